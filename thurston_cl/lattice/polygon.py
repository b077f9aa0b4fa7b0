"""Convex polygons of S2, the plane and H2: the base of an upright domain.

Base points are [x,y,z] on the unit sphere or the sheet z > 0 of x^2+y^2-z^2 = -1, and [x,y,1] in the plane.
They are taken as the points [x,y,0,z] of s3, h3, e3, so that the formulas of these geometries hold.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from thurston_cl.lattice.forms import ORIGIN, Array, curvature, dot, form
from thurston_cl.lattice.polyhedron import NULL, Key, Kind
from thurston_cl.models import HOMOGENEOUS

# The geometry whose formulas hold on the base of a fibred geometry, and for the polygons of sol in x, y.
BASE = {"s2xe": "s3", "h2xe": "h3", "nil": "e3", "sl2": "h3", "sol": "e3"}
# How far a corner may be beyond the other walls, relative to its size: rounding of walls given to 1e-9.
ON_WALL = 1e-7


def lower(geometry: str, points: Array) -> Array:
    """Base points [x,y,0,z] (...,4) under points (...,4) of a geometry with a base."""
    base = np.array(points, dtype=np.float64)
    base[..., 2], base[..., 3] = 0.0, points[..., 3 if HOMOGENEOUS[geometry] == 4 else 2]
    return base


def lift(geometry: str, base: Array, level: float) -> Array:
    """Points (...,4) over base points [x,y,0,z] (...,4) at a value of the upright coordinate."""
    points = np.array(base, dtype=np.float64)
    if HOMOGENEOUS[geometry] == 4:
        points[..., 2] = level
    else:
        points[..., 2], points[..., 3] = base[..., 3], level
    return points


@dataclass(frozen=True, eq=False)
class Corner:
    """A corner where the sides `sides` meet: `vector` (4,) as that of a Vertex, on the base."""

    kind: Kind
    vector: Array
    sides: Key


class Polygon:
    """The polygon {p : sides . p <= 0} for unit covectors (S,4) with third entry 0, all with the origin
    inside.
    """

    def __init__(self, base: str, sides: Array) -> None:
        self.base = base
        self.sides = sides

    @cached_property
    def corners(self) -> list[Corner]:
        """Corners, in the order of their sides. Two sides of S2 that meet twice have two."""
        found: dict[tuple[Key, bool], Corner] = {}
        k = curvature(self.base)
        for f in range(len(self.sides)):
            for g in range(f + 1, len(self.sides)):
                meet = np.cross(self.sides[f, [0, 1, 3]], self.sides[g, [0, 1, 3]])
                size = float(np.linalg.norm(meet))
                if size < ON_WALL:
                    continue
                v = np.array([meet[0], meet[1], 0.0, meet[2]]) / size
                # Towards the half of the sphere about the origin; in the plane and in H2 the sign is no
                # matter.
                v = -v if v[3] < 0 else v
                for corner in (v, -v) if k > 0 else (v,):
                    heights = self.sides @ corner
                    if np.all(heights <= ON_WALL):
                        at = tuple(int(s) for s in np.flatnonzero(heights >= -ON_WALL))
                        found.setdefault((at, bool(corner is v)), self._corner(corner, at))
        return [
            corner for corner in (found[key] for key in sorted(found)) if np.all(np.isfinite(corner.vector))
        ]

    def _corner(self, v: Array, sides: Key) -> Corner:
        match curvature(self.base):
            case 1:
                return Corner("finite", v, sides)
            case 0:
                # Parallel lines meet nowhere.
                return Corner("finite", v / v[3] if v[3] > ON_WALL else np.full(4, np.inf), sides)
        if v[3] > 0 and abs(float(dot("h3", v, v))) <= NULL * v[3] ** 2:
            size = np.hypot(v[0], v[1])
            return Corner("ideal", np.array([v[0] / size, v[1] / size, 0.0, 1.0]), sides)
        square = float(dot("h3", v, v))
        return Corner("finite" if square < 0 else "hyperideal", v / np.sqrt(abs(square)), sides)

    @cached_property
    def bounding(self) -> list[int]:
        """Sides that bound the polygon in more than a point."""
        found = []
        for f, side in enumerate(self.sides):
            foot = self.foot(f)
            along = np.array([-side[1], side[0], 0.0, 0.0])
            others = np.delete(self.sides, f, axis=0)
            # The equator of S2 is not in the chart: it bounds a half-sphere only if nothing else does.
            if foot[3] <= ON_WALL:
                if len(self.sides) == 1:
                    found.append(f)
                continue
            # Points of the line, foot + s along, in the chart.
            rates, offsets = others @ along, others @ (foot / foot[3])
            steep = np.abs(rates) > ON_WALL
            crossings = -offsets[steep] / rates[steep]
            high = np.min(crossings[rates[steep] > 0], initial=np.inf)
            low = np.max(crossings[rates[steep] < 0], initial=-np.inf)
            reach = np.inf
            if curvature(self.base) < 0:
                # The line is in the disc as far as this.
                reach = np.sqrt(1.0 - float(np.sum((foot[:2] / foot[3]) ** 2))) / np.hypot(side[0], side[1])
            wide = min(high, reach) - max(low, -reach) > ON_WALL
            if wide and np.all(offsets[~steep] <= ON_WALL):
                found.append(f)
        return found

    def foot(self, side: int) -> Array:
        """The point (4,) of a side's line that is nearest to the origin."""
        n = self.sides[side]
        dual = n * form(self.base)
        if np.hypot(n[0], n[1]) < ON_WALL:
            # The equator of S2: all its points are.
            return np.array([1.0, 0.0, 0.0, 0.0])
        foot = ORIGIN - n[3] * dual
        return foot / (np.sqrt(abs(dot(self.base, foot, foot))) if curvature(self.base) else foot[3])

    def nearest(self, side: int) -> Array:
        """The point (4,) of a side that is nearest to the origin."""
        foot = self.foot(side)
        if np.all(self.sides @ foot <= ON_WALL * max(1.0, foot[3])):
            return foot
        ends = [c.vector for c in self.corners if side in c.sides and c.kind == "finite"]
        return min(ends, key=lambda end: float(np.hypot(end[0], end[1])), default=foot)

    def angle(self, corner: Corner) -> float:
        """The inner angle at a finite or ideal corner between two sides, in radians."""
        f, g = corner.sides[0], corner.sides[-1]
        if corner.kind == "ideal":
            return 0.0
        return float(np.pi - np.arccos(np.clip(dot(self.base, self.sides[f], self.sides[g]), -1.0, 1.0)))

    @cached_property
    def closed(self) -> bool:
        """Whether the polygon has finite area: always on S2."""
        ends = [sum(f in corner.sides for corner in self.corners) for f in range(len(self.sides))]
        bounded = len(ends) > 0 and min(ends) >= 2 and all(c.kind != "hyperideal" for c in self.corners)
        return curvature(self.base) > 0 or bounded
