"""A school of fish: a few fish, multiplied by mirrors that stand unaligned (KRS paper, figure 5)."""

import math
from typing import Any

import numpy as np

from .folds import EMPTY, Array, tilted
from .guard import guarded
from .pieces import moved, spindle

# Beyond this even a list of where the fish are grows large: 32768 fish.
MOST_DOUBLINGS = 12
LEAST_STAGGER = 2.0  # or they would touch, each being off its place by chance
_X, _Y, _Z = np.eye(3)
# Where fish are along x: in the lower row and its image above it, and in the row between them.
_ROWS = ((0.0, 1.0, -1.0), (0.5, -0.5))
# A fish of length 1 lies within this distance of the segment along which it swims, and that reaches so far.
_GIRTH, _HALF = 0.21, 0.62
_FLATTER = 3.0  # a school is this much wider than high
_HALVINGS = 6
_ROUNDING = 1e-12


@guarded()
def fish_school(
    *,
    doublings: int = 5,
    length: float = 1.0,
    gap: float = 0.8,
    stagger: float = 2.2,
    askew: float = math.radians(10),
    spread: float = math.radians(30),
    seed: int = 1,
) -> dict[str, Any]:
    """The record of a school of 8 · 2^`doublings` fish about the origin, swimming roughly along x; up is z.

    `length` of a fish. `gap`: how much is left free at a mirror at most, and `stagger`: how far fish that
    follow each other are apart, in lengths. `askew`: standard deviation of how far mirrors lean towards x;
    `spread`: how far at most a fish heads off x; angles in radians. Materials: 0 bodies, 1 fins, 2 eyes.
    ValueError for more than MOST_DOUBLINGS, or less than
    LEAST_STAGGER.
    """
    if not 0 <= doublings <= MOST_DOUBLINGS:
        raise ValueError(f"a school is doubled 0 to {MOST_DOUBLINGS} times, not {doublings} times")
    if stagger < LEAST_STAGGER:
        raise ValueError(f"fish follow each other {LEAST_STAGGER} lengths apart at least, not {stagger:g}")
    random = np.random.default_rng(seed)
    centers, headings = np.zeros((0, 3)), np.zeros((0, 3))
    mirrors: list[tuple[Array, float]] = []
    kernels: list[dict[str, Any]] = []

    # Rows one above the other, upright in y; each fish is symmetric in the mirror of its row, and in y.
    for row, places in enumerate(_ROWS):
        # A fish in a mirror turns by twice its lean.
        lean = float(np.clip(random.normal(0, askew / 2), -spread / 2, spread / 2)) if row else 0.0
        normal = tilted(_Z, _X, lean)
        heading = np.array([normal[2], 0.0, -normal[0]])
        turn = np.column_stack([heading, _Y, normal])
        centers, headings, offset = _doubled(centers, headings, normal, random.uniform(0, gap))
        for place in places:
            center = offset * normal + (stagger * place + random.uniform(-0.4, 0.4)) * heading
            # To fold again where a mirror stands already moves nothing: it adds a kernel, and no copy.
            mirrors += [(normal, offset)] * 2 + [(_Y, 0.0)] * 2
            kernels += [moved(kernel, turn, center) for kernel in _fish()]
            centers, headings = np.vstack([centers, center]), np.vstack([headings, heading])

    # Mirrors that stand nearly along x keep what is ahead; across that in which the school is narrower.
    for _ in range(doublings):
        extent = np.ptp(centers, axis=0)
        across, other = (_Y, _Z) if extent[1] <= _FLATTER * extent[2] else (_Z, _Y)
        across = tilted(random.choice((-1.0, 1.0)) * across, other, random.normal(0, askew / 2))
        lean = random.normal(0, askew)
        for _ in range(_HALVINGS):
            normal = tilted(across, _X, lean)
            turned = headings - 2 * np.outer(headings @ normal, normal)
            if turned[:, 0].min() >= math.cos(spread) - _ROUNDING:
                break
            lean /= 2
        else:
            normal = across
        centers, headings, offset = _doubled(centers, headings, normal, random.uniform(0, gap))
        mirrors.append((normal, offset))
        kernels.append(EMPTY)

    shift = -length * (centers.max(axis=0) + centers.min(axis=0)) / 2
    return {
        "mirrors": [{"u": u.tolist(), "w": float(length * offset + u @ shift)} for u, offset in mirrors],
        "clips": True,
        "kernels": [moved(kernel, shift=shift, scale=length) for kernel in [*kernels, EMPTY]],
    }


def _doubled(centers: Array, headings: Array, normal: Array, gap: float) -> tuple[Array, Array, float]:
    """Fish and their images in a mirror across this normal, beyond them all, and its offset."""
    if len(centers) == 0:
        return centers, headings, 0.0
    reach = centers @ normal + _GIRTH + _HALF * np.abs(headings @ normal)
    offset = float(reach.max() + gap)
    copies = centers - 2 * np.outer(centers @ normal - offset, normal)
    turned = headings - 2 * np.outer(headings @ normal, normal)
    return np.concatenate([centers, copies]), np.concatenate([headings, turned]), offset


def _fish() -> list[dict[str, Any]]:
    """The kernels of a fish of length 1 about the origin that heads along x: two halved across z and y, two
    across y alone."""
    return [
        spindle((-0.34, 0, 0.01), (-0.62, 0, -0.2), 0.06, 0.012, _Y, 1),  # a lobe of the tail
        spindle((0.1, 0, -0.08), (-0.2, 0, -0.17), 0.07, 0.012, _Y, 1),  # a fin on the back and one below
        spindle((0.5, 0, 0), (-0.47, 0, 0), 0.135, 0.075, _Y, 0),
        {"type": "sphere", "c": [0.34, -0.036, 0], "r": 0.026, "mat": 2},
    ]
