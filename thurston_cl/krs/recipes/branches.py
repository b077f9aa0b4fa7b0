"""Walking one route of a branching plant: what tree, shrub, forest and coral share (paper, 9.2).

A plant is given by the branches along one route, from its foot to the end of a twig. At every fork stands
a mirror, whose image of all that follows on the route is the other child. A random walk often makes a plant
that reaches through its own mirrors, where it is cut off; so of many walks the best is taken.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thurston_cl.krs.sequence import MOST_LEVELS
from thurston_cl.krs.vectors import across, unit

Vector = NDArray[np.float64]
Record = dict[str, Any]

UP = np.array([0.0, 0.0, 1.0])
# Of so many walks the best is taken; each costs about a millisecond.
WALKS = 150
# So many of the outermost branches are laid out to judge a walk: 2^10 copies show where a crown goes.
JUDGED_BRANCHES = 10
# Sagitta of a branch, in its length times the tangent of half its turn: 0.5 would leave the fork exactly
# along the branch before it, and look like a hose.
SAGITTA = 0.35


@dataclass(frozen=True)
class Mirror:
    """The plane normal . x = offset, with a unit normal; what it doubles is where normal . x <= offset."""

    normal: Vector
    offset: float

    @classmethod
    def through(cls, point: Vector, normal: Vector) -> "Mirror":
        """The mirror through a point."""
        return cls(normal, float(normal @ point))

    def image(self, points: Vector) -> Vector:
        """The mirror images of points (N, 3)."""
        heights = points @ self.normal - self.offset
        return points - 2 * heights[:, np.newaxis] * self.normal


@dataclass(frozen=True)
class Habit:
    """How a plant grows; lengths in units of the scene, angles in radians."""

    levels: int  # branches on the route, the first included
    spread: float  # half the angle of the first fork
    widen: float  # by how much that grows until the last fork
    lean: float  # about how far a mirror leans from the branch before it: this makes the children unequal
    turn: float  # of the plane of the fork about the branch, from fork to fork
    trunk: float  # length of the first branch
    second: float  # length of the second
    ratio: float  # length of every later branch, in that of the one before it
    radius: float  # of the first branch
    taper: float  # radius of a branch, in that of the one before it; the second has the root of this
    up: float  # how strongly the route bends upwards at each fork
    upright: float  # how far mirrors are turned upright, from 0 to 1, later ones less: their images keep up
    loose: float  # how random all this is, from 0 to 1


@dataclass(frozen=True)
class Route:
    """The branches of one route, the outermost first: one more than there are mirrors."""

    forks: tuple[Vector, ...]  # where branches begin and end: one more than branches
    mirrors: tuple[Mirror, ...]
    kernels: tuple[Record, ...]
    along: Vector  # direction of the last branch
    side: Vector  # a unit vector across it


def branch(start: Vector, end: Vector, before: Vector, radius: float) -> Record:
    """The toroidal capsule between two forks that sets out along the branch `before`, a unit vector."""
    length = float(np.linalg.norm(end - start))
    chord = (end - start) / length
    outside = before - (before @ chord) * chord
    # For unit vectors sin / (1 + cos) is the tangent of half the angle.
    bulge = SAGITTA * length / (1 + float(before @ chord)) * outside
    middle = 0.5 * (start + end) + bulge
    return {
        "type": "torcap",
        "p": start.tolist(),
        "q": end.tolist(),
        "m": middle.tolist(),
        "r": radius,
        "mat": 0,
    }


def walk(rng: np.random.Generator, foot: Vector, along: Vector, habit: Habit) -> Route:
    """A random route from a foot in a direction."""
    side = across(along, np.array([0.9, 0.4, 0.1]))
    before = unit(along + 0.15 * habit.loose * rng.uniform(-1, 1, 3))
    azimuth = rng.uniform(0, 2 * math.pi)
    length, radius = habit.trunk, habit.radius
    forks: list[Vector] = [foot]
    mirrors: list[Mirror] = []
    kernels: list[Record] = []
    for level in range(habit.levels):
        if level > 0:
            fork, grown = forks[-1], (level - 1) / habit.levels
            azimuth += habit.turn + habit.loose * rng.uniform(-1.4, 1.4)
            towards = math.cos(azimuth) * side + math.sin(azimuth) * np.cross(along, side)
            lean = habit.lean * rng.choice([-1, 1]) * (1 + habit.loose * rng.uniform(-1, 1))
            normal = math.cos(lean) * towards - math.sin(lean) * along
            # Not the first: a leaning mirror is what the eye finds last, since its halves are unequal.
            if level > 1:
                normal = unit(normal - habit.upright * (1 - grown) * normal[2] * UP)
            mirrors.append(Mirror.through(fork, normal))
            half = (habit.spread + habit.widen * grown) * (1 + 0.3 * habit.loose * rng.uniform(-1, 1))
            before = along
            along = math.cos(half) * across(normal, along) - math.sin(half) * normal
            # Upwards within the mirror, so that the child stays as far from its image.
            along = unit(along + habit.up * (UP - normal[2] * normal))
            side = across(along, side)
            length = habit.second if level == 1 else length * habit.ratio
            length *= 1 + 0.15 * habit.loose * rng.uniform(-1, 1)
            radius *= math.sqrt(habit.taper) if level == 1 else habit.taper
        forks.append(forks[-1] + length * along)
        kernels.append(branch(forks[-2], forks[-1], before, radius))
    return Route(tuple(forks), tuple(mirrors), tuple(kernels), along, side)


@dataclass(frozen=True)
class Copies:
    """The ends (N, 3) of all copies of the branches of a route."""

    ends: Vector
    lost: NDArray[np.bool_]  # cut off, beyond one of its mirrors
    loose: NDArray[np.bool_]  # in the air: itself not cut off, but a branch between it and the foot is


def copies(ends: Sequence[Vector], mirrors: Sequence[Mirror]) -> Copies:
    """All copies of branches, given by their ends, the outermost first: one more than there are mirrors."""
    found, lost, parent = np.array([ends[-1]]), np.zeros(1, bool), np.zeros(1, int)
    for end, mirror in zip(reversed(ends[:-1]), reversed(mirrors), strict=True):
        beyond, count = lost | (found @ mirror.normal > mirror.offset), len(found)
        found = np.concatenate([found, mirror.image(found), [end]])
        lost = np.concatenate([beyond, beyond, [False]])
        parent = np.concatenate([parent, parent + count, [2 * count]])
        parent[[count - 1, 2 * count - 1]] = 2 * count
    severed = lost
    for _ in mirrors:
        severed = severed | severed[parent]
    return Copies(found, lost, severed & ~lost)


def best_walk(draw: Callable[[], Route], walls: Sequence[Mirror] = ()) -> Route:
    """Of WALKS routes the one with the least `faults`."""
    return min((draw() for _ in range(WALKS)), key=lambda route: faults(route, walls))


def faults(route: Route, walls: Sequence[Mirror] = ()) -> float:
    """How badly a plant has grown that stands on z = 0, judged by its outer branches; 0 is best.

    Counts the parts that are cut off by mirrors, also by walls around the whole plant; that hang in the air;
    that are in the ground; and that are low. And without walls, how far its middle is from above its foot."""
    found = copies(route.forks[1 : JUDGED_BRANCHES + 1], route.mirrors[: JUDGED_BRANCHES - 1])
    lost = found.lost
    for wall in walls:
        lost = lost | (found.ends @ wall.normal > wall.offset)
    kept = found.ends[~lost] - route.forks[0] * (1, 1, 0)
    if len(kept) == 0:
        return math.inf
    reach = float(np.max(np.linalg.norm(kept, axis=1)))
    aside = 0.0 if walls else float(np.linalg.norm(kept.mean(axis=0)[:2])) / reach
    buried, low = np.mean(kept[:, 2] < 0.05 * reach), np.mean(kept[:, 2] < 0.35 * reach)
    return float(2 * np.mean(lost) + 20 * np.mean(found.loose) + 8 * buried + low) + aside


def sectors(rng: np.random.Generator, levels: int) -> Iterator[tuple[float, float]]:
    """Halving the circle again and again: azimuth of the normal of each mirror, which points away from the
    half that is kept, and azimuth of the middle of that half."""
    start, width = rng.uniform(0, 2 * math.pi), 2 * math.pi
    for _ in range(levels):
        width /= 2
        normal = start + width + math.pi / 2
        if rng.random() < 0.5:
            start, normal = start + width, normal + math.pi
        yield normal, start + width / 2


def rosette(
    rng: np.random.Generator, route: Route, levels: int, grown: Callable[[int, Vector], Record]
) -> tuple[list[Mirror], list[Record]]:
    """Mirrors and kernels, outermost first, for what grows around the last twig of a route.

    Each mirror halves the sector around the twig. It leans a little along it, away from its kernel, or
    else all copies of a kernel would be in one ring. `grown(level, outwards)` is a kernel with a center
    "c", or that begins at "a", for the middle of what is left.
    """
    binormal, end = np.cross(route.along, route.side), route.forks[-1]

    def around(azimuth: float) -> Vector:
        return math.cos(azimuth) * route.side + math.sin(azimuth) * binormal

    mirrors, kernels = [], []
    for level, (normal, middle) in enumerate(sectors(rng, levels)):
        kernel = grown(level, around(middle))
        ahead = float((np.array(kernel["c" if "c" in kernel else "a"]) - end) @ route.along)
        # What begins at the end goes on along the twig: it stays one with its image.
        lean = -np.sign(ahead) * rng.uniform(0.0, 0.3)
        mirrors.append(Mirror.through(end, unit(around(normal) + lean * route.along)))
        kernels.append(kernel)
    return mirrors, kernels


def foliage(
    rng: np.random.Generator, route: Route, levels: int, size: float
) -> tuple[list[Mirror], list[Record]]:
    """Mirrors and kernels of leaves around the last twig: lenses as long as `size`, of material 1."""
    radius, along = 0.5 * size, route.along

    def leaf(level: int, outwards: Vector) -> Record:
        reach = unit(outwards + rng.uniform(0.2, 0.9) * along)
        face = across(reach, along)
        roll = rng.uniform(0.7, 1.3) * rng.choice([-1, 1])
        normal = math.cos(roll) * face + math.sin(roll) * np.cross(reach, face)
        # One behind the other along the twig, around its end, their stalks at the twig.
        stalk = route.forks[-1] + radius * (level - 0.5 * (levels - 1)) * along
        center = stalk + 1.05 * radius * reach
        return {
            "type": "lens",
            "c": center.tolist(),
            "a": normal.tolist(),
            "b": radius,
            "h": 0.18 * radius,
            "mat": 1,
        }

    return rosette(rng, route, levels, leaf)


def record(mirrors: Sequence[Mirror], kernels: Sequence[Record], inside: Record | None = None) -> Record:
    """The record of a kernel-reflection sequence, from mirrors and kernels with the outermost first; around
    the record of another, each mirror then has its kernel.

    ValueError for more than MOST_LEVELS mirrors."""
    inner = inside or {"mirrors": [], "kernels": []}
    levels = len(inner["mirrors"]) + len(mirrors)
    if levels > MOST_LEVELS:
        raise ValueError(f"a plant of {levels} mirrors; expected at most {MOST_LEVELS}")
    outer = [{"u": mirror.normal.tolist(), "w": mirror.offset} for mirror in reversed(mirrors)]
    return {
        "mirrors": inner["mirrors"] + outer,
        "clips": True,
        "kernels": inner["kernels"] + [dict(kernel) for kernel in reversed(kernels)],
    }
