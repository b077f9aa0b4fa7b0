"""A meadow: a few blades of grass, doubled by upright mirrors further and further out (paper, 9.2)."""

import math

import numpy as np

from .branches import UP, Mirror, Record, Vector, record
from .guard import guarded

# Blades of the first tuft that are kernels, each doubled once less than the one before it.
_BLADES = 4
# From one mirror to the next less is turned out of a square lattice, of what the first one is.
_CALMER = 0.88
_SCATTER = 0.5
# Mirrors stand where they cut off this share of the blades, which hides straight edges: the first more.
_CUT, _CUT_FIRST = 0.14, 0.2
_FIRST = 5
# A tuft is sown by mirrors that go through it.
_WITHIN, _SOWN = 0.35, 3
# The meadow is known by so many points, and where they were doubled.
_MOST_POINTS = 4096


@guarded()
def meadow(*, doublings: int = 24, blade: float = 0.3, thickness: float = 0.02, seed: int = 0) -> Record:
    """The record of a meadow about the origin of the ground z = 0, which is not part of it.

    doublings  how often the blades are doubled: each two more make it twice as wide; at least 4
    blade      length of the longest blades
    thickness  diameter of a blade
    seed       of the random numbers

    Lengths are in units of the scene. With n doublings it is about 0.04 * 2^(n/2) blades wide, or twice
    that. "mat" is 0 for the blades. The record has as many mirrors as doublings; ValueError
    if that is too many or too few."""
    if doublings < _BLADES:
        raise ValueError(f"a meadow is doubled at least {_BLADES} times, not {doublings} times")
    rng = np.random.default_rng(seed)
    kernels = [_blade(rng, blade, thickness) for _ in range(_BLADES)]
    points = _points(kernels[0])
    mirrors: list[Mirror] = []
    for level in range(doublings):
        azimuth = level * math.pi / 2 + _CALMER**level * _SCATTER * rng.uniform(-1, 1)
        normal = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
        heights = points @ normal
        if level < _SOWN:
            offset = _WITHIN * float(heights.max())
        else:
            offset = float(np.quantile(heights, 1 - (_CUT_FIRST if level < _FIRST else _CUT)))
        mirror = Mirror(normal, offset)
        mirrors.append(mirror)
        left = points[heights <= offset]
        points = np.concatenate([left, mirror.image(left)])
        if level + 1 < _BLADES:
            points = np.concatenate([points, _points(kernels[level + 1])])
        if len(points) > _MOST_POINTS:
            points = rng.permutation(points)[:_MOST_POINTS]
    aside = -points.mean(axis=0) * (1, 1, 0)
    nothing: list[Record] = [{"type": "empty"}] * (doublings + 1 - _BLADES)
    return record(
        [Mirror(m.normal, m.offset + float(m.normal @ aside)) for m in reversed(mirrors)],
        [*nothing, *(_moved(kernel, aside) for kernel in reversed(kernels))],
    )


def _blade(rng: np.random.Generator, length: float, thickness: float) -> Record:
    """A blade near the origin that bends over to some side, its foot in the ground."""
    height, azimuth = length * rng.uniform(0.55, 1.0), rng.uniform(0, 2 * math.pi)
    bends = height * rng.uniform(0.25, 0.6) * np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    foot = 0.1 * length * rng.uniform(-1, 1, 3) * (1, 1, 0)
    return {
        "type": "torcap",
        "p": (foot - 0.05 * length * UP).tolist(),
        "q": (foot + bends + height * UP).tolist(),
        "m": (foot + 0.3 * bends + 0.62 * height * UP).tolist(),
        "r": 0.5 * thickness,
        "mat": 0,
    }


def _points(blade: Record) -> Vector:
    """Where a blade is (3, 3)."""
    return np.array([blade[end] for end in "pqm"])


def _moved(blade: Record, by: Vector) -> Record:
    return blade | {end: (np.array(blade[end]) + by).tolist() for end in "pqm"}
