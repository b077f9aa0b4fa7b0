"""What recipes that simulate the fold of a kernel-reflection sequence share (Szécsi et al., section 3).

A recipe of this kind takes sample points of what it wants to cover, and chooses mirrors from the outermost to
the innermost, each by where the samples lie after the ones before it.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
EMPTY: dict[str, Any] = {"type": "empty"}


def unit(vector: ArrayLike) -> Array:
    """The vector(s) (..., 3) of length 1 in this direction."""
    array = np.asarray(vector, dtype=float)
    return array / np.linalg.norm(array, axis=-1, keepdims=True)


def fold(points: Array, normal: Array, offset: float) -> Array:
    """Points (N, 3), those beyond the mirror reflected to its negative side."""
    return points - 2 * np.maximum(points @ normal - offset, 0.0)[:, None] * normal


def longest_axis(points: Array, across: Array | None = None) -> Array:
    """The unit vector along which points (N, 3) vary most, orthogonal to the unit vector `across` if given."""
    spread = points - points.mean(axis=0)
    if across is not None:
        spread = spread - np.outer(spread @ across, across)
    axes = np.linalg.eigh(spread.T @ spread)[1]
    return np.asarray(axes[:, 2])


def tilted(normal: Array, towards: Array, angle: float) -> Array:
    """A unit normal, turned by an angle towards a unit vector orthogonal to it."""
    return np.asarray(np.cos(angle) * normal + np.sin(angle) * towards)


def sequence(
    folds: list[tuple[Array, float, float]], kernels: dict[int, dict[str, Any]], scale: float = 1.0
) -> dict[str, Any]:
    """The record of mirrors (unit normal, offset, smooth width) that are listed outermost first.

    `kernels`: by level, already to scale; the other levels are empty. `scale` multiplies offsets and widths.
    """
    inner_first = folds[::-1]
    return {
        "mirrors": [{"u": normal.tolist(), "w": float(scale * offset)} for normal, offset, _ in inner_first],
        "kernels": [kernels.get(level, EMPTY) for level in range(len(folds) + 1)],
        "smooth": [float(scale * width) for _, _, width in inner_first],
    }
