"""A sky behind everything: its colors by the direction of the ray, in fog, in mirrors, at infinity of h3; and
that a scene without one has the program it had.
"""

from typing import Any

import numpy as np
import pytest
from camera_rays import view
from small_kernels import Body, SmallKernels

import thurston_cl as tc
from thurston_cl.device import Device
from thurston_cl.program import LANE_WIDTHS, geometry_parts, kernel_text
from thurston_cl.scene import load_text
from thurston_cl.scene.placement import CameraFrame, Placement
from thurston_cl.scene.plan import make_plan

ZENITH, HORIZON, GROUND = np.array([[0.1, 0.2, 0.9], [0.8, 0.9, 1.0], [0.3, 0.2, 0.1]])
SKY = f"sky: {{zenith: {ZENITH.tolist()}, horizon: {HORIZON.tolist()}, ground: {GROUND.tolist()}"
SIZE = (48, 36)
FAR_BALL = "objects: [{ball: {radius: 0.1}, at: [0, 0, -3]}]\n"


def colors_of(sines: Any) -> np.ndarray:
    """The colors at these sines of the angle above the horizon, by the formula of the reference page."""
    sines = np.asarray(sines)[:, None]
    haze = (1 - np.abs(sines)) ** 4
    return haze * HORIZON + (1 - haze) * np.where(sines > 0, ZENITH, GROUND)


def seen(text: str, **settings: Any) -> tc.Image:
    return tc.render(load_text(text), **{"size": SIZE, "samples": 1} | settings)


def kernels(device: Device, geometry: str, precision: str, lanes: int) -> SmallKernels:
    body = "point p = POINT(0), v = POINT(4);\nscene_data scene = {numbers, 0, 0, 0};\n"
    body += "real3_lanes c = sky(p, v, scene, 3); OUT(0, c.x); OUT(1, c.y); OUT(2, c.z);"
    parts = (*geometry_parts(geometry), "scene_types.h", "light/sky.h")
    if precision == "double" and not device.info.fp64:
        pytest.skip("the device has no double precision")
    return SmallKernels(device, parts, {"sky": Body(8, 3, body)}, precision, lanes)


NUMBERS = [0, 0, 0, *ZENITH, *HORIZON, *GROUND, 0, 0, 1]


@pytest.mark.parametrize("precision", ["single", "double"])
def test_colors_from_the_ground_to_the_zenith(precision: str, opencl_device: Device) -> None:
    """At the horizon and straight up and down the colors themselves; between them, on both sides of the
    horizon, the formula; and the same bits at every width."""
    angles = np.radians([90, 60, 30, 9.15, 1, 1e-5, 0, -1e-5, -1, -30, -90])
    one = np.ones(len(angles))
    rays = [5 * one, -3 * one, 7 * one, one, np.cos(angles), 0 * one, np.sin(angles), 0 * one]
    epsilon = {"single": 2.0**-23, "double": 2.0**-52}[precision]
    alone = None
    for lanes in LANE_WIDTHS:
        got = kernels(opencl_device, "e3", precision, lanes).run("sky", rays, NUMBERS).T
        np.testing.assert_allclose(got, colors_of(np.sin(angles)), atol=20 * epsilon)
        alone = got if alone is None else alone
        np.testing.assert_array_equal(got, alone)
    np.testing.assert_allclose(got[[0, 6, 10]], [ZENITH, HORIZON, GROUND], atol=4 * epsilon)
    # Half of the change is within 9 degrees of the horizon.
    np.testing.assert_allclose(got[3], (ZENITH + HORIZON) / 2, atol=1e-3)


@pytest.mark.parametrize("precision", ["single", "double"])
def test_the_sky_of_h3_stays_the_same_along_a_ray(precision: str, opencl_device: Device) -> None:
    """From wherever it is asked on one geodesic; on one through the origin it is that of its direction."""
    at = kernels(opencl_device, "h3", precision, 4)
    g = tc.Geometry("h3", "double")
    rng = np.random.default_rng(2)
    directions = rng.normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    atol = {"single": 3e-6, "double": 1e-14}[precision]

    def seen_at(length: float, base: np.ndarray) -> np.ndarray:
        points, ahead = g.flow(directions, length, base=base)
        return at.run("sky", np.hstack([points, g.velocity(points, ahead)]).T, NUMBERS).T

    origin = np.tile([0, 0, 0, 1.0], (200, 1))
    for length in (0, 0.5, 3, 14):
        expected = colors_of(directions[:, 2])
        np.testing.assert_allclose(seen_at(length, origin), expected, atol=atol, err_msg=str(length))
    start = g.flow(directions[::-1], 0.8)[0]
    np.testing.assert_allclose(seen_at(0, start), seen_at(4, start), atol=30 * atol)


@pytest.mark.parametrize("up", [(0, 0, 1), (0, 2, 0), (1, -1, 0.5)])
def test_the_sky_of_a_picture(up: tuple[float, float, float]) -> None:
    scene = (
        f"geometry: e3\n{FAR_BALL}background: {{{SKY}, up: {list(up)}}}}}\n"
        "camera: {at: [1, 2, 3], look: {along: [1, 0.3, 0.1]}, fov: 70 deg}\n"
    )
    image = seen(scene)
    camera = CameraFrame(load_text(scene).camera, Placement(tc.Geometry("e3", "double")))
    directions = view(camera, SIZE, np.radians(70))
    expected = colors_of(directions @ np.array(up) / np.linalg.norm(up))
    np.testing.assert_allclose(image.channels["beauty"].reshape(-1, 3), expected, atol=3e-6)
    assert image.statistics["hits"] == image.statistics["nan"] == 0


def test_without_a_ground_all_below_is_horizon() -> None:
    scene = f"geometry: e3\n{FAR_BALL}background: {{sky: {{zenith: blue, horizon: white}}}}\n"
    camera = "camera: {at: [0, 0, 0], look: {along: [1, 0, -1]}, fov: 60 deg}\n"
    np.testing.assert_allclose(seen(scene + camera).channels["beauty"], 1, atol=1e-6)


@pytest.mark.parametrize(
    "fog", ["exponential: {density: 0.3, color: red}", "linear: {length: 2, color: red}"]
)
def test_fog_does_not_hide_the_sky(fog: str) -> None:
    def scene(effects: str) -> tc.Image:
        return seen(
            f"geometry: e3\nobjects: [{{ball: {{radius: 0.5}}}}]\nbackground: {{{SKY}}}}}\n"
            f"camera: {{at: [-2, 0, 0]}}\n{effects}"
        )

    clear, foggy = scene(""), scene(f"effects: {{fog: {{{fog}}}}}\n")
    hit = clear.channels["object"] > 0
    np.testing.assert_array_equal(foggy.channels["beauty"][~hit], clear.channels["beauty"][~hit])
    assert hit.any() and np.abs(foggy.channels["beauty"] - clear.channels["beauty"])[hit].max() > 0.1


@pytest.mark.parametrize("density", [0, 0.2])
def test_mirrors_show_the_sky(density: float) -> None:
    """In a level mirror the sky upside down: what fog leaves of it on the way there, and the rest fog."""
    fog = f"fog: {{exponential: {{density: {density}, color: [1, 0, 0.5]}}}}, " if density else ""
    scene = (
        "geometry: e3\nobjects: [{half-space: {}, material: {reflectivity: 1}}]\n"
        "camera: {at: [0, 0, 1], look: {along: [1, 0.3, -0.6]}, fov: 50 deg}\n"
        f"effects: {{{fog}reflections: {{depth: 1}}}}\nbackground: {{{SKY}}}}}\nrender: {{steps: 1000}}\n"
        "lights: [sun: {}]\n"
    )
    image = seen(scene)
    camera = CameraFrame(load_text(scene).camera, Placement(tc.Geometry("e3", "double")))
    directions = view(camera, SIZE, np.radians(50))
    hit = image.channels["object"].ravel() > 0
    assert hit.sum() > 1000 and image.statistics["nan"] == 0
    left = np.exp(density * 1 / directions[hit, 2:])
    expected = left * colors_of(-directions[hit, 2]) + (1 - left) * np.array([1, 0, 0.5])
    np.testing.assert_allclose(image.channels["beauty"].reshape(-1, 3)[hit], expected, atol=2e-4)


def test_mirrors_of_h3_show_the_sky_without_losing_a_ray() -> None:
    """Lanes whose ray is done while others are mirrored hold any ray."""
    scene = (
        "geometry: h3\nobjects: [{ball: {radius: 0.5}, material: {reflectivity: 0.8}}]\n"
        "camera: {at: [0, -1.5, 0.3], look: {to: [0, 0, 0]}}\neffects: {reflections: {depth: 2}}\n"
        f"background: {{{SKY}}}}}\n"
    )
    many, one = (seen(scene, size=(96, 64), lanes=lanes) for lanes in (16, 1))
    assert many.statistics["nan"] == one.statistics["nan"] == 0
    # Edges may move by a pixel.
    off = np.abs(many.channels["beauty"] - one.channels["beauty"]).max(axis=2) > 1e-3
    assert np.count_nonzero(off) <= 0.01 * off.size and many.statistics["hits"] > 100


def test_a_ray_that_comes_to_nothing_shows_the_horizon_and_is_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    place = "  look first;\n"

    def spoilt(file: str) -> str:
        return kernel_text(file).replace(place, "  r.t = REAL(NAN);\n" + place)

    scene = f"geometry: e3\n{FAR_BALL}background: {{{SKY}}}}}\n"
    monkeypatch.setattr("thurston_cl.program.kernel_text", spoilt)
    image = seen(scene)
    assert image.statistics["nan"] >= SIZE[0] * SIZE[1]
    np.testing.assert_allclose(image.channels["beauty"], np.tile(HORIZON, (*SIZE[::-1], 1)), atol=1e-6)


@pytest.mark.parametrize("effects", ["", "effects: {reflections: {depth: 1}}\n"])
def test_a_plain_color_asks_for_nothing_of_a_sky(effects: str) -> None:
    """Two plain colors share their program, which has neither the sky nor what calls it."""
    mirror = ", material: {reflectivity: 0.5}" if effects else ""
    head = f"geometry: e3\nobjects: [{{ball: {{radius: 1}}{mirror}}}]\n{effects}"
    plans = [make_plan(load_text(f"{head}background: {color}\n")) for color in ("black", "[0.5, 2, 1]")]
    assert plans[0].source.text == plans[1].source.text
    assert "sky" not in "".join(plans[0].source.generated.values())
    assert "SKY" not in plans[0].source.defines and "light/sky.h" not in plans[0].parts
    with_sky = make_plan(load_text(f"{head}background: {{sky: {{}}}}\n"))
    assert with_sky.source.defines["SKY"] == 1
    assert ("SKY" in kernel_text("light/reflection.h")) and ("SKY" not in kernel_text("light/look.h"))
