"""Lights, and the shadows that they throw."""

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, ValidationInfo

from thurston_cl.models import LEFT_INVARIANT, PRODUCTS

from .base import Node, Problem, problem, shown
from .context import Context, context_of
from .points import Point
from .shapes import fits
from .suggest import did_you_mean
from .values import Also, ColorValue, Count, Direction, Flag, Positive, Says, color, whole_number

if TYPE_CHECKING:
    from thurston_cl.lattice import Lattice

# Each costs a solve at every point that is hit, and light along the hundredth is dim beyond telling.
MOST_GEODESICS = 1000
# How far a vector may be off and still be the same, in parts of its size: far above rounding.
_SAME_DIRECTION = 1e-9


class Within(Node):
    """All geodesics up to a length."""

    what = "a greatest length"
    example = "geodesics: {within: 12}"

    within: Positive = Field(description="The length of the longest that counts.")


def _geodesics(value: Any, info: ValidationInfo) -> Any:
    if value == "all":
        help = "most points are joined by infinitely many; write 'geodesics: {within: LENGTH}'"
        raise problem("expected a whole number or a greatest length, found 'all'", help)
    if isinstance(value, dict):
        return Within.model_validate(value, context=context_of(info))
    if isinstance(value, float) and not value.is_integer():
        help = f"for a greatest length write 'geodesics: {{within: {abs(value):g}}}'"
        raise problem(f"expected a whole number, found {shown(value)}", help)
    if not isinstance(value, Within) and whole_number(value) < 1:
        raise problem(f"geodesics must be at least 1; this is {shown(value)}")
    return value


class PointLight(Node):
    """A light that shines from one point in all directions, along geodesics."""

    what = "a point light"
    example = 'point: {at: [0, 0, 1], color: "#ffddaa", intensity: 2}'

    hints: ClassVar[Mapping[str, str]] = {
        "shadows": "'shadows' stands beside 'point', not inside it",
        **dict.fromkeys(
            ("radius", "size", "visible", "show"),
            "write 'ball: 0.1', the radius of a ball that shows where the light stands",
        ),
    }

    at: Point = Field(description="Where it stands.")
    color: ColorValue = Field(default=color("white"), description="Its color.")
    intensity: Positive = Field(
        default=1.0,
        description="Its strength; 1 gives full light where the falloff is 1: at area density 1 or length 1.",
    )
    ball: Positive | None = Field(
        default=None,
        description="Radius of a ball of its color that shows where it stands, and that does not shade it. "
        "Left out: the light is not seen itself.",
    )
    falloff: Literal["area", "inverse", "inverse-square", "constant"] = Field(
        default="area",
        description="How it fades with the length of the geodesic: `area` is what the geometry does, 1/area "
        "density; `inverse` is 1/length, `inverse-square` 1/length²; `constant` does not fade (paper, 5.9). "
        "Default `constant` with `direction: straight`, which has no `area`.",
    )
    direction: Literal["geodesic", "straight"] = Field(
        default="geodesic",
        description="Where it comes from: along geodesics; or, in nil, sl2 and sol, for speed, as if along "
        "the `straight` line of coordinates about the point that it falls on (paper, 5.9 and 11.6), without "
        "shadows.",
    )
    geodesics: Annotated[
        Count | Within,
        BeforeValidator(lambda v, info: _geodesics(v, info)),
        Says("whole number ≥ 1, or `{within: LENGTH}`"),
    ] = Field(
        default=1,
        description="Along how many geodesics it shines, shortest first; or along all that are no longer "
        "than a length. Default 2 in s3 and s2xe; elsewhere 1. In e3, h3 and h2xe there is one.",
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

    @property
    def within(self) -> float | None:
        """The length up to which all geodesics count; None where their number is given."""
        return self.geodesics.within if isinstance(self.geodesics, Within) else None

    @property
    def most_geodesics(self) -> int:
        """The number of geodesics that are looked for."""
        return MOST_GEODESICS if isinstance(self.geodesics, Within) else self.geodesics

    @classmethod
    def fill(cls, data: dict[str, Any], context: Context) -> None:
        data.setdefault("geodesics", usual_geodesics(context.geometry))
        if data.get("direction") == "straight":
            data.setdefault("falloff", "constant")
        if not context.manifold:
            data.setdefault("translates", 1)

    def check(self, context: Context) -> Iterator[Problem]:
        if context.geometry in ("e3", "h3", "h2xe") and self.most_geodesics > 1 and self.within is None:
            message = f"in {context.geometry} only one geodesic joins two points, not {self.geodesics}"
            yield Problem(("geodesics",), message, "leave it out")
        if self.direction == "straight":
            yield from self._check_straight(context)
        if self.most_geodesics > MOST_GEODESICS:
            message = f"{self.geodesics} geodesics are more than anyone will wait for"
            yield Problem(("geodesics",), message, f"at most {MOST_GEODESICS}")
        if self.ball is not None:
            yield from fits(context, "ball", self.ball, "π", "the radius of a ball")
            if not self.repeated:
                message = "the ball of a light stands in every cell, and this light does not"
                yield Problem(("ball",), message, "leave ball out, or 'repeated: false'", True)
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
        if self.most_geodesics > 1:
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
        elif context.lattice is not None and not is_kept(context.lattice, self.towards):
            message = "this manifold turns the direction of the sun, so that it has none there"
            yield Problem(("from",), message, "use a point light, or leave the manifold out")


def is_kept(lattice: "Lattice", direction: tuple[float, float, float]) -> bool:
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
            did_you_mean(value, ("cell", "neighbours"), "those in the cells around it are 'neighbours'"),
        )
    if isinstance(value, (dict, list, bool)) or (
        isinstance(value, (int, float)) and (value < 1 or value != int(value))
    ):
        raise problem(f"expected a whole number from 1, 'cell' or 'neighbours', found {shown(value)}")
    return value


class HardShadows(Node):
    """Shadows with sharp edges, as light from a point throws (paper, 5.2)."""

    what = "hard shadows"


class SoftShadows(Node):
    """Shadows with soft edges: the nearer light passes by an object, the darker (paper, 5.2)."""

    what = "soft shadows"
    example = "soft: {sharpness: 5}"
    hints: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("softness", "radius", "size", "blur", "k"), "write 'soft: {sharpness: 5}'; larger is harder"
    )

    sharpness: Positive = Field(
        default=8.0,
        description="The K of eq. 5.4: light is dimmed that passes an object by less than the angle 1/K, as "
        "seen from the surface; the larger, the harder the shadow.",
    )


class Shadows(Node):
    """How objects shade a light."""

    what = "shadows"
    example = "shadows: {soft: {sharpness: 5}}"
    one_of = ("hard", "soft")
    hints: ClassVar[Mapping[str, str]] = {"softness": SoftShadows.hints["softness"]}

    hard: HardShadows | None = Field(
        default=None, description="A place is lit or not. Short: `shadows: hard`."
    )
    soft: SoftShadows | None = Field(default=None, description="Softer edges. Short: `shadows: soft`.")


def _shadows(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, (dict, Shadows)):
        return value
    if value not in Shadows.one_of:
        help = did_you_mean(value, Shadows.one_of) if isinstance(value, str) else None
        help = help or "write 'shadows: hard' or 'shadows: soft'; leave shadows out for none"
        raise problem(f"expected hard or soft, found {shown(value)}", help)
    return Shadows.model_validate({value: {}}, context=context_of(info))


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
    shadows: Annotated[
        Shadows | None,
        BeforeValidator(_shadows),
        Also(({"enum": ["hard", "soft"]},)),
        Says("`hard`, `soft`, or [shadows](#shadows)"),
    ] = Field(default=None, description="Left out: no shadows are worked out for this light.")

    def check(self, context: Context) -> Iterator[Problem]:
        if self.shadows is not None and self.point is not None and self.point.direction == "straight":
            message = "light along a straight line of coordinates throws no shadows: no ray follows that line"
            yield Problem(("shadows",), message, "leave out shadows, or 'direction: straight'", True)

    @classmethod
    def _split(cls) -> str:
        return "begin each light with '- '"
