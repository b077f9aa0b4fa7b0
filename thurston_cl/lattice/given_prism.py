"""A lattice of s2xe, h2xe, nil or sl2 that a person gives by matrices and half-spaces, checked."""

import numpy as np

from thurston_cl.lattice.checks import INSIDE, OVERLAP, blame
from thurston_cl.lattice.error import LatticeError
from thurston_cl.lattice.forms import Array, unit_wall
from thurston_cl.lattice.isometry import (
    SAME_DIGITS,
    act,
    compose,
    fibre,
    identity,
    inverse,
    on_model,
    origin,
    snap,
    tidy,
)
from thurston_cl.lattice.polygon import BASE, Polygon, lower
from thurston_cl.lattice.prism import Prism, base_radius
from thurston_cl.lattice.radius import greatest_climb

# A trial whether the domain's images overlap: so many points of it, moved by so many elements at most. The
# cells that touch a domain are far fewer.
TRIAL_POINTS = 200
TRIAL_ELEMENTS = 2000


def prism_from(geometry: str, maps: Array, walls: Array, tolerance: float, name: str) -> Prism:
    """The prism with these isometries (F,n,n) and half-spaces (F,n): see `from_matrices`."""
    axis = fibre(geometry)
    walls = np.array([_unit(geometry, n, f, tolerance) for f, n in enumerate(walls)])
    levels = [f for f in range(len(walls)) if walls[f, axis] != 0]
    sides = [f for f in range(len(walls)) if walls[f, axis] == 0]
    maps = np.array([tidy(geometry, m, tolerance) for m in maps])
    for f in levels:
        _check_level(geometry, maps[f], f, tolerance)
    partner = [_partner(geometry, walls, maps, f, tolerance) for f in range(len(walls))]
    for f, g in enumerate(partner):
        if partner[g] != f:
            raise blame("generators", f, f"is the same as number {partner[g] + 1}; leave one of them out")
        # Repair what the tolerance let pass. Maps of sides may be inverses but for a shift along the fibre.
        if f < g:
            walls[g] = snap(_carried(geometry, walls[f], maps[f]))
            if _off_identity(geometry, compose(geometry, maps[g], maps[f])) < OVERLAP:
                maps[g] = snap(inverse(geometry, maps[f]))
    _check_bounding(geometry, walls, sides, levels)
    order = [*sides, *levels]
    prism = Prism(name, geometry, walls[order], maps[order], "given by generators and half-spaces")
    _check_tiling(prism)
    return prism


def _unit(geometry: str, n: Array, f: int, tolerance: float) -> Array:
    """Half-space f, n (n,), scaled; LatticeError where it is neither a side nor a level, or o is outside."""
    axis, base = fibre(geometry), _base_entries(geometry)
    small = np.abs(n) <= tolerance * np.max(np.abs(n))
    wall = np.where(small, 0.0, n)
    level = not small[axis]
    own = {axis, len(n) - 1} if level else set(base)
    if small.all() or not all(small[k] for k in range(len(n)) if k not in own):
        forms = (
            ("[a, b, 0, d]", "[0, 0, c, d]") if geometry == "nil" else ("[a, b, c, 0, 0]", "[0, 0, 0, d, e]")
        )
        text = f"is neither a side {forms[0]} over the base nor a level {forms[1]} of the fiber"
        raise blame("domain", f, f"{text}; walls cannot lean in {geometry}")
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


def _check_level(geometry: str, m: Array, f: int, tolerance: float) -> None:
    """A level's generator must keep the fibre over o: then it carries levels to levels, in nil and sl2
    too.
    """
    moved = float(base_radius(geometry, act(geometry, m, origin(geometry))))
    if moved > 10.0 * tolerance:
        raise blame(
            "generators",
            f,
            f"leads back over a level but moves the fiber over the origin by {moved:.2g}; "
            "compose it with generators of the sides until it shifts along that fiber",
        )


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
    inverses = np.flatnonzero(np.array(off) < allowed)
    if len(inverses) == 0:
        raise blame(
            "generators",
            f,
            "has no inverse among the generators; add it, with the half-space whose points it leads back",
        )
    defects = np.max(np.abs(walls - _carried(geometry, walls[f], maps[f])), axis=1)
    best = int(inverses[np.argmin(defects[inverses])])
    if defects[best] < allowed:
        return best
    if np.max(np.abs(walls[best] - _carried(geometry, walls[f], inverse(geometry, maps[f])))) < allowed:
        raise blame(
            "generators",
            f,
            "moves the wrong way: it must lead back the points outside its half-space; "
            "exchange it with its inverse",
        )
    raise blame(
        "domain",
        f,
        f"does not fit its generator, which should carry its plane to that of half-space {best + 1} "
        f"and misses by {defects[best]:.2g}; correct one of the half-spaces or the generator",
    )


def _base_entries(geometry: str) -> list[int]:
    """The homogeneous coordinates that are those of the base."""
    return [0, 1, 3] if geometry == "nil" else [0, 1, 2]


def _off_identity(geometry: str, m: Array) -> float:
    return float(np.max(np.abs(m - identity(geometry))))


def _check_bounding(geometry: str, walls: Array, sides: list[int], levels: list[int]) -> None:
    """Each wall must bound the domain."""
    polygon = Polygon(BASE[geometry], lower(geometry, walls[sides][:, :4]))
    bounding = {sides[k] for k in polygon.bounding}
    for sign in (1.0, -1.0):
        stacked = [f for f in levels if walls[f, fibre(geometry)] == sign]
        bounding |= {max(stacked, key=lambda f: float(walls[f, -1]))} if stacked else set()
    for f in range(len(walls)):
        if f not in bounding:
            raise blame(
                "domain",
                f,
                "does not bound the domain, for the others already imply it; "
                "leave it out with its generator, or correct its numbers",
            )


def _check_tiling(prism: Prism) -> None:
    """The images of the domain must not overlap: those around it are tried."""
    geometry, axis = prism.geometry, fibre(prism.geometry)
    points = _trial_points(prism)
    # Cells that share a corner with the domain have their centres within twice its distance.
    corners = [c.vector for c in prism.polygon.corners if c.kind == "finite"]
    corners += [prism.polygon.foot(f) for f in range(len(prism.polygon.sides))]
    reach = 2.0 * float(np.max(base_radius(geometry, _raised(geometry, corners)), initial=0.0)) + OVERLAP
    low, high = prism.levels
    # On the way around a corner a bundle may climb more than the height of a cell.
    climb = 2.0 * (high - low) + greatest_climb(geometry, 2.0 * reach)
    known = {_key(identity(geometry))}
    fresh = [identity(geometry)]
    while fresh and len(known) < TRIAL_ELEMENTS:
        following = []
        for image in (compose(geometry, element, step) for element in fresh for step in prism.inverses):
            centre = act(geometry, image, prism.centre)
            near = base_radius(geometry, centre) <= reach and abs(centre[axis]) <= climb
            if near and _key(image) not in known:
                known.add(_key(image))
                following.append(image)
        for image in following:
            if prism.contains(act(geometry, image, points), -OVERLAP).any():
                text = "the images of the domain overlap, so that it does not tile space"
                raise LatticeError(f"{text}; correct the generators", "generators")
        fresh = following


def _key(element: Array) -> bytes:
    return (np.round(element, SAME_DIGITS) + 0.0).tobytes()


def _raised(geometry: str, base: list[Array]) -> Array:
    points = np.array(base).reshape(-1, 4)
    return points if geometry == "nil" else points[:, [0, 1, 3, 2]]


def _trial_points(prism: Prism) -> Array:
    """Points (M,4) of the domain, more of them near the origin."""
    geometry, axis = prism.geometry, fibre(prism.geometry)
    random = np.random.default_rng(0)
    ends = [
        base_radius(geometry, _raised(geometry, [prism.polygon.foot(f)]))[0]
        for f in range(len(prism.polygon.sides))
    ]
    size = min([1.0, *ends])
    points = np.tile(prism.centre, (TRIAL_POINTS, 1))
    points[:, :2] += size * random.normal(size=(TRIAL_POINTS, 2))
    low, high = (max(-1.0, prism.levels[0]), min(1.0, prism.levels[1]))
    points[:, axis] = random.uniform(low, high, TRIAL_POINTS)
    points = on_model(geometry, points)
    return points[prism.contains(points, -OVERLAP)]
