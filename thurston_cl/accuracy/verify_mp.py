"""A handful of pixels against geodesics in many digits, worked out on the host by mpmath (`--verify-mp N`).

What `verify` takes for true, rays in double, is itself checked so: nothing of the kernels is in this but the
direction of a pixel at the eye. The geodesic is followed in the whole space for the length of the method's
ray, led back into the cell by the group of the scene, with three geodesics beside it, and the method's point
is taken apart there as by kernels/verify/carry.cl. Isometries of the group have the digits of double.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from mpmath import mp

from thurston_cl.accuracy.rays import ExactRays, Places, Rays
from thurston_cl.accuracy.truth import displacement, flow
from thurston_cl.accuracy.verify import SEED, random_places
from thurston_cl.lattice.isometry import act, on_model
from thurston_cl.scene.pixel import half_pixels

if TYPE_CHECKING:
    from thurston_cl.accuracy.rays import Array
    from thurston_cl.device import Device
    from thurston_cl.lattice import Lattice
    from thurston_cl.method import Method
    from thurston_cl.scene.picture import Area, Size
    from thurston_cl.scene.schema import Scene

DIGITS = 30
# How far beside a geodesic, as a turn of its direction and as a length, its neighbors are: first order is
# then exact to so much of itself, and differences have the other half of the digits.
ASIDE = mp.mpf(10) ** -12
# So many times the pixels that are asked for are drawn: some show no object.
DRAWN = 20
# Walls that a point is led back over, at most.
MOST_WALLS = 10000

Point = list[Any]  # 4 mpf


@dataclass(frozen=True)
class Checked:
    """What was found: the angle errors (N,) in radians and in pixels, of the `places` that hit something, and
    the seconds it took.
    """

    places: Places
    angle: Array
    pixels: Array
    seconds: float

    @property
    def words(self) -> str:
        """What was found, in a line."""
        if len(self.angle) == 0:
            return "by mpmath: none of the pixels hits anything"
        return (
            f"{len(self.angle)} pixels by mpmath, {DIGITS} digits: angle error up to "
            f"{self.pixels.max():.2g} pixels ({self.angle.max():.2g} rad), median "
            f"{np.median(self.pixels):.2g}; {self.seconds:.1f} s"
        )

    @property
    def report(self) -> dict[str, Any]:
        """All of it, for JSON."""
        return {
            "digits": DIGITS,
            "seconds": self.seconds,
            "pixels": [
                {
                    "pixel": [int(x), int(y)],
                    "eye": int(eye),
                    "angle": float(angle),
                    "angle_pixels": float(pixels),
                }
                for (x, y), eye, angle, pixels in zip(
                    self.places.pixel, self.places.eye, self.angle, self.pixels, strict=True
                )
            ],
        }


def check(
    scene: Scene,
    count: int,
    method: Method,
    device: Device,
    size: Size | None = None,
    samples: int | None = None,
    area: Area | None = None,
    seed: int = SEED,
) -> Checked:
    """Check up to `count` pixels of a picture, drawn by chance among those that show an object; the arguments
    are those of `thurston_cl.accuracy.verify.verify`.

    Raises as that does: directions at the eye are worked out in double by the device.
    """
    began = time.perf_counter()
    exact = ExactRays(scene, device, size)
    rays = Rays(scene, method, device, size)
    places = random_places(scene, DRAWN * count, size, samples, area, seed)
    ends = rays.trace(places)
    chosen = np.flatnonzero(ends.object > 0)[:count]
    places, ends = places[chosen], ends[chosen]
    eyes, directions = exact.starts(places)
    geometry, lattice = scene.geometry, scene.lattice
    angle = np.array(
        [
            angle_error(geometry, lattice, eye, direction, length, point)
            for eye, direction, length, point in zip(
                eyes, directions, ends.length, on_model(geometry, ends.point), strict=True
            )
        ]
    )
    pixels = angle / (2 * half_pixels(scene.camera, rays.size, *places.xy.T))
    return Checked(places, angle, pixels, time.perf_counter() - began)


def angle_error(
    geometry: str, lattice: Lattice | None, eye: Array, direction: Array, length: float, point: Array
) -> float:
    """By which angle the direction (3,) at an eye (4,) has to turn, to first order, for its geodesic to come
    to a `point` (4,) after about this length, or in a manifold to an image of it.
    """
    with mp.workdps(DIGITS + math.ceil(length / math.log(10))):
        u = _unit([mp.mpf(float(component)) for component in direction])
        e1 = _unit(_cross(u, [mp.mpf(k == min(range(3), key=lambda i: abs(u[i]))) for k in range(3)]))
        e2 = _cross(u, e1)
        ahead = mp.mpf(length)
        rays = [(u, ahead), (_turned(u, e1), ahead), (_turned(u, e2), ahead), (u, ahead + ASIDE)]
        base = [float(coordinate) for coordinate in eye]
        reached = [flow(geometry, v, t, base, mp.dps)[0] for v, t in rays]
        if lattice is not None:
            reached = led_back(lattice, reached)
        columns = [displacement(geometry, reached[0], other, mp.dps) for other in reached[1:]]
        matrix = mp.matrix(3, 3)
        for j, column in enumerate(columns):
            for i in range(3):
                matrix[i, j] = column[i] / ASIDE
        best = None
        for image in _images(geometry, lattice, point):
            offset = displacement(geometry, reached[0], [float(c) for c in image], mp.dps)
            distance = mp.norm(mp.matrix(offset))
            if best is None or distance < best[0]:
                best = distance, offset
        assert best is not None
        try:
            turn = mp.lu_solve(matrix, mp.matrix(best[1]))
        except ZeroDivisionError:
            # A conjugate point, or the eye itself: no turn leads anywhere else.
            return 0.0 if best[0] == 0 else math.pi
        return float(mp.hypot(turn[0], turn[1]))


def led_back(lattice: Lattice, points: Sequence[Point]) -> list[Point]:
    """Points (mpf) moved by the group element that leads the first of them into the cell; again and again the
    wall that it is farthest behind is crossed, as in `Lattice.teleport`.
    """
    moved = [list(point) for point in points]
    first = set(lattice.level_walls)
    if not lattice.levels_first:
        first = set(range(len(lattice.walls))) - first
    for _ in range(MOST_WALLS):
        heights = [mp.fdot(wall.tolist(), _homogeneous(wall, moved[0])) for wall in lattice.walls]
        early = [k for k in first if heights[k] > 0]
        behind = early or [k for k in range(len(heights)) if heights[k] > 0]
        if not behind:
            break
        back = lattice.maps[max(behind, key=lambda k: heights[k])]
        moved = [_act(lattice.geometry, back, point) for point in moved]
    return moved


def _act(geometry: str, isometry: Array, point: Point) -> Point:
    """`thurston_cl.lattice.isometry.act` on a point in many digits."""
    rows = isometry.tolist()
    q = [mp.fdot(row, _homogeneous(rows[0], point)) for row in rows[:4]]
    # What is rounded is no isometry, which far away shows in the coordinate that follows from the others.
    if geometry == "h3":
        q[3] = mp.sqrt(1 + mp.fdot(q[:3], q[:3]))
    elif geometry in ("h2xe", "sl2"):
        q[2] = mp.sqrt(1 + mp.fdot(q[:2], q[:2]))
    if geometry == "sl2":
        sense, across = rows[3][3], rows[2][1] * point[0] - rows[2][0] * point[1]
        q[3] += 2 * mp.atan2(sense * across, 1 + rows[2][2] + point[2] + q[2])
    return q


def _homogeneous(row: Sequence[float] | Array, point: Point) -> Point:
    return [*point, mp.mpf(1)] if len(row) == 5 else point


def _images(geometry: str, lattice: Lattice | None, point: Array) -> list[Array]:
    """A point (4,) and its images beyond the walls."""
    if lattice is None:
        return [point]
    return [point, *act(geometry, lattice.over_walls, point)]


def _unit(v: list[Any]) -> list[Any]:
    length = mp.sqrt(mp.fdot(v, v))
    return [component / length for component in v]


def _cross(a: list[Any], b: list[Any]) -> list[Any]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _turned(u: list[Any], e: list[Any]) -> list[Any]:
    return _unit([a + ASIDE * b for a, b in zip(u, e, strict=True)])
