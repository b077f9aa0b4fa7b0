"""Stereo: where the eyes stand and look, by the Python API; layouts; eyes beyond walls; depth in e3."""

import re
import warnings
from typing import Any

import numpy as np
import projections
import pytest
from projections import Array, middles
from small_kernels import Body, SmallKernels

import thurston_cl as tc
from thurston_cl.device import Device
from thurston_cl.errors import SceneError
from thurston_cl.geometry import Geometry
from thurston_cl.image import CHANNELS
from thurston_cl.models import GEOMETRIES
from thurston_cl.program import geometry_parts
from thurston_cl.scene import load_text
from thurston_cl.scene.placement import CameraFrame, Placement
from thurston_cl.scene.plan import Plan, make_plan

LAYOUTS = ("side-by-side", "top-bottom", "anaglyph")


def picture(text: str, **settings: Any) -> tc.Image:
    return tc.render(load_text(text), **{"samples": 1, "channels": CHANNELS} | settings)


def camera_numbers(plan: Plan, eye: int) -> tuple[Array, Array]:
    """The position (4,) and the frame (3,3) that rays of an eye start from."""
    place = int(re.findall(r"four_numbers\(scene, (\d+)\)", plan.source.generated["scene objects"])[-1])
    numbers = plan.eyes[eye]
    return numbers[place : place + 4], numbers[place + 4 : place + 13].reshape(3, 3)


# -- where the eyes are --------------------------------------------------------------------------------------


@pytest.mark.parametrize("projection", ["perspective: {}", "fisheye: {}"])
@pytest.mark.parametrize("name", GEOMETRIES)
def test_eyes_stand_where_the_flow_leads_and_look_where_transport_leads(
    name: str, projection: str, opencl_device: Device
) -> None:
    distance = 0.5
    scene = load_text(
        f"geometry: {name}\nobjects: [{{ball: {{radius: 0.2}}}}]\n"
        f"camera: {{at: [-0.7, -0.4, 0.3], look: {{to: [0, 0, 0.1]}}, projection: {{{projection}}}, "
        f"stereo: {{layout: side-by-side, distance: {distance}}}}}\n"
    )
    plan = make_plan(scene, device=opencl_device)
    g = Geometry(name, "double", opencl_device)
    nose = CameraFrame(scene.camera, Placement(g))
    assert len(plan.eyes) == 2
    for eye, reach in enumerate((-distance / 2, distance / 2)):
        point, frame = camera_numbers(plan, eye)
        # Along the direction backwards, instead of a negative time.
        side = nose.frame[0] * np.sign(reach)
        want = g.flow(side, abs(reach), base=nose.point)[0][0]
        turn = g.transport(side, abs(reach), base=nose.point)[0]
        np.testing.assert_allclose(point, want, atol=1e-12)
        np.testing.assert_allclose(frame, nose.frame @ turn.T, atol=1e-12)
    # Nothing but the camera differs: both eyes are one program over two buffers.
    assert np.count_nonzero(plan.eyes[0] != plan.eyes[1]) <= 13


def turning_eye(name: str, device: Device, precision: str, lanes: int) -> SmallKernels:
    head = "FN real scene_distance(point p, vector v, scene_data scene) { return REAL(0); }"
    text = """
      scene_data scene = {numbers, 0, 0};
      ray r = omnidirectional(IN(0), IN(1), scene, 0);
      direction u = pull(r.p, r.v);
      OUT(0, r.p.x); OUT(1, r.p.y); OUT(2, r.p.z); OUT(3, r.p.w); OUT(4, u.x); OUT(5, u.y); OUT(6, u.z);
      """
    camera = ("frame", "equirectangular", "omnidirectional")
    parts = (
        *geometry_parts(name),
        "scene_types.h",
        "flow/exact.h",
        "march.h",
        *(f"camera/{file}.h" for file in camera),
    )
    return SmallKernels(device, parts, {"eye": Body(2, 7, text)}, precision, lanes, head)


@pytest.mark.parametrize(("precision", "within"), [("double", 1e-12), ("single", 2e-5)])
@pytest.mark.parametrize("name", GEOMETRIES)
def test_turning_eyes_stand_beside_every_column(
    name: str, precision: str, within: float, opencl_device: Device
) -> None:
    if not opencl_device.info.fp64:
        pytest.skip("the device has no double precision")
    g, size = Geometry(name, "double", opencl_device), (64, 32)
    camera = load_text(
        f"geometry: {name}\nobjects: [{{ball: {{radius: 0.2}}}}]\n"
        "camera: {at: [-0.7, -0.4, 0.3], look: {to: [0, 0, 0.1], up: [0.2, 0, 1]}}\n"
    ).camera
    nose = CameraFrame(camera, Placement(g))
    small = turning_eye(name, opencl_device, precision, 1)
    x, y = (values.ravel()[::5] for values in middles(size))
    looking = projections.equirectangular(x, y, size) @ nose.frame
    # To the right of the column's own direction on the horizon: a quarter turn further.
    aside = projections.equirectangular(x + size[0] / 4, np.full_like(x, size[1] / 2), size) @ nose.frame
    for reach in (0.3, -0.3):
        got = small.run("eye", [x, y], [*nose.point, *nose.frame.ravel(), *size, reach]).T
        eyes = g.flow(aside * np.sign(reach), abs(reach), base=nose.point)[0]
        turns = g.transport(aside * np.sign(reach), abs(reach), base=nose.point)
        np.testing.assert_allclose(got[:, :4], eyes, atol=within)
        np.testing.assert_allclose(got[:, 4:], np.einsum("nij,nj->ni", turns, looking), atol=within)


# -- layouts -------------------------------------------------------------------------------------------------

BALLS = """
geometry: %s
manifold: %s
objects:
  - ball: {radius: 0.15}
    material: {color: {checker: {count: [16, 8]}}}
  - {ball: {radius: 0.12}, at: [0.2, 0.1, -0.1]}
lights: [{point: {at: [0.2, -0.1, 0.3], intensity: 0.3}}]
background: [0.1, 0.2, 0.3]
render: {far: 6}
camera: {at: [0.2, -0.3, 0.1], look: {along: [0.4, 1, 0.2]}%s}
"""
TORUS = ("e3", "three-torus")
WHOLE = {"side-by-side": (128, 32), "top-bottom": (64, 64), "anaglyph": (64, 32)}


def halves(image: tc.Image, layout: str, channel: str) -> tuple[Array, Array]:
    """What the left and the right eye see."""
    values = image.channels[channel]
    if layout == "side-by-side":
        return values[:, : values.shape[1] // 2], values[:, values.shape[1] // 2 :]
    return values[: values.shape[0] // 2], values[values.shape[0] // 2 :]


@pytest.mark.parametrize("projection", ["perspective: {}", "equirectangular: {}", "fisheye: {}"])
def test_eyes_that_are_not_apart_see_the_same_as_one(projection: str) -> None:
    one = picture(BALLS % (*TORUS, f", projection: {{{projection}}}"), size=(64, 32), samples=2)
    for layout in LAYOUTS:
        stereo = f", projection: {{{projection}}}, stereo: {{layout: {layout}, distance: 0}}"
        two = picture(BALLS % (*TORUS, stereo), size=WHOLE[layout], samples=2)
        assert two.statistics["rays"] == 2 * one.statistics["rays"]
        for channel in CHANNELS:
            seen = [two.channels[channel]] if layout == "anaglyph" else halves(two, layout, channel)
            for eye in seen:
                np.testing.assert_array_equal(eye, one.channels[channel], err_msg=f"{layout} {channel}")


@pytest.mark.parametrize("projection", ["perspective: {}", "equirectangular: {}"])
def test_layouts_hold_the_same_two_pictures(projection: str) -> None:
    text = BALLS % (*TORUS, ", projection: {%s}, stereo: {layout: %s, distance: %g}")
    beside, over, red_cyan = (
        picture(text % (projection, layout, 0.1), size=WHOLE[layout]) for layout in LAYOUTS
    )
    for channel in CHANNELS:
        left, right = halves(beside, "side-by-side", channel)
        np.testing.assert_array_equal(halves(over, "top-bottom", channel), (left, right))
        if channel == "beauty":
            left = np.concatenate([left[..., :1], right[..., 1:]], axis=2)
        np.testing.assert_array_equal(red_cyan.channels[channel], left)
    # Eyes that change places.
    crossed = picture(text % (projection, "side-by-side", -0.1), size=WHOLE["side-by-side"])
    left, right = halves(beside, "side-by-side", "beauty")
    np.testing.assert_array_equal(halves(crossed, "side-by-side", "beauty"), (right, left))
    assert not np.array_equal(left, right)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_crop_is_that_part_of_the_picture_of_both_eyes(layout: str) -> None:
    text = BALLS % (*TORUS, f", stereo: {{layout: {layout}, distance: 0.1}}")
    size = WHOLE[layout]
    whole = picture(text, size=size)
    middle, quarter = (size[0] // 2, size[1] // 2), (size[0] // 4, size[1] // 4)
    for crop in [
        (middle[0] - 5, middle[1] - 7, middle[0] + 9, middle[1] + 3),  # over the seam
        (1, 2, quarter[0], quarter[1]),  # of the left eye
        (middle[0] + 2, middle[1] + 3, size[0] - 1, size[1]),  # of the right one
    ]:
        part = picture(text, size=size, crop=crop)
        for channel in CHANNELS:
            np.testing.assert_array_equal(
                part.channels[channel], whole.channels[channel][crop[1] : crop[3], crop[0] : crop[2]]
            )
        eyes = 2 if layout == "anaglyph" else 1
        assert part.statistics["rays"] == eyes * (crop[2] - crop[0]) * (crop[3] - crop[1])


def test_progress_counts_both_eyes() -> None:
    text = BALLS % (*TORUS, ", stereo: {layout: anaglyph}")
    seen: list[tuple[int, int]] = []
    picture(text, size=(32, 16), samples=3, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(done, 6) for done in range(1, 7)]
    # The right eye adds colors only.
    seen.clear()
    picture(text, size=(32, 16), channels=["depth"], progress=lambda done, total: seen.append((done, total)))
    assert seen == [(1, 1)]


# -- what they see -------------------------------------------------------------------------------------------

POINT = (
    "geometry: e3\nobjects: [{ball: {radius: 0.02}, at: [%g, 0, 0]}]\nlights: [{point: {at: [0, 0, 0.5]}}]\n"
)


def columns(image: tc.Image) -> tuple[float, float]:
    """The column, in pixels from the middle, of what the left and right eye see."""
    found = [np.argwhere(objects > 0) + 0.5 for objects in halves(image, "side-by-side", "object")]
    width = image.width // 2
    assert all(len(pixels) >= 20 for pixels in found)
    return (found[0].mean(axis=0)[1] - width / 2, found[1].mean(axis=0)[1] - width / 2)


@pytest.mark.parametrize("away", [1.0, 2.5])
def test_parallax_in_e3_is_that_of_two_pinholes(away: float) -> None:
    """At the distance D a place is at +-d/(2 D) in the picture plane of parallel views."""
    fov, distance, height = 20, 0.1, 400
    camera = (
        f"camera: {{at: [0, 0, 0], fov: {fov} deg, stereo: {{layout: side-by-side, distance: {distance}}}}}"
    )
    left, right = columns(picture(POINT % away + camera, size=(2 * height, height)))
    shift = 0.5 * distance / away / np.tan(np.radians(fov / 2)) * height / 2
    assert left == pytest.approx(shift, abs=0.15)
    assert right == pytest.approx(-shift, abs=0.15)


@pytest.mark.parametrize("turn", [0, 75, 180])
def test_parallax_of_a_panorama_is_the_same_all_around(turn: float) -> None:
    """Rays touch the circle of the eyes: at the distance D it is asin(d/2 / D), at every azimuth."""
    distance, away, width = 0.2, 0.6, 1024
    camera = (
        f"camera: {{at: [0, 0, 0], move: [{{yaw: {turn} deg}}], projection: {{equirectangular: {{}}}}, "
        f"stereo: {{layout: side-by-side, distance: {distance}}}}}"
    )
    image = picture(POINT % away + camera, size=(2 * width, width // 2))
    # A camera that has turned left sees it to the right; counted round, so that it may lie on the edge.
    unit, shift = width / 360, np.degrees(np.arcsin(0.5 * distance / away))
    for eye, sign in zip(halves(image, "side-by-side", "object"), (1, -1), strict=True):
        seen = np.argwhere(eye > 0)[:, 1] + 0.5
        angle = np.angle(np.exp(2j * np.pi * seen / width).mean(), deg=True) - 180
        want = turn + sign * shift
        assert (angle - want + 180) % 360 - 180 == pytest.approx(0, abs=0.25 / unit)


ASKEW = "at: [0.35, -0.3, 0.3], look: {along: [0.3, 1, 0.2]}"
# Its right is along the line, which is what the manifold closes.
ACROSS = "at: [0.6, -0.3, 0.3], look: {to: [0.1, 0.05, 0.2], up: [0.5, 0.8, 0]}, fov: 120 deg"
BEYOND = [
    ("e3", "three-torus", ASKEW, 0.5),
    ("h3", "seifert-weber", ASKEW, 1.4),
    ("nil", "heisenberg", ASKEW, 0.6),
    ("s2xe", "hopf-manifold", ACROSS, 1.4),
]


@pytest.mark.parametrize(("name", "manifold", "view", "distance"), BEYOND)
def test_an_eye_beyond_a_wall_sees_what_a_camera_there_sees(
    name: str, manifold: str, view: str, distance: float, opencl_device: Device
) -> None:
    """That camera is led back into the cell; the eye is not, until its rays are marched."""
    text = (
        f"geometry: {name}\nmanifold: {manifold}\nrender: {{far: 4}}\n"
        "objects: [{ball: {radius: 0.2}, at: [0.1, 0.05, 0]}]\nlights: [{point: {at: [0, 0.3, 0.2]}}]\n"
        f"camera: {{{view}%s}}\n"
    )
    stereo = text % f", stereo: {{layout: side-by-side, distance: {distance}}}"
    plan = make_plan(load_text(stereo), device=opencl_device)
    lattice = load_text(stereo).lattice
    assert lattice is not None
    outside = [
        not np.allclose(lattice.teleport(camera_numbers(plan, eye)[0][None])[0], camera_numbers(plan, eye)[0])
        for eye in range(2)
    ]
    assert any(outside)
    two = picture(stereo, size=(128, 64), precision="double")
    for eye, reach in enumerate((-distance / 2, distance / 2)):
        there = picture(text % f", move: [{{right: {reach}}}]", size=(64, 64), precision="double")
        for channel, within in (("depth", 1e-3), ("object", 0), ("beauty", 1e-2)):
            seen = halves(two, "side-by-side", channel)[eye]
            with np.errstate(invalid="ignore"):
                off = np.abs(seen.astype(float) - there.channels[channel].astype(float)) > within
            assert np.count_nonzero(off) <= 0.01 * off.size, (eye, channel)
        # The cells are numbered from the one the camera stands in, so numbers differ, but not what has one.
        pairs = np.stack([halves(two, "side-by-side", "cell")[eye], there.channels["cell"]])
        pairs = pairs[:, (pairs > 0).all(axis=0)]
        assert pairs.shape[1] > 100
        distinct, counts = np.unique(pairs, axis=1, return_counts=True)
        most = [counts[distinct[0] == number].max() for number in np.unique(distinct[0])]
        assert sum(most) >= 0.98 * pairs.shape[1]


@pytest.mark.parametrize("projection", ["perspective: {}", "equirectangular: {}"])
def test_cells_have_one_number_for_both_eyes(projection: str, opencl_device: Device) -> None:
    """In the three-torus the cell of a ball is known from where its rays end in the whole space."""
    distance = 0.5
    at = np.array([0.1, 0.05, 0])
    scene = load_text(
        "geometry: e3\nmanifold: three-torus\nrender: {far: 4}\n"
        f"objects: [{{ball: {{radius: 0.2}}, at: {at.tolist()}}}]\n"
        "camera: {at: [0.35, -0.3, 0.3], look: {along: [0.3, 1, 0.2]}, fov: 80 deg, "
        f"stereo: {{layout: side-by-side, distance: {distance}}}}}\n".replace(
            "fov: 80 deg", "fov: 80 deg" if "persp" in projection else f"projection: {{{projection}}}"
        )
    )
    size = (128, 64)
    image = tc.render(scene, size=(2 * size[0], size[1]), samples=1, channels=CHANNELS, precision="double")
    nose = CameraFrame(scene.camera, Placement(Geometry("e3", "double", opencl_device)))
    x, y = middles(size)
    if "persp" in projection:
        u = projections.perspective(x, y, size, np.radians(80))
        aside = np.broadcast_to(projections.RIGHT, u.shape)
    else:
        u = projections.equirectangular(x, y, size)
        aside = projections.equirectangular(x + size[0] / 4, np.full_like(y, size[1] / 2), size)
    found: dict[tuple[int, ...], set[int]] = {}
    beyond_a_wall = False
    for eye, reach in enumerate((-distance / 2, distance / 2)):
        depth, cell = (halves(image, "side-by-side", channel)[eye] for channel in ("depth", "cell"))
        hit = np.isfinite(depth)
        eyes = nose.point[:3] + reach * (aside @ nose.frame)
        beyond_a_wall |= bool(np.any(np.abs(eyes) > 0.5))
        ends = eyes[hit] + depth[hit, None] * (u @ nose.frame)[hit]
        which = np.rint(ends - at).astype(int)
        assert np.abs(np.linalg.norm(ends - at - which, axis=1) - 0.2).max() < 1e-3
        for k, number in zip(which, cell[hit], strict=True):
            found.setdefault(tuple(k), set()).add(int(number))
    assert beyond_a_wall and len(found) > 20
    assert all(len(cells) == 1 for cells in found.values())
    assert found[0, 0, 0] == {1}
    assert len({min(cells) for cells in found.values()}) == len(found)


# -- mistakes ------------------------------------------------------------------------------------------------


def test_an_eye_inside_an_object_is_named() -> None:
    text = "geometry: e3\nobjects: [{ball: {radius: 0.3}, at: [0, %g, 0]}]\ncamera: {at: [0, 0, 0], %s}\n"
    stereo = "stereo: {layout: top-bottom, distance: 1}"
    # The camera looks along x with z up: left is y.
    for where, who in ((0.5, "left eye"), (-0.5, "right eye")):
        with warnings.catch_warnings(), pytest.raises(SceneError, match=f"the {who} is inside an object"):
            warnings.simplefilter("ignore")
            picture(text % (where, stereo), size=(32, 64))


@pytest.mark.parametrize("projection", ["perspective: {}", "equirectangular: {}"])
def test_eyes_too_far_apart_are_an_error_at_their_distance(projection: str) -> None:
    text = (
        "geometry: h3\nobjects: [{ball: {radius: 0.3}}]\n"
        f"camera: {{projection: {{{projection}}}, stereo: {{layout: anaglyph, distance: 80}}}}\n"
    )
    with pytest.raises(SceneError, match="too far apart") as error:
        picture(text)
    assert ":3:" in str(error.value) and "make the distance smaller" in str(error.value)


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("projection", ["perspective", "equirectangular"])
def test_eyes_that_are_hardly_apart_see_nearly_the_same_as_one(geometry: str, projection: str) -> None:
    """In every geometry; around the camera by the kernel that flows to the eye of each column."""
    scene = (
        "geometry: %s\ncamera: {at: [0.3, -1.1, 0.4], look: {to: [0, 0, 0]}, projection: {%s: {}}%s}\n"
        "objects:\n  - ball: {radius: 0.5}\n  - ball: {radius: 0.3}\n    at: [-0.6, -1.2, 0.2]\n"
        "lights: [{point: {at: [1, -1, 1]}}]\nrender: {far: 6}\n"
    )
    one = picture(scene % (geometry, projection, ""), size=(96, 48))
    apart = ", stereo: {layout: top-bottom, distance: 1.0e-6}"
    two = picture(scene % (geometry, projection, apart), size=(96, 96))
    for eye in halves(two, "top-bottom", "beauty"):
        off = np.abs(eye - one.channels["beauty"]).max(axis=2) > 2e-3
        assert np.count_nonzero(off) <= 0.01 * off.size
    assert 0.02 < (one.channels["object"] > 0).mean() < 0.95
