"""From an accuracy that is asked for to the cheapest method that reaches it, by what was measured."""

import dataclasses
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from thurston_cl.device import PRECISIONS
from thurston_cl.flows import ORDERS
from thurston_cl.method import Method
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
# So many pixels may be farther off than what was asked for.
MISSED = 0.001
# Nearer than this single precision does not bring rays to a surface.
FINEST_SINGLE = 1e-6
# What the estimate of a pixel is at most: that of rays that may be anywhere.
HALF_TURN = math.pi * (1 - 1e-6)
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
        reached = f"{self.estimated:.3g} rad" if math.isfinite(self.estimated) else "unknown"
        outcome = f"estimated {reached}" + ("" if self.met else ", which is not enough to be sure of it")
        return (
            f"{self._asked}: {how}, {', '.join(bounds)}; {outcome}; "
            f"{self.cost:.2g} times the time of the plain method"
        )

    @property
    def _asked(self) -> str:
        """What was asked for, in words."""
        angle = f"{self.target:.3g} rad"
        return angle if angle == self.requested else f"{self.requested}, {angle}"

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
            "words": self.words,
        }


@dataclass(frozen=True)
class Glance:
    """What is known of a picture by some of its pixels, or all. grazing: the angle that rays which graze a
    surface may be off by, at 99.9 % of the pixels or less. spent: the share of rays that are out of steps
    where that can be seen.
    """

    grazing: float
    spent: float

    @classmethod
    def of(cls, errors: NDArray[np.floating], flow: float, spent: float) -> "Glance":
        """From the channel `error` of a picture; `flow` is what is alike in it for all rays."""
        known = errors[errors < HALF_TURN]
        grazing = float(np.quantile(known, 1 - MISSED, method="higher")) - flow if known.size else 0.0
        return cls(max(grazing, 0.0), spent)


def fitted(choice: Choice, geometry: str, glance: Glance) -> Choice:
    """The choice with a smaller threshold where things stand nearer to the eye than in the probes, and with
    more steps where rays ran out of them.
    """
    method = choice.method
    most = choice.target / MARGIN
    if glance.grazing > most and choice.requested != "reference":
        finest = min(
            row.settings["threshold"]
            for row in measured(geometry)["thresholds"]
            if row.settings["precision"] == method.precision and row.reaches is not None
        )
        # In single precision rays do not come much nearer than rounding.
        finest = max(finest, FINEST_SINGLE) if method.precision == "single" else finest
        nearer = max(method.threshold * most / glance.grazing, finest)
        method = dataclasses.replace(method, threshold=min(nearer, method.threshold))
    if glance.spent > MISSED / 2:
        method = dataclasses.replace(method, steps=min(4 * method.steps, REFERENCE.steps))
    return dataclasses.replace(choice, method=method)


def achieved(choice: Choice, glance: Glance) -> Choice:
    """The choice with what the finished picture says of it."""
    estimated = max(choice.estimated, glance.grazing)
    if choice.requested == "reference":
        estimated = choice.estimated
    good = choice.met and estimated <= choice.target and glance.spent <= MISSED
    return dataclasses.replace(choice, estimated=estimated, met=good)


def with_accuracy(scene: "Scene", accuracy: str | float | None) -> "Scene":
    """The scene where an accuracy is asked for beside what it says: all of it counts then, and no `detail` is
    left out.
    """
    if accuracy is None or scene.render.detail is None:
        return scene
    return scene.model_copy(update={"render": scene.render.model_copy(update={"detail": None})})


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
