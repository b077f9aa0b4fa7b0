"""Every error a user can meet, with the exit code the command line returns for it."""


class ThurstonError(Exception):
    """Something failed in a way that we can explain. `exit_code` is what the command line returns."""

    exit_code = 1


class SceneError(ThurstonError):
    """The scene is wrong; the text lists every mistake with file, line, column and cure."""

    exit_code = 65


class MissingFileError(ThurstonError):
    """A file that was asked for is not there or cannot be read."""

    exit_code = 66


class NoDeviceError(ThurstonError):
    """No OpenCL device can build and run our kernels."""

    exit_code = 69


class OutputError(ThurstonError):
    """A picture could not be written, or would overwrite one without `--force`."""

    exit_code = 73


class BuildError(ThurstonError):
    """A kernel did not compile; the text names the options, the log and the saved source."""


class Interrupted(ThurstonError):
    """Stopped by Ctrl-C or SIGTERM; nothing half-written was left behind."""

    exit_code = 130
