"""Nil and SL2~ with 50 digits: group law, flow, transport, area density, and the records of tests/data
for them.

The flow is the closed form of math in complex numbers and, in sl2, on the pair (Z, E) of the group
instead of the point of H2 x R; test_golden_nil.py and test_golden_sl2.py hold it against the 25 digits of
the records. It serves for condition numbers and for values at inputs that the records do not have.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from golden import MP, Case, Exact, exact, inputs

Number = Any
ORIGIN = {"nil": (0.0, 0.0, 0.0, 1.0), "sl2": (0.0, 0.0, 1.0, 0.0)}


def stumpff(s: Number) -> tuple[Number, Number, Number, Number]:
    """C0, S0, S1, D of `s`; their Taylor series converge everywhere, closed forms save terms where
    nothing cancels."""
    if abs(s) < 1:
        terms = range(24)
        s1 = sum(-(k + 1) * (-s) ** k / MP.factorial(2 * k + 3) for k in terms)
        d = sum(2 * (-4 * s) ** k / MP.factorial(2 * k + 3) for k in range(32))
        c0 = sum((-s) ** k / MP.factorial(2 * k) for k in terms)
        return c0, sum((-s) ** k / MP.factorial(2 * k + 1) for k in terms), s1, d
    x = MP.sqrt(abs(s))
    c0, s0 = (MP.cos(x), MP.sin(x) / x) if s > 0 else (MP.cosh(x), MP.sinh(x) / x)
    return c0, s0, (c0 - s0) / (2 * s), (1 - c0 * s0) / (2 * s)


def rotation(axis: Sequence[Number], angle: Number) -> Exact:
    """The right-handed rotation (3,3) about a unit axis."""
    x, y, z = axis
    cross = np.array([[0 * x, -z, y], [z, 0 * x, -x], [-y, x, 0 * x]])
    return exact(np.eye(3)) + MP.sin(angle) * cross + (1 - MP.cos(angle)) * cross @ cross


def lift(geometry: str, xyw: Exact) -> Exact:
    """The model's point (4,) from the three numbers of a record."""
    x, y, w = xyw
    return np.array([x, y, w, MP.mpf(1)] if geometry == "nil" else [x, y, MP.sqrt(1 + x * x + y * y), w])


def half_speeds(u: Sequence[Number], t: Number) -> tuple[Number, Number]:
    """R and T: half of the time times the parts of `u` across and along the fibre."""
    return MP.sqrt(u[0] ** 2 + u[1] ** 2) * t / 2, u[2] * t / 2


def in_group(p: Exact) -> tuple[Number, Number, Number]:
    """Z, E and the fibre coordinate of a point (4,) of sl2."""
    turn = MP.expj(p[3] / 2)
    return MP.sqrt((p[2] + 1) / 2) * turn, MP.mpc(p[0], p[1]) / MP.sqrt(2 * (p[2] + 1)) / turn, p[3]


def multiply(geometry: str, p: Exact, q: Exact) -> Exact:
    """The product in the group of two points (4,)."""
    if geometry == "nil":
        return np.array([p[0] + q[0], p[1] + q[1], p[2] + q[2] + (p[0] * q[1] - p[1] * q[0]) / 2, MP.mpf(1)])
    (z1, e1, w1), (z2, e2, w2) = in_group(p), in_group(q)
    z, e = z1 * z2 + e1 * MP.conj(e2), z1 * e2 + e1 * MP.conj(z2)
    w = w1 + w2 + 2 * MP.arg(1 + (e1 / z1) * (MP.conj(e2) / z2))
    return np.array([(2 * z * e).real, (2 * z * e).imag, 1 + 2 * abs(e) ** 2, w])


def flow_from_origin(geometry: str, u: Sequence[Number], t: Number) -> tuple[Exact, Exact]:
    """Point (4,) and direction (3,) after time `t`; `u` need not be a unit vector."""
    r, turned = half_speeds(u, t)
    across = MP.mpc(u[0], u[1])
    if geometry == "nil":
        _, s0, _, d = stumpff(turned**2)
        xy, end = across * t * s0 * MP.expj(turned), across * MP.expj(2 * turned)
        return np.array([xy.real, xy.imag, 2 * turned * (1 + r**2 * d), MP.mpf(1)]), np.array(
            [end.real, end.imag, u[2]]
        )
    s = turned**2 - r**2
    c0, s0, _, _ = stumpff(s)
    xy, end = across * t * s0 * MP.mpc(c0, -turned * s0), across * MP.expj(-4 * turned)
    angle = MP.arg(MP.mpc(c0, turned * s0))
    if s > 0:
        # The continuous angle is the one nearest to the angle x that the vertical line has.
        x = MP.sqrt(s) * (1 if turned > 0 else -1)
        angle += 2 * MP.pi * MP.nint((x - angle) / (2 * MP.pi))
    return np.array([xy.real, xy.imag, 1 + 2 * (r * s0) ** 2, 4 * turned - 2 * angle]), np.array(
        [end.real, end.imag, u[2]]
    )


def flow(geometry: str, base: Exact, u: Sequence[Number], t: Number) -> dict[str, Exact]:
    """Point (4,), direction (3,) and transport (9,), the last for the unit direction and its length."""
    point, direction = flow_from_origin(geometry, u, t)
    length = MP.sqrt(sum(c * c for c in u))
    spin, roll = (1, MP.mpf(-1) / 2) if geometry == "nil" else (-2, MP.mpf(1) / 2)
    vertical = exact([0.0, 0.0, 1.0])
    turn = rotation(vertical, spin * u[2] * t) @ rotation([c / length for c in u], roll * length * t)
    return {"point": multiply(geometry, base, point), "direction": direction, "transport": turn.reshape(9)}


def area_factors(geometry: str, u: Sequence[Number], t: Number) -> tuple[Number, Number, Number]:
    """The area density is the product of these: r^2, |S0| and the factor that vanishes at other conjugate
    points."""
    r, turned = half_speeds(u, t)
    s, k = (turned**2, 2) if geometry == "nil" else (turned**2 - r**2, 4)
    _, s0, s1, _ = stumpff(s)
    return 4 * (r**2 + turned**2), abs(s0), abs(s0 - k * r**2 * s1)


def area(geometry: str, u: Sequence[Number], t: Number) -> Number:
    a, b, c = area_factors(geometry, u, t)
    return a * b * c


# Relative steps of numeric derivatives: far above the last of 50 digits, far below any curvature.
STEP = MP.mpf(10) ** -20


def sensitivity(f: Callable[[Exact], Exact], at: Exact) -> Exact:
    """By how much each entry of `f` changes at most when each entry of `at` changes by its own size times
    a unit."""
    value = f(at)
    total = 0 * value
    for i in range(len(at)):
        moved = at.copy()
        moved[i] = moved[i] * (1 + STEP)
        total = total + np.abs(f(moved) - value) / STEP
    return total


def flow_sensitivity(geometry: str, base: Exact, u: Exact, t: Number) -> dict[str, Exact]:
    """Changes of point, direction and transport with relative changes of base, direction and time."""
    names = ("point", "direction", "transport")

    def f(values: Exact) -> Exact:
        start = values[:4].copy()
        if geometry == "sl2":
            start[2] = MP.sqrt(1 + start[0] ** 2 + start[1] ** 2)
        out = flow(geometry, start, values[4:7], values[7])
        return np.concatenate([out[name] for name in names])

    changes = sensitivity(f, np.concatenate([base, u, [t]]))
    return dict(zip(names, (changes[:4], changes[4:7], changes[7:]), strict=True))


def area_sensitivity(geometry: str, u: Exact, t: Number) -> Number:
    return sensitivity(lambda v: np.array([area(geometry, v[:3], v[3])]), np.concatenate([u, [t]]))[0]


def scales(geometry: str, point: Exact, u: Exact, t: Number, base: Exact) -> Exact:
    """The sizes (4,) that errors of a point are relative to: in nil the length of the way for x and y,
    and z for z; in sl2 z for the point of H2, and the fibre coordinate."""
    if geometry == "nil":
        way = t * MP.sqrt(sum(c * c for c in u)) + max(abs(base[0]), abs(base[1]))
        return np.array([way, way, max(abs(point[2]), MP.mpf(10) ** -300), MP.mpf(1)])
    height = max(abs(point[3]), abs(u[2] * t), MP.mpf(10) ** -300)
    return np.array([point[2], point[2], point[2], height])


def as_points(geometry: str, values: Any) -> Exact:
    """Points (N,4) of the model from the inputs of records (N,3)."""
    return np.array([lift(geometry, p) for p in inputs(values)])


def reached(case: Case) -> Exact:
    """The points (N,4) of flow records."""
    return (
        exact([p["hyp"] for p in case.column("point")])
        if case.geometry == "sl2"
        else exact([[*p, "1"] for p in case.column("point")])
    )


def list_index(geometry: str, record: dict[str, Any], found: dict[str, Any]) -> int:
    """Where in the complete list, by length, a geodesic of a record stands: records leave out all beyond
    some interval.

    Off the fibre they leave out only longer ones. On it the circles come first and the vertical line last.
    """
    if any(float(c) != 0 for c in record["q"][:2]) or any(float(c) != 0 for c in record["p"]):
        return [g["d"] for g in record["pairs"]].index(found["d"])
    return found["k"] - 1 if found["k"] else int(abs(float(record["q"][2])) // (2 * np.pi))
