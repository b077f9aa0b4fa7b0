"""The geodesics between two points of Sol (kernels/geometry/sol_geodesics.h): every solve succeeds, and the
shortest arrives; distance is a metric that isometries keep; lists of further ones are complete and in order.

Points are ends of geodesics of known length, not longer than a period, which then are the shortest
(Coiculescu and Schwartz), by the flow in double precision, which tests/test_golden_sol.py holds to 25 digits.
`pytest -s` prints the largest errors, in units of EPSILON.
"""

import functools
import re
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sol
from golden import EPSILON, MP, Array, constant, cut
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import ellipe, ellipeinc, ellipkinc, ellipkm1
from small_kernels import Body, SmallKernels

import thurston_cl.program
from thurston_cl.device import Device
from thurston_cl.geometry import SOL_HEIGHT_LIMIT, Geometry
from thurston_cl.program import geometry_parts, kernel_text

LANES = 16
PART = "geometry/sol_geodesics.h"
both_precisions = pytest.mark.parametrize("precision", EPSILON)


def geometry(precision: str, device: Device) -> Geometry:
    return Geometry("sol", precision, device, lanes=LANES)


def unit(u: Any) -> Array:
    v = np.asarray(u, dtype=np.float64)
    return v / np.linalg.norm(v, axis=1, keepdims=True)


# -- the shortest --------------------------------------------------------------------------------------------


def sets(n: int) -> dict[str, tuple[Array, Array]]:
    """Directions (n,3) and lengths, a period at most, by what is hard about their ends."""
    rng = np.random.default_rng(3)
    u = unit(rng.normal(size=(n, 3)))
    period = sol.periods(u)
    part = period * rng.uniform(0.02, 0.999, n)
    small, other = 10 ** rng.uniform(-12, -1, (2, n))
    one, none = np.ones(n), np.zeros(n)
    long = np.where(period > 8, np.minimum(rng.uniform(8, 14, n), period * 0.999), part)
    found = {
        "random": (u, np.minimum(rng.uniform(0.1, 8, n), part)),
        "far": (u, long),
        "short": (u, 10 ** rng.uniform(-6, -1, n)),
        "next to the cut locus": (u, period * (1 - 10 ** rng.uniform(-10, -1, n))),
        "on the cut locus": (u, period),
    }
    for name, scales in {
        "next to y = 0": (one, small, one),
        "next to x = 0": (small, one, one),
        "next to the axis": (small, other, one),
        "c to 0": (one, one, small),
        "y = 0": (one, none, one),
        "x = 0": (none, one, one),
        "c = 0": (one, one, none),
        "x = y = 0": (none, none, one),
    }.items():
        v = unit(u * np.stack(scales, axis=1))
        with np.errstate(divide="ignore"):
            lengths = np.minimum(rng.uniform(0.1, 8, n), sol.periods(v) * rng.uniform(0.02, 0.999, n))
        found[name] = v, lengths
    near = straight(rng, n, -3)
    found["next to straight lines"] = near, np.minimum(rng.uniform(1e-3, 4.4, n), sol.periods(near) * 0.999)
    near = near[: n // 4]
    found["and to their ends"] = near, sol.periods(near) * (1 - 10 ** rng.uniform(-8, -1, len(near)))
    found = {name: (v[t < 14], t[t < 14]) for name, (v, t) in found.items()}
    for low, high in ((14, 20), (20, 30)):
        v = unit(u * np.stack([one, 10 ** rng.uniform(-12, -8, n), one], axis=1))
        found[f"{low} to {high}"] = v, rng.uniform(low, high, n)
    return found


def straight(rng: np.random.Generator, n: int, least: float) -> Array:
    """Directions at 10^least to 0.1 from a = b, c = 0."""
    angle, small = rng.uniform(0, 2 * np.pi, n), 10 ** rng.uniform(least, -1, n)
    across = small * np.cos(angle)
    return unit(np.stack([np.sqrt(0.5) + across, np.sqrt(0.5) - across, small * np.sin(angle)], axis=1))


HARD = sets(2000) | {"random": sets(10_000)["random"]}
# The largest error of a length, of 99 of 100 directions, and of the end that direction and length lead to.
STATED = {"single": (5.0, 4.0, 7.0), "double": (8.0, 18.0, 8.0)}
STATED_WHERE: dict[tuple[str, str], tuple[float, float, float]] = {
    ("single", "far"): (4.0, 6.0, 6.0),
    ("double", "far"): (5.0, 30.0, 6.0),
    ("single", "next to the cut locus"): (5.0, 150.0, 7.0),
    ("double", "next to the cut locus"): (7.0, 1700.0, 7.0),
    ("single", "on the cut locus"): (5.0, 200.0, 7.0),
    ("double", "on the cut locus"): (7.0, 200.0, 7.0),
    # Two geodesics fuse there: half of the digits of a direction are lost.
    ("single", "and to their ends"): (4.0, 3000.0, 4.0),
    ("double", "and to their ends"): (5.0, 2e6, 5.0),
    ("single", "14 to 20"): (5.0, 4.0, 35.0),
    ("double", "14 to 20"): (5.0, 4.0, 40.0),
    ("single", "20 to 30"): (5.0, 40.0, 80.0),
    ("double", "20 to 30"): (5.0, 40.0, 90.0),
}


@both_precisions
@pytest.mark.parametrize("name", HARD)
def test_every_solve_succeeds(name: str, precision: str, opencl_device: Device) -> None:
    u, t = HARD[name]
    exact, g, epsilon = (
        geometry("double", opencl_device),
        geometry(precision, opencl_device),
        EPSILON[precision],
    )
    points, _ = exact.flow(u, t)
    if name == "on the cut locus":
        points[:, 2] = 0
    if name in ("x = 0", "y = 0"):
        assert (points[:, int(name == "y = 0")] == 0).all()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        length = g.distance(points)
        found, lengths = g.geodesics(points, 1)
        back = g.distance(np.array([0.0, 0, 0, 1]), points)
    np.testing.assert_array_equal(lengths[:, 0], length)
    off = np.abs(length / t - 1) / epsilon
    turned = np.abs(found[:, 0] - u).max(axis=1)
    if name == "on the cut locus":
        turned = np.minimum(turned, np.abs(found[:, 0] - u * [1, 1, -1]).max(axis=1))
    arrived = sol.errors(points, exact.flow(unit(found[:, 0]), length)[0]) / epsilon
    worst = off.max(), np.quantile(turned, 0.99) / epsilon, arrived.max()
    print(f"{precision} {name:24} length {worst[0]:8.1f} direction {worst[1]:8.1f} end {worst[2]:8.1f}")
    stated = STATED_WHERE.get((precision, name), STATED[precision])
    assert (np.array(worst) <= 1.5 * np.array(stated)).all(), worst
    assert np.abs(back / length - 1).max() <= 12 * epsilon, np.abs(back / length - 1).max() / epsilon
    assert np.abs((found[:, 0] ** 2).sum(axis=1) - 1).max() <= 4 * epsilon


@both_precisions
def test_along_straight_lines(precision: str, opencl_device: Device) -> None:
    """On the diagonals x = y, z = 0, and nearer to them than rounding, up to half a period: sqrt 2 x."""
    g, rng = geometry(precision, opencl_device), np.random.default_rng(8)
    x = cut(10 ** rng.uniform(-6, 0.49, 2000), precision)
    for heights in (0.0, 10 ** rng.uniform(-26 if precision == "single" else -170, -15, 2000)):
        points = np.stack([x, x, x * heights, np.ones(2000)], axis=1)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            u, lengths = g.geodesics(points, 1)
        off = np.abs(lengths[:, 0] / np.hypot(np.sqrt(2) * x, points[:, 2]) - 1)
        assert off.max() <= 8 * EPSILON[precision], (off.max() / EPSILON[precision], x[off.argmax()])
        assert np.abs(u[:, 0] - [np.sqrt(0.5), np.sqrt(0.5), 0]).max() <= 16 * EPSILON[precision]


@both_precisions
def test_past_the_end_of_a_straight_line_two_others_are_shorter(
    precision: str, opencl_device: Device
) -> None:
    """From x = pi on, where the line x = y, z = 0 is a period long: by 2/3 of the square of what is past."""
    g = geometry(precision, opencl_device)
    past = np.array([-0.1, -1e-3, -1e-5, 1e-5, 1e-3, 1e-2])
    x = np.pi * (1 + past)
    length = g.distance(np.stack([x, x, 0 * x, 1 + 0 * x], axis=1))
    less = np.where(past > 0, 2 / 3 * past**2, 0)
    # The next order is the cube.
    assert (np.abs(length / (np.sqrt(2) * x) - 1 + less) <= 8 * EPSILON[precision] + 3 * less * past).all()


def relative_to_each(got: Any, want: Array) -> float:
    """The largest relative error of a coordinate."""
    return max(
        abs(float(g / MP.mpf(float(w)) - 1)) if w else abs(float(g)) for g, w in zip(got, want, strict=True)
    )


def arrive_by_each_coordinate(precision: str, points: Array, device: Device) -> None:
    """Direction and length lead to each coordinate of the points with its own digits, by long arithmetic."""
    g, worst = geometry(precision, device), 0.0
    u, lengths = g.geodesics(points, 1)
    np.testing.assert_array_equal(g.distance(points), lengths[:, 0])
    for point, ray, length in zip(points, u[:, 0], lengths[:, 0], strict=True):
        off = relative_to_each(sol.flow(ray, length).point, point[:3])
        worst = max(worst, off)
        assert off <= AXIS_AND_PLANES[precision], (point, ray, length, off)
    print(f"{precision} {worst:.1e}")


@both_precisions
def test_next_to_the_axis(precision: str, opencl_device: Device) -> None:
    """AXIS_BELOW, in x e^(-z/2), from both sides; on the axis, and with y = 0."""
    axis, points = constant(PART, "AXIS_BELOW", precision), []
    for e in (-0.5, -1e-3, 1e-3, 0.5):
        for z in (0.0, 0.7, -2.5):
            across = axis * (1 + e) * np.exp(abs(z) / 2)
            points += [(across, other * across, z) for other in (0.9 * np.exp(-abs(z)), 1e-3, 0.0)]
            points += [(other * across, across, z) for other in (0.9 * np.exp(-abs(z)), 1e-3)]
            points += [(1e-3 * across, 0.0, z), (0.0, 0.0, z)]
    arrive_by_each_coordinate(precision, cut([(*p, 1.0) for p in points], precision), opencl_device)


@both_precisions
def test_next_to_the_planes(precision: str, opencl_device: Device) -> None:
    """PLANAR_BELOW squared, in 8 a b cosh(length), that is (k' e^v)^2, from both sides; y down to nothing."""
    found = re.findall(r"#define PLANAR_BELOW ([\d.e-]+)", kernel_text("geometry/sol_phase.h"))
    values = [float(value) for value in found]
    seam, points = values[0 if precision == "double" else 1] ** 2, []
    for a, c in ((0.6, 0.8), (0.6, -0.8), (1.0, 0.0)):
        for length in (0.01, 0.5, 3.0, 8.0):
            for share in (0.5, 1 - 1e-3, 1 + 1e-3, 2.0, 1e-6, 1e-12):
                b = share * seam / (8 * a * np.cosh(length))
                for ray in ((a, b, c), (b, -a, -c)):
                    points.append([*(float(x) for x in sol.flow(ray, length).point), 1.0])
    points += [(3.0, tiny, 0.5, 1.0) for tiny in (1e-36, 0.0)]
    arrive_by_each_coordinate(precision, cut(points, precision), opencl_device)


AXIS_AND_PLANES = {"single": 1.3e-5, "double": 1.2e-13}


# -- identities ----------------------------------------------------------------------------------------------

coordinate = st.one_of(st.floats(-4, 4), st.floats(-8, 0).map(lambda p: 10.0**p), st.just(0.0))
drawn_point = st.tuples(coordinate, coordinate, st.floats(-2, 2))
identity = settings(max_examples=60)


def point(xyz: Any) -> Array:
    return np.array([*xyz, 1.0])


@identity
@given(a=drawn_point, b=drawn_point, c=drawn_point)
@both_precisions
def test_distance_is_a_metric(precision: str, a: Any, b: Any, c: Any, opencl_device: Device) -> None:
    """Symmetric, with the triangle inequality; kept by translations."""
    g, epsilon = geometry(precision, opencl_device), EPSILON[precision]
    p, q, r = point(a), point(b), point(c)
    there = g.distance(q, p)[0]
    # Differences of coordinates keep their digits, but the factors e^z are rounded.
    units = 24 * epsilon * (1 + np.abs([p, q, r]).max())
    assert abs(g.distance(p, q)[0] - there) <= 16 * epsilon * there
    assert g.distance(p, p)[0] == 0
    assert there <= g.distance(r, p)[0] + g.distance(q, r)[0] + units
    moved = g.distance(g.translate(r, q), g.translate(r, p))[0]
    assert abs(moved - there) <= 64 * units


@identity
@given(a=drawn_point)
@both_precisions
def test_symmetries(precision: str, a: Any, opencl_device: Device) -> None:
    """Reflections change nothing but signs; (x, y, z) -> (y, x, -z) and p -> p^-1 keep the distance."""
    g, p = geometry(precision, opencl_device), point(a)
    u, lengths = g.geodesics(p, 3)
    for signs in ((-1, 1, 1), (1, -1, 1), (-1, -1, 1)):
        v, others = g.geodesics(p * (*signs, 1), 3)
        np.testing.assert_array_equal(others, lengths)
        np.testing.assert_array_equal(v, u * signs + 0.0)
    others = np.array([[a[1], a[0], -a[2], 1.0], g.untranslate(p, point((0, 0, 0)))[0]])
    assert (
        np.abs(g.distance(others) - lengths[0, 0])
        <= 16 * EPSILON[precision] * (lengths[0, 0] + np.abs(p).max())
    ).all()


@identity
@given(a=drawn_point, b=drawn_point)
@both_precisions
def test_the_shortest_arrives_from_anywhere(precision: str, a: Any, b: Any, opencl_device: Device) -> None:
    g = geometry(precision, opencl_device)
    p, q = point(a), point(b)
    u, lengths = g.geodesics(q, 1, p)
    end, _ = g.flow(u[:, 0], lengths[:, 0], p)
    there, wanted = (g.untranslate(p, x) for x in (end, q))
    # Coordinates of the base are lost digits of the difference.
    units = 64 * EPSILON[precision] * (1 + np.exp(abs(a[2])) * np.abs([p, q]).max())
    assert sol.errors(wanted, there)[0] <= units


@both_precisions
def test_a_length_is_as_exact_as_the_square_of_the_tolerance(precision: str, opencl_device: Device) -> None:
    """LENGTH_TOLERANCE, at which lengths alone are done, and DIRECTION_TOLERANCE agree to rounding."""
    body = Body(
        4,
        3,
        "point p = POINT(0), zero = scale_4(p, REAL(0)); mask unsolved;"
        "OUT(0, origin_distance(p)); OUT(1, distance_between(origin(), p, zero, zero, &unsolved));"
        "OUT(2, connect(p.x, p.y, p.z, 0, REAL(LENGTH_TOLERANCE)).u.z);",
    )
    kernels = SmallKernels(opencl_device, geometry_parts("sol"), {"both": body}, precision, LANES)
    points = np.concatenate([geometry("double", opencl_device).flow(*rays)[0] for rays in HARD.values()])
    points = points[np.abs(points[:, :3]).max(axis=1) < 1e6]
    early, late, up = kernels.run("both", points.T).astype(float)
    off = np.abs(early - late) / late / EPSILON[precision]
    print(f"{precision} {off.max():.1f}")
    assert np.nanmax(off) <= 8 and np.isfinite(up).mean() > 0.99


# -- further ones --------------------------------------------------------------------------------------------


def far_points(n: int, least: float = 1.5, most: float = 6.0) -> Array:
    """Points (n,4) to which most often several geodesics lead: X and Y from e^least to e^most."""
    rng = np.random.default_rng(5)
    x, y = np.exp(rng.uniform(least, most, (2, n))) * rng.choice([-1, 1], (2, n))
    z = 10 ** rng.uniform(-2.5, 0.7, n) * rng.choice([-1, 1], n)
    return np.stack([x * np.exp(z / 2), y * np.exp(-z / 2), z, np.ones(n)], axis=1)


LISTS = 33


@functools.cache
def far_lists(precision: str, device: Device) -> tuple[Array, Array, Array]:
    points = far_points(2500)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return points, *geometry(precision, device).geodesics(points, LISTS)


# Error of the ends of those on the lists, in units of EPSILON.
LIST_ENDS = {"single": 28.0, "double": 20.0}


@both_precisions
def test_lists_arrive_and_are_in_order(precision: str, opencl_device: Device) -> None:
    """Each ends at its point; lengths do not decrease, nor do the numbers of whole periods: all with n are
    shorter than those with n + 1, as they are enumerated. Past the first there are 0, 2 or 4 with each."""
    points, u, lengths = far_lists(precision, opencl_device)
    known = np.isfinite(lengths)
    counts = known.sum(axis=1)
    assert counts.min() >= 1 and (counts % 2 == 1).all()
    assert all(known[n, :count].all() for n, count in enumerate(counts))
    item, place = np.nonzero(known)
    ray, length = unit(u[item, place]), lengths[item, place]
    off = (
        sol.errors(points[item], geometry("double", opencl_device).flow(ray, length)[0]) / EPSILON[precision]
    )
    print(f"{precision}: {known.sum()} geodesics, ends {off.max():.1f}")
    assert off.max() <= 2 * LIST_ENDS[precision]
    steps = np.diff(lengths, axis=1)
    assert np.nanmin(steps / lengths[:, 1:]) >= -4 * EPSILON[precision]
    windings = np.full(lengths.shape, np.nan)
    windings[item, place] = np.floor(length / sol.periods(ray) + 1e-6 * (length / sol.periods(ray) % 1 > 0.5))
    assert np.nanmin(np.diff(windings, axis=1)) >= 0 and (windings[:, 0] == 0).all()
    for n in range(1, 6):
        complete = counts < LISTS
        assert set((windings[complete] == n).sum(axis=1)) <= {0, 2, 4}
    jumps = steps[np.diff(windings, axis=1) > 0] / lengths[:, 1:][np.diff(windings, axis=1) > 0]
    print(
        f"{precision}: least jump of length from n to n + 1 periods {jumps.min():.1e} of it, of {jumps.size}"
    )
    assert jumps.size >= 2000


def on_the_conic(target: Array, n: int, grid: Array) -> list[Array]:
    """What geodesics with n whole periods cover too much, 2 b (Y - y), on both parts of the conic, over
    r = b/a: by SciPy's elliptic integrals, as in sol-distance.md, sections 1 and 2."""
    x, y, z = abs(target[0]), abs(target[1]), target[2]
    values = []
    for part in (0, 1):
        share = np.exp(-grid)
        r, d = (
            (x / y / (1 + share), x * share / (1 + share)) if part == 0 else (x / y * (1 + share), -x * share)
        )
        e = np.expm1(2 * z) * (1 - (r * np.exp(-z)) ** 2) / d
        c, c_end = (d + e) / 2, (e - d) / 2
        a = 1 / np.sqrt(1 + r * r + c * c)
        m = a * a * r
        mu, square = np.sqrt(1 + 2 * m), np.clip((1 - 2 * m) / (1 + 2 * m), 0, 1)
        first = np.arctan2(-c, 1 - r)
        last = np.arctan2(-c_end, np.exp(z) - r * np.exp(-z))
        last = np.where(last <= first, last + 2 * np.pi, last)
        length = ellipkinc(last, square) - ellipkinc(first, square) + 4 * n * ellipkm1(4 * m / mu**2)
        second = ellipeinc(last, square) - ellipeinc(first, square) + 4 * n * ellipe(square)
        values.append(mu * (second - 2 * m / (1 + 2 * m) * length) - a * (x + r * y))
    return values


def test_a_scan_of_the_conic_finds_as_many(opencl_device: Device) -> None:
    """And with n > 0 a single minimum on either part, where it is not flat."""
    points, u, lengths = far_lists("double", opencl_device)
    grid, found = np.linspace(-30, 30, 3001), 0
    for target, rays, row in zip(points[:60], u, lengths, strict=False):
        known = np.isfinite(row)
        windings = np.floor(row[known] / sol.periods(rays[known]) + 1e-9)
        for n in range(4):
            if known.all() and n >= windings[-1]:
                continue
            with np.errstate(all="ignore"):
                parts = on_the_conic(target, n, grid)
            crossings = 0
            for values in parts:
                values = values[np.isfinite(values)]
                crossings += int((np.diff(np.sign(values)) != 0).sum())
                rising = np.sign(np.diff(values))
                dips = (rising[:-1] < 0) & (rising[1:] > 0) & (values[1:-1] < 3.5 * n)
                assert dips.sum() <= 1 or n == 0, (target, n)
            assert crossings == (windings == n).sum(), (target, n, row)
            found += crossings
    assert found > 300


def test_brute_force_finds_no_others(opencl_device: Device) -> None:
    """Many directions, followed closely; what comes near is led to the point by Newton's method."""
    g = geometry("double", opencl_device)
    targets = np.array([[11.6043944, 10.1230545, 0.791313827, 1], [7.3, -6.1, 0.2, 1], [2.0, 1.5, -0.7, 1]])
    longest = 12.5
    n = 40_000
    # Fibonacci's points on the sphere.
    up = 1 - (2 * np.arange(n) + 1) / n
    angle = np.arange(n) * np.pi * (3 - np.sqrt(5))
    sphere = np.stack(
        [np.sqrt(1 - up * up) * np.cos(angle), np.sqrt(1 - up * up) * np.sin(angle), up], axis=1
    )
    times = np.linspace(0.2, longest, 50)
    near: list[list[Array]] = [[] for _ in targets]
    for t in times:
        reached = g.flow(sphere, t)[0]
        for k, target in enumerate(targets):
            off = sol.errors(np.broadcast_to(target, reached.shape), reached)
            near[k] += [t * sphere[i] for i in np.argsort(off)[:60]]
    for target, starts in zip(targets, near, strict=True):
        solutions = led_to(g, target, np.array(starts))
        solutions = solutions[np.linalg.norm(solutions, axis=1) < longest]
        u, lengths = g.geodesics(target, 12)
        listed = (u[0] * lengths[0][:, None])[lengths[0] < longest]
        apart = np.linalg.norm(solutions[:, None] - listed[None], axis=2)
        assert apart.min(axis=1).max() <= 1e-6, (target, solutions[apart.min(axis=1).argmax()])
        # And the other way round: they find all but perhaps one of what is listed.
        assert (apart.min(axis=0) <= 1e-6).sum() >= len(listed) - 1, (target, listed, apart.min(axis=0))


def led_to(g: Geometry, target: Array, v: Array) -> Array:
    """Where Newton's method from `v` (N,3), direction times length, leads to the target, once each."""

    def missed(v: Array) -> Array:
        length = np.linalg.norm(v, axis=1)
        reached = g.flow(v / length[:, None], length)[0]
        stretch = np.exp(target[2])
        return (reached - target)[:, :3] * [1 / stretch, stretch, 1]

    step = 1e-6
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for _ in range(12):
            here = missed(v)
            slopes = np.stack(
                [(missed(v + step * e) - missed(v - step * e)) / (2 * step) for e in np.eye(3)], axis=2
            )
            move = np.linalg.solve(slopes + 1e-12 * np.eye(3), here[..., None])[..., 0]
            move *= np.minimum(1, 0.5 / np.maximum(np.linalg.norm(move, axis=1), 1e-9))[:, None]
            moved = v - move
            fine = np.isfinite(moved).all(axis=1) & (np.linalg.norm(moved, axis=1) < 40)
            v = moved[fine & (np.linalg.norm(moved, axis=1) > 1e-3)]
    v = v[np.abs(missed(v)).max(axis=1) < 1e-9]
    kept: list[Array] = []
    for row in v:
        if all(np.linalg.norm(row - other) > 1e-6 for other in kept):
            kept.append(row)
    return np.array(kept).reshape(-1, 3)


@both_precisions
def test_level_points_have_the_lists_of_points_next_to_them(precision: str, opencl_device: Device) -> None:
    """With z = 0, and |z| down to 1e-9, no pair is missing."""
    rng, g = np.random.default_rng(1), geometry(precision, opencl_device)
    x, y = np.exp(rng.uniform(1, 4, (2, 2000)))
    level = np.stack([x, y, 0 * x, 1 + 0 * x], axis=1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        shifted = (level + np.array([0, 0, z, 0]) for z in (1e-5, 1e-6, 1e-7, 1e-9, 0))
        (_, want), *others = (g.geodesics(points, 8) for points in shifted)
    for _, got in others:
        # But where two have only just become one, or one two.
        assert (np.isfinite(got).sum(axis=1) != np.isfinite(want).sum(axis=1)).mean() < 1e-3
        assert np.nanquantile(np.abs(got - want), 0.999) < 2e-2


@both_precisions
def test_how_far_lists_go(precision: str, opencl_device: Device) -> None:
    """MOST_WINDINGS: all up to that many periods, so that no length below 4.44 times it is missing."""
    most = int(constant(PART, "MOST_WINDINGS", precision))
    (u,), (lengths,) = geometry(precision, opencl_device).geodesics([60.0, 50.0, 0.3, 1.0], 4 * most + 3)
    known = np.isfinite(lengths)
    assert known.sum() == 4 * most + 1
    windings = np.floor(lengths[known] / sol.periods(u[known]))
    assert [int((windings == n).sum()) for n in range(most + 1)] == [1] + [4] * most
    with np.errstate(all="ignore"):
        longer = on_the_conic(np.array([60.0, 50.0, 0.3]), most + 1, np.linspace(-30, 30, 3001))
    assert sum(int((np.diff(np.sign(v[np.isfinite(v)])) != 0).sum()) for v in longer) == 4
    assert lengths[known].max() > 4.44 * most


@both_precisions
def test_straight_lines_are_listed_once(precision: str, opencl_device: Device) -> None:
    """SAME_DIRECTION: on the diagonal, and next to it, where both sides of the kink find the same line."""
    g = geometry(precision, opencl_device)
    for x, count in ((3.0, 1), (3.6, 3), (4.4, 5), (8.0, 9)):
        for e in (0.0, *(sign * 10.0**-n for n in range(4, 17, 2) for sign in (-1, 1))):
            for sign in (-1, 1):
                (u,), (lengths,) = g.geodesics([x, sign * x * (1 + e), 0.0, 1.0], 12)
                known = np.isfinite(lengths)
                assert known.sum() == count, (x, e)
                apart = np.abs(u[known][:, None] - u[known][None]).max(axis=2) + 9 * np.eye(known.sum())
                assert apart.min() > 1e-2, (x, e)


@both_precisions
@pytest.mark.parametrize("lanes", [1, 8])
def test_neighbours_without_further_geodesics_do_not_matter(
    precision: str, lanes: int, opencl_device: Device
) -> None:
    """Points in planes and on the vertical have one geodesic, the others of the same vector more."""
    points = np.array(
        [[3.6, 3.6, 0, 1], [0, 0, 2, 1], [30, 0, 0.5, 1], [0, 30, 0.5, 1], [0, 0, 0, 1], [9, 8, 0.2, 1]] * 3
    )
    g = Geometry("sol", precision, opencl_device, lanes=lanes)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        u, lengths = g.geodesics(points, 3)
    assert np.isfinite(lengths).sum(axis=1).tolist() == [3, 1, 1, 1, 1, 3] * 3
    assert (np.isfinite(u).all(axis=2) == np.isfinite(lengths)).all()


@both_precisions
def test_planes_have_one_geodesic_each(precision: str, opencl_device: Device) -> None:
    points = np.array([[30.0, 0, 0.5, 1], [0, 30.0, 0.5, 1], [0, 0, 9.0, 1], [0, 0, 0, 1]])
    _, lengths = geometry(precision, opencl_device).geodesics(points, 4)
    assert np.isfinite(lengths).sum(axis=1).tolist() == [1, 1, 1, 1]
    # And so have points next to them, as near as the others are far.
    _, lengths = geometry(precision, opencl_device).geodesics([30.0, 1e-9, 0.5, 1], 4)
    assert np.isfinite(lengths).sum() == 1


@both_precisions
def test_heights_whose_exponentials_do_not_fit_are_refused(precision: str, opencl_device: Device) -> None:
    """SOL_HEIGHT_LIMIT from both sides: a distance is right or an error."""
    g, limit = geometry(precision, opencl_device), SOL_HEIGHT_LIMIT[precision]
    for sign in (-1, 1):
        assert abs(g.distance([0, 0, sign * limit, 1])[0] / limit - 1) <= 4 * EPSILON[precision]
        with pytest.raises(ValueError, match=f"too far away for {precision} precision"):
            g.distance([0, 0, sign * (limit + 0.01), 1])


# -- the search ----------------------------------------------------------------------------------------------


def changed(changes: dict[str, Callable[[float], float]], monkeypatch: pytest.MonkeyPatch) -> None:
    """Let programs built from now on have other constants."""
    text = kernel_text(PART)
    for name, change in changes.items():

        def other(match: re.Match[str], change: Callable[[float], float] = change) -> str:
            value = change(float(match[2]))
            return f"{match[1]}{value!r}" if "." in match[2] else f"{match[1]}{value:g}"

        text, count = re.subn(rf"(#define {name} (?:C\()?)([\d.]+)", other, text)
        assert count == 1, name
    monkeypatch.setattr(
        thurston_cl.program, "kernel_text", lambda part: text if part == PART else kernel_text(part)
    )


@both_precisions
@pytest.mark.parametrize("factor", [0.5, 1.3])
def test_the_choices_of_the_search_do_not_matter(
    precision: str, factor: float, opencl_device: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    """OUTWARD_LEAST, OUTWARD_MOST and ROOT_START only say where the search goes next; more MINIMUM_STEPS, by
    the golden ratio GOLDEN, change nothing; both forms beside WIDE_ABOVE and APART_BELOW are good."""
    golden = constant(PART, "GOLDEN", precision)
    assert abs(golden * golden + golden - 1) < 1e-15
    points, _, lengths = (a[:600] for a in far_lists(precision, opencl_device))
    names = ("OUTWARD_LEAST", "OUTWARD_MOST", "ROOT_START", "WIDE_ABOVE", "APART_BELOW")
    changes: dict[str, Callable[[float], float]] = dict.fromkeys(names, lambda value: value * factor)
    changed(changes | {"MINIMUM_STEPS": lambda count: count + 3}, monkeypatch)
    g = Geometry("sol", precision, opencl_device, lanes=4)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        _, others = g.geodesics(points, 8)
    np.testing.assert_array_equal(np.isfinite(others), np.isfinite(lengths[:, :8]))
    assert np.nanmax(np.abs(others / lengths[:, :8] - 1)) <= 8 * EPSILON[precision]


# Of 40 and 64: where log(Y/y) is not below DIRECTION_TOLERANCE for rounding, bisection goes on to the end.
MOST_STEPS = {"single": 36, "double": 60}


@both_precisions
def test_the_bound_of_iterations_is_not_needed(
    precision: str, opencl_device: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    """NEWTON_BOUND: fewer suffice for every set above; of lists half as many."""
    g, half = (with_bound(MOST_STEPS[precision] // k, precision, opencl_device, monkeypatch) for k in (1, 2))
    double = geometry("double", opencl_device)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for rays in HARD.values():
            g.distance(double.flow(*rays)[0])
        points = far_points(500)
        for index in range(1, 8):
            assert (half._run("geodesic", half._pair_with_tails(points, None), 6, index)[:, 4] == 0).all()


def with_bound(bound: int, precision: str, device: Device, monkeypatch: pytest.MonkeyPatch) -> Geometry:
    text = re.sub(
        r"#define NEWTON_BOUND \d+", f"#define NEWTON_BOUND {bound}", kernel_text("special/newton.h")
    )
    with monkeypatch.context() as patched:
        patched.setattr(
            thurston_cl.program,
            "kernel_text",
            lambda part: text if part == "special/newton.h" else kernel_text(part),
        )
        g = Geometry("sol", precision, device, lanes=4)
        assert g._program.built  # built while the bound is changed
        return g
