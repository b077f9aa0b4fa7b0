"""tools/: what the set-up decides on made-up computers: with or without Python, OpenCL, apt, root, sudo."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


class Computer:
    """A folder with made-up programs, which is the whole PATH, and a record of those that were called."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.bin = folder / "bin"
        self.venv = folder / "venv"
        self.calls_file = folder / "calls"
        self.bin.mkdir()
        (self.venv / "bin").mkdir(parents=True)
        for name in ("bash", "env", "dirname", "mktemp", "rm", "cat", "touch", "mkdir", "chmod"):
            real = shutil.which(name)
            assert real
            (self.bin / name).symlink_to(real)
        self.has("id", "echo 0")
        self.has("apt-get", self.record("apt-get"))
        # The device works once a file "works" is there.
        works = f"[ -e {folder}/works ] || {{ echo 'thurston: error: no device' >&2; exit 69; }}"
        self.has(self.venv / "bin" / "thurston", works)
        self.has(self.venv / "bin" / "python", self.record("python"))

    def record(self, name: str) -> str:
        return f'echo "{name} $*" >>{self.calls_file}'

    def has(self, name: str | Path, script: str) -> None:
        """Adds a program; a bare name goes to the PATH."""
        path = self.bin / name
        path.unlink(missing_ok=True)
        path.write_text(f"#!/bin/bash\n{script}\n")
        path.chmod(0o755)

    def run(self, tool: str, **variables: str) -> subprocess.CompletedProcess[str]:
        environment = {"PATH": str(self.bin), "TMPDIR": str(self.folder)} | variables
        command = [ROOT / "tools" / tool, self.venv]
        return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=20)

    def calls(self) -> list[str]:
        return self.calls_file.read_text().splitlines() if self.calls_file.exists() else []


@pytest.fixture
def computer(tmp_path: Path) -> Computer:
    return Computer(tmp_path)


PIP_INSTALL = "python -m pip install --quiet pocl-binary-distribution"
PIP_UNINSTALL = "python -m pip uninstall --quiet --yes pocl-binary-distribution"
INSTALL = "apt-get install -y -qq --no-install-recommends"
APT = ["apt-get update -qq", f"{INSTALL} pocl-opencl-icd"]


def pip(computer: Computer, effect: str) -> None:
    """Makes `pip install` have an effect in the shell."""
    script = f'{computer.record("python")}\ncase "$*" in *" install "*) {effect} ;; esac'
    computer.has(computer.venv / "bin" / "python", script)


def apt(computer: Computer, effect: str) -> None:
    """Makes `apt-get install` have an effect in the shell."""
    script = f'{computer.record("apt-get")}\ncase "$*" in install*) {effect} ;; esac'
    computer.has("apt-get", script)


# OpenCL


def test_a_device_that_works_is_used(computer: Computer) -> None:
    (computer.folder / "works").touch()
    done = computer.run("ensure_opencl.sh")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert computer.calls() == []


def test_pocl_from_pip_is_kept_where_it_works(computer: Computer) -> None:
    pip(computer, f"touch {computer.folder}/works")
    done = computer.run("ensure_opencl.sh")
    assert done.returncode == 0
    assert "PoCL from pip builds and runs a kernel here" in done.stdout
    assert computer.calls() == [PIP_INSTALL]


def test_pocl_from_pip_is_dropped_where_it_does_not_work(computer: Computer) -> None:
    apt(computer, f"touch {computer.folder}/works")
    done = computer.run("ensure_opencl.sh")
    assert done.returncode == 0
    assert "PoCL from pip does not work on this CPU; removed" in done.stdout
    assert "PoCL from apt builds and runs a kernel here" in done.stdout
    assert computer.calls() == [PIP_INSTALL, PIP_UNINSTALL, *APT]


def test_no_pocl_on_pip(computer: Computer) -> None:
    pip(computer, "exit 1")
    apt(computer, f"touch {computer.folder}/works")
    done = computer.run("ensure_opencl.sh")
    assert done.returncode == 0
    assert "pip has no PoCL for this system" in done.stdout
    assert computer.calls() == [PIP_INSTALL, *APT]


def test_sudo_where_not_root(computer: Computer) -> None:
    computer.has("id", "echo 1000")
    computer.has("sudo", f'{computer.record("sudo")}; exec "$@"')
    apt(computer, f"touch {computer.folder}/works")
    assert computer.run("ensure_opencl.sh").returncode == 0
    assert [call for call in computer.calls() if call.startswith("sudo")] == [
        "sudo apt-get update -qq",
        f"sudo env DEBIAN_FRONTEND=noninteractive {INSTALL} pocl-opencl-icd",
    ]


def test_neither_root_nor_sudo(computer: Computer) -> None:
    computer.has("id", "echo 1000")
    done = computer.run("ensure_opencl.sh")
    assert done.returncode == 1
    assert "not root, and no sudo; please run as root: apt-get install pocl-opencl-icd" in done.stderr
    assert not any(call.startswith("apt-get") for call in computer.calls())


def test_no_apt(computer: Computer) -> None:
    (computer.bin / "apt-get").unlink()
    done = computer.run("ensure_opencl.sh")
    assert done.returncode == 1
    assert "no apt-get; please install what Debian calls: pocl-opencl-icd" in done.stderr


def test_apt_fails(computer: Computer) -> None:
    apt(computer, "exit 100")
    done = computer.run("ensure_opencl.sh")
    assert done.returncode == 1
    assert "that failed; please run as root: apt-get install pocl-opencl-icd" in done.stderr


def test_lists_that_cannot_be_refreshed_do_not_stop_apt(computer: Computer) -> None:
    script = f'case "$1" in update) exit 100 ;; install) touch {computer.folder}/works ;; esac'
    computer.has("apt-get", script)
    assert computer.run("ensure_opencl.sh").returncode == 0


def test_still_no_device_after_all(computer: Computer) -> None:
    done = computer.run("ensure_opencl.sh")
    assert done.returncode == 1
    assert "still no device works" in done.stderr
    assert "thurston: error: no device" in done.stderr


def test_a_broken_thurston_installs_nothing(computer: Computer) -> None:
    computer.has(computer.venv / "bin" / "thurston", "echo 'internal error: oh' >&2; exit 1")
    done = computer.run("ensure_opencl.sh")
    assert done.returncode == 1
    assert "internal error: oh" in done.stderr
    assert computer.calls() == []


# Environment


def python(computer: Computer, name: str, release: str, *, ensurepip: bool = True) -> None:
    """Adds a made-up Python: answers the questions of ensure_venv.sh, and makes environments if it can."""
    new = "0" if tuple(map(int, release.split("."))) >= (3, 11) else "1"
    computer.has(
        name,
        f"""{computer.record(name)}
case "$*" in
    --version) echo Python {release}.0 ;;
    *version_info\\ \\<*) exit {new} ;;
    *"import ensurepip"*) [ -e {computer.folder}/ensurepip ] ;;
    *python%d*) echo python{release}-venv ;;
    *"-m venv"*)
        mkdir -p {computer.venv}/bin
        [ -e {computer.folder}/ensurepip ] || {{ echo "ensurepip is not available"; exit 1; }}
        echo "#!/bin/bash" >{computer.venv}/bin/python; chmod +x {computer.venv}/bin/python ;;
esac""",
    )
    if ensurepip:
        (computer.folder / "ensurepip").touch()


def made_by(computer: Computer) -> list[str]:
    return [call.split()[0] for call in computer.calls() if "-m venv" in call]


@pytest.fixture
def bare(computer: Computer) -> Computer:
    """A computer without an environment."""
    shutil.rmtree(computer.venv)
    return computer


def test_an_environment_is_used(computer: Computer) -> None:
    done = computer.run("ensure_venv.sh")
    assert (done.returncode, done.stdout) == (0, "")
    assert computer.calls() == ["python -m pip --version"]


def test_the_first_python_that_is_new_enough(bare: Computer) -> None:
    python(bare, "python3", "3.10")
    python(bare, "python3.12", "3.12")
    python(bare, "python3.11", "3.11")
    done = bare.run("ensure_venv.sh")
    assert done.returncode == 0
    assert "of Python 3.12.0" in done.stdout
    assert made_by(bare) == ["python3.12"]


def test_python_by_name(bare: Computer) -> None:
    python(bare, "python3", "3.14")
    python(bare, "mine", "3.11")
    assert bare.run("ensure_venv.sh", PYTHON="mine").returncode == 0
    assert made_by(bare) == ["mine"]


@pytest.mark.parametrize(("variables", "name"), [({}, "python3"), ({"PYTHON": "mine"}, "mine")])
def test_no_python_that_is_new_enough(bare: Computer, variables: dict[str, str], name: str) -> None:
    python(bare, "python3", "3.10")
    done = bare.run("ensure_venv.sh", **variables)
    assert done.returncode == 1
    assert f"{name} is not a Python >= 3.11" in done.stderr
    assert "make PYTHON=" in done.stderr


def test_missing_venv_package_comes_from_apt(bare: Computer) -> None:
    python(bare, "python3", "3.11", ensurepip=False)
    apt(bare, f"touch {bare.folder}/ensurepip")
    done = bare.run("ensure_venv.sh")
    assert done.returncode == 0, done.stderr
    assert f"{INSTALL} python3.11-venv" in bare.calls()
    assert (bare.venv / "bin" / "python").exists()


def test_missing_venv_package_and_no_root(bare: Computer) -> None:
    python(bare, "python3", "3.11", ensurepip=False)
    bare.has("id", "echo 1000")
    done = bare.run("ensure_venv.sh")
    assert done.returncode == 1
    assert "please run as root: apt-get install python3.11-venv" in done.stderr
    assert not bare.venv.exists()


# Makefile


def make(*arguments: str) -> str:
    done = subprocess.run(["make", "-n", *arguments], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_make_render_names_the_picture() -> None:
    commands = make("render", "SCENE=scenes/e3/some.scene.yaml")
    assert "thurston render scenes/e3/some.scene.yaml -o out/some.scene.png --force" in commands
    assert f"Picture: {ROOT}/out/some.scene.png" in commands


def test_make_test_checks_too() -> None:
    commands = make("test")
    for tool in ("ruff check", "ruff format --check", "mypy", "pytest", "tools/ensure_opencl.sh"):
        assert tool in commands


def test_continuous_integration_runs_make_test() -> None:
    script = ROOT / ".ci" / "run"
    assert os.access(script, os.X_OK)
    assert "make test" in script.read_text()
    assert ".ci/run" in (ROOT / ".github" / "workflows" / "test.yml").read_text()
