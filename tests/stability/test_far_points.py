"""Far from the origin: as far as the head of each geometry says, results are as exact as it says; beyond,
they are right, or there is a word (ValueError, RuntimeWarning). Never a wrong number, and never a wait.

In e3 and nil coordinates go on to the end of the numbers; in h3 squares of coordinates overflow at 44
(single) and 354 (double), in h2xe where the part of the way in H2 is as long; in sl2 coordinates themselves
at kappa t = 88 and 709; in sol at the height 88 and 709, and single flows are right to 87, double ones to
160/mu.
"""

import time
import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pytest
from golden import EPSILON, MP, Array, cut
from test_twisted import circle_length

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry

from . import truth
from .sweeps import lifted

DIRECTIONS = np.array([
    [0.6, 0.0, 0.8], [-0.36, 0.48, 0.8], [0.64, -0.6, 0.48], [0.0, 1.0, 0.0], [1e-3, 1e-3, 1.0],
    [0.7, 0.7, 1e-3],
])  # fmt: skip
# No call takes as long, however far (seconds; the first compiles).
PATIENCE = 20.0


class Range(NamedTuple):
    """Times that are within what the head states and times beyond it; errors of points in single and in
    double, and what they are for each unit of length where that is more."""

    within: dict[str, Sequence[float]]
    beyond: dict[str, Sequence[float]]
    stated: tuple[float, float]
    per_length: tuple[float, float] = (0.0, 0.0)

    def allowed(self, t: float, precision: str) -> float:
        k = precision == "double"
        return max(self.stated[k], self.per_length[k] * t)


RANGES: dict[str, Range] = {
    "e3": Range(
        {"single": (1e3, 1e10, 9e18), "double": (1e3, 1e100, 1e153)},
        {"single": (1e20, 1e38, 1e39), "double": (1e155, 1e300)},
        (2.1e-7, 3.3e-16),
    ),
    "h3": Range(
        {"single": (10, 30, 38, 43.0), "double": (10, 30, 38, 100.0, 350.0)},
        {"single": (44.5, 80, 88, 89, 1e4, 1e30), "double": (356, 600.0, 709, 710, 1e4, 1e200)},
        (1.4e-7, 3e-15),
    ),
    # The angle l t is rounded: an error of t EPSILON/2 of the size of cosh.
    "h2xe": Range(
        {"single": (10, 30, 40), "double": (10, 30, 40, 350)},
        {"single": (50, 88, 95, 1e4, 1e30), "double": (400, 709, 710, 1e4, 1e200)},
        (2.3e-6, 4.2e-15),
        (EPSILON["single"] / 2, EPSILON["double"] / 2),
    ),
    "nil": Range(
        {"single": (10, 300, 1e3), "double": (10, 300, 1e3)},
        {"single": (1e4, 1e5), "double": (1e4, 1e5, 1e8)},
        (2.6e-7, 3.4e-16),
    ),
    "sl2": Range(
        {"single": (10, 30, 80, 87), "double": (10, 100, 700)},
        {"single": (89, 95, 150, 300), "double": (712, 720, 1e3)},
        (5.3e-7, 1.1e-15),
        # 2.1e-5 and 3.1e-14 at 100.
        (2.1e-7, 3.1e-16),
    ),
    "sol": Range(
        {"single": (10, 30, 60, 87), "double": (10, 60, 100, 110)},
        {"single": (89, 95, 150), "double": (170, 250)},
        (6.1e-7, 1.1e-15),
    ),
}  # fmt: skip
CASES = [(name, precision) for name in RANGES for precision in EPSILON]


def unit_rays(t: float, precision: str) -> tuple[Array, Array]:
    u = cut(DIRECTIONS / np.linalg.norm(DIRECTIONS, axis=1, keepdims=True), precision)
    return u, np.full(len(u), float(np.float64(t)))


def off(geometry: str, u: Array, t: Array, points: Array) -> Array:
    """Errors (N,) of points, in the terms of the head."""
    with MP.workdps(60 + int(min(2 * t[0], 1500))):
        wants = [truth.flow(geometry, *row).point for row in zip(u, t, strict=True)]
    return np.array(
        [np.abs(truth.point_error(geometry, *row)).max() for row in zip(u, t, wants, points, strict=True)]
    )


@pytest.mark.parametrize(("geometry", "precision"), CASES)
def test_flows_within_their_range(geometry: str, precision: str, opencl_device: Device) -> None:
    """Without a word, and as exact as the head says."""
    g, limits = Geometry(geometry, precision, opencl_device, lanes=4), RANGES[geometry]
    for t in limits.within[precision]:
        u, times = unit_rays(t, precision)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            points, ahead = g.flow(u, times)
        stated = limits.allowed(t, precision)
        errors = off(geometry, u, times, points)
        print(f"{geometry} {precision} t = {t:g}: {errors.max():.1e}, stated {stated:.1e}")
        assert (errors <= stated).all(), (t, errors)
        assert np.abs(np.linalg.norm(ahead, axis=1) - 1).max() <= 1e-5


@pytest.mark.parametrize(("geometry", "precision"), CASES)
def test_flows_beyond_their_range(geometry: str, precision: str, opencl_device: Device) -> None:
    """Points that are numbers are right, to a thousandth of a radian or of themselves; all others are
    counted."""
    g, limits = Geometry(geometry, precision, opencl_device, lanes=4), RANGES[geometry]
    for t in limits.beyond[precision]:
        u, times = unit_rays(t, precision)
        start = time.perf_counter()
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            points, ahead = g.flow(u, times)
            area = g.area_density(u, times)
        assert time.perf_counter() - start < PATIENCE
        known = np.isfinite(points).all(axis=1) & np.isfinite(ahead).all(axis=1)
        words = [str(word.message) for word in said]
        far = [word for word in words if word.startswith("flow: ")]
        assert far == ([] if known.all() else [far_message(known, precision)]), (t, words)
        unknown = int(np.isnan(area).sum())
        dark = [word for word in words if word.startswith("area_density: ")]
        begin = f"area_density: {unknown} of {len(u)} values are not known"
        assert dark == ([f"{begin}: too far away for {precision} precision"] if unknown else []), (t, words)
        errors = (
            off(geometry, u[known], times[known], points[known]) if t < 1e6 and known.any() else np.zeros(1)
        )
        assert (errors <= 1e-3).all(), (t, errors)


def far_message(known: Array, precision: str) -> str:
    return f"flow: {int((~known).sum())} of {len(known)} points are too far away for {precision} precision"


# Points that are too far for single precision, or of too great heights, by geometry and precision.
REFUSED = {
    ("e3", "single"): [2e19, 0, 0], ("s2xe", "single"): [0, 0, 2e19], ("h3", "single"): [2e19, 0, 0],
    ("h2xe", "single"): [2e19, 0, 0], ("nil", "single"): [0, 2e19, 0], ("sl2", "single"): [2e19, 0, 0],
    ("sol", "single"): [0, 0, 88.0], ("sol", "double"): [0, 0, 709.0],
}  # fmt: skip


@pytest.mark.parametrize(("geometry", "precision"), REFUSED)
def test_points_too_far_are_refused(geometry: str, precision: str, opencl_device: Device) -> None:
    g = Geometry(geometry, precision, opencl_device, lanes=4)
    point = lifted(geometry, *(np.array([float(c)]) for c in REFUSED[geometry, precision]))
    cure = "; use precision='double'" if precision == "single" else ""
    for call in (g.distance, g.underestimate, lambda p: g.geodesics(p, 1), lambda p: g.translate(p, p)):
        with pytest.raises(ValueError, match=r"(point|base) 0") as error:
            call(point)
        assert str(error.value).endswith(f"is too far away for {precision} precision{cure}"), error.value


# Lengths of geodesics from the origin along which points are taken; of some the coordinates are large.
LENGTHS = {
    "e3": {"single": (1e6, 1e18), "double": (1e6, 1e150, 1e200)},
    "h3": {"single": (20.0, 40.0, 43.0), "double": (20.0, 100.0, 350.0)},
    "h2xe": {"single": (20.0, 40.0, 43.0), "double": (20.0, 100.0, 350.0)},
    "sl2": {"single": (20.0, 40.0, 43.0), "double": (20.0, 100.0, 350.0)},
    "sol": {"single": (20.0, 30.0), "double": (20.0, 30.0)},
}


@pytest.mark.parametrize(("geometry", "precision"), [(n, p) for n in LENGTHS for p in EPSILON])
def test_distances_from_the_origin(geometry: str, precision: str, opencl_device: Device) -> None:
    """Of far points, by geodesics that are the shortest: horizontal ones, and in sol one in a plane."""
    g = Geometry(geometry, precision, opencl_device, lanes=4)
    row = [0.6, 0.0, 0.8] if geometry in ("e3", "h3", "sol") else [0.6, -0.8, 0.0]
    for length in LENGTHS[geometry][precision]:
        with MP.workdps(60 + int(min(2 * length, 1500))):
            u = truth.exact_row(row) / MP.sqrt(sum(c * c for c in truth.exact_row(row)))
            point = truth.flow(geometry, u, length).point.astype(float)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            got, (found, _) = g.distance(point)[0], g.geodesics(point, 1)
        assert abs(got / length - 1) <= 4 * EPSILON[precision], length
        assert np.abs(found[0, 0] - u.astype(float)).max() <= 8 * EPSILON[precision], length


@pytest.mark.parametrize("precision", EPSILON)
def test_transport_far_away(precision: str, opencl_device: Device) -> None:
    """In sol it is integrated for so many steps only, and says so; elsewhere it goes on, a rotation."""
    for geometry in ("e3", "nil", "sl2", "sol"):
        g = Geometry(geometry, precision, opencl_device, lanes=4)
        u = cut([[0.48, 0.6, 0.64]], precision)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            turn = g.transport(u, 1e5 if geometry == "sol" else 1e4)[0]
        if geometry == "sol":
            text = f"transport: 1 of 1 matrices are not known: too far away for {precision} precision"
            assert np.isnan(turn).any() and [str(word.message) for word in said] == [text]
        else:
            assert not said and np.abs(turn @ turn.T - np.eye(3)).max() <= 16 * EPSILON[precision], geometry


@pytest.mark.parametrize("precision", EPSILON)
@pytest.mark.parametrize("geometry", ["nil", "sl2"])
def test_far_up_the_fibre(geometry: str, precision: str, opencl_device: Device) -> None:
    """Right above the origin, however high: the shortest are circles of geodesics with one turn, two, and
    three; next to the fiber the same, each parted in two."""
    g = Geometry(geometry, precision, opencl_device, lanes=4)
    heights = np.array([20.0, 1e3, 1e6, 1e9, 1e12, 9e18])
    for sign in (1, -1):
        on, near = (lifted(geometry, x * heights, 0 * heights, sign * heights) for x in (0.0, 1e-25))
        want = np.array([[circle_length(geometry, k, MP.mpf(h)) for k in (1, 2, 3)] for h in heights])
        want = want.astype(float)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            _, lengths, family = g.geodesics(on, 3, families=True)
            _, beside = g.geodesics(near if precision == "double" else on, 3)
        assert family.all() and np.abs(lengths / want - 1).max() <= 4 * EPSILON[precision], sign
        np.testing.assert_array_equal(g.distance(on), lengths[:, 0])
        parted = want[:, [0, 0, 1]] if precision == "double" else want
        assert np.abs(beside / parted - 1).max() <= 4 * EPSILON[precision], sign
