"""Kernel-reflection sequences as the kernels of `kernels/krs/` read them: mirrors, maps, kernels, and what
holds them together.
"""

import math
from collections.abc import Sequence as Series
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from thurston_cl.krs import moebius
from thurston_cl.krs.bounds import Balls
from thurston_cl.krs.kernels import KINDS, Kernel

Array = NDArray[np.float64]

# As in kernels/krs/kernels.h: numbers are kept for this many levels.
MOST_LEVELS = 40
# A ball that holds a level pays at every third (measured: docs/krs.md, "Moebius maps").
LEVELS_BETWEEN_BALLS = 3
# A pole is as good as in a ball where it is nearer to that than this share of its radius, and as good as
# before a mirror where it is nearer to that than this share of its distance from the origin: rays that come
# so near to a pole have this much room at least.
POLE_ROOM = 0.2
# Whether anything is left of a kernel is followed for so many images of it.
MOST_FOLLOWED = 256
# What reaches beyond its mirror by less than this touches it: rounding.
TOUCHES = 1e-9


@dataclass(frozen=True)
class Mirror:
    """A totally geodesic plane: the form (5,) on homogeneous coordinates, positive where is folded away; the
    vector (4,) along which it reflects; and the width within which normals are smoothed over it.
    """

    form: Array
    normal: Array
    width: float = 0.0

    @property
    def matrix(self) -> Array:
        """The reflection (5,5) on [x, y, z, w, 1]."""
        return np.eye(5) - 2 * np.outer(np.append(self.normal, 0.0), self.form)

    def numbers(self, geometry: str) -> list[float]:
        """What kernels/krs/mirror.h reads."""
        if geometry == "e3":
            return [*self.normal[:3], -float(self.form[3] + self.form[4]), self.width]
        return [*self.form, *self.normal, self.width]


class _Levels:
    """What both kinds of sequences have."""

    kernels: tuple[Kernel, ...]

    @property
    def levels(self) -> int:
        """How many mirrors there are."""
        return len(self.kernels) - 1

    @property
    def instances(self) -> int:
        """How many kernels there are when all mirrors have been gone through."""
        return sum(2 ** (self.levels - i) for i, kernel in enumerate(self.kernels) if not kernel.is_empty)

    @property
    def kinds(self) -> set[str]:
        """The files of kernels/krs that hold its kernels."""
        return {KINDS[kernel.kind][0] for kernel in self.kernels if not kernel.is_empty}

    @property
    def bounded(self) -> bool:
        """Whether each kernel is."""
        return all(kernel.is_empty or kernel.ball is not None for kernel in self.kernels)

    def _check(self, steps: int) -> None:
        if len(self.kernels) != steps + 1:
            raise ValueError(
                f"{steps} mirrors and {len(self.kernels)} kernels; expected one kernel more than mirrors"
            )
        if steps > MOST_LEVELS:
            raise ValueError(f"{steps} levels; expected at most {MOST_LEVELS}")
        if all(kernel.is_empty for kernel in self.kernels):
            raise ValueError("all kernels are empty: there is nothing to see")


@dataclass(frozen=True)
class Sequence(_Levels):
    """L_0 = K_0, L_{i+1} = K_{i+1} u L_i u R_i L_i, in one geometry (KRS paper 3). ValueError unless there
    is one kernel more than mirrors, and at most MOST_LEVELS of these.
    """

    geometry: str
    mirrors: tuple[Mirror, ...]
    kernels: tuple[Kernel, ...]
    # In e3: about the origin, what holds it, where who made it knows; mirrors may bound a half-space.
    within: float = math.inf

    # The functions of its file in kernels/krs begin with this.
    name = "sequence"

    def __post_init__(self) -> None:
        self._check(len(self.mirrors))

    @property
    def numbers(self) -> list[float]:
        """What kernels/krs/sequence.h reads."""
        numbers = [float(self.levels), *self.kernels[-1].numbers]
        for mirror, kernel in zip(reversed(self.mirrors), reversed(self.kernels[:-1]), strict=True):
            numbers += [*mirror.numbers(self.geometry), *kernel.numbers]
        return numbers

    @cached_property
    def radius(self) -> float:
        """How far it reaches from the origin at most; infinite where a kernel has no bound, and outside e3
        where there are too many instances to look at.
        """
        if not self.bounded:
            return math.inf
        if self.geometry == "e3":
            return min(self.within, self.balls.reach(np.zeros(3)))
        return self._curved_radius()

    @property
    def bounded(self) -> bool:
        """Whether something is known to hold it."""
        return super().bounded or math.isfinite(self.within)

    @cached_property
    def balls(self) -> Balls:
        """Balls of e3 that hold it, if it is bounded."""
        if not super().bounded:
            return Balls.none().with_ball((np.zeros(3), self.within))
        balls = Balls.none().with_ball(self.kernels[0].ball)
        for mirror, kernel in zip(self.mirrors, self.kernels[1:], strict=True):
            offset = -float(mirror.form[3] + mirror.form[4])
            balls = balls.mirrored(mirror.normal[:3], offset).with_ball(kernel.ball)
        return balls

    def _curved_radius(self) -> float:
        from thurston_cl.geometry import for_few_points

        if self.instances > _MOST_CURVED:
            return math.inf
        found = [
            (matrix[:4, :4] @ kernel.ball[0] + matrix[:4, 4], kernel.ball[1])
            for kernel, matrix in ((self.kernels[i], m) for i, m in self.expand())
            if kernel.ball is not None
        ]
        distances = for_few_points(self.geometry).distance(np.array([center for center, _ in found]))
        return float(np.max(distances + np.array([radius for _, radius in found])))

    def clipped(self, *, lost: bool = False) -> list[tuple[int, float]]:
        """Kernels that reach beyond their own mirror, and by how much: what is there is clipped.

        lost: only those of which the mirror takes something away. What is within a radius of a point,
        segment or arc before the mirror loses nothing: where it reaches beyond, its image is, too.
        """
        found = []
        for i, mirror in enumerate(self.mirrors):
            kernel = self.kernels[i]
            if kernel.is_empty:
                continue
            if self.geometry == "e3":
                beyond = kernel.reach(mirror.normal[:3]) + float(mirror.form[3] + mirror.form[4])
            else:
                beyond = kernel.reach(mirror.form)
            spared = _SPARED * kernel.radius if lost else 0.0
            if beyond - spared > TOUCHES and not (lost and kernel.is_kept_by(mirror.normal)):
                found.append((i, beyond))
        return found

    def vanished(self) -> list[tuple[int, int]]:
        """Kernels of e3 of which mirrors leave nothing, with the mirror that takes the last of them; of
        those with more than MOST_FOLLOWED images it is not known.
        """
        found = []
        for i, kernel in enumerate(self.kernels[:-1]):
            if kernel.ball is None or self.geometry != "e3":
                continue
            centers, radius = kernel.ball[0][None], kernel.ball[1]
            for j in range(i, self.levels):
                normal, form = self.mirrors[j].normal[:3], self.mirrors[j].form
                side = centers @ normal + float(form[3] + form[4])
                centers, side = centers[side < radius], side[side < radius]
                if len(centers) == 0:
                    found.append((i, j))
                    break
                centers = np.concatenate([centers, centers - 2 * side[:, None] * normal])
                if len(centers) > MOST_FOLLOWED:
                    break
        return found

    def expand(self) -> list[tuple[int, Array]]:
        """All instances: the number of the kernel and the isometry (5,5) on [x, y, z, w, 1] that leads from
        it to its place.
        """
        found: list[tuple[int, Array]] = []
        places = [np.eye(5)]
        for i in range(self.levels, -1, -1):
            if not self.kernels[i].is_empty:
                found += [(i, place) for place in places]
            if i > 0:
                reflection = self.mirrors[i - 1].matrix
                places += [place @ reflection for place in places]
        return found


# So much of a radius may reach beyond a mirror: what is lost then is no thicker than a thousandth of it, as
# where a scene has rounded numbers.
_SPARED = 1.001
# Outside e3 instances are looked at one by one for the radius.
_MOST_CURVED = 1 << 14


class PoleError(ValueError):
    """The map of a level, from 0, has its pole within what it maps."""

    def __init__(self, level: int) -> None:
        super().__init__("the pole of a map lies within what it maps: part of the model would be infinite")
        self.level = level


@dataclass(frozen=True)
class MoebiusSequence(_Levels):
    """L_0 = K_0, L_{i+1} = G_i(K_{i+1} u L_i u R L_i) with R: x -> -x, in e3 (KRS paper 7)."""

    maps: tuple[moebius.Map, ...]
    widths: tuple[float, ...]
    kernels: tuple[Kernel, ...]

    name = "moebius_sequence"
    geometry = "e3"

    def __post_init__(self) -> None:
        self._check(len(self.maps))
        if not self.bounded:
            raise ValueError("a plane among the kernels of a Moebius sequence; expected bounded ones")

    @property
    def numbers(self) -> list[float]:
        """What kernels/krs/moebius_sequence.h reads."""
        return self._packed(level_balls=True)

    @property
    def numbers_without_balls(self) -> list[float]:
        """The same without balls that hold levels."""
        return self._packed(level_balls=False)

    def _packed(self, *, level_balls: bool) -> list[float]:
        none = [0.0, 0.0, 0.0, -1.0]

        def held(level: int) -> list[float]:
            """The ball that holds a level, where it pays or is needed."""
            if not (level_balls and len(self._balls[level].radii)):
                return none
            if not (self._has_usual_ball(level) or self._needs_ball(level)):
                return none
            center, radius = self._balls[level].enclosing()
            return [*center, radius]

        numbers = [float(self.levels), *held(self.levels)]
        for i in range(self.levels - 1, -1, -1):
            numbers += [*self.maps[i].inverse.numbers, self.widths[i], *held(i), *self.kernels[i + 1].numbers]
        return numbers + self.kernels[0].numbers

    def _has_usual_ball(self, level: int) -> bool:
        return (self.levels - level) % LEVELS_BETWEEN_BALLS == 0

    def _needs_ball(self, level: int) -> bool:
        """Whether a ray that comes to the pole of the map inside a level would find no room there: next to it
        only a ball that holds the level, or one further out, tells that all of it is far.
        """
        if level == 0 or not self.maps[level - 1].inverse.has_pole:
            return False
        # Where the pole is seen from further out, as far as the next ball there.
        seen = np.array([self.maps[level - 1].inverse.pole])
        while True:
            if level < self.levels:
                # What is beyond the mirror is never come to.
                seen = seen[seen[:, 0] <= POLE_ROOM * np.linalg.norm(seen, axis=1)]
            if len(seen) == 0:
                return False
            if self._has_usual_ball(level):
                center, radius = self._balls[level].enclosing()
                return bool(np.any(np.linalg.norm(seen - center, axis=1) < (1 + POLE_ROOM) * radius))
            seen = self.maps[level].apply(np.concatenate([seen, seen * [-1.0, 1.0, 1.0]]))
            level += 1

    @property
    def radius(self) -> float:
        """How far it reaches from the origin at most."""
        return self.balls.reach(np.zeros(3))

    @property
    def balls(self) -> Balls:
        """Balls that hold it."""
        return self._balls[-1]

    @cached_property
    def _balls(self) -> list[Balls]:
        """What holds L_0, ..., L_n; PoleError where one of them is infinite."""
        levels = [Balls.none().with_ball(self.kernels[0].ball)]
        for i, (map_, kernel) in enumerate(zip(self.maps, self.kernels[1:], strict=True)):
            whole = levels[-1].mirrored(np.array([1.0, 0.0, 0.0]), 0.0).with_ball(kernel.ball)
            image = whole.mapped(map_.sphere_image)
            if image is None:
                raise PoleError(i)
            levels.append(image)
        return levels

    def clipped(self, *, lost: bool = False) -> list[tuple[int, float]]:
        """As of a `Sequence`; here only K_0 stands in the same space as its mirror."""
        if self.levels == 0 or self.kernels[0].is_empty:
            return []
        beyond = self.kernels[0].reach(np.array([1.0, 0.0, 0.0]))
        spared = _SPARED * self.kernels[0].radius if lost else 0.0
        return [(0, beyond)] if beyond - spared > TOUCHES else []

    def vanished(self) -> list[tuple[int, int]]:
        """As of a `Sequence`; here it is not known."""
        return []

    def expand(self) -> list[tuple[int, moebius.Map]]:
        """All instances: the number of the kernel and the map that leads from it to its place."""
        found: list[tuple[int, moebius.Map]] = []
        places: Series[moebius.Map] = [self.maps[-1]] if self.maps else [moebius.identity()]
        for i in range(self.levels, -1, -1):
            if not self.kernels[i].is_empty:
                found += [(i, place) for place in places]
            # K_i for 0 < i < n is seen through the mirrors of its own space, and through G_{i-1} of the next.
            if i > 0:
                both = [*places, *(place @ moebius.mirror() for place in places)]
                places = [place @ self.maps[i - 2] for place in both] if i > 1 else both
        return found
