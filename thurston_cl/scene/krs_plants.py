"""Plants as scenes write them: trees, shrubs, forests and corals, by a few words for how they grow."""

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from annotated_types import Ge, Le
from pydantic import BeforeValidator, Field

from thurston_cl.krs.recipes.coral import coral
from thurston_cl.krs.recipes.forest import forest
from thurston_cl.krs.recipes.meadow import meadow
from thurston_cl.krs.recipes.moebius_coral import moebius_coral
from thurston_cl.krs.recipes.shrub import shrub
from thurston_cl.krs.recipes.tree import tree
from thurston_cl.krs.sequence import MOST_LEVELS

from .base import Problem, problem
from .context import Context
from .krs_recipe import Recipe, within
from .surfaces import Material, MaterialValue
from .values import Angle, Flag, Positive, Ratio, Says, Seed, Weight, color, number, whole_number

Levels = Annotated[int, Ge(1), Le(30), BeforeValidator(whole_number), Says("whole number from 1 to 30")]
Few = Annotated[int, Ge(0), Le(8), BeforeValidator(whole_number), Says("whole number from 0 to 8")]
Reach = Annotated[float, Ge(0), Le(20), BeforeValidator(number), Says("number from 0 to 20")]
Doublings = Annotated[int, Ge(1), Le(24), BeforeValidator(whole_number), Says("whole number from 1 to 24")]
Bent = Annotated[float, Ge(0), Le(0.6), BeforeValidator(number), Says("number from 0 to 0.6")]
Sowings = Annotated[int, Ge(4), Le(36), BeforeValidator(whole_number), Says("whole number from 4 to 36")]
# Wider forks, or branches that turn back, would go through those before them.
Spread = Annotated[Angle, within(5, 60), Says("angle from 5 deg to 60 deg")]
Outwards = Annotated[Angle, within(0, 70), Says("angle from 0 deg to 70 deg")]
Turn = Annotated[Angle, within(-360, 360), Says("angle from -360 deg to 360 deg")]
Roll = Annotated[Angle, within(0, 5), Says("angle from 0 deg to 5 deg")]

_SPREAD = "How far the two branches of the first fork turn aside, on average; later forks are {}."
_TURN = "By how much the plane of a fork turns about the branch from one fork to the next."
_RATIO = "Length of a branch, in that of the one before it."
_UPRIGHT = "From 0, branches curl around to {}, to 1, all grow upwards to a flat top."
_LEAVES = "How often the leaves of a twig are doubled: it has 2^(leaves + 1) − 2 of them, and 0 has none."
_SEED = "Another number is another {}."
_BARK = Material(color=color("#6b4f3c"), specular=0.05, diffuse=0.85)
_LEAF = Material(color=color("#4c8a2f"), specular=0.1, diffuse=0.8)
_SOIL = Material(color=color("#6f7a45"), specular=0.0, diffuse=0.9)
_GRASS = Material(color=color("#7da23e"), specular=0.0, diffuse=0.8, ambient=0.2)
_BODY = Material(color=color("#c4573f"))
_TIP = Material(color=color("#f2dcc6"))


def _whether(value: object) -> object:
    if isinstance(value, dict):
        cure = "the ground's material is 'soil': write 'soil: {color: ...}'"
        raise problem("expected true or false, found a mapping", cure)
    return value


def _material(default: Material, what: str, looks: str) -> Any:
    """The field of the material of something, and what it looks like if it is left out."""
    description = f"The material of {what}. Left out: {looks}."
    return Field(default=default, description=description, json_schema_extra={"default": "see there"})


class Plant(Recipe):
    """What all plants have: at most so many levels together."""

    # The fields that count levels.
    counted: ClassVar[tuple[str, ...]] = ()

    def check(self, context: Context) -> Iterator[Problem]:
        count = sum(getattr(self, key) for key in self.counted) + self._uncounted()
        if count > MOST_LEVELS:
            largest = max(self.counted, key=lambda key: getattr(self, key))
            named = f"{', '.join(self.counted[:-1])} and {self.counted[-1]}"
            message = f"{named} make {count} mirrors together; at most {MOST_LEVELS} are possible"
            yield Problem((largest,), message, f"take {count - MOST_LEVELS} off '{largest}'")

    @classmethod
    def _uncounted(cls) -> int:
        """Mirrors besides: the last branch of a route does not fork."""
        return -1


class Tree(Plant):
    """A tree (KRS paper, 9.2), at the origin, on the ground z = 0, which is not part of it. It is about 4
    trunks high and as wide, with 4096 twigs, each with 14 leaves. Its branches are mirror images of those of
    one route from trunk to twig, found by chance from the seed."""

    what = "a tree"
    example = "tree: {seed: 3, spread: 26 deg, bark: {color: sienna}, leaf: {color: olivedrab}}"
    roles: ClassVar[tuple[str, ...]] = ("bark", "leaf")
    counted: ClassVar[tuple[str, ...]] = ("levels", "leaves")
    hints: ClassVar[Mapping[str, str]] = {
        "height": "write 'trunk', the length of the trunk: a tree is about 4 times as high",
        "angle": "did you mean 'spread'?",
        "material": "a tree has two: 'bark' and 'leaf'",
        "color": "write 'bark: {color: ...}' and 'leaf: {color: ...}'",
        "at": "'at' stands beside 'krs', not inside it",
    }

    levels: Levels = Field(
        default=13,
        description="How many branches follow each other from the trunk to a twig, both included. Each level "
        "doubles the twigs.",
    )
    spread: Spread = Field(
        default=math.radians(26),
        description=_SPREAD.format("wider, by up to 20 deg"),
        json_schema_extra={"default": "26 deg"},
    )
    turn: Turn = Field(
        default=math.radians(137.5), description=_TURN, json_schema_extra={"default": "137.5 deg"}
    )
    trunk: Positive = Field(default=1.7, description="Length of the trunk.")
    ratio: Ratio = Field(default=0.85, description=_RATIO)
    thickness: Positive = Field(default=0.4, description="Diameter of the trunk.")
    upright: Weight = Field(default=0.7, description=_UPRIGHT.format("a ball"))
    leaves: Few = Field(default=3, description=_LEAVES)
    leaf_size: Positive = Field(default=0.2, alias="leaf-size", description="Diameter of a leaf.")
    seed: Seed = Field(default=0, description=_SEED.format("tree"))
    bark: MaterialValue = _material(_BARK, "branches", "brown")
    leaf: MaterialValue = _material(_LEAF, "leaves", "green")

    def record(self) -> Mapping[str, Any]:
        return tree(**self._growth())

    def _growth(self) -> dict[str, Any]:
        """The parameters of the recipe."""
        return {key: getattr(self, key) for key in type(self).model_fields if key not in self.roles}


class Forest(Tree):
    """A forest (KRS paper, 9.2) of mirror images of one tree. Put two or three of them into one scene, with
    other seeds and spacings, and the eye finds no mirror any more."""

    what = "a forest"
    example = "forest: {doublings: 10, spacing: 7, seed: 3}"
    roles = ("bark", "leaf", "soil")
    counted = ("levels", "leaves", "doublings")
    hints: ClassVar[Mapping[str, str]] = {
        **Tree.hints,
        **dict.fromkeys(("trees", "count"), "write 'doublings': 10 are up to 1024 trees"),
        "material": "a forest has three: 'bark', 'leaf' and 'soil'",
    }

    doublings: Doublings = Field(
        default=10,
        description="How often the trees are doubled: 10 are up to 1024 trees, less those that mirrors cut.",
    )
    spacing: Positive = Field(
        default=7.0,
        description="About how far it is from one tree to the next; where crowns meet they are cut off.",
    )
    scatter: Outwards = Field(
        default=math.radians(20),
        description="How far mirrors are turned out of a square lattice, at most.",
        json_schema_extra={"default": "20 deg"},
    )
    roll: Roll = Field(
        default=math.radians(1.2),
        description="How far mirrors lean, about: the more, the more the ground rises and falls.",
        json_schema_extra={"default": "1.2 deg"},
    )
    ground: Annotated[Flag, BeforeValidator(_whether)] = Field(
        default=True,
        description="Whether the ground is part of it. If not, all trees stand on z = 0, without `roll`.",
    )
    soil: MaterialValue = _material(_SOIL, "the ground", "as green as dry grass")

    def record(self) -> Mapping[str, Any]:
        return forest(**self._growth())


class Shrub(Plant):
    """A shrub: many thin stems out of the ground around the origin, on the ground z = 0, which is not part of
    it; about 4 stems high and 7 wide."""

    what = "a shrub"
    example = "shrub: {seed: 3, stems: 3, leaf: {color: olivedrab}}"
    roles = ("bark", "leaf")
    counted = ("stems", "levels", "leaves")
    hints: ClassVar[Mapping[str, str]] = {
        "height": "write 'stem', the length of a stem: a shrub is about 4 times as high",
        "trunk": "did you mean 'stem'?",
        "angle": "did you mean 'spread'?",
        "material": "a shrub has two: 'bark' and 'leaf'",
        "color": "write 'bark: {color: ...}' and 'leaf: {color: ...}'",
        "at": "'at' stands beside 'krs', not inside it",
    }

    stems: Few = Field(default=3, description="How often the stems are doubled: 3 are 8 stems.")
    levels: Levels = Field(
        default=9, description="How many branches follow each other from a stem to a twig, both included."
    )
    spread: Spread = Field(
        default=math.radians(26),
        description=_SPREAD.format("wider, by up to 20 deg"),
        json_schema_extra={"default": "26 deg"},
    )
    outwards: Outwards = Field(
        default=math.radians(28),
        description="How far stems lean outwards, about.",
        json_schema_extra={"default": "28 deg"},
    )
    turn: Turn = Field(
        default=math.radians(137.5), description=_TURN, json_schema_extra={"default": "137.5 deg"}
    )
    stem: Positive = Field(default=0.5, description="Length of a stem up to its first fork.")
    ratio: Ratio = Field(default=0.82, description=_RATIO)
    thickness: Positive = Field(default=0.05, description="Diameter of a stem.")
    upright: Weight = Field(default=0.45, description=_UPRIGHT.format("balls"))
    leaves: Few = Field(default=3, description=_LEAVES)
    leaf_size: Positive = Field(default=0.12, alias="leaf-size", description="Diameter of a leaf.")
    seed: Seed = Field(default=0, description=_SEED.format("shrub"))
    bark: MaterialValue = _material(_BARK, "branches", "brown")
    leaf: MaterialValue = _material(_LEAF, "leaves", "green")

    def record(self) -> Mapping[str, Any]:
        return shrub(**{key: getattr(self, key) for key in type(self).model_fields if key not in self.roles})


class Meadow(Plant):
    """A meadow about the origin, blade by blade, on the ground z = 0, which is not part of it: put a
    half-space below it, in the color of the grass from afar."""

    what = "a meadow"
    example = "meadow: {doublings: 26, blade: 0.3, seed: 5, grass: {color: yellowgreen}}"
    roles = ("grass",)
    counted = ("doublings",)
    hints: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("size", "width"), "write 'doublings': each two more make it twice as wide"),
        **dict.fromkeys(("height", "length"), "did you mean 'blade'?"),
        **dict.fromkeys(("color", "material"), "write 'grass: {color: ...}'"),
        "at": "'at' stands beside 'krs', not inside it",
    }

    doublings: Sowings = Field(
        default=24,
        description="How often four blades are doubled: 24 are a meadow some 150 blades wide; each two more "
        "make it twice as wide.",
    )
    blade: Positive = Field(default=0.3, description="Length of the longest blades.")
    thickness: Positive = Field(default=0.02, description="Diameter of a blade.")
    seed: Seed = Field(default=0, description=_SEED.format("meadow"))
    grass: MaterialValue = _material(_GRASS, "the blades", "green")

    def record(self) -> Mapping[str, Any]:
        return meadow(**{key: getattr(self, key) for key in type(self).model_fields if key not in self.roles})

    @classmethod
    def _uncounted(cls) -> int:
        return 0


class Coral(Plant):
    """A coral (KRS paper, 9.1 and 9.2), at the origin, on the ground z = 0, which is not part of it; about 5
    limbs high and 7 wide."""

    what = "a coral"
    example = "coral: {seed: 3, body: {color: coral}, tip: {color: seashell}}"
    roles = ("body", "tip")
    counted = ("stems", "levels", "buds")
    hints: ClassVar[Mapping[str, str]] = {
        "height": "write 'limb', the length of the second branch: a coral is about 5 times as high",
        "angle": "did you mean 'spread'?",
        "polyps": "did you mean 'buds'?",
        "material": "a coral has two: 'body' and 'tip'",
        "color": "write 'body: {color: ...}' and 'tip: {color: ...}'",
        "at": "'at' stands beside 'krs', not inside it",
    }

    stems: Few = Field(
        default=0, description="How often stems out of the ground are doubled: 2 are 4 stems side by side."
    )
    levels: Levels = Field(
        default=10,
        description="How many branches follow each other from the ground to a tip, both included. Each level "
        "doubles the tips.",
    )
    spread: Spread = Field(
        default=math.radians(34),
        description=_SPREAD.format("as wide"),
        json_schema_extra={"default": "34 deg"},
    )
    turn: Turn = Field(default=math.radians(100), description=_TURN, json_schema_extra={"default": "100 deg"})
    trunk: Positive = Field(default=0.35, description="Length of the first branch, out of the ground.")
    limb: Positive = Field(default=0.6, description="Length of the second branch.")
    ratio: Ratio = Field(default=0.86, description="Length of every other branch, in that of the one before.")
    thickness: Positive = Field(default=0.3, description="Diameter of the first branch.")
    taper: Ratio = Field(default=0.86, description="Thickness of a branch, in that of the one before it.")
    upright: Weight = Field(default=0.5, description=_UPRIGHT.format("balls"))
    buds: Few = Field(
        default=2, description="How often the buds around a tip are doubled: 2^(buds + 1) − 2 of them."
    )
    bend: Bent = Field(
        default=0.0,
        description="How strongly each part is bent and scaled in its own way, so that no branch equals "
        "another: 0.2 shows, 0.6 is wild. With 0 branches are mirror images of each other; with more it is "
        "a [Moebius sequence](#moebius-level), which takes longer.",
    )
    tip_length: Reach = Field(
        default=0.0,
        alias="tip-length",
        description="By how much a tip is drawn out into a finger, in diameters of its branch; 0 is a ball.",
    )
    seed: Seed = Field(default=0, description=_SEED.format("coral"))
    body: MaterialValue = _material(_BODY, "branches and buds", "red")
    tip: MaterialValue = _material(_TIP, "tips", "pale")

    def record(self) -> Mapping[str, Any]:
        apart = (*self.roles, "bend")
        growth = {key: getattr(self, key) for key in type(self).model_fields if key not in apart}
        return moebius_coral(strength=self.bend, **growth) if self.bend > 0 else coral(**growth)

    @classmethod
    def _uncounted(cls) -> int:
        return 0
