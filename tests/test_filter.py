"""Reconstruction filters and seeds: where the samples of a pixel lie, and what that makes of a picture."""

from typing import Any

import numpy as np
import pytest
from scipy.stats import qmc

import thurston_cl as tc
from thurston_cl.image import CHANNELS
from thurston_cl.sampling import FILTERS, GAUSSIAN_DEVIATION, GAUSSIAN_RADIUS, sample_shifts
from thurston_cl.scene import load_text

# Radius and variance along one axis: of the even density on [-1/2, 1/2], of 1 - |x|, and of exp(-2 x^2) cut
# off at 3/2, which is (1 - 6 phi(3)/(2 Phi(3) - 1))/4.
MOMENTS = {"box": (0.5, 1 / 12), "tent": (1.0, 1 / 6), "gaussian": (1.5, 0.24333424)}

SCENE = """
geometry: h3
manifold: ideal-cube
camera: {at: [0.1, 0.05, 0.02], fov: 70 deg}
objects: [{complement: {ball: {radius: 1.02}}}]
"""


def picture(settings: str = "", **arguments: Any) -> tc.Image:
    scene = load_text(f"{SCENE}render: {{{settings}}}\n" if settings else SCENE)
    return tc.render(scene, **{"size": (96, 64), "samples": 4, "channels": CHANNELS} | arguments)


def test_all_filters_are_tested() -> None:
    assert set(MOMENTS) == set(FILTERS)
    assert MOMENTS["gaussian"][0] == GAUSSIAN_RADIUS and GAUSSIAN_DEVIATION == 0.5


@pytest.mark.parametrize("seed", [0, 1, 123456])
@pytest.mark.parametrize("name", MOMENTS)
def test_samples_have_the_moments_of_their_filter(name: str, seed: int) -> None:
    radius, variance = MOMENTS[name]
    away = sample_shifts(4096, name, seed) - 0.5
    assert np.abs(away).max() <= radius
    np.testing.assert_allclose(away.mean(axis=0), 0, atol=2e-3)
    np.testing.assert_allclose((away**2).mean(axis=0), variance, rtol=4e-3)
    assert abs((away[:, 0] * away[:, 1]).mean()) <= 2e-3
    # Both ends are reached: nothing is cut off before.
    assert np.abs(away).max() >= 0.93 * radius


@pytest.mark.parametrize(
    ("name", "distribution"),
    [
        ("box", lambda x: x + 0.5),
        ("tent", lambda x: np.where(x < 0, (1 + x) ** 2 / 2, 1 - (1 - x) ** 2 / 2)),
    ],
)
def test_samples_follow_the_distribution(name: str, distribution: Any) -> None:
    """Bent back by the distribution of the filter they are even."""
    u = distribution(sample_shifts(1024, name, 3) - 0.5)
    counts, _ = np.histogram(u[:, 0], bins=32, range=(0, 1))
    assert counts.min() >= 29 and counts.max() <= 35
    assert qmc.discrepancy(u) < 1e-4


def test_the_first_sample_of_seed_0_is_in_the_middle_and_of_others_elsewhere() -> None:
    for name in FILTERS:
        np.testing.assert_array_equal(sample_shifts(1, name)[0], [0.5, 0.5])
        assert np.abs(sample_shifts(1, name, 1)[0] - 0.5).min() > 0.05


def test_seeds_are_rotations_of_one_sequence_that_fill_the_square_together() -> None:
    first, second = sample_shifts(64), sample_shifts(64, seed=7)
    turn = (second - first) % 1.0
    np.testing.assert_allclose(turn, np.broadcast_to(turn[0], turn.shape), atol=1e-12)
    together = np.concatenate([sample_shifts(16, seed=seed) for seed in range(16)])
    assert qmc.discrepancy(together) < 0.1 * qmc.discrepancy(np.random.default_rng(0).random((256, 2)))


def test_a_seed_gives_the_same_picture_to_the_last_bit_and_another_seed_another() -> None:
    for name in FILTERS:
        one, again = picture(f"filter: {name}, seed: 3"), picture(f"filter: {name}, seed: 3")
        other = picture(f"filter: {name}, seed: 4")
        for channel in CHANNELS:
            np.testing.assert_array_equal(one.channels[channel], again.channels[channel])
        assert not np.array_equal(one.channels["beauty"], other.channels["beauty"])


def test_with_seed_0_the_other_channels_do_not_depend_on_the_filter() -> None:
    box = picture()
    for name in ("tent", "gaussian"):
        filtered = picture(f"filter: {name}")
        for channel in CHANNELS[1:]:
            np.testing.assert_array_equal(filtered.channels[channel], box.channels[channel])
        assert not np.array_equal(filtered.channels["beauty"], box.channels["beauty"])


def test_a_filter_makes_a_picture_smoother_and_not_brighter() -> None:
    images = {name: picture(f"filter: {name}", samples=32).channels["beauty"] for name in FILTERS}
    box = images["box"]
    for name in ("tent", "gaussian"):
        # Except what filters move over the edges of the picture.
        np.testing.assert_allclose(images[name].mean(axis=(0, 1)), box.mean(axis=(0, 1)), rtol=5e-3)
    roughness = {name: np.abs(np.diff(image, axis=1)).mean() for name, image in images.items()}
    assert roughness["gaussian"] < 0.95 * roughness["tent"] < 0.9 * roughness["box"]
