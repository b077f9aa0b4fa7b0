"""Made-up rows of thurston_cl.accuracy.protocol, for tests of what is done with rows."""

from __future__ import annotations

import dataclasses
from typing import Any

from thurston_cl.accuracy.protocol import Row

ROW = Row(
    geometry="nil",
    time=6.0,
    directions="uniform",
    flow="exact",
    equation="left-invariant",
    precision="double",
    step=None,
    truth="mpmath",
    count=48,
    timed=100,
    seconds=2e-3,
    relative=2.0,
    distance_max=1e-14,
    distance_mean=1e-15,
    off=0,
    lost=0,
    angle_max=1e-13,
    angle_quantile=1e-13,
    angle_mean=1e-14,
    worst="",
    unsolved=0,
    floor=1e-14,
)


def row(**changes: Any) -> Row:
    return dataclasses.replace(ROW, **changes)


def rows(geometry: str = "nil", time: float = 6.0, directions: str = "uniform") -> list[Row]:
    """Exact in both precisions, and two integrators of which one is worth its time."""
    there: dict[str, Any] = {"geometry": geometry, "time": time, "directions": directions}
    single: dict[str, Any] = {"precision": "single", "truth": "double exact", "count": 100}
    return [
        row(**there, **single, seconds=1e-3, relative=1.0, angle_max=1e-5, angle_quantile=9e-6),
        row(**there),
        row(
            **there,
            **single,
            flow="euler",
            step=0.1,
            seconds=5e-4,
            relative=0.5,
            angle_max=9.0,
            angle_quantile=5.0,
        ),
        row(
            **there,
            **single,
            flow="rk4",
            step=0.1,
            seconds=4e-3,
            relative=4.0,
            angle_max=1e-3,
            angle_quantile=1e-3,
        ),
    ]
