"""How large an angle error is in a picture: half a pixel as an angle (paper A.2.2)."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thurston_cl.scene.picture import Size, eye_size
from thurston_cl.scene.schema import Camera

Array = NDArray[np.float64]


def half_pixel(width: float, field_of_view: float) -> float:
    """Half a pixel at the border of a perspective picture, where it is the smallest angle, in radians.

    width: of the picture in pixels. field_of_view: across that width, in radians, below pi. Paper A.2.2:
    tan(da) = dm sin(b)/(1 + 2 dm sin^2(b/2)) with dm = 1/(2 width). ValueError for what is no picture.
    """
    if not (width >= 1 and 0 < field_of_view < math.pi):
        raise ValueError(
            f"a picture {width:g} pixels wide with {field_of_view:g} radians across; expected at least one "
            "pixel, and an angle between 0 and pi"
        )
    shift = 0.5 / width
    below = 1 + 2 * shift * math.sin(0.5 * field_of_view) ** 2
    return math.atan2(shift * math.sin(field_of_view), below)


def half_pixels(camera: Camera, size: Size, x: ArrayLike, y: ArrayLike) -> Array:
    """Half a pixel as an angle (N,) in radians, at places x, y (N,) in the picture of one eye.

    size: of the whole picture, both eyes included. In a perspective it is counted away from the middle, where
    angles are the smallest. Elsewhere it is the same at all places: in an equirectangular picture that
    between rows, in a fisheye and a dome that between circles about the middle.
    """
    width, height = eye_size(camera.layout, size)
    x, y = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
    circle = camera.projection.fisheye or camera.projection.dome
    if circle is not None:
        return np.full(x.shape, 0.5 * circle.angle / min(width, height))
    if camera.projection.perspective is None:
        return np.full(x.shape, 0.5 * math.pi / height)
    # Tangents of the angle from forward, here and half a pixel farther out.
    scale = 2 * math.tan(0.5 * camera.fov) / height
    tangent = scale * np.hypot(x - 0.5 * width, y - 0.5 * height)
    return np.arctan2(0.5 * scale, 1 + tangent * (tangent + 0.5 * scale))
