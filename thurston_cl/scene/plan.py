"""What a scene calls for: the kernel files, the generated text and the numbers that one program needs, and
no more.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thurston_cl import device as devices
from thurston_cl.device import Device
from thurston_cl.flows import Flow
from thurston_cl.geometry import for_few_points
from thurston_cl.krs.program import krs_order
from thurston_cl.krs.words import Level, in_short, levels_of, numbered
from thurston_cl.lattice import cell_table
from thurston_cl.lattice.prism import Prism
from thurston_cl.method import Method
from thurston_cl.program import Source, geometry_parts
from thurston_cl.scene import effect_files, schema
from thurston_cl.scene.choice import Choice, flow_error, method_of
from thurston_cl.scene.cost import Cost, predict
from thurston_cl.scene.near_walls import choose_near_walls
from thurston_cl.scene.numbers import Numbers
from thurston_cl.scene.placement import CameraFrame, Placement
from thurston_cl.scene.tracer import tracer_of
from thurston_cl.scene.write_camera import pixel_angle, write_camera
from thurston_cl.scene.write_light import write_air, write_lights, write_seen
from thurston_cl.scene.write_objects import needs_clearance, write_objects
from thurston_cl.scene.write_tracer import write_tracer
from thurston_cl.scene.write_walls import write_walls
from thurston_cl.scene.writer import Named, Writer

# How far a ray goes where the scene does not say. In s3 a ray is back where it began, in s2xe it
# has been round six times. In h3, h2xe and sl2 nearby directions part like e^t, so that single precision,
# with log(1/EPSILON) = 16, has no digits left beyond 15. In sol those do that go up or down, but they come
# back: next to a hyperbolic plane after twice the logarithm of the angle to it, which does not show at 30.
# A cell of finite volume has something to hit in every direction, and no background: there a ray goes on, and
# what it shows beyond 15 is finer than a pixel.
FAR = dict.fromkeys(("h3", "h2xe", "sl2"), 15.0) | {
    "e3": 100.0,
    "s3": 2 * np.pi,
    "s2xe": 40.0,
    "nil": 100.0,
    "sol": 30.0,
}
FAR_IN_FINITE_CELL = FAR | dict.fromkeys(("h3", "h2xe", "sl2", "sol"), 40.0)

# What is said of an accuracy before anything is rendered.
FIT = "{}. Rendering looks at the picture first, and may take a smaller threshold and more steps"

# Cells with a number of their own; those farther away share the last. 4096 numbers fit half of a second-level
# cache.
CELL_TABLE = 4096
# In a fibred geometry a light that is not repeated is seen along the fibre from cells that are far more than
# 4096 away, and over a hyperbolic base so many lie beside each other: the table has whole columns, as high as
# rays go, over the nearest cells of the base. Beyond these windows are finer than a pixel.
LIT_CELLS = 131072


@dataclass
class Plan:
    """One program for one scene, with its numbers. `eyes` (the numbers as each eye has them, the left or only
    one first), `next_cell`, `seen_from` and `texels` fill the kernels' buffers.
    """

    scene: schema.Scene
    source: Source
    eyes: tuple[NDArray[np.float64], ...]
    next_cell: NDArray[np.int32]
    seen_from: NDArray[np.float64]
    texels: NDArray[np.float32]
    near_walls: str
    object_images: int
    light_images: int
    sequences: tuple[Named, ...]
    method: Method
    choice: Choice | None
    asked: Mapping[str, float]
    image_digests: Mapping[str, str]

    @property
    def parts(self) -> tuple[str, ...]:
        """The kernel files that are pasted, in order, with the generated parts between them."""
        return self.source.parts

    @property
    def left_out(self) -> list[str]:
        """Effects that exist, and that this scene does not name: their files are not in the source."""
        return effect_files.left_out(self.parts)

    @property
    def called_for(self) -> list[str]:
        """Effects that this scene names."""
        return effect_files.called_for(self.parts)

    @property
    def costs(self) -> dict[str, Cost]:
        """The predicted cost of the lights and of each effect that this scene names."""
        named = {"lights": "light/point.h", "light fading by area density": "light/falloff_area.h"}
        named = {name: file for name, file in named.items() if file in self.parts}
        return self._costs(named | {effect: effect_files.EFFECTS[effect] for effect in self.called_for})

    @property
    def costs_left_out(self) -> dict[str, Cost]:
        """What each effect that this scene does not name would cost: shadows those of all lights."""
        left_out = [effect for effect in self.left_out if self.scene.lattice or effect != "cell ids"]
        return self._costs({effect: effect_files.EFFECTS[effect] for effect in left_out})

    def _costs(self, named: Mapping[str, str]) -> dict[str, Cost]:
        lights = self.asked.get("light/point.h", 0) + self.asked.get("light/sun.h", 0)
        # What is not counted, such as a pattern, is evaluated once.
        usual = dict.fromkeys(named.values(), 1.0) | {
            file: max(1.0, lights) for file in named.values() if file.endswith("_shadow.h")
        }
        costs = predict(self.scene.geometry, {file: self.asked.get(file, usual[file]) for file in usual})
        return {name: costs[file] for name, file in named.items()}

    @property
    def sequence_levels(self) -> list[list[Level]]:
        """Of each sequence its levels, the innermost first."""
        return [levels_of(named.sequence, named.made_of) for named in self.sequences]

    @property
    def numbers(self) -> NDArray[np.float64]:
        """The numbers of the left or only eye."""
        return self.eyes[0]

    def explain(self) -> dict[str, str]:
        """What the scene calls for and what is left out, in the order in which to say it."""
        settings = self.scene.render
        quotient = (
            "the whole space"
            if self.scene.lattice is None
            else f"{self.scene.lattice.name}, {len(self.scene.lattice.walls)} walls"
        )
        named = [part.split("/")[1].removesuffix(".h") for part in self.parts if part.startswith("shape/")]
        objects = self.source.generated["scene objects"]
        shapes = [name.replace("_", " ") for name in named if f"{name}_surface(" in objects]
        shapes += ["kernel-reflection sequences"] * bool(self.sequences)
        return {
            "geometry": self.scene.geometry,
            "space": quotient,
            "objects": f"{len(self.scene.objects)}, made of: {', '.join(shapes)}",
            **{
                f"sequence {k}": "\n".join([in_short(named.sequence), *numbered(levels)])
                for k, (named, levels) in enumerate(
                    zip(self.sequences, self.sequence_levels, strict=True), start=1
                )
            },
            "distance near walls": f"{self.near_walls}, {self.object_images} images of objects over walls",
            "lights": f"{len(self.scene.lights) or 'the default ones'}, {self.light_images} images in all",
            "called for": ", ".join(self.called_for) or "nothing beyond point lights",
            "left out": ", ".join(f"{name} ({cost.percent})" for name, cost in self.costs_left_out.items())
            or "nothing",
            "predicted cost": "\n".join(
                ["of the first rays", *(f"{name}: {cost}" for name, cost in self.costs.items())]
            ),
            "camera": _camera_words(self.scene.camera),
            "kernel files": ", ".join(self.parts),
            "numbers": str(len(self.numbers)),
            "picture": f"{settings.size[0]} x {settings.size[1]}, {settings.samples} samples a pixel, "
            f"{settings.filter} filter, seed {settings.seed}",
            "steps": f"at most {self.method.steps} a ray",
            "flow": self.method.flow_in(self.scene.geometry).words,
            "accuracy": "not asked for: the plain settings"
            if self.choice is None
            else FIT.format(self.choice.words),
            "tracer": _tracer_words(self.scene),
        }


def make_plan(
    scene: schema.Scene,
    *,
    device: Device | None = None,
    size: tuple[int, int] | None = None,
    channels: Collection[str] = (),
    method: Method | None = None,
    precision: str | None = None,
    accuracy: str | float | None = None,
    switch: bool | None = None,
) -> Plan:
    """Decide what a scene needs and write its program.

    Places things with the kernels of `device`, in double where it has that, whatever the precision of
    the picture. `size` and `method` (or `precision` and `accuracy`, of which the method follows) replace
    the scene's, `channels` are wanted beside those of the scene's outputs. `switch`: see `Writer`; for
    measurements only. Raises SceneError for what can only be seen here, such as a camera that no group
    element leads into the cell.
    """
    device = device or devices.choose()
    wanted = {channel for output in scene.outputs for channel in output.channels} | set(channels)
    geometry = for_few_points(scene.geometry, device)
    size = size or scene.render.size
    choice = None
    if method is None:
        method, choice = method_of(scene, device, size=size, precision=precision, accuracy=accuracy)
    numbers = Numbers([method.threshold, _far(scene), pixel_angle(scene.camera, size)])
    detail = None if scene.render.detail is None else numbers.add([scene.render.detail])
    error = numbers.add([flow_error(scene.geometry, method)]) if "error" in wanted else None
    place = Placement(geometry)
    cells, next_cell = _cells(scene, wanted)
    writer = Writer(scene, geometry, numbers, choose_near_walls(scene), cells, switch)
    camera = _camera(scene, place)

    tracer = tracer_of(scene).name
    writer.parts.add(f"march/{tracer}.h")
    if scene.render.start == "block":
        writer.parts.add("block_start.cl")
    if error is not None:
        writer.parts.add("error.h")
    object_images = write_objects(writer)
    write_tracer(writer, tracer)
    write_walls(writer)
    eyes = write_camera(writer, camera, size)
    objects = writer.text()
    light_images = write_lights(writer, camera)
    light = writer.text()
    write_air(writer)
    air = writer.text()
    write_seen(writer)
    if writer.cell_ids:
        writer.parts.add("cells.h")
    flow = method.flow_in(scene.geometry)
    generated = {
        **flow.generated,
        "scene objects": objects,
        "scene light": light,
        "scene air": air,
        "scene seen": writer.text(),
    }
    source = Source(
        _order(scene.geometry, flow, writer.parts),
        method.defines | _defines(writer, detail, error),
        generated,
    )
    return Plan(
        scene,
        source,
        eyes.buffers(np.array(numbers.values)),
        next_cell,
        # No buffer may be empty.
        np.array(writer.seen_from).ravel() if writer.seen_from else np.zeros(1),
        writer.texels.buffer(),
        writer.near_walls,
        object_images,
        light_images,
        tuple(writer.sequences),
        method,
        choice,
        writer.asked,
        writer.texels.digests,
    )


def _tracer_words(scene: schema.Scene) -> str:
    tracer, settings = tracer_of(scene), scene.render
    words = [f"{tracer.name}: {tracer.why}"]
    if settings.detail is not None:
        words.append(f"detail {settings.detail:g} pixels")
    if settings.start == "block":
        words.append("started by blocks of 4x4 pixels")
    return ", ".join(words)


def _camera_words(camera: schema.Camera) -> str:
    if camera.stereo is None:
        return camera.projection.kind
    return f"{camera.projection.kind}, stereo {camera.stereo.layout}, eyes {camera.stereo.distance:g} apart"


def _far(scene: schema.Scene) -> float:
    if scene.render.far is not None:
        return scene.render.far
    lattice = scene.lattice
    finite = lattice is not None and lattice.finite_volume
    return (FAR_IN_FINITE_CELL if finite else FAR)[scene.geometry]


def _camera(scene: schema.Scene, place: Placement) -> CameraFrame:
    try:
        camera = CameraFrame(scene.camera, place)
    except ValueError as error:
        raise scene.error_at(
            ("camera", "look"), str(error), "look elsewhere, or choose another up"
        ) from error
    if scene.lattice is not None and not camera.carry(scene.lattice):
        raise scene.error_at(
            ("camera",), "no group element leads the camera into the cell", "place it nearer to the origin"
        )
    return camera


def _cells(scene: schema.Scene, wanted: Collection[str]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """The cells (C,n,n) that rays keep track of and the cells behind their walls; of neither any where no
    channel and no light asks for it.
    """
    points = [light.point for light in scene.lights if light.point is not None]
    once = any(not point.repeated for point in points)
    if scene.lattice is None or not ("cell" in wanted or once):
        return np.zeros((0, 4, 4)), np.zeros((1, 1), np.int32)
    if isinstance(scene.lattice, Prism) and once:
        return cell_table(scene.lattice, LIT_CELLS, _far(scene))
    return cell_table(scene.lattice, CELL_TABLE)


def _defines(writer: Writer, detail: int | None, error: int | None) -> dict[str, str | int]:
    """The defines that effects, a round picture, a lattice and tracers take; `detail` and `error` are
    their places.
    """
    defines: dict[str, str | int] = {}
    if detail is not None:
        defines["DETAIL"] = detail
    if error is not None:
        defines["ERROR_CHANNEL"] = error
    if "march/compound.h" in writer.parts:
        defines["COMPONENTS"] = len(writer.scene.solids)
    if "block_start.cl" in writer.parts:
        defines["BLOCK_START"] = 1
    if "light/reflection.h" in writer.parts:
        defines["REFLECTIONS"] = 1
    if "light/sky.h" in writer.parts:
        defines["SKY"] = 1
    if needs_clearance(writer):
        defines["CLEARANCE"] = 1
    if writer.sequences:
        defines["PARTS"] = 1
    if "camera/fisheye.h" in writer.parts:
        defines["ROUND_PICTURE"] = 1
    if writer.lattice is not None:
        defines["IN_QUOTIENT"] = 1
        if writer.creeping:
            defines["CREEPING"] = 1
        if writer.cell_ids:
            defines |= {"WALLS": len(writer.lattice.walls), "CELLS": len(writer.cells)}
    return defines


def _order(geometry: str, flow: Flow, parts: Collection[str]) -> tuple[str, ...]:
    """All parts of a program in the order in which they need each other."""

    def under(*folders: str) -> list[str]:
        return sorted(part for part in parts if part.split("/")[0] in folders)

    before, after = effect_files.light_parts(parts)
    return (
        *geometry_parts(geometry),
        *flow.parts,
        "scene_types.h",
        *under("shape"),
        *krs_order(parts),
        *under("lane_integers.h"),
        # What several patterns call comes first.
        *sorted(under("pattern"), key=lambda part: part not in effect_files.PATTERN_SUPPORT),
        "march.h",
        # What a tracer calls comes first.
        *sorted(under("march"), key=lambda part: part != "march/stretch.h"),
        "march/loop.h",
        *under("cells.h"),
        # What each projection starts from, and then in the order of the alphabet.
        "camera/frame.h",
        *(part for part in under("camera") if part != "camera/frame.h"),
        "scene objects",
        *before,
        "scene light",
        "scene air",
        *after,
        "scene seen",
        *under("error.h"),
        "render.cl",
        *under("block_start.cl"),
    )
