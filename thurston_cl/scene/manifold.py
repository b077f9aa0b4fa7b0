"""The manifold that tiles space: a name, matrices and half-spaces, or the monodromy of a torus bundle."""

from collections.abc import Callable, Iterator, Mapping
from difflib import get_close_matches
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, ValidationInfo

from thurston_cl.models import GEOMETRIES, HOMOGENEOUS

from .base import Node, Problem, problem, shown
from .context import Context, context_of
from .suggest import did_you_mean, listing
from .values import AtLeast, Lengths, Number, Says, whole_number

if TYPE_CHECKING:
    from thurston_cl.lattice import Lattice

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


def _two(expected: str, each: str) -> Callable[[object], object]:
    """The validator of a list of two; `each` is what a message calls its entries."""

    def check(value: object) -> object:
        if not isinstance(value, (list, tuple)) or len(value) != 2:
            found = f"{len(value)}{each}" if isinstance(value, (list, tuple)) else shown(value)
            raise problem(f"expected {expected}, found {found}", "for example [[2, 1], [1, 1]]")
        return value

    return check


Whole = Annotated[int, BeforeValidator(whole_number), Says("whole number")]
WholeRow = Annotated[tuple[Whole, Whole], BeforeValidator(_two("a row of 2 whole numbers", ""))]
WholeMatrix = Annotated[
    tuple[WholeRow, WholeRow],
    BeforeValidator(_two("2 rows of 2 whole numbers", " rows")),
    Says("2 × 2 whole numbers `[[a, b], [c, d]]`"),
]


class MatrixLattice(Node):
    """A group of isometries, given by the matrices that pair the walls of a fundamental domain."""

    what = "a lattice"
    example = "manifold: {generators: [[[1, 0, 0, 1], ...], ...], domain: [[1, 0, 0, -0.5], ...]}"

    generators: Annotated[tuple[Matrix, ...], AtLeast(1), Says("list of matrices, row by row")] = Field(
        description="Isometries in the model of the geometry, acting on columns: 4 × 4 on [x, y, z, w] in "
        "e3, s3, h3, nil and sol; 5 × 5 on [x, y, z, w, 1] in s2xe, h2xe and sl2. There w goes to ±w + a "
        "number; in sl2 it also gains an angle that is not linear: ± 2 atan2(b x − a y, 1 + c + z + z') "
        "where the third row is [a, b, c, 0, 0] and z' = a x + b y + c z. The k-th leads back a point that "
        "left the domain through the k-th wall."
    )
    domain: Annotated[tuple[Row, ...], AtLeast(1), Says("list of 4- or 5-vectors")] = Field(
        description="The walls: the domain holds the points p with n · p ≤ 0 for each n, which has as many "
        "numbers as the matrices have rows. In the fibered geometries s2xe, h2xe, nil and sl2 a wall is "
        "vertical, with 0 for the fiber coordinate, or horizontal, with nothing but that and a constant. In "
        "sol z takes its place: at most two pairs of vertical walls, with translations [x, y, 0], and one of "
        "horizontal ones."
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
        if context.geometry is not None:
            yield from _built(context, self)

    def lattice(self, geometry: str) -> "Lattice":
        """The lattice that this means. Raises LatticeError where there is none."""
        from thurston_cl import lattice

        return lattice.from_matrices(geometry, self.generators, self.domain)


class TorusBundle(Node):
    """A torus bundle over the circle, in sol: the torus times an interval, whose ends are glued by a matrix
    that stretches one direction and shrinks another."""

    what = "a torus bundle"
    example = "manifold: {monodromy: [[2, 1], [1, 1]]}"
    hints: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("generators", "domain"), "they follow from the monodromy; give these two or it"
    )

    monodromy: WholeMatrix = Field(
        description="How the ends of the interval are glued: a d − b c = 1, and a + d is from 3 to 1000, or "
        "from −3 to −1000, which adds a half-turn. The interval is as long as the logarithm of the larger "
        "eigenvalue. At z = 0 the cell is nearly a square; at every level it has the same area, "
        "1/(golden ratio + 2) = 0.276."
    )

    def check(self, context: Context) -> Iterator[Problem]:
        if context.geometry not in (None, "sol"):
            message = f"a torus bundle by its monodromy has the geometry sol, not {context.geometry}"
            yield Problem(("monodromy",), message, "write geometry: sol", True)
        elif context.geometry is not None:
            yield from _built(context, self)

    def lattice(self, geometry: str) -> "Lattice":
        """The lattice that this means. Raises LatticeError where there is none."""
        from thurston_cl import lattice

        return lattice.torus_bundle(self.monodromy)


def _built(context: Context, given: MatrixLattice | TorusBundle) -> Iterator[Problem]:
    """Keep the lattice for the rest of the scene, or say why there is none."""
    from thurston_cl.lattice import LatticeError

    assert context.geometry is not None
    try:
        context.lattice = given.lattice(context.geometry)
    except LatticeError as error:
        path = (error.what,) if error.index is None else (error.what, error.index)
        what, _, cure = str(error).rpartition("; ")
        yield Problem(path, what or cure, cure if what else None)


def _manifold(value: Any, info: ValidationInfo) -> Any:
    context = context_of(info)
    if isinstance(value, dict):
        given = TorusBundle if get_close_matches("monodromy", map(str, value)) else MatrixLattice
        return given.model_validate(value, context=context)
    if not isinstance(value, (str, MatrixLattice, TorusBundle)):
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
    str | MatrixLattice | TorusBundle,
    BeforeValidator(_manifold),
    Says(
        "name of a manifold, a [lattice](#matrix-lattice) `{generators: ..., domain: ...}` or a "
        "[torus bundle](#torus-bundle) `{monodromy: ...}`"
    ),
]
