"""How to measure distance near the walls of a cell (paper 4.2), and which images of an object that takes."""

import numpy as np
from numpy.typing import NDArray

from thurston_cl.lattice import Lattice, elements
from thurston_cl.scene import schema
from thurston_cl.scene.placement import Placement

Array = NDArray[np.float64]

# Group elements that are tried, nearest first, for images of an object that reach into the cell.
SEARCHED = 1000
# How far outside the domain a point of an edge may be and still be on it: far above rounding.
ON_EDGE = 1e-9


def choose_near_walls(scene: schema.Scene) -> str:
    """What the scene says, or else "domain" or "images"; "whole space" where there are no walls.

    A hollow that is symmetric under the walls bounds the distance to the solid beyond them too, so the cell's
    own distance will do. For everything else rays creep over the walls, and each object is seen with those of
    its images that reach into the cell.
    """
    if scene.lattice is None:
        return "whole space"
    if scene.render.distance != "auto":
        return scene.render.distance
    symmetric = scene.lattice.is_dirichlet and all(_symmetric_hollow(solid) for solid in scene.objects)
    return "domain" if symmetric else "images"


def _symmetric_hollow(solid: schema.Solid) -> bool:
    """Whether a solid is the cell minus balls that every wall maps to each other."""
    if solid.at != (0.0, 0.0, 0.0):
        return False
    match solid.kind:
        case "tile":
            return True
        case "complement":
            return solid.shape.kind == "ball" and solid.shape.at == (0.0, 0.0, 0.0)
        case "intersection":
            return all(_symmetric_hollow(member) for member in solid.shape)
        case _:
            return False


def is_hollow(solid: schema.Solid) -> bool:
    """Whether a solid fills the cell but for something: over a wall it would fill its neighbour's hollow."""
    match solid.kind:
        case "tile" | "complement":
            return True
        case "intersection" | "union":
            return all(is_hollow(member) for member in solid.shape)
        case "difference":
            return is_hollow(solid.shape[0])
        case _:
            return False


def images(solid: schema.Solid, frame: Array, near_walls: str, lattice: Lattice, place: Placement) -> Array:
    """The group elements (M,4,4) besides 1 by which a solid is seen from the cell.

    `frame` (4,4) carries what the solid belongs to into the cell.
    """
    if is_hollow(solid) or near_walls in ("whole space", "domain", "creeping"):
        return np.empty((0, 4, 4))
    if near_walls in ("neighbours", "both"):
        return lattice.inverses
    balls = _bounding_balls(solid, frame, place)
    if balls is None:
        return _around_edges(lattice)
    near = elements(lattice, count=SEARCHED)[1:]
    reached = np.zeros(len(near), dtype=bool)
    for centre, radius in balls:
        # The height over one wall is a quick lower bound.
        for k in np.flatnonzero(lattice.clearance(near @ centre) > -radius):
            reached[k] |= lattice.distance_from(near[k] @ centre) < radius
    return np.asarray(near[reached])


def _bounding_balls(solid: schema.Solid, outer: Array, place: Placement) -> list[tuple[Array, float]] | None:
    """Balls (centre (4,), radius) that hold a solid together; None for a solid without bound."""
    frame = outer @ place.isometry(solid.at, solid.rotate)
    match solid.kind:
        case "ball":
            return [(frame[:, 3], solid.shape.radius)]
        case "union":
            members = [_bounding_balls(member, frame, place) for member in solid.shape]
            if None in members:
                return None
            return [ball for member in members if member is not None for ball in member]
        case "intersection":
            members = [_bounding_balls(member, frame, place) for member in solid.shape]
            return next((member for member in members if member is not None), None)
        case "difference":
            return _bounding_balls(solid.shape[0], frame, place)
        case _:
            return None


def _around_edges(lattice: Lattice) -> Array:
    """The elements (M,4,4) besides 1 whose cells share a face or an edge with the domain."""
    middles = np.array([edge.point for edge in lattice.polyhedron.edges]).reshape(-1, 4)
    near = elements(lattice, count=SEARCHED)[1:]
    back = np.einsum("gij,ej->gei", np.linalg.inv(near), middles)
    shared = lattice.contains(back, ON_EDGE).any(axis=1)
    apart = (
        np.abs(near[:, None] - lattice.inverses[None]).reshape(len(near), len(lattice.walls), 16).max(axis=2)
    )
    return np.asarray(near[shared | (apart.min(axis=1) < ON_EDGE)])
