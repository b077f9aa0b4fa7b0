"""What every recipe of a kernel-reflection sequence has: words for its parameters, and the model they
give.
"""

from collections.abc import Mapping
from typing import Any, ClassVar

from .base import Node
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

    @property
    def materials(self) -> tuple[Material, ...]:
        """The materials, in the order of `roles`."""
        return tuple(getattr(self, role) for role in self.roles)
