"""Lattices of e3, s3 and h3: domains bounded by planes, in pairs that maps carry to each other."""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thurston_cl.lattice.domain import Lattice
from thurston_cl.lattice.forms import ORIGIN, Array, bisector, form, wall_distance
from thurston_cl.lattice.isometry import inverse
from thurston_cl.lattice.polyhedron import Polyhedron

# Walls whose Gram determinant is less meet nowhere in the space, or are the same.
DEGENERATE = 1e-9


@dataclass(frozen=True, eq=False)
class Polyhedral(Lattice):
    """A lattice of e3, s3 or h3.

    `walls` (F,4) have norm 1: walls[f] . p is the distance s to that wall (e3), sin s (s3) or sinh s (h3).
    The map of wall partner[f] is the inverse of maps[f], and the neighbour of the domain D across wall f is
    inverse(maps[f]) D.
    """

    @property
    def level_walls(self) -> tuple[int, ...]:
        """None: these geometries have no fibres."""
        return ()

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
    def finite_volume(self) -> bool:
        """Whether the domain has finite volume: always in s3; elsewhere no wall's face is open or
        hyperideal.
        """
        if self.geometry == "s3":
            return True
        faces = [face for face in self.polyhedron.faces if face is not None]
        closed = len(faces) > 0 and all(-1 not in face.sides for face in faces)
        return closed and all(v.kind != "hyperideal" for v in self.polyhedron.vertices)

    @cached_property
    def polyhedron(self) -> Polyhedron:
        """The domain's faces, edges and vertices."""
        return Polyhedron(self.geometry, self.walls)

    def clearance(self, points: ArrayLike) -> Array:
        """Distance (...) of points (...,4) from the nearest wall's plane; negative outside the domain."""
        return wall_distance(self.geometry, -np.max(self.heights(points), axis=-1))

    def distance_from(self, point: ArrayLike) -> float:
        """Distance of a point (4,) from the domain; 0 inside."""
        square = behind_square(form(self.geometry), self.walls, self.heights(point))
        return float(wall_distance(self.geometry, np.sqrt(square)))


def behind_square(g: Array, walls: Array, heights: Array) -> float:
    """The square of a point's distance from {p : walls . p <= 0}, of its sine or of its hyperbolic sine.

    It is the distance from the face, edge or corner where the walls (F,k) meet that the point is behind: with
    the heights v (F,) over these walls and their Gram matrix G by the form diag(g), v G^-1 v is the square of
    that distance in flat space, of its sine on spheres, of its hyperbolic sine in hyperbolic space, if G^-1 v
    is positive.
    """
    behind = np.flatnonzero(heights > 0)
    square = 0.0
    for size in range(1, len(g)):
        for corner in combinations(behind, size):
            normals, v = walls[list(corner)], heights[list(corner)]
            gram = (normals * g) @ normals.T
            if np.linalg.det(gram) > DEGENERATE:
                weights = np.linalg.solve(gram, v)
                if np.all(weights > 0):
                    square = max(square, float(v @ weights))
    return square


def pairing_defects(geometry: str, walls: Array, maps: Array) -> tuple[Array, Array]:
    """How badly wall g serves as partner of wall f: (F,F) for maps[g] maps[f] = 1, and for f landing on g.

    The second compares the plane of f moved by maps[f] with that of g, with the sides exchanged.
    """
    products = maps[None, :] @ maps[:, None]
    inverse_defect = np.max(np.abs(products - np.eye(4)), axis=(2, 3))
    moved = np.einsum("fi,fij->fj", walls, inverse(geometry, maps))
    wall_defect = np.max(np.abs(moved[:, None] + walls[None, :]), axis=2)
    return inverse_defect, wall_defect
