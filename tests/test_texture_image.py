"""Images on surfaces: reading them, their pyramid, the look-up in the kernel, and what pictures show."""

import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import pytest
from click.testing import CliRunner
from small_kernels import Body, SmallKernels

import thurston_cl as tc
from thurston_cl.cli.main import main
from thurston_cl.device import Device
from thurston_cl.errors import MissingFileError, SceneError
from thurston_cl.image import MOST_TEXELS, read_texture
from thurston_cl.models import GEOMETRIES
from thurston_cl.program import LANE_WIDTHS, geometry_parts
from thurston_cl.rendering import TileRenderer
from thurston_cl.scene import load_scene, load_text
from thurston_cl.scene.image_file import ImageFile
from thurston_cl.scene.plan import make_plan
from thurston_cl.scene.texels import TEXEL_PAGE, Texels, halved, pyramid

EPSILON = {"single": 2.0**-23, "double": 2.0**-52}


def write(path: Path, pixels: Any, kind: str = "float", **attributes: Any) -> Path:
    """An image file of pixels (H,W,C) in [0, 1], stored as `kind`."""
    array = np.ascontiguousarray(pixels, np.float32)
    spec = oiio.ImageSpec(array.shape[1], array.shape[0], array.shape[2], kind)
    for name, value in attributes.items():
        spec[name.replace("__", ":")] = value
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec)
    assert out.write_image(array)
    assert out.close()
    return path


def noise(height: int, width: int) -> np.ndarray:
    return np.random.default_rng(7).random((height, width, 3), np.float32)


# -- reading -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "suffix"), [("uint8", "png"), ("uint16", "png"), ("uint8", "tif")])
def test_integers_are_read_as_srgb(kind: str, suffix: str, tmp_path: Path) -> None:
    """IEC 61966-2-1 of the code value that is nearest to 0.46136, which is 0.18 in linear light."""
    levels = 255 if kind == "uint8" else 65535
    code = round(0.46136 * levels) / levels
    read = read_texture(write(tmp_path / f"gray.{suffix}", np.full((2, 3, 3), 0.46136), kind))
    assert read.shape == (2, 3, 3)
    assert read.dtype == np.float32
    np.testing.assert_allclose(read, ((code + 0.055) / 1.055) ** 2.4, rtol=1e-4)
    assert abs(read[0, 0, 0] - 0.18) < 0.002


@pytest.mark.parametrize(("kind", "suffix"), [("float", "exr"), ("half", "exr"), ("float", "tif")])
def test_floats_are_read_as_linear_light(kind: str, suffix: str, tmp_path: Path) -> None:
    pixels = np.array([[[0.25, 0.5, 4.0], [0, 1, 2]]], np.float32)
    np.testing.assert_array_equal(read_texture(write(tmp_path / f"linear.{suffix}", pixels, kind)), pixels)


def test_the_color_space_that_a_file_names_counts(tmp_path: Path) -> None:
    pixels = np.full((1, 1, 3), 0.5)
    said = write(tmp_path / "said.png", pixels, "uint16", oiio__ColorSpace="g22_rec709_scene")
    np.testing.assert_allclose(read_texture(said), 0.5**2.2, rtol=1e-4)


def test_gray_and_alpha(tmp_path: Path) -> None:
    gray = read_texture(write(tmp_path / "gray.exr", np.full((1, 2, 1), 0.25)))
    np.testing.assert_array_equal(gray, np.full((1, 2, 3), np.float32(0.25)))
    # PNG stores colors that are not times alpha.
    clear = np.dstack([np.full((1, 2, 3), 0.25), [[[0.5], [0.5]]]])
    stored = write(tmp_path / "clear.png", clear, "uint8", oiio__UnassociatedAlpha=1)
    opaque = write(tmp_path / "opaque.png", clear[..., :3], "uint8")
    np.testing.assert_array_equal(read_texture(stored), read_texture(opaque))


def test_files_that_are_no_images(tmp_path: Path) -> None:
    (tmp_path / "text.jpg").write_text("no image")
    with pytest.raises(MissingFileError, match=r"text\.jpg: is no image that can be read: "):
        read_texture(tmp_path / "text.jpg")
    for name in ("whole.png", "whole.jpg", "whole.exr"):
        data = write(
            tmp_path / name, noise(64, 64), "float" if name.endswith("exr") else "uint8"
        ).read_bytes()
        cut = tmp_path / name.replace("whole", "cut")
        cut.write_bytes(data[: len(data) * 2 // 3])
        with pytest.raises(MissingFileError, match=r"cut\.\w+: is (damaged|no image)"):
            read_texture(cut)
    for value in (np.nan, np.inf):
        pixels = noise(2, 2)
        pixels[1, 1, 2] = value
        with pytest.raises(MissingFileError, match="holds NaN or infinity"):
            read_texture(write(tmp_path / "nan.exr", pixels))
    assert (
        read_texture(write(tmp_path / "wide.png", np.zeros((1, MOST_TEXELS, 1)), "uint8")).shape[1] == 16384
    )
    with pytest.raises(MissingFileError, match="is 16385 x 1, more than 16384 x 16384 pixels"):
        read_texture(write(tmp_path / "wider.png", np.zeros((1, MOST_TEXELS + 1, 1)), "uint8"))


# -- the pyramid ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 3, 5, 8, 37])
@pytest.mark.parametrize("axis", [0, 1])
def test_halving_is_a_box_filter(count: int, axis: int) -> None:
    """What a new pixel covers, cut into pieces that whole pixels and new ones are made of alike."""
    pixels = noise(count, 4) if axis == 0 else noise(4, count)
    new = max(1, count // 2)
    pieces = np.repeat(pixels.astype(np.float64), new, axis)
    shape = list(pixels.shape)
    shape[axis : axis + 1] = [new, count]
    expected = pieces.reshape(shape).mean(axis + 1)
    np.testing.assert_allclose(halved(pixels, axis), expected, rtol=1e-6)


def test_pyramids_end_in_one_texel() -> None:
    levels = pyramid(noise(13, 100))
    assert [level.shape[:2] for level in levels] == [
        (13, 100),
        (6, 50),
        (3, 25),
        (1, 12),
        (1, 6),
        (1, 3),
        (1, 1),
    ]
    means = np.array([level.astype(np.float64).mean((0, 1)) for level in levels])
    np.testing.assert_allclose(means, np.tile(means[:1], (7, 1)), rtol=1e-6)
    for level in pyramid(np.full((13, 100, 3), np.float32(0.3))):
        np.testing.assert_array_equal(level, np.float32(0.3))


def test_a_file_named_twice_is_in_the_buffer_once(tmp_path: Path) -> None:
    one, other = (write(tmp_path / name, noise(3, 4)) for name in ("one.exr", "other.exr"))
    texels = Texels()
    first = texels.add(ImageFile(one, "one.exr"))
    second = texels.add(ImageFile(other, "other.exr"))
    assert texels.add(ImageFile(tmp_path / ".." / tmp_path.name / "one.exr", "../one.exr")) == first
    # 4 x 3, 2 x 1 and 1 x 1 texels.
    assert first == [0, 0, 4, 3, 0, 12, 2, 1, 0, 14, 1, 1]
    assert second[1] == 15
    assert texels.buffer().shape == (90,)


# -- the look-up ---------------------------------------------------------------------------------------------

PARTS = (
    *geometry_parts("e3"),
    "scene_types.h",
    "shape/angles.h",
    "shape/ball.h",
    "pattern/footprint.h",
    "pattern/image.h",
    "pattern/color_in_turn.h",
    "pattern/strips.h",
)
_SCENE = "scene_data scene = {{numbers, 0, 0, in + (size_t){} * stride}};\n"
BODIES = {
    # Texels stand in the last row of the inputs.
    "image": Body(
        4,
        3,
        _SCENE.format(3)
        + "real3_lanes c = image(IN(0), IN(1), IN(2), scene, 3); OUT(0, c.x); OUT(1, c.y); OUT(2, c.z);",
    ),
    "spread": Body(
        4,
        1,
        _SCENE.format(0)
        + """footprint f = {IN(3), REAL(1)};
point p = {IN(0), IN(1), IN(2), REAL(1)};
surface s = ball_surface(p, REAL(1)), beside[2];
direction in_surface[2];
directions_in_surface(p, s.gradient, in_surface);
for (int i = 0; i < 2; i++)
  beside[i] = ball_surface(moved_along(p, in_surface[i], footprint_step(f)), REAL(1));
OUT(0, spread_of(s, beside, f));""",
    ),
    "footprint": Body(
        3,
        2,
        _SCENE.format(0)
        + """point p = {REAL(0), REAL(0), REAL(0), REAL(1)};
vector v = {IN(0), REAL(0), IN(1), REAL(0)};
covector up = {REAL(0), REAL(0), REAL(5), REAL(0)};
footprint f = footprint_of(p, v, IN(2), up, scene);
OUT(0, f.width); OUT(1, f.area);""",
    ),
    "strips": Body(
        1,
        3,
        _SCENE.format(0)
        + "real3_lanes c = strips(IN(0), scene, 3, 3); OUT(0, c.x); OUT(1, c.y); OUT(2, c.z);",
    ),
}


def kernels(device: Device, precision: str, lanes: int) -> SmallKernels:
    if precision == "double" and not device.info.fp64:
        pytest.skip("the device has no double precision")
    return SmallKernels(device, PARTS, BODIES, precision, lanes)


def bilinear(level: np.ndarray, u: np.ndarray, v: np.ndarray, ends: bool) -> np.ndarray:
    """The reference: texel (i, j) has its centre at ((i + 1/2)/W, 1 - (j + 1/2)/H)."""
    height, width = level.shape[:2]
    x, y = u * width - 0.5, (1 - v) * height - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)

    def texel(di: int, dj: int) -> np.ndarray:
        row = np.clip(j + dj, 0, height - 1) if ends else (j + dj) % height
        return level[row, (i + di) % width]

    right, down = (x - i)[:, None], (y - j)[:, None]
    above = (1 - right) * texel(0, 0) + right * texel(1, 0)
    below = (1 - right) * texel(0, 1) + right * texel(1, 1)
    return (1 - down) * above + down * below


def trilinear(
    levels: list[np.ndarray], u: np.ndarray, v: np.ndarray, lod: np.ndarray, ends: bool
) -> np.ndarray:
    lod = np.clip(lod, 0, len(levels) - 1)
    first = np.minimum(np.floor(lod).astype(int), len(levels) - 2)
    colors = np.array([bilinear(level.astype(np.float64), u, v, ends) for level in levels])
    every = np.arange(len(u))
    share = (lod - first)[:, None]
    return (1 - share) * colors[first, every] + share * colors[first + 1, every]


def looked_up(
    at: SmallKernels,
    pixels: np.ndarray,
    u: Any,
    v: Any,
    spread: Any,
    size: tuple[float, float],
    ends: bool,
    first: int,
) -> np.ndarray:
    """The kernel's colors (N,3), with the image's texels from number `first` of the buffer on."""
    levels = pyramid(pixels)
    numbers = [0, 0, 0, len(levels), float(ends), *size]
    texels = [np.full((first, 3), np.nan, np.float32)]
    for level in levels:
        place = sum(len(t) for t in texels)
        numbers += [place // TEXEL_PAGE, place % TEXEL_PAGE, level.shape[1], level.shape[0]]
        texels.append(level.reshape(-1, 3))
    row = np.concatenate(texels).ravel()
    count = max(len(row), len(u))
    inputs = np.zeros((4, count))
    for k, values in enumerate((u, v, spread, row)):
        inputs[k, : len(values)] = values
    return at.run("image", inputs, numbers)[:, : len(u)].T


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("ends", [False, True])
def test_look_up_against_the_reference(precision: str, ends: bool, opencl_device: Device) -> None:
    pixels = noise(37, 61)
    source = np.random.default_rng(3)
    count, size = 4000, (1.0, 1.0) if ends else (0.5, 3.0)
    dtype = np.float32 if precision == "single" else np.float64
    u = source.uniform(-2, 3, count).astype(dtype)
    v = source.uniform(0, 1, count) if ends else source.uniform(-4, 4, count)
    v[:4], u[:4] = [0, 1, 0, 1], [0, 1, 0.5, 0.25]
    v = v.astype(dtype)
    lod = source.uniform(-1, 7, count)
    lod[4:12] = np.arange(8) - 0.0
    spread = (4.0**lod * size[0] * size[1] / pixels[..., 0].size).astype(dtype)
    expected = trilinear(pyramid(pixels), u.astype(float) / size[0], v.astype(float) / size[1], lod, ends)
    got = {}
    for lanes in LANE_WIDTHS:
        at = kernels(opencl_device, precision, lanes)
        got[lanes] = looked_up(at, pixels, u, v, spread, size, ends, 0)
        # Coordinates of up to six images are rounded, each image 61 texels wide.
        np.testing.assert_allclose(got[lanes], expected, rtol=0, atol=6 * 61 * EPSILON[precision])
        np.testing.assert_array_equal(got[lanes], got[1])


@pytest.mark.parametrize("first", [1, TEXEL_PAGE - 1, TEXEL_PAGE, 2 * TEXEL_PAGE + 5])
def test_texels_are_found_on_both_sides_of_a_page(first: int, opencl_device: Device) -> None:
    """TEXEL_PAGE is what kernel and host count by."""
    at, pixels = kernels(opencl_device, "single", 4), noise(5, 9)
    source = np.random.default_rng(5)
    u, v, spread = source.random(500), source.random(500), 4.0 ** source.uniform(-4, 0, 500)
    there, at_start = (looked_up(at, pixels, u, v, spread, (1, 1), True, place) for place in (first, 0))
    np.testing.assert_array_equal(there, at_start)


def test_what_is_not_a_number_stays_one_and_reads_no_texel_elsewhere(opencl_device: Device) -> None:
    at, pixels = kernels(opencl_device, "single", 4), noise(5, 9)
    u = np.array([np.nan, 0.5, np.inf, 0.5, 0.5, 0.5])
    v = np.array([0.5, np.nan, 0.5, 0.5, 0.5, 0.5])
    spread = np.array([0.1, 0.1, 0.1, np.nan, np.inf, 0])
    colors = looked_up(at, pixels, u, v, spread, (1, 1), True, 0)
    assert np.isnan(colors[:3]).all()
    # Without a footprint the finest level; with an endless one the mean.
    np.testing.assert_array_equal(colors[3], colors[5])
    np.testing.assert_array_equal(colors[4], pyramid(pixels)[-1][0, 0])


@pytest.mark.parametrize("precision", ["single", "double"])
def test_spread_on_a_ball(precision: str, opencl_device: Device) -> None:
    """On the unit ball an area of 1 has 1/(2 pi^2 cos(latitude)) of the area of (u, v), on both sides of
    FOOTPRINT_STEP as far as the surface is flat over the step.
    """
    at = kernels(opencl_device, precision, 8)
    step = 1 / 64
    for width in (1e-3, 0.99 * step, step, 1.01 * step, 1.0, 100.0):
        source = np.random.default_rng(9)
        longitude, sine = source.uniform(-np.pi, np.pi, 300), source.uniform(-0.95, 0.95, 300)
        cosine = np.sqrt(1 - sine**2)
        points = [cosine * np.cos(longitude), cosine * np.sin(longitude), sine, np.full(300, width)]
        expected = 1 / (2 * np.pi**2 * cosine)
        # The step over the radius of the parallel is what the quotient is wrong by.
        allowed = 3 * min(width, step) / cosine + 1e-3 + 50 * EPSILON[precision] / min(width, step)
        off = np.abs(at.run("spread", points)[0] / expected - 1)
        assert (off < allowed).all(), (width, (off / allowed).max())


def test_footprint_of_a_beam_on_a_plane(opencl_device: Device) -> None:
    """Of e3: the pixel's angle times the length, longer where the plane is grazed."""
    at = kernels(opencl_device, "single", 4)
    angles, length = np.radians([90, 45, 30, 5.739170]), np.array([1.0, 2, 3, 10])
    width, area = at.run("footprint", [np.cos(angles), -np.sin(angles), length], [0, 0, 0.01])
    np.testing.assert_allclose(width, 0.01 * length, rtol=1e-5)
    np.testing.assert_allclose(area, (0.01 * length) ** 2 / [1, 0.5**0.5, 0.5, 0.1], rtol=1e-4)


@pytest.mark.parametrize("lanes", [1, 16])
def test_strips(lanes: int, opencl_device: Device) -> None:
    at = kernels(opencl_device, "single", lanes)
    colors = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    x = np.array([0, 0.049, 0.051, 0.149, 0.151, 0.95, 0.99, -0.01, -0.149, -0.151, 7.301])
    numbers = [0, 0, 0, 20, *np.ravel(colors)]
    expected = [int(Fraction(str(value)) * 20 // 1) % 3 for value in x]
    np.testing.assert_array_equal(at.run("strips", x[None], numbers).T, np.array(colors)[expected])


# -- pictures ------------------------------------------------------------------------------------------------

# A material that shows the color of an image in any light.
MATT = "material: {{color: {{image: {}}}, ambient: 0.9, specular: 0}}"


def rendered(text: str, **settings: Any) -> np.ndarray:
    image = tc.render(load_text(text), **{"size": (48, 48), "samples": 1, "lanes": 8} | settings)
    assert image.statistics["nan"] == 0
    return image.channels["beauty"]


def facing(geometry: str, material: str) -> str:
    """A ball seen against the direction (1, 1, 0), along which a geodesic is straight in every geometry."""
    return (
        f"geometry: {geometry}\ncamera: {{at: [0.5, 0.5, 0], look: {{along: [-1, -1, 0]}}, fov: 64 deg}}\n"
        f"objects: [{{ball: {{radius: 0.35}}, material: {material}}}]\n"
        "lights: [point: {at: [0.5, 0.5, 0.1], falloff: constant, intensity: 0.2}]\n"
    )


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_maps_are_neither_mirrored_nor_upside_down(geometry: str, tmp_path: Path) -> None:
    """Longitude 45 degrees is in the middle of the ball. West of it is left, and north is up."""
    colors = {"nw": (1, 0, 0), "ne": (0, 1, 0), "sw": (0, 0, 1), "se": (1, 1, 0)}
    quadrants = np.zeros((64, 128, 3), np.float32)
    middle, east = 80, np.arange(128) >= 80  # 128 (1/2 + 1/8): the direction (1, 1, 0)
    for name, color in colors.items():
        rows = slice(0, 32) if name[0] == "n" else slice(32, 64)
        quadrants[rows, east if name[1] == "e" else ~east] = color
    assert east[middle]
    path = write(tmp_path / "quadrants.exr", quadrants)
    picture = rendered(facing(geometry, f"{{color: {{image: {path}}}, specular: 0}}"))
    for name, color in colors.items():
        row, column = 24 + (-9 if name[0] == "n" else 8), 24 + (-9 if name[1] == "w" else 8)
        seen = picture[row, column] / picture[row, column].max()
        # In sol the border of two quadrants is near.
        np.testing.assert_allclose(seen, color, atol=0.1, err_msg=name)


# Geometry, shape, and a camera outside of it: where it is, along what it looks, what is up.
SURFACES = {
    "plane": ("e3", "half-space: {}", "[0, 0, 1]", "[0, 0, -1]", "[0, 1, 0]"),
    "cylinder": ("e3", "cylinder: {radius: 0.4}", "[0, -1, 0]", "[0, 1, 0]", "[0, 0, 1]"),
    "floor of sl2": ("sl2", "half-space: {}", "[0, 0, 1]", "[0, 0, -1]", "[0, 1, 0]"),
    "wall of nil": ("nil", "half-space: {normal: [1, 0, 0]}", "[0.8, 0, 0]", "[-1, 0, 0]", "[0, 0, 1]"),
    "plane of sol": ("sol", "half-space: {normal: [0, 1, 0]}", "[0, 0.5, 0]", "[0, -1, 0]", "[0, 0, 1]"),
    "horoball": ("h3", "horoball: {towards: [0, 0, 1], distance: 0}", "[0, 0, -1]", "[0, 0, 1]", "[0, 1, 0]"),
}


@pytest.mark.parametrize("name", SURFACES)
def test_other_surfaces_show_images_from_outside(name: str, tmp_path: Path) -> None:
    """Right and up in the picture lead to the right and up in the image, as area goes; on a horoball, whose
    coordinates are seen from within, the image is mirrored.
    """
    geometry, shape, at, along, up = SURFACES[name]
    # Red grows to the right and green upwards, from the corner where u = v = 0 on.
    place = (np.arange(64) + 32) % 64 / 64
    pixels = np.stack([*np.meshgrid(place, place[::-1]), np.zeros((64, 64))], axis=-1)
    path = write(tmp_path / "places.exr", pixels)
    picture = rendered(
        f"geometry: {geometry}\ncamera: {{at: {at}, look: {{along: {along}, up: {up}}}, fov: 40 deg}}\n"
        f"objects: [{{{shape}, {MATT.format(f'{{file: {path}, size: 8}}')}}}]\n"
        "lights: [point: {at: [0.2, 0.2, 0.2], intensity: 0.0001}]\n"
    )[16:32, 16:32, :2]
    down, right = np.gradient(picture, axis=(0, 1))
    area = right[..., 0] * -down[..., 1] + down[..., 0] * right[..., 1]
    assert (area != 0).mean() > 0.9
    assert (area < 0 if name == "horoball" else area > 0).mean() > 0.9


@pytest.mark.parametrize("geometry", ["e3", "s2xe", "nil"])
def test_an_image_of_one_color_is_that_color(geometry: str, tmp_path: Path) -> None:
    path = write(tmp_path / "plain.exr", np.broadcast_to(np.float32([0.25, 0.5, 0.125]), (9, 13, 3)))
    image = rendered(facing(geometry, f"{{color: {{image: {path}}}}}"))
    plain = rendered(facing(geometry, "{color: [0.25, 0.5, 0.125]}"))
    assert plain.max() > 0.1
    np.testing.assert_array_equal(image, plain)


@pytest.mark.parametrize("geometry", ["nil", "sl2"])
def test_a_turned_ball_of_a_union_shows_its_turn(geometry: str) -> None:
    """A union of equal balls is one shape, and is marched as one, unless a turn shows."""
    turned = "{ball: {radius: 0.35}, rotate: {axis: [0, 0, 1], angle: 50 deg}}"
    far = "{ball: {radius: 0.35}, at: [-4, -4, 0]}"
    alone = facing(geometry, "{color: {image: earth}}")
    both = alone.replace("{ball: {radius: 0.35},", f"{{union: [{turned}, {far}],")
    turned_alone = alone.replace("{ball: {radius: 0.35},", f"{turned[:-1]},")
    np.testing.assert_allclose(rendered(both)[18:30, 18:30], rendered(turned_alone)[18:30, 18:30], atol=2e-3)
    assert np.abs(rendered(alone) - rendered(turned_alone)).max() > 0.1


def test_walls_do_not_change_an_image() -> None:
    """The ball of a cell of the three-torus and that over a wall, against two balls in the whole space."""

    def picture(balls: str, rest: str) -> Any:
        text = (
            f"geometry: e3\ncamera: {{at: [-0.2, 0.45, 0], look: {{along: [-1, -1.6, 0]}}, fov: 50 deg}}\n"
            f"objects: [{{union: [{balls}], {MATT.format('earth')}}}]\n"
            f"lights: [point: {{at: [-0.2, 0.45, 0], intensity: 0.001, falloff: constant}}]\n{rest}"
        )
        return tc.render(load_text(text), size=(96, 96), samples=1, lanes=8).channels

    # The cell is [-1/2, 1/2]^3: the ball at x = 0.4 reaches through the wall of x = 1/2.
    torus = picture("{ball: {radius: 0.2}, at: [0.4, 0, 0]}", "manifold: three-torus\n")
    space = picture("{ball: {radius: 0.2}, at: [0.4, 0, 0]}, {ball: {radius: 0.2}, at: [-0.6, 0, 0]}", "")
    same = np.isfinite(space["depth"]) & (np.abs(space["depth"] - torus["depth"]) < 1e-3)
    assert np.count_nonzero(same) > 500
    assert space["beauty"][same].std() > 0.1
    off = np.abs(space["beauty"] - torus["beauty"])[same]
    assert np.quantile(off, 0.98) < 0.01


def floor(material: str) -> str:
    return (
        "geometry: e3\ncamera: {at: [0, 0, 1], look: {along: [1, 0, -0.1]}, fov: 50 deg}\n"
        "objects: [{half-space: {normal: [0, 0, 1]}, "
        f"material: {{color: {material}, ambient: 0.9, specular: 0}}}}]\n"
        "lights: [point: {at: [0, 0, 1], intensity: 0.001}]\n"
    )


def test_a_fine_image_far_away_is_its_mean(tmp_path: Path) -> None:
    """Squares finer than a pixel: one sample of the image is as smooth as many, one of a pattern is not."""
    squares = np.indices((16, 16)).sum(0) % 2
    path = write(tmp_path / "squares.exr", np.repeat(squares[..., None], 3, 2))
    image = floor(f"{{image: {{file: {path}, size: 0.8}}}}")
    pattern = floor("{checker: {count: 20}}")
    below = slice(30, 40)  # from 3 to 20 units away
    one, exact = rendered(image)[below], rendered(pattern, samples=400)[below]
    noisy = rendered(pattern)[below]
    assert noisy.std() > 0.3
    np.testing.assert_allclose(exact.mean(), 0.45, atol=0.02)
    np.testing.assert_allclose(one.mean(), exact.mean(), atol=0.01)
    assert one.std() < 0.05


def test_an_image_near_the_camera_is_sharp(tmp_path: Path) -> None:
    """Where a texel covers several pixels the finest level is seen: edges are as sharp as the texels."""
    squares = np.indices((16, 16)).sum(0) % 2
    path = write(tmp_path / "squares.exr", np.repeat(squares[..., None], 3, 2))
    near = rendered(floor(f"{{image: {{file: {path}, size: 14}}}}"))[40:]
    assert near.max() > 0.85
    assert near.min() < 0.05


def test_poles_are_not_blurred(tmp_path: Path) -> None:
    """Rings about the pole, 128 of them from pole to pole, seen from above, each 4 pixels wide and more."""
    rings = np.repeat((np.arange(128) % 2)[:, None], 256, 1)
    path = write(tmp_path / "rings.exr", np.repeat(rings[..., None], 3, 2))
    text = (
        "geometry: e3\ncamera: {at: [0, 0, 2], look: {along: [0, 0, -1], up: [1, 0, 0]}, fov: 20 deg}\n"
        f"objects: [{{ball: {{radius: 1}}, {MATT.format(path)}}}]\n"
        "lights: [point: {at: [0, 0, 2], intensity: 0.001}]\n"
    )
    middle = rendered(text, size=(128, 128))[64, 76:116].max(axis=1)
    assert middle.max() > 0.75
    assert middle.min() < 0.15


# -- scenes --------------------------------------------------------------------------------------------------


def test_without_images_there_is_nothing_of_them(opencl_device: Device) -> None:
    plan = make_plan(load_text(facing("e3", "{color: {checker: {}}}")), device=opencl_device)
    assert "pattern/image.h" not in plan.parts
    assert "footprint" not in plan.source.text
    assert plan.texels.shape == (1,)
    assert "image" in plan.left_out
    images = make_plan(load_text(facing("e3", "{color: {image: earth}}")), device=opencl_device)
    assert "image" in images.called_for
    # 1024 x 512 and its halvings, to 1 x 1.
    assert images.texels.size == 3 * (sum(2**k * 2 ** (k - 1) for k in range(1, 11)) + 1)


def test_images_of_other_sizes_share_the_program(tmp_path: Path, opencl_device: Device) -> None:
    small, large = (write(tmp_path / f"{k}.exr", noise(k, 2 * k)) for k in (3, 40))
    texts = [
        make_plan(load_text(facing("e3", f"{{color: {{image: {path}}}}}")), device=opencl_device).source.text
        for path in (small, large)
    ]
    assert texts[0] == texts[1]


def test_files_are_found_from_the_folder_of_the_scene(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "scenes").mkdir()
    path = write(tmp_path / "scenes" / "map.exr", noise(2, 2))
    scene = tmp_path / "scenes" / "scene.yaml"
    scene.write_text(facing("e3", "{color: {image: map.exr}}"))
    for folder in (tmp_path, tmp_path / "scenes"):
        monkeypatch.chdir(folder)
        paint: Any = load_scene(scene).objects[0].material.color
        assert paint.image.file.path == path
        assert paint.image.file.written == "map.exr"
    # A text has no folder: the current one.
    paint = load_text(scene.read_text()).objects[0].material.color
    assert paint.image.file.path == path
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SceneError, match=r"there is no image file 'map\.exr'"):
        load_text(scene.read_text())


@pytest.mark.parametrize(
    ("name", "message", "help"),
    [
        ("photo.jpg", "there is no image file 'photo.jpg'", "did you mean 'photos.jpg'?"),
        ("earth.png", "there is no image file 'earth.png'", "comes with the program is called 'earth'"),
        (
            "https://a.org/b.png",
            "'https://a.org/b.png' is an address, not a file",
            "save the picture, and name that file",
        ),
        (300 * "a" + ".png", f"'{40 * 'a'}...' cannot be read: File name too long", "JPEG, PNG"),
        ("photos.jpg", "'photos.jpg' is no image that can be read: ", "JPEG, PNG, TIFF"),
        ("huge.png", "'huge.png' is 1 x 16385, more than 16384 x 16384 pixels", "JPEG"),
        ("folder.d", "'folder.d' is a folder, not an image file", "name a file in it"),
        ("cut.png", "'cut.png' is damaged: ", "JPEG, PNG"),
    ],
)
def test_validate_tells_of_files_at_their_line(name: str, message: str, help: str, tmp_path: Path) -> None:
    (tmp_path / "photos.jpg").write_text("no image")
    (tmp_path / "folder.d").mkdir()
    write(tmp_path / "huge.png", np.zeros((MOST_TEXELS + 1, 1, 1)), "uint8")
    whole = write(tmp_path / "whole.png", noise(64, 64), "uint8").read_bytes()
    (tmp_path / "cut.png").write_bytes(whole[: len(whole) // 2])
    scene = tmp_path / "scene.yaml"
    scene.write_text(
        "geometry: e3\n"
        f"textures:\n  map: {{image: {{file: {name}, size: [1, 1]}}}}\n"
        "objects: [{ball: {radius: 1}, material: {color: $textures.map}}]\n"
    )
    result = CliRunner().invoke(main, ["validate", str(scene)])
    assert result.exit_code == 65
    first, line, caret, cure, *rest = result.stderr.strip().split("\n")
    assert first.startswith(f"{scene}:3:23: error: {message}")
    # A long line is cut short.
    assert caret.index("^") == line.index(name[:20])
    assert help in cure
    assert rest == [f"1 error in {scene}"]


def test_images_too_large_for_the_device_are_an_error_at_their_line(opencl_device: Device) -> None:
    plan = make_plan(load_text(facing("e3", "{color: {image: earth}}"), "scene.yaml"), device=opencl_device)
    most = opencl_device.context.devices[0].max_mem_alloc_size
    # Takes no memory itself.
    plan.texels = np.broadcast_to(np.float32(0), (most // 4 + 1,))
    with pytest.raises(SceneError, match=r"scene\.yaml:3:60: error: the images of the scene take \d+ bytes"):
        TileRenderer(plan, opencl_device, 1, "packet")


def test_the_image_library_is_loaded_only_for_an_image() -> None:
    code = (
        "import sys\nimport thurston_cl\nfrom thurston_cl.scene import load_text\n"
        "for color in ('{checker: {}}', '{image: earth}'):\n"
        "    load_text('geometry: e3\\nobjects: [{ball: {radius: 1}, material: {color: ' + color + '}}]')\n"
        "    print('OpenImageIO' in sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout == "False\nTrue\n", done.stderr
