"""Every record of tests/data/sol_flow.json and sol_distance.json against the kernels of Sol, in both
precisions, at widths 1 to 32: points, directions, transport, distances, lists of geodesics, area densities.

Directions and times are rounded to the precision first. Truth for those is the long arithmetic of
tests/sol.py, held against the records here; for transport in single precision it is double precision, held
against them here. Distances keep what precision cuts off a point: the records themselves are the truth.
"""

import functools
import json
from typing import Any, NamedTuple

import numpy as np
import pytest
import sol
from golden import DATA, EPSILON, MP, Array, cut, exact, rounded

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry

FLOWS = json.loads((DATA / "sol_flow.json").read_text(encoding="utf-8"))["flow"]
_DISTANCES = json.loads((DATA / "sol_distance.json").read_text(encoding="utf-8"))
CASES, AREAS = _DISTANCES["cases"], _DISTANCES["area"]
# Geodesics of each record at most; lists that are shorter are complete.
LONGEST_LIST = 7

both_precisions = pytest.mark.parametrize("precision", EPSILON)
every_kernel = pytest.mark.parametrize(
    ("precision", "lanes"), [(precision, lanes) for precision in EPSILON for lanes in (1, 4, 16, 32)]
)


class Limit(NamedTuple):
    """An error of the tables of math, and the one measured, of which 4 and 2 times are allowed."""

    tabled: float
    measured: float

    @property
    def allowed(self) -> float:
        return min(4 * self.tabled, 2 * self.measured)


def limits(single: tuple[float, float], double: tuple[float, float]) -> dict[str, Limit]:
    return {"single": Limit(*single), "double": Limit(*double)}


# sol-flow.md, section 3: errors of points relative to max(1, size), here also to times below 1.
_PLANES = limits((1.3e-6, 3.0e-7), (3.9e-15, 5.0e-16))
_LEVEL = limits((4.2e-7, 1.3e-7), (1.3e-15, 2.7e-16))
_STRAIGHT = limits((3.8e-7, 1.3e-7), (8.0e-16, 5.0e-16))
_VERTICAL = limits((1.6e-6, 2.2e-7), (6.5e-15, 3.3e-16))
_RANDOM = limits((1.0e-6, 2.8e-7), (2.2e-15, 5.1e-16))
POINT = {
    "random": _RANDOM,
    "near_a0": _PLANES,
    "near_b0": _PLANES,
    "planar_a0": _PLANES,
    "planar_b0": _PLANES,
    "vertical_exact": _VERTICAL,
    "near_vertical": _VERTICAL,
    "k0_exact": _STRAIGHT,
    "near_k0": _STRAIGHT,
    "horizontal": _LEVEL,
    "short_t": limits((1.3e-6, 1.7e-7), (3.9e-15, 6.0e-16)),
    "long_t": limits((1.2e-6, 2.3e-7), (2.5e-15, 3.4e-16)),
    "negative_t": _RANDOM,
}
# By time, up to which: of directions (section 3); and of the entries of transport (section 2, up to 10).
DIRECTION = {
    1.0: limits((1.1e-6, 3.5e-7), (3.2e-15, 9.5e-16)),
    10.0: limits((4.4e-6, 2.5e-6), (1.3e-14, 5.0e-15)),
    100.0: limits((2.5e-5, 4.2e-6), (5.4e-14, 7.3e-15)),
}
TRANSPORT = {
    1.0: limits((2.6e-6, 4.6e-7), (8.4e-15, 8.2e-16)),
    10.0: limits((1.7e-5, 2.1e-6), (1.9e-13, 7.0e-15)),
    100.0: limits((np.inf, 2.9e-5), (np.inf, 2.9e-13)),
}
# sol-distance.md, sections 1 and 5, over the distance; near the ends of the shortest, directions lose digits.
DISTANCE = limits((2.1e-6, 3.3e-7), (1.4e-14, 1.7e-15))
DIRECTION_THERE = limits((3.0e-5, 1.3e-6), (1.5e-8, 2.3e-15))
# Next to the ends of the cut locus, where two geodesics fuse, by EPSILON over the square of c.
DIRECTION_AT_CUT = limits((1.6e-2, 6.8e-6), (1.5e-8, 5.2e-15))
FURTHER_LENGTH = limits((2.1e-6, 3.0e-7), (1.4e-14, 3.4e-16))
FURTHER_DIRECTION = limits((3.0e-5, 2.7e-7), (1.5e-8, 3.4e-16))
# Section 3.
AREA = {
    "before-period": limits((np.inf, 1e-5), (1.3e-13, 9e-16)),
    "after-period": limits((np.inf, 8e-7), (1.3e-13, 4.7e-15)),
    "near-degenerate": limits((np.inf, 1.5e-5), (1.3e-13, 6.5e-14)),
}


def row(table: dict[float, dict[str, Limit]], t: float, precision: str) -> Limit:
    return next(limits[precision] for end, limits in table.items() if abs(t) <= end)


@functools.cache
def rays(precision: str) -> tuple[Array, Array]:
    u = sol.directions([[float(c) for c in record["direction"]] for record in FLOWS], precision)
    return u, cut([float(record["t"]) for record in FLOWS], precision)


def worst(name: str, found: list[tuple[str, float, Limit, Any]]) -> None:
    """Print the largest error of each regime, and fail with the record that exceeds its limit most."""
    for regime in dict.fromkeys(f[0] for f in found):
        error, limit = max((f[1], f[2].measured) for f in found if f[0] == regime)
        print(f"{name:24} {regime:20} {error:8.1e}   stated {limit:8.1e}")
    regime, error, limit, said = max(found, key=lambda f: f[1] / f[2].allowed if f[1] == f[1] else np.inf)
    assert error <= limit.allowed, f"{name}, {regime}: error {error:.3g}, allowed {limit.allowed:.3g}\n{said}"


def test_the_data_hold_what_the_tables_name() -> None:
    assert (len(FLOWS), len(CASES), len(AREAS)) == (152, 129, 26)
    assert {record["regime"] for record in FLOWS} == set(POINT)
    assert {record["regime"] for record in AREAS} == set(AREA)
    assert max(len(record.get("extra_geodesics", [])) for record in CASES) == LONGEST_LIST - 1


def test_the_truth_of_the_tests_agrees_with_the_records() -> None:
    for record in FLOWS:
        state, point = sol.flow(record["direction"], MP.mpf(record["t"])), exact(record["point"][:3])
        stretch, scale = MP.exp(point[2]), max(MP.mpf(1), sol.size(point))
        error = (state.point - point) * np.array([1 / stretch, stretch, MP.mpf(1)], dtype=object) / scale
        assert max(abs(c) for c in error) < 1e-23, record
        assert max(abs(c) for c in state.direction - exact(record["u"])) < 1e-23, record
    for record in AREAS:
        area = sol.area(record["direction_unnormalised"], MP.mpf(record["t"]))
        assert abs(area / MP.mpf(record["A"]) - 1) < 1e-22, record
    for record in FLOWS[::19]:
        if abs(float(record["t"])) < 0.6:
            state = sol.taylor(record["direction"], MP.mpf(record["t"]))
            assert state.transport is not None
            assert max(abs(c) for c in state.transport.reshape(-1) - exact(record["Q"])) < 1e-23, record
            assert sol.off(state.point, rounded(exact(record["point"]))) < 1e-15, record


@every_kernel
def test_flows(precision: str, lanes: int, opencl_device: Device) -> None:
    u, t = rays(precision)
    points, ends = Geometry("sol", precision, opencl_device, lanes=lanes).flow(u, t)
    there, ahead = [], []
    for record, state, time, point, end in zip(FLOWS, sol.flows(u, t), t, points, ends, strict=True):
        regime, said = record["regime"], (record["direction"], record["t"], point, end)
        off = sol.off(state.point, point) / min(1, abs(time))
        there.append((regime, off, POINT[regime][precision], said))
        off = float(max(abs(c) for c in exact(end) - state.direction))
        ahead.append((regime, off, row(DIRECTION, time, precision), said))
    worst(f"{precision} point", there)
    worst(f"{precision} direction", ahead)


@every_kernel
def test_transport(precision: str, lanes: int, opencl_device: Device) -> None:
    u, t = rays(precision)
    got = Geometry("sol", precision, opencl_device, lanes=lanes).transport(u, t).reshape(-1, 9)
    if precision == "double":
        want = np.array([exact(record["Q"]) for record in FLOWS])
    else:
        want = exact(
            Geometry("sol", "double", opencl_device, lanes=1).transport(sol.directions(u, "double"), t)
        )
    off = np.abs(exact(got) - want.reshape(-1, 9)).max(axis=1).astype(float)
    spans = ["up to 1" if abs(time) <= 1 else "up to 10" if abs(time) <= 10 else "beyond" for time in t]
    found = [
        (span, float(error), row(TRANSPORT, time, precision), record)
        for span, error, time, record in zip(spans, off, t, FLOWS, strict=True)
    ]
    worst(f"{precision} transport", found)


def point_of(record: dict[str, Any]) -> list[float]:
    return [*(float(c) for c in record["p"]), 1.0]


@pytest.mark.filterwarnings("error")
@every_kernel
def test_distances_and_lists_of_geodesics(precision: str, lanes: int, opencl_device: Device) -> None:
    g = Geometry("sol", precision, opencl_device, lanes=lanes)
    points = np.array([point_of(record) for record in CASES])
    u, lengths = g.geodesics(points, LONGEST_LIST + 1)
    distance = g.distance(points)
    shortest, ahead, further, further_ahead = [], [], [], []
    for n, record in enumerate(CASES):
        regime, want, said = (
            record["regime"],
            MP.mpf(record["distance"]),
            (record, distance[n], u[n], lengths[n]),
        )
        cut_locus = "cut-locus" in regime
        for length in (distance[n], lengths[n, 0]):
            shortest.append((regime, abs(float(length / want - 1)), DISTANCE[precision], said))
        directions = [record[key] for key in ("direction", "second_direction") if key in record]
        off = min(float(max(abs(c) for c in exact(u[n, 0]) - exact(d))) for d in directions)
        ahead.append((regime, off, (DIRECTION_AT_CUT if cut_locus else DIRECTION_THERE)[precision], said))
        extra = record.get("extra_geodesics", [])
        known = lengths[n, np.isfinite(lengths[n])]
        assert (np.diff(known) >= -4 * EPSILON[precision] * known[1:]).all(), said
        assert np.isfinite(lengths[n, : len(known)]).all(), said
        if extra:
            assert len(known) - 1 == len(extra) or len(known) - 1 > len(extra) == LONGEST_LIST - 1, said
        windings = np.floor(lengths[n] / sol.periods(u[n]))
        for k, geodesic in enumerate(extra, 1):
            length, off = MP.mpf(geodesic["length"]), exact(u[n, k]) - exact(geodesic["direction"])
            further.append((regime, abs(float(lengths[n, k] / length - 1)), FURTHER_LENGTH[precision], said))
            further_ahead.append(
                (regime, float(max(abs(c) for c in off)), FURTHER_DIRECTION[precision], said)
            )
            assert windings[k] == geodesic["windings"], (k, said)
    worst(f"{precision} distance", shortest)
    worst(f"{precision} its direction", ahead)
    worst(f"{precision} lengths", further)
    worst(f"{precision} their directions", further_ahead)


@both_precisions
def test_both_geodesics_to_points_of_the_cut_locus_are_on_the_list(
    precision: str, opencl_device: Device
) -> None:
    """One with less than a period, in a way, and the other as the first with one whole period."""
    records = [record for record in CASES if "second_direction" in record]
    assert len(records) == 10
    u, lengths = Geometry("sol", precision, opencl_device, lanes=4).geodesics(
        np.array([point_of(record) for record in records]), 2
    )
    for n, record in enumerate(records):
        assert np.isfinite(lengths[n]).all(), (record, lengths[n])
        off = np.abs(lengths[n] / float(record["distance"]) - 1).max()
        assert off <= DISTANCE[precision].allowed, (record, lengths[n])
        both = np.array([exact(record[key]) for key in ("direction", "second_direction")])
        both = both[np.argsort(both[:, 2] * (1 if u[n, 0, 2] < 0 else -1))]
        error = np.abs(exact(u[n]) - both).max()
        assert error <= DIRECTION_AT_CUT[precision].allowed, (record, u[n], error)


@every_kernel
def test_areas(precision: str, lanes: int, opencl_device: Device) -> None:
    u = sol.directions([[float(c) for c in record["direction_unnormalised"]] for record in AREAS], precision)
    t = cut([float(record["t"]) for record in AREAS], precision)
    got = Geometry("sol", precision, opencl_device, lanes=lanes).area_density(u, t)
    found = []
    for record, ray, time, area in zip(AREAS, u, t, got, strict=True):
        off = abs(float(area / abs(known_area(*map(float, ray), float(time))) - 1))
        found.append((record["regime"], off, AREA[record["regime"]][precision], (record, area)))
    worst(f"{precision} area", found)


@functools.cache
def known_area(a: float, b: float, c: float, t: float) -> Any:
    return sol.area([a, b, c], t)
