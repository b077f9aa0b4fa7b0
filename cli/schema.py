"""`thurston schema`: the JSON Schema of scenes, for editors."""

from __future__ import annotations

import json

import click

from thurston_cl.scene import scene_schema


@click.command()
def command() -> None:
    """Print the JSON Schema (draft 7) of scenes, for editors.

    Save it beside your scenes and begin each with the line

    # yaml-language-server: $schema=scene.schema.json

    so that an editor with a YAML language server completes keys, explains them and marks mistakes.
    """
    click.echo(json.dumps(scene_schema(), indent=2, ensure_ascii=False))
