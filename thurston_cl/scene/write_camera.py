"""OpenCL text for the camera: how rays start, and the numbers of each eye that they start from."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thurston_cl.scene import schema
from thurston_cl.scene.picture import Size, eye_size
from thurston_cl.scene.placement import CameraFrame
from thurston_cl.scene.writer import Writer

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Eyes:
    """Where the camera's numbers stand in the constant buffer, and what they are for each eye (E,n), the left
    one first.
    """

    place: int
    numbers: Array

    def buffers(self, numbers: Array) -> tuple[Array, ...]:
        """The constant buffer of each eye, from that of the scene."""
        copies = tuple(numbers.copy() for _ in self.numbers)
        for copy, own in zip(copies, self.numbers, strict=True):
            copy[self.place : self.place + len(own)] = own
        return copies


def write_camera(writer: Writer, camera: CameraFrame, size: Size) -> Eyes:
    """Add view_ray, for a picture of `size` that has both eyes in it, and in_picture where it is round.

    Both eyes share the program. They are flowed to from the camera, which stands in the cell, and are not led
    into it: the marcher does that, and counts the cells on the way. SceneError for eyes too far away.
    """
    scene = writer.scene.camera
    reaches = [0.0] if scene.stereo is None else [-0.5 * scene.stereo.distance, 0.5 * scene.stereo.distance]
    try:
        stand = [camera.eye(reach) for reach in reaches]
    except ValueError as error:
        place = ("camera", "stereo", "distance")
        message = "the eyes are too far apart to be computed with"
        raise writer.scene.error_at(place, message, "make the distance smaller") from error
    # Where the eyes turn with the column the kernel flows to them. At the distance 0 they stay.
    turning = scene.projection.equirectangular is not None and any(reaches)
    seen = eye_size(scene.layout, size)
    rows = []
    for eye, reach in zip(stand, reaches, strict=True):
        start = camera if turning else eye
        own = [reach] if turning else _own_numbers(scene)
        rows.append([*start.point, *_facing(scene.projection, start.frame).ravel(), *seen, *own])
    first = writer.numbers.add(rows[0])
    _write_start(writer, "omnidirectional" if turning else scene.projection.kind, first)
    return Eyes(first, np.array(rows))


def pixel_angle(camera: schema.Camera, size: Size) -> float:
    """The angle between the rays of neighbouring pixels, in the middle of a picture of `size`."""
    width, height = eye_size(camera.layout, size)
    circle = camera.projection.fisheye or camera.projection.dome
    if circle is not None:
        return circle.angle / min(width, height)
    perspective = camera.projection.perspective is not None
    return (2 * math.tan(0.5 * camera.fov) if perspective else math.pi) / height


def _facing(projection: schema.Projection, frame: Array) -> Array:
    """Right, up and forward of the picture (rows): a dome is a fisheye that looks up, its back on top."""
    if projection.dome is None:
        return frame
    right, up, forward = frame
    cosine, sine = math.cos(projection.dome.tilt), math.sin(projection.dome.tilt)
    return np.stack([right, sine * up - cosine * forward, cosine * up + sine * forward])


def _own_numbers(camera: schema.Camera) -> list[float]:
    """The numbers of the projection after those of kernels/camera/frame.h."""
    circle = camera.projection.fisheye or camera.projection.dome
    if circle is not None:
        return [0.5 * circle.angle]
    return [math.tan(0.5 * camera.fov)] if camera.projection.perspective is not None else []


def _write_start(writer: Writer, kind: str, place: int) -> None:
    head = "ray view_ray(real x, real y, scene_data scene)"
    kernel = "fisheye" if kind == "dome" else kind
    writer.parts.add(f"camera/{kernel}.h")
    if kind == "omnidirectional":
        writer.parts.add("camera/equirectangular.h")
        writer.function(head, [f"return omnidirectional(x, y, scene, {place});"])
        return
    start = [
        f"point p = four_numbers(scene, {place});",
        f"return new_ray(p, push(p, {kernel}(x, y, scene, {place})));",
    ]
    writer.function(head, start)
    if kernel == "fisheye":
        writer.function(
            "mask in_picture(real x, real y, scene_data scene)", [f"return in_circle(x, y, scene, {place});"]
        )
