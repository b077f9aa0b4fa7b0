"""Discrete groups, fundamental domains and named manifolds of the eight geometries.

    lattice = named("h3", "seifert-weber")
    inside, elements, ok = lattice.teleport(points)

Names are listed by `names(geometry)`; the docstrings of `thurston_cl.lattice.e3`, `.s3`, `.h3`, `.s2xe`,
`.h2xe`, `.nil`, `.sl2`, `.sol` define them.
"""

import difflib
import unicodedata
from functools import cache

from thurston_cl.lattice import e3, h2xe, h3, nil, s2xe, s3, sl2, sol
from thurston_cl.lattice.cycles import EdgeCycle, edge_cycles, presentation
from thurston_cl.lattice.dirichlet import dirichlet
from thurston_cl.lattice.domain import Lattice, edges, vertices
from thurston_cl.lattice.error import LatticeError
from thurston_cl.lattice.given import from_matrices
from thurston_cl.lattice.isometry import check_geometry, inverse
from thurston_cl.lattice.orbit import cell_table, elements, neighbours, paths
from thurston_cl.lattice.polyhedron import Edge, Vertex
from thurston_cl.lattice.sol import torus_bundle

__all__ = [
    "Edge",
    "EdgeCycle",
    "Lattice",
    "LatticeError",
    "Vertex",
    "cell_table",
    "dirichlet",
    "edge_cycles",
    "edges",
    "elements",
    "from_matrices",
    "inverse",
    "named",
    "names",
    "neighbours",
    "paths",
    "presentation",
    "torus_bundle",
    "vertices",
]

_MODULES = {"e3": e3, "s3": s3, "h3": h3, "s2xe": s2xe, "h2xe": h2xe, "nil": nil, "sl2": sl2, "sol": sol}
_MANIFOLDS = {geometry: module.MANIFOLDS for geometry, module in _MODULES.items()}
_ALIASES = {geometry: module.ALIASES for geometry, module in _MODULES.items()}


def names(geometry: str) -> list[str]:
    """Names of the manifolds and orbifolds of a geometry, without their aliases."""
    check_geometry(geometry)
    return list(_MANIFOLDS[geometry])


def named(geometry: str, name: str) -> Lattice:
    """The lattice of that name; case, spaces, underscores and accents do not matter, and common aliases are
    known.

    Raises LatticeError (a ValueError) that lists the names and guesses what was meant.
    """
    check_geometry(geometry)
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode().strip().lower()
    plain = plain.replace(" ", "-").replace("_", "-")
    known, aliases = _MANIFOLDS[geometry], _ALIASES[geometry]
    canonical = aliases.get(plain, plain)
    if canonical in known:
        return _build(geometry, canonical)
    message = f"there is no manifold '{name}' in {geometry}; known are: {', '.join(known)}"
    guesses = difflib.get_close_matches(plain, [*known, *aliases], n=1)
    elsewhere = [g for g in _MANIFOLDS if plain in _MANIFOLDS[g] or plain in _ALIASES[g]]
    if elsewhere:
        message += f"; '{name}' is in {elsewhere[0]}"
    elif guesses:
        message += f"; did you mean '{guesses[0]}'?"
    raise LatticeError(message, "name")


@cache
def _build(geometry: str, name: str) -> Lattice:
    return _MANIFOLDS[geometry][name]()
