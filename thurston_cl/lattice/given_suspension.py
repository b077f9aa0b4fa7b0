"""A lattice of sol that a person gives by matrices and half-spaces, checked."""

import numpy as np

from thurston_cl.lattice.checks import blame
from thurston_cl.lattice.forms import Array
from thurston_cl.lattice.given_upright import check_bounding, pair_up, upright_walls
from thurston_cl.lattice.isometry import tidy, translation
from thurston_cl.lattice.suspension import GREATEST_TRACE, Suspension


def suspension_from(maps: Array, walls: Array, tolerance: float, name: str) -> Suspension:
    """The suspension with these isometries (F,4,4) and half-spaces (F,4): see `from_matrices`."""
    walls = upright_walls("sol", walls, tolerance)
    maps = np.array([tidy("sol", m, tolerance) for m in maps])
    sides = [f for f in range(len(walls)) if walls[f, 2] == 0]
    levels = [f for f in range(len(walls)) if walls[f, 2] != 0]
    for f in sides:
        maps[f] = _translation(maps[f], f, tolerance)
    for f in levels:
        _check_upright(maps[f], f)
    partner = pair_up("sol", walls, maps, tolerance)
    check_bounding("sol", walls)
    firsts = [f for f in sides if f < partner[f]]
    order = [*(f for first in firsts for f in (first, partner[first])), *levels]
    suspension = Suspension(name, "sol", walls[order], maps[order], "given by generators and half-spaces")
    _check_parallelogram(suspension, firsts, tolerance)
    if firsts and levels:
        _check_kept(suspension, levels[0], tolerance)
    return suspension


def _translation(m: Array, f: int, tolerance: float) -> Array:
    """The generator f, m (4,4), of a side, which must be a translation [x, y, 0]."""
    pure = translation("sol", np.array([m[0, 3], m[1, 3], 0.0, 1.0]))
    if np.max(np.abs(m - pure)) > 10.0 * tolerance:
        raise blame(
            "generators",
            f,
            "leads back over a side but is no translation [x, y, 0]; compose it with generators of the "
            "levels until it is one",
        )
    return pure


def _check_upright(m: Array, f: int) -> None:
    """The generator f, m (4,4), of a level must keep what is up."""
    if m[2, 2] < 0:
        raise blame(
            "generators",
            f,
            "leads back over a level but reverses z, which is not supported; give the half of the group "
            "that does not, with a domain twice as large",
        )


def _check_parallelogram(suspension: Suspension, firsts: list[int], tolerance: float) -> None:
    """There must be at most two pairs of sides, given by their first ones, each along the other's
    translations.
    """
    if len(firsts) > 2:
        raise blame(
            "domain",
            firsts[2],
            "is one side too many: a cell has at most two pairs of them in sol; give a parallelogram along "
            "two of the translations",
        )
    for side, moving in ((0, 1), (1, 0))[: 2 * len(firsts) - 2]:
        step = suspension.basis[moving]
        lean = abs(float(suspension.normals[side] @ step))
        if lean > 10.0 * tolerance * max(1.0, float(np.max(np.abs(step)))):
            raise blame(
                "generators",
                firsts[moving],
                f"moves the domain across half-space {firsts[side] + 1} by {lean:.2g}; let that half-space "
                "and the opposite one stand along this translation",
            )


def _check_kept(suspension: Suspension, level: int, tolerance: float) -> None:
    """Generator number `level` must make sums of the translations of the sides, with whole coefficients."""
    if len(suspension.basis) < 2:
        raise blame(
            "generators",
            level,
            "stretches the translation of the sides, so that it is not kept; add another pair of sides, or "
            "leave the levels out",
        )
    step = suspension.inverses[suspension.level_walls[0]]
    # The coefficients of the translations' images, in columns.
    m = suspension.normals @ step[:2, :2] @ suspension.basis.T / suspension.widths[:, None]
    trace = round(np.trace(m))
    if np.max(np.abs(m - np.round(m))) > 10.0 * tolerance * max(1.0, float(np.max(np.abs(m)))):
        written = ", ".join(f"[{row[0]:.6g}, {row[1]:.6g}]" for row in m)
        raise blame(
            "generators",
            level,
            f"does not keep the group of the sides' translations, on which it acts as [{written}] and not by "
            "whole numbers; correct it or them, and give all digits of irrational entries",
        )
    if abs(trace) > GREATEST_TRACE:
        raise blame(
            "generators",
            level,
            f"acts on the sides' translations with the trace {trace}: about as many cells meet "
            f"over a level, which are too many; keep it from -{GREATEST_TRACE} to {GREATEST_TRACE}",
        )
