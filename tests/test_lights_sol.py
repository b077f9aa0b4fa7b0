"""Lights in sol, and those that came with it: what arrives along each geodesic against the area density;
shadows against brute force; light along straight lines of coordinates; suns in every geometry that has them.
"""

import numpy as np
import pytest
from camera_rays import view
from numpy.typing import NDArray

import thurston_cl as tc
from thurston_cl.scene import load_text
from thurston_cl.scene.placement import CameraFrame, Placement

Array = NDArray[np.float64]

SIZE = (40, 30)
RADIUS = 0.5
CENTRE = [0.1, 0.0, 0.1]
SAMPLES = 100
# What a render and samples may disagree about: geodesics that pass an object this closely, or leave their own
# surface this flatly.
GRAZING = 0.02
OWN_SURFACE = 0.1
FULL = "{color: white, specular: 0, diffuse: 1, ambient: 0}"
# At z = -0.6 and at x = 0.8.
PLANES = {
    "flat": "{normal: [0, 0, 1], offset: -0.6}",
    "hyperbolic": "{normal: [-1, 0, 0], offset: -0.732668256}",
}
BOTH_PRECISIONS = pytest.mark.parametrize("precision", ["single", "double"])


def scene_text(geometry: str, light: str, plane: str = PLANES["flat"]) -> str:
    """A ball over a plane, both white and dull."""
    return f"""
geometry: {geometry}
camera: {{at: [-1.6, -0.6, 1.2], look: {{to: [0, 0, -0.2]}}, fov: 100 deg}}
objects:
  - ball: {{radius: {RADIUS}}}
    at: {CENTRE}
    material: {FULL}
  - half-space: {plane}
    material: {FULL}
lights:
  - {light}
render: {{far: 6, threshold: 1.0e-4, steps: 4000}}
"""


class Stage:
    """What is seen of a ball over a plane: points (N,4), which of them are on the ball, normals (N,3)."""

    def __init__(self, geometry: str, plane: str = PLANES["flat"]) -> None:
        self.g = tc.Geometry(geometry, "double", lanes=8)
        self._plane, self.flat = plane, plane == PLANES["flat"]
        self._text = scene_text(geometry, "point: {at: [0, 0, 1]}", plane)
        scene, place = load_text(self._text), Placement(self.g)
        self.camera, self.ball = CameraFrame(scene.camera, place), place.point((0.1, 0.0, 0.1))
        image = tc.render(scene, size=SIZE, samples=1, precision="double", lanes=8)
        depth, seen = (image.channels[name].ravel() for name in ("depth", "object"))
        self.hit = seen > 0
        rays = view(self.camera, SIZE, scene.camera.fov)[self.hit]
        self.points = self.g.flow(rays, depth[self.hit].astype(float), base=self.camera.point)[0]
        self.on_ball = seen[self.hit] == 1
        assert self.on_ball.sum() > 12 and (~self.on_ball).sum() > 100
        self.normals = image.channels["normal"].reshape(-1, 3)[self.hit].astype(float)
        u, lengths = self.g.geodesics(self.points[self.on_ball], 1, base=self.ball)
        arriving = self.g.flow(u[:, 0], lengths[:, 0], base=self.ball)[1]
        if geometry == "sol":
            assert np.abs(arriving - self.normals[self.on_ball]).max() < 1e-3

    def seen(self, light: str, precision: str) -> Array:
        """What a render shows (N,) of the points in a light."""
        scene = load_text(scene_text(self.g.name, light, self._plane))
        image = tc.render(scene, size=SIZE, samples=1, precision=precision, lanes=8)
        np.testing.assert_array_equal(image.channels["object"].ravel() > 0, self.hit)
        assert image.statistics["nan"] == 0
        return np.asarray(image.channels["beauty"].reshape(-1, 3)[self.hit, 0].astype(float))

    def above_plane(self, p: Array) -> Array:
        """How far points (N,4) are outside the half-space, in sol."""
        return p[:, 2] + 0.6 if self.flat else np.arcsinh((0.8 - p[:, 0]) * np.exp(-p[:, 2]))

    def hidden(
        self, u: Array, lengths: Array, points: Array, on_ball: Array
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Whether geodesics meet an object, and whether that is clear, from samples of them."""
        count = len(points)
        times = lengths[:, None] * np.linspace(0, 1, SAMPLES)
        way = self.g.flow(
            np.repeat(u, SAMPLES, axis=0), times.ravel(), base=np.repeat(points, SAMPLES, axis=0)
        )[0]
        ball = self.g.distance(way, np.broadcast_to(self.ball, way.shape)) - RADIUS
        least = np.full(count, np.inf)
        for of_ball, gap in ((True, ball), (False, self.above_plane(way))):
            leaving = (on_ball == of_ball)[:, None] & (times < OWN_SURFACE)
            least = np.minimum(least, np.where(leaving, np.inf, gap.reshape(count, SAMPLES)).min(axis=1))
        return least < 0, np.abs(least) > GRAZING


@pytest.fixture(scope="module", params=PLANES)
def stage(request: pytest.FixtureRequest) -> Stage:
    return Stage("sol", PLANES[request.param])


@BOTH_PRECISIONS
@pytest.mark.parametrize(("light", "count"), [([0.4, 1.2], 1), ([8, 0.5], 3)], ids=["near", "far"])
def test_light_and_shadow_along_each_geodesic(
    stage: Stage, light: list[float], count: int, precision: str
) -> None:
    """1/area density along each of them, and nothing where a sample of it lies in an object."""
    g, p, (y, z) = stage.g, stage.points, light
    place = [y if stage.flat else -y - 1, y, z, 1]
    u, lengths = g.geodesics(np.array([place]), count, base=p)
    bare, shaded = np.zeros(len(p)), np.zeros(len(p))
    sure = np.ones(len(p), bool)
    hidden_share = []
    for k in range(count):
        there = np.isfinite(lengths[:, k])
        toward, length, here = u[there, k], lengths[there, k], p[there]
        facing = np.maximum(np.sum(stage.normals[there] * toward, axis=1), 0)
        given = facing / np.maximum(g.area_density(toward, length), 1e-6)
        hidden, clear = stage.hidden(toward, length, here, stage.on_ball[there])
        bare[there] += given
        shaded[there] += np.where(hidden, 0, given)
        sure[there] &= clear | (given == 0)
        hidden_share.append(hidden[given > 0].mean() if (given > 0).any() else 0)
    written = f"point: {{at: {{model: {place}}}, geodesics: {count}}}"
    tolerance = 2e-2 if precision == "single" else 2e-3
    # Next to a focus the area density changes faster than a hit is known.
    calm = bare < 30
    assert calm.mean() > 0.9 and (bare > 0).mean() > 0.3
    got = stage.seen(written, precision)
    off = np.abs(got - bare) / (1 + bare)
    assert (off[calm] < tolerance).mean() > 0.995, np.sort(off[calm])[-8:]
    got = stage.seen(f"{written}\n    shadows: hard", precision)
    off = np.abs(got - shaded) / (1 + shaded)
    assert (off[calm & sure] < tolerance).mean() > 0.99, np.sort(off[calm & sure])[-8:]
    assert sure.mean() > 0.8 and max(hidden_share) > 0.02, (sure.mean(), hidden_share)


@pytest.mark.parametrize("geometry", ["nil", "sl2", "sol"])
def test_light_along_straight_lines(geometry: str) -> None:
    """From where the light has its coordinates, seen from the point."""
    stage = Stage(geometry)
    light = Placement(stage.g).point((0.5, 0.4, 1.2))
    q = stage.g.untranslate(stage.points, light)
    to = q[:, [0, 1, 3]] if geometry == "sl2" else q[:, :3]
    length = np.linalg.norm(to, axis=1)
    facing = np.maximum(np.sum(stage.normals * to, axis=1) / length, 0)
    assert (facing > 0).mean() > 0.3
    for falloff, want in (("", facing), (", falloff: inverse", facing / length)):
        got = stage.seen(f"point: {{at: [0.5, 0.4, 1.2], direction: straight{falloff}}}", "single")
        assert (np.abs(got - want) < 2e-3).mean() > 0.99, (falloff, np.abs(got - want).max())


@pytest.mark.parametrize("geometry", ["e3", "s2xe", "h2xe", "nil", "sl2", "sol"])
def test_suns(geometry: str) -> None:
    """As bright everywhere as the surface faces them; a ball is in the shadow of itself and throws one."""
    stage, up = Stage(geometry), np.array([0.0, 0.0, 1.0])
    toward = np.array([0.6, 0.0, 0.8]) if geometry == "e3" else up
    written = f"sun: {{from: {toward.tolist()}, intensity: 0.5}}"
    want = 0.5 * np.maximum(stage.normals @ toward, 0)
    got = stage.seen(written, "single")
    assert np.abs(got - want).max() < 1e-3
    shaded = stage.seen(f"{written}\n    shadows: hard", "single")
    times = np.linspace(0, 4, 161)
    u = np.broadcast_to(toward, stage.normals.shape)
    gaps = []
    for t in times:
        way = stage.g.flow(u, np.full(len(u), t), base=stage.points)[0]
        gap = stage.g.distance(way, np.broadcast_to(stage.ball, way.shape)) - RADIUS
        gaps.append(np.where(stage.on_ball & (t < OWN_SURFACE), np.inf, gap))
    least = np.min(gaps, axis=0)
    clear = (np.abs(least) > GRAZING) & (want > 0.02)
    assert clear.mean() > 0.5
    expected = np.where(least < 0, 0, want)
    assert np.abs(shaded - expected)[clear].max() < 1e-3
    assert 2 < (least < 0)[clear].sum() < 0.5 * clear.sum()


def test_area_divided_by_light_is_the_same_along_vertical_lines() -> None:
    """What sun.h says: a vertical bundle of geodesics keeps its area, at any height."""
    for geometry in ("s2xe", "h2xe", "nil", "sl2", "sol"):
        g, step = tc.Geometry(geometry, "double", lanes=1), 1e-5
        corners = g.flow(np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]]), np.full(4, step))[0]
        moved = g.flow(np.tile([0.0, 0, 1], (4, 1)), np.full(4, 1.5), base=corners)[0]
        middle = g.flow([0.0, 0, 1], np.array([1.5]))[0]
        v = np.array([g.untranslate(middle, q[None])[0] for q in moved])
        a, b = (v[0] - v[1])[:2] / (2 * step), (v[2] - v[3])[:2] / (2 * step)
        assert a[0] * b[1] - a[1] * b[0] == pytest.approx(1, abs=1e-6), geometry
