"""Hyperbolic manifolds and orbifolds (h3) from regular polyhedra about the origin, paper 7.3, figure 32.

A regular polyhedron whose faces are at distance d from the origin has its dihedral angle theta from the
product of two neighbouring outward normals u, v: -cos theta = cosh(d)^2 u.v - sinh(d)^2. Opposite faces are
glued by a translation along their common axis through 2d followed by a turn about it.
"""

import numpy as np

from thurston_cl.lattice.dirichlet import dirichlet
from thurston_cl.lattice.domain import Lattice
from thurston_cl.lattice.forms import Array

GOLDEN = (1.0 + np.sqrt(5.0)) / 2.0
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def screw(axis: tuple[float, ...], sinh_squared: float, cosine: float, sine: float) -> Array:
    """Translation (4,4) along a unit axis by 2d, given sinh(d)^2, and a right-handed turn about it."""
    u = np.array(axis)
    c = 1.0 + 2.0 * sinh_squared
    s = 2.0 * np.sqrt(sinh_squared * (1.0 + sinh_squared))
    cross = np.array([[0.0, -u[2], u[1]], [u[2], 0.0, -u[0]], [-u[1], u[0], 0.0]])
    along = np.outer(u, u)
    m = np.zeros((4, 4))
    m[:3, :3] = c * along + cosine * (np.eye(3) - along) + sine * cross
    m[:3, 3] = m[3, :3] = s * u
    m[3, 3] = c
    return m


def sinh_squared_of_dihedral(cosine: float, neighbours: float) -> float:
    """sinh(d)^2 from the cosine of the dihedral angles and the product u.v of neighbouring normals."""
    return float((neighbours + cosine) / (1.0 - neighbours))


def seifert_weber() -> Lattice:
    """Seifert-Weber space: dodecahedron with dihedral angles 2 pi/5, opposite faces glued by 3/10 of a turn.

    Closed manifold of volume 11.199, first homology Z5^3. Paper figure 32a; Weber and Seifert 1933.
    """
    cos_72, sin_72 = (np.sqrt(5.0) - 1.0) / 4.0, np.sqrt(10.0 + 2.0 * np.sqrt(5.0)) / 4.0
    square = sinh_squared_of_dihedral(cos_72, 1.0 / np.sqrt(5.0))
    # 3/10 of a turn is 108 degrees = 180 - 72.
    long, short = GOLDEN / np.sqrt(GOLDEN + 2.0), 1.0 / np.sqrt(GOLDEN + 2.0)
    axes = [(long, short, 0.0), (long, -short, 0.0), (0.0, long, short), (0.0, long, -short)]
    axes += [(short, 0.0, long), (-short, 0.0, long)]
    return dirichlet(
        "seifert-weber",
        "h3",
        [screw(axis, square, -cos_72, sin_72) for axis in axes],
        "dodecahedron with dihedral angles 2 pi/5, opposite faces glued with 3/10 of a turn; volume 11.199",
        "paper figure 32a; Weber, Seifert: Die beiden Dodekaederraeume (1933)",
    )


def ideal_cube() -> Lattice:
    """Ideal cube with dihedral angles pi/3, opposite faces glued by a quarter turn.

    Orbifold of finite volume, with cone angle pi along the edges and cusps at the vertices; S3/Q8 minus the
    vertices as a manifold. Paper figure 32b.
    """
    square = sinh_squared_of_dihedral(0.5, 0.0)
    return dirichlet(
        "ideal-cube",
        "h3",
        [screw(axis, square, 0.0, 1.0) for axis in AXES],
        "ideal cube with dihedral angles pi/3, opposite faces glued with a quarter turn; cone angle pi",
        "paper figure 32b",
    )


def hyperideal_cube() -> Lattice:
    """Hyperideal cube with dihedral angles pi/4, opposite faces glued by translations.

    Orbifold of infinite volume, with cone angle pi along the edges; the three-torus minus a ball about the
    vertex as a manifold. Paper figure 32c; Nelson and Segerman, "Visualizing hyperbolic honeycombs", 2017,
    6.1.
    """
    square = sinh_squared_of_dihedral(np.sqrt(0.5), 0.0)
    return dirichlet(
        "hyperideal-cube",
        "h3",
        [screw(axis, square, 1.0, 0.0) for axis in AXES],
        "hyperideal cube with dihedral angles pi/4, opposite faces glued by translations; cone angle pi",
        "paper figure 32c; Nelson, Segerman: Visualizing hyperbolic honeycombs (2017)",
    )


MANIFOLDS = {"seifert-weber": seifert_weber, "ideal-cube": ideal_cube, "hyperideal-cube": hyperideal_cube}
ALIASES = {
    "seifert-weber-space": "seifert-weber",
    "seifert-weber-dodecahedral-space": "seifert-weber",
    "weber-seifert": "seifert-weber",
    "ideal-cube-orbifold": "ideal-cube",
    "hyperideal-cube-orbifold": "hyperideal-cube",
}
