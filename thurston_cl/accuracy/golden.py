"""Golden values: where geodesics really lead, by mpmath, for what has no better truth among the kernels.

Double exact flows are the truth that other methods are measured against. They themselves are measured here,
in a sample of the directions. For the times of the tables the values are stored beside this file, and
    python -m thurston_cl.accuracy.golden
computes them anew, in ten minutes; for other times fewer directions are computed on the spot.
"""

import json
import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from mpmath import mp

from thurston_cl.accuracy.directions import SEED, Directions, adversarial, uniform
from thurston_cl.accuracy.truth import displacement, flow
from thurston_cl.arrays import Array
from thurston_cl.models import GEOMETRIES

TIMES = (6.0, 10.0)
SETS = ("uniform", "adversarial")
# Directions of each set that are stored, and that are computed where none are.
STORED = 48
LIVE = 4
# None are computed for longer times: minutes, with all the digits that these need.
LONGEST = 20.0
# So many are stored of a point: differences of 1e-16 of it have 9 of them, or 5 where e^t cancels.
STORED_DIGITS = 25
RESPONSE_DIGITS = 15
# The response is a difference quotient over this much, which is little even beside the 1e-16 that a rounded
# direction leaves of a distance from a caustic; and its points have digits for that.
CHANGE = "1e-25"
DIGITS = 50


@dataclass(frozen=True)
class Golden:
    """Points (N) of 4 numbers (mpf or strings) that flows along `directions` by `time` lead to.

    responses: matrices (N,2,3) from a small displacement of the point to the change of direction, across it,
    that causes it: the angle error is the length of that, as far as it is small.
    """

    geometry: str
    time: float
    directions: Directions
    points: tuple[list[Any], ...]
    responses: Array

    def errors(self, points: Array) -> tuple[Array, Array]:
        """Distances (N,) of points (N,4) from the golden ones and the angle errors (N,) in radians, NaN where
        a point is."""
        distances, angles = np.full((2, len(points)), np.nan)
        for n, point in enumerate(points):
            if np.isfinite(point).all():
                off = np.array(
                    [float(part) for part in displacement(self.geometry, self.points[n], point, DIGITS)]
                )
                distances[n] = np.linalg.norm(off)
                angles[n] = min(float(np.linalg.norm(self.responses[n] @ off)), math.pi)
        return distances, angles


def golden(geometry: str, time: float, name: str) -> Golden | None:
    """Golden values for the set `name` of directions: stored ones if there are any, else LIVE new ones; None
    beyond LONGEST.
    """
    if time in TIMES:
        for block in json.loads(_file(geometry).read_text(encoding="utf-8")):
            if (block["time"], block["set"]) == (time, name):
                return _read(geometry, block)
    return compute(geometry, time, name, LIVE) if time <= LONGEST else None


def compute(geometry: str, time: float, name: str, count: int) -> Golden:
    """Golden values for the first `count` directions of a set, by mpmath."""
    there = uniform(count) if name == "uniform" else adversarial(geometry, time, count)
    rays = [_ray(geometry, [float(part) for part in u], time) for u in there.vectors]
    return Golden(
        geometry, time, there, tuple(point for point, _ in rays), np.array([response for _, response in rays])
    )


def _ray(geometry: str, u: list[float], time: float) -> tuple[list[Any], Array]:
    point, _ = flow(geometry, u, time, digits=DIGITS)
    columns = []
    for axis in range(3):
        with mp.workdps(DIGITS):
            moved = [mp.mpf(part) + (i == axis) * mp.mpf(CHANGE) for i, part in enumerate(u)]
        end, _ = flow(geometry, moved, time, digits=DIGITS)
        off = displacement(geometry, point, end, DIGITS)
        columns.append([part / mp.mpf(CHANGE) for part in off])
    return point, _response(columns, u)


def _response(columns: list[list[Any]], u: list[float]) -> Array:
    """From displacements to changes of velocity, of which the part across u is the change of direction."""
    # A basis across u: its first vector is level, and e_x where u is vertical.
    level = np.array([-u[1], u[0], 0.0]) if u[0] or u[1] else np.array([1.0, 0.0, 0.0])
    level /= np.linalg.norm(level)
    across = np.stack([level, np.cross(u, level)])
    with mp.workdps(DIGITS):
        inverse = mp.matrix(columns).T ** -1
    return across @ np.array(inverse.tolist(), float)


def _file(geometry: str) -> Any:
    return files("thurston_cl.accuracy") / "golden" / f"{geometry}.json"


def _read(geometry: str, block: dict[str, Any]) -> Golden:
    rows = block["rows"]
    there = Directions(
        block["set"],
        np.array([row["u"] for row in rows]),
        tuple(row["regime"] for row in rows),
        np.array([np.nan if row["offset"] is None else row["offset"] for row in rows]),
    )
    points = tuple(row["point"] for row in rows)
    return Golden(geometry, block["time"], there, points, np.array([row["response"] for row in rows]))


def _blocks(geometry: str) -> Iterator[dict[str, Any]]:
    for time in TIMES:
        for name in SETS:
            made = compute(geometry, time, name, STORED)
            there = made.directions
            rows = [
                {
                    "u": list(there.vectors[n]),
                    "regime": there.regimes[n],
                    "offset": None if name == "uniform" else there.offsets[n],
                    "point": [mp.nstr(part, STORED_DIGITS) for part in made.points[n]],
                    "response": [
                        [float(f"{x:.{RESPONSE_DIGITS}g}") for x in row] for row in made.responses[n]
                    ],
                }
                for n in range(STORED)
            ]
            yield {"time": time, "set": name, "seed": SEED, "rows": rows}


def _write(folder: Path) -> None:
    """Compute and store the golden values of every geometry; one line a direction."""
    folder.mkdir(exist_ok=True)
    for geometry in GEOMETRIES:
        print(geometry, file=sys.stderr, flush=True)
        blocks = []
        for block in _blocks(geometry):
            rows = ",\n".join(json.dumps(row) for row in block.pop("rows"))
            blocks.append(json.dumps(block)[:-1] + ', "rows": [\n' + rows + "]}")
        text = "[" + ",\n".join(blocks) + "]\n"
        (folder / f"{geometry}.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    _write(Path(__file__).parent / "golden")
