"""Errors of pictures: half a pixel as an angle, angle errors against the geodesics that lead to a point, what
counts as seen, and the truth that they are measured against.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from camera_rays import view
from golden import Array

from thurston_cl.accuracy import rays as rays_module
from thurston_cl.accuracy.pictures import Errors, _refined, all_places, compare, errors, quantiles, worst
from thurston_cl.accuracy.rays import Ends, ExactRays, Offsets, Places, Rays
from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.method import Method
from thurston_cl.models import GEOMETRIES, LEFT_INVARIANT
from thurston_cl.program import Source, kernel_text
from thurston_cl.scene import load_scene, load_text
from thurston_cl.scene.pixel import half_pixel, half_pixels
from thurston_cl.scene.placement import CameraFrame, Placement
from thurston_cl.scene.schema import Scene

SIZE = (40, 24)
FOV = math.pi / 3

# One for each way in which rays are led back into a cell.
QUOTIENTS = (
    "e3/three-torus-ball",
    "s3/poincare-ball",
    "h3/seifert-weber",
    "s2xe/hopf-manifold-tile",
    "h2xe/genus-two-tile",
    "nil/heisenberg-tile",
    "sl2/genus-two-tile",
    "sol/anosov-globes",
)


def whole_space(geometry: str) -> Scene:
    """A scene without a manifold, with the camera off the origin."""
    return load_text(
        f"geometry: {geometry}\n"
        "camera: {at: [0.2, -0.1, 0.3], look: {along: [0.5, 0.7, 0.4]}, fov: 60 deg}\n"
        "objects: [{ball: {radius: 0.1}, at: [0.9, 0.9, 0.9]}]\n"
    )


def directions(scene: Scene, device: Device) -> tuple[Array, Array]:
    """Where the camera stands (4,), and the directions (N,3) of the middles of the pixels of a picture."""
    camera = CameraFrame(scene.camera, Placement(Geometry(scene.geometry, device=device, lanes=1)))
    return camera.point, view(camera, SIZE, FOV)


def turned_aside(u: Array, angle: Array, seed: int) -> Array:
    """Unit directions (N,3) turned by angles (N,) towards something across."""
    across = np.cross(u, np.random.default_rng(seed).normal(size=u.shape))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * across


def ends_at(geometry: Geometry, point: Array, direction: Array, length: Array) -> Ends:
    """What rays would come to that hit something at these points."""
    velocity = np.concatenate([direction, np.zeros((len(point), 1))], axis=1)
    if geometry.name not in LEFT_INVARIANT:
        velocity = geometry.velocity(point, direction)
    flags = np.ones(len(point), dtype=bool)
    objects = flags.astype(np.intp)
    return Ends(length, 0 * length, flags, flags, ~flags, point, velocity, objects, flags * 1.0, 0 * length)


def mismatch(a: Array, b: Array) -> Array:
    """The angles (N,) between unit vectors, exact for small ones."""
    return 2 * np.arcsin(np.minimum(1, np.linalg.norm(a - b, axis=1) / 2))


class TestHalfAPixel:
    @pytest.mark.parametrize(("width", "degrees"), [(1000, 2.8e-2), (5000, 5.6e-3)])
    def test_it_is_what_the_paper_says(self, width: int, degrees: float) -> None:
        assert math.degrees(half_pixel(width, math.radians(100))) == pytest.approx(degrees, rel=0.02)

    @pytest.mark.parametrize("angle", [0.3, 1.0, 2.0, 3.0])
    def test_at_the_border_it_is_the_difference_of_two_angles(self, angle: float) -> None:
        width, edge = 640, math.tan(angle / 2)
        beyond = math.atan(edge * (1 + 1 / width)) - math.atan(edge)
        assert half_pixel(width, angle) == pytest.approx(beyond, rel=1e-9)

    @pytest.mark.parametrize(("width", "angle"), [(0, 1.0), (100, 0.0), (100, math.pi), (100, math.nan)])
    def test_what_is_no_picture_is_told(self, width: int, angle: float) -> None:
        with pytest.raises(ValueError, match=r"a picture .* pixels wide"):
            half_pixel(width, angle)

    def test_in_a_perspective_it_is_the_smaller_the_farther_out(self) -> None:
        scene = whole_space("e3")
        width, height = 300, 200
        across = 2 * math.atan(math.tan(FOV / 2) * width / height)
        found = half_pixels(scene.camera, (width, height), [150, 300], [100, 100])
        assert found[0] == pytest.approx(math.atan(math.tan(FOV / 2) / height), rel=1e-12)
        assert found[1] == pytest.approx(half_pixel(width, across), rel=1e-9)

    @pytest.mark.parametrize(
        ("camera", "size", "expected"),
        [
            ("{projection: {equirectangular: {}}}", (200, 100), math.pi / 200),
            ("{projection: {fisheye: {angle: 180 deg}}}", (300, 100), math.pi / 200),
            ("{projection: {dome: {angle: 90 deg}}}", (100, 300), math.pi / 400),
            (
                "{projection: {equirectangular: {}}, stereo: {layout: top-bottom, distance: 0.1}}",
                (200, 200),
                math.pi / 200,
            ),
        ],
    )
    def test_in_other_projections_it_is_the_same_everywhere(
        self, camera: str, size: tuple[int, int], expected: float
    ) -> None:
        scene = load_text(f"geometry: e3\ncamera: {camera}\nobjects: [{{ball: {{radius: 0.1}}}}]\n")
        found = half_pixels(scene.camera, size, [0, 50, 99], [0, 50, 3])
        np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("longest", [2.0, 9.0])
def test_angles_are_those_to_the_geodesics_that_lead_to_the_point(
    geometry: str, longest: float, opencl_device: Device
) -> None:
    scene = whole_space(geometry)
    exact = ExactRays(scene, opencl_device, SIZE)
    places, space = all_places(scene, SIZE), Geometry(geometry, device=opencl_device)
    eye, u = directions(scene, opencl_device)
    random = np.random.default_rng(5)
    count = len(u)
    angle, length = 10 ** random.uniform(-6, -2, count), random.uniform(0.5, longest, count)
    aside = turned_aside(u, angle, seed=6)
    point, arriving = space.flow(aside, length, eye)
    # The nearest of the geodesics that lead there, of as many as may be in between.
    way, _ = space.geodesics(point, 1 if geometry in ("e3", "h3", "h2xe") else 9, eye)
    truth = np.nanmin(np.stack([mismatch(u, way[:, k]) for k in range(way.shape[1])]), axis=0)
    assert np.all(truth <= angle * (1 + 1e-6) + 1e-12)

    none, nowhere = np.zeros((count, 2)), np.zeros(count)
    ends = ends_at(space, point, arriving, length)
    first = exact.offsets(places, none, length, ends, nowhere)
    # What is left out, over what moves the point the least.
    small = first.distance**2 * first.widest[1] / first.area < 3e-3 * truth
    assert small.mean() > 0.2
    near = np.abs(np.hypot(*first.turn.T) / truth - 1)[small]
    assert near.max() < 0.01

    # Rays that took another length to come there: that is no error of the angle.
    ends = ends_at(space, point, arriving, length + random.uniform(-1e-2, 1e-2, count))
    first = exact.offsets(places, none, ends.length, ends, nowhere)
    found = _refined(exact, places, ends, first.turn, first, np.full(count, 1e-7))
    good = np.abs(found - truth) <= 0.02 * truth + 1e-12
    # Near a fold of the wave front Newton's method may find neither of the two that meet there; nor does it
    # come to what is many units away.
    within = first.distance < 2
    assert within.mean() > 0.9
    assert good[within].mean() >= 0.98
    # All the same they are told from what is right.
    assert ((found > 1e-3) == (truth > 1e-3)).mean() > 0.998


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_fields_cover_the_area_density(geometry: str, opencl_device: Device) -> None:
    scene = whole_space(geometry)
    exact = ExactRays(scene, opencl_device, SIZE)
    places, space = all_places(scene, SIZE), Geometry(geometry, device=opencl_device)
    eye, u = directions(scene, opencl_device)
    length = np.random.default_rng(1).uniform(0.1, 9, len(u))
    point, arriving = space.flow(u, length, eye)
    found = exact.offsets(
        places, np.zeros((len(u), 2)), length, ends_at(space, point, arriving, length), 0 * length
    )
    density = np.abs(space.area_density(u, length))
    # What is small because the fields are nearly parallel has the rounding of the larger.
    scale = np.maximum(density, found.widest[1] ** 2)
    assert np.all(np.abs(found.area - density) <= 1e-6 * scale + 1e-7)
    # The point is where it should be.
    assert found.distance.max() < 1e-11 * np.exp(9 if geometry in ("h3", "h2xe", "sl2", "sol") else 0)


@pytest.mark.parametrize("name", QUOTIENTS)
def test_a_shift_in_the_picture_comes_back_as_its_angle_in_a_manifold(
    name: str, opencl_device: Device
) -> None:
    """What the true rays of places beside come to, taken for the answers of the places: over walls, too."""
    scene = load_scene(name)
    exact = ExactRays(scene, opencl_device, SIZE)
    places = all_places(scene, SIZE)
    for shift, is_over in ((0.2, False), (0.8, True)):
        beside = Places(places.eye, places.pixel, places.shift + shift * np.array([0.6, -0.8]))
        ends = exact.trace(beside)
        found = compare(exact, exact, places, ends)
        _, u = exact.starts(places)
        _, v = exact.starts(beside)
        expected = mismatch(u, v)
        # Farther away a pixel covers so much that other images are nearer.
        hit = (ends.object > 0) & (ends.length < 3) & (found.truth.length < 3)
        assert hit.mean() > 0.2
        # A fold may lie between, behind which another direction is nearer or none is found.
        near = np.abs(found.angle / expected - 1)[hit] < 0.01
        assert near.mean() > 0.98, name
        assert found.over[hit].mean() > 0.98 if is_over else found.over[hit].mean() < 0.01, name


@pytest.mark.parametrize("name", QUOTIENTS)
def test_double_is_without_error_and_single_near_rounding(name: str, opencl_device: Device) -> None:
    scene = load_scene(name)
    exact = ExactRays(scene, opencl_device, SIZE)
    places = all_places(scene, SIZE)
    truth = exact.trace(places)
    assert not (truth.lost | truth.out_of_steps).any()
    itself = compare(exact, exact, places, truth, truth).summary
    assert itself["over_half_pixel"] == itself["ids_differ"] == itself["nan"] == 0
    assert itself["depth"] is None or itself["depth"]["max"] == 0
    assert itself["angle"] is not None
    assert itself["angle"]["99"] < 1e-14
    single = errors(scene, Method(), opencl_device, SIZE)
    near = single.angle[(single.method.object > 0) & (single.method.length < 8)]
    # And it is no copy of the truth.
    assert np.quantile(near, 0.99) < 2e-6
    assert np.median(near) > 1e-9
    assert single.summary["angle_pixels"]["99"] < 0.01
    assert single.summary["over_half_pixel"] < 2e-3


@pytest.mark.parametrize(
    ("name", "changes", "least", "angle"),
    [
        ("h3/seifert-weber", {"flow": "euler", "step": 0.1}, 0.1, 5e-3),
        ("nil/heisenberg-tile", {"flow": "euler", "step": 0.1}, 0.1, 5e-3),
        ("s2xe/hopf-manifold-tile", {"flow": "rk2", "step": 2.0}, 0.1, 5e-3),
        # A coarse threshold leaves angles alone: rays end on the way.
        ("nil/heisenberg-tile", {"threshold": 3e-2}, 0.1, 0.0),
        ("e3/hantzsche-wendt-balls", {"threshold": 3e-2}, 0.05, 0.0),
    ],
)
def test_a_method_that_is_wrong_is_found_out(
    name: str, changes: dict[str, object], least: float, angle: float, opencl_device: Device
) -> None:
    scene = load_scene(name)
    found = errors(scene, Method.of(scene, **changes), opencl_device, SIZE).summary
    assert found["over_half_pixel"] > least
    assert found["angle"] is not None
    assert found["angle"]["50"] > angle if angle else found["angle"]["99"] < 2e-6


TWO_BALLS = """
geometry: e3
camera: {at: [-3, 0, 0], look: {along: [1, 0, 0]}, fov: 40 deg}
objects:
  - union:
      - {ball: {radius: 0.2}, at: [0, 0, 0]}
      - {ball: {radius: 1.0}, at: [3, 0, 0]}
"""


def behind_the_first(scene: Scene, device: Device) -> Errors:
    """The errors of rays that have not noticed the front ball of an object."""
    front = load_text(
        TWO_BALLS.replace("{ball: {radius: 0.2}, at: [0, 0, 0]}", "{ball: {radius: 1.0}, at: [3, 0, 0]}")
    )
    exact = ExactRays(scene, device, SIZE)
    places = all_places(scene, SIZE)
    return compare(
        Rays(scene, Method(), device, SIZE), exact, places, ExactRays(front, device, SIZE).trace(places)
    )


def test_another_surface_of_the_same_object_is_no_right_answer(opencl_device: Device) -> None:
    found = behind_the_first(load_text(TWO_BALLS), opencl_device)
    missed = found.truth.length < 3.1
    assert 5 < missed.sum() < found.over.size / 2
    assert not found.id_differs.any()
    assert found.angle[missed].max() < 1e-12
    # At its edge what is behind it is seen within half a pixel.
    middle = missed & (np.hypot(*(found.places.xy - np.array(SIZE) / 2).T) < 2)
    assert middle.sum() > 3
    assert found.over[middle].all()
    assert not found.over[~missed].any()


def test_what_is_shown_within_half_a_pixel_is_right(opencl_device: Device) -> None:
    """An object that the truth shows a third of a pixel aside is right, and a whole pixel aside is not."""
    scene = load_text(TWO_BALLS)
    exact = ExactRays(scene, opencl_device, SIZE)
    places = all_places(scene, SIZE)
    for shift, right in ((1 / 3, True), (1.0, False)):
        beside = Places(places.eye, places.pixel, places.shift + np.array([shift, 0]))
        found = compare(exact, exact, places, exact.trace(beside))
        edge = found.id_differs
        assert edge.sum() >= 5
        assert found.over[edge].mean() < 0.1 if right else found.over[edge].mean() > 0.5


def test_what_fog_hides_is_not_seen(opencl_device: Device) -> None:
    """Rays that go no farther than 2.5, in front of a wall that fog hides, or does not."""
    text = """
geometry: e3
camera: {look: {along: [1, 0, 0]}}
objects: [{half-space: {normal: [-1, 0, 0], offset: -3}}]
effects: {fog: {linear: {length: AWAY}}}
"""
    for away, hidden in ((2.9, True), (9.0, False)):
        scene = load_text(text.replace("AWAY", str(away)))
        assert (errors(scene, Method(steps=1), opencl_device, SIZE).summary["over_half_pixel"] == 0) == hidden


def test_rays_that_are_lost_show_the_background(opencl_device: Device) -> None:
    scene = load_text(TWO_BALLS)
    exact = ExactRays(scene, opencl_device, SIZE)
    places = all_places(scene, SIZE)
    truth = exact.trace(places)
    lost = np.arange(len(places)) % 2 == 0
    ends = dataclasses.replace(
        truth,
        length=np.where(lost, np.nan, truth.length),
        hit=truth.hit & ~lost,
        object=np.where(lost, 0, truth.object),
    )
    found = compare(exact, exact, places, ends, truth)
    assert found.summary["nan"] == 0.5
    assert not found.over[lost & (truth.object == 0)].any()
    assert found.over[lost & (truth.object > 0)].mean() > 0.8
    assert np.isnan(found.angle[lost]).all()
    first = worst(found, 3)
    assert found.over[first].all()


# What the constants of carry.cl may be as well.
CHOICES = {
    "VERIFY_ASIDE C(1e-8)": "VERIFY_ASIDE C(1e-7)",
    "VERIFY_STEP 1": "VERIFY_STEP C(0.37)",
    "VERIFY_PASSES 64": "VERIFY_PASSES 200",
    "VERIFY_AHEAD 2": "VERIFY_AHEAD 3",
    "VERIFY_ROUNDS 2": "VERIFY_ROUNDS 3",
}


@pytest.mark.parametrize("name", QUOTIENTS)
def test_the_choices_of_carrying_do_not_matter(
    name: str, opencl_device: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = load_scene(name)
    exact, rays = ExactRays(scene, opencl_device, SIZE), Rays(scene, Method(), opencl_device, SIZE)
    places = all_places(scene, SIZE)
    ends = rays.trace(places)
    plain = compare(rays, exact, places, ends)

    text = kernel_text("verify/carry.cl")
    for old, new in CHOICES.items():
        assert old in text
        text = text.replace(old, new)
    of_rays = rays_module._of_rays

    def with_choices(*arguments: Any) -> Source:
        source = of_rays(*arguments)
        return dataclasses.replace(source, generated={**source.generated, "verify/carry.cl": text})

    monkeypatch.setattr(rays_module, "_of_rays", with_choices)
    other = compare(rays, ExactRays(scene, opencl_device, SIZE), places, ends, plain.truth)
    near = (ends.object > 0) & (ends.length < 6)
    np.testing.assert_allclose(other.angle[near], plain.angle[near], rtol=1e-3, atol=1e-11)
    # Which of the images far away is found first may differ, and with it what is over half a pixel.
    assert (other.over != plain.over).mean() < 2e-3


@pytest.mark.parametrize("name", ["h3/seifert-weber", "sl2/genus-two-tile", "sol/anosov-globes"])
@pytest.mark.parametrize("lanes", [4, 8, 16])
def test_every_width_finds_what_one_lane_finds(name: str, lanes: int, opencl_device: Device) -> None:
    scene = load_scene(name)
    # One ray that is none, among others.
    places = all_places(scene, SIZE)[np.arange(0, SIZE[0] * SIZE[1], 7)]

    def found(width: int) -> tuple[Ends, Offsets]:
        exact = ExactRays(scene, opencl_device, SIZE, lanes=width)
        ends = exact.trace(places)
        beside = exact.trace(Places(places.eye, places.pixel, places.shift + 0.1))
        turn = np.zeros((len(places), 2))
        return ends, exact.offsets(places, turn, beside.length, beside, 0 * beside.length)

    (one, one_off), (many, many_off) = found(1), found(lanes)
    # exp and log may differ in the last bit between a scalar and a vector built-in: far away that is much.
    near = one.length < 6
    np.testing.assert_array_equal(many.object[near], one.object[near])
    np.testing.assert_allclose(many.length[near], one.length[near], rtol=0, atol=1e-8)
    np.testing.assert_allclose(many_off.turn[near], one_off.turn[near], rtol=1e-3, atol=1e-7)


def test_a_round_picture_is_judged_inside_its_circle(opencl_device: Device) -> None:
    scene = load_text(
        "geometry: s3\ncamera: {projection: {fisheye: {angle: 180 deg}}}\n"
        "objects: [{ball: {radius: 0.3}, at: [0.6, 0, 0]}]\n"
    )
    found = errors(scene, Method(), opencl_device, (40, 20))
    inside = np.hypot(*(found.places.xy - [20, 10]).T) <= 10
    np.testing.assert_array_equal(found.method.marched, inside)
    assert found.summary["n"] == inside.sum()
    assert not found.over[~inside].any()


def test_both_eyes_are_judged(opencl_device: Device) -> None:
    scene = load_text(
        "geometry: e3\ncamera: {stereo: {layout: side-by-side, distance: 0.4}}\n"
        "objects: [{ball: {radius: 0.5}, at: [2, 0, 0]}]\n"
    )
    found = errors(scene, Method(), opencl_device, (40, 20))
    assert [int((found.places.eye == eye).sum()) for eye in (0, 1)] == [400, 400]
    seen = [found.truth.object[found.places.eye == eye].reshape(20, 20) for eye in (0, 1)]
    # What is near stands farther to the left for the right eye.
    columns = [np.nonzero(picture)[1].mean() for picture in seen]
    assert columns[1] < columns[0] - 1
    assert found.summary["over_half_pixel"] == 0


def test_quantiles_are_values_that_occur() -> None:
    values = np.array([np.nan, *range(1, 1001)], dtype=np.float64)
    assert quantiles(values) == {"50": 501, "95": 951, "99": 991, "99.9": 1000, "max": 1000}
    assert quantiles(np.array([np.nan])) is None
    assert quantiles(np.array([1.0, np.inf])) == {
        "50": math.inf,
        **dict.fromkeys(("95", "99", "99.9", "max"), math.inf),
    }
