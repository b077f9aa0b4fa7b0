"""Flow, area density and shortest geodesics of every geometry in long arithmetic: what the stability suite
compares with.

Built from what golden.py, twisted.py, sol.py and test_products.py know of the geometries; no formula is that
of a kernel. Directions are taken as they are given, rounded; only Sol brings them to unit length first.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import golden
import numpy as np
import scipy.optimize
import sol
import test_products as products
import twisted
from golden import MP, Array, Exact, exact, rounded

from thurston_cl.models import GEOMETRIES, ISOTROPIC, ORIGIN, PRODUCTS, TWISTED

Number = Any
both_precisions = products.both_precisions
SETTINGS = [(name, precision) for name in GEOMETRIES for precision in golden.EPSILON]
# 50 digits; what sol.py works out may have more.
FINE = MP.mpf(10) ** -22


class End(NamedTuple):
    """The end of a geodesic: point (4,) and direction of travel (3,) in the frame there."""

    point: Exact
    direction: Exact


def curved(geometry: str, angle: Number) -> tuple[Number, Number]:
    """Sine and cosine of the curvature of an isotropic geometry or of a product's factor."""
    if geometry == "e3":
        return angle, MP.mpf(1)
    return products.sine({"s3": "s2xe", "h3": "h2xe"}.get(geometry, geometry), angle)


def flow(geometry: str, u: Any, t: Any) -> End:
    """From the origin along `u` (3,) for the length `t`, numbers or floats."""
    e, time = exact_row(u), number(t)
    if geometry in ISOTROPIC:
        s, c = curved(geometry, time)
        return End(np.array([*(s * e), c], dtype=object), e)
    if geometry in PRODUCTS:
        share = MP.sqrt(e[0] ** 2 + e[1] ** 2)
        s, c = curved(geometry, share * time)
        ratio = s / share if share else time
        return End(np.array([ratio * e[0], ratio * e[1], c, e[2] * time], dtype=object), e)
    if geometry in TWISTED:
        return End(*twisted.flow_from_origin(geometry, e, time))
    state = sol.flow(e, time)
    return End(np.append(state.point, MP.mpf(1)), state.direction)


def area(geometry: str, u: Any, t: Any) -> Number:
    """Area density (5.7) after `t` along `u`, not negative."""
    e, time = exact_row(u), number(t)
    if geometry in ISOTROPIC:
        return curved(geometry, time)[0] ** 2
    if geometry in PRODUCTS:
        share = MP.sqrt(e[0] ** 2 + e[1] ** 2)
        return abs(time * (curved(geometry, share * time)[0] / share if share else time))
    return abs(twisted.area(geometry, e, time) if geometry in TWISTED else sol.area(e, time))


def signed_factor(geometry: str, u: Any, t: Any) -> Number:
    """The factor of the area density of nil or sl2 that is 0 at conjugate points between whole turns,
    signed."""
    e, time = exact_row(u), number(t)
    r, turned = twisted.half_speeds(e, time)
    s, k = (turned**2, 2) if geometry == "nil" else (turned**2 - r**2, 4)
    _, s0, s1, _ = twisted.stumpff(s)
    return s0 - k * r**2 * s1


def root_between(f: Callable[[float], float], low: float, high: float) -> float:
    return float(scipy.optimize.brentq(f, low, high, xtol=1e-15))


def number(value: Any) -> Number:
    return value if isinstance(value, MP.mpf) else MP.mpf(float(value))


def exact_row(values: Any) -> Exact:
    return np.array([number(c) for c in values], dtype=object)


def seen_from(geometry: str, base: Array, point: Array) -> Exact:
    """untranslate(base, point) (4,) of a group, from three free coordinates of each."""
    if geometry == "sol":
        p, q = exact(base), exact(point)
        return np.append(sol.multiply(sol.inverse(p), q), MP.mpf(1))
    free = [0, 1, 2] if geometry == "nil" else [0, 1, 3]
    p, q = (twisted.lift(geometry, exact(x[free])) for x in (base, point))
    if geometry == "nil":
        back = np.array([-p[0], -p[1], -p[2], p[3]], dtype=object)
    else:
        turn = MP.mpc(p[0], p[1]) * MP.expj(-p[3])
        back = np.array([-turn.real, -turn.imag, p[2], -p[3]], dtype=object)
    return twisted.multiply(geometry, back, q)


def in_frame(geometry: str, at: Exact, change: Exact) -> Exact:
    """A small change (4,) of the point `at` (4,) of a group as a vector (3,) in the left-invariant frame."""
    if geometry == "sol":
        stretch = MP.exp(at[2])
        return np.array([change[0] / stretch, change[1] * stretch, change[2]], dtype=object)
    if geometry == "nil":
        return np.array(
            [change[0], change[1], change[2] - (at[0] * change[1] - at[1] * change[0]) / 2], dtype=object
        )
    # The transvection back to the origin, then the turn back by the fibre coordinate.
    along = (at[0] * change[0] + at[1] * change[1]) / (at[2] * (1 + at[2]))
    x, y = change[0] - at[0] * along, change[1] - at[1] * along
    turned = MP.mpc(x, y) * MP.expj(-at[3])
    spin = (at[1] * x - at[0] * y) / (1 + at[2])
    return np.array([turned.real, turned.imag, change[3] - spin], dtype=object)


class Shortest(NamedTuple):
    """Length of the shortest geodesic, and its direction (3,) in the frame at the base."""

    length: Number
    direction: Exact


def shortest(geometry: str, base: Array, point: Array, found: tuple[Array, float]) -> Shortest:
    """The shortest geodesic from `base` (4,) to `point` (4,). In nil, sl2 and sol it is the one next to
    `found`, direction and length in double precision, to which Newton's method on the long flow leads."""
    if geometry in ISOTROPIC:
        p, q = (nearest(geometry, x) for x in (base, point))
        to = (golden.inverse_translation(geometry, p) @ q)[:3]
        size = MP.sqrt((to * to).sum())
        return Shortest(golden.distance(geometry, p[None], q[None])[0], to / size if size else to)
    if geometry in PRODUCTS:
        across, to = products.connection(geometry, base, point)
        rise = number(point[3]) - number(base[3])
        length, size = MP.hypot(across, rise), MP.sqrt((to * to).sum())
        ahead = to * (across / size / length) if size else 0 * to
        return Shortest(length, np.append(ahead, rise / length if length else MP.mpf(1)))
    target = seen_from(geometry, base, point)
    v = exact(found[0]) * number(found[1])
    for _ in range(6):
        end = of_vector(geometry, v)
        off = in_frame(geometry, target, target - end)
        if max(abs(c) for c in off) <= FINE * length_of(v):
            return Shortest(length_of(v), v / length_of(v))
        v = v + solved(slopes(lambda w: in_frame(geometry, target, of_vector(geometry, w)), v), off)
    raise AssertionError(f"{geometry}: {found} does not lead to {point.tolist()} from {base.tolist()}")


def nearest(geometry: str, p: Array) -> Exact:
    """The point (4,) of an isotropic model over three coordinates of `p`, on the side of w."""
    return golden.on_model(geometry, exact(p[None, :3]), [p[3] >= 0])[0]


def length_of(v: Exact) -> Number:
    return MP.sqrt(sum(c * c for c in v))


def of_vector(geometry: str, v: Exact) -> Exact:
    """The point (4,) that the exponential map at the origin takes `v` (3,) to."""
    length = length_of(v)
    return flow(geometry, v / length, length).point


def slopes(f: Callable[[Exact], Exact], v: Exact) -> Any:
    """The derivative (3,3) of `f` at `v`, by differences."""
    step = length_of(v) * MP.mpf(10) ** -18
    here, matrix = f(v), MP.matrix(3, 3)
    for column in range(3):
        moved = v.copy()
        moved[column] += step
        change = (f(moved) - here) / step
        for row in range(3):
            matrix[row, column] = change[row]
    return matrix


def solved(matrix: Any, right: Exact) -> Exact:
    return np.array(list(MP.lu_solve(matrix, MP.matrix(list(right)))), dtype=object)


def point_error(geometry: str, u: Array, t: float, want: Exact, got: Array) -> Array:
    """The error (3,) or (4,) of a point (4,) in the terms of the head of the geometry's file: relative to
    the largest entry; in nil to the length and, for z, to itself; in sl2 to z and, for w, to max(|w|, |u_w
    t|); in sol in the frame there, to max(1, size), and below 1 to the time."""
    if not np.isfinite(got).all():
        return np.full(4, np.inf)
    off = exact(got) - want
    if geometry == "sol":
        size = max(MP.mpf(1), sol.size(want)) * min(1.0, abs(t))
        return rounded(in_frame("sol", want, off) / size)
    if geometry in TWISTED:
        sizes = twisted.scales(geometry, want, exact(u), number(abs(t)), exact(ORIGIN[geometry]))
        return rounded(off / sizes)
    return rounded(off / max(np.abs(want)))


def vector_error(want: Exact, got: Array) -> Array:
    return rounded(exact(got) - want) if np.isfinite(got).all() else np.full(len(want), np.inf)
