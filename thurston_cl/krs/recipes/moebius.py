"""Möbius maps of space as 2x2 matrices of quaternions (Szécsi et al., section 6), to build records with.

A quaternion is [w, x, y, z], a point (x, y, z) the quaternion [0, x, y, z]; [[a, b], [c, d]] maps q to
(a q + b) (c q + d)^-1. Matrices are arrays (2, 2, 4); their product is composition.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
_ONE, _ZERO = np.array([1.0, 0, 0, 0]), np.zeros(4)


def quaternion(point: ArrayLike) -> Array:
    """Points (..., 3) as quaternions (..., 4)."""
    array = np.asarray(point, dtype=float)
    return np.concatenate([np.zeros((*array.shape[:-1], 1)), array], axis=-1)


def times(left: Array, right: Array) -> Array:
    """The product of quaternions (..., 4)."""
    w, v = left[..., :1], left[..., 1:]
    u, r = right[..., :1], right[..., 1:]
    real = w * u - np.sum(v * r, axis=-1, keepdims=True)
    return np.concatenate([real, w * r + u * v + np.cross(v, r)], axis=-1)


def conjugate(q: Array) -> Array:
    """The conjugate of quaternions (..., 4)."""
    return q * np.array([1.0, -1, -1, -1])


def matrix(a: Array, b: Array, c: Array, d: Array) -> Array:
    """The matrix [[a, b], [c, d]]."""
    return np.array([[a, b], [c, d]])


def translation(shift: ArrayLike) -> Array:
    """q + shift."""
    return matrix(_ONE, quaternion(shift), _ZERO, _ONE)


def dilation(factor: float) -> Array:
    """factor q."""
    return matrix(factor * _ONE, _ZERO, _ZERO, _ONE)


def rotation(turn: Array) -> Array:
    """The rotation by an orthogonal matrix (3, 3) of determinant 1."""
    # The eigenvector of the largest eigenvalue (Bar-Itzhack 2000): safe at half turns too.
    m = turn
    k = np.array(
        [
            [m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
            [m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], m[1, 1] - m[0, 0] - m[2, 2], m[1, 2] + m[2, 1]],
            [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], m[2, 2] - m[0, 0] - m[1, 1]],
        ]
    )
    r = np.linalg.eigh(k)[1][:, 3]
    return matrix(r, _ZERO, _ZERO, r)


def bend(pole: ArrayLike) -> Array:
    """The special conformal map q (v q + 1)^-1, v = (x, y, z): the origin stays, as does what is near it, and
    the point v / |v|² goes to infinity."""
    return matrix(_ONE, _ZERO, quaternion(pole), _ONE)


def composed(*maps: Array) -> Array:
    """The matrix of the maps one after the other, the last applied first."""
    result = maps[0]
    for m in maps[1:]:
        result = np.array(
            [[times(result[i, 0], m[0, j]) + times(result[i, 1], m[1, j]) for j in (0, 1)] for i in (0, 1)]
        )
    return result


def applied(m: Array, points: ArrayLike) -> Array:
    """The images of points (..., 3)."""
    q = quaternion(points)
    below = times(m[1, 0], q) + m[1, 1]
    image = times(times(m[0, 0], q) + m[0, 1], conjugate(below)) / np.sum(below**2, axis=-1, keepdims=True)
    return np.asarray(image[..., 1:])
