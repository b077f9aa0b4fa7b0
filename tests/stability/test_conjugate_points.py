"""Up to where a geodesic is the shortest, and where light comes together: the first conjugate points, from
both sides.

The cut times are pi in s3; pi/l in s2xe, l the part of the direction across the line; 2 pi/|u_z| in nil; 2
pi/kappa in sl2, kappa^2 = u_w^2 - a^2 (where a <= |u_w|); the period in sol (Coiculescu, Schwartz). In s3,
s2xe, nil and sl2 they are conjugate points: the area density is 0 there.
"""

import numpy as np
import pytest
import sol
from golden import EPSILON, Array, cut

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry

from . import truth
from .truth import both_precisions

WITH_CUT = ("s3", "s2xe", "nil", "sl2", "sol")
ROWS = {
    "s3": [[0.6, 0.0, 0.8], [0.36, -0.48, 0.8]],
    "s2xe": [[0.6, 0.0, 0.8], [0.64, -0.6, 0.48], [0.28, 0.0, 0.96]],
    "nil": [[0.6, 0.0, 0.8], [0.64, -0.6, 0.48], [0.28, 0.0, -0.96], [0.05, 0.03, 1.0]],
    "sl2": [[0.6, 0.0, 0.8], [0.3, -0.3, 0.9], [0.28, 0.0, -0.96], [0.05, 0.03, 1.0]],
    "sol": [[0.6, 0.64, 0.48], [0.5, -0.7, 0.3], [0.4, 0.3, -0.8]],
}
STEPS = np.array([1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10])
settings = pytest.mark.parametrize(("geometry", "precision"), [(n, p) for n in WITH_CUT for p in EPSILON])


def cut_time(geometry: str, u: Array) -> float:
    a, c = float(np.hypot(u[0], u[1])), abs(float(u[2]))
    match geometry:
        case "s3":
            return np.pi
        case "s2xe":
            return np.pi / a
        case "nil":
            return 2 * np.pi / c
        case "sl2":
            return float(2 * np.pi / np.sqrt((c - a) * (c + a)))
        case _:
            return float(sol.periods(u[None])[0])


def directions(geometry: str, precision: str) -> Array:
    u = np.array(ROWS[geometry])
    return cut(u / np.linalg.norm(u, axis=1, keepdims=True), precision)


@settings
def test_shortest_until_there(geometry: str, precision: str, opencl_device: Device) -> None:
    """Before the cut time the distance of the end is the length, with the digits that the head states; after
    it, less: the more the farther, and never a hair more than the length."""
    g, double = (Geometry(geometry, p, opencl_device, lanes=4) for p in (precision, "double"))
    for u in directions(geometry, "double"):
        last = cut_time(geometry, u)
        before, after = last * (1 - STEPS), last * (1 + STEPS[::-1])
        ends = [double.flow(u, t)[0] for t in (before, after)]
        # Near the cut points lengths are as stable as elsewhere: their slope is 1 in every direction.
        size = 1 + max(np.abs(end).max() for end in ends) / last
        allowed = 4 * EPSILON[precision] + 4 * EPSILON["double"] * size
        assert np.abs(g.distance(ends[0]) / before - 1).max() <= allowed, u
        less = 1 - g.distance(ends[1]) / after
        assert (less >= -allowed).all() and (np.diff(less) >= -2 * allowed).all(), (u, less)
        # A thousandth beyond, a part of a millionth is seen, whatever the geometry.
        assert less[-2] > 1e-6, (u, less)


CONJUGATE = ("s3", "s2xe", "nil", "sl2")


@both_precisions
@pytest.mark.parametrize("geometry", CONJUGATE)
def test_light_comes_together(geometry: str, precision: str, opencl_device: Device) -> None:
    """The density falls to 0 at each of the first conjugate points and rises again, its errors no more than
    what rounding the time, and the angle turned, does to it; never negative."""
    g = Geometry(geometry, precision, opencl_device, lanes=4)
    for u in directions(geometry, precision):
        for turns in (1, 2, 5):
            last = turns * cut_time(geometry, u)
            t = cut(last * (1 + np.concatenate([-STEPS, [0], STEPS[::-1]])), precision)
            got = g.area_density(u, t)
            want = np.array([float(truth.area(geometry, u, x)) for x in t])
            # How fast the density changes with the part of the time; the zero itself is rounded.
            steps = np.concatenate([-STEPS, STEPS[::-1]])
            slope = (np.delete(want, len(STEPS)) / np.abs(steps))[np.abs(steps) > 1e-5].max()
            allowed = 4 * EPSILON[precision] * (want + slope)
            assert (got >= 0).all()
            assert (np.abs(got - want) <= allowed).all(), (u, turns, got, want)
            middle = len(STEPS)
            assert got[middle] <= got[0] and got[middle] <= allowed[middle], (u, turns)


@both_precisions
def test_the_second_factor_of_nil_and_sl2(precision: str, opencl_device: Device) -> None:
    """Between whole turns another conjugate point stands, where the other factor is 0: found in long
    arithmetic, and walked over."""
    for geometry in ("nil", "sl2"):
        g = Geometry(geometry, precision, opencl_device, lanes=4)
        for u in directions(geometry, precision):
            first = cut_time(geometry, u)

            def signed(t: float, u: Array = u, geometry: str = geometry) -> float:
                return float(truth.signed_factor(geometry, u, t))

            low, high = 1.001 * first, 1.999 * first
            assert signed(low) * signed(high) < 0, (geometry, u)
            root = truth.root_between(signed, low, high)
            t = cut(root * (1 + np.concatenate([-STEPS, [0], STEPS[::-1]])), precision)
            got = g.area_density(u, t)
            want = np.array([float(truth.area(geometry, u, x)) for x in t])
            size = max(want[0], want[-1])
            # From a tenth away the density falls in proportion.
            allowed = 64 * EPSILON[precision] * 10 * size
            assert (got >= 0).all() and (np.abs(got - want) <= allowed).all(), (geometry, u, got, want)
