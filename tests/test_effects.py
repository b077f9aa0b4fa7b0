"""Effects: a program has those that its scene names and no other; their work is counted; they change what
they should and nothing else; and what they show is compared with closed forms.
"""

import re
from typing import Any

import numpy as np
import pytest
from camera_rays import view
from golden import Array, constant

import thurston_cl as tc
from thurston_cl.device import Device
from thurston_cl.program import kernel_text
from thurston_cl.rendering import Tile, TileRenderer
from thurston_cl.sampling import sample_shifts
from thurston_cl.scene import load_text
from thurston_cl.scene.effect_files import EFFECTS
from thurston_cl.scene.placement import CameraFrame, Placement
from thurston_cl.scene.plan import make_plan

SIZE = (160, 96)
FOV = np.radians(60)


def text(
    *,
    geometry: str = "e3",
    more: str = "",
    color: str = '"#cfa"',
    mirror: str = "",
    light: str = "point: {at: [1, -1, 2], intensity: 3}",
    shadows: str = "",
    effects: str = "",
) -> str:
    """A ball over a plane."""
    shaded = f"    shadows: {shadows}\n" if shadows else ""
    return f"""
geometry: {geometry}
{more}
camera: {{at: [0, -3, 1.2], look: {{to: [0, 0, 0]}}, fov: 60 deg}}
objects:
  - ball: {{radius: 0.5}}
    material: {{color: {color}{mirror}}}
  - half-space: {{normal: [0, 0, 1], offset: -0.7}}
lights:
  - {light}
{shaded}effects: {{{effects}}}
"""


IN_MANIFOLD = """
geometry: e3
manifold: three-torus
camera: {at: [0.2, -0.4, 0.1], look: {to: [0, 0, 0]}}
objects: [{ball: {radius: 0.2}}]
"""

# The counts of work that only some scenes do, and that of the first rays.
WORK = ("shadow_steps", "reflection_steps", "light_solves")
# By effect: a scene without it, one with it, and what is counted of it, or "".
CASES: dict[str, tuple[str, str, str]] = {
    "checker": (text(), text(color="{checker: {count: 8}}"), ""),
    "grid": (text(), text(color="{grid: {count: 8}}"), ""),
    "bands": (text(), text(color="{bands: {count: 8}}"), ""),
    "strips": (text(), text(color="{strips: {count: 8, colors: [red, white]}}"), ""),
    "image": (text(), text(color="{image: earth}"), ""),
    "noise": (text(), text(color="{noise: {size: 0.3}}"), ""),
    "triplanar": (text(), text(color="{triplanar: {checker: {count: 8}}}"), ""),
    "slope": (text(), text(color="{slope: {flat: green, steep: gray}}"), ""),
    "light along straight lines": (
        text(geometry="nil", light="sun: {from: [0, 0, 1]}"),
        text(geometry="nil", light="point: {at: [0, 0, 2], direction: straight}"),
        "",
    ),
    "sun": (text(), text(light="sun: {from: [1, -1, 2]}"), ""),
    "light along all geodesics up to a length": (
        text(light="point: {at: [1, -1, 2], intensity: 2}"),
        text(light="point: {at: [1, -1, 2], intensity: 2, geodesics: {within: 2}}"),
        "light_solves",
    ),
    "light fading as 1/length": (text(), text(light="point: {at: [1, -1, 2], falloff: inverse}"), ""),
    "light fading as 1/length²": (
        text(geometry="h3"),
        text(geometry="h3", light="point: {at: [1, -1, 2], falloff: inverse-square}"),
        "",
    ),
    "light that does not fade": (text(), text(light="point: {at: [1, -1, 2], falloff: constant}"), ""),
    "hard shadows": (text(), text(shadows="hard"), "shadow_steps"),
    "soft shadows": (text(), text(shadows="soft"), "shadow_steps"),
    "ambient occlusion": (text(), text(effects="ambient-occlusion: {reach: 1}"), "distance_evaluations"),
    "exponential fog": (text(), text(effects="fog: {exponential: {density: 0.2}}"), ""),
    "linear fog": (text(), text(effects="fog: {linear: {length: 9}}"), ""),
    "fog between lights and surfaces": (
        text(effects="fog: {linear: {length: 9}}"),
        text(effects="fog: {linear: {length: 9}, on-lights: true}"),
        "",
    ),
    "sky": (text(), text(more="background: {sky: {}}"), ""),
    "reflections": (
        text(),
        text(mirror=", reflectivity: 0.4", effects="reflections: {depth: 1}"),
        "reflection_steps",
    ),
    "cell ids": (IN_MANIFOLD, IN_MANIFOLD, ""),
}


def picture(scene: str, **settings: Any) -> tc.Image:
    return tc.render(load_text(scene), **{"size": SIZE, "samples": 1} | settings)


def functions_of(part: str) -> list[str]:
    # With a body: a declaration is not its own.
    return re.findall(r"^(?:FN|SOLVER) [\w ]+?(\w+)\([^;{]*(?:\n?\{)", kernel_text(part), re.MULTILINE)


def test_every_effect_is_here() -> None:
    assert set(CASES) == set(EFFECTS)


@pytest.mark.parametrize("effect", CASES)
def test_an_effect_is_compiled_where_it_is_named_and_changes_nothing_else(effect: str) -> None:
    without, with_it, counted = CASES[effect]
    functions = functions_of(EFFECTS[effect])
    assert functions
    channels = ("beauty", "depth", "normal", "object", "steps")
    more = {"channels": (*channels, "cell")} if effect == "cell ids" else {"channels": channels}
    plans = make_plan(load_text(without)), make_plan(load_text(with_it), channels=more["channels"])
    for plan, named in zip(plans, (False, True), strict=True):
        assert (effect in plan.called_for) == named and (effect in plan.left_out) != named
        assert (effect in plan.costs) == named and (effect in plan.costs_left_out) != named
        assert not named or plan.costs[effect].count > 0
        for function in functions:
            assert bool(re.search(rf"\b{function}\(", plan.source.text)) == named, function
    bare, full = picture(without, channels=channels), picture(with_it, **more)
    for name in ("depth", "object", "normal", "steps"):
        np.testing.assert_array_equal(bare.channels[name], full.channels[name], err_msg=name)
    changes = effect != "cell ids"
    assert np.any(bare.channels["beauty"] != full.channels["beauty"]) == changes
    for name in WORK:
        if name != "light_solves":
            assert bare.statistics[name] == 0, name
            assert (full.statistics[name] > 0) == (name == counted), name
    if counted == "distance_evaluations":
        assert full.statistics[counted] > bare.statistics[counted]
    if counted == "light_solves":
        # The second geodesic is looked for where the first is short enough, and there is none.
        assert full.statistics[counted] > bare.statistics[counted] > 0


def test_what_is_counted_adds_up() -> None:
    """Each step asks once for the distance, and so does where a ray ends; each surface asks for the light."""
    image = picture(text())
    told = image.statistics
    assert told["light_solves"] == told["hits"] > 0
    ended = told["rays"] - told["out_of_steps"]
    assert told["distance_evaluations"] == told["steps"] + ended
    shaded = picture(text(shadows="hard")).statistics
    lit = shaded["light_solves"] - shaded["hits"]
    assert 0 < lit < shaded["hits"]
    assert shaded["distance_evaluations"] == shaded["steps"] + ended + shaded["shadow_steps"] + lit
    occluded = picture(text(effects="ambient-occlusion: {reach: 1}")).statistics
    heights = int(constant("light/ambient_occlusion.h", "OCCLUSION_HEIGHTS"))
    assert occluded["distance_evaluations"] == told["distance_evaluations"] + heights * told["hits"]


ALL = text(
    mirror=", reflectivity: 0.4",
    shadows="soft",
    effects="fog: {linear: {length: 9}, on-lights: true}, "
    "ambient-occlusion: {reach: 1}, reflections: {depth: 2}",
)


def run(plan: Any, device: Device) -> tuple[dict[str, Array], dict[str, float]]:
    renderer = TileRenderer(plan, device, 4, "packet")
    return renderer.run(Tile(0, 0, *SIZE), sample_shifts(1), ("beauty", "depth"))  # type: ignore[return-value]


def test_a_program_with_everything_off_shows_what_one_without_shows(opencl_device: Device) -> None:
    """`switch`, against which the gain of assembling is measured, does not change what is simulated."""
    assembled = make_plan(load_text(ALL), size=SIZE)
    bare = make_plan(load_text(text()), size=SIZE)
    for switch, same in ((True, assembled), (False, bare)):
        plan = make_plan(load_text(ALL), size=SIZE, switch=switch)
        assert set(plan.parts) == set(assembled.parts)
        got, work = run(plan, opencl_device)
        want, wanted_work = run(same, opencl_device)
        np.testing.assert_allclose(got["beauty"], want["beauty"], atol=2e-6, err_msg=str(switch))
        assert work == wanted_work


@pytest.mark.parametrize("geometry", tc.models.GEOMETRIES)
def test_two_lights_give_the_sum_of_each(geometry: str) -> None:
    lights = (
        '  - point: {at: [0.9, -0.8, 0.9], intensity: 0.7, color: "#f84"}\n    shadows: hard\n',
        '  - point: {at: [-1, -0.5, 0.8], color: "#48f", falloff: inverse}\n    shadows: soft\n',
    )

    def seen(*which: str) -> Array:
        scene = (
            f"geometry: {geometry}\ncamera: {{at: [0.2, -1.1, 0.4], look: {{to: [0, 0, 0]}}}}\n"
            "objects:\n  - ball: {radius: 0.4}\n    material: {ambient: 0}\n"
            "  - half-space: {normal: [0, 0, 1], offset: -0.5}\n    material: {ambient: 0}\n"
            "lights:\n" + "".join(which)
        )
        beauty: Array = picture(scene).channels["beauty"].astype(np.float64)
        return beauty

    first, second, both = seen(lights[0]), seen(lights[1]), seen(*lights)
    for one, other in ((first, second), (second, first)):
        assert np.any((one > 0.02) & (other == 0))
    np.testing.assert_allclose(both, first + second, rtol=2e-6, atol=1e-7)


def points_of(image: tc.Image, scene: str, geometry: str = "e3") -> tuple[Array, Array, tc.Geometry]:
    """The points (N,4) that pixels hit, row by row, and which of all pixels those are (H*W,)."""
    g = tc.Geometry(geometry, "double")
    camera = CameraFrame(load_text(scene).camera, Placement(g))
    hit = image.channels["object"].ravel() > 0
    lengths = image.channels["depth"].ravel()[hit].astype(np.float64)
    directions = view(camera, SIZE, FOV)[hit]
    return g.flow(directions, lengths, base=camera.point)[0], hit, g


def beside_the_ball(
    p: Array, q: Array, center: Array, radius: float, samples: int = 4001
) -> tuple[Array, Array]:
    """Clear distances (N,S) to a ball and the plane z = -0.7 along segments from p (N,3) to q (3,), and the
    lengths there (N,S)."""
    s = np.linspace(0, 1, samples)[None, :, None]
    way = p[:, None] * (1 - s) + q * s
    clear = np.minimum(np.linalg.norm(way - center, axis=2) - radius, way[..., 2] + 0.7)
    return clear, s[..., 0] * np.linalg.norm(q - p, axis=1)[:, None]


FLAT_LIGHT = "point: {at: [1, -1, 2], falloff: constant}"


def test_the_shadow_of_a_ball_on_a_half_space() -> None:
    """Where the segment to the light passes the center of the ball by less than its radius: closed form."""
    scene = text(light=FLAT_LIGHT, shadows="hard")
    bare, shaded = picture(text(light=FLAT_LIGHT)), picture(scene)
    points, hit, _ = points_of(shaded, scene)
    on_plane = shaded.channels["object"].ravel()[hit] == 2
    p, q = points[on_plane, :3], np.array([1.0, -1, 2])
    to_light = (q - p) / np.linalg.norm(q - p, axis=1, keepdims=True)
    along = (-p * to_light).sum(axis=1)
    passes = np.linalg.norm(p + along[:, None] * to_light, axis=1)
    hidden = (passes < 0.5) & (along > 0)
    difference = bare.channels["beauty"] - shaded.channels["beauty"]
    dark = difference.max(axis=2).ravel()[hit][on_plane] > 1e-3
    clear = np.abs(passes - 0.5) > 2e-3
    assert 0.02 < hidden.mean() < 0.5
    np.testing.assert_array_equal(dark[clear], hidden[clear])


@pytest.mark.parametrize("sharpness", [2, 5, 20])
def test_soft_shadows_are_the_least_angle(sharpness: float) -> None:
    """Eq. 5.4 over the whole segment in place of where the marcher stops: it may miss the least by a little,
    and never goes below."""
    scene = text(light=FLAT_LIGHT, shadows=f"{{soft: {{sharpness: {sharpness}}}}}")
    bare, shaded = picture(text(light=FLAT_LIGHT)), picture(scene)
    points, hit, _ = points_of(shaded, scene)
    on_plane = shaded.channels["object"].ravel()[hit] == 2
    clear, lengths = beside_the_ball(points[on_plane, :3], np.array([1.0, -1, 2]), np.zeros(3), 0.5)
    ratio = np.where(lengths > 1e-3, clear / np.maximum(lengths, 1e-3), np.inf).min(axis=1)
    want = np.clip(sharpness * ratio, 0, 1)

    def direct(image: tc.Image) -> Array:
        ambient = 0.1 * np.array(load_text(scene).objects[1].material.color.linear)
        values = image.channels["beauty"].reshape(-1, 3)[hit][on_plane] - ambient
        return np.asarray(values[:, 0], np.float64)

    got = direct(shaded) / direct(bare)
    assert ((want > 0.05) & (want < 0.95)).sum() > 200
    assert (got - want).min() > -2e-2
    assert np.abs(got - want).mean() < 0.02 and np.percentile(got - want, 99) < 0.15


def test_the_ball_of_a_light_shades_other_lights_and_not_its_own() -> None:
    lamp = "point: {at: [0.6, -0.6, 1.2], intensity: 2, color: orange, ball: 0.2}"
    for kind in ("hard", "soft"):
        bare, shaded = picture(text(light=lamp)), picture(text(light=lamp, shadows=kind))
        away = shaded.channels["object"] == 2
        # Above the plane nothing but the lamp itself stands between, beside the shadow of the other ball.
        points, hit, _ = points_of(shaded, text(light=lamp))
        clear, lengths = beside_the_ball(points[:, :3], np.array([0.6, -0.6, 1.2]), np.zeros(3), 0.5, 801)
        ratio = np.where(lengths > 0.01, clear / np.maximum(lengths, 0.01), np.inf).min(axis=1)
        open_to_it = np.zeros(hit.shape, bool)
        open_to_it[hit] = ratio > 0.15
        lit = away & open_to_it.reshape(away.shape)
        assert lit.sum() > 100
        np.testing.assert_allclose(
            shaded.channels["beauty"][lit], bare.channels["beauty"][lit], rtol=1e-5, err_msg=kind
        )
    seen = shaded.channels["object"] == 3
    assert seen.sum() > 20
    # It shines by itself, in its color.
    glow = np.array(load_text(text(light=lamp)).lights[0].point.color.linear)  # type: ignore[union-attr]
    np.testing.assert_allclose(shaded.channels["beauty"][seen], np.tile(glow, (seen.sum(), 1)), rtol=1e-6)

    def second(ball: str) -> tc.Image:
        other = "\n  - point: {at: [1.2, -1.2, 2.9], falloff: constant}\n    shadows: hard"
        return picture(text(light=f"point: {{at: [0.6, -0.6, 1.2], intensity: 1.0e-9{ball}}}{other}"))

    with_ball, without = second(", ball: 0.2"), second("")
    darker = (without.channels["beauty"] - with_ball.channels["beauty"]).max(axis=2) > 0.05
    assert np.count_nonzero(darker & (with_ball.channels["object"] == 2)) > 12


@pytest.mark.parametrize("geometry", ["h2xe", "nil"])
@pytest.mark.parametrize("kind", ["hard", "soft"])
def test_over_a_level_plane_the_ball_of_a_light_does_not_shade_its_own(geometry: str, kind: str) -> None:
    """There soft shadows work out the distance anew."""

    def lit(ball: str) -> tc.Image:
        return picture(
            text(
                geometry=geometry,
                light=f"point: {{at: [0.3, -0.4, 0.9]{ball}}}",
                shadows=kind,
                more="render: {far: 8}",
            )
        )

    bare, lamp = lit(""), lit(", ball: 0.2")
    same = bare.channels["object"] == lamp.channels["object"]
    assert (lamp.channels["object"] == 3).sum() > 50 and (same & (bare.channels["object"] == 2)).sum() > 2000
    # Rounding may move the steps of a ray, and with them the least distance by a little.
    off = np.abs(bare.channels["beauty"] - lamp.channels["beauty"]).max(axis=2)[same]
    assert np.count_nonzero(off > 1e-3) <= 0.002 * off.size


def test_the_second_geodesic_of_s3_is_as_bright_as_its_area_density_says() -> None:
    """2 pi - theta long, density sin^2, the light's own color and intensity in it (a known bug elsewhere)."""

    def scene(count: int) -> str:
        return (
            "geometry: s3\ncamera: {at: [0, -1.2, 0.4], look: {to: [0, 0, 0]}, fov: 60 deg}\n"
            "objects:\n  - ball: {radius: 0.5}\n"
            "    material: {color: white, ambient: 0, diffuse: 1, specular: 0}\n"
            "lights:\n  - point: {at: [0.9, -0.5, 0.4], intensity: 0.7, color: '#ff8040', "
            f"geodesics: {count}}}\n"
        )

    one, two = picture(scene(1)), picture(scene(2))
    points, hit, g = points_of(two, scene(2), "s3")
    light = load_text(scene(2)).lights[0].point
    assert light is not None
    place = Placement(g).point(light.at)
    cosine = points @ place
    theta = np.arccos(np.clip(cosine, -1, 1))
    # At p the way to q over the near side begins along q - <p, q> p; the normal points away from the center.
    towards = (place - cosine[:, None] * points) / np.sin(theta)[:, None]
    origin = np.array([0, 0, 0, 1.0])
    normal = -(origin - points[:, 3:] * points) / np.sqrt(1 - points[:, 3:] ** 2)
    facing = (towards * normal).sum(axis=1)
    both = np.maximum(facing, 0) + np.maximum(-facing, 0)
    density = np.sin(2 * np.pi - theta) ** 2
    want = np.outer(both / density, np.array(light.color.linear) * light.intensity)
    got = two.channels["beauty"].reshape(-1, 3)[hit]
    inside = np.abs(facing) > 0.02
    np.testing.assert_allclose(got[inside], want[inside], rtol=2e-3, atol=2e-4)
    behind = (facing < -0.02) & inside
    assert behind.sum() > 500 and np.all(one.channels["beauty"].reshape(-1, 3)[hit][behind] == 0)


def test_light_along_all_geodesics_up_to_a_length_is_that_of_those_which_are_no_longer() -> None:
    """In nil, where between none and many geodesics reach a point."""

    def scene(geodesics: str) -> str:
        return (
            "geometry: nil\nrender: {far: 8}\n"
            "camera: {at: {model: [2, -1, 6, 1]}, look: {to: {model: [0, 0, 6, 1]}}, fov: 60 deg}\n"
            "objects:\n  - ball: {radius: 0.8}\n    at: {model: [0, 0, 6, 1]}\n"
            "    material: {ambient: 0, specular: 0, diffuse: 1}\n"
            "lights:\n  - point: {at: {model: [0.2, 0.1, -4, 1]}, falloff: constant, "
            f"geodesics: {geodesics}}}\n"
        )

    most, limit = 6, 9.5
    by_count = [picture(scene(str(k))).channels["beauty"].astype(np.float64) for k in range(1, most + 1)]
    each = np.diff([np.zeros_like(by_count[0]), *by_count], axis=0).reshape(most, -1, 3)
    image = picture(scene(f"{{within: {limit}}}"))
    points, hit, g = points_of(image, scene("1"), "nil")
    light = np.array([0.2, 0.1, -4, 1])
    _, lengths = g.geodesics(np.broadcast_to(light, points.shape), most, points)
    assert np.all(np.isnan(lengths[:, -1]) | (lengths[:, -1] > limit)), "there are more"
    counts = np.less_equal(lengths.T, limit)
    assert 0 < counts[1:].mean() < 1
    want = (each[:, hit] * counts[:, :, None]).sum(axis=0)
    near = (np.abs(lengths - limit) < 1e-3).any(axis=1)
    got = image.channels["beauty"].reshape(-1, 3)[hit]
    np.testing.assert_allclose(got[~near], want[~near], atol=1e-6)


@pytest.mark.parametrize("geometry", tc.models.GEOMETRIES)
def test_energy_is_neither_made_nor_lost_along_the_flow(geometry: str) -> None:
    """Intensity times area over a small solid angle is constant (paper 5.7): a small triangle of directions
    flows to one on the wave front; its area, by Heron's formula from the distances of its corners, times the
    intensity is the solid angle."""
    g = tc.Geometry(geometry, "double")
    rng = np.random.default_rng(5)
    middles = rng.normal(size=(40, 3))
    middles /= np.linalg.norm(middles, axis=1, keepdims=True)
    across = np.cross(middles, rng.normal(size=(40, 3)))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    other = np.cross(middles, across)
    size = 2e-5
    turns = 2 * np.pi * np.arange(3) / 3
    corners = [middles + size * (np.cos(a) * across + np.sin(a) * other) for a in turns]
    corners = [c / np.linalg.norm(c, axis=1, keepdims=True) for c in corners]
    solid_angle = 0.75 * np.sqrt(3) * size**2

    def heron(a: Array, b: Array, c: Array) -> Array:
        s = (a + b + c) / 2
        return np.asarray(np.sqrt(np.maximum(s * (s - a) * (s - b) * (s - c), 0)))

    for time in (0.3, 1.0, 2.0, 2.9, 4.3, 5.4):
        ends = [g.flow(corner, time)[0] for corner in corners]
        sides = [g.distance(ends[k], base=ends[k - 1]) for k in range(3)]
        intensity = 1 / g.area_density(middles, time)
        energy = intensity * heron(*sides)
        if time < np.pi:
            np.testing.assert_allclose(energy, solid_angle, rtol=5e-3, err_msg=f"{geometry} {time}")
        else:
            # Beyond places where light is focused; next to one the triangle is no small one any more.
            off = np.abs(energy / solid_angle - 1)
            assert np.percentile(off, 80) < 0.02, f"{geometry} {time}"


# Isometries that mirror in a plane: geometry, normal of the plane.
MIRRORS = {
    "e3": (0.2, 0, 1),
    "s3": (0.2, 0, 1),
    "h3": (0.2, 0, 1),
    "s2xe": (0, 0, 1),
    "h2xe": (1, 0.2, 0),
    "sol": (1, 0, 0),
}


@pytest.mark.parametrize("geometry", MIRRORS)
def test_a_mirror_shows_what_stands_behind_it_if_the_mirror_is_an_isometry(geometry: str) -> None:
    """In a half-space that mirrors everything one sees what one sees without it if the mirrored ball stands
    behind; as far away, as the fog tells."""
    normal = np.array(MIRRORS[geometry], float)
    normal /= np.linalg.norm(normal)
    at = 0.5 * normal
    camera = 1.2 * normal + 0.9 * np.cross(normal, [0.3, 1.0, 0.2])

    def seen(second: str, reflections: str) -> tc.Image:
        glow = "ambient: 1, diffuse: 0, specular: 0"
        return picture(
            f"geometry: {geometry}\ncamera: {{at: {camera.tolist()}, look: {{to: [0, 0, 0]}}, fov: 60 deg}}\n"
            f"objects:\n  - ball: {{radius: 0.4}}\n    at: {at.tolist()}\n"
            f"    material: {{color: orange, {glow}}}\n{second.replace('GLOW', glow)}"
            "lights: [{point: {at: [0, 0, 1]}}]\n"
            f"effects: {{fog: {{exponential: {{density: 0.3}}}}{reflections}}}\nrender: {{far: 40}}\n"
        )

    mirrored = seen(
        f"  - half-space: {{normal: {normal.tolist()}}}\n"
        "    material: {color: black, GLOW, reflectivity: 1}\n",
        ", reflections: {depth: 1}",
    )
    through = seen(
        f"  - ball: {{radius: 0.4}}\n    at: {(-at).tolist()}\n    material: {{color: orange, GLOW}}\n", ""
    )
    on_mirror = mirrored.channels["object"] == 2
    behind = through.channels["object"] == 2
    assert np.count_nonzero(on_mirror & behind) > 60
    off = np.abs(mirrored.channels["beauty"] - through.channels["beauty"]).max(axis=2) > 2e-3
    # Edges may move by a pixel.
    assert np.count_nonzero(off & on_mirror) <= 0.01 * on_mirror.sum()


@pytest.mark.parametrize("depth", [0, 1, 2, 3])
def test_mirrors_share_what_is_seen(depth: int) -> None:
    """Between two planes that glow: (1 - r1) c1 + r1 ((1 - r2) c2 + r2 (...)), the last one whole (5.4)."""
    scene = f"""
geometry: e3
camera: {{at: [0, 0, 0.1], look: {{along: [0.2, 0.1, -1], up: [0, 1, 0]}}, fov: 40 deg}}
objects:
  - half-space: {{normal: [0, 0, 1], offset: -1}}
    material: {{color: red, ambient: 1, diffuse: 0, specular: 0, reflectivity: 0.4}}
  - half-space: {{normal: [0, 0, -1], offset: -1}}
    material: {{color: lime, ambient: 1, diffuse: 0, specular: 0, reflectivity: 0.7}}
lights: [{{sun: {{from: [0, 0, 1]}}}}]
effects: {{reflections: {{depth: {depth}}}}}
"""
    image = picture(scene)
    seen = np.zeros(3)
    for bounce in range(depth, -1, -1):
        color, r = (np.array([1.0, 0, 0]), 0.4) if bounce % 2 == 0 else (np.array([0, 1.0, 0]), 0.7)
        seen = color if bounce == depth else (1 - r) * color + r * seen
    np.testing.assert_allclose(image.channels["beauty"], np.tile(seen, (*SIZE[::-1], 1)), atol=1e-6)
    assert (image.statistics["reflection_steps"] > 0) == (depth > 0)
    assert ("light/reflection.h" in make_plan(load_text(scene)).parts) == (depth > 0)


@pytest.mark.parametrize(
    "law", ['linear: {length: 4, color: "#246"}', 'exponential: {density: 0.4, color: "#246"}']
)
def test_fog_follows_its_law_on_both_ways(law: str) -> None:
    """Against the picture without fog: Col Fog(d_V) + (1 - Fog(d_V)) C_fog (eq. 5.6), and what lights give
    dimmed by Fog(d_L)."""
    clear, seen = picture(text()), picture(text(effects=f"fog: {{{law}}}"))
    lit = picture(text(effects=f"fog: {{{law}, on-lights: true}}"))

    def left(length: Array) -> Array:
        return np.asarray(np.exp(-0.4 * length) if "density" in law else 1 - np.minimum(length / 4, 1))

    points, hit, _ = points_of(clear, text())
    t = left(clear.channels["depth"].ravel()[hit].astype(np.float64))[:, None]
    fog = np.array(load_text(text(effects=f"fog: {{{law}}}")).effects.fog.law[2].linear)  # type: ignore[union-attr]
    bare = clear.channels["beauty"].reshape(-1, 3)[hit].astype(np.float64)
    np.testing.assert_allclose(
        seen.channels["beauty"].reshape(-1, 3)[hit], bare * t + (1 - t) * fog, atol=2e-6
    )
    np.testing.assert_allclose(
        seen.channels["beauty"].reshape(-1, 3)[~hit], np.tile(fog, ((~hit).sum(), 1)), atol=1e-6
    )
    scene = load_text(text())
    colors = np.array([item.material.color.linear for item in scene.objects])
    ambient = 0.1 * colors[clear.channels["object"].ravel()[hit] - 1]
    d = left(np.linalg.norm(points[:, :3] - [1, -1, 2], axis=1))[:, None]
    want = (ambient + (bare - ambient) * d) * t + (1 - t) * fog
    np.testing.assert_allclose(lit.channels["beauty"].reshape(-1, 3)[hit], want, atol=2e-5)


@pytest.mark.parametrize(("reach", "strength"), [(0.5, 1.0), (2.0, 0.6)])
def test_ambient_occlusion_beside_a_wall(reach: float, strength: float) -> None:
    """On a floor at the distance x from a wall what is clear at the height h is the lesser of h and x."""
    glow = "material: {color: white, ambient: 1, diffuse: 0, specular: 0}"
    scene = (
        "geometry: e3\ncamera: {at: [0, -2.5, 1], look: {to: [0, 0, 0]}, fov: 60 deg}\nobjects:\n"
        f"  - half-space: {{normal: [0, 0, 1]}}\n    {glow}\n"
        f"  - half-space: {{normal: [0, -1, 0]}}\n    {glow}\n"
        "lights: [{sun: {from: [0, 0, 1]}}]\n"
        f"effects: {{ambient-occlusion: {{reach: {reach}, strength: {strength}}}}}\n"
    )
    image = picture(scene, precision="double")
    points, hit, _ = points_of(image, scene)
    heights = int(constant("light/ambient_occlusion.h", "OCCLUSION_HEIGHTS"))
    ratio = constant("light/ambient_occlusion.h", "OCCLUSION_RATIO")
    h, weights = reach * np.arange(1, heights + 1) / heights, ratio ** -np.arange(heights)
    on_floor = image.channels["object"].ravel()[hit] == 1
    x = np.where(on_floor, -points[:, 1], points[:, 2])
    hidden = (weights * np.maximum(1 - np.minimum(h, x[:, None]) / h, 0)).sum(axis=1) / weights.sum()
    got = image.channels["beauty"].reshape(-1, 3)[hit][:, 0]
    np.testing.assert_allclose(got, 1 - strength * hidden, atol=2e-3)
    assert got.min() < 1 - 0.8 * strength and got.max() > 0.99 and on_floor.any() and not on_floor.all()


def test_ambient_occlusion_beyond_walls() -> None:
    """In the three-torus a ball beside a wall sees its images over it, as it sees such balls in whole space.
    With reach: 3 a step would lead over more than one wall, with 0.9 it ends beyond one."""
    glow = "material: {color: white, ambient: 1, diffuse: 0, specular: 0}"
    head = (
        "geometry: e3\ncamera: {at: [-0.2, -0.4, 0.45], look: {to: [0.3, 0.2, 0.1]}, fov: 80 deg}\n"
        "lights: [{sun: {from: [0, 0, 1]}}]\nrender: {far: 1.4}\n"
    )
    balls = ", ".join(f"{{ball: {{radius: 0.15}}, at: [{x}, {y}, {z}]}}" for x, y, z in np.ndindex(9, 9, 9))
    for reach in (0.9, 3):
        effect = f"effects: {{ambient-occlusion: {{reach: {reach}}}}}\n"
        torus = picture(
            f"{head}{effect}manifold: three-torus\nobjects:\n"
            f"  - ball: {{radius: 0.15}}\n    at: [0.3, 0.2, 0.1]\n    {glow}\n"
        )
        whole = picture(
            f"{head}{effect}objects:\n  - union: [{balls}]\n    at: [-3.7, -3.8, -3.9]\n    {glow}\n"
        )
        assert torus.statistics["nan"] == whole.statistics["nan"] == 0
        same = torus.channels["object"] == whole.channels["object"]
        assert same.mean() > 0.995
        off = np.abs(torus.channels["beauty"] - whole.channels["beauty"]).max(axis=2) > 1e-3
        assert np.count_nonzero(off & same) <= 0.005 * off.size
        seen = torus.channels["beauty"][torus.channels["object"] == 1][:, 0]
        assert seen.min() < 0.8 and np.ptp(seen) > 0.1


SMALL_OCCLUSION = """
geometry: GEOMETRY
camera: {at: [0.002, -0.011, 0.002], look: {to: [0, 0, 0]}}
objects:
  - ball: {radius: 0.004}
    material: {color: white, ambient: 1, specular: 0}
  - half-space: {normal: [0, 0, 1], offset: -0.005}
    material: {color: white, ambient: 1, specular: 0}
lights: [{point: {at: [0, 0, 0.03], falloff: constant}}]
effects: {ambient-occlusion: {reach: 0.005}}
render: {threshold: 1.0e-6, far: 0.1}
"""
SMALL_SHADOW = """
geometry: GEOMETRY
camera: {at: [0.002, -0.011, 0.005], look: {to: [0, 0, -0.005]}}
objects:
  - half-space: {normal: [0, 0, 1], offset: -0.005}
    material: {color: white, ambient: 0, specular: 0}
  - ball: {radius: 0.002}
    material: {color: white, ambient: 0, specular: 0}
lights:
  - point: {at: [0.005, 0, 0.02], falloff: constant}
    shadows: {soft: {sharpness: 3}}
render: {threshold: 1.0e-6, far: 0.1}
"""


@pytest.mark.parametrize("geometry", [name for name in tc.models.GEOMETRIES if name != "e3"])
@pytest.mark.parametrize("scene", [SMALL_OCCLUSION, SMALL_SHADOW], ids=["occlusion", "shadow"])
def test_small_things_are_shaded_as_in_euclidean_space(scene: str, geometry: str) -> None:
    """A hundredth of a unit large, where curvature changes little. Horizontal planes of fibered geometries,
    whose distance rays know along themselves only, shade as others do; of sol balls there is a bound only."""
    flat, curved = (picture(scene.replace("GEOMETRY", name), precision="double") for name in ("e3", geometry))
    assert curved.statistics["nan"] == 0
    same = flat.channels["object"] == curved.channels["object"]
    assert same.mean() > 0.95 and (flat.channels["object"] > 0).mean() > 0.4
    off = np.abs(flat.channels["beauty"] - curved.channels["beauty"]).max(axis=2)[same]
    most = 0.08 if geometry == "sol" else 0.04
    assert np.percentile(off, 95) < most and off.mean() < most / 4, (off.max(), off.mean())


def test_ambient_occlusion_leaves_lamps_bright() -> None:
    scene = text(light="point: {at: [1, -1, -0.5], ball: 0.25}", effects="ambient-occlusion: {reach: 0.5}")
    image = picture(scene)
    lamp = image.channels["object"] == 3
    assert lamp.sum() > 50
    np.testing.assert_allclose(image.channels["beauty"][lamp], 1, rtol=1e-6)


@pytest.mark.parametrize(
    ("geometry", "manifold"), [("h3", "seifert-weber"), ("nil", "heisenberg"), ("sol", "anosov")]
)
def test_ambient_occlusion_is_the_same_at_every_width(geometry: str, manifold: str) -> None:
    scene = (
        f"geometry: {geometry}\nmanifold: {manifold}\nrender: {{far: 3}}\n"
        "objects:\n  - ball: {radius: 0.25}\n    at: [0.2, 0.1, 0.1]\n"
        "    material: {color: white, ambient: 1, diffuse: 0, specular: 0}\n"
        "lights: [{point: {at: [0, 0, -0.4]}}]\neffects: {ambient-occlusion: {reach: 0.4}}\n"
    )
    many, one = (picture(scene, size=(64, 40), lanes=lanes) for lanes in (16, 1))
    assert many.statistics["nan"] == 0 and many.statistics["hits"] > 100
    off = np.abs(many.channels["beauty"] - one.channels["beauty"]).max(axis=2) > 1e-3
    assert np.count_nonzero(off) <= 0.01 * off.size


SPOILT = {
    "hard": ("light/hard_shadow.h", "  done->shadow_steps +=", "started"),
    "soft": ("light/soft_shadow.h", "  done->shadow_steps +=", "started"),
    "mirror": ("light/reflection.h", "    share = SELECT(open & is_lost(r)", "open"),
    "occlusion": ("light/ambient_occlusion.h", "    lost |=", ""),
}


@pytest.mark.parametrize("fog", ["", "fog: {linear: {length: 12}}", "fog: {exponential: {density: 0.1}}"])
@pytest.mark.parametrize("effect", SPOILT)
def test_a_ray_that_comes_to_nothing_is_a_counted_pixel_of_background(
    effect: str, fog: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every second ray gets a length that is no number: its pixel is counted, and shows no made-up light."""
    part, place, lanes = SPOILT[effect]
    spoil = f"r.t = SELECT({lanes}, REAL(NAN), r.t); r.hit &= NOT({lanes}); r.active &= NOT({lanes});\n"
    if effect == "occlusion":
        spoil = "clear = SELECT(counted, REAL(NAN), clear);\n"

    def spoilt(file: str) -> str:
        return kernel_text(file).replace(place, spoil + place) if file == part else kernel_text(file)

    scene = text(
        mirror=", reflectivity: 0.4" if effect == "mirror" else "",
        shadows=effect if effect in ("hard", "soft") else "",
        effects=", ".join(
            filter(
                None,
                [
                    fog,
                    {"mirror": "reflections: {depth: 1}", "occlusion": "ambient-occlusion: {reach: 1}"}.get(
                        effect
                    ),
                ],
            )
        ),
    )
    sound = picture(scene)
    monkeypatch.setattr("thurston_cl.program.kernel_text", spoilt)
    image = picture(scene)
    ball = np.count_nonzero(sound.channels["object"] == 1)
    least = {"mirror": ball, "occlusion": sound.statistics["hits"]}.get(
        effect, 0.4 * sound.statistics["hits"]
    )
    assert sound.statistics["nan"] == 0 and image.statistics["nan"] >= least > 0
    assert image.statistics["hits"] + image.statistics["nan"] == sound.statistics["hits"]
    assert np.isfinite(image.channels["beauty"]).all() and image.channels["beauty"].max() < 10


@pytest.mark.parametrize("geometry", ["h2xe", "nil"])
@pytest.mark.parametrize("shape", ["ball: {radius: 0.25}", "cylinder: {radius: 0.15}"])
def test_a_union_with_a_level_plane_shades_as_its_members(geometry: str, shape: str) -> None:
    def seen(objects: str) -> tc.Image:
        return picture(
            f"geometry: {geometry}\nrender: {{far: 6}}\n"
            "camera: {at: [0.2, -1.2, 0.4], look: {to: [0, 0, 0]}}\n"
            f"objects:\n{objects}lights: [{{sun: {{from: [0, 0, 1]}}}}]\n"
            "effects: {ambient-occlusion: {reach: 0.5}}\n"
        )

    glow = "material: {color: white, ambient: 1, diffuse: 0, specular: 0}"
    plane = "half-space: {normal: [0, 0, 1], offset: -0.3}"
    apart = seen(f"  - {shape}\n    {glow}\n  - {plane}\n    {glow}\n")
    union = seen(f"  - union: [{{{shape}}}, {{{plane}}}]\n    {glow}\n")
    same = (apart.channels["object"] > 0) == (union.channels["object"] > 0)
    off = np.abs(apart.channels["beauty"] - union.channels["beauty"]).max(axis=2)
    assert same.mean() > 0.995 and np.count_nonzero(off[same] > 1e-3) <= 0.005 * off.size
