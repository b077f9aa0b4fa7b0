"""A shrub: many stems out of the ground side by side, by upright mirrors around a thin tree (paper, 9.2)."""

import math

import numpy as np

from .branches import Habit, Mirror, Record, best_walk, foliage, record, sectors, unit, walk


def shrub(
    *,
    stems: int = 3,
    branches: int = 9,
    spread: float = math.radians(22),
    open: float = math.radians(28),
    turn: float = math.radians(137.5),
    stem: float = 0.5,
    ratio: float = 0.82,
    thickness: float = 0.05,
    taper: float = 0.82,
    upright: float = 0.6,
    loose: float = 0.6,
    leaves: int = 3,
    leaf_size: float = 0.12,
    seed: int = 0,
) -> Record:
    """The record of a shrub that stands on z = 0 around the origin.
    """
    rng = np.random.default_rng(seed)
    walls, outwards = [], 0.0
    for normal, middle in sectors(rng, stems):
        leaning = rng.uniform(-0.15, 0.15)
        outwards = middle
        walls.append(Mirror(unit(np.array([math.cos(normal), math.sin(normal), leaning])), 0.0))
    horizontal = np.array([math.cos(outwards), math.sin(outwards), 0.0])
    foot = 3*thickness*horizontal - np.array([0,0,2*thickness])
    along = math.sin(open)*horizontal + np.array([0,0,math.cos(open)])
    habit = Habit(branches, spread, math.radians(20), math.radians(15), turn, stem, stem*.8, ratio, .5*thickness, taper, 0.12, upright, loose)
    route = best_walk(lambda: walk(rng, foot, along, habit), walls)
    m, k = foliage(rng, route, leaves, leaf_size)
    return record([*walls, *route.mirrors, *m], [*[{"type": "empty"}]*stems, *route.kernels, *k])
