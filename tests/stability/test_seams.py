"""Across every named constant at which a formula of geometry/, special/ or shape/ changes: results stay
within the accuracy that the head of the file states, and do not jump there by more.

sweeps.py holds the table. Truth has 50 digits (truth.py). `pytest -s` prints the largest error of each sweep.
"""

import functools

import numpy as np
import pytest
import sol
import test_products as products
import test_regimes
import test_twisted
from golden import EPSILON, FLOAT, MP, Array, cut, exact, rounded
from small_kernels import Body, SmallKernels
from test_special import Case, check_all

import thurston_cl as tc
from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.program import geometry_parts, kernel_text
from thurston_cl.scene.writer import shape_parts

from . import truth
from .sweeps import (
    BALLS,
    ELLIPTIC,
    NO_SWEEP,
    SWEEPS,
    BallSweep,
    Inputs,
    Rays,
    Sweep,
    inputs_of,
    lifted,
    sides,
    value_of,
)

LANES = 4


def errors_of(sweep: Sweep, given: Inputs, g: Geometry, double: Geometry) -> Array:
    """Signed errors (N,M) in the terms of the head."""
    name = sweep.geometry
    if isinstance(given, Rays):
        u, t, base = given
        if sweep.asked == "point":
            got, _ = g.flow(u, t, base)
            if base is not None:
                want = [products.ray(name, *row)[0] for row in zip(base, u, t, strict=True)]
                return np.array(
                    [rounded((exact(p) - w) / max(np.abs(w))) for p, w in zip(got, want, strict=True)]
                )
            want = [truth.flow(name, *row).point for row in zip(u, t, strict=True)]
            return np.array([truth.point_error(name, *row) for row in zip(u, t, want, got, strict=True)])
        if sweep.asked == "area":
            want = np.array([float(truth.area(name, *row)) for row in zip(u, t, strict=True)])
            size = np.maximum(want, np.minimum(t, 4.0) ** 2 / 4) if name == "sol" else want
            return ((g.area_density(u, t) - want) / size)[:, None]
        assert sweep.asked == "transport"
        got = g.transport(u, t).reshape(-1, 9)
        known = [sol.taylor(*row, order=26).transport for row in zip(u, t, strict=True)]
        return np.array([rounded(exact(q) - w.reshape(9)) for q, w in zip(got, known, strict=True)])
    point, base = given
    if sweep.asked == "underestimate":
        # Never above the distance, and as smooth as its rounding: what is missing is no error.
        got, want = g.underestimate(point), double.distance(point)
        assert (got <= want * (1 + 4 * EPSILON[g.precision])).all()
        return (got / want - 1)[:, None]
    lengths = g.distance(point, base)
    if sweep.asked == "length on the fibre":
        heights = np.abs(point[:, 2 if name == "nil" else 3])
        want = [h if h < 2 * np.pi else test_twisted.circle_length(name, 1, exact(h)[()]) for h in heights]
        return rounded(exact(lengths) / np.array(want) - 1)[:, None]
    starts, sizes = (x[:, 0] for x in double.geodesics(point, 1, base))
    rows = zip(base, point, starts, sizes, strict=True)
    want = [truth.shortest(name, b, p, (u, float(length))) for b, p, u, length in rows]
    if sweep.asked == "length":
        return np.array([[float(exact(d)[()] / w.length - 1)] for d, w in zip(lengths, want, strict=True)])
    assert sweep.asked == "direction"
    got = g.geodesics(point, 1, base)[0][:, 0]
    return np.array([truth.vector_error(w.direction, u) for u, w in zip(got, want, strict=True)])


@pytest.mark.parametrize("precision", EPSILON)
@pytest.mark.parametrize("index", range(len(SWEEPS)), ids=map(str, SWEEPS))
def test_no_error_and_no_jump(index: int, precision: str, opencl_device: Device) -> None:
    sweep = SWEEPS[index]
    if precision not in sweep.precisions:
        return
    g, double = (Geometry(sweep.geometry, p, opencl_device, lanes=LANES) for p in (precision, "double"))
    given = inputs_of(index, precision)
    errors = errors_of(sweep, given, g, double)
    stated = sweep.stated[precision == "double"]
    # Walk by walk, in order: the mean of the neighbours above against that of those below.
    e = sides(precision)
    walks = errors.reshape(-1, len(e), errors.shape[1])
    near = np.abs(e) <= 8 * EPSILON[precision]
    above, below = (walks[:, near & side].mean(axis=1) for side in (e > 0, e < 0))
    jump = np.abs(above - below).max()
    off = 0.0 if sweep.asked == "underestimate" else np.abs(errors).max()
    print(f"{precision} {sweep!s:60} error {off:8.1e}   jump {jump:8.1e}   stated {stated:8.1e}")
    worst = int(np.abs(errors).max(axis=1).argmax())
    where = [None if a is None else a[worst].tolist() for a in given]
    assert off <= stated, (where, errors[worst])
    assert jump <= stated, walks


@pytest.mark.parametrize("sweep", SWEEPS, ids=str)
def test_the_head_says_so(sweep: Sweep) -> None:
    for said in sweep.said:
        assert said in kernel_text(sweep.head), f"{sweep.head} does not say {said}"


# -- elliptic functions, by the public functions -------------------------------------------------------------

JACOBI = "special/jacobi.h"


def elliptic_cases(name: str, precision: str) -> list[Case]:
    """k' on both sides of the constant, with arguments at fractions of K."""
    cases = []
    for k in value_of(JACOBI, name, precision) * (1 + sides(precision)):
        # The parameter keeps its tail: k' is the root of what is given.
        case = Case("m1", float(k * k))
        cases += [case.at(part * case.quarter, precision) for part in (0.2, 0.5, 0.9, 2.3)]
    return cases


@pytest.mark.parametrize("precision", EPSILON)
@pytest.mark.parametrize("name", [name for name in ELLIPTIC if name != "SECH_END"])
def test_elliptic_functions(name: str, precision: str, opencl_device: Device) -> None:
    """All of tc.special, within the table of the head and the rounding of the parameter's root."""
    check_all(elliptic_cases(name, precision), precision, opencl_device, LANES, more=1.0)


@pytest.mark.parametrize("precision", EPSILON)
def test_hyperbolic_functions_end(precision: str, opencl_device: Device) -> None:
    """SECH_END: k' = 0 and arguments on both sides of it; beyond, cn and dn are below the least number that
    has all digits."""
    u = cut(value_of(JACOBI, "SECH_END", precision) * (1 + sides(precision)), precision)
    sn, cn, dn, zeta = tc.special.jacobi(u, m1=0.0, precision=precision, device=opencl_device, lanes=LANES)
    sech = np.array([float(MP.sech(MP.mpf(float(x)))) for x in u])
    least = float(np.finfo(FLOAT[precision]).tiny)
    assert (np.abs(cn - sech) <= 4 * EPSILON[precision] * (1 + u) * sech + 1.1 * least).all()
    np.testing.assert_array_equal(dn, cn)
    assert (np.diff(cn) <= 0).all() and (sn == 1).all() and (zeta == 1).all()


# -- shapes whose bounds change ------------------------------------------------------------------------------


@functools.cache
def shape_kernels(geometry: str, precision: str, device: Device) -> SmallKernels:
    bodies = {"ball": Body(5, 1, "OUT(0, ball_distance(POINT(0), IN(4)));")}
    shapes = ["ball"]
    if geometry != "sol":
        shapes.append("bisected_half_space")
        text = "OUT(0, bisected_half_space_distance(POINT(0), push(POINT(0), first_3(POINT(4)))));"
        bodies["bisected_half_space"] = Body(8, 1, text)
    parts = (*geometry_parts(geometry), "scene_types.h", *sorted(shape_parts(geometry, shapes)))
    return SmallKernels(device, parts, bodies, precision, LANES)


@pytest.mark.parametrize("precision", EPSILON)
@pytest.mark.parametrize("ball", BALLS, ids=str)
def test_balls_keep_their_bounds(ball: BallSweep, precision: str, opencl_device: Device) -> None:
    """Where a guess is cut off or another bound begins: never beyond the distance, never less than 2/5 of
    it, on the right side; whatever the radius."""
    g = Geometry(ball.geometry, "double", opencl_device, lanes=LANES)
    kernels = shape_kernels(ball.geometry, precision, opencl_device)
    points = ball.drive(value_of(ball.part, ball.constant, precision) * (1 + sides(precision)), g)
    points = cut(points, precision)
    if ball.geometry == "sl2":
        points[:, 2] = np.sqrt(1 + points[:, 0] ** 2 + points[:, 1] ** 2)
    lengths = g.distance(points)
    for radius in (0.25, 1.5, *(float(lengths.mean() * s) for s in (0.5, 0.999, 1.001, 2.0))):
        radius = float(np.float32(radius))
        want = lengths - radius
        got = kernels.run("ball", [*points.T, np.full(len(points), radius)])[0].astype(float)
        side, rounding = np.sign(want), 8 * EPSILON[precision] * (np.abs(want) + radius + 1)
        assert (side * got <= side * want + rounding).all(), (radius, got, want)
        assert (side * got >= 0.4 * side * want - rounding).all(), (radius, got, want)


@pytest.mark.parametrize("precision", EPSILON)
@pytest.mark.parametrize("geometry", ["nil", "sl2"])
def test_a_bisection_ends_at_the_level_or_at_its_probe(
    geometry: str, precision: str, opencl_device: Device
) -> None:
    """PROBE: down the fibre from heights on both sides of it."""
    probe = value_of("shape/bisected_half_space.h", "PROBE", precision)
    heights = cut(probe * (1 + sides(precision)), precision)
    points = lifted(geometry, 0 * heights, 0 * heights, heights)
    rows = np.concatenate([points, np.broadcast_to([0.0, 0, -1, 0], points.shape)], axis=1)
    got = shape_kernels(geometry, precision, opencl_device).run("bisected_half_space", rows.T)[0]
    assert np.abs(got - np.minimum(heights, probe)).max() <= 2 * EPSILON[precision]


# -- nothing is left out -------------------------------------------------------------------------------------

HERE = ("geometry/", "special/", "shape/")
ISOTROPIC = (
    "geometry/e3.h",
    "geometry/s3.h",
    "geometry/h3.h",
    "geometry/isotropic.h",
    "special/elementary.h",
)


def test_every_constant_is_swept_or_has_a_reason() -> None:
    parts = [part for part in test_regimes.SEAMS if part.startswith(HERE)] + [*ISOTROPIC]
    named = {(part, name) for part in parts for name in test_regimes.constants_of(part)} - {
        (part, "CURVATURE") for part in ISOTROPIC
    }
    swept = {(s.part, s.constant) for s in (*SWEEPS, *BALLS)} | {(JACOBI, name) for name in ELLIPTIC}
    swept.add(("shape/bisected_half_space.h", "PROBE"))
    assert swept <= named, swept - named
    assert named - swept == set(NO_SWEEP), (named - swept) ^ set(NO_SWEEP)
