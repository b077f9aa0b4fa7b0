"""Terrain: a level plane folded together until one slope is enough (KRS paper, section 9.1)."""

import math
from typing import Any

import numpy as np

from thurston_cl.krs.sequence import MOST_LEVELS

from .folds import Array, fold, longest_axis, sequence, tilted
from .guard import ANGLE, guarded

# Terrain that is gentle and well aligned.
SEABED: dict[str, Any] = {
    "size": 60.0,
    "levels": 14,
    "roughness": math.radians(1),
    "slope": math.radians(9),
    "steepest": math.radians(18),
    "wander": math.radians(10),
    "ripples": 4,
    "seed": 3,
}
_SAMPLES = 8000
_UPRIGHT = 3  # outermost mirrors that are vertical, or there would be walls where the sampled square ends
LEAST_LEVELS = _UPRIGHT + 1
_HALVINGS = 6


@guarded(roughness=ANGLE)
def terrain(
    *,
    size: float = 300.0,
    levels: int = 22,
    roughness: float = math.radians(6),
    slope: float = math.radians(11),
    steepest: float = math.radians(50),
    smooth: float = 1.0,
    wander: float = math.radians(20),
    ripples: int = 0,
    seed: int = 7,
) -> dict[str, Any]:
    """The record of land of mean height 0 about the origin; up is z.

    `size`: side of the square that it is made for; beyond it slopes go on without detail. `levels`: mirrors,
    4 to 40; two more halve the smallest facets. `roughness`: standard deviation of how far mirrors lean,
    which changes slopes by twice that. `slope` is that of the plane that all facets are copies of, and no
    sampled facet is steeper than `steepest`. `smooth`: how far shading hides edges. `wander`: how
    irregularly ridges run: twice the standard deviation from the longest axis of what is folded. `ripples`:
    so many of the innermost mirrors cross the slope, which makes ripples of its steepness, their crests
    nearly along y. Angles in radians.
    """
    if not LEAST_LEVELS <= levels <= MOST_LEVELS:
        raise ValueError(f"a terrain has {LEAST_LEVELS} to {MOST_LEVELS} levels, not {levels}")
    if not 0 < slope < steepest < math.pi / 2:
        raise ValueError("of a terrain, slope is above 0 and below steepest, and that is below a right angle")
    if not 0 <= ripples < levels:
        raise ValueError(f"of {levels} levels 0 to {levels - 1} make ripples, not {ripples}")
    random = np.random.default_rng(seed)
    direction = 0.0 if ripples else random.uniform(0, 2 * math.pi)
    facing = np.array([math.cos(direction), math.sin(direction), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    points = np.column_stack([random.uniform(-0.5, 0.5, (_SAMPLES, 2)), np.zeros(_SAMPLES)])
    ups = np.tile(up, (_SAMPLES, 1))  # which way was up in the world, at each folded point
    sign, mirrors, widths = 1.0, [], []
    for i in range(levels):
        axis = longest_axis(points, up)
        if ripples:
            sideways = abs(float(axis @ facing)) < math.sqrt(0.5) and i < levels - ripples
            axis = np.cross(up, facing) if sideways else facing
        turned = random.normal(0, wander / 2)
        across = math.cos(turned) * axis + math.sin(turned) * np.cross(up, axis)
        along = points @ across
        offset = float(np.median(along) + random.uniform(-0.25, 0.25) * along.std())
        lean = abs(random.normal(0, roughness * (1 - i / (3 * levels)))) if i >= _UPRIGHT else 0.0
        normal = tilted(across, up, sign * lean)
        # Lean less where that would make walls.
        for _ in range(_HALVINGS):
            if _steepest(_turned(points, ups, normal, offset)) + slope <= steepest:
                break
            lean /= 2
            normal = tilted(across, up, sign * lean)
        else:
            normal = across
        ups = _turned(points, ups, normal, offset)
        points = fold(points, normal, offset)
        mirrors.append((normal, offset))
        widths.append(0.1 * smooth * float(along.std()))
        sign = -sign
    if ripples:
        # A quarter of the way from crest to crest, at every crest, makes a wave of a zigzag.
        quarter = np.subtract(*np.quantile(points @ facing, (0.75, 0.25)))
        widths = [smooth * float(quarter)] * levels
    normal = tilted(up, facing, slope)
    height = size * float((points @ normal).mean())
    plane = {"type": "plane", "n": normal.tolist(), "h": height, "mat": 0}
    return sequence(mirrors, {0: plane}, size, widths)


def seabed(**others: Any) -> dict[str, Any]:
    """The record of a sea floor with ripples of sand: of terrain with the values of SEABED unless given."""
    return terrain(**{**SEABED, **others})


def _turned(points: Array, ups: Array, normal: Array, offset: float) -> Array:
    """The directions `ups` at points (N, 3), folded with them."""
    beyond = points @ normal > offset
    return np.asarray(ups - 2 * (beyond * (ups @ normal))[:, None] * normal)


def _steepest(ups: Array) -> float:
    """The largest angle to z of directions (N, 3)."""
    return float(np.arccos(np.clip(ups[:, 2], -1.0, 1.0)).max())
