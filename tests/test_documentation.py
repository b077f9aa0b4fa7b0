"""The scenes that README.md and docs/scene.md print: each is rendered, small, and something is to be seen.
The contact sheet docs/gallery.jpg."""

from __future__ import annotations

import re
import runpy
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import OpenImageIO as oiio
import pytest
from numpy.typing import NDArray

from thurston_cl.device import Device
from thurston_cl.image import to_srgb
from thurston_cl.models import GEOMETRIES
from thurston_cl.rendering import render
from thurston_cl.scene import load_text
from thurston_cl.scene.library import library_scene

ROOT = Path(__file__).parents[1]
SIZES = {"perspective": (48, 27), "equirectangular": (48, 24), "fisheye": (36, 36), "dome": (36, 36)}


def printed_scenes(page: Path) -> dict[str, tuple[str, list[str]]]:
    """By the line where it stands: the text of a scene, and what `--set` makes of it. A camera that stands
    alone is another one for the scene before it."""
    found: dict[str, tuple[str, list[str]]] = {}
    scene = ""
    text = page.read_text(encoding="utf-8")
    for block in re.finditer(r"^```yaml\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
        name = f"{page.name}:{text.count(chr(10), 0, block.start()) + 2}"
        if re.search("^geometry:", block[1], re.MULTILINE):
            scene = block[1]
            found[name] = scene, []
        elif block[1].startswith("camera: "):
            found[name] = scene, ["camera=" + block[1].removeprefix("camera: ").strip()]
    return found


SCENES = printed_scenes(ROOT / "README.md") | printed_scenes(ROOT / "docs" / "scene.md")


def test_the_scenes_are_found() -> None:
    assert len(SCENES) >= 12
    assert sum(bool(sets) for _, sets in SCENES.values()) == 2


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", SCENES)
def test_something_is_to_be_seen(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, opencl_device: Device
) -> None:
    """Some of the rays hit, and the picture has light and shade: it is neither black nor of one color."""
    monkeypatch.chdir(tmp_path)
    _write_photo("photo.png")
    text, sets = SCENES[name]
    scene = load_text(text, "scene.yaml", sets=sets)
    picture = render(
        scene,
        device=opencl_device,
        lanes=4,
        size=SIZES[scene.camera.projection.kind] if scene.camera.layout in (None, "anaglyph") else (48, 48),
        samples=1,
        channels=["beauty"],
    )
    assert picture.statistics["hits"] >= 0.1 * picture.statistics["rays"]
    levels = to_srgb(picture.channels["beauty"]).max(axis=2)
    if scene.camera.projection.kind in ("fisheye", "dome"):
        levels = levels[_disc(picture.width)]
    dark, bright = np.percentile(levels, [10, 90])
    assert bright > 60
    assert bright - dark > 30


def _disc(width: int) -> NDArray[np.bool_]:
    """Which pixels of a square picture are in its circle."""
    middles = np.arange(width) + 0.5 - width / 2
    disc: NDArray[np.bool_] = np.hypot(middles, middles[:, np.newaxis]) < width / 2
    return disc


def _write_photo(file: str) -> None:
    """A picture of four colors."""
    pixels = np.array([[[255, 99, 71], [255, 215, 0]], [[70, 130, 180], [240, 248, 255]]], np.uint8)
    assert oiio.ImageBuf(pixels).write(file)


@pytest.fixture(scope="module")
def gallery() -> dict[str, Any]:
    return runpy.run_path(str(ROOT / "docs" / "examples" / "gallery.py"))


def test_the_gallery_is_of_the_scenes_that_the_readme_names(gallery: dict[str, Any]) -> None:
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    caption = page.split("docs/gallery.jpg)")[1].split("## ")[0]
    assert tuple(re.findall("`([a-z0-9]+/[a-z-]+)`", caption)) == gallery["SCENES"]
    assert {library_scene(name).geometry for name in gallery["SCENES"]} == set(GEOMETRIES)


def test_the_sheet_of_sequences_is_of_the_scenes_that_its_caption_names(gallery: dict[str, Any]) -> None:
    page = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
    caption = page.split("](sequences.jpg)")[1].split("Five lines")[0]
    assert tuple(re.findall("`([a-z0-9]+/[a-z-]+)`", caption)) == gallery["SEQUENCES"]


def test_the_gallery_is_small_and_has_its_size(gallery: dict[str, Any]) -> None:
    file = ROOT / "docs" / "gallery.jpg"
    spec = oiio.ImageBuf(str(file)).spec()
    assert file.stat().st_size < 400_000
    blank = np.zeros((gallery["HEIGHT"], gallery["WIDTH"], 3), np.uint8)
    assert (spec.height, spec.width, 3) == gallery["sheet"]([blank] * len(gallery["SCENES"])).shape


def test_pictures_of_the_gallery_go_row_by_row(gallery: dict[str, Any]) -> None:
    pictures = [np.full((gallery["HEIGHT"], gallery["WIDTH"], 3), k + 1, np.uint8) for k in range(5)]
    whole = gallery["sheet"](pictures)
    places = [(0, 0), (0, 324), (0, 648), (184, 0), (184, 324), (184, 648)]
    assert [int(whole[row, column, 0]) for row, column in places] == [1, 2, 3, 4, 5, 0]
    assert (whole[180:184] == 0).all()


def test_a_panorama_is_cut_to_its_middle(gallery: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """By a stand-in for the renderer that paints each column in its number."""

    def paint(scene: Any, size: tuple[int, int], samples: int) -> SimpleNamespace:
        columns = np.linspace(0, 1, size[0], dtype=np.float32)
        return SimpleNamespace(channels={"beauty": np.broadcast_to(columns[:, np.newaxis], (*size[::-1], 3))})

    monkeypatch.setattr("thurston_cl.render", paint)
    pixels = gallery["picture"]("h3/seifert-weber-panorama", 1)
    whole = to_srgb(paint(None, (360, 180), 1).channels["beauty"])
    assert pixels.shape == (180, 320, 3)
    np.testing.assert_array_equal(pixels, whole[:, 20:340])
