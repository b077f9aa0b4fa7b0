"""What a ray shows that hits nothing: a color, or a sky."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, ValidationInfo

from .base import Node, Problem, problem
from .context import Context, context_of
from .lights import is_kept
from .values import ColorValue, Direction, Says, color, to_color


class Sky(Node):
    """A smooth gradient by the direction in which a ray leaves; most of its change is near the horizon.

    In h3 by the point at infinity that the ray reaches: the direction in which the geodesic from the origin
    to that point begins. Fog does not hide a sky: give the fog the color of the horizon.
    """

    what = "a sky"
    example = 'sky: {zenith: "#3a6fc4", horizon: "#dbe7f2"}'
    hints: ClassVar[Mapping[str, str]] = {
        "sun": "a sun is a light: write 'lights: [sun: {from: [x, y, z]}]'",
        "top": "did you mean 'zenith'?",
        "bottom": "did you mean 'ground'?",
    }

    zenith: ColorValue = Field(default=color("#3a6fc4"), description="The color straight up.")
    horizon: ColorValue = Field(default=color("#dbe7f2"), description="The color between up and down.")
    ground: ColorValue | None = Field(
        default=None, description="The color straight down. Left out: that of the horizon, all below it."
    )
    up: Direction = Field(
        default=(0, 0, 1), description="Where the zenith is, in the frame at the origin; in e3 everywhere."
    )

    def check(self, context: Context) -> Iterator[Problem]:
        if context.geometry not in ("e3", "h3", None):
            message = f"there is a sky in e3 and h3, not in {context.geometry}"
            yield Problem((), message, "write a plain color, such as 'background: \"#dbe7f2\"'")
        elif context.manifold and context.geometry == "h3":
            message = "in a manifold of h3 a ray reaches no point at infinity: there is no sky"
            yield Problem((), message, "write a plain color, or leave the manifold out")
        elif context.lattice is not None and not is_kept(context.lattice, self.up):
            message = "this manifold turns the direction up of the sky, so that it has none there"
            yield Problem((), message, "write a plain color, or leave the manifold out")


class Background(Node):
    """What a ray shows that hits nothing, if that is no plain color."""

    what = "a background"
    one_of = ("sky",)

    sky: Sky | None = Field(default=None, description="A smooth gradient from the horizon to the zenith.")


def _background(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, dict):
        return Background.model_validate(value, context=context_of(info))
    if value == "sky":
        raise problem("'sky' is not a color", "write 'background: {sky: {}}'")
    return value if isinstance(value, Background) else to_color(value)


BackgroundValue = Annotated[
    ColorValue | Background,
    BeforeValidator(_background),
    Says("color, or a [background](#background), such as `{sky: {}}`"),
]
