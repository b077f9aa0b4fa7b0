"""Reading YAML: what values mean, where they stand, and what is refused."""

import random
import string
from pathlib import Path

import pytest

from thurston_cl.errors import SceneError
from thurston_cl.scene import load_text
from thurston_cl.scene import parse as parser
from thurston_cl.scene.parse import Document, parse

SCENES = Path(__file__).parent / "data" / "scenes"


def messages(document: Document) -> list[str]:
    """What is wrong, each as line:column: message."""
    return [f"{m.mark[0] + 1}:{m.mark[1] + 1}: {m.message}" for m in document.mistakes]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-6", 1e-6),  # YAML 1.1 readers give text here
        ("1.0e6", 1e6),
        (".5", 0.5),
        ("5.", 5.0),
        ("-0.25", -0.25),
        ("+3", 3),
        ("017", 17),  # not octal
        ("0o17", 15),
        ("0x1F", 31),
        ("12:30", "12:30"),  # not base 60
        ("1_000", "1_000"),
        ("on", "on"),
        ("no", "no"),
        ("true", True),
        ("False", False),
        ("~", None),
        ("null", None),
        ("", None),
        ("nil", "nil"),
        ("90 deg", "90 deg"),
        ("'1e3'", "1e3"),
        ('"true"', "true"),
        ("'2026-01-01'", "2026-01-01"),
        ("1e-400", 0.0),
        ("version 2026-01-01", "version 2026-01-01"),
    ],
)
def test_values(text: str, value: object) -> None:
    document = parse(f"key: {text}\n")
    assert document.mistakes == []
    found = document.data["key"]
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (".inf", "1:6: numbers are finite; '.inf' is not"),
        ("-.INF", "1:6: numbers are finite; '-.INF' is not"),
        (".nan", "1:6: numbers are finite; '.nan' is not"),
        ("nan", "1:6: numbers are finite; 'nan' is not"),
        ("1e999", "1:6: this number is too large"),
        ("1" * 5000, "1:6: this number is too large"),
        ("2026-01-01", "1:6: '2026-01-01' reads as a date; put quotes around it to make it text"),
        (
            "2026-01-01T12:00:00Z",
            "1:6: '2026-01-01T12:00:00Z' reads as a date; put quotes around it to make it text",
        ),
        ("*a", "1:6: aliases (*a) are not allowed in a scene"),
        ("&a 3", "1:6: anchors (&a) are not allowed in a scene"),
        ("!!int 3", "1:6: tags (!!int) are not allowed in a scene"),
        (
            "!!python/object/apply:os.system [ls]",
            "1:6: tags (!!python/object/apply:os.system) are not allowed",
        ),
        ("[1, 2", "1:6: not valid YAML: the bracket that opens here is not closed"),
        ("[1, 2\nb: 3", "2:2: not valid YAML: the bracket of line 1, column 6 is not closed"),
        ("'text", "1:6: not valid YAML: the quote that opens here is not closed"),
        ("a: b", "1:7: not valid YAML: a ':' may not stand here"),
        ("1\n\tb: 2", "2:1: a tab may not stand here; YAML is indented with spaces"),
        ("@x", "1:6: not valid YAML: this character cannot start a value"),
        ("'it's'", "1:10: not valid YAML: this does not belong here"),
        ("[1, 2]]", "1:12: not valid YAML: this does not belong here"),
        ("{[1]: 2}", "1:7: a key must be a word, not a list or a mapping"),
        ("1\n---\nb: 2", "2:1: a scene file holds one document; a second one starts here"),
        ("x\x07y", "1:7: the character U+0007 may not stand here"),
        ("1\nkey: 2", "2:1: the key 'key' is given twice; first in line 1, column 1"),
        ("1\n'key' : 2", "2:1: the key 'key' is given twice; first in line 1, column 1"),
    ],
)
def test_refused(text: str, message: str) -> None:
    found = messages(parse(f"key: {text}\n"))
    assert len(found) == 1, found
    assert found[0].startswith(message)


def test_directive_of_old_yaml() -> None:
    assert messages(parse("%YAML 1.1\n---\na: 1\n")) == ["2:1: scenes are written in YAML 1.2"]
    assert messages(parse("%YAML 1.2\n---\na: 1\n")) == []


def test_everything_that_can_be_found_is_found_before_the_text_ends() -> None:
    found = messages(parse("a: {b: 1, b: &x 2, b: .nan}\nc: *x\na: [2026-01-01]\nd: [\n"))
    assert [message.split(": ")[0] for message in found] == [
        "1:11",
        "1:14",
        "1:20",
        "1:23",
        "2:4",
        "3:1",
        "3:5",
        "4:4",
    ]


def test_first_of_two_values_stays() -> None:
    assert parse("a: 1\na: 2\n").data == {"a": 1}


def test_depth() -> None:
    assert parse("[" * 40 + "]" * 40).mistakes == []
    assert messages(parse("[" * 41 + "]" * 41)) == ["1:41: nested more than 40 deep"]
    # Far deeper than the stack of Python.
    assert messages(parse("[" * 100_000)) == ["1:41: nested more than 40 deep"]
    assert messages(parse("".join(" " * k + "a:\n" for k in range(42)))) == [
        "41:41: nested more than 40 deep"
    ]


def test_alias_bomb_is_never_built() -> None:
    lines = ["a0: &a0 [lol]"] + [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, 10)]
    document = parse("\n".join(lines))
    assert len(document.mistakes) == 10 + 81
    assert document.data["a9"] == [None] * 9


def test_number_of_values(monkeypatch: pytest.MonkeyPatch) -> None:
    assert parser.MAX_NODES == 200_000
    monkeypatch.setattr(parser, "MAX_NODES", 100)
    # The list itself is a value, too.
    assert parse("[" + "1," * 99 + "]").mistakes == []
    assert messages(parse("[" + "1," * 100 + "]")) == ["1:200: the scene has more than 100 values"]


def test_places() -> None:
    document = parse("a: 1\nb:\n  - c: {d: 2}\n  -   3\n")
    places = {location: (place.key, place.value) for location, place in document.places.items()}
    assert places == {
        (): (None, (0, 0)),
        ("a",): ((0, 0), (0, 3)),
        ("b",): ((1, 0), (2, 2)),
        ("b", 0): (None, (2, 4)),
        ("b", 0, "c"): ((2, 4), (2, 7)),
        ("b", 0, "c", "d"): ((2, 8), (2, 11)),
        ("b", 1): (None, (3, 6)),
    }


def test_damaged_scenes_give_scene_errors_only() -> None:
    """Whatever is done to a text, the answer is a scene or a report with lines that exist."""
    random_source = random.Random(1)
    text = (SCENES / "good-hyperbolic.yaml").read_text()
    for _ in range(150):
        damaged = text
        for _ in range(random_source.randint(1, 4)):
            start = random_source.randrange(len(damaged))
            stop = start + random_source.choice((0, 1, 1, 5, 30))
            put = "".join(
                random_source.choices(
                    string.printable + "é漢\u2028\ufeff", k=random_source.choice((0, 1, 2, 6))
                )
            )
            damaged = damaged[:start] + put + damaged[stop:]
        try:
            load_text(damaged, "scene.yaml")
        except SceneError as error:
            lines = len(damaged.splitlines()) + 1
            assert all(1 <= d.line <= lines and d.column >= 1 for d in error.diagnostics)  # type: ignore[attr-defined]
