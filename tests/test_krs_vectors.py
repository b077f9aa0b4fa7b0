"""Vectors of recipes and records of sequences: lengths and directions of all sizes, and what is across."""

import numpy as np
import pytest

from thurston_cl.krs.vectors import across, length_of, two_across, unit

VECTORS = np.random.default_rng(1).normal(size=(200, 3))


@pytest.mark.parametrize("size", [1.0, 1e300, 1e-300])
def test_lengths_and_directions(size: float) -> None:
    want = np.sqrt((VECTORS**2).sum(axis=1))
    np.testing.assert_allclose(length_of(size * VECTORS), size * want, rtol=1e-15)
    np.testing.assert_allclose(unit(size * VECTORS), VECTORS / want[:, None], rtol=1e-15, atol=1e-16)
    # Of one vector as of many.
    np.testing.assert_array_equal(unit(size * VECTORS[7]), unit(size * VECTORS)[7])
    assert length_of(size * VECTORS[7]) == length_of(size * VECTORS)[7]


def test_a_zero_vector_has_a_length_and_no_direction() -> None:
    assert length_of([0, 0, 0]) == 0
    with np.errstate(invalid="ignore"):
        assert np.isnan(unit([0, 0, 0])).all()


def test_what_is_across() -> None:
    for axis, wanted in zip(unit(VECTORS), unit(VECTORS[::-1]), strict=True):
        frame = np.array([axis, *two_across(axis)])
        np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-15)
        assert np.linalg.det(frame) == pytest.approx(1, abs=1e-14)
        nearest = across(axis, wanted)
        assert length_of(nearest) == pytest.approx(1, abs=1e-14)
        assert nearest @ axis == pytest.approx(0, abs=1e-13)
        # The best of all directions that are perpendicular: as near as the plane is.
        assert nearest @ wanted == pytest.approx(np.sqrt(1 - (axis @ wanted) ** 2), abs=1e-13)
