"""Render a scene: tile by tile, sample by sample, on one OpenCL device."""

import dataclasses
import datetime
import json
import platform
import time
import warnings
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thurston_cl import device as devices
from thurston_cl.device import PRECISIONS, Device
from thurston_cl.errors import ThurstonError
from thurston_cl.image import EVERY_CHANNEL, Image
from thurston_cl.method import Method
from thurston_cl.program import LANE_WIDTHS, LOCAL_SIZE, build_widest
from thurston_cl.sampling import sample_shifts
from thurston_cl.scene import schema
from thurston_cl.scene.choice import Glance, achieved, fitted, flow_error, with_accuracy
from thurston_cl.scene.picture import View, size_problem, views
from thurston_cl.scene.plan import Plan, make_plan
from thurston_cl.scene.texels import images_of

# Pixels on a side of a tile: small enough on a CPU to show progress and stop at once, large enough on a GPU
# to fill it.
TILE_SIDE = {"cpu": 256}
TILE_SIDE_ELSEWHERE = 1024
# Tiles are padded to a multiple of this, so that each holds a whole number of work-groups at every lane width
# (64 x 16).
TILE_STEP = 32

# Rays out of steps are told of when they are so large a share: fewer graze an edge and are not seen.
TOLD_OUT_OF_STEPS = 0.05

# Pixels that one work-item of trace_refill owns at most; measured flat from 512 to 4096 on PoCL.
REFILL_CHUNK = 1024
# Work-items of trace_refill per compute unit, at least, so that the last one does not keep the others
# waiting.
REFILL_ITEMS = 8
# Below this share of lanes doing work in trace_packet, trace_refill is faster. Over 14 scenes on PoCL it took
# 0.6 to 0.9 of the time where the share was at most 0.56, and 1.3 to 1.6 where it was 0.68 or more.
REFILL_BELOW_UTILISATION = 0.6

# Where an accuracy is asked for: small tiles that are looked at beforehand, and how often the method is
# fitted to what is seen there.
GLANCES = 32
MOST_FITS = 4

# The channels of a tile in render.cl: what is counted per pixel over all samples, and where the others stand.
COUNTS = {
    "steps": 3,
    "shadow_steps": 4,
    "reflection_steps": 5,
    "light_solves": 6,
    "distance_evaluations": 7,
    "hits": 8,
    "nan": 9,
    "out_of_steps": 10,
}
_PLACES = {
    "beauty": (0, 1, 2),
    "depth": (11,),
    "normal": (12, 13, 14),
    "steps": (15,),
    "object": (16,),
    "cell": (17,),
    "error": (18,),
}
_TILE_CHANNELS = 19
_RECORD_COMPONENTS = 13


def render(
    scene: schema.Scene,
    *,
    device: "str | Device | None" = None,
    precision: str | None = None,
    lanes: int | None = None,
    finish: str | None = None,
    size: tuple[int, int] | None = None,
    samples: int | None = None,
    crop: tuple[int, int, int, int] | None = None,
    channels: Collection[str] = ("beauty", "depth", "normal", "steps", "object"),
    method: Method | None = None,
    accuracy: str | float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Image:
    """Render a scene to an image with the given channels; the arguments replace what the scene says.

    size: of the whole picture, both eyes included. crop: (left, top, right, bottom) in pixels of that;
    the image holds that part. method: precision, flow, threshold and steps in place of the scene's,
    where neither `precision` nor `accuracy` (a word of `render: {accuracy: ...}`, or an angle in
    radians) is given, which change only that. finish: "packet", "refill" or "auto". progress: called
    with (done, total) after every tile and sample; what it raises ends the rendering. Channels: beauty
    (H,W,3) linear Rec.709; depth (H,W), arc length, inf where nothing is hit; normal (H,W,3) in the
    frame at the hit point; steps (H,W); object (H,W), 0 for nothing, else the number of the object from
    1; cell (H,W), 0 for nothing, else the number of the cell from 1, the camera's own, nearest first;
    error (H,W), an estimate of how far off what is shown may be seen, in radians.

    The image's `statistics` count the work, over all samples: `rays` that were marched and their
    `steps`; `shadow_steps` and `reflection_steps` of rays that these called for; `light_solves`,
    geodesics to lights that were solved for; `distance_evaluations` of all rays and of ambient
    occlusion; and first rays that had `hits`, came to nothing (`nan`) or were `out_of_steps` where that
    can be seen. Raises SceneError, NoDeviceError, ValueError for arguments that make no sense.
    """
    started = time.perf_counter()
    scene = with_accuracy(scene, accuracy)
    settings = scene.render
    chosen = devices.choose(device) if device is None or isinstance(device, str) else device
    if precision is not None:
        _check_name("precision", precision, PRECISIONS)
    if method is not None and (precision, accuracy) != (None, None):
        raise ValueError("a method has its precision and accuracy: give only one of them")
    finish, samples = finish or settings.finish, settings.samples if samples is None else samples
    _check_name("finish", finish, ("auto", "packet", "refill"))
    for channel in channels:
        _check_name("channel", channel, EVERY_CHANNEL)
    if lanes is not None and lanes not in LANE_WIDTHS:
        raise ValueError(f"{lanes} lanes; expected one of: {', '.join(map(str, LANE_WIDTHS))}")
    if samples < 1 or samples != int(samples):
        raise ValueError(f"{samples} samples; expected a whole number from 1")
    whole = size or settings.size
    if any(side < 1 or side != int(side) for side in whole):
        raise ValueError(f"size {tuple(whole)}; expected two whole numbers from 1")
    layout = scene.camera.layout
    if problem := size_problem(scene.camera.projection.kind, layout, whole):
        raise ValueError("; ".join(problem))
    area = _checked_crop(crop, whole)
    promised = method is None and (accuracy, scene.render.accuracy) != (None, None)
    made = (*channels, "error") if promised and "error" not in channels else tuple(channels)
    plan = make_plan(
        scene,
        device=chosen,
        size=whole,
        channels=made,
        method=method,
        precision=precision,
        accuracy=accuracy,
    )
    method = plan.method
    if method.precision == "double" and not chosen.info.fp64:
        raise ValueError(
            f"{chosen.info.name} has no double precision; choose single precision or another device"
        )
    shifts = sample_shifts(samples, settings.filter, settings.seed)
    seen = [view for view in views(layout, whole, area) if "beauty" in channels or view.all_channels]

    def renderer_of(plan: Plan) -> TileRenderer:
        return TileRenderer(plan, chosen, lanes or chosen.info.lane_width(plan.method.precision), finish)

    renderer = renderer_of(plan)
    if plan.choice is not None:
        for _ in range(MOST_FITS):
            fit = fitted(plan.choice, scene.geometry, _glance(renderer, seen, shifts))
            if fit == plan.choice:
                break
            plan = make_plan(scene, device=chosen, size=whole, channels=made, method=fit.method)
            plan.choice = fit
            renderer = renderer_of(plan)
        method = plan.method
    image_channels, statistics = _render_tiles(renderer, seen, area, shifts, made, progress)
    if plan.choice is not None:
        rest = flow_error(scene.geometry, method)
        spent = statistics["out_of_steps"] / max(1, statistics["rays"])
        plan.choice = achieved(plan.choice, Glance.of(image_channels["error"], rest, spent))
        if made != tuple(channels):
            del image_channels["error"]
    if statistics["out_of_steps"] > TOLD_OUT_OF_STEPS * statistics["rays"]:
        share = statistics["out_of_steps"] / statistics["rays"]
        warnings.warn(
            f"{share:.1%} of the rays ran out of steps, and show what they came nearest to; raise steps",
            stacklevel=2,
        )
    if statistics["hits"] == 0:
        warnings.warn("no ray hit anything: is every object out of sight?", stacklevel=2)
    if plan.choice is not None and not plan.choice.met:
        warnings.warn(f"the accuracy may not be reached: {plan.choice.words}", stacklevel=2)
    statistics |= {
        "seconds": time.perf_counter() - started,
        "device": chosen.info.name,
        "method": dataclasses.asdict(method),
        "accuracy": None if plan.choice is None else plan.choice.metadata,
        "precision": method.precision,
        "lanes": renderer.lanes,
        "finish": renderer.finish,
        "size": list(whole),
        "samples": samples,
    }
    return Image(image_channels, _metadata(plan, chosen, statistics, area), statistics)


def _check_name(what: str, name: str, known: Collection[str]) -> None:
    if name not in known:
        raise ValueError(f"unknown {what} {name!r}; expected one of: {', '.join(known)}")


def _checked_crop(crop: tuple[int, int, int, int] | None, size: tuple[int, int]) -> tuple[int, int, int, int]:
    if crop is None:
        return (0, 0, *size)
    left, top, right, bottom = crop
    if not (0 <= left < right <= size[0] and 0 <= top < bottom <= size[1]):
        raise ValueError(f"crop {crop} is not inside the picture, which is {size[0]} x {size[1]} pixels")
    return crop


def _metadata(
    plan: Plan, device: Device, statistics: dict[str, Any], area: tuple[int, int, int, int]
) -> dict[str, str]:
    """Everything that it takes to make the picture again."""
    packages = ("thurston_cl", "pyopencl", "numpy", "OpenImageIO")
    settings = {key: statistics[key] for key in ("lanes", "finish", "size", "samples")}
    settings |= dataclasses.asdict(plan.method) | {"accuracy": statistics["accuracy"]}
    info = device.info
    return {
        "scene": plan.scene.effective_text(),
        "settings": json.dumps({**settings, "crop": list(area)}),
        "versions": json.dumps(
            {name: version(name) for name in packages} | {"python": platform.python_version()}
        ),
        "device": json.dumps(
            {
                "name": info.name,
                "platform": info.platform,
                "version": info.platform_version,
                "driver": info.driver,
            }
        ),
        "images": json.dumps(plan.image_digests),
        "created": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
    }


@dataclass(frozen=True)
class Tile:
    """A rectangle of the picture, in pixels; `padded` is what the kernels work on."""

    left: int
    top: int
    width: int
    height: int

    @property
    def padded(self) -> tuple[int, int]:
        return -(-self.width // TILE_STEP) * TILE_STEP, -(-self.height // TILE_STEP) * TILE_STEP

    @property
    def pixels(self) -> int:
        return self.padded[0] * self.padded[1]


def tiles(area: tuple[int, int, int, int], side: int) -> Iterator[Tile]:
    """Cover the area (left, top, right, bottom), row by row."""
    left, top, right, bottom = area
    for y in range(top, bottom, side):
        for x in range(left, right, side):
            yield Tile(x, y, min(side, right - x), min(side, bottom - y))


def _glance(renderer: "TileRenderer", seen: Sequence[View], shifts: NDArray[np.float64]) -> Glance:
    """What a few small tiles all over the picture say of how exact it is."""
    random = np.random.default_rng(0)
    errors: list[NDArray[np.floating]] = []
    rays = spent = 0.0
    for view in seen:
        renderer.look_through(view.eye)
        left, top, right, bottom = view.area
        for _ in range(GLANCES):
            x = int(random.integers(left, max(left + 1, right - TILE_STEP + 1)))
            y = int(random.integers(top, max(top + 1, bottom - TILE_STEP + 1)))
            tile = Tile(x, y, min(TILE_STEP, right - x), min(TILE_STEP, bottom - y))
            found, counts = renderer.run(tile, shifts[:1], ["error", "object"])
            errors.append(found["error"][found["object"] > 0])
            rays, spent = rays + counts["rays"], spent + counts["out_of_steps"]
    rest = flow_error(renderer.plan.scene.geometry, renderer.plan.method)
    return Glance.of(np.concatenate(errors), rest, spent / max(1.0, rays))


class TileRenderer:
    """The program of one plan, its buffers, and how to run it over one tile."""

    def __init__(self, plan: Plan, device: Device, lanes: int, finish: str) -> None:
        import pyopencl as cl

        self.plan = plan
        self.device = device
        precision = plan.method.precision
        self.dtype = np.dtype(np.float64 if precision == "double" else np.float32)
        self.program, self.lanes = build_widest(device, plan.source, precision, lanes)
        # One lane never waits for another: refilling it gains nothing.
        self.finish = "packet" if finish == "auto" and self.lanes == 1 else finish
        self.kernel_seconds = 0.0
        flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
        room = device.context.devices[0].max_constant_buffer_size
        if plan.numbers.size * self.dtype.itemsize > room:
            raise ThurstonError(
                f"the scene has {plan.numbers.size} numbers, more than the {room} bytes for constants on "
                f"{device.info.name} hold; use fewer translates of lights"
            )
        self._eyes = [
            cl.Buffer(device.context, flags, hostbuf=numbers.astype(self.dtype)) for numbers in plan.eyes
        ]
        self._next_cell = cl.Buffer(device.context, flags, hostbuf=np.ascontiguousarray(plan.next_cell))
        self._seen_from = cl.Buffer(device.context, flags, hostbuf=plan.seen_from.astype(self.dtype))
        self._texels = cl.Buffer(device.context, flags, hostbuf=self._checked_texels())
        self._by_blocks = "block_start.cl" in plan.parts
        names = ("trace_packet", "trace_refill", "shade", *(("trace_blocks",) if self._by_blocks else ()))
        self._kernels = {name: cl.Kernel(self.program, name) for name in names}
        self._side = TILE_SIDE.get(device.info.kind, TILE_SIDE_ELSEWHERE)
        self._room = 0
        self.look_through(0)

    def look_through(self, eye: int) -> None:
        """Go on with the eye of this number, 0 for the left or only one."""
        self._eye = eye
        self._looked = False

    def _checked_texels(self) -> NDArray[np.floating]:
        """The images in the precision of the picture; SceneError where the device has no buffer for them."""
        needed = self.plan.texels.size * self.dtype.itemsize
        most = self.device.context.devices[0].max_mem_alloc_size
        if needed > most:
            location = next(location for location, _ in images_of(self.plan.scene))
            raise self.plan.scene.error_at(
                location,
                f"the images of the scene take {needed} bytes, more than the {most} of one buffer on "
                f"{self.device.info.name}",
                "scale them down",
            )
        return self.plan.texels.astype(self.dtype)

    @property
    def side(self) -> int:
        """Pixels on a side of a tile."""
        return self._side

    def run(
        self,
        tile: Tile,
        shifts: NDArray[np.float64],
        channels: Collection[str],
        after_sample: Callable[[], None] = lambda: None,
    ) -> tuple[dict[str, NDArray[np.floating]], dict[str, float]]:
        """Trace and shade all samples of a tile.

        Returns its channels, (height, width) or (height, width, 3), beauty summed over the samples and the
        others of the first one; and the counts of `COUNTS` and of the rays, over all samples. Pixels that are
        not marched are black.
        """
        import pyopencl as cl

        self._make_room(tile.pixels)
        stride = np.int32(tile.pixels)
        for sample, shift in enumerate(shifts):
            self._trace(tile, shift)
            items = tile.pixels // self.lanes
            self._launch("shade", items, LOCAL_SIZE, self._records, self._pixels, stride, np.int32(sample))
            after_sample()
        shape = (_TILE_CHANNELS, tile.pixels)
        values, _ = cl.enqueue_map_buffer(
            self.device.queue, self._pixels, cl.map_flags.READ, 0, shape, self.dtype
        )
        with values.base:
            counts = {name: float(values[place].sum(dtype=np.float64)) for name, place in COUNTS.items()}
            # Padding, and what is outside a round picture.
            seen = values[_PLACES["object"]] + values[COUNTS["nan"]]
            unmarched = (values[_PLACES["steps"]] == 0) & (seen == 0)
            counts["rays"] = float(np.count_nonzero(~unmarched)) * len(shifts)
            found = {name: _unblock(values, _PLACES[name], tile) for name in channels}
            if "beauty" in found:
                found["beauty"][_unblock(unmarched[None], (0,), tile)] = 0
        return found, counts

    def trace(self, tile: Tile, shift: NDArray[np.float64], finish: str) -> None:
        """March the rays of one sample of a tile, without shading them."""
        self._make_room(tile.pixels)
        corners = (tile.left, tile.top, tile.left + tile.width, tile.top + tile.height)
        place = (*map(np.int32, corners), np.int32(tile.padded[0]), *map(self.dtype.type, shift))
        if self._by_blocks:
            items = tile.pixels // (16 * self.lanes)
            group = LOCAL_SIZE if items % LOCAL_SIZE == 0 else 1
            self._launch("trace_blocks", items, group, self._records, np.int32(tile.pixels), *place)
        if finish == "packet":
            self._launch(
                "trace_packet",
                tile.pixels // self.lanes,
                LOCAL_SIZE,
                self._records,
                np.int32(tile.pixels),
                *place,
            )
        else:
            chunk = self._chunk(tile.pixels)
            self._launch(
                "trace_refill",
                tile.pixels // chunk,
                1,
                self._records,
                np.int32(tile.pixels),
                *place,
                last=(np.int32(chunk),),
            )

    def _trace(self, tile: Tile, shift: NDArray[np.float64]) -> None:
        if self._looked:
            self.trace(tile, shift, self.finish)
            return
        self.trace(tile, shift, "packet" if self.finish == "auto" else self.finish)
        t, steps, _, end = self.records(tile)
        marched = (steps > 0) | (end > 0)
        # A tile may lie outside a round picture.
        self._looked = bool(marched.any())
        if not self._looked:
            return
        if self.finish == "auto":
            # How many lanes of a packet wait for the others?
            packets = steps.reshape(-1, self.lanes)
            utilisation = steps.sum() / max(1.0, packets.max(axis=1).sum() * self.lanes)
            self.finish = "refill" if utilisation < REFILL_BELOW_UTILISATION else "packet"
        if np.all(t[marched] == 0):
            who = "camera" if len(self.plan.eyes) == 1 else ("left eye", "right eye")[self._eye]
            raise self.plan.scene.error_at(
                ("camera",), f"the {who} is inside an object: no ray gets anywhere", "move it into the open"
            )

    def records(self, tile: Tile) -> NDArray[np.floating]:
        """Arc length, steps, cell and end (4, pixels) of the rays just traced, the head of their records."""
        import pyopencl as cl

        result = np.empty((4, tile.pixels), self.dtype)
        cl.enqueue_copy(self.device.queue, result, self._records)
        return result

    def _chunk(self, pixels: int) -> int:
        chunk = REFILL_CHUNK
        while chunk > 4 * self.lanes and pixels // chunk < REFILL_ITEMS * self.device.info.compute_units:
            chunk //= 2
        return max(chunk, self.lanes)

    def _launch(self, name: str, items: int, group: int, *arguments: Any, last: tuple[Any, ...] = ()) -> None:
        import pyopencl as cl

        steps = np.int32(self.plan.method.steps)
        kernel = self._kernels[name]
        tables = (self._eyes[self._eye], self._next_cell, self._seen_from, self._texels)
        kernel.set_args(*arguments, steps, *tables, *last)
        event = cl.enqueue_nd_range_kernel(self.device.queue, kernel, (items,), (group,))
        event.wait()
        self.kernel_seconds += (event.profile.end - event.profile.start) * 1e-9

    def _make_room(self, pixels: int) -> None:
        import pyopencl as cl

        if pixels > self._room:
            size = pixels * self.dtype.itemsize
            self._records = cl.Buffer(self.device.context, cl.mem_flags.READ_WRITE, size * _RECORD_COMPONENTS)
            self._pixels = cl.Buffer(self.device.context, cl.mem_flags.READ_WRITE, size * _TILE_CHANNELS)
            self._room = pixels


def _unblock(values: NDArray[np.floating], places: Sequence[int], tile: Tile) -> NDArray[np.floating]:
    """Undo the 4x4 blocks in which the kernels number pixels, and cut off the padding."""
    width, height = tile.padded
    rows = [
        values[place].reshape(height // 4, width // 4, 4, 4).transpose(0, 2, 1, 3).reshape(height, width)
        for place in places
    ]
    picture = rows[0] if len(rows) == 1 else np.stack(rows, axis=2)
    return picture[: tile.height, : tile.width]


def _render_tiles(
    renderer: TileRenderer,
    seen: Sequence[View],
    area: tuple[int, int, int, int],
    shifts: NDArray[np.float64],
    channels: Collection[str],
    progress: Callable[[int, int], None] | None,
) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    width, height = area[2] - area[0], area[3] - area[1]
    result: dict[str, NDArray[Any]] = {}
    for name in channels:
        integer = name in ("object", "cell")
        shape = (height, width, 3) if name in ("beauty", "normal") else (height, width)
        result[name] = np.zeros(shape, np.uint32 if integer else np.float32)
    counts = dict.fromkeys(("rays", *COUNTS), 0)
    work = [(view, list(tiles(view.area, renderer.side))) for view in seen]
    done, total = 0, len(shifts) * sum(len(view_tiles) for _, view_tiles in work)

    def after_sample() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, total)

    for view, view_tiles in work:
        renderer.look_through(view.eye)
        wanted = [name for name in channels if name == "beauty" or view.all_channels]
        # The middle first: it says how to go on.
        view_tiles.insert(0, view_tiles.pop(len(view_tiles) // 2))
        for tile in view_tiles:
            found, tile_counts = renderer.run(tile, shifts, wanted, after_sample)
            top, left = tile.top - view.area[1] + view.top, tile.left - view.area[0] + view.left
            place = np.s_[top : top + tile.height, left : left + tile.width]
            for name, count in tile_counts.items():
                counts[name] += round(count)
            for name, values in found.items():
                if name == "beauty":
                    result[name][place][..., view.colors] = values[..., view.colors] / len(shifts)
                else:
                    result[name][place] = values
    return result, {**counts, "kernel_seconds": renderer.kernel_seconds}
