"""Which OpenCL devices are there, which of them work, and which one do we use?

A device that is listed need not work: a driver can know the device and still fail to compile for it. So a
device is used only after a small kernel has been built, run and checked on it (`probe`).

Importing this module also makes a later `import pyopencl` safe, and does not import it.
"""

from __future__ import annotations

import functools
import hashlib
import importlib.metadata
import json
import os
import signal
import subprocess
import sys
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import platformdirs

from thurston_cl import _probe
from thurston_cl.errors import NoDeviceError

if TYPE_CHECKING:
    import pyopencl as cl

# pyopencl refuses to be imported while this is set but empty; elsewhere an empty variable means "not set".
if os.environ.get("PYOPENCL_NO_CACHE", "unset").strip() == "":
    del os.environ["PYOPENCL_NO_CACHE"]

LANE_WIDTHS = (1, 4, 8, 16, 32, 64)
PRECISIONS = ("single", "double")

# A cold build takes 2 s on a core of 2022; a broken compiler has been seen to run for minutes, then to crash.
PROBE_SECONDS = 30.0

INSTALL_POCL = (
    "install PoCL, OpenCL for CPUs: 'sudo apt install pocl-opencl-icd' (Debian, Ubuntu), "
    "'sudo dnf install pocl' (Fedora), 'conda install -c conda-forge pocl' (elsewhere)"
)


class DeviceWarning(UserWarning):
    """A device that is listed was passed over because it cannot run our kernels."""


@dataclass(frozen=True)
class DeviceInfo:
    """What OpenCL says about one device, and the lane width we use on it."""

    id: str  # "platform:device", numbers in the order in which OpenCL lists them
    platform: str
    platform_version: str
    name: str
    kind: str  # "cpu", "gpu", "accelerator" or "other"
    driver: str
    fp64: bool
    native_width_float: int
    native_width_double: int
    compute_units: int
    memory_bytes: int

    def lane_width(self, precision: str) -> int:
        """Number of rays that one work-item marches side by side, one of `LANE_WIDTHS`.

        One on a GPU, whose hardware does this itself. On a CPU two native float vectors: a marching step
        waits for its own results, so a second independent vector is nearly free. In double the same number
        of lanes (which makes four native vectors), and at least 16. Both were measured on PoCL.
        """
        if precision not in PRECISIONS:
            raise ValueError(f"precision must be one of {', '.join(PRECISIONS)}, not {precision!r}")
        if self.kind != "cpu":
            return 1
        least = 16 if precision == "double" else 4
        wanted = max(least, 2 * self.native_width_float)
        return next((width for width in LANE_WIDTHS if width >= wanted), LANE_WIDTHS[-1])


@dataclass(frozen=True)
class Probe:
    """Did a small kernel build, run and give the right results? If not: what happened, and what helps."""

    ok: bool
    message: str = ""
    cure: str = ""


@dataclass(frozen=True)
class Device:
    """An opened device: what it is, and an OpenCL context and queue (with profiling) of its own."""

    info: DeviceInfo
    context: cl.Context
    queue: cl.CommandQueue


def list_devices() -> list[DeviceInfo]:
    """Every device of every OpenCL platform, whether it works or not; empty where there is none."""
    return [info for info, _ in _enumerate()]


def probe(info: DeviceInfo, *, fresh: bool = False) -> Probe:
    """Build, run and check a small kernel on the device, in a process of its own so that a crash stays there.

    The answer is kept in this process. That a device works is also remembered in the user's cache folder, by
    device and driver version, which saves half a second at every start; `fresh` tries again all the same.
    """
    if not fresh and info.id not in _probed and _memory(info).exists():
        _probed[info.id] = Probe(True)
    if info.id not in _probed or fresh:
        _probed[info.id] = _run_probe(info)
        _remember(info, _probed[info.id].ok)
    return _probed[info.id]


def no_device_message() -> str:
    """What to tell a user whose computer lists no OpenCL device at all."""
    vendors = os.environ.get("OCL_ICD_VENDORS")
    hint = f" (OCL_ICD_VENDORS={vendors}: only the drivers listed there are seen)" if vendors else ""
    return f"no OpenCL device found{hint}; {INSTALL_POCL}"


def choose(request: str | None = None) -> Device:
    """The device to use, opened; the same object whenever the choice is the same.

    `request` (the command line's `--device`) wins over the variable THURSTON_DEVICE, that over
    PYOPENCL_CTX, and that over the default: the first GPU that works, else the first CPU. A request is
    "cpu" or "gpu"; a platform's number or a platform's and a device's ("0", "0:1"); or part of a
    platform's or a device's name, in any case ("portable", "portable:epyc"). PYOPENCL_CTX is read as
    pyopencl reads it: a platform, or platform:device.

    Devices that do not work are passed over with a `DeviceWarning`. Where none is left, or the request
    fits none, `NoDeviceError` says what to do.
    """
    sources = (
        ("the request", request),
        ("THURSTON_DEVICE", os.environ.get("THURSTON_DEVICE")),
        ("PYOPENCL_CTX", os.environ.get("PYOPENCL_CTX")),
    )
    for source, text in sources:
        if text is not None and text.strip():
            return _open(_select(source, text.strip()))
    return _open(_select("", ""))


_probed: dict[str, Probe] = {}


@functools.cache
def _select(source: str, text: str) -> DeviceInfo:
    """The device for a request (`text`, which came from `source`), or the default where both are empty."""
    devices = list_devices()
    if not devices:
        raise NoDeviceError(no_device_message())
    if not text:
        rank = {"gpu": 0, "cpu": 1}
        return _first_working(sorted(devices, key=lambda info: rank.get(info.kind, 2)))
    fitting = _matches(text, devices, platforms_only=source == "PYOPENCL_CTX")
    if not fitting:
        listed = "\n".join(f"  {info.id}  {info.platform}: {info.name} ({info.kind})" for info in devices)
        raise NoDeviceError(f"no OpenCL device fits {text!r} (from {source}); there are:\n{listed}")
    return _first_working(fitting)


def _first_working(candidates: Iterable[DeviceInfo]) -> DeviceInfo:
    """The first device whose probe passes, with a warning for those before it; NoDeviceError if none does."""
    failures: list[str] = []
    for info in candidates:
        result = probe(info)
        if result.ok:
            for failure in failures:
                warnings.warn(f"skipped {failure}", DeviceWarning, stacklevel=4)
            return info
        failures.append(f"{info.id} {info.name}: {result.message}; {result.cure}")
    raise NoDeviceError("no OpenCL device can build and run a kernel:\n  " + "\n  ".join(failures))


def _matches(text: str, devices: list[DeviceInfo], *, platforms_only: bool) -> list[DeviceInfo]:
    """The devices that a request means. A number is an index; "platform:device" may mix numbers and names."""
    if not platforms_only:
        if text.lower() in ("cpu", "gpu", "accelerator"):
            return [info for info in devices if info.kind == text.lower()]
        if not text.isdecimal():
            named = [i for i in devices if _fits(text, "", i.platform) or _fits(text, "", i.name)]
            if named:
                return named
    platform, _, wanted = text.partition(":")
    return [
        info
        for info in devices
        if _fits(platform, info.id.split(":")[0], info.platform)
        and any(_fits(part, info.id.split(":")[1], info.name) for part in wanted.split(","))
    ]


def _fits(part: str, index: str, name: str) -> bool:
    part = part.strip().lower()
    return int(part) == int(index) if part.isdecimal() else part in name.lower()


@functools.cache
def _open(info: DeviceInfo) -> Device:
    import pyopencl as cl

    handle = next(handle for listed, handle in _enumerate() if listed.id == info.id)
    context = cl.Context([handle])
    queue = cl.CommandQueue(context, properties=cl.command_queue_properties.PROFILING_ENABLE)
    return Device(info, context, queue)


@functools.cache
def _enumerate() -> list[tuple[DeviceInfo, cl.Device]]:
    """Ask OpenCL for its devices: the only place that does."""
    import pyopencl as cl

    try:
        platforms = cl.get_platforms()
    except cl.LogicError as error:
        if "PLATFORM_NOT_FOUND" in str(error):  # what the loader answers where no driver is installed
            return []
        raise
    found = []
    for p, platform in enumerate(platforms):
        try:
            handles = platform.get_devices()
        except cl.Error:  # a platform whose hardware is absent
            continue
        found += [(_describe(f"{p}:{d}", platform, handle), handle) for d, handle in enumerate(handles)]
    return found


def _describe(identity: str, platform: cl.Platform, handle: cl.Device) -> DeviceInfo:
    import pyopencl as cl

    kinds = {cl.device_type.CPU: "cpu", cl.device_type.GPU: "gpu", cl.device_type.ACCELERATOR: "accelerator"}
    return DeviceInfo(
        id=identity,
        platform=platform.name.strip(),
        platform_version=platform.version.strip(),
        name=handle.name.strip(),
        kind=next((kind for bit, kind in kinds.items() if handle.type & bit), "other"),
        driver=handle.driver_version.strip(),
        fp64="cl_khr_fp64" in handle.extensions.split(),
        native_width_float=handle.native_vector_width_float,
        native_width_double=handle.native_vector_width_double,
        compute_units=handle.max_compute_units,
        memory_bytes=handle.global_mem_size,
    )


def _run_probe(info: DeviceInfo) -> Probe:
    """Run `_probe.py` for the device and put its outcome into words."""
    command = [sys.executable, "-P", _probe.__file__, *info.id.split(":")]
    # The child finds pyopencl where this process finds it, whatever the way it came onto the path.
    path = os.pathsep.join(filter(None, sys.path))
    environment = os.environ | {"PYTHONPATH": path, "PYOPENCL_NO_CACHE": "1"}
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, errors="replace", timeout=PROBE_SECONDS
        )
    except subprocess.TimeoutExpired as error:
        log = (error.stderr or b"").decode(errors="replace")
        return _explain(info, f"building a kernel took more than {PROBE_SECONDS:.0f} s", log)
    if done.returncode == 0 and done.stdout:
        outcome = json.loads(done.stdout.splitlines()[-1])
        if outcome["ok"]:
            return Probe(True)
        return _explain(info, "a kernel fails", outcome["message"] + "\n" + done.stderr)
    how = signal.Signals(-done.returncode).name if done.returncode < 0 else f"exit status {done.returncode}"
    return _explain(info, f"building a kernel crashes the driver, {how}", done.stderr)


def _explain(info: DeviceInfo, event: str, log: str) -> Probe:
    """A failed probe with the line of `log` that tells most, and what a user can do."""
    is_pocl = "pocl" in info.platform_version.lower()
    if is_pocl and "unknown target CPU" in log:
        event = "its compiler is older than this CPU and does not know it"
    lines = [line.strip() for line in log.splitlines() if "error" in line.lower() or "wrong" in line.lower()]
    message = f"{event} ({lines[0]})" if lines else event
    if is_pocl:
        return Probe(False, message, f"this PoCL does not suit the CPU; {INSTALL_POCL}")
    return Probe(False, message, f"update the driver of {info.platform}, or choose another device")


def _memory(info: DeviceInfo) -> Path:
    """The empty file whose presence says that this device, with these drivers, has passed this probe."""
    facts = [importlib.metadata.version("pyopencl"), _probe.SOURCE, str(info)]
    # Drivers loaded side by side can break each other, so what counts is the whole list.
    facts += [str(listed) for listed in list_devices()]
    digest = hashlib.sha256("\n".join(facts).encode()).hexdigest()
    return platformdirs.user_cache_path("thurston_cl") / "working-devices" / digest


def _remember(info: DeviceInfo, works: bool) -> None:
    path = _memory(info)
    try:
        if works:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
        else:
            path.unlink(missing_ok=True)
    except OSError:  # a read-only home only costs the next start half a second
        pass
