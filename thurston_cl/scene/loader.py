"""From a file to a checked `Scene`, or to one error that lists every mistake."""

import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from thurston_cl.errors import MissingFileError, SceneError

from .base import Problem, problems_of
from .context import Context
from .diagnostics import Diagnostic, SceneReport
from .library import resolve
from .overrides import apply_sets, names_used, read_overrides, substitute
from .parse import MAX_BYTES, Location, parse
from .schema import Scene
from .source import SceneSource
from .suggest import blank_after_colon
from .values import PARAM_PATTERN


def load_scene(
    path: str | Path, defines: Mapping[str, str | float] | None = None, sets: Sequence[str] = ()
) -> Scene:
    """Read and check a scene.

    `path` is a file, the name of a library scene such as "h3/seifert-weber", or "-" for standard input.
    `defines` gives params other values and `sets` changes keys, as `-D name=value` and `--set key=value` do.

    Raises SceneError, whose text lists every mistake with line, column and cure, and whose `diagnostics` has
    them one by one; MissingFileError if there is no such file."""
    if str(path) == "-":
        return load_text(_decode(sys.stdin.buffer.read(MAX_BYTES + 1), "<stdin>"), "<stdin>", defines, sets)
    file = resolve(path)
    try:
        with file.open("rb") as stream:
            content = stream.read(MAX_BYTES + 1)
    except OSError as error:
        raise MissingFileError(f"cannot read the scene {file}: {error.strerror}") from error
    return load_text(_decode(content, str(file)), str(file), defines, sets, path=file)


def load_text(
    text: str,
    name: str = "scene",
    defines: Mapping[str, str | float] | None = None,
    sets: Sequence[str] = (),
    *,
    path: Path | None = None,
) -> Scene:
    """Check a scene that is at hand as text; `name` stands for it in messages. Otherwise as `load_scene`."""
    defines = dict(defines or {})
    document = parse(text)
    source = SceneSource(name, path, text, document.places, defines, tuple(sets))
    diagnostics = [source.at_mark(mistake) for mistake in document.mistakes]
    if not document.complete:
        raise source.report(diagnostics)
    if not isinstance(document.data, dict):
        what = "is empty" if document.data is None else "is not a mapping of keys"
        help = blank_after_colon(str(document.data), Scene.model_fields)
        help = help or "it starts with 'geometry:' and 'objects:'"
        diagnostics.append(source.diagnostic((), f"the scene {what}", help))
        raise source.report(diagnostics)

    used_before = names_used(document.data)
    overrides = read_overrides(defines, sets)
    apply_sets(document, overrides)
    substitution = substitute(document.data, overrides)
    source = SceneSource(name, path, text, document.places, defines, tuple(sets), substitution.notes)
    diagnostics += overrides.diagnostics
    diagnostics += [source.diagnostic(*unknown) for unknown in substitution.unknown]
    diagnostics += _unused_params(document.data, used_before | substitution.used, source)

    reported = {mistake.location for mistake in document.mistakes if mistake.location} | substitution.broken
    context = Context.of(substitution.data, None if path is None else path.parent)
    try:
        scene = Scene.model_validate(substitution.data, context=context)
    except ValidationError as error:
        found = [problem for problem in problems_of(error) if not _is_known(problem, reported)]
        diagnostics += [source.diagnostic(p.path, p.message, p.help, key=p.key) for p in found]
    if diagnostics:
        raise source.report(diagnostics)
    scene.remember(source, context.lattice)
    return scene


def _is_known(problem: Problem, reported: set[Location]) -> bool:
    """Whether a problem only repeats, in other words, what was reported of the same value."""
    return any(problem.path[: len(location)] == location for location in reported)


def _unused_params(data: dict[str, Any], used: set[str], source: SceneSource) -> list[Diagnostic]:
    params = data.get("params")
    if not isinstance(params, dict):
        return []
    return [
        source.diagnostic(
            ("params", name),
            f"the param '{name}' is not used",
            f"write ${name} somewhere, or remove it",
            key=True,
        )
        for name in params
        if name not in used and re.match(PARAM_PATTERN, f"${name}")
    ]


def _decode(content: bytes, name: str) -> str:
    if len(content) > MAX_BYTES:
        raise SceneReport(name, "", [Diagnostic(0, 0, f"the scene is larger than {MAX_BYTES} bytes")])
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8", "replace").split("\n")
        text = content.decode("utf-8", "replace")
        mistake = Diagnostic(
            len(before), len(before[-1]) + 1, "this is not UTF-8 text", "save the file as UTF-8"
        )
        raise SceneReport(name, text, [mistake]) from error


__all__ = ["SceneError", "load_scene", "load_text"]
