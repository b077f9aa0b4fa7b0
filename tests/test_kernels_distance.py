"""kernels/shape: signed distance functions against independent ones, their gradients, coordinates and slopes.

What they should be is found without their formulas: the nearest point of an axis, a plane or a set of centres
is searched for with the distance of tests/golden.py, and a horoball is the limit of balls.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from golden import EPSILON, MP, Array, distance, exact
from scipy.optimize import minimize
from small_kernels import Body, SmallKernels

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.program import geometry_parts
from thurston_cl.scene.writer import shape_parts

GEOMETRIES = ("e3", "s3", "h3")
LANES = 16
ORIGIN = np.array([0.0, 0, 0, 1])
RADIUS = 0.4
OFFSET = -0.35
CENTRES = 4  # of the set of balls, first in the scene's numbers after their radius

DISTANCES = {
    "ball": "ball_{}(p, number(scene, 0))",
    "cylinder": "cylinder_{}(p, number(scene, 0))",
    "half_space": "half_space_{}(p)",
    "horoball": "horoball_{}(p, number(scene, 0))",
    "ball_set": f"ball_set_{{}}(p, scene, 1, {CENTRES}, number(scene, 0))",
}
# Gradients are wanted in the frame at the point.
OUTPUTS = """scene_data scene = {numbers, 0};
  point p = POINT(0);
  surface s = SURFACE;
  direction g = pull_covector(p, s.gradient);
  OUT(0, DISTANCE); OUT(1, s.distance); OUT(2, g.x); OUT(3, g.y); OUT(4, g.z); OUT(5, s.u); OUT(6, s.v);"""
SETS = {
    "union": "union_of(a, b)",
    "intersection": "intersection_of(a, b)",
    "difference": "intersection_of(a, complement_of(b))",
}


def body(call: str) -> Body:
    text = OUTPUTS.replace("SURFACE", call.format("surface")).replace("DISTANCE", call.format("distance"))
    return Body(4, 7, text)


def set_body(call: str) -> Body:
    return Body(
        4,
        5,
        f"""point p = POINT(0);
  surface a = ball_surface(p, REAL({RADIUS})), b = half_space_surface(p), s = {call};
  direction g = pull_covector(p, s.gradient);
  OUT(0, s.distance); OUT(1, g.x); OUT(2, g.y); OUT(3, g.z); OUT(4, s.u);""",
    )


class Setting(NamedTuple):
    g: Geometry
    kernels: SmallKernels

    @property
    def epsilon(self) -> float:
        return EPSILON[self.g.precision]

    @property
    def shapes(self) -> list[str]:
        return [name for name in DISTANCES if name != "horoball" or self.g.name == "h3"]

    def numbers(self, shape: str) -> Array:
        """The numbers of the scene: radius or offset, then the centres."""
        first = OFFSET if shape == "horoball" else RADIUS
        return np.concatenate([[first], centres(self.g.name).ravel()])

    def run(self, shape: str, points: Array) -> Array:
        """distance, the surface's distance, its gradient in the frame (3), its two coordinates: (7, N)."""
        return self.kernels.run(shape, points.T, self.numbers(shape)).astype(np.float64)


@pytest.fixture(scope="module", params=[(n, p) for n in GEOMETRIES for p in EPSILON], ids="-".join)
def at(request: pytest.FixtureRequest, opencl_device: Device) -> Setting:
    name, precision = request.param
    shapes = [shape for shape in DISTANCES if shape != "horoball" or name == "h3"]
    bodies = {shape: body(DISTANCES[shape]) for shape in shapes}
    bodies |= {name: set_body(call) for name, call in SETS.items()}
    parts = (*geometry_parts(name), "scene_types.h", *sorted(shape_parts(name, shapes)))
    kernels = SmallKernels(opencl_device, parts, bodies, precision, LANES)
    return Setting(Geometry(name, precision, opencl_device, lanes=LANES), kernels)


def exponential(geometry: str, vectors: Array) -> Array:
    """Points (N,4) that geodesics from the origin along vectors (N,3) reach after their length."""
    r = np.linalg.norm(vectors, axis=1)[:, None]
    sine, cosine = {"e3": (r, 1 + 0 * r), "s3": (np.sin(r), np.cos(r)), "h3": (np.sinh(r), np.cosh(r))}[
        geometry
    ]
    return np.concatenate([vectors * np.where(r > 0, sine / np.where(r > 0, r, 1), 1), cosine], axis=1)


def some_points(geometry: str, count: int = 40, reach: float = 1.1) -> Array:
    """Points (N,4) all around the origin, whose coordinates are numbers of either precision."""
    vectors = np.random.default_rng(21).uniform(-reach, reach, (count, 3))
    points = exponential(geometry, vectors)
    points[:, :3] = points[:, :3].astype(np.float32)
    square = (points[:, :3] ** 2).sum(axis=1)
    height = {"e3": 1 + 0 * square, "s3": np.sqrt(np.maximum(1 - square, 0)), "h3": np.sqrt(1 + square)}[
        geometry
    ]
    points[:, 3] = np.copysign(height, points[:, 3])
    return points


def centres(geometry: str) -> Array:
    vectors = np.array([[0.7, 0, 0.2], [-0.5, 0.6, 0], [0, -0.8, -0.3], [0.1, 0.2, 0.9]])
    return exponential(geometry, vectors)


def far_apart(geometry: str, p: Array, q: Array) -> Array:
    """Distances (N,) in double, good away from 0 (and from pi): for searching only."""
    if geometry == "e3":
        return np.linalg.norm(p - q, axis=-1)
    product = (p[..., :3] * q[..., :3]).sum(axis=-1)
    if geometry == "s3":
        return np.arccos(np.clip(product + p[..., 3] * q[..., 3], -1, 1))
    return np.arccosh(np.maximum(p[..., 3] * q[..., 3] - product, 1))


def nearest(geometry: str, point: Array, embed: Callable[[Array], Array], dimension: int) -> float:
    """The least distance of a point from the image of `embed`, searched for on a grid and then by descent."""
    line = np.linspace(-2, 2, 41 if dimension == 2 else 401)
    grid = np.stack(np.meshgrid(*[line] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    start = grid[far_apart(geometry, embed(grid), point).argmin()]

    def length(parameters: Array) -> float:
        return float(far_apart(geometry, embed(parameters[None]), point)[0])

    found = minimize(length, start, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-15})
    foot = embed(found.x[None])
    return float(distance(geometry, exact(foot), exact(point[None]))[0])


def on_axis(geometry: str) -> Callable[[Array], Array]:
    return lambda s: exponential(geometry, np.concatenate([np.zeros((len(s), 2)), s], axis=1))


def on_plane(geometry: str) -> Callable[[Array], Array]:
    return lambda s: exponential(geometry, np.concatenate([s, np.zeros((len(s), 1))], axis=1))


def expected(geometry: str, shape: str, points: Array) -> Array:
    """Signed distances (N,), negative inside."""
    if shape == "ball":
        origin = np.broadcast_to(ORIGIN, points.shape)
        return distance(geometry, exact(origin), exact(points)).astype(float) - RADIUS
    if shape == "cylinder":
        return np.array([nearest(geometry, p, on_axis(geometry), 1) for p in points]) - RADIUS
    if shape == "half_space":
        return np.array([np.sign(p[2]) * nearest(geometry, p, on_plane(geometry), 2) for p in points])
    if shape == "ball_set":
        to_each = [
            distance(geometry, exact(np.broadcast_to(c, points.shape)), exact(points))
            for c in centres(geometry)
        ]
        return np.min(to_each, axis=0).astype(float) - RADIUS
    # Balls through the point of the z-geodesic at -offset whose centres go to infinity along it.
    far = MP.mpf(40)
    centre = exact(np.broadcast_to(ORIGIN, points.shape))
    centre[:, 2], centre[:, 3] = MP.sinh(far), MP.cosh(far)
    return (distance("h3", centre, exact(points)) - far).astype(float) + OFFSET


def test_distances_are_those_found_by_search(at: Setting) -> None:
    points = some_points(at.g.name)
    for shape in at.shapes:
        got = at.run(shape, points)
        want = expected(at.g.name, shape, points)
        # The search ends within 1e-9 of the foot, where the distance is stationary: an error of the order
        # 1e-16.
        np.testing.assert_allclose(got[0], want, atol=16 * at.epsilon, err_msg=shape)
        np.testing.assert_array_equal(got[1], got[0], err_msg=shape)


def test_signs(at: Setting) -> None:
    """Negative inside, positive outside, zero on the surface."""
    ways = {
        "ball": ([1, 0, 0], RADIUS),
        "cylinder": ([0, 1, 0], RADIUS),
        "half_space": ([0, 0, 1], 0.0),
        "horoball": ([0, 0, -1], -OFFSET),
    }
    for shape, (way, surface) in ways.items():
        if shape in at.shapes:
            along = np.array([-0.2, -1e-3, 0, 1e-3, 0.2])
            got = at.run(shape, exponential(at.g.name, (surface + along)[:, None] * np.array(way)))
            np.testing.assert_allclose(got[0], along, atol=8 * at.epsilon, err_msg=shape)


def test_far_away_horoballs_keep_their_digits(at: Setting) -> None:
    """Towards the ideal point w - z cancels; the formula changes at z = 0."""
    if at.g.name == "h3":
        s = np.array([-10, -5, -1, -1e-3, -1e-7, 0, 1e-7, 1e-3, 1, 5, 10, 15.0])
        got = at.run("horoball", exponential("h3", s[:, None] * np.array([0, 0, 1])))
        np.testing.assert_allclose(got[0], OFFSET - s, rtol=8 * at.epsilon, atol=2 * at.epsilon)


def test_s3_cylinder_near_the_farthest_circle(at: Setting) -> None:
    """A quarter turn from the axis lies a circle, a geodesic, about which the rest is a cylinder again."""
    if at.g.name == "s3":
        away = np.array([1e-1, 1e-2, 1e-3, 1e-4, 1e-6])
        turn = np.linspace(0, 6, len(away))
        points = np.stack([np.cos(turn), np.sin(turn), 0 * turn, 0 * turn], axis=1) * np.cos(away)[:, None]
        points[:, 2], points[:, 3] = np.sin(away) * 0.6, np.sin(away) * 0.8
        got = at.run("cylinder", points)[0] + RADIUS
        np.testing.assert_allclose(np.pi / 2 - got, away, atol=4 * at.epsilon)


def test_slopes_are_at_most_1(at: Setting) -> None:
    """Along any geodesic a distance changes by no more than the length gone: no surface is jumped over."""
    rng = np.random.default_rng(22)
    base = some_points(at.g.name, 2000, 0.9)
    u = rng.normal(size=(len(base), 3))
    u /= np.linalg.norm(u, axis=1)[:, None]
    length = 10 ** rng.uniform(-4, 0.2, len(base))
    end, _ = at.g.flow(u, length, base)
    for shape in at.shapes:
        change = np.abs(at.run(shape, end)[0] - at.run(shape, base)[0])
        size = np.maximum(base[:, 3], end[:, 3]) if at.g.name == "h3" else 1
        assert (change <= length + 16 * at.epsilon * size).all(), shape


def test_gradients_point_where_the_distance_grows(at: Setting) -> None:
    """The gradient in the frame, brought to length 1, is the one of central differences along geodesics."""
    points = some_points(at.g.name)
    step = 1e-5 if at.g.precision == "double" else 1e-2
    for shape in at.shapes:
        got = at.run(shape, points)
        gradient = got[2:5].T
        gradient /= np.linalg.norm(gradient, axis=1)[:, None]
        columns = []
        for e in np.eye(3):
            ahead, behind = (at.run(shape, at.g.flow(e, sign * step, points)[0])[0] for sign in (1, -1))
            columns.append((ahead - behind) / (2 * step))
        difference = np.stack(columns, axis=1)
        # Not next to the axis or the centre, nor where two balls of a set are equally near.
        smooth = got[0] + RADIUS > 0.3
        if shape == "ball_set":
            nearest_two = np.sort([far_apart(at.g.name, c, points) for c in centres(at.g.name)], axis=0)[:2]
            smooth &= nearest_two[1] - nearest_two[0] > 4 * step
        assert smooth.mean() > 0.5, shape
        off = np.abs(gradient - difference)[smooth].max()
        assert off <= (1e-8 if at.g.precision == "double" else 3e-3), (shape, off)


def test_coordinates_on_the_surfaces(at: Setting) -> None:
    g = at.g
    # Ball: longitude and latitude.
    longitude, latitude = np.array([-3, -1, 0.5, 2.5]), np.array([-1.2, 0, 0.3, 1.5])
    vectors = RADIUS * np.stack(
        [np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)], axis=1
    )
    got = at.run("ball", exponential(g.name, vectors))[5:]
    want = [longitude / (2 * np.pi) + 0.5, latitude / np.pi + 0.5]
    np.testing.assert_allclose(got, want, atol=8 * at.epsilon)
    # Cylinder: angle, and length along the axis. Half-space: length along the x-geodesic, and distance from
    # it.
    s, angle = np.array([-1, -0.2, 0, 0.4, 1.3]), np.array([-3, -1, 0.5, 1, 3])
    axis_points = exponential(g.name, s[:, None] * np.array([0, 0, 1]))
    radial = RADIUS * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    got = at.run("cylinder", g.translate(axis_points, exponential(g.name, radial)))[5:]
    np.testing.assert_allclose(got, [angle / (2 * np.pi) + 0.5, s], atol=16 * at.epsilon)
    x_points = exponential(g.name, s[:, None] * np.array([1, 0, 0]))
    beside = np.array([0.3, -0.7, 0, 1, -1.2])
    got = at.run(
        "half_space", g.translate(x_points, exponential(g.name, beside[:, None] * np.array([0, 1, 0])))
    )
    np.testing.assert_allclose(got[[0, 5, 6]], [np.zeros(5), s, beside], atol=16 * at.epsilon)


def test_coordinates_stay_finite_far_away(at: Setting) -> None:
    """A scene of the whole space sees surfaces at a distance; what is drawn on them must not become NaN."""
    if at.g.name == "h3":
        rng = np.random.default_rng(23)
        u = rng.normal(size=(3000, 3))
        u /= np.linalg.norm(u, axis=1)[:, None]
        u[::3] = u[::3] * [1e-3, 1e-3, 1]  # along the axis of the cylinder
        u[1::3] = u[1::3] * [1, 1e-3, 1e-3]
        reach = rng.uniform(0, 12 if at.g.precision == "single" else 25, len(u))
        points = exponential("h3", u * (reach / np.linalg.norm(u, axis=1))[:, None])
        for shape in at.shapes:
            assert np.isfinite(at.run(shape, points)).all(), shape


def test_the_length_along_the_axis_far_away(at: Setting) -> None:
    """On a thin cylinder (w - z)(w + z) is nearly 1, whatever w and z."""
    if at.g.name == "h3":
        s = np.array([-9, -7, -5, 5, 6, 8, 10.0])
        got = at.run("cylinder", exponential("h3", s[:, None] * np.array([0, 0, 1])))[6]
        np.testing.assert_allclose(got, s, rtol=1e-5 if at.g.precision == "single" else 1e-13)


def test_sets_of_shapes(at: Setting) -> None:
    """Ball and half-space: a set takes distance, gradient and coordinate of one of them."""
    points = some_points(at.g.name, 500, 0.7)
    a, b = at.run("ball", points), at.run("half_space", points)
    choices = {"union": (a[0] < b[0], b), "intersection": (a[0] > b[0], b), "difference": (a[0] > -b[0], -b)}
    for name, (takes_a, other) in choices.items():
        got = at.kernels.run(name, points.T).astype(float)
        want = np.where(takes_a, a, other)
        assert 50 < takes_a.sum() < 450
        np.testing.assert_array_equal(got[:4], want[[0, 2, 3, 4]], err_msg=name)
        # The complement turns a surface inside out but does not renumber what is drawn on it.
        np.testing.assert_array_equal(got[4], np.where(takes_a, a[5], b[5]), err_msg=name)
