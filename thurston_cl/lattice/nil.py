"""Nil manifolds: circle bundles over flat surfaces and orbifolds (paper 9.9; Scott, "The geometries of
3-manifolds", 1983, section 4).

Translations A and B commute up to the area they span: ABA^-1B^-1 is the shift along the fibre by that area.
Where it is n times the fibre's length, the bundle over the torus has the Euler number n, and it is the torus
bundle over the circle with monodromy [[1,n],[0,1]]. Points are led back by A and B over the sides, then along
the fibre.
"""

import numpy as np

from thurston_cl.lattice.domain import Lattice
from thurston_cl.lattice.forms import Array
from thurston_cl.lattice.isometry import compose, inverse, stabilizer, translation
from thurston_cl.lattice.prism import pair, prism

AUTHORS = "the paper's own code"


def step(x: float, y: float, z: float = 0.0) -> Array:
    """Left translation (4,4) by [x,y,z]."""
    return translation("nil", np.array([x, y, z, 1.0]))


def heisenberg() -> Lattice:
    """Integer Heisenberg group: the torus bundle whose monodromy is the Dehn twist [[1,1],[0,1]].

    A = [1,0,0], B = [0,1,0], ABA^-1B^-1 = C = [0,0,1]; unit cube. Paper 9.9, figures 41, 50 and 51.
    """
    return prism(
        "heisenberg",
        "nil",
        [*pair((1, 0, -0.5), step(-1, 0), "nil"), *pair((0, 1, -0.5), step(0, -1), "nil")],
        1.0,
        "unit cube; integer Heisenberg group, the torus bundle of a Dehn twist",
        f"paper 9.9, figure 51; {AUTHORS}, heisenberg",
    )


def double_twist() -> Lattice:
    """The torus bundle whose monodromy is a double Dehn twist [[1,2],[0,1]]: Euler number 2.

    A = [1,0,0], B = [0,1,0] and the fibre's shift by 1/2, scaled by sqrt(2) along x, y, so by 2 along z: a
    square of the side sqrt(2) times the unit interval. The integer Heisenberg group, scaled so, is a subgroup
    of index two.
    """
    side = float(np.sqrt(2.0))
    return prism(
        "double-twist",
        "nil",
        [*pair((1, 0, -side / 2), step(-side, 0), "nil"), *pair((0, 1, -side / 2), step(0, -side), "nil")],
        1.0,
        "square of the side sqrt(2) times the unit interval; the torus bundle of a double Dehn twist",
        "Scott: The geometries of 3-manifolds (1983)",
    )


def hexagonal() -> Lattice:
    """The integer Heisenberg group over a hexagonal torus: A = [1,0,0], B = [1/2,sqrt(3)/2,0], ABA^-1B^-1 the
    shift by sqrt(3)/2.

    Regular hexagon of the width 1 times an interval. It is isomorphic to `heisenberg`, with another shape.
    """
    high = float(np.sqrt(0.75))
    sides: list[tuple[Array, Array]] = []
    for x, y in ((1.0, 0.0), (0.5, high), (-0.5, high)):
        # The third generator A^-1 B has the shift of that product.
        shift = high / 2.0 if x < 0 else 0.0
        sides += pair((x, y, -0.5), inverse("nil", step(x, y, -shift)), "nil")
    return prism(
        "hexagonal",
        "nil",
        sides,
        high,
        "regular hexagon of width 1 times an interval of length sqrt(3)/2; Heisenberg group",
        "Scott: The geometries of 3-manifolds (1983)",
    )


def half_turn() -> Lattice:
    """Circle bundle over the sphere with four cone points of angle pi: screw motions with half-turns about
    the fibres over [+-1/2,0] through 1, and the translation by [0,2,0].

    The domain is [-1/2,1/2] x [-1,1] x [-1,1]. Each screw's square is the shift by 2 and nothing has fixed
    points: it is a manifold with four short fibres, doubly covered by `double-twist`, scaled by sqrt(2).
    """
    turn = stabilizer("nil", np.diag([-1.0, -1.0, 1.0]))

    def screw(x: float, height: float) -> Array:
        there = compose("nil", step(x, 0, height), turn)
        return compose("nil", there, step(-x, 0))

    # The product of both screws is the translation by [2,0,0], so that they lead the same way round.
    sides = [((1, 0, -0.5), screw(0.5, 1.0)), ((-1, 0, -0.5), screw(-0.5, 1.0))]
    return prism(
        "half-turn",
        "nil",
        [*sides, *pair((0, 1, -1), step(0, -2), "nil")],
        2.0,
        "box of 1 x 2 x 2; screw motions with half-turns about two of its vertical faces' middles",
        "Scott: The geometries of 3-manifolds (1983)",
    )


MANIFOLDS = {
    "heisenberg": heisenberg,
    "double-twist": double_twist,
    "hexagonal": hexagonal,
    "half-turn": half_turn,
}
ALIASES = {
    "integer-heisenberg": "heisenberg",
    "heisenberg-1": "heisenberg",
    "dehn-twist": "heisenberg",
    "torus-bundle": "heisenberg",
    "basic-heisenberg": "heisenberg",
    "extended-heisenberg": "heisenberg",
    "heisenberg-2": "double-twist",
    "hexagonal-heisenberg": "hexagonal",
}
