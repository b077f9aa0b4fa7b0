"""Moebius maps, and kernel-reflection sequences distorted by them, against all image spheres and samples.

In single precision every level rounds the point once more: a bound is off by up to 0.8 EPSILON (levels + 1)
times 1 and the point's own size (measured; see `rounding`). Double precision agrees to EXACT.
"""

import functools
import json
import warnings
from collections.abc import Callable

import krs_models as models
import krs_moebius_truth as truth
import krs_truth
import numpy as np
import pytest
from golden import DATA, EPSILON, Array, cut
from krs_truth import Record, length, vector

from thurston_cl.device import Device
from thurston_cl.krs import Model
from thurston_cl.krs.moebius import Map, bend
from thurston_cl.krs.sequence import MoebiusSequence
from thurston_cl.program import LANE_WIDTHS

RECORDS = json.loads((DATA / "krs.json").read_text(encoding="utf-8"))
KINDS = ("sphere", "capsule", "torcap", "lens")
EXACT = 1e-12

both_precisions = pytest.mark.parametrize("precision", EPSILON)
every_record = pytest.mark.parametrize("n", range(len(RECORDS["mokrs"])))


def model(record: Record, device: Device, precision: str = "double", lanes: int | None = None) -> Model:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return Model.from_dict(record, precision=precision, device=device, lanes=lanes)


@functools.cache
def chain(levels: int, seed: int, kinds: tuple[str, ...] = ("sphere",)) -> Record:
    turn = iter(range(levels + 1))
    return truth.chain(
        levels, seed, lambda rng, c: models.kernel(kinds[(seed + next(turn)) % len(kinds)], rng, c, 0.4)
    )


def points_near(record: Record, count: int, seed: int) -> Array:
    cloud = truth.samples(record, 20, seed)
    rng = np.random.default_rng([seed, 2])
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    return (low + high) / 2 + (high - low) * rng.uniform(-1.5, 1.5, (count, 3))


# Maps.


def test_the_truth_of_the_tests_agrees_with_the_records() -> None:
    for record in RECORDS["mokrs"]:
        points = vector(record["points"])
        assert np.abs(truth.brute(record, points) / record["true"] - 1).max() < 1e-13
        bounds = [truth.centered_bound(record, x) for x in points]
        assert np.abs(vector(bounds) / record["bound"] - 1).max() < 1e-11
        hits = truth.first_hits(record, *(vector([ray[key] for ray in record["rays"]]) for key in "od"))
        for ray, hit in zip(record["rays"], hits, strict=True):
            assert abs(hit - ray["t"]) < 1e-10 if ray["t"] is not None else hit == np.inf
        probes = record["probes"]
        away = truth.brute(record, vector([probe["c"] for probe in probes]))
        free = away >= [probe["r"] for probe in probes]
        assert free.tolist() == [probe["empty"] for probe in probes]
    for record in RECORDS["sphere_transform"]:
        inverse = truth.inverse(vector(record["H"]))
        center, radius, sign = truth.sphere_image(inverse, vector(record["center_in"]), record["radius_in"])
        assert np.abs(center - record["center_out"]).max() < 1e-13 * max(1, radius)
        assert abs(radius / record["radius_out"] - 1) < 1e-13
        assert sign == record["N_sign"]
    for record in RECORDS["gradient"]:
        m, q = vector(record["H"]), vector(record["q"])
        assert np.abs(truth.apply(m, q) - record["qw"]).max() < 1e-14
        assert abs(truth.factor(m, q) / record["factor"] - 1) < EXACT


def test_sphere_images(opencl_device: Device) -> None:
    for record in RECORDS["sphere_transform"]:
        inverse = Map(vector(record["H"])).inverse
        center, radius, sign = inverse.sphere_image([record["center_in"]], [record["radius_in"]])
        scale = max(1.0, record["radius_out"])
        assert np.abs(center[0] - record["center_out"]).max() <= EXACT * scale
        assert abs(radius[0] / record["radius_out"] - 1) <= EXACT
        assert sign[0] == record["N_sign"]
        # The record's own coefficients: center beta/alpha, radius^2 = |center|^2 - gamma/alpha.
        alpha, beta, gamma = record["out"]
        assert np.abs(center[0] - vector(beta)[1:] / alpha).max() <= 1e-10 * scale
        assert abs(radius[0] ** 2 - (length(center[0]) ** 2 - gamma / alpha)) <= 1e-10 * scale**2
        back, size, _ = Map(vector(record["H"])).sphere_image(center, radius)
        assert np.abs(back[0] - record["center_in"]).max() <= 1e-11 * max(1.0, record["radius_in"])
        assert abs(size[0] / record["radius_in"] - 1) <= 1e-11


def test_points_and_gradients(opencl_device: Device) -> None:
    for record in RECORDS["gradient"]:
        m = Map(vector(record["H"]))
        q, g = [record["q"]], [record["g"]]
        assert np.abs(m.apply(q)[0] - record["qw"]).max() <= EXACT
        assert np.abs(m.inverse.apply(m.apply(q))[0] - record["q"]).max() <= 1e-11
        push, factor = m.push(q, g)[0], m.factor(q)[0]
        assert abs(factor / record["factor"] - 1) <= EXACT
        assert np.abs(push - record["push"]).max() <= EXACT * length(vector(record["push"]))
        assert np.abs(push / length(push) - record["unit"]).max() <= EXACT
        assert np.abs(push / factor**2 - record["true_gradient"]).max() <= EXACT * length(
            vector(record["true_gradient"])
        )


def random_maps() -> dict[str, Array]:
    rng = np.random.default_rng(3)
    v, r = rng.normal(size=3), rng.normal(size=4)
    simple = {
        "identity": truth.IDENTITY,
        "translation": truth.translation(v),
        "dilation": truth.dilation(2.5),
        "rotation": truth.rotation(r),
        "mirror": truth.MIRROR,
        "inversion": truth.INVERSION,
        "distortion": truth.distortion(0.3 * v),
    }
    simple["all"] = truth.product(*(simple[key] for key in list(simple)[1:]))
    simple["similarity"] = truth.product(*(simple[key] for key in ("rotation", "translation", "dilation")))
    return simple


@pytest.mark.parametrize("name", random_maps())
def test_maps_of_every_kind(name: str, opencl_device: Device) -> None:
    matrix = random_maps()[name]
    m = Map(matrix)
    points = np.random.default_rng(4).normal(size=(200, 3))
    image = truth.apply(matrix, points)
    assert np.abs(m.apply(points) - image).max() <= EXACT * max(1, np.abs(image).max())
    assert np.abs(m.factor(points) / truth.factor(matrix, points) - 1).max() <= EXACT
    assert np.abs(m.inverse.apply(image) - points).max() <= 1e-11 * max(1, np.abs(image).max())
    both = (m @ Map(random_maps()["distortion"])).apply(points)
    wanted = truth.apply(matrix, truth.apply(random_maps()["distortion"], points))
    assert np.abs(both - wanted).max() <= 1e-11 * max(1, np.abs(wanted).max())
    # The differential, by differences.
    vectors = np.random.default_rng(5).normal(size=(200, 3))
    ahead, behind = (truth.apply(matrix, points + h * vectors) for h in (1e-6, -1e-6))
    wanted = (ahead - behind) / 2e-6
    assert (length(m.push(points, vectors) - wanted) <= 1e-5 * length(wanted)).all()


@pytest.mark.parametrize("far", [1.0, 100.0])
@pytest.mark.parametrize("radius", [1e-4, 1e-2, 1.0])
def test_images_of_small_spheres_far_out(far: float, radius: float, opencl_device: Device) -> None:
    """Coefficients of spheres lose all digits of a small radius; centers and radii keep theirs."""
    rng = np.random.default_rng(6)
    matrix = random_maps()["all"]
    centers = far * rng.normal(size=(200, 3))
    pole = truth.pole(matrix)
    assert pole is not None
    centers = centers[np.abs(length(centers - pole) - radius) > 0.3 * length(centers - pole)]
    found = Map(matrix).sphere_image(centers, np.full(len(centers), radius))
    # The truth's radii, differences of images, lose digits where these are small: here by factor and pole.
    radii = radius * truth.factor(matrix, centers) / np.abs(1 - (radius / length(centers - pole)) ** 2)
    for c, center, size, sign, wanted_size in zip(centers, *found, radii, strict=True):
        wanted = truth.sphere_image(matrix, c, radius)
        assert abs(wanted[1] - wanted_size) <= EXACT * max(1, length(wanted[0]))
        assert np.abs(center - wanted[0]).max() <= EXACT * max(1, length(wanted[0]))
        assert abs(size / wanted_size - 1) <= EXACT
        assert sign == wanted[2]


NOT_OF_SPACE = [
    pytest.param([[[1, 0, 0, 0], [1, 0, 0, 0]], [[0, 0, 0, 0], [1, 0, 0, 0]]], id="q -> q + 1"),
    pytest.param([[[1, 1, 0, 0], [0, 0, 0, 0]], [[0, 0, 0, 0], [1, 0, 0, 0]]], id="q -> (1 + i) q"),
    pytest.param([[[1, 0, 0, 0], [0, 0, 0, 0]], [[1, 0, 0, 0], [1, 0, 0, 0]]], id="q -> q/(q + 1)"),
]


@pytest.mark.parametrize("matrix", NOT_OF_SPACE)
def test_maps_that_do_not_keep_space_are_refused(matrix: list, opencl_device: Device) -> None:
    with pytest.raises(ValueError, match=r"R\^3"):
        Map(vector(matrix))
    record = chain(3, 2)
    broken = {"G": [record["G"][0], matrix, record["G"][2]], "kernels": record["kernels"]}
    with pytest.raises(ValueError, match=r"G of level 1: this Moebius map does not keep R\^3"):
        model(broken, opencl_device)


# Bounds.


def rounding(record: Record, points: Array) -> Array:
    """Errors (N,) that single precision explains: see the head."""
    levels = len(record["G"])
    return 1.5 * EPSILON["single"] * (levels + 1) * (1 + length(points))


@both_precisions
@every_record
def test_bounds_of_the_records(n: int, precision: str, opencl_device: Device) -> None:
    record = RECORDS["mokrs"][n]
    points = cut(record["points"], precision)
    built = model(record, opencl_device, precision)
    found, distance = built.bound(points), built.distance(points)
    if precision == "double":
        true, centered = vector(record["true"]), vector(record["bound"])
        limit = EXACT * true
    else:
        true = truth.brute(record, points)
        centered = vector([truth.centered_bound(record, x) for x in points])
        limit = rounding(record, points)
    assert (found > 0).all()
    assert (np.abs(found - centered) <= limit).all()
    # Balls that hold whole levels let it grow, never beyond the distance.
    assert (distance >= found).all()
    assert (distance <= true + limit).all()


@pytest.mark.parametrize("levels", [0, 1, 2, 4, 6])
def test_bounds_of_spheres(levels: int, opencl_device: Device) -> None:
    record = chain(levels, levels + 3)
    points = points_near(record, 5000, levels)
    built = model(record, opencl_device)
    found, distance, true = built.bound(points), built.distance(points), truth.brute(record, points)
    outside = true > 0
    assert outside.mean() > 0.3
    assert ((found > 0) == outside).all()
    assert ((distance > 0) == outside).all()
    assert (found <= distance)[outside].all()
    assert (distance <= true + EXACT)[outside].all()
    # Inside no deeper than it is: what is cut out by the model is marched by this.
    assert (found >= true - EXACT)[~outside].all()
    assert (distance >= true - EXACT)[~outside].all()
    centered = vector([truth.centered_bound(record, x) for x in points[:60]])
    assert np.abs(found[:60] - centered).max() <= 1e-9
    if levels >= 4:  # balls that hold levels are worth something
        assert (distance > 1.01 * found)[outside].mean() > 0.5


@pytest.mark.parametrize("kinds", [KINDS])
def test_bounds_of_all_kinds_of_kernels(kinds: tuple[str, ...], opencl_device: Device) -> None:
    """Samples are never nearer than the surface; close above it, the bound is nearly the distance."""
    record = chain(4, 5, kinds)
    found = model(record, opencl_device)
    cloud = truth.samples(record, 400, 1)
    points = points_near(record, 1500, 7)
    nearest = np.array([length(cloud - x).min() for x in points])
    bound = found.bound(points)
    assert (bound <= nearest + EXACT).all()
    assert np.median((bound / nearest)[bound > 0]) > 0.4
    assert np.abs(found.bound(cloud)[found.bound(cloud) > -1e-9]).max() <= 1e-10
    for height, share in ((1e-3, 0.97), (1e-4, 0.995)):
        above = cloud + height * found.normal(cloud)
        bound = found.bound(above)
        # Where the nearest is what lies below, and not another kernel in front of it.
        alone = np.abs(found.bound(cloud)) < 1e-9
        assert np.quantile(bound[alone] / height, 0.1) > share


def test_maps_without_distortion_give_the_sequence_of_mirrors(opencl_device: Device) -> None:
    plain = models.chain(5, 3, ("sphere",))
    points = models.points_around(plain, 3000, 2)
    found = model(truth.undistorted(plain), opencl_device).bound(points)
    assert np.abs(found - krs_truth.brute(plain, points)).max() <= 1e-12


def test_smooth_normals_without_distortion_are_those_of_mirrors(
    opencl_device: Device,
) -> None:
    plain = models.chain(4, 3, ("sphere",), 0.4)
    widths = [0.2, 0.3, 0.0, 0.4]
    points = models.points_around(plain, 3000, 2)
    found = model(truth.undistorted(plain) | {"smooth": widths}, opencl_device).normal(points)
    mirrored = model(plain | {"smooth": widths}, opencl_device).normal(points)
    sharp = model(plain, opencl_device).normal(points)
    assert (length(mirrored - sharp) > 0.01).mean() > 0.1
    assert np.quantile(length(found - mirrored), 0.995) <= 1e-11  # but for ties


@pytest.mark.parametrize("levels", [1, 4])
def test_expansions(levels: int, opencl_device: Device) -> None:
    record = chain(levels, 4)
    found = model(record, opencl_device)
    instances, wanted = found.expand(), truth.expand(record)
    assert len(instances) == len(wanted) == found.instances == 2 ** (levels + 1) - 1
    mark = 0.1 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
    for kernel in range(levels + 1):
        ours, theirs = (
            np.array([truth.apply(np.asarray(m), mark - [1, 0, 0]).ravel() for k, m in side if k == kernel])
            for side in (instances, wanted)
        )
        assert len(ours) == len(theirs) == 2 ** (levels - kernel)
        off = np.abs(ours[:, None] - theirs).max(axis=2)
        assert sorted(off.argmin(axis=1)) == list(range(len(ours)))
        assert off.min(axis=1).max() <= 1e-11


def test_a_model_lies_within_its_radius(opencl_device: Device) -> None:
    record = chain(4, 2)
    assert length(truth.samples(record, 100, 3)).max() <= model(record, opencl_device).radius * (1 + 1e-9)


@pytest.mark.parametrize("far", [1.0, 100.0])
@pytest.mark.parametrize("radius", [1e-4, 1e-2, 1.0])
def test_single_precision_far_out_and_small(far: float, radius: float, opencl_device: Device) -> None:
    """Absolute errors are those of the coordinates in float, however small the model is and how far: at 100,
    with radii of 1e-4, more than the model itself, which one can then only see the place of."""
    base = chain(4, 6)
    offset = far * np.array([0.48, 0.6, -0.64])
    last = truth.product(truth.translation(offset), truth.dilation(radius), vector(base["G"][-1]))
    record = {"G": [*base["G"][:-1], last.tolist()], "kernels": base["kernels"]}
    spread = np.geomspace(1, 100 if radius < 1e-2 else 3, 50)[:, None]
    points = cut(offset + radius * spread * points_near(base, 50, 8), "single")
    found = model(record, opencl_device, "single").bound(points)
    true = truth.brute(record, points)
    centered = vector([truth.centered_bound(record, x) for x in points])
    limit = rounding(record, points)
    outside = true > limit
    assert outside.sum() > 20
    assert (found <= true + limit)[outside].all()
    assert (found >= centered - limit)[outside].all()


@both_precisions
def test_widths_give_the_same_bits(precision: str, opencl_device: Device) -> None:
    record = chain(4, 5, KINDS)
    points = points_near(record, 2003, 9)
    radii = np.geomspace(1e-3, 1, len(points))
    first = model(record, opencl_device, precision, 1)
    for lanes in LANE_WIDTHS[1:] if precision == "single" else (4, 16):
        other = model(record, opencl_device, precision, lanes)
        assert (other.bound(points) == first.bound(points)).all(), lanes
        assert (other.normal(points) == first.normal(points)).all(), lanes
        assert (other.unbounding(points, radii) == first.unbounding(points, radii)).all(), lanes


# Normals.


@both_precisions
def test_normals_on_spheres(precision: str, opencl_device: Device) -> None:
    record = chain(4, 8)
    centers, radii, signs = truth.spheres(record)
    rng = np.random.default_rng(2)
    v = rng.normal(size=(len(centers), 50, 3))
    v /= length(v)[..., None]
    points = (centers[:, None] + radii[:, None, None] * v).reshape(-1, 3)
    wanted = (signs[:, None, None] * v).reshape(-1, 3)
    own = np.repeat(np.arange(len(centers)), 50)
    gaps = signs * (length(points[:, None] - centers) - radii)
    gaps[np.arange(len(points)), own] = np.inf
    alone = gaps.min(axis=1) > 1e-3
    normal = model(record, opencl_device, precision).normal(points)
    assert np.abs(length(normal) - 1).max() <= 4 * EPSILON[precision]
    # The direction from a center loses what its point lost, over the radius.
    limit = 40 * EPSILON[precision] / np.minimum(1, radii)[own]
    assert (length(normal - wanted) <= limit)[alone].all()


# Probes and rays.


@both_precisions
@every_record
def test_probes_of_the_records(n: int, precision: str, opencl_device: Device) -> None:
    record = RECORDS["mokrs"][n]
    centers = cut([probe["c"] for probe in record["probes"]], precision)
    radii = cut([probe["r"] for probe in record["probes"]], precision)
    found = model(record, opencl_device, precision).unbounding(centers, radii)
    assert found.dtype == bool
    assert found.tolist() == [probe["accept"] for probe in record["probes"]]
    assert not (found & ~(truth.brute(record, centers) >= radii)).any()


@pytest.mark.parametrize("kinds", [("sphere",), KINDS])
def test_a_ball_that_unbounds_is_free(kinds: tuple[str, ...], opencl_device: Device) -> None:
    record = chain(4, 5, kinds)
    found = model(record, opencl_device)
    points = points_near(record, 1500, 4)
    cloud = truth.samples(record, 400, 2)
    nearest = np.array([length(cloud - x).min() for x in points])
    share = np.random.default_rng(1).uniform(0.2, 1.5, len(points))
    accepted = found.unbounding(points, share * nearest)
    assert accepted.mean() > 0.1
    assert (share[accepted] <= 1 + 1e-12).all()
    with_balls = free_with_balls(found)(points, share * nearest)
    assert (share[with_balls] <= 1 + 1e-12).all()
    assert (with_balls >= accepted).all()
    assert with_balls.sum() > accepted.sum()
    # What the bound promises is accepted: it is the smaller of the two.
    bound = found.bound(points)
    plain = vector([truth.centered_bound(record, x) for x in points[:100]])
    safe = np.minimum(bound[:100], plain) * (1 - 1e-9)
    assert found.unbounding(points[:100], np.maximum(safe, 0))[safe > 0].all()


def test_what_is_no_ball_unbounds_nothing(opencl_device: Device) -> None:
    found = model(chain(4, 5), opencl_device)
    with pytest.raises(ValueError, match=r"radii\[0\] is nan"):
        found.unbounding([[0.0, 0, 5]], [np.nan])
    with pytest.raises(ValueError, match="2 centers and 3 radii; expected as many"):
        found.unbounding(np.zeros((2, 3)), [1.0, 1, 1])
    assert found.unbounding(np.full((2, 3), 5.0), [1e-3, -1e-3]).tolist() == [True, False]


def sphere_trace(found: Callable[[Array], Array], o: Array, d: Array, eps: float, end: float) -> Array:
    t = np.zeros(len(o))
    for _ in range(3000):
        step = found(o + t[:, None] * d)
        going = (step > eps * t) & (t < end)
        if not going.any():
            return t
        t = np.where(going, t + step, t)
    raise AssertionError("rays that do not end")


def binary_trace(
    free: Callable[[Array, Array], np.ndarray], o: Array, d: Array, eps: float, end: float
) -> Array:
    """Corrected algorithm 2: first across the ball that was tried, then the next is tried twice as large."""
    t, s = np.zeros(len(o)), np.ones(len(o))
    for _ in range(3000):
        going = (s > eps * t) & (t < end)
        if not going.any():
            return t
        accepted = free(o + (t + s)[:, None] * d, s) & going
        t = np.where(accepted, t + 2 * s, t)
        s = np.where(accepted, 2 * s, np.where(going, 0.3 * s, s))
    raise AssertionError("rays that do not end")


def free_with_balls(found: Model) -> Callable[[Array, Array], np.ndarray]:
    """As `Model.unbounding`, but with balls that hold levels, as rays ask in pictures."""

    def free(centers: Array, radii: Array) -> np.ndarray:
        rows = [np.concatenate([centers, np.ones((len(centers), 1))], axis=1), radii[:, None]]
        numbers = np.array(found.sequence.numbers)
        return found.program.run("moebius_sequence_over_unbounding", rows, 1, numbers=numbers)[:, 0] > 0

    return free


def rays(record: Record, count: int, seed: int) -> tuple[Array, Array]:
    """From outside, towards somewhere inside."""
    cloud = truth.samples(record, 20, seed)
    rng = np.random.default_rng([seed, 3])
    middle, size = cloud.mean(axis=0), np.ptp(cloud, axis=0).max()
    o = middle + 2 * size * np.array([models.direction(rng) for _ in range(count)])
    d = cloud[rng.integers(len(cloud), size=count)] + 0.05 * size * rng.normal(size=(count, 3)) - o
    return o, d / length(d)[:, None]


@pytest.mark.parametrize("method", ["bound", "balls"])
def test_rays_do_not_stop_at_poles(method: str, opencl_device: Device) -> None:
    """The centered bound vanishes there like the distance from the pole, and a ball that holds the pole is
    turned inside out: a speck in empty space as large as the threshold, one for each map and mirror image.
    Balls that hold the levels tell that it is empty."""
    eps, count = 1e-3, 0
    for record in (*RECORDS["mokrs"], *(chain(levels, 2) for levels in (3, 4, 5, 6))):
        spots = truth.blind_spots(record)
        true = truth.brute(record, spots)
        size = np.abs(truth.samples(record, 20, 1)).max()
        spots = spots[true > 0.2 * size]
        count += len(spots)
        found = model(record, opencl_device)
        rng = np.random.default_rng(1)
        for spot in spots:
            d = np.array([models.direction(rng) for _ in range(100)])
            away = 5 * size
            # Past the pole, nearer than the threshold there.
            aim = spot + 0.5 * eps * away * rng.uniform(-1, 1, (100, 3)) - (spot - away * d)
            o, u = spot - away * d, aim / length(aim)[:, None]
            if method == "bound":
                t = sphere_trace(found.distance, o, u, eps, 3 * away)
            else:
                # A ball of the last size that was refused is larger: see BINARY_ACCURACY.
                t = binary_trace(free_with_balls(found), o, u, 0.3 * eps, 3 * away)
            stop = o + t[:, None] * u
            in_the_air = (t < 3 * away) & (truth.brute(record, stop) > 2 * eps * t)
            assert in_the_air.sum() == 0, (len(record["G"]), spot)
    assert count > 15


def test_balls_are_where_poles_need_them(opencl_device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    """Next to each pole a good part of the distance is known; without the balls that are there for poles
    alone, in some models next to nothing.
    """

    def shares() -> list[float]:
        found = []
        for record in (
            *RECORDS["mokrs"],
            *(chain(levels, seed) for levels in (5, 6, 7, 8) for seed in (2, 3, 4)),
        ):
            spots = truth.blind_spots(record)
            true, size = truth.brute(record, spots), np.abs(truth.samples(record, 20, 1)).max()
            clear = true > 0.02 * size
            distance = model(record, opencl_device).distance(spots[clear] + 1e-6 * size)
            found.append(float(np.min(distance / true[clear], initial=1.0)))
        return found

    assert min(shares()) > 0.2
    monkeypatch.setattr(MoebiusSequence, "_needs_ball", lambda self, level: False)
    bare = shares()
    assert sum(share < 1e-4 for share in bare) > 5
    assert max(bare) < 1 + 1e-9


@both_precisions
def test_at_a_pole_there_is_room(precision: str, opencl_device: Device) -> None:
    """A map whose pole has no rounding, so that a camera may stand on it."""
    pole, ball = np.array([[0.0, 0, 1]]), models.kernel("sphere", np.random.default_rng(1), [-0.4, 0, 0], 0.2)
    record = {"G": [bend([0, 0, -1]).matrix.tolist()], "kernels": [ball, {"type": "empty"}]}
    found = model(record, opencl_device, precision)
    true = truth.brute(record, pole)
    assert 0 < found.distance(pole) <= true
    assert 0 <= found.bound(pole) <= true


@pytest.mark.parametrize("source", ["records", "random"])
@pytest.mark.parametrize("method", ["bound", "balls"])
def test_rays_stop_where_they_hit(method: str, source: str, opencl_device: Device) -> None:
    eps = 1e-4
    for n in range(len(RECORDS["mokrs"]) if source == "records" else 3):
        if source == "records":
            record = RECORDS["mokrs"][n]
            o, d = (vector([ray[key] for ray in record["rays"]]) for key in "od")
            hit = vector([np.inf if ray["t"] is None else ray["t"] for ray in record["rays"]])
        else:
            record = chain(3 + n, n + 1)
            o, d = rays(record, 150, n)
            hit = truth.first_hits(record, o, d)
        found = model(record, opencl_device)
        end = 4 * np.abs(hit[np.isfinite(hit)]).max()
        if method == "bound":
            t, slack = sphere_trace(found.bound, o, d, eps, end), 1.2
        else:  # the last ball that was refused is s/0.3 large, and reaches twice as far
            t, slack = binary_trace(found.unbounding, o, d, eps, end), 7.0
        meets = np.isfinite(hit)
        assert meets.sum() >= 10
        assert (t <= hit + 1e-9 * (1 + t)).all()  # never beyond the surface
        stopped = t < end
        assert stopped[meets].all()
        away = truth.brute(record, o + t[:, None] * d)
        assert (away <= slack * eps * t)[stopped].all()
        # A ray that misses may stop only where it nearly touches.
        assert (stopped & ~meets).sum() <= 0.1 * len(o)
