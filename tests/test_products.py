"""s2xe and h2xe beyond the reference values: walks over every change of regime, and identities.

Inputs are numbers of the precision under test, where they matter. References have 50 digits and stand on the
points of the model nearest to the inputs.
"""

import re
from typing import Any

import numpy as np
import pytest
from golden import EPSILON, FLOAT, MP, Array, Exact, cut, exact, rounded
from hypothesis import given
from hypothesis import strategies as st
from small_kernels import Body, SmallKernels

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.program import geometry_parts

CURVATURE = {"s2xe": 1, "h2xe": -1}
ORIGIN = np.array([0.0, 0.0, 1.0, 0.0])
OPPOSITE = np.array([0.0, 0.0, -1.0, 0.0])
both_precisions = pytest.mark.parametrize("precision", EPSILON)
both_geometries = pytest.mark.parametrize("geometry", CURVATURE)


def on_factor(geometry: str, p: Array) -> Exact:
    """The point (3,) of the factor nearest to `p` (4,): on the sphere radially, on the sheet over (x, y)."""
    x, y, z = exact(p[:3])
    if geometry == "h2xe":
        return np.array([x, y, MP.sqrt(1 + x * x + y * y)])
    return np.array([x, y, z]) / MP.sqrt(x * x + y * y + z * z)


def frame(geometry: str, y: Exact) -> Exact:
    """The transvection (3,3) of the factor from o to `y` (3,); at the antipode of o that on the +x side."""
    k, x = CURVATURE[geometry], y[:2]
    square = (x * x).sum()
    if y[2] < 0 and square == 0:
        return exact(np.diag([-1.0, 1.0, -1.0]))
    matrix = exact(np.eye(3))
    matrix[:2, :2] -= k * np.outer(x, x) * (1 / (1 + y[2]) if y[2] >= 0 else (1 - y[2]) / square)
    matrix[:2, 2], matrix[2, :2], matrix[2, 2] = x, -k * x, y[2]
    return matrix


def sine(geometry: str, angle: Any) -> tuple[Any, Any]:
    """Sine and cosine of the curvature."""
    s2 = geometry == "s2xe"
    return (MP.sin(angle), MP.cos(angle)) if s2 else (MP.sinh(angle), MP.cosh(angle))


def ray(geometry: str, base: Array, u: Array, t: float) -> tuple[Exact, Exact]:
    """Point and velocity (4,) after time `t` from `base` (4,) along `u` (3,)."""
    e, time = exact(u), MP.mpf(float(t))
    share = MP.sqrt(e[0] ** 2 + e[1] ** 2)
    s, c = sine(geometry, share * time)
    ratio = s / share if share else time
    matrix = frame(geometry, on_factor(geometry, base))
    y = matrix @ np.array([ratio * e[0], ratio * e[1], c])
    v = matrix @ np.array([c * e[0], c * e[1], -CURVATURE[geometry] * share * s])
    return np.append(y, MP.mpf(float(base[3])) + time * e[2]), np.append(v, e[2])


def connection(geometry: str, p: Array, q: Array) -> tuple[Any, Exact]:
    """Distance in the factor, and the direction (2,) of the shortest way in the frame at `p`, not unit."""
    a, b = on_factor(geometry, p), on_factor(geometry, q)
    k = CURVATURE[geometry]
    near = k * (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2] >= 0
    d = b - a if near else b + a
    half = MP.sqrt(max(d[0] ** 2 + d[1] ** 2 + k * d[2] ** 2, MP.mpf(0))) / 2
    apart = 2 * (MP.asin(half) if geometry == "s2xe" else MP.asinh(half))
    inverse = frame(geometry, a).T if geometry == "s2xe" else frame(geometry, np.array([-a[0], -a[1], a[2]]))
    toward = (inverse @ (b - a if near or geometry == "s2xe" else b))[:2]
    return (apart if near or geometry == "h2xe" else MP.pi - apart), toward


# -- along the line ------------------------------------------------------------------------------------------


@both_precisions
@both_geometries
def test_directions_close_in_on_the_line(geometry: str, precision: str, opencl_device: Device) -> None:
    """l from 1 to 1e-35 and 0, from both sides: what remains of the factor's part keeps all its digits."""
    eps = EPSILON[precision]
    g = Geometry(geometry, precision, opencl_device)
    shares = np.concatenate([10.0 ** -np.arange(0, 36, 0.5), [0.0]])
    u = cut(
        [[s * b * 0.6, s * b * 0.8, np.sqrt(1 - min(b * b, 1.0))] for b in shares for s in (1, -1)], precision
    )
    for t in cut([1e-6, 0.3, 3.0, 3.1415, 6.2, 30.0], precision):
        points, _ = g.flow(u, t)
        areas = g.area_density(u, t)
        for i, e in enumerate(u):
            wanted, _ = ray(geometry, ORIGIN, e, t)
            share = MP.sqrt(exact(e)[0] ** 2 + exact(e)[1] ** 2)
            angle = float(share * float(t))
            size = np.abs(t * e[:2]) if geometry == "s2xe" else np.abs(rounded(wanted[:2]))
            allowed = 3 * eps * (1 + angle) * size + np.finfo(FLOAT[precision]).tiny
            assert (np.abs(rounded(exact(points[i, :2]) - wanted[:2])) <= allowed).all(), (e, t)
            length = MP.mpf(float(t))
            area = length * abs(sine(geometry, share * length)[0] / share) if share else length**2
            allowed_area = 3 * eps * (1 + angle) * (t * t if geometry == "s2xe" else float(area))
            assert abs(areas[i] - area) <= allowed_area, (e, t)


@both_precisions
def test_area_density_about_the_foci(precision: str, opencl_device: Device) -> None:
    """s2xe: |S(l t)| falls to 0 at every half turn and rises again; never negative."""
    g = Geometry("s2xe", precision, opencl_device)
    u = cut([0.48, 0.64, 0.6], precision)
    share = MP.sqrt(exact(u)[0] ** 2 + exact(u)[1] ** 2)
    steps = np.concatenate([10.0 ** -np.arange(1, 17), [0.0]])
    times = np.array(
        [float(n * MP.pi / share) * (1 + s * step) for n in (1, 2, 7) for step in steps for s in (1, -1)]
    )
    got = g.area_density(u, times)
    wanted = exact([t * abs(MP.sin(share * MP.mpf(float(t))) / share) for t in times])
    assert (got >= 0).all()
    np.testing.assert_array_equal(g.area_density(u, -times), got)
    assert (np.abs(rounded(exact(got) - wanted)) <= 2 * EPSILON[precision] * times * (1 + times)).all()


# -- nearby points and antipodes -----------------------------------------------------------------------------

# Points of the factor: at and about the origin. S2: about the equator z = 0, where s3.h changes its formula
# at |2 z| = 1/4, and about the antipode of the origin. H2: where h3.h changes its own at |x| = 1, and far.
STARTS = {
    "s2xe": [
        (0, 0, 1), (1e-5, 2e-5, 1), (0.3, -0.4, 0.7), (0.6, 0.8, 0), (0.6, 0.8, 1e-5), (0.6, 0.8, -1e-5),
        (0.6, 0.79, 0.124), (0.6, 0.79, 0.126), (0.6, 0.79, -0.126), (0.1, 0.2, -0.9), (1e-5, 2e-5, -1),
        (0, 0, -1),
    ],
    "h2xe": [
        (0, 0, 1), (1e-5, 2e-5, 1), (0.3, -0.4, 1), (0.6, 0.79, 1), (0.61, 0.8, 1), (3, -4, 1), (30, 40, 1),
    ],
}  # fmt: skip
SEPARATIONS = np.concatenate([10.0 ** -np.arange(0.5, 13, 0.5), [0.0]])
RISES = (0.0, 1e-7, -1.0)


def starts(geometry: str) -> Array:
    rows = [np.append(rounded(on_factor(geometry, np.array([*p, 0.0]))), 0.25) for p in STARTS[geometry]]
    return np.array(rows)


def beside(geometry: str, p: Array, separation: float, rise: float) -> Array:
    y, _ = ray(geometry, p, np.array([0.8, -0.6, 0.0]), separation)
    return rounded(np.append(y[:3], MP.mpf(float(p[3])) + rise))


def pairs(geometry: str, antipodal: bool) -> tuple[Array, Array, Array]:
    """Bases, points beside them (or beside their antipodes), and the separations."""
    rows = [
        (p, beside(geometry, p, s, rise), s) for p in starts(geometry) for s in SEPARATIONS for rise in RISES
    ]
    p, q, s = (np.array(column) for column in zip(*rows, strict=True))
    if antipodal:
        q[:, :3] *= -1
    return p, q, s


@both_precisions
@pytest.mark.parametrize("geometry, antipodal", [("s2xe", False), ("s2xe", True), ("h2xe", False)])
def test_geodesics_close_in(geometry: str, antipodal: bool, precision: str, opencl_device: Device) -> None:
    """Distance and geodesics while the points of the factor become one, or antipodes, down to exactly."""
    g = Geometry(geometry, precision, opencl_device)
    p, q, s = pairs(geometry, antipodal)
    count = 4 if geometry == "s2xe" else 1
    directions, lengths = g.geodesics(q, count, p)
    distances = g.distance(q, p)
    np.testing.assert_array_equal(distances, lengths[:, 0])
    assert (np.diff(lengths, axis=1) >= 0).all()
    # How far double coordinates, or single ones with their tails, fix a point of the factor.
    grain = {"double": 2 * EPSILON["double"], "single": EPSILON["single"] ** 2}[precision] * np.abs(p).max(
        axis=1
    )
    # Far out a formula cannot be better than rounded coordinates: they tell a position to EPSILON z.
    condition = 1 + 0.2 * p[:, 2] if geometry == "h2xe" else np.ones(len(p))
    eps = EPSILON[precision]
    for i in range(len(p)):
        apart, toward = connection(geometry, p[i], q[i])
        rise = MP.mpf(float(q[i, 3])) - MP.mpf(float(p[i, 3]))
        n = MP.sqrt((toward**2).sum())
        for k in range(count):
            turns = MP.pi * (k + 1) - apart if k % 2 else MP.pi * k + apart
            wanted = MP.sqrt(turns**2 + rise**2)
            off = abs(float(lengths[i, k] - wanted))
            assert off <= 4 * eps * condition[i] * float(wanted) + grain[i], (p[i], q[i], k)
            got = directions[i, k]
            assert abs(np.linalg.norm(got) - 1) <= 4 * eps, (p[i], q[i], k)
            if wanted == 0:
                assert got.tolist() == [0, 0, 1]
            elif s[i] > 0 and float(n) > 100 * grain[i]:
                across = toward / n * (-1 if k % 2 else 1) * turns / wanted
                unit = rounded(np.append(across, rise / wanted))
                allowed = 6 * eps * condition[i] + 2 * grain[i] / float(n)
                assert np.abs(got - unit).max() <= allowed, (p[i], q[i], k, got, unit)


@both_precisions
@both_geometries
def test_directions_are_unit_however_near(geometry: str, precision: str, opencl_device: Device) -> None:
    """Separations whose squares, and which themselves, leave the range of the precision."""
    g = Geometry(geometry, precision, opencl_device)
    for apart in 10.0 ** -np.arange(12, 320, 4.0):
        q = np.array([[0.6 * apart, -0.8 * apart, 1, 0], [0.6 * apart, 0, 1, 0.8 * apart], [0, 0, 1, apart]])
        directions, lengths = g.geodesics(q, 1)
        assert np.abs(np.linalg.norm(directions[:, 0], axis=1) - 1).max() <= 4 * EPSILON[precision], apart
        assert (lengths <= 1.01 * apart + 2 * np.finfo(FLOAT[precision]).smallest_subnormal).all(), apart


@both_precisions
def test_over_one_point_the_line_is_shortest(precision: str, opencl_device: Device) -> None:
    """s2xe: of each family of geodesics to a point straight above, one member that arrives there."""
    g = Geometry("s2xe", precision, opencl_device)
    for p in starts("s2xe"):
        q = p + 2 * np.eye(4)[3]
        directions, lengths = g.geodesics(q, 5, p)
        assert directions[0, 0].tolist() == [0, 0, 1]
        np.testing.assert_allclose(lengths[0], np.hypot([0, 2, 2, 4, 4] * np.full(5, np.pi), 2), rtol=1e-6)
        for u, t in zip(directions[0], lengths[0], strict=True):
            reached, _ = g.flow(u / np.linalg.norm(u), t, p)
            assert np.abs(reached - q).max() <= 4 * EPSILON[precision] * (1 + t)


# The rows of math section 5 for H3 and H2: radii, separations (None: the second point is drawn like the
# first), and the "stable" columns for double and single, whose references too start from rounded inputs.
FAR_OUT = {
    "near": ((0, 2), (1e-6, 1e-2), 3.0e-16, 1.5e-7),
    "random": ((0, 3), None, 3.7e-16, 1.7e-7),
    "r6": ((6, 6), (0.1, 3), 6.4e-15, 4.2e-6),
    "r12": ((12, 12), (0.1, 3), 3.4e-12, 1.4e-3),
    "far": ((20, 30), None, 9.4e-17, EPSILON["single"]),
}


@both_precisions
@pytest.mark.parametrize("regime", FAR_OUT)
def test_h2xe_distance_far_out(regime: str, precision: str, opencl_device: Device) -> None:
    """Within 4 times the columns of math section 5, on the level and with a rise of the line's coordinate."""
    radii, separations, *columns = FAR_OUT[regime]
    rng = np.random.default_rng(5)

    def drawn(low: float, high: float) -> Array:
        a, r = rng.uniform(0, 2 * np.pi, 300), rng.uniform(low, high, 300)
        return np.stack([np.cos(a) * np.sinh(r), np.sin(a) * np.sinh(r), np.cosh(r)], axis=1)

    p = drawn(*radii)
    if separations is None:
        q = drawn(*radii)
    else:
        a, r = rng.uniform(0, 2 * np.pi, 300), np.exp(rng.uniform(*np.log(separations), 300))
        near = exact(np.stack([np.cos(a) * np.sinh(r), np.sin(a) * np.sinh(r), np.cosh(r)], axis=1))
        q = np.array([rounded(frame("h2xe", exact(b)) @ n) for b, n in zip(p, near, strict=True)])
    p, q = (cut(x[:, :2], precision) for x in (p, q))
    rises = cut(np.where(np.arange(300) % 2, rng.uniform(-3, 3, 300), 0), precision)
    zeros = np.zeros(300)
    p, q = (np.column_stack([x, np.sqrt(1 + (x**2).sum(axis=1)), w]) for x, w in ((p, zeros), (q, rises)))
    g = Geometry("h2xe", precision, opencl_device)
    wanted = exact([MP.hypot(connection("h2xe", a, b)[0], b[3]) for a, b in zip(p, q, strict=True)])
    errors = np.abs(rounded(exact(g.distance(q, p)) / wanted - 1))
    # The square root of the sum of squares adds its own rounding.
    assert errors.max() <= 4 * columns[precision == "single"] + EPSILON[precision], errors.max()


@both_precisions
@pytest.mark.parametrize("radius", [0.99, 1.01, 4.0, 9.0, 14.0])
def test_h2xe_directions_from_far_out(radius: float, precision: str, opencl_device: Device) -> None:
    """Towards points about the origin, over the change of formula at |x| = 1."""
    g = Geometry("h2xe", precision, opencl_device)
    x = cut(np.sinh(radius) * np.array([0.6, 0.8]), precision)
    p = np.array([*x, np.sqrt(1 + (x**2).sum()), 0.0])
    xy = cut(
        [[0, 0], [0.3, 0.1], [-0.3, 0.2], [0.1, -0.9], [0.8, -0.6], [0.8, -0.6000001], [3, 2]], precision
    )
    q = np.column_stack([xy, np.sqrt(1 + (xy**2).sum(axis=1)), np.arange(7) - 3.0])
    found, lengths = g.geodesics(q, 1, p)
    for i in range(len(q)):
        apart, toward = connection("h2xe", p, q[i])
        wanted = MP.hypot(apart, q[i, 3])
        unit = np.append(toward / MP.sqrt((toward**2).sum()) * apart / wanted, q[i, 3] / wanted)
        assert abs(float(lengths[i, 0] / wanted) - 1) <= 4 * EPSILON[precision]
        assert np.abs(rounded(exact(found[i, 0]) - unit)).max() <= 8 * EPSILON[precision], q[i]


# -- frames over the antipode of the origin ------------------------------------------------------------------


@both_precisions
def test_frames_about_the_antipode_of_the_origin(precision: str, opencl_device: Device) -> None:
    """s2xe: starts and ends from a tenth away from the antipode down to on it; velocities stay right."""
    g = Geometry("s2xe", precision, opencl_device)
    eps = EPSILON[precision]
    u = cut([0.36, 0.48, 0.8], precision)
    radii = np.concatenate([10.0 ** -np.arange(1, 31), 10.0 ** -np.arange(140, 170, 2.0), [0.0]])
    bases = cut(
        [[r * np.cos(a), r * np.sin(a), -np.sqrt(1 - r * r), 0] for r in radii for a in (0.3, 4)], precision
    )
    for t in cut([0.0, 1e-6, 1e-3, 0.1, 2.0], precision):
        points, directions = g.flow(u, t, bases)
        velocities = g.velocity(points, directions)
        for i, base in enumerate(bases):
            point, velocity = ray("s2xe", base, u, t)
            assert np.abs(rounded(exact(points[i]) - point)).max() <= 6 * eps, (base, t)
            # The point that is reached, and with it the frame, is known to this share of its offset.
            turn = (np.hypot(*base[:2]) + t) / max(
                float(MP.hypot(*point[:2])), np.finfo(FLOAT[precision]).tiny
            )
            allowed = 6 * eps * max(1.0, turn)
            assert np.abs(rounded(exact(velocities[i]) - velocity)).max() <= allowed, (base, t)


@both_precisions
def test_arriving_at_the_antipode_of_the_origin(precision: str, opencl_device: Device) -> None:
    """s2xe: half a turn from the origin along every direction, from both sides and exactly."""
    g = Geometry("s2xe", precision, opencl_device)
    a = np.linspace(0, 2 * np.pi, 12)
    u = np.stack([np.cos(a), np.sin(a), np.zeros(12)], axis=1)
    for t in np.pi * (1 + np.array([-1e-3, -1e-7, -1e-15, 0, 1e-15, 1e-7, 1e-3])):
        points, directions = g.flow(u, t)
        wanted = [ray("s2xe", ORIGIN, e, t)[1] for e in u]
        off = np.abs(rounded(exact(g.velocity(points, directions)) - np.array(wanted)))
        assert off.max() <= 6 * EPSILON[precision], t


@both_precisions
def test_the_frame_on_the_antipode_turns_nothing_over(precision: str, opencl_device: Device) -> None:
    """s2xe: translation to the antipode of the origin is a rotation, not a reflection, and can be undone."""
    g = Geometry("s2xe", precision, opencl_device)
    e = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]
    moved = g.translate(OPPOSITE, e)
    np.testing.assert_allclose(moved[:, :3], np.diag([-1, 1, -1]), atol=2 * EPSILON[precision])
    np.testing.assert_allclose(g.untranslate(OPPOSITE, moved), e, atol=2 * EPSILON[precision])


# -- identities ----------------------------------------------------------------------------------------------


@st.composite
def points(draw: st.DrawFn, geometry: str) -> Array:
    a, r = draw(st.floats(0, 2 * np.pi)), draw(st.floats(0, np.pi if geometry == "s2xe" else 2.0))
    s, c = (np.sin(r), np.cos(r)) if geometry == "s2xe" else (np.sinh(r), np.cosh(r))
    return np.array([s * np.cos(a), s * np.sin(a), c, draw(st.floats(-3, 3))])


@st.composite
def directions(draw: st.DrawFn) -> Array:
    a, z = draw(st.floats(0, 2 * np.pi)), draw(st.floats(-1, 1))
    share = np.sqrt(1 - z * z)
    return np.array([share * np.cos(a), share * np.sin(a), z])


# Condition of what is drawn here: heights up to cosh(2) cosh(3), angles up to 6.
ROUNDINGS = 400
anything = st.sampled_from([(geometry, precision) for geometry in CURVATURE for precision in EPSILON])


def near(got: Any, wanted: Any, precision: str) -> bool:
    return bool(np.abs(np.asarray(got) - np.asarray(wanted)).max() <= ROUNDINGS * EPSILON[precision])


def moving(g: Geometry, u: Array, t: float, base: Array) -> tuple[Array, Array, Array]:
    """Point, direction and ambient velocity after `flow`."""
    p, e = g.flow(u, t, base)
    return p[0], e[0] / np.linalg.norm(e[0]), g.velocity(p, e)[0]


@given(st.data(), anything, st.floats(-3, 3), st.floats(-3, 3))
def test_flow_is_a_flow(
    opencl_device: Device, data: st.DataObject, kind: tuple[str, str], s: float, t: float
) -> None:
    geometry, precision = kind
    g = Geometry(geometry, precision, opencl_device)
    p, u = data.draw(points(geometry)), data.draw(directions())
    start, _, v = moving(g, u, 0, p)
    assert near(start, p, precision)
    assert near(v, g.velocity(p, u)[0], precision)
    middle, e, _ = moving(g, u, s, p)
    once, _, velocity = moving(g, u, s + t, p)
    twice, _, velocity_twice = moving(g, e, t, middle)
    assert near(once, twice, precision)
    assert near(velocity, velocity_twice, precision)
    back, e, _ = moving(g, -e, s, middle)
    assert near(back, p, precision)


@given(st.data(), anything)
def test_distance_is_a_metric(opencl_device: Device, data: st.DataObject, kind: tuple[str, str]) -> None:
    geometry, precision = kind
    g = Geometry(geometry, precision, opencl_device)
    p, q, r = (data.draw(points(geometry)) for _ in range(3))
    pq, qp, qr, pr = g.distance([q, p, r, r], [p, q, q, p])
    assert near(pq, qp, precision)
    assert pr <= pq + qr + ROUNDINGS * EPSILON[precision]
    assert near(g.distance(p, p)[0], 0, precision)
    moved_p, moved_q = g.translate(r, [p, q])
    assert near(g.distance(moved_q, moved_p)[0], pq, precision)
    assert near(g.untranslate(r, [moved_p, moved_q]), [p, q], precision)
    assert g.underestimate(p)[0] <= g.distance(p)[0] * (1 + 4 * EPSILON[precision])


@given(st.data(), anything)
def test_geodesics_arrive(opencl_device: Device, data: st.DataObject, kind: tuple[str, str]) -> None:
    """Each of the first geodesics leads to its end in its length, and reversed it is one from there."""
    geometry, precision = kind
    g = Geometry(geometry, precision, opencl_device)
    p, q = data.draw(points(geometry)), data.draw(points(geometry))
    found, lengths = g.geodesics(q, 4, p)
    assert np.isnan(lengths[0, 1:]).all() == (geometry == "h2xe")
    for u, t in zip(found[0], lengths[0], strict=True):
        if not np.isnan(t):
            reached, e, _ = moving(g, u / np.linalg.norm(u), t, p)
            assert near(reached, q, precision)
            home, _, _ = moving(g, -e, t, reached)
            assert near(home, p, precision)


@given(st.data(), anything, st.floats(0, 3))
def test_transport_is_a_rotation_that_carries_the_direction(
    opencl_device: Device, data: st.DataObject, kind: tuple[str, str], t: float
) -> None:
    geometry, precision = kind
    g = Geometry(geometry, precision, opencl_device)
    p, u = data.draw(points(geometry)), data.draw(directions())
    matrix = g.transport(u, t, p)[0]
    _, e = g.flow(u, t, p)
    assert near(matrix @ matrix.T, np.eye(3), precision)
    assert near(matrix @ u, e[0], precision)
    assert near(matrix[2], [0, 0, 1], precision) and near(matrix[:, 2], [0, 0, 1], precision)
    assert np.linalg.det(matrix) > 0


@both_precisions
@both_geometries
def test_where_a_flow_leads_another_can_start(geometry: str, precision: str, opencl_device: Device) -> None:
    """Rounding must not carry points off the model or directions off unit length, flow after flow."""
    g = Geometry(geometry, precision, opencl_device)
    rng = np.random.default_rng(15)
    base, u = sample(geometry, 1000)
    for _ in range(30):
        base, u = g.flow(u, rng.uniform(-1, 1, 1000) * (0.3 if geometry == "h2xe" else 3), base)
    assert np.abs(np.linalg.norm(u, axis=1) - 1).max() <= 16 * EPSILON[precision]
    assert np.abs(g.velocity(base, u)).max() < np.inf


@pytest.mark.parametrize(
    "geometry, point, model",
    [
        ("s2xe", [0.6, 0.8, 0.1, 5], "x^2 + y^2 + z^2 = 1"),
        ("h2xe", [0, 0.75, -1.25, 5], "z = sqrt(1 + x^2 + y^2)"),
    ],
)
def test_points_must_be_on_the_model(
    geometry: str, point: list[float], model: str, opencl_device: Device
) -> None:
    with pytest.raises(ValueError, match=rf"off the model of {geometry}; expected {re.escape(model)}"):
        Geometry(geometry, "single", opencl_device).distance(point)


# -- what pictures use ---------------------------------------------------------------------------------------

BODIES = {
    # point 0-3, direction 4-6, time 7 -> point 0-3, velocity 4-7, direction 8-10, square of the speed
    "flow": Body(
        8,
        12,
        """
  point p = POINT(0);
  direction u = {IN(4), IN(5), IN(6)};
  vector v = push(p, u);
  flow(&p, &v, IN(7));
  reproject(&p, &v);
  direction e = pull(p, v);
  real to[] = {p.x, p.y, p.z, p.w, v.x, v.y, v.z, v.w, e.x, e.y, e.z, inner(p, v, v)};
  for (int c = 0; c < 12; c++) OUT(c, to[c]);""",
    ),
    # point 0-3, direction 4-6, covector 7-10 -> the covector on the direction, in the frame and outside
    "covector": Body(
        11,
        2,
        """
  point p = POINT(0);
  direction u = {IN(4), IN(5), IN(6)};
  covector g = POINT(7);
  vector v = push(p, u);
  OUT(0, dot_3(pull_covector(p, g), u));
  OUT(1, dot_4(g, v));""",
    ),
    # any point -> the origin and its distance from itself and from the point
    "origin": Body(
        4,
        6,
        """
  point o = origin(), p = POINT(0), exact = scale_4(p, REAL(0));
  mask unsolved;
  OUT(0, o.x);
  OUT(1, o.y);
  OUT(2, o.z);
  OUT(3, o.w);
  OUT(4, origin_distance(o));
  OUT(5, origin_distance(p) - distance_between(o, p, exact, exact, &unsolved));""",
    ),
}


def sample(geometry: str, count: int, radius: float = 2) -> tuple[Array, Array]:
    """Points (N,4) within `radius` of the origin, and unit directions (N,3), some close to the line."""
    rng = np.random.default_rng(3)
    a, r = rng.uniform(0, 2 * np.pi, count), rng.uniform(0, radius, count)
    s, c = (np.sin(r), np.cos(r)) if geometry == "s2xe" else (np.sinh(r), np.cosh(r))
    p = np.stack([s * np.cos(a), s * np.sin(a), c, rng.uniform(-1, 1, count)], axis=1)
    b, share = rng.uniform(0, 2 * np.pi, count), np.sin(10.0 ** rng.uniform(-9, 0.19, count))
    return p, np.stack([share * np.cos(b), share * np.sin(b), np.sqrt(1 - share**2)], axis=1)


@pytest.mark.parametrize("lanes", [1, 16])
@both_precisions
@both_geometries
def test_the_marchers_flow_is_the_flow(
    geometry: str, precision: str, lanes: int, opencl_device: Device
) -> None:
    kernels = SmallKernels(opencl_device, geometry_parts(geometry), BODIES, precision, lanes)
    g = Geometry(geometry, precision, opencl_device, lanes=lanes)
    eps = EPSILON[precision]
    for radius, t in ((2, 0.0), (2, 1e-3), (2, 0.7), (2, 3.0), (6, 1e-3), (6, 0.7)):
        p, u = sample(geometry, 400, radius)
        got = kernels.run("flow", np.column_stack([p, u, np.full(400, t)]).T).T.astype(np.float64)
        reached, e = g.flow(u, t, p)
        # Rounding of the ambient velocity grows with t.
        size = np.maximum(np.abs(p).max(axis=1), np.abs(reached).max(axis=1))[:, None]
        allowed = 12 * eps * size * np.cosh(t)
        assert (np.abs(got[:, :4] - reached) <= allowed).all()
        assert (np.abs(got[:, 4:8] - g.velocity(reached, e)) <= allowed * size).all()
        assert (np.abs(np.linalg.norm(got[:, 8:11], axis=1) - 1) <= 8 * eps * size[:, 0]).all()
        assert (np.abs(got[:, 11] - 1) <= 8 * eps * size[:, 0] ** 2).all()


@both_precisions
@both_geometries
def test_gradients_and_the_origin(geometry: str, precision: str, opencl_device: Device) -> None:
    kernels = SmallKernels(opencl_device, geometry_parts(geometry), BODIES, precision, 4)
    p, u = sample(geometry, 400)
    covectors = np.random.default_rng(4).normal(size=(400, 4))
    inside, outside = kernels.run("covector", np.column_stack([p, u, covectors]).T)
    assert np.abs(inside - outside).max() <= 40 * EPSILON[precision] * np.abs(p).max()
    *o, none, difference = kernels.run("origin", p.T)
    assert (np.array(o).T == ORIGIN).all()
    assert (none == 0).all()
    assert np.abs(difference).max() <= 4 * EPSILON[precision] * 3
