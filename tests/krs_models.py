"""Random kernel-reflection sequences for tests, the same for the same seed."""

import numpy as np
from golden import Array
from krs_truth import (
    Kernel,
    Record,
    expand,
    length,
    product_balls,
    product_mirror,
    signature,
    support,
)

BOUNDED = ("sphere", "capsule", "torcap", "lens")


def direction(rng: np.random.Generator) -> Array:
    v = rng.normal(size=3)
    return v / length(v)


def kernel(kind: str, rng: np.random.Generator, center: Array, size: float = 1.0) -> Kernel:
    """One that reaches about `size` around `center`; planes look up, below it."""
    c, d = np.asarray(center, dtype=np.float64), size * direction(rng)
    r = size * rng.uniform(0.05, 0.25)
    if kind == "sphere":
        return {"type": kind, "c": c.tolist(), "r": size * rng.uniform(0.1, 0.6)}
    if kind == "plane":
        n = direction(rng) * 0.1 + [0, 0, 1]
        n /= length(n)
        return {"type": kind, "n": n.tolist(), "h": float(n @ c - size)}
    if kind == "capsule":
        return {"type": kind, "a": (c - d).tolist(), "b": (c + d).tolist(), "r": r}
    if kind == "torcap":
        across = np.cross(d, direction(rng))
        across *= size * rng.uniform(0.05, 1.8) / length(across)
        m = c + across + d * rng.uniform(-0.4, 0.4)
        return {"type": kind, "p": (c - d).tolist(), "q": (c + d).tolist(), "m": m.tolist(), "r": r}
    if kind == "lens":
        b = size * rng.uniform(0.2, 0.8)
        return {
            "type": kind,
            "c": c.tolist(),
            "a": direction(rng).tolist(),
            "b": b,
            "h": b * rng.uniform(0.1, 1),
        }
    return {"type": "empty"}


def reach(record: Record, u: Array) -> float:
    """How far all instances reach along `u`."""
    return max(
        u @ m[:3, 3] + support(record["kernels"][k], m[:3, :3].T @ u)
        for k, m in expand(record, len(record["mirrors"]))
    )


def chain(
    levels: int, seed: int, kinds: tuple[str, ...] = BOUNDED, depth: float = 0.0, top: str | None = None
) -> Record:
    """A model whose mirrors stand beyond what they reflect, or `depth` of its extent (0 to 1) inside it.

    kinds: types of kernels, taken in turn. top: the type of the last kernel, which no mirror reflects.
    """
    rng = np.random.default_rng(seed)
    record: Record = {"mirrors": [], "kernels": [kernel(kinds[seed % len(kinds)], rng, rng.normal(size=3))]}
    for i in range(levels):
        u = direction(rng)
        far, near = reach(record, u), -reach(record, -u)
        w = far - depth * (far - near) * rng.uniform(0.2, 0.8) + (rng.uniform(0.01, 0.3) if not depth else 0)
        middle = u * w + rng.normal(size=3)
        record["mirrors"].append({"u": u.tolist(), "w": float(w)})
        kind = top if top and i == levels - 1 else kinds[(seed + i + 1) % len(kinds)]
        record["kernels"].append(kernel(kind, rng, middle, rng.uniform(0.5, 1.5)))
    return record


def moved(record: Record, offset: Array, scale: float = 1.0) -> Record:
    """The model of spheres made `scale` times as large, then moved by `offset`."""
    return {
        "mirrors": [
            {"u": m["u"], "w": float(scale * m["w"] + np.dot(m["u"], offset))} for m in record["mirrors"]
        ],
        "kernels": [
            k | {"c": (scale * np.array(k["c"]) + offset).tolist(), "r": scale * k["r"]}
            for k in record["kernels"]
        ],
    }


def points_around(record: Record, count: int, seed: int) -> Array:
    """Points (count,3) in and around a model, some far outside; a plane, the last kernel, does not count."""
    rng = np.random.default_rng(seed)
    bounded = {"mirrors": record["mirrors"], "kernels": list(record["kernels"])}
    if bounded["kernels"][-1]["type"] == "plane":
        bounded["kernels"][-1] = {"type": "empty"}
    high = np.array([reach(bounded, e) for e in np.eye(3)])
    low = -np.array([reach(bounded, -e) for e in np.eye(3)])
    middle, half = (low + high) / 2, (high - low) / 2
    stretch = np.where(rng.random((count, 1)) < 0.1, 5.0, 1.1)
    return middle + half * stretch * rng.uniform(-1, 1, (count, 3))


def at(space: str, along: Array, radius: Array) -> Array:
    """Points (N,4) of S3 or H3 at distances (N,) from the origin along unit vectors (N,3)."""
    cosine, sine = (np.cos, np.sin) if space == "S3" else (np.cosh, np.sinh)
    radius = np.asarray(radius)[:, None]
    return np.concatenate([cosine(radius), sine(radius) * along], axis=1)


def curved_chain(space: str, levels: int, seed: int) -> Record:
    """Balls near the origin of S3 or H3; each mirror is the nearest of its direction that nothing crosses."""
    rng = np.random.default_rng(seed)
    sphere = space == "S3"

    def ball() -> Kernel:
        c = at(space, direction(rng)[None], rng.uniform(0.1, 0.5, 1))[0]
        return {"c": c.tolist(), "r": rng.uniform(0.05, 0.2)}

    record: Record = {"space": space, "mirrors": [], "kernels": [ball()]}
    angle = np.arcsin if sphere else np.arcsinh
    while len(record["mirrors"]) < levels:
        m = direction(rng)
        heights = np.linspace(-0.5, 1.5 if sphere else 4, 401)
        cosine, sine = (np.cos, np.sin) if sphere else (np.cosh, np.sinh)
        first = -sine(heights) if sphere else sine(heights)
        normals = np.concatenate([first[:, None], cosine(heights)[:, None] * m], axis=1)
        over = np.full(len(heights), -np.inf)
        for k, isometry in expand(record):
            kernel = record["kernels"][k]
            sides = normals @ signature(record) @ isometry @ kernel["c"]
            over = np.maximum(over, angle(sides) + kernel["r"])
        free = np.flatnonzero(over < -0.01)
        if len(free):  # a sphere may be too full for a mirror of this direction
            record["mirrors"].append(normals[free[0]].tolist())
            record["kernels"].append(ball())
    return record


def product_chain(space: str, levels: int, seed: int) -> Record:
    """Balls in S2xE or H2xE; upright mirrors and level ones take turns, and nothing crosses them."""
    rng = np.random.default_rng(seed)
    cosine, sine = (np.cos, np.sin) if space == "S2xE" else (np.cosh, np.sinh)

    def ball() -> Kernel:
        t, angle = rng.uniform(0.1, 0.4), rng.uniform(0, 2 * np.pi)
        flat = [sine(t) * np.cos(angle), sine(t) * np.sin(angle), cosine(t)]
        return {"c": [*map(float, flat), rng.uniform(-0.5, 0.5)], "r": rng.uniform(0.05, 0.15)}

    record: Record = {"space": space, "mirrors": [], "kernels": [ball()]}
    while len(record["mirrors"]) < levels:
        balls, angle = product_balls(record), rng.uniform(0, 2 * np.pi)
        level = len(record["mirrors"]) % 2 == seed % 2
        tries: list[object] = [{"height": float(max(c[3] + r for c, r in balls) + 0.05)}]
        if not level:
            tries = [
                [
                    cosine(t) * np.cos(angle),
                    cosine(t) * np.sin(angle),
                    -sine(t) if space == "S2xE" else sine(t),
                    0.0,
                ]
                for t in np.linspace(-0.3, 1.4, 200)
            ]
        for mirror in tries:
            over = [float(product_mirror(space, mirror, c[None])[0][0]) for c, _ in balls]
            reach = over if level else (np.arcsin(over) if space == "S2xE" else np.arcsinh(over))
            if all(h + r < 0 for h, (_, r) in zip(reach, balls, strict=True)):
                record["mirrors"].append(mirror)
                record["kernels"].append(ball())
                break
    return record
