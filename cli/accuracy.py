"""`thurston accuracy`: what each method and precision costs, and how wrong it is."""

from __future__ import annotations

import contextlib
import functools
import math
import os
import sys
import time as clock
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from thurston_cl.errors import Interrupted, NoDeviceError, OutputError, ThurstonError
from thurston_cl.models import GEOMETRIES

from .options import DEVICE, MEASURING, OTHER, OUTPUT, GroupedCommand, Option, parse_size, scene_changes

if TYPE_CHECKING:
    from thurston_cl.accuracy.protocol import Row

PLOT_SUFFIXES = (".png", ".svg", ".pdf")
# In directions; in units of length; and in steps of one flow, as kernels/flow/steps.h has it.
MOST_DIRECTIONS = 100_000
LONGEST = 100.0
MOST_STEPS = 100_000
# Options for flows only, and for scenes only, by parameter.
FOR_FLOWS = {"geometries": "--geometry", "times": "--times", "count": "--directions", "steps": "--steps"}
FOR_SCENES = {"sets": "--set", "defines": "-D", "size": "--size"}
# What is measured where the options do not say; written out, as --help must not wait for NumPy.
TIMES, STEPS, DIRECTIONS = (6.0, 10.0), (0.1, 0.01), 10_000


def _numbers(most: float, what: str) -> Callable[[click.Context, click.Parameter, str], tuple[float, ...]]:
    """A callback that reads "6,10": numbers over 0, each once."""

    def read(ctx: click.Context, param: click.Parameter, text: str) -> tuple[float, ...]:
        values: list[float] = []
        for word in text.split(","):
            try:
                value = float(word)
            except ValueError:
                value = math.nan
            # Written so that NaN fails.
            if not 0 < value <= most:
                raise click.BadParameter(f"{word.strip()!r} is not {what} over 0, up to {most:g}")
            if value in values:
                raise click.BadParameter(f"{word.strip()} is given twice")
            values.append(value)
        return tuple(values)

    return read


def _check_plot(ctx: click.Context, param: click.Parameter, file: str | None) -> str | None:
    if file is not None and Path(file).suffix.lower() not in PLOT_SUFFIXES:
        raise click.BadParameter(f"{file!r} does not end in {', '.join(PLOT_SUFFIXES)}")
    return file


@click.command(cls=GroupedCommand)
@click.argument("scene", required=False)
@scene_changes
@click.option(
    "--geometry",
    "geometries",
    multiple=True,
    type=click.Choice(GEOMETRIES),
    cls=Option,
    group=MEASURING,
    help="Geometry to measure in without SCENE; may be given several times. [default: all eight]",
)
@click.option(
    "--times",
    default=",".join(f"{time:g}" for time in TIMES),
    show_default=True,
    metavar="T,...",
    callback=_numbers(LONGEST, "a length"),
    cls=Option,
    group=MEASURING,
    help="Lengths of the geodesics, without SCENE.",
)
@click.option(
    "--directions",
    "count",
    default=DIRECTIONS,
    show_default=True,
    type=click.IntRange(1, MOST_DIRECTIONS),
    metavar="N",
    cls=Option,
    group=MEASURING,
    help="How many directions of each of both sets, without SCENE.",
)
@click.option(
    "--steps",
    default=",".join(f"{step:g}" for step in STEPS),
    show_default=True,
    metavar="H,...",
    callback=_numbers(LONGEST, "a length"),
    cls=Option,
    group=MEASURING,
    help="Steps of the integrators, without SCENE.",
)
@click.option(
    "--size",
    type=parse_size,
    metavar="WxH",
    cls=Option,
    group=MEASURING,
    help="Pixels of the picture of SCENE. [default: about 320x180]",
)
@click.option("--json", "as_json", is_flag=True, cls=Option, group=OUTPUT, help="Print JSON.")
@click.option("--csv", "as_csv", is_flag=True, cls=Option, group=OUTPUT, help="Print CSV.")
@click.option(
    "--plot",
    "plot_file",
    metavar="FILE",
    callback=_check_plot,
    cls=Option,
    group=OUTPUT,
    help="Also draw error against time into FILE: .png, .svg or .pdf.",
)
@click.option("--force", is_flag=True, cls=Option, group=OUTPUT, help="Replace the plot if it exists.")
@click.option(
    "--device",
    metavar="DEVICE",
    cls=Option,
    group=DEVICE,
    help="cpu, gpu, an id such as 0:0, or part of a name; see 'thurston devices'.",
)
@click.option("-q", "--quiet", is_flag=True, cls=Option, group=OTHER, help="Do not show progress.")
@click.pass_context
def command(
    ctx: click.Context,
    scene: str | None,
    defines: dict[str, str],
    sets: tuple[str, ...],
    geometries: tuple[str, ...],
    times: tuple[float, ...],
    count: int,
    steps: tuple[float, ...],
    size: tuple[int, int] | None,
    as_json: bool,
    as_csv: bool,
    plot_file: str | None,
    force: bool,
    device: str | None,
    quiet: bool,
) -> None:
    """Measure what accuracy costs: time against error, by method and precision.

    Without SCENE geodesics from the origin are followed, exactly and by integrators, as in appendix A of the
    paper; that takes some minutes for all eight geometries. With SCENE, a file or the name of one that comes
    with the program, its picture is rendered with each: the first time that takes two to six minutes, most of
    them to build some twenty programs. Ctrl-C prints what is finished, and draws nothing.

    \b
      thurston accuracy --geometry nil --plot nil.png
      thurston accuracy --csv > accuracy.csv
      thurston accuracy h3/seifert-weber
    """
    if as_json and as_csv:
        raise click.UsageError("--json and --csv are two ways to print the same: leave out one")
    for name, option in (FOR_SCENES if scene is None else FOR_FLOWS).items():
        if ctx.get_parameter_source(name) is not ParameterSource.DEFAULT:
            cure = "a scene: name one" if scene is None else f"flows without a scene: leave out it or {scene}"
            raise click.UsageError(f"{option} is for {cure}")
    most = max(times) / min(steps)
    if most > MOST_STEPS:
        raise click.UsageError(
            f"--steps {min(steps):g} makes {most:.2g} steps to {max(times):g}; at most {MOST_STEPS} are made"
        )
    draw = None
    if plot_file is not None:
        _check_target(plot_file, force)
        draw = functools.partial(_draw, plot_file)
    if scene is not None:
        from .accuracy_scene import report_scene

        report_scene(
            scene,
            defines=defines,
            sets=sets,
            as_json=as_json,
            as_csv=as_csv,
            device=device,
            quiet=quiet,
            size=size,
            draw=draw,
        )
        return
    from thurston_cl.accuracy import table
    from thurston_cl.accuracy.directions import SEED
    from thurston_cl.accuracy.protocol import measure
    from thurston_cl.device import choose

    chosen = choose(device)
    if not chosen.info.fp64:
        raise NoDeviceError(
            f"{chosen.info.name} ({chosen.info.id}) has no double precision, which errors are measured "
            "against; use a --device that 'thurston devices' lists with fp64"
        )
    start = clock.perf_counter()
    rows: list[Row] = []
    interrupted = False
    wanted = tuple(dict.fromkeys(geometries)) or GEOMETRIES
    progress = _Progress(not quiet)
    work = measure(wanted, times, count, steps, chosen, progress=progress)
    try:
        with progress:
            for row in work:
                rows.append(row)
    except KeyboardInterrupt:
        interrupted = True
    seconds = clock.perf_counter() - start
    about = {
        "device": chosen.info.name,
        "directions": count,
        "seed": SEED,
        "times": times,
        "steps": steps,
        "seconds": seconds,
        "complete": not interrupted,
    }
    if as_json:
        click.echo(table.as_json(rows, **about))
    elif as_csv:
        click.echo(table.as_csv(rows), nl=False)
    elif rows:
        click.echo(table.text(rows, table.header(count, SEED, chosen.info.name)))
    if interrupted:
        raise Interrupted(f"{len(rows)} of {progress.total} rows are finished" + " and printed" * bool(rows))
    if draw is not None:
        from thurston_cl.accuracy.plot import plot

        draw(functools.partial(plot, rows))
    if not quiet:
        drawn = f", drawn in {plot_file}" if plot_file else ""
        click.echo(f"measured {len(rows)} rows in {seconds:.0f} s on {chosen.info.name}{drawn}", err=True)


def _check_target(file: str, force: bool) -> None:
    """Say before the work begins whether the plot can be drawn and written."""
    from thurston_cl.accuracy.plot import has_matplotlib

    if not has_matplotlib():
        raise ThurstonError(
            "--plot needs matplotlib, which is not installed; pip install 'thurston_cl[plot]', or "
            "leave out --plot"
        )
    target = Path(file)
    if not target.parent.is_dir():
        raise OutputError(f"{file}: there is no directory {target.parent}")
    if target.exists() and not force:
        raise OutputError(f"{file}: exists; use --force to replace it")
    if not os.access(target.parent, os.W_OK):
        raise OutputError(f"{file}: cannot write into {target.parent}")


def _draw(file: str, plot: Callable[[str], None]) -> None:
    # Under its own name it is whole or absent.
    part = Path(file).with_name(f".{Path(file).name}.part{Path(file).suffix}")
    try:
        plot(str(part))
        part.replace(file)
    except OSError as error:
        raise OutputError(f"{file}: cannot be written: {error.strerror or error}") from error
    finally:
        part.unlink(missing_ok=True)


class _Progress(contextlib.AbstractContextManager["_Progress"]):
    """Called with (done, total, next), shows on stderr how far the work is: on a terminal a bar with the
    remaining time, else a line for each geometry.
    """

    def __init__(self, shown: bool) -> None:
        self.total = 0
        self._shown = shown
        self._stack = contextlib.ExitStack()
        self._bar: Any = None
        self._done = 0
        self._geometry = ""

    def __call__(self, done: int, total: int, coming: str) -> None:
        self.total = total
        if not self._shown:
            return
        if sys.stderr.isatty():
            if self._bar is None:
                self._bar = self._stack.enter_context(
                    click.progressbar(
                        length=total, label="measuring", file=sys.stderr, item_show_func=lambda item: item
                    )
                )
            self._bar.update(done - self._done, coming)
            self._done = done
        elif (geometry := coming.partition(":")[0]) != self._geometry and geometry:
            self._geometry = geometry
            click.echo(f"{geometry}: {done} of {total} rows are finished", err=True)

    def __exit__(self, *exception: Any) -> None:
        self._stack.close()
