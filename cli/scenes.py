"""`thurston scenes`: the scenes that come with the program."""

from __future__ import annotations

import json

import click

from thurston_cl.models import GEOMETRIES
from thurston_cl.scene.library import LibraryScene, library_scene, library_scenes


@click.command()
@click.argument("name", required=False)
@click.option("--show", is_flag=True, help="Print the text of the scene NAME instead of its path.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of text.")
def command(name: str | None, show: bool, as_json: bool) -> None:
    """List the scenes that come with thurston, or those of the geometry NAME, or say where the scene NAME is.

    A name from the list can stand wherever a command asks for a SCENE: thurston render h3/seifert-weber.

    Exit code 66 if there is no scene NAME.
    """
    if name is None or name in GEOMETRIES:
        if show:
            raise click.UsageError("--show needs the NAME of a scene")
        scenes = [scene for scene in library_scenes() if name in (None, scene.geometry)]
        click.echo(
            json.dumps({"scenes": [_entry(scene) for scene in scenes]}, indent=2)
            if as_json
            else _table(scenes)
        )
        return
    scene = library_scene(name)
    if as_json:
        text = {"text": scene.path.read_text(encoding="utf-8")} if show else {}
        click.echo(json.dumps(_entry(scene) | text, indent=2, ensure_ascii=False))
    elif show:
        click.echo(scene.path.read_text(encoding="utf-8"), nl=False)
    else:
        click.echo(scene.path)


def _entry(scene: LibraryScene) -> dict[str, str]:
    """One scene as `--json` shows it."""
    return {
        "name": scene.name,
        "path": str(scene.path),
        "title": scene.title,
        "geometry": scene.geometry,
        "comment": scene.comment,
    }


def _table(scenes: list[LibraryScene]) -> str:
    """Name, geometry and title of each scene in columns, and the head comment below."""
    name = max((len(scene.name) for scene in scenes), default=0)
    lines = []
    for scene in scenes:
        lines.append(f"{scene.name:{name}}  {scene.geometry}  {scene.title}".rstrip())
        if scene.comment:
            lines.append(f"    {scene.comment}")
    return "\n".join(lines)
