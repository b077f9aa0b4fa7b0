"""Single rays of a picture: what they come to by a method, and what exact geodesics in double come to.

`Rays` marches the rays of places in a picture, `ExactRays` does so for the truth, and tells how far a
method's point is from the exact geodesic (kernels/verify).
"""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thurston_cl.arrays import ArrayProgram
from thurston_cl.device import Device
from thurston_cl.errors import NoDeviceError
from thurston_cl.lattice import elements
from thurston_cl.method import Method
from thurston_cl.models import HOMOGENEOUS
from thurston_cl.program import Source
from thurston_cl.scene import schema
from thurston_cl.scene.choice import REFERENCE
from thurston_cl.scene.picture import Size
from thurston_cl.scene.plan import make_plan
from thurston_cl.scene.tracer import tracer_of
from thurston_cl.scene.write_camera import pixel_angle

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
# Some of many: flags, or their numbers.
Which = Flags | NDArray[np.intp]

# Of the truth: how near is a hit, and how many steps a ray may take. The threshold is far above rounding in
# double, and far below what any picture shows.
TRUTH_THRESHOLD = REFERENCE.threshold
TRUTH_STEPS = REFERENCE.steps
# Lanes on a CPU, at most: few rays are marched, so that a narrow program, which is built in half of the time,
# is the faster one.
MOST_LANES = 8
# Images of a point that are looked at for the one with the least turn, at most.
IMAGES = 400
# Numbers of a plan that are replaced here: where kernels/scene_types.h has them.
_HIT_THRESHOLD = 0


@dataclass(frozen=True)
class Places:
    """Places in a picture: which eye sees them (N,), 0 for the left or only one; column and row (N,2) of the
    pixel in the picture of that eye; and where in the pixel (N,2), from its top left corner.
    """

    eye: NDArray[np.intp]
    pixel: Array
    shift: Array

    def __len__(self) -> int:
        return len(self.eye)

    def __getitem__(self, which: Which) -> "Places":
        return Places(*_of_each(self, which))

    @property
    def xy(self) -> Array:
        """The places (N,2) in pixels from the top left corner of what the eye sees."""
        return self.pixel + self.shift

    def around(self, offsets: Array, scale: ArrayLike = 1.0) -> "Places":
        """Places beside these: for each of them, in order, those at all `offsets` (K,2) in pixels, times
        `scale` (N,).
        """
        count = len(offsets)
        shift = (self.shift[:, None] + offsets[None] * np.reshape(scale, (-1, 1, 1))).reshape(-1, 2)
        return Places(np.repeat(self.eye, count), np.repeat(self.pixel, count, axis=0), shift)


@dataclass(frozen=True)
class Ends:
    """What rays come to: their length (N,), NaN where they are lost; steps (N,); whether they are `marched`,
    which they are not outside a round picture, `hit`, or ran `out_of_steps` (N,); point and velocity (N,4)
    there; the number of the object that they show (N,), 0 for the background; the fraction (N,) of what they
    show that fog leaves; and, where the rays were made to tell, an estimate of their angle error (N,) in
    radians, without what is alike for all: else 0.
    """

    length: Array
    steps: Array
    marched: Flags
    hit: Flags
    out_of_steps: Flags
    point: Array
    velocity: Array
    object: NDArray[np.intp]
    clear: Array
    estimate: Array

    def __getitem__(self, which: Which) -> "Ends":
        return Ends(*_of_each(self, which))

    @property
    def lost(self) -> Flags:
        """Whether they came to nothing (N,): they show the background."""
        return self.marched & ~np.isfinite(self.length)


@dataclass(frozen=True)
class Offsets:
    """How far points are from exact geodesics, to first order: by which turn (N,2) of the direction at the
    eye and by which length (N,) they are missed; their `distance` (N,); the `area` (N,) that a solid angle of
    1 has at this length; by which turn (N,2) their `foot` (N,4) is missed, the point of the surface that is
    nearest to them; and of the two `fields` that turns make the products (N,3) 1 with 1, 1 with 2, 2 with 2.
    """

    turn: Array
    length: Array
    distance: Array
    area: Array
    shown: Array
    foot: Array
    fields: Array

    def __getitem__(self, which: Which) -> "Offsets":
        return Offsets(*_of_each(self, which))

    @property
    def widest(self) -> tuple[Array, Array]:
        """The turn (N,2) of length 1 that moves the point the most, and how much it does (N,)."""
        first, mixed, second = self.fields.T
        angle = 0.5 * np.arctan2(2 * mixed, first - second)
        square = 0.5 * (first + second + np.hypot(first - second, 2 * mixed))
        return np.stack([np.cos(angle), np.sin(angle)], axis=1), np.sqrt(square)


class Rays:
    """Marches the rays of single places by a method, as the picture of the scene has them.

    size: of the whole picture; the scene's where it is None. lanes: width of the kernels, None for what suits
    the device. estimate: whether rays tell how large their error may be. Raises SceneError as rendering does,
    ValueError where the device has no double precision.
    """

    _parts: tuple[str, ...] = ("verify/trace.cl",)

    def __init__(
        self,
        scene: schema.Scene,
        method: Method,
        device: Device,
        size: Size | None = None,
        lanes: int | None = None,
        estimate: bool = False,
    ) -> None:
        import pyopencl as cl

        self.scene = scene
        self.method = method
        self.device = device
        self.size = size or scene.render.size
        plan = make_plan(_uncolored(scene), device=device, size=self.size, method=method)
        self._eyes = plan.eyes
        self._estimates = estimate
        defines = {"VERIFY_ESTIMATE": 1, "ERROR_CHANNEL": len(plan.numbers)} if estimate else {}
        if estimate:
            # What is alike for all rays.
            self._eyes = tuple(np.append(numbers, 0.0) for numbers in plan.eyes)
        width = lanes or min(MOST_LANES, device.info.lane_width(method.precision))
        source = _of_rays(plan.source, self._parts, defines)
        self._program = ArrayProgram(source, method.precision, device, width)
        dtype = self._program.dtype
        flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
        tables = (plan.next_cell, plan.seen_from.astype(dtype), plan.texels.astype(dtype))
        self._tables = [
            cl.Buffer(device.context, flags, hostbuf=np.ascontiguousarray(table)) for table in tables
        ]

    @property
    def seconds(self) -> float:
        """How long the device was at work on the last rays, of the last eye that had some."""
        return self._program.seconds

    def threshold_at(self, length: Array, threshold: float | None = None) -> Array:
        """How near counts as a hit (N,) after lengths (N,) of the way; threshold: not the method's."""
        near = self.method.threshold if threshold is None else threshold
        angle = pixel_angle(self.scene.camera, self.size)
        return np.maximum(near, (self.scene.render.detail or 0.0) * angle * length)

    def starts(self, places: Places) -> tuple[Array, Array]:
        """Where the rays of places begin (N,4), and their directions (N,3) in the frame there."""
        out = self._run("verify_view", places, [], 7, threshold=self.method.threshold)
        return out[:, :4], out[:, 4:]

    def trace(self, places: Places, threshold: float | None = None, steps: int | None = None) -> Ends:
        """March the rays of places; threshold and steps in place of the method's."""
        near = self.method.threshold if threshold is None else threshold
        most = self.method.steps if steps is None else steps
        out = self._run("verify_trace", places, [], 13 + self._estimates, most, threshold=near)
        marched = out[:, 2] >= 0
        lost = ~np.isfinite(out[:, 0])
        return Ends(
            np.where(marched, out[:, 0], np.nan),
            out[:, 1],
            marched,
            (out[:, 2] == 1) & ~lost,
            (out[:, 2] == 2) & ~lost,
            out[:, 3:7],
            out[:, 7:11],
            np.where(lost, 0, out[:, 11]).astype(np.intp),
            np.where(lost, 1.0, out[:, 12]),
            out[:, 13] if self._estimates else np.zeros(len(places)),
        )

    def _run(
        self,
        kernel: str,
        places: Places,
        arrays: Sequence[Array],
        outputs: int,
        *constants: int,
        threshold: float,
        more: ArrayLike = (),
    ) -> Array:
        """Run a kernel for each eye over its places; `more` numbers stand behind those of the plan."""
        result = np.empty((len(places), outputs))
        for eye, numbers in enumerate(self._eyes):
            own = np.flatnonzero(places.eye == eye)
            if len(own) == 0:
                continue
            numbers = np.concatenate([numbers, np.ravel(more)])
            numbers[_HIT_THRESHOLD] = threshold
            rows = [places.pixel[own], places.shift[own], *(array[own] for array in arrays)]
            result[own] = self._program.run(
                kernel, rows, outputs, *constants, numbers=numbers, tables=self._tables
            )
        return result


class ExactRays(Rays):
    """The truth of a picture: rays along exact geodesics in double, marched step by step to a tight
    threshold, with nothing left out for being small (`detail`), however the scene is marched.

    Raises NoDeviceError where the device has no double precision.
    """

    _parts = ("verify/trace.cl", "verify/carry.cl")

    def __init__(
        self, scene: schema.Scene, device: Device, size: Size | None = None, lanes: int | None = None
    ) -> None:
        if not device.info.fp64:
            raise NoDeviceError(
                f"{device.info.name} ({device.info.id}) has no double precision, which errors are measured "
                "against; use a --device that 'thurston devices' lists with fp64"
            )
        method = Method("double", threshold=min(TRUTH_THRESHOLD, scene.render.threshold), steps=TRUTH_STEPS)
        plain = {"start": "pixel", "detail": None}
        if tracer_of(scene).name != "direct":
            plain["tracer"] = "direct"
        settings = scene.render.model_copy(update=plain)
        super().__init__(scene.model_copy(update={"render": settings}), method, device, size, lanes)
        none = np.zeros((0, 4, 4))
        self._over_walls = none if scene.lattice is None else scene.lattice.over_walls[:, :4]
        # All numbers have to fit.
        room = device.context.devices[0].max_constant_buffer_size // 8 - len(self._eyes[0])
        count = min(IMAGES, room // (4 * HOMOGENEOUS[scene.geometry]))
        self._around = none if scene.lattice is None else elements(scene.lattice, count)[:, :4]

    def offsets(
        self,
        places: Places,
        turn: Array,
        length: Array,
        ends: Ends,
        near: Array,
        by_turn: bool = False,
    ) -> Offsets:
        """How far the points of `ends` are from the exact geodesics of places after a length (N,), with the
        direction at the eye turned by `turn` (N,2) radians along two axes across it. Those points are no
        farther than `near` (N,) from a surface.

        In a manifold the image of the point counts that is nearest, in the cell or beyond its walls; or, of
        all that are near, the one with the least turn (`by_turn`): where geodesics part fast, that may be
        some cells from where the geodesic is.
        """
        images = self._around if by_turn else self._over_walls
        arrays = [turn, length[:, None], ends.point, ends.velocity, near[:, None]]
        out = self._run(
            "verify_carry",
            places,
            arrays,
            14,
            len(self._eyes[0]),
            len(images),
            int(by_turn),
            threshold=self.method.threshold,
            more=images,
        )
        return Offsets(out[:, :2], out[:, 2], out[:, 3], out[:, 4], out[:, 5:7], out[:, 7:11], out[:, 11:])


def _of_each(arrays: Places | Ends | Offsets, which: Which) -> Iterator[NDArray[Any]]:
    return (getattr(arrays, field.name)[which] for field in dataclasses.fields(arrays))


def _uncolored(scene: schema.Scene) -> schema.Scene:
    """The scene with objects in a plain color: where rays end does not depend on it, and patterns take long
    to compile.
    """
    plain = {"color": schema.Material().color}
    objects = tuple(
        item.model_copy(update={"material": item.material.model_copy(update=plain)}) for item in scene.objects
    )
    return scene.model_copy(update={"objects": objects})


def _of_rays(source: Source, parts: tuple[str, ...], defines: Mapping[str, int]) -> Source:
    """The program of a plan with rays and air, without light, and with other entry points."""
    before = source.parts[: source.parts.index("scene objects") + 1]
    air = [
        part for part in source.parts if part.startswith(("light/fog", "light/sky")) or part == "scene air"
    ]
    more = ("error.h", "arrays.h") if "VERIFY_ESTIMATE" in defines else ("arrays.h",)
    return Source((*before, *air, *more, *parts), {**source.defines, **defines}, source.generated)
