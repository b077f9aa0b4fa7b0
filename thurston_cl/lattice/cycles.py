"""Edge cycles of a fundamental domain, and the group's presentation that follows (Poincare's polyhedron
theorem).

Maskit, "On Poincare's theorem for fundamental polygons", 1971; Epstein and Petronio, "An exposition of
Poincare's polyhedron theorem", 1994.
"""

from dataclasses import dataclass

import numpy as np

from thurston_cl.lattice.domain import Lattice
from thurston_cl.lattice.error import LatticeError
from thurston_cl.lattice.forms import Array
from thurston_cl.lattice.polyhedral import Polyhedral
from thurston_cl.lattice.polyhedron import Edge

# Ends of glued edges agree to this (vectors scaled to length 1 in R^4); distinct vertices are farther apart.
MATCH = 1e-6
# An angle sum is 2 pi/k when it is within this, in radians.
ANGLE = 1e-6

Word = tuple[int, ...]


@dataclass(frozen=True, eq=False)
class EdgeCycle:
    """Edges that are glued together.

    `edges` are indices into edges(lattice) and `faces` the walls crossed one after the other when going once
    around; `transformation` (4,4) is the product of their maps, the last crossed on the left. `angle` is the
    sum of the dihedral angles, in radians, and `order` the k with angle = 2 pi/k: 1 in a manifold, k > 1 for
    a cone axis of an orbifold, None when there is no such k (a cone manifold: the maps generate no discrete
    group with this domain).
    """

    edges: tuple[int, ...]
    faces: tuple[int, ...]
    transformation: Array
    angle: float
    order: int | None


def edge_cycles(lattice: Lattice) -> list[EdgeCycle]:
    """Cycles of edges of the domain, each edge in one cycle, in the order of their first edges.

    An edge that a map turns around is passed once in each sense. Raises LatticeError when a map does not
    carry the edges of its wall to edges of the partner, or when edges are not in the chart (a domain of s3
    that reaches w = 0), and for a prism, whose maps need not pair its faces.
    """
    lattice = _polyhedral(lattice)
    edges = lattice.polyhedron.edges
    if lattice.geometry == "s3" and (not edges or any("open" in edge.kinds for edge in edges)):
        raise LatticeError(f"the domain of '{lattice.name}' reaches the equator w = 0 of s3", "domain")
    partner = [int(f) for f in lattice.partner]
    left = set(range(len(edges)))
    cycles = []
    while left:
        start = min(left)
        # A state is an edge with a sense, and the wall that will be crossed next.
        state = (start, False, edges[start].walls[0])
        crossed: list[int] = []
        passed: list[int] = []
        product = np.eye(4)
        angle = 0.0
        while True:
            edge, flipped, face = state
            passed.append(edge)
            left.discard(edge)
            crossed.append(face)
            angle += edges[edge].angle
            product = lattice.maps[face] @ product
            image, turned = _image(lattice, edges, edge, face, partner[face])
            f, g = edges[image].walls
            state = (image, flipped != turned, g if f == partner[face] else f)
            if state == (start, False, edges[start].walls[0]):
                break
        turns = 2.0 * np.pi / angle
        order = round(turns)
        good = order >= 1 and abs(angle - 2.0 * np.pi / order) < ANGLE * len(crossed)
        cycles.append(EdgeCycle(tuple(passed), tuple(crossed), product, angle, order if good else None))
    return cycles


def _polyhedral(lattice: Lattice) -> Polyhedral:
    if not isinstance(lattice, Polyhedral):
        raise LatticeError(
            f"the domain of '{lattice.name}' is a prism, not given by a pairing of faces", "domain"
        )
    return lattice


def _image(lattice: Lattice, edges: list[Edge], edge: int, face: int, partner: int) -> tuple[int, bool]:
    """The edge that the face's map carries an edge to, and whether the ends are exchanged."""
    ends = [_direction(lattice.maps[face] @ end) for end in edges[edge].ends]
    for other, candidate in enumerate(edges):
        if partner not in candidate.walls:
            continue
        to = [_direction(end) for end in candidate.ends]
        for turned in (False, True):
            first, second = (to[1], to[0]) if turned else (to[0], to[1])
            if np.max(np.abs(ends[0] - first)) < MATCH and np.max(np.abs(ends[1] - second)) < MATCH:
                return other, turned
    raise LatticeError(
        f"generator {face + 1} of '{lattice.name}' does not carry the edges of its face to edges of face "
        f"{partner + 1}",
        "domain",
        face,
    )


def _direction(vector: Array) -> Array:
    """A vector scaled to length 1 in R^4: ideal ends are only known up to a positive factor."""
    return vector / np.linalg.norm(vector)


def presentation(lattice: Lattice) -> tuple[Array, list[Word]]:
    """Generators (n,4,4) and relations of the group, from the face pairing and the edge cycles.

    There is one generator per pair of walls: the map of the first. A relation is a word such as (1, -2, 1):
    the matrix product g1 inverse(g2) g1 is the identity. Raises LatticeError as `edge_cycles` does, and when
    an angle sum is not 2 pi/k.
    """
    lattice = _polyhedral(lattice)
    partner = lattice.partner
    firsts = [f for f in range(len(partner)) if f <= partner[f]]
    letter = {}
    for number, f in enumerate(firsts, start=1):
        letter[int(partner[f])] = -number
        letter[f] = number
    relations: list[Word] = [(letter[f], letter[f]) for f in firsts if partner[f] == f]
    for cycle in edge_cycles(lattice):
        if cycle.order is None:
            raise LatticeError(
                f"the dihedral angles of '{lattice.name}' around an edge sum up to "
                f"{np.degrees(cycle.angle):.6g} degrees, which is not 360/k",
                "domain",
            )
        relations.append(tuple(letter[f] for f in reversed(cycle.faces)) * cycle.order)
    return lattice.maps[firsts], relations
