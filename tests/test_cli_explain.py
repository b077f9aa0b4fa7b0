"""`thurston explain`: what a scene calls for, what is left out, and the source that it prints."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner, Result

from thurston_cl.cli.main import main
from thurston_cl.device import Device
from thurston_cl.krs import moebius
from thurston_cl.rendering import render
from thurston_cl.scene import load_scene

PLAIN = """\
geometry: h3
camera: {at: [-2, 0, 0]}
objects:
  - ball: {radius: 0.4}
"""

RICH = """\
geometry: h3
manifold: seifert-weber
camera: {at: [0.6, 0, 0]}
params: {density: 0.2}
objects:
  - ball: {radius: 0.3}
    material: {color: {checker: {count: 8}}}
  - complement: {ball: {radius: 0.9}}
lights:
  - point: {at: [0.3, 0.5, 0.2]}
    shadows: hard
effects: {fog: {exponential: {density: $density}}}
outputs: [{file: a.exr, channels: [beauty, cell]}]
"""


@pytest.fixture
def explain(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Result]:
    (tmp_path / "plain.yaml").write_text(PLAIN)
    (tmp_path / "rich.yaml").write_text(RICH)
    (tmp_path / "sequences.yaml").write_text(SEQUENCES)
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(main, ["explain", *arguments], prog_name="thurston")


SEQUENCES = """\
geometry: e3
camera: {at: [-9, 0, 3]}
materials: {leaf: {color: olivedrab}}
objects:
  - krs:
      kernel: {leaf: {radius: 0.1, thickness: 0.03, at: [-1, 0, 2]}, material: leaf}
      levels:
        - {mirror: {normal: [2, 0, 0], smooth: 0.25}, kernel: {ball: {radius: 0.5, at: [0, -1, 0]}}}
        - {mirror: {normal: [0, 1, 0]}}
        - {mirror: {normal: [0, 0, -1], offset: 1}, kernel: {half-space: {}, material: {color: tan}}}
  - krs:
      kernel: {capsule: {from: [-1, 0, 0], to: [-1, 0, 3], radius: 0.5}}
      moebius: [{map: [{bend: [0.1, 0, 0]}]}, {map: [{scale: 2}]}]
    at: [0, 5, 0]
  - krs: {tree: {levels: 4, leaves: 1, seed: 3}}
"""


def rows(result: Result) -> dict[str, str]:
    """Heading and value of each row, continued lines joined."""
    found: dict[str, str] = {}
    for line in result.stdout.splitlines():
        heading, _, value = line.partition("  ")
        last = heading or list(found)[-1]
        found[last] = f"{found[last]} {value.strip()}" if not heading else value.strip()
    return found


def test_a_plain_scene_leaves_all_effects_out(explain: Callable[..., Result]) -> None:
    result = explain("plain.yaml")
    assert result.exit_code == 0, result.output
    said = rows(result)
    assert said["geometry"] == "h3"
    assert said["space"] == "the whole space"
    for effect in ("hard shadows", "exponential fog", "checker", "grid"):
        assert effect in said["left out"]
        assert effect not in said["called for"]
    assert said["arithmetic"].startswith("single precision, ")
    assert "-cl-std=CL1.2" in said["compiler options"]


def test_the_camera_and_its_samples_are_named(explain: Callable[..., Result]) -> None:
    said = rows(explain("plain.yaml"))
    assert said["camera"] == "perspective"
    assert said["picture"] == "960 x 540, 4 samples a pixel, box filter, seed 0"
    changes = {
        "camera.projection": "{equirectangular: {}}",
        "camera.stereo": "{layout: top-bottom, distance: 0.1}",
        "render": "{filter: tent, seed: 7, samples: 2}",
    }
    sets = [word for key, value in changes.items() for word in ("--set", f"{key}={value}")]
    said = rows(explain("plain.yaml", *sets))
    assert said["camera"] == "equirectangular, stereo top-bottom, eyes 0.1 apart"
    assert said["picture"] == "1024 x 1024, 2 samples a pixel, tent filter, seed 7"
    assert "camera/omnidirectional.h" in said["kernel files"]


def test_a_rich_scene_names_what_it_calls_for(explain: Callable[..., Result]) -> None:
    said = rows(explain("rich.yaml"))
    assert "seifert-weber" in said["space"]
    for effect in ("hard shadows", "exponential fog", "checker", "cell ids"):
        assert effect in said["called for"]
        assert effect not in said["left out"]
    assert "grid" in said["left out"]
    assert said["outputs"] == "a.exr: beauty, cell"


def test_outputs_are_shown_with_their_film(explain: Callable[..., Result]) -> None:
    assert rows(explain("plain.yaml"))["outputs"] == "none: the command line names them"
    outputs = "outputs=[{file: a.png, view: filmic, exposure: 1.5}, {file: b.png}, {file: c.exr}, "
    outputs += "{file: d.png, shows: steps, most: 70}, {file: e.png, shows: depth}]"
    answer = json.loads(explain("plain.yaml", "--json", "--set", outputs).stdout)
    assert answer["explanation"]["outputs"].split("\n") == [
        "a.png: view filmic, exposure +1.5",
        "b.png: view none, exposure +0",
        "c.exr: beauty",
        "d.png: heat map of steps, black at 70",
        "e.png: heat map of depth, black at the largest that occurs",
    ]


def test_what_is_left_out_is_not_in_the_source(explain: Callable[..., Result]) -> None:
    plain, rich = explain("plain.yaml", "--source").stdout, explain("rich.yaml", "--source").stdout
    for name in ("hard_shadow", "fog_exponential", "checker", "next_cell["):
        assert name in rich
        assert name not in plain
    assert "/grid.h" not in rich


def test_the_printed_source_compiles_by_hand(explain: Callable[..., Result], opencl_device: Device) -> None:
    import pyopencl as cl

    head, _, source = explain("plain.yaml", "--source").stdout.partition("\n")
    options = head.removeprefix("// clBuildProgram options: ")
    # One lane builds quickest; the rest is as printed.
    chosen = [word for word in shlex.split(options) if not word.startswith("-DLANES=")]
    program = cl.Program(opencl_device.context, source).build([*chosen, "-DLANES=1"])
    assert "shade" in program.kernel_names.split(";")


def test_json_holds_the_same_and_the_source_on_request(explain: Callable[..., Result]) -> None:
    answer = json.loads(explain("rich.yaml", "--json").stdout)
    assert rows(explain("rich.yaml")) == {
        heading: " ".join(value.split()) for heading, value in answer["explanation"].items()
    }
    assert "source" not in answer
    assert not set(answer["called_for"]) & set(answer["left_out"])
    assert "march.h" in answer["parts"]
    with_source = json.loads(explain("rich.yaml", "--json", "--source").stdout)
    assert with_source["source"] == explain("rich.yaml", "--source").stdout.split("\n", 1)[1]


def test_precision_and_changes_of_the_scene_count(
    explain: Callable[..., Result], opencl_device: Device
) -> None:
    result = explain("rich.yaml", "-D", "density=0.1", "--set", "lights=[{point: {at: [1, 0, 0]}}]")
    assert "hard shadows" in rows(result)["left out"]
    if opencl_device.info.fp64:
        said = rows(explain("plain.yaml", "--precision", "double"))
        assert said["arithmetic"].startswith("double precision, ")
        assert "-DFP64=1" in said["compiler options"]


def test_exit_codes(explain: Callable[..., Result], monkeypatch: pytest.MonkeyPatch) -> None:
    assert explain().exit_code == 2
    assert explain("plain.yaml", "-D", "q=1").exit_code == 65
    assert explain("plian.yaml").exit_code == 66
    assert explain("plain.yaml", "--device", "no such device").exit_code == 69
    toaster = SimpleNamespace(info=SimpleNamespace(id="0:0", name="Toaster", fp64=False))
    monkeypatch.setattr("thurston_cl.device.choose", lambda request=None: toaster)
    result = explain("plain.yaml", "--precision", "double")
    assert result.exit_code == 69
    assert "Toaster (0:0) has no double precision" in result.stderr


def test_the_predicted_cost_is_that_of_what_is_counted(explain: Callable[..., Result]) -> None:
    """Each light asks once a surface point for its geodesic, each shadowed one casts a ray from it; what the
    scene does not name has no cost."""
    more = "lights=[{point: {at: [0.3, 0, 0]}, shadows: hard}, {point: {at: [0, 0.3, 0], translates: 3}}]"
    costs = json.loads(explain("rich.yaml", "--json", "--set", more).stdout)["costs"]
    assert costs["lights"]["count"] == 13 + 3
    assert costs["hard shadows"]["count"] == 13
    assert set(costs) == {
        "lights",
        "light fading by area density",
        "checker",
        "hard shadows",
        "exponential fog",
        "cell ids",
    }
    image = render(load_scene("rich.yaml", sets=[more]), size=(64, 40), samples=1)
    shadow_solves = image.statistics["light_solves"] - 16 * image.statistics["hits"]
    assert 0 < shadow_solves < 13 * image.statistics["hits"]
    cheaper = json.loads(explain("plain.yaml", "--json").stdout)["costs"]
    assert cheaper["lights"]["share_of_first_rays"] == pytest.approx(
        costs["lights"]["share_of_first_rays"] / 8
    )
    assert "hard shadows: about " in rows(explain("rich.yaml"))["predicted cost"]


@pytest.mark.filterwarnings("ignore:sequence")
def test_sequences_level_by_level(explain: Callable[..., Result], monkeypatch: pytest.MonkeyPatch) -> None:
    """A line a level: mirror or map, how many of its kernel, and its material by name."""
    monkeypatch.setenv("COLUMNS", "140")
    result = explain("sequences.yaml")
    indent = result.stdout.index("e3") - result.stdout.index("geometry")
    table = [
        line[indent:] for line in result.stdout.split("sequence 1")[1].split("distance near")[0].split("\n")
    ]
    assert "3 levels, 13 kernels in all, without bound" in result.stdout
    assert table[1:5] == [
        "0: 8 x leaf of radius 0.1, 0.03 thick: leaf",
        "1: mirror (1, 0, 0) at 0, smooth 0.25; 4 x ball of radius 0.5",
        "2: mirror (0, 1, 0) at 0",
        "3: mirror (0, 0, -1) at 1; 1 x half-space: tan",
    ]
    assert table[6:9] == [
        "0: 4 x capsule over 3, radius 0.5",
        "1: mirror x = 0, map with pole (10, 0, 0)",
        "2: mirror x = 0, similarity x 2",
    ]
    tree = json.loads(explain("sequences.yaml", "--json").stdout)["sequences"][2]
    assert [level["made_of"] for level in tree["levels"]] == ["leaf"] + 4 * ["bark"]
    assert [level["instances"] for level in tree["levels"]] == [16, 8, 4, 2, 1]


@pytest.mark.filterwarnings("ignore:sequence")
def test_the_levels_of_sequences_as_data(explain: Callable[..., Result]) -> None:
    first, second, _ = json.loads(explain("sequences.yaml", "--json").stdout)["sequences"]
    assert first["levels"][0] == {
        "step": None,
        "kernel": "leaf of radius 0.1, 0.03 thick",
        "made_of": "leaf",
        "instances": 8,
    }
    assert first["levels"][1]["made_of"] is None
    assert first["levels"][2] == {
        "step": "mirror (0, 1, 0) at 0",
        "kernel": None,
        "made_of": None,
        "instances": 0,
    }
    assert (first["kernels"], first["radius"]) == (13, None)
    assert second["kernels"] == 4
    # Balls of radius 2 about the capsule and its image; then all of it is twice as large.
    centers, radii, _ = moebius.bend([0.1, 0, 0]).sphere_image([[-1, 0, 1.5], [1, 0, 1.5]], [2.0, 2.0])
    reach = 2 * np.max(np.linalg.norm(centers, axis=1) + radii)
    assert second["radius"] == pytest.approx(reach, rel=1e-12)


@pytest.mark.filterwarnings("ignore:sequence")
def test_long_levels_go_on_further_in(
    explain: Callable[..., Result], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "70")
    lines = explain("sequences.yaml").stdout.split("sequence 1")[1].split("sequence 2")[0].split("\n")
    assert all(len(line) <= 70 for line in lines)
    starts = [line.lstrip()[:2] for line in lines[1:-1]]
    levels = [start for start in starts if start in ("0:", "1:", "2:", "3:")]
    assert levels == ["0:", "1:", "2:", "3:"]
    assert len(starts) > len(levels)
    first = lines[starts.index("1:") + 1]
    after = lines[starts.index("1:") + 2]
    assert len(after) - len(after.lstrip()) == len(first) - len(first.lstrip()) + 2
