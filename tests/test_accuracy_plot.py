"""accuracy/plot.py: the picture shows the rows it is given, each once."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from accuracy_rows import row, rows

from thurston_cl.accuracy import plot as module
from thurston_cl.accuracy.plot import STYLES, figure, plot
from thurston_cl.accuracy.table import HALF_PIXELS
from thurston_cl.flows import FLOWS


def marks(axes: object, marker: str, size: float) -> list[tuple[float, float, bool]]:
    """Time and error of the marks of one shape and size, and whether each is filled."""
    return [
        (float(line.get_xdata()[0]), float(line.get_ydata()[0]), line.get_markerfacecolor() != "white")
        for line in axes.lines  # type: ignore[attr-defined]
        if line.get_marker() == marker and line.get_markersize() == size
    ]


def test_a_style_for_every_flow() -> None:
    assert tuple(STYLES) == FLOWS
    assert len({marker for _, marker in STYLES.values()}) == len({color for color, _ in STYLES.values()}) == 5


def test_each_row_of_the_longest_time_has_its_place() -> None:
    drawn = figure(
        [*rows("nil", 6.0), *rows("nil", 10.0), *rows("nil", 10.0, "adversarial"), *rows("sol", 10.0)]
    )
    panels = [axes for axes in drawn.axes if axes.axison]
    assert [axes.get_title() for axes in panels] == ["Nil", "Sol"]
    for axes in panels:
        assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
        assert marks(axes, "*", 15) == [(1.0, 1e-5, False), (2.0, 1e-13, True)]
        assert marks(axes, "D", 8) == [(4.0, 1e-3, False)]
        assert marks(axes, "D", 4) == [(4.0, 1e-14, False)]  # its mean
        assert marks(axes, "x", 14) == []
        dashed = [
            line
            for line in axes.lines
            if line.get_color() == module.LIMIT_COLOR and line.get_linestyle() == "--"
        ]
        assert [line.get_ydata()[0] for line in dashed] == list(HALF_PIXELS.values())
        (steps,) = [line for line in axes.lines if line.get_drawstyle() == "steps-post"]
        assert list(steps.get_xdata()) == [0.5, 1.0, 2.0, 4.0]
        assert list(steps.get_ydata()) == [9.0, 1e-5, 1e-13, 1e-13]
    labels = [entry.get_text() for entry in drawn.axes[2].get_legend().get_texts()]
    assert labels[:3] == ["exact", "Euler", "Runge-Kutta 4"]


def test_errors_of_0_stand_below_all_others_and_flaws_are_crossed_out() -> None:
    drawn = figure(
        [row(angle_max=0.0, angle_mean=0.0), row(flow="rk2", step=0.1, angle_max=1e-4, lost=1, count=999)]
    )
    (axes,) = [axes for axes in drawn.axes if axes.axison]
    ((_, zero, _),) = marks(axes, "*", 15)
    assert 0 < zero < 1e-14
    assert "0" in [note.get_text() for note in axes.texts]
    assert marks(axes, "x", 14)[0][:2] == (2.0, 1e-4)


def test_files(tmp_path: Path) -> None:
    plot(rows(), str(tmp_path / "a.png"))
    assert (tmp_path / "a.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    plot(rows(), str(tmp_path / "a.svg"))
    assert re.search("<svg", (tmp_path / "a.svg").read_text(encoding="utf-8"))
    with pytest.raises(ValueError, match="no rows of uniform directions"):
        plot(rows(directions="adversarial"), str(tmp_path / "b.png"))
