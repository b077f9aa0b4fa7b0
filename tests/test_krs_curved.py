"""Kernel-reflection sequences in curved spaces against all their instances.

In single precision distances of far points from what is near the origin of hyperbolic space keep their digits
(1e-5 at a radius of 8). But a fold that leads a far point next to the origin brings along how far
its rounding is off the hyperboloid: what stands at the radius r is seen with an error of EPSILON cosh^2 r,
1e-4 at 4 and 0.2 at 8, in double 6e-10.
"""

import functools
import json

import krs_models as models
import krs_truth as truth
import numpy as np
import pytest
from golden import DATA, EPSILON, Array, cut
from krs_truth import Record, vector

from thurston_cl.device import Device
from thurston_cl.krs import Model

RECORDS = json.loads((DATA / "krs.json").read_text(encoding="utf-8"))["curved"]
SPACES = ("S3", "H3")

both_precisions = pytest.mark.parametrize("precision", EPSILON)
both_spaces = pytest.mark.parametrize("space", SPACES)
pytestmark = pytest.mark.filterwarnings("error")


@functools.cache
def chain(space: str, levels: int, seed: int) -> Record:
    return models.curved_chain(space, levels, seed)


def model(record: Record, device: Device, precision: str = "double", lanes: int | None = None) -> Model:
    return Model.from_dict(record, precision=precision, device=device, lanes=lanes)


def points_of(space: str, count: int, seed: int, radius: float) -> Array:
    """Up to a radius; in the three-sphere everywhere."""
    rng = np.random.default_rng(seed)
    along = np.array([models.direction(rng) for _ in range(count)])
    return models.at(space, along, rng.uniform(0, np.pi if space == "S3" else radius, count))


def rounded(space: str, points: Array, precision: str) -> Array:
    """Points whose coordinates but the first are numbers of the precision, and the first follows."""
    inner = cut(points[:, 1:], precision)
    square = 1 - (inner**2).sum(axis=1) if space == "S3" else 1 + (inner**2).sum(axis=1)
    first = np.copysign(np.sqrt(np.maximum(square, 0)), points[:, 0])
    return np.concatenate([first[:, None], inner], axis=1)


def allowed(record: Record, points: Array, precision: str) -> Array:
    levels = len(record["mirrors"])
    return 1.5 * (levels + 1) * EPSILON[precision] * np.maximum(1, np.abs(points[:, 0]))


@both_precisions
@pytest.mark.parametrize("n", range(len(RECORDS)))
def test_records(n: int, precision: str, opencl_device: Device) -> None:
    record = RECORDS[n]
    points = vector(record["points"])
    assert np.abs(truth.brute(record, points) - record["true"]).max() < 1e-13
    found = model(record, opencl_device, precision).distance(points)
    limit = 1e-12 if precision == "double" else allowed(record, points, precision)
    assert (np.abs(found - record["true"]) <= limit).all()


@both_spaces
@pytest.mark.parametrize("levels", range(5))
def test_distances_are_those_of_the_nearest_instance(space: str, levels: int, opencl_device: Device) -> None:
    record = chain(space, levels, levels)
    points = points_of(space, 4000, levels, 3)
    found = model(record, opencl_device).distance(points)
    true = truth.brute(record, points)
    assert (true < 0).any()
    # Where folds lead from far out to near the origin a rounding there is as much larger.
    limit = 1e-12 if space == "S3" else 1e-14 * points[:, 0] ** 2
    assert (np.abs(found - true) <= np.maximum(limit, 1e-12)).all()


@both_spaces
def test_single_precision(space: str, opencl_device: Device) -> None:
    record = chain(space, 3, 1)
    points = rounded(space, points_of(space, 4000, 3, 1.5), "single")
    found = model(record, opencl_device, "single").distance(points)
    assert (np.abs(found - truth.brute(record, points)) <= allowed(record, points, "single")).all()


def test_hyperbolic_space_in_single_precision_far_out(opencl_device: Device) -> None:
    """From up to 8 away; and from near by, where acosh would lose half of all digits."""
    ball: Record = {"space": "H3", "mirrors": [], "kernels": [{"c": [1.0, 0, 0, 0], "r": 0.1}]}
    far = rounded("H3", points_of("H3", 4000, 4, 8), "single")
    for record in (ball, chain("H3", 3, 1)):
        found = model(record, opencl_device, "single").distance(far)
        assert np.abs(found - truth.brute(record, far)).max() <= 2e-6
    near = rounded("H3", points_of("H3", 4000, 5, 1e-2), "single")
    found = model(ball, opencl_device, "single").distance(near)
    assert np.abs(found - truth.brute(ball, near)).max() <= 2 * EPSILON["single"] * 0.1


@both_precisions
@pytest.mark.parametrize("half", [0.5, 1, 2, 3, 4])
def test_instances_far_out_in_hyperbolic_space(half: float, precision: str, opencl_device: Device) -> None:
    mirror = [np.sinh(half), np.cosh(half), 0.0, 0.0]
    kernels = [{"c": [1.0, 0, 0, 0], "r": 0.1}, {"type": "empty"}]
    record: Record = {"space": "H3", "mirrors": [mirror], "kernels": kernels}
    beside = points_of("H3", 2000, 6, 1) @ truth.reflection(record, 0).T
    points = rounded("H3", beside, precision)
    found = model(record, opencl_device, precision).distance(points)
    limit = 2 * EPSILON[precision] * np.cosh(2 * half + 1) ** 2
    assert np.abs(found - truth.brute(record, points)).max() <= limit


@both_spaces
def test_crossing_models_are_clipped(space: str, opencl_device: Device) -> None:
    record = chain(space, 3, 2)
    first = record["kernels"][0]
    grown = {**record, "kernels": [first | {"r": first["r"] + 0.4}, *record["kernels"][1:]]}
    points = points_of(space, 3000, 6, 2)
    with pytest.warns(UserWarning, match=r"kernel 0 \(by 0\.\d+\) reaches beyond the mirror"):
        found = Model.from_dict(grown, device=opencl_device)
    distance = found.distance(points)
    assert np.abs(distance - truth.folded(grown, points)).max() <= 1e-11
    assert (distance >= truth.brute(grown, points) - 1e-11).all()


@both_spaces
@pytest.mark.parametrize("levels", [0, 3])
def test_expansions(space: str, levels: int, opencl_device: Device) -> None:
    record = chain(space, levels, 3)
    found = model(record, opencl_device)
    instances, wanted = found.expand(), truth.expand(record)
    assert len(instances) == len(wanted) == found.instances
    for kernel in range(levels + 1):
        ours = np.array([m for k, m in instances if k == kernel]).reshape(-1, 16)
        theirs = np.array([m for k, m in wanted if k == kernel]).reshape(-1, 16)
        off = np.abs(ours[:, None] - theirs).max(axis=2)
        assert len(ours) == len(theirs)
        assert sorted(off.argmin(axis=1)) == list(range(len(ours)))
        assert off.min(axis=1).max() <= 1e-12 * np.abs(theirs).max() ** 2


@both_spaces
def test_normals_are_unit_tangents_along_which_distances_grow(space: str, opencl_device: Device) -> None:
    record = chain(space, 3, 4)
    found = model(record, opencl_device)
    points = points_of(space, 3000, 7, 1.5)
    normal, metric = found.normal(points), truth.signature(record)
    assert np.abs(((normal @ metric) * points).sum(axis=1)).max() <= 1e-12
    assert np.abs(((normal @ metric) * normal).sum(axis=1) - 1).max() <= 1e-12
    step = 1e-5
    cosine, sine = (np.cos, np.sin) if space == "S3" else (np.cosh, np.sinh)
    ahead, behind = (cosine(step) * points + s * sine(step) * normal for s in (1, -1))
    slope = (found.distance(ahead) - found.distance(behind)) / (2 * step)
    # At ties and on mirrors there is no gradient.
    assert np.quantile(np.abs(slope - 1), 0.98) < 1e-8
    assert slope.max() < 1 + 1e-8


@both_precisions
@both_spaces
def test_widths_give_the_same_bits(space: str, precision: str, opencl_device: Device) -> None:
    record = chain(space, 3, 5)
    points = points_of(space, 1003, 8, 2)
    first = model(record, opencl_device, precision, 1)
    other = model(record, opencl_device, precision, 16)
    if space == "S3" and precision == "double":  # on atan2 of the device, whose widths differ
        off = np.abs(other.distance(points) - first.distance(points))
        assert off.max() <= 4 * EPSILON["double"]
    else:
        assert (other.distance(points) == first.distance(points)).all()
    assert (other.normal(points) == first.normal(points)).all()


def far_end(space: str, a: Array, along: Array, size: float) -> Array:
    """The end of a geodesic from a point in the direction of another vector, made a unit tangent there."""
    metric = truth.signature({"space": space})
    tangent = along - (along @ metric @ a) / (a @ metric @ a) * a
    tangent /= np.sqrt(tangent @ metric @ tangent)
    return truth.geodesic(space, a, tangent, np.array([size]))[0]


@both_precisions
@both_spaces
def test_capsules_and_half_spaces(space: str, precision: str, opencl_device: Device) -> None:
    rng = np.random.default_rng(5)
    a = models.at(space, models.direction(rng)[None], np.array([0.4]))[0]
    b = far_end(space, a, rng.normal(size=4), 0.9)
    points = rounded(space, points_of(space, 400, 9, 2), precision)
    capsule = {"type": "capsule", "a": a.tolist(), "b": b.tolist(), "r": 0.15}
    found = model({"space": space, "mirrors": [], "kernels": [capsule]}, opencl_device, precision)
    limit = {"single": 2e-6, "double": 1e-12}[precision]
    assert np.abs(found.distance(points) - truth.curved_capsule(space, capsule, points)).max() <= limit
    plane = chain(space, 1, 3)["mirrors"][0]
    found = model(
        {"space": space, "mirrors": [], "kernels": [{"type": "plane", "n": plane}]}, opencl_device, precision
    )
    height = points @ truth.signature({"space": space}) @ vector(plane)
    wanted = (np.arcsin if space == "S3" else np.arcsinh)(height)
    # Near its pole a sine tells a quarter turn badly.
    off = np.abs(found.distance(points) - wanted)[np.abs(height) < 0.9 if space == "S3" else height == height]
    assert off.max() <= 2 * limit


@pytest.mark.parametrize("space", ["S2xE", "H2xE"])
@pytest.mark.parametrize("seed", range(3))
def test_products_with_upright_and_level_mirrors(space: str, seed: int, opencl_device: Device) -> None:
    record = models.product_chain(space, 4, seed)
    balls = truth.product_balls(record)
    assert len(balls) == 31
    rng = np.random.default_rng(seed)
    angle, along = rng.uniform(0, 2 * np.pi, 3000), rng.uniform(0, 2, 3000)
    cosine, sine = (np.cos, np.sin) if space == "S2xE" else (np.cosh, np.sinh)
    heights = rng.uniform(-3, 3, 3000)
    points = np.stack(
        [sine(along) * np.cos(angle), sine(along) * np.sin(angle), cosine(along), heights], axis=1
    )
    distances = [truth.product_distance(space, c, points) - r for c, r in balls]
    found = model(record, opencl_device).distance(points)
    assert np.abs(found - np.min(distances, axis=0)).max() <= 1e-12


MISTAKES = {
    "space": ({"space": "E4"}, r"space is 'E4'; expected one of: S3, H3"),
    "mirror": ({"mirrors": [[0.0, 2.0, 0.0, 0.0]]}, r"mirror 0 has <n, n> = 4; expected a unit normal"),
    "time-like": ({"space": "H3", "mirrors": [[1.0, 0.0, 0.0, 0.0]]}, r"mirror 0 has <n, n> = -1"),
    "length": (
        {"mirrors": [[0.0, 1.0, 0.0]]},
        r"mirror 0 is \[0\.0, 1\.0, 0\.0\]; expected 4 finite numbers",
    ),
    "center": ({"kernels": [{"c": [2.0, 0, 0, 0], "r": 0.1}] * 2}, r"c of kernel 0 is no point of s3"),
    "radius": ({"kernels": [{"c": [1.0, 0, 0, 0], "r": -0.1}] * 2}, r"r of kernel 0 is -0\.1"),
    "kind": ({"kernels": [{"type": "lens"}] * 2}, r"kernel 0 has type 'lens'; expected one of"),
    "missing": ({"kernels": [{"type": "sphere", "r": 1.0}] * 2}, r"kernel 0, a sphere, has no 'c'"),
    "misspelt height": ({"space": "H2xE", "mirrors": [{"hight": 1}]}, r"^mirror 0 has no 'height'$"),
    "text height": (
        {"space": "H2xE", "mirrors": [{"height": "up"}]},
        r"height of mirror 0 is 'up'; expected a finite number",
    ),
    "plane without normal": ({"kernels": [{"type": "plane"}] * 2}, r"^kernel 0, a plane, has no 'n'$"),
    "plane of a product": (
        {"space": "S2xE", "mirrors": [{"height": 1.0}], "kernels": [{"type": "plane", "hight": 1}] * 2},
        r"^kernel 0, a plane, has neither 'n' nor 'height'$",
    ),
    "height of a plane": (
        {"space": "S2xE", "mirrors": [{"height": 1.0}], "kernels": [{"type": "plane", "height": None}] * 2},
        r"^height of kernel 0 is None; expected a finite number$",
    ),
    "capsule without length": (
        {"kernels": [{"type": "capsule", "a": [1.0, 0, 0, 0], "b": [1.0, 0, 0, 0], "r": 0.1}] * 2},
        r"^kernel 0: a capsule that begins where it ends; make it a ball$",
    ),
    "leaning capsule": (
        {
            "space": "S2xE",
            "mirrors": [{"height": 1.0}],
            "kernels": [{"type": "capsule", "a": [0.0, 0, 1, 0], "b": [0.6, 0, 0.8, 0], "r": 0.1}] * 2,
        },
        r"^kernel 0: in s2xe a capsule of a sequence is vertical$",
    ),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes(name: str, opencl_device: Device) -> None:
    change, message = MISTAKES[name]
    record = {
        "space": "S3",
        "mirrors": [[0.0, 1.0, 0.0, 0.0]],
        "kernels": [{"c": [0.8, -0.6, 0.0, 0.0], "r": 0.1}] * 2,
    }
    with pytest.raises(ValueError, match=message):
        model(record | change, opencl_device)


def test_points_off_the_model_are_refused(opencl_device: Device) -> None:
    found = model(chain("H3", 1, 1), opencl_device)
    with pytest.raises(ValueError, match="point 1 is off the model of h3; as in the record, the origin is"):
        found.distance([[1.0, 0, 0, 0], [1.5, 0, 0, 0]])
    with pytest.raises(ValueError, match=r"points have shape \(1, 3\); expected \(N, 4\)"):
        found.distance([[1.0, 0, 0]])
