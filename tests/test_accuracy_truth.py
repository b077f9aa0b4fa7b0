"""accuracy/truth.py: the flow by Taylor series agrees with the reference values, and with itself."""

from __future__ import annotations

import json
from typing import Any

import pytest
from golden import DATA, MP, on_model
from mpmath import mp

from thurston_cl.accuracy.truth import displacement, flow
from thurston_cl.models import GEOMETRIES, ORIGIN

# The files have 25 digits.
DIGITS = 25
# Every so many records of each file, and all longer flows are left out: seconds, not minutes.
STRIDE = 5
LONGEST = 12
UNIT = {"s3": (3, 1), "h3": (3, -1), "s2xe": (2, 1), "h2xe": (2, -1), "sl2": (2, -1)}


def base_of(geometry: str, record: dict[str, Any]) -> list[Any]:
    """The base of a record: three coordinates in the file, the fourth from the model."""
    given = [MP.mpf(float(text)) for text in record["base"]]
    if geometry in ("e3", "nil"):
        return [*given, MP.mpf(1)]
    if geometry in ("s3", "h3"):
        return list(on_model(geometry, [given])[0])
    height = MP.sqrt(1 - UNIT[geometry][1] * (given[0] ** 2 + given[1] ** 2))
    return [given[0], given[1], height, given[2]]


def records(geometry: str) -> list[tuple[Any, ...]]:
    """Direction, time, base, point and (where the file has it) velocity at the end."""
    if geometry == "sol":
        data = json.loads((DATA / "sol_flow.json").read_text(encoding="utf-8"))["flow"]
        rays = []
        for record in data:
            u = [MP.mpf(text) for text in record["direction"]]
            size = MP.sqrt(sum(component**2 for component in u))
            point, end = record["point"], record["u"]
            rays.append(([component / size for component in u], MP.mpf(record["t"]), None, point, end))
    else:
        data = json.loads((DATA / f"{geometry}.json").read_text(encoding="utf-8"))
        rows = data["flow"] + [row for part in data["hard"].values() for row in part.get("flow", [])]
        rays = [
            (
                [float(text) for text in row["u"]],
                float(row["t"]),
                base_of(geometry, row),
                row["point"]["hyp"] if geometry == "sl2" else row["point"] + ["1"] * (geometry == "nil"),
                row.get("u_t"),
            )
            for row in rows
        ]
    return [ray for ray in rays if abs(ray[1]) <= LONGEST][::STRIDE]


def apart(got: list[Any], wanted: list[Any]) -> float:
    """The largest difference, relative to the largest entry wanted."""
    with mp.workdps(50):
        rows = [(mp.mpf(a), mp.mpf(b)) for a, b in zip(got, wanted, strict=True)]
        return float(max(abs(a - b) for a, b in rows) / max(abs(b) for _, b in rows))


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_reference_values(geometry: str) -> None:
    rays = records(geometry)
    assert len(rays) >= 10
    for direction, time, base, point, end in rays:
        got, velocity = flow(geometry, direction, time, base)
        where = (direction, time, base)
        assert apart(got, point) < 10.0**-DIGITS * 10, where
        if end is not None:
            assert apart(velocity, end) < 10.0**-DIGITS * 10, where


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_there_and_back_and_in_two_parts(geometry: str) -> None:
    u = ["0.36", "0.48", "0.8"]
    point, velocity = flow(geometry, u, 5, digits=40)
    back, start = flow(geometry, velocity, -5, point, digits=40)
    assert apart(back, list(ORIGIN[geometry])) < 1e-36
    assert apart(start, u) < 1e-36
    half, along = flow(geometry, u, 2, digits=40)
    there, arriving = flow(geometry, along, 3, half, digits=40)
    assert apart(there, point) < 1e-36
    assert apart(arriving, velocity) < 1e-36


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_a_longer_velocity_runs_faster(geometry: str) -> None:
    slow, along = flow(geometry, [0.5, -0.25, 0.75], 4)
    fast, faster = flow(geometry, [1, -0.5, 1.5], 2)
    assert apart(fast, slow) < 1e-28
    assert apart(faster, [mp.fmul(2, component, exact=True) for component in along]) < 1e-28


@pytest.mark.parametrize("geometry", ["nil", "sl2", "sol"])
def test_digits_that_are_asked_for_are_there(geometry: str) -> None:
    u = [1e-12, 0.6, 0.8]
    best = flow(geometry, u, 10, digits=60)[0]
    for digits in (15, 30):
        assert 0 < apart(flow(geometry, u, 10, digits=digits)[0], best) < 10.0**-digits


def test_vertical_and_unmoved() -> None:
    assert flow("nil", [0, 0, 1], 3)[0] == [0, 0, 3, 1]
    assert flow("sol", [0, 0, -1], 3)[0] == [0, 0, -3, 1]
    assert flow("sl2", [0, 0, 1], 30)[0][3] == pytest.approx(30, abs=1e-12)
    for geometry in GEOMETRIES:
        assert flow(geometry, [0.6, 0, 0.8], 0)[0] == list(ORIGIN[geometry])


def test_unknown_geometry() -> None:
    with pytest.raises(ValueError, match="unknown geometry 'e4'; expected one of: e3"):
        flow("e4", [1, 0, 0], 1)


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("time", [0.7, 3.1, 9.0])
def test_displacement_is_the_way_from_one_point_to_another(geometry: str, time: float) -> None:
    start = flow(geometry, [0.36, 0.48, 0.8], time)[0]
    # A short way in another direction, and past the cut of the argument in sl2.
    step = [mp.mpf("0.6e-9"), mp.mpf("-0.48e-9"), mp.mpf("0.64e-9")]
    end, _ = flow(geometry, step, 1, start)
    got = displacement(geometry, start, end)
    assert float(mp.norm(got)) == pytest.approx(1e-9, rel=1e-7)
    if geometry not in ("s3", "s2xe"):
        assert [float(part) for part in got] == pytest.approx([float(part) for part in step], rel=1e-6)
    # Off the model it is put back on it, and is the same.
    if geometry in ("s3", "h3"):
        scaled = (
            [mp.fmul(3, part, exact=True) for part in end] if geometry == "s3" else [*end[:3], end[3] + 1]
        )
        assert apart(displacement(geometry, start, scaled), got) < 1e-15


def test_displacement_knows_the_sheets_of_sl2() -> None:
    start, _ = flow("sl2", [0.36, 0.48, 0.8], 9)
    x, y, z, w = start
    turned = displacement("sl2", start, [x, y, z, mp.fadd(w, 4 * mp.pi)])
    assert float(turned[2]) == pytest.approx(4 * float(mp.pi))


def test_no_turn_about_a_fiber_is_lost_however_fast() -> None:
    # Up the fiber by 50 in one unit of time, and once more at the slowest.
    assert float(flow("sl2", [0, 0, 50], 1)[0][3]) == pytest.approx(50, rel=1e-14)
    assert float(flow("sl2", [0, 0, -1e-3], 50000)[0][3]) == pytest.approx(-50, rel=1e-14)
