"""From the text of a scene to plain values and the place of each of them.

One pass over the events of ruamel.yaml builds the tree. So nothing that we refuse is ever constructed (an
alias bomb only explodes when it is built), every duplicate key is found and not only the first, and each key
and value has a place of its own. Plain scalars are read by the core schema of YAML 1.2.2, section 10.3.2."""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.events import (
    AliasEvent,
    CollectionEndEvent,
    CollectionStartEvent,
    DocumentStartEvent,
    Event,
    MappingStartEvent,
    NodeEvent,
    ScalarEvent,
)
from ruamel.yaml.reader import ReaderError

from .diagnostics import split_lines

MAX_BYTES = 1 << 20
MAX_DEPTH = 40
MAX_NODES = 200_000

# Where something stands in a scene: keys and indices from the top, as in ("objects", 0, "ball", "radius").
Location = tuple[str | int, ...]

_NULL = re.compile(r"~|null|Null|NULL|")
_BOOL = re.compile(r"true|True|TRUE|false|False|FALSE")
_INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)|[-+]?(inf|infinity|nan)", re.IGNORECASE)
_DATE = re.compile(r"[0-9]{4}-[0-9]{1,2}-[0-9]{1,2}([Tt \t].*)?")
# Longer integers hold no meaning for a scene, and Python itself refuses to read very long ones.
_MAX_DIGITS = 18


@dataclass(frozen=True, slots=True)
class Place:
    """Where a key (None in a list) and its value start, (line, column) from 0; `origin` outside the file."""

    key: tuple[int, int] | None
    value: tuple[int, int]
    origin: str | None = None


@dataclass(frozen=True, slots=True)
class Mistake:
    """Something refused while reading, at a place of the text; if it got that far, with its location."""

    mark: tuple[int, int]
    message: str
    help: str | None = None
    location: Location | None = None


@dataclass
class Document:
    """The values of a scene as dicts, lists and scalars, the place of each, and what was refused on the way.

    `complete` is False if reading stopped early, so that the rest of the tree is unknown."""

    data: Any = None
    places: dict[Location, Place] = field(default_factory=dict)
    mistakes: list[Mistake] = field(default_factory=list)
    complete: bool = True


class _Stop(Exception):
    """Reading cannot go on."""


def parse(text: str) -> Document:
    """Read one YAML document; never raises for anything in the text: what is wrong stands in `mistakes`."""
    builder = _Builder(Document(places={(): Place(None, (0, 0))}))
    document = builder.document
    try:
        for event in _events(text):
            builder.feed(event)
    except _Stop:
        document.complete = False
    except ReaderError as error:
        before = split_lines(text[: error.position])
        mark = (len(before) - 1, len(before[-1]))
        document.mistakes.append(
            Mistake(mark, f"the character U+{ord(text[error.position]):04X} may not stand here")
        )
        document.complete = False
    except MarkedYAMLError as error:
        document.mistakes.append(_syntax_mistake(error, builder.open_bracket(), split_lines(text)))
        document.complete = False
    return document


def scalar(text: str) -> Any:
    """The value of a plain scalar; ValueError for what YAML can say and a scene cannot."""
    if _NULL.fullmatch(text):
        return None
    if _BOOL.fullmatch(text):
        return text.lower() == "true"
    if _INT.fullmatch(text):
        if len(text) > _MAX_DIGITS + 2:
            raise ValueError("this number is too large")
        return int(text, 0) if text[:2] in ("0o", "0x") else int(text)
    if _FLOAT.fullmatch(text):
        number = float(text)
        if math.isinf(number):
            raise ValueError("this number is too large")
        return number
    if _NOT_FINITE.fullmatch(text):
        raise ValueError(f"numbers are finite; '{text}' is not")
    if _DATE.fullmatch(text):
        raise ValueError(f"'{text}' reads as a date; put quotes around it to make it text")
    return text


def _events(text: str) -> Iterator[Event]:
    reader = YAML(typ="safe", pure=True)
    events: Iterator[Event] = reader.parse(text)
    return events


class _Builder:
    """Turns a stream of events into a `Document`."""

    def __init__(self, document: Document):
        self.document = document
        self.stack: list[_Open] = []
        self.documents = 0
        self.nodes = 0

    def feed(self, event: Event) -> None:
        if isinstance(event, DocumentStartEvent):
            self._start_document(event)
        elif isinstance(event, NodeEvent):
            self._refuse_what_scenes_do_without(event)
            if isinstance(event, ScalarEvent):
                self._scalar(event)
            elif isinstance(event, CollectionStartEvent):
                self._open(event)
        elif isinstance(event, CollectionEndEvent):
            self.stack.pop()

    def open_bracket(self) -> tuple[int, int] | None:
        """Where the innermost bracket opens that is not closed yet."""
        return next((top.bracket for top in reversed(self.stack) if top.bracket is not None), None)

    def _start_document(self, event: DocumentStartEvent) -> None:
        self.documents += 1
        if self.documents > 1:
            self._stop(event, "a scene file holds one document; a second one starts here")
        if event.version is not None and tuple(event.version) != (1, 2):
            self._note(event, "scenes are written in YAML 1.2", "leave the %YAML line out")

    def _refuse_what_scenes_do_without(self, event: NodeEvent) -> None:
        self.nodes += 1
        if self.nodes > MAX_NODES:
            self._stop(event, f"the scene has more than {MAX_NODES} values")
        if isinstance(event, AliasEvent):
            self._note(
                event,
                f"aliases (*{event.anchor}) are not allowed in a scene",
                "give the value a name under params:, materials: or textures: and refer to that",
                self._take_slot(event, None),
            )
            return
        if event.anchor is not None:
            self._note(
                event,
                f"anchors (&{event.anchor}) are not allowed in a scene",
                "give the value a name under params:, materials: or textures: and refer to that",
            )
        tag = getattr(event, "tag", None)
        if tag is not None:
            tag = str(tag).replace("tag:yaml.org,2002:", "!!")
            self._note(event, f"tags ({tag}) are not allowed in a scene", "write the plain value")

    def _scalar(self, event: ScalarEvent) -> None:
        top = self.stack[-1] if self.stack else None
        if top is not None and top.awaits_key:
            self._key(top, event)
            return
        if event.style is None:
            try:
                value = scalar(event.value)
            except ValueError as error:
                self._note(event, str(error), None, self._take_slot(event, event.value))
                return
        else:
            value = event.value
        self._take_slot(event, value)

    def _key(self, top: "_Open", event: ScalarEvent) -> None:
        top.key, top.key_mark = event.value, _mark(event)
        top.location = (*top.path, event.value)
        first = self.document.places.get(top.location)
        if first is not None and first.key is not None:
            # The first value stays; this one is read for its own mistakes, where nothing asks for it.
            line, column = first.key
            message = f"the key '{event.value}' is given twice; first in line {line + 1}, column {column + 1}"
            self._note(event, message, "keep one of them")
            top.location = (*top.path, f"{event.value} (again, line {top.key_mark[0] + 1})")
            top.discard = True

    def _open(self, event: CollectionStartEvent) -> None:
        if len(self.stack) >= MAX_DEPTH:
            self._stop(event, f"nested more than {MAX_DEPTH} deep")
        if self.stack and self.stack[-1].awaits_key:
            self._stop(
                event, "a key must be a word, not a list or a mapping", "does a ':' or a ',' stand too early?"
            )
        container: Any = {} if isinstance(event, MappingStartEvent) else []
        path = self._take_slot(event, container)
        self.stack.append(_Open(container, path, _mark(event) if event.flow_style else None))

    def _take_slot(self, event: NodeEvent, value: Any) -> Location:
        """Put a value where the stream stands, remember its place, and say its location."""
        if not self.stack:
            self.document.data = value
            self.document.places[()] = Place(None, _mark(event))
            return ()
        top = self.stack[-1]
        if isinstance(top.container, list):
            location: Location = (*top.path, len(top.container))
            top.container.append(value)
            self.document.places[location] = Place(None, _mark(event))
            return location
        if top.awaits_key:  # an alias as a key; it is refused already
            top.key, top.key_mark, top.location = "*", _mark(event), (*top.path, "*")
            top.discard = True
            return top.location
        assert top.key is not None
        location = top.location
        self.document.places[location] = Place(top.key_mark, _mark(event))
        if not top.discard:
            top.container[top.key] = value
        top.key, top.discard = None, False
        return location

    def _note(
        self, event: Event, message: str, help: str | None = None, location: Location | None = None
    ) -> None:
        self.document.mistakes.append(Mistake(_mark(event), message, help, location))

    def _stop(self, event: Event, message: str, help: str | None = None) -> None:
        self._note(event, message, help)
        raise _Stop


@dataclass
class _Open:
    """A list or mapping that is being filled, and for a mapping the key whose value comes next."""

    container: Any
    path: Location
    bracket: tuple[int, int] | None  # where it opens, if it is written in brackets
    key: str | None = None
    key_mark: tuple[int, int] = (0, 0)
    location: Location = ()
    discard: bool = False

    @property
    def awaits_key(self) -> bool:
        return isinstance(self.container, dict) and self.key is None


def _mark(event: Event) -> tuple[int, int]:
    return event.start_mark.line, event.start_mark.column


# Longer values are not repeated in a help line.
_LONGEST_VALUE = 40

# What the YAML reader says -> what an illustrator can act on.
_SYNTAX = (
    ("cannot start any token", "this character cannot start a value", "put quotes around the text"),
    (
        "mapping values are not allowed",
        "a ':' may not stand here",
        "is the line above it indented and closed?",
    ),
    ("could not find expected ':'", "a ':' is missing after the key before this", "write 'key: value'"),
    ("expected the node content", "a value is missing here", None),
    ("<block mapping start>", "this line is not indented as its neighbours are", None),
    ("<block sequence start>", "this line is not indented as its neighbours are", None),
    ("but found '-'", "this line is not indented as its neighbours are", None),
    ("but found '?'", "this line is not indented as its neighbours are", None),
    (
        "expected <block end>",
        "this does not belong here",
        "is there a quote or a bracket too many before it?",
    ),
)


def _syntax_mistake(error: MarkedYAMLError, bracket: tuple[int, int] | None, lines: list[str]) -> Mistake:
    opened, found = error.context_mark, error.problem_mark or error.context_mark
    context = error.context or ""
    problem = (error.problem or context or "it cannot be read").split("\n")[0].strip()
    mark = (found.line, found.column) if found else (0, 0)
    if r"\t" in problem:
        return Mistake(mark, "a tab may not stand here; YAML is indented with spaces")
    if opened is not None and "end of stream" in problem and "quoted" in context:
        return Mistake(
            (opened.line, opened.column), "not valid YAML: the quote that opens here is not closed"
        )
    if joined := _joined_key(mark, problem, lines):
        return joined
    if bracket is not None and "parsing a flow" in context:
        if "stream end" in problem:
            return Mistake(bracket, "not valid YAML: the bracket that opens here is not closed")
        where = f"line {bracket[0] + 1}, column {bracket[1] + 1}"
        return Mistake(
            mark, f"not valid YAML: the bracket of {where} is not closed, or a ',' is missing before this"
        )
    for sign, message, help in _SYNTAX:
        if sign in problem:
            return Mistake(mark, f"not valid YAML: {message}", help)
    return Mistake(mark, f"not valid YAML: {problem}")


def _joined_key(mark: tuple[int, int], problem: str, lines: list[str]) -> Mistake | None:
    """The blank that is missing after a colon, if that is what upset the reader at `mark`: it took the key
    and its value for one text, and the lines below for the rest of it."""
    line, column = mark
    here = lines[line] if line < len(lines) else ""
    if inside := re.search(r"([A-Za-z_][\w-]*):$", here[:column]):
        return _blank_needed((line, column), inside[1], "...")
    found = None
    if "mapping values are not allowed" in problem or "could not find expected ':'" in problem:
        for number in range(line - 1, -1, -1):
            if not lines[number].strip():
                continue
            key = re.match(r"\s*(?:- +)*([A-Za-z_][\w-]*):(?!//)(?=\S)", lines[number])
            if key is None:
                break
            found = _blank_needed((number, key.end()), key[1], lines[number][key.end() :])
    return found


def _blank_needed(mark: tuple[int, int], key: str, value: str) -> Mistake:
    value = value.strip() if len(value) <= _LONGEST_VALUE else "..."
    return Mistake(mark, "a blank is missing after the colon", f"write '{key}: {value}'")
