"""What each setting costs and how exact it is: the tables that `render: {accuracy: ...}` chooses from.

`make accuracy`, or `python benchmarks/measure_accuracy.py nil sol`, writes benchmarks/accuracy/GEOMETRY.json.
Two probes of each geometry, a cell with a ball that is repeated and balls about the eye in the whole space,
are rendered by one setting after another, the others as exact as they can be. A row's `reaches` is the
smallest of ANGLES such that of the rays of pictures whose half pixels have this angle at most `ALLOWED` are
over half a pixel off (`thurston_cl.accuracy.pictures`). Its `cost` is the time to march
those rays, as a multiple of the table's first row: a ratio within one run.
"""

import argparse
import datetime
import json
import math
import statistics
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import isotonic_regression

from thurston_cl import device as devices
from thurston_cl.accuracy.pictures import all_places, compare
from thurston_cl.accuracy.rays import ExactRays, Places, Rays
from thurston_cl.arrays import Array, ArrayProgram
from thurston_cl.device import Device
from thurston_cl.geometry import Geometry
from thurston_cl.method import Method
from thurston_cl.models import GEOMETRIES, ORIGIN
from thurston_cl.program import Source, geometry_parts
from thurston_cl.scene import load_text
from thurston_cl.scene.measured import ALLOWED, KNOBS
from thurston_cl.scene.pixel import half_pixels
from thurston_cl.scene.schema import Scene

FOLDER = Path(__file__).parent / "accuracy"
# From two pixels of a small picture to what double precision is for.
ANGLES = (1e-2, 3e-3, 1e-3, 5e-4, 2e-4, 1.5e-4, 1e-4, 3e-5, 1e-5, 1e-6, 1e-7)
RAYS = 4000
# Where so large a share of the rays is over an angle, smaller ones are not tried.
HOPELESS = 0.02
# The picture whose rays are timed.
TIMED_SIZE = (160, 96)
RUNS = 5

CELLS = {
    "e3": "manifold: three-torus\nobjects: [{ball: {radius: 0.3}}]",
    "s3": "manifold: quaternion\nobjects: [{ball: {radius: 0.35}}]",
    "h3": "manifold: seifert-weber\nobjects: [{ball: {radius: 0.6}}]",
    "s2xe": "manifold: hopf-manifold\nobjects: [{ball: {radius: 0.4}}]",
    "h2xe": "manifold: genus-two\nobjects: [{ball: {radius: 0.8}}]",
    "nil": "manifold: heisenberg\nobjects: [{ball: {radius: 0.3}}]",
    "sl2": "manifold: genus-two\nobjects: [{ball: {radius: 1.0}}]",
    "sol": "manifold: anosov\nobjects: [{ball: {radius: 0.16}}]",
}
EYES = {
    "e3": "[0.4, 0.35, 0.3]",
    "s3": "[0.42, 0.36, 0.22]",
    "h3": "[0.5, 0.5, 0.3]",
    "s2xe": "[0.45, 0.3, -0.45]",
    "h2xe": "[-0.9, -0.6, 0.4]",
    "nil": "[0.4, 0.35, 0.3]",
    "sl2": "[1.2, 0.9, 0.9]",
    "sol": "[0.16, 0.13, 0.3]",
}
# What is far hides in fog in the cells, as in scenes: where directions part like e^t it would be noise.
FOG = dict.fromkeys(("h3", "h2xe", "sl2", "sol"), 0.5) | dict.fromkeys(("s3", "s2xe"), 0.25)
FAR = {"h3": 15, "h2xe": 15, "sl2": 15, "sol": 15, "s3": 12, "s2xe": 40, "e3": 100, "nil": 100}
FOG |= dict.fromkeys(("e3", "nil"), 0.1)
# How far the balls of the open probe are, and how large.
REACH = dict.fromkeys(GEOMETRIES, 6.0) | {"s3": 2.9}

FLOWS: tuple[tuple[str, str, float | None], ...] = (
    ("single", "exact", None),
    ("double", "exact", None),
    ("single", "euler", 0.01),
    ("single", "rk2", 0.05),
    ("single", "rk4", 0.25),
    ("single", "rk4", 0.1),
    ("double", "rk4", 0.1),
    ("double", "rk8", 0.25),
)
# The first of each is the plain one.
THRESHOLDS = (1e-4, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 3e-5, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
STEPS = (300, 50, 100, 200, 600, 1200, 5000)
NEWTON = dict.fromkeys(("nil", "sl2", "sol"), (None, 2, 3, 4, 6, 8, 12, 20))
AGM: dict[str, tuple[int | None, ...]] = {"sol": (None, 2, 3, 4, 5)}
TIGHT = {"single": 1e-6, "double": 1e-8}
# The threshold for which steps are counted: rays that come nearer to what they graze take more.
STEPPED = 1e-5


def probes(geometry: str) -> list[Scene]:
    """A cell, and twelve balls all around in the whole space."""
    rng = np.random.default_rng(7)
    balls = []
    for k in range(12):
        way = rng.normal(size=3)
        at = way / np.linalg.norm(way) * REACH[geometry] * (k + 2) / 14
        balls.append(f"{{ball: {{radius: {0.2 + 0.02 * k:.2f}}}, at: {[round(float(c), 3) for c in at]}}}")
    space = f"objects: [{', '.join(balls)}]"
    eye = f"camera: {{at: {EYES[geometry]}, look: {{along: [-1, 0.5, 0.25]}}, fov: 90 deg}}"
    fog = f"effects: {{fog: {{exponential: {{density: {FOG[geometry]}}}}}}}"
    start = "camera: {at: [0.05, 0.03, 0.02], look: {along: [1, 0.4, 0.1]}, fov: 120 deg}"
    head, more = f"geometry: {geometry}", f"render: {{size: [320, 192], far: {FAR[geometry]}}}"
    return [
        load_text(f"{head}\n{CELLS[geometry]}\n{eye}\n{fog}\n{more}"),
        load_text(f"{head}\n{space}\n{start}\n{more}"),
    ]


def candidates(geometry: str) -> Iterator[tuple[str, dict[str, Any], Method]]:
    """The rows to measure: their table, their settings, and a method that is exact but for those."""
    for precision, flow, step in FLOWS:
        method = Method(precision, flow, step, threshold=TIGHT[precision], steps=5000)
        yield "flows", {"precision": precision, "flow": flow, "step": step}, method
    for precision in ("single", "double"):
        for threshold in THRESHOLDS:
            # Nearer than that rounding never lets a ray come to a surface.
            if precision == "double" or threshold >= 1e-7:
                settings = {"precision": precision, "threshold": threshold}
                yield "thresholds", settings, Method(precision, threshold=threshold, steps=5000)
    for steps in STEPS:
        yield "steps", {"steps": steps}, Method("double", threshold=STEPPED, steps=steps)
    for precision in ("single", "double"):
        for agm in AGM.get(geometry, ()):
            settings = {"precision": precision, "agm": agm}
            yield "agm", settings, Method(precision, threshold=TIGHT[precision], steps=5000, agm=agm)


class Probe:
    """One scene, its truth in pictures of every half pixel, and the programs of methods that were built."""

    def __init__(self, scene: Scene, device: Device) -> None:
        self.scene, self.device = scene, device
        self.pictures: list[tuple[float, ExactRays, Places, Any]] = []
        rng = np.random.default_rng(3)
        for angle in ANGLES:
            width = 64
            size = (width, 3 * width // 5)
            half = float(half_pixels(scene.camera, size, 0.0, 0.0))
            width = round(width * half / angle / 5) * 5 or 5
            size = (width, 3 * width // 5)
            exact = ExactRays(scene, device, size)
            at = rng.random((RAYS, 2)) * size
            places = Places(np.zeros(RAYS, np.intp), np.floor(at), at - np.floor(at))
            self.pictures.append((angle, exact, places, exact.trace(places)))
        self.timed = all_places(scene, TIMED_SIZE)

    def reaches(self, method: Method) -> float | None:
        """The smallest angle within which all but `ALLOWED` of the rays are.

        Fewer are over a greater angle than over a smaller one, but other rays are drawn for each: what chance
        turns round is evened out.
        """
        over = []
        for _, exact, places, truth in self.pictures:
            rays = Rays(self.scene, method, self.device, exact.size, self._lanes(method))
            found = compare(rays, exact, places, rays.trace(places), truth)
            over.append(float(found.over.mean()))
            if over[-1] > HOPELESS:
                break
        shares = isotonic_regression(over).x
        good = [angle for angle, share in zip(ANGLES, shares, strict=False) if share <= ALLOWED + 1e-12]
        return min(good) if good else None

    def timer(self, method: Method) -> "Timer":
        return Timer(Rays(self.scene, method, self.device, TIMED_SIZE, self._lanes(method)), self.timed)

    def _lanes(self, method: Method) -> int:
        return self.device.info.lane_width(method.precision)


class Timer:
    """How long a method takes for the rays of a picture."""

    def __init__(self, rays: Rays, places: Places) -> None:
        self.rays, self.places = rays, places
        self.run()

    def run(self) -> float:
        self.rays.trace(self.places)
        return self.rays.seconds


def measure(geometry: str, device: Device) -> dict[str, Any]:
    """All tables of one geometry."""
    tables: dict[str, list[dict[str, Any]]] = {knob: [] for knob in KNOBS}
    all_probes = [Probe(scene, device) for scene in probes(geometry)]
    plain: dict[tuple[str, str], list[Timer]] = {}
    rows = list(candidates(geometry))
    for k, (knob, settings, method) in enumerate(rows, start=1):
        started = time.perf_counter()
        reached = [probe.reaches(method) for probe in all_probes]
        timers = [probe.timer(method) for probe in all_probes]
        # Thresholds are held against the plain one of their precision, whose cost the flow has.
        base = plain.setdefault((knob, method.precision if knob in ("thresholds", "agm") else ""), timers)
        ratios = [
            statistics.median(timer.run() / other.run() for _ in range(RUNS))
            for timer, other in zip(timers, base, strict=True)
        ]
        cost = 1.0 if base is timers else statistics.geometric_mean(ratios)
        worst = None if None in reached else max(angle for angle in reached if angle is not None)
        tables[knob].append({**settings, "cost": round(cost, 3), "reaches": worst})
        seconds = time.perf_counter() - started
        print(f"{geometry} {k}/{len(rows)} {knob} {tables[knob][-1]} {seconds:.1f} s", file=sys.stderr)
    tables["newton"] = list(solves(geometry, device))
    agree(tables)
    for precision in ("single", "double"):
        without_noise([row for row in tables["thresholds"] if row["precision"] == precision], "threshold", -1)
    without_noise(tables["steps"], "steps", 1)
    info = device.info
    return {
        "geometry": geometry,
        "device": f"{info.name}, {info.platform_version}",
        "measured": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "angles": ANGLES,
        "rays": RAYS,
        "allowed": ALLOWED,
        **tables,
    }


def agree(tables: dict[str, list[dict[str, Any]]]) -> None:
    """Let rows say nothing that others refute: a few rays that end where they do by chance are many beside
    those allowed.
    """
    for flow in tables["flows"]:
        if flow["flow"] == "exact":
            # Every threshold is measured with the exact flow of its precision.
            same = [row for row in tables["thresholds"] if row["precision"] == flow["precision"]]
            flow["reaches"] = min(row["reaches"] for row in [flow, *same] if row["reaches"] is not None)
    # Nor is what the mean with all its steps does not better for want of steps of the mean.
    plain = {row["precision"]: row["reaches"] for row in tables["agm"] if row["agm"] is None}
    for row in tables["agm"]:
        if row["reaches"] == plain[row["precision"]]:
            row["reaches"] = ANGLES[-1]
    # What the most steps do not better is not for want of steps, nor is what fewer steps reach.
    steps = sorted(tables["steps"], key=lambda row: row["steps"])
    most, best = steps[-1]["reaches"], math.inf
    for row in steps:
        best = min(best, math.inf if row["reaches"] is None else row["reaches"])
        row["reaches"] = None if best == math.inf else ANGLES[-1] if best == most else best


def without_noise(rows: list[dict[str, Any]], knob: str, sense: int) -> None:
    """Let no finer setting cost less than a coarser one: it cannot, and where it is measured so costs are off
    by that much. Of such rows all get the mean (isotonic regression), and then the plain one 1.
    """
    rows = sorted(rows, key=lambda row: sense * row[knob])
    costs = [float(cost) for cost in isotonic_regression([row["cost"] for row in rows]).x]
    plain = next(cost for row, cost in zip(rows, costs, strict=True) if row[knob] == getattr(Method(), knob))
    for row, cost in zip(rows, costs, strict=True):
        row["cost"] = round(cost / plain, 3)


def solves(geometry: str, device: Device) -> Iterator[dict[str, Any]]:
    """The rows of Newton's method: it finds the geodesics to lights and the distances to balls, three of
    them to each of many points. A row reaches the angle within which all but `ALLOWED` of their
    directions are.
    """
    rng = np.random.default_rng(5)
    ways = rng.normal(size=(RAYS, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    points = Geometry(geometry).flow(ways, rng.uniform(0.1, 12.0, RAYS))[0]
    base = np.broadcast_to(ORIGIN[geometry], points.shape)
    for precision in ("single", "double"):
        plain: Array = np.zeros(0)
        plain_seconds = 1.0
        for newton in NEWTON.get(geometry, ()):
            defines = Method(newton=newton).defines
            source = Source((*geometry_parts(geometry), "arrays.h", "numerics.cl"), defines)
            program = ArrayProgram(source, precision, device, None)
            arrays = [base, points, program.tail(base), program.tail(points)]
            found, seconds = [], []
            for _ in range(RUNS):
                found = [program.run("numerics_geodesic", arrays, 6, k)[:, :3] for k in range(3)]
                seconds.append(program.seconds)
            ends = np.concatenate(found)
            if newton is None:
                plain, plain_seconds = ends, statistics.median(seconds)
            apart = np.linalg.norm(ends - plain, axis=1)[np.isfinite(plain).all(axis=1)]
            worst = float(np.quantile(np.where(np.isnan(apart), np.inf, apart), 1 - ALLOWED))
            # Not below rounding, which the plain row has too.
            worst = max(worst, {"single": 2e-6, "double": 1e-7}[precision])
            reached = [angle for angle in ANGLES if worst <= angle]
            yield {
                "precision": precision,
                "newton": newton,
                "cost": round(statistics.median(seconds) / plain_seconds, 3),
                "reaches": reached[-1] if reached else None,
            }


def written(told: dict[str, Any]) -> str:
    """JSON with a line for each row."""
    lines = []
    for key, value in told.items():
        if key in KNOBS:
            rows = ",\n".join(f"  {json.dumps(row)}" for row in value)
            lines.append(f" {json.dumps(key)}: [\n{rows}\n ]" if rows else f" {json.dumps(key)}: []")
        else:
            lines.append(f" {json.dumps(key)}: {json.dumps(value)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("geometries", nargs="*", default=list(GEOMETRIES), help="default: all")
    device = devices.choose()
    FOLDER.mkdir(exist_ok=True)
    for geometry in parser.parse_args().geometries:
        text = written(measure(geometry, device))
        (FOLDER / f"{geometry}.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
