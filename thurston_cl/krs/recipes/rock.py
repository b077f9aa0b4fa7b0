"""A rock: a sphere folded together until a plane is enough (KRS paper, figure 8 and section 9.1)."""

import math
from typing import Any

import numpy as np

from thurston_cl.krs.sequence import MOST_LEVELS
from thurston_cl.krs.vectors import unit

from .folds import GATHERING, farthest_turn, fold, over_ball, sequence
from .guard import guarded

LEAST_LEVELS = GATHERING + 1
_SAMPLES = 6000
# From afar all directions are folded nearer to one than this cosine, or the rock would have an open side.
_NEAREST = 0.6
# Between which spheres about the origin the surface lies, in radii.
INNERMOST, OUTERMOST = 0.4, 1.8
_ATTEMPTS = 150
# Over how much of the standard deviation of what it halves shading is smooth at a mirror.
_SMOOTH = 0.3


@guarded()
def rock(
    *, radius: float = 1.0, levels: int = 14, roughness: float = 1.0, smooth: float = 1.0, seed: int = 4
) -> dict[str, Any]:
    """The record of a rock about the origin.

    `radius`: about how far its surface is from the origin: 0.4 to 1.8 of it. `levels`: mirrors, 6 to 40;
    each one past 5 halves the facets. `roughness`: 0 for a cut stone, 1 for a battered one. `smooth`: how
    far shading hides the edges, 0 for facets. ValueError for other numbers of levels, and where
    `roughness` lets no stone close.
    """
    if not LEAST_LEVELS <= levels <= MOST_LEVELS:
        raise ValueError(f"a rock has {LEAST_LEVELS} to {MOST_LEVELS} levels, not {levels}")
    random = np.random.default_rng(seed)
    for _ in range(_ATTEMPTS):
        record = _attempt(random, radius, levels, roughness, smooth)
        if record is not None:
            return record
    raise ValueError(f"no closed rock of roughness {roughness:g} found; take less roughness or another seed")


def _attempt(
    random: np.random.Generator, radius: float, levels: int, roughness: float, smooth: float
) -> dict[str, Any] | None:
    directions = unit(random.normal(size=(_SAMPLES, 3)))
    points, mirrors, outward = over_ball(
        random, directions, levels, 0.1 * roughness, math.radians(5 * roughness), 0.12
    )
    height = 0.97 * float((points @ outward).mean())
    if farthest_turn(directions, mirrors, outward) < _NEAREST:
        return None
    inside, outside = INNERMOST * directions, OUTERMOST * directions
    widths, folded = [], directions
    for normal, offset in mirrors:
        # In proportion to what the mirror halves: the innermost facets are as smooth as the whole.
        widths.append(_SMOOTH * smooth * float((folded @ normal).std()))
        folded = fold(folded, normal, offset)
        inside, outside = fold(inside, normal, offset), fold(outside, normal, offset)
    if not (inside @ outward).max() < height < (outside @ outward).min():
        return None
    plane = {"type": "plane", "n": outward.tolist(), "h": radius * height, "mat": 0}
    return sequence(mirrors, {0: plane}, radius, widths) | {"within": OUTERMOST * radius}
