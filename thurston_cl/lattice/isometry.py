"""Isometries of the eight geometries, as matrices on homogeneous columns.

Points are 4-vectors [x,y,z,w] of the models (paper Table 1). In e3, s3, h3, nil and sol isometries are linear
on them: (4,4) matrices. In s2xe, h2xe and sl2 they are (5,5) matrices on [x,y,z,w,1]: rows x, y, z hold the
isometry A (3,3) of the base S2 or H2, row w is (0,0,0,sense,shift) with sense +-1. That is all of a product's
isometry; in sl2 the fibre coordinate gains more than that (`act`), so that matrix products do not compose.
An isometry of sl2 is determined by its matrix all the same, since shift is where it takes o along the fibre.
Paper 7, 8.1, 9.1, 10.1, 11.1; the isometries of nil and sl2 are L_p (R_a or a flip), both orientation
preserving; those of sol L_p K where K changes signs of x and y, and may exchange them while it negates z.
"""

import numpy as np
from numpy.typing import ArrayLike

from thurston_cl.lattice.error import LatticeError
from thurston_cl.lattice.forms import (
    Array,
    form,
    form_inverse,
    form_polish,
    form_residual,
    keeps_sheet,
)
from thurston_cl.models import FIBRE, GEOMETRIES, HOMOGENEOUS, LEFT_INVARIANT, ORIGIN, TWISTED

# Curvature of the base of a fibred geometry: S2, the plane, H2.
BASE_CURVATURE = {"s2xe": 1, "h2xe": -1, "nil": 0, "sl2": -1}
# Matrices and points that agree to so many digits after the point are the same: far above rounding, far below
# a lattice.
SAME_DIGITS = 6
# The residual of an isometry whose entries are correctly rounded is below this.
ROUNDING = 2e-15
# How far a rotation may be from orthogonal, and from keeping the fibre: far above rounding, far below an
# angle.
OFF_ORTHOGONAL = 1e-9


def check_geometry(geometry: str) -> None:
    """Raises LatticeError for a geometry that has no lattices here."""
    if geometry not in GEOMETRIES:
        known = ", ".join(GEOMETRIES)
        raise LatticeError(f"there are no lattices for geometry '{geometry}'; known are: {known}", "name")


def dimension(geometry: str) -> int:
    """Number of homogeneous coordinates, and size of the matrices: 4 or 5."""
    check_geometry(geometry)
    return HOMOGENEOUS[geometry]


def fibre(geometry: str) -> int:
    """Which coordinate of a point of a fibred geometry runs along the fibre; in sol z, across its planes."""
    return 2 if geometry == "sol" else FIBRE[geometry]


def origin(geometry: str) -> Array:
    """The origin o (4,) of the model."""
    check_geometry(geometry)
    return np.array(ORIGIN[geometry])


def identity(geometry: str) -> Array:
    """The identity (n,n)."""
    return np.eye(dimension(geometry))


def homogeneous(geometry: str, points: ArrayLike) -> Array:
    """Homogeneous coordinates (...,n) of points (...,4)."""
    p = np.asarray(points, dtype=np.float64)
    return np.concatenate([p, np.ones((*p.shape[:-1], 1))], axis=-1) if dimension(geometry) == 5 else p


def on_model(geometry: str, points: ArrayLike) -> Array:
    """Points (...,4) put back on the model after rounding has moved them off it."""
    check_geometry(geometry)
    p = np.array(points, dtype=np.float64)
    match geometry:
        case "e3" | "nil" | "sol":
            p[..., 3] = 1.0
        case "s3":
            p /= np.linalg.norm(p, axis=-1, keepdims=True)
        case "h3":
            p[..., 3] = np.sqrt(1.0 + np.sum(p[..., :3] ** 2, axis=-1))
        case "s2xe":
            p[..., :3] /= np.linalg.norm(p[..., :3], axis=-1, keepdims=True)
        case _:
            p[..., 2] = np.sqrt(1.0 + np.sum(p[..., :2] ** 2, axis=-1))
    return p


def act(geometry: str, isometry: ArrayLike, points: ArrayLike) -> Array:
    """Points (...,4) moved by isometries (...,n,n), both broadcast, and put back on the model.

    In sl2 the fibre coordinate of p = [x,y,z,w] with A p = q becomes, m the third row of A,
    sense w + shift + 2 atan2(sense (m_y x - m_x y), 1 + m_z + z + q_z): left multiplication (10.1) before the
    logarithm of the product is taken, see kernels/geometry/sl2.h.
    """
    m, p = np.asarray(isometry, dtype=np.float64), np.asarray(points, dtype=np.float64)
    q = on_model(geometry, np.einsum("...ij,...j->...i", m[..., :4, :], homogeneous(geometry, p)))
    if geometry == "sl2":
        q[..., 3] += _gain(m, p, q)
    return q


def _gain(m: Array, p: Array, q: Array) -> Array:
    """What the fibre coordinate of sl2 gains beyond its affine part, from p (...,4) to q on the base."""
    across = m[..., 2, 1] * p[..., 0] - m[..., 2, 0] * p[..., 1]
    along = 1.0 + m[..., 2, 2] + p[..., 2] + q[..., 2]
    return np.asarray(2.0 * np.arctan2(m[..., 3, 3] * across, along))


def compose(geometry: str, a: ArrayLike, b: ArrayLike) -> Array:
    """The isometries a after b (...,n,n), both broadcast."""
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    product = np.asarray(a @ b)
    check_geometry(geometry)
    if geometry == "sl2":
        product[..., 3, 4] += _gain(a, b[..., :4, 2], product[..., :4, 2])
    return product


def inverse(geometry: str, isometry: ArrayLike) -> Array:
    """Inverses (...,n,n) of isometries (...,n,n), without solving."""
    check_geometry(geometry)
    m = np.asarray(isometry, dtype=np.float64)
    if geometry in ("s3", "h3"):
        return form_inverse(form(geometry), m) + 0.0
    result = np.zeros_like(m)
    result[..., -1, -1] = 1.0
    if HOMOGENEOUS[geometry] == 5:
        result[..., :3, :3] = form_inverse(_base_form(geometry), m[..., :3, :3])
        result[..., 3, 3] = m[..., 3, 3]
        # Also in sl2: A takes A^-1 o to o, where nothing is gained.
        result[..., 3, 4] = -m[..., 3, 3] * m[..., 3, 4]
        return result + 0.0
    if geometry == "nil":
        # (L_p K)^-1 = K^-1 L_-p = L_q K^-1 with q = -K^-1 p.
        turn = np.swapaxes(m[..., :2, :2], -1, -2)
        q = -(turn @ m[..., :2, 3:])[..., 0]
        return _nil(turn, m[..., 2, 2], np.concatenate([q, (-m[..., 2, 2] * m[..., 2, 3])[..., None]], -1))
    if geometry == "sol":
        # The adjugate of the block of x, y, which has two zeros and the determinant +-1.
        block, quarter = m[..., :2, :2], np.array([[0.0, -1.0], [1.0, 0.0]])
        sign = np.sign(np.linalg.det(block))[..., None, None]
        result[..., :2, :2] = sign * (quarter @ np.swapaxes(block, -1, -2) @ quarter.T)
        result[..., 2, 2] = m[..., 2, 2]
        result[..., :3, 3] = -(result[..., :3, :3] @ m[..., :3, 3:])[..., 0]
        return result + 0.0
    transposed = np.swapaxes(m[..., :3, :3], -1, -2)
    result[..., :3, :3] = transposed
    result[..., :3, 3] = -(transposed @ m[..., :3, 3:])[..., 0]
    return result + 0.0


def _nil(turn: Array, sense: ArrayLike, shift: Array) -> Array:
    """The isometry (...,4,4) of nil that turns about o by turn (...,2,2) and +-1 and then goes to `shift`
    (...,3).
    """
    m = np.zeros((*shift.shape[:-1], 4, 4))
    m[..., :2, :2] = turn
    m[..., 2, :2] = 0.5 * (shift[..., :1] * turn[..., 1, :] - shift[..., 1:2] * turn[..., 0, :])
    m[..., 2, 2] = sense
    m[..., :3, 3] = shift
    m[..., 3, 3] = 1.0
    return m + 0.0


def _sol(signs: ArrayLike, sense: ArrayLike, shift: Array) -> Array:
    """The isometry (...,4,4) of sol that maps x, y by `signs` (...,2,2), z by +-1 and then goes to `shift`
    (...,3).
    """
    m = np.zeros((*shift.shape[:-1], 4, 4))
    m[..., :2, :2] = np.exp(shift[..., 2, None] * [1.0, -1.0])[..., None] * signs
    m[..., 2, 2] = sense
    m[..., :3, 3] = shift
    m[..., 3, 3] = 1.0
    return m + 0.0


def _sol_signs(m: Array) -> tuple[Array, Array]:
    """What an isometry (...,4,4) of sol makes of x and y about o (...,2,2), and where it may have entries."""
    with np.errstate(over="ignore"):
        # Beyond what can be an exponent the matrix is none, and the product says so.
        back = np.exp(np.clip(m[..., 2, 3, None], -700.0, 700.0) * [-1.0, 1.0])
        signs = back[..., None] * m[..., :2, :2]
    upright = m[..., 2, 2, None, None] > 0
    return signs, np.where(upright, np.eye(2), np.eye(2)[::-1])


def _base_form(geometry: str) -> Array:
    return np.array([1.0, 1.0, float(BASE_CURVATURE[geometry])])


def residual(geometry: str, isometry: ArrayLike) -> float:
    """How far (...,n,n) matrices are from isometries, relative to their largest entry or its square: the
    greatest of `rules`. The sheet of h3, h2xe, sl2 is not looked at, nor the sign of sense.
    """
    return max(rules(geometry, isometry).values())


def rules(geometry: str, isometry: ArrayLike) -> dict[str, float]:
    """What makes matrices (...,n,n) isometries, in words, and how far they are from it."""
    check_geometry(geometry)
    m = np.asarray(isometry, dtype=np.float64)

    def off(values: ArrayLike) -> float:
        return float(np.max(np.abs(values)))

    match geometry:
        case "e3":
            rotation = m[..., :3, :3]
            worst = form_residual(np.ones(3), rotation)
            last = off(m[..., 3, :] - [0.0, 0.0, 0.0, 1.0])
            return {
                "its last row must be [0, 0, 0, 1] and its upper left 3x3 block orthogonal": max(worst, last)
            }
        case "s3":
            return {"it must be orthogonal": form_residual(form("s3"), m)}
        case "h3":
            return {"M^T J M must be J = diag(1, 1, 1, -1)": form_residual(form("h3"), m)}
        case "nil":
            turn = m[..., :2, :2]
            determinant = np.linalg.det(turn)
            right = _nil(turn, determinant, m[..., :3, 3])
            scale = max(1.0, off(m))
            return {
                "its last row must be [0, 0, 0, 1] and the first two entries of its third column 0": max(
                    off(m[..., 3, :] - [0.0, 0.0, 0.0, 1.0]), off(m[..., :2, 2])
                ),
                "its upper left 2x2 block must be orthogonal": form_residual(np.ones(2), turn),
                "the third entry of its third row must be the determinant of the upper left 2x2 block": off(
                    m[..., 2, 2] - determinant
                ),
                "its third row must begin with (a d - b c)/2 for the entries c, d above and the last entries "
                "a, b of the rows above": off(m[..., 2, :2] - right[..., 2, :2]) / scale,
            }
        case "sol":
            signs, places = _sol_signs(m)
            return {
                "its last row must be [0, 0, 0, 1]": off(m[..., 3, :] - [0.0, 0.0, 0.0, 1.0]),
                "its third row must be [0, 0, e, c] with e = 1 or -1, its third column 0 above e": max(
                    off(m[..., 2, :2]), off(m[..., :2, 2]), off(np.abs(m[..., 2, 2]) - 1.0)
                ),
                "its upper left 2x2 block must be [[+-exp(c), 0], [0, +-exp(-c)]] where its third row is "
                "[0, 0, 1, c], and [[0, +-exp(c)], [+-exp(-c), 0]] where it is [0, 0, -1, c]": off(
                    np.abs(signs) - places
                ),
            }
    zeros = np.ones((5, 5), dtype=bool)
    zeros[:3, :3] = False
    zeros[3, 3:] = False
    last = np.eye(5)[4]
    blocks = "its upper left 3x3 block must be orthogonal"
    if BASE_CURVATURE[geometry] < 0:
        blocks = "A^T J A must be J = diag(1, 1, -1) for its upper left 3x3 block A"
    found = {
        "its last row must be [0, 0, 0, 0, 1]": off(m[..., 4, :] - last),
        "it must be [[A, 0, 0], [0, e, s], [0, 0, 1]] with a 3x3 block A": off(
            (m - np.diag(last))[..., zeros]
        ),
        blocks: form_residual(_base_form(geometry), m[..., :3, :3]),
        "the fourth entry of its fourth row must be 1 or -1": off(np.abs(m[..., 3, 3]) - 1.0),
    }
    if geometry == "sl2":
        sign = np.sign(np.linalg.det(m[..., :3, :3]))
        found["the fourth entry of its fourth row must be the determinant of its upper left 3x3 block"] = off(
            m[..., 3, 3] - sign
        )
    return found


def keeps_model(geometry: str, isometry: ArrayLike) -> bool:
    """Whether the matrices (...,n,n) map the model to itself, not one sheet of its hyperboloid to the
    other.
    """
    if geometry in BASE_CURVATURE:
        return BASE_CURVATURE[geometry] >= 0 or bool(np.all(np.asarray(isometry)[..., 2, 2] > 0))
    return geometry == "sol" or keeps_sheet(geometry, isometry)


def polish(geometry: str, isometry: ArrayLike) -> Array:
    """The isometry next to an almost-isometry (n,n), by Newton's iteration on its orthogonal block; in sol
    that with the same signs that carries o to the same point.
    """
    m = np.array(isometry, dtype=np.float64)
    # Quadratic convergence: from 1e-3 to rounding in three steps. A step too many adds rounding of its own.
    for _ in range(4):
        if residual(geometry, m) < ROUNDING:
            break
        match geometry:
            case "e3":
                m[:3, :3] = form_polish(np.ones(3), m[:3, :3])
                m[3] = [0.0, 0.0, 0.0, 1.0]
            case "s3" | "h3":
                m = form_polish(form(geometry), m)
            case "nil":
                turn = form_polish(np.ones(2), m[:2, :2])
                m = _nil(turn, np.sign(np.linalg.det(turn)), m[:3, 3])
            case "sol":
                signs, places = _sol_signs(m)
                m = _sol(np.sign(signs) * places, np.sign(m[2, 2]), m[:3, 3])
            case _:
                sense, shift = np.sign(m[3, 3]), m[3, 4]
                block = form_polish(_base_form(geometry), m[:3, :3])
                m = np.zeros((5, 5))
                m[:3, :3], m[3, 3:], m[4, 4] = block, (sense, shift), 1.0
    return m


def snap(values: ArrayLike, tolerance: float = 1e-12) -> Array:
    """Round entries next to a multiple of 1/2 to it, and -0 to 0: the code generator leaves zeros out."""
    a = np.array(values, dtype=np.float64)
    halves = np.round(2.0 * a) / 2.0
    return np.where(np.abs(a - halves) <= tolerance, halves, a) + 0.0


def tidy(geometry: str, isometry: ArrayLike, tolerance: float = 1e-12) -> Array:
    """The isometry next to an almost-isometry (n,n), with entries exact where they are a multiple of 1/2."""
    m = np.array(isometry, dtype=np.float64)
    # Either step disturbs the other a little; they settle in a few rounds.
    for _ in range(20):
        m = snap(polish(geometry, m), tolerance)
        if residual(geometry, m) < ROUNDING:
            break
    return m


def stabilizer(geometry: str, rotation: ArrayLike) -> Array:
    """The isometry (n,n) that fixes o and has the differential `rotation` (3,3), on directions of the frame.

    In e3, s3, h3 any orthogonal matrix will do. Fibred geometries must keep the fibre: rotations about it and
    half-turns about horizontal axes, in s2xe and h2xe also reflections. Sol keeps the axes x and y, up to
    their exchange, which reverses z. Raises LatticeError otherwise.
    """
    r = np.array(rotation, dtype=np.float64)
    m = identity(geometry)
    if r.shape != (3, 3) or form_residual(np.ones(3), r) > OFF_ORTHOGONAL:
        raise LatticeError("a rotation must be an orthogonal 3x3 matrix", "generators")
    if geometry == "sol":
        turned = _sol(np.round(r[:2, :2]), np.round(r[2, 2]), np.zeros(3))
        if np.max(np.abs(turned[:3, :3] - r)) > OFF_ORTHOGONAL or residual("sol", turned) > 0:
            raise LatticeError(
                "sol can only be turned by 180 deg about [0, 0, 1], [1, 1, 0] and [1, -1, 0], "
                "and mirrored in x and in y",
                "generators",
            )
        return turned
    if geometry not in BASE_CURVATURE:
        m[:3, :3] = r
        return m
    if max(np.max(np.abs(r[2, :2])), np.max(np.abs(r[:2, 2]))) > OFF_ORTHOGONAL:
        raise LatticeError(
            f"{geometry} can only be turned about its fiber, the third axis, and by half-turns about axes "
            "across it",
            "generators",
        )
    sense = float(np.sign(r[2, 2]))
    if geometry in TWISTED and np.linalg.det(r) < 0:
        raise LatticeError(f"{geometry} has no reflections: its rotations have determinant 1", "generators")
    m[:2, :2] = r[:2, :2]
    m[fibre(geometry), fibre(geometry)] = sense
    return m


def vector_map(geometry: str, isometry: ArrayLike) -> Array:
    """The linear maps (...,4,4) that isometries (...,n,n) make of tangent vectors as kernels have them.

    Ambient velocities in e3, s3, h3, s2xe, h2xe. In nil, sl2 and sol the components in the left-invariant
    frame, w = 0: left translations leave them alone, so only the turn about o is left.
    """
    check_geometry(geometry)
    m = np.asarray(isometry, dtype=np.float64)
    if geometry not in LEFT_INVARIANT:
        return np.array(m[..., :4, :4])
    k = np.zeros((*m.shape[:-2], 4, 4))
    if geometry == "sol":
        k[..., :2, :2], k[..., 2, 2] = np.sign(m[..., :2, :2]), m[..., 2, 2]
        return k
    if geometry == "nil":
        k[..., :2, :2], k[..., 2, 2] = m[..., :2, :2], m[..., 2, 2]
        return k
    # A = T(p) R(shift) K: undo the transvection to p = A o, then the turn that left translation makes.
    p = m[..., :3, 2]
    back = m[..., :2, :2] - p[..., :2, None] * (m[..., 2:3, :2] / (1.0 + p[..., 2, None, None]))
    c, s = np.cos(m[..., 3, 4]), np.sin(m[..., 3, 4])
    k[..., 0, :2] = c[..., None] * back[..., 0, :] + s[..., None] * back[..., 1, :]
    k[..., 1, :2] = c[..., None] * back[..., 1, :] - s[..., None] * back[..., 0, :]
    k[..., 2, 2] = m[..., 3, 3]
    return k


def translation(geometry: str, point: ArrayLike) -> Array:
    """The isometries (...,n,n) that carry o to points (...,4): left translation in nil, sl2 and sol, in s2xe
    and h2xe the transvection of the base and the shift. Singular at the antipode of o on S2.
    """
    p = np.asarray(point, dtype=np.float64)
    if geometry == "sol":
        return _sol(np.eye(2), 1.0, p[..., :3])
    if geometry == "nil":
        return _nil(np.eye(2), 1.0, p[..., :3])
    if HOMOGENEOUS[geometry] == 4:
        raise LatticeError(f"{geometry} is no fibered geometry", "generators")
    k = BASE_CURVATURE[geometry]
    m = np.zeros((*p.shape[:-1], 5, 5))
    xy = p[..., :2]
    m[..., :2, :2] = np.eye(2) - k * xy[..., :, None] * xy[..., None, :] / (1.0 + p[..., 2, None, None])
    m[..., :2, 2] = xy
    m[..., 2, :2] = -k * xy
    m[..., 2, 2] = p[..., 2]
    m[..., 3, 3] = m[..., 4, 4] = 1.0
    m[..., 3, 4] = p[..., 3]
    if geometry == "sl2":
        c, s = np.cos(p[..., 3]), np.sin(p[..., 3])
        turn = np.zeros((*p.shape[:-1], 3, 3))
        turn[..., 0, 0] = turn[..., 1, 1] = c
        turn[..., 0, 1], turn[..., 1, 0], turn[..., 2, 2] = -s, s, 1.0
        m[..., :3, :3] = m[..., :3, :3] @ turn
    return m + 0.0
