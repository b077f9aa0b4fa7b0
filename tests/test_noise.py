"""Noise: the kernel against a reference in NumPy, the same bits at every width, where octaves fade, and what
pictures show of it.
"""

from typing import Any

import numpy as np
import pytest
from golden import constant
from small_kernels import Body, SmallKernels

import thurston_cl as tc
from thurston_cl.device import Device
from thurston_cl.program import LANE_WIDTHS, geometry_parts
from thurston_cl.scene import load_text
from thurston_cl.scene.plan import make_plan

PARTS = (
    *geometry_parts("e3"),
    "scene_types.h",
    "lane_integers.h",
    "pattern/footprint.h",
    "pattern/noise.h",
)
_SCENE = "scene_data scene = {numbers, 0, 0, 0};\npoint p = {IN(0), IN(1), IN(2), REAL(1)};\n"
OCTAVES = 5
BODIES = {
    "sum": Body(4, 1, _SCENE + f"OUT(0, noise_value(p, IN(3), scene, 3, {OCTAVES}));"),
    "one": Body(3, 1, "OUT(0, gradient_noise(IN(0), IN(1), IN(2), 0));"),
    "told": Body(1, 1, "OUT(0, told_apart(IN(0)));"),
    "left": Body(2, 1, "OUT(0, octave_left(IN(0), IN(1)));"),
    "color": Body(
        5,
        3,
        _SCENE
        + "footprint f = {IN(3), IN(4), REAL(0)};\n"
        + f"real3_lanes c = noise(p, f, scene, 3, {OCTAVES}, 3);\nOUT(0, c.x); OUT(1, c.y); OUT(2, c.z);",
    ),
    "hash": Body(1, 1, "OUT(0, UINT_TO_REAL(mixed_bits(TO_UINT(IN(0))) & 0xffffU));"),
}
SHIFT = np.array([constant("pattern/noise.h", f"NOISE_SHIFT_{axis}") for axis in "XYZ"])


def kernels(device: Device, precision: str, lanes: int) -> SmallKernels:
    if precision == "double" and not device.info.fp64:
        pytest.skip("the device has no double precision")
    return SmallKernels(device, PARTS, BODIES, precision, lanes)


def mixed_bits(x: np.ndarray) -> np.ndarray:
    """lowbias32, by its definition; uint32 arithmetic of NumPy wraps around."""
    x = x ^ (x >> np.uint32(16))
    x = x * np.uint32(0x7FEB352D)
    x = x ^ (x >> np.uint32(15))
    x = x * np.uint32(0x846CA68B)
    return x ^ (x >> np.uint32(16))


def reference(points: np.ndarray, seed: int) -> np.ndarray:
    """Gradient noise at points (N,3): the eight corners one by one, weighted by products of the quintic."""
    cell = np.floor(points)
    inside = points - cell
    whole = cell.astype(np.int64).astype(np.uint32)
    total = np.zeros(len(points))
    for corner in np.ndindex(2, 2, 2):
        i, j, k = (whole[:, axis] + np.uint32(corner[axis]) for axis in range(3))
        bits = mixed_bits(i + mixed_bits(j + mixed_bits(k + np.uint32(seed))))
        gradient = np.stack([(bits >> np.uint32(10 * axis)) & np.uint32(1023) for axis in range(3)], axis=1)
        way = inside - corner
        value = ((gradient / 511.5 - 1) * way).sum(axis=1)
        t = 1 - np.abs(way)
        total += value * (6 * t**5 - 15 * t**4 + 10 * t**3).prod(axis=1)
    return total


def points_of(count: int, reach: float, seed: int = 4) -> np.ndarray:
    """Points (N,3) that single precision holds exactly."""
    return np.random.default_rng(seed).uniform(-reach, reach, (count, 3)).astype(np.float32)


@pytest.mark.parametrize("precision", ["single", "double"])
def test_against_the_reference_and_the_same_bits_at_every_width(
    precision: str, opencl_device: Device
) -> None:
    points, size = points_of(3000, 20), np.array([0.5, 0.25, 2.0])
    scaled = points.astype(np.float64) / size
    expected = sum(0.5**o * reference(2**o * scaled + o * SHIFT, o) for o in range(OCTAVES))
    numbers = [0, 0, 0, *(1 / size), size.min()]
    inputs = np.vstack([points.T, np.full(len(points), 1e-9)])
    alone = None
    for lanes in LANE_WIDTHS:
        got = kernels(opencl_device, precision, lanes).run("sum", inputs, numbers)[0]
        # Coordinates up to 80 cubes, 16 times as many in the last octave; gradients up to the root of 3.
        rounding = {"single": 2.0**-24, "double": 2.0**-53}[precision]
        np.testing.assert_allclose(got, expected, rtol=0, atol=40 * 80 * rounding)
        alone = got if alone is None else alone
        np.testing.assert_array_equal(got, alone)
    assert expected.std() > 0.15


@pytest.mark.parametrize("precision", ["single", "double"])
def test_the_hash_is_on_whole_numbers(precision: str, opencl_device: Device) -> None:
    """Its last 16 bits, which both precisions hold; of negative numbers too."""
    whole = np.concatenate([np.arange(-500, 500), [2**24, -(2**24), 2**24 - 1]])
    expected = mixed_bits(whole.astype(np.int64).astype(np.uint32)) & np.uint32(0xFFFF)
    for lanes in LANE_WIDTHS:
        got = kernels(opencl_device, precision, lanes).run("hash", whole[None])[0]
        np.testing.assert_array_equal(got, expected)
    assert len(np.unique(expected)) > 0.98 * len(whole)


def test_noise_is_smooth_over_the_sides_of_its_cubes_and_zero_at_their_corners(opencl_device: Device) -> None:
    at = kernels(opencl_device, "double", 8)
    corners = np.array(list(np.ndindex(5, 5, 5))) - 2.0
    np.testing.assert_array_equal(at.run("one", corners.T)[0], 0)
    step = 1e-5
    sides = points_of(500, 10).astype(np.float64)
    sides[:, 1] = np.rint(sides[:, 1])
    below, on, above = (at.run("one", (sides + np.array([0, d, 0])).T)[0] for d in (-step, 0, step))
    # Twice differentiable: the second difference is that of a smooth function.
    assert np.abs(above - on).max() > 0.5 * step
    assert np.abs(above - 2 * on + below).max() < 20 * step**2


def test_values_are_spread_as_the_gain_says(opencl_device: Device) -> None:
    """0 on average, and 2 standard deviations times NOISE_GAIN are the half of all colors."""
    at = kernels(opencl_device, "single", 8)
    points = points_of(40000, 200)
    values = at.run("sum", np.vstack([points.T, np.full(len(points), 1e-9)]), [0, 0, 0, 1, 1, 1, 1])[0]
    gain = constant("pattern/noise.h", "NOISE_GAIN")
    assert abs(values.mean()) < 0.005
    assert 2 * values.std() * gain == pytest.approx(0.5, abs=0.02)
    assert np.mean(np.abs(values) * gain > 0.5) < 0.06


def test_octaves_fade_until_a_pixel_is_as_long_as_their_cubes(opencl_device: Device) -> None:
    """On both sides of NOISE_SHARP_FROM footprints and of half as many."""
    at = kernels(opencl_device, "single", 4)
    sharp = constant("pattern/noise.h", "NOISE_SHARP_FROM")
    ratios = sharp * np.array([100, 1.001, 1, 0.999, 0.75, 0.501, 0.5, 0.499, 0.01])
    left = at.run("left", np.stack([3 * ratios, np.full(len(ratios), 3)]))[0]
    np.testing.assert_allclose(left, [1, 1, 1, 0.998, 0.5, 0.002, 0, 0, 0], atol=1e-5)
    np.testing.assert_array_equal(at.run("left", [[1, 1], [0, np.nan]])[0], 1)


@pytest.mark.parametrize("precision", ["single", "double"])
def test_octaves_fade_until_numbers_no_longer_tell_their_points_apart(
    precision: str, opencl_device: Device
) -> None:
    """On both sides of NOISE_FAR cubes and of half as many, of the whole numbers of 32 bits and of all
    numbers, along each axis; at every width.
    """
    far = constant("pattern/noise.h", "NOISE_FAR")
    share = np.array([0.25, 0.499, 0.5, 0.501, 0.75, 0.999, 1.0, 1.001, 2.0**13, 2.0**14, 1e20])
    want = [1, 1, 1, 0.998, 0.5, 0.002, 0, 0, 0, 0, 0]
    at = kernels(opencl_device, precision, 4)
    for sign in (1, -1):
        np.testing.assert_allclose(at.run("told", sign * far * share[None])[0], want, atol=1e-5)
    np.testing.assert_array_equal(at.run("told", [[np.nan, np.inf, -np.inf]])[0], 0)
    points = points_of(6 * len(share), 20).reshape(6, -1, 3).astype(np.float64)
    for axis, sign in np.ndindex(3, 2):
        # A multiple of 1/32: single precision holds it up to there.
        points[2 * axis + sign, :, axis] = (1 - 2 * sign) * (np.floor(far * share) + 0.40625)
    points = points.reshape(-1, 3)
    scaled = [2**o * points + o * SHIFT for o in range(OCTAVES)]
    expected = np.zeros(len(points))
    for o, octave in enumerate(scaled):
        left = np.clip(2 - 2 * np.abs(octave) / far, 0, 1).prod(axis=1)
        kept = np.where(left[:, None] > 0, octave, 0)
        expected += 0.5**o * left * reference(kept, o)
    inputs, numbers = np.vstack([points.T, np.full(len(points), 1e-9)]), [0, 0, 0, 1, 1, 1, 1]
    alone = None
    for lanes in LANE_WIDTHS:
        got = kernels(opencl_device, precision, lanes).run("sum", inputs, numbers)[0]
        np.testing.assert_allclose(got, expected, rtol=0, atol=0.1 if precision == "single" else 1e-9)
        alone = got if alone is None else alone
        np.testing.assert_array_equal(got, alone)
    beyond = np.abs(points).max(axis=1) > far
    assert beyond.sum() == 6 * 5
    assert not got[beyond].any()
    assert expected[~beyond].std() > 0.05


def test_what_is_left_of_the_octaves(opencl_device: Device) -> None:
    """Where a pixel is as long as the cubes of octave 3, it and those after it are gone; of octave 2 all is
    there."""
    at, points = kernels(opencl_device, "double", 4), points_of(200, 5).astype(np.float64)
    covered = 1 / 8
    got = at.run("sum", np.vstack([points.T, np.full(200, covered)]), [0, 0, 0, 1, 1, 1, 1])[0]
    expected = sum(0.5**o * reference(2**o * points + o * SHIFT, o) for o in range(3))
    np.testing.assert_allclose(got, expected, atol=1e-12)


def test_colors_follow_each_other_evenly(opencl_device: Device) -> None:
    at, points = kernels(opencl_device, "double", 4), points_of(2000, 5).astype(np.float64)
    colors = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]])
    numbers = [0, 0, 0, 1, 1, 1, 1, *colors.ravel()]
    beam = np.full((2, 2000), 1e-9)
    beam[1] = 1e-18
    got = at.run("color", np.vstack([points.T, beam]), numbers)
    value = at.run("sum", np.vstack([points.T, beam[:1]]), numbers)[0]
    place = np.clip(0.5 + constant("pattern/noise.h", "NOISE_GAIN") * value, 0, 1)
    expected = [np.interp(place, [0, 0.5, 1], column) for column in colors.T]
    np.testing.assert_allclose(got, expected, atol=1e-12)
    assert (got[0] == 1).any() and (got[2] == 1).any()
    # A beam twice as long along the surface blurs as one that is twice as wide.
    long = at.run("color", np.vstack([points.T, np.full(2000, 0.1), np.full(2000, 0.02)]), numbers)
    wide = at.run("color", np.vstack([points.T, np.full(2000, 0.2), np.full(2000, 0.04)]), numbers)
    np.testing.assert_allclose(long, wide, atol=1e-12)
    points[3] = np.nan
    lost = np.isnan(at.run("color", np.vstack([points.T, beam]), numbers)).any(axis=0)
    np.testing.assert_array_equal(np.flatnonzero(lost), [3])


# -- pictures ------------------------------------------------------------------------------------------------

GLOW = "ambient: 1, diffuse: 0, specular: 0"
NOISE = "{noise: {size: 0.3, octaves: 3, colors: [black, white]}}"


def seen(text: str, **settings: Any) -> tc.Image:
    image = tc.render(load_text(text), **{"size": (64, 40), "samples": 1} | settings)
    assert image.statistics["nan"] == 0
    return image


@pytest.mark.parametrize("geometry", ["e3", "s3", "h3"])
def test_noise_moves_with_its_object(geometry: str) -> None:
    """A ball at the origin from the camera, and the ball and the camera moved alike along an axis; and a ball
    that turns about the axis along which it is seen turns its picture."""

    def ball(shift: float, turn: int, roll: int) -> np.ndarray:
        return seen(
            f"geometry: {geometry}\n"
            f"camera: {{at: [{shift - 1}, 0, 0], look: {{along: [1, 0, 0]}}, move: [roll: {roll} deg]}}\n"
            f"objects: [{{ball: {{radius: 0.4}}, at: [{shift}, 0, 0], material: {{color: {NOISE}, {GLOW}}},\n"
            f"          rotate: {{axis: [1, 0, 0], angle: {turn} deg}}}}]\n"
            "lights: [point: {at: [0, 0, 1]}]\n",
            precision="double",
        ).channels["beauty"]

    still = ball(0, 0, 0)
    assert np.ptp(still) > 0.3
    for other in (ball(0.7, 0, 0), ball(0.7, 30, 30), ball(-0.4, 90, 90)):
        off = np.abs(other - still).max(axis=2) > 1e-4
        # Edges may move by a pixel.
        assert np.count_nonzero(off) <= 0.01 * off.size
    assert np.mean(np.abs(ball(0, 30, 0) - still).max(axis=2) > 1e-2) > 0.05


def test_noise_is_a_value_of_the_point() -> None:
    """A plane seen from straight above: each pixel has the color of the reference there."""
    size, height = (40, 24), 2.0
    image = seen(
        f"geometry: e3\ncamera: {{at: [0, 0, {height}], look: {{along: [0, 0, -1], up: [0, 1, 0]}},"
        " fov: 40 deg}\n"
        "objects: [{half-space: {normal: [0, 0, 1], offset: 0.3}, at: [0.1, -0.2, 0],\n"
        "           rotate: {axis: [0, 0, 1], angle: 90 deg},\n"
        f"           material: {{color: {{noise: {{size: 0.9, octaves: 1, stretch: [1, 2, 0.5],"
        f" colors: [black, white]}}}}, {GLOW}}}}}]\n"
        "lights: [point: {at: [0, 0, 9]}]\n",
        size=size,
        precision="double",
    )
    x, y = np.meshgrid(np.arange(size[0]) + 0.5 - size[0] / 2, size[1] / 2 - np.arange(size[1]) - 0.5)
    scale = np.tan(np.radians(20)) / (size[1] / 2) * (height - 0.3)
    # The frame of the object is turned by a quarter: its x is the y of the scene.
    own = np.stack([y * scale + 0.2, -(x * scale - 0.1), np.full(x.shape, 0.3)], axis=-1).reshape(-1, 3)
    value = reference(own / (0.9 * np.array([1, 2, 0.5])), 0)
    expected = np.clip(0.5 + constant("pattern/noise.h", "NOISE_GAIN") * value, 0, 1)
    got = image.channels["beauty"][..., 0].ravel()
    np.testing.assert_allclose(got, expected, atol=2e-4)
    assert np.ptp(got) > 0.5


def test_far_ground_does_not_flicker() -> None:
    """With one sample a pixel it looks as with 64, up to the horizon."""
    text = (
        "geometry: e3\ncamera: {at: [0, 0, 0.3], look: {along: [0, 1, -0.12]}, fov: 30 deg}\n"
        "objects: [{half-space: {}, material: {color: {noise: {size: 0.5, octaves: 8,"
        f" colors: [black, white]}}}}, {GLOW}}}}}]\n"
        "lights: [point: {at: [0, 0, 1]}]\nrender: {steps: 2000}\n"
    )
    one, many = (seen(text, size=(96, 64), samples=n).channels["beauty"][20:, :, 0] for n in (1, 64))
    assert many.std() > 0.05
    assert np.sqrt(np.mean((one - many) ** 2)) < 0.02


@pytest.mark.parametrize("precision", ["single", "double"])
def test_pictures_are_the_same_at_every_width(precision: str, opencl_device: Device) -> None:
    text = (
        "geometry: e3\ncamera: {at: [0, -2, 0.5], look: {to: [0, 0, 0]}}\n"
        f"objects: [{{ball: {{radius: 0.5}}, material: {{color: {NOISE}}}}}]\n"
    )
    pictures = [seen(text, precision=precision, lanes=n).channels["beauty"] for n in (1, 8, 16)]
    for other in pictures[1:]:
        np.testing.assert_array_equal(other, pictures[0])


def test_noise_counts_its_octaves() -> None:
    plan = make_plan(
        load_text(f"geometry: e3\nobjects: [{{ball: {{radius: 1}}, material: {{color: {NOISE}}}}}]")
    )
    assert plan.costs["noise"].count == 3
    assert "lane_integers.h" in plan.parts
    plain = make_plan(load_text("geometry: e3\nobjects: [{ball: {radius: 1}}]"))
    assert not {"lane_integers.h", "pattern/footprint.h"} & set(plain.parts)
