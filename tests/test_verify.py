"""`thurston render --verify` and `--verify-mp`, and what `thurston accuracy SCENE` measures and advises."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result
from test_accuracy_pictures import QUOTIENTS, directions, mismatch, turned_aside, whole_space

from thurston_cl.accuracy import knobs, knobs_table
from thurston_cl.accuracy.knobs import Row
from thurston_cl.accuracy.pictures import all_places, compare
from thurston_cl.accuracy.rays import ExactRays, Rays
from thurston_cl.accuracy.verify import random_places, verify
from thurston_cl.accuracy.verify_mp import angle_error, check
from thurston_cl.cli.main import main
from thurston_cl.device import Device
from thurston_cl.errors import NoDeviceError
from thurston_cl.geometry import Geometry
from thurston_cl.method import Method
from thurston_cl.models import GEOMETRIES
from thurston_cl.scene import load_scene, load_text

SIZE = (60, 40)
BALLS = """
geometry: h3
camera: {at: [0.1, 0, 0.2], look: {along: [1, 0.1, 0]}}
objects:
  - ball: {radius: 0.4}
    at: [1.2, 0.1, 0]
  - ball: {radius: 0.3}
    at: [1.6, 1.0, 0.4]
render: {size: [60, 40], samples: 3}
"""

Thurston = Callable[..., Result]


@pytest.fixture
def thurston(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Thurston:
    """Run the command line in an empty folder with a scene in it."""
    (tmp_path / "scene.yaml").write_text(BALLS)
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(main, arguments, prog_name="thurston")


@pytest.fixture
def without_double(monkeypatch: pytest.MonkeyPatch, opencl_device: Device) -> None:
    lesser = dataclasses.replace(
        opencl_device, info=dataclasses.replace(opencl_device.info, fp64=False, name="Toaster")
    )
    monkeypatch.setattr("thurston_cl.device.choose", lambda request=None: lesser)


# --- verification in double


def test_random_pixels_are_the_same_in_every_run_and_none_twice() -> None:
    scene = load_text(BALLS)
    one, two = (random_places(scene, 100) for _ in range(2))
    np.testing.assert_array_equal(one.xy, two.xy)
    assert len(np.unique(one.pixel, axis=0)) == 100
    # All samples of a pixel occur.
    assert len(np.unique(one.shift, axis=0)) == 3
    assert not np.array_equal(one.pixel, random_places(scene, 100, seed=2).pixel)
    assert len(random_places(scene, 10**6)) == 60 * 40


def test_a_picture_is_verified(opencl_device: Device) -> None:
    scene = load_text(BALLS)
    found = verify(scene, 300, Method.of(scene), opencl_device)
    assert found.report["random"]["n"] == found.report["largest_estimate"]["n"] == 300
    for part in (found.drawn, found.suspected):
        assert part.summary["over_half_pixel"] == 0
        assert part.summary["angle"]["max"] < 2e-6
    assert json.loads(json.dumps(found.report, allow_nan=False))["seed"] == 1
    assert found.words[0].startswith("300 random pixels: 300 of 300 within half a pixel (100.00%), ")
    assert "the 300 with the largest estimate: 300 of 300" in found.words[1]


def test_the_largest_estimate_is_where_the_threshold_shows_most(opencl_device: Device) -> None:
    scene = load_text(BALLS)
    found = verify(scene, 100, Method(threshold=1e-3), opencl_device)
    drawn = found.drawn.method.length[found.drawn.method.object > 0]
    # Near things, since geodesics part.
    assert found.suspected.method.object.min() > 0
    assert found.suspected.method.length.max() < np.median(drawn)


def test_rays_out_of_steps_are_suspected_first(opencl_device: Device) -> None:
    scene = load_text(BALLS)
    found = verify(scene, 20, Method(steps=6), opencl_device)
    assert found.suspected.method.out_of_steps.all()
    assert found.suspected.over.mean() > 0.5
    assert found.words[-1].startswith("worst: ")


def test_a_wrong_flow_is_found_out(opencl_device: Device) -> None:
    scene = load_text(BALLS)
    found = verify(scene, 200, Method(flow="euler", step=0.5), opencl_device)
    assert found.drawn.summary["over_half_pixel"] > 0.05
    first = found.worst[0]
    assert first["over_half_pixel"]
    assert first["shown_pixels"] > 0.5 or first["object"] != first["true_object"]
    x, y = first["pixel"]
    assert 0 <= x < 60
    assert 0 <= y < 40


def test_a_crop_is_verified_within_itself(opencl_device: Device) -> None:
    scene = load_text(BALLS)
    area = (20, 10, 30, 25)
    found = verify(scene, 1000, Method(), opencl_device, area=area)
    for part in (found.drawn, found.suspected):
        assert len(part.places) == 150
        assert part.places.pixel.min(axis=0).tolist() == [20, 10]
        assert part.places.pixel.max(axis=0).tolist() == [29, 24]


def test_without_double_there_is_no_truth(opencl_device: Device) -> None:
    info = dataclasses.replace(opencl_device.info, fp64=False, name="Toaster")
    with pytest.raises(NoDeviceError, match=r"Toaster .* has no double precision, which errors are measured"):
        ExactRays(load_text(BALLS), dataclasses.replace(opencl_device, info=info))


# --- verification by mpmath


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_mpmath_finds_the_turn_of_a_direction(geometry: str, opencl_device: Device) -> None:
    scene = whole_space(geometry)
    eye, u = directions(scene, opencl_device)
    u = u[:: len(u) // 4]
    angle = np.array([1e-9, 1e-7, 1e-5, 1e-4, 1e-6])[: len(u)]
    aside = turned_aside(u, angle, seed=3)
    point, _ = Geometry(geometry, device=opencl_device).flow(aside, 2.5, eye)
    for k in range(len(u)):
        found = angle_error(geometry, None, eye, u[k], 2.5, point[k])
        # The point is known to the last digits of double, and the angle is small.
        assert found == pytest.approx(mismatch(u[k : k + 1], aside[k : k + 1])[0], rel=2e-3, abs=1e-14)


@pytest.mark.parametrize("name", QUOTIENTS)
def test_double_and_mpmath_find_the_same_errors(name: str, opencl_device: Device) -> None:
    scene = load_scene(name)
    found = check(scene, 4, Method(), opencl_device, SIZE)
    assert len(found.places) == 4
    exact = ExactRays(scene, opencl_device, SIZE)
    rays = Rays(scene, Method(), opencl_device, SIZE)
    in_double = compare(rays, exact, found.places, rays.trace(found.places))
    near = in_double.method.length < 8
    assert near.sum() >= 2
    np.testing.assert_allclose(found.angle[near], in_double.angle[near], rtol=1e-3, atol=1e-13)
    # And the truth itself is right.
    itself = check(scene, 4, Method("double"), opencl_device, SIZE)
    assert itself.angle.max() < 1e-13
    assert f"4 pixels by mpmath, 30 digits: angle error up to {found.pixels.max():.2g} pixels" in found.words
    assert [entry["angle"] for entry in found.report["pixels"]] == found.angle.tolist()


def test_mpmath_says_that_nothing_is_hit(opencl_device: Device) -> None:
    scene = load_text("geometry: e3\nobjects: [{ball: {radius: 0.1}, at: [-5, 0, 0]}]\n")
    found = check(scene, 2, Method(), opencl_device, (8, 6))
    assert len(found.angle) == 0
    assert found.words == "by mpmath: none of the pixels hits anything"


# --- the options of `thurston render`


def test_render_verifies_what_it_has_written(thurston: Thurston) -> None:
    result = thurston("render", "scene.yaml", "-o", "a.png", "--verify", "50", "--verify-mp", "2", "--json")
    assert result.exit_code == 0, result.output
    lines = result.stderr.splitlines()
    assert lines[0].startswith("wrote a.png: 60x40")
    assert lines[1].startswith("verified in double precision, ")
    assert lines[2].startswith("  50 random pixels: 50 of 50 within half a pixel (100.00%), ")
    assert lines[-1].startswith("2 pixels by mpmath, 30 digits: ")
    answer = json.loads(result.stdout)
    assert answer["verify"]["random"]["n"] == 50
    assert set(answer["verify"]["random"]["angle_pixels"]) == {"50", "95", "99", "99.9", "max"}
    assert len(answer["verify_mp"]["pixels"]) == 2


def test_it_verifies_the_method_of_the_picture(thurston: Thurston) -> None:
    arguments = ("render", "scene.yaml", "-o", "a.png", "--verify", "50", "--json", "--quiet", "--force")
    in_double = json.loads(thurston(*arguments, "--precision", "double").stdout)
    in_single = json.loads(thurston(*arguments).stdout)
    assert in_double["verify"]["random"]["angle"]["max"] < 1e-13
    assert in_single["verify"]["random"]["angle"]["max"] > 1e-9
    cropped = json.loads(thurston(*arguments, "--crop", "5,5,10,9").stdout)
    assert cropped["verify"]["random"]["n"] == 20
    assert thurston(*arguments).stderr == ""


@pytest.mark.parametrize("option", ["--verify", "--verify-mp"])
def test_a_number_of_pixels_is_expected(thurston: Thurston, option: str) -> None:
    result = thurston("render", "scene.yaml", "-o", "a.png", option, "0")
    assert result.exit_code == 2
    assert f"Invalid value for '{option}'" in result.stderr


@pytest.mark.usefixtures("without_double")
@pytest.mark.parametrize("option", ["--verify", "--verify-mp"])
def test_without_double_it_does_not_begin(thurston: Thurston, option: str, tmp_path: Path) -> None:
    result = thurston("render", "scene.yaml", "-o", "a.png", option, "5")
    assert result.exit_code == 69
    assert "Toaster" in result.stderr
    assert "has no double precision, which --verify and --verify-mp need; leave them out" in result.stderr
    assert not (tmp_path / "a.png").exists()


# --- methods of a scene


def test_candidates_are_tried_once_and_the_scenes_own_first() -> None:
    scene = load_text(BALLS)
    found = knobs.candidates(scene, Method.of(scene))
    methods = [method for _, method in found]
    assert len(set(methods)) == len(methods)
    assert found[0] == ("own", Method.of(scene))
    assert {method.flow for method in methods} == {"exact", "euler", "rk2", "rk4", "rk8"}
    assert {method.threshold for method in methods} == {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7}
    assert {method.steps for method in methods} == {50, 100, 200, 300, 600}
    assert {method.precision for method in methods} == {"single", "double"}


def test_in_euclidean_space_there_is_nothing_to_integrate() -> None:
    scene = load_text("geometry: e3\nobjects: [{ball: {radius: 0.1}}]\n")
    assert {method.flow for _, method in knobs.candidates(scene, Method.of(scene))} == {"exact"}


def row(knob: str = "method", relative: float = 1.0, over: float = 0.0, **method: Any) -> Row:
    quantiles = dict.fromkeys(("50", "95", "99", "99.9", "max"), 1e-3)
    return Row(
        knob,
        Method(**method),
        relative * 0.1,
        relative,
        0.02,
        over,
        0.0,
        0.25,
        quantiles,
        quantiles,
        None,
        None,
    )


OWN = row("own")


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        # The cheapest that is good.
        ([OWN, row(relative=0.5, threshold=1e-3), row(relative=0.3, over=0.01, threshold=1e-2)], 1),
        # As good as the scene's own, and no cheaper than timings differ by.
        ([OWN, row(relative=0.97, threshold=1e-3)], 0),
        # The scene's own is not good.
        ([row("own", over=0.5), row(relative=3.0, precision="double"), row(relative=9, threshold=1e-7)], 1),
        ([row("own", over=0.5), row(relative=3.0, over=0.002)], None),
        ([row("own", over=0.0011), row(relative=3.0, over=0.0009)], 1),
        ([row("own", over=math.nan)], None),
    ],
)
def test_the_cheapest_that_is_good_is_recommended(rows: list[Row], expected: int | None) -> None:
    assert knobs.recommended(rows) is (None if expected is None else rows[expected])


def test_the_recommendation_is_a_line_of_a_scene() -> None:
    found = knobs.verdict([OWN, row(relative=0.5, threshold=1e-3, flow="rk4", step=0.1)])
    assert found == (
        "recommended: render: {precision: single, flow: rk4, flow-step: 0.1, threshold: 0.001, steps: 300}: "
        "0.00% of the pixels over half a pixel off, 0.50 x the time of what the scene says"
    )
    # It is one that scenes accept.
    line = found.removeprefix("recommended: ").partition("}")[0] + "}"
    scene = load_text(f"geometry: h3\nobjects: [{{ball: {{radius: 0.1}}}}]\n{line}\n")
    assert Method.of(scene) == Method(flow="rk4", step=0.1, threshold=1e-3)
    assert "the scene's own settings are as cheap as any" in knobs.verdict([OWN])
    assert knobs.verdict([row("own", over=0.5)]).startswith("none has at most 0.1% of the pixels over half")
    assert knobs.verdict([]) == "nothing is measured"


def test_the_front_is_of_rows_that_none_beats() -> None:
    rows = [
        OWN,
        row(relative=0.5, over=0.1),
        row(relative=0.7, over=0.2),
        row(relative=0.9, over=0.05),
        row(relative=2.0),
    ]
    assert knobs.front(rows) == [rows[1], rows[3], rows[0]]


def test_rows_as_text_json_and_csv() -> None:
    rows = [OWN, row(relative=2.0, over=0.5, flow="euler", step=0.1, precision="double")]
    lines = knobs_table.text(rows, ["head"]).splitlines()
    assert lines[0] == "head"
    assert lines[2].split()[:5] == ["precision", "flow", "step", "threshold", "steps"]
    assert "*" in lines[4]
    assert lines[6].split()[:8] == ["double", "euler", "0.1", "0.0001", "300", "200", "2.00", "2.00%"]
    assert lines[-1] == knobs.verdict(rows)
    answer = json.loads(knobs_table.as_json(rows, scene="it"))
    assert answer["scene"] == "it"
    assert answer["rows"][1]["over_half_pixel"] == 0.5
    assert answer["rows"][1]["depth_99.9"] is None
    read = list(csv.DictReader(io.StringIO(knobs_table.as_csv(rows))))
    assert [entry["flow"] for entry in read] == ["exact", "euler"]
    assert float(read[0]["angle_99.9"]) == 1e-3
    assert read[0]["depth_max"] == read[0]["step"] == ""


def few(scene: Any, own: Method | None = None) -> list[tuple[str, Method]]:
    return [
        ("own", own or Method.of(scene)),
        ("method", Method("double")),
        ("method", Method(flow="euler", step=0.2)),
        ("steps", Method(steps=6)),
    ]


def test_methods_of_a_scene_are_measured(opencl_device: Device) -> None:
    scene = load_text(BALLS)
    told: list[tuple[int, int, str]] = []
    rows = list(knobs.measure(scene, opencl_device, SIZE, lambda *at: told.append(at), few(scene)))
    own, double, euler, short = rows
    assert own.relative == 1
    assert all(row.seconds > 0 for row in rows)
    assert own.over_half_pixel == double.over_half_pixel == 0
    assert double.angle is not None
    assert own.angle is not None
    assert double.angle["max"] < 1e-13 < own.angle["50"]
    assert euler.over_half_pixel > 0.02
    assert short.out_of_steps > 0.02
    assert [(done, total) for done, total, _ in told] == [(0, 4), *((k, 4) for k in range(5))]
    assert told[0][2] == "the truth"
    # Errors are those of the whole picture.
    places = all_places(scene, SIZE)
    exact, rays = ExactRays(scene, opencl_device, SIZE), Rays(scene, Method.of(scene), opencl_device, SIZE)
    assert own.angle == compare(rays, exact, places, rays.trace(places)).summary["angle"]


def test_the_command_prints_a_table_and_a_recommendation(
    thurston: Thurston, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(knobs, "candidates", few)
    result = thurston("accuracy", "scene.yaml", "--size", "30x20", "--plot", "plot.png")
    assert result.exit_code == 0, result.output
    assert result.stdout.startswith("scene.yaml, 30x20 pixels on ")
    assert "- the scene's own method" in result.stdout
    assert result.stdout.splitlines()[-1].startswith(("recommended: ", "the scene's own", "none has"))
    assert "0 of 4, 0 s: the truth" in result.stderr
    assert result.stderr.splitlines()[-1].startswith("measured 4 methods in ")
    assert (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")
    answer = thurston("accuracy", "scene.yaml", "--size", "30x20", "--json", "-q")
    assert answer.exit_code == 0
    assert answer.stderr == ""
    assert json.loads(answer.stdout)["size"] == [30, 20]
    assert json.loads(answer.stdout)["complete"]


def test_an_interrupt_prints_what_is_finished(thurston: Thurston, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(knobs, "candidates", few)
    timed = knobs._time_beside
    calls: list[int] = []

    def interrupted(*arguments: Any) -> Any:
        calls.append(1)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return timed(*arguments)

    monkeypatch.setattr(knobs, "_time_beside", interrupted)
    result = thurston("accuracy", "scene.yaml", "--size", "30x20")
    assert result.exit_code == 130
    assert result.stderr.splitlines()[-1] == "thurston: interrupted: 1 of 4 rows are finished and printed"
    assert "single" in result.stdout
    assert "double exact, threshold" not in result.stdout


@pytest.mark.usefixtures("without_double")
def test_a_scene_cannot_be_measured_without_double(thurston: Thurston) -> None:
    result = thurston("accuracy", "scene.yaml")
    assert result.exit_code == 69
    assert "Toaster" in result.stderr
    assert "has no double precision, which errors are measured against" in result.stderr


def test_a_scene_that_is_wrong_is_told(thurston: Thurston, tmp_path: Path) -> None:
    (tmp_path / "wrong.yaml").write_text("geometry: e4\n")
    assert thurston("accuracy", "wrong.yaml").exit_code == 65
    assert thurston("accuracy", "nowhere.yaml").exit_code == 66
    panorama = "geometry: e3\ncamera: {projection: {equirectangular: {}}}\nobjects: [{ball: {radius: 0.1}}]\n"
    (tmp_path / "panorama.yaml").write_text(panorama)
    result = thurston("accuracy", "panorama.yaml", "--size", "30x30")
    assert result.exit_code == 2
    assert "for example --size 60x30" in result.stderr


def test_a_plot_needs_rows() -> None:
    from thurston_cl.accuracy.knobs_plot import plot

    with pytest.raises(ValueError, match="no rows to draw"):
        plot([], "nothing.png", "")
