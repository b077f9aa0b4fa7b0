"""Draw the intensity of a light over its tangent space: figures 33, 36, 45 and 57 of the paper, and Sol.

    python docs/examples/intensity.py -o intensity.png
    python docs/examples/intensity.py --geometry nil --radius 30 -o nil.png

Needs matplotlib: pip install -e '.[plot]'. docs/intensity.md says what is to be seen.
"""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import Circle
from numpy.typing import NDArray

import thurston_cl as tc

Vector = tuple[float, float, float]
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
DIAGONAL = (0.5**0.5, 0.5**0.5, 0.0)


@dataclass(frozen=True)
class Panel:
    """A plane through the light: spanned by `across` and `up`, which are orthonormal."""

    geometry: str
    title: str
    subtitle: str
    across: Vector = X
    up: Vector = Z  # the fiber, where there is one, and then the axis of rotation


PANELS: tuple[Panel, ...] = (
    Panel("e3", "Euclidean space", "1 / r²"),
    Panel("s3", "Three-sphere", "infinite at r = π, 2π, 3π"),
    Panel("h3", "Hyperbolic space", "1 / sinh² r"),
    Panel("s2xe", "S² × E", "E upwards; infinite at π, 2π, 3π from it"),
    Panel("h2xe", "H² × E", "E upwards"),
    Panel("nil", "Nil", "fiber upwards; infinite from 2π on"),
    Panel("sl2", "Universal cover of SL(2, R)", "fiber upwards; infinite from 2π on"),
    Panel("sol", "Sol, a hyperbolic plane", "z upwards, y = 0"),
    Panel("sol", "Sol, between two of them", "z upwards, x = y", across=DIAGONAL),
)
# Sol has no axis of rotation, by which one plane could tell all.
MORE_PANELS = (Panel("sol", "Sol, the horizontal plane", "x to the right, y upwards", up=Y),)

# The same colors in all pictures, from dark blue to yellow; what is less or more has those of the ends.
NORM = LogNorm(1e-4, 1e2)
COLORS = LinearSegmentedColormap.from_list(
    "intensity", ["#0a0f3c", "#15327a", "#1c6390", "#2f9589", "#86bf62", "#e9dd52", "#fffbd0"], 512
)


def intensity(panel: Panel, radius: float = 10, pixels: int = 600) -> NDArray[np.float64]:
    """I(r, u) = 1 / A(r, u) at the middles of the pixels of a square of 2 `radius`: (pixels, pixels).

    The first row is at the bottom. `pixels` is even, so that the light itself is in no middle. Infinite where
    a middle is conjugate to the light.
    """
    if pixels % 2:
        raise ValueError(f"pixels is {pixels}; expected an even number")
    middles = radius * ((np.arange(pixels) + 0.5) * 2 / pixels - 1)
    row, column = middles[np.newaxis, :, np.newaxis], middles[:, np.newaxis, np.newaxis]
    vectors = row * np.array(panel.across) + column * np.array(panel.up)
    lengths = np.linalg.norm(vectors, axis=2)
    directions = vectors / lengths[..., np.newaxis]
    area = tc.Geometry(panel.geometry).area_density(directions.reshape(-1, 3), lengths.ravel())
    with np.errstate(divide="ignore"):
        return 1 / area.reshape(pixels, pixels)


def draw(panels: Sequence[Panel], radius: float = 10, pixels: int = 600) -> Figure:
    """One disc for each panel, three in a row, and the scale of the colors below them."""
    columns = min(3, len(panels))
    rows = -(-len(panels) // columns)
    figure = Figure(figsize=(3.3 * columns, 4.05 * rows + 1), layout=ConstrainedLayoutEngine(h_pad=0.12))
    axes = figure.subplots(rows, columns, squeeze=False)
    for place in axes.flat:
        place.set(xticks=[], yticks=[], frame_on=False)
    for place, panel in zip(axes.flat, panels, strict=False):
        _draw_panel(place, panel, radius, pixels)
    scale = figure.colorbar(
        ScalarMappable(NORM, COLORS),
        ax=axes,
        location="bottom",
        extend="both",
        fraction=0.02,
        aspect=50,
        shrink=0.7,
    )
    scale.set_label(f"intensity 1 / A(r, u)\nin a ball of radius {radius:g} of the tangent space")
    scale.outline.set_visible(False)
    scale.minorticks_off()
    return figure


def _draw_panel(axes: Axes, panel: Panel, radius: float, pixels: int) -> None:
    values = intensity(panel, radius, pixels)
    square = (-radius, radius, -radius, radius)
    disc = axes.imshow(values, norm=NORM, cmap=COLORS, origin="lower", extent=square)
    disc.set_clip_path(Circle((0, 0), radius, transform=axes.transData))
    axes.set_title(panel.title, fontsize=12)
    axes.set_xlabel(panel.subtitle, fontsize=9, color="0.4", labelpad=6)


def main() -> None:
    known = sorted({panel.geometry for panel in PANELS})
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-o", "--output", required=True, metavar="FILE.png")
    parser.add_argument("--geometry", nargs="+", choices=known, help="these only; all planes of sol")
    parser.add_argument("--radius", type=float, default=10)
    parser.add_argument("--pixels", type=int, default=600, help="of one disc, both ways")
    given = parser.parse_args()
    panels = PANELS
    if given.geometry:
        panels = tuple(panel for panel in PANELS + MORE_PANELS if panel.geometry in given.geometry)
    draw(panels, given.radius, given.pixels).savefig(given.output, dpi=100)


if __name__ == "__main__":
    main()
