"""device.py: which device is chosen, what is said when one does not work, and the command that lists them."""

from __future__ import annotations

import functools
import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyopencl as cl
import pytest
from click.testing import CliRunner, Result

from thurston_cl import device
from thurston_cl.cli.main import main
from thurston_cl.errors import NoDeviceError

POCL = "Portable Computing Language"


def info(identity: str, platform: str, name: str, kind: str, **facts: object) -> device.DeviceInfo:
    usual = {
        "platform_version": "OpenCL 3.0 PoCL 3.1  Linux, LLVM 15" if platform == POCL else "OpenCL 3.0",
        "driver": "1",
        "fp64": True,
        "native_width_float": 8 if kind == "cpu" else 1,
        "native_width_double": 4 if kind == "cpu" else 1,
        "compute_units": 4,
        "memory_bytes": 2**33,
    }
    return device.DeviceInfo(id=identity, platform=platform, name=name, kind=kind, **(usual | facts))


EPYC = info("0:0", POCL, "pthread-AMD EPYC 7B13", "cpu")
FPGA = info("1:0", "Acme", "Board 1", "accelerator")
RADEON = info("2:0", "AMD Accelerated Parallel Processing", "gfx90a", "gpu")
H200 = info("3:0", "NVIDIA CUDA", "NVIDIA H200", "gpu")
A100 = info("3:1", "NVIDIA CUDA", "NVIDIA A100", "gpu")
ALL = [EPYC, FPGA, RADEON, H200, A100]


class Computer:
    """A computer with made-up devices, some of them broken; counts the probes."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.monkeypatch = monkeypatch
        self.probed: list[str] = []
        self.has(*ALL)
        self.breaks()
        monkeypatch.setattr(device, "_run_probe", self._probe)
        monkeypatch.setattr(device, "_open", functools.cache(lambda info: device.Device(info, None, None)))

    def has(self, *devices: device.DeviceInfo) -> None:
        self.monkeypatch.setattr(device, "_enumerate", lambda: [(info, None) for info in devices])

    def breaks(self, *broken: device.DeviceInfo) -> None:
        self.broken = broken

    def _probe(self, info: device.DeviceInfo) -> device.Probe:
        self.probed.append(info.id)
        return device.Probe(False, "it broke", "mend it") if info in self.broken else device.Probe(True)


@pytest.fixture
def computer(monkeypatch: pytest.MonkeyPatch, forget_devices: None) -> Computer:
    return Computer(monkeypatch)


# Choice


def test_default_is_the_first_gpu_and_only_it_is_probed(computer: Computer) -> None:
    assert device.choose().info == RADEON
    assert computer.probed == ["2:0"]


def test_default_without_gpu_is_a_cpu_before_anything_else(computer: Computer) -> None:
    computer.has(FPGA, EPYC)
    assert device.choose().info == EPYC


def test_broken_devices_are_skipped_with_a_warning_that_names_the_cure(computer: Computer) -> None:
    computer.breaks(RADEON, H200)
    with pytest.warns(device.DeviceWarning, match="skipped .*it broke; mend it") as warned:
        assert device.choose().info == A100
    assert [str(warning.message).split(":")[0] for warning in warned] == ["skipped 2", "skipped 3"]


def test_all_broken(computer: Computer) -> None:
    computer.breaks(*ALL)
    with pytest.raises(NoDeviceError, match=r"(?s)gfx90a: it broke; mend it.*EPYC 7B13: it broke; mend it"):
        device.choose()


def test_no_device_says_what_to_install(computer: Computer, monkeypatch: pytest.MonkeyPatch) -> None:
    computer.has()
    monkeypatch.delenv("OCL_ICD_VENDORS", raising=False)
    with pytest.raises(NoDeviceError, match=r"no OpenCL device found; .*apt install pocl-opencl-icd"):
        device.choose()
    monkeypatch.setenv("OCL_ICD_VENDORS", "/nowhere")
    with pytest.raises(NoDeviceError, match=r"found \(OCL_ICD_VENDORS=/nowhere"):
        device.choose()


@pytest.mark.parametrize(
    ("request_", "expected"),
    [
        ("cpu", EPYC),
        ("GPU", RADEON),
        ("0", EPYC),
        ("3", H200),
        ("3:1", A100),
        (" 3:1 ", A100),
        ("nvidia", H200),
        ("a100", A100),
        ("h200", H200),
        ("portable", EPYC),
        ("nvidia:a100", A100),
        ("nvidia:1", A100),
        ("3:a100", A100),
    ],
)
def test_request(computer: Computer, request_: str, expected: device.DeviceInfo) -> None:
    assert device.choose(request_).info == expected


@pytest.mark.parametrize("request_", ["nonsense", "7", "0:1", "nvidia:radeon", "3:2", "other"])
def test_request_that_fits_nothing_lists_what_there_is(computer: Computer, request_: str) -> None:
    with pytest.raises(NoDeviceError) as failure:
        device.choose(request_)
    assert f"no OpenCL device fits {request_!r}" in str(failure.value)
    for listed in ALL:
        assert f"{listed.id}  {listed.platform}: {listed.name} ({listed.kind})" in str(failure.value)
    assert computer.probed == []


def test_request_for_a_broken_device_takes_no_other(computer: Computer) -> None:
    computer.breaks(EPYC)
    with pytest.raises(NoDeviceError, match="EPYC 7B13: it broke; mend it"):
        device.choose("cpu")


def test_order_of_the_sources(computer: Computer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYOPENCL_CTX", "nvidia:1")
    assert device.choose().info == A100
    monkeypatch.setenv("THURSTON_DEVICE", "h200")
    assert device.choose().info == H200
    assert device.choose("cpu").info == EPYC
    monkeypatch.setenv("THURSTON_DEVICE", "")
    assert device.choose().info == A100
    monkeypatch.setenv("PYOPENCL_CTX", "")
    assert device.choose().info == RADEON


@pytest.mark.parametrize(
    ("variable", "expected"),
    [("0", EPYC), ("portable", EPYC), ("3:1", A100), ("nvidia", H200), ("cuda:a1", A100), ("3:1,0", H200)],
)
def test_pyopencl_ctx(
    computer: Computer, monkeypatch: pytest.MonkeyPatch, variable: str, expected: device.DeviceInfo
) -> None:
    monkeypatch.setenv("PYOPENCL_CTX", variable)
    assert device.choose().info == expected


@pytest.mark.parametrize("variable", ["cpu", "h200", "nonsense"])
def test_pyopencl_ctx_names_platforms_only(
    computer: Computer, monkeypatch: pytest.MonkeyPatch, variable: str
) -> None:
    monkeypatch.setenv("PYOPENCL_CTX", variable)
    with pytest.raises(NoDeviceError, match=r"from PYOPENCL_CTX"):
        device.choose()


def test_same_choice_same_object(computer: Computer) -> None:
    assert device.choose("cpu") is device.choose("0:0")
    assert computer.probed == ["0:0"]


# Probe


def test_success_is_remembered_by_the_next_process_and_failure_is_not(computer: Computer) -> None:
    computer.breaks(EPYC)
    device.probe(EPYC)
    device.probe(H200)
    device._probed.clear()  # as in a new process
    assert device.probe(H200).ok
    assert not device.probe(EPYC).ok
    assert computer.probed == ["0:0", "3:0", "0:0"]


def test_a_fresh_probe_corrects_what_is_remembered(computer: Computer) -> None:
    assert device.probe(H200).ok
    computer.breaks(H200)
    assert device.probe(H200).ok
    assert not device.probe(H200, fresh=True).ok
    device._probed.clear()
    assert not device.probe(H200).ok


def test_a_new_driver_is_probed_again(computer: Computer) -> None:
    device.probe(EPYC)
    device._probed.clear()
    newer = info("0:0", POCL, EPYC.name, "cpu", driver="2")
    computer.has(newer)
    device.probe(newer)
    assert computer.probed == ["0:0", "0:0"]


def test_unwritable_cache_is_no_error(
    computer: Computer, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file" / "below"))
    assert device.probe(EPYC).ok


CHILDREN = {
    "passes": ('print(\'{"ok": true, "message": ""}\')', EPYC, True, "", ""),
    "unknown CPU": (
        "import sys; sys.stderr.write(\"error: unknown target CPU 'generic'\\nnote: valid are\\n\");"
        'print(\'{"ok": false, "message": "RuntimeError: clBuildProgram failed"}\')',
        EPYC,
        False,
        "its compiler is older than this CPU",
        "apt install pocl-opencl-icd",
    ),
    "crashes": ("import os; os.abort()", EPYC, False, "crashes the driver, SIGABRT", "pocl-opencl-icd"),
    "exits": ("import sys; sys.exit(3)", H200, False, "exit status 3", "update the driver of NVIDIA CUDA"),
    "wrong": (
        'print(\'{"ok": false, "message": "the results are wrong"}\')',
        H200,
        False,
        "a kernel fails (the results are wrong)",
        "update the driver",
    ),
    "hangs": ("import time; time.sleep(60)", EPYC, False, "took more than 1 s", "pocl-opencl-icd"),
}


@pytest.mark.parametrize("child", CHILDREN)
def test_probe_in_words(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, child: str) -> None:
    source, target, ok, message, cure = CHILDREN[child]
    script = tmp_path / "child.py"
    script.write_text(source)
    monkeypatch.setattr(device._probe, "__file__", str(script))
    monkeypatch.setattr(device, "PROBE_SECONDS", 1.0 if child == "hangs" else 30.0)
    result = device._run_probe(target)
    assert result.ok is ok
    assert message in result.message
    assert cure in result.cure


def test_probe_notices_wrong_results(opencl_device: device.Device, monkeypatch: pytest.MonkeyPatch) -> None:
    numbers = [int(part) for part in opencl_device.info.id.split(":")]
    assert device._probe.run(*numbers) == (True, "")
    monkeypatch.setattr(device._probe, "SOURCE", device._probe.SOURCE.replace("exp(-x)", "exp(x)"))
    assert device._probe.run(*numbers) == (False, "the kernel ran, but its results are wrong")
    monkeypatch.setattr(device._probe, "SOURCE", device._probe.SOURCE.replace("exp(x)", "nonsense(x)"))
    ok, message = device._probe.run(*numbers)
    assert not ok
    assert "nonsense" in message


# Lane width


@pytest.mark.parametrize(
    ("native_float", "single", "double"),
    [(1, 4, 16), (4, 8, 16), (8, 16, 16), (16, 32, 32), (12, 32, 32), (32, 64, 64), (128, 64, 64)],
)
def test_lane_width_on_cpus(native_float: int, single: int, double: int) -> None:
    cpu = info("0:0", POCL, "CPU", "cpu", native_width_float=native_float)
    assert (cpu.lane_width("single"), cpu.lane_width("double")) == (single, double)


def test_lane_width_elsewhere() -> None:
    assert {entry.lane_width(p) for entry in (H200, FPGA) for p in device.PRECISIONS} == {1}
    with pytest.raises(ValueError, match="'half'"):
        H200.lane_width("half")


# The real device


def test_real_device(opencl_device: device.Device) -> None:
    chosen = opencl_device.info
    assert chosen in device.list_devices()
    assert device.probe(chosen) == device.Probe(True)
    assert chosen.lane_width("single") in device.LANE_WIDTHS
    assert chosen.compute_units > 0
    assert chosen.memory_bytes > 2**27
    assert opencl_device.queue.properties & cl.command_queue_properties.PROFILING_ENABLE
    data = np.arange(8.0)
    buffer = cl.Buffer(opencl_device.context, cl.mem_flags.COPY_HOST_PTR, hostbuf=data)
    back = np.zeros_like(data)
    cl.enqueue_copy(opencl_device.queue, back, buffer)
    assert (back == data).all()
    assert device.choose(chosen.id) is device.choose(chosen.id)


def in_new_process(code: str, **variables: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code], env=os.environ | variables, capture_output=True, text=True, timeout=60
    )


def test_importing_the_module_makes_pyopencl_importable() -> None:
    done = in_new_process("import thurston_cl.device, pyopencl", PYOPENCL_NO_CACHE="")
    assert done.returncode == 0, done.stderr


def test_importing_the_module_does_not_import_pyopencl() -> None:
    code = "import sys, thurston_cl.device; sys.exit('pyopencl' in sys.modules)"
    assert in_new_process(code).returncode == 0


@pytest.mark.skipif(
    importlib.util.find_spec("pocl_binary_distribution") is not None, reason="PoCL from pip is always found"
)
def test_no_driver_at_all() -> None:
    done = in_new_process("import thurston_cl.device as d; d.choose()", OCL_ICD_VENDORS="/nonexistent")
    assert "NoDeviceError: no OpenCL device found (OCL_ICD_VENDORS=/nonexistent" in done.stderr


# thurston devices


def thurston_devices(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["devices", *arguments])


def test_command_table(computer: Computer) -> None:
    result = thurston_devices()
    assert result.exit_code == 0
    assert result.stderr == ""
    lines = result.stdout.splitlines()
    assert len(lines) == 1 + len(ALL)
    assert " ".join(lines[0].split()) == "id platform version device kind fp64 native lanes builds"
    assert lines[1].split("  ")[0] == "0:0"
    assert "OpenCL 3.0 PoCL 3.1 " in lines[1]
    assert "LLVM" not in lines[1]
    assert " 8/4 " in lines[1]
    assert " 16/16 " in lines[1]
    assert computer.probed == []


def test_command_check(computer: Computer) -> None:
    device.probe(EPYC)
    computer.breaks(RADEON)
    result = thurston_devices("--check")
    assert result.exit_code == 0
    assert [line.split()[-1] for line in result.stdout.splitlines()[1:]] == ["yes", "yes", "no", "yes", "yes"]
    assert result.stderr == "thurston: warning: 2:0 gfx90a: it broke; mend it\n"
    assert computer.probed == ["0:0"] + [entry.id for entry in ALL]  # checks, whatever is remembered


def test_command_json(computer: Computer) -> None:
    computer.has(EPYC, H200)
    computer.breaks(H200)
    unchecked = json.loads(thurston_devices("--json").stdout)["devices"]
    assert [entry["builds"] for entry in unchecked] == [None, None]
    checked = json.loads(thurston_devices("--json", "--check").stdout)["devices"]
    assert [entry["builds"] for entry in checked] == [True, False]
    assert checked[0]["lane_width"] == {"single": 16, "double": 16}
    assert (checked[1]["id"], checked[1]["cure"]) == ("3:0", "mend it")


@pytest.mark.parametrize("arguments", [[], ["--check"], ["--json"]])
def test_command_without_devices(computer: Computer, arguments: list[str]) -> None:
    computer.has()
    result = thurston_devices(*arguments)
    assert result.exit_code == 69
    assert result.stderr.startswith("thurston: error: no OpenCL device found")
    assert result.stderr.count("\n") == 1
    assert (json.loads(result.stdout) if arguments == ["--json"] else result.stdout) in ("", {"devices": []})


def test_command_check_where_none_works(computer: Computer) -> None:
    computer.has(EPYC)
    computer.breaks(EPYC)
    result = thurston_devices("--check")
    assert result.exit_code == 69
    assert "it broke; mend it" in result.stderr
    assert "0:0" in result.stdout
