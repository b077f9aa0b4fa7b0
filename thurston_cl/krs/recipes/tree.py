"""A tree: a trunk that forks again and again, with leaves around the last twigs (paper, 9.2)."""

import math

import numpy as np

from .branches import UP, Habit, Mirror, Record, Vector, best_walk, foliage, record, walk


def tree(
    *,
    branches: int = 13,
    spread: float = math.radians(26),
    widen: float = math.radians(20),
    lean: float = math.radians(18),
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
    """The record of a tree that stands on z = 0 at the origin, about 3.5 trunks high.

    branches   from trunk to twig, both included; the tree has 2^branches - 1 in all
    spread     half the angle of the first fork, radians
    widen      by how much wider the last fork is than the first, radians
    lean       about how far mirrors lean from the branch before them, radians: at 0 both children of a fork
               turn by the same angle
    turn       by how much the plane of a fork turns from fork to fork, radians
    trunk      length of the trunk above the ground; the next branch has 0.58 of it
    ratio      length of every other branch, in that of the one before it
    thickness  diameter of the trunk
    taper      thickness of a branch, in that of the one before it
    up         how strongly the route bends upwards at every fork
    upright    from 0, branches curl round to a ball, to 1, all grow upwards to a flat crown
    loose      how random all this is, from 0 to 1
    leaves     levels of leaves: a twig has 2^(leaves + 1) - 2
    leaf_size  length of a leaf
    seed       of the random numbers

    Lengths are in units of the scene. "mat" is 0 for bark and 1 for leaves. branches - 1 + leaves levels."""
    habit = Habit(
        branches=branches,
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
    return record(*grown(habit, np.array([0.0, 0.0, -thickness]), leaves, leaf_size, seed))


def grown(
    habit: Habit, foot: Vector, leaves: int, leaf_size: float, seed: int
) -> tuple[list[Mirror], list[Record]]:
    """Mirrors and kernels of a tree with its foot at a point, outermost first."""
    rng = np.random.default_rng(seed)
    route = best_walk(lambda: walk(rng, foot, UP, habit))
    mirrors, kernels = foliage(rng, route, leaves, leaf_size)
    return [*route.mirrors, *mirrors], [*route.kernels, *kernels]
