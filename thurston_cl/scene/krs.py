"""Kernel-reflection sequences as scenes write them: level by level, as Moebius sequences, or by a recipe."""

import json
import warnings
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, PlainValidator, ValidationInfo, WithJsonSchema

from thurston_cl.krs.kernels import kernel_of
from thurston_cl.krs.record import sequence_of
from thurston_cl.krs.sequence import MOST_LEVELS
from thurston_cl.models import ISOTROPIC, PRODUCTS

from .base import Node, Problem, problem, shown
from .context import Context, context_of
from .krs_curved import HyperbolicForest
from .krs_grounds import FishSchool, PalmLeaf, Rock, Sponge, Terrain
from .krs_plants import Coral, Forest, Meadow, Shrub, Tree
from .krs_recipe import Recipe
from .parse import Location
from .points import Point
from .surfaces import Material, MaterialValue, OptionalMaterial
from .values import Angle, AtLeast, Direction, Flag, NotNegative, Number, OneOrMore, Positive, Says, Vec3

# Geometries with mirrors: totally geodesic planes across every direction, or across and along the fiber.
MIRRORED = (*ISOTROPIC, *PRODUCTS)


# What is made elsewhere, by the geometry it is asked for in: what to write instead.
_CURES: dict[tuple[str, str | None], str] = {
    **dict.fromkeys((("tree", "h3"), ("forest", "h3")), "write 'hyperbolic-forest'"),
    ("hyperbolic-forest", "e3"): "write 'forest'",
}


def _painted_beside(key: str) -> dict[str, str]:
    """What is said of a color or a material inside a shape."""
    return dict.fromkeys(("color", "material"), f"write 'material: {{color: ...}}' beside '{key}'")


class KernelBall(Node):
    """A ball as a kernel."""

    what = "a ball"
    example = "ball: {radius: 0.1, at: [0, 0, 1]}"
    hints: ClassVar[Mapping[str, str]] = _painted_beside("ball")

    radius: Positive = Field(description="Its radius.")
    at: Point = Field(default=(0.0, 0.0, 0.0), description="Its center.")


class KernelHalfSpace(Node):
    """A half-space as a kernel."""

    what = "a half-space"
    example = "half-space: {normal: [0, 0, 1], offset: 0}"
    hints: ClassVar[Mapping[str, str]] = _painted_beside("half-space")

    normal: Direction = Field(default=(0, 0, 1), description="Points out of it.")
    offset: Number = Field(default=0.0, description="How far along the normal the plane stands.")


class KernelCapsule(Node):
    """All points within a distance of a geodesic segment; in s2xe and h2xe of a vertical one."""

    what = "a capsule"
    example = "capsule: {from: [0, 0, 0], to: [0, 0, 1], radius: 0.1}"
    hints: ClassVar[Mapping[str, str]] = _painted_beside("capsule")

    start: Point = Field(alias="from", description="One end of the segment.")
    to: Point = Field(description="The other end.")
    radius: Positive = Field(description="The distance.")

    def check(self, context: Context) -> Iterator[Problem]:
        if self.start == self.to:
            yield Problem(("to",), "a capsule does not end where it begins", "write 'ball' for a ball")
        if context.geometry in PRODUCTS and isinstance(self.start, tuple) and isinstance(self.to, tuple):
            (x, y, _), (*beside, z) = self.start, self.to
            if beside != [x, y]:
                message = f"in {context.geometry} the capsules of a sequence stand along the fiber"
                yield Problem(("to",), message, f"write [{x:g}, {y:g}, {z:g}], over its other end")


class KernelArc(Node):
    """All points within a distance of an arc of a circle: a bent branch. In e3."""

    what = "an arc"
    example = "arc: {from: [0, 0, 0], through: [0.1, 0, 0.5], to: [0, 0, 1], radius: 0.1}"
    hints: ClassVar[Mapping[str, str]] = _painted_beside("arc")

    start: Vec3 = Field(alias="from", description="One end of the arc.")
    through: Vec3 = Field(description="A point of it between the ends; on their straight line: no bend.")
    to: Vec3 = Field(description="The other end.")
    radius: Positive = Field(description="The distance.")

    def check(self, context: Context) -> Iterator[Problem]:
        if self.start == self.to:
            yield Problem(("to",), "an arc does not end where it begins", "write 'ball' for a ball")
            return
        try:
            kernel_of({"type": "torcap", "p": self.start, "q": self.to, "m": self.through, "r": 1}, "arc")
        except ValueError:
            message = "no arc leads through a point on the line of its ends that is not between them"
            yield Problem(("through",), message, "choose a point beside that line, or between the ends")


class KernelLeaf(Node):
    """A lens-shaped leaf: what two equal balls have in common. In e3."""

    what = "a leaf"
    example = "leaf: {radius: 0.1, thickness: 0.03, across: [0, 0, 1]}"
    hints: ClassVar[Mapping[str, str]] = _painted_beside("leaf")

    radius: Positive = Field(description="Radius of its rim.")
    thickness: Positive = Field(description="How thick it is in the middle; at most twice the radius.")
    across: Direction = Field(default=(0, 0, 1), description="The direction across it.")
    at: Vec3 = Field(default=(0.0, 0.0, 0.0), description="Its middle.")

    def check(self, context: Context) -> Iterator[Problem]:
        if self.thickness > 2 * self.radius:
            message = f"a leaf is at most twice as thick as its radius, {shown(self.radius)}"
            yield Problem(("thickness",), message, f"write at most {shown(2 * self.radius)}")


class Kernel(Node):
    """One kernel: the piece of geometry that a level adds."""

    what = "a kernel"
    example = "kernel: {ball: {radius: 0.1}}"
    one_of = ("ball", "half-space", "capsule", "arc", "leaf")
    hints: ClassVar[Mapping[str, str]] = {
        "sphere": "did you mean 'ball'?",
        "plane": "did you mean 'half-space'?",
        "lens": "did you mean 'leaf'?",
        **dict.fromkeys(("torcap", "torus", "branch"), "did you mean 'arc'?"),
        "cylinder": "did you mean 'capsule'?",
        "at": "'at' belongs inside the ball or leaf: write 'ball: {radius: 0.1, at: [0, 0, 1]}'",
        "color": "write 'material: {color: ...}'",
    }

    ball: KernelBall | None = Field(default=None, description="All points within a distance of a point.")
    half_space: KernelHalfSpace | None = Field(
        default=None, alias="half-space", description="One side of a plane."
    )
    capsule: KernelCapsule | None = Field(
        default=None, description="All points within a distance of a segment."
    )
    arc: KernelArc | None = Field(default=None, description="All points within a distance of an arc; in e3.")
    leaf: KernelLeaf | None = Field(default=None, description="A lens; in e3.")
    material: OptionalMaterial = Field(
        default=None, description="What it is made of. Left out: what the object is made of."
    )

    @property
    def kind(self) -> str:
        """Which of the kernels this is, as it is written in a scene."""
        return next(key for key in self.one_of if getattr(self, self.keys()[key]) is not None)

    def check(self, context: Context) -> Iterator[Problem]:
        if context.geometry in (None, "e3"):
            return
        for key in ("arc", "leaf"):
            if getattr(self, key) is not None:
                message = f"this kernel is made in e3, not in {context.geometry}"
                yield Problem((key,), message, "there is the capsule", True)


class Mirror(Node):
    """A mirror: the totally geodesic plane across a direction at a point. What the levels before it have made
    belongs on the side that the normal does not point to; what reaches beyond is cut off."""

    what = "a mirror"
    example = "mirror: {normal: [1, 0, 0.3], offset: 0.5}"

    normal: Direction = Field(
        description="Points to the side where the mirror image is; in s2xe and h2xe vertical, [0, 0, ±1], or "
        "horizontal, [x, y, 0]."
    )
    offset: Number = Field(default=0.0, description="How far along the normal the plane stands.")
    at: Point = Field(default=(0.0, 0.0, 0.0), description="The point from which the normal points.")
    smooth: NotNegative = Field(
        default=0.0,
        description="Normals are blended within this distance of the mirror, so that the crease where "
        "surfaces meet on it is not seen; 0 keeps it.",
    )

    def check(self, context: Context) -> Iterator[Problem]:
        x, y, fiber = self.normal
        if context.geometry in PRODUCTS and fiber != 0 and (x != 0 or y != 0):
            message = f"in {context.geometry} a mirror is across the fiber or along it"
            yield Problem(("normal",), message, f"write [0, 0, 1] or [{x:g}, {y:g}, 0]")


class Level(Node):
    """One level of a sequence: the mirror doubles what there is, and then the kernel is added."""

    what = "a level"
    example = "- {mirror: {normal: [1, 0, 0.3], offset: 0.5}, kernel: {ball: {radius: 0.1}}}"

    mirror: Mirror = Field(description="Doubles what the levels before have made.")
    kernel: Kernel | None = Field(default=None, description="What is added after that. Left out: nothing.")


class MapTurn(Node):
    """A turn about an axis through the origin, right-handed."""

    what = "a turn"
    example = "turn: {axis: [0, 0, 1], angle: 30 deg}"

    axis: Direction = Field(description="The axis.")
    angle: Angle = Field(description="How far to turn.")


class MapStep(Node):
    """One step of a conformal map."""

    what = "a step of a map"
    example = "- {move: [0, 0, 1]}"
    one_of = ("move", "turn", "scale", "bend")
    hints: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("rotate", "rotation"), "did you mean 'turn'?"),
        **dict.fromkeys(("translate", "shift"), "did you mean 'move'?"),
    }

    move: Vec3 | None = Field(default=None, description="Move by a vector.")
    turn: MapTurn | None = Field(default=None, description="Turn about an axis through the origin.")
    scale: Positive | None = Field(default=None, description="Make larger or smaller about the origin.")
    bend: Vec3 | None = Field(
        default=None,
        description="Bend by an inversion, a move by this vector v and an inversion: the origin stays, with "
        "its directions, and the point v/|v|² goes to infinity.",
    )


def _steps(value: Any) -> Any:
    if isinstance(value, dict) and value:
        first, *others = value
        written = ", ".join([f"{{{first}: ...}}", *(["..."] if others else [])])
        raise problem("expected a list, found a mapping", f"write [{written}]")
    return value


class MoebiusLevel(Node):
    """One level of a Moebius sequence: the plane x = 0 doubles what there is, on its negative side; the
    kernel is added; and then all of it goes through a conformal map.
    """

    what = "a level"
    example = "- {map: [{bend: [0.1, 0, 0]}, {move: [-1, 0, 0]}], kernel: {ball: {radius: 0.1}}}"

    map: Annotated[tuple[MapStep, ...], AtLeast(1), BeforeValidator(_steps)] = Field(
        description="Steps, the first made first."
    )
    kernel: Kernel | None = Field(default=None, description="What is added beside the mirror images.")
    smooth: NotNegative = Field(default=0.0, description="As of a [mirror](#mirror).")


class Twist(Node):
    """A twist about the z-axis of the object (KRS paper, 5.2): it hides mirror symmetry."""

    what = "a twist"
    example = "twist: {angle: 10 deg}"

    angle: Angle = Field(description="How far things turn for each unit of height.")


class EmptyZone(Node):
    """A ball out of which the sequence is cut (KRS paper, 8.4)."""

    what = "an empty zone"
    example = "- {radius: 1, at: [0, 0, 2]}"

    radius: Positive = Field(description="Its radius.")
    at: Vec3 = Field(default=(0.0, 0.0, 0.0), description="Its center.")


def _zones(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, (list, tuple)):
        return value
    return (EmptyZone.model_validate(value, context=context_of(info)),)


class Record:
    """A record as `thurston_cl.krs.Model.from_dict` takes it, and the sequence it describes."""

    def __init__(self, entries: Mapping[str, Any]) -> None:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            self.sequence = sequence_of(entries)
        # Whether what mirrors clip is meant, as recipes say.
        self.clips = bool(entries.get("clips"))
        # Told when the scene is rendered.
        self.warnings = tuple(str(warning.message) for warning in caught)
        self._text = json.dumps(entries)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Record) and other._text == self._text

    def __hash__(self) -> int:
        return hash(self._text)


def _record(value: Any) -> Any:
    if isinstance(value, Record):
        return value
    if not isinstance(value, Mapping):
        raise problem(f"expected a mapping, found {shown(value)}", f"for example {_RECORD}")
    try:
        return Record(value)
    except (TypeError, ValueError) as error:
        raise problem(f"this record makes no sense: {error}", f"for example {_RECORD}") from None


_RECORD = (
    "record: {mirrors: [{u: [1, 0, 0], w: 0.5}], kernels: [{type: sphere, c: [0, 0, 0], r: 0.4}, "
    "{type: empty}]}"
)


class Krs(Node):
    """A kernel-reflection sequence: a few kernels, doubled again and again by mirrors. Some ten levels
    make a tree, some twenty a forest; time grows with the levels, not with what they make.
    """

    what = "a sequence"
    example = "krs: {tree: {seed: 3}}"
    one_of = (
        "levels",
        "moebius",
        "record",
        "tree",
        "shrub",
        "forest",
        "meadow",
        "coral",
        "rock",
        "terrain",
        "sponge",
        "fish-school",
        "palm-leaf",
        "hyperbolic-forest",
    )
    hints: ClassVar[Mapping[str, str]] = {
        "mirrors": "write 'levels: [{mirror: ..., kernel: ...}, ...]', and 'kernel' for the innermost one",
        "material": "'material' stands beside 'krs', or with a kernel of its levels",
        **dict.fromkeys(("fish", "school"), "did you mean 'fish-school'?"),
        **dict.fromkeys(("palm", "frond"), "did you mean 'palm-leaf'?"),
        **dict.fromkeys(("grass", "lawn"), "did you mean 'meadow'?"),
        **dict.fromkeys(("seabed", "land", "hills"), "did you mean 'terrain'?"),
        "reef": "there is no recipe 'reef': write several objects, each with a 'coral'",
    }

    kernel: Kernel | None = Field(
        default=None,
        description="The innermost kernel, of `levels` and `moebius`: what is doubled most often.",
    )
    levels: Annotated[tuple[Level, ...], AtLeast(1)] | None = Field(
        default=None, description=f"Mirrors and kernels, the innermost level first; at most {MOST_LEVELS}."
    )
    moebius: Annotated[tuple[MoebiusLevel, ...], AtLeast(1)] | None = Field(
        default=None,
        description=f"Conformal maps and kernels, the innermost level first; at most {MOST_LEVELS}. In e3.",
    )
    record: Annotated[
        Record | None,
        PlainValidator(_record),
        WithJsonSchema({"type": "object"}),
        Says("a record: `{mirrors: ..., kernels: ...}` or `{G: ..., kernels: ...}`"),
    ] = Field(
        default=None,
        description="The numbers of a sequence, as `thurston_cl.krs.Model.from_dict` takes them. In e3.",
    )
    made_of: tuple[MaterialValue, ...] = Field(
        default=(),
        alias="made-of",
        description="Of a `record`: materials by the number `mat` of its kernels, from 0. Left out: "
        "all is made of what the object is made of.",
    )
    tree: Tree | None = Field(default=None, description="A tree. In e3, as the next ones.")
    shrub: Shrub | None = Field(default=None, description="A shrub.")
    forest: Forest | None = Field(default=None, description="A forest of one tree, and its ground.")
    meadow: Meadow | None = Field(default=None, description="A meadow, blade by blade.")
    coral: Coral | None = Field(default=None, description="A coral.")
    rock: Rock | None = Field(default=None, description="A rock.")
    terrain: Terrain | None = Field(default=None, description="Hills, or the bottom of the sea.")
    sponge: Sponge | None = Field(default=None, description="A sponge.")
    fish_school: FishSchool | None = Field(default=None, alias="fish-school", description="A school of fish.")
    palm_leaf: PalmLeaf | None = Field(
        default=None, alias="palm-leaf", description="The leaf of a palm, as a Moebius sequence."
    )
    hyperbolic_forest: HyperbolicForest | None = Field(
        default=None, alias="hyperbolic-forest", description="A forest on a plane of h3."
    )
    level_balls: Flag = Field(
        default=True,
        alias="level-balls",
        description="Of a Moebius sequence: whether balls that hold its levels say more of how far it is. "
        "Without them rays may stop in empty space, at the poles of its maps; it is for comparisons.",
    )
    twist: Twist | None = Field(default=None, description="Twist it about its z-axis. In e3.")
    empty_zones: Annotated[
        tuple[EmptyZone, ...],
        BeforeValidator(_zones),
        OneOrMore(),
        Says("an [empty zone](#empty-zone), or a list of them"),
    ] = Field(
        default=(),
        alias="empty-zones",
        description="Balls out of which it is cut, the ground of a forest too: for a glade "
        "write `ground: false` and put a half-space below. In e3.",
    )

    @property
    def recipe(self) -> Recipe | None:
        """The recipe that makes it, if any does."""
        found = getattr(self, self.keys()[self.kind])
        return found if isinstance(found, Recipe) else None

    @property
    def kind(self) -> str:
        """The key by which it is described."""
        return next(key for key in self.one_of if getattr(self, self.keys()[key]) is not None)

    @property
    def materials(self) -> tuple[Material, ...]:
        """What its kernels are made of where that is not what the object is made of, each once."""
        if self.recipe is not None:
            return self.recipe.materials
        if self.record is not None:
            return self.made_of
        named = (kernel.material for _, kernel in self.kernels_written() if kernel is not None)
        return tuple(dict.fromkeys(material for material in named if material is not None))

    def check(self, context: Context) -> Iterator[Problem]:
        geometry = context.geometry
        if not any(getattr(self, self.keys()[key]) is not None for key in self.one_of):
            return
        if geometry is not None and geometry not in MIRRORED:
            message = f"in {geometry} nothing is doubled by mirrors"
            yield Problem((), message, f"sequences are made in {', '.join(MIRRORED)}")
            return
        for key in (*self.one_of, "twist", "empty-zones") if geometry is not None else ():
            given = getattr(self, self.keys()[key])
            made = given.geometries if isinstance(given, Recipe) else ("e3",)
            if given and key != "levels" and geometry not in made:
                message = f"this is made in {', '.join(made)}, not in {geometry}"
                help = _CURES.get((key, geometry), "write 'levels', with mirrors and kernels")
                if key not in self.one_of:
                    help = f"leave '{key}' out"
                yield Problem((key,), message, help, True)
        for key in ("levels", "moebius"):
            given = getattr(self, key)
            if given is not None and len(given) > MOST_LEVELS:
                yield Problem(
                    (key,), f"at most {MOST_LEVELS} levels; these are {len(given)}", "leave some out"
                )
        if self.kernel is not None and self.kind not in ("levels", "moebius"):
            message = "a recipe or a record brings its kernels with it"
            yield Problem(("kernel",), message, "leave kernel out, or write levels", True)
        explicit = self.levels is not None or self.moebius is not None
        if explicit and not any(kernel for _, kernel in self.kernels_written()):
            message = "there is no kernel, so that there is nothing to double"
            yield Problem((), message, "add 'kernel: {ball: {radius: 0.1}}'")
        bent = self.moebius is not None or self.palm_leaf is not None or self.coral is not None
        if not self.level_balls and not (bent or self.record is not None):
            message = "only Moebius sequences have balls that hold their levels"
            yield Problem(("level-balls",), message, "leave it out", True)
        if self.made_of and self.record is None:
            message = "only the kernels of a record are made of what is listed here"
            yield Problem(("made-of",), message, "leave it out", True)
        if self.record is not None:
            parts = max(kernel.part for kernel in self.record.sequence.kernels)
            if self.made_of and parts >= len(self.made_of):
                count = "1 material" if len(self.made_of) == 1 else f"{len(self.made_of)} materials"
                message = f"kernels have mat 0 to {parts}, and made-of lists {count}"
                yield Problem(("made-of",), message, f"list {parts + 1}")
            if geometry == "e3" and self.record.sequence.geometry != geometry:
                message = f"this record is of {self.record.sequence.geometry}, and the scene of {geometry}"
                yield Problem(("record",), message, "write 'levels'", True)
        for path, kernel in self.kernels_written():
            if kernel is None or kernel.half_space is None:
                continue
            if self.moebius is not None:
                message = "a Moebius sequence has bounded kernels only"
                yield Problem((*path, "half-space"), message, "write a large ball", True)
            elif self.twist is not None:
                message = "a half-space has no bound, and what has none cannot be twisted"
                yield Problem((*path, "half-space"), message, "make it an object of its own", True)
        yield from self._unbounded_twist()

    def _unbounded_twist(self) -> Iterator[Problem]:
        """Whether a recipe or a record is twisted that has no bound."""
        if self.twist is None or not (self.recipe or self.record):
            return
        try:
            made = Record(self.recipe.record()) if self.recipe else self.record
        except ValueError:
            # That there is no such thing is told where it is made.
            return
        if made is not None and not made.sequence.bounded:
            message = f"this {self.kind} has a plane, so no bound, and what has none cannot be twisted"
            help = "write 'ground: false'" if self.kind == "forest" else "leave the twist out"
            yield Problem(("twist",), message, help, True)

    def kernels_written(self) -> Iterator[tuple[Location, Kernel | None]]:
        """Kernels of `levels` and `moebius`, the innermost first, with the keys that lead to them."""
        yield ("kernel",), self.kernel
        for index, level in enumerate(self.levels or ()):
            yield ("levels", index, "kernel"), level.kernel
        for index, distorted in enumerate(self.moebius or ()):
            yield ("moebius", index, "kernel"), distorted.kernel
