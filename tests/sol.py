"""Sol in long arithmetic, by ways of its own: the truth that tests/test_*sol*.py compare with.

The flow in closed form, with the phase inverted for as in paper 11.2 (Landen's transformation of the
amplitude, A&S 17.5, 17.6), in as many digits as its differences cancel plus 40; the same, and parallel
transport, by Taylor's series of the equations of motion; the area density by differences of the flow.
"""

import functools
from typing import Any, NamedTuple

import numpy as np
import scipy.special
from golden import MP, Array, Exact, cut, exact

# Digits that are left at the end.
DIGITS = 40


class State(NamedTuple):
    """A point (x, y, z), the direction of travel there in its frame, and the transport from 0 if known."""

    point: Exact
    direction: Exact
    transport: Exact | None = None


def row(values: Any) -> Exact:
    """Strings, floats or long numbers, none of which is rounded."""
    return np.array([c if isinstance(c, MP.mpf) else exact(c)[()] for c in values], dtype=object)


def unit(u: Any) -> Exact:
    v = row(u)
    return v / MP.sqrt(sum(c * c for c in v))


def multiply(p: Any, q: Any) -> Exact:
    stretch = MP.exp(p[2])
    return np.array([p[0] + stretch * q[0], p[1] + q[1] / stretch, p[2] + q[2]], dtype=object)


def inverse(p: Any) -> Exact:
    stretch = MP.exp(p[2])
    return np.array([-p[0] / stretch, -p[1] * stretch, -p[2]], dtype=object)


def size(point: Any) -> Any:
    """The length of (x, y, z) in the metric at the point."""
    stretch = MP.exp(point[2])
    return MP.sqrt((point[0] / stretch) ** 2 + (point[1] * stretch) ** 2 + point[2] ** 2)


def off(point: Exact, got: Any) -> float:
    """The length of the error in the metric at the true point, relative to max(1, size)."""
    p, g = list(point[:3]), [MP.mpf(float(c)) for c in got[:3]]
    if not all(MP.isfinite(c) for c in g):
        return float("inf")
    stretch = MP.exp(p[2])
    error = MP.sqrt(((g[0] - p[0]) / stretch) ** 2 + ((g[1] - p[1]) * stretch) ** 2 + (g[2] - p[2]) ** 2)
    return float(error / max(MP.mpf(1), size(p)))


class Means:
    """Arithmetic-geometric means of 1 and k'."""

    def __init__(self, complement: Any, square: Any) -> None:
        self.a, self.b, self.c = [MP.mpf(1)], [complement], [MP.sqrt(square)]
        while self.c[-1] > MP.mpf(10) ** (-MP.dps // 2 - 3):
            a, b = self.a[-1], self.b[-1]
            self.a.append((a + b) / 2)
            self.b.append(MP.sqrt(a * b))
            self.c.append((a - b) / 2)
        excess = sum(MP.ldexp(c * c, n - 1) for n, c in enumerate(self.c))
        self.mean = 1 - excess  # E/K
        self.scale = MP.ldexp(self.a[-1], len(self.a) - 1)

    def by_amplitude(self, phi: Any) -> tuple[Any, Any]:
        """F and the integral of dn^2 up to the amplitude."""
        total = MP.mpf(0)
        for a, b, c in zip(self.a[:-1], self.b[:-1], self.c[1:], strict=True):
            turns = MP.nint(phi / MP.pi) * MP.pi
            phi += turns + MP.atan2(b * MP.sin(phi - turns), a * MP.cos(phi - turns))
            total += c * MP.sin(phi)
        w = phi / self.scale
        return w, self.mean * w + total

    def by_argument(self, w: Any) -> tuple[Any, Any]:
        """The amplitude and the integral of dn^2."""
        phi, total = self.scale * w, MP.mpf(0)
        for a, c in zip(reversed(self.a[1:]), reversed(self.c[1:]), strict=True):
            sine = MP.sin(phi)
            total += c * sine
            phi = (phi + MP.asin(c / a * sine)) / 2
        return phi, self.mean * w + total


def _in_plane(u: Exact, t: Any, axis: int) -> State:
    """With u_y = 0 (axis 0), or with u_x = 0 and z turned round."""
    across, up = u[axis], u[2] if axis == 0 else -u[2]
    cosh, sinh = MP.cosh(t), MP.sinh(t)
    shrink = cosh - up * sinh
    z, end = -MP.log(shrink), (up * cosh - sinh) / shrink
    point, ahead = [MP.mpf(0)] * 3, [MP.mpf(0)] * 3
    point[axis], ahead[axis] = across * sinh / shrink, across / shrink
    point[2], ahead[2] = (z, end) if axis == 0 else (-z, -end)
    return State(np.array(point, dtype=object), np.array(ahead, dtype=object))


def flow(u: Any, t: Any) -> State:
    """From 0 along u, made a unit vector first, for the length t of either sign."""
    start, time = row(u), MP.mpf(t)
    with MP.workdps(DIGITS + 10 + 2 * int(abs(time))):
        ray = unit(start)
        if time < 0:
            there = flow(-ray, -time)
            return State(there.point, -there.direction)
        if ray[0] == 0 or ray[1] == 0:
            return _in_plane(ray, time, int(ray[0] == 0))
    loss = int(-2 * MP.log10(abs(ray[0] * ray[1]))) + int(time)
    with MP.workdps(DIGITS + 10 + loss):
        ray = unit(start)
        a, b, c = abs(ray[0]), abs(ray[1]), ray[2]
        m = a * b
        mu = MP.sqrt(1 + 2 * m)
        complement_square, square = 4 * m / mu**2, ((a - b) ** 2 + c * c) / mu**2
        means = Means(MP.sqrt(complement_square), square)
        k, first = MP.sqrt(square), MP.atan2(-c, a - b)
        w_0, dn_0 = means.by_amplitude(first)
        w = w_0 + mu * time
        phi, dn_1 = means.by_argument(w)
        dn = MP.sqrt(complement_square + square * MP.cos(phi) ** 2)
        end = [mu / 2 * (dn + k * MP.cos(phi)), mu / 2 * (dn - k * MP.cos(phi)), -k * mu * MP.sin(phi)]
        both = 2 * (dn_1 - dn_0) - complement_square * (w - w_0)
        turn = 2 * k * (MP.sin(phi) - MP.sin(first))
        point = [mu / 4 * (both + turn) / a, mu / 4 * (both - turn) / b, MP.log(end[0] / a)]
        for axis in (0, 1):
            if ray[axis] < 0:
                point[axis], end[axis] = -point[axis], -end[axis]
        return State(np.array(point, dtype=object), np.array(end, dtype=object))


def taylor(u: Any, t: Any, order: int = 40, step: str = "0.2") -> State:
    """The same by the equations of motion, with transport Q' = -B Q."""
    time = MP.mpf(t)
    steps = max(1, int(MP.ceil(abs(time) / MP.mpf(step))))
    h, q = time / steps, list(exact(np.eye(3)).reshape(-1))
    ray, point = list(unit(u)), list(exact(np.zeros(3)))

    def product(f: list[Any], g: list[Any], n: int) -> Any:
        return MP.fsum(f[k] * g[n - k] for k in range(n + 1))

    def at_end(series: list[Any]) -> Any:
        total = MP.mpf(0)
        for coefficient in reversed(series):
            total = total * h + coefficient
        return total

    for _ in range(steps):
        x, y, z = ([c] for c in ray)
        stretch, shrink, moved, turned = (
            [MP.mpf(1)],
            [MP.mpf(1)],
            [[MP.mpf(0)] for _ in range(3)],
            [[c] for c in q],
        )
        for n in range(order):
            rates = [
                (x, product(x, z, n)),
                (y, -product(y, z, n)),
                (z, product(y, y, n) - product(x, x, n)),
                (stretch, product(stretch, z, n)),
                (shrink, -product(shrink, z, n)),
                (moved[0], product(stretch, x, n)),
                (moved[1], product(shrink, y, n)),
                (moved[2], z[n]),
            ]
            for column in range(3):
                top, middle, bottom = (turned[3 * row + column] for row in range(3))
                rates += [(top, product(x, bottom, n)), (middle, -product(y, bottom, n))]
                rates += [(bottom, product(y, middle, n) - product(x, top, n))]
            for series, rate in rates:
                series.append(rate / (n + 1))
        point = list(multiply(point, [at_end(f) for f in moved]))
        ray, q = [at_end(f) for f in (x, y, z)], [at_end(f) for f in turned]
    return State(*(np.array(v, dtype=object) for v in (point, ray)), np.array(q, dtype=object).reshape(3, 3))


def height_integral(v: Any, complement: Any) -> Any:
    """The integral of sn^2 cn dn/(dn + cn)^2 from 0 to v: of second kind, and elementary at k' = 0 and 1."""
    small = MP.mpf(complement)
    with MP.workdps(DIGITS + 10 + int(-8 * MP.log10(min(small or 1, MP.mpf(v) or 1)))):
        v, square = MP.mpf(v), 1 - small**2
        if not small:
            return (v - MP.tanh(v)) / 4
        phi, second = Means(small, square).by_argument(v)
        s, c, d = MP.sin(phi), MP.cos(phi), MP.sqrt(small**2 + square * MP.cos(phi) ** 2)
        return ((2 + 2 * square) * (v - s) - 4 * (v - second)) / small**4 - s * (s / (d + c)) ** 2


def across(u: Exact) -> tuple[Exact, Exact]:
    """Two unit vectors that make a frame with u."""
    axis = exact(np.eye(3))[int(np.argmin(np.abs(u.astype(float))))]
    first = unit(np.cross(u, axis))
    return first, np.cross(u, first)


def area(u: Any, t: Any) -> Any:
    """Area of the wave front per solid angle, signed: by differences of the flow, of order 2."""
    step = MP.mpf(10) ** -14
    ray = unit(u)
    here = flow(ray, t)
    stretch = MP.exp(here.point[2])
    fields = []
    for aside in across(ray):
        ahead, behind = (flow(ray * MP.cos(s) + aside * MP.sin(s), t).point for s in (step, -step))
        field = (ahead - behind) / (2 * step)
        fields.append(np.array([field[0] / stretch, field[1] * stretch, field[2]], dtype=object))
    return np.dot(here.direction, np.cross(*fields))


def directions(rows: Any, precision: str) -> Array:
    """Unit vectors along `rows` (N,3), rounded to the precision."""
    u = np.asarray(rows, dtype=np.float64)
    return cut(u / np.linalg.norm(u, axis=1, keepdims=True), precision)


def periods(u: Array) -> Array:
    """The times (N,) after which directions (N,3) come back."""
    m = np.abs(u[:, 0] * u[:, 1])
    return 4 * scipy.special.ellipkm1(4 * m / (1 + 2 * m)) / np.sqrt(1 + 2 * m)


def errors(points: Array, got: Array) -> Array:
    """What `off` measures, of many points (N,4), with the digits of binary64."""
    stretch = np.exp(points[:, 2])
    error, length = (
        np.sqrt((v[:, 0] / stretch) ** 2 + (v[:, 1] * stretch) ** 2 + v[:, 2] ** 2)
        for v in (got - points, points)
    )
    return error / np.maximum(1, length)


@functools.cache
def known_flow(a: float, b: float, c: float, t: float) -> State:
    """`flow`, remembered."""
    return flow([a, b, c], t)


def flows(u: Array, t: Array) -> list[State]:
    """Of rays (N,3) and times (N,), numbers of a precision."""
    return [known_flow(*map(float, ray), float(time)) for ray, time in zip(u, t, strict=True)]
