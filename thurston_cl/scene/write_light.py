"""OpenCL text for the light of a scene: its lights, the air between, what is seen where nothing is hit."""

import numpy as np
from numpy.typing import NDArray

from thurston_cl.geometry import Geometry
from thurston_cl.lattice import Lattice, elements
from thurston_cl.scene.placement import CameraFrame
from thurston_cl.scene.writer import Writer

Array = NDArray[np.float64]

# The light of a scene that names none stands beside the camera: so far to the right, up and behind it.
HEAD_LIGHT = {"right": 0.25, "up": 0.35, "forward": -0.1}


def write_lights(writer: Writer, camera: CameraFrame) -> int:
    """One loop over the images of all lights that ask for the same: number of geodesics, shadows or
    none.
    """
    loops: dict[tuple[int, bool], list[float]] = {}
    for k, light in enumerate(writer.scene.lights):
        point = writer.place.point(light.point.at)
        color = np.array(light.point.color.linear) * light.point.intensity
        if writer.lattice is not None:
            carried, _, ok = writer.lattice.teleport(point[None])
            if not ok[0]:
                raise writer.scene.error_at(
                    ("lights", k, "point", "at"), "no group element leads this light into the cell"
                )
            point = carried[0]
        images = _images(writer.lattice, light.point.translates) @ point
        loop = loops.setdefault((light.point.geodesics, light.shadows == "hard"), [])
        for image in images:
            loop += [*image, *color]
    if not writer.scene.lights:
        loops[(1, False)] = [*_head_light(camera, writer.geometry), 1.0, 1.0, 1.0]
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
        return np.concatenate([np.eye(4)[None], lattice.inverses])
    return elements(lattice, count=int(translates))


def _head_light(camera: CameraFrame, geometry: Geometry) -> NDArray[np.float64]:
    right, up, forward = camera.frame
    offset = HEAD_LIGHT["right"] * right + HEAD_LIGHT["up"] * up + HEAD_LIGHT["forward"] * forward
    length = float(np.linalg.norm(offset))
    return geometry.flow(offset / length, length, base=camera.point)[0][0]


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
