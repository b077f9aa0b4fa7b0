"""`thurston render`: options, outputs, exit codes, and what an interrupt leaves.

A fake plays the renderer, except at the end.
"""

from __future__ import annotations

import io
import json
import os
import re
import select
import signal
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from thurston_cl.cli import render as cli_render
from thurston_cl.cli.main import main
from thurston_cl.image import CHANNELS, Image, read_image, to_srgb

SCENE = """\
geometry: e3
params: {r: 0.4}
objects:
  - ball: {radius: $r}
render: {size: [8, 6]}
"""


class FakeRenderer:
    """Stands in for `thurston_cl.render`: notes what it was asked for, and gives a grey picture."""

    def __init__(self) -> None:
        self.calls: list[dict[str, Any]] = []
        self.scene: Any = None
        self.statistics: dict[str, Any] = {
            "hits": np.int64(7),
            "rays": 48,
            "ratio": float("nan"),
            "precision": "single",
            "device": "Toaster",
        }
        self.raises: BaseException | None = None
        self.warns: str | None = None

    def __call__(self, scene: Any, **options: Any) -> Image:
        self.scene = scene
        self.calls.append(options)
        for done in range(1, 5):
            options["progress"](done, 4)
            if self.raises and done == 2:
                raise self.raises
        if self.warns:
            warnings.warn(self.warns, stacklevel=2)
        width, height = options["size"] or scene.render.size
        grey = np.full((height, width), 0.5, np.float32)
        ids = np.ones((height, width), np.uint32)
        color = np.repeat(grey[..., np.newaxis], 3, axis=2)
        channels = {
            "beauty": color,
            "depth": grey,
            "normal": color,
            "steps": grey,
            "object": ids,
            "cell": ids,
        }
        asked = {name: channels[name] for name in options["channels"]}
        return Image(asked, {"scene": "text"}, self.statistics)


@pytest.fixture
def renderer(monkeypatch: pytest.MonkeyPatch) -> FakeRenderer:
    fake = FakeRenderer()
    module = ModuleType("thurston_cl.rendering")
    module.render = fake  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "thurston_cl.rendering", module)
    return fake


@pytest.fixture
def device(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    info = SimpleNamespace(id="0:0", name="Toaster", fp64=False)
    chosen = SimpleNamespace(info=info)
    monkeypatch.setattr("thurston_cl.device.choose", lambda request=None: chosen)
    return chosen


@pytest.fixture
def thurston(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, device: SimpleNamespace
) -> Callable[..., Result]:
    """Run the command line in an empty folder with a scene in it."""
    (tmp_path / "scene.yaml").write_text(SCENE)
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(main, ["render", *arguments], prog_name="thurston")


def new_files(folder: Path) -> list[str]:
    return sorted(set(os.listdir(folder)) - {"scene.yaml"})


# --- outputs


def test_several_outputs_of_one_render(
    thurston: Callable[..., Result], renderer: FakeRenderer, tmp_path: Path
) -> None:
    result = thurston("scene.yaml", "-o", "a.exr", "-o", "a.PNG")
    assert result.exit_code == 0, result.output
    assert len(renderer.calls) == 1
    assert new_files(tmp_path) == ["a.PNG", "a.exr"]
    assert tuple(read_image("a.exr").channels) == CHANNELS
    assert read_image("a.PNG").metadata == {"scene": "text", "exposure": "0.0", "view": "none"}
    assert result.stdout == ""
    wanted = r"wrote a\.exr, a\.PNG: 8x6 in [0-9.]+ s, single precision on Toaster\n"
    assert re.fullmatch(wanted, result.stderr)


def test_channels_are_for_exr(thurston: Callable[..., Result], renderer: FakeRenderer) -> None:
    result = thurston("scene.yaml", "-o", "a.exr", "-o", "a.png", "--channels", "depth, object")
    assert result.exit_code == 0, result.output
    assert renderer.calls[0]["channels"] == ("beauty", "depth", "object")
    assert list(read_image("a.exr").channels) == ["depth", "object"]
    assert list(read_image("a.png").channels) == ["beauty"]


def test_the_outputs_of_the_scene(
    thurston: Callable[..., Result], renderer: FakeRenderer, tmp_path: Path
) -> None:
    (tmp_path / "scene.yaml").write_text(
        SCENE + "outputs: [{file: b.exr, channels: [beauty, cell]}, {file: b.png}, {file: c.exr}]\n"
    )
    result = thurston("scene.yaml", "--json")
    assert result.exit_code == 0, result.output
    assert list(read_image("b.exr").channels) == ["beauty", "cell"]
    assert json.loads(result.stdout)["outputs"] == [
        {"file": "b.exr", "channels": ["beauty", "cell"]},
        {"file": "b.png", "channels": ["beauty"], "exposure": 0.0, "view": "none"},
        {"file": "c.exr", "channels": ["beauty"]},
    ]
    # -o comes instead of them.
    assert thurston("scene.yaml", "-o", "d.png").exit_code == 0
    assert new_files(tmp_path) == ["b.exr", "b.png", "c.exr", "d.png"]


def test_existing_outputs_are_kept_and_found_before_rendering(
    thurston: Callable[..., Result], renderer: FakeRenderer, tmp_path: Path
) -> None:
    (tmp_path / "b.png").write_text("mine")
    result = thurston("scene.yaml", "-o", "a.exr", "-o", "b.png")
    assert result.exit_code == 73
    assert (
        result.stderr == "thurston: error: b.png: exists; use --force (in Python: force=True) to replace it\n"
    )
    assert not renderer.calls
    assert new_files(tmp_path) == ["b.png"]
    assert (tmp_path / "b.png").read_text() == "mine"
    assert thurston("scene.yaml", "-o", "b.png", "--force").exit_code == 0
    assert read_image("b.png").width == 8


def test_a_missing_directory_is_found_before_rendering(
    thurston: Callable[..., Result], renderer: FakeRenderer
) -> None:
    result = thurston("scene.yaml", "-o", "out/a.png")
    assert result.exit_code == 73
    assert "out/a.png: there is no directory" in result.stderr
    assert not renderer.calls


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["scene.yaml"], "where to? Give -o FILE.png or -o FILE.exr, or 'outputs' in the scene"),
        ([], "Missing argument 'SCENE'"),
        (["scene.yaml", "-o", "scene.yaml"], "'scene.yaml' does not end in .exr or .png"),
        (["scene.yaml", "-o", "a.png", "-o", "./a.png"], "-o ./a.png is given twice"),
        (["scene.yaml", "-o", "a.png", "--channels", "depth"], "--channels says what an .exr holds"),
        (["scene.yaml", "-o", "a.exr", "--channels", "depht"], "'depht' is not one of beauty, depth"),
        (["scene.yaml", "-o", "a.png", "--size", "0x5"], "width and height are from 1 to 16384"),
        (["scene.yaml", "-o", "a.png", "--size", "99999x5"], "width and height are from 1 to 16384"),
        (["scene.yaml", "-o", "a.png", "--size", "5"], "not of the form WxH, for example 960x540"),
        (["scene.yaml", "-o", "a.png", "--crop", "0,0,0,5"], "holds no pixel"),
        (["scene.yaml", "-o", "a.png", "--crop", "0,0,9,5"], "reaches beyond the picture of 8x6 pixels"),
        (
            ["scene.yaml", "-o", "a.png", "--size", "9x6", "--set", "camera.stereo={layout: side-by-side}"],
            "--size 9x6: each eye has half of the width, and 9 is odd; for example --size 10x6",
        ),
        (
            [
                "scene.yaml",
                "-o",
                "a.png",
                "--size",
                "320x180",
                "--set",
                "camera.projection={equirectangular: {}}",
                "--set",
                "render.size=[8, 4]",
            ],
            "is twice as wide as high; this is 320 x 180; for example --size 360x180",
        ),
        (["scene.yaml", "-o", "a.png", "--crop", "1,2,3"], "not of the form X0,Y0,X1,Y1"),
        (["scene.yaml", "-o", "a.png", "--lanes", "3"], "'3' is not one of '1', '4', '8'"),
        (["scene.yaml", "-o", "a.png", "--samples", "0"], "0 is not in the range"),
        (["scene.yaml", "-o", "a.png", "-D", "r"], "not of the form NAME=VALUE"),
        (["scene.yaml", "-o", "a.png", "--sice", "3x4"], "--size"),
    ],
)
def test_wrong_usage(
    thurston: Callable[..., Result], renderer: FakeRenderer, tmp_path: Path, arguments: list[str], says: str
) -> None:
    result = thurston(*arguments)
    assert result.exit_code == 2
    assert says in result.stderr.replace("\n", " ")
    assert not renderer.calls
    assert new_files(tmp_path) == []


# --- options


def test_options_reach_the_renderer(
    thurston: Callable[..., Result], renderer: FakeRenderer, device: SimpleNamespace
) -> None:
    device.info.fp64 = True
    arguments = "scene.yaml -o a.png --size 20x10 --samples 3 --crop 1,2,11,10 --precision double --lanes 16"
    result = thurston(*arguments.split(), "--finish", "refill", "-D", "r=0.3", "--set", "render.steps=77")
    assert result.exit_code == 0, result.output
    (options,) = renderer.calls
    del options["progress"]
    assert options == {
        "device": device,
        "precision": "double",
        "accuracy": None,
        "lanes": 16,
        "finish": "refill",
        "size": (20, 10),
        "samples": 3,
        "crop": (1, 2, 11, 10),
        "channels": ("beauty",),
    }
    assert renderer.scene.objects[0].ball.radius == 0.3
    assert renderer.scene.render.steps == 77


def test_options_left_out_are_left_to_the_scene(
    thurston: Callable[..., Result], renderer: FakeRenderer, device: SimpleNamespace
) -> None:
    assert thurston("scene.yaml", "-o", "a.png").exit_code == 0
    (options,) = renderer.calls
    assert {name for name, value in options.items() if value is not None} == {
        "device",
        "progress",
        "channels",
    }


@pytest.mark.parametrize("arguments", [["--precision", "double"], ["--set", "render.precision=double"]])
def test_double_needs_a_device_that_has_it(
    thurston: Callable[..., Result], renderer: FakeRenderer, arguments: list[str]
) -> None:
    result = thurston("scene.yaml", "-o", "a.png", *arguments)
    assert result.exit_code == 69
    assert "Toaster (0:0) has no double precision; use --precision single" in result.stderr
    assert not renderer.calls


def test_a_wrong_scene_and_a_missing_one(thurston: Callable[..., Result], renderer: FakeRenderer) -> None:
    result = thurston("scene.yaml", "-o", "a.png", "--set", "render.sampels=3")
    assert result.exit_code == 65
    assert "samples" in result.stderr
    assert thurston("scene.yaml", "-o", "a.png", "-D", "q=3").exit_code == 65
    assert thurston("scnee.yaml", "-o", "a.png").exit_code == 66


# --- what is said


def test_json_is_the_only_thing_on_stdout(thurston: Callable[..., Result], renderer: FakeRenderer) -> None:
    result = thurston("scene.yaml", "-o", "a.png", "--json", "--quiet")
    assert result.exit_code == 0
    assert result.stderr == ""
    answer = json.loads(result.stdout)
    assert answer.pop("total_seconds") > 0
    assert answer == {
        "hits": 7,
        "rays": 48,
        "ratio": None,
        "precision": "single",
        "device": "Toaster",
        "outputs": [{"file": "a.png", "channels": ["beauty"], "exposure": 0.0, "view": "none"}],
        "warnings": [],
    }


def test_json_holds_the_warnings_that_are_shown(
    thurston: Callable[..., Result], renderer: FakeRenderer
) -> None:
    renderer.statistics["nan"] = 3
    renderer.warns = "no ray hit anything"
    result = thurston("scene.yaml", "-o", "a.png", "--json", "--quiet")
    shown = json.loads(result.stdout)["warnings"]
    lost = "3 of 48 rays came to nothing (NaN) and show the background; try --precision double"
    assert shown == ["no ray hit anything", lost]
    assert result.stderr == "".join(f"thurston: warning: {text}\n" for text in shown)


def test_json_has_exposures_as_numbers_of_one_kind(
    thurston: Callable[..., Result], renderer: FakeRenderer, tmp_path: Path
) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE + "outputs: [{file: a.png}, {file: b.png, exposure: 1}]\n")
    outputs = json.loads(thurston("scene.yaml", "--json").stdout)["outputs"]
    assert [repr(output["exposure"]) for output in outputs] == ["0.0", "1.0"]


def test_nan_is_warned_of_even_when_quiet(thurston: Callable[..., Result], renderer: FakeRenderer) -> None:
    renderer.statistics["nan"] = 3
    result = thurston("scene.yaml", "-o", "a.png", "--quiet")
    assert result.stderr.startswith("thurston: warning: 3 of 48 rays came to nothing (NaN)")
    assert result.stderr.count("\n") == 1


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_progress_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with cli_render._Progress(True) as progress:
        progress(1, 4)
        progress(4, 4)
    shown = terminal.getvalue()
    assert "rendering" in shown
    assert "25%" in shown
    assert "100%" in shown


def test_no_progress_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with cli_render._Progress(False) as progress:
        progress(4, 4)
    assert terminal.getvalue() == ""


def test_help_shows_options_in_groups(thurston: Callable[..., Result]) -> None:
    text = thurston("--help").stdout
    headings = ["Scene:", "Output:", "Rendering:", "Device:", "Other:"]
    assert [line for line in text.splitlines() if line in headings] == headings
    assert text.index("Output:") < text.index("--channels") < text.index("Rendering:") < text.index("--crop")


def test_the_lists_of_the_command_line_are_those_of_the_image_module() -> None:
    from thurston_cl import image

    assert cli_render.CHANNELS == image.CHANNELS
    assert cli_render.HEAT_CHANNELS == image.HEAT_CHANNELS
    assert cli_render.SUFFIXES == image.SUFFIXES
    assert cli_render.VIEWS == image.VIEWS
    assert cli_render.EXPOSURE_LIMIT == image.EXPOSURE_LIMIT


# --- film


def test_film_of_the_scene(thurston: Callable[..., Result], renderer: FakeRenderer, tmp_path: Path) -> None:
    """Three pictures of one render, each with its own film; the numbers have none."""
    (tmp_path / "scene.yaml").write_text(
        SCENE + "outputs: [{file: a.png, exposure: 1.5}, {file: b.png, view: filmic}, {file: c.exr}]\n"
    )
    result = thurston("scene.yaml", "--json")
    assert result.exit_code == 0, result.output
    assert len(renderer.calls) == 1
    gray = np.full((6, 8, 3), 0.5, np.float32)
    np.testing.assert_array_equal(read_image("c.exr").channels["beauty"], gray)
    assert read_image("c.exr").metadata == {"scene": "text"}
    assert shown("a.png") == {tuple(to_srgb(gray, exposure=1.5)[0, 0])}
    assert shown("b.png") == {tuple(to_srgb(gray, view="filmic")[0, 0])}
    films = [(output.get("exposure"), output.get("view")) for output in json.loads(result.stdout)["outputs"]]
    assert films == [(1.5, "none"), (0.0, "filmic"), (None, None)]


def test_film_of_the_command_line_is_for_png(
    thurston: Callable[..., Result], renderer: FakeRenderer, tmp_path: Path
) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE + "outputs: [{file: a.png, exposure: 3}]\n")
    files = ("-o", "a.exr", "-o", "a.png", "-o", "b.PNG")
    result = thurston("scene.yaml", *files, "--view", "aces", "--exposure", "-1")
    assert result.exit_code == 0, result.output
    np.testing.assert_array_equal(read_image("a.exr").channels["beauty"], np.float32(0.5))
    wanted = to_srgb(np.full((6, 8, 3), 0.5, np.float32), -1, "aces")
    assert shown("a.png") == shown("b.PNG") == {tuple(wanted[0, 0])}
    assert read_image("a.png").metadata == {"scene": "text", "exposure": "-1.0", "view": "aces"}
    # -o stands instead of the outputs of the scene, film and all.
    assert thurston("scene.yaml", "-o", "c.png").exit_code == 0
    assert read_image("c.png").metadata["exposure"] == "0.0"


def test_heat_maps_of_the_scene(
    thurston: Callable[..., Result], renderer: FakeRenderer, tmp_path: Path
) -> None:
    (tmp_path / "scene.yaml").write_text(
        SCENE + "outputs: [{file: a.png, shows: steps, most: 2}, {file: b.png, shows: depth}]\n"
    )
    result = thurston("scene.yaml", "--json")
    assert result.exit_code == 0, result.output
    # Only what is shown is worked out.
    assert renderer.calls[0]["channels"] == ("depth", "steps")
    assert shown("a.png") == {(191, 191, 191)}
    assert shown("b.png") == {(0, 0, 0)}
    # What was not said is.
    assert result.stderr.startswith("wrote a.png, b.png (depth, black at 0.5): 8x6 in ")
    assert json.loads(result.stdout)["outputs"] == [
        {"file": "a.png", "channels": ["steps"], "most": 2.0},
        {"file": "b.png", "channels": ["depth"], "most": 0.5},
    ]


def test_heat_maps_of_the_command_line(
    thurston: Callable[..., Result], renderer: FakeRenderer, tmp_path: Path
) -> None:
    files = ("-o", "a.exr", "-o", "a.png")
    result = thurston("scene.yaml", *files, "--channels", "depth", "--shows", "steps", "--most", "2")
    assert result.exit_code == 0, result.output
    assert renderer.calls[0]["channels"] == ("depth", "steps")
    assert list(read_image("a.exr").channels) == ["depth"]
    assert shown("a.png") == {(191, 191, 191)}
    assert read_image("a.png").metadata == {"scene": "text", "shows": "steps", "most": "2.0"}
    assert result.stderr.startswith("wrote a.exr, a.png: 8x6 in ")
    result = thurston("scene.yaml", *files, "--shows", "steps", "--force")
    assert result.stderr.startswith("wrote a.exr, a.png (steps, black at 0.5): 8x6 in ")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["-o", "a.exr", "--view", "filmic"], "--view says how a .png shows the picture: name one with -o"),
        (["-o", "a.exr", "--exposure", "0"], "--exposure says how a .png shows the picture"),
        (["--view", "filmic"], "--view says how a .png shows the picture"),
        (["-o", "a.png", "--view", "agx"], "'agx' is not one of 'none', 'filmic', 'aces'"),
        (["-o", "a.png", "--exposure", "40"], "40 is not from -32 to 32 stops"),
        (["-o", "a.png", "--exposure", "nan"], "nan is not from -32 to 32 stops"),
        (["-o", "a.exr", "--shows", "steps"], "--shows says how a .png shows the picture"),
        (["-o", "a.exr", "--most", "70"], "--most says how a .png shows the picture"),
        (["-o", "a.png", "--shows", "normal"], "'normal' is not one of 'beauty', 'depth', 'steps'"),
        (["-o", "a.png", "--most", "70"], "add --shows steps or --shows depth"),
        (["-o", "a.png", "--shows", "beauty", "--most", "70"], "add --shows steps or --shows depth"),
        (["-o", "a.png", "--shows", "steps", "--most", "0"], "0 is not a finite number over 0"),
        (["-o", "a.png", "--shows", "steps", "--most", "nan"], "nan is not a finite number over 0"),
        (["-o", "a.png", "--shows", "steps", "--view", "aces"], "--view is for light, and --shows steps for"),
        (
            ["-o", "a.png", "--shows", "depth", "--exposure", "1"],
            "--exposure is for light, and --shows depth",
        ),
    ],
)
def test_film_that_cannot_be(
    thurston: Callable[..., Result], renderer: FakeRenderer, arguments: list[str], says: str
) -> None:
    result = thurston("scene.yaml", *arguments)
    assert result.exit_code == 2
    assert says in " ".join(result.stderr.split())
    assert not renderer.calls


def shown(file: str) -> set[tuple[int, ...]]:
    """The colors of a picture's pixels as its file holds them."""
    return {tuple(pixel) for pixel in to_srgb(read_image(file).channels["beauty"]).reshape(-1, 3)}


# --- interrupts


@pytest.mark.parametrize("raised", [KeyboardInterrupt(), RuntimeError("boom")])
def test_a_render_that_ends_early_leaves_nothing(
    thurston: Callable[..., Result], renderer: FakeRenderer, tmp_path: Path, raised: BaseException
) -> None:
    renderer.raises = raised
    result = thurston("scene.yaml", "-o", "a.exr", "-o", "a.png")
    assert result.exit_code == (130 if isinstance(raised, KeyboardInterrupt) else 1)
    assert ("nothing written" in result.stderr) == isinstance(raised, KeyboardInterrupt)
    assert new_files(tmp_path) == []


def test_an_interrupt_between_outputs_names_the_one_that_is_whole(
    thurston: Callable[..., Result], renderer: FakeRenderer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    save = Image.save

    def interrupted(self: Image, path: str, *arguments: Any, **options: Any) -> None:
        if path == "b.png":
            raise KeyboardInterrupt
        save(self, path, *arguments, **options)

    monkeypatch.setattr(Image, "save", interrupted)
    result = thurston("scene.yaml", "-o", "a.exr", "-o", "b.png")
    assert result.exit_code == 130
    assert result.stderr == "thurston: interrupted: only a.exr written\n"
    assert read_image("a.exr").width == 8
    assert new_files(tmp_path) == ["a.exr"]


# --- the renderer itself


BALL = """\
geometry: e3
camera: {at: [-2, 0, 0]}
params: {r: 0.6}
objects:
  - ball: {radius: $r}
render: {size: [60, 40], samples: 1}
"""

REPEATED = """\
geometry: e3
manifold: three-torus
camera: {at: [-0.45, 0.1, 0.2]}
objects:
  - ball: {radius: 0.3}
"""


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """The installed command, in a process of its own."""
    command = [sys.executable, "-m", "thurston_cl.cli.main", "render", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120)


@pytest.fixture(scope="module")
def ball(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a scene, its picture in ball.exr, and what the command said in ball.json."""
    folder = tmp_path_factory.mktemp("ball")
    (folder / "ball.yaml").write_text(BALL)
    result = run(folder, "ball.yaml", "-o", "ball.exr", "--json", "-D", "r=0.7")
    assert result.returncode == 0, result.stderr
    (folder / "ball.json").write_text(result.stdout)
    return folder


def test_the_picture_shows_the_ball(ball: Path) -> None:
    picture = read_image(ball / "ball.exr").channels
    # The middle looks at the nearest point, 2 - 0.7 away; the corners look past the ball.
    assert picture["depth"][20, 30] == pytest.approx(1.3, abs=2e-3)
    assert picture["object"][20, 30] == 1
    assert picture["beauty"][20, 30].min() > 0
    for corner in ((0, 0), (0, -1), (-1, 0), (-1, -1)):
        assert picture["object"][corner] == 0
        assert np.isinf(picture["depth"][corner])
    np.testing.assert_array_equal(np.isfinite(picture["depth"]), picture["object"] == 1)
    # Seen from 2 away, a ball of radius 0.7 fills a cone of asin(0.35); the picture is 80 degrees high.
    radius = np.tan(np.arcsin(0.35)) / np.tan(np.radians(40)) * 20
    assert picture["object"].sum() == pytest.approx(np.pi * radius**2, rel=0.05)


def test_a_heat_map_shows_the_steps_that_the_numbers_tell(ball: Path) -> None:
    steps = read_image(ball / "ball.exr").channels["steps"]
    assert np.unique(steps).size > 5
    options = ("-D", "r=0.7", "--shows", "steps", "--json")
    result = run(ball, "ball.yaml", "-o", "steps.png", *options)
    assert result.returncode == 0, result.stderr
    found = to_srgb(read_image(ball / "steps.png").channels["beauty"])[..., 0]
    most = json.loads(result.stdout)["outputs"][0]["most"]
    assert most == steps.max()
    np.testing.assert_array_equal(found, np.rint(255 - 255 * steps / most))


def test_statistics_fit_the_picture(ball: Path) -> None:
    answer = json.loads((ball / "ball.json").read_text())
    picture = read_image(ball / "ball.exr").channels
    assert answer["rays"] == 60 * 40
    assert answer["hits"] == (picture["object"] > 0).sum()
    assert answer["steps"] == picture["steps"].sum()
    assert answer["nan"] == 0
    assert answer["precision"] == "single"
    assert 0 < answer["kernel_seconds"] < answer["seconds"] <= answer["total_seconds"]
    assert {"device", "lanes", "finish"} <= set(answer)


def test_the_metadata_makes_the_picture_again(ball: Path) -> None:
    first = read_image(ball / "ball.exr")
    settings = json.loads(first.metadata["settings"])
    (ball / "again.yaml").write_text(first.metadata["scene"])
    size = "x".join(map(str, settings["size"]))
    result = run(ball, "again.yaml", "-o", "again.exr", "--size", size, "--precision", settings["precision"])
    assert result.returncode == 0, result.stderr
    again = read_image(ball / "again.exr")
    for name in CHANNELS:
        np.testing.assert_array_equal(again.channels[name], first.channels[name], err_msg=name)


def test_a_crop_is_a_part_of_the_picture(ball: Path) -> None:
    result = run(ball, "ball.yaml", "-o", "crop.exr", "-D", "r=0.7", "--crop", "21,5,47,38")
    assert result.returncode == 0, result.stderr
    whole, part = read_image(ball / "ball.exr"), read_image(ball / "crop.exr")
    for name in CHANNELS:
        np.testing.assert_array_equal(part.channels[name], whole.channels[name][5:38, 21:47], err_msg=name)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_stopped_render_leaves_no_file(tmp_path: Path, number: signal.Signals) -> None:
    """On a terminal, since the progress shown there tells when the kernels run."""
    (tmp_path / "scene.yaml").write_text(REPEATED)
    ours, theirs = os.openpty()
    command = [sys.executable, "-m", "thurston_cl.cli.main", "render", "scene.yaml"]
    command += ["-o", "a.exr", "-o", "a.png", "--size", "2000x2000", "--samples", "4096"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=theirs, stdout=subprocess.PIPE) as process:
        os.close(theirs)
        said = b""
        try:
            while b"%" not in said:
                assert select.select([ours], [], [], 60)[0], said
                said += os.read(ours, 4096)
            process.send_signal(number)
            assert process.wait(timeout=30) == 130
        finally:
            process.kill()
        said += os.read(ours, 65536)
        os.close(ours)
    assert b"rendering" in said
    assert b"thurston: interrupted: nothing written" in said
    assert new_files(tmp_path) == []
