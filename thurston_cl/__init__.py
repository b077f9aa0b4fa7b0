"""thurston_cl: an OpenCL renderer and numerical back-end for Thurston's geometries.

    import thurston_cl as tc
    g = tc.Geometry("h3")                     # numerics over arrays: flow, distance, geodesics, area density
    image = tc.render(tc.load_scene("h3/seifert-weber"))  # image.channels["beauty"], ["depth"], ... are arrays
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from thurston_cl import krs, special
    from thurston_cl.errors import NoDeviceError, SceneError, ThurstonError
    from thurston_cl.geometry import Geometry
    from thurston_cl.image import Image
    from thurston_cl.method import Method
    from thurston_cl.rendering import render
    from thurston_cl.scene import load_scene

# Loaded when first used, so that `thurston --help` and the numerics do not wait for image and scene
# libraries.
_HOME = {
    "Geometry": "geometry",
    "Image": "image",
    "Method": "method",
    "NoDeviceError": "errors",
    "SceneError": "errors",
    "ThurstonError": "errors",
    "load_scene": "scene",
    "render": "rendering",
}

__all__ = [
    "Geometry",
    "Image",
    "Method",
    "NoDeviceError",
    "SceneError",
    "ThurstonError",
    "krs",
    "load_scene",
    "render",
    "special",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("thurston_cl")
    if name in ("krs", "special"):
        return importlib.import_module(f"thurston_cl.{name}")
    if name not in _HOME:
        raise AttributeError(f"module 'thurston_cl' has no attribute {name!r}")
    return getattr(importlib.import_module(f"thurston_cl.{_HOME[name]}"), name)
