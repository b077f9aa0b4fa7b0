"""The scene library, the commands on scenes, and the reference page."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from thurston_cl import lattice
from thurston_cl.cli.main import main
from thurston_cl.errors import MissingFileError
from thurston_cl.models import GEOMETRIES
from thurston_cl.scene import library, load_scene, reference, scene_schema

ROOT = Path(__file__).parent.parent
SCENES = ROOT / "tests" / "data" / "scenes"


@pytest.fixture
def shelf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A library of two scenes, away from the current folder."""
    folder = tmp_path / "shelf"
    (folder / "h3").mkdir(parents=True)
    (folder / "h3" / "weber.yaml").write_text(
        "# yaml-language-server: $schema=x.json\n#\n# Figure 32a.\n# More.\n"
        "title: Weber\ngeometry: h3\nobjects: [{ball: {radius: 1}}]\n"
    )
    (folder / "plain.yaml").write_text("geometry: e3\nobjects: [{ball: {radius: 1}}]\n")
    monkeypatch.setattr(library, "library_folder", lambda: folder)
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    return folder


def thurston(*arguments: str, stdin: str | None = None) -> Result:
    return CliRunner().invoke(main, list(arguments), input=stdin)


# The library


def test_every_scene_of_the_library_loads_and_says_what_it_is() -> None:
    for scene in library.library_scenes():
        assert load_scene(scene.path).geometry == scene.geometry, scene.name
        assert scene.title or scene.name == "h3/seifert-weber", scene.name  # which has six lines, no more
        assert scene.comment, scene.name


def test_list(shelf: Path) -> None:
    assert [scene.name for scene in library.library_scenes()] == ["h3/weber", "plain"]
    weber = library.library_scene("h3/weber")
    assert (weber.title, weber.geometry, weber.comment) == ("Weber", "h3", "Figure 32a.")
    assert library.library_scene("plain.yaml").comment == ""


def test_name_stands_for_a_file(shelf: Path) -> None:
    assert library.resolve("h3/weber") == shelf / "h3" / "weber.yaml"
    assert library.resolve("h3/weber.yaml") == shelf / "h3" / "weber.yaml"
    assert load_scene("h3/weber").title == "Weber"


def test_file_goes_before_the_library(shelf: Path) -> None:
    Path("plain.yaml").write_text("title: mine\ngeometry: s3\nobjects: [{ball: {radius: 1}}]\n")
    assert load_scene("plain.yaml").title == "mine"
    assert load_scene("plain").title == ""


@pytest.mark.parametrize(
    ("name", "guess"),
    [
        ("h3/webber", "did you mean 'h3/weber'?"),
        ("weber", "did you mean 'h3/weber'?"),
        ("mine.yml", "did you mean 'mine.yaml'?"),
        ("q", "'thurston scenes' lists the scenes"),
    ],
)
def test_unknown_names(shelf: Path, name: str, guess: str) -> None:
    Path("mine.yaml").write_text("")
    with pytest.raises(MissingFileError) as caught:
        library.resolve(name)
    assert f"there is no scene file {name}; " in str(caught.value)
    assert guess in str(caught.value)


def test_names_do_not_leave_the_library(shelf: Path) -> None:
    (shelf.parent / "secret.yaml").write_text("geometry: e3\n")
    with pytest.raises(MissingFileError):
        library.resolve("h3/../../secret")


# thurston scenes


def test_scenes_command(shelf: Path) -> None:
    result = thurston("scenes")
    assert result.exit_code == 0
    assert result.stdout == "h3/weber  h3  Weber\n    Figure 32a.\nplain     e3\n"
    assert [scene["name"] for scene in json.loads(thurston("scenes", "--json").stdout)["scenes"]] == [
        "h3/weber",
        "plain",
    ]
    assert thurston("scenes", "h3/weber").stdout == f"{shelf / 'h3' / 'weber.yaml'}\n"
    assert thurston("scenes", "plain", "--show").stdout == (shelf / "plain.yaml").read_text()
    assert json.loads(thurston("scenes", "plain", "--show", "--json").stdout)["text"].startswith("geometry")


def test_scenes_command_errors(shelf: Path) -> None:
    missing = thurston("scenes", "h3/wber")
    assert missing.exit_code == 66
    assert missing.stdout == ""
    assert missing.stderr == "thurston: error: the library has no scene 'h3/wber'; did you mean 'h3/weber'?\n"
    assert thurston("scenes", "--show").exit_code == 2
    # The name of a geometry stands for its scenes.
    assert thurston("scenes", "h3").stdout.startswith("h3/weber  h3  ")
    of_h3 = json.loads(thurston("scenes", "h3", "--json").stdout)["scenes"]
    assert [scene["name"] for scene in of_h3] == ["h3/weber"]
    assert thurston("scenes", "h3", "--show").exit_code == 2


# thurston validate


def test_validate_good_scenes() -> None:
    good, other = str(SCENES / "good-minimal.yaml"), str(SCENES / "good-matrices.yaml")
    result = thurston("validate", good, other)
    assert result.exit_code == 0
    assert result.stdout == (
        f"{good}: ok: h3, seifert-weber; 1 object, default lights\n"
        f"{other}: ok: e3, a lattice given by matrices; 1 object, default lights\n"
    )
    assert result.stderr == ""


def test_validate_goes_on_after_mistakes(shelf: Path) -> None:
    broken = str(SCENES / "broken-five.yaml")
    result = thurston("validate", "nowhere.yaml", broken, "h3/weber")
    assert result.exit_code == 65
    assert result.stdout == "h3/weber: ok: h3; 1 object, default lights\n"
    assert result.stderr.startswith("thurston: error: there is no scene file nowhere.yaml; ")
    assert result.stderr.endswith(f"5 errors in {broken}\n")
    assert thurston("validate", "nowhere.yaml", "plain").exit_code == 66


def test_validate_json(shelf: Path) -> None:
    result = thurston("validate", "--json", str(SCENES / "broken-five.yaml"), "plain", "nowhere")
    assert result.exit_code == 65
    broken, good, missing = json.loads(result.stdout)["scenes"]
    assert broken["ok"] is False
    assert broken["errors"][1] == {
        "line": 4,
        "column": 3,
        "message": "unknown key 'postion'",
        "help": "did you mean 'at'?",
        "origin": None,
    }
    assert good == {"scene": "plain", "ok": True, "summary": "e3; 1 object, default lights", "errors": []}
    assert "there is no scene file nowhere" in missing["errors"][0]["message"]
    assert result.stderr == ""


def test_validate_counts_lights_that_the_scene_names(shelf: Path) -> None:
    result = thurston("validate", "plain", "--set", "lights=[sun: {}]")
    assert result.stdout == "plain: ok: e3; 1 object, 1 light\n"


def test_validate_with_options(shelf: Path) -> None:
    assert thurston("validate", "plain", "--set", "objects.0.ball.radius=2").exit_code == 0
    wrong = thurston("validate", "plain", "--set", "objects.0.ball.radius=-2", "-D", "x=1")
    assert wrong.exit_code == 65
    assert (
        "--set objects.0.ball.radius=-2: error: radius must be greater than 0; this is -2\n" in wrong.stderr
    )
    assert (
        "-D x=1: error: the scene has no param 'x'\n      = help: it has no params at all\n" in wrong.stderr
    )
    usage = thurston("validate", "plain", "-D", "x")
    assert usage.exit_code == 2
    assert "'x' is not of the form NAME=VALUE" in usage.stderr
    assert thurston("validate").exit_code == 2


def test_validate_reads_standard_input() -> None:
    result = thurston("validate", "-", stdin="geometry: e3\nobjects: [{ball: {radius: 0}}]\n")
    assert result.exit_code == 65
    assert result.stderr.startswith("<stdin>:2:27: error: radius must be greater than 0; this is 0\n")


# thurston schema


def test_schema_command() -> None:
    result = thurston("schema")
    assert result.exit_code == 0
    assert json.loads(result.stdout) == scene_schema()


# docs/scene.md


def test_reference_page_is_up_to_date() -> None:
    page = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
    assert reference.BEGIN in page
    assert page == reference.renewed(page), "run: python -m thurston_cl.scene.reference docs/scene.md"


def test_every_manifold_stands_in_the_reference_page() -> None:
    """With its geometry, what it is, and the distance of the nearest wall."""
    page = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
    rows = [[cell.strip() for cell in line.split("|")[1:5]] for line in page.split("\n") if line[:3] == "| `"]
    known = [
        [f"`{name}`", geometry, found.description, f"{found.inradius:.3f}"]
        for geometry in GEOMETRIES
        for name in lattice.names(geometry)
        for found in [lattice.named(geometry, name)]
    ]
    assert [row for row in known if row not in rows] == []
    assert [row[:2] for row in rows if row[1] in GEOMETRIES and row[:2] not in [r[:2] for r in known]] == []


def test_links_of_the_reference_page_lead_somewhere() -> None:
    page = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
    headings = {
        line.lstrip("# ").lower().replace(" ", "-") for line in page.split("\n") if line.startswith("#")
    }
    targets = {part.split(")")[0] for part in page.split("](#")[1:]}
    assert len(targets) > 20
    assert targets <= headings
