"""A lattice that a person gives by matrices and half-spaces, checked."""

import numpy as np
from numpy.typing import ArrayLike

from thurston_cl.lattice.checks import INSIDE, OVERLAP, blame, check_isometry, given_numbers, partner_of
from thurston_cl.lattice.cycles import edge_cycles
from thurston_cl.lattice.domain import Lattice
from thurston_cl.lattice.error import LatticeError
from thurston_cl.lattice.forms import ORIGIN, Array, unit_wall
from thurston_cl.lattice.given_prism import prism_from
from thurston_cl.lattice.given_suspension import suspension_from
from thurston_cl.lattice.isometry import check_geometry, inverse, on_model, snap, tidy
from thurston_cl.lattice.polyhedral import Polyhedral, pairing_defects
from thurston_cl.lattice.polyhedron import Polyhedron
from thurston_cl.models import FIBRED

# A trial whether the domain's images overlap: so many points of it, moved by all words of so many generators.
# Shorter words miss rotations that fit a face but not its corners; longer ones cost seconds.
TRIAL_POINTS = 200
TRIAL_WORD_LENGTH = 3


def from_matrices(
    geometry: str, generators: ArrayLike, half_spaces: ArrayLike, tolerance: float = 1e-9, name: str = "given"
) -> Lattice:
    """Lattice with the domain {p : half_spaces[f] . p <= 0 for all f}; generators[f] leads back over wall f.

    `generators` is (F,n,n), isometries acting on columns [x,y,z,w], and [x,y,z,w,1] in s2xe, h2xe, sl2 (see
    `thurston_cl.lattice.isometry`); `half_spaces` is (F,n), covectors of any positive scale. The origin must
    be inside. The inverse of every generator must be there too, and a generator must carry the plane of its
    half-space to that of its inverse, with the sides exchanged; see `Prism` for what walls and generators of
    fibred geometries are, where that is asked of the base and of the fibre over o, and `Suspension` for those
    of sol. Numbers may be off by
    `tolerance`, relative to the largest; generators and planes are then corrected to rounding. A gluing whose
    angles around an edge do not add up to 2 pi/k is allowed (a cone manifold, paper 4.3): see `edge_cycles`.
    So is one whose faces meet like bricks, if the images of the domain do not overlap.

    Raises LatticeError: `what` is "generators" or "domain", `index` the entry to blame, from 0, if there is
    one. Its text counts from 1.
    """
    check_geometry(geometry)
    maps, walls = given_numbers(geometry, generators, half_spaces)
    for f, m in enumerate(maps):
        check_isometry(geometry, m, f, tolerance)
    if geometry in FIBRED:
        return prism_from(geometry, maps, walls, tolerance, name)
    if geometry == "sol":
        return suspension_from(maps, walls, tolerance, name)
    for f, n in enumerate(walls):
        walls[f] = _unit_half_space(geometry, n, f)

    # Repair what the tolerance let pass.
    maps = np.array([tidy(geometry, m, tolerance) for m in maps])
    walls = np.array([snap(unit_wall(geometry, snap(n, tolerance))) for n in walls])
    partner = [_partner(geometry, walls, maps, f, tolerance) for f in range(len(walls))]
    for f, g in enumerate(partner):
        if partner[g] != f:
            raise blame("generators", f, f"is the same as number {partner[g] + 1}; leave one of them out")
        if f < g:
            maps[g] = snap(inverse(geometry, maps[f]))
            walls[g] = snap(unit_wall(geometry, -walls[f] @ maps[g]))

    bounding = Polyhedron(geometry, walls).bounding
    for f in range(len(walls)):
        if f not in bounding:
            raise blame(
                "domain",
                f,
                "does not bound the domain, for the others already imply it; "
                "leave it out with its generator, or correct its numbers",
            )
    lattice = Polyhedral(name, geometry, walls, maps, "given by generators and half-spaces")
    _check_tiling(lattice)
    return lattice


def _check_tiling(lattice: Lattice) -> None:
    """Either every face is carried onto a face, edge to edge (a cone manifold is), or, like bricks that are
    laid half over each other, the images of the domain do not overlap.
    """
    try:
        edge_cycles(lattice)
        return
    except LatticeError as error:
        mismatch = error
    points = (
        np.random.default_rng(0).normal(size=(TRIAL_POINTS, 4)) * [1, 1, 1, 0] * lattice.inradius + ORIGIN
    )
    points = on_model(lattice.geometry, points)
    points = points[lattice.contains(points, -OVERLAP)]
    words = lattice.maps
    for _ in range(TRIAL_WORD_LENGTH - 1):
        words = np.concatenate([words, np.einsum("fij,wjk->wfik", lattice.maps, words).reshape(-1, 4, 4)])
    moved = np.abs(words - np.eye(4)).max(axis=(1, 2)) > OVERLAP
    images = np.einsum("wij,nj->wni", words[moved], points)
    if lattice.contains(images, -OVERLAP).any():
        text = "the images of the domain overlap, so that it does not tile space"
        raise LatticeError(f"{mismatch}; {text}", "generators", mismatch.index)


def _unit_half_space(geometry: str, n: Array, f: int) -> Array:
    try:
        wall = unit_wall(geometry, n)
    except ValueError as error:
        cure = "a^2 + b^2 + c^2 must exceed d^2" if geometry == "h3" else "a, b, c must not all be 0"
        raise blame("domain", f, f"has no boundary plane: {error}; {cure}") from None
    if wall[3] >= -INSIDE:
        raise blame(
            "domain",
            f,
            "does not have the origin inside: [a, b, c, d] means a x + b y + c z + d w <= 0, so d must be "
            "negative; change all four signs if the other side is meant",
        )
    return wall


def _partner(geometry: str, walls: Array, maps: Array, f: int, tolerance: float) -> int:
    """The wall that maps[f] carries wall f to and whose map is its inverse, or LatticeError."""
    # Entries off by the tolerance spoil products by this much.
    size = max(1.0, float(np.max(np.abs(maps[f]))), float(np.max(np.abs(walls[f]))))
    allowed = 10.0 * tolerance * size * size
    inverse_defect, wall_defect = (defect[f] for defect in pairing_defects(geometry, walls, maps))

    def outward(best: int) -> float:
        return float(pairing_defects(geometry, walls, inverse(geometry, maps))[1][f, best])

    return partner_of(f, inverse_defect, wall_defect, outward, allowed)
