"""accuracy/protocol.py: errors of points are what they are said to be, and rows count all directions."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from thurston_cl.accuracy import protocol
from thurston_cl.accuracy.directions import uniform
from thurston_cl.accuracy.protocol import (
    Candidate,
    angle_errors,
    candidates,
    distance_errors,
    geodesics_within,
    measure,
)
from thurston_cl.arrays import Array
from thurston_cl.device import Device
from thurston_cl.flows import Flow
from thurston_cl.geometry import Geometry
from thurston_cl.models import GEOMETRIES

COUNT = 60


def turned(vectors: Array, angle: float) -> Array:
    """Vectors (N,3) turned by an angle, each to one side."""
    side = np.cross(vectors, [0.6, -0.48, 0.64])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    return math.cos(angle) * vectors + math.sin(angle) * side


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("time", [2.0, 10.0])
def test_a_point_of_a_turned_direction_is_off_by_that_angle(
    geometry: str, time: float, opencl_device: Device
) -> None:
    exact = Geometry(geometry, "double", opencl_device)
    vectors, angle = uniform(COUNT).vectors, 1e-4
    points = exact.flow(turned(vectors, angle), time)[0]
    angles = angle_errors(exact, vectors, points, time)
    assert angles == pytest.approx(angle, rel=1e-4)
    truth = exact.flow(vectors, time)[0]
    distances = distance_errors(exact, truth, points)
    np.testing.assert_allclose(distances, exact.distance(points, truth))
    assert angle_errors(exact, vectors, truth, time) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(
    ("geometry", "time", "u_z", "point"),
    [
        ("s3", math.pi, 0.3, [0, 0, 0, -1]),
        ("s3", 2 * math.pi, 0.3, [0, 0, 0, 1]),
        ("s2xe", 2 * math.pi, math.sqrt(0.75), [0, 0, -1, math.sqrt(3) * math.pi]),
        # A full turn: c t/2 = pi, and z = t (1 + c^2)/(2 c).
        ("nil", 10.0, math.pi / 5, [0, 0, 5 * (math.pi / 5 + 5 / math.pi), 1]),
        # s = (t/2)^2 (2 c^2 - 1) = pi^2, and w = 2 c t - 2 pi.
        ("sl2", 10.0, math.sqrt((1 + (math.pi / 5) ** 2) / 2), [0, 0, 1, None]),
    ],
)
def test_of_a_family_the_nearest_member_counts(
    geometry: str, time: float, u_z: float, point: list[Any], opencl_device: Device
) -> None:
    if geometry == "sl2":
        point = [0, 0, 1, 2 * u_z * time - 2 * math.pi]
    azimuth = np.linspace(0, 6, 5)
    across = math.sqrt(1 - u_z**2)
    vectors = np.stack([across * np.cos(azimuth), across * np.sin(azimuth), np.full(5, u_z)], axis=1)
    exact = Geometry(geometry, "double", opencl_device)
    points = np.tile(np.array(point, float), (5, 1))
    assert exact.flow(vectors, time)[0] == pytest.approx(points, abs=1e-12)
    assert angle_errors(exact, vectors, points, time) == pytest.approx(0, abs=1e-13)
    tilted = turned(vectors, 1e-3)
    assert (angle_errors(exact, tilted, points, time) <= 1e-3 * (1 + 1e-9)).all()


@pytest.mark.parametrize("geometry", ["s3", "s2xe", "nil", "sl2", "sol"])
def test_as_many_geodesics_as_can_be_of_that_length(geometry: str, opencl_device: Device) -> None:
    exact = Geometry(geometry, "double", opencl_device)
    for time in (3.0, 10.0, 14.0):
        points = exact.flow(uniform(COUNT).vectors, time)[0]
        lengths = exact.geodesics(points, geodesics_within(geometry, time) + 1)[1]
        assert (np.isnan(lengths[:, -1]) | (lengths[:, -1] > time * (1 - 1e-12))).all()


def test_rows_of_a_run(opencl_device: Device) -> None:
    said: list[tuple[int, int, str]] = []
    rows = list(
        measure(
            ["h2xe"],
            [6.0],
            COUNT,
            [0.5, 0.25],
            opencl_device,
            flows=["rk4"],
            progress=lambda *what: said.append(what),
        )
    )
    assert len(rows) == 2 * len(candidates("h2xe", ["rk4"], [0.5, 0.25])) == 12
    assert said[0] == (0, 12, "h2xe: exact, single")
    assert said[-1] == (12, 12, "")
    by = {(row.directions, row.flow, row.precision, row.step): row for row in rows}
    assert len(by) == 12
    for name in ("uniform", "adversarial"):
        single, double = by[name, "exact", "single", None], by[name, "exact", "double", None]
        assert single.relative == 1
        assert double.relative == pytest.approx(double.seconds / single.seconds)
        assert (single.truth, single.count, single.timed) == ("double exact", COUNT, COUNT)
        assert (double.truth, double.count, double.timed) == ("mpmath", 48, COUNT)
        assert 0 < double.angle_mean <= double.angle_max < 1e-12 < single.angle_max < 1e-4
        assert 0 < double.distance_mean < 1e-11 < single.distance_mean < 1e-2
        coarse, fine = (by[name, "rk4", "double", step] for step in (0.5, 0.25))
        # Of order 4: half the step, a sixteenth of the error.
        assert 12 < coarse.distance_mean / fine.distance_mean < 20
        assert coarse.angle_mean <= coarse.angle_quantile <= coarse.angle_max
        assert (coarse.off, coarse.lost) == (0, 0)
    assert by["uniform", "rk4", "double", 0.5].worst == ""
    assert by["adversarial", "rk4", "double", 0.5].worst.startswith(("horizontal", "vertical"))


def test_coordinates_are_measured_in_nil_only() -> None:
    assert {each.flow.equation for each in candidates("sl2")} == {"left-invariant"}
    words = [each.words for each in candidates("nil", ["rk2"], [0.1], ["double"])]
    assert words == [
        "exact, double",
        "rk2 in steps of 0.1, double",
        "rk2 in steps of 0.1, coordinates, double",
    ]


def test_what_is_off_or_lost_is_counted_and_spoils_the_quantile(opencl_device: Device) -> None:
    exact = Geometry("nil", "double", opencl_device)
    block = protocol._block(exact, 6.0, uniform(COUNT))
    # Two points that are no numbers, one off the model, and one that is where another direction leads.
    points = block.truth.copy()
    points[[3, 5], 2] = np.nan
    points[7, 3] = 2.0
    other = int(np.argmin(block.directions.vectors @ block.directions.vectors[9]))
    points[9] = points[other]
    flowing: Any = SimpleNamespace(
        name="nil", flow=lambda vectors, time: (points.copy(), None), flow_seconds=0.25
    )
    row = protocol._row(Candidate(Flow("nil", "rk4", 0.1), "double"), flowing, exact, block)
    assert (row.lost, row.off, row.count, row.seconds) == (3, 1, COUNT, 0.25)
    assert row.angle_max < 1e-10
    assert row.angle_quantile == 180
    assert row.distance_max > 1
    assert math.isnan(row.relative)  # single exact was not measured


def test_where_the_true_geodesic_is_not_found_no_angle_is_measured(
    opencl_device: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    exact = Geometry("nil", "double", opencl_device)
    found = np.array([1e-9, 0.7, 3e-9, 2e-9])
    monkeypatch.setattr(protocol, "angle_errors", lambda *what: found.copy())
    block = protocol._block(exact, 6.0, uniform(4))
    assert block.solved.tolist() == [True, False, True, True]
    assert block.floor == pytest.approx(math.degrees(3e-9))
    row = protocol._row(Candidate(Flow("nil"), "single"), exact, exact, block)
    assert (row.unsolved, row.off, row.lost, row.count) == (1, 0, 0, 4)
    assert row.angle_max == row.angle_quantile == pytest.approx(math.degrees(3e-9))
    assert row.angle_mean == pytest.approx(math.degrees(2e-9))


def test_all_lost(opencl_device: Device) -> None:
    exact = Geometry("nil", "double", opencl_device)
    block = protocol._block(exact, 6.0, uniform(4))
    flowing: Any = SimpleNamespace(
        name="nil", flow=lambda vectors, time: (np.full((4, 4), np.inf), None), flow_seconds=0.25
    )
    row = protocol._row(Candidate(Flow("nil", "rk4", 0.1), "single"), flowing, exact, block)
    assert (row.lost, row.off, row.unsolved, row.worst) == (4, 0, 0, "")
    assert all(
        math.isnan(error) for error in (row.distance_max, row.distance_mean, row.angle_max, row.angle_mean)
    )


def test_double_exact_beyond_the_golden_values_is_said_to_have_no_truth(opencl_device: Device) -> None:
    exact = Geometry("nil", "double", opencl_device)
    block = protocol._block(exact, 30.0, uniform(4))
    row = protocol._row(Candidate(Flow("nil"), "double"), exact, exact, block)
    assert (row.truth, row.count, row.lost) == ("none", 0, 0)
    assert math.isnan(row.angle_max)


def test_a_device_without_double_precision() -> None:
    device: Any = SimpleNamespace(info=SimpleNamespace(name="Toaster", fp64=False))
    with pytest.raises(ValueError, match="Toaster has no double precision"):
        next(measure(["nil"], device=device))
