"""What each setting costs and reaches, as `benchmarks/measure_accuracy.py` has measured it:
benchmarks/accuracy/*.json.
"""

import functools
import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

# The settings that a picture's accuracy depends on, one table of rows for each. They are measured one at a
# time, with the others as exact as they can be.
KNOBS = {
    "flows": ("precision", "flow", "step"),
    "thresholds": ("precision", "threshold"),
    "steps": ("steps",),
    "newton": ("precision", "newton"),
    "agm": ("precision", "agm"),
}


@dataclass(frozen=True)
class Row:
    """One setting: `settings` are fields of Method. cost: its time, as a multiple of that of the table's
    plain row, whose other settings are the same; the mean of both probes. reaches: the smallest of the
    tabulated angles, in radians, within which all but `ALLOWED` of the pixels of every probe are; None
    where they are within none.
    """

    settings: Mapping[str, Any]
    cost: float
    reaches: float | None


# So many pixels may be farther off than what a row is said to reach: half of what a picture may have, since
# several settings come together.
ALLOWED = 0.0005


@functools.cache
def measured(geometry: str) -> dict[str, tuple[Row, ...]]:
    """The rows of a geometry by table; empty tables for settings that mean nothing there."""
    told = json.loads((files("thurston_cl.measured") / f"{geometry}.json").read_text(encoding="utf-8"))
    return {
        knob: tuple(
            Row({name: row[name] for name in names}, row["cost"], row["reaches"]) for row in told[knob]
        )
        for knob, names in KNOBS.items()
    }
