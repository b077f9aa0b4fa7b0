"""kernels/special/jacobi.h and thurston_cl.special against mpmath, SciPy and tests/data/sol_flow.json: within
the ACCURACY table of the head, in both precisions, at widths 1, 4, 16 and 32; every constant walked over from
both sides; identities; messages."""

import functools
import json
import re
import subprocess
import sys
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pytest
import scipy.special
from golden import DATA, EPSILON, FLOAT, MP, Array, constant, cut, exact
from hypothesis import given
from hypothesis import strategies as st
from small_kernels import Body, SmallKernels

import thurston_cl as tc
from thurston_cl.device import Device
from thurston_cl.program import kernel_text
from thurston_cl.special import ARGUMENT_LIMIT

PART = "special/jacobi.h"
HEAD = kernel_text(PART)
PARTS = ("lanes.h", "special/elementary.h")
BODY = Body(
    3,
    7,
    """agm m = agm_of(IN(0), IN(1));
  real cosine, delta, zeta, excess;
  OUT(0, m.quarter);
  OUT(1, mean_excess(&m));
  OUT(2, jacobi_zeta(&m, IN(2), &cosine, &delta, &zeta));
  OUT(3, cosine);
  OUT(4, delta);
  OUT(5, zeta);
  jacobi(&m, IN(2), &cosine, &delta, &excess);
  OUT(6, excess);""",
)
FUNCTIONS = ("sn", "cn", "dn", "zeta")
both_precisions = pytest.mark.parametrize("precision", EPSILON)
all_kernels = pytest.mark.parametrize(
    ("precision", "lanes"), [(precision, lanes) for precision in EPSILON for lanes in (1, 4, 16, 32)]
)
BOTH_SIDES = [sign * 10.0**-n for sign in (-1, 1) for n in (3, 6, 9, 12, 15)] + [0.0]


# -- truth ---------------------------------------------------------------------------------------------------


class Case(NamedTuple):
    """An argument u and the parameter, `given` as "m", as "m1" = 1 - m or as "complement" k'; all exact."""

    given: str
    parameter: float
    u: float = 0.0

    @property
    def m(self) -> Any:
        """At the precision of the moment."""
        p = MP.mpf(self.parameter)
        return {"m": p, "m1": 1 - p, "complement": 1 - p * p}[self.given]

    @property
    def m1(self) -> Any:
        p = MP.mpf(self.parameter)
        return {"m": 1 - p, "m1": p, "complement": p * p}[self.given]

    @property
    def quarter(self) -> float:
        return float(scipy.special.ellipkm1(float(self.m1)))

    def at(self, u: float, precision: str = "single") -> "Case":
        """With another argument, rounded to the precision."""
        return self._replace(u=float(cut(u, precision)))


class Truth(NamedTuple):
    """Whether |u| <= K; m; what mpmath says; and in what units the table of the head states errors."""

    inside: bool
    m: Any
    values: dict[str, Any]
    units: dict[str, Any]


@functools.cache
def truth(case: Case) -> Truth:
    with MP.workdps(50):
        small = min(x for x in (case.m, case.m1) if x > 0)
    # The digits that are lost where 1 - m is formed, and half as many in theta functions.
    with MP.workdps(50 - int(1.5 * MP.log10(small))):
        m, u = case.m, MP.mpf(case.u)
        if m == 1:
            K, E, ratio, halves = MP.inf, MP.mpf(1), MP.mpf(0), 0
            sn, cn, dn, zeta = MP.tanh(u), MP.sech(u), MP.sech(u), MP.tanh(u)
        else:
            K, E = MP.ellipk(m), MP.ellipe(m)
            ratio, halves = E / K, int(MP.nint(u / (2 * K)))
            sn, cn, dn = (MP.ellipfun(name, u, m=m) for name in ("sn", "cn", "dn"))
            turn = (-1) ** halves
            epsilon = MP.ellipe(MP.atan2(turn * sn, turn * cn), m)
            zeta = epsilon - ratio * (u - 2 * K * halves) if m > 0 else MP.mpf(0)
        values = {"sn": sn, "cn": cn, "dn": dn, "zeta": zeta}
        slopes = {"sn": cn * dn, "cn": sn * dn, "dn": m * sn * cn, "zeta": dn**2 - ratio}
        units = {name: abs(values[name]) + abs(u * slopes[name]) for name in FUNCTIONS}
        integrals = {"K": K, "E": E, "mean_excess": 1 - ratio}
        excess = {"excess": u * (1 - ratio) - zeta} if halves == 0 else {}
        return Truth(
            abs(u) <= K,
            m,
            {**values, **integrals, **excess},
            {**units, **integrals, "excess": m * abs(u)},
        )


@functools.cache
def sample() -> list[Case]:
    """At random, next to 0 and next to multiples of K; with the ends of m."""
    rng = np.random.default_rng(5)
    parameters = [("m", 0.0), ("m", 1e-300), ("m", 0.5), ("m", 1 - 2.0**-53), ("m1", 1.0), ("m1", 2.0**-126)]
    for _ in range(250):
        parameters += [
            ("m", rng.uniform(0, 1)),
            ("m", 10 ** rng.uniform(-12, -0.3)),
            ("m", 1 - 10 ** rng.uniform(-12, -0.3)),
            ("m1", 10 ** rng.uniform(-6, -0.3)),
            ("m1", 10 ** rng.uniform(-30, -0.3)),
            ("m1", 10 ** rng.uniform(-37, -10)),
        ]
    cases = []
    for n, (name, parameter) in enumerate(parameters):
        case = Case(name, float(parameter))
        K, sign = case.quarter, rng.choice([-1, 1])
        u = [
            rng.uniform(-100, 100),
            rng.uniform(-K, K),
            sign * 10 ** rng.uniform(-6, 0),
            K * (rng.integers(-2, 3) + sign * 10 ** rng.uniform(-6, -1)),
        ]
        cases.append(case.at(np.clip(u[n % 4], -100, 100)))
    return cases


# -- errors in units of the table ----------------------------------------------------------------------------


class Row(NamedTuple):
    """A row of the table: the largest errors for m in an interval and |u| on one side of K, or on both."""

    lowest: float
    highest: float
    side: str
    limits: dict[str, float]


@functools.cache
def table() -> dict[str, list[Row]]:
    number = {"0": 0.0, "1/2": 0.5, "1": 1.0}
    pattern = r"^//   (\w+) +([01/2]+) to ([01/2]+) +(-|to K|K to 100) +(\d+) +(\d+)$"
    rows: dict[str, list[Row]] = {}
    for name, lowest, highest, side, single, double in re.findall(pattern, HEAD, re.MULTILINE):
        limits = {"single": float(single), "double": float(double)}
        rows.setdefault(name, []).append(Row(number[lowest], number[highest], side, limits))
    return rows


def stated(name: str, case: Case, precision: str) -> float:
    m, inside = truth(case).m, truth(case).inside
    rows = [row for row in table()[name] if row.side != ("K to 100" if inside else "to K")]
    return max(row.limits[precision] for row in rows if row.lowest <= m <= row.highest)


def units_off(name: str, got: Array, cases: Sequence[Case], precision: str) -> list[float]:
    """The errors, in EPSILON times the unit of the table."""
    least = float(np.finfo(FLOAT[precision]).tiny)  # numbers below have fewer digits
    errors = []
    for value, case in zip(exact(got), cases, strict=True):
        want, unit = truth(case).values[name], truth(case).units[name]
        off = 0 if value == want else abs(value - want) / max(unit, least)
        errors.append(float(off) / EPSILON[precision])
    return errors


def check(name: str, got: Array, cases: Sequence[Case], precision: str, more: float = 0) -> None:
    """Every error must be within the table, or as much more."""
    for off, case, value in zip(units_off(name, got, cases, precision), cases, got, strict=True):
        limit = stated(name, case, precision) + more
        assert off <= limit, f"{name} of {case}: {value}, {off:.2f} units off, stated {limit}"


def check_all(
    cases: Sequence[Case], precision: str, device: Device, lanes: int = 16, more: float = 0
) -> None:
    """What `tc.special` returns."""
    for name in {case.given for case in cases}:
        alike = [case for case in cases if case.given == name]
        parameter: dict[str, Any] = {name: [case.parameter for case in alike]}
        setting: dict[str, Any] = {"precision": precision, "device": device, "lanes": lanes}
        for integral, got in zip("KE", tc.special.elliptic_ke(**parameter, **setting), strict=True):
            check(integral, got, alike, precision, more)
        found = tc.special.jacobi([case.u for case in alike], **parameter, **setting)
        for function, got in zip(FUNCTIONS, found, strict=True):
            check(function, got, alike, precision, more)


def test_the_table_covers_everything() -> None:
    assert table().keys() == {"K", "E", "mean_excess", "excess", *FUNCTIONS}
    for name, rows in table().items():
        for side in {row.side for row in rows}:
            intervals = [(row.lowest, row.highest) for row in rows if row.side == side]
            assert intervals in ([(0, 1)], [(0, 0.5), (0.5, 1)]), (name, side)
        assert len({row.side for row in rows}) == (2 if name in FUNCTIONS else 1)


@all_kernels
def test_accuracy_of_the_head(precision: str, lanes: int, opencl_device: Device) -> None:
    check_all(sample(), precision, opencl_device, lanes)


# -- tests/data/sol_flow.json --------------------------------------------------------------------------------


def records() -> list[tuple[Case, dict[str, str]]]:
    """All elliptic records; of m and m1 the one with more digits as binary64, and x so too."""
    data = json.loads((DATA / "sol_flow.json").read_text(encoding="utf-8"))["elliptic"]
    cases = []
    for record in data:
        name = "m" if float(record["m"]) < 0.5 else "m1"
        cases.append((Case(name, float(record[name]), float(record.get("x", 0))), record))
    return cases


@all_kernels
def test_golden_records(precision: str, lanes: int, opencl_device: Device) -> None:
    """Within a unit more, for rounding x and the parameter."""
    assert len(records()) == 100
    for case, record in records():
        setting: dict[str, Any] = {"precision": precision, "device": opencl_device, "lanes": lanes}
        parameter = {case.given: case.parameter}
        names: Sequence[str] = FUNCTIONS
        if record["kind"] == "complete":
            names, found = "KE", tc.special.elliptic_ke(**parameter, **setting)
        else:
            found = tc.special.jacobi(case.u, **parameter, **setting)
        for name, got in zip(names, found, strict=True):
            want, limit = MP.mpf(record[name]), stated(name, case, precision) + 1
            off = abs(MP.mpf(float(got)) - want)
            assert off <= limit * EPSILON[precision] * truth(case).units[name], (record, name, float(got))


# -- the functions that kernels call -------------------------------------------------------------------------


@functools.cache
def inside_quarter(precision: str) -> list[Case]:
    """k' as small as AGM_STEPS allow, 0 <= u <= K."""
    rng = np.random.default_rng(6)
    smallest = {"single": -12, "double": -24}[precision]
    complements = [*rng.uniform(0, 1, 150), *10 ** rng.uniform(smallest, 0, 250), 10.0**smallest, 1.0]
    cases = []
    for n, complement in enumerate(complements):
        case = Case("complement", float(cut(complement, precision)))
        fraction = rng.uniform(0, 1) if n % 2 else 10 ** rng.uniform(-5, 0)
        cases.append(case.at(fraction * case.quarter, precision))
    return cases


def moduli(cases: Sequence[Case]) -> Array:
    """k, k' and u as rows."""
    ks = [float(MP.sqrt(truth(case).m)) for case in cases]
    return np.array([ks, [case.parameter for case in cases], [case.u for case in cases]])


@all_kernels
def test_functions_of_both_moduli(precision: str, lanes: int, opencl_device: Device) -> None:
    cases = inside_quarter(precision)
    kernels = SmallKernels(opencl_device, (*PARTS, "special/jacobi.h"), {"jacobi": BODY}, precision, lanes)
    got = kernels.run("jacobi", moduli(cases)).astype(float)
    for name, values in zip(("K", "mean_excess", *FUNCTIONS, "excess"), got, strict=True):
        check(name, values, cases, precision)
    sn, cn = got[2:4]
    assert (sn <= 1).all() and (cn >= 0).all()


@both_precisions
def test_the_mean_for_any_complement(precision: str, opencl_device: Device) -> None:
    """K and the mean excess hold on as k' vanishes; and cn is not negative where rounding passes K."""
    tiny = float(np.finfo(FLOAT[precision]).tiny)
    cases = [Case("complement", float(cut(k, precision))) for k in (1.0, 1e-3, 1e-9, 1e-20, 1e-37, tiny)]
    kernels = SmallKernels(opencl_device, (*PARTS, "special/jacobi.h"), {"jacobi": BODY}, precision, 16)
    got = kernels.run("jacobi", moduli(cases)).astype(float)
    check("K", got[0], cases, precision)
    check("mean_excess", got[1], cases, precision)
    assert kernels.run("jacobi", [[1.0], [0.0], [1.0]])[0] == np.inf
    beyond = moduli([case.at(case.quarter * (1 + 1e-6)) for case in cases[:3]])
    assert (kernels.run("jacobi", beyond)[3] == 0).all()


# -- named constants -----------------------------------------------------------------------------------------


def with_steps(steps: int) -> str:
    return re.sub(r"(?<=#define AGM_STEPS )\d+", str(steps), HEAD)


@both_precisions
def test_steps_of_the_mean(precision: str, opencl_device: Device) -> None:
    """AGM_STEPS: k' needs as many steps as the head says, and one fewer are too few."""
    words = {"single": "float", "double": "double"}
    rows = {
        word: line.split()
        for word, line in re.findall(r"^//   (k'|float|double)  +(\d.*)$", HEAD, re.MULTILINE)[-3:]
    }
    needed = dict(zip(map(float, rows["k'"]), map(int, rows[words[precision]]), strict=False))
    (allowed,) = re.findall(r"errors of at most (\d+) units", HEAD)
    (smallest,) = re.findall(rf"k' down to .*?(\S+) \({words[precision]}\)", HEAD)
    fitting = [k for k, steps in needed.items() if steps <= constant(PART, "AGM_STEPS", precision)]
    assert min(fitting) == float(smallest)

    @functools.cache
    def kernels(steps: int) -> SmallKernels:
        return SmallKernels(opencl_device, PARTS, {"jacobi": BODY}, precision, 16, with_steps(steps))

    def error(steps: int, complement: float) -> float:
        case = Case("complement", float(cut(complement, precision)))
        cases = [case.at(case.quarter * x, precision) for x in np.linspace(0.1, 0.999, 10)]
        got = kernels(steps).run("jacobi", moduli(cases)).astype(float)
        names = ("K", *FUNCTIONS)
        return max(
            max(units_off(name, got[row], cases, precision))
            for name, row in zip(names, (0, 2, 3, 4, 5), strict=True)
        )

    for complement, steps in needed.items():
        assert error(steps, complement) <= float(allowed), (complement, steps)
        assert steps == 0 or error(steps - 1, complement) > float(allowed), (complement, steps)


def fractions_of_quarter(case: Case, precision: str) -> list[Case]:
    """u on both sides of the middle, of the end and of the first reduction."""
    parts = (0.01, 0.3, 0.5 - 1e-6, 0.5 + 1e-6, 0.9, 1 - 1e-6, 1 + 1e-6, 1.7, 2.2)
    return [case.at(case.quarter * part, precision) for part in parts]


@both_precisions
def test_where_hyperbolic_functions_begin(precision: str, opencl_device: Device) -> None:
    """HYPERBOLIC_BELOW, at which cn and dn change their formula, and so does K."""
    seam = constant(PART, "HYPERBOLIC_BELOW", precision)
    cases = [Case("m1", (seam * (1 + e)) ** 2) for e in (*BOTH_SIDES, -0.1, 0.1)]
    check_all(
        [at for case in cases for at in fractions_of_quarter(case, precision)], precision, opencl_device
    )


@both_precisions
def test_where_c_is_a_difference(precision: str, opencl_device: Device) -> None:
    """DIFFERENCE_BELOW, passed at the first step or at a later one."""
    ratio = constant(PART, "DIFFERENCE_BELOW", precision)
    cases = []
    for _ in range(4):
        cases += [Case("m1", (ratio * (1 + e)) ** 2) for e in BOTH_SIDES]
        # Of which the next ratio is this one: 2 sqrt(r)/(1 + r).
        ratio = (ratio / (1 + np.sqrt(1 - ratio**2))) ** 2
    check_all(
        [at for case in cases for at in fractions_of_quarter(case, precision)], precision, opencl_device
    )


@both_precisions
def test_where_sech_vanishes(precision: str, opencl_device: Device) -> None:
    """SECH_END, for m = 1: up to there sech is worked out, from there on it is less than TINY."""
    end = constant(PART, "SECH_END", precision)
    least = float(np.finfo(FLOAT[precision]).tiny)
    u = cut([end * (1 + e) for e in BOTH_SIDES], precision)
    below = u[u <= end]
    check_all([Case("m", 1.0, float(x)) for x in (*below, *-below)], precision, opencl_device, more=1)
    beyond = np.array([*u[u > end], 2 * end, ARGUMENT_LIMIT[precision]])
    sn, cn, dn, zeta = tc.special.jacobi(
        np.concatenate([beyond, -beyond]), 1, precision=precision, device=opencl_device
    )
    assert (np.abs(sn) == 1).all() and (sn == zeta).all() and (sn[: len(beyond)] == 1).all()
    assert (cn == dn).all() and (np.abs(cn) <= 1.1 * least).all()


@both_precisions
def test_seams_without_a_name(precision: str, opencl_device: Device) -> None:
    """m = 1/2, where E changes its formula; k of the size of EPSILON and of its root; the ends of m."""
    squares = EPSILON[precision] ** 2 * np.array([0.25, 1, 4]), EPSILON[precision] * np.array([1, 4, 16])
    cases = [Case("m", 0.5 * (1 + e)) for e in BOTH_SIDES]
    cases += [Case("m", float(m) * (1 + e)) for m in np.concatenate(squares) for e in (-1e-3, 0, 1e-3)]
    cases += [Case("m", m) for m in (0.0, 1.0)] + [Case("m1", m1) for m1 in (0.0, 1.0)]
    for case in cases:
        finite = (
            fractions_of_quarter(case, precision) if case.m < 1 else [case.at(u) for u in (0, 1e-6, 1, 20)]
        )
        check_all([*finite, case._replace(u=-1.5)], precision, opencl_device)


# -- other implementations -----------------------------------------------------------------------------------


def test_scipy(opencl_device: Device) -> None:
    """Up to where SciPy's own errors begin: for m > 1 - 1e-9 beyond K/2."""
    m = np.array([0, 1e-12, 1e-3, 0.3, 0.5, 0.9, 0.999, 1 - 1e-6, 1 - 1e-9, 1 - 1e-12])
    m1 = 10.0 ** -np.arange(31)
    K, E = tc.special.elliptic_ke(m, device=opencl_device)
    np.testing.assert_allclose(K, scipy.special.ellipk(m), rtol=1e-15)
    np.testing.assert_allclose(E, scipy.special.ellipe(m), rtol=1e-15)
    np.testing.assert_allclose(
        tc.special.elliptic_ke(m1=m1, device=opencl_device)[0], scipy.special.ellipkm1(m1), rtol=1e-15
    )
    u = np.linspace(-100, 100, 401)[:, None]
    u, m = np.broadcast_arrays(u, m)
    good = (m < 1 - 1e-9) | (np.abs(u) < K / 2)
    got = tc.special.jacobi(u, m, device=opencl_device)
    for found, want in zip(got, scipy.special.ellipj(u, m)[:3], strict=False):
        assert (np.abs(found - want) <= 1e-13 * np.maximum(1, np.abs(u)))[good].all()


# -- identities ----------------------------------------------------------------------------------------------

parameters = st.one_of(st.floats(0, 1), st.floats(-30, 0).map(lambda power: 10.0**power)).map(
    lambda m1: max(m1, 1e-300)
)
arguments = st.floats(-100, 100)
EPS = EPSILON["double"]


def at_one(u: float, m1: float) -> tuple[float, float, float, float]:
    sn, cn, dn, zeta = tc.special.jacobi(u, m1=m1, lanes=1)
    return float(sn), float(cn), float(dn), float(zeta)


@given(arguments, parameters)
def test_squares(u: float, m1: float) -> None:
    sn, cn, dn, _ = at_one(u, m1)
    assert abs(sn * sn + cn * cn - 1) <= 4 * EPS
    # dn^2 + k^2 sn^2 = 1, without cancellation where k is next to 1.
    assert abs(dn * dn - (m1 + (1 - m1) * cn * cn)) <= 8 * EPS * dn * dn


@given(parameters.filter(lambda m1: m1 < 1))
def test_legendre(m1: float) -> None:
    K, E = (float(x) for x in tc.special.elliptic_ke(m1=m1, lanes=1))
    other_K, other_E = (float(x) for x in tc.special.elliptic_ke(m1, lanes=1))
    terms = E * other_K, (other_E - other_K) * K
    assert abs(sum(terms) - np.pi / 2) <= 4 * EPS * (E + K) * other_K


@given(arguments, parameters)
def test_symmetry(u: float, m1: float) -> None:
    sn, cn, dn, zeta = at_one(u, m1)
    assert at_one(-u, m1) == (-sn, cn, dn, -zeta)


@given(st.floats(-20, 20), parameters, st.integers(-3, 3))
def test_periods(u: float, m1: float, halves: int) -> None:
    K = float(tc.special.elliptic_ke(m1=m1, lanes=1)[0])
    moved, turn = u + 2 * K * halves, (-1) ** halves
    sn, cn, dn, zeta = at_one(u, m1)
    wanted = (turn * sn, turn * cn, dn, zeta)
    assert np.abs(np.subtract(at_one(moved, m1), wanted)).max() <= 4 * EPS * (1 + abs(moved) + abs(u))


@given(arguments, parameters)
def test_derivatives(u: float, m1: float) -> None:
    step = 1e-4
    K, E = (float(x) for x in tc.special.elliptic_ke(m1=m1, lanes=1))
    sn, cn, dn, _ = at_one(u, m1)
    slopes = np.subtract(at_one(u + step, m1), at_one(u - step, m1)) / (2 * step)
    wanted = (cn * dn, -sn * dn, -(1 - m1) * sn * cn, dn * dn - E / K)
    assert np.abs(slopes - wanted).max() <= 2 * step**2 + 4 * EPS * (1 + abs(u)) / step


# -- the Python functions ------------------------------------------------------------------------------------


def test_shapes(opencl_device: Device) -> None:
    K, E = tc.special.elliptic_ke([[0.1, 0.2, 0.3]], device=opencl_device)
    assert K.shape == E.shape == (1, 3) and K.dtype == E.dtype == np.float64
    for u, m, shape in ((1, 0.5, ()), ([], 0.5, (0,)), ([[1], [2]], [0.1, 0.2, 0.3], (2, 3))):
        found = tc.special.jacobi(u, m, precision="single", device=opencl_device)
        assert [f.shape for f in found] == [shape] * 4 and all(f.dtype == np.float64 for f in found)


def test_parameters_are_not_rounded(opencl_device: Device) -> None:
    """In single precision m keeps the digits of binary64, next to 0 and next to 1."""
    m = np.array([1e-20, 1 - 1e-12, 1 - 2.0**-53])
    K, _ = tc.special.elliptic_ke(m, precision="single", device=opencl_device)
    np.testing.assert_allclose(K, scipy.special.ellipk(m), rtol=4 * EPSILON["single"])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "neither of m and m1 = 1 - m given; expected one"),
        ({"m": 0.5, "m1": 0.5}, "both of m and m1 = 1 - m given; expected one"),
        ({"m": [0.5, np.nan]}, "m[1] is nan; expected a number from 0 to 1"),
        ({"m": [[0.5, 0], [1.5, -1]]}, "m[1, 0] is 1.5; expected a number from 0 to 1"),
        ({"m": -0.25}, "m is -0.25; expected a number from 0 to 1"),
        ({"m1": [np.inf]}, "m1[0] is inf; expected 0 or a number from 2.2e-308 to 1 in double precision"),
        (
            {"m1": [1, 1e-60], "precision": "single"},
            "m1[1] is 1e-60; expected 0 or a number from 1.2e-38 to 1 in single precision",
        ),
        ({"m": 0.5, "precision": "half"}, "unknown precision 'half'; expected 'single' or 'double'"),
        ({"m": 0.5, "lanes": 3}, "3 lanes; expected one of: 1, 4, 8, 16, 32, 64"),
    ],
)
def test_messages_about_parameters(arguments: dict[str, Any], message: str) -> None:
    for call in (tc.special.elliptic_ke, functools.partial(tc.special.jacobi, 1.0)):
        with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
            call(**arguments)


def test_messages_about_arguments() -> None:
    for u, setting, message in (
        ([0, np.nan], {}, "u[1] is nan; expected a number of at most 1e+09 in double precision"),
        (
            -1e6,
            {"precision": "single"},
            "u is -1000000.0; expected a number of at most 100000 in single precision",
        ),
        ([1, 2], {}, "u has shape (2,) and m has shape (3,); expected shapes that broadcast"),
    ):
        with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
            tc.special.jacobi(u, [0.1, 0.2, 0.3], **setting)


def test_loaded_when_first_used() -> None:
    code = (
        "import sys, thurston_cl as tc; assert 'thurston_cl.special' not in sys.modules; "
        "assert tc.special is sys.modules['thurston_cl.special']"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
