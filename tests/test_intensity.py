"""The plots of docs/intensity.md: numbers against the paper's formulas, colors, and what the page says."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

import thurston_cl as tc
from thurston_cl.models import GEOMETRIES

ROOT = Path(__file__).parents[1]
PROGRAM = ROOT / "docs" / "examples" / "intensity.py"
PIXELS, RADIUS = 60, 10.0


def _load() -> Any:
    spec = importlib.util.spec_from_file_location("intensity", PROGRAM)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["intensity"] = module  # where dataclasses look for it
    spec.loader.exec_module(module)
    return module


plot = _load()
PANELS = {
    panel.geometry + panel.subtitle * (panel.geometry == "sol"): panel
    for panel in (*plot.PANELS, *plot.MORE_PANELS)
}
SOL_PLANE, SOL_BETWEEN, SOL_LEVEL = (name for name in PANELS if name.startswith("sol"))


def values(name: str, radius: float = RADIUS, pixels: int = PIXELS) -> np.ndarray:
    found: np.ndarray = plot.intensity(PANELS[name], radius, pixels)
    assert found.shape == (pixels, pixels)
    return found


def coordinates(radius: float = RADIUS, pixels: int = PIXELS) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distance from the axis, height, and length at the middles of the pixels."""
    middles = np.linspace(-radius, radius, 2 * pixels + 1)[1::2]
    across, height = np.meshgrid(middles, middles)
    return np.abs(across), height, np.hypot(across, height)


def nil(across: np.ndarray, z: np.ndarray, r: np.ndarray) -> np.ndarray:
    """A of the paper's (9.6)."""
    s, c = np.sin(z / 2), np.cos(z / 2)
    return 2 * r**2 / z**4 * np.abs(s) * np.abs(across**2 * z * c - 2 * r**2 * s)


AREAS = {
    "e3": lambda across, z, r: r**2,  # 7.5
    "s3": lambda across, z, r: np.sin(r) ** 2,
    "h3": lambda across, z, r: np.sinh(r) ** 2,
    "s2xe": lambda across, z, r: r**2 * np.abs(np.sin(across)) / across,  # 8.1
    "h2xe": lambda across, z, r: r**2 * np.sinh(across) / across,
}


@pytest.mark.parametrize("name", AREAS)
def test_panels_are_the_formulas_of_the_paper(name: str) -> None:
    np.testing.assert_allclose(1 / values(name), AREAS[name](*coordinates()), rtol=1e-9, atol=1e-12)


def test_nil_is_the_formula_of_the_paper() -> None:
    across, z, r = coordinates()
    np.testing.assert_allclose(1 / values("nil"), nil(across, z, r), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", ["e3", "s3", "h3"])
def test_isotropic_panels_do_not_change_when_turned(name: str) -> None:
    found = values(name)
    for turned in (found.T, found[::-1], found[:, ::-1], np.rot90(found)):
        np.testing.assert_allclose(1 / turned, 1 / found, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("name", ["s2xe", "h2xe", "nil", "sl2"])
def test_the_fiber_is_an_axis_of_rotation(name: str) -> None:
    """Which is why one plane through it tells all."""
    found = 1 / values(name)
    np.testing.assert_allclose(found[::-1], found, rtol=1e-8, atol=1e-10)
    panel = PANELS[name]
    for across in (plot.Y, plot.DIAGONAL, (-0.6, 0.8, 0.0)):
        other = plot.Panel(panel.geometry, "", "", across=across)
        np.testing.assert_allclose(1 / plot.intensity(other, RADIUS, PIXELS), found, rtol=1e-8, atol=1e-10)


def test_symmetries_of_sol() -> None:
    plane, between, level = (1 / values(name) for name in (SOL_PLANE, SOL_BETWEEN, SOL_LEVEL))
    equal = [(found[:, ::-1], found) for found in (plane, between, level)]
    equal += [(between[::-1], between), (level[::-1], level), (level.T, level)]
    for turned, found in equal:
        # Next to planes and axes Jacobi's equation is integrated, as sol_light.h says.
        np.testing.assert_allclose(turned, found, rtol=1e-7, atol=1e-7)
    # Light that leaves upwards turns over and stays together.
    above, below = plane[PIXELS // 2 :], plane[: PIXELS // 2][::-1]
    assert (above < below).all()


def conjugate_lengths(geometry: str, direction: tuple[float, float, float], farthest: float) -> list[float]:
    """Lengths along `direction` where the area density has a least value of 0, to 1e-3."""
    lengths = np.arange(1, farthest, 1e-3)
    area = tc.Geometry(geometry).area_density(np.array([direction]) / np.linalg.norm(direction), lengths)
    least = (area[1:-1] <= area[:-2]) & (area[1:-1] < area[2:]) & (area[1:-1] < 2e-3 * lengths[1:-1] ** 2)
    return [float(length) for length in lengths[1:-1][least]]


@pytest.mark.parametrize(
    ("geometry", "direction", "wanted"),
    [
        ("s3", (1, 2, 3), [np.pi, 2 * np.pi, 3 * np.pi]),
        ("s2xe", (3, 0, 4), [np.pi / 0.6, 2 * np.pi / 0.6]),
        # Both sheets at once, of which only the plane crosses the fiber straight.
        ("nil", (0, 0, 1), [2 * np.pi, 4 * np.pi]),
        ("sl2", (0, 0, 1), [2 * np.pi, 4 * np.pi]),
        ("e3", (1, 2, 3), []),
        ("h3", (1, 2, 3), []),
        ("h2xe", (3, 0, 4), []),
        ("sl2", (1, 0, 0.999), []),
        ("sol", (0.3, 0, 1), []),
        ("sol", (0, 0, 1), []),
    ],
)
def test_caustics_are_where_the_page_says(
    geometry: str, direction: tuple[float, float, float], wanted: list[float]
) -> None:
    assert conjugate_lengths(geometry, direction, 13 if geometry != "s3" else 10) == pytest.approx(
        wanted, abs=1e-3
    )


def test_first_caustic_of_sol_on_the_lines_between_its_planes() -> None:
    assert conjugate_lengths("sol", (1, -1, 0), 6)[0] == pytest.approx(np.sqrt(2) * np.pi, abs=1e-3)


def test_first_sheet_of_sl2_is_a_hyperboloid() -> None:
    across = np.linspace(0.1, 20, 50)
    height = np.hypot(across, 2 * np.pi)
    length = np.hypot(across, height)
    direction = np.stack([across, 0 * across, height], axis=1) / length[:, np.newaxis]
    area = tc.Geometry("sl2").area_density(direction, length)
    beside = tc.Geometry("sl2").area_density(direction, 1.01 * length)
    assert (area < 1e-9 * beside).all()


@pytest.mark.parametrize("height", [2 * np.pi, 4 * np.pi])
def test_whole_turns_in_nil_are_conjugate(height: float) -> None:
    across = np.linspace(0, 30, 50)
    length = np.hypot(across, height)
    direction = np.stack([across, 0 * across, 0 * across + height], axis=1) / length[:, np.newaxis]
    area = tc.Geometry("nil").area_density(direction, length)
    assert (area < 1e-9 * length**2).all()


def test_how_fast_light_falls_off() -> None:
    lengths = np.array([3.0, 10, 30])
    level = tc.Geometry("nil").area_density([[1, 0, 0]], lengths)
    np.testing.assert_allclose(level, lengths**2 + lengths**4 / 12, rtol=1e-12)
    for up in (1, -1):
        area = tc.Geometry("sol").area_density([[0, 0, up]], lengths[:2])
        np.testing.assert_allclose(area, np.sinh(lengths[:2]) ** 2, rtol=1e-6)


def test_the_light_is_in_no_pixel() -> None:
    with pytest.raises(ValueError, match="pixels is 61; expected an even number"):
        plot.intensity(PANELS["e3"], RADIUS, 61)


def test_colors_of_the_picture(tmp_path: Path) -> None:
    """Each place of a disc has the color of its intensity, and outside of the discs is paper."""
    names = ("s2xe", SOL_PLANE)
    # Away from caustics, where a pixel is too wide for one color.
    spots = [(1.0, 2.0), (-2.0, 5.0), (0.5, -8.0), (-1.5, -1.5)]
    figure = plot.draw([PANELS[name] for name in names], RADIUS, 200)
    figure.savefig(tmp_path / "a.png", dpi=100)
    picture = oiio.ImageBuf(str(tmp_path / "a.png")).get_pixels("float")[::-1]
    for axes, name in zip(figure.axes, names, strict=False):
        assert axes.get_title() == PANELS[name].title
        for x, y in spots:
            column, row = axes.transData.transform((x, y)).astype(int)
            length = np.hypot(x, y)
            area = tc.Geometry(PANELS[name].geometry).area_density([[x / length, 0, y / length]], length)
            wanted = plot.COLORS(plot.NORM(1 / area[0]))[:3]
            np.testing.assert_allclose(picture[row, column, :3], wanted, atol=0.03)
        column, row = axes.transData.transform((0.95 * RADIUS, 0.95 * RADIUS)).astype(int)
        np.testing.assert_array_equal(picture[row, column, :3], 1)
    brightness = plot.COLORS(np.linspace(0, 1, 100))[:, :3] @ (0.2126, 0.7152, 0.0722)
    assert (np.diff(brightness) > 0).all()


@pytest.mark.parametrize("panels", [plot.PANELS, plot.PANELS[:1], plot.PANELS[:2]], ids=len)
def test_titles_and_captions_have_room(panels: tuple[Any, ...]) -> None:
    """All in the figure, and between a caption and the title below it lies a line's height or so."""
    figure = plot.draw(panels, RADIUS, 20)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    discs = figure.axes[: len(panels)]
    titles = [disc.title.get_window_extent(canvas.get_renderer()) for disc in discs]
    captions = [disc.xaxis.label.get_window_extent(canvas.get_renderer()) for disc in discs]
    for box in titles + captions:
        assert 4 < box.y0 < box.y1 < figure.bbox.height - 4
        assert 0 < box.x0 < box.x1 < figure.bbox.width
    for caption, title in zip(captions, titles[3:], strict=False):
        assert caption.y0 - title.y1 > 15


PAGE = (ROOT / "docs" / "intensity.md").read_text(encoding="utf-8")
COMMANDS = [line.split() for line in PAGE.splitlines() if line.startswith("    .venv/bin/python ")]


def test_the_page_shows_what_it_makes() -> None:
    made = [command[command.index("-o") + 1] for command in COMMANDS]
    assert [f"docs/{name}" for name in re.findall(r"!\[[^]]+\]\(([^)]+)\)", PAGE)] == made
    for file in made:
        assert (ROOT / file).is_file()
    assert {panel.geometry for panel in plot.PANELS} == set(GEOMETRIES)


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_commands_of_the_page_run_without_a_screen(command: list[str], tmp_path: Path) -> None:
    here = tmp_path / "a.png"
    arguments = [*command[1:-1], str(here), "--pixels", "20"]
    env = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "MPLBACKEND")}
    done = subprocess.run([sys.executable, *arguments], cwd=ROOT, env=env, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, ""), done.stderr
    spec = oiio.ImageBuf(str(here)).spec()
    wanted = oiio.ImageBuf(str(ROOT / command[-1])).spec()
    assert (spec.width, spec.height) == (wanted.width, wanted.height)
