"""Kernel-reflection sequences in pictures of e3: the same depth, shade and materials as their instances drawn
one by one; twists and empty zones against what they are defined as; every tracer against sphere tracing; and
mistakes from the command line.
"""

import json
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from camera_rays import view
from click.testing import CliRunner
from golden import EPSILON, Array, constant

import thurston_cl as tc
from thurston_cl.arrays import ArrayProgram
from thurston_cl.cli.main import main
from thurston_cl.device import Device
from thurston_cl.errors import SceneError
from thurston_cl.image import Image
from thurston_cl.krs import Model
from thurston_cl.krs.kernels import KERNEL_SIZE, KINDS
from thurston_cl.krs.record import plane_mirror, sequence_of
from thurston_cl.krs.sequence import MOST_LEVELS
from thurston_cl.program import LANE_WIDTHS, Source
from thurston_cl.scene import load_text
from thurston_cl.scene.placement import CameraFrame, Placement
from thurston_cl.scene.plan import make_plan

SIZE = (72, 48)
THRESHOLD = 1e-4
both_precisions = pytest.mark.parametrize("precision", EPSILON)

# Center and radius of balls and the mirrors between them, the innermost first.
BALLS: Sequence[tuple[Sequence[float], float]] = [
    ([-1.2, -0.8, -0.2], 0.25),
    ([-0.6, -1.3, 0.5], 0.2),
    ([0.2, -0.9, 0.6], 0.3),
    ([0.9, 0.9, 0.4], 0.35),
]
MIRRORS: Sequence[tuple[Sequence[float], float]] = [
    ([1, 0.1, 0], -0.7),
    ([-0.2, 1, 0.3], -0.2),
    ([0.3, 0, 1], 1.0),
]
CAMERA = {"at": [3.2, -2.8, 1.4], "look": {"to": [-0.2, -0.3, 0.6]}, "fov": "36 deg"}


def unit(v: Sequence[float]) -> Array:
    return np.asarray(v, dtype=np.float64) / np.linalg.norm(v)


def instances() -> list[tuple[Array, float, int]]:
    """Center, radius and number of the kernel of each ball: L_0 = K_0, L_{i+1} = K_{i+1} u L_i u R L_i."""
    found = [(np.array(BALLS[0][0]), BALLS[0][1], 0)]
    for level, ((normal, offset), (center, radius)) in enumerate(
        zip(MIRRORS, BALLS[1:], strict=True), start=1
    ):
        u = unit(normal)
        # Otherwise it is clipped, and no union of balls.
        assert all(u @ c + r < offset for c, r, _ in found)
        found += [(c - 2 * (u @ c - offset) * u, r, k) for c, r, k in found]
        found.append((np.array(center), radius, level))
    return found


RECORD = {
    "mirrors": [{"u": unit(u).tolist(), "w": w} for u, w in MIRRORS],
    "kernels": [{"type": "sphere", "c": list(c), "r": r, "mat": k} for k, (c, r) in enumerate(BALLS)],
}
LEVELS = {
    "kernel": {"ball": {"radius": BALLS[0][1], "at": BALLS[0][0]}},
    "levels": [
        {"mirror": {"normal": list(u), "offset": w}, "kernel": {"ball": {"radius": r, "at": c}}}
        for (u, w), (c, r) in zip(MIRRORS, BALLS[1:], strict=True)
    ],
}


def scene_of(*objects: Mapping[str, Any], **more: Any) -> str:
    render = {"threshold": THRESHOLD} | more.pop("render", {})
    camera = CAMERA | more.pop("camera", {})
    return json.dumps({"geometry": "e3", "camera": camera, "objects": objects, "render": render, **more})


def picture(scene: str, size: tuple[int, int] = SIZE, lanes: int | None = 4, **settings: Any) -> Image:
    return tc.render(load_text(scene), size=size, samples=1, lanes=lanes, **settings)


def balls_by_themselves(**more: Any) -> list[dict[str, Any]]:
    return [{"ball": {"radius": r}, "at": c.tolist(), **more} for c, r, _ in instances()]


def rays_of(scene: str) -> tuple[Array, Array]:
    """The eye and the directions (H,W,3) of the middles of pixels."""
    camera = load_text(scene).camera
    frame = CameraFrame(camera, Placement(tc.Geometry("e3", "double")))
    return frame.point[:3], view(frame, SIZE, camera.fov).reshape(SIZE[1], SIZE[0], -1)[..., :3]


def first_ball(eye: Array, u: Array, balls: Sequence[tuple[Array, float]]) -> tuple[Array, Array]:
    """Depth and number, from 0, of the ball that each ray meets first; inf and 0 where none is."""
    depths = []
    for center, radius in balls:
        d = center - eye
        along = u @ d
        room = along**2 - d @ d + radius**2
        depths.append(np.where((room > 0) & (along > 0), along - np.sqrt(np.maximum(room, 0)), np.inf))
    stacked = np.stack(depths)
    return stacked.min(axis=0), stacked.argmin(axis=0)


def same_pictures(got: Image, want: Image, few: int = 3, grazing: float = 0.95) -> None:
    """The same surface but for a few pixels that graze one; depths to the threshold."""
    hit = want.channels["object"] > 0
    other = (got.channels["object"] > 0) != hit
    assert 0.05 < hit.mean() < 0.98
    assert other.sum() <= few
    both = hit & (got.channels["object"] > 0)
    off = np.abs(got.channels["depth"][both].astype(np.float64) - want.channels["depth"][both])
    assert np.quantile(off, grazing) < 5 * THRESHOLD
    assert np.mean(off > 0.05) < 0.003


# Records and levels, against the roots of rays


@both_precisions
def test_a_record_is_seen_as_its_instances_at_every_width(precision: str, opencl_device: Device) -> None:
    if precision == "double" and not opencl_device.info.fp64:
        pytest.skip("no double precision")
    scene = scene_of({"krs": {"record": RECORD}})
    eye, u = rays_of(scene)
    assert len(instances()) == 15
    depth, _ = first_ball(eye, u, [(c, r) for c, r, _ in instances()])
    want = picture(scene, lanes=1, precision=precision)
    got = want.channels["depth"].astype(np.float64)
    hit = want.channels["object"] > 0
    assert 0.1 < hit.mean() < 0.9
    assert (hit != np.isfinite(depth)).sum() <= 3
    both = hit & np.isfinite(depth)
    # Rays end before the surface, and within the threshold of one.
    assert np.all(got[both] <= depth[both] + 4e-6)
    assert np.all(depth_in_balls(eye + got[hit][:, None] * u[hit]) < THRESHOLD + 4e-6)
    for lanes in LANE_WIDTHS[1:] if precision == "single" else (8,):
        other = picture(scene, lanes=lanes, precision=precision)
        for name in ("depth", "object", "normal"):
            np.testing.assert_array_equal(
                other.channels[name], want.channels[name], err_msg=f"{lanes} {name}"
            )


def test_levels_are_the_record_and_ordinary_balls_the_same() -> None:
    record = picture(scene_of({"krs": {"record": RECORD}}))
    levels = picture(scene_of({"krs": LEVELS}))
    same_pictures(levels, record, few=0, grazing=1.0)
    np.testing.assert_allclose(levels.channels["normal"], record.channels["normal"], atol=1e-5)
    union = picture(scene_of({"union": balls_by_themselves()}))
    same_pictures(record, union)


def test_a_sequence_is_moved_and_turned_with_its_object() -> None:
    turn = {"axis": [0, 0, 1], "angle": "40 deg"}
    moved = picture(scene_of({"krs": LEVELS, "at": [0.2, 0.3, -0.1], "rotate": turn}))
    union = picture(scene_of({"union": balls_by_themselves(), "at": [0.2, 0.3, -0.1], "rotate": turn}))
    same_pictures(moved, union)


# Shades


SHADES = {
    "soft shadows": {
        "lights": [
            {"point": {"at": [2, -1, 3], "falloff": "constant"}, "shadows": {"soft": {"sharpness": 6}}},
        ]
    },
    "hard shadows": {"lights": [{"sun": {"from": [1, -0.5, 2]}, "shadows": "hard"}]},
    "ambient occlusion": {
        "lights": [{"sun": {"from": [1, -0.5, 2]}}],
        "effects": {"ambient-occlusion": {"reach": 0.8, "strength": 0.9}},
    },
}


@pytest.mark.parametrize("shade", SHADES)
def test_shades_are_those_of_ordinary_balls(shade: str) -> None:
    """The distance is the same, so the shade is: but where rays graze a ball, which ends some of them.
    Both are traced alike: towards the horizon tracers end at different depths.
    """
    ground = {"half-space": {"offset": -0.5}, "material": {"color": "white", "specular": 0}}
    plain = {"material": {"color": "tan", "specular": 0}}
    settings: dict[str, Any] = {**SHADES[shade], "render": {"tracer": "direct"}}
    got = picture(scene_of({"krs": LEVELS, **plain}, ground, **settings))
    want = picture(scene_of({"union": balls_by_themselves(), **plain}, ground, **settings))
    bare = {
        key: [{name: light[name] for name in light if name != "shadows"} for light in value]
        for key, value in SHADES[shade].items()
        if key == "lights"
    }
    unshaded = picture(scene_of({"krs": LEVELS, **plain}, ground, render=settings["render"], **bare))
    same_pictures(got, want)
    beauty = [image.channels["beauty"] for image in (got, want, unshaded)]
    assert np.mean(np.abs(beauty[0] - beauty[2]).max(axis=2) > 0.03) > 0.05
    assert np.mean(np.abs(beauty[0] - beauty[1]).max(axis=2) > 0.02) < 0.005


# Materials by part

PAINTS = ([1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0])


def glow(color: Any) -> dict[str, Any]:
    """What is as bright as it is painted, whatever the light."""
    return {"color": color, "ambient": 1, "diffuse": 0, "specular": 0}


def seen_color(scene: str, balls: Sequence[tuple[Array, float, Sequence[float]]]) -> tuple[Array, Array]:
    """What the picture shows, and the paint of the ball that each ray meets first, where both meet one."""
    image = picture(scene)
    eye, u = rays_of(scene)
    depth, number = first_ball(eye, u, [(c, r) for c, r, _ in balls])
    found = np.isfinite(depth) & (image.channels["object"] > 0)
    assert found.mean() > 0.1
    want = np.array([paint for _, _, paint in balls])[number][found]
    return image.channels["beauty"][found], want


def test_parts_have_their_materials() -> None:
    painted = [(c, r, PAINTS[k]) for c, r, k in instances()]
    by_record = {"record": RECORD, "made-of": [glow(paint) for paint in PAINTS]}
    got, want = seen_color(scene_of({"krs": by_record}), painted)
    assert len({tuple(color) for color in want}) == 4
    assert np.mean(np.abs(got - want).max(axis=1) > 1e-5) < 0.005

    # By levels; what has no material is the object's own.
    levels = json.loads(json.dumps(LEVELS))
    levels["kernel"]["material"] = glow(PAINTS[0])
    levels["levels"][1]["kernel"]["material"] = glow(PAINTS[2])
    own = [1.0, 1.0, 1.0]
    painted = [(c, r, PAINTS[k] if k in (0, 2) else own) for c, r, k in instances()]
    got, want = seen_color(scene_of({"krs": levels, "material": glow(own)}), painted)
    assert np.mean(np.abs(got - want).max(axis=1) > 1e-5) < 0.005


def test_parts_of_two_sequences_in_one_object() -> None:
    """Each keeps its materials, and what has none is the object's, in a union and beside an ordinary ball."""
    one, other = (
        {"record": RECORD, "made-of": [glow(p) for p in paints]} for paints in (PAINTS, PAINTS[::-1])
    )
    ball = {"ball": {"radius": 0.5}, "at": [1.5, -0.9, 0.2]}
    shift = np.array([0.3, 0.5, -0.9])
    scene = scene_of(
        {"union": [{"krs": one}, ball, {"krs": other, "at": shift.tolist()}], "material": glow([1, 1, 1])}
    )
    painted: list[tuple[Array, float, Sequence[float]]] = [(np.array(ball["at"]), 0.5, [1.0, 1.0, 1.0])]
    painted += [(c, r, PAINTS[k]) for c, r, k in instances()]
    painted += [(c + shift, r, PAINTS[3 - k]) for c, r, k in instances()]
    got, want = seen_color(scene, painted)
    assert len({tuple(color) for color in want}) == 5
    assert np.mean(np.abs(got - want).max(axis=1) > 1e-5) < 0.01


def test_patterns_of_parts_lie_in_the_coordinates_of_the_kernel() -> None:
    """Longitude and latitude about the center of the ball before it is mirrored; so they are mirrored too."""
    made_of = [glow({"checker": {"count": [8, 4], "colors": ["white", "black"]}})] + [glow("red")] * 3
    scene = scene_of({"krs": {"record": RECORD, "made-of": made_of}})
    image = picture(scene)
    eye, u = rays_of(scene)
    places = Model.from_dict(RECORD, precision="double").expand()
    centers = [place[:3, :3] @ np.array(BALLS[k][0]) + place[:3, 3] for k, place in places]
    depth, number = first_ball(eye, u, [(c, BALLS[k][1]) for c, (k, _) in zip(centers, places, strict=True)])
    checked = 0
    for row, column in zip(*np.nonzero(np.isfinite(depth) & (image.channels["object"] > 0)), strict=True):
        k, place = places[number[row, column]]
        if k != 0:
            continue
        p = eye + depth[row, column] * u[row, column]
        d = place[:3, :3].T @ (p - place[:3, 3]) - np.array(BALLS[0][0])
        longitude = np.arctan2(d[1], d[0]) / (2 * np.pi) % 1
        latitude = np.arcsin(np.clip(d[2] / np.linalg.norm(d), -1, 1)) / np.pi + 0.5
        cells = np.array([8 * longitude, 4 * latitude])
        if np.any(np.abs(cells - np.round(cells)) < 0.05):
            continue
        bright = image.channels["beauty"][row, column, 0] > 0.5
        odd = bool((np.floor(cells).sum() % 2) == 1)
        checked += 1
        assert bright != odd, (row, column, cells)
    assert checked > 40


def test_an_image_on_one_part_is_that_of_a_ball_by_itself() -> None:
    """The last kernel is not mirrored; the footprint of a pixel and all else are the same."""
    earth = glow({"image": "earth"})
    made_of = [*[glow("red")] * 3, earth]
    got = picture(scene_of({"krs": {"record": RECORD, "made-of": made_of}}))
    red = {"union": balls_by_themselves()[:-1], "material": glow("red")}
    globe = {"ball": {"radius": BALLS[3][1]}, "at": BALLS[3][0], "material": earth}
    want = picture(scene_of(globe, red))
    on_globe = want.channels["object"] == 1
    assert on_globe.sum() > 100
    difference = np.abs(got.channels["beauty"] - want.channels["beauty"]).max(axis=2)
    assert np.mean(difference[on_globe] > 0.02) < 0.02
    assert np.ptp(want.channels["beauty"][on_globe]) > 0.2
    # Others are not painted with it.
    rest = (want.channels["object"] == 2) & (difference < 1)
    np.testing.assert_allclose(got.channels["beauty"][rest], want.channels["beauty"][rest], atol=1e-6)
    assert rest.sum() >= (want.channels["object"] == 2).sum() - 2


def test_an_image_is_mirrored_with_its_part() -> None:
    """On an image of the kernel it shows what the kernel itself shows at the point that is folded there."""
    earth = {"image": "earth"}
    krs = {
        "record": {
            "mirrors": [{"u": [0, 1, 0], "w": 0}],
            "kernels": [{"type": "sphere", "c": [0, -0.7, 0], "r": 0.6}, {"type": "empty"}],
        }
    }
    camera = {"at": [3, 0, 0], "look": {"to": [0, 0, 0]}, "fov": "45 deg"}
    image = picture(scene_of({"krs": krs, "material": glow(earth)}, camera=camera)).channels["beauty"]
    left, right = image[:, : SIZE[0] // 2], image[:, SIZE[0] // 2 :][:, ::-1]
    assert np.ptp(left) > 0.2
    assert np.mean(np.abs(left - right).max(axis=2) > 0.03) < 0.02
    # It is no repetition: not mirrored they differ.
    assert np.mean(np.abs(left - right[:, ::-1]).max(axis=2) > 0.03) > 0.1


def test_noise_on_a_part_stands_in_the_frame_of_the_object() -> None:
    """No two images of a kernel wear the same clouds: those of all balls in one union."""
    clouds = glow({"noise": {"size": 0.2, "colors": ["black", "white"]}})
    levels = json.loads(json.dumps(LEVELS))
    levels["kernel"]["material"] = clouds
    scene = scene_of({"krs": levels, "at": [0.1, 0.2, 0], "material": glow("red")})
    got = picture(scene).channels["beauty"]
    union = {"union": balls_by_themselves(), "at": [0.1, 0.2, 0], "material": clouds}
    want = picture(scene_of(union)).channels["beauty"]
    eye, u = rays_of(scene)
    depth, number = first_ball(eye - np.array([0.1, 0.2, 0]), u, [(c, r) for c, r, _ in instances()])
    clouded = np.isfinite(depth) & (np.array([k for _, _, k in instances()])[number] == 0)
    assert clouded.sum() > 60
    assert np.ptp(want[clouded]) > 0.3
    assert np.mean(np.abs(got - want)[clouded].max(axis=1) > 0.02) < 0.03
    rest = np.isfinite(depth) & ~clouded
    assert np.mean(np.abs(got[rest] - [1, 0, 0]).max(axis=1) > 1e-5) < 0.02


# Smooth widths


def test_what_a_mirror_takes_away_is_told_of() -> None:
    """A ball whose center lies beyond its mirror loses its larger part; one that only touches it loses
    nothing, for where it reaches beyond its image does too.
    """
    level = {"mirror": {"normal": [1, 0, 0], "offset": 0.2}}
    for x, told in ((0.1, []), (0.3, ["sequence 1: kernel 0 (by 0.35) reaches beyond the mirror"])):
        krs = {"kernel": {"ball": {"radius": 0.25, "at": [x, 0, 0]}}, "levels": [level]}
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            make_plan(load_text(scene_of({"krs": krs})))
        assert [str(warning.message)[: len(want)] for warning, want in zip(caught, told, strict=True)] == told


def test_smooth_widths_hide_the_crease_and_keep_the_shape() -> None:
    """Two balls that meet on a mirror: normals turn at once, or within the width."""

    def scene(width: float) -> str:
        krs = {
            "kernel": {"ball": {"radius": 0.6, "at": [0, -0.4, 0]}},
            "levels": [{"mirror": {"normal": [0, 1, 0], "smooth": width}}],
        }
        return scene_of({"krs": krs}, camera={"at": [3, 0, 0], "look": {"to": [0, 0, 0]}, "fov": "30 deg"})

    sharp, smooth = picture(scene(0)), picture(scene(0.1))
    np.testing.assert_array_equal(sharp.channels["depth"], smooth.channels["depth"])
    eye, u = rays_of(scene(0))
    y = (eye + sharp.channels["depth"][..., None] * u)[..., 1]
    hit = sharp.channels["object"] > 0
    turned = np.arccos(np.clip((sharp.channels["normal"] * smooth.channels["normal"]).sum(axis=-1), -1, 1))
    assert np.all(turned[hit & (np.abs(y) > 0.1 + 1e-3)] < 1e-3)
    inside = hit & (np.abs(y) < 0.05)
    assert inside.any() and np.all(turned[inside] > 0.05)
    # On the mirror itself no side is preferred: the normal lies in the mirror.
    middle = hit & (np.abs(y) < 0.02)
    assert np.all(np.abs(smooth.channels["normal"][middle][:, 1]) < 0.2)
    assert np.all(np.abs(sharp.channels["normal"][middle][:, 1]) > 0.5)


# Twists

ASK = """
// point 0-3, vector 4-7 -> distance along it 0, gradient 1-4, part 5
__kernel void ask(ARRAYS, __constant const scalar *numbers)
{
  scene_data scene = {numbers, 0, 0, 0, 0};
  point p = get_4(0, in, stride);
  surface s = object_1_surface(p, scene);
  put(object_1_distance(p, get_4(4, in, stride), scene), 0, out, stride);
  put_4(s.gradient, 1, out, stride);
  put(s.part, 5, out, stride);
}
"""


def asked(
    scene: str, device: Device, points: Array, along: Array | None = None, precision: str = "double"
) -> Array:
    """Distance, gradient and part of the first object at points (N,3)."""
    plan = make_plan(load_text(scene), device=device)
    before = plan.parts[: plan.parts.index("scene objects")]
    parts = (*before, "arrays.h", "light/phong.h", "scene objects", "ask")
    generated = {"scene objects": plan.source.generated["scene objects"], "ask": ASK}
    program = ArrayProgram(Source(parts, plan.source.defines, generated), precision, device, 1)
    ones, zeros = np.ones((len(points), 1)), np.zeros((len(points), 1))
    v = np.tile([1.0, 0, 0], (len(points), 1)) if along is None else along
    return program.run("ask", [points, ones, v, zeros], 6, numbers=plan.numbers)


def twisted_scene(degrees: float, **more: Any) -> str:
    return scene_of({"krs": LEVELS | {"twist": {"angle": f"{degrees} deg"}}, **more})


def unwound(points: Array, degrees: float) -> Array:
    """T(x): turned about the z-axis by the angle times z."""
    angle = np.radians(degrees) * points[:, 2]
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = points.T
    return np.stack([c * x - s * y, s * x + c * y, z], axis=1)


def depth_in_balls(points: Array) -> Array:
    return np.min([np.linalg.norm(points - c, axis=1) - r for c, r, _ in instances()], axis=0)


@pytest.mark.parametrize("degrees", [35.0, -60.0])
def test_a_twist_bounds_the_distance_to_what_is_drawn(degrees: float, opencl_device: Device) -> None:
    """What is drawn is {x: T(x) in the model}: its surface are the balls wound back, densely sampled."""
    rng = np.random.default_rng(7)
    d = rng.normal(size=(30000, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    picked = rng.integers(len(instances()), size=len(d))
    centers, radii = np.array([c for c, _, _ in instances()]), np.array([r for _, r, _ in instances()])
    surface = unwound(centers[picked] + radii[picked][:, None] * d, -degrees)
    near, far = rng.uniform(-2.5, 2.5, (1500, 3)), rng.uniform(-20, 20, (300, 3))
    points = np.concatenate([near, surface[:500] + 0.05 * d[:500], far])
    got = asked(twisted_scene(degrees), opencl_device, points)[:, 0]
    outside = depth_in_balls(unwound(points, degrees)) > 0
    true = np.min(np.linalg.norm(points[outside][:, None] - surface[None, ::6], axis=2), axis=1)
    assert outside.mean() > 0.7
    assert np.all(got[outside] <= true + 1e-12)
    # Neither is it useless, far out as near the axis.
    share = got[outside] / true
    assert np.median(share[: outside[:1500].sum()]) > 0.5
    assert share[-outside[-300:].sum() :].min() > 0.4
    np.testing.assert_array_equal(got > 0, outside)
    # And zero on the surface, where that is not within another ball.
    on = np.abs(depth_in_balls(unwound(surface[:300], degrees))) < 1e-9
    assert np.all(np.abs(asked(twisted_scene(degrees), opencl_device, surface[:300])[on, 0]) < 1e-9)


@pytest.mark.parametrize("degrees", [35.0, -60.0])
def test_the_gradient_of_a_twist(degrees: float, opencl_device: Device) -> None:
    """Central differences of the untwisted distance at T(x), which is what is differentiated."""
    points = np.random.default_rng(8).uniform(-2, 2, (200, 3))
    got = asked(twisted_scene(degrees), opencl_device, points)[:, 1:4]
    step = 1e-6
    for axis in range(3):
        e = step * np.eye(3)[axis]
        sides = [depth_in_balls(unwound(points + sign * e, degrees)) for sign in (1, -1)]
        # Gradients of balls are as long as their radius vectors: compare directions.
        difference = (sides[0] - sides[1]) / (2 * step)
        if axis == 0:
            want = np.zeros((len(points), 3))
        want[:, axis] = difference
    size = np.linalg.norm(got, axis=1) / np.linalg.norm(want, axis=1)
    off = np.abs(got / size[:, None] - want).max(axis=1)
    # Where two balls are as near the difference is none.
    assert np.mean(off > 1e-5) < 0.02


@pytest.mark.parametrize("degrees", [35.0, -60.0])
def test_a_twist_is_drawn_where_it_is(degrees: float) -> None:
    scene = twisted_scene(degrees)
    image = picture(scene, precision="double")
    eye, u = rays_of(scene)
    hit = image.channels["object"] > 0
    assert 0.1 < hit.mean() < 0.9
    p = eye + image.channels["depth"][hit].astype(np.float64)[:, None] * u[hit]
    # The bound is shorter than the distance in the model by up to L, at 1.69 from the axis 2.2 for 60 deg.
    rate = np.radians(abs(degrees)) * 1.7
    longest = (rate + np.sqrt(rate**2 + 4)) / 2
    clear = depth_in_balls(unwound(p, degrees))
    assert np.all(clear > 0)
    # A ray that grazes may be out of steps before.
    assert image.statistics["out_of_steps"] <= 2
    assert (clear > longest * THRESHOLD + 1e-6).sum() <= image.statistics["out_of_steps"]
    # Nothing is passed by: along each ray the model is not met before.
    t = np.linspace(0, 1, 800)[1:-1]
    some = np.flatnonzero(hit.ravel())[::7]
    ends = image.channels["depth"].ravel()[some].astype(np.float64)
    way = eye + (t[None] * ends[:, None])[..., None] * u.reshape(-1, 3)[some][:, None]
    assert depth_in_balls(unwound(way.reshape(-1, 3), degrees)).min() > 0
    # In what passes by there is nothing either.
    rest = np.flatnonzero(~hit.ravel())[::9]
    way = eye + (8 * t)[None, :, None] * u.reshape(-1, 3)[rest][:, None]
    assert depth_in_balls(unwound(way.reshape(-1, 3), degrees)).min() > -THRESHOLD


# Empty zones

ZONES = [{"radius": 0.9, "at": [0.3, -0.6, 0.7]}, {"radius": 0.4, "at": [0.9, 0.6, 0.4]}]


def test_zones_are_a_difference_with_balls() -> None:
    cut = picture(scene_of({"krs": LEVELS | {"empty-zones": ZONES}}))
    removed = [{"ball": {"radius": zone["radius"]}, "at": zone["at"]} for zone in ZONES]
    want = picture(scene_of({"difference": [{"krs": LEVELS}, *removed]}))
    same_pictures(cut, want)
    both = (cut.channels["object"] > 0) & (want.channels["object"] > 0)
    turned = (cut.channels["normal"] * want.channels["normal"]).sum(axis=-1)[both]
    assert np.mean(turned < 0.999) < 0.01
    whole = picture(scene_of({"krs": LEVELS}))
    with np.errstate(invalid="ignore"):
        assert np.mean(np.abs(whole.channels["depth"] - cut.channels["depth"]) > 0.01) > 0.05


def test_nothing_is_drawn_within_a_zone_and_cuts_face_its_center() -> None:
    scene = scene_of({"krs": LEVELS | {"empty-zones": ZONES}})
    image = picture(scene, precision="double")
    eye, u = rays_of(scene)
    hit = image.channels["object"] > 0
    p = eye + image.channels["depth"][hit].astype(np.float64)[:, None] * u[hit]
    normals = image.channels["normal"][hit]
    on_cut = np.zeros(len(p), bool)
    for zone in ZONES:
        center, radius = np.array(zone["at"]), zone["radius"]
        from_center = np.linalg.norm(p - center, axis=1)
        assert np.all(from_center > radius - 2 * THRESHOLD)
        here = (np.abs(from_center - radius) < 2e-5) & (depth_in_balls(p) < -0.01)
        inwards = (center - p[here]) / from_center[here][:, None]
        np.testing.assert_allclose((normals[here] * inwards).sum(axis=1), 1, atol=1e-4)
        on_cut |= here
    assert on_cut.sum() > 10


@pytest.mark.parametrize("tracer", ["direct", "binary"])
def test_a_camera_within_a_zone_sees_from_there(tracer: str) -> None:
    zone = {"radius": 0.9, "at": [0.3, -0.6, 0.7]}
    camera = {"at": [0.1, -0.7, 0.6], "look": {"to": [-1, -1, 0]}, "fov": "100 deg"}
    scene = scene_of({"krs": LEVELS | {"empty-zones": zone}}, camera=camera, render={"tracer": tracer})
    image = picture(scene)
    removed = {"ball": {"radius": zone["radius"]}, "at": zone["at"]}
    want = picture(scene_of({"difference": [{"krs": LEVELS}, removed]}, camera=camera))
    same_pictures(image, want, few=8)


def test_rays_go_straight_to_the_end_of_a_zone(opencl_device: Device) -> None:
    """From inside the distance along a ray is the way out, and a little more; outside that to the model."""
    zone = {"radius": 0.9, "at": [0.3, -0.6, 0.7]}
    scene = scene_of({"krs": LEVELS | {"empty-zones": zone}})
    rng = np.random.default_rng(4)
    points, along = rng.uniform(-2, 2, (2000, 3)), rng.normal(size=(2000, 3))
    along /= np.linalg.norm(along, axis=1)[:, None]
    got = asked(scene, opencl_device, points, along)[:, 0]
    d, depth = points - np.array(zone["at"]), depth_in_balls(points)
    inside = np.linalg.norm(d, axis=1) < zone["radius"]
    b = (d * along).sum(axis=1)
    way = np.sqrt(np.maximum(b**2 + zone["radius"] ** 2 - (d**2).sum(axis=1), 0)) - b
    want = np.where(
        inside, np.maximum(way, depth), np.maximum(depth, zone["radius"] - np.linalg.norm(d, axis=1))
    )
    assert 0.02 < inside.mean() < 0.5
    slack = constant("krs/empty_zones.h", "ZONE_SLACK") * EPSILON["double"]
    assert np.all(got >= want - 1e-14)
    assert np.all(got <= want + 8 * slack)
    # Just beyond the end the ray is outside, with the slack and not without it.
    end = points + (way + slack * (1 + np.abs(points).max(axis=1)))[:, None] * along
    assert np.all(np.linalg.norm(end - np.array(zone["at"]), axis=1)[inside] > zone["radius"] - 1e-15)


@both_precisions
def test_zone_slack_leads_out_of_the_zone(precision: str, opencl_device: Device) -> None:
    """ZONE_SLACK: the end of the way out counts as outside. Without it rounding leaves some points inside,
    and it is far below the threshold of a hit."""
    zone = {"radius": 0.9, "at": [0.3, -0.6, 0.7]}
    scene = scene_of({"krs": LEVELS | {"empty-zones": zone}})
    slack = constant("krs/empty_zones.h", "ZONE_SLACK") * EPSILON[precision]
    rng = np.random.default_rng(5)
    kind = np.float32 if precision == "single" else np.float64
    along = rng.normal(size=(4000, 3))
    along /= np.linalg.norm(along, axis=1)[:, None]
    start = (np.array(zone["at"]) + rng.uniform(-0.45, 0.45, (4000, 3))).astype(kind)
    along = along.astype(kind)
    way = asked(scene, opencl_device, start.astype(np.float64), along.astype(np.float64), precision)[
        :, 0
    ].astype(kind)

    def inside(lengths: Array) -> Array:
        at = start + lengths[:, None].astype(kind) * along
        d = at - np.array(zone["at"], kind)
        return (d * d).sum(axis=1) < kind(zone["radius"]) ** 2

    assert not inside(way).any()
    # A slack of none would leave many inside.
    bare = way - (slack * (1 + np.abs(start).max(axis=1))).astype(kind)
    assert inside(bare).mean() > 0.2
    assert slack < 0.1 * THRESHOLD


def test_what_a_sequence_with_zones_is_cut_out_of() -> None:
    """Its zones stay: rays within the block do not pass over them."""
    block = {"ball": {"radius": 1.2, "at": None}, "at": [0, -0.9, 0.5]}
    del block["ball"]["at"]
    zone = {"radius": 0.25, "at": [0.2, -0.9, 0.6]}
    # From within the largest ball, through it, the zone in its middle is solid.
    camera = {"at": [0.2, -1.17, 0.6], "look": {"to": [0.2, -0.9, 0.6]}, "fov": "70 deg"}
    scene = scene_of({"difference": [block, {"krs": LEVELS | {"empty-zones": zone}}]}, camera=camera)
    image = picture(scene, precision="double")
    eye, u = rays_of(scene)
    depth, _ = first_ball(eye, u, [(np.array(zone["at"]), zone["radius"])])
    hit = np.isfinite(depth)
    assert hit.mean() > 0.3
    np.testing.assert_allclose(image.channels["depth"][hit], depth[hit], atol=1e-3)


@pytest.mark.parametrize("start", ["pixel", "block"])
def test_blocks_of_pixels_start_before_what_zones_leave(start: str) -> None:
    """The way out of a zone holds along one ray alone, and blocks go by what is clear all around: seen from
    within a hollow, along its wall."""
    krs = {
        "kernel": {"ball": {"radius": 2}},
        "levels": [{"mirror": {"normal": [0, 0, 1], "offset": 3}}],
        "empty-zones": {"radius": 1},
    }
    camera = {"at": [0, -0.95, 0], "look": {"along": [1, 0, 0]}, "fov": "60 deg"}
    scene = scene_of({"krs": krs}, camera=camera, render={"start": start})
    image = picture(scene)
    eye, u = rays_of(scene)
    way = np.sqrt((u @ eye) ** 2 + 1 - eye @ eye) - u @ eye
    np.testing.assert_allclose(image.channels["depth"], way, atol=1e-4)


# Tracers

MOEBIUS = {
    "kernel": {"ball": {"radius": 0.25, "at": [-0.5, 0, 0]}},
    "moebius": [
        {
            "map": [
                {"bend": [0.3, 0, 0.4]},
                {"turn": {"axis": [0, 1, 0], "angle": "25 deg"}},
                {"move": [-0.5, 0, 0.5]},
            ],
            "kernel": {"ball": {"radius": 0.15, "at": [-0.3, 0.4, 0]}},
        },
        {
            "map": [
                {"scale": 0.8},
                {"turn": {"axis": [0, 0, 1], "angle": "40 deg"}},
                {"move": [-0.8, 0, 0.1]},
            ],
            "kernel": {"ball": {"radius": 0.2, "at": [-0.4, -0.6, 0.3]}},
        },
        {"map": [{"bend": [0, 0.2, 0]}, {"move": [0, 0, 0.2]}]},
    ],
}


@pytest.mark.filterwarnings("ignore:sequence 1")
def test_moebius_sequences_are_the_same_by_every_tracer() -> None:
    wall = {"half-space": {"normal": [0, 0, 1], "offset": -0.8}}
    images = {
        tracer: picture(scene_of({"krs": MOEBIUS}, wall, render={"tracer": tracer}))
        for tracer in ("direct", "relaxed", "binary", "compound")
    }
    want = images.pop("direct")
    assert (want.channels["object"] == 1).mean() > 0.05
    for tracer, image in images.items():
        other = image.channels["object"] != want.channels["object"]
        assert other.sum() <= 6, tracer
        seen = ~other & (want.channels["object"] > 0)
        off = np.abs(image.channels["depth"][seen] - want.channels["depth"][seen])
        # A free ball behind the last one that is not is twice as far across: see BINARY_ACCURACY.
        assert np.quantile(off, 0.9) < (6 if tracer == "binary" else 3) * THRESHOLD, tracer
        assert image.statistics["nan"] == 0


def test_detail_is_so_many_pixels_of_a_sequence() -> None:
    detail = 0.7
    scene = scene_of({"krs": LEVELS}, render={"detail": detail, "threshold": 1e-6})
    image = picture(scene)
    eye, u = rays_of(scene)
    hit = image.channels["object"] > 0
    depth = image.channels["depth"][hit].astype(np.float64)
    clear = depth_in_balls(eye + depth[:, None] * u[hit])
    allowed = detail * 2 * np.tan(np.radians(18)) / SIZE[1] * depth
    assert np.all(clear < allowed + 1e-5)
    assert np.quantile(clear / allowed, 0.9) > 0.3
    assert image.statistics["steps"] < picture(scene_of({"krs": LEVELS})).statistics["steps"]


# Balls that hold components

# What rays do with the ball that holds the second object: a camera and where that object is.
NEAR_BALLS = {
    "missed": ({"at": [3.2, -2.8, 1.4], "look": {"to": [-0.3, -0.2, 0.8]}, "fov": "60 deg"}, [4.0, 0, 0]),
    "started inside": ({"at": [-0.4, -0.4, 0.3], "look": {"to": [-1, -1, 0]}, "fov": "100 deg"}, [0.0, 0, 0]),
    "behind": ({"at": [3.2, -2.8, 1.4], "look": {"to": [6, -5, 1.5]}, "fov": "60 deg"}, [8.0, -6, 0]),
}


@pytest.mark.parametrize("finish", ["packet", "refill"])
@pytest.mark.parametrize("case", NEAR_BALLS)
def test_compound_by_the_balls_that_hold_components(case: str, finish: str) -> None:
    camera, at = NEAR_BALLS[case]
    objects = [{"krs": LEVELS}, {"krs": LEVELS, "at": at}, {"ball": {"radius": 0.4}, "at": [0.6, 0.2, 2.0]}]
    want = picture(scene_of(*objects, camera=camera, render={"tracer": "direct"}), finish=finish)
    got = picture(scene_of(*objects, camera=camera, render={"tracer": "compound"}), finish=finish)
    assert (want.channels["object"] > 0).mean() > 0.02
    other = got.channels["object"] != want.channels["object"]
    # Two components in one place are met both.
    if case != "started inside":
        assert other.sum() <= 3
    both = (got.channels["object"] > 0) & (want.channels["object"] > 0)
    assert ((got.channels["object"] > 0) != (want.channels["object"] > 0)).sum() <= 3
    off = np.abs(got.channels["depth"][both] - want.channels["depth"][both])
    assert np.quantile(off, 0.95) < 3 * THRESHOLD
    assert np.mean(off > 0.05) < 0.004


@both_precisions
@pytest.mark.parametrize("lanes", [1, 16])
def test_compound_meets_a_component_at_the_edge_of_its_ball(
    lanes: int, precision: str, opencl_device: Device
) -> None:
    """The ball of a ball is itself: each hit lies on it, and within the threshold before it."""
    if precision == "double" and not opencl_device.info.fp64:
        pytest.skip("no double precision")
    one = {
        "kernel": {"ball": {"radius": 0.5, "at": [-0.6, 0, 0]}},
        "levels": [{"mirror": {"normal": [1, 0, 0]}}],
    }
    single = {"record": {"mirrors": [], "kernels": [{"type": "sphere", "c": [0, 0, 0], "r": 0.5}]}}
    objects = [
        {"krs": single, "at": [0, 0, 1.2]},
        {"krs": one},
        {"ball": {"radius": 0.6}, "at": [0, -1.2, 0]},
    ]
    settings = {"lanes": lanes, "precision": precision}
    want = picture(scene_of(*objects, render={"tracer": "direct"}), **settings)
    got = picture(scene_of(*objects, render={"tracer": "compound"}), **settings)
    assert set(np.unique(want.channels["object"])) == {0, 1, 2, 3}
    assert (got.channels["object"] != want.channels["object"]).sum() <= 2
    both = (got.channels["object"] > 0) & (want.channels["object"] > 0)
    eye, u = rays_of(scene_of(*objects))
    balls = [([0, 0, 1.2], 0.5), ([-0.6, 0, 0], 0.5), ([0.6, 0, 0], 0.5), ([0, -1.2, 0], 0.6)]
    depth, _ = first_ball(eye, u, [(np.array(c), r) for c, r in balls])
    found = got.channels["depth"][both].astype(np.float64)
    assert np.all(found <= depth[both] + 4e-6)
    p = eye + found[:, None] * u[both]
    clear = np.min([np.linalg.norm(p - np.array(c), axis=1) - r for c, r in balls], axis=0)
    assert np.all(clear < THRESHOLD + 4e-6)


def test_compound_leaves_lamps_out_of_their_own_light() -> None:
    lamp = {"point": {"at": [1.2, -1.6, 1.9], "ball": 0.15, "falloff": "constant"}, "shadows": "hard"}
    objects = [{"krs": LEVELS}, {"half-space": {"offset": -0.5}, "material": {"color": "white"}}]
    pictures = [
        picture(scene_of(*objects, lights=[light], camera={"fov": "60 deg"}, render={"tracer": tracer}))
        for tracer, light in (
            ("direct", lamp),
            ("compound", lamp),
            ("direct", {"point": lamp["point"]}),
        )
    ]
    want, got, bare = (image.channels["beauty"] for image in pictures)
    assert (pictures[1].channels["object"] == 3).sum() > 5
    # The ground far from shadows is lit as without any: the lamp does not shade itself.
    assert np.mean(np.abs(bare - want).max(axis=2) > 0.05) > 0.02
    assert np.mean(np.abs(bare - got).max(axis=2) < 1e-4) > 0.4
    assert np.mean(np.abs(got - want).max(axis=2) > 0.02) < 0.006


# In a manifold


def test_a_sequence_in_the_three_torus_is_repeated() -> None:
    """As the union of its balls is, over walls as well."""
    small = {
        "kernel": {"ball": {"radius": 0.06, "at": [-0.3, 0.1, 0.1]}},
        "levels": [
            {"mirror": {"normal": [1, 0.2, 0]}, "kernel": {"ball": {"radius": 0.1, "at": [0.1, -0.2, 0.45]}}}
        ],
    }
    u = unit([1, 0.2, 0])
    first = np.array([-0.3, 0.1, 0.1])
    balls = [(first, 0.06), (first - 2 * (u @ first) * u, 0.06), (np.array([0.1, -0.2, 0.45]), 0.1)]
    union = {"union": [{"ball": {"radius": r}, "at": c.tolist()} for c, r in balls]}
    camera = {"at": [-0.1, -0.35, -0.2], "look": {"along": [0.4, 1, 0.3]}, "fov": "80 deg"}
    more: dict[str, Any] = {"manifold": "three-torus", "camera": camera, "render": {"far": 3.0}}
    got, want = (picture(scene_of(solid, **more)) for solid in ({"krs": small}, union))
    same_pictures(got, want, few=6)
    eye, rays = rays_of(scene_of({"krs": small}, camera=camera))
    shifts = np.stack(np.meshgrid(*3 * [np.arange(-4, 5)], indexing="ij"), axis=-1).reshape(-1, 3)
    everywhere = [(c + shift, r) for shift in shifts for c, r in balls]
    depth, _ = first_ball(eye, rays, everywhere)
    hit = (got.channels["object"] > 0) & (depth < 2.9)
    assert hit.mean() > 0.1
    assert np.mean(np.abs(got.channels["depth"][hit] - depth[hit]) > 5e-3) < 0.01


REFUSED = {
    "a plane": (
        {"krs": {"kernel": {"half-space": {}}, "levels": [{"mirror": {"normal": [1, 0, 0]}}]}},
        ("krs",),
    ),
    "terrain in a union": (
        {"union": [{"ball": {"radius": 0.1}}, {"krs": {"terrain": {"size": 1, "levels": 6}}}]},
        ("union", 1, "krs"),
    ),
}


@pytest.mark.filterwarnings("ignore:sequence 1")
@pytest.mark.parametrize("case", REFUSED)
def test_a_sequence_without_bound_has_no_place_in_a_manifold(case: str) -> None:
    solid, _ = REFUSED[case]
    scene = json.dumps({"geometry": "e3", "manifold": "three-torus", "objects": [solid]})
    with pytest.raises(SceneError, match="a sequence without bound") as caught:
        make_plan(load_text(scene))
    (found,) = caught.value.diagnostics  # type: ignore[attr-defined]
    assert found.help.startswith("cut a bounded piece out of it with an intersection")
    assert scene[found.column - 1 :].startswith(json.dumps(solid).split('"krs": ')[1][:20])
    # And the cure works.
    make_plan(
        load_text(
            scene.replace(
                json.dumps(solid),
                json.dumps(
                    {
                        "intersection": [
                            {"ball": {"radius": 0.3}},
                            {"krs": {"terrain": {"size": 1, "levels": 6}}},
                        ]
                    }
                ),
            )
        )
    )


def test_a_rock_is_held_by_a_ball_though_its_kernel_is_not() -> None:
    """Its recipe knows how far it reaches, so that it has images in a manifold, and may be twisted."""
    rock = {"rock": {"radius": 0.15, "levels": 8}}
    scene = {"geometry": "e3", "manifold": "three-torus", "objects": [{"krs": rock, "at": [0.45, 0, 0]}]}
    assert make_plan(load_text(json.dumps(scene))).object_images == 1
    twisted = {"geometry": "e3", "objects": [{"krs": {**rock, "twist": {"angle": "10 deg"}}}]}
    (own,) = make_plan(load_text(json.dumps(twisted))).sequences
    assert own.sequence.radius == pytest.approx(1.8 * 0.15)


def test_too_many_kernels_to_look_at_have_no_place_in_a_manifold() -> None:
    level = {"mirror": {"normal": [0, 0, 1], "offset": 0.5}}
    krs = {"kernel": {"ball": {"radius": 0.1}}, "levels": 15 * [level]}
    scene = json.dumps({"geometry": "h3", "manifold": "seifert-weber", "objects": [{"krs": krs}]})
    with pytest.raises(SceneError, match="these 32768 kernels are too many to find how far they reach"):
        make_plan(load_text(scene))


@pytest.mark.parametrize(
    ("krs", "column", "keys"),
    [
        ("{tree: {levels: 6}}", 17, "'trunk', 'thickness' and 'leaf-size'"),
        ("{fish-school: {length: 5}}", 24, "'length'"),
    ],
)
def test_a_recipe_too_large_for_a_cell_says_what_makes_it_smaller(krs: str, column: int, keys: str) -> None:
    text = f"geometry: e3\nmanifold: three-torus\nobjects:\n  - krs: {krs}\n"
    with pytest.raises(SceneError, match="too many images of this reach over the walls") as caught:
        make_plan(load_text(text))
    (found,) = caught.value.diagnostics  # type: ignore[attr-defined]
    assert (found.line, found.column) == (4, column)
    assert found.help == f"take a smaller {keys}, or a larger cell"


# What the host and the kernels say to each other


def test_numbers_are_laid_out_as_the_kernels_read_them() -> None:
    """Kinds, places and sizes of records are written down on both sides."""
    by_file = {
        "sphere": "KRS_SPHERE",
        "plane": "KRS_PLANE",
        "capsule": "KRS_CAPSULE",
        "toroidal_capsule": "KRS_TOROIDAL_CAPSULE",
        "lens_leaf": "KRS_LENS_LEAF",
    }
    kinds = {file: number for file, number in KINDS.values() if file}
    assert kinds == {file: constant(f"krs/{file}.h", name) for file, name in by_file.items()}
    head, part, size = (constant("krs/kernels.h", f"KERNEL_{name}") for name in ("HEAD", "PART", "SIZE"))
    assert {"KERNEL_HEAD": head, "KERNEL_PART": part, "KERNEL_SIZE": size} == {
        "KERNEL_HEAD": 2,
        "KERNEL_PART": 1,
        "KERNEL_SIZE": KERNEL_SIZE,
    }
    assert constant("krs/kernels.h", "MOST_LEVELS") == MOST_LEVELS
    kernel = sequence_of(RECORD).kernels[2]
    assert kernel.numbers[int(part)] == 2
    assert tuple(kernel.numbers[int(head) : int(head) + len(kernel.own)]) == kernel.own
    assert len(kernel.numbers) == size

    width = int(constant("krs/mirror.h", "MIRROR_WIDTH"))
    mirror = plane_mirror(np.array([1.0, 0, 0]), 0.5, 0.25).numbers("e3")
    assert (mirror[width], len(mirror)) == (0.25, width + 1)
    assert len(sequence_of(RECORD).numbers) == 1 + size + 3 * (width + 1 + size)

    matrix = tc.krs.moebius.identity().matrix.tolist()
    bent = sequence_of({"G": 3 * [matrix], "kernels": RECORD["kernels"]}).numbers
    map_size, moebius_head = (
        constant("krs/moebius_map.h", "MOEBIUS_SIZE"),
        constant("krs/moebius_sequence.h", "MOEBIUS_HEAD"),
    )
    assert len(tc.krs.moebius.identity().numbers) == map_size
    # A width and a ball with each level.
    assert len(bent) == moebius_head + 3 * (map_size + 1 + 4 + size) + size


# From the command line

# What is only seen when a program is made: keys of the sequence, message, cure, and what stands at the caret.
LATE = {
    "a pole within": (
        "kernel: {ball: {radius: 1, at: [-1, 0, 0]}}, "
        "moebius: [{map: [{move: [1, 0, 0]}]}, {map: [{bend: [1, 0, 0]}]}]",
        "the pole of a map lies within what it maps",
        "bend less",
        "[{bend: [1, 0, 0]}]",
    ),
    "a pole within a record": (
        "record: {G: [[[[1, 0, 0, 0], [0, 0, 0, 0]], [[0, -1, 0, 0], [1, 0, 0, 0]]]], "
        "kernels: [{type: sphere, c: [-1, 0, 0], r: 1}, {type: empty}]}",
        "the pole of a map lies within what it maps",
        "bend less",
        "{G: ",
    ),
    "a map that is nearly none": (
        "kernel: {ball: {radius: 1}}, moebius: [{map: [{scale: 1e-300}]}]",
        "this Moebius map is not invertible",
        "write numbers that are neither so large nor so small",
        "[{scale: 1e-300}]",
    ),
}


@pytest.mark.parametrize("verb", ["explain", "render"])
@pytest.mark.parametrize("case", LATE)
def test_late_mistakes_are_told_at_their_keys(case: str, verb: str, tmp_path: Path) -> None:
    keys, message, help, at = LATE[case]
    line = f"  - union: [{{ball: {{radius: 1}}}}, {{krs: {{{keys}}}}}]"
    path = tmp_path / "scene.yaml"
    path.write_text(f"geometry: e3\nobjects:\n{line}\n")
    output = ["-o", str(tmp_path / "x.png")] if verb == "render" else []
    result = CliRunner().invoke(main, [verb, str(path), *output], prog_name="thurston")
    assert result.exit_code == 65, result.output
    assert "Traceback" not in result.output
    assert f"{path}:3:{line.rindex(at) + 1}: error: {message}" in result.stderr
    assert f"= help: {help}" in result.stderr
    assert result.stderr.endswith(f"1 error in {path}\n")
    assert not (tmp_path / "x.png").exists()


@pytest.mark.parametrize(
    ("geometry", "keys", "message", "at"),
    [
        (
            "h3",
            "kernel: {ball: {radius: 1, at: [0, 0, 40]}}, LEVEL",
            "this point is too far away",
            "{radius: 1, at",
        ),
        (
            "h3",
            "kernel: {ball: {radius: 1}}, levels: [{mirror: {normal: [1, 0, 0], offset: 40}}]",
            "this point is too far away",
            "{normal: [1, 0, 0], offset",
        ),
        (
            "h2xe",
            "kernel: {capsule: {from: {model: [0, 0, 1, 0]}, to: {model: [0, 0.75, 1.25, 1]}, radius: 0.1}}, "
            "LEVEL",
            "in h2xe a capsule of a sequence is vertical",
            "{from: {model",
        ),
    ],
)
def test_places_that_cannot_be(geometry: str, keys: str, message: str, at: str) -> None:
    keys = keys.replace("LEVEL", "levels: [{mirror: {normal: [1, 0, 0]}}]")
    line = f"  - krs: {{{keys}}}"
    with pytest.raises(SceneError, match=message) as caught:
        make_plan(load_text(f"geometry: {geometry}\nobjects:\n{line}\n"))
    (found,) = caught.value.diagnostics  # type: ignore[attr-defined]
    assert (found.line, found.column) == (3, line.index(at) + 1)
    assert found.help == "place it nearer to the origin"


def test_a_recipe_that_finds_nothing_is_told_at_its_key(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(**_: Any) -> dict[str, Any]:
        raise ValueError("no closed rock of roughness 2 found; take less roughness or another seed")

    monkeypatch.setattr("thurston_cl.scene.krs_grounds.rock", none)
    with pytest.raises(SceneError) as caught:
        make_plan(load_text("geometry: e3\nobjects:\n  - krs: {rock: {roughness: 2}}\n"))
    (found,) = caught.value.diagnostics  # type: ignore[attr-defined]
    assert (found.line, found.column) == (3, 17)
    assert found.message == "no closed rock of roughness 2 found"
    assert found.help == "take less roughness or another seed"


def test_normals_that_are_not_unit_vectors_are_told_of() -> None:
    record = {
        "mirrors": [{"u": [2, 0, 0], "w": 1}],
        "kernels": [{"type": "sphere", "c": [0, 0, 0], "r": 0.4}, {"type": "empty"}],
    }
    with pytest.warns(UserWarning) as caught:
        make_plan(load_text(scene_of({"ball": {"radius": 1}}, {"krs": {"record": record}})))
    assert [str(warning.message) for warning in caught] == [
        "sequence 1: the normals of mirrors 0 are not of length 1; u and w were divided by their length",
    ]


# From Python


def test_the_names_of_the_module() -> None:
    """Each has a docstring; each recipe gives a record of plain numbers that a model takes."""
    recipes = set(tc.krs.__all__) - {"Map", "Model", "moebius", "moebius_of"}
    assert len(recipes) == 13
    for name in tc.krs.__all__:
        assert getattr(tc.krs, name).__doc__, name
        assert name in dir(tc.krs)
    for name in recipes:
        json.dumps(getattr(tc.krs, name)())
    assert tc.krs.seabed() == tc.krs.recipes.terrain.seabed() != tc.krs.terrain()
    small = tc.krs.tree(levels=4, leaves=0, seed=3)
    assert set(small) >= {"mirrors", "kernels"}
    bent = tc.krs.moebius_of(small, strength=0.1, seed=1)
    assert isinstance(tc.krs.Map(np.array(bent["G"][0])), tc.krs.moebius.Map)
    with pytest.raises(AttributeError, match="no attribute 'oak'"):
        _ = tc.krs.oak
