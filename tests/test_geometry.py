"""Identities that the numerical API keeps, the seams of the formulas, shapes, and the words of the errors.

Tolerances are in units of EPSILON of the precision times the natural size of what is compared: in h3
coordinates are cosh of a distance large and fix a position to EPSILON times that only.
"""

import re
from typing import Any, NamedTuple

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from golden import (
    EPSILON,
    MP,
    Array,
    Exact,
    cut,
    distance,
    exact,
    inverse_translation,
    on_model,
    rounded,
    translation,
)
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from small_kernels import Body, SmallKernels

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.program import geometry_parts, kernel_text

GEOMETRIES = ("e3", "s3", "h3")
LANES = 16
ORIGIN = np.array([0.0, 0, 0, 1])
SETTINGS = [(name, precision) for name in GEOMETRIES for precision in EPSILON]

# Functions of kernels/geometry that the numerical API does not call itself.
BODIES = {
    "flow": Body(
        8,
        8,
        """point p = POINT(0); vector v = POINT(4);
  flow(&p, &v, REAL(1.25));
  OUT(0, p.x); OUT(1, p.y); OUT(2, p.z); OUT(3, p.w); OUT(4, v.x); OUT(5, v.y); OUT(6, v.z); OUT(7, v.w);""",
    ),
    "reproject": Body(
        8,
        8,
        """point p = POINT(0); vector v = POINT(4);
  reproject(&p, &v);
  OUT(0, p.x); OUT(1, p.y); OUT(2, p.z); OUT(3, p.w); OUT(4, v.x); OUT(5, v.y); OUT(6, v.z); OUT(7, v.w);""",
    ),
    "pull": Body(8, 3, "direction u = pull(POINT(0), POINT(4)); OUT(0, u.x); OUT(1, u.y); OUT(2, u.z);"),
    "pull_covector": Body(
        8, 3, "direction u = pull_covector(POINT(0), POINT(4)); OUT(0, u.x); OUT(1, u.y); OUT(2, u.z);"
    ),
    "crossing_time": Body(1, 1, "OUT(0, crossing_time(IN(0), with_w(first_3(origin()), REAL(0))));"),
}


class Setting(NamedTuple):
    g: Geometry
    kernels: SmallKernels

    @property
    def epsilon(self) -> float:
        return EPSILON[self.g.precision]

    def points(self, vectors: Array) -> Array:
        """exp of vectors (N,3) at the origin."""
        r = np.linalg.norm(vectors, axis=1)
        along = np.where(r > 0, r, 1)
        sine, cosine = {
            "e3": (r, np.ones_like(r)),
            "s3": (np.sin(r), np.cos(r)),
            "h3": (np.sinh(r), np.cosh(r)),
        }[self.g.name]
        return np.concatenate([vectors * np.where(r > 0, sine / along, 1)[:, None], cosine[:, None]], axis=1)

    def size(self, *points: Array) -> Array:
        """How large coordinates get (N,): 1 in s3."""
        product = np.ones(len(points[0]))
        for p in points:
            product = product * (1 + np.abs(p).max(axis=1) if self.g.name == "e3" else np.abs(p[:, 3]))
        return np.ones_like(product) if self.g.name == "s3" else product

    def close(self, got: Array, want: Array, units: float, size: Any = 1.0) -> None:
        """Rows agree to `units` EPSILON times `size` (N,)."""
        off = np.abs(got - want).reshape(len(want), -1).max(axis=1, initial=0)
        allowed = units * self.epsilon * np.broadcast_to(size, off.shape)
        worst = int(np.argmax(off / allowed))
        assert (off <= allowed).all(), (
            f"{self.g.name} {self.g.precision}, row {worst}: got {got[worst]}, want {want[worst]}, "
            f"off {off[worst]:.3g}, allowed {allowed[worst]:.3g}"
        )


@pytest.fixture(scope="module", params=SETTINGS, ids="-".join)
def at(request: pytest.FixtureRequest, opencl_device: Device) -> Setting:
    name, precision = request.param
    kernels = SmallKernels(opencl_device, geometry_parts(name), BODIES, precision, LANES)
    return Setting(Geometry(name, precision, opencl_device, lanes=LANES), kernels)


def geometry(name: str, precision: str, device: Device) -> Geometry:
    return Geometry(name, precision, device, lanes=LANES)


class Drawn(NamedTuple):
    """Three vectors and a direction (N,3) and two lengths (N,)."""

    a: Array
    b: Array
    c: Array
    u: Array
    s: Array
    t: Array


@st.composite
def drawn(draw: st.DrawFn) -> Drawn:
    """Vectors up to 1.3 in each coordinate, also equal, zero or very short; times up to 1.5 both ways."""
    n = draw(st.integers(1, 5))

    def rows(bound: float, width: int) -> Array:
        return draw(hnp.arrays(np.float64, (n, width), elements=st.floats(-bound, bound)))

    a, b, c = rows(1.3, 3), rows(1.3, 3), rows(1.3, 3)
    if draw(st.booleans()):
        b = a + 1e-5 * c
    u = rows(1, 3)
    length = np.linalg.norm(u, axis=1)
    assume((length > 1e-3).all())
    return Drawn(a, b, c, u / length[:, None], rows(1.5, 1)[:, 0], rows(1.5, 1)[:, 0])


identity = settings(max_examples=15)


@identity
@given(d=drawn())
def test_flows_add_up(at: Setting, d: Drawn) -> None:
    """flow(s) then flow(t) from where it led is flow(s + t): the same point and the same ambient velocity."""
    base = at.points(d.a)
    middle, forward = at.g.flow(d.u, d.s, base)
    got, ahead = at.g.flow(forward, d.t, middle)
    want, direction = at.g.flow(d.u, d.s + d.t, base)
    # s3: the frame turns infinitely fast around -origin.
    off_pole = (
        np.linalg.norm(np.minimum(np.abs(want[:, :3]), 1), axis=1)
        if at.g.name == "s3"
        else np.ones(len(base))
    )
    off_pole = np.where(want[:, 3] > 0, 1, off_pole)
    assume((off_pole > 0.01).all())
    size = at.size(base, at.points(d.s[:, None] * d.u), at.points(d.t[:, None] * d.u))
    at.close(got, want, 16, size)
    at.close(at.g.velocity(got, ahead), at.g.velocity(want, direction), 64, size / off_pole)


@identity
@given(d=drawn())
def test_distance_is_symmetric(at: Setting, d: Drawn) -> None:
    p, q = at.points(d.a), at.points(d.b)
    there, back = at.g.distance(q, p), at.g.distance(p, q)
    assert (there >= 0).all()
    at.close(there, back, 4, there + np.finfo(float).tiny)


@identity
@given(d=drawn())
def test_distance_is_invariant_under_translations(at: Setting, d: Drawn) -> None:
    base, p, q = at.points(d.c), at.points(d.a), at.points(d.b)
    moved = at.g.distance(at.g.translate(base, q), at.g.translate(base, p))
    at.close(moved, at.g.distance(q, p), 16, at.size(base, p) + at.size(base, q))


@identity
@given(d=drawn())
def test_untranslate_undoes_translate(at: Setting, d: Drawn) -> None:
    base, p = at.points(d.a), at.points(d.b)
    at.close(at.g.untranslate(base, at.g.translate(base, p)), p, 16, at.size(base, base, p))
    at.close(at.g.translate(base, at.g.untranslate(base, p)), p, 16, at.size(base, base, p))
    # The last coordinate is worked out anew from the others: a rounding of theirs and one of its own.
    at.close(at.g.translate(base, np.broadcast_to(ORIGIN, p.shape)), base, 2, at.size(base))
    matrix = at.g.translation_matrix(base)
    at.close(np.einsum("nij,nj->ni", matrix, p), at.g.translate(base, p), 16, at.size(base, p))


@identity
@given(d=drawn())
def test_geodesics_end_where_they_should(at: Setting, d: Drawn) -> None:
    p, q = at.points(d.a), at.points(d.b)
    directions, lengths = at.g.geodesics(q, 4, p)
    expected = 4 if at.g.name == "s3" else 1
    assert np.isfinite(lengths[:, :expected]).all() and np.isnan(lengths[:, expected:]).all()
    assert np.isfinite(directions[:, :expected]).all() and np.isnan(directions[:, expected:]).all()
    np.testing.assert_array_equal(lengths[:, 0], at.g.distance(q, p))
    assert (np.diff(lengths[:, :expected], axis=1) >= 0).all()
    for k in range(expected):
        end, _ = at.g.flow(directions[:, k], lengths[:, k], p)
        at.close(end, q, 32, at.size(p, p, q) * (1 + lengths[:, k]))


@identity
@given(d=drawn())
def test_underestimate_is_one_and_is_zero_at_the_origin(at: Setting, d: Drawn) -> None:
    p = at.points(d.a)
    assert (at.g.underestimate(p) <= at.g.distance(p) * (1 + 4 * at.epsilon)).all()
    assert at.g.underestimate(ORIGIN)[0] == 0


@identity
@given(d=drawn())
def test_triangle_inequality(at: Setting, d: Drawn) -> None:
    a, b, c = at.points(d.a), at.points(d.b), at.points(d.c)
    detour = at.g.distance(b, a) + at.g.distance(c, b)
    slack = 8 * at.epsilon * np.maximum.reduce([at.size(a), at.size(b), at.size(c)])
    assert (at.g.distance(c, a) <= detour + slack).all()


@identity
@given(d=drawn())
def test_transport_is_a_rotation_that_carries_the_direction_along(at: Setting, d: Drawn) -> None:
    base = at.points(d.a)
    transport = at.g.transport(d.u, d.t, base)
    at.close(np.einsum("nij,nkj->nik", transport, transport), np.broadcast_to(np.eye(3), transport.shape), 32)
    assert np.abs(np.linalg.det(transport) - 1).max() <= 64 * at.epsilon
    _, direction = at.g.flow(d.u, d.t, base)
    at.close(np.einsum("nij,nj->ni", transport, d.u), direction, 16)
    np.testing.assert_array_equal(at.g.transport(d.u, 0.0), np.broadcast_to(np.eye(3), transport.shape))


@identity
@given(d=drawn())
def test_a_flow_backwards_is_the_flow_of_the_opposite_direction(at: Setting, d: Drawn) -> None:
    base = at.points(d.a)
    point, direction = at.g.flow(d.u, -d.t, base)
    other, opposite = at.g.flow(-d.u, d.t, base)
    at.close(point, other, 4, at.size(base, at.points(d.t[:, None] * d.u)))
    at.close(direction, -opposite, 16)


@identity
@given(d=drawn())
def test_area_density_measures_the_spread_of_geodesics(at: Setting, d: Drawn) -> None:
    """The distance between the ends of two geodesics at a small angle, over the angle, squared."""
    t = np.abs(d.t) + 0.1
    angle = 1e-3
    across = np.cross(d.u, np.roll(d.u, 1, axis=1) + np.array([0, 0.5, 0.25]))
    assume((np.linalg.norm(across, axis=1) > 0.05).all())
    across /= np.linalg.norm(across, axis=1)[:, None]
    ends = [at.g.flow(np.cos(a) * d.u + np.sin(a) * across, t)[0] for a in (-angle / 2, angle / 2)]
    spread = at.g.distance(*ends) / angle
    np.testing.assert_allclose(at.g.area_density(d.u, t), spread**2, rtol=2e-6 + 2e3 * 8 * at.epsilon * 5)


def random_rays(at: Setting, count: int = 500) -> tuple[Array, Array]:
    """Points within 2 of the origin, and unit directions."""
    rng = np.random.default_rng(3)
    base, u = at.points(rng.uniform(-1.1, 1.1, (count, 3))), rng.normal(size=(count, 3))
    return base, u / np.linalg.norm(u, axis=1)[:, None]


def test_the_marchers_flow_is_the_flow(at: Setting) -> None:
    base, u = random_rays(at)
    velocity = at.g.velocity(base, u)
    state = at.kernels.run("flow", np.concatenate([base, velocity], axis=1).T).T.astype(float)
    point, direction = at.g.flow(u, 1.25, base)
    size = at.size(base) * (np.cosh(1.25) if at.g.name == "h3" else 1)
    at.close(state[:, :4], point, 16, size)
    at.close(state[:, 4:], at.g.velocity(point, direction), 16, size)


def test_reproject_undoes_a_small_drift(at: Setting) -> None:
    """To second order in the drift: on the model, unit and tangent again."""
    base, u = random_rays(at)
    velocity = at.g.velocity(base, u)
    drift = 1e-4 if at.g.precision == "single" else 1e-8
    off = np.random.default_rng(6).uniform(-drift, drift, (len(base), 8))
    if at.g.name == "e3":
        off[:, [3, 7]] = 0
    state = at.kernels.run("reproject", (np.concatenate([base, velocity], axis=1) + off).T).T.astype(float)
    p, v = state[:, :4], state[:, 4:]
    form = np.array({"e3": [1, 1, 1, 0], "s3": [1, 1, 1, 1], "h3": [1, 1, 1, -1]}[at.g.name])
    curvature = {"e3": 0, "s3": 1, "h3": -1}[at.g.name]
    size = at.size(base, base) if at.g.name == "h3" else np.ones(len(base))
    bound = 16 * (drift**2 + at.epsilon) * size
    if curvature:
        assert (np.abs((form * p * p).sum(axis=1) - curvature) <= bound).all()
        assert (np.abs((form * p * v).sum(axis=1)) <= bound).all()
    assert (np.abs((form * v * v).sum(axis=1) - 1) <= bound).all()


def test_pull_undoes_velocity_and_gradients_are_pulled_back_like_pairings(at: Setting) -> None:
    base, u = random_rays(at)
    velocity = at.g.velocity(base, u)
    got = at.kernels.run("pull", np.concatenate([base, velocity], axis=1).T).T.astype(float)
    at.close(got, u, 16, at.size(base))
    covector = np.random.default_rng(8).normal(size=base.shape)
    pulled = at.kernels.run("pull_covector", np.concatenate([base, covector], axis=1).T).T.astype(float)
    at.close((pulled * u).sum(axis=1), (covector * velocity).sum(axis=1), 64, at.size(base))


def test_crossing_time_is_when_the_flow_meets_the_wall(at: Setting) -> None:
    """A wall n, a start with n . p = -a and n . v = b: the first t with b S(t) = a C(t), or never."""
    ratio = np.array([1e-3, 0.5, 0.999, 1.001, 1.5, 2.0, 30.0, 1e4]).astype(at.kernels.dtype).astype(float)
    time = at.kernels.run("crossing_time", ratio)[0].astype(float)
    behind = at.kernels.run("crossing_time", -ratio)[0].astype(float)
    if at.g.name == "s3":
        np.testing.assert_allclose(time, np.arctan2(1, ratio), rtol=4 * at.epsilon)
        np.testing.assert_allclose(behind, np.arctan2(1, -ratio), rtol=4 * at.epsilon)
        return
    assert np.isinf(behind).all() and np.isinf(at.kernels.run("crossing_time", [[0.0]])).all()
    if at.g.name == "e3":
        np.testing.assert_allclose(time, 1 / ratio, rtol=4 * at.epsilon)
    else:
        assert np.isinf(time[ratio < 1]).all() and np.isinf(at.kernels.run("crossing_time", [[1.0]])).all()
        crosses = ratio > 1
        want = 0.5 * np.log1p(2 / (ratio[crosses] - 1))
        np.testing.assert_allclose(time[crosses], want, rtol=4 * at.epsilon, atol=2 * at.epsilon)


# Seams. Each named constant at which a formula of kernels/geometry changes, and the test that walks over it.
SEAMS = {
    "CHORD_W_FROM_SUM": "test_s3_distance_over_the_equator",
    "OPPOSITE_ABOVE": "test_h3_distance_over_the_seam_of_opposite_points",
    "SPLIT_DIRECTION_ABOVE": "test_h3_directions_over_the_seam_of_the_split",
    "RADIAL_ABOVE": "test_h3_directions_far_out_stay_units_and_outward",
}


def constant(name: str, part: str) -> float:
    found = re.search(rf"^#define {name} (?:C\()?([\d.]+)\)?$", kernel_text(part), re.MULTILINE)
    assert found, f"{part} no longer names {name}"
    return float(found[1])


def test_every_named_seam_is_walked_over() -> None:
    named = set()
    for part in ("isotropic", "e3", "s3", "h3"):
        named |= set(
            re.findall(r"^#define (\w+) (?:C\()?[\d.]+\)?$", kernel_text(f"geometry/{part}.h"), re.MULTILINE)
        )
    assert named - {"CURVATURE", "HOMOGENEOUS"} == set(SEAMS)
    assert all(callable(globals()[test]) for test in SEAMS.values())


def around(threshold: float) -> Array:
    """Numbers that approach a threshold from both sides, and itself."""
    steps = 2.0 ** -np.arange(3, 40, 3)
    return threshold + np.concatenate([-steps, [0], steps]) * max(threshold, 1)


def in_precision(vectors: Array, precision: str) -> Exact:
    """Coordinates (N,3) rounded to the precision, as exact numbers."""
    return exact(cut(vectors, precision))


def check_distances(g: Geometry, p: Exact, q: Exact, allowed: Array) -> None:
    got, want = g.distance(rounded(q), rounded(p)), distance(g.name, p, q)
    errors = np.abs((exact(got) - want) / want).astype(float)
    worst = int((errors / allowed).argmax())
    assert (errors <= allowed).all(), (
        rounded(p)[worst],
        rounded(q)[worst],
        got[worst],
        errors[worst],
        allowed[worst],
    )


@pytest.mark.parametrize("precision", EPSILON)
@pytest.mark.parametrize("separation", [1e-9, 1e-6, 1e-3, 0.1, 1.0])
def test_s3_distance_over_the_equator(opencl_device: Device, precision: str, separation: float) -> None:
    """w is computed from three coordinates and rounded. While |w| is large x . dx + w dw = 0 gives its
    difference to EPSILON of the distance; nearer to the equator rounding of w itself limits us, to EPSILON
    |w|.
    """
    # In single precision the tails of the coordinates carry the difference.
    threshold = constant("CHORD_W_FROM_SUM", "geometry/s3.h")
    sums = np.concatenate([around(threshold), 2.0 ** -np.arange(3.0, 20)])
    rng = np.random.default_rng(11)
    xyz, u = rng.normal(size=(2, len(sums), 3))
    xyz *= (np.sqrt(1 - (sums / 2) ** 2) / np.linalg.norm(xyz, axis=1))[:, None]
    u *= (1 / np.linalg.norm(u, axis=1))[:, None]
    p = on_model("s3", exact(xyz))
    near = exact(np.concatenate([u * np.sin(separation), np.full((len(u), 1), np.cos(separation))], axis=1))
    q = np.array([translation("s3", a) @ b for a, b in zip(p, near, strict=True)])
    q = on_model("s3", exact(rounded(q[:, :3])), q[:, 3] > 0)
    w = p[:, 3].astype(float), q[:, 3].astype(float)
    limited = np.abs(w[0] + w[1]) <= threshold
    apart = distance("s3", p, q).astype(float)
    factor = np.where(limited, 4 + np.maximum(*np.abs(w)) / apart, 4 + 2 / threshold)
    if precision == "single":
        factor += EPSILON["single"] / apart  # a coordinate and its tail have 48 bits
    allowed = EPSILON[precision] * factor
    check_distances(geometry("s3", precision, opencl_device), p, q, allowed)


@pytest.mark.parametrize("precision", EPSILON)
def test_s3_distance_over_a_quarter_turn(opencl_device: Device, precision: str) -> None:
    """Where <p, q> changes its sign the chord changes from q - p to q + p."""
    lengths = around(np.pi / 2)
    rng = np.random.default_rng(12)
    u, base = rng.normal(size=(len(lengths), 3)), rng.uniform(-0.4, 0.4, (len(lengths), 3))
    u /= np.linalg.norm(u, axis=1)[:, None]
    p = on_model("s3", in_precision(base, precision))
    near = exact(np.concatenate([u * np.sin(lengths)[:, None], np.cos(lengths)[:, None]], axis=1))
    q = np.array([translation("s3", a) @ b for a, b in zip(p, near, strict=True)])
    q = on_model("s3", in_precision(rounded(q[:, :3]), precision), q[:, 3] > 0)
    w = np.abs(np.concatenate([p[:, 3:], q[:, 3:]], axis=1)).min(axis=1).astype(float)
    check_distances(geometry("s3", precision, opencl_device), p, q, 4 * EPSILON[precision] * (1 + 1 / w))


@pytest.mark.parametrize("precision", EPSILON)
def test_s3_translations_over_the_equator(opencl_device: Device, precision: str) -> None:
    """1/(1 + w) changes its form at w = 0."""
    g = geometry("s3", precision, opencl_device)
    w = around(0.0)
    base = np.stack([np.sqrt(1 - w**2) * 0.6, -np.sqrt(1 - w**2) * 0.8, np.zeros_like(w), w], axis=1)
    p = np.broadcast_to([0.1, 0.7, -0.1, 0.7], base.shape)
    want = np.array([translation("s3", exact(b)) @ exact(x) for b, x in zip(base, p, strict=True)])
    assert np.abs((exact(g.translate(base, p)) - want).astype(float)).max() <= 4 * EPSILON[precision]


@pytest.mark.parametrize("precision", EPSILON)
def test_h3_distance_over_the_seam_of_opposite_points(opencl_device: Device, precision: str) -> None:
    """cosh d over its threshold for points on opposite sides, and x . y through 0 for points far apart."""
    threshold = constant("OPPOSITE_ABOVE", "geometry/h3.h")
    cosh = around(threshold)
    half = np.arccosh(cosh) / 2
    axis = np.array([0.36, 0.48, -0.8])
    first, second = np.sinh(half)[:, None] * axis, -np.sinh(half)[:, None] * axis
    turn = np.pi / 2 + around(0.0)
    right = 3.0 * np.stack([np.ones_like(turn), np.zeros_like(turn), np.zeros_like(turn)], axis=1)
    turned = 5.0 * np.stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)], axis=1)
    p = on_model("h3", in_precision(np.concatenate([first, right]), precision))
    q = on_model("h3", in_precision(np.concatenate([second, turned]), precision))
    check_distances(geometry("h3", precision, opencl_device), p, q, np.full(len(p), 4 * EPSILON[precision]))


def direction_errors(g: Geometry, p: Exact, q: Exact) -> Array:
    """Angles (N,) between the direction of the geodesic from p to q and the exact one, in the frame at p."""
    got = g.geodesics(rounded(q), 1, rounded(p))[0][:, 0]
    errors = []
    for u, a, b in zip(got, p, q, strict=True):
        want = (inverse_translation(g.name, a) @ b)[:3]
        want = want / MP.sqrt((want**2).sum())
        errors.append(float(np.abs(exact(u) - want).max()))
    return np.array(errors)


@pytest.mark.parametrize("precision", EPSILON)
@pytest.mark.parametrize("separation", [1e-6, 1e-2, 1.0, 3.0])
def test_h3_directions_over_the_seam_of_the_split(
    opencl_device: Device, precision: str, separation: float
) -> None:
    """|x|^2 over its threshold."""
    threshold = constant("SPLIT_DIRECTION_ABOVE", "geometry/h3.h")
    radius = np.sqrt(around(threshold))
    rng = np.random.default_rng(13)
    x, u = rng.normal(size=(2, len(radius), 3))
    x *= (radius / np.linalg.norm(x, axis=1))[:, None]
    u *= (1 / np.linalg.norm(u, axis=1))[:, None]
    p = on_model("h3", in_precision(x, precision))
    near = exact(np.concatenate([u * np.sinh(separation), np.full((len(u), 1), np.cosh(separation))], axis=1))
    q = np.array([translation("h3", a) @ b for a, b in zip(p, near, strict=True)])
    q = on_model("h3", in_precision(rounded(q[:, :3]), precision))
    assert (direction_errors(geometry("h3", precision, opencl_device), p, q) <= 8 * EPSILON[precision]).all()


@pytest.mark.parametrize("precision", EPSILON)
@pytest.mark.parametrize("sense", [1, -1])
def test_h3_directions_far_out_stay_units_and_outward(
    opencl_device: Device, precision: str, sense: int
) -> None:
    """What a step leaves of a ray over RADIAL_ABOVE: its part along the radius and that along a coordinate
    which is 0 keep their digits, the part across is noise up to there and none beyond; so its length stays 1.
    """
    body = Body(
        8,
        4,
        "point p = POINT(0); vector v = POINT(4); reproject(&p, &v);"
        "OUT(0, v.x); OUT(1, v.y); OUT(2, v.z); OUT(3, v.w);",
    )
    kernels = SmallKernels(opencl_device, geometry_parts("h3"), {"back": body}, precision, LANES)
    seam = np.arccosh(constant("RADIAL_ABOVE", "geometry/h3.h") / EPSILON[precision])
    r = seam + np.linspace(-5, 5, 401)
    outward, level = np.array([0.8, 0.6, 0.0]), 0.6
    along = sense * np.sqrt(1 - level**2)
    p = np.column_stack([np.sinh(r)[:, None] * outward, np.cosh(r)])
    v = np.column_stack([along * np.cosh(r)[:, None] * outward, along * np.sinh(r)])
    v[:, 2] = level
    got = kernels.run("back", np.concatenate([p.T, v.T])).T.astype(np.float64)
    # The squared length of the noise across comes off the rest.
    noise = np.minimum(7 * EPSILON[precision] * np.cosh(r), 0.05)
    assert (np.abs(got[:, 3] / np.sinh(r) - along) <= noise).all()
    assert (np.abs(got[:, 2] - level) <= noise).all()
    # Beyond, for both coordinates, whatever is across comes from their own rounding.
    far = r > seam + 1
    aside = np.abs(got[:, :2] @ [-0.6, 0.8]) / np.cosh(r)
    assert (aside[far] <= 4 * EPSILON[precision]).all()


@pytest.mark.parametrize("precision", EPSILON)
def test_h3_directions_from_far_away_to_near_the_origin(opencl_device: Device, precision: str) -> None:
    """Seen from far out the neighbourhood of the origin lies straight back, on either side of it."""
    g = geometry("h3", precision, opencl_device)
    farthest = 40 if precision == "single" else 300
    for far in (2, 5, 10, 15, 17, 18, 20, 25, 30, 36, 37, 38, 40, 60, 100, 300):
        if far > farthest:
            continue
        axis = np.array([0.36, 0.48, -0.8])
        near = np.concatenate(
            [np.zeros((1, 3)), [[0.3, 0.1, 0], [-0.3, 0, 0.2], [0.1, 0.2, 0.3], [-1, 1, 0.15]]]
        )
        p = on_model("h3", in_precision(np.broadcast_to(np.sinh(far) * axis, near.shape), precision))
        got = g.geodesics(
            np.concatenate([near, np.sqrt(1 + (near**2).sum(axis=1))[:, None]], axis=1), 1, rounded(p)
        )
        backwards = -rounded(p[:, :3] / np.array([[MP.sqrt((x**2).sum())] for x in p[:, :3]]))
        # The side on which a point lies shows as an angle of the order e^-far.
        np.testing.assert_allclose(got[0][:, 0], backwards, atol=8 * EPSILON[precision] + 8 * np.exp(-far))
        assert np.isfinite(got[1]).all()


# Special positions.


def test_s3_coincident_and_antipodal_points(opencl_device: Device) -> None:
    rng = np.random.default_rng(14)
    p = rng.normal(size=(200, 4))
    p /= np.linalg.norm(p, axis=1)[:, None]
    p = np.concatenate([p, np.eye(4), -np.eye(4)])
    for precision in EPSILON:
        g = geometry("s3", precision, opencl_device)
        assert (g.distance(p, p) <= 4e-16).all()
        np.testing.assert_allclose(g.distance(-p, p), np.pi, rtol=EPSILON[precision])
        for end, lengths in ((p, (0, 2 * np.pi)), (-p, (np.pi, np.pi))):
            directions, found = g.geodesics(end, 2, p)
            np.testing.assert_allclose(
                found, np.broadcast_to(lengths, found.shape), atol=8 * EPSILON[precision]
            )
            np.testing.assert_allclose(np.linalg.norm(directions, axis=2), 1, rtol=4 * EPSILON[precision])


def test_coincident_points(at: Setting) -> None:
    base, _ = random_rays(at)
    assert (at.g.distance(base, base) == 0).all()
    directions, lengths = at.g.geodesics(base, 1, base)
    np.testing.assert_array_equal(directions[:, 0], np.broadcast_to([0.0, 0, 1], base[:, :3].shape))
    assert (lengths == 0).all()


def test_directions_are_unit_vectors_however_near_the_point(at: Setting) -> None:
    """The squares of such separations underflow."""
    apart = 10.0 ** -np.array(
        [15, 19, 20, 21, 22, 23, 25, 30, 37, 38, 40, 45, 100, 153, 155, 160, 170, 200, 300, 308, 320]
    )
    for axis in ([0.6, 0, -0.8], [0, 1, 0]):
        point = np.concatenate([apart[:, None] * axis, np.ones((len(apart), 1))], axis=1)
        directions, lengths = at.g.geodesics(point, 1)
        np.testing.assert_allclose(np.linalg.norm(directions[:, 0], axis=1), 1, rtol=4 * at.epsilon)
        # The least numbers are rounded to whole multiples of the least.
        assert (lengths[:, 0] <= 1.1 * apart + np.finfo(at.kernels.dtype).smallest_subnormal).all()
        # Well above the least number of the precision the direction is known too.
        known = apart > 100 * np.finfo(at.kernels.dtype).tiny / at.epsilon
        np.testing.assert_allclose(
            directions[known, 0], np.broadcast_to(axis, (known.sum(), 3)), atol=4 * at.epsilon
        )


def test_s3_flow_past_the_antipode_of_the_origin(opencl_device: Device) -> None:
    """Geodesics from the origin carry the frames along, so the direction stays, on either side of -origin."""
    u = np.array([0.36, 0.48, -0.8])
    for precision in EPSILON:
        g = geometry("s3", precision, opencl_device)
        near = np.concatenate([[0.0], 10.0 ** -np.arange(1.0, 13)])
        times = np.concatenate([np.pi - near, np.pi + near])
        point, direction = g.flow(u, times)
        np.testing.assert_allclose(
            direction, np.broadcast_to(u, direction.shape), rtol=16 * EPSILON[precision]
        )
        np.testing.assert_allclose(point[:, 3], np.cos(times), atol=2 * EPSILON[precision])
        assert (np.abs(point[:, :3] @ u - np.sin(times)) <= 2 * EPSILON[precision]).all()
        transport = g.transport(u, times)
        np.testing.assert_allclose(
            transport, np.broadcast_to(np.eye(3), transport.shape), atol=16 * EPSILON[precision]
        )


def test_where_a_flow_leads_another_can_start(at: Setting) -> None:
    """Rounding must not carry points off the model or directions off unit length, flow after flow."""
    rng = np.random.default_rng(15)
    base, u = random_rays(at, 2000)
    times = 0.3 if at.g.name == "h3" else 2.5
    for _ in range(30):
        base, u = at.g.flow(u, rng.uniform(-times, times, len(base)), base)
    assert np.abs(np.linalg.norm(u, axis=1) - 1).max() <= 16 * at.epsilon


def test_h3_far_points_in_single_precision_are_refused_or_right(opencl_device: Device) -> None:
    """A distance is right or an error, never silently 0 or NaN, though squares overflow beyond 44."""
    g = geometry("h3", "single", opencl_device)
    for far in (20, 30, 40, 44, 50, 60, 80, 100):
        point = np.array([np.sinh(far), 0, 0, np.cosh(far)])
        try:
            found = np.array([g.distance(point)[0], g.underestimate(point)[0]])
        except ValueError as error:
            assert "single" in str(error), error
            continue
        np.testing.assert_allclose(found, far, rtol=4 * EPSILON["single"])


# Shapes.


@pytest.mark.parametrize("count", [0, 1, LANES - 1, LANES, 3 * LANES + 5, 16 * LANES + 1])
def test_shapes_and_lane_remainders(at: Setting, count: int) -> None:
    """Any number of rows, each the same whatever stands beside it."""
    base, u = random_rays(at, 16 * LANES + 1)
    whole, _ = at.g.flow(u, 0.5, base)
    point, direction = at.g.flow(u[:count], np.full(count, 0.5), base[:count])
    assert point.shape == (count, 4) and direction.shape == (count, 3)
    assert point.dtype == direction.dtype == np.float64
    np.testing.assert_array_equal(point, whole[:count])
    assert at.g.velocity(base[:count], u[:count]).shape == (count, 4)
    assert at.g.transport(u[:count], 0.5).shape == (count, 3, 3)
    assert at.g.distance(base[:count]).shape == (count,)
    assert at.g.underestimate(base[:count]).shape == (count,)
    directions, lengths = at.g.geodesics(base[:count], 3)
    assert directions.shape == (count, 3, 3) and lengths.shape == (count, 3)
    assert at.g.area_density(u[:count], 0.5).shape == (count,)
    assert at.g.translate(base[:count], base[:count]).shape == (count, 4)
    assert at.g.untranslate(base[:count], base[:count]).shape == (count, 4)
    assert at.g.translation_matrix(base[:count]).shape == (count, 4, 4)


def test_single_rows_are_repeated(at: Setting) -> None:
    base, u = random_rays(at, 7)
    for k in range(7):
        fixed_base = at.g.flow(u, 0.5, base[k])[0]
        np.testing.assert_array_equal(fixed_base, at.g.flow(u, 0.5, np.broadcast_to(base[k], base.shape))[0])
    for one, other in zip(at.g.flow(u[0], np.full(7, 0.5), base), at.g.flow(u[0], 0.5, base), strict=True):
        np.testing.assert_array_equal(one, other)
    first = np.broadcast_to(base[0], base.shape)
    np.testing.assert_array_equal(at.g.distance(base, base[0]), at.g.distance(base, first))
    np.testing.assert_array_equal(at.g.distance(base[0], base), at.g.distance(first, base))
    assert at.g.flow(u[0], 0.5)[0].shape == (1, 4)
    np.testing.assert_array_equal(at.g.distance(base, ORIGIN), at.g.distance(base))
    np.testing.assert_array_equal(at.g.flow(u.tolist(), 0.5, base.tolist())[0], at.g.flow(u, 0.5, base)[0])


# Errors.

POINT: dict[str, list[float]] = {"e3": [1, 2, 3, 1], "s3": [0.6, 0, 0, 0.8], "h3": [0.75, 0, 0, 1.25]}
OFF: dict[str, list[float]] = {"e3": [0, 0, 0, 1.1], "s3": [0.6, 0, 0, 0.7], "h3": [0, 0.75, 0, -1.25]}
MODEL = {"e3": "w = 1", "s3": "x^2 + y^2 + z^2 + w^2 = 1", "h3": "w = sqrt(1 + x^2 + y^2 + z^2)"}
X = [1, 0, 0]


@pytest.fixture(scope="module", params=GEOMETRIES)
def g(request: pytest.FixtureRequest, opencl_device: Device) -> Geometry:
    return geometry(request.param, "single", opencl_device)


def expect(text: str) -> Any:
    return pytest.raises(ValueError, match=re.escape(text))


def test_wrong_shapes(g: Geometry) -> None:
    point = POINT[g.name]
    with expect("direction has shape (2,); expected (N, 3)"):
        g.flow([1, 0], 1.0)
    with expect("direction has shape (1, 4); expected (N, 3)"):
        g.velocity(point, [[1, 0, 0, 0]])
    with expect("point has shape (3,); expected (N, 4)"):
        g.distance([0, 0, 1])
    with expect("base has shape (1, 1, 4); expected (N, 4)"):
        g.distance(point, [[point]])
    with expect("point has shape (); expected (N, 4)"):
        g.underestimate(1.0)
    with expect("time has shape (1, 2); expected (N,) or a number"):
        g.flow(X, [[1, 2]])
    with expect("arrays of different lengths: 2, 3"):
        g.area_density([X, X], [1, 2, 3])
    with expect("arrays of different lengths: 3, 2"):
        g.translate([point] * 3, [point] * 2)


def test_directions_must_be_unit_vectors(g: Geometry) -> None:
    with expect("direction 1 has length 1.1; expected a unit vector"):
        g.flow([[1.0, 0, 0], [0, 1.1, 0]], 1.0)
    with expect("direction 0 has length 0; expected a unit vector"):
        g.transport([0, 0, 0], 1.0)
    g.area_density([1 + 9e-7, 0, 0], 1.0)
    with expect("expected a unit vector"):
        g.area_density([1 + 2e-6, 0, 0], 1.0)


def test_points_must_be_on_the_model(g: Geometry) -> None:
    off = OFF[g.name]
    text = f"1 = {[float(c) for c in off]} is off the model of {g.name}; expected {MODEL[g.name]}"
    with expect(f"point {text}"):
        g.distance([POINT[g.name], off])
    with expect(f"base {text}"):
        g.flow(X, 1.0, [POINT[g.name], off])
    with expect("point 0"):
        g.underestimate(off)
    with expect("point 0"):
        g.geodesics(off, 1)
    with expect("point 0"):
        g.translate(POINT[g.name], off)
    with expect("base 0"):
        g.untranslate(off, POINT[g.name])
    with expect("base 0"):
        g.translation_matrix(off)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_numbers_must_be_finite(g: Geometry, bad: float) -> None:
    with expect(f"direction[1, 2] is {bad}; expected a finite number"):
        g.flow([[1.0, 0, 0], [1, 0, bad]], 1.0)
    with expect(f"time[1] is {bad}; expected a finite number"):
        g.flow(X, [1.0, bad])
    with expect(f"point[0, 3] is {bad}; expected a finite number"):
        g.distance([[0, 0, 0, bad]])
    with expect(f"base[2] is {bad}; expected a finite number"):
        g.distance(POINT[g.name], [0, 0, bad, 1])


def test_geodesics_need_a_count(g: Geometry) -> None:
    with expect("count is 0; expected a whole number of at least 1"):
        g.geodesics(POINT[g.name], 0)


def test_unknown_names(opencl_device: Device) -> None:
    with pytest.raises(ValueError, match=r"unknown geometry 'E3'; expected one of: e3, s3, h3"):
        Geometry("E3", device=opencl_device)
    with expect("unknown precision 'half'; expected 'single' or 'double'"):
        Geometry("e3", "half", opencl_device)
    with expect("unknown flow 'leapfrog'; expected one of: exact, euler, rk2, rk4, rk8"):
        Geometry("e3", device=opencl_device, flow="leapfrog")
    with expect("3 lanes; expected one of: 1, 4, 8, 16, 32, 64"):
        Geometry("e3", device=opencl_device, lanes=3)
