"""The walls of an upright domain that a person gives, checked, and which generator leads where."""

import numpy as np

from thurston_cl.lattice.checks import INSIDE, OVERLAP, blame, partner_of
from thurston_cl.lattice.forms import Array, unit_wall
from thurston_cl.lattice.isometry import act, compose, dimension, fibre, identity, inverse, origin, snap
from thurston_cl.lattice.polygon import BASE, Polygon, lower


def upright_walls(geometry: str, half_spaces: Array, tolerance: float) -> Array:
    """Half-spaces (F,n), scaled. LatticeError where one is neither side nor level, or has o outside."""
    return np.array([_upright_wall(geometry, n, f, tolerance) for f, n in enumerate(half_spaces)])


def _upright_wall(geometry: str, n: Array, f: int, tolerance: float) -> Array:
    axis, base = fibre(geometry), _base_entries(geometry)
    small = np.abs(n) <= tolerance * np.max(np.abs(n))
    wall = np.where(small, 0.0, n)
    level = not small[axis]
    own = {axis, len(n) - 1} if level else set(base)
    if small.all() or not all(small[k] for k in range(len(n)) if k not in own):
        forms = "a side [a, b, c, 0, 0] nor a level [0, 0, 0, d, e]"
        if len(n) == 4:
            forms = "a side [a, b, 0, d] nor a level [0, 0, c, d]"
        raise blame("domain", f, f"is neither {forms}; walls cannot lean in {geometry}")
    if level:
        wall = snap(wall / abs(wall[axis]))
    else:
        try:
            wall[base] = unit_wall(BASE[geometry], np.insert(wall[base], 2, 0.0))[[0, 1, 3]]
        except ValueError:
            cure = "a^2 + b^2 must exceed c^2" if geometry in ("h2xe", "sl2") else "a, b must not both be 0"
            raise blame("domain", f, f"has no boundary plane; {cure}") from None
        wall = snap(wall)
    constant = len(n) - 1 if level else base[2]
    if wall[constant] >= -INSIDE:
        raise blame(
            "domain",
            f,
            f"does not have the origin inside: {'abcde'[constant]} must be negative; "
            "change all signs if the other side is meant",
        )
    return wall


def pair_up(geometry: str, walls: Array, maps: Array, tolerance: float) -> list[int]:
    """For each wall (F,n) that to which its map (F,n,n) carries it, and whose map is the inverse. What the
    tolerance let pass is repaired, in place. LatticeError where there is none.
    """
    partner = [_partner(geometry, walls, maps, f, tolerance) for f in range(len(walls))]
    for f, g in enumerate(partner):
        if partner[g] != f:
            raise blame("generators", f, f"is the same as number {partner[g] + 1}; leave one of them out")
        # Maps of sides may be inverses but for a shift along the fibre.
        if f < g:
            walls[g] = snap(_carried(geometry, walls[f], maps[f]))
            if _off_identity(geometry, compose(geometry, maps[g], maps[f])) < OVERLAP:
                maps[g] = snap(inverse(geometry, maps[f]))
    return partner


def _carried(geometry: str, wall: Array, m: Array) -> Array:
    """The wall (n,) carried by a generator m (n,n), with the sides exchanged."""
    axis = fibre(geometry)
    if wall[axis] == 0:
        # A covector of the base, on the block of the matrix that moves the base.
        at = _base_entries(geometry)
        back = inverse(geometry, m)[np.ix_(at, at)]
        carried = np.zeros_like(wall)
        carried[at] = -wall[at] @ back
        return carried
    point = origin(geometry)
    point[axis] = -wall[-1] * wall[axis]
    carried = np.zeros_like(wall)
    carried[axis] = -wall[axis] * m[axis, axis]
    carried[-1] = -carried[axis] * act(geometry, m, point)[axis]
    return carried


def _partner(geometry: str, walls: Array, maps: Array, f: int, tolerance: float) -> int:
    """The wall that maps[f] carries wall f to and whose map is its inverse, or LatticeError."""
    size = max(1.0, float(np.max(np.abs(maps[f]))))
    # Entries off by the tolerance spoil products by this much.
    allowed = 10.0 * tolerance * size * size
    products = compose(geometry, maps, maps[f])
    if walls[f, fibre(geometry)] == 0:
        # A side's map has its inverse on the base.
        at = _base_entries(geometry)
        off = [float(np.max(np.abs(m[np.ix_(at, at)] - np.eye(3)))) for m in products]
    else:
        off = [_off_identity(geometry, m) for m in products]
    defects = np.max(np.abs(walls - _carried(geometry, walls[f], maps[f])), axis=1)

    def outward(best: int) -> float:
        carried = _carried(geometry, walls[f], inverse(geometry, maps[f]))
        return float(np.max(np.abs(walls[best] - carried)))

    return partner_of(f, np.array(off), defects, outward, allowed)


def _base_entries(geometry: str) -> list[int]:
    """The homogeneous coordinates that are those of the base."""
    return [0, 1, 3] if dimension(geometry) == 4 else [0, 1, 2]


def _off_identity(geometry: str, m: Array) -> float:
    return float(np.max(np.abs(m - identity(geometry))))


def check_bounding(geometry: str, walls: Array) -> None:
    """Raises LatticeError where a wall does not bound the domain."""
    upright = walls[:, fibre(geometry)]
    sides = [f for f in range(len(walls)) if upright[f] == 0]
    polygon = Polygon(BASE[geometry], lower(geometry, walls[sides][:, :4]))
    bounding = {sides[k] for k in polygon.bounding}
    for sign in (1.0, -1.0):
        stacked = [f for f in range(len(walls)) if upright[f] == sign]
        bounding |= {max(stacked, key=lambda f: float(walls[f, -1]))} if stacked else set()
    for f in range(len(walls)):
        if f not in bounding:
            raise blame(
                "domain",
                f,
                "does not bound the domain, for the others already imply it; "
                "leave it out with its generator, or correct its numbers",
            )
