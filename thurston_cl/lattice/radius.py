"""How far an orbit goes from the origin, and how far the fibre coordinate may go."""

import numpy as np
from numpy.typing import ArrayLike

from thurston_cl.lattice.forms import CURVATURE, Array

# Hyperbolic coordinates, and the entries of isometries of sol, grow like e^distance: beyond this they do not
# tell orbit points apart any more.
FARTHEST = 25.0


def farthest(geometry: str) -> float:
    """How far from the origin an orbit is looked at."""
    return FARTHEST if geometry in ("h3", "h2xe", "sl2", "sol") else np.inf


def orbit_radius(geometry: str, points: ArrayLike) -> Array:
    """Distance (...) of points (...,4) from the origin, to sort an orbit by: poor next to the origin.

    In nil, sl2 and sol, where only an iteration finds it, the kernel is asked, on the default device.
    """
    p = np.asarray(points, dtype=np.float64)
    match geometry:
        case "nil" | "sl2" | "sol":
            from thurston_cl.geometry import for_few_points

            return np.asarray(for_few_points(geometry).distance(p.reshape(-1, 4)).reshape(p.shape[:-1]))
        case "s2xe":
            return np.hypot(np.arctan2(np.hypot(p[..., 0], p[..., 1]), p[..., 2]), p[..., 3])
        case "h2xe":
            return np.hypot(np.arcsinh(np.hypot(p[..., 0], p[..., 1])), p[..., 3])
    match CURVATURE[geometry]:
        case 0:
            return np.asarray(np.linalg.norm(p[..., :3], axis=-1))
        case 1:
            return np.asarray(np.arctan2(np.linalg.norm(p[..., :3], axis=-1), p[..., 3]))
        case _:
            return np.asarray(np.arccosh(np.maximum(1.0, p[..., 3])))


def climb_time(geometry: str, rho: ArrayLike, height: ArrayLike) -> Array:
    """Length (...) below which no path of nil or sl2 changes the fibre coordinate by `height` (...), of
    either sign and with its sign, if it starts at the distance rho (...) from the axis; in s2xe and h2xe
    `height` itself.

    A unit vector at the distance r from the axis changes it by at most sqrt(1 + (r/2)^2) in nil and by
    sqrt(1 + tanh(r/2)^2) in sl2, and after the length d a path is at a distance of at most rho + d. With F an
    integral of that, F(rho + d) - F(rho) = |height| is solved for d, by Newton's iteration, which comes from
    above for a convex F: the last step is in the constant SAFE.
    """
    rho, target = np.asarray(rho, dtype=np.float64), np.abs(np.asarray(height, dtype=np.float64))
    if geometry not in ("nil", "sl2"):
        return np.asarray(height, dtype=np.float64)
    start = _climb(geometry, rho)[0]
    d = target / _climb(geometry, rho)[1]
    for _ in range(CLIMB_STEPS):
        reached, rate = _climb(geometry, rho + d)
        d = np.maximum(d - (reached - start - target) / rate, 0.0)
    return np.copysign(SAFE * d, height)


# Newton's iteration for climb_time doubles its digits each time; at the start it has at least one.
CLIMB_STEPS = 6
# What rounding may add to climb_time, with a wide margin.
SAFE = 1.0 - 1e-9


def greatest_climb(geometry: str, length: float) -> float:
    """How far a path of a length from the origin may change the fibre coordinate."""
    return float(_climb(geometry, np.array(length))[0]) if geometry in ("nil", "sl2") else length


def _climb(geometry: str, r: Array) -> tuple[Array, Array]:
    """Integral from 0 to r of the greatest rate of the fibre coordinate, and that rate at r."""
    if geometry == "nil":
        rate = np.hypot(1.0, 0.5 * r)
        return 0.5 * r * rate + np.arcsinh(0.5 * r), rate
    t = np.tanh(0.5 * r)
    rate = np.hypot(1.0, t)
    # log(cosh(r/2)) without overflow.
    log_cosh = 0.5 * r + np.log1p(np.exp(-r)) - np.log(2.0)
    return 2.0 * np.sqrt(2.0) * (np.log(rate + np.sqrt(2.0) * t) + log_cosh) - 2.0 * np.arcsinh(t), rate
