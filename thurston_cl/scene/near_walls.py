"""How to measure distance near the walls of a cell (paper 4.2), and which images of an object that takes."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from thurston_cl.lattice import Lattice, elements
from thurston_cl.lattice.isometry import SAME_DIGITS, act, compose, fibre, inverse, origin
from thurston_cl.lattice.suspension import Suspension
from thurston_cl.models import FIBRED, PRODUCTS, TWISTED
from thurston_cl.scene import schema
from thurston_cl.scene.krs_sequence import SequenceError, painted_sequence
from thurston_cl.scene.placement import Placement

Array = NDArray[np.float64]

# Group elements that are tried, nearest first, for images of an object that reach into the cell.
SEARCHED = 1000
# If one of the last of them, this part of all, is an image, there are more, and the picture would lack them.
LAST = 20
# How far outside the domain a point of an edge may be and still be on it: far above rounding.
ON_EDGE = 1e-9
# How often a line may run along each translation of a torus before it closes: beyond, its images fill the
# cell closely, and there would be too many of them.
MOST_TIMES = 12
# The sine of the angle by which a direction may miss a closed one: scenes give few digits of irrational ones.
CLOSED = 1e-4


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
    symmetric = scene.lattice.is_dirichlet and all(_symmetric_hollow(solid) for solid in scene.solids)
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


def is_hollow(solid: schema.Solid, geometry: str) -> bool:
    """Whether a solid fills the cell, or a floor of it, but for something: over a wall it would fill what its
    neighbour leaves out.
    """
    match solid.kind:
        case "tile" | "complement":
            return True
        case "intersection" | "union":
            return all(is_hollow(member, geometry) for member in solid.shape)
        case "difference":
            first = solid.shape[0]
            floor = first.kind in ("slab", "half-space") and first.shape.normal[2] != 0
            return (floor and geometry in PRODUCTS) or is_hollow(first, geometry)
        case _:
            return False


@dataclass(frozen=True)
class _Bound:
    """A ball, or the solid cylinder about the fibre through its centre, that holds a solid."""

    centre: Array
    radius: float
    vertical: bool


def images(
    solid: schema.Solid,
    frame: Array,
    near_walls: str,
    lattice: Lattice,
    place: Placement,
    reach: float = 0.0,
) -> Array:
    """The group elements (M,n,n) besides 1 by which a solid is seen from the cell, or from so far around it.

    `frame` (n,n) carries what the solid belongs to into the cell.
    """
    geometry = lattice.geometry
    if is_hollow(solid, geometry) or near_walls in ("whole space", "domain", "creeping"):
        return lattice.inverses[:0]
    bounds = bounds_of(solid, frame, place)
    if bounds is None and geometry in TWISTED and _has_level(solid) and lattice.has_sides:
        raise ValueError(
            "this manifold does not keep levels, so that a horizontal plane has no place in it; cut a "
            "bounded piece out of it with an intersection, or leave the manifold out"
        )
    if bounds is None:
        _check_sequences(solid, place)
    if bounds is None and isinstance(lattice, Suspension):
        _check_lines(solid, frame, lattice, place)
    if near_walls in ("neighbours", "both"):
        return lattice.over_walls
    if bounds is None:
        return _around_edges(lattice)
    near = elements(lattice, count=SEARCHED)[1:]
    ended = len(near) + 1 < SEARCHED
    vertical = all(bound.vertical for bound in bounds)
    if vertical:
        near = _one_a_base(geometry, near)
    reached = np.zeros(len(near), dtype=bool)
    for bound in bounds:
        centres = act(geometry, near, bound.centre)
        if bound.vertical:
            centres = on_base(geometry, centres)
        radius = bound.radius + reach
        # The height over one wall is a quick lower bound.
        for k in np.flatnonzero(lattice.clearance(centres) > -radius):
            reached[k] |= lattice.distance_from(centres[k]) < radius
    if not ended and reached[-max(1, len(near) // LAST) :].any():
        _too_many_images(solid)
    return near[reached]


def _too_many_images(solid: schema.Solid) -> NoReturn:
    """Raises ValueError, and says of a recipe which keys make it smaller."""
    message, help = "too many images of this reach over the walls", "make it smaller, or the cell larger"
    made = next((leaf.shape for leaf in _leaves(solid) if leaf.kind == "krs" and leaf.shape.recipe), None)
    if made is None:
        raise ValueError(f"{message}; {help}")
    lengths = [f"'{key}'" for key in made.recipe.lengths()]
    named = f"{', '.join(lengths[:-1])} and {lengths[-1]}" if len(lengths) > 1 else lengths[0]
    help = f"take a smaller {named}, or a larger cell"
    raise SequenceError(message, (made.kind,), help, made)


def _leaves(solid: schema.Solid) -> Iterator[schema.Solid]:
    """The shapes that a solid is made of."""
    members = solid.shape if isinstance(solid.shape, tuple) else [solid.shape]
    solids = [member for member in members if isinstance(member, schema.Solid)]
    for member in solids:
        yield from _leaves(member)
    if not solids:
        yield solid


def _has_level(solid: schema.Solid) -> bool:
    """Whether a horizontal half-space or slab takes part in a solid."""
    return any(leaf.kind in ("half-space", "slab") and leaf.shape.normal[2] != 0 for leaf in _leaves(solid))


def _check_lines(solid: schema.Solid, outer: Array, lattice: Suspension, place: Placement) -> None:
    """Raises ValueError unless the horizontal lines that a solid of sol runs along close in the manifold:
    each has to be along a sum of few of the translations over the sides.
    """
    if not lattice.has_sides:
        return
    frame = compose("sol", outer, place.isometry(solid.at, solid.rotate))
    match solid.kind:
        case "cylinder" | "pseudo-cylinder":
            along = np.array(solid.shape.along, dtype=np.float64)[:2]
        case "half-space" | "slab":
            # The axis of the plane other than z.
            normal = np.array(solid.shape.normal, dtype=np.float64)
            along = np.array([normal[1], normal[0]]) if normal[2] == 0 else np.zeros(2)
        case _:
            members = solid.shape if isinstance(solid.shape, tuple) else [solid.shape]
            for member in members:
                if isinstance(member, schema.Solid):
                    _check_lines(member, frame, lattice, place)
            return
    # The translations as they are in the coordinates of the solid.
    translations = lattice.basis @ np.linalg.inv(frame[:2, :2]).T
    if along.any() and not _few(along, translations):
        ways = " or ".join(f"[{x:.5g}, {y:.5g}, 0]" for x, y in translations)
        raise ValueError(
            f"in this manifold the horizontal lines of this {solid.kind} never close, and come as near to "
            f"every point as one likes; lead it along a translation of the torus, there {ways}, cut a "
            "bounded piece out of it with an intersection, or leave the manifold out"
        )


def _few(direction: Array, translations: Array) -> bool:
    """Whether a direction (2,) of x, y is along a sum of each of the translations (k,2) a few times."""
    times = np.arange(-MOST_TIMES, MOST_TIMES + 1)
    sums = np.stack(np.meshgrid(*[times] * len(translations)), axis=-1).reshape(-1, len(translations))
    ways = sums[np.any(sums != 0, axis=1)] @ translations
    sines = np.abs(direction[0] * ways[:, 1] - direction[1] * ways[:, 0])
    return bool(np.any(sines < CLOSED * np.hypot(*direction) * np.hypot(*ways.T)))


def balls_over_walls(lattice: Lattice, centres: Array, radius: float) -> Array:
    """The images (M,4) of centres (N,4) of balls, besides themselves, whose balls reach into the cell."""
    near = elements(lattice, count=SEARCHED)[1:]
    found = act(lattice.geometry, near[:, None], centres[None]).reshape(-1, centres.shape[1])
    found = found[lattice.clearance(found) > -radius]
    known = [tuple(row) for row in np.round(centres, SAME_DIGITS) + 0.0]
    new: dict[tuple[float, ...], Array] = {}
    for point in found:
        key = tuple(np.round(point, SAME_DIGITS) + 0.0)
        if key not in known and key not in new and lattice.distance_from(point) < radius:
            new[key] = point
    return np.array(list(new.values())).reshape(-1, centres.shape[1])


def on_base(geometry: str, points: Array) -> Array:
    """Points (N,4) of a fibred geometry moved along their fibres to coordinate 0."""
    moved = points.copy()
    moved[:, fibre(geometry)] = 0.0
    return moved


def _one_a_base(geometry: str, found: Array) -> Array:
    """Of elements (M,n,n) that act alike on the base one each, and none that acts as 1: from all of them a
    vertical solid looks the same.
    """
    size = 2 if geometry == "nil" else 3
    columns = [0, 1, 3] if geometry == "nil" else [0, 1, 2]
    base = np.concatenate([np.eye(size, len(columns))[None], found[:, :size][:, :, columns]])
    _, first = np.unique(np.round(base.reshape(len(base), -1), SAME_DIGITS) + 0.0, axis=0, return_index=True)
    return found[np.sort(first[first > 0]) - 1]


def bounds_of(solid: schema.Solid, outer: Array, place: Placement) -> list[_Bound] | None:
    """What holds a solid together; None for a solid without bound."""
    geometry = place.geometry.name
    frame = compose(geometry, outer, place.isometry(solid.at, solid.rotate))
    match solid.kind:
        case "ball":
            return [_Bound(act(geometry, frame, origin(geometry)), solid.shape.radius, False)]
        case "pseudo-ball":
            # Along z and then straight across it, d <= |z| + sqrt(X^2 + Y^2) <= sqrt(2) sigma.
            radius = float(np.sqrt(2.0)) * solid.shape.radius
            return [_Bound(act(geometry, frame, origin(geometry)), radius, False)]
        case "cylinder" if geometry in FIBRED and solid.shape.along[2] != 0:
            return [_Bound(act(geometry, frame, origin(geometry)), solid.shape.radius, True)]
        case "krs":
            ball = painted_sequence(solid.shape, place.geometry).ball
            return None if ball is None else [_Bound(act(geometry, frame, ball[0]), ball[1], False)]
        case "union":
            members = [bounds_of(member, frame, place) for member in solid.shape]
            if None in members:
                return None
            return [bound for member in members if member is not None for bound in member]
        case "intersection":
            members = [bounds_of(member, frame, place) for member in solid.shape]
            box = _box(solid.shape, frame) if geometry == "sol" else None
            return next((member for member in members if member is not None), box)
        case "difference":
            return bounds_of(solid.shape[0], frame, place)
        case _:
            return None


def _check_sequences(solid: schema.Solid, place: Placement) -> None:
    """SequenceError if a solid has a sequence of which nobody knows how far it reaches."""
    if solid.kind == "krs":
        painted = painted_sequence(solid.shape, place.geometry)
        if painted.ball is None and painted.sequence.bounded:
            message = f"these {painted.sequence.instances} kernels are too many to find how far they reach"
            raise SequenceError(message, help="take levels off, or leave the manifold out", krs=solid.shape)
        if painted.ball is None:
            message = "a sequence without bound, for it has a plane, has no place in a manifold"
            help = "cut a bounded piece out of it with an intersection, or leave the manifold out"
            raise SequenceError(message, help=help, krs=solid.shape)
    members = solid.shape if isinstance(solid.shape, tuple) else (solid.shape,)
    for member in members:
        if isinstance(member, schema.Solid):
            _check_sequences(member, place)


def _box(members: tuple[schema.Solid, ...], frame: Array) -> list[_Bound] | None:
    """What holds an intersection of slabs of sol across x, y and z together."""
    half = [np.inf] * 3
    for member in members:
        if member.kind == "slab" and member.at == (0.0, 0.0, 0.0) and not member.rotate:
            axis = int(np.argmax(np.abs(member.shape.normal)))
            half[axis] = min(half[axis], 0.5 * member.shape.thickness)
    if np.inf in half:
        return None
    # Straight to the point below or above, and from there along z.
    radius = float(np.hypot(*np.sinh(half[:2]))) + half[2]
    return [_Bound(act("sol", frame, origin("sol")), radius, False)]


def _around_edges(lattice: Lattice) -> Array:
    """The elements (M,n,n) besides 1 whose cells share a face or an edge with the domain."""
    geometry = lattice.geometry
    middles = np.array([edge.point for edge in lattice.polyhedron.edges]).reshape(-1, 4)
    near = elements(lattice, count=SEARCHED)[1:]
    back = act(geometry, inverse(geometry, near)[:, None], middles[None])
    shared = lattice.contains(back, ON_EDGE).any(axis=1)
    differences = np.abs(near[:, None] - lattice.over_walls[None])
    apart = differences.reshape(len(near), len(lattice.over_walls), -1).max(axis=2)
    return np.asarray(near[shared | (apart.min(axis=1) < ON_EDGE)])
