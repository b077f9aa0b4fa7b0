"""Group elements near the identity, and the automaton that follows a ray from cell to cell."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from thurston_cl.lattice.domain import Lattice
from thurston_cl.lattice.forms import Array
from thurston_cl.lattice.isometry import act, compose, identity, origin
from thurston_cl.lattice.prism import Prism
from thurston_cl.lattice.prism_orbit import TIE, columns, elements_within
from thurston_cl.lattice.radius import farthest, orbit_radius
from thurston_cl.lattice.suspension import Suspension
from thurston_cl.lattice.suspension_orbit import suspension_elements_within, suspension_paths


def neighbours(lattice: Lattice) -> Array:
    """The identity, then the elements that carry the domain to its neighbours over the walls: (M+1,n,n)."""
    return np.concatenate([identity(lattice.geometry)[None], lattice.over_walls])


def elements(lattice: Lattice, count: int | None = None, radius: float | None = None) -> Array:
    """Group elements gamma (M,n,n) in order of the distance from the origin o to gamma o, the identity first.

    `count` keeps the first so many, `radius` those with distance at most `radius`. A finite group may leave
    both out and give all its elements; a smaller group than `count` gives what it has. Elements at the same
    distance are ordered by the coordinates of gamma o, so the order is the same in every run.

    In a Dirichlet domain every element is reached over ever nearer ones: if gamma o is outside wall f,
    maps[f] leads it nearer. In another domain we search farther out, by the longest step, and may in theory
    miss some. In a prism that is said of its polygon. A suspension's are written down. In h3 and sol, and
    over the base in h2xe and sl2, none is farther than FARTHEST (radius.py), so that there may be fewer.
    Raises ValueError without a bound where the group may be infinite: everywhere but in s3.
    """
    if count is None and radius is None and lattice.geometry != "s3":
        raise ValueError(f"the group of '{lattice.name}' may be infinite: give count or radius")
    if count is not None and count < 1:
        raise ValueError(f"count must be at least 1, not {count}")
    bound = np.inf if radius is None else float(radius)
    if isinstance(lattice, Prism):
        found = elements_within(lattice, np.inf if count is None else count, bound)
    elif isinstance(lattice, Suspension):
        found = suspension_elements_within(lattice, np.inf if count is None else count, bound)
    else:
        found = _around(lattice, count, min(bound, farthest(lattice.geometry)))
    return found[_order(lattice, found)][:count]


def _around(lattice: Lattice, count: int | None, bound: float) -> Array:
    """The elements (M,4,4) of a polyhedron's group with d(o, gamma o) <= bound, in no order, or `count` of
    them and all that are as near.
    """
    steps = lattice.inverses
    step_points = act(lattice.geometry, steps, origin(lattice.geometry))
    detour = 0.0 if lattice.is_dirichlet else float(np.max(orbit_radius(lattice.geometry, step_points)))

    found = identity(lattice.geometry)[None]
    fresh = found
    # Neighbours of what was found that lie beyond the present horizon: parent, wall and point of each.
    later: list[tuple[NDArray[np.intp], NDArray[np.intp], Array]] = []
    horizon = 0.0 if np.isinf(bound) or count is not None else bound + detour + TIE
    while True:
        while len(fresh):
            first = len(found) - len(fresh)
            points = act(lattice.geometry, fresh[:, None], step_points[None]).reshape(-1, 4)
            parents, walls = np.divmod(np.arange(len(points)), len(steps))
            near = orbit_radius(lattice.geometry, points) <= horizon
            later.append((parents[~near] + first, walls[~near], points[~near]))
            found, fresh = _accept(lattice, found, parents[near] + first, walls[near], points[near])
        enough = np.count_nonzero(_radii(lattice, found) <= horizon - detour)
        if horizon - detour > bound or (count is not None and enough >= count):
            break
        parents, walls, points = (np.concatenate(part) for part in zip(*later, strict=True))
        if len(parents) == 0:
            break
        # Move the horizon so far that about as many come in as there are.
        radii = orbit_radius(lattice.geometry, points)
        middle = min(len(radii) - 1, len(found))
        horizon = float(np.partition(radii, middle)[middle]) + TIE
        near = radii <= horizon
        later = [(parents[~near], walls[~near], points[~near])]
        found, fresh = _accept(lattice, found, parents[near], walls[near], points[near])

    return found[_radii(lattice, found) <= bound + TIE]


def cell_table(lattice: Lattice, size: int, reach: float | None = None) -> tuple[Array, NDArray[np.int32]]:
    """The automaton of the `size` cells nearest to home: elements (C,n,n) and the next cell (C,F).

    Cell k is g_k D with g_k = elements[k], and cell 0 is home. A ray in cell k that leaves the domain through
    wall f and is led back by maps[f] goes on in the cell of g_k inverse(maps[f]), which is next[k,f], or C
    where that cell is not in the table. A finite group with fewer elements gives a smaller table. With
    `reach`, a prism's cells are whole columns: those within `reach` along the fibre, over as many cells of
    the base as make about `size` in all.
    """
    if reach is not None and isinstance(lattice, Prism):
        cells = columns(lattice, size, reach)
        cells = cells[_order(lattice, cells)]
    else:
        cells = elements(lattice, count=size)
    starts = act(lattice.geometry, lattice.inverses, origin(lattice.geometry))
    points = act(lattice.geometry, cells[:, None], starts[None])
    _, following = cKDTree(_points(lattice, cells)).query(
        points.reshape(-1, 4), distance_upper_bound=_apart(lattice)
    )
    return cells, following.reshape(len(cells), len(lattice.walls)).astype(np.int32)


def paths(lattice: Lattice, wanted: Array) -> list[tuple[int, ...]]:
    """For each of the elements (M,n,n) the walls that lead from the domain to its cell, one after the other.

    A path (f, g, ...) belongs to the element inverse(maps[f]) inverse(maps[g]) ..., as in `cell_table`.
    """
    if isinstance(lattice, Suspension):
        return suspension_paths(lattice, wanted)
    goals = _points(lattice, wanted)
    found: dict[int, tuple[int, ...]] = {}
    level: list[tuple[Array, tuple[int, ...]]] = [(identity(lattice.geometry), ())]
    reached = lattice.centre[None]
    apart = _apart(lattice)
    while len(found) < len(goals):
        following = []
        for element, path in level:
            for wall, step in enumerate(lattice.inverses):
                image = compose(lattice.geometry, element, step)
                point = _points(lattice, image)
                if np.min(np.linalg.norm(reached - point, axis=1)) < apart:
                    continue
                reached = np.concatenate([reached, point[None]])
                following.append((image, (*path, wall)))
                for goal in np.flatnonzero(np.linalg.norm(goals - point, axis=1) < apart):
                    found[int(goal)] = (*path, wall)
        level = following
    return [found[k] for k in range(len(goals))]


def _apart(lattice: Lattice) -> float:
    """A distance in R^4 below which two points of the orbit of the origin are the same.

    A ball about the origin as large as the nearest wall allows meets none of its images, so orbit points are
    at least twice that apart: 2 |wall . o| in e3, and as a chord in R^4 in s3 and h3. In a prism the points
    of the orbit on the base are so far apart, and those over one of them along the fibre.
    """
    return 0.5 * float(np.min(np.abs(lattice.heights(lattice.centre))))


def _points(lattice: Lattice, found: Array) -> Array:
    """The points (...,4) where elements (...,n,n) carry the origin."""
    return act(lattice.geometry, found, lattice.centre)


def _radii(lattice: Lattice, found: Array) -> Array:
    return orbit_radius(lattice.geometry, _points(lattice, found))


def _accept(
    lattice: Lattice, found: Array, parents: NDArray[np.intp], walls: NDArray[np.intp], points: Array
) -> tuple[Array, Array]:
    """Add the elements found[parents] inverse(maps[walls]) that are new; they are also returned alone."""
    if len(points):
        apart = _apart(lattice)
        known, _ = cKDTree(_points(lattice, found)).query(points, distance_upper_bound=apart)
        parents, walls, points = (part[np.isinf(known)] for part in (parents, walls, points))
    if len(points):
        # Keep the first of every group of equal points.
        pairs = cKDTree(points).query_pairs(apart, output_type="ndarray")
        repeated = np.zeros(len(points), dtype=bool)
        repeated[pairs.max(axis=1)] = True
        parents, walls = parents[~repeated], walls[~repeated]
    fresh = compose(lattice.geometry, found[parents], lattice.inverses[walls])
    return np.concatenate([found, fresh]), fresh


def _order(lattice: Lattice, found: Array) -> NDArray[np.intp]:
    """By distance; ties by |x|, |y|, |z|, larger first, then plus before minus (+x, -x, +y, ...)."""
    radii = _radii(lattice, found)
    by_radius = np.argsort(radii, kind="stable")
    level = np.zeros(len(found), dtype=np.intp)
    level[by_radius[1:]] = np.cumsum(np.diff(radii[by_radius]) > TIE)
    # Coordinates that are equal but for rounding must compare as equal.
    x, y, z, w = (np.round(_points(lattice, found), 6) + 0.0).T
    return np.lexsort((-w, -z, -y, -x, -abs(z), -abs(y), -abs(x), level))
