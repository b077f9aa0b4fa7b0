"""accuracy/golden.py: the stored values are those of mpmath, and errors are measured by them."""

from __future__ import annotations

import numpy as np
import pytest
from mpmath import mp

from thurston_cl.accuracy import golden as module
from thurston_cl.accuracy.directions import regimes, uniform
from thurston_cl.accuracy.golden import LONGEST, SETS, STORED, TIMES, compute, golden
from thurston_cl.accuracy.truth import flow
from thurston_cl.models import GEOMETRIES


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("time", TIMES)
def test_stored_values(geometry: str, time: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "compute", None)  # nothing is computed anew
    for name in SETS:
        there = golden(geometry, time, name)
        assert there is not None
        assert len(there.directions) == len(there.points) == len(there.responses) == STORED
        if name == "uniform":
            np.testing.assert_array_equal(there.directions.vectors, uniform(STORED).vectors)
        else:
            assert set(there.directions.regimes) == {regime.name for regime in regimes(geometry, time)}
        n = STORED // 3
        point, _ = flow(geometry, [float(part) for part in there.directions.vectors[n]], time)
        with mp.workdps(40):
            off = [abs(mp.mpf(a) - b) for a, b in zip(there.points[n], point, strict=True)]
            assert max(off) < mp.mpf(10) ** -23 * max(abs(part) for part in point)


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_a_direction_off_by_an_angle_is_off_by_that_angle(geometry: str) -> None:
    there = golden(geometry, 10.0, "uniform")
    assert there is not None
    # Small, since errors are taken to first order; and the response has 5 digits, of which e^t cancel.
    angle, count = 1e-10, 2
    aside, ahead = [], []
    for u in there.directions.vectors[:count]:
        side = np.cross(u, [0.6, -0.48, 0.64])
        turned = np.cos(angle) * u + np.sin(angle) * side / np.linalg.norm(side)
        aside.append([float(part) for part in flow(geometry, [float(part) for part in turned], 10.0)[0]])
        ahead.append([float(part) for part in flow(geometry, [float(part) for part in u], 10.0 + 1e-7)[0]])
    distances, angles = there.errors(np.array(aside))
    assert angles == pytest.approx(angle, rel=0.03)
    if geometry in ("e3", "h3"):
        assert distances == pytest.approx({"e3": 10, "h3": np.sinh(10)}[geometry] * angle, rel=1e-3)
    # Along the geodesic there is no angle, only distance.
    distances, angles = there.errors(np.array(ahead))
    assert distances == pytest.approx(1e-7, rel=1e-3)
    assert angles == pytest.approx(0, abs=1e-11)


def test_lost_points_have_no_errors() -> None:
    there = golden("nil", 6.0, "uniform")
    assert there is not None
    points = np.array([[float(part) for part in point] for point in there.points])
    points[3, 1] = np.nan
    distances, angles = there.errors(points)
    assert np.flatnonzero(np.isnan(distances)).tolist() == np.flatnonzero(np.isnan(angles)).tolist() == [3]
    # Rounded to double, the others are as near as numbers allow.
    assert 0 < np.nanmax(distances) < 1e-14


def test_other_times_are_computed_where_that_is_quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "LIVE", 2)
    there = golden("nil", 2.5, "adversarial")
    assert there is not None
    assert (there.time, len(there.points), there.responses.shape) == (2.5, 2, (2, 3, 3))
    assert golden("nil", LONGEST * 1.01, "uniform") is None


def test_responses_are_inverse_to_the_flow() -> None:
    there = compute("sl2", 3.0, "uniform", 1)
    u = there.directions.vectors[0]
    # In any direction across u, the response undoes what the flow does; along u there is none.
    np.testing.assert_allclose(u @ there.responses[0], 0, atol=1e-12)
