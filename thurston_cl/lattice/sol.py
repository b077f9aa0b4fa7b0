"""Sol manifolds: torus bundles over the circle with hyperbolic monodromy, and two open manifolds (paper 11.7;
Scott, "The geometries of 3-manifolds", 1983, section 4).

A matrix M of SL(2,Z) with |trace| > 2 stretches the plane by an eigenvalue of the size e^tau along one line
and shrinks it as much along another. With x and y along these, Z^2 is a lattice of translations A_1, A_2 that
is kept by B, the translation by tau along z, with x and y negated where the eigenvalues are:
B A_j B^-1 = A_1^M_1j A_2^M_2j. Points are led back by B over the levels, then by A_1 and A_2 over the sides.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from thurston_cl.lattice.domain import Lattice
from thurston_cl.lattice.error import LatticeError
from thurston_cl.lattice.forms import Array
from thurston_cl.lattice.isometry import compose, stabilizer, translation
from thurston_cl.lattice.suspension import GREATEST_TRACE, Suspension, suspension

SCOTT = "Scott: The geometries of 3-manifolds (1983)"
GOLDEN = float((1.0 + np.sqrt(5.0)) / 2.0)
# The area that the two translations of a bundle span in x, y, which is that of the paper's. A manifold has
# this shape in every size of it: no isometry scales x and y alike.
AREA = 1.0 / (GOLDEN + 2.0)

# Whole numbers, however large.
Whole = NDArray[np.object_]


def torus_bundle(monodromy: Sequence[Sequence[int]]) -> Suspension:
    """The torus bundle over the circle with this monodromy [[a,b],[c,d]]: whole numbers with a d - b c = 1
    and |a + d| > 2.

    Any basis of Z^2 and any level for z = 0 give the same manifold; here the parallelogram at z = 0 is as
    near to a square as single steps lead. It has the area AREA at every level, and the interval the
    length tau. Raises LatticeError: `what` is "monodromy", `index` the row to blame, from 0, if there is one.
    """
    m = _checked(monodromy)
    written = f"[[{m[0, 0]}, {m[0, 1]}], [{m[1, 0]}, {m[1, 1]}]]"
    m, basis = _near_square(m)
    large, _ = _eigenvalues(m)
    climb = translation("sol", np.array([0.0, 0.0, np.log(abs(large)), 1.0]))
    if large < 0:
        climb = compose("sol", climb, stabilizer("sol", np.diag([-1.0, -1.0, 1.0])))
    return suspension(
        f"torus bundle of {written}",
        basis.T,
        climb,
        f"parallelogram times an interval of length {climb[2, 3]:.3f}; the torus bundle of {written}",
        f"paper 11.7; {SCOTT}",
    )


def _checked(monodromy: Sequence[Sequence[int]]) -> Whole:
    """The monodromy (2,2); LatticeError where it has no bundle here."""
    try:
        rows = [[*row] for row in monodromy]
    except TypeError:
        rows = []
    if [len(row) for row in rows] != [2, 2]:
        text = "the monodromy must be two rows of two whole numbers; write [[a, b], [c, d]]"
        raise LatticeError(text, "monodromy")
    for k, row in enumerate(rows):
        if not all(isinstance(n, (int, float, np.number)) and float(n).is_integer() for n in row):
            raise LatticeError(f"row {k + 1} of the monodromy must be two whole numbers", "monodromy", k)
    m = np.array([[int(n) for n in row] for row in rows], dtype=object)
    if fault := _fault(m):
        raise LatticeError(fault, "monodromy")
    return m


def _fault(m: Whole) -> str:
    """Why a matrix of whole numbers has no bundle here; empty if it has one."""
    (a, b), (c, d) = m
    determinant, trace = a * d - b * c, a + d
    if determinant == -1:
        return (
            "the determinant of the monodromy is -1: bundles that are glued with a reflection are not "
            "supported; take its square, whose bundle covers that one twice"
        )
    if determinant != 1:
        return (
            f"the determinant of the monodromy is {determinant}, so that it maps no torus to itself one to "
            "one; choose whole numbers with a d - b c = 1"
        )
    if abs(trace) <= 2:
        geometry = "nil" if abs(trace) == 2 and (b, c) != (0, 0) else "e3"
        return (
            f"the trace of the monodromy is {trace}, so that its bundle has the geometry {geometry}; "
            "choose a + d above 2 or below -2"
        )
    if abs(trace) > GREATEST_TRACE:
        return (
            f"the trace of the monodromy is {trace}: about as many cells meet over a level, which are too "
            f"many; choose a + d from -{GREATEST_TRACE} to {GREATEST_TRACE}"
        )
    return ""


def _eigenvalues(m: Whole) -> tuple[float, float]:
    """The large and the small one."""
    trace = float(m[0, 0] + m[1, 1])
    large = 0.5 * (trace + np.copysign(np.sqrt((trace - 2.0) * (trace + 2.0)), trace))
    return float(large), float(1.0 / large)


def _coordinates(m: Whole) -> Array:
    """The basis of Z^2 in x and y, as columns: the rows are the left eigenvectors of M, here equally long."""
    rows = []
    for other in reversed(_eigenvalues(m)):
        # Both rows of M - other are multiples of the vector; the longer one has more digits.
        row = max(m.astype(np.float64) - other * np.eye(2), key=lambda row: float(np.linalg.norm(row)))
        rows.append(row / np.linalg.norm(row))
    area = np.linalg.det(rows)
    return np.sqrt(AREA / abs(area)) * np.array([rows[0], np.sign(area) * rows[1]])


def _near_square(m: Whole) -> tuple[Whole, Array]:
    """The matrix in another basis of Z^2, and that basis in x, y (as columns).

    The less the sum of the squares of its two vectors, the nearer they are to a square. Rows equally long
    make it least over all levels; then a multiple of one vector is taken from the other, while that helps.
    """
    while True:
        basis = _coordinates(m)
        gram = basis.T @ basis
        multiples = [round(gram[0, 1] / gram[k, k]) for k in (0, 1)]
        if multiples == [0, 0]:
            return m, basis
        k = 0 if multiples[0] else 1
        change, back = np.array([[[1, 0], [0, 1]]] * 2, dtype=object)
        change[k, 1 - k], back[k, 1 - k] = -multiples[k], multiples[k]
        m = back @ m @ change


def anosov() -> Lattice:
    """The torus bundle of Arnold's cat map [[2,1],[1,1]], in the paper's coordinates.

    With the golden ratio phi: tau = 2 ln phi, a_1 = [phi,-1]/(phi + 2), a_2 = [1,phi]/(phi + 2). The square
    that they span times an interval; volume 2 ln phi/(phi + 2) = 0.266. Paper 11.7, figure 67.
    """
    return replace(
        torus_bundle([[2, 1], [1, 1]]),
        name="anosov",
        description="square of side 0.526 times an interval of length 0.962; the torus bundle of the cat map",
        source="paper 11.7, figure 67; the paper's own code, mappingTorus",
    )


def xy_loops() -> Lattice:
    """Translations by 1 along x and along y alone, over all z: a torus times a line, which becomes long and
    thin upwards and downwards.
    """
    return suspension(
        "xy-loops",
        np.eye(2),
        None,
        "unit square times all z, opposite sides glued by translations",
        "the paper's own code, xyLoops",
    )


def z_loop() -> Lattice:
    """A translation along z alone: the plane times an interval of the length 2 ln phi. It covers `anosov`."""
    height = 2.0 * float(np.log(GOLDEN))
    return suspension(
        "z-loop",
        (),
        translation("sol", np.array([0.0, 0.0, height, 1.0])),
        f"plane times an interval of length {height:.3f}",
        "the paper's own code, zLoop",
    )


MANIFOLDS = {"anosov": anosov, "xy-loops": xy_loops, "z-loop": z_loop}
ALIASES = {
    "anosov-torus-bundle": "anosov",
    "anosov-bundle": "anosov",
    "cat-map": "anosov",
    "arnold-cat-map": "anosov",
    "mapping-torus": "anosov",
    "mappingtorus": "anosov",
    "torus-bundle": "anosov",
    "horizontal-loops": "xy-loops",
    "horizontalloops": "xy-loops",
    "xyloops": "xy-loops",
    "zloop": "z-loop",
}
