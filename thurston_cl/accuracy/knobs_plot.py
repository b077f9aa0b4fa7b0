"""The rows of knobs.py as a picture: error against time. Needs matplotlib."""

from collections.abc import Sequence
from typing import Any

from thurston_cl.accuracy.knobs import GOOD, Row, front
from thurston_cl.accuracy.plot import DOTS, LIMIT_COLOR, STYLES

SIZE = (11.0, 5.0)  # inches
# No pixel at all stands this part below the smallest fraction there is.
ZERO_BELOW = 0.3
# Of an angle error, what is drawn.
DRAWN = "99.9"


def plot(rows: Sequence[Row], file: str, title: str) -> None:
    """Draw the rows into `file`, a .png, .svg or .pdf: the fraction of pixels over half a pixel, and the
    angle error of 99.9 % of them, against time.

    ValueError where there are none.
    """
    from matplotlib.figure import Figure

    if not rows:
        raise ValueError("no rows to draw")
    figure = Figure(figsize=SIZE, layout="constrained")
    left, right = figure.subplots(1, 2)
    least = min((row.over_half_pixel for row in rows if row.over_half_pixel > 0), default=GOOD)
    zero = ZERO_BELOW * min(least, GOOD)
    best = front(rows)
    left.step(
        [row.relative for row in best] + [max(row.relative for row in rows)],
        [row.over_half_pixel or zero for row in best] + [best[-1].over_half_pixel or zero],
        where="post",
        color="#bdbdbd",
        linewidth=6,
        alpha=0.55,
    )
    for row in rows:
        _mark(left, row, row.over_half_pixel or zero)
        if row.angle_pixels is not None:
            _mark(right, row, row.angle_pixels[DRAWN])
    left.axhline(GOOD, color=LIMIT_COLOR, linewidth=1, linestyle="--")
    left.set_ylabel(f"pixels over half a pixel off; lowest: none; line: {GOOD:.1%}")
    right.axhline(0.5, color=LIMIT_COLOR, linewidth=1, linestyle="--")
    right.set_ylabel(f"angle error of {DRAWN} % of the pixels, in pixels")
    for axes in (left, right):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("time, relative to the scene's own method")
        axes.grid(True, color="#e4e4e4", linewidth=0.6)
        axes.set_axisbelow(True)
    flows = [flow for flow in STYLES if any(row.method.flow == flow for row in rows)]
    for flow in flows:
        for precision, face in (("single", "white"), ("double", STYLES[flow][0])):
            left.plot(
                [],
                [],
                STYLES[flow][1],
                color=STYLES[flow][0],
                markerfacecolor=face,
                label=f"{precision} {flow}",
            )
    left.plot([], [], "o", color="none", markeredgecolor=LIMIT_COLOR, markersize=15, label="the scene's own")
    figure.legend(loc="outside right center", frameon=False)
    figure.suptitle(title)
    figure.savefig(file, dpi=DOTS)


def _mark(axes: Any, row: Row, value: float) -> None:
    color, marker = STYLES[row.method.flow]
    face = color if row.method.precision == "double" else "white"
    size = 11 if marker == "*" else 6
    axes.plot(row.relative, value, marker, markersize=size, color=color, markerfacecolor=face)
    if row.knob == "own":
        axes.plot(row.relative, value, "o", color="none", markeredgecolor=LIMIT_COLOR, markersize=17)
