"""Scenes: the format, and reading them with errors that point at the line.

scene = load_scene("scene.yaml", defines={"r": "0.3"}, sets=["render.samples=16"])
"""

from .diagnostics import Diagnostic, SceneReport
from .json_schema import scene_schema
from .loader import load_scene, load_text
from .schema import Scene
from .source import Problems, SceneSource

__all__ = [
    "Diagnostic",
    "Problems",
    "Scene",
    "SceneReport",
    "SceneSource",
    "load_scene",
    "load_text",
    "scene_schema",
]
