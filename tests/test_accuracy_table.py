"""accuracy/table.py: rows as text, JSON and CSV, and which are worth their time."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import math

import pytest
from accuracy_rows import row, rows

from thurston_cl.accuracy.protocol import Row
from thurston_cl.accuracy.table import (
    HALF_PIXELS,
    as_csv,
    as_json,
    blocks,
    front,
    header,
    text,
    usable,
    verdict,
)

NAN = math.nan


def words(line: str) -> str:
    return " ".join(line.split())


def test_half_a_pixel_is_the_paper_s() -> None:
    assert f"{HALF_PIXELS[1000]:.0e}" == "3e-02"
    assert f"{HALF_PIXELS[5000]:.0e}" == "6e-03"


def test_the_front_is_of_what_nothing_beats() -> None:
    single, double, euler, rk4 = rows()
    assert front([single, double, euler, rk4]) == {euler, single, double}
    # One that is as accurate as a faster one is not on it; nor is one that is off, lost, or nothing at all.
    twin = row(seconds=3e-3)
    assert front([double, twin]) == {double}
    for changes in ({"off": 6}, {"lost": 6}, {"off": 3, "lost": 3}, {"angle_max": NAN}):
        flawed = row(seconds=1e-9, count=5000, **changes)
        assert not usable(flawed)
        assert front([double, flawed]) == {double}
    assert usable(row(count=5000, off=3, lost=2))


def test_blocks_are_of_one_geometry_time_and_set() -> None:
    # As they are measured: method after method, each in all blocks.
    parts = [rows("nil", 6.0), rows("nil", 10.0), rows("nil", 6.0, "adversarial"), rows("sol", 6.0)]
    mixed = [entry for entries in zip(*parts, strict=True) for entry in entries]
    assert blocks(mixed) == parts
    assert blocks([]) == []


def test_text_shows_every_number_and_marks_the_front() -> None:
    lines = text(rows()).splitlines()
    assert lines[0] == "nil, t = 6, 100 uniform directions (angle error found for the truth itself: 1.0e-14)"
    assert words(lines[1]) == (
        "method step precision time/ms x max distance mean off lost max angle 99.9% mean worst"
    )
    assert words(lines[2]) == "exact single 1 1 1.0e-14 1.0e-15 0 0 1.0e-05 9.0e-06 1.0e-14 *"
    assert lines[3].split()[-3:] == ["*", "[mpmath,", "48]"]
    assert words(lines[5]) == "rk4 0.1 single 4 4 1.0e-14 1.0e-15 0 0 1.0e-03 1.0e-03 1.0e-14"
    assert lines[6:] == verdict(rows())


def test_directions_without_angle_are_spoken_of() -> None:
    title = text([*rows(), row(unsolved=3)]).splitlines()[0]
    assert title.endswith("1.0e-14; 3 directions without angle, as their geodesic is not found)")


def test_text_of_errors_that_are_none_or_nothing() -> None:
    line = text([row(angle_max=0.0, angle_quantile=0.0, angle_mean=NAN, relative=NAN)]).splitlines()[2]
    assert words(line) == "exact double 2 1.0e-14 1.0e-15 0 0 0 0 - * [mpmath, 48]"
    shown = text([row(flow="rk2", step=0.01, equation="coordinates", worst="vertical, 1e-06 off", truth="x")])
    assert shown.splitlines()[2].startswith("rk2 in coordinates  0.01  double")
    assert shown.splitlines()[2].endswith("vertical, 1e-06 off")


def test_the_verdict_does_not_flatter() -> None:
    single, double, euler, rk4 = rows()
    assert verdict([single, double, euler, rk4]) == [
        "double exact: none more accurate; 2 faster: single euler 0.1, single exact",
        "cheapest within half a pixel of 1000 in 99.9% of directions: single exact",
        "cheapest within half a pixel of 5000 in 99.9% of directions: single exact",
    ]
    better = dataclasses.replace(rk4, angle_max=1e-14, seconds=1e-4, angle_quantile=1e-14)
    assert (
        verdict([double, better])[0]
        == "double exact: 1 more accurate: single rk4 0.1; 1 faster: single rk4 0.1"
    )
    many = [dataclasses.replace(rk4, step=step, seconds=step * 1e-3) for step in (0.1, 0.2, 0.3, 0.4)]
    assert verdict([double, *many])[0].endswith("4 faster: single rk4 0.1, single rk4 0.2, and 2 others")
    # Within half a pixel in most directions only does not do.
    assert verdict([dataclasses.replace(double, angle_quantile=5.0)])[1:] == [
        f"cheapest within half a pixel of {width} in 99.9% of directions: none" for width in (1000, 5000)
    ]


def test_the_header_says_what_is_true() -> None:
    head = "\n".join(header(500, 17, "Toaster"))
    for words in (
        "500 directions",
        "seed 17",
        "Toaster",
        "for double exact mpmath",
        "0.028 for 1000",
        "40 degrees",
    ):
        assert words in head
    assert text(rows(), ["above"]).startswith("above\n\nnil, t = 6")


def test_json_and_csv_have_all_fields() -> None:
    measured = [*rows(), row(angle_max=NAN)]
    answer = json.loads(as_json(measured, device="Toaster", complete=True))
    assert answer["device"] == "Toaster"
    assert answer["half_pixel_degrees"]["1000"] == pytest.approx(0.0282, abs=1e-4)
    names = [field.name for field in dataclasses.fields(Row)]
    assert [list(entry) for entry in answer["rows"]] == [names] * 5
    assert answer["rows"][4]["angle_max"] is None
    assert Row(**answer["rows"][3]) == measured[3]
    lines = list(csv.DictReader(io.StringIO(as_csv(measured))))
    assert list(lines[0]) == names
    assert (lines[3]["flow"], float(lines[3]["step"]), lines[0]["step"]) == ("rk4", 0.1, "")
    assert lines[4]["angle_max"] == ""
