"""Groups, domains and named manifolds: relations, homology, tilings, cells, and the words of the errors."""

import mpmath
import numpy as np
import pytest
from scipy.spatial import ConvexHull

from thurston_cl import lattice as tl
from thurston_cl.errors import ThurstonError
from thurston_cl.lattice.forms import CURVATURE, ORIGIN, dot, form, keeps_sheet
from thurston_cl.lattice.isometry import on_model, residual

NAMED = [(geometry, name) for geometry in CURVATURE for name in tl.names(geometry)]
MANIFOLDS = [pair for pair in NAMED if pair not in (("h3", "ideal-cube"), ("h3", "hyperideal-cube"))]
each = pytest.mark.parametrize(("geometry", "name"), NAMED)

# First homology, rank of the free part and torsion: Wolf (e3), the abelianised groups (s3), Weber and Seifert
# 1933 (h3).
HOMOLOGY = {
    "three-torus": (3, []),
    "half-turn": (1, [2, 2]),
    "quarter-turn": (1, [2]),
    "hantzsche-wendt": (0, [4, 4]),
    "klein-bottle-x-circle": (2, [2]),
    "quaternion": (0, [2, 2]),
    "binary-tetrahedral": (0, [3]),
    "poincare": (0, []),
    "seifert-weber": (0, [5, 5, 5]),
}
# Per manifold: faces, edges, vertices, kind of vertices, dihedral angle in degrees.
SHAPE = {
    "three-torus": (6, 12, 8, "finite", 90),
    "half-turn": (6, 12, 8, "finite", 90),
    "quarter-turn": (6, 12, 8, "finite", 90),
    "hantzsche-wendt": (12, 24, 14, "finite", 120),
    "klein-bottle-x-circle": (6, 12, 8, "finite", 90),
    "quaternion": (6, 12, 8, "finite", 120),
    "binary-tetrahedral": (8, 12, 6, "finite", 120),
    "poincare": (12, 30, 20, "finite", 120),
    "seifert-weber": (12, 30, 20, "finite", 72),
    "ideal-cube": (6, 12, 8, "ideal", 60),
    "hyperideal-cube": (6, 12, 8, "hyperideal", 45),
}
ORDER = {"quaternion": 8, "binary-tetrahedral": 24, "poincare": 120}


def homology(generators, relations):
    """Rank and torsion of the abelianised group, by the Smith normal form of the exponent sums."""
    rows = [[word.count(n) - word.count(-n) for n in range(1, generators + 1)] for word in relations]
    invariants = []
    while any(any(row) for row in rows):
        # The smallest entry becomes the pivot; reduce its row and column until they are 0.
        _, i, j = min((abs(v), i, j) for i, row in enumerate(rows) for j, v in enumerate(row) if v)
        rows[0], rows[i] = rows[i], rows[0]
        for row in rows:
            row[0], row[j] = row[j], row[0]
        pivot = rows[0][0]
        for row in rows[1:]:
            factor = row[0] // pivot
            row[:] = [a - factor * b for a, b in zip(row, rows[0], strict=True)]
        for column in range(1, len(rows[0])):
            factor = rows[0][column] // pivot
            for row in rows:
                row[column] -= factor * row[0]
        if any(rows[0][1:]) or any(row[0] for row in rows[1:]):
            continue
        stubborn = next((row for row in rows[1:] if any(v % pivot for v in row)), None)
        if stubborn is not None:
            rows[0] = [a + b for a, b in zip(rows[0], stubborn, strict=True)]
            continue
        invariants.append(abs(pivot))
        rows = [row[1:] for row in rows[1:]]
    return generators - len(invariants), [n for n in invariants if n > 1]


def random_points(geometry, count, size, seed):
    """Points of the model, uniform on s3, within `size` of the origin elsewhere."""
    rng = np.random.default_rng(seed)
    if geometry == "s3":
        return on_model("s3", rng.normal(size=(count, 4)))
    u = rng.normal(size=(count, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    r = size * rng.random((count, 1)) ** (1 / 3)
    return on_model(geometry, np.hstack([u * (np.sinh(r) if geometry == "h3" else r), np.ones((count, 1))]))


def precise_distance(geometry, p, q):
    """Distance of two points at 40 digits, after putting the rounded points back on the model."""
    with mpmath.workdps(40):
        a, b = ([mpmath.mpf(float(c)) for c in v] for v in (p, q))
        if geometry == "e3":
            return float(mpmath.norm([x - y for x, y in zip(a[:3], b[:3], strict=True)]))
        if geometry == "h3":
            a[3], b[3] = (mpmath.sqrt(1 + sum(x * x for x in v[:3])) for v in (a, b))
            return float(mpmath.acosh(a[3] * b[3] - sum(x * y for x, y in zip(a[:3], b[:3], strict=True))))
        a, b = ([x / mpmath.norm(v) for x in v] for v in (a, b))
        return float(mpmath.acos(sum(x * y for x, y in zip(a, b, strict=True))))


def test_smith_normal_form():
    assert homology(2, [(1, 1), (1, 1, 1, 1), (2, 2, 2, 2, 2, 2)]) == (0, [2, 6])
    assert homology(2, [(1, 1), (2, 2, 2)]) == (0, [6])
    assert homology(2, [(1, 1, 1, 1, 2, 2, -1, -1)]) == (1, [2])
    assert homology(3, [(1, 2, -1, -2)]) == (3, [])


# --- the domains --------------------------------------------------------------------------------------------


@each
def test_is_well_formed(geometry, name):
    lattice = tl.named(geometry, name)
    assert (lattice.geometry, lattice.name) == (geometry, name)
    assert lattice.description and lattice.source
    assert lattice.is_dirichlet and lattice.contains(lattice.centre[None]).all()
    assert residual(geometry, lattice.maps) < 1e-14
    assert keeps_sheet(geometry, lattice.maps)
    assert np.max(np.abs(dot(geometry, lattice.walls, lattice.walls) - 1)) < 1e-14
    assert not lattice.walls.flags.writeable and not lattice.maps.flags.writeable
    for f, g in enumerate(lattice.partner):
        assert lattice.partner[g] == f and f // 2 == g // 2 and f != g
        assert np.max(np.abs(lattice.maps[f] @ lattice.maps[g] - np.eye(4))) < 1e-13
        # The map carries its plane to the partner's with the sides exchanged.
        assert np.max(np.abs(lattice.walls[f] @ lattice.maps[g] + lattice.walls[g])) < 1e-14


@each
def test_shape(geometry, name):
    lattice = tl.named(geometry, name)
    faces, edges, vertices, kind, degrees = SHAPE[name]
    assert len(lattice.walls) == faces
    assert len(tl.edges(lattice)) == edges
    assert len(tl.vertices(lattice)) == vertices
    assert {v.kind for v in tl.vertices(lattice)} == {kind}
    np.testing.assert_allclose([e.angle for e in tl.edges(lattice)], np.radians(degrees), rtol=1e-13)


@each
def test_zeros_and_ones_are_exact(geometry, name):
    lattice = tl.named(geometry, name)
    for array in (lattice.walls, lattice.maps):
        halves = np.round(2 * array) / 2
        assert np.all((array == halves) | (np.abs(array - halves) > 1e-6))
        assert not np.any(np.signbit(array) & (array == 0))


@pytest.mark.parametrize(("geometry", "name"), [p for p in NAMED if SHAPE[p[1]][0] == 6])
def test_faces_of_cubes_are_ordered(geometry, name):
    normals = tl.named(geometry, name).walls[:, :3]
    assert (np.sign(normals) == np.kron(np.eye(3), [[1], [-1]])).all()


@each
def test_vertices_and_edges_lie_on_their_walls(geometry, name):
    lattice = tl.named(geometry, name)
    k = CURVATURE[geometry]
    for vertex in tl.vertices(lattice):
        heights = lattice.walls @ vertex.vector
        assert np.max(np.abs(heights[list(vertex.walls)])) < 1e-13
        assert np.max(np.delete(heights, vertex.walls), initial=-1) < -0.1
        square = float(dot(geometry, vertex.vector, vertex.vector)) if k else vertex.vector[3]
        expected = {"finite": k or 1, "ideal": 0, "hyperideal": 1}[vertex.kind]
        assert square == pytest.approx(expected, abs=1e-13)
        assert vertex.kind != "ideal" or vertex.vector[3] == pytest.approx(1, abs=1e-15)
    known = np.array([v.vector for v in tl.vertices(lattice)])
    for edge in tl.edges(lattice):
        on = lattice.walls[list(edge.walls)] @ np.array([edge.point, edge.direction, *edge.ends]).T
        assert np.max(np.abs(on)) < 1e-13
        assert edge.direction[3] == 0 and np.linalg.norm(edge.direction) == pytest.approx(1, abs=1e-15)
        # Nearest to the origin: the direction is orthogonal to the one from the origin.
        assert abs(edge.point[:3] @ edge.direction[:3]) < 1e-14
        assert lattice.contains(edge.point[None], 1e-13).all()
        for end, sense in zip(edge.ends, (-1, 1), strict=True):
            assert np.min(np.max(np.abs(known - end), axis=1)) < 1e-13
            assert sense * end[:3] @ edge.direction[:3] > 0


@pytest.mark.parametrize("name", tl.names("e3"))
def test_volume_e3(name):
    volume = 2 if name == "hantzsche-wendt" else 1
    corners = [v.vector[:3] for v in tl.vertices(tl.named("e3", name))]
    assert ConvexHull(corners).volume == pytest.approx(volume, rel=1e-12)


@pytest.mark.parametrize("name", tl.names("s3"))
def test_volume_s3(name):
    # The share of the sphere that is inside: 1/|G| within four standard deviations.
    count = 200_000
    inside = np.count_nonzero(tl.named("s3", name).contains(random_points("s3", count, 0, seed=1)))
    share = 1 / ORDER[name]
    assert abs(inside / count - share) < 4 * np.sqrt(share * (1 - share) / count)


def test_face_distances_of_the_hyperbolic_cubes():
    # sinh(d)^2 = cos(dihedral angle); the wall's last number is -sinh(d).
    np.testing.assert_allclose(tl.named("h3", "ideal-cube").walls[:, 3] ** 2, 0.5, rtol=1e-14)
    np.testing.assert_allclose(tl.named("h3", "hyperideal-cube").walls[:, 3] ** 2, np.sqrt(0.5), rtol=1e-14)


@each
def test_clearance(geometry, name):
    lattice = tl.named(geometry, name)
    # Straight from the origin at a wall, which is half-way to the neighbour's centre.
    for wall, step in zip(lattice.walls, lattice.inverses, strict=True):
        half = precise_distance(geometry, ORIGIN, step @ ORIGIN) / 2
        assert lattice.clearance(ORIGIN[None])[0] <= half + 1e-14
        u = wall[:3] / np.linalg.norm(wall[:3])
        for t in (0.9 * half, 1.05 * half):
            s, c = {"e3": (t, 1), "s3": (np.sin(t), np.cos(t)), "h3": (np.sinh(t), np.cosh(t))}[geometry]
            assert lattice.clearance(np.append(s * u, c)[None])[0] == pytest.approx(half - t, abs=1e-13)


# --- the groups ---------------------------------------------------------------------------------------------


@each
def test_edge_cycles(geometry, name):
    lattice = tl.named(geometry, name)
    cycles = tl.edge_cycles(lattice)
    order = 1 if (geometry, name) in MANIFOLDS else 2
    assert sorted(e for c in cycles for e in c.edges) == list(range(len(tl.edges(lattice))))
    for cycle in cycles:
        assert cycle.angle == pytest.approx(2 * np.pi / order, rel=1e-12)
        assert cycle.order == order
        power = np.linalg.matrix_power(cycle.transformation, order)
        assert np.max(np.abs(power - np.eye(4))) < 1e-12
        assert order == 1 or np.max(np.abs(cycle.transformation - np.eye(4))) > 1


@each
def test_relations_hold(geometry, name):
    generators, relations = tl.presentation(tl.named(geometry, name))
    for word in relations:
        product = np.eye(4)
        for letter in word:
            g = generators[abs(letter) - 1]
            product = product @ (g if letter > 0 else tl.inverse(geometry, g))
        assert np.max(np.abs(product - np.eye(4))) < 1e-12


@pytest.mark.parametrize(("geometry", "name"), MANIFOLDS)
def test_first_homology(geometry, name):
    generators, relations = tl.presentation(tl.named(geometry, name))
    assert homology(len(generators), relations) == HOMOLOGY[name]


@pytest.mark.parametrize("name", tl.names("s3"))
def test_finite_groups(name):
    group = tl.elements(tl.named("s3", name))
    assert group.shape == (ORDER[name], 4, 4)
    np.testing.assert_array_equal(group[0], np.eye(4))
    # Closed under products: every orbit point of a product is an orbit point.
    points = group @ ORIGIN
    products = np.einsum("aij,bj->abi", group, points).reshape(-1, 4)
    gaps = np.min(np.linalg.norm(products[:, None] - points, axis=2), axis=1)
    assert np.max(gaps) < 1e-14
    # Left multiplications: they commute with right multiplication by i, [x,y,z,w] -> [w,z,-y,-x].
    right = np.array([[0.0, 0, 0, 1], [0, 0, 1, 0], [0, -1, 0, 0], [-1, 0, 0, 0]])
    assert np.max(np.abs(group @ right - right @ group)) < 1e-15


@each
def test_elements_are_sorted_and_distinct(geometry, name):
    lattice = tl.named(geometry, name)
    group = tl.elements(lattice, count=300)
    assert len(group) == min(300, ORDER.get(name, 300))
    np.testing.assert_array_equal(group[0], np.eye(4))
    assert residual(geometry, group) < 1e-13
    points = group @ ORIGIN
    height = {"e3": np.linalg.norm(points[:, :3], axis=1), "s3": -points[:, 3], "h3": points[:, 3]}[geometry]
    assert np.all(np.diff(height) > -1e-6 * np.max(np.abs(height)))
    gaps = np.linalg.norm(points[:, None] - points, axis=2) + 10 * np.eye(len(points))
    # The images of the ball that touches the nearest wall do not overlap.
    assert np.min(gaps) > 2 * np.min(-lattice.walls[:, 3]) - 1e-9
    np.testing.assert_array_equal(tl.elements(lattice, count=40), group[:40])


def test_elements_within_a_radius():
    # Integer points in a ball of radius 6, and nothing is missed.
    inside = tl.elements(tl.named("e3", "three-torus"), radius=6)
    r = np.arange(-6, 7)
    assert len(inside) == np.count_nonzero(r[:, None, None] ** 2 + r[:, None] ** 2 + r**2 <= 36)
    lattice = tl.named("h3", "seifert-weber")
    near = tl.elements(lattice, radius=3.5)
    many = tl.elements(lattice, count=len(near) + 1)
    np.testing.assert_array_equal(many[:-1], near)
    assert np.cosh(3.5) < many[-1, 3, 3]
    # The nearest of a cube come in the order of its faces.
    torus = tl.named("e3", "three-torus")
    np.testing.assert_array_equal(tl.elements(torus, count=7), tl.neighbours(torus))
    with pytest.raises(ValueError, match="give count or radius"):
        tl.elements(lattice)


@each
def test_neighbours_share_faces(geometry, name):
    lattice = tl.named(geometry, name)
    around = tl.neighbours(lattice)
    assert around.shape == (len(lattice.walls) + 1, 4, 4)
    np.testing.assert_array_equal(around[0], np.eye(4))
    for wall, step in zip(lattice.walls, around[1:], strict=True):
        # The neighbour's centre lies mirrored behind the wall.
        centre = step @ ORIGIN
        assert wall @ centre == pytest.approx(-wall[3], rel=1e-13)


# --- tilings ------------------------------------------------------------------------------------------------


@each
def test_points_are_teleported_by_group_elements(geometry, name):
    lattice = tl.named(geometry, name)
    start = random_points(geometry, 400, 3.0, seed=2)
    points, elements, ok = lattice.teleport(start)
    assert ok.all()
    assert lattice.contains(points, 1e-12).all()
    np.testing.assert_allclose(np.einsum("nij,nj->ni", elements, start), points, rtol=0, atol=1e-11)
    # The elements are in the group that `elements` lists: a point moves by at most twice its distance from o.
    orbit = tl.elements(lattice, radius=6.0) @ ORIGIN
    images = tl.inverse(geometry, elements) @ ORIGIN
    assert np.max(np.min(np.linalg.norm(images[:, None] - orbit, axis=2), axis=1)) < 1e-9


@each
def test_teleporting_preserves_distances(geometry, name):
    lattice = tl.named(geometry, name)
    # Points beside each other, moved by the same element.
    start = random_points(geometry, 20, 3.0, seed=3)
    beside = on_model(geometry, start + 0.2 * random_points(geometry, 20, 1.0, seed=4) * [1, 1, 1, 0])
    points, elements, _ = lattice.teleport(start)
    moved = np.einsum("nij,nj->ni", elements, beside)
    for p, q, p1, q1 in zip(start, beside, points, moved, strict=True):
        before, after = precise_distance(geometry, p, q), precise_distance(geometry, p1, q1)
        assert after == pytest.approx(before, abs=1e-11)


@each
def test_translates_do_not_overlap(geometry, name):
    lattice = tl.named(geometry, name)
    group = tl.elements(lattice, count=200)
    points = random_points(geometry, 300, 1.5, seed=5)
    home = np.einsum("gij,nj->gni", tl.inverse(geometry, group), points)
    inside = np.all(home @ lattice.walls.T < -1e-9, axis=2)
    assert np.all(np.count_nonzero(inside, axis=0) <= 1)
    # Those near the origin are covered, but for the few that lie on a wall.
    assert np.count_nonzero(inside) >= (0.99 * len(points) if name != "ideal-cube" else 0.9 * len(points))


@pytest.mark.parametrize(("geometry", "name"), MANIFOLDS)
def test_an_orbit_has_one_point_inside(geometry, name):
    lattice = tl.named(geometry, name)
    group = tl.elements(lattice, count=60)
    start = random_points(geometry, 30, 1.0, seed=6)
    expected, _, _ = lattice.teleport(start)
    orbit = np.einsum("gij,nj->gni", group, start).reshape(-1, 4)
    points, _, ok = lattice.teleport(on_model(geometry, orbit))
    assert ok.all()
    points = points.reshape(len(group), -1, 4)
    np.testing.assert_allclose(points, np.broadcast_to(expected, points.shape), atol=1e-10)


def test_teleport_reports_what_it_cannot_do():
    lattice = tl.named("e3", "three-torus")
    start = np.array([[3.25, 0, -7, 1], [5000, 0, 0, 1], [np.nan, 0, 0, 1], [0.5, 0.5, 0.5, 1]])
    points, elements, ok = lattice.teleport(start, max_steps=20)
    np.testing.assert_array_equal(ok, [True, False, False, True])
    np.testing.assert_array_equal(points[0], [0.25, 0, 0, 1])
    np.testing.assert_array_equal(elements[0, :, 3], [-3, 0, 7, 1])
    np.testing.assert_array_equal(elements[3], np.eye(4))
    np.testing.assert_array_equal(start[0], [3.25, 0, -7, 1])


def test_points_on_walls_come_to_rest():
    for geometry, name in NAMED:
        lattice = tl.named(geometry, name)
        corners = [v.vector for v in tl.vertices(lattice) if v.kind == "finite"]
        on_walls = np.array([*corners, *(e.point for e in tl.edges(lattice))])
        for step in tl.neighbours(lattice):
            assert lattice.teleport(on_walls @ step.T, max_steps=50)[2].all(), name


# --- cells --------------------------------------------------------------------------------------------------


@each
def test_cell_table(geometry, name):
    lattice = tl.named(geometry, name)
    cells, following = tl.cell_table(lattice, 500)
    count = len(cells)
    assert count == min(500, ORDER.get(name, 500))
    assert following.shape == (count, len(lattice.walls)) and following.dtype == np.int32
    np.testing.assert_array_equal(cells, tl.elements(lattice, count=500))
    if name in ORDER:
        assert following.max() == count - 1
    k, f = np.nonzero(following < count)
    # It is the right cell, and crossing back leads home.
    expected = cells[k] @ lattice.inverses[f]
    scale = np.max(np.abs(expected), axis=(1, 2))
    assert np.max(np.max(np.abs(cells[following[k, f]] - expected), axis=(1, 2)) / scale) < 1e-12
    np.testing.assert_array_equal(following[following[k, f], lattice.partner[f]], k)
    # Home has all its neighbours, in the order of `neighbours`.
    np.testing.assert_allclose(cells[following[0]], tl.neighbours(lattice)[1:], atol=1e-14)


@each
def test_cells_do_not_depend_on_the_path(geometry, name):
    # Going around an edge, as often as its order, leads back to the cell unless the path leaves the table.
    lattice = tl.named(geometry, name)
    cells, following = tl.cell_table(lattice, 500)
    beyond = len(cells)
    following = np.vstack([following, np.full(len(lattice.walls), beyond, dtype=np.int32)])
    for cycle in tl.edge_cycles(lattice):
        k = np.arange(beyond)
        for f in cycle.faces * (cycle.order or 1):
            k = following[k, f]
        back = k != beyond
        assert np.count_nonzero(back) >= (beyond if name in ORDER else 10)
        np.testing.assert_array_equal(k[back], np.arange(beyond)[back])


def test_large_cell_table():
    lattice = tl.named("h3", "seifert-weber")
    cells, following = tl.cell_table(lattice, 4096)
    assert len(cells) == 4096
    k, f = np.nonzero(following < 4096)
    np.testing.assert_array_equal(following[following[k, f], lattice.partner[f]], k)
    # A tree of cells: every cell but home has a neighbour nearer to home.
    assert all(np.min(following[k]) < k for k in range(1, 4096))


# --- lattices given by hand ---------------------------------------------------------------------------------


def given(geometry, name):
    lattice = tl.named(geometry, name)
    return lattice.maps.copy(), lattice.walls.copy()


@each
def test_from_matrices_takes_every_named_lattice(geometry, name):
    maps, walls = given(geometry, name)
    noise = 1 + 1e-11 * np.random.default_rng(7).uniform(-1, 1, maps.shape)
    lattice = tl.from_matrices(geometry, maps * noise, 3.7 * walls)
    np.testing.assert_allclose(lattice.walls, walls, atol=1e-9)
    np.testing.assert_allclose(lattice.maps, maps, atol=1e-9)
    assert residual(geometry, lattice.maps) < 1e-14
    assert len(tl.edge_cycles(lattice)) == len(tl.edge_cycles(tl.named(geometry, name)))


def test_from_matrices_accepts_a_domain_that_is_not_dirichlet():
    # The three-torus with x faces that lean: x - y/4 between -1/2 and 1/2.
    maps, walls = given("e3", "three-torus")
    walls[:2] = [[1, -0.25, 0, -0.5], [-1, 0.25, 0, -0.5]]
    lattice = tl.from_matrices("e3", maps, walls)
    assert not lattice.is_dirichlet
    assert lattice.teleport(random_points("e3", 100, 5.0, seed=8))[2].all()
    inside = tl.elements(lattice, radius=4)
    assert len(inside) == len(tl.elements(tl.named("e3", "three-torus"), radius=4))
    # The y maps do not fit edge to edge, so there is no presentation.
    with pytest.raises(tl.LatticeError, match="does not carry the edges"):
        tl.presentation(lattice)


def test_from_matrices_unbounded_and_mirrored():
    shift = np.eye(4)
    shift[0, 3] = 2.0
    slab = tl.from_matrices("e3", [tl.inverse("e3", shift), shift], [[1, 0, 0, -1], [-1, 0, 0, -1]])
    assert tl.edges(slab) == [] and tl.vertices(slab) == []
    assert tl.presentation(slab)[1] == []
    # Two mirrors at a right angle generate a group of four.
    mirrors = [np.diag([-1.0, 1, 1, 1]), np.diag([1.0, -1, 1, 1])]
    for m in mirrors:
        m[:3, 3] = np.where(np.diag(m)[:3] < 0, 1.0, 0.0)
    corner = tl.from_matrices("e3", mirrors, [[2, 0, 0, -1], [0, 2, 0, -1]])
    np.testing.assert_array_equal(corner.partner, [0, 1])
    (edge,) = tl.edges(corner)
    assert edge.kinds == ("open", "open") and edge.angle == pytest.approx(np.pi / 2)
    assert len(tl.elements(corner, count=10)) == 4
    (cycle,) = tl.edge_cycles(corner)
    assert cycle.order == 2 or cycle.angle == pytest.approx(np.pi)


def test_cone_manifold_has_no_presentation():
    # A cube with dihedral angles of 50 degrees and four of them around an edge: 200 is not 360/k.
    square = np.cos(np.radians(50.0))
    c, s = 1 + 2 * square, 2 * np.sqrt(square * (1 + square))
    maps, walls = [], []
    for axis in range(3):
        for sign in (1, -1):
            m = np.eye(4)
            m[axis, axis] = m[3, 3] = c
            m[axis, 3] = m[3, axis] = -sign * s
            n = np.zeros(4)
            n[axis], n[3] = sign * np.sqrt(1 + square), -np.sqrt(square)
            maps.append(m)
            walls.append(n)
    lattice = tl.from_matrices("h3", maps, walls)
    assert [c.order for c in tl.edge_cycles(lattice)] == [None] * 3
    with pytest.raises(tl.LatticeError, match="200 degrees"):
        tl.presentation(lattice)


def scale_generator(maps, walls):
    maps[2, 0, 0] = 1.5


def flip_sheet(maps, walls):
    maps[1] *= -1


def drop_inverse(maps, walls):
    maps[3] = maps[1]


def swap_pair(maps, walls):
    maps[[4, 5]] = maps[[5, 4]]


def turn_out(maps, walls):
    walls[1] *= -1


def shift_wall(maps, walls):
    walls[4, 3] *= 0.9


def not_a_plane(maps, walls):
    walls[2] = [0.5, 0.0, 0.0, -1.0]


def not_finite(maps, walls):
    walls[3, 0] = np.inf


@pytest.mark.parametrize(
    ("spoil", "what", "index", "words"),
    [
        (scale_generator, "generators", 2, "generator 3 is not an isometry of h3 \\(off by 0"),
        (flip_sheet, "generators", 1, "generator 2 exchanges the sheets.*negate"),
        (drop_inverse, "generators", 2, "generator 3 has no inverse among the generators; add it"),
        (swap_pair, "generators", 4, "generator 5 moves the wrong way.*exchange it with its inverse"),
        (turn_out, "domain", 1, "half-space 2 does not have the origin inside.*change all four signs"),
        (shift_wall, "domain", 4, "half-space 5 does not fit its generator.*that of half-space 6"),
        (not_a_plane, "domain", 2, "half-space 3 has no boundary plane.*must exceed"),
        (not_finite, "domain", 3, "half-space 4 has a number that is not finite"),
    ],
)
def test_from_matrices_says_what_is_wrong(spoil, what, index, words):
    maps, walls = given("h3", "ideal-cube")
    spoil(maps, walls)
    with pytest.raises(tl.LatticeError, match=words) as caught:
        tl.from_matrices("h3", maps, walls)
    assert (caught.value.what, caught.value.index) == (what, index)
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, ThurstonError)


def test_from_matrices_says_more():
    maps, walls = given("e3", "three-torus")
    with pytest.raises(tl.LatticeError, match="6 generators but 5 half-spaces") as caught:
        tl.from_matrices("e3", maps, walls[:5])
    assert (caught.value.what, caught.value.index) == ("domain", None)
    with pytest.raises(tl.LatticeError, match="must be a list of 4x4 matrices"):
        tl.from_matrices("e3", maps[:, :3], walls)
    with pytest.raises(tl.LatticeError, match="list of half-spaces"):
        tl.from_matrices("e3", maps, [[1, 0, 0, -1], [1, 0]])
    rows = np.swapaxes(maps, 1, 2)
    with pytest.raises(tl.LatticeError, match=r"generator 1 .*last row must be \[0, 0, 0, 1\]"):
        tl.from_matrices("e3", rows, walls)
    # A pair of walls far outside the cube.
    far = np.eye(4)
    far[:3, 3] = [3.0, 3.0, 0.0]
    with pytest.raises(tl.LatticeError, match="half-space 7 does not bound the domain") as caught:
        tl.from_matrices("e3", [*maps, tl.inverse("e3", far), far], [*walls, [1, 1, 0, -3], [-1, -1, 0, -3]])
    assert (caught.value.what, caught.value.index) == ("domain", 6)
    with pytest.raises(tl.LatticeError, match="is the same as number 1"):
        tl.from_matrices("e3", [*maps, maps[0]], [*walls, walls[0]])


# --- Dirichlet domains and names ----------------------------------------------------------------------------


def test_dirichlet_domain_of_the_hexagonal_torus():
    maps = [np.eye(4) for _ in range(3)]
    maps[0][:2, 3] = [1.0, 0.0]
    maps[1][:2, 3] = [10.5, np.sqrt(0.75)]  # a long way round: the domain needs products
    maps[2][2, 3] = 2.0
    lattice = tl.dirichlet("hexagonal", "e3", maps)
    assert len(lattice.walls) == 8 and len(tl.vertices(lattice)) == 12
    generators, relations = tl.presentation(lattice)
    assert homology(len(generators), relations) == (3, [])
    assert ConvexHull([v.vector[:3] for v in tl.vertices(lattice)]).volume == pytest.approx(2 * np.sqrt(0.75))


def test_dirichlet_domain_of_projective_space():
    lattice = tl.dirichlet("projective", "s3", [-np.eye(4)])
    np.testing.assert_array_equal(lattice.walls, [[0, 0, 0, -1]])
    assert len(tl.elements(lattice)) == 2
    points = random_points("s3", 50, 0, seed=9)
    moved, _, ok = lattice.teleport(points)
    assert ok.all()
    np.testing.assert_allclose(moved, points * np.sign(points[:, 3:]), atol=1e-15)
    with pytest.raises(tl.LatticeError, match="reaches the equator"):
        tl.edge_cycles(lattice)


def test_dirichlet_refuses_what_it_cannot_do():
    with pytest.raises(tl.LatticeError, match="fixes the origin"):
        tl.dirichlet("turn", "e3", [np.diag([-1.0, -1, 1, 1])])
    with pytest.raises(tl.LatticeError, match="generator 1 of 'stretch' is not an isometry") as caught:
        tl.dirichlet("stretch", "h3", [np.diag([1.0, 1, 1, 2])])
    assert caught.value.index == 0
    dense = [np.eye(4), np.eye(4)]
    dense[0][0, 3], dense[1][0, 3] = 1.0, np.sqrt(2.0)
    with pytest.raises(tl.LatticeError, match="discrete"):
        tl.dirichlet("dense", "e3", dense)


def test_names():
    assert tl.names("s3") == ["quaternion", "binary-tetrahedral", "poincare"]
    assert tl.named("s3", "Q8") is tl.named("s3", "quaternion")
    assert tl.named("s3", "Poincaré dodecahedral space").name == "poincare"
    assert tl.named("e3", "torus").name == "three-torus"
    assert tl.named("e3", "Klein_bottle").name == "klein-bottle-x-circle"
    with pytest.raises(ValueError, match=r"known are: seifert-weber, ideal-cube.*did you mean 'ideal-cube'"):
        tl.named("h3", "idealcube")
    with pytest.raises(tl.LatticeError, match="'seifert-weber' is in h3"):
        tl.named("e3", "seifert-weber")
    with pytest.raises(ValueError, match="no lattices for geometry 'e4'"):
        tl.names("e4")


def test_form():
    np.testing.assert_array_equal([form(g)[3] for g in ("e3", "s3", "h3")], [0, 1, -1])


@pytest.mark.parametrize("degrees", [45.0, 57.3])
def test_a_turn_that_does_not_fit_the_face_is_refused(degrees: float) -> None:
    """The planes fit, but the images of the cube overlap."""
    cube = tl.named("e3", "three-torus")
    maps = np.array(cube.maps)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    maps[4] = maps[4] @ np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    maps[5] = np.linalg.inv(maps[4])
    with pytest.raises(tl.LatticeError, match="does not tile space") as error:
        tl.from_matrices("e3", maps, cube.walls)
    assert error.value.what == "generators" and error.value.index in (4, 5)


def test_bricks_laid_half_over_each_other_are_a_lattice() -> None:
    cube = tl.named("e3", "three-torus")
    maps = np.array(cube.maps)
    maps[0, 1, 3], maps[1, 1, 3] = -0.3, 0.3
    assert len(tl.from_matrices("e3", maps, cube.walls).walls) == 6
