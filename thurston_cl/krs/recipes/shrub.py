"""A shrub: many stems out of the ground around one place, a thin tree and upright mirrors (paper, 9.2)."""

import math

import numpy as np

from thurston_cl.krs.vectors import unit

from .branches import Habit, Mirror, Record, best_walk, foliage, record, sectors, walk
from .guard import guarded

# How far the mirrors around the middle lean at most: stems at unequal angles, and still out of the ground.
_LEAN = 0.08


@guarded()
def shrub(
    *,
    stems: int = 3,
    levels: int = 9,
    spread: float = math.radians(26),
    widen: float = math.radians(20),
    lean: float = math.radians(15),
    outwards: float = math.radians(28),
    turn: float = math.radians(137.5),
    stem: float = 0.5,
    ratio: float = 0.82,
    thickness: float = 0.05,
    taper: float = 0.82,
    up: float = 0.12,
    upright: float = 0.45,
    loose: float = 0.6,
    leaves: int = 3,
    leaf_size: float = 0.12,
    seed: int = 0,
) -> Record:
    """The record of a shrub around the origin of the ground z = 0, about 4 stems high and 7 wide.

    stems      how often stems are doubled: there are 2^stems
    levels     branches from a stem to a twig, both included
    spread     half the angle of the first fork, radians
    widen      by how much more the last fork has, radians
    lean       about how far mirrors lean from the branch before them, radians
    outwards   how far a stem leans outwards, radians; about, since mirrors lean too
    turn       by how much the plane of a fork turns from one to the next, radians
    stem       length of a stem above the ground up to its first fork
    ratio      length of every other branch, in that of the one before it
    thickness  diameter of a stem
    taper      thickness of a branch, in that of the one before it
    up         how strongly the route bends upwards at every fork
    upright    from 0, branches curl around to balls, to 1, all of them grow upwards
    loose      how random all this is, from 0 to 1
    leaves     levels of leaves: a twig has 2^(leaves + 1) - 2 of them
    leaf_size  diameter of a leaf
    seed       of the random numbers

    Lengths are in units of the scene. "mat" is 0 for bark and 1 for leaves. The record has
    stems + levels - 1 + leaves mirrors; ValueError if that is too many."""
    rng = np.random.default_rng(seed)
    around = []
    azimuth = 0.0
    for normal, middle in sectors(rng, stems):
        leaning = unit(np.array([math.cos(normal), math.sin(normal), rng.uniform(-_LEAN, _LEAN)]))
        around.append(Mirror(leaning, 0.0))
        azimuth = middle
    horizontal = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    along = math.sin(outwards) * horizontal + np.array([0.0, 0.0, math.cos(outwards)])
    # The foot is below the ground, where the round end of a stem is not seen, and beside the other stems.
    below = 2 * thickness / math.cos(outwards)
    foot = 3 * thickness * horizontal - below * along
    habit = Habit(
        levels=levels,
        spread=spread,
        widen=widen,
        lean=lean,
        turn=turn,
        trunk=stem + below,
        second=0.8 * stem,
        ratio=ratio,
        radius=0.5 * thickness,
        taper=taper,
        up=up,
        upright=upright,
        loose=loose,
    )
    route = best_walk(lambda: walk(rng, foot, along, habit), around)
    mirrors, kernels = foliage(rng, route, leaves, leaf_size)
    nothing: list[Record] = [{"type": "empty"}] * stems
    return record([*around, *route.mirrors, *mirrors], [*nothing, *route.kernels, *kernels])
