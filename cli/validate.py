"""`thurston validate`: checks scenes and lists every mistake."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import click

from thurston_cl.errors import MissingFileError, SceneError
from thurston_cl.scene import Scene, load_scene

from .options import parse_define


@click.command()
@click.argument("scenes", nargs=-1, required=True, metavar="SCENE...")
@click.option(
    "-D",
    "--define",
    "defines",
    type=parse_define,
    multiple=True,
    metavar="NAME=VALUE",
    help="Give a param of the scenes another value.",
)
@click.option(
    "--set",
    "sets",
    multiple=True,
    metavar="KEY=VALUE",
    help="Change a key, such as render.samples=16; KEY=null leaves it out.",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of text.")
@click.pass_context
def command(
    ctx: click.Context,
    scenes: tuple[str, ...],
    defines: tuple[tuple[str, str], ...],
    sets: tuple[str, ...],
    as_json: bool,
) -> None:
    """Check scenes, and list every mistake with its line and a cure.

    SCENE is a file, the name of a library scene (see thurston scenes), or - for standard input.

    Exit code 65 if any scene is wrong, else 66 if any is missing.
    """
    answers = [_check(name, dict(defines), sets, quiet=as_json) for name in scenes]
    if as_json:
        click.echo(json.dumps({"scenes": [answer for answer, _ in answers]}, indent=2))
    codes = {code for _, code in answers}
    # A wrong scene can be mended here and now, so it is the more urgent news.
    ctx.exit(min(codes - {0}, default=0))


def _check(
    name: str, defines: dict[str, str], sets: tuple[str, ...], quiet: bool
) -> tuple[dict[str, Any], int]:
    """Check one scene and say how it went; the answer for `--json` and the exit code."""
    try:
        scene = load_scene(name, defines, sets)
    except SceneError as error:
        if not quiet:
            click.echo(str(error), err=True)
        found = [dataclasses.asdict(mistake) for mistake in getattr(error, "diagnostics", [])]
        return {"scene": name, "ok": False, "errors": found}, error.exit_code
    except MissingFileError as error:
        if not quiet:
            click.echo(f"thurston: error: {error}", err=True)
        return {"scene": name, "ok": False, "errors": [{"message": str(error)}]}, error.exit_code
    summary = _summary(scene)
    if not quiet:
        click.echo(f"{name}: ok: {summary}")
    return {"scene": name, "ok": True, "summary": summary, "errors": []}, 0


def _summary(scene: Scene) -> str:
    """What a scene holds, in one line."""
    where: str = scene.geometry
    if scene.lattice is not None:
        name = scene.lattice.name
        where += f", {'a lattice given by matrices' if name == 'given' else name}"
    lights = _count(len(scene.lights), "light") if scene.lights else "default lights"
    return f"{where}; {_count(len(scene.objects), 'object')}, {lights}"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number != 1)}"
