"""Pictures in files: what is written comes back, and what cannot be written leaves nothing behind."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from thurston_cl import image
from thurston_cl.errors import MissingFileError, OutputError
from thurston_cl.image import Image, check_output, compare, read_image, save_comparison, to_srgb

ROOT = Path(__file__).parents[1]


def picture(height: int = 5, width: int = 7, metadata: dict[str, str] | None = None) -> Image:
    random = np.random.default_rng(1)

    def floats(*shape: int) -> np.ndarray:
        return random.random((height, width, *shape), np.float32)

    depth = floats()
    depth[0, 0], depth[0, 1], depth[-1, -1] = np.inf, np.float32(1e-40), np.nan
    ids = random.integers(0, 2**32, (height, width), np.uint32)
    # Neighbours of 2^24 are what a detour over float would lose.
    ids.flat[:5] = 0, 1, 2**24 + 1, 2**32 - 2, 2**32 - 1
    channels = {"beauty": floats(3), "depth": depth, "normal": floats(3), "steps": floats()}
    return Image(channels | {"object": ids, "cell": ids[::-1].copy()}, metadata or {})


def assert_same_channels(got: Image, wanted: Image, names: tuple[str, ...] = image.CHANNELS) -> None:
    assert set(got.channels) == set(names)
    for name in names:
        assert got.channels[name].dtype == wanted.channels[name].dtype
        np.testing.assert_array_equal(got.channels[name], wanted.channels[name], err_msg=name)


SCENE = 'geometry: nil  # é漢字\r\n\tx: 1e-12 \\ "\n' * 5000
METADATA = {"scene": SCENE, "settings": '{"accuracy": 1e-12}', "title": "a"}


# --- EXR


@pytest.mark.parametrize("height", [1, 5, image._BAND + 1])
def test_exr_keeps_every_value_and_all_text(tmp_path: Path, height: int) -> None:
    wanted = picture(height, metadata={**METADATA, "empty": ""})
    wanted.save(tmp_path / "a.exr")
    got = read_image(tmp_path / "a.exr")
    assert_same_channels(got, wanted)
    assert len(SCENE.encode()) > 200_000
    assert got.metadata == METADATA
    assert (got.width, got.height) == (7, height)
    assert os.listdir(tmp_path) == ["a.exr"]


@pytest.mark.parametrize(
    "names", [("beauty",), ("depth", "cell"), ("object",), ("steps", "normal", "object", "cell")]
)
def test_exr_holds_the_channels_asked_for_and_the_metadata(tmp_path: Path, names: tuple[str, ...]) -> None:
    wanted = picture(metadata=METADATA)
    wanted.save(tmp_path / "a.EXR", channels=names)
    got = read_image(tmp_path / "a.EXR")
    assert_same_channels(got, wanted, names)
    assert got.metadata == METADATA


def test_exr_parts_are_what_other_programs_expect(tmp_path: Path) -> None:
    picture().save(tmp_path / "a.exr")
    file = oiio.ImageInput.open(str(tmp_path / "a.exr"))
    assert file is not None
    seen: dict[str, tuple[str, set[str]]] = {}
    while file.seek_subimage(len(seen), 0):
        spec = file.spec()
        assert spec.get_string_attribute("compression") == "zip"
        seen[spec.get_string_attribute("oiio:subimagename")] = (str(spec.format), set(spec.channelnames))
    assert seen == {
        "beauty": ("float", {"R", "G", "B", "depth", "steps", "normal.X", "normal.Y", "normal.Z"}),
        "object": ("uint", {"object.id"}),
        "cell": ("uint", {"cell.id"}),
    }


# --- PNG and colour


def test_srgb_is_the_standard_curve_rounded_to_nearest() -> None:
    linear = np.linspace(0, 1, 3 * 4096, dtype=np.float32).reshape(64, 64, 3)
    exact = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055) * 255
    # Half a step for rounding, 0.02 for OpenColorIO's own approximation of the curve.
    assert np.abs(to_srgb(linear) - exact).max() < 0.52


def test_srgb_of_what_no_screen_can_show() -> None:
    beauty = np.full((5, 5, 3), 0.5, np.float32)
    beauty[0, 0], beauty[0, 4], beauty[4, 0], beauty[2, 2] = np.inf, 7.0, -np.inf, np.nan
    shown = to_srgb(beauty)
    grey = shown[4, 4]
    np.testing.assert_array_equal(shown[0, 0], 255)
    np.testing.assert_array_equal(shown[0, 4], 255)
    np.testing.assert_array_equal(shown[4, 0], 0)
    np.testing.assert_array_equal(shown[2, 2], grey)
    assert not to_srgb(np.full((2, 2, 3), np.nan, np.float32)).any()


def test_bands_make_no_seam() -> None:
    row = np.random.default_rng(2).random((1, 3, 3), np.float32) * 1.2
    np.testing.assert_array_equal(
        to_srgb(np.repeat(row, image._BAND + 2, axis=0)), to_srgb(row).repeat(image._BAND + 2, axis=0)
    )


def test_png_round_trip_of_all_levels(tmp_path: Path) -> None:
    levels = np.arange(256, dtype=np.float64) / 255
    linear = np.where(levels <= 0.04045, levels / 12.92, ((levels + 0.055) / 1.055) ** 2.4)
    beauty = np.repeat(linear.astype(np.float32).reshape(16, 16, 1), 3, axis=2)
    Image({"beauty": beauty}, METADATA).save(tmp_path / "a.png")
    got = read_image(tmp_path / "a.png")
    assert set(got.channels) == {"beauty"}
    assert got.metadata == METADATA | {"exposure": "0.0", "view": "none"}
    np.testing.assert_allclose(got.channels["beauty"], beauty, atol=2e-4)
    np.testing.assert_array_equal(to_srgb(got.channels["beauty"])[..., 0], np.arange(256).reshape(16, 16))


def test_a_broken_ocio_variable_changes_nothing() -> None:
    code = (
        "import numpy as np; from thurston_cl.image import to_srgb;"
        "print(to_srgb(np.full((1, 1, 3), 0.18, np.float32)))"
    )
    env = os.environ | {"OCIO": "/nonexistent/config.ocio"}
    run = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True)
    assert run.stdout.strip() == "[[[118 118 118]]]", run.stderr


def test_a_notebook_shows_the_beauty(tmp_path: Path) -> None:
    shown = picture(metadata=METADATA)._repr_png_()
    assert shown is not None and shown.startswith(b"\x89PNG\r\n")
    (tmp_path / "a.png").write_bytes(shown)
    assert read_image(tmp_path / "a.png").channels["beauty"].shape == (5, 7, 3)
    assert Image({"depth": np.ones((2, 2), np.float32)})._repr_png_() is None


# --- heat maps

NUMBERS = np.float32([[0, 1, 14, 35], [69, 70, 71, 1e9], [np.inf, np.nan, 7, 62]])


def test_a_heat_map_is_white_for_0_and_black_for_most() -> None:
    np.testing.assert_array_equal(
        image.heat_map(NUMBERS, 70),
        # 255 (1 - n/70), rounded; nothing is known of NaN.
        [[255, 251, 204, 128], [4, 0, 0, 0], [0, 0, 230, 29]],
    )


@pytest.mark.parametrize(
    ("numbers", "most", "shades"),
    [
        ([[0, 4, 1]], 4, [[255, 0, 191]]),
        ([[0, 4, np.inf]], 4, [[255, 0, 0]]),
        ([[np.nan, 0, 0.25]], 0.25, [[0, 255, 0]]),
        ([[0, 0, 0]], 1, [[255, 255, 255]]),
        ([[np.inf, np.inf]], 1, [[0, 0]]),
    ],
)
def test_a_heat_map_goes_up_to_the_largest_that_occurs(
    numbers: list[list[float]], most: float, shades: list[list[int]]
) -> None:
    values = np.float32(numbers)
    assert image.largest(values) == most
    assert image.heat_map(values).tolist() == shades


@pytest.mark.parametrize("most", [0, -1, np.inf, np.nan])
def test_a_heat_map_needs_a_number_that_is_black(most: float) -> None:
    with pytest.raises(ValueError, match="expected a finite number over 0"):
        image.heat_map(NUMBERS, most)


def test_a_heat_map_is_of_single_numbers() -> None:
    with pytest.raises(ValueError, match=r"shape \(2, 2, 3\), expected \(H, W\)"):
        image.heat_map(np.zeros((2, 2, 3)))


@pytest.mark.parametrize(("most", "told"), [(70, "70.0"), (None, "1000000000.0")])
def test_a_heat_map_in_a_file(tmp_path: Path, most: float | None, told: str) -> None:
    picture = Image({"steps": NUMBERS}, METADATA)
    picture.save(tmp_path / "a.png", ["steps"], most=most)
    got = read_image(tmp_path / "a.png")
    assert got.metadata == METADATA | {"shows": "steps", "most": told}
    shades = to_srgb(got.channels["beauty"])
    assert np.ptp(shades, axis=2).max() == 0
    np.testing.assert_array_equal(shades[..., 0], image.heat_map(NUMBERS, most))


# --- what must not be written, and what must not be left


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        ("none/a.exr", {}, "there is no directory .*none"),
        ("file/a.exr", {}, "Not a directory"),
        ("a.jpg", {}, r"ends in \.exr or \.png"),
        ("exr", {}, r"ends in \.exr or \.png"),
        ("old.png", {}, "exists; use --force"),
        ("folder.exr", {"force": True}, "exists and is not a file"),
        ("pipe.png", {"force": True}, "exists and is not a file"),
        ("a.png", {"channels": ["beauty", "depth"]}, "PNG shows beauty, depth, steps or error, one of them"),
        ("a.png", {"channels": ["normal"]}, "one of them; write normal to an EXR"),
        ("a.png", {"channels": ["steps"], "view": "filmic"}, "a heat map is no light; leave exposure"),
        ("a.png", {"most": 3.0}, "most is for a heat map"),
        ("a.exr", {"channels": ["steps"], "most": 3.0}, "most is for a heat map"),
        ("a.exr", {"channels": ["beauty", "depht"]}, "unknown channels depht; there are beauty"),
        ("a.exr", {"channels": []}, "no channels are named"),
        ("a" * 300 + ".exr", {}, "File name too long"),
        ("a" * 250 + ".exr", {}, "File name too long"),
        ("\udcff.exr", {}, "not UTF-8"),
    ],
)
def test_refusals_name_the_path_and_the_cause(
    tmp_path: Path, name: str, options: dict[str, object], says: str
) -> None:
    (tmp_path / "file").write_text("x")
    (tmp_path / "old.png").write_text("old")
    (tmp_path / "folder.exr").mkdir()
    os.mkfifo(tmp_path / "pipe.png")
    before = sorted(os.listdir(tmp_path))
    with pytest.raises(OutputError, match=says) as caught:
        picture().save(tmp_path / name, **options)  # type: ignore[arg-type]
    assert caught.value.exit_code == 73
    assert name[:200] in str(caught.value) or "UTF-8" in str(caught.value)
    assert sorted(os.listdir(tmp_path)) == before
    assert (tmp_path / "old.png").read_text() == "old"


def test_a_directory_that_cannot_be_written(tmp_path: Path) -> None:
    if os.geteuid() == 0:
        folder = Path("/proc")  # permissions do not bind root, this file system does
    else:
        folder = tmp_path / "locked"
        folder.mkdir(mode=0o500)
    with pytest.raises(OutputError, match=f"cannot write into {folder}"):
        check_output(folder / "a.exr")


def test_force_replaces_and_a_link_keeps_pointing(tmp_path: Path) -> None:
    (tmp_path / "old.exr").write_text("old")
    (tmp_path / "link.exr").symlink_to("old.exr")
    picture().save(tmp_path / "link.exr", force=True)
    assert (tmp_path / "link.exr").is_symlink()
    assert_same_channels(read_image(tmp_path / "old.exr"), picture())
    assert sorted(os.listdir(tmp_path)) == ["link.exr", "old.exr"]


def test_a_left_over_part_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "a.png.part").write_text("from a killed run")
    picture().save(tmp_path / "a.png")
    assert os.listdir(tmp_path) == ["a.png"]


@pytest.mark.parametrize("name", ["a?compression=none.exr", "a b#%.png", "漢字.exr", "a.part.png"])
def test_odd_names(tmp_path: Path, name: str) -> None:
    picture().save(tmp_path / name)
    assert read_image(tmp_path / name).width == 7
    assert os.listdir(tmp_path) == [name]


@pytest.mark.parametrize("suffix", image.SUFFIXES)
@pytest.mark.parametrize("stage", ["_write", "_read_back"])
@pytest.mark.parametrize("raised", [KeyboardInterrupt, RuntimeError])
def test_an_interrupt_leaves_the_old_file_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str, stage: str, raised: type[BaseException]
) -> None:
    target = tmp_path / f"a{suffix}"
    target.write_text("old")
    original = getattr(image, stage)

    def interrupted(*arguments: object) -> None:
        original(*arguments)
        assert (tmp_path / f"a{suffix}.part").exists()
        raise raised

    monkeypatch.setattr(image, stage, interrupted)
    with pytest.raises(raised):
        picture().save(target, force=True)
    assert os.listdir(tmp_path) == [target.name]
    assert target.read_text() == "old"


@pytest.mark.parametrize("suffix", image.SUFFIXES)
def test_damage_on_the_disk_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str) -> None:
    original = image._write

    def damaged(part_path: Path, *arguments: object) -> None:
        original(part_path, *arguments)  # type: ignore[arg-type]
        os.truncate(part_path, part_path.stat().st_size * 2 // 3)

    monkeypatch.setattr(image, "_write", damaged)
    with pytest.raises(OutputError, match="was not stored whole"):
        picture(100, 100).save(tmp_path / f"a{suffix}")
    usage = shutil.disk_usage(tmp_path)._replace(free=4096)
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: usage)
    with pytest.raises(OutputError, match=f"a{suffix}: cannot be written: the disk is full"):
        picture(100, 100).save(tmp_path / f"a{suffix}")
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("suffix", image.SUFFIXES)
def test_a_full_disk_is_an_error_at_once(tmp_path: Path, suffix: str) -> None:
    # A limit on the size of files stands in for the full disk. OpenImageIO can hang here: hence the timeout.
    code = f"""
import resource, signal
import numpy as np
from thurston_cl.errors import OutputError
from thurston_cl.image import Image
random = np.random.default_rng(1)
noise = random.random((600, 300, 3), np.float32)
ids = random.integers(0, 2**32, (600, 300), np.uint32)
picture = Image({{"beauty": noise, "object": ids}})
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
try:
    picture.save({str(tmp_path / f"a{suffix}")!r})
except OutputError as error:
    print(error)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert run.returncode == 0, run.stderr
    assert re.search(rf"a{suffix}: (cannot be written|was not stored whole): .+", run.stdout), run.stdout
    assert os.listdir(tmp_path) == []


# --- what is not a picture


@pytest.mark.parametrize(
    ("channels", "says"),
    [
        ({}, "at least one channel"),
        ({"beuty": np.zeros((2, 2, 3), np.float32)}, "unknown channel 'beuty'"),
        ({"beauty": np.zeros((2, 2), np.float32)}, r"shape \(2, 2\), not \(2, 2, 3\)"),
        ({"depth": np.zeros((2, 0), np.float32)}, "without 0"),
        ({"depth": np.zeros((2, 2))}, "is float64, expected float32"),
        ({"object": np.zeros((2, 2), np.int32)}, "is int32, expected uint32"),
        (
            {"depth": np.zeros((2, 2), np.float32), "steps": np.zeros((2, 3), np.float32)},
            r"'steps' has the shape \(2, 3\), not \(2, 2\)",
        ),
    ],
)
def test_channels_that_make_no_picture(channels: dict[str, np.ndarray], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        Image(channels)


@pytest.mark.parametrize("value", ["a\0b", 3, None])
def test_metadata_that_no_file_holds(value: object) -> None:
    with pytest.raises(ValueError, match="metadata 'k' must be text"):
        Image({"depth": np.zeros((2, 2), np.float32)}, {"k": value})  # type: ignore[dict-item]


def test_reading_what_is_not_there_or_not_a_picture(tmp_path: Path) -> None:
    with pytest.raises(MissingFileError, match=r"a\.exr: cannot be read: .*No such file"):
        read_image(tmp_path / "a.exr")
    (tmp_path / "b.exr").write_text("no picture")
    with pytest.raises(MissingFileError, match=r"b\.exr: cannot be read"):
        read_image(tmp_path / "b.exr")


# --- comparing


def test_compare_counts_pixels_not_channels() -> None:
    wanted = np.zeros((4, 5, 3), np.float32)
    got = wanted.copy()
    got[0, 0] = 0.5
    got[1, 1, 2] = 0.011
    got[2, 2] = 0.01
    assert compare(got, wanted, 0.0101) == 2
    assert compare(wanted, got, 0.0) == 3
    assert compare(got, got, 0.0) == 0


def test_compare_sees_nan_and_infinity() -> None:
    wanted = np.array([[np.nan, np.inf, np.inf, 1.0, -np.inf]])
    got = np.array([[np.nan, np.inf, 1.0, np.nan, np.inf]])
    assert compare(got, wanted, 1e9) == 3


def test_compare_tells_the_largest_integers_apart() -> None:
    wanted = np.full((2, 2), 2**32 - 1, np.uint32)
    assert compare(wanted - np.uint32(1), wanted, 0) == 4
    with pytest.raises(ValueError, match="shapes"):
        compare(wanted, wanted[:1], 0)


def test_a_failing_picture_test_shows_got_wanted_and_difference(tmp_path: Path) -> None:
    wanted = np.full((4, 4, 3), 0.2, np.float32)
    got = wanted.copy()
    got[1, 2] = 0.9
    paths = save_comparison(tmp_path / "failed", "ball", got, wanted, 0.02)
    assert [path.name for path in paths] == ["ball-got.png", "ball-wanted.png", "ball-difference.png"]
    difference = to_srgb(read_image(paths[2]).channels["beauty"])
    assert difference[1, 2].tolist() == [255, 0, 0]
    assert difference.sum() == 255
    assert len(save_comparison(tmp_path, "ball", got, wanted[:2], 0.02)) == 2


# --- the house


def test_only_one_module_touches_openimageio() -> None:
    sources = [*ROOT.glob("thurston_cl/**/*.py"), *ROOT.glob("cli/**/*.py")]
    users = [
        path.name for path in sources if re.search(r"^\s*(import|from) OpenImageIO", path.read_text(), re.M)
    ]
    assert users == ["image.py"]
