"""Sequences in curved spaces: how records write points, mirrors and kernels of S3, H3, S2xE and H2xE, and
what the kernels of `kernels/krs/` read of them (docs/krs.md, "Curved spaces").

Records of S3 and H3 write the time-like coordinate first: <x, x> = -x0^2 + x1^2 + x2^2 + x3^2.
Those of the products write points as `thurston_cl.Geometry` does, [x, y, z, w]; a mirror of theirs is
vertical, [x, y, z, 0], a unit normal to a great circle or line of the factor, or horizontal, {"height": w}.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thurston_cl.krs.kernels import EMPTY, SAME_PLANE, Kernel, number, part_of, vector
from thurston_cl.krs.sequence import Mirror
from thurston_cl.models import MODEL, PRODUCTS, off_model

Array = NDArray[np.float64]

# How far a point or normal that is given may be off its model.
OFF_MODEL = 1e-6


@dataclass(frozen=True)
class Space:
    """A curved space of records. `order`: the places of our coordinates [x, y, z, w] in those of a record."""

    geometry: str
    order: tuple[int, int, int, int]

    @property
    def signs(self) -> Array:
        """The metric of the ambient space on [x, y, z, w]."""
        return np.array({"h3": [1.0, 1, 1, -1], "h2xe": [1.0, 1, -1, 1]}.get(self.geometry, [1.0, 1, 1, 1]))

    def point(self, value: Any, what: str) -> Array:
        """A point (4,) in our coordinates."""
        point = vector(value, 4, what)[list(self.order)]
        if abs(off_model(self.geometry, *point)) > OFF_MODEL:
            raise ValueError(f"{what} is no point of {self.geometry}; expected {MODEL[self.geometry]}")
        return point

    def mirror(self, value: Any, what: str, width: float = 0.0) -> Mirror:
        """The mirror of a record."""
        if isinstance(value, Mapping) and self.geometry in PRODUCTS:
            if "height" not in value:
                raise ValueError(f"{what} has no 'height'")
            return level_mirror(number(value["height"], f"height of {what}"), 1.0, width)
        normal = vector(value, 4, what)[list(self.order)]
        if self.geometry in PRODUCTS and normal[3] != 0:
            raise ValueError(f"{what} is neither vertical nor horizontal; expected [x, y, z, 0] or height")
        square = float(normal @ (self.signs * normal))
        if not square > 0 or abs(square - 1) > OFF_MODEL:
            raise ValueError(f"{what} has <n, n> = {square:.6g}; expected a unit normal, 1")
        return normal_mirror(self.geometry, normal / np.sqrt(square), width)

    def kernel(self, record: Mapping[str, Any], what: str) -> Kernel:
        """The kernel of a record: a sphere {c, r}; a plane {type: plane, n}, in products also {type: plane,
        height}; a capsule {type: capsule, a, b, r}, in products a vertical one.
        """
        kind, part = record.get("type", "sphere"), part_of(record, what)
        if kind == "empty":
            return EMPTY
        try:
            match kind:
                case "sphere":
                    radius = _positive(record["r"], what)
                    return sphere(self.geometry, self.point(record["c"], f"c of {what}"), radius, part)
                case "plane":
                    level = self.geometry in PRODUCTS and "n" not in record
                    if level and "height" not in record:
                        raise ValueError(f"{what}, a plane, has neither 'n' nor 'height'")
                    mirror = self.mirror(record, what) if level else self.mirror(record["n"], f"n of {what}")
                    return plane(self.geometry, mirror, part)
                case "capsule":
                    ends = [self.point(record[key], f"{key} of {what}") for key in ("a", "b")]
                    radius = _positive(record["r"], what)
                    try:
                        return capsule(self.geometry, ends[0], ends[1], radius, part)
                    except ValueError as error:
                        raise ValueError(f"{what}: {error}") from None
        except KeyError as error:
            raise ValueError(f"{what}, a {kind}, has no {error.args[0]!r}") from None
        raise ValueError(f"{what} has type {kind!r}; expected one of: empty, sphere, plane, capsule")


_SPACES = {
    "S3": Space("s3", (1, 2, 3, 0)),
    "H3": Space("h3", (1, 2, 3, 0)),
    "S2xE": Space("s2xe", (0, 1, 2, 3)),
    "H2xE": Space("h2xe", (0, 1, 2, 3)),
}


def space_named(name: Any) -> Space:
    """The space that a record names."""
    if not isinstance(name, str) or name not in _SPACES:
        raise ValueError(f"space is {name!r}; expected one of: {', '.join(_SPACES)}")
    return _SPACES[name]


def _positive(value: Any, what: str) -> float:
    radius = number(value, f"r of {what}")
    if radius <= 0:
        raise ValueError(f"r of {what} is {radius:g}; expected a number greater than 0")
    return radius


def signs_of(geometry: str) -> Array:
    """The metric of the ambient space on [x, y, z, w]."""
    return Space(geometry, (0, 1, 2, 3)).signs


def normal_mirror(geometry: str, normal: Array, width: float = 0.0) -> Mirror:
    """The mirror <n, x> = 0 of a unit normal (4,) in ambient coordinates."""
    return Mirror(np.append(signs_of(geometry) * normal, 0.0), normal, width)


def level_mirror(height: float, sense: float = 1.0, width: float = 0.0) -> Mirror:
    """The horizontal mirror w = height of a product; what is above is folded away, below with sense -1."""
    up = np.array([0.0, 0.0, 0.0, sense])
    return Mirror(np.append(up, -sense * height), up, width)


def sphere(geometry: str, center: Array, radius: float, part: int) -> Kernel:
    """The ball about a point (4,)."""

    def reach(form: Array) -> float:
        side = float(form[:4] @ center + form[4])
        if geometry in PRODUCTS and form[3] != 0:
            return side + radius
        return (np.arcsin(np.clip(side, -1, 1)) if geometry in ("s3", "s2xe") else np.arcsinh(side)) + radius

    return Kernel("sphere", part, (*center, radius), (center, radius), reach, f"ball of radius {radius:.3g}")


def plane(geometry: str, mirror: Mirror, part: int) -> Kernel:
    """What lies on the negative side of a plane. Coordinates on it begin next to the origin."""
    level = geometry in PRODUCTS and mirror.form[3] != 0
    own = (*mirror.form, 0.0 if level else 1.0, *_coordinates(geometry, mirror.normal, level).ravel())

    def reach(form: Array) -> float:
        # Bounded only towards planes that face the same way, do not meet its own and do not lie within.
        together = float(form[:4] @ mirror.normal)
        if together < 1 - SAME_PLANE:
            return np.inf
        if level:
            return float(form[4] - mirror.form[4])
        if together < 1 + SAME_PLANE:
            return 0.0
        on_own = -signs_of(geometry) * np.array(own[-4:])
        return -float(np.arccosh(together)) if form[:4] @ on_own < 0 else np.inf

    return Kernel("plane", part, own, None, reach, "half-space")


def _coordinates(geometry: str, normal: Array, level: bool) -> Array:
    """Three forms (3,4): 0 on two lines of the plane across each other, and 1 where they meet."""
    axes = np.eye(4)
    if level:
        # Lengths are measured along the y-line of the factor.
        return axes[[1, 0, 2]]
    origin, others = (axes[2], axes[:2]) if geometry in PRODUCTS else (axes[3], axes[:3])
    signs = signs_of(geometry)

    def next_across(found: list[Array], candidates: Array) -> Array:
        """What is farthest from those that were found, at right angles to them and of length 1."""
        rest = candidates
        for v in found:
            rest = rest - np.outer(rest @ (signs * v), v) * (v @ (signs * v))
        squares = np.abs(np.einsum("ij,j,ij->i", rest, signs, rest))
        best = int(np.argmax(squares))
        return rest[best] / np.sqrt(squares[best])

    # On a sphere all points may be as near to the origin: any will do then.
    pole = signs.min() > 0 and abs(normal @ origin) > 1 - OFF_MODEL
    foot = next_across([normal], others if pole else origin[None, :])
    first = next_across([normal, foot], np.concatenate([others, origin[None, :]]))
    second = axes[3] if geometry in PRODUCTS else next_across([normal, foot, first], axes)
    vectors = np.array([first, second, foot])
    return vectors * signs * np.einsum("ij,j,ij->i", vectors, signs, vectors)[:, None]


def capsule(geometry: str, a: Array, b: Array, radius: float, part: int) -> Kernel:
    """All points within a radius of the geodesic from a to b (4,); in the products of a vertical one."""
    from thurston_cl.geometry import for_few_points

    g = for_few_points(geometry)
    directions, lengths = g.geodesics(b, 1, base=a)
    half = 0.5 * float(lengths[0, 0])
    if not half > 0:
        raise ValueError("a capsule that begins where it ends; make it a ball")
    middle, along = (out[0] for out in g.flow(directions[0, 0], half, base=a))
    words = f"capsule over {2 * half:.3g}, radius {radius:.3g}"
    if geometry in PRODUCTS:
        if abs(abs(directions[0, 0, 2]) - 1) > OFF_MODEL:
            raise ValueError(f"in {geometry} a capsule of a sequence is vertical")
        own: tuple[float, ...] = (*middle, half, radius)
    else:
        sine, cosine = (np.sin(half), np.cos(half)) if geometry == "s3" else (np.sinh(half), np.cosh(half))
        own = (*middle, *along, sine, cosine, *a, *b, radius)
    tangent = g.velocity(middle, along)[0]

    def reach(form: Array) -> float:
        # Along the segment the form is a sine or hyperbolic sine, in the products linear or constant.
        at_middle, rate = float(form[:4] @ middle + form[4]), float(form[:4] @ tangent)
        candidates = [-half, half]
        if geometry == "s3":
            candidates.append(float(np.arctan2(rate, at_middle)))
        elif geometry == "h3" and at_middle < -abs(rate):
            candidates.append(float(np.arctanh(-rate / at_middle)))
        points = [g.flow(along, s, base=middle)[0][0] for s in candidates if abs(s) <= half]
        return max(sphere(geometry, point, radius, part).reach(form) for point in points)

    return Kernel(
        "capsule",
        part,
        own,
        (middle, half + radius),
        reach,
        words,
    )
