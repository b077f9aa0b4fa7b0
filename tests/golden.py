"""The reference values of tests/data/*.json, and 50-digit forms of the models to compare with.

Outputs there are decimal strings of 25 digits; an input is exactly the binary64 number that its string
denotes. Of a point three coordinates are given, the fourth follows from the model, so here it is computed
with 50 digits before it is rounded.
"""

import functools
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from thurston_cl.program import kernel_text

DATA = Path(__file__).parent / "data"
GEOMETRIES = ("e3", "s3", "h3")
CURVATURE = {"e3": 0, "s3": 1, "h3": -1}
# Machine epsilons of the precisions of `Geometry`, as in kernels/lanes.h.
EPSILON = {"single": float(np.finfo(np.float32).eps), "double": float(np.finfo(np.float64).eps)}

FLOAT = {"single": np.float32, "double": np.float64}

# A context of its own: mpmath's global precision may be changed by other tests.
MP = mpmath.MPContext()
MP.dps = 50

Exact = NDArray[np.object_]  # numbers of 50 digits
Array = NDArray[np.float64]


def constant(part: str, name: str, precision: str = "double") -> float:
    """A named constant of a file of kernels/; one that double precision has of its own comes first there."""
    found = re.findall(rf"^#define {name} (?:C\()?([\de.+-]+)", kernel_text(part), re.MULTILINE)
    return float(found[0 if precision == "double" else -1])


def exact(values: Any) -> Exact:
    """Decimal strings or floats, in nested lists or an array, as numbers of 50 digits."""
    array = np.asarray(values, dtype=object)
    result = np.empty(array.shape, dtype=object)
    result[...] = np.vectorize(_number, otypes=[object])(array) if array.size else array
    return result


def _number(value: Any) -> Any:
    return MP.mpf(value if isinstance(value, str) else float(value))


def inputs(values: Any) -> Exact:
    """Strings of inputs as the binary64 numbers that they denote."""
    return exact(np.asarray(values, dtype=np.float64))


def rounded(values: Exact) -> Array:
    """Numbers of 50 digits, rounded to binary64."""
    return values.astype(np.float64)


def cut(values: Any, precision: str) -> Array:
    """Values rounded to the precision."""
    return np.asarray(values, dtype=np.float64).astype(FLOAT[precision]).astype(np.float64)


def on_model(geometry: str, xyz: Exact, positive: Sequence[bool] | NDArray[np.bool_] | None = None) -> Exact:
    """Points (N,4) of the model from their coordinates (N,3); where `positive` is false, w < 0 (s3)."""
    signs = [True] * len(xyz) if positive is None else positive
    rows = []
    for x, sign in zip(xyz, signs, strict=True):
        square = MP.mpf(1) - CURVATURE[geometry] * sum(c * c for c in x)
        rows.append([*x, MP.sqrt(square) * (1 if sign else -1)])
    return np.array(rows, dtype=object).reshape(-1, 4)


def translation(geometry: str, point: Exact) -> Exact:
    """The transvection from the origin to `point` (4): [[I - K x x^T/(1+w), x], [-K x^T, w]]."""
    x, w, k = point[:3], point[3], CURVATURE[geometry]
    matrix = exact(np.eye(4))
    matrix[:3, :3] -= k * np.outer(x, x) / (1 + w)
    matrix[:3, 3] = x
    matrix[3, :3] = -k * x
    matrix[3, 3] = w
    return matrix


def inverse_translation(geometry: str, point: Exact) -> Exact:
    """The inverse of `translation`, which is the transvection to the opposite point."""
    return translation(geometry, np.concatenate([-point[:3], point[3:]]))


def distance(geometry: str, p: Exact, q: Exact) -> Exact:
    """Distances (N,) of points (N,4), from the half chord; 50 digits leave room for its cancellation."""
    k = CURVATURE[geometry]
    d = q - p
    square = (d[:, :3] ** 2).sum(axis=1) + k * d[:, 3] ** 2
    lengths = []
    for a, b, chord in zip(p, q, square, strict=True):
        half = MP.sqrt(max(chord, MP.mpf(0))) / 2
        if geometry == "s3" and half > 0.7:
            # Past a quarter turn the chord's sine nears 1: measure from the antipode instead.
            lengths.append(MP.pi - 2 * MP.asin(MP.sqrt(((a + b) ** 2).sum()) / 2))
        else:
            lengths.append(2 * {"e3": lambda c: c, "s3": MP.asin, "h3": MP.asinh}[geometry](half))
    return np.array(lengths, dtype=object)


def relative_errors(got: Any, wanted: Exact | Array) -> Array:
    """Errors (N,) of the rows of `got`, relative to the largest entry of the row of `wanted`."""
    if wanted.dtype == object:
        got = exact(got)
    off = np.abs(got - wanted).reshape(len(wanted), -1).max(axis=1)
    size = np.abs(wanted).reshape(len(wanted), -1).max(axis=1)
    return rounded(off / size)


@dataclass(frozen=True)
class Case:
    """All records of one kind (flow, pairs, area) in one regime of a geometry; "main" is the generic one."""

    geometry: str
    regime: str
    kind: str

    def __str__(self) -> str:
        return f"{self.geometry}-{self.regime}-{self.kind}"

    @property
    def records(self) -> list[dict[str, Any]]:
        data = _read(self.geometry)
        return (data if self.regime == "main" else data["hard"][self.regime])[self.kind]

    def column(self, key: str) -> list[Any]:
        return [record[key] for record in self.records]


def cases(*kinds: str) -> list[Case]:
    """Every case that the files hold, of these kinds."""
    return [
        Case(geometry, regime, kind)
        for geometry in GEOMETRIES
        for regime in ("main", *_read(geometry)["hard"])
        for kind in kinds
        if kind in (_read(geometry) if regime == "main" else _read(geometry)["hard"][regime])
    ]


@functools.cache
def _read(geometry: str) -> dict[str, Any]:
    return json.loads((DATA / f"{geometry}.json").read_text(encoding="utf-8"))
