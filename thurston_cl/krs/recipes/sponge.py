"""A sponge: rings around pores, folded over a ball and through its skin (KRS paper, figure 10)."""

import math
from typing import Any

import numpy as np

from thurston_cl.krs.sequence import MOST_LEVELS
from thurston_cl.krs.vectors import unit

from .folds import GATHERING, farthest_turn, longest_axis, over_ball, sequence, tilted
from .guard import guarded

SKIN_LEVELS = GATHERING + 2  # the fewest mirrors that make pores
_SAMPLES = 6000
# From afar all directions are folded nearer to one than this cosine, so that it is round.
_NEAREST = 0.75
_ATTEMPTS = 200
# How far a ring is from closed, in radians: a toroidal capsule has two ends.
_OPEN = 0.04


@guarded()
def sponge(
    *,
    radius: float = 1.0,
    levels: int = 14,
    layers: int = 4,
    threads: float = 0.5,
    lumps: float = 1.0,
    seed: int = 4,
) -> dict[str, Any]:
    """The record of a sponge about the origin.

    `radius`: about how far its surface is from the origin. `levels`: mirrors, 7 to 40; each one more halves
    the pores. `layers`: that many of them fold its skin, which has 2^`layers` layers of pores, 0 for a
    shell. `threads`: how thick is what stands between pores, 0 to 1. `lumps`: 0 for a ball, 2 for a lump.
    ValueError where no round one is found.
    """
    if layers < 0 or not SKIN_LEVELS + layers <= levels <= MOST_LEVELS:
        least = SKIN_LEVELS + max(layers, 0)
        raise ValueError(f"a sponge of {layers} layers has {least} to {MOST_LEVELS} levels, not {levels}")
    random = np.random.default_rng(seed)
    directions = unit(random.normal(size=(_SAMPLES, 3)))
    for _ in range(_ATTEMPTS):
        points, mirrors, outward = over_ball(
            random, directions, levels - layers, 0.15 * lumps, math.radians(4.5 * lumps), 0.3
        )
        if farthest_turn(directions, mirrors, outward) >= _NEAREST:
            break
    else:
        raise ValueError(f"no round sponge of lumps {lumps:g} found; take fewer lumps or another seed")
    center = points.mean(axis=0)
    first = longest_axis(points, outward)
    second = np.cross(outward, first)
    # Of a rectangle in which points are uniform the sides are √12 standard deviations.
    pore = math.sqrt(12 * float(((points - center) @ first).std() * ((points - center) @ second).std()))

    # What is below the skin is folded out of it, layer upon layer.
    for i in reversed(range(layers)):
        below = tilted(-outward, first, random.normal(0, 0.05))
        mirrors.append((below, float(-center @ outward + 0.45 * pore * 2**i)))
    ring, thread = 0.54 * radius * pore, radius * pore * (0.1 + 0.3 * threads)
    middle = radius * center
    opening = math.cos(_OPEN) * first + np.outer((1, -1), math.sin(_OPEN) * second)
    p, q, m = (middle + ring * around for around in (*opening, -first))
    torus = {"type": "torcap", "p": p.tolist(), "q": q.tolist(), "m": m.tolist(), "r": thread, "mat": 0}
    return sequence(mirrors, {0: torus}, radius)
