"""The ways to follow geodesics: by the closed form, or by an integrator of the geodesic equation."""

import math
from dataclasses import dataclass

from thurston_cl.models import GEOMETRIES, ISOTROPIC, PRODUCTS

# Each integrator with its order.
ORDERS = {"euler": 1, "rk2": 2, "rk4": 4, "rk8": 8}
FLOWS = ("exact", *ORDERS)
# The geodesic equation as systems of first order, by the left-invariant frame where there is one; or in the
# coordinates of the model, of second order.
EQUATIONS = ("left-invariant", "coordinates")
# The step where only the integrator is named: with rk4 the paper's for pictures (appendix A).
DEFAULT_STEP = 0.1


@dataclass(frozen=True)
class Flow:
    """How to follow geodesics in one geometry.

    name: "exact", "euler", "rk2" (midpoint rule), "rk4" (classical) or "rk8" (Cooper and Verner). step: the
    longest step of an integrator in units of length, None for the exact flow. equation: what is integrated;
    "coordinates" exists in nil. Raises ValueError.
    """

    geometry: str
    name: str = "exact"
    step: float | None = None
    equation: str = "left-invariant"

    def __post_init__(self) -> None:
        if self.geometry not in GEOMETRIES:
            raise ValueError(f"unknown geometry {self.geometry!r}; expected one of: {', '.join(GEOMETRIES)}")
        if self.name not in FLOWS:
            raise ValueError(f"unknown flow {self.name!r}; expected one of: {', '.join(FLOWS)}")
        if self.equation not in EQUATIONS:
            raise ValueError(f"unknown equation {self.equation!r}; expected one of: {', '.join(EQUATIONS)}")
        if self.equation == "coordinates" and (self.geometry != "nil" or self.name == "exact"):
            raise ValueError("equation='coordinates' is for the integrators in nil")
        if self.name == "exact":
            if self.step is not None:
                raise ValueError(f"step={self.step} is for the integrators: {', '.join(ORDERS)}")
        elif self.step is None:
            raise ValueError(f"flow={self.name!r} needs a step, for example step={DEFAULT_STEP}")
        elif not 0 < self.step < math.inf:
            raise ValueError(f"step={self.step}; expected a number over 0")

    @property
    def parts(self) -> tuple[str, ...]:
        """The kernel files, after those of the geometry, that give flow_from_origin and ray_flow."""
        if self.name == "exact":
            return ("flow/exact.h",)
        ambient = self.geometry in (*ISOTROPIC, *PRODUCTS)
        return (
            "flow/motion.h",
            f"flow/field_{self._field}.h",
            f"flow/{self.name}.h",
            "flow step",
            "flow/steps.h",
            f"flow/{'from_anywhere' if ambient else 'from_origin'}.h",
        )

    @property
    def generated(self) -> dict[str, str]:
        """The text of what is not a file of `parts`."""
        return {} if self.step is None else {"flow step": f"#define FLOW_STEP C({float(self.step)!r})"}

    @property
    def words(self) -> str:
        """The flow in words."""
        if self.step is None:
            return self.name
        return f"{self.name} in steps of {self.step:g}"

    @property
    def _field(self) -> str:
        if self.equation == "coordinates":
            return "nil_coordinates"
        if self.geometry in ISOTROPIC:
            return "isotropic"
        if self.geometry in PRODUCTS:
            return "product"
        return "sl2" if self.geometry == "sl2" else "left_invariant"
