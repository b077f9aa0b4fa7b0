"""Records of sequences, as dictionaries of plain numbers: what they may say, and the sequences they mean.

`{"mirrors": [{"u": [3], "w": x}, ...], "kernels": [...], "smooth": [...]}` in Euclidean space, `{"G":
[...], "kernels": [...]}` of Moebius maps, `{"space": "S3", "mirrors": [[4], ...], "kernels": [...]}` in a
curved space.
"""

import warnings
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thurston_cl.krs import curved, moebius
from thurston_cl.krs.kernels import Kernel, direction, kernel_of, number
from thurston_cl.krs.sequence import MOST_LEVELS, Mirror, MoebiusSequence
from thurston_cl.krs.sequence import Sequence as KernelSequence

Array = NDArray[np.float64]

_KEYS = {
    "mirrors": ("mirrors", "kernels", "smooth", "within"),
    "G": ("G", "kernels", "smooth"),
    "space": ("space", "mirrors", "kernels", "smooth"),
}
# A key so alike to one of these is taken for it.
_MISSPELT = 0.75
# A normal longer or shorter by this much is no unit vector written with few digits.
OFF_UNIT = 1e-6
# A message names no more kernels than these.
_MOST_TOLD = 6


def sequence_of(record: Mapping[str, Any]) -> KernelSequence | MoebiusSequence:
    """The sequence that a record describes. ValueError where it makes no sense; a warning for normals that
    are not of length 1, and are made so.
    """
    form = next((key for key in ("G", "space", "mirrors") if key in record), None)
    steps_key = "G" if form == "G" else "mirrors"
    if form is None or steps_key not in record or "kernels" not in record:
        raise ValueError("a record of a sequence has 'mirrors' or 'G', and 'kernels'")
    for key in record:
        # What else a record says of a model is not our business.
        meant = get_close_matches(str(key), _KEYS[form], 1, _MISSPELT)
        if meant and key not in _KEYS[form]:
            raise ValueError(f"unknown key {key!r}; did you mean {meant[0]!r}?")
    steps = _series(record[steps_key], steps_key)
    if len(steps) > MOST_LEVELS:
        raise ValueError(f"{len(steps)} levels; expected at most {MOST_LEVELS}")
    widths = _widths(record.get("smooth"), len(steps))
    kernels = _series(record["kernels"], "kernels")
    found: KernelSequence | MoebiusSequence
    if form == "space":
        space = curved.space_named(record["space"])
        found = KernelSequence(
            space.geometry,
            tuple(
                space.mirror(m, f"mirror {i}", w) for i, (m, w) in enumerate(zip(steps, widths, strict=True))
            ),
            tuple(space.kernel(_mapping(k, f"kernel {i}"), f"kernel {i}") for i, k in enumerate(kernels)),
        )
    elif form == "G":
        found = MoebiusSequence(tuple(map(_map, range(len(steps)), steps)), widths, _kernels(kernels))
    else:
        found = KernelSequence("e3", _mirrors(steps, widths), _kernels(kernels), _within(record))
    return found


def _series(value: Any, what: str) -> Sequence[Any]:
    if not isinstance(value, (list, tuple, np.ndarray)):
        raise ValueError(f"{what} is {value!r}; expected a list")
    return list(value)


def _mapping(value: Any, what: str) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise ValueError(f"{what} is {value!r}; expected a mapping")
    return value


def _kernels(kernels: Sequence[Any]) -> tuple[Kernel, ...]:
    return tuple(kernel_of(_mapping(k, f"kernel {i}"), f"kernel {i}") for i, k in enumerate(kernels))


def _widths(smooth: Any, count: int) -> tuple[float, ...]:
    if smooth is None:
        return (0.0,) * count
    widths = tuple(number(width, f"smooth {i}") for i, width in enumerate(_series(smooth, "smooth")))
    if len(widths) != count:
        raise ValueError(f"smooth has {len(widths)} widths for {count} levels; expected one for each")
    if any(width < 0 for width in widths):
        raise ValueError("smooth has a negative width; expected numbers from 0")
    return widths


def _within(record: Mapping[str, Any]) -> float:
    if "within" not in record:
        return np.inf
    radius = number(record["within"], "within")
    if radius <= 0:
        raise ValueError(f"within is {radius:g}; expected a number greater than 0")
    return radius


def _mirrors(mirrors: Sequence[Any], widths: Sequence[float]) -> tuple[Mirror, ...]:
    made, lengths = [], []
    for i, (entry, width) in enumerate(zip(mirrors, widths, strict=True)):
        mirror = _mapping(entry, f"mirror {i}")
        for key in ("u", "w"):
            if key not in mirror:
                raise ValueError(f"mirror {i} has no {key!r}")
        u, length = direction(mirror["u"], f"u of mirror {i}")
        made.append(plane_mirror(u, number(mirror["w"], f"w of mirror {i}") / length, width))
        lengths.append(length)
    off = [i for i, length in enumerate(lengths) if abs(length - 1) > OFF_UNIT]
    if off:
        warnings.warn(
            f"the normals of mirrors {', '.join(map(str, off))} are not of length 1; "
            "u and w were divided by their length",
            stacklevel=4,
        )
    return tuple(made)


def plane_mirror(normal: Array, offset: float, width: float = 0.0) -> Mirror:
    """The mirror u . x = w of Euclidean space, u of length 1."""
    return Mirror(np.array([*normal, -offset, 0.0]), np.array([*normal, 0.0]), width)


def _map(level: int, matrix: Any) -> moebius.Map:
    try:
        numbers = np.asarray(matrix, dtype=np.float64)
    except (TypeError, ValueError):
        numbers = np.empty(0)
    try:
        return moebius.Map(numbers)
    except ValueError as error:
        raise ValueError(f"G of level {level}: {error}") from None


def clipping_in_words(sequence: KernelSequence | MoebiusSequence, *, lost: bool = False) -> list[str]:
    """What mirrors clip, in sentences: kernels that reach beyond the mirror that follows them, and by
    how much, with `lost` only those that are less for it; and kernels of which the mirrors leave
    nothing.
    """
    sentences = [
        f"nothing is left of kernel {i}: all of it is beyond mirror {j}; turn its normal round, or move it"
        for i, j in sequence.vanished()
    ]
    gone = {i for i, _ in sequence.vanished()}
    clipped = [(i, by) for i, by in sequence.clipped(lost=lost) if i not in gone]
    told = [f"{i} ({'without bound' if np.isinf(by) else f'by {by:.3g}'})" for i, by in clipped]
    if len(told) > _MOST_TOLD:
        told[_MOST_TOLD - 1 :] = [f"and {len(told) - _MOST_TOLD + 1} more"]
    if told:
        who = f"kernel {told[0]} reaches" if len(told) == 1 else f"kernels {', '.join(told)} reach"
        whose = "it" if len(told) == 1 else "them"
        sentences.append(f"{who} beyond the mirror that follows {whose}; what is there is clipped")
    return sentences
