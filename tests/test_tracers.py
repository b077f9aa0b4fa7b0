"""Ways to march: each ends where sphere tracing does, within the threshold, in every geometry it is made for,
in packets and refilled, at every width and in both precisions; none starts or ends behind a surface; a NaN
ends it.

Truth in e3 are the roots of the ray's polynomial; elsewhere sphere tracing, which test_render.py checks.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from golden import Array, constant
from small_kernels import Body, SmallKernels

from thurston_cl import program
from thurston_cl.device import Device
from thurston_cl.errors import SceneError
from thurston_cl.image import Image
from thurston_cl.models import GEOMETRIES, ISOTROPIC, PRODUCTS
from thurston_cl.program import LANE_WIDTHS, geometry_parts
from thurston_cl.rendering import Tile, TileRenderer, render
from thurston_cl.scene import load_text
from thurston_cl.scene.plan import make_plan
from thurston_cl.scene.shapes import Solid
from thurston_cl.scene.tracer import MOST_COMPONENTS
from thurston_cl.scene.writer import Writer

SIZE = (96, 64)
THRESHOLD = 1e-4
TRACERS = ("relaxed", "compound", "binary")
WAYS = [(tracer, start) for tracer in ("direct", *TRACERS) for start in ("pixel", "block")]
# Centers and radii of balls in front of a wall and over each other.
BALLS = [
    ((1.0, 0.5, 0.1), 0.4),
    ((1.6, -0.6, 0.2), 0.45),
    ((0.8, -0.2, -0.5), 0.25),
    ((2.2, 0.3, -0.6), 0.5),
    ((1.2, -0.1, 0.6), 0.2),
]
WALL = 3.0
OWN_TEXT = program.kernel_text


def text(
    render: str, *, geometry: str = "e3", balls: Any = tuple(BALLS), light: str = "", far: float | None = None
) -> str:
    # Elsewhere nearer: the sphere is small, and in hyperbolic space what is far is small.
    size = 1.0 if geometry == "e3" else 0.4
    objects = "".join(
        f"  - {{ball: {{radius: {size * radius}}}, at: [{size * x}, {size * y}, {size * z}]}}\n"
        for (x, y, z), radius in balls
    )
    # A vertical half-space; in sol a wall of the coordinate x.
    wall = f"  - half-space: {{normal: [-1, 0, 0], offset: {-size * WALL}}}\n"
    end = "" if far is None else f", far: {far}"
    eye = f"[{-size * 1.2}, {size * 0.1}, {size * 0.05}]"
    return (
        f"geometry: {geometry}\ncamera: {{at: {eye}, look: {{along: [1, 0, 0]}}}}\n"
        f"objects:\n{objects}{wall}{light}render: {{threshold: {THRESHOLD}, {render}{end}}}\n"
    )


def picture(render_text: str, finish: str = "packet", samples: int = 1, **options: Any) -> Image:
    chosen = {key: options.pop(key) for key in ("lanes", "precision") if key in options}
    scene = load_text(text(render_text, **options))
    return render(scene, size=SIZE, samples=samples, finish=finish, **chosen)


def rays(shift: tuple[float, float] = (0.5, 0.5)) -> tuple[Array, Array]:
    """The eye, and the directions (H,W,3) of the rays through one place in each pixel."""
    x, y = np.meshgrid(np.arange(SIZE[0]) + shift[0], np.arange(SIZE[1]) + shift[1])
    scale = 2 * np.tan(np.radians(40)) / SIZE[1]
    u = np.stack([np.ones_like(x), (SIZE[0] / 2 - x) * scale, (SIZE[1] / 2 - y) * scale], axis=-1)
    return np.array([-1.2, 0.1, 0.05]), u / np.linalg.norm(u, axis=-1, keepdims=True)


def first_surface(eye: Array, u: Array) -> tuple[Array, Array]:
    """Depth and number of the object that each ray meets first."""
    depths = []
    for center, radius in BALLS:
        d = np.asarray(center) - eye
        along = u @ d
        room = along**2 - d @ d + radius**2
        depths.append(np.where(room > 0, along - np.sqrt(np.maximum(room, 0)), np.inf))
    with np.errstate(divide="ignore"):
        depths.append(np.where(u[..., 0] > 0, (WALL - eye[0]) / u[..., 0], np.inf))
    stacked = np.stack(depths)
    return stacked.min(axis=0), stacked.argmin(axis=0) + 1


def distance_to_scene(points: Array) -> Array:
    balls = [np.linalg.norm(points - np.asarray(center), axis=-1) - radius for center, radius in BALLS]
    return np.minimum.reduce([*balls, WALL - points[..., 0]])


def way(tracer: str, start: str = "pixel") -> str:
    return f"tracer: {tracer}, start: {start}"


# -- in e3, against the roots of polynomials -----------------------------------------------------------------


@pytest.mark.parametrize("finish", ["packet", "refill"])
@pytest.mark.parametrize(("tracer", "start"), WAYS)
def test_rays_end_just_before_the_first_surface(tracer: str, start: str, finish: str) -> None:
    image = picture(way(tracer, start), finish)
    eye, u = rays()
    depth, number = first_surface(eye, u)
    got = image.channels["depth"].astype(np.float64)
    assert image.statistics["nan"] == 0
    other = image.channels["object"] != number
    # What passes by an edge within the threshold is met there.
    assert other.sum() <= 0.002 * other.size
    rounding = 4e-6
    assert np.all(got <= depth + rounding)
    # A free ball behind the last one that is not is twice as far across: see BINARY_ACCURACY.
    near = 2.1 * THRESHOLD if tracer == "binary" else THRESHOLD
    assert np.all(distance_to_scene(eye + got[..., None] * u) < near + rounding)


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize(
    ("tracer", "start"), [way for way in WAYS if way[1] == "pixel" or way[0] == "compound"]
)
def test_every_width_and_both_ends_of_packets_agree(
    tracer: str, start: str, precision: str, opencl_device: Device
) -> None:
    if precision == "double" and not opencl_device.info.fp64:
        pytest.skip("no double precision")
    chosen: dict[str, Any] = {"precision": precision}
    want = picture(way(tracer, start), lanes=1, **chosen).channels
    for lanes in LANE_WIDTHS[1:] if precision == "single" else (16,):
        packet = picture(way(tracer, start), lanes=lanes, **chosen).channels
        refill = picture(way(tracer, start), "refill", lanes=lanes, **chosen).channels
        for name in ("depth", "object", "normal"):
            np.testing.assert_array_equal(packet[name], want[name], err_msg=f"{lanes} {name}")
        for name in ("depth", "object", "normal", "beauty"):
            np.testing.assert_array_equal(packet[name], refill[name], err_msg=f"{lanes} {name}")
        np.testing.assert_allclose(packet["beauty"], want["beauty"], atol=1e-6)


@pytest.mark.parametrize(("tracer", "start"), WAYS)
def test_few_steps_are_told_and_both_ends_of_packets_agree_on_them(tracer: str, start: str) -> None:
    with pytest.warns(UserWarning, match="ran out of steps"):
        packet = picture(way(tracer, start) + ", steps: 4")
    with pytest.warns(UserWarning, match="ran out of steps"):
        refill = picture(way(tracer, start) + ", steps: 4", "refill")
    assert packet.statistics["out_of_steps"] == refill.statistics["out_of_steps"] > 0
    for name in ("depth", "object", "beauty"):
        np.testing.assert_array_equal(packet.channels[name], refill.channels[name])
    # What is shown stands before the surface.
    eye, u = rays()
    assert np.all(packet.channels["depth"] <= first_surface(eye, u)[0] + 4e-6)


@pytest.mark.parametrize("tracer", ["direct", *TRACERS])
def test_distances_are_counted(tracer: str) -> None:
    """Each step asks once, and so does the end of a ray; a block asks for its pixels."""
    light = "lights: [{point: {at: [-1, 1, 1.5]}, shadows: hard}]\n"
    told = picture(way(tracer), light=light).statistics
    ends = told["rays"] + told["light_solves"] - told["hits"]
    work = told["steps"] + told["shadow_steps"]
    assert told["distance_evaluations"] == pytest.approx(work + ends, abs=told["out_of_steps"])
    by_blocks = picture(way(tracer, "block"), light=light).statistics
    assert by_blocks["distance_evaluations"] > by_blocks["steps"] + by_blocks["shadow_steps"] + ends
    assert by_blocks["steps"] < told["steps"]


def test_compound_asks_for_less() -> None:
    direct, compound = (picture(way(tracer)).statistics for tracer in ("direct", "compound"))
    # Of components: direct asks for all of them.
    assert compound["distance_evaluations"] < 0.7 * (len(BALLS) + 1) * direct["distance_evaluations"]


def test_relaxed_asks_less_along_a_plane() -> None:
    plane = "geometry: e3\ncamera: {at: [0, 0, 1]}\nobjects: [half-space: {normal: [0, 0, 1]}]\n"
    asked = [
        render(load_text(f"{plane}render: {{tracer: {tracer}}}\n"), size=SIZE, samples=1).statistics
        for tracer in ("direct", "relaxed")
    ]
    assert asked[1]["distance_evaluations"] < 0.85 * asked[0]["distance_evaluations"]


# -- shadows -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("tracer", TRACERS)
def test_hard_shadows_are_those_of_sphere_tracing(tracer: str) -> None:
    # The ball that shows the light does not shade it.
    light = "lights: [{point: {at: [-0.4, 0.8, 0.9], ball: 0.1, intensity: 3}, shadows: hard}]\n"
    want = picture(way("direct"), light=light).channels["beauty"]
    got = picture(way(tracer), light=light).channels["beauty"]
    unlit = picture(way("direct"), light=light.replace(", shadows: hard", "")).channels["beauty"]
    assert np.mean(np.abs(unlit - want).max(axis=2) > 0.05) > 0.02
    assert np.mean(np.abs(got - want).max(axis=2) > 0.02) < 0.004


@pytest.mark.parametrize("tracer", ["relaxed", "compound"])
def test_soft_shadows_are_those_of_short_steps(tracer: str) -> None:
    """The least quotient is looked for where a tracer asks, so that short steps show a little darker."""
    light = "lights: [{point: {at: [-0.4, 0.8, 0.9], intensity: 3}, shadows: {soft: {sharpness: 6}}}]\n"
    want = picture(way("direct"), light=light).channels["beauty"]
    hard = picture(way("direct"), light=light.replace("{soft: {sharpness: 6}}", "hard")).channels["beauty"]
    got = picture(way(tracer), light=light).channels["beauty"]
    difference = np.abs(got - want).max(axis=2)
    assert np.mean(np.abs(hard - want).max(axis=2)) > 4 * np.mean(difference)
    assert np.mean(difference > 0.05) < 0.02


# -- elsewhere, against sphere tracing -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("geometry", "tracer"),
    [(geometry, "relaxed") for geometry in GEOMETRIES]
    + [(geometry, "compound") for geometry in (*ISOTROPIC, *PRODUCTS)],
)
def test_other_geometries(geometry: str, tracer: str) -> None:
    light = "lights: [{point: {at: [-0.2, 0.3, 0.4]}, shadows: hard}]\n"
    want = picture(way("direct"), geometry=geometry, light=light)
    for finish in ("packet", "refill"):
        got = picture(way(tracer), finish, geometry=geometry, light=light)
        assert got.statistics["nan"] == want.statistics["nan"] == 0
        same = got.channels["object"] == want.channels["object"]
        assert np.mean(same) > 0.995
        hit = same & (want.channels["object"] > 0)
        assert np.mean(hit) > 0.1
        apart = np.abs(got.channels["depth"] - want.channels["depth"])[hit]
        # Both are within the threshold of the surface, which a ray meets at an angle.
        assert np.quantile(apart, 0.9) < 2.5 * THRESHOLD
        assert np.mean(np.abs(got.channels["beauty"] - want.channels["beauty"]).max(axis=2) > 0.03) < 0.01


# -- level of detail -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("tracer", ["direct", *TRACERS])
def test_detail_is_so_many_pixels(tracer: str) -> None:
    detail = 0.7
    image = picture(way(tracer) + f", detail: {detail}")
    eye, u = rays()
    got = image.channels["depth"].astype(np.float64)
    pixel = 2 * np.tan(np.radians(40)) / SIZE[1]
    clear = distance_to_scene(eye + got[..., None] * u)
    allowed = np.maximum(THRESHOLD, detail * pixel * got)
    assert np.all(clear < (2.1 if tracer == "binary" else 1.0) * allowed + 4e-6)
    assert np.quantile(clear / allowed, 0.9) > 0.3
    plain = picture(way(tracer))
    assert image.statistics["steps"] < 0.8 * plain.statistics["steps"]


@pytest.mark.parametrize("tracer", ["direct", "relaxed", "compound", "binary"])
def test_detail_leaves_no_speckle_far_away(tracer: str) -> None:
    """A plane to the horizon, lit from aside: nothing stands on it, so that nothing of it is in shadow."""
    plane = (
        "geometry: e3\ncamera: {at: [0, 0, 1]}\nobjects:\n  - half-space: {normal: [0, 0, 1]}\n"
        "  - half-space: {normal: [0, 0, 1], offset: -5}\n"
        "lights: [{sun: {from: [1, 2, 0.4]}, shadows: hard}]\n"
        f"render: {{tracer: {tracer}, detail: 0.7, far: 4000}}\n"
    )
    lit = render(load_text(plane), size=SIZE, samples=1)
    unshaded = render(load_text(plane.replace(", shadows: hard", "")), size=SIZE, samples=1)
    assert lit.channels["depth"][lit.channels["object"] > 0].max() > 40
    np.testing.assert_array_equal(lit.channels["beauty"], unshaded.channels["beauty"])


@pytest.mark.parametrize("tracer", ["direct", *TRACERS])
def test_shadows_go_on_with_the_detail_of_what_they_fall_on(tracer: str) -> None:
    """A light close behind a wall with a slit, seen from afar: through the slit, in which rays of the eye
    would end, comes no light.
    """
    scene = (
        "geometry: e3\ncamera: {at: [0, -60, 100], look: {to: [0, -1.5, 0]}, fov: 5 deg}\nobjects:\n"
        "  - half-space: {normal: [0, 0, 1]}\n    material: {ambient: 0, specular: 0}\n"
        "  - difference:\n      - {slab: {normal: [0, 1, 0], thickness: 0.1}, at: [0, 1, 0]}\n"
        "      - slab: {normal: [1, 0, 0], thickness: 0.36}\n"
        "    material: {ambient: 0, specular: 0}\n"
        "lights: [{point: {at: [0, 4, 2], falloff: constant}, shadows: hard}]\n"
        f"render: {{tracer: {tracer}, far: 300, detail: 4}}\n"
    )
    coarse, fine = (
        render(load_text(text), size=SIZE, samples=1) for text in (scene, scene.replace(", detail: 4", ""))
    )
    # A pixel sees 0.16: the threshold is 0.65, of binary 0.2, and after the way to the light alone 0.05.
    lit = (fine.channels["beauty"][..., 1] > 0.05) & (fine.channels["object"] == 1)
    assert 0.03 < lit.mean() < 0.3
    assert np.mean(coarse.channels["beauty"][lit][:, 1] > 0.05) < 0.02
    assert coarse.statistics["shadow_steps"] < fine.statistics["shadow_steps"]


def test_what_is_more_than_a_threshold_behind_a_light_throws_no_shadow() -> None:
    """Of binary tracing, whose balls end at the light: under a ceiling just above it."""
    threshold = 0.02
    scene = (
        "geometry: e3\ncamera: {at: [-3, 0, 0.8], look: {to: [0, 0, 0]}}\nobjects:\n"
        "  - half-space: {normal: [0, 0, 1]}\n"
        f"  - slab: {{normal: [0, 0, 1], thickness: 0.2}}\n    at: [0, 0, {1.1 + 1.1 * threshold}]\n"
        "lights: [{point: {at: [0, 0, 1], falloff: constant}, shadows: hard}]\n"
        f"render: {{tracer: binary, threshold: {threshold}}}\n"
    )
    lit, plain = (
        render(load_text(text), size=SIZE, samples=1)
        for text in (scene, scene.replace(", shadows: hard", ""))
    )
    floor = lit.channels["object"] == 1
    assert floor.mean() > 0.3
    np.testing.assert_array_equal(lit.channels["beauty"][floor], plain.channels["beauty"][floor])


def test_mirrors_go_on_with_the_detail_of_what_they_show() -> None:
    """A mirror to the horizon under a ball: what it shows is red or white, and nowhere the mirror itself."""
    scene = (
        "geometry: e3\nbackground: red\ncamera: {at: [0, 0, 1], look: {along: [1, 0, -0.3]}}\nobjects:\n"
        "  - half-space: {normal: [0, 0, 1]}\n    material: {color: black, reflectivity: 1, specular: 0}\n"
        "  - ball: {radius: 2}\n    at: [30, 0, 8]\n"
        "    material: {color: white, ambient: 1, diffuse: 0, specular: 0}\n"
        "lights: [sun: {from: [0, 0, 1]}]\neffects: {reflections: {depth: 1}}\nrender: {detail: 0.7}\n"
    )
    coarse = render(load_text(scene), size=SIZE, samples=1)
    fine = render(load_text(scene.replace("render: {detail: 0.7}\n", "")), size=SIZE, samples=1)
    assert coarse.statistics["reflection_steps"] < fine.statistics["reflection_steps"]
    assert coarse.channels["beauty"][..., 0].min() > 0.9
    assert 0.005 < np.mean(coarse.channels["beauty"][..., 1] > 0.5) < 0.05


# -- the constants -------------------------------------------------------------------------------------------


def with_constant(monkeypatch: pytest.MonkeyPatch, part: str, name: str, value: str) -> None:
    """Paste a file of kernels/ with another value of a constant of it."""

    def changed(file: str) -> str:
        found = OWN_TEXT(file)
        return re.sub(rf"(?m)^(#define {name}) .*$", rf"\1 {value}", found) if file == part else found

    monkeypatch.setattr(program, "kernel_text", changed)


def test_any_relaxation_ends_at_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 1 steps are those of sphere tracing; up to 2 they go back where they must."""
    direct, steps = picture(way("direct")), {}
    for factor in (1.0, constant("march/relaxed.h", "RELAXATION"), 1.9):
        with_constant(monkeypatch, "march/relaxed.h", "RELAXATION", f"C({factor})")
        image = picture(way("relaxed"))
        steps[factor] = image.statistics["steps"]
        if factor == 1:
            np.testing.assert_array_equal(image.channels["depth"], direct.channels["depth"])
        eye, u = rays()
        assert np.all(image.channels["depth"] <= first_surface(eye, u)[0] + 4e-6)
        assert np.mean(image.channels["object"] != direct.channels["object"]) < 0.002
    assert len(set(steps.values())) == 3


GROWTHS = [
    ("BINARY_BONUS", ("C(1.3)", "3")),
    ("BINARY_PENALTY", ("C(0.15)", "C(0.6)")),
    ("BINARY_FIRST", ("C(1e-5)", "C(0.5)")),
    ("BINARY_ACCURACY", ("C(0.1)", "C(0.3)")),
]


@pytest.mark.parametrize(("name", "values"), GROWTHS)
def test_any_growth_of_the_balls_ends_at_the_same(
    name: str, values: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    eye, u = rays()
    depth, number = first_surface(eye, u)
    for value in values:
        with_constant(monkeypatch, "march/binary.h", name, value)
        image = picture(way("binary"))
        got = image.channels["depth"].astype(np.float64)
        assert np.all(got <= depth + 4e-6)
        assert np.mean(image.channels["object"] != number) < 0.003
        penalty = 0.15 if value == "C(0.15)" else 0.3
        # The last ball that was not free is larger than the one that ends the ray by the penalty.
        ended = 0.1 if value == "C(0.1)" else 0.3
        near = distance_to_scene(eye + got[..., None] * u) < (2 * ended / penalty + 0.1) * THRESHOLD + 4e-6
        assert np.mean(near) > 0.998


BLOCK_CHANGES = [
    ("BLOCK_WORTH", None),
    ("BLOCK_WORTH", "0"),
    ("BLOCK_WORTH", "9"),
    ("BLOCK_ROUNDING", "1000"),
    ("BLOCK_END", "C(0.5)"),
    ("BLOCK_MIDDLE", None),
]


@pytest.mark.parametrize(("name", "value"), BLOCK_CHANGES)
def test_blocks_start_before_the_surface(
    name: str, value: str | None, monkeypatch: pytest.MonkeyPatch, opencl_device: Device
) -> None:
    """No pixel starts beyond the first surface, nor nearer to one than the threshold, at any place in it."""
    assert constant("block_start.cl", "BLOCK_MIDDLE") == 1.5
    if value is not None:
        with_constant(monkeypatch, "block_start.cl", name, value)
    plan = make_plan(load_text(text(way("direct", "block"), far=4.0)), device=opencl_device, size=SIZE)
    renderer = TileRenderer(plan, opencl_device, 16, "packet")
    launch, kept = renderer._launch, []

    def only_blocks(kernel: str, *arguments: Any, **options: Any) -> None:
        if kernel == "trace_blocks":
            launch(kernel, *arguments, **options)
            kept.append(renderer.records(tile)[0])

    monkeypatch.setattr(renderer, "_launch", only_blocks)
    tile = Tile(0, 0, *SIZE)
    for shift in ((0.5, 0.5), (0.02, 0.97), (1.4, -0.4)):
        renderer.trace(tile, np.array(shift), "packet")
        width, height = tile.padded
        t = kept[-1].reshape(height // 4, width // 4, 4, 4).transpose(0, 2, 1, 3).reshape(height, width)
        t = t[: SIZE[1], : SIZE[0]].astype(np.float64)
        eye, u = rays(shift)
        depth, _ = first_surface(eye, u)
        assert np.all(t < np.minimum(depth, 4.0))
        assert np.all(distance_to_scene(eye + t[..., None] * u) > THRESHOLD - 1e-6)
        blocks = t.reshape(SIZE[1] // 4, 4, SIZE[0] // 4, 4)
        assert np.all(blocks.max(axis=(1, 3)) == blocks.min(axis=(1, 3)))
        assert np.mean(t / np.minimum(depth, 4.0)) > (0.3 if value in ("9", "C(0.5)") else 0.7)


@pytest.mark.parametrize(("tracer", "start"), WAYS)
@pytest.mark.parametrize("other", ["ball: {radius: 0.1}", "half-space: {offset: -1}"])
def test_the_background_is_not_left_black_where_rays_see_nothing(tracer: str, start: str, other: str) -> None:
    """Rays beside the balls of all objects, and those that blocks leave just before the end, make no step."""
    scene = (
        "geometry: e3\ncamera: {at: [0, 0, 0]}\nbackground: white\n"
        f"objects: [{{ball: {{radius: 0.1}}, at: [2, 0, 0]}}, {{{other}, at: [3, 0, 0]}}]\n"
    )
    image = render(load_text(f"{scene}render: {{{way(tracer, start)}}}\n"), size=SIZE, samples=1)
    assert image.statistics["rays"] == SIZE[0] * SIZE[1]
    np.testing.assert_array_equal(image.channels["beauty"][0, 0], [1, 1, 1])


# -- numbers that are none -----------------------------------------------------------------------------------

_MARCH = """vector v = {IN(3), IN(4), IN(5), REAL(0)};
point p = {IN(0), IN(1), IN(2), REAL(1)};
scene_data scene = {numbers, 0, 0, 0, 0};
ray r = new_ray(p, v);
march(&r, REAL(10), 100, scene);
OUT(0, r.t); OUT(1, SELECT(r.hit, REAL(1), REAL(0)));
OUT(2, SELECT(r.active, REAL(1), REAL(0))); OUT(3, r.p.x);
"""
# A wall at x = 3; the second object is far away, and no number beyond y = 1.
_HEAD = """
FN real scene_component(int k, point p, vector v, scene_data scene)
{
  real none = REAL(0) * (p.x + p.y + p.z);
  return k == 0 ? REAL(3) - p.x + none : SELECT(p.y > REAL(1), REAL(NAN), REAL(20) + none);
}
FN real scene_distance(point p, vector v, scene_data scene)
{
  real a = scene_component(0, p, v, scene), b = scene_component(1, p, v, scene);
  return SELECT(b < a, b, SELECT(b == b, a, b));
}
FN stretch scene_stretch(int k, ray r, scene_data scene) { return everywhere(); }
FN mask scene_unbounding(point c, real radius, scene_data scene)
{
  return scene_distance(c, c, scene) >= radius;
}
"""


@pytest.mark.parametrize("lanes", [1, 16])
@pytest.mark.parametrize("tracer", ["direct", *TRACERS])
def test_a_nan_ends_a_lane_and_no_other(tracer: str, lanes: int, opencl_device: Device) -> None:
    parts = (*geometry_parts("e3"), "scene_types.h", "flow/exact.h", "march.h", "march/stretch.h")
    own = program.kernel_text("march/compound.h")
    assert "COMPONENTS" in own
    after = (f"march/{tracer}.h", "march/loop.h")
    head = "".join(f'#line 1 "{part}"\n{program.kernel_text(part)}\n' for part in after) + _HEAD
    kernels = SmallKernels(
        opencl_device,
        parts,
        {"march": Body(6, 4, _MARCH)},
        "single",
        lanes,
        "#define COMPONENTS 2\n" + head,
    )
    starts = [[0, 0, 0], [np.nan, 0, 0], [0, 2, 0], [0, np.nan, 0], [1, 0.5, 0], [0, 0, 0], [0, 0, 0]]
    along = [[1, 0, 0]] * 5 + [[np.nan, 0, 0], [0, -1, 0]]
    t, hit, active, x = kernels.run("march", np.column_stack([starts, along]).T, [1e-4, 10, 1e-3])
    np.testing.assert_array_equal(active, 0)
    for lane, length in ((0, 3.0), (4, 2.0)):
        assert hit[lane] == 1
        assert t[lane] == pytest.approx(length, abs=1e-3)
        assert x[lane] == pytest.approx(3, abs=1e-3)
    assert hit[6] == 0
    assert t[6] == pytest.approx(10, abs=1e-5)
    lost = [1, 3, 5]
    if tracer == "binary":
        # Whether a ball is free has no third answer: what is no distance is met.
        assert hit[2] == 1
    else:
        lost.append(2)
    assert np.isnan(t[lost]).all()
    np.testing.assert_array_equal(hit[lost], 0)


# -- where distances hold ------------------------------------------------------------------------------------

_BALL, _LEVEL = "ball: {radius: 0.2}", "half-space: {normal: [0, 0, 1], offset: -0.3}"
_SEQUENCE = "levels: [{mirror: {normal: [1, 0, 0]}, kernel: {ball: {radius: 0.1, at: [-0.2, 0, 0]}}}]"
SOLIDS = [
    _BALL,
    "cylinder: {radius: 0.2, along: [0, 0, 1]}",
    "cylinder: {radius: 0.2, along: [1, 0, 0]}",
    _LEVEL,
    "half-space: {normal: [1, 0, 0], offset: -0.3}",
    "half-space: {normal: [0, 0, 1], crossing: bisection}",
    "slab: {normal: [0, 0, 1], thickness: 0.2}",
    "slab: {normal: [1, 0, 0], thickness: 0.2}",
    "horoball: {towards: [0, 0, 1], distance: 0.5}",
    "pseudo-ball: {radius: 0.2}",
    "pseudo-cylinder: {radius: 0.2, along: [0, 0, 1]}",
    "pseudo-cylinder: {radius: 0.2, along: [1, 0, 0]}",
    f"krs: {{kernel: {{{_BALL}}}, {_SEQUENCE}}}",
    f"krs: {{kernel: {{{_BALL}}}, {_SEQUENCE}, empty-zones: [{{radius: 0.1, at: [0, 0, 0]}}]}}",
    f"union: [{{{_BALL}}}, {{intersection: [{{{_BALL}}}, {{{_LEVEL}}}]}}]",
    f"intersection: [{{{_BALL}}}, {{{_LEVEL}}}]",
    f"difference: [{{{_BALL}}}, {{{_LEVEL}}}]",
    f"complement: {{{_LEVEL}}}",
    f"complement: {{{_BALL}}}",
]


def test_the_tracer_knows_which_distances_the_writer_makes_along_the_ray(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of all shapes in all geometries: where `relaxed` is refused, and only there."""
    writers: list[Writer] = []

    def kept(*given: Any) -> Writer:
        writers.append(Writer(*given))
        return writers[-1]

    monkeypatch.setattr("thurston_cl.scene.plan.Writer", kept)
    told: dict[str, set[bool]] = {solid: set() for solid in SOLIDS}
    for geometry in GEOMETRIES:
        for solid in SOLIDS:
            scene = f"geometry: {geometry}\nobjects: [{{{solid}}}]\nrender: {{tracer: TRACER}}\n"
            try:
                make_plan(load_text(scene.replace("TRACER", "direct")))
            except SceneError:
                # There is no such shape there.
                continue
            try:
                load_text(scene.replace("TRACER", "relaxed"))
                refused = False
            except SceneError as error:
                assert "needs distances all around" in str(error)
                refused = True
            assert refused == writers[-1].directed, (geometry, solid)
            told[solid].add(refused)
    assert all(told.values())
    assert set.union(*told.values()) == {True, False}
    # A tile needs a manifold, which `relaxed` does not know.
    assert {solid.split(":")[0] for solid in SOLIDS} == set(Solid.one_of) - {"tile"}


# -- what is in the program ----------------------------------------------------------------------------------


def test_a_scene_that_names_no_tracer_has_none_of_them() -> None:
    plan = make_plan(load_text(text("samples: 1")))
    marched = [part for part in plan.parts if part.startswith("march") or part == "block_start.cl"]
    assert marched == ["march.h", "march/direct.h", "march/loop.h"]
    assert plan.source.defines == {}
    for name in ("scene_component", "scene_unbounding"):
        assert name not in plan.source.generated["scene objects"]
    assert plan.explain()["tracer"] == "direct: all objects at once are cheap"


def test_what_a_scene_names_is_in_its_program_and_explained() -> None:
    plan = make_plan(load_text(text("tracer: compound, start: block, detail: 0.5")))
    assert "march/compound.h" in plan.parts
    assert plan.parts[-2:] == ("render.cl", "block_start.cl")
    assert plan.source.defines == {"BLOCK_START": 1, "COMPONENTS": len(BALLS) + 1, "DETAIL": 3}
    assert plan.numbers[3] == 0.5
    said = plan.explain()["tracer"]
    assert said == "compound: as the scene says, detail 0.5 pixels, started by blocks of 4x4 pixels"


def test_as_many_objects_as_may_be_marched_by_themselves() -> None:
    centers = [(x, 0.5 * y, 0.5 * z) for x in (1.0, 2.0) for y in (-1, 0, 1) for z in (-1, 0, 1)]
    balls = tuple((center, 0.2) for center in centers[: MOST_COMPONENTS - 1])
    want, got = picture(way("direct"), balls=balls), picture(way("compound"), balls=balls)
    assert np.mean(want.channels["object"] != got.channels["object"]) < 0.002


@pytest.mark.parametrize(("tracer", "start"), WAYS)
def test_the_background_is_seen_where_nothing_is_near(tracer: str, start: str) -> None:
    """A ray that no object may stop is marched all the same: black is what lies outside a round picture."""
    scene = load_text(
        "geometry: e3\ncamera: {at: [0, -6, 0], look: {to: [0, 0, 0]}}\nbackground: white\nobjects:\n"
        "  - {ball: {radius: 0.3}, at: [-1, 0, 0]}\n  - {ball: {radius: 0.3}, at: [1, 0, 0]}\n"
        f"render: {{tracer: {tracer}, start: {start}}}\n"
    )
    image = render(scene, size=SIZE, samples=1)
    assert image.statistics["rays"] == SIZE[0] * SIZE[1]
    missed = image.channels["object"] == 0
    assert np.mean(missed) > 0.9
    np.testing.assert_array_equal(image.channels["beauty"][missed], 1)
