"""Balls that hold the levels of a sequence: sets of balls, carried through mirrors and maps exactly, and
merged two by two where they become many.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# More balls than these are merged: half of them after each mirror.
MOST_BALLS = 512


class Balls:
    """A union of balls in R^3: centers (N,3) and radii (N,)."""

    def __init__(self, centers: Array, radii: Array) -> None:
        self.centers, self.radii = centers, radii

    @classmethod
    def none(cls) -> "Balls":
        return cls(np.zeros((0, 3)), np.zeros(0))

    def with_ball(self, ball: tuple[Array, float] | None) -> "Balls":
        """These and one more, if any."""
        if ball is None:
            return self
        return Balls(np.vstack([self.centers, ball[0]]), np.append(self.radii, ball[1]))

    def mirrored(self, normal: Array, offset: float) -> "Balls":
        """What is on the negative side of the plane u . x = w, and its mirror image; what is beyond is
        clipped.
        """
        side = self.centers @ normal - offset
        kept = side - self.radii <= 0
        centers, radii, side = self.centers[kept], self.radii[kept], side[kept]
        images = centers - 2 * side[:, None] * normal
        return Balls(np.vstack([centers, images]), np.append(radii, radii))._merged()

    def mapped(self, image: Callable[[Array, Array], tuple[Array, Array, Array]]) -> "Balls | None":
        """Images of the balls under a Moebius map; None where one is turned inside out."""
        if len(self.radii) == 0:
            return self
        centers, radii, signs = image(self.centers, self.radii)
        return None if (signs < 0).any() else Balls(centers, radii)

    def enclosing(self) -> tuple[Array, float]:
        """A ball (center, radius) that holds all of them; of none a point."""
        if len(self.radii) == 0:
            return np.zeros(3), 0.0
        low = np.min(self.centers - self.radii[:, None], axis=0)
        high = np.max(self.centers + self.radii[:, None], axis=0)
        center = 0.5 * (low + high)
        return center, self.reach(center)

    def enclosing_on_axis(self) -> tuple[Array, float]:
        """The same with its center on the z-axis."""
        low, high = np.min(self.centers[:, 2] - self.radii), np.max(self.centers[:, 2] + self.radii)
        center = np.array([0.0, 0.0, 0.5 * (low + high)])
        return center, self.reach(center)

    def reach(self, point: Array) -> float:
        """How far the farthest of them is from a point."""
        if len(self.radii) == 0:
            return 0.0
        return float(np.max(np.linalg.norm(self.centers - point, axis=1) + self.radii))

    def reach_about_axis(self) -> float:
        """How far the farthest of them is from the z-axis."""
        if len(self.radii) == 0:
            return 0.0
        return float(np.max(np.linalg.norm(self.centers[:, :2], axis=1) + self.radii))

    def _merged(self) -> "Balls":
        balls = self
        while len(balls.radii) > MOST_BALLS:
            balls = balls._halved()
        return balls

    def _halved(self) -> "Balls":
        """Neighbors in a walk through halves along the widest axis, in pairs."""
        order = _by_halves(self.centers, np.arange(len(self.radii)))
        first, second = order[0 : len(order) // 2 * 2 : 2], order[1::2]
        a, b = self.centers[first], self.centers[second]
        ra, rb = self.radii[first], self.radii[second]
        apart = np.linalg.norm(b - a, axis=1)
        radii = np.maximum.reduce([ra, rb, 0.5 * (apart + ra + rb)])
        # From a towards b until both are inside.
        share = np.clip((radii - ra) / np.where(apart > 0, apart, 1.0), 0.0, 1.0)
        centers = a + share[:, None] * (b - a)
        rest = order[len(second) * 2 :]
        return Balls(np.vstack([centers, self.centers[rest]]), np.append(radii, self.radii[rest]))


def _by_halves(centers: Array, index: NDArray[np.intp]) -> NDArray[np.intp]:
    if len(index) <= 2:
        return index
    axis = int(np.argmax(np.ptp(centers[index], axis=0)))
    half = len(index) // 4 * 2 or 2
    parted = index[np.argpartition(centers[index, axis], half - 1)]
    return np.concatenate([_by_halves(centers, parted[:half]), _by_halves(centers, parted[half:])])
