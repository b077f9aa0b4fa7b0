"""kernels/light/falloff_*.h: how light fades, against the area density of `Geometry` in double precision, and
how bright it is where that has no bound: at the light itself and where its wave fronts focus.
"""

from typing import Any

import numpy as np
import pytest
from golden import EPSILON, Array, cut
from small_kernels import Body, SmallKernels

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.models import GEOMETRIES
from thurston_cl.program import geometry_parts

FALLOFFS = ("area", "inverse", "inverse_square", "constant")
# Up to so many times what a picture shows as white, at intensity 1, the law holds: falloff_*.h.
LAW_HOLDS_TO = 1000.0
ARRIVAL = "arrival a = {{IN(0), IN(1), IN(2)}, IN(3), IN(4), IN(4) == IN(4)}; OUT(0, falloff_NAME(a));"
DIRECTIONS = np.array([[0.6, 0.0, 0.8], [0.48, 0.64, 0.6], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])

both_precisions = pytest.mark.parametrize("precision", EPSILON)
all_geometries = pytest.mark.parametrize("geometry", GEOMETRIES)


def brightness(
    device: Device, geometry: str, precision: str, falloff: str, u: Array, t: Array, intensity: float = 1.0
) -> Array:
    """What arrives (N,) from directions (N,3) along geodesics of the lengths (N,)."""
    parts = (*geometry_parts(geometry), "scene_types.h", "light/phong.h", f"light/falloff_{falloff}.h")
    body = Body(5, 1, ARRIVAL.replace("NAME", falloff))
    kernels = SmallKernels(device, parts, {"falloff": body}, precision, 4)
    inputs: Any = np.column_stack([u, t, np.full(len(t), intensity)])
    return kernels.run("falloff", inputs.T)[0].astype(np.float64)


def lengths_of(values: Array, precision: str) -> tuple[Array, Array]:
    """Every direction with every length: (N,3), (N,), numbers of the precision."""
    u = np.repeat(DIRECTIONS, len(values), axis=0)
    return cut(u, precision), cut(np.tile(values, len(DIRECTIONS)), precision)


@both_precisions
@all_geometries
def test_light_fades_by_its_law_until_it_is_far_brighter_than_white(
    geometry: str, precision: str, opencl_device: Device
) -> None:
    """AREA_DENSITY_FLOOR, LENGTH_FLOOR and SQUARE_LENGTH_FLOOR, from above: none dims what one sees."""
    u, t = lengths_of(np.geomspace(1.0 / LAW_HOLDS_TO, 2.5, 60) * (1 + 1e-6), precision)
    area = Geometry(geometry, "double", opencl_device, lanes=4).area_density(
        u / np.linalg.norm(u, axis=1, keepdims=True), t
    )
    laws = {"area": 1 / area, "inverse": 1 / t, "inverse_square": t**-2.0, "constant": np.ones_like(t)}
    for falloff in FALLOFFS:
        for intensity in (1.0, 0.125):
            got = brightness(opencl_device, geometry, precision, falloff, u, t, intensity)
            bright = laws[falloff] <= LAW_HOLDS_TO
            assert bright.sum() > len(t) / 3
            # The area density loses digits as its factors do; a floor would take half of it and more.
            allowed = (400 if falloff == "area" else 4) * EPSILON[precision]
            off = np.abs(got / (laws[falloff] * intensity) - 1)[bright]
            assert off.max() <= allowed, (falloff, intensity, off.max() / EPSILON[precision])


@both_precisions
@all_geometries
def test_light_has_a_greatest_brightness(geometry: str, precision: str, opencl_device: Device) -> None:
    """AREA_DENSITY_FLOOR, LENGTH_FLOOR and SQUARE_LENGTH_FLOOR, from below: at the light it is brighter than
    the law needs, and in a sum of single precision what else there is keeps a digit beside it."""
    u, t = lengths_of(np.concatenate([[0.0, 1e-30], 10.0 ** np.arange(-12.0, -3)]), precision)
    for falloff in ("area", "inverse", "inverse_square"):
        got = brightness(opencl_device, geometry, precision, falloff, u, t)
        assert (got >= LAW_HOLDS_TO * (1 - 4 * EPSILON[precision])).all(), (falloff, got.min())
        assert (got <= 1 / EPSILON["single"]).all(), (falloff, got.max())
        assert got[0] == got.max(), falloff
        half = brightness(opencl_device, geometry, precision, falloff, u, t, 0.5)
        np.testing.assert_array_equal(half, got / 2)


# Directions and lengths at which all geodesics nearby meet again.
FOCI = {
    "s3": ([0.6, 0.0, 0.8], np.pi),
    "s2xe": ([1.0, 0.0, 0.0], np.pi),
    "nil": ([0.6, 0.0, 0.8], 2 * np.pi / 0.8),
    "sl2": ([0.6, 0.0, 0.8], 2 * np.pi / np.sqrt(0.28)),
}


@both_precisions
@pytest.mark.parametrize("geometry", FOCI)
def test_light_that_is_focused_stays_finite(geometry: str, precision: str, opencl_device: Device) -> None:
    """The brightness rises towards the focus, and in it is no more than at the light."""
    u, focus = FOCI[geometry]
    # Rounding moves the focus itself, in single precision by more than the last step here.
    t = focus * (1 - np.array([1e-1, 1e-2, 1e-3, 1e-4, 0.0]))
    got = brightness(opencl_device, geometry, precision, "area", np.tile(u, (5, 1)), t)
    at_light = brightness(opencl_device, geometry, precision, "area", np.array([u]), np.zeros(1))[0]
    assert (np.diff(got[:4]) > 0).all() and np.isfinite(got).all() and (got <= at_light).all()
    assert got[4] > 100 * got[0] or precision == "single"
