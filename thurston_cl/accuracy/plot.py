"""The rows of protocol.py as a picture: angle error against time, one panel a geometry. Needs matplotlib."""

import math
from collections.abc import Sequence
from typing import Any

from thurston_cl.accuracy.protocol import QUANTILE, Row
from thurston_cl.accuracy.table import HALF_PIXELS, front, usable

# Colors that are told apart by everyone (Okabe and Ito), and a shape for each as well.
STYLES = {
    "exact": ("#000000", "*"),
    "euler": ("#e69f00", "v"),
    "rk2": ("#56b4e9", "s"),
    "rk4": ("#009e73", "D"),
    "rk8": ("#cc79a7", "o"),
}
NAMES = {"exact": "exact", "euler": "Euler", "rk2": "Runge-Kutta 2", "rk4": "Runge-Kutta 4", "rk8": "order 8"}
TITLES = {
    "e3": "E³",
    "s3": "S³",
    "h3": "H³",
    "s2xe": "S² × E",
    "h2xe": "H² × E",
    "nil": "Nil",
    "sl2": "SL(2, R), universal cover",
    "sol": "Sol",
}
COLUMNS = 3
PANEL = (4.4, 3.7)  # inches
DOTS = 130  # an inch
FAINT = 0.35
LIMIT_COLOR = "#b03030"
DASHES = (0, (4, 3))
# Errors of 0 stand this part below all others.
ZERO_BELOW = 0.05


def has_matplotlib() -> bool:
    """Whether plots can be drawn."""
    try:
        import matplotlib.figure  # noqa: F401
    except ImportError:
        return False
    return True


def plot(rows: Sequence[Row], file: str) -> None:
    """Draw `figure` into a file, .png, .svg or .pdf. ValueError as there."""
    figure(rows).savefig(file, dpi=DOTS)


def figure(rows: Sequence[Row]) -> Any:
    """A matplotlib Figure of uniform directions after the longest time; nil without its coordinates.

    ValueError where there are no such rows.
    """
    from matplotlib.figure import Figure

    shown = [row for row in rows if row.directions == "uniform" and row.equation == "left-invariant"]
    if not shown:
        raise ValueError("no rows of uniform directions to draw")
    time = max(row.time for row in shown)
    shown = [row for row in shown if row.time == time]
    geometries = list(dict.fromkeys(row.geometry for row in shown))
    columns = min(COLUMNS, len(geometries) + 1)
    lines = math.ceil((len(geometries) + 1) / columns)
    drawn = Figure(figsize=(PANEL[0] * columns, PANEL[1] * lines + 0.6), layout="constrained")
    grid = drawn.subplots(lines, columns, sharex=True, sharey=True, squeeze=False)
    zero = _zero_place(shown)
    panels = list(grid.flat)
    for axes, geometry in zip(panels, geometries, strict=False):
        _panel(axes, [row for row in shown if row.geometry == geometry], zero)
        axes.set_title(TITLES[geometry], fontsize=13, fontweight="bold")
    for axes in grid[:, 0]:
        axes.set_ylabel("angle error / degrees")
    for axes in panels[max(0, len(geometries) - columns) : len(geometries)]:
        axes.set_xlabel(f"device time for {shown[0].timed:,} directions / ms")
        axes.tick_params(labelbottom=True)
    for axes in panels[len(geometries) :]:
        axes.set_axis_off()
    _legend(panels[len(geometries)], shown)
    drawn.suptitle(f"What accuracy costs: geodesics of length {time:g}", fontsize=16)
    return drawn


def _zero_place(rows: Sequence[Row]) -> float | None:
    """Where errors of 0 stand on the axis; None where there are none."""
    errors = [error for row in rows for error in (row.angle_max, row.angle_mean)]
    least = min((error for error in errors if error > 0), default=1.0)
    return least * ZERO_BELOW if any(error == 0 for error in errors) else None


def _panel(axes: Any, rows: list[Row], zero: float | None) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.grid(True, color="#e4e4e4", linewidth=0.6)
    axes.set_axisbelow(True)
    for spine in ("top", "right"):
        axes.spines[spine].set_visible(False)
    for width, angle in HALF_PIXELS.items():
        axes.axhline(angle, color=LIMIT_COLOR, linewidth=1, linestyle=DASHES, zorder=1)
        axes.annotate(
            f"½ pixel of {width}",
            (1, angle),
            xycoords=("axes fraction", "data"),
            xytext=(-2, 2 if width == min(HALF_PIXELS) else -2),
            textcoords="offset points",
            ha="right",
            va="bottom" if width == min(HALF_PIXELS) else "top",
            fontsize=8,
            color=LIMIT_COLOR,
        )
    if zero is not None:
        axes.axhline(zero, color="#888888", linewidth=0.8, zorder=1)
        axes.annotate(
            "0",
            (0, zero),
            xycoords=("axes fraction", "data"),
            xytext=(3, 2),
            textcoords="offset points",
            color="#666666",
            fontsize=9,
        )
    best = sorted(front(rows), key=lambda row: row.seconds)
    if best:
        axes.step(
            [row.seconds * 1e3 for row in best] + [max(row.seconds for row in rows) * 1e3],
            [_place(row.angle_max, zero) for row in best] + [_place(best[-1].angle_max, zero)],
            where="post",
            color="#bdbdbd",
            linewidth=6,
            alpha=0.55,
            solid_capstyle="round",
            zorder=2,
        )
    for flow, (color, _) in STYLES.items():
        for precision in ("single", "double"):
            chosen = [row for row in rows if (row.flow, row.precision) == (flow, precision)]
            chosen = [row for row in chosen if not math.isnan(row.angle_max)]
            chosen.sort(key=lambda row: row.seconds)
            if len(chosen) > 1:
                axes.plot(
                    [row.seconds * 1e3 for row in chosen],
                    [_place(row.angle_max, zero) for row in chosen],
                    color=color,
                    linewidth=1,
                    alpha=FAINT,
                    zorder=3,
                )
            for row in chosen:
                _mark(axes, row, zero)


def _mark(axes: Any, row: Row, zero: float | None) -> None:
    """The largest error, with the mean below it and fainter, and a cross where directions are off or lost."""
    color, marker = STYLES[row.flow]
    x, top, mean = row.seconds * 1e3, _place(row.angle_max, zero), _place(row.angle_mean, zero)
    size = 15 if marker == "*" else 8
    face = color if row.precision == "double" else "white"
    axes.plot([x, x], [mean, top], color=color, linewidth=1, alpha=FAINT, zorder=3)
    axes.plot(
        x,
        mean,
        marker,
        markersize=size * 0.5,
        markerfacecolor=face,
        markeredgecolor=color,
        alpha=FAINT,
        zorder=4,
    )
    axes.plot(
        x,
        top,
        marker,
        markersize=size,
        markerfacecolor=face,
        markeredgecolor=color,
        markeredgewidth=1.4,
        zorder=5,
    )
    if not usable(row):
        axes.plot(x, top, "x", markersize=14, markeredgecolor=LIMIT_COLOR, markeredgewidth=1.2, zorder=6)


def _place(error: float, zero: float | None) -> float:
    return error if error > 0 or zero is None else zero


def _legend(axes: Any, rows: Sequence[Row]) -> None:
    """What the marks mean, in the first cell that no geometry needs."""
    from matplotlib.lines import Line2D

    def entry(label: str, marker: str, color: str, **more: Any) -> Line2D:
        settings: dict[str, Any] = {
            "linestyle": "",
            "markersize": 9,
            "markeredgecolor": color,
            "label": label,
        }
        return Line2D([], [], marker=marker, **(settings | more))

    steps = sorted({row.step for row in rows if row.step is not None}, reverse=True)
    by = " to ".join(f"{step:g}" for step in (steps if len(steps) < 3 else [steps[0], steps[-1]]))
    used = {row.flow for row in rows}
    handles = [
        entry(NAMES[flow], marker, color, markerfacecolor=color, markersize=14 if marker == "*" else 9)
        for flow, (color, marker) in STYLES.items()
        if flow in used
    ]
    gray = "#555555"
    handles += [
        entry("double precision", "o", gray, markerfacecolor=gray),
        entry("single precision", "o", gray, markerfacecolor="white", markeredgewidth=1.4),
        entry("mean; the others are maxima", "o", gray, markerfacecolor=gray, markersize=4.5, alpha=FAINT),
        entry(f"over {1 - QUANTILE:.1%} of directions off or lost", "x", LIMIT_COLOR, markersize=12),
        Line2D([], [], color="#bdbdbd", linewidth=6, alpha=0.55, label="Pareto front of the maxima"),
        Line2D([], [], color=gray, linewidth=1, alpha=FAINT, label=f"one method, steps {by}"),
        Line2D(
            [],
            [],
            color=LIMIT_COLOR,
            linestyle=DASHES,
            linewidth=1,
            label="½ pixel at the border, 100° across",
        ),
    ]
    axes.legend(
        handles=handles, loc="center", frameon=False, fontsize=11, labelspacing=0.75, handlelength=2.2
    )
