"""Rays in cells of s2xe, h2xe, nil and sl2, checked against the whole space: what a ray hits in the cell has
to be the first ball of the orbit along the geodesic.
"""

import numpy as np
import pytest
from camera_rays import view

import thurston_cl as tc
from thurston_cl.lattice import elements
from thurston_cl.lattice.isometry import act
from thurston_cl.scene import load_text
from thurston_cl.scene.placement import CameraFrame, Placement

SIZE = (24, 16)
# Manifold, place of a ball inside the cell and of one across its walls, radius, and how far rays go: so many
# cells are in reach.
CELLS = {
    "s2xe": ("hopf-manifold", (0.3, 0.2, 0.4), (0.3, 0.2, 1.5), 0.5, 5.0, 40),
    "h2xe": ("orbi-torus", (0.3, 0.2, 0.3), (0.7, 0.2, 0.7), 0.35, 3.0, 700),
    "nil": ("heisenberg", (0.1, 0.2, 0.15), (0.45, 0.2, 0.48), 0.25, 2.5, 900),
    "sl2": ("genus-two", (0.4, 0.3, 0.5), (1.4, 0.3, 3.0), 0.7, 5.0, 1500),
    "sol": ("anosov", (0.05, 0.1, 0.1), (0.2, 0.12, 0.45), 0.2, 3.0, 4000),
}
# So many rays are sampled, so finely; and a ray may end so far from a ball that it hits, far above rounding.
RAYS = 24
SAMPLES = 8
NEAR = 2e-3


def scene_text(geometry: str, at: tuple[float, ...]) -> str:
    name, _, _, radius, far, _ = CELLS[geometry]
    return f"""
geometry: {geometry}
manifold: {name}
camera: {{at: [-0.25, 0.15, -0.3], look: {{along: [0.7, 0.5, 0.4]}}, fov: 90 deg}}
objects:
  - ball: {{radius: {radius}}}
    at: {list(at)}
render: {{far: {far}, threshold: 1.0e-4}}
"""


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("across", [False, True], ids=["inside", "across-walls"])
@pytest.mark.parametrize("geometry", CELLS)
def test_rays_hit_the_first_ball_of_the_orbit(geometry: str, across: bool, precision: str) -> None:
    _, inside, over_walls, radius, far, count = CELLS[geometry]
    at = over_walls if across else inside
    scene = load_text(scene_text(geometry, at))
    image = tc.render(scene, size=SIZE, samples=1, precision=precision, channels=("depth", "cell"))
    depth, cell = image.channels["depth"].ravel(), image.channels["cell"].ravel().astype(int)

    g = tc.Geometry(geometry)
    place = Placement(g)
    camera = CameraFrame(scene.camera, place)
    assert scene.lattice is not None and camera.carry(scene.lattice)
    centre, _, _ = scene.lattice.teleport(place.point(at)[None])
    orbit = elements(scene.lattice, count=count)
    centres = act(geometry, orbit, centre[0])
    reach = g.distance(centres[-1], base=camera.point)[0]
    assert reach > far + radius, "the orbit must go beyond the rays"

    directions = view(camera, SIZE, np.radians(90))
    hit = np.isfinite(depth)
    assert hit.mean() > 0.05 and (geometry == "h2xe" or not hit.all())
    ends, _ = g.flow(directions[hit], depth[hit], base=camera.point)
    # The ball that was hit is the one of the cell the ray is in.
    there = np.abs(g.distance(centres[cell[hit] - 1], base=ends) - radius)
    assert np.quantile(there, 0.99) < NEAR

    # Nothing was met before.
    rays = np.arange(0, len(directions), len(directions) // RAYS)
    times = np.linspace(0, 1, SAMPLES) * np.minimum(depth[rays] - 10 * NEAR, far)[:, None]
    points, _ = g.flow(np.repeat(directions[rays], SAMPLES, axis=0), times.ravel(), base=camera.point)
    lengths = g.distance(np.tile(centres, (len(points), 1)), base=np.repeat(points, count, axis=0))
    assert lengths.min() > radius - NEAR


@pytest.mark.parametrize("geometry", CELLS)
def test_neither_lanes_nor_refilling_change_what_is_seen(geometry: str) -> None:
    scene = load_text(scene_text(geometry, CELLS[geometry][2]))
    settings = {"size": (64, 48), "samples": 1, "channels": ("beauty", "depth", "object")}
    one = tc.render(scene, lanes=1, **settings).channels
    packet = tc.render(scene, lanes=16, finish="packet", **settings).channels
    refill = tc.render(scene, lanes=16, finish="refill", **settings).channels
    for name, values in packet.items():
        np.testing.assert_array_equal(values, refill[name], err_msg=name)
    # Rays that part like e^t carry a last digit of exp or log to the edge of a pixel now and then.
    assert np.count_nonzero(one["object"] != packet["object"]) <= 0.002 * one["object"].size


# Balls of the flat torus around the cell, written out, lit by one light that is not repeated.
NEAREST = [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]
TORUS = """
geometry: e3
{manifold}
camera: {{at: [0.4, 0.4, 0.4], look: {{along: [-1, -0.6, -0.5]}}, fov: 90 deg}}
objects: [{objects}]
lights:
  - point: {{at: [0.3, -0.4, 0.4]{repeated}}}
    shadows: hard
render: {{far: 1.0}}
"""


def test_a_light_that_is_not_repeated_lights_the_tiling_as_it_lights_the_whole_space() -> None:
    ball = "{{union: [{}]}}".format(
        ", ".join(f"{{ball: {{radius: 0.25}}, at: {list(center)}}}" for center in NEAREST)
    )
    settings = {"size": (48, 32), "samples": 1, "precision": "double", "channels": ("beauty", "object")}
    whole = tc.render(load_text(TORUS.format(manifold="", objects=ball, repeated="")), **settings)
    torus = TORUS.format(
        manifold="manifold: three-torus", objects="{ball: {radius: 0.25}}", repeated=", repeated: false"
    )
    tiled = tc.render(load_text(torus), **settings)
    np.testing.assert_array_equal(whole.channels["object"], tiled.channels["object"])
    assert 0.05 < (whole.channels["object"] > 0).mean() < 0.95
    np.testing.assert_allclose(whole.channels["beauty"], tiled.channels["beauty"], atol=2e-3)
    assert np.ptp(whole.channels["beauty"]) > 0.5


def test_what_a_manifold_has_no_place_for_is_an_error() -> None:
    level = "geometry: nil\nmanifold: heisenberg\nobjects:\n  - slab: {normal: [0, 0, 1], thickness: 0.05}\n"
    with pytest.raises(tc.SceneError, match="does not keep levels"):
        tc.render(load_text(level), size=(8, 8))
    # A bounded piece of it is an object like others.
    piece = level.replace("slab: {normal: [0, 0, 1], thickness: 0.05}", "{0}").format(
        "intersection: [{ball: {radius: 0.3}}, {slab: {normal: [0, 0, 1], thickness: 0.05}}]"
    )
    assert tc.render(load_text(piece), size=(64, 48), samples=1, lanes=4).statistics["hits"] > 0


THIN = """
geometry: e3
manifold:
  generators: [{maps}]
  domain: [{walls}]
camera: {{at: [-0.45, -0.4, {half}], look: {{along: [1, 0.1, 0]}}}}
objects:
  - ball: {{radius: 0.45}}
    at: [0.1, 0.2, 0]
"""


@pytest.mark.parametrize(("height", "fits"), [(0.02, True), (0.0004, False)])
def test_images_that_are_more_than_are_searched_are_an_error(height: float, fits: bool) -> None:
    maps, walls = [], []
    for axis, size in enumerate((1.0, 1.0, height)):
        for sign in (1, -1):
            matrix, wall = np.eye(4), np.zeros(4)
            matrix[axis, 3], wall[axis], wall[3] = -sign * size, sign, -size / 2
            maps.append(matrix.tolist())
            walls.append(wall.tolist())
    text = THIN.format(maps=", ".join(map(str, maps)), walls=", ".join(map(str, walls)), half=0.25 * height)
    scene = load_text(text)
    if fits:
        assert tc.render(scene, size=(8, 8), samples=1, lanes=1).statistics["nan"] == 0
    else:
        with pytest.raises(tc.SceneError, match="too many images"):
            tc.render(scene, size=(8, 8), samples=1, lanes=1)


def test_no_ray_of_sol_sticks_to_a_side() -> None:
    """Whatever is outside for outside_cell is moved, though both round in other ways: else it steps by 0."""
    scene = tc.load_scene("sol/cube-lattice", sets=["render.steps=1500", "render.far=9"])
    image = tc.render(scene, size=(480, 270), samples=1)
    assert image.statistics["out_of_steps"] == 0
