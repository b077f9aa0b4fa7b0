"""kernels/special/carlson.h against SciPy and mpmath: within the ACCURACY table of its head, in both
precisions, at widths 1, 4, 16 and 32."""

import re

import numpy as np
import pytest
import scipy.special
from golden import EPSILON, MP, Array, cut
from small_kernels import Body, SmallKernels

from thurston_cl.device import Device
from thurston_cl.program import kernel_text

HEAD = kernel_text("special/carlson.h")
PARTS = ("lanes.h", "special/elementary.h")
BODY = Body(2, 2, "real d; OUT(0, carlson_f_and_d(IN(0), IN(1), &d)); OUT(1, d);")
FUNCTIONS = ("R_F", "R_D")
both_precisions = pytest.mark.parametrize("precision", EPSILON)
all_kernels = pytest.mark.parametrize(
    ("precision", "lanes"), [(precision, lanes) for precision in EPSILON for lanes in (1, 4, 16, 32)]
)


def table() -> dict[tuple[str, str], dict[float, float]]:
    """By function and precision: the stated error by the least y."""
    rows = re.findall(r"^//   (R_F|R_D) +(float|double)((?: +[\d.e+-]+)+)", HEAD, re.MULTILINE)
    (least,) = re.findall(r"^//   y from((?: +[\d.e+-]+)+)", HEAD, re.MULTILINE)
    words = {"float": "single", "double": "double"}
    ends = [float(y) for y in least.split()]
    return {
        (name, words[word]): dict(zip(ends, map(float, errors.split()), strict=True))
        for name, word, errors in rows
    }


STATED = table()


def sample(precision: str, low: float, high: float, n: int) -> tuple[Array, Array]:
    """0 <= x <= y with y in [low, high]: x as small as may be, next to y, equal to it, and 0."""
    rng = np.random.default_rng(1)
    y = cut(np.exp(rng.uniform(np.log(low), np.log(high), n)), precision)
    y[:3] = cut([low * (1 + EPSILON[precision]), high, low * 1.5], precision)
    share = np.choose(
        np.arange(n) % 4, [rng.uniform(0, 1, n), 10.0 ** rng.uniform(-9, 0, n), np.ones(n), np.zeros(n)]
    )
    return cut(y * share, precision), y


def kernels(precision: str, lanes: int, device: Device, head: str = HEAD) -> SmallKernels:
    return SmallKernels(device, PARTS, {"carlson": BODY}, precision, lanes, head)


def worst(at: SmallKernels, x: Array, y: Array) -> Array:
    """The largest relative errors of both functions, against SciPy."""
    got = at.run("carlson", [x, y]).astype(float)
    want = np.array([scipy.special.elliprf(x, y, 1), scipy.special.elliprd(x, y, 1)])
    return np.abs(got / want - 1).max(axis=1)


def test_the_head_has_a_row_for_each() -> None:
    assert set(STATED) == {(name, precision) for name in FUNCTIONS for precision in EPSILON}


@all_kernels
def test_accuracy_of_the_head(precision: str, lanes: int, opencl_device: Device) -> None:
    at = kernels(precision, lanes, opencl_device)
    high = 1.0
    for low in STATED["R_F", precision]:
        off = worst(at, *sample(precision, low, high, 6000))
        for name, error in zip(FUNCTIONS, off, strict=True):
            stated = STATED[name, precision][low]
            print(f"{precision} {name} y from {low:.0e}: {error:.1e}, stated {stated:.1e}")
            assert error <= stated, (name, low, error)
        high = low


@both_precisions
def test_against_long_arithmetic(precision: str, opencl_device: Device) -> None:
    """Where SciPy might err as well."""
    at, (high, *_) = kernels(precision, 4, opencl_device), STATED["R_F", precision]
    x, y = sample(precision, high, 1.0, 60)
    got = at.run("carlson", [x, y]).astype(float)
    for name, function, values in zip(FUNCTIONS, (MP.elliprf, MP.elliprd), got, strict=True):
        off = max(
            abs(float(MP.mpf(v) / function(MP.mpf(p), MP.mpf(q), 1) - 1))
            for v, p, q in zip(values, x, y, strict=True)
        )
        assert off <= STATED[name, precision][high], (name, off)


@both_precisions
def test_known_values(precision: str, opencl_device: Device) -> None:
    """R_F(0, 1, 1) = pi/2, R_F(x, x, 1) atanh(r)/r, r^2 = 1 - x, R_D(1, 1, 1) = R_F(1, 1, 1) = 1."""
    x, y = [0.0, 1.0, 0.25, 0.5], [1.0, 1.0, 0.25, 0.5]
    f, d = kernels(precision, 4, opencl_device).run("carlson", [x, y]).astype(float)
    root = np.sqrt(1 - np.array(x[2:]))
    want = [np.pi / 2, 1.0, *(np.arctanh(root) / root)]
    assert np.abs(f / want - 1).max() <= 4 * EPSILON[precision]
    assert abs(d[1] - 1) <= 4 * EPSILON[precision]
    assert abs(d[0] / (3 * np.pi / 4) - 1) <= 4 * EPSILON[precision]


@both_precisions
def test_one_duplication_fewer_is_too_few(precision: str, opencl_device: Device) -> None:
    """DUPLICATIONS: the last one still counts."""
    values = re.findall(r"^#define DUPLICATIONS (\d+)", HEAD, re.MULTILINE)
    count = int(values[0 if precision == "double" else -1])
    head = re.sub(r"(?<=#define DUPLICATIONS )\d+", str(count - 1), HEAD)
    off = worst(kernels(precision, 4, opencl_device, head), *sample(precision, 1e-20, 1.0, 2000))
    assert off[0] > 2 * STATED["R_F", precision][1e-20], off
