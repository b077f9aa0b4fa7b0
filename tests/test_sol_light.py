"""The area density of Sol (kernels/geometry/sol_light.h): against the long arithmetic of tests/sol.py, closed
forms where there are any, and the flow of thin bundles of rays; on both sides of where its formula changes.

Errors are relative to the density; next to conjugate points, where it vanishes, to (t/2)^2 where that is
more, t counting up to 4. `pytest -s` prints the largest.
"""

import functools
import re
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pytest
import sol
from golden import EPSILON, Array, constant, cut
from small_kernels import Body, SmallKernels
from test_sol_flow import both_sides, with_m

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.program import geometry_parts, kernel_text

LANES = 16
PART = "geometry/sol_light.h"
both_precisions = pytest.mark.parametrize("precision", EPSILON)


@functools.cache
def known(a: float, b: float, c: float, t: float) -> float:
    return abs(float(sol.area([a, b, c], t)))


def errors(got: Array, want: Array, t: Array) -> Array:
    return np.abs(got - want) / np.maximum(want, np.minimum(t, 4.0) ** 2 / 4)


def check(
    name: str, precision: str, rays: Sequence[tuple[Any, float]], stated: dict[str, float], device: Device
) -> None:
    """Against the truth for the rays as numbers of the precision; twice of what is stated is allowed."""
    u, t = sol.directions([ray[0] for ray in rays], precision), cut([ray[1] for ray in rays], precision)
    got = Geometry("sol", precision, device, lanes=LANES).area_density(u, t)
    want = np.array([known(*map(float, ray), float(time)) for ray, time in zip(u, t, strict=True)])
    off = errors(got, want, t)
    n = int(np.argmax(off))
    line = f"{precision} {name:32} {off[n]:8.1e}   stated {stated[precision]:8.1e}"
    line += f"   at {u[n].tolist()}, {t[n]:.6g}"
    print(line)
    assert off[n] <= 2 * stated[precision], line


# -- the formula changes -------------------------------------------------------------------------------------


def with_product(product: float, straight: bool) -> tuple[float, float, float]:
    """The direction with m (1 - 4 m^2) = product, next to a plane or to a straight line."""
    m = 0.5 if straight else product
    for _ in range(40):
        m = np.sqrt(1 - product / m) / 2 if straight else product / (1 - 4 * m * m)
    up = 0.7 * np.sqrt(1 - 2 * m)
    a, b, c = with_m(m, up)
    # Of a small m the difference has no digits.
    return (a, b, c) if straight else (a, m / a, c)


@both_precisions
def test_on_both_sides_of_the_closed_form(precision: str, opencl_device: Device) -> None:
    """CLOSED_AREA_ABOVE, next to planes, to straight lines and to the vertical."""
    seam = constant(PART, "CLOSED_AREA_ABOVE", precision)
    rays = []
    for straight in (False, True):
        for e in (0.5, -0.5, *both_sides(precision)):
            a, b, c = with_product(seam * (1 + e), straight)
            assert abs(a * b * (1 - 4 * (a * b) ** 2) / seam - 1 - e) < 1e-6
            rays += [(row, t) for row in ((a, b, c), (b, a, -c)) for t in (1.0, 3.0, 5.5, 8.0)]
    for e in (0.5, -0.5, 1e-3, -1e-3):
        across = np.sqrt(seam * (1 + e))
        rays += [((across, across, 1.0), t) for t in (1.0, 3.0, 8.0)]
    check("at CLOSED_AREA_ABOVE", precision, rays, {"single": 4.1e-5, "double": 3.1e-9}, opencl_device)


RAYS = 24


def random_rays(times: Sequence[float]) -> Iterator[tuple[Array, float]]:
    rng = np.random.default_rng(1)
    for u in rng.normal(size=(RAYS, 3)):
        yield from ((u, t) for t in times)


def near_planes(times: Sequence[float]) -> Iterator[tuple[Array, float]]:
    rng = np.random.default_rng(2)
    for n, u in enumerate(rng.normal(size=(RAYS, 3))):
        u[n % 2] *= 10 ** rng.uniform(-8, -0.5)
        yield from ((u, t) for t in times)


def near_straight(times: Sequence[float]) -> Iterator[tuple[Array, float]]:
    rng = np.random.default_rng(3)
    for _ in range(RAYS):
        angle, small = rng.uniform(0, 2 * np.pi), 10 ** rng.uniform(-8, -0.5)
        off = small * np.array([np.cos(angle), -np.cos(angle), np.sin(angle)])
        yield from ((np.array([1.0, 1.0, 0.0]) / np.sqrt(2) + off, t) for t in times)


def near_vertical(times: Sequence[float]) -> Iterator[tuple[Array, float]]:
    rng = np.random.default_rng(4)
    for u in rng.normal(size=(RAYS, 3)):
        u[:2] *= 10 ** rng.uniform(-8, -0.5)
        yield from ((u, t) for t in times)


# By regime: the rays, and the errors measured from t = 1 on; and before.
REGIMES = {
    "random": (random_rays, {"single": 2.1e-5, "double": 8.2e-14}),
    "next to planes": (near_planes, {"single": 3.5e-5, "double": 2.7e-9}),
    "next to straight lines": (near_straight, {"single": 1.5e-4, "double": 1.6e-8}),
    "next to the vertical": (near_vertical, {"single": 1.8e-5, "double": 2.5e-9}),
}
BEFORE = {"single": 4.3e-7, "double": 3.2e-10}


@both_precisions
@pytest.mark.parametrize("regime", REGIMES)
def test_regimes(regime: str, precision: str, opencl_device: Device) -> None:
    rays, stated = REGIMES[regime]
    check(f"{regime}, t >= 1", precision, list(rays((1.0, 4.0, 15.0))), stated, opencl_device)


@pytest.mark.parametrize("precision", EPSILON)
def test_short_times(precision: str, opencl_device: Device) -> None:
    """Where space looks flat the density is t^2, with all digits."""
    g = Geometry("sol", precision, opencl_device, lanes=LANES)
    rays = [ray for regime, _ in REGIMES.values() for ray in list(regime((1e-6, 1e-3, 0.03, 0.4)))[::2]]
    assert (g.area_density(sol.directions([ray for ray, _ in rays], precision), 0.0) == 0).all()
    check("t < 1", precision, rays, BEFORE, opencl_device)


@both_precisions
def test_the_integration_is_of_order_four(precision: str, opencl_device: Device) -> None:
    """AREA_STEP: steps of twice the length err by 16 times as much, so that the error is that of the rule."""
    parts, text = geometry_parts("sol"), kernel_text(PART)
    parts = tuple(part for part in parts if part != PART)
    body = {
        "area": Body(4, 1, "direction u = {IN(0), IN(1), IN(2)}; OUT(0, area_density(u, IN(3), REAL(0)));")
    }
    step = constant(PART, "AREA_STEP", precision)
    t = np.linspace(2.0, 6.0, 40)
    u, want = np.broadcast_to([0.0, 0.0, 1.0], (40, 3)), np.sinh(t) ** 2
    off = []
    for factor in (2.0, 4.0):
        head = re.sub(r"(?<=#define AREA_STEP )[\d.]+(f?)", lambda m, k=factor: f"{step * k}{m[1]}", text)
        kernels = SmallKernels(opencl_device, parts, body, precision, LANES, head)
        off.append(np.median(kernels.run("area", np.column_stack([u, t]).T)[0] / want - 1))
    assert 12 < off[1] / off[0] < 18, off


# -- closed forms --------------------------------------------------------------------------------------------

TIMES = np.array([1e-3, 0.05, 0.3, 1.0, 2.0, 4.0, 7.0, 12.0, 20.0])
# Of integration; and along straight lines past the first conjugate point.
INTEGRATED = {"single": 5e-5, "double": 4e-9}
STRAIGHT = {"single": 3.3e-4, "double": 3.2e-8}


@both_precisions
def test_straight_up_and_down(precision: str, opencl_device: Device) -> None:
    """Two fields sinh t across."""
    g = Geometry("sol", precision, opencl_device, lanes=LANES)
    t = cut(TIMES, precision)
    for sign in (1.0, -1.0):
        off = np.abs(g.area_density([0.0, 0.0, sign], t) / np.sinh(t) ** 2 - 1).max()
        print(f"{precision} vertical {off:.1e}")
        assert off <= 2 * INTEGRATED[precision], off


@both_precisions
def test_in_the_hyperbolic_planes(precision: str, opencl_device: Device) -> None:
    """In the plane the field sinh t, and across it that of the Killing field of y, e^z times the integral of
    e^-2z, with e^-z = cosh t - c sinh t."""
    g = Geometry("sol", precision, opencl_device, lanes=LANES)
    t = cut(TIMES, precision)
    for up in (0.0, 0.5, -0.5, 0.96, -0.96):
        ((a, _, c),) = sol.directions([(np.sqrt((1 - up) * (1 + up)), 0.0, up)], "double")
        cosh, sinh = np.cosh(t), np.sinh(t)
        shrink = (1 - c) / 2 * np.exp(t) + (1 + c) / 2 * np.exp(-t)
        integral = (
            (1 - c) ** 2 / 8 * np.expm1(2 * t)
            - (1 + c) ** 2 / 8 * np.expm1(-2 * t)
            + (1 - c) * (1 + c) / 2 * t
        )
        assert np.allclose(shrink, cosh - c * sinh)
        want = sinh * integral / shrink
        for u in ((a, 0.0, c), (-a, 0.0, c), (0.0, a, -c)):
            off = np.abs(g.area_density(u, t) / want - 1).max()
            print(f"{precision} plane, c = {up} {off:.1e}")
            assert off <= 2 * INTEGRATED[precision], (u, off)


@both_precisions
def test_along_straight_lines(precision: str, opencl_device: Device) -> None:
    """Along a = b, c = 0 the equations have constant coefficients: 2 (1 - cos s) - (s/2) sin s, s = sqrt 2 t,
    which vanishes first after one period, at pi sqrt 2."""
    g = Geometry("sol", precision, opencl_device, lanes=LANES)
    t = cut(np.array([*TIMES, np.pi * np.sqrt(2), 5.0]), precision)
    s = np.sqrt(2) * t
    want = np.abs(4 * np.sin(s / 2) ** 2 - s / 2 * np.sin(s))
    for u in ((1.0, 1.0, 0.0), (1.0, -1.0, 0.0)):
        off = errors(g.area_density(sol.directions([u], precision), t), want, t).max()
        print(f"{precision} straight {off:.1e}")
        assert off <= 2 * STRAIGHT[precision], off


# -- what it is for ------------------------------------------------------------------------------------------


def test_light_of_a_thin_bundle_is_kept(opencl_device: Device) -> None:
    """Intensity times area is the same all along: the cross-section of three rays about a fourth, over the
    solid angle between them, is the density."""
    g = Geometry("sol", "double", opencl_device, lanes=LANES)
    rng, small = np.random.default_rng(5), 1e-6
    u = sol.directions(rng.normal(size=(400, 3)), "double")
    aside = sol.directions(np.cross(u, rng.normal(size=(400, 3))), "double")
    third = np.cross(u, aside)
    for t in (0.3, 1.0, 2.0, 4.0):
        here, ahead = g.flow(u, t)
        corners = []
        for angle in 2 * np.pi * np.arange(3) / 3:
            ray = u + small * (np.cos(angle) * aside + np.sin(angle) * third)
            corners.append(g.untranslate(here, g.flow(sol.directions(ray, "double"), t)[0])[:, :3])
        area = np.einsum("ni,ni->n", ahead, np.cross(corners[1] - corners[0], corners[2] - corners[0])) / 2
        solid_angle = 3 * np.sqrt(3) / 4 * small**2
        density = g.area_density(u, t)
        # The second order, which grows with the bundle.
        off = np.abs(np.abs(area) / solid_angle - density) / np.exp(2 * t)
        assert off.max() <= 1e-4, (t, off.max())


@both_precisions
def test_symmetries(precision: str, opencl_device: Device) -> None:
    """The symmetries that fix 0 keep it, and so does going back the same way."""
    g = Geometry("sol", precision, opencl_device, lanes=LANES)
    u = sol.directions(np.random.default_rng(6).normal(size=(300, 3)), precision)
    for t in (1.0, 5.0):
        want = g.area_density(u, t)
        for signs in ((-1, 1, 1), (1, -1, 1), (-1, -1, 1)):
            np.testing.assert_array_equal(g.area_density(u * signs, t), want)
        exchanged = g.area_density(u[:, [1, 0, 2]] * [1, 1, -1], t)
        back = g.area_density(sol.directions(-g.flow(u, t)[1], precision), t)
        for got in (exchanged, back):
            off = errors(got, want, np.full(300, t))
            print(f"{precision} symmetry {off.max():.1e}, 95 % {np.quantile(off, 0.95):.1e}")
            assert np.quantile(off, 0.95) <= 1e3 * EPSILON[precision] and off.max() <= 100 * BEFORE[precision]


@both_precisions
def test_all_widths_agree(precision: str, opencl_device: Device) -> None:
    rays = [ray for regime, _ in REGIMES.values() for ray in regime((1.0, 5.0))]
    u, t = sol.directions([ray[0] for ray in rays], precision), np.array([ray[1] for ray in rays])
    want = Geometry("sol", precision, opencl_device, lanes=1).area_density(u, t)
    limit = {"single": 1e-4, "double": 1e-7}[precision]
    for lanes in (4, 16, 32):
        got = Geometry("sol", precision, opencl_device, lanes=lanes).area_density(u, t)
        assert errors(got, want, t).max() <= limit, lanes
