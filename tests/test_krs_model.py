"""Kernel-reflection sequences in e3 against all their instances: records, random models, identities.

Single precision rounds mirrors and centers, and every fold rounds the point again: an error in units of
EPSILON * (levels + 1) * size, size the largest coordinate that there is. ROUNDING times that is allowed.
"""

import functools
import json
import warnings
from typing import Any

import krs_models as models
import krs_truth as truth
import numpy as np
import pytest
from golden import DATA, EPSILON, Array, cut
from hypothesis import given, settings
from hypothesis import strategies as st
from krs_truth import Record, length, vector

from thurston_cl.device import Device
from thurston_cl.krs import Model
from thurston_cl.program import LANE_WIDTHS

RECORDS = json.loads((DATA / "krs.json").read_text(encoding="utf-8"))
EXACT = 1e-12
ROUNDING = 1.5
KINDS = ("sphere", "capsule", "torcap", "lens")

both_precisions = pytest.mark.parametrize("precision", EPSILON)
# Most random models are made of the same kinds, so that their program is compiled once.
pytestmark = pytest.mark.filterwarnings("error")


def model(record: Record, device: Device, precision: str = "double", lanes: int | None = None) -> Model:
    return Model.from_dict(record, precision=precision, device=device, lanes=lanes)


def clipped(record: Record, device: Device, precision: str = "double", lanes: int | None = None) -> Model:
    """The model of a record whose kernels cross mirrors, which is said."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return model(record, device, precision, lanes)


def size(record: Record, points: Array) -> float:
    """The largest coordinate of points, mirrors and kernels."""
    numbers = [np.abs(points).max(), 1.0, *(abs(mirror["w"]) for mirror in record["mirrors"])]
    for kernel in record["kernels"]:
        numbers += [
            np.abs(vector(value)).max() for key, value in kernel.items() if key not in ("type", "mat")
        ]
    return float(max(numbers))


def allowed(record: Record, points: Array, precision: str) -> float:
    levels = len(record["mirrors"])
    return max(EXACT, ROUNDING * EPSILON[precision] * (levels + 1) * size(record, points))


@functools.cache
def chain(levels: int, seed: int, depth: float = 0.0, top: str | None = None) -> Record:
    return models.chain(levels, seed, KINDS, depth, top)


# The records.


def test_the_truth_of_the_tests_agrees_with_the_records() -> None:
    assert len(RECORDS["krs"]) == 14
    for record in RECORDS["krs"]:
        points = vector(record["points"])
        assert np.abs(truth.brute(record, points) - record["true"]).max() < 1e-14
        assert np.abs(truth.folded(record, points) - record["folded"]).max() < 1e-14
    for kernel in RECORDS["torcap"]:
        found = truth.kernel_distance(kernel | {"type": "torcap"}, vector(kernel["points"]))
        assert np.abs(found - kernel["true"]).max() < 1e-13


@both_precisions
@pytest.mark.parametrize("n", range(len(RECORDS["krs"])))
def test_records(n: int, precision: str, opencl_device: Device) -> None:
    record = RECORDS["krs"][n]
    points = cut(record["points"], precision)
    if precision == "double":
        true, folded = vector(record["true"]), vector(record["folded"])
    else:  # at the points as single precision holds them
        true, folded = truth.brute(record, points), truth.folded(record, points)
    build = model if record["separated"] else clipped
    found = build(record, opencl_device, precision).distance(points)
    limit = allowed(record, points, precision)
    assert np.abs(found - folded).max() <= limit
    if record["separated"]:
        assert np.abs(found - true).max() <= limit
    else:
        assert (folded - true).max() > 0.1  # what is clipped away does not count
        assert (found >= true - limit).all()


# One kernel of each kind, no mirror.


def alone(kernel: truth.Kernel) -> Record:
    return {"mirrors": [], "kernels": [kernel]}


ARC = {"type": "torcap", "p": [-1.1, 0.3, 0.2], "q": [0.8, -0.4, 0.1], "r": 0.1}


def with_sagitta(ratio: float, skew: float = 0.0) -> truth.Kernel:
    """An arc over ARC's chord L by a point that is `ratio` L beside it, `skew` L off its middle."""
    p, q = vector(ARC["p"]), vector(ARC["q"])
    side = np.cross(q - p, [0.2, 0.1, 1.0])
    m = (p + q) / 2 + ratio * length(q - p) * side / length(side) + skew * (q - p)
    return ARC | {"m": m.tolist()}


SAGITTAS = (0.0, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3, 0.4999, 0.5, 0.5001, 1.0, 3.0, 20.0, 1e4)


@both_precisions
@pytest.mark.parametrize("ratio", SAGITTAS)
def test_arcs_of_every_sagitta(ratio: float, precision: str, opencl_device: Device) -> None:
    """In float the usual form has errors of 3e-4 at s/L = 0.01 and 0.6 at 1e-4, this one 5e-7."""
    kernel = with_sagitta(ratio, skew=0.2 if ratio > 0.01 else 0.0)
    chord = vector(ARC["q"]) - vector(ARC["p"])
    points = np.random.default_rng(5).uniform(-1, 1, (300, 3)) * max(1, ratio) * length(chord)
    points = cut(points, precision)
    found = model(alone(kernel), opencl_device, precision).distance(points)
    wanted = (truth.exact_arc_distances if ratio else truth.kernel_distance)(kernel, points)
    limit = {"single": 5e-7, "double": 1e-15}[precision]
    assert np.abs(found - wanted).max() <= limit * np.abs(points).max()


@both_precisions
@pytest.mark.parametrize("ratio", [0.01, 0.1, 0.3, 0.5, 1.0, 3.0])
def test_arcs_seen_from_the_axis_of_their_circle(ratio: float, precision: str, opencl_device: Device) -> None:
    """There the distance from the axis is a small difference, 1 + kappa g in the curvature form."""
    kernel = with_sagitta(ratio)
    on = truth.arc(kernel)
    assert on is not None
    rng = np.random.default_rng(9)
    beside = (
        on.radius * 10 ** rng.uniform(-9, -1, (2000, 1)) * (on.at(rng.uniform(0, on.end, 2000)) - on.center)
    )
    points = on.center + beside / on.radius + rng.normal(size=(2000, 1)) * on.normal
    points = cut(points, precision)
    found = model(alone(kernel), opencl_device, precision).distance(points)
    error = np.abs(found - truth.kernel_distance(kernel, points)).max()
    assert error <= 4 * EPSILON[precision] * np.abs(points).max()


@both_precisions
def test_arcs_of_the_records(precision: str, opencl_device: Device) -> None:
    for kernel in RECORDS["torcap"]:
        shape = {key: kernel[key] for key in ("p", "q", "m", "r")} | {"type": "torcap"}
        points = cut(kernel["points"], precision)
        wanted = kernel["true"] if precision == "double" else truth.kernel_distance(shape, points)
        found = model(alone(shape), opencl_device, precision).distance(points)
        limit = allowed(alone(shape), points, precision) if precision == "single" else 1e-13
        assert np.abs(found - wanted).max() <= limit


def test_a_straight_arc_is_a_capsule(opencl_device: Device) -> None:
    straight = with_sagitta(0.0, skew=0.3)
    points = np.random.default_rng(6).normal(size=(2000, 3))
    capsule = {"type": "capsule", "a": straight["p"], "b": straight["q"], "r": straight["r"]}
    found = model(alone(straight), opencl_device).distance(points)
    assert np.abs(found - truth.kernel_distance(capsule, points)).max() <= 1e-14


@both_precisions
def test_a_capsule_without_length_is_a_sphere(precision: str, opencl_device: Device) -> None:
    middle = [0.3, -0.7, 1.25]
    points = cut(np.random.default_rng(7).normal(size=(2000, 3)), precision)
    found = model(
        alone({"type": "capsule", "a": middle, "b": middle, "r": 0.2}), opencl_device, precision
    ).distance(points)
    wanted = truth.kernel_distance({"type": "sphere", "c": middle, "r": 0.2}, points)
    assert np.abs(found - wanted).max() <= 8 * EPSILON[precision]
    # And nearly without: the direction along it is still its own.
    short = {"type": "capsule", "a": middle, "b": [0.3, -0.7, 1.25 + 1e-9], "r": 0.2}
    found = model(alone(short), opencl_device, precision).distance(points)
    assert np.abs(found - wanted).max() <= 1e-9 + 8 * EPSILON[precision]


LEAF = {"type": "lens", "c": [0.2, -0.1, 0.4], "a": [0.48, -0.6, 0.64], "b": 0.8}


@both_precisions
@pytest.mark.parametrize("ratio", [1.0, 0.999999, 0.9, 0.3, 1e-2, 1e-4, 1e-7])
def test_leaves_from_a_ball_to_a_disc(ratio: float, precision: str, opencl_device: Device) -> None:
    kernel = LEAF | {"h": LEAF["b"] * ratio}
    rng = np.random.default_rng(8)
    # And points next to its middle, which is next to the centers of the faces where it is nearly a ball.
    inner = LEAF["c"] + 10 ** rng.uniform(-8, -1, (2000, 1)) * rng.normal(size=(2000, 3))
    points = cut(np.concatenate([rng.normal(size=(4000, 3)), inner]), precision)
    found = model(alone(kernel), opencl_device, precision).distance(points)
    # The truth subtracts radii of b/(2 ratio).
    limit = max(8 * EPSILON[precision], 8 * EPSILON["double"] / ratio)
    assert np.abs(found - truth.kernel_distance(kernel, points)).max() <= limit
    if ratio == 1:
        ball = {"type": "sphere", "c": kernel["c"], "r": kernel["b"]}
        assert np.abs(found - truth.kernel_distance(ball, points)).max() <= 8 * EPSILON[precision]
    if ratio <= 1e-7:
        axis = vector(kernel["a"]) / length(vector(kernel["a"]))
        height = (points - kernel["c"]) @ axis
        beyond = np.maximum(length(points - kernel["c"] - height[:, None] * axis) - kernel["b"], 0)
        assert np.abs(found - np.hypot(height, beyond)).max() <= kernel["h"] + 8 * EPSILON[precision]


# Random models.


@pytest.mark.parametrize("levels", range(9))
def test_separated_models_are_as_far_as_their_nearest_instance(levels: int, opencl_device: Device) -> None:
    """1e5 points in all."""
    record = chain(levels, levels, top="plane" if levels % 3 == 1 else None)
    points = models.points_around(record, 11200, levels)
    found = model(record, opencl_device).distance(points)
    true = truth.brute(record, points)
    assert (true < 0).any()
    assert np.abs(found - true).max() <= EXACT


@both_precisions
@pytest.mark.parametrize("depth", [0.0, 0.2, 0.6])
def test_values_of_crossing_models(depth: float, precision: str, opencl_device: Device) -> None:
    record = chain(6, 12, depth)
    points = cut(models.points_around(record, 20000, 3), precision)
    found = (clipped if depth else model)(record, opencl_device, precision).distance(points)
    limit = allowed(record, points, precision)
    assert np.abs(found - truth.folded(record, points)).max() <= limit
    if precision == "double":
        # What is drawn is what mirrors leave, and never more.
        assert ((found <= 0) == truth.drawn(record, points)).all()
        assert (found >= truth.brute(record, points) - limit).all()


def test_a_crossing_model_is_nowhere_farther_than_what_it_draws(opencl_device: Device) -> None:
    record = chain(4, 7, 0.5)
    cloud = models.points_around(record, 30000, 4)
    set_points = cloud[truth.drawn(record, cloud)]
    assert len(set_points) > 100
    points = models.points_around(record, 500, 5)
    found = clipped(record, opencl_device).distance(points)
    nearest = np.array([length(set_points - x).min() for x in points])
    assert (found <= nearest + EXACT).all()


@both_precisions
@settings(max_examples=20)
@given(seed=st.integers(0, 2**32 - 1))
def test_distances_are_1_lipschitz(precision: str, opencl_device: Device, seed: int) -> None:
    record = chain(7, 5, 0.4)
    rng = np.random.default_rng(seed)
    first = models.points_around(record, 400, seed)
    second = first + 10.0 ** rng.uniform(-9, 1, (400, 1)) * rng.normal(size=(400, 3))
    first, second = cut(first, precision), cut(second, precision)
    found = lipschitz_model(opencl_device, precision).distance(np.concatenate([first, second]))
    apart = length(first - second)
    limit = 2 * allowed(record, np.concatenate([first, second]), precision)
    assert (np.abs(found[:400] - found[400:]) <= apart + limit).all()


@functools.cache
def lipschitz_model(device: Device, precision: str) -> Model:
    return clipped(chain(7, 5, 0.4), device, precision)


@both_precisions
def test_a_ball_is_free_where_the_distance_is_no_smaller(precision: str, opencl_device: Device) -> None:
    record = chain(5, 3)
    found = model(record, opencl_device, precision)
    points = models.points_around(record, 3000, 4)
    distance = found.distance(points)
    assert (found.bound(points) == distance).all()
    radii = np.abs(distance) * np.random.default_rng(1).uniform(0.5, 1.5, len(points))
    assert (found.unbounding(points, radii) == (distance >= cut(radii, precision))).all()


@pytest.mark.parametrize("levels", [0, 1, 4, 7])
def test_expansions(levels: int, opencl_device: Device) -> None:
    record = chain(levels, 2)
    found = model(record, opencl_device)
    instances = found.expand()
    wanted = truth.expand(record)
    assert len(instances) == len(wanted) == found.instances == 2 ** (levels + 1) - 1
    for kernel in range(levels + 1):
        ours = np.array([m for k, m in instances if k == kernel]).reshape(-1, 16)
        theirs = np.array([m for k, m in wanted if k == kernel]).reshape(-1, 16)
        assert len(ours) == len(theirs) == 2 ** (levels - kernel)
        off = np.abs(ours[:, None] - theirs).max(axis=2)
        assert sorted(off.argmin(axis=1)) == list(range(len(ours)))
        assert off.min(axis=1).max() <= EXACT
    points = models.points_around(record, 2000, 9)
    brute = truth.brute(record, points, [(k, np.asarray(m)) for k, m in instances])
    assert np.abs(brute - found.distance(points)).max() <= EXACT


def test_a_model_lies_within_its_radius(opencl_device: Device) -> None:
    record = chain(5, 3)
    rng = np.random.default_rng(1)
    everything = np.concatenate(
        [
            truth.surface(record["kernels"][k], 200, rng) @ m[:3, :3].T + m[:3, 3]
            for k, m in truth.expand(record)
        ]
    )
    assert length(everything).max() <= model(record, opencl_device).radius * (1 + 1e-12)


# Normals.


def differences(found: Model, points: Array, step: float = 1e-5) -> Array:
    moved = np.concatenate([points + h * e for e in np.eye(3) for h in (step, -step)])
    up, down = found.distance(moved).reshape(3, 2, -1).transpose(1, 2, 0)
    return (up - down) / (2 * step)


@pytest.mark.parametrize(("levels", "depth", "top"), [(0, 0.0, None), (3, 0.0, "plane"), (6, 0.5, None)])
def test_normals_are_gradients(levels: int, depth: float, top: str | None, opencl_device: Device) -> None:
    """Where there is one: at ties, on mirrors that cross and on creases, differences are too short."""
    record = chain(levels, 3, depth, top)
    found = clipped(record, opencl_device)
    points = models.points_around(record, 4000, 2)
    gradient = differences(found, points)
    smooth = np.abs(length(gradient) - 1) < 1e-7
    assert smooth.mean() > 0.97
    normal = found.normal(points)
    assert np.abs(length(normal) - 1).max() < 1e-14
    assert np.abs(normal - gradient)[smooth].max() < 1e-6


def test_where_there_is_no_normal(opencl_device: Device) -> None:
    """At centers and on axes, where the distance is known all the same; and a normal right beside them."""
    ball = {"type": "sphere", "c": [0.25, 0, 0], "r": 0.5}
    capsule = {"type": "capsule", "a": [0.0, 0, 0], "b": [0.0, 0, 1], "r": 0.5}
    for kernel, at in ((ball, [0.25, 0, 0]), (capsule, [0.0, 0, 0.25]), (capsule, [0.0, 0, 0])):
        found = model({"mirrors": [], "kernels": [kernel]}, opencl_device)
        points = np.array([at, np.add(at, [1e-6, 0, 0])])
        np.testing.assert_array_equal(found.distance(points[:1]), [-0.5])
        np.testing.assert_allclose(found.normal(points), [[np.nan] * 3, [1, 0, 0]], atol=1e-9)
    ball = {"type": "sphere", "c": [1.0, 0, 0, 0], "r": 0.5}
    found = model({"space": "S3", "mirrors": [], "kernels": [ball]}, opencl_device)
    assert np.isnan(found.normal([[1.0, 0, 0, 0], [-1.0, 0, 0, 0]])).all()
    assert np.isfinite(found.normal([[0.6, 0.8, 0, 0]])).all()


def test_normals_in_single_precision(opencl_device: Device) -> None:
    record = chain(4, 3)
    points = cut(models.points_around(record, 4000, 2), "single")
    gradient = differences(model(record, opencl_device), points)
    normal = model(record, opencl_device, "single").normal(points)
    # Directions from an axis or a center lose what the point lost, over its distance from them.
    off = length(normal - gradient)[np.abs(length(gradient) - 1) < 1e-7]
    assert np.quantile(off, 0.5) < 1e-6
    assert np.quantile(off, 0.99) < 1e-4


def boulder(levels: int, seed: int, width: float) -> Record:
    """One plane, folded often by mirrors nearly at a right angle to it: as in rocks, all of it is edges."""
    rng = np.random.default_rng(seed)
    record: Record = {
        "mirrors": [],
        "kernels": [{"type": "plane", "n": [0.0, 0.0, 1.0], "h": 0.0}],
        "smooth": [],
    }
    for i in range(levels):
        turn, tilt = rng.uniform(0, 2 * np.pi), rng.normal() * 0.15
        u = np.array([np.cos(turn) * np.cos(tilt), np.sin(turn) * np.cos(tilt), np.sin(tilt)])
        record["mirrors"].append({"u": u.tolist(), "w": float(rng.normal() * 0.3)})
        record["kernels"].append({"type": "empty"})
        record["smooth"].append(width * 0.8 ** (levels - i))
    return record


def test_smooth_normals_are_those_of_faded_folds(opencl_device: Device) -> None:
    record = chain(5, 3, 0.4) | {"smooth": [0.1, 0.3, 0.0, 0.2, 0.5]}
    points = models.points_around(record, 400, 6)
    normal = clipped(record, opencl_device).normal(points)
    wanted = np.array([truth.normal(record, x) for x in points])
    flat = np.array([truth.normal({**record, "smooth": [0.0] * 5}, x) for x in points])
    assert (length(wanted - flat) > 0.01).mean() > 0.1
    # Next to centers and axes differences of the truth are not good; creases are the points' bad luck.
    assert np.quantile(length(normal - wanted), 0.99) < 1e-7


def test_smooth_normals_are_continuous_across_all_mirrors(opencl_device: Device) -> None:
    record = boulder(8, 4, 0.2)
    smooth = clipped(record, opencl_device)
    sharp = clipped({key: record[key] for key in ("mirrors", "kernels")}, opencl_device)
    rng = np.random.default_rng(7)
    for _ in range(5):
        start, along = rng.normal(size=3), models.direction(rng)
        jumps = []
        for count in (2001, 4001):
            points = start + np.linspace(-2, 2, count)[:, None] * along
            steps = length(np.diff(smooth.normal(points), axis=0))
            jumps.append(steps.max())
        # A step half as long: a jump that is half as large.
        assert jumps[1] < 0.55 * jumps[0]
        assert length(np.diff(sharp.normal(points), axis=0)).max() > 2 * jumps[1]


@both_precisions
@pytest.mark.parametrize("level", range(3))
def test_on_a_mirror_smooth_normals_lie_along_it(level: int, precision: str, opencl_device: Device) -> None:
    """From both sides: the outermost mirror of the three is the one walked over, the others are far away."""
    u = np.array([0.6, 0.0, 0.8])
    far = [{"u": [1.0, 0.0, 0.0], "w": 100.0}, {"u": [0.0, 1.0, 0.0], "w": 100.0}]
    mirrors = [*far[:level], {"u": u.tolist(), "w": 0.5}, *far[level:]]
    width, epsilon = 0.125, EPSILON[precision]
    record = {
        "mirrors": mirrors,
        "kernels": [{"type": "sphere", "c": [-0.5, 0.4, -0.1], "r": 0.5}] + [{"type": "empty"}] * 3,
        "smooth": [width] * 3,
    }
    found = model(record, opencl_device, precision)
    on = 0.5 * u + np.outer(np.linspace(-1, 1, 41), [0.0, 1.0, 0.0])
    # Rounding leaves a point some EPSILON beside the mirror, and smoothstep is 1.5/(2 width) steep there.
    assert np.abs(found.normal(on) @ u).max() <= 20 * epsilon / width
    for beside in (0.1 * width, 1e-3 * width):
        front, back = found.normal(on - beside * u), found.normal(on + beside * u)
        # Mirrored images of each other, and so as near as their components along u are small.
        assert np.abs(front - 2 * np.outer(front @ u, u) - back).max() <= 60 * epsilon / width
        assert np.abs(front @ u).max() <= 4 * beside / width
    outside = found.normal(on - 1.01 * width * u)
    sharp = model({key: record[key] for key in ("mirrors", "kernels")}, opencl_device, precision)
    assert (outside == sharp.normal(on - 1.01 * width * u)).all()


# Widths, levels, sizes.


@both_precisions
def test_widths_give_the_same_bits(precision: str, opencl_device: Device) -> None:
    record = chain(6, 3, 0.3, "plane") | {"smooth": [0.2] * 6}
    points = models.points_around(record, 5003, 8)
    first = clipped(record, opencl_device, precision, 1)
    # 64 lanes compile four times as long.
    for lanes in LANE_WIDTHS[1:] if precision == "single" else (4, 16):
        other = clipped(record, opencl_device, precision, lanes)
        assert (other.distance(points) == first.distance(points)).all(), lanes
        assert (other.normal(points) == first.normal(points)).all(), lanes


def line_of_balls(levels: int) -> Record:
    """A ball at every integer from 0 to 2^levels - 1 on the x axis."""
    return {
        "mirrors": [{"u": [1.0, 0.0, 0.0], "w": 2.0**i - 0.5} for i in range(levels)],
        "kernels": [{"type": "sphere", "c": [0.0, 0.0, 0.0], "r": 0.125}, *([{"type": "empty"}] * levels)],
    }


def test_forty_levels(opencl_device: Device) -> None:
    record = line_of_balls(40)
    found = model(record, opencl_device)
    rng = np.random.default_rng(2)
    points = np.zeros((5000, 3))
    # Multiples of 2^-10, so that double precision has every fold exactly.
    points[:, 0] = np.round(2.0 ** rng.uniform(-10, 39.9, 5000) * 1024) / 1024
    points[:, 1:] = np.round(rng.normal(size=(5000, 2)) * 1024) / 1024
    off = points - np.round(points * [1, 0, 0])
    assert np.abs(found.distance(points) - (length(off) - 0.125)).max() <= 4 * EPSILON["double"]
    assert found.instances >= 2**40
    with pytest.raises(ValueError, match="41"):
        model(line_of_balls(41), opencl_device)


@pytest.mark.parametrize("radius", [1e-4, 1e-2, 1.0])
@pytest.mark.parametrize("far", [0.0, 1.0, 100.0])
def test_single_precision_far_out_and_small(far: float, radius: float, opencl_device: Device) -> None:
    base = models.chain(5, 4, ("sphere",))
    scale = radius / min(kernel["r"] for kernel in base["kernels"])
    offset = far * np.array([0.6, -0.64, 0.48])
    record = models.moved(base, offset, scale)
    rng = np.random.default_rng(3)
    inner = models.points_around(base, 4000, 3) * rng.uniform(0.2, 1, (4000, 1))
    points = cut(offset + scale * inner, "single")
    found = model(record, opencl_device, "single").distance(points)
    true = truth.brute(record, points)
    # What rounding of centers, mirrors and points to float leaves open; ROUNDING as everywhere, so nothing
    # is lost to small radii or large distances.
    assert np.abs(found - true).max() <= ROUNDING * EPSILON["single"] * 6 * np.abs(points).max()


@both_precisions
def test_no_point_has_no_distance(precision: str, opencl_device: Device) -> None:
    found = model(chain(3, 3), opencl_device, precision)
    with pytest.raises(ValueError, match=r"points\[1, 2\]"):
        found.distance([[0.0, 0, 0], [0, 0, np.nan]])
    with pytest.raises(ValueError, match="points"):
        found.distance([[0.0, 0.0]])
    assert found.distance(np.zeros((0, 3))).shape == (0,)
    assert found.normal(np.zeros((0, 3))).shape == (0, 3)


def test_a_record_is_not_yet_a_sequence() -> None:
    record: Any = {"mirrors": [], "kernels": [{"type": "sphere", "c": [0, 0, 0], "r": 1}]}
    with pytest.raises(TypeError, match=r"use Model\.from_dict\(record\)"):
        Model(record)


def test_the_mirrors_of_the_documentation_make_six_arms(opencl_device: Device) -> None:
    """Copies on a mirror are not doubled: docs/scene.md says how to make six of one."""
    text = (DATA.parents[1] / "docs" / "scene.md").read_text(encoding="utf-8")
    normals = json.loads(f"[{text.split('Six arms of one along x: mirrors ')[1].split(' (its twigs)')[0]}]")
    normals += json.loads(f"[{text.split('(its twigs), ')[1].split('. ')[0]}]")
    record: Record = {
        "mirrors": [{"u": (np.array(u) / np.linalg.norm(u)).tolist(), "w": 0} for u in normals],
        "kernels": [
            {"type": "capsule", "a": [0.5, 0, 0], "b": [0.7, 0, 0.2], "r": 0.03},
            {"type": "capsule", "a": [0, 0, 0], "b": [1, 0, 0], "r": 0.05},
            *[{"type": "empty"}] * (len(normals) - 1),
        ],
    }
    angles = np.radians(np.arange(0, 360, 60))
    along = np.stack([np.cos(angles), 0 * angles, np.sin(angles)], axis=-1)
    beside = np.stack([-np.sin(angles), 0 * angles, np.cos(angles)], axis=-1)
    m = clipped(record, opencl_device)
    np.testing.assert_allclose(m.distance(along), -0.05, atol=1e-4)
    for side in (0.2, -0.2):
        np.testing.assert_allclose(m.distance(0.7 * along + side * beside), -0.03, atol=1e-4)
    between = along + np.roll(along, 1, axis=0)
    assert m.distance(between).min() > 0.5
