"""Shapes, how they are combined and placed, and objects."""

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, ValidationInfo

from thurston_cl.models import FIBRED, PRODUCTS, TWISTED

from .base import Node, Problem, problem, shown
from .context import Context, context_of
from .krs import Krs
from .points import Point
from .surfaces import Material, MaterialValue
from .values import Angle, AtLeast, Color, Direction, Number, OneOrMore, Positive, Says

# How far an angle may be off a half turn, in half turns: rounding, since people write '180 deg'.
_HALF_TURN = 1e-12
# How far from its center a plane of sol may be: sinh of it is as large as coordinates may be (placement.py).
_FARTHEST_PLANE = 27.0


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

    radius: Positive = Field(description="Radius of the ball; less than π in s3 and s2xe.")

    def check(self, context: Context) -> Iterator[Problem]:
        yield from fits(context, "radius", self.radius, "π", "the radius of a ball")


class Cylinder(Shape):
    """All points within a distance of a geodesic; in sol of the x- or the y-axis, which are none."""

    what = "a cylinder"
    example = "cylinder: {radius: 0.1, along: [0, 0, 1]}"

    radius: Positive = Field(
        description="Radius of the cylinder; less than π/2 in s3 and, of a horizontal one, in s2xe; less "
        "than π about a fiber of s2xe."
    )
    along: Direction = Field(
        default=(0, 0, 1),
        description="Direction of the geodesic through the center: any in e3, s3 and h3; along the fiber, "
        "[0, 0, 1], or horizontal, [x, y, 0], in s2xe and h2xe; along the fiber in nil and sl2. In sol the "
        "axis, [±1, 0, 0] or [0, ±1, 0].",
    )

    def check(self, context: Context) -> Iterator[Problem]:
        if context.geometry == "sol":
            if _axis_of(self.along) not in ("x", "y"):
                message = "in sol a cylinder is about the x-axis, [1, 0, 0], or the y-axis, [0, 1, 0]"
                help = "write 'along: [1, 0, 0]' or 'along: [0, 1, 0]', or make it a pseudo-cylinder"
                yield Problem(("along",), message, help)
        elif context.geometry in FIBRED:
            yield from _keeps_fibers(
                context, "along", self.along, "a cylinder", horizontal=context.geometry in PRODUCTS
            )
            if self.along[2] == 0:
                yield from fits(context, "radius", self.radius, "π/2", "the radius of a horizontal cylinder")
            else:
                yield from fits(context, "radius", self.radius, "π", "the radius of a cylinder")
        else:
            yield from fits(context, "radius", self.radius, "π/2", "the radius of a cylinder")


class HalfSpace(Shape):
    """All points on one side of a plane: a totally geodesic surface. In nil and sl2, which have none, it is
    all fibers over a line of the base, or one level of the fiber coordinate; in sol one value of x or y,
    which is a hyperbolic plane, or of z, which is a Euclidean plane and not geodesic."""

    what = "a half-space"
    example = "half-space: {normal: [0, 0, 1], offset: -0.5}"

    normal: Direction = Field(
        default=(0, 0, 1),
        description="Points out of the half-space, at the center. In the fibered geometries s2xe, h2xe, nil "
        "and sl2 it is [0, 0, ±1], and the plane is horizontal, or [x, y, 0], and the plane is vertical. In "
        "sol it is [±1, 0, 0], [0, ±1, 0] or [0, 0, ±1].",
    )
    offset: Number = Field(
        default=0.0,
        description="How far along the normal the plane stands: it is perpendicular to the geodesic that "
        "leaves the center along the normal, at this signed distance; between −π/2 and π/2 in s3 and, of a "
        "vertical plane, in s2xe. In sol this is the signed distance from the center too, but the nearest "
        "point lies elsewhere: the plane is x = sinh(offset), y = sinh(offset) or z = offset.",
    )
    crossing: Literal["directed", "bisection"] = Field(
        default="directed",
        description="How a ray finds a horizontal plane of nil or sl2, to which no distance is known: by "
        "`directed` steps, in which this geodesic cannot cross it (paper, 12.3), or by creeping and "
        "`bisection` (9.7), which overlooks what is entered and left within a step.",
    )

    def check(self, context: Context) -> Iterator[Problem]:
        yield from _has_plane(context, self.normal, "the normal of a half-space")
        if context.geometry == "s3" or self.normal[2] == 0:
            yield from fits(context, "offset", self.offset, "π/2", "an offset, to either side,")
        yield from _is_near(context, "offset", self.offset)
        if "crossing" in self.model_fields_set and context.geometry is not None:
            if context.geometry not in TWISTED:
                message = f"in {context.geometry} the distance to a plane is known"
                yield Problem(("crossing",), message, "leave crossing out", True)
            elif self.normal[2] == 0:
                message = "the distance to a vertical plane is known"
                yield Problem(("crossing",), message, "leave crossing out", True)


class Slab(Shape):
    """All points between two planes that face each other: half-spaces with opposite normals."""

    what = "a slab"
    example = "slab: {normal: [0, 0, 1], thickness: 0.2}"

    normal: Direction = Field(
        default=(0, 0, 1),
        description="Across the slab, at the center, with the choice of a [half-space](#half-space).",
    )
    thickness: Positive = Field(
        description="How far apart the planes are at the center, half of it on either side; less than π in "
        "s3 and, of vertical planes, in s2xe."
    )

    def check(self, context: Context) -> Iterator[Problem]:
        yield from _has_plane(context, self.normal, "the normal of a slab")
        if context.geometry == "s3" or self.normal[2] == 0:
            yield from fits(context, "thickness", self.thickness, "π", "the thickness of a slab")
        yield from _is_near(context, "thickness", 0.5 * self.thickness)


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
                yield from fits(context, key, radius, "π", "the radius of a ball")
        if context.lattice is None:
            return
        polyhedron = context.lattice.polyhedron
        if self.vertices is not None:
            if not polyhedron.vertices:
                yield Problem(
                    ("vertices",), "the cell of this manifold has no vertices", "leave it out", True
                )
            elif context.geometry in FIBRED and any(v.kind != "finite" for v in polyhedron.vertices):
                message = "the cell of this manifold has vertices at infinity, where no balls are"
                yield Problem(("vertices",), message, "leave it out", True)
        if self.edges is not None and not polyhedron.edges:
            yield Problem(("edges",), "the cell of this manifold has no edges", "leave it out", True)


class PseudoBall(Shape):
    """In sol what the paper takes for a ball (11.5): e^(−2z) x² + e^(2z) y² + z² ≤ radius², in coordinates
    about the center. The smaller it is, the nearer to a ball; and it is quick, for no geodesic is solved
    for."""

    what = "a pseudo-ball"
    example = "pseudo-ball: {radius: 0.4}"

    radius: Positive = Field(description="How far it reaches along z.")


class PseudoCylinder(Shape):
    """In sol all pseudo-balls of one radius about the points of a one-parameter subgroup: t (x, y, 0), or the
    z-axis (paper, 11.5). Only the z-axis and the lines x = ±y are geodesics."""

    what = "a pseudo-cylinder"
    example = "pseudo-cylinder: {radius: 0.1, along: [1, 1, 0]}"

    radius: Positive = Field(description="Radius of the pseudo-balls.")
    along: Direction = Field(
        default=(0, 0, 1),
        description="Which way it goes from the center: [0, 0, ±1], or horizontal, [x, y, 0].",
    )

    def check(self, context: Context) -> Iterator[Problem]:
        x, y, z = self.along
        if z != 0 and (x != 0 or y != 0):
            message = "a pseudo-cylinder is vertical, [0, 0, 1], or horizontal, [x, y, 0]"
            yield Problem(("along",), message, f"write [0, 0, 1] or [{x:g}, {y:g}, 0]")


def fits(context: Context, key: str, value: float, bound: str, what: str) -> Iterator[Problem]:
    """In s3 and on the sphere of s2xe nothing is further away than π, no plane or line further than π/2."""
    if context.geometry in ("s3", "s2xe") and abs(value) >= {"π": math.pi, "π/2": math.pi / 2}[bound]:
        message = f"in {context.geometry} {what} is less than {bound}; this is {shown(value)}"
        help = "at that size it fills the whole space, or nothing of it"
        if context.geometry == "s2xe":
            help = "at that size it meets itself on the far side of the sphere"
        yield Problem((key,), message, help)


def _is_near(context: Context, key: str, distance: float) -> Iterator[Problem]:
    """In sol numbers grow by e a unit: further planes are lost to rounding."""
    if context.geometry == "sol" and abs(distance) > _FARTHEST_PLANE:
        most, given = shown(_FARTHEST_PLANE), shown(abs(distance))
        message = f"in sol a plane is at most {most} from the center; this one is {given}"
        yield Problem((key,), message, "that far away nothing is seen of it")


def _axis_of(direction: tuple[float, float, float]) -> str | None:
    """Which axis of the coordinates a direction is along."""
    along = [axis for axis, component in zip("xyz", direction, strict=True) if component != 0]
    return along[0] if len(along) == 1 else None


def _has_plane(context: Context, normal: tuple[float, float, float], what: str) -> Iterator[Problem]:
    """Whether there is a plane across a direction."""
    if context.geometry != "sol":
        yield from _keeps_fibers(context, "normal", normal, what)
    elif _axis_of(normal) is None:
        message = f"in sol {what} is along an axis: [±1, 0, 0], [0, ±1, 0] or [0, 0, ±1]"
        nearest = max(range(3), key=lambda k: abs(normal[k]))
        cure = [math.copysign(1, c) if k == nearest else 0 for k, c in enumerate(normal)]
        yield Problem(("normal",), message, "write [{:g}, {:g}, {:g}]".format(*cure))


def _keeps_fibers(
    context: Context, key: str, direction: tuple[float, float, float], what: str, horizontal: bool = True
) -> Iterator[Problem]:
    """Isometries of the fibered geometries turn no direction along the fiber into another; `horizontal`:
    whether what is meant can also lie across the fiber."""
    if context.geometry not in FIBRED:
        return
    x, y, fiber = direction
    if (x == 0 and y == 0) or (horizontal and fiber == 0):
        return
    if not horizontal:
        message = f"in {context.geometry} {what} stands along the fiber, [0, 0, 1]"
        yield Problem((key,), message, "write [0, 0, 1]")
        return
    cure = f"write [0, 0, {math.copysign(1, fiber):g}] or [{x:g}, {y:g}, 0]"
    message = f"in {context.geometry} {what} is along the fiber, [0, 0, 1], or across it, [x, y, 0]"
    yield Problem((key,), message, cure)


class Rotation(Node):
    """A turn about a geodesic through the center of the object, right-handed about its axis. In the fibered
    geometries s2xe, h2xe, nil and sl2 a turn has to keep the fibers; sol has three half turns."""

    what = "a rotation"
    example = "rotate: {axis: [0, 0, 1], angle: 30 deg}"

    axis: Direction = Field(
        description="The axis: any in e3, s3 and h3; in the fibered geometries [0, 0, ±1], along the fiber, "
        "or horizontal, [x, y, 0]; in sol [0, 0, 1], [1, 1, 0] or [1, −1, 0], or any of these backwards."
    )
    angle: Angle = Field(
        description="How far to turn; about a horizontal axis of a fibered geometry by 180 deg, which turns "
        "the fiber over; in sol by 180 deg."
    )

    def check(self, context: Context) -> Iterator[Problem]:
        yield from _keeps_fibers(context, "axis", self.axis, "the axis of a rotation")
        halves, turned = self.angle / math.pi, f"{math.degrees(self.angle):.10g} deg"
        half_turn = abs(halves - round(halves)) <= _HALF_TURN
        if context.geometry == "sol":
            x, y, z = self.axis
            if not (x == y == 0 or (z == 0 and abs(x) == abs(y))):
                message = "in sol the axis of a rotation is [0, 0, 1], [1, 1, 0] or [1, -1, 0]"
                yield Problem(("axis",), message, "no other turn is an isometry of sol; write one of these")
            if not half_turn:
                message = f"sol can be turned by 180 deg only; this is {turned}"
                yield Problem(("angle",), message, "write '180 deg'")
        elif context.geometry in FIBRED and self.axis[2] == 0 and not half_turn:
            yield Problem(
                ("angle",),
                f"about a horizontal axis {context.geometry} can be turned by 180 deg only; this is {turned}",
                "write '180 deg', or turn about the fiber: axis: [0, 0, 1]",
            )


def _one_or_more(value: Any, info: ValidationInfo) -> Any:
    if not isinstance(value, (dict, list, tuple, Rotation)):
        raise problem(f"expected a rotation, found {shown(value)}", f"for example {Rotation.example}")
    if isinstance(value, (list, tuple)):
        return value
    return (Rotation.model_validate(value, context=context_of(info)),)


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
    "slab",
    "horoball",
    "tile",
    "pseudo-ball",
    "pseudo-cylinder",
    "krs",
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
        "box": "a box is an intersection of three slabs: intersection: [{slab: ...}, ...]",
        "cube": "a cube is an intersection of three slabs: intersection: [{slab: ...}, ...]",
    }

    ball: Ball | None = Field(default=None, description="All points within a distance of the center.")
    cylinder: Cylinder | None = Field(default=None, description="All points within a distance of a geodesic.")
    half_space: HalfSpace | None = Field(default=None, alias="half-space", description="One side of a plane.")
    slab: Slab | None = Field(default=None, description="What lies between two planes.")
    horoball: Horoball | None = Field(default=None, description="A ball that touches infinity; in h3 only.")
    tile: Tile | None = Field(default=None, description="The cell of the manifold with balls removed.")
    pseudo_ball: PseudoBall | None = Field(
        default=None, alias="pseudo-ball", description="Nearly a ball; in sol only."
    )
    pseudo_cylinder: PseudoCylinder | None = Field(
        default=None, alias="pseudo-cylinder", description="Nearly a cylinder; in sol only."
    )
    krs: Krs | None = Field(
        default=None,
        description="A kernel-reflection sequence: a tree, a coral, a forest; where there are mirrors.",
    )
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
            yield Problem(("horoball",), f"horoballs are made in h3, not in {context.geometry}", key=True)
        for key, node in (("pseudo-ball", self.pseudo_ball), ("pseudo-cylinder", self.pseudo_cylinder)):
            if node is not None and context.geometry not in ("sol", None):
                message, exact = f"{key}s are made in sol, not in {context.geometry}", key[len("pseudo-") :]
                yield Problem((key,), message, f"there is the {exact} itself: write '{exact}: ...'", True)
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
    } | {
        "color": "the color belongs to the material: write 'material: {color: ...}'",
        **dict.fromkeys(
            ("texture", "image"), "it belongs to the material: write 'material: {color: {image: earth.png}}'"
        ),
    }

    material: MaterialValue = Field(default=Material(), description="What the surface is made of.")
    name: str | None = Field(default=None, description="A name, for messages and statistics.")

    @property
    def materials(self) -> tuple[Material, ...]:
        """Its own material and those of its parts."""
        return (self.material, *_parts(self))


def _parts(solid: Solid) -> Iterator[Material]:
    """What the kernels of sequences within a solid are made of."""
    if isinstance(solid.shape, Krs):
        yield from solid.shape.materials
    members = solid.shape if isinstance(solid.shape, tuple) else (solid.shape,)
    for member in members:
        if isinstance(member, Solid):
            yield from _parts(member)


def lamp(at: Point, radius: float, light: Color) -> Object:
    """The ball that shows where a light stands: of its color, and as bright whatever falls on it."""
    glow = Material(color=light, ambient=1.0, diffuse=0.0, specular=0.0)
    return Object(ball=Ball(radius=radius), at=at, material=glow)
