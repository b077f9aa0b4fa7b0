"""What flows cost and how wrong they are: the protocol of the paper's appendix A, in all eight geometries.

N directions at the origin are followed by a time; each method gives N points. For every point q:
  distance error (A.2.1): the exact distance of q from where the geodesic really leads;
  angle error (A.2.2): of all exact geodesics from the origin to q, as many as can be of that length, the one
    that starts nearest to the direction followed; the angle between both. Of a family of equally long ones
    (right over the origin, say) the nearest member counts. Above OFF_ABOVE a direction is off: the endpoint
    has come to where fewer geodesics lead (A.5), and it is counted instead. Not so in the quantile, in which
    directions that are off or lost are as wrong as can be.
Points that are no numbers, or off the model, are lost, and counted. Time is that of the device for all N,
without the way there and back: the median of several runs.

TRUTH. Double exact, for all methods but itself; for itself golden values by mpmath (golden.py), in fewer
directions. Points and directions of it have errors of their own, in the row of double exact, and so has the
solver for geodesics: `floor` is the largest angle error that it finds for the truth itself. No error below
these means anything. Where it does not find the true geodesic, as in sol one of a pair that is about to fuse,
no angle can be measured: the direction is `unsolved`, and counted.
"""

import math
import statistics
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from thurston_cl import device as devices
from thurston_cl.accuracy.directions import SEED, Directions, adversarial, uniform
from thurston_cl.accuracy.golden import SETS, golden
from thurston_cl.arrays import Array
from thurston_cl.flows import ORDERS, Flow
from thurston_cl.geometry import MODEL_TOLERANCE, Geometry
from thurston_cl.models import GEOMETRIES, off_model

if TYPE_CHECKING:
    from thurston_cl.device import Device

TIMES = (6.0, 10.0)
DIRECTIONS = 10_000
STEPS = (0.1, 0.01)
# As in the paper's text and its table A4; A2 has 60 degrees. In sl2 at t = 10 the wrong geodesic is 42 away.
OFF_ABOVE = math.radians(40)
QUANTILE = 0.999
# A method is run this often, but not again once it has taken this many seconds; then the first run, which
# also pays for what the device sets up, counts as well.
RUNS = 9
ENOUGH_SECONDS = 0.2
# In radians; geodesics about to fuse are found with half of the digits of double precision.
SOLVED_BELOW = 1e-6
# The shortest period of geodesics in sol.
SOL_PERIOD = math.pi * math.sqrt(2)

Progress = Callable[[int, int, str], None]


@dataclass(frozen=True)
class Candidate:
    """A way to follow geodesics in one geometry, in one precision."""

    flow: Flow
    precision: str

    @property
    def words(self) -> str:
        """Its name, as in "rk4 in steps of 0.1, coordinates, single"."""
        equation = "" if self.flow.equation == "left-invariant" else f", {self.flow.equation}"
        return f"{self.flow.words}{equation}, {self.precision}"


@dataclass(frozen=True)
class Row:
    """One candidate in one set of directions after one time. Errors NaN where no direction has one.

    count: directions that were measured. seconds: of the device for `timed` directions. relative: that
    divided by what single exact took. distance, angle: errors, the angles in degrees and only of directions
    that are not off, but for the quantile; worst: the regime of the direction with the largest angle error.
    """

    geometry: str
    time: float
    directions: str
    flow: str
    equation: str
    precision: str
    step: float | None
    truth: str
    count: int
    timed: int
    seconds: float
    relative: float
    distance_max: float
    distance_mean: float
    off: int
    lost: int
    angle_max: float
    angle_quantile: float
    angle_mean: float
    worst: str
    # Directions whose own geodesic the solver does not find, without angle error here; and the largest error,
    # in degrees, that it finds in the others.
    unsolved: int
    floor: float


@dataclass
class _Block:
    """A set of directions and where they lead after a time."""

    time: float
    directions: Directions
    truth: Array
    solved: NDArray[np.bool_]
    floor: float
    single: float = math.nan


def candidates(
    geometry: str,
    flows: Sequence[str] = tuple(ORDERS),
    steps: Sequence[float] = STEPS,
    precisions: Sequence[str] = ("single", "double"),
) -> list[Candidate]:
    """Exact flows first, then the integrators `flows`; in nil also those of the equation in coordinates."""
    exact = [Candidate(Flow(geometry), precision) for precision in precisions]
    equations = ("left-invariant", "coordinates") if geometry == "nil" else ("left-invariant",)
    return exact + [
        Candidate(Flow(geometry, name, step, equation), precision)
        for equation in equations
        for name in flows
        for step in steps
        for precision in precisions
    ]


def measure(
    geometries: Sequence[str] = GEOMETRIES,
    times: Sequence[float] = TIMES,
    count: int = DIRECTIONS,
    steps: Sequence[float] = STEPS,
    device: "str | Device | None" = None,
    *,
    flows: Sequence[str] = tuple(ORDERS),
    seed: int = SEED,
    progress: Progress | None = None,
) -> Iterator[Row]:
    """Rows one after another, geometry after geometry, so that an interrupted run keeps what it has.

    times > 0, count >= 1 directions of each set, steps > 0 of the integrators `flows`. `progress` is called
    with the number of rows that are done, that of all, and what comes next. Raises ValueError for unknown
    names, wrong numbers and a device without double precision, NoDeviceError where there is no device.
    """
    chosen = devices.choose(device) if device is None or isinstance(device, str) else device
    if not chosen.info.fp64:
        raise ValueError(
            f"{chosen.info.name} has no double precision, which is what errors are measured against; "
            "choose another device"
        )
    work = [
        (geometry, candidate) for geometry in geometries for candidate in candidates(geometry, flows, steps)
    ]
    each, done = len(times) * len(SETS), 0
    blocks: list[_Block] = []
    last = ""
    for geometry, candidate in work:
        if progress is not None:
            progress(done * each, len(work) * each, f"{geometry}: {candidate.words}")
        if geometry != last:
            exact = Geometry(geometry, "double", chosen)
            blocks = [
                _block(exact, time, directions)
                for time in times
                for directions in (uniform(count, seed), adversarial(geometry, time, count, seed))
            ]
            last = geometry
        flowing = Geometry(
            geometry,
            candidate.precision,
            chosen,
            candidate.flow.name,
            step=candidate.flow.step,
            equation=candidate.flow.equation,
        )
        for block in blocks:
            yield _row(candidate, flowing, exact, block)
        done += 1
    if progress is not None:
        progress(done * each, len(work) * each, "")


def _block(exact: Geometry, time: float, directions: Directions) -> _Block:
    truth = _follow(exact, directions.vectors, time)
    angles = angle_errors(exact, directions.vectors, truth, time)
    solved = np.asarray(angles < SOLVED_BELOW, np.bool_)
    return _Block(time, directions, truth, solved, math.degrees(float(angles[solved].max(initial=0))))


def _row(candidate: Candidate, flowing: Geometry, exact: Geometry, block: _Block) -> Row:
    points = _follow(flowing, block.directions.vectors, block.time)
    seconds = _seconds(flowing, block)
    is_truth = candidate.flow.name == "exact" and candidate.precision == "double"
    if candidate.flow.name == "exact" and candidate.precision == "single":
        block.single = seconds
    measured, truth = block.directions, "double exact"
    if not is_truth:
        distances = distance_errors(exact, block.truth, points)
        angles = angle_errors(exact, measured.vectors, points, block.time)
        # A number to which no geodesic is found is off.
        angles[np.isnan(angles) & ~np.isnan(distances)] = np.pi
        angles[~block.solved] = np.nan
    elif (values := golden(exact.name, block.time, measured.name)) is not None:
        measured, truth = values.directions, "mpmath"
        distances, angles = values.errors(_follow(exact, measured.vectors, block.time))
    else:
        measured, truth = measured.first(0), "none"
        distances = angles = np.empty(0)
    lost = np.isnan(distances)
    off = angles > OFF_ABOVE
    rest = np.degrees(angles[~off & ~np.isnan(angles)])
    worst = int(np.nanargmax(np.where(off, np.nan, angles))) if len(rest) else None
    all_angles = np.where(lost | off, np.pi, angles)
    return Row(
        geometry=exact.name,
        time=block.time,
        directions=block.directions.name,
        flow=candidate.flow.name,
        equation=candidate.flow.equation,
        precision=candidate.precision,
        step=candidate.flow.step,
        truth=truth,
        count=len(measured),
        timed=len(block.directions),
        seconds=seconds,
        relative=seconds / block.single,
        distance_max=_of(np.max, distances[~lost]),
        distance_mean=_of(np.mean, distances[~lost]),
        off=int(off.sum()),
        lost=int(lost.sum()),
        angle_max=_of(np.max, rest),
        angle_quantile=_of(_quantile, np.degrees(all_angles[~np.isnan(all_angles)])),
        angle_mean=_of(np.mean, rest),
        worst="" if worst is None else _place(measured, worst),
        unsolved=0 if is_truth else int((~block.solved & ~lost).sum()),
        floor=block.floor,
    )


def _of(function: Callable[[Array], np.floating], values: Array) -> float:
    return float(function(values)) if len(values) else math.nan


def _quantile(values: Array) -> np.floating:
    """At least so many are not larger: no mean of two of them."""
    return np.quantile(values, QUANTILE, method="higher")


def _place(directions: Directions, index: int) -> str:
    """The regime of a direction and how far it is, as in "null cone, 1e-06 off"."""
    name, offset = directions.regimes[index], directions.offsets[index]
    return f"{name}, {abs(offset):.0e} off" if name and offset else name


def _follow(geometry: Geometry, vectors: Array, time: float) -> Array:
    """Points (N,4), NaN where they are no points of the model."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # lost points are counted
        points = geometry.flow(vectors, time)[0]
    with np.errstate(over="ignore", invalid="ignore"):
        lost = ~np.isfinite(points).all(axis=1) | ~(
            np.abs(off_model(geometry.name, *points.T)) < MODEL_TOLERANCE
        )
    points[lost] = np.nan
    return points


def _seconds(geometry: Geometry, block: _Block) -> float:
    """Median of the device's seconds. The first run is done, and warms the device up."""
    first = geometry.flow_seconds
    taken = [first] if first > ENOUGH_SECONDS else []
    while len(taken) < RUNS and sum(taken) < ENOUGH_SECONDS:
        _follow(geometry, block.directions.vectors, block.time)
        taken.append(geometry.flow_seconds)
    return statistics.median(taken)


def distance_errors(exact: Geometry, truth: Array, points: Array) -> Array:
    """Distances (N,) of points (N,4) from the true ones, NaN where one of both is lost."""
    at = _are_numbers(points) & _are_numbers(truth)
    errors = np.full(len(points), np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a solve at its bound is the best so far
        errors[at] = exact.distance(points[at], truth[at])
    return errors


def angle_errors(exact: Geometry, vectors: Array, points: Array, time: float) -> Array:
    """Angles (N,) in radians between unit vectors (N,3) and the nearest direction of an exact geodesic from
    the origin to points (N,4); NaN where those are lost.
    """
    at = _are_numbers(points)
    errors = np.full(len(points), np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        found, _, families = exact.geodesics(points[at], geodesics_within(exact.name, time), families=True)
        followed = np.broadcast_to(vectors[at][:, None, :], found.shape)
        found = np.where(families[:, :, None], _members(exact.name, found, followed), found)
        across = np.linalg.norm(np.cross(found, followed), axis=2)
        errors[at] = np.nanmin(np.arctan2(across, (found * followed).sum(axis=2)), axis=1)
    return errors


def geodesics_within(geometry: str, time: float) -> int:
    """How many geodesics to one point can be as short as `time`, and with one turn more."""
    turns = math.floor(time / (2 * math.pi)) + 1
    match geometry:
        case "s3" | "s2xe":
            return 2 * (turns + 1)
        case "nil" | "sl2":
            return 1 + 2 * turns
        case "sol":
            return 1 + 4 * math.ceil(time / SOL_PERIOD)
        case _:
            return 1


def _members(geometry: str, found: Array, followed: Array) -> Array:
    """Of the family of each geodesic found, the member that is nearest to the direction followed."""
    if geometry == "s3":
        return followed
    # The others are turned about the fibre.
    across = np.linalg.norm(found[..., :2], axis=-1, keepdims=True)
    size = np.linalg.norm(followed[..., :2], axis=-1, keepdims=True)
    turned = np.divide(followed[..., :2] * across, size, out=found[..., :2].copy(), where=size > 0)
    return np.concatenate([turned, found[..., 2:]], axis=-1)


def _are_numbers(points: Array) -> NDArray[np.bool_]:
    return np.asarray(np.isfinite(points).all(axis=1), np.bool_)
