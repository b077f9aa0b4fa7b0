"""OpenCL text for the light of a scene: its lights, the air between, what is seen where nothing is hit."""

import numpy as np
from numpy.typing import NDArray

from thurston_cl.lattice import Lattice, elements, neighbours
from thurston_cl.scene.placement import CameraFrame
from thurston_cl.scene.writer import Writer

Array = NDArray[np.float64]

# The lights of a scene that names none, a warm one and a cool one: how far to the right of the camera, up and
# forward they stand, and their colour times intensity. In the whole space they stand above; in a cell on
# opposite sides, at multiples of the distance u from its middle to the nearest wall, and their intensity is
# what arrives at distance u.
DEFAULT_LIGHTS = (
    ((0.5, 0.6, 0.0), (2.6, 2.1, 1.5)),
    ((-0.9, 0.4, 0.4), (0.4, 0.7, 1.2)),
)
DEFAULT_LIGHTS_IN_CELL = (
    ((0.5, 0.5, 0.3), (1.4, 0.77, 0.35)),
    ((-0.7, -0.25, 0.4), (0.26, 0.56, 1.4)),
)


def write_lights(writer: Writer, camera: CameraFrame) -> int:
    """One loop over the images of all lights that ask for the same: number of geodesics, shadows or none.

    Returns the number of images in all.
    """
    loops: dict[tuple[int, bool], list[float]] = {}
    for k, light in enumerate(writer.scene.lights):
        try:
            point = writer.place.point(light.point.at)
        except ValueError as error:
            raise writer.scene.error_at(("lights", k, "point", "at"), str(error)) from error
        color = np.array(light.point.color.linear) * light.point.intensity
        if writer.lattice is not None:
            carried, _, ok = writer.lattice.teleport(point[None])
            if not ok[0]:
                raise writer.scene.error_at(
                    ("lights", k, "point", "at"), "no group element leads this light into the cell"
                )
            point = carried[0]
        loop = loops.setdefault((light.point.geodesics, light.shadows == "hard"), [])
        for image in _images(writer.lattice, light.point.translates) @ point:
            loop += [*image, *color]
    if not writer.scene.lights:
        loops[(1, False)] = _default_lights(camera, writer)
    writer.parts.add("light/point.h")
    body = ["real3_lanes seen = phong_ambient(s);"]
    total = 0
    for (geodesics, shadowed), values in loops.items():
        count = len(values) // 7
        total += count
        place = writer.numbers.add(values)
        body += [
            f"for (int i = 0; i < {count}; i++) {{",
            f"  point light = four_numbers(scene, {place} + 7 * i);",
            f"  for (int k = 0; k < {geodesics}; k++) {{",
            "    arrival a = point_light(s, light, k);",
            "    a.lit &= counted;",
        ]
        if shadowed:
            writer.parts.add("light/hard_shadow.h")
            body.append("    a.lit &= NOT(hard_shadow(s, a, light, k, max_steps, scene, shadow_steps));")
        body += [
            f"    real3_lanes more = phong(s, a, three_numbers(scene, {place} + 7 * i + 4));",
            "    seen = add_scaled_3(seen, more, REAL(1));",
            "  }",
            "}",
        ]
    writer.function(
        "real3_lanes scene_light(shading s, mask counted, int max_steps, scene_data scene,"
        " real *shadow_steps)",
        [*body, "return seen;"],
    )
    return total


def _images(lattice: Lattice | None, translates: "int | str") -> Array:
    """The isometries (M,4,4) that carry a light to those of its images that count, nearest cells first."""
    if lattice is None:
        return np.eye(4)[None]
    if translates == "neighbours":
        return neighbours(lattice)
    return elements(lattice, count=int(translates))


def _default_lights(camera: CameraFrame, writer: Writer) -> list[float]:
    lights, unit, intensity = DEFAULT_LIGHTS, 1.0, 1.0
    if writer.lattice is not None:
        lights, unit = DEFAULT_LIGHTS_IN_CELL, writer.lattice.inradius
        intensity = float(writer.geometry.area_density([0.0, 0.0, 1.0], unit)[0])
    numbers: list[float] = []
    for offset, color in lights:
        towards = unit * np.array(offset) @ camera.frame
        length = float(np.linalg.norm(towards))
        point = writer.geometry.flow(towards / length, length, base=camera.point)[0][0]
        numbers += [*point, *(intensity * np.array(color))]
    return numbers


def write_air(writer: Writer) -> None:
    background = writer.numbers.add(writer.scene.background.linear)
    writer.function(
        "real3_lanes scene_background(scene_data scene)", [f"return three_numbers(scene, {background});"]
    )
    fog = writer.scene.effects.fog
    seen = "seen"
    if fog is not None:
        writer.parts.add("light/fog_exponential.h")
        place = writer.numbers.add([fog.exponential.density, *fog.exponential.color.linear])
        seen = f"fog_exponential(seen, t, scene, {place})"
    writer.function("real3_lanes scene_air(real3_lanes seen, real t, scene_data scene)", [f"return {seen};"])
