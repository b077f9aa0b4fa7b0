"""The constant buffer of a scene, and the OpenCL text that reads from it."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

# The fifth homogeneous coordinate of a point.
ONE = "1"


class Numbers:
    """Collects the numbers of a scene and says where each stands.

    The generated text depends on which coefficients are 0 and +-1, which costs nothing to leave out, and on
    nothing else: two scenes that differ in other values share their program.
    """

    def __init__(self, first: Iterable[float]) -> None:
        self.values: list[float] = list(first)

    def add(self, values: Iterable[float]) -> int:
        """Append values; returns the place of the first."""
        place = len(self.values)
        self.values.extend(float(value) for value in values)
        return place

    def term(self, value: float) -> str:
        """The text of one number."""
        if value in (0.0, 1.0, -1.0):
            return f"REAL({int(value)})"
        return f"number(scene, {self.add([value])})"

    def linear(self, coefficients: Sequence[float] | NDArray[np.float64], variables: Sequence[str]) -> str:
        """The text of a linear form, without the terms that are 0; the variable ONE may stand last."""
        text = ""
        for coefficient, variable in reversed(list(zip(coefficients, variables, strict=True))):
            if coefficient == 0:
                continue
            if variable == ONE:
                text = self.term(coefficient)
            elif not text:
                text = {1.0: variable, -1.0: f"-{variable}"}.get(
                    float(coefficient), f"{self.term(coefficient)} * {variable}"
                )
            elif coefficient == 1:
                text = f"{variable} + {text}"
            elif coefficient == -1:
                text = f"{text} - {variable}"
            else:
                text = f"fma({self.term(coefficient)}, {variable}, {text})"
        return text or "REAL(0)"

    def rows(self, matrix: NDArray[np.float64], variables: Sequence[str]) -> str:
        """The text of a matrix times a vector, as an initialiser."""
        return "{" + ", ".join(self.linear(row, variables) for row in matrix) + "}"


def homogeneous(name: str, dimension: int) -> tuple[str, ...]:
    """The homogeneous coordinates of a point: its four components, and 1 where there are five."""
    return (*components(name), ONE)[:dimension]


def components(name: str) -> tuple[str, str, str, str]:
    """The four components of a point, vector or covector."""
    return (f"{name}.x", f"{name}.y", f"{name}.z", f"{name}.w")
