"""Truth for kernel-reflection sequences in NumPy, in double: every instance written out, the nearest taken.

Records are those of `thurston_cl.krs.Model.from_dict`: in Euclidean space and, with a "space", in the
three-sphere and in hyperbolic space, where the first coordinate is the one of the origin. Instances follow
the definition L_0 = K_0, L_{i+1} = K_{i+1} u L_i u R_i L_i, with isometries as 4x4 matrices (kernel to
world) that are multiplied; nothing here folds a point, except `folded`, which says what a crossing model
draws, and `normal`.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from golden import MP, Array, exact

Record = dict[str, Any]
Kernel = dict[str, Any]
Instance = tuple[int, Array]


def length(v: Array) -> Array:
    return np.sqrt((v**2).sum(axis=-1))


def vector(values: Any) -> Array:
    return np.asarray(values, dtype=np.float64)


# Kernels of Euclidean space.


class Arc(NamedTuple):
    """The arc from p by m to q: center and radius of its circle, its axes in the plane (the first towards p),
    the normal of the plane, the angle of q."""

    center: Array
    radius: float
    e: Array
    f: Array
    normal: Array
    end: float

    def at(self, angle: Any) -> Array:
        angle = np.asarray(angle)[..., None]
        return self.center + self.radius * (np.cos(angle) * self.e + np.sin(angle) * self.f)


def arc(kernel: Kernel) -> Arc | None:
    """None where m lies on the chord."""
    p, q, m = (vector(kernel[key]) for key in "pqm")
    a, b = p - m, q - m
    n = np.cross(a, b)
    if length(n) <= 1e-14 * length(a) * length(b):
        return None
    center = m + np.cross((a @ a) * b - (b @ b) * a, n) / (2 * n @ n)
    radius = float(length(p - center))
    e, normal = (p - center) / radius, n / length(n)
    f = np.cross(normal, e)

    def angle(x: Array) -> float:
        return float(np.arctan2((x - center) @ f, (x - center) @ e) % (2 * np.pi))

    if angle(m) > angle(q):
        f, normal = -f, -normal
    return Arc(center, radius, e, f, normal, angle(q))


def _segment(a: Array, b: Array, x: Array) -> Array:
    square = (b - a) @ (b - a)
    along = np.clip((x - a) @ (b - a) / square, 0, 1) if square > 0 else np.zeros(len(x))
    return length(x - a - along[:, None] * (b - a))


def _sphere(k: Kernel, x: Array) -> Array:
    return length(x - vector(k["c"])) - k["r"]


def _plane(k: Kernel, x: Array) -> Array:
    return x @ vector(k["n"]) - k["h"]


def _capsule(k: Kernel, x: Array) -> Array:
    return _segment(vector(k["a"]), vector(k["b"]), x) - k["r"]


def _torcap(k: Kernel, x: Array) -> Array:
    p, q, on = vector(k["p"]), vector(k["q"]), arc(k)
    if on is None:
        return _segment(p, q, x) - k["r"]
    y, z = x - on.center, (x - on.center) @ on.normal
    flat = np.hypot(y @ on.e, y @ on.f)
    angle = np.arctan2(y @ on.f, y @ on.e) % (2 * np.pi)
    ends = np.minimum(length(x - p), length(x - q))
    return np.where(angle <= on.end, np.hypot(flat - on.radius, z), ends) - k["r"]


def _lens(k: Kernel, x: Array) -> Array:
    """The intersection of two balls: inside, the nearer of two spheres; outside, the foot on a sphere where
    that is a point of the lens, else the rim."""
    c, a, b, h = vector(k["c"]), vector(k["a"]), k["b"], k["h"]
    a = a / length(a)
    radius = (b * b + h * h) / (2 * h)
    height = np.abs((x - c) @ a)  # the lens is the same on both sides
    across = length(x - c - ((x - c) @ a)[:, None] * a)
    offset = radius - h
    upper = np.hypot(height + offset, across) - radius  # of the ball that bounds the lens on this side
    lower = np.hypot(height - offset, across) - radius
    # The foot on the sphere of this side is a point of the lens unless it is beyond the rim.
    over_face = across * radius <= b * (upper + radius)
    outside = np.where(over_face, upper, np.hypot(height, across - b))
    return np.where((upper <= 0) & (lower <= 0), np.maximum(upper, lower), outside)


def _empty(k: Kernel, x: Array) -> Array:
    return np.full(len(x), np.inf)


DISTANCES: dict[str, Callable[[Kernel, Array], Array]] = {
    "sphere": _sphere,
    "plane": _plane,
    "capsule": _capsule,
    "torcap": _torcap,
    "lens": _lens,
    "empty": _empty,
}


def kernel_distance(kernel: Kernel, points: Array) -> Array:
    """Signed distances (N,) of points (N,3)."""
    return DISTANCES[kernel["type"]](kernel, points)


def exact_arc_distances(kernel: Kernel, points: Array) -> Array:
    """Those of a toroidal capsule, by its circle with 50 digits, of which flat arcs need some."""
    p, q, m = (exact(kernel[key]) for key in "pqm")
    a, b = p - m, q - m
    n = np.cross(a, b)
    center = m + np.cross((a @ a) * b - (b @ b) * a, n) / (2 * n @ n)
    radius = MP.sqrt((p - center) @ (p - center))
    e, normal = (p - center) / radius, n / MP.sqrt(n @ n)
    f = np.cross(normal, e)

    def angle(x: Any) -> Any:
        return MP.atan2((x - center) @ f, (x - center) @ e) % (2 * MP.pi)

    if angle(m) > angle(q):
        f = -f
    end, found = angle(q), []
    for x in exact(points):
        y = x - center
        if angle(x) <= end:
            distance = MP.hypot(MP.hypot(y @ e, y @ f) - radius, y @ normal)
        else:
            distance = MP.sqrt(min((x - p) @ (x - p), (x - q) @ (x - q)))
        found.append(float(distance - MP.mpf(kernel["r"])))
    return vector(found)


def kernel_gradient(kernel: Kernel, points: Array, step: float = 1e-5) -> Array:
    """Gradients (N,3) by central differences, of fourth order."""
    columns = []
    for e in np.eye(3):
        near, far = (
            kernel_distance(kernel, points + h * e) - kernel_distance(kernel, points - h * e)
            for h in (step, 2 * step)
        )
        columns.append((8 * near - far) / (12 * step))
    return np.stack(columns, axis=1)


def support(kernel: Kernel, u: Array) -> float:
    """No point of the kernel is further along the unit vector `u` than this."""
    kind = kernel["type"]
    if kind == "sphere":
        return u @ vector(kernel["c"]) + kernel["r"]
    if kind == "capsule":
        return max(u @ vector(kernel["a"]), u @ vector(kernel["b"])) + kernel["r"]
    if kind == "lens":
        return u @ vector(kernel["c"]) + max(kernel["b"], kernel["h"])
    if kind == "torcap":
        ends = max(u @ vector(kernel["p"]), u @ vector(kernel["q"])) + kernel["r"]
        on = arc(kernel)
        if on is not None and np.arctan2(u @ on.f, u @ on.e) % (2 * np.pi) <= on.end:
            return u @ on.center + on.radius * np.hypot(u @ on.e, u @ on.f) + kernel["r"]
        return ends
    return -np.inf if kind == "empty" else np.inf


def surface(kernel: Kernel, count: int, rng: np.random.Generator) -> Array:
    """Points (count,3) of the boundary of a kernel that is bounded."""
    v = rng.normal(size=(count, 3))
    v /= length(v)[:, None]
    kind = kernel["type"]
    if kind == "sphere":
        return vector(kernel["c"]) + kernel["r"] * v
    if kind == "lens":
        c, b, h = vector(kernel["c"]), kernel["b"], kernel["h"]
        a = vector(kernel["a"]) / length(vector(kernel["a"]))
        radius = (b * b + h * h) / (2 * h)
        side = np.where(v @ a < 0, -1.0, 1.0)
        flat = v - (v @ a)[:, None] * a
        flat /= length(flat)[:, None]
        # Heights above the middle of the ball, from the rim to the pole.
        height = radius - h * rng.random(count)
        across = np.sqrt(np.maximum(radius**2 - height**2, 0))
        return c + (side * (height - radius + h))[:, None] * a + across[:, None] * flat
    t, r = rng.random(count), kernel["r"]
    on = arc(kernel) if kind == "torcap" else None
    if on is not None:
        axis, tangent = on.at(t * on.end), on.at(t * on.end + np.pi / 2) - on.center
        ends, out = on.at([0, on.end]), on.at([-np.pi / 2, on.end + np.pi / 2]) - on.center
    else:
        p, q = (vector(kernel[key]) for key in ("pq" if kind == "torcap" else "ab"))
        axis, tangent = p + t[:, None] * (q - p), np.broadcast_to(q - p, (count, 3))
        ends, out = np.stack([p, q]), np.stack([p - q, q - p])
    tangent = tangent / length(tangent)[:, None]
    out = out / length(out)[:, None]
    across = v - (v * tangent).sum(axis=1)[:, None] * tangent
    across /= length(across)[:, None]
    end = rng.integers(2, size=count)
    outward = v * np.sign((v * out[end]).sum(axis=1))[:, None]
    on_cap = rng.random(count) < 0.2
    return np.where(on_cap[:, None], ends[end] + r * outward, axis + r * across)


# Isometries, and all instances.


def signature(record: Record) -> Array:
    return np.diag([-1.0 if record.get("space") == "H3" else 1.0, 1, 1, 1])


def reflection(record: Record, i: int) -> Array:
    """The mirror i as a 4x4 matrix on (x, y, z, 1), or on the vectors of a curved space."""
    mirror = record["mirrors"][i]
    if "space" in record:
        n = vector(mirror)
        return np.eye(4) - 2 * np.outer(n, signature(record) @ n)
    u, matrix = vector(mirror["u"]), np.eye(4)
    matrix[:3, :3] -= 2 * np.outer(u, u)
    matrix[:3, 3] = 2 * mirror["w"] * u
    return matrix


def side(record: Record, i: int, points: Array) -> Array:
    """Heights (N,) over mirror i, of curved spaces their sines."""
    mirror = record["mirrors"][i]
    if "space" in record:
        return points @ signature(record) @ vector(mirror)
    return points @ vector(mirror["u"]) - mirror["w"]


def expand(record: Record, levels: int | None = None) -> list[Instance]:
    """All 2^(levels+1)-1 instances of the first levels: index of the kernel, isometry to the world."""
    instances: list[Instance] = [(0, np.eye(4))]
    for i in range(len(record["mirrors"]) if levels is None else levels):
        mirror = reflection(record, i)
        instances = [(i + 1, np.eye(4)), *instances, *((k, mirror @ m) for k, m in instances)]
    return instances


def curved_distance(space: str, center: Array, points: Array) -> Array:
    d = points - center
    if space == "S3":
        return 2 * np.arctan2(length(d), length(points + center))
    # In extended precision: the square of a chord cancels far out.
    d = np.asarray(points, np.longdouble) - np.asarray(center, np.longdouble)
    square = (d[:, 1:] ** 2).sum(axis=1) - d[:, 0] ** 2
    return np.float64(2 * np.arcsinh(np.sqrt(np.maximum(square, 0)) / 2))


def geodesic(space: str, start: Array, tangent: Array, time: Array) -> Array:
    """Points (...,4) after times (...) from one (4,) along a unit tangent (4,)."""
    cosine, sine = (np.cos, np.sin) if space == "S3" else (np.cosh, np.sinh)
    return cosine(time)[..., None] * start + sine(time)[..., None] * tangent


def curved_capsule(space: str, kernel: Kernel, points: Array) -> Array:
    """Distances (N,) from the geodesic segment a b of S3 or H3, less r: the least over it, searched for."""
    a, b = vector(kernel["a"]), vector(kernel["b"])
    size = float(curved_distance(space, a, b[None])[0])
    cosine, sine = (np.cos, np.sin) if space == "S3" else (np.cosh, np.sinh)
    tangent = (b - cosine(size) * a) / sine(size)

    def away(time: Array) -> Array:
        return np.array(
            [
                curved_distance(space, c, x[None])[0]
                for c, x in zip(geodesic(space, a, tangent, time), points, strict=True)
            ]
        )

    grid = np.linspace(0, size, 41)
    coarse = np.array([away(np.full(len(points), t)) for t in grid])
    middle = grid[coarse.argmin(axis=0)]
    low, high = np.maximum(middle - grid[1], 0), np.minimum(middle + grid[1], size)
    for _ in range(40):
        first, second = (2 * low + high) / 3, (low + 2 * high) / 3
        nearer = away(first) < away(second)
        low, high = np.where(nearer, low, first), np.where(nearer, second, high)
    return np.minimum(away((low + high) / 2), coarse.min(axis=0)) - kernel["r"]


def product_distance(space: str, center: Array, points: Array) -> Array:
    """Distances (N,) in S2xE or H2xE, whose points are [x, y, z, w] as those of `Geometry`."""
    d = points - center
    if space == "S2xE":
        across = 2 * np.arctan2(length(d[:, :3]), length((points + center)[:, :3]))
    else:
        square = d[:, 0] ** 2 + d[:, 1] ** 2 - d[:, 2] ** 2
        across = 2 * np.arcsinh(np.sqrt(np.maximum(square, 0)) / 2)
    return np.hypot(across, d[:, 3])


def product_mirror(space: str, mirror: Any, points: Array) -> tuple[Array, Array]:
    """Heights (N,) over a mirror of a product, those of an upright one as sines, and mirror images (N,4)."""
    if isinstance(mirror, dict):
        over = points[:, 3] - mirror["height"]
        return over, points - 2 * over[:, None] * np.array([0.0, 0, 0, 1])
    normal = vector(mirror)
    over = points @ (normal * np.array([1, 1, 1 if space == "S2xE" else -1, 0]))
    return over, points - 2 * over[:, None] * normal


def product_balls(record: Record) -> list[tuple[Array, float]]:
    """Centers and radii of all instances of a sequence of balls in a product."""
    balls: list[tuple[Array, float]] = []
    for i, kernel in enumerate(record["kernels"]):
        if i:
            mirror = record["mirrors"][i - 1]
            images = [product_mirror(record["space"], mirror, c[None])[1][0] for c, _ in balls]
            balls += [(c, r) for c, (_, r) in zip(images, balls, strict=True)]
        balls.append((vector(kernel["c"]), kernel["r"]))
    return balls


def instance_distance(record: Record, kernel: int, isometry: Array, points: Array) -> Array:
    k = record["kernels"][kernel]
    if k.get("type") == "empty":
        return np.full(len(points), np.inf)
    if "space" in record:
        return curved_distance(record["space"], isometry @ vector(k["c"]), points) - k["r"]
    return kernel_distance(k, (points - isometry[:3, 3]) @ isometry[:3, :3])


def brute(record: Record, points: Array, instances: list[Instance] | None = None) -> Array:
    """Distances (N,) to the nearest of all instances, clipped by no mirror."""
    best = np.full(len(points), np.inf)
    for kernel, isometry in expand(record) if instances is None else instances:
        np.minimum(best, instance_distance(record, kernel, isometry, points), out=best)
    return best


def folded(record: Record, points: Array, level: int | None = None) -> Array:
    """Values (N,) of the sequence of what each mirror leaves: the level below, on the mirror's negative side,
    or its image."""
    level = len(record["mirrors"]) if level is None else level
    own = instance_distance(record, level, np.eye(4), points)
    if level == 0:
        return own
    image = points @ reflection(record, level - 1)[: points.shape[1], : points.shape[1]].T
    if points.shape[1] == 3:
        image = image + reflection(record, level - 1)[:3, 3]
    behind = side(record, level - 1, points) > 0
    return np.minimum(own, folded(record, np.where(behind[:, None], image, points), level - 1))


def drawn(record: Record, points: Array, level: int | None = None) -> Array:
    """Whether points (N,3) lie in the set with all that crosses a mirror clipped away, by its definition."""
    level = len(record["mirrors"]) if level is None else level
    inside = kernel_distance(record["kernels"][level], points) <= 0
    if level:
        mirror = reflection(record, level - 1)
        for there in (points, points @ mirror[:3, :3].T + mirror[:3, 3]):
            front = side(record, level - 1, there) <= 0
            inside |= front & drawn(record, there, level - 1)
    return inside


def smoothstep(t: Array) -> Array:
    t = np.clip(t, 0, 1)
    return t * t * (3 - 2 * t)


def normal(record: Record, point: Array) -> Array:
    """The unit normal (3,) at a point (3,), folds faded over the record's widths: the gradient of the kernel
    that is nearest after the folds, times I - 2 h u u^T of each fold before it."""
    best, found = np.inf, np.zeros(3)
    x, back = point[None], np.eye(3)
    for level in range(len(record["mirrors"]), -1, -1):
        kernel = record["kernels"][level]
        distance = kernel_distance(kernel, x)[0]
        if distance < best:
            best, found = distance, back @ kernel_gradient(kernel, x)[0]
        if level:
            u, s = vector(record["mirrors"][level - 1]["u"]), side(record, level - 1, x)[0]
            width = record.get("smooth", [0] * level)[level - 1]
            h = smoothstep((s + width) / (2 * width)) if width > 0 else float(s > 0)
            back = back @ (np.eye(3) - 2 * h * np.outer(u, u))
            x = x - 2 * max(s, 0) * u
    return found / length(found)
