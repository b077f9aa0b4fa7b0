"""Every record of tests/data against the kernels: both precisions, widths 1 to 64, and width against width.

An error is relative to the largest entry of a record's value and is held against `factor * EPSILON *
condition`, where the condition number of the record is computed from its inputs. On top of that stand limits:
1e-13 in double, and four times what a prototype of the stable formulas reached in single (see REGIMES).
"""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from golden import (
    EPSILON,
    Array,
    Case,
    Exact,
    cases,
    distance,
    exact,
    inputs,
    inverse_translation,
    on_model,
    relative_errors,
    rounded,
    translation,
)

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry

PRECISIONS = ("single", "double")
REFERENCE_WIDTH = 1
WIDTHS = (1, 4, 16, 32)
# These only in one precision of h3, which uses most built-ins: 64 lanes take four times as long to compile.
MORE_WIDTHS = (8, 64)

NEAR = "near_coincident_1e-12_to_1e-2"
FAR = "both_far_r_8_to_15_sep_0.01_to_3"


class Prepared(NamedTuple):
    """Inputs of a case, rounded to binary64 for the kernels and exact, and the values wanted by quantity."""

    given: dict[str, Array]
    exact: dict[str, Exact]
    wanted: dict[str, Exact]


@functools.cache
def prepared(case: Case) -> Prepared:
    if case.kind == "flow":
        points = {"base": on_model(case.geometry, inputs(case.column("base")))}
        others = {"u": inputs(case.column("u")), "t": inputs(case.column("t"))}
        wanted = {key: exact(case.column(key)) for key in ("point", "velocity", "transport")}
    elif case.kind == "pairs":
        points = {
            "p": on_model(case.geometry, inputs(case.column("p"))),
            "q": on_model(case.geometry, inputs(case.column("q")), case.column("q_last_positive")),
        }
        others = {}
        found = [
            [*zip(*((pair["d"], pair["L"]) for pair in pairs), strict=True)] for pairs in case.column("pairs")
        ]
        wanted = {"distance": exact(case.column("distance"))}
        for k in range(len(found[0][0])):
            wanted[f"length {k}"] = exact([lengths[k] for lengths, _ in found])
            wanted[f"direction {k}"] = exact([directions[k] for _, directions in found])
    else:
        points, others = {}, {"t": inputs(case.column("t"))}
        wanted = {"area": exact(case.column("area"))}
    inner = points | others
    return Prepared({key: rounded(value) for key, value in inner.items()}, inner, wanted)


def ambient_transport(case: Case, frames: Array) -> Exact:
    """M(point) Q M(base)^-1 of the records, from the transport Q (N,3,3) between the frames there."""
    between = exact(np.broadcast_to(np.eye(4), (len(frames), 4, 4)))
    between[:, :3, :3] = exact(frames)
    return np.array(
        [m @ q @ n for (m, n), q in zip(frame_matrices(case), between, strict=True)], dtype=object
    )


@functools.cache
def frame_matrices(case: Case) -> list[tuple[Exact, Exact]]:
    """M(point) and M(base)^-1 of the records of flows."""
    ends = zip(prepared(case).wanted["point"], prepared(case).exact["base"], strict=True)
    return [(translation(case.geometry, p), inverse_translation(case.geometry, b)) for p, b in ends]


@functools.cache
def computed(case: Case, precision: str, lanes: int, device: Device) -> dict[str, Any]:
    """What the kernels say, by quantity; "frames", the transport between frames, is in no record."""
    g = Geometry(case.geometry, precision, device, lanes=lanes)
    assert g.lanes == lanes
    given = prepared(case).given
    if case.kind == "flow":
        ray = (given["u"], given["t"], given["base"])
        point, direction = g.flow(*ray)
        return {"point": point, "velocity": g.velocity(point, direction), "frames": g.transport(*ray)}
    if case.kind == "pairs":
        count = len(case.records[0]["pairs"])
        directions, lengths = g.geodesics(given["q"], count, given["p"])
        values: dict[str, Any] = {"distance": g.distance(given["q"], given["p"])}
        for k in range(count):
            values[f"length {k}"] = lengths[:, k]
            values[f"direction {k}"] = g.velocity(given["p"], directions[:, k])
        return values
    return {"area": g.area_density([0, 0, 1], given["t"])}


# Condition numbers of the records of a case, for one precision.
Condition = Callable[[Case, str], Array]


def none(case: Case, precision: str) -> Array:
    """Rounding of the result and of the coordinates that make it up."""
    return np.ones(len(case.records))


def tail(case: Case, precision: str) -> Array:
    """Single precision knows a coordinate to 48 bits, a number and its tail: EPSILON^2 over the separation,
    relative.

    Separation means that of p from q or from its antipode, or of t from a zero of the area density. Double
    precision has the inputs exactly.
    """
    if precision == "double":
        return none(case, precision)
    if case.kind == "area":
        separation = np.abs(np.sin(prepared(case).given["t"]))
        size = prepared(case).given["t"]
    else:
        apart = rounded(prepared(case).wanted["distance"])
        separation = np.minimum(apart, np.pi - apart) if case.geometry == "s3" else apart
        size = np.abs(prepared(case).given["p"]).max(axis=1)
    return 1 + EPSILON[precision] * size / separation


def frame(case: Case, precision: str) -> Array:
    """s3: beyond the equator the frame turns as the point moves, the faster the nearer -origin is."""
    point = rounded(prepared(case).wanted["point"])
    return np.where(point[:, 3] < 0, 1 / np.linalg.norm(point[:, :3], axis=1), 1.0)


def heights(case: Case, precision: str) -> Array:
    """h3: w_base w_travelled / w_reached, and what |u| differs from 1 in the record's input, which speeds up
    the flow there.
    """
    given, point = prepared(case).given, rounded(prepared(case).wanted["point"])
    speed = np.abs([np.sqrt((u**2).sum()) - 1 for u in prepared(case).exact["u"]]).astype(np.float64)
    height = np.cosh(given["t"]) * given["base"][:, 3] / point[:, 3]
    return height * (1 + given["t"] * speed / EPSILON[precision])


def quantised(case: Case, precision: str) -> Array:
    """h3, far out: coordinates of size w fix a position and a direction to EPSILON w only."""
    return prepared(case).given["p"][:, 3]


class Row(NamedTuple):
    """Allowed error in units of EPSILON times the condition, and limits in single and in double."""

    factor: float
    condition: Condition = none
    single: float = np.inf
    double: float = 1e-13


# By geometry, regime ("" for every other one) and quantity. Factors are about twice what PoCL measures; the
# limits for single are 4 times what the prototype reached, which knew distances only.
TOLERANCES: dict[tuple[str, str, str], Row] = {
    ("e3", "", "point"): Row(3),
    ("e3", "", "velocity"): Row(2),
    ("e3", "", "transport"): Row(1),
    ("e3", "", "distance"): Row(3),
    ("e3", "", "direction"): Row(3),
    ("e3", "", "area"): Row(3),
    ("e3", NEAR, "distance"): Row(2, tail),
    ("e3", NEAR, "direction"): Row(3, tail),
    ("s3", "", "point"): Row(8),
    ("s3", "", "velocity"): Row(16, frame),
    ("s3", "", "transport"): Row(12, frame),
    ("s3", "", "distance"): Row(3),
    ("s3", "", "direction"): Row(3),
    ("s3", "", "area"): Row(6),
    ("s3", "area_near_pi", "area"): Row(6, tail),
    ("s3", NEAR, "distance"): Row(3, tail, single=4 * 2.5e-7),
    ("s3", NEAR, "direction"): Row(4, tail),
    ("s3", "near_antipodal", "distance"): Row(2, single=4 * 6.6e-8),
    ("s3", "near_antipodal", "direction"): Row(6, tail),
    ("h3", "", "point"): Row(8, heights),
    ("h3", "", "velocity"): Row(8, heights),
    ("h3", "", "transport"): Row(12, heights),
    ("h3", "", "distance"): Row(4, single=4 * 1.7e-7),
    ("h3", "", "direction"): Row(4),
    ("h3", "", "area"): Row(4),
    ("h3", NEAR, "distance"): Row(4, single=4 * 1.5e-7),
    ("h3", NEAR, "direction"): Row(3, quantised),
    ("h3", FAR, "distance"): Row(0.3, quantised, single=4 * 1.4e-3, double=1e-11),
    ("h3", FAR, "direction"): Row(12, quantised, double=np.inf),
}


def tolerance(case: Case, quantity: str, precision: str) -> Array:
    """Allowed relative errors (N,) of the records of a case."""
    name = quantity.split()[0]
    name = "distance" if name == "length" else name
    row = TOLERANCES.get((case.geometry, case.regime, name)) or TOLERANCES[case.geometry, "", name]
    limit = row.single if precision == "single" else row.double
    return np.minimum(row.factor * EPSILON[precision] * row.condition(case, precision), limit)


def assert_within(case: Case, quantity: str, got: Any, wanted: Any, allowed: Array, where: str) -> None:
    """Fail with the record that exceeds its tolerance most."""
    errors = relative_errors(got, wanted)
    worst = int(np.argmax(np.where(np.isfinite(errors), errors / allowed, np.inf)))
    if not errors[worst] <= allowed[worst]:
        pytest.fail(
            f"{case} {quantity}, {where}, record {worst} of {len(errors)}\n"
            f"record    {case.records[worst]}\n"
            f"got       {np.asarray(got)[worst].tolist()}\n"
            f"wanted    {wanted[worst : worst + 1].astype(np.float64)[0].tolist()}\n"
            f"error     {errors[worst]:.3g} relative\n"
            f"tolerance {allowed[worst]:.3g}"
        )


def check(case: Case, precision: str, lanes: int, device: Device) -> None:
    got = dict(computed(case, precision, lanes, device))
    if case.kind == "flow":
        got["transport"] = ambient_transport(case, got["frames"])
    for quantity, wanted in prepared(case).wanted.items():
        where = f"{precision} precision, width {lanes}"
        assert_within(case, quantity, got[quantity], wanted, tolerance(case, quantity, precision), where)


ALL = cases("flow", "pairs", "area")


def test_the_data_hold_what_the_tables_name() -> None:
    assert len(ALL) == 19
    assert {(c.geometry, c.regime) for c in ALL} >= {(g, regime) for g, regime, _ in TOLERANCES if regime}


def test_the_tests_own_distance_agrees_with_the_data() -> None:
    for case in cases("pairs"):
        p, q = prepared(case).exact["p"], prepared(case).exact["q"]
        errors = [
            abs(a / b - 1)
            for a, b in zip(distance(case.geometry, p, q), prepared(case).wanted["distance"], strict=True)
        ]
        assert max(errors) < 1e-20, case


@pytest.mark.parametrize("lanes", WIDTHS)
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("case", ALL, ids=str)
def test_records(case: Case, precision: str, lanes: int, opencl_device: Device) -> None:
    check(case, precision, lanes, opencl_device)


@pytest.mark.parametrize("lanes", MORE_WIDTHS)
@pytest.mark.parametrize("case", [case for case in ALL if case.geometry == "h3"], ids=str)
def test_records_at_the_other_widths(case: Case, lanes: int, opencl_device: Device) -> None:
    check(case, "single", lanes, opencl_device)


def depends_on_built_ins(case: Case, quantity: str, precision: str) -> bool:
    """Do exp, log or (in double) atan2 of the device take part, whose vector forms may round differently?"""
    if case.geometry == "h3":
        return True
    return (
        case.geometry == "s3" and precision == "double" and quantity in ("distance", "length 0", "length 1")
    )


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("case", ALL, ids=str)
def test_widths_agree(case: Case, precision: str, opencl_device: Device) -> None:
    """Bit by bit where only our own functions take part; else to 4 EPSILON, times the condition of a flow."""
    reference = computed(case, precision, REFERENCE_WIDTH, opencl_device)
    conditions = (
        heights(case, precision) if case.kind == "flow" and case.geometry == "h3" else none(case, precision)
    )
    for lanes in WIDTHS[1:]:
        values = computed(case, precision, lanes, opencl_device)
        for quantity, wanted in reference.items():
            if depends_on_built_ins(case, quantity, precision):
                allowed = 4 * EPSILON[precision] * conditions
                assert_within(case, quantity, values[quantity], wanted, allowed, f"width {lanes} against 1")
            else:
                np.testing.assert_array_equal(values[quantity], wanted, f"{case} {quantity}, width {lanes}")


class Regime(NamedTuple):
    """How pairs of points are drawn, and the largest errors of distance that a prototype of the stable
    formulas made on 800 of them, in double and in single.
    """

    name: str
    geometry: str
    radius: tuple[float, float]
    separation: tuple[float, float] | None  # None: the second point is drawn like the first
    double: float
    single: float
    antipodal: bool = False


REGIMES = (
    # Not near the equator w = 0, where three coordinates fix a point badly; for that see test_geometry.py.
    Regime("near", "s3", (0, 1.4), (1e-6, 1e-2), 2.9e-16, 2.5e-7),
    Regime("antipodal", "s3", (0, 1.4), (1e-6, 1e-2), 2.9e-17, 6.6e-8, antipodal=True),
    Regime("near", "h3", (0, 2), (1e-6, 1e-2), 3.0e-16, 1.5e-7),
    Regime("random", "h3", (0, 3), None, 3.7e-16, 1.7e-7),
    Regime("r6", "h3", (6, 6), (0.1, 3), 6.4e-15, 4.2e-6),
    Regime("r12", "h3", (12, 12), (0.1, 3), 3.4e-12, 1.4e-3),
    # Where coordinates reach 1e13, whose squares overflow in single: the prototype failed.
    Regime("far", "h3", (20, 30), None, 9.4e-17, EPSILON["single"]),
)
PAIRS = 300


def draw(regime: Regime, precision: str) -> tuple[Exact, Exact]:
    """Pairs of points (N,4) whose first three coordinates are numbers of the precision."""
    rng = np.random.default_rng(5)
    dtype = np.float64 if precision == "double" else np.float32

    def exponential(low: float, high: float, uniform: bool) -> Exact:
        u = rng.normal(size=(PAIRS, 3))
        r = (
            rng.uniform(low, high, PAIRS)
            if uniform
            else np.exp(rng.uniform(np.log(low), np.log(high), PAIRS))
        )
        sine, cosine = (np.sin, np.cos) if regime.geometry == "s3" else (np.sinh, np.cosh)
        x = u / np.linalg.norm(u, axis=1)[:, None] * sine(r)[:, None]
        return exact(np.concatenate([x, cosine(r)[:, None]], axis=1))

    p = exponential(*regime.radius, uniform=True)
    if regime.separation is None:
        q = exponential(*regime.radius, uniform=True)
    else:
        near = exponential(*regime.separation, uniform=False)
        q = np.array([translation(regime.geometry, a) @ b for a, b in zip(p, near, strict=True)])
    if regime.antipodal:
        q = -q
    first, second = (on_model(regime.geometry, exact(x[:, :3].astype(dtype)), x[:, 3] >= 0) for x in (p, q))
    return first, second


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("regime", REGIMES, ids=lambda regime: f"{regime.geometry}-{regime.name}")
def test_distance_is_as_good_as_the_prototypes(regime: Regime, precision: str, opencl_device: Device) -> None:
    """Within 4 times the errors of the prototype, whose references too were computed from rounded inputs."""
    p, q = draw(regime, precision)
    g = Geometry(regime.geometry, precision, opencl_device, lanes=16)
    wanted = distance(regime.geometry, p, q)
    errors = relative_errors(g.distance(rounded(q), rounded(p)), wanted)
    worst = int(errors.argmax())
    # No result can be better than its own rounding.
    allowed = max(4 * getattr(regime, precision), EPSILON[precision])
    assert errors[worst] <= allowed, (
        rounded(p)[worst].tolist(),
        rounded(q)[worst].tolist(),
        float(wanted[worst]),
    )
