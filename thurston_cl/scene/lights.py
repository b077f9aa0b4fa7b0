"""Lights, and what light does on its way."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from .base import Node, Problem, problem, shown
from .context import Context
from .points import Point
from .suggest import did_you_mean
from .values import Also, ColorValue, Count, Flag, Positive, Says, color

# Each costs a solve at every point that is hit, and light along the hundredth is dim beyond telling.
MOST_GEODESICS = 1000


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
        "density; `inverse` is 1/length; `constant` does not fade (paper, 5.9).",
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
        if not context.manifold:
            data.setdefault("translates", 1)

    def check(self, context: Context) -> Iterator[Problem]:
        if context.geometry in ("e3", "h3", "h2xe") and self.geodesics > 1:
            message = f"in {context.geometry} only one geodesic joins two points, not {self.geodesics}"
            yield Problem(("geodesics",), message, "leave it out")
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
    one_of = ("point",)
    hints: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("sun", "directional", "ambient", "area", "spot"), "this version has point lights only"
    )

    point: PointLight = Field(description="A light that shines from one point in all directions.")
    shadows: Literal["hard"] | None = Field(
        default=None, description="Left out: no shadows are worked out for this light."
    )


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
