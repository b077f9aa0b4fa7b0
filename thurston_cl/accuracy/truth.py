"""The geodesic flow of all eight geometries by mpmath: what the kernels are measured against.

The geodesic equation is integrated by its Taylor series, step after step, in any number of digits. Nothing of
the kernels is in it: no closed form, no elliptic function, no case. In coordinates in which every equation is
quadratic, so that products of series are all that is wanted:
  isotropic (paper 7) and products (8): q' = v, v' = -K |v|^2 q in the ambient space of each factor;
  nil (9.2):  u' = (-u_z u_y, u_z u_x, 0), x' = u_x, y' = u_y, z' = u_z + (x u_y - y u_x)/2;
  sl2 (10.3): u' = (2 u_y u_w, -2 u_x u_w, 0) and the matrix g' = g (u_x E2 + u_y E3 + u_w E1)/2, in the
    complex form g = (Z, E); the fibre coordinate is twice the continuous argument of Z;
  sol (11.2): u' = (u_x u_z, -u_y u_z, u_y^2 - u_x^2), z' = u_z, and with P = e^z, M = e^-z: P' = P u_z,
    M' = -M u_z, x' = P u_x, y' = M u_y.
ACCURACY. tests/test_accuracy_truth.py: flows of tests/data, to the 25 digits that they have.
SPEED. 30 digits to t = 10: 3 ms in products and isotropic spaces, 10 ms in nil, 30 in sl2, 100 in sol.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from mpmath import mp

from thurston_cl.models import GEOMETRIES, ORIGIN, PRODUCTS

# mpmath has no type hints.
Real = Any
Series = list[Real]
# From the series of all components up to the order n, the coefficients of order n of their derivatives.
Equation = Callable[[list[Series], int], Sequence[Real]]

CURVATURE = {"e3": 0, "s3": 1, "h3": -1, "s2xe": 1, "h2xe": -1}
# Nearby geodesics part like e^t at the most, and so do errors: digits for each unit of length.
DIGITS_FOR_LENGTH = 1 / math.log(10)
# For rounding, and for directions with components as small as 1e-12 that grow with the geodesic.
GUARD_DIGITS = 15
# Terms of a series for each digit: the sum of all steps' work has its flat minimum there.
TERMS_FOR_DIGIT = 1.3
# In sl2 the argument of Z turns by |w'|/2 <= 0.71 for each unit of length: no step this long loses a turn.
LONGEST_STEP = 4


def flow(
    geometry: str,
    direction: Sequence[Any],
    time: Any,
    base: Sequence[Any] | None = None,
    digits: int = 30,
) -> tuple[list[Real], list[Real]]:
    """Follow the geodesic from `base` (4; default the origin) with the velocity `direction` (3) for `time`.

    Numbers are floats, which are taken as exact, mpf or decimal strings. `direction` stands in the frame of
    `Geometry` and is taken as it is: where its length is not 1, the geodesic is run through that much faster.
    Returns the point (4 mpf, in the model of `Geometry`) and the velocity there (3 mpf, in the frame there),
    with about `digits` digits relative to the largest of each. ValueError for an unknown geometry. The frame
    at the antipode of the origin, in s3 and s2xe, is undefined.
    """
    if geometry not in GEOMETRIES:
        raise ValueError(f"unknown geometry {geometry!r}; expected one of: {', '.join(GEOMETRIES)}")
    length = abs(float(time)) * math.sqrt(sum(float(component) ** 2 for component in direction))
    with mp.workdps(digits + GUARD_DIGITS + math.ceil(length * DIGITS_FOR_LENGTH)):
        u = [mp.mpf(component) for component in direction]
        p = [mp.mpf(coordinate) for coordinate in (ORIGIN[geometry] if base is None else base)]
        follow = {"nil": _nil, "sl2": _sl2, "sol": _sol}.get(geometry)
        if follow is not None:
            return follow(p, u, mp.mpf(time))
        return _straight(geometry, p, u, mp.mpf(time))


def _integrate(
    start: list[Real],
    derivative: Equation,
    time: Real,
    longest: Real = mp.inf,
    turn: Callable[..., None] | None = None,
) -> list[Real]:
    """The components at `time`, by steps of at most `longest`; `turn(before, after)` is told of each."""
    order = math.ceil(TERMS_FOR_DIGIT * mp.dps)
    y, left = list(start), time
    while left:
        series = [[component] for component in y]
        for n in range(order):
            for component, rate in zip(series, derivative(series, n), strict=True):
                component.append(rate / (n + 1))
        step = min(abs(left), longest, *(_reach(series, n) for n in (order - 1, order)))
        step *= mp.sign(left)
        powers = [mp.one]
        for _ in range(order):
            powers.append(powers[-1] * step)
        after = [mp.fdot(component, powers) for component in series]
        if turn is not None:
            turn(y, after)
        y, left = after, left - step
    return y


def _reach(series: list[Series], n: int) -> Real:
    """How far the terms of order n are below rounding."""
    largest = max(abs(component[n]) for component in series)
    return (mp.eps / largest) ** (mp.one / n) if largest else mp.inf


def _product(a: Series, b: Series, n: int) -> Real:
    """The coefficient of order n of the product of two series."""
    return mp.fdot(a[: n + 1], b[n::-1])


def _straight(geometry: str, p: list[Real], u: list[Real], time: Real) -> tuple[list[Real], list[Real]]:
    """Isotropic spaces, and products: a factor and a line."""
    product, k = geometry in PRODUCTS, CURVATURE[geometry]
    across = 2 if product else 3
    x, w, along = p[:across], p[across], u[:across]
    if not k:
        return [a + time * b for a, b in zip(x, u, strict=True)] + [w], u
    # The transvection that carries the origin of the factor to p, applied to u.
    inner = mp.fdot(x, along)
    velocity = [b - k * inner * a / (1 + w) for a, b in zip(x, along, strict=True)] + [-k * inner]
    stiffness = -k * mp.fdot(along, along)
    half = across + 1

    def derivative(series: list[Series], n: int) -> list[Real]:
        return [v[n] for v in series[half:]] + [stiffness * q[n] for q in series[:half]]

    y = _integrate([*x, w, *velocity], derivative, time)
    q, v = y[:half], y[half:]
    back = [b - a * v[across] / (1 + q[across]) for a, b in zip(q[:across], v[:across], strict=True)]
    if not product:
        return q, back
    return [*q, p[3] + time * u[2]], [*back, u[2]]


def _nil(p: list[Real], u: list[Real], time: Real) -> tuple[list[Real], list[Real]]:
    def derivative(series: list[Series], n: int) -> list[Real]:
        x, y, _, a, b = series
        rise = (_product(x, b, n) - _product(y, a, n)) / 2
        return [a[n], b[n], rise if n else rise + u[2], -u[2] * b[n], u[2] * a[n]]

    *point, a, b = _integrate([*p[:3], u[0], u[1]], derivative, time)
    return [*point, mp.one], [a, b, u[2]]


def _sl2(p: list[Real], u: list[Real], time: Real) -> tuple[list[Real], list[Real]]:
    c = u[2]

    def derivative(series: list[Series], n: int) -> list[Real]:
        # Z' = (i c Z + E conj v)/2 and E' = (Z v - i c E)/2 with v = a + i b.
        p0, p1, p2, p3, a, b = series
        return [
            (-c * p1[n] + _product(p2, a, n) + _product(p3, b, n)) / 2,
            (c * p0[n] + _product(p3, a, n) - _product(p2, b, n)) / 2,
            (c * p3[n] + _product(p0, a, n) - _product(p1, b, n)) / 2,
            (-c * p2[n] + _product(p0, b, n) + _product(p1, a, n)) / 2,
            2 * c * b[n],
            -2 * c * a[n],
        ]

    angle = p[3] / 2

    def turn(before: list[Real], after: list[Real]) -> None:
        nonlocal angle
        angle += mp.arg(mp.mpc(after[0], after[1]) * mp.mpc(before[0], -before[1]))

    start_z = mp.sqrt((p[2] + 1) / 2) * mp.expj(angle)
    start_e = mp.mpc(p[0], p[1]) / mp.sqrt(2 * (p[2] + 1)) * mp.expj(-angle)
    start = [start_z.real, start_z.imag, start_e.real, start_e.imag, u[0], u[1]]
    speed = mp.norm(u)
    longest = LONGEST_STEP / speed if speed else mp.inf
    p0, p1, p2, p3, a, b = _integrate(start, derivative, time, longest, turn)
    over = 2 * mp.mpc(p0, p1) * mp.mpc(p2, p3)
    return [over.real, over.imag, 1 + 2 * (p2 * p2 + p3 * p3), 2 * angle], [a, b, c]


def _sol(p: list[Real], u: list[Real], time: Real) -> tuple[list[Real], list[Real]]:
    def derivative(series: list[Series], n: int) -> list[Real]:
        _, _, _, stretch, shrink, a, b, c = series
        return [
            _product(stretch, a, n),
            _product(shrink, b, n),
            c[n],
            _product(stretch, c, n),
            -_product(shrink, c, n),
            _product(a, c, n),
            -_product(b, c, n),
            _product(b, b, n) - _product(a, a, n),
        ]

    start = [*p[:3], mp.exp(p[2]), mp.exp(-p[2]), *u]
    x, y, z, _, _, a, b, c = _integrate(start, derivative, time)
    return [x, y, z, mp.one], [a, b, c]


def displacement(geometry: str, start: Sequence[Any], end: Sequence[Any], digits: int = 30) -> list[Real]:
    """The vector (3 mpf) from `start` (4) to a point `end` (4) next to it, to first order, in an orthonormal
    frame there.

    Its norm is their distance, up to a part of the order of that distance. Floats and mpf are exact; `end` is
    put on the model first: on a hyperboloid by its height over the others, on a sphere along its ray. The
    frame is that of `Geometry`, but where a sphere is away from the origin that of the point opposite.
    """
    with mp.workdps(digits + GUARD_DIGITS):
        p, q = ([mp.mpf(coordinate) for coordinate in point] for point in (start, end))
        match geometry:
            case "nil":
                x, y, z = (b - a for a, b in zip(p[:3], q[:3], strict=True))
                return [x, y, z + (p[1] * q[0] - p[0] * q[1]) / 2]
            case "sol":
                stretch = mp.exp(p[2])
                return [(q[0] - p[0]) / stretch, (q[1] - p[1]) * stretch, q[2] - p[2]]
            case "sl2":
                (z, e), (z_end, e_end) = _matrix(p), _matrix(q)
                turned = mp.conj(z) * z_end - e * mp.conj(e_end)
                over = 2 * turned * (mp.conj(z) * e_end - e * mp.conj(z_end))
                # In the cover: the angle that the product gains is that of 1 + (E/Z) conj(E'/Z'), E' of -p.
                gain = mp.arg(1 - e / mp.conj(z) * mp.conj(e_end) / z_end)
                return [over.real, over.imag, q[3] - p[3] + 2 * gain]
            case "s2xe" | "h2xe":
                return [*_across(p[:3], q[:3], CURVATURE[geometry]), q[3] - p[3]]
            case _:
                return _across(p, q, CURVATURE[geometry])


def _matrix(p: list[Real]) -> tuple[Real, Real]:
    """(Z, E) of a point of sl2."""
    height = mp.sqrt(1 + p[0] ** 2 + p[1] ** 2)
    e = mp.mpc(p[0], p[1]) / mp.sqrt(2 * (height + 1))
    return mp.sqrt((height + 1) / 2) * mp.expj(p[3] / 2), e * mp.expj(-p[3] / 2)


def _across(p: list[Real], q: list[Real], k: int) -> list[Real]:
    """The spatial part of q, put on the model, carried back by the transvection from the origin to p."""
    if not k:
        return [b - a for a, b in zip(p[:-1], q[:-1], strict=True)]
    if k > 0:
        side, size = (mp.mpf(1) if p[-1] >= 0 else mp.mpf(-1)), mp.sqrt(mp.fdot(q, q))
        p, q = [side * a for a in p], [side * a / size for a in q]
    else:
        p, q = ([*a[:-1], mp.sqrt(1 + mp.fdot(a[:-1], a[:-1]))] for a in (p, q))
    x, w = p[:-1], p[-1]
    return [b + a * (-k * mp.fdot(x, q[:-1]) / (1 + w) - q[-1]) for a, b in zip(x, q[:-1], strict=True)]
