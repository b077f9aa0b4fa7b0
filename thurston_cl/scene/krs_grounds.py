"""Rocks, land, sponges, schools of fish and fronds as scenes write them, by a few words for how they are."""

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Ge, Le
from pydantic import BeforeValidator, Field

from thurston_cl.krs.recipes.fish_school import fish_school
from thurston_cl.krs.recipes.palm_leaf import palm_leaf
from thurston_cl.krs.recipes.rock import rock
from thurston_cl.krs.recipes.sponge import SKIN_LEVELS, sponge
from thurston_cl.krs.recipes.terrain import SEABED, terrain

from .base import Problem
from .context import Context
from .krs_recipe import Recipe, within
from .surfaces import Material, MaterialValue
from .values import Angle, Positive, Says, Seed, Weight, color, number, whole_number

RockLevels = Annotated[int, Ge(6), Le(40), BeforeValidator(whole_number), Says("whole number from 6 to 40")]
LandLevels = Annotated[int, Ge(4), Le(40), BeforeValidator(whole_number), Says("whole number from 4 to 40")]
SkinLevels = Annotated[int, Ge(7), Le(40), BeforeValidator(whole_number), Says("whole number from 7 to 40")]
Few = Annotated[int, Ge(0), Le(8), BeforeValidator(whole_number), Says("whole number from 0 to 8")]
Doublings = Annotated[int, Ge(1), Le(12), BeforeValidator(whole_number), Says("whole number from 1 to 12")]
Strength = Annotated[float, Ge(0), Le(2), BeforeValidator(number), Says("number from 0 to 2")]
PartOf = Annotated[float, Ge(0.05), Le(1), BeforeValidator(number), Says("number from 0.05 to 1")]
Taper = Annotated[float, Ge(0), Le(4), BeforeValidator(number), Says("number from 0 to 4")]
Apart = Annotated[float, Ge(2), Le(10), BeforeValidator(number), Says("number from 2 to 10")]
# Mirrors that lean more make walls.
Lean = Annotated[Angle, within(0, 15), Says("angle from 0 deg to 15 deg")]
Slope = Annotated[Angle, within(0.1, 80), Says("angle from 0.1 deg to 80 deg")]
Aside = Annotated[Angle, within(0, 60), Says("angle from 0 deg to 60 deg")]

_SEED = "Another number is another {}."
_AT = {"at": "'at' stands beside 'krs', not inside it"}
_ONE_MATERIAL = {"color": "write 'material: {color: ...}'"} | _AT


def _degrees(default: float, description: str) -> Any:
    """A field that holds an angle, with a default that the reference shows in degrees."""
    shown: dict[str, Any] = {"default": f"{default:g} deg"}
    return Field(default=math.radians(default), description=description, json_schema_extra=shown)


def _matte(name: str) -> Material:
    return Material(color=color(name), specular=0.05, diffuse=0.85)


class Ground(Recipe):
    """What all these have: fields that are the parameters of the recipe, besides materials."""

    @property
    def parameters(self) -> dict[str, Any]:
        """The parameters of the recipe, by their names."""
        return {key: getattr(self, key) for key in type(self).model_fields if key not in self.roles}


class Rock(Ground):
    """A rock about the center (KRS paper, 9.1): one plane, which mirrors fold over a ball into facets."""

    what = "a rock"
    example = "rock: {radius: 1.5, seed: 3, material: {color: slategray}}"
    roles: ClassVar[tuple[str, ...]] = ("material",)
    hints: ClassVar[Mapping[str, str]] = {"size": "did you mean 'radius'?"} | _ONE_MATERIAL

    radius: Positive = Field(
        default=1.0, description="About how large it is: its surface is 0.4 to 1.8 of this from the center."
    )
    levels: RockLevels = Field(
        default=14, description="How many mirrors fold it. Each one more makes facets half as large in area."
    )
    roughness: Strength = Field(
        default=1.0, description="0 is a cut stone, 1 a battered one; towards 2 it falls apart into lumps."
    )
    smooth: Strength = Field(
        default=1.0,
        description="Over how much of a facet shading hides its edges; 0 keeps them. It hides more of facets "
        "that are small.",
    )
    seed: Seed = Field(default=4, description=_SEED.format("rock"))
    material: MaterialValue = Field(
        default=_matte("#8d857a"), description="What it is made of. Left out: a gray."
    )

    def record(self) -> Mapping[str, Any]:
        return rock(**self.parameters)


class Terrain(Ground):
    """Land about the level z = 0 (KRS paper, 9.1): one slope, which mirrors fold over a square into hills. It
    goes on without end, but beyond the square without detail."""

    what = "a terrain"
    example = "terrain: {size: 200, slope: 16 deg, roughness: 4 deg, seed: 11}"
    roles: ClassVar[tuple[str, ...]] = ("material",)
    hints: ClassVar[Mapping[str, str]] = {
        "height": "write 'slope', how steep it is: hills are as high as that makes them",
        "width": "did you mean 'size'?",
    } | _ONE_MATERIAL

    form: Literal["land", "seabed"] = Field(
        default="land",
        description="What it is like unless other keys say so: `land`, or the `seabed`, which is gentle and "
        "has ripples of sand that run along y: size 60, levels 14, roughness 1 deg, slope 9 deg, steepest "
        "18 deg, wander 10 deg, ripples 4 and seed 3.",
    )
    size: Positive = Field(default=300.0, description="Side of the square, its middle at the origin.")
    levels: LandLevels = Field(
        default=22, description="How many mirrors fold it. Two more halve the smallest facets."
    )
    roughness: Lean = _degrees(
        6,
        "Standard deviation of how far mirrors lean. Slopes on the two sides of a mirror differ "
        "by twice that.",
    )
    slope: Slope = _degrees(11, "How steep the slope is that all others come from.")
    steepest: Slope = _degrees(50, "Mirrors lean less where slopes would be steeper than this.")
    smooth: Strength = Field(
        default=1.0, description="Over how much of a slope shading hides its edges; 0 keeps them."
    )
    wander: Aside = _degrees(20, "How irregularly ridges run; from 0 deg, in straight lines.")
    ripples: Few = Field(
        default=0,
        description="How many of the levels make parallel ripples, as steep as the slope, instead of hills.",
    )
    seed: Seed = Field(default=7, description=_SEED.format("landscape"))
    material: MaterialValue = Field(
        default=_matte("#7d8452"), description="What it is made of. Left out: dull green."
    )

    @classmethod
    def fill(cls, data: dict[str, Any], context: Context) -> None:
        if data.get("form") == "seabed":
            for key, value in SEABED.items():
                angle = key in ("roughness", "slope", "steepest", "wander")
                data.setdefault(key, f"{math.degrees(value):.10g} deg" if angle else value)
            data.setdefault("material", _matte("#cdbb8a"))

    def check(self, context: Context) -> Iterator[Problem]:
        if self.slope >= self.steepest:
            degrees = f"{math.degrees(self.slope):.10g}"
            message = f"the slope is {degrees} deg, and the steepest one has to be steeper"
            yield Problem(("slope",), message, f"write more than {degrees} deg for 'steepest'")
        if self.ripples >= self.levels:
            message = f"of {self.levels} levels at most {self.levels - 1} make ripples"
            cure = f"write 'ripples: {self.levels - 1}' or 'levels: {self.ripples + 1}'"
            yield Problem(("ripples",), message, cure)

    def record(self) -> Mapping[str, Any]:
        return terrain(**{key: value for key, value in self.parameters.items() if key != "form"})


class Sponge(Ground):
    """A sponge about the center (KRS paper, figure 10): rings around pores, layer upon layer. It
    needs shadows to show how deep they are."""

    what = "a sponge"
    example = "sponge: {radius: 0.5, seed: 3, material: {color: goldenrod}}"
    roles: ClassVar[tuple[str, ...]] = ("material",)
    hints: ClassVar[Mapping[str, str]] = {
        "size": "did you mean 'radius'?",
        "pores": "write 'levels': each one more makes pores half as large",
    } | _ONE_MATERIAL

    radius: Positive = Field(default=1.0, description="About how large it is.")
    levels: SkinLevels = Field(
        default=14, description="How many mirrors fold it. Each one more makes pores half as large in area."
    )
    layers: Few = Field(
        default=4,
        description="How many of the levels fold its skin, which is 2^layers layers of pores thick; it has "
        "no more than there are levels beyond 7. 0 is a hollow shell.",
    )
    threads: Weight = Field(default=0.5, description="How thick is what stands between pores.")
    lumps: Strength = Field(default=1.0, description="0 is nearly round; more is lumpy.")
    seed: Seed = Field(default=4, description=_SEED.format("sponge"))
    material: MaterialValue = Field(
        default=_matte("#d9a93f"), description="What it is made of. Left out: yellow."
    )

    def check(self, context: Context) -> Iterator[Problem]:
        most = self.levels - SKIN_LEVELS
        if self.layers > most:
            message = f"of {self.levels} levels at most {most} fold the skin; these are {self.layers}"
            yield Problem(
                ("layers",), message, f"write 'layers: {most}' or 'levels: {SKIN_LEVELS + self.layers}'"
            )

    def record(self) -> Mapping[str, Any]:
        return sponge(**self.parameters)


class FishSchool(Ground):
    """A school of fish about the center that swim roughly along x, upright in z (KRS paper, figure 5)."""

    what = "a school of fish"
    example = "fish-school: {doublings: 6, length: 0.3, body: {color: silver, specular: 0.5}}"
    roles: ClassVar[tuple[str, ...]] = ("body", "fins", "eyes")
    hints: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("fish", "count", "number"), "write 'doublings': there are 8 · 2^doublings fish"),
        "size": "did you mean 'length'?",
        **dict.fromkeys(("material", "color"), "a fish has three materials: 'body', 'fins' and 'eyes'"),
    } | _AT

    doublings: Doublings = Field(
        default=5, description="How many mirrors multiply them: there are 8 · 2^doublings fish."
    )
    length: Positive = Field(default=1.0, description="Length of a fish.")
    gap: Strength = Field(
        default=0.8, description="How much room mirrors leave between fish at most, in lengths of a fish."
    )
    stagger: Apart = Field(
        default=2.2, description="How far apart fish are that follow each other, in lengths of a fish."
    )
    askew: Lean = _degrees(
        10,
        "How far mirrors lean, which hides them; standard deviation. Fish turn by twice that.",
    )
    spread: Aside = _degrees(30, "How far a fish heads off x at most.")
    seed: Seed = Field(default=1, description=_SEED.format("school"))
    body: MaterialValue = Field(
        default=Material(color=color("#8fa3b3"), specular=0.35, diffuse=0.55),
        description="What bodies are made of. Left out: a bluish gray that shines.",
    )
    fins: MaterialValue = Field(
        default=_matte("#c9a45c"), description="What fins are made of. Left out: ochre."
    )
    eyes: MaterialValue = Field(
        default=Material(color=color("#101010"), specular=0.4, diffuse=0.5),
        description="What eyes are made of. Left out: black.",
    )

    def record(self) -> Mapping[str, Any]:
        return fish_school(**self.parameters)


class PalmLeaf(Ground):
    """A frond of a palm (KRS paper, figure 13), its blade from the origin along x, its upper side to z. It is
    a [Moebius sequence](#moebius-level): maps bend and scale it, so that no leaflet equals another."""

    what = "a palm leaf"
    example = "palm-leaf: {length: 2, droop: 0.8, leaf: {color: olivedrab}}"
    roles: ClassVar[tuple[str, ...]] = ("leaf", "midrib")
    hints: ClassVar[Mapping[str, str]] = {
        "size": "did you mean 'length'?",
        **dict.fromkeys(("material", "color"), "a palm leaf has two materials: 'leaf' and 'midrib'"),
    } | _AT

    length: Positive = Field(default=1.0, description="Length of the blade, straight from end to end.")
    doublings: Doublings = Field(
        default=6, description="How often leaflets are doubled: there are 2^doublings on either side."
    )
    leaflets: PartOf = Field(
        default=0.25,
        description="How long leaflets are, in lengths of the midrib, before `taper` stretches those near "
        "the stalk.",
    )
    width: PartOf = Field(
        default=0.42, description="Half the width of a leaflet, in distances from one to the next."
    )
    hang: Aside = _degrees(14, "How far leaflets slope down from the midrib.")
    droop: Weight = Field(default=0.25, description="How much the whole frond bends down.")
    taper: Taper = Field(
        default=2.2,
        description="How much smaller leaflets get towards its tip, and how far they sweep towards it: 0 not "
        "at all, 1 to a quarter, 4 to a twenty-fifth of their length.",
    )
    fullness: Weight = Field(
        default=0.0, description="How much smaller they get towards both ends; it leaves a gap halfway."
    )
    uneven: Weight = Field(
        default=0.18, description="How much the maps between leaflets bend and scale, each by chance."
    )
    stalk: Weight = Field(default=0.4, description="Length of the stalk, about, in lengths of the blade.")
    seed: Seed = Field(default=5, description=_SEED.format("frond"))
    leaf: MaterialValue = Field(
        default=Material(color=color("#4f8a2b"), specular=0.15, diffuse=0.75),
        description="What leaflets are made of. Left out: green.",
    )
    midrib: MaterialValue = Field(
        default=_matte("#a59a55"), description="What midrib and stalk are made of. Left out: straw."
    )

    def record(self) -> Mapping[str, Any]:
        return palm_leaf(**self.parameters)
