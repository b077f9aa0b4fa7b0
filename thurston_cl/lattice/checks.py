"""What is checked of every lattice that a person gives."""

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from thurston_cl.lattice.error import LatticeError
from thurston_cl.lattice.forms import Array
from thurston_cl.lattice.isometry import dimension, keeps_model, rules

What = Literal["generators", "domain"]
# How deep inside the domain an image must be to count: far above rounding, far below any cell.
OVERLAP = 1e-6
# The origin must be at least this far inside every wall.
INSIDE = 1e-9


def given_numbers(geometry: str, generators: ArrayLike, half_spaces: ArrayLike) -> tuple[Array, Array]:
    """Generators (F,n,n) and half-spaces (F,n) as arrays. Raises LatticeError where they are none."""
    n = dimension(geometry)
    maps = _numbers(generators, (n, n), "generators", f"generators must be a list of {n}x{n} matrices")
    names = ", ".join("abcde"[:n])
    walls = _numbers(half_spaces, (n,), "domain", f"the domain must be a list of half-spaces [{names}]")
    if len(maps) != len(walls):
        raise LatticeError(
            f"there are {len(maps)} generators but {len(walls)} half-spaces; "
            "give one half-space for each generator",
            "domain",
        )
    return maps, walls


def blame(what: What, index: int, text: str) -> LatticeError:
    """The error that blames generator or half-space number `index`, from 0."""
    noun = "generator" if what == "generators" else "half-space"
    return LatticeError(f"{noun} {index + 1} {text}", what, index)


def _numbers(values: ArrayLike, shape: tuple[int, ...], what: What, expected: str) -> Array:
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise LatticeError(expected, what) from None
    if array.ndim != len(shape) + 1 or array.shape[1:] != shape or len(array) == 0:
        raise LatticeError(expected, what)
    for f, entry in enumerate(array):
        if not np.all(np.isfinite(entry)):
            raise blame(what, f, "has a number that is not finite; correct it")
    return array


def check_isometry(geometry: str, m: Array, f: int, tolerance: float) -> None:
    """Raises LatticeError where generator f, m (n,n), is no isometry."""
    for rule, off in rules(geometry, m).items():
        if off > tolerance:
            raise blame(
                "generators",
                f,
                f"is not an isometry of {geometry} (off by {off:.2g}, allowed {tolerance:.2g}): {rule}; "
                "check its signs and give all digits of irrational entries",
            )
    if not keeps_model(geometry, m):
        which = "third diagonal entry" if dimension(geometry) == 5 else "last entry"
        cure = "its upper left 3x3 block" if dimension(geometry) == 5 else "the matrix"
        raise blame(
            "generators",
            f,
            f"exchanges the sheets of the hyperboloid: its {which} must be positive; negate {cure}",
        )


def partner_of(
    f: int,
    inverse_defects: Array,
    wall_defects: Array,
    outward_defect: Callable[[int], float],
    allowed: float,
) -> int:
    """The wall whose map is the inverse of map f, and to which that carries wall f, or LatticeError.

    `inverse_defects` and `wall_defects` (F,) say by how much each wall fails either, `outward_defect` by how
    much one would fail the second if map f led out of the domain instead of back.
    """
    inverses = np.flatnonzero(inverse_defects < allowed)
    if len(inverses) == 0:
        raise blame(
            "generators",
            f,
            "has no inverse among the generators; add it, with the half-space whose points it leads back",
        )
    best = int(inverses[np.argmin(wall_defects[inverses])])
    if wall_defects[best] < allowed:
        return best
    if outward_defect(best) < allowed:
        raise blame(
            "generators",
            f,
            "moves the wrong way: it must lead back the points outside its half-space; "
            "exchange it with its inverse",
        )
    raise blame(
        "domain",
        f,
        f"does not fit its generator, which should carry its plane to that of half-space {best + 1} "
        f"and misses by {wall_defects[best]:.2g}; correct one of the half-spaces or the generator",
    )
