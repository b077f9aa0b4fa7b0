"""The camera moves by parallel transport (paper 3.4): against the matrices of the golden records, and against
the transport equation integrated in coordinates, along paths with turns and around closed loops.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
import twisted
from golden import Array, Case, exact, inputs, rounded
from golden import on_model as isotropic_points
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.models import GEOMETRIES
from thurston_cl.scene import schema
from thurston_cl.scene.placement import CameraFrame, Placement

# The coordinates that chart the points near the origin.
CHART = {name: (0, 1, 3) if name in ("s2xe", "h2xe", "sl2") else (0, 1, 2) for name in GEOMETRIES}
CURVATURE = {"e3": 0, "s3": 1, "h3": -1, "s2xe": 1, "h2xe": -1, "sl2": -1}


def camera(at: Array, along: Array, up: Array, *moves: dict[str, Any]) -> schema.Camera:
    return schema.Camera.model_construct(
        at=schema.ModelPoint(model=tuple(at)),
        look=schema.Look.model_construct(along=tuple(along), up=tuple(up), to=None),
        move=tuple(schema.Step(**move) for move in moves),
    )


# -- golden records ------------------------------------------------------------------------------------------

# The camera's computation is in double; relative to the size of the coordinates at both ends and the time.
GOLDEN_UNITS = 2e-14


# The golden records of sol are of another form: tests/test_golden_sol.py has its transport.
RECORDED = [name for name in GEOMETRIES if name != "sol"]


def bases(case: Case) -> Array:
    if case.geometry in twisted.ORIGIN:
        return rounded(twisted.as_points(case.geometry, case.column("base")))
    x = inputs(case.column("base"))
    if case.geometry in ("s2xe", "h2xe"):
        k = CURVATURE[case.geometry]
        return np.array([[a, b, np.sqrt(1 - k * (a * a + b * b)), w] for a, b, w in rounded(x)])
    return rounded(isotropic_points(case.geometry, x))


def transported(case: Case, g: Geometry, start: Array, frames: Array, k: int) -> Array:
    """Ambient velocities (3,4) of a frame carried along by the matrix of record `k`, or directions."""
    if case.geometry in twisted.ORIGIN:
        return frames @ rounded(exact(case.column("Q")[k])).T
    matrix = np.eye(4)
    given = rounded(exact(case.column("transport")[k]))
    matrix[: len(given), : len(given)] = given
    return g.velocity(start, frames) @ matrix.T


@pytest.mark.parametrize("name", RECORDED)
def test_a_move_is_the_transport_of_the_records(name: str, opencl_device: Device) -> None:
    """A camera that looks along the geodesic of a record, tipped at random, and goes forward."""
    g = Geometry(name, "double", opencl_device)
    case, place, rng = Case(name, "main", "flow"), Placement(g), np.random.default_rng(1)
    starts, u = bases(case), rounded(inputs(case.column("u")))
    times = rounded(inputs(case.column("t")))
    for k in range(len(u)):
        up = rng.normal(size=3)
        still = CameraFrame(camera(starts[k], u[k], up), place)
        moved = CameraFrame(camera(starts[k], u[k], up, {"forward": float(times[k])}), place)
        want = transported(case, g, starts[k], still.frame, k)
        got = moved.frame if name in twisted.ORIGIN else g.velocity(moved.point, moved.frame)
        sizes = np.abs(starts[k]).max() * max(1.0, np.abs(moved.point).max())
        assert np.abs(got - want).max() <= GOLDEN_UNITS * (1 + times[k]) * sizes, (name, k)
        np.testing.assert_allclose(moved.frame @ moved.frame.T, np.eye(3), atol=1e-13)


# -- the equation of parallel transport ----------------------------------------------------------------------


def metric(name: str, x: Any) -> Any:
    """The metric (3,3) of the chart at `x` (3,), which may be complex (paper 7.1-7.3, 8.1, 9.1, 10.1, 11)."""
    if name == "sol":
        return np.diag([np.exp(-2 * x[2]), np.exp(2 * x[2]), 1 + 0 * x[2]])
    g = np.eye(3, dtype=np.asarray(x).dtype)
    if name == "nil":
        form = np.array([x[1] / 2, -x[0] / 2, 1])
        return np.diag([1, 1, 0]) + np.outer(form, form)
    k, n = CURVATURE[name], 3 if name in ("e3", "s3", "h3") else 2
    g[:n, :n] += k * np.outer(x[:n], x[:n]) / (1 - k * (x[:n] @ x[:n]))
    if name == "sl2":
        # dw + (x dy - y dx)/(1 + z), z the height on the sheet: (cosh rho - 1) d theta.
        height = np.sqrt(1 + x[0] * x[0] + x[1] * x[1])
        form = np.array([-x[1] / (1 + height), x[0] / (1 + height), 1])
        g[2, 2] = 0
        g = g + np.outer(form, form)
    return g


def christoffel(name: str, x: Array) -> Array:
    """Gamma^i_jk (3,3,3) from derivatives by complex steps, which do not cancel."""
    step = 1e-30
    d = np.stack([metric(name, x + 1j * step * e).imag / step for e in np.eye(3)])
    lowered = 0.5 * (np.einsum("jik->ijk", d) + np.einsum("kij->ijk", d) - d)
    return np.einsum("il,ljk->ijk", np.linalg.inv(metric(name, x)), lowered)


def carried(name: str, x: Array, v: Array, frame: Array, t: float) -> tuple[Array, Array, Array]:
    """Point, velocity (3,) and vectors (N,3) carried along the geodesic for the time `t`, in the chart."""

    def rate(_: float, state: Array) -> Array:
        at, rows = state[:3], state[3:].reshape(-1, 3)
        turns = np.einsum("ijk,j,nk->ni", christoffel(name, at), rows[0], rows)
        return np.concatenate([rows[0], -turns.reshape(-1)])

    start = np.concatenate([x, v, frame.reshape(-1)])
    end = solve_ivp(rate, (0.0, t), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return end[:3], end[3:6], end[6:].reshape(-1, 3)


def in_chart(g: Geometry, point: Array, rows: Array) -> Array:
    """Directions (N,3) in the frame at a point as vectors (N,3) of the chart."""
    return g.velocity(point, rows)[:, list(CHART[g.name])]


def start_point(g: Geometry) -> Array:
    """A point off the origin and off the fibre through it."""
    u = np.array([0.48, 0.6, 0.64])
    return g.flow(u, 0.5)[0][0]


PATH: Sequence[dict[str, Any]] = (
    {"forward": 0.4},
    {"yaw": "50 deg"},
    {"right": 0.3},
    {"up": -0.35},
    {"roll": "-40 deg"},
    {"forward": -0.3},
    {"pitch": "65 deg"},
    {"forward": 0.45},
)
# Integration to 1e-12, and rounding of both sides.
AGREED = 2e-10


@pytest.mark.parametrize("name", GEOMETRIES)
def test_a_path_of_the_camera_follows_the_transport_equation(name: str, opencl_device: Device) -> None:
    g = Geometry(name, "double", opencl_device)
    place, point = Placement(g), start_point(g)
    look = (np.array([0.2, 1.0, 0.3]), np.array([0.1, -0.2, 1.0]))
    frame = in_chart(g, point, CameraFrame(camera(point, *look), place).frame)
    x = point[list(CHART[name])]
    for done in range(len(PATH)):
        ((kind, amount),) = PATH[done].items()
        if kind in ("right", "up", "forward"):
            along = frame[("right", "up", "forward").index(kind)]
            x, _, frame = carried(name, x, along, frame, amount)
        else:
            axis = {"pitch": 0, "yaw": 1, "roll": 2}[kind]
            # The rows right, up, forward are left-handed: seen in them a turn goes the other way round.
            angle = np.deg2rad(float(amount.split()[0]))
            frame = Rotation.from_rotvec(angle * np.eye(3)[axis]).as_matrix() @ frame
        got = CameraFrame(camera(point, *look, *PATH[: done + 1]), place)
        assert np.abs(got.point[list(CHART[name])] - x).max() <= AGREED, (name, done)
        assert np.abs(in_chart(g, got.point, got.frame) - frame).max() <= AGREED, (name, done)


@pytest.mark.parametrize("name", GEOMETRIES)
def test_around_a_triangle(name: str, opencl_device: Device) -> None:
    """The turn that a closed loop leaves, by the kernels and by the equation; none in e3."""
    g = Geometry(name, "double", opencl_device)
    corners = [start_point(g)]
    for u in ([0.6, -0.8, 0.0], [0.8, 0.36, 0.48]):
        corners.append(g.flow(u, 1.0, corners[0])[0][0])
    turn, frame = np.eye(3), in_chart(g, corners[0], np.eye(3))
    x = corners[0][list(CHART[name])]
    for start, end in zip(corners, [*corners[1:], corners[0]], strict=True):
        u, length = g.geodesics(end, 1, start)
        turn = g.transport(u[0], length[0], start)[0] @ turn
        x, _, frame = carried(name, x, in_chart(g, start, u[0])[0], frame, length[0, 0])
    assert np.abs(x - corners[0][list(CHART[name])]).max() <= AGREED
    assert np.abs(in_chart(g, corners[0], turn.T) - frame).max() <= AGREED
    assert np.abs(turn @ turn.T - np.eye(3)).max() <= 1e-13
    angle = np.linalg.norm(Rotation.from_matrix(turn).as_rotvec())
    assert angle <= 1e-13 if name == "e3" else angle > 0.05
