"""The camera: where it stands, which way it looks, and how it gets there."""

import math
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Literal

from pydantic import Field

from .base import Node, Problem
from .context import Context
from .points import Point
from .values import Angle, Direction, FieldOfView, Number, ViewAngle


class Look(Node):
    """Which way the camera looks."""

    what = "a view"
    example = "look: {along: [1, 0, 0], up: [0, 0, 1]}"

    along: Direction = Field(default=(1, 0, 0), description="The direction to look along, at the camera.")
    to: Point | None = Field(default=None, description="A point to look at, instead of a direction.")
    up: Direction = Field(
        default=(0, 0, 1), description="What is up in the picture; need not be perpendicular."
    )

    def check(self, context: Context) -> Iterator[Problem]:
        given = self.model_fields_set
        if {"along", "to"} <= given:
            yield Problem(
                ("to",), "look either along a direction or to a point", "leave one of the two out", True
            )
        elif self.to is None and _parallel(self.along, self.up):
            where = "up" if "up" in given else "along"
            up = ", ".join(f"{component:g}" for component in self.up)
            yield Problem(
                (where,), f"the direction of view is parallel to up, [{up}]", "give 'up' another direction"
            )


def _parallel(a: tuple[float, ...], b: tuple[float, ...]) -> bool:
    """Whether two vectors leave no plane between them: an angle below 1e-9 rad would make the frame noise."""
    cross = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    return math.hypot(*cross) <= 1e-9 * math.hypot(*a) * math.hypot(*b)


class Step(Node):
    """One step of the camera: along a geodesic with parallel transport, or a turn in place."""

    what = "a step"
    example = "- forward: 0.25"
    one_of = ("forward", "right", "up", "yaw", "pitch", "roll")
    hints: ClassVar[Mapping[str, str]] = {
        "back": "go forward by a negative number",
        "backward": "go forward by a negative number",
        "left": "go right by a negative number",
        "down": "go up by a negative number",
    }

    forward: Number | None = Field(default=None, description="Go this far the way the camera looks.")
    right: Number | None = Field(default=None, description="Go this far to the right.")
    up: Number | None = Field(default=None, description="Go this far up.")
    yaw: Angle | None = Field(
        default=None, description="Turn left (negative: right), about the up direction."
    )
    pitch: Angle | None = Field(
        default=None, description="Turn up (negative: down), about the right direction."
    )
    roll: Angle | None = Field(
        default=None, description="Tip to the right (negative: left), about the direction of view."
    )

    @property
    def kind(self) -> str:
        """Which of the steps this is."""
        return next(key for key in self.one_of if getattr(self, key) is not None)

    @property
    def amount(self) -> float:
        """How far: a length, or an angle in radians."""
        return float(getattr(self, self.kind))

    @classmethod
    def _split(cls) -> str:
        return "write one step after the other: [{forward: 0.25}, {yaw: 20 deg}]"


class Perspective(Node):
    """Straight lines through one point: a picture plane in the tangent space."""

    what = "a perspective"
    hints: ClassVar[Mapping[str, str]] = {"fov": "'fov' stands in the camera itself: camera: {fov: 60 deg}"}


class Equirectangular(Node):
    """All directions: 360 deg from the left to the right edge, which continue each other, and 180 deg from
    the camera's up, at the top edge, to its down. Forward is in the middle. A picture is twice as wide as it
    is high.
    """

    what = "an equirectangular projection"
    example = "equirectangular: {}"
    hints: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("angle", "fov"), "it has all directions: write 'equirectangular: {}'"
    )


class Fisheye(Node):
    """An equidistant fisheye: angles from forward grow evenly from the middle of a circle as wide as the
    shorter side of the picture. What is outside the circle is black, and not marched.
    """

    what = "a fisheye"
    example = "fisheye: {angle: 180 deg}"
    hints: ClassVar[Mapping[str, str]] = {"fov": "did you mean 'angle'?"}

    angle: ViewAngle = Field(
        default=math.pi,
        description="Angle of view across the circle, up to 360 deg.",
        json_schema_extra={"default": "180 deg"},
    )


class Dome(Fisheye):
    """A fulldome master: an equidistant fisheye about the camera's up, in the middle. Forward, the front of
    the dome, is at the bottom; left and right are as the audience has them.
    """

    what = "a dome"
    example = "dome: {angle: 180 deg, tilt: 15 deg}"

    tilt: Angle = Field(
        default=0.0,
        description="How far the dome leans to the front: the middle is this far from up, towards forward.",
        json_schema_extra={"default": "0 deg"},
    )


class Projection(Node):
    """How directions at the camera become places in the picture. In every geometry this happens in the
    tangent space; from there rays go along geodesics.
    """

    what = "a projection"
    example = "projection: {equirectangular: {}}"
    one_of = ("perspective", "equirectangular", "fisheye", "dome")
    hints: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("panorama", "spherical", "360", "latlong"), "did you mean 'equirectangular'?"),
        **dict.fromkeys(("fulldome", "planetarium", "domemaster"), "did you mean 'dome'?"),
        "orthographic": "there is none: in curved space lines that start parallel do not stay so",
    }

    perspective: Perspective | None = Field(default=None, description="Straight lines through one point.")
    equirectangular: Equirectangular | None = Field(default=None, description="A panorama all around.")
    fisheye: Fisheye | None = Field(default=None, description="A circle about forward.")
    dome: Dome | None = Field(default=None, description="A circle about up, for the dome of a planetarium.")

    @property
    def kind(self) -> str:
        """Which of the projections this is."""
        return next(key for key in self.one_of if getattr(self, key) is not None)


class Stereo(Node):
    """Two eyes, to the left and right of where the camera stands, which is their nose: each is reached along
    the geodesic to that side, and looks the way that parallel transport gives it (paper, 3.6), with parallel
    views. In an equirectangular picture the eyes turn with the column that is looked at (omnidirectional
    stereo).
    """

    what = "stereo"
    example = "stereo: {layout: side-by-side, distance: 0.064}"
    hints: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("separation", "baseline", "eyes", "ipd"), "did you mean 'distance'?"),
        "convergence": "views are parallel: shift the pictures against each other afterwards",
    }

    layout: Literal["side-by-side", "top-bottom", "anaglyph"] = Field(
        description="How the pictures of the eyes share the file: `side-by-side`, the left eye at the left, "
        "each with half of the width; `top-bottom`, the left eye on top, each with half of the height; "
        "`anaglyph`, red from the left eye, green and blue from the right, and the other channels from the "
        "left."
    )
    distance: Number = Field(
        default=0.064,
        description="How far the eyes are apart. Below 0 they change places, to be looked at cross-eyed.",
    )


# Where the camera stands and looks if the scene does not say. In a manifold beside the middle of the cell,
# where tiles and balls leave room, and askew; lengths are multiples of the distance from the middle to the
# nearest wall. In a cell that is open to all sides, up along the images above it, for there are no others.
# In the whole space facing the origin.
IN_MANIFOLD: Mapping[str, Any] = {"at": (-0.68, -0.5, 0.35), "look": {"along": (1, 0.5, -0.2)}}
IN_COLUMN: Mapping[str, Any] = {"at": (-0.8, -0.48, -0.3), "look": {"to": (0, 0, 0.67)}}
IN_WHOLE_SPACE: Mapping[str, Any] = {"at": (-1.3, -0.5, 0.4), "look": {"to": (0, 0, 0)}}


class Camera(Node):
    """Where the picture is taken from. Right-handed: forward × up = right."""

    what = "a camera"
    example = "camera: {at: [0, -2, 0.5], look: {to: [0, 0, 0]}}"

    at: Point = Field(
        default=(0.0, 0.0, 0.0),
        description="Where the camera stands. Left out: in a manifold beside the middle of the cell, looking "
        "past it, or up a column of cells; in the whole space at [-1.3, -0.5, 0.4], looking at the origin.",
        json_schema_extra={"default": "see there"},
    )
    look: Look = Field(default=Look(), description="Which way it looks.")
    move: tuple[Step, ...] = Field(
        default=(),
        description="Steps from there, in this order, along geodesics with parallel transport (paper, 3.4).",
    )
    fov: FieldOfView = Field(
        default=math.radians(80),
        description="Angle of view from bottom to top, between 0 and 180 deg; of the perspective projection.",
        json_schema_extra={"default": "80 deg"},
    )
    projection: Projection = Field(
        default=Projection(perspective=Perspective()),
        description="How directions become places in the picture.",
    )
    stereo: Stereo | None = Field(default=None, description="Two eyes. Left out: there is one.")

    @property
    def layout(self) -> str | None:
        """How the pictures of two eyes share the file; None for one eye."""
        return None if self.stereo is None else self.stereo.layout

    def check(self, context: Context) -> Iterator[Problem]:
        kind = self.projection.kind
        if "fov" in self.model_fields_set and kind != "perspective":
            cure = "leave it out (--set camera.fov=null)"
            round_picture = self.projection.fisheye or self.projection.dome
            if round_picture is None:
                cure += ": there all directions are seen"
            elif "angle" in round_picture.model_fields_set:
                cure += f": the angle of the {kind} is given"
            elif round_picture.model_fields_set:
                cure += f" and write 'angle: {math.degrees(self.fov):.10g} deg' in the {kind}"
            else:
                angle = f"{math.degrees(self.fov):.10g} deg"
                cure += f" and write 'projection: {{{kind}: {{angle: {angle}}}}}'"
            yield Problem(("fov",), f"'fov' belongs to the perspective projection, not to {kind}", cure, True)

    @classmethod
    def fill(cls, data: dict[str, Any], context: Context) -> None:
        if "at" not in data:
            view, unit = IN_WHOLE_SPACE, 1.0
            if context.lattice is not None:
                open_to_all_sides = len(context.lattice.level_walls) == len(context.lattice.walls)
                view, unit = IN_COLUMN if open_to_all_sides else IN_MANIFOLD, context.lattice.inradius
            data["at"] = [unit * component for component in view["at"]]
            look = {key: list(value) for key, value in view["look"].items()}
            if "to" in look:
                look["to"] = [unit * component for component in look["to"]]
            data.setdefault("look", look)
