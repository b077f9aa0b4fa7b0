"""accuracy/directions.py: uniform directions, and adversarial ones that stand where they say."""

from __future__ import annotations

import re

import numpy as np
import pytest
from golden import constant

from thurston_cl.accuracy import directions as module
from thurston_cl.accuracy.directions import DISTANCES, adversarial, regimes, uniform
from thurston_cl.accuracy.truth import flow
from thurston_cl.models import GEOMETRIES

TIME = 10.0


def on(geometry: str, name: str, offset: float = 0.0, time: float = TIME) -> list[float]:
    """One direction next to a regime."""
    (regime,) = [r for r in regimes(geometry, time) if r.name == name][:1]
    vectors = regime.near(offset, 1, np.random.default_rng(7))
    return [float(component) for component in vectors[0]]


def test_uniform_directions_are_uniform_and_always_the_same() -> None:
    there = uniform(20000)
    assert np.linalg.norm(there.vectors, axis=1) == pytest.approx(1, rel=1e-15)
    # The mean and the second moments, to four standard deviations.
    assert np.abs(there.vectors.mean(axis=0)).max() < 4 / np.sqrt(3 * 20000)
    assert np.abs(there.vectors.T @ there.vectors / 20000 - np.eye(3) / 3).max() < 4 * 0.3 / np.sqrt(20000)
    np.testing.assert_array_equal(uniform(20000).vectors, there.vectors)
    assert (uniform(20000, seed=1).vectors != there.vectors).any()


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("time", [0.5, 6.0, 10.0, 1000.0])
def test_every_regime_comes_at_every_distance(geometry: str, time: float) -> None:
    places = len(regimes(geometry, time)) * (2 * len(DISTANCES) + 1)
    there = adversarial(geometry, time, places)
    assert np.linalg.norm(there.vectors, axis=1) == pytest.approx(1, rel=1e-14)
    assert set(there.regimes) == {regime.name for regime in regimes(geometry, time)}
    assert set(np.abs(there.offsets)) == {0.0, *DISTANCES}
    assert len(adversarial(geometry, time, 7)) == 7


@pytest.mark.parametrize("offset", [0.0, 1e-1, -1e-4, 1e-12])
def test_planes_poles_and_points(offset: float) -> None:
    assert abs(on("nil", "horizontal", offset)[2]) == pytest.approx(np.sin(abs(offset)), rel=1e-12)
    assert np.hypot(*on("h2xe", "vertical", offset)[:2]) == pytest.approx(np.sin(abs(offset)), rel=1e-12)
    assert on("sol", "plane a = 0", offset)[0] == pytest.approx(np.sin(offset), rel=1e-12)
    assert on("sol", "plane b = 0", offset)[1] == pytest.approx(np.sin(offset), rel=1e-12)
    a, b, c = on("sol", "straight line", offset)
    assert np.hypot(c, (abs(a) - abs(b)) / np.sqrt(2)) == pytest.approx(abs(np.sin(offset)), abs=2e-16)
    assert abs(on("sl2", "null cone", offset)[2]) == pytest.approx(np.cos(np.pi / 4 + offset), rel=1e-15)


@pytest.mark.parametrize("geometry", ["nil", "sl2"])
def test_after_a_full_turn_a_geodesic_is_back_on_its_fibre(geometry: str) -> None:
    for time, turns in ((10.0, 1), (20.0, 3)):
        names = {regime.name for regime in regimes(geometry, time)}
        assert f"full turn {turns}" in names
        assert f"full turn {turns + 1}" not in names
        for turn in range(1, turns + 1):
            x, y, *_ = flow(geometry, on(geometry, f"full turn {turn}", time=time), time)[0]
            assert float(abs(x) + abs(y)) < 1e-12
            x, y, *_ = flow(geometry, on(geometry, f"full turn {turn}", 1e-6, time), time)[0]
            assert 1e-7 < float(abs(x) + abs(y)) < 1e-3


def test_after_a_half_circle_a_geodesic_is_over_the_origin_or_its_antipode() -> None:
    for turn in (1, 2, 3):
        x, y, z, _ = flow("s2xe", on("s2xe", f"half circle {turn}"), TIME)[0]
        assert float(abs(x) + abs(y)) < 1e-14
        assert float(z) == pytest.approx((-1) ** turn)
    assert "half circle 4" not in {regime.name for regime in regimes("s2xe", TIME)}


def test_each_half_period_of_sol_exchanges_two_components() -> None:
    for time in (6.0, 10.0):
        half = [r.name for r in regimes("sol", time) if r.name.startswith("half period")]
        assert len(half) == {6.0: 2, 10.0: 4}[time]
        for h, name in enumerate(half, start=1):
            a, b, c = on("sol", name, time=time)
            end = [abs(float(component)) for component in flow("sol", [a, b, c], time)[1]]
            wanted = (b, a, c) if h % 2 else (a, b, c)
            assert end == pytest.approx(np.abs(wanted), abs=1e-9)


def test_edges_are_where_the_kernels_have_them() -> None:
    # The square of half the angle in nil; in sl2 that of the elliptic and the hyperbolic side.
    edge = constant("special/stumpff.h", "STUMPFF_SERIES_BELOW")
    assert (on("nil", "edge of the series")[2] * TIME / 2) ** 2 == pytest.approx(edge)
    c = [abs(r.near(0.0, 1, np.random.default_rng(7))[0][2]) for r in regimes("sl2", TIME)[-2:]]
    assert [(TIME / 2) ** 2 * (2 * level**2 - 1) for level in c] == pytest.approx([edge, -edge])
    assert constant("geometry/sol_phase.h", "CLOSED_BELOW") == module.CLOSED_BELOW
    assert constant("geometry/sol_phase.h", "SHORT_PHASE", "double") == module.SHORT_PHASE
    for precision in ("double", "single"):
        threshold = constant("geometry/sol_phase.h", "PLANAR_BELOW", precision)
        a, b, _ = on("sol", f"planar in {precision}")
        mu = np.sqrt(1 + 2 * abs(a * b))
        at = 2 * np.sqrt(abs(a * b)) / mu * np.exp(mu * TIME / 2)
        assert at == pytest.approx(threshold, rel=1e-6)
        a, b, _ = on("sol", f"planar in {precision}", 0.1)
        assert abs(a * b) == pytest.approx(1.1 * (threshold * np.exp(-TIME / 2) / 2) ** 2)
    a, b, c = on("sol", "closed form")
    modulus = np.sqrt(((abs(a) - abs(b)) ** 2 + c**2) / (1 + 2 * abs(a * b)))
    assert modulus == pytest.approx(module.CLOSED_BELOW)
    a, b, _ = on("sol", "short phase", time=1.6)
    assert np.sqrt(1 + 2 * abs(a * b)) * 1.6 / 2 == pytest.approx(module.SHORT_PHASE)


def test_no_geometry_of_that_name() -> None:
    with pytest.raises(ValueError, match=re.escape("unknown geometry 'e4'; expected one of: e3, s3")):
        regimes("e4", 1.0)
