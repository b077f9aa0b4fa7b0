"""What kernel-reflection sequences cost by their levels (KRS paper, figure 12): time of one evaluation
and of a picture, direct, binary, as a Moebius sequence in both ways, and as a union of eight.

What came out is in docs/krs.md, "Costs". Run with `make bench`, or `python benchmarks/krs.py --plot krs.png`.
All at one view: eight trees whose smallest branches go finer with the levels. A single sequence is one tree,
eight times by its last three mirrors; the compound is eight different trees in the same places, with as many
kernels in all. Times are processor time of all cores together, of marching the first rays; depth errors are
relative to double precision with a threshold a thousandth as large.
"""

import argparse
import json
import statistics
import tempfile
import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thurston_cl import device as devices
from thurston_cl.device import Device
from thurston_cl.krs.model import Model
from thurston_cl.krs.recipes.moebius_of import moebius_of
from thurston_cl.krs.recipes.tree import tree
from thurston_cl.krs.sequence import MoebiusSequence
from thurston_cl.method import Method
from thurston_cl.program import LOCAL_SIZE
from thurston_cl.rendering import TileRenderer, tiles
from thurston_cl.scene import load_scene
from thurston_cl.scene.plan import make_plan

Array = NDArray[np.float64]
Record = Mapping[str, Any]

EVALUATIONS = ("KRS distance", "KRS free ball", "Moebius free ball", "Moebius bound")
# Points of one measurement of an evaluation.
EVALUATED = 1 << 19

LEVELS = (4, 7, 10, 13, 16, 19, 22, 25, 28)
# Where the plot goes.
PLOT = Path("build/krs-levels.png")
SIZE, LARGE = (960, 600), (1920, 1200)
# Mirrors of the single sequence that make eight trees of one; how far apart these stand.
DOUBLINGS, APART = 3, 7.0
# How small the hit threshold is against the pixel; the truth is marched with a thousandth.
DETAIL = 0.7
# At these shares of it binary tracing is measured, to compare it at equal depth error.
BINARY_DETAILS = (0.25, 0.7, 2.0)
DISTORTION = 0.15


def single(levels: int) -> Record:
    """Eight trees by mirrors, `levels` in all."""
    record = tree(levels=levels - DOUBLINGS + 1, leaves=0, seed=1)
    mirrors = [
        {"u": [1.0, 0.0, 0.0], "w": 0.5 * APART},
        {"u": [0.0, 1.0, 0.0], "w": 0.5 * APART},
        {"u": [1.0, 0.0, 0.0], "w": 1.5 * APART},
    ]
    empty = [{"type": "empty"}] * DOUBLINGS
    return {"mirrors": [*record["mirrors"], *mirrors], "kernels": [*record["kernels"], *empty]}


def places() -> list[tuple[float, float]]:
    """Where the eight trees of `single` stand."""
    return [(k * APART, j * APART) for k in range(4) for j in range(2)]


def compound(levels: int) -> list[dict[str, Any]]:
    """Eight different trees, `levels` - 3 each, as objects."""
    records = [tree(levels=levels - DOUBLINGS + 1, leaves=0, seed=seed) for seed in range(1, 9)]
    return [
        {"krs": {"record": record}, "at": [x, y, 0.0]}
        for record, (x, y) in zip(records, places(), strict=True)
    ]


@dataclass
class Case:
    """One way to trace one model: what it took, and where its rays ended."""

    name: str
    levels: int
    renderer: TileRenderer
    size: tuple[int, int]
    seconds: list[float] = field(default_factory=list)
    depth: Array = field(default_factory=lambda: np.zeros(0))
    evaluations: float = 0.0

    def run(self) -> None:
        """March all first rays once."""
        total, steps, depths = 0.0, 0.0, []
        for tile in tiles((0, 0, *self.size), self.renderer.side):
            before = time.process_time()
            self.renderer.trace(tile, np.zeros(2), self.finish)
            total += time.process_time() - before
            t, taken, _, end = self.renderer.records(tile)
            steps += float(taken.sum()) + float(np.count_nonzero(taken + end > 0))
            depths.append(np.where(end == 1, t, np.inf))
        self.seconds.append(total)
        self.evaluations, self.depth = steps, np.concatenate(depths).astype(np.float64)

    @property
    def finish(self) -> str:
        return "refill" if self.renderer.lanes > 1 else "packet"

    @property
    def median(self) -> float:
        """Core-seconds of a run."""
        return statistics.median(self.seconds[1:])

    def error(self, truth: "Case") -> float:
        """Mean depth error relative to depth, over rays that hit in both; grazing ones count as they are."""
        both = np.isfinite(self.depth) & np.isfinite(truth.depth)
        return float(np.mean(np.abs(self.depth[both] - truth.depth[both]) / truth.depth[both]))


def case(
    device: Device,
    name: str,
    levels: int,
    objects: Sequence[Mapping[str, Any]],
    tracer: str,
    *,
    size: tuple[int, int] = SIZE,
    detail: float = DETAIL,
    precision: str = "single",
    start: str = "pixel",
) -> Case:
    """The program of one case."""
    scene = {
        "geometry": "e3",
        "camera": {"at": [-9, -16, 5], "look": {"to": [10.5, 3.5, 2.5]}, "fov": "40 deg"},
        "objects": list(objects),
        "lights": [{"sun": {"from": [1, -1, 2]}}],
        "render": {"size": list(size), "tracer": tracer, "detail": detail, "start": start},
    }
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.yaml"
        file.write_text(json.dumps(scene), encoding="utf-8")
        loaded = load_scene(file)
    with warnings.catch_warnings():
        # Branches reach through the mirrors at their forks.
        warnings.simplefilter("ignore")
        plan = make_plan(loaded, device=device, method=Method.of(loaded, precision=precision))
    lanes = device.info.lane_width(precision)
    return Case(name, levels, TileRenderer(plan, device, lanes, "refill"), size)


def evaluation(device: Device, record: Record, name: str, repeat: int) -> float:
    """Core-nanoseconds of one evaluation at sixteen points; `name`: "distance" or "unbounding"."""
    import pyopencl as cl

    with warnings.catch_warnings():
        # Branches reach through the mirrors at their forks.
        warnings.simplefilter("ignore")
        model = Model.from_dict(record, precision="single", device=device)
    points = np.random.default_rng(0).normal(size=(5, EVALUATED)).astype(np.float32) * 4
    points[3:] = [[1.0], [0.05]]
    flags = cl.mem_flags
    source = cl.Buffer(device.context, flags.READ_ONLY | flags.COPY_HOST_PTR, hostbuf=points)
    target = cl.Buffer(device.context, flags.WRITE_ONLY, points[0].nbytes)
    sequence = model.sequence
    # The balls that hold levels would end it early.
    read = sequence.numbers_without_balls if isinstance(sequence, MoebiusSequence) else sequence.numbers
    numbers = np.array(read, np.float32)
    constants = cl.Buffer(device.context, flags.READ_ONLY | flags.COPY_HOST_PTR, hostbuf=numbers)
    kernel = cl.Kernel(model.program.built, f"{sequence.name}_over_{name}")
    kernel.set_args(source, target, np.int32(EVALUATED), constants)
    seconds = []
    for _ in range(2 * repeat + 1):
        before = time.process_time()
        items = (EVALUATED // model.lanes,)
        cl.enqueue_nd_range_kernel(device.queue, kernel, items, (LOCAL_SIZE,)).wait()
        seconds.append(time.process_time() - before)
    # The quickest: whatever else the machine does only adds.
    return 16e9 * min(seconds[1:]) / EVALUATED


def evaluations(device: Device, levels: Sequence[int], repeat: int) -> dict[str, list[float]]:
    """Time of one evaluation by levels: a tree of so many forks, plain and distorted."""
    found: dict[str, list[float]] = {name: [] for name in EVALUATIONS}
    for n in levels:
        plain = tree(levels=n + 1, leaves=0, seed=1)
        distorted = moebius_of(plain, strength=DISTORTION)
        for name, record, asked in (
            ("KRS distance", plain, "distance"),
            ("KRS free ball", plain, "unbounding"),
            ("Moebius free ball", distorted, "unbounding"),
            ("Moebius bound", distorted, "distance"),
        ):
            found[name].append(evaluation(device, record, asked, repeat))
    return found


def run_in_turn(cases: Sequence[Case], repeat: int) -> None:
    """Run all, again and again; a first run is not counted."""
    for _ in range(repeat + 1):
        for each in cases:
            each.run()


def line(levels: Sequence[int], values: Sequence[float]) -> tuple[float, float, float]:
    """Slope and offset of the line through values over levels, and its R^2."""
    slope, offset = np.polyfit(levels, values, 1)
    residual = np.array(values) - (slope * np.array(levels) + offset)
    total = np.array(values) - np.mean(values)
    return float(slope), float(offset), float(1 - residual @ residual / (total @ total))


def tree_objects(record: Record) -> list[dict[str, Any]]:
    return [{"krs": {"record": record}}]


def cases_of(device: Device, levels: int) -> dict[str, Case]:
    """The five cases of figure 12 and what they are compared with."""
    plain = single(levels)
    distorted = moebius_of(plain, strength=DISTORTION)
    one, moebius = tree_objects(plain), tree_objects(distorted)
    # As in the paper, and with the balls that hold its levels, of which it knows nothing.
    bare = [{"krs": {"record": distorted, "level-balls": False}}]
    found = {
        "direct": case(device, "direct", levels, one, "direct"),
        "relaxed": case(device, "relaxed", levels, one, "relaxed"),
        "binary": case(device, "binary", levels, one, "binary"),
        "Moebius binary": case(device, "Moebius binary", levels, bare, "binary"),
        "Moebius conformal": case(device, "Moebius conformal", levels, moebius, "relaxed"),
        "compound of eight": case(device, "compound of eight", levels, compound(levels), "compound"),
    }
    for share in BINARY_DETAILS:
        for kind, objects in (("bare", bare), ("with balls", moebius)):
            name = f"{kind} {share}"
            found[name] = case(device, name, levels, objects, "binary", detail=DETAIL * share)
    return found


FIGURE_12 = ("direct", "relaxed", "binary", "Moebius binary", "Moebius conformal", "compound of eight")


def at_equal_error(binary: Sequence[tuple[float, float]], error: float) -> float:
    """Time of binary tracing at a depth error, between measured pairs (error, time), on logarithmic
    scales.
    """
    errors, times = np.log(np.array(sorted(binary))).T
    return float(np.exp(np.interp(np.log(error), errors, times)))


def figure_12(device: Device, repeat: int, levels: Sequence[int]) -> dict[str, dict[str, list[float]]]:
    """Print the table of figure 12; returns core-seconds and core-nanoseconds an evaluation by case."""
    table: dict[str, dict[str, list[float]]] = {
        name: {"seconds": [], "evaluations": []} for name in FIGURE_12
    }
    print(f"\nfigure 12: {SIZE[0]} x {SIZE[1]}, first rays only; core-ms a picture (evaluations a ray)")
    print(f"  {'levels':>6} " + "".join(f"{name:>24}" for name in FIGURE_12))
    equal = []
    for n in levels:
        cases = cases_of(device, n)
        run_in_turn(list(cases.values()), repeat)
        cells = []
        for name in FIGURE_12:
            each = cases[name]
            table[name]["seconds"].append(each.median)
            table[name]["evaluations"].append(each.evaluations / (SIZE[0] * SIZE[1]))
            cells.append(f"{1e3 * each.median:9.1f} ({each.evaluations / (SIZE[0] * SIZE[1]):6.1f})")
        print(f"  {n:>6} " + "".join(f"{cell:>24}" for cell in cells))
        truth = case(
            device,
            "truth",
            n,
            tree_objects(moebius_of(single(n), strength=DISTORTION)),
            "direct",
            detail=1e-3 * DETAIL,
            precision="double" if device.info.fp64 else "single",
        )
        truth.run()
        conformal = cases["Moebius conformal"]
        error = conformal.error(truth)
        ratios = []
        for kind in ("bare", "with balls"):
            measured = [cases[name] for name in cases if name.startswith(kind)]
            pairs = [(each.error(truth), each.median) for each in measured]
            ratios.append(conformal.median / at_equal_error(pairs, error))
        equal.append((n, error, ratios))
    print("\nlines through these")
    for name in FIGURE_12:
        slope, offset, r2 = line(levels, table[name]["seconds"])
        print(f"  {name:20} {1e3 * slope:6.2f} ms a level, {1e3 * offset:6.1f} ms besides, R^2 {r2:.3f}")
    print(
        "\nMoebius sequences at the same mean depth error: time of conformal tracing over that of binary\n"
        "  tracing as in the paper; over that of binary tracing with balls that hold the levels, too"
    )
    for n, error, (bare, balls) in equal:
        print(f"  {n:>6} levels: error {error:.1e}, time {bare:5.2f}; {balls:5.2f}")
    print("  target: below 1 for that of the paper")
    ratios = np.array(table["compound of eight"]["seconds"]) / np.array(table["direct"]["seconds"])
    print(
        "\ncompound of eight over one sequence of as many kernels: " + ", ".join(f"{r:.2f}" for r in ratios)
    )
    print("  target: at most 1.3")
    return table


def large(device: Device, repeat: int) -> None:
    """28 levels at the paper's size, and what starting by blocks saves."""
    objects = tree_objects(single(28))
    cases = [
        case(device, f"{tracer}, start by {start}", 28, objects, tracer, size=LARGE, start=start)
        for tracer in ("direct", "relaxed")
        for start in ("pixel", "block")
    ]
    run_in_turn(cases, repeat)
    print(f"\n28 levels, {LARGE[0]} x {LARGE[1]}, {2**29 - 1} kernels")
    for each in cases:
        ratio = statistics.median(a / b for a, b in zip(each.seconds[1:], cases[0].seconds[1:], strict=True))
        print(f"  {each.name:28} {each.median:6.2f} core-s, ratio {ratio:.2f}")
    print("  target: at most 3 core-s")


def each_evaluation(device: Device, repeat: int, levels: Sequence[int]) -> dict[str, list[float]]:
    """Print the time of one evaluation, and the lines through it."""
    found = evaluations(device, levels, repeat)
    print("\none evaluation for sixteen rays, core-ns, by levels " + ", ".join(map(str, levels)))
    for name, values in found.items():
        slope, offset, r2 = line(levels, values)
        print(
            f"  {name:20} {', '.join(f'{value:.0f}' for value in values)}: {slope:.2f} a level, "
            f"{offset:.1f} besides, R^2 {r2:.4f}"
        )
    print("  target: R^2 at least 0.99")
    return found


def plot(
    each: Mapping[str, Sequence[float]],
    table: Mapping[str, Mapping[str, Sequence[float]]],
    levels: Sequence[int],
    file: Path,
) -> None:
    """Save figure 12 again: time of a picture and of an evaluation against levels."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(11, 4.5), layout="constrained")
    for name in FIGURE_12:
        left.plot(levels, 1e3 * np.array(table[name]["seconds"]), "o-", label=name, markersize=4)
    for name in EVALUATIONS:
        right.plot(levels, each[name], "o-", label=name, markersize=4)
    left.set(title="a picture, 960 x 600", xlabel="levels", ylabel="core-milliseconds", ylim=(0, None))
    right.set(
        title="one evaluation of sixteen rays", xlabel="levels", ylabel="core-nanoseconds", ylim=(0, None)
    )
    left.legend(frameon=False)
    right.legend(frameon=False)
    figure.savefig(file, dpi=120)
    pyplot.close(figure)
    print(f"\nwrote {file}")


def krs(device: Device, repeat: int, file: Path, levels: Sequence[int] = LEVELS) -> None:
    """All of it."""
    file.parent.mkdir(parents=True, exist_ok=True)
    each = each_evaluation(device, repeat, levels)
    table = figure_12(device, repeat, levels)
    large(device, repeat)
    plot(each, table, levels, file)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=3, help="counted runs of each case (default 3)")
    parser.add_argument("--device", help="as for `thurston render`")
    parser.add_argument("--levels", default=",".join(map(str, LEVELS)), help="which levels")
    parser.add_argument("--plot", type=Path, default=PLOT, help="where the plot goes")
    arguments = parser.parse_args()
    levels = [int(level) for level in arguments.levels.split(",")]
    krs(devices.choose(arguments.device), arguments.repeat, arguments.plot, levels)


if __name__ == "__main__":
    main()
