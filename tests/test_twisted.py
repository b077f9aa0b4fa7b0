"""nil and sl2 beyond the records: walks over every change of regime from both sides, identities, and the
bound of iterations.

Inputs are numbers of the precision under test, where they matter; references have 50 digits.
"""

import re
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
import twisted
from golden import EPSILON, FLOAT, MP, Array, cut, exact, rounded
from hypothesis import given, settings
from hypothesis import strategies as st

import thurston_cl.program
from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.program import kernel_text

LANES = 16
both_precisions = pytest.mark.parametrize("precision", EPSILON)
both_geometries = pytest.mark.parametrize("geometry", twisted.ORIGIN)
# Units of EPSILON, times 1 + condition: as for the records.
FLOW_FACTOR = 3.0
AREA_FACTOR = 2.0
GEODESIC_FACTOR = 4.0

BOTH_SIDES = (-1e-1, -1e-3, -1e-5, -1e-7, -1e-10, -1e-15, 0.0, 1e-15, 1e-10, 1e-7, 1e-5, 1e-3, 1e-1)


def direction(up: float, angle: float = 0.7) -> list[float]:
    """The unit direction with this part along the fibre, the rest without cancellation."""
    across = np.sqrt((1 - abs(up)) * (1 + abs(up)))
    return [across * np.cos(angle), across * np.sin(angle), up]


def nearly_vertical(across: float, sign: float = 1.0) -> list[float]:
    return [across * 0.8, across * 0.6, sign * np.sqrt((1 - across) * (1 + across))]


def ray_walks(geometry: str, precision: str) -> dict[str, list[tuple[list[float], float]]]:
    """Directions and times that step over every change of regime of flow and area density."""
    times = [*10.0 ** np.arange(-6, 1), 3.0, 10.0]
    walks = {
        "c to 0": [
            (direction(s * c), t) for c in (0.0, 1e-30, 1e-12, 1e-6, 1e-3) for s in (1, -1) for t in times
        ],
        "a to 0": [
            (nearly_vertical(a, s), t)
            for a in (0.0, 1e-30, 1e-12, 1e-6, 1e-3)
            for s in (1, -1)
            for t in times
        ],
    }
    if geometry == "nil":
        walks["series to closed form, T = 1"] = [(direction(0.8), 2.5 * (1 + e)) for e in BOTH_SIDES]
        walks["conjugate points"] = [
            (direction(s * 0.8), 2 * np.pi * k / 0.8 * (1 + e))
            for k in (1, 2, 5)
            for e in BOTH_SIDES
            for s in (1, -1)
        ]
        walks["long"] = [(direction(c), t) for c in (-0.9, -1e-3, 0.5) for t in (30.0, 100.0, 300.0, 1000.0)]
        return walks
    null = np.sqrt(0.5)
    walks["|c| to a"] = [
        (direction(s * null * (1 + e)), t)
        for e in BOTH_SIDES
        for s in (1, -1)
        for t in (1e-3, 1.0, 4.0, 10.0)
    ]
    # kappa = 0.6 on both sides of the cone: |s| = (0.3 t)^2.
    walks["series to closed form, |s| = 1"] = [
        (direction(np.sqrt((1 + s * 0.36) / 2)), 2 / 0.6 * (1 + e)) for s in (1, -1) for e in BOTH_SIDES
    ]
    walks["conjugate points"] = [
        (direction(s * np.sqrt(0.68)), 2 * np.pi * k / 0.6 * (1 + e))
        for k in (1, 2, 5)
        for e in BOTH_SIDES
        for s in (1, -1)
    ]
    # x, y, z overflow at kappa t = 88 or 709.
    end = 85.0 if precision == "single" else 700.0
    walks["long"] = [
        *((direction(c), end / np.sqrt(1 - 2 * c * c)) for c in (0.0, 0.3, -0.6)),
        *((direction(c), t) for c in (0.8, -0.95) for t in (30.0, 100.0)),
    ]
    return walks


@both_precisions
@both_geometries
def test_flow_and_area_over_every_seam(geometry: str, precision: str, opencl_device: Device) -> None:
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    origin = exact(twisted.ORIGIN[geometry])
    for name, rays in ray_walks(geometry, precision).items():
        u, t = cut([r[0] for r in rays], precision), cut([r[1] for r in rays], precision)
        points, ends = g.flow(u, t)
        areas, turns = g.area_density(u, t), g.transport(u, t)
        for n in range(len(rays)):
            ray = (exact(u[n]), MP.mpf(float(t[n])))
            want = twisted.flow(geometry, origin, *ray)
            change = twisted.flow_sensitivity(geometry, origin, *ray)
            sizes = twisted.scales(geometry, want["point"], *ray, origin)
            for what, got in (("point", points), ("direction", ends), ("transport", turns.reshape(-1, 9))):
                size = sizes if what == "point" else 1
                off = rounded(np.abs(exact(got[n]) - want[what]) / size)
                allowed = FLOW_FACTOR * EPSILON[precision] * (1 + rounded(change[what] / size))
                assert (off <= allowed).all(), (name, what, rays[n], got[n], off, allowed)
            area = twisted.area(geometry, *ray)
            changes = twisted.area_sensitivity(geometry, *ray)
            off_area = abs(MP.mpf(float(areas[n])) - area)
            if area > np.finfo(FLOAT[precision]).max:
                assert areas[n] == np.inf, (name, rays[n])
                continue
            floor = float(np.finfo(FLOAT[precision]).tiny)
            assert off_area <= AREA_FACTOR * EPSILON[precision] * (area + changes) + floor, (
                name,
                "area",
                rays[n],
                areas[n],
            )


def geodesic_walks(geometry: str) -> dict[str, list[tuple[list[float], float]]]:
    """Directions and lengths from the origin, by the change of regime of the solver that they step over."""
    quarter, half = np.pi / 2, np.pi
    if geometry == "nil":
        walks = {
            "turn by pi/2: low to high branch": [
                (direction(s * 0.6), 2 * quarter / 0.6 * (1 + e)) for e in BOTH_SIDES for s in (1, -1)
            ],
            "T = 1: series to closed form": [(direction(0.5), 4 * (1 + e)) for e in BOTH_SIDES],
            "z to 0": [(direction(s * c), 3.0) for c in (0.0, 1e-30, 1e-12, 1e-6, 1e-3) for s in (1, -1)],
        }
    else:
        null = np.sqrt(0.5)
        walks = {
            "x = pi/2: low to high branch": [
                (direction(s * np.sqrt(0.68)), 2 * quarter / 0.6 * (1 + e))
                for e in BOTH_SIDES
                for s in (1, -1)
            ],
            "parabolic": [
                (direction(s * null * (1 + e)), t)
                for e in BOTH_SIDES
                for s in (1, -1)
                for t in (0.1, 1.0, 5.0)
            ],
            "psi or its complement": [(direction(c), 3.0) for c in np.linspace(0.6, 0.9, 40)],
            "w to 0": [(direction(s * c), 3.0) for c in (0.0, 1e-30, 1e-12, 1e-6, 1e-3) for s in (1, -1)],
        }
    near_axis = (1e-3, 1e-6, 1e-9)
    turning = 1 if geometry == "nil" else 0.999
    walks["near the fibre"] = [
        (nearly_vertical(a, s), turning * t)
        for a in near_axis
        for s in (1, -1)
        for t in (1e-3, 1.0, 3.0, 6.0)
    ]
    walks["short"] = [(direction(c), t) for c in (-0.7, 0.2, 0.99) for t in 10.0 ** np.arange(-6, 0)]
    if geometry == "nil":
        walks["before the conjugate point"] = [
            (direction(c), 2 * half / c * (1 - e)) for c in (0.3, 0.9) for e in (1e-1, 1e-2, 1e-3)
        ]
    else:
        walks["before the conjugate point"] = [
            (direction(np.sqrt((1 + k * k) / 2)), 2 * half / k * (1 - e))
            for k in (0.3, 0.9)
            for e in (1e-1, 1e-2, 1e-3)
        ]
    return walks


@pytest.mark.filterwarnings("error")
@both_precisions
@both_geometries
def test_geodesics_over_every_seam(geometry: str, precision: str, opencl_device: Device) -> None:
    """The geodesic that leads to a point is found, as the shortest. The point is known to binary64 only:
    near a conjugate point that takes digits, by length^2/area."""
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    for name, rays in geodesic_walks(geometry).items():
        u, t = exact([r[0] for r in rays]), exact([r[1] for r in rays])
        lengths = np.array([time * MP.sqrt(sum(c * c for c in v)) for v, time in zip(u, t, strict=True)])
        ends = [twisted.flow_from_origin(geometry, v, time)[0] for v, time in zip(u, t, strict=True)]
        found, length = g.geodesics(rounded(np.array(ends)), 1)
        for n, ray in enumerate(rays):
            spread = float(lengths[n] ** 2 / twisted.area(geometry, u[n], t[n]))
            size = 1 + float(max(abs(c) for c in ends[n])) / float(lengths[n])
            allowed = GEODESIC_FACTOR * (EPSILON[precision] + EPSILON["double"] * spread * size)
            unit = u[n] * t[n] / lengths[n]
            assert abs(MP.mpf(float(length[n, 0])) / lengths[n] - 1) <= allowed, (name, ray, length[n, 0])
            assert rounded(np.abs(exact(found[n, 0]) - unit)).max() <= allowed, (
                name,
                ray,
                found[n, 0],
                rounded(unit),
            )


def over_fibre(geometry: str, rho: float, heights: Sequence[float]) -> Array:
    """Points (N,4) at distance `rho` from the fibre through the origin."""
    w = np.asarray(heights, dtype=np.float64)
    x, one = np.full_like(w, rho if geometry == "nil" else np.sinh(rho)), np.ones_like(w)
    if geometry == "nil":
        return np.stack([0.6 * x, 0.8 * x, w, one], axis=1)
    return np.stack([0.6 * x, 0.8 * x, np.sqrt(1 + x * x), w], axis=1)


def circle_length(geometry: str, k: int, height: Any) -> Any:
    """Length of the circle of geodesics that turn k times to the point of the fibre at this height (paper
    9.4, 10.4)."""
    if geometry == "nil":
        return MP.sqrt(4 * k * MP.pi * (height - k * MP.pi))
    return MP.sqrt((height + 2 * k * MP.pi) ** 2 / 2 - (2 * k * MP.pi) ** 2)


@both_precisions
@both_geometries
def test_the_fibre_over_every_turn(geometry: str, precision: str, opencl_device: Device) -> None:
    """Circles appear at 2 pi k, one each time; the vertical line stays, at last the longest."""
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    resolved = EPSILON["double"] if precision == "double" else EPSILON["single"] ** 2
    turns = (
        2 * np.pi * np.array([k * (1 + e) for k in (1, 2, 3) for e in BOTH_SIDES if abs(e) > 100 * resolved])
    )
    heights = np.concatenate([[1e-6, 0.5, 3.0, 10.0, 25.0], turns])
    for sign in (1, -1):
        points = over_fibre(geometry, 0.0, sign * heights)
        u, lengths = g.geodesics(points, 5)
        for n, height in enumerate(exact(heights)):
            circles = int(height // (2 * MP.pi))
            want = [circle_length(geometry, k, height) for k in range(1, circles + 1)] + [height]
            assert np.isfinite(lengths[n]).sum() == len(want), (height, lengths[n])
            off = rounded(np.abs(exact(lengths[n, : len(want)]) / np.array(want) - 1))
            assert (off <= GEODESIC_FACTOR * EPSILON[precision]).all(), (height, off)
            np.testing.assert_array_equal(u[n, circles], [0, 0, sign])
            assert (u[n, :circles, 1] == 0).all() and (u[n, :circles, 0] > 0).all()
    zero = g.geodesics(over_fibre(geometry, 0.0, [0.0]), 2)
    np.testing.assert_array_equal(zero[0][0, 0], [0, 0, 1])
    assert zero[1][0, 0] == 0 and np.isnan(zero[1][0, 1])


@both_precisions
@both_geometries
def test_rho_to_0_is_the_fibre(geometry: str, precision: str, opencl_device: Device) -> None:
    """Off the fibre each circle parts in two, whose lengths come together there at the rate of rho."""
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    for height in (3.0, 6.2, 6.4, 10.0, 14.0):
        circles = int(height // (2 * np.pi))
        on = g.geodesics(over_fibre(geometry, 0.0, [height]), 5)[1][0]
        for rho in 10.0 ** -np.arange(3, 40, 3.0):
            lengths = g.geodesics(over_fibre(geometry, rho, [height]), 5)[1][0]
            if not circles:
                want = on[:1]
            elif rho <= 1e-19 * height and precision == "single":
                want = on[: circles + 1]
            else:
                want = np.append(np.repeat(on[:circles], 2), height)
            assert np.isfinite(lengths).sum() == len(want), (height, rho, lengths)
            allowed = 4 * rho * height + GEODESIC_FACTOR * EPSILON[precision] * height
            assert (np.abs(lengths[: len(want)] - want) <= allowed).all(), (height, rho, lengths, want)


def fold_height(geometry: str, rho: Any, k: int) -> Any:
    """The least height at this rho that geodesics with k turns reach."""
    s = rho**2 / 8 if geometry == "nil" else MP.sinh(rho / 2) ** 2

    def slope(u: Any) -> Any:
        return MP.sin(u) ** 3 + 2 * s * (MP.sin(u) - (k * MP.pi + u) * MP.cos(u))

    u = MP.findroot(slope, (MP.mpf("1e-9"), MP.pi / 2), solver="bisect", maxsteps=200, verify=False)
    x, sine = k * MP.pi + u, MP.sin(u)
    if geometry == "nil":
        return 2 * x + s * (2 * x - MP.sin(2 * x)) / sine**2
    return 4 * x * MP.sqrt(1 + s / sine**2) - 2 * (k * MP.pi + MP.atan2(MP.sqrt(s + sine**2), MP.cos(u)))


@pytest.mark.filterwarnings("error")
@both_precisions
@both_geometries
def test_pairs_appear_at_the_folds(geometry: str, precision: str, opencl_device: Device) -> None:
    """Below the fold of interval k there are 2 k - 1 geodesics, above it two more, equally long to first
    order."""
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    steps = (1e-2, 1e-4, 1e-5) if precision == "single" else (1e-2, 1e-6, 1e-10, 1e-13)
    for rho in (1e-3, 0.1, 1.0, 4.0):
        for k in (1, 2, 3):
            height = float(fold_height(geometry, MP.mpf(rho), k))
            for e in steps:
                u, lengths = g.geodesics(
                    over_fibre(geometry, rho, [height * (1 - e), height * (1 + e)]), 2 * k + 1
                )
                assert np.isfinite(lengths).sum(axis=1).tolist() == [2 * k - 1, 2 * k + 1], (rho, k, e)
                apart, units = lengths[1, -1] - lengths[1, -2], GEODESIC_FACTOR * EPSILON[precision] * height
                assert -units <= apart <= 4 * e * height + units, (rho, k, e, lengths[1])
                ends, _ = g.flow(u[1], lengths[1])
                want = over_fibre(geometry, rho, [height * (1 + e)])
                # The two directions differ by the root of the distance to the fold, and so do their errors.
                allowed = 64 * EPSILON[precision] * np.abs(want).max() * np.abs(want).max() / rho
                assert np.abs(ends - want).max() <= allowed, (rho, k, e, ends, want)


def random_points(geometry: str, n: int, rng: np.random.Generator) -> Array:
    """Points (8 n,4) in every corner that starting values are chosen for."""
    turn = rng.integers(1, 4, n) * 2 * np.pi + 10 ** rng.uniform(-8, 0, n) * rng.choice([-1, 1], n)
    middle = rng.uniform(0.01, 8, n)
    seam = np.pi * (1 + middle**2 / 8) if geometry == "nil" else 2 * np.pi * np.cosh(middle / 2) - np.pi
    rho_height = [
        (rng.uniform(0, 8, n), rng.uniform(-40, 40, n)),
        (10 ** rng.uniform(-12, -1, n), rng.uniform(-40, 40, n)),
        (10 ** rng.uniform(-17, -1, n), turn),
        (10 ** rng.uniform(-9, -1, n), 10 ** rng.uniform(-9, -1, n)),
        (10 ** rng.uniform(0, 1, n), 10 ** rng.uniform(0, 5, n)),
        (10 ** rng.uniform(-3, 1, n), 10 ** rng.uniform(-30, -1, n)),
        (rng.uniform(8, 30, n), 10 ** rng.uniform(-3, 12, n)),
        (middle, seam * (1 + 10 ** rng.uniform(-16, -1, n) * rng.choice([-1, 1], n))),
    ]
    rho, height = (np.concatenate(part) for part in zip(*rho_height, strict=True))
    angle = rng.uniform(0, 2 * np.pi, len(rho))
    r = rho if geometry == "nil" else np.sinh(rho)
    x, y = r * np.cos(angle), r * np.sin(angle)
    if geometry == "nil":
        return np.stack([x, y, height, np.ones_like(x)], axis=1)
    return np.stack([x, y, np.sqrt(1 + x * x + y * y), height], axis=1)


def with_bound(bound: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let programs built from now on stop each solve after so many iterations."""
    text = re.sub(
        r"#define NEWTON_BOUND \d+", f"#define NEWTON_BOUND {bound}", kernel_text("special/newton.h")
    )
    monkeypatch.setattr(
        thurston_cl.program,
        "kernel_text",
        lambda part: text if part == "special/newton.h" else kernel_text(part),
    )


@both_precisions
@both_geometries
def test_the_bound_of_iterations_is_far_from_what_is_needed(
    geometry: str, precision: str, opencl_device: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What newton.h states suffices for points in every corner; its bounds leave twice as many."""
    stated = re.search(r"sees is (\d+)\.", kernel_text("special/newton.h"))
    assert stated is not None
    with_bound(int(stated[1]), monkeypatch)
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    points = random_points(geometry, 5000, np.random.default_rng(11))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        g.distance(points)
        _, lengths = g.geodesics(points, 7)
    assert np.isfinite(lengths[:, 0]).all()
    assert (
        (np.diff(lengths, axis=1) >= -8 * EPSILON[precision] * lengths[:, 1:]) | np.isnan(lengths[:, 1:])
    ).all()


@both_precisions
@both_geometries
def test_reaching_the_bound_is_counted_and_said(
    geometry: str, precision: str, opencl_device: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_bound(1, monkeypatch)
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    points = over_fibre(geometry, 2.0, [1.0, 5.0, 20.0])
    with pytest.warns(RuntimeWarning, match=r"distance: 3 of 3 solves reached the iteration bound"):
        g.distance(points)
    with pytest.warns(RuntimeWarning, match=r"geodesics: \d of 6 solves reached the iteration bound"):
        g.geodesics(points, 2)


# Identities: points from coordinates on the base and the fibre, times both ways.
coordinate = st.floats(-2.0, 2.0)
drawn_point = st.tuples(coordinate, coordinate, st.floats(-12.0, 12.0))
drawn_direction = st.tuples(st.floats(-1.0, 1.0), st.floats(0.0, 2 * np.pi))
identity = settings(max_examples=40)


def point(geometry: str, xyw: tuple[float, float, float]) -> Array:
    x, y, w = xyw
    return np.array([x, y, w, 1.0] if geometry == "nil" else [x, y, np.sqrt(1 + x * x + y * y), w])


def nearness(geometry: str, got: Array, want: Array) -> float:
    """The largest difference of coordinates, relative to the largest or 1."""
    return float(np.abs(got - want).max() / max(1.0, np.abs(want).max()))


@identity
@given(up=drawn_direction, p=drawn_point, s=st.floats(-2.0, 2.0), t=st.floats(-2.0, 2.0))
@both_precisions
@both_geometries
def test_flows_add_up(
    geometry: str, precision: str, up: Any, p: Any, s: float, t: float, opencl_device: Device
) -> None:
    """flow(s), flow(t) is flow(s + t); transports compose and carry the direction along; flow(0) is
    nothing."""
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    base, u = point(geometry, p), np.array([direction(*up)])
    middle, ahead = g.flow(u, s, base)
    got, last = g.flow(ahead, t, middle)
    want, expected = g.flow(u, s + t, base)
    units = 200 * EPSILON[precision]
    assert nearness(geometry, got, want) <= units * (1 + np.abs(base).max())
    assert np.abs(last - expected).max() <= units
    turn = g.transport(u, s + t)[0]
    assert np.abs(turn @ u[0] - expected[0]).max() <= units
    assert np.abs(turn @ turn.T - np.eye(3)).max() <= units
    assert np.abs(g.transport(ahead, t)[0] @ g.transport(u, s)[0] - turn).max() <= units
    still, same = g.flow(u, 0.0, base)
    assert nearness(geometry, still[0], base) <= 4 * EPSILON[precision]
    assert np.abs(same - u).max() <= EPSILON[precision]


@identity
@given(a=drawn_point, b=drawn_point, c=drawn_point)
@both_precisions
@both_geometries
def test_distance_is_a_metric_that_translations_keep(
    geometry: str, precision: str, a: Any, b: Any, c: Any, opencl_device: Device
) -> None:
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    p, q, r = (point(geometry, xyw) for xyw in (a, b, c))
    units = 64 * EPSILON[precision] * (1 + np.abs([p, q, r]).max() ** 2)
    there = g.distance(q, p)[0]
    assert abs(g.distance(p, q)[0] - there) <= 8 * EPSILON[precision] * (
        there + EPSILON[precision] * np.abs([p, q]).max()
    )
    assert g.distance(p, p)[0] == 0
    assert there <= g.distance(r, p)[0] + g.distance(q, r)[0] + units
    moved = g.distance(g.translate(r, q), g.translate(r, p))[0]
    assert abs(moved - there) <= units * (1 + 1 / max(there, 1e-3))
    back = g.untranslate(r, g.translate(r, p))[0]
    assert nearness(geometry, back, p) <= units
    assert nearness(geometry, g.translate(r, np.array(twisted.ORIGIN[geometry]))[0], r) <= EPSILON[precision]


@identity
@given(a=drawn_point, b=drawn_point)
@both_precisions
@both_geometries
def test_geodesics_arrive_in_order_and_no_bound_is_above(
    geometry: str, precision: str, a: Any, b: Any, opencl_device: Device
) -> None:
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    p, q = point(geometry, a), point(geometry, b)
    u, lengths = g.geodesics(q, 5, p)
    found = np.isfinite(lengths[0])
    assert found[0] and (np.diff(found.astype(int)) <= 0).all()
    assert (np.diff(lengths[0][found]) >= -GEODESIC_FACTOR * EPSILON[precision] * lengths[0][found][1:]).all()
    ends, _ = g.flow(u[0][found], lengths[0][found], np.broadcast_to(p, (int(found.sum()), 4)))
    for end in ends:
        assert nearness(geometry, end, q) <= 400 * EPSILON[precision] * (1 + np.abs([p, q]).max() ** 2)
    assert g.underestimate(q)[0] <= g.distance(q)[0] * (1 + 4 * EPSILON[precision])


@both_precisions
@both_geometries
def test_the_underestimate_is_sharp(geometry: str, precision: str, opencl_device: Device) -> None:
    """Never above the distance, equal to it on the horizontal plane and near it elsewhere: at least 0.7
    of it."""
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    rng = np.random.default_rng(2)
    points = random_points(geometry, 2000, rng)
    ratio = g.underestimate(points) / g.distance(points)
    assert ratio.max() <= 1 + 4 * EPSILON[precision]
    assert ratio.min() >= 0.7
    flat = over_fibre(geometry, 2.0, [0.0])
    assert abs(g.underestimate(flat)[0] / 2 - 1) <= 4 * EPSILON[precision]
    assert g.underestimate(twisted.ORIGIN[geometry])[0] == 0


@both_precisions
@both_geometries
def test_velocity_is_the_derivative_of_the_flow(geometry: str, precision: str, opencl_device: Device) -> None:
    """Against a difference of the 50-digit flow, at points off the origin."""
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    rng = np.random.default_rng(4)
    step = MP.mpf(10) ** -20
    for _ in range(20):
        xyw = rng.uniform(-2, 2, 3)
        u = cut(direction(*rng.uniform(-0.9, 0.9, 2)), precision)
        base = twisted.lift(geometry, exact(cut(xyw, precision)))
        moved = twisted.multiply(geometry, base, twisted.flow_from_origin(geometry, exact(u), step)[0])
        want = rounded((moved - base) / step)
        got = g.velocity(rounded(base), u)[0]
        assert np.abs(got - want).max() <= 8 * EPSILON[precision] * (1 + np.abs(rounded(base)).max())


@both_geometries
def test_points_off_the_model_and_directions_that_are_not_unit_are_refused(
    geometry: str, opencl_device: Device
) -> None:
    g = Geometry(geometry, "double", opencl_device, lanes=LANES)
    with pytest.raises(ValueError, match=f"off the model of {geometry}"):
        g.distance([0.5, 0.5, 0.5, 0.5])
    with pytest.raises(ValueError, match="expected a unit vector"):
        g.flow([1.0, 1.0, 0.0], 1.0)
    with pytest.raises(ValueError, match="count is 0"):
        g.geodesics(twisted.ORIGIN[geometry], 0)


@both_precisions
@both_geometries
def test_only_the_fraction_of_a_turn_counts(geometry: str, precision: str, opencl_device: Device) -> None:
    """Along a long geodesic the direction keeps its digits: half the angle and the time have two parts.

    Directions are numbers of the precision; times are not, and their tails are used.
    """
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    times = np.linspace(90.1, 999.9, 50) if geometry == "nil" else np.linspace(20.1, 99.9, 50)
    u = cut(np.broadcast_to(direction(-0.83), (50, 3)), precision)
    _, ends = g.flow(u, times)
    for n, t in enumerate(times):
        want = twisted.flow_from_origin(geometry, exact(u[n]), MP.mpf(float(t)))[1]
        assert rounded(np.abs(exact(ends[n]) - want)).max() <= 2 * EPSILON[precision], (t, ends[n])
