"""-D and --set: what they change, what they refuse, and the text of the scene that results."""

from pathlib import Path
from typing import Any

import pytest

from thurston_cl.scene import SceneReport, load_scene, load_text

TEXT = """\
# A scene with params.
geometry: h3   # hyperbolic
params: {r: 0.3, tint: "#aabbcc", view: 60 deg}
camera: {fov: $view}
objects:
  - ball: {radius: $r}   # the ball
    material: {color: $tint}
  - half-space: {normal: [0, 0, 1], offset: -1}
"""


def load(defines: dict[str, str] | None = None, sets: list[str] | None = None) -> Any:
    """The scene above with options."""
    return load_text(TEXT, "scene.yaml", defines, sets or [])


def report(defines: dict[str, str] | None = None, sets: list[str] | None = None) -> str:
    """The text of the error."""
    with pytest.raises(SceneReport) as caught:
        load(defines, sets)
    return str(caught.value)


def test_defines() -> None:
    scene = load({"r": "0.5", "tint": "#fff", "view": "0.25 turn"})
    assert scene.objects[0].shape.radius == 0.5
    assert scene.objects[0].material.color.linear == (1, 1, 1)
    assert scene.camera.fov == pytest.approx(1.5707963267948966)
    assert scene.params == {"r": 0.5, "tint": "#fff", "view": "0.25 turn"}


def test_defines_from_python_may_be_numbers() -> None:
    scene = load_text(TEXT, "scene.yaml", {"r": 0.5})
    assert scene.objects[0].shape.radius == 0.5
    assert load_text(scene.effective_text()) == scene


def test_define_in_quotes() -> None:
    assert load({"tint": "'red'"}).objects[0].material.color.linear == (1, 0, 0)


@pytest.mark.parametrize(
    ("name", "value", "message", "help"),
    [
        ("vew", "3", "the scene has no param 'vew'", "did you mean 'view'?"),
        ("q", "3", "the scene has no param 'q'", "it has: r, tint, view"),
        ("r", "", "the value is empty", None),
        ("r", "[1]", "a param is one number or one text, not a list or a mapping", None),
        ("r", "true", "a param is a number or text, and not true or false", None),
        ("r", ".inf", "numbers are finite; '.inf' is not", None),
        ("r", "2026-01-01", "'2026-01-01' reads as a date; put quotes around it to make it text", None),
    ],
)
def test_wrong_defines(name: str, value: str, message: str, help: str | None) -> None:
    expected = f"-D {name}={value}: error: {message}\n"
    if help:
        expected += f"      = help: {help}\n"
    assert report({name: value}) == f"{expected}1 error in scene.yaml"


def test_wrong_value_of_a_define_is_shown_where_it_is_used() -> None:
    assert report({"r": "-1"}) == (
        "scene.yaml:6:20: error: radius must be greater than 0; this is -1 (here $r is -1, from -D r)\n"
        "    6 |   - ball: {radius: $r}   # the ball\n"
        "      |                    ^\n"
        "1 error in scene.yaml"
    )


def test_sets() -> None:
    scene = load(
        sets=[
            "render.samples=16",
            "objects.1.half-space.offset=-2e-3",
            "objects.2={ball: {radius: 1}, at: [1, 2, 3]}",
            "lights.0.point.at=[0, 0, 1]",
            "background=#fff",
            "title='2026-01-01'",
            "objects.0.ball.radius=$r",
            "camera.look.to.model=[0, 0, 0, 1]",
        ]
    )
    assert scene.render.samples == 16
    assert scene.objects[1].shape.offset == -2e-3
    assert scene.objects[2].at == (1, 2, 3)
    assert scene.lights[0].point.at == (0, 0, 1)
    assert scene.background.linear == (1, 1, 1)
    assert scene.title == "2026-01-01"
    assert scene.objects[0].shape.radius == 0.3
    assert scene.camera.look.to.model == (0, 0, 0, 1)


def test_later_sets_win() -> None:
    assert load(sets=["render.samples=16", "render={samples: 2}"]).render.samples == 2


def test_param_whose_only_use_is_set_away() -> None:
    assert load(sets=["objects.0.ball.radius=1"]).objects[0].shape.radius == 1


@pytest.mark.parametrize(
    ("option", "message", "help"),
    [
        ("render.sampels=4", "unknown key 'sampels'", "did you mean 'samples'?"),
        ("render.samples=4.5", "expected a whole number, found 4.5", None),
        ("camera={fov: 200 deg}", "a perspective view is between 0 and 180 deg", "wider views need"),
        ("objects.0.ball.radius=x", "expected a number, found 'x'", None),
        ("objects.1.half-space.offset=$q", "unknown name '$q'", "params has: r, tint, view"),
        ("objects.3.at=[0, 0, 0]", "'objects' has 2 entries, counted from 0: there is no entry 3", None),
        ("objects.first.at=[0, 0, 0]", "'objects' is a list: 'first' must be a number, from 0", None),
        ("geometry.x=3", "'geometry' is a single value and has no 'x'", None),
        ("render.samples", "expected key=value", "for example --set render.samples=16"),
        ("render..samples=3", "expected key=value", "for example --set render.samples=16"),
        ("render.samples=", "the value is empty", "to leave the key out write render.samples=null"),
        ("camera.at=null", "there is no key 'camera.at' to leave out", None),
        ("camera.look.to=null", "there is no key 'camera.look' to leave out", None),
        (
            "objects.0=null",
            "'objects.0' is an entry of a list, and only keys can be left out: set 'objects' anew",
            None,
        ),
        ("objects.7.at=~", "'objects' has 2 entries, counted from 0: there is no entry 7", None),
        ("objects.9=~", "'objects' has 2 entries, counted from 0: there is no entry 9", None),
        ("geometry.x=null", "there is no key 'geometry.x' to leave out", None),
        ("a." * 5000 + "b=1", "nested more than 40 deep", None),
        ("title=*x", "aliases (*x) are not allowed in a scene", "give the value a name"),
        ("title=[", "not valid YAML: the bracket that opens here is not closed", None),
        ("lights=[{point: {at: [0, 0]}}]", "expected 3 numbers [x, y, z], found 2", None),
    ],
)
def test_wrong_sets(option: str, message: str, help: str | None) -> None:
    lines = report(sets=[option]).split("\n")
    assert lines[0] == f"--set {option}: error: {message}"
    assert lines[-1] == "1 error in scene.yaml"
    assert len(lines) == (3 if help else 2)
    if help:
        assert lines[1].startswith(f"      = help: {help}")


def test_all_kinds_of_mistakes_at_once() -> None:
    """The file first, in the order of its lines, then the options."""
    text = report({"r": "0", "x": "1"}, ["render.sampels=4", "objects.1.half-space.normal=[0, 0, 0]"])
    assert [line.split(": error")[0] for line in text.split("\n") if ": error" in line] == [
        "scene.yaml:6:20",
        "-D x=1",
        "--set objects.1.half-space.normal=[0, 0, 0]",
        "--set render.sampels=4",
    ]


def test_text_without_options_is_the_text() -> None:
    assert load().effective_text() == TEXT


def test_text_with_options() -> None:
    defines, sets = {"r": "0.5", "tint": "#fff"}, ["render.samples=16", "objects.1.half-space.offset=1e-6"]
    scene = load(defines, sets)
    text = scene.effective_text()
    assert (
        text
        == TEXT.replace("r: 0.3", "r: 0.5")
        .replace('"#aabbcc"', '"#fff"')
        .replace("offset: -1", "offset: 1e-06")
        + "render:\n  samples: 16\n"
    )
    again = load_text(text)
    assert again == scene
    assert again != load()


def test_null_leaves_a_key_out() -> None:
    sets = ["camera.fov=null", "objects.0.material=~", "camera.projection={fisheye: {}}"]
    scene = load(sets=sets)
    assert scene.camera.projection.kind == "fisheye"
    plain = TEXT.replace("camera: {fov: $view}", "camera: {projection: {fisheye: {}}}")
    assert (
        scene.objects
        == load_text(plain.replace("    material: {color: $tint}\n", ""), sets=["params={r: 0.3}"]).objects
    )
    again = load_text(scene.effective_text(), sets=["params={r: 0.3}"])
    assert (again.camera, again.objects) == (scene.camera, scene.objects)


def test_text_of_the_largest_scene_with_options() -> None:
    path = Path(__file__).parent / "data" / "scenes" / "good-hyperbolic.yaml"
    scene = load_scene(
        path, {"r": "0.2", "how": "single"}, ["objects.2.material=plain", "outputs=[file: x.png]"]
    )
    again = load_text(scene.effective_text())
    assert again == scene
    assert again.render.precision == "single"
