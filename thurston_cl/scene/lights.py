"""Lights, and what light does on its way."""

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from thurston_cl.models import LEFT_INVARIANT, PRODUCTS

from .base import Node, Problem, problem, shown
from .context import Context
from .points import Point
from .suggest import did_you_mean
from .values import Also, ColorValue, Count, Direction, Flag, Positive, Says, color

if TYPE_CHECKING:
    from thurston_cl.lattice import Lattice

# Each costs a solve at every point that is hit, and light along the hundredth is dim beyond telling.
MOST_GEODESICS = 1000
# How far a vector may be off and still be the same, in parts of its size: far above rounding.
_SAME_DIRECTION = 1e-9


class PointLight(Node):
    """A light that shines from one point in all directions, along geodesics."""

    what = "a point light"
    example = 'point: {at: [0, 0, 1], color: "#ffddaa", intensity: 2}'

    hints: ClassVar[Mapping[str, str]] = {"shadows": "'shadows' stands beside 'point', not inside it"}

    at: Point = Field(description="Where it stands.")
    color: ColorValue = Field(default=color("white"), description="Its color.")
    intensity: Positive = Field(
        default=1.0,
        description="Its strength; 1 gives full light where the falloff is 1: at area density 1 or length 1.",
    )
    falloff: Literal["area", "inverse", "constant"] = Field(
        default="area",
        description="How it fades with the length of the geodesic: `area` is what the geometry does, 1/area "
        "density; `inverse` is 1/length; `constant` does not fade (paper, 5.9). Default `constant` with "
        "`direction: straight`, which has no `area`.",
    )
    direction: Literal["geodesic", "straight"] = Field(
        default="geodesic",
        description="Where it comes from: along geodesics; or, in nil, sl2 and sol, for speed, as if along "
        "the `straight` line of coordinates about the point that it falls on (paper, 5.9 and 11.6), without "
        "shadows.",
    )
    geodesics: Count = Field(
        default=1,
        description="Along how many geodesics it shines, shortest first. Default 2 in s3 and s2xe; "
        "elsewhere 1. In e3, h3 and h2xe there is one.",
    )
    translates: Annotated[
        Count | Literal["neighbours"],
        BeforeValidator(lambda v: _translates(v)),
        Also(({"const": "cell"},)),
        Says("whole number ≥ 1, `cell` (= 1) or `neighbours`"),
    ] = Field(
        default="neighbours",
        description="In a manifold: how many images of the light count. 1 is the one in the cell itself; "
        "`neighbours` adds those in the cells around it. Without a manifold there is one.",
    )
    repeated: Flag = Field(
        default=True,
        description="In a manifold: whether one such light stands in every cell. `false`: in the whole "
        "tiling there is this one only, seen from the 4096 cells next to the camera, in fibered geometries "
        "from 131072 in columns along the fiber; others are dark.",
    )

    @classmethod
    def fill(cls, data: dict[str, Any], context: Context) -> None:
        data.setdefault("geodesics", usual_geodesics(context.geometry))
        if data.get("direction") == "straight":
            data.setdefault("falloff", "constant")
        if not context.manifold:
            data.setdefault("translates", 1)

    def check(self, context: Context) -> Iterator[Problem]:
        if context.geometry in ("e3", "h3", "h2xe") and self.geodesics > 1:
            message = f"in {context.geometry} only one geodesic joins two points, not {self.geodesics}"
            yield Problem(("geodesics",), message, "leave it out")
        if self.direction == "straight":
            yield from self._check_straight(context)
        if self.geodesics > MOST_GEODESICS:
            message = f"{self.geodesics} geodesics are more than anyone will wait for"
            yield Problem(("geodesics",), message, f"at most {MOST_GEODESICS}")
        if context.geometry is not None and not context.manifold and self.translates != 1:
            yield Problem(
                ("translates",), "translates needs a manifold", "leave it out, or add 'manifold: NAME'", True
            )
        if not self.repeated and context.geometry is not None and not context.manifold:
            yield Problem(("repeated",), "without a manifold no light is repeated", "leave it out", True)
        elif not self.repeated and "translates" in self.model_fields_set:
            message = "a light that is not repeated has no translates"
            yield Problem(("translates",), message, "leave one of the two out", True)

    def _check_straight(self, context: Context) -> Iterator[Problem]:
        if context.geometry not in (*LEFT_INVARIANT, None):
            message = f"in {context.geometry} light comes along geodesics as quickly"
            yield Problem(("direction",), message, "leave direction out", True)
        if self.falloff == "area":
            message = "what comes along a straight line has no area density"
            yield Problem(("falloff",), message, "write inverse or constant")
        if self.geodesics > 1:
            message = "only one straight line joins two points"
            yield Problem(("geodesics",), message, "leave geodesics out, or 'direction: straight'", True)


class Sun(Node):
    """A light that is so far away that it comes from the same direction everywhere, and does not fade."""

    what = "a sun"
    example = "sun: {from: [0, 0, 1]}"
    hints: ClassVar[Mapping[str, str]] = {
        "shadows": "'shadows' stands beside 'sun', not inside it",
        "along": "write 'from: [x, y, z]', the direction that the light comes from",
        "at": "a sun has a direction, no place: write 'from: [x, y, z]'",
    }

    towards: Direction = Field(
        default=(0, 0, 1),
        alias="from",
        description="The direction that its light comes from, in the frame at each point: any in e3; in "
        "s2xe, h2xe, nil, sl2 and sol [0, 0, ±1], since only vertical geodesics are parallel; s3 and h3 have "
        "no parallel ones. A manifold has to keep the direction.",
    )
    color: ColorValue = Field(default=color("white"), description="Its color.")
    intensity: Positive = Field(default=1.0, description="Its strength; 1 gives full light.")

    def check(self, context: Context) -> Iterator[Problem]:
        x, y, z = self.towards
        if context.geometry in ("s3", "h3"):
            message = f"{context.geometry} has no parallel light: geodesics meet or part in every direction"
            yield Problem((), message, "write 'point: {at: ...}' instead")
        elif context.geometry not in ("e3", None) and (x != 0 or y != 0):
            message = f"in {context.geometry} only vertical light is parallel: from [0, 0, 1] or [0, 0, -1]"
            yield Problem(("from",), message, f"write [0, 0, {math.copysign(1, z):g}]")
        elif context.lattice is not None and not _is_kept(context.lattice, self.towards):
            message = "this manifold turns the direction of the sun, so that it has none there"
            yield Problem(("from",), message, "use a point light, or leave the manifold out")


def _is_kept(lattice: "Lattice", direction: tuple[float, float, float]) -> bool:
    """Whether the group of a lattice keeps a direction of the frame, but for e3 the vertical one."""
    from thurston_cl.lattice.isometry import vector_map

    kept = (0.0, 0.0, 0.0, 1.0) if lattice.geometry in PRODUCTS else (*direction, 0.0)
    off = vector_map(lattice.geometry, lattice.maps) @ kept - kept
    return bool(abs(off).max() < _SAME_DIRECTION * max(map(abs, kept)))


def usual_geodesics(geometry: str | None) -> int:
    """Along how many geodesics light shines where a scene does not say: round a sphere it comes both ways."""
    return 2 if geometry in ("s3", "s2xe") else 1


def _translates(value: Any) -> Any:
    if value == "cell":
        return 1
    if isinstance(value, str) and value != "neighbours":
        raise problem(
            f"expected a whole number, 'cell' or 'neighbours', found {shown(value)}",
            did_you_mean(value, ("cell", "neighbours")),
        )
    if isinstance(value, (dict, list, bool)) or (
        isinstance(value, (int, float)) and (value < 1 or value != int(value))
    ):
        raise problem(f"expected a whole number from 1, 'cell' or 'neighbours', found {shown(value)}")
    return value


class Light(Node):
    """A source of light, and what is worked out for it."""

    what = "a light"
    example = "- point: {at: [0, 0, 1]}"
    one_of = ("point", "sun")
    hints: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("ambient", "area", "spot"), "this version has point lights and suns only"
    ) | {"directional": "did you mean 'sun'?"}

    point: PointLight | None = Field(
        default=None, description="A light that shines from one point in all directions."
    )
    sun: Sun | None = Field(default=None, description="A light that comes from one direction everywhere.")
    shadows: Literal["hard"] | None = Field(
        default=None, description="Left out: no shadows are worked out for this light."
    )

    def check(self, context: Context) -> Iterator[Problem]:
        if self.shadows is not None and self.point is not None and self.point.direction == "straight":
            message = "light along a straight line of coordinates throws no shadows: no ray follows that line"
            yield Problem(("shadows",), message, "leave out shadows, or 'direction: straight'", True)

    @classmethod
    def _split(cls) -> str:
        return "begin each light with '- '"


class ExponentialFog(Node):
    """Fog that takes the same fraction of light on every unit of length."""

    what = "exponential fog"
    example = "exponential: {density: 0.15}"

    density: Positive = Field(description="Light is dimmed by exp(−density · length).")
    color: ColorValue = Field(default=color("black"), description="What is seen where the fog is thick.")


class Fog(Node):
    """How light fades along a ray."""

    what = "fog"
    example = "fog: {exponential: {density: 0.15}}"
    one_of = ("exponential",)
    hints: ClassVar[Mapping[str, str]] = {"linear": "this version has exponential fog only"}

    exponential: ExponentialFog = Field(description="The same fraction on every unit of length.")


class Effects(Node):
    """What is simulated besides direct light; what is not named costs nothing."""

    what = "a list of effects by name"
    example = "effects: {fog: {exponential: {density: 0.15}}}"
    hints: ClassVar[Mapping[str, str]] = {
        "reflections": "reflections are not rendered yet; available: fog",
        "shadows": "shadows belong to a light: write '- point: {...}' and below it 'shadows: hard'",
    }

    fog: Fog | None = Field(default=None, description="How light fades along a ray. Left out: it does not.")
