"""kernels/special/stumpff.h against 50 digits: within the ACCURACY table of its head, in both precisions, at
widths 1, 16 and 32; and the seam between series and closed form walked over from both sides."""

import functools
import re

import numpy as np
import pytest
from golden import EPSILON, MP, Array, cut, rounded
from small_kernels import Body, SmallKernels
from twisted import stumpff

from thurston_cl.device import Device
from thurston_cl.program import kernel_text

PARTS = ("lanes.h", "special/elementary.h", "special/stumpff.h")
BODY = Body(
    1,
    4,
    """real s = IN(0), c0, s0 = stumpff(s, &c0);
  OUT(0, c0); OUT(1, s0); OUT(2, stumpff_s1(s, c0, s0)); OUT(3, stumpff_d(s, c0, s0));""",
)
# D is needed of s = T^2 >= 0 only.
LOWEST = {"C0": -400.0, "S0": -400.0, "S1": -400.0, "D": 0.0}
HIGHEST = 400.0


def stated(precision: str) -> dict[str, float]:
    """The table of the head: the maximal errors in units of EPSILON."""
    rows = re.findall(
        r"^//   ([\w, ]+?)  +-?\d.*?  +(\d+) +(\d+)\b", kernel_text("special/stumpff.h"), re.MULTILINE
    )
    column = {"single": 1, "double": 2}[precision]
    return {name: float(row[column]) for row in rows for name in row[0].split(", ")}


@functools.cache
def arguments(precision: str) -> Array:
    """s on both sides of 0, of the seam at |s| = 1 to the last bit, of the functions' zeros, and at
    random."""
    rng = np.random.default_rng(3)
    tiny = 10.0 ** np.arange(-37, 0)
    seam = 1 + EPSILON[precision] * np.array([-64, -2, -1, -0.5, 0, 1, 2, 64])
    zeros = (np.pi * np.arange(1, 12) / 2) ** 2
    near_zeros = np.concatenate([zeros * (1 + e) for e in (-1e-3, -1e-6, 0, 1e-6, 1e-3)])
    positive = np.concatenate([tiny, seam, near_zeros, rng.uniform(0, HIGHEST, 300)])
    values = np.concatenate([[0.0], positive, -positive, rng.uniform(-80, 80, 200)])
    values = cut(values, precision)
    return values[(values >= min(LOWEST.values())) & (values <= HIGHEST)]


@functools.cache
def reference(precision: str) -> Array:
    """C0, S0, S1, D (4,N), and what errors are relative to (4,N)."""
    values, sizes = [], []
    for s in arguments(precision):
        c0, s0, s1, d = stumpff(MP.mpf(float(s)))
        values.append([c0, s0, s1, d])
        x = max(MP.sqrt(abs(MP.mpf(float(s)))), MP.mpf(1))
        size = x * max(abs(c0), x * abs(s0))
        sizes.append([size, size / x, size / x**2, abs(d)])
    return np.stack([np.array(values, dtype=object).T, np.array(sizes, dtype=object).T])


@pytest.mark.parametrize("lanes", (1, 16, 32))
@pytest.mark.parametrize("precision", EPSILON)
def test_values(precision: str, lanes: int, opencl_device: Device) -> None:
    kernels = SmallKernels(opencl_device, PARTS, {"stumpff": BODY}, precision, lanes)
    got = kernels.run("stumpff", arguments(precision)[None, :])
    values, sizes = reference(precision)
    table = stated(precision)
    assert table.keys() == LOWEST.keys()
    for row, (name, lowest) in enumerate(LOWEST.items()):
        inside = arguments(precision) >= lowest
        exact = np.array([MP.mpf(float(x)) for x in got[row]], dtype=object)
        units = rounded(np.abs(exact - values[row]) / sizes[row])[inside] / EPSILON[precision]
        worst = int(np.argmax(units))
        assert units[worst] <= table[name], (name, arguments(precision)[inside][worst], units[worst])
