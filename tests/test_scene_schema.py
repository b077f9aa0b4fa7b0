"""The models: values, defaults and the agreement of loader and JSON Schema on scenes that nobody wrote."""

import copy
import json
import math
import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import jsonschema
import pydantic
import pytest

from thurston_cl.errors import SceneError
from thurston_cl.models import FIBRED, GEOMETRIES, HOMOGENEOUS, LEFT_INVARIANT
from thurston_cl.scene import load_scene, load_text, scene_schema
from thurston_cl.scene.base import Node
from thurston_cl.scene.parse import parse
from thurston_cl.scene.reference import models_of_scenes
from thurston_cl.scene.schema import (
    Bands,
    Camera,
    Color,
    HalfSpace,
    Material,
    ModelPoint,
    Object,
    Pattern,
    PseudoBall,
    PseudoCylinder,
    Scene,
    Shape,
    Slab,
    Step,
)

SCENES = Path(__file__).parent / "data" / "scenes"
MINIMAL = "geometry: {geometry}\nobjects: [{{ball: {{radius: 1}}}}]\n"


def scene_of(text: str, geometry: str = "e3") -> Any:
    """A scene of one ball with more text."""
    return load_text(MINIMAL.format(geometry=geometry) + text)


def test_defaults() -> None:
    scene = scene_of("")
    assert scene.thurston == 1
    assert scene.manifold is None
    assert scene.lattice is None
    assert scene.camera == Camera()
    assert math.degrees(scene.camera.fov) == pytest.approx(80, abs=1e-12)
    assert scene.camera.look.along == (1, 0, 0)
    assert scene.camera.look.up == (0, 0, 1)
    assert scene.lights == ()
    assert scene.effects.fog is None
    assert scene.background.linear == (0, 0, 0)
    assert scene.render.size == (960, 540)
    assert scene.render.far is None
    assert scene.objects[0].kind == "ball"
    assert scene.objects[0].shape.radius == 1
    assert scene.objects[0].at == (0, 0, 0)


@pytest.mark.parametrize(
    ("written", "linear"),
    [
        # IEC 61966-2-1, worked out by hand: 0x80 and 0x0a on either side of the bend of the curve.
        ('"#000000"', (0, 0, 0)),
        ('"#fff"', (1, 1, 1)),
        ('"#80800a"', (0.21586050, 0.21586050, 0.0030352698)),
        ('"#0b0a80"', (0.0033465358, 0.0030352698, 0.21586050)),
        ("red", (1, 0, 0)),
        ("purple", (0.21586050, 0, 0.21586050)),
        ("[0.25, 2, 0]", (0.25, 2, 0)),
    ],
)
def test_colors(written: str, linear: tuple[float, float, float]) -> None:
    scene = scene_of(f"background: {written}\n")
    assert isinstance(scene.background, Color)
    assert scene.background.linear == pytest.approx(linear, rel=1e-7)


@pytest.mark.parametrize(
    ("written", "degrees"),
    [("90 deg", 90), ("1.5rad", math.degrees(1.5)), (".125 turn", 45), (" 1e1 deg ", 10)],
)
def test_angles(written: str, degrees: float) -> None:
    scene = scene_of(f"camera: {{fov: '{written}'}}\n")
    assert math.degrees(scene.camera.fov) == pytest.approx(degrees, rel=1e-14)


def test_default_camera_of_a_cell() -> None:
    """Inside the largest ball of the cell; past the middle of it, or up where it has no sides."""
    octagon = scene_of("manifold: genus-two\n", "h2xe")
    assert isinstance(octagon.camera.at, tuple)
    assert octagon.camera.look.to is None
    column = scene_of("manifold: hopf-manifold\n", "s2xe")
    assert isinstance(column.camera.at, tuple)
    assert column.camera.look.to == (0, 0, pytest.approx(0.67 * column.lattice.inradius))
    for scene in (octagon, column):
        assert 0.9 < math.hypot(*scene.camera.at) / scene.lattice.inradius < 1
    assert scene_of("", "nil").camera.look.to == (0, 0, 0)


def test_points() -> None:
    camera = scene_of("camera: {at: [1, 2, 3], look: {to: {model: [1, 0, 0, 1]}}}\n").camera
    assert camera.at == (1.0, 2.0, 3.0)
    assert camera.look.to == ModelPoint(model=(1, 0, 0, 1))


def test_steps_keep_their_order() -> None:
    move = scene_of("camera: {move: [{yaw: -90 deg}, {forward: 2}, {up: 0}]}\n").camera.move
    assert [(step.kind, step.amount) for step in move] == [
        ("yaw", -math.pi / 2),
        ("forward", 2.0),
        ("up", 0.0),
    ]
    assert all(isinstance(step, Step) for step in move)


def test_solids() -> None:
    thing = load_text(
        "geometry: e3\n"
        "objects: [{difference: [{ball: {radius: 1}}, {complement: {half-space: {}}, at: [1, 0, 0]}]}]\n"
    ).objects[0]
    assert isinstance(thing, Object)
    assert thing.kind == "difference"
    assert [member.kind for member in thing.shape] == ["ball", "complement"]
    assert thing.shape[1].shape.kind == "half-space"
    assert thing.shape[1].at == (1, 0, 0)


def test_one_rotation_or_many() -> None:
    def turned(text: str) -> Any:
        return (
            load_text(f"geometry: e3\nobjects: [{{ball: {{radius: 1}}, rotate: {text}}}]\n").objects[0].rotate
        )

    one = "{axis: [0, 0, 1], angle: 90 deg}"
    assert turned(one) == turned(f"[{one}]")
    assert len(turned(f"[{one}, {one}]")) == 2


def test_weights_of_a_material_add_up() -> None:
    assert Material().diffuse == pytest.approx(0.7)
    assert Material(ambient=0, specular=0).diffuse == 1
    assert Material(ambient=0.3, specular=0.7).diffuse == pytest.approx(0, abs=1e-15)
    with pytest.raises(pydantic.ValidationError, match="more than 1"):
        Material(ambient=0.5, specular=0.6)


def test_materials_and_textures_are_put_in() -> None:
    scene = load_text(
        "geometry: e3\n"
        "textures: {t: {grid: {count: 3}}}\n"
        "materials: {m: {color: $textures.t}}\n"
        "objects: [{ball: {radius: 1}, material: m}, {ball: {radius: 1}, material: {color: $textures.t}}]\n"
    )
    paint = scene.objects[0].material.color
    assert isinstance(paint, Pattern)
    assert paint.grid is not None
    assert paint.grid.count == (3, 3)
    assert scene.objects[0].material == scene.objects[1].material == scene.materials["m"]


def test_light_counts_follow_geometry_and_manifold() -> None:
    light = "lights: [point: {at: [0.1, 0, 0]}]\n"
    assert scene_of(light).lights[0].point.geodesics == 1
    assert scene_of(light).lights[0].point.translates == 1
    sphere = scene_of(f"manifold: quaternion\n{light}", "s3").lights[0].point
    assert (sphere.geodesics, sphere.translates) == (2, "neighbours")
    one = scene_of("manifold: quaternion\nlights: [point: {at: [0.1, 0, 0], translates: cell}]\n", "s3")
    assert one.lights[0].point.translates == 1


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_geodesics_of_a_light(geometry: str) -> None:
    light = "lights: [point: {at: [0.1, 0, 0]}]\n"
    assert scene_of(light, geometry).lights[0].point.geodesics == (2 if geometry in ("s3", "s2xe") else 1)
    more = "lights: [point: {at: [0.1, 0, 0], geodesics: 9}]\n"
    if geometry in ("e3", "h3", "h2xe"):
        with pytest.raises(SceneError, match="only one geodesic joins two points, not 9"):
            scene_of(more, geometry)
    else:
        assert scene_of(more, geometry).lights[0].point.geodesics == 9


def test_falloff() -> None:
    def written(text: str) -> Any:
        return scene_of(f"lights: [point: {{at: [0.1, 0, 0]{text}}}]\n", "nil").lights[0].point.falloff

    assert written("") == "area"
    assert [written(f", falloff: {name}") for name in ("area", "inverse", "constant")] == [
        "area",
        "inverse",
        "constant",
    ]


def test_bands() -> None:
    paint = scene_of("textures: {t: {bands: {count: 3, colors: [white, red]}}}\n").textures["t"].bands
    assert isinstance(paint, Bands)
    assert (paint.count, paint.width) == (3, 0.1)
    assert [color.written for color in paint.colors] == ["white", "red"]
    assert isinstance(paint.ground, Color)


# Points of each model, and a coordinate that takes them off it.
MODEL_POINTS = {
    "e3": ([1, 2, 3, 1], 3),
    "s3": ([0, 0, 0.6, 0.8], 3),
    "h3": ([0.75, 0, 0, 1.25], 3),
    "s2xe": ([0.6, 0, 0.8, 7], 2),
    "h2xe": ([0, 0.75, 1.25, -7], 2),
    "nil": ([1, 2, 3, 1], 3),
    "sl2": ([0, 0.75, 1.25, -7], 2),
    "sol": ([1, 2, 3, 1], 3),
}


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_model_points(geometry: str) -> None:
    point, index = MODEL_POINTS[geometry]

    def moved(step: float) -> Any:
        coordinates = [value + (step if k == index else 0) for k, value in enumerate(point)]
        return scene_of(f"camera: {{at: {{model: {coordinates}}}}}\n", geometry).camera.at

    assert moved(0).model == tuple(point)
    # What six decimals leave, and what they do not.
    moved(4e-6)
    for step in (2e-5, -2e-5):
        with pytest.raises(SceneError, match="not a point of the geometry"):
            moved(step)


def of_geometry(geometry: str, text: str) -> Any:
    """The first object of a scene."""
    return load_text(f"geometry: {geometry}\nobjects: [{text}]\n").objects[0]


@pytest.mark.parametrize(
    ("geometry", "text", "bound"),
    [
        ("s3", "ball: {{radius: {0}}}", math.pi),
        ("s3", "cylinder: {{radius: {0}}}", math.pi / 2),
        ("s3", "half-space: {{offset: {0}}}", math.pi / 2),
        ("s3", "half-space: {{normal: [1, 0, 1], offset: -{0}}}", math.pi / 2),
        ("s3", "slab: {{thickness: {0}}}", math.pi),
        ("s2xe", "ball: {{radius: {0}}}", math.pi),
        ("s2xe", "cylinder: {{radius: {0}}}", math.pi),
        ("s2xe", "cylinder: {{radius: {0}, along: [0, 2, 0]}}", math.pi / 2),
        ("s2xe", "half-space: {{normal: [1, 1, 0], offset: -{0}}}", math.pi / 2),
        ("s2xe", "half-space: {{offset: {0}}}", math.inf),
        ("s2xe", "slab: {{normal: [0, 1, 0], thickness: {0}}}", math.pi),
        ("s2xe", "slab: {{thickness: {0}}}", math.inf),
        ("h2xe", "cylinder: {{radius: {0}, along: [0, 2, 0]}}", math.inf),
        ("nil", "slab: {{normal: [0, 1, 0], thickness: {0}}}", math.inf),
        ("sl2", "half-space: {{normal: [1, 1, 0], offset: -{0}}}", math.inf),
    ],
)
def test_sizes(geometry: str, text: str, bound: float) -> None:
    if bound == math.inf:
        of_geometry(geometry, text.format(100))
        return
    of_geometry(geometry, text.format(math.nextafter(bound, 0)))
    with pytest.raises(SceneError, match="is less than π"):
        of_geometry(geometry, text.format(bound))


@pytest.mark.parametrize("geometry", FIBRED)
def test_directions_keep_fibers(geometry: str) -> None:
    for normal in ([0, 0, 1], [0, 0, -2], [1, 0, 0], [-3, 4, 0]):
        half_space = of_geometry(geometry, f"half-space: {{normal: {normal}}}").shape
        assert isinstance(half_space, HalfSpace)
        assert half_space.normal == tuple(normal)
        assert isinstance(of_geometry(geometry, f"slab: {{normal: {normal}, thickness: 1}}").shape, Slab)
    for text in ("half-space: {normal: [1e-9, 0, 1]}", "slab: {normal: [1, 0, 1e-9], thickness: 1}"):
        with pytest.raises(SceneError, match="along the fiber"):
            of_geometry(geometry, text)
    of_geometry(geometry, "cylinder: {radius: 1, along: [0, 0, -1]}")
    horizontal = "cylinder: {radius: 1, along: [1, 1, 0]}"
    if geometry in ("nil", "sl2"):
        assert of_geometry(geometry, "half-space: {}").shape.crossing == "directed"
        assert of_geometry(geometry, "half-space: {crossing: bisection}").shape.crossing == "bisection"
        with pytest.raises(SceneError, match="stands along the fiber"):
            of_geometry(geometry, horizontal)
    else:
        of_geometry(geometry, horizontal)


@pytest.mark.parametrize("geometry", FIBRED)
def test_turns_keep_fibers(geometry: str) -> None:
    def turned(axis: str, angle: str) -> None:
        of_geometry(geometry, f"{{ball: {{radius: 1}}, rotate: {{axis: {axis}, angle: {angle}}}}}")

    turned("[0, 0, -1]", "17 deg")
    # Rounding is forgiven, and no more.
    for angle in ("180 deg", "-180 deg", "540 deg", "0.5 turn", "0 deg", "3.14159265358979 rad"):
        turned("[1, -1, 0]", angle)
    for angle in ("90 deg", "180.00000001 deg", "3.1416 rad"):
        with pytest.raises(SceneError, match="by 180 deg only"):
            turned("[1, -1, 0]", angle)
    of_geometry("h3", "{ball: {radius: 1}, rotate: {axis: [1, 1, 1], angle: 17 deg}}")


def test_directions_in_sol() -> None:
    """Planes and cylinders at the axes of the coordinates, pseudo-cylinders and turns at more."""
    for axis in ([1, 0, 0], [0, -2, 0], [0, 0, 0.5]):
        assert of_geometry("sol", f"half-space: {{normal: {axis}}}").shape.normal == tuple(axis)
        of_geometry("sol", f"slab: {{normal: {axis}, thickness: 1}}")
        if axis[2] == 0:
            of_geometry("sol", f"cylinder: {{radius: 1, along: {axis}}}")
    for along in ([0, 0, -1], [1, 2, 0], [0, 1, 0]):
        pseudo = of_geometry("sol", f"pseudo-cylinder: {{radius: 1, along: {along}}}")
        assert isinstance(pseudo.shape, PseudoCylinder)
        assert pseudo.kind == "pseudo-cylinder"
    assert isinstance(of_geometry("sol", "pseudo-ball: {radius: 1}").shape, PseudoBall)

    def turned(axis: str, angle: str) -> None:
        of_geometry("sol", f"{{ball: {{radius: 1}}, rotate: {{axis: {axis}, angle: {angle}}}}}")

    for axis in ("[0, 0, -1]", "[1, 1, 0]", "[-2, 2, 0]"):
        for angle in ("180 deg", "-180 deg", "0 deg", "0.5 turn"):
            turned(axis, angle)
        with pytest.raises(SceneError, match="by 180 deg only"):
            turned(axis, "180.00000001 deg")
    for axis in ("[0, 1, 0]", "[1, 1, 1]", "[1, 1.001, 0]"):
        with pytest.raises(SceneError, match="the axis of a rotation is"):
            turned(axis, "180 deg")


def test_lights_along_straight_lines() -> None:
    for geometry in LEFT_INVARIANT:
        light = "lights: [point: {at: [0.1, 0, 0], direction: straight"
        point = scene_of(light + "}]\n", geometry).lights[0].point
        assert (point.direction, point.falloff, point.geodesics) == ("straight", "constant", 1)
        faded = scene_of(light + ", falloff: inverse}]\n", geometry).lights[0].point
        assert faded.falloff == "inverse"
    assert scene_of("lights: [point: {at: [0.1, 0, 0]}]\n", "sol").lights[0].point.direction == "geodesic"


def test_suns() -> None:
    def sun(geometry: str, text: str = "", more: str = "") -> Any:
        return scene_of(f"{more}lights: [{{sun: {{{text}}}, shadows: hard}}]\n", geometry).lights[0].sun

    assert sun("e3", "from: [1, 2, 3]").towards == (1, 2, 3)
    assert sun("sol").towards == (0, 0, 1)
    for geometry in (*FIBRED, "sol"):
        assert sun(geometry, "from: [0, 0, -2], intensity: 3").intensity == 3
    # Manifolds that keep the direction.
    sun("e3", "from: [1, 0, 0]", "manifold: three-torus\n")
    sun("e3", "", "manifold: quarter-turn\n")
    for geometry, manifold in (("nil", "heisenberg"), ("sl2", "genus-two"), ("h2xe", "orbi-torus")):
        sun(geometry, "", f"manifold: {manifold}\n")
    with pytest.raises(SceneError, match="turns the direction"):
        sun("e3", "", "manifold: hantzsche-wendt\n")


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_size_of_isometries(geometry: str) -> None:
    """Only the right number of rows gets as far as being asked whether it is an isometry."""

    def given(n: int) -> str:
        matrix = [[2.0 * (i == j) for j in range(n)] for i in range(n)]
        try:
            scene_of(f"manifold: {{generators: [{matrix}], domain: [{[1.0] * n}]}}\n", geometry)
        except SceneError as error:
            return str(error)
        raise AssertionError

    n = HOMOGENEOUS[geometry]
    other = 9 - n
    assert f"expected a matrix of {n} rows with {n} numbers each, found {other} rows" in given(other)
    assert f"expected {n} numbers" in given(other)
    assert "expected" not in given(n)


def test_loading_needs_no_device() -> None:
    code = (
        "import sys\n"
        "from thurston_cl.scene import load_text\n"
        f"for geometry in {GEOMETRIES}:\n"
        "    load_text(f'geometry: {geometry}\\nobjects: [ball: {{radius: 1}}]')\n"
        "print('pyopencl' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout == "False\n", done.stderr


def test_lattices() -> None:
    assert scene_of("manifold: Seifert_Weber\n", "h3").lattice.name == "seifert-weber"
    assert len(load_scene(SCENES / "good-matrices.yaml").lattice.walls) == 2


def test_scenes_are_frozen() -> None:
    scene = scene_of("")
    with pytest.raises(pydantic.ValidationError, match="frozen"):
        scene.title = "other"


def test_errors_after_loading_point_at_the_text() -> None:
    scene = load_scene(SCENES / "good-spherical.yaml")
    error = scene.error_at(("objects", 1, "cylinder", "radius"), "the camera is inside", "move it")
    assert isinstance(error, SceneError)
    assert ":7:24: error: the camera is inside\n    7 |   - cylinder: {radius: 1.57}\n" in str(error)
    assert "= help: move it" in str(error)
    problems = scene.problems()
    problems.raise_if_any()
    problems.add(("objects", 2), "one")
    problems.add(("camera", "at"), "two", key=True)
    problems.add(("render", "far"), "nowhere, so at the top")
    with pytest.raises(SceneError) as caught:
        problems.raise_if_any()
    found = [(d.line, d.column, d.message) for d in caught.value.diagnostics]  # type: ignore[attr-defined]
    assert found == [(2, 1, "nowhere, so at the top"), (3, 10, "two"), (8, 5, "one")]


def test_errors_of_a_scene_made_in_python() -> None:
    scene = type(scene_of("")).model_validate({"geometry": "e3", "objects": [{"ball": {"radius": 1}}]})
    assert str(scene.error_at(("objects",), "no")) == "scene: error: no\n1 error in scene"


def test_what_the_loader_takes_the_schema_takes() -> None:
    """Good scenes with a value exchanged for another: what loads is valid, and most of the rest is not."""
    validator = jsonschema.Draft7Validator(scene_schema())
    source = random.Random(2)
    values = [
        0,
        1,
        2.5,
        -1,
        True,
        "red",
        "90 deg",
        "$r",
        "$textures.tiles",
        "tiled",
        [],
        [1, 0, 0],
        {},
        "cell",
        "x.exr",
    ]
    both_refuse = only_loader_refuses = taken = 0
    for name in ("good-hyperbolic", "good-spherical", "good-matrices"):
        original = parse((SCENES / f"{name}.yaml").read_text()).data
        for _ in range(60):
            data = copy.deepcopy(original)
            container, key = source.choice(list(_slots(data)))
            container[key] = source.choice(values)
            try:
                load_text(json.dumps(data))
            except SceneError:
                if validator.is_valid(data):
                    only_loader_refuses += 1
                else:
                    both_refuse += 1
            else:
                taken += 1
                assert validator.is_valid(data), (key, container[key])
    assert taken > 10
    assert both_refuse > 5 * only_loader_refuses


def _slots(value: Any) -> Any:
    """Every (container, key) inside nested dicts and lists."""
    for key in value if isinstance(value, dict) else range(len(value)):
        yield value, key
        if isinstance(value[key], (dict, list)):
            yield from _slots(value[key])


@pytest.mark.parametrize("model", models_of_scenes(), ids=lambda model: model.__name__)
def test_examples_in_messages_are_right(model: type[Node]) -> None:
    """What a message tells people to type must load."""
    if not model.example or "..." in model.example:
        return
    data = parse(model.example).data
    if isinstance(data, list):
        data = data[0]
    if not set(data) <= set(model.keys()) or (len(data) == 1 and issubclass(model, Shape)):
        (data,) = data.values()
    if model is Scene:
        data["objects"] = [{"ball": {"radius": 1}}]
    model.model_validate(data)
