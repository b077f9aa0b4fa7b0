"""What is simulated besides direct light: fog, ambient occlusion, reflections. Shadows belong to lights."""

from collections.abc import Mapping
from typing import Annotated, ClassVar

from annotated_types import Ge, Le
from pydantic import BeforeValidator, Field

from .base import Node
from .values import Color, ColorValue, Flag, Positive, Says, Weight, color, whole_number

# Every reflection is one more ray, and what is seen in the eighth mirror is dim and small.
MOST_REFLECTIONS = 8


class ExponentialFog(Node):
    """Fog that takes the same fraction of light on every unit of length."""

    what = "exponential fog"
    example = "exponential: {density: 0.15}"

    density: Positive = Field(description="Light is dimmed by exp(−density · length).")
    color: ColorValue = Field(default=color("black"), description="What is seen where the fog is thick.")


class LinearFog(Node):
    """Fog that takes the same amount of light on every unit of length, until nothing is left."""

    what = "linear fog"
    example = "linear: {length: 12}"
    hints: ClassVar[Mapping[str, str]] = {
        "start": "it starts at the camera: write 'length', where nothing is left",
        **dict.fromkeys(("end", "far"), "did you mean 'length'?"),
    }

    length: Positive = Field(description="Where nothing is left: light is dimmed by 1 − l/length after l.")
    color: ColorValue = Field(default=color("black"), description="What is seen where the fog is thick.")


class Fog(Node):
    """How light fades along a ray (paper, 5.3)."""

    what = "fog"
    example = "fog: {exponential: {density: 0.15}}"
    one_of = ("exponential", "linear")

    exponential: ExponentialFog | None = Field(
        default=None, description="The same fraction on every unit of length."
    )
    linear: LinearFog | None = Field(default=None, description="The same amount on every unit of length.")
    on_lights: Flag = Field(
        default=False,
        alias="on-lights",
        description="Whether light fades on its way from point lights to surfaces too. A sun does not.",
    )

    @property
    def law(self) -> tuple[str, float, Color]:
        """Which law it follows, the one number of that, and the color of the fog."""
        if self.linear is not None:
            return "linear", self.linear.length, self.linear.color
        assert self.exponential is not None
        return "exponential", self.exponential.density, self.exponential.color


class AmbientOcclusion(Node):
    """Less of the ambient light where other surfaces stand close above one."""

    what = "ambient occlusion"
    example = "ambient-occlusion: {reach: 0.5}"

    reach: Positive = Field(description="How far above a surface others are looked for.")
    strength: Weight = Field(
        default=1.0, description="How much of the ambient light what is closed on all sides loses."
    )


class Reflections(Node):
    """Mirrors: what materials with a `reflectivity` show (paper, 5.4)."""

    what = "reflections"
    example = "reflections: {depth: 2}"

    depth: Annotated[
        int, Ge(0), Le(MOST_REFLECTIONS), BeforeValidator(whole_number), Says("whole number from 0 to 8")
    ] = Field(
        default=1, description="How many mirrors light may meet one after the other; 0 leaves all dull."
    )


class Effects(Node):
    """What is simulated besides direct light; what is not named costs nothing."""

    what = "a list of effects by name"
    example = "effects: {fog: {exponential: {density: 0.15}}}"
    hints: ClassVar[Mapping[str, str]] = {
        "shadows": "shadows belong to a light: write '- point: {...}' and below it 'shadows: hard'",
        **dict.fromkeys(("ao", "occlusion"), "did you mean 'ambient-occlusion'?"),
        **dict.fromkeys(("mirrors", "reflection"), "did you mean 'reflections'?"),
        "reflectivity": "'reflectivity' belongs to a material; write 'reflections: {depth: 1}' here",
    }

    fog: Fog | None = Field(default=None, description="How light fades along a ray. Left out: it does not.")
    ambient_occlusion: AmbientOcclusion | None = Field(
        default=None,
        alias="ambient-occlusion",
        description="Less ambient light in corners. Left out: it is the same everywhere.",
    )
    reflections: Reflections | None = Field(
        default=None, description="Mirrors. Left out: no material may have a `reflectivity`."
    )
