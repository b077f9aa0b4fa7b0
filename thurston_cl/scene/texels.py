"""The images of a scene as the one buffer of texels that kernels/pattern/image.h reads."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thurston_cl.scene import schema
from thurston_cl.scene.image_file import ImageFile
from thurston_cl.scene.parse import Location

Array = NDArray[np.float32]

# Places of texels are split into two numbers that single precision holds.
TEXEL_PAGE = 65536
# Of an image with 16384 pixels on a side. Each has room for so many, so that scenes share their program.
MOST_LEVELS = 15


def halved(pixels: Array, axis: int) -> Array:
    """Pixels resampled to half their number along an axis, rounded down from 2, by an exact box filter.

    Of 2m + 1 pixels each of the m new ones covers 2 + 1/m; a constant stays what it is to the last digit.
    """
    count = pixels.shape[axis]
    if count == 1:
        return pixels
    new = count // 2

    def taken(first: int) -> Array:
        return pixels.take(np.arange(first, first + 2 * new, 2), axis)

    if count % 2 == 0:
        return np.float32(0.5) * (taken(0) + taken(1))
    shape = [1] * pixels.ndim
    shape[axis] = new
    before = (np.arange(new, 0, -1, dtype=np.float32) / np.float32(count)).reshape(shape)
    after = before[::-1] if axis == 0 else before[:, ::-1]
    middle = taken(1)
    return middle + before * (taken(0) - middle) + after * (taken(2) - middle)


def pyramid(pixels: Array) -> list[Array]:
    """An image (H,W,3) and its halvings down to a single texel."""
    levels = [pixels]
    while max(levels[-1].shape[:2]) > 1:
        levels.append(halved(halved(levels[-1], 0), 1))
    return levels


@dataclass
class Texels:
    """Collects images, each file once."""

    _levels: list[Array] = field(default_factory=list)
    _places: dict[Path, list[float]] = field(default_factory=dict)
    _count: int = 0
    # The SHA-256 of each file, by the name that the scene has for it.
    digests: dict[str, str] = field(default_factory=dict)

    def add(self, file: ImageFile) -> list[float]:
        """For each level of an image, largest first, its place in pages and beyond, its width and height."""
        from thurston_cl.image import read_texture

        path = file.path.resolve()
        self.digests[file.written] = hashlib.sha256(path.read_bytes()).hexdigest()
        if path not in self._places:
            self._places[path] = places = []
            for level in pyramid(read_texture(path)):
                height, width = level.shape[:2]
                places += [self._count // TEXEL_PAGE, self._count % TEXEL_PAGE, width, height]
                self._levels.append(level)
                self._count += width * height
        return self._places[path]

    def buffer(self) -> Array:
        """All texels, red, green, blue. One number where there is no image: no buffer may be empty."""
        if not self._levels:
            return np.zeros(1, np.float32)
        return np.concatenate([level.ravel() for level in self._levels])


def images_of(scene: schema.Scene) -> Iterator[tuple[Location, schema.ImageTexture]]:
    """The images that objects of a scene wear, each with the place where it is named."""
    named = [(("textures", name), pattern) for name, pattern in scene.textures.items()]
    paints: list[tuple[Location, object]] = [
        *named,
        *((("materials", name, "color"), material.color) for name, material in scene.materials.items()),
        *(
            (("objects", k, "material", "color"), solid.material.color)
            for k, solid in enumerate(scene.objects)
        ),
    ]
    for location, paint in paints:
        yield from _images_in(location, paint)


def _images_in(location: Location, paint: object) -> Iterator[tuple[Location, schema.ImageTexture]]:
    """The images of a paint, and of the paints inside it."""
    if not isinstance(paint, schema.Pattern):
        return
    if paint.image is not None:
        yield (*location, "image", "file"), paint.image
    if paint.triplanar is not None and paint.triplanar.image is not None:
        yield (*location, "triplanar", "image", "file"), paint.triplanar.image
    if paint.slope is not None:
        yield from _images_in((*location, "slope", "flat"), paint.slope.flat)
        yield from _images_in((*location, "slope", "steep"), paint.slope.steep)
