"""Recipes in curved spaces as scenes write them."""

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from annotated_types import Ge, Le
from pydantic import BeforeValidator, Field

from thurston_cl.krs.recipes.hyperbolic_forest import hyperbolic_forest
from thurston_cl.krs.sequence import MOST_LEVELS

from .base import Problem
from .context import Context
from .krs_recipe import Recipe, within
from .surfaces import Material, MaterialValue
from .values import Angle, NotNegative, Positive, Ratio, Says, Seed, Weight, color, whole_number

Doublings = Annotated[int, Ge(1), Le(30), BeforeValidator(whole_number), Says("whole number from 1 to 30")]
Forks = Annotated[int, Ge(1), Le(10), BeforeValidator(whole_number), Says("whole number from 1 to 10")]
Few = Annotated[int, Ge(0), Le(6), BeforeValidator(whole_number), Says("whole number from 0 to 6")]
Spread = Annotated[Angle, within(5, 60), Says("angle from 5 deg to 60 deg")]


def _material(tint: str, description: str) -> Any:
    """The field of a dull material of some color."""
    default = Material(color=color(tint), ambient=0.3, diffuse=0.7, specular=0.0)
    return Field(default=default, description=description, json_schema_extra={"default": "see there"})


class HyperbolicForest(Recipe):
    """A forest on the plane z = 0 of hyperbolic space. The plane is tiled with pentagons all of whose angles
    are right, four of them around each corner, and in each stands a tree, the first at the origin. All of
    them are images of one: each mirror doubles the forest."""

    what = "a hyperbolic forest"
    example = "hyperbolic-forest: {seed: 3, height: 0.9, leaf: {color: olivedrab}}"
    roles: ClassVar[tuple[str, ...]] = ("bark", "leaf", "ground", "stone")
    geometries: ClassVar[tuple[str, ...]] = ("h3",)
    hints: ClassVar[Mapping[str, str]] = {
        "trees": "write 'doublings': there are 2^doublings trees",
        "levels": "write 'doublings' for the forest, 'forks' and 'foliage' for its trees",
        "density": "each tree has a pentagon of area 1.571 for itself, whatever its sides are",
        "material": "a forest has four: 'bark', 'leaf', 'ground' and 'stone'",
        "color": "write 'bark: {color: ...}', and so on for 'leaf', 'ground' and 'stone'",
        "at": "'at' stands beside 'krs', not inside it",
    }

    doublings: Doublings = Field(
        default=22,
        description="Mirrors on the ground: there are 2^doublings trees. 10 reach about 2 around the first, "
        "22 about 3.",
    )
    height: Positive = Field(
        default=0.9,
        description="Length of a tree along its branches, trunk included. One that would not fit in its "
        "cell, whose sides are about 0.6 from the trunk, is smaller.",
    )
    forks: Forks = Field(
        default=8, description="How often branches fork on the way from the trunk to a twig."
    )
    foliage: Few = Field(
        default=5,
        description="How often the leaves of a twig are doubled: it has 2^(foliage + 1) − 2 of them; 0 has "
        "none.",
    )
    spread: Spread = Field(
        default=math.radians(27),
        description="How far branches turn aside at a fork, or more where they would touch each other.",
        json_schema_extra={"default": "27 deg"},
    )
    ratio: Ratio = Field(default=0.8, description="Length of a branch, in that of the one before it.")
    thickness: Positive = Field(default=0.075, description="Diameter of the trunk.")
    leaf_size: Positive = Field(default=0.019, alias="leaf-size", description="Diameter of a leaf, a ball.")
    wall: NotNegative = Field(
        default=0.018,
        description="Diameter of the walls between the cells, half above the ground; 0 has none.",
    )
    irregular: Weight = Field(
        default=0.8, description="How different the sides of a cell are; 0 is the regular pentagon."
    )
    seed: Seed = Field(default=0, description="Another number is another forest.")
    bark: MaterialValue = _material("#7d5a42", "What branches are made of. Left out: brown.")
    leaf: MaterialValue = _material("#86a838", "What leaves are made of. Left out: green.")
    ground: MaterialValue = _material("#c9b273", "What the plane is made of. Left out: dry grass.")
    stone: MaterialValue = _material("#f0e4d0", "What walls are made of. Left out: nearly white.")

    def check(self, context: Context) -> Iterator[Problem]:
        count = self.doublings + self.forks + self.foliage
        if count > MOST_LEVELS:
            message = (
                f"doublings, forks and foliage make {count} mirrors together; at most {MOST_LEVELS} can be"
            )
            yield Problem(("doublings",), message, f"take {count - MOST_LEVELS} off 'doublings'")

    def record(self) -> Mapping[str, Any]:
        parameters = (key for key in type(self).model_fields if key not in self.roles)
        return hyperbolic_forest(**{key: getattr(self, key) for key in parameters})
