"""The programs that evaluate sequences over arrays: made of the kernels of one model, and kept."""

import functools
from collections.abc import Iterable

from thurston_cl import device as devices
from thurston_cl.arrays import ArrayProgram
from thurston_cl.device import Device
from thurston_cl.program import Source, geometry_parts

# What the kernels of a sequence call of other files of kernels/shape and kernels/krs.
_CALLED = {
    "sphere": ("shape/angles.h",),
    "capsule": ("shape/angles.h",),
    "toroidal_capsule": ("shape/angles.h", "krs/bulge.h"),
    "lens_leaf": ("krs/bulge.h",),
}
# Where the factor of a product is met, shape/ball.h says how a ball there is seen.
_IN_PRODUCTS = ("shape/angles.h", "shape/ball.h")


def sequence_parts(geometry: str, name: str, kinds: Iterable[str]) -> tuple[str, ...]:
    """The kernel files of a sequence after those of its geometry and scene_types.h, in order of pasting."""
    kinds = sorted(kinds)
    called = {part for kind in kinds for part in _CALLED.get(kind, ())}
    if geometry in ("s2xe", "h2xe"):
        called |= set(_IN_PRODUCTS)
    before = sorted(called, key=lambda part: (not part.startswith("shape"), part))
    own = ("krs/moebius_map.h",) if name == "moebius_sequence" else ("krs/mirror.h",)
    return (*before, *(f"krs/{kind}.h" for kind in kinds), "krs/kernels.h", *own, f"krs/{name}.h")


@functools.lru_cache(maxsize=32)
def sequence_program(
    geometry: str,
    name: str,
    kinds: frozenset[str],
    precision: str,
    device: Device,
    lanes: int | None,
) -> ArrayProgram:
    """The entry points of krs/arrays.cl for a kind of model."""
    parts = (
        *geometry_parts(geometry),
        "arrays.h",
        "scene_types.h",
        *sequence_parts(geometry, name, kinds),
        f"krs/{name}.cl",
    )
    return ArrayProgram(Source(parts, {"PARTS": 1}), precision, device, lanes)


@functools.lru_cache(maxsize=2)
def moebius_program(device: Device | None = None) -> ArrayProgram:
    """The entry points of krs/moebius.cl, in double where the device has it."""
    device = device or devices.choose()
    parts = (*geometry_parts("e3"), "arrays.h", "scene_types.h", "krs/moebius_map.h", "krs/moebius.cl")
    return ArrayProgram(Source(parts), "double" if device.info.fp64 else "single", device, 1)
