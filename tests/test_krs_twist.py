"""Twisted sequences in scenes: what they show from near and from afar."""

import numpy as np
import pytest

from thurston_cl.image import Image
from thurston_cl.rendering import render
from thurston_cl.scene import load_text

SIZE = (96, 64)
# Two rods on the axis, one of them an image of the other, and a ball between them.
ON_AXIS = (
    "kernel: {capsule: {from: [0, 0, -1.5], to: [0, 0, -0.5], radius: 0.3}}, "
    "levels: [{mirror: {normal: [0, 0, 1]}, kernel: {ball: {radius: 0.4}}}]"
)
# Away from it two balls, which the twist shears.
ASIDE = "kernel: {ball: {radius: 0.4, at: [-1, 0, 0.8]}}, levels: [{mirror: {normal: [1, 0, 0]}}]"


def picture(sequence: str, twist: str, eye: float = 6.0, settings: str = "") -> Image:
    text = (
        f"geometry: e3\ncamera: {{at: [{-eye}, 0.3, 0.2], look: {{to: [0, 0, 0]}}, fov: {240 / eye} deg}}\n"
        f"objects: [{{krs: {{{sequence}, twist: {{angle: {twist}}}}}}}]\n"
        f"background: white\nrender: {{precision: double, threshold: 1e-6, far: 1e4{settings}}}\n"
    )
    return render(load_text(text), size=SIZE, samples=1)


@pytest.mark.parametrize("eye", [3.0, 60.0])
@pytest.mark.parametrize("twist", ["20 deg", "-200 deg"])
def test_what_is_round_about_the_axis_stays_as_it_is(twist: str, eye: float) -> None:
    plain, twisted = (picture(ON_AXIS, angle, eye).channels for angle in ("0 deg", twist))
    hit = plain["object"] > 0
    assert 0.05 < hit.mean() < 0.6
    # Rays that graze it end at it or not.
    assert np.mean(hit != (twisted["object"] > 0)) < 0.005
    both = hit & (twisted["object"] > 0)
    assert np.quantile(np.abs(plain["depth"][both] - twisted["depth"][both]), 0.99) < 1e-4


def test_hits_are_where_the_model_is_turned() -> None:
    """What is seen is on the surface of the model when it is turned about the axis by the rate times z."""
    rate = np.radians(50)
    image = picture(ASIDE, "50 deg")
    eye = np.array([-6.0, 0.3, 0.2])
    forward = -eye / np.linalg.norm(eye)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    up, half = np.cross(right, forward), np.tan(np.radians(20))
    columns, rows = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    x, y = (2 * columns - SIZE[0]) / SIZE[1] * half, (1 - 2 * rows / SIZE[1]) * half
    rays = forward + x[..., None] * right + y[..., None] * up
    rays /= np.linalg.norm(rays, axis=-1)[..., None]
    hit = image.channels["object"] > 0
    assert hit.mean() > 0.03
    p = eye + image.channels["depth"][hit][:, None] * rays[hit]
    c, s = np.cos(rate * p[:, 2]), np.sin(rate * p[:, 2])
    turned = np.stack([c * p[:, 0] - s * p[:, 1], s * p[:, 0] + c * p[:, 1], p[:, 2]], axis=-1)
    off = np.abs(np.linalg.norm(np.abs(turned) - (1, 0, 0.8), axis=-1) - 0.4)
    assert np.quantile(off, 0.98) < 1e-4


def test_rays_that_leave_a_twisted_sequence_do_not_creep() -> None:
    """Far from the axis a twist stretches without bound, but what it twists is near."""
    statistics = picture(ASIDE, "90 deg", settings=", steps: 80").statistics
    assert statistics["out_of_steps"] < 0.01 * statistics["rays"]
