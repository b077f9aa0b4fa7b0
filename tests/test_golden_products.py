"""Every record of tests/data/s2xe.json and h2xe.json against the kernels: both precisions, widths 1 to 32,
and the widths against each other.

As in test_golden.py, an error is relative to the largest entry of a record's value and is held against
`factor * EPSILON * condition`, where the condition number is computed from the inputs of the record.
"""

import functools
import json
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from golden import (
    DATA,
    EPSILON,
    Array,
    Case,
    Exact,
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
FACTOR = {"s2xe": "s3", "h2xe": "h3"}

ALL = [
    *(Case(geometry, "main", kind) for geometry in FACTOR for kind in ("flow", "pairs", "area")),
    *(Case(geometry, "near_coincident", "pairs") for geometry in FACTOR),
    *(Case(geometry, "near_vertical_direction", kind) for geometry in FACTOR for kind in ("flow", "area")),
    Case("s2xe", "near_antipodal", "pairs"),
    Case("h2xe", "far_flow_t_10_40", "flow"),
]


def factor_points(geometry: str, xy: Exact, positive: Any = None) -> Exact:
    """Points (N,4) of S3 or H3 on the surface z = 0 from (N,2): the factor's, as golden.py has them."""
    flat = np.concatenate([xy, exact(np.zeros((len(xy), 1)))], axis=1)
    return on_model(FACTOR[geometry], flat, positive)


def product_points(geometry: str, xyw: Exact, positive: Any = None) -> Exact:
    """Points (N,4) of the product from (N,3); where `positive` is false, z < 0."""
    factor = factor_points(geometry, xyw[:, :2], positive)
    return np.stack([factor[:, 0], factor[:, 1], factor[:, 3], xyw[:, 2]], axis=1)


class Prepared(NamedTuple):
    """Inputs of a case, rounded to binary64 for the kernels and exact, and the values wanted by quantity."""

    given: dict[str, Array]
    exact: dict[str, Exact]
    wanted: dict[str, Exact]


@functools.cache
def prepared(case: Case) -> Prepared:
    others = {key: inputs(case.column(key)) for key in ("u", "t") if key in case.records[0]}
    points = {}
    if case.kind == "flow":
        points = {"base": product_points(case.geometry, inputs(case.column("base")))}
        wanted = {key: exact(case.column(key)) for key in ("point", "velocity", "transport")}
    elif case.kind == "pairs":
        points = {
            "p": product_points(case.geometry, inputs(case.column("p"))),
            "q": product_points(case.geometry, inputs(case.column("q")), case.column("q_last_positive")),
        }
        wanted = {"distance": exact(case.column("distance"))}
        for k in range(len(case.records[0]["pairs"])):
            wanted[f"length {k}"] = exact([pairs[k]["d"] for pairs in case.column("pairs")])
            wanted[f"direction {k}"] = exact([pairs[k]["L"] for pairs in case.column("pairs")])
    else:
        wanted = {"area": exact(case.column("area"))}
    inner = points | others
    return Prepared({key: rounded(value) for key, value in inner.items()}, inner, wanted)


def ambient_transport(case: Case, frames: Array) -> Exact:
    """The records' matrices on the factor, M(point) Q M(base)^-1 without the row and column of z = 0."""
    keep = np.ix_([0, 1, 3], [0, 1, 3])
    points = [
        factor_points(case.geometry, p[None, :2], [p[2] > 0])[0] for p in prepared(case).wanted["point"]
    ]
    bases = [factor_points(case.geometry, p[None, :2])[0] for p in prepared(case).exact["base"]]
    result = []
    for q, point, base in zip(frames, points, bases, strict=True):
        between = exact(np.eye(4))
        between[:3, :3] = exact(q)
        matrix = translation(FACTOR[case.geometry], point) @ between
        result.append((matrix @ inverse_translation(FACTOR[case.geometry], base))[keep])
    return np.array(result, dtype=object)


def computed(case: Case, precision: str, lanes: int, device: Device) -> dict[str, Any]:
    """What the kernels say, by quantity; "frames", which no record holds, is the transport between frames."""
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
    return {"area": g.area_density(given["u"], given["t"])}


# Condition numbers of the records of a case.
Condition = Callable[[Case], Array]


def none(case: Case) -> Array:
    """Rounding of the result and of the coordinates that make it up."""
    return np.ones(len(case.records))


def angle(case: Case) -> Array:
    """How far the geodesics of the records go along the factor."""
    given = prepared(case).given
    return np.hypot(given["u"][:, 0], given["u"][:, 1]) * given["t"]


def travelled(case: Case) -> Array:
    """s2xe: rounding of u is an error of that share of the angle."""
    return 1 + angle(case)


def frame(case: Case) -> Array:
    """s2xe: past the equator the frame turns as the point moves, the faster the nearer the antipode of o."""
    point = rounded(prepared(case).wanted["point"])
    turn = np.where(point[:, 2] < 0, 1 / np.linalg.norm(point[:, :2], axis=1), 1.0)
    return turn * travelled(case)


def heights(case: Case) -> Array:
    """h2xe: z_base z_travelled / z_reached of a flow, and rounding of u as in s2xe."""
    given, point = prepared(case).given, rounded(prepared(case).wanted["point"])
    return np.cosh(angle(case)) * given["base"][:, 2] / point[:, 2] * travelled(case)


def quantised(case: Case) -> Array:
    """h2xe: coordinates of size z fix a position and a direction to EPSILON z only."""
    return prepared(case).given["p"][:, 2]


def focus(case: Case) -> Array:
    """Relative change of the area density by one of the angle: the angle over its tangent."""
    theta = angle(case)
    tangent = np.tan(theta) if case.geometry == "s2xe" else np.tanh(theta)
    return 1 + np.abs(theta / tangent)


class Row(NamedTuple):
    """Allowed error in units of EPSILON times the condition. Factors are about twice what PoCL measures."""

    factor: float
    condition: Condition = none


TOLERANCES: dict[tuple[str, str], Row] = {
    ("s2xe", "point"): Row(3, travelled),
    ("s2xe", "velocity"): Row(3, frame),
    ("s2xe", "transport"): Row(3, frame),
    ("s2xe", "distance"): Row(3),
    ("s2xe", "direction"): Row(6),
    ("s2xe", "area"): Row(2, focus),
    ("h2xe", "point"): Row(3, heights),
    ("h2xe", "velocity"): Row(4, heights),
    ("h2xe", "transport"): Row(8, heights),
    ("h2xe", "distance"): Row(3),
    ("h2xe", "direction"): Row(4, quantised),
    ("h2xe", "area"): Row(2, focus),
}


def tolerance(case: Case, quantity: str, precision: str) -> Array:
    """Allowed relative errors (N,) of the records of a case."""
    name = quantity.split()[0]
    row = TOLERANCES[case.geometry, "distance" if name == "length" else name]
    return row.factor * EPSILON[precision] * row.condition(case)


def assert_within(case: Case, quantity: str, got: Any, wanted: Exact, allowed: Array, where: str) -> None:
    """Fail with the record that exceeds its tolerance most."""
    errors = relative_errors(got, wanted)
    worst = int(np.argmax(np.where(np.isfinite(errors), errors / allowed, np.inf)))
    if not errors[worst] <= allowed[worst]:
        pytest.fail(
            f"{case} {quantity}, {where}, record {worst} of {len(errors)}\n"
            f"record    {case.records[worst]}\n"
            f"got       {np.asarray(got)[worst].tolist()}\n"
            f"wanted    {rounded(wanted[worst : worst + 1])[0].tolist()}\n"
            f"error     {errors[worst]:.3g} relative\n"
            f"tolerance {allowed[worst]:.3g}"
        )


@pytest.mark.parametrize("geometry", FACTOR)
def test_every_record_is_read(geometry: str) -> None:
    data = json.loads((DATA / f"{geometry}.json").read_text(encoding="utf-8"))
    held = {("main", kind) for kind in ("flow", "pairs", "area")}
    held |= {(regime, kind) for regime, kinds in data["hard"].items() for kind in kinds}
    assert held == {(case.regime, case.kind) for case in ALL if case.geometry == geometry}
    assert len(held) == 7


@pytest.mark.parametrize("lanes", WIDTHS)
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("case", ALL, ids=str)
def test_records(case: Case, precision: str, lanes: int, opencl_device: Device) -> None:
    got = computed(case, precision, lanes, opencl_device)
    if case.kind == "flow":
        got["transport"] = ambient_transport(case, got.pop("frames"))
    for quantity, wanted in prepared(case).wanted.items():
        where = f"{precision} precision, width {lanes}"
        assert_within(case, quantity, got[quantity], wanted, tolerance(case, quantity, precision), where)


def depends_on_built_ins(case: Case, precision: str) -> bool:
    """Do exp, log or (in double only) atan2 of the device take part? Their vector forms may differ."""
    return case.geometry == "h2xe" or (precision == "double" and case.kind == "pairs")


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("case", ALL, ids=str)
def test_widths_agree(case: Case, precision: str, opencl_device: Device) -> None:
    """Bit by bit where only our own functions take part; else to 4 EPSILON, times the condition of a flow."""
    reference = computed(case, precision, REFERENCE_WIDTH, opencl_device)
    conditions = heights(case) if case.kind == "flow" and case.geometry == "h2xe" else none(case)
    for lanes in WIDTHS[1:]:
        values = computed(case, precision, lanes, opencl_device)
        for quantity, wanted in reference.items():
            if depends_on_built_ins(case, precision):
                allowed = 4 * EPSILON[precision] * conditions
                assert_within(
                    case, quantity, values[quantity], exact(wanted), allowed, f"width {lanes} against 1"
                )
            else:
                np.testing.assert_array_equal(values[quantity], wanted, f"{case} {quantity}, width {lanes}")
