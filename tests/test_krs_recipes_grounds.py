"""Recipes of rocks, terrain, sponges, fish and palm leaves, and Moebius sequences of others: what holds of
their records, and that scenes give the same ones."""

import itertools
import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError

from thurston_cl.krs import Model
from thurston_cl.krs.moebius import Map, conjugate, product
from thurston_cl.krs.recipes.coral import coral
from thurston_cl.krs.recipes.fish_school import LEAST_STAGGER, MOST_DOUBLINGS, fish_school
from thurston_cl.krs.recipes.moebius_coral import moebius_coral
from thurston_cl.krs.recipes.moebius_of import moebius_of
from thurston_cl.krs.recipes.palm_leaf import palm_leaf
from thurston_cl.krs.recipes.rock import INNERMOST, OUTERMOST, rock
from thurston_cl.krs.recipes.sponge import sponge
from thurston_cl.krs.recipes.terrain import seabed, terrain
from thurston_cl.krs.record import sequence_of
from thurston_cl.scene.base import Node
from thurston_cl.scene.krs_grounds import FishSchool, PalmLeaf, Rock, Sponge, Terrain
from thurston_cl.scene.krs_plants import Coral

Array = NDArray[np.float64]
Record = dict[str, Any]
# Each with how many materials it has.
RECIPES: dict[str, tuple[Callable[..., Record], int]] = {
    "rock": (rock, 1),
    "terrain": (terrain, 1),
    "seabed": (seabed, 1),
    "sponge": (sponge, 1),
    "fish school": (fish_school, 3),
    "palm leaf": (palm_leaf, 2),
    "moebius coral": (moebius_coral, 2),
}

ONE, ZERO = [1.0, 0, 0, 0], [0.0] * 4
SPHERE = {"type": "sphere", "c": [0, 0, 0], "r": 1}

pytestmark = pytest.mark.filterwarnings("ignore:.*clipped")


def directions(count: int, seed: int = 99) -> Array:
    """Random unit vectors (N, 3), other ones than those that recipes draw."""
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


@pytest.mark.parametrize("name", RECIPES)
def test_record(name: str) -> None:
    make, materials = RECIPES[name]
    record = make()
    steps = record.get("mirrors", record.get("G"))
    assert len(record["kernels"]) == len(steps) + 1 <= 41
    painted = {kernel["mat"] for kernel in record["kernels"] if kernel["type"] != "empty"}
    assert painted == set(range(materials))
    for mirror in record.get("mirrors", []):
        assert math.hypot(*mirror["u"]) == pytest.approx(1, abs=1e-12)
    assert json.loads(json.dumps(record)) == record
    assert sequence_of(record).levels == len(steps)


@pytest.mark.parametrize("name", RECIPES)
def test_seeds(name: str) -> None:
    make, _ = RECIPES[name]
    assert make(seed=11) == make(seed=11)
    assert make(seed=11) != make(seed=12)


@pytest.mark.parametrize(("make", "key"), [(rock, "radius"), (terrain, "size"), (sponge, "radius")])
def test_size_scales(make: Callable[..., Record], key: str) -> None:
    points = 0.7 * directions(200)
    usual, large = make(**{key: 1.0}), make(**{key: 4.0})
    near, far = Model.from_dict(usual).distance(points), Model.from_dict(large).distance(4 * points)
    np.testing.assert_allclose(far, 4 * near, atol=1e-12)


@pytest.mark.parametrize(
    ("seed", "roughness", "levels"), [(4, 1.0, 14), (5, 1.0, 14), (6, 0.0, 9), (7, 2.0, 20)]
)
def test_rock_is_bounded(seed: int, roughness: float, levels: int) -> None:
    model = Model.from_dict(rock(radius=2.0, seed=seed, roughness=roughness, levels=levels))
    outwards = directions(2000)
    assert model.distance(2 * INNERMOST * outwards).max() < 0
    for radii in (OUTERMOST, 3, 10, 1000):
        assert model.distance(2 * radii * outwards).min() > 0


def test_rock_is_as_smooth_where_facets_are_small() -> None:
    """Widths are in proportion to what mirrors halve: about 1 for whole directions, and less and less."""
    record = rock(seed=2, levels=18)
    points, ratios = directions(4000), []
    for mirror, width in zip(reversed(record["mirrors"]), reversed(record["smooth"]), strict=True):
        heights = points @ mirror["u"] - mirror["w"]
        ratios.append(width / heights.std())
        points = points - 2 * np.maximum(heights, 0)[:, None] * mirror["u"]
    np.testing.assert_allclose(ratios, 0.3, rtol=0.1)
    assert record["smooth"][0] < 0.1 * record["smooth"][-1]
    assert set(rock(smooth=0)["smooth"]) == {0}
    np.testing.assert_allclose(rock(smooth=2)["smooth"], 2 * np.array(rock()["smooth"]), rtol=1e-12)


def heights(model: Model, where: Array, above: float) -> Array:
    """Heights (N,) of a surface over points (N, 2), by sphere tracing down from above it."""
    points = np.column_stack([where, np.full(len(where), above)])
    for _ in range(2000):
        distances = model.distance(points)
        points[:, 2] -= distances
        if distances.max() < 1e-9 * above:
            return points[:, 2]
    raise AssertionError("no ground below")


@pytest.mark.parametrize(
    ("record", "size", "steepest"),
    [
        (terrain(), 300, 50),
        (terrain(seed=8, roughness=math.radians(12), steepest=math.radians(40)), 300, 40),
        (terrain(seed=9, slope=math.radians(20), roughness=math.radians(4)), 300, 50),
        (seabed(), 60, 18),
        (seabed(seed=4), 60, 18),
    ],
)
def test_terrain_has_no_walls(record: Record, size: float, steepest: float) -> None:
    model = Model.from_dict(record)
    random = np.random.default_rng(1)
    where = random.uniform(-0.5, 0.5, (400, 2)) * size
    ground = heights(model, where, size)
    assert abs(ground.mean()) < 0.05 * size
    # Facets between the samples of the recipe may be a little steeper.
    most = math.tan(math.radians(steepest + 5))
    for step in (1e-4, 1e-2):
        beside = where + step * size * directions(400)[:, :2]
        rise = np.abs(heights(model, beside, size) - ground) / np.linalg.norm(beside - where, axis=1)
        assert rise.max() < most
    assert np.ptp(ground) > 0.01 * size


@pytest.mark.parametrize("seed", [3, 4])
def test_ripples_run_along_y(seed: int) -> None:
    model = Model.from_dict(seabed(seed=seed))
    line, beside = np.meshgrid(np.linspace(-8, 8, 400), [-3, 0, 3])

    def crests(x: Array, y: Array) -> int:
        ground = heights(model, np.column_stack([x.ravel(), y.ravel()]), 60).reshape(x.shape)
        middle = ground[:, 1:-1]
        return int(np.sum((middle > ground[:, :-2]) & (middle > ground[:, 2:])))

    assert crests(line, beside) > 2 * crests(beside, line)


def skin_of(record: Record) -> tuple[float, float]:
    """How often rays to the middle of a thing enter it, and circles close below its surface go in or out."""
    model, outwards = Model.from_dict(record), directions(500)
    radii = np.linspace(2.2, 0.1, 160)
    solid = np.array([model.distance(radius * outwards) < 0 for radius in radii])
    assert not solid[0].any()
    entered = np.mean(np.sum(solid[1:] & ~solid[:-1], axis=0))
    met = solid.any(axis=0)
    skin = 0.95 * np.median(radii[np.argmax(solid[:, met], axis=0)])
    turn = np.linspace(0, 2 * math.pi, 3000)[:, None]
    changes = []
    for first, second in zip(directions(10), directions(10, 98), strict=True):
        across = second - (second @ first) * first
        circle = np.cos(turn) * first + np.sin(turn) * across / np.linalg.norm(across)
        inside = model.distance(skin * circle) < 0
        changes.append(np.sum(inside[1:] != inside[:-1]))
    return float(entered), float(np.mean(changes))


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_sponge_has_holes_and_rock_has_none(seed: int) -> None:
    entered, changes = skin_of(sponge(seed=seed))
    assert entered > 2
    assert changes > 16
    entered, changes = skin_of(rock(seed=seed))
    assert entered < 1.1
    assert changes < 12


def spines(kernel: Record) -> Array:
    """Where the tips (2, 3) of a half spindle are on the mirror that cuts it."""
    p, q, m = (np.array(kernel[key]) for key in "pqm")
    out = (p + q) / 2 - m
    return np.array([p, q]) - kernel["r"] * out / np.linalg.norm(out)


def swum(record: Record, doublings: int) -> Array:
    """Noses and tails (N, 2, 3) of all fish, each once. Fails if a mirror of the school cuts one."""
    fish, levels = np.zeros((0, 2, 3)), len(record["mirrors"])
    for level, kernel in enumerate(record["kernels"]):
        if level > 0:
            mirror = record["mirrors"][level - 1]
            normal, offset = np.array(mirror["u"]), mirror["w"]
            heights = fish @ normal - offset
            if level > levels - doublings:
                # Beside its spine a fish is at least 0.1 wide and high.
                assert heights.max() < -0.1
            fish = np.concatenate([fish, fish - 2 * heights[..., None] * normal])
        if kernel["type"] == "torcap" and kernel["mat"] == 0:
            fish = np.concatenate([fish, spines(kernel)[None]])
        fish = fish[np.unique(np.round(fish, 6), axis=0, return_index=True)[1]]
    return fish


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_fish_swim_one_way_and_apart(seed: int) -> None:
    fish = swum(fish_school(seed=seed, doublings=4, spread=math.radians(25)), 4)
    assert len(fish) == 8 * 2**4
    ahead = fish[:, 0] - fish[:, 1]
    ahead /= np.linalg.norm(ahead, axis=1)[:, None]
    assert ahead[:, 0].min() >= math.cos(math.radians(25)) - 1e-12
    # No two of them are the same way or in one place.
    assert len(np.unique(np.round(ahead, 6), axis=0)) > 10
    middle = fish.mean(axis=1)
    apart = np.linalg.norm(middle[:, None] - middle[None], axis=-1) + 9 * np.eye(len(fish))
    assert apart.min() > 0.4
    np.testing.assert_allclose(middle.max(axis=0) + middle.min(axis=0), 0, atol=0.2)


def test_every_fish_has_two_eyes() -> None:
    record = fish_school(doublings=1, askew=0, spread=0)
    model, fish = Model.from_dict(record), swum(record, 1)
    middle = fish[:, 0] - (0.16, 0, 0)
    for side in (-1, 1):
        # They stand out from heads: a little behind or before them there is water.
        assert (model.distance(middle + np.array([0, 0.06 * side, 0])) < 0).all()
        for along in (-0.04, 0.04):
            assert (model.distance(middle + np.array([along, 0.06 * side, 0])) > 0).all()


def test_fish_is_symmetric() -> None:
    record = fish_school(doublings=1, seed=2)
    model = Model.from_dict(record)
    # The fish of the lowest row are upright in the innermost mirror across y.
    mirror = record["mirrors"][2]
    assert mirror["u"] == [0, 1, 0]
    nose, tail = spines(record["kernels"][2])
    points = (nose + tail) / 2 + 0.3 * directions(500)
    image = points * (1, -1, 1) + (0, 2 * mirror["w"], 0)
    np.testing.assert_allclose(model.distance(points), model.distance(image), atol=1e-12)
    # A point of the midline is inside; beside, above and below it is water soon.
    assert model.distance([(nose + tail) / 2])[0] < 0
    beside = (nose + tail) / 2 + np.array([[0, 0.12, 0], [0, -0.12, 0], [0.2, 0, 0.22], [0.2, 0, -0.22]])
    assert (model.distance(beside) > 0).all()


def maps_of(record: Record) -> list[Map]:
    """The maps of a Moebius record."""
    return [Map(np.array(matrix)) for matrix in record["G"]]


def keeps_space(matrix: Array) -> float:
    """How far a matrix is from the criterion of docs/krs.md, "Moebius maps", relative to its entries."""
    (a, b), (c, d) = matrix
    size = float(np.max(np.sum(matrix**2, axis=-1)))
    mixed = product(conjugate(d), a) - product(conjugate(c), b)
    real = product(a, conjugate(c))[0], product(b, conjugate(d))[0]
    return float(max(np.abs(real).max(), np.abs(mixed[1:]).max())) / size


def leaflets(record: Record) -> Array:
    """Where base, middle and tip (N, 3, 3) of all leaflets are."""
    base, tip = spines(record["kernels"][0]) * (0, 1, 1)
    # Halves of a leaflet meet where the first mirror is: it makes one of both.
    places = np.array([[base, (base + tip) / 2, tip]])
    for level, map_ in enumerate(maps_of(record)):
        both = places if level == 0 else np.concatenate([places, places * (-1, 1, 1)])
        places = map_.apply(both.reshape(-1, 3)).reshape(both.shape)
    return places


@pytest.mark.parametrize(("seed", "doublings"), [(3, 5), (4, 5), (5, 6), (6, 1)])
def test_palm_leaf(seed: int, doublings: int) -> None:
    record = palm_leaf(seed=seed, doublings=doublings)
    for matrix in np.array(record["G"]):
        assert keeps_space(matrix) < 1e-12
    # The last map and all that double a row but the first bend: they have poles.
    poles = [map_.numbers[0] for map_ in maps_of(record)]
    assert poles == [0.0] + [1.0] * (doublings - 1) + [0.0, 1.0]
    found = leaflets(record)
    assert len(found) == 2 ** (doublings + 1)
    lengths = np.sort(np.linalg.norm(found[:, 2] - found[:, 0], axis=1))
    # No two are equally long, and the longest is several times as long as the shortest.
    if doublings > 1:
        assert np.diff(lengths).min() > 1e-7
        assert lengths[-1] > 2 * lengths[0]
    # Leaflets are on both sides of the midrib, bent, and reach ahead.
    sides = np.sign(found[:, 2, 1] - found[:, 0, 1])
    assert np.sum(sides) == 0
    straight = (found[:, 0] + found[:, 2]) / 2
    assert (np.linalg.norm(found[:, 1] - straight, axis=1) > 1e-3 * lengths.min()).all()
    assert np.mean(found[:, 2, 0] - found[:, 0, 0] > 0) > 0.8
    # The midrib curves down.
    bases = found[np.argsort(found[:, 0, 0]), 0]
    assert bases[-1, 2] < bases[0, 2]


@pytest.mark.parametrize("taper", [0.3, 1.0])
def test_palm_leaf_is_as_long_as_it_says(taper: float) -> None:
    record = palm_leaf(length=3.0, stalk=0.5, taper=taper)
    model = Model.from_dict(record)
    assert model.distance([[0.0, 0, 0]])[0] < 0
    assert model.distance([[0.0, 0, 2], [4, 0, 0], [-2.2, 0, 0]]).min() > 0.3
    # The outermost leaflets begin half their distance from the end.
    ends = np.linalg.norm(leaflets(record)[:, 0], axis=1)
    assert 2.9 < ends.max() < 3.0
    (foot,) = maps_of(record)[-1].apply([record["kernels"][-1]["a"]])
    assert foot[0] < 0
    assert np.linalg.norm(foot) == pytest.approx(1.5, rel=0.1)


@pytest.mark.parametrize(("taper", "doublings"), [(0.3, 5), (2.2, 6)])
def test_the_stalk_of_a_palm_leaf_is_as_thick_as_its_midrib(taper: float, doublings: int) -> None:
    model = Model.from_dict(palm_leaf(taper=taper, doublings=doublings))
    heights = np.linspace(0, 0.02, 2001)
    thick = []
    for x in (-1e-3, 1e-3):
        above = np.column_stack([np.full_like(heights, x), np.zeros_like(heights), heights])
        thick.append(heights[model.distance(above) < 0].max())
    assert thick[0] > 1e-3
    assert thick[1] == pytest.approx(thick[0], rel=0.03)


def test_what_is_not_bent_is_the_same() -> None:
    record = coral(levels=8)
    points = 3 * directions(1000) * np.random.default_rng(0).uniform(0.1, 1, (1000, 1))
    usual = Model.from_dict(record).distance(points)
    unbent = Model.from_dict(moebius_coral(strength=0.0, levels=8))
    assert np.abs(unbent.bound(points) - usual).max() < 4e-14


@pytest.mark.parametrize("strength", [0.05, 0.2])
def test_bending_keeps_space_and_what_is_joined(strength: float) -> None:
    record = coral(levels=8, buds=2)
    bent = moebius_coral(strength=strength, levels=8, buds=2)
    maps = maps_of(bent)
    for map_ in maps:
        assert keeps_space(map_.matrix) < 1e-12
        assert map_.numbers[0] == 1
    # Along the route the branch of a level ends where that before it begins, and the trunk stays.
    whole, ends, moved = Map(np.array([[ONE, ZERO], [ZERO, ONE]])), [], []
    for level in range(len(maps), 0, -1):
        whole = whole @ maps[level - 1]
        kernel = bent["kernels"][level]
        if kernel["type"] == "torcap":
            ends.append(whole.apply([kernel["p"], kernel["q"]]))
            moved.append(np.linalg.norm(ends[-1][1] - record["kernels"][level]["q"]))
    assert len(ends) == 8
    np.testing.assert_allclose(ends[0][0], record["kernels"][-1]["p"], atol=1e-12)
    for outer, inner in itertools.pairwise(ends):
        np.testing.assert_allclose(outer[1], inner[0], atol=1e-10)
    # The tip is where the last branch ends, behind the mirrors of the buds.
    (tip,) = whole.apply([bent["kernels"][0]["c"]])
    np.testing.assert_allclose(tip, ends[-1][1], atol=1e-10)
    assert max(moved) > 0.1 * strength


def test_a_coral_of_a_scene_is_bent_as_it_says() -> None:
    assert Coral.model_validate({"seed": 8}).record() == coral(seed=8)
    bent = Coral.model_validate({"seed": 8, "bend": 0.35, "levels": 7}).record()
    assert bent == moebius_coral(seed=8, strength=0.35, levels=7)
    assert len(bent["G"]) == 7 + 2


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rock(levels=5), "a rock has 6 to 40 levels, not 5"),
        (lambda: rock(levels=41), "a rock has 6 to 40 levels, not 41"),
        (lambda: rock(roughness=100), "no closed rock of roughness 100 found"),
        (lambda: terrain(levels=3), "a terrain has 4 to 40 levels, not 3"),
        (lambda: terrain(slope=1.0, steepest=0.9), "slope is above 0 and below steepest"),
        (lambda: terrain(ripples=22), "of 22 levels 0 to 21 make ripples, not 22"),
        (lambda: sponge(levels=10, layers=4), "a sponge of 4 layers has 11 to 40 levels, not 10"),
        (lambda: sponge(lumps=100, seed=1), "no round sponge of lumps 100 found"),
        (lambda: fish_school(doublings=MOST_DOUBLINGS + 1), "doubled 0 to 12 times, not 13 times"),
        (lambda: fish_school(stagger=1), f"{LEAST_STAGGER} lengths apart at least, not 1"),
        (lambda: palm_leaf(doublings=0), "doubled 1 to 12 times, not 0 times"),
        (lambda: moebius_of(palm_leaf()), "only a sequence of mirrors in Euclidean space"),
        (lambda: moebius_of(rock()), "bounded kernels only, no planes"),
        (lambda: moebius_of({"mirrors": [], "kernels": [{"type": "empty"}]}), "no kernel to bend"),
        (lambda: moebius_of({"mirrors": [], "kernels": [SPHERE]}), "there is no mirror"),
        (lambda: moebius_of(coral(), strength=1), "from 0 to less than 1, not 1"),
    ],
)
def test_what_cannot_be_made(make: Callable[[], Record], message: str) -> None:
    with pytest.raises(ValueError, match=message.replace(".", r"\.")):
        make()


@pytest.mark.parametrize(
    ("node", "made"),
    [
        (Rock, rock),
        (Terrain, terrain),
        (Sponge, sponge),
        (FishSchool, fish_school),
        (PalmLeaf, palm_leaf),
    ],
)
def test_node(node: type[Any], made: Callable[..., Record]) -> None:
    usual = node.model_validate({})
    assert usual.record() == made()
    assert node.model_validate({"seed": 17}).record() == made(seed=17)
    painted = {kernel["mat"] for kernel in made()["kernels"] if kernel["type"] != "empty"}
    assert painted == set(range(len(usual.materials)))


@pytest.mark.parametrize(
    ("node", "given"),
    [
        (Rock, {"levels": 6, "roughness": 0}),
        (Rock, {"levels": 40, "roughness": 2, "smooth": 0}),
        (Terrain, {"levels": 4, "roughness": "0 deg", "wander": "0 deg"}),
        (Terrain, {"levels": 40, "roughness": "15 deg", "slope": "79 deg", "steepest": "80 deg"}),
        (Terrain, {"form": "seabed", "levels": 9, "ripples": 8}),
        (Sponge, {"levels": 7, "layers": 0, "lumps": 2, "threads": 0}),
        (Sponge, {"levels": 40, "layers": 8, "lumps": 0, "threads": 1}),
        (FishSchool, {"doublings": 12, "askew": "15 deg", "spread": "0 deg", "gap": 0}),
        (FishSchool, {"doublings": 1, "spread": "60 deg", "gap": 2, "stagger": 10}),
        (PalmLeaf, {"doublings": 12, "leaflets": 1, "width": 1, "hang": "60 deg", "stalk": 0.001}),
        (PalmLeaf, {"doublings": 12, "droop": 1, "fullness": 1, "uneven": 1, "stalk": 1}),
        (PalmLeaf, {"doublings": 1, "leaflets": 0.05, "width": 0.05, "droop": 0, "taper": 0, "uneven": 0}),
    ],
)
def test_whatever_a_scene_may_say_is_made(node: type[Any], given: dict[str, Any]) -> None:
    for seed in range(3):
        record = node.model_validate(given | {"seed": seed}).record()
        sequence = sequence_of(record)
        assert sequence.levels <= 40
        bounded = "within" in record or all(kernel["type"] != "plane" for kernel in record["kernels"])
        assert math.isfinite(sequence.radius) is bounded


def test_node_of_a_seabed() -> None:
    assert Terrain.model_validate({"form": "seabed"}).record() == seabed()
    gentle = Terrain.model_validate({"form": "seabed", "slope": "5 deg", "seed": 9})
    assert gentle.record() == seabed(slope=math.radians(5), seed=9)
    assert Terrain.model_validate({"form": "land"}).record() == terrain()


@pytest.mark.parametrize(
    ("node", "given", "message"),
    [
        (Rock, {"levels": 5}, "levels must be at least 6; this is 5"),
        (Rock, {"levels": 41}, "levels must be at most 40; this is 41"),
        (Terrain, {"slope": "60 deg"}, "the slope is 60 deg, and the steepest one has to be steeper"),
        (Terrain, {"roughness": "16 deg"}, "expected an angle from 0 to 15 deg; this is 16 deg"),
        (Terrain, {"levels": 6, "ripples": 6}, "of 6 levels at most 5 make ripples"),
        (Sponge, {"levels": 10}, "of 10 levels at most 3 fold the skin; these are 4"),
        (FishSchool, {"fish": 100}, "unknown key 'fish'"),
        (FishSchool, {"stagger": 1}, "stagger must be at least 2; this is 1"),
        (PalmLeaf, {"doublings": 13}, "doublings must be at most 12; this is 13"),
    ],
)
def test_mistakes(node: type[Node], given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError) as caught:
        node.model_validate(given)
    assert message in str(caught.value)
