"""A forest: a tree doubled by upright mirrors further and further out (paper, 9.2)."""

import math
from typing import Any

import numpy as np

from .branches import Mirror, Record, Vector, unit
from .tree import tree

# So many trees are enough to see where their edge is.
MOST_TREES = 4096


def forest(
    *,
    doublings: int = 10,
    spacing: float = 7.0,
    scatter: float = math.radians(20),
    roll: float = math.radians(1.2),
    ground: bool = True,
    seed: int = 0,
    **tree_parameters: Any,
) -> Record:
    """The record of a forest of 2^doublings trees around the origin.

    doublings  how often the trees are doubled; at least 1
    spacing    about how far a tree is from the next; crowns that are wider are cut where they meet
    scatter    by how much mirrors are turned off a square lattice, radians, at random and at most
    roll       about how much mirrors lean from upright, radians: so the ground rolls, in valleys and ridges
    ground     whether there is a ground; without it, all trees stand on z = 0 and `roll` is left out
    seed       of the random numbers, also of the tree

    Every other parameter is one of `tree`. Lengths are in units of the scene. "mat" is 0 for bark, 1 for
    leaves and 2 for the ground. The levels are those of the tree and the doublings; the trees between two
    that are mirror images are better of another forest, in one union with this."""
    planted = tree(seed=seed, **tree_parameters)
    rng = np.random.default_rng([seed, 1])
    steps = spacing * (np.arange(12) - 5.5) / 12
    land = np.stack(np.broadcast_arrays(steps[:, np.newaxis], steps, 0.0), axis=-1).reshape(-1, 3)
    land = land + 0.1 * spacing * rng.uniform(-1, 1, 3) * (1, 1, 0)
    mirrors: list[Mirror] = []
    for level in range(doublings):
        azimuth = level * math.pi / 2 + scatter * rng.uniform(-1, 1) * 0.7 ** level
        # The first mirror is upright, since the ground is in one piece below the first two trees.
        lean = roll * rng.normal() if ground and level > 0 else 0.0
        normal = unit(np.array([math.cos(azimuth), math.sin(azimuth), math.sin(lean)]))
        mirror = Mirror(normal, _edge(land @ normal, spacing))
        mirrors.append(mirror)
        land = land[land @ normal <= mirror.offset]
        land = np.concatenate([land, mirror.image(land)])
        if len(land) > 8192: land = rng.permutation(land)[:8192]
    empty: Record = {"type": "empty"}
    soil: Record = {"type": "plane", "n": [0.0, 0.0, 1.0], "h": 0.0, "mat": 2}
    return {
        "mirrors": planted["mirrors"] + [{"u": m.normal.tolist(), "w": m.offset} for m in mirrors],
        "kernels": [*planted["kernels"], soil if ground else empty, *[empty] * (doublings - 1)],
    }


def _edge(heights: Vector, spacing: float) -> float:
    """Where to put a mirror across land with points at these heights above it: where half a row of it is left. A
    mirror further out would leave clearings along its ragged edge, one further in would cut off trees."""
    rows = np.floor((heights.max() - heights) / (0.25 * spacing)).astype(int)
    counts = np.bincount(rows)
    row = int(np.argmax(counts >= 0.5 * np.median(counts)))
    return float(heights.max()) - 0.25 * spacing * row
