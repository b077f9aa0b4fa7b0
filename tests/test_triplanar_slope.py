"""Patterns by the direction in which a surface faces: projections along axes, and two paints by slope."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import pytest
from small_kernels import Body, SmallKernels

import thurston_cl as tc
from thurston_cl.device import Device
from thurston_cl.program import LANE_WIDTHS, geometry_parts
from thurston_cl.scene import load_text
from thurston_cl.scene.plan import make_plan
from thurston_cl.scene.texels import images_of

PARTS = (
    *geometry_parts("e3"),
    "scene_types.h",
    "pattern/footprint.h",
    "pattern/slope.h",
    "pattern/triplanar.h",
)
_GIVEN = (
    "scene_data scene = {numbers, 0, 0, 0};\npoint q = {REAL(1), REAL(2), REAL(3), REAL(1)};\n"
    "covector g = {IN(0), IN(1), IN(2), REAL(0)};\nsurface s = {REAL(0), g, REAL(0), REAL(0)};\n"
)
BODIES = {
    "weights": Body(
        3, 3, _GIVEN + "direction w = triplanar_weights(q, g); OUT(0, w.x); OUT(1, w.y); OUT(2, w.z);"
    ),
    "along": Body(
        3,
        9,
        _GIVEN
        + """footprint f = {REAL(1), REAL(5), REAL(0)};
for (int axis = 0; axis < 3; axis++) {
  surface t = along_axis(s, q, axis, scene, 3);
  OUT(3 * axis, t.u); OUT(3 * axis + 1, t.v);
  OUT(3 * axis + 2, footprint_along_axis(f, s, q, axis, scene, 3).spread);
}""",
    ),
    "share": Body(3, 1, _GIVEN + "OUT(0, share_of_flat(q, g, scene, 3));"),
}


def kernels(device: Device, precision: str, lanes: int) -> SmallKernels:
    if precision == "double" and not device.info.fp64:
        pytest.skip("the device has no double precision")
    return SmallKernels(device, PARTS, BODIES, precision, lanes)


def gradients(count: int) -> np.ndarray:
    """Of any length, the first six along the axes."""
    found = np.random.default_rng(8).normal(size=(3, count))
    found[:, :6] = np.hstack([np.eye(3), -np.eye(3)]) * 7
    return found


@pytest.mark.parametrize("precision", ["single", "double"])
def test_weights(precision: str, opencl_device: Device) -> None:
    """In sum 1, as the fourth powers of the normal; 1 on a face across an axis."""
    g = gradients(500)
    epsilon = {"single": 2.0**-23, "double": 2.0**-52}[precision]
    alone = None
    for lanes in LANE_WIDTHS:
        got = kernels(opencl_device, precision, lanes).run("weights", g)
        np.testing.assert_allclose(got.sum(axis=0), 1, atol=4 * epsilon)
        np.testing.assert_allclose(got, g**4 / (g**4).sum(axis=0), rtol=60 * epsilon)
        alone = got if alone is None else alone
        np.testing.assert_array_equal(got, alone)
    np.testing.assert_allclose(got[:, :6], np.hstack([np.eye(3), np.eye(3)]), atol=epsilon)


def test_projections(opencl_device: Device) -> None:
    """Seen from outside, right and up make with the normal a right-handed frame; of a footprint of area 5 the
    projection counts."""
    at, g = kernels(opencl_device, "double", 4), gradients(300)
    size, point = 0.5, np.array([1.0, 2, 3])
    u, v, spread = at.run("along", g, [0, 0, 0, size]).reshape(3, 3, -1).transpose(1, 0, 2)
    np.testing.assert_allclose(spread, 5 * np.abs(g) / np.linalg.norm(g, axis=0) / size**2, rtol=1e-12)
    axes = np.eye(3)
    for axis, up in ((0, axes[2]), (1, axes[2]), (2, axes[1])):
        for side in (1, -1):
            faces = np.sign(g[axis]) == side
            right = np.cross(up, side * axes[axis])
            np.testing.assert_allclose(u[axis, faces], right @ point / size)
            np.testing.assert_allclose(v[axis, faces], up @ point / size)
            assert faces.any()


def test_the_share_of_what_is_flat(opencl_device: Device) -> None:
    """On both sides of where it begins and ends, a half at `at`, smooth between."""
    at_cosine, width = 0.8, 0.2
    cosines = np.array([1, 0.901, 0.9, 0.899, 0.85, 0.8, 0.75, 0.701, 0.7, 0.699, 0, -1])
    g = np.stack([np.sqrt(1 - cosines**2), 0 * cosines, cosines]) * 3
    t = np.clip((cosines - 0.7) / 0.2, 0, 1)
    for lanes in LANE_WIDTHS:
        at = kernels(opencl_device, "double", lanes)
        got = at.run("share", g, [0, 0, 0, at_cosine, width, 0, 0, 1])[0]
        np.testing.assert_allclose(got, 3 * t**2 - 2 * t**3, atol=1e-12)
        # Up is any direction.
        turned = at.run("share", g[[2, 0, 1]], [0, 0, 0, at_cosine, width, 1, 0, 0])[0]
        np.testing.assert_allclose(turned, got, atol=1e-12)
    assert got[5] == pytest.approx(0.5) and got[0] == got[1] == 1 and got[9] == got[-1] == 0


# -- pictures ------------------------------------------------------------------------------------------------

GLOW = "ambient: 1, diffuse: 0, specular: 0"
PLAIN = {
    "checker": "checker: {count: [3, 5], colors: [red, blue]}",
    "grid": "grid: {count: 4, width: 0.3}",
    "bands": "bands: {count: 4, width: 0.3, colors: [red, white, lime]}",
    "strips": "strips: {count: 4, across: second, colors: [red, white, lime]}",
    "image": "image: {file: earth, size: [1, 1]}",
}


def seen(objects: str, camera: str, **settings: Any) -> np.ndarray:
    image = tc.render(
        load_text(
            f"geometry: e3\ncamera: {{{camera}}}\nobjects: [{objects}]\nlights: [point: {{at: [0, 0, 9]}}]\n"
        ),
        **{"size": (60, 40), "samples": 1, "precision": "double"} | settings,
    )
    assert image.statistics["nan"] == 0
    return image.channels["beauty"]


@pytest.mark.parametrize("pattern", PLAIN)
def test_across_an_axis_it_is_the_plain_pattern(pattern: str) -> None:
    """On the plane z = 0, whose own coordinates are x and y; and scaled, seen from as many times farther."""
    camera = "at: [0.2, 0.1, 1], look: {along: [0, 0, -1], up: [0, 1, 0]}, fov: 60 deg"
    plane = "{{half-space: {{}}, material: {{color: {{{}}}, " + GLOW + "}}}}"
    plain = seen(plane.format(PLAIN[pattern]), camera)
    once = seen(plane.format(f"triplanar: {{{PLAIN[pattern]}}}"), camera)
    twice = seen(
        plane.format(f"triplanar: {{{PLAIN[pattern]}, size: 2}}"),
        camera.replace("[0.2, 0.1, 1]", "[0.4, 0.2, 2]"),
    )
    assert np.ptp(plain) > 0.3
    # Where a ray ends is known to the hit threshold, which is half as large on the pattern twice as large.
    for other, allowed in ((once, 1e-6), (twice, 2e-3)):
        off = np.abs(other - plain).max(axis=2) > allowed
        # Where a pixel sees a border, rounding decides.
        assert np.count_nonzero(off) <= 0.005 * off.size


@pytest.mark.parametrize("facing", ["[1, 0, 0]", "[-1, 0, 0]", "[0, 1, 0]", "[0, -1, 0]", "[0, 0, 1]"])
def test_images_are_not_mirrored(facing: str, tmp_path: Path) -> None:
    """Seen from outside, red grows to the right and green upwards."""
    place = (np.arange(64) + 32) % 64 / 64
    pixels = np.stack([*np.meshgrid(place, place[::-1]), np.zeros((64, 64))], axis=-1).astype(np.float32)
    path = tmp_path / "places.exr"
    spec = oiio.ImageSpec(64, 64, 3, "float")
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec) and out.write_image(pixels) and out.close()
    normal = np.array(json.loads(facing), float)
    up = "[0, 1, 0]" if normal[2] else "[0, 0, 1]"
    material = f"{{color: {{triplanar: {{image: {path}, size: 8}}}}, {GLOW}}}"
    picture = seen(
        f"{{half-space: {{normal: {facing}}}, material: {material}}}",
        f"at: {normal.tolist()}, look: {{along: {(-normal).tolist()}, up: {up}}}, fov: 40 deg",
        precision="single",
    )
    down, right = np.gradient(picture[8:-8, 8:-8], axis=(0, 1))
    assert right[..., 0].min() > 0 and np.abs(right[..., 1]).max() < 1e-4
    assert down[..., 1].max() < 0 and np.abs(down[..., 0]).max() < 1e-4


@pytest.mark.parametrize(
    "paint",
    [
        "triplanar: {checker: {count: 6, colors: [black, white]}}",
        "slope: {flat: lime, steep: {noise: {size: 0.2}}, at: 0.6, width: 0.3, up: [0, -1, 1]}",
    ],
)
def test_they_move_with_their_object(paint: str) -> None:
    """A ball, and the same turned about the line of sight and moved along it, as the camera is."""

    def ball(y: float, turn: int) -> np.ndarray:
        return seen(
            f"{{ball: {{radius: 0.5}}, at: [0, {y}, 0], rotate: {{axis: [0, 1, 0], angle: {turn} deg}},"
            f" material: {{color: {{{paint}}}, {GLOW}}}}}",
            f"at: [0, {y - 1.5}, 0], look: {{along: [0, 1, 0]}}, move: [roll: {turn} deg], fov: 60 deg",
        )

    still = ball(0, 0)
    off = np.abs(ball(2, 35) - still).max(axis=2) > 1e-3
    assert np.count_nonzero(off) <= 0.02 * off.size
    assert np.ptp(still) > 0.5


def test_a_slope_over_walls_is_that_of_its_object() -> None:
    """An image of an object in another cell of a manifold is painted as the object itself."""
    paint = f"{{color: {{slope: {{flat: lime, steep: red, at: 0.5, width: 0.01}}}}, {GLOW}}}"
    image = tc.render(
        load_text(
            "geometry: e3\nmanifold: three-torus\nrender: {far: 2.2}\n"
            "camera: {at: [0.3, -0.4, 0.1], look: {to: [0, 0, 0]}, fov: 90 deg}\n"
            f"objects: [{{ball: {{radius: 0.2}}, at: [0.4, 0.1, 0.4], material: {paint}}}]\n"
            "lights: [point: {at: [0, 0, 0.3]}]\n"
        ),
        size=(96, 64),
        samples=1,
        channels=("beauty", "normal", "object"),
    )
    hit = image.channels["object"] > 0
    z = image.channels["normal"][hit][:, 2]
    sure = np.abs(z - 0.5) > 0.02
    expected = np.where(z[:, None] > 0.5, [0.0, 1, 0], [1.0, 0, 0])
    np.testing.assert_allclose(image.channels["beauty"][hit][sure], expected[sure], atol=1e-5)
    assert 0.1 < np.mean(z > 0.5) < 0.9


def test_paints_inside_a_slope() -> None:
    """Each shows what it shows alone, where it is all there is; so does an image on surface coordinates."""
    camera = "at: [0, -0.9, 0.7], look: {to: [0, 0, 0]}, fov: 70 deg"
    paints = [
        "{image: earth}",
        "{checker: {count: 6}}",
        "{noise: {size: 0.2}}",
        "{triplanar: {image: earth}}",
    ]

    def ball(paint: str) -> np.ndarray:
        return seen(f"{{ball: {{radius: 0.5}}, material: {{color: {paint}, {GLOW}}}}}", camera)

    for k, flat in enumerate(paints):
        steep = paints[k - 1]
        both = ball(f"{{slope: {{flat: {flat}, steep: {steep}, at: 0.5, width: 0.001}}}}")
        alone = [np.abs(ball(paint) - both).max(axis=2) < 1e-5 for paint in (flat, steep)]
        assert np.mean(alone[0] | alone[1]) > 0.995
        assert not alone[0].all() and not alone[1].all()


def test_images_inside_are_found() -> None:
    scene = load_text(
        "geometry: e3\ntextures:\n"
        "  a: {slope: {flat: {triplanar: {image: earth}},\n"
        "              steep: {slope: {flat: red, steep: {image: earth}}}}}\n"
        "objects: [{ball: {radius: 1}, material: {color: $textures.a}}]\n"
    )
    places = [location for location, _ in images_of(scene)]
    assert ("textures", "a", "slope", "flat", "triplanar", "image", "file") in places
    assert ("textures", "a", "slope", "steep", "slope", "steep", "image", "file") in places
    assert set(make_plan(scene).image_digests) == {"earth"}
