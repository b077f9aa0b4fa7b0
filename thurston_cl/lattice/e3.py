"""Euclidean space forms (e3): five of the flat manifolds, with unit translations.

Names after Conway and Rossetti, "Describing the platycosms", arXiv:math/0311476, are in the docstrings; the
groups are those of Wolf, "Spaces of constant curvature", theorems 3.5.5 and 3.5.9, and belong to paper 7.1.
"""

import numpy as np

from thurston_cl.lattice.dirichlet import dirichlet
from thurston_cl.lattice.domain import Lattice
from thurston_cl.lattice.forms import Array

PLATYCOSMS = "Conway, Rossetti: Describing the platycosms (2003)"


def motion(rows: tuple[tuple[float, float, float], ...], shift: tuple[float, float, float]) -> Array:
    """Matrix (4,4) of p -> rows p + shift."""
    m = np.eye(4)
    m[:3, :3] = rows
    m[:3, 3] = shift
    return m


IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
SHIFT_X = motion(IDENTITY, (1.0, 0.0, 0.0))
SHIFT_Y = motion(IDENTITY, (0.0, 1.0, 0.0))
SHIFT_Z = motion(IDENTITY, (0.0, 0.0, 1.0))


def three_torus() -> Lattice:
    """Three-torus (torocosm c1): unit translations along x, y, z; unit cube. Paper figures 13, 21, 30."""
    return dirichlet(
        "three-torus",
        "e3",
        [SHIFT_X, SHIFT_Y, SHIFT_Z],
        "unit cube, opposite faces glued by translations",
        f"paper figure 30; {PLATYCOSMS}, c1",
    )


def half_turn() -> Lattice:
    """Half-turn space (dicosm c2): translations along x and y, (x,y,z) -> (-x,-y,z+1); unit cube."""
    screw = motion(((-1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 1.0))
    return dirichlet(
        "half-turn",
        "e3",
        [SHIFT_X, SHIFT_Y, screw],
        "unit cube, the z faces glued with a half turn",
        f"{PLATYCOSMS}, c2; Wolf G2",
    )


def quarter_turn() -> Lattice:
    """Quarter-turn space (tetracosm c4): translations along x and y, (x,y,z) -> (-y,x,z+1); unit cube."""
    screw = motion(((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 1.0))
    return dirichlet(
        "quarter-turn",
        "e3",
        [SHIFT_X, SHIFT_Y, screw],
        "unit cube, the z faces glued with a quarter turn",
        f"{PLATYCOSMS}, c4; Wolf G4",
    )


def hantzsche_wendt() -> Lattice:
    """Hantzsche-Wendt manifold (didicosm c22): three screw motions with half turns about skew axes.

    A(x,y,z) = (x+1, 1-y, -z), B(x,y,z) = (-x, y+1, 1-z), C(x,y,z) = (1-x, -y, z+1). Their squares translate
    by 2; the orbit of the origin is the face-centred cubic lattice, so the domain is a rhombic dodecahedron,
    of volume 2.
    """
    a = motion(((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)), (1.0, 1.0, 0.0))
    b = motion(((-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)), (0.0, 1.0, 1.0))
    c = motion(((-1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)), (1.0, 0.0, 1.0))
    return dirichlet(
        "hantzsche-wendt",
        "e3",
        [a, b, c],
        "rhombic dodecahedron, three screw motions with half turns about skew axes",
        f"Hantzsche, Wendt: Dreidimensionale euklidische Raumformen (1935); {PLATYCOSMS}, c22; Wolf G6",
    )


def klein_bottle_x_circle() -> Lattice:
    """Klein bottle times circle (first amphicosm +a1): (x,y,z) -> (x+1,-y,z), translations along y and z;
    unit cube.

    Not orientable: a traveller along x comes home mirrored.
    """
    glide = motion(((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)), (1.0, 0.0, 0.0))
    return dirichlet(
        "klein-bottle-x-circle",
        "e3",
        [glide, SHIFT_Y, SHIFT_Z],
        "unit cube, the x faces glued with a reflection in y",
        f"{PLATYCOSMS}, +a1; Wolf B1",
    )


MANIFOLDS = {
    "three-torus": three_torus,
    "half-turn": half_turn,
    "quarter-turn": quarter_turn,
    "hantzsche-wendt": hantzsche_wendt,
    "klein-bottle-x-circle": klein_bottle_x_circle,
}
ALIASES = {
    "torus": "three-torus",
    "3-torus": "three-torus",
    "t3": "three-torus",
    "half-turn-space": "half-turn",
    "quarter-turn-space": "quarter-turn",
    "hantzsche-wendt-manifold": "hantzsche-wendt",
    "didicosm": "hantzsche-wendt",
    "klein-bottle": "klein-bottle-x-circle",
    "klein-s1": "klein-bottle-x-circle",
}
