"""What the command line changes in a scene before it is checked: `-D name=value` and `--set key=value`."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from .diagnostics import Diagnostic
from .parse import MAX_DEPTH, Document, Location, Place, parse, scalar
from .suggest import did_you_mean, listing, nearest
from .values import PARAM_PATTERN


@dataclass
class Overrides:
    """The changes, read but not yet made, and what is wrong with them."""

    defines: dict[str, Any] = field(default_factory=dict)
    sets: list[tuple[str, list[str], Document]] = field(default_factory=list)  # origin, dotted key, value
    diagnostics: list[Diagnostic] = field(default_factory=list)

    def blame(self, origin: str, message: str, help: str | None = None) -> None:
        """Note a mistake in an option."""
        self.diagnostics.append(Diagnostic(0, 0, message, help, origin))


def read_overrides(defines: Mapping[str, str | float], sets: Sequence[str]) -> Overrides:
    """Read the options by themselves; what is wrong with them stands in `diagnostics`."""
    overrides = Overrides()
    for name, text in defines.items():
        origin = f"-D {name}={text}"
        try:
            value = _one_value(str(text))
        except ValueError as error:
            overrides.blame(origin, str(error))
        else:
            overrides.defines[name] = value
    for text in sets:
        key, equals, value_text = text.partition("=")
        origin = f"--set {text}"
        if not equals or not all(key.strip().split(".")):
            overrides.blame(origin, "expected key=value", "for example --set render.samples=16")
            continue
        if key.count(".") >= MAX_DEPTH:
            overrides.blame(origin, f"nested more than {MAX_DEPTH} deep")
            continue
        # A color: to YAML, '#' would start a comment.
        value = Document(data=value_text, places={(): Place(None, (0, 0))})
        if not value_text.strip().startswith("#"):
            value = parse(value_text)
        if value.mistakes:
            overrides.blame(origin, value.mistakes[0].message, value.mistakes[0].help)
            continue
        # What a shell leaves of an unset variable is not taken for a wish to remove the key.
        if not value_text.strip():
            overrides.blame(origin, "the value is empty", f"to leave the key out write {key.strip()}=null")
            continue
        overrides.sets.append((origin, key.strip().split("."), value))
    return overrides


def _one_value(text: str) -> Any:
    """The value of `-D`: a plain scalar, or text in quotes."""
    text = text.strip()
    if text[:1] in ("'", '"') and text[-1:] == text[:1] and len(text) > 1:
        document = parse(text)
        if document.mistakes:
            raise ValueError(document.mistakes[0].message)
        return document.data
    if text[:1] in ("[", "{"):
        raise ValueError("a param is one number or one text, not a list or a mapping")
    value = scalar(text)
    if value is None:
        raise ValueError("the value is empty")
    if isinstance(value, bool):
        raise ValueError("a param is a number or text, and not true or false")
    return value


def apply_sets(document: Document, overrides: Overrides) -> None:
    """Make the changes of `--set` in a document, and remember that the new values come from there."""
    for origin, keys, value in overrides.sets:
        try:
            location = change(document.data, keys, value.data)
        except ValueError as error:
            overrides.blame(origin, str(error))
            continue
        stale = [place for place in document.places if place[: len(location)] == location]
        for old in stale:
            del document.places[old]
        if value.data is None:
            continue
        # Mappings that were made on the way have no place yet.
        for end in range(1, len(location)):
            document.places.setdefault(location[:end], Place(None, (0, 0), origin))
        for below in value.places:
            document.places[location + below] = Place(None, (0, 0), origin)


def change(data: Any, keys: Sequence[str], value: Any) -> Location:
    """Put a value at dotted keys, or with None remove that key of a mapping; the location.

    ValueError as `assign`, or if there is no such key."""
    if value is not None:
        return assign(data, keys, value)
    container = data
    location: list[str | int] = []
    for depth, written in enumerate(keys):
        name = ".".join(keys[: depth + 1])
        inner = isinstance(container, list) and depth < len(keys) - 1
        key = _index(written, container, ".".join(keys[:depth])) if inner else written
        there = range(len(container)) if inner else container if isinstance(container, dict) else ()
        if isinstance(container, list) and not inner:
            _index(written, container, ".".join(keys[:depth]))
            whole = ".".join(keys[:depth])
            raise ValueError(
                f"'{name}' is an entry of a list, and only keys can be left out: set '{whole}' anew"
            )
        if key not in there:
            raise ValueError(f"there is no key '{name}' to leave out")
        location.append(key)
        if depth < len(keys) - 1:
            container = container[key]
    del container[key]
    return tuple(location)


def assign(data: Any, keys: Sequence[str], value: Any) -> Location:
    """Put a value at dotted keys into nested dicts and lists; the location. Makes what is missing on the way.

    ValueError if the way leads through a single value, or beyond the end of a list."""
    location: list[str | int] = []
    container = data
    for depth, written in enumerate(keys):
        key: str | int = written
        if isinstance(container, list):
            key = _index(written, container, ".".join(keys[:depth]))
        elif not isinstance(container, dict):
            raise ValueError(f"'{'.'.join(keys[:depth])}' is a single value and has no '{written}'")
        location.append(key)
        if depth == len(keys) - 1:
            new = value
        elif (isinstance(key, int) and key == len(container)) or (
            isinstance(key, str) and container.get(key) is None
        ):
            new = [] if keys[depth + 1].isdecimal() else {}
        else:
            container = container[key]
            continue
        if isinstance(container, list) and key == len(container):
            container.append(new)
        else:
            container[key] = new
        container = new
    return tuple(location)


def _index(written: str, container: list[Any], name: str) -> int:
    if not re.fullmatch(r"[0-9]+", written):
        raise ValueError(f"'{name}' is a list: '{written}' must be a number, from 0")
    index = int(written)
    if index > len(container):
        raise ValueError(f"'{name}' has {len(container)} entries, counted from 0: there is no entry {index}")
    return index


@dataclass
class Substitution:
    """A scene with its params put in; where each stood, with a note on its value; what was used."""

    data: Any
    notes: dict[Location, str] = field(default_factory=dict)
    used: set[str] = field(default_factory=set)
    broken: set[Location] = field(default_factory=set)  # reported already: say no more about these
    unknown: list[tuple[Location, str, str]] = field(default_factory=list)  # location, message, help


def names_used(data: Any) -> set[str]:
    """The names that stand as `$name` anywhere outside `params`."""
    return {name for location, name in _uses((), data) if location[:1] != ("params",)}


def substitute(data: dict[str, Any], overrides: Overrides) -> Substitution:
    """Replace every `$name` by the param of that name, with `-D` before `params`."""
    params = data.get("params")
    params = dict(params) if isinstance(params, dict) else {}
    result = Substitution(data)
    for name in overrides.defines.keys() - params.keys():
        help = did_you_mean(
            name, params, f"it has: {listing(params)}" if params else "it has no params at all"
        )
        overrides.blame(f"-D {name}={overrides.defines[name]}", f"the scene has no param '{name}'", help)
    values = params | overrides.defines

    def walk(location: Location, value: Any) -> Any:
        if isinstance(value, dict):
            return {key: walk((*location, key), inner) for key, inner in value.items()}
        if isinstance(value, list):
            return [walk((*location, index), inner) for index, inner in enumerate(value)]
        if not isinstance(value, str) or not re.match(PARAM_PATTERN, value):
            return value
        name = value[1:]
        result.used.add(name)
        if name not in values:
            guess = nearest(name, values)
            if name in _names(data, "textures"):
                help = f"a texture goes by '$textures.{name}'"
            elif name in _names(data, "materials"):
                help = f"a material goes by its bare name: {name}"
            elif guess:
                help = f"did you mean '${guess}'?"
                result.used.add(guess)  # it is used, but for the spelling
            elif values:
                help = f"params has: {listing(values)}"
            else:
                help = f"the scene has no params; add 'params: {{{name}: ...}}'"
            result.unknown.append((location, f"unknown name '{value}'", help))
            result.broken.add(location)
            return value
        found = values[name]
        if isinstance(found, bool) or not isinstance(found, (int, float, str)) or str(found).startswith("$"):
            result.broken.add(location)  # the param itself is wrong, and reported there
            return value
        whence = f", from -D {name}" if name in overrides.defines else ""
        result.notes[location] = f"here {value} is {found}{whence}"
        return found

    result.data = {
        key: {**params, **{name: overrides.defines[name] for name in params if name in overrides.defines}}
        if key == "params" and isinstance(value, dict)
        else walk((key,), value)
        for key, value in data.items()
    }
    return result


def _names(data: dict[str, Any], section: str) -> dict[str, Any]:
    """What a section of the scene defines."""
    found = data.get(section)
    return found if isinstance(found, dict) else {}


def _uses(location: Location, value: Any) -> Iterator[tuple[Location, str]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _uses((*location, key), inner)
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from _uses((*location, index), inner)
    elif isinstance(value, str) and re.match(PARAM_PATTERN, value):
        yield location, value[1:]
