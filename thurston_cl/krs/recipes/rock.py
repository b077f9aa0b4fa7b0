"""A rock: the unit sphere folded together until a plane is enough (Szécsi et al., figure 8 and section 9.1)."""

from typing import Any

import numpy as np

from .folds import fold, longest_axis, sequence, tilted, unit

_SAMPLES = 6000
_COARSE = 5  # mirrors that gather all directions around one
# All directions end nearer to that one than this cosine, or the far side of the rock would be open.
_NEAREST = 0.6
# Between which spheres about the origin the surface lies, in radii.
INNERMOST, OUTERMOST = 0.4, 1.8
_ATTEMPTS = 400


def rock(
    *, radius: float = 1.0, levels: int = 14, roughness: float = 1.0, smooth: float = 1.0, seed: int = 5
) -> dict[str, Any]:
    """The record of a rock about the origin.

    `radius`: about how far its surface is from the origin: 0.4 to 1.8 of it. `levels`: mirrors, 6 to 40; each one past 5 halves
    the facets. `roughness`: 0 for a nearly round stone, 1 for a battered one, 2 for a heap. `smooth`: how far
    shading hides the edges, 0 for facets. ValueError where no stone is closed.
    """
    if not _COARSE < levels <= 40:
        raise ValueError(f"a rock has {_COARSE + 1} to 40 levels, not {levels}")
    random = np.random.default_rng(seed)
    for _ in range(_ATTEMPTS):
        record = _attempt(random, radius, levels, roughness, smooth)
        if record is not None:
            return record
    raise ValueError(f"no closed rock of roughness {roughness:g} found; take less roughness or another seed")


def _attempt(
    random: np.random.Generator, radius: float, levels: int, roughness: float, smooth: float
) -> dict[str, Any] | None:
    directions = unit(random.normal(size=(_SAMPLES, 3)))
    points, folds = directions, []

    # Gather all directions around one.
    for i in range(_COARSE):
        normal = unit(longest_axis(points) + random.normal(0, 0.2, 3))
        offset = random.normal(0, 0.1 * roughness) if i < 3 else float((points @ normal).mean())
        points = fold(points, normal, offset)
        folds.append((normal, offset, 0.07 * smooth * 0.68**i))
    outward = unit(points.mean(axis=0))

    # Break what faces outward into facets.
    for i in range(_COARSE, levels):
        across = longest_axis(points, outward)
        normal = tilted(across, outward, random.normal(0, np.radians(5 * roughness)))
        along = points @ normal
        offset = float(along.mean() + random.uniform(-0.12, 0.12) * along.std())
        points = fold(points, normal, offset)
        folds.append((normal, offset, 0.07 * smooth * 0.68**i))
    height = 0.97 * float((points @ outward).mean())

    # It is bounded if far away, where offsets do not count, every direction ends on the outward side.
    inside, outside, far = INNERMOST * directions, OUTERMOST * directions, directions
    for normal, offset, _ in folds:
        inside, outside = fold(inside, normal, offset), fold(outside, normal, offset)
        far = fold(far, normal, 0.0)
    heights = (inside @ outward).max(), (outside @ outward).min()
    if not heights[0] < height < heights[1] or (far @ outward).min() < _NEAREST:
        return None
    plane = {"type": "plane", "n": outward.tolist(), "h": radius * height, "mat": 0}
    return sequence(folds, {0: plane}, radius)
