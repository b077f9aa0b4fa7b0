"""kernels/special/elementary.h against 64-bit mantissas: within the ACCURACY table of its head, in both
precisions, at widths 1, 16 and 32; and every branch walked over from both sides.
"""

import functools
import re
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from golden import EPSILON
from numpy.typing import NDArray
from small_kernels import Body, SmallKernels

from thurston_cl.device import Device
from thurston_cl.program import kernel_text

PART = "special/elementary.h"
Wide = NDArray[np.longdouble]

BODIES = {
    "sin_cos": Body(1, 2, "real c; OUT(0, sin_cos(IN(0), &c)); OUT(1, c);"),
    "arc_tangent_2": Body(2, 1, "OUT(0, arc_tangent_2(IN(0), IN(1)));"),
    "log_1p": Body(1, 1, "OUT(0, log_1p(IN(0)));"),
    "area_sinh": Body(1, 1, "OUT(0, area_sinh(IN(0)));"),
    "area_sinh_odd": Body(1, 1, "OUT(0, area_sinh_odd(IN(0)));"),
    "area_cosh": Body(1, 1, "OUT(0, area_cosh(IN(0)));"),
    "sinh_cosh": Body(1, 2, "real c; OUT(0, sinh_cosh(IN(0), &c)); OUT(1, c);"),
    "unit_correction": Body(1, 1, "OUT(0, unit_correction(IN(0)));"),
}
REFERENCES: dict[str, Callable[..., tuple[Any, ...]]] = {
    "sin_cos": lambda x: (np.sin(x), np.cos(x)),
    "arc_tangent_2": lambda y, x: (np.arctan2(y, x),),
    "log_1p": lambda x: (np.log1p(x),),
    "area_sinh": lambda x: (np.arcsinh(x),),
    "area_sinh_odd": lambda x: (np.arcsinh(x),),
    "area_cosh": lambda x: (np.arccosh(x),),
    "sinh_cosh": lambda x: (np.sinh(x), np.cosh(x)),
}
FLOAT: dict[str, type[np.floating[Any]]] = {"single": np.float32, "double": np.float64}
SAMPLES = 200_000

if np.finfo(np.longdouble).nmant <= np.finfo(np.float64).nmant:
    pytest.skip("long double is no wider than double here, so there is no reference", allow_module_level=True)


def stated() -> dict[str, dict[str, float]]:
    """The table of the head: the maximal error of each function in units of EPSILON, by precision."""
    rows = re.findall(r"^//   (\w+) +\S.*?  +(\d+) +(\d+)\b", kernel_text(PART), re.MULTILINE)
    return {name: {"single": float(single), "double": float(double)} for name, single, double in rows}


def samples(name: str, precision: str) -> NDArray[np.floating]:
    """Arguments (inputs, N) over the domain that the head states."""
    rng = np.random.default_rng(1)
    half = SAMPLES // 2
    largest = np.log10(np.finfo(FLOAT[precision]).max)
    if name == "arc_tangent_2":
        angle, radius = rng.uniform(-np.pi, np.pi, SAMPLES), 10 ** rng.uniform(-15, 15, SAMPLES)
        values = np.stack([radius * np.sin(angle), radius * np.cos(angle)])
    else:
        drawn = {
            "sin_cos": (rng.uniform(-1e3, 1e3, half), rng.uniform(-10, 10, half)),
            "log_1p": (
                rng.uniform(-0.5, 1, half),
                10 ** rng.uniform(-30, 30, half),
                -(10 ** rng.uniform(-30, -0.302, half)),
            ),
            # The last doubling before the largest number overflows.
            "area_sinh": (10 ** rng.uniform(-largest + 1, largest - 0.4, half), rng.uniform(0, 10, half)),
            "area_sinh_odd": (
                -(10 ** rng.uniform(-largest + 1, largest - 0.4, half)),
                rng.uniform(-10, 10, half),
            ),
            "area_cosh": (2 * 10 ** rng.uniform(0, largest - 0.4, half), rng.uniform(2, 10, half)),
            "sinh_cosh": (
                rng.uniform(-20, 20, half),
                rng.choice([-1, 1], half) * 10 ** rng.uniform(-20, 0, half),
            ),
        }[name]
        values = np.concatenate(drawn)[None, :]
    return values.astype(FLOAT[precision])


@functools.cache
def reference(name: str, precision: str) -> tuple[NDArray[np.floating], Wide]:
    """Arguments and what they give, to 64 bits."""
    values = samples(name, precision)
    return values, np.array(REFERENCES[name](*values.astype(np.longdouble)))


class Setting(NamedTuple):
    kernels: SmallKernels
    precision: str

    def errors(self, name: str, values: NDArray[np.floating], wanted: Wide | None = None) -> Wide:
        """Errors (outputs, N) in units of EPSILON of the result; of sin_cos absolute, as the head says."""
        values = np.atleast_2d(np.asarray(values, FLOAT[self.precision]))
        if wanted is None:
            wanted = np.array(REFERENCES[name](*values.astype(np.longdouble)))
        off = np.abs(self.kernels.run(name, values).astype(np.longdouble) - wanted)
        if name != "sin_cos":
            # Numbers below the least normal one have no more relative accuracy.
            off = np.where(
                off == 0, 0, off / np.maximum(np.abs(wanted), np.finfo(FLOAT[self.precision]).tiny)
            )
        return off / EPSILON[self.precision]

    def check(self, name: str, values: NDArray[np.floating], wanted: Wide | None = None) -> None:
        """Every error must be within the table of the head."""
        values = np.atleast_2d(np.asarray(values, FLOAT[self.precision]))
        errors = self.errors(name, values, wanted)
        limit = stated()[name][self.precision]
        output, worst = np.unravel_index(
            np.argmax(np.where(np.isfinite(errors), errors, np.inf)), errors.shape
        )
        got = self.kernels.run(name, values)[output, worst]
        assert errors[output, worst] <= limit, (
            f"{name}{tuple(values[:, worst].tolist())}, output {output}, {self.precision}, "
            f"width {self.kernels.lanes}: "
            f"got {got!r}, error {errors[output, worst]:.2f} EPSILON, stated {limit}"
        )


@pytest.fixture(
    scope="module", params=[(p, n) for p in FLOAT for n in (1, 16, 32)], ids=lambda p: f"{p[0]}-{p[1]}"
)
def at(request: pytest.FixtureRequest, opencl_device: Device) -> Setting:
    precision, lanes = request.param
    return Setting(SmallKernels(opencl_device, ("lanes.h", PART), BODIES, precision, lanes), precision)


def both_sides(threshold: float, precision: str) -> NDArray[np.floating]:
    """Numbers that approach `threshold` from below and from above, down to its neighbours, and itself."""
    dtype = FLOAT[precision]
    steps = 2.0 ** -np.arange(4, np.finfo(dtype).nmant + 1)
    t = dtype(threshold)
    near = np.concatenate([threshold * (1 - steps), threshold * (1 + steps)]).astype(dtype)
    return np.concatenate(
        [near, [np.nextafter(t, dtype(-np.inf)), t, np.nextafter(t, dtype(np.inf))]]
    ).astype(dtype)


def test_the_head_has_a_row_for_every_function() -> None:
    functions = set(re.findall(r"^FN real (\w+)\(", kernel_text(PART), re.MULTILINE))
    kernels_of_sines = {"sine_kernel", "cosine_kernel"}
    # Of second order, and without rounding: these have tests of their own, here and in tests/stability.
    assert set(stated()) == functions - kernels_of_sines - {"unit_correction", "square_scale"}
    assert set(stated()) == set(REFERENCES)


@pytest.mark.parametrize("name", REFERENCES)
def test_accuracy_of_the_head(at: Setting, name: str) -> None:
    at.check(name, *reference(name, at.precision))


def test_sin_cos_over_the_seams_of_its_reduction(at: Setting) -> None:
    """The quadrant changes at the odd multiples of pi/4, the sign at the multiples of pi/2."""
    for multiple in (*range(1, 17), 635, 636, 1271, 1272):
        x = both_sides(multiple * np.pi / 4, at.precision)
        at.check("sin_cos", np.concatenate([x, -x]))


def test_sin_cos_is_odd_and_even_and_exact_at_zero(at: Setting) -> None:
    x = samples("sin_cos", at.precision)[0]
    plus, minus = at.kernels.run("sin_cos", x), at.kernels.run("sin_cos", -x)
    np.testing.assert_array_equal(minus, plus * np.array([[-1], [1]]))
    np.testing.assert_array_equal(at.kernels.run("sin_cos", [[0.0, -0.0]]), [[0, 0], [1, 1]])


def test_sin_keeps_relative_accuracy_for_small_arguments(at: Setting) -> None:
    x = 10.0 ** np.linspace(-30, -0.2, 500)
    x = x.astype(FLOAT[at.precision])
    got = at.kernels.run("sin_cos", x)[0]
    np.testing.assert_allclose(
        got, np.sin(x.astype(np.longdouble)).astype(float), rtol=2 * EPSILON[at.precision]
    )


def test_sin_cos_of_large_arguments_stays_on_the_circle(at: Setting) -> None:
    """Beyond the domain of the table the three parts of pi/2 still give 1e5 turns to a few EPSILON."""
    x = np.random.default_rng(2).uniform(-1e5, 1e5, 10_000)
    sine, cosine = at.kernels.run("sin_cos", x).astype(float)
    assert np.abs(sine**2 + cosine**2 - 1).max() <= 8 * EPSILON[at.precision]
    at.check("sin_cos", x)


def test_arc_tangent_2_on_the_axes_and_at_the_origin(at: Setting) -> None:
    y = [0, 0, 1, -1, 0, -0.0, 1e-30, -1e-30, 2.5e10]
    x = [1, 0, 0, 0, -1, 1, 1e30, -1e30, -0.0]
    got = at.kernels.run("arc_tangent_2", [y, x])[0].astype(float)
    want = np.array([0, 0, np.pi / 2, -np.pi / 2, np.pi, -0.0, 0, -np.pi, np.pi / 2])
    np.testing.assert_allclose(got, want, rtol=EPSILON[at.precision], atol=1e-37)
    assert np.signbit(got[5]) and not np.signbit(got[0])


def test_arc_tangent_2_over_its_seams(at: Setting) -> None:
    """The diagonals, where the quotient is turned over, and the axes, where an argument changes sign."""
    across = both_sides(1, at.precision)
    one = np.ones_like(across)
    tiny = np.concatenate([10.0 ** -np.arange(1, 30), [0]])
    for sy in (1, -1):
        for sx in (1, -1):
            at.check("arc_tangent_2", np.stack([sy * across, sx * one]))
            at.check("arc_tangent_2", np.stack([sy * one, sx * across]))
            at.check("arc_tangent_2", np.stack([sy * np.ones_like(tiny), sx * tiny]))
            at.check("arc_tangent_2", np.stack([sy * tiny[:-1], sx * np.ones_like(tiny[:-1])]))


def test_log_1p_and_area_sinh_near_zero(at: Setting) -> None:
    x = np.concatenate([[0.0], 10.0 ** np.linspace(-37, -1, 400)])
    at.check("log_1p", x)
    at.check("log_1p", -x)
    at.check("area_sinh", x)
    # Where 1 + x rounds to the neighbours of 1.
    near = np.concatenate([both_sides(k * EPSILON[at.precision] / 2, at.precision) for k in (1, 2, 3, 4)])
    at.check("log_1p", near)
    at.check("log_1p", -near)
    at.check("area_sinh", near)


def test_areas_of_large_arguments_do_not_overflow(at: Setting) -> None:
    """Coordinates reach 1e13 at distance 30; up to a third of the largest number nothing may be squared."""
    largest = float(np.finfo(FLOAT[at.precision]).max)
    x = np.array([1e13, 1e18, 1e19, 1e20, 1e30, 1e37, largest / 3])
    for name in ("area_sinh", "area_cosh", "log_1p"):
        at.check(name, x)


def test_area_cosh_down_to_its_bound(at: Setting) -> None:
    x = both_sides(2, at.precision)
    at.check("area_cosh", x[x >= 2])


def test_sinh_cosh_over_the_series(at: Setting) -> None:
    found = re.search(r"^#define SINH_SERIES_BELOW (\S+)", kernel_text(PART), re.MULTILINE)
    assert found
    x = both_sides(float(found[1]), at.precision)
    at.check("sinh_cosh", np.concatenate([x, -x]))


def test_sinh_cosh_far_out(at: Setting) -> None:
    """Beyond the table exp rules; where that is good to 3 EPSILON the stated error holds on."""
    x = np.random.default_rng(3).uniform(20, 87, 10_000)
    at.check("sinh_cosh", np.concatenate([x, -x]))


def test_hyperbolic_identity(at: Setting) -> None:
    x = np.random.default_rng(4).uniform(-2, 2, 10_000)
    sine, cosine = at.kernels.run("sinh_cosh", x).astype(float)
    assert np.abs((cosine - sine) * (cosine + sine) - 1).max() <= 64 * EPSILON[at.precision]
    np.testing.assert_array_equal(at.kernels.run("sinh_cosh", [[0.0]]), [[0], [1]])


def test_unit_correction_has_an_error_of_second_order(at: Setting) -> None:
    n = 1 + np.linspace(-1e-3, 1e-3, 101)
    n = n.astype(FLOAT[at.precision])
    got = at.kernels.run("unit_correction", n)[0].astype(float)
    bound = 0.38 * (n.astype(float) - 1) ** 2 * 1.01 + EPSILON[at.precision]
    assert (np.abs(got * np.sqrt(n.astype(float)) - 1) <= bound).all()
