"""Tables A1 to A4 of the paper are reproduced, up to what 2000 other random directions change.

Nil by the second-order equation in coordinates, SL2 by the first-order system on Q with |u| kept; directions
off are those of more than 60 degrees in A2 and 40 in A4.
"""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from thurston_cl.accuracy.directions import uniform
from thurston_cl.accuracy.protocol import angle_errors, distance_errors
from thurston_cl.device import Device
from thurston_cl.geometry import Geometry

COUNT = 2000
# Of 10,000 directions.
PAPERS = 10_000
ROOT = Path(__file__).parents[1]
# The paper's figures stand where they are printed beside ours.
PAPER = runpy.run_path(str(ROOT / "docs" / "examples" / "accuracy_tables.py"))["TABLES"]
ROWS = [(table, flow, step) for table in PAPER for flow, step in table.rows]


@pytest.fixture(scope="module")
def exact(opencl_device: Device) -> dict[str, Geometry]:
    return {name: Geometry(name, "double", opencl_device) for name in ("nil", "sl2")}


@pytest.mark.parametrize(
    ("table", "flow", "step"), ROWS, ids=[f"{table.name}-{flow}-{step:g}" for table, flow, step in ROWS]
)
def test_a_row_of_the_paper(
    table: Any, flow: str, step: float, exact: dict[str, Geometry], opencl_device: Device
) -> None:
    distance_max, distance_mean, off, _, angle_mean = table.rows[flow, step]
    vectors, name, time = uniform(COUNT).vectors, table.geometry, table.time
    method = Geometry(name, "double", opencl_device, flow, step=step, equation=table.equation)
    points = method.flow(vectors, time)[0]
    distances = distance_errors(exact[name], exact[name].flow(vectors, time)[0], points)
    assert distances.mean() == pytest.approx(distance_mean, rel=0.08)
    assert distances.max() == pytest.approx(distance_max, rel=0.08)
    angles = np.degrees(angle_errors(exact[name], vectors, points, time))
    found = int((angles > table.off_above).sum())
    wanted = off * COUNT / PAPERS
    # Both counts are random: four standard deviations, of ours mostly.
    assert abs(found - wanted) <= 4 * np.sqrt(wanted * (1 + COUNT / PAPERS))
    if time == 6:
        # At t = 10 this mean hangs on a few directions next to the cut locus. The paper's 1.2e-9 for rk4 in
        # nil in steps of 0.01 is below ours, 1.7e-9, and its maximum, 2.7e-8, above ours, 8.0e-9.
        mean = angles[angles <= table.off_above].mean()
        assert mean == pytest.approx(angle_mean, rel=0.15 if angle_mean > 1e-8 else 0.5)
