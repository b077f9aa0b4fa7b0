"""What every recipe of a kernel-reflection sequence has: words for its parameters, and the model they
give.
"""

import math
from collections.abc import Mapping
from typing import Any, ClassVar

from annotated_types import Gt
from pydantic import AfterValidator

from .base import Node, problem
from .surfaces import Material


class Recipe(Node):
    """A kernel-reflection sequence made from a few parameters."""

    # The fields that hold materials: kernel entry "mat" k of the record is painted with the k-th.
    roles: ClassVar[tuple[str, ...]] = ()
    # Where it is made.
    geometries: ClassVar[tuple[str, ...]] = ("e3",)

    def record(self) -> Mapping[str, Any]:
        """The model as `thurston_cl.krs.Model.from_dict` takes it."""
        raise NotImplementedError

    @classmethod
    def lengths(cls) -> list[str]:
        """The keys that make it larger or smaller."""
        return [
            key
            for key, name in cls.keys().items()
            if any(isinstance(m, Gt) for m in cls.model_fields[name].metadata)
        ]

    @property
    def materials(self) -> tuple[Material, ...]:
        """The materials, in the order of `roles`."""
        return tuple(getattr(self, role) for role in self.roles)


def within(low: float, high: float) -> AfterValidator:
    """A validator of angles in radians, of bounds in degrees."""

    def check(angle: float) -> float:
        degrees = math.degrees(angle)
        # An angle in degrees is rounded.
        if not low - 1e-9 <= degrees <= high + 1e-9:
            raise problem(f"expected an angle from {low:g} to {high:g} deg; this is {degrees:.10g} deg")
        return angle

    return AfterValidator(check)
