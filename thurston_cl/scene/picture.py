"""The shape of a picture: what size it has, and how the pictures of two eyes share it."""

from collections.abc import Iterator
from dataclasses import dataclass

Size = tuple[int, int]
Area = tuple[int, int, int, int]  # left, top, right, bottom in pixels

# Width and height for one eye where the scene does not say: about half a million pixels each.
DEFAULT_SIZES = {
    "perspective": (960, 540),
    "equirectangular": (1024, 512),
    "fisheye": (720, 720),
    "dome": (720, 720),
}
# How many pictures stand side by side, and over each other. In an anaglyph they lie upon each other.
GRIDS = {None: (1, 1), "anaglyph": (1, 1), "side-by-side": (2, 1), "top-bottom": (1, 2)}


@dataclass(frozen=True)
class View:
    """What one eye, 0 for the left or only one, adds to a part of a picture: the `area` of what it sees,
    which goes to column `left` and row `top` of that part, and of the colors there to `colors` only.
    """

    eye: int
    area: Area
    left: int = 0
    top: int = 0
    colors: tuple[int, ...] = (0, 1, 2)

    @property
    def all_channels(self) -> bool:
        """Whether it adds the channels beside the colors too."""
        return 0 in self.colors


def default_size(projection: str, layout: str | None) -> Size:
    """The size of a picture whose scene does not say."""
    across, down = GRIDS[layout]
    width, height = DEFAULT_SIZES[projection]
    return width * across, height * down


def eye_size(layout: str | None, size: Size) -> Size:
    """The size of what one eye sees, in a picture of `size`."""
    across, down = GRIDS[layout]
    return size[0] // across, size[1] // down


def size_problem(projection: str, layout: str | None, size: Size) -> tuple[str, str] | None:
    """Why a picture cannot have a size, and what would help."""
    across, down = GRIDS[layout]
    for side, count, name in zip(size, (across, down), ("width", "height"), strict=True):
        if side % count:
            return f"each eye has half of the {name}, and {side} is odd", f"make it {side + 1}"
    width, height = eye_size(layout, size)
    if projection == "equirectangular" and width != 2 * height:
        fitting = fitting_size(projection, layout, size)
        each = f" for each eye ({layout})" if across * down > 1 else ""
        message = f"an equirectangular picture is twice as wide as high{each}; this is {size[0]} x {size[1]}"
        return message, f"for example size: [{fitting[0]}, {fitting[1]}]"
    return None


def fitting_size(projection: str, layout: str | None, size: Size) -> Size:
    """A size near the given one that a picture can have."""
    across, down = GRIDS[layout]
    width, height = -(-size[0] // across), -(-size[1] // down)
    if projection == "equirectangular":
        width = 2 * height
    return width * across, height * down


def views(layout: str | None, size: Size, area: Area) -> Iterator[View]:
    """What the eyes add to an area of the whole picture, which has that size."""
    if layout is None:
        yield View(0, area)
    elif layout == "anaglyph":
        yield View(0, area, colors=(0,))
        yield View(1, area, colors=(1, 2))
    else:
        width, height = eye_size(layout, size)
        for eye in range(2):
            x, y = (eye * width, 0) if layout == "side-by-side" else (0, eye * height)
            left, top = max(area[0], x), max(area[1], y)
            right, bottom = min(area[2], x + width), min(area[3], y + height)
            if left < right and top < bottom:
                yield View(eye, (left - x, top - y, right - x, bottom - y), left - area[0], top - area[1])
