"""The bilinear forms of e3, s3 and h3: planes, bisectors and isometries by them.

Models (paper Table 1): points are 4-vectors [x,y,z,w], the origin is o = e_w; e3 is the plane w = 1, s3 the
unit sphere, h3 the sheet w > 0 of x^2+y^2+z^2-w^2 = -1. With the curvature K = 0, 1, -1 the form on vectors
is xx'+yy'+zz'+K ww', and the one on covectors (walls) is the same; in e3 it only sees x, y, z.
"""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thurston_cl.lattice.error import LatticeError

Array = NDArray[np.float64]

CURVATURE: Mapping[str, int] = MappingProxyType({"e3": 0, "s3": 1, "h3": -1})
ORIGIN: Array = np.array([0.0, 0.0, 0.0, 1.0])
ORIGIN.setflags(write=False)


def curvature(geometry: str) -> int:
    """K = 0, 1, -1 for e3, s3, h3."""
    if geometry not in CURVATURE:
        raise LatticeError(f"'{geometry}' has no constant curvature", "name")
    return CURVATURE[geometry]


def form(geometry: str) -> Array:
    """Diagonal (4,) of the bilinear form on covectors, and in s3 and h3 also of the one on vectors."""
    return np.array([1.0, 1.0, 1.0, curvature(geometry)])


def form_inverse(g: Array, m: Array) -> Array:
    """Inverses (...,k,k) of matrices (...,k,k) that preserve the form diag(g), g (k,) of +-1: G M^T G."""
    return np.asarray(g[:, None] * np.swapaxes(m, -1, -2) * g)


def form_residual(g: Array, m: Array) -> float:
    """How far matrices (...,k,k) are from preserving the form diag(g): max|M^T G M - G| relative to their
    largest entry squared.
    """
    defect = np.swapaxes(m, -1, -2) @ (g[:, None] * m) - np.diag(g)
    size = np.max(np.abs(m), axis=(-1, -2), keepdims=True)
    return float(np.max(np.abs(defect) / np.maximum(1.0, size) ** 2))


def form_polish(g: Array, m: Array) -> Array:
    """A step of Newton's iteration M -> M (3 - M* M)/2 to the next matrix (k,k) that preserves diag(g)."""
    return np.asarray(m @ (3.0 * np.eye(len(g)) - form_inverse(g, m) @ m) / 2.0)


def keeps_sheet(geometry: str, isometry: ArrayLike) -> bool:
    """Whether the matrices (...,4,4) map the model to itself; in h3 that is w > 0 to w > 0."""
    return curvature(geometry) >= 0 or bool(np.all(np.asarray(isometry)[..., 3, 3] > 0))


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
