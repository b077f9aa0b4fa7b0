"""The programs that evaluate sequences over arrays: made of the kernels of one model, and kept."""

import functools
from collections.abc import Iterable

from thurston_cl import device as devices
from thurston_cl.arrays import ArrayProgram
from thurston_cl.device import Device
from thurston_cl.models import PRODUCTS
from thurston_cl.program import Source, geometry_parts

# What the kernels of a sequence call of other files of kernels/shape and kernels/krs.
_CALLED = {
    "sphere": ("shape/angles.h",),
    "capsule": ("shape/angles.h",),
    "toroidal_capsule": ("shape/angles.h", "krs/bulge.h"),
    "lens_leaf": ("krs/bulge.h",),
}
# All files of kernels/krs for programs, in the order in which they need each other.
_ORDER = (
    "bulge",
    "capsule",
    "lens_leaf",
    "plane",
    "sphere",
    "toroidal_capsule",
    "kernels",
    "mirror",
    "sequence",
    "moebius_map",
    "moebius_sequence",
    "twist",
    "empty_zones",
)
# Where the factor of a product is met, shape/ball.h says how a ball there is seen.
_IN_PRODUCTS = ("shape/angles.h", "shape/ball.h")


def sequence_parts(geometry: str, name: str, kinds: Iterable[str]) -> set[str]:
    """The kernel files of a sequence besides those of its geometry and scene_types.h."""
    kinds = set(kinds)
    called = {part for kind in kinds for part in _CALLED.get(kind, ())}
    if geometry in PRODUCTS:
        called |= set(_IN_PRODUCTS)
    own = "krs/moebius_map.h" if name == "moebius_sequence" else "krs/mirror.h"
    return called | {f"krs/{kind}.h" for kind in kinds} | {"krs/kernels.h", own, f"krs/{name}.h"}


def krs_order(parts: Iterable[str]) -> list[str]:
    """The files of kernels/krs among `parts`, in order of pasting, after those of kernels/shape."""
    return [part for part in (f"krs/{name}.h" for name in _ORDER) if part in parts]


@functools.lru_cache(maxsize=32)
def sequence_program(
    geometry: str,
    name: str,
    kinds: frozenset[str],
    precision: str,
    device: Device,
    lanes: int | None,
) -> ArrayProgram:
    """The entry points of krs/sequence.cl or moebius_sequence.cl for a kind of model."""
    own = sequence_parts(geometry, name, kinds)
    parts = (
        *geometry_parts(geometry),
        "arrays.h",
        "scene_types.h",
        *sorted(part for part in own if part.startswith("shape/")),
        *krs_order(own),
        "krs/numbers.h",
        f"krs/{name}.cl",
    )
    return ArrayProgram(Source(parts, {"PARTS": 1}), precision, device, lanes)


@functools.lru_cache(maxsize=2)
def moebius_program(device: Device | None = None) -> ArrayProgram:
    """The entry points of krs/moebius.cl, in double where the device has it."""
    device = device or devices.choose()
    own = ("krs/moebius_map.h", "krs/numbers.h", "krs/moebius.cl")
    parts = (*geometry_parts("e3"), "arrays.h", "scene_types.h", *own)
    return ArrayProgram(Source(parts), "double" if device.info.fp64 else "single", device, 1)
