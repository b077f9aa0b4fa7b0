"""`thurston explain`: what a scene calls for, what is left out, and the program that is made of it."""

from __future__ import annotations

import dataclasses
import json
import math
import shutil
import textwrap
from typing import TYPE_CHECKING

import click

from .options import (
    OTHER,
    OUTPUT,
    RENDERING,
    GroupedCommand,
    Option,
    accuracy_option,
    check_precision,
    check_size,
    device_options,
    parse_size,
    scene_options,
)

if TYPE_CHECKING:
    from thurston_cl.scene.schema import Output


@click.command(cls=GroupedCommand)
@scene_options
@device_options
@accuracy_option
@click.option(
    "--size",
    type=parse_size,
    metavar="WxH",
    cls=Option,
    group=RENDERING,
    help="Pixels of the picture, on which an accuracy depends. [default: of the scene]",
)
@click.option(
    "--source",
    "show_source",
    is_flag=True,
    cls=Option,
    group=OUTPUT,
    help="Print the assembled OpenCL source, complete, with its compiler options on top.",
)
@click.option("--json", "as_json", is_flag=True, cls=Option, group=OTHER, help="Print JSON.")
def command(
    scene: str,
    defines: dict[str, str],
    sets: tuple[str, ...],
    device: str | None,
    precision: str | None,
    accuracy: str | float | None,
    size: tuple[int, int] | None,
    show_source: bool,
    as_json: bool,
) -> None:
    """Say what SCENE calls for and what is left out of its program; nothing is compiled or rendered.

    SCENE is a file, the name of a scene that comes with the program, or - for standard input. The channel
    "cell" counts only where an output of the scene names it.
    """
    from thurston_cl.device import choose
    from thurston_cl.scene import load_scene
    from thurston_cl.scene.choice import with_accuracy
    from thurston_cl.scene.plan import make_plan

    loaded = with_accuracy(load_scene(scene, defines=defines, sets=sets), accuracy)
    chosen = choose(device)
    check_precision(chosen, loaded, precision, accuracy)
    check_size(loaded, size)
    plan = make_plan(loaded, device=chosen, size=size, precision=precision, accuracy=accuracy)
    arithmetic = plan.method.precision
    lanes = chosen.info.lane_width(arithmetic)
    options = plan.source.options(arithmetic, lanes)
    rows = {
        **plan.explain(),
        "outputs": "\n".join(map(_output_words, loaded.outputs)) or "none: the command line names them",
        "device": f"{chosen.info.id} {chosen.info.name}",
        "arithmetic": f"{arithmetic} precision, {lanes} lanes",
        "compiler options": " ".join(options),
    }
    if as_json:
        answer = {
            "explanation": rows,
            "called_for": plan.called_for,
            "method": dataclasses.asdict(plan.method),
            "accuracy": None if plan.choice is None else plan.choice.metadata,
            "left_out": plan.left_out,
            "costs": {
                name: {"work": cost.work, "count": cost.count, "share_of_first_rays": cost.share}
                for name, cost in plan.costs.items()
            },
            "sequences": [
                {
                    "levels": [dataclasses.asdict(level) for level in levels],
                    "kernels": named.sequence.instances,
                    # Infinite is no number of JSON.
                    "radius": named.sequence.radius if math.isfinite(named.sequence.radius) else None,
                }
                for named, levels in zip(plan.sequences, plan.sequence_levels, strict=True)
            ],
            "parts": plan.parts,
            "options": options,
        }
        click.echo(json.dumps(answer | ({"source": plan.source.text} if show_source else {}), indent=2))
    elif show_source:
        click.echo(f"// clBuildProgram options: {' '.join(options)}\n{plan.source.text}", nl=False)
    else:
        _print_rows(rows)


def _output_words(output: Output) -> str:
    """The file of an output, and what of the picture it holds or how it shows it."""
    if output.file.lower().endswith(".exr"):
        return f"{output.file}: {', '.join(output.channels)}"
    if output.shows != "beauty":
        black = "the largest that occurs" if output.most is None else f"{output.most:g}"
        return f"{output.file}: heat map of {output.shows}, black at {black}"
    return f"{output.file}: view {output.view}, exposure {output.exposure:+g}"


def _print_rows(rows: dict[str, str]) -> None:
    indent = max(map(len, rows)) + 2
    columns = max(shutil.get_terminal_size().columns, indent + 40)
    for heading, value in rows.items():
        lines = [
            line
            for part in value.split("\n")
            for line in textwrap.wrap(
                part,
                columns - indent,
                subsequent_indent="  " * (value.count("\n") > 0),
                break_long_words=False,
                break_on_hyphens=False,
            )
        ]
        click.echo(f"{heading:{indent}}" + ("\n" + " " * indent).join(lines))
