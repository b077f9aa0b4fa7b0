"""Records of kernel-reflection sequences that say too little or something odd: messages and warnings."""

import json
import re
import warnings
from typing import Any

import krs_models as models
import krs_truth as truth
import numpy as np
import pytest
from golden import DATA, Array
from krs_truth import Record, length, vector

from thurston_cl.device import Device
from thurston_cl.krs import Model
from thurston_cl.krs.kernels import SAME_PLANE

RECORDS = json.loads((DATA / "krs.json").read_text(encoding="utf-8"))

BALL = {"type": "sphere", "c": [0.0, 0.0, 0.0], "r": 0.5}
ARC = {"type": "torcap", "p": [0.0, 0, 0], "q": [1.0, 0, 0], "m": [0.5, 0.1, 0], "r": 0.1}
LEAF = {"type": "lens", "c": [0.0, 0, 0], "a": [0.0, 0, 1], "b": 0.3, "h": 0.1}
CAPSULE = {"type": "capsule", "a": [0.0, 0, 0], "b": [1.0, 0, 0], "r": 0.1}
PLANE = {"type": "plane", "n": [0.0, 0, 1], "h": -2.0}
MIRROR = {"u": [1.0, 0.0, 0.0], "w": 2.0}
IDENTITY = [[[1.0, 0, 0, 0], [0.0, 0, 0, 0]], [[0.0, 0, 0, 0], [1.0, 0, 0, 0]]]


def one(kernel: Any) -> Record:
    return {"mirrors": [], "kernels": [kernel]}


def mirrored(**change: Any) -> Record:
    return {"mirrors": [MIRROR | change], "kernels": [BALL, BALL]}


MISTAKES: dict[str, tuple[Record, str]] = {
    "nothing": ({}, "a record of a sequence has 'mirrors' or 'G', and 'kernels'"),
    "no kernels": ({"mirrors": []}, "a record of a sequence has 'mirrors' or 'G', and 'kernels'"),
    "no mirrors of a curved space": (
        {"space": "S3", "kernels": [{"c": [1.0, 0, 0, 0], "r": 0.1}]},
        "a record of a sequence has 'mirrors' or 'G', and 'kernels'",
    ),
    "within nothing": (one(BALL) | {"within": 0}, "within is 0; expected a number greater than 0"),
    "unknown key": (one(BALL) | {"mirror": []}, "unknown key 'mirror'; did you mean 'mirrors'\\?"),
    "mirrors no list": ({"mirrors": 3, "kernels": [BALL]}, "mirrors is 3; expected a list"),
    "kernel no mapping": (one(3.0), r"kernel 0 is 3\.0; expected a mapping"),
    "too few kernels": (
        {"mirrors": [MIRROR], "kernels": [BALL]},
        "1 mirrors and 1 kernels; expected one kernel more than mirrors",
    ),
    "too many kernels": ({"mirrors": [], "kernels": [BALL] * 2}, "0 mirrors and 2 kernels"),
    "too many levels": (
        {"mirrors": [MIRROR] * 41, "kernels": [BALL] * 42},
        "41 levels; expected at most 40",
    ),
    "too many maps": ({"G": [IDENTITY] * 41, "kernels": [BALL] * 42}, "41 levels; expected at most 40"),
    "all empty": (one({"type": "empty"}), "all kernels are empty"),
    "unknown type": (one(BALL | {"type": "cube"}), "kernel 0 has type 'cube'; expected one of: .*sphere"),
    "no radius": (one({"type": "sphere", "c": [0, 0, 0]}), "kernel 0, a sphere, has no 'r'"),
    "no end": (one({"type": "torcap", "p": [0, 0, 0], "r": 1}), "kernel 0, a torcap, has no 'q'"),
    "negative radius": (one(BALL | {"r": -0.5}), r"r of kernel 0 is -0\.5; expected a number greater than 0"),
    "no size": (one(CAPSULE | {"r": 0}), "r of kernel 0 is 0; expected a number greater than 0"),
    "nan radius": (one(BALL | {"r": np.nan}), "r of kernel 0 is nan; expected a finite number"),
    "text radius": (one(BALL | {"r": "big"}), "r of kernel 0 is 'big'; expected a finite number"),
    "nan center": (one(BALL | {"c": [0, np.nan, 0]}), r"c of kernel 0 is \[0, nan, 0\]; expected 3 finite"),
    "flat center": (one(BALL | {"c": [0, 0]}), r"c of kernel 0 is \[0, 0\]; expected 3 finite numbers"),
    "infinite end": (one(CAPSULE | {"b": [np.inf, 0, 0]}), "b of kernel 0 is .*; expected 3 finite numbers"),
    "arc without chord": (one(ARC | {"q": ARC["p"]}), "kernel 0, a torcap, begins where it ends"),
    "arc by infinity": (
        one(ARC | {"m": [1.5, 0, 0]}),
        "m of kernel 0 is on the line through p and q, and not between them",
    ),
    "no axis": (one(LEAF | {"a": [0, 0, 0]}), "a of kernel 0 is the zero vector; expected a direction"),
    "no thickness": (one(LEAF | {"h": 0.0}), "h of kernel 0 is 0; expected a number greater than 0"),
    "thick leaf": (one(LEAF | {"h": 0.4}), r"h of kernel 0, .*, is 0\.4, more than the rim radius b, 0\.3"),
    "plane without normal": (one(PLANE | {"n": [0, 0, 0]}), "n of kernel 0 is the zero vector"),
    "negative part": (one(BALL | {"mat": -1}), "kernel 0 has mat -1; expected a whole number from 0"),
    "half a part": (one(BALL | {"mat": 0.5}), r"kernel 0 has mat 0\.5; expected a whole number from 0"),
    "zero normal": (mirrored(u=[0, 0, 0]), "u of mirror 0 is the zero vector; expected a direction"),
    "nan normal": (mirrored(u=[np.nan, 0, 0]), "u of mirror 0 is .*nan.*; expected 3 finite numbers"),
    "nan offset": (mirrored(w=np.nan), "w of mirror 0 is nan; expected a finite number"),
    "no offset": ({"mirrors": [{"u": [1, 0, 0]}], "kernels": [BALL] * 2}, "mirror 0 has no 'w'"),
    "mirror no mapping": (
        {"mirrors": [[1, 0, 0]], "kernels": [BALL] * 2},
        "mirror 0 is .*; expected a mapping",
    ),
    "widths": (
        mirrored() | {"smooth": [0.1, 0.2]},
        "smooth has 2 widths for 1 levels; expected one for each",
    ),
    "negative width": (mirrored() | {"smooth": [-0.1]}, "smooth has a negative width"),
    "nan width": (mirrored() | {"smooth": [np.nan]}, "smooth 0 is nan; expected a finite number"),
    "matrix of numbers": (
        {"G": [[[1, 0], [0, 1]]], "kernels": [BALL] * 2},
        "G of level 0: expected a 2 x 2 matrix of quaternions",
    ),
    "nan in a matrix": (
        {"G": [IDENTITY, [[[np.nan] * 4] * 2] * 2], "kernels": [BALL] * 3},
        "G of level 1: expected a 2 x 2 matrix of quaternions of four finite numbers",
    ),
    "ragged matrix": ({"G": [[[1], [2, 3]]], "kernels": [BALL] * 2}, "G of level 0: "),
    "singular matrix": (
        {"G": [[IDENTITY[0], [[0, 0, 0, 0]] * 2]], "kernels": [BALL] * 2},
        "G of level 0: this Moebius map is not invertible",
    ),
    "plane under maps": (
        {"G": [IDENTITY], "kernels": [BALL, PLANE]},
        "a plane among the kernels of a Moebius",
    ),
}


@pytest.mark.filterwarnings("ignore:kernel")
@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes(name: str, opencl_device: Device) -> None:
    record, message = MISTAKES[name]
    with pytest.raises(ValueError, match=message):
        Model.from_dict(record, device=opencl_device)


def test_settings(opencl_device: Device) -> None:
    with pytest.raises(ValueError, match="unknown precision 'half'; expected 'single' or 'double'"):
        Model.from_dict(one(BALL), precision="half", device=opencl_device)
    with pytest.raises(ValueError, match="3 lanes; expected one of: 1, "):
        Model.from_dict(one(BALL), lanes=3, device=opencl_device)


def test_a_pole_inside_what_a_map_carries_is_refused(opencl_device: Device) -> None:
    """The image of the ball about the pole of q -> q/|q|^2 would be all that is outside another."""
    inversion = [[[0.0, 0, 0, 0], [-1.0, 0, 0, 0]], [[1.0, 0, 0, 0], [0.0, 0, 0, 0]]]
    record = {"G": [inversion], "kernels": [BALL | {"c": [-3.0, 0, 0]}, BALL]}
    with pytest.raises(ValueError, match="the pole of a map lies within what it maps"):
        _ = Model.from_dict(record, device=opencl_device).radius


# Warnings.


def test_mirrors_whose_normals_have_another_length_are_made_unit(opencl_device: Device) -> None:
    record = models.chain(2, 3, ("sphere",))
    stretched = {**record, "mirrors": [*record["mirrors"]]}
    u, w = record["mirrors"][1]["u"], record["mirrors"][1]["w"]
    stretched["mirrors"][1] = {"u": [3 * c for c in u], "w": 3 * w}
    with pytest.warns(UserWarning) as told:
        found = Model.from_dict(stretched, device=opencl_device)
    assert [str(warning.message) for warning in told] == [
        "the normals of mirrors 1 are not of length 1; u and w were divided by their length"
    ]
    assert told[0].filename == __file__
    points = models.points_around(record, 500, 1)
    assert np.abs(found.distance(points) - truth.brute(record, points)).max() < 1e-12


@pytest.mark.filterwarnings("error")
def test_axes_and_normals_of_kernels_may_have_any_length(opencl_device: Device) -> None:
    points = np.random.default_rng(2).normal(size=(200, 3))
    found = Model.from_dict(one(LEAF | {"a": [0.0, 0, 5]}), device=opencl_device).distance(points)
    assert np.abs(found - truth.kernel_distance(LEAF, points)).max() < 1e-14
    found = Model.from_dict(one(PLANE | {"n": [0.0, 0, 4], "h": -8.0}), device=opencl_device).distance(points)
    assert np.abs(found - truth.kernel_distance(PLANE, points)).max() < 1e-14


@pytest.mark.filterwarnings("ignore:the normals of mirrors 0")
@pytest.mark.parametrize("size", [1e200, 1e-200, 1e-310])
def test_normals_whose_squares_are_no_numbers(size: float, opencl_device: Device) -> None:
    """Of a mirror and of a half-space: as those of length 1."""
    half, ball = np.sqrt(0.5), BALL | {"c": [-2.0, 0, 0]}
    diagonal, offset = np.array([1.0, 1.0, 0.0]), 0.3 / half
    points = np.random.default_rng(3).normal(size=(100, 3))

    def distance(kernel: Record, u: Array, w: float) -> Array:
        record = {"mirrors": [{"u": u.tolist(), "w": w}], "kernels": [ball, kernel]}
        return Model.from_dict(record, device=opencl_device).distance(points)

    plane = PLANE | {"n": (half * diagonal).tolist(), "h": -4.0}
    want = distance(plane, half * diagonal, 0.3)
    far = PLANE | {"n": (size * diagonal).tolist(), "h": -4.0 / half * size}
    np.testing.assert_allclose(distance(far, size * diagonal, offset * size), want, atol=1e-12)


def said_of(record: Record, device: Device) -> list[str]:
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        Model.from_dict(record, device=device)
    return [str(warning.message) for warning in told]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", models.BOUNDED)
def test_how_far_a_kernel_reaches_beyond_its_mirror(kind: str, seed: int, opencl_device: Device) -> None:
    rng = np.random.default_rng(seed)
    kernel, u = models.kernel(kind, rng, rng.normal(size=3)), models.direction(rng)
    heights = truth.surface(kernel, 200000, rng) @ u
    record = {"mirrors": [{"u": u.tolist(), "w": 0.0}], "kernels": [kernel, {"type": "empty"}]}
    record["mirrors"][0]["w"] = float(heights.max() + 1e-3)
    assert said_of(record, opencl_device) == []
    beyond = 0.3 * np.ptp(heights)
    record["mirrors"][0]["w"] = float(heights.max() - beyond)
    (said,) = said_of(record, opencl_device)
    found = re.fullmatch(
        r"kernel 0 \(by ([\d.e-]+)\) reaches beyond the mirror that follows it; what is there is clipped",
        said,
    )
    assert found is not None, said
    assert abs(float(found[1]) - beyond) < 0.01 * beyond


def test_one_warning_names_all_kernels_that_cross(opencl_device: Device) -> None:
    far = {"type": "sphere", "c": [-5.0, 0, 0], "r": 0.5}
    near = {"type": "sphere", "c": [0.25, 0.0, 0], "r": 0.5}
    mirror = {"u": [1.0, 0, 0], "w": 0.0}
    record = {"mirrors": [mirror] * 3, "kernels": [near, far, BALL, far]}
    with pytest.warns(UserWarning) as told:
        Model.from_dict(record, device=opencl_device)
    assert [str(warning.message) for warning in told] == [
        "kernels 0 (by 0.75), 2 (by 0.5) reach beyond the mirror that follows them; what is there is clipped"
    ]
    assert told[0].filename == __file__
    plane = {"mirrors": [mirror], "kernels": [PLANE, BALL]}
    assert said_of(plane, opencl_device) == [
        "kernel 0 (without bound) reaches beyond the mirror that follows it; what is there is clipped"
    ]
    # A half-space on the negative side of its own mirror does not cross it.
    behind = {"mirrors": [mirror], "kernels": [{"type": "plane", "n": [1.0, 0, 0], "h": 0.0}, BALL]}
    assert said_of(behind, opencl_device) == []
    moebius = {"G": [IDENTITY], "kernels": [near, BALL]}
    assert said_of(moebius, opencl_device) == [
        "kernel 0 (by 0.75) reaches beyond the mirror that follows it; what is there is clipped"
    ]


@pytest.mark.parametrize(("product", "told"), [(1 - 0.9 * SAME_PLANE, 0), (1 - 1.1 * SAME_PLANE, 1)])
def test_a_half_space_that_faces_as_its_mirror(product: float, told: int, opencl_device: Device) -> None:
    """On both sides of SAME_PLANE: bounded towards its own normal alone."""
    n = [np.sqrt(1 - product**2), 0.0, product]
    record = {"mirrors": [{"u": [0.0, 0, 1], "w": 0.0}], "kernels": [PLANE | {"n": n}, BALL]}
    assert len(said_of(record, opencl_device)) == told


def test_kernels_of_the_records_that_cross_are_named(opencl_device: Device) -> None:
    for record in RECORDS["krs"]:
        crossing = [
            i
            for i, mirror in enumerate(record["mirrors"])
            if truth.support(record["kernels"][i], vector(mirror["u"])) > mirror["w"] + 1e-9
        ]
        said = " ".join(said_of(record, opencl_device))
        gone = {int(i) for i in re.findall(r"of kernel (\d+)", said)}
        assert [int(i) for i in re.findall(r"(\d+) \(by", said)] == [i for i in crossing if i not in gone]
        for i in gone:
            assert not shows(record, i)
        assert not (record["separated"] and said)


def shows(record: Record, i: int) -> bool:
    """Whether anything is drawn of a kernel: whether points come into it by folding."""
    kernels = [kernel if j == i else {"type": "empty"} for j, kernel in enumerate(record["kernels"])]
    alone = record | {"kernels": kernels}
    rng = np.random.default_rng(1)
    places = np.array([place[:3, 3] + place[:3, :3] @ kernels[i]["c"] for _, place in truth.expand(alone)])
    points = places[rng.integers(len(places), size=40000)] + kernels[i]["r"] * rng.uniform(-1, 1, (40000, 3))
    return bool((truth.folded(alone, points) < 0).any())


def test_kernels_that_are_gone_are_told_of(opencl_device: Device) -> None:
    """Also those that a later mirror takes, all images of them."""
    mirrors = [{"u": [1.0, 0, 0], "w": 0.0}, {"u": [0.0, 1, 0], "w": 0.0}, {"u": [0.0, 0, 1], "w": 0.3}]
    empty: list[Record] = [{"type": "empty"}] * 3
    for y, gone in ((0.5, True), (-0.5, False), (0.09, False)):
        record = {"mirrors": mirrors, "kernels": [{"type": "sphere", "c": [-0.5, y, 0], "r": 0.1}, *empty]}
        said = said_of(record, opencl_device)
        want = "nothing is left of kernel 0: all of it is beyond mirror 1; turn its normal round, or move it"
        assert said == ([want] if gone else [])
        assert shows(record, 0) is not gone


def test_touching_a_mirror_is_not_crossing_it(opencl_device: Device) -> None:
    u = np.array([0.6, 0.0, 0.8])
    for c in (np.array([0.1, 0.2, 0.3]), np.array([50.0, -70.0, 10.0])):
        mirror = {"u": u.tolist(), "w": float(u @ c) + 0.5}
        record = {"mirrors": [mirror], "kernels": [BALL | {"c": c.tolist()}, {"type": "empty"}]}
        assert said_of(record, opencl_device) == []


# What a model says of itself.


def test_parts_are_those_of_the_nearest_kernel(opencl_device: Device) -> None:
    record = models.chain(4, 3, models.BOUNDED)
    for i, kernel in enumerate(record["kernels"]):
        kernel["mat"] = 7 - i
    points = models.points_around(record, 2000, 2)
    values = np.full((5, len(points)), np.inf)
    for k, isometry in truth.expand(record):
        values[k] = np.minimum(values[k], truth.instance_distance(record, k, isometry, points))
    near, next_best = np.sort(values, axis=0)[:2]
    clear = next_best - near > 1e-9
    found = Model.from_dict(record, device=opencl_device).part(points)
    assert (found == 7 - values.argmin(axis=0))[clear].all()
    assert len(set(found)) >= 4


def test_empty_kernels_do_not_count_as_instances(opencl_device: Device) -> None:
    record = models.chain(3, 2, ("sphere",))
    record["kernels"][1] = {"type": "empty"}
    record["kernels"][3] = {"type": "empty"}
    found = Model.from_dict(record, device=opencl_device)
    assert found.levels == 3
    assert found.instances == len(found.expand()) == 8 + 2
    assert {k for k, _ in found.expand()} == {0, 2}
    points = models.points_around(record, 500, 3)
    assert np.abs(found.distance(points) - truth.brute(record, points)).max() <= 1e-12


def test_large_models_are_not_expanded(opencl_device: Device) -> None:
    record = {"mirrors": [MIRROR] * 28, "kernels": [BALL] * 29}
    found = Model.from_dict(record, device=opencl_device)
    assert found.instances == 2**29 - 1
    with pytest.raises(ValueError, match=f"{2**29 - 1} instances; at most"):
        found.expand()


def test_radii(opencl_device: Device) -> None:
    assert Model.from_dict(one(PLANE), device=opencl_device).radius == np.inf
    far = {"type": "sphere", "c": [3.0, 4.0, 0.0], "r": 0.5}
    assert Model.from_dict(one(far), device=opencl_device).radius == pytest.approx(5.5)
    # The mirror image of what it reflects counts: the farther corner of a row of balls.
    record = {"mirrors": [{"u": [1.0, 0, 0], "w": 4.0}], "kernels": [far, {"type": "empty"}]}
    assert Model.from_dict(record, device=opencl_device).radius == pytest.approx(np.hypot(5, 4) + 0.5)
    rng = np.random.default_rng(4)
    for kind in models.BOUNDED:
        kernel = models.kernel(kind, rng, rng.normal(size=3))
        reach = length(truth.surface(kernel, 20000, rng)).max()
        radius = Model.from_dict(one(kernel), device=opencl_device).radius
        assert reach <= radius * (1 + 1e-12)
        assert radius <= reach + 2 * np.ptp(truth.surface(kernel, 200, rng), axis=0).max()
