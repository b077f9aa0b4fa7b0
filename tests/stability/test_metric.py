"""What makes a distance one, next to seams and cut loci, by Hypothesis: symmetry, the triangle inequality,
invariance under translations, and that no way is shorter.

tests/test_geometry.py, test_products.py, test_twisted.py and test_sol_geodesics.py ask the same of ordinary
points. Here a second point lies next to the first, to its antipode or above it on its fiber; lengths are
next to cut times.
"""

from typing import Any, NamedTuple

import numpy as np
import pytest
from golden import EPSILON, Array
from hypothesis import given, settings
from hypothesis import strategies as st

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.models import ORIGIN

from . import truth
from .test_conjugate_points import cut_time

few = settings(max_examples=25)
all_settings = pytest.mark.parametrize(("geometry", "precision"), truth.SETTINGS)
part = st.one_of(st.floats(-1, 1), st.floats(-9, 0).map(lambda n: 10.0**n), st.just(0.0))
row = st.tuples(part, part, part).filter(lambda r: max(map(abs, r)) > 1e-2)
# From the place of a seam, as a part of it.
beside = st.floats(-15, -0.5).map(lambda n: 10.0**n)
sign = st.sampled_from([-1, 1])
# The farthest that a geodesic is followed where it has no cut.
FARTHEST = {"e3": 3.0, "h3": 2.5, "h2xe": 2.5}


class Ray(NamedTuple):
    u: Array
    t: float


def unit(values: Any) -> Array:
    u = np.array(values, dtype=np.float64)
    return u / np.linalg.norm(u)


def last_time(geometry: str, u: Array) -> float:
    """Until when the geodesic is the shortest, or a length that keeps coordinates small."""
    if geometry in FARTHEST:
        return FARTHEST[geometry]
    if geometry == "sl2" and abs(u[2]) <= 1.05 * np.hypot(u[0], u[1]):
        return 2.5
    if geometry in ("s2xe", "nil") and (np.hypot(u[0], u[1]) if geometry == "s2xe" else abs(u[2])) < 0.5:
        return 5.0
    if geometry == "sol" and abs(u[0] * u[1]) < 1e-2:
        return 3.0
    return min(cut_time(geometry, u), 7.0)


def sizes(*points: Array) -> float:
    """By how much rounding of coordinates counts: their product, 1 at least."""
    return float(np.prod([1 + np.abs(p).max() for p in points]))


@all_settings
def test_distance_is_at_most_the_way(geometry: str, precision: str, opencl_device: Device) -> None:
    """d(flow(u, t)) <= t, with equality below the cut time and next to it: from anywhere, both ways."""
    g, double = (Geometry(geometry, p, opencl_device, lanes=1) for p in (precision, "double"))

    @few
    @given(values=row, start=row, e=beside, s=sign, length=st.floats(0, 1))
    def check(values: Any, start: Any, e: float, s: int, length: float) -> None:
        u, last = unit(values), last_time(geometry, unit(values))
        base = double.flow(unit(start), 0.8 * length)[0][0]
        t = last * (1 + s * e)
        end = double.flow(u, t, base)[0][0]
        rounding = EPSILON[precision] * 3 + EPSILON["double"] * 6 * sizes(base, end, end) / t
        if precision == "single":
            rounding *= sizes(base, base) if geometry in ("h3", "h2xe", "sl2", "sol", "nil") else 1
        there, back = g.distance(end, base)[0], g.distance(base, end)[0]
        assert there <= t * (1 + rounding), (u, base, t, there / t - 1)
        assert abs(there - back) <= 2 * rounding * t
        if s < 0:
            assert there >= t * (1 - rounding), (u, base, t, there / t - 1)

    check()


@all_settings
def test_triangles_next_to_seams(geometry: str, precision: str, opencl_device: Device) -> None:
    """d(a, c) <= d(a, b) + d(b, c), where b is next to the geodesic from a to c: there the two sides nearly
    agree."""
    g, double = (Geometry(geometry, p, opencl_device, lanes=1) for p in (precision, "double"))

    @few
    @given(values=row, aside=row, e=beside, share=st.floats(0.05, 0.95), start=row)
    def check(values: Any, aside: Any, e: float, share: float, start: Any) -> None:
        u, last = unit(values), last_time(geometry, unit(values))
        a = double.flow(unit(start), 0.5)[0][0]
        middle, ahead = (x[0] for x in double.flow(u, share * last, a))
        b = double.flow(unit(aside), e, middle)[0][0]
        c = double.flow(ahead / np.linalg.norm(ahead), (1 - share) * last, middle)[0][0]
        ab, bc, ac = g.distance([b, c, c], [a, b, a])
        rounding = EPSILON[precision] * (4 if precision == "double" else 1) * sizes(a, b, c) * (1 + last)
        assert ac <= ab + bc + rounding, ac - ab - bc
        # And no longer than that by more than twice the way aside.
        assert ab + bc <= ac + 2 * e + rounding + max(0.0, last - ac), ab + bc - ac

    check()


@all_settings
def test_translations_keep_what_is_next_to_a_seam(
    geometry: str, precision: str, opencl_device: Device
) -> None:
    """Distances from the origin to points next to cut points are those from where both are carried to."""
    g, double = (Geometry(geometry, p, opencl_device, lanes=1) for p in (precision, "double"))

    @few
    @given(values=row, to=row, e=beside, s=sign)
    def check(values: Any, to: Any, e: float, s: int) -> None:
        u, last = unit(values), last_time(geometry, unit(values))
        end = double.flow(u, last * (1 + s * e))[0][0]
        base = double.flow(unit(to), 0.9)[0][0]
        moved = double.translate(base, end)[0]
        want, got = g.distance(end)[0], g.distance(moved, base)[0]
        size = sizes(base, end, moved)
        rounding = EPSILON["double"] * 6 * size / max(last, 0.1) + EPSILON[precision] * 3 * (
            sizes(base, base) if geometry not in ("e3", "s3", "s2xe") else 1
        )
        assert abs(got / want - 1) <= rounding, (u, base, got / want - 1)
        # And to the base itself: carried back it is the origin.
        assert g.distance(g.untranslate(base, base)[0], ORIGIN[geometry])[0] <= 8 * EPSILON[
            precision
        ] * sizes(base, base)

    check()
