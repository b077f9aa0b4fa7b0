"""What a scene calls for: the kernel files, the generated text and the numbers that one program needs, and
no more.
"""

from collections.abc import Collection
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from thurston_cl import device as devices
from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.lattice import Lattice, cell_table
from thurston_cl.program import Source, geometry_parts
from thurston_cl.scene import schema
from thurston_cl.scene.emit import (
    Solids,
    light_images,
    write_material,
    write_outside,
    write_teleport,
    write_wall_time,
)
from thurston_cl.scene.numbers import Numbers
from thurston_cl.scene.placement import CameraFrame, Placement

# How far a ray goes where the scene does not say. In h3 without a lattice, coordinates grow like e^t and
# single precision has no digits left beyond this; in a cell they stay small. In s3 a ray is back where it
# began.
FAR = {"e3": 100.0, "s3": 2 * np.pi, "h3": 15.0}
FAR_IN_QUOTIENT = {"e3": 100.0, "s3": 2 * np.pi, "h3": 40.0}

# Cells with a number of their own; those farther away share the last. 4096 numbers fit half of a second-level
# cache.
CELL_TABLE = 4096

# The light of a scene that names none stands beside the camera: so far to the right, up and behind it.
HEAD_LIGHT = {"right": 0.25, "up": 0.35, "forward": -0.1}

EFFECT_FILES = {
    "hard shadows": "light/hard_shadow.h",
    "exponential fog": "light/fog_exponential.h",
    "checker": "pattern/checker.h",
    "grid": "pattern/grid.h",
    "cell ids": "cells.h",
}


@dataclass
class Plan:
    """One program for one scene, with its numbers. `numbers` and `next_cell` fill the kernels' buffers."""

    scene: schema.Scene
    geometry: str
    lattice: Lattice | None
    source: Source
    numbers: NDArray[np.float64]
    next_cell: NDArray[np.int32]
    distance: str
    lights: int
    light_images: int
    cells: int
    warnings: list[str] = field(default_factory=list)

    @property
    def parts(self) -> tuple[str, ...]:
        """The kernel files that are pasted, in order, with the generated parts between them."""
        return self.source.parts

    @property
    def left_out(self) -> list[str]:
        """Effects that exist, and that this scene does not name: their files are not in the source."""
        return [effect for effect, file in EFFECT_FILES.items() if file not in self.parts]

    @property
    def called_for(self) -> list[str]:
        """Effects that this scene names."""
        return [effect for effect, file in EFFECT_FILES.items() if file in self.parts]

    def explain(self) -> dict[str, str]:
        """What the scene calls for and what is left out, in the order in which to say it."""
        settings = self.scene.render
        quotient = (
            "the whole space"
            if self.lattice is None
            else f"{self.lattice.name}, {len(self.lattice.walls)} walls"
        )
        shapes = sorted(
            {
                part.split("/")[1].removesuffix(".h").replace("_", " ")
                for part in self.parts
                if part.startswith("shape/")
            }
        )
        return {
            "geometry": self.geometry,
            "space": quotient,
            "objects": f"{len(self.scene.objects)}, made of: {', '.join(shapes)}",
            "distance near walls": self.distance,
            "lights": f"{self.lights}, with {self.light_images} images in all",
            "called for": ", ".join(self.called_for) or "nothing beyond point lights",
            "left out": ", ".join(self.left_out) or "nothing",
            "kernel files": ", ".join(self.parts),
            "numbers": str(len(self.numbers)),
            "picture": f"{settings.size[0]} x {settings.size[1]}, {settings.samples} samples a pixel",
            "steps": f"at most {settings.steps} a ray",
        }


def make_plan(
    scene: schema.Scene,
    *,
    device: Device | None = None,
    size: tuple[int, int] | None = None,
    channels: Collection[str] = (),
) -> Plan:
    """Decide what a scene needs and write its program.

    Places things with the kernels of `device`, in double where it has that, whatever the precision of the
    picture. `size` replaces the scene's, `channels` are wanted beside those of the scene's outputs. Raises
    SceneError for what can only be seen here, such as a camera that no group element leads into the cell.
    """
    device = device or devices.choose()
    wanted = {channel for output in scene.outputs for channel in output.channels} | set(channels)
    return _Planner(scene, device, size or scene.render.size, "cell" in wanted).plan()


class _Planner:
    def __init__(self, scene: schema.Scene, device: Device, size: tuple[int, int], cell_ids: bool) -> None:
        self.scene = scene
        self.size = size
        precision = "double" if device.info.fp64 else "single"
        self.geometry = Geometry(scene.geometry, precision, device)
        self.place = Placement(self.geometry)
        self.lattice = scene.lattice
        self.cells = cell_ids and self.lattice is not None
        default_far = FAR if self.lattice is None else FAR_IN_QUOTIENT
        self.numbers = Numbers([scene.render.threshold, scene.render.far or default_far[scene.geometry]])
        self.parts: set[str] = set()
        self.text: list[str] = []
        self.distance = self._distance_choice()

    def plan(self) -> Plan:
        lattice, scene = self.lattice, self.scene
        self._write_walls()
        self._write_objects()
        self._write_camera()
        before = self.text
        self.text = []
        lights, images = self._write_lights()
        self._write_air()
        defines: dict[str, str | int] = {}
        next_cell = np.zeros((1, 1), np.int32)
        if lattice is not None:
            defines["IN_QUOTIENT"] = 1
            if self.distance in ("creeping", "both"):
                defines["CREEPING"] = 1
            if self.cells:
                _, next_cell = cell_table(lattice, CELL_TABLE)
                defines |= {"WALLS": len(lattice.walls), "CELLS": len(next_cell)}
                self.parts.add("cells.h")
        source = Source(
            (
                *geometry_parts(scene.geometry),
                "scene_types.h",
                *sorted(part for part in self.parts if part.split("/")[0] in ("shape", "pattern")),
                "march.h",
                *(["cells.h"] if self.cells else []),
                *sorted(part for part in self.parts if part.startswith("camera/")),
                "scene objects",
                "light/phong.h",
                *sorted((part for part in self.parts if part.startswith("light/")), reverse=True),
                "scene light",
                "render.cl",
            ),
            defines,
            {"scene objects": "\n".join(before), "scene light": "\n".join(self.text)},
        )
        return Plan(
            scene,
            scene.geometry,
            lattice,
            source,
            np.array(self.numbers.values),
            next_cell,
            self.distance,
            lights,
            images,
            len(next_cell) if self.cells else 0,
        )

    def _function(self, head: str, body: list[str]) -> None:
        self.text += [f"FN {head}", "{", *(f"  {line}" for line in body), "}"]

    # Walls

    def _write_walls(self) -> None:
        if self.lattice is None:
            return
        self._function(
            "mask outside_cell(point p, scene_data scene)", write_outside(self.lattice, self.numbers)
        )
        self._function(
            "void teleport(ray *r, scene_data scene)", write_teleport(self.lattice, self.numbers, self.cells)
        )
        if self.distance in ("creeping", "both"):
            self._function(
                "real wall_time(point p, vector v, scene_data scene)",
                write_wall_time(self.lattice, self.numbers),
            )

    def _distance_choice(self) -> str:
        """How distance is measured near walls (paper 4.2), where the scene leaves it to us.

        A hollow that is symmetric under the walls bounds the distance to the solid beyond them too, so the
        cell's own distance will do. Objects inside the cell need creeping. Whatever crosses a wall needs the
        neighbours as well.
        """
        if self.lattice is None:
            return "whole space"
        if self.scene.render.distance != "auto":
            return self.scene.render.distance
        if all(self._symmetric_hollow(solid) for solid in self.scene.objects) and self.lattice.is_dirichlet:
            return "domain"
        return "creeping" if all(self._in_cell(solid, np.eye(4)) for solid in self.scene.objects) else "both"

    def _symmetric_hollow(self, solid: schema.Solid) -> bool:
        if solid.at != (0.0, 0.0, 0.0):
            return False
        match solid.kind:
            case "tile":
                return True
            case "complement":
                return solid.shape.kind == "ball" and solid.shape.at == (0.0, 0.0, 0.0)
            case "intersection":
                return all(self._symmetric_hollow(member) for member in solid.shape)
            case _:
                return False

    def _in_cell(self, solid: schema.Solid, outer: NDArray[np.float64]) -> bool:
        assert self.lattice is not None
        if self._symmetric_hollow(solid) and self.lattice.is_dirichlet:
            return True
        frame = outer @ self.place.isometry(solid.at, solid.rotate)
        match solid.kind:
            case "ball":
                return bool(self.lattice.clearance(frame[None, :, 3])[0] >= solid.shape.radius)
            case "union":
                return all(self._in_cell(member, frame) for member in solid.shape)
            case "intersection":
                return any(self._in_cell(member, frame) for member in solid.shape)
            case "difference":
                return self._in_cell(solid.shape[0], frame)
            case _:
                return False

    # Objects

    def _write_objects(self) -> None:
        solids = Solids(self.numbers, self.place, self.lattice, self.parts)
        distances = []
        surfaces = ["surface s;", "mask nearer;"]
        for k, solid in enumerate(self.scene.objects, start=1):
            self._check_tile(solid, ("objects", k - 1))
            distance, lines, name = solids.write(solid, np.eye(4))
            self._function(f"real object_{k}_distance(point p, scene_data scene)", [f"return {distance};"])
            self._function(
                f"surface object_{k}_surface(point p, scene_data scene)", [*lines, f"return {name};"]
            )
            material = write_material(solid.material, self.numbers, self.parts, "s")
            self._function(
                f"material object_{k}_material(surface s, scene_data scene)",
                [f"material m = {material};", "return m;"],
            )
            distances.append(f"object_{k}_distance(p, scene)")
            surfaces += [
                f"s = object_{k}_surface(p, scene);",
                "nearer = s.distance < best->distance;",
                "*best = nearer_of(s, *best, nearer);",
                f"*object = SELECT(nearer, REAL({k}), *object);",
                f"*m = select_material(nearer, object_{k}_material(s, scene), *m);",
            ]
        total = distances[0]
        for distance in distances[1:]:
            total = f"fmin({total}, {distance})"
        self._function("real cell_distance(point p, scene_data scene)", [f"return {total};"])
        self._function(
            "void cell_surface(point p, surface *best, real *object, material *m, scene_data scene)", surfaces
        )
        self._write_neighbours()

    def _write_neighbours(self) -> None:
        """The distance and the surface seen from a point: of the cell alone, or also of the cells behind its
        walls.
        """
        distance = ["real distance = cell_distance(p, scene);"]
        surface = [
            "surface best = {REAL(INFINITY), {REAL(0), REAL(0), REAL(0), REAL(1)}, REAL(0), REAL(0)};",
            "material none = {{REAL(0), REAL(0), REAL(0)}, REAL(0), REAL(0), REAL(0), REAL(0)};",
            "*object = REAL(0);",
            "*m = none;",
            "cell_surface(p, &best, object, m, scene);",
        ]
        if self.distance in ("neighbours", "both"):
            assert self.lattice is not None
            maps, count = self.numbers.add(self.lattice.maps.ravel()), len(self.lattice.maps)
            loop = f"for (int wall = 0; wall < {count}; wall++) {{"
            distance += [
                loop,
                f"  distance = fmin(distance, cell_distance(apply(scene, {maps} + 16 * wall, p), scene));",
                "}",
            ]
            surface += [
                "real seen_from = *cell;" if self.cells else "",
                loop,
                "  surface there = best;",
                f"  cell_surface(apply(scene, {maps} + 16 * wall, p), &there, object, m, scene);",
                "  mask nearer = there.distance < best.distance;",
                f"  there.gradient = pull_back(scene, {maps} + 16 * wall, there.gradient);",
                "  best = nearer_of(there, best, nearer);",
                "  *cell = SELECT(nearer, cell_behind(seen_from, nearer, wall, scene), *cell);"
                if self.cells
                else "",
                "}",
            ]
        self._function("real scene_distance(point p, scene_data scene)", [*distance, "return distance;"])
        self._function(
            "void scene_surface(point p, real *object, real *cell, covector *gradient, material *m,"
            " scene_data scene)",
            [*(line for line in surface if line), "*gradient = best.gradient;"],
        )

    def _check_tile(self, solid: schema.Solid, location: tuple[str | int, ...]) -> None:
        """Balls about vertices need vertices that are points of the space."""
        shape = solid.shape
        if solid.kind == "tile" and shape.vertices is not None:
            assert self.lattice is not None
            kinds = {vertex.kind for vertex in self.lattice.polyhedron.vertices} - {"finite"}
            if kinds:
                raise self.scene.error_at(
                    (*location, "tile", "vertices"),
                    f"the vertices of {self.lattice.name} are {' and '.join(sorted(kinds))}: no ball has its "
                    "centre there",
                    "leave vertices out",
                )
        members = shape if isinstance(shape, tuple) else (shape,) if isinstance(shape, schema.Solid) else ()
        for k, member in enumerate(members):
            self._check_tile(
                member, (*location, solid.kind, k) if isinstance(shape, tuple) else (*location, solid.kind)
            )

    # Camera

    def _write_camera(self) -> None:
        camera = CameraFrame(self.scene.camera, self.place)
        if self.lattice is not None and not camera.carry(self.lattice):
            raise self.scene.error_at(
                ("camera",),
                "no group element leads the camera into the cell",
                "place it nearer to the origin",
            )
        self.camera = camera
        half_height = float(np.tan(0.5 * self.scene.camera.fov))
        place = self.numbers.add([*camera.point, *camera.frame.ravel(), half_height, *self.size])
        self.parts.add("camera/perspective.h")
        self._function(
            "ray view_ray(real x, real y, scene_data scene)",
            [
                f"point p = four_numbers(scene, {place});",
                f"return new_ray(p, push(p, perspective(x, y, scene, {place})));",
            ],
        )

    # Light

    def _write_lights(self) -> tuple[int, int]:
        """One loop over the images of all lights that ask for the same: number of geodesics, shadows or
        none.
        """
        loops: dict[tuple[int, bool], list[float]] = {}
        for k, light in enumerate(self.scene.lights):
            point = self.place.point(light.point.at)
            color = np.array(light.point.color.linear) * light.point.intensity
            if self.lattice is not None:
                carried, _, ok = self.lattice.teleport(point[None])
                if not ok[0]:
                    raise self.scene.error_at(
                        ("lights", k, "point", "at"), "no group element leads this light into the cell"
                    )
                point = carried[0]
            images = light_images(self.lattice, light.point.translates) @ point
            loop = loops.setdefault((light.point.geodesics, light.shadows == "hard"), [])
            for image in images:
                loop += [*image, *color]
        if not self.scene.lights:
            loops[(1, False)] = [*self._head_light(), 1.0, 1.0, 1.0]
        self.parts.add("light/point.h")
        body = ["real3_lanes seen = phong_ambient(s);"]
        total = 0
        for (geodesics, shadowed), values in loops.items():
            count = len(values) // 7
            total += count
            place = self.numbers.add(values)
            body += [
                f"for (int i = 0; i < {count}; i++) {{",
                f"  point light = four_numbers(scene, {place} + 7 * i);",
                f"  for (int k = 0; k < {geodesics}; k++) {{",
                "    arrival a = point_light(s, light, k);",
                "    a.lit &= counted;",
            ]
            if shadowed:
                self.parts.add("light/hard_shadow.h")
                body.append("    a.lit &= NOT(hard_shadow(s, a, light, k, max_steps, scene, shadow_steps));")
            body += [
                f"    real3_lanes more = phong(s, a, three_numbers(scene, {place} + 7 * i + 4));",
                "    seen = add_scaled_3(seen, more, REAL(1));",
                "  }",
                "}",
            ]
        self._function(
            "real3_lanes scene_light(shading s, mask counted, int max_steps, scene_data scene,"
            " real *shadow_steps)",
            [*body, "return seen;"],
        )
        return max(1, len(self.scene.lights)), total

    def _head_light(self) -> NDArray[np.float64]:
        right, up, forward = self.camera.frame
        offset = HEAD_LIGHT["right"] * right + HEAD_LIGHT["up"] * up + HEAD_LIGHT["forward"] * forward
        length = float(np.linalg.norm(offset))
        return self.geometry.flow(offset / length, length, base=self.camera.point)[0][0]

    def _write_air(self) -> None:
        background = self.numbers.add(self.scene.background.linear)
        self._function(
            "real3_lanes scene_background(scene_data scene)", [f"return three_numbers(scene, {background});"]
        )
        fog = self.scene.effects.fog
        seen = "seen"
        if fog is not None:
            self.parts.add("light/fog_exponential.h")
            place = self.numbers.add([fog.exponential.density, *fog.exponential.color.linear])
            seen = f"fog_exponential(seen, t, scene, {place})"
        self._function(
            "real3_lanes scene_air(real3_lanes seen, real t, scene_data scene)", [f"return {seen};"]
        )
