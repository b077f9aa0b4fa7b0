"""Trees, shrubs, forests and corals: what holds of their records, and the words that scenes have for them."""

import functools
import inspect
import math
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError

from thurston_cl import krs
from thurston_cl.device import Device
from thurston_cl.krs import Model
from thurston_cl.krs.recipes import branches
from thurston_cl.krs.recipes.branches import Mirror, copies, faults
from thurston_cl.krs.recipes.coral import coral
from thurston_cl.krs.recipes.forest import forest
from thurston_cl.krs.recipes.hyperbolic_forest import hyperbolic_forest
from thurston_cl.krs.recipes.meadow import meadow
from thurston_cl.krs.recipes.moebius_coral import moebius_coral
from thurston_cl.krs.recipes.palm_leaf import palm_leaf
from thurston_cl.krs.recipes.rock import rock
from thurston_cl.krs.recipes.shrub import shrub
from thurston_cl.krs.recipes.terrain import terrain
from thurston_cl.krs.recipes.tree import tree
from thurston_cl.krs.record import sequence_of
from thurston_cl.scene.base import Problem, problems_of
from thurston_cl.scene.krs_plants import Coral, Forest, Meadow, Plant, Shrub, Tree
from thurston_cl.scene.krs_recipe import Recipe

Array = NDArray[np.float64]
Recipes = Callable[..., dict[str, Any]]

RECIPES: dict[str, Recipes] = {"tree": tree, "shrub": shrub, "forest": forest, "coral": coral}
NODES: dict[str, type[Plant]] = {"tree": Tree, "shrub": Shrub, "forest": Forest, "coral": Coral}
# How many levels of each are further out than the first branch, and how many materials it has.
AROUND = {"tree": 0, "shrub": 3, "forest": 10, "coral": 0}
MATERIALS = {"tree": 2, "shrub": 2, "forest": 3, "coral": 2}
SEEDS = (0, 1, 2, 3)

every_recipe = pytest.mark.parametrize("name", RECIPES)
every_seed = pytest.mark.parametrize("seed", SEEDS)


@functools.cache
def made(name: str, seed: int) -> dict[str, Any]:
    return RECIPES[name](seed=seed)


def normals(record: dict[str, Any]) -> Array:
    return np.array([mirror["u"] for mirror in record["mirrors"]])


def offsets(record: dict[str, Any]) -> Array:
    return np.array([mirror["w"] for mirror in record["mirrors"]])


def route(record: dict[str, Any]) -> list[dict[str, Any]]:
    """The branches of the route, from the foot outwards."""
    return [kernel for kernel in reversed(record["kernels"]) if kernel["type"] == "torcap"]


def chords(record: dict[str, Any]) -> Array:
    """The directions of the branches of the route."""
    ways = np.array([np.subtract(branch["q"], branch["p"]) for branch in route(record)])
    directions: Array = ways / np.linalg.norm(ways, axis=1)[:, np.newaxis]
    return directions


def forks(name: str, record: dict[str, Any]) -> list[tuple[Array, float]]:
    """The mirrors at the forks of the route, from the first fork outwards."""
    pairs = list(zip(normals(record), offsets(record), strict=True))[::-1]
    return pairs[AROUND[name] : AROUND[name] + len(route(record)) - 1]


def model(record: dict[str, Any], device: Device) -> Model:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # plants are clipped: the caps of branches reach through their forks
        return Model.from_dict(record, device=device)


@every_seed
@every_recipe
def test_records_are_those_of_sequences(name: str, seed: int) -> None:
    record = made(name, seed)
    assert set(record) == {"mirrors", "kernels", "clips"}
    assert len(record["kernels"]) == len(record["mirrors"]) + 1 <= 41
    np.testing.assert_allclose(np.linalg.norm(normals(record), axis=1), 1, atol=1e-14)
    used = {kernel["mat"] for kernel in record["kernels"] if kernel["type"] != "empty"}
    assert used == set(range(MATERIALS[name]))
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="kernels? .* reach")
        assert sequence_of(record).levels == len(record["mirrors"])


@every_recipe
def test_a_seed_always_gives_the_same_record_and_another_gives_another(name: str) -> None:
    recipe = RECIPES[name]
    assert recipe(seed=5) == recipe(seed=5)
    assert recipe(seed=5) != recipe(seed=6)
    assert recipe() == recipe(seed=0)


@every_seed
@every_recipe
def test_a_mirror_goes_through_every_fork_and_what_follows_is_before_it(name: str, seed: int) -> None:
    record = made(name, seed)
    branch = route(record)
    mirrors = forks(name, record)
    assert len(mirrors) == len(branch) - 1 >= 8
    for (normal, offset), before, after in zip(mirrors, branch, branch[1:], strict=False):
        assert before["q"] == after["p"]
        assert normal @ before["q"] == pytest.approx(offset, abs=1e-12)
        assert normal @ after["q"] < offset - 0.1 * math.dist(after["p"], after["q"])


@every_seed
@every_recipe
def test_branches_get_thinner(name: str, seed: int) -> None:
    radii = [branch["r"] for branch in route(made(name, seed))]
    taper = inspect.signature(coral if name == "coral" else shrub if name == "shrub" else tree)
    ratio = taper.parameters["taper"].default
    assert radii[1] / radii[0] == pytest.approx(math.sqrt(ratio), rel=1e-12)
    np.testing.assert_allclose(np.divide(radii[2:], radii[1:-1]), ratio, rtol=1e-12)


@every_seed
@pytest.mark.parametrize("name", ["tree", "forest", "coral"])
def test_the_two_children_of_the_first_fork_are_unequal(name: str, seed: int) -> None:
    """They turn from the trunk by angles that differ by at least as much as the mirror leans."""
    record = made(name, seed)
    normal, _ = forks(name, record)[0]
    trunk, child = chords(record)[:2]
    other = child - 2 * (child @ normal) * normal
    angles = np.degrees(np.arccos([child @ trunk, other @ trunk]))
    assert abs(angles[0] - angles[1]) > 6


def test_without_lean_the_two_children_of_every_fork_are_equal() -> None:
    record = tree(seed=1, lean=0.0, upright=0.0)
    along = chords(record)
    for (normal, _), before, child in zip(forks("tree", record), along, along[1:], strict=False):
        other = child - 2 * (child @ normal) * normal
        assert other @ before == pytest.approx(child @ before, abs=1e-12)


def test_upright_mirrors_keep_what_is_up() -> None:
    """At 1 the second mirror keeps 1/13 of its lean: the least, and more of each one further out."""
    leans = {
        upright: np.array([forks("tree", tree(seed=seed, upright=upright))[1][0][2] for seed in range(12)])
        for upright in (0.0, 1.0)
    }
    assert np.abs(leans[1.0]).max() < math.sin(math.radians(60)) / 13
    assert np.abs(leans[0.0]).mean() > 0.15


@every_seed
@every_recipe
def test_the_route_starts_below_the_ground_and_stays_above_it(name: str, seed: int) -> None:
    """Its foot is deeper than its round end, and no other branch is in the ground."""
    first, *others = route(made(name, seed))
    assert first["p"][2] < -first["r"]
    assert first["q"][2] > first["r"]
    for branch in others:
        assert min(branch[end][2] for end in "pqm") > branch["r"]


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("name", ["tree", "coral"])
def test_no_branch_is_in_the_ground(name: str, seed: int) -> None:
    record = RECIPES[name](levels=10, seed=seed)
    ends = [np.array(branch["q"]) for branch in route(record)]
    found = copies(ends, [Mirror(*pair) for pair in forks(name, record)])
    assert len(found.ends) == 2**10 - 1
    assert found.ends[~found.lost, 2].min() > 0.1


@every_seed
def test_the_trunk_stands_upright_below_the_middle_of_the_crown(seed: int) -> None:
    record = tree(levels=10, seed=seed)
    np.testing.assert_allclose(chords(record)[0], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(route(record)[0]["q"], [0, 0, 1.7], atol=1e-15)
    ends = [np.array(branch["q"]) for branch in route(record)]
    found = copies(ends, [Mirror(*pair) for pair in forks("tree", record)])
    kept = found.ends[~found.lost]
    assert np.linalg.norm(kept.mean(axis=0)[:2]) < 0.15 * np.linalg.norm(kept, axis=1).max()


@every_seed
@pytest.mark.parametrize("name", ["tree", "shrub", "forest"])
def test_leaves_are_at_the_last_twig_and_before_their_mirrors(name: str, seed: int) -> None:
    record = RECIPES[name](seed=seed, leaves=4)
    twig = route(record)[-1]
    along = chords(record)[-1]
    for level, leaf in enumerate(record["kernels"][:4]):
        assert leaf["type"] == "lens"
        assert np.linalg.norm(leaf["a"]) == pytest.approx(1, abs=1e-12)
        way = np.subtract(leaf["c"], twig["q"])
        # No further from the axis of the twig than its stalk is long, and its rim nearly reaches the axis.
        aside = np.linalg.norm(way - (way @ along) * along)
        assert 0.5 * leaf["b"] < aside < 1.1 * leaf["b"]
        for normal, offset in zip(normals(record)[level:4], offsets(record)[level:4], strict=True):
            assert normal @ twig["q"] == pytest.approx(offset, abs=1e-12)
        assert normals(record)[level] @ leaf["c"] < offsets(record)[level]
    assert [kernel["type"] for kernel in RECIPES[name](leaves=0)["kernels"]].count("lens") == 0


def test_a_coral_ends_in_a_tip_and_has_buds_around_it() -> None:
    record = coral(buds=2)
    twig = route(record)[-1]
    tip, *buds = record["kernels"][:3]
    assert (tip["type"], tip["c"], tip["mat"]) == ("sphere", twig["q"], 1)
    assert tip["r"] == pytest.approx(1.12 * twig["r"])
    along = chords(record)[-1]
    for bud in buds:
        way = np.subtract(bud["c"], twig["q"])
        assert np.linalg.norm(way - (way @ along) * along) == pytest.approx(0.9 * twig["r"])
        assert way @ along < 0
        assert bud["mat"] == 0
    assert len(coral(buds=0)["mirrors"]) == len(record["mirrors"]) - 2


def test_a_tip_of_a_coral_may_be_a_finger() -> None:
    record = coral(buds=0, tip_length=1.5)
    twig, along = route(record)[-1], chords(record)[-1]
    finger = record["kernels"][0]
    assert (finger["type"], finger["a"], finger["mat"]) == ("capsule", twig["q"], 1)
    # It goes on where the twig ends, as in the mirror at its foot, which therefore doubles nothing.
    drawn = np.subtract(finger["b"], finger["a"])
    np.testing.assert_allclose(drawn, 3 * twig["r"] * along, atol=1e-12)
    assert abs(normals(record)[0] @ along) < 1e-12


def test_stems_of_a_coral_grow_side_by_side_out_of_the_ground() -> None:
    record = coral(stems=2, seed=3)
    around = normals(record)[::-1][:2]
    assert (offsets(record)[::-1][:2] == 0).all()
    assert (np.abs(around[:, 2]) < 0.09).all()
    assert [kernel["type"] for kernel in record["kernels"][-2:]] == ["empty", "empty"]
    foot, fork = (np.array(route(record)[0][key]) for key in "pq")
    # On the side that is doubled, below the ground, leaning away from the middle.
    assert (around @ foot < 0).all()
    assert (around @ fork < 0).all()
    assert foot[2] < 0 < fork[2]
    assert np.linalg.norm(fork[:2]) > np.linalg.norm(foot[:2])


def test_a_shrub_has_its_stems_in_the_last_of_equal_sectors() -> None:
    """Every mirror around the middle halves what the mirrors before it leave of the circle."""
    record = shrub(stems=4, seed=7)
    around = normals(record)[::-1][:4]
    assert (offsets(record)[::-1][:4] == 0).all()
    assert (np.abs(around[:, 2]) < 0.09).all()
    azimuths = np.radians(np.arange(0.05, 360, 0.1))
    circle = np.stack([np.cos(azimuths), np.sin(azimuths)])
    before = (around[:, :2] @ circle < 0).cumprod(axis=0)
    np.testing.assert_allclose(before.mean(axis=1), [1 / 2, 1 / 4, 1 / 8, 1 / 16], atol=1e-3)
    foot = np.array(route(record)[0]["p"])
    assert (around @ foot < 0).all()
    assert record["kernels"][-4:] == [{"type": "empty"}] * 4


def test_copies_tell_what_is_cut_off_and_what_hangs_in_the_air() -> None:
    """A trunk to (0, 0, 1), a branch that crosses its mirror x = 0, and a twig that comes back."""
    ends = [np.array(end, float) for end in ([0, 0, 1], [1, 0, 2], [-1, 0, 3])]
    mirrors = [Mirror(np.array([1.0, 0, 0]), 0.0), Mirror(np.array([0, 1.0, 0]), 0.0)]
    found = copies(ends, mirrors)
    by_end = {
        tuple(end): state for end, *state in zip(found.ends.tolist(), found.lost, found.loose, strict=True)
    }
    assert by_end == {
        (0, 0, 1): [False, False],
        (1, 0, 2): [True, False],
        (-1, 0, 2): [True, False],
        (-1, 0, 3): [False, True],
        (1, 0, 3): [False, True],
    }
    assert len(found.ends) == 7


def test_of_many_walks_the_best_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[float] = []

    def watched(*arguments: Any) -> float:
        drawn.append(faults(*arguments))
        return drawn[-1]

    monkeypatch.setattr(branches, "faults", watched)
    chosen = route(tree(seed=9))
    assert len(drawn) == branches.WALKS
    monkeypatch.setattr(branches, "WALKS", int(np.argmin(drawn)) + 1)
    assert route(tree(seed=9)) == chosen
    assert min(drawn) < 0.6 * np.median(drawn)


# A few levels, so that points are near mirrors of all of them.
SMALL = {
    "tree": tree(levels=4, leaves=2, seed=1),
    "shrub": shrub(stems=2, levels=3, leaves=2, seed=1),
    "forest": forest(levels=3, leaves=1, doublings=3, seed=1),
    "coral": coral(levels=4, seed=1),
}


@every_recipe
def test_the_distance_has_lipschitz_constant_one(name: str, opencl_device: Device) -> None:
    rng = np.random.default_rng(3)
    points = rng.uniform((-4, -4, -2), (4, 4, 6), (4000, 3))
    near = points + rng.normal(size=points.shape) * 10 ** rng.uniform(-6, 0, (4000, 1))
    distance = model(SMALL[name], opencl_device).distance
    assert (np.abs(distance(points) - distance(near)) <= np.linalg.norm(points - near, axis=1) + 1e-12).all()


@pytest.mark.parametrize("name", ["tree", "coral"])
def test_both_children_of_the_first_fork_are_there(name: str, opencl_device: Device) -> None:
    """In the middle of a branch the distance is its radius, inside; the mirror image has the same."""
    record = RECIPES[name](seed=2)
    trunk, child = route(record)[:2]
    mirror = Mirror(*forks(name, record)[0])
    middles = np.array([trunk["m"], child["m"], mirror.image(np.array([child["m"]]))[0]])
    np.testing.assert_allclose(
        model(record, opencl_device).distance(middles), [-trunk["r"], -child["r"], -child["r"]], atol=1e-12
    )


def planted(record: dict[str, Any], doublings: int) -> Array:
    """Where the trunks of a forest are that no mirror cuts."""
    trees = np.zeros((1, 3))
    for mirror in record["mirrors"][-doublings:]:
        normal, offset = np.array(mirror["u"]), mirror["w"]
        trees = trees[trees @ normal <= offset]
        trees = np.concatenate([trees, Mirror(normal, offset).image(trees)])
    return trees


@pytest.mark.parametrize("seed", range(8))
def test_a_forest_is_neither_crowded_nor_full_of_clearings(seed: int) -> None:
    trees = planted(forest(doublings=10, spacing=7.0, seed=seed, levels=2), 10)
    assert 900 < len(trees) <= 1024
    assert np.linalg.norm(trees, axis=1).min() == 0
    pairs = np.linalg.norm(trees[:, np.newaxis, :2] - trees[:, :2], axis=-1) + 1e9 * np.eye(len(trees))
    assert np.quantile(pairs.min(axis=1), 0.1) > 0.55 * 7.0
    # Wherever one stands inside, there is a tree within two spacings.
    places = np.median(trees, axis=0) + np.random.default_rng(0).uniform(-50, 50, (2000, 3))
    nearest = np.linalg.norm(places[:, np.newaxis, :2] - trees[:, :2], axis=-1).min(axis=1)
    assert nearest.max() < 2 * 7.0


def test_the_ground_of_a_forest_has_no_holes_and_rolls(opencl_device: Device) -> None:
    rng = np.random.default_rng(1)
    record = forest(doublings=8, seed=4)
    places = rng.uniform(-60, 60, (2000, 3)) * (1, 1, 0)
    land = model(record, opencl_device)
    assert (land.distance(places - (0, 0, 8)) < -2).all()
    # The ground below the first trees is flat, that further out is not.
    assert land.distance([[0.5, 0.5, -1]])[0] == pytest.approx(-1, abs=1e-12)
    assert np.std(land.distance(places - (0, 0, 8))) > 0.05
    flat = model(forest(doublings=8, seed=4, roll=0.0), opencl_device)
    np.testing.assert_allclose(flat.distance(places - (0, 0, 8)), -8, atol=1e-12)


def test_without_ground_a_forest_has_no_soil_and_upright_mirrors() -> None:
    record = forest(ground=False, seed=4)
    assert {kernel["type"] for kernel in record["kernels"][-10:]} == {"empty"}
    assert (normals(record)[-10:, 2] == 0).all()
    soil = forest(seed=4)["kernels"][-10]
    assert soil == {"type": "plane", "n": [0, 0, 1], "h": 0, "mat": 2}
    assert normals(forest(seed=4))[-10, 2] == 0
    assert (normals(forest(seed=4))[-9:, 2] != 0).all()


def test_a_forest_is_of_the_tree_with_the_same_parameters() -> None:
    single, many = tree(seed=3, levels=6, trunk=1.0), forest(seed=3, levels=6, trunk=1.0, doublings=4)
    assert many["kernels"][:9] == single["kernels"]
    assert many["mirrors"][:8] == single["mirrors"]
    assert len(many["mirrors"]) == 12


def sown(record: dict[str, Any]) -> Array:
    """Where the blades (N, 3) of a meadow stand: their feet, of very many some."""
    feet, blades = np.zeros((0, 3)), record["kernels"]
    for level, mirror in enumerate(record["mirrors"]):
        if blades[level]["type"] != "empty":
            feet = np.concatenate([feet, [blades[level]["p"]]])
        normal, offset = np.array(mirror["u"]), mirror["w"]
        feet = feet[feet @ normal <= offset]
        feet = np.concatenate([feet, Mirror(normal, offset).image(feet)])
        if len(feet) > 2**15:
            feet = np.random.default_rng(level).permutation(feet)[: 2**15]
    return feet


@every_seed
def test_a_meadow_is_about_the_origin_and_without_bare_places(seed: int) -> None:
    record = meadow(doublings=14, blade=1.0, seed=seed)
    assert len(record["mirrors"]) == 14
    assert [kernel["type"] for kernel in record["kernels"]] == ["torcap"] * 4 + ["empty"] * 11
    assert (normals(record)[:, 2] == 0).all()
    feet = sown(record)
    assert len(feet) > 2000
    reach = np.abs(feet[:, :2]).max(axis=0)
    assert (np.abs(feet.mean(axis=0)[:2]) < 0.15 * reach).all()
    # Inside, a blade stands within a third of its length.
    places = np.random.default_rng(0).uniform(-0.4, 0.4, (500, 2)) * reach
    nearest = np.linalg.norm(places[:, np.newaxis] - feet[:, :2], axis=-1).min(axis=1)
    assert np.quantile(nearest, 0.98) < 1 / 3


@every_seed
def test_blades_come_out_of_the_ground_and_are_no_longer_than_said(seed: int) -> None:
    for kernel in meadow(blade=0.5, thickness=0.03, seed=seed)["kernels"][:4]:
        assert kernel["p"][2] == pytest.approx(-0.025)
        assert 0.27 < kernel["q"][2] <= 0.5
        assert kernel["r"] == 0.015


def test_two_more_doublings_make_a_meadow_about_twice_as_wide() -> None:
    areas = [np.prod(np.ptp(sown(meadow(doublings=n, seed=4)), axis=0)[:2]) for n in (12, 14, 16, 18)]
    ratios = np.divide(areas[1:], areas[:-1])
    assert (ratios > 2).all()
    assert (ratios < 4.2).all()


def test_a_meadow_has_four_doublings_at_least() -> None:
    with pytest.raises(ValueError, match="a meadow is doubled at least 4 times, not 3 times"):
        meadow(doublings=3)
    assert len(meadow(doublings=4)["mirrors"]) == 4


def test_the_words_of_a_meadow() -> None:
    assert Meadow.model_validate({}).record() == meadow()
    written = {"doublings": 20, "blade": 0.4, "thickness": 0.03, "seed": 2, "grass": {"color": "red"}}
    node = Meadow.model_validate(written)
    assert node.record() == meadow(doublings=20, blade=0.4, thickness=0.03, seed=2)
    assert [material.color.written for material in node.materials] == ["red"]
    with pytest.raises(ValidationError) as found:
        Meadow.model_validate({"size": 30, "doublings": 3})
    assert {problem.help for problem in problems_of(found.value)} >= {
        "write 'doublings': each two more make it twice as wide"
    }


@pytest.mark.parametrize(
    ("made", "given", "message"),
    [
        (tree, {"levels": 0}, "levels is 0; expected a whole number from 1"),
        (tree, {"levels": 2.5}, "levels is 2.5; expected a whole number from 1"),
        (tree, {"trunk": -1}, "trunk is -1; expected a number greater than 0"),
        (tree, {"trunk": math.nan}, "trunk is nan; expected a number greater than 0"),
        (tree, {"trunk": math.inf}, "trunk is inf; expected a number greater than 0"),
        (tree, {"trunk": "long"}, "trunk is 'long'; expected a number greater than 0"),
        (tree, {"upright": 1.1}, "upright is 1.1; expected a number from 0 to 1"),
        (tree, {"seed": -1}, "seed is -1; expected a whole number from 0"),
        (
            forest,
            {"spread": 26},
            "expected an angle from 0 to pi/2 radians; in degrees: np.radians(26)",
        ),
        (tree, {"spread": -0.1}, "spread is -0.1; expected an angle from 0 to pi/2 radians"),
        (
            tree,
            {"turn": 137.5},
            "angle from -2 pi to 2 pi radians; in degrees: np.radians(137.5)",
        ),
        (forest, {"doublings": 0}, "doublings is 0; expected a whole number from 1"),
        (moebius_coral, {"spread": 34}, "in degrees: np.radians(34)"),
        (terrain, {"roughness": 6}, "in degrees: np.radians(6)"),
        (palm_leaf, {"taper": -1}, "taper is -1; expected a number from 0"),
        (hyperbolic_forest, {"forks": 0}, "forks is 0; expected a whole number from 1"),
    ],
)
def test_parameters_have_a_range(made: Recipes, given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError) as caught:
        made(**given)
    assert str(caught.value).endswith(message)


def test_the_numbers_of_numpy_are_parameters() -> None:
    assert tree(levels=np.int64(4), seed=np.uint8(2)) == tree(levels=4, seed=2)
    # Of a rock the roughness is no angle, and a frond may not taper.
    assert rock(levels=8, roughness=1.6)["kernels"]
    assert palm_leaf(taper=0)["kernels"]


def test_every_recipe_is_guarded() -> None:
    for name in set(krs.__all__) - {"Map", "Model", "moebius"}:
        with pytest.raises(ValueError, match="seed is -1; expected a whole number from 0"):
            getattr(krs, name)(*[tree(levels=2)] * (name == "moebius_of"), seed=-1)


def test_too_many_levels() -> None:
    with pytest.raises(ValueError, match="a plant of 41 mirrors; expected at most 40"):
        tree(levels=20, leaves=22)
    with pytest.raises(ValueError, match="a plant of 41 mirrors"):
        forest(levels=13, leaves=3, doublings=26)
    assert len(forest(levels=13, leaves=3, doublings=25)["mirrors"]) == 40


# The words of scenes


@every_recipe
def test_a_node_without_keys_gives_the_record_of_the_recipe(name: str) -> None:
    node = NODES[name].model_validate({})
    assert isinstance(node, Recipe)
    assert node.record() == RECIPES[name]()
    assert len(node.materials) == len(node.roles) == MATERIALS[name]
    assert len(set(node.materials)) == MATERIALS[name]


OTHER: dict[str, dict[str, Any]] = {
    "tree": {"spread": "20 deg", "upright": 0.4, "leaf-size": 0.3},
    "shrub": {"stems": 2, "outwards": "40 deg", "stem": 0.7, "leaf-size": 0.1},
    "forest": {"ground": False, "doublings": 3, "spread": "20 deg", "scatter": "5 deg"},
    "coral": {"limb": 0.5, "taper": 0.8, "buds": 1, "turn": "90 deg", "stems": 2, "tip-length": 1.5},
}


@every_recipe
def test_keys_of_a_node_are_parameters_of_the_recipe(name: str) -> None:
    written = {"levels": 6, "seed": 8, **OTHER[name]}
    meant = {
        key.replace("-", "_"): math.radians(float(value.split()[0])) if isinstance(value, str) else value
        for key, value in written.items()
    }
    node = NODES[name].model_validate(written)
    assert node.record() == RECIPES[name](**meant)
    assert node.record() != RECIPES[name](levels=6, seed=8)


@every_recipe
def test_materials_are_in_the_order_of_mat(name: str) -> None:
    roles = NODES[name].roles
    painted = {role: {"color": color} for role, color in zip(roles, ("red", "lime", "blue"), strict=False)}
    found = NODES[name].model_validate(painted).materials
    assert [material.color.written for material in found] == ["red", "lime", "blue"][: len(roles)]


@every_recipe
def test_every_example_is_right(name: str) -> None:
    from thurston_cl.scene.parse import parse

    data = parse(NODES[name].example).data
    assert list(data) == [name]
    NODES[name].model_validate(data[name])


@pytest.mark.parametrize(
    ("name", "written", "expected"),
    [
        (
            "tree",
            {"spread": "80 deg"},
            Problem(("spread",), "expected an angle from 5 to 60 deg; this is 80 deg"),
        ),
        ("tree", {"levels": 0}, Problem(("levels",), "levels must be at least 1; this is 0")),
        ("tree", {"levels": 31}, Problem(("levels",), "levels must be at most 30; this is 31")),
        ("tree", {"leaves": 9}, Problem(("leaves",), "leaves must be at most 8; this is 9")),
        ("tree", {"ratio": 1.2}, Problem(("ratio",), "ratio must be at most 1; this is 1.2")),
        ("tree", {"upright": 2}, Problem(("upright",), "upright must be at most 1; this is 2")),
        ("tree", {"trunk": 0}, Problem(("trunk",), "trunk must be greater than 0; this is 0")),
        (
            "tree",
            {"height": 6},
            Problem(
                ("height",),
                "unknown key 'height'",
                "write 'trunk', the length of the trunk: a tree is about 4 times as high",
                True,
            ),
        ),
        (
            "tree",
            {"color": "green"},
            Problem(
                ("color",), "unknown key 'color'", "write 'bark: {color: ...}' and 'leaf: {color: ...}'", True
            ),
        ),
        (
            "forest",
            {"trees": 100},
            Problem(("trees",), "unknown key 'trees'", "write 'doublings': 10 are up to 1024 trees", True),
        ),
        ("forest", {"doublings": 0}, Problem(("doublings",), "doublings must be at least 1; this is 0")),
        (
            "forest",
            {"roll": "10 deg"},
            Problem(("roll",), "expected an angle from 0 to 5 deg; this is 10 deg"),
        ),
        (
            "forest",
            {"levels": 15, "leaves": 3, "doublings": 24},
            Problem(
                ("doublings",),
                "levels, leaves and doublings make 41 mirrors together; at most 40 are possible",
                "take 1 off 'doublings'",
            ),
        ),
        (
            "shrub",
            {"stems": 8, "levels": 30, "leaves": 8},
            Problem(
                ("levels",),
                "stems, levels and leaves make 45 mirrors together; at most 40 are possible",
                "take 5 off 'levels'",
            ),
        ),
        ("shrub", {"trunk": 1}, Problem(("trunk",), "unknown key 'trunk'", "did you mean 'stem'?", True)),
        ("coral", {"polyps": 1}, Problem(("polyps",), "unknown key 'polyps'", "did you mean 'buds'?", True)),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, dict) else None,
)
def test_mistakes(name: str, written: dict[str, Any], expected: Problem) -> None:
    with pytest.raises(ValidationError) as found:
        NODES[name].model_validate(written)
    assert problems_of(found.value) == [expected]


def test_the_most_levels_are_allowed() -> None:
    node = Forest.model_validate({"levels": 14, "leaves": 3, "doublings": 24})
    assert len(node.record()["mirrors"]) == 40
