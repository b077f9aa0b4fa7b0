"""A lane does what it does alone: whatever stands in the packet beside it, at every width.

Packets here mix regimes: ordinary rays and points with ones next to every degenerate case, with slow ones,
with ones that overflow, and with numbers that are none. Only what the device's own exp, log and, in double
precision, atan2 round may differ from width to width: by a few units, and in a bit nowhere else.
"""

import functools
import warnings
from collections.abc import Callable

import numpy as np
import pytest
from golden import EPSILON, Array, cut

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry

from . import truth
from .sweeps import lifted

WIDTHS = (1, 4, 16)
COUNT = 61
all_settings = pytest.mark.parametrize(("geometry", "precision"), truth.SETTINGS)


@functools.cache
def mixture(geometry: str, precision: str) -> dict[str, Array]:
    """Directions, lengths, bases and points (COUNT,...), shuffled."""
    rng = np.random.default_rng(23)
    u = rng.normal(size=(COUNT, 3))
    small = 10.0 ** rng.uniform(-30, 0, COUNT)
    u[::4, 0] *= small[::4]
    u[1::4, 1] *= small[1::4]
    u[2::8] = [0.0, 0.0, 1.0]
    u[3::8, :2] *= small[3::8, None]
    u[7::16] = [np.sqrt(0.5), np.sqrt(0.5), 0.0]
    t = rng.choice([1e-12, 1e-3, 0.3, 1.0, 3.0, 6.2, 9.0, 14.0], COUNT)
    if geometry in ("h3", "h2xe", "sol"):
        t = np.minimum(t, 6.2)

    def points(size: float) -> Array:
        x = rng.uniform(-size, size, (COUNT, 3)) * 10.0 ** rng.choice([0, 0, -4, -20], (COUNT, 3))
        x[::9] = 0
        if geometry == "s3":
            x *= 0.4
        if geometry == "s2xe":
            x[:, :2] *= 0.6
        if geometry in ("nil", "sl2"):
            x[::5, 2] *= 15
        p = lifted(geometry, *x.T)
        if geometry in ("s3", "s2xe"):
            p[::3, 3 if geometry == "s3" else 2] *= -1
        return p

    return {
        "u": cut(u / np.linalg.norm(u, axis=1, keepdims=True), precision),
        "t": cut(t, precision),
        "base": points(1.1),
        "point": points(1.3),
    }


# What is asked, of rows of the mixture; (N, any).
ASKED: dict[str, Callable[[Geometry, dict[str, Array]], Array]] = {
    "flow": lambda g, m: np.concatenate(g.flow(m["u"], m["t"], m["base"]), axis=1),
    "flow from the origin": lambda g, m: np.concatenate(g.flow(m["u"], m["t"]), axis=1),
    "velocity": lambda g, m: g.velocity(m["base"], m["u"]),
    "transport": lambda g, m: g.transport(m["u"], m["t"], m["base"]).reshape(len(m["t"]), 9),
    "distance": lambda g, m: g.distance(m["point"], m["base"])[:, None],
    "underestimate": lambda g, m: g.underestimate(m["point"])[:, None],
    "geodesics": lambda g, m: np.concatenate(
        [x.reshape(len(m["t"]), -1) for x in g.geodesics(m["point"], 3, m["base"])], axis=1
    ),
    "area_density": lambda g, m: g.area_density(m["u"], m["t"])[:, None],
    "translate": lambda g, m: g.translate(m["base"], m["point"]),
    "untranslate": lambda g, m: g.untranslate(m["base"], m["point"]),
}


def rows(m: dict[str, Array], chosen: Array) -> dict[str, Array]:
    return {name: values[chosen] for name, values in m.items()}


@all_settings
def test_neighbours_do_not_matter(geometry: str, precision: str, opencl_device: Device) -> None:
    """To the last bit: shuffled, and by itself, which fills its packet."""
    g, m = Geometry(geometry, precision, opencl_device, lanes=WIDTHS[2]), mixture(geometry, precision)
    order = np.random.default_rng(29).permutation(COUNT)
    for name, asked in ASKED.items():
        together = asked(g, m)
        np.testing.assert_array_equal(asked(g, rows(m, order)), together[order], name)
        for n in range(0, COUNT, 15):
            np.testing.assert_array_equal(asked(g, rows(m, np.array([n])))[0], together[n], f"{name} {n}")


# Inputs that are no numbers, or whose results are none, or take long; in place of components of a ray or a
# point.
BAD = (np.nan, np.inf, -np.inf, 1e38, -1e38, 1e-38, 0.0)


@all_settings
def test_bad_neighbours_do_not_matter(geometry: str, precision: str, opencl_device: Device) -> None:
    """Every other row made nonsense, as no caller may: the rows between keep every bit. And it ends."""
    g, m = Geometry(geometry, precision, opencl_device, lanes=WIDTHS[1]), mixture(geometry, precision)
    u, t, base, point = m["u"], m["t"][:, None], m["base"], m["point"]
    none, zero = np.zeros_like(base), np.zeros_like(t)
    calls = {
        "flow": ([base, u, t, zero], 7, ()),
        "transport": ([base, u, t, zero], 9, ()),
        "distance": ([base, point, none, none], 2, ()),
        "geodesic": ([base, point, none, none], 6, (1,)),
        "underestimate": ([point], 1, ()),
        "area_density": ([u, t, zero], 1, ()),
        "translate": ([base, point], 4, ()),
    }
    good = np.arange(COUNT) % 2 == 0
    rng = np.random.default_rng(31)
    for name, (arrays, outputs, constants) in calls.items():
        program = g._flow if name == "flow" else g._program
        want = program.run(f"numerics_{name}", arrays, outputs, *constants)
        spoilt = [a.copy() for a in arrays]
        for n in np.flatnonzero(~good):
            a = spoilt[rng.integers(len(spoilt))]
            a[n, rng.integers(a.shape[1])] = BAD[rng.integers(len(BAD))]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            got = program.run(f"numerics_{name}", spoilt, outputs, *constants)
        np.testing.assert_array_equal(got[good], want[good], name)


# Where the device's exp, log or (in double precision) atan2 take part, by geometry: what they round
# otherwise in vectors, in units of EPSILON of the largest entry of a row. Everything else is equal to the
# last bit; and so is single precision, but for the search for geodesics of sol.
_FLOWS = ("flow", "flow from the origin", "velocity", "transport", "area_density")
_LENGTHS = ("distance", "underestimate", "geodesics")
_MOVES = ("translate", "untranslate")
BUILT_INS: dict[tuple[str, str], tuple[str, ...]] = {
    ("s3", "double"): _LENGTHS,
    ("h3", "double"): (*_FLOWS, *_LENGTHS),
    ("s2xe", "double"): _LENGTHS,
    ("h2xe", "double"): (*_FLOWS, *_LENGTHS),
    ("nil", "double"): _LENGTHS,
    ("sl2", "double"): (*_FLOWS, *_LENGTHS, *_MOVES),
    ("sol", "single"): ("geodesics",),
    ("sol", "double"): (*_FLOWS, *_LENGTHS, *_MOVES),
}
UNITS = 4.0


@all_settings
def test_widths_agree(geometry: str, precision: str, opencl_device: Device) -> None:
    """Widths 4 and 16 with width 1."""
    m = mixture(geometry, precision)
    one, *others = (Geometry(geometry, precision, opencl_device, lanes=lanes) for lanes in WIDTHS)
    for name, asked in ASKED.items():
        want = asked(one, m)
        size = np.nanmax(np.abs(want), axis=1, keepdims=True)
        for lanes, g in zip(WIDTHS[1:], others, strict=True):
            got = asked(g, m)
            if name not in BUILT_INS.get((geometry, precision), ()):
                np.testing.assert_array_equal(got, want, f"{name}, {lanes} lanes")
                continue
            np.testing.assert_array_equal(np.isnan(got), np.isnan(want), name)
            off = np.abs(np.nan_to_num(got - want))
            assert (off <= UNITS * EPSILON[precision] * size).all(), (name, lanes)
