"""A forest: one tree, doubled by upright mirrors further and further out (paper, 9.2)."""

import math
from typing import Any

import numpy as np

from thurston_cl.krs.vectors import unit

from .branches import Mirror, Record, Vector, record
from .guard import COUNT, guarded
from .tree import tree

# The land of a tree is known by so many points a side, and that of the forest by so many of their images, as
# its trees are.
_POINTS = 12
_MOST_POINTS = 8192
# Where land ends is found to this part of the spacing.
_ROW = 0.25
# The tree stands up to this part of the spacing off the middle of its land: so trees come in pairs, not rows.
_ASIDE = 0.1
# From one mirror to the next the land is larger, and less scatter makes as large a clearing.
_CALMER = 0.7


@guarded(doublings=COUNT)
def forest(
    *,
    doublings: int = 10,
    spacing: float = 7.0,
    scatter: float = math.radians(20),
    roll: float = math.radians(1.2),
    ground: bool = True,
    seed: int = 0,
    **of_tree: Any,
) -> Record:
    """The record of a forest of up to 2^doublings trees, one of them at the origin.

    doublings  how often the trees are doubled; at least 1
    spacing    about how far it is from one tree to the next; wider crowns are cut off where they meet
    scatter    by how much the first mirror is at most turned out of a square lattice, radians; each later one
               by 0.7 of that
    roll       about how much mirrors lean from upright, radians; so the ground rolls in ridges and valleys
    ground     whether there is ground; if not, all trees stand on z = 0 and `roll` is not used
    seed       of the random numbers, also of the tree

    Everything else is a parameter of `tree`. Lengths are in units of the scene. "mat" is 0 for bark, 1 for
    leaves and 2 for ground. The record has as many mirrors as the tree and `doublings`; ValueError if that is
    too many. One forest shows its mirrors. A union of a few, of other seeds and spacings, hides them."""
    rng = np.random.default_rng([seed, 1])
    land = _cell(spacing) + _ASIDE * spacing * rng.uniform(-1, 1, 3) * (1, 1, 0)
    trees = np.zeros((1, 3))
    mirrors: list[Mirror] = []
    for level in range(doublings):
        azimuth = level * math.pi / 2 + _CALMER**level * scatter * rng.uniform(-1, 1)
        # The first mirror is upright: the kernel of its level is the ground, in one piece, below two trees.
        lean = roll * rng.normal() if ground and level > 0 else 0.0
        normal = unit(np.array([math.cos(azimuth), math.sin(azimuth), math.sin(lean)]))
        edge = _edge(land @ normal, _ROW * spacing)
        mirror = Mirror(normal, _between_trees(edge, trees @ normal, spacing))
        mirrors.append(mirror)
        land = _doubled(rng, land, mirror)
        trees = _doubled(rng, trees, mirror)
    soil: Record = (
        {"type": "plane", "n": [0.0, 0.0, 1.0], "h": 0.0, "mat": 2} if ground else {"type": "empty"}
    )
    around: list[Record] = [{"type": "empty"}] * (doublings - 1)
    return record(mirrors[::-1], [*around, soil], inside=tree(seed=seed, **of_tree))


def _cell(side: float) -> Vector:
    """Points of a square of the ground around the origin."""
    steps = side * ((np.arange(_POINTS) + 0.5) / _POINTS - 0.5)
    x, y = np.meshgrid(steps, steps)
    return np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)


def _edge(heights: Vector, row: float) -> float:
    """Where a mirror across land stands, of points at these heights above it: where half a row is left of it.

    Further out it would double the clearings along a ragged edge, further in it would cut off trees."""
    highest = float(heights.max())
    counts = np.bincount(((highest - heights) / row).astype(int))
    return highest - row * int(np.argmax(counts >= 0.5 * np.median(counts)))


def _between_trees(edge: float, heights: Vector, spacing: float) -> float:
    """The offset near `edge` of a mirror that has the fewest trees close to it, which would grow into their
    images; of trees at these heights above it."""
    offsets = edge + spacing * np.array([0.0, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3, 0.4, -0.4])
    close = np.abs(heights - offsets[:, np.newaxis]) < 0.3 * spacing
    return float(offsets[np.argmin(close.sum(axis=1))])


def _doubled(rng: np.random.Generator, points: Vector, mirror: Mirror) -> Vector:
    """What a mirror leaves of points, and its image; of very many, some."""
    left = points[points @ mirror.normal <= mirror.offset]
    doubled = np.concatenate([left, mirror.image(left)])
    return doubled if len(doubled) <= _MOST_POINTS else rng.permutation(doubled)[:_MOST_POINTS]
