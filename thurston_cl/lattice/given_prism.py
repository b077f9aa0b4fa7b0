"""A lattice of s2xe, h2xe, nil or sl2 that a person gives by matrices and half-spaces, checked."""

import numpy as np

from thurston_cl.lattice.checks import OVERLAP, blame
from thurston_cl.lattice.error import LatticeError
from thurston_cl.lattice.forms import Array
from thurston_cl.lattice.given_upright import check_bounding, pair_up, upright_walls
from thurston_cl.lattice.isometry import (
    SAME_DIGITS,
    act,
    compose,
    fibre,
    identity,
    on_model,
    origin,
    tidy,
)
from thurston_cl.lattice.prism import Prism, base_radius
from thurston_cl.lattice.radius import greatest_climb

# A trial whether the domain's images overlap: so many points of it, moved by so many elements at most. The
# cells that touch a domain are far fewer.
TRIAL_POINTS = 200
TRIAL_ELEMENTS = 2000


def prism_from(geometry: str, maps: Array, walls: Array, tolerance: float, name: str) -> Prism:
    """The prism with these isometries (F,n,n) and half-spaces (F,n): see `from_matrices`."""
    walls = upright_walls(geometry, walls, tolerance)
    maps = np.array([tidy(geometry, m, tolerance) for m in maps])
    levels = np.flatnonzero(walls[:, fibre(geometry)])
    for f in levels:
        _check_level(geometry, maps[f], int(f), tolerance)
    pair_up(geometry, walls, maps, tolerance)
    check_bounding(geometry, walls)
    order = [*np.delete(np.arange(len(walls)), levels), *levels]
    prism = Prism(name, geometry, walls[order], maps[order], "given by generators and half-spaces")
    _check_tiling(prism)
    return prism


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
