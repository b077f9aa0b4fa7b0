"""The kernels of a sequence in Euclidean space: what a record says of one, the numbers that `kernels/krs/`
reads, a ball that holds it, and how far it reaches in a direction.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thurston_cl.krs.vectors import length_of, two_across, unit

Array = NDArray[np.float64]

# By the name in a record: the file under kernels/krs, and the number by which it is known there.
KINDS = {
    "empty": ("", 0),
    "sphere": ("sphere", 1),
    "plane": ("plane", 2),
    "capsule": ("capsule", 3),
    "torcap": ("toroidal_capsule", 4),
    "lens": ("lens_leaf", 5),
}
# Products of unit normals are this near to 1 for planes that face the same way.
SAME_PLANE = 1e-12
# Numbers of a kernel: kind, part, and what it has of its own.
KERNEL_SIZE = 20


@dataclass(frozen=True)
class Kernel:
    """One kernel. `part` is the number of its material, 0 for that of the object. `ball`: center and radius
    of a ball that holds it, None for one that has no bound or is empty. `reach(u)`: the supremum of u . x
    over it.
    """

    kind: str
    part: int
    own: tuple[float, ...]
    ball: tuple[Array, float] | None
    reach: Callable[[Array], float]
    words: str = ""

    @property
    def numbers(self) -> list[float]:
        """What kernels.h reads."""
        head = [KINDS[self.kind][1], self.part, *self.own]
        return head + [0.0] * (KERNEL_SIZE - len(head))

    @property
    def radius(self) -> float:
        """Of what is a point, a segment or an arc and all that is so near to it; else 0."""
        return self.own[-1] if self.kind in ("sphere", "capsule", "torcap") else 0.0

    def is_kept_by(self, mirror_normal: Array) -> bool:
        """Whether it is a half-space that stands across a mirror: its own image."""
        return self.kind == "plane" and abs(float(mirror_normal @ self.own[: len(mirror_normal)])) < _ACROSS

    @property
    def is_empty(self) -> bool:
        return self.kind == "empty"


# How far from a right angle a half-space may be to a mirror, and be its own image: rounding.
_ACROSS = 1e-9
EMPTY = Kernel("empty", 0, (), None, lambda u: -np.inf, "empty")


def kernel_of(record: Mapping[str, Any], what: str) -> Kernel:
    """The kernel that a record describes; `what` names it in the message of a ValueError."""
    kind = record.get("type", "sphere")
    if not isinstance(kind, str) or kind not in KINDS:
        raise ValueError(f"{what} has type {kind!r}; expected one of: {', '.join(KINDS)}")
    if kind == "empty":
        return EMPTY
    try:
        return _MAKERS[kind](_Entries(record, what), part_of(record, what))
    except KeyError as error:
        raise ValueError(f"{what}, a {kind}, has no {error.args[0]!r}") from None


def part_of(record: Mapping[str, Any], what: str) -> int:
    """The number of the material of the kernel that a record describes."""
    part = record.get("mat", 0)
    if isinstance(part, bool) or not isinstance(part, (int, np.integer)) or part < 0:
        raise ValueError(f"{what} has mat {part!r}; expected a whole number from 0")
    return int(part)


class _Entries:
    """The entries of a record, checked as they are read."""

    def __init__(self, record: Mapping[str, Any], what: str) -> None:
        self._record, self.what = record, what

    def vector(self, key: str) -> Array:
        return vector(self._record[key], 3, f"{key} of {self.what}")

    def direction(self, key: str) -> tuple[Array, float]:
        return direction(self._record[key], f"{key} of {self.what}")

    def number(self, key: str) -> float:
        return number(self._record[key], f"{key} of {self.what}")

    def positive(self, key: str) -> float:
        value = self.number(key)
        if value <= 0:
            raise ValueError(f"{key} of {self.what} is {value:g}; expected a number greater than 0")
        return value


def vector(value: Any, length: int, what: str) -> Array:
    """`value` as finite numbers (length,); ValueError that names `what`."""
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != (length,) or not np.isfinite(array).all():
        raise ValueError(f"{what} is {value!r}; expected {length} finite numbers")
    return array


def number(value: Any, what: str) -> float:
    """`value` as a finite number; ValueError that names `what`."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.number)) or not np.isfinite(value):
        raise ValueError(f"{what} is {value!r}; expected a finite number")
    return float(value)


def direction(value: Any, what: str) -> tuple[Array, float]:
    """`value` as a vector (3,) of length 1, and its own length; ValueError that names `what`."""
    array = vector(value, 3, what)
    if not array.any():
        raise ValueError(f"{what} is the zero vector; expected a direction")
    return unit(array), float(length_of(array))


def _sphere(entries: _Entries, part: int) -> Kernel:
    c, r = entries.vector("c"), entries.positive("r")
    return Kernel("sphere", part, (*c, 1.0, r), (c, r), lambda u: float(u @ c) + r, f"ball of radius {r:.3g}")


def _plane(entries: _Entries, part: int) -> Kernel:
    n, size = entries.direction("n")
    h = entries.number("h") / size
    first, second = two_across(n)

    def reach(u: Array) -> float:
        # Bounded only towards its own normal.
        return h if u @ n > 1 - SAME_PLANE else np.inf

    own = (*n, 0.0, -h, 0.0, *first, 0.0, *second, 0.0)
    return Kernel("plane", part, own, None, reach, "half-space")


def _capsule(entries: _Entries, part: int) -> Kernel:
    a, b, r = entries.vector("a"), entries.vector("b"), entries.positive("r")
    middle, half = 0.5 * (a + b), 0.5 * float(np.linalg.norm(b - a))
    axis = (b - a) / (2 * half) if half > 0 else np.array([0.0, 0.0, 1.0])
    own = (*middle, 1.0, *axis, half, r)
    return Kernel(
        "capsule",
        part,
        own,
        (middle, half + r),
        lambda u: float(max(u @ a, u @ b)) + r,
        f"capsule over {2 * half:.3g}, radius {r:.3g}",
    )


def _toroidal_capsule(entries: _Entries, part: int) -> Kernel:
    """The arc from p to q through m, in curvature form (docs/krs.md, "Kernels")."""
    p, q, m, r = entries.vector("p"), entries.vector("q"), entries.vector("m"), entries.positive("r")
    length = float(np.linalg.norm(q - p))
    if length == 0:
        raise ValueError(f"{entries.what}, a torcap, begins where it ends; make it a sphere")
    along = (q - p) / length
    h = m - 0.5 * (p + q)
    a = float(h @ along)
    sideways = h - a * along
    b = float(np.linalg.norm(sideways))
    if b <= _STRAIGHT * length:
        out, b = two_across(along)[0], 0.0
        if abs(a) > 0.5 * length * (1 + _STRAIGHT):
            raise ValueError(f"m of {entries.what} is on the line through p and q, and not between them")
    else:
        out = sideways / b
    power = a * a + b * b - 0.25 * length * length
    root = float(np.hypot(power, b * length))
    if b == 0:
        sagitta = 0.0
    elif power >= 0:
        sagitta = (power + root) / (2 * b)
    else:
        sagitta = b * length * length / (2 * (root - power))
    curvature = 2 * sagitta / (0.25 * length * length + sagitta * sagitta)
    sine, cosine = 0.5 * curvature * length, 1 - curvature * sagitta
    middle = 0.5 * (p + q) + sagitta * out
    own = (
        *middle,
        *out,
        *along,
        *np.cross(out, along),
        curvature,
        sine,
        cosine,
        0.5 * length,
        -sagitta,
        r,
    )

    def reach(u: Array) -> float:
        ends = max(u @ p, u @ q)
        # Whether the arc passes the point of its circle that is farthest along u.
        right, up = float(u @ along), float(u @ out)
        size = np.hypot(right, up)
        if size == 0 or curvature == 0 or up < cosine * size:
            return float(ends) + r
        centre = middle - out / curvature
        return float(u @ centre + size / curvature) + r

    # Within half the chord, or of an arc over half a circle within its circle's radius, of its centre there.
    ball = (0.5 * (p + q), 0.5 * length + r) if cosine >= 0 else (middle - out / curvature, 1 / curvature + r)
    return Kernel("torcap", part, own, ball, reach, f"arc over {length:.3g}, radius {r:.3g}")


# How far m may be off the chord, as a part of its length, for the arc to be straight: rounding.
_STRAIGHT = 1e-12


def _lens(entries: _Entries, part: int) -> Kernel:
    c, (axis, _) = entries.vector("c"), entries.direction("a")
    rim, half = entries.positive("b"), entries.positive("h")
    if half > rim:
        raise ValueError(
            f"h of {entries.what}, half the thickness, is {half:g}, more than the rim radius b, {rim:g}"
        )
    curvature = 2 * half / (rim * rim + half * half)
    first, second = two_across(axis)
    own = (*c, *axis, *first, *second, rim, half, curvature)

    def reach(u: Array) -> float:
        steep = abs(float(u @ axis))
        flat = float(np.sqrt(max(1 - steep * steep, 0.0)))
        if flat <= rim * curvature:
            return float(u @ c) + 1 / curvature - (1 / curvature - half) * steep
        return float(u @ c) + rim * flat

    words = f"leaf of radius {rim:.3g}, {2 * half:.3g} thick"
    return Kernel("lens", part, own, (c, rim), reach, words)


_MAKERS: dict[str, Callable[[_Entries, int], Kernel]] = {
    "sphere": _sphere,
    "plane": _plane,
    "capsule": _capsule,
    "torcap": _toroidal_capsule,
    "lens": _lens,
}
