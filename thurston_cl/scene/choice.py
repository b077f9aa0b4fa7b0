"""From an accuracy that is asked for to the cheapest method that reaches it, by what was measured."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from thurston_cl.flows import ORDERS
from thurston_cl.method import PRECISIONS, Method
from thurston_cl.scene.measured import Row, measured
from thurston_cl.scene.pixel import half_pixels

if TYPE_CHECKING:
    from thurston_cl.device import Device
    from thurston_cl.scene.schema import Scene

# What words ask for, in halves of a pixel where the picture has its smallest.
WORDS = {"draft": 4.0, "half-pixel": 1.0, "quarter-pixel": 0.5}
# As exact as pictures get: a threshold far above the rounding of double precision, and steps enough for it.
REFERENCE = Method("double", threshold=1e-9, steps=20_000)
_EXACT_DOUBLE = {"precision": "double", "flow": "exact", "step": None}
# A row has to be so much better than what is asked for: errors of several settings add up, and no scene is
# one of the probes.
MARGIN = 2.0
# A row is taken instead of a plainer one only for so much less time: ratios are no surer than that.
WORTH = 0.95


@dataclass(frozen=True)
class Choice:
    """A method for a picture. requested: in the words of the scene. target: the angle that it means;
    estimated: that within which 99.9 % of the pixels are expected, both in radians. met: whether that is
    enough, with `MARGIN`. cost: the time that it takes as a multiple of that of the plain method.
    """

    requested: str
    target: float
    estimated: float
    met: bool
    cost: float
    method: Method

    @property
    def words(self) -> str:
        """The choice in words."""
        method = self.method
        how = (
            f"{method.precision} precision, {method.flow_in('e3').words} flow, threshold {method.threshold:g}"
        )
        bounds = [f"at most {method.steps} steps"]
        bounds += [f"{n} iterations of {what}" for what, n in self._iterations if n is not None]
        reached = f"{self.estimated:.2g} rad" if math.isfinite(self.estimated) else "unknown"
        outcome = f"estimated {reached}" + ("" if self.met else ", which is not reached")
        return (
            f"{self.requested}, {self.target:.2g} rad: {how}, {', '.join(bounds)}; {outcome}; "
            f"{self.cost:.2g} times the time of the plain method"
        )

    @property
    def _iterations(self) -> list[tuple[str, int | None]]:
        return [("Newton", self.method.newton), ("the AGM", self.method.agm)]

    @property
    def metadata(self) -> dict[str, Any]:
        """The choice for the metadata of a picture."""
        return {
            "requested": self.requested,
            "target": self.target,
            "estimated": self.estimated if math.isfinite(self.estimated) else None,
            "met": self.met,
        }


def method_of(
    scene: "Scene",
    device: "Device",
    *,
    size: tuple[int, int] | None = None,
    precision: str | None = None,
    accuracy: str | float | None = None,
) -> tuple[Method, Choice | None]:
    """How a scene is worked out on a device, and where an accuracy was asked for how that was chosen.

    size, accuracy: in place of the scene's; `accuracy` also in place of what else its settings say.
    precision: the only one that may be used.
    """
    asked = scene.render.accuracy if accuracy is None else accuracy
    if asked is None:
        return Method.of(scene, precision=precision), None
    has = PRECISIONS if device.info.fp64 else ("single",)
    choice = choose_method(scene, asked, has if precision is None else [precision], size)
    return choice.method, choice


def choose_method(
    scene: "Scene",
    requested: str | float,
    precisions: Iterable[str] = PRECISIONS,
    size: tuple[int, int] | None = None,
) -> Choice:
    """The cheapest method that reaches the accuracy, or where none does the most accurate one.

    requested: "half-pixel", "quarter-pixel" (half of that), "draft" (two pixels), "reference", or an angle in
    radians. precisions: those that may be used. size: of the picture, in place of the scene's.
    """
    half = float(half_pixels(scene.camera, size or scene.render.size, 0.0, 0.0))
    named = requested if isinstance(requested, str) else f"{requested:g} rad"
    allowed = list(precisions)
    if requested == "reference":
        return _reference(scene.geometry, named, allowed)
    target = WORDS[requested] * half if isinstance(requested, str) else requested
    choices = [_of_precision(scene.geometry, named, target, precision) for precision in allowed]
    met = [choice for choice in choices if choice.met]
    if met:
        return min(met, key=lambda choice: choice.cost)
    # Of equals the last, which is double precision.
    return min(reversed(choices), key=lambda choice: choice.estimated)


def flow_error(geometry: str, method: Method) -> float:
    """The angle within which a method follows geodesics, in radians: what was measured of its precision and
    flow; another step of a flow is taken for so much better or worse as its order says. Infinite where
    nothing is known.
    """
    known = [
        row
        for row in measured(geometry)["flows"]
        if row.settings["precision"] == method.precision
        and row.settings["flow"] == method.flow
        and row.reaches is not None
    ]
    if not known:
        return math.inf
    if method.step is None:
        return float(known[0].reaches or math.inf)
    step = method.step
    near = min(known, key=lambda row: abs(math.log(row.settings["step"] / step)))
    rounding = flow_error(geometry, Method(method.precision))
    return float(max((near.reaches or 0) * (step / near.settings["step"]) ** ORDERS[method.flow], rounding))


def _reference(geometry: str, named: str, precisions: Sequence[str]) -> Choice:
    """What is as exact as it gets; without double precision the most accurate of single."""
    if "double" in precisions:
        exact = max(flow_error(geometry, REFERENCE), REFERENCE.threshold)
        slow = [row.cost for row in measured(geometry)["flows"] if dict(row.settings) == _EXACT_DOUBLE]
        slow += [
            row.cost for row in measured(geometry)["thresholds"] if row.settings["precision"] == "double"
        ]
        return Choice(named, exact, exact, True, slow[0] * max(slow[1:]), REFERENCE)
    best = _of_precision(geometry, named, 0.0, "single")
    return Choice(named, REFERENCE.threshold, best.estimated, False, best.cost, best.method)


def _of_precision(geometry: str, named: str, target: float, precision: str) -> Choice:
    """The cheapest settings of one precision that reach the target each, or those that come nearest to it."""
    settings: dict[str, Any] = {}
    cost, estimated, reached = 1.0, 0.0, True
    for knob, rows in measured(geometry).items():
        fitting = [row for row in rows if row.settings.get("precision", precision) == precision]
        if not fitting:
            continue
        good = [row for row in fitting if row.reaches is not None and MARGIN * row.reaches <= target]
        row = _cheapest(good) if good else min(fitting, key=_by_accuracy)
        settings |= row.settings
        reached &= bool(good)
        # Newton's rows are timed in solves alone.
        cost *= 1.0 if knob == "newton" else row.cost
        estimated = max(estimated, math.inf if row.reaches is None else row.reaches)
    method = Method(**settings)
    return Choice(named, target, estimated, reached, cost, method)


def _cheapest(rows: Sequence[Row]) -> Row:
    """The first, which is the plainest, unless another is worth it."""
    best = min(rows, key=lambda row: row.cost)
    return best if best.cost <= WORTH * rows[0].cost else rows[0]


def _by_accuracy(row: Row) -> tuple[float, float]:
    return (math.inf if row.reaches is None else row.reaches, row.cost)
