"""Whole pictures: the same by single and double precision, by every width of the kernels, by both ways to
finish packets, in tiles of any size, as a whole and in parts, on every device that there is; and what seeds
change.

That no scene of the library has a pixel without a number is asked where all of them are rendered, in
test_library_pictures.py.
"""

import itertools
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
import test_library_pictures as in_library

import thurston_cl as tc
from thurston_cl import device as devices
from thurston_cl import rendering
from thurston_cl.device import Device
from thurston_cl.image import Image
from thurston_cl.models import GEOMETRIES

from .pictures import check_finite, differing, picture
from .test_cameras import SPACE

CHANNELS = ("beauty", "depth", "normal", "steps", "object")
each_geometry = pytest.mark.parametrize("geometry", GEOMETRIES)
SIZE = (96, 64)


def check_same(one: Image, other: Image, but: Mapping[str, int] | None = None) -> None:
    """Equal to the last bit, but for so many numbers in a channel."""
    for name, values in one.channels.items():
        off = np.count_nonzero(values != other.channels[name])
        assert off <= (but or {}).get(name, 0), (name, off)


# -- single and double precision -----------------------------------------------------------------------------

# Of 6144 pixels: how many may show another object, and how many depths may differ by more than 0.01. By
# default a ray or two that graze something; measured are 0 and at most 1. Beyond that, why:
GRAZING = (2, 3)
MORE_DIFFER = {
    # Rays that pass many cells part like e^t, and those that graze edges are 0.01 off after six of them.
    "h3/hyperideal-cube": (4, 40),
    "h3/ideal-cube": (4, 100),
    "h2xe/orbi-torus-tile": (4, 10),
}
# Each tracer, on a scene of the library that is made for it.
TRACED = {
    "compound": ("e3/rock-smooth", ["render.tracer=compound"]),
    "compound-by-blocks": ("e3/rock-smooth", ["render.tracer=compound", "render.start=block"]),
    "binary": ("e3/palm-leaf-iterations", []),
    "relaxed": ("e3/palm-leaf-iterations", ["render.tracer=relaxed"]),
}


def check_precisions(name: str, single: Image, double: Image) -> None:
    check_finite(single)
    check_finite(double)
    ids, depths = MORE_DIFFER.get(name, GRAZING)
    assert np.count_nonzero(single.channels["object"] != double.channels["object"]) <= ids
    both = np.isfinite(single.channels["depth"]) & np.isfinite(double.channels["depth"])
    off = np.abs(single.channels["depth"][both] - double.channels["depth"][both])
    assert np.count_nonzero(off > 0.01) <= depths
    # Half of all depths are known far better than rays are marched.
    assert np.median(off) <= 1e-5


@pytest.mark.parametrize("name", in_library.COMPARED)
def test_single_precision_sees_what_double_sees(name: str, opencl_device: Device) -> None:
    if not opencl_device.info.fp64:
        pytest.skip("the device has no double precision")
    check_precisions(name, in_library.picture(name), in_library.picture(name, precision="double"))


@pytest.mark.parametrize("tracer", TRACED)
def test_tracers_see_the_same_in_both_precisions(tracer: str, opencl_device: Device) -> None:
    if not opencl_device.info.fp64:
        pytest.skip("the device has no double precision")
    name, sets = TRACED[tracer]
    scene = tc.load_scene(name, sets=sets)
    single, double = (
        tc.render(scene, size=SIZE, samples=1, lanes=1, precision=precision)
        for precision in ("single", "double")
    )
    check_precisions(name, single, double)


# -- ways to work a picture out ------------------------------------------------------------------------------


def space(geometry: str, **settings: Any) -> Image:
    """Two balls, a half-space and shadows, from beside the light."""
    view = "at: [0, 0.4, 0.1], look: {along: [0.8, -0.4, 0.2]}, fov: 120 deg"
    text = SPACE.replace("GEOMETRY", geometry).replace("CAMERA", view)
    return picture(text, **{"size": SIZE, "lanes": 4, "channels": CHANNELS} | settings)


# How many numbers of a picture of one lane may differ from those of the other widths: built-in functions for
# one number and for many differ in the last bit of exp and log. In sol each step takes exp; elsewhere it is
# highlights alone that do.
ONE_LANE = {"beauty": 40, "normal": 4}
ONE_LANE_SOL = {"beauty": 300, "normal": 120, "depth": 20}


@each_geometry
def test_every_width_makes_the_same_picture(geometry: str) -> None:
    one, four, sixteen = (space(geometry, lanes=lanes) for lanes in (1, 4, 16))
    check_finite(four)
    assert len(np.unique(four.channels["object"])) >= 3
    check_same(four, sixteen)
    check_same(one, four, ONE_LANE_SOL if geometry == "sol" else ONE_LANE)
    np.testing.assert_allclose(one.channels["beauty"], four.channels["beauty"], rtol=1e-4, atol=1e-5)


@each_geometry
def test_packets_tiles_and_crops_make_the_same_picture(
    geometry: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = space(geometry, finish="packet")
    check_same(whole, space(geometry, finish="refill"))
    left, top, right, bottom = area = (13, 7, 78, 50)
    part = space(geometry, crop=area)
    for name, values in part.channels.items():
        np.testing.assert_array_equal(values, whole.channels[name][top:bottom, left:right], err_msg=name)
    # Tiles of which the last in each row and column are cut off.
    for side in (32, 64):
        monkeypatch.setattr(rendering, "TILE_SIDE", {"cpu": side})
        monkeypatch.setattr(rendering, "TILE_SIDE_ELSEWHERE", side)
        check_same(whole, space(geometry))


@pytest.mark.parametrize(
    ("projection", "size"),
    [("equirectangular: {}", (96, 48)), ("fisheye: {angle: 220 deg}", (64, 64)), ("dome: {}", (64, 64))],
)
def test_parts_of_other_projections(projection: str, size: tuple[int, int]) -> None:
    view = f"at: [0, 0.4, 0.1], projection: {{{projection}}}"
    text = SPACE.replace("GEOMETRY", "h3").replace("CAMERA", view)
    settings = {"size": size, "lanes": 4, "channels": CHANNELS}
    whole = picture(text, **settings)
    for area in ((0, 0, 31, 17), (40, 20, 64, 48), (63, 47, 64, 48)):
        part = picture(text, crop=area, **settings)
        left, top, right, bottom = area
        for name, values in part.channels.items():
            np.testing.assert_array_equal(values, whole.channels[name][top:bottom, left:right], err_msg=name)


@pytest.mark.parametrize("geometry", ["e3", "nil"])
def test_seeds_move_samples_and_nothing_else(geometry: str) -> None:
    view = "at: [0, 0.4, 0.1], look: {along: [0.8, -0.4, 0.2]}, fov: 120 deg"
    text = SPACE.replace("GEOMETRY", geometry).replace("CAMERA", view)
    seeded = [text.replace("far: 8", f"far: 8, seed: {seed}") for seed in (0, 1, 2)]
    settings = {"size": SIZE, "lanes": 4, "channels": CHANNELS}
    images = [picture(each, samples=16, **settings) for each in seeded]
    check_same(images[1], picture(seeded[1], samples=16, **settings))
    for one, other in itertools.combinations(images, 2):
        assert not np.array_equal(one.channels["beauty"], other.channels["beauty"])
    # Seeds differ where there are edges, and agree on what they average.
    means = [image.channels["beauty"].mean() for image in images]
    np.testing.assert_allclose(means, means[0], rtol=0.01)


def test_every_device_shows_the_same(opencl_device: Device) -> None:
    """They round alike but for built-in functions."""
    others = [
        info.id for info in devices.list_devices() if info != opencl_device.info and devices.probe(info).ok
    ]
    if not others:
        pytest.skip("there is one device")
    for geometry, other in itertools.product(GEOMETRIES, others):
        here, there = space(geometry), space(geometry, device=other)
        check_finite(there)
        assert differing(here, there) <= 0.002, (geometry, other)
