"""program.py: sources are pasted with markers that point home, built once, and narrower where need be."""

import re
from pathlib import Path

import numpy as np
import pyopencl as cl
import pytest

from thurston_cl import program
from thurston_cl.device import Device
from thurston_cl.errors import BuildError
from thurston_cl.models import GEOMETRIES
from thurston_cl.program import (
    LANE_WIDTHS,
    Source,
    build,
    build_widest,
    geometry_parts,
    kernel_text,
)

GOOD = "__kernel void fill(__global int *out) { out[get_global_id(0)] = LANES; }\n"
BROKEN = "// one\n// two\n__kernel void broken(__global int *out)\n{\n  out[0] = no_such_name;\n}\n"


def source(text: str, name: str = "made.cl", **defines: str | int) -> Source:
    return Source(("lanes.h", name), defines=defines, generated={name: text})


def run(built: cl.Program, device: Device) -> int:
    out = np.zeros(1, np.int32)
    buffer = cl.Buffer(device.context, cl.mem_flags.WRITE_ONLY, out.nbytes)
    built.fill(device.queue, (1,), None, buffer)
    cl.enqueue_copy(device.queue, out, buffer)
    return int(out[0])


def test_parts_are_pasted_whole_behind_a_line_that_names_them() -> None:
    parts = (*geometry_parts("h3"), "numerics.cl")
    text = Source(parts).text
    markers = re.findall(r'^#line 1 "(.*)"$', text, re.MULTILINE)
    assert markers == list(parts)
    for part, pasted in zip(parts, re.split(r'^#line 1 ".*"\n', text, flags=re.MULTILINE)[1:], strict=True):
        assert pasted.rstrip() == kernel_text(part).rstrip()


def test_generated_text_stands_among_the_parts_like_a_file() -> None:
    text = Source(("lanes.h", "scene"), generated={"scene": "int here;"}).text
    assert text.endswith('#line 1 "scene"\nint here;\n')
    with pytest.raises(FileNotFoundError):
        _ = Source(("no_such_part.h",)).text


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_geometries_begin_with_their_lanes_and_functions(geometry: str) -> None:
    parts = geometry_parts(geometry)
    assert parts[:2] == ("lanes.h", "special/elementary.h")
    assert len(set(parts)) == len(parts)
    assert any(part.startswith("geometry/") for part in parts)


def test_options_are_sorted_and_change_no_arithmetic() -> None:
    options = source(GOOD, WALLS=6, CELLS="12", CREEPING=1).options("double", 16)
    assert options == ["-cl-std=CL1.2", "-DCELLS=12", "-DCREEPING=1", "-DFP64=1", "-DLANES=16", "-DWALLS=6"]
    assert source(GOOD).options("single", 1) == ["-cl-std=CL1.2", "-DLANES=1"]
    for option in options:
        assert not re.search("fast|mad|unsafe|finite|denorm|signed-zeros|single-precision", option)


@pytest.mark.parametrize("lanes", [1, 16])
def test_a_program_is_built_once_per_source_precision_and_width(opencl_device: Device, lanes: int) -> None:
    first = build(opencl_device, source(GOOD), "single", lanes)
    assert run(first, opencl_device) == lanes
    # What counts is what is built, not which object says so.
    assert build(opencl_device, source(GOOD), "single", lanes) is first
    others = [
        build(opencl_device, source(GOOD), "double", lanes),
        build(opencl_device, source(GOOD), "single", 4),
        build(opencl_device, source(GOOD, WALLS=6), "single", lanes),
        build(opencl_device, source(GOOD + "\n// more"), "single", lanes),
    ]
    assert len({id(p) for p in [first, *others]}) == 5


def test_a_failed_build_is_tried_again(opencl_device: Device) -> None:
    for _ in range(2):
        with pytest.raises(BuildError):
            build(opencl_device, source(BROKEN), "single", 1)


def test_a_build_error_points_home(opencl_device: Device) -> None:
    """It names our file and line, options, device, and a saved source that holds what was compiled."""
    broken = source(BROKEN, "shape/torus.h", WALLS=6)
    with pytest.raises(BuildError) as caught:
        build(opencl_device, broken, "single", 4)
    message = str(caught.value)
    first, options, *lines = message.splitlines()
    assert first == f"the kernel does not compile on {opencl_device.info.name}"
    assert options == "options: -cl-std=CL1.2 -DLANES=4 -DWALLS=6"
    assert re.search(r"shape/torus\.h[:(]5\b", message), message
    assert "no_such_name" in message
    saved = re.fullmatch(r"source: (.+\.cl)", lines[-1])
    assert saved
    path = Path(saved[1])
    assert path.read_text() == broken.text
    path.unlink()


def test_the_widest_build_that_works(opencl_device: Device) -> None:
    narrow = "#if LANES > 8\n#error too wide for this compiler\n#endif\n" + GOOD
    with pytest.warns(UserWarning) as caught:
        built, lanes = build_widest(opencl_device, source(narrow), "single", 32)
    assert lanes == 8
    assert run(built, opencl_device) == 8
    messages = [str(w.message) for w in caught]
    assert len(messages) == 2
    for message, width in zip(messages, (32, 16), strict=True):
        assert message.startswith(f"no build with {width} lanes, trying fewer:")


def test_the_widest_build_is_silent_where_nothing_is_wrong(
    opencl_device: Device, recwarn: pytest.WarningsRecorder
) -> None:
    for lanes in LANE_WIDTHS:
        built, got = build_widest(opencl_device, source(GOOD), "single", lanes)
        assert got == lanes == run(built, opencl_device)
    assert not list(recwarn)


def test_a_source_that_never_builds_is_an_error_at_width_1(opencl_device: Device) -> None:
    with (
        pytest.warns(UserWarning, match="no build with 4 lanes"),
        pytest.raises(BuildError, match="-DLANES=1"),
    ):
        build_widest(opencl_device, source(BROKEN), "single", 4)


@pytest.fixture(autouse=True)
def programs_of_these_tests_are_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cache starts empty, and keeps nothing that was made here."""
    monkeypatch.setattr(program, "_built", {})


@pytest.fixture(autouse=True)
def saved_sources_are_cleaned_up(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
