"""The flow of Sol (kernels/geometry/sol_flow.h, sol_phase.h) and parallel transport beyond the records:
sweeps into every degenerate direction and walks over every branch, against the long arithmetic of
tests/sol.py; first integrals, symmetries, composition; the same in every lane, at every width, without NaN.

Errors of points are lengths in the metric of Sol at the true point, relative to max(1, size) and, below 1, to
the time; those of directions are absolute. `pytest -s` prints the largest of each regime.
"""

import functools
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import pytest
import sol
from golden import EPSILON, FLOAT, MP, Array, constant, cut, exact
from hypothesis import given, settings
from hypothesis import strategies as st
from small_kernels import Body, SmallKernels

import thurston_cl.program
from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.program import kernel_text

LANES = 16
PHASE_PART, FLOW_PART = "geometry/sol_phase.h", "geometry/sol_flow.h"
PHASE, FLOW = kernel_text(PHASE_PART), kernel_text(FLOW_PART)
both_precisions = pytest.mark.parametrize("precision", EPSILON)
# From here on e^t overflows on the way, also where the end does not.
LAST_TIME = {"single": 87.0, "double": 150.0}
Ray = tuple[Sequence[float], float]


# Which double precision does not have.
SHORT_PHASE = max(map(float, re.findall(r"^#define SHORT_PHASE (\d+)", PHASE, re.MULTILINE)))


def both_sides(precision: str) -> list[float]:
    smallest = {"single": 7, "double": 15}[precision]
    return [0.0, *(sign * 10.0**-n for n in range(1, smallest + 1, 2) for sign in (-1, 1))]


def geometry(precision: str, device: Device, lanes: int = LANES) -> Geometry:
    return Geometry("sol", precision, device, lanes=lanes)


class Errors(NamedTuple):
    points: Array
    directions: Array


def errors_of(rays: Sequence[Ray], precision: str, device: Device) -> tuple[Array, Array, Errors]:
    """The rays as numbers of the precision, and what the flow errs by along each."""
    u, t = sol.directions([ray[0] for ray in rays], precision), cut([ray[1] for ray in rays], precision)
    points, ends = geometry(precision, device).flow(u, t)
    off = Errors(np.zeros(len(t)), np.zeros(len(t)))
    for n, state in enumerate(sol.flows(u, t)):
        off.points[n] = sol.off(state.point, points[n]) / min(1, abs(t[n]))
        off.directions[n] = max(abs(float(c)) for c in exact(ends[n]) - state.direction)
    return u, t, off


def check(
    name: str, precision: str, rays: tuple[Array, Array], off: Array, measured: float, allowed: float = 2.0
) -> None:
    """Print the worst ray; at most `allowed` times what was measured."""
    u, t = rays
    n = int(np.argmax(np.where(np.isfinite(off), off, np.inf)))
    line = f"{precision} {name:44} {off[n]:8.1e}   stated {measured:8.1e}   at {u[n].tolist()}, {t[n]:.6g}"
    print(line)
    assert off[n] <= allowed * measured, line


# -- sweeps into the degenerate directions -------------------------------------------------------------------

SMALL = (1e-2, 1e-4, 1e-7, 1e-11, 1e-16, 1e-22, 1e-30, 0.0)


def a_small() -> Iterator[Sequence[float]]:
    for e in SMALL:
        for c in (0.0, 0.7, -0.7, 0.99, -0.99):
            yield e, np.sqrt((1 - c) * (1 + c)), c


def b_small() -> Iterator[Sequence[float]]:
    return ((b, a, -c) for a, b, c in a_small())


def both_small() -> Iterator[Sequence[float]]:
    for e in SMALL:
        for sign in (1, -1):
            yield from ((e, e, sign), (0.3 * e, e, sign), (e, e * e if e > 1e-15 else 0.0, sign))


def straight() -> Iterator[Sequence[float]]:
    """2ab to 1: 1 - 2ab = (a - b)^2 + c^2 from 1e-1 to 1e-16, and 0."""
    for e in (*10.0 ** np.arange(-0.5, -8.1, -0.5), 0.0):
        a, b = np.cos(np.pi / 4 + e), np.sin(np.pi / 4 + e)
        for c in (0.0, e, -e, 1e-3 * e):
            yield from ((a, b, c), (b, a, c), (1.0, 1.0, c * np.sqrt(2)))


def vertical() -> Iterator[Sequence[float]]:
    """c to 1 and -1: 1 - |c| from 1e-1 to 1e-30, and 0."""
    for e in (*10.0 ** -np.arange(1, 31, 3), 1e-30, 0.0):
        for angle in (0.1, np.pi / 4, 1.4):
            across = np.sqrt(e * (2 - e))
            for sign in (1, -1):
                yield across * np.cos(angle), across * np.sin(angle), sign * (1 - e)


def random_rays() -> Iterator[Sequence[float]]:
    return iter(np.random.default_rng(1).normal(size=(80, 3)))


# By regime: what is swept, and the errors measured of points and, up to t = 3, 30 and the end, of directions;
# in single and in double.
SWEEPS: dict[str, tuple[Callable[[], Iterator[Sequence[float]]], dict[str, tuple[float, ...]]]] = {
    "a to 0": (
        a_small,
        {"single": (2.7e-7, 3.2e-7, 1.2e-6, 1.7e-5), "double": (9.3e-16, 1.1e-15, 3.2e-15, 1.6e-14)},
    ),
    "b to 0": (
        b_small,
        {"single": (2.7e-7, 3.2e-7, 1.2e-6, 1.7e-5), "double": (9.3e-16, 1.1e-15, 3.2e-15, 1.6e-14)},
    ),
    "a and b to 0": (
        both_small,
        {"single": (3.8e-7, 1.2e-7, 7.7e-7, 2.8e-6), "double": (7.3e-16, 1.8e-16, 2.0e-15, 5.2e-15)},
    ),
    "2ab to 1": (
        straight,
        {"single": (3.6e-7, 1.8e-7, 3.6e-7, 1.9e-6), "double": (5.8e-16, 3.4e-16, 9.6e-16, 5.6e-15)},
    ),
    "c to 1 or -1": (
        vertical,
        {"single": (3.9e-7, 2.0e-7, 1.7e-6, 8.0e-6), "double": (8.6e-16, 3.0e-16, 4.4e-15, 2.5e-14)},
    ),
    "random": (
        random_rays,
        {"single": (5.7e-7, 7.6e-7, 2.0e-6, 1.1e-5), "double": (7.2e-16, 1.1e-15, 4.9e-15, 2.3e-14)},
    ),
}
TIMES = (1e-5, 1e-2, 0.1, 1.0, 3.0, 8.0, 20.0, 60.0, 100.0)
SPANS = (3.0, 30.0, 100.0)


@both_precisions
@pytest.mark.parametrize("regime", SWEEPS)
def test_sweeps(regime: str, precision: str, opencl_device: Device) -> None:
    rows, measured = SWEEPS[regime]
    times = np.minimum(TIMES, LAST_TIME[precision])
    rays = [(row, t) for row in rows() for t in times]
    u, t, off = errors_of(rays, precision, opencl_device)
    check(f"{regime}: point", precision, (u, t), off.points, measured[precision][0])
    for start, end, stated in zip((0, *SPANS), SPANS, measured[precision][1:], strict=False):
        now = (t > start) & (t <= end)
        check(f"{regime}: direction, t <= {end:g}", precision, (u[now], t[now]), off.directions[now], stated)


# -- walks over every branch ---------------------------------------------------------------------------------


def with_m(m: float, up: float) -> tuple[float, float, float]:
    """The direction with a > b, ab = m and c = up."""
    plus, minus = np.sqrt(1 - up * up + 2 * m), np.sqrt(max(1 - up * up - 2 * m, 0.0))
    return (plus + minus) / 2, (plus - minus) / 2, up


def with_complement(complement: float, up: float = 0.3) -> tuple[float, float, float]:
    """k'^2 = 4m/(1 + 2m)."""
    square = complement**2
    return with_m(square / (4 - 2 * square), up)


def speed(row: Sequence[float]) -> float:
    """The phase that passes in a unit of time, mu."""
    return float(np.sqrt(1 + 2 * row[0] * row[1]))


def over_modulus(precision: str) -> Iterator[Ray]:
    """CLOSED_BELOW, in k, at short and long phases, and where half periods are taken off."""
    for e in both_sides(precision):
        k = constant(PHASE_PART, "CLOSED_BELOW", precision) * (1 + e)
        row = with_complement(np.sqrt((1 - k) * (1 + k)), 0.1)
        yield from ((row, t) for t in (0.3, 1.5, 2.5, 3.0, 9.0))


def over_short_phase(precision: str) -> Iterator[Ray]:
    """SHORT_PHASE, in mu t/2."""
    for row in ((0.6, 0.64, 0.48), (0.7, 0.7, 0.1), (1e-3, 0.6, -0.8), (1e-20, 0.0, 1.0), (0.0, 0.6, 0.8)):
        for e in both_sides(precision):
            yield row, 2 * SHORT_PHASE / speed(row) * (1 + e)


def over_planar(precision: str) -> Iterator[Ray]:
    """PLANAR_BELOW, in k' e^v at v = mu t/2."""
    for t in (2.5, 8.0, 25.0):
        for up in (0.6, -0.6, 0.0):
            for e in both_sides(precision):
                complement = constant(PHASE_PART, "PLANAR_BELOW", precision) * np.exp(-t / 2) * (1 + e)
                a, _, c = with_complement(complement, up)
                # Of a small m the difference has no digits.
                row = (a, complement**2 / 4 / a, c)
                yield from ((row, t), ((row[1], row[0], c), t))
    for t in (2.5, 8.0, 25.0):
        for e in both_sides(precision):
            small = constant(PHASE_PART, "PLANAR_BELOW", precision) * np.exp(-t / 2) * (1 + e) / 2
            yield from (((small, small, sign), t) for sign in (1, -1))


def over_half_tangent(precision: str) -> Iterator[Ray]:
    """HALF_TANGENT_BELOW, in tanh(z/2), at its first crossing and at others."""
    height = 2 * np.arctanh(constant(FLOW_PART, "HALF_TANGENT_BELOW", precision))
    for row in ((0.3, 0.2, 0.9), (1e-3, 0.0, 1.0), (0.2, 0.7, 0.1), (1e-9, 0.4, -0.9)):
        start = row / np.linalg.norm(row)
        times = np.linspace(0.05, 12, 400)
        z = np.array([float(sol.known_flow(*map(float, start), float(t)).point[2]) for t in times])
        for n in np.flatnonzero(np.diff(np.abs(z) > height))[:3]:
            t = bisected(
                lambda t, start=start: abs(sol.flow(start, t).point[2]) - height, times[n], times[n + 1]
            )
            yield from ((row, t * (1 + e)) for e in both_sides(precision))


def bisected(f: Callable[[float], Any], low: float, high: float) -> float:
    rising = f(high) > 0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if (f(middle) > 0) == rising else (middle, high)
    return low


def over_half_periods(precision: str) -> Iterator[Ray]:
    """Whole half periods, which are taken off, and quarters of the phase."""
    for row in ((0.6, 0.64, 0.48), (1e-3, 0.6, -0.8), (1e-2, 1e-3, 1.0), (0.7, 0.72, 1e-3), (1.0, 1.0, 0.0)):
        u = sol.directions([row], "double")
        half = float(sol.periods(u)[0]) / 2
        for count in (0.5, 1, 2, 3, 10):
            if half * count < 60:
                yield from ((row, half * count * (1 + e)) for e in both_sides(precision))


WALKS = {
    "k over CLOSED_BELOW": (over_modulus, {"single": (3.7e-7, 6.8e-7), "double": (5.4e-16, 1.7e-15)}),
    "v over SHORT_PHASE": (over_short_phase, {"single": (5.9e-7, 2.4e-7), "double": (5.4e-16, 6.3e-16)}),
    "k' e^v over PLANAR_BELOW": (over_planar, {"single": (2.3e-7, 1.2e-7), "double": (5.7e-16, 4.0e-16)}),
    "tanh(z/2) over HALF_TANGENT_BELOW": (
        over_half_tangent,
        {"single": (3.5e-7, 3.4e-7), "double": (1.1e-15, 6.9e-16)},
    ),
    "t over half periods": (over_half_periods, {"single": (4.7e-7, 1.2e-6), "double": (6.2e-16, 2.3e-15)}),
}


@both_precisions
@pytest.mark.parametrize("walk", WALKS)
def test_walks(walk: str, precision: str, opencl_device: Device) -> None:
    rays, measured = WALKS[walk]
    u, t, off = errors_of(list(rays(precision)), precision, opencl_device)
    for name, values, stated in zip(off._fields, off, measured[precision], strict=True):
        check(f"{walk}: {name}", precision, (u, t), values, stated)


def test_planes_go_on_to_the_end_of_double_precision(opencl_device: Device) -> None:
    """PHASE_END, in mu t/2: from there on k' e^v is not worked out, which must not make a geodesic planar;
    and in a plane heights go on to 709."""
    end = min(2 * constant(PHASE_PART, "PHASE_END", "double"), 600.0)
    rows = ((0.6, 0.0, 0.8), (0.0, 0.6, 0.8), (0.6, 1e-100, 0.8), (1e-60, 1e-60, 1.0), (1e-100, 1e-100, 1.0))
    rays = [(row, t) for row in rows for t in (0.99 * end, 1.01 * end, 200.0, 300.0, 620.0)]
    u, t, off = errors_of(rays, "double", opencl_device)
    check("beyond PHASE_END: point", "double", (u, t), off.points, 1e-15)
    check("beyond PHASE_END: direction", "double", (u, t), off.directions, 1e-13)


# -- the integral of second kind -----------------------------------------------------------------------------

INTEGRAL = Body(
    3,
    1,
    """agm mean = agm_of(IN(0), IN(1));
  real c, d, excess, s = jacobi(&mean, IN(2), &c, &d, &excess);
  OUT(0, height_integral(IN(2), s, c, d, IN(0), IN(1), excess));""",
)
SHORT = Body(
    2,
    5,
    "phase p = short_phase(IN(0), IN(1)); OUT(0, p.s); OUT(1, p.c); OUT(2, p.d); OUT(3, p.ratio);"
    "OUT(4, p.integral);",
)
PARTS = ("lanes.h", "special/elementary.h", "special/jacobi.h")


@functools.cache
def integral_kernels(device: Device, precision: str, ascents: int) -> SmallKernels:
    text = re.sub(r"(?<=#define ASCENTS )\d", str(ascents), PHASE)
    return SmallKernels(device, PARTS, {"integral": INTEGRAL, "short": SHORT}, precision, 4, text)


def integral_errors(device: Device, precision: str, ascents: int, complements: Sequence[float]) -> Array:
    """Errors (M,N) of I at the moduli, over phases v up to K, relative to v: I is v^3/12 where v is small."""
    rows, want = [], []
    for complement in cut(complements, precision):
        k = MP.sqrt((1 - MP.mpf(complement)) * (1 + MP.mpf(complement)))
        quarter = min(float(MP.ellipk(k * k)), 40.0) if complement else 40.0
        for v in cut(quarter * np.array([1e-3, 0.1, 0.4, 0.7, 0.9, 0.99]), precision):
            rows.append((float(k), complement, v))
            want.append(sol.height_integral(v, complement))
    got = integral_kernels(device, precision, ascents).run("integral", np.array(rows).T)[0]
    off = [abs(float((MP.mpf(float(g)) - w) / row[2])) for g, w, row in zip(got, want, rows, strict=True)]
    return np.array(off).reshape(len(complements), -1)


# Largest error, measured.
INTEGRAL_ERROR = {"single": 8.2e-7, "double": 1.7e-15}


@both_precisions
def test_the_integral_on_both_sides_of_the_closed_form(precision: str, opencl_device: Device) -> None:
    """CLOSED_BELOW: I keeps its digits over all k, next to where the formula changes and far from it."""
    seam = constant(PHASE_PART, "CLOSED_BELOW", precision)
    moduli = np.array(
        [*(seam * (1 + e) for e in both_sides(precision) if seam * (1 + e) < 1), 0.3, 0.05, 1e-3]
    )
    complements = [*np.sqrt((1 - moduli) * (1 + moduli)), 0.4, 0.1, 1e-2, 1e-4, 1e-8, 1.0]
    ascents = int(constant(PHASE_PART, "ASCENTS", precision))
    off = integral_errors(opencl_device, precision, ascents, complements)
    print(f"{precision} I {off.max():.1e}")
    assert off.max() <= 2 * INTEGRAL_ERROR[precision], (complements, off)


@both_precisions
def test_one_ascent_fewer_is_too_few(precision: str, opencl_device: Device) -> None:
    """ASCENTS: just above CLOSED_BELOW what the last one adds counts."""
    k = constant(PHASE_PART, "CLOSED_BELOW", precision) * 1.001
    ascents = int(constant(PHASE_PART, "ASCENTS", precision))
    off, more = (
        integral_errors(opencl_device, precision, n, [np.sqrt((1 - k) * (1 + k))]).max()
        for n in (ascents - 1, ascents)
    )
    assert more <= 2 * INTEGRAL_ERROR[precision] < off, (more, off)


def test_series_of_short_phases(opencl_device: Device) -> None:
    """Up to SHORT_PHASE over all k: the functions, their ratio and I, in units of EPSILON."""
    phases, moduli = (1e-4, 1e-2, 0.2, 0.5, 0.8, 0.99, SHORT_PHASE), (0, 1e-3, 0.3, 0.6, 0.9, 0.999, 1)
    v, k = (a.ravel() for a in np.meshgrid(phases, moduli))
    v, k = cut(v, "single"), cut(k, "single")
    got = integral_kernels(opencl_device, "single", 2).run("short", [v, k]).astype(float)
    want = np.zeros_like(got)
    for n, (phase, modulus) in enumerate(zip(v, k, strict=True)):
        complement = MP.sqrt((1 - MP.mpf(modulus)) * (1 + MP.mpf(modulus)))
        s, c, d = (MP.ellipfun(name, MP.mpf(phase), m=MP.mpf(modulus) ** 2) for name in ("sn", "cn", "dn"))
        want[:, n] = [float(x) for x in (s, c, d, s / (d + c), sol.height_integral(phase, complement))]
    off = np.abs(got / want - 1).max(axis=1) / EPSILON["single"]
    print("sn, cn, dn, ratio, I:", off.round(1))
    assert (off <= SHORT_UNITS).all(), off


# I is v^3/12, and counts little beside s.
SHORT_UNITS = (2.0, 2.0, 1.0, 3.0, 20.0)


@both_precisions
@pytest.mark.parametrize("other", [0.4, 0.6])
def test_both_forms_next_to_the_seam_of_beta_sn(
    precision: str, other: float, opencl_device: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    """BETA_SN_ABOVE: on either side of it 1 -+ beta sn keeps its digits."""
    u, t = all_kinds_of_rays(precision), 2.0
    points, ahead = geometry(precision, opencl_device).flow(u, t)
    text, count = re.subn(r"(#define BETA_SN_ABOVE C\()[\d.]+", rf"\g<1>{other}", FLOW)
    assert count == 1
    with monkeypatch.context() as patched:
        patched.setattr(
            thurston_cl.program,
            "kernel_text",
            lambda part: text if part == FLOW_PART else kernel_text(part),
        )
        others, other_ahead = geometry(precision, opencl_device).flow(u, t)
    assert (np.abs(others - points) <= 16 * EPSILON[precision] * np.maximum(1, np.abs(points))).all()
    assert np.abs(other_ahead - ahead).max() <= 16 * EPSILON[precision]


# -- parallel transport --------------------------------------------------------------------------------------


@both_precisions
def test_transport_over_its_steps(precision: str, opencl_device: Device) -> None:
    """TRANSPORT_STEP: one step more from there on, with NODES each; against Taylor's series."""
    step = constant(FLOW_PART, "TRANSPORT_STEP", precision)
    e = 1e-6 if precision == "single" else 1e-12
    rows = ((0.6, 0.64, 0.48), (0.05, 0.03, -1.0), (0.7, 0.7, 1e-3), (-0.5, 0.3, 0.8))
    times = [step * k * (1 + sign * e) for k in (1, 2) for sign in (-1, 0, 1)] + [1e-3]
    u = sol.directions([row for row in rows for _ in times], precision)
    t = cut(np.tile(times, len(rows)), precision)
    got = geometry(precision, opencl_device).transport(u, t)
    off = np.array(
        [
            np.abs(exact(turn) - taylor_transport(*map(float, ray), float(time))).max()
            for turn, ray, time in zip(got, u, t, strict=True)
        ],
        dtype=float,
    )
    check(
        "transport over TRANSPORT_STEP",
        precision,
        (u, t),
        off,
        {"single": 5.5e-7, "double": 1.5e-15}[precision],
    )


@functools.cache
def taylor_transport(a: float, b: float, c: float, t: float) -> Any:
    return sol.taylor([a, b, c], t, order=26).transport


def rotation_errors(g: Geometry, u: Array, t: float) -> tuple[float, float]:
    """How far transport is from a rotation, and from carrying the direction along."""
    turn, (_, ahead) = g.transport(u, t), g.flow(u, t)
    square = np.einsum("nij,nkj->nik", turn, turn)
    return np.abs(square - np.eye(3)).max(), np.abs(np.einsum("nij,nj->ni", turn, u) - ahead).max()


def all_kinds_of_rays(precision: str) -> Array:
    return sol.directions([*vertical(), *straight(), *a_small(), *random_rays()], precision)


@both_precisions
def test_transport_is_a_rotation_that_carries_the_direction_along(
    precision: str, opencl_device: Device
) -> None:
    """From pole to pole, in planes, along straight lines; and back again it is the inverse."""
    g, u = geometry(precision, opencl_device), all_kinds_of_rays(precision)
    for t in (1e-5, 0.4, -0.4, 1.0):
        assert max(rotation_errors(g, u, t)) <= 48 * EPSILON[precision] * (1 + abs(t)), t
    back = g.transport(sol.directions(g.flow(u, 1.0)[1], precision), -1.0)
    product = np.einsum("nij,njk->nik", back, g.transport(u, 1.0))
    assert np.abs(product - np.eye(3)).max() <= 128 * EPSILON[precision]


@both_precisions
def test_transport_stays_a_rotation(precision: str, opencl_device: Device) -> None:
    g, u = geometry(precision, opencl_device), all_kinds_of_rays(precision)
    for t in (3.0, -3.0, 15.0, 40.0):
        assert rotation_errors(g, u, t)[0] <= 8 * EPSILON[precision] * (1 + abs(t)), t


@both_precisions
def test_transport_ends_at_its_bound(precision: str, opencl_device: Device) -> None:
    """MOST_STEPS: beyond there is no number, and no waiting for one."""
    most = constant(FLOW_PART, "MOST_STEPS", precision) * constant(FLOW_PART, "TRANSPORT_STEP", precision)
    g, u = geometry(precision, opencl_device), np.array([0.5, 0.5, 0.0]) * np.sqrt(2.0)
    for t, known in ((most * 0.999, True), (most * 1.001, False), (1e30, False), (-1e30, False)):
        assert np.isfinite(g.transport(u, t)).all() == known, t


# -- identities ----------------------------------------------------------------------------------------------

component = st.one_of(st.floats(-1, 1), st.floats(-20, 0).map(lambda p: 10.0**p), st.just(0.0))
drawn_row = st.tuples(component, component, component).filter(lambda r: max(map(abs, r)) > 1e-3)
coordinate = st.floats(-2.0, 2.0)
identity = settings(max_examples=40)


@identity
@given(
    row=drawn_row, s=st.floats(-3, 3), t=st.floats(-3, 3), base=st.tuples(coordinate, coordinate, coordinate)
)
@both_precisions
def test_flows_add_up(precision: str, row: Any, s: float, t: float, base: Any, opencl_device: Device) -> None:
    """flow(s), then flow(t), is flow(s + t); from anywhere it is the translate of the flow from 0."""
    g = geometry(precision, opencl_device)
    u, start = sol.directions([row], precision), np.array([[*base, 1.0]])
    middle, ahead = g.flow(u, s)
    got, last = g.flow(ahead, t, middle)
    want, end = g.flow(u, s + t)
    # Errors made on the way grow as geodesics part.
    units = 16 * EPSILON[precision] * np.exp(abs(s) + abs(t))
    assert sol.errors(want, got)[0] <= units
    assert np.abs(last - end).max() <= units
    moved, same = g.flow(u, s + t, start)
    assert sol.errors(g.translate(start, want), moved)[0] <= 16 * EPSILON[precision]
    assert (same == end).all()


@identity
@given(row=drawn_row, t=st.floats(-30, 30))
@both_precisions
def test_first_integrals(precision: str, row: Any, t: float, opencl_device: Device) -> None:
    """Speed, u_x u_y, u_z + a x - b y, and u_x = a e^z, u_y = b e^-z."""
    u = sol.directions([row], precision)
    (p,), (end,) = geometry(precision, opencl_device).flow(u, t)
    epsilon, (a, b, c), stretch = EPSILON[precision], u[0], np.exp(p[2])
    assert abs(end @ end - 1) <= 8 * epsilon
    # 1e-30: in single precision products vanish below.
    units = epsilon * (8 + 4 * abs(t))
    assert abs(end[0] * end[1] - a * b) <= 4 * units * abs(a * b) + 1e-30
    assert abs(end[0] - a * stretch) <= 4 * units * (abs(end[0]) + 1e-30) * (1 + abs(p[2]))
    assert abs(end[1] - b / stretch) <= 4 * units * (abs(end[1]) + 1e-30) * (1 + abs(p[2]))
    assert abs(end[2] + a * p[0] - b * p[1] - c) <= 4 * units * (1 + abs(a * p[0]) + abs(b * p[1]))


@identity
@given(row=drawn_row, t=st.floats(0, 30))
@both_precisions
def test_symmetries(precision: str, row: Any, t: float, opencl_device: Device) -> None:
    """x -> -x, y -> -y and t -> -t change signs only; (x, y, z) -> (y, x, -z), what rounding does."""
    g = geometry(precision, opencl_device)
    u = sol.directions([row], precision)
    p, end = g.flow(u, t)
    for signs in ((-1, 1, 1), (1, -1, 1), (-1, -1, 1)):
        mirrored, ahead = g.flow(u * signs, t)
        np.testing.assert_array_equal(mirrored, p * (*signs, 1))
        np.testing.assert_array_equal(ahead, end * signs)
    behind, back = g.flow(-u, -t)
    np.testing.assert_array_equal(behind, p)
    np.testing.assert_array_equal(back, -end)
    units = 16 * EPSILON[precision]
    exchanged, ahead = g.flow(u[:, [1, 0, 2]] * [1, 1, -1], t)
    assert sol.errors(p, exchanged[:, [1, 0, 2, 3]] * [1, 1, -1, 1])[0] <= units
    assert np.abs(ahead[:, [1, 0, 2]] * [1, 1, -1] - end).max() <= units * (1 + t)


@both_precisions
def test_no_time_is_no_change(precision: str, opencl_device: Device) -> None:
    u = sol.directions(list(random_rays()), precision)
    p, end = geometry(precision, opencl_device).flow(u, 0.0)
    np.testing.assert_array_equal(p, np.broadcast_to([0, 0, 0, 1], p.shape))
    assert np.abs(end - u).max() <= 2 * EPSILON[precision]


# -- lanes, widths, NaN --------------------------------------------------------------------------------------


@functools.cache
def mixture(precision: str) -> tuple[Array, Array]:
    """Rays of all regimes, so that neighbours take different branches."""
    rng = np.random.default_rng(2)
    rows = np.array([row for sweep, _ in SWEEPS.values() for row in sweep()])
    t = rng.choice([1e-5, 0.1, 1.0, 3.0, 8.0, 20.0, 80.0], len(rows))
    order = rng.permutation(len(rows))
    return sol.directions(rows[order], precision), cut(t, precision)


@both_precisions
def test_a_ray_does_not_depend_on_its_neighbours(precision: str, opencl_device: Device) -> None:
    """To the last bit: alone, which fills a packet, and among others."""
    g = geometry(precision, opencl_device)
    u, t = mixture(precision)
    together = np.concatenate(g.flow(u, t), axis=1)
    for n in range(0, len(t), 4):
        np.testing.assert_array_equal(
            np.concatenate(g.flow(u[n], t[n]), axis=1)[0], together[n], f"{u[n]} {t[n]}"
        )


@both_precisions
def test_all_widths_agree(precision: str, opencl_device: Device) -> None:
    """But for the last digits, of exp and log, which a runtime may round otherwise in vectors."""
    u, t = mixture(precision)
    want, end = geometry(precision, opencl_device, 1).flow(u, t)
    for lanes in (4, 16, 32):
        got, ahead = geometry(precision, opencl_device, lanes).flow(u, t)
        assert sol.errors(want, got).max() <= 8 * EPSILON[precision], lanes
        assert np.abs(ahead - end).max() <= 64 * EPSILON[precision], lanes


@both_precisions
def test_nowhere_a_nan(precision: str, opencl_device: Device) -> None:
    """Down to components that are denormal, up to the last time: still unit vectors, not too far away."""
    tiny = float(np.finfo(FLOAT[precision]).smallest_subnormal)
    least = int(np.log10(tiny))
    small = [0.0, tiny, 3 * tiny, *10.0 ** np.arange(least, 0, 3 if precision == "single" else 20), 1.0]
    rows = np.array([(a, b, c) for a in small for b in small for c in (1, -1, 0) if (a, b, c) != (0, 0, 0)])
    u = cut(rows / np.abs(rows).max(axis=1, keepdims=True), precision)
    u = cut(u / np.linalg.norm(u, axis=1, keepdims=True), precision)
    g = geometry(precision, opencl_device)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for t in (1e-38, 1e-5, 0.5, 1.9, 2.1, 10.0, 40.0, LAST_TIME[precision]):
            p, end = g.flow(u, t)
            assert np.isfinite(p).all() and np.isfinite(end).all(), t
            assert (np.abs(p[:, 2]) <= t * (1 + 1e-5)).all(), t
            assert np.abs((end**2).sum(axis=1) - 1).max() <= 8 * EPSILON[precision], t
            area = g.area_density(u[::7], min(t, 10.0))
            assert np.isfinite(area).all() and (area >= 0).all(), t
    assert np.isfinite(g.transport(u[::7], 20.0)).all()
