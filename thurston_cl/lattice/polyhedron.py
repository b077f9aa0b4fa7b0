"""Faces, edges and vertices of the domain {p : walls . p <= 0}, in the projective chart (x,y,z)/w.

The chart shows the side w > 0 of all three models with geodesics as straight lines and walls as planes, h3 as
the open unit ball. Outside that ball lie the hyperideal vertices; they are kept, and parts of a face or edge
that do not meet the ball are not. A domain of s3 that reaches the equator w = 0 has its boundary there left
out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from thurston_cl.lattice.forms import Array, curvature, dot
from thurston_cl.lattice.isometry import on_model

Kind = Literal["finite", "ideal", "hyperideal"]
Key = tuple[int, ...]
Flat = tuple[float, float]

# Relative to the size of the domain: two chart points nearer than this are one (walls of a lattice are good
# to 1e-15, those given by a person to 1e-9; true vertices are farther apart).
SAME = 1e-8
# How far a vertex of h3 may miss the sphere at infinity and still be ideal: rounding is amplified there.
NULL = 1e-7
# Unbounded faces are cut off at this multiple of the distance of the farthest wall.
FAR = 1e3


@dataclass(frozen=True, eq=False)
class Vertex:
    """A corner of the domain where the walls `walls` meet.

    kind "finite": `vector` (4,) is a point of the model; "ideal" (h3): a null vector with w = 1; "hyperideal"
    (h3): a vector with <v,v> = 1, polar to the plane that is orthogonal to all walls of the corner.
    """

    kind: Kind
    vector: Array
    walls: Key


@dataclass(frozen=True, eq=False)
class Edge:
    """Where the domain's walls `walls` = (f, g), f < g, meet.

    `point` (4,) is the point of the edge's geodesic that is nearest to the origin, `direction` (4,) the unit
    tangent there (its w is 0). `ends` are the vectors of the two end vertices, in the order of `direction`;
    where a vertex is missing because the edge does not end, the end is the ideal point (h3, kind "ideal") or
    the direction (e3, s3, kind "open"). `angle` is the dihedral angle inside the domain, in radians.
    """

    walls: tuple[int, int]
    point: Array
    direction: Array
    ends: tuple[Array, Array]
    kinds: tuple[str, str]
    angle: float


@dataclass(frozen=True, eq=False)
class Polygon:
    """A face in its plane: corners (k,2) in order, and the wall beyond each side (-1: cut off far away)."""

    corners: Array
    sides: tuple[int, ...]


class Polyhedron:
    """The domain {p : walls . p <= 0} of a geometry, for walls (F,4) that all leave the origin inside."""

    def __init__(self, geometry: str, walls: Array) -> None:
        self.geometry = geometry
        self.walls = np.asarray(walls, dtype=np.float64)
        normals = self.walls[:, :3]
        lengths = np.linalg.norm(normals, axis=1)
        # In s3 the wall w = 0 (the bisector of o and -o) has no plane in the chart.
        self.flat = lengths > 1e-12
        squares = np.where(self.flat, lengths, 1.0) ** 2
        self.feet = -normals * (self.walls[:, 3] / squares)[:, None]
        self.size = float(np.max(np.linalg.norm(self.feet[self.flat], axis=1), initial=0.0)) or 1.0

    def frame(self, face: int) -> Array:
        """Two orthonormal chart vectors (2,3) that span the plane of a face."""
        # The smallest right singular vectors complement the normal; any rotation of them will do.
        return np.linalg.svd(self.walls[face, None, :3])[2][1:]

    @cached_property
    def faces(self) -> tuple[Polygon | None, ...]:
        """Per wall its polygon, None where the wall bounds nothing inside the model."""
        return tuple(self._face(f) for f in range(len(self.walls)))

    def _face(self, face: int) -> Polygon | None:
        if not self.flat[face]:
            return None
        frame, foot = self.frame(face), self.feet[face]
        # Each other wall is a half-plane a.b + c <= 0 in this plane.
        normals = self.walls[:, :3] @ frame.T
        offsets = self.walls[:, :3] @ foot + self.walls[:, 3]
        reach = FAR * self.size
        tolerance = SAME * self.size
        corners: list[Flat] = [(reach, reach), (-reach, reach), (-reach, -reach), (reach, -reach)]
        sides = [-1] * 4
        for other in range(len(self.walls)):
            if other == face or not self.flat[other]:
                continue
            norm = float(np.linalg.norm(self.walls[other, :3]))
            half = (normals[other, 0] / norm, normals[other, 1] / norm, offsets[other] / norm)
            corners, sides = _cut(corners, sides, half, other, tolerance)
            if len(corners) < 3:
                return None
        b = np.array(corners)
        after = np.roll(b, -1, axis=0)
        area = float(np.sum(b[:, 0] * after[:, 1] - b[:, 1] * after[:, 0])) / 2.0
        if area <= tolerance * self.size or not self._in_model(foot, b):
            return None
        return Polygon(b, tuple(sides))

    def _in_model(self, foot: Array, corners: Array) -> bool:
        """Whether a polygon about the foot (in the frame's coordinates) meets the model."""
        if curvature(self.geometry) >= 0:
            return True
        after = np.roll(corners, -1, axis=0)
        step = after - corners
        if bool(np.all(corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0] >= 0)):
            nearest = 0.0
        else:
            t = np.clip(-np.sum(corners * step, axis=1) / np.sum(step * step, axis=1), 0.0, 1.0)
            nearest = float(np.min(np.sum((corners + t[:, None] * step) ** 2, axis=1)))
        return float(foot @ foot) + nearest < 1.0 - NULL

    @property
    def bounding(self) -> list[int]:
        """The walls that bound the domain in a face; the others only touch it, or not even that."""
        found = [f for f, polygon in enumerate(self.faces) if polygon is not None]
        # The hemisphere w > 0 of s3 alone has its face outside the chart.
        return found or [int(f) for f in np.nonzero(~self.flat)[0][:1]]

    @cached_property
    def corner_points(self) -> Array:
        """Chart points (n,4), w = 1, whose convex hull is the domain (far away where it is unbounded)."""
        parts = [
            self.feet[f] + polygon.corners @ self.frame(f)
            for f, polygon in enumerate(self.faces)
            if polygon is not None
        ]
        if not parts:
            return np.zeros((0, 4))
        points = np.concatenate(parts)
        return np.column_stack([points, np.ones(len(points))])

    def _incident(self, chart: Array) -> Key:
        """Walls through a chart point (4,)."""
        heights = self.walls @ chart / np.maximum(np.linalg.norm(self.walls[:, :3], axis=1), 1e-300)
        # A corner between planes at a small angle is worse known than the planes.
        return tuple(int(f) for f in np.nonzero((np.abs(heights) < 10 * SAME * self.size) & self.flat)[0])

    def _vertex(self, chart: Array) -> Vertex:
        walls = self._incident(chart)
        # The common zero of the walls, better than the clipped corner.
        v = np.linalg.svd(self.walls[list(walls)])[2][-1]
        v = v / v[3] if abs(v[3]) > 1e-12 else v
        k = curvature(self.geometry)
        if k >= 0:
            return Vertex("finite", on_model(self.geometry, v), walls)
        square = float(dot(self.geometry, v, v))
        if abs(square) <= NULL:
            v[:3] /= np.linalg.norm(v[:3])
            return Vertex("ideal", v, walls)
        kind: Kind = "finite" if square < 0 else "hyperideal"
        return Vertex(kind, v / np.sqrt(abs(square)), walls)

    @cached_property
    def _graph(self) -> tuple[dict[Key, Vertex], tuple[Edge, ...]]:
        vertices: dict[Key, Vertex] = {}
        edges: dict[tuple[int, int], Edge] = {}
        for f, polygon in enumerate(self.faces):
            if polygon is None:
                continue
            frame = self.frame(f)
            for i, g in enumerate(polygon.sides):
                if g < 0 or (min(f, g), max(f, g)) in edges:
                    continue
                before, after = polygon.sides[i - 1], polygon.sides[(i + 1) % len(polygon.sides)]
                flat = polygon.corners[i], polygon.corners[(i + 1) % len(polygon.sides)]
                ends = [np.append(self.feet[f] + b @ frame, 1.0) for b in flat]
                corners = [
                    self._vertex(end) if neighbour >= 0 else None
                    for end, neighbour in zip(ends, (before, after), strict=True)
                ]
                edge = self._edge(min(f, g), max(f, g), ends, corners)
                if edge is None:
                    continue
                edges[edge.walls] = edge
                vertices.update({v.walls: v for v in corners if v is not None})
        return vertices, tuple(edges[key] for key in sorted(edges))

    def _edge(self, f: int, g: int, chart: Sequence[Array], corners: Sequence[Vertex | None]) -> Edge | None:
        # The point of the line nearest to the chart's centre is also the nearest in the geometry.
        along = np.cross(self.walls[f, :3], self.walls[g, :3])
        along /= np.linalg.norm(along)
        if float(along @ (chart[1] - chart[0])[:3]) < 0:
            along = -along
        foot = np.append(np.linalg.lstsq(self.walls[[f, g], :3], -self.walls[[f, g], 3])[0], 1.0)
        direction = np.append(along, 0.0)
        k = curvature(self.geometry)
        if k < 0:
            square = float(foot[:3] @ foot[:3])
            reach = [float(along @ end[:3]) for end in chart]
            nearest = max(reach[0], -reach[1], 0.0)
            if square + nearest * nearest >= 1.0 - NULL:
                return None
        point = on_model(self.geometry, foot) if k >= 0 else foot / np.sqrt(-dot("h3", foot, foot))
        ends: list[Array] = []
        kinds: list[str] = []
        for corner, sign in zip(corners, (-1.0, 1.0), strict=True):
            if corner is not None:
                ends.append(corner.vector)
                kinds.append(corner.kind)
            elif k < 0:
                null = point + sign * direction
                ends.append(null / null[3])
                kinds.append("ideal")
            else:
                ends.append(sign * direction)
                kinds.append("open")
        # Normals point out of the domain: the inner angle is what is left of pi.
        angle = float(np.pi - np.arccos(np.clip(dot(self.geometry, self.walls[f], self.walls[g]), -1.0, 1.0)))
        return Edge((f, g), point, direction, (ends[0], ends[1]), (kinds[0], kinds[1]), angle)

    @property
    def vertices(self) -> list[Vertex]:
        """Corners, in the order of their walls."""
        return [self._graph[0][key] for key in sorted(self._graph[0])]

    @property
    def edges(self) -> list[Edge]:
        """Edges, in the order of their walls."""
        return list(self._graph[1])


def _cut(
    corners: list[Flat], sides: list[int], half: tuple[float, float, float], label: int, tolerance: float
) -> tuple[list[Flat], list[int]]:
    """Cut a convex polygon with {b : half . (b,1) <= 0} (Sutherland-Hodgman); the new side gets the label."""
    heights = [half[0] * x + half[1] * y + half[2] for x, y in corners]
    if max(heights) <= tolerance:
        return corners, sides
    kept: list[Flat] = []
    labels: list[int] = []
    count = len(corners)
    for i in range(count):
        j = (i + 1) % count
        inside, next_inside = heights[i] <= tolerance, heights[j] <= tolerance
        if inside:
            kept.append(corners[i])
            labels.append(sides[i])
        if inside != next_inside:
            # A corner on the line counts as inside; the crossing is then that corner.
            t = min(1.0, max(0.0, heights[i] / (heights[i] - heights[j])))
            (x0, y0), (x1, y1) = corners[i], corners[j]
            kept.append((x0 + t * (x1 - x0), y0 + t * (y1 - y0)))
            labels.append(label if inside else sides[i])
    # Drop sides without length.
    result: list[Flat] = []
    result_labels: list[int] = []
    for i, (x, y) in enumerate(kept):
        x1, y1 = kept[(i + 1) % len(kept)]
        if max(abs(x1 - x), abs(y1 - y)) > tolerance:
            result.append((x, y))
            result_labels.append(labels[i])
    return result, result_labels
