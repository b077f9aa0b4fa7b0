"""How the rays of a picture are worked out: arithmetic, flow, and where marching ends."""

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from thurston_cl.device import PRECISIONS
from thurston_cl.flows import DEFAULT_STEP, Flow

if TYPE_CHECKING:
    from thurston_cl.scene.schema import Scene


@dataclass(frozen=True)
class Method:
    """What accuracy and time of a picture depend on, beside what is in it.

    precision: "single" or "double". flow, step: see `thurston_cl.flows.Flow`. threshold: a ray has hit
    what is nearer than this. steps: the most that a ray may take. newton, agm: the most iterations of
    any solve and of the arithmetic-geometric mean, None for as many as the precision can use. Raises
    ValueError for unknown names.
    """

    precision: str = "single"
    flow: str = "exact"
    step: float | None = None
    threshold: float = 1e-4
    steps: int = 300
    newton: int | None = None
    agm: int | None = None

    def __post_init__(self) -> None:
        if self.precision not in PRECISIONS:
            raise ValueError(
                f"unknown precision {self.precision!r}; expected one of: {', '.join(PRECISIONS)}"
            )
        Flow("e3", self.flow, self.step)

    @classmethod
    def of(cls, scene: "Scene", **changes: Any) -> "Method":
        """What the settings of a scene say, with `changes`, of which None changes nothing."""
        settings = scene.render
        longest = None if settings.flow == "exact" else settings.flow_step or DEFAULT_STEP
        says = cls(
            "single" if settings.precision == "auto" else settings.precision,
            settings.flow,
            longest,
            settings.threshold,
            settings.steps,
        )
        return dataclasses.replace(says, **{k: v for k, v in changes.items() if v is not None})

    @property
    def defines(self) -> dict[str, str | int]:
        """The defines of a program that bound its iterations."""
        bounds = {"NEWTON_BOUND": self.newton, "AGM_STEPS": self.agm}
        return {name: bound for name, bound in bounds.items() if bound is not None}

    def flow_in(self, geometry: str) -> Flow:
        """The flow in a geometry."""
        return Flow(geometry, self.flow, self.step)
