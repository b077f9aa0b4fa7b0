"""Pictures: the marcher, its ways of finishing, precision and lanes, effects left out, arguments and
metadata.
"""

import json

import numpy as np
import pytest

import thurston_cl as tc
from thurston_cl.errors import SceneError
from thurston_cl.image import CHANNELS
from thurston_cl.program import kernel_text
from thurston_cl.rendering import Tile, tiles
from thurston_cl.sampling import sample_shifts
from thurston_cl.scene import load_text
from thurston_cl.scene.plan import make_plan

CORRIDOR = """
geometry: h3
manifold: ideal-cube
camera: {at: [0.1, 0.05, 0.02], fov: 70 deg}
objects:
  - complement: {ball: {radius: 1.02}}
"""

BALLS = """
geometry: e3
manifold: three-torus
camera: {at: [0.2, -0.3, 0.1], look: {along: [0.4, 1, 0.2]}, fov: 90 deg}
objects:
  - ball: {radius: 0.15}
    material: {color: {checker: {count: [16, 8]}}}
  - ball: {radius: 0.12}
    at: [0.2, 0.1, -0.1]
lights:
  - point: {at: [0.2, -0.1, 0.3], intensity: 0.3, translates: 3}
    shadows: hard
effects:
  fog: {exponential: {density: 0.2}}
"""

SPHERE = """
geometry: s3
camera: {at: [0, -1.0, 0.3], look: {to: [0, 0, 0]}, fov: 90 deg}
objects:
  - ball: {radius: 0.3}
  - half-space: {normal: [0, 0, 1], offset: -0.6}
lights:
  - point: {at: [0.5, -0.6, 0.7]}
"""


def picture(text: str, **settings):
    return tc.render(load_text(text), **{"size": (160, 96), "samples": 1, "channels": CHANNELS} | settings)


@pytest.mark.parametrize("text", [CORRIDOR, BALLS, SPHERE])
def test_finishing_by_refill_gives_the_same_picture_to_the_last_bit(text):
    packet, refill = picture(text, finish="packet"), picture(text, finish="refill")
    for name, channel in packet.channels.items():
        np.testing.assert_array_equal(channel, refill.channels[name], err_msg=name)
    assert packet.statistics["out_of_steps"] == refill.statistics["out_of_steps"]


@pytest.mark.parametrize("text", [CORRIDOR, BALLS, SPHERE])
@pytest.mark.parametrize("lanes", [4, 16])
def test_every_width_shows_what_one_lane_shows(text, lanes):
    one, many = picture(text, lanes=1, size=(96, 64)), picture(text, lanes=lanes, size=(96, 64))
    pixels = one.channels["object"].size
    # exp and log may differ in the last bit between a scalar and a vector built-in, and some rays are
    # chaotic.
    assert np.count_nonzero(one.channels["object"] != many.channels["object"]) <= 0.002 * pixels
    assert np.count_nonzero(one.channels["cell"] != many.channels["cell"]) <= 0.005 * pixels
    off = np.abs(one.channels["beauty"] - many.channels["beauty"]).max(axis=2) > 1e-2
    assert np.count_nonzero(off) <= 0.01 * pixels


@pytest.mark.parametrize("text", [CORRIDOR, BALLS, SPHERE])
def test_single_precision_shows_what_double_shows(text, opencl_device):
    if not opencl_device.info.fp64:
        pytest.skip("the device has no double precision")
    single, double = picture(text), picture(text, precision="double")
    pixels = single.channels["object"].size
    assert np.count_nonzero(single.channels["object"] != double.channels["object"]) <= 0.005 * pixels
    off = np.abs(single.channels["beauty"] - double.channels["beauty"]).max(axis=2) > 1e-2
    assert np.count_nonzero(off) <= 0.02 * pixels


def test_depth_of_a_ball_straight_ahead_is_the_distance_to_its_surface():
    for geometry in ("e3", "s3", "h3"):
        text = (
            f"geometry: {geometry}\ncamera: {{at: [0, 0, 0]}}\n"
            "objects:\n  - ball: {radius: 0.3}\n    at: [1.2, 0, 0]\n"
        )
        image = picture(text, size=(33, 33), precision="double")
        assert image.channels["depth"][16, 16] == pytest.approx(0.9, abs=2e-4), geometry
        # The frame at the hit point is carried along the same geodesic, so the ball's pole shows -x.
        np.testing.assert_allclose(image.channels["normal"][16, 16], [-1, 0, 0], atol=1e-3)


def test_what_is_not_hit_has_no_object_no_cell_and_infinite_depth():
    image = picture(
        "geometry: e3\ncamera: {at: [0, 0, 0]}\nobjects: [{ball: {radius: 0.3}, at: [2, 0, 0]}]\n"
        "background: [0.1, 0.2, 0.3]\n"
    )
    missed = image.channels["object"] == 0
    assert missed[0, 0] and not missed[48, 80]
    assert np.all(np.isinf(image.channels["depth"][missed]))
    assert np.all(image.channels["cell"][missed] == 0)
    np.testing.assert_allclose(image.channels["beauty"][0, 0], [0.1, 0.2, 0.3], rtol=1e-6)


def test_cells_of_the_three_torus_are_numbered_by_distance_and_whole():
    image = picture(
        "geometry: e3\nmanifold: three-torus\nobjects: [{ball: {radius: 0.2}, at: [0.25, 0.1, 0]}]\n"
        "camera: {at: [-0.3, 0, 0]}\n"
    )
    cells = image.channels["cell"]
    assert cells[48, 84] == 1
    # Every ball is seen in one cell: near the ball's middle no pixel has another number.
    assert np.all(cells[44:52, 80:88] == 1)
    assert np.unique(cells).size > 20


def test_a_crop_is_that_part_of_the_whole_picture():
    whole, part = picture(CORRIDOR), picture(CORRIDOR, crop=(37, 21, 90, 70))
    for name, channel in part.channels.items():
        np.testing.assert_array_equal(channel, whole.channels[name][21:70, 37:90], err_msg=name)


def test_samples_change_the_picture_but_not_the_other_channels():
    one, four = picture(CORRIDOR), picture(CORRIDOR, samples=4)
    np.testing.assert_array_equal(one.channels["depth"], four.channels["depth"])
    assert not np.array_equal(one.channels["beauty"], four.channels["beauty"])
    assert four.statistics["rays"] == 4 * one.statistics["rays"]
    again = picture(CORRIDOR, samples=4)
    np.testing.assert_array_equal(again.channels["beauty"], four.channels["beauty"])


def test_sample_shifts_begin_in_the_centre_and_fill_the_pixel():
    shifts = sample_shifts(256)
    np.testing.assert_array_equal(shifts[0], [0.5, 0.5])
    counts, _, _ = np.histogram2d(*shifts.T, bins=8, range=[[0, 1], [0, 1]])
    assert counts.min() >= 2 and counts.max() <= 6


def test_tiles_cover_the_area_once():
    covered = np.zeros((70, 90), int)
    for tile in tiles((5, 10, 90, 70), 32):
        assert tile.padded[0] % 32 == 0 and tile.padded[1] % 32 == 0
        covered[tile.top : tile.top + tile.height, tile.left : tile.left + tile.width] += 1
    assert np.all(covered[10:, 5:] == 1) and covered[:10].sum() == 0 and covered[:, :5].sum() == 0
    assert Tile(0, 0, 33, 1).padded == (64, 32)


def test_effects_that_are_not_named_are_not_in_the_source():
    bare = make_plan(load_text(CORRIDOR)).source.text
    for name in ("hard_shadow", "fog_exponential", "checker", "cell_behind"):
        assert name not in bare.split('"scene objects"')[1].replace("cell_behind(real", ""), name
        assert f"FN {name}" not in bare
    for part in ("light/hard_shadow.h", "light/fog_exponential.h", "pattern/checker.h"):
        assert kernel_text(part).strip() in make_plan(load_text(BALLS)).source.text
        assert kernel_text(part).strip() not in bare
    assert picture(CORRIDOR).statistics["shadow_steps"] == 0
    assert picture(BALLS).statistics["shadow_steps"] > 0


def test_shadows_and_fog_change_only_the_colours():
    with_all = picture(BALLS)
    bare = picture(BALLS.replace("    shadows: hard\n", "").split("effects:")[0])
    for name in ("depth", "object", "cell", "normal"):
        np.testing.assert_array_equal(with_all.channels[name], bare.channels[name], err_msg=name)
    assert not np.array_equal(with_all.channels["beauty"], bare.channels["beauty"])


def test_scenes_that_differ_in_numbers_share_their_program():
    first, second = load_text(BALLS), load_text(BALLS.replace("0.15", "0.16").replace("0.12", "0.11"))
    assert make_plan(first).source.text == make_plan(second).source.text
    assert not np.array_equal(make_plan(first).numbers, make_plan(second).numbers)


def test_distance_near_walls_is_chosen_by_what_crosses_them():
    def choice(objects: str) -> tuple[str, int]:
        plan = make_plan(load_text(f"geometry: e3\nmanifold: three-torus\nobjects: [{objects}]\n"))
        return plan.near_walls, plan.object_images

    assert choice("tile: {ball: 0.6}") == ("domain", 0)
    assert choice("{ball: {radius: 0.4999}}") == ("images", 0)
    assert choice("{ball: {radius: 0.5001}}") == ("images", 6)
    assert choice("{ball: {radius: 0.2}, at: [0.4, 0, 0]}") == ("images", 1)
    assert choice("{ball: {radius: 0.2}, at: [0.5, 0.5, 0.5]}") == ("images", 7)
    assert choice("{tile: {ball: 0.6}}, {ball: {radius: 0.2}, at: [0.4, 0, 0]}") == ("images", 1)
    assert choice("{cylinder: {radius: 0.1}}") == ("images", 18)
    assert make_plan(load_text(SPHERE)).near_walls == "whole space"


def test_a_light_that_is_far_around_the_sphere_lights_from_behind():
    text = (
        "geometry: s3\nobjects: [{ball: {radius: 0.3}}]\ncamera: {at: [-1, 0, 0]}\n"
        "lights: [{point: {at: [1.2, 0, 0], geodesics: %d}}]\n"
    )
    one, both = (picture(text % count).channels["beauty"][48, 80].sum() for count in (1, 2))
    # The light stands behind the ball: the shortest geodesic meets its far side, the long way round its near
    # side.
    assert both > 1.5 * one


def test_camera_inside_an_object_is_an_error_at_its_line():
    text = "geometry: h3\ncamera: {at: [0.1, 0, 0]}\nobjects: [{ball: {radius: 0.3}}]\n"
    with pytest.raises(SceneError, match="camera is inside an object"):
        picture(text)


@pytest.mark.parametrize(
    ("solid", "along"),
    [
        ("ball: {radius: 0.3}", (0.5, 0.5, 0.5)),
        ("ball: {radius: 0.3}", (0.5, 0.5, 0)),
        ("cylinder: {radius: 0.1}", (0.5, 0.5, 0)),
    ],
)
def test_objects_on_corners_and_edges_look_like_objects_in_the_middle(solid, along):
    """The same lattice of objects, seen from the same side, with the cell moved by half."""
    text = (
        "geometry: e3\nmanifold: three-torus\nobjects:\n  - {%s, at: [%g, %g, %g]}\n"
        "camera: {at: [%g, %g, %g], look: {along: [1, 0.4, 0.2]}}\nrender: {far: 8}\n"
    )
    eye = np.array([-0.31, 0.27, 0.38])
    moved = picture(text % (solid, *along, *(eye + along)), precision="double", channels=["depth", "cell"])
    still = picture(text % (solid, 0, 0, 0, *eye), precision="double", channels=["depth", "cell"])
    with np.errstate(invalid="ignore"):
        off = np.abs(moved.channels["depth"] - still.channels["depth"]) > 1e-2
    assert np.count_nonzero(off) <= 0.002 * off.size
    # Each object has one cell number, whichever cell it is seen from.
    pairs = np.unique(
        np.stack([moved.channels["cell"], still.channels["cell"]])[:, still.channels["cell"] > 0], axis=1
    )
    assert pairs.shape[1] <= 1.02 * np.unique(still.channels["cell"]).size


def test_an_object_outside_the_cell_is_led_into_it():
    text = "geometry: e3\nmanifold: three-torus\nobjects: [{ball: {radius: 0.2}, at: [%s, 0.05, 0]}]\n"
    inside, outside = picture(text % "0.4"), picture(text % "2.4")
    np.testing.assert_allclose(inside.channels["depth"], outside.channels["depth"], atol=1e-4)


def test_a_tile_stands_beside_what_crosses_a_wall():
    text = (
        "geometry: h3\nmanifold: seifert-weber\nobjects: [{tile: {ball: 1.3}}, {cylinder: {radius: 0.05}}]\n"
    )
    objects = picture(text).channels["object"]
    assert 0 < np.count_nonzero(objects == 2) < np.count_nonzero(objects == 1)


@pytest.mark.parametrize(
    "text",
    [
        "geometry: h3\ncamera: {at: [1000, 0, 0]}\nobjects: [{ball: {radius: 0.3}}]\n",
        "geometry: h3\nobjects: [{ball: {radius: 0.3}, at: [800, 0, 0]}]\n",
        "geometry: h3\nobjects: [{ball: {radius: 0.3}}]\nlights: [{point: {at: [800, 0, 0]}}]\n",
        "geometry: sol\nobjects: [{ball: {radius: 0.3}, at: [0, 0, -28]}]\n",
        "geometry: sol\nobjects: [{ball: {radius: 0.3}, at: {model: [0, 0, 28, 1]}}]\n",
        "geometry: sol\ncamera: {at: {model: [1e13, 0, 0, 1]}}\nobjects: [{ball: {radius: 0.3}}]\n",
    ],
)
def test_what_is_too_far_away_is_an_error_at_its_line(text):
    with pytest.raises(SceneError, match="too far away"):
        picture(text)


def test_objects_at_the_antipode_are_not_mirrored():
    text = (
        "geometry: s3\ncamera: {at: [0.4, 0.3, 2.4], look: {to: [0, 0, 3.1]}}\nobjects:\n  - union:\n"
        "      - {ball: {radius: 0.2}, at: [0.3, 0, 0]}\n      - {ball: {radius: 0.1}, at: [0.3, 0.3, 0]}\n"
        "      - {ball: {radius: 0.15}, at: [0, 0.3, 0.3]}\n    at: %s\n"
    )
    exact, near = picture(text % "{model: [0, 0, 0, -1]}"), picture(text % "[3.14159265358979, 0, 0]")
    off = exact.channels["object"] != near.channels["object"]
    assert np.count_nonzero(off) <= 0.002 * off.size and exact.channels["object"].any()


def test_no_ray_leaves_a_finite_hollow_for_the_background():
    image = picture(CORRIDOR + "background: [9, 0, 0]\nrender: {steps: 100}\n", size=(256, 256))
    assert np.all(image.channels["object"] == 1)


def test_camera_that_looks_at_its_own_place_is_an_error_at_its_line():
    text = "geometry: h3\ncamera: {at: [0, 0, 3], look: {to: [0, 0, 3]}}\nobjects: [{ball: {radius: 0.3}}]\n"
    with pytest.raises(SceneError, match="camera stands at the point it looks at"):
        picture(text)


def test_a_picture_of_nothing_is_remarked_on():
    text = "geometry: s3\nmanifold: poincare\nobjects: [{tile: {ball: 0.6}}]\n"
    with pytest.warns(UserWarning, match="no ray hit anything"):
        picture(text)


def test_nothing_behind_a_light_shades_this_side_of_it():
    text = (
        "geometry: e3\ncamera: {at: [0, -2, 1.5], look: {to: [0, 0, 0]}}\n"
        "objects:\n  - half-space: {}\n  - ball: {radius: 0.4}\n    at: [0, 0, 3]\n"
        "lights:\n  - point: {at: [0, 0, 1], intensity: 2}\n%s"
    )
    bare, shaded = picture(text % ""), picture(text % "    shadows: hard\n")
    np.testing.assert_array_equal(bare.channels["beauty"], shaded.channels["beauty"])


def test_tile_vertices_that_are_no_points_are_an_error():
    with pytest.raises(SceneError, match="vertices of ideal-cube are ideal"):
        picture("geometry: h3\nmanifold: ideal-cube\nobjects: [{tile: {ball: 1, vertices: 0.1}}]\n")


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"crop": (0, 0, 161, 10)}, "not inside the picture"),
        ({"crop": (5, 0, 5, 10)}, "not inside the picture"),
        ({"channels": ["beauty", "albedo"]}, "unknown channel 'albedo'"),
        ({"finish": "never"}, "unknown finish 'never'"),
        ({"precision": "half"}, "unknown precision 'half'"),
        ({"lanes": 7}, "7 lanes"),
        ({"samples": 0}, "0 samples"),
        ({"samples": 2.5}, "2.5 samples"),
        ({"size": (0, 5)}, "size"),
    ],
)
def test_arguments_that_make_no_sense_are_named(settings, words):
    with pytest.raises(ValueError, match=words):
        picture(CORRIDOR, **settings)


def test_metadata_makes_the_same_picture_again():
    image = picture(BALLS)
    settings = json.loads(image.metadata["settings"])
    again = tc.render(
        load_text(image.metadata["scene"]),
        size=tuple(settings["size"]),
        samples=settings["samples"],
        crop=tuple(settings["crop"]),
        precision=settings["precision"],
        lanes=settings["lanes"],
    )
    np.testing.assert_array_equal(again.channels["beauty"], image.channels["beauty"])


def test_progress_is_told_and_can_end_the_rendering():
    seen = []

    def stop(done: int, total: int) -> None:
        seen.append((done, total))
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        picture(CORRIDOR, size=(512, 512), samples=2, progress=stop)
    assert seen == [(1, 8), (2, 8)]
