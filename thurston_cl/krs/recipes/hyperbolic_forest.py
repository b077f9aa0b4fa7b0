"""A forest in hyperbolic space: one tree in a right-angled pentagon, and mirrors on its sides.

GROUND PLAN. The ground is a totally geodesic plane, and on it lies a pentagon with five right angles, which
fit together in the hyperbolic plane alone. A polygon with right angles and its image across one of its sides
make another one: beside the mirror two right angles become a straight line. So each doubling reflects in a
side of the polygon so far, the one nearest to the first tree, and all trees lie exactly on one side of each
mirror: 2^doublings cells, none of them cut.

TREE. From the twigs down to the trunk (as tree.py does, by exponential maps): what has grown is leant away
from a mirror through the next fork, by at least as much as brings all of its axes to one side. What is within
a radius of axes on one side of a mirror is not clipped by it: where it reaches beyond, the image is, too.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .guard import guarded

Array = NDArray[np.float64]
Record = dict[str, Any]

# Coordinates are those of records: [t, x, y, z], <p, p> = -t^2 + x^2 + y^2 + z^2.
METRIC = np.diag([-1.0, 1.0, 1.0, 1.0])
ORIGIN = np.array([1.0, 0.0, 0.0, 0.0])
# The side of the regular right-angled pentagon: cosh is the golden ratio.
REGULAR_SIDE = math.acosh(0.5 * (1 + math.sqrt(5)))
# By how much of it two neighboring sides may differ from it: both shorter by a sixth do not go together.
MOST_IRREGULAR = 0.14
# Walls end so far from the foot of the first tree on them: beyond, a wall is finer than a pixel.
LONGEST_WALL = 5.0
# Sides that are known beyond those that are doubled, for walls to end at.
NEIGHBORS = 50
# Products of normals: 0 where sides meet, and beyond 1 where they do not.
MEETS = 1e-6
# By this factor a tree is smaller if it does not fit.
SMALLER = 0.96
BARK, LEAF, GROUND, WALL = range(4)


@guarded()
def hyperbolic_forest(
    *,
    doublings: int = 22,
    height: float = 0.9,
    forks: int = 8,
    foliage: int = 5,
    spread: float = math.radians(27),
    ratio: float = 0.8,
    thickness: float = 0.075,
    taper: float = 0.74,
    leaf_size: float = 0.019,
    wall: float = 0.018,
    irregular: float = 0.8,
    seed: int = 0,
) -> Record:
    """The record of a forest on the ground z = 0, its first tree at the origin.

    doublings  mirrors on the ground; there are 2^doublings trees
    height     of a tree along its branches, trunk included; one that does not fit its cell is smaller
    forks      of a route from the trunk to a twig: a tree has 2^forks twigs
    foliage    doublings of the leaves at the end of a twig, which has 2^(foliage + 1) - 2; 0 leaves it bare
    spread     how far branches lean from the one before, at least, radians
    ratio      length of a branch in that of the one before it
    thickness  diameter of the trunk
    taper      thickness of a branch in that of the one before it
    leaf_size  diameter of a leaf
    wall       diameter of the walls between cells, half above the ground; 0 leaves them out
    irregular  from 0, the regular pentagon, up to 1
    seed       of the random numbers

    "mat" is 0 for bark, 1 for leaves, 2 for the ground, 3 for walls. The record has foliage + forks +
    doublings mirrors.
    """
    rng = np.random.default_rng(seed)
    first, second = REGULAR_SIDE * (1 + MOST_IRREGULAR * irregular * rng.uniform(-1, 1, 2))
    sides = pentagon(float(first), float(second))
    shape = Habit(forks, foliage, spread, ratio, 0.5 * thickness, taper, 0.5 * leaf_size)
    tree = _fitting(shape, height, sides, int(rng.integers(2**32)))
    mirrors, kernels = list(tree.mirrors), list(tree.kernels)
    for side, ends in doubled(sides, doublings):
        mirrors.append(side)
        kernels.append(_capsule(*ends, 0.5 * wall, WALL) if wall > 0 else {"type": "empty"})
    if doublings:
        kernels.pop()
        kernels.append({"type": "plane", "n": [0.0, 0.0, 0.0, 1.0], "mat": GROUND})
    return {
        "space": "H3",
        "clips": True,
        "mirrors": [mirror.tolist() for mirror in mirrors],
        "kernels": kernels,
    }


# The ground


def pentagon(a: float, b: float) -> list[Array]:
    """Outer unit normals (4,) of the sides of a pentagon with right angles, by the lengths of two
    neighboring sides, which decide the others. They stand upright on the ground, and the origin is as far
    inside as it can be. ValueError where there is none.
    """
    square = math.tanh(a) ** 2 + math.tanh(b) ** 2 - 1
    if not square > 0:
        raise ValueError(f"no right-angled pentagon has neighboring sides of {a:.4g} and {b:.4g}")
    far = np.array([1.0, math.tanh(a), math.tanh(b), 0.0]) / math.sqrt(square)
    sides = np.array(
        [
            [0.0, 0.0, -1.0, 0.0],
            [math.sinh(a), math.cosh(a), 0.0, 0.0],
            far,
            [math.sinh(b), 0.0, math.cosh(b), 0.0],
            [0.0, -1.0, 0.0, 0.0],
        ]
    )
    # Whatever stands in the middle: coarse is good enough.
    radius, angle = np.meshgrid(np.linspace(0.02, 1.5, 75), np.linspace(0, 0.5 * math.pi, 91))
    points = np.array([np.cosh(radius), np.sinh(radius) * np.cos(angle), np.sinh(radius) * np.sin(angle)])
    points = np.concatenate([points.reshape(3, -1), np.zeros((1, radius.size))])
    middle = points[:, np.argmin((sides @ METRIC @ points).max(axis=0))]
    return list(sides @ _to_origin(middle).T)


def doubled(sides: list[Array], doublings: int) -> Iterator[tuple[Array, tuple[Array, Array]]]:
    """The mirrors, one after the other: the side of the polygon so far that is nearest to the origin, and
    the ends of it that are in sight; the polygon is then its union with its image.
    """
    for left in range(doublings, 0, -1):
        # t grows with the distance of a side: <n, o> = -t.
        sides = sorted(sides, key=lambda n: float(n[0]))
        mirror = sides.pop(0)
        products = [float(n @ METRIC @ mirror) for n in sides]
        yield (
            mirror,
            _ends(mirror, [n for n, product in zip(sides, products, strict=True) if abs(product) < MEETS]),
        )
        images = [n - 2 * p * mirror for n, p in zip(sides, products, strict=True) if abs(p) >= MEETS]
        # An image is no nearer than what it is the image of, and each doubling takes one side away: what is
        # farther than as many others as are still to come has no turn any more, and at most ends a wall.
        sides = sorted(sides + images, key=lambda n: float(n[0]))[: left + NEIGHBORS]


def _ends(side: Array, neighbors: list[Array]) -> tuple[Array, Array]:
    """Where a side ends: at its neighbors, or LONGEST_WALL from the foot of the origin on it."""
    foot = ORIGIN + side[0] * side
    foot = foot / math.sqrt(-float(foot @ METRIC @ foot))
    along = np.cross(np.array([0.0, 0.0, 1.0]), side[1:])
    # Level, and at right angles to the side and the foot.
    level = np.array([0.0, *along])
    level = level + float(level @ METRIC @ foot) * foot
    level = level / math.sqrt(float(level @ METRIC @ level))
    reach = [-LONGEST_WALL, LONGEST_WALL]
    for n in neighbors:
        inwards, outwards = float(n @ METRIC @ foot), float(n @ METRIC @ level)
        to = math.atanh(-inwards / outwards)
        reach[int(outwards > 0)] = max(-LONGEST_WALL, min(LONGEST_WALL, to))
    low, high = (math.cosh(s) * foot + math.sinh(s) * level for s in reach)
    return low, high


# The tree


@dataclass(frozen=True)
class Habit:
    """How a tree grows; see `hyperbolic_forest`. Thickness and leaves by radii."""

    forks: int
    foliage: int
    spread: float
    ratio: float
    radius: float
    taper: float
    leaf: float


@dataclass
class Grown:
    """What has grown so far, its foot at the origin and z upwards: mirrors and kernels from the twigs down,
    and all centers and ends of axes (4,N).
    """

    kernels: list[Record]
    points: Array
    mirrors: list[Array] = field(default_factory=list)

    def moved(self, place: Array) -> "Grown":
        """The same elsewhere, by an isometry (4,4)."""
        kernels = [
            {key: (place @ value).tolist() if key in "abc" else value for key, value in kernel.items()}
            for kernel in self.kernels
        ]
        return Grown(kernels, place @ self.points, [place @ mirror for mirror in self.mirrors])

    def forked(self, stem: float, kernel: Record, spread: float, rng: np.random.Generator) -> "Grown":
        """Two of it on a stem with this kernel, one the image of the other."""
        lean = spread * rng.uniform(0.05, 0.4)
        turns = rng.uniform(0, 2 * math.pi, 12)
        widest = [_widest(_turn(2, turn) @ self.points) for turn in turns]
        best = int(np.argmin(widest))
        tilt = max(spread * rng.uniform(0.9, 1.2), widest[best] + lean)
        upper = self.moved(_rise(stem) @ _turn(1, -tilt) @ _turn(2, turns[best]))
        mirror = _rise(stem) @ np.array([0.0, math.cos(lean), 0.0, math.sin(lean)])
        images = upper.points - 2 * np.outer(mirror, mirror @ METRIC @ upper.points)
        points = np.concatenate(
            [upper.points, images, ORIGIN[:, None], _rise(stem) @ ORIGIN[:, None]], axis=1
        )
        return Grown([*upper.kernels, kernel], points, [*upper.mirrors, mirror])


def _fitting(habit: Habit, height: float, sides: list[Array], seed: int) -> Grown:
    """A tree of this size, or of the largest that goes into the cell, turned so that it fits best."""
    normals, turns = np.array(sides) @ METRIC, [_turn(2, angle) for angle in np.linspace(0, 2 * math.pi, 72)]
    while True:
        tree = _tree(habit, height, np.random.default_rng(seed))
        beyond = [float((normals @ turn @ tree.points).max()) for turn in turns]
        best = int(np.argmin(beyond))
        if beyond[best] <= 0:
            return tree.moved(turns[best])
        height *= SMALLER
        habit = replace(habit, radius=SMALLER * habit.radius, leaf=SMALLER * habit.leaf)


def _tree(habit: Habit, height: float, rng: np.random.Generator) -> Grown:
    lengths = float(habit.ratio) ** np.arange(habit.forks + 1)
    # The trunk is longer than its share.
    lengths[0] *= 1.5
    lengths *= height / lengths.sum()
    thickness = habit.radius * habit.taper ** np.arange(habit.forks + 1)

    def leaf() -> Record:
        return {"type": "sphere", "c": ORIGIN, "r": habit.leaf, "mat": LEAF}

    grown = Grown([leaf()], ORIGIN[:, None])
    for _ in range(habit.foliage - 1):
        grown = grown.forked(1.1 * habit.leaf, leaf(), math.radians(50), rng)
    for i in range(habit.forks, -1, -1):
        # A trunk begins below the ground, where its round end is not seen.
        foot = ORIGIN if i else _rise(-habit.radius) @ ORIGIN
        stem = float(lengths[i])
        kernel = _capsule(foot, _rise(stem) @ ORIGIN, float(thickness[i]), BARK)
        if i == habit.forks and habit.foliage == 0:
            grown = Grown([kernel], np.stack([ORIGIN, _rise(stem) @ ORIGIN], axis=1))
        else:
            grown = grown.forked(stem, kernel, habit.spread, rng)
    return grown


def _widest(points: Array) -> float:
    """The largest angle from z towards x at which a point is seen from the origin."""
    away = np.abs(points[1]) + np.abs(points[3]) > 0
    return float(np.max(np.arctan2(points[1, away], points[3, away]), initial=0.0))


def _capsule(a: Array, b: Array, radius: float, material: int) -> Record:
    return {"type": "capsule", "a": a.tolist(), "b": b.tolist(), "r": radius, "mat": material}


def _rise(length: float) -> Array:
    """The transvection (4,4) along the z-axis."""
    matrix = np.eye(4)
    matrix[np.ix_([0, 3], [0, 3])] = [
        [math.cosh(length), math.sinh(length)],
        [math.sinh(length), math.cosh(length)],
    ]
    return matrix


def _turn(axis: int, angle: float) -> Array:
    """The right-handed turn (4,4) about the y- (1) or z-axis (2)."""
    first, second = ((3, 1), (1, 2))[axis - 1]
    matrix = np.eye(4)
    matrix[np.ix_([first, second], [first, second])] = [
        [math.cos(angle), -math.sin(angle)],
        [math.sin(angle), math.cos(angle)],
    ]
    return matrix


def _to_origin(point: Array) -> Array:
    """The transvection (4,4) that carries a point to the origin."""
    x = point[1:]
    matrix = np.eye(4)
    matrix[0, 0] = point[0]
    matrix[0, 1:] = matrix[1:, 0] = -x
    matrix[1:, 1:] += np.outer(x, x) / (1 + point[0])
    return matrix
