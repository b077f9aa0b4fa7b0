"""What the lattice package knows about each geometry: its bilinear form and its isometries.

Models (paper Table 1): points are 4-vectors [x,y,z,w], the origin is o = e_w; e3 is the plane w = 1, s3 the
unit sphere, h3 the sheet w > 0 of x^2+y^2+z^2-w^2 = -1. With the curvature K = 0, 1, -1 the form on vectors
is xx'+yy'+zz'+K ww', and the one on covectors (walls) is the same; in e3 it only sees x, y, z.
"""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thurston_cl.errors import ThurstonError

Array = NDArray[np.float64]

CURVATURE: Mapping[str, int] = MappingProxyType({"e3": 0, "s3": 1, "h3": -1})
ORIGIN: Array = np.array([0.0, 0.0, 0.0, 1.0])
ORIGIN.setflags(write=False)
# The residual of an isometry whose entries are correctly rounded is below this.
ROUNDING = 2e-15


class LatticeError(ThurstonError, ValueError):
    """A lattice is unknown or wrong.

    `what` is "generators", "domain" or "name", and `index` says which generator or half-space (None: all of
    them), so that a scene loader can point at the line.
    """

    exit_code = 65

    def __init__(self, message: str, what: str, index: int | None = None) -> None:
        super().__init__(message)
        self.what = what
        self.index = index


def curvature(geometry: str) -> int:
    """K = 0, 1, -1 for e3, s3, h3. Raises LatticeError for a geometry that has no lattices here."""
    if geometry not in CURVATURE:
        known = ", ".join(CURVATURE)
        raise LatticeError(f"there are no lattices for geometry '{geometry}'; known are: {known}", "name")
    return CURVATURE[geometry]


def form(geometry: str) -> Array:
    """Diagonal (4,) of the bilinear form on covectors, and in s3 and h3 also of the one on vectors."""
    return np.array([1.0, 1.0, 1.0, curvature(geometry)])


def inverse(geometry: str, isometry: ArrayLike) -> Array:
    """Inverses (...,4,4) of isometries (...,4,4), without solving: G M^T G, in e3 [R^T, -R^T t]."""
    m = np.asarray(isometry, dtype=np.float64)
    if curvature(geometry) != 0:
        g = form(geometry)
        return g[:, None] * np.swapaxes(m, -1, -2) * g + 0.0
    result = np.zeros_like(m)
    transposed = np.swapaxes(m[..., :3, :3], -1, -2)
    result[..., :3, :3] = transposed
    result[..., :3, 3] = -(transposed @ m[..., :3, 3:])[..., 0]
    result[..., 3, 3] = 1.0
    return result + 0.0


def residual(geometry: str, isometry: ArrayLike) -> float:
    """How far (...,4,4) matrices are from preserving the form, relative to their largest entry squared.

    In s3, h3 max|M^T G M - G|; in e3 max|R^T R - 1| and how far the last row is from [0,0,0,1]. The sheet of
    h3 is not looked at: see `keeps_sheet`.
    """
    m = np.asarray(isometry, dtype=np.float64)
    if curvature(geometry) == 0:
        rotation = m[..., :3, :3]
        defect = np.swapaxes(rotation, -1, -2) @ rotation - np.eye(3)
        scale = max(1.0, float(np.max(np.abs(rotation))) ** 2)
        return max(float(np.max(np.abs(defect))) / scale, float(np.max(np.abs(m[..., 3, :] - ORIGIN))))
    g = np.diag(form(geometry))
    defect = np.swapaxes(m, -1, -2) @ g @ m - g
    size = np.max(np.abs(m), axis=(-1, -2), keepdims=True)
    return float(np.max(np.abs(defect) / np.maximum(1.0, size) ** 2))


def keeps_sheet(geometry: str, isometry: ArrayLike) -> bool:
    """Whether the matrices (...,4,4) map the model to itself; in h3 that is w > 0 to w > 0."""
    return curvature(geometry) >= 0 or bool(np.all(np.asarray(isometry)[..., 3, 3] > 0))


def polish(geometry: str, isometry: ArrayLike) -> Array:
    """The isometry next to an almost-isometry (4,4), by Newton's iteration M -> M (3 - M* M)/2."""
    m = np.array(isometry, dtype=np.float64)
    # Quadratic convergence: from 1e-3 to rounding in three steps. A step too many adds rounding of its own.
    for _ in range(4):
        if residual(geometry, m) < ROUNDING:
            break
        if curvature(geometry) == 0:
            rotation = m[:3, :3]
            m[:3, :3] = rotation @ (3.0 * np.eye(3) - rotation.T @ rotation) / 2.0
            m[3] = ORIGIN
        else:
            m = m @ (3.0 * np.eye(4) - inverse(geometry, m) @ m) / 2.0
    return m


def snap(values: ArrayLike, tolerance: float = 1e-12) -> Array:
    """Round entries next to a multiple of 1/2 to it, and -0 to 0: the code generator leaves zeros out."""
    a = np.array(values, dtype=np.float64)
    halves = np.round(2.0 * a) / 2.0
    return np.where(np.abs(a - halves) <= tolerance, halves, a) + 0.0


def tidy(geometry: str, isometry: ArrayLike, tolerance: float = 1e-12) -> Array:
    """The isometry next to an almost-isometry (4,4), with entries exact where they are a multiple of 1/2."""
    m = np.array(isometry, dtype=np.float64)
    # Either step disturbs the other a little; they settle in a few rounds.
    for _ in range(20):
        m = snap(polish(geometry, m), tolerance)
        if residual(geometry, m) < ROUNDING:
            break
    return m


def on_model(geometry: str, points: ArrayLike) -> Array:
    """Points (...,4) put back on the model after rounding has moved them off it."""
    p = np.array(points, dtype=np.float64)
    k = curvature(geometry)
    if k == 0:
        p[..., 3] = 1.0
    elif k < 0:
        p[..., 3] = np.sqrt(1.0 + np.sum(p[..., :3] ** 2, axis=-1))
    else:
        p /= np.linalg.norm(p, axis=-1, keepdims=True)
    return p


def dot(geometry: str, a: ArrayLike, b: ArrayLike) -> Array:
    """The form <a, b> (...) of vectors or covectors (...,4)."""
    return np.asarray(np.sum(form(geometry) * np.asarray(a) * np.asarray(b), axis=-1))


def unit_wall(geometry: str, covector: ArrayLike) -> Array:
    """A covector (4,) scaled to norm 1, so that wall . p is the signed distance s to its plane, sin s or sinh
    s.

    Raises ValueError when {p : covector . p = 0} is not a plane of the geometry.
    """
    n = np.asarray(covector, dtype=np.float64)
    size = float(np.max(np.abs(n)))
    square = float(dot(geometry, n, n))
    if not square > 1e-12 * size * size:
        raise ValueError(f"[{', '.join(f'{c:g}' for c in n)}] is not a plane of {geometry}")
    return np.asarray(n / np.sqrt(square))


def wall_distance(geometry: str, height: ArrayLike) -> Array:
    """Signed distance (...) of a point p to the plane of a unit wall, from the height wall . p (...)."""
    h = np.asarray(height, dtype=np.float64)
    k = curvature(geometry)
    if k == 0:
        return h
    # On s3 rounding may carry a height past 1.
    return np.asarray(np.arcsinh(h) if k < 0 else np.arcsin(np.clip(h, -1.0, 1.0)))


def bisector(geometry: str, point: ArrayLike) -> Array:
    """Wall (4,) between the origin and a point (4,): positive at the points that are nearer to `point`."""
    q = np.asarray(point, dtype=np.float64)
    k = curvature(geometry)
    last = -float(q[:3] @ q[:3]) / 2.0 if k == 0 else k * (q[3] - 1.0)
    return unit_wall(geometry, [q[0], q[1], q[2], last])


def orbit_radius(geometry: str, points: ArrayLike) -> Array:
    """Distance (...) of points (...,4) from the origin, to sort an orbit by: poor next to the origin."""
    p = np.asarray(points, dtype=np.float64)
    k = curvature(geometry)
    if k == 0:
        return np.asarray(np.linalg.norm(p[..., :3], axis=-1))
    if k < 0:
        return np.asarray(np.arccosh(np.maximum(1.0, p[..., 3])))
    return np.asarray(np.arctan2(np.linalg.norm(p[..., :3], axis=-1), p[..., 3]))
