"""Vectors of space: their lengths, their directions, and what is across them."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def length_of(vectors: ArrayLike) -> Array:
    """The lengths (...) of vectors (..., 3), also where the squares of their entries are no numbers."""
    scaled, exponent = _scaled(vectors)
    return np.ldexp(np.linalg.norm(scaled, axis=-1), exponent[..., 0])


def unit(vectors: ArrayLike) -> Array:
    """The vectors (..., 3) of length 1 in these directions; of a zero vector NaN."""
    scaled, _ = _scaled(vectors)
    return np.asarray(scaled / np.linalg.norm(scaled, axis=-1, keepdims=True))


def across(direction: Array, wanted: Array) -> Array:
    """The unit vector (3,) perpendicular to a unit direction that is nearest to a wanted one."""
    return unit(wanted - (wanted @ direction) * direction)


def two_across(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors at right angles to a unit vector (3,) and to each other, right-handed after it."""
    first = unit(np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))]))
    return first, np.cross(axis, first)


def _scaled(vectors: ArrayLike) -> tuple[Array, NDArray[np.int32]]:
    """Vectors with entries up to 1, by a power of two, which rounds nothing; its exponent (..., 1)."""
    array = np.asarray(vectors, dtype=float)
    exponent = np.frexp(np.abs(array).max(axis=-1, keepdims=True))[1]
    return np.ldexp(array, -exponent), exponent
