"""What each method costs in a scene and how wrong its picture is, with threshold and step limit as further
knobs (`thurston accuracy SCENE`).
"""

import dataclasses
import math
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from thurston_cl.accuracy.pictures import PERCENTILES, all_places, compare
from thurston_cl.accuracy.rays import ExactRays, Rays
from thurston_cl.device import PRECISIONS, Device
from thurston_cl.method import Method
from thurston_cl.rendering import TileRenderer, tiles
from thurston_cl.sampling import sample_shifts
from thurston_cl.scene import schema
from thurston_cl.scene.choice import MISSED, method_of
from thurston_cl.scene.picture import Size, views
from thurston_cl.scene.plan import make_plan

# At a step of 0.1 the rule of order 8 is as exact as rounding; a finer one only adds to that.
FLOW_STEPS = {"euler": (0.1, 0.01), "rk2": (0.1, 0.01), "rk4": (0.1, 0.01), "rk8": (0.1,)}
THRESHOLDS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
STEP_LIMITS = (50, 100, 200, 300, 600)

# A picture is good where no more of its pixels are over half a pixel off.
GOOD = MISSED
# A method that is not so much cheaper than another is no better: timings differ by as much.
WORTH = 0.05
# Pictures are timed so often, in turn with the scene's own, at least and at most, as the seconds allow: a
# device that others use as well is not as fast from one moment to the next.
RUNS = (3, 15)
MOST_SECONDS = 2.0


@dataclass(frozen=True)
class Row:
    """One method: `knob` is what of it differs from the scene's own, "own" for that; seconds on the device
    for one sample of each pixel, and how much of the scene's own those are. The rest is of
    `thurston_cl.accuracy.pictures.Errors`: fractions of the pixels, and percentiles of errors, None where
    nothing is hit; angles in radians and pixels.
    """

    knob: str
    method: Method
    seconds: float
    relative: float
    ids_differ: float
    over_half_pixel: float
    nan: float
    out_of_steps: float
    angle: dict[str, float] | None
    angle_pixels: dict[str, float] | None
    depth: dict[str, float] | None
    relative_depth: dict[str, float] | None

    @property
    def flat(self) -> dict[str, Any]:
        """All of it under plain names, those of percentiles such as angle_99.9; None where there is none."""
        values: dict[str, Any] = {"knob": self.knob, **dataclasses.asdict(self.method)}
        for field in dataclasses.fields(self)[2:]:
            value = getattr(self, field.name)
            if field.name in ("angle", "angle_pixels", "depth", "relative_depth"):
                values |= {f"{field.name}_{name}": value and value[name] for name in PERCENTILES}
            else:
                values[field.name] = value
        return values


def candidates(scene: schema.Scene, own: Method) -> list[tuple[str, Method]]:
    """The methods to try, each once, with the knob that each turns; first the scene's own.

    In e3 the integrators follow straight lines exactly and are left out.
    """
    found = [("own", own)]
    flows: list[tuple[str, float | None]] = [("exact", None)]
    if scene.geometry != "e3":
        flows += [(flow, step) for flow, steps in FLOW_STEPS.items() for step in steps]
    for precision in PRECISIONS:
        for flow, step in flows:
            found.append(("method", dataclasses.replace(own, precision=precision, flow=flow, step=step)))
    exact = dataclasses.replace(own, flow="exact", step=None)
    for precision in PRECISIONS:
        for threshold in THRESHOLDS:
            found.append(("threshold", dataclasses.replace(exact, precision=precision, threshold=threshold)))
    found += [("steps", dataclasses.replace(own, steps=steps)) for steps in STEP_LIMITS]
    unique: dict[Method, str] = {}
    for knob, method in found:
        unique.setdefault(method, knob)
    return [(knob, method) for method, knob in unique.items()]


def measure(
    scene: schema.Scene,
    device: Device,
    size: Size | None = None,
    progress: Callable[[int, int, str], None] | None = None,
    methods: Sequence[tuple[str, Method]] | None = None,
) -> Iterator[Row]:
    """Measure `candidates` one after another; the first of them is what the others are relative to.

    size: of the picture, the scene's where it is None. progress: called with (done, total, what comes next).
    Raises SceneError as rendering does, NoDeviceError where the device has no double precision.
    """
    methods = candidates(scene, method_of(scene, device, size=size)[0]) if methods is None else methods
    say = progress or (lambda done, total, coming: None)
    say(0, len(methods), "the truth")
    exact = ExactRays(scene, device, size)
    places = all_places(scene, size)
    truth = exact.trace(places)
    own: _Timed | None = None
    plain = 0.0
    for k, (knob, method) in enumerate(methods):
        say(k, len(methods), name(method))
        timed = _Timed(scene, method, device, size)
        own = timed if own is None else own
        seconds, relative = _time_beside(timed, own)
        # Every time by the one ruler: the machine may be slower by now.
        plain = seconds if own is timed else plain
        seconds = relative * plain
        rays = Rays(scene, method, device, size)
        found = compare(rays, exact, places, rays.trace(places), truth).summary
        names = [field.name for field in dataclasses.fields(Row)[4:]]
        yield Row(knob, method, seconds, relative, *(found[key] for key in names))
    say(len(methods), len(methods), "")


class _Timed:
    """A picture of one sample a pixel, by one method, over and over."""

    def __init__(self, scene: schema.Scene, method: Method, device: Device, size: Size | None) -> None:
        size = size or scene.render.size
        plan = make_plan(scene, device=device, size=size, method=method)
        lanes = device.info.lane_width(method.precision)
        self._renderer = TileRenderer(plan, device, lanes, scene.render.finish)
        self._views = list(views(scene.camera.layout, size, (0, 0, *size)))
        self._shifts = sample_shifts(1, scene.render.filter, scene.render.seed)
        # The first run builds the kernels, and finds out how rays are best finished.
        self.run()

    def run(self) -> float:
        """Seconds that the device takes for the picture."""
        before = self._renderer.kernel_seconds
        for view in self._views:
            self._renderer.look_through(view.eye)
            for tile in tiles(view.area, self._renderer.side):
                self._renderer.run(tile, self._shifts, ())
        return self._renderer.kernel_seconds - before


def _time_beside(timed: _Timed, own: _Timed) -> tuple[float, float]:
    """The median of some runs, and that of their ratios to the scene's own method, taken in turn."""
    started = time.perf_counter()
    found: list[float] = []
    ratios: list[float] = []
    least, most = RUNS
    while len(found) < least or (len(found) < most and time.perf_counter() - started < MOST_SECONDS):
        found.append(timed.run())
        ratios.append(1.0 if own is timed else found[-1] / own.run())
    return statistics.median(found), statistics.median(ratios)


def front(rows: Sequence[Row]) -> list[Row]:
    """The rows of which none is both cheaper and has fewer pixels over half a pixel, the cheapest first."""
    best: list[Row] = []
    least = math.inf
    for row in sorted(rows, key=lambda row: (row.relative, row.over_half_pixel)):
        if row.over_half_pixel < least:
            best.append(row)
            least = row.over_half_pixel
    return best


def recommended(rows: Sequence[Row]) -> Row | None:
    """The cheapest row that is good, or the scene's own where that is good and as cheap; None where none
    is good.
    """
    good = [row for row in front(rows) if row.over_half_pixel <= GOOD]
    own = next((row for row in rows if row.knob == "own"), None)
    if not good:
        return None
    if own is not None and own.over_half_pixel <= GOOD and good[0].relative > own.relative * (1 - WORTH):
        return own
    return good[0]


def name(method: Method) -> str:
    """A method in a few words."""
    step = "" if method.step is None else f" {method.step:g}"
    return f"{method.precision} {method.flow}{step}, threshold {method.threshold:g}, {method.steps} steps"


def keys(method: Method) -> str:
    """A method as a line of a scene, in place of what it says of accuracy."""
    flow = "" if method.step is None else f"flow: {method.flow}, flow-step: {method.step:g}, "
    return (
        f"render: {{precision: {method.precision}, {flow}threshold: {method.threshold:g}, "
        f"steps: {method.steps}}}"
    )


def verdict(rows: Sequence[Row]) -> str:
    """The recommendation, in one line."""
    if not rows:
        return "nothing is measured"
    row = recommended(rows)
    if row is None:
        best = min(rows, key=lambda row: (row.over_half_pixel, row.relative))
        return (
            f"none has at most {GOOD:.1%} of the pixels over half a pixel off; nearest, with "
            f"{best.over_half_pixel:.2%} at {best.relative:.2f} x the time: {keys(best.method)}"
        )
    if row.knob == "own":
        return (
            f"the scene's own settings are as cheap as any with at most {GOOD:.1%} of the pixels over half a "
            f"pixel off ({row.over_half_pixel:.2%}): {keys(row.method)}"
        )
    return (
        f"recommended: {keys(row.method)}: {row.over_half_pixel:.2%} of the pixels over half a pixel off, "
        f"{row.relative:.2f} x the time of what the scene says"
    )
