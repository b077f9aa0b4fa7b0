"""The manifold that tiles space: a name, or matrices and half-spaces."""

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, ValidationInfo

from thurston_cl.models import GEOMETRIES, HOMOGENEOUS

from .base import Node, Problem, problem, shown
from .context import Context, context_of
from .suggest import did_you_mean, listing
from .values import AtLeast, Lengths, Number, Says

_COORDINATES = {4: "[x, y, z, w]", 5: "[x, y, z, w, 1]"}
_SIZES = (4, 5)


def _sizes(context: Context) -> tuple[int, ...]:
    """How many coordinates isometries act on in the geometry of the scene, if that is known."""
    return (HOMOGENEOUS[context.geometry],) if context.geometry is not None else _SIZES


def _row(value: Any, info: ValidationInfo) -> Any:
    sizes = _sizes(context_of(info))
    if not isinstance(value, (list, tuple)) or len(value) not in sizes:
        found = len(value) if isinstance(value, (list, tuple)) else shown(value)
        expected = f"{sizes[0]} numbers {_COORDINATES[sizes[0]]}" if len(sizes) == 1 else "4 or 5 numbers"
        raise problem(f"expected {expected}, found {found}")
    return value


def _square(value: Any, info: ValidationInfo) -> Any:
    sizes = _sizes(context_of(info))
    if not isinstance(value, (list, tuple)) or len(value) not in sizes:
        found = f"{len(value)} rows" if isinstance(value, (list, tuple)) else shown(value)
        n = " or ".join(map(str, sizes))
        help = None
        if len(sizes) == 1:
            help = f"isometries of {context_of(info).geometry} act on columns {_COORDINATES[sizes[0]]}"
        raise problem(f"expected a matrix of {n} rows with {n} numbers each, found {found}", help)
    return value


Row = Annotated[tuple[Number, ...], BeforeValidator(_row), Lengths(*_SIZES), Says("4 or 5 numbers")]
Matrix = Annotated[
    tuple[Row, ...], BeforeValidator(_square), Lengths(*_SIZES), Says("4 × 4 or 5 × 5 numbers")
]


class MatrixLattice(Node):
    """A group of isometries, given by the matrices that pair the walls of a fundamental domain."""

    what = "a lattice"
    example = "manifold: {generators: [[[1, 0, 0, 1], ...], ...], domain: [[1, 0, 0, -0.5], ...]}"

    generators: Annotated[tuple[Matrix, ...], AtLeast(1), Says("list of matrices, row by row")] = Field(
        description="Isometries in the model of the geometry, acting on columns: 4 × 4 on [x, y, z, w] in "
        "e3, s3, h3 and nil; 5 × 5 on [x, y, z, w, 1] in s2xe, h2xe and sl2. There w goes to ±w + a number; "
        "in sl2 it also gains an angle that is not linear: ± 2 atan2(b x − a y, 1 + c + z + z') where the "
        "third row is [a, b, c, 0, 0] and z' = a x + b y + c z. The k-th leads back a point that left the "
        "domain through the k-th wall."
    )
    domain: Annotated[tuple[Row, ...], AtLeast(1), Says("list of 4- or 5-vectors")] = Field(
        description="The walls: the domain holds the points p with n · p ≤ 0 for each n, which has as many "
        "numbers as the matrices have rows. In the fibered geometries s2xe, h2xe, nil and sl2 a wall is "
        "vertical, with 0 for the fiber coordinate, or horizontal, with nothing but that and a constant."
    )

    def check(self, context: Context) -> Iterator[Problem]:
        if len(self.generators) != len(self.domain):
            message = (
                f"{len(self.generators)} generators for {len(self.domain)} walls: each wall has its generator"
            )
            yield Problem(
                ("domain",), message, "give the inverse of each generator, with the opposite wall, too"
            )
            return
        if context.geometry is None:
            return
        from thurston_cl import lattice

        try:
            context.lattice = lattice.from_matrices(context.geometry, self.generators, self.domain)
        except lattice.LatticeError as error:
            path = (error.what,) if error.index is None else (error.what, error.index)
            what, _, cure = str(error).rpartition("; ")
            yield Problem(path, what or cure, cure if what else None)


def _manifold(value: Any, info: ValidationInfo) -> Any:
    context = context_of(info)
    if isinstance(value, dict):
        return MatrixLattice.model_validate(value, context=context)
    if not isinstance(value, (str, MatrixLattice)):
        raise problem(
            f"expected the name of a manifold, found {shown(value)}", "or {generators: [...], domain: [...]}"
        )
    if isinstance(value, str) and context.geometry is not None:
        from thurston_cl import lattice

        try:
            context.lattice = lattice.named(context.geometry, value)
        except lattice.LatticeError:
            known = lattice.names(context.geometry)
            plain = value.lower().replace(" ", "-").replace("_", "-")
            elsewhere = [geometry for geometry in GEOMETRIES if plain in lattice.names(geometry)]
            help = f"'{value}' has the geometry {elsewhere[0]}" if elsewhere else did_you_mean(value, known)
            raise problem(
                f"{context.geometry} has no manifold '{value}'",
                help or f"known manifolds: {listing(known, 20)}",
            ) from None
    return value


ManifoldValue = Annotated[
    str | MatrixLattice,
    BeforeValidator(_manifold),
    Says("name of a manifold, or a [lattice](#matrix-lattice) `{generators: ..., domain: ...}`"),
]
