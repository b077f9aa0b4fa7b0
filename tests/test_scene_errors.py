"""Every mistake we know of, one at a time: its place, message, cure, and whether the JSON Schema sees it."""

from dataclasses import dataclass

import jsonschema
import pytest

from thurston_cl.scene import SceneReport, load_text, scene_schema
from thurston_cl.scene.parse import parse


@dataclass(frozen=True)
class Mistake:
    """A scene with one mistake at line:column; `schema` says whether the JSON Schema can find it, too."""

    text: str
    at: str
    message: str
    help: str = ""
    schema: bool = True


BALL = "objects: [{ball: {radius: 1}}]\n"
E3, S3, H3, SOL = (f"geometry: {name}\n{BALL}" for name in ("e3", "s3", "h3", "sol"))


def an_object(text: str, geometry: str = "e3") -> str:
    """A scene with one object, which starts in line 3, column 5."""
    return f"geometry: {geometry}\nobjects:\n  - {text}\n"


def a_sequence(text: str, geometry: str = "e3") -> str:
    """A scene with one sequence, whose keys start in line 3, column 11."""
    return an_object(f"krs: {{{text}}}", geometry)


def a_forest(text: str) -> str:
    """A scene with a forest in h3, whose keys start in line 3, column 31."""
    return a_sequence(f"hyperbolic-forest: {{{text}}}", "h3")


# By recipe: words that are none of its keys, and what is said of them.
WORDS_OF_RECIPES = {
    "tree": {
        "height": "write 'trunk', the length of the trunk: a tree is about 4 times as high",
        "angle": "did you mean 'spread'?",
        "material": "a tree has two: 'bark' and 'leaf'",
        "color": "write 'bark: {color: ...}' and 'leaf: {color: ...}'",
        "at": "'at' stands beside 'krs', not inside it",
    },
    "forest": {
        "height": "write 'trunk', the length of the trunk: a tree is about 4 times as high",
        "angle": "did you mean 'spread'?",
        "material": "a forest has three: 'bark', 'leaf' and 'soil'",
        "color": "write 'bark: {color: ...}' and 'leaf: {color: ...}'",
        "at": "'at' stands beside 'krs', not inside it",
        "trees": "write 'doublings': 10 are up to 1024 trees",
        "count": "write 'doublings': 10 are up to 1024 trees",
    },
    "shrub": {
        "height": "write 'stem', the length of a stem: a shrub is about 4 times as high",
        "trunk": "did you mean 'stem'?",
        "angle": "did you mean 'spread'?",
        "material": "a shrub has two: 'bark' and 'leaf'",
        "color": "write 'bark: {color: ...}' and 'leaf: {color: ...}'",
        "at": "'at' stands beside 'krs', not inside it",
    },
    "coral": {
        "height": "write 'limb', the length of the second branch: a coral is about 5 times as high",
        "angle": "did you mean 'spread'?",
        "polyps": "did you mean 'buds'?",
        "material": "a coral has two: 'body' and 'tip'",
        "color": "write 'body: {color: ...}' and 'tip: {color: ...}'",
        "at": "'at' stands beside 'krs', not inside it",
    },
    "rock": {
        "size": "did you mean 'radius'?",
        "color": "write 'material: {color: ...}'",
        "at": "'at' stands beside 'krs', not inside it",
    },
    "terrain": {
        "height": "write 'slope', how steep it is: hills are as high as that makes them",
        "width": "did you mean 'size'?",
        "color": "write 'material: {color: ...}'",
        "at": "'at' stands beside 'krs', not inside it",
    },
    "sponge": {
        "size": "did you mean 'radius'?",
        "pores": "write 'levels': each one more makes pores half as large",
        "color": "write 'material: {color: ...}'",
        "at": "'at' stands beside 'krs', not inside it",
    },
    "fish-school": {
        "fish": "write 'doublings': there are 8 · 2^doublings fish",
        "count": "write 'doublings': there are 8 · 2^doublings fish",
        "number": "write 'doublings': there are 8 · 2^doublings fish",
        "size": "did you mean 'length'?",
        "material": "a fish has three materials: 'body', 'fins' and 'eyes'",
        "color": "a fish has three materials: 'body', 'fins' and 'eyes'",
        "at": "'at' stands beside 'krs', not inside it",
    },
    "palm-leaf": {
        "size": "did you mean 'length'?",
        "material": "a palm leaf has two materials: 'leaf' and 'midrib'",
        "color": "a palm leaf has two materials: 'leaf' and 'midrib'",
        "at": "'at' stands beside 'krs', not inside it",
    },
}

A_LEVEL = "levels: [{mirror: {normal: [1, 0, 0]}}]"
ONE_LEVEL = f"kernel: {{ball: {{radius: 0.1}}}}, {A_LEVEL}"
BALL_KERNEL = "{type: sphere, c: [0, 0, 0], r: 1}"


def by_matrices(generators: str, domain: str) -> str:
    """A scene of e3 with a lattice."""
    return f"{E3}manifold:\n  generators: {generators}\n  domain: {domain}\n"


SHIFT = "[[1, 0, 0, -1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
BACK = "[[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"

FIVE = "[[1, 0, 0, 0, 0], [0, 1, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 1, -1], [0, 0, 0, 0, 1]]"

MISTAKES = {
    # The scene as a whole
    "empty": Mistake("", "1:1", "the scene is empty", "'geometry:'"),
    "only comments": Mistake("# nothing\n", "1:1", "the scene is empty", "'geometry:'"),
    "a list": Mistake("- geometry: e3\n", "1:1", "the scene is not a mapping of keys", "'geometry:'"),
    "no geometry": Mistake(BALL, "1:1", "a scene needs the key 'geometry'", "geometry: h3"),
    "no objects": Mistake("geometry: e3\n", "1:1", "a scene needs the key 'objects'"),
    "empty objects": Mistake("geometry: e3\nobjects: []\n", "2:10", "expected at least 1 entry, found 0"),
    "one object, no list": Mistake(
        "geometry: e3\nobjects:\n  ball: {radius: 1}\n", "3:3", "expected a list, found a mapping", "'- '"
    ),
    "long name of a geometry": Mistake(
        f"geometry: Hyperbolic\n{BALL}",
        "1:11",
        "'Hyperbolic' is not one of: e3, s3, h3, s2xe, h2xe, nil, sl2",
        "did you mean 'h3'?",
    ),
    "geometry in capitals": Mistake(
        f"geometry: H3\n{BALL}", "1:11", "'H3' is not one of", "did you mean 'h3'?"
    ),
    "misspelt geometry": Mistake(
        f"geometry: Solv\n{BALL}", "1:11", "'Solv' is not one of", "did you mean 'sol'?"
    ),
    "geometry by its group": Mistake(
        f"geometry: SL(2,R)\n{BALL}", "1:11", "'SL(2,R)' is not one of", "did you mean 'sl2'?"
    ),
    "geometry by its other name": Mistake(
        f"geometry: Heisenberg\n{BALL}", "1:11", "'Heisenberg' is not one of", "did you mean 'nil'?"
    ),
    "product by another name": Mistake(
        f"geometry: H2xR\n{BALL}", "1:11", "'H2xR' is not one of", "did you mean 'h2xe'?"
    ),
    "product with a sign": Mistake(
        f"geometry: S2×E\n{BALL}", "1:11", "'S2×E' is not one of", "did you mean 's2xe'?"
    ),
    "no blank after the first colon": Mistake(
        f"geometry:h3\n{BALL}", "1:10", "a blank is missing after the colon", "write 'geometry: h3'"
    ),
    "no blank after any colon": Mistake(
        "geometry:h3", "1:1", "the scene is not a mapping of keys", "write 'geometry: h3'"
    ),
    "no blank after a colon in a block": Mistake(
        f"{E3}render:\n  samples:4\n  size: [1, 1]\n",
        "4:11",
        "a blank is missing after the colon",
        "write 'samples: 4'",
    ),
    "no blank after a colon above a list": Mistake(
        an_object("ball: {radius: 1}\n    at:[0, 0, 0]\n  - ball: {radius: 1}"),
        "4:8",
        "a blank is missing after the colon",
        "write 'at: [0, 0, 0]'",
        schema=False,
    ),
    "no blank after a colon, and a long value": Mistake(
        f"title:{'long ' * 9}\n{E3}", "1:7", "a blank is missing after the colon", "write 'title: ...'"
    ),
    "no blank after a colon in brackets": Mistake(
        an_object("{ball: {radius: 1}, at:[0, 0, 0]}"),
        "3:28",
        "a blank is missing after the colon",
        "write 'at: ...'",
    ),
    "no blank after a colon, before a number": Mistake(
        an_object("ball: {radius:1}"), "3:12", "unknown key 'radius:1'", "write 'radius: 1'"
    ),
    "no blank after the colon of a shape": Mistake(
        an_object("ball:0.4"), "3:5", "expected an object, found 'ball:0.4'", "write 'ball: 0.4'"
    ),
    "geometry is no text": Mistake(f"geometry: 3\n{BALL}", "1:11", "expected one of e3, s3, h3, s2xe, h2xe"),
    "version": Mistake(
        f"thurston: 2\n{E3}", "1:11", "this program reads version 1 of the scene format; this is 2"
    ),
    "version is true": Mistake(f"thurston: true\n{E3}", "1:11", "this is true"),
    "unknown key": Mistake(f"{E3}sceen: 3\n", "3:1", "unknown key 'sceen'", "known keys: thurston, title"),
    "key of another program": Mistake(
        f"{E3}lattice: quaternion\n", "3:1", "unknown key 'lattice'", "did you mean 'manifold'?"
    ),
    "key in capitals": Mistake(f"{E3}Title: x\n", "3:1", "unknown key 'Title'", "did you mean 'title'?"),
    "key one level too high": Mistake(
        f"{E3}samples: 4\n", "3:1", "unknown key 'samples'", "inside 'render': write 'render: {samples: ...}'"
    ),
    "key without a value": Mistake(
        f"{E3}camera:\n", "3:1", "'camera' has no value", "for example camera: {at:"
    ),
    "number for a title": Mistake(f"{E3}title: 3\n", "3:8", "expected text, found 3", "put quotes around it"),
    # Objects
    "negative radius": Mistake(
        an_object("ball: {radius: -1}"), "3:20", "radius must be greater than 0; this is -1"
    ),
    "zero radius": Mistake(
        an_object("ball: {radius: 0}"), "3:20", "radius must be greater than 0; this is 0"
    ),
    "no radius": Mistake(
        an_object("ball: {}"), "3:11", "a ball needs the key 'radius'", "ball: {radius: 0.4}"
    ),
    "misspelt radius": Mistake(
        an_object("ball: {raduis: 1}"), "3:12", "unknown key 'raduis'", "did you mean 'radius'?"
    ),
    "text for a number": Mistake(an_object("ball: {radius: big}"), "3:20", "expected a number, found 'big'"),
    "number in quotes": Mistake(
        an_object('ball: {radius: "0.4"}'), "3:20", "expected a number, found '0.4'", "take the quotes off"
    ),
    "truth for a number": Mistake(an_object("ball: {radius: true}"), "3:20", "expected a number, found true"),
    "formula for a number": Mistake(
        an_object("ball: {radius: 2*pi}"), "3:20", "found '2*pi'", "not expressions"
    ),
    "unit for a number": Mistake(an_object("ball: {radius: 0.4 m}"), "3:20", "found '0.4 m'", "no unit"),
    "decimal comma": Mistake(an_object("cylinder: {radius: '0,4'}"), "3:24", "found '0,4'", "0.4"),
    "number for a shape": Mistake(
        an_object("ball: 0.4"), "3:11", "expected a ball, found 0.4", "ball: {radius"
    ),
    "shape without its keys": Mistake(
        an_object("ball:"), "3:5", "'ball' has no value", "ball: {radius: 0.4}"
    ),
    "no shape": Mistake(an_object("at: [0, 0, 0]"), "3:5", "an object needs one of: ball, cylinder"),
    "only a name": Mistake(
        an_object("ball"), "3:5", "expected an object, found 'ball'", "- ball: {radius: 0.4}"
    ),
    "two shapes": Mistake(
        an_object("{ball: {radius: 1}, cylinder: {radius: 1}}"),
        "3:25",
        "an object has only one of 'ball' and 'cylinder'",
        "union",
    ),
    "sphere": Mistake(
        an_object("sphere: {radius: 1}"), "3:5", "unknown key 'sphere'", "did you mean 'ball'?"
    ),
    "half_space": Mistake(an_object("half_space: {}"), "3:5", "unknown key 'half_space'", "'half-space'"),
    "subtract": Mistake(
        an_object("subtract: []"), "3:5", "unknown key 'subtract'", "did you mean 'difference'?"
    ),
    "box": Mistake(an_object("box: {size: 1}"), "3:5", "unknown key 'box'", "three slabs"),
    "place inside the shape": Mistake(
        an_object("ball: {radius: 1, at: [1, 0, 0]}"), "3:23", "unknown key 'at'", "stands beside the shape"
    ),
    "radius beside the shape": Mistake(
        an_object("{cylinder: {radius: 1}, radius: 2}"),
        "3:29",
        "unknown key 'radius'",
        "inside 'ball' or 'cylinder'",
    ),
    "color beside the shape": Mistake(
        an_object("{ball: {radius: 1}, color: red}"), "3:25", "unknown key 'color'", "material: {color: ...}"
    ),
    "material inside a union": Mistake(
        an_object("union: [{ball: {radius: 1}, material: x}]"), "3:33", "unknown key 'material'", "outermost"
    ),
    "empty union": Mistake(an_object("union: []"), "3:12", "expected at least 1 entry, found 0"),
    "difference of one": Mistake(
        an_object("difference: [{ball: {radius: 1}}]"), "3:17", "expected at least 2 entries, found 1"
    ),
    "list in a complement": Mistake(an_object("complement: [1]"), "3:17", "expected a shape, found a list"),
    "deep inside": Mistake(
        an_object("difference: [{ball: {radius: 1}}, {complement: {union: [{ball: {radius: x}}]}}]"),
        "3:77",
        "expected a number, found 'x'",
    ),
    "short vector": Mistake(
        an_object("{ball: {radius: 1}, at: [0, 1]}"), "3:29", "expected 3 numbers [x, y, z], found 2"
    ),
    "number for a point": Mistake(
        an_object("{ball: {radius: 1}, at: 1}"), "3:29", "expected a point, found 1", "{model: [x, y, z, w]}"
    ),
    "text in a point": Mistake(
        an_object("{ball: {radius: 1}, at: [0, 0, up]}"), "3:36", "expected a number, found 'up'"
    ),
    "point off the model, e3": Mistake(
        an_object("{ball: {radius: 1}, at: {model: [0, 0, 0, 2]}}"),
        "3:37",
        "this is not a point of the geometry, where w = 1",
        schema=False,
    ),
    "point off the model, s3": Mistake(
        an_object("{ball: {radius: 1}, at: {model: [1, 0, 0, 1]}}", "s3"),
        "3:37",
        "x^2 + y^2 + z^2 + w^2 = 1",
        schema=False,
    ),
    "point on the other sheet, h3": Mistake(
        an_object("{ball: {radius: 1}, at: {model: [0, 0, 0, -1]}}", "h3"),
        "3:37",
        "w = sqrt(1 + ",
        schema=False,
    ),
    "point off the model, s2xe": Mistake(
        an_object("{ball: {radius: 1}, at: {model: [0, 0, 0, 1]}}", "s2xe"),
        "3:37",
        "where x^2 + y^2 + z^2 = 1",
        schema=False,
    ),
    "point off the model, h2xe": Mistake(
        an_object("{ball: {radius: 1}, at: {model: [1, 0, 1, 0]}}", "h2xe"),
        "3:37",
        "where z = sqrt(1 + x^2 + y^2)",
        schema=False,
    ),
    "point on the other sheet, sl2": Mistake(
        an_object("{ball: {radius: 1}, at: {model: [0, 0, -1, 0]}}", "sl2"),
        "3:37",
        "where z = sqrt(1 + x^2 + y^2)",
        schema=False,
    ),
    "point off the model, nil": Mistake(
        an_object("{ball: {radius: 1}, at: {model: [1, 0, 0, 0]}}", "nil"),
        "3:37",
        "where w = 1",
        schema=False,
    ),
    "zero direction": Mistake(
        an_object("half-space: {normal: [0, 0, 0]}"),
        "3:26",
        "a direction is not the zero vector",
        schema=False,
    ),
    "name of an axis": Mistake(
        an_object("cylinder: {radius: 1, along: z}"),
        "3:34",
        "expected 3 numbers [x, y, z], found 'z'",
        "[0, 0, 1]",
    ),
    "angle without a unit": Mistake(
        an_object("{ball: {radius: 1}, rotate: {axis: [0, 0, 1], angle: 0.5}}"),
        "3:58",
        "an angle needs a unit: write '0.5 deg' or '0.5 rad'",
    ),
    "angle for a rotation": Mistake(
        an_object("{ball: {radius: 1}, rotate: 30 deg}"),
        "3:33",
        "expected a rotation, found '30 deg'",
        "axis",
    ),
    "ball as large as s3": Mistake(
        an_object("ball: {radius: 3.2}", "s3"), "3:20", "the radius of a ball is less than π", schema=False
    ),
    "cylinder as large as s3": Mistake(
        an_object("cylinder: {radius: 1.6}", "s3"),
        "3:24",
        "the radius of a cylinder is less than π/2",
        schema=False,
    ),
    "half-space as large as s3": Mistake(
        an_object("half-space: {offset: -1.6}", "s3"), "3:26", "is less than π/2; this is -1.6", schema=False
    ),
    "ball as large as s2xe": Mistake(
        an_object("ball: {radius: 3.2}", "s2xe"),
        "3:20",
        "in s2xe the radius of a ball is less than π; this is 3.2",
        "meets itself",
        schema=False,
    ),
    "cylinder as large as s2xe": Mistake(
        an_object("cylinder: {radius: 3.2}", "s2xe"), "3:24", "a cylinder is less than π", schema=False
    ),
    "horizontal cylinder as large as s2xe": Mistake(
        an_object("cylinder: {radius: 1.6, along: [1, 1, 0]}", "s2xe"),
        "3:24",
        "the radius of a horizontal cylinder is less than π/2",
        schema=False,
    ),
    "vertical half-space as large as s2xe": Mistake(
        an_object("half-space: {normal: [1, 0, 0], offset: 1.6}", "s2xe"),
        "3:45",
        "in s2xe an offset, to either side, is less than π/2",
        schema=False,
    ),
    "slab as large as s3": Mistake(
        an_object("slab: {thickness: 3.2}", "s3"),
        "3:23",
        "in s3 the thickness of a slab is less than π; this is 3.2",
        "fills the whole space",
        schema=False,
    ),
    "vertical slab as large as s2xe": Mistake(
        an_object("slab: {normal: [1, 0, 0], thickness: 3.2}", "s2xe"),
        "3:42",
        "the thickness of a slab is less than π",
        schema=False,
    ),
    "slab without a thickness": Mistake(
        an_object("slab: {normal: [0, 0, 1]}"), "3:11", "a slab needs the key 'thickness'", "thickness: 0.2"
    ),
    "plate": Mistake(
        an_object("plate: {thickness: 1}"), "3:5", "unknown key 'plate'", "did you mean 'slab'?"
    ),
    "slanted half-space in nil": Mistake(
        an_object("half-space: {normal: [1, 0, -2]}", "nil"),
        "3:26",
        "in nil the normal of a half-space is along the fiber, [0, 0, 1], or across it, [x, y, 0]",
        "write [0, 0, -1] or [1, 0, 0]",
        schema=False,
    ),
    "slanted slab in h2xe": Mistake(
        an_object("slab: {normal: [0, 1, 1], thickness: 1}", "h2xe"),
        "3:20",
        "in h2xe the normal of a slab is along the fiber",
        "write [0, 0, 1] or [0, 1, 0]",
        schema=False,
    ),
    "slanted cylinder in h2xe": Mistake(
        an_object("cylinder: {radius: 1, along: [0, 1, 1]}", "h2xe"),
        "3:34",
        "in h2xe a cylinder is along the fiber, [0, 0, 1], or across it",
        "write [0, 0, 1] or [0, 1, 0]",
        schema=False,
    ),
    "horizontal cylinder in sl2": Mistake(
        an_object("cylinder: {radius: 1, along: [1, 0, 0]}", "sl2"),
        "3:34",
        "in sl2 a cylinder stands along the fiber",
        "write [0, 0, 1]",
        schema=False,
    ),
    "misspelt monodromy": Mistake(
        f"geometry: sol\nmanifold: {{monodromi: [[2, 1], [1, 1]]}}\n{BALL}",
        "2:12",
        "unknown key 'monodromi'",
        "did you mean 'monodromy'?",
    ),
    "far half-space in sol": Mistake(
        an_object("half-space: {normal: [0, -1, 0], offset: -800}", "sol"),
        "3:46",
        "in sol a plane is at most 27 from the center; this one is 800",
        schema=False,
    ),
    "thick slab in sol": Mistake(
        an_object("slab: {normal: [0, 0, 1], thickness: 54.5}", "sol"),
        "3:42",
        "in sol a plane is at most 27 from the center; this one is 27.25",
        schema=False,
    ),
    "slanted half-space in sol": Mistake(
        an_object("half-space: {normal: [1, 0, -2]}", "sol"),
        "3:26",
        "in sol the normal of a half-space is along an axis: [±1, 0, 0], [0, ±1, 0] or [0, 0, ±1]",
        "write [0, 0, -1]",
        schema=False,
    ),
    "slanted slab in sol": Mistake(
        an_object("slab: {normal: [0, 1, 1], thickness: 1}", "sol"),
        "3:20",
        "in sol the normal of a slab is along an axis",
        "write [0, 1, 0]",
        schema=False,
    ),
    "vertical cylinder in sol": Mistake(
        an_object("cylinder: {radius: 1}", "sol"),
        "3:15",
        "in sol a cylinder is about the x-axis, [1, 0, 0], or the y-axis, [0, 1, 0]",
        "write 'along: [1, 0, 0]' or 'along: [0, 1, 0]', or make it a pseudo-cylinder",
        schema=False,
    ),
    "cylinder about a diagonal of sol": Mistake(
        an_object("cylinder: {radius: 1, along: [1, 1, 0]}", "sol"),
        "3:34",
        "in sol a cylinder is about the x-axis",
        "make it a pseudo-cylinder",
        schema=False,
    ),
    "slanted pseudo-cylinder": Mistake(
        an_object("pseudo-cylinder: {radius: 1, along: [1, 0, 1]}", "sol"),
        "3:41",
        "a pseudo-cylinder is vertical, [0, 0, 1], or horizontal, [x, y, 0]",
        "write [0, 0, 1] or [1, 0, 0]",
        schema=False,
    ),
    "pseudo-ball in e3": Mistake(
        an_object("pseudo-ball: {radius: 1}"),
        "3:5",
        "pseudo-balls are made in sol, not in e3",
        "write 'ball: ...'",
        schema=False,
    ),
    "pseudo-cylinder in nil": Mistake(
        an_object("pseudo-cylinder: {radius: 1}", "nil"),
        "3:5",
        "pseudo-cylinders are made in sol, not in nil",
        "write 'cylinder: ...'",
        schema=False,
    ),
    "turn about an axis of sol": Mistake(
        an_object("{ball: {radius: 1}, rotate: {axis: [1, 0, 0], angle: 180 deg}}", "sol"),
        "3:40",
        "in sol the axis of a rotation is [0, 0, 1], [1, 1, 0] or [1, -1, 0]",
        "write one of these",
        schema=False,
    ),
    "quarter turn in sol": Mistake(
        an_object("{ball: {radius: 1}, rotate: {axis: [0, 0, 1], angle: 90 deg}}", "sol"),
        "3:58",
        "sol can be turned by 180 deg only; this is 90 deg",
        "write '180 deg'",
        schema=False,
    ),
    "point off the model, sol": Mistake(
        an_object("{ball: {radius: 1}, at: {model: [1, 0, 0, 0]}}", "sol"),
        "3:37",
        "where w = 1",
        schema=False,
    ),
    "crossing where the distance is known": Mistake(
        an_object("half-space: {crossing: bisection}", "h2xe"),
        "3:18",
        "in h2xe the distance to a plane is known",
        "leave crossing out",
        schema=False,
    ),
    "crossing of a vertical half-space": Mistake(
        an_object("half-space: {normal: [1, 0, 0], crossing: directed}", "nil"),
        "3:37",
        "the distance to a vertical plane is known",
        "leave crossing out",
        schema=False,
    ),
    "misspelt crossing": Mistake(
        an_object("half-space: {crossing: bisect}", "nil"), "3:28", "'bisect' is not", "'bisection'?"
    ),
    "slanted rotation in nil": Mistake(
        an_object("{ball: {radius: 1}, rotate: {axis: [1, 1, 1], angle: 180 deg}}", "nil"),
        "3:40",
        "in nil the axis of a rotation is along the fiber",
        "write [0, 0, 1] or [1, 1, 0]",
        schema=False,
    ),
    "quarter turn of a fiber": Mistake(
        an_object("{ball: {radius: 1}, rotate: [{axis: [1, 1, 0], angle: 90 deg}]}", "sl2"),
        "3:59",
        "about a horizontal axis sl2 can be turned by 180 deg only; this is 90 deg",
        "turn about the fiber: axis: [0, 0, 1]",
        schema=False,
    ),
    "horoball in e3": Mistake(
        an_object("horoball: {towards: [0, 0, 1], distance: 0}"),
        "3:5",
        "horoballs are made in h3, not in e3",
        schema=False,
    ),
    "tile without a manifold": Mistake(
        an_object("tile: {ball: 0.6}"),
        "3:5",
        "a tile needs a manifold, whose cell it is",
        "manifold: NAME",
        schema=False,
    ),
    # Lights
    "two geodesics in h2xe": Mistake(
        "geometry: h2xe\n" + BALL + "lights: [point: {at: [0, 0, 1], geodesics: 2}]\n",
        "3:44",
        "in h2xe only one geodesic joins two points, not 2",
        "leave it out",
        schema=False,
    ),
    "no geodesics in nil": Mistake(
        "geometry: nil\n" + BALL + "lights: [point: {at: [0, 0, 1], geodesics: 0}]\n",
        "3:44",
        "geodesics must be at least 1; this is 0",
    ),
    "one light without a manifold": Mistake(
        f"{E3}lights: [point: {{at: [0, 0, 1], repeated: false}}]\n",
        "3:33",
        "without a manifold no light is repeated",
        "leave it out",
        schema=False,
    ),
    "translates of one light": Mistake(
        f"{H3}manifold: seifert-weber\nlights: [point: {{at: [0, 0, 1], repeated: false, translates: 2}}]\n",
        "4:50",
        "a light that is not repeated has no translates",
        "leave one of the two out",
        schema=False,
    ),
    "yes for true": Mistake(
        f"{E3}lights: [point: {{at: [0, 0, 1], repeated: yes}}]\n",
        "3:43",
        "expected true or false, found 'yes'",
        "write true",
    ),
    "number for true": Mistake(
        f"{E3}lights: [point: {{at: [0, 0, 1], repeated: 0}}]\n",
        "3:43",
        "expected true or false, found 0",
        "write false",
    ),
    "misspelt falloff": Mistake(
        f"{E3}lights: [point: {{at: [0, 0, 1], falloff: invers}}]\n",
        "3:42",
        "'invers' is not one of: area, inverse, inverse-square, constant",
        "did you mean 'inverse'?",
    ),
    # Camera
    "eye": Mistake(f"{E3}camera: {{eye: [0, 0, 0]}}\n", "3:10", "unknown key 'eye'", "did you mean 'at'?"),
    "postion": Mistake(
        f"{E3}camera: {{postion: [0, 0, 0]}}\n", "3:10", "unknown key 'postion'", "did you mean 'at'?"
    ),
    "bare angle": Mistake(f"{E3}camera: {{fov: 90}}\n", "3:15", "an angle needs a unit: write '90 deg'"),
    "degree sign": Mistake(
        f"{E3}camera: {{fov: 90°}}\n", "3:15", "expected an angle such as '90 deg'", "write '90 deg'"
    ),
    "fov of a half turn": Mistake(
        f"{E3}camera: {{fov: 180 deg}}\n",
        "3:15",
        "a perspective view is between 0 and 180 deg",
        "fisheye",
        schema=False,
    ),
    "fov of nothing": Mistake(
        f"{E3}camera: {{fov: 0 deg}}\n", "3:15", "a field of view is greater than 0 deg", schema=False
    ),
    "fov in the projection": Mistake(
        f"{E3}camera: {{projection: {{perspective: {{fov: 60 deg}}}}}}\n",
        "3:37",
        "unknown key 'fov'",
        "in the camera",
    ),
    "fov of a fisheye": Mistake(
        f"{E3}camera: {{fov: 60 deg, projection: {{fisheye: {{}}}}}}\n",
        "3:10",
        "'fov' belongs to the perspective projection, not to fisheye",
        "leave it out (--set camera.fov=null) and write 'projection: {fisheye: {angle: 60 deg}}'",
        schema=False,
    ),
    "fov of a dome": Mistake(
        f"{E3}camera: {{fov: 60 deg, projection: {{dome: {{}}}}}}\n",
        "3:10",
        "'fov' belongs to the perspective projection, not to dome",
        "projection: {dome: {angle: 60 deg}}",
        schema=False,
    ),
    "fov of a panorama": Mistake(
        f"{E3}camera: {{fov: 60 deg, projection: {{equirectangular: {{}}}}}}\n",
        "3:10",
        "'fov' belongs to the perspective projection, not to equirectangular",
        "all directions",
        schema=False,
    ),
    "fov in a fisheye": Mistake(
        f"{E3}camera: {{projection: {{fisheye: {{fov: 60 deg}}}}}}\n",
        "3:33",
        "unknown key 'fov'",
        "did you mean 'angle'?",
    ),
    "angle of a panorama": Mistake(
        f"{E3}camera: {{projection: {{equirectangular: {{angle: 60 deg}}}}}}\n",
        "3:41",
        "unknown key 'angle'",
        "all directions",
    ),
    "panorama": Mistake(
        f"{E3}camera: {{projection: {{panorama: {{}}}}}}\n",
        "3:23",
        "unknown key 'panorama'",
        "did you mean 'equirectangular'?",
    ),
    "fulldome": Mistake(
        f"{E3}camera: {{projection: {{fulldome: {{}}}}}}\n",
        "3:23",
        "unknown key 'fulldome'",
        "did you mean 'dome'?",
    ),
    "orthographic": Mistake(
        f"{E3}camera: {{projection: {{orthographic: {{}}}}}}\n",
        "3:23",
        "unknown key 'orthographic'",
        "there is none",
    ),
    "two projections": Mistake(
        f"{E3}camera: {{projection: {{perspective: {{}}, dome: {{}}}}}}\n",
        "3:40",
        "a projection has only one of 'perspective' and 'dome'",
    ),
    "angle of a fisheye beyond a turn": Mistake(
        f"{E3}camera: {{projection: {{fisheye: {{angle: 361 deg}}}}}}\n",
        "3:40",
        "an angle of view is greater than 0 deg and at most 360 deg",
        schema=False,
    ),
    "stereo without a layout": Mistake(
        f"{E3}camera: {{stereo: {{distance: 0.1}}}}\n",
        "3:18",
        "stereo needs the key 'layout'",
        "stereo: {layout: side-by-side",
    ),
    "layout of stereo": Mistake(
        f"{E3}camera: {{stereo: {{layout: sidebyside}}}}\n",
        "3:27",
        "'sidebyside' is not one of: side-by-side, top-bottom, anaglyph",
        "did you mean 'side-by-side'?",
    ),
    "separation of eyes": Mistake(
        f"{E3}camera: {{stereo: {{layout: anaglyph, separation: 0.1}}}}\n",
        "3:37",
        "unknown key 'separation'",
        "did you mean 'distance'?",
    ),
    "convergence of eyes": Mistake(
        f"{E3}camera: {{stereo: {{layout: anaglyph, convergence: 2}}}}\n",
        "3:37",
        "unknown key 'convergence'",
        "views are parallel",
    ),
    "size of a panorama": Mistake(
        f"{E3}camera: {{projection: {{equirectangular: {{}}}}}}\nrender: {{size: [960, 540]}}\n",
        "4:16",
        "an equirectangular picture is twice as wide as high; this is 960 x 540",
        "for example size: [1080, 540]",
        schema=False,
    ),
    "size of a panorama for two eyes": Mistake(
        f"{E3}camera: {{projection: {{equirectangular: {{}}}}, stereo: {{layout: top-bottom}}}}\n"
        "render: {size: [1024, 512]}\n",
        "4:16",
        "twice as wide as high for each eye (top-bottom); this is 1024 x 512",
        "for example size: [512, 512]",
        schema=False,
    ),
    "odd width for two eyes": Mistake(
        f"{E3}camera: {{stereo: {{layout: side-by-side}}}}\nrender: {{size: [961, 540]}}\n",
        "4:16",
        "each eye has half of the width, and 961 is odd",
        "make it 962",
        schema=False,
    ),
    "unknown filter": Mistake(
        f"{E3}render: {{filter: gauss}}\n",
        "3:18",
        "'gauss' is not one of: box, tent, gaussian",
        "did you mean 'gaussian'?",
    ),
    "negative seed": Mistake(f"{E3}render: {{seed: -1}}\n", "3:16", "seed must be at least 0; this is -1"),
    "direction for a view": Mistake(
        f"{E3}camera: {{look: [1, 0, 0]}}\n", "3:16", "expected a view, found a list", "look: {along:"
    ),
    "along and to": Mistake(
        f"{E3}camera: {{look: {{along: [1, 0, 0], to: [0, 1, 0]}}}}\n",
        "3:35",
        "look either along a direction or to a point",
        schema=False,
    ),
    "up along the view": Mistake(
        f"{E3}camera: {{look: {{along: [1, 1, 0], up: [-2, -2, 0]}}}}\n",
        "3:39",
        "parallel to up, [-2, -2, 0]",
        schema=False,
    ),
    "view along the default up": Mistake(
        f"{E3}camera: {{look: {{along: [0, 0, 3]}}}}\n",
        "3:24",
        "parallel to up, [0, 0, 1]",
        "give 'up'",
        schema=False,
    ),
    "two steps in one": Mistake(
        f"{E3}camera: {{move: [{{forward: 1, yaw: 20 deg}}]}}\n",
        "3:30",
        "a step has only one of 'forward' and 'yaw'",
        "one step after the other",
    ),
    "backward": Mistake(
        f"{E3}camera: {{move: [{{back: 1}}]}}\n", "3:18", "unknown key 'back'", "forward by a negative number"
    ),
    # Colors and materials
    "misspelt color": Mistake(
        f"{E3}background: rred\n", "3:13", "'rred' is not a color", "did you mean 'red'?"
    ),
    "color in capitals": Mistake(
        f"{E3}background: White\n", "3:13", "'White' is not a color", "lower case: white"
    ),
    "color without #": Mistake(f"{E3}background: ff00ff\n", "3:13", "'ff00ff' is not a color", '"#ff00ff"'),
    "color with a short code": Mistake(
        f'{E3}background: "#ff00"\n', "3:13", "'#ff00' is not a color", "#rrggbb"
    ),
    "color of two numbers": Mistake(
        f"{E3}background: [1, 2]\n", "3:13", "expected 3 numbers [red, green, blue], found 2"
    ),
    "negative color": Mistake(
        f"{E3}background: [1, -1, 0]\n", "3:13", "the components of a color are at least 0"
    ),
    "color is a comment": Mistake(f"{E3}background: #ff0000\n", "3:1", "'background' has no value", "value"),
    "color as a function": Mistake(
        f"{E3}background: rgb(255, 128, 3)\n", "3:13", "'rgb(255, 128, 3)' is not a color", 'write "#ff8003"'
    ),
    "color as another function": Mistake(
        f"{E3}background: hsl(120 50% 50%)\n", "3:13", "is not a color", "functions are not read"
    ),
    "color function beyond its range": Mistake(
        f"{E3}background: RGB(256, 0, 0)\n", "3:13", "is not a color", "functions are not read"
    ),
    "bands without a color": Mistake(
        f"{E3}textures: {{a: {{bands: {{colors: []}}}}}}\n", "3:32", "expected at least 1 entry, found 0"
    ),
    "sky as a key of the scene": Mistake(
        f"{E3}sky: {{}}\n", "3:1", "unknown key 'sky'", "write 'background: {sky: {...}}'"
    ),
    "sky as a word": Mistake(
        f"{E3}background: sky\n", "3:13", "'sky' is not a color", "write 'background: {sky: {}}'"
    ),
    "background of nothing": Mistake(f"{E3}background: {{}}\n", "3:13", "a background needs one of: sky"),
    "sky without its key": Mistake(
        f"{E3}background: {{zenith: blue}}\n",
        "3:14",
        "unknown key 'zenith'",
        "it belongs inside 'sky': write 'sky: {zenith: ...}'",
    ),
    "sun of a sky": Mistake(
        f"{E3}background: {{sky: {{sun: [1, 0, 1]}}}}\n", "3:20", "unknown key 'sun'", "a sun is a light"
    ),
    **{
        f"{key} of a sky": Mistake(
            f"{E3}background: {{sky: {{{key}: blue}}}}\n", "3:20", f"unknown key '{key}'", f"'{meant}'"
        )
        for key, meant in (("top", "zenith"), ("bottom", "ground"))
    },
    "sky in s3": Mistake(
        f"{S3}background: {{sky: {{}}}}\n",
        "3:19",
        "there is a sky in e3 and h3, not in s3",
        "write a plain color, such as 'background: \"#dbe7f2\"'",
        schema=False,
    ),
    "sky in a manifold of h3": Mistake(
        f"{H3}manifold: seifert-weber\nbackground: {{sky: {{}}}}\n",
        "4:19",
        "in a manifold of h3 a ray reaches no point at infinity",
        "leave the manifold out",
        schema=False,
    ),
    "sky that a manifold turns": Mistake(
        f"{E3}manifold: half-turn\nbackground: {{sky: {{up: [1, 0, 0]}}}}\n",
        "4:19",
        "this manifold turns the direction up of the sky",
        "leave the manifold out",
        schema=False,
    ),
    **{
        f"{key} in s2xe": Mistake(
            an_object(f"{{ball: {{radius: 1}}, material: {{color: {{{key}: {{{inside}}}}}}}}}", "s2xe"),
            "3:44",
            f"{key} is made in {where}, not in s2xe",
            "use another pattern, such as 'grid: {}'",
            schema=False,
        )
        for key, inside, where in (
            ("noise", "", "e3, s3, h3"),
            ("triplanar", "grid: {}", "e3"),
            ("slope", "flat: red, steep: blue", "e3"),
        )
    },
    **{
        f"{key} for a material": Mistake(
            f"{E3}materials: {{a: {{{key}: {{}}}}}}\n",
            "3:17",
            f"unknown key '{key}'",
            f"'color: {{{key}: ...}}'",
        )
        for key in ("noise", "triplanar", "slope")
    },
    "noise of one color": Mistake(
        f"{E3}textures: {{a: {{noise: {{colors: [red]}}}}}}\n", "3:32", "expected at least 2 entries, found 1"
    ),
    "noise of too many octaves": Mistake(
        f"{E3}textures: {{a: {{noise: {{octaves: 13}}}}}}\n", "3:33", "octaves must be at most 12; this is 13"
    ),
    "noise of no octaves": Mistake(
        f"{E3}textures: {{a: {{noise: {{octaves: 0}}}}}}\n", "3:33", "octaves must be at least 1; this is 0"
    ),
    "noise stretched by a number": Mistake(
        f"{E3}textures: {{a: {{noise: {{stretch: 2}}}}}}\n", "3:33", "expected 3 numbers [x, y, z], found 2"
    ),
    "noise stretched to nothing": Mistake(
        f"{E3}textures: {{a: {{noise: {{stretch: [1, 0, 1]}}}}}}\n", "3:37", "must be greater than 0"
    ),
    **{
        f"{key} of noise": Mistake(
            f"{E3}textures: {{a: {{noise: {{{key}: 2}}}}}}\n", "3:24", f"unknown key '{key}'", f"'{meant}'"
        )
        for key, meant in (
            ("scale", "size"),
            ("frequency", "size"),
            ("count", "size"),
            ("detail", "octaves"),
            ("levels", "octaves"),
        )
    },
    "triplanar noise": Mistake(
        f"{E3}textures: {{a: {{triplanar: {{noise: {{}}}}}}}}\n", "3:28", "unknown key 'noise'", "known keys"
    ),
    "triplanar of nothing": Mistake(
        f"{E3}textures: {{a: {{triplanar: {{size: 2}}}}}}\n",
        "3:27",
        "a triplanar pattern needs one of: checker, grid, bands, strips, image",
        "triplanar: {image: earth, size: 0.5}",
    ),
    "slope of one paint": Mistake(
        f"{E3}textures: {{a: {{slope: {{flat: red}}}}}}\n",
        "3:23",
        "a slope needs the key 'steep'",
        "slope: {flat",
    ),
    "slope by an angle": Mistake(
        f"{E3}textures: {{a: {{slope: {{flat: red, steep: blue, angle: 30 deg}}}}}}\n",
        "3:48",
        "unknown key 'angle'",
        "the cosine of that angle",
    ),
    **{
        f"{key} of a slope": Mistake(
            f"{E3}textures: {{a: {{slope: {{flat: red, steep: blue, {key}: red}}}}}}\n",
            "3:48",
            f"unknown key '{key}'",
            f"did you mean '{meant}'?",
        )
        for key, meant in (("grass", "flat"), ("top", "flat"), ("rock", "steep"), ("side", "steep"))
    },
    "slope at no cosine": Mistake(
        f"{E3}textures: {{a: {{slope: {{flat: red, steep: blue, at: 28}}}}}}\n",
        "3:52",
        "at must be at most 1; this is 28",
    ),
    "unknown pattern inside a slope": Mistake(
        f"{E3}textures: {{a: {{slope: {{flat: {{stripes: {{}}}}, steep: red}}}}}}\n",
        "3:31",
        "unknown key 'stripes'",
        "did you mean 'strips'?",
    ),
    "texture inside itself": Mistake(
        f"{E3}textures: {{a: {{slope: {{flat: $textures.a, steep: red}}}}}}\n",
        "3:30",
        "the texture 'a' contains itself",
        "write a color or another texture here",
        schema=False,
    ),
    "textures inside each other": Mistake(
        f"{E3}textures:\n  a: {{slope: {{flat: $textures.b, steep: red}}}}\n"
        "  b: {slope: {flat: $textures.a, steep: red}}\n",
        "4:21",
        "the texture 'b' contains itself",
        "write a color or another texture here",
        schema=False,
    ),
    "strips of one color": Mistake(
        f"{E3}textures: {{a: {{strips: {{colors: [red]}}}}}}\n",
        "3:33",
        "expected at least 2 entries, found 1",
    ),
    "strips across a letter": Mistake(
        f"{E3}textures: {{a: {{strips: {{across: u}}}}}}\n", "3:33", "'u' is not one of: first, second"
    ),
    "strips for a material": Mistake(
        f"{E3}materials: {{a: {{strips: {{}}}}}}\n",
        "3:17",
        "unknown key 'strips'",
        "'color: {strips: ...}'",
    ),
    "image for a material": Mistake(
        f"{E3}materials: {{a: {{image: earth}}}}\n", "3:17", "unknown key 'image'", "'color: {image: ...}'"
    ),
    "missing image": Mistake(
        f"{E3}textures: {{a: {{image: no-such-file.jpg}}}}\n",
        "3:23",
        "there is no image file 'no-such-file.jpg'",
        "it is looked for in ",
        schema=False,
    ),
    "misspelt picture of the program": Mistake(
        f"{E3}textures: {{a: {{image: erth}}}}\n",
        "3:23",
        "no picture 'erth' comes with the program",
        "did you mean 'earth'?",
        schema=False,
    ),
    "unknown picture of the program": Mistake(
        f"{E3}textures: {{a: {{image: {{file: qqqq}}}}}}\n",
        "3:30",
        "no picture 'qqqq' comes with the program",
        "these pictures come with the program: earth; the name of a file has a suffix, as in qqqq.jpg",
        schema=False,
    ),
    "image without a file": Mistake(
        f"{E3}textures: {{a: {{image: {{size: 1}}}}}}\n", "3:23", "an image needs the key 'file'"
    ),
    "number for an image": Mistake(
        f"{E3}textures: {{a: {{image: {{file: 7}}}}}}\n",
        "3:30",
        "expected the name of an image file, found 7",
        "for example photo.jpg",
    ),
    "image of no size": Mistake(
        f"{E3}textures: {{a: {{image: {{file: earth, size: 0}}}}}}\n",
        "3:43",
        "size must be greater than 0; this is 0",
    ),
    "image of three sizes": Mistake(
        f"{E3}textures: {{a: {{image: {{file: earth, size: [1, 1, 1]}}}}}}\n",
        "3:43",
        "expected 2 numbers [w, h], found 3",
    ),
    "bands of half a line": Mistake(
        f"{E3}textures: {{a: {{bands: {{count: 0.5}}}}}}\n", "3:31", "expected a whole number, found 0.5"
    ),
    "bands for a material": Mistake(
        f"{E3}materials: {{a: {{bands: {{}}}}}}\n", "3:17", "unknown key 'bands'", "'color: {bands: ...}'"
    ),
    "stripes": Mistake(
        f"{E3}textures: {{a: {{stripes: {{}}}}}}\n", "3:16", "unknown key 'stripes'", "did you mean 'strips'?"
    ),
    "colour": Mistake(
        f"{E3}materials: {{a: {{colour: red}}}}\n", "3:17", "unknown key 'colour'", "did you mean 'color'?"
    ),
    "too much light": Mistake(
        f"{E3}materials: {{a: {{ambient: 0.5, specular: 0.6}}}}\n",
        "3:41",
        "ambient and specular add up to 1.1, which is more than 1",
        schema=False,
    ),
    "weights do not add up": Mistake(
        f"{E3}materials: {{a: {{diffuse: 0.5}}}}\n",
        "3:26",
        "add up to 0.8 instead of 1",
        "or write 0.7",
        schema=False,
    ),
    "weight above 1": Mistake(
        f"{E3}materials: {{a: {{ambient: 2}}}}\n", "3:26", "ambient must be at most 1; this is 2"
    ),
    "unknown material": Mistake(
        an_object("{ball: {radius: 1}, material: glob}") + "materials: {globe: {}}\n",
        "3:35",
        "there is no material 'glob'",
        "did you mean 'globe'?",
        schema=False,
    ),
    "color for a material": Mistake(
        an_object("{ball: {radius: 1}, material: gold}"),
        "3:35",
        "there is no material 'gold'",
        "material: {color: gold}",
        schema=False,
    ),
    "material with a dollar": Mistake(
        an_object("{ball: {radius: 1}, material: $materials.gold}") + "materials: {gold: {}}\n",
        "3:35",
        "there is no material '$materials.gold'",
        "write 'material: gold'",
    ),
    "misspelt material with a dollar": Mistake(
        an_object("{ball: {radius: 1}, material: $materials.glod}") + "materials: {gold: {}}\n",
        "3:35",
        "there is no material '$materials.glod'",
        "did you mean 'gold'?",
    ),
    "material without materials": Mistake(
        an_object("{ball: {radius: 1}, material: wood}"),
        "3:35",
        "there is no material 'wood'",
        "the scene has no materials; add",
        schema=False,
    ),
    "unknown texture": Mistake(
        f"{E3}textures: {{a: {{grid: {{}}}}}}\nmaterials: {{m: {{color: $textures.b}}}}\n",
        "4:24",
        "there is no texture 'b'",
        "textures has: a",
        schema=False,
    ),
    "wrong texture, used": Mistake(
        f"{E3}textures: {{a: {{grid: {{width: 2}}}}}}\nmaterials: {{m: {{color: $textures.a}}}}\n",
        "3:30",
        "width must be less than 1; this is 2",
    ),
    "name with a blank": Mistake(
        f'{E3}materials: {{"a b": {{}}}}\n', "3:13", "'a b' cannot be a name", "letters, digits, - or _"
    ),
    "pattern for a material": Mistake(
        an_object("{ball: {radius: 1}, material: {checker: {}}}"),
        "3:36",
        "unknown key 'checker'",
        "color: {checker",
    ),
    "two patterns": Mistake(
        f"{E3}textures: {{a: {{grid: {{}}, checker: {{}}}}}}\n",
        "3:26",
        "a pattern has only one of 'grid' and 'checker'",
    ),
    "one color of two": Mistake(
        f"{E3}textures: {{a: {{grid: {{colors: [red]}}}}}}\n",
        "3:31",
        "expected a list of two colors, found 1",
    ),
    "no squares": Mistake(
        f"{E3}textures: {{a: {{grid: {{count: 0}}}}}}\n", "3:30", "count must be at least 1; this is 0"
    ),
    "half a square": Mistake(
        f"{E3}textures: {{a: {{grid: {{count: [2, 1.5]}}}}}}\n", "3:34", "expected a whole number, found 1.5"
    ),
    # Lights and effects
    "light without its kind": Mistake(
        f"{E3}lights: [{{at: [0, 0, 1]}}]\n",
        "3:11",
        "unknown key 'at'",
        "inside 'point': write 'point: {at: ...}'",
    ),
    "light without a place": Mistake(
        f"{E3}lights: [point: {{}}]\n", "3:17", "a point light needs the key 'at'"
    ),
    "light straight where geodesics are known": Mistake(
        f"{E3}lights: [point: {{at: [0, 0, 1], direction: straight}}]\n",
        "3:33",
        "in e3 light comes along geodesics as quickly",
        "leave direction out",
        schema=False,
    ),
    "area density of a straight line": Mistake(
        f"{SOL}lights: [point: {{at: [0, 0, 1], direction: straight, falloff: area}}]\n",
        "3:63",
        "what comes along a straight line has no area density",
        "write inverse or constant",
        schema=False,
    ),
    "two straight lines": Mistake(
        f"{SOL}lights: [point: {{at: [0, 0, 1], direction: straight, geodesics: 2}}]\n",
        "3:54",
        "only one straight line joins two points",
        "leave geodesics out, or 'direction: straight'",
        schema=False,
    ),
    "shadows along a straight line": Mistake(
        f"{SOL}lights: [{{point: {{at: [0, 0, 1], direction: straight}}, shadows: hard}}]\n",
        "3:56",
        "light along a straight line of coordinates throws no shadows",
        "leave out shadows, or 'direction: straight'",
        schema=False,
    ),
    "sun in h3": Mistake(
        f"{H3}lights: [sun: {{}}]\n",
        "3:15",
        "h3 has no parallel light",
        "write 'point: {at: ...}' instead",
        schema=False,
    ),
    "slanted sun in sol": Mistake(
        f"{SOL}lights: [sun: {{from: [1, 0, -1]}}]\n",
        "3:22",
        "in sol only vertical light is parallel: from [0, 0, 1] or [0, 0, -1]",
        "write [0, 0, -1]",
        schema=False,
    ),
    "sun that a manifold turns": Mistake(
        f"{E3}manifold: half-turn\nlights: [sun: {{from: [1, 0, 0]}}]\n",
        "4:22",
        "this manifold turns the direction of the sun",
        "use a point light, or leave the manifold out",
        schema=False,
    ),
    "sun along": Mistake(
        f"{E3}lights: [sun: {{along: [1, 0, 0]}}]\n", "3:16", "unknown key 'along'", "write 'from: [x, y, z]'"
    ),
    "sun at a place": Mistake(
        f"{E3}lights: [sun: {{at: [1, 0, 0]}}]\n", "3:16", "unknown key 'at'", "write 'from: [x, y, z]'"
    ),
    "directional": Mistake(
        f"{E3}lights: [directional: {{}}]\n", "3:10", "unknown key 'directional'", "did you mean 'sun'?"
    ),
    "spot": Mistake(
        f"{E3}lights: [spot: {{}}]\n", "3:10", "unknown key 'spot'", "point lights and suns only"
    ),
    "sun and point": Mistake(
        f"{E3}lights: [{{sun: {{}}, point: {{at: [0, 0, 1]}}}}]\n",
        "3:20",
        "a light has only one of 'sun' and 'point'",
        "begin each light with '- '",
    ),
    "soft misspelt": Mistake(
        f"{E3}lights: [{{point: {{at: [0, 0, 1]}}, shadows: sofft}}]\n",
        "3:44",
        "expected hard or soft, found 'sofft'",
        "did you mean 'soft'?",
    ),
    "no shadows": Mistake(
        f"{E3}lights: [{{point: {{at: [0, 0, 1]}}, shadows: false}}]\n",
        "3:44",
        "expected hard or soft, found false",
        "leave shadows out for none",
    ),
    "both kinds of shadows": Mistake(
        f"{E3}lights: [{{point: {{at: [0, 0, 1]}}, shadows: {{hard: {{}}, soft: {{}}}}}}]\n",
        "3:55",
        "shadows has only one of 'hard' and 'soft'",
    ),
    "all geodesics": Mistake(
        f"{S3}lights: [point: {{at: [0, 0, 1], geodesics: all}}]\n",
        "3:44",
        "expected a whole number or a greatest length, found 'all'",
        "write 'geodesics: {within: LENGTH}'",
    ),
    "geodesics within nothing": Mistake(
        f"{S3}lights: [point: {{at: [0, 0, 1], geodesics: {{within: 0}}}}]\n",
        "3:53",
        "within must be greater than 0; this is 0",
    ),
    "a light's ball around the sphere": Mistake(
        f"{S3}lights: [point: {{at: [0, 0, 1], ball: 3.2}}]\n",
        "3:39",
        "in s3 the radius of a ball is less than π; this is 3.2",
        schema=False,
    ),
    "a ball for one light": Mistake(
        f"{S3}manifold: poincare\nlights: [point: {{at: [0, 0, 1], ball: 0.1, repeated: false}}]\n",
        "4:33",
        "the ball of a light stands in every cell, and this light does not",
        "leave ball out, or 'repeated: false'",
        schema=False,
    ),
    "reflectivity without reflections": Mistake(
        "geometry: e3\nobjects: [{ball: {radius: 1}, material: {reflectivity: 0.5}}]\n",
        "2:42",
        "a material with reflectivity needs reflections, which this scene does not call for",
        "add 'effects: {reflections: {depth: 1}}'",
        schema=False,
    ),
    "reflections without a mirror": Mistake(
        f"{E3}effects: {{reflections: {{depth: 2}}}}\n",
        "3:11",
        "no object has a material with reflectivity",
        "give a material 'reflectivity: 0.5'",
        schema=False,
    ),
    "many reflections": Mistake(
        "geometry: e3\nobjects: [{ball: {radius: 1}, material: {reflectivity: 0.5}}]\n"
        "effects: {reflections: {depth: 9}}\n",
        "3:32",
        "depth must be at most 8; this is 9",
    ),
    "mirror": Mistake(
        "geometry: e3\nobjects: [{ball: {radius: 1}, material: {mirror: 0.5}}]\n",
        "2:42",
        "unknown key 'mirror'",
        "write 'reflectivity: 0.5'",
    ),
    "occlusion without reach": Mistake(
        f"{E3}effects: {{ambient-occlusion: {{}}}}\n", "3:30", "ambient occlusion needs the key 'reach'"
    ),
    "shadows inside": Mistake(
        f"{E3}lights: [point: {{at: [0, 0, 1], shadows: hard}}]\n",
        "3:33",
        "unknown key 'shadows'",
        "beside 'point'",
    ),
    "dark light": Mistake(
        f"{E3}lights: [point: {{at: [0, 0, 1], intensity: 0}}]\n",
        "3:44",
        "intensity must be greater than 0; this is 0",
    ),
    "many geodesics in e3": Mistake(
        f"{E3}lights: [point: {{at: [0, 0, 1], geodesics: 2}}]\n", "3:44", "only one geodesic", schema=False
    ),
    "no geodesics": Mistake(
        f"{S3}lights: [point: {{at: [0, 0, 1], geodesics: 0}}]\n",
        "3:44",
        "geodesics must be at least 1; this is 0",
    ),
    "translates without a manifold": Mistake(
        f"{S3}lights: [point: {{at: [0, 0, 1], translates: 3}}]\n",
        "3:33",
        "translates needs a manifold",
        schema=False,
    ),
    "American neighbours": Mistake(
        f"{S3}manifold: quaternion\nlights: [point: {{at: [0, 0, 1], translates: neighbors}}]\n",
        "4:45",
        "found 'neighbors'",
        "did you mean 'neighbours'?",
    ),
    "fog without its kind": Mistake(
        f"{E3}effects: {{fog: {{density: 1}}}}\n", "3:17", "unknown key 'density'", "inside 'exponential'"
    ),
    "linear fog": Mistake(
        f"{E3}effects: {{fog: {{linear: {{}}}}}}\n", "3:25", "linear fog needs the key 'length'"
    ),
    "two fogs": Mistake(
        f"{E3}effects: {{fog: {{linear: {{length: 1}}, exponential: {{density: 1}}}}}}\n",
        "3:38",
        "fog has only one of 'linear' and 'exponential'",
    ),
    "reflections": Mistake(
        f"{E3}effects: {{reflections: 2}}\n",
        "3:24",
        "expected reflections, found 2",
        "for example reflections: {depth: 2}",
    ),
    # Settings and outputs
    "part of a sample": Mistake(
        f"{E3}render: {{samples: 4.5}}\n", "3:19", "expected a whole number, found 4.5"
    ),
    "many samples": Mistake(
        f"{E3}render: {{samples: 1e4}}\n", "3:19", "samples must be at most 4096; this is 10000"
    ),
    "spp": Mistake(f"{E3}render: {{spp: 4}}\n", "3:10", "unknown key 'spp'", "did you mean 'samples'?"),
    "misspelt precision": Mistake(
        f"{E3}render: {{precision: doubel}}\n",
        "3:21",
        "'doubel' is not one of: auto, single, double",
        "'double'",
    ),
    "one side of a picture": Mistake(
        f"{E3}render: {{size: [10]}}\n", "3:16", "expected 2 numbers [width, height], found 1"
    ),
    "wide picture": Mistake(
        f"{E3}render: {{size: [16385, 1]}}\n", "3:17", "size must be at most 16384; this is 16385"
    ),
    "far nearer than threshold": Mistake(
        f"{E3}render: {{far: 1e-5}}\n",
        "3:15",
        "far must be greater than threshold, which is 0.0001",
        schema=False,
    ),
    "accuracy and what it chooses": Mistake(
        f"{E3}render: {{accuracy: half-pixel, threshold: 1e-5}}\n",
        "3:32",
        "accuracy chooses the threshold itself",
        "leave one of them out",
        schema=False,
    ),
    "accuracy and detail": Mistake(
        f"{E3}render: {{accuracy: half-pixel, detail: 2}}\n",
        "3:32",
        "detail leaves out what is finer, and accuracy says how exact all of it is",
        "leave one of them out",
        schema=False,
    ),
    "an accuracy without unit": Mistake(
        f"{E3}render: {{accuracy: 0.001}}\n",
        "3:20",
        "expected one of half-pixel, quarter-pixel, draft, reference, or an angle, found 0.001",
        "an angle needs a unit: write '0.001 rad', or 'half-pixel'",
    ),
    "an accuracy of nothing": Mistake(
        f"{E3}render: {{accuracy: 0 rad}}\n",
        "3:20",
        "an accuracy is an angle greater than 0 and at most 180 deg",
        schema=False,
    ),
    "a step of the exact flow": Mistake(
        f"{E3}render: {{flow-step: 0.1}}\n",
        "3:10",
        "flow-step is that of an integrator, and the flow is exact",
        "leave it out, or write a flow such as 'flow: rk4'",
        schema=False,
    ),
    "steps of nothing": Mistake(
        f"{E3}render: {{flow: rk4, flow-step: 0}}\n",
        "3:32",
        "flow-step must be at least 0.0001; this is 0",
    ),
    "detail of no pixels": Mistake(
        f"{E3}render: {{detail: 0}}\n", "3:18", "detail must be greater than 0; this is 0"
    ),
    "an unknown tracer": Mistake(
        f"{E3}render: {{tracer: direkt}}\n",
        "3:18",
        "is not one of: auto, direct, relaxed",
        "did you mean 'direct'?",
    ),
    "relaxed in a manifold": Mistake(
        f"geometry: e3\nmanifold: three-torus\n{BALL}render: {{tracer: relaxed}}\n",
        "4:10",
        "tracer: relaxed needs the whole space, and this is a manifold",
        "leave it out, or write 'tracer: direct'",
        schema=False,
    ),
    "relaxed over a level plane": Mistake(
        "geometry: nil\nobjects: [union: [{ball: {radius: 1}}, {slab: {normal: [0, 0, 1], thickness: 1}}]]\n"
        "render: {tracer: relaxed}\n",
        "3:10",
        "tracer: relaxed needs distances all around; that of a level plane holds along the ray",
        "leave it out, or write 'tracer: direct'",
        schema=False,
    ),
    "compound in nil": Mistake(
        "geometry: nil\nobjects: [{ball: {radius: 1}}, {ball: {radius: 1}}]\nrender: {tracer: compound}\n",
        "3:10",
        "tracer: compound flows along any length at once, which in nil is costly",
        "leave it out, or write 'tracer: direct'",
        schema=False,
    ),
    "compound of one object": Mistake(
        f"{E3}render: {{tracer: compound}}\n",
        "3:10",
        "tracer: compound marches 2 to 16 objects by themselves, and here are 1, with the balls of lights",
        "a union of objects is one object",
        schema=False,
    ),
    "compound of too many objects": Mistake(
        "geometry: e3\nobjects: [" + 16 * "{ball: {radius: 1}}, " + "]\n"
        "lights: [point: {at: [0, 0, 3], ball: 0.1}]\nrender: {tracer: compound}\n",
        "4:10",
        "tracer: compound marches 2 to 16 objects by themselves, and here are 17, with the balls of lights",
        "a union of objects is one object",
        schema=False,
    ),
    "binary in h3": Mistake(
        f"{H3}render: {{tracer: binary}}\n",
        "3:10",
        "tracer: binary is made for e3, not for h3",
        "leave it out, or write 'tracer: direct'",
        schema=False,
    ),
    "binary with soft shadows": Mistake(
        f"{E3}lights: [{{point: {{at: [0, 0, 3]}}, shadows: soft}}]\nrender: {{tracer: binary}}\n",
        "3:35",
        "soft shadows need a distance, and tracer: binary asks for none",
        "write 'shadows: hard', or another tracer",
        schema=False,
    ),
    "blocks in h3": Mistake(
        f"{H3}render: {{start: block}}\n",
        "3:10",
        "start: block needs e3, and this is h3",
        "leave it out, or write 'start: pixel'",
        schema=False,
    ),
    "blocks in a manifold": Mistake(
        f"geometry: e3\nmanifold: three-torus\n{BALL}render: {{start: block}}\n",
        "4:10",
        "start: block needs the whole space, and this is a manifold",
        "leave it out, or write 'start: pixel'",
        schema=False,
    ),
    "blocks of a fisheye": Mistake(
        f"{E3}camera: {{projection: {{fisheye: {{}}}}}}\nrender: {{start: block}}\n",
        "4:10",
        "start: block needs a perspective, and this is fisheye",
        "leave it out, or write 'start: pixel'",
        schema=False,
    ),
    "distance without a manifold": Mistake(
        f"{E3}render: {{distance: both}}\n", "3:10", "distance: both needs a manifold", schema=False
    ),
    "output above the folder": Mistake(
        f"{E3}outputs: [file: ../x.png]\n", "3:17", "climbs out with '..'", "-o"
    ),
    "output above, hidden": Mistake(f"{E3}outputs: [file: a/../../x.png]\n", "3:17", "climbs out with '..'"),
    "output above, on Windows": Mistake(
        f"{E3}outputs: [file: 'a\\..\\x.png']\n", "3:17", "climbs out with '..'"
    ),
    "absolute output": Mistake(
        f"{E3}outputs: [file: /tmp/x.png]\n", "3:17", "'/tmp/x.png' is absolute", "-o"
    ),
    "output on a drive": Mistake(f"{E3}outputs: [file: 'C:x.png']\n", "3:17", "'C:x.png' is absolute"),
    "output in a home folder": Mistake(f"{E3}outputs: [file: ~/x.png]\n", "3:17", "'~/x.png' is absolute"),
    "output as jpeg": Mistake(
        f"{E3}outputs: [file: x.jpg]\n", "3:17", "'x.jpg' is neither a .png nor an .exr file"
    ),
    "output without a name": Mistake(f"{E3}outputs: [file: .png]\n", "3:17", "'.png' is neither"),
    "misspelt channel": Mistake(
        f"{E3}outputs: [{{file: x.exr, channels: [depht]}}]\n",
        "3:36",
        "'depht' is not one of",
        "did you mean 'depth'?",
    ),
    "channel twice": Mistake(
        f"{E3}outputs: [{{file: x.exr, channels: [depth, depth]}}]\n",
        "3:43",
        "'depth' is listed twice",
        schema=False,
    ),
    "channels of a png": Mistake(
        f"{E3}outputs: [{{file: x.png, channels: [depth]}}]\n",
        "3:25",
        "a .png holds the picture only",
        schema=False,
    ),
    "exposure of an exr": Mistake(
        f"{E3}outputs: [{{file: x.exr, exposure: 1}}]\n",
        "3:25",
        "an .exr keeps the linear numbers and takes no exposure",
        "write a .png too",
        schema=False,
    ),
    "view of an exr": Mistake(
        f"{E3}outputs: [{{file: x.EXR, view: filmic}}]\n",
        "3:25",
        "an .exr keeps the linear numbers and takes no view",
        "leave it out",
        schema=False,
    ),
    "coral bent out of shape": Mistake(
        "geometry: e3\nobjects:\n  - krs: {coral: {bend: 1}}\n",
        "3:25",
        "bend must be at most 0.6; this is 1",
    ),
    "palm leaf that is all tip": Mistake(
        "geometry: e3\nobjects:\n  - krs: {palm-leaf: {taper: 5}}\n",
        "3:30",
        "taper must be at most 4; this is 5",
    ),
    "heat map in an exr": Mistake(
        f"{E3}outputs: [{{file: x.exr, shows: steps}}]\n",
        "3:25",
        "an .exr keeps numbers and makes no heat map of them",
        "name what it holds in 'channels'",
        schema=False,
    ),
    "black in an exr": Mistake(
        f"{E3}outputs: [{{file: x.exr, most: 70}}]\n",
        "3:25",
        "an .exr keeps numbers and makes no heat map of them",
        "leave it out",
        schema=False,
    ),
    "heat map of an unknown channel": Mistake(
        f"{E3}outputs: [{{file: x.png, shows: step}}]\n",
        "3:32",
        "'step' is not one of: beauty, depth, steps",
        "did you mean 'steps'?",
    ),
    "black without a heat map": Mistake(
        f"{E3}outputs: [{{file: x.png, most: 70}}]\n",
        "3:25",
        "most says what is black in a heat map, and this is the picture",
        "add 'shows: steps' or 'shows: depth'",
        schema=False,
    ),
    "black is 0": Mistake(
        f"{E3}outputs: [{{file: x.png, shows: steps, most: 0}}]\n",
        "3:45",
        "most must be greater than 0; this is 0",
    ),
    "exposed heat map": Mistake(
        f"{E3}outputs: [{{file: x.png, shows: steps, exposure: 1}}]\n",
        "3:39",
        "a heat map of steps is no light and takes no exposure",
        "leave it out",
        schema=False,
    ),
    "heat map as a film shows it": Mistake(
        f"{E3}outputs: [{{file: x.png, shows: depth, view: aces}}]\n",
        "3:39",
        "a heat map of depth is no light and takes no view",
        "leave it out",
        schema=False,
    ),
    "exposure of a sun": Mistake(
        f"{E3}outputs: [{{file: x.png, exposure: 33}}]\n", "3:35", "exposure must be at most 32; this is 33"
    ),
    "exposure of a cellar": Mistake(
        f"{E3}outputs: [{{file: x.png, exposure: -33}}]\n",
        "3:35",
        "exposure must be at least -32; this is -33",
    ),
    "misspelt view": Mistake(
        f"{E3}outputs: [{{file: x.png, view: flimic}}]\n",
        "3:31",
        "'flimic' is not one of: none, filmic, aces",
        "did you mean 'filmic'?",
    ),
    "tone map of an output": Mistake(
        f"{E3}outputs: [{{file: x.png, tonemap: filmic}}]\n",
        "3:25",
        "unknown key 'tonemap'",
        "did you mean 'view'?",
    ),
    "file twice": Mistake(
        f"{E3}outputs: [file: x.png, file: X.png]\n",
        "3:30",
        "'X.png' is the file of output 1 already",
        schema=False,
    ),
    # Kernel-reflection sequences in curved spaces
    **{
        f"a sequence in {name}": Mistake(
            a_sequence(ONE_LEVEL, name),
            "3:10",
            f"in {name} nothing is doubled by mirrors",
            "sequences are made in e3, s3, h3, s2xe, h2xe",
            False,
        )
        for name in ("nil", "sl2", "sol")
    },
    "a Moebius sequence in h3": Mistake(
        a_sequence("kernel: {ball: {radius: 0.1}}, moebius: [{map: [{move: [1, 0, 0]}]}]", "h3"),
        "3:42",
        "this is made in e3, not in h3",
        "write 'levels'",
        False,
    ),
    "a twist in s3": Mistake(
        a_sequence(f"twist: {{angle: 10 deg}}, {ONE_LEVEL}", "s3"),
        "3:11",
        "this is made in e3, not in s3",
        "",
        False,
    ),
    "empty zones in h2xe": Mistake(
        a_sequence(f"empty-zones: {{radius: 1}}, {ONE_LEVEL}", "h2xe"),
        "3:11",
        "this is made in e3, not in h2xe",
        "",
        False,
    ),
    "an arc in h3": Mistake(
        a_sequence(
            "kernel: {arc: {from: [0, 0, 0], through: [0.1, 0, 0.5], to: [0, 0, 1], radius: 0.1}}, "
            "levels: [{mirror: {normal: [1, 0, 0]}}]",
            "h3",
        ),
        "3:20",
        "this kernel is made in e3, not in h3",
        "there is the capsule",
        False,
    ),
    "a leaf in s2xe": Mistake(
        a_sequence(
            "kernel: {leaf: {radius: 0.1, thickness: 0.03}}, levels: [{mirror: {normal: [1, 0, 0]}}]", "s2xe"
        ),
        "3:20",
        "this kernel is made in e3, not in s2xe",
        "there is the capsule",
        False,
    ),
    "a slanted mirror in h2xe": Mistake(
        a_sequence("kernel: {ball: {radius: 0.1}}, levels: [{mirror: {normal: [1, 0, 2]}}]", "h2xe"),
        "3:69",
        "in h2xe a mirror is across the fiber or along it",
        "write [0, 0, 1] or [1, 0, 0]",
        False,
    ),
    "a slanted capsule in h2xe": Mistake(
        a_sequence(
            "kernel: {capsule: {to: [0, 0, 1], from: [0.2, 0, 0], radius: 0.1}}, "
            "levels: [{mirror: {normal: [1, 0, 0]}}]",
            "h2xe",
        ),
        "3:34",
        "in h2xe the capsules of a sequence stand along the fiber",
        "write [0.2, 0, 1], over its other end",
        False,
    ),
    "a capsule without length": Mistake(
        a_sequence(
            "kernel: {capsule: {to: [0, 0, 1], from: [0, 0, 1], radius: 0.1}}, "
            "levels: [{mirror: {normal: [1, 0, 0]}}]",
            "h3",
        ),
        "3:34",
        "a capsule does not end where it begins",
        "write 'ball' for a ball",
        False,
    ),
    "a hyperbolic forest of too many levels": Mistake(
        a_forest("doublings: 30, forks: 9, foliage: 4"),
        "3:42",
        "doublings, forks and foliage make 43 mirrors together; at most 40 can be",
        "take 3 off 'doublings'",
        False,
    ),
    "a hyperbolic forest of too many doublings": Mistake(
        a_forest("doublings: 31"), "3:42", "doublings must be at most 30; this is 31"
    ),
    "a hyperbolic forest that spreads too far": Mistake(
        a_forest("spread: 61 deg"),
        "3:39",
        "expected an angle from 5 to 60 deg; this is 61 deg",
        "",
        False,
    ),
    "a hyperbolic forest that is too irregular": Mistake(
        a_forest("irregular: 2"), "3:42", "irregular must be at most 1; this is 2"
    ),
    "a hyperbolic forest with walls below 0": Mistake(
        a_forest("wall: -1"), "3:37", "wall must be at least 0; this is -1"
    ),
    "a hyperbolic forest with a material": Mistake(
        a_forest("material: gold"), "3:31", "unknown key 'material'", "'bark', 'leaf', 'ground' and 'stone'"
    ),
    "a hyperbolic forest with a color": Mistake(
        a_forest("color: red"), "3:31", "unknown key 'color'", "write 'bark: {color: ...}'"
    ),
    "a hyperbolic forest by its levels": Mistake(
        a_forest("levels: 20"), "3:31", "unknown key 'levels'", "write 'doublings' for the forest"
    ),
    "a hyperbolic forest by its trees": Mistake(
        a_forest("trees: 20"), "3:31", "unknown key 'trees'", "write 'doublings': there are 2^doublings trees"
    ),
    "a hyperbolic forest by its density": Mistake(
        a_forest("density: 2"), "3:31", "unknown key 'density'", "each tree has a pentagon of area 1.571"
    ),
    "a hyperbolic forest with a place inside": Mistake(
        a_forest("at: [0, 0, 1]"), "3:31", "unknown key 'at'", "'at' stands beside 'krs', not inside it"
    ),
    # Sequences
    "a sequence of nothing": Mistake(
        a_sequence(""),
        "3:10",
        "a sequence needs one of: levels, moebius, record, tree",
        "for example krs: {tree: {seed: 3}}",
    ),
    "a sequence in nil": Mistake(
        a_sequence(f"{ONE_LEVEL}", "nil"),
        "3:10",
        "in nil nothing is doubled by mirrors",
        "sequences are made in e3, s3, h3, s2xe, h2xe",
        False,
    ),
    "two recipes": Mistake(
        a_sequence("tree: {}, rock: {}"), "3:21", "a sequence has only one of 'tree' and 'rock'", ""
    ),
    "mirrors of a sequence": Mistake(
        a_sequence("mirrors: []"),
        "3:11",
        "unknown key 'mirrors'",
        "write 'levels: [{mirror: ..., kernel: ...}, ...]', and 'kernel' for the innermost one",
    ),
    "a material in a sequence": Mistake(
        a_sequence(f"{ONE_LEVEL}, material: gold"),
        "3:83",
        "unknown key 'material'",
        "'material' stands beside 'krs', or with a kernel of its levels",
    ),
    "a sequence without kernels": Mistake(
        a_sequence("levels: [{mirror: {normal: [1, 0, 0]}}]"),
        "3:10",
        "there is no kernel, so that there is nothing to double",
        "add 'kernel: {ball: {radius: 0.1}}'",
        False,
    ),
    "a recipe with a kernel": Mistake(
        a_sequence("tree: {}, kernel: {ball: {radius: 0.1}}"),
        "3:21",
        "a recipe or a record brings its kernels with it",
        "leave kernel out, or write levels",
        False,
    ),
    "a recipe made of something": Mistake(
        a_sequence("tree: {}, made-of: [{color: red}]"),
        "3:21",
        "only the kernels of a record are made of what is listed here",
        "leave it out",
        False,
    ),
    "a tree in h3": Mistake(
        a_sequence("tree: {}", "h3"),
        "3:11",
        "this is made in e3, not in h3",
        "write 'hyperbolic-forest'",
        False,
    ),
    "a forest in h3": Mistake(
        a_sequence("forest: {}", "h3"),
        "3:11",
        "this is made in e3, not in h3",
        "write 'hyperbolic-forest'",
        False,
    ),
    "a tree in s3": Mistake(
        a_sequence("tree: {}", "s3"),
        "3:11",
        "this is made in e3, not in s3",
        "write 'levels', with mirrors and kernels",
        False,
    ),
    "a hyperbolic forest in e3": Mistake(
        a_sequence("hyperbolic-forest: {}"),
        "3:11",
        "this is made in h3, not in e3",
        "write 'forest'",
        False,
    ),
    "a twist in h3": Mistake(
        a_sequence(f"{ONE_LEVEL}, twist: {{angle: 9 deg}}", "h3"),
        "3:83",
        "this is made in e3, not in h3",
        "leave 'twist' out",
        False,
    ),
    "an empty zone in h3": Mistake(
        a_sequence(f"{ONE_LEVEL}, empty-zones: {{radius: 1}}", "h3"),
        "3:83",
        "this is made in e3, not in h3",
        "leave 'empty-zones' out",
        False,
    ),
    "a recipe of fish": Mistake(
        a_sequence("fish: {}"), "3:11", "unknown key 'fish'", "did you mean 'fish-school'?"
    ),
    "a recipe of a palm": Mistake(
        a_sequence("palm: {}"), "3:11", "unknown key 'palm'", "did you mean 'palm-leaf'?"
    ),
    "a recipe of grass": Mistake(
        a_sequence("grass: {}"), "3:11", "unknown key 'grass'", "did you mean 'meadow'?"
    ),
    "a recipe of a seabed": Mistake(
        a_sequence("seabed: {}"), "3:11", "unknown key 'seabed'", "did you mean 'terrain'?"
    ),
    "a recipe of a reef": Mistake(
        a_sequence("reef: {}"),
        "3:11",
        "unknown key 'reef'",
        "there is no recipe 'reef': write several objects, each with a 'coral'",
    ),
    "a color for a leaf": Mistake(
        a_sequence("tree: {leaf: tomato}"),
        "3:24",
        "there is no material 'tomato'",
        "for a plain color write 'leaf: {color: tomato}'",
        False,
    ),
    "a color for what a record is made of": Mistake(
        a_sequence(f"record: {{mirrors: [], kernels: [{BALL_KERNEL}]}}, made-of: [tomato]"),
        "3:91",
        "there is no material 'tomato'",
        "for a plain color write '{color: tomato}'",
        False,
    ),
    "a map that rotates": Mistake(
        a_sequence("kernel: {ball: {radius: 0.1}}, moebius: [{map: [{rotate: 1}]}]"),
        "3:60",
        "unknown key 'rotate'",
        "did you mean 'turn'?",
    ),
    "a map that translates": Mistake(
        a_sequence("kernel: {ball: {radius: 0.1}}, moebius: [{map: [{translate: 1}]}]"),
        "3:60",
        "unknown key 'translate'",
        "did you mean 'move'?",
    ),
    "a map that is no list": Mistake(
        a_sequence("kernel: {ball: {radius: 0.1}}, moebius: [{map: {move: [1, 0, 0]}}]"),
        "3:58",
        "expected a list, found a mapping",
        "write [{move: ...}]",
    ),
    "a map of two steps that is no list": Mistake(
        a_sequence("kernel: {ball: {radius: 0.1}}, moebius: [{map: {scale: 2, move: [1, 0, 0]}}]"),
        "3:58",
        "expected a list, found a mapping",
        "write [{scale: ...}, ...]",
    ),
    "a colored ball as a kernel": Mistake(
        a_sequence(f"kernel: {{ball: {{radius: 0.1, color: red}}}}, {A_LEVEL}"),
        "3:40",
        "unknown key 'color'",
        "write 'material: {color: ...}' beside 'ball'",
    ),
    "a capsule with a material as a kernel": Mistake(
        a_sequence(
            f"kernel: {{capsule: {{from: [0, 0, 0], to: [0, 0, 1], radius: 1, material: a}}}}, {A_LEVEL}"
        ),
        "3:73",
        "unknown key 'material'",
        "write 'material: {color: ...}' beside 'capsule'",
    ),
    "a ground of some color": Mistake(
        a_sequence("forest: {ground: {color: red}}"),
        "3:28",
        "expected true or false, found a mapping",
        "the ground's material is 'soil': write 'soil: {color: ...}'",
    ),
    "a tree that turns too far": Mistake(
        a_sequence("tree: {turn: 361 deg}"),
        "3:24",
        "expected an angle from -360 to 360 deg; this is 361 deg",
        "",
        False,
    ),
    "a record in h3": Mistake(
        a_sequence(
            f"record: {{mirrors: [{{u: [1, 0, 0], w: 1}}], kernels: [{BALL_KERNEL}, {{type: empty}}]}}",
            "h3",
        ),
        "3:11",
        "this is made in e3, not in h3",
        "write 'levels', with mirrors and kernels",
        False,
    ),
    "41 levels": Mistake(
        a_sequence(
            "kernel: {ball: {radius: 0.1}}, levels: "
            + f"[{', '.join(['{mirror: {normal: [1, 0, 0]}}'] * 41)}]"
        ),
        "3:50",
        "at most 40 levels; these are 41",
        "leave some out",
        False,
    ),
    "41 Moebius levels": Mistake(
        a_sequence(
            "kernel: {ball: {radius: 0.1}}, moebius: " + f"[{', '.join(['{map: [{move: [1, 0, 0]}]}'] * 41)}]"
        ),
        "3:51",
        "at most 40 levels; these are 41",
        "leave some out",
        False,
    ),
    "a half-space in a Moebius sequence": Mistake(
        a_sequence("kernel: {half-space: {}}, moebius: [{map: [{move: [1, 0, 0]}]}]"),
        "3:20",
        "a Moebius sequence has bounded kernels only",
        "write a large ball",
        False,
    ),
    "a half-space that is twisted": Mistake(
        a_sequence(f"kernel: {{half-space: {{}}}}, {A_LEVEL}, twist: {{angle: 9 deg}}"),
        "3:20",
        "a half-space has no bound, and what has none cannot be twisted",
        "make it an object of its own",
        False,
    ),
    "a terrain that is twisted": Mistake(
        a_sequence("terrain: {levels: 4}, twist: {angle: 9 deg}"),
        "3:33",
        "this terrain has a plane, so no bound, and what has none cannot be twisted",
        "leave the twist out",
        False,
    ),
    "a forest that is twisted": Mistake(
        a_sequence("forest: {}, twist: {angle: 9 deg}"),
        "3:23",
        "this forest has a plane, so no bound, and what has none cannot be twisted",
        "write 'ground: false'",
        False,
    ),
    "a record without bound that is twisted": Mistake(
        a_sequence(
            "record: {mirrors: [], kernels: [{type: plane, n: [0, 0, 1], h: 0}]}, twist: {angle: 9 deg}"
        ),
        "3:80",
        "this record has a plane, so no bound, and what has none cannot be twisted",
        "leave the twist out",
        False,
    ),
    "a number for a twist": Mistake(
        a_sequence(f"{ONE_LEVEL}, twist: 9 deg"),
        "3:90",
        "expected a twist, found '9 deg'",
        "for example twist: {angle: 10 deg}",
    ),
    "a number for an empty zone": Mistake(
        a_sequence(f"{ONE_LEVEL}, empty-zones: 3"),
        "3:96",
        "expected an empty zone, found 3",
        "for example - {radius: 1, at: [0, 0, 2]}",
    ),
    "a zone without a radius": Mistake(
        a_sequence(f"{ONE_LEVEL}, empty-zones: {{at: [0, 0, 1]}}"),
        "3:96",
        "an empty zone needs the key 'radius'",
        "for example - {radius: 1, at: [0, 0, 2]}",
    ),
    "a kernel at": Mistake(
        a_sequence(f"kernel: {{ball: {{radius: 0.1}}, at: [0, 0, 1]}}, {A_LEVEL}"),
        "3:41",
        "unknown key 'at'",
        "'at' belongs inside the ball or leaf: write 'ball: {radius: 0.1, at: [0, 0, 1]}'",
    ),
    "a kernel with a color": Mistake(
        a_sequence(f"kernel: {{ball: {{radius: 0.1}}, color: red}}, {A_LEVEL}"),
        "3:41",
        "unknown key 'color'",
        "write 'material: {color: ...}'",
    ),
    "two kernels in one": Mistake(
        a_sequence(f"kernel: {{ball: {{radius: 0.1}}, half-space: {{}}}}, {A_LEVEL}"),
        "3:41",
        "a kernel has only one of 'ball' and 'half-space'",
        "",
    ),
    "a leaf that is too thick": Mistake(
        a_sequence(f"kernel: {{leaf: {{radius: 0.1, thickness: 0.3}}}}, {A_LEVEL}"),
        "3:51",
        "a leaf is at most twice as thick as its radius, 0.1",
        "write at most 0.2",
        False,
    ),
    "an arc without length": Mistake(
        a_sequence(
            f"kernel: {{arc: {{from: [0, 0, 0], through: [0, 1, 1], to: [0, 0, 0], radius: 0.1}}}}, {A_LEVEL}"
        ),
        "3:67",
        "an arc does not end where it begins",
        "write 'ball' for a ball",
        False,
    ),
    "an arc through a point beyond its ends": Mistake(
        a_sequence(
            f"kernel: {{arc: {{from: [0, 0, 0], through: [0, 0, 2], to: [0, 0, 1], radius: 0.1}}}}, {A_LEVEL}"
        ),
        "3:52",
        "no arc leads through a point on the line of its ends that is not between them",
        "choose a point beside that line, or between the ends",
        False,
    ),
    "a mirror with a negative width": Mistake(
        a_sequence("kernel: {ball: {radius: 0.1}}, levels: [{mirror: {normal: [1, 0, 0], smooth: -1}}]"),
        "3:88",
        "smooth must be at least 0; this is -1",
    ),
    "a Moebius level with a negative width": Mistake(
        a_sequence("kernel: {ball: {radius: 0.1}}, moebius: [{map: [{move: [1, 0, 0]}], smooth: -1}]"),
        "3:87",
        "smooth must be at least 0; this is -1",
    ),
    "a level without a mirror": Mistake(
        a_sequence("kernel: {ball: {radius: 0.1}}, levels: [{}]"),
        "3:51",
        "a level needs the key 'mirror'",
        "for example - {mirror: {normal: [1, 0, 0.3], offset: 0.5}, kernel: {ball: {radius: 0.1}}}",
    ),
    "a Moebius level without a map": Mistake(
        a_sequence("kernel: {ball: {radius: 0.1}}, moebius: [{}]"),
        "3:52",
        "a level needs the key 'map'",
        "for example - {map: [{bend: [0.1, 0, 0]}, {move: [-1, 0, 0]}], kernel: {ball: {radius: 0.1}}}",
    ),
    "a map of two steps in one": Mistake(
        a_sequence("kernel: {ball: {radius: 0.1}}, moebius: [{map: [{move: [1, 0, 0], scale: 2}]}]"),
        "3:77",
        "a step of a map has only one of 'move' and 'scale'",
        "",
    ),
    "a number for a record": Mistake(
        a_sequence("record: 3"),
        "3:19",
        "expected a mapping, found 3",
        "for example record: {mirrors: ",
    ),
    "too few materials": Mistake(
        a_sequence(
            "record: {mirrors: [{u: [1, 0, 0], w: 1}], "
            "kernels: [{type: sphere, c: [0, 0, 0], r: 1, mat: 2}, {type: empty}]}, made-of: [{color: red}]"
        ),
        "3:133",
        "kernels have mat 0 to 2, and made-of lists 1 material",
        "list 3",
        False,
    ),
    "a forest of too many mirrors": Mistake(
        a_sequence("forest: {levels: 20, doublings: 24}"),
        "3:43",
        "levels, leaves and doublings make 46 mirrors together; at most 40 are possible",
        "take 6 off 'doublings'",
        False,
    ),
    "a shrub of too many mirrors": Mistake(
        a_sequence("shrub: {levels: 30, stems: 8, leaves: 8}"),
        "3:27",
        "stems, levels and leaves make 45 mirrors together; at most 40 are possible",
        "take 5 off 'levels'",
        False,
    ),
    "a tree of levels beyond 30": Mistake(
        a_sequence("tree: {levels: 31}"), "3:26", "levels must be at most 30; this is 31", ""
    ),
    "a tree without an angle's unit": Mistake(
        a_sequence("tree: {spread: 27}"), "3:26", "an angle needs a unit: write '27 deg'", ""
    ),
    "a tree that spreads too far": Mistake(
        a_sequence("tree: {spread: 61 deg}"),
        "3:26",
        "expected an angle from 5 to 60 deg; this is 61 deg",
        "",
        False,
    ),
    "stems that lie down": Mistake(
        a_sequence("shrub: {outwards: 71 deg}"),
        "3:29",
        "expected an angle from 0 to 70 deg; this is 71 deg",
        "",
        False,
    ),
    "a forest that rolls": Mistake(
        a_sequence("forest: {roll: 6 deg}"),
        "3:26",
        "expected an angle from 0 to 5 deg; this is 6 deg",
        "",
        False,
    ),
    "a terrain steeper than its steepest": Mistake(
        a_sequence("terrain: {slope: 50 deg}"),
        "3:28",
        "the slope is 50 deg, and the steepest one has to be steeper",
        "write more than 50 deg for 'steepest'",
        False,
    ),
    "a terrain of ripples": Mistake(
        a_sequence("terrain: {levels: 6, ripples: 6}"),
        "3:41",
        "of 6 levels at most 5 make ripples",
        "write 'ripples: 5' or 'levels: 7'",
        False,
    ),
    "a terrain that leans": Mistake(
        a_sequence("terrain: {roughness: 16 deg}"),
        "3:32",
        "expected an angle from 0 to 15 deg; this is 16 deg",
        "",
        False,
    ),
    "a form of a terrain": Mistake(
        a_sequence("terrain: {form: sea}"),
        "3:27",
        "'sea' is not one of: land, seabed",
        "did you mean 'seabed'?",
    ),
    "a sponge of layers": Mistake(
        a_sequence("sponge: {levels: 9, layers: 4}"),
        "3:39",
        "of 9 levels at most 2 fold the skin; these are 4",
        "write 'layers: 2' or 'levels: 11'",
        False,
    ),
    "a rock of 5 levels": Mistake(
        a_sequence("rock: {levels: 5}"), "3:26", "levels must be at least 6; this is 5", ""
    ),
    "a rock too rough": Mistake(
        a_sequence("rock: {roughness: 3}"), "3:29", "roughness must be at most 2; this is 3", ""
    ),
    "fish too near": Mistake(
        a_sequence("fish-school: {stagger: 1}"), "3:34", "stagger must be at least 2; this is 1", ""
    ),
    "fish askew": Mistake(
        a_sequence("fish-school: {askew: 16 deg}"),
        "3:32",
        "expected an angle from 0 to 15 deg; this is 16 deg",
        "",
        False,
    ),
    "a frond of 13 doublings": Mistake(
        a_sequence("palm-leaf: {doublings: 13}"), "3:34", "doublings must be at most 12; this is 13", ""
    ),
    "leaflets that are too long": Mistake(
        a_sequence("palm-leaf: {leaflets: 1.5}"), "3:33", "leaflets must be at most 1; this is 1.5", ""
    ),
    "level balls of a tree": Mistake(
        a_sequence("tree: {}, level-balls: false"),
        "3:21",
        "only Moebius sequences have balls that hold their levels",
        "leave it out",
        False,
    ),
    "relaxed with empty zones": Mistake(
        a_sequence(f"empty-zones: {{radius: 1}}, {ONE_LEVEL}") + "render: {tracer: relaxed}\n",
        "4:10",
        "tracer: relaxed needs distances all around; with empty zones it holds along the ray",
        "leave it out, or write 'tracer: direct'",
        False,
    ),
    **{
        f"a record with {name}": Mistake(
            a_sequence(f"record: {{{text}}}"),
            "3:19",
            f"this record makes no sense: {message}",
            "for example record: {mirrors: ",
            False,
        )
        for name, text, message in (
            ("nothing", "", "a record of a sequence has 'mirrors' or 'G', and 'kernels'"),
            ("a key", "mirrors: [], kernels: [], smoth: [1]", "unknown key 'smoth'"),
            (
                "no kernels",
                "mirrors: [], kernels: []",
                "0 mirrors and 0 kernels; expected one kernel more than mirrors",
            ),
            ("no list", "mirrors: 3, kernels: []", "mirrors is 3; expected a list"),
            ("a number for a kernel", "mirrors: [], kernels: [3]", "kernel 0 is 3; expected a mapping"),
            (
                "a list for a type",
                "mirrors: [], kernels: [{type: [sphere]}]",
                "kernel 0 has type ['sphere']; expected one of: empty, sphere, plane, capsule, torcap, lens",
            ),
            (
                "a type",
                "mirrors: [], kernels: [{type: ball, c: [0, 0, 0], r: 1}]",
                "kernel 0 has type 'ball'; expected one of: empty, sphere, plane, capsule, torcap, lens",
            ),
            (
                "mat",
                "mirrors: [], kernels: [{type: sphere, c: [0, 0, 0], r: 1, mat: x}]",
                "kernel 0 has mat 'x'; expected a whole number from 0",
            ),
            (
                "mat in a curved space",
                "space: H3, mirrors: [], kernels: [{type: sphere, c: [1, 0, 0, 0], r: 1, mat: -1}]",
                "kernel 0 has mat -1; expected a whole number from 0",
            ),
            ("no center", "mirrors: [], kernels: [{type: sphere, r: 1}]", "kernel 0, a sphere, has no 'c'"),
            (
                "two coordinates",
                "mirrors: [], kernels: [{type: sphere, c: [0, 0], r: 1}]",
                "c of kernel 0 is [0, 0]; expected 3 finite numbers",
            ),
            (
                "a radius below 0",
                "mirrors: [], kernels: [{type: sphere, c: [0, 0, 0], r: -1}]",
                "r of kernel 0 is -1; expected a number greater than 0",
            ),
            (
                "a radius in quotes",
                "mirrors: [], kernels: [{type: sphere, c: [0, 0, 0], r: '1'}]",
                "r of kernel 0 is '1'; expected a finite number",
            ),
            (
                "an arc without length",
                "mirrors: [], kernels: [{type: torcap, p: [0, 0, 0], q: [0, 0, 0], m: [0, 0, 1], r: 1}]",
                "kernel 0, a torcap, begins where it ends; make it a sphere",
            ),
            (
                "an arc beyond its ends",
                "mirrors: [], kernels: [{type: torcap, p: [0, 0, 0], q: [0, 0, 1], m: [0, 0, 2], r: 1}]",
                "m of kernel 0 is on the line through p and q, and not between them",
            ),
            (
                "a leaf without an axis",
                "mirrors: [], kernels: [{type: lens, c: [0, 0, 0], a: [0, 0, 0], b: 1, h: 1}]",
                "a of kernel 0 is the zero vector; expected a direction",
            ),
            (
                "a thick leaf",
                "mirrors: [], kernels: [{type: lens, c: [0, 0, 0], a: [0, 0, 1], b: 1, h: 2}]",
                "h of kernel 0, half the thickness, is 2, more than the rim radius b, 1",
            ),
            (
                "no normal",
                f"mirrors: [{{w: 1}}], kernels: [{BALL_KERNEL}, {BALL_KERNEL}]",
                "mirror 0 has no 'u'",
            ),
            (
                "a zero normal",
                f"mirrors: [{{u: [0, 0, 0], w: 1}}], kernels: [{BALL_KERNEL}, {BALL_KERNEL}]",
                "u of mirror 0 is the zero vector; expected a direction",
            ),
            (
                "widths",
                f"mirrors: [{{u: [1, 0, 0], w: 1}}], smooth: [1, 1], kernels: [{BALL_KERNEL}, {BALL_KERNEL}]",
                "smooth has 2 widths for 1 levels; expected one for each",
            ),
            (
                "a negative width",
                f"mirrors: [{{u: [1, 0, 0], w: 1}}], smooth: [-1], kernels: [{BALL_KERNEL}, {BALL_KERNEL}]",
                "smooth has a negative width; expected numbers from 0",
            ),
            (
                "a kernel too few",
                f"mirrors: [{{u: [1, 0, 0], w: 1}}], kernels: [{BALL_KERNEL}]",
                "1 mirrors and 1 kernels; expected one kernel more than mirrors",
            ),
            (
                "only empty kernels",
                "mirrors: [], kernels: [{type: empty}]",
                "all kernels are empty: there is nothing to see",
            ),
            (
                "a matrix",
                f"G: [[[1, 2], [3]]], kernels: [{{type: empty}}, {BALL_KERNEL}]",
                "G of level 0: expected a 2 x 2 matrix of quaternions of four finite numbers",
            ),
            (
                "a map that leaves space",
                "G: [[[[1, 0, 0, 0], [1, 0, 0, 0]], [[0, 0, 0, 0], [1, 0, 0, 0]]]], "
                f"kernels: [{{type: empty}}, {BALL_KERNEL}]",
                "G of level 0: this Moebius map does not keep R^3: Re(a c*), Re(b d*) or Im(",
            ),
            (
                "a plane that is bent",
                "G: [], kernels: [{type: plane, n: [0, 0, 1], h: 0}]",
                "a plane among the kernels of a Moebius sequence; expected bounded ones",
            ),
            (
                "no space",
                "space: S9, mirrors: [], kernels: []",
                "space is 'S9'; expected one of: S3, H3, S2xE, H2xE",
            ),
        )
    },
    "a record of another space": Mistake(
        a_sequence("record: {space: S3, mirrors: [], kernels: [{type: sphere, c: [1, 0, 0, 0], r: 1}]}"),
        "3:11",
        "this record is of s3, and the scene of e3",
        "write 'levels'",
        False,
    ),
    **{
        f"a kernel by the name {word}": Mistake(
            a_sequence(f"kernel: {{{word}: {{}}}}, levels: [{{mirror: {{normal: [1, 0, 0]}}}}]"),
            "3:20",
            f"unknown key '{word}'",
            f"did you mean '{meant}'?",
        )
        for word, meant in (
            ("sphere", "ball"),
            ("plane", "half-space"),
            ("lens", "leaf"),
            ("torcap", "arc"),
            ("torus", "arc"),
            ("branch", "arc"),
            ("cylinder", "capsule"),
        )
    },
    **{
        f"{key} of a {recipe}": Mistake(
            a_sequence(f"{recipe}: {{{key}: 1}}"), f"3:{14 + len(recipe)}", f"unknown key '{key}'", help
        )
        for recipe, helps in WORDS_OF_RECIPES.items()
        for key, help in helps.items()
    },
    # Params
    "unknown param": Mistake(
        an_object("ball: {radius: $rr}") + "params: {r: 1}\n",
        "3:20",
        "unknown name '$rr'",
        "did you mean '$r'?",
        schema=False,
    ),
    "param without params": Mistake(
        an_object("ball: {radius: $r}"), "3:20", "unknown name '$r'", "add 'params: {r: ...}'", schema=False
    ),
    "unused param": Mistake(
        f"{E3}params: {{r: 1}}\n", "3:10", "the param 'r' is not used", "write $r", schema=False
    ),
    "param of the wrong kind": Mistake(
        an_object("ball: {radius: $r}") + "params: {r: big}\n",
        "3:20",
        "expected a number, found 'big' (here $r is big)",
        schema=False,
    ),
    "list for a param": Mistake(
        an_object("ball: {radius: $r}") + "params: {r: [1]}\n",
        "4:13",
        "a param is one number or one text, found a list",
    ),
    "param of a param": Mistake(
        an_object("{ball: {radius: $r}, name: $q}") + "params: {r: 1, q: $r}\n",
        "4:19",
        "a param cannot refer to another param",
    ),
    "name of a param": Mistake(
        f"{E3}params: {{a-b: 1}}\n", "3:10", "'a-b' cannot be a name", "letters, digits or _"
    ),
    # Manifolds
    "misspelt manifold": Mistake(
        f"{H3}manifold: seifert-wber\n",
        "3:11",
        "h3 has no manifold",
        "did you mean 'seifert-weber'?",
        schema=False,
    ),
    "manifold of another geometry": Mistake(
        f"{H3}manifold: poincare\n",
        "3:11",
        "h3 has no manifold 'poincare'",
        "has the geometry s3",
        schema=False,
    ),
    "manifold of another geometry, in other letters": Mistake(
        f"{H3}manifold: Hopf Manifold\n",
        "3:11",
        "h3 has no manifold 'Hopf Manifold'",
        "'Hopf Manifold' has the geometry s2xe",
        schema=False,
    ),
    "vertices of a cell that has none": Mistake(
        "geometry: s2xe\nmanifold: hopf-manifold\nobjects: [tile: {ball: 1, vertices: 0.1}]\n",
        "3:27",
        "the cell of this manifold has no vertices",
        "leave it out",
        schema=False,
    ),
    "edges of a cell that has none": Mistake(
        "geometry: s2xe\nmanifold: hopf-manifold\nobjects: [tile: {ball: 1, edges: 0.1}]\n",
        "3:27",
        "the cell of this manifold has no edges",
        "leave it out",
        schema=False,
    ),
    "number for a manifold": Mistake(
        f"{H3}manifold: 3\n", "3:11", "expected the name of a manifold, found 3"
    ),
    "four rows where five are needed": Mistake(
        f"geometry: h2xe\n{BALL}manifold: {{generators: [{SHIFT}], domain: [[0, 0, 0, 1, -1]]}}\n",
        "3:25",
        "expected a matrix of 5 rows with 5 numbers each, found 4 rows",
        "isometries of h2xe act on columns [x, y, z, w, 1]",
        schema=False,
    ),
    "wall of four numbers where five are needed": Mistake(
        f"geometry: sl2\n{BALL}manifold: {{generators: [{FIVE}], domain: [[0, 0, 0, 1]]}}\n",
        "3:123",
        "expected 5 numbers [x, y, z, w, 1], found 4",
        schema=False,
    ),
    "five rows where four are needed": Mistake(
        f"geometry: nil\n{BALL}manifold: {{generators: [{FIVE}], domain: [[0, 0, 1, -1]]}}\n",
        "3:25",
        "expected a matrix of 4 rows with 4 numbers each, found 5 rows",
        schema=False,
    ),
    "no isometry": Mistake(
        by_matrices(
            f"[{SHIFT}, {BACK.replace('[0, 1, 0, 0]', '[0, 2, 0, 0]')}]",
            "[[1, 0, 0, -0.5], [-1, 0, 0, -0.5]]",
        ),
        "4:75",
        "generator 2 is not an isometry of e3",
        schema=False,
    ),
    "wall that does not fit": Mistake(
        by_matrices(f"[{SHIFT}, {BACK}]", "[[1, 0, 0, -0.5], [-1, 0, 0, -0.6]]"),
        "5:12",
        "half-space 1",
        schema=False,
    ),
    "walls and generators": Mistake(
        by_matrices(f"[{SHIFT}, {BACK}]", "[[1, 0, 0, -0.5]]"),
        "5:11",
        "2 generators for 1 walls",
        schema=False,
    ),
    "three rows": Mistake(
        by_matrices("[[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]]", "[[1, 0, 0, -0.5]]"),
        "4:16",
        "expected a matrix of 4 rows with 4 numbers each, found 3 rows",
    ),
    "three numbers in a row": Mistake(
        by_matrices("[[[1, 0, 0, 0], [0, 1, 0], [0, 0, 1, 0], [0, 0, 0, 1]]]", "[[1, 0, 0, -0.5]]"),
        "4:31",
        "expected 4 numbers [x, y, z, w], found 3",
    ),
    # A word alone, where a mapping belongs
    "word for a projection": Mistake(
        f"{E3}camera: {{projection: fisheye}}\n",
        "3:22",
        "expected a projection, found 'fisheye'",
        "write 'projection: {fisheye: {angle: 180 deg}}'",
    ),
    "word for a projection without keys": Mistake(
        f"{E3}camera: {{projection: perspective}}\n",
        "3:22",
        "expected a projection, found 'perspective'",
        "write 'projection: {perspective: {}}'",
    ),
    "other word for a projection": Mistake(
        f"{E3}camera: {{projection: panorama}}\n",
        "3:22",
        "expected a projection, found 'panorama'",
        "did you mean 'equirectangular'?",
    ),
    "word for fog": Mistake(
        f"{E3}effects: {{fog: linear}}\n",
        "3:16",
        "expected fog, found 'linear'",
        "write 'fog: {linear: {length: 12}}'",
    ),
    "word for a step": Mistake(
        f"{E3}camera: {{move: [forward]}}\n", "3:17", "expected a step, found 'forward'", "'- forward: ...'"
    ),
    "word for a shape in a shape": Mistake(
        an_object("union: [ball]"), "3:13", "expected a shape, found 'ball'", "write '{ball: {radius: 0.4}}'"
    ),
    "word for an object": Mistake(
        an_object("ball"), "3:5", "expected an object, found 'ball'", "write '- ball: {radius: 0.4}'"
    ),
    "word for a texture": Mistake(
        f"{E3}textures: {{e: checker}}\n",
        "3:15",
        "expected a pattern, found 'checker'",
        "write '{checker: {count: 8, colors: [white, black]}}'",
    ),
    "picture for a texture": Mistake(
        f"{E3}textures: {{e: earth}}\n", "3:15", "expected a pattern, found 'earth'", "write '{image: earth}'"
    ),
    "file for a texture": Mistake(
        f"{E3}textures: {{e: my/photo.JPG}}\n",
        "3:15",
        "expected a pattern, found 'my/photo.JPG'",
        "write '{image: my/photo.JPG}'",
    ),
    "pattern for a color": Mistake(
        an_object("{ball: {radius: 1}, material: {color: checker}}"),
        "3:43",
        "'checker' is not a color",
        "write 'color: {checker: {count: 8, colors: [white, black]}}'",
    ),
    "picture for a color": Mistake(
        an_object("{ball: {radius: 1}, material: {color: earth}}"),
        "3:43",
        "'earth' is not a color",
        "write 'color: {image: earth}'",
    ),
    "file for a color": Mistake(
        an_object("{ball: {radius: 1}, material: {color: earth.png}}"),
        "3:43",
        "'earth.png' is not a color",
        "write 'color: {image: earth.png}'",
    ),
    "texture without its dollar": Mistake(
        f"{E3}textures: {{e: {{image: earth}}}}\nmaterials: {{m: {{color: textures.e}}}}\n",
        "4:24",
        "'textures.e' is not a color",
        "did you mean '$textures.e'?",
    ),
    "bare name of a texture": Mistake(
        f"{E3}textures: {{globe: {{image: earth}}}}\nmaterials: {{m: {{color: globe}}}}\n",
        "4:24",
        "'globe' is not a color",
        "did you mean '$textures.globe'?",
    ),
    "texture as a param": Mistake(
        f"{E3}textures: {{globe: {{image: earth}}}}\nmaterials: {{m: {{color: $globe}}}}\n",
        "4:24",
        "unknown name '$globe'",
        "a texture goes by '$textures.globe'",
        schema=False,
    ),
    "material as a param": Mistake(
        f"{E3}materials: {{gold: {{color: gold}}}}\n".replace("}}]", "}, material: $gold}]"),
        "2:41",
        "unknown name '$gold'",
        "a material goes by its bare name: gold",
        schema=False,
    ),
    "word for stereo": Mistake(
        f"{E3}camera: {{stereo: anaglyph}}\n",
        "3:18",
        "expected stereo, found 'anaglyph'",
        "write 'stereo: {layout: anaglyph}'",
    ),
    # Words of other programs
    **{
        f"{key} of a point light": Mistake(
            f"{E3}lights: [point: {{at: [0, 0, 1], {key}: 1}}]\n",
            "3:33",
            f"unknown key '{key}'",
            "write 'ball: 0.1', the radius of a ball that shows where the light stands",
        )
        for key in ("radius", "size", "visible", "show")
    },
    "softness of shadows": Mistake(
        f"{E3}lights: [{{sun: {{}}, shadows: {{softness: 1}}}}]\n",
        "3:30",
        "unknown key 'softness'",
        "write 'soft: {sharpness: 5}'; larger is harder",
    ),
    "softness of soft shadows": Mistake(
        f"{E3}lights: [{{sun: {{}}, shadows: {{soft: {{softness: 1}}}}}}]\n",
        "3:37",
        "unknown key 'softness'",
        "write 'soft: {sharpness: 5}'; larger is harder",
    ),
    "shadows: true": Mistake(
        f"{E3}lights: [{{sun: {{}}, shadows: true}}]\n",
        "3:29",
        "expected hard or soft, found true",
        "write 'shadows: hard' or 'shadows: soft'",
    ),
    **{
        f"effect {key}": Mistake(
            f"{E3}effects: {{{key}: {{}}}}\n", "3:11", f"unknown key '{key}'", f"did you mean '{meant}'?"
        )
        for key, meant in (
            ("ao", "ambient-occlusion"),
            ("occlusion", "ambient-occlusion"),
            ("mirrors", "reflections"),
            ("reflection", "reflections"),
        )
    },
    **{
        f"{key} of a scene": Mistake(
            f"{E3}{key}: white\n", "3:1", f"unknown key '{key}'", "did you mean 'background'?"
        )
        for key in ("environment",)
    },
    **{
        f"{key} of linear fog": Mistake(
            f"{E3}effects: {{fog: {{linear: {{length: 3, {key}: 1}}}}}}\n",
            "3:37",
            f"unknown key '{key}'",
            "length",
        )
        for key in ("start", "end", "far")
    },
    **{
        f"{key} of stereo": Mistake(
            f"{E3}camera: {{stereo: {{layout: anaglyph, {key}: 0.1}}}}\n",
            "3:37",
            f"unknown key '{key}'",
            "did you mean 'distance'?",
        )
        for key in ("eyes", "ipd", "separation")
    },
    **{
        f"{key} of an image": Mistake(
            f"{E3}textures: {{e: {{image: {{file: earth, {key}: 2}}}}}}\n",
            "3:37",
            f"unknown key '{key}'",
            "write 'size: [w, h]', which is that of one image",
        )
        for key in ("scale", "repeat")
    },
    **{
        f"size of a {pattern}": Mistake(
            f"{E3}textures: {{e: {{{pattern}: {{size: 2}}}}}}\n",
            f"3:{26 - 3 * (pattern == 'grid')}",
            "unknown key 'size'",
            "did you mean 'count'?",
        )
        for pattern in ("checker", "grid")
    },
    "texture of a material": Mistake(
        an_object("{ball: {radius: 1}, material: {texture: earth.png}}"),
        "3:36",
        "unknown key 'texture'",
        "write 'color: {image: earth.png}'",
    ),
    "texture of an object": Mistake(
        an_object("{ball: {radius: 1}, texture: earth.png}"),
        "3:25",
        "unknown key 'texture'",
        "write 'material: {color: {image: earth.png}}'",
    ),
    **{
        f"layout {layout}": Mistake(
            f"{E3}camera: {{stereo: {{layout: {layout}}}}}\n",
            "3:27",
            f"'{layout}' is not one of: side-by-side, top-bottom, anaglyph",
            f"did you mean '{meant}'?",
        )
        for layout, meant in (("sbs", "side-by-side"), ("over-under", "top-bottom"), ("red-cyan", "anaglyph"))
    },
    # Values with what does not belong to them
    "exposure with a unit": Mistake(
        f"{E3}outputs: [{{file: x.png, exposure: 1 stop}}]\n",
        "3:35",
        "expected a number, found '1 stop'",
        "write 1",
    ),
    "percent": Mistake(
        an_object("{ball: {radius: 1}, material: {specular: 12.5%}}"),
        "3:46",
        "expected a number, found '12.5%'",
        "write 0.125",
    ),
    "broken number of geodesics": Mistake(
        f"{SOL}lights: [point: {{at: [0, 0, 1], geodesics: 8.5}}]\n",
        "3:44",
        "expected a whole number, found 8.5",
        "for a greatest length write 'geodesics: {within: 8.5}'",
    ),
    "size in one word": Mistake(
        f"{E3}render: {{size: 800x600}}\n",
        "3:16",
        "expected 2 numbers [width, height], found '800x600'",
        "write [800, 600]",
    ),
    "point without brackets": Mistake(
        f"{E3}camera: {{look: {{up: 0 0 -1}}}}\n",
        "3:21",
        "expected 3 numbers [x, y, z], found '0 0 -1'",
        "write [0, 0, -1]",
    ),
    "all translates": Mistake(
        f"{E3}manifold: three-torus\nlights: [point: {{at: [0, 0, 0], translates: all}}]\n",
        "4:45",
        "expected a whole number, 'cell' or 'neighbours', found 'all'",
        "those in the cells around it are 'neighbours'",
    ),
    "ambient alone": Mistake(
        an_object("{ball: {radius: 1}, material: {ambient: 0.9}}"),
        "3:45",
        "ambient and specular add up to 1.1, which is more than 1",
        "specular is 0.2 unless you say so: write 'specular: 0'",
        schema=False,
    ),
    "specular alone": Mistake(
        an_object("{ball: {radius: 1}, material: {specular: 1}}"),
        "3:46",
        "ambient and specular add up to 1.1, which is more than 1",
        "ambient is 0.1 unless you say so: write 'ambient: 0'",
        schema=False,
    ),
    "reflectivity of a named material without reflections": Mistake(
        "geometry: e3\nobjects:\n  - {ball: {radius: 1}, material: mirror}\n"
        "materials:\n  dull: {}\n  mirror: {reflectivity: 0.5}\n",
        "6:12",
        "a material with reflectivity needs reflections, which this scene does not call for",
        "add 'effects: {reflections: {depth: 1}}'",
        schema=False,
    ),
}


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft7Validator:
    return jsonschema.Draft7Validator(scene_schema())


@pytest.mark.parametrize("name", MISTAKES)
def test_mistake(name: str, validator: jsonschema.Draft7Validator) -> None:
    mistake = MISTAKES[name]
    with pytest.raises(SceneReport) as caught:
        load_text(mistake.text, "scene.yaml")
    assert len(caught.value.diagnostics) == 1, str(caught.value)
    found = caught.value.diagnostics[0]
    assert mistake.message in found.message
    assert mistake.help in (found.help or "")
    assert f"{found.line}:{found.column}" == mistake.at
    assert str(caught.value).startswith(f"scene.yaml:{mistake.at}: error: {found.message}\n")
    assert str(caught.value).endswith("\n1 error in scene.yaml")
    assert validator.is_valid(parse(mistake.text).data) is not mistake.schema


def test_a_color_function_without_quotes_says_why_its_commas_are_keys() -> None:
    with pytest.raises(SceneReport) as caught:
        load_text(f"{E3}materials: {{a: {{color: rgb(255, 128, 3)}}}}\n")
    first, *rest = caught.value.diagnostics
    assert first.message == "'rgb(255' is not a color"
    assert [found.message for found in rest] == ["unknown key '128'", "unknown key '3)'"]
    assert all("Put quotes around a text that has commas" in (found.help or "") for found in rest)


def test_many_mistakes_are_counted_and_cut() -> None:
    text = "geometry: e3\nobjects:\n" + "  - ball: {radius: 0}\n" * 150
    with pytest.raises(SceneReport) as caught:
        load_text(text, "scene.yaml")
    assert len(caught.value.diagnostics) == 150
    assert str(caught.value).count(": error: ") == 100
    assert str(caught.value).endswith("150 errors in scene.yaml (the first 100 are shown)")


def test_caret_below_wide_characters_and_tabs() -> None:
    with pytest.raises(SceneReport) as caught:
        load_text('geometry: e3\nobjects: [{name: "漢字",\tball: {radius: x}}]\n', "scene.yaml")
    line, caret = str(caught.value).split("\n")[1:3]
    # Each of the two characters covers two cells of a terminal, and the tab stays a tab.
    column = line.index("x}")
    assert (
        caret
        == "      | "
        + " " * (line.index("漢") - 8)
        + "    "
        + "  \t"
        + " " * (column - line.index("\t") - 1)
        + "^"
    )


def test_long_lines_are_cut_around_the_caret() -> None:
    items = ", ".join(f"{{ball: {{radius: {'x' if k == 50 else 1}}}}}" for k in range(100))
    with pytest.raises(SceneReport) as caught:
        load_text(f"geometry: e3\nobjects: [{items}]\n", "scene.yaml")
    line, caret = str(caught.value).split("\n")[1:3]
    assert len(line) < 130
    assert line[caret.index("^")] == "x"


def test_terminal_commands_are_not_passed_on() -> None:
    with pytest.raises(SceneReport) as caught:
        load_text("geometry: e3\ntitle: \x1b[31mred\n", "scene.yaml")
    assert "scene.yaml:2:8: error: the character U+001B may not stand here" in str(caught.value)
    assert "\x1b" not in str(caught.value)
