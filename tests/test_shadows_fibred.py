"""Hard shadows in nil and sl2 against brute force: light along one geodesic is missing exactly
where a sampled point of that geodesic, from the surface to the light, lies in an object.
"""

from typing import NamedTuple

import numpy as np
import pytest
from camera_rays import view

import thurston_cl as tc
from thurston_cl.scene import load_text
from thurston_cl.scene.placement import CameraFrame, Placement

SIZE = (40, 30)
FOV = np.radians(100)
SAMPLES = 100
# What a render and samples may disagree about: geodesics that pass an object this closely, or leave their own
# surface this flatly.
GRAZING = 0.02
OWN_SURFACE = 0.1


class Stage(NamedTuple):
    camera: str
    normal: tuple[float, float, float]
    offset: float
    ball: tuple[float, float, float]
    light: tuple[float, float, float]


RADIUS = 0.5
STAGES = {
    "horizontal": Stage(
        "at: [-1.6, -0.6, 1.2], look: {to: [0, 0, -0.2]}", (0, 0, 1), -0.6, (0.1, 0, 0.1), (0.5, 0.4, 1.6)
    ),
    # So far up the fibre that there is a second geodesic.
    "high light": Stage(
        "at: [-1.6, -0.6, 1.2], look: {to: [0, 0, -0.2]}", (0, 0, 1), -0.6, (0.1, 0, 0.6), (0.2, 0.1, 8.5)
    ),
    "vertical": Stage(
        "at: [1.7, -0.8, 0.4], look: {to: [0, 0.1, 0]}", (1, 0, 0), -0.5, (0.2, 0.1, 0.1), (1.5, 0.5, 0.5)
    ),
}


def scene_text(geometry: str, stage: Stage, geodesics: int, shadows: str) -> str:
    material = "{specular: 0, diffuse: 1, ambient: 0}"
    return f"""
geometry: {geometry}
camera: {{{stage.camera}, fov: 100 deg}}
objects:
  - ball: {{radius: {RADIUS}}}
    at: {list(stage.ball)}
    material: {material}
  - half-space: {{normal: {list(stage.normal)}, offset: {stage.offset}}}
    material: {material}
lights:
  - point: {{at: {list(stage.light)}, falloff: constant, geodesics: {geodesics}}}
    {shadows}
render: {{far: 6, threshold: 1.0e-4, steps: 4000}}
"""


def above(g: tc.Geometry, stage: Stage, p: np.ndarray) -> np.ndarray:
    """How far points (N,4) are outside the half-space, as a length or a difference of levels."""
    if stage.normal[2]:
        return np.asarray(p[:, 2 if g.name == "nil" else 3] - stage.offset)
    on_plane = np.broadcast_to(g.flow(np.array(stage.normal), stage.offset)[0], p.shape)
    x = g.untranslate(on_plane, p)[:, 0]
    return np.asarray(x if g.name == "nil" else np.arcsinh(x))


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("stage", STAGES)
@pytest.mark.parametrize("geometry", ["nil", "sl2"])
def test_a_shadow_is_where_the_geodesic_to_the_light_meets_an_object(
    geometry: str, stage: str, precision: str
) -> None:
    set_up, g = STAGES[stage], tc.Geometry(geometry, "double")

    def picture(geodesics: int, shadows: str = "") -> tc.Image:
        scene = load_text(scene_text(geometry, set_up, geodesics, shadows))
        channels = ("depth", "object", "beauty")
        return tc.render(scene, size=SIZE, samples=1, precision=precision, channels=channels)

    lit = [picture(count) for count in (1, 2)]
    shaded = [picture(count, "shadows: hard") for count in (1, 2)]
    for image in (lit[1], *shaded):
        for name in ("depth", "object"):
            np.testing.assert_array_equal(image.channels[name], lit[0].channels[name], err_msg=name)

    scene, place = load_text(scene_text(geometry, set_up, 1, "")), Placement(g)
    camera = CameraFrame(scene.camera, place)
    ball, light = place.point(set_up.ball), place.point(set_up.light)
    depth, seen = (lit[0].channels[name].ravel() for name in ("depth", "object"))
    hit = seen > 0
    assert (seen == 1).sum() > 12 and (seen == 2).sum() > 100
    points, _ = g.flow(view(camera, SIZE, FOV)[hit], depth[hit].astype(float), base=camera.point)
    on_ball = seen[hit] == 1
    assert np.abs(g.distance(points[on_ball], ball) - RADIUS).max() < 1e-3
    assert np.abs(above(g, set_up, points[~on_ball])).max() < 1e-3

    def light_of(image: tc.Image) -> np.ndarray:
        return np.asarray(image.channels["beauty"].astype(float).sum(axis=2).ravel()[hit])

    u, lengths = g.geodesics(light, 2, points)
    # What is given along each geodesic alone, without shadows, and with.
    first, first_shaded = light_of(lit[0]), light_of(shaded[0])
    second, second_shaded = light_of(lit[1]) - first, light_of(shaded[1]) - first_shaded
    share = np.zeros(2)
    for k, (bare, got) in enumerate(((first, first_shaded), (second, second_shaded))):
        shining = np.isfinite(lengths[:, k]) & (bare > 0.05)
        if k == 0 or stage == "high light":
            assert shining.sum() > 10, (k, shining.sum())
        if not shining.any():
            continue
        times = lengths[shining, k, None] * np.linspace(0, 1, SAMPLES)
        count = len(times)
        way, _ = g.flow(
            np.repeat(u[shining, k], SAMPLES, axis=0),
            times.ravel(),
            base=np.repeat(points[shining], SAMPLES, axis=0),
        )
        gaps = {
            True: (g.distance(way, np.broadcast_to(ball, way.shape)) - RADIUS).reshape(count, SAMPLES),
            False: above(g, set_up, way).reshape(count, SAMPLES),
        }
        least = np.full(count, np.inf)
        for of_ball, gap in gaps.items():
            leaving = (on_ball[shining] == of_ball)[:, None] & (times < OWN_SURFACE)
            least = np.minimum(least, np.where(leaving, np.inf, gap).min(axis=1))
        clear = np.abs(least) > GRAZING
        assert clear.mean() > 0.8, (k, clear.mean())
        hidden = least < 0
        want = np.where(hidden, 0, bare[shining])
        off = np.abs(got[shining] - want) > 1e-3
        assert not (off & clear).any(), (k, points[shining][off & clear][:3], least[off & clear][:3])
        share[k] = hidden.mean()
    # Neither nothing nor everything, or nothing is shown.
    assert 0.02 < share.max() < 0.9, share
