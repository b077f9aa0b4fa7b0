"""Up the cusps of h3 and h2xe: points that go to an ideal point, on its horospheres and around it.

In the half-space with the ideal point at infinity they are (X, Y, h), with
w - z = 1/h, x = X/h, y = Y/h in h3, and with y left out and z for w in h2xe.
"""

import numpy as np
import pytest
from golden import EPSILON, MP, Array, cut, distance, exact, on_model
from small_kernels import Body, SmallKernels

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.program import geometry_parts
from thurston_cl.scene.writer import shape_parts

from .truth import both_precisions

HEIGHTS = {"single": (0.5, 3.0, 6.0, 12.0, 20.0, 40.0), "double": (0.5, 6.0, 12.0, 20.0, 100.0, 340.0)}


def up_the_cusp(heights: Array, beside: float) -> Array:
    """Points (N,4) of h3 at the horosphere of log h = `heights`, X = beside, Y = -beside/2."""
    with MP.workdps(400):
        rows = []
        for height in heights:
            h, X, Y = MP.exp(MP.mpf(float(height))), MP.mpf(beside), MP.mpf(-beside) / 2
            plus = h + (X * X + Y * Y) / h
            rows.append([float(X / h), float(Y / h), float((plus - 1 / h) / 2), float((plus + 1 / h) / 2)])
        return np.array(rows)


@both_precisions
def test_horoballs_about_the_ideal_point(precision: str, opencl_device: Device) -> None:
    """Towards it the distance to the horoball falls by the length gone, away from it it rises, beside it as
    (x, y) say; with all digits, though w - z has none left at log h = 20."""
    body = Body(4, 1, "OUT(0, horoball_distance(POINT(0), REAL(C(0.75))));")
    parts = (*geometry_parts("h3"), "scene_types.h", *sorted(shape_parts("h3", ["horoball"])))
    kernels = SmallKernels(opencl_device, parts, {"horoball": body}, precision, 4)
    heights = np.array([h for h in HEIGHTS[precision] if h < 44])
    for beside in (0.0, 0.7, 30.0):
        for sign in (1, -1):
            points = cut(up_the_cusp(sign * heights, beside), precision)
            got = kernels.run("horoball", points.T)[0].astype(float)
            with MP.workdps(400):
                rows = exact(points)
                # Of the points as rounded, whose w is that of the model.
                square = (rows[:, :3] ** 2).sum(axis=1)
                want = [
                    float(MP.log(MP.sqrt(1 + s) - z) + 0.75) for s, z in zip(square, rows[:, 2], strict=True)
                ]
            size = 4 * (1 + np.abs(want))
            # Away from the ideal point w - z is a sum: of rounded coordinates.
            assert (np.abs(got - want) <= EPSILON[precision] * size).all(), (beside, sign, got, want)


@both_precisions
def test_distances_from_the_origin_up_the_cusp(precision: str, opencl_device: Device) -> None:
    g = Geometry("h3", precision, opencl_device, lanes=4)
    for beside in (0.0, 0.7, 30.0):
        points = up_the_cusp(np.array(HEIGHTS[precision]), beside)
        with MP.workdps(400):
            p = on_model("h3", exact(points[:, :3]))
            want = distance("h3", on_model("h3", exact(np.zeros((len(points), 3)))), p).astype(float)
        assert np.abs(g.distance(points) / want - 1).max() <= 4 * EPSILON[precision], beside


# By how far up: what the heads of h3.h and h2xe.h say of distances at that distance from the origin.
STATED = {
    "h3": {6.0: (4.2e-6, 4.3e-16), 12.0: (1.7e-3, 4.3e-16)},
    "h2xe": {6.0: (5.2e-6, 9.8e-15), 12.0: (1.9e-3, 2.9e-12)},
}


@both_precisions
@pytest.mark.parametrize("geometry", STATED)
def test_distances_of_points_beside_each_other_up_the_cusp(
    geometry: str, precision: str, opencl_device: Device
) -> None:
    """X = 1 apart on a horosphere: e^-height as far, and what the coordinates have left of it."""
    g = Geometry(geometry, precision, opencl_device, lanes=4)
    for height, stated in STATED[geometry].items():
        # At separations from 0.1 on, which the heads are about.
        for step in (0.1, 1.0, 3.0):
            p, q = (up_the_cusp(np.array([height]), x * np.exp(height)) for x in (0.0, step))
            p, q = (cut(x[:, :3], precision) for x in (p, q))
            if geometry == "h2xe":
                p[:, 1] = q[:, 1] = 0
            with MP.workdps(100):
                a, b = (on_model("h3", exact(x)) for x in (p, q))
                want = float(distance("h3", a, b)[0])
            points = [np.column_stack([x, np.sqrt(1 + (x**2).sum(axis=1))]) for x in (p, q)]
            if geometry == "h2xe":
                # x and z of H2, with the ideal point along +y.
                points = [np.column_stack([x[:, 0], x[:, 2], x[:, 3], 0 * x[:, 0]]) for x in points]
            got = g.distance(points[1], points[0])[0]
            assert abs(got / want - 1) <= stated[precision == "double"], (height, step, got, want)


@both_precisions
def test_up_and_down_again(precision: str, opencl_device: Device) -> None:
    """Along the geodesic into the cusp and back: as exact as its coordinates, and the frame does not turn."""
    for geometry, u in (("h3", [0, 0, 1.0]), ("h2xe", [0, 1.0, 0])):
        g = Geometry(geometry, precision, opencl_device, lanes=4)
        for height in HEIGHTS[precision]:
            point, ahead = g.flow(u, height)
            np.testing.assert_allclose(ahead[0], u, atol=EPSILON[precision])
            assert abs(g.distance(point)[0] / height - 1) <= 4 * EPSILON[precision]
            # The way back subtracts products of size w^2.
            if height <= 6:
                back, _ = g.flow(-ahead, height, point)
                assert g.distance(back)[0] <= 2 * EPSILON[precision] * np.cosh(height) ** 2, height
