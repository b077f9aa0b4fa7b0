"""A coral: thick branches that fork from near the ground, with buds and a pale tip on each (paper, 9)."""

import math

import numpy as np

from thurston_cl.krs.vectors import unit

from .branches import UP, Habit, Mirror, Record, Vector, best_walk, record, rosette, sectors, walk
from .guard import guarded

# Radii, in that of the last branch: of its tip and of its buds; and how far buds are from its axis.
_TIP = 1.12
_BUD = 0.45
_BESIDE = 0.9


# Of a tip that is drawn out, in the same: it hardly bulges.
_FINGER = 1.04
# How far the mirrors around the middle lean at most, and stems outwards, radians.
_LEAN = 0.08
_OUTWARDS = math.radians(25)


@guarded()
def coral(
    *,
    stems: int = 0,
    levels: int = 10,
    spread: float = math.radians(34),
    widen: float = 0.0,
    lean: float = math.radians(12),
    turn: float = math.radians(100),
    trunk: float = 0.35,
    limb: float = 0.6,
    ratio: float = 0.86,
    thickness: float = 0.3,
    taper: float = 0.86,
    up: float = 0.3,
    upright: float = 0.5,
    loose: float = 0.5,
    buds: int = 2,
    tip_length: float = 0.0,
    seed: int = 0,
) -> Record:
    """The record of a coral at the origin of the ground z = 0, about 5 limbs high and 7 wide.

    stems      how often stems are doubled: 2^stems grow out of the ground side by side
    levels     branches from the ground to a tip, both included; there are 2^levels - 1 on a stem
    spread     half the angle of the first fork, radians
    widen      by how much more the last fork has, radians
    lean       about how far mirrors lean from the branch before them, radians
    turn       by how much the plane of a fork turns from one to the next, radians
    trunk      length of the first branch above the ground
    limb       length of the second branch
    ratio      length of every other branch, in that of the one before it
    thickness  diameter of the first branch
    taper      thickness of a branch, in that of the one before it
    up         how strongly the route bends upwards at every fork
    upright    from 0, branches curl around, to 1, all of them grow upwards
    loose      how random all this is, from 0 to 1
    buds       levels of buds: a tip has 2^(buds + 1) - 2 of them around it
    tip_length by how much a tip is drawn out into a finger, in diameters of its branch
    seed       of the random numbers

    Lengths are in units of the scene. "mat" is 0 for branches and buds, and 1 for tips. The record has
    stems + levels + buds mirrors; ValueError if that is too many."""
    habit = Habit(
        levels=levels,
        spread=spread,
        widen=widen,
        lean=lean,
        turn=turn,
        trunk=trunk + thickness,
        second=limb,
        ratio=ratio,
        radius=0.5 * thickness,
        taper=taper,
        up=up,
        upright=upright,
        loose=loose,
    )
    rng = np.random.default_rng(seed)
    # The foot is below the ground: its round end is not seen.
    foot, along = np.array([0.0, 0.0, -thickness]), UP
    around = []
    for normal, middle in sectors(rng, stems) if stems else ():
        leaning = unit(np.array([math.cos(normal), math.sin(normal), rng.uniform(-_LEAN, _LEAN)]))
        around.append(Mirror(leaning, 0.0))
        horizontal = np.array([math.cos(middle), math.sin(middle), 0.0])
        foot = np.array([0.0, 0.0, -thickness]) + 0.7 * thickness * horizontal
        along = math.sin(_OUTWARDS) * horizontal + math.cos(_OUTWARDS) * UP
    route = best_walk(lambda: walk(rng, foot, along, habit), around)
    end, radius = route.forks[-1], route.kernels[-1]["r"]

    def grown(level: int, outwards: Vector) -> Record:
        if level < buds:
            center = end - 1.3 * (buds - level) * radius * route.along + _BESIDE * radius * outwards
            return {"type": "sphere", "c": center.tolist(), "r": _BUD * radius, "mat": 0}
        if tip_length == 0:
            return {"type": "sphere", "c": end.tolist(), "r": _TIP * radius, "mat": 1}
        drawn = end + 2 * tip_length * radius * route.along
        return {"type": "capsule", "a": end.tolist(), "b": drawn.tolist(), "r": _FINGER * radius, "mat": 1}

    mirrors, kernels = rosette(rng, route, buds + 1, grown)
    nothing: list[Record] = [{"type": "empty"}] * stems
    return record([*around, *route.mirrors, *mirrors], [*nothing, *route.kernels, *kernels])
