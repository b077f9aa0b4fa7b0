"""How to measure distance near the walls of a cell (paper 4.2), where the scene leaves it to us."""

import numpy as np
from numpy.typing import NDArray

from thurston_cl.lattice import Lattice
from thurston_cl.scene import schema
from thurston_cl.scene.placement import Placement


def choose_near_walls(scene: schema.Scene, place: Placement) -> str:
    """ "domain", "creeping", "neighbours", "both", or "whole space" where there are no walls.

    A hollow that is symmetric under the walls bounds the distance to the solid beyond them too, so the cell's
    own distance will do. Objects inside the cell need creeping. Whatever crosses a wall needs the neighbours
    as well.
    """
    lattice = scene.lattice
    if lattice is None:
        return "whole space"
    if scene.render.distance != "auto":
        return scene.render.distance
    if lattice.is_dirichlet and all(_symmetric_hollow(solid) for solid in scene.objects):
        return "domain"
    inside = all(_in_cell(solid, np.eye(4), lattice, place) for solid in scene.objects)
    return "creeping" if inside else "both"


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


def _in_cell(solid: schema.Solid, outer: NDArray[np.float64], lattice: Lattice, place: Placement) -> bool:
    """Whether a solid surely crosses no wall; `outer` carries the frame that it stands in into the cell."""
    if lattice.is_dirichlet and _symmetric_hollow(solid):
        return True
    frame = outer @ place.isometry(solid.at, solid.rotate)
    match solid.kind:
        case "ball":
            return bool(lattice.clearance(frame[None, :, 3])[0] >= solid.shape.radius)
        case "union":
            return all(_in_cell(member, frame, lattice, place) for member in solid.shape)
        case "intersection":
            return any(_in_cell(member, frame, lattice, place) for member in solid.shape)
        case "difference":
            return _in_cell(solid.shape[0], frame, lattice, place)
        case _:
            return False
