"""Scenes in files: the good ones load, the broken ones give the report that stands beside them."""

from pathlib import Path
from typing import Any

import jsonschema
import pytest

from thurston_cl.errors import MissingFileError, SceneError
from thurston_cl.scene import load_scene, load_text, scene_schema
from thurston_cl.scene.base import Node
from thurston_cl.scene.parse import parse
from thurston_cl.scene.reference import models_of_scenes

SCENES = Path(__file__).parent / "data" / "scenes"
GOOD = sorted(SCENES.glob("good-*.yaml"))
BROKEN = sorted(SCENES.glob("broken-*.yaml"))


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft7Validator:
    schema = scene_schema()
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


def test_there_are_scenes() -> None:
    assert len(GOOD) >= 4
    assert len(BROKEN) >= 4


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_good_scene(path: Path, validator: jsonschema.Draft7Validator) -> None:
    scene = load_scene(path)
    assert scene.source.path == path
    assert scene.effective_text() == path.read_text()
    assert list(validator.iter_errors(parse(path.read_text()).data)) == []


@pytest.mark.parametrize("path", BROKEN, ids=lambda path: path.stem)
def test_broken_scene(path: Path) -> None:
    with pytest.raises(SceneError) as caught:
        load_text(path.read_text(), path.name)
    assert f"{caught.value}\n" == path.with_suffix(".txt").read_text()
    assert caught.value.exit_code == 65


def test_five_mistakes_are_all_in_the_schema_too(validator: jsonschema.Draft7Validator) -> None:
    data = parse((SCENES / "broken-five.yaml").read_text()).data
    places = {tuple(error.absolute_path)[:2] for error in validator.iter_errors(data)}
    # An unknown key is an error of the mapping around it.
    assert places == {("geometry",), ("camera",), ("camera", "fov"), ("objects", 0), ("objects", 1)}


def test_every_key_stands_in_a_good_scene() -> None:
    """A key that no test scene uses could be broken without anybody noticing."""
    seen: set[tuple[str, str]] = set()

    def visit(value: Any) -> None:
        if isinstance(value, Node):
            seen.update(_owner(type(value), name) for name in value.model_fields_set)
            visit([getattr(value, name) for name in type(value).model_fields])
        elif isinstance(value, (tuple, list, dict)):
            for item in value.values() if isinstance(value, dict) else value:
                visit(item)

    for path in GOOD:
        visit(load_scene(path))
    keys = {_owner(model, name) for model in models_of_scenes() for name in model.model_fields}
    assert len(keys) > 80
    assert keys - seen == set()


def _owner(model: type[Node], name: str) -> tuple[str, str]:
    """The key, with the model that defines it: an object's ball is that of a solid."""
    first = next(base for base in reversed(model.__mro__) if name in getattr(base, "model_fields", {}))
    return first.__name__, name


def test_missing_file(tmp_path: Path) -> None:
    (tmp_path / "torus.yaml").write_text("geometry: e3\nobjects: [{ball: {radius: 1}}]\n")
    with pytest.raises(MissingFileError, match=r"did you mean 'torus\.yaml'\?"):
        load_scene(tmp_path / "tours.yaml")
    with pytest.raises(MissingFileError, match="is a folder"):
        load_scene(tmp_path)


def test_too_large_a_file(tmp_path: Path) -> None:
    path = tmp_path / "large.yaml"
    path.write_text("# " + "x" * (1 << 20) + "\ngeometry: e3\n")
    with pytest.raises(SceneError, match="larger than 1048576 bytes"):
        load_scene(path)


def test_largest_file_allowed(tmp_path: Path) -> None:
    path = tmp_path / "large.yaml"
    scene = b"geometry: e3\nobjects: [{ball: {radius: 1}}]\n#"
    path.write_bytes(scene + b"x" * ((1 << 20) - len(scene)))
    assert load_scene(path).geometry == "e3"


def test_not_utf8(tmp_path: Path) -> None:
    path = tmp_path / "latin.yaml"
    path.write_bytes(b"geometry: e3\ntitle: caf\xe9\n")
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    assert f"{path}:2:11: error: this is not UTF-8 text" in str(caught.value)


def test_byte_order_mark_and_windows_lines(tmp_path: Path) -> None:
    path = tmp_path / "windows.yaml"
    path.write_bytes(b"\xef\xbb\xbfgeometry: e3\r\nobjects:\r\n  - ball: {radius: x}\r\n")
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    assert ":3:20: error: expected a number, found 'x'" in str(caught.value)


# The JSON Schema


def test_schema_is_draft_7() -> None:
    """yaml-language-server reads draft 7: no $defs, no prefixItems, nothing beside a $ref, no null."""

    def visit(value: Any) -> None:
        if isinstance(value, dict):
            assert "$defs" not in value
            assert "prefixItems" not in value
            assert value.get("type") != "null"
            if "$ref" in value:
                assert list(value) == ["$ref"]
                assert value["$ref"].startswith("#/definitions/")
            for item in value.values():
                visit(item)
        elif isinstance(value, list):
            for item in value:
                visit(item)

    visit(scene_schema())


def test_schema_describes_every_key() -> None:
    schema = scene_schema()
    for name, definition in {"Scene": schema, **schema["definitions"]}.items():
        assert definition["additionalProperties"] is False, name
        for key, value in definition.get("properties", {}).items():
            # A key whose description is that of its mapping says it there.
            assert value.get("description") or "$ref" in value, f"{name}.{key}"
