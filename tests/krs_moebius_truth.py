"""Truth for Moebius maps on quaternions and for kernel-reflection sequences distorted by them, in NumPy.

A map is a (2,2,4) array [[a, b], [c, d]] of quaternions [w, x, y, z] and acts on R^3, the quaternions without
real part, as (a q + b)(c q + d)^-1. L_0 = K_0, L_{i+1} = G_i (K_{i+1} u L_i u R L_i), R: x -> -x, and every
instance is the product of its matrices. Images of spheres come from the images of two of their points, not
from a formula for spheres.
"""

from collections.abc import Callable

import numpy as np
from golden import Array
from krs_truth import Kernel, Record, kernel_distance, length, surface, vector


def times(p: Array, q: Array) -> Array:
    """Products of quaternions (...,4)."""
    pw, qw, pv, qv = p[..., :1], q[..., :1], p[..., 1:], q[..., 1:]
    real = pw * qw - (pv * qv).sum(axis=-1, keepdims=True)
    return np.concatenate([real, pw * qv + qw * pv + np.cross(pv, qv)], axis=-1)


def conjugate(q: Array) -> Array:
    return q * np.array([1.0, -1, -1, -1])


def reciprocal(q: Array) -> Array:
    return conjugate(q) / (q**2).sum(axis=-1, keepdims=True)


def pure(points: Array) -> Array:
    points = vector(points)
    return np.concatenate([np.zeros((*points.shape[:-1], 1)), points], axis=-1)


def quaternion(real: float = 0.0, imaginary: Array | tuple[float, ...] = (0.0, 0.0, 0.0)) -> Array:
    return np.array([real, *imaginary], dtype=np.float64)


ONE, NONE = quaternion(1), quaternion(0)
I = quaternion(0, (1.0, 0.0, 0.0))  # noqa: E741
IDENTITY = np.array([[ONE, NONE], [NONE, ONE]])
MIRROR = np.array([[-I, NONE], [NONE, I]])
INVERSION = np.array([[NONE, -ONE], [ONE, NONE]])


def translation(v: Array) -> Array:
    return np.array([[ONE, pure(v)], [NONE, ONE]])


def dilation(s: float) -> Array:
    return np.array([[s * ONE, NONE], [NONE, ONE]])


def rotation(r: Array) -> Array:
    return np.array([[r, NONE], [NONE, r]])


def distortion(v: Array) -> Array:
    """Fixes the origin and directions there, carries v/|v|^2 to infinity."""
    return np.array([[ONE, NONE], [pure(v), ONE]])


def product(*maps: Array) -> Array:
    result = IDENTITY
    for m in maps:
        result = np.array(
            [[times(row[0], m[0, j]) + times(row[1], m[1, j]) for j in (0, 1)] for row in result]
        )
        result = result / np.sqrt((result**2).sum())
    return result


def inverse(m: Array) -> Array:
    """By elimination, for any invertible matrix of quaternions."""
    (a, b), (c, d) = m
    if (c**2).sum() < 1e-30 * (d**2).sum():
        x, y = reciprocal(a), reciprocal(d)
        return np.array([[x, -times(times(x, b), y)], [NONE, y]])
    s = b - times(times(a, reciprocal(c)), d)
    x, y = reciprocal(c), reciprocal(s)
    ac, cd = times(a, x), times(x, d)
    return np.array([[-times(cd, y), x + times(times(cd, y), ac)], [y, -times(y, ac)]])


def apply(m: Array, points: Array) -> Array:
    """Images (N,3) of points (N,3)."""
    (a, b), (c, d) = m
    q = pure(points)
    image = times(times(a, q) + b, reciprocal(times(c, q) + d))
    assert (np.abs(image[..., 0]) <= 1e-9 * np.maximum(1, length(image[..., 1:]))).all(), m
    return image[..., 1:]


def pole(m: Array) -> Array | None:
    """The point (3,) that goes to infinity; None where that is infinity."""
    c, d = m[1]
    if (c**2).sum() < 1e-28 * (d**2).sum():
        return None
    return -times(reciprocal(c), d)[1:]


def sphere_image(m: Array, center: Array, radius: float) -> tuple[Array, float, float]:
    """Center and radius of the image of a sphere, and -1 where its inside becomes the outside, else 1.

    The image is symmetric about the line through the images of the two points next to and farthest from the
    pole, so these are a diameter of it.
    """
    p = pole(m)
    away = np.array([1.0, 0, 0]) if p is None else vector(center) - p
    size = length(away)
    unit = away / size if size > 0 else np.array([1.0, 0, 0])
    first, second = apply(m, vector(center) + radius * np.stack([unit, -unit]))
    sign = 1.0 if p is None or size > radius else -1.0
    return (first + second) / 2, float(length(first - second)) / 2, sign


def determinant(m: Array) -> float:
    """That of Dieudonne and Study."""
    (a, b), (c, d) = m
    square = (a @ a) * (d @ d) + (b @ b) * (c @ c)
    mixed = times(times(conjugate(b), a), times(conjugate(c), d))[0]
    return float(np.sqrt(square - 2 * mixed))


def factor(m: Array, points: Array) -> Array:
    """Factors (N,) of length."""
    c, d = m[1]
    return determinant(m) / ((times(c, pure(points)) + d) ** 2).sum(axis=-1)


def expand(record: Record) -> list[tuple[int, Array]]:
    """All instances: index of the kernel, map from its space to the world."""
    instances = [(0, IDENTITY)]
    for i, g in enumerate(record["G"]):
        both = [(i + 1, IDENTITY), *instances, *((k, product(MIRROR, m)) for k, m in instances)]
        instances = [(k, product(vector(g), m)) for k, m in both]
    return instances


def spheres(record: Record) -> tuple[Array, Array, Array]:
    """Centers (M,3), radii (M,) and signs (M,) of the images of kernels that are all spheres."""
    found = [
        sphere_image(m, vector(record["kernels"][k]["c"]), record["kernels"][k]["r"])
        for k, m in expand(record)
        if record["kernels"][k]["type"] != "empty"
    ]
    return tuple(np.array(column) for column in zip(*found, strict=True))  # type: ignore[return-value]


def brute(record: Record, points: Array) -> Array:
    """Signed distances (N,) to the nearest of the image spheres."""
    centers, radii, signs = spheres(record)
    return (signs * (length(points[:, None] - centers) - radii)).min(axis=1)


def centered_bound(record: Record, point: Array) -> float:
    """Of every kernel the free ball about the point as the kernel sees it, inside the one that it fills,
    carried out to the world by images of balls, each made smaller until it is a ball about the image of its
    center again; the least of them, negative inside."""
    maps = [vector(g) for g in record["G"]]
    seen: dict[int, Array] = {}  # before the mirror of each level
    x = vector(point)
    for i in reversed(range(len(maps))):
        seen[i] = apply(inverse(maps[i]), x)
        x = seen[i] * [-np.sign(seen[i][0]), 1, 1]
    bounds = []
    for k, kernel in enumerate(record["kernels"]):
        distance = float(kernel_distance(kernel, (seen[k - 1] if k else x)[None])[0])
        radius = abs(distance)
        for i in range(max(k - 1, 0), len(maps)):
            center, size, sign = sphere_image(maps[i], seen[i], radius)
            radius = sign * (size - float(length(center - apply(maps[i], seen[i]))))
        bounds.append(np.copysign(radius, distance))
    return min(bounds)


def blind_spots(record: Record) -> Array:
    """Where in the world (M,3) the outermost level, or one inside it, sees a point go to infinity, although
    nothing is there."""
    maps, found = [vector(g) for g in record["G"]], []
    for i, g in enumerate(maps):
        x = pole(inverse(g))
        for outer in maps[i + 1 :]:
            # Folded points only come to the negative side.
            x = None if x is None or x[0] > 0 else apply(outer, x)
        if x is not None:
            found.append(x)
    return vector(found).reshape(-1, 3)


def first_hits(record: Record, origins: Array, along: Array) -> Array:
    """Where rays (N,3) with unit directions meet the first image sphere (N,); infinity where none."""
    best = np.full(len(origins), np.inf)
    for c, r, _ in zip(*spheres(record), strict=True):
        middle, away = ((c - origins) * along).sum(axis=1), length(np.cross(c - origins, along))
        half = np.sqrt(np.maximum((r - away) * (r + away), 0))
        for t in (middle - half, middle + half):
            best = np.where((away <= r) & (t > 0), np.minimum(best, t), best)
    return best


def samples(record: Record, count: int, seed: int) -> Array:
    """Points of the images of all kernels' surfaces, `count` of each instance: the distance to the nearest
    of them is never below the true one."""
    rng = np.random.default_rng([seed, 1])
    return np.concatenate([apply(m, surface(record["kernels"][k], count, rng)) for k, m in expand(record)])


def chain(
    levels: int,
    seed: int,
    make: Callable[[np.random.Generator, Array], Kernel],
    strength: float = 0.5,
    crossing: float = 0.0,
) -> Record:
    """A random model: every level distorted (`strength` over its size), turned, brought to the size 1 and
    moved to x <= 0, or by `crossing` beyond that."""
    rng = np.random.default_rng(seed)
    record: Record = {"G": [], "kernels": [make(rng, np.array([-1.0, 0, 0]))]}
    for i in range(levels):
        record["kernels"].append(make(rng, rng.normal(size=3) * 0.5))
        record["G"].append(IDENTITY)
        cloud = samples(record, 400, seed)
        size = length(cloud).max()
        v = rng.normal(size=3)
        turn = rng.normal(size=4)
        g = product(rotation(turn), distortion(strength / size * v / length(v)))
        cloud = apply(g, cloud)
        scale = 1.5 / np.ptp(cloud, axis=0).max()
        low, high = scale * cloud.min(axis=0), scale * cloud.max(axis=0)
        shift = -(low + high) / 2
        shift[0] = crossing - high[0] - 0.05
        record["G"][i] = product(translation(shift), dilation(scale), g).tolist()
    return record


def undistorted(record: Record) -> Record:
    """A sequence of spheres in e3 as one of Moebius maps: G_i leads from the frame of mirror i, where it is
    x = 0, to that of the next mirror, and the last to the world."""
    frames = []
    for mirror in record["mirrors"]:
        u = vector(mirror["u"])
        turn = quaternion(1 + u[0], np.cross(u, [1.0, 0, 0]))  # from u to x
        frames.append(product(translation(np.array([-mirror["w"], 0, 0])), rotation(turn / length(turn))))
    frames.append(IDENTITY)
    kernels = []
    for i, kernel in enumerate(record["kernels"]):
        c = apply(frames[max(i - 1, 0)], vector(kernel["c"]))
        kernels.append(kernel | {"c": c.tolist()})
    maps = [product(frames[i + 1], inverse(frames[i])).tolist() for i in range(len(frames) - 1)]
    return {"G": maps, "kernels": kernels}
