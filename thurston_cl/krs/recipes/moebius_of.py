"""From a kernel-reflection sequence to a Moebius one: parts that mirrors would make equal are bent each in
its own way (KRS paper, section 6)."""

from collections.abc import Mapping
from collections.abc import Sequence as Series
from typing import Any

import numpy as np

from thurston_cl.krs.moebius import bend, rotation, translation
from thurston_cl.krs.vectors import two_across, unit

from .folds import Array
from .guard import guarded
from .pieces import moved

# The points of kernels that are branches, from end to end.
_ENDS = {"capsule": "ab", "torcap": "pmq"}


@guarded()
def moebius_of(record: Mapping[str, Any], *, strength: float = 0.2, seed: int = 1) -> dict[str, Any]:
    """The Moebius record of a record whose mirrors go through forks, each part bent about its root.

    `strength`: how near to a part its pole is, as a part of the reach of its branches; 0 bends nothing, 0.6
    is wild. What is joined stays joined. ValueError if the record is not one of mirrors in Euclidean space,
    or has a plane, no kernel or no mirror.
    """
    if "mirrors" not in record or "space" in record:
        raise ValueError("only a sequence of mirrors in Euclidean space is made a Moebius one")
    if any(kernel["type"] == "plane" for kernel in record["kernels"]):
        raise ValueError("a Moebius sequence has bounded kernels only, no planes")
    if all(kernel["type"] == "empty" for kernel in record["kernels"]):
        raise ValueError("there is no kernel to bend")
    if not record["mirrors"]:
        raise ValueError("there is no mirror, so that there is one part only")
    if not 0 <= strength < 1:
        raise ValueError(f"the strength of bending is from 0 to less than 1, not {strength:g}")
    random = np.random.default_rng(seed)
    kernels = record["kernels"]
    reach, _ = _measured(kernels[0])
    frames, bends = [], []
    for level, mirror in enumerate(record["mirrors"]):
        normal, offset = np.asarray(mirror["u"], dtype=float), float(mirror["w"])
        fork, root = _joints(kernels[level + 1 :], normal, offset)
        frames.append((_turn(normal), fork - (float(normal @ fork) - offset) * normal))
        reach += _measured(kernels[level + 1])[0]
        by = strength * random.uniform(0.6, 1.0) * unit(random.normal(size=3)) / (reach or 1.0)
        bends.append(translation(root) @ bend(by) @ translation(-root))

    # From the space in which mirror i is x = 0 to the world, bent there, and to that of the next mirror.
    maps = []
    for i, (turn, fork) in enumerate(frames):
        bent = bends[i] @ translation(fork) @ rotation(turn)
        if i + 1 < len(frames):
            next_turn, next_fork = frames[i + 1]
            bent = rotation(next_turn.T) @ translation(-next_fork) @ bent
        maps.append(bent)
    # The innermost kernel is given in the space of the same mirror as that after it.
    spaces = [frames[max(0, level - 1)] for level in range(len(kernels))]
    return {
        "G": [m.matrix.tolist() for m in maps],
        "clips": True,
        "kernels": [
            moved(kernel, turn.T, -turn.T @ fork)
            for kernel, (turn, fork) in zip(kernels, spaces, strict=True)
        ],
    }


def _joints(kernels: Series[Mapping[str, Any]], normal: Array, offset: float) -> tuple[Array, Array]:
    """Where a mirror doubles what is on a branch, and where all of that begins.

    The first of the kernels is added behind the mirror. If it is a branch, it goes from the one to the other;
    if it is a leaf or nothing, both are where the next branch ends.
    """
    for kernel in kernels:
        _, ends = _measured(kernel)
        if ends:
            near, far = sorted(ends, key=lambda end: abs(float(normal @ end - offset)))
            return near, far if kernel is kernels[0] else near
    return offset * normal, offset * normal


def _measured(kernel: Mapping[str, Any]) -> tuple[float, list[Array]]:
    """How far a kernel reaches, and the two ends of a branch; of others none."""
    kind = kernel["type"]
    if kind in ("capsule", "torcap"):
        first, *middle, last = (np.asarray(kernel[key], dtype=float) for key in _ENDS[kind])
        length = float(np.linalg.norm(last - first))
        if middle:
            length += float(np.linalg.norm(middle[0] - (first + last) / 2))
        return length + 2 * kernel["r"], [first, last]
    if kind in ("sphere", "lens"):
        return 2 * kernel["r" if kind == "sphere" else "b"], []
    return 0.0, []


def _turn(normal: Array) -> Array:
    """A rotation that takes x to the normal."""
    return np.column_stack([normal, *two_across(normal)])
