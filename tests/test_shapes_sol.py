"""kernels/shape in sol: distances against those of `Geometry` in double precision, the least of which is
searched for where a surface has many points; bounds, that no geodesic of that length meets the surface;
gradients against differences.
"""

import contextlib
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import pytest
from camera_rays import view
from golden import EPSILON, Array
from numpy.typing import NDArray
from small_kernels import Body, SmallKernels

from thurston_cl.device import Device
from thurston_cl.errors import SceneError
from thurston_cl.geometry import Geometry
from thurston_cl.program import geometry_parts
from thurston_cl.rendering import render
from thurston_cl.scene import load_text
from thurston_cl.scene.placement import CameraFrame, Placement
from thurston_cl.scene.plan import make_plan
from thurston_cl.scene.writer import shape_parts

LANES = 16
CENTRES = np.array([[0.5, 0.25, 0.25, 1], [-0.375, 0.25, -0.25, 1], [0.125, -0.625, 0.5, 1]])
# A slanted horizontal direction, in numbers that single precision has.
ALONG = (0.28125, -0.9609375)
# Constants of the kernels that have two sides.
BALL_SEEN_BELOW = 0.1
LEAST_FADING, MOST_FADING, FADING_KNOWN_BELOW = 0.12, 0.31, 1.4

SHAPES = {
    "ball": "p, number(scene, 0)",
    "ball_set": f"p, scene, 1, {len(CENTRES)}, number(scene, 0)",
    "pseudo_ball": "p, number(scene, 0)",
    "horocycle_cylinder": "p, number(scene, 0)",
    "pseudo_cylinder": "p, number(scene, 0), number(scene, AFTER_SET), number(scene, AFTER_SET + 1)",
    "vertical_pseudo_cylinder": "p, number(scene, 0)",
    "flat_half_space": "p",
    "hyperbolic_half_space": "p",
}
BALLS = ("ball", "ball_set")
PSEUDO = ("pseudo_ball", "pseudo_cylinder", "vertical_pseudo_cylinder")
OUTPUTS = """scene_data scene = {numbers, 0};
  point p = POINT(0);
  surface s = NAME_surface(ARGUMENTS);
  OUT(0, NAME_distance(ARGUMENTS)); OUT(1, s.distance); OUT(2, s.gradient.x); OUT(3, s.gradient.y);
  OUT(4, s.gradient.z); OUT(5, s.u); OUT(6, s.v);"""
BOUNDS = "bounds b = ball_bounds(POINT(0), IN(4)); OUT(0, b.below); OUT(1, b.above);"


class Setting(NamedTuple):
    g: Geometry  # in double precision
    precision: str
    kernels: SmallKernels

    @property
    def epsilon(self) -> float:
        return EPSILON[self.precision]

    def run(self, shape: str, points: Array, radius: float = 0.0) -> NDArray[np.float64]:
        """distance, the surface's distance, its gradient in the frame (3), its two coordinates: (7, N)."""
        numbers = np.concatenate([[radius], CENTRES.ravel(), ALONG])
        return self.kernels.run(shape, points.T, numbers).astype(np.float64)


def small_kernels(device: Device, precision: str, lanes: int) -> SmallKernels:
    texts = {name: OUTPUTS.replace("NAME", name).replace("ARGUMENTS", SHAPES[name]) for name in SHAPES}
    bodies = {name: Body(4, 7, text) for name, text in texts.items()} | {"bounds": Body(5, 2, BOUNDS)}
    parts = (*geometry_parts("sol"), "scene_types.h", *sorted(shape_parts("sol", SHAPES)))
    return SmallKernels(device, parts, bodies, precision, lanes, f"#define AFTER_SET {1 + CENTRES.size}")


@pytest.fixture(scope="module", params=[(p, lanes) for p in EPSILON for lanes in (1, LANES)], ids=str)
def at(request: pytest.FixtureRequest, opencl_device: Device) -> Setting:
    precision, lanes = request.param
    g = Geometry("sol", "double", opencl_device, lanes=8)
    return Setting(g, precision, small_kernels(opencl_device, precision, lanes))


def rounded(points: Array) -> NDArray[np.float64]:
    return points.astype(np.float32).astype(np.float64)


def directions(count: int, seed: int) -> NDArray[np.float64]:
    u = np.random.default_rng(seed).normal(size=(count, 3))
    return np.asarray(u / np.linalg.norm(u, axis=1)[:, None])


def points_between(g: Geometry, low: float, high: float, count: int, seed: int = 31) -> NDArray[np.float64]:
    """Points (N,4) that geodesics from the origin reach after lengths between `low` and `high`; some of them
    in the hyperbolic planes, on the axes and next to these, and on the lines x = +-y."""
    u = directions(count, seed + 1)
    u[: count // 5, seed % 2] *= 10.0 ** -np.arange(count // 5)
    u[count // 5 : count // 4, :2] *= 1e-4
    u[count // 4 : count // 3] = [1, -1, 0]
    u /= np.linalg.norm(u, axis=1)[:, None]
    return rounded(g.flow(u, np.random.default_rng(seed).uniform(low, high, count))[0])


def pseudo_radius(shape: str, p: Array) -> NDArray[np.float64]:
    """sigma of points (N,4): the least of the paper's from the points of a subgroup, along which its square
    is a parabola.
    """
    way: dict[str, list[float]] = {
        "pseudo_ball": [0, 0, 0],
        "pseudo_cylinder": [*ALONG, 0],
        "vertical_pseudo_cylinder": [0, 0, 1],
    }

    def square(t: float) -> Array:
        a, b, c = (t * component for component in way[shape])
        x, y, z = np.exp(-c) * (p[:, 0] - a), np.exp(c) * (p[:, 1] - b), p[:, 2] - c
        return np.asarray(np.exp(-2 * z) * x**2 + np.exp(2 * z) * y**2 + z**2)

    before, at, after = square(-1), square(0), square(1)
    bend = before + after - 2 * at
    shift = np.divide(before - after, 2 * bend, out=np.zeros_like(at), where=bend > 0)
    return np.sqrt(np.maximum(at - 0.5 * bend * shift**2, 0))


def level(g: Geometry, shape: str, p: Array, radius: float) -> NDArray[np.float64]:
    """What has the sign of the distance, in double."""
    if shape == "ball":
        return g.distance(p) - radius
    if shape == "ball_set":
        return np.min([g.distance(p, np.broadcast_to(c, p.shape)) for c in CENTRES], axis=0) - radius
    if shape in PSEUDO:
        return pseudo_radius(shape, p) - radius
    return exact(shape, p) - radius


def exact(shape: str, p: Array) -> NDArray[np.float64]:
    """Distances in double, but for the radius (paper, lemmas 11.2, 11.3, 11.5): those that a search finds."""
    x, y, z = p[:, 0], p[:, 1], p[:, 2]
    if shape == "horocycle_cylinder":
        return np.asarray(2 * np.arcsinh(np.sqrt(np.sinh(z / 2) ** 2 + np.exp(z) * y**2 / 4)))
    return np.asarray(z if shape == "flat_half_space" else np.arcsinh(x * np.exp(-z)))


def radius_of(shape: str) -> float:
    return 0.0 if shape.endswith("half_space") else 0.375


@pytest.mark.parametrize("radius", [0.05, 0.3, 1.0, 2.5, 4.0])
def test_balls_against_the_exact_distance(at: Setting, radius: float) -> None:
    """Never beyond it, and at least 2/5 of it, on the same side: within half of the way near the surface."""
    g = at.g
    radius = float(np.float32(radius))
    for low, high in [(1e-3, 0.1), (0.1, 1), (max(radius - 1e-2, 0), radius + 1e-2), (1, 4), (4, 12)]:
        points = points_between(g, low, high, 600)
        want = g.distance(points) - radius
        got = at.run("ball", points, radius)
        rounding = 32 * at.epsilon * (np.abs(want) + radius)
        np.testing.assert_array_equal(got[1], got[0])
        side = np.sign(want)
        assert (side * got[0] <= side * want + rounding).all()
        assert (side * got[0] >= 0.4 * side * want - rounding).all()


def test_the_bounds_of_a_ball(at: Setting) -> None:
    """They hold from 0.001 to 12, and are close where FADING_KNOWN_BELOW says so."""
    g = at.g
    for low, high in [(1e-3, 0.1), (0.1, 1), (1.3, 1.5), (1, 4), (4, 12)]:
        points = points_between(g, low, high, 1500)
        d, f = g.distance(points), g.underestimate(points)
        below, above = at.kernels.run("bounds", np.column_stack([points, np.ones(len(d))]).T).astype(float)
        rounding = 16 * at.epsilon * d + 8 * EPSILON["double"]
        assert (below <= d + rounding).all() and (above >= d - rounding).all()
        known = f < FADING_KNOWN_BELOW * (1 - at.epsilon)
        assert (above - below <= np.where(known, d**7 / 3500, d**5 / 1150) + 2 * rounding).all()
        beyond = f > FADING_KNOWN_BELOW * (1 + at.epsilon)
        assert (np.abs(below - f) <= 2 * rounding)[beyond].all()


def test_the_first_term_fades_as_the_bounds_say(at: Setting) -> None:
    """LEAST_FADING and MOST_FADING, from both sides: what fades is between them, and comes near to both."""
    if at.precision == "single" or at.kernels.lanes == 1:
        return
    points = points_between(at.g, 0.3, FADING_KNOWN_BELOW, 20000)
    d, f = at.g.distance(points), at.g.underestimate(points)
    x, y, z = points[:, 0], points[:, 1], points[:, 2]
    a, b, height = x**2 * np.exp(-z), y**2 * np.exp(z), z**2
    term = a * b * ((a + b) / 120 + height / 180)
    seen = term > 1e-7
    fading = (term[seen] / (d**2 - f**2)[seen] - 1) / (a + b + 7 * height)[seen]
    assert LEAST_FADING < fading.min() < 1.03 * LEAST_FADING, fading.min()
    assert 0.8 * MOST_FADING < fading.max() < MOST_FADING, fading.max()


def test_far_from_a_ball_its_normal_is_not_looked_for(at: Setting) -> None:
    radius = 0.5
    for d in (radius + BALL_SEEN_BELOW * (1 - 1e-3), radius + BALL_SEEN_BELOW * (1 + 1e-3), 3.0):
        p = rounded(at.g.flow([0.6, 0.0, 0.8], np.array([d]))[0])
        got = at.run("ball", p, radius)[2:5, 0]
        assert (got[0] > 0.1) == (d < radius + BALL_SEEN_BELOW)


def test_exact_surfaces_are_as_far_as_a_search_finds(at: Setting) -> None:
    g = at.g
    points = points_between(g, 0.3, 1.5, 20)
    surfaces: dict[str, Callable[[Array, Array], Array]] = {
        "horocycle_cylinder": lambda s, t: np.stack([s, 0 * s, 0 * s, 1 + 0 * s], axis=-1),
        "flat_half_space": lambda s, t: np.stack([s, t, 0 * s, 1 + 0 * s], axis=-1),
        "hyperbolic_half_space": lambda s, t: np.stack([0 * s, s, t, 1 + 0 * s], axis=-1),
    }
    for shape, embed in surfaces.items():
        radius = radius_of(shape)
        got = at.run(shape, points, radius)
        for k in range(0, 20, 3):
            p, centre, reach, least = points[k : k + 1], np.zeros(2), 6.0, np.inf
            while reach > 1e-5:
                grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 25)] * 2), axis=-1).reshape(-1, 2)
                targets = embed(*(centre + reach * grid).T)
                lengths = g.distance(targets, np.broadcast_to(p, targets.shape))
                centre, least = centre + reach * grid[lengths.argmin()], min(least, lengths.min())
                reach *= 0.3
            side = 1 if shape == "horocycle_cylinder" else np.sign(got[0, k])
            np.testing.assert_allclose(
                side * (got[0, k] + radius), least, atol=1e-8 + 8 * at.epsilon, err_msg=shape
            )
    for shape in surfaces:
        far = points_between(g, 0, 6, 1000)
        want = exact(shape, far) - radius_of(shape)
        got = at.run(shape, far, radius_of(shape))[0]
        assert (np.abs(got - want) <= 8 * at.epsilon * (1 + np.abs(want))).all(), shape


def test_pseudo_shapes_are_the_paper_s(at: Setting) -> None:
    """HALF_C, INVERSE_ROOT: 0 where sigma is the radius, with the sign of their difference elsewhere; and as
    far as the bound of the gradient says, no less."""
    g = at.g
    for shape in PSEUDO:
        points = points_between(g, 0.1, 6, 500)
        sigma = pseudo_radius(shape, points)
        for radius in (0.125, 0.5, 2.0):
            got = at.run(shape, points, radius)[0]
            middle = np.geomspace(radius, sigma, 2001)
            c = 0 if shape == "vertical_pseudo_cylinder" else 4 / np.sqrt(27)
            rate = 1 / np.sqrt(1 + c * middle + middle**2)
            want = np.trapezoid(rate, middle, axis=0)
            assert (np.abs(got - want) <= 1e-5 + 16 * at.epsilon).all(), (shape, np.abs(got - want).max())


def test_a_step_never_passes_a_surface(at: Setting) -> None:
    """In any direction, and along the gradient, the surface is as far as its distance says, or farther."""
    g = at.g
    for shape in SHAPES:
        radius = radius_of(shape)
        base = points_between(g, 0.02, 3.5, 900)
        got = at.run(shape, base, radius)
        size = np.linalg.norm(got[2:5], axis=0)
        inwards = np.where(got[0] > 0, -1, 1)
        down = np.where(size > 0, inwards * got[2:5], np.array([[0], [0], [1]]))
        # A ball far away has no normal.
        towards = np.where(np.abs(got[0]) < BALL_SEEN_BELOW, down, directions(len(base), 45).T).T
        for u in (directions(len(base), 43), towards if shape in BALLS else down.T):
            u = u / np.linalg.norm(u, axis=1)[:, None]
            end = g.flow(u, np.abs(got[0]), base)[0]
            after = -inwards * level(g, shape, end, radius)
            # The level of a pseudo-shape changes faster than a distance.
            most = 1 + pseudo_radius(shape, base) if shape in PSEUDO else 1
            assert (after >= -64 * at.epsilon * most * (1 + np.abs(end).max(axis=1))).all(), shape


def test_slopes_are_at_most_1(at: Setting) -> None:
    """Along any geodesic a distance changes by no more than the length gone: no surface is jumped over."""
    g = at.g
    base = points_between(g, 0, 3, 3000)
    u = directions(len(base), 41)
    length = 10 ** np.random.default_rng(42).uniform(-4, 0.5, len(base))
    end = g.flow(u, length, base)[0]
    for shape in SHAPES:
        if shape not in BALLS:
            change = np.abs(at.run(shape, end, 0.375)[0] - at.run(shape, base, 0.375)[0])
            size = np.maximum(np.abs(base).max(axis=1), np.abs(end).max(axis=1))
            assert (change <= length + 16 * at.epsilon * (1 + size)).all(), shape


def test_gradients(at: Setting) -> None:
    """In the frame they point along central differences of the level along geodesics."""
    g = at.g
    step = 1e-5
    for shape in SHAPES:
        radius = radius_of(shape)
        points = points_between(g, 0.2, 1.6, 60)
        if shape in BALLS:
            points = points_between(g, radius - 0.05, radius + 0.05, 60)
        if shape == "ball_set":
            points = rounded(g.translate(CENTRES[1], points))
        columns = []
        for e in np.eye(3):
            ahead, behind = (level(g, shape, g.flow(e, sign * step, points)[0], radius) for sign in (1, -1))
            columns.append((ahead - behind) / (2 * step))
        want = np.stack(columns, axis=1)
        size = np.linalg.norm(want, axis=1)[:, None]
        got = at.run(shape, points, radius)[2:5].T
        got = got / np.linalg.norm(got, axis=1)[:, None]
        smooth = np.abs(size[:, 0] - 1) < 1e-6
        if shape in PSEUDO:
            smooth = pseudo_radius(shape, points) > 0.05
        if shape == "ball_set":
            each = np.sort([g.distance(points, np.broadcast_to(c, points.shape)) for c in CENTRES], axis=0)
            smooth &= (each[1] - each[0] > 1e-3) & (np.abs(each[0] - radius) < BALL_SEEN_BELOW)
        assert smooth.mean() > 0.7, shape
        off = np.abs(got - want / size)[smooth].max()
        assert off <= (1e-6 if at.precision == "double" else 2e-5), (shape, off)


def test_coordinates_on_surfaces(at: Setting) -> None:
    """Of planes: flat ones x and y, hyperbolic ones y and z; along cylinders the length of the axis; about
    these and on globes a quarter of a turn for each axis that is passed.
    """
    points = points_between(at.g, 0.2, 2, 50)
    np.testing.assert_array_equal(at.run("flat_half_space", points)[5:].T, points[:, :2])
    np.testing.assert_array_equal(at.run("hyperbolic_half_space", points)[5:].T, points[:, 1:3])
    np.testing.assert_array_equal(at.run("horocycle_cylinder", points, 1.0)[6], points[:, 0])
    np.testing.assert_array_equal(at.run("vertical_pseudo_cylinder", points, 1.0)[6], points[:, 2])
    on_curve = rounded(np.array([[t * ALONG[0], t * ALONG[1], 0.25, 1] for t in (-1.0, 0.0, 2.0)]))
    along = at.run("pseudo_cylinder", on_curve, 0.25)
    np.testing.assert_allclose(along[5], 0.75, atol=1e-3)
    np.testing.assert_allclose(np.diff(along[6]), np.hypot(*ALONG) ** 2 * np.array([1, 2]), rtol=0.1)
    r = 0.25
    axes = np.array([[r, 0, 0, 1], [0, r, 0, 1], [0, 0, r, 1], [-r / 1024, -r, 0, 1], [0, 0, -r, 1]])
    for shape in ("ball", "pseudo_ball"):
        got = at.run(shape, axes, r)
        np.testing.assert_allclose(got[5, [0, 1, 3]], [0.5, 0.75, 0.25], atol=1e-2, err_msg=shape)
        np.testing.assert_allclose(got[6], [0.5, 0.5, 1, 0.5, 0], atol=0.05, err_msg=shape)
    about = at.run("horocycle_cylinder", axes[1:], r)[5]
    np.testing.assert_allclose(about[[0, 1, 3]], [0.5, 0.75, 0.25], atol=0.05)


def test_nothing_is_lost_at_singular_points(at: Setting) -> None:
    """Centre, axes and planes, far up and down: numbers everywhere, and normals on balls."""
    z = np.array([0, 1e-30, 0.5, -0.5, 7, -7, 14])
    rows = [(x, y, height, 1) for x in (0, 1e-20, 1e-4, 2.0) for y in (0, 1e-12, 3.0) for height in z]
    p = np.array(rows)
    for shape in SHAPES:
        assert not np.isnan(at.run(shape, p, 0.5)).any(), shape
    d = at.g.distance(p)
    for k in np.flatnonzero((d > 1e-3) & (d < 8)):
        normal = at.run("ball", p[k : k + 1], float(d[k]))[2:5, 0]
        assert np.linalg.norm(normal) == pytest.approx(1, abs=1e-5)


class Placed(NamedTuple):
    """An object of a scene, what has the sign of its distance in coordinates about its center, how it is
    turned and where its center is.
    """

    text: str
    level: Callable[[Array, Array, Array], Array]
    turn: str = "[0, 0, 1], angle: 0 deg"
    matrix: Sequence[Sequence[float]] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    at: tuple[float, float, float] = (0, 0, 0)


HALF_TURN, EXCHANGE, EXCHANGE_BACK = (
    ("[0, 0, 1], angle: 180 deg", ((-1, 0, 0), (0, -1, 0), (0, 0, 1))),
    ("[1, 1, 0], angle: 180 deg", ((0, 1, 0), (1, 0, 0), (0, 0, -1))),
    ("[1, -1, 0], angle: 180 deg", ((0, -1, 0), (-1, 0, 0), (0, 0, -1))),
)
SINH = np.sinh(0.75)
PLACED = {
    "planes": [
        Placed("half-space: {normal: [0, 0, 1], offset: -1.5}", lambda x, y, z: z + 1.5),
        Placed("half-space: {normal: [0, 0, -2], offset: -1.5}", lambda x, y, z: 1.5 - z),
        Placed("half-space: {normal: [1, 0, 0], offset: -0.75}", lambda x, y, z: x + SINH),
        Placed("half-space: {normal: [-1, 0, 0], offset: -0.75}", lambda x, y, z: SINH - x),
        Placed("half-space: {normal: [0, 3, 0], offset: -0.75}", lambda x, y, z: y + SINH),
        Placed("half-space: {normal: [0, -1, 0], offset: -0.75}", lambda x, y, z: SINH - y),
    ],
    "solids": [
        Placed(
            "cylinder: {radius: 0.15, along: [0, -1, 0]}",
            lambda x, y, z: np.cosh(z) + np.exp(-z) * x**2 / 2 - np.cosh(0.15),
            *HALF_TURN,
            (0.75, 0.25, 0.5),
        ),
        Placed(
            "pseudo-cylinder: {radius: 0.15, along: [3, 4, 0]}",
            lambda x, y, z: (
                (0.8 * x - 0.6 * y) ** 2 / (0.64 * np.exp(2 * z) + 0.36 * np.exp(-2 * z)) + z**2 - 0.15**2
            ),
            *EXCHANGE,
            (0.5, 1.0, -0.25),
        ),
        Placed(
            "slab: {normal: [0, 1, 0], thickness: 0.25}",
            lambda x, y, z: np.abs(y) - np.sinh(0.125),
            *EXCHANGE_BACK,
            (-0.75, 0.25, 0),
        ),
    ],
}


@pytest.mark.parametrize("name", PLACED)
def test_what_scenes_place_is_hit_where_it_stands(name: str) -> None:
    objects = "".join(
        f"  - {item.text}\n    rotate: {{axis: {item.turn}}}\n    at: {{model: {[*item.at, 1]}}}\n"
        for item in PLACED[name]
    )
    g, size = Geometry("sol", "double", lanes=8), (40, 30)
    counts = np.zeros(len(PLACED[name]))
    for look in ("[1, 0.6, -0.3]", "[-1, -0.6, 0.3]"):
        view_from = f"camera: {{at: [0, 0, 0], look: {{along: {look}}}, fov: 150 deg}}\n"
        scene = load_text(f"geometry: sol\n{view_from}objects:\n{objects}render: {{steps: 2000}}\n")
        image = render(scene, size=size, samples=1, precision="double", lanes=8)
        camera = CameraFrame(scene.camera, Placement(g))
        depth, seen = (image.channels[name].ravel() for name in ("depth", "object"))
        for k, item in enumerate(PLACED[name]):
            hit = seen == k + 1
            if not hit.any():
                continue
            counts[k] += hit.sum()

            def value(p: Array, item: Placed = item) -> Array:
                q = g.untranslate(np.array([*item.at, 1.0]), p)
                return item.level(*(np.array(item.matrix) @ q[:, :3].T))

            p = g.flow(view(camera, size, scene.camera.fov)[hit], depth[hit].astype(float))[0]
            ways = [[g.flow(e, sign * 1e-5, p)[0] for sign in (1, -1)] for e in np.eye(3)]
            slope = np.stack([(value(ahead) - value(behind)) / 2e-5 for ahead, behind in ways], axis=1)
            steepness = np.linalg.norm(slope, axis=1)
            assert (np.abs(value(p)) <= 3e-4 * steepness).all(), item.text
            normal = image.channels["normal"].reshape(-1, 3)[hit]
            assert np.abs(normal - slope / steepness[:, None]).max() < 1e-2, item.text
    assert (counts > 8).all(), counts


GOLDEN_RATIO = 0.5 * (1 + 5**0.5)


@pytest.mark.parametrize(
    ("manifold", "solid", "closes"),
    [
        ("anosov", "half-space: {normal: [1, 0, 0], offset: 0.1}", False),
        ("anosov", "slab: {normal: [0, 1, 0], thickness: 0.1}", False),
        ("anosov", "cylinder: {radius: 0.1, along: [1, 0, 0]}", False),
        ("anosov", "pseudo-cylinder: {radius: 0.1, along: [1, 1, 0]}", False),
        ("anosov", f"pseudo-cylinder: {{radius: 0.1, along: [{GOLDEN_RATIO:.4f}, -1, 0]}}", True),
        ("anosov", "pseudo-cylinder: {radius: 0.1}", True),
        ("anosov", "half-space: {normal: [0, 0, 1], offset: 0.1}", True),
        (
            "anosov",
            "intersection: [{ball: {radius: 0.2}}, {slab: {normal: [1, 0, 0], thickness: 0.1}}]",
            True,
        ),
        (
            "anosov",
            "intersection: [{slab: {normal: [1, 0, 0], thickness: 0.1}}, "
            "{slab: {normal: [0, 1, 0], thickness: 0.1}}, {slab: {normal: [0, 0, 1], thickness: 0.1}}]",
            True,
        ),
        ("anosov", "union: [{ball: {radius: 0.2}}, {slab: {normal: [1, 0, 0], thickness: 0.1}}]", False),
        # MOST_TIMES the one translation, and once more; CLOSED from both sides.
        ("xy-loops", "pseudo-cylinder: {radius: 0.1, along: [12, 11, 0]}", True),
        ("xy-loops", "pseudo-cylinder: {radius: 0.1, along: [13, 11, 0]}", False),
        ("xy-loops", "pseudo-cylinder: {radius: 0.1, along: [1, 0.00009, 0]}", True),
        ("xy-loops", "pseudo-cylinder: {radius: 0.1, along: [1, 0.00011, 0]}", False),
        ("xy-loops", "cylinder: {radius: 0.1, along: [0, 1, 0]}", True),
        ("z-loop", "pseudo-cylinder: {radius: 0.1, along: [1, 1.3, 0]}", True),
        ("z-loop", "half-space: {normal: [1, 0, 0], offset: 0.1}", True),
    ],
)
def test_horizontal_lines_of_sol_have_to_close(manifold: str, solid: str, closes: bool) -> None:
    scene = load_text(f"geometry: sol\nmanifold: {manifold}\nobjects:\n  - {solid}\n")
    with contextlib.nullcontext() if closes else pytest.raises(SceneError, match="never close"):
        make_plan(scene)
