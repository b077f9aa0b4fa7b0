"""`thurston render`: from a scene to pictures in files."""

from __future__ import annotations

import contextlib
import functools
import json
import math
import os
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from thurston_cl.errors import Interrupted, NoDeviceError

from .options import (
    DEVICE,
    OTHER,
    OUTPUT,
    RENDERING,
    GroupedCommand,
    Option,
    accuracy_option,
    check_precision,
    check_size,
    device_options,
    parse_crop,
    parse_size,
    scene_options,
)

if TYPE_CHECKING:
    from thurston_cl.device import Device
    from thurston_cl.image import Image
    from thurston_cl.method import Method
    from thurston_cl.scene import Scene

# The formats, channels and views of image.py, written out: --help must not wait for OpenImageIO.
SUFFIXES = (".exr", ".png")
CHANNELS = ("beauty", "depth", "normal", "steps", "object", "cell")
EVERY_CHANNEL = ("beauty", "depth", "normal", "steps", "error", "object", "cell")
HEAT_CHANNELS = ("depth", "steps", "error")
VIEWS = ("none", "filmic", "aces")
EXPOSURE_LIMIT = 32.0
# The exit code of a picture that is not as exact as was asked for.
ACCURACY_MISSED = 3
# Pixels that --verify and --verify-mp take, at most: more are no sample any more, or take hours.
MOST_VERIFIED = 1_000_000
MOST_VERIFIED_MP = 1000


@dataclass(frozen=True)
class _Film:
    """How a PNG shows a picture: as light, or as a heat map of another channel."""

    shows: str = "beauty"
    exposure: float = 0.0
    view: str = "none"
    most: float | None = None

    def words(self, image: Image) -> dict[str, Any]:
        """What it is, for --json; `most` as it is where it was left out."""
        from thurston_cl.image import largest

        if self.shows == "beauty":
            return {"exposure": self.exposure, "view": self.view}
        return {"most": largest(image.channels[self.shows]) if self.most is None else self.most}

    def note(self, image: Image) -> str:
        """What is told of a heat map where it was left open what is black."""
        if self.shows == "beauty" or self.most is not None:
            return ""
        return f" ({self.shows}, black at {self.words(image)['most']:g})"


@dataclass(frozen=True)
class _Target:
    """A file to write, which channels of the picture it gets (None means all), and how a PNG shows it."""

    file: str
    channels: tuple[str, ...] | None
    film: _Film = _Film()


def _split_channels(ctx: click.Context, param: click.Parameter, text: str | None) -> tuple[str, ...] | None:
    if text is None:
        return None
    names = tuple(name.strip() for name in text.split(","))
    for name in names:
        if name not in EVERY_CHANNEL:
            raise click.BadParameter(f"{name!r} is not one of {', '.join(EVERY_CHANNEL)}")
    return names


def _check_suffixes(ctx: click.Context, param: click.Parameter, files: tuple[str, ...]) -> tuple[str, ...]:
    for file in files:
        if Path(file).suffix.lower() not in SUFFIXES:
            raise click.BadParameter(f"{file!r} does not end in {' or '.join(SUFFIXES)}")
    return files


def _check_exposure(ctx: click.Context, param: click.Parameter, stops: float | None) -> float | None:
    # Written so that NaN fails; click's own range lets it through.
    if stops is not None and not abs(stops) <= EXPOSURE_LIMIT:
        raise click.BadParameter(f"{stops:g} is not from {-EXPOSURE_LIMIT:g} to {EXPOSURE_LIMIT:g} stops")
    return stops


def _check_most(ctx: click.Context, param: click.Parameter, most: float | None) -> float | None:
    if most is not None and not 0 < most < math.inf:
        raise click.BadParameter(f"{most:g} is not a finite number over 0")
    return most


@click.command(cls=GroupedCommand)
@scene_options
@click.option(
    "-o",
    "--output",
    "files",
    multiple=True,
    metavar="FILE",
    callback=_check_suffixes,
    cls=Option,
    group=OUTPUT,
    help="Where to write: .png for the eye, .exr for numbers; may be given several times. "
    "[default: 'outputs' of the scene]",
)
@click.option(
    "--channels",
    metavar="NAME,...",
    callback=_split_channels,
    cls=Option,
    group=OUTPUT,
    help=f"What the .exr of -o holds. [default: {','.join(CHANNELS)}]; also error, an "
    "estimate of how far off what is shown may be seen, in radians",
)
@click.option(
    "--shows",
    type=click.Choice(("beauty", *HEAT_CHANNELS)),
    cls=Option,
    group=OUTPUT,
    help="What the .png of -o shows: the picture, or a heat map of a ray's length, its number of steps or "
    "the estimate of its error, from white for 0 to black at --most. [default: beauty]",
)
@click.option(
    "--most",
    type=float,
    metavar="NUMBER",
    callback=_check_most,
    cls=Option,
    group=OUTPUT,
    help="What is black in the heat map of --shows. [default: the largest that occurs]",
)
@click.option(
    "--exposure",
    type=float,
    metavar="STOPS",
    callback=_check_exposure,
    cls=Option,
    group=OUTPUT,
    help="How much brighter the .png of -o is; each stop doubles the light. [default: 0]",
)
@click.option(
    "--view",
    type=click.Choice(VIEWS),
    cls=Option,
    group=OUTPUT,
    help="How the .png of -o shows light brighter than a screen: cut off, bent over, or by ACES 2.0. "
    "[default: none]",
)
@click.option("--force", is_flag=True, cls=Option, group=OUTPUT, help="Replace files that exist.")
@click.option(
    "--size",
    type=parse_size,
    metavar="WxH",
    cls=Option,
    group=RENDERING,
    help="Pixels of the picture. [default: of the scene]",
)
@click.option(
    "--samples",
    type=click.IntRange(1, 4096),
    metavar="N",
    cls=Option,
    group=RENDERING,
    help="Rays for each pixel. [default: of the scene]",
)
@click.option(
    "--crop",
    type=parse_crop,
    metavar="X0,Y0,X1,Y1",
    cls=Option,
    group=RENDERING,
    help="Render these pixels only, without column X1 and row Y1; rows count from the top.",
)
@device_options
@accuracy_option
@click.option(
    "--lanes",
    type=click.Choice(["1", "4", "8", "16", "32", "64"]),
    metavar="N",
    callback=lambda ctx, param, text: text and int(text),
    cls=Option,
    group=DEVICE,
    help="Rays marched side by side: 1, 4, 8, 16, 32 or 64. [default: what suits the device]",
)
@click.option(
    "--finish",
    type=click.Choice(["packet", "refill", "auto"]),
    cls=Option,
    group=DEVICE,
    help="What lanes do whose rays end early: wait, or take new rays. [default: what the scene says]",
)
@click.option(
    "--verify",
    type=click.IntRange(1, MOST_VERIFIED),
    metavar="N",
    cls=Option,
    group=OTHER,
    help="Trace the rays of N random pixels again in double, and of the N with the largest estimated error, "
    "and tell how wrong they are; against --accuracy or the scene's, with exit code 3 where that is missed.",
)
@click.option(
    "--verify-mp",
    type=click.IntRange(1, MOST_VERIFIED_MP),
    metavar="N",
    cls=Option,
    group=OTHER,
    help="Follow the geodesics of N random pixels in 30 digits by mpmath to where their rays ended, and tell "
    "how far off these are. Slow: up to some seconds for each.",
)
@click.option(
    "--json", "as_json", is_flag=True, cls=Option, group=OTHER, help="Print statistics as JSON on stdout."
)
@click.option(
    "-q",
    "--quiet",
    is_flag=True,
    cls=Option,
    group=OTHER,
    help="Show warnings, errors and what was verified only.",
)
def command(
    scene: str,
    defines: dict[str, str],
    sets: tuple[str, ...],
    files: tuple[str, ...],
    channels: tuple[str, ...] | None,
    shows: str | None,
    most: float | None,
    exposure: float | None,
    view: str | None,
    force: bool,
    size: tuple[int, int] | None,
    samples: int | None,
    crop: tuple[int, int, int, int] | None,
    device: str | None,
    precision: str | None,
    accuracy: str | float | None,
    lanes: int | None,
    finish: str | None,
    verify: int | None,
    verify_mp: int | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Render SCENE: a file, the name of a scene that comes with the program, or - for standard input.

    Files are written beside their names and renamed when they are whole, so that an interrupted render leaves
    nothing behind; those that exist are kept unless --force is given.

    \b
      thurston render scene.yaml -o picture.png
      thurston render h3/seifert-weber -o a.exr -o a.png --size 1920x1080 --samples 16
    """
    from thurston_cl.device import choose
    from thurston_cl.image import check_output
    from thurston_cl.method import Method
    from thurston_cl.rendering import render
    from thurston_cl.scene import load_scene
    from thurston_cl.scene.choice import with_accuracy

    loaded = with_accuracy(load_scene(scene, defines=defines, sets=sets), accuracy)
    targets = _targets(loaded, files, channels, _film(files, shows, most, exposure, view))
    for target in targets:
        check_output(target.file, target.channels, force)
    check_size(loaded, size)
    if crop is not None:
        _check_crop(crop, size or loaded.render.size)
    chosen = choose(device)
    check_precision(chosen, loaded, precision, accuracy)
    if verify or verify_mp:
        _check_truth(chosen)

    start = time.perf_counter()
    written: list[str] = []
    try:
        with _Progress(sys.stderr.isatty() and not quiet) as progress, _warnings_noted() as noted:
            image = render(
                loaded,
                device=chosen,
                precision=precision,
                accuracy=accuracy,
                lanes=lanes,
                finish=finish,
                size=size,
                samples=samples,
                crop=crop,
                channels=_wanted(targets),
                progress=progress,
            )
        for target in targets:
            film = target.film
            image.save(target.file, target.channels, force, film.exposure, film.view, film.most)
            written.append(target.file)
    except KeyboardInterrupt:
        raise Interrupted(f"only {', '.join(written)} written" if written else "nothing written") from None
    seconds = time.perf_counter() - start
    _say(image, targets, seconds, noted, quiet=quiet)
    checked = _Checked()
    if verify or verify_mp:
        asked = loaded.render.accuracy if accuracy is None else accuracy
        method = Method(**image.statistics["method"])
        picture = _Picture(loaded, method, chosen, size, samples, crop)
        try:
            checked = _verify(picture, verify, verify_mp, asked)
        except KeyboardInterrupt:
            raise Interrupted("the picture is written, and not verified") from None
        # An answer that was asked for: on one of both.
        for line in () if quiet and as_json else checked.lines:
            click.echo(line, err=True)
    if as_json:
        _answer(image, targets, checked, seconds, noted)
    promised = image.statistics.get("accuracy") or {"met": True}
    if not promised["met"] or checked.missed:
        click.get_current_context().exit(ACCURACY_MISSED)


def _film(
    files: Sequence[str], shows: str | None, most: float | None, exposure: float | None, view: str | None
) -> _Film:
    """How the .png of `-o` show the picture."""
    of_light = {"--exposure": exposure, "--view": view}
    for option, value in {"--shows": shows, "--most": most, **of_light}.items():
        if value is not None and not any(_is_png(file) for file in files):
            raise click.UsageError(f"{option} says how a .png shows the picture: name one with -o FILE.png")
    if shows in HEAT_CHANNELS:
        for option, value in of_light.items():
            if value is not None:
                raise click.UsageError(
                    f"{option} is for light, and --shows {shows} for a heat map: leave out one"
                )
    elif most is not None:
        raise click.UsageError("--most says what is black in a heat map: add --shows steps or --shows depth")
    return _Film(shows or "beauty", exposure or 0.0, view or "none", most)


def _targets(
    scene: Scene, files: Sequence[str], channels: tuple[str, ...] | None, film: _Film
) -> list[_Target]:
    """What to write: the files of `-o`, else those of the scene."""
    if channels is not None and all(_is_png(file) for file in files):
        raise click.UsageError("--channels says what an .exr holds: name one with -o FILE.exr")
    if not files and not scene.outputs:
        raise click.UsageError("where to? Give -o FILE.png or -o FILE.exr, or 'outputs' in the scene")
    real = [os.path.realpath(file) for file in files]
    for index, path in enumerate(real):
        if path in real[:index]:
            raise click.UsageError(f"-o {files[index]} is given twice")
    if not files:
        return [
            _Target(
                o.file,
                (o.shows,),
                _Film(o.shows, float(o.exposure), o.view, None if o.most is None else float(o.most)),
            )
            if _is_png(o.file)
            else _Target(o.file, o.channels)
            for o in scene.outputs
        ]
    return [
        _Target(file, (film.shows,), film) if _is_png(file) else _Target(file, channels) for file in files
    ]


def _wanted(targets: Sequence[_Target]) -> tuple[str, ...]:
    """The channels that the files need: what is not asked for is not worked out."""
    wanted = {name for target in targets for name in target.channels or CHANNELS}
    return tuple(name for name in EVERY_CHANNEL if name in wanted)


def _is_png(file: str) -> bool:
    return file.lower().endswith(".png")


def _check_crop(crop: tuple[int, int, int, int], size: tuple[int, int]) -> None:
    if crop[2] > size[0] or crop[3] > size[1]:
        raise click.UsageError(
            f"--crop {','.join(map(str, crop))} reaches beyond the picture of {size[0]}x{size[1]} pixels"
        )


@dataclass(frozen=True)
class _Picture:
    """What was rendered, as thurston_cl.accuracy asks for it."""

    scene: Scene
    method: Method
    device: Device
    size: tuple[int, int] | None
    samples: int | None
    area: tuple[int, int, int, int] | None

    def ask(self, check: Callable[..., Any], count: int) -> Any:
        return check(self.scene, count, self.method, self.device, self.size, self.samples, self.area)


@dataclass(frozen=True)
class _Checked:
    """What a verification has found: lines for people, and entries of --json."""

    lines: tuple[str, ...] = ()
    entries: dict[str, Any] = field(default_factory=dict)
    # Whether an accuracy that was asked for is not there.
    missed: bool = False


def _check_truth(device: Device) -> None:
    if not device.info.fp64:
        raise NoDeviceError(
            f"{device.info.name} ({device.info.id}) has no double precision, which --verify and --verify-mp "
            "need; leave them out, or use a --device that 'thurston devices' lists with fp64"
        )


def _verify(
    picture: _Picture, count: int | None, count_mp: int | None, target: str | float | None
) -> _Checked:
    """Do what --verify and --verify-mp ask for."""
    checked = _Checked()
    if count:
        from thurston_cl.accuracy.verify import verify

        found = picture.ask(functools.partial(verify, target=target), count)
        lines = (
            f"verified in double precision, {found.seconds:.1f} s",
            *(f"  {line}" for line in found.words),
        )
        missed = target is not None and not found.reached
        checked = _Checked(lines, {"verify": found.report}, missed)
    if count_mp:
        from thurston_cl.accuracy.verify_mp import check

        exactly = picture.ask(check, count_mp)
        entries = checked.entries | {"verify_mp": exactly.report}
        checked = _Checked((*checked.lines, exactly.words), entries, checked.missed)
    return checked


class _Progress(contextlib.AbstractContextManager["_Progress"]):
    """Called with (done, total), draws a bar with the remaining time on stderr, if `shown`."""

    def __init__(self, shown: bool) -> None:
        self._shown = shown
        self._stack = contextlib.ExitStack()
        self._bar: Any = None
        self._done = 0

    def __call__(self, done: int, total: int) -> None:
        if not self._shown:
            return
        if self._bar is None:
            self._bar = self._stack.enter_context(
                click.progressbar(length=total, label="rendering", file=sys.stderr)
            )
        self._bar.update(done - self._done)
        self._done = done

    def __exit__(self, *exception: Any) -> None:
        self._stack.close()


@contextlib.contextmanager
def _warnings_noted() -> Iterator[list[str]]:
    """The texts of the warnings that are shown meanwhile."""
    noted: list[str] = []
    with warnings.catch_warnings():
        show_as_before = warnings.showwarning

        def show(message: Warning | str, *where: Any) -> None:
            noted.append(str(message))
            show_as_before(message, *where)

        warnings.showwarning = show  # type: ignore[assignment]  # it is always called in this way
        yield noted


def _say(
    image: Image,
    targets: Sequence[_Target],
    seconds: float,
    noted: list[str],
    *,
    quiet: bool,
) -> None:
    """Say on stderr what was made; a warning of what is wrong with it is also added to those `noted`."""
    statistics = image.statistics
    if lost := statistics.get("nan", 0):
        message = f"{lost} of {statistics['rays']} rays came to nothing (NaN) and show the background"
        noted.append(f"{message}; try --precision double")
        click.echo(f"thurston: warning: {noted[-1]}", err=True)
    if not quiet:
        names = ", ".join(
            target.file + (target.film.note(image) if _is_png(target.file) else "") for target in targets
        )
        how = f"{statistics['precision']} precision on {statistics['device']}"
        click.echo(f"wrote {names}: {image.width}x{image.height} in {seconds:.1f} s, {how}", err=True)
        if (promised := statistics.get("accuracy")) and promised["met"]:
            click.echo(f"accuracy: {promised['words']}", err=True)


def _answer(
    image: Image, targets: Sequence[_Target], checked: _Checked, seconds: float, noted: list[str]
) -> None:
    """All that is known of a picture, as JSON on stdout."""
    outputs = [
        {"file": target.file, "channels": target.channels or tuple(image.channels)}
        | (target.film.words(image) if _is_png(target.file) else {})
        for target in targets
    ]
    answer = {
        **image.statistics,
        **checked.entries,
        "total_seconds": seconds,
        "outputs": outputs,
        "warnings": noted,
    }
    click.echo(json.dumps(_plain(answer), indent=2, allow_nan=False))


def _plain(value: Any) -> Any:
    """A value as JSON holds it: NumPy's numbers as Python's, and null for what is not finite."""
    if isinstance(value, dict):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry) for entry in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
