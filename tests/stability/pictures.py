"""What the tests of pictures share: scenes as text, and how two pictures differ."""

import re
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

import thurston_cl as tc
from thurston_cl.image import Image
from thurston_cl.program import kernel_text
from thurston_cl.scene import load_text

Array = NDArray[np.float64]
PRECISIONS = ("single", "double")


def picture(text: str, **settings: Any) -> Image:
    """A picture of a scene text, small and by one lane unless the settings say otherwise. What the text draws
    may be nothing, on purpose: remarks about that are not of interest here.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return tc.render(load_text(text), **{"size": (48, 32), "samples": 1, "lanes": 1} | settings)


def share(pixels: Any) -> float:
    """The part of the pixels that are set."""
    return float(np.count_nonzero(pixels)) / np.size(pixels)


def differing(one: Image, other: Image, channel: str = "object") -> float:
    """The share of pixels whose number in a channel differs."""
    return share(one.channels[channel] != other.channels[channel])


def check_finite(image: Image) -> None:
    """No pixel without a number, in any channel; only depth may be infinite, and only where nothing is."""
    assert image.statistics["nan"] == 0
    for name, values in image.channels.items():
        if name == "depth":
            assert not np.isnan(values).any()
            assert (np.isinf(values) == (image.channels["object"] == 0)).all()
        else:
            assert np.isfinite(values).all(), name


def stated(part: str, row: str, precision: str) -> float:
    """The accuracy that the head of a file of kernels/ states in the row that begins so: the first number
    with an exponent is that of single precision, the second of double.
    """
    found = re.search(rf"^// *{re.escape(row)}(.*)$", kernel_text(part), re.MULTILINE)
    assert found is not None, f"{part} has no row {row!r}"
    numbers = re.findall(r"\d(?:\.\d+)?e-\d+", found[1])
    assert len(numbers) >= 2, found[0]
    return float(numbers[PRECISIONS.index(precision)])
