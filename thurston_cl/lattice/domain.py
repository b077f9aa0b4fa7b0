"""A lattice: a fundamental domain bounded by walls, and per wall the group element that leads back inside."""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thurston_cl.lattice.isometry import ORIGIN, Array, bisector, form, inverse, on_model, wall_distance
from thurston_cl.lattice.polyhedron import Edge, Polyhedron, Vertex

# Walls whose Gram determinant is less meet nowhere in the space, or are the same.
DEGENERATE = 1e-9
# A point this far outside is inside: without slack, rounding sends points on a wall to and fro for ever.
SLACK = 1e-12


@dataclass(frozen=True, eq=False)
class Lattice:
    """A discrete group by its fundamental domain about the origin.

    `walls` (F,4) are covectors of norm 1: a point p is outside when walls[f] . p > 0 (plain dot product) for
    some f, and then walls[f] . p is the distance s to that wall (e3), sin s (s3) or sinh s (h3). `maps`
    (F,4,4): maps[f] @ p leads p back. Every map is a group element, and the map of wall partner[f] is its
    inverse. The neighbour of the domain D across wall f is inverse(maps[f]) D. Arrays are read-only. Paper
    4.1.
    """

    name: str
    geometry: str
    walls: Array
    maps: Array
    description: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        for field in ("walls", "maps"):
            array = np.array(getattr(self, field), dtype=np.float64)
            array.setflags(write=False)
            object.__setattr__(self, field, array)

    @property
    def centre(self) -> Array:
        """The base point (4,) inside the domain: the origin."""
        return ORIGIN

    @property
    def inradius(self) -> float:
        """Distance from the centre to the nearest wall."""
        return float(self.clearance(self.centre[None])[0])

    @cached_property
    def inverses(self) -> Array:
        """Inverses (F,4,4) of the maps: the elements that carry the domain to its neighbours."""
        return inverse(self.geometry, self.maps)

    @cached_property
    def partner(self) -> NDArray[np.intp]:
        """Per wall (F,) the wall that its map carries it to; the wall itself for a mirror or a half-turn."""
        return np.asarray(np.argmin(sum(pairing_defects(self.geometry, self.walls, self.maps)), axis=1))

    @cached_property
    def is_dirichlet(self) -> bool:
        """Whether the domain is the set of points that are nearest to the origin among its images."""
        return all(
            np.allclose(wall, bisector(self.geometry, step @ ORIGIN), rtol=0.0, atol=1e-9)
            for wall, step in zip(self.walls, self.inverses, strict=True)
        )

    @cached_property
    def polyhedron(self) -> Polyhedron:
        """The domain's faces, edges and vertices."""
        return Polyhedron(self.geometry, self.walls)

    def contains(self, points: ArrayLike, slack: float = 0.0) -> NDArray[np.bool_]:
        """Whether points (N,4) are in the domain, or outside by no more than `slack` in walls . p."""
        return np.asarray(np.all(np.asarray(points) @ self.walls.T <= slack, axis=-1))

    def clearance(self, points: ArrayLike) -> Array:
        """Distance (N,) of points (N,4) from the nearest wall's plane; negative outside the domain."""
        return wall_distance(self.geometry, -np.max(np.asarray(points) @ self.walls.T, axis=-1))

    def distance_from(self, point: ArrayLike) -> float:
        """Distance of a point (4,) from the domain; 0 inside.

        It is the distance from the face, edge or corner where the walls meet that the point is behind: with
        the heights v over these walls and their Gram matrix G, v G^-1 v is the square of that distance in e3,
        of its sine in s3, of its hyperbolic sine in h3, if G^-1 v is positive.
        """
        heights = self.walls @ np.asarray(point)
        behind = np.flatnonzero(heights > 0)
        square = 0.0
        for size in (1, 2, 3):
            for corner in combinations(behind, size):
                normals, v = self.walls[list(corner)], heights[list(corner)]
                gram = (normals * form(self.geometry)) @ normals.T
                if np.linalg.det(gram) > DEGENERATE:
                    weights = np.linalg.solve(gram, v)
                    if np.all(weights > 0):
                        square = max(square, float(v @ weights))
        return float(wall_distance(self.geometry, np.sqrt(square)))

    def teleport(self, points: ArrayLike, max_steps: int = 1000) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Lead points (N,4) of the model back into the domain.

        Again and again, the wall that a point is farthest behind is crossed back. Returns the points (N,4),
        the group elements (N,4,4) that were applied, elements @ points, and whether the point came to rest
        (N,): not so after `max_steps` walls, and for points that are not finite.
        """
        p = np.array(points, dtype=np.float64)
        elements = np.tile(np.eye(4), (len(p), 1, 1))
        moving = np.arange(len(p))
        for _ in range(max_steps):
            heights = p[moving] @ self.walls.T
            outside = np.max(heights, axis=1) > SLACK
            moving = moving[outside]
            if len(moving) == 0:
                break
            steps = self.maps[np.argmax(heights[outside], axis=1)]
            p[moving] = on_model(self.geometry, np.einsum("nij,nj->ni", steps, p[moving]))
            elements[moving] = steps @ elements[moving]
        return p, elements, self.contains(p, SLACK)


def pairing_defects(geometry: str, walls: Array, maps: Array) -> tuple[Array, Array]:
    """How badly wall g serves as partner of wall f: (F,F) for maps[g] maps[f] = 1, and for f landing on g.

    The second compares the plane of f moved by maps[f] with that of g, with the sides exchanged.
    """
    products = maps[None, :] @ maps[:, None]
    inverse_defect = np.max(np.abs(products - np.eye(4)), axis=(2, 3))
    moved = np.einsum("fi,fij->fj", walls, inverse(geometry, maps))
    wall_defect = np.max(np.abs(moved[:, None] + walls[None, :]), axis=2)
    return inverse_defect, wall_defect


def vertices(lattice: Lattice) -> list[Vertex]:
    """Corners of the domain: finite, ideal and hyperideal."""
    return lattice.polyhedron.vertices


def edges(lattice: Lattice) -> list[Edge]:
    """Edges of the domain, with their walls, nearest point to the origin, ends and dihedral angle."""
    return lattice.polyhedron.edges
