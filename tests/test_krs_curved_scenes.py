"""Kernel-reflection sequences in the curved geometries with mirrors: that scenes place mirrors and kernels
where they say; that what is rendered is what all instances, written out, would be; kernels against what they
are made of; and the recipe of a forest in hyperbolic space.
"""

import json
import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from golden import EPSILON, Array
from small_kernels import Body, SmallKernels

import thurston_cl as tc
from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.image import Image
from thurston_cl.krs import Model, curved
from thurston_cl.krs.recipes.hyperbolic_forest import (
    MOST_IRREGULAR,
    REGULAR_SIDE,
    doubled,
    hyperbolic_forest,
    pentagon,
)
from thurston_cl.krs.sequence import Sequence as KernelSequence
from thurston_cl.krs.words import levels_of
from thurston_cl.models import ORIGIN
from thurston_cl.program import geometry_parts
from thurston_cl.scene import load_text
from thurston_cl.scene.krs_curved import HyperbolicForest
from thurston_cl.scene.krs_sequence import _Points

SPACES = ("s3", "h3", "s2xe", "h2xe")
SIGNS = {"s3": (1, 1, 1, 1), "h3": (1, 1, 1, -1), "s2xe": (1, 1, 1, 1), "h2xe": (1, 1, -1, 1)}
SIZE = (96, 64)
both_precisions = pytest.mark.parametrize("precision", EPSILON)
every_space = pytest.mark.parametrize("space", SPACES)


@pytest.fixture(scope="module")
def spaces(opencl_device: Device) -> dict[str, Geometry]:
    return {name: Geometry(name, "double", opencl_device) for name in SPACES}


def some_points(g: Geometry, count: int, seed: int, farthest: float) -> Array:
    """Points up to a distance from the origin."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return g.flow(directions, rng.uniform(0.01, farthest, count))[0]


def some_directions(count: int, seed: int) -> Array:
    directions = np.random.default_rng(seed).normal(size=(count, 3))
    return directions / np.linalg.norm(directions, axis=1)[:, None]


# Scenes against their instances

# From the innermost: center and radius of a ball, and a mirror: the frame's normal, how far along.
BALLS: dict[str, Sequence[tuple[Sequence[float], float]]] = {
    "s3": [
        ([0.7, 0.1, 0.1], 0.1),
        ([0.3, -0.3, 0.2], 0.16),
        ([-0.2, 0.2, 0.5], 0.14),
        ([0.1, 0.2, -0.2], 0.2),
    ],
    "h3": [
        ([0.9, 0.1, 0.1], 0.15),
        ([0.3, -0.3, 0.2], 0.2),
        ([-0.2, 0.2, 0.5], 0.2),
        ([0.1, 0.2, -0.2], 0.2),
    ],
    "s2xe": [
        ([0.7, 0.1, 0.1], 0.1),
        ([0.3, -0.3, 0.2], 0.16),
        ([-0.2, 0.2, 0.3], 0.14),
        ([0.1, 0.2, -0.2], 0.2),
    ],
    "h2xe": [
        ([0.7, 0.1, 0.1], 0.1),
        ([0.3, -0.3, 0.2], 0.2),
        ([-0.2, 0.2, 0.3], 0.2),
        ([0.1, 0.2, -0.2], 0.2),
    ],
}
MIRRORS: dict[str, Sequence[tuple[Sequence[float], float]]] = {
    "s3": [([-1, 0.2, 0.1], -0.4), ([-0.3, 1, -0.2], 0.7), ([0.1, -0.3, 1], 0.9)],
    "h3": [([-1, 0.2, 0.1], -0.5), ([-0.3, 1, -0.2], 0.8), ([0.1, -0.3, 1], 1.0)],
    "s2xe": [([-1, 0.2, 0], -0.4), ([-0.3, 1, 0], 0.7), ([0, 0, 2], 0.6)],
    "h2xe": [([-1, 0.2, 0], -0.4), ([0, 0, -1], 0.3), ([-0.3, 1, 0], 0.9)],
}
VIEWS = {
    "s3": [-0.6, -0.9, 0.5],
    "h3": [-0.3, -0.5, 0.8],
    "s2xe": [-0.6, -0.9, 0.4],
    "h2xe": [-0.3, -0.5, 0.6],
    "e3": [-1, -1, 0.5],
}


def mirror_by_hand(space: str, normal: Sequence[float], offset: float) -> tuple[Array, float]:
    """The unit vector and the constant of a mirror across a geodesic from the origin, by its formula."""
    u = np.array(normal) / np.linalg.norm(normal)
    if space in ("s2xe", "h2xe") and u[2] != 0:
        return np.array([0, 0, 0, u[2]]), offset
    sine, cosine = (np.sin, np.cos) if space in ("s3", "s2xe") else (np.sinh, np.cosh)
    back = -sine(offset) if space in ("s3", "s2xe") else sine(offset)
    last = [u[2] * cosine(offset), back] if space in ("s3", "h3") else [back, 0.0]
    return np.array([u[0] * cosine(offset), u[1] * cosine(offset), *last]), 0.0


def written_out(g: Geometry) -> list[tuple[Array, float]]:
    """All balls of the sequence: L_0 = K_0, L_{i+1} = K_{i+1} u L_i u R_i L_i."""

    def ball(at: Sequence[float], radius: float) -> tuple[Array, float]:
        length = float(np.linalg.norm(at))
        return g.flow(np.array(at) / length, length)[0][0], radius

    signs, balls = np.array(SIGNS[g.name]), BALLS[g.name]
    found = [ball(*balls[0])]
    for mirror, kernel in zip(MIRRORS[g.name], balls[1:], strict=True):
        normal, constant = mirror_by_hand(g.name, *mirror)
        sides = [float(c @ (signs * normal)) - constant for c, _ in found]
        # Otherwise it is clipped, and no union of balls.
        assert max(sides) < 0
        found += [(c - 2 * side * normal, r) for (c, r), side in zip(found, sides, strict=True)]
        found.append(ball(*kernel))
    return found


def render(scene: Mapping[str, Any], device: Device, **settings: Any) -> Image:
    return tc.render(load_text(json.dumps(scene)), size=SIZE, samples=1, device=device, **settings)


def scene_of(space: str, shape: Mapping[str, Any], **more: Any) -> dict[str, Any]:
    camera = {"at": VIEWS[space], "look": {"to": [0, 0, 0.1]}, "fov": "75 deg"}
    return {
        "geometry": space,
        "camera": camera,
        "objects": [dict(shape)],
        "render": {"steps": 3000, "threshold": 1e-6},
        **more,
    }


@every_space
def test_a_sequence_is_seen_as_all_its_instances_are(
    space: str, spaces: dict[str, Geometry], opencl_device: Device
) -> None:
    instances = written_out(spaces[space])
    assert len(instances) == 15
    balls = [{"ball": {"radius": radius, "at": list(at)}} for at, radius in BALLS[space]]
    levels = [
        {"mirror": {"normal": list(normal), "offset": offset}, "kernel": kernel}
        for (normal, offset), kernel in zip(MIRRORS[space], balls[1:], strict=True)
    ]
    union = [{"ball": {"radius": r}, "at": {"model": c.tolist()}} for c, r in instances]
    folded = render(
        scene_of(space, {"krs": {"kernel": balls[0], "levels": levels}}), opencl_device, precision="double"
    )
    brute = render(scene_of(space, {"union": union}), opencl_device, precision="double")
    hit = brute.channels["object"] > 0
    assert 0.1 < hit.mean() < 0.99
    assert np.count_nonzero(folded.channels["object"] != brute.channels["object"]) <= 3
    both = hit & (folded.channels["object"] > 0)
    off = np.abs(folded.channels["depth"][both] - brute.channels["depth"][both])
    # A ray ends within the threshold of the surface, the earlier the more it grazes.
    assert np.quantile(off, 0.95) < 1e-5
    assert off.max() < 1e-2
    turned = (folded.channels["normal"] * brute.channels["normal"]).sum(axis=-1)[both]
    assert np.quantile(turned, 0.01) > 1 - 1e-4


@every_space
def test_single_precision_sees_what_double_sees(space: str, opencl_device: Device) -> None:
    balls = [{"ball": {"radius": radius, "at": list(at)}} for at, radius in BALLS[space]]
    levels = [
        {"mirror": {"normal": list(normal), "offset": offset}, "kernel": kernel}
        for (normal, offset), kernel in zip(MIRRORS[space], balls[1:], strict=True)
    ]
    scene = scene_of(space, {"krs": {"kernel": balls[0], "levels": levels}}, render={"steps": 1000})
    single, double = (render(scene, opencl_device, precision=p).channels for p in ("single", "double"))
    assert np.count_nonzero(single["object"] != double["object"]) <= 10
    both = (single["object"] > 0) & (double["object"] > 0)
    assert np.quantile(np.abs(single["depth"][both] - double["depth"][both]), 0.95) < 1e-4


# Mirrors


@pytest.mark.parametrize(
    ("space", "normal", "offset", "at"),
    [
        ("s3", [1, 0, 0], 0.4, [0.3, -0.8, 0.5]),
        ("s3", [0.3, -0.4, 1], 2.5, [1.5, 1.5, -1]),
        ("h3", [0, 1, 1], -0.7, [0.5, 0.2, 0.1]),
        ("h3", [0.3, -0.4, 1], 1.5, [-1, 1.2, 0.3]),
        ("s2xe", [1, 2, 0], 0.6, [0.4, 0.3, 1]),
        ("s2xe", [1, -1, 0], 0.3, [2, 1.5, 0]),
        ("s2xe", [0, 0, -3], 0.6, [0.4, 0.3, 1]),
        ("h2xe", [1, 2, 0], -0.6, [0.4, 0.3, 1]),
        ("h2xe", [0, 0, 1], -0.6, [0.4, 0.3, 1]),
    ],
)
def test_a_mirror_stands_across_its_geodesic(
    space: str, normal: list[float], offset: float, at: list[float], spaces: dict[str, Geometry]
) -> None:
    g = spaces[space]
    start = g.flow(np.array(at) / np.linalg.norm(at), np.linalg.norm(at))[0]
    mirror = _Points(g).mirror((normal[0], normal[1], normal[2]), offset, (at[0], at[1], at[2]))
    u = np.tile(np.array(normal) / np.linalg.norm(normal), (5, 1))
    times = np.linspace(0, 1, 5)
    before, beyond = (g.flow(u, offset + s * times, base=np.tile(start, (5, 1)))[0] for s in (-1, 1))
    images = (np.concatenate([before, np.ones((5, 1))], axis=1) @ mirror.matrix.T)[:, :4]
    np.testing.assert_allclose(images, beyond, atol=1e-13 * np.abs(beyond).max())
    # The normal points to where the image is.
    assert np.all(beyond[1:] @ mirror.form[:4] + mirror.form[4] > 0)
    # The plane stays where it is, point by point.
    foot, direction = g.flow(u[:1], offset, base=start)
    across = np.cross(direction[0], [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    across = across[np.linalg.norm(across, axis=1) > 1e-9]
    along = g.flow(
        across / np.linalg.norm(across, axis=1)[:, None], 0.7, base=np.tile(foot, (len(across), 1))
    )[0]
    fixed = (np.concatenate([along, np.ones((len(along), 1))], axis=1) @ mirror.matrix.T)[:, :4]
    np.testing.assert_allclose(fixed, along, atol=1e-13 * np.abs(along).max())


@every_space
def test_explain_tells_of_mirrors_as_scenes_write_them(space: str, spaces: dict[str, Geometry]) -> None:
    points = _Points(spaces[space])
    ball = curved.sphere(space, np.array(ORIGIN[space]), 0.1, 0)
    for sense in (1, -1):
        mirror = points.mirror((sense * 0.6, sense * -0.8, 0), 0.3)
        sequence = KernelSequence(space, (mirror,), (ball, ball))
        across = "(0.6, -0.8, 0)" if sense == 1 else "(-0.6, 0.8, 0)"
        assert levels_of(sequence, [None])[1].step == f"mirror {across} at 0.3"
    if space in ("s2xe", "h2xe"):
        level = KernelSequence(space, (points.mirror((0, 0, -1), 0.3),), (ball, ball))
        assert levels_of(level, [None])[1].step == "horizontal mirror at -0.3"
    if space == "s3":
        far = KernelSequence(space, (points.mirror((0, 0, 1), np.pi / 2),), (ball, ball))
        assert levels_of(far, [None])[1].step == "mirror a quarter turn from the origin"


# Kernels


def alone(space: str, kernel: curved.Kernel) -> KernelSequence:
    return KernelSequence(space, (), (kernel,))


# In s3 also longer than a quarter turn, about the antipode of the origin, and nearly half a turn long.
CAPSULES = [
    ("s3", [0.3, 0.2, 0.1], [0.9, -0.5, 0.4]),
    ("s3", [-1.2, 0.4, 0], [1.3, 0.1, 0.3]),
    ("s3", [0, 0, 2.8], [0, 0, 3.4831853]),
    ("s3", [0, 0, 0], [0, np.pi - 1e-3, 0]),
    ("h3", [0.3, 0.2, 0.1], [0.9, -0.5, 0.4]),
    ("h3", [-1.5, 0.4, 0], [1.6, 0.1, 0.3]),
    ("s2xe", [0.5, 0.4, -0.3], [0.5, 0.4, 0.8]),
    ("s2xe", [np.pi, 0, 0], None),
    ("h2xe", [0.5, 0.4, -0.3], [0.5, 0.4, 0.8]),
    ("h2xe", [-1.5, 1.4, 0], None),
]


def ends_of(g: Geometry, a: Sequence[float], b: Sequence[float] | None) -> tuple[Array, Array]:
    def point(v: Sequence[float]) -> Array:
        length = float(np.linalg.norm(v))
        return g.flow(np.array(v) / (length or 1) if length else np.array([0.0, 0, 1]), length)[0][0]

    first = point(a)
    if g.name in ("s2xe", "h2xe"):
        second = first + np.array([0, 0, 0, 1.1 if b is None else b[2] - a[2]])
        return first, second
    assert b is not None
    return first, point(b)


def least_distance(g: Geometry, points: Array, a: Array, b: Array) -> Array:
    """From a geodesic segment, by looking at points of it, and again next to the nearest."""
    directions, lengths = g.geodesics(b, 1, base=a)
    u, length = directions[0, 0], float(lengths[0, 0])
    low, high = np.zeros(len(points)), np.full(len(points), length)
    for _ in range(3):
        share = np.linspace(0, 1, 201)
        times = low[:, None] + (high - low)[:, None] * share
        on = g.flow(np.tile(u, (times.size, 1)), times.ravel(), base=np.tile(a, (times.size, 1)))[0]
        found = g.distance(np.repeat(points, len(share), axis=0), base=on).reshape(times.shape)
        best = found.argmin(axis=1)
        step = (high - low) / (len(share) - 1)
        middle = np.take_along_axis(times, best[:, None], axis=1)[:, 0]
        low, high = np.maximum(middle - step, 0), np.minimum(middle + step, length)
    return found.min(axis=1)


@both_precisions
@pytest.mark.parametrize(("space", "a", "b"), CAPSULES)
def test_capsules_against_their_segments(
    space: str,
    a: list[float],
    b: list[float] | None,
    precision: str,
    spaces: dict[str, Geometry],
    opencl_device: Device,
) -> None:
    g = spaces[space]
    first, second = ends_of(g, a, b)
    model = Model(
        alone(space, curved.capsule(space, first, second, 0.1, 0)), precision=precision, device=opencl_device
    )
    points = some_points(g, 600, 3, 3.1 if space[0] == "s" else 2.5)
    # And next to the axis.
    points = np.concatenate([points, g.flow(some_directions(50, 4), 0.07, base=np.tile(first, (50, 1)))[0]])
    true = least_distance(g, points, first, second) - 0.1
    found = model.distance(points)
    limit = 1e-9 if precision == "double" else 8 * EPSILON["single"] * np.abs(points).max(axis=1)
    if space == "h3" and precision == "single":
        # Seen from its middle a point is rounded by as much more as the middle is far out.
        limit = limit * np.abs([first, second]).max() ** 2
    assert (np.abs(found - true) <= limit).all()
    assert (true < 0).any()


def kernels_of(g: Geometry) -> dict[str, curved.Kernel]:
    a, b = ends_of(g, [0.3, 0.2, -0.1], [0.6, -0.5, 0.4])
    points = _Points(g)
    found = {
        "sphere": curved.sphere(g.name, a, 0.3, 0),
        "capsule": curved.capsule(g.name, a, b, 0.2, 0),
        "plane": curved.plane(g.name, points.mirror((0.6, 0.8, 0), 0.3), 0),
    }
    if g.name in ("s2xe", "h2xe"):
        found["level"] = curved.plane(g.name, points.mirror((0, 0, -1), 0.3), 0)
    return found


@every_space
def test_normals_are_the_gradients_of_distances(
    space: str, spaces: dict[str, Geometry], opencl_device: Device
) -> None:
    g = spaces[space]
    points = some_points(g, 300, 5, 3.0 if space[0] == "s" else 2.0)
    step, frames = 1e-4, [np.tile(e, (len(points), 1)) for e in np.eye(3)]
    for name, kernel in kernels_of(g).items():
        model = Model(alone(space, kernel), device=opencl_device)
        sides = [[model.distance(g.flow(e, s, base=points)[0]) for s in (step, -step)] for e in frames]
        slopes = np.array([(ahead - behind) / (2 * step) for ahead, behind in sides]).T
        # Where surfaces of equal distance are smooth: not at centers, axes and what is farthest away.
        smooth = np.abs(np.linalg.norm(slopes, axis=1) - 1) < 1e-6
        assert smooth.mean() > 0.9, name
        normal = model.normal(points)
        parts = np.array([(normal * SIGNS[space] * g.velocity(points, e)).sum(axis=1) for e in frames]).T
        # The end of a segment takes over from its side with a jump in the curvature.
        assert np.quantile(np.abs(parts - slopes)[smooth], 0.98) < 1e-5, name
        assert np.abs(parts - slopes)[smooth].max() < 1e-3, name


@pytest.mark.filterwarnings("ignore:.*reaches beyond the mirror")
@pytest.mark.parametrize(
    ("space", "normal"),
    [
        ("s3", [0, 0, 1]),
        ("h3", [0, 0, 1]),
        ("s2xe", [0, 0, 1]),
        ("s2xe", [1, 0, 0]),
        ("h2xe", [0, 0, 1]),
        ("h2xe", [1, 0, 0]),
    ],
)
def test_patterns_of_half_spaces_are_those_of_ordinary_ones(
    space: str, normal: list[int], opencl_device: Device
) -> None:
    shape = {"half-space": {"normal": normal, "offset": -0.3}}
    material = {"color": {"checker": {"count": [5, 3]}}}
    # An ordinary one has its coordinates about its foot.
    camera = {
        "at": [0.2 * n + 0.1 for n in normal],
        "look": {"along": [-n + 0.5 for n in normal]},
        "fov": "100 deg",
    }
    settings = {"steps": 1000, "far": 1.4}
    pictures = [
        render(
            {**scene_of(space, {**given, "material": material}), "camera": camera, "render": settings},
            opencl_device,
            precision="double",
        )
        for given in (shape, {"krs": {"kernel": shape, "levels": [FAR_MIRROR[space]]}})
    ]
    one, other = (picture.channels["beauty"] for picture in pictures)
    assert (one.max(axis=2) > 0).mean() > 0.2
    assert (np.abs(one - other).max(axis=2) > 0.02).mean() < 0.005


# A mirror that nothing in sight lies beyond.
FAR_MIRROR = {
    "s3": {"mirror": {"normal": [0, 0, 1], "offset": 1.57}},
    "h3": {"mirror": {"normal": [0, 0, 1], "offset": 9}},
    "s2xe": {"mirror": {"normal": [0, 0, 1], "offset": 90}},
    "h2xe": {"mirror": {"normal": [0, 0, 1], "offset": 90}},
}
COORDINATES = Body(
    4,
    2,
    "scene_data scene = {numbers, 0}; point p = POINT(0); surface s = krs_capsule_surface(p, scene, 2); "
    "OUT(0, s.u); OUT(1, s.v);",
)


@pytest.mark.parametrize(
    ("space", "a", "b"), [case for case in CAPSULES if case[0] in ("s3", "h3")][:2] + CAPSULES[4:6]
)
def test_angles_about_a_capsule_go_once_around(
    space: str, a: list[float], b: list[float], spaces: dict[str, Geometry], opencl_device: Device
) -> None:
    g = spaces[space]
    first, second = ends_of(g, a, b)
    kernel = curved.capsule(space, first, second, 0.1, 0)
    directions, lengths = g.geodesics(second, 1, base=first)
    at, along = (found[0] for found in g.flow(directions[0, 0], 0.4 * lengths[0, 0], base=first))
    side = np.cross(along, [0.0, 0, 1])
    side /= np.linalg.norm(side)
    angles = np.linspace(0, 2 * np.pi, 41)[:40]
    around = np.cos(angles)[:, None] * side + np.sin(angles)[:, None] * np.cross(along, side)
    points = g.flow(around, 0.1, base=np.tile(at, (40, 1)))[0]
    parts = (*geometry_parts(space), "scene_types.h", "shape/angles.h", "krs/capsule.h")
    kernels = SmallKernels(opencl_device, parts, {"coordinates": COORDINATES}, "double", 8)
    turn, length = kernels.run("coordinates", points.T, kernel.numbers)
    steps = np.unwrap(turn, period=1)
    np.testing.assert_allclose(np.abs(np.diff(steps)), 1 / 40, atol=1e-9)
    assert abs(abs(steps[-1] - steps[0]) - 39 / 40) < 1e-9
    np.testing.assert_allclose(length, -0.1 * lengths[0, 0], atol=1e-9)


@pytest.mark.parametrize("space", ["s3", "h3"])
def test_what_reaches_beyond_a_mirror_between_its_ends_is_told(
    space: str, spaces: dict[str, Geometry]
) -> None:
    """On a sphere the middle of a segment is farther beyond a mirror than its ends; in hyperbolic space it is
    nearer to one before which it lies."""
    g = spaces[space]
    a, b = ends_of(g, [0.05, 0, -1.2], [0.05, 0, 1.2])
    kernel = curved.capsule(space, a, b, 0.1, 0)
    for offset in (0.0, 0.1, 0.2, 0.5):
        mirror = _Points(g).mirror((1, 0, 0), offset)
        on = g.flow(g.geodesics(b, 1, base=a)[0][0], np.linspace(0, g.distance(b, base=a)[0], 2001), base=a)[
            0
        ]
        sines = on @ mirror.form[:4]
        deepest = float(np.max(np.arcsin(sines) if space == "s3" else np.arcsinh(sines))) + 0.1
        assert abs(kernel.reach(mirror.form) - deepest) < 1e-6


@every_space
def test_half_spaces_before_their_mirror_do_not_reach_it(space: str, spaces: dict[str, Geometry]) -> None:
    points = _Points(spaces[space])
    normals = [(1.0, 0.0, 0.0)] if space in ("s3", "h3") else [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    for u in normals:
        kernel = curved.plane(space, points.mirror(u, 0.3), 0)
        for offset in (0.2, 0.3, 0.5):
            # On a sphere any two great circles meet.
            nested = space == "h3" or u[2] == 1 or space == "h2xe"
            expected = 0.3 - offset if (nested and offset >= 0.3) or u[2] == 1 else np.inf
            if offset == 0.3:
                expected = 0
            assert kernel.reach(points.mirror(u, offset).form) == pytest.approx(expected, abs=1e-7)
        back = points.mirror((-u[0], 0.0, -u[2]), 0.5)
        assert kernel.reach(back.form) == np.inf


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", ["h3/forest", "s3/woven-fibers", "h2xe/hall"])
def test_scenes_do_not_warn_of_what_no_mirror_takes_away(name: str, opencl_device: Device) -> None:
    tc.render(tc.load_scene(name), size=(24, 16), samples=1, device=opencl_device)


@pytest.mark.parametrize("at", [-0.05, 0.0, 0.05])
@pytest.mark.parametrize("space", ["e3", *SPACES])
def test_scenes_warn_of_what_a_mirror_takes_away(space: str, at: float, opencl_device: Device) -> None:
    """Of a ball whose center is beyond a mirror, and of a plane that is not across it."""
    levels = [{"mirror": {"normal": [1, 0, 0], "offset": 0.3}}]
    ball = {"ball": {"radius": 0.1, "at": [0.3 + at, 0, 0]}}
    plane = {"half-space": {"normal": [0.05 + at, -1, 0]}}
    for kernel, is_lost in ((ball, at > 0), (plane, at > -0.05)):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            render(scene_of(space, {"krs": {"kernel": kernel, "levels": levels}}), opencl_device)
        assert any("reaches beyond the mirror" in str(found.message) for found in told) is is_lost, kernel


# The forest

METRIC = np.diag([-1.0, 1, 1, 1])
SMALL = {"doublings": 4, "forks": 4, "foliage": 2}


def axis_points(kernel: Mapping[str, Any]) -> list[Array]:
    """The ends or the center of a kernel's axis."""
    return [np.array(kernel[key]) for key in "abc" if key in kernel]


@pytest.mark.parametrize("seed", range(5))
def test_a_pentagon_has_right_angles(seed: int) -> None:
    a, b = REGULAR_SIDE * (1 + MOST_IRREGULAR * np.random.default_rng(seed).uniform(-1, 1, 2))
    sides = np.array(pentagon(float(a), float(b)))
    products = sides @ METRIC @ sides.T
    np.testing.assert_allclose(np.diag(products), 1, atol=1e-12)
    neighbors = (np.arange(5), (np.arange(5) + 1) % 5)
    np.testing.assert_allclose(products[neighbors], 0, atol=1e-12)
    # The others do not meet, the origin is inside, and the ground across all of them.
    assert np.all(products[np.arange(5), (np.arange(5) + 2) % 5] < -1)
    assert np.all(sides[:, 0] > 0.3)
    assert np.all(sides[:, 3] == 0)
    # Corners next to the first side are its ends, at the right distance.
    corners = [np.cross(*(METRIC[:3, :3] @ sides[i, :3] for i in pair)) for pair in ((4, 0), (0, 1))]
    corners = [c * np.sign(c[0]) / np.sqrt(-(c @ METRIC[:3, :3] @ c)) for c in corners]
    assert abs(np.arccosh(-(corners[0] @ METRIC[:3, :3] @ corners[1])) - a) < 1e-9


def test_sides_that_are_too_short_make_no_pentagon() -> None:
    with pytest.raises(ValueError, match=r"no right-angled pentagon has neighboring sides of 0\.8 and 0\.9"):
        pentagon(0.8, 0.9)
    least = REGULAR_SIDE * (1 - MOST_IRREGULAR)
    assert len(pentagon(least, least)) == 5


def test_the_polygon_stays_right_angled_and_doubles() -> None:
    """All cells lie before each mirror, no two in one place, and each mirror is a wall of their tiling."""
    sides = pentagon(1.0, 1.1)
    mirrors = [mirror for mirror, _ in doubled(sides, 6)]
    cells = [np.eye(4)]
    for mirror in mirrors:
        reflection = np.eye(4) - 2 * np.outer(mirror, METRIC @ mirror)
        middles = np.array([cell[:, 0] for cell in cells])
        # All cells lie before it, and none of them twice.
        assert (middles @ METRIC @ mirror).max() < -0.3
        cells += [reflection @ cell for cell in cells]
    middles = np.array([cell[:, 0] for cell in cells])
    apart = np.arccosh(np.maximum(-middles @ METRIC @ middles.T, 1)) + 9 * np.eye(64)
    assert apart.min() > 0.5
    # Each mirror is a wall of the tiling: the plane through a side of some cell.
    walls = np.array([cell @ side for cell in cells for side in sides])
    for mirror in mirrors:
        assert np.abs(np.abs(walls @ METRIC @ mirror) - 1).min() < 1e-9
    # The nearest side first: the sides of the first cell come before any other.
    distances = np.arcsinh([mirror[0] for mirror in mirrors])
    assert np.all(np.diff(distances) > -1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_every_mirror_of_a_forest_has_the_levels_before_on_its_negative_side(seed: int) -> None:
    record = hyperbolic_forest(seed=seed, **SMALL)
    mirrors = np.array(record["mirrors"])
    assert len(mirrors) == 10
    assert len(record["kernels"]) == 11
    np.testing.assert_allclose(np.einsum("ij,jk,ik->i", mirrors, METRIC, mirrors), 1, atol=1e-9)
    points = np.array(axis_points(record["kernels"][0]))
    for mirror, kernel in zip(mirrors, record["kernels"][1:], strict=True):
        sides = points @ METRIC @ mirror
        assert sides.max() <= 1e-9 * np.abs(points).max()
        points = np.concatenate(
            [points, points - 2 * np.outer(sides, mirror), np.array(axis_points(kernel)).reshape(-1, 4)]
        )
    # Trees stand on the ground, and those of different cells stay apart from each other.
    assert record["kernels"][-1] == {"type": "plane", "n": [0, 0, 0, 1], "mat": 2}
    assert points[:, 3].min() > -0.1


def test_nothing_of_a_forest_is_clipped(opencl_device: Device) -> None:
    """Its distance is that of all instances, although branches reach over the mirrors at their forks."""
    record = hyperbolic_forest(doublings=2, forks=3, foliage=1, leaf_size=0.1, seed=1)
    model = Model.from_dict(record, device=opencl_device)
    rng = np.random.default_rng(2)
    u = some_directions(400, 3)
    t = rng.uniform(0.05, 1.5, 400)
    points = np.concatenate([np.cosh(t)[:, None], np.sinh(t)[:, None] * u], axis=1)
    nearest = np.full(400, np.inf)
    for i, place in model.expand():
        kernel = record["kernels"][i]
        if kernel["type"] == "plane":
            nearest = np.minimum(nearest, np.arcsinh(points[:, 3]))
            continue
        moved = {
            key: (place @ np.array(value)).tolist() if key in "abc" else value
            for key, value in kernel.items()
        }
        one = Model.from_dict({"space": "H3", "mirrors": [], "kernels": [moved]}, device=opencl_device)
        nearest = np.minimum(nearest, one.distance(points))
    assert np.abs(model.distance(points) - nearest).max() < 1e-12


def trunk(record: Mapping[str, Any]) -> Mapping[str, Any]:
    """The last branch from the twigs down."""
    found: Mapping[str, Any] = [kernel for kernel in record["kernels"] if kernel.get("mat") == 0][-1]
    return found


def test_trees_are_as_high_as_is_asked() -> None:
    shares = 0.8 ** np.arange(5) * [1.5, 1, 1, 1, 1]
    record = hyperbolic_forest(height=1.2, thickness=0.08, **SMALL)
    assert trunk(record)["r"] == 0.04
    np.testing.assert_allclose(
        trunk(record)["b"], [np.cosh(h := 1.2 * shares[0] / shares.sum()), 0, 0, np.sinh(h)]
    )
    # Upright, from below the ground.
    np.testing.assert_allclose(trunk(record)["a"], [np.cosh(0.04), 0, 0, -np.sinh(0.04)])


def test_trees_are_no_larger_than_their_cells() -> None:
    record = hyperbolic_forest(
        height=2.5, spread=1.05, ratio=1, doublings=5, forks=8, foliage=2, thickness=0.07, leaf_size=0.05
    )
    smaller = trunk(record)["r"] / 0.035
    assert 0.3 < smaller < 0.5
    np.testing.assert_allclose(np.arcsinh(trunk(record)["b"][3]), smaller * 2.5 * 1.5 / 9.5)
    assert record["kernels"][0]["r"] == pytest.approx(0.025 * smaller)


def test_a_seed_makes_one_forest() -> None:
    assert hyperbolic_forest(seed=4, **SMALL) == hyperbolic_forest(seed=4, **SMALL)
    assert hyperbolic_forest(seed=4, **SMALL) != hyperbolic_forest(seed=5, **SMALL)


def test_a_forest_without_leaves_or_walls() -> None:
    bare = hyperbolic_forest(doublings=3, forks=3, foliage=0, wall=0)
    assert [kernel["type"] for kernel in bare["kernels"]] == ["capsule"] * 4 + ["empty"] * 2 + ["plane"]


def test_the_defaults_of_a_scene_are_those_of_the_recipe() -> None:
    assert HyperbolicForest().record() == hyperbolic_forest()
    assert [material.color for material in HyperbolicForest().materials] == [
        getattr(HyperbolicForest(), role).color for role in ("bark", "leaf", "ground", "stone")
    ]


def test_a_forest_far_out_in_single_precision(opencl_device: Device) -> None:
    """Rounding stays below a fiftieth of a pixel of 0.1 deg as far as there are trees."""
    record = hyperbolic_forest(seed=1)
    t = np.repeat(np.linspace(0.5, 5, 10), 200)
    u = some_directions(len(t), 7)
    u[:, 2] = 0.3 * np.abs(u[:, 2])
    u /= np.linalg.norm(u, axis=1)[:, None]
    points = np.concatenate([np.cosh(t)[:, None], np.sinh(t)[:, None] * u], axis=1)
    single, double = (
        Model.from_dict(record, precision=p, device=opencl_device).distance(points)
        for p in ("single", "double")
    )
    pixel = np.radians(0.1) * np.sinh(t)
    assert np.quantile(np.abs(single - double) / pixel, 0.99) < 0.02
