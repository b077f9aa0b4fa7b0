"""Every constant of the fibred geometries at which a formula, a solver or a bound changes, and the test that
walks over it from both sides. What test_twisted.py, test_stumpff.py, test_products.py and test_marching.py do
not walk over is walked over here; and single precision follows double along all of it.
"""

import ast
import re
from collections.abc import Sequence
from importlib.resources import files
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

# By file of kernels/: each named constant, the test that walks over it or uses it up to its bound, and what
# the source of that test says of it, with the functions and constants of its module that it uses. By default
# that is the constant's own name.
R, T, M, S = "test_regimes", "test_twisted", "test_marching", "test_shapes_fibred"
SOL = "test_shapes_sol"
E = "test_effects"
IMAGE = "test_texture_image"
NOISE = "test_noise"
TRACERS = "test_tracers"
KRS = "test_krs_scenes"
_LAYOUT = f"{KRS}.test_numbers_are_laid_out_as_the_kernels_read_them"
_ITERATIONS = f"{T}.test_the_bound_of_iterations_is_far_from_what_is_needed"
_LENGTHS = f"{R}.test_lengths_go_on_over_the_seams_of_the_solver"
_LIGHT = "test_light_falloff.test_light_fades_by_its_law_until_it_is_far_brighter_than_white"
_SHADOWS = "test_shadows_fibred.test_a_shadow_is_where_the_geodesic_to_the_light_meets_an_object"
_SOL_WALKS = "test_sol_flow.test_walks"
_SOL_SEARCH = "test_sol_geodesics.test_the_choices_of_the_search_do_not_matter"
_FIELDS = ("isotropic", "product", "left_invariant", "nil_coordinates", "sl2")
_WITHOUT_CONSTANTS = ("exact", "motion", "euler", "rk2", "rk4", "from_anywhere", "from_origin")
FLOW_FILES = [f"flow/{name}.h" for name in (*_WITHOUT_CONSTANTS, *(f"field_{field}" for field in _FIELDS))]
SEAMS: dict[str, dict[str, tuple[str, ...]]] = {
    "geometry/twisted.h": {
        "AXIS_RATIO": (f"{T}.test_rho_to_0_is_the_fibre", "rho <= 1e-19 * height"),
        "QUARTER_TURN": (_LENGTHS,),
        "QUARTER_TURN_END": (_LENGTHS, "quarter turn"),
        "START_BELOW": (f"{T}.test_pairs_appear_at_the_folds", "fold_height"),
    },
    "geometry/left_invariant.h": {},
    "special/rise.h": {"LOOK_AHEAD": (f"{M}.test_levels_are_reached_in_few_steps", "LEVEL_STEPS")},
    "geometry/nil.h": {
        "POLE_SHIFT": (_ITERATIONS, "with_bound"),
        "CUBE_ROOT_HALF": (_ITERATIONS, "with_bound"),
        "STRAIGHT_BELOW": (f"{R}.test_the_underestimate_of_nil_over_its_seams",),
        "PARABOLIC_FROM": (f"{R}.test_the_underestimate_of_nil_over_its_seams",),
    },
    "geometry/sl2.h": {
        "POLE_SHIFT": (_ITERATIONS, "with_bound"),
        "COMPLEMENT_ABOVE": (f"{R}.test_lengths_keep_their_digits_on_both_sides_of_the_complement",),
        "OPPOSITE_ABOVE": (f"{R}.test_distance_of_points_on_opposite_sides",),
        "SPLIT_DIRECTION_ABOVE": (f"{R}.test_directions_over_the_seam_of_the_split",),
        "MOST_BEND": (f"{M}.test_level_time_is_never_too_late", '"level"'),
    },
    "geometry/s2xe.h": {
        "ANTIPODE_OFFSET": ("test_products.test_frames_about_the_antipode_of_the_origin", "antipode")
    },
    "geometry/h2xe.h": {},
    "geometry/product.h": {},
    "special/newton.h": {
        "NEWTON_BOUND": (_ITERATIONS,),
        "NEWTON_TOLERANCE": (f"{T}.test_geodesics_over_every_seam", "GEODESIC_FACTOR"),
    },
    "special/stumpff.h": {"STUMPFF_SERIES_BELOW": ("test_stumpff.test_values", "stumpff")},
    "special/jacobi.h": {
        "AGM_STEPS": ("test_special.test_steps_of_the_mean",),
        "HYPERBOLIC_BELOW": ("test_special.test_where_hyperbolic_functions_begin",),
        "SECH_END": ("test_special.test_where_sech_vanishes",),
        "DIFFERENCE_BELOW": ("test_special.test_where_c_is_a_difference",),
    },
    "special/carlson.h": {"DUPLICATIONS": ("test_carlson.test_one_duplication_fewer_is_too_few",)},
    "geometry/sol.h": {},
    "geometry/sol_phase.h": {
        "CLOSED_BELOW": ("test_sol_flow.test_the_integral_on_both_sides_of_the_closed_form",),
        "ASCENTS": ("test_sol_flow.test_one_ascent_fewer_is_too_few",),
        "SHORT_PHASE": (_SOL_WALKS,),
        "PLANAR_BELOW": (_SOL_WALKS,),
        "PHASE_END": ("test_sol_flow.test_planes_go_on_to_the_end_of_double_precision",),
    },
    "geometry/sol_flow.h": {
        "HALF_TANGENT_BELOW": (_SOL_WALKS,),
        "BETA_SN_ABOVE": ("test_sol_flow.test_both_forms_next_to_the_seam_of_beta_sn",),
        "MOST_STEPS": ("test_sol_flow.test_transport_ends_at_its_bound",),
        "TRANSPORT_STEP": ("test_sol_flow.test_transport_over_its_steps",),
        "NODES": ("test_sol_flow.test_transport_over_its_steps",),
    },
    "geometry/sol_bounds.h": {
        "BOUND_FACTOR": ("test_sol_bounds.test_a_greater_factor_is_too_great",),
        "MOST_JERK": ("test_sol_bounds.test_the_most_jerk",),
        "SIDE_HORIZON": ("test_sol_bounds.test_side_time_is_never_too_late",),
        "SIDE_GROWTH": ("test_sol_bounds.test_side_time_is_never_too_late",),
    },
    "geometry/sol_geodesics.h": {
        "WIDE_ABOVE": (_SOL_SEARCH,),
        "APART_BELOW": (_SOL_SEARCH,),
        "OUTWARD_LEAST": (_SOL_SEARCH,),
        "OUTWARD_MOST": (_SOL_SEARCH,),
        "MINIMUM_STEPS": (_SOL_SEARCH,),
        "GOLDEN": (_SOL_SEARCH,),
        "ROOT_START": (_SOL_SEARCH,),
        "MOST_WINDINGS": ("test_sol_geodesics.test_how_far_lists_go",),
        "AXIS_BELOW": ("test_sol_geodesics.test_next_to_the_axis",),
        "LENGTH_TOLERANCE": ("test_sol_geodesics.test_a_length_is_as_exact_as_the_square_of_the_tolerance",),
    },
    "geometry/sol_light.h": {
        "CLOSED_AREA_ABOVE": ("test_sol_light.test_on_both_sides_of_the_closed_form",),
        "AREA_STEP": ("test_sol_light.test_the_integration_is_of_order_four",),
    },
    **{file: {} for file in FLOW_FILES},
    "flow/rk8.h": {
        "ROOT_21": ("test_flows.test_errors_fall_by_the_order",),
        "STAGES": ("test_flows.test_errors_fall_by_the_order",),
    },
    "flow/steps.h": {
        "STEP_SLACK": ("test_flows.test_a_whole_number_of_steps_is_not_given_one_more",),
        "MOST_FLOW_STEPS": ("test_flows.test_more_than_a_million_steps_are_not_made",),
    },
    "special/meeting.h": {},
    "special/two_part.h": {},
    "shape/ball.h": {
        "SQUEEZE_ROUNDING": (f"{S}.test_balls_against_the_exact_distance", "0.4 * side * want"),
        "BALL_SEEN_BELOW": (f"{S}.test_far_from_a_ball_its_normal_is_not_looked_for",),
    },
    "shape/ball_twisted.h": {
        "COT_START": (f"{S}.test_the_cotangent",),
        "COT_END": (f"{S}.test_the_cotangent",),
        "UNKNOWN_END": (f"{S}.test_the_first_guess_over_its_cut",),
        "PSI_END": (f"{S}.test_the_first_guess_over_its_cut",),
        "SQUEEZE_STEPS": (f"{S}.test_balls_against_the_exact_distance", "0.4 * side * want"),
    },
    "shape/ball_sol.h": {
        "LEAST_FADING": (f"{SOL}.test_the_first_term_fades_as_the_bounds_say",),
        "MOST_FADING": (f"{SOL}.test_the_first_term_fades_as_the_bounds_say",),
        "FADING_KNOWN_BELOW": (f"{SOL}.test_the_bounds_of_a_ball",),
    },
    "shape/pseudo_ball.h": {
        "HALF_C": (f"{SOL}.test_pseudo_shapes_are_the_paper_s",),
        "INVERSE_ROOT": (f"{SOL}.test_pseudo_shapes_are_the_paper_s",),
    },
    "shape/bisected_half_space.h": {
        "PROBE": (f"{S}.test_bisection_ends_at_the_crossing",),
        "HALVINGS": (f"{S}.test_bisection_ends_at_the_crossing", "at.epsilon"),
    },
    "pattern/image.h": {
        "IMAGE_HEAD": (f"{IMAGE}.test_look_up_against_the_reference", "len(levels)"),
        "IMAGE_LEVEL": (f"{IMAGE}.test_look_up_against_the_reference", "len(levels)"),
        "TEXEL_PAGE": (f"{IMAGE}.test_texels_are_found_on_both_sides_of_a_page",),
        "FOOTPRINT_STEP": (f"{IMAGE}.test_spread_on_a_ball",),
    },
    "pattern/noise.h": {
        "NOISE_HEAD": (f"{NOISE}.test_colors_follow_each_other_evenly", "colors.ravel()"),
        "NOISE_SHARP_FROM": (f"{NOISE}.test_octaves_fade_until_a_pixel_is_as_long_as_their_cubes",),
        "NOISE_FAR": (f"{NOISE}.test_octaves_fade_until_numbers_no_longer_tell_their_points_apart",),
        "NOISE_GAIN": (f"{NOISE}.test_values_are_spread_as_the_gain_says",),
        **{
            f"NOISE_SHIFT_{axis}": (
                f"{NOISE}.test_against_the_reference_and_the_same_bits_at_every_width",
                "NOISE_SHIFT_",
            )
            for axis in "XYZ"
        },
    },
    "light/falloff_area.h": {"AREA_DENSITY_FLOOR": (_LIGHT,)},
    "light/falloff_inverse.h": {"LENGTH_FLOOR": (_LIGHT,)},
    "light/falloff_inverse_square.h": {"SQUARE_LENGTH_FLOOR": (_LIGHT,)},
    "light/lifted_ray.h": {"SURFACE_LIFT": (_SHADOWS, "shadows: hard")},
    "light/ambient_occlusion.h": {
        "OCCLUSION_HEIGHTS": (f"{E}.test_ambient_occlusion_beside_a_wall", "OCCLUSION_HEIGHTS"),
        "OCCLUSION_RATIO": (f"{E}.test_ambient_occlusion_beside_a_wall", "OCCLUSION_RATIO"),
        "OCCLUSION_TELEPORTS": (f"{E}.test_ambient_occlusion_beyond_walls", "reach: 3"),
    },
    "march/direct.h": {},
    "march/relaxed.h": {"RELAXATION": (f"{TRACERS}.test_any_relaxation_ends_at_the_same",)},
    "march/compound.h": {},
    "march/binary.h": dict.fromkeys(
        ("BINARY_BONUS", "BINARY_PENALTY", "BINARY_ACCURACY", "BINARY_FIRST"),
        (f"{TRACERS}.test_any_growth_of_the_balls_ends_at_the_same",),
    ),
    "march/loop.h": {},
    "block_start.cl": dict.fromkeys(
        ("BLOCK_MIDDLE", "BLOCK_WORTH", "BLOCK_ROUNDING", "BLOCK_END"),
        (f"{TRACERS}.test_blocks_start_before_the_surface",),
    ),
    "krs/empty_zones.h": {"ZONE_SLACK": (f"{KRS}.test_zone_slack_leads_out_of_the_zone",)},
    "krs/kernels.h": {
        "MOST_LEVELS": ("test_krs_model.test_forty_levels", "line_of_balls(41)"),
        **dict.fromkeys(("KERNEL_PART", "KERNEL_HEAD", "KERNEL_SIZE"), (_LAYOUT,)),
    },
    "krs/sphere.h": {"KRS_SPHERE": (_LAYOUT,)},
    "krs/plane.h": {"KRS_PLANE": (_LAYOUT,)},
    "krs/capsule.h": {"KRS_CAPSULE": (_LAYOUT,)},
    "krs/toroidal_capsule.h": {"KRS_TOROIDAL_CAPSULE": (_LAYOUT,)},
    "krs/lens_leaf.h": {"KRS_LENS_LEAF": (_LAYOUT,)},
    "krs/mirror.h": {"MIRROR_WIDTH": (_LAYOUT,)},
    "krs/moebius_map.h": {"MOEBIUS_SIZE": (_LAYOUT,)},
    "krs/moebius_sequence.h": {"MOEBIUS_HEAD": (_LAYOUT,)},
    "krs/bulge.h": {},
    "krs/sequence.h": {},
    "krs/twist.h": {},
    "march/stretch.h": {},
    "verify/carry.cl": dict.fromkeys(
        ("VERIFY_ASIDE", "VERIFY_STEP", "VERIFY_PASSES", "VERIFY_AHEAD", "VERIFY_ROUNDS"),
        ("test_accuracy_pictures.test_the_choices_of_carrying_do_not_matter",),
    ),
    "march.h": {"WALL_SLACK": ("test_fibred_cells.test_rays_hit_the_first_ball_of_the_orbit", "over_walls")},
}
# Named, but no seams: what a geometry is, how many fields there are, and pi.
NO_SEAMS = {"FIELDS", "HALF_PI", "HOMOGENEOUS", "PI_HIGH", "PI_LOW"}


def constants_of(part: str) -> set[str]:
    pattern = r"^#define (\w+) [^\n(]*(?:C\()?[-.\dxa-fp]+f?\)?(?:\s|$)"
    return set(re.findall(pattern, kernel_text(part), re.MULTILINE)) - NO_SEAMS


def test_every_file_with_a_constant_is_listed() -> None:
    for folder in ("shape", "light", "march", "krs"):
        for file in (files("thurston_cl.kernels") / folder).iterdir():
            part = f"{folder}/{file.name}"
            assert part in SEAMS or not constants_of(part), part


def source_of(module: str, test: str) -> str:
    """The text of a test, and of whatever its module defines that it uses, at any remove."""
    text = (Path(__file__).parent / f"{module}.py").read_text(encoding="utf-8")
    defined: dict[str, ast.stmt] = {}
    for statement in ast.parse(text).body:
        if isinstance(statement, ast.FunctionDef | ast.ClassDef):
            defined[statement.name] = statement
        elif isinstance(statement, ast.Assign):
            for name in (n.id for n in ast.walk(statement) if isinstance(n, ast.Name)):
                defined.setdefault(name, statement)
    assert test in defined, f"{module}.{test}"
    used, left = {test}, [test]
    while left:
        for node in ast.walk(defined[left.pop()]):
            if isinstance(node, ast.Name) and node.id in defined and node.id not in used:
                used.add(node.id)
                left.append(node.id)
    return "\n".join(ast.get_source_segment(text, defined[name]) or "" for name in sorted(used))


@pytest.mark.parametrize("part", SEAMS)
def test_every_named_constant_is_walked_over(part: str) -> None:
    assert constants_of(part) == set(SEAMS[part])
    for name, (where, *said) in SEAMS[part].items():
        module, test = where.split(".")
        assert (said or [name])[0] in source_of(module, test), f"{where} does not mention {name}"


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


def test_lengths_keep_their_digits_on_both_sides_of_the_complement(opencl_device: Device) -> None:
    """COMPLEMENT_ABOVE: near the fibre psi is tiny and its complement has lost its digits; far up the fibre
    of a far point it is the other way round. Single precision against double, in the mean of squares."""
    rng = np.random.default_rng(21)
    near, far = 10 ** rng.uniform(-4, -1, 3000), rng.uniform(6.5, 9, 3000)
    single, double = (Geometry("sl2", p, opencl_device, lanes=8) for p in ("single", "double"))
    # Half the height, less rho; and units of EPSILON.
    for rho, above in ((near, 10 ** rng.uniform(-3, 0.5, 3000)), (far, rng.uniform(10, 49, 3000))):
        x, height = cut(np.sinh(rho), "single"), cut(2 * (rho + above), "single")
        points = np.stack([x, 0 * x, np.sqrt(1 + x * x), height], axis=1)
        off = single.geodesics(points, 1)[1][:, 0] / double.distance(points) - 1
        assert np.sqrt((off**2).mean()) <= (1.0 if rho is near else 0.75) * EPSILON["single"], rho.max()


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
