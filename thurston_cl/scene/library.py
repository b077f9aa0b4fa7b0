"""The scenes that come with the program: their list, and how a name becomes a file."""

import importlib.resources
from dataclasses import dataclass
from pathlib import Path

from thurston_cl.errors import MissingFileError

from .diagnostics import split_lines
from .parse import parse
from .suggest import did_you_mean


@dataclass(frozen=True)
class LibraryScene:
    """A scene of the library: its name ("h3/seifert-weber"), its file, and what its text says about it."""

    name: str
    path: Path
    title: str
    geometry: str
    comment: str  # the first line of its head comment


def library_folder() -> Path:
    """Where the scenes of the library stand."""
    return Path(str(importlib.resources.files("thurston_cl.scenes")))


def library_names() -> list[str]:
    """The names of all scenes of the library, in order."""
    folder = library_folder()
    return sorted(file.relative_to(folder).with_suffix("").as_posix() for file in folder.rglob("*.yaml"))


def library_scenes() -> list[LibraryScene]:
    """All scenes of the library, in order of their names."""
    return [_describe(name) for name in library_names()]


def library_scene(name: str) -> LibraryScene:
    """One scene of the library, by its name; MissingFileError if there is none."""
    known = library_names()
    plain = name.removesuffix(".yaml")
    if plain not in known:
        raise MissingFileError(f"the library has no scene '{name}'; {_guess(plain, known)}")
    return _describe(plain)


def resolve(scene: str | Path) -> Path:
    """The file that is meant where a scene is asked for: one that exists, else the library scene so named."""
    path = Path(scene)
    if path.is_file():
        return path
    if path.is_dir():
        raise MissingFileError(f"{path} is a folder, not a scene")
    known = library_names()
    plain = str(scene).removesuffix(".yaml")
    if plain in known:
        return library_folder() / f"{plain}.yaml"
    raise MissingFileError(f"there is no scene file {path}; {_guess(plain, known, path)}")


def _guess(plain: str, known: list[str], path: Path | None = None) -> str:
    """What was meant instead: a file beside the one asked for, or a scene of the library."""
    if path is not None and path.parent.is_dir():
        beside = [file.name for file in path.parent.glob("*.yaml")]
        if guess := did_you_mean(path.name, beside):
            return guess
    bare = {name.rsplit("/", 1)[-1]: name for name in known}
    if plain in bare:
        return f"did you mean '{bare[plain]}'?"
    return did_you_mean(plain, known) or "'thurston scenes' lists the scenes that come with the program"


def _describe(name: str) -> LibraryScene:
    path = library_folder() / f"{name}.yaml"
    text = path.read_text(encoding="utf-8")
    data = parse(text).data
    data = data if isinstance(data, dict) else {}
    return LibraryScene(
        name, path, str(data.get("title", "")), str(data.get("geometry", "")), _head_comment(text)
    )


def _head_comment(text: str) -> str:
    for line in split_lines(text):
        if not line.startswith("#"):
            return ""
        words = line.lstrip("# ").rstrip()
        if words and not words.startswith("yaml-language-server"):
            return words
    return ""
