"""From what a scene says of a kernel-reflection sequence to the sequence itself, and its materials."""

import dataclasses
import functools

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from thurston_cl.geometry import Geometry
from thurston_cl.krs import curved, moebius
from thurston_cl.krs.kernels import EMPTY, kernel_of
from thurston_cl.krs.kernels import Kernel as SequenceKernel
from thurston_cl.krs.sequence import Mirror as SequenceMirror
from thurston_cl.krs.sequence import MoebiusSequence, Sequence
from thurston_cl.models import ORIGIN, PRODUCTS
from thurston_cl.scene import schema
from thurston_cl.scene.krs import Kernel, Krs, MapStep, Mirror, Record
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


def painted_sequence(krs: Krs, geometry: Geometry) -> Painted:
    """The sequence that a scene describes; ValueError where it makes no sense."""
    painted = _painted(krs, geometry.name, _Points(geometry))
    return painted if krs.twist is None else dataclasses.replace(painted, twisted=True)


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

    def mirror(
        self,
        normal: tuple[float, float, float],
        offset: float,
        at: "schema.ModelPoint | tuple[float, float, float]" = (0.0, 0.0, 0.0),
        width: float = 0.0,
    ) -> SequenceMirror:
        """The plane across the geodesic that leaves `at` along the normal, at the signed distance offset."""
        name, start = self.geometry.name, self.point(at)
        direction = np.array(normal) / np.linalg.norm(normal)
        if name in PRODUCTS and direction[2] != 0:
            height = float(start[3] + offset * direction[2])
            return curved.level_mirror(height, float(direction[2]), width)
        foot, along = (found[0] for found in self.geometry.flow(direction, offset, base=start))
        vector = self.geometry.velocity(foot, along)[0]
        if name == "e3":
            return SequenceMirror(np.array([*vector[:3], 0.0, -float(vector @ foot)]), vector, width)
        return curved.normal_mirror(name, vector, width)


@functools.lru_cache(maxsize=64)
def _painted(krs: Krs, name: str, points: _Points) -> Painted:
    record = Record(krs.recipe.record()) if krs.recipe is not None else krs.record
    if record is not None:
        # Without materials every part is the object's own.
        shift = 1 if krs.materials else None
        kernels = tuple(
            dataclasses.replace(kernel, part=0 if shift is None else kernel.part + shift)
            for kernel in record.sequence.kernels
        )
        return Painted(dataclasses.replace(record.sequence, kernels=kernels), krs.materials)

    def made(kernel: Kernel | None) -> SequenceKernel:
        if kernel is None:
            return EMPTY
        part = 0 if kernel.material is None else 1 + krs.materials.index(kernel.material)
        return _kernel(kernel, part, points)

    if krs.moebius is not None:
        kernels = (made(krs.kernel), *(made(level.kernel) for level in krs.moebius))
        maps = tuple(_map(level.map) for level in krs.moebius)
        widths = tuple(level.smooth for level in krs.moebius)
        return Painted(MoebiusSequence(maps, widths, kernels), krs.materials)
    levels = krs.levels or ()
    kernels = (made(krs.kernel), *(made(level.kernel) for level in levels))
    mirrors = tuple(_mirror(level.mirror, points) for level in levels)
    return Painted(Sequence(name, mirrors, kernels), krs.materials)


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
