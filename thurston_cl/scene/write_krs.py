"""OpenCL text for kernel-reflection sequences: a function for the distance of each, and one for its
surface.
"""

import warnings
from collections.abc import Mapping

from thurston_cl.krs.program import sequence_parts
from thurston_cl.krs.record import clipping_in_words
from thurston_cl.krs.sequence import MoebiusSequence, Sequence
from thurston_cl.scene.krs import Krs
from thurston_cl.scene.krs_sequence import painted_sequence
from thurston_cl.scene.surfaces import Material
from thurston_cl.scene.values import Color
from thurston_cl.scene.writer import Named, Writer


def _names(
    krs: Krs, materials: tuple[Material, ...], named: Mapping[str, Material]
) -> tuple[str | None, ...]:
    """What kernels are made of, by their part, in words; None for what the object is made of."""
    if krs.recipe is not None:
        return (None, *(role.replace("_", "-") for role in krs.recipe.roles))
    known = {material: name for name, material in named.items()}
    return (None, *(known.get(material) or _look(material) for material in materials))


def _look(material: Material) -> str:
    return material.color.written if isinstance(material.color, Color) else "a pattern"


def _warnings(krs: Krs, sequence: Sequence | MoebiusSequence) -> tuple[str, ...]:
    """What is told of a sequence. Recipes mean what their mirrors clip."""
    if krs.recipe is not None or (krs.record is not None and krs.record.clips):
        return ()
    own = () if krs.record is None else krs.record.warnings
    return (*own, *clipping_in_words(sequence, lost=True))


def tells_free_balls(writer: Writer, krs: Krs) -> bool:
    """Whether a ball may be free of a sequence where its distance does not say so: balls are images of
    balls under Moebius maps, and of no others.
    """
    moebius = isinstance(painted_sequence(krs, writer.geometry).sequence, MoebiusSequence)
    return moebius and krs.twist is None and not krs.empty_zones


def write_krs(writer: Writer, krs: Krs, first_part: int) -> tuple[str, tuple[Material, ...]]:
    """Add the functions of a sequence whose own materials are the parts from `first_part` of its object.

    Returns the name they begin with, and the materials.
    """
    painted = painted_sequence(krs, writer.geometry)
    sequence, numbers = painted.sequence, writer.numbers
    for told in _warnings(krs, sequence):
        warnings.warn(f"sequence {len(writer.sequences) + 1}: {told}", stacklevel=2)
    writer.sequences.append(Named(sequence, _names(krs, painted.materials, writer.scene.materials)))
    writer.parts |= sequence_parts(sequence.geometry, sequence.name, sequence.kinds)
    name = f"krs_{len(writer.sequences)}"
    if krs.level_balls or not isinstance(sequence, MoebiusSequence):
        place = numbers.add(sequence.numbers)
    else:
        place = numbers.add(sequence.numbers_without_balls)
    kind = sequence.name
    distance, way = [f"real d = {kind}_distance(q, scene, {place});"], []
    surface = [f"surface s = {kind}_surface(q, scene, {place});"]
    if krs.twist is not None:
        writer.parts.add("krs/twist.h")
        radius = sequence.balls.reach_about_axis()
        twist = numbers.add([krs.twist.angle, radius])
        distance = [
            f"point y = twisted(q, scene, {twist});",
            f"real d = twist_bound({kind}_distance(y, scene, {place}), q, scene, {twist});",
        ]
        surface = [
            f"point y = twisted(q, scene, {twist});",
            f"surface s = {kind}_surface(y, scene, {place});",
            f"s.distance = twist_bound(s.distance, q, scene, {twist});",
            f"s.gradient = twist_back(s.gradient, q, y, scene, {twist});",
        ]
    clear = list(distance)
    if krs.empty_zones:
        writer.parts.add("krs/empty_zones.h")
        zones = numbers.add(number for zone in krs.empty_zones for number in (*zone.at, zone.radius))
        rest = f"scene, {zones}, {len(krs.empty_zones)});"
        way.append(f"d = way_through_zones(d, q, v, {rest}")
        clear.append(f"d = clear_of_zones(d, q, {rest}")
        surface.append(f"s = surface_left(s, q, {rest}")
        writer.along_rays.append(name)
    arguments = "point q, vector v, scene_data scene"
    writer.function(f"real {name}_distance({arguments})", [*distance, *way, "return d;"])
    if krs.empty_zones:
        writer.function(f"real {name}_clearance({arguments})", [*clear, "return d;"])
    if writer.scene.render.tracer == "binary" and tells_free_balls(writer, krs):
        writer.function(
            f"mask {name}_unbounding(point q, real radius, scene_data scene)",
            [f"return {kind}_unbounding(q, radius, scene, {place});"],
        )
    if first_part > 1 and painted.materials:
        # Part 0, what the object is made of, keeps its number.
        surface.append(f"s.part = SELECT(s.part > REAL(0), s.part + REAL({first_part - 1}), s.part);")
    writer.function(f"surface {name}_surface(point q, scene_data scene)", [*surface, "return s;"])
    return name, painted.materials
