"""The geometries by name: their families, their models and what their coordinates are."""

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", float, NDArray[np.float64])

ISOTROPIC = ("e3", "s3", "h3")
# In these every point lies on a line of its own, the fibre. Isometries keep the fibres, so that the vertical
# direction, along them, and the horizontal ones, across them, cannot be turned into each other.
PRODUCTS = ("s2xe", "h2xe")
TWISTED = ("nil", "sl2")
FIBRED = PRODUCTS + TWISTED
GEOMETRIES = (*ISOTROPIC, *FIBRED, "sol")
# Groups with a left-invariant metric: frames are carried by left translation.
LEFT_INVARIANT = (*TWISTED, "sol")

# Homogeneous coordinates, on which isometries are matrices: a fifth one, 1, where the fourth is not linear.
HOMOGENEOUS = dict.fromkeys(("e3", "s3", "h3", "nil", "sol"), 4) | dict.fromkeys(("s2xe", "h2xe", "sl2"), 5)
ORIGIN = {name: (0.0, 0.0, 0.0, 1.0) if n == 4 else (0.0, 0.0, 1.0, 0.0) for name, n in HOMOGENEOUS.items()}
# The coordinate along the fibre.
FIBRE = {"s2xe": 3, "h2xe": 3, "nil": 2, "sl2": 3}

# The equation of each model (paper, 7.1-7.3, 8.1, 9.2, 10.1, 11.1).
MODEL = {
    "e3": "w = 1",
    "s3": "x^2 + y^2 + z^2 + w^2 = 1",
    "h3": "w = sqrt(1 + x^2 + y^2 + z^2)",
    "s2xe": "x^2 + y^2 + z^2 = 1",
    "h2xe": "z = sqrt(1 + x^2 + y^2)",
    "nil": "w = 1",
    "sl2": "z = sqrt(1 + x^2 + y^2)",
    "sol": "w = 1",
}


def off_model(geometry: str, x: Number, y: Number, z: Number, w: Number) -> Number:
    """By how much coordinates, numbers or arrays, miss the equation of the model. On a hyperboloid relative
    to its height, since both sides are large far out.
    """
    match geometry:
        case "e3" | "nil" | "sol":
            return w - 1.0
        case "s3":
            return x * x + y * y + z * z + w * w - 1.0
        case "s2xe":
            return x * x + y * y + z * z - 1.0
        case "h2xe" | "sl2":
            height = (1.0 + x * x + y * y) ** 0.5
            return (z - height) / height
        case _:
            height = (1.0 + x * x + y * y + z * z) ** 0.5
            return (w - height) / height
