"""Image files that a scene names: where they are, and what is wrong with them."""

import os
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Annotated

from pydantic import PlainValidator, ValidationInfo, WithJsonSchema

from thurston_cl.errors import MissingFileError

from .base import problem, shown
from .context import context_of
from .suggest import did_you_mean, nearest
from .values import Says

# The formats that people have; OpenImageIO reads more.
_KNOWN = "JPEG, PNG, TIFF, EXR, HDR and WebP are read"
SUFFIXES = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".exr", ".hdr", ".webp")


@dataclass(frozen=True)
class ImageFile:
    """An image file: its `path`, and how it was `written`."""

    path: Path
    written: str


def image_folder() -> Path:
    """Where the pictures are that come with the program."""
    return Path(str(files("thurston_cl.scenes") / "images"))


def _image_file(value: object, info: ValidationInfo) -> ImageFile:
    if isinstance(value, ImageFile):
        return value
    if not isinstance(value, str) or not value.strip() or "\0" in value:
        raise problem(f"expected the name of an image file, found {shown(value)}", "for example photo.jpg")
    if "://" in value:
        raise problem(f"{shown(value)} is an address, not a file", "save the picture, and name that file")
    if not Path(value).suffix and Path(value).name == value:
        path = _shipped(value)
    else:
        path = context_of(info).folder / os.path.expanduser(value)
    try:
        if not path.exists():
            raise problem(f"there is no image file {shown(value)}", _instead_of(path))
        if path.is_dir():
            raise problem(f"{shown(value)} is a folder, not an image file", "name a file in it")
        state = path.stat()
        _check(path, state.st_mtime_ns, state.st_size)
    except OSError as error:
        raise problem(f"{shown(value)} cannot be read: {error.strerror}", _KNOWN) from error
    except MissingFileError as error:
        # The library may have more lines to say.
        message = str(error).split("\n")[0].replace(f"{path}: ", f"{shown(value)} ")
        raise problem(message, _KNOWN) from error
    return ImageFile(path, value)


def _instead_of(path: Path) -> str:
    """What to write in place of a file that is not there."""
    if path.stem in pictures():
        return f"the picture that comes with the program is called '{path.stem}'"
    beside = path.parent.iterdir() if path.parent.is_dir() else ()
    known = [file.name for file in beside if file.suffix.lower() in SUFFIXES]
    looked = f"it is looked for in {path.parent}"
    guess = nearest(path.name, known)
    return f"did you mean '{guess}'? It is in {path.parent}" if guess else looked


def pictures() -> dict[str, Path]:
    """The pictures that come with the program, by their bare names."""
    return {file.stem: file for file in image_folder().iterdir() if file.suffix in SUFFIXES}


def _shipped(name: str) -> Path:
    """The picture with this bare name that comes with the program."""
    known = pictures()
    if name not in known:
        listed = f"these pictures come with the program: {', '.join(sorted(known))}"
        help = did_you_mean(name, known, f"{listed}; the name of a file has a suffix, as in {name}.jpg")
        raise problem(f"no picture '{name}' comes with the program", help)
    return known[name]


@lru_cache(maxsize=64)
def _check(path: Path, changed: int, size: int) -> None:
    """Read a file once as long as it does not change; a texture is checked wherever it is named."""
    # Not before an image is named: the library behind it takes its time to load.
    from thurston_cl.image import read_texture

    read_texture(path)


ImageFileValue = Annotated[
    ImageFile,
    PlainValidator(_image_file),
    WithJsonSchema({"type": "string", "pattern": r"\S", "examples": ["photo.jpg", "earth"]}),
    Says("file name, from the folder of the scene, or `earth`"),
]
