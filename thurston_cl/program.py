"""Assemble OpenCL source from the parts under `kernels/`, build it, and keep what was built.

Sources are pasted, not `#include`d, each part behind a `#line` that names its file, so that a compiler
message points home.
"""

import functools
import hashlib
import tempfile
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from thurston_cl.errors import BuildError

if TYPE_CHECKING:
    import pyopencl as cl

    from thurston_cl.device import Device

LANE_WIDTHS = (1, 4, 8, 16, 32, 64)
LOCAL_SIZE = 16  # PoCL compiles a kernel once per local size, so there is only one
_LEFT_INVARIANT_PARTS = (
    "special/two_part.h",
    "special/newton.h",
    "special/rise.h",
    "geometry/left_invariant.h",
)
_TWISTED_PARTS = (*_LEFT_INVARIANT_PARTS, "special/stumpff.h", "geometry/twisted.h")
# The kernel files of each geometry, after those that all have.
_GEOMETRY_PARTS = {
    "e3": ("geometry/e3.h", "geometry/isotropic.h"),
    "s3": ("geometry/s3.h", "geometry/isotropic.h"),
    "h3": ("geometry/h3.h", "geometry/isotropic.h"),
    "s2xe": (
        "special/two_part.h",
        "geometry/factor.h",
        "geometry/s3.h",
        "geometry/isotropic.h",
        "geometry/s2xe.h",
        "geometry/product.h",
    ),
    "h2xe": (
        "special/two_part.h",
        "geometry/factor.h",
        "geometry/h3.h",
        "geometry/isotropic.h",
        "geometry/h2xe.h",
        "geometry/product.h",
    ),
    "nil": (*_TWISTED_PARTS, "geometry/nil.h"),
    "sl2": (*_TWISTED_PARTS, "geometry/sl2.h"),
    "sol": (
        *_LEFT_INVARIANT_PARTS,
        "special/jacobi.h",
        "special/carlson.h",
        "geometry/sol.h",
        "geometry/sol_phase.h",
        "geometry/sol_flow.h",
        "geometry/sol_bounds.h",
        "geometry/sol_geodesics.h",
        "geometry/sol_light.h",
    ),
}


def geometry_parts(geometry: str) -> tuple[str, ...]:
    """The kernel files that implement the contract of one geometry, in order of pasting."""
    common = ("lanes.h", "special/elementary.h", "special/meeting.h", "geometry/connection.h")
    return (*common, *_GEOMETRY_PARTS[geometry])


@functools.cache
def kernel_text(part: str) -> str:
    """The text of one file under `kernels/`."""
    return (files("thurston_cl.kernels") / part).read_text(encoding="utf-8")


@dataclass(frozen=True)
class Source:
    """One program: the files it is pasted from, text generated for a scene, and its defines.

    `generated` maps the name of a generated part to its text; such a name stands in `parts` like a file's.
    """

    parts: tuple[str, ...]
    defines: Mapping[str, str | int] = field(default_factory=dict)
    generated: Mapping[str, str] = field(default_factory=dict)

    @functools.cached_property
    def text(self) -> str:
        pasted = []
        for part in self.parts:
            body = self.generated[part] if part in self.generated else kernel_text(part)
            pasted.append(f'#line 1 "{part}"\n{body.rstrip()}\n')
        return "\n".join(pasted)

    def options(self, precision: str, lanes: int) -> list[str]:
        """The compiler options, sorted. No math flags: they gain little and move pixels."""
        defines = {**self.defines, "LANES": lanes}
        if precision == "double":
            defines["FP64"] = 1
        return ["-cl-std=CL1.2", *(f"-D{name}={value}" for name, value in sorted(defines.items()))]


_built: dict[tuple[object, ...], "cl.Program"] = {}


def build(device: "Device", source: Source, precision: str, lanes: int) -> "cl.Program":
    """Build `source` for `device`, once per process and set of options.

    Raises BuildError with the options, the first lines of the log and the path of the saved source.
    """
    import pyopencl as cl

    options = source.options(precision, lanes)
    key = (device.context, hashlib.sha256(source.text.encode()).hexdigest(), *options)
    if key not in _built:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", cl.CompilerWarning)
            try:
                _built[key] = cl.Program(device.context, source.text).build(options)
            except cl.RuntimeError as error:
                raise BuildError(_build_message(device, source, options, str(error))) from error
    return _built[key]


def build_widest(device: "Device", source: Source, precision: str, lanes: int) -> tuple["cl.Program", int]:
    """Build at `lanes`, or where the compiler refuses that width at the next smaller one. Returns the
    program and its width.
    """
    widths = [width for width in reversed(LANE_WIDTHS) if width <= lanes]
    for width in widths[:-1]:
        try:
            return build(device, source, precision, width), width
        except BuildError as error:
            warnings.warn(
                f"no build with {width} lanes, trying fewer: {str(error).splitlines()[0]}", stacklevel=2
            )
    return build(device, source, precision, widths[-1]), widths[-1]


def _build_message(device: "Device", source: Source, options: Iterable[str], log: str) -> str:
    with tempfile.NamedTemporaryFile("w", prefix="thurston-", suffix=".cl", delete=False) as saved:
        saved.write(source.text)
    lines = [line for line in log.splitlines() if "error" in line.lower()][:8] or log.splitlines()[:8]
    return "\n".join(
        [
            f"the kernel does not compile on {device.info.name}",
            f"options: {' '.join(options)}",
            *lines,
            f"source: {Path(saved.name)}",
        ]
    )
