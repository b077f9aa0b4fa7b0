"""Exposure and views: what a number of light becomes on a screen, and that each output has its own film."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any, get_args

import numpy as np
import OpenImageIO as oiio
import pytest

import thurston_cl as tc
from thurston_cl import image
from thurston_cl.errors import OutputError
from thurston_cl.image import VIEWS, Image, read_image, to_srgb
from thurston_cl.scene.settings import Output

# From black to far over white, in steps far below those of 8 bits.
LIGHT = np.concatenate([[0], np.geomspace(1e-6, 65504, 20001)]).astype(np.float32)
COLORS = np.float32([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0.2, 0.05], [0.1, 0.3, 0.8]])


def gray(light: Any) -> np.ndarray:
    """A row of gray pixels (1,N,3)."""
    return np.repeat(np.atleast_1d(np.float32(light))[np.newaxis, :, np.newaxis], 3, axis=2)


def screen(linear: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1, in 255ths."""
    return 255 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def filmic(color: np.ndarray) -> np.ndarray:
    """The curve as film.ocio states it, worked out without OpenColorIO: (...,3) in 255ths."""
    mixed = 0.88 * color.astype(float) + 0.04 * color.astype(float).sum(axis=-1, keepdims=True)
    s = 0.18 * (0.82 / 0.18) ** (1 / 1.5)
    return screen(mixed**1.5 / (mixed**1.5 + s**1.5))


def numbers(shown: np.ndarray) -> list[int]:
    return [int(level) for level in shown[0, :, 0]]


def test_the_views_stand_in_one_order_everywhere() -> None:
    assert get_args(Output.model_fields["view"].annotation) == VIEWS
    config = oiio.ColorConfig(image._COLOR_CONFIG)
    assert config.geterror() == ""
    assert tuple(config.getViewNames(image._DISPLAY)) == VIEWS
    limits = {type(bound).__name__: bound for bound in Output.model_fields["exposure"].metadata}
    assert limits["Ge"].ge == -image.EXPOSURE_LIMIT
    assert limits["Le"].le == image.EXPOSURE_LIMIT


@pytest.mark.parametrize(
    ("view", "wanted"),
    [
        # The formula of sRGB.
        ("none", [0, 118, 255, 255, 255]),
        # 0.18 stays; 1 / (1 + 0.348) = 0.742 is 224.
        ("filmic", [0, 118, 224, 250, 254]),
        # Of the configuration that comes with OpenColorIO 2.5 (below): 10 nits of 100 for middle gray.
        ("aces", [0, 89, 180, 229, 249]),
    ],
)
def test_reference_levels(view: str, wanted: list[int]) -> None:
    assert numbers(to_srgb(gray([0, 0.18, 1, 4, 16]), view=view)) == wanted


def test_the_reference_levels_are_those_of_the_documentation() -> None:
    page = (Path(__file__).parents[1] / "docs" / "scene.md").read_text(encoding="utf-8")
    for light, name in ((0.18, "0.18, middle gray"), (1, "1"), (4, "4"), (16, "16")):
        levels = " | ".join(str(numbers(to_srgb(gray(light), view=view))[0]) for view in VIEWS)
        assert f"| {name} | {levels} |\n" in page


@pytest.mark.parametrize("view", VIEWS)
def test_gray_stays_gray_and_in_order(view: str) -> None:
    shown = to_srgb(gray(LIGHT), view=view)
    assert (shown == shown[..., :1]).all()
    levels = shown[0, :, 0].astype(int)
    assert levels[0] == 0
    assert levels[-1] == 255
    assert (np.diff(levels) >= 0).all()
    # No level is jumped over: a curve, not a step.
    assert np.diff(levels).max() == 1


@pytest.mark.parametrize("view", VIEWS)
def test_no_view_leaves_the_screen(view: str) -> None:
    """Before they are cut to bytes, in colors too; 2e-5 for OpenColorIO's own approximation of powers."""
    strong = COLORS * np.geomspace(1e-3, 6e4, 200, dtype=np.float32)[:, np.newaxis, np.newaxis]
    display = image._displayed(strong if view != "none" else np.clip(strong, 0, 1), view)
    assert np.isfinite(display).all()
    assert display.min() >= -2e-5
    assert display.max() <= 1 + 2e-5


def test_filmic_is_the_curve_that_it_says() -> None:
    """Half a step for rounding, 0.02 for OpenColorIO's own approximation of powers."""
    assert np.abs(to_srgb(gray(LIGHT), view="filmic") - filmic(gray(LIGHT))).max() < 0.52
    light = COLORS[np.newaxis] * 2.0 ** np.arange(-6, 7)[:, np.newaxis, np.newaxis]
    assert np.abs(to_srgb(light, view="filmic") - filmic(light)).max() < 0.52


def test_aces_is_that_of_the_configuration_of_opencolorio() -> None:
    """The matrix and the order of transforms in film.ocio against the library's own, in colors and grays."""
    config = "ocio://cg-config-v4.0.0_aces-v2.0_ocio-v2.5"
    view = "ACES 2.0 - SDR 100 nits (Rec.709)"
    if view not in oiio.ColorConfig(config).getViewNames("sRGB - Display"):
        pytest.skip("this OpenColorIO is too old to have the view")
    light = np.random.default_rng(3).random((40, 40, 3), np.float32) ** 2 * 8
    wanted = oiio.ImageBufAlgo.ociodisplay(
        oiio.ImageBuf(light), "sRGB - Display", view, "lin_rec709_scene", colorconfig=config
    )
    np.testing.assert_allclose(image._displayed(light, "aces"), wanted.get_pixels("float"), atol=1e-5)


def test_views_differ_in_highlights_and_strong_light_pales() -> None:
    none, film, aces = (numbers(to_srgb(gray([2, 4, 8]), view=view)) for view in VIEWS)
    assert none == [255, 255, 255]
    assert film[0] < film[1] < film[2] < 255
    assert aces[0] < aces[1] < aces[2] < 255
    assert all(darker < lighter for darker, lighter in zip(aces, film, strict=True))
    for view in ("filmic", "aces"):
        for color in COLORS:
            levels = to_srgb(color * 2.0 ** np.float32([[[0], [2], [4], [6]]]), view=view)[0].astype(int)
            spread = levels.max(axis=1) - levels.min(axis=1)
            assert (np.diff(spread) < 0).all(), (view, color)


@pytest.mark.parametrize("view", VIEWS)
def test_a_stop_doubles_the_light(view: str) -> None:
    light = np.random.default_rng(4).random((9, 11, 3), np.float32) * 3
    for stops in (1, -1, 5):
        # Powers of two are exact: the very same picture.
        once = to_srgb(light, exposure=stops, view=view)
        np.testing.assert_array_equal(once, to_srgb(light * np.float32(2.0**stops), view=view))
    half_a_stop = to_srgb(light, exposure=0.5, view=view).astype(int)
    assert np.abs(half_a_stop - to_srgb(light * np.sqrt(2), view=view)).max() <= 1
    assert (half_a_stop >= to_srgb(light, view=view)).all()


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("exposure", [-32, 0, 32])
def test_what_is_no_number_has_a_color_under_every_film(view: str, exposure: float) -> None:
    light = np.full((5, 5, 3), 1e-12, np.float32)
    light[0, 0], light[0, 4], light[4, 0] = np.inf, -np.inf, np.float32(3e38)
    light[2, 2] = np.nan
    shown = to_srgb(light, exposure, view)
    assert (shown[0, 0] == 255).all()
    assert (shown[0, 4] == 0).all()
    assert (shown[4, 0] == 255).all()
    np.testing.assert_array_equal(shown[2, 2], shown[3, 3])


def test_a_broken_ocio_variable_changes_no_view() -> None:
    code = (
        "import numpy as np; from thurston_cl.image import VIEWS, to_srgb;"
        "print([int(to_srgb(np.full((1, 1, 3), 0.18, np.float32), 1, view)[0, 0, 0]) for view in VIEWS])"
    )
    env = os.environ | {"OCIO": "/nonexistent/config.ocio"}
    run = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True)
    wanted = [numbers(to_srgb(gray(0.36), view=view))[0] for view in VIEWS]
    assert run.stdout.strip() == str(wanted), run.stderr


@pytest.mark.parametrize(
    ("film", "says"),
    [
        ({"view": "agx"}, "unknown view 'agx'; there are none, filmic, aces"),
        ({"exposure": 32.5}, "exposure is 32.5; expected from -32 to 32 stops"),
        ({"exposure": -33}, "exposure is -33"),
        ({"exposure": float("nan")}, "exposure is nan"),
    ],
)
def test_films_that_there_are_not(tmp_path: Path, film: dict[str, Any], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        Image({"beauty": gray(1)}).save(tmp_path / "a.png", **film)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("film", [{"view": "filmic"}, {"exposure": -1}])
def test_an_exr_has_no_film(tmp_path: Path, film: dict[str, Any]) -> None:
    with pytest.raises(
        OutputError, match="keeps the linear numbers; leave exposure and view out, or write a PNG"
    ):
        Image({"beauty": gray(1)}).save(tmp_path / "a.exr", **film)
    assert os.listdir(tmp_path) == []


def test_the_metadata_tell_the_film(tmp_path: Path) -> None:
    picture = Image({"beauty": gray([0.18, 4])}, {"title": "t"})
    picture.save(tmp_path / "a.png", exposure=-1.5, view="aces")
    got = read_image(tmp_path / "a.png")
    assert got.metadata == {"title": "t", "exposure": "-1.5", "view": "aces"}
    np.testing.assert_array_equal(
        to_srgb(got.channels["beauty"]), to_srgb(picture.channels["beauty"], -1.5, "aces")
    )
    assert picture.metadata == {"title": "t"}


def test_outputs_of_a_scene_differ_by_their_film_alone(tmp_path: Path) -> None:
    """Through the renderer: the EXR has the light, and each PNG is what its film makes of that."""
    scene = tc.load_scene(_scene(tmp_path))
    picture = tc.render(scene)
    for output in scene.outputs:
        film = {} if output.file.endswith(".exr") else {"exposure": output.exposure, "view": output.view}
        picture.save(tmp_path / output.file, **film)
    light = read_image(tmp_path / "c.exr").channels["beauty"]
    np.testing.assert_array_equal(light, picture.channels["beauty"])
    assert light.max() > 1
    seen = [to_srgb(read_image(tmp_path / name).channels["beauty"]) for name in ("a.png", "b.png")]
    np.testing.assert_array_equal(seen[0], to_srgb(light, 1.5))
    np.testing.assert_array_equal(seen[1], to_srgb(light, view="filmic"))
    assert (seen[0] != seen[1]).any()


def _scene(folder: Path) -> Path:
    path = folder / "scene.yaml"
    path.write_text(
        "geometry: e3\n"
        "objects: [ball: {radius: 0.5}]\n"
        "lights: [point: {at: [-0.5, -0.6, 0.6], intensity: 3}]\n"
        "render: {size: [24, 16], samples: 1}\n"
        "outputs: [{file: a.png, exposure: 1.5}, {file: b.png, view: filmic}, {file: c.exr}]\n"
    )
    return path
