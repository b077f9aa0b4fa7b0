"""The error of a lattice that is unknown or wrong."""

from thurston_cl.errors import ThurstonError


class LatticeError(ThurstonError, ValueError):
    """A lattice is unknown or wrong.

    `what` is "generators", "domain", "monodromy" or "name", and `index` says which generator, half-space or
    row (None: all of them), so that a scene loader can point at the line.
    """

    exit_code = 65

    def __init__(self, message: str, what: str, index: int | None = None) -> None:
        super().__init__(message)
        self.what = what
        self.index = index
