"""Conformal maps of R^3 as 2 x 2 matrices of quaternions (KRS paper 6.2; corrected in docs/krs.md,
"Moebius maps").

A quaternion is [w, x, y, z]; a point (x, y, z) is the quaternion [0, x, y, z]. [[a, b], [c, d]] maps q to
(a q + b)(c q + d)^-1, and composition is the product of matrices.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

# How far a matrix may be from keeping R^3, relative to its entries: far above rounding, far below a mistake.
KEEPS_SPACE = 1e-9
# A pole so many sizes of the map's translation away is none: rounding.
NO_POLE = 1e-14


def product(p: ArrayLike, q: ArrayLike) -> Array:
    """The product (...,4) of quaternions."""
    a, b = np.asarray(p, dtype=np.float64), np.asarray(q, dtype=np.float64)
    scalar = a[..., :1] * b[..., :1] - np.sum(a[..., 1:] * b[..., 1:], axis=-1, keepdims=True)
    rest = a[..., :1] * b[..., 1:] + b[..., :1] * a[..., 1:] + np.cross(a[..., 1:], b[..., 1:])
    return np.concatenate([scalar, rest], axis=-1)


def conjugate(q: ArrayLike) -> Array:
    """The conjugates (...,4)."""
    return np.asarray(q, dtype=np.float64) * np.array([1.0, -1.0, -1.0, -1.0])


def embedded(points: ArrayLike) -> Array:
    """Points (...,3) as quaternions (...,4)."""
    p = np.asarray(points, dtype=np.float64)
    return np.concatenate([np.zeros((*p.shape[:-1], 1)), p], axis=-1)


@dataclass(frozen=True)
class Map:
    """A conformal map by its matrix (2,2,4). ValueError unless it keeps R^3: Re(a c*) = Re(b d*) = 0
    and d* a - c* b real.
    """

    matrix: Array

    def __post_init__(self) -> None:
        matrix = np.asarray(self.matrix, dtype=np.float64)
        if matrix.shape != (2, 2, 4) or not np.isfinite(matrix).all():
            raise ValueError("expected a 2 x 2 matrix of quaternions of four finite numbers")
        object.__setattr__(self, "matrix", matrix)
        (a, b), (c, d) = matrix
        with np.errstate(over="ignore", invalid="ignore"):
            size = float(np.max(np.sum(matrix**2, axis=-1)))
            mixed = product(conjugate(d), a) - product(conjugate(c), b)
            off = max(
                abs(product(a, conjugate(c))[0]),
                abs(product(b, conjugate(d))[0]),
                float(np.max(np.abs(mixed[1:]))),
            )
            orientation = abs(self.orientation)
        if off > KEEPS_SPACE * size:
            raise ValueError(
                "this Moebius map does not keep R^3: Re(a c*), Re(b d*) or Im(d* a - c* b) is not 0"
            )
        if not orientation > KEEPS_SPACE**2 * size:
            raise ValueError("this Moebius map is not invertible")

    @cached_property
    def orientation(self) -> float:
        """sigma = d* a + b* c, real: positive where orientation is kept; its size is that of the map."""
        (a, b), (c, d) = self.matrix
        return float((product(conjugate(d), a) + product(conjugate(b), c))[0])

    @property
    def has_pole(self) -> bool:
        """Whether a point goes to infinity: whether it is no similarity."""
        return self.numbers[0] > 0

    @property
    def pole(self) -> Array:
        """The point (3,) that goes to infinity, where there is one."""
        return np.array(self.numbers[1:4])

    @property
    def inverse(self) -> "Map":
        """The inverse, up to a real factor: of conjugates only."""
        (a, b), (c, d) = self.matrix
        return Map(np.array([[conjugate(d), conjugate(b)], [conjugate(c), conjugate(a)]]))

    def __matmul__(self, other: "Map") -> "Map":
        m, n = self.matrix, other.matrix
        rows = [[product(m[i, 0], n[0, j]) + product(m[i, 1], n[1, j]) for j in (0, 1)] for i in (0, 1)]
        matrix = np.array(rows)
        # Of long products only the direction matters.
        return Map(matrix / np.max(np.abs(matrix)))

    @cached_property
    def numbers(self) -> tuple[float, ...]:
        """What kernels/krs/moebius_map.h reads: 1 with a pole, 0 without; pole p; t; Q row by row; k."""
        (a, b), (c, d) = self.matrix
        axes = embedded(np.eye(3))
        squares = float(c @ c), float(d @ d)
        if squares[0] <= (NO_POLE**2) * squares[1]:
            back = conjugate(d) / squares[1]
            t, columns = product(b, back), product(product(a, axes), back)
            pole, has, factor = np.zeros(4), 0.0, abs(self.orientation) / squares[1]
        else:
            back = conjugate(c) / squares[0]
            pole, has, factor = -product(back, d), 1.0, abs(self.orientation) / squares[0]
            t, columns = product(a, back), -product(product(product(a, pole) + b, axes), back)
        return (has, *pole[1:], *t[1:], *columns[:, 1:].T.ravel(), factor)

    def apply(self, points: ArrayLike) -> Array:
        """Images (N,3) of points (N,3)."""
        return _run("point", self, np.asarray(points, dtype=np.float64))[:, :3]

    def factor(self, points: ArrayLike) -> Array:
        """By which factor (N,) lengths grow at points (N,3)."""
        return _run("point", self, np.asarray(points, dtype=np.float64))[:, 3]

    def sphere_image(self, center: ArrayLike, radius: ArrayLike) -> tuple[Array, Array, Array]:
        """Centers (N,3) and radii (N,) of the images of spheres, and a sign (N,): -1 where the inside becomes
        the outside.
        """
        c, r = np.atleast_2d(np.asarray(center, dtype=np.float64)), np.atleast_1d(radius)
        out = _run("ball", self, np.concatenate([c, np.reshape(r, (-1, 1))], axis=1))
        return out[:, :3], out[:, 3], np.where(out[:, 4] != 0, 1.0, -1.0)

    def push(self, points: ArrayLike, vectors: ArrayLike) -> Array:
        """The differential at points (N,3) applied to vectors (N,3) (KRS paper, appendix C: the gradient of a
        distance at the image has this direction, and this over factor^2 as its value).
        """
        p, g = np.atleast_2d(points), np.atleast_2d(vectors)
        factor = self.factor(p)
        pulled = _run("pull_back", self.inverse, np.concatenate([self.apply(p), g], axis=1))[:, :3]
        return pulled * (factor**2)[:, None]


def _run(name: str, map_: Map, rows: Array) -> Array:
    """A kernel of moebius.cl over rows of numbers, in double where the device has it."""
    from thurston_cl.krs.program import moebius_program

    outputs = {"point": 4, "ball": 5, "pull_back": 3}[name]
    return moebius_program().run(f"moebius_over_{name}", [np.atleast_2d(rows)], outputs, numbers=map_.numbers)


def identity() -> Map:
    """q -> q."""
    return _matrix([1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 0])


def translation(vector: ArrayLike) -> Map:
    """q -> q + v."""
    return _matrix([1, 0, 0, 0], embedded(vector), [0, 0, 0, 0], [1, 0, 0, 0])


def dilation(scale: float) -> Map:
    """q -> s q, s > 0."""
    return _matrix([scale, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 0])


def rotation(matrix: ArrayLike) -> Map:
    """The rotation by a matrix (3,3)."""
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(matrix).as_quat()
    return _matrix([w, x, y, z], [0, 0, 0, 0], [0, 0, 0, 0], [w, x, y, z])


def bend(vector: ArrayLike) -> Map:
    """q -> q (v q + 1)^-1: keeps 0 and, next to it, everything; its pole is v/|v|^2."""
    return _matrix([1, 0, 0, 0], [0, 0, 0, 0], embedded(vector), [1, 0, 0, 0])


def mirror() -> Map:
    """x -> -x."""
    return _matrix([0, -1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 1, 0, 0])


def inversion() -> Map:
    """q -> q/|q|^2 (the matrix of the paper's table 1 gives -q/|q|^2)."""
    return _matrix([0, 0, 0, 0], [-1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0])


def _matrix(a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike) -> Map:
    return Map(np.array([[a, b], [c, d]], dtype=np.float64))
