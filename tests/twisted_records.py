"""How the records of nil and sl2 are held against the kernels: the same for both, with a table of errors
for each.

An error is allowed when it is below `factor * EPSILON * (1 + condition)`. The condition of a flow or an
area density is what relative changes of base, direction and time do to it, by numeric derivative with 50
digits; directions are rounded to single precision first, which this covers. Distances, lengths and
directions of geodesics have condition 1 everywhere, since differences of points keep their digits. On top
of that stand the limits of the contract, 4 times the table of math section 5, which speaks of geodesics
from the origin and of area densities away from conjugate points.
"""

import functools
from typing import Any, NamedTuple

import numpy as np
import pytest
import twisted
from golden import EPSILON, MP, Array, Case, Exact, exact, inputs, rounded

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry

WIDTHS = (1, 4, 16, 32)
# Units of EPSILON: about twice what PoCL measures.
FLOW_FACTOR = 3.0
AREA_FACTOR = 2.0
PAIR_FACTOR = 4.0
# Below this a factor of the area density counts as near a conjugate point (math section 5).
CONJUGATE_BELOW = 0.02


class Limits(NamedTuple):
    """4 times the entries of math section 5, in one precision; infinite where it has none."""

    plane: float = np.inf
    fibre: float = np.inf
    area: float = np.inf
    distance: float = np.inf
    direction: float = np.inf


class Expected(NamedTuple):
    """Values (N,K) wanted, what one unit of relative error may change them by, and the sizes of their
    errors."""

    values: Exact
    conditions: Array
    sizes: Array


@functools.cache
def expected(case: Case) -> dict[str, Expected]:
    """By quantity: point, direction, transport; or area."""
    u, t = inputs(case.column("u")), inputs(case.column("t"))
    if case.kind == "area":
        values = exact(case.column("area"))[:, None]
        changes = [twisted.area_sensitivity(case.geometry, *ray) for ray in zip(u, t, strict=True)]
        sizes = np.abs(rounded(values))
        return {"area": Expected(values, rounded(np.array(changes)[:, None]) / sizes, sizes)}
    base = twisted.as_points(case.geometry, case.column("base"))
    values = {
        "point": twisted.reached(case),
        "direction": exact(case.column("u_t")),
        "transport": exact(case.column("Q")).reshape(-1, 9),
    }
    changes = [twisted.flow_sensitivity(case.geometry, *ray) for ray in zip(base, u, t, strict=True)]
    rays = zip(values["point"], u, t, base, strict=True)
    sizes = {name: np.ones(value.shape) for name, value in values.items()}
    sizes["point"] = rounded(np.array([twisted.scales(case.geometry, *ray) for ray in rays]))
    return {
        name: Expected(value, rounded(np.array([c[name] for c in changes])) / sizes[name], sizes[name])
        for name, value in values.items()
    }


def errors(got: Array, want: Expected) -> Array:
    """Errors (N,K) relative to their sizes."""
    return rounded(np.abs(exact(got) - want.values)) / want.sizes


def fail_beyond(case: Case, what: str, got: Array, off: Array, allowed: Array) -> None:
    """Fail with the record whose error exceeds its tolerance most."""
    excess = np.where(np.isfinite(off), off / allowed, np.inf)
    record, entry = np.unravel_index(int(np.argmax(excess)), excess.shape)
    if not off[record, entry] <= allowed[record, entry]:
        pytest.fail(
            f"{case} {what}, record {record} of {len(off)}, entry {entry}\n"
            f"record    {case.records[record]}\n"
            f"got       {np.asarray(got)[record].tolist()}\n"
            f"error     {off[record, entry]:.3g}\n"
            f"tolerance {allowed[record, entry]:.3g}"
        )


def contract_limits(case: Case, quantity: str, limits: Limits, shape: tuple[int, ...]) -> Array:
    """The limits of math section 5 for each entry: they are for geodesics from the origin."""
    allowed = np.full(shape, np.inf)
    if quantity == "point":
        plane = 2 if case.geometry == "nil" else 3
        allowed[:, :plane], allowed[:, plane] = limits.plane, limits.fibre
        allowed[(inputs(case.column("base")) != 0).any(axis=1)] = np.inf
    elif quantity == "area":
        rays = zip(inputs(case.column("u")), inputs(case.column("t")), strict=True)
        regular = [min(twisted.area_factors(case.geometry, u, t)[1:]) > CONJUGATE_BELOW for u, t in rays]
        allowed[regular] = limits.area
    return allowed


def check_flow_or_area(case: Case, limits: Limits, precision: str, lanes: int, device: Device) -> None:
    g = Geometry(case.geometry, precision, device, lanes=lanes)
    assert g.lanes == lanes
    u, t = rounded(inputs(case.column("u"))), rounded(inputs(case.column("t")))
    if case.kind == "area":
        got = {"area": g.area_density(u, t)[:, None]}
    else:
        base = rounded(twisted.as_points(case.geometry, case.column("base")))
        point, direction = g.flow(u, t, base)
        got = {"point": point, "direction": direction, "transport": g.transport(u, t, base).reshape(-1, 9)}
    for quantity, want in expected(case).items():
        factor = AREA_FACTOR if quantity == "area" else FLOW_FACTOR
        allowed = factor * EPSILON[precision] * (1 + want.conditions)
        allowed = np.minimum(allowed, contract_limits(case, quantity, limits, allowed.shape))
        where = f"{quantity}, {precision} precision, width {lanes}"
        fail_beyond(case, where, got[quantity], errors(got[quantity], want), allowed)


def check_pairs(case: Case, count: int, limits: Limits, precision: str, lanes: int, device: Device) -> None:
    """Every geodesic of every record at its place, none that the record lacks, and the distance."""
    g = Geometry(case.geometry, precision, device, lanes=lanes)
    p, q = (rounded(twisted.as_points(case.geometry, case.column(key))) for key in ("p", "q"))
    directions, lengths = g.geodesics(q, count + 1, p)
    distance = g.distance(q, p)
    np.testing.assert_array_equal(distance, lengths[:, 0])
    for n, record in enumerate(case.records):
        where = f"{case}, record {n}: {record}, {precision} precision, width {lanes}"
        found = np.isfinite(lengths[n])
        assert (np.diff(lengths[n][found]) >= 0).all(), where
        assert abs(MP.mpf(distance[n]) / MP.mpf(record["distance"]) - 1) <= limits.distance, where
        if len(record["pairs"]) < count and case.regime != "axis":
            assert found.sum() == len(record["pairs"]), where
        for wanted in record["pairs"]:
            k = twisted.list_index(case.geometry, record, wanted)
            off_length = float(abs(MP.mpf(lengths[n, k]) / MP.mpf(wanted["d"]) - 1))
            off_direction = float(np.abs(exact(directions[n, k]) - exact(wanted["u"])).max())
            assert off_length <= min(PAIR_FACTOR * EPSILON[precision], limits.distance), (
                where,
                k,
                off_length,
            )
            assert off_direction <= min(PAIR_FACTOR * EPSILON[precision], limits.direction), (
                where,
                k,
                off_direction,
            )


def check_own_reference(case: Case) -> None:
    """The 50-digit flow of the tests agrees with the 25 digits of the records."""
    u, t = inputs(case.column("u")), inputs(case.column("t"))
    if case.kind == "area":
        for n, want in enumerate(exact(case.column("area"))):
            assert abs(twisted.area(case.geometry, u[n], t[n]) / want - 1) < 1e-20
        return
    base = twisted.as_points(case.geometry, case.column("base"))
    for n in range(len(u)):
        got = twisted.flow(case.geometry, base[n], u[n], t[n])
        for quantity, want in expected(case).items():
            assert (rounded(np.abs(got[quantity] - want.values[n])) / want.sizes[n]).max() < 1e-20, (
                case,
                n,
                quantity,
            )


def records_of(geometry: str, data: dict[str, Any], *kinds: str) -> list[Case]:
    """Every case that a file holds, of these kinds."""
    regimes = {"main": data} | data["hard"]
    return [
        Case(geometry, regime, kind) for regime, held in regimes.items() for kind in kinds if kind in held
    ]
