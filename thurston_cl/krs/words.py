"""A sequence in words: how much the mirrors make of it, how far it reaches, and its levels one by one."""

import math

import numpy as np
from numpy.typing import NDArray

from thurston_cl.krs.moebius import Map
from thurston_cl.krs.sequence import Mirror, MoebiusSequence, Sequence
from thurston_cl.models import PRODUCTS


def in_short(sequence: Sequence | MoebiusSequence) -> str:
    """Levels, instances and bounding radius."""
    reach = (
        f"within {sequence.radius:.4g} of its origin" if math.isfinite(sequence.radius) else "without bound"
    )
    kind = "Moebius levels" if isinstance(sequence, MoebiusSequence) else "levels"
    return f"{sequence.levels} {kind}, {sequence.instances} kernels in all, {reach}"


def level_by_level(sequence: Sequence | MoebiusSequence) -> list[str]:
    """What each level does, the innermost first."""
    lines = [f"0: {sequence.kernels[0].words}"]
    if isinstance(sequence, MoebiusSequence):
        steps = [_map_in_words(map_) for map_ in sequence.maps]
    else:
        steps = [_mirror_in_words(mirror, sequence.geometry) for mirror in sequence.mirrors]
    for i, step in enumerate(steps, start=1):
        kernel = sequence.kernels[i]
        lines.append(f"{i}: {step}" + ("" if kernel.is_empty else f"; {kernel.words}"))
    return lines


def _mirror_in_words(mirror: Mirror, geometry: str) -> str:
    if geometry == "e3":
        words = f"mirror across {_vector(mirror.normal[:3])} at {-float(mirror.form[4] + mirror.form[3]):.4g}"
    elif geometry in PRODUCTS and mirror.form[3] != 0:
        words = f"horizontal mirror at height {-float(mirror.form[4] / mirror.form[3]):.4g}"
    else:
        words = _plane_in_words(mirror.normal, geometry)
    return f"{words}, smooth within {mirror.width:.4g}" if mirror.width > 0 else words


def _plane_in_words(normal: NDArray[np.float64], geometry: str) -> str:
    """By the geodesic from the origin that a mirror stands across, as scenes write it."""
    first = 2 if geometry in PRODUCTS else 3
    along, back = normal[:first], float(normal[first])
    size = float(np.linalg.norm(along))
    if size < _AT_A_QUARTER_TURN:
        return "mirror a quarter turn from the origin"
    distance = math.asinh(back) if geometry in ("h3", "h2xe") else -math.atan2(back, size)
    direction = along / size if geometry not in PRODUCTS else np.array([*along, 0.0]) / size
    return f"mirror across {_vector(direction)} at {distance:.4g}"


# Of a great sphere or circle that is as far from the origin everywhere: how far its normal may be off.
_AT_A_QUARTER_TURN = 1e-5


def _map_in_words(map_: Map) -> str:
    has_pole, *numbers, factor = map_.numbers
    if not has_pole:
        return f"mirror x = 0, then a similarity, {factor:.4g} times as large"
    return f"mirror x = 0, then a map with its pole at {_vector(np.array(numbers[:3]))}"


def _vector(v: NDArray[np.float64]) -> str:
    # What is 0 up to rounding has no sign.
    return "(" + ", ".join(f"{round(float(c), 9) + 0.0:.4g}" for c in v) + ")"
