"""A row for each named constant of the kernels at which a formula changes: how inputs are driven across it,
what is asked of them, and the accuracy that the head of the file states.

What a constant is compared with is called its variable here. `drive` makes inputs of values of that variable,
which approach the constant from both sides.
"""

import functools
import re
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy.optimize
import sol
import test_sol_flow
import test_sol_light
import test_twisted
from golden import EPSILON, MP, Array, cut, rounded
from test_sol_flow import with_complement

from thurston_cl.geometry import Geometry
from thurston_cl.models import ORIGIN
from thurston_cl.program import kernel_text


class Rays(NamedTuple):
    """Directions (N,3) and lengths (N,), rounded to the precision, from `base` (N,4) or the origin."""

    u: Array
    t: Array
    base: Array | None = None


class Pairs(NamedTuple):
    """Points (N,4), and the points (N,4) that they are seen from."""

    point: Array
    base: Array


Inputs = Rays | Pairs


class Sweep(NamedTuple):
    """`asked`: what test_seams.py compares with the truth. `stated`: the largest error in single and in
    double, by the head of the file `head`, where `said` stands."""

    part: str
    constant: str
    geometry: str
    asked: str
    drive: Callable[[Array, str], Inputs]
    stated: tuple[float, float]
    said: tuple[str, ...]
    head: str
    precisions: tuple[str, ...] = ("single", "double")

    def __str__(self) -> str:
        return f"{self.constant} {self.geometry} {self.asked} {self.drive.__name__}"


def sides(precision: str) -> Array:
    """From a tenth away on either side down to the neighbouring numbers of the precision, in order."""
    far = 10.0 ** -(
        np.array([1, 2, 3, 4, 5, 6]) if precision == "single" else np.array([1, 2, 3, 5, 7, 9, 11, 13])
    )
    near = np.array([1, 2, 4, 8]) * EPSILON[precision]
    return np.sort(np.concatenate([-far, -near, [0], near, far]))


def along(direction: Sequence[float], sizes: Array) -> Array:
    return np.outer(sizes, np.asarray(direction, dtype=np.float64))


def rays(rows: Sequence[Sequence[float]] | Array, t: Any, precision: str, base: Array | None = None) -> Rays:
    """Directions along the rows, made unit vectors and rounded, and rounded lengths."""
    u = np.asarray(rows, dtype=np.float64)
    u = cut(u / np.linalg.norm(u, axis=1, keepdims=True), precision)
    return Rays(u, cut(np.broadcast_to(t, len(u)), precision), base)


def joined(parts: Sequence[Inputs]) -> Inputs:
    kind = type(parts[0])
    columns = zip(*parts, strict=True)
    return kind(*(None if column[0] is None else np.concatenate(column) for column in columns))


def lifted(geometry: str, x: Array, y: Array, third: Array | float) -> Array:
    """Points (N,4) from three free coordinates: of s3 with w > 0."""
    x, y, c = (np.asarray(a, dtype=np.float64) for a in np.broadcast_arrays(x, y, third))
    square = x * x + y * y
    match geometry:
        case "s3":
            return np.stack([x, y, c, np.sqrt(1 - square - c * c)], axis=1)
        case "h3":
            return np.stack([x, y, c, np.sqrt(1 + square + c * c)], axis=1)
        case "s2xe":
            return np.stack([x, y, np.sqrt(1 - square), c], axis=1)
        case "h2xe" | "sl2":
            return np.stack([x, y, np.sqrt(1 + square), c], axis=1)
        case _:
            return np.stack([x, y, c, np.ones_like(x)], axis=1)


def from_origin(geometry: str, point: Array) -> Pairs:
    return Pairs(point, np.broadcast_to(ORIGIN[geometry], point.shape))


# -- constant curvature and products -------------------------------------------------------------------------


def over_the_equator(v: Array, precision: str) -> Pairs:
    """Both points at w = v/2, as far apart as 0.3 about the w axis."""
    w = v / 2
    r = np.sqrt((1 - w) * (1 + w))
    p, q = (np.stack([r * np.cos(a), r * np.sin(a), 0 * r, w], axis=1) for a in (0.2, 0.5))
    return Pairs(q, p)


def opposite(geometry: str) -> Callable[[Array, str], Pairs]:
    def opposite_points(v: Array, precision: str) -> Pairs:
        """On both sides of the origin, as far apart as cosh d = v."""
        x = np.sqrt((v - 1) / 2)
        apart = 0.0 if geometry == "h3" else 0.75
        return Pairs(lifted(geometry, 0.6 * x, 0.8 * x, apart), lifted(geometry, -0.6 * x, -0.8 * x, apart))

    return opposite_points


def split(geometry: str) -> Callable[[Array, str], Pairs]:
    def beside_split(v: Array, precision: str) -> Pairs:
        """From |x|^2 = v to points beside, ahead and back."""
        r = np.sqrt(v)
        base = lifted(geometry, 0.6 * r, -0.8 * r, 0.0)
        ends = ((0.3, -0.2, 0.4), (1.1, -0.9, -0.3), (0.55, -0.7, 0.01))
        return joined([Pairs(lifted(geometry, *(np.full(len(v), c) for c in end)), base) for end in ends])

    return beside_split


def near_antipode(v: Array, precision: str) -> Rays:
    """From bases at v from the antipode of the origin of S2."""
    base = np.stack([0.6 * v, -0.8 * v, np.full(len(v), -1.0), np.full(len(v), 0.25)], axis=1)
    ways = ([0.6, 0.0, 0.8], [-0.36, 0.48, 0.8], [0.0, 1.0, 0.0])
    return joined([rays([u] * len(v), t, precision, base) for u in ways for t in (0.7, 2.5)])


def apart(geometry: str) -> Callable[[Array, str], Pairs]:
    def points_apart(v: Array, precision: str) -> Pairs:
        """At the distance v from the origin, whose square may have no number."""
        return from_origin(
            geometry,
            lifted(geometry, v, 0 * v, 0.0) if geometry == "s3" else lifted(geometry, 0.6 * v, 0.0, 0.8 * v),
        )

    return points_apart


def for_the_time(v: Array, precision: str) -> Rays:
    return rays([[0.48, -0.64, 0.6]] * len(v), v, precision)


# -- nil and sl2 ---------------------------------------------------------------------------------------------


def on_the_axis(geometry: str) -> Callable[[Array, str], Pairs]:
    def next_to_the_fibre(v: Array, precision: str) -> Pairs:
        """At v times the height from the fibre, below the first circle and above it."""
        parts = []
        for height in (3.0, 10.0, -10.0):
            x = v * abs(height)
            parts.append(from_origin(geometry, lifted(geometry, x, 0 * x, height)))
        return joined(parts)

    return next_to_the_fibre


def turning(geometry: str) -> Callable[[Array, str], Pairs]:
    def quarter_turn(v: Array, precision: str) -> Pairs:
        """Points to which geodesics turn by 2 v in nil; the same of sl2, where ways part by the height."""
        parts = []
        for rho in (0.1, 1.0, 3.0):
            half = np.cosh(rho / 2)
            height = 2 * v * (1 + rho**2 / 8) if geometry == "nil" else 4 * v * half - 2 * v
            parts.append(from_origin(geometry, test_twisted.over_fibre(geometry, rho, height)))
        return joined(parts)

    return quarter_turn


def on_the_fibre(v: Array, precision: str) -> Pairs:
    return from_origin("nil", lifted("nil", 0 * v, 0 * v, cut(v, precision)))


def far_up(v: Array, precision: str) -> Pairs:
    """w/2 = rho + v."""
    return joined(
        [from_origin("sl2", test_twisted.over_fibre("sl2", rho, 2 * (rho + v))) for rho in (0.5, 2.0, 6.0)]
    )


def series_of_nil(v: Array, precision: str) -> Rays:
    """T^2 = v."""
    return joined(
        [
            rays([test_twisted.direction(up)] * len(v), 2 * np.sqrt(v) / abs(up), precision)
            for up in (0.8, -0.3)
        ]
    )


def series_of_sl2(v: Array, precision: str) -> Rays:
    """s = v and s = -v, of elliptic and hyperbolic geodesics."""
    parts = []
    for sign in (1, -1):
        up = np.sqrt((1 + sign * 0.36) / 2)
        parts.append(rays([test_twisted.direction(up)] * len(v), 2 * np.sqrt(v) / 0.6, precision))
    return joined(parts)


# -- sol -----------------------------------------------------------------------------------------------------


def moduli(v: Array, precision: str) -> Rays:
    """k = v, in short and long phases."""
    rows = [with_complement(float(np.sqrt((1 - k) * (1 + k))), 0.1) for k in v]
    return joined([rays(rows, t, precision) for t in (1.5, 2.5, 9.0)])


def phases(v: Array, precision: str) -> Rays:
    """mu t/2 = v."""
    rows = ((0.6, 0.64, 0.48), (1e-3, 0.6, -0.8), (0.0, 0.6, 0.8))
    return joined(
        [
            rays([row] * len(v), 2 * v / test_sol_flow.speed(sol.unit(row).astype(float)), precision)
            for row in rows
        ]
    )


def long_phases(v: Array, precision: str) -> Rays:
    """The same, of a geodesic that is far from planes: those overflow before."""
    row = (0.3, 0.2, 0.9)
    return rays([row] * len(v), 2 * v / test_sol_flow.speed(sol.unit(row).astype(float)), precision)


def planar(v: Array, precision: str) -> Rays:
    """k' e^(t mu/2) = v, next to both planes."""
    parts = []
    for t in (2.5, 8.0, 25.0):
        for flip in (False, True):
            rows = []
            for complement in v * np.exp(-t / 2):
                a, _, c = with_complement(complement, 0.6)
                row = (a, complement**2 / 4 / a, c)
                rows.append((row[1], row[0], -c) if flip else row)
            parts.append(rays(rows, t, precision))
    return joined(parts)


def ends_of(given: Rays) -> Pairs:
    """Where rays of Sol lead, as points of binary64."""
    ends = [np.append(rounded(sol.flow(u, t).point), 1.0) for u, t in zip(given.u, given.t, strict=True)]
    return from_origin("sol", np.array(ends))


def planar_points(v: Array, precision: str) -> Pairs:
    """8 a b cosh d = v^2: points of which only the square is compared."""
    parts = []
    for length in (0.5, 3.0, 8.0):
        rows = [(0.6, (x / 0.6) * x / (8 * np.cosh(length)), 0.8) for x in v]
        parts.append(
            ends_of(Rays(np.array(rows) / np.linalg.norm(rows, axis=1)[:, None], np.full(len(v), length)))
        )
    return joined(parts)


def moved_to(f: Callable[[float], Any], low: float, high: float, v: Array) -> Array:
    """Arguments at which the smooth function `f`, with one root there, is about `v`: to first order about
    the middle of v, where it is so to the last digit."""
    middle = float(v[len(v) // 2])
    root = scipy.optimize.brentq(lambda t: float(f(t)) - middle, low, high, xtol=1e-15)
    slope = float(f(root + 1e-6) - f(root - 1e-6)) / 2e-6
    return root + (v - middle) / slope


def half_heights(v: Array, precision: str) -> Rays:
    """tanh(z/2) = v, going up and down."""
    parts = []
    for row, high in (((0.3, 0.2, 0.9), 1.5), ((1e-3, 0.0, 1.0), 1.5)):
        u = rays([row], 0, precision).u[0]
        t = moved_to(lambda t, u=u: MP.tanh(sol.flow(u, t).point[2] / 2), 0.5, high, v)
        parts += [
            rays([row] * len(v), t, precision),
            rays([(row[1], row[0], -row[2])] * len(v), t, precision),
        ]
    return joined(parts)


def beta_sn(v: Array, precision: str) -> Rays:
    """beta sn = v and -v at the half phase."""
    parts = []
    for row in ((0.4, 0.3, 0.8), (0.1, 0.5, 0.9)):
        a, b, c = (float(x) for x in sol.unit(row))
        mu = np.sqrt(1 + 2 * a * b)
        square = MP.mpf((a - b) ** 2 + c * c) / MP.mpf(mu) ** 2
        half = moved_to(lambda w, m=square, f=c / mu: f * MP.ellipfun("sn", w, m=m), 0.1, 1.2, v)
        parts += [rays([(a, b, sign * c)] * len(v), 2 * half / mu, precision) for sign in (1, -1)]
    return joined(parts)


def steps_of(count: int) -> Callable[[Array, str], Rays]:
    def whole_steps(v: Array, precision: str) -> Rays:
        """A length of as many steps, where one more begins."""
        return joined(
            [rays([row] * len(v), count * v, precision) for row in ((0.6, 0.64, 0.48), (-0.5, 0.3, 0.8))]
        )

    return whole_steps


def steps_up(v: Array, precision: str) -> Rays:
    """Ten and a hundred steps of the integration of Jacobi's equation, up and in a plane."""
    rows = ((0.0, 0.0, 1.0), (0.6, 0.0, 0.8))
    return joined([rays([row] * len(v), count * v, precision) for row in rows for count in (10, 30)])


def areas(straight: bool) -> Callable[[Array, str], Rays]:
    def area_forms(v: Array, precision: str) -> Rays:
        """m (1 - 4 m^2) = v next to planes or to straight lines."""
        rows = [test_sol_light.with_product(x, straight) for x in v]
        return joined([rays(rows, t, precision) for t in (1.0, 4.0)])

    area_forms.__name__ = "next_to_straight_lines" if straight else "next_to_planes"
    return area_forms


def ends_where(
    f: Callable[[Any, Any, Any, Any], Any], rows: Sequence[tuple[Sequence[float], float, float]], v: Array
) -> Pairs:
    """Ends of geodesics along rows, with lengths in a bracket, at which f(r, x, y, z) = v, where r = b/a."""
    parts = []
    for row, low, high in rows:
        u = sol.unit(row)
        t = moved_to(lambda t, u=u: f(u[1] / u[0], *sol.flow(u, t).point), low, high, v)
        parts.append(ends_of(Rays(np.broadcast_to(u.astype(float), (len(v), 3)), t)))
    return joined(parts)


def wide(v: Array, precision: str) -> Pairs:
    """D = x - r y = v x."""
    return ends_where(lambda r, x, y, z: 1 - r * y / x, WIDE_ROWS, v)


def apart_at_the_end(v: Array, precision: str) -> Pairs:
    """r e^-z = v."""
    return ends_where(lambda r, x, y, z: r * MP.exp(-z), APART_ROWS, v)


# With X >= Y and z >= 0 at their ends.
WIDE_ROWS = (((0.8, 0.6, 0.3), 0.1, 0.5), ((0.6, 0.5, 0.5), 0.1, 0.5), ((0.5, 0.45, 0.9), 0.1, 0.5))
APART_ROWS = (((0.5, 0.45, 0.9), 0.5, 1.2), ((0.4, 0.35, 0.9), 0.5, 1.2), ((0.3, 0.3, 0.9), 2.7, 3.2))


def next_to_the_axis(v: Array, precision: str) -> Pairs:
    """X = x e^(-z/2) = v, with y as large and less."""
    return joined(
        [
            from_origin(
                "sol", np.stack([v * np.exp(z / 2), part * v * np.exp(-z / 2), 0 * v + z, 1 + 0 * v], axis=1)
            )
            for z in (0.7, 2.5)
            for part in (0.9, 1e-3)
        ]
    )


# -- the table -----------------------------------------------------------------------------------------------

SOL_FLOW = "geometry/sol_flow.h"
_POINTS_OF_SOL = (6.1e-7, 1.1e-15), ("6.1e-7    1.1e-15",), SOL_FLOW
_LENGTHS_OF_SOL = (6.7e-7, 1.8e-15), ("6.7e-7    1.8e-15",), "geometry/sol_geodesics.h"
_NIL, _SL2 = "geometry/nil.h", "geometry/sl2.h"
_LENGTHS = {
    "nil": ((2.0e-7, 4.5e-16), ("2.0e-7    4.5e-16",), _NIL),
    "sl2": ((2.8e-7, 6.7e-16), ("2.8e-7    6.7e-16",), _SL2),
}
_DIRECTIONS = {
    "nil": ((3.3e-7, 4.8e-16), ("3.3e-7    4.8e-16",), _NIL),
    "sl2": ((2.2e-7, 4.5e-16), ("2.2e-7    4.5e-16",), _SL2),
}
_PHASE, _GEODESICS = "geometry/sol_phase.h", "geometry/sol_geodesics.h"

SWEEPS = [
    Sweep("geometry/s3.h", "CHORD_W_FROM_SUM", "s3", "length", over_the_equator, (2.5e-7, 4e-16),
          ("2.5e-7   double 4e-16",), "geometry/s3.h"),
    Sweep("geometry/h3.h", "OPPOSITE_ABOVE", "h3", "length", opposite("h3"), (2.1e-7, 4.3e-16),
          ("2.1e-7   double 4.3e-16",), "geometry/h3.h"),
    Sweep("geometry/h3.h", "OPPOSITE_ABOVE", "h2xe", "length", opposite("h2xe"), (1.7e-7, 4.0e-16),
          ("1.7e-7    4.0e-16",), "geometry/h2xe.h"),
    # 7 EPSILON w at w = sqrt 2.
    Sweep("geometry/h3.h", "SPLIT_DIRECTION_ABOVE", "h3", "direction", split("h3"), (1.2e-6, 5e-15),
          ("7 EPSILON w", "5e-15"), "geometry/h3.h"),
    Sweep("geometry/h3.h", "SPLIT_DIRECTION_ABOVE", "h2xe", "direction", split("h2xe"), (3.5e-7, 1.1e-15),
          ("3.5e-7    1.1e-15",), "geometry/h2xe.h"),
    Sweep("geometry/s2xe.h", "ANTIPODE_OFFSET", "s2xe", "point", near_antipode, (8.2e-7, 1.1e-15),
          ("8.2e-7    1.1e-15",), "geometry/s2xe.h"),
    Sweep("special/elementary.h", "SINH_SERIES_BELOW", "h3", "point", for_the_time, (1.4e-7, 3e-15),
          ("1.4e-7, 3e-15",), "geometry/h3.h"),
    *(
        Sweep("special/elementary.h", name, g, "length", apart(g), figures, (said,), f"geometry/{g}.h")
        for name, g, figures, said in (
            ("SQUARES_VANISH_BELOW", "e3", (2.5e-7, 2.2e-16), "2.5e-7   double 2.2e-16"),
            ("SQUARES_OVERFLOW_ABOVE", "e3", (2.5e-7, 2.2e-16), "2.5e-7   double 2.2e-16"),
            ("SQUARES_VANISH_BELOW", "s3", (2.5e-7, 4e-16), "2.5e-7   double 4e-16"),
        )
    ),
    *(
        Sweep("geometry/twisted.h", "AXIS_RATIO", g, "length on the fibre", on_the_axis(g), *_LENGTHS[g])
        for g in ("nil", "sl2")
    ),
    *(
        Sweep("geometry/twisted.h", "QUARTER_TURN", g, asked, turning(g), *stated[g])
        for asked, stated in (("length", _LENGTHS), ("direction", _DIRECTIONS))
        for g in ("nil", "sl2")
    ),
    Sweep(_NIL, "STRAIGHT_BELOW", "nil", "underestimate", on_the_fibre, (4.8e-7, 8.9e-16), (), _NIL),
    Sweep(_NIL, "PARABOLIC_FROM", "nil", "underestimate", on_the_fibre, (4.8e-7, 8.9e-16), (), _NIL),
    Sweep(_SL2, "COMPLEMENT_ABOVE", "sl2", "length", far_up, *_LENGTHS["sl2"]),
    Sweep(_SL2, "COMPLEMENT_ABOVE", "sl2", "direction", far_up, *_DIRECTIONS["sl2"]),
    Sweep(_SL2, "OPPOSITE_ABOVE", "sl2", "length", opposite("sl2"), *_LENGTHS["sl2"]),
    Sweep(_SL2, "SPLIT_DIRECTION_ABOVE", "sl2", "direction", split("sl2"), *_DIRECTIONS["sl2"]),
    Sweep("special/stumpff.h", "STUMPFF_SERIES_BELOW", "nil", "point", series_of_nil, (2.6e-7, 3.3e-16),
          ("2.6e-7    3.3e-16",), _NIL),
    Sweep("special/stumpff.h", "STUMPFF_SERIES_BELOW", "nil", "area", series_of_nil, (7.7e-6, 1.1e-15),
          ("7.7e-6    1.1e-15",), _NIL),
    Sweep("special/stumpff.h", "STUMPFF_SERIES_BELOW", "sl2", "point", series_of_sl2, (5.3e-7, 1.1e-15),
          ("5.3e-7    1.1e-15",), _SL2),
    Sweep("special/stumpff.h", "STUMPFF_SERIES_BELOW", "sl2", "area", series_of_sl2, (3.6e-6, 4.9e-15),
          ("3.6e-6    4.9e-15",), _SL2),
    Sweep(_PHASE, "CLOSED_BELOW", "sol", "point", moduli, *_POINTS_OF_SOL),
    Sweep(_PHASE, "SHORT_PHASE", "sol", "point", phases, *_POINTS_OF_SOL, ("single",)),
    Sweep(_PHASE, "PHASE_END", "sol", "point", long_phases, *_POINTS_OF_SOL),
    Sweep(_PHASE, "PLANAR_BELOW", "sol", "point", planar, *_POINTS_OF_SOL),
    Sweep(_PHASE, "PLANAR_BELOW", "sol", "length", planar_points, *_LENGTHS_OF_SOL),
    Sweep(SOL_FLOW, "HALF_TANGENT_BELOW", "sol", "point", half_heights, *_POINTS_OF_SOL),
    Sweep(SOL_FLOW, "BETA_SN_ABOVE", "sol", "point", beta_sn, *_POINTS_OF_SOL),
    Sweep(SOL_FLOW, "TRANSPORT_STEP", "sol", "transport", steps_of(1), (4.6e-7, 8.2e-16),
          ("4.6e-7    8.2e-16",), SOL_FLOW),
    Sweep(_GEODESICS, "WIDE_ABOVE", "sol", "length", wide, *_LENGTHS_OF_SOL),
    Sweep(_GEODESICS, "APART_BELOW", "sol", "length", apart_at_the_end, *_LENGTHS_OF_SOL),
    Sweep(_GEODESICS, "AXIS_BELOW", "sol", "length", next_to_the_axis, *_LENGTHS_OF_SOL),
    Sweep("geometry/sol_light.h", "CLOSED_AREA_ABOVE", "sol", "area", areas(False), (4.1e-5, 3.1e-9),
          ("4.1e-5    3.1e-9",), "geometry/sol_light.h"),
    Sweep("geometry/sol_light.h", "CLOSED_AREA_ABOVE", "sol", "area", areas(True), (4.1e-5, 3.1e-9),
          ("4.1e-5    3.1e-9",), "geometry/sol_light.h"),
    Sweep("geometry/sol_light.h", "AREA_STEP", "sol", "area", steps_up, (5.0e-5, 4.0e-9),
          ("5.0e-5    4.0e-9",), "geometry/sol_light.h"),
]  # fmt: skip


class BallSweep(NamedTuple):
    """`drive` makes points (N,4), by a Geometry in double precision, of values of the variable."""

    part: str
    constant: str
    geometry: str
    drive: Callable[[Array, Geometry], Array]

    def __str__(self) -> str:
        return f"{self.constant} {self.geometry}"


def near_the_pole(v: Array, g: Geometry) -> Array:
    """nil: the first guess of T is v, next to pi."""
    rest, heights = (np.pi - v) / (np.sqrt(np.pi) / 2), (1.0, 6.0, 20.0)
    return np.concatenate([lifted("nil", rest * np.sqrt(h + 0.5), 0 * v, h) for h in heights])


def guessed_angle(v: Array, g: Geometry) -> Array:
    """sl2: the first guess of psi is v."""
    parts = []
    for square in (1e-3, 0.3, 4.0):
        bend = square / (0.4 * square + 1)
        x = 2 * np.sqrt(square * (1 + square))
        parts.append(lifted("sl2", 0 * v + x, 0 * v, v * (4 / 3 * bend + 2)))
    return np.concatenate(parts)


def elliptic_square(v: Array, g: Geometry) -> Array:
    """Ends of geodesics of nil and sl2 whose s, or T^2, is v."""
    parts = []
    for up in (0.75, 0.9, 0.99) if v.mean() > 0 else (0.1, 0.5, 0.69):
        u = np.array([np.sqrt((1 - up) * (1 + up)), 0.0, up])
        square = (up * up if g.name == "nil" else 2 * up * up - 1) / 4
        parts.append(g.flow(u, np.sqrt(v / square))[0])
    return np.concatenate(parts)


def bounded_at(v: Array, g: Geometry) -> Array:
    """sol: the lower bound of the distance is v, in three directions."""
    parts = []
    for row in ((0.5, 0.4, 0.2), (0.1, 0.7, -0.6), (0.5, -0.5, 0.5)):
        u = np.array(row) / np.linalg.norm(row)
        t = moved_to(lambda t, u=u: g.underestimate(g.flow(u, t)[0])[0], 0.5, 3.0, v)
        parts.append(g.flow(u, t)[0])
    return np.concatenate(parts)


BALLS = [
    BallSweep("shape/ball_twisted.h", "UNKNOWN_END", "nil", near_the_pole),
    BallSweep("shape/ball_twisted.h", "PSI_END", "sl2", guessed_angle),
    BallSweep("shape/ball_twisted.h", "COT_END", "nil", elliptic_square),
    BallSweep("shape/ball_twisted.h", "COT_END", "sl2", elliptic_square),
    BallSweep("shape/ball_twisted.h", "COT_START", "sl2", elliptic_square),
    BallSweep("shape/ball_sol.h", "FADING_KNOWN_BELOW", "sol", bounded_at),
]
# Of special/jacobi.h, by the functions of thurston_cl.special.
ELLIPTIC = ("DIFFERENCE_BELOW", "HYPERBOLIC_BELOW", "SECH_END")

_START = "where a search starts or goes next: no result depends on it (test_regimes.SEAMS names the test)"
_COUNT = "how many steps or nodes suffice: fewer are tested to be too few"
_END = "the end of a bracket or of a solve: only reached by what has no root"
_FACTOR = "a factor, on no side of which another formula stands"
_EXACT = "a power of two: nothing is rounded by it"
# The named constants of geometry/, special/ and shape/ that are no seams of a result, and why.
NO_SWEEP: dict[tuple[str, str], str] = {
    ("geometry/h3.h", "RADIAL_ABOVE"): "what steps leave of a ray; test_geometry.py walks over it",
    ("geometry/twisted.h", "QUARTER_TURN_END"): _END,
    ("geometry/twisted.h", "START_BELOW"): _START,
    ("geometry/nil.h", "POLE_SHIFT"): _START,
    ("geometry/nil.h", "CUBE_ROOT_HALF"): _START,
    ("geometry/sl2.h", "POLE_SHIFT"): _START,
    ("geometry/sl2.h", "MOST_BEND"): _FACTOR,
    ("geometry/sol_phase.h", "ASCENTS"): _COUNT,
    ("geometry/sol_flow.h", "MOST_STEPS"): "beyond it there is no number, and a warning; test_far_points.py",
    ("geometry/sol_flow.h", "NODES"): _COUNT,
    ("geometry/sol_bounds.h", "BOUND_FACTOR"): _FACTOR,
    ("geometry/sol_bounds.h", "MOST_JERK"): _FACTOR,
    ("geometry/sol_bounds.h", "SIDE_GROWTH"): _FACTOR,
    ("geometry/sol_bounds.h", "SIDE_HORIZON"): "how far a bound of a ray's time looks ahead: rays only",
    ("geometry/sol_geodesics.h", "GOLDEN"): _START,
    ("geometry/sol_geodesics.h", "LENGTH_TOLERANCE"): _END,
    ("geometry/sol_geodesics.h", "MINIMUM_STEPS"): _COUNT,
    ("geometry/sol_geodesics.h", "MOST_WINDINGS"): "how many geodesics are listed",
    ("geometry/sol_geodesics.h", "OUTWARD_LEAST"): _START,
    ("geometry/sol_geodesics.h", "OUTWARD_MOST"): _START,
    ("geometry/sol_geodesics.h", "ROOT_START"): _START,
    ("special/rise.h", "LOOK_AHEAD"): _START,
    ("special/newton.h", "NEWTON_BOUND"): _COUNT,
    ("special/newton.h", "NEWTON_TOLERANCE"): _END,
    ("special/jacobi.h", "AGM_STEPS"): _COUNT,
    ("special/carlson.h", "DUPLICATIONS"): _COUNT,
    ("special/elementary.h", "SQUARE_SCALE"): _EXACT,
    ("special/elementary.h", "SQUARE_SCALE_BACK"): _EXACT,
    **{("special/elementary.h", f"HALF_PI_{part}"): "pi/2 in parts" for part in ("HIGH", "MIDDLE", "LOW")},
    (
        "shape/ball.h",
        "BALL_SEEN_BELOW",
    ): "where normals begin to be worked out: distances do not depend on it",
    (
        "shape/ball.h",
        "SQUEEZE_ROUNDING",
    ): "when two bounds count as one: what they differ by then is rounding",
    ("shape/ball_twisted.h", "SQUEEZE_STEPS"): _COUNT,
    ("shape/ball_sol.h", "LEAST_FADING"): _FACTOR,
    ("shape/ball_sol.h", "MOST_FADING"): _FACTOR,
    ("shape/pseudo_ball.h", "HALF_C"): _FACTOR,
    ("shape/pseudo_ball.h", "INVERSE_ROOT"): _FACTOR,
    ("shape/bisected_half_space.h", "HALVINGS"): _COUNT,
}


def value_of(part: str, name: str, precision: str) -> float:
    """The value of a named constant, in decimal or hexadecimal."""
    found = re.findall(rf"^#define {name} (?:C\()?(-?[\dx][^\sf)]*)", kernel_text(part), re.MULTILINE)
    values = [float.fromhex(x) if "x" in x else float(x) for x in found]
    # Of two, that of double precision comes first, but for what only single precision has.
    return max(values) if name == "SHORT_PHASE" else values[0 if precision == "double" else -1]


@functools.cache
def inputs_of(index: int, precision: str) -> Inputs:
    sweep = SWEEPS[index]
    return sweep.drive(value_of(sweep.part, sweep.constant, precision) * (1 + sides(precision)), precision)
