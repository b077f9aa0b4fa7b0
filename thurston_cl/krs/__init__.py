"""Kernel-reflection sequences: trees, corals, rocks and fields of them from a few kernels and mirrors.

record = tc.krs.tree(seed=3)               # a dictionary of numbers: mirrors and kernels
model = tc.krs.Model.from_dict(record)     # on an OpenCL device
model.distance(points), model.normal(points), model.instances, model.radius, model.expand()

`Model`: distances, normals and instances of a record. `Map`: conformal maps; `tc.krs.moebius` makes them.
Recipes, each from a few words to a record: `tree`, `shrub`, `forest`, `meadow`, `coral`, `rock`, `terrain`,
`seabed`, `sponge`, `fish_school`, `palm_leaf`, `hyperbolic_forest`, `moebius_coral`; and `moebius_of`, which
bends a branching record. Angles are in radians. `json.dumps` writes a record into a scene:
`krs: {record: ...}`.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from thurston_cl.krs import moebius
    from thurston_cl.krs.model import Model
    from thurston_cl.krs.moebius import Map
    from thurston_cl.krs.recipes.coral import coral
    from thurston_cl.krs.recipes.fish_school import fish_school
    from thurston_cl.krs.recipes.forest import forest
    from thurston_cl.krs.recipes.hyperbolic_forest import hyperbolic_forest
    from thurston_cl.krs.recipes.meadow import meadow
    from thurston_cl.krs.recipes.moebius_coral import moebius_coral
    from thurston_cl.krs.recipes.moebius_of import moebius_of
    from thurston_cl.krs.recipes.palm_leaf import palm_leaf
    from thurston_cl.krs.recipes.rock import rock
    from thurston_cl.krs.recipes.shrub import shrub
    from thurston_cl.krs.recipes.sponge import sponge
    from thurston_cl.krs.recipes.terrain import seabed, terrain
    from thurston_cl.krs.recipes.tree import tree

__all__ = [
    "Map",
    "Model",
    "coral",
    "fish_school",
    "forest",
    "hyperbolic_forest",
    "meadow",
    "moebius",
    "moebius_coral",
    "moebius_of",
    "palm_leaf",
    "rock",
    "seabed",
    "shrub",
    "sponge",
    "terrain",
    "tree",
]

# Loaded when first used: scenes ask for one of their own, and models wait for the device.
_HOME = {"Map": "moebius", "Model": "model", "seabed": "recipes.terrain"}


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'thurston_cl.krs' has no attribute {name!r}")
    if name == "moebius":
        return importlib.import_module("thurston_cl.krs.moebius")
    home = _HOME.get(name, f"recipes.{name}")
    return getattr(importlib.import_module(f"thurston_cl.krs.{home}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
