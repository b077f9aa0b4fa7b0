"""What effects are expected to cost, as a share of marching the first rays: from what a scene asks for at
each surface point, and from unit costs that `make bench` measures. Scenes differ: expect a factor of two.
"""

from collections.abc import Mapping
from dataclasses import dataclass

# Steps of a ray until it ends: a first ray, one to a light, a mirrored one. Medians over the scene library.
FIRST_STEPS, SHADOW_STEPS, MIRRORED_STEPS = 22.0, 12.0, 16.0
# The share of surface points that face a light, whose shadow is looked for.
FACING = 0.6
# Ambient occlusion in steps: short flows, and a distance at the end of each.
OCCLUSION = 0.8
# By geometry, in steps: one geodesic to a light with Phong's formula, and the area density at its end.
LIGHT = {"e3": 1.2, "s3": 0.8, "h3": 1.1, "s2xe": 0.5, "h2xe": 0.6, "nil": 0.8, "sl2": 1.0, "sol": 3.0}
AREA = {"e3": 0.1, "s3": 0.3, "h3": 0.1, "s2xe": 0.2, "h2xe": 0.1, "nil": 0.1, "sl2": 0.1, "sol": 4.7}
# The surface at two more places, in steps, for the beam of a pixel on an image.
FOOTPRINT = 2.0
# How many geodesics are solved for where all up to a length count.
GEODESICS_WITHIN = 3
# What is a few operations for each surface point.
LITTLE = 0.05


@dataclass(frozen=True)
class Cost:
    """What an effect does, how often at each surface point, and its cost as a share of the first rays."""

    work: str
    count: float
    share: float

    def __str__(self) -> str:
        percent = 100 * self.share
        return f"{f'about {percent:.0f} %' if percent >= 1 else 'under 1 %'} ({self.work}: {self.count:.3g})"


def predict(geometry: str, asked: Mapping[str, float]) -> dict[str, Cost]:
    """The costs by kernel file; `asked` has, by file, how often a surface point calls for it."""
    costs = {}
    for file, count in asked.items():
        match file:
            case "light/point.h":
                work, steps = "geodesics to lights", LIGHT[geometry]
            case "light/falloff_area.h":
                work, steps = "area densities", AREA[geometry]
            case "light/hard_shadow.h" | "light/soft_shadow.h":
                work, steps = "shadow rays", FACING * (SHADOW_STEPS + LIGHT[geometry])
            case "light/ambient_occlusion.h":
                work, steps = "looks along the normal", OCCLUSION
            case "light/reflection.h":
                work, steps = "mirrored rays", MIRRORED_STEPS
            case "pattern/image.h":
                work, steps = "footprints", FOOTPRINT + AREA[geometry]
            case _:
                work, steps = "evaluations", LITTLE
        costs[file] = Cost(work, count, count * steps / FIRST_STEPS)
    return costs
