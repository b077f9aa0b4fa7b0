"""A tree: a trunk that forks again and again, with leaves around the last twigs (paper, 9.2)."""

import math

import numpy as np

from .branches import UP, Habit, Record, best_walk, foliage, record, walk
from .guard import guarded


@guarded()
def tree(
    *,
    levels: int = 13,
    spread: float = math.radians(26),
    widen: float = math.radians(20),
    lean: float = math.radians(14),
    turn: float = math.radians(137.5),
    trunk: float = 1.7,
    ratio: float = 0.85,
    thickness: float = 0.4,
    taper: float = 0.75,
    up: float = 0.12,
    upright: float = 0.7,
    loose: float = 0.5,
    leaves: int = 3,
    leaf_size: float = 0.2,
    seed: int = 0,
) -> Record:
    """The record of a tree at the origin of the ground z = 0, about 4 trunks high and as wide.

    levels     branches from the trunk to a twig, both included; the tree has 2^levels - 1 in all
    spread     half the angle of the first fork, radians
    widen      by how much more the last fork has, radians
    lean       about how far mirrors lean from the branch before them, radians; at 0 both children of a fork
               turn by the same angle
    turn       by how much the plane of a fork turns from one to the next, radians
    trunk      length of the trunk above the ground; the next branch has 0.58 of it
    ratio      length of every other branch, in that of the one before it
    thickness  diameter of the trunk
    taper      thickness of a branch, in that of the one before it
    up         how strongly the route bends upwards at every fork
    upright    from 0, branches curl around to a ball, to 1, all of them grow upwards to a flat crown
    loose      how random all this is, from 0 to 1
    leaves     levels of leaves: a twig has 2^(leaves + 1) - 2 of them
    leaf_size  diameter of a leaf
    seed       of the random numbers

    Lengths are in units of the scene. "mat" is 0 for bark and 1 for leaves. The record has
    levels - 1 + leaves mirrors; ValueError if that is too many."""
    habit = Habit(
        levels=levels,
        spread=spread,
        widen=widen,
        lean=lean,
        turn=turn,
        trunk=trunk + thickness,
        second=0.58 * trunk,
        ratio=ratio,
        radius=0.5 * thickness,
        taper=taper,
        up=up,
        upright=upright,
        loose=loose,
    )
    rng = np.random.default_rng(seed)
    # The foot is below the ground: the round end of the trunk is not seen.
    foot = np.array([0.0, 0.0, -thickness])
    route = best_walk(lambda: walk(rng, foot, UP, habit))
    mirrors, kernels = foliage(rng, route, leaves, leaf_size)
    return record([*route.mirrors, *mirrors], [*route.kernels, *kernels])
