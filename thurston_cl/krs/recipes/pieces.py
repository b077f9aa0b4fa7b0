"""Kernels of recipes: flat spindles of what a mirror cuts, and moving kernels."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Which entries of a kernel are points, which directions, and which lengths.
_POINTS = {"sphere": "c", "plane": "", "capsule": "ab", "torcap": "pqm", "lens": "c", "empty": ""}
_DIRECTIONS = {"plane": "n", "lens": "a"}
_LENGTHS = {"sphere": "r", "capsule": "r", "torcap": "r", "lens": "bh"}


def spindle(
    start: ArrayLike, end: ArrayLike, half_width: float, half_thickness: float, out: ArrayLike, mat: int
) -> dict[str, Any]:
    """A bent toroidal capsule of which a mirror through `start` and `end` leaves a pointed half spindle.

    `out`: unit normal of the mirror, orthogonal to start - end, to the side that is cut off. Together the
    two halves are 2 `half_width` wide in the mirror and 2 `half_thickness` across it, at most as much.
    """
    p, q, normal = (np.asarray(v, dtype=float) for v in (start, end, out))
    width = half_width * half_width / half_thickness
    radius, middle = (width + half_thickness) / 2, (width - half_thickness) / 2
    return {
        "type": "torcap",
        "p": (p + radius * normal).tolist(),
        "q": (q + radius * normal).tolist(),
        "m": ((p + q) / 2 + middle * normal).tolist(),
        "r": radius,
        "mat": mat,
    }


def moved(
    kernel: dict[str, Any],
    rotation: NDArray[np.float64] | None = None,
    shift: ArrayLike = (0.0, 0.0, 0.0),
    scale: float = 1.0,
) -> dict[str, Any]:
    """The record of a kernel scaled, then turned by an orthogonal matrix (3, 3), then shifted."""
    turn, to = np.eye(3) if rotation is None else rotation, np.asarray(shift, dtype=float)
    kind, result = kernel["type"], dict(kernel)
    for key in _POINTS[kind]:
        result[key] = (turn @ (scale * np.asarray(kernel[key], dtype=float)) + to).tolist()
    for key in _DIRECTIONS.get(kind, ""):
        result[key] = (turn @ np.asarray(kernel[key], dtype=float)).tolist()
    for key in _LENGTHS.get(kind, ""):
        result[key] = scale * kernel[key]
    if kind == "plane":
        result["h"] = scale * kernel["h"] + float(np.dot(result["n"], to))
    return result
