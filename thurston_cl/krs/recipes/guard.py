"""What all recipes ask of their parameters: counts, lengths, angles in radians and shares, by their names.

Wider than what scenes allow: only what makes no model, or what was meant in degrees, is refused.
"""

import functools
import math
from collections.abc import Callable
from numbers import Integral, Real
from typing import NamedTuple, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


class Span(NamedTuple):
    """The values of a parameter, from `least` to `most`."""

    words: str
    least: float
    most: float = math.inf
    whole: bool = False
    angle: bool = False
    open: bool = False  # without `least`

    def holds(self, value: object) -> bool:
        """Whether a value is one of them."""
        if not isinstance(value, Integral if self.whole else Real):
            return False
        number = float(value)
        above = self.least < number if self.open else self.least <= number
        return above and number <= self.most and number < math.inf


COUNT = Span("a whole number from 1", 1, whole=True)
COUNT_OR_NONE = Span("a whole number from 0", 0, whole=True)
LENGTH = Span("a number greater than 0", 0, open=True)
AMOUNT = Span("a number from 0", 0)
SHARE = Span("a number from 0 to 1", 0, 1)
# An angle of a scene in degrees is rounded.
ANGLE = Span("an angle from 0 to pi/2 radians", 0, math.pi / 2 + 1e-9, angle=True)
TURN = Span("an angle from -2 pi to 2 pi radians", -2 * math.pi - 1e-9, 2 * math.pi + 1e-9, angle=True)

SPANS = {
    **dict.fromkeys(("levels", "forks"), COUNT),
    **dict.fromkeys(("seed", "doublings", "stems", "leaves", "buds", "foliage"), COUNT_OR_NONE),
    **dict.fromkeys(("trunk", "stem", "limb", "ratio", "thickness", "taper", "leaf_size", "spacing"), LENGTH),
    **dict.fromkeys(("blade", "height", "radius", "size", "length", "leaflets", "width"), LENGTH),
    **dict.fromkeys(("up", "tip_length", "wall", "gap", "lumps", "roughness", "smooth"), AMOUNT),
    **dict.fromkeys(("droop", "fullness", "uneven", "stalk"), AMOUNT),
    **dict.fromkeys(("upright", "loose", "irregular", "threads"), SHARE),
    **dict.fromkeys(("spread", "lean", "outwards", "scatter", "roll", "slope", "steepest"), ANGLE),
    **dict.fromkeys(("wander", "askew", "hang"), ANGLE),
    **dict.fromkeys(("widen", "turn"), TURN),
}


def guarded(**others: Span) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """A recipe that raises ValueError for parameters outside of SPANS, or of `others` where it means
    something else by a name.
    """
    spans = SPANS | others

    def decorate(recipe: Callable[P, R]) -> Callable[P, R]:
        @functools.wraps(recipe)
        def checked(*args: P.args, **parameters: P.kwargs) -> R:
            for name, value in parameters.items():
                span = spans.get(name)
                if span is not None and not span.holds(value):
                    degrees = span.angle and isinstance(value, Real) and span.most < float(value) <= 360
                    cure = f"; in degrees: np.radians({value:g})" if degrees else ""
                    raise ValueError(f"{name} is {value!r}; expected {span.words}{cure}")
            return recipe(*args, **parameters)

        return checked

    return decorate
