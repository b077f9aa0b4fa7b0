"""Draw the contact sheets docs/gallery.jpg and docs/sequences.jpg: scenes of the library, three in a row.

    python docs/examples/gallery.py -o docs/gallery.jpg
    python docs/examples/gallery.py --sequences -o docs/sequences.jpg

The first run compiles a program for each scene, which takes some minutes.
"""

import argparse

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

import thurston_cl as tc
from thurston_cl.image import to_srgb

SCENES = (
    "e3/ball-over-plane-soft",
    "s3/one-light",
    "h3/mirrors-twice",
    "h3/seifert-weber-panorama",
    "s2xe/floors-with-wells",
    "h2xe/holed-slab",
    "nil/sunset",
    "nil/four-lamps-far",
    "nil/globes",
    "sl2/genus-two-globes",
    "sol/one-light",
    "sol/mirrored-corner",
)
# Kernel-reflection sequences.
SEQUENCES = (
    "e3/tree-twisted",
    "e3/grove",
    "e3/forest-inside",
    "e3/reef",
    "e3/fish-school",
    "e3/terrain",
    "e3/palm-leaf",
    "h3/forest",
    "e3/sponge",
)
COLUMNS = 3
WIDTH, HEIGHT = 320, 180
GAP = 4  # pixels of black between pictures


def picture(name: str, samples: int) -> NDArray[np.uint8]:
    """A library scene as a screen shows it: (HEIGHT, WIDTH, 3). Of a panorama the middle is kept."""
    scene = tc.load_scene(name)
    panorama = scene.camera.projection.kind == "equirectangular"
    size = (2 * HEIGHT, HEIGHT) if panorama else (WIDTH, HEIGHT)
    pixels = to_srgb(tc.render(scene, size=size, samples=samples).channels["beauty"])
    left = (size[0] - WIDTH) // 2
    return pixels[:, left : left + WIDTH]


def sheet(pictures: list[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Pictures of one size in rows of COLUMNS, with black between them."""
    rows = -(-len(pictures) // COLUMNS)
    whole = np.zeros((rows * (HEIGHT + GAP) - GAP, COLUMNS * (WIDTH + GAP) - GAP, 3), np.uint8)
    for k, pixels in enumerate(pictures):
        top, left = k // COLUMNS * (HEIGHT + GAP), k % COLUMNS * (WIDTH + GAP)
        whole[top : top + HEIGHT, left : left + WIDTH] = pixels
    return whole


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-o", "--output", required=True, metavar="FILE.jpg")
    parser.add_argument("--samples", type=int, default=16, help="rays for each pixel")
    parser.add_argument("--sequences", action="store_true", help="of kernel-reflection sequences")
    given = parser.parse_args()
    names = SEQUENCES if given.sequences else SCENES
    pixels = sheet([picture(name, given.samples) for name in names])
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "uint8")
    spec.attribute("compression", "jpeg:88")
    spec.attribute("jpeg:subsampling", "4:4:4")
    file = oiio.ImageOutput.create(given.output)
    if file is None or not (file.open(given.output, spec) and file.write_image(pixels) and file.close()):
        raise SystemExit(f"cannot write {given.output}: {oiio.geterror()}")


if __name__ == "__main__":
    main()
