"""Projections: the directions of the kernels against their definitions, in pictures of every geometry too."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import projections
import pytest
from projections import FORWARD, RIGHT, UP, Array, middles
from small_kernels import Body, SmallKernels

import thurston_cl as tc
from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.image import CHANNELS
from thurston_cl.models import GEOMETRIES
from thurston_cl.program import geometry_parts
from thurston_cl.scene import load_text
from thurston_cl.scene.placement import CameraFrame, Placement
from thurston_cl.scene.plan import make_plan

KERNELS = ("perspective", "equirectangular", "fisheye")
DEGREE = np.pi / 180


def kernels(device: Device, precision: str, lanes: int) -> SmallKernels:
    head = "scene_data scene = {numbers, 0, 0};"
    bodies = {
        name: Body(
            2,
            3,
            f"{head} direction u = {name}(IN(0), IN(1), scene, 0); OUT(0, u.x); OUT(1, u.y); OUT(2, u.z);",
        )
        for name in KERNELS
    }
    bodies["circle"] = Body(
        2, 1, f"{head} OUT(0, SELECT(in_circle(IN(0), IN(1), scene, 0), REAL(1), REAL(0)));"
    )
    files = ("scene_types.h", "camera/frame.h", *(f"camera/{name}.h" for name in KERNELS))
    return SmallKernels(device, (*geometry_parts("e3"), *files), bodies, precision, lanes)


def numbers(size: tuple[int, int], *own: float) -> list[float]:
    """A camera's numbers whose right, up and forward are x, y and z."""
    return [0, 0, 0, 1, *np.eye(3).ravel(), *size, *own]


def places(size: tuple[int, int]) -> Array:
    """Places all over a picture and a pixel and a half around it, its corners, edges and middle (2,N)."""
    width, height = size
    spread = np.random.default_rng(5).uniform(-1.5, 1.5, (2, 500)) + np.random.default_rng(6).uniform(
        [[0], [0]], [[width], [height]], (2, 500)
    )
    special = [(x, y) for x in (0, width / 2, width) for y in (0, height / 2, height)]
    return np.concatenate([np.round(spread * 64) / 64, np.array(special).T], axis=1)


@pytest.mark.parametrize("size", [(96, 64), (64, 96), (33, 33)])
@pytest.mark.parametrize(("precision", "lanes", "within"), [("double", 4, 4e-15), ("single", 16, 2e-6)])
def test_directions_are_those_of_the_definitions(
    size: tuple[int, int], precision: str, lanes: int, within: float, opencl_device: Device
) -> None:
    if precision == "double" and not opencl_device.info.fp64:
        pytest.skip("the device has no double precision")
    small, (x, y) = kernels(opencl_device, precision, lanes), places(size)
    wide = [20 * DEGREE, np.pi, 2 * np.pi]
    cases: list[tuple[str, list[float], Array]] = [
        ("equirectangular", [], projections.equirectangular(x, y, size)),
        *(
            ("perspective", [np.tan(fov / 2)], projections.perspective(x, y, size, fov))
            for fov in (1.0, 160 * DEGREE)
        ),
        *(("fisheye", [angle / 2], projections.fisheye(x, y, size, angle)) for angle in wide),
    ]
    for name, own, want in cases:
        got = small.run(name, [x, y], numbers(size, *own)).T
        assert np.abs(got - want).max() <= within, (name, own)


def test_edges_corners_and_the_middle(opencl_device: Device) -> None:
    small = kernels(opencl_device, "single", 4)
    size = (64, 32)

    def seen(name: str, own: list[float], *where: tuple[float, float]) -> Array:
        return small.run(name, np.array(where).T, numbers(size, *own)).T

    columns = [(x, y) for x in (0.0, 13.0, 32.0, 64.0) for y in (0.0, 32.0)]
    got = seen("equirectangular", [], (32, 16), (48, 16), (0, 16), (64, 16), *columns)
    want = [FORWARD, RIGHT, -FORWARD, -FORWARD, *[UP, -UP] * 4]
    np.testing.assert_allclose(got, want, atol=2e-6)
    # The circle is as wide as the shorter side, here the height.
    got = seen("fisheye", [np.pi / 2], (32, 16), (48, 16), (16, 16), (32, 0), (32, 32))
    np.testing.assert_allclose(got, [FORWARD, RIGHT, -RIGHT, UP, -UP], atol=2e-6)
    inside = small.run(
        "circle", [[47.9, 48.1, 15.9, 32, 32, 43, 44], [16, 16, 16, 0.1, -0.1, 27.2, 27.2]], numbers(size)
    )
    np.testing.assert_array_equal(inside[0], [1, 0, 0, 1, 0, 1, 0])


def frame_of(text: str, device: Device) -> Array:
    """Right, up and forward (rows) of the picture that a camera takes, in e3."""
    scene = load_text(f"geometry: e3\nobjects: [{{ball: {{radius: 0.1}}}}]\ncamera: {text}\n")
    plan = make_plan(scene, device=device)
    place = int(re.findall(r"four_numbers\(scene, (\d+)\)", plan.source.generated["scene objects"])[-1])
    return plan.numbers[place + 4 : place + 13].reshape(3, 3)


@pytest.mark.parametrize("tilt", [0, 20, -35])
def test_a_dome_is_a_fisheye_that_looks_up_with_the_front_at_the_bottom(
    tilt: float, opencl_device: Device
) -> None:
    """The camera looks along x with z up: its right is -y."""
    text = f"{{at: [0, 0, 0], projection: {{dome: {{tilt: {tilt} deg}}}}}}"
    right, top, middle = frame_of(text, opencl_device)
    x, y = places((64, 64))
    axes = np.array([[0, -1, 0], [0, 0, 1], [1, 0, 0]])  # right, up, forward
    want = projections.dome(x, y, (64, 64), np.pi, tilt * DEGREE) @ axes
    got = projections.fisheye(x, y, (64, 64), np.pi) @ np.stack([right, top, middle])
    np.testing.assert_allclose(got, want, atol=1e-14)
    if tilt == 0:
        # Bottom, top, left and right of the circle, and its middle.
        edge = projections.dome(
            np.array([32, 32, 0, 64, 32.0]), np.array([64, 0, 32, 32, 32.0]), (64, 64), np.pi, 0
        )
        np.testing.assert_allclose(edge, [FORWARD, -FORWARD, -RIGHT, RIGHT, UP], atol=1e-15)


# -- pictures ------------------------------------------------------------------------------------------------

Formula = Callable[[Array, Array], Array]
SIZES = {"perspective": (24, 18), "equirectangular": (36, 18), "fisheye": (20, 20), "dome": (20, 20)}
VIEWS: dict[str, tuple[str, Formula]] = {
    "perspective": ("{perspective: {}}", lambda x, y: projections.perspective(x, y, (24, 18), 80 * DEGREE)),
    "equirectangular": ("{equirectangular: {}}", lambda x, y: projections.equirectangular(x, y, (36, 18))),
    "fisheye": (
        "{fisheye: {angle: 260 deg}}",
        lambda x, y: projections.fisheye(x, y, (20, 20), 260 * DEGREE),
    ),
    "dome": (
        "{dome: {angle: 200 deg, tilt: 50 deg}}",
        lambda x, y: projections.dome(x, y, (20, 20), 200 * DEGREE, 50 * DEGREE),
    ),
}


@pytest.mark.parametrize("kind", VIEWS)
@pytest.mark.parametrize("name", GEOMETRIES)
def test_rays_go_the_way_of_their_pixel(name: str, kind: str, opencl_device: Device) -> None:
    """What a ray hits after its depth lies on the ball, in every geometry; the rest looks past it."""
    if not opencl_device.info.fp64:
        pytest.skip("the device has no double precision")
    projection, formula = VIEWS[kind]
    radius, at = 0.35, (0.1, -0.2, 0.05)
    scene = load_text(
        f"geometry: {name}\nobjects: [{{ball: {{radius: {radius}}}, at: {list(at)}}}]\nrender: {{far: 3}}\n"
        f"camera: {{at: [-0.6, -0.3, 0.1], look: {{to: [0.2, 0, 0.1]}}, projection: {projection}}}\n"
    )
    image = tc.render(
        scene,
        device=opencl_device,
        precision="double",
        lanes=1,
        size=SIZES[kind],
        samples=1,
        channels=["depth", "beauty"],
    )
    assert image.statistics["nan"] == 0
    depth = image.channels["depth"].astype(np.float64)
    hit = np.isfinite(depth)
    assert 10 < np.count_nonzero(hit) < 0.6 * hit.size
    g = Geometry(name, "double", opencl_device)
    camera, centre = CameraFrame(scene.camera, Placement(g)), Placement(g).point(at)
    u = formula(*middles(SIZES[kind])) @ camera.frame
    points, _ = g.flow(u[hit], depth[hit], base=camera.point)
    away = g.distance(points, base=centre)
    assert np.abs(away - radius).max() <= 2e-4
    # A pixel that looks straight at the ball's middle hits it.
    to_centre = g.geodesics(centre, 1, camera.point)[0][0, 0]
    aimed = np.unravel_index(np.argmax(u @ to_centre), hit.shape)
    assert hit[aimed]


ROOM = """
geometry: %s
objects: [{complement: {ball: {radius: 0.9}}, material: {color: {checker: {count: [12, 6]}}}}]
lights: [{point: {at: [0.1, 0.2, 0.3], intensity: 0.5}}]
camera: {at: [-0.3, 0.1, 0.2], look: {along: [%g, %g, 0.4]}, projection: {equirectangular: {}}}
"""


def picture(text: str, **settings: Any) -> tc.Image:
    return tc.render(load_text(text), **{"samples": 1, "channels": CHANNELS} | settings)


@pytest.mark.parametrize("name", ["e3", "h3", "s2xe"])
def test_the_left_edge_of_a_panorama_continues_the_right_one(name: str) -> None:
    """Level cameras that look to and fro see the same, half of the width apart."""
    level = ROOM.replace("0.4]}, proj", "0]}, proj")
    to, fro = (picture(level % (name, *way), size=(128, 64)) for way in ((1, 0.3), (-1, -0.3)))
    for channel, within in (("beauty", 2e-3), ("depth", 1e-4)):
        rolled = np.roll(to.channels[channel], 64, axis=1)
        off = np.abs(rolled - fro.channels[channel]) > within
        assert np.count_nonzero(off) <= 0.004 * off.size, channel


def test_a_panorama_has_one_color_at_its_poles() -> None:
    depth = picture(ROOM % ("h3", 1, 0.3), size=(256, 128)).channels["depth"]
    spread = np.ptp(depth, axis=1)
    # Next to a pole a row is a circle of half a pixel's width, half of it an angle of pi/256.
    assert max(spread[0], spread[-1]) <= 0.05 * spread.max()


def test_what_is_outside_the_circle_is_black_and_not_marched() -> None:
    text = (
        "geometry: e3\nobjects: [{ball: {radius: 0.1}}]\nbackground: red\n"
        "camera: {at: [-1, 0, 0], look: {to: [0, 0, 0]}, projection: {fisheye: {}}}\n"
        "render: {filter: gaussian}\n"
    )
    size, samples = (90, 64), 5
    image = picture(text, size=size, samples=samples)
    x, y = middles(size)
    inside = np.hypot(x - 45, y - 32) <= 32
    assert np.all(image.channels["beauty"][~inside] == 0)
    assert np.all(image.channels["beauty"][inside].max(axis=1) > 0)
    assert np.all(image.channels["steps"][~inside] == 0) and np.all(image.channels["steps"][inside] > 0)
    assert np.all(np.isinf(image.channels["depth"][~inside]))
    assert image.statistics["rays"] == samples * np.count_nonzero(inside)
    assert image.statistics["nan"] == 0
    for finish in ("packet", "refill"):
        again = picture(text, size=size, samples=samples, finish=finish)
        np.testing.assert_array_equal(again.channels["beauty"], image.channels["beauty"])


def test_a_part_outside_the_circle_is_black() -> None:
    text = (
        "geometry: e3\nobjects: [{ball: {radius: 0.1}}]\nbackground: red\n"
        "camera: {projection: {fisheye: {}}}\n"
    )
    with pytest.warns(UserWarning, match="no ray hit anything"):
        corner = picture(text, size=(100, 100), crop=(0, 0, 10, 10))
    assert not corner.channels["beauty"].any() and corner.statistics["rays"] == 0


def test_only_the_projection_of_the_scene_is_pasted() -> None:
    for kind, (projection, _) in VIEWS.items():
        scene = load_text(
            f"geometry: e3\nobjects: [{{ball: {{radius: 0.1}}}}]\ncamera: {{projection: {projection}}}\n"
        )
        files = [part for part in make_plan(scene).parts if part.startswith("camera/")]
        assert files == ["camera/frame.h", f"camera/{'fisheye' if kind == 'dome' else kind}.h"]


@pytest.mark.parametrize(
    ("camera", "size"),
    [
        ("", (960, 540)),
        ("projection: {equirectangular: {}}", (1024, 512)),
        ("projection: {fisheye: {}}", (720, 720)),
        ("projection: {dome: {}}", (720, 720)),
        ("stereo: {layout: side-by-side}", (1920, 540)),
        ("stereo: {layout: top-bottom}", (960, 1080)),
        ("stereo: {layout: anaglyph}", (960, 540)),
        ("projection: {equirectangular: {}}, stereo: {layout: top-bottom}", (1024, 1024)),
    ],
)
def test_the_size_follows_the_projection_and_the_layout(camera: str, size: tuple[int, int]) -> None:
    scene = f"geometry: e3\nobjects: [{{ball: {{radius: 1}}}}]\ncamera: {{{camera}}}\n"
    assert load_text(scene).render.size == size


def test_a_size_that_cannot_be_is_an_error() -> None:
    scene = "geometry: e3\nobjects: [{ball: {radius: 1}}]\ncamera: {%s}\n"
    with pytest.raises(
        ValueError, match=r"twice as wide as high; this is 96 x 64; for example .*\[128, 64\]"
    ):
        picture(scene % "projection: {equirectangular: {}}", size=(96, 64))
    with pytest.raises(ValueError, match=r"half of the width, and 97 is odd; make it 98"):
        picture(scene % "stereo: {layout: side-by-side}", size=(97, 64))
    with pytest.raises(ValueError, match=r"half of the height, and 63 is odd"):
        picture(scene % "stereo: {layout: top-bottom}", size=(96, 63))
    ods = "projection: {equirectangular: {}}, stereo: {layout: side-by-side}"
    with pytest.raises(ValueError, match=r"for each eye \(side-by-side\).*\[256, 64\]"):
        picture(scene % ods, size=(128, 64))
