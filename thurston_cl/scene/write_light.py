"""OpenCL text for the light of a scene: its lights, the air between, what is seen where nothing is hit."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thurston_cl.lattice import Lattice, elements, neighbours
from thurston_cl.lattice.isometry import act, inverse
from thurston_cl.scene import schema
from thurston_cl.scene.cost import GEODESICS_WITHIN
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
    within: float | None = None
    direction: str = "geodesic"
    shadows: schema.Shadows | None = None
    falloff: str = "area"
    repeated: bool = True


@dataclass(frozen=True)
class _Image:
    """One image of a point light: its point (4,), its colour times intensity, the number of its ball or 0."""

    point: Array
    color: Array
    lamp: int = 0


def write_lights(writer: Writer, camera: CameraFrame) -> int:
    """Add scene_light: a loop over the images of all point lights that ask for the same, and over the suns.

    Returns the number of images in all.
    """
    scene, loops = writer.scene, dict[_Asked, list[_Image]]()
    lamps = dict(zip(scene.lamps, range(len(scene.objects) + 1, len(scene.solids) + 1), strict=True))
    for k, light in enumerate(scene.lights):
        point = light.point
        if point is None:
            continue
        asked = _Asked(
            point.most_geodesics, point.within, point.direction, light.shadows, point.falloff, point.repeated
        )
        color = np.array(point.color.linear) * point.intensity
        try:
            where = writer.place.point(point.at)
        except ValueError as error:
            raise scene.error_at(("lights", k, "point", "at"), str(error)) from error
        images = where[None]
        if writer.lattice is not None and point.repeated:
            carried, _, ok = writer.lattice.teleport(where[None])
            if not ok[0]:
                raise scene.error_at(
                    ("lights", k, "point", "at"), "no group element leads this light into the cell"
                )
            images = _images(writer.lattice, point.translates, carried[0])
        loops.setdefault(asked, []).extend(_Image(image, color, lamps.get(k, 0)) for image in images)
    if not scene.lights:
        loops[_Asked(usual_geodesics(writer.geometry.name))] = _default_lights(camera, writer)
    body = _ambient(writer)
    for asked, images_of in loops.items():
        body += _loop(writer, camera, asked, images_of)
    suns = [light for light in scene.lights if light.sun is not None]
    for light in suns:
        body += _sun(writer, light)
    writer.function(
        "void scene_light(const shading *at, mask counted, int max_steps, scene_data scene, work *total,"
        " real3_lanes *lit)",
        # Copies stay in registers.
        ["shading s = *at;", "work sum = *total, *done = &sum;", *body, "*total = sum;", "*lit = seen;"],
        called=writer.large,
    )
    return len(suns) + sum(len(images_of) for images_of in loops.values())


def _ambient(writer: Writer) -> list[str]:
    """Lines that begin with the light from everywhere."""
    lines = ["real3_lanes seen = phong_ambient(s);"]
    occlusion = writer.scene.effects.ambient_occlusion
    if occlusion is not None:
        place = writer.numbers.add([occlusion.reach, occlusion.strength])
        # Lamps glow by themselves.
        lit = "counted"
        if writer.scene.lamps:
            lit += f" & NOT(s.object > REAL({len(writer.scene.objects)}))"
        left = f"ambient_occlusion(s, {lit}, scene, {place}, done)"
        lines += writer.effect("light/ambient_occlusion.h", [f"seen = scale_3(seen, {left});"])
        # Each distance looks at more images than that of a ray.
        writer.asked["light/ambient_occlusion.h"] *= max(1.0, writer.clearances / writer.distances)
    return lines


def _loop(writer: Writer, camera: CameraFrame, asked: _Asked, lights: Sequence[_Image]) -> list[str]:
    """Lines that add the light of `lights`."""
    known = ""
    own = [[*light.color, light.lamp] if _skips(asked, lights) else [*light.color] for light in lights]
    if asked.repeated or writer.lattice is None:
        place = writer.numbers.add(
            number for light, more in zip(lights, own, strict=True) for number in (*light.point, *more)
        )
        size, color = 4 + len(own[0]), place + 4
        light = f"point light = four_numbers(scene, {place} + {size} * i);"
    else:
        # Seen from each cell a light stands elsewhere; what the camera was carried by, it is carried by too.
        cells, first = inverse(writer.lattice.geometry, writer.cells), len(writer.seen_from)
        for image in lights:
            writer.seen_from.append(act(writer.lattice.geometry, cells, camera.carry_along(image.point)))
        size, color = len(own[0]), writer.numbers.add(number for more in own for number in more)
        light, known = f"point light = seen_from_cell(s.cell, {first} + i, &known, scene);", " & known"
    straight = asked.direction == "straight"
    falloff, count = f"falloff_{asked.falloff.replace('-', '_')}", len(lights)
    if not straight:
        count *= asked.geodesics if asked.within is None else GEODESICS_WITHIN
    for part in (f"light/{'direction_field' if straight else 'point'}.h", f"light/{falloff}.h"):
        writer.parts.add(part)
        writer.asked[part] += count
    # Along all geodesics up to a length a lane is done with the first that is longer.
    counted = f"counted{known}" if asked.within is None else "left"
    lines = [f"arrival a = direction_field(s, light, {counted});"]
    if not straight:
        lines = [f"arrival a = point_light(s, light, k, {counted}, done);"]
    if asked.within is not None:
        writer.parts.add("light/within.h")
        writer.asked["light/within.h"] += len(lights)
        most = f"number(scene, {writer.numbers.add([asked.within])})"
        lines += [
            f"mask arrives = left & arrives_within(a, {most});",
            "if (!ANY(arrives)) break;",
            "a.lit &= arrives;",
            f"left &= goes_on(a, {most});",
        ]
    lines.append(f"a.intensity = {falloff}(a);")
    fog = writer.scene.effects.fog
    if fog is not None and fog.on_lights:
        lines += writer.effect("light/light_in_fog.h", ["a.intensity = light_in_fog(a, scene);"], count)
    if asked.shadows is not None:
        others = "scene"
        if _skips(asked, lights):
            others, lamp = "others", f"(int)scene.numbers[{color + 3} + {size} * i]"
            lines += ["scene_data others = scene;", f"others.skipped = {lamp};"]
        writer.parts.add("light/shadow_to_light.h")
        towards = "towards_light(s, &a, light, k, scene, done)"
        lines += _shadow(writer, asked.shadows, towards, others, count)
    lines += _seen(f"{color} + {size} * i")
    if not straight:
        lines = [f"for (int k = 0; k < {asked.geodesics}; k++) {{", *(f"  {line}" for line in lines), "}"]
    if asked.within is not None:
        lines.insert(0, f"mask left = counted{known};")
    return [
        f"for (int i = 0; i < {len(lights)}; i++) {{",
        *(["  mask known;"] if known else []),
        f"  {light}",
        *(f"  {line}" for line in lines),
        "}",
    ]


def _skips(asked: _Asked, lights: Sequence[_Image]) -> bool:
    """Whether there is a ball that must not shade its own light."""
    return asked.shadows is not None and any(light.lamp for light in lights)


def _sun(writer: Writer, light: schema.Light) -> list[str]:
    """Lines that add the light of a sun."""
    assert light.sun is not None
    writer.parts.add("light/sun.h")
    writer.asked["light/sun.h"] += 1
    place = writer.numbers.add(
        [*light.sun.towards, *(light.sun.intensity * c for c in light.sun.color.linear)]
    )
    lines = [f"arrival a = sun(s, three_numbers(scene, {place}), counted);"]
    if light.shadows is not None:
        writer.parts.add("light/shadow_to_sun.h")
        lines += _shadow(writer, light.shadows, "towards_sun(s, &a, scene)", "scene", 1)
    return ["{", *(f"  {line}" for line in (*lines, *_seen(f"{place + 3}"))), "}"]


def _shadow(writer: Writer, shadows: schema.Shadows, towards: str, scene: str, count: int) -> list[str]:
    """Lines that shade the arrival `a`; `towards`: the ray to its source, `scene`: what it may meet."""
    writer.parts |= {"light/lifted_ray.h", "light/shadow_ray.h"}
    lines = [f"shadow_ray q = {towards};"]
    if shadows.soft is None:
        cast = f"hard_shadow(q, &a, max_steps, {scene}, done);"
        return writer.effect("light/hard_shadow.h", [*lines, cast], count)
    sharpness = f"number(scene, {writer.numbers.add([shadows.soft.sharpness])})"
    cast = f"soft_shadow(q, &a, {sharpness}, max_steps, {scene}, done);"
    return writer.effect("light/soft_shadow.h", [*lines, cast], count)


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


def _default_lights(camera: CameraFrame, writer: Writer) -> list[_Image]:
    lights, unit, intensity, lattice = DEFAULT_LIGHTS, 1.0, 1.0, writer.lattice
    if lattice is not None:
        lights, unit = DEFAULT_LIGHTS_IN_CELL, lattice.inradius
        intensity = float(writer.geometry.area_density([0.0, 0.0, 1.0], unit)[0])
        # What comes round the sphere adds to it.
        intensity /= usual_geodesics(writer.geometry.name)
    placed: list[_Image] = []
    for offset, color in lights:
        towards = unit * np.array(offset) @ camera.frame
        length = float(np.linalg.norm(towards))
        point = writer.geometry.flow(towards / length, length, base=camera.point)[0][0]
        images, strength = point[None], intensity
        if lattice is not None and not lattice.is_dirichlet and placed:
            # A ray sees in its cell what belongs to the neighbours too: the cool light fills it from there.
            images = _images(lattice, "neighbours", lattice.teleport(point[None])[0][0])
            strength *= FILL
        placed += [_Image(image, strength * np.array(color)) for image in images]
    return placed


def write_air(writer: Writer) -> None:
    """Add scene_background, scene_clear and scene_air: what is seen where nothing is hit, and fog; and where
    there is a sky, scene_under_sky. The plain color of that, for what comes to nothing, is its horizon's.
    """
    sky = writer.scene.sky
    background = writer.numbers.add(writer.scene.plain_background.linear)
    writer.function(
        "real3_lanes scene_background(scene_data scene)", [f"return three_numbers(scene, {background});"]
    )
    if sky is not None:
        writer.parts.add("light/sky.h")
        up = np.array(sky.up) / np.linalg.norm(sky.up)
        ground = sky.horizon if sky.ground is None else sky.ground
        place = writer.numbers.add([*sky.zenith.linear, *sky.horizon.linear, *ground.linear, *up])
        writer.function(
            "real3_lanes scene_under_sky(ray r, real3_lanes seen, scene_data scene)",
            [f"return select_3(r.hit, seen, sky(r.p, r.v, scene, {place}));"],
        )
    fog = writer.scene.effects.fog
    clear, air = ["return REAL(1);"], ["return seen;"]
    if fog is not None:
        kind, amount, color = fog.law
        place = writer.numbers.add([amount, *color.linear])
        writer.parts.add("light/fog.h")
        foggy = writer.effect(f"light/fog_{kind}.h", [f"return fog_{kind}(length, scene, {place});"])
        clear = foggy if writer.switch is None else [*foggy, *clear]
        air = [f"return in_fog(seen, left, three_numbers(scene, {place + 1}));"]
    writer.function("real scene_clear(real length, scene_data scene)", clear)
    writer.function("real3_lanes scene_air(real3_lanes seen, real left, scene_data scene)", air)


def write_seen(writer: Writer) -> None:
    """Add scene_seen: what a ray shows that has ended."""
    writer.parts.add("light/look.h")
    body = [
        "*first = look_at(r, r.t, max_steps, scene, done);",
        "return scene_air(first->color, scene_clear(SELECT(r.hit, r.t, REAL(INFINITY)), scene), scene);",
    ]
    if writer.scene.sky is not None:
        body = [
            "*first = look_at(r, r.t, max_steps, scene, done);",
            "first->color = scene_under_sky(r, first->color, scene);",
            # Behind everything is no fog.
            "return scene_air(first->color, scene_clear(SELECT(r.hit, r.t, REAL(0)), scene), scene);",
        ]
    if writer.reflections:
        writer.parts |= {"light/lifted_ray.h", "light/reflection.h"}
        # Of what is seen in a mirror, half may be a mirror again.
        writer.asked["light/reflection.h"] = 2 - 2.0 ** (1 - writer.reflections)
        # A number, so that scenes that differ in it share their program; 0 in a program that has it off.
        depth = writer.numbers.add([0 if writer.switch is False else writer.reflections])
        arguments = f"r, first, (int)scene.numbers[{depth}], max_steps, scene, done"
        body = [f"return seen_with_reflections({arguments});"]
    writer.function(
        "real3_lanes scene_seen(ray r, look *first, int max_steps, scene_data scene, work *done)", body
    )
