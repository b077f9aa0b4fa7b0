"""The directions of pictures, worked out beside the kernels from what the projections are defined to be.

In camera coordinates [right, up, forward].
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
RIGHT, UP, FORWARD = np.eye(3)


def turned(start: Array, goal: Array, angle: ArrayLike) -> Array:
    """`start` turned by angles (...) towards the perpendicular `goal`: (...,3)."""
    angle = np.asarray(angle)[..., None]
    return np.cos(angle) * start + np.sin(angle) * goal


def perspective(x: Array, y: Array, size: tuple[int, int], fov: float) -> Array:
    """Through a picture plane at the distance at which its height subtends `fov`."""
    away = 0.5 * size[1] / np.tan(0.5 * fov)
    u = np.stack([x - 0.5 * size[0], 0.5 * size[1] - y, np.full_like(x, away)], axis=-1)
    return u / np.linalg.norm(u, axis=-1, keepdims=True)


def equirectangular(x: Array, y: Array, size: tuple[int, int]) -> Array:
    """Along the horizon by the column, from there up by the row."""
    azimuth = 2 * np.pi * (x / size[0] - 0.5)
    height = np.pi * (0.5 - y / size[1])[..., None]
    return np.cos(height) * turned(FORWARD, RIGHT, azimuth) + np.sin(height) * UP


def fisheye(
    x: Array, y: Array, size: tuple[int, int], angle: float, middle: Array = FORWARD, top: Array = UP
) -> Array:
    """From the middle towards the side that the place is on, by an angle that grows with its distance."""
    across, upwards = x - 0.5 * size[0], 0.5 * size[1] - y
    around = np.arctan2(upwards, across)
    away = np.hypot(across, upwards) / (0.5 * min(size)) * 0.5 * angle
    side = turned(RIGHT, top, around)
    return np.cos(away)[..., None] * middle + np.sin(away)[..., None] * side


def dome(x: Array, y: Array, size: tuple[int, int], angle: float, tilt: float) -> Array:
    """A fisheye whose middle is up, leant to the front; its bottom shows the front."""
    return fisheye(x, y, size, angle, turned(UP, FORWARD, tilt), turned(-FORWARD, UP, tilt))


def middles(size: tuple[int, int]) -> tuple[Array, Array]:
    """The middles of all pixels (H,W)."""
    x, y = np.meshgrid(np.arange(size[0]) + 0.5, np.arange(size[1]) + 0.5)
    return x, y
