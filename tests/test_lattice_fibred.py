"""Lattices of s2xe, h2xe, nil and sl2: isometries against the kernels, groups, domains, cells and errors."""

import itertools

import numpy as np
import pytest

from thurston_cl import lattice as tl
from thurston_cl.geometry import Geometry
from thurston_cl.lattice import isometry as iso
from thurston_cl.lattice.checks import INSIDE
from thurston_cl.lattice.given_prism import TRIAL_POINTS, _trial_points
from thurston_cl.lattice.polygon import ON_WALL, Polygon
from thurston_cl.lattice.prism import STRAIGHT_BELOW, Prism, base_radius, pair, prism, shift
from thurston_cl.lattice.radius import climb_time, greatest_climb, orbit_radius

FIBRED = ("s2xe", "h2xe", "nil", "sl2")
NAMED = [(geometry, name) for geometry in FIBRED for name in tl.names(geometry)]
every = pytest.mark.parametrize("geometry", FIBRED)
each = pytest.mark.parametrize(("geometry", "name"), NAMED)

# Per lattice: sides, area of the base by Gauss and Bonnet (on H2 - 2 pi times the orbifold's Euler
# characteristic), length of the fibre, vertices and edges of the prism.
SHAPE = {
    ("s2xe", "hopf-manifold"): (0, 4 * np.pi, 1.5, 0, 0),
    ("s2xe", "lunes"): (2, np.pi, np.pi / 2, 4, 6),
    ("s2xe", "cube"): (4, 4 * np.pi / 6, np.pi / 2, 8, 12),
    ("s2xe", "dodecahedron"): (5, 4 * np.pi / 12, np.arctan(2), 10, 15),
    ("h2xe", "orbi-torus"): (4, np.pi, 2 * np.arcsinh(2**-0.25), 8, 12),
    ("h2xe", "cusped-torus"): (4, 2 * np.pi, 2, 8, 8),
    ("h2xe", "genus-two"): (8, 4 * np.pi, 2 * np.arccosh(1 + np.sqrt(2)), 16, 24),
    ("nil", "heisenberg"): (4, 1, 1, 8, 12),
    ("nil", "double-twist"): (4, 2, 1, 8, 12),
    ("nil", "hexagonal"): (6, np.sqrt(0.75), np.sqrt(0.75), 12, 18),
    ("nil", "half-turn"): (4, 2, 2, 8, 12),
    ("sl2", "genus-two"): (8, 4 * np.pi, 2 * np.pi, 16, 24),
    ("sl2", "orbi-sphere"): (4, 2 * np.pi / 3, 2 * np.pi, 8, 12),
    ("sl2", "fiber-loop"): (0, np.inf, 2 * np.pi, 0, 0),
}
# Relations between inverses of the walls' maps, g1, g2, ..., and the power of the shift along the fibre that
# the product is.
RELATIONS = {
    ("s2xe", "lunes"): [((1,) * 4, 0)],
    ("s2xe", "cube"): [((1, 1, 1), 0), ((1, 2), 0), ((3, 3), 0), ((4, 4), 0), ((3, 4) * 3, 0)],
    ("h2xe", "orbi-torus"): [((1, 3, 2, 4) * 2, 0)],
    ("nil", "heisenberg"): [((1, 3, 2, 4), 1)],
    ("nil", "double-twist"): [((1, 3, 2, 4), 2)],
    ("nil", "hexagonal"): [((1, 5, 4), 0), ((1, 3, 2, 4), 1)],
    ("nil", "half-turn"): [((1, 1), -1), ((2, 2), -1)],
    ("sl2", "orbi-sphere"): [((1,) * 6, 1), ((2,) * 6, 1), ((1, 2) * 3, 2)],
}


@pytest.fixture(scope="module")
def kernels():
    return {geometry: Geometry(geometry) for geometry in FIBRED}


def random_points(geometry, count, size, seed):
    rng = np.random.default_rng(seed)
    points = np.tile(iso.origin(geometry), (count, 1))
    points[:, :2] += size * rng.normal(size=(count, 2))
    points[:, iso.fibre(geometry)] = size * rng.normal(size=count)
    if geometry == "s2xe":
        points[:, 2] = rng.normal(size=count)
    return iso.on_model(geometry, points)


def random_isometries(geometry, count, seed):
    rng = np.random.default_rng(seed)
    m = iso.translation(geometry, random_points(geometry, count, 1.0, seed))
    for k, angle in enumerate(rng.uniform(0, 2 * np.pi, count)):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        if k % 2:
            turn = turn @ [[0, 1, 0], [1, 0, 0], [0, 0, -1]]
        if k % 3 == 0 and geometry in ("s2xe", "h2xe"):
            turn = turn @ np.diag([1, 1, -1])
        m[k] = iso.compose(geometry, m[k], iso.stabilizer(geometry, turn))
    return m


def power(geometry, element, exponent):
    product = iso.identity(geometry)
    for _ in range(abs(exponent)):
        product = iso.compose(geometry, product, element)
    return product if exponent >= 0 else iso.inverse(geometry, product)


# --- isometries ---------------------------------------------------------------------------------------------


@every
def test_isometries_are_a_group(geometry):
    a, b, c = (random_isometries(geometry, 60, seed) for seed in (1, 2, 3))
    points = random_points(geometry, 60, 1.0, 4)
    size = np.max(np.abs(a)) * np.max(np.abs(b)) * np.max(np.abs(c))
    ab = iso.compose(geometry, a, b)
    assert iso.residual(geometry, ab) < 1e-13 and iso.keeps_model(geometry, ab)
    np.testing.assert_allclose(
        iso.act(geometry, ab, points), iso.act(geometry, a, iso.act(geometry, b, points)), atol=1e-14 * size
    )
    np.testing.assert_allclose(
        iso.compose(geometry, ab, c),
        iso.compose(geometry, a, iso.compose(geometry, b, c)),
        rtol=0,
        atol=1e-14 * size,
    )
    back = iso.inverse(geometry, a)
    for product in (iso.compose(geometry, a, back), iso.compose(geometry, back, a)):
        np.testing.assert_allclose(
            product,
            np.broadcast_to(iso.identity(geometry), a.shape),
            rtol=0,
            atol=1e-14 * np.max(np.abs(a)) ** 2,
        )
    # Broadcasting: all isometries on all points.
    table = iso.act(geometry, a[:, None], points[None])
    np.testing.assert_allclose(table[7, 11], iso.act(geometry, a[7], points[11]), rtol=1e-14)


@every
def test_isometries_keep_the_kernels_distances_and_geodesics(geometry, kernels):
    m = random_isometries(geometry, 60, 1)
    p, q = (random_points(geometry, 60, 1.0, seed) for seed in (4, 5))
    kernel = kernels[geometry]
    moved = iso.act(geometry, m, p)
    np.testing.assert_allclose(
        kernel.distance(moved, iso.act(geometry, m, q)), kernel.distance(p, q), rtol=1e-12
    )
    np.testing.assert_allclose(
        iso.act(geometry, iso.translation(geometry, p), q), kernel.translate(p, q), rtol=0, atol=1e-13
    )
    # vector_map turns directions: a geodesic's image is the geodesic of the image.
    u = np.random.default_rng(6).normal(size=(60, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    maps = iso.vector_map(geometry, m)
    if geometry in ("nil", "sl2"):
        turned = np.einsum("nij,nj->ni", maps, np.column_stack([u, np.zeros(60)]))[:, :3]
    else:
        image = np.einsum("nij,nj->ni", maps, kernel.velocity(p, u))
        frames = [kernel.velocity(point, np.eye(3)).T for point in moved]
        turned = np.array([np.linalg.lstsq(f, v)[0] for f, v in zip(frames, image, strict=True)])
    ends = iso.act(geometry, m, kernel.flow(u, 1.3, base=p)[0])
    reached = kernel.flow(turned, 1.3, base=moved)[0]
    np.testing.assert_allclose(reached, ends, rtol=0, atol=1e-12 * np.max(np.abs(ends)))


@every
def test_rotations_about_the_origin(geometry, kernels):
    u = np.array([0.36, 0.48, 0.8])
    flip = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]])
    m = iso.stabilizer(geometry, flip)
    start, turned = (kernels[geometry].flow(v, 2.0)[0][0] for v in (u, flip @ u))
    np.testing.assert_allclose(iso.act(geometry, m, start), turned, rtol=0, atol=1e-14)
    np.testing.assert_array_equal(iso.act(geometry, m, iso.origin(geometry)), iso.origin(geometry))
    with pytest.raises(tl.LatticeError, match="only be turned about its fiber"):
        iso.stabilizer(geometry, [[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    with pytest.raises(tl.LatticeError, match="orthogonal"):
        iso.stabilizer(geometry, 2 * np.eye(3))
    mirror = np.diag([1.0, 1.0, -1.0])
    if geometry in ("nil", "sl2"):
        with pytest.raises(tl.LatticeError, match="no reflections"):
            iso.stabilizer(geometry, mirror)
    else:
        assert iso.act(geometry, iso.stabilizer(geometry, mirror), start)[3] == -start[3]
    # From both sides of the tolerance.
    for off, good in ((0.5, True), (2.0, False)):
        tilt = np.eye(3)
        tilt[0, 2], tilt[2, 0] = off * iso.OFF_ORTHOGONAL, -off * iso.OFF_ORTHOGONAL
        if good:
            np.testing.assert_array_equal(iso.stabilizer(geometry, tilt), iso.identity(geometry))
        else:
            with pytest.raises(tl.LatticeError):
                iso.stabilizer(geometry, tilt)


@every
def test_tidy_puts_an_isometry_right(geometry):
    for m in random_isometries(geometry, 10, 8):
        noise = 1 + 1e-7 * np.random.default_rng(9).uniform(-1, 1, m.shape)
        tidied = iso.tidy(geometry, m * noise)
        assert iso.residual(geometry, m * noise) > 1e-9
        assert iso.residual(geometry, tidied) < iso.ROUNDING
        np.testing.assert_allclose(tidied, m, rtol=0, atol=1e-5)


def test_dimensions():
    assert [iso.dimension(g) for g in iso.GEOMETRIES] == [4, 4, 4, 5, 5, 4, 5, 4]
    assert [len(iso.identity(g)) for g in iso.GEOMETRIES] == [4, 4, 4, 5, 5, 4, 5, 4]
    for geometry in iso.GEOMETRIES:
        o = iso.origin(geometry)
        np.testing.assert_array_equal(iso.on_model(geometry, o), o)
        assert iso.homogeneous(geometry, o).shape == (iso.dimension(geometry),)
    with pytest.raises(tl.LatticeError, match="no lattices for geometry 'solv'"):
        tl.names("solv")


# --- how far the fibre coordinate goes ----------------------------------------------------------------------


@every
@pytest.mark.parametrize("rho", [0.0, 0.7, 3.0])
def test_no_geodesic_climbs_faster(geometry, rho, kernels):
    rng = np.random.default_rng(10)
    u = rng.normal(size=(4000, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    start = kernels[geometry].flow([1.0, 0, 0], rho)[0]
    axis = iso.fibre(geometry)
    for length in (0.1, 1.0, 4.0):
        climbed = np.abs(kernels[geometry].flow(u, length, base=start)[0][:, axis] - start[0, axis])
        bound = climb_time(geometry, rho, climbed)
        assert np.all(bound <= length)
        # Short paths nearly attain it.
        assert np.max(bound) > (0.98 if length == 0.1 else 0.4) * length
    assert climb_time(geometry, rho, -2.0) == -climb_time(geometry, rho, 2.0)
    assert climb_time(geometry, rho, 0.0) == 0
    # The inverse of the greatest climb from the axis.
    assert climb_time(geometry, 0.0, greatest_climb(geometry, 5.0)) == pytest.approx(5.0, rel=2e-9)


def test_inradius_of_nil_from_both_sides(kernels):
    for height, exact in ((0.99 * STRAIGHT_BELOW, True), (1.01 * STRAIGHT_BELOW, False)):
        tower = prism("tower", "nil", [], 2 * height, "", "")
        assert (tower.inradius == pytest.approx(height, rel=1e-15)) == exact
        assert tower.inradius <= height
    # Right at the limit a level is no nearer than straight above.
    x = np.linspace(0, 3, 200)
    level = np.column_stack([x, 0 * x, 0 * x + STRAIGHT_BELOW, 0 * x + 1])
    assert np.min(kernels["nil"].distance(level)) == pytest.approx(STRAIGHT_BELOW, rel=1e-12)


# --- the domains --------------------------------------------------------------------------------------------


@each
def test_is_well_formed(geometry, name):
    lattice = tl.named(geometry, name)
    sides, _, length, _, _ = SHAPE[geometry, name]
    assert isinstance(lattice, Prism) and lattice.name == name
    assert lattice.description and lattice.source
    assert len(lattice.walls) == sides + 2 and lattice.level_walls == (sides, sides + 1)
    assert lattice.maps.shape == (sides + 2, *iso.identity(geometry).shape)
    assert iso.residual(geometry, lattice.maps) < 1e-14 and iso.keeps_model(geometry, lattice.maps)
    assert not lattice.walls.flags.writeable and not lattice.maps.flags.writeable
    assert lattice.contains(lattice.centre)
    low, high = lattice.levels
    assert high == -low and high - low == pytest.approx(length, rel=1e-15)
    # Sides see the base alone, levels the fibre alone.
    axis = iso.fibre(geometry)
    assert not lattice.walls[:sides, axis].any()
    np.testing.assert_array_equal(np.delete(lattice.walls[sides:], [axis, -1], axis=1), 0)
    np.testing.assert_array_equal(lattice.walls[sides:, axis], [1, -1])
    for array in (lattice.walls, lattice.maps):
        halves = np.round(2 * array) / 2
        assert np.all((array == halves) | (np.abs(array - halves) > 1e-6))
        assert not np.any(np.signbit(array) & (array == 0))
    # o is led into the domain's neighbours, and right behind the wall.
    images = iso.act(geometry, lattice.inverses, lattice.centre)
    assert np.all(np.diag(lattice.heights(images)) > 0)


@each
def test_area_and_corners(geometry, name):
    lattice = tl.named(geometry, name)
    sides, area, _, vertices, edges = SHAPE[geometry, name]
    polygon = lattice.polygon
    assert lattice.finite_volume == bool(np.isfinite(area))
    assert polygon.bounding == list(range(sides))
    if geometry == "nil":
        x, y = np.array([c.vector[:2] for c in polygon.corners]).T
        order = np.argsort(np.arctan2(y, x))
        x, y = x[order], y[order]
        assert (x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2 == pytest.approx(area, rel=1e-14)
    elif np.isfinite(area) and sides:
        excess = sum(polygon.angle(c) for c in polygon.corners) - (sides - 2) * np.pi
        assert abs(excess) == pytest.approx(area, rel=1e-12)
    assert (len(tl.vertices(lattice)), len(tl.edges(lattice))) == (vertices, edges)
    kinds = {v.kind for v in tl.vertices(lattice)}
    assert kinds == ({"ideal"} if name == "cusped-torus" else {"finite"} if vertices else set())
    for vertex in tl.vertices(lattice):
        heights = lattice.heights(vertex.vector)
        assert np.max(np.abs(heights[list(vertex.walls)])) < 1e-13
        assert np.max(np.delete(heights, vertex.walls), initial=-1) < -0.1
        if vertex.kind == "finite":
            np.testing.assert_allclose(
                iso.on_model(geometry, vertex.vector), vertex.vector, rtol=1e-14, atol=0
            )
        else:
            assert np.hypot(*vertex.vector[:2]) == pytest.approx(vertex.vector[2], rel=1e-15)
    for edge in tl.edges(lattice):
        heights = lattice.heights(edge.point)
        assert np.max(np.abs(heights[list(edge.walls)])) < 1e-13 and np.max(heights) < 1e-12
        # Both walls' forms vanish along the edge.
        along = edge.direction if len(lattice.walls[0]) == 4 else np.append(edge.direction, 0)
        assert np.max(np.abs(lattice.walls[list(edge.walls)] @ along)) < 1e-13
        assert np.linalg.norm(edge.direction) >= 1 - 1e-15
        upright = not set(edge.walls) & set(lattice.level_walls)
        assert upright == bool(edge.direction[iso.fibre(geometry)])
        known = np.array([v.vector for v in tl.vertices(lattice)])
        for end in edge.ends:
            assert np.min(np.max(np.abs(known - end), axis=1)) < 1e-13


@each
def test_dirichlet_domains_of_products(geometry, name, kernels):
    lattice = tl.named(geometry, name)
    assert lattice.is_dirichlet == (geometry in ("s2xe", "h2xe"))
    if lattice.is_dirichlet:
        points = random_points(geometry, 300, 1.0, 11)
        images = iso.act(geometry, tl.elements(lattice, count=60)[1:], lattice.centre)
        nearest = np.min(
            [kernels[geometry].distance(points, np.tile(image, (300, 1))) for image in images], axis=0
        )
        np.testing.assert_array_equal(lattice.contains(points), kernels[geometry].distance(points) < nearest)


def test_a_prism_that_is_no_dirichlet_domain():
    square = tl.named("h2xe", "orbi-torus")
    maps, walls = square.maps.copy(), square.walls.copy()
    maps[4:, 3, 4] *= 1.1
    assert not Prism("x", "h2xe", walls, maps).is_dirichlet
    walls = square.walls.copy()
    walls[0, 1] += 2e-9
    assert not Prism("x", "h2xe", walls, square.maps).is_dirichlet
    walls[0, 1] -= 1.5e-9
    assert Prism("x", "h2xe", walls, square.maps).is_dirichlet


@each
def test_clearance_and_distance_are_lower_bounds(geometry, name, kernels):
    lattice = tl.named(geometry, name)
    points = random_points(geometry, 4000, 1.5, 12)
    inside = lattice.contains(points)
    domain, outside = points[inside][:60], points[~inside][:60]
    assert np.all(lattice.clearance(domain) > 0) and np.all(lattice.clearance(outside) < 0)
    assert lattice.inradius == pytest.approx(float(lattice.clearance(lattice.centre)), rel=0.02)
    distances = np.array([kernels[geometry].distance(np.tile(p, (len(outside), 1)), outside) for p in domain])
    for p, near, least in zip(domain, lattice.clearance(domain), distances.min(axis=1), strict=True):
        assert near <= least + 1e-12 and lattice.distance_from(p) == 0
    from_outside = np.array([lattice.distance_from(q) for q in outside])
    assert np.all(from_outside > 0) and np.all(from_outside <= distances.min(axis=0) + 1e-12)
    assert np.all(-lattice.clearance(outside) <= from_outside + 1e-12)


@every
def test_distance_from_corners_and_levels(geometry, kernels):
    names = {"s2xe": "cube", "h2xe": "orbi-torus", "nil": "heisenberg", "sl2": "orbi-sphere"}
    lattice = tl.named(geometry, names[geometry])
    axis = iso.fibre(geometry)
    # Straight above o by a little.
    point = lattice.centre
    point[axis] = lattice.levels[1] + 0.1
    exact = geometry in ("s2xe", "h2xe")
    assert lattice.distance_from(point) == pytest.approx(0.1, rel=1e-12 if exact else 0.05)
    # Behind two sides and a level of a product, the corner is nearest.
    if exact:
        corner = tl.vertices(lattice)[0].vector
        out = corner.copy()
        out[:2] *= 1.2
        out = iso.on_model(geometry, out)
        out[axis] += 0.3 * np.sign(out[axis])
        expected = kernels[geometry].distance(out[None], corner[None])[0]
        assert 0.8 * expected < lattice.distance_from(out) <= expected * (1 + 1e-12)


# --- the groups ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("geometry", "name"), list(RELATIONS))
def test_relations_hold(geometry, name):
    lattice = tl.named(geometry, name)
    steps = lattice.inverses
    up = shift(geometry, SHAPE[geometry, name][2])
    for word, expected in RELATIONS[geometry, name]:
        product = iso.identity(geometry)
        for letter in word:
            product = iso.compose(geometry, product, steps[letter - 1])
        np.testing.assert_allclose(product, power(geometry, up, expected), rtol=0, atol=1e-12)


def test_relation_of_the_genus_two_surface():
    # Paper 10.9: sides H1+ H1- H2+ H2- ... have B1^-1, B2^-1, A1, A2, B1, B2, A1^-1, A2^-1 for their maps.
    for geometry, exponent in (("sl2", -2), ("h2xe", 0)):
        _, _, a1, a2, b1, b2 = tl.named(geometry, "genus-two").maps[:6]
        product = iso.identity(geometry)
        for a, b in ((a1, b1), (a2, b2)):
            for factor in (a, b, iso.inverse(geometry, a), iso.inverse(geometry, b)):
                product = iso.compose(geometry, product, factor)
        expected = power(geometry, shift(geometry, 2 * np.pi), exponent)
        np.testing.assert_allclose(product, expected, rtol=0, atol=1e-11)


@each
def test_points_are_teleported_by_group_elements(geometry, name):
    lattice = tl.named(geometry, name)
    start = random_points(geometry, 300, 3.0, 13)
    points, elements, ok = lattice.teleport(start)
    assert ok.all() and lattice.contains(points, 1e-12).all()
    np.testing.assert_allclose(iso.act(geometry, elements, start), points, rtol=0, atol=1e-10)
    assert iso.residual(geometry, elements) < 1e-12


@each
def test_teleporting_does_not_depend_on_the_path(geometry, name):
    lattice = tl.named(geometry, name)
    rng = np.random.default_rng(14)
    points = random_points(geometry, 4000, 1.0, 15)
    points = points[lattice.contains(points, -1e-6)][:100]
    for _ in range(20):
        word = iso.identity(geometry)
        for letter in rng.integers(len(lattice.walls), size=5):
            word = iso.compose(geometry, word, lattice.maps[letter])
        led, elements, ok = lattice.teleport(iso.act(geometry, word, points))
        assert ok.all()
        # What products of entries so large lose to rounding.
        allowed = 1e-13 * np.max(np.abs(word)) ** 2
        np.testing.assert_allclose(led, points, rtol=0, atol=1e-10 + allowed)
        np.testing.assert_allclose(
            iso.compose(geometry, elements, word),
            np.broadcast_to(iso.identity(geometry), elements.shape),
            rtol=0,
            atol=1e-10 + allowed,
        )


@each
def test_images_do_not_overlap_and_cover(geometry, name):
    lattice = tl.named(geometry, name)
    points = random_points(geometry, 3000, 1.0, 16)
    points = points[lattice.contains(points, -1e-9)][:200]
    group = tl.elements(lattice, count=300)
    assert np.max(np.abs(group[0] - iso.identity(geometry))) == 0
    assert not lattice.contains(iso.act(geometry, group[1:, None], points[None])).any()


@each
def test_elements_are_sorted_and_distinct(geometry, name):
    lattice = tl.named(geometry, name)
    group = tl.elements(lattice, count=300)
    assert len(group) == 300 and iso.residual(geometry, group) < 1e-12
    points = iso.act(geometry, group, lattice.centre)
    radii = orbit_radius(geometry, points)
    assert np.all(np.diff(radii) > -1e-6)
    gaps = np.linalg.norm(points[:, None] - points, axis=2) + 10 * np.eye(len(points))
    assert np.min(gaps) > np.min(np.abs(lattice.heights(lattice.centre)))
    np.testing.assert_array_equal(tl.elements(lattice, count=40), group[:40])
    # A radius keeps the same ones.
    middle = float((radii[99] + radii[100]) / 2)
    if radii[100] - radii[99] > 1e-3:
        np.testing.assert_allclose(tl.elements(lattice, radius=middle), group[:100], rtol=0, atol=1e-10)


@each
def test_no_element_is_missed(geometry, name):
    lattice = tl.named(geometry, name)
    radius = 3.2 if geometry != "sl2" else 5.0
    found = iso.act(geometry, tl.elements(lattice, radius=radius), lattice.centre)
    # All words of up to four letters, and shifts.
    words = [iso.identity(geometry)]
    level = words
    for _ in range(3 if len(lattice.walls) > 6 else 4):
        level = [iso.compose(geometry, w, s) for w in level for s in lattice.inverses]
        words += level
    points = iso.act(geometry, np.array(words), lattice.centre)
    points = points[orbit_radius(geometry, points) <= radius - 1e-6]
    gaps = np.min(np.linalg.norm(points[:, None] - found, axis=2), axis=1)
    assert np.max(gaps) < 1e-9


def test_elements_of_the_heisenberg_group(kernels):
    # All products A^i B^j C^k are the points [i, j, k + i j/2].
    r = np.arange(-12, 13)
    i, j, k = (v.ravel() for v in np.meshgrid(r, r, r, indexing="ij"))
    points = np.column_stack([i, j, k + i * j / 2, np.ones(len(i))])
    count = np.count_nonzero(kernels["nil"].distance(points) <= 5.0)
    assert len(tl.elements(tl.named("nil", "heisenberg"), radius=5.0)) == count


@each
def test_cell_table(geometry, name):
    lattice = tl.named(geometry, name)
    cells, following = tl.cell_table(lattice, 300)
    assert following.shape == (300, len(lattice.walls)) and following.dtype == np.int32
    np.testing.assert_array_equal(cells, tl.elements(lattice, count=300))
    k, f = np.nonzero(following < 300)
    assert len(k) > 300
    expected = iso.compose(geometry, cells[k], lattice.inverses[f])
    scale = np.max(np.abs(expected), axis=(1, 2))
    assert np.max(np.max(np.abs(cells[following[k, f]] - expected), axis=(1, 2)) / scale) < 1e-10


@each
def test_columns_of_cells(geometry, name):
    lattice, reach = tl.named(geometry, name), 20.0
    cells, following = tl.cell_table(lattice, 2000, reach)
    np.testing.assert_array_equal(cells[0], iso.identity(geometry))
    k, f = np.nonzero(following < len(cells))
    expected = iso.compose(geometry, cells[k], lattice.inverses[f])
    scale = np.max(np.abs(expected), axis=(1, 2))
    assert np.max(np.max(np.abs(cells[following[k, f]] - expected), axis=(1, 2)) / scale) < 1e-9
    # Up and down from home they go on to the end of the reach, and there they end.
    for wall in lattice.level_walls:
        cell, height = 0, 0.0
        while following[cell, wall] < len(cells):
            cell = following[cell, wall]
            height = abs(iso.act(geometry, cells[cell], lattice.centre)[iso.fibre(geometry)])
        low, high = lattice.levels
        assert reach - (high - low) - 1e-9 <= height <= reach


@each
def test_paths_and_neighbours(geometry, name):
    lattice = tl.named(geometry, name)
    around = tl.neighbours(lattice)
    np.testing.assert_array_equal(around[0], iso.identity(geometry))
    if geometry not in ("nil", "sl2"):
        np.testing.assert_array_equal(around[1:], lattice.inverses)
    wanted = tl.elements(lattice, count=12)[1:]
    for element, path in zip(wanted, tl.paths(lattice, wanted), strict=True):
        product = iso.identity(geometry)
        for wall in path:
            product = iso.compose(geometry, product, lattice.inverses[wall])
        np.testing.assert_allclose(product, element, rtol=0, atol=1e-10)


def test_a_side_of_a_twisted_prism_has_neighbours_at_several_heights():
    # Paper, figure 50: A, A C and A C^-1 lead over the side x = 1/2, and likewise on the others.
    lattice = tl.named("nil", "heisenberg")
    centres = iso.act("nil", tl.neighbours(lattice), lattice.centre)
    for side in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        there = centres[np.all(np.isclose(centres[:, :2], side), axis=1), 2]
        np.testing.assert_allclose(np.sort(there), [-1, 0, 1], atol=1e-12)
    assert len(centres) == 1 + 4 * 3 + 2


def test_mirrors_and_screws_along_the_fibre():
    # Levels that are mirrors: o's images are 2 h apart, every second cell is upside down.
    square = tl.named("h2xe", "orbi-torus")
    maps, walls = square.maps.copy(), square.walls.copy()
    for f, sign in ((4, 1.0), (5, -1.0)):
        maps[f] = iso.stabilizer("h2xe", np.diag([1.0, 1.0, -1.0]))
        maps[f, 3, 4] = -2 * sign * walls[f, -1]
    mirrored = tl.from_matrices("h2xe", maps, walls)
    assert mirrored.is_dirichlet
    group = tl.elements(mirrored, radius=4.0)
    above = group[np.max(np.abs(group[:, :3, :3] - np.eye(3)), axis=(1, 2)) < 1e-9]
    heights = np.sort(above[:, 3, 4])
    np.testing.assert_allclose(heights, mirrored.levels[1] * np.array([-4, -2, 0, 2, 4]), rtol=1e-12)
    assert sorted(above[:, 3, 3]) == [-1, -1, 1, 1, 1]
    points = random_points("h2xe", 100, 2.0, 17)
    assert mirrored.teleport(points)[2].all()
    # A screw: after the fibre's length, a quarter turn.
    turn = iso.stabilizer("h2xe", [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    maps = square.maps.copy()
    maps[4] = iso.compose("h2xe", maps[4], turn)
    maps[5] = iso.inverse("h2xe", maps[4])
    screw = tl.from_matrices("h2xe", maps, walls)
    assert screw.teleport(points)[2].all() and screw.is_dirichlet
    # One mirror alone.
    half = Prism("half", "h2xe", mirrored.walls[:5], mirrored.maps[:5])
    assert half.levels[0] == -np.inf and not half.finite_volume
    assert {e[3, 3] for e in tl.elements(half, radius=2.0)} == {1, -1}
    alone = Prism("alone", "h2xe", mirrored.walls[4:5], mirrored.maps[4:5])
    assert len(tl.elements(alone, count=10)) == 2


# --- lattices given by hand ---------------------------------------------------------------------------------


@each
def test_from_matrices_takes_every_named_lattice(geometry, name):
    lattice = tl.named(geometry, name)
    noise = 1 + 1e-11 * np.random.default_rng(18).uniform(-1, 1, lattice.maps.shape)
    # Levels first: they are put behind the sides.
    order = [*lattice.level_walls, *range(len(lattice.walls) - 2)]
    given = tl.from_matrices(geometry, (lattice.maps * noise)[order], 3.7 * lattice.walls[order])
    np.testing.assert_allclose(given.walls, lattice.walls, atol=2e-8)
    np.testing.assert_allclose(given.maps, lattice.maps, atol=2e-8)
    assert given.level_walls == lattice.level_walls
    assert iso.residual(geometry, given.maps) < 2e-14


def blame(geometry, name, spoil):
    lattice = tl.named(geometry, name)
    maps, walls = lattice.maps.copy(), lattice.walls.copy()
    maps, walls = spoil(maps, walls) or (maps, walls)
    with pytest.raises(tl.LatticeError) as caught:
        tl.from_matrices(geometry, maps, walls)
    return caught.value.what, caught.value.index, str(caught.value)


def put(array, index, value):
    array[index] = value


@pytest.mark.parametrize(
    ("geometry", "name", "spoil", "what", "index", "words"),
    [
        (
            "h2xe",
            "orbi-torus",
            lambda m, w: put(m, (1, 4, 0), 1),
            "generators",
            1,
            "last row must be [0, 0, 0, 0, 1]",
        ),
        ("h2xe", "orbi-torus", lambda m, w: put(m, (0, 0, 0), 1), "generators", 0, "A^T J A must be J"),
        ("s2xe", "cube", lambda m, w: put(m, (0, 0, 0), 2), "generators", 0, "3x3 block must be orthogonal"),
        (
            "s2xe",
            "cube",
            lambda m, w: put(m, (2, 3, 0), 1),
            "generators",
            2,
            "[[A, 0, 0], [0, e, s], [0, 0, 1]]",
        ),
        ("s2xe", "cube", lambda m, w: put(m, (2, 3, 3), 2), "generators", 2, "must be 1 or -1"),
        (
            "sl2",
            "genus-two",
            lambda m, w: put(m, (3, 3, 3), -1),
            "generators",
            3,
            "determinant of its upper left 3x3",
        ),
        (
            "h2xe",
            "orbi-torus",
            lambda m, w: put(m, (0, slice(3), slice(3)), -m[0, :3, :3]),
            "generators",
            0,
            "exchanges the sheets of the hyperboloid: its third diagonal entry must be positive",
        ),
        (
            "nil",
            "heisenberg",
            lambda m, w: put(m, (0, 0, 0), 2),
            "generators",
            0,
            "2x2 block must be orthogonal",
        ),
        (
            "nil",
            "heisenberg",
            lambda m, w: put(m, (0, 2, 1), 0),
            "generators",
            0,
            "must begin with (a d - b c)/2",
        ),
        ("nil", "heisenberg", lambda m, w: put(m, (0, 2, 2), -1), "generators", 0, "must be the determinant"),
        (
            "nil",
            "heisenberg",
            lambda m, w: put(m, (0, 3, 2), 1),
            "generators",
            0,
            "last row must be [0, 0, 0, 1]",
        ),
        ("nil", "heisenberg", lambda m, w: put(w, (1, 2), 0.1), "domain", 1, "neither a side [a, b, 0, d]"),
        ("sl2", "genus-two", lambda m, w: put(w, (8, 0), 0.1), "domain", 8, "nor a level [0, 0, 0, d, e]"),
        ("sl2", "genus-two", lambda m, w: put(w, (2, 4), 0.1), "domain", 2, "walls cannot lean in sl2"),
        (
            "sl2",
            "genus-two",
            lambda m, w: put(w, (2, 2), -3),
            "domain",
            2,
            "no boundary plane; a^2 + b^2 must exceed",
        ),
        ("nil", "heisenberg", lambda m, w: put(w, 1, [0, 0, 0, 1]), "domain", 1, "a, b must not both be 0"),
        (
            "nil",
            "heisenberg",
            lambda m, w: put(w, 2, -w[2]),
            "domain",
            2,
            "origin inside: d must be negative",
        ),
        (
            "h2xe",
            "orbi-torus",
            lambda m, w: put(w, 5, -w[5]),
            "domain",
            5,
            "origin inside: e must be negative",
        ),
        (
            "h2xe",
            "orbi-torus",
            lambda m, w: put(w, 0, -w[0]),
            "domain",
            0,
            "origin inside: c must be negative",
        ),
        (
            "nil",
            "heisenberg",
            lambda m, w: (m[[0, 2, 3, 4, 5]], w[[0, 2, 3, 4, 5]]),
            "generators",
            0,
            "no inverse",
        ),
        (
            "sl2",
            "fiber-loop",
            lambda m, w: (m[:1], w[:1]),
            "generators",
            0,
            "has no inverse among the generators",
        ),
        ("nil", "heisenberg", lambda m, w: put(m, [0, 1], m[[1, 0]]), "generators", 0, "moves the wrong way"),
        ("nil", "heisenberg", lambda m, w: put(w, (4, 3), -0.4), "domain", 4, "does not fit its generator"),
        (
            "s2xe",
            "cube",
            lambda m, w: put(w, 0, [1, 0, -0.9, 0, 0]),
            "domain",
            0,
            "does not fit its generator",
        ),
        (
            "nil",
            "heisenberg",
            lambda m, w: put(m, 4, iso.translation("nil", np.array([0.1, 0, -1, 1]))),
            "generators",
            4,
            "moves the fiber over the origin by 0.1",
        ),
        (
            "nil",
            "heisenberg",
            lambda m, w: (np.concatenate([m, m[4:]]), np.concatenate([w, w[4:]])),
            "generators",
            6,
            "is the same as number 5",
        ),
        (
            "nil",
            "heisenberg",
            lambda m, w: (
                np.array([*m, shift("nil", -3.0), shift("nil", 3.0)]),
                np.array([*w, [0, 0, 1, -1.5], [0, 0, -1, -1.5]]),
            ),
            "domain",
            6,
            "does not bound the domain",
        ),
        ("nil", "heisenberg", lambda m, w: put(m, (0, 0, 0), np.nan), "generators", 0, "not finite"),
        ("nil", "heisenberg", lambda m, w: (m, w[:3]), "domain", None, "6 generators but 3 half-spaces"),
        (
            "sl2",
            "genus-two",
            lambda m, w: (m[:, :4], w),
            "generators",
            None,
            "must be a list of 5x5 matrices",
        ),
        ("sl2", "genus-two", lambda m, w: (m, w[:, :4]), "domain", None, "half-spaces [a, b, c, d, e]"),
    ],
)
def test_from_matrices_says_what_is_wrong(geometry, name, spoil, what, index, words):
    assert blame(geometry, name, spoil)[:2] == (what, index)
    assert words in blame(geometry, name, spoil)[2]


def test_images_that_overlap_are_refused():
    # The fibre must be as long as the commutator of the sides, or that divided by a whole number.
    side = tl.named("nil", "heisenberg")
    # Periods next to each other to 6 digits are the same.
    periods = [
        (1.0, True),
        (0.5, True),
        (1 + 1e-8, True),
        (1 + 1e-5, False),
        (2.0, False),
        (0.7, False),
        (0.13, False),
    ]
    for period, good in periods:
        maps, walls = side.maps.copy(), side.walls.copy()
        maps[4], maps[5] = shift("nil", -period), shift("nil", period)
        walls[4:, 3] = -period / 2
        if good:
            assert tl.from_matrices("nil", maps, walls).levels[1] == period / 2
        else:
            with pytest.raises(tl.LatticeError, match="overlap, so that it does not tile space") as caught:
                tl.from_matrices("nil", maps, walls)
            assert caught.value.what == "generators"
    # Without levels the commutator maps the column to itself.
    with pytest.raises(tl.LatticeError, match="does not tile space"):
        tl.from_matrices("nil", side.maps[:4], side.walls[:4])
    # Other lifts of the octagon's sides climb by other multiples, which 2 pi divides, and 3 pi does not.
    surface = tl.named("sl2", "genus-two")
    for period, good in ((4 * np.pi, True), (6 * np.pi, False)):
        maps, walls = surface.maps.copy(), surface.walls.copy()
        maps[8], maps[9] = shift("sl2", -period), shift("sl2", period)
        walls[8:, 4] = -period / 2
        if good:
            assert tl.from_matrices("sl2", maps, walls).levels[1] == pytest.approx(period / 2)
        else:
            with pytest.raises(tl.LatticeError, match="does not tile space"):
                tl.from_matrices("sl2", maps, walls)


def test_walls_at_the_origin_and_walls_through_corners():
    # From both sides of the least distance of a wall from the origin.
    cube = tl.named("nil", "heisenberg")
    for depth, words in ((0.5 * INSIDE, "origin inside"), (2 * INSIDE, "does not fit")):
        walls = cube.walls.copy()
        walls[0, 3] = -depth
        with pytest.raises(tl.LatticeError, match=words):
            tl.from_matrices("nil", cube.maps, walls)
    # A fifth side that passes through a corner, or cuts it off.
    for cut, corners in ((0.5 * ON_WALL, 4), (2 * ON_WALL, 5)):
        sides = np.array([*cube.polygon.sides, np.array([1, 1, 0, -1 + cut]) / np.sqrt(2)])
        assert len(Polygon("e3", sides).corners) == corners
    assert Polygon("e3", sides).bounding == [0, 1, 2, 3, 4]
    sides[4, 3] = -1 / np.sqrt(2)
    assert Polygon("e3", sides).bounding == [0, 1, 2, 3]


def test_feet_of_sides():
    for base, sides in (("s3", [0.6, 0, 0, -0.8]), ("h3", [1.25, 0, 0, -0.75]), ("e3", [1, 0, 0, -3.0])):
        polygon = Polygon(base, np.array([sides]))
        foot = polygon.foot(0)
        assert abs(polygon.sides[0] @ foot) < 1e-15
        np.testing.assert_allclose(foot, iso.on_model(base, foot), rtol=1e-15)
        np.testing.assert_array_equal(polygon.nearest(0), foot)


def test_a_column_and_a_slab():
    side = tl.named("h2xe", "cusped-torus")
    column = tl.from_matrices("h2xe", side.maps[:4], side.walls[:4])
    assert column.level_walls == () and not column.finite_volume
    assert column.levels == (-np.inf, np.inf) and len(tl.edges(column)) == 0
    assert len(tl.elements(column, radius=3.0)) == len(
        {tuple(np.round(e[:3, 2], 6)) for e in tl.elements(side, radius=3.0)}
    )
    assert column.clearance(column.centre) == pytest.approx(np.arcsinh(1))
    square = tl.named("h2xe", "orbi-torus")
    upright = tl.edges(Prism("open", "h2xe", square.walls[:4], square.maps[:4]))
    assert [e.kinds for e in upright] == [("open", "open")] * 4
    np.testing.assert_allclose([e.angle for e in upright], np.pi / 4, rtol=1e-14)
    # Half of the sphere: a point and its antipode are one.
    wall = np.array([[0, 0, -1.0, 0, 0]])
    antipodal = tl.from_matrices("s2xe", np.diag([-1.0, -1, -1, 1, 1])[None], wall)
    assert antipodal.teleport(random_points("s2xe", 50, 1.0, 19))[2].all()
    assert len(tl.elements(antipodal, count=10)) == 2


def test_trial_points_are_in_the_domain():
    for geometry, name in NAMED:
        points = _trial_points(tl.named(geometry, name))
        assert TRIAL_POINTS / 10 < len(points) <= TRIAL_POINTS


# --- names --------------------------------------------------------------------------------------------------


def test_names():
    assert tl.names("nil") == ["heisenberg", "double-twist", "hexagonal", "half-turn"]
    assert tl.named("nil", "Dehn twist") is tl.named("nil", "heisenberg")
    assert tl.named("sl2", "orbiTorus").name == "orbi-sphere"
    assert tl.named("h2xe", "Cusped_Torus").name == "cusped-torus"
    assert tl.named("s2xe", "S2xS1").name == "hopf-manifold"
    with pytest.raises(tl.LatticeError, match="'heisenberg' is in nil"):
        tl.named("sl2", "heisenberg")
    for geometry, module in itertools.product(FIBRED, [tl]):
        for alias, name in module._ALIASES[geometry].items():
            assert name in module.names(geometry) and alias not in module.names(geometry)


def test_presentations_are_of_polyhedra():
    with pytest.raises(tl.LatticeError, match="is a prism"):
        tl.edge_cycles(tl.named("nil", "heisenberg"))
    with pytest.raises(tl.LatticeError, match="is a prism"):
        tl.presentation(tl.named("sl2", "genus-two"))


def test_a_pair_of_sides():
    (wall, back), (opposite, forth) = pair((1, 0, -0.5), shift("nil", 0.0), "nil")
    np.testing.assert_array_equal([wall, opposite], [[1, 0, -0.5], [-1, 0, -0.5]])
    np.testing.assert_array_equal(back, forth)
    assert base_radius("nil", np.array([3.0, 4.0, 9.0, 1.0])) == 5.0


@pytest.mark.parametrize("geometry", ["h3", "h2xe"])
def test_the_orbit_of_one_translation_ends_where_coordinates_end(geometry):
    # There are never 1000 elements within reach of the numbers.
    n, axis = iso.dimension(geometry), 2 if geometry == "h2xe" else 3
    step = np.eye(n)
    step[0, 0] = step[axis, axis] = np.cosh(1.0)
    step[0, axis] = step[axis, 0] = np.sinh(1.0)
    wall = np.zeros(n)
    wall[[0, axis]] = np.cosh(0.5), -np.sinh(0.5)
    other = wall * np.where(np.arange(n) == 0, -1.0, 1.0)
    lattice = tl.from_matrices(geometry, [iso.inverse(geometry, step), step], [wall, other])
    found = tl.elements(lattice, count=1000)
    assert len(found) == 2 * 25 + 1
    assert len(tl.elements(lattice, count=7)) == 7
