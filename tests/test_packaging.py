"""Wheel, sdist and editable install have kernels, commands and scenes; the wheel runs anywhere."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import zipfile
from importlib.resources import files
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = {
    "thurston_cl": "thurston_cl",
    "kernels": "thurston_cl/kernels",
    "cli": "thurston_cl/cli",
    "scenes": "thurston_cl/scenes",
    "benchmarks/accuracy": "thurston_cl/measured",
}
SUFFIXES = (".py", ".cl", ".h", ".json", ".yaml", ".json", ".typed", ".ocio", ".jpg")


def sources(root: Path) -> set[str]:
    """Every file of the checkout's packages, by the name under which it is installed."""
    return {
        f"{PACKAGES[folder]}/{path.relative_to(root / folder).as_posix()}"
        for folder in PACKAGES
        for path in (root / folder).rglob("*")
        if path.suffix in SUFFIXES and "__pycache__" not in path.parts
    }


def run(*command: str | Path, cwd: Path, **variables: str) -> str:
    done = subprocess.run(
        command, cwd=cwd, env=os.environ | variables, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel made from an sdist, which is made from a copy of the checkout (in the folder above)."""
    copy = tmp_path_factory.mktemp("checkout")
    for name in PACKAGES:
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("setup.cfg", "pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy / name)
    run(sys.executable, "-m", "build", "--no-isolation", cwd=copy)
    (sdist,) = (copy / "dist").glob("*.tar.gz")
    (wheel,) = (copy / "dist").glob("*.whl")
    assert sdist.name.startswith("thurston_cl-")
    return wheel


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the installed wheel; on PYTHONPATH it wins over the environment's editable install."""
    folder = tmp_path_factory.mktemp("installed")
    arguments = ("install", "--quiet", "--no-deps", "--no-index", "--target", folder, wheel)
    run(sys.executable, "-m", "pip", *arguments, cwd=folder)
    return folder


def test_wheel_made_from_the_sdist_holds_every_source(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    assert sources(wheel.parents[1]) - names == set()
    assert any(name.endswith("licenses/LICENSE") for name in names)
    # Nothing else comes along: tests, tools and benchmarks belong to the checkout.
    assert {name.split("/")[0] for name in names if ".dist-info/" not in name} == {"thurston_cl"}


LOCATE = """
import json, thurston_cl
from importlib.resources import files
places = [files("thurston_cl." + name) for name in ("kernels", "cli", "scenes")]
print(json.dumps([thurston_cl.__file__, *map(str, places)]))
"""


def test_installed_wheel_finds_its_own_files(wheel: Path, installed: Path, tmp_path: Path) -> None:
    places = json.loads(run(sys.executable, "-P", "-c", LOCATE, cwd=tmp_path, PYTHONPATH=str(installed)))
    package = installed / "thurston_cl"
    found = ("__init__.py", "kernels", "cli", "scenes")
    assert places == [str(package / name) for name in found]
    names = {path.relative_to(installed).as_posix() for path in package.rglob("*") if path.suffix in SUFFIXES}
    assert names == sources(wheel.parents[1])


def thurston(installed: Path, cwd: Path, *arguments: str) -> str:
    script = installed / "bin" / "thurston"
    return run(sys.executable, "-P", script, *arguments, cwd=cwd, PYTHONPATH=str(installed))


def test_installed_wheel_runs(installed: Path, tmp_path: Path) -> None:
    devices = json.loads(thurston(installed, tmp_path, "devices", "--json"))["devices"]
    assert devices[0]["id"] == "0:0"
    scenes = {path.stem for path in (ROOT / "scenes").rglob("*.yaml")}
    listed = thurston(installed, tmp_path, "scenes")
    assert scenes
    assert all(name in listed for name in scenes)


def test_installed_wheel_renders(installed: Path, tmp_path: Path) -> None:
    scene = min((installed / "thurston_cl" / "scenes" / "h3").glob("*.yaml"))
    options = ("--size", "32x24", "--samples", "1")
    thurston(installed, tmp_path, "render", str(scene), "-o", "small.png", *options)
    assert (tmp_path / "small.png").read_bytes().startswith(b"\x89PNG")


def test_editable_install_reads_the_checkout() -> None:
    for folder in ("kernels", "cli", "scenes"):
        assert Path(str(files(f"thurston_cl.{folder}"))).resolve() == ROOT / folder
