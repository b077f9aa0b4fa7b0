"""The manifold that tiles space: a name, or matrices and half-spaces."""

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, ValidationInfo

from .base import Node, Problem, problem, shown
from .context import GEOMETRIES, Context, context_of
from .suggest import did_you_mean, listing
from .values import AtLeast, Says, Vec4

Matrix = Annotated[
    tuple[Vec4, Vec4, Vec4, Vec4], BeforeValidator(lambda v: _four_rows(v)), Says("4 × 4 numbers")
]


def _four_rows(value: Any) -> Any:
    if not isinstance(value, (list, tuple)) or len(value) != 4:
        found = f"{len(value)} rows" if isinstance(value, (list, tuple)) else shown(value)
        raise problem(f"expected a matrix of 4 rows with 4 numbers each, found {found}")
    return value


class MatrixLattice(Node):
    """A group of isometries, given by the matrices that pair the walls of a fundamental domain."""

    what = "a lattice"
    example = "manifold: {generators: [[[1, 0, 0, 1], ...], ...], domain: [[1, 0, 0, -0.5], ...]}"

    generators: Annotated[tuple[Matrix, ...], AtLeast(1), Says("list of 4 × 4 matrices, row by row")] = Field(
        description="Isometries in the model of the geometry, acting on columns [x, y, z, w]. The k-th leads "
        "back a point that left the domain through the k-th wall."
    )
    domain: Annotated[tuple[Vec4, ...], AtLeast(1), Says("list of 4-vectors")] = Field(
        description="The walls: the domain holds the points p with n · p ≤ 0 (four components) for each n."
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
            elsewhere = [geometry for geometry in GEOMETRIES if value in lattice.names(geometry)]
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
