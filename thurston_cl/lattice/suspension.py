"""Lattices of sol: a parallelogram, strip or plane times an interval of z, or times all of it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thurston_cl.lattice.domain import SLACK
from thurston_cl.lattice.forms import Array
from thurston_cl.lattice.isometry import inverse, snap, tidy, translation
from thurston_cl.lattice.upright import Upright

# Parallelograms that overlap by less than this part of their widths only have corners or edges in common.
TOUCH = 1e-9
# The greatest trace of the map over a level: about so many cells meet one there.
GREATEST_TRACE = 1000


@dataclass(frozen=True, eq=False)
class Suspension(Upright):
    """A lattice of sol: the suspension of a torus by a hyperbolic map, or one that covers such a manifold.

    Sides come in opposite pairs, of which there are at most two, with a^2 + b^2 = 1: a pair's maps are
    translations [x,y,0] along the other pair. The map of a level leads to the opposite one; it stretches x
    and shrinks y, or the other way round, may negate them, and keeps the group of the translations. So points
    must be led back over levels first, and then over sides, which do not move them up or down: the opposite
    of prisms (paper 11.7).
    """

    levels_first = True

    @property
    def is_dirichlet(self) -> bool:
        """Never: bisectors are curved."""
        return False

    @cached_property
    def normals(self) -> Array:
        """The normals (k,2) in x, y of the first side of each pair."""
        return self.walls[: len(self.walls) - len(self.level_walls) : 2, :2]

    @cached_property
    def basis(self) -> Array:
        """The translations (k,2) of x, y that carry the domain over the first side of each pair."""
        return self.inverses[: 2 * len(self.normals) : 2, :2, 3]

    @cached_property
    def widths(self) -> Array:
        """The distances (k,) between the sides of each pair, in x, y."""
        return -np.sum(self.walls[: 2 * len(self.normals), 3].reshape(-1, 2), axis=1)

    def _steps_back(self, walls: NDArray[np.intp], heights: Array) -> Array:
        # Behind a level a point may be beyond many sides of a pair: they are crossed at once.
        across = np.append(np.repeat(self.widths, 2), np.full(len(self.level_walls), np.inf))
        steps = self.maps[walls]
        steps[:, :2, 3] *= np.maximum(1.0, np.ceil((heights - SLACK) / across[walls]))[:, None]
        return steps

    @cached_property
    def over_walls(self) -> Array:
        """Elements (M,4,4) that carry the domain to the cells that share a piece of a wall with it: one over
        each side, and over a level all that meet the domain's parallelogram there.
        """
        if not self.finite_volume:
            return self.inverses
        over_levels = [self._over_level(self.inverses[f]) for f in self.level_walls]
        return np.concatenate([self.inverses[: 2 * len(self.basis)], *over_levels])

    def _over_level(self, step: Array) -> Array:
        """The elements (M,4,4) that translate and then go over a level by `step`, to cells whose
        parallelograms Q meet the domain's own, P, there.
        """
        corners = np.array([corner.vector[:2] for corner in self.polygon.corners])
        middle = np.mean(corners, axis=0)
        own, stretch = corners - middle, step[:2, :2]
        other = own @ stretch.T
        # They overlap unless a normal n of one of them parts them: with m from the middle of P to that of Q,
        # where |n . m| is more than half the widths of both along n. Along its normals Q moves by its widths.
        start = step[:2, 3] + stretch @ middle - middle
        normals = self.normals @ inverse("sol", step)[:2, :2]
        reach = (np.max(own @ normals.T, axis=0) + 0.5 * self.widths) * (1.0 - TOUCH)
        low, high = ((sign * reach - normals @ start) / self.widths for sign in (-1.0, 1.0))
        moves = grid(low, high) @ self.basis @ stretch.T
        reach = (np.max(other @ self.normals.T, axis=0) + 0.5 * self.widths) * (1.0 - TOUCH)
        meet = np.all(np.abs((start + moves) @ self.normals.T) < reach, axis=1)
        return moved(step, step[:2, 3] + moves[meet])

    def clearance(self, points: ArrayLike) -> Array:
        """A lower bound of the distance (...) of points (...,4) from the nearest wall; negative outside.

        Exact of levels (paper, lemma 11.2) and of sides along x or y (11.3, 11.4). A path that climbs by c
        changes n . (x, y) at the rate s e^|c| at most, s = |(n_x e^z, n_y e^-z)| at its start: so by s sinh t
        over the length t at most, as it would over the hyperbolic plane of lemma 11.3.
        """
        p = np.asarray(points, dtype=np.float64)
        heights, level = self.heights(p), 2 * len(self.normals)
        behind = np.concatenate([np.arcsinh(self._paces(p, heights)), heights[..., level:]], axis=-1)
        return -np.max(behind, axis=-1, initial=-np.inf)

    def _paces(self, p: Array, heights: Array) -> Array:
        """Heights (...,2k) over the sides, over the rates at which they change at most at p (...,4)."""
        x, y = np.moveaxis(np.abs(self.normals) * np.exp(p[..., 2, None, None] * [1.0, -1.0]), -1, 0)
        return heights[..., : 2 * len(self.normals)] / np.repeat(np.hypot(x, y), 2, axis=-1)

    def distance_from(self, point: ArrayLike) -> float:
        """A lower bound of the distance of a point (4,) from the domain; 0 inside.

        The path of `clearance` to a side that is q s behind it ends at a height of c as in the hyperbolic
        plane, where its length d has cosh d = cosh c + e^-|c| q^2/2, which is least for e^(2|c|) = 1 + q^2;
        and it must climb at least to the levels.
        """
        p = np.asarray(point, dtype=np.float64)
        heights = self.heights(p)
        q = max([0.0, *self._paces(p, heights)])
        climb = max([0.5 * np.log1p(q * q), *heights[2 * len(self.normals) :]])
        # cosh d - 1 and cosh c - 1 as 2 sinh^2 of the halves, which keep digits.
        return float(2.0 * np.arcsinh(np.sqrt(np.sinh(0.5 * climb) ** 2 + 0.25 * np.exp(-climb) * q * q)))


def grid(low: Array, high: Array) -> Array:
    """All points (M,k) with whole coordinates from low (k,) to high (k,); one without any for k = 0."""
    first, last = np.ceil(low).astype(np.intp), np.floor(high).astype(np.intp)
    return np.asarray(np.argwhere(np.ones(np.maximum(last - first + 1, 0))) + first, dtype=np.float64)


def moved(step: Array, places: Array) -> Array:
    """The elements (M,4,4) that do what `step` does, and carry o over places (M,2) in x, y instead."""
    found = np.tile(step, (len(places), 1, 1))
    found[:, :2, 3] = places
    return found


def suspension(
    name: str, translations: ArrayLike, climb: Array | None, description: str, source: str
) -> Suspension:
    """The suspension with translations (k,2) of x, y, and with `climb` (4,4) for what leads over its upper
    level; None: all z. Two translations span its parallelogram; the strip of one is straight across it.
    """
    steps = np.asarray(translations, dtype=np.float64).reshape(-1, 2)
    walls, maps = [], []
    for k, step in enumerate(steps):
        x, y = steps[1 - k] if len(steps) == 2 else (-step[1], step[0])
        normal = np.array([y, -x]) / np.hypot(x, y)
        normal *= np.sign(normal @ step)
        for sign in (1.0, -1.0):
            walls.append([*(sign * normal), 0.0, -0.5 * (normal @ step)])
            maps.append(translation("sol", np.array([*(-sign * step), 0.0, 1.0])))
    if climb is not None:
        for sign, back in ((1.0, inverse("sol", climb)), (-1.0, climb)):
            walls.append([0.0, 0.0, sign, -0.5 * climb[2, 3]])
            maps.append(back)
    tidied = np.array([tidy("sol", m) for m in maps])
    return Suspension(name, "sol", snap(np.array(walls)), tidied, description, source)
