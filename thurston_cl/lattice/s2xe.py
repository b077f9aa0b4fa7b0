"""S2 x E: quotients of the sphere, manifolds and orbifolds, times a circle (paper 8; Scott, "The geometries
of 3-manifolds", 1983, section 4).

Groups of rotations that carry each of the equal faces of a solid to every other in one way have a face as
their domain, here that about o = e_z.
"""

import numpy as np

from thurston_cl.lattice.domain import Lattice
from thurston_cl.lattice.forms import Array, bisector
from thurston_cl.lattice.polygon import Polygon
from thurston_cl.lattice.prism import prism

AUTHORS = "the paper's own code"
GOLDEN = (1.0 + np.sqrt(5.0)) / 2.0


def rotation(matrix: Array) -> Array:
    """The isometry (5,5) that is this one (3,3) on the sphere and leaves the line alone."""
    m = np.eye(5)
    m[:3, :3] = matrix
    return m


def faces(group: list[Array]) -> list[tuple[Array, Array]]:
    """Sides and maps of the Dirichlet polygon about o, counterclockwise from the x axis, of a finite group by
    its rotations (3,3) but the identity, none of which keeps o.
    """
    images = [g[:, 2] for g in group]
    walls = np.array([bisector("s3", [x, y, 0.0, z]) for x, y, z in images])
    turn = np.arctan2(walls[:, 1], walls[:, 0]) % (2.0 * np.pi)
    chosen = sorted(Polygon("s3", walls).bounding, key=lambda f: float(np.round(turn[f], 9)))
    return [(walls[f][[0, 1, 3]], rotation(group[f].T)) for f in chosen]


def even_permutations() -> list[Array]:
    """The three rotations (3,3) about [1,1,1] that permute the axes."""
    return [np.roll(np.eye(3), k, axis=0) for k in range(3)]


def hopf_manifold() -> Lattice:
    """S2 x S1: the sphere times a circle of length 1.5, the length in the paper's own code. Paper figure
    38.
    """
    return prism(
        "hopf-manifold", "s2xe", [], 1.5, "sphere times an interval of length 1.5", f"{AUTHORS}, zLoop"
    )


def lunes() -> Lattice:
    """Football S2(4,4) times a circle of length pi/2: quarter turns of the sphere about its x axis.

    The domain is a lune with corners at [+-1,0,0], a quarter of the sphere, times an interval. In the paper's
    own code this is the torus grouping, with a longitude and the fibre as its directions.
    """
    turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    return prism(
        "lunes",
        "s2xe",
        [((0, 1, -1), rotation(turn.T)), ((0, -1, -1), rotation(turn))],
        np.pi / 2,
        "lune of a right angle times an interval; cone angle pi/2 at both corners",
        f"{AUTHORS}, torus",
    )


def cube() -> Lattice:
    """S2(2,2,3) times a circle of length pi/2: cells are the six faces of a cube times an interval.

    The six rotations about [1,1,1] and half-turns about axes across it carry each face to every other in one
    way. (Quarter turns over the sides, as in the paper's own code, generate a group of 24, which turns the
    face in itself.) Half-turns and thirds of a turn about corners and middles of edges are cone points.
    """
    swap = np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    group = [s @ r for s in (np.eye(3), swap) for r in even_permutations()]
    return prism(
        "cube",
        "s2xe",
        faces(group[1:]),
        np.pi / 2,
        "face of a cube times an interval; the rotations of a triangular prism",
        f"{AUTHORS}, cube, with a group that keeps no face",
    )


def dodecahedron() -> Lattice:
    """S2(2,3,3) times a circle: cells are the twelve faces of a dodecahedron times an interval.

    The rotations of a tetrahedron carry each face to every other in one way. The interval is as long as two
    neighbouring centres are apart on the sphere, atan(2) = 1.107. Centres of cells are the icosahedron's
    vertices of paper figure 35.
    """
    signs = [np.diag([x, y, x * y]) for x in (1.0, -1.0) for y in (1.0, -1.0)]
    # Turned about the x axis so that the vertex [0,1,phi] of an icosahedron comes to e_z.
    long, short = GOLDEN / np.sqrt(GOLDEN + 2.0), 1.0 / np.sqrt(GOLDEN + 2.0)
    up = np.array([[1.0, 0.0, 0.0], [0.0, long, -short], [0.0, short, long]])
    group = [up @ s @ r @ up.T for s in signs for r in even_permutations()]
    return prism(
        "dodecahedron",
        "s2xe",
        faces(group[1:]),
        float(np.arctan(2.0)),
        "face of a dodecahedron times an interval; the rotations of a tetrahedron",
        "paper figures 35 and 38",
    )


MANIFOLDS = {"hopf-manifold": hopf_manifold, "lunes": lunes, "cube": cube, "dodecahedron": dodecahedron}
ALIASES = {
    "s2xs1": "hopf-manifold",
    "s2-x-s1": "hopf-manifold",
    "hopf": "hopf-manifold",
    "z-loop": "hopf-manifold",
    "zloop": "hopf-manifold",
    "torus": "lunes",
    "football": "lunes",
}
