"""The camera: where it stands, which way it looks, and how it gets there."""

import math
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from pydantic import Field

from .base import Node, Problem
from .context import Context
from .points import Point
from .values import Angle, Direction, FieldOfView, Number


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


class Projection(Node):
    """How directions at the camera become places in the picture."""

    what = "a projection"
    example = "projection: {perspective: {}}"
    one_of = ("perspective",)
    hints: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("fisheye", "equirectangular", "orthographic", "panorama"), "this version has perspective only"
    )

    perspective: Perspective = Field(description="Straight lines through one point.")


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
        description="Angle of view from bottom to top, between 0 and 180 deg.",
        json_schema_extra={"default": "80 deg"},
    )
    projection: Projection = Field(
        default=Projection(perspective=Perspective()),
        description="How directions become places in the picture.",
    )

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
