"""The rows of protocol.py as text, JSON and CSV; and which of them are worth their time."""

import csv
import dataclasses
import io
import itertools
import json
import math
from collections.abc import Sequence
from typing import Any

from thurston_cl.accuracy.golden import LIVE, LONGEST, STORED, TIMES
from thurston_cl.accuracy.protocol import OFF_ABOVE, QUANTILE, RUNS, Row
from thurston_cl.scene.pixel import half_pixel

# The paper's pictures (A.2.2): their widths in pixels, and the angle across them.
WIDTHS = (1000, 5000)
FIELD = 100  # degrees
HALF_PIXELS = {width: math.degrees(half_pixel(width, math.radians(FIELD))) for width in WIDTHS}

HEADINGS = (
    "method",
    "step",
    "precision",
    "time/ms",
    "x",
    "max distance",
    "mean",
    "off",
    "lost",
    "max angle",
    f"{QUANTILE:.1%}",
    "mean",
    "",
    "worst",
)
LEFT = (0, 2, 13)  # columns of words


def front(rows: Sequence[Row]) -> set[Row]:
    """Those of which none is both faster and more accurate, of the `usable` ones.

    Accuracy is that of the largest angle error. Give it rows of one block: the same geometry, time and set.
    """
    best, least = set(), math.inf
    for row in sorted((row for row in rows if usable(row)), key=lambda row: (row.seconds, row.angle_max)):
        if row.angle_max < least:
            best.add(row)
            least = row.angle_max
    return best


def usable(row: Row) -> bool:
    """Whether all directions, but for 1 - QUANTILE, have led to about where they should."""
    return row.off + row.lost <= (1 - QUANTILE) * row.count and not math.isnan(row.angle_max)


def blocks(rows: Sequence[Row]) -> list[list[Row]]:
    """The rows of each geometry, time and set of directions, in the order in which these come first."""

    def key(row: Row) -> tuple[str, float, str]:
        return row.geometry, row.time, row.directions

    order = {k: n for n, k in enumerate(dict.fromkeys(map(key, rows)))}
    arranged = sorted(rows, key=lambda row: order[key(row)])
    return [list(block) for _, block in itertools.groupby(arranged, key)]


def header(count: int, seed: int, device: str) -> list[str]:
    """What the numbers mean, in lines."""
    limit = math.degrees(OFF_ABOVE)
    stored = " and ".join(f"{time:g}" for time in TIMES)
    widths = " and ".join(f"{angle:.2g} for {width}" for width, angle in HALF_PIXELS.items())
    return [
        f"Geodesics from the origin in {count} directions (seed {seed}), after the paper's appendix A.",
        f"device    {device}",
        "truth     double exact, for every method but itself; for double exact mpmath, which integrates the",
        f"          geodesic equation by Taylor series, independently of the kernels: in {STORED} directions",
        f"          of each set for t = {stored}, and in {LIVE} for other times up to {LONGEST:g};",
        "          its maxima are over so few directions only, beside which the titles tell of all",
        "sets      uniform; adversarial: at 0 and 1e-12 to 1e-1 from every change of regime of the geometry",
        f"time      of the device for all directions, median of up to {RUNS} runs; x: by single exact",
        "in coordinates: of the second-order equation in x, y, z (nil), which the paper's tables are of",
        "distance  in the metric, between where the geodesic leads and where the method does",
        "angle     degrees, from the direction followed to the nearest exact geodesic to that point",
        f"off       directions with more than {limit:.0f} degrees, which max angle and mean leave out",
        "lost      points that are no numbers, which all errors leave out",
        f"{QUANTILE:.1%}     so many directions have no larger angle; off and lost ones have the largest",
        "*         no method is both faster and more accurate, by its max angle; with more than"
        f" {1 - QUANTILE:.1%} off or lost none is",
        "found for the truth itself: by what solving for the direction of the exact endpoint misses it",
        f"Half a pixel, {FIELD} degrees across, at the border: {widths} pixels.",
        "Single precision rounds the direction it is given, too: by up to 3e-6 degrees.",
    ]


def text(rows: Sequence[Row], head: Sequence[str] = ()) -> str:
    """All blocks as tables for a terminal, under the lines `head`."""
    parts = ["\n".join(head)] if head else []
    parts += ["\n".join(_block_lines(block)) for block in blocks(rows)]
    return "\n\n".join(parts)


def as_json(rows: Sequence[Row], **about: Any) -> str:
    """An object of `about`, the half pixels in degrees and the list of rows; null for what is no number."""
    plain = [
        {
            key: None if isinstance(value, float) and math.isnan(value) else value
            for key, value in entry.items()
        }
        for entry in map(dataclasses.asdict, rows)
    ]
    pixels = {str(width): angle for width, angle in HALF_PIXELS.items()}
    return json.dumps(about | {"half_pixel_degrees": pixels, "rows": plain}, indent=2, allow_nan=False)


def as_csv(rows: Sequence[Row]) -> str:
    """One line a row under a line of names; empty for what is no number."""
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerow(field.name for field in dataclasses.fields(Row))
    for row in rows:
        values = dataclasses.astuple(row)
        writer.writerow(
            "" if value is None or (isinstance(value, float) and math.isnan(value)) else value
            for value in values
        )
    return lines.getvalue()


def verdict(rows: Sequence[Row]) -> list[str]:
    """What a block says about double exact, and about the cheapest method within half a pixel."""
    lines = []
    exact = next((row for row in rows if row.flow == "exact" and row.precision == "double"), None)
    if exact is not None and exact.truth == "none":
        lines.append(f"double exact: not measured, for want of a truth beyond t = {LONGEST:g}")
    elif exact is not None:
        better = [row for row in rows if usable(row) and row.angle_max < exact.angle_max]
        faster = [row for row in rows if row.seconds < exact.seconds]
        best = f"{len(better)} more accurate: {_names(better)}" if better else "none more accurate"
        fast = f"{len(faster)} faster: {_names(faster)}" if faster else "none faster"
        lines.append(f"double exact: {best}; {fast}")
    for width, angle in HALF_PIXELS.items():
        good = [row for row in rows if row.angle_quantile <= angle]
        cheapest = _name(min(good, key=lambda row: row.seconds)) if good else "none"
        lines.append(f"cheapest within half a pixel of {width} in {QUANTILE:.1%} of directions: {cheapest}")
    return lines


def _names(rows: Sequence[Row]) -> str:
    names = [_name(row) for row in sorted(rows, key=lambda row: row.seconds)]
    return ", ".join(names if len(names) <= 3 else [*names[:2], f"and {len(names) - 2} others"])


def _name(row: Row) -> str:
    step = "" if row.step is None else f" {row.step:g}"
    return f"{row.precision} {_method(row)}{step}"


def _method(row: Row) -> str:
    return row.flow if row.equation == "left-invariant" else f"{row.flow} in {row.equation}"


def _block_lines(rows: list[Row]) -> list[str]:
    first, best = rows[0], front(rows)
    cells = [HEADINGS] + [_cells(row, row in best) for row in rows]
    widths = [max(len(line[column]) for line in cells) for column in range(len(HEADINGS))]
    lines = [
        "  ".join(
            cell.ljust(width) if column in LEFT else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in cells
    ]
    title = (
        f"{first.geometry}, t = {first.time:g}, {first.timed} {first.directions} directions "
        f"(angle error found for the truth itself: {_number(first.floor)}{_unsolved(rows)})"
    )
    return [title, *lines, *verdict(rows)]


def _unsolved(rows: list[Row]) -> str:
    most = max(row.unsolved for row in rows)
    return f"; {most} directions without angle, as their geodesic is not found" if most else ""


def _cells(row: Row, best: bool) -> tuple[str, ...]:
    return (
        _method(row),
        "" if row.step is None else f"{row.step:g}",
        row.precision,
        f"{row.seconds * 1e3:.3g}",
        "" if math.isnan(row.relative) else f"{row.relative:.3g}",
        _number(row.distance_max),
        _number(row.distance_mean),
        str(row.off),
        str(row.lost),
        _number(row.angle_max),
        _number(row.angle_quantile),
        _number(row.angle_mean),
        "*" if best else "",
        row.worst + {"mpmath": f" [mpmath, {row.count}]", "none": " [no truth]"}.get(row.truth, ""),
    )


def _number(value: float) -> str:
    return "-" if math.isnan(value) else "0" if value == 0 else f"{value:.1e}"
