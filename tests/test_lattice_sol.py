"""Lattices of sol: isometries against the kernels, torus bundles of all monodromies, domains, cells, errors,
and what the kernels make of walls.
"""

from types import SimpleNamespace

import numpy as np
import pyopencl as cl
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from thurston_cl import lattice as tl
from thurston_cl.errors import SceneError
from thurston_cl.geometry import Geometry
from thurston_cl.lattice import isometry as iso
from thurston_cl.lattice.checks import INSIDE
from thurston_cl.lattice.radius import FARTHEST, orbit_radius
from thurston_cl.lattice.sol import AREA
from thurston_cl.lattice.suspension import GREATEST_TRACE, TOUCH, Suspension, suspension
from thurston_cl.program import LOCAL_SIZE, Source, build, geometry_parts
from thurston_cl.scene import load_text
from thurston_cl.scene.near_walls import choose_near_walls, images
from thurston_cl.scene.numbers import Numbers
from thurston_cl.scene.placement import Placement
from thurston_cl.scene.write_walls import write_walls

PHI = (1 + np.sqrt(5)) / 2
ORIGIN = iso.origin("sol")
# The isometries that fix o: x and y negated or not, and exchanged while z is reversed or not.
SIGNS = [np.diag([a, b, 1.0]) for a in (1, -1) for b in (1, -1)]
D8 = SIGNS + [s @ [[0, 1, 0], [1, 0, 0], [0, 0, -1]] for s in SIGNS]


def off_centre():
    """The cat map's bundle with a domain that is not symmetric about o, and generators in another order."""
    lattice = tl.named("sol", "anosov")
    walls = lattice.walls.copy()
    walls[:, 3] += [0.1, -0.1, -0.05, 0.05, 0.2, -0.2]
    shifted = [4, 1, 3, 0, 2, 5]
    return tl.from_matrices("sol", lattice.maps[shifted], walls[shifted])


def glide():
    """The golden bundle [[1,1],[1,0]], whose level is glued with a reflection in y; and a shift along it."""
    climb = iso.compose(
        "sol",
        iso.translation("sol", np.array([0.1, -0.2, np.log(PHI), 1])),
        iso.stabilizer("sol", np.diag([1, -1, 1])),
    )
    made = suspension("glide", tl.named("sol", "anosov").basis, climb, "", "")
    return tl.from_matrices("sol", made.maps, made.walls)


def strip():
    return tl.from_matrices(
        "sol",
        [iso.translation("sol", np.array([s, 0.5 * s, 0, 1])) for s in (-1, 1)],
        [[0.6, 0.8, 0, -0.5], [-0.6, -0.8, 0, -0.5]],
    )


MADE = {
    "[[3,1],[2,1]]": lambda: tl.torus_bundle([[3, 1], [2, 1]]),
    "-[[2,1],[1,1]]": lambda: tl.torus_bundle([[-2, -1], [-1, -1]]),
    "[[1,10],[1,11]]": lambda: tl.torus_bundle([[1, 10], [1, 11]]),
    "-[[27,8],[10,3]]": lambda: tl.torus_bundle([[-27, -8], [-10, -3]]),
    "off-centre": off_centre,
    "glide": glide,
    "strip": strip,
}
LATTICES = {name: tl.named("sol", name) for name in tl.names("sol")} | {n: make() for n, make in MADE.items()}
CLOSED = [name for name, lattice in LATTICES.items() if lattice.finite_volume]
each = pytest.mark.parametrize("name", LATTICES)
each_closed = pytest.mark.parametrize("name", CLOSED)


@pytest.fixture(scope="module")
def kernel():
    return Geometry("sol")


def random_points(count, size, seed):
    points = np.tile(ORIGIN, (count, 1))
    points[:, :3] = size * np.random.default_rng(seed).normal(size=(count, 3))
    return points


def random_isometries(count, seed):
    m = iso.translation("sol", random_points(count, 1.0, seed))
    return np.array([iso.compose("sol", m[k], iso.stabilizer("sol", D8[k % 8])) for k in range(count)])


def inside(lattice, count, seed):
    """Points of the domain, all over it; where it has no end, within 2 of o."""
    low, high = np.clip(lattice.levels, -2, 2)
    points = np.tile(ORIGIN, (40 * count, 1))
    rng = np.random.default_rng(seed)
    size = 1.2 if lattice.normals.size else 2.0
    points[:, :2] = rng.uniform(-size, size, (len(points), 2))
    points[:, 2] = rng.uniform(low, high, len(points))
    points = points[lattice.contains(points, -1e-9)][:count]
    assert len(points) == count
    return points


def step(x, y):
    return iso.translation("sol", np.array([x, y, 0.0, 1.0]))


def product(*factors):
    found = iso.identity("sol")
    for factor in factors:
        found = iso.compose("sol", found, factor)
    return found


# --- isometries ---------------------------------------------------------------------------------------------


def test_isometries_are_a_group():
    a, b, c = (random_isometries(64, seed) for seed in (1, 2, 3))
    points = random_points(64, 1.0, 4)
    size = np.max(np.abs(a)) * np.max(np.abs(b)) * np.max(np.abs(c))
    ab = iso.compose("sol", a, b)
    assert iso.residual("sol", ab) < 1e-14 and iso.keeps_model("sol", ab)
    np.testing.assert_allclose(
        iso.act("sol", ab, points), iso.act("sol", a, iso.act("sol", b, points)), atol=1e-15 * size
    )
    np.testing.assert_allclose(
        iso.compose("sol", ab, c), iso.compose("sol", a, iso.compose("sol", b, c)), rtol=0, atol=1e-15 * size
    )
    back = iso.inverse("sol", a)
    for one in (iso.compose("sol", a, back), iso.compose("sol", back, a)):
        np.testing.assert_allclose(one, np.broadcast_to(np.eye(4), a.shape), rtol=0, atol=1e-15 * size)
    assert iso.residual("sol", back) < 1e-14
    assert iso.fibre("sol") == 2


def test_isometries_keep_the_kernels_distances_and_geodesics(kernel):
    m = random_isometries(64, 1)
    p, q = (random_points(64, 1.0, seed) for seed in (4, 5))
    moved = iso.act("sol", m, p)
    np.testing.assert_allclose(
        kernel.distance(moved, iso.act("sol", m, q)), kernel.distance(p, q), rtol=1e-10
    )
    np.testing.assert_allclose(
        iso.act("sol", iso.translation("sol", p), q), kernel.translate(p, q), rtol=1e-14, atol=1e-14
    )
    u = np.random.default_rng(6).normal(size=(64, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    turned = np.einsum("nij,nj->ni", iso.vector_map("sol", m)[:, :3, :3], u)
    ends = iso.act("sol", m, kernel.flow(u, 1.3, base=p)[0])
    np.testing.assert_allclose(
        kernel.flow(turned, 1.3, base=moved)[0], ends, rtol=0, atol=1e-13 * np.max(np.abs(ends))
    )


def test_isometries_keep_the_metric():
    """ds^2 = e^-2z dx^2 + e^2z dy^2 + dz^2, on the columns of the matrices."""
    m, p = random_isometries(64, 7), random_points(64, 1.0, 8)

    def metric(points):
        return np.exp(points[:, 2, None] * [-2.0, 2.0, 0.0])

    pulled = np.einsum("nki,nk,nkj->nij", m[:, :3, :3], metric(iso.act("sol", m, p)), m[:, :3, :3])
    there = metric(p)
    np.testing.assert_allclose(
        pulled / np.sqrt(there[:, :, None] * there[:, None]), np.tile(np.eye(3), (64, 1, 1)), atol=1e-14
    )


def test_rotations_about_the_origin():
    for signs in D8:
        m = iso.stabilizer("sol", signs)
        np.testing.assert_array_equal(m[:3, :3], signs)
        np.testing.assert_array_equal(iso.vector_map("sol", m)[:3, :3], signs)
    for wrong in ([[0, 1, 0], [1, 0, 0], [0, 0, 1]], np.diag([1, 1, -1]), [[1, 0, 0], [0, 0, 1], [0, 1, 0]]):
        with pytest.raises(tl.LatticeError, match=r"only be turned by 180 deg about \[0, 0, 1\]"):
            iso.stabilizer("sol", wrong)
    c, s = np.cos(0.3), np.sin(0.3)
    with pytest.raises(tl.LatticeError, match="mirrored in x and in y"):
        iso.stabilizer("sol", [[c, -s, 0], [s, c, 0], [0, 0, 1]])
    # From both sides of the tolerance.
    for off, good in ((0.5, True), (2.0, False)):
        tilt = np.eye(3)
        tilt[0, 1], tilt[1, 0] = off * iso.OFF_ORTHOGONAL, -off * iso.OFF_ORTHOGONAL
        if good:
            np.testing.assert_array_equal(iso.stabilizer("sol", tilt), np.eye(4))
        else:
            with pytest.raises(tl.LatticeError):
                iso.stabilizer("sol", tilt)


def test_tidy_puts_an_isometry_right():
    for m in random_isometries(16, 8):
        noise = 1 + 1e-7 * np.random.default_rng(9).uniform(-1, 1, m.shape)
        tidied = iso.tidy("sol", m * noise)
        assert iso.residual("sol", m * noise) > 1e-9
        assert iso.residual("sol", tidied) < iso.ROUNDING
        np.testing.assert_allclose(tidied, m, rtol=0, atol=1e-5)
    assert iso.residual("sol", np.diag([1.0, 1.0, 1e9, 1.0]) + np.eye(4, k=1) * [0, 0, 1e9, 0]) > 1


# --- bundles ------------------------------------------------------------------------------------------------

R, L = np.array([[1, 1], [0, 1]]), np.array([[1, 0], [1, 1]])


@st.composite
def monodromies(draw):
    """Every hyperbolic matrix of SL(2, Z) is a conjugate of a product of R and L, or of minus one."""
    m = R @ L if draw(st.booleans()) else L @ R
    for letter in draw(st.lists(st.sampled_from([R, L]), max_size=6)):
        m = m @ letter
    base = np.eye(2, dtype=int)
    for letter in draw(st.lists(st.sampled_from([R, L, -R, [[0, -1], [1, 0]]]), max_size=5)):
        base = base @ letter
    det_one_inverse = np.array([[base[1, 1], -base[0, 1]], [-base[1, 0], base[0, 0]]])
    m = base @ m @ det_one_inverse * draw(st.sampled_from([1, -1]))
    assume(abs(np.trace(m)) <= GREATEST_TRACE)
    return m.tolist()


def action(lattice):
    """The numbers by which the map over the upper level acts on the translations, unrounded."""
    climb = lattice.inverses[lattice.level_walls[0]]
    return np.linalg.solve(lattice.basis.T, climb[:2, :2] @ lattice.basis.T)


def test_the_papers_bundle():
    lattice = tl.named("sol", "anosov")
    a_1, a_2, b = lattice.inverses[0], lattice.inverses[2], lattice.inverses[4]
    np.testing.assert_allclose(a_1[:3, 3], np.array([PHI, -1, 0]) / (PHI + 2), rtol=0, atol=1e-16)
    np.testing.assert_allclose(a_2[:3, 3], np.array([1, PHI, 0]) / (PHI + 2), rtol=0, atol=1e-16)
    np.testing.assert_allclose(b[:3, 3], [0, 0, 2 * np.log(PHI)], rtol=0, atol=2e-16)
    back = iso.inverse("sol", b)
    np.testing.assert_allclose(product(b, a_1, back), product(a_1, a_1, a_2), rtol=0, atol=1e-15)
    np.testing.assert_allclose(product(b, a_2, back), product(a_1, a_2), rtol=0, atol=1e-15)
    np.testing.assert_array_equal(product(a_1, a_2), product(a_2, a_1))
    # The cube [-1/2, 1/2]^3 in the coordinates of the paper.
    u = np.random.default_rng(1).uniform(-1, 1, (500, 3))
    x = (u[:, 0] * PHI + u[:, 1]) / (PHI + 2)
    y = (-u[:, 0] + u[:, 1] * PHI) / (PHI + 2)
    points = np.column_stack([x, y, 2 * np.log(PHI) * u[:, 2], np.ones(500)])
    np.testing.assert_array_equal(lattice.contains(points), np.all(np.abs(u) <= 0.5, axis=1))


@given(monodromies())
def test_bundles_of_all_monodromies(monodromy):
    lattice = tl.torus_bundle(monodromy)
    m, trace = action(lattice), np.trace(monodromy)
    size = np.max(np.abs(m))
    # In its basis the level acts by whole numbers, and there the matrix has the same trace and determinant.
    np.testing.assert_allclose(m, np.round(m), rtol=0, atol=2e-15 * size)
    m = np.round(m).astype(int)
    assert np.trace(m) == trace and round(np.linalg.det(m)) == 1
    a_1, a_2 = (step(*a) for a in lattice.basis)
    b = lattice.inverses[4]
    for k, a in enumerate((a_1, a_2)):
        image = step(*(m[0, k] * lattice.basis[0] + m[1, k] * lattice.basis[1]))
        np.testing.assert_allclose(product(b, a, iso.inverse("sol", b)), image, rtol=0, atol=1e-15 * size)
    assert lattice.finite_volume and not lattice.is_dirichlet
    assert np.linalg.det(lattice.basis) == pytest.approx(AREA, rel=1e-13)
    large = max(abs(np.linalg.eigvals(np.array(monodromy))))
    assert lattice.levels[1] == -lattice.levels[0] == pytest.approx(np.log(large) / 2, rel=1e-9)
    np.testing.assert_array_equal(np.sign(np.diag(b)[:2]), np.sign(trace))
    # Near a square: equally spread along x and y, and no sum or difference of the translations is shorter.
    assert np.sum(lattice.basis[:, 0] ** 2) == pytest.approx(np.sum(lattice.basis[:, 1] ** 2), rel=1e-9)
    gram = lattice.basis @ lattice.basis.T
    assert abs(gram[0, 1]) <= 0.5 * min(gram[0, 0], gram[1, 1]) * (1 + 1e-9)
    _, elements, ok = lattice.teleport(random_points(50, 2.0, 2), 60)
    assert ok.all() and iso.residual("sol", elements) < 1e-12


def test_conjugate_monodromies_have_the_same_cell():
    """A sliver of Z^2 is no sliver of a cell: bases are changed until they are short."""
    far = np.linalg.matrix_power(R, 1000) @ [[2, 1], [1, 1]] @ np.linalg.matrix_power(R, -1000)
    found = tl.torus_bundle(far.tolist())
    gram = found.basis @ found.basis.T
    np.testing.assert_allclose(gram, AREA * np.eye(2), rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("monodromy", "index", "words"),
    [
        ([[2, 1], [1, 1], [0, 0]], None, "two rows of two whole numbers"),
        ([2, 1, 1, 1], None, "two rows of two whole numbers"),
        ([[2, 1], [1]], None, "two rows of two whole numbers"),
        ([[2, 1], [1.5, 1]], 1, "row 2 of the monodromy must be two whole numbers"),
        ([["2", 1], [1, 1]], 0, "row 1 of the monodromy"),
        ([[2, np.nan], [1, 1]], 0, "row 1 of the monodromy"),
        ([[2, 1], [1, 2]], None, "determinant of the monodromy is 3, so that it maps no torus"),
        (
            [[1, 1], [1, 0]],
            None,
            "determinant of the monodromy is -1: bundles that are glued",
        ),
        ([[1, 5], [0, 1]], None, "trace of the monodromy is 2, so that its bundle has the geometry nil"),
        ([[-1, 5], [0, -1]], None, "trace of the monodromy is -2, so that its bundle has the geometry nil"),
        ([[-1, 0], [0, -1]], None, "geometry e3; choose a + d above 2 or below -2"),
        ([[0, -1], [1, 0]], None, "trace of the monodromy is 0, so that its bundle has the geometry e3"),
        ([[0, -1], [1, GREATEST_TRACE + 1]], None, "trace of the monodromy is 1001: about as many cells"),
        ([[-GREATEST_TRACE - 1, -1], [1, 0]], None, "trace of the monodromy is -1001: about as many cells"),
    ],
)
def test_matrices_without_a_bundle(monodromy, index, words):
    with pytest.raises(tl.LatticeError) as caught:
        tl.torus_bundle(monodromy)
    assert (caught.value.what, caught.value.index) == ("monodromy", index)
    assert words in str(caught.value)


def test_the_least_and_the_greatest_trace():
    for trace in (3, -3, GREATEST_TRACE, -GREATEST_TRACE):
        assert np.trace(np.round(action(tl.torus_bundle([[0, -1], [1, trace]])))) == trace
    assert tl.torus_bundle(np.array([[2.0, 1.0], [1.0, 1.0]])).finite_volume


# --- the domains --------------------------------------------------------------------------------------------

# Pairs of sides, area of the parallelogram, height, vertices and edges.
SHAPE = {
    "anosov": (2, AREA, 2 * np.log(PHI), 8, 12),
    "xy-loops": (2, 1, np.inf, 0, 4),
    "z-loop": (0, np.inf, 2 * np.log(PHI), 0, 0),
}


@pytest.mark.parametrize("name", SHAPE)
def test_is_well_formed(name):
    lattice, (pairs, area, height, vertices, edges) = LATTICES[name], SHAPE[name]
    assert isinstance(lattice, Suspension) and lattice.name == name
    assert lattice.description and lattice.source
    levels = 2 * np.isfinite(height)
    assert len(lattice.walls) == 2 * pairs + levels
    assert lattice.level_walls == tuple(range(2 * pairs, 2 * pairs + levels))
    assert iso.residual("sol", lattice.maps) < 1e-15
    assert not lattice.walls.flags.writeable and not lattice.maps.flags.writeable
    assert lattice.levels[1] - lattice.levels[0] == pytest.approx(height, rel=1e-15)
    assert lattice.finite_volume == (np.isfinite(area) and np.isfinite(height))
    if pairs:
        assert abs(np.linalg.det(lattice.basis)) == pytest.approx(area, rel=1e-15)
    assert (len(tl.vertices(lattice)), len(tl.edges(lattice))) == (vertices, edges)
    for array in (lattice.walls, lattice.maps):
        assert not np.any(np.signbit(array) & (array == 0))


@each
def test_walls_corners_and_edges(name):
    lattice = LATTICES[name]
    assert lattice.contains(lattice.centre)
    sides = lattice.walls[: 2 * len(lattice.basis)]
    np.testing.assert_allclose(np.linalg.norm(sides[:, :2], axis=1), 1, rtol=1e-15)
    # Opposite walls, each pair carried along by the translations of the other one.
    np.testing.assert_array_equal(sides[::2, :2], -sides[1::2, :2])
    np.testing.assert_allclose(lattice.normals @ lattice.basis.T, np.diag(lattice.widths), rtol=0, atol=1e-15)
    for vertex in tl.vertices(lattice):
        heights = lattice.heights(vertex.vector)
        assert vertex.kind == "finite" and len(vertex.walls) == 3
        assert np.max(np.abs(heights[list(vertex.walls)])) < 1e-15
        assert np.max(np.delete(heights, vertex.walls)) < -0.1
    for edge in tl.edges(lattice):
        heights = lattice.heights(edge.point)
        assert np.max(np.abs(heights[list(edge.walls)])) < 1e-15 and np.max(heights) < 1e-15
        assert np.max(np.abs(lattice.walls[list(edge.walls)] @ edge.direction)) < 1e-15
        upright = not set(edge.walls) & set(lattice.level_walls)
        # z is perpendicular to levels, and the angle between sides is another at each of them.
        assert np.isnan(edge.angle) if upright else edge.angle == np.pi / 2
        known = [v.vector for v in tl.vertices(lattice)] if lattice.finite_volume else []
        for end in edge.ends if lattice.finite_volume else ():
            assert np.min(np.max(np.abs(known - end), axis=1)) < 1e-15


@each
def test_points_are_teleported_by_group_elements_in_few_steps(name):
    lattice = LATTICES[name]
    start = random_points(400, 4.0, 13)
    # Every level once, then each pair of sides: moves by the thousand are one step.
    height = np.subtract(*lattice.levels[::-1])
    steps = 6 + int(np.max(np.abs(start[:, 2])) / height)
    points, elements, ok = lattice.teleport(start, steps)
    assert ok.all() and lattice.contains(points, 1e-12).all()
    # Both round, by what stretches x and y on the way.
    stretch = np.max(np.abs(elements), axis=(1, 2))
    allowed = 1e-14 * stretch * np.max(np.abs(start), axis=1)
    assert np.all(np.max(np.abs(iso.act("sol", elements, start) - points), axis=1) <= allowed)
    assert iso.residual("sol", elements) < 1e-13


def test_one_crossing_after_the_other_would_take_thousands():
    lattice = LATTICES["anosov"]
    far = np.array([[3.0, 2.0, 8.5, 1.0]])
    _, element, ok = lattice.teleport(far, 12)
    assert ok.all()
    moves = np.linalg.solve(lattice.basis.T, element[0, :2, 3])
    np.testing.assert_allclose(moves, np.round(moves), atol=1e-9)
    assert np.max(np.abs(moves)) > 5000
    assert not lattice.teleport(far, 10)[2].any()
    assert not lattice.teleport(np.array([[np.nan, 0, 0, 1.0]]))[2].any()


@each
def test_teleporting_does_not_depend_on_the_path(name):
    lattice = LATTICES[name]
    points, rng = inside(lattice, 60, 14), np.random.default_rng(15)
    for _ in range(20):
        word = product(*lattice.maps[rng.integers(len(lattice.walls), size=5)])
        led, elements, ok = lattice.teleport(iso.act("sol", word, points))
        allowed = 1e-13 * np.max(np.abs(word)) ** 2
        assert ok.all()
        np.testing.assert_allclose(led, points, rtol=0, atol=allowed)
        one = iso.compose("sol", elements, word)
        np.testing.assert_allclose(one, np.broadcast_to(np.eye(4), one.shape), rtol=0, atol=allowed)


@each
def test_images_do_not_overlap_and_cover(name):
    """Every point next to the domain is in one image of it; those are the nearest elements."""
    lattice = LATTICES[name]
    low, high = np.clip(lattice.levels, -1, 1)
    points = inside(lattice, 100, 16)
    points[:, :2] *= 2
    points[:, 2] = np.random.default_rng(17).uniform(1.5 * low, 1.5 * high, 100)
    group = tl.elements(lattice, count=3000 if lattice.finite_volume else 300)
    images = lattice.contains(iso.act("sol", iso.inverse("sol", group)[:, None], points[None]))
    np.testing.assert_array_equal(images.sum(axis=0), 1)
    # And that one is where the point is led from.
    _, back, _ = lattice.teleport(points)
    np.testing.assert_allclose(
        iso.compose("sol", back, group[np.argmax(images, axis=0)]),
        np.broadcast_to(np.eye(4), back.shape),
        atol=1e-12,
    )


@each
def test_clearance_and_distance_are_lower_bounds(name, kernel):
    lattice = LATTICES[name]
    domain = inside(lattice, 80, 18)
    outside = random_points(400, 1.0, 19)
    outside = outside[~lattice.contains(outside)][:80]
    assert np.all(lattice.clearance(domain) > 0) and np.all(lattice.clearance(outside) < 0)
    distances = np.array([kernel.distance(outside, np.tile(p, (len(outside), 1))) for p in domain])
    assert np.all(lattice.clearance(domain) <= distances.min(axis=1) + 1e-9)
    assert not any(lattice.distance_from(p) for p in domain)
    from_outside = np.array([lattice.distance_from(q) for q in outside])
    assert np.all(from_outside > 0) and np.all(from_outside <= distances.min(axis=0) + 1e-9)
    assert np.all(-lattice.clearance(outside) <= from_outside + 1e-12)
    # Not far below it: exact at levels and at sides along x and y.
    for p in domain[:10]:
        walls = _on_walls(lattice, p, 3000)
        near = np.min(kernel.distance(walls, np.tile(p, (len(walls), 1))))
        assert 0.9 * near - 0.01 <= lattice.clearance(p) <= near + 1e-9
    assert lattice.inradius == lattice.clearance(lattice.centre)


def _on_walls(lattice, p, count):
    """Points on the planes of the walls about those of p: led there from about p across the planes."""
    rng = np.random.default_rng(20)
    near = random_points(count, 0.3, 21) * [[1, 1, 1, 0]] * rng.uniform(size=(count, 1)) ** 2 + ORIGIN
    points = iso.act("sol", iso.translation("sol", p), near)
    walls = lattice.walls[rng.integers(len(lattice.walls), size=count)]
    across = walls[:, :3] * np.exp(points[:, 2, None] * [2.0, -2.0, 0.0])
    across /= np.sum(across * walls[:, :3], axis=1, keepdims=True)
    points[:, :3] -= across * np.sum(walls * points, axis=1, keepdims=True)
    return points


def test_distances_to_coordinate_planes_are_exact():
    # Paper, lemmas 11.2 to 11.4.
    lattice = LATTICES["xy-loops"]
    for x, y, z, expected in (
        (0.1, 0.0, 0.7, np.arcsinh(0.4 * np.exp(-0.7))),
        (0.0, -0.2, 0.7, np.arcsinh(0.5 * np.exp(-0.7))),
        (0.0, -0.2, 0.0, np.arcsinh(0.3)),
        (0.7, 0.0, -0.3, np.arcsinh(-0.2 * np.exp(0.3))),
    ):
        assert lattice.clearance([x, y, z, 1]) == pytest.approx(expected, rel=1e-14)
    behind = np.arcsinh(0.2 * np.exp(0.3))
    assert lattice.distance_from([0.7, 0.0, -0.3, 1]) == pytest.approx(behind, rel=1e-14)
    slab = LATTICES["z-loop"]
    assert slab.clearance([5, -3, 0.1, 1]) == pytest.approx(np.log(PHI) - 0.1, rel=1e-14)
    assert slab.distance_from([5, -3, 1.1, 1]) == pytest.approx(1.1 - np.log(PHI), rel=1e-14)


def test_distance_from_an_edge(kernel):
    """Above the domain and beside it: farther than from either wall."""
    lattice = LATTICES["anosov"]
    corner = next(v.vector for v in tl.vertices(lattice) if v.walls == (0, 2, 4))
    out = corner + np.array([*(0.5 * lattice.normals[0]), 0.4, 0])
    edge = corner - np.linspace(0, 1, 400)[:, None] * [*lattice.basis[1], 0, 0]
    nearest = np.min(kernel.distance(edge, np.tile(out, (400, 1))))
    alone = -float(lattice.clearance(out))
    assert alone * 1.05 < lattice.distance_from(out) <= nearest


# --- the groups ---------------------------------------------------------------------------------------------


@each_closed
def test_cells_over_the_walls(name):
    """All that share a piece of a wall: those that points next to a wall are led back from, and no others."""
    lattice = LATTICES[name]
    over = lattice.over_walls
    u = np.random.default_rng(22).uniform(0, 1, (40000, 2))
    corners = np.array([c.vector[:2] for c in lattice.polygon.corners])
    first = corners[np.argmin(corners @ (lattice.normals[0] + lattice.normals[1]))]
    points = np.tile(ORIGIN, (len(u), 1))
    points[:, :2] = first + u @ lattice.basis
    found = [lattice.inverses[: 2 * len(lattice.basis)]]
    for level, sign in zip(lattice.levels, (-1, 1), strict=True):
        points[:, 2] = level + sign * 1e-9
        _, back, ok = lattice.teleport(points)
        assert ok.all()
        keys = np.round(back.reshape(len(back), -1), 5) + 0.0
        _, which = np.unique(keys, axis=0, return_index=True)
        found.append(iso.inverse("sol", back[which]))
    found = np.concatenate(found)
    gaps = np.max(np.abs(found[:, None] - over[None]), axis=(2, 3))
    assert np.max(np.min(gaps, axis=1)) < 1e-9, "one is left out"
    # Pieces that are too small for points to fall on them are few.
    assert len(found) <= len(over) <= 1.1 * len(found)
    np.testing.assert_array_equal(tl.neighbours(lattice)[1:], over)


def test_cells_that_touch_in_a_corner_share_no_wall():
    """From both sides of what counts as a corner: a square, and others over it that are moved by a little."""
    square = suspension("", np.eye(2), iso.translation("sol", np.array([0.0, 0, 1e-12, 1])), "", "")
    for shift, cells in ((0.0, 1), (0.5 * TOUCH, 1), (2 * TOUCH, 2), (0.5, 2)):
        over = square._over_level(iso.translation("sol", np.array([shift, 0, 1e-12, 1])))
        assert len(over) == cells


@each
def test_elements_are_all_sorted_and_distinct(name, kernel):
    lattice = LATTICES[name]
    group = tl.elements(lattice, count=300)
    np.testing.assert_array_equal(group[0], iso.identity("sol"))
    assert iso.residual("sol", group) < 1e-13
    points = iso.act("sol", group, lattice.centre)
    radii = orbit_radius("sol", points)
    np.testing.assert_allclose(radii, kernel.distance(points), rtol=1e-12)
    assert np.all(np.diff(radii) > -1e-6)
    if name == "z-loop":
        assert len(group) == 2 * int(FARTHEST / (2 * np.log(PHI))) + 1
        return
    assert len(group) == 300
    gaps = np.linalg.norm(points[:, None] - points, axis=2) + 10 * np.eye(len(points))
    assert np.min(gaps) > 1.999 * np.min(np.abs(lattice.heights(lattice.centre)))
    np.testing.assert_array_equal(tl.elements(lattice, count=40), group[:40])
    k = 99 + int(np.argmax(np.diff(radii[99:])))
    between = float((radii[k] + radii[k + 1]) / 2)
    np.testing.assert_array_equal(tl.elements(lattice, radius=between), group[: k + 1])
    # None is missed of those that five steps lead to, or of a large piece of the orbit.
    words = [np.eye(4)[None]]
    for _ in range(4):
        longer = iso.compose("sol", words[-1][:, None], tl.neighbours(lattice)[1:]).reshape(-1, 4, 4)
        _, which = np.unique(np.round(longer[:, :3, 3], 5) + 0.0, axis=0, return_index=True)
        words.append(longer[which][:4000])
    others = iso.act("sol", np.concatenate(words), lattice.centre)
    others = others[kernel.distance(others) <= between - 1e-6]
    assert len(others) > 10
    assert np.max(np.min(np.linalg.norm(others[:, None] - points, axis=2), axis=1)) < 1e-9


def test_elements_of_the_cat_map(kernel):
    # All points of the lattice at all levels of it are the orbit.
    lattice = LATTICES["anosov"]
    r = np.arange(-60, 61)
    i, j, k = (v.ravel() for v in np.meshgrid(r, r, np.arange(-3, 4), indexing="ij"))
    points = np.column_stack([np.column_stack([i, j]) @ lattice.basis, 2 * np.log(PHI) * k, np.ones(len(i))])
    count = np.count_nonzero(kernel.distance(points) <= 3.0)
    assert len(tl.elements(lattice, radius=3.0)) == count > 500
    with pytest.raises(ValueError, match="may be infinite"):
        tl.elements(lattice)


@each
def test_cell_table_and_paths(name):
    lattice = LATTICES[name]
    cells, following = tl.cell_table(lattice, 300)
    np.testing.assert_array_equal(cells, tl.elements(lattice, count=300))
    assert following.shape == (len(cells), len(lattice.walls))
    k, f = np.nonzero(following < len(cells))
    assert len(k) > len(cells)
    expected = iso.compose("sol", cells[k], lattice.inverses[f])
    scale = np.max(np.abs(expected), axis=(1, 2))
    assert np.max(np.max(np.abs(cells[following[k, f]] - expected), axis=(1, 2)) / scale) < 1e-12
    # There and back again.
    opposite = np.arange(len(lattice.walls)) ^ 1
    np.testing.assert_array_equal(following[following[k, f], opposite[f]], k)
    wanted = np.concatenate([lattice.over_walls, cells[1:]])
    for element, path in zip(wanted, tl.paths(lattice, wanted), strict=True):
        np.testing.assert_allclose(product(*lattice.inverses[list(path)]), element, rtol=0, atol=1e-12)


# --- lattices given by hand ---------------------------------------------------------------------------------


@each
def test_from_matrices_takes_every_lattice(name):
    lattice = LATTICES[name]
    noise = 1 + 1e-11 * np.random.default_rng(18).uniform(-1, 1, lattice.maps.shape)
    # Levels first: they are put behind the sides.
    order = [*lattice.level_walls, *range(2 * len(lattice.basis))]
    given = tl.from_matrices("sol", (lattice.maps * noise)[order], 3.7 * lattice.walls[order])
    size = np.max(np.abs(lattice.maps))
    np.testing.assert_allclose(given.walls, lattice.walls, rtol=0, atol=1e-9)
    np.testing.assert_allclose(given.maps, lattice.maps, rtol=0, atol=1e-9 * size)
    assert given.level_walls == lattice.level_walls
    assert iso.residual("sol", given.maps) < 2e-15


def put(array, index, value):
    array[index] = value


CAT = LATTICES["anosov"]


@pytest.mark.parametrize(
    ("spoil", "what", "index", "words"),
    [
        (lambda m, w: put(m, (1, 3, 2), 1), "generators", 1, "last row must be [0, 0, 0, 1]"),
        (lambda m, w: put(m, (2, 2, 0), 1), "generators", 2, "third row must be [0, 0, e, c]"),
        (lambda m, w: put(m, (2, 0, 2), 1), "generators", 2, "third column 0 above e"),
        (lambda m, w: put(m, (4, 2, 2), 2), "generators", 4, "with e = 1 or -1"),
        (lambda m, w: put(m, (4, 0, 0), 0.39), "generators", 4, "[[+-exp(c), 0], [0, +-exp(-c)]]"),
        (lambda m, w: put(m, (4, 2, 3), -0.9), "generators", 4, "give all digits of irrational entries"),
        (lambda m, w: put(m, (4, 2, 2), -1), "generators", 4, "[[0, +-exp(c)], [+-exp(-c), 0]]"),
        (
            lambda m, w: put(w, (1, 2), 0.1),
            "domain",
            1,
            "neither a side [a, b, 0, d] nor a level [0, 0,",
        ),
        (lambda m, w: put(w, (5, 0), 0.1), "domain", 5, "walls cannot lean in sol"),
        (lambda m, w: put(w, 1, [0, 0, 0, 1]), "domain", 1, "a, b must not both be 0"),
        (lambda m, w: put(w, 2, -w[2]), "domain", 2, "origin inside: d must be negative"),
        (lambda m, w: (m[[0, 2, 3, 4, 5]], w[[0, 2, 3, 4, 5]]), "generators", 0, "has no inverse"),
        (lambda m, w: (m[4:5], w[4:5]), "generators", 0, "has no inverse"),
        (lambda m, w: put(m, [0, 1], m[[1, 0]]), "generators", 0, "moves the wrong way"),
        (lambda m, w: put(m, [4, 5], m[[5, 4]]), "generators", 4, "moves the wrong way"),
        (lambda m, w: put(w, (4, 3), -0.4), "domain", 4, "does not fit its generator"),
        (lambda m, w: put(w, (2, 3), -0.2), "domain", 2, "does not fit its generator"),
        (
            lambda m, w: put(m, [0, 1], m[[4, 5]]),
            "generators",
            0,
            "over a side but is no translation",
        ),
        (
            lambda m, w: put(m, [4, 5], [m[4] @ flip, m[5] @ flip]),
            "generators",
            4,
            "reverses z, which is not supported",
        ),
        (
            lambda m, w: (np.concatenate([m, m[4:]]), np.concatenate([w, w[4:]])),
            "generators",
            6,
            "is the same as number 5",
        ),
        (
            lambda m, w: (
                np.array([*m, step(3, 0), step(-3, 0)]),
                np.array([*w, [-1, 0, 0, -1.5], [1, 0, 0, -1.5]]),
            ),
            "domain",
            6,
            "does not bound the domain",
        ),
        # A hexagon tiles the plane by three translations.
        (
            lambda m, w: (
                np.array([step(*(-s * n)) for n in HEXAGON for s in (1, -1)]),
                np.array([[*(s * n), 0, -0.5] for n in HEXAGON for s in (1, -1)]),
            ),
            "domain",
            4,
            "is one side too many",
        ),
        # Bricks laid over each other by a half.
        (
            lambda m, w: (
                np.array([step(-1, -0.5), step(1, 0.5), step(0, -1), step(0, 1)]),
                np.array([[1, 0, 0, -0.5], [-1, 0, 0, -0.5], [0, 1, 0, -0.5], [0, -1, 0, -0.5]]),
            ),
            "generators",
            0,
            "moves the domain across half-space 3 by 0.5; let that half-space",
        ),
        (lambda m, w: (m[2:], w[2:]), "generators", 2, "stretches the translation of the sides"),
        (
            lambda m, w: (
                np.array([*LATTICES["xy-loops"].maps, *m[4:]]),
                np.array([*LATTICES["xy-loops"].walls, *w[4:]]),
            ),
            "generators",
            4,
            "acts as [[2.61803, 0], [0, 0.381966]] and not by whole numbers",
        ),
        (lambda m, w: put(m, (0, 0, 0), np.nan), "generators", 0, "not finite"),
        (lambda m, w: (m, w[:3]), "domain", None, "6 generators but 3 half-spaces"),
        (lambda m, w: (m[:, :3], w), "generators", None, "must be a list of 4x4 matrices"),
    ],
)
def test_from_matrices_says_what_is_wrong(spoil, what, index, words):
    maps, walls = CAT.maps.copy(), CAT.walls.copy()
    maps, walls = spoil(maps, walls) or (maps, walls)
    with pytest.raises(tl.LatticeError) as caught:
        tl.from_matrices("sol", maps, walls)
    assert words in str(caught.value)
    assert (caught.value.what, caught.value.index) == (what, index)


flip = iso.stabilizer("sol", D8[4])
HEXAGON = [np.array([np.cos(a), np.sin(a)]) for a in (0, np.pi / 3, 2 * np.pi / 3)]


def test_tolerances_of_given_numbers_from_both_sides():
    for off, good in ((3e-9, True), (3e-8, False)):
        maps, walls = CAT.maps.copy(), CAT.walls.copy()
        maps[0, 0, 3] += off
        maps[1, 0, 3] -= off
        walls[:2, 3] -= 0.5 * off * walls[0, 0]
        if good:
            assert tl.from_matrices("sol", maps, walls, 1e-9).finite_volume
        else:
            with pytest.raises(tl.LatticeError):
                tl.from_matrices("sol", maps, walls, 1e-9)
    for depth, words in ((0.5 * INSIDE, "origin inside"), (2 * INSIDE, "does not fit")):
        walls = CAT.walls.copy()
        walls[0, 3] = -depth
        with pytest.raises(tl.LatticeError, match=words):
            tl.from_matrices("sol", CAT.maps, walls)
    for trace, good in ((GREATEST_TRACE, True), (GREATEST_TRACE + 1, False)):
        m = np.array([[0, -1], [1, trace]])
        values, vectors = np.linalg.eig(m)
        basis = np.linalg.inv(vectors[:, np.argsort(-values)]).T
        climb = iso.translation("sol", np.array([0, 0, np.log(np.max(values)), 1]))
        made = suspension("", basis, climb, "", "")
        if good:
            assert tl.from_matrices("sol", made.maps, made.walls).finite_volume
        else:
            with pytest.raises(tl.LatticeError, match="the trace 1001"):
                tl.from_matrices("sol", made.maps, made.walls)


def test_glides_and_shifts_are_taken():
    glide, moved = LATTICES["glide"], LATTICES["off-centre"]
    np.testing.assert_allclose(action(glide), [[1, 1], [1, 0]], atol=1e-15)
    assert np.linalg.det(iso.vector_map("sol", glide.maps[4])[:3, :3]) == -1
    assert moved.levels == pytest.approx((-np.log(PHI) - 0.2, np.log(PHI) - 0.2))
    assert len(moved.over_walls) > 10
    # The square of the golden bundle's map is the cat map's.
    np.testing.assert_allclose(action(glide) @ action(glide), action(CAT), atol=1e-14)


# --- names and scenes ---------------------------------------------------------------------------------------


def test_names():
    assert tl.names("sol") == ["anosov", "xy-loops", "z-loop"]
    for alias in ("Anosov torus bundle", "cat map", "Arnold cat map", "mappingTorus", "Torus_Bundle"):
        assert tl.named("sol", alias) is tl.named("sol", "anosov")
    assert tl.named("sol", "horizontalLoops").name == "xy-loops"
    for alias, name in tl._ALIASES["sol"].items():
        assert name in tl.names("sol") and alias not in tl.names("sol")
    with pytest.raises(tl.LatticeError, match="'anosov' is in sol"):
        tl.named("nil", "anosov")
    with pytest.raises(tl.LatticeError, match="is a prism"):
        tl.edge_cycles(tl.named("sol", "anosov"))


def scene(manifold, geometry="sol"):
    return load_text(f"geometry: {geometry}\nobjects: [ball: {{radius: 0.1}}]\nmanifold: {manifold}\n")


def test_bundles_in_scenes():
    lattice = scene("{monodromy: [[2, 1], [1, 1]]}").lattice
    np.testing.assert_array_equal(lattice.walls, CAT.walls)
    assert lattice.name == "torus bundle of [[2, 1], [1, 1]]"
    assert scene("{monodromy: [[-5, -2], [-2, -1.0]]}").lattice.maps[4, 0, 0] < 0
    again = load_text(scene("{monodromy: [[3, 1], [2, 1]]}").effective_text())
    assert again.manifold.monodromy == ((3, 1), (2, 1))


@pytest.mark.parametrize(
    ("manifold", "geometry", "at", "message", "help"),
    [
        (
            "{monodromy: [[2, 1], [1, 2]]}",
            "sol",
            "3:23",
            "the determinant of the monodromy is 3",
            "a d - b c = 1",
        ),
        ("{monodromy: [[1, 1], [1, 0]]}", "sol", "3:23", "is -1: bundles that are glued", "take its square"),
        ("{monodromy: [[1, 1], [0, 1]]}", "sol", "3:23", "has the geometry nil", "choose a + d above 2"),
        ("{monodromy: [[2, 1], [1, 1.5]]}", "sol", "3:36", "expected a whole number, found 1.5", ""),
        (
            "{monodromy: [[2, 1], [1]]}",
            "sol",
            "3:32",
            "expected a row of 2 whole numbers, found 1",
            "[[2, 1]",
        ),
        ("{monodromy: [[2, 1]]}", "sol", "3:23", "expected 2 rows of 2 whole numbers, found 1 rows", ""),
        ("{monodromy: 7}", "sol", "3:23", "expected 2 rows of 2 whole numbers, found 7", ""),
        (
            "{monodromy: [[2, 1], [1, 1]]}",
            "h3",
            "3:12",
            "has the geometry sol, not h3",
            "write geometry: sol",
        ),
        (
            "{monodromy: [[2, 1], [1, 1]], domain: []}",
            "sol",
            "3:41",
            "unknown key 'domain'",
            "follow from the",
        ),
        ("anosv", "sol", "3:11", "sol has no manifold 'anosv'", "did you mean 'anosov'?"),
        ("heisenberg", "sol", "3:11", "sol has no manifold", "has the geometry nil"),
    ],
)
def test_mistakes_in_scenes(manifold, geometry, at, message, help):
    with pytest.raises(SceneError) as caught:
        scene(manifold, geometry)
    (found,) = caught.value.diagnostics
    assert f"{found.line}:{found.column}" == at
    assert message in found.message and help in (found.help or "")


@pytest.mark.parametrize(
    ("name", "manifold"), [("anosov", "anosov"), ("bundle", "{monodromy: [[-4, -3], [-1, -1]]}")]
)
def test_images_of_balls_over_walls(name, manifold, kernel):
    """All images of a ball that reach into the cell are seen, and not many more."""
    ball = "{ball: {radius: 0.3}, at: [0.1, 0.15, 0.3]}"
    made = load_text(f"geometry: sol\nmanifold: {manifold}\nobjects: [{ball}]\n")
    lattice, place = made.lattice, Placement(kernel)
    centre, carried, _ = lattice.teleport(place.point(made.objects[0].at)[None])
    found = images(made.objects[0], carried[0], choose_near_walls(made), lattice, place)
    centres = iso.act("sol", tl.elements(lattice, count=3000)[1:], centre[0])
    points = inside(lattice, 800, 25)
    reached = [kernel.distance(points, np.tile(c, (800, 1))).min() < 0.3 for c in centres[:400]]
    seen = iso.act("sol", found, centre[0])
    gaps = np.linalg.norm(centres[:400][reached][:, None] - seen, axis=2).min(axis=1)
    assert np.max(gaps) < 1e-12, "one is left out"
    assert np.count_nonzero(reached) <= len(seen) <= 1.6 * np.count_nonzero(reached)


# --- the walls in kernels -----------------------------------------------------------------------------------

WIDTHS = [("double", 1), ("double", 8), ("single", 16)]


class Walls:
    """outside_cell, teleport and wall_time of a lattice, compiled."""

    def __init__(self, lattice, device, precision, lanes):
        self.lattice, self.device, self.lanes = lattice, device, lanes
        self.cells, self.following = tl.cell_table(lattice, 3000)
        self.dtype = np.float64 if precision == "double" else np.float32
        numbers, lines = Numbers([0.0]), []
        writer = SimpleNamespace(
            lattice=lattice,
            numbers=numbers,
            cell_ids=True,
            creeping=True,
            function=lambda head, body: lines.extend([f"FN {head}", "{", *body, "}"]),
        )
        write_walls(writer)
        text = "\n".join(
            [
                "FN real scene_distance(point p, vector v, scene_data scene) { return REAL(0); }",
                *lines,
                "__kernel void walls(__global const scalar *in, __global scalar *out, int stride,"
                " __constant const scalar *numbers, __global const int *next_cell)",
                "{",
                "  size_t packet = get_global_id(0);",
                "  scene_data scene = {numbers, next_cell, 0};",
                "#define IN(c) LOAD(packet, in + (size_t)(c) * stride)",
                "#define OUT(c, v) STORE(v, packet, out + (size_t)(c) * stride)",
                "  point p = {IN(0), IN(1), IN(2), REAL(1)};",
                "  vector v = {IN(3), IN(4), IN(5), REAL(0)};",
                "  ray r = new_ray(p, v);",
                "  OUT(0, SELECT(outside_cell(p, scene), REAL(1), REAL(0)));",
                "  OUT(1, wall_time(p, v, scene));",
                "  for (int k = 0; k < 16; k++) teleport(&r, scene);",
                "  OUT(2, r.p.x); OUT(3, r.p.y); OUT(4, r.p.z);",
                "  OUT(5, r.v.x); OUT(6, r.v.y); OUT(7, r.v.z); OUT(8, r.cell);",
                "  OUT(9, SELECT(outside_cell(r.p, scene), REAL(1), REAL(0)));",
                "}",
            ]
        )
        parts = (*geometry_parts("sol"), "scene_types.h", "flow/exact.h", "march.h", "cells.h", "walls")
        defines = {"WALLS": len(lattice.walls), "CELLS": len(self.cells)}
        self.program = build(device, Source(parts, defines, {"walls": text}), precision, lanes)
        self.numbers = np.array(numbers.values, self.dtype)

    def run(self, points, directions):
        rows = np.column_stack([points[:, :3], directions]).T.astype(self.dtype)
        packet = self.lanes * LOCAL_SIZE
        stride = -(-rows.shape[1] // packet) * packet
        data = np.zeros((6, stride), self.dtype)
        data[:, : rows.shape[1]] = rows
        result = np.empty((10, stride), self.dtype)
        flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
        source, numbers, table = (
            cl.Buffer(self.device.context, flags, hostbuf=np.ascontiguousarray(a))
            for a in (data, self.numbers, self.following)
        )
        target = cl.Buffer(self.device.context, cl.mem_flags.WRITE_ONLY, result.nbytes)
        kernel = cl.Kernel(self.program, "walls")
        kernel.set_args(source, target, np.int32(stride), numbers, table)
        cl.enqueue_nd_range_kernel(self.device.queue, kernel, (stride // self.lanes,), (LOCAL_SIZE,))
        cl.enqueue_copy(self.device.queue, result, target)
        return result[:, : rows.shape[1]].T.astype(np.float64)


@pytest.mark.parametrize(("precision", "lanes"), WIDTHS)
@pytest.mark.parametrize("name", ["anosov", "xy-loops", "z-loop", "-[[27,8],[10,3]]", "off-centre", "glide"])
def test_walls_in_kernels(name, precision, lanes, opencl_device, kernel):
    lattice = LATTICES[name]
    walls = Walls(lattice, opencl_device, precision, lanes)
    epsilon = np.finfo(walls.dtype).eps
    rng = np.random.default_rng(23)
    points = random_points(2000, 0.8, 24).astype(walls.dtype).astype(np.float64)
    u = rng.normal(size=(len(points), 3))
    u = (u / np.linalg.norm(u, axis=1, keepdims=True)).astype(walls.dtype).astype(np.float64)
    out = walls.run(points, u)
    np.testing.assert_array_equal(out[:, 0] == 1, ~lattice.contains(points))
    assert not out[:, 9].any()

    # Led back to the same point by the same element, but where rounding chose another side of a wall.
    led, elements, _ = lattice.teleport(points)
    stretch = np.max(np.abs(elements), axis=(1, 2))
    same = np.max(np.abs(out[:, 2:5] - led[:, :3]), axis=1) < 100 * epsilon * stretch
    assert same.mean() > (0.99 if precision == "single" else 0.999)
    turned = np.einsum("nij,nj->ni", iso.vector_map("sol", elements)[:, :3, :3], u)
    np.testing.assert_array_equal(out[same, 5:8], turned[same])

    # The cell that was counted along the way, where the table has it, and it has most.
    cells = out[:, 8].astype(int)
    known = same & (cells < len(walls.cells))
    assert known.mean() > 0.7
    one = iso.compose("sol", elements[known], walls.cells[cells[known]])
    assert np.max(np.abs(one - np.eye(4))) < 1e-9

    # Rays are inside for the time that is said, and some are out soon after.
    home = lattice.contains(points)
    times = out[home, 1]
    assert np.all(times > 0)
    reached = [kernel.flow(u[home], times * part, base=points[home])[0] for part in (0.5, 0.9, 0.999)]
    slack = 200 * epsilon * (1 + np.max(np.abs(points[home]), axis=1))
    for ends in reached:
        assert np.all(np.max(lattice.heights(ends), axis=1) <= slack)


def test_numbers_are_shared_between_bundles(opencl_device):
    """Bundles are one program with other numbers, but for the signs of the level's map."""

    def text(lattice):
        lines = []
        writer = SimpleNamespace(
            lattice=lattice,
            numbers=Numbers([0.0]),
            cell_ids=False,
            creeping=True,
            function=lambda head, body: lines.extend([head, *body]),
        )
        write_walls(writer)
        return lines

    first, second = (text(tl.torus_bundle(m)) for m in ([[3, 1], [2, 1]], [[4, 1], [3, 1]]))
    assert first == second
    assert sum("rint" in line for line in first) == 2
    assert not any("SELECT(plus" in line for line in first if "r->p.x" in line)
