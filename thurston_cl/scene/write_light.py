"""OpenCL text for the light of a scene: its lights, the air between, what is seen where nothing is hit."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thurston_cl.lattice import Lattice, elements, neighbours
from thurston_cl.lattice.isometry import act, inverse
from thurston_cl.scene import schema
from thurston_cl.scene.lights import usual_geodesics
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

# What the cool light gives where its images in the cells around shine along.
FILL = 0.4


@dataclass(frozen=True)
class _Asked:
    """What a light asks for. Lights that ask for the same share a loop."""

    geodesics: int
    direction: str = "geodesic"
    shadowed: bool = False
    falloff: str = "area"
    repeated: bool = True


def write_lights(writer: Writer, camera: CameraFrame) -> int:
    """Add scene_light: a loop over the images of all point lights that ask for the same, and over the suns.

    Returns the number of images in all.
    """
    loops: dict[_Asked, list[tuple[Array, Array]]] = {}
    for k, light in enumerate(writer.scene.lights):
        point, shadowed = light.point, light.shadows == "hard"
        if point is None:
            continue
        asked = _Asked(point.geodesics, point.direction, shadowed, point.falloff, point.repeated)
        color = np.array(point.color.linear) * point.intensity
        try:
            where = writer.place.point(point.at)
        except ValueError as error:
            raise writer.scene.error_at(("lights", k, "point", "at"), str(error)) from error
        images = where[None]
        if writer.lattice is not None and point.repeated:
            carried, _, ok = writer.lattice.teleport(where[None])
            if not ok[0]:
                raise writer.scene.error_at(
                    ("lights", k, "point", "at"), "no group element leads this light into the cell"
                )
            images = _images(writer.lattice, point.translates, carried[0])
        loops.setdefault(asked, []).extend((image, color) for image in images)
    if not writer.scene.lights:
        loops[_Asked(usual_geodesics(writer.geometry.name))] = _default_lights(camera, writer)
    body = ["real3_lanes seen = phong_ambient(s);"]
    for asked, images_of in loops.items():
        body += _loop(writer, camera, asked, images_of)
    suns = [light for light in writer.scene.lights if light.sun is not None]
    for light in suns:
        body += _sun(writer, light)
    writer.function(
        "real3_lanes scene_light(shading s, mask counted, int max_steps, scene_data scene,"
        " real *shadow_steps)",
        [*body, "return seen;"],
    )
    return len(suns) + sum(len(images_of) for images_of in loops.values())


def _loop(
    writer: Writer, camera: CameraFrame, asked: _Asked, lights: Sequence[tuple[Array, Array]]
) -> list[str]:
    """Lines that add the light of `lights`, each a point (4,) and its colour times intensity."""
    known = ""
    if asked.repeated or writer.lattice is None:
        size, place = 7, writer.numbers.add(number for light in lights for number in np.concatenate(light))
        color = place + 4
        light = f"point light = four_numbers(scene, {place} + 7 * i);"
    else:
        # Seen from each cell a light stands elsewhere; what the camera was carried by, it is carried by too.
        cells, first = inverse(writer.lattice.geometry, writer.cells), len(writer.seen_from)
        for point, _ in lights:
            writer.seen_from.append(act(writer.lattice.geometry, cells, camera.carry_along(point)))
        size, color = 3, writer.numbers.add(number for _, light_color in lights for number in light_color)
        light, known = f"point light = seen_from_cell(s.cell, {first} + i, &known, scene);", " & known"
    straight = asked.direction == "straight"
    writer.parts |= {
        f"light/{'direction_field' if straight else 'point'}.h",
        f"light/falloff_{asked.falloff}.h",
    }
    lines = [
        f"arrival a = {'direction_field(s, light)' if straight else 'point_light(s, light, k)'};",
        f"a.lit &= counted{known};",
        f"a.intensity = falloff_{asked.falloff}(a);",
    ]
    if asked.shadowed:
        writer.parts.add("light/hard_shadow.h")
        lines.append("hard_shadow(s, &a, light, k, max_steps, scene, shadow_steps);")
    lines += _seen(f"{color} + {size} * i")
    if not straight:
        lines = [f"for (int k = 0; k < {asked.geodesics}; k++) {{", *(f"  {line}" for line in lines), "}"]
    return [
        f"for (int i = 0; i < {len(lights)}; i++) {{",
        *(["  mask known;"] if known else []),
        f"  {light}",
        *(f"  {line}" for line in lines),
        "}",
    ]


def _sun(writer: Writer, light: schema.Light) -> list[str]:
    """Lines that add the light of a sun."""
    assert light.sun is not None
    writer.parts.add("light/sun.h")
    place = writer.numbers.add(
        [*light.sun.towards, *(light.sun.intensity * c for c in light.sun.color.linear)]
    )
    lines = [f"arrival a = sun(s, three_numbers(scene, {place}));", "a.lit &= counted;"]
    if light.shadows == "hard":
        writer.parts.add("light/hard_shadow.h")
        lines.append("sun_shadow(s, &a, max_steps, scene, shadow_steps);")
    return ["{", *(f"  {line}" for line in (*lines, *_seen(f"{place + 3}"))), "}"]


def _seen(color: str) -> list[str]:
    """Lines that add what arrives in the color at this place of the numbers."""
    return [
        f"real3_lanes more = phong(s, a, three_numbers(scene, {color}));",
        "seen = add_scaled_3(seen, more, REAL(1));",
    ]


def _images(lattice: Lattice, translates: "int | str", point: Array) -> Array:
    """The images (M,4) of a light at `point` (4,) that count, those of the nearest cells first."""
    found = neighbours(lattice) if translates == "neighbours" else elements(lattice, count=int(translates))
    return act(lattice.geometry, found, point)


def _default_lights(camera: CameraFrame, writer: Writer) -> list[tuple[Array, Array]]:
    lights, unit, intensity, lattice = DEFAULT_LIGHTS, 1.0, 1.0, writer.lattice
    if lattice is not None:
        lights, unit = DEFAULT_LIGHTS_IN_CELL, lattice.inradius
        intensity = float(writer.geometry.area_density([0.0, 0.0, 1.0], unit)[0])
        # What comes round the sphere adds to it.
        intensity /= usual_geodesics(writer.geometry.name)
    placed: list[tuple[Array, Array]] = []
    for offset, color in lights:
        towards = unit * np.array(offset) @ camera.frame
        length = float(np.linalg.norm(towards))
        point = writer.geometry.flow(towards / length, length, base=camera.point)[0][0]
        images, strength = point[None], intensity
        if lattice is not None and not lattice.is_dirichlet and placed:
            # A ray sees in its cell what belongs to the neighbours too: the cool light fills it from there.
            images = _images(lattice, "neighbours", lattice.teleport(point[None])[0][0])
            strength *= FILL
        placed += [(image, strength * np.array(color)) for image in images]
    return placed


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
