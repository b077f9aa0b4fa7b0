"""kernels/shape in the fibred geometries s2xe, h2xe, nil, sl2.

Distances against those of `Geometry` in double precision, the least of which is searched for where a surface
has many points; bounds, that they stay on their side; gradients against differences; directed half-spaces
against dense samples of geodesics.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from golden import EPSILON, MP, Array
from numpy.typing import NDArray
from small_kernels import Body, SmallKernels

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.program import geometry_parts
from thurston_cl.scene.writer import shape_parts

PRODUCTS = ("s2xe", "h2xe")
TWISTED = ("nil", "sl2")
FIBRED = (*PRODUCTS, *TWISTED)
LANES = 16
CENTRES = 3

# Constants of the kernels whose two sides are tested.
BALL_SEEN_BELOW = 0.1
PROBE = 0.125
COT_START, COT_END = -4.0, 7.5625
# Parts of the distance by which the bounds of a ball are off: those of the first guess at most, where d is 2
# to 4, those of the step after it, and those of the first guess in half of the points where d is 6 to 9.
GUESS_IS_OFF = {"nil": (5e-3, 1e-5, 0.3), "sl2": (1e-2, 3e-5, 0.8)}

UNDIRECTED = {
    "ball": "p, number(scene, 0)",
    "ball_set": f"p, scene, 1, {CENTRES}, number(scene, 0)",
    "cylinder": "p, number(scene, 0)",
    "level_cylinder": "p, number(scene, 0)",
    "vertical_half_space": "p",
}
DIRECTED = ("horizontal_half_space", "bisected_half_space")
OUTPUTS = """scene_data scene = {numbers, 0};
  point p = POINT(0);
  vector v = push(p, first_3(POINT(4)));
  surface s = NAME_surface(ARGUMENTS);
  direction g = pull_covector(p, s.gradient);
  OUT(0, NAME_distance(ARGUMENTS)); OUT(1, s.distance); OUT(2, g.x); OUT(3, g.y); OUT(4, g.z);
  OUT(5, s.u); OUT(6, s.v);"""
SQUEEZE = """point p = POINT(0);
  target a = target_at(p);
  squeeze one = squeeze_at(a, first_guess(a)), two = squeeze_at(a, one.next);
  OUT(0, one.least); OUT(1, one.most); OUT(2, two.least); OUT(3, two.most);"""
COTANGENT = (
    "real first, second, k = root_cot_root(IN(0), &first, &second); OUT(0, k); OUT(1, first); OUT(2, second);"
)


def shapes_of(geometry: str) -> list[str]:
    left_out = {"bisected_half_space"} if geometry in PRODUCTS else {"level_cylinder"}
    return [name for name in (*UNDIRECTED, *DIRECTED) if name not in left_out]


def body(name: str) -> Body:
    text = OUTPUTS.replace("NAME_distance(ARGUMENTS)", "NAME_distance(p, v)") if name in DIRECTED else OUTPUTS
    return Body(8, 7, text.replace("NAME", name).replace("ARGUMENTS", UNDIRECTED.get(name, "p")))


class Setting(NamedTuple):
    g: Geometry  # in double precision
    precision: str
    kernels: SmallKernels

    @property
    def epsilon(self) -> float:
        return EPSILON[self.precision]

    def run(
        self, shape: str, points: Array, radius: float = 0.0, directions: Array | None = None
    ) -> NDArray[np.float64]:
        """distance, the surface's distance, its gradient in the frame (3), its two coordinates: (7, N)."""
        u = np.zeros((len(points), 4))
        u[:, 2] = 1
        if directions is not None:
            u[:, :3] = directions
        numbers = np.concatenate([[radius], centres(self.g).ravel()])
        return self.kernels.run(shape, np.concatenate([points, u], axis=1).T, numbers).astype(np.float64)


def small_kernels(device: Device, geometry: str, precision: str, lanes: int) -> SmallKernels:
    bodies = {name: body(name) for name in shapes_of(geometry)}
    if geometry in TWISTED:
        bodies |= {"squeeze": Body(4, 4, SQUEEZE), "cotangent": Body(1, 3, COTANGENT)}
    files = sorted(shape_parts(geometry, shapes_of(geometry)))
    parts = (*geometry_parts(geometry), "scene_types.h", *files)
    return SmallKernels(device, parts, bodies, precision, lanes)


@pytest.fixture(scope="module", params=[(n, p) for n in FIBRED for p in EPSILON], ids="-".join)
def at(request: pytest.FixtureRequest, opencl_device: Device) -> Setting:
    name, precision = request.param
    g = Geometry(name, "double", opencl_device, lanes=LANES)
    return Setting(g, precision, small_kernels(opencl_device, name, precision, LANES))


def fibre_column(geometry: str) -> int:
    return 2 if geometry == "nil" else 3


def rounded(geometry: str, points: Array) -> NDArray[np.float64]:
    """The points (N,4) with free coordinates that single precision has too, on their model in double."""
    p = points.astype(np.float32).astype(np.float64)
    square = p[:, 0] ** 2 + p[:, 1] ** 2
    if geometry in ("h2xe", "sl2"):
        p[:, 2] = np.sqrt(1 + square)
    elif geometry == "s2xe":
        p[:, 2] = np.copysign(np.sqrt(np.maximum(1 - square, 0)), points[:, 2])
    return p


def directions(count: int, seed: int) -> NDArray[np.float64]:
    u = np.random.default_rng(seed).normal(size=(count, 3))
    u /= np.linalg.norm(u, axis=1)[:, None]
    return u


def points_between(g: Geometry, low: float, high: float, count: int, seed: int = 31) -> NDArray[np.float64]:
    """Points (N,4) that geodesics from the origin reach after lengths between `low` and `high`."""
    t = np.random.default_rng(seed).uniform(low, high, count)
    return rounded(g.name, g.flow(directions(count, seed + 1), t)[0])


def over(geometry: str, x: Array, y: Array, h: Array) -> NDArray[np.float64]:
    """Points (N,4) over (x, y) of the base (in its model) at the fibre coordinate h."""
    x, y, h = np.broadcast_arrays(x, y, h)
    if geometry == "nil":
        return np.stack([x, y, h, 1 + 0 * h], axis=-1).astype(np.float64)
    sign = -1 if geometry == "s2xe" else 1
    return np.stack([x, y, np.sqrt(1 + sign * (x**2 + y**2)), h], axis=-1).astype(np.float64)


def centres(g: Geometry) -> NDArray[np.float64]:
    column = fibre_column(g.name)
    c = over(g.name, np.array([0.5, -0.4, 0.1]), np.array([0.2, 0.3, -0.6]), np.array([0.3, -0.2, 0.5]))
    assert c.shape == (CENTRES, 4) and column in (2, 3)
    return rounded(g.name, c)


def sine(geometry: str, t: Array) -> NDArray[np.float64]:
    """The coordinate x over the base of the point at the length t along its x-line."""
    if geometry == "nil":
        return 1.0 * t
    return np.sin(t) if geometry == "s2xe" else np.sinh(t)


def arc_sine(geometry: str, x: Array) -> NDArray[np.float64]:
    if geometry == "nil":
        return x
    return np.arcsin(x) if geometry == "s2xe" else np.arcsinh(x)


def on_base(geometry: str, along: Array, aside: Array) -> tuple[Array, Array]:
    """x, y over the base of what lies `aside` (towards +x) of the y-line at its length `along`."""
    x = sine(geometry, aside)
    cosine = np.sqrt(1 + {"nil": 0, "s2xe": -1}.get(geometry, 1) * x**2)
    return x, cosine * sine(geometry, along)


def size_of(points: Array) -> NDArray[np.float64]:
    return np.asarray(np.abs(points).max(axis=1))


def least(f: Callable[[Array], Array], dimension: int, reach: float) -> float:
    """The least value of f on a box, by a grid that closes in; f takes (N, dimension)."""
    centre, ticks = np.zeros(dimension), np.linspace(-1, 1, 33)
    grid = np.stack(np.meshgrid(*[ticks] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    best = np.inf
    while reach > 1e-7:
        values = f(centre + reach * grid)
        centre, best = centre + reach * grid[values.argmin()], min(best, values.min())
        reach *= 0.25
    return float(best)


@pytest.mark.parametrize("radius", [0.05, 0.3, 1.0, 2.5, 4.0])
def test_balls_against_the_exact_distance(at: Setting, radius: float) -> None:
    """Products: the distance. Nil, sl2: never beyond it, and at least 2/5 of it, on the same side."""
    g = at.g
    radius = float(np.float32(radius))
    for low, high in [(1e-3, 0.1), (0.1, 1), (max(radius - 1e-2, 0), radius + 1e-2), (1, 4), (4, 12)]:
        points = points_between(g, low, high, 600)
        want = g.distance(points) - radius
        got = at.run("ball", points, radius)
        rounding = 8 * at.epsilon * (np.abs(want) + radius + (size_of(points) if g.name == "h2xe" else 0))
        np.testing.assert_array_equal(got[1], got[0])
        if g.name in PRODUCTS:
            assert (np.abs(got[0] - want) <= rounding).all()
            continue
        side = np.sign(want)
        assert (side * got[0] <= side * want + rounding).all()
        assert (side * got[0] >= 0.4 * side * want - rounding).all()
        near = np.abs(want) < 1e-3
        if at.precision == "double" and near.any():
            assert (side * got[0] >= side * want / 2)[near].all()


def test_the_cotangent(at: Setting) -> None:
    if at.g.name not in TWISTED:
        return
    s = np.concatenate([np.linspace(COT_START, COT_END, 257), [0, 1e-9, -1e-9]]).astype(np.float32)
    got = at.kernels.run("cotangent", s[None]).astype(float)
    roots = [MP.sqrt(MP.mpf(float(x))) if x else MP.mpf(10) ** -20 for x in s]
    want = np.array([float(MP.re(r * MP.cot(r))) for r in roots])
    np.testing.assert_allclose(got[0], want, atol=4 * at.epsilon * np.maximum(1, np.abs(want)).max())

    def derivative(order: int) -> Array:
        values = [
            MP.diff(
                lambda x: MP.re(MP.sqrt(x) * MP.cot(MP.sqrt(x))), MP.mpf(float(x)) + MP.mpf(10) ** -9, order
            )
            for x in s[:-3:16]
        ]
        return np.array([float(v) for v in values])

    tolerance = 1e-4 if at.precision == "single" else 1e-8
    for order in (1, 2):
        np.testing.assert_allclose(got[order, :-3:16], derivative(order), rtol=tolerance, atol=tolerance)


def test_the_bounds_of_the_distance_hold_for_any_guess(at: Setting) -> None:
    """Over a grid of base distances and heights that passes all limits of the unknown, from both sides."""
    g = at.g
    if g.name not in TWISTED:
        return
    rho = np.concatenate([[0, 1e-6, 1e-3], np.linspace(0.05, 7, 40)])
    h = np.concatenate([[0, 1e-6, 1e-3], np.linspace(0.05, 30, 60)])
    r, z = (a.ravel() for a in np.meshgrid(sine(g.name, rho), h))
    points = rounded(g.name, over(g.name, 0.6 * r, 0.8 * r, z))
    d = g.distance(points)
    got = at.kernels.run("squeeze", points.T).astype(float)
    # Where the height is large the lower bound is a small difference, which is no harm.
    rounding = 16 * at.epsilon * (d**2 + np.abs(points[:, fibre_column(g.name)]))
    for least_square, most_square in (got[:2], got[2:]):
        assert (least_square <= d**2 + rounding).all()
        known = np.isfinite(most_square)
        assert known.all()
        assert (most_square >= d**2 - rounding).all()
    near = (d > 0) & (d < 2)
    for k, share in ((0, 3e-4), (2, max(1e-9, 8 * at.epsilon))):
        low, high = np.sqrt(np.maximum(got[k : k + 2, near], 0))
        assert (low >= (1 - share) * d[near]).all() and (high <= (1 + share) * d[near]).all()


def test_the_first_guess_over_its_cut(at: Setting) -> None:
    """PSI_END, sl2, and UNKNOWN_END, nil, from both sides: up to d = 4 two steps come as near as here, and
    far beyond, where the series of the guess is wrong, a guess still leads to a bound at most points."""
    g = at.g
    if g.name not in TWISTED:
        return
    rho, h = np.meshgrid(np.linspace(0.01, 4, 25), np.linspace(0.05, 14, 60))
    r = sine(g.name, rho.ravel())
    points = rounded(g.name, over(g.name, 0.6 * r, 0.8 * r, h.ravel()))
    d = g.distance(points)
    got = np.sqrt(np.maximum(at.kernels.run("squeeze", points.T).astype(float), 0))
    gaps = [np.maximum(1 - low / d, high / d - 1) for low, high in (got[:2], got[2:])]
    middle, far = (d > 2) & (d < 4), (d > 6) & (d < 9)
    assert middle.sum() > 200 and far.sum() > 200
    first, second = (gap[middle].max() for gap in gaps)
    assert first < GUESS_IS_OFF[g.name][0] and second < GUESS_IS_OFF[g.name][1], (first, second)
    assert np.median(gaps[0][far]) < GUESS_IS_OFF[g.name][2], np.median(gaps[0][far])


def test_gradients(at: Setting) -> None:
    """In the frame they point along central differences of the distance along geodesics."""
    g = at.g
    step = 1e-5
    radius = 0.7
    for shape in shapes_of(g.name):
        if shape in DIRECTED:
            points = points_between(g, 0.2, 2, 50)
        elif g.name in TWISTED and shape.startswith("ball"):
            centre = points_between(g, radius - 0.05, radius + 0.05, 50)
            points = rounded(g.name, g.translate(centres(g)[1], centre)) if shape == "ball_set" else centre
        else:
            points = points_between(g, 0.2, 1.6, 50)

        def value(p: Array, shape: str = shape) -> Array:
            if shape in DIRECTED:
                return np.asarray(p[:, fibre_column(g.name)])
            if shape == "ball":
                return np.asarray(g.distance(p))
            if shape == "ball_set":
                each = [g.distance(p, np.broadcast_to(c, p.shape)) for c in centres(g)]
                return np.asarray(np.min(each, axis=0))
            return base_distance(g.name, shape, p)

        columns = []
        for e in np.eye(3):
            ahead, behind = (value(g.flow(e, sign * step, points)[0]) for sign in (1, -1))
            columns.append((ahead - behind) / (2 * step))
        want = np.stack(columns, axis=1)
        size = np.linalg.norm(want, axis=1)[:, None]
        got = at.run(shape, points, radius)[2:5].T
        got = got / np.linalg.norm(got, axis=1)[:, None]
        smooth = np.ones(len(points), bool)
        if shape not in DIRECTED:
            assert (np.abs(size - 1) < 1e-6).mean() > 0.7, shape
            smooth = np.abs(size[:, 0] - 1) < 1e-6
        if shape == "ball_set":
            two = np.sort([g.distance(points, np.broadcast_to(c, points.shape)) for c in centres(g)], axis=0)
            smooth &= two[1] - two[0] > 1e-3
            if g.name in TWISTED:
                smooth &= np.abs(two[0] - radius) < BALL_SEEN_BELOW
        off = np.abs(got - want / size)[smooth].max()
        assert off <= (2e-8 if at.precision == "double" else 1e-5), (shape, off)


def base_distance(geometry: str, shape: str, p: Array) -> NDArray[np.float64]:
    """Distances in double, but for the radius: those that the search below confirms."""
    if shape == "cylinder":
        across = np.hypot(p[:, 0], p[:, 1])
        return np.arctan2(across, p[:, 2]) if geometry == "s2xe" else arc_sine(geometry, across)
    if shape == "vertical_half_space":
        return arc_sine(geometry, p[:, 0])
    return np.hypot(arc_sine(geometry, p[:, 1]), p[:, 3])


def test_vertical_and_level_surfaces_are_as_far_as_a_search_finds(at: Setting) -> None:
    g = at.g
    radius = 0.25
    points = points_between(g, 0.3, 1.5, 6)

    nothing = np.zeros(1)
    surfaces: dict[str, tuple[int, Callable[[Array], Array], float]] = {
        "cylinder": (1, lambda s: over(g.name, nothing, nothing, s[:, 0]), 4),
        "vertical_half_space": (
            2,
            lambda s: over(g.name, *on_base(g.name, s[:, 0], 0 * s[:, 0]), s[:, 1]),
            1.5,
        ),
    }
    if g.name in PRODUCTS:
        surfaces["level_cylinder"] = (1, lambda s: over(g.name, sine(g.name, s[:, 0]), nothing, nothing), 1.5)
    for k, p in enumerate(points):
        for shape, (dimension, embed, reach) in surfaces.items():

            def length(s: Array, p: Array = p, embed: Callable[[Array], Array] = embed) -> Array:
                targets = embed(s)
                return g.distance(targets, np.broadcast_to(p, targets.shape))

            want = least(length, dimension, reach)
            want = np.sign(p[0]) * want if shape == "vertical_half_space" else want - radius
            got = at.run(shape, points[k : k + 1], radius)
            np.testing.assert_allclose(got[:2, 0], want, atol=1e-9 + 8 * at.epsilon, err_msg=shape)


def test_far_sides_of_s2(at: Setting) -> None:
    """Near the antipode, the poles of lines and beyond the equator, distances keep their digits."""
    if at.g.name != "s2xe":
        return
    away = np.array([1e-1, 1e-3, 1e-5, 0.0])
    points = np.stack([np.sin(away), 0 * away, -np.cos(away), 0 * away], axis=1)
    np.testing.assert_allclose(at.run("cylinder", points, 0.5)[0], np.pi - 0.5 - away, atol=4 * at.epsilon)
    np.testing.assert_allclose(at.run("ball", points, 0.5)[0], np.pi - 0.5 - away, atol=4 * at.epsilon)
    pole = np.stack([np.cos(away), 0 * away, np.sin(away), 0 * away], axis=1)
    np.testing.assert_allclose(at.run("vertical_half_space", pole)[0], np.pi / 2 - away, atol=4 * at.epsilon)
    pole = pole[:, [1, 0, 2, 3]]
    np.testing.assert_allclose(
        at.run("level_cylinder", pole, 0.5)[0], np.pi / 2 - 0.5 - away, atol=4 * at.epsilon
    )


def test_slopes_are_at_most_1(at: Setting) -> None:
    """Along any geodesic a distance changes by no more than the length gone: no surface is jumped over."""
    g = at.g
    base = points_between(g, 0, 2.5, 1500)
    u = directions(len(base), 41)
    length = 10 ** np.random.default_rng(42).uniform(-4, 0.2, len(base))
    end = g.flow(u, length, base)[0]
    size = np.maximum(size_of(base), size_of(end))
    for shape in shapes_of(g.name):
        if shape in DIRECTED or (g.name in TWISTED and shape.startswith("ball")):
            continue
        change = np.abs(at.run(shape, end, 0.4)[0] - at.run(shape, base, 0.4)[0])
        assert (change <= length + 16 * at.epsilon * size).all(), shape


def test_a_step_never_passes_a_ball(at: Setting) -> None:
    """In whatever direction the ball is as far as its distance says, or farther: from without and within."""
    g = at.g
    radius = 0.5
    base = points_between(g, 0.02, 3.5, 1500)
    step = at.run("ball", base, radius)[0]
    end = g.flow(directions(len(base), 43), np.abs(step), base)[0]
    after = g.distance(end) - radius
    assert (np.sign(step) * after >= -32 * at.epsilon * np.maximum(size_of(base), size_of(end))).all()


def first_crossing(g: Geometry, p: Array, u: Array, reach: float, samples: int) -> NDArray[np.float64]:
    """The lengths (N,) at which samples of geodesics are first on the other side of level 0."""
    t = np.linspace(0, reach, samples + 1)[1:]
    count = len(p)
    levels = np.stack([g.flow(u, np.full(count, s), p)[0][:, fibre_column(g.name)] for s in t])
    changed = np.sign(levels) != np.sign(p[:, fibre_column(g.name)])
    first = changed.argmax(axis=0)
    return np.where(changed.any(axis=0), t[first], np.inf)


def test_directed_half_spaces_never_reach_beyond_the_first_crossing(at: Setting) -> None:
    """Nor the other way: they come to it when marched along."""
    g = at.g
    p, u = points_between(g, 0.05, 3, 300), directions(300, 51)
    column = fibre_column(g.name)
    crossing = first_crossing(g, p, u, 4.0, 400)
    sample = 4.0 / 400
    outside = p[:, column] > 0
    for shape in DIRECTED:
        if shape not in shapes_of(g.name):
            continue
        got = at.run(shape, p, directions=u)[0]
        assert (np.sign(got) == np.where(outside, 1, -1)).all()
        # A bisected one may jump over a sliver, which dense samples see.
        passed = np.abs(got) > crossing + 64 * at.epsilon
        assert passed.sum() <= (2 if shape == "bisected_half_space" else 0)
        if g.name in PRODUCTS:
            np.testing.assert_allclose(np.abs(got)[crossing < 4], crossing[crossing < 4], atol=sample + 1e-6)
        q, v, gone = p.copy(), u.copy(), np.zeros(len(p))
        threshold = 1e-9 if at.precision == "double" else 1e-4
        ended = np.zeros(len(p), bool)
        for _ in range(60):
            t = np.where(outside, 1, -1) * at.run(shape, q, directions=v)[0]
            # As in march.h: near enough, or by rounding just beyond it.
            ended |= (t < threshold) | (gone > 4)
            t = np.where(ended, 0, np.minimum(t, 4.0))
            q, v = g.flow(v, t, q)
            gone += t
        meets = (crossing < 3.9) & ~passed
        assert (np.abs(gone - crossing)[meets] < sample + threshold).all(), shape
        assert (np.abs(q[:, column])[meets] < 10 * threshold).all(), shape
        assert (gone[np.isinf(crossing)] > 4 - 2 * sample).mean() > 0.9, shape


def test_bisection_ends_at_the_crossing(at: Setting) -> None:
    """Just short of the probe's length it finds it to rounding; just beyond it goes the probe's length."""
    g = at.g
    if g.name not in TWISTED:
        return
    column = fibre_column(g.name)
    for height in (0.01, 0.124, PROBE - 1e-5, PROBE + 1e-5, 0.3):
        for side in (1, -1):
            p = over(g.name, np.array([0.0]), np.array([0.0]), np.array([side * height]))
            got = at.run("bisected_half_space", p, directions=np.array([[0.0, 0, -side]]))[0, 0]
            assert got == pytest.approx(side * min(height, PROBE), abs=4 * at.epsilon)
            assert p[0, column] * got > 0


def test_nothing_is_lost_at_singular_points(at: Setting) -> None:
    """Centre, fibre axis, antipode, 2 pi up the fibre and beyond: numbers everywhere, normals on balls."""
    g = at.g
    heights = np.array(
        [0, 1e-30, 0.5, 2 * np.pi - 1e-6, 2 * np.pi, 2 * np.pi + 1e-6, 4 * np.pi, 20, -0.5, -7]
    )
    points = [
        over(g.name, 0 * heights, 0 * heights, heights),
        over(g.name, 0 * heights + 1e-20, 0 * heights, heights),
        over(g.name, 0 * heights + 1e-4, 0 * heights, heights),
    ]
    if g.name == "s2xe":
        antipodes = over(g.name, 0 * heights, 0 * heights, heights)
        antipodes[:, 2] = -1
        points.append(antipodes)
    p = np.concatenate(points)
    for shape in shapes_of(g.name):
        got = at.run(shape, p, 0.5)
        assert not np.isnan(got).any(), shape
    # On the surface itself, over the centre and under the antipode.
    d = g.distance(p)
    for k in range(len(p)):
        if d[k] > 1e-3:
            normal = at.run("ball", p[k : k + 1], float(d[k]))[2:5, 0]
            assert np.isfinite(normal).all() and np.linalg.norm(normal) > 0
            if g.name in TWISTED:
                assert np.linalg.norm(normal) == pytest.approx(1, abs=8 * at.epsilon)


def test_no_point_has_no_distance(at: Setting) -> None:
    """A NaN is neither outside nor inside anything."""
    p = np.full((2, 4), np.nan)
    p[1] = over(at.g.name, np.array([0.1]), np.array([0.2]), np.array([0.3]))[0]
    for shape in shapes_of(at.g.name):
        got = at.run(shape, p, 0.5)[0]
        assert np.isnan(got[0]) and not np.isnan(got[1]), shape


def test_far_from_a_ball_its_normal_is_not_looked_for(at: Setting) -> None:
    """Within BALL_SEEN_BELOW the geodesic from the centre is solved for; beyond, the fibre stands."""
    g = at.g
    if g.name not in TWISTED:
        return
    p = points_between(g, 0.9, 1.1, 20)
    d = g.distance(p)
    for side in (1, -1):
        for gap, seen in ((BALL_SEEN_BELOW - 1e-3, True), (BALL_SEEN_BELOW + 1e-3, False)):
            for k in range(len(p)):
                normal = at.run("ball", p[k : k + 1], float(d[k] - side * gap))[2:5, 0]
                assert np.linalg.norm(normal) == pytest.approx(1, abs=8 * at.epsilon)
                assert (abs(normal[2]) < 1) == seen or not seen


def test_sets_of_balls_are_the_nearest_ball(at: Setting) -> None:
    g = at.g
    p = points_between(g, 0, 2, 400)
    got = at.run("ball_set", p, 0.25)
    each = [at.run("ball", g.untranslate(np.broadcast_to(c, p.shape), p), 0.25)[0] for c in centres(g)]
    np.testing.assert_allclose(got[0], np.min(each, axis=0), atol=32 * at.epsilon * size_of(p).max())


def test_coordinates_on_balls(at: Setting) -> None:
    """Longitude and latitude of the direction in which the shortest geodesic leaves the centre."""
    g = at.g
    longitude, latitude = np.array([-3, -1, 0.5, 2.5]), np.array([-1.2, 0, 0.3, 1.5])
    u = np.stack(
        [np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)], axis=1
    )
    got = at.run("ball", g.flow(u, 0.6)[0], 0.6)[5:]
    np.testing.assert_allclose(
        got, [longitude / (2 * np.pi) + 0.5, latitude / np.pi + 0.5], atol=16 * at.epsilon
    )


def test_coordinates_on_the_other_surfaces(at: Setting) -> None:
    g = at.g
    angle, h = np.array([-3, -1, 0.5, 1, 3]), np.array([-1, -0.2, 0, 0.4, 1.3])
    r = sine(g.name, np.array([0.4]))
    round_it = over(g.name, r * np.cos(angle), r * np.sin(angle), h)
    np.testing.assert_allclose(
        at.run("cylinder", round_it, 0.4)[5:], [angle / (2 * np.pi) + 0.5, h], atol=8 * at.epsilon
    )
    along = np.array([-1.2, -0.3, 0, 0.5, 1.1])
    x, y = on_base(g.name, along, 0 * along)
    np.testing.assert_allclose(
        at.run("vertical_half_space", over(g.name, x, y, h))[5:], [along, h], atol=8 * at.epsilon
    )
    aside = np.array([0.3, -0.7, 0, 0.9, -0.6])
    x, y = on_base(g.name, along, aside)
    want = [x, y] if g.name == "nil" else [aside, along]
    for shape in DIRECTED:
        if shape in shapes_of(g.name):
            np.testing.assert_allclose(
                at.run(shape, over(g.name, x, y, 0 * x))[5:], want, atol=8 * at.epsilon
            )
    if g.name in PRODUCTS:
        turned = np.stack([sine(g.name, along), np.cos(angle), np.sin(angle)], axis=0)
        x_points = over(g.name, turned[0], 0 * along, 0 * along)
        ring = over(g.name, 0 * angle, sine(g.name, 0.4 * turned[1]), 0.4 * turned[2])
        got = at.run("level_cylinder", g.translate(x_points, ring), 0.4)
        np.testing.assert_allclose(got[5:], [angle / (2 * np.pi) + 0.5, along], atol=16 * at.epsilon)
        np.testing.assert_allclose(got[0], 0, atol=8 * at.epsilon)


def test_vertical_planes_are_flat(at: Setting) -> None:
    """Squares in the coordinates of a vertical half-space are squares: equal and orthogonal unit steps."""
    g = at.g
    if g.name not in TWISTED:
        return
    step = 1e-4
    for along, h in ((0.0, 0.3), (0.8, -0.5), (-1.3, 2.0)):
        corner, side, up, both = (
            over(
                g.name, *on_base(g.name, np.array([along + i * step]), np.zeros(1)), np.array([h + j * step])
            )
            for i, j in ((0, 0), (1, 0), (0, 1), (1, 1))
        )
        lengths = [g.distance(q, corner)[0] / step for q in (side, up, both)]
        np.testing.assert_allclose(lengths, [1, 1, np.sqrt(2)], rtol=1e-3)


def test_one_lane_does_what_many_do(at: Setting, opencl_device: Device) -> None:
    narrow = Setting(at.g, at.precision, small_kernels(opencl_device, at.g.name, at.precision, 1))
    p, u = points_between(at.g, 0.05, 2, 64), directions(64, 61)
    for shape in shapes_of(at.g.name):
        one, many = narrow.run(shape, p, 0.4, u), at.run(shape, p, 0.4, u)
        finite = np.isfinite(many)
        np.testing.assert_array_equal(finite, np.isfinite(one))
        np.testing.assert_allclose(
            one[finite], many[finite], rtol=64 * at.epsilon, atol=64 * at.epsilon, err_msg=shape
        )


def test_bands(opencl_device: Device) -> None:
    """Line j at u = j/count in colour |j| mod their number, up to both edges; ground elsewhere."""
    count, width, ground, colors = 2.0, 0.25, (0.5, 0.5, 0.5), [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    text = """scene_data scene = {numbers, 0};
  surface s = {REAL(0), {REAL(0), REAL(0), REAL(0), REAL(0)}, IN(0), REAL(0)};
  real3_lanes c = bands(s, scene, 1, 3);
  OUT(0, c.x); OUT(1, c.y); OUT(2, c.z);"""
    for precision in EPSILON:
        parts = (*geometry_parts("e3"), "scene_types.h", "pattern/color_in_turn.h", "pattern/bands.h")
        kernels = SmallKernels(opencl_device, parts, {"bands": Body(1, 3, text)}, precision, LANES)
        numbers = np.array([7.0, count, width, *ground, *np.ravel(colors)])
        for j in (-300, -5, -2, -1, 0, 1, 2, 3, 7, 3 * 333):
            for offset, on in (
                (0, True),
                (0.12, True),
                (-0.12, True),
                (0.13, False),
                (-0.13, False),
                (0.5, False),
            ):
                got = kernels.run("bands", [[(j + offset) / count]], numbers)[:, 0]
                np.testing.assert_array_equal(got, colors[abs(j) % 3] if on else ground)
