"""The scenes of the library: that they are listed, what each shows, and that its picture does not depend on
how it is worked out (in which precision: stability/test_pictures.py).
"""

import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stability.pictures import check_finite

import thurston_cl as tc
from thurston_cl.device import Device
from thurston_cl.image import Image
from thurston_cl.models import GEOMETRIES
from thurston_cl.scene import library

ROOT = Path(__file__).parents[1]
NAMES = library.library_names()
SIX_LINES = "h3/seifert-weber"
SIZE = (96, 64)

# The paper's figures that this version can render; the top of figure 23 is its upper half.
FIGURES = {
    "figure 13(a)",
    "figure 13(b)",
    "figure 13(c)",
    *(f"figure 16({letter})" for letter in "bc"),
    *(f"figure {number}({letter})" for number in (20, 26) for letter in "ab"),
    *(f"figure {number}({letter})" for number in (21, 22, 25) for letter in "abc"),
    "figure 23, top",
    "figure 23, bottom",
    "figure 34, left",
    "figure 34, right",
    *(f"figure {number}" for number in (8, 18, 19, 29, 41, 42, 44, 48, 49, 52, 55, 56, 59)),
    *(f"figure {number}({letter})" for number in (27, 35, 47) for letter in "ab"),
    *(f"figure {number}({letter})" for number in (28, 46) for letter in "abcd"),
    "figure 1",
    "figure 37(a)",
    "figure 37(b)",
    *(f"figure {number}({letter})" for number in (30, 31, 32, 38, 39, 51, 60, 67) for letter in "abc"),
    "figure 62",
    "figure 63",
    *(f"figure {number}({letter})" for number in (64, 65) for letter in "abcd"),
    *(f"KRS figure {number}" for number in (1, 5, 6, 8, 9, 10, 11, 13)),
}

# The share of rays that hit something at least, and at most where rays should also escape. In a tiling of
# e3 or h3 every ray ends on something; windows of s3, the plane's sky, the ends of h3, level rays beside a
# line of balls and far balls beyond the fog stay open.
OPEN = {
    "e3/ball-over-plane": (0.9, 1.0),
    "e3/carved-solids": (0.85, 0.99),
    "e3/coral": (0.65, 0.9),
    "e3/earth-balls": (0.25, 0.5),
    "e3/moebius-coral": (0.65, 0.9),
    "e3/palm-leaf-iterations": (0.1, 0.35),
    "e3/reef": (0.65, 0.88),
    "e3/rock-flat": (0.75, 0.9),
    "e3/rock-smooth": (0.75, 0.9),
    "e3/shadow-hard": (0.75, 0.9),
    "e3/shadow-soft": (0.75, 0.9),
    "e3/terrain": (0.55, 0.75),
    "e3/fish-aligned": (0.55, 0.8),
    "e3/fish-school": (0.6, 0.85),
    "e3/forest-from-the-air": (0.75, 0.95),
    "e3/grove": (0.7, 0.9),
    "e3/tree": (0.55, 0.8),
    "e3/tree-twisted": (0.6, 0.85),
    "h3/cone-axis-double-image": (0.35, 0.7),
    "h3/cone-axis-hidden-ball": (0.35, 0.7),
    "h3/forest": (0.45, 0.85),
    "h3/horoballs": (0.6, 0.95),
    "h3/hyperideal-cube": (0.25, 0.6),
    "s3/woven-fibers": (0.35, 0.8),
    "s3/binary-tetrahedral-light-all": (0.75, 0.95),
    "s3/binary-tetrahedral-light-cell": (0.75, 0.95),
    "s3/binary-tetrahedral-light-neighbours": (0.75, 0.95),
    "s3/binary-tetrahedral-tile": (0.7, 0.99),
    "s3/hopf-fibration": (0.4, 0.9),
    "s3/one-light": (0.2, 0.7),
    "s3/poincare-ball": (0.4, 0.9),
    "s3/quaternion-edges": (0.5, 0.95),
    "s2xe/antipodal-fiber-panorama": (0.9, 0.98),
    "s2xe/dodecahedron-along-the-fiber": (0.85, 0.99),
    "s2xe/dodecahedron-along-the-sphere": (0.7, 0.95),
    "s2xe/dodecahedron-dome": (0.85, 0.97),
    "s2xe/fibers-over-an-icosahedron": (0.3, 0.7),
    "s2xe/line-of-balls": (0.8, 0.97),
    "s2xe/line-of-balls-fake-light": (0.8, 0.97),
    "s2xe/mirrored-sphere": (0.65, 0.9),
    "s2xe/one-light": (0.4, 0.8),
    "h2xe/hall": (0.8, 0.98),
    "h2xe/half-space": (0.6, 0.9),
    "h2xe/stereo-anaglyph": (0.2, 0.4),
    "nil/bundle-of-fibers": (0.2, 0.6),
    "nil/collection-of-balls": (0.35, 0.65),
    "nil/fibers": (0.9, 0.99),
    "nil/fibers-panorama": (0.5, 0.8),
    "nil/globes-omnidirectional": (0.75, 0.95),
    "nil/heisenberg-plane": (0.7, 0.95),
    "nil/horizontal-half-space": (0.85, 0.98),
    "nil/line-of-balls": (0.9, 0.99),
    "nil/line-of-balls-eight-geodesics": (0.9, 0.99),
    "nil/line-of-balls-four-geodesics": (0.9, 0.99),
    "nil/line-of-balls-sixteen-geodesics": (0.9, 0.99),
    "nil/line-of-balls-two-geodesics": (0.9, 0.99),
    "nil/parallax-left": (0.1, 0.25),
    "nil/parallax-middle": (0.25, 0.45),
    "nil/parallax-right": (0.1, 0.25),
    "nil/sunset": (0.55, 0.8),
    "nil/vertical-half-space-along": (0.55, 0.85),
    "nil/vertical-half-space-behind": (0.5, 0.8),
    "nil/vertical-half-space-facing": (0.4, 0.75),
    "sl2/fibers-panorama": (0.4, 0.65),
    "sl2/genus-two-balls": (0.9, 0.99),
    "sl2/genus-two-globes": (0.85, 0.98),
    "sl2/globes": (0.75, 0.95),
    "sl2/horizontal-half-space": (0.6, 0.85),
    "sl2/line-of-balls": (0.4, 0.75),
    "sl2/soft-shadows": (0.4, 0.7),
    "sl2/vertical-half-space": (0.45, 0.8),
    "sl2/vertical-half-space-along": (0.45, 0.75),
    "sol/anosov-floors": (0.85, 0.99),
    "sol/anosov-globes": (0.9, 0.99),
    "sol/balls-exact-and-pseudo": (0.2, 0.6),
    "sol/between-horizontal-planes": (0.6, 0.9),
    "sol/between-horizontal-planes-diagonal": (0.9, 0.99),
    "sol/bundle-of-trace-four": (0.55, 0.9),
    "sol/cube": (0.25, 0.6),
    "sol/cube-from-a-distance": (0.1, 0.4),
    "sol/cube-lattice": (0.75, 0.95),
    "sol/cube-stereo": (0.15, 0.35),
    "sol/cylinders": (0.8, 0.98),
    "sol/horizontal-half-space": (0.6, 0.9),
    "sol/horizontal-planes-panorama": (0.85, 0.97),
    "sol/hyperbolic-grids": (0.2, 0.6),
    "sol/hyperbolic-half-space": (0.75, 0.98),
    "sol/negative-trace-comets": (0.5, 0.85),
    "sol/plane-of-cubes": (0.65, 0.9),
    "sol/pseudo-cylinders": (0.8, 0.98),
    "sol/square-tubes": (0.3, 0.7),
    "sol/straight-lines": (0.35, 0.7),
    "sol/sun": (0.45, 0.8),
}
# Light that blows up is what these show.
GLARING = ("s2xe/light-over-the-pole",)

# One for each geometry and way to measure distance near walls, one with shadows, and one sequence.
COMPARED = (
    "e3/ball-across-a-wall-neighbours",
    "e3/ball-over-plane",
    "e3/reef",
    "e3/rock-smooth",
    "h3/forest",
    "e3/palm-leaf",
    "e3/fish-school",
    "h3/hyperideal-cube",
    "h3/ideal-cube",
    "s3/woven-fibers",
    "s3/quaternion-edges",
    "s2xe/floors-with-wells",
    "h2xe/orbi-torus-tile",
    "nil/globes",
    "sl2/vertical-half-space",
    "sol/anosov-globes",
    "sol/cube",
    "sol/one-light",
)
# Each object is marched by itself, the one that is next in most lanes first: steps depend on the packet.
COMPOUND = ("e3/fish-school", "e3/reef", "e3/rock-smooth")


@cache
def picture(name: str, **settings: Any) -> Image:
    """A small picture of a scene, by one lane unless the settings say otherwise."""
    scene = tc.load_scene(name)
    plain = scene.camera.stereo is None and scene.camera.projection.kind == "perspective"
    # Panoramas and pictures for two eyes keep their shape.
    size = SIZE if plain else tuple(side // 10 for side in scene.render.size)
    return tc.render(scene, size=size, samples=1, **{"lanes": 1} | settings)


def share(pixels: np.ndarray) -> float:
    return float(np.count_nonzero(pixels)) / pixels.size


# What the files say


def test_the_library_has_scenes_of_every_geometry():
    assert {name.split("/")[0] for name in NAMES} == set(GEOMETRIES)
    for name in NAMES:
        assert tc.load_scene(name).geometry == name.split("/")[0]


def test_every_figure_that_can_be_rendered_has_a_scene():
    heads = [
        " ".join(re.findall("^#(.*)", library.library_scene(name).path.read_text("utf-8"), re.MULTILINE))
        for name in NAMES
    ]
    missing = {
        figure
        for figure in FIGURES
        # "figure 1" is neither figure 10 nor that of the other paper.
        if not any(re.search(rf"(?<!KRS ){re.escape(figure)}(?!\d)", head) for head in heads)
    }
    assert not missing


def test_every_scene_says_what_it_shows():
    for name in NAMES:
        scene = library.library_scene(name)
        assert scene.comment.endswith((".", ":")), name
        assert len(scene.comment) <= 130, name
        assert scene.title or name == SIX_LINES, name
        # Lines that a page of scenes can show.
        assert max(map(len, scene.path.read_text("utf-8").splitlines())) <= 130, name


def test_the_readme_lists_every_scene_with_its_figure():
    page = (ROOT / "scenes" / "README.md").read_text("utf-8")
    rows = dict(re.findall(r"^\| `(\w+/[\w-]+)` \| ([^|]*)\|", page, re.MULTILINE))
    assert sorted(rows) == NAMES
    for name, figure in rows.items():
        if figure.strip():
            # "KRS 13" is "KRS figure 13", of the other paper.
            words = re.sub("(KRS )?(.*)", r"\1figure \2", figure.strip(), count=1)
            assert words in library.library_scene(name).path.read_text("utf-8"), name


def test_six_lines_make_a_scene():
    text = library.library_scene(SIX_LINES).path.read_text("utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    assert [line.split(":")[0].strip() for line in lines] == [
        "geometry",
        "manifold",
        "objects",
        "- tile",
        "effects",
        "fog",
    ]


# What the pictures show


@pytest.mark.parametrize("name", NAMES)
def test_scene_renders(name):
    image = picture(name)
    rays = image.statistics["rays"]
    check_finite(image)
    least, most = OPEN.get(name, (0.97, 1.0))
    assert least <= image.statistics["hits"] / rays <= most
    # Rays that get nowhere would show as specks.
    assert image.statistics["out_of_steps"] <= 0.06 * rays
    # Neither drowned nor blown out, and not one flat tone.
    brightness = image.channels["beauty"].max(axis=2)
    assert brightness.std() > 0.03
    assert brightness.mean() > 0.04
    if name not in GLARING:
        assert brightness.mean() < 0.9
        assert share(brightness > 1) < 0.15


@pytest.mark.parametrize("name", COMPARED)
def test_lanes_do_not_change_what_is_seen(name):
    one, many = picture(name), picture(name, lanes=32)
    np.testing.assert_array_equal(one.channels["object"], many.channels["object"])
    off = np.abs(one.channels["beauty"] - many.channels["beauty"]).max(axis=2) > 0.02
    assert share(off) <= 0.01


@pytest.mark.parametrize("name", COMPARED)
def test_refilling_lanes_changes_nothing(name):
    packet, refill = picture(name, lanes=32, finish="packet"), picture(name, lanes=32, finish="refill")
    for channel, values in packet.channels.items():
        if channel == "steps" and name in COMPOUND:
            continue
        np.testing.assert_array_equal(values, refill.channels[channel], err_msg=channel)


# Figure 41: where c is small, the printed formulas of nil are noise.

# The share of hit pixels that may differ between float and double, and what counts as different.
NOISE, SEEN = 0.001, 2 / 255


def test_the_horizontal_plane_of_nil_is_free_of_noise(opencl_device: Device):
    if not opencl_device.info.fp64:
        pytest.skip("the device has no double precision")
    scene = tc.load_scene("nil/heisenberg-plane")
    single, double = (
        tc.render(scene, size=(384, 216), samples=1, precision=precision, lanes=4)
        for precision in ("single", "double")
    )
    hit = double.channels["object"] > 0
    assert share(hit) > 0.7
    off = np.abs(single.channels["beauty"] - double.channels["beauty"]).max(axis=2) > SEEN
    assert np.count_nonzero(off & hit) < NOISE * np.count_nonzero(hit)
    assert np.count_nonzero((single.channels["object"] > 0) != hit) < NOISE * np.count_nonzero(hit)


# Figures 44 and 56: the bound along the ray shows what bisection shows.


@pytest.mark.parametrize("name", ["nil/horizontal-half-space", "sl2/horizontal-half-space"])
def test_the_directed_bound_shows_what_bisection_shows(name):
    text = library.library_scene(name).path.read_text("utf-8")
    assert "crossing" not in re.sub("(?m)^#.*", "", text)
    ways = {}
    for way in ("directed", "bisection"):
        sets = [f"objects.0.half-space.crossing={way}", "render.steps=3000"]
        ways[way] = tc.render(tc.load_scene(name, sets=sets), size=SIZE, samples=1, lanes=1)
    one, other = (ways[way].channels for way in ("directed", "bisection"))
    assert share(one["object"] != other["object"]) <= 0.005
    assert share(np.abs(one["beauty"] - other["beauty"]).max(axis=2) > 0.02) <= 0.01
    assert ways["directed"].statistics["steps"] < 0.2 * ways["bisection"].statistics["steps"]


# Figure 13: one scene, three ways to measure distance near the walls

INSIDE, ACROSS = 1, 2


def seen(way: str) -> np.ndarray:
    return picture(f"e3/ball-across-a-wall-{way}").channels["object"]


def test_the_three_scenes_of_figure_13_differ_in_the_distance_only():
    texts = []
    for way in ("domain", "creeping", "neighbours"):
        text = library.library_scene(f"e3/ball-across-a-wall-{way}").path.read_text("utf-8")
        assert text.count(f"distance: {way}") == 1
        texts.append(re.sub("(?m)^(#|title:).*\n", "", text.replace(f"distance: {way}", "distance: WAY")))
    assert texts[0] == texts[1] == texts[2]


def test_distances_in_the_cell_alone_miss_the_ball_across_the_wall():
    domain, right = seen("domain"), seen("neighbours")
    assert share(domain != right) > 0.1
    # Rays jump through the red ball, and nowhere see more of it.
    assert np.count_nonzero(domain == ACROSS) < 0.75 * np.count_nonzero(right == ACROSS)


def test_creeping_shows_half_of_the_ball_across_the_wall():
    # Along the wall, which stands upright in the middle of the picture behind the red ball's center.
    view = "camera={at: [0.499, -0.45, 0], look: {along: [0, 1, 0]}, fov: 50 deg}"
    red = {}
    for way in ("creeping", "neighbours"):
        scene = tc.load_scene(f"e3/ball-across-a-wall-{way}", sets=[view])
        image = tc.render(scene, size=SIZE, samples=1, lanes=1)
        red[way] = (image.channels["object"] == ACROSS) & (image.channels["depth"] < 0.5)
    left = slice(0, SIZE[0] // 2)
    whole = np.count_nonzero(red["neighbours"])
    assert whole > 500
    assert 0.48 * whole < np.count_nonzero(red["creeping"]) < 0.52 * whole
    np.testing.assert_array_equal(red["creeping"][:, left], red["neighbours"][:, left])


def test_the_ball_inside_the_cell_needs_creeping_only():
    creeping, right = seen("creeping"), seen("neighbours")
    near = picture("e3/ball-across-a-wall-neighbours").channels["depth"] < 2
    assert share(near & (right == INSIDE)) > 0.1
    assert not np.any((right == INSIDE) & (creeping != INSIDE) & near)
    # Half a ball covers less than a whole one, and nothing beside it.
    assert share((creeping == ACROSS) & (right != ACROSS)) < 0.002


# KRS figure 13: a picture of the leaf, and what the way to it costs


def test_the_heat_map_of_figure_13_is_of_the_leaf_that_the_other_scene_shows():
    pictured, counted = (tc.load_scene(f"e3/palm-leaf{end}") for end in ("", "-iterations"))
    assert counted.camera == pictured.camera
    leaves = [scene.objects[0].krs.palm_leaf for scene in (pictured, counted)]
    assert leaves[0].record() == leaves[1].record()
    (output,) = counted.outputs
    assert (counted.render.tracer, output.shows, output.most) == ("binary", "steps", 70)


def test_70_iterations_are_enough_for_figure_13_and_more_than_by_distance():
    name = "e3/palm-leaf-iterations"
    binary = picture(name).channels
    relaxed = tc.render(tc.load_scene(name, sets=["render.tracer=relaxed"]), size=SIZE, samples=1, lanes=1)
    assert share(binary["object"] != relaxed.channels["object"]) <= 0.01
    leaf = binary["object"] > 0
    assert share(binary["steps"] > 70) <= 0.002
    # On the leaf the paper, too, needs about twice as many; beside it the largest balls go far at once.
    assert 1.5 < binary["steps"][leaf].mean() / relaxed.channels["steps"][leaf].mean() < 3
    assert binary["steps"][leaf].mean() > 1.2 * binary["steps"][~leaf].mean()


# Figure 8: one ball, seen from its fiber and from either side

EYES = ("left", "middle", "right")


def test_the_three_scenes_of_figure_8_differ_in_the_offset_only():
    texts, offsets = set(), []
    for eye in EYES:
        text = library.library_scene(f"nil/parallax-{eye}").path.read_text("utf-8")
        text, count = re.subn(r"delta: (-?[\d.]+)", "delta: D", re.sub("(?m)^(#|title:).*\n", "", text))
        assert count == 1
        texts.add(text)
        offsets.append(tc.load_scene(f"nil/parallax-{eye}").camera.at.model[0])
    assert len(texts) == 1
    assert offsets == [-0.03, 0, 0.03]


def test_the_eyes_do_not_agree_on_a_ball_beyond_a_conjugate_point():
    left, middle, right = (picture(f"nil/parallax-{eye}").channels["object"] == 1 for eye in EYES)
    center = slice(SIZE[1] // 2 - 2, SIZE[1] // 2 + 2), slice(SIZE[0] // 2 - 2, SIZE[0] // 2 + 2)
    # From the fiber the ball is a disc. Beside it a half turn about the fiber exchanges the eyes.
    assert middle[center].all()
    np.testing.assert_array_equal(left, right[::-1, ::-1])
    # Either eye sees half of that disc, and not the same half.
    seen_by_both = np.count_nonzero(left & right) / np.count_nonzero(middle)
    assert np.count_nonzero(left) < 0.55 * np.count_nonzero(middle)
    assert seen_by_both < 0.25
    # As large as a ball of this radius 0.1 away in Euclidean space: 2 asin(0.3) wide.
    across = np.count_nonzero(middle[SIZE[1] // 2]) / SIZE[1]
    expected = np.tan(np.arcsin(0.3)) / np.tan(np.radians(22))
    assert abs(across - expected) < 1.5 / SIZE[1]


def test_depth_is_reversed_beyond_a_quarter_of_a_great_circle():
    image = picture("s3/stereo-depth-reversed")
    eyes = np.split(image.channels["object"], 2, axis=1)
    near, at_quarter, far = (
        np.mean(np.nonzero(eyes[1] == ball)[1]) - np.mean(np.nonzero(eyes[0] == ball)[1])
        for ball in (1, 2, 3)
    )
    # In pixels; 0.064 rad near the direction of view are 3.3 of them, and 3.8 at its side.
    assert -4.3 < near < -3.3
    assert abs(at_quarter) < 0.3
    assert 3.3 < far < 4.3
