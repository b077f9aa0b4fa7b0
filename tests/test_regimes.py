"""Every constant of the fibred geometries at which a formula, a solver or a bound changes, and the test that
walks over it from both sides. What test_twisted.py, test_stumpff.py, test_products.py and test_marching.py do
not walk over is walked over here; and single precision follows double along all of it.
"""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import twisted
from golden import EPSILON, MP, Array, cut, exact, rounded
from test_twisted import (
    BOTH_SIDES,
    GEODESIC_FACTOR,
    LANES,
    both_geometries,
    both_precisions,
    direction,
    geodesic_walks,
    over_fibre,
    ray_walks,
)

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.program import kernel_text

# By file of kernels/: each named constant, and where it is walked over or used up to its bound.
SEAMS = {
    "geometry/twisted.h": {
        "AXIS_RATIO": "test_twisted.test_rho_to_0_is_the_fibre",
        "QUARTER_TURN": "test_regimes.test_lengths_go_on_over_the_seams_of_the_solver",
        "QUARTER_TURN_END": "test_regimes.test_lengths_go_on_over_the_seams_of_the_solver",
        "START_BELOW": "test_twisted.test_pairs_appear_at_the_folds",
        "LOOK_AHEAD": "test_marching.test_levels_are_reached_in_few_steps",
    },
    "geometry/nil.h": {
        "POLE_SHIFT": "test_twisted.test_the_bound_of_iterations_is_far_from_what_is_needed",
        "CUBE_ROOT_HALF": "test_twisted.test_the_bound_of_iterations_is_far_from_what_is_needed",
        "STRAIGHT_BELOW": "test_regimes.test_the_underestimate_of_nil_over_its_seams",
        "PARABOLIC_FROM": "test_regimes.test_the_underestimate_of_nil_over_its_seams",
    },
    "geometry/sl2.h": {
        "POLE_SHIFT": "test_twisted.test_the_bound_of_iterations_is_far_from_what_is_needed",
        "COMPLEMENT_ABOVE": "test_regimes.test_lengths_go_on_over_the_seams_of_the_solver",
        "OPPOSITE_ABOVE": "test_regimes.test_distance_of_points_on_opposite_sides",
        "SPLIT_DIRECTION_ABOVE": "test_regimes.test_directions_over_the_seam_of_the_split",
        "MOST_BEND": "test_marching.test_level_time_is_never_too_late",
    },
    "geometry/s2xe.h": {"ANTIPODE_OFFSET": "test_products.test_frames_about_the_antipode_of_the_origin"},
    "geometry/h2xe.h": {},
    "geometry/product.h": {},
    "special/newton.h": {
        "NEWTON_BOUND": "test_twisted.test_the_bound_of_iterations_is_far_from_what_is_needed",
        "NEWTON_TOLERANCE": "test_twisted.test_geodesics_over_every_seam",
    },
    "special/stumpff.h": {"STUMPFF_SERIES_BELOW": "test_stumpff.test_values"},
    "special/meeting.h": {},
    "special/two_part.h": {},
}
# Named, but no seams: what a geometry is, and pi.
NO_SEAMS = {"HOMOGENEOUS", "PI_HIGH", "PI_LOW"}


@pytest.mark.parametrize("part", SEAMS)
def test_every_named_constant_is_walked_over(part: str) -> None:
    named = set(
        re.findall(
            r"^#define (\w+) [^\n(]*(?:C\()?[-.\dxa-fp]+f?\)?(?:\s|$)", kernel_text(part), re.MULTILINE
        )
    )
    assert named - NO_SEAMS == set(SEAMS[part])
    for where in SEAMS[part].values():
        module, test = where.split(".")
        assert f"def {test}(" in (Path(__file__).parent / f"{module}.py").read_text(encoding="utf-8"), where


def value(name: str, part: str) -> float:
    found = re.search(rf"^#define {name} (?:C\()?([-.\de]+)", kernel_text(part), re.MULTILINE)
    assert found is not None
    return float(found[1])


# -- the solver ----------------------------------------------------------------------------------------------


def seams_of_the_solver(geometry: str, rho: float) -> dict[str, float]:
    """Heights at distance `rho` from the fibre at which the shortest geodesic is found in another way."""
    quarter = value("QUARTER_TURN", "geometry/twisted.h")
    if geometry == "nil":
        return {"quarter turn": 2 * quarter * (1 + rho**2 / 8)}
    return {
        "quarter turn": 4 * quarter * np.cosh(rho / 2) - 2 * quarter,
        "complement": 2 * (rho + value("COMPLEMENT_ABOVE", "geometry/sl2.h")),
    }


@both_precisions
@both_geometries
def test_lengths_go_on_over_the_seams_of_the_solver(
    geometry: str, precision: str, opencl_device: Device
) -> None:
    """The length changes by the part of the direction along the fibre times the change of height, over the
    seams as elsewhere; the direction as little."""
    g = Geometry(geometry, precision, opencl_device, lanes=LANES)
    for rho in (1e-6, 1e-3, 0.1, 1.0, 3.0, 6.0):
        for name, height in seams_of_the_solver(geometry, rho).items():
            for e in (1e-3, 1e-4, 1e-6, 1e-9, 1e-12, 1e-15):
                around = np.array([height * (1 - e), height * (1 + e)])
                u, lengths = (x[:, 0] for x in g.geodesics(over_fibre(geometry, rho, around), 1))
                change = u[:, 2].mean() * (around[1] - around[0])
                # The third order: where rho is small, the corner at the first circle is as sharp as rho.
                allowed = 8 * height * e**2 + GEODESIC_FACTOR * EPSILON[precision] * lengths[0]
                assert abs(lengths[1] - lengths[0] - change) <= allowed, (name, rho, e)
                # A direction turns with the height by no more than this rate, which the corner sets.
                rate = 8 * height * (1 + 1 / rho) if rho < 1 else 8 * height
                assert np.abs(u[1] - u[0]).max() <= rate * e + 8 * EPSILON[precision], (name, rho, e, u)


# -- pairs of points off the origin, sl2 ---------------------------------------------------------------------


@both_precisions
def test_distance_of_points_on_opposite_sides(precision: str, opencl_device: Device) -> None:
    """On a line through the origin their difference of height is that of w: over cosh of the distance in H2
    equal to 2, from both sides."""
    g = Geometry("sl2", precision, opencl_device, lanes=LANES)
    threshold = value("OPPOSITE_ABOVE", "geometry/sl2.h")
    rows = []
    for cosine in (*(threshold * (1 + e) for e in BOTH_SIDES), 1.01, 1.3, 4.0, 40.0):
        apart = MP.acosh(MP.mpf(cosine))
        for part in (0.1, 0.5, 0.7):
            for height in (0.0, 1e-3, 2.0, -7.0):
                rows.append((apart * part, apart * (1 - part), height, apart))
    ends = np.array([[MP.sinh(r[0]), MP.sinh(r[1])] for r in rows])
    p = np.array([[-0.6 * a, -0.8 * a, np.sqrt(1 + a * a), 0.75] for a in rounded(ends[:, 0])])
    q = np.array([[0.6 * a, 0.8 * a, np.sqrt(1 + a * a), 0.75] for a in rounded(ends[:, 1])])
    q[:, 3] += np.array([r[2] for r in rows])
    got = g.distance(q, p)
    double = Geometry("sl2", "double", opencl_device, lanes=8)
    want = double.distance(np.array([over_fibre("sl2", float(r[3]), [r[2]])[0] for r in rows]))
    assert (np.abs(got / want - 1) <= 8 * EPSILON[precision]).all(), np.abs(got / want - 1).max()


@both_precisions
def test_directions_over_the_seam_of_the_split(precision: str, opencl_device: Device) -> None:
    """From starts about |(x, y)|^2 = 1, towards all sides: a 50-digit flow leads to a point, and the geodesic
    there starts as the flow did."""
    g = Geometry("sl2", precision, opencl_device, lanes=LANES)
    threshold = value("SPLIT_DIRECTION_ABOVE", "geometry/sl2.h")
    starts, rays, ends = [], [], []
    for e in BOTH_SIDES:
        r = np.sqrt(threshold * (1 + e))
        base = np.array([0.6 * r, -0.8 * r, np.sqrt(1 + r * r), 0.4])
        for angle in np.arange(6) + 0.1:
            for up in (0.0, 0.5, -0.8):
                for t in (1e-3, 0.3, 2.0):
                    u = exact(direction(up, angle))
                    unit = u / MP.sqrt(sum(c * c for c in u))
                    start = twisted.lift("sl2", exact(base[[0, 1, 3]]))
                    starts.append(base)
                    rays.append((unit, t))
                    ends.append(twisted.flow("sl2", start, unit, MP.mpf(t))["point"])
    u, lengths = g.geodesics(rounded(np.array(ends)), 1, np.array(starts))
    for n, (unit, t) in enumerate(rays):
        # Points are known to binary64 only.
        allowed = GEODESIC_FACTOR * EPSILON[precision] + 8 * EPSILON["double"] * (1 + float(ends[n][2]) / t)
        assert abs(lengths[n, 0] / t - 1) <= allowed, (starts[n], rounded(unit), t)
        assert np.abs(u[n, 0] - rounded(unit)).max() <= allowed, (starts[n], rounded(unit), t, u[n, 0])


# -- bounds --------------------------------------------------------------------------------------------------


@both_precisions
def test_the_underestimate_of_nil_over_its_seams(precision: str, opencl_device: Device) -> None:
    """On the fibre and near it: the inverse of the paper's bound (lemma 9.5) and of d^2/(2 pi) + pi/2, in
    50 digits; rising, and never above the distance."""
    g = Geometry("nil", precision, opencl_device, lanes=LANES)
    part = "geometry/nil.h"
    seams = (value("STRAIGHT_BELOW", part), value("PARABOLIC_FROM", part), np.pi / 2)
    heights = cut(np.sort([seam * (1 + e) for seam in seams for e in BOTH_SIDES]), precision)
    points = over_fibre("nil", 0.0, heights)
    got = g.underestimate(points)
    root = [(MP.mpf(3) / 4 * MP.mpf(z)) ** (MP.mpf(2) / 3) for z in heights]
    for n, z in enumerate(heights):
        middle = MP.sqrt(12 * (root[n] - 1)) if z >= seams[0] else MP.mpf(z)
        by_lemma = middle if z < seams[1] else MP.sqrt(2 * MP.sqrt(3) * MP.mpf(z))
        by_circles = MP.sqrt(2 * MP.pi * max(MP.mpf(z) - MP.pi / 2, MP.mpf(0)))
        want = max(by_lemma, by_circles)
        assert abs(MP.mpf(float(got[n])) / want - 1) <= 8 * EPSILON[precision], (z, got[n], want)
    assert (np.diff(got) >= -4 * EPSILON[precision] * got[1:]).all()
    assert (got <= g.distance(points) * (1 + 4 * EPSILON[precision])).all()


# -- single precision follows double -------------------------------------------------------------------------


@both_geometries
def test_single_follows_double_over_every_seam(geometry: str, opencl_device: Device) -> None:
    """Flow and transport of the same numbers; they part by what rounding does to c t, the angle turned."""
    single, double = (Geometry(geometry, p, opencl_device, lanes=8) for p in ("single", "double"))
    walks: dict[str, Sequence[tuple[list[float], float]]] = {
        **ray_walks(geometry, "single"),
        **geodesic_walks(geometry),
    }
    for name, rays in walks.items():
        u, t = cut([r[0] for r in rays], "single"), cut([r[1] for r in rays], "single")
        for base in (None, over_fibre(geometry, 0.5, [0.25])):
            (p, e), (q, f) = (g.flow(u, t, base) for g in (single, double))
            turns = EPSILON["single"] * (4 + t)
            size: Array = np.maximum(np.abs(q).max(axis=1), 1 + t) * (1 if base is None else 2)
            assert (np.abs(p - q).max(axis=1) <= 2 * turns * size).all(), name
            assert (np.abs(e - f).max(axis=1) <= turns).all(), name
            turn, wanted = (g.transport(u, t, base) for g in (single, double))
            assert (np.abs(turn - wanted).reshape(-1, 9).max(axis=1) <= 2 * turns).all(), name
