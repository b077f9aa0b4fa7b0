"""What effects are expected to cost, as a share of marching the first rays: from what a scene asks for at
each surface point, and from unit costs; `make bench` measures those of lights. Expect a factor of two.
"""

from collections.abc import Mapping
from dataclasses import dataclass

# Medians over the library's scenes of what `thurston render --json` counts: the steps of a first ray; for
# each surface point those of a shadow ray, which it sends out if it faces the light, and of a mirrored ray.
FIRST_STEPS, SHADOW_STEPS, MIRRORED_STEPS = 17.0, 18.0, 18.0
# Ambient occlusion in steps: short flows, and a distance at the end of each.
OCCLUSION = 0.8
# By geometry, in steps: one geodesic to a light with Phong's formula, and the area density at its end.
LIGHT = {"e3": 1.2, "s3": 0.8, "h3": 1.1, "s2xe": 0.5, "h2xe": 0.6, "nil": 0.8, "sl2": 1.0, "sol": 3.0}
AREA = {"e3": 0.1, "s3": 0.3, "h3": 0.1, "s2xe": 0.2, "h2xe": 0.1, "nil": 0.1, "sl2": 0.1, "sol": 4.7}
# The surface at two more places, in steps, for the beam of a pixel on an image.
FOOTPRINT = 2.0
# One octave of noise, in steps.
OCTAVE = 0.6
# Looking up the cell at every wall, in steps of a first ray all together.
CELLS = 3.0
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

    @property
    def percent(self) -> str:
        """The share in words."""
        return f"about {100 * self.share:.0f} %" if self.share >= 0.01 else "under 1 %"

    def __str__(self) -> str:
        return f"{self.percent} ({self.work}: {self.count:.3g})"


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
                work, steps = "shadow rays", SHADOW_STEPS + LIGHT[geometry]
            case "light/ambient_occlusion.h":
                work, steps = "looks along the normal", OCCLUSION
            case "light/reflection.h":
                work, steps = "mirrored rays if all one sees is a mirror", MIRRORED_STEPS
            case "pattern/image.h":
                work, steps = "footprints", FOOTPRINT + AREA[geometry]
            case "pattern/noise.h":
                work, steps = "octaves", OCTAVE
            case "light/within.h":
                work, steps = "lights", (GEODESICS_WITHIN - 1) * LIGHT[geometry]
            case "cells.h":
                work, steps = "cells of a ray", CELLS
            case _:
                work, steps = "evaluations", LITTLE
        costs[file] = Cost(work, count, count * steps / FIRST_STEPS)
    return costs
