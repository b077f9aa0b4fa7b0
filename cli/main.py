"""The command `thurston`: finds the sub-command, and turns every failure into a message and an exit code."""

from __future__ import annotations

import contextlib
import errno
import importlib
import os
import signal
import sys
import threading
import traceback
import warnings
from collections.abc import Iterator, Sequence
from types import FrameType
from typing import Any, TextIO

import click

from thurston_cl.device import DeviceWarning
from thurston_cl.errors import Interrupted, OutputError, SceneError, ThurstonError

# One module a command, named after it, with the command in `command`. The help line stands here so that
# `thurston --help` imports none of them.
COMMANDS = {
    "render": "Render a scene to a picture, or to EXR channels.",
    "explain": "Say what a scene calls for, and what is left out.",
    "validate": "Check scenes, and list every mistake.",
    "schema": "Print the JSON Schema of scenes, for editors.",
    "scenes": "List the scenes that come with thurston.",
    "accuracy": "Measure what accuracy costs in time.",
    "devices": "List the OpenCL devices, and whether they work.",
}

# What the system says where there is no room to write: the disk, the quota or the file is full.
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)

EXIT_CODES = """\b
Exit codes:
    0  done
    1  failed
    2  wrong usage
    3  rendered, but the accuracy target was missed
   65  the scene is wrong
   66  a file is missing
   69  no OpenCL device works
   73  cannot write the output
  130  interrupted
"""


class LazyCommand(click.Command):
    """Stands in for a command until it is called, and only then imports its module."""

    def make_context(
        self, info_name: str | None, args: list[str], parent: click.Context | None = None, **extra: Any
    ) -> click.Context:
        module = importlib.import_module(f"thurston_cl.cli.{self.name}")
        command: click.Command = module.command
        return command.make_context(info_name, args, parent=parent, **extra)


class Thurston(click.Group):
    """A group whose every outcome has a documented exit code; messages go to stderr, answers to stdout."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(self.commands)  # in the order of COMMANDS, not of the alphabet

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        **extra: Any,
    ) -> Any:
        if not standalone_mode:
            return super().main(args, prog_name, complete_var, standalone_mode=False, **extra)
        with _terminate_as_interrupt(), _short_warnings():
            try:
                result: Any = super().main(args, prog_name, complete_var, standalone_mode=False, **extra)
                if sys.stdout is not None:  # it is None where the caller has closed it
                    sys.stdout.flush()
            except SceneError as error:
                click.echo(str(error), err=True)
                sys.exit(error.exit_code)
            except (click.Abort, KeyboardInterrupt, Interrupted) as error:
                click.echo(f"thurston: interrupted{f': {error}' if str(error) else ''}", err=True)
                sys.exit(Interrupted.exit_code)
            except ThurstonError as error:
                click.echo(f"thurston: error: {error}", err=True)
                sys.exit(error.exit_code)
            except click.ClickException as error:
                error.show()
                sys.exit(error.exit_code)
            except BrokenPipeError:
                # The reader has left, as in `thurston scenes | head -1`.
                _drop_stdout()
                sys.exit(1)
            except Exception as error:
                if isinstance(error, OSError) and error.errno in NO_ROOM:
                    _drop_stdout()
                    click.echo(f"thurston: error: cannot write the output: {error.strerror}", err=True)
                    sys.exit(OutputError.exit_code)
                click.echo(f"thurston: internal error: {type(error).__name__}: {error}", err=True)
                click.echo(traceback.format_exc(), err=True, nl=False)
                sys.exit(1)
        # click hands over the code of `ctx.exit(code)` as the result.
        sys.exit(result if type(result) is int else 0)


def _drop_stdout() -> None:
    """Keep the flush at exit quiet: what stdout could not take goes nowhere."""
    with contextlib.suppress(OSError):  # a stand-in without a file behind it, as in tests
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@contextlib.contextmanager
def _terminate_as_interrupt() -> Iterator[None]:
    """SIGTERM unwinds like Ctrl-C, so that half-written files are removed on the way out."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def interrupt(signum: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    previous = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, previous)


@contextlib.contextmanager
def _short_warnings() -> Iterator[None]:
    """Our own warnings are one line for the user; those of libraries keep their file and line for us."""
    with warnings.catch_warnings():
        standard = warnings.showwarning

        def show(
            message: Warning | str,
            category: type[Warning],
            filename: str,
            lineno: int,
            file: TextIO | None = None,
            line: str | None = None,
        ) -> None:
            if category is UserWarning or issubclass(category, DeviceWarning):
                click.echo(f"thurston: warning: {message}", err=True)
            else:
                standard(message, category, filename, lineno, file, line)

        warnings.showwarning = show
        yield


@click.group(
    cls=Thurston,
    commands=[LazyCommand(name, short_help=line) for name, line in COMMANDS.items()],
    epilog=EXIT_CODES,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(package_name="thurston_cl", message="thurston %(version)s")
def main() -> None:
    """Render pictures from inside Thurston's geometries, from scenes written in YAML.

    Every command explains itself: thurston COMMAND --help.
    """


if __name__ == "__main__":
    main(prog_name="thurston")
