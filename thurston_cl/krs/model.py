"""Models: sequences of which one may ask distances, normals and instances, on one OpenCL device."""

import warnings
from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thurston_cl import device as devices
from thurston_cl.arrays import Array, finite
from thurston_cl.device import Device
from thurston_cl.krs import curved
from thurston_cl.krs.program import sequence_program
from thurston_cl.krs.record import clipping_in_words, sequence_of
from thurston_cl.krs.sequence import MoebiusSequence, Sequence
from thurston_cl.models import off_model

# As many instances are worked out one by one.
MOST_EXPANDED = 1 << 20


class Model:
    """A kernel-reflection sequence or a Moebius one (KRS paper 3, 7) on one OpenCL device.

    Points are (N,3) in Euclidean space and (N,4) in a curved one, in the coordinates of the record.
    precision: "single" or "double", the arithmetic inside. device: what `--device` accepts, None for the
    default choice. lanes: width of the kernels, None for the device's default.
    """

    def __init__(
        self,
        sequence: Sequence | MoebiusSequence,
        *,
        order: tuple[int, ...] = (0, 1, 2, 3),
        precision: str = "double",
        device: "str | Device | None" = None,
        lanes: int | None = None,
    ) -> None:
        if isinstance(sequence, Mapping):
            raise TypeError("a record is not a sequence yet; use Model.from_dict(record)")
        self.sequence = sequence
        chosen = devices.choose(device) if device is None or isinstance(device, str) else device
        self._order = list(order)
        self._numbers = np.array(sequence.numbers)
        self.program = sequence_program(
            sequence.geometry, sequence.name, frozenset(sequence.kinds), precision, chosen, lanes
        )
        self.device, self.precision, self.lanes = chosen, precision, self.program.lanes

    @classmethod
    def from_dict(cls, record: Mapping[str, Any], **settings: Any) -> Self:
        """The model of a record (`thurston_cl.krs.record`), its points in the record's coordinates.

        ValueError for records that make no sense, warnings for what will be clipped. Settings: those of
        `Model`.
        """
        sequence = sequence_of(record)
        # Recipes mean what their mirrors clip.
        for told in [] if record.get("clips") else clipping_in_words(sequence):
            warnings.warn(told, stacklevel=2)
        order = curved.space_named(record["space"]).order if "space" in record else (0, 1, 2, 3)
        return cls(sequence, order=order, **settings)

    @property
    def levels(self) -> int:
        """How many mirrors there are."""
        return self.sequence.levels

    @property
    def instances(self) -> int:
        """How many kernels the mirrors make of those that are not empty."""
        return self.sequence.instances

    @property
    def radius(self) -> float:
        """How far the model reaches from the origin at most; inf where it has no bound."""
        return self.sequence.radius

    def distance(self, points: ArrayLike) -> Array:
        """The signed distance (N,) by folding (KRS paper, algorithm 1): of all instances where every level
        lies on the negative side of its mirror, and else a lower bound of the distance to what the mirrors
        leave. Of a Moebius sequence `bound`, and more where balls show that whole levels are far: what rays
        go by.
        """
        return self._run("distance", [self._points(points)], 1, self._numbers)[:, 0]

    def bound(self, points: ArrayLike) -> Array:
        """A lower bound (N,) of the distance: of a Moebius sequence by the largest ball about the point that
        stays centered (docs/krs.md, "Moebius maps"), in one pass; of any other the distance itself.
        """
        return self._run("distance", [self._points(points)], 1, self._without_balls)[:, 0]

    def unbounding(self, centers: ArrayLike, radii: ArrayLike) -> NDArray[np.bool_]:
        """Whether balls (N,3) and (N,) are free of the model (KRS paper, algorithm 3, corrected). Of a
        Moebius sequence it may deny a ball that is free, if a map turns it inside out; rays ask with balls
        that hold levels beside, which tell more.
        """
        points, sizes = self._points(centers), finite("radii", radii).reshape(-1, 1)
        if len(sizes) not in (1, len(points)):
            raise ValueError(f"{len(points)} centers and {len(sizes)} radii; expected as many")
        sizes = np.broadcast_to(sizes, (len(points), 1))
        return self._run("unbounding", [points, sizes], 1, self._without_balls)[:, 0] > 0

    def normal(self, points: ArrayLike) -> Array:
        """Unit normals (N,3) or (N,4), the gradient of the distance to the nearest kernel, led back through
        the mirrors or maps, and smoothed over mirrors within their widths.

        NaN where there is no gradient because all directions are alike: at the center of a ball, on the axis
        of a capsule or of a toroidal one, and in S3 opposite to them.
        """
        normal = self._run("surface", [self._points(points)], 5, self._numbers)[:, :4]
        if self.sequence.geometry == "e3":
            return normal[:, :3]
        back = np.argsort(self._order)
        return normal[:, back]

    def part(self, points: ArrayLike) -> NDArray[np.int64]:
        """The number of the material (N,), "mat" of the record, of the nearest kernel."""
        return self._run("surface", [self._points(points)], 5, self._numbers)[:, 4].astype(np.int64)

    def expand(self) -> list[tuple[int, Array]]:
        """All instances: the number of the kernel and the isometry (4,4) from it to its place, on
        homogeneous coordinates in the order of the record, in a product (5,5); of a Moebius sequence the
        matrix (2,2,4) of the map. ValueError for more than MOST_EXPANDED.
        """
        if self.instances > MOST_EXPANDED:
            raise ValueError(f"{self.instances} instances; at most {MOST_EXPANDED} are worked out one by one")
        if isinstance(self.sequence, MoebiusSequence):
            return [(i, place.matrix) for i, place in self.sequence.expand()]
        geometry = self.sequence.geometry
        if geometry == "e3":
            # w is 1.
            return [(i, _with_one(place)) for i, place in self.sequence.expand()]
        if geometry in ("s2xe", "h2xe"):
            return self.sequence.expand()
        back = np.argsort(self._order)
        return [(i, place[:4, :4][np.ix_(back, back)]) for i, place in self.sequence.expand()]

    @property
    def _without_balls(self) -> Array:
        if isinstance(self.sequence, MoebiusSequence):
            return np.array(self.sequence.numbers_without_balls)
        return self._numbers

    def _points(self, points: ArrayLike) -> Array:
        array = finite("points", points)
        width = 3 if self.sequence.geometry == "e3" else 4
        if array.ndim == 1:
            array = array[None, :]
        if array.ndim != 2 or array.shape[1] != width:
            raise ValueError(f"points have shape {np.shape(points)}; expected (N, {width})")
        if width == 3:
            return np.concatenate([array, np.ones((len(array), 1))], axis=1)
        array = array[:, self._order]
        off = np.abs(off_model(self.sequence.geometry, *array.T))
        if off.size and off.max() > curved.OFF_MODEL:
            first = "" if self._order[0] == 0 else "; as in the record, the origin is [1, 0, 0, 0]"
            raise ValueError(f"point {int(off.argmax())} is off the model of {self.sequence.geometry}{first}")
        return array

    def _run(self, name: str, arrays: list[Array], outputs: int, numbers: Array) -> Array:
        return self.program.run(f"{self.sequence.name}_over_{name}", arrays, outputs, numbers=numbers)


def _with_one(place: Array) -> Array:
    """A matrix (5,5) on [x, y, z, w, 1] as one (4,4) on [x, y, z, 1]."""
    keep = [0, 1, 2]
    matrix = np.eye(4)
    matrix[:3, :3] = place[np.ix_(keep, keep)]
    matrix[:3, 3] = place[:3, 3] + place[:3, 4]
    return matrix
