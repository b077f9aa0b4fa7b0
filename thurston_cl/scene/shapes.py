"""Shapes, how they are combined and placed, and objects."""

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field

from .base import Node, Problem, problem, shown
from .context import Context
from .points import Point
from .surfaces import Material, MaterialValue
from .values import Angle, AtLeast, Direction, Number, OneOrMore, Positive, Says


class Shape(Node):
    """A set of points, in the frame of the object that it belongs to."""

    hints: ClassVar[Mapping[str, str]] = {
        key: f"'{key}' stands beside the shape, not inside it" for key in ("at", "rotate", "material", "name")
    } | {
        "position": "'at' stands beside the shape, not inside it",
        "center": "'at' stands beside the shape, not inside it",
    }


class Ball(Shape):
    """All points within a distance of the center."""

    what = "a ball"
    example = "ball: {radius: 0.4}"

    radius: Positive = Field(description="Radius of the ball; less than π in s3.")

    def check(self, context: Context) -> Iterator[Problem]:
        yield from _below_in_s3(context, "radius", self.radius, "π", "the radius of a ball")


class Cylinder(Shape):
    """All points within a distance of a geodesic."""

    what = "a cylinder"
    example = "cylinder: {radius: 0.1, along: [0, 0, 1]}"

    radius: Positive = Field(description="Radius of the cylinder; less than π/2 in s3.")
    along: Direction = Field(default=(0, 0, 1), description="Direction of the geodesic through the center.")

    def check(self, context: Context) -> Iterator[Problem]:
        yield from _below_in_s3(context, "radius", self.radius, "π/2", "the radius of a cylinder")


class HalfSpace(Shape):
    """All points on one side of a plane: a totally geodesic surface."""

    what = "a half-space"
    example = "half-space: {normal: [0, 0, 1], offset: -0.5}"

    normal: Direction = Field(default=(0, 0, 1), description="Points out of the half-space, at the center.")
    offset: Number = Field(
        default=0.0,
        description="How far along the normal the plane stands: it is perpendicular to the geodesic that "
        "leaves the center along the normal, at this signed distance; between −π/2 and π/2 in s3.",
    )

    def check(self, context: Context) -> Iterator[Problem]:
        yield from _below_in_s3(context, "offset", self.offset, "π/2", "an offset, to either side,")


class Horoball(Shape):
    """A ball that touches infinity; in h3 only."""

    what = "a horoball"
    example = "horoball: {towards: [0, 0, 1], distance: 0.5}"

    towards: Direction = Field(
        description="Direction, at the center, of the point at infinity that it touches."
    )
    distance: Number = Field(
        description="Signed distance from the center to its surface; negative if the center lies inside."
    )


class Tile(Shape):
    """The cell of the manifold with balls removed (paper, figure 3)."""

    what = "a tile"
    example = "tile: {ball: 0.6, vertices: 0.2}"

    ball: Positive = Field(description="Radius of the ball removed around the center of the cell.")
    vertices: Positive | None = Field(
        default=None, description="Radius of balls removed around the vertices of the cell."
    )
    edges: Positive | None = Field(
        default=None, description="Radius of balls removed around the midpoints of its edges."
    )

    def check(self, context: Context) -> Iterator[Problem]:
        for key, radius in (("ball", self.ball), ("vertices", self.vertices), ("edges", self.edges)):
            if radius is not None:
                yield from _below_in_s3(context, key, radius, "π", "the radius of a ball")


def _below_in_s3(context: Context, key: str, value: float, bound: str, what: str) -> Iterator[Problem]:
    """In s3 nothing is further away than π, and no plane or line further than π/2."""
    if context.geometry == "s3" and abs(value) >= {"π": math.pi, "π/2": math.pi / 2}[bound]:
        help = "at that size it fills the whole space, or nothing of it"
        yield Problem((key,), f"in s3 {what} is less than {bound}; this is {shown(value)}", help)


class Rotation(Node):
    """A turn about a geodesic through the center of the object, right-handed about its axis."""

    what = "a rotation"
    example = "rotate: {axis: [0, 0, 1], angle: 30 deg}"

    axis: Direction = Field(description="The axis.")
    angle: Angle = Field(description="How far to turn.")


def _one_or_more(value: Any) -> Any:
    if not isinstance(value, (dict, list, tuple, Rotation)):
        raise problem(f"expected a rotation, found {shown(value)}", f"for example {Rotation.example}")
    return value if isinstance(value, (list, tuple)) else (Rotation.model_validate(value),)


Rotations = Annotated[
    tuple[Rotation, ...],
    BeforeValidator(_one_or_more),
    OneOrMore(),
    Says("a [rotation](#rotation), or a list of them, the first applied first"),
]

_SHAPES = (
    "ball",
    "cylinder",
    "half-space",
    "horoball",
    "tile",
    "union",
    "intersection",
    "difference",
    "complement",
)


class Solid(Node):
    """A shape and where it stands: what union, intersection, difference and complement are made of."""

    what = "a shape"
    example = "ball: {radius: 0.4}"
    one_of = _SHAPES
    hints: ClassVar[Mapping[str, str]] = {
        "material": "'material' stands with the outermost shape: an object has one material",
        "name": "'name' stands with the outermost shape",
        "box": "a box is an intersection of six half-spaces: intersection: [{half-space: ...}, ...]",
        "cube": "a cube is an intersection of six half-spaces: intersection: [{half-space: ...}, ...]",
    }

    ball: Ball | None = Field(default=None, description="All points within a distance of the center.")
    cylinder: Cylinder | None = Field(default=None, description="All points within a distance of a geodesic.")
    half_space: HalfSpace | None = Field(default=None, alias="half-space", description="One side of a plane.")
    horoball: Horoball | None = Field(default=None, description="A ball that touches infinity; in h3 only.")
    tile: Tile | None = Field(default=None, description="The cell of the manifold with balls removed.")
    union: Annotated[tuple["Solid", ...], AtLeast(1)] | None = Field(
        default=None, description="What lies in any of these."
    )
    intersection: Annotated[tuple["Solid", ...], AtLeast(1)] | None = Field(
        default=None, description="What lies in all of these."
    )
    difference: Annotated[tuple["Solid", ...], AtLeast(2)] | None = Field(
        default=None, description="What lies in the first and in none of the others."
    )
    complement: "Solid | None" = Field(default=None, description="What lies outside this.")
    at: Point = Field(
        default=(0.0, 0.0, 0.0), description="The center, in the frame of what this belongs to."
    )
    rotate: Rotations = Field(
        default=(), description="Turns about the center, made before it is moved there."
    )

    @property
    def kind(self) -> str:
        """Which of the shapes this is, as it is written in a scene."""
        return next(key for key in self.one_of if getattr(self, self.keys()[key]) is not None)

    @property
    def shape(self) -> Any:
        """The shape itself: a Shape, a tuple of Solids, or (of a complement) a Solid."""
        return getattr(self, self.keys()[self.kind])

    def check(self, context: Context) -> Iterator[Problem]:
        if self.horoball is not None and context.geometry not in ("h3", None):
            yield Problem(
                ("horoball",), f"there are no horoballs in {context.geometry}, only in h3", key=True
            )
        if self.tile is not None and context.geometry is not None and not context.manifold:
            yield Problem(
                ("tile",), "a tile needs a manifold, whose cell it is", "add 'manifold: NAME'", key=True
            )

    @classmethod
    def _split(cls) -> str:
        return "begin each object with '- ', or combine shapes with 'union: [{...}, {...}]'"


class Object(Solid):
    """A solid with a surface."""

    what = "an object"
    example = "- ball: {radius: 0.4}"
    hints: ClassVar[Mapping[str, str]] = {
        key: help for key, help in Solid.hints.items() if key not in ("material", "name")
    } | {"color": "the color belongs to the material: write 'material: {color: ...}'"}

    material: MaterialValue = Field(default=Material(), description="What the surface is made of.")
    name: str | None = Field(default=None, description="A name, for messages and statistics.")
