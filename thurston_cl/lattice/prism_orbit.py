"""The elements of a prism's group: those of the group on the base, times shifts along the fibre."""

import numpy as np
from scipy.spatial import cKDTree

from thurston_cl.lattice.forms import Array, bisector
from thurston_cl.lattice.isometry import act, compose, fibre, identity
from thurston_cl.lattice.polygon import BASE, lower
from thurston_cl.lattice.prism import BISECTOR, Prism, base_radius
from thurston_cl.lattice.radius import farthest, greatest_climb, orbit_radius

# The search goes so much farther each time that it has not found enough; the last round costs most.
FARTHER = 1.25
# Orbit points whose distances from the origin differ by less are sorted as equally far; acosh and products
# round less.
TIE = 1e-7


def elements_within(prism: Prism, count: float, radius: float) -> Array:
    """Elements (M,n,n) in no order: all those gamma with d(o, gamma o) <= radius, or those of a smaller
    radius if these are `count` already.
    """
    heights = np.abs(prism.heights(prism.centre))
    # Along the fibre one wall alone makes a mirror or a half-turn: beyond its image of o there is nothing.
    endless = len(prism.level_walls) > 1
    least = float(np.min(heights)) if endless or not prism.level_walls else 2.0 * float(np.max(heights)) + TIE
    limit = farthest(prism.geometry)
    reach = least if np.isinf(radius) or np.isfinite(count) else radius
    while True:
        base, all_of_base = _on_base(prism, min(reach, limit))
        found = _over(prism, base, reach)
        far = orbit_radius(prism.geometry, act(prism.geometry, found, prism.centre))
        near = found[far <= min(reach, radius) + TIE]
        if reach >= radius or len(near) >= count or ((all_of_base or reach > limit) and not endless):
            return near
        reach = min(FARTHER * reach, radius)


def columns(prism: Prism, count: int, reach: float) -> Array:
    """Elements (M,n,n) in no order: over the nearest cells of the base all those that stay within about
    `reach` along the fibre; over so many cells that there are about `count` elements.
    """
    stack, _ = _stack(prism, reach)
    wanted = max(1, count // len(stack))
    radius = prism.inradius
    base, all_of_base = _on_base(prism, radius)
    while len(base) < wanted and not all_of_base and radius < farthest(prism.geometry):
        radius *= FARTHER
        base, all_of_base = _on_base(prism, radius)
    near = np.argsort(base_radius(prism.geometry, act(prism.geometry, base, prism.centre)), kind="stable")
    found = compose(prism.geometry, base[near[:wanted], None], stack[None])
    return found.reshape(-1, *stack.shape[1:])


def _on_base(prism: Prism, reach: float) -> tuple[Array, bool]:
    """For every element of the group on the base that moves o by at most `reach` there one element (M,n,n)
    over it, and whether that is all of the group.

    In a Dirichlet domain every element is reached over ever nearer ones. In another we search farther out, by
    the longest step, and may in theory miss some.
    """
    geometry = prism.geometry
    sides = [f for f in range(len(prism.walls)) if f not in prism.level_walls]
    found = fresh = identity(geometry)[None]
    if not sides:
        return found, True
    steps = prism.inverses[sides]
    starts = act(geometry, steps, prism.centre)
    nearest = [bisector(BASE[geometry], point) for point in lower(geometry, starts)]
    detour = 0.0
    if np.max(np.abs(np.array(nearest) - prism.polygon.sides)) > BISECTOR:
        detour = float(np.max(base_radius(geometry, starts)))
    apart = 0.5 * float(np.min(np.abs(prism.polygon.sides[:, 3])))
    complete = True
    while len(fresh):
        points = act(geometry, fresh[:, None], starts[None]).reshape(-1, 4)
        parents, walls = np.divmod(np.arange(len(points)), len(steps))
        near = base_radius(geometry, points) <= reach + detour + TIE
        complete &= bool(near.all())
        parents, walls, keys = parents[near], walls[near], lower(geometry, points[near])
        if len(keys):
            known = lower(geometry, act(geometry, found, prism.centre))
            new = np.isinf(cKDTree(known).query(keys, distance_upper_bound=apart)[0])
            parents, walls, keys = parents[new], walls[new], keys[new]
        if len(keys):
            # Keep the first of every group of equal points.
            pairs = cKDTree(keys).query_pairs(apart, output_type="ndarray")
            repeated = np.zeros(len(keys), dtype=bool)
            repeated[pairs.max(axis=1)] = True
            parents, walls = parents[~repeated], walls[~repeated]
        fresh = _to_middle(prism, compose(geometry, found[len(found) - len(fresh) :][parents], steps[walls]))
        found = np.concatenate([found, fresh])
    return found, complete


def _stack(prism: Prism, reach: float) -> tuple[Array, Array]:
    """The elements (M,n,n) that keep the fibre over o and carry o at most as far as `reach` along it, and
    their values (M,) of the fibre coordinate there.
    """
    axis = fibre(prism.geometry)
    upper = {prism.walls[f, axis] > 0: f for f in prism.level_walls}
    found, heights = [identity(prism.geometry)], [0.0]
    for upwards in (True, False):
        element, wall = found[0], upper.get(upwards)
        while wall is not None:
            element = compose(prism.geometry, element, prism.inverses[wall])
            height = float(act(prism.geometry, element, prism.centre)[axis])
            if abs(height) > reach:
                break
            found.append(element)
            heights.append(height)
            # Upwards is downwards in a cell that a mirror or a half-turn led to. One mirror leads back at
            # once.
            wall = upper.get(upwards == (element[axis, axis] > 0))
    return np.array(found), np.array(heights)


def _to_middle(prism: Prism, found: Array) -> Array:
    """Elements (M,n,n) replaced by those over the same of the base that carry o nearest to coordinate 0."""
    if not prism.level_walls or len(found) == 0:
        return found
    axis = fibre(prism.geometry)
    now = act(prism.geometry, found, prism.centre)[:, axis] * found[:, axis, axis]
    low, high = prism.levels
    reach = float(np.max(np.abs(now))) + (high - low if np.isfinite(high - low) else 0.0)
    stack, heights = _stack(prism, reach)
    best = np.argmin(np.abs(now[:, None] + heights), axis=1)
    return compose(prism.geometry, found, stack[best])


def _over(prism: Prism, base: Array, reach: float) -> Array:
    """All elements over those of the base that may move o by at most `reach`."""
    if not prism.level_walls:
        return base
    axis = fibre(prism.geometry)
    middle = np.max(np.abs(act(prism.geometry, base, prism.centre)[:, axis]))
    stack, _ = _stack(prism, float(greatest_climb(prism.geometry, reach) + middle) + TIE)
    found = compose(prism.geometry, base[:, None], stack[None])
    return found.reshape(-1, *stack.shape[1:])
