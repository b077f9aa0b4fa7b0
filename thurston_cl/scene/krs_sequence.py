"""From what a scene says of a kernel-reflection sequence to the sequence itself, and its materials."""

import contextlib
import dataclasses
import functools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from thurston_cl.geometry import Geometry
from thurston_cl.krs import curved, moebius
from thurston_cl.krs.kernels import EMPTY, kernel_of
from thurston_cl.krs.kernels import Kernel as SequenceKernel
from thurston_cl.krs.sequence import Mirror as SequenceMirror
from thurston_cl.krs.sequence import MoebiusSequence, PoleError, Sequence
from thurston_cl.models import ORIGIN, PRODUCTS
from thurston_cl.scene import schema
from thurston_cl.scene.krs import Kernel, Krs, MapStep, Mirror, Record
from thurston_cl.scene.parse import Location
from thurston_cl.scene.surfaces import Material

Array = NDArray[np.float64]


@dataclasses.dataclass(frozen=True)
class Painted:
    """A sequence, and the materials of its parts: part k of a kernel is painted with the k-th, from 1;
    part 0 with that of the object.
    """

    sequence: Sequence | MoebiusSequence
    materials: tuple[Material, ...]
    twisted: bool = False

    @property
    def ball(self) -> tuple[Array, float] | None:
        """Center (4,) and radius of a ball that holds it, None where none is known. A twist keeps balls
        about the axis.
        """
        sequence = self.sequence
        if not np.isfinite(sequence.radius):
            return None
        if sequence.geometry != "e3":
            return np.array(ORIGIN[sequence.geometry]), sequence.radius
        balls = sequence.balls
        center, radius = balls.enclosing_on_axis() if self.twisted else balls.enclosing()
        return np.append(center, 1.0), radius


class SequenceError(ValueError):
    """A sequence of a scene that cannot be: what is wrong, which keys of `krs` lead there, and a cure."""

    def __init__(
        self, message: str, path: Location = (), help: str | None = None, krs: Krs | None = None
    ) -> None:
        super().__init__(message)
        self.path, self.help, self.krs = path, help, krs


def painted_sequence(krs: Krs, geometry: Geometry) -> Painted:
    """The sequence that a scene describes; SequenceError where it makes no sense."""
    try:
        painted = _painted(krs, geometry.name, _Points(geometry))
    except SequenceError as error:
        error.krs = krs
        raise
    return painted if krs.twist is None else dataclasses.replace(painted, twisted=True)


@contextlib.contextmanager
def _reported_at(*path: str | int, help: str | None = None) -> Iterator[None]:
    """Whatever makes no sense in here is reported at these keys; by itself it may say "wrong; cure"."""
    try:
        yield
    except ValueError as error:
        message, _, cure = str(error).partition("; ")
        raise SequenceError(message, path, cure or help) from error


class _Points:
    """Where points are: works things out once for each sequence, whatever asks for it."""

    def __init__(self, geometry: Geometry) -> None:
        self.geometry = geometry

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Points) and other.geometry.name == self.geometry.name

    def __hash__(self) -> int:
        return hash(self.geometry.name)

    def point(self, where: "schema.ModelPoint | tuple[float, float, float]") -> Array:
        from thurston_cl.scene.placement import Placement

        return Placement(self.geometry).point(where)

    def check_near(self, point: Array) -> None:
        from thurston_cl.scene.placement import Placement

        Placement(self.geometry).check_near(point)

    def mirror(
        self,
        normal: tuple[float, float, float],
        offset: float,
        at: "schema.ModelPoint | tuple[float, float, float]" = (0.0, 0.0, 0.0),
        width: float = 0.0,
    ) -> SequenceMirror:
        """The plane across the geodesic that leaves `at` along the normal, at the signed distance offset."""
        name, start = self.geometry.name, self.point(at)
        # Neither too large nor too small a vector to be squared.
        direction = np.array(normal) / np.max(np.abs(normal))
        direction /= np.linalg.norm(direction)
        if name in PRODUCTS and direction[2] != 0:
            height = float(start[3] + offset * direction[2])
            return curved.level_mirror(height, float(direction[2]), width)
        foot, along = (found[0] for found in self.geometry.flow(direction, offset, base=start))
        self.check_near(foot)
        vector = self.geometry.velocity(foot, along)[0]
        if name == "e3":
            return SequenceMirror(np.array([*vector[:3], 0.0, -float(vector @ foot)]), vector, width)
        return curved.normal_mirror(name, vector, width)


@functools.lru_cache(maxsize=64)
def _painted(krs: Krs, name: str, points: _Points) -> Painted:
    record = krs.record
    if krs.recipe is not None:
        with _reported_at(krs.kind, help="choose another seed"):
            record = Record(krs.recipe.record())
    if record is not None:
        # Without materials every part is the object's own.
        shift = 1 if krs.materials else None
        kernels = tuple(
            dataclasses.replace(kernel, part=0 if shift is None else kernel.part + shift)
            for kernel in record.sequence.kernels
        )
        return _without_poles(
            krs, Painted(dataclasses.replace(record.sequence, kernels=kernels), krs.materials)
        )

    def made(path: Location, kernel: Kernel | None) -> SequenceKernel:
        if kernel is None:
            return EMPTY
        part = 0 if kernel.material is None else 1 + krs.materials.index(kernel.material)
        with _reported_at(*path, kernel.kind, help=_NEARER):
            return _kernel(kernel, part, points)

    kernels = tuple(made(path, kernel) for path, kernel in krs.kernels_written())
    if krs.moebius is not None:
        maps = []
        for i, level in enumerate(krs.moebius):
            with _reported_at(
                "moebius", i, "map", help="write numbers that are neither so large nor so small"
            ):
                maps.append(_map(level.map))
        widths = tuple(level.smooth for level in krs.moebius)
        return _without_poles(krs, Painted(MoebiusSequence(tuple(maps), widths, kernels), krs.materials))
    mirrors = []
    for i, ordinary in enumerate(krs.levels or ()):
        with _reported_at("levels", i, "mirror", help=_NEARER):
            mirrors.append(_mirror(ordinary.mirror, points))
    return Painted(Sequence(name, tuple(mirrors), kernels), krs.materials)


_NEARER = "place it nearer to the origin"


def _without_poles(krs: Krs, painted: Painted) -> Painted:
    """A sequence no level of which is infinite."""
    if isinstance(painted.sequence, MoebiusSequence):
        try:
            _ = painted.sequence.radius
        except PoleError as error:
            path: Location = (krs.kind,) if krs.moebius is None else ("moebius", error.level, "map")
            help = "bend less, or move what is bent away from the pole v/|v|² of the bend"
            raise SequenceError(str(error), path, help) from error
    return painted


def _mirror(mirror: Mirror, points: _Points) -> SequenceMirror:
    return points.mirror(mirror.normal, mirror.offset, mirror.at, mirror.smooth)


def _kernel(kernel: Kernel, part: int, points: _Points) -> SequenceKernel:
    name = points.geometry.name
    if kernel.half_space is not None:
        plane = points.mirror(kernel.half_space.normal, kernel.half_space.offset)
        if name != "e3":
            return curved.plane(name, plane, part)
        record = {"type": "plane", "n": plane.normal[:3], "h": -float(plane.form[4]), "mat": part}
        return kernel_of(record, "kernel")
    if kernel.ball is not None:
        center = points.point(kernel.ball.at)
        if name != "e3":
            return curved.sphere(name, center, kernel.ball.radius, part)
        return kernel_of({"type": "sphere", "c": center[:3], "r": kernel.ball.radius, "mat": part}, "kernel")
    if kernel.capsule is not None:
        a, b, r = points.point(kernel.capsule.start), points.point(kernel.capsule.to), kernel.capsule.radius
        if name != "e3":
            return curved.capsule(name, a, b, r, part)
        return kernel_of({"type": "capsule", "a": a[:3], "b": b[:3], "r": r, "mat": part}, "kernel")
    if kernel.arc is not None:
        arc = kernel.arc
        return kernel_of(
            {"type": "torcap", "p": arc.start, "q": arc.to, "m": arc.through, "r": arc.radius, "mat": part},
            "kernel",
        )
    assert kernel.leaf is not None
    leaf = kernel.leaf
    return kernel_of(
        {
            "type": "lens",
            "c": leaf.at,
            "a": leaf.across,
            "b": leaf.radius,
            "h": 0.5 * leaf.thickness,
            "mat": part,
        },
        "kernel",
    )


def _map(steps: tuple[MapStep, ...]) -> moebius.Map:
    return functools.reduce(lambda before, step: _step(step) @ before, steps, moebius.identity())


def _step(step: MapStep) -> moebius.Map:
    if step.move is not None:
        return moebius.translation(step.move)
    if step.scale is not None:
        return moebius.dilation(step.scale)
    if step.bend is not None:
        return moebius.bend(step.bend)
    assert step.turn is not None
    axis = np.array(step.turn.axis) / np.linalg.norm(step.turn.axis)
    return moebius.rotation(Rotation.from_rotvec(axis * step.turn.angle).as_matrix())
