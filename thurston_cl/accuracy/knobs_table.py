"""The rows of knobs.py as text, JSON and CSV."""

import csv
import io
import json
import math
from collections.abc import Sequence
from typing import Any

from thurston_cl.accuracy.knobs import Row, front, verdict
from thurston_cl.accuracy.pictures import PERCENTILES

HEADINGS = (
    "precision",
    "flow",
    "step",
    "threshold",
    "steps",
    "time/ms",
    "x",
    "other id",
    "over 1/2 px",
    *(f"{'angle ' if k == 0 else ''}{share}" for k, share in enumerate(PERCENTILES)),
    *(f"{'depth ' if k == 0 else ''}{share}" for k, share in enumerate(PERCENTILES)),
    "NaN",
    "no steps",
    "",
)
LEFT = 2  # columns of words
GROUPS = {
    "own": "the scene's own method",
    "method": "other methods",
    "threshold": "exact, with other thresholds",
    "steps": "with other limits of steps",
}


def header(scene: str, size: tuple[int, int], device: str) -> list[str]:
    """What the numbers mean, in lines."""
    return [
        f"{scene}, {size[0]}x{size[1]} pixels on {device}",
        "truth        double exact, to a threshold of 1e-9; one ray through the middle of each pixel",
        "time         of the device for the picture with one sample a pixel; x: relative to the scene's own",
        "other id     pixels that show another object",
        "over 1/2 px  pixels whose object, its depth, or the place on it is none that the truth shows within",
        "             half a pixel; *: none is both cheaper and has fewer of them",
        "angle        radians, from the pixel's direction to the exact geodesic that comes to the point",
        "             found: the median, 95, 99, 99.9 % and the largest",
        "depth        error of the length of rays that show the right object, likewise",
        "NaN          rays that came to nothing; no steps: that ran out of steps",
    ]


def text(rows: Sequence[Row], head: Sequence[str] = ()) -> str:
    """The rows as a table for a terminal, under the lines `head`, with the recommendation below."""
    best = front(rows)
    cells = [HEADINGS] + [_cells(row, row in best) for row in rows]
    widths = [max(len(line[column]) for line in cells) for column in range(len(HEADINGS))]
    lines = [
        "  ".join(
            cell.ljust(width) if column < LEFT else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in cells
    ]
    table = [lines[0]]
    before = ""
    for row, line in zip(rows, lines[1:], strict=True):
        if row.knob != before:
            table.append(f"- {GROUPS[row.knob]}")
            before = row.knob
        table.append(line)
    return "\n".join([*head, *([""] if head else []), *table, "", verdict(rows)])


def as_json(rows: Sequence[Row], **about: Any) -> str:
    """An object of `about`, the recommendation and the list of rows; null for what is no number."""
    plain = [{key: _plain(value) for key, value in row.flat.items()} for row in rows]
    return json.dumps(about | {"recommendation": verdict(rows), "rows": plain}, indent=2, allow_nan=False)


def as_csv(rows: Sequence[Row]) -> str:
    """One line a row under a line of names; empty for what is no number."""
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    for k, row in enumerate(rows):
        if k == 0:
            writer.writerow(row.flat)
        writer.writerow("" if _plain(value) is None else value for value in row.flat.values())
    return lines.getvalue()


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _cells(row: Row, best: bool) -> tuple[str, ...]:
    method = row.method
    return (
        method.precision,
        method.flow,
        "" if method.step is None else f"{method.step:g}",
        f"{method.threshold:g}",
        str(method.steps),
        f"{row.seconds * 1e3:.3g}",
        f"{row.relative:.2f}",
        _share(row.ids_differ),
        _share(row.over_half_pixel),
        *_quantiles(row.angle),
        *_quantiles(row.depth),
        _share(row.nan),
        _share(row.out_of_steps),
        "*" if best else "",
    )


def _share(value: float) -> str:
    return "0" if value == 0 else f"{value:.2%}" if value >= 1e-4 else f"{100 * value:.1g}%"


def _quantiles(values: dict[str, float] | None) -> list[str]:
    if values is None:
        return ["-"] * len(PERCENTILES)
    return ["0" if value == 0 else f"{value:.0e}" for value in values.values()]
