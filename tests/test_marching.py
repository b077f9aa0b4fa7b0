"""What the marcher asks of every geometry: its own flow, walls, levels of the fibre, bounds of the distance,
the isometries of sl2. Walls and levels of sol are in tests/test_sol_bounds.py.

Truth are the double-precision flow and distance of the numerical API, which tests/test_golden*.py hold to 25
digits, at the inputs that the kernel has after rounding.
"""

import re
from typing import Any, NamedTuple

import numpy as np
import pytest
from golden import EPSILON, MP, Array, cut
from small_kernels import Body, SmallKernels

from thurston_cl.device import Device
from thurston_cl.geometry import ORIGIN, Geometry
from thurston_cl.models import FIBRED, GEOMETRIES, HOMOGENEOUS, LEFT_INVARIANT, TWISTED
from thurston_cl.program import geometry_parts, kernel_text

FIBRE = {"s2xe": 3, "h2xe": 3, "nil": 2, "sl2": 3}

_RAY = "point p = POINT(0); direction u = {IN(4), IN(5), IN(6)}; vector v = push(p, u);\n"


def _form(v: str) -> str:
    """A wall, inputs 7 to 10, on a vector."""
    return f"(IN(7) * {v}.x + IN(8) * {v}.y + IN(9) * {v}.z + IN(10) * {v}.w)"


BODIES = {
    # point 0-3, direction 4-6, time 7 -> point 0-3, direction 4-6, square of the speed
    "flow": Body(
        8,
        8,
        _RAY
        + """flow(&p, &v, IN(7));
  reproject(&p, &v);
  direction e = pull(p, v);
  OUT(0, p.x); OUT(1, p.y); OUT(2, p.z); OUT(3, p.w);
  OUT(4, e.x); OUT(5, e.y); OUT(6, e.z); OUT(7, inner(p, v, v));""",
    ),
    # the same without flow -> the changes of the point and the direction by reproject
    "reproject": Body(
        8,
        7,
        _RAY
        + """point kept = p; vector before = v;
  reproject(&p, &v);
  direction e = pull(p, add_scaled_4(v, before, REAL(-1)));
  OUT(0, p.x - kept.x); OUT(1, p.y - kept.y); OUT(2, p.z - kept.z); OUT(3, p.w - kept.w);
  OUT(4, e.x); OUT(5, e.y); OUT(6, e.z);""",
    ),
    # point 0-3, direction 4-6, covector 7-10 -> pull(push), the covector on the direction, on velocities
    "frames": Body(
        11,
        7,
        _RAY
        + """direction e = pull(p, v);
  covector g = POINT(7);
  vector ambient = velocity(p, u);
  vector of_wall = wall_velocity(p, v);
  OUT(0, e.x); OUT(1, e.y); OUT(2, e.z);
  OUT(3, dot_3(pull_covector(p, gradient_of(p, g)), u));
  OUT(4, dot_4(g, ambient)); OUT(5, dot_4(g, of_wall)); OUT(6, inner(p, v, v));""",
    ),
    # two points -> distance, under- and overestimate, from the origin exactly
    "bounds": Body(
        4,
        4,
        """point p = POINT(0), zero = scale_4(p, REAL(0));
  mask unsolved;
  OUT(0, distance_between(origin(), p, zero, zero, &unsolved));
  OUT(1, underestimate(p)); OUT(2, overestimate(p)); OUT(3, origin_distance(p));""",
    ),
}
_LEVEL = Body(9, 1, _RAY + "OUT(0, level_time(p, v, IN(7), IN(8)));")


def bodies(name: str) -> dict[str, Body]:
    if name == "sol":
        # Its walls have times of their own.
        frames = BODIES["frames"]
        text = frames.text.replace("wall_velocity(p, v)", "velocity(p, u)")
        return {**BODIES, "frames": frames._replace(text=text)}
    fifth = " + IN(11)" if HOMOGENEOUS[name] == 5 else ""
    aside = "wall_turning(p, v)" if name in TWISTED else "v"
    wall = (
        f"{_RAY} vector ahead = wall_velocity(p, v), aside = {aside};\n"
        f"real form = {_form('p')}{fifth}, rate = {_form('ahead')}, turning = {_form('aside')};\n"
        "OUT(0, crossing_time(wall_ratio(v, -form, rate, turning), v)); OUT(1, -form); OUT(2, rate);"
    )
    found = {**BODIES, "wall": Body(12, 3, wall)}
    if name in FIBRED:
        found["level"] = _LEVEL
    if name == "sl2":
        gain = "point q = with_fibre_gain(POINT(0), POINT(4), IN(8), IN(9), IN(10), IN(11)); OUT(0, q.w);"
        found["gain"] = Body(12, 1, gain)
    return found


class Setting(NamedTuple):
    name: str
    precision: str
    kernels: SmallKernels
    g: Geometry

    @property
    def epsilon(self) -> float:
        return EPSILON[self.precision]

    def cut(self, values: Any) -> Array:
        """Values rounded to the precision."""
        return cut(values, self.precision)

    def run(self, body: str, *columns: Any) -> Array:
        rows = np.concatenate(
            [np.asarray(c, dtype=np.float64).reshape(len(columns[0]), -1) for c in columns], axis=1
        )
        return self.kernels.run(body, rows.T).T.astype(np.float64)


WIDTHS = {"single": (1, 16), "double": (8,)}
SETTINGS = [(name, p, lanes) for name in GEOMETRIES for p, widths in WIDTHS.items() for lanes in widths]


def prepare(setting: tuple[str, str, int], device: Device) -> Setting:
    name, precision, lanes = setting
    kernels = SmallKernels(device, geometry_parts(name), bodies(name), precision, lanes)
    return Setting(name, precision, kernels, Geometry(name, "double", device, lanes=8))


def identifier(setting: tuple[str, str, int]) -> str:
    return "-".join(map(str, setting))


@pytest.fixture(scope="module", params=SETTINGS, ids=identifier)
def at(request: pytest.FixtureRequest, opencl_device: Device) -> Setting:
    return prepare(request.param, opencl_device)


@pytest.fixture(scope="module", params=[s for s in SETTINGS if s[0] != "sol"], ids=identifier)
def walled(request: pytest.FixtureRequest, opencl_device: Device) -> Setting:
    return prepare(request.param, opencl_device)


@pytest.fixture(scope="module", params=[s for s in SETTINGS if s[0] in FIBRED], ids=identifier)
def fibred(request: pytest.FixtureRequest, opencl_device: Device) -> Setting:
    return prepare(request.param, opencl_device)


@pytest.fixture(scope="module", params=[s for s in SETTINGS if s[0] == "sl2"], ids=identifier)
def sl2(request: pytest.FixtureRequest, opencl_device: Device) -> Setting:
    return prepare(request.param, opencl_device)


def on_model(name: str, p: Array) -> Array:
    """The point of the model over rounded coordinates: single ones are off it by more than double allows."""
    p = p.copy()
    square = (p[:, :2] ** 2).sum(axis=1)
    if name in ("h2xe", "sl2"):
        p[:, 2] = np.sqrt(1 + square)
    elif name == "h3":
        p[:, 3] = np.sqrt(1 + square + p[:, 2] ** 2)
    elif name == "s2xe":
        p[:, :3] /= np.linalg.norm(p[:, :3], axis=1, keepdims=True)
    elif name == "s3":
        p /= np.linalg.norm(p, axis=1, keepdims=True)
    return p


def points(name: str, count: int, radius: float, rng: np.random.Generator) -> Array:
    """Points (N,4) about as far as `radius` from the origin, those of nil and sl2 as high along the fibre."""
    v = rng.normal(size=(count, 3))
    v *= (radius * rng.uniform(0, 1, count) / np.linalg.norm(v, axis=1))[:, None]
    r, across = np.linalg.norm(v, axis=1), np.linalg.norm(v[:, :2], axis=1)
    one = np.ones(count)
    match name:
        case "e3" | "nil" | "sol":
            return np.column_stack([v, one])
        case "s3":
            return np.column_stack([v * (np.sin(r) / r)[:, None], np.cos(r)])
        case "h3":
            return np.column_stack([v * (np.sinh(r) / r)[:, None], np.cosh(r)])
        case "s2xe":
            return np.column_stack([v[:, :2] * (np.sin(across) / across)[:, None], np.cos(across), v[:, 2]])
        case _:
            return np.column_stack([v[:, :2] * (np.sinh(across) / across)[:, None], np.cosh(across), v[:, 2]])


def directions(count: int, rng: np.random.Generator) -> Array:
    """Unit directions (N,3): any; and along, across and on the cone |c| = a, exactly or nearly."""
    u = rng.normal(size=(count, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    near = np.where(rng.random(count) < 0.2, 0, 10.0 ** rng.uniform(-12, -1, count)) * rng.choice(
        [-1, 1], count
    )
    angle, kind = np.arctan2(u[:, 1], u[:, 0]), np.arange(count) % 6
    polar = np.select(
        [kind == 1, kind == 2, kind == 3], [near, np.pi / 2 + near, np.pi / 4 + near], np.arccos(u[:, 2])
    )
    polar = np.where((kind == 3) & (u[:, 2] < 0), np.pi - polar, polar)
    return np.column_stack([np.sin(polar) * np.cos(angle), np.sin(polar) * np.sin(angle), np.cos(polar)])


def unit(u: Array) -> Array:
    return u / np.linalg.norm(u, axis=1, keepdims=True)


def homogeneous(name: str, p: Array) -> Array:
    return np.concatenate([p, np.ones((*p.shape[:-1], 1))], axis=-1)[..., : HOMOGENEOUS[name]]


def rays(at: Setting, count: int, radius: float, seed: int) -> tuple[Array, Array]:
    """Points and directions, numbers of the precision."""
    rng = np.random.default_rng(seed)
    p = points(at.name, count, radius, rng)
    # Some on the fibre through the origin, some at the origin.
    if at.name in FIBRED:
        p[::7, :2] = 0
        if at.name != "nil":
            p[::7, 2] = 1
    p[::49] = ORIGIN[at.name]
    return at.cut(p), at.cut(directions(count, rng))


def follow(at: Setting, p: Array, u: Array, times: Array) -> Array:
    """The points (N,T,4) of the exact flow at `times` (N,T)."""
    steps = times.shape[1]
    base, ahead = np.repeat(on_model(at.name, p), steps, axis=0), np.repeat(unit(u), steps, axis=0)
    return at.g.flow(ahead, times.reshape(-1), base)[0].reshape(len(p), steps, 4)


def size_of(p: Array) -> Array:
    return np.abs(p).max(axis=-1)


# -- the flow ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("t", [0.0, 1e-5, 0.01, 0.7, 3.0])
def test_the_marchers_flow_is_the_flow(at: Setting, t: float) -> None:
    """And in two parts it is the same; lengths are kept."""
    p, u = rays(at, 600, 2, 1)
    t = float(at.cut(t))
    got = at.run("flow", p, u, np.full(600, t))
    base = on_model(at.name, p)
    want, ahead = at.g.flow(unit(u), t, base)
    # Ambient velocities round to the size of the coordinates, and that grows with the flow.
    growth = size_of(p) * size_of(want) * np.cosh(t)
    allowed = 24 * at.epsilon * growth
    assert (size_of(got[:, :4] - want) <= allowed).all()
    assert (size_of(got[:, 4:7] - ahead) <= allowed).all()
    assert (np.abs(got[:, 7] - 1) <= 24 * at.epsilon * size_of(want) ** 2).all()
    again = at.run("flow", at.cut(got[:, :4]), at.cut(unit(got[:, 4:7])), np.full(600, t))
    both, _ = at.g.flow(unit(u), 2 * t, base)
    assert (size_of(again[:, :4] - both) <= 4 * allowed * size_of(both) * np.cosh(t)).all()


def test_reproject_changes_nothing_but_rounding(at: Setting) -> None:
    p, u = rays(at, 600, 2, 2)
    got = at.run("reproject", p, u, np.zeros(600))
    # Coordinates of single precision are off the model by the rounding of their squares.
    assert (size_of(got) <= 4 * at.epsilon * size_of(p) ** 2).all()


def test_frames_gradients_and_velocities_belong_together(at: Setting) -> None:
    p, u = rays(at, 600, 2, 3)
    g = np.random.default_rng(4).normal(size=(600, 4))
    if at.name in ("nil", "sol"):
        g[:, 3] = 0
    got = at.run("frames", p, u, g)
    allowed = 32 * at.epsilon * size_of(p) ** 2
    assert (size_of(got[:, :3] - u) <= allowed).all()
    assert (np.abs(got[:, 6] - 1) <= allowed).all()
    want = (g * at.g.velocity(on_model(at.name, p), unit(u))).sum(axis=1)
    for k in (3, 4, 5):
        assert (np.abs(got[:, k] - want) <= allowed * size_of(g)).all(), k


def test_bounds_hold_the_distance_between_them(at: Setting) -> None:
    rng = np.random.default_rng(5)
    radii = (1e-6, 1e-2, 1.0, 3.0, 3.0 if at.name in ("s3", "s2xe") else 9.0)
    p = at.cut(np.concatenate([points(at.name, 200, radius, rng) for radius in radii]))
    exact, below, above, from_origin = at.run("bounds", p).T
    want = at.g.distance(on_model(at.name, p))
    # s3 and h3: near the origin single coordinates alone fix a point.
    units = 8 * at.epsilon * (want + at.epsilon)
    assert (below <= want + units).all() and (want <= above + units).all()
    assert (np.abs(from_origin - want) <= 2 * units).all() and (np.abs(exact - want) <= 2 * units).all()
    if at.name not in LEFT_INVARIANT:
        assert (np.abs(below - want) <= units).all() and (np.abs(above - want) <= units).all()
    else:
        assert (above <= 2 * want + units).all() or at.name == "nil"


# -- walls ---------------------------------------------------------------------------------------------------

# In these units of EPSILON, times the sizes of wall and point: how far from a wall a crossing may be found.
WALL_UNITS = 48.0


def side_walls(at: Setting, p: Array, q: Array, rng: np.random.Generator) -> Array:
    """Walls (N,n) through points `q` at random angles, with `p` inside."""
    n = walls_across(
        at, q, unit(rng.normal(size=(len(q), 3)) * ([1, 1, 0] if at.name in FIBRED else [1, 1, 1]))
    )
    return facing(at, n, p)


def facing(at: Setting, n: Array, p: Array) -> Array:
    """The same walls with `p` inside."""
    return n * np.where((n * homogeneous(at.name, p)).sum(axis=1) > 0, -1, 1)[:, None]


def grazing_walls(at: Setting, p: Array, u: Array, t: Array, miss: Array, rng: np.random.Generator) -> Array:
    """Walls (N,n) that the ray touches at time `t`, moved out by `miss`: negative ones are crossed."""
    reached, ahead = at.g.flow(u, t, p)
    aside = np.column_stack([-ahead[:, 1], ahead[:, 0], np.zeros(len(ahead))])
    normal = aside if at.name in FIBRED else np.cross(ahead, rng.normal(size=ahead.shape))
    # Up the fibre there is no wall to touch, and any will do.
    normal = unit(np.where(np.linalg.norm(normal, axis=1, keepdims=True) > 0, normal, [1.0, 0, 0]))
    return walls_across(at, at.g.flow(normal, miss, reached)[0], normal)


def walls_across(at: Setting, q: Array, normal: Array) -> Array:
    """The walls (N,n) through `q` with these unit normals in the frames there."""
    matrix = np.linalg.inv(at.g.translation_matrix(q))
    n = np.einsum("ni,nij->nj", np.pad(normal, ((0, 0), (0, HOMOGENEOUS[at.name] - 3))), matrix)
    if at.name in FIBRED:
        n[:, FIBRE[at.name]] = 0
    return n


def check_crossings(at: Setting, p: Array, u: Array, n: Array, horizon: float) -> tuple[Array, Array]:
    """No sample before the time found is beyond the wall; there the ray is on it. Times, heights."""
    n = at.cut(n)
    got, height, _ = at.run("wall", p, u, np.pad(n, ((0, 0), (0, 5 - HOMOGENEOUS[at.name])))).T
    inside = height > 0
    p, u, n, got = p[inside], u[inside], n[inside], got[inside]
    ended = np.where(got < horizon, got, horizon)
    times = ended[:, None] * np.linspace(0, 1, 401)
    way = follow(at, p, u, times)
    form = np.einsum("ntk,nk->nt", homogeneous(at.name, way), n)
    slack = WALL_UNITS * at.epsilon * (size_of(way) * size_of(n)[:, None]) * size_of(p)[:, None] * (1 + times)
    beyond = (form > slack).any(axis=1)
    assert not beyond.any(), (p[beyond][:3], u[beyond][:3], n[beyond][:3], got[beyond][:3])
    off = (got < horizon) & (np.abs(form[:, -1]) > slack[:, -1])
    assert not off.any(), (
        p[off][:3],
        u[off][:3],
        n[off][:3],
        got[off][:3],
        form[off, -1][:3],
        slack[off, -1][:3],
    )
    assert not np.isnan(got).any() and (got > 0).all()
    return got, height[inside]


def test_walls_are_crossed_first_where_it_is_said(walled: Setting) -> None:
    at, rng = walled, np.random.default_rng(6)
    p, u = rays(at, 1500, 1.5, 7)
    q = points(at.name, 1500, 2.0, rng)
    got, _ = check_crossings(at, p, u, side_walls(at, on_model(at.name, p), q, rng), 8.0)
    crossed = np.isfinite(got).mean()
    assert crossed > 0.2 and ((crossed < 1) or at.name == "s3")


def test_walls_that_are_grazed(walled: Setting) -> None:
    """Nearly tangent to the way, crossed or missed by little: it may be either, by rounding."""
    at, rng = walled, np.random.default_rng(8)
    p, u = rays(at, 1000, 1.0, 9)
    start, ahead = on_model(at.name, p), unit(u)
    t = rng.uniform(0.1, 2.0, 1000)
    for sign in (1, -1):
        miss = sign * 10.0 ** rng.uniform(-9 if at.precision == "double" else -4, -1, 1000)
        n = grazing_walls(at, start, ahead, t, miss, rng)
        check_crossings(at, p, u, facing(at, n, start), 6.0)


def test_walls_next_to_the_start(walled: Setting) -> None:
    """Heights down to rounding, on rays that leave the wall and come to it."""
    at, rng = walled, np.random.default_rng(10)
    p, u = rays(at, 1000, 1.0, 11)
    start = on_model(at.name, p)
    normal = unit(rng.normal(size=(1000, 3)) * ([1, 1, 0] if at.name in FIBRED else [1, 1, 1]))
    height = 10.0 ** rng.uniform(-14 if at.precision == "double" else -6, -1, 1000)
    q, _ = at.g.flow(normal, height, start)
    n = walls_across(at, q, normal)
    check_crossings(at, p, u, facing(at, n, start), 6.0)


def test_the_greatest_ratio_is_the_first_crossing(walled: Setting) -> None:
    """crossing_time falls with the ratio, over both signs and every kind of direction."""
    at = walled
    _, u = rays(at, 600, 1.0, 12)
    ratios = np.sort(
        np.concatenate([[-np.inf], -(10.0 ** np.arange(-6, 7)), [0.0], 10.0 ** np.arange(-6, 7)])
    )
    body = Body(8, 1, _RAY + "OUT(0, crossing_time(IN(7), v));")
    kernels = SmallKernels(
        at.kernels.device, geometry_parts(at.name), {"time": body}, at.precision, at.kernels.lanes
    )
    o = np.broadcast_to(ORIGIN[at.name], (600, 4))
    times = np.array(
        [kernels.run("time", np.column_stack([o, u, np.full(600, r)]).T)[0] for r in ratios], dtype=np.float64
    )
    assert (times > 0).all()
    # Equal ones may differ in the last digit.
    later, sooner = times[:-1], times[1:]
    assert ((sooner <= later * (1 + 4 * at.epsilon)) | np.isinf(later)).all()
    if at.name in TWISTED:
        assert np.isinf(times[0]).all()


@pytest.mark.parametrize("precision", EPSILON)
def test_meeting_times(precision: str, opencl_device: Device) -> None:
    """What meeting.h states, in 50 digits: over k from nearly 0, ratios of both signs and down to k."""
    stated = re.search(r"(\d+) EPSILON", kernel_text("special/meeting.h"))
    assert stated is not None
    allowed = float(stated[1]) * EPSILON[precision]
    one = "OUT(0, {}_meeting(IN(0), IN(1)));"
    each = {name: Body(2, 1, one.format(name)) for name in ("circular", "hyperbolic")}
    parts = ("lanes.h", "special/elementary.h", "special/meeting.h")
    kernels, rng = SmallKernels(opencl_device, parts, each, precision, 4), np.random.default_rng(19)
    k = cut(10.0 ** rng.uniform(-12, 2, 500), precision)
    ratio = cut(10.0 ** rng.uniform(-6, 6, 500) * rng.choice([-1, 1], 500), precision)
    above = cut(k * (1 + 10.0 ** rng.uniform(-6, 8, 500)), precision)
    circular = kernels.run("circular", [ratio, k])[0]
    hyperbolic = kernels.run("hyperbolic", [above, k])[0]
    for n in range(500):
        a, r, h = (MP.mpf(float(x[n])) for x in (k, ratio, above))
        assert abs(MP.mpf(float(circular[n])) * a / MP.atan2(a, r) - 1) <= allowed, (ratio[n], k[n])
        if h > a:
            assert abs(MP.mpf(float(hyperbolic[n])) * a / MP.atanh(a / h) - 1) <= allowed, (above[n], k[n])
    none = kernels.run("hyperbolic", [[1.0, 0.5, -1.0, 0.0, 4.0], [1.0, 1.0, 1.0, 0.0, 0.0]])[0]
    assert none.tolist() == [np.inf, np.inf, np.inf, np.inf, 0.25]


@pytest.mark.parametrize("name", TWISTED)
def test_crossing_time_in_long_arithmetic(name: str, opencl_device: Device) -> None:
    """t from r = k cot(k t/2) with 50 digits, over k^2 from elliptic to hyperbolic and to 0."""
    body = Body(4, 1, "vector v = {IN(1), IN(2), IN(3), REAL(0)}; OUT(0, crossing_time(IN(0), v));")
    steps = (0.0, *(s * 10.0**-e for e in range(1, 17) for s in (1, -1)))
    null = np.pi / 4 if name == "sl2" else np.pi / 2
    polar = np.array([null + e for e in steps] + [0.0, 1e-9, 0.3, 1.2, 1.5])
    for precision, epsilon in EPSILON.items():
        kernels = SmallKernels(opencl_device, geometry_parts(name), {"time": body}, precision, 1)
        u = np.column_stack([np.sin(polar), 0 * polar, np.cos(polar)]).astype(kernels.dtype)
        for ratio in (-30.0, -0.5, -1e-3, 1e-3, 0.5, 1.0625, 30.0, 1e5):
            r = np.full(len(u), ratio).astype(kernels.dtype)
            got = kernels.run("time", np.column_stack([r, u]).T)[0]
            for k in range(len(u)):
                a, c = MP.mpf(float(u[k, 0])), MP.mpf(float(u[k, 2]))
                square, value = (c - a) * (c + a) if name == "sl2" else c * c, MP.mpf(float(r[k]))
                root = MP.sqrt(abs(square))
                if square > 0:
                    want = 2 * MP.atan2(root, value) / root
                elif value <= root:
                    assert np.isinf(got[k]), (ratio, u[k], got[k])
                    continue
                else:
                    want = 2 / value if square == 0 else 2 * MP.atanh(root / value) / root
                condition = 1 + float(root / abs(value - root)) if square < 0 else 1.0
                assert abs(MP.mpf(float(got[k])) / want - 1) <= 6 * epsilon * condition, (
                    precision,
                    ratio,
                    u[k],
                )


# -- levels of the fibre -------------------------------------------------------------------------------------


def test_level_time_is_never_too_late(fibred: Setting) -> None:
    at, rng = fibred, np.random.default_rng(13)
    p, u = rays(at, 4000, 2.5, 14)
    above, below = at.cut(10.0 ** rng.uniform(-5, 0.7, (2, 4000)))
    bound = at.run("level", p, u, above, below)[:, 0]
    assert (bound > 0).all()
    times = np.minimum(bound, 12.0)[:, None] * np.linspace(0, 1, 201)
    height = follow(at, p, u, times)[..., FIBRE[at.name]] - p[:, None, FIBRE[at.name]]
    slack = WALL_UNITS * at.epsilon * (1 + size_of(p))[:, None] * (1 + times)
    assert (height <= above[:, None] + slack).all() and (height >= -below[:, None] - slack).all()
    if at.name not in TWISTED:
        end, finite = height[:, -1], bound < 12
        assert (np.minimum(np.abs(end - above), np.abs(end + below))[finite] <= slack[finite, -1]).all()


# Steps, mean and most, in which rays reach a level to 1e-5 in cells like those of the lattices of math 3, 4.
LEVEL_STEPS = {"s2xe": (1.0, 1), "h2xe": (1.0, 1), "nil": (2.5, 24), "sl2": (3.5, 12)}


@pytest.mark.parametrize("name", FIBRED)
def test_levels_are_reached_in_few_steps(name: str, opencl_device: Device) -> None:
    at, rng = prepare((name, "double", 8), opencl_device), np.random.default_rng(15)
    half = 0.5 if at.name == "nil" else np.pi
    p = points(at.name, 1500, 0.7 if at.name == "nil" else 1.8, rng)
    p[:, FIBRE[at.name]] = half * rng.uniform(-1, 1, 1500)
    u, q, t, steps = unit(directions(1500, rng)), p, np.zeros(1500), np.zeros(1500)
    w, level, ahead = q[:, FIBRE[at.name]], np.zeros(1500, dtype=bool), u
    for _ in range(60):
        level |= np.abs(q[:, FIBRE[at.name]]) >= half
        bound = at.run(
            "level", q, ahead, np.maximum(half - w, 1e-9) + 2e-6, np.maximum(half + w, 1e-9) + 2e-6
        )[:, 0]
        moving = ~level & (t < 8)
        steps += moving
        step = np.where(moving, np.minimum(bound + 1e-5, 8), 0)
        q, ahead = at.g.flow(unit(ahead), step, q)
        t, w = t + step, q[:, FIBRE[at.name]]
        if not moving.any():
            break
    mean, most = LEVEL_STEPS[at.name]
    assert level.mean() > 0.5 and (np.abs(w) <= half + 1e-4).all()
    assert steps[level].mean() <= mean and steps[level].max() <= most, (steps[level].mean(), steps.max())


def test_the_fibre_itself_comes_to_levels_exactly(fibred: Setting) -> None:
    at = fibred
    heights = at.cut(10.0 ** np.linspace(-6, 2, 50))
    p = at.cut(points(at.name, 50, 1.0, np.random.default_rng(16)))
    for sign in (1.0, -1.0):
        u = np.broadcast_to([0.0, 0.0, sign], (50, 3))
        for other in (np.full(50, np.inf), heights / 2):
            above, below = (heights, other) if sign > 0 else (other, heights)
            got = at.run("level", p, u, above, below)[:, 0]
            np.testing.assert_allclose(got, heights, rtol=8 * at.epsilon)
        free = at.run("level", p, u, np.full(50, np.inf), np.full(50, np.inf))[:, 0]
        assert np.isinf(free).all()
    flat = np.broadcast_to([1.0, 0.0, 0.0], (50, 3))
    o = np.broadcast_to(ORIGIN[at.name], (50, 4))
    still = at.run("level", o, flat, heights, heights)[:, 0]
    # Horizontal geodesics from the origin stay level: products see it, the others see that it takes long.
    assert (np.isinf(still) if at.name not in TWISTED else still >= np.sqrt(heights)).all()


# -- isometries and families of geodesics -----------------------------------------------------------------


def test_translations_as_matrices(at: Setting) -> None:
    """They lead points where translate does; in sl2 but for what the fibre gains."""
    g = Geometry(at.name, at.precision, at.g.device, lanes=at.kernels.lanes)
    rng = np.random.default_rng(18)
    p, base = (points(at.name, 60, 1.5, rng) for _ in range(2))
    matrix = g.translation_matrix(base)
    assert matrix.shape == (60, HOMOGENEOUS[at.name], HOMOGENEOUS[at.name])
    got = np.einsum("nij,nj->ni", matrix, homogeneous(at.name, p))
    moved = g.translate(base, p)
    if at.name == "sl2":
        row, sense = matrix[:, 2, :3], np.ones(60)
        got[:, 3] = at.run("gain", p, got[:, :4], row, sense)[:, 0]
    if HOMOGENEOUS[at.name] == 5:
        assert (got[:, 4] == 1).all()
    assert (size_of(got[:, :4] - moved) <= 32 * at.epsilon * size_of(p) * size_of(base)).all()


# A point, the base, and how many of the first five geodesics between them are members of families.
_O, _UP = (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 1.0, 7.0)
FAMILIES = {
    "e3": [((0, 0, 1, 1), (0, 0, 0, 1), [0, 0, 0, 0, 0])],
    "h3": [((0, 0, 0, 1), (0, 0, 0, 1), [0, 0, 0, 0, 0])],
    "s3": [
        ((0, 0, 0, -1), (0, 0, 0, 1), [1, 1, 1, 1, 1]),
        ((0, 0, 0, 1), (0, 0, 0, 1), [0, 1, 1, 1, 1]),
        ((0.6, 0, 0, 0.8), (0, 0, 0, 1), [0, 0, 0, 0, 0]),
    ],
    "s2xe": [
        ((0, 0, -1, 2), _O, [1, 1, 1, 1, 1]),
        (_UP, _O, [0, 1, 1, 1, 1]),
        ((-0.6, 0, -0.8, 1), (0.6, 0, 0.8, 0), [1, 1, 1, 1, 1]),
        ((0.6, 0, 0.8, 1), _O, [0, 0, 0, 0, 0]),
    ],
    "h2xe": [(_UP, _O, [0, 0, 0, 0, 0])],
    "nil": [
        ((0, 0, 13, 1), (0, 0, 0, 1), [1, 1, 0, 0, 0]),
        ((1, 2, -9, 1), (1, 2, 0, 1), [1, 0, 0, 0, 0]),
        ((0.5, 0, 13, 1), (0, 0, 0, 1), [0, 0, 0, 0, 0]),
        ((0, 0, 6, 1), (0, 0, 0, 1), [0, 0, 0, 0, 0]),
    ],
    "sl2": [
        (_UP, _O, [1, 0, 0, 0, 0]),
        ((0.75, 0, 1.25, 2), (0.75, 0, 1.25, -11), [1, 1, 0, 0, 0]),
        ((0.75, 0, 1.25, 7), _O, [0, 0, 0, 0, 0]),
    ],
    "sol": [
        ((0, 0, 7, 1), (0, 0, 0, 1), [0, 0, 0, 0, 0]),
        ((20, 15, 0.5, 1), (0, 0, 0, 1), [0, 0, 0, 0, 0]),
    ],
}


def test_families_of_geodesics_are_flagged(at: Setting) -> None:
    """And nothing else: in nil and sl2 the fibre itself, which comes last, belongs to none."""
    g = Geometry(at.name, at.precision, at.g.device, lanes=at.kernels.lanes)
    for q, p, want in FAMILIES[at.name]:
        u, lengths, family = g.geodesics(q, 5, p, families=True)
        assert family.dtype == bool and family[0].tolist() == [bool(f) for f in want], (q, p)
        assert not family[np.isnan(lengths)].any()
        without = g.geodesics(q, 5, p)
        np.testing.assert_array_equal(without[0], u)
        np.testing.assert_array_equal(without[1], lengths)


def turn_5(angle: float) -> Array:
    matrix = np.eye(5)
    matrix[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return matrix


def apply_sl2(at: Setting, matrix: Array, p: Array) -> Array:
    q = (homogeneous("sl2", p) @ matrix.T)[:, :4]
    row, sense = np.broadcast_to(matrix[2, :3], (len(p), 3)), np.full(len(p), matrix[3, 3])
    q[:, 3] = at.run("gain", p, q, row, sense)[:, 0]
    return q


@pytest.mark.parametrize("flipped", [False, True])
def test_fibre_gain_makes_isometries_of_matrices(sl2: Setting, flipped: bool) -> None:
    """They agree with translate, compose, and keep distances; the flip x <-> y turns the fibre over."""
    at, rng = sl2, np.random.default_rng(17)
    p, q = (points("sl2", 200, 1.5, rng) for _ in range(2))
    base = points("sl2", 1, 1.5, rng)
    translation = at.g.translation_matrix(base)[0]
    # Translations turn the base about the origin by the fibre coordinate of their own: this one moves only.
    units = 40 * at.epsilon * (size_of(p) * size_of(base[0])) ** 2
    got = apply_sl2(at, translation, p)
    assert (size_of(got - at.g.translate(base, p)) <= units).all()
    flip = np.diag([1.0, 1, 1, -1, 1])[[1, 0, 2, 3, 4]]
    matrix = translation @ turn_5(0.7) @ (flip if flipped else np.eye(5))
    matrix[3, 3] = -1 if flipped else 1
    moved = apply_sl2(at, matrix, p), apply_sl2(at, matrix, q)
    np.testing.assert_allclose(
        at.g.distance(on_model("sl2", moved[0]), on_model("sl2", moved[1])),
        at.g.distance(p, q),
        atol=float(units.max()),
    )
    by_parts = np.array(p)
    if flipped:
        by_parts = p[:, [1, 0, 2, 3]] * [1, 1, 1, -1]
    by_parts[:, :2] = by_parts[:, :2] @ turn_5(0.7)[:2, :2].T
    assert (size_of(moved[0] - at.g.translate(base, by_parts)) <= units).all()
