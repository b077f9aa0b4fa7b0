"""cli/main.py: every outcome of `thurston` has its exit code and its message."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import types
import warnings
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result

from thurston_cl import errors
from thurston_cl.cli import main as module
from thurston_cl.cli.main import main
from thurston_cl.device import DeviceWarning


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> Callable[[Callable[[], object]], Result]:
    """Runs a function as the sub-command `schema`."""

    def invoke(body: Callable[[], object]) -> Result:
        stand_in = types.SimpleNamespace(command=click.Command("schema", callback=body))
        monkeypatch.setitem(sys.modules, "thurston_cl.cli.schema", stand_in)
        return CliRunner().invoke(main, ["schema"])

    return invoke


def raising(error: BaseException) -> Callable[[], object]:
    def body() -> None:
        raise error

    return body


@pytest.mark.parametrize(
    ("error", "code", "text"),
    [
        (errors.ThurstonError("no luck"), 1, "thurston: error: no luck\n"),
        (errors.BuildError("no luck"), 1, "thurston: error: no luck\n"),
        (errors.SceneError("a.yaml:1:2: error: no luck"), 65, "a.yaml:1:2: error: no luck\n"),
        (errors.MissingFileError("a.yaml"), 66, "thurston: error: a.yaml\n"),
        (errors.NoDeviceError("none"), 69, "thurston: error: none\n"),
        (errors.OutputError("a.png exists"), 73, "thurston: error: a.png exists\n"),
        (errors.Interrupted(""), 130, "thurston: interrupted\n"),
        (errors.Interrupted("no file was written"), 130, "thurston: interrupted: no file was written\n"),
        (KeyboardInterrupt(), 130, "\nthurston: interrupted\n"),
        (click.Abort(), 130, "thurston: interrupted\n"),
    ],
)
def test_errors(run: Callable[..., Result], error: BaseException, code: int, text: str) -> None:
    result = run(raising(error))
    assert (result.exit_code, result.stderr, result.stdout) == (code, text, "")


def test_usage_error_within_a_command(run: Callable[..., Result]) -> None:
    result = run(raising(click.UsageError("not so")))
    assert result.exit_code == 2
    assert "Error: not so" in result.stderr


def test_unexpected_error(run: Callable[..., Result]) -> None:
    result = run(raising(ZeroDivisionError("oh")))
    assert result.exit_code == 1
    first, *rest = result.stderr.splitlines()
    assert first == "thurston: internal error: ZeroDivisionError: oh"
    assert rest[0].startswith("Traceback")
    assert rest[-1] == "ZeroDivisionError: oh"


def test_done_and_missed_accuracy(run: Callable[..., Result]) -> None:
    assert run(lambda: None).exit_code == 0
    assert run(lambda: "an answer nobody asked for").exit_code == 0
    assert run(lambda: click.get_current_context().exit(3)).exit_code == 3


def test_warnings(run: Callable[..., Result]) -> None:
    def body() -> None:
        warnings.warn("skipped it", DeviceWarning, stacklevel=1)
        warnings.warn("a library's", RuntimeWarning, stacklevel=1)

    with pytest.warns(RuntimeWarning, match="a library's"):  # left to Python, which here is left to pytest
        result = run(body)
    assert result.stderr == "thurston: warning: skipped it\n"


def test_terminate_handler_is_put_back(run: Callable[..., Result]) -> None:
    before = signal.getsignal(signal.SIGTERM)
    during = []
    run(lambda: during.append(signal.getsignal(signal.SIGTERM)))
    assert signal.getsignal(signal.SIGTERM) is before
    assert during != [before]


def test_help_lists_commands_and_exit_codes() -> None:
    result = CliRunner().invoke(main, ["--help"])
    assert result.exit_code == 0
    for name, line in module.COMMANDS.items():
        assert f"{name} " in result.stdout
        assert line in result.stdout
    for error in (errors.SceneError, errors.MissingFileError, errors.NoDeviceError, errors.OutputError):
        assert f"\n     {error.exit_code}  " in result.stdout
    assert "\n    130  interrupted" in result.stdout


@pytest.mark.parametrize("name", module.COMMANDS)
def test_every_command_explains_itself(name: str) -> None:
    result = CliRunner().invoke(main, [name, "--help"])
    assert result.exit_code == 0, result.stderr
    assert f"Usage: main {name}" in result.stdout


def test_usage() -> None:
    result = CliRunner().invoke(main, ["rendr"])
    assert result.exit_code == 2
    assert "No such command 'rendr'" in result.stderr
    assert CliRunner().invoke(main, ["devices", "--chekc"]).exit_code == 2
    assert CliRunner().invoke(main, []).exit_code == 2


# In a process of its own


def thurston(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "thurston_cl.cli.main", *arguments]


def test_version() -> None:
    done = subprocess.run(thurston("--version"), capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, f"thurston {version('thurston_cl')}\n")


def test_help_is_quick() -> None:
    code = (
        "import sys; from thurston_cl.cli.main import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: print({'pyopencl', 'scipy', 'pydantic', 'OpenImageIO'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "set()"


STAND_IN = """
import sys, time, types, click
from thurston_cl.cli.main import main
def body():
    {body}
sys.modules["thurston_cl.cli.schema"] = types.SimpleNamespace(command=click.Command("schema", callback=body))
main(["schema"])
"""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_signals_unwind(number: signal.Signals) -> None:
    body = """
    try: print("ready", flush=True); time.sleep(30)
    finally: print("cleaned up")
    """
    child = subprocess.Popen(
        [sys.executable, "-c", STAND_IN.format(body=body)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert child.stdout is not None
    assert child.stdout.readline() == "ready\n"
    os.kill(child.pid, number)
    out, err = child.communicate(timeout=20)
    assert child.returncode == 130
    assert out == "cleaned up\n"
    assert err.strip() == "thurston: interrupted"


FULL = Path("/dev/full")


@pytest.mark.skipif(not FULL.exists(), reason="this system has no device that is always full")
@pytest.mark.parametrize("lines", [1, 100_000])
def test_no_room_for_the_answer(lines: int) -> None:
    body = f'[click.echo("line") for _ in range({lines})]; print("last")'
    with FULL.open("w") as full:
        done = subprocess.run(
            [sys.executable, "-c", STAND_IN.format(body=body)], stdout=full, stderr=subprocess.PIPE, text=True
        )
    assert done.returncode == 73
    assert done.stderr == "thurston: error: cannot write the output: No space left on device\n"


def test_other_errors_of_the_system_are_our_mistakes(run: Callable[..., Result]) -> None:
    result = run(raising(OSError(errno.EINVAL, "no such thing")))
    assert result.exit_code == 1
    assert result.stderr.startswith("thurston: internal error: OSError: [Errno 22] no such thing\n")


def test_nobody_listens() -> None:
    """stdout is closed: there is nothing to say it to, and nothing that failed."""
    done = subprocess.run(
        [sys.executable, "-c", STAND_IN.format(body='click.echo("line")')],
        preexec_fn=lambda: os.close(1),
        stderr=subprocess.PIPE,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("lines", [1, 100_000])
def test_broken_pipe_is_quiet(lines: int) -> None:
    body = f'time.sleep(0.3); [click.echo("line") for _ in range({lines})] and print("last")'
    child = subprocess.Popen(
        [sys.executable, "-c", STAND_IN.format(body=body)], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert child.stdout is not None
    assert child.stderr is not None
    child.stdout.close()
    assert child.stderr.read() == b""
    assert child.wait(timeout=20) == 1
