"""The frond of a palm as a Moebius sequence, so that it bends and no leaflet equals another (KRS paper,
section 6 and figure 13)."""

import math
from typing import Any

import numpy as np

from thurston_cl.krs.moebius import (
    Map,
    bend,
    conjugate,
    dilation,
    embedded,
    identity,
    product,
    rotation,
    translation,
)
from thurston_cl.krs.vectors import unit

from .folds import EMPTY, Array
from .guard import AMOUNT, guarded
from .pieces import spindle

MOST_DOUBLINGS = 12
_X, _Y, _Z = np.eye(3)
_STEP = 1e-4  # between the points that tell which way the midrib goes, in distances between leaflets
_RIB = 0.2  # radius of the midrib, in the same


@guarded(taper=AMOUNT)
def palm_leaf(
    *,
    length: float = 1.0,
    doublings: int = 6,
    leaflets: float = 0.25,
    width: float = 0.42,
    hang: float = math.radians(14),
    droop: float = 0.25,
    taper: float = 2.2,
    fullness: float = 0.0,
    uneven: float = 0.18,
    stalk: float = 0.4,
    seed: int = 5,
) -> dict[str, Any]:
    """The Moebius record of a frond whose blade begins at the origin and grows along x; up is z.

    `length` of the blade, straight from end to end, and about that of the `stalk`, in lengths of it.
    2^`doublings` leaflets on either side, as long as `leaflets`, about, in lengths of the midrib before it is
    bent, and `width` half their width, in distances between them. `hang`: how far they slope down from the
    midrib, in radians. `droop`: how strongly it bends down. `taper`: how strongly leaflets get smaller
    towards its end and all sweep ahead, 0 to about 4; `fullness`: how strongly they get smaller towards both
    ends, 0 to about 1. `uneven`: how strongly maps of the other levels bend and scale, each by chance.
    Materials: 0 leaflets, 1 midrib. ValueError for a number of doublings not from 1 to MOST_DOUBLINGS.
    """
    if not 1 <= doublings <= MOST_DOUBLINGS:
        raise ValueError(f"leaflets are doubled 1 to {MOST_DOUBLINGS} times, not {doublings} times")
    random = np.random.default_rng(seed)
    count = 2**doublings
    blade = leaflets * (1 + fullness) * count

    # Halves of one leaflet meet at x = 0; it grows along z from a piece of midrib along y, which is 1 long.
    kernels = [
        spindle((0, 0, 0), (0, 0, blade), width, 0.36 * width, _X, 0),
        {"type": "capsule", "a": [0.0, -0.55, 0.0], "b": [0.0, 0.55, 0.0], "r": _RIB, "mat": 1},
    ]
    grown = np.array([0.0, math.cos(hang), math.sin(hang)])
    before = rotation(np.column_stack([np.cross(_X, grown), _X, grown]))
    # Where the piece of midrib ends, a point short of that, and both again at its other end.
    rib = np.array([[0.5, 0, 0], [0.5 - _STEP, 0, 0], [-0.5, 0, 0], [-0.5 + _STEP, 0, 0]])

    # Double the leaflets of one side: a mirror stands across the midrib where it ends.
    maps: list[Map] = []
    for i in range(doublings):
        row = float(np.linalg.norm(rib[2] - rib[0]))
        by_chance = uneven * random.uniform(-1, 1, 2) * (0.5, 0.25) / max(row, blade) if i else (0.0, 0.0)
        full = fullness / row if i == doublings - 1 else 0.0
        ending = bend((by_chance[0] + full, 0, by_chance[1])) @ _at_end(rib)
        maps.append(ending @ before)
        left = _images(ending, rib[2:])
        rib = np.concatenate([left * (-1, 1, 1), left])
        before = identity()
        kernels.append(EMPTY)

    # Double the side; then bend the whole, all of it ahead of what goes to infinity.
    to_side = rotation(np.column_stack([-_Y, -_X, -_Z])) @ _at_end(rib)
    tip = _images(to_side, rib[2])
    reach = float(np.linalg.norm(tip))
    maps.append(to_side @ before)
    sideways = 0.15 * random.choice((-1.0, 1.0))
    bent = bend(np.array([sideways, -taper, droop]) / reach)
    whole = rotation(np.column_stack([-_Y, _X, _Z])) @ bent
    size = float(np.linalg.norm(_images(whole, tip)))
    maps.append(dilation(length / size) @ whole)
    # Behind the blade a length t becomes about t / (1 − taper t / reach): nearer to the pole, longer.
    stem = stalk * size / (1 + taper * stalk * size / reach)
    # As thick as the midrib is where it begins, so that one goes on as the other.
    stem_radius = _RIB * float(np.linalg.norm(rib[1] - rib[0])) / _STEP
    kernels.append(
        {"type": "capsule", "a": [0.0, -stem, 0.0], "b": [0.0, 0.0, 0.0], "r": stem_radius, "mat": 1}
    )
    return {"G": [m.matrix.tolist() for m in maps], "clips": True, "kernels": kernels}


def _at_end(rib: Array) -> Map:
    """The motion that takes the end of the midrib, in y = 0, to the origin and its direction there to x."""
    ahead = unit(rib[0] - rib[1])
    turn = np.array([[ahead[0], 0, ahead[2]], [0, 1, 0], [-ahead[2], 0, ahead[0]]])
    return rotation(turn) @ translation(-rib[0])


def _images(of: Map, points: Array) -> Array:
    """The images (..., 3) of points (..., 3): without a device, on which Map.apply works."""
    (a, b), (c, d) = of.matrix
    q = embedded(points)
    below = product(c, q) + d
    return product(product(a, q) + b, conjugate(below))[..., 1:] / np.sum(below**2, axis=-1, keepdims=True)
