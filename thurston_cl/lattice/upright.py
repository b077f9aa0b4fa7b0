"""Domains that stand upright: a polygon times an interval, as prisms and suspensions are."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from thurston_cl.lattice.domain import Lattice
from thurston_cl.lattice.forms import Array, curvature, form
from thurston_cl.lattice.isometry import fibre
from thurston_cl.lattice.polygon import BASE, Corner, Polygon, lift, lower
from thurston_cl.lattice.polyhedron import Edge, Vertex
from thurston_cl.models import TWISTED


@dataclass(frozen=True, eq=False)
class Upright(Lattice):
    """A lattice whose domain is a polygon of the base times an interval of the coordinate along the fibre, in
    sol a polygon of x, y times an interval of z.

    Sides come first: walls [a,b,c,0,0], in nil and sol [a,b,0,d], that look at the base only. Levels come
    last: [0,0,0,+-1,-h], in nil and sol [0,0,+-1,-h]; walls . p is what the coordinate is too large or too
    small by.
    """

    @cached_property
    def level_walls(self) -> tuple[int, ...]:
        """Indices of the walls at a value of the coordinate that runs upright: the last ones."""
        return tuple(int(f) for f in np.flatnonzero(self.walls[:, fibre(self.geometry)]))

    @cached_property
    def polygon(self) -> Polygon:
        """The base of the domain."""
        sides = np.delete(self.walls, self.level_walls, axis=0)
        return Polygon(BASE[self.geometry], lower(self.geometry, sides[:, :4]))

    @cached_property
    def levels(self) -> tuple[float, float]:
        """The least and the greatest value of the upright coordinate; infinite where no wall bounds it."""
        low, high = -np.inf, np.inf
        for f in self.level_walls:
            wall = self.walls[f]
            if wall[fibre(self.geometry)] > 0:
                high = min(high, -float(wall[-1]))
            else:
                low = max(low, float(wall[-1]))
        return low, high

    @property
    def finite_volume(self) -> bool:
        """Whether both the base and the interval are finite."""
        return self.polygon.closed and bool(np.all(np.isfinite(self.levels)))

    @cached_property
    def polyhedron(self) -> "Frame":
        """The edges and corners of the domain."""
        return Frame(self)


class Frame:
    """Edges and corners of an upright domain.

    An upright edge's `point` is at 0 of the coordinate that runs upright, and its `direction` along that. The
    other edges run along a side at a level: `point` is the one nearest to the line upright through the
    origin. `angle` is NaN where it varies along the edge: at levels of nil and sl2, and upright in sol.
    Corners at infinity have no upright edge.
    """

    def __init__(self, domain: Upright) -> None:
        geometry, polygon = domain.geometry, domain.polygon
        levels = [
            (f, float(-domain.walls[f, -1] * domain.walls[f, fibre(geometry)])) for f in domain.level_walls
        ]
        self.vertices = sorted(
            (
                Vertex(corner.kind, lift(geometry, corner.vector, level), (*corner.sides, f))
                for corner in polygon.corners
                for f, level in levels
            ),
            key=lambda vertex: vertex.walls,
        )
        edges = [_upright(domain, corner, levels) for corner in polygon.corners if corner.kind == "finite"]
        edges += [_along(domain, side, *level) for side in polygon.bounding for level in levels]
        self.edges = sorted(edges, key=lambda edge: edge.walls)


def _upright(domain: Upright, corner: Corner, levels: Sequence[tuple[int, float]]) -> Edge:
    geometry = domain.geometry
    point = lift(geometry, corner.vector, 0.0)
    direction = np.eye(4)[fibre(geometry)]
    ends, kinds = [], []
    for sign in (-1.0, 1.0):
        end = [level for _, level in levels if level * sign > 0]
        ends.append(lift(geometry, corner.vector, end[0]) if end else sign * direction)
        kinds.append("finite" if end else "open")
    walls = (corner.sides[0], corner.sides[-1])
    angle = float(np.nan) if geometry == "sol" else domain.polygon.angle(corner)
    return Edge(walls, point, direction, (ends[0], ends[1]), (kinds[0], kinds[1]), angle)


def _along(domain: Upright, side: int, wall: int, level: float) -> Edge:
    geometry, polygon = domain.geometry, domain.polygon
    g, point = form(polygon.base), polygon.nearest(side)
    # Tangent to the base at the point, in [x,y,0,z].
    along = np.zeros(4)
    if curvature(polygon.base) == 0:
        along[:2] = [-polygon.sides[side, 1], polygon.sides[side, 0]]
    else:
        along[[0, 1, 3]] = np.cross((polygon.sides[side])[[0, 1, 3]], (g * point)[[0, 1, 3]])
        along /= np.sqrt(np.sum(g * along * along))
    ends: list[Array] = []
    kinds: list[str] = []
    corners = [corner for corner in polygon.corners if side in corner.sides]
    for sign in (-1.0, 1.0):
        there = [c for c in corners if sign * float(np.sum(along[[0, 1]] * (c.vector - point)[[0, 1]])) > 0]
        if there:
            ends.append(lift(geometry, there[0].vector, level))
            kinds.append(there[0].kind)
        else:
            ends.append(lift(geometry, sign * along, 0.0))
            kinds.append("open")
    angle = float(np.nan) if geometry in TWISTED else np.pi / 2.0
    direction = lift(geometry, along, 0.0)
    return Edge(
        (side, wall), lift(geometry, point, level), direction, (ends[0], ends[1]), (kinds[0], kinds[1]), angle
    )
