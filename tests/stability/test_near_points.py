"""Points that coincide, or nearly: from 1e-6 apart down to where there are no numbers.

Truth is the chord in constant curvature and, in nil, sl2 and sol, the exponential map to second order, both
with as many digits as the separation needs.
"""

import golden
import numpy as np
import pytest
from golden import EPSILON, FLOAT, MP, Array

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.models import ISOTROPIC, ORIGIN, PRODUCTS

from . import truth
from .sweeps import lifted

BASES = ([0.0, 0.0, 0.0], [0.5, 0.0, 0.25], [0.0, 0.3, -0.4], [0.3, 0.4, 0.0], [0.3, -0.2, 0.6])
AXES = ([1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0], [0.6, 0.8, 0], [0.48, -0.64, 0.6])
SEPARATIONS = (1e-6, 1e-9, 1e-12, 1e-15, 1e-19, 1e-23, 1e-30, 1e-37, 1e-100, 1e-155, 1e-160, 1e-200, 1e-300)
all_settings = pytest.mark.parametrize(("geometry", "precision"), truth.SETTINGS)


def near_distance(geometry: str, p: Array, q: Array) -> float:
    """Of points less than 1e-5 apart, to 1e-10 of itself at 1e-5 and better the nearer."""
    with MP.workdps(700):
        if geometry in ISOTROPIC:
            a, b = (truth.nearest(geometry, x)[None] for x in (p, q))
            return float(golden.distance(geometry, a, b)[0])
        if geometry in PRODUCTS:
            factor = {"s2xe": "s3", "h2xe": "h3"}[geometry]
            a, b = (truth.nearest(factor, np.array([x[0], x[1], 0.0, x[2]]))[None] for x in (p, q))
            return float(MP.hypot(golden.distance(factor, a, b)[0], MP.mpf(q[3]) - MP.mpf(p[3])))
        x, y, z, w = truth.seen_from(geometry, p, q)
        if geometry == "sol":
            # x'' = 2 u_x u_z, y'' = -2 u_y u_z, z'' = u_y^2 - u_x^2 at the start.
            x, y, z = x - x * z, y + y * z, z - (y * y - x * x) / 2
        return float(MP.sqrt(x * x + y * y + (w if geometry == "sl2" else z) ** 2))


def rows(geometry: str) -> tuple[Array, Array]:
    """Bases and points (N,4) next to them that are other points of binary64."""
    bases, points = [], []
    for base in BASES:
        for axis in AXES:
            for apart in SEPARATIONS:
                p = lifted(geometry, *(np.array([c]) for c in base))[0]
                q = lifted(geometry, *(np.array([c]) for c in np.array(base) + apart * np.array(axis)))[0]
                if (p != q).any():
                    bases.append(p)
                    points.append(q)
    return np.array(bases), np.array(points)


@all_settings
def test_a_distance_is_as_small_as_it_is(geometry: str, precision: str, opencl_device: Device) -> None:
    """With the digits that coordinates and what single precision cuts off them have; not 0 before there are
    no smaller numbers; the same there and back; with unit directions."""
    g = Geometry(geometry, precision, opencl_device, lanes=4)
    p, q = rows(geometry)
    want = np.array([near_distance(geometry, *pair) for pair in zip(p, q, strict=True)])
    got, back = g.distance(q, p), g.distance(p, q)
    # Below the least number with all digits there are fewer. A coordinate and its tail have 48 bits. The
    # truth of sol leaves out the third order.
    least = float(np.finfo(FLOAT[precision]).tiny)
    grain = np.where((p == 0) | (q == 0), 0, np.abs(p)).max(axis=1) * EPSILON["single"] ** 2
    allowed = 4 * EPSILON[precision] * want + 2 * least + (grain if precision == "single" else 0)
    allowed += want**3
    worst = int(np.argmax(np.abs(got - want) / allowed))
    assert (np.abs(got - want) <= allowed).all(), (p[worst], q[worst], got[worst], want[worst])
    assert (np.abs(back - got) <= allowed).all()
    known = want > 4 * least
    assert (got[known] > 0).all()
    u, lengths = g.geodesics(q, 1, p)
    np.testing.assert_array_equal(lengths[:, 0], got)
    assert np.abs(np.linalg.norm(u[:, 0], axis=1) - 1).max() <= 4 * EPSILON[precision]


@all_settings
def test_no_distance_from_a_point_to_itself(geometry: str, precision: str, opencl_device: Device) -> None:
    """Exactly 0, along the third direction, and no family; far from the origin too."""
    g = Geometry(geometry, precision, opencl_device, lanes=4)
    p = np.concatenate([rows(geometry)[0], [ORIGIN[geometry]], g.flow(np.eye(3), [0.5, 2.0, 3.0])[0]])
    assert (g.distance(p, p) <= (4e-16 if geometry == "s3" else 0)).all()
    u, lengths, family = g.geodesics(p, 1, p, families=True)
    assert (lengths <= (4e-16 if geometry == "s3" else 0)).all() and not family.any()
    exact_ones = lengths[:, 0] == 0
    np.testing.assert_array_equal(u[exact_ones, 0], np.broadcast_to([0.0, 0, 1], u[exact_ones, 0].shape))


def test_what_bare_inverse_cosines_make_of_it() -> None:
    """acos and acosh of a product, as other programs take them, say 0 from 1e-9 on: the test above sees
    that."""
    for geometry, arc in (("s3", np.arccos), ("h3", np.arccosh)):
        p = lifted(geometry, *(np.array([c]) for c in BASES[4]))[0]
        q = lifted(geometry, *(np.array([c]) for c in np.array(BASES[4]) + 1e-9 * np.array(AXES[4])))[0]
        sign = 1 if geometry == "s3" else -1
        product = sign * (p[:3] @ q[:3]) + p[3] * q[3]
        naive = arc(np.clip(product, -1, 1) if geometry == "s3" else max(product, 1.0))
        assert abs(naive / near_distance(geometry, p, q) - 1) > 0.5
