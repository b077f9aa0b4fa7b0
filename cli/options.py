"""The options that several commands share, values such as 640x480, and help that shows options in groups."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

from thurston_cl.errors import NoDeviceError

if TYPE_CHECKING:
    from thurston_cl.device import Device
    from thurston_cl.scene import Scene

SCENE = "Scene"
OUTPUT = "Output"
RENDERING = "Rendering"
MEASURING = "Measuring"
DEVICE = "Device"
OTHER = "Other"

MOST_PIXELS = 16384  # in a row or column; what a scene accepts

Command = TypeVar("Command", bound=Callable[..., Any])


class Option(click.Option):
    """An option that stands under the heading `group` in the help text."""

    def __init__(self, *arguments: Any, group: str = OTHER, **attributes: Any) -> None:
        super().__init__(*arguments, **attributes)
        self.group = group


class GroupedCommand(click.Command):
    """A command whose help text shows its options in groups."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        groups: dict[str, list[tuple[str, str]]] = {
            group: [] for group in (SCENE, MEASURING, OUTPUT, RENDERING, DEVICE, OTHER)
        }
        for option in self.get_params(ctx):
            record = option.get_help_record(ctx)
            if record is not None and isinstance(option, click.Option):
                groups[getattr(option, "group", OTHER)].append(record)
        for heading, records in groups.items():
            if records:
                with formatter.section(heading):
                    formatter.write_dl(records)


def parse_size(text: str) -> tuple[int, int]:
    """The type of an option for width and height in pixels."""
    width, height = map(int, _match(r"([0-9]+)[xX×]([0-9]+)", text, "WxH, for example 960x540"))
    if not (1 <= width <= MOST_PIXELS and 1 <= height <= MOST_PIXELS):
        raise click.BadParameter(f"{text!r}: width and height are from 1 to {MOST_PIXELS} pixels")
    return width, height


def parse_crop(text: str) -> tuple[int, int, int, int]:
    """The type of an option for a rectangle: first column and row, then the column and row after the last."""
    number = "([0-9]+)"
    x0, y0, x1, y1 = map(int, _match(",".join([number] * 4), text, "X0,Y0,X1,Y1, for example 0,0,480,270"))
    if x0 >= x1 or y0 >= y1:
        raise click.BadParameter(f"{text!r} holds no pixel: X0 < X1 and Y0 < Y1 are needed")
    return x0, y0, x1, y1


def parse_define(text: str) -> tuple[str, str]:
    """The type of an option for the name of a param and its value."""
    name, value = _match("([^=]+)=(.*)", text, "NAME=VALUE, for example radius=0.3")
    return name.strip(), value


def _match(pattern: str, text: str, form: str) -> tuple[str, ...]:
    found = re.fullmatch(pattern, text, re.DOTALL)
    if not found:
        raise click.BadParameter(f"{text!r} is not of the form {form}")
    return found.groups()


def scene_options(function: Command) -> Command:
    """SCENE and what changes it: the arguments `scene`, `defines` (a dict) and `sets`."""
    return scene_changes(click.argument("scene")(function))


def scene_changes(function: Command) -> Command:
    """What changes a scene: the arguments `defines` (a dict) and `sets`."""
    for decorate in (
        click.option(
            "--set",
            "sets",
            multiple=True,
            metavar="KEY=VALUE",
            cls=Option,
            group=SCENE,
            help="Change a key of the scene, as in --set render.samples=16; KEY=null leaves it out.",
        ),
        click.option(
            "-D",
            "--define",
            "defines",
            type=parse_define,
            metavar="NAME=VALUE",
            multiple=True,
            callback=lambda ctx, param, pairs: dict(pairs),
            cls=Option,
            group=SCENE,
            help="Give a param of the scene another value.",
        ),
    ):
        function = decorate(function)
    return function


def _parse_accuracy(ctx: click.Context, param: click.Parameter, text: str | None) -> str | float | None:
    if text is None:
        return None
    from pydantic_core import PydanticCustomError

    from thurston_cl.scene.values import accuracy

    is_number = re.fullmatch(r"\s*[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?\s*", text)
    try:
        return accuracy(float(text) if is_number else text)
    except PydanticCustomError as error:
        help = (error.context or {}).get("help")
        raise click.BadParameter(f"{error.message()}; {help}" if help else error.message()) from error


def accuracy_option(function: Command) -> Command:
    """How exact a picture is to be: the argument `accuracy`, a word or an angle in radians, None where
    not given.
    """
    return click.option(
        "--accuracy",
        metavar="WORD|ANGLE",
        callback=_parse_accuracy,
        cls=Option,
        group=RENDERING,
        help="Take the cheapest method that shows 99.9 % of the pixels that exactly: half-pixel, "
        "quarter-pixel, draft, reference, or an angle such as '1e-5 rad'. [default: of the scene]",
    )(function)


def check_size(scene: Scene, size: tuple[int, int] | None) -> None:
    """UsageError for a --size that the scene's projection cannot have."""
    from thurston_cl.scene.picture import fitting_size, size_problem

    shape = scene.camera.projection.kind, scene.camera.layout
    if size and (problem := size_problem(*shape, size)):
        width, height = fitting_size(*shape, size)
        message = f"--size {size[0]}x{size[1]}: {problem[0]}; for example --size {width}x{height}"
        raise click.UsageError(message)


def check_precision(
    device: Device, scene: Scene, precision: str | None, accuracy: str | float | None
) -> None:
    """NoDeviceError if the device lacks the arithmetic that is asked for. An accuracy takes what there is."""
    if precision is None and accuracy is None and scene.render.accuracy is None:
        precision = scene.render.precision
    if precision == "double" and not device.info.fp64:
        raise NoDeviceError(
            f"{device.info.name} ({device.info.id}) has no double precision; "
            "use --precision single, or a --device that 'thurston devices' lists with fp64"
        )


def device_options(function: Command) -> Command:
    """Where and in which arithmetic to compute: `device` and `precision`, None where not given."""
    for decorate in (
        click.option(
            "--precision",
            type=click.Choice(["single", "double"]),
            cls=Option,
            group=DEVICE,
            help="Arithmetic of the kernels. [default: what the scene says]",
        ),
        click.option(
            "--device",
            metavar="DEVICE",
            cls=Option,
            group=DEVICE,
            help="cpu, gpu, an id such as 0:0, or part of a name; see 'thurston devices'.",
        ),
    ):
        function = decorate(function)
    return function
