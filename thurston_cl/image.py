"""Pictures: their channels as arrays, and EXR and PNG files of them.

The only module that touches OpenImageIO. That library answers errors with False or None, takes an unknown
type name for "half", reorders channels, scales integers stored beside floats, and hangs when a file that
failed is written again; so every call goes through `check`, types are asserted, channels are looked up by
name, integers stand in parts of their own, and a file is read back and compared before it gets its name.
Colors go through OpenColorIO with `film.ocio` beside this file.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from thurston_cl.errors import MissingFileError, OutputError, ThurstonError

# The library would print errors that we already raise, on stdout.
oiio.attribute("imagebuf:print_uncaught_errors", 0)

FLOAT_CHANNELS: dict[str, tuple[str, ...]] = {
    "beauty": ("R", "G", "B"),
    "depth": ("depth",),
    "normal": ("normal.X", "normal.Y", "normal.Z"),
    "steps": ("steps",),
    "error": ("error",),
}
INTEGER_CHANNELS: dict[str, tuple[str, ...]] = {"object": ("object.id",), "cell": ("cell.id",)}
EVERY_CHANNEL = (*FLOAT_CHANNELS, *INTEGER_CHANNELS)
# Those that are made without being named.
CHANNELS = tuple(name for name in EVERY_CHANNEL if name != "error")
# Of which a PNG may be a heat map.
HEAT_CHANNELS = ("depth", "steps", "error")
SUFFIXES = (".exr", ".png")
# How light becomes the color of a screen; `film.ocio` says how each of them does.
VIEWS = ("none", "filmic", "aces")
# Stops either way: beyond lies no picture, and a factor that single precision might not hold.
EXPOSURE_LIMIT = 32.0

_PREFIX = "thurston:"
_LINEAR, _SRGB = "lin_rec709_scene", "srgb_rec709_scene"
# Always given: a broken $OCIO must not break a render.
_COLOR_CONFIG = str(Path(__file__).with_name("film.ocio"))
# The color spaces that other people's files name, which film.ocio need not have.
_FILE_CONFIG = "ocio://default"
_DISPLAY = "sRGB"
# Rows handled at a time: bounds the memory of a large picture. A multiple of the 16 rows that zip packs.
_BAND = 256
# OpenColorIO gives NaN for infinity; any number far over white does as well.
_OVER_WHITE = 65504.0
# Bytes free below which a failed file is put down to the disk.
_FULL = 1 << 20

Array = NDArray[Any]


class _Answers(Protocol):
    """Anything of OpenImageIO that keeps the text of its last error."""

    def geterror(self) -> str: ...


def check(result: Any, source: _Answers, what: str, error: type[ThurstonError] = OutputError) -> Any:
    """Give `result` back; where it says failure (False or None), raise `error` with `what` and the cause."""
    if result is None or result is False:
        raise error(f"{what}: {source.geterror() or 'OpenImageIO gives no reason'}")
    return result


# ------------------------------------------------------------------------------------------------ the picture


@dataclass
class Image:
    """A rendered picture.

    `channels`: arrays, top row first. beauty (H,W,3) float32, linear Rec.709; depth (H,W) float32, the length
    of the geodesic, inf where nothing is hit; normal (H,W,3) float32; steps (H,W) float32; object (H,W)
    uint32, 0 where nothing is hit, else the 1-based number of the object in the scene; cell (H,W) uint32.
    `metadata`: text that reproduces the picture (numbers as JSON); saved with "thurston:" before each key. An
    empty text is not saved, since EXR holds none.
    `statistics`: what the render cost and met; not saved.

    Raises ValueError for an unknown channel, arrays that do not fit together, metadata that no file can hold.
    """

    channels: dict[str, Array]
    metadata: dict[str, str] = field(default_factory=dict)
    statistics: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.channels:
            raise ValueError("a picture needs at least one channel")
        size = next(iter(self.channels.values())).shape[:2]
        for name, array in self.channels.items():
            planes = len(_names(name))
            wanted = size if planes == 1 else (*size, planes)
            if array.shape != wanted or 0 in array.shape:
                raise ValueError(f"channel {name!r} has the shape {array.shape}, not {wanted} without 0")
            dtype = np.dtype("uint32" if name in INTEGER_CHANNELS else "float32")
            if array.dtype != dtype:
                raise ValueError(f"channel {name!r} is {array.dtype}, expected {dtype}")
        for key, text in self.metadata.items():
            if not isinstance(text, str) or "\0" in text:
                raise ValueError(f"metadata {key!r} must be text without NUL characters, not {text!r}")

    @property
    def width(self) -> int:
        """Pixels in a row."""
        return int(next(iter(self.channels.values())).shape[1])

    @property
    def height(self) -> int:
        """Number of rows."""
        return int(next(iter(self.channels.values())).shape[0])

    def save(
        self,
        path: str | os.PathLike[str],
        channels: Sequence[str] | None = None,
        force: bool = False,
        exposure: float = 0.0,
        view: str = "none",
        most: float | None = None,
    ) -> None:
        """Write the picture to `path`; the suffix says how.

        .exr: `channels` (default: all) as 32-bit floats in linear Rec.709, object and cell as parts of 32-bit
        integers. .png: one channel, 8 bits in sRGB: beauty, the default, made by `to_srgb` with `exposure`
        and `view`; depth or steps by `heat_map` with `most`. Its metadata tell how. The file is written
        beside its name as NAME.part, read back, compared and renamed: under its own name it is whole or
        absent.

        Raises OutputError: wrong suffix or channels, exposure, view or most for what does not take them, no
        such directory, not writable, disk full, or the file exists and `force` is not given; ValueError as
        `to_srgb` and `heat_map` do.
        """
        target = check_output(path, channels, force)
        is_png = target.suffix.lower() == ".png"
        every = ("beauty",) if is_png else tuple(n for n in CHANNELS if n in self.channels)
        chosen = tuple(channels) if channels is not None else every
        absent = [name for name in chosen if name not in self.channels]
        if absent:
            has = ", ".join(self.channels)
            raise OutputError(f"{path}: the picture has no channel {', '.join(absent)}; it has {has}")
        if not is_png and (exposure != 0 or view != "none"):
            raise OutputError(
                f"{path}: an EXR keeps the linear numbers; leave exposure and view out, or write a PNG"
            )
        if is_png and chosen[0] in HEAT_CHANNELS:
            if exposure != 0 or view != "none":
                raise OutputError(f"{path}: a heat map is no light; leave exposure and view out")
            _save_parts(target, self._heat_parts(chosen[0], most))
            return
        if most is not None:
            raise OutputError(
                f"{path}: most is for a heat map; leave it out, or write steps or depth to a PNG"
            )
        _save_parts(target, self._png_parts(exposure, view) if is_png else self._exr_parts(chosen))

    def _exr_parts(self, chosen: Sequence[str]) -> list[_Part]:
        floats = [name for name in FLOAT_CHANNELS if name in chosen]
        planes = {label: plane for name in floats for label, plane in _planes(name, self.channels[name])}
        parts = [_Part("beauty" if "beauty" in floats else "data", "float", planes)] if floats else []
        parts += [
            _Part(name, "uint", dict(_planes(name, self.channels[name])))
            for name in INTEGER_CHANNELS
            if name in chosen
        ]
        parts[0].metadata = self._saved_metadata()
        return parts

    def _png_parts(self, exposure: float = 0.0, view: str = "none") -> list[_Part]:
        pixels = to_srgb(self.channels["beauty"], exposure, view)
        film = {"exposure": json.dumps(float(exposure)), "view": view}
        return [_Part("beauty", "uint8", dict(_planes("beauty", pixels)), self._saved_metadata() | film)]

    def _heat_parts(self, channel: str, most: float | None) -> list[_Part]:
        values = self.channels[channel]
        black = largest(values) if most is None else float(most)
        gray = np.broadcast_to(heat_map(values, black)[..., np.newaxis], (*values.shape, 3))
        told = {"shows": channel, "most": json.dumps(black)}
        return [_Part(channel, "uint8", dict(_planes("beauty", gray)), self._saved_metadata() | told)]

    def _saved_metadata(self) -> dict[str, str]:
        return {key: text for key, text in self.metadata.items() if text}

    def __repr__(self) -> str:
        return f"<Image {self.width}x{self.height}: {', '.join(self.channels)}>"

    def _repr_png_(self) -> bytes | None:
        """The beauty as a PNG, by which a notebook shows the picture."""
        if "beauty" not in self.channels:
            return None
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "beauty.png")
            _save_parts(path, self._png_parts())
            return path.read_bytes()


def _names(channel: str) -> tuple[str, ...]:
    names = FLOAT_CHANNELS.get(channel) or INTEGER_CHANNELS.get(channel)
    if names is None:
        raise ValueError(f"unknown channel {channel!r}; there are {', '.join(EVERY_CHANNEL)}")
    return names


def _planes(channel: str, array: Array) -> Iterator[tuple[str, Array]]:
    """The names in the file and (H,W) views of a channel."""
    stack = array if array.ndim == 3 else array[..., np.newaxis]
    return ((name, stack[..., k]) for k, name in enumerate(_names(channel)))


# ----------------------------------------------------------------------------------------------------- colour


def to_srgb(beauty: Array, exposure: float = 0.0, view: str = "none") -> NDArray[np.uint8]:
    """Convert linear Rec.709 (H,W,3) float to the 8-bit sRGB that a screen shows, by OpenColorIO.

    `exposure`: stops; the light is taken 2^exposure times, before anything else. `view`: what becomes of it.
    "none": sRGB as it is, what is over white is white. "filmic": an S-shaped curve that keeps middle gray and
    never quite reaches white. "aces": the Academy's output transform 2.0 for screens of 100 nits, which shows
    middle gray darker. All take 0 to 0. Rounded to nearest, no dither. NaN takes the mean of its sound
    neighbours (black where there is none), infinity is white, as any number far over white.

    Raises ValueError for another shape, an unknown view, an exposure beyond EXPOSURE_LIMIT either way.
    """
    if beauty.ndim != 3 or beauty.shape[2] != 3:
        raise ValueError(f"beauty has the shape {beauty.shape}, expected (H, W, 3)")
    if view not in VIEWS:
        raise ValueError(f"unknown view {view!r}; there are {', '.join(VIEWS)}")
    if not abs(exposure) <= EXPOSURE_LIMIT:
        raise ValueError(
            f"exposure is {exposure}; expected from {-EXPOSURE_LIMIT:g} to {EXPOSURE_LIMIT:g} stops"
        )
    with np.errstate(over="ignore"):
        linear = np.asarray(beauty, np.float32) * np.float32(2.0**exposure)
    if not np.isfinite(linear).all():
        linear = np.clip(linear, 0, _OVER_WHITE)
        fixed = oiio.ImageBufAlgo.fixNonFinite(_buffer(linear), oiio.NonFiniteFixMode.NONFINITE_BOX3)
        linear = _pixels(fixed, "replacing NaN pixels")
    out = np.empty(linear.shape, np.uint8)
    for rows in _bands(len(linear)):
        # sRGB maps [0, 1] onto itself, and the curves of the others are flat where they end.
        display = _displayed(np.clip(linear[rows], 0, 1 if view == "none" else _OVER_WHITE), view)
        out[rows] = np.rint(np.clip(display, 0, 1) * 255)
    return out


def heat_map(values: Array, most: float | None = None) -> NDArray[np.uint8]:
    """Grays (H,W), 8 bits, of numbers (H,W): 0 is white, `most` and more is black, even steps between them.

    `most`: left out, the largest that occurs. Infinity is black, as is NaN, of which nothing is known.
    Raises ValueError for another shape, `most` not a finite number over 0.
    """
    if values.ndim != 2:
        raise ValueError(f"the numbers of a heat map have the shape {values.shape}, expected (H, W)")
    black = largest(values) if most is None else most
    if not 0 < black < np.inf:
        raise ValueError(f"most is {black}; expected a finite number over 0")
    shares = np.clip(np.nan_to_num(values.astype(np.float64), nan=np.inf) / black, 0, 1)
    return np.rint(255 * (1 - shares)).astype(np.uint8)


def largest(values: Array) -> float:
    """The largest finite number; 1 where none is over 0, so that a heat map can be made of it."""
    found = float(np.max(values, where=np.isfinite(values), initial=0))
    return found if found > 0 else 1.0


def _displayed(pixels: Array, view: str) -> Array:
    displayed = oiio.ImageBufAlgo.ociodisplay(
        _buffer(pixels), _DISPLAY, view, _LINEAR, colorconfig=_COLOR_CONFIG
    )
    return _pixels(displayed, f"converting color to the view {view}")


def _convert(pixels: Array, source: str, target: str) -> Array:
    converted = oiio.ImageBufAlgo.colorconvert(_buffer(pixels), source, target, colorconfig=_COLOR_CONFIG)
    return _pixels(converted, f"converting color from {source} to {target}")


def _buffer(pixels: Array) -> oiio.ImageBuf:
    return oiio.ImageBuf(np.ascontiguousarray(pixels, np.float32))


def _pixels(buffer: oiio.ImageBuf, what: str) -> Array:
    check(not buffer.has_error, buffer, what, ThurstonError)
    return np.asarray(check(buffer.get_pixels("float"), buffer, what, ThurstonError))


# ---------------------------------------------------------------------------------------------------- writing


@dataclass
class _Part:
    """One part of a file: planes (H,W) by channel name, all stored as `format`."""

    name: str
    format: str  # "float", "uint" or "uint8": other spellings make OpenImageIO silently write something else
    planes: dict[str, Array]
    metadata: Mapping[str, str] = field(default_factory=dict)

    @property
    def shape(self) -> tuple[int, int]:
        height, width = next(iter(self.planes.values())).shape
        return height, width

    def spec(self) -> oiio.ImageSpec:
        height, width = self.shape
        spec = oiio.ImageSpec(width, height, len(self.planes), self.format)
        assert str(spec.format) == self.format, f"OpenImageIO took {self.format} for {spec.format}"
        spec.channelnames = tuple(self.planes)
        spec["oiio:ColorSpace"] = _SRGB if self.format == "uint8" else _LINEAR
        spec["oiio:subimagename"] = self.name
        spec["compression"] = "zip"
        spec["Software"] = "thurston_cl"
        for key, text in self.metadata.items():
            spec[_PREFIX + key] = text
        return spec

    def rows(self, band: slice, names: Sequence[str] | None = None) -> Array:
        """A band of rows, (rows, W, channels), contiguous, in the order of `names` (default: our own)."""
        return np.stack([self.planes[name][band] for name in names or self.planes], axis=-1)


def _bands(height: int) -> Iterator[slice]:
    return (slice(y, min(y + _BAND, height)) for y in range(0, height, _BAND))


def check_output(
    path: str | os.PathLike[str], channels: Sequence[str] | None = None, force: bool = False
) -> Path:
    """Say early whether a picture can be written to `path`; give back the file to write, links followed.

    Raises OutputError: wrong suffix, channels that the format cannot hold, no such directory, not writable,
    or the file exists and `force` is not given.
    """
    target = Path(os.path.realpath(path))
    suffix = target.suffix.lower()
    if suffix not in SUFFIXES:
        raise OutputError(f"{path}: a picture's name ends in {' or '.join(SUFFIXES)}")
    if channels is not None:
        wrong = [name for name in channels if name not in EVERY_CHANNEL]
        if not channels:
            raise OutputError(f"{path}: no channels are named; there are {', '.join(EVERY_CHANNEL)}")
        if wrong:
            raise OutputError(
                f"{path}: unknown channels {', '.join(wrong)}; there are {', '.join(EVERY_CHANNEL)}"
            )
        if suffix == ".png" and (len(channels) != 1 or channels[0] not in ("beauty", *HEAT_CHANNELS)):
            raise OutputError(
                f"{path}: a PNG shows beauty, depth, steps or error, one of them; "
                f"write {', '.join(channels)} to an EXR"
            )
    try:
        str(target).encode()
        with contextlib.suppress(FileNotFoundError):
            _part_path(target).lstat()  # may be longer than a name can be
        mode = target.lstat().st_mode
    except UnicodeEncodeError:
        raise OutputError(f"{os.fsencode(path)!r}: the name is not UTF-8") from None
    except FileNotFoundError:
        if not target.parent.is_dir():
            raise OutputError(f"{path}: there is no directory {target.parent}") from None
    except OSError as error:
        raise OutputError(f"{path}: {error.strerror}") from None
    else:
        if not stat.S_ISREG(mode):
            raise OutputError(f"{path}: exists and is not a file")
        if not force:
            raise OutputError(f"{path}: exists; use --force (in Python: force=True) to replace it")
    try:
        # Permissions do not tell of read-only file systems, quotas and the like: try. The file has no name.
        with tempfile.TemporaryFile(dir=target.parent):
            pass
    except OSError as error:
        raise OutputError(f"{path}: cannot write into {target.parent}: {error.strerror}") from None
    return target


def _part_path(target: Path) -> Path:
    return target.with_name(target.name + ".part")


def _save_parts(target: Path, parts: Sequence[_Part]) -> None:
    """Write, read back, compare, rename. Whatever happens, no NAME.part is left."""
    part_path = _part_path(target)
    try:
        part_path.unlink(missing_ok=True)
        _write(part_path, target, parts)
        _read_back(part_path, target, parts)
        os.replace(part_path, target)
    except OSError as error:
        raise OutputError(f"{target}: cannot be written: {error.strerror or error}") from error
    except OutputError as error:
        # OpenImageIO speaks of missing data then.
        if shutil.disk_usage(target.parent).free < _FULL:
            raise OutputError(f"{target}: cannot be written: the disk is full") from error
        raise
    finally:
        if part_path.is_file():
            part_path.unlink()


def _write(part_path: Path, target: Path, parts: Sequence[_Part]) -> None:
    what = f"{target}: cannot be written"
    # By format, since the library knows no writer for a name that ends in ".part".
    out = check(oiio.ImageOutput.create(target.suffix.lower().lstrip(".")), oiio, what)
    specs = tuple(part.spec() for part in parts)
    name = str(part_path)
    check(out.open(name, specs) if len(specs) > 1 else out.open(name, specs[0]), out, what)
    for k, part in enumerate(parts):
        if k > 0:
            check(out.open(name, specs[k], "AppendSubimage"), out, what)
        for band in _bands(part.shape[0]):
            # Stop at the first failure: OpenImageIO 3.2 waits for ever when a failed EXR is written again.
            check(out.write_scanlines(band.start, band.stop, 0, part.rows(band)), out, what)
    check(out.close(), out, what)


def _read_back(part_path: Path, target: Path, parts: Sequence[_Part]) -> None:
    """Compare the file with what was to be written: OpenImageIO closes a broken file without a word."""
    what = f"{target}: was not stored whole"
    file = check(oiio.ImageInput.open(str(part_path)), oiio, what)
    try:
        for k, part in enumerate(parts):
            check(file.seek_subimage(k, 0), file, what)
            spec = file.spec()
            names = spec.channelnames
            got_as = (spec.height, spec.width), str(spec.format), {*names}
            if got_as != (part.shape, part.format, {*part.planes}):
                raise OutputError(f"{what}: part {part.name} came back as {got_as}")
            for key, text in part.metadata.items():
                if spec.getattribute(_PREFIX + key) != text:
                    raise OutputError(f"{what}: metadata {key!r} came back changed")
            for band in _bands(spec.height):
                got = file.read_scanlines(band.start, band.stop, 0, 0, len(names), part.format)
                wanted = part.rows(band, names)
                if not np.array_equal(check(got, file, what), wanted, equal_nan=part.format == "float"):
                    raise OutputError(f"{what}: part {part.name} came back with other values")
    finally:
        file.close()


# ---------------------------------------------------------------------------------------------------- reading


def read_image(path: str | os.PathLike[str]) -> Image:
    """Read a picture that `Image.save` wrote: its channels and metadata, exact for EXR.

    A PNG has a beauty alone, brought back to linear Rec.709 as far as its 8 bits say; exposure and view, or
    of which channel it is a heat map, are told by its metadata and not undone. Raises MissingFileError where
    the file is absent, damaged or not a picture.
    """
    what = f"{path}: cannot be read"
    file = check(oiio.ImageInput.open(os.fspath(path)), oiio, what, MissingFileError)
    try:
        spec = file.spec()
        ours = (p for p in spec.extra_attribs if p.name.startswith(_PREFIX))
        metadata = {p.name.removeprefix(_PREFIX): str(p.value) for p in ours}
        if file.format_name() != "openexr":
            n = 3 if spec.nchannels >= 3 else 1
            pixels = check(file.read_image(0, 0, 0, n, "float"), file, what, MissingFileError)
            color = np.broadcast_to(pixels, (spec.height, spec.width, 3))
            return Image({"beauty": _convert(color, _SRGB, _LINEAR)}, metadata)
        planes: dict[str, Array] = {}
        for k in range(max(1, spec.get_int_attribute("oiio:subimages", 1))):
            check(file.seek_subimage(k, 0), file, what, MissingFileError)
            spec = file.spec()
            kind = "uint" if str(spec.format) == "uint" else "float"
            pixels = check(file.read_image(k, 0, 0, spec.nchannels, kind), file, what, MissingFileError)
            planes.update({name: pixels[..., c] for c, name in enumerate(spec.channelnames)})
    finally:
        file.close()
    channels = {
        channel: np.squeeze(np.stack([planes[name] for name in names], axis=2), 2 if len(names) == 1 else ())
        for channel, names in (FLOAT_CHANNELS | INTEGER_CHANNELS).items()
        if all(name in planes for name in names)
    }
    if not channels:
        raise MissingFileError(f"{what}: no channel of ours in it, only {', '.join(planes)}")
    return Image(channels, metadata)


# ----------------------------------------------------------------------------------------------- textures

# A side of a larger picture is finer than the largest picture we render, and its texels fill memory.
MOST_TEXELS = 16384


def read_texture(path: str | os.PathLike[str]) -> NDArray[np.float32]:
    """Read the colors of an image file, (H,W,3), top row first, linear Rec.709.

    From the color space that the file names, else sRGB for integers and linear for floats. Gray has three
    equal colors; alpha is ignored, and does not darken. Raises MissingFileError, its text starting with the
    path, where the file is damaged, no image, larger than MOST_TEXELS a side, or holds NaN or infinity.
    """
    pixels, spaces = _raw_colors(path)
    for space in spaces:
        converted = oiio.ImageBufAlgo.colorconvert(_buffer(pixels), space, _LINEAR, colorconfig=_FILE_CONFIG)
        # The name that a file gives may be one that OpenColorIO does not know.
        if not converted.has_error:
            break
        converted.geterror()
    colors = _pixels(converted, f"{path}: cannot be brought from {space} to {_LINEAR}")
    return np.ascontiguousarray(np.broadcast_to(colors, (*colors.shape[:2], 3)), np.float32)


def _raw_colors(path: str | os.PathLike[str]) -> tuple[NDArray[np.float32], list[str]]:
    """The colors as they stand in the file, (H,W,3), and their color spaces to try in turn."""
    as_is = oiio.ImageSpec()
    # Colors as they stand, not times alpha.
    as_is["oiio:UnassociatedAlpha"] = 1
    file = check(
        oiio.ImageInput.open(os.fspath(path), as_is),
        oiio,
        f"{path}: is no image that can be read",
        MissingFileError,
    )
    try:
        spec = file.spec()
        if max(spec.width, spec.height) > MOST_TEXELS or spec.depth > 1:
            size = f"{spec.width} x {spec.height}" + (f" x {spec.depth}" if spec.depth > 1 else "")
            raise MissingFileError(f"{path}: is {size}, more than {MOST_TEXELS} x {MOST_TEXELS} pixels")
        names = list(spec.channelnames)
        planes = [names.index(name) for name in "RGB" if name in names]
        if len(planes) < 3:
            planes = [0, 1, 2] if len(names) > 2 else [0, 0, 0]
        what = f"{path}: is damaged"
        pixels = check(file.read_image(0, 0, 0, spec.nchannels, "float"), file, what, MissingFileError)
        # Of a file cut short the library gives what there is, and says so.
        check(not file.has_error, file, what, MissingFileError)
        spaces = [_LINEAR if str(spec.format) in ("half", "float", "double") else _SRGB]
        if named := spec.getattribute("oiio:ColorSpace"):
            spaces.insert(0, str(named))
    finally:
        file.close()
    colors = np.ascontiguousarray(np.asarray(pixels).reshape(spec.height, spec.width, -1)[..., planes])
    if not np.isfinite(colors).all():
        raise MissingFileError(f"{path}: holds NaN or infinity, which is no color")
    return colors, spaces


# -------------------------------------------------------------------------------------------------- comparing


def compare(got: Array, wanted: Array, threshold: float) -> int:
    """Count the pixels that differ by more than `threshold` in any channel; (H,W) or (H,W,C).

    NaN and infinities are equal to themselves only (OpenImageIO's own comparison passes over a NaN against a
    number). Raises ValueError for arrays of different shapes.
    """
    return int(_differing(got, wanted, threshold).sum())


def _differing(got: Array, wanted: Array, threshold: float) -> NDArray[np.bool_]:
    if got.shape != wanted.shape or got.ndim not in (2, 3):
        raise ValueError(f"cannot compare pictures of the shapes {got.shape} and {wanted.shape}")
    a, b = np.asarray(got, np.float64), np.asarray(wanted, np.float64)
    with np.errstate(invalid="ignore"):
        same = (np.abs(a - b) <= threshold) | (a == b) | (np.isnan(a) & np.isnan(b))
    differs: NDArray[np.bool_] = ~same if same.ndim == 2 else ~same.all(axis=-1)
    return differs


def save_comparison(
    folder: str | os.PathLike[str], name: str, got: Array, wanted: Array, threshold: float
) -> list[Path]:
    """Write NAME-got.png, NAME-wanted.png and NAME-difference.png of two beauties (H,W,3), to be looked at.

    The difference is grey, four times as strong as it is, and pixels over `threshold` are red. It is left out
    when the sizes differ. Replaces what is there; gives back the paths.
    """
    pictures = {"got": got, "wanted": wanted}
    if got.shape == wanted.shape:
        grey = np.abs(to_srgb(got).astype(np.float32) - to_srgb(wanted)).max(axis=-1) * (4 / 255)
        shown = np.repeat(np.clip(grey, 0, 1)[..., np.newaxis], 3, axis=-1)
        shown[_differing(got, wanted, threshold)] = (1, 0, 0)
        pictures["difference"] = shown
    os.makedirs(folder, exist_ok=True)
    paths = {kind: Path(folder, f"{name}-{kind}.png") for kind in pictures}
    for kind, picture in pictures.items():
        Image({"beauty": np.asarray(picture, np.float32)}).save(paths[kind], force=True)
    return list(paths.values())
