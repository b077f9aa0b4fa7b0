"""The elements of a suspension's group: powers of the map that leads over a level, times translations."""

import numpy as np

from thurston_cl.lattice.forms import Array
from thurston_cl.lattice.isometry import act, compose, identity
from thurston_cl.lattice.prism_orbit import FARTHER, TIE
from thurston_cl.lattice.radius import farthest, orbit_radius
from thurston_cl.lattice.suspension import Suspension, grid, moved


def suspension_elements_within(suspension: Suspension, count: float, radius: float) -> Array:
    """Elements (M,4,4) in no order: all those gamma with d(o, gamma o) <= radius, or those of a smaller
    radius if these are `count` already.
    """
    radius = min(radius, farthest("sol"))
    # Twice the radius of a ball in the domain: no image of o is nearer.
    reach = 2.0 * suspension.inradius if np.isfinite(count) else radius
    while True:
        reach = min(reach, radius)
        found = _candidates(suspension, reach)
        near = found[orbit_radius("sol", act("sol", found, suspension.centre)) <= reach + TIE]
        if reach == radius or len(near) >= count:
            return near
        reach *= FARTHER


def suspension_paths(suspension: Suspension, wanted: Array) -> list[tuple[int, ...]]:
    """For each of the elements (M,4,4) the walls on the way to its cell: over levels, then over sides. That
    is the way of a ray, and cells over a level are many sides apart, which no search gets over.
    """
    found = []
    for element in wanted:
        rest, path = element, []
        for f in suspension.level_walls:
            step = suspension.inverses[f, 2, 3]
            while rest[2, 3] / step > 0.5:
                rest = compose("sol", suspension.maps[f], rest)
                path.append(f)
        moves = np.round(suspension.normals @ rest[:2, 3] / suspension.widths).astype(int)
        for pair, count in enumerate(moves):
            path += [2 * pair + int(count < 0)] * abs(int(count))
        found.append(tuple(path))
    return found


def _candidates(suspension: Suspension, reach: float) -> Array:
    """All elements (M,4,4) that may move o by at most `reach`, from the powers of the map over a level."""
    powers = [identity("sol")]
    for f in suspension.level_walls:
        power = powers[0]
        while abs((power := compose("sol", power, suspension.inverses[f]))[2, 3]) <= reach + TIE:
            powers.append(power)
    # The coordinates of points by the basis, on one translation after projection to it.
    dual = np.linalg.pinv(suspension.basis)
    found = []
    for power in powers:
        start, climb = power[:2, 3], power[2, 3]
        # How far x and y may be: in the hyperbolic planes of x, z and of y, z it is no farther (paper 11.3).
        sides = np.sqrt(2.0 * np.exp([climb, -climb]) * max(np.cosh(reach + TIE) - np.cosh(climb), 0.0))
        spread = sides @ np.abs(dual)
        places = start + grid(-spread - start @ dual, spread - start @ dual) @ suspension.basis
        found.append(moved(power, places[np.all(np.abs(places) <= sides, axis=1)]))
    return np.concatenate(found)
