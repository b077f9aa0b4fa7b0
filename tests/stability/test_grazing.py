"""Rays that graze: silhouettes of balls and cylinders and horizons of half-spaces against the exact angle
at which they stand, depths right up to there, rays that touch, run along planes and along edges of cells, in
surfaces that are totally geodesic, and out into the open.
"""

import numpy as np
import pytest
from golden import EPSILON, Array

from thurston_cl.device import Device
from thurston_cl.lattice import domain

from .pictures import PRECISIONS, check_finite, differing, picture, share
from .test_cameras import cell, seen

CURVATURE = {"e3": 0, "s3": 1, "h3": -1, "s2xe": 1, "h2xe": -1, "sol": -1}
THRESHOLD = 1e-4  # by default, of the distance at which a ray has hit
both_precisions = pytest.mark.parametrize("precision", PRECISIONS)


def sine(k: int, t: Array | float) -> Array:
    return np.asarray({0: lambda x: x, 1: np.sin, -1: np.sinh}[k](t))


def angles(size: tuple[int, int], fov: float) -> tuple[Array, Array]:
    """Of the pixels (H,W) of a picture in perspective: how far from forward, and how far above."""
    x, y = np.meshgrid(np.arange(size[0]) + 0.5 - size[0] / 2, size[1] / 2 - np.arange(size[1]) - 0.5)
    scale = 2 * np.tan(fov / 2) / size[1]
    flat = np.hypot(x, y) * scale
    return np.arctan(flat), np.arctan(y * scale / np.hypot(1, x * scale))


# -- silhouettes ---------------------------------------------------------------------------------------------

# The radius of a ball and how far away it is. In s3 it is seen larger again beyond a quarter turn.
BALLS = {
    "e3": [(0.3, 1.0), (0.01, 1.0), (0.5, 50.0), (0.9, 1.0)],
    "s3": [(0.3, 1.0), (0.01, 1.0), (0.3, 1.5), (0.3, 2.7)],
    "h3": [(0.3, 1.0), (0.01, 1.0), (0.5, 3.0), (2.0, 4.0)],
}
BALL = """
geometry: GEOMETRY
camera: {at: [0, 0, 0], look: {along: [0.6, 0.64, 0.48]}, fov: FOV rad}
objects: [{ball: {radius: RADIUS}, at: CENTER}]
render: {far: FAR, steps: 1000}
"""
# Once around s3 rays pass by again.
FAR = {"e3": 60.0, "s3": 3.2, "h3": 20.0, "s2xe": 3.2, "h2xe": 20.0}
SIZE = (64, 64)


def silhouette(k: int, radius: float, distance: float) -> float:
    """The angle between the middle of a ball and its rim: S(r)/S(d) is its sine."""
    return float(np.arcsin(sine(k, radius) / sine(k, distance)))


def ball_text(geometry: str, radius: float, distance: float, fov: float) -> str:
    text = BALL.replace("GEOMETRY", geometry).replace("FOV", repr(fov)).replace("FAR", repr(FAR[geometry]))
    text = text.replace("RADIUS", repr(radius))
    return text.replace("CENTER", str([0.6 * distance, 0.64 * distance, 0.48 * distance]))


@both_precisions
@pytest.mark.parametrize(("geometry", "ball"), [(g, ball) for g in BALLS for ball in BALLS[g]])
def test_a_ball_is_seen_up_to_its_silhouette(
    geometry: str, ball: tuple[float, float], precision: str
) -> None:
    """To a twentieth of a pixel, beside what the threshold adds to the ball."""
    k, (radius, distance) = CURVATURE[geometry], ball
    rim = silhouette(k, radius, distance)
    fov = min(3 * rim, 2.8)
    image = picture(ball_text(geometry, radius, distance, fov), size=SIZE, precision=precision)
    check_finite(image)
    away, _ = angles(SIZE, fov)
    hit, pixel = image.channels["object"] == 1, fov / SIZE[1]
    # A ball that the threshold makes reach the camera is seen everywhere.
    grown = radius + THRESHOLD
    outer = silhouette(k, grown, distance) if sine(k, grown) < sine(k, distance) else np.pi / 2
    assert hit[away < rim - 0.05 * pixel].all()
    assert not hit[away > outer + 0.05 * pixel].any()
    assert 0.05 < share(hit) < 0.99
    assert image.statistics["out_of_steps"] == 0
    check_depths(image.channels["depth"], k, radius, distance, away, EPSILON[precision])


def check_depths(depth: Array, k: int, radius: float, distance: float, away: Array, epsilon: float) -> None:
    """Where rays end: so far from the center of the ball as the law of cosines says, within the threshold."""
    t = depth.astype(np.float64)
    hit = np.isfinite(t)
    t, away = t[hit], away[hit]
    if k == 0:
        from_center = np.sqrt(distance**2 + t**2 - 2 * distance * t * np.cos(away))
    else:
        c, ends = (np.cos, np.arccos) if k == 1 else (np.cosh, np.arccosh)
        from_center = ends(c(t) * c(distance) + k * sine(k, t) * sine(k, distance) * np.cos(away))
    slack = THRESHOLD + 8 * epsilon * np.exp((k == -1) * 2 * distance) + 4e-7 * distance
    assert (from_center < radius + slack).all()
    assert (from_center > radius - slack).all()


# The same in the plane across a cylinder that the camera looks at, a row of the picture.
CYLINDER = """
geometry: GEOMETRY
camera: {at: [0, 0, 0], look: {along: [1, 0, 0]}, fov: FOV rad}
objects: [{cylinder: {radius: RADIUS}, at: [DISTANCE, 0, 0]}]
render: {far: FAR, steps: 1000}
"""


@pytest.mark.parametrize("geometry", ["e3", "s3", "h3", "s2xe", "h2xe"])
def test_a_cylinder_is_seen_up_to_its_silhouette(geometry: str) -> None:
    """Up to pi away in s2xe, whose cylinders stand on circles, and a quarter turn in s3."""
    k = CURVATURE[geometry]
    for radius, distance in ((0.3, 1.0), (0.02, 1.2), (0.7, 1.4)):
        rim, size = silhouette(k, radius, distance), (65, 33)
        fov = min(2 * rim, 2.0)
        text = CYLINDER.replace("GEOMETRY", geometry).replace("FOV", repr(fov))
        text = text.replace("FAR", repr(FAR[geometry]))
        image = picture(text.replace("RADIUS", repr(radius)).replace("DISTANCE", repr(distance)), size=size)
        check_finite(image)
        away, _ = angles(size, fov)
        hit, away, pixel = image.channels["object"][16] == 1, away[16], fov / size[1]
        outer = silhouette(k, radius + THRESHOLD, distance)
        assert hit[away < rim - 0.05 * pixel].all()
        assert not hit[(away > outer + 0.05 * pixel) & (away < np.pi / 2)].any()


# A half-space below the camera.
HORIZON = """
geometry: GEOMETRY
camera: {at: [0, 0, 0], look: {along: [1, 0, 0]}, fov: 100 deg}
objects: [{half-space: {normal: [0, 0, 1], offset: -HEIGHT}}]
render: {far: FAR, steps: STEPS}
"""


def horizon(geometry: str, height: float, far: float = 20.0, steps: int = 3000) -> str:
    text = HORIZON.replace("GEOMETRY", geometry).replace("HEIGHT", repr(height))
    return text.replace("FAR", repr(far)).replace("STEPS", str(steps))


@both_precisions
@pytest.mark.parametrize("height", [0.02, 0.5, 2.0])
def test_the_horizon_of_a_half_space(height: float, precision: str) -> None:
    """In e3 as far down as rays of length `far` reach; in h3 at the angle of parallelism, of which they see
    all but nothing. In s3 there is none."""
    size, fov, far = (33, 129), np.radians(100), 20.0
    _, above = angles(size, fov)
    down, pixel = np.sin(-above), fov / size[1]
    reach = {"e3": height / far, "h3": np.tanh(height) / np.tanh(far)}
    for geometry, least in reach.items():
        image = picture(horizon(geometry, height, far), size=size, precision=precision)
        check_finite(image)
        hit = image.channels["object"] == 1
        edge = np.arcsin(least)
        assert hit[-above > edge + 0.05 * pixel].all(), geometry
        outer = np.arcsin((height - THRESHOLD) / far if geometry == "e3" else np.tanh(height - THRESHOLD))
        assert not hit[-above < outer - 0.05 * pixel].any(), geometry
        # How high rays end.
        t, d = image.channels["depth"][hit].astype(np.float64), down[hit]
        if geometry == "e3":
            end = height - t * d
        else:
            end = np.arcsinh(np.sinh(height) * np.cosh(t) - np.cosh(height) * np.sinh(t) * d)
        slack = 8 * EPSILON[precision] * (1 + t if geometry == "e3" else np.exp(t))
        assert (end < THRESHOLD + slack).all() and (end > -slack).all(), geometry
    image = picture(horizon("s3", min(height, 1.5)), size=size, precision=precision)
    assert (image.channels["object"] == 1).all()


# How many rows of rays may run out of the 300 steps that there are by default, 0.02 above a half-space: in e3
# the one that is level, in h3 the next below, on which every step takes the same small part of the height.
ROWS_OUT = {"e3": 1, "s3": 0, "h3": 1, "s2xe": 0, "h2xe": 0, "nil": 0, "sl2": 0, "sol": 0}


@pytest.mark.parametrize("geometry", ROWS_OUT)
def test_few_rays_along_a_plane_run_out_of_steps(geometry: str) -> None:
    size = (49, 97)
    image = picture(horizon(geometry, 0.02, steps=300), size=size)
    check_finite(image)
    assert 0.3 < share(image.channels["object"]) <= 1
    assert image.statistics["out_of_steps"] <= ROWS_OUT[geometry] * size[0]


SKY = """
geometry: GEOMETRY
camera: {at: [0, 0, 0], look: {along: [1, 0, 0]}, fov: 120 deg}
objects: [{half-space: {normal: [1, 0, 0], offset: -HEIGHT}}]
render: {far: FAR, steps: 3000}
"""


@both_precisions
@pytest.mark.parametrize("geometry", ["e3", "h3", "h2xe"])
def test_rays_that_go_out_into_the_open_do_not_come_back(geometry: str, precision: str) -> None:
    """At lengths of 20, by default, and 40 coordinates have lost the direction of h3."""
    for height in (0.02, 0.5, 3.0):
        for far in (20, 40):
            text = SKY.replace("GEOMETRY", geometry).replace("HEIGHT", str(height)).replace("FAR", str(far))
            image = picture(text, precision=precision)
            check_finite(image)
            assert not image.channels["object"].any(), (height, far)


@pytest.mark.parametrize("geometry", ["nil", "sl2", "sol"])
def test_rays_that_wind_come_back_in_both_precisions_alike(geometry: str, opencl_device: Device) -> None:
    """Geodesics that leave a vertical plane meet it again in nil and sl2."""
    if not opencl_device.info.fp64:
        pytest.skip("the device has no double precision")
    for height in (0.02, 3.0):
        text = SKY.replace("GEOMETRY", geometry).replace("HEIGHT", str(height)).replace("FAR", "40")
        single, double = (picture(text, precision=precision) for precision in PRECISIONS)
        check_finite(single)
        assert differing(single, double) <= 0.001


# -- rays that touch -----------------------------------------------------------------------------------------

TOUCHING = """
geometry: GEOMETRY
camera: {at: [0, 0, 0], look: {along: [1, 0, 0]}, fov: 1.0e-3 deg}
objects: [{SOLID}]
render: {far: 5, steps: 1000}
"""


@both_precisions
@pytest.mark.parametrize("geometry", ["e3", "s3", "h3"])
def test_rays_that_touch_a_ball(geometry: str, precision: str) -> None:
    """Rays that leave within a thousandth of a degree of one that touches: they end a threshold before the
    point of touch or so, as far as the square root of the threshold, or run past it."""
    # The center is 0.4 at right angles from where the ray is at the length 1.
    k = CURVATURE[geometry]
    c, s = {0: (lambda t: 1.0, float), 1: (np.cos, np.sin), -1: (np.cosh, np.sinh)}[k]
    model = [float(x) for x in (s(1.0) * c(0.4), 0.0, s(0.4), c(1.0) * c(0.4))]
    text = TOUCHING.replace("GEOMETRY", geometry)
    text = text.replace("SOLID", f"ball: {{radius: 0.4}}, at: {{model: {model}}}")
    image = picture(text, size=(33, 33), precision=precision)
    check_finite(image)
    assert image.statistics["out_of_steps"] == 0
    assert (image.channels["object"] == 1).all()
    np.testing.assert_allclose(image.channels["depth"], 1, atol=2 * np.sqrt(THRESHOLD))


# -- walls and edges of cells --------------------------------------------------------------------------------


@pytest.mark.parametrize("geometry", ["e3", "s3", "h3", "h2xe", "nil", "sl2", "sol"])
def test_along_the_edge_of_a_cell(geometry: str) -> None:
    text, lattice = cell(geometry)
    edge = domain.edges(lattice)[0]
    at = [float(x) for x in edge.point]
    # Upright edges, and those of s3 and h3, which are perpendicular to the plane z = 0.
    image = seen(text, f"at: {{model: {at}}}, look: {{along: [0, 0, 1], up: [1, 0, 0]}}")
    assert (image.channels["object"] == 1).any()


# -- surfaces that are totally geodesic ----------------------------------------------------------------------

# Where a ball 1.2 ahead and the row of the picture lie: planes of curvature -1 in sol, H2, S2, and flat ones.
SURFACES = {
    "sol-x": ("sol", -1, (0.0, 0.6, 0.8), (1.0, 0.0, 0.0)),
    "sol-y": ("sol", -1, (0.8, 0.0, -0.6), (0.0, 1.0, 0.0)),
    "h2xe-level": ("h2xe", -1, (0.6, 0.8, 0.0), (0.0, 0.0, 1.0)),
    "s2xe-level": ("s2xe", 1, (0.6, 0.8, 0.0), (0.0, 0.0, 1.0)),
    "h2xe-upright": ("h2xe", 0, (0.8, 0.0, 0.6), (0.0, 1.0, 0.0)),
    "s2xe-upright": ("s2xe", 0, (0.8, 0.0, 0.6), (0.0, 1.0, 0.0)),
}
IN_SURFACE = """
geometry: GEOMETRY
camera: {at: [0, 0, 0], look: {along: ALONG, up: UP}, fov: FOV rad}
objects: [{ball: {radius: 0.3}, at: CENTER}]
render: {far: 5, steps: 1000}
"""


@both_precisions
@pytest.mark.parametrize("name", SURFACES)
def test_rays_in_a_totally_geodesic_surface(name: str, precision: str) -> None:
    geometry, k, along, up = SURFACES[name]
    radius, distance = 0.3, 1.2
    rim, size = silhouette(k, radius, distance), (129, 33)
    fov = 0.6 * rim
    text = IN_SURFACE.replace("GEOMETRY", geometry).replace("FOV", repr(fov)).replace("UP", str(list(up)))
    center = [x * distance for x in along]
    text = text.replace("ALONG", str(list(along))).replace("CENTER", str(center))
    image = picture(text, size=size, precision=precision)
    check_finite(image)
    away, _ = angles(size, fov)
    pixel = fov / size[1]
    hit = image.channels["object"][16] == 1
    outer = silhouette(k, radius + THRESHOLD, distance)
    assert hit[away[16] < rim - 0.05 * pixel].all()
    assert not hit[away[16] > outer + 0.05 * pixel].any()
    assert 0.2 < share(hit) < 0.99
    check_depths(image.channels["depth"][16], k, radius, distance, away[16], EPSILON[precision])
