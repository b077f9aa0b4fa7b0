"""Long flows: lengths of 1000 and 10,000 where a geometry has them, and what returns after them.

Drift, measured here: for a length t an error of the size of the path's amplitude times

    geometry                    single              double
    e3, s3, nil                 a unit at any t     the same: lengths and half angles have two parts
    s2xe, of the factor         t EPSILON/2         the same: the angle l t is rounded
    sl2, elliptic, over H2      t EPSILON           the same: so is the root of s
    sol, off the planes         a unit of the point's size at any t; its direction, t EPSILON
    1000 flows of 1, reproject,  at most 1000 EPSILON of the size of coordinates; 1000^(3/2) EPSILON of
      against one of 1000        directions that turn about a fiber: what rounding does to the part along it
                                 turns them for the rest of the way
"""

import warnings

import numpy as np
import pytest
import sol
from golden import EPSILON, MP, Array, cut
from small_kernels import Body, SmallKernels

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.models import ORIGIN
from thurston_cl.program import geometry_parts

from . import truth
from .truth import both_precisions

LONG = ("e3", "s3", "s2xe", "nil", "sl2")
both = pytest.mark.parametrize(("geometry", "precision"), [(n, p) for n in LONG for p in EPSILON])


def directions(geometry: str, precision: str) -> Array:
    """In sl2 elliptic ones, whose points over H2 stay near; in the others towards all sides."""
    u = np.random.default_rng(17).normal(size=(16, 3))
    if geometry == "sl2":
        up = np.random.default_rng(18).uniform(0.75, 0.99, 16) * np.sign(u[:, 2])
        u = np.column_stack([u[:, :2] / np.hypot(*u[:, :2].T)[:, None] * np.sqrt(1 - up**2)[:, None], up])
    return cut(u / np.linalg.norm(u, axis=1, keepdims=True), precision)


# Errors of points in units of EPSILON, and for each unit of length.
DRIFT = {"e3": (1.5, 0.0), "s3": (2.0, 0.0), "s2xe": (2.0, 0.5), "nil": (2.5, 0.0), "sl2": (5.0, 1.0)}


@both
def test_long_flows(geometry: str, precision: str, opencl_device: Device) -> None:
    """Against 50 digits, at t = 1000 and 10,000, and next to it what single precision cuts off."""
    g = Geometry(geometry, precision, opencl_device, lanes=4)
    u = directions(geometry, precision)
    for t in (1000.0, 1000.0001, 10_000.0, -1000.0):
        points, ahead = g.flow(u, t)
        ends = [truth.flow(geometry, row, t) for row in u]
        off = [
            truth.point_error(geometry, row, t, end.point, p)
            for row, end, p in zip(u, ends, points, strict=True)
        ]
        size = np.array(off)
        if geometry == "s2xe":
            # Of the sphere, and of the line.
            want = np.array([end.point.astype(float) for end in ends])
            size *= np.abs(want).max(axis=1)[:, None] / np.array([1, 1, 1, abs(t)])
        if geometry == "sl2":
            want = np.array([end.point.astype(float) for end in ends])
            # Of what z comes to on the way, a^2/(u_w^2 - a^2).
            a = 1 - u[:, 2] ** 2
            size[:, :3] *= (want[:, 2] / (1 + 2 * a / (1 - 2 * a)))[:, None]
        once, each = DRIFT[geometry]
        worst = np.abs(size).max() / EPSILON[precision]
        print(f"{geometry} {precision} t = {t:g}: {worst:.2f} EPSILON, of the length {worst / abs(t):.2g}")
        assert worst <= once + each * abs(t), t
        turned = [truth.vector_error(end.direction, e) for end, e in zip(ends, ahead, strict=True)]
        # Where a half angle of single precision has a large second part, its square counts.
        assert np.abs(turned).max() <= 4 * EPSILON[precision] + (t * EPSILON[precision]) ** 2 / 4, t


@both_precisions
def test_long_flows_of_sol(precision: str, opencl_device: Device) -> None:
    """Far from the planes, where coordinates grow in proportion to the length, the period counts only."""
    g = Geometry("sol", precision, opencl_device, lanes=4)
    u = sol.directions([(0.6, 0.64, 0.48), (0.7, 0.7, 1e-3), (0.3, -0.2, 0.9)], precision)
    for t in (300.0, 1000.0):
        points, ahead = g.flow(u, t)
        for row, p, e in zip(u, points, ahead, strict=True):
            end = truth.flow("sol", row, t)
            off = np.abs(truth.point_error("sol", row, t, end.point, p)).max()
            assert off <= 4 * EPSILON[precision], (row, t)
            assert np.abs(truth.vector_error(end.direction, e)).max() <= t * EPSILON[precision], (row, t)


@both
def test_there_and_back(geometry: str, precision: str, opencl_device: Device) -> None:
    """Arrived after 1000, turned round and gone as far: the start again, to the drift of both."""
    g = Geometry(geometry, precision, opencl_device, lanes=4)
    u = directions(geometry, precision)
    points, ahead = g.flow(u, 1000.0)
    back, home = g.flow(-ahead, 1000.0, points)
    size = 1 + np.abs(points).max(axis=1)
    off = np.abs(back - ORIGIN[geometry]).max(axis=1) / EPSILON[precision]
    print(f"{geometry} {precision} {off.max():.0f} EPSILON, {(off / size).max():.2f} of the size gone to")
    # The direction is rounded where the way turns round, which counts by the length.
    assert (off <= 2 * 1000.0 + 8 * size).all()
    turned = np.abs(home + u).max(axis=1)
    if geometry == "s3":
        # Nearer to the antipode than that frames are known to less.
        turned = turned * np.minimum(1, np.linalg.norm(points[:, :3], axis=1))
    assert turned.max() <= 1e3 * EPSILON[precision]


@both_precisions
def test_full_turns_of_s3(precision: str, opencl_device: Device) -> None:
    """t = 2 pi k leads back to the start, and pi (2 k + 1) to its antipode: pi has no two parts here, t
    has."""
    g = Geometry("s3", precision, opencl_device, lanes=4)
    u = directions("s3", precision)
    k = np.arange(1, 17) * 97
    t = 2 * np.pi * k
    # What 2 pi k as binary64 misses of it.
    rest = np.array([float(MP.mpf(x) - 2 * MP.pi * int(n)) for x, n in zip(t, k, strict=True)])
    points, ahead = g.flow(u, t)
    assert np.abs(points[:, :3] - u * rest[:, None]).max() <= 4 * EPSILON[precision]
    assert np.abs(points[:, 3] - 1).max() <= 2 * EPSILON[precision]
    assert np.abs(ahead - u).max() <= 2 * EPSILON[precision]
    across, _ = g.flow(u, t + np.pi)
    assert np.abs(across[:, 3] + 1).max() <= 2 * EPSILON[precision]


@both_precisions
@pytest.mark.parametrize("geometry", ["nil", "sl2"])
def test_helices_through_the_fibre(geometry: str, precision: str, opencl_device: Device) -> None:
    """After whole turns a helix is on the fibre again, k times as high, at k = 1 to 300."""
    g = Geometry(geometry, precision, opencl_device, lanes=4)
    for up in (0.9, -0.8, 0.99):
        u = cut([[0.6 * np.sqrt(1 - up * up), -0.8 * np.sqrt(1 - up * up), up]], precision)[0]
        a, c = np.hypot(u[0], u[1]), abs(u[2])
        turn = 2 * np.pi / (c if geometry == "nil" else np.sqrt((c - a) * (c + a)))
        k = np.array([1, 2, 5, 30, 100, 300])
        points, _ = g.flow(np.broadcast_to(u, (len(k), 3)), turn * k)
        # nil knows the half angle in two parts, sl2 its root to EPSILON.
        allowed = 4 * EPSILON[precision] * (1 + turn * k * (1 if geometry == "sl2" else 1e-1))
        assert (np.hypot(points[:, 0], points[:, 1]) <= allowed * (1 + turn)).all(), up
        height = points[:, 2 if geometry == "nil" else 3]
        assert np.abs(height / (k * height[0]) - 1).max() <= 8 * EPSILON[precision], up


@both_precisions
def test_periods_of_sol(precision: str, opencl_device: Device) -> None:
    """After half a period a and b are exchanged and c turned round; after a whole one the direction is that
    of the start and the point on z = 0, where a x = b y; after n, n times as far. As far as sol goes."""
    g = Geometry("sol", precision, opencl_device, lanes=4)
    u = sol.directions([(0.6, 0.64, 0.48), (0.3, 0.9, -0.2), (0.7, 0.7, 0.1), (0.4, -0.5, 0.7)], precision)
    period = sol.periods(u)
    half, turned = g.flow(u, period / 2)
    exchanged = np.sign(u) * np.abs(u[:, [1, 0, 2]]) * [1, 1, -1]
    assert np.abs(turned - exchanged).max() <= 16 * EPSILON[precision]
    assert np.abs(half[:, 2] - np.log(np.abs(u[:, 1] / u[:, 0]))).max() <= 16 * EPSILON[precision]
    once, ahead = g.flow(u, period)
    assert np.abs(ahead - u).max() <= 32 * EPSILON[precision]
    for n in (1, 3, 10, 14):
        t = n * period
        within = t < (87 if precision == "single" else 110)
        points, ahead = g.flow(u[within], t[within])
        # The period is rounded, and the phase: where directions change at a rate up to 1.
        allowed = 8 * EPSILON[precision] * (2 + t[within])
        assert (np.abs(ahead - u[within]).max(axis=1) <= allowed).all(), n
        assert (np.abs(points[:, 2]) <= allowed).all(), n
        ax, by = (np.abs(u[within, i] * points[:, i]) for i in (0, 1))
        assert (np.abs(ax - by) <= allowed).all(), n
        assert (np.abs(points[:, :2] / (n * once[within, :2]) - 1).max(axis=1) <= allowed).all(), n


# -- many short flows ----------------------------------------------------------------------------------------

MANY = """point p = POINT(0); vector v = POINT(4);
  for (int i = 0; i < 1000; i++) { flow(&p, &v, IN(8)); REPROJECT }
  OUT(0, p.x); OUT(1, p.y); OUT(2, p.z); OUT(3, p.w); OUT(4, v.x); OUT(5, v.y); OUT(6, v.z); OUT(7, v.w);"""
# The length of each; errors of points in units of EPSILON times 1000 and the size of coordinates.
SHORT = {
    "e3": (1.0, 0.6), "s3": (1.0, 0.4), "s2xe": (1.0, 0.6), "nil": (1.0, 0.6), "sl2": (1.0, 8.0),
    "h3": (2**-8, 1.0), "h2xe": (2**-8, 1.0), "sol": (2**-6, 6.0),
}  # fmt: skip


@pytest.mark.parametrize(("geometry", "precision"), truth.SETTINGS)
def test_a_thousand_flows_are_one(geometry: str, precision: str, opencl_device: Device) -> None:
    """The marcher's flow a thousand times, with and without `reproject`, against one flow of the whole
    length. With it points stay on the model and velocities unit and tangent, to a few units; without it they
    leave."""
    length, units = SHORT[geometry]
    bodies = {
        "kept": Body(9, 8, MANY.replace("REPROJECT", "reproject(&p, &v);")),
        "free": Body(9, 8, MANY.replace("REPROJECT", "")),
    }
    kernels = SmallKernels(opencl_device, geometry_parts(geometry), bodies, precision, 4)
    double = Geometry(geometry, "double", opencl_device, lanes=4)
    u = directions(geometry, precision)
    start = np.broadcast_to(ORIGIN[geometry], (len(u), 4))
    left_invariant = geometry in ("nil", "sl2", "sol")
    velocity = np.column_stack([u, 0 * u[:, 0]]) if left_invariant else double.velocity(start, u)
    rows = np.concatenate([start, velocity, np.full((len(u), 1), length)], axis=1).T
    want, ahead = double.flow(u, 1000 * length)
    size = 1 + np.abs(want).max(axis=1)
    kept, free = (kernels.run(name, rows).T.astype(float) for name in bodies)
    off = np.abs(kept[:, :4] - want).max(axis=1) / size / EPSILON[precision]
    print(f"{geometry} {precision} drift {off.max():.0f} EPSILON, off {defects(geometry, kept)}")
    print(f"without reproject off {defects(geometry, free)}")
    assert off.max() <= 1000 * units
    point, speed = defects(geometry, kept)
    assert max(point, speed) <= 8 * EPSILON[precision]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # On the model to what the functions of arrays ask for: they can start there.
        double.distance(kept[:, :4])
    want = np.column_stack([ahead, 0 * u[:, 0]]) if left_invariant else double.velocity(want, ahead)
    turned = np.abs(kept[:, 4:] - want).max(axis=1) / EPSILON[precision]
    steps = 1000**1.5 if geometry in ("s2xe", "nil", "sl2") else 1000 * units
    assert (turned <= steps * (size if geometry in ("h3", "h2xe") else 1)).all(), turned.max()


def defects(geometry: str, state: Array) -> tuple[float, float]:
    """How far points are off the model, and velocities from length 1 and from being tangent."""
    p, v = state[:, :4], state[:, 4:]
    form = {
        "e3": (1, 1, 1, 0),
        "s3": (1, 1, 1, 1),
        "h3": (1, 1, 1, -1),
        "s2xe": (1, 1, 1, 1),
        "h2xe": (1, 1, -1, 1),
    }
    if geometry not in form:
        point = p[:, 0] ** 2 + p[:, 1] ** 2 - p[:, 2] ** 2 + 1 if geometry == "sl2" else p[:, 3] - 1
        size = p[:, 2] ** 2 if geometry == "sl2" else 1
        return float(np.abs(point / size).max()), float(np.abs((v**2).sum(axis=1) - 1).max())
    g = np.array(form[geometry])
    factor = np.array([1, 1, 1, 0]) if geometry in ("s2xe", "h2xe") else np.ones(4)
    square, size = (g * factor * p * p).sum(axis=1), (p**2 * factor).sum(axis=1)
    model = {"e3": 0 * square, "s3": square - 1, "s2xe": square - 1}.get(geometry, square + 1)
    tangent = np.abs((g * factor * p * v).sum(axis=1)) if geometry != "e3" else 0 * square
    speed = np.abs((g * v * v).sum(axis=1) - 1)
    return float(np.abs(model / size).max()), float((np.maximum(tangent, speed) / size).max())
