"""A sequence in words: how much the mirrors make of it, how far it reaches, and its levels one by one."""

import math
from collections.abc import Sequence as Series
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thurston_cl.krs.moebius import Map
from thurston_cl.krs.sequence import Mirror, MoebiusSequence, Sequence
from thurston_cl.models import PRODUCTS


@dataclass(frozen=True)
class Level:
    """One level: its mirror or map in words, none for the innermost; its kernel, if any, what that is made of
    where it is not what the object is made of, and how often it is there after all mirrors.
    """

    step: str | None
    kernel: str | None
    made_of: str | None
    instances: int

    def __str__(self) -> str:
        made = "" if self.made_of is None else f": {self.made_of}"
        kernel = None if self.kernel is None else f"{self.instances} x {self.kernel}{made}"
        return "; ".join(part for part in (self.step, kernel) if part) or "nothing"


def in_short(sequence: Sequence | MoebiusSequence) -> str:
    """Levels, instances and bounding radius."""
    reach = (
        f"within {sequence.radius:.4g} of its origin" if math.isfinite(sequence.radius) else "without bound"
    )
    kind = "Moebius level" if isinstance(sequence, MoebiusSequence) else "level"
    return f"{_count(sequence.levels, kind)}, {_count(sequence.instances, 'kernel')} in all, {reach}"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number != 1)}"


def levels_of(sequence: Sequence | MoebiusSequence, made_of: Series[str | None]) -> list[Level]:
    """The levels, the innermost first; `made_of` names the materials by the part of a kernel."""
    if isinstance(sequence, MoebiusSequence):
        steps = [_map_in_words(map_) for map_ in sequence.maps]
    else:
        steps = [_mirror_in_words(mirror, sequence.geometry) for mirror in sequence.mirrors]
    found = []
    for i, (step, kernel) in enumerate(zip([None, *steps], sequence.kernels, strict=True)):
        if kernel.is_empty:
            found.append(Level(step, None, None, 0))
        else:
            found.append(Level(step, kernel.words, made_of[kernel.part], 2 ** (sequence.levels - i)))
    return found


def numbered(levels: Series[Level]) -> list[str]:
    """A line for each level."""
    width = len(str(len(levels) - 1))
    return [f"{i:{width}}: {level}" for i, level in enumerate(levels)]


def _mirror_in_words(mirror: Mirror, geometry: str) -> str:
    if geometry == "e3":
        words = f"mirror {_vector(mirror.normal[:3])} at {_short(-float(mirror.form[4] + mirror.form[3]))}"
    elif geometry in PRODUCTS and mirror.form[3] != 0:
        words = f"horizontal mirror at {_short(-float(mirror.form[4] / mirror.form[3]))}"
    else:
        words = _plane_in_words(mirror.normal, geometry)
    return f"{words}, smooth {_short(mirror.width)}" if mirror.width > 0 else words


def _plane_in_words(normal: NDArray[np.float64], geometry: str) -> str:
    """By the geodesic from the origin that a mirror stands across, as scenes write it."""
    first = 2 if geometry in PRODUCTS else 3
    along, back = normal[:first], float(normal[first])
    size = float(np.linalg.norm(along))
    if size < _AT_A_QUARTER_TURN:
        return "mirror a quarter turn from the origin"
    distance = math.asinh(back) if geometry in ("h3", "h2xe") else -math.atan2(back, size)
    direction = along / size if geometry not in PRODUCTS else np.array([*along, 0.0]) / size
    return f"mirror {_vector(direction)} at {_short(distance)}"


# Of a great sphere or circle that is as far from the origin everywhere: how far its normal may be off.
_AT_A_QUARTER_TURN = 1e-5


def _map_in_words(map_: Map) -> str:
    has_pole, *numbers, factor = map_.numbers
    if not has_pole:
        return f"mirror x = 0, similarity x {_short(factor)}"
    return f"mirror x = 0, map with pole {_vector(np.array(numbers[:3]))}"


def _vector(v: NDArray[np.float64]) -> str:
    return "(" + ", ".join(map(_short, v)) + ")"


def _short(number: float) -> str:
    # What is 0 up to rounding has no sign.
    return f"{number:.3g}" if abs(number) >= 5e-10 else "0"
