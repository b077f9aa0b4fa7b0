"""Where in and around a pixel its samples lie: a sequence that fills the square evenly, bent to a filter.

A filter is not a weight here: samples are placed as densely as it says and count alike (filter importance
sampling: Ernst, Stamminger and Greiner, "Filter Importance Sampling", IEEE Symposium on Interactive Ray
Tracing 2006; Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, 8.8).
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

Array = NDArray[np.float64]

# Roberts' R2 sequence: steps of the powers of 1/1.3247..., the plastic number.
PLASTIC = 1.32471795724474602596
SAMPLE_STEP = np.array([1 / PLASTIC, 1 / PLASTIC**2])
# What one seed more turns the sequence by (Cranley-Patterson rotation). No whole number of these steps is one
# of those above: the pictures of seeds 0, 1, 2, ... fill the pixel together.
SEED_STEP = np.sqrt([2.0, 3.0]) - 1.0

GAUSSIAN_DEVIATION = 0.5
GAUSSIAN_RADIUS = 1.5


def _box(u: Array) -> Array:
    return u


def _tent(u: Array) -> Array:
    near = np.minimum(u, 1 - u)
    return 0.5 + np.copysign(1 - np.sqrt(2 * near), u - 0.5)


def _gaussian(u: Array) -> Array:
    share = 2 * ndtr(GAUSSIAN_RADIUS / GAUSSIAN_DEVIATION) - 1
    return 0.5 + GAUSSIAN_DEVIATION * ndtri(0.5 + (u - 0.5) * share)


# The inverse of each filter's distribution, from [0, 1) to pixels from the corner.
FILTERS: dict[str, Callable[[Array], Array]] = {"box": _box, "tent": _tent, "gaussian": _gaussian}


def sample_shifts(count: int, reconstruction: str = "box", seed: int = 0) -> Array:
    """Where the samples of a pixel lie, (count, 2) in pixels from its top left corner.

    Along both axes: `box` keeps to the pixel, evenly; `tent` reaches one pixel from the middle and falls to 0
    there; `gaussian` has the standard deviation 0.5 and is cut off at 1.5. The first sample of seed 0 is in
    the middle.
    """
    steps = np.arange(count)[:, None] * SAMPLE_STEP
    return FILTERS[reconstruction]((0.5 + seed * SEED_STEP + steps) % 1.0)
