"""What recipes that simulate the fold of a kernel-reflection sequence share (KRS paper, section 3).

A recipe of this kind takes sample points of what it wants to cover, and chooses mirrors from the outermost to
the innermost, each by where the samples lie after the ones before it.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from thurston_cl.krs.vectors import unit

Array = NDArray[np.float64]
Mirror = tuple[Array, float]  # unit normal, offset
EMPTY: dict[str, Any] = {"type": "empty"}
GATHERING = 5  # how many mirrors turn a whole sphere to one side

_ASKEW = 0.35  # standard deviation in radians, so that facets and pores stand in no grid


def fold(points: Array, normal: Array, offset: float) -> Array:
    """Points (N, 3), those beyond the mirror reflected to its negative side."""
    return points - 2 * np.maximum(points @ normal - offset, 0.0)[:, None] * normal


def longest_axis(points: Array, across: Array | None = None) -> Array:
    """The unit vector along which points (N, 3) vary most, orthogonal to the unit vector `across`, if any."""
    spread = points - points.mean(axis=0)
    if across is not None:
        spread = spread - np.outer(spread @ across, across)
    axes = np.linalg.eigh(spread.T @ spread)[1]
    return np.asarray(axes[:, 2])


def tilted(normal: Array, towards: Array, angle: float) -> Array:
    """A unit normal, turned by an angle towards a unit vector orthogonal to it."""
    return np.asarray(np.cos(angle) * normal + np.sin(angle) * towards)


def over_ball(
    random: np.random.Generator, directions: Array, levels: int, uneven: float, lean: float, jitter: float
) -> tuple[Array, list[Mirror], Array]:
    """Mirrors, outermost first, that fold the unit sphere into one small patch that faces one way.

    The first GATHERING of them turn all `directions` (N, 3) to the same side, less cleanly the larger
    `uneven`; the others halve the patch, each leaning out of it by N(0, `lean`) radians, off its middle by up
    to `jitter` of its standard deviation. Returns also the folded directions and which way they face.
    """
    points, mirrors, outward = directions, [], np.zeros(3)
    for i in range(levels):
        if i < GATHERING:
            normal = unit(longest_axis(points) + random.normal(0, 0.2, 3))
            offset = random.normal(0, uneven) if i < 3 else float((points @ normal).mean())
        else:
            axis = longest_axis(points, outward)
            axis = tilted(axis, np.cross(outward, axis), random.normal(0, _ASKEW))
            normal = tilted(axis, outward, random.normal(0, lean))
            along = points @ normal
            offset = float(along.mean() + random.uniform(-jitter, jitter) * along.std())
        points = fold(points, normal, offset)
        mirrors.append((normal, offset))
        if i == GATHERING - 1:
            outward = unit(points.mean(axis=0))
    return points, mirrors, outward


def farthest_turn(directions: Array, mirrors: list[Mirror], outward: Array) -> float:
    """The least cosine to `outward` of directions (N, 3) once folded from afar, where no offset counts."""
    for normal, _ in mirrors:
        directions = fold(directions, normal, 0.0)
    return float((directions @ outward).min())


def sequence(
    mirrors: list[Mirror],
    kernels: dict[int, dict[str, Any]],
    scale: float = 1.0,
    smooth: list[float] | None = None,
) -> dict[str, Any]:
    """The record of mirrors (unit normal, offset) and, if any, widths of smoothing, listed outermost first.

    `kernels`: by level, already to scale; the other levels are empty. `scale` multiplies offsets and widths.
    """
    record: dict[str, Any] = {
        "mirrors": [{"u": u.tolist(), "w": float(scale * offset)} for u, offset in reversed(mirrors)],
        "clips": True,
        "kernels": [kernels.get(level, EMPTY) for level in range(len(mirrors) + 1)],
    }
    if smooth is not None:
        record["smooth"] = [float(scale * width) for width in reversed(smooth)]
    return record
