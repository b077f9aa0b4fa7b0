"""thurston_cl: an OpenCL renderer and numerical back-end for Thurston's geometries."""

from thurston_cl.errors import NoDeviceError, SceneError, ThurstonError
from thurston_cl.geometry import Geometry

__all__ = ["Geometry", "NoDeviceError", "SceneError", "ThurstonError"]
