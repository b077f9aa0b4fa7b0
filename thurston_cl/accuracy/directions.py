"""The directions in which flows are measured: uniform ones, and ones next to every change of regime.

A regime is where a formula of the flow or of the geodesics degenerates, or a kernel takes another one. After
a given time it does so in the directions of a curve, or of a few points of the sphere. The regimes are those
of kernels/geometry and kernels/special; adversarial directions stand on each, and at 1e-1 to 1e-12 from it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ellipkm1

from thurston_cl.arrays import Array
from thurston_cl.models import GEOMETRIES

SEED = 20220203
DISTANCES = tuple(10.0**-k for k in range(1, 13))

# As in the kernels: |s| below which Stumpff functions are series (stumpff.h); the modulus of the closed form,
# k' e^v of planes in double and single, and the short phase in single (sol_phase.h).
STUMPFF_SERIES_BELOW = 1.0
CLOSED_BELOW = 0.6
PLANAR_BELOW = {"double": 1e-8, "single": 3e-4}
SHORT_PHASE = 1.0
# Levels of m = |ab| below this are the planes a = 0 and b = 0 themselves.
LEAST_LEVEL = 1e-300


@dataclass(frozen=True)
class Directions:
    """Unit vectors (N,3), and for each the regime that it is next to and by how much, "" and NaN where none.

    name: "uniform" or "adversarial".
    """

    name: str
    vectors: Array
    regimes: tuple[str, ...]
    offsets: Array

    def __len__(self) -> int:
        return len(self.vectors)

    def first(self, count: int) -> "Directions":
        """The first `count` of them."""
        return Directions(self.name, self.vectors[:count], self.regimes[:count], self.offsets[:count])


class Regime(NamedTuple):
    """`near(offset, count, random)` are directions (count,3) at that distance, to either side."""

    name: str
    near: Callable[[float, int, np.random.Generator], Array]


def uniform(count: int, seed: int = SEED) -> Directions:
    """`count` directions, uniform on the sphere."""
    vectors = np.random.default_rng(seed).standard_normal((count, 3))
    return Directions("uniform", _unit(vectors), ("",) * count, np.full(count, np.nan))


def adversarial(geometry: str, time: float, count: int, seed: int = SEED) -> Directions:
    """`count` directions next to the regimes of a flow by `time`, in turn, in random order.

    Every regime comes at every distance on both sides, and exactly, before any comes again. ValueError for
    an unknown geometry.
    """
    random = np.random.default_rng(seed)
    places = [
        (regime, offset)
        for regime in regimes(geometry, time)
        for offset in (0.0, *DISTANCES, *(-distance for distance in DISTANCES))
    ]
    order = np.concatenate([random.permutation(len(places)) for _ in range(-(-count // len(places)))])[:count]
    vectors = np.empty((count, 3))
    for index, (regime, offset) in enumerate(places):
        here = np.flatnonzero(order == index)
        vectors[here] = regime.near(offset, len(here), random)
    names, offsets = zip(*((places[i][0].name, places[i][1]) for i in order), strict=True)
    return Directions("adversarial", _unit(vectors), names, np.array(offsets))


def regimes(geometry: str, time: float) -> list[Regime]:
    """Where the flow by `time` > 0 changes its regime. ValueError for an unknown geometry."""
    if geometry not in GEOMETRIES:
        raise ValueError(f"unknown geometry {geometry!r}; expected one of: {', '.join(GEOMETRIES)}")
    ends = [_latitude("horizontal", 0.0), _latitude("vertical", 1.0)]
    match geometry:
        case "h2xe":
            return ends
        case "s2xe":
            # The part along the sphere is k half circles long.
            turns = [math.sqrt(1 - (k * math.pi / time) ** 2) for k in _up_to(time / math.pi)]
            return ends + [_latitude(f"half circle {k + 1}", level) for k, level in enumerate(turns)]
        case "nil":
            # c t/2 is k half turns: back on the fibre through the origin.
            turns = [2 * k * math.pi / time for k in _up_to(time / (2 * math.pi))]
            series = [2 * math.sqrt(STUMPFF_SERIES_BELOW) / time]
        case "sl2":
            # The same where s = (t/2)^2 (2 c^2 - 1) is (k pi)^2; s is 0 on the null cone.
            turns = [_sl2_level((k * math.pi) ** 2, time) for k in _up_to(time / (2 * math.pi))]
            series = [_sl2_level(side * STUMPFF_SERIES_BELOW, time) for side in (1, -1)]
            ends.append(_latitude("null cone", math.sqrt(0.5)))
        case "sol":
            return _of_sol(time)
        case _:
            # Nothing depends on the direction: components that are 0 or next to it.
            return [_latitude("coordinate plane", 0.0), _latitude("coordinate axis", 1.0)]
    levels = [(f"full turn {k + 1}", level) for k, level in enumerate(turns)]
    levels += [("edge of the series", level) for level in series]
    return ends + [_latitude(name, level) for name, level in levels if 0 < level < 1]


def _of_sol(time: float) -> list[Regime]:
    """By m = |ab|, on which the elliptic functions depend: a level of m each, but for the degenerate ones."""
    shortest = math.pi / math.sqrt(2)
    levels = [
        (f"half period {h}", _sol_level_of_half_periods(time / h)) for h in _up_to(time / shortest - 1e-9)
    ]
    square = CLOSED_BELOW**2
    levels.append(("closed form", (1 - square) / (2 * (1 + square))))
    levels += [
        (f"planar in {precision}", (threshold * math.exp(-time / 2) / 2) ** 2)
        for precision, threshold in PLANAR_BELOW.items()
    ]
    if (phase := (2 * SHORT_PHASE / time) ** 2) > 1:
        levels.append(("short phase", (phase - 1) / 2))
    half = math.sqrt(0.5)
    return [
        _circle("plane a = 0", 0),
        _circle("plane b = 0", 1),
        _latitude("vertical", 1.0),
        _latitude("horizontal", 0.0),
        _around("straight line", np.array([[x, y, 0.0] for x in (half, -half) for y in (half, -half)])),
        *(_sol_level(name, m) for name, m in levels if LEAST_LEVEL < m < 0.5),
    ]


def _sl2_level(s: float, time: float) -> float:
    """The c at which (t/2)^2 (2 c^2 - 1) = s, 0 where there is none."""
    return math.sqrt(max(0.0, (4 * s / time**2 + 1) / 2))


def _sol_level_of_half_periods(period: float) -> float:
    """The m of the geodesics of which half a period, 2K/mu, is `period` long; 0 below LEAST_LEVEL."""

    def excess(log_m: float) -> float:
        m = math.exp(log_m)
        return float(2 * ellipkm1(4 * m / (1 + 2 * m)) / math.sqrt(1 + 2 * m)) - period

    least = math.log(LEAST_LEVEL)
    return math.exp(brentq(excess, least, math.log(0.5), xtol=1e-14)) if excess(least) > 0 else 0.0


def _up_to(most: float) -> range:
    return range(1, math.floor(most) + 1)


def _unit(vectors: Array) -> Array:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def _signs(count: int, random: np.random.Generator) -> NDArray[np.float64]:
    return random.choice([-1.0, 1.0], count)


def _latitude(name: str, level: float) -> Regime:
    """About the circles u_z = +-level: offsets are angles."""

    def near(offset: float, count: int, random: np.random.Generator) -> Array:
        azimuth = random.uniform(0, 2 * math.pi, count)
        # From the equator, where sine and angle agree to the last digit, or from the pole.
        tilt = offset if level == 0 else math.acos(level) + offset
        across, along = (math.cos(tilt), math.sin(tilt)) if level == 0 else (math.sin(tilt), math.cos(tilt))
        up = _signs(count, random) * along
        return np.stack([across * np.cos(azimuth), across * np.sin(azimuth), up], axis=1)

    return Regime(name, near)


def _circle(name: str, axis: int) -> Regime:
    """About the great circle on which one component is 0: offsets are angles."""

    def near(offset: float, count: int, random: np.random.Generator) -> Array:
        azimuth = random.uniform(0, 2 * math.pi, count)
        vectors = np.full((count, 3), math.sin(offset))
        rest = [i for i in range(3) if i != axis]
        vectors[:, rest] = math.cos(offset) * np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)
        return vectors

    return Regime(name, near)


def _around(name: str, points: Array) -> Regime:
    """About single directions: offsets are angles."""

    def near(offset: float, count: int, random: np.random.Generator) -> Array:
        center = points[random.integers(len(points), size=count)]
        side = random.standard_normal((count, 3))
        side -= (side * center).sum(axis=1, keepdims=True) * center
        return math.cos(offset) * center + math.sin(offset) * _unit(side)

    return Regime(name, near)


def _sol_level(name: str, level: float) -> Regime:
    """About the curves |ab| = level: offsets are relative to it."""

    def near(offset: float, count: int, random: np.random.Generator) -> Array:
        m = min(level * (1 + offset), 0.5)
        # a/b = e^tau, as far as a^2 + b^2 = 2 m cosh tau <= 1.
        tau = random.uniform(-1, 1, count) * math.acosh(0.5 / m)
        a, b = math.sqrt(m) * np.exp(tau / 2), math.sqrt(m) * np.exp(-tau / 2)
        c = np.sqrt(np.maximum(0.0, (1 - a * a) - b * b))
        return np.stack([_signs(count, random) * part for part in (a, b, c)], axis=1)

    return Regime(name, near)
