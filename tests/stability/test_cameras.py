"""Cameras where formulas could degenerate: on axes and fibers, looking along them, on walls, edges and
vertices of cells, at lights, at centers and antipodes of objects, where frames are singular, inside objects.
No pixel is without a number, and a camera that is moved by a millionth sees the same; or the scene is told
what is wrong.
"""

import functools

import numpy as np
import pytest
from golden import Array

from thurston_cl.errors import SceneError
from thurston_cl.geometry import Geometry
from thurston_cl.image import Image
from thurston_cl.lattice import Lattice, domain
from thurston_cl.models import GEOMETRIES
from thurston_cl.scene import load_text

from .pictures import check_finite, differing, picture

each_geometry = pytest.mark.parametrize("geometry", GEOMETRIES)
# How far the camera is moved, and the share of pixels that may show something else then: those whose ray
# passes a silhouette, or grazes something, within that.
MOVED = "move: [{right: 1.0e-6}, {up: -1.0e-6}, {forward: 1.0e-6}]"
NEARLY_ALL = 0.004
# Which way is up where the camera looks along the fiber.
UP = {True: "[1, 0, 0]", False: "[0, 0, 1]"}


def seen(text: str, camera: str) -> Image:
    """The picture by a camera, checked, and held to what it sees from a millionth beside."""
    image, beside = (
        picture(text.replace("CAMERA", f"{camera}, {more}"))
        for more in ("fov: 100 deg", f"fov: 100 deg, {MOVED}")
    )
    for each in (image, beside):
        check_finite(each)
        assert each.statistics["out_of_steps"] <= 0.01 * each.statistics["rays"]
    assert differing(image, beside) <= NEARLY_ALL
    return image


def looking(along: tuple[float, float, float]) -> str:
    across = along[0] or along[1]
    return f"look: {{along: {list(along)}, up: {UP[not across]}}}"


# -- whole spaces --------------------------------------------------------------------------------------------

# Two balls, of which one is on the fiber through the origin, and a half-space; the light is in the open.
SPACE = """
geometry: GEOMETRY
camera: {CAMERA}
objects:
  - {ball: {radius: 0.3}, at: [0, 0, 1.2]}
  - {ball: {radius: 0.25}, at: [0.9, 0.2, -0.3]}
  - half-space: {normal: [1, 0, 0], offset: -1.2}
lights: [{point: {at: [0, 0.4, 0]}, shadows: hard}]
render: {far: 8, steps: 1000}
"""
PLACES = {
    "origin": "[0, 0, 0]",
    "fiber": "[0, 0, -0.7]",
    "plane": "[0, 0.8, 0]",
    "light": "[0, 0.4, 0]",
}
DIRECTIONS = ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 1.0, 0.0))


@pytest.mark.parametrize("place", PLACES)
@each_geometry
def test_on_axes_and_along_them(geometry: str, place: str) -> None:
    text = SPACE.replace("GEOMETRY", geometry)
    objects = set()
    for along in DIRECTIONS:
        image = seen(text, f"at: {PLACES[place]}, {looking(along)}")
        objects |= set(np.unique(image.channels["object"]))
    assert objects >= {1, 2, 3}


# Far sides: the antipodes of the origin, where frames are singular, and of both balls.
ANTIPODES = {
    "s3": ["{model: [0, 0, 0, -1]}", f"[0, 0, {1.2 - np.pi!r}]", "{model: [0, 0, 1, 0]}"],
    "s2xe": ["{model: [0, 0, -1, 0]}", "{model: [0, 0, -1, 1.2]}", "{model: [0, 1, 0, 0]}"],
}


@pytest.mark.parametrize(("geometry", "at"), [(g, at) for g in ANTIPODES for at in ANTIPODES[g]])
def test_at_antipodes(geometry: str, at: str) -> None:
    # A half-space that leaves out the origin holds its antipode.
    ball = "{ball: {radius: 0.2}, at: [-1.2, 0, 0]}"
    text = SPACE.replace("GEOMETRY", geometry).replace("half-space: {normal: [1, 0, 0], offset: -1.2}", ball)
    for along in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 1.0, 1.0)):
        seen(text, f"at: {at}, {looking(along)}")


HOLLOW = """
geometry: GEOMETRY
camera: {CAMERA}
objects: [{complement: {ball: {radius: 1}}, at: AT}]
lights: [{point: {at: AT}}]
render: {steps: 1000}
"""


@pytest.mark.parametrize("at", ["[0, 0, 0]", "[0.4, -0.3, 0.5]"])
@each_geometry
def test_from_the_center_of_a_hollow_ball_all_is_as_far_away(geometry: str, at: str) -> None:
    """And as bright as light and the eye in one place make it where every ray falls upright."""
    text = HOLLOW.replace("GEOMETRY", geometry).replace("AT", at)
    for along in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)):
        image = picture(text.replace("CAMERA", f"at: {at}, {looking(along)}, fov: 140 deg"))
        check_finite(image)
        np.testing.assert_allclose(image.channels["depth"], 1, atol=1.1e-4)
        assert (image.channels["object"] == 1).all()


# -- what is told -------------------------------------------------------------------------------------------


@each_geometry
def test_looking_along_up_is_told(geometry: str) -> None:
    text = SPACE.replace("GEOMETRY", geometry)
    for camera in ("at: [0, 0, 0], look: {along: [0, 0, 1]}", "at: [0, 0, 0], look: {along: [0, 0, -2]}"):
        with pytest.raises(SceneError, match="the direction of view is parallel to up"):
            load_text(text.replace("CAMERA", camera))
    with pytest.raises(SceneError, match="the direction of view is parallel to up"):
        picture(text.replace("CAMERA", "at: [0, 0, 0], look: {to: [0, 0, 1.2]}"))
    with pytest.raises(SceneError, match="the camera stands at the point it looks at"):
        picture(text.replace("CAMERA", "at: [0, 0, 0.1], look: {to: [0, 0, 0.1]}"))


@each_geometry
def test_inside_an_object_is_told(geometry: str) -> None:
    text = SPACE.replace("GEOMETRY", geometry)
    # At the center, somewhere, and just below the surface.
    for at in ("[0, 0, 1.2]", "[0.9, 0.2, -0.2]", "[0, 0, 0.9001]"):
        with pytest.raises(SceneError, match="the camera is inside an object"):
            picture(text.replace("CAMERA", f"at: {at}, look: {{along: [1, 0, 0]}}"))
    # Just above it, where all rays to the ball end soon and the others go on.
    image = picture(text.replace("CAMERA", "at: [0, 0, 0.899], look: {along: [1, 0, 0]}, fov: 120 deg"))
    check_finite(image)
    near = image.channels["depth"] < 0.1
    assert 0.1 < near.mean() < 0.6


# -- cells -------------------------------------------------------------------------------------------------

CELLS = {
    "e3": ("three-torus", 0.3),
    "s3": ("poincare", 0.12),
    "h3": ("seifert-weber", 0.5),
    "s2xe": ("hopf-manifold", 0.5),
    "h2xe": ("genus-two", 0.5),
    "nil": ("heisenberg", 0.25),
    "sl2": ("genus-two", 0.5),
    "sol": ("anosov", 0.12),
}
CELL = """
geometry: GEOMETRY
manifold: NAME
camera: {CAMERA}
objects: [{ball: {radius: RADIUS}}]
lights: [{point: {at: [0, 0, 0], translates: cell}}]
render: {far: 4, steps: 2000}
"""


@functools.cache
def cell(geometry: str) -> tuple[str, Lattice]:
    name, radius = CELLS[geometry]
    text = CELL.replace("GEOMETRY", geometry).replace("NAME", name).replace("RADIUS", str(radius))
    lattice = load_text(text.replace("CAMERA", "")).lattice
    assert lattice is not None
    return text, lattice


def on_wall(lattice: Lattice, along: Array) -> Array:
    """Where the ray from the middle of the cell leaves it."""
    g, low, high = Geometry(lattice.geometry, lanes=1), 0.0, 6.0
    for _ in range(60):
        middle = (low + high) / 2
        inside = lattice.contains(g.flow(along, middle)[0], 0.0)[0]
        low, high = (middle, high) if inside else (low, middle)
    return g.flow(along, low)[0][0]


def places(geometry: str) -> dict[str, Array]:
    _, lattice = cell(geometry)
    found = {"level": on_wall(lattice, np.array([0.0, 0.0, 1.0]))}
    if geometry == "s2xe":
        # Levels are the only walls there.
        return found
    found["side"] = on_wall(lattice, np.array([1.0, 0.0, 0.0]))
    found["edge"] = domain.edges(lattice)[0].point
    found["vertex"] = domain.vertices(lattice)[0].vector
    return found


@pytest.mark.parametrize(
    ("geometry", "place"),
    [
        (geometry, place)
        for geometry in GEOMETRIES
        for place in (("level",) if geometry == "s2xe" else ("level", "side", "edge", "vertex"))
    ],
)
def test_on_walls_edges_and_vertices(geometry: str, place: str) -> None:
    text, _ = cell(geometry)
    at = [float(x) for x in places(geometry)[place]]
    objects = set()
    # Along or across the wall, and back.
    for along in ((1.0, 0.0, 0.0), (-1.0, -0.8, -0.9)):
        image = seen(text, f"at: {{model: {at}}}, {looking(along)}")
        objects |= set(np.unique(image.channels["object"]))
    assert 1 in objects
