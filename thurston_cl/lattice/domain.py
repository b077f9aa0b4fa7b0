"""A lattice: a fundamental domain bounded by walls, and per wall the group element that leads back inside."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thurston_cl.lattice.forms import Array
from thurston_cl.lattice.isometry import act, compose, homogeneous, identity, inverse, origin
from thurston_cl.lattice.polyhedron import Edge, Vertex

# A point this far outside is inside: without slack, rounding sends points on a wall to and fro for ever.
SLACK = 1e-12


class Skeleton(Protocol):
    """What is known of a domain's corners and edges."""

    @property
    def vertices(self) -> list[Vertex]:
        """Corners, in the order of their walls."""

    @property
    def edges(self) -> list[Edge]:
        """Edges, in the order of their walls."""


@dataclass(frozen=True, eq=False)
class Lattice(ABC):
    """A discrete group by its fundamental domain about the origin.

    `walls` (F,n) are covectors: a point p is outside when walls[f] . homogeneous(p) > 0 (plain dot product)
    for some f. `maps` (F,n,n), isometries and group elements: maps[f] leads p back. Arrays are read-only.
    Paper 4.1.
    """

    name: str
    geometry: str
    walls: Array
    maps: Array
    description: str = ""
    source: str = ""
    # Whether points are led back over levels before they are over the other walls; else only after that.
    levels_first: ClassVar[bool] = False

    def __post_init__(self) -> None:
        for field in ("walls", "maps"):
            array = np.array(getattr(self, field), dtype=np.float64)
            array.setflags(write=False)
            object.__setattr__(self, field, array)

    @property
    def centre(self) -> Array:
        """The base point (4,) inside the domain: the origin."""
        return origin(self.geometry)

    @property
    def inradius(self) -> float:
        """Distance from the centre to the nearest wall; a lower bound where `clearance` is one."""
        return float(self.clearance(self.centre[None])[0])

    @cached_property
    def inverses(self) -> Array:
        """Inverses (F,n,n) of the maps: elements that carry the domain over its walls."""
        return inverse(self.geometry, self.maps)

    @property
    def over_walls(self) -> Array:
        """The elements (M,n,n) that carry the domain to the cells that share a piece of a wall with it."""
        return self.inverses

    @property
    @abstractmethod
    def level_walls(self) -> tuple[int, ...]:
        """Indices of the walls at a value of the fibre coordinate, in sol of z, behind all the others."""

    @property
    def has_sides(self) -> bool:
        """Whether it has other walls than levels."""
        return len(self.level_walls) < len(self.walls)

    @property
    @abstractmethod
    def is_dirichlet(self) -> bool:
        """Whether the domain is the set of points that are nearest to the origin among its images."""

    @property
    @abstractmethod
    def finite_volume(self) -> bool:
        """Whether the domain has finite volume."""

    @property
    @abstractmethod
    def polyhedron(self) -> Skeleton:
        """The domain's edges and vertices."""

    @abstractmethod
    def clearance(self, points: ArrayLike) -> Array:
        """Distance (...) of points (...,4) from the nearest wall, or a lower bound; negative outside."""

    @abstractmethod
    def distance_from(self, point: ArrayLike) -> float:
        """Distance of a point (4,) from the domain, or a lower bound; 0 inside."""

    def heights(self, points: ArrayLike) -> Array:
        """walls . p (...,F) of points (...,4): positive beyond a wall."""
        return np.asarray(homogeneous(self.geometry, points) @ self.walls.T)

    def contains(self, points: ArrayLike, slack: float = 0.0) -> NDArray[np.bool_]:
        """Whether points (...,4) are in the domain, or outside by no more than `slack` in walls . p."""
        return np.asarray(np.all(self.heights(points) <= slack, axis=-1))

    def teleport(self, points: ArrayLike, max_steps: int = 1000) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Lead points (N,4) of the model back into the domain.

        Again and again, the wall that a point is farthest behind is crossed back; levels only where all other
        walls have the point inside, or these only where the levels do (`levels_first`). Returns the points
        (N,4), the group elements (N,n,n) that were applied, and whether the point came to rest (N,): not so
        after `max_steps` steps, and for points that are not finite.
        """
        p = np.array(points, dtype=np.float64)
        elements = np.tile(identity(self.geometry), (len(p), 1, 1))
        moving = np.arange(len(p))
        first = np.zeros(len(self.walls), dtype=bool)
        first[list(self.level_walls)] = True
        if not self.levels_first:
            first = ~first
        for _ in range(max_steps):
            heights = self.heights(p[moving])
            early = np.any(heights[:, first] > SLACK, axis=1)
            heights[np.ix_(early, ~first)] = -np.inf
            outside = np.max(heights, axis=1) > SLACK
            moving, heights = moving[outside], heights[outside]
            if len(moving) == 0:
                break
            steps = self._steps_back(np.argmax(heights, axis=1), np.max(heights, axis=1))
            p[moving] = act(self.geometry, steps, p[moving])
            elements[moving] = compose(self.geometry, steps, elements[moving])
        return p, elements, self.contains(p, SLACK)

    def _steps_back(self, walls: NDArray[np.intp], heights: Array) -> Array:
        """The elements (N,n,n) that lead points back over walls (N,) which they are `heights` (N,) behind."""
        return self.maps[walls]


def vertices(lattice: Lattice) -> list[Vertex]:
    """Corners of the domain: finite, ideal and hyperideal."""
    return lattice.polyhedron.vertices


def edges(lattice: Lattice) -> list[Edge]:
    """Edges of the domain, with their walls, a point on them, ends and dihedral angle."""
    return lattice.polyhedron.edges
