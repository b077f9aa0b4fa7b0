"""The antipodes of s3 and s2xe: geodesics to points exactly there, next to them, and beyond."""

import numpy as np
import pytest
from golden import EPSILON, Array, cut

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry

from .truth import both_precisions

both_spheres = pytest.mark.parametrize("geometry", ["s3", "s2xe"])
# From the antipode, along the geodesic; below EPSILON of single precision tails carry it.
STEPS = np.array([1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12])


def bases(geometry: str) -> Array:
    """Points (N,4): the origin, its antipode, the equator, and others."""
    rows = np.array(
        [
            [0, 0, 0, 1],
            [0, 0, 0, -1],
            [1, 0, 0, 0],
            [0.6, 0, -0.8, 0],
            [0.1, 0.5, -0.1, 0.7],
            [0.3, -0.1, 0.5, -0.8],
        ]
    )
    if geometry == "s2xe":
        rows = rows[:, [0, 1, 3, 2]]
        rows[3] = [0.6, -0.8, 0, 0]
        factor = rows[:, :3] / np.linalg.norm(rows[:, :3], axis=1, keepdims=True)
        return np.column_stack([factor, np.linspace(-1, 1, len(rows))])
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def antipode(geometry: str, p: Array) -> Array:
    q = -p
    if geometry == "s2xe":
        q[:, 3] = p[:, 3]
    return q


def directions(geometry: str, precision: str) -> Array:
    """In s2xe horizontal ones, along which the sphere is crossed at full speed."""
    u = np.array([[0.6, -0.8, 0], [1, 0, 0], [0.0, 0.28, -0.96], [0.48, 0.64, 0.6]])
    if geometry == "s2xe":
        u[:, 2] = 0
    return cut(u / np.linalg.norm(u, axis=1, keepdims=True), precision)


@both_precisions
@both_spheres
def test_exactly_at_the_antipode(geometry: str, precision: str, opencl_device: Device) -> None:
    """All of a family, in pairs of lengths (2 k + 1) pi; what is returned of each arrives."""
    g = Geometry(geometry, precision, opencl_device, lanes=4)
    p = bases(geometry)
    u, lengths, family = g.geodesics(antipode(geometry, p), 6, p, families=True)
    assert family.all()
    want = np.pi * np.array([1, 1, 3, 3, 5, 5])
    assert np.abs(lengths / want - 1).max() <= 2 * EPSILON[precision]
    np.testing.assert_array_equal(g.distance(antipode(geometry, p), p), lengths[:, 0])
    for k in range(6):
        reached, _ = g.flow(u[:, k], want[k], p)
        off = np.abs(reached - antipode(geometry, p)).max()
        assert off <= 8 * EPSILON[precision] * (1 + k), k


@both_precisions
@both_spheres
def test_next_to_the_antipode_and_beyond_it(geometry: str, precision: str, opencl_device: Device) -> None:
    """Short of it the geodesic gone is the shortest, beyond it the second; none is of a family. Both
    directions are known to what the points say of them: rounding over the step."""
    g, double = (Geometry(geometry, x, opencl_device, lanes=4) for x in (precision, "double"))
    for base in bases(geometry):
        for u in directions(geometry, "double"):
            for sign in (-1, 1):
                t = np.pi + sign * STEPS
                end, _ = double.flow(u, t, base)
                found, lengths, family = g.geodesics(end, 2, base, families=True)
                assert not family.any()
                gone = (0 if sign < 0 else 1) + np.zeros(len(t), int)
                rows = np.arange(len(t))
                # Coordinates of binary64, which single precision knows to 48 bits.
                grain = 4 * (EPSILON["double"] if precision == "double" else EPSILON["single"] ** 2)
                assert np.abs(lengths[rows, gone] / t - 1).max() <= 2 * EPSILON[precision] + grain
                assert (
                    np.abs(lengths[rows, 1 - gone] / (2 * np.pi - t) - 1).max()
                    <= 2 * EPSILON[precision] + grain
                )
                turned = np.abs(found[rows, gone] - u).max(axis=1)
                back = np.abs(found[rows, 1 - gone] + u).max(axis=1)
                assert (np.maximum(turned, back) <= 8 * EPSILON[precision] + 4 * grain / STEPS).all(), (
                    base,
                    u,
                )


@both_precisions
@both_spheres
def test_back_to_the_start(geometry: str, precision: str, opencl_device: Device) -> None:
    """Around the sphere, from both sides and exactly: the distance falls to nothing and rises again."""
    g, double = (Geometry(geometry, x, opencl_device, lanes=4) for x in (precision, "double"))
    steps = np.concatenate([-STEPS, [0], STEPS[::-1]])
    for base in bases(geometry):
        for u in directions(geometry, "double"):
            end, _ = double.flow(u, 2 * np.pi + steps, base)
            # 2 pi + step is rounded, and so are points, which single precision knows to 48 bits.
            grain = 8 * EPSILON["double"] if precision == "double" else EPSILON["single"] ** 2
            allowed = grain + 2.1 * EPSILON[precision] * np.abs(steps)
            assert (np.abs(g.distance(end, base) - np.abs(steps)) <= allowed).all(), (base, u)


@both_precisions
def test_areas_at_the_antipode(precision: str, opencl_device: Device) -> None:
    """All light that leaves a point comes together there: sin^2 in s3, t |sin l t|/l in s2xe, to nothing."""
    for geometry in ("s3", "s2xe"):
        g = Geometry(geometry, precision, opencl_device, lanes=4)
        for u in directions(geometry, precision):
            steps = np.concatenate([-STEPS, [0], STEPS[::-1]])
            t = np.pi + steps
            got = g.area_density(u, t)
            want = np.sin(np.abs(steps)) ** 2 if geometry == "s3" else t * np.abs(np.sin(steps))
            size = 1 if geometry == "s3" else np.pi**2
            # The sine is off by rounding, of which s3 has the square.
            sine = 4 * EPSILON[precision]
            allowed = sine * (sine + 2 * np.abs(steps)) if geometry == "s3" else size * sine
            assert (got >= 0).all() and (np.abs(got - want) <= allowed).all(), (geometry, got, want)
