"""H2 x E: hyperbolic surfaces and orbifolds times a circle (paper 8, figure 39; Scott, "The geometries of
3-manifolds", 1983, section 4).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from thurston_cl.lattice import sl2
from thurston_cl.lattice.domain import Lattice
from thurston_cl.lattice.forms import Array
from thurston_cl.lattice.isometry import translation
from thurston_cl.lattice.prism import pair, prism

AUTHORS = "the paper's own code"


def square(sinh_squared: float) -> Sequence[tuple[ArrayLike, Array]]:
    """Sides and maps of a square whose sides are at the distance d from o; opposite ones are glued by
    translations.

    cos of its corners' angle is sinh(d)^2.
    """
    sinh, cosh = np.sqrt(sinh_squared), np.sqrt(1.0 + sinh_squared)
    # Over twice the distance, backwards.
    far, up = -2.0 * sinh * cosh, 1.0 + 2.0 * sinh_squared
    along_x = translation("h2xe", np.array([far, 0.0, up, 0.0]))
    along_y = translation("h2xe", np.array([0.0, far, up, 0.0]))
    return [*pair((cosh, 0, -sinh), along_x, "h2xe"), *pair((0, cosh, -sinh), along_y, "h2xe")]


def orbi_torus() -> Lattice:
    """Torus with a cone point of angle pi, times a circle. Paper figure 39.

    Square with angles pi/4, opposite sides glued by translations; its corners make the cone point. The
    interval is as high as the square is wide, 2 asinh(2^(-1/4)) = 1.528.
    """
    sinh_squared = np.sqrt(0.5)
    return prism(
        "orbi-torus",
        "h2xe",
        square(sinh_squared),
        float(2.0 * np.arcsinh(np.sqrt(sinh_squared))),
        "square with angles pi/4 times an interval, opposite faces glued by translations; cone angle pi",
        f"paper figure 39; {AUTHORS}, orbiTorus",
    )


def cusped_torus() -> Lattice:
    """Once-punctured torus times a circle of length 2: of finite volume, with a cusp.

    Ideal square, opposite sides glued by translations; its corners make the puncture.
    """
    return prism(
        "cusped-torus",
        "h2xe",
        square(1.0),
        2.0,
        "ideal square times an interval, opposite faces glued by translations",
        f"{AUTHORS}, cuspedTorus",
    )


def genus_two() -> Lattice:
    """Genus two surface times a circle.

    The regular octagon with angles pi/4 and the gluing of sl2's `genus-two`: sides a b a^-1 b^-1 c d c^-1
    d^-1. The interval is as high as the octagon is wide between opposite sides, 3.057.
    """
    sides = [(covector, flat(back)) for covector, back in sl2.octagon()]
    return prism(
        "genus-two",
        "h2xe",
        sides,
        float(2.0 * np.arctanh(sl2.OCTAGON_WIDTH)),
        "regular octagon with angles pi/4 times an interval",
        f"paper 10.9, figure 58; {AUTHORS}, genus2",
    )


def flat(isometry: Array) -> Array:
    """The isometry (5,5) of sl2's base, without what it does to the fibre."""
    m = np.eye(5)
    m[:3, :3] = isometry[:3, :3]
    return m


MANIFOLDS = {"orbi-torus": orbi_torus, "cusped-torus": cusped_torus, "genus-two": genus_two}
ALIASES = {
    "orbitorus": "orbi-torus",
    "orbi-torus-x-circle": "orbi-torus",
    "cuspedtorus": "cusped-torus",
    "punctured-torus": "cusped-torus",
    "genus2": "genus-two",
    "genus-2": "genus-two",
    "genus-two-x-circle": "genus-two",
}
