"""Accuracy targets: the cheapest method by what was measured, what a picture tells of it, and exit code 3."""

from __future__ import annotations

import dataclasses
import itertools
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

import thurston_cl as tc
from thurston_cl.accuracy.pictures import all_places
from thurston_cl.accuracy.rays import Rays
from thurston_cl.accuracy.verify import verify
from thurston_cl.arrays import ArrayProgram
from thurston_cl.cli.main import main
from thurston_cl.device import Device
from thurston_cl.image import read_image
from thurston_cl.method import Method
from thurston_cl.models import GEOMETRIES, ORIGIN
from thurston_cl.program import Source, geometry_parts
from thurston_cl.scene import choice as module
from thurston_cl.scene import load_scene, load_text
from thurston_cl.scene.choice import (
    FINEST_SINGLE,
    MARGIN,
    MISSED,
    REFERENCE,
    WORDS,
    Choice,
    Glance,
    achieved,
    choose_method,
    fitted,
    flow_error,
    with_accuracy,
)
from thurston_cl.scene.measured import ALLOWED, KNOBS, Row, measured
from thurston_cl.scene.pixel import half_pixels
from thurston_cl.scene.plan import make_plan
from thurston_cl.scene.schema import Scene

BALL = "geometry: nil\nobjects: [{ball: {radius: 0.5}, at: [0, 1.2, 0]}]\n"
# The tile of figure 1 in each geometry asks for half a pixel.
TILES = [
    "e3/three-torus-edges",
    "s3/quaternion-edges",
    "h3/ideal-cube",
    "s2xe/hopf-manifold-tile",
    "h2xe/orbi-torus-tile",
    "nil/heisenberg-tile",
    "sl2/genus-two-tile",
    "sol/anosov-tile",
]


def asking(accuracy: str, more: str = "") -> Scene:
    return load_text(f"{BALL}render: {{accuracy: {accuracy}{more}}}\n")


def half(scene: Scene) -> float:
    return float(half_pixels(scene.camera, scene.render.size, 0.0, 0.0))


# -- the tables ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_every_geometry_was_measured(geometry: str) -> None:
    """Each table begins with the plain row, which costs 1; what is finer reaches more and is not free."""
    tables = measured(geometry)
    assert set(tables) == set(KNOBS)
    plain = Method()
    for knob in ("flows", "thresholds", "steps"):
        first = tables[knob][0]
        assert first.cost == 1
        assert all(getattr(plain, name) == value for name, value in first.settings.items()), knob
    fine = [row for row in tables["thresholds"] if row.settings["precision"] == "double"]
    fine.sort(key=lambda row: -row.settings["threshold"])
    reached = [math.inf if row.reaches is None else row.reaches for row in fine]
    assert reached == sorted(reached, reverse=True)
    assert reached[-1] <= 1e-6
    exact = {row.settings["precision"]: row for row in tables["flows"] if row.settings["flow"] == "exact"}
    assert exact["double"].reaches is not None and exact["single"].reaches is not None
    assert exact["double"].reaches < exact["single"].reaches
    assert exact["double"].cost > 1
    assert (len(tables["newton"]) > 0) == (geometry in ("nil", "sl2", "sol"))
    assert (len(tables["agm"]) > 0) == (geometry == "sol")
    assert 2 * ALLOWED <= 1e-3


def rows(*entries: tuple[dict[str, Any], float, float | None]) -> tuple[Row, ...]:
    return tuple(Row(*entry) for entry in entries)


EXACT = {"precision": "single", "flow": "exact", "step": None}
DOUBLE = EXACT | {"precision": "double"}
RK4 = {"precision": "single", "flow": "rk4", "step": 0.1}


def table(**knobs: tuple[Row, ...]) -> dict[str, tuple[Row, ...]]:
    """Tables in which only the given ones say something."""
    known = {
        "flows": rows((EXACT, 1, 1e-5), (DOUBLE, 3, 1e-9)),
        "thresholds": rows(
            *(({"precision": p, "threshold": 1e-4}, 1, 1e-9) for p in ("single", "double")),
        ),
        "steps": rows(({"steps": 300}, 1, 1e-9)),
        "newton": (),
        "agm": (),
    }
    return known | knobs


def chosen(
    tables: dict[str, tuple[Row, ...]], target: float, monkeypatch: pytest.MonkeyPatch, **more: Any
) -> Choice:
    monkeypatch.setattr(module, "measured", lambda geometry: tables)
    return choose_method(load_text(BALL), target, **more)


def test_a_row_has_to_be_better_by_the_margin(monkeypatch: pytest.MonkeyPatch) -> None:
    """MARGIN, on both sides: errors of several settings add up."""
    thresholds = rows(
        ({"precision": "single", "threshold": 1e-3}, 1.0, 1e-3),
        ({"precision": "single", "threshold": 1e-5}, 2.0, 1e-6),
    )
    known = table(flows=rows((EXACT, 1, 1e-9)), thresholds=thresholds)
    only = {"precisions": ["single"]}
    assert chosen(known, MARGIN * 1.001e-3, monkeypatch, **only).method.threshold == 1e-3
    assert chosen(known, MARGIN * 0.999e-3, monkeypatch, **only).method.threshold == 1e-5


def test_a_row_is_taken_for_its_time_only_if_it_is_worth_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """WORTH, on both sides: the exact flow stands unless an integrator is cheaper by more than noise."""
    for share, flow in ((1.01, "exact"), (0.99, "rk4")):
        flows = rows((EXACT, 1, 1e-5), (RK4, share * module.WORTH, 1e-5))
        found = chosen(table(flows=flows), 1e-3, monkeypatch, precisions=["single"])
        assert found.method.flow == flow


def test_double_precision_where_single_is_not_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of what reaches the target the cheapest; where nothing does the most accurate, and it says so."""
    assert chosen(table(), 1e-4, monkeypatch).method.precision == "single"
    found = chosen(table(), 1e-6, monkeypatch)
    assert (found.method.precision, found.met, found.cost, found.estimated) == ("double", True, 3, 1e-9)
    missed = chosen(table(), 1e-6, monkeypatch, precisions=["single"])
    assert (missed.method.precision, missed.met, missed.estimated) == ("single", False, 1e-5)
    assert "which is not enough to be sure of it" in missed.words
    beyond = chosen(table(), 1e-12, monkeypatch)
    assert not beyond.met and beyond.method.precision == "double"


def test_costs_multiply_and_the_worst_setting_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    known = table(
        thresholds=rows(({"precision": "single", "threshold": 1e-5}, 1.5, 2e-5)),
        steps=rows(({"steps": 600}, 1.2, 1e-6)),
        newton=rows(({"precision": "single", "newton": 6}, 0.5, 1e-6)),
        agm=rows(({"precision": "double", "agm": 5}, 0.5, 1e-6)),
    )
    found = chosen(known, 1e-4, monkeypatch, precisions=["single"])
    # The cost of a solve is no share of that of a picture.
    assert found.cost == pytest.approx(1.8)
    assert found.estimated == 2e-5
    assert found.method == Method("single", threshold=1e-5, steps=600, newton=6)


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_words_ask_for_more_and_more(geometry: str) -> None:
    """draft, half-pixel, quarter-pixel and reference: targets in halves of a pixel, and no cheaper each."""
    scene = load_text(BALL.replace("nil", geometry))
    found = {word: choose_method(scene, word) for word in (*WORDS, "reference")}
    for word, halves in WORDS.items():
        assert found[word].target == pytest.approx(halves * half(scene))
        assert found[word].met
        assert found[word].estimated <= found[word].target / MARGIN
    costs = [choice.cost for choice in found.values()]
    assert all(after >= before * module.WORTH for before, after in itertools.pairwise(costs)), costs
    assert found["reference"].method == REFERENCE and found["reference"].met
    single = choose_method(scene, "reference", ["single"])
    assert single.method.precision == "single" and not single.met


def test_a_large_picture_needs_more() -> None:
    scene = load_text(BALL)
    small, large = (choose_method(scene, "half-pixel", size=size) for size in ((320, 180), (15360, 8640)))
    assert large.target < small.target / 40
    assert large.method.threshold < small.method.threshold


def test_what_is_known_of_a_flow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Other steps by the order of the flow, never better than rounding; infinite where nothing is known."""
    flows = rows((EXACT, 1, 1e-6), (RK4, 1, 1e-4), (RK4 | {"flow": "rk2"}, 1, None))
    monkeypatch.setattr(module, "measured", lambda geometry: table(flows=flows))
    assert flow_error("nil", Method()) == 1e-6
    assert flow_error("nil", Method(flow="rk4", step=0.1)) == 1e-4
    assert flow_error("nil", Method(flow="rk4", step=0.2)) == pytest.approx(16e-4)
    assert flow_error("nil", Method(flow="rk4", step=0.01)) == 1e-6
    assert flow_error("nil", Method(flow="rk2", step=0.1)) == math.inf
    assert flow_error("nil", Method("double")) == math.inf


# -- in scenes, pictures and on the command line -------------------------------------------------------------


def test_a_plan_says_what_was_chosen(opencl_device: Device) -> None:
    plan = make_plan(asking("quarter-pixel"), device=opencl_device)
    assert plan.choice is not None and plan.method == plan.choice.method
    assert plan.explain()["accuracy"].startswith("quarter-pixel, 0.000")
    assert plan.numbers[0] == plan.method.threshold
    assert plan.source.defines.items() >= plan.method.defines.items()
    plain = make_plan(load_text(BALL), device=opencl_device)
    assert plain.choice is None and plain.explain()["accuracy"] == "not asked for: the plain settings"


def test_an_angle_is_as_good_as_a_word() -> None:
    assert asking("1e-5 rad").render.accuracy == 1e-5
    assert asking("0.001 deg").render.accuracy == pytest.approx(math.radians(0.001))
    scene = load_text(BALL)
    assert choose_method(scene, half(scene)).method == choose_method(scene, "half-pixel").method


def test_bounds_of_iterations_reach_the_program(opencl_device: Device) -> None:
    """newton and agm are defines of the program, and change what it finds."""
    ball = "objects: [{ball: {radius: 0.5}, at: [0, 1.2, 0]}]"
    scene = load_text(f"geometry: sol\n{ball}\nrender: {{size: [64, 36]}}\n")
    # In single precision short steps do without the mean.
    exact = Method("double")
    plain = Rays(scene, exact, opencl_device)
    places = all_places(scene)
    want = plain.trace(places)
    for few, enough in (({"agm": 1}, {"agm": 9}), ({"newton": 1}, {"newton": 64})):
        method = dataclasses.replace(exact, **few)
        source = make_plan(scene, device=opencl_device, method=method).source
        assert source.defines.items() >= method.defines.items()
        same = Rays(scene, dataclasses.replace(exact, **enough), opencl_device).trace(places)
        assert np.array_equal(same.length, want.length, equal_nan=True)
    assert np.isfinite(want.length[want.hit]).any()
    # A few iterations of Newton's method change the geodesics that are found, if not what is hit.
    points = tc.Geometry("nil").flow([[0.6, 0.0, 0.8]], [3.0])[0]
    parts = (*geometry_parts("nil"), "arrays.h", "numerics.cl")
    lengths = []
    for method in (Method(newton=1), Method()):
        program = ArrayProgram(Source(parts, method.defines), "double", opencl_device, 1)
        arrays = [np.array([ORIGIN["nil"]]), points, np.zeros((1, 4)), np.zeros((1, 4))]
        lengths.append(program.run("numerics_distance", arrays, 2)[0, 0])
    assert abs(lengths[0] - lengths[1]) > 1e-6
    poor = Rays(scene, dataclasses.replace(exact, agm=1), opencl_device).trace(places)
    assert not np.array_equal(poor.length, want.length, equal_nan=True)


def test_a_picture_tells_its_accuracy(tmp_path: Path, opencl_device: Device) -> None:
    """Requested and estimated, in the statistics and in the file."""
    scene = asking("half-pixel")
    image = tc.render(scene, device=opencl_device, size=(64, 36), samples=1)
    told = image.statistics["accuracy"]
    assert told["requested"] == "half-pixel" and told["met"]
    assert 0 < told["estimated"] <= told["target"]
    image.save(tmp_path / "a.exr")
    settings = json.loads(read_image(tmp_path / "a.exr").metadata["settings"])
    assert settings["accuracy"] == told
    assert settings["threshold"] == image.statistics["method"]["threshold"]
    plain = tc.render(load_text(BALL), device=opencl_device, size=(64, 36), samples=1)
    assert plain.statistics["accuracy"] is None


def test_a_method_leaves_nothing_open(opencl_device: Device) -> None:
    with pytest.raises(ValueError, match="a method has its precision and accuracy"):
        tc.render(load_text(BALL), device=opencl_device, method=Method(), accuracy="draft")


def render(*arguments: str, scene: str = BALL) -> Result:
    Path("scene.yaml").write_text(scene)
    standard = ["render", "scene.yaml", "-o", "a.exr", "--size", "64x36", "--samples", "1", "--force"]
    return CliRunner().invoke(main, [*standard, *arguments], prog_name="thurston")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.usefixtures("here")
def test_exit_code_3_with_the_picture_written() -> None:
    """Single precision does not reach a ten millionth of a radian: it renders, warns, and exits with 3."""
    result = render("--accuracy", "1e-7 rad", "--precision", "single", "--json")
    assert result.exit_code == 3, result.stderr
    assert "thurston: warning: the accuracy may not be reached: 1e-07 rad: single" in result.stderr
    assert Path("a.exr").exists()
    assert json.loads(result.stdout)["accuracy"]["met"] is False
    assert render("--accuracy", "half-pixel").exit_code == 0


@pytest.mark.usefixtures("here")
def test_a_device_without_double_precision(monkeypatch: pytest.MonkeyPatch, opencl_device: Device) -> None:
    """It renders in single precision what asks for more."""
    lesser = dataclasses.replace(opencl_device.info, fp64=False)
    monkeypatch.setattr(type(opencl_device), "info", lesser, raising=False)
    monkeypatch.setattr("thurston_cl.device.choose", lambda name=None: _Without(opencl_device, lesser))
    result = render("--accuracy", "reference")
    assert result.exit_code == 3, result.stderr
    assert "single precision" in result.stderr


class _Without:
    """A device that says it has no double precision."""

    def __init__(self, device: Device, info: Any) -> None:
        self._device, self.info = device, info

    def __getattr__(self, name: str) -> Any:
        return getattr(self._device, name)


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("0.5", "an angle needs a unit: write '0.5 rad'"),
        ("pixel", "expected one of half-pixel, quarter-pixel, draft, reference, or an angle, found 'pixel'"),
        ("0 rad", "an accuracy is an angle greater than 0 and at most 180 deg"),
    ],
)
def test_what_is_no_accuracy(value: str, message: str) -> None:
    result = render("--accuracy", value)
    assert result.exit_code == 2
    assert message in " ".join(result.stderr.split())


@pytest.mark.usefixtures("here")
def test_the_command_line_has_the_last_word() -> None:
    """--accuracy stands in place of what the scene says of accuracy, threshold and precision."""
    scene = BALL + "render: {threshold: 1e-2, precision: double}\n"
    result = render("--accuracy", "half-pixel", "--json", scene=scene)
    assert result.exit_code == 0, result.stderr
    told = json.loads(result.stdout)
    assert told["method"]["threshold"] < 1e-2 and told["precision"] == "single"


@pytest.mark.usefixtures("here")
def test_explain_states_the_choice() -> None:
    Path("scene.yaml").write_text(BALL)
    result = CliRunner().invoke(main, ["explain", "scene.yaml", "--accuracy", "1e-6 rad", "--json"])
    told = json.loads(result.stdout)
    assert told["accuracy"]["requested"] == "1e-06 rad"
    assert told["method"]["precision"] == "double"
    assert "double precision" in told["explanation"]["arithmetic"]
    assert told["explanation"]["accuracy"].startswith("1e-06 rad: double precision, exact flow")


# -- fitted to the picture -----------------------------------------------------------------------------------


def a_choice(**changes: Any) -> Choice:
    return dataclasses.replace(
        Choice("half-pixel", 1e-3, 1e-4, True, 1.0, Method(threshold=1e-4, steps=300)), **changes
    )


def test_a_threshold_is_as_small_as_what_is_near_needs() -> None:
    """MARGIN and MISSED from both sides, and no further than FINEST_SINGLE."""
    choice, most = a_choice(), 1e-3 / MARGIN
    assert fitted(choice, "nil", Glance(most * 0.999, 0)) == choice
    nearer = fitted(choice, "nil", Glance(most * 10, 0)).method
    assert nearer.threshold == pytest.approx(1e-5)
    assert fitted(choice, "nil", Glance(most * 1e6, 0)).method.threshold == FINEST_SINGLE
    double = a_choice(method=Method("double"))
    assert fitted(double, "nil", Glance(most * 1e4, 0)).method.threshold == pytest.approx(1e-8)
    assert fitted(choice, "nil", Glance(0, MISSED * 0.49)) == choice
    assert fitted(choice, "nil", Glance(0, MISSED * 0.51)).method.steps == 1200
    assert fitted(a_choice(method=Method(steps=19_000)), "nil", Glance(0, 1)).method.steps == REFERENCE.steps
    exact = a_choice(requested="reference")
    assert fitted(exact, "nil", Glance(1.0, 0)) == exact


def test_what_a_finished_picture_says_counts() -> None:
    choice = a_choice()
    assert achieved(choice, Glance(5e-5, 0)) == choice
    assert achieved(choice, Glance(9.9e-4, 0)) == a_choice(estimated=9.9e-4)
    assert achieved(choice, Glance(1.1e-3, 0)) == a_choice(estimated=1.1e-3, met=False)
    assert achieved(choice, Glance(0, MISSED)).met and not achieved(choice, Glance(0, MISSED * 1.01)).met


def test_a_glance_leaves_out_what_may_be_anywhere() -> None:
    errors = np.concatenate([np.full(9_980, 2e-4), np.full(20, 3e-3), np.full(500, math.pi)])
    glance = Glance.of(errors, 1e-5, 0.25)
    assert glance.grazing == pytest.approx(3e-3 - 1e-5) and glance.spent == 0.25
    assert Glance.of(errors[10:9_981], 1e-5, 0).grazing == pytest.approx(1.9e-4)
    assert Glance.of(errors[-500:], 1e-5, 0).grazing == 0


def test_what_stands_close_to_the_eye(opencl_device: Device) -> None:
    """A tiny ball right before the eye needs a smaller threshold than the probes, and gets it."""
    scene = load_text(
        "geometry: e3\ncamera: {at: [0, 0, 0], look: {along: [0, 1, 0]}}\n"
        "objects: [{ball: {radius: 0.005}, at: [0, 0.01, 0]}, {ball: {radius: 1}, at: [0, 5, 1]}]\n"
        "render: {accuracy: half-pixel, size: [240, 136], samples: 1}\n"
    )
    image = tc.render(scene, device=opencl_device)
    told, method = image.statistics["accuracy"], Method(**image.statistics["method"])
    assert told["met"] and told["estimated"] <= told["target"]
    plain = choose_method(scene, "half-pixel").method
    assert method.threshold < plain.threshold / 4
    assert verify(scene, 1000, method, opencl_device, target="half-pixel").reached
    assert not verify(scene, 1000, dataclasses.replace(plain, threshold=1e-3), opencl_device).reached


def test_no_detail_is_left_out_where_an_accuracy_is_asked_for(opencl_device: Device) -> None:
    """`detail` would let rays end pixels away from what they graze."""
    scene = load_text(BALL + "render: {detail: 3, size: [160, 90], samples: 1}\n")
    image = tc.render(scene, device=opencl_device, accuracy="half-pixel")
    assert image.statistics["accuracy"]["met"]
    with_detail = Method(**image.statistics["method"])
    assert verify(with_accuracy(scene, "half-pixel"), 500, with_detail, opencl_device).reached
    assert not verify(scene, 500, with_detail, opencl_device).reached
    assert with_accuracy(scene, None) is scene


def test_a_picture_is_held_against_what_was_asked_for(opencl_device: Device) -> None:
    """The same rays are within two pixels, and not within a hundredth of one."""
    scene = load_text(BALL)
    method = Method(threshold=1e-2)
    rough = verify(scene, 500, method, opencl_device, size=(320, 180), target="draft")
    fine = verify(scene, 500, method, opencl_device, size=(320, 180), target=1e-6)
    assert rough.drawn.over.sum() < fine.drawn.over.sum()
    assert rough.reached and not fine.reached
    assert "99.9% within 2 pixels: this is reached" in rough.words[2]
    assert "99.9% within 1e-06 rad: this is NOT reached" in fine.words[2]


@pytest.mark.usefixtures("here")
def test_a_promise_that_verification_breaks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Exit code 3 also where the estimate is fine and the rays are not; and --quiet does not hide it."""
    wrong = dataclasses.replace(Method(threshold=0.05), steps=300)
    monkeypatch.setattr(
        "thurston_cl.scene.choice.choose_method",
        lambda scene, requested, *more: Choice("half-pixel", 4e-4, 1e-5, True, 1.0, wrong),
    )
    monkeypatch.setattr("thurston_cl.rendering.fitted", lambda choice, geometry, glance: choice)
    monkeypatch.setattr("thurston_cl.rendering.achieved", lambda choice, glance: choice)
    result = render("--accuracy", "half-pixel", "--verify", "500", "--quiet", "--size", "320x180")
    assert result.exit_code == 3
    assert "this is NOT reached at random pixels" in result.stderr
    assert "wrote" not in result.stderr


# -- the estimate of each pixel ------------------------------------------------------------------------------


def test_the_error_channel(opencl_device: Device) -> None:
    """What the flow misses, and the threshold as it is seen from the eye: larger on what is near."""
    scene = load_text(BALL)
    near, far = 1e-3, 1e-5
    shown = {
        threshold: tc.render(
            scene,
            device=opencl_device,
            size=(64, 36),
            samples=1,
            channels=("error", "object", "depth"),
            method=Method(threshold=threshold),
        ).channels
        for threshold in (near, far)
    }
    hit = shown[near]["object"] > 0
    assert hit.any() and not hit.all()
    flow = flow_error("nil", Method())
    assert shown[near]["error"][~hit] == pytest.approx(flow)
    for threshold in (near, far):
        error, depth = shown[threshold]["error"][hit], shown[threshold]["depth"][hit].astype(float)
        # In nil the area density is about the square of the depth where that is small.
        assert np.all(np.abs((error - flow) * depth / threshold - 1) < 0.2)
    lost = tc.render(
        scene, device=opencl_device, size=(64, 36), samples=1, channels=("error",), method=Method(steps=1)
    )
    # Out of steps a ray may be anywhere.
    assert (lost.channels["error"] == np.float32(math.pi)).mean() > 0.5
    assert "error" not in tc.render(scene, device=opencl_device, size=(8, 8), samples=1).channels
    assert "error.h" not in make_plan(scene, device=opencl_device).parts


@pytest.mark.usefixtures("here")
def test_a_heat_map_of_the_error() -> None:
    result = render("-o", "a.png", "--shows", "error", "--most", "1e-3")
    assert result.exit_code == 0, result.stderr
    assert read_image("a.exr").channels.keys() >= {"beauty"}
    assert "error" not in read_image("a.exr").channels
    assert render("--channels", "beauty,error").exit_code == 0
    assert read_image("a.exr").channels["error"].max() < 0.1


# -- half a pixel is half a pixel ----------------------------------------------------------------------------


@pytest.mark.parametrize("name", TILES)
def test_half_a_pixel_is_reached(name: str, opencl_device: Device) -> None:
    """The tiles of the library ask for half a pixel, and at least 99.9 % of pixels drawn by chance are within
    it; and those with the largest estimate, of which more are not, are few beside the whole picture.
    """
    scene = load_scene(name)
    assert scene.render.accuracy == "half-pixel"
    plan = make_plan(scene, device=opencl_device)
    assert plan.choice is not None and plan.choice.met
    found = verify(scene, 2000, plan.method, opencl_device)
    assert found.drawn.summary["over_half_pixel"] <= 1e-3, found.words
    width, height = scene.render.size
    assert found.suspected.over.sum() <= 1e-3 * width * height, found.words
