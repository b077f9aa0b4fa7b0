"""The integrators of kernels/flow against the exact flow: orders, steps, turns, and pictures by them."""

from typing import Any

import numpy as np
import pytest
from golden import EPSILON, Array, constant
from hypothesis import given, settings
from hypothesis import strategies as st

import thurston_cl as tc
from thurston_cl.device import Device
from thurston_cl.flows import FLOWS, ORDERS, Flow
from thurston_cl.method import Method
from thurston_cl.models import GEOMETRIES
from thurston_cl.scene import load_text
from thurston_cl.scene.plan import make_plan

LANES = 4
CASES = [(name, "left-invariant") for name in GEOMETRIES] + [("nil", "coordinates")]


def directions(count: int, seed: int = 5) -> Array:
    u = np.random.default_rng(seed).normal(size=(count, 3))
    return u / np.linalg.norm(u, axis=1)[:, None]


def by(name: str, flow: str, step: float, precision: str = "double", **more: Any) -> tc.Geometry:
    return tc.Geometry(name, precision, flow=flow, step=step, lanes=LANES, **more)


def exact(name: str, precision: str = "double") -> tc.Geometry:
    return tc.Geometry(name, precision, lanes=LANES)


@pytest.mark.parametrize("flow", ORDERS)
@pytest.mark.parametrize(("name", "equation"), CASES)
def test_errors_fall_by_the_order(name: str, equation: str, flow: str) -> None:
    """Halved steps leave 1/2^order of the mean error, of points and directions; in e3 there is none.
    The table of rk8 (STAGES, ROOT_21) is right if its order is.
    """
    u, t = directions(200), 2.0
    truth, ahead = exact(name).flow(u, t)
    # Steps whose errors stand well above rounding and are well inside the range where the first term rules.
    step = {"euler": 1 / 64, "rk2": 1 / 32, "rk4": 1 / 16, "rk8": 1 / 3}[flow]
    points, turns = [], []
    for h in (step, step / 2):
        p, d = by(name, flow, h, equation=equation).flow(u, t)
        points.append(exact(name).distance(p, truth).mean())
        turns.append(np.linalg.norm(d - ahead, axis=1).mean())
    if name == "e3":
        assert max(*points, *turns) < 1e-14
        return
    falls = [points[0] / points[1]] + ([turns[0] / turns[1]] if turns[0] > 1e-9 else [])
    order = ORDERS[flow]
    # Euler's rule in s3 and s2xe keeps to the right great circle at a speed that is wrong by an error of
    # order 2.
    most = order + (1.4 if flow == "euler" and name in ("s3", "s2xe") else 0.6)
    assert points[1] > 20 * EPSILON["double"]
    assert 2 ** (order - 0.35) < min(falls) < 2**most, (points, turns)


@pytest.mark.parametrize(("name", "equation"), CASES)
def test_single_precision_follows_double(name: str, equation: str) -> None:
    """rk4 in single precision is where it is in double, up to the rounding of its steps."""
    u, t, step = directions(300), 3.0, 0.05
    p, d = by(name, "rk4", step, "double", equation=equation).flow(u, t)
    q, e = by(name, "rk4", step, "single", equation=equation).flow(u, t)
    size = np.abs(p).max(axis=1, keepdims=True)
    # Sixty steps, and in sol coordinates that e^z multiplies.
    assert (np.abs(p - q) / size).max() < 100 * EPSILON["single"]
    assert np.abs(d - e).max() < 100 * EPSILON["single"]


@pytest.mark.parametrize("name", GEOMETRIES)
def test_back_is_where_it_came_from(name: str) -> None:
    """Flowed on and back by the same steps: rk8 is back up to rounding, from anywhere."""
    u = directions(50)
    back_and_forth = by(name, "rk8", 0.05)
    base = exact(name).flow(directions(50, 6), 1.2)[0]
    p, d = back_and_forth.flow(u, 1.5, base)
    q, e = back_and_forth.flow(d, -1.5, p)
    assert np.abs(q - base).max() < 1e-11
    assert np.abs(e - u).max() < 1e-11


@pytest.mark.parametrize("name", GEOMETRIES)
def test_from_anywhere_as_from_the_origin(name: str) -> None:
    """A flow from a base is that from the origin, translated."""
    u = directions(50)
    g = by(name, "rk2", 0.1)
    base = exact(name).flow(directions(50, 6), 1.2)[0]
    p, _ = g.flow(u, 2.0)
    q, _ = g.flow(u, 2.0, base)
    assert np.abs(g.translate(base, p) - q).max() < 1e-12 * np.abs(q).max()


def test_the_fibre_of_sl2_is_counted_in_whole_turns() -> None:
    """arg Z passes the negative numbers many times, both ways."""
    u = np.array([[0.1, 0.2, 1.0], [0.1, 0.2, -1.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.1, 0.9]])
    u /= np.linalg.norm(u, axis=1)[:, None]
    g, truth = by("sl2", "rk8", 0.05), exact("sl2")
    for t in (2 * np.pi, 10.0, 31.0, -31.0, 200.0):
        p, q = g.flow(u[:4], t)[0], truth.flow(u[:4], t)[0]
        assert np.abs(p - q).max() < 1e-8 * abs(t), t
    # Exactly on the cut: up the fibre by 2 pi, Z = -1 up to rounding, from either side.
    for t in 2 * np.pi * (1 + np.array([-1e-15, 0, 1e-15])):
        assert abs(abs(g.flow(u[2], t)[0][0, 3]) - 2 * np.pi) < 1e-12


@pytest.mark.parametrize("precision", ["single", "double"])
def test_a_whole_number_of_steps_is_not_given_one_more(precision: str) -> None:
    """STEP_SLACK: 6 in steps of 0.1 are 60, though 0.1 is no number of the computer; with a little more they
    are 61. Euler's rule tells them apart.
    """
    slack = 8 * EPSILON[precision]
    u, g = np.array([[0.6, 0.0, 0.8]]), by("nil", "euler", 0.1, precision)

    def height(t: float) -> float:
        return float(g.flow(u, t)[0][0, 2])

    # On both sides of the slack.
    whole, one_more = height(6.0 * (1 + slack / 4)), height(6.0 * (1 + 4 * slack))
    assert abs(whole - height(6.0)) < 1e-3 * abs(whole - one_more)
    assert abs(one_more - height(6.05)) > 10 * abs(one_more - height(6.0 * (1 + 8 * slack)))


def test_more_than_a_million_steps_are_not_made() -> None:
    """MOST_FLOW_STEPS: up to there the flow arrives, beyond it says that it did not."""
    most = constant("flow/steps.h", "MOST_FLOW_STEPS")
    g, u = by("e3", "euler", 1e-3), directions(1)
    p, _ = g.flow(u, most * 1e-3)
    assert np.allclose(p[0, :3], u[0] * most * 1e-3, rtol=1e-9)
    with pytest.warns(RuntimeWarning, match="1 of 1 points are too far away for double precision and euler"):
        p, _ = g.flow(u, most * 1.01e-3)
    assert np.isnan(p).any()


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize(("name", "equation"), CASES)
def test_a_packet_changes_nothing(name: str, equation: str, precision: str, opencl_device: Device) -> None:
    """Lanes whose flows take different numbers of steps, on or back, do not disturb each other."""
    u, t = directions(64), np.random.default_rng(3).uniform(-4, 4, 64)
    g = tc.Geometry(name, precision, opencl_device, "rk4", 16, step=0.25, equation=equation)
    p, d = g.flow(u, t)
    for k in (0, 1, 17, 40):
        q, e = g.flow(u[k], t[k])
        assert np.array_equal(p[k], q[0]) and np.array_equal(d[k], e[0])
    one = tc.Geometry(name, precision, opencl_device, "rk4", 1, step=0.25, equation=equation)
    # exp, sin and cos of vectors are other functions of PoCL than those of numbers.
    q, e = one.flow(u, t)
    assert (np.abs(p - q) / np.abs(p).max(axis=1, keepdims=True)).max() < 16 * EPSILON[precision]
    assert np.abs(d - e).max() < 16 * EPSILON[precision]


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.sampled_from(CASES), st.floats(-3, 3), st.sampled_from((0.1, 0.2, 0.4)))
def test_no_step_is_longer_than_asked_for(case: tuple[str, str], t: float, step: float) -> None:
    """The error of rk4 is at most what the fourth power of the step says, for any time."""
    name, equation = case
    u = directions(8)
    q, _ = by(name, "rk4", step, equation=equation).flow(u, t)
    # 0.02 step^4 a unit of length in sol, which bends the most; it grows like e^t.
    most = 0.05 * step**4 * (1 + abs(t)) * np.exp(abs(t)) + 1e-13
    assert exact(name).distance(q, exact(name).flow(u, t)[0]).max() < most


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"flow": "rk5", "step": 0.1}, "unknown flow 'rk5'; expected one of: exact, euler, rk2, rk4, rk8"),
        ({"flow": "rk4"}, "flow='rk4' needs a step, for example step=0.1"),
        ({"flow": "rk4", "step": 0.0}, "step=0.0; expected a number over 0"),
        ({"flow": "rk4", "step": float("nan")}, "step=nan; expected a number over 0"),
        ({"step": 0.1}, "step=0.1 is for the integrators: euler, rk2, rk4, rk8"),
        ({"flow": "rk4", "step": 0.1, "equation": "first"}, "unknown equation 'first'"),
        ({"flow": "rk4", "step": 0.1, "equation": "coordinates"}, "is for the integrators in nil"),
    ],
)
def test_what_makes_no_sense(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError) as told:
        tc.Geometry("sol", **settings)
    assert message in str(told.value)


def test_other_functions_stay_exact() -> None:
    """Only the flow is integrated."""
    p = exact("nil").flow(directions(20), 2.0)[0]
    assert np.array_equal(by("nil", "euler", 0.5).distance(p), exact("nil").distance(p))


SCENES = {
    "e3": "objects: [{ball: {radius: 0.7}, at: [0, 0, -2]}]",
    "s3": "objects: [{ball: {radius: 0.5}, at: [0, 1.2, 0]}]",
    "h3": "objects: [{ball: {radius: 0.7}, at: [0, 0, -2]}]",
    "s2xe": "objects: [{ball: {radius: 0.4}, at: [0, 0, -1.5]}]",
    "h2xe": "objects: [{ball: {radius: 0.7}, at: [0, 0, -2]}]",
    "nil": "manifold: heisenberg\nobjects: [{tile: {ball: 0.55}}]",
    "sl2": "objects: [{ball: {radius: 0.7}, at: [0, 0, -2]}]",
    "sol": "objects: [{ball: {radius: 0.7}, at: [0, 0, -2]}]",
}


@pytest.mark.parametrize("name", SCENES)
def test_pictures_by_an_integrator(name: str, opencl_device: Device) -> None:
    """rk4 shows what the exact flow shows; Euler's rule with long steps does not, where geodesics bend."""
    text = f"geometry: {name}\n{SCENES[name]}\nrender: {{FLOW}}\n"
    seen = {
        flow: tc.render(
            load_text(text.replace("FLOW", f"flow: {flow}")), device=opencl_device, size=(64, 48), samples=1
        )
        for flow in ("exact", "rk4")
    }
    ids = [seen[flow].channels["object"] for flow in ("exact", "rk4")]
    assert ids[0].any()
    assert (ids[0] != ids[1]).mean() < 0.002
    depth = [seen[flow].channels["depth"][(ids[0] == ids[1]) & (ids[0] > 0)] for flow in ("exact", "rk4")]
    assert np.median(np.abs(depth[0] - depth[1])) < 2e-4


def test_a_picture_by_a_bad_integrator_differs(opencl_device: Device) -> None:
    """The flow that a scene names is the one that its rays are marched along."""
    text = f"geometry: nil\n{SCENES['nil']}\nrender: {{flow: FLOW, flow-step: 1}}\n"
    ids = [
        tc.render(
            load_text(text.replace("FLOW", flow).replace(", flow-step: 1" if flow == "exact" else "|", "")),
            device=opencl_device,
            size=(64, 48),
            samples=1,
        ).channels["depth"]
        for flow in ("exact", "euler")
    ]
    assert (np.abs(ids[0] - ids[1]) > 1e-2).mean() > 0.05


def test_what_a_scene_says_of_its_flow() -> None:
    """In the plan, in `explain`, and in the program only what is asked for."""
    text = "geometry: sl2\nobjects: [{ball: {radius: 1}}]\nrender: {flow: rk2}\n"
    plan = make_plan(load_text(text))
    assert plan.method == Method(flow="rk2", step=0.1)
    assert plan.explain()["flow"] == "rk2 in steps of 0.1"
    assert {"flow/rk2.h", "flow/field_sl2.h"} <= set(plan.parts)
    others = {f"flow/{name}.h" for name in (*FLOWS, "field_left_invariant") if name != "rk2"}
    assert not others & set(plan.parts)
    assert "#define FLOW_STEP C(0.1)" in plan.source.text
    assert make_plan(load_text(text.split("render")[0])).explain()["flow"] == "exact"


def test_a_flow_says_what_it_is() -> None:
    assert Flow("nil", "rk8", 0.01).words == "rk8 in steps of 0.01"
    assert Flow("nil").words == "exact"
