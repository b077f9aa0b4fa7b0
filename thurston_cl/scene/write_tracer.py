"""OpenCL text for tracers that ask for more than the distance to the scene."""

import numpy as np

from thurston_cl.krs.bounds import Balls
from thurston_cl.lattice.isometry import identity
from thurston_cl.scene import schema
from thurston_cl.scene.near_walls import bounds_of
from thurston_cl.scene.writer import Writer


def write_tracer(writer: Writer, name: str) -> None:
    """Add what kernels/march/`name`.h asks for, from the functions that `write_objects` added."""
    if name == "compound":
        _write_component(writer)
    elif name == "binary":
        _write_unbounding(writer)


def _write_component(writer: Writer) -> None:
    """scene_component: the distance to the k-th object, from 0; every lane asks for the same."""
    numbers = range(1, len(writer.scene.solids) + 1)
    body = [
        "switch (k) {",
        *(f"  case {k - 1}: return object_{k}_distance(p, v, scene);" for k in numbers[:-1]),
        f"  default: return object_{numbers[-1]}_distance(p, v, scene);",
        "}",
    ]
    writer.function("real scene_component(int k, point p, vector v, scene_data scene)", body)
    writer.parts.add("march/stretch.h")
    lines = ["switch (k) {"]
    for k, solid in enumerate(writer.scene.solids):
        ball = _ball(writer, solid)
        if ball is not None:
            lines.append(f"  case {k}: return stretch_in_ball(r, scene, {writer.numbers.add(ball)});")
    lines += ["  default: return everywhere();", "}"]
    writer.function("stretch scene_stretch(int k, ray r, scene_data scene)", lines)


def _ball(writer: Writer, solid: schema.Solid) -> list[float] | None:
    """Center and radius of a ball that holds a solid of e3, where one does."""
    bounds = bounds_of(solid, identity("e3"), writer.place) if writer.geometry.name == "e3" else None
    if not bounds:
        return None
    centers = np.array([bound.centre[:3] for bound in bounds])
    center, radius = Balls(centers, np.array([bound.radius for bound in bounds])).enclosing()
    return [*center, radius]


def _write_unbounding(writer: Writer) -> None:
    """scene_unbounding: whether a ball is free of all objects but a lamp whose light is traced."""
    body = ["mask clear = radius == radius;"]
    for k, _ in enumerate(writer.scene.solids, start=1):
        writer.function(
            f"mask object_{k}_unbounding(point p, real radius, scene_data scene)",
            ["vector v = {REAL(0), REAL(0), REAL(0), REAL(0)};", f"return {writer.free[k]};"],
        )
        asked = f"clear &= object_{k}_unbounding(c, radius, scene);"
        body.append(asked if k <= len(writer.scene.objects) else f"if (scene.skipped != {k}) {asked}")
    writer.function("mask scene_unbounding(point c, real radius, scene_data scene)", [*body, "return clear;"])
