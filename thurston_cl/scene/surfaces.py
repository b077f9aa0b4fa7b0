"""Surfaces: patterns, and materials by Phong's model."""

import re
from collections.abc import Iterator, Mapping
from pathlib import PurePath
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Ge, Le
from pydantic import BeforeValidator, Field, ValidationInfo
from pydantic_core import PydanticCustomError

from .base import Node, Problem, problem, shown
from .context import Context, context_of
from .image_file import SUFFIXES, ImageFileValue, pictures
from .suggest import did_you_mean, listing
from .values import (
    NAME_PATTERN,
    PARAM_PATTERN,
    Also,
    AtLeast,
    ColorValue,
    Cosine,
    Count,
    Direction,
    Fraction,
    Positive,
    Says,
    SquareCount,
    TwoLengths,
    Weight,
    color,
    list_of,
    to_color,
    whole_number,
)

# Octave 12 is 2000 times as fine as the first.
MOST_OCTAVES = 12

SQUARES = (
    "How many squares, in the two directions: once around a ball or cylinder, and from pole to pole of a "
    "ball; in every other direction for each unit of length."
)


class Checker(Node):
    """A checkerboard."""

    what = "a checker"
    example = "checker: {count: 8, colors: [white, black]}"
    hints: ClassVar[Mapping[str, str]] = dict.fromkeys(("size", "scale", "repeat"), "did you mean 'count'?")

    count: SquareCount = Field(default=(8, 8), description=SQUARES)
    colors: Annotated[
        tuple[ColorValue, ColorValue], BeforeValidator(lambda v: _two_colors(v)), Says("2 colors")
    ] = Field(default=(color("white"), color("black")), description="The colors of the two kinds of squares.")


class Grid(Node):
    """Lines between squares."""

    what = "a grid"
    example = 'grid: {count: 8, width: 0.1, colors: [white, "#335577"]}'
    hints: ClassVar[Mapping[str, str]] = Checker.hints

    count: SquareCount = Field(default=(8, 8), description=SQUARES)
    width: Fraction = Field(default=0.1, description="Width of a line, as a fraction of a square.")
    colors: Annotated[
        tuple[ColorValue, ColorValue], BeforeValidator(lambda v: _two_colors(v)), Says("2 colors")
    ] = Field(
        default=(color("white"), color("#335577")),
        description="The color of the lines and that of the squares.",
    )


class Bands(Node):
    """Lines across the first surface coordinate, in colors that take turns."""

    what = "bands"
    example = "bands: {count: 2, width: 0.1, ground: black, colors: [white, red]}"

    count: Count = Field(
        default=2,
        description="How many lines: once around a ball or cylinder; on every other surface for each unit of "
        "length.",
    )
    width: Fraction = Field(default=0.1, description="Width of a line, as a fraction of their distance.")
    ground: ColorValue = Field(default=color("#335577"), description="The color between the lines.")
    colors: Annotated[tuple[ColorValue, ...], AtLeast(1)] = Field(
        default=(color("white"),),
        description="The colors of the lines: the first is that of line 0, and on both sides of it they take "
        "turns in this order. Around a ball or cylinder they meet again if their number divides count.",
    )


class Strips(Node):
    """Strips of equal width side by side, in colors that take turns."""

    what = "strips"
    example = "strips: {count: 12, colors: [white, tomato, gold]}"

    count: Count = Field(
        default=8,
        description="How many strips: once around a ball or cylinder, and from pole to pole of a ball; in "
        "every other direction for each unit of length.",
    )
    across: Literal["first", "second"] = Field(
        default="first",
        description="The [surface coordinate](#patterns-on-surfaces) along which strip follows strip: on a "
        "ball `first` is from meridian to meridian, `second` from parallel to parallel.",
    )
    colors: Annotated[tuple[ColorValue, ...], AtLeast(2)] = Field(
        default=(color("white"), color("#335577")),
        description="The colors, in this order. Around a ball or cylinder they meet again if their number "
        "divides count.",
    )


class ImageTexture(Node):
    """A picture from a file: once around a ball, its middle towards x and its top towards z, or repeated.

    Also written as the name of the file alone. 8-bit and 16-bit files are read as sRGB and files of floats as
    linear light, unless they say otherwise. Transparent parts are as opaque as the rest.
    """

    what = "an image"
    example = "image: {file: earth, size: [1, 1]}"
    hints: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("scale", "repeat", "count", "tile"), "write 'size: [w, h]', which is that of one image"
    )

    file: ImageFileValue = Field(
        description="The image: a file of at most 16384 x 16384 pixels, found from the folder of the scene, "
        "or `earth`, a map of the Earth that comes with the program."
    )
    size: TwoLengths = Field(
        default=(1.0, 1.0),
        description="Width and height of one image: as parts of a turn around a ball or cylinder, and of the "
        "way from pole to pole of a ball; in every other direction as lengths.",
    )


def _image(value: Any) -> Any:
    return {"file": value} if isinstance(value, str) else value


def _two_colors(value: Any) -> Any:
    if not isinstance(value, (list, tuple)) or len(value) != 2:
        found = f"{len(value)}" if isinstance(value, (list, tuple)) else shown(value)
        raise problem(f"expected a list of two colors, found {found}", 'for example [white, "#335577"]')
    return value


ImageValue = Annotated[
    ImageTexture | None,
    BeforeValidator(_image),
    Also(({"type": "string", "pattern": r"\S"},)),
    Says("[image texture](#image-texture), or the name of its file alone"),
]


class Noise(Node):
    """Clouds of color through the whole of the object, which never repeat: gradient noise of several sizes,
    each half as large and half as strong as the one before. In e3, s3 and h3, in the coordinates x, y and z
    of the model about the center of the object, as `rotate` turns them."""

    what = "noise"
    example = 'noise: {size: 0.3, octaves: 4, colors: ["#2f5d22", "#7f9a45"]}'
    hints: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("scale", "frequency", "count"), "write 'size', the length of the largest clouds"),
        **dict.fromkeys(("detail", "levels"), "did you mean 'octaves'?"),
    }

    size: Positive = Field(default=0.3, description="How large the largest clouds are.")
    octaves: Annotated[
        int,
        Ge(1),
        Le(MOST_OCTAVES),
        BeforeValidator(whole_number),
        Says(f"whole number from 1 to {MOST_OCTAVES}"),
    ] = Field(
        default=4, description="How many sizes there are. What is finer than a pixel is left out by itself."
    )
    colors: Annotated[tuple[ColorValue, ...], AtLeast(2)] = Field(
        default=(color("#335577"), color("white")),
        description="The colors, from the least value to the greatest; the middle ones are seen most.",
    )
    stretch: Annotated[
        tuple[Positive, Positive, Positive], BeforeValidator(list_of(3, "[x, y, z]")), Says("3 numbers > 0")
    ] = Field(
        default=(1.0, 1.0, 1.0),
        description="How many times as large the clouds are along x, y and z; [1, 1, 0.1] makes layers.",
    )


class Triplanar(Node):
    """A flat pattern that is projected along the three axes of the object and blended by how much the surface
    faces each: for shapes without coordinates of their own. In e3."""

    what = "a triplanar pattern"
    example = "triplanar: {image: earth, size: 0.5}"
    one_of = ("checker", "grid", "bands", "strips", "image")

    checker: Checker | None = Field(default=None, description="A checkerboard of two colors.")
    grid: Grid | None = Field(default=None, description="Lines in one color on ground of another.")
    bands: Bands | None = Field(default=None, description="Lines in colors that take turns.")
    strips: Strips | None = Field(default=None, description="Strips side by side, in colors that take turns.")
    image: ImageValue = Field(default=None, description="A picture from a file, repeated.")
    size: Positive = Field(
        default=1.0,
        description="The length that is one unit of the pattern: of an image of size 1, its width.",
    )


class Slope(Node):
    """Two paints by how steep the surface is, such as grass on what is flat and rock on what is steep. In
    e3."""

    what = "a slope"
    example = 'slope: {flat: "#4c7a34", steep: "#6b6560"}'
    hints: ClassVar[Mapping[str, str]] = {
        "angle": "write 'at', the cosine of that angle: 0.88 is 28 deg",
        **dict.fromkeys(("grass", "top"), "did you mean 'flat'?"),
        **dict.fromkeys(("rock", "side"), "did you mean 'steep'?"),
    }

    flat: "Paint" = Field(description="The color or pattern where the surface faces up.")
    steep: "Paint" = Field(description="The color or pattern where it is steep, and where it faces down.")
    at: Cosine = Field(
        default=0.88,
        description="Where both are alike: the cosine of the angle between the normal and up.",
    )
    width: Positive = Field(default=0.05, description="Over how much of the cosine they blend.")
    up: Direction = Field(default=(0, 0, 1), description="Where up is, in the frame of the object.")


class Pattern(Node):
    """A color that changes over the surface."""

    what = "a pattern"
    example = "checker: {count: 8, colors: [white, black]}"
    one_of = ("checker", "grid", "bands", "strips", "image", "noise", "triplanar", "slope")

    checker: Checker | None = Field(default=None, description="A checkerboard of two colors.")
    grid: Grid | None = Field(default=None, description="Lines in one color on ground of another.")
    bands: Bands | None = Field(
        default=None, description="Lines in one direction, in colors that take turns."
    )
    strips: Strips | None = Field(default=None, description="Strips side by side, in colors that take turns.")
    image: ImageValue = Field(default=None, description="A picture from a file.")
    noise: Noise | None = Field(
        default=None, description="Clouds of color that never repeat. In e3, s3 and h3."
    )
    triplanar: Triplanar | None = Field(
        default=None, description="One of the flat patterns, projected along three axes. In e3."
    )
    slope: Slope | None = Field(default=None, description="Two paints by how steep the surface is. In e3.")

    def check(self, context: Context) -> Iterator[Problem]:
        where = {"noise": ("e3", "s3", "h3"), "triplanar": ("e3",), "slope": ("e3",)}
        for key, geometries in where.items():
            if getattr(self, key) is not None and context.geometry not in (*geometries, None):
                message = f"{key} is made in {listing(geometries)}, not in {context.geometry}"
                yield Problem((key,), message, "use another pattern, such as 'grid: {}'", True)

    @classmethod
    def spelled_out(cls, word: str) -> str | None:
        return f"image: {word}" if _is_picture(word) else super().spelled_out(word)


def _is_picture(word: str) -> bool:
    """Whether a text names an image file, or a picture that comes with the program."""
    return PurePath(word).suffix.lower() in SUFFIXES or word in pictures()


def _paint(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, dict):
        return Pattern.model_validate(value, context=context_of(info))
    if isinstance(value, str) and value.startswith("$textures."):
        context, name = context_of(info), value.removeprefix("$textures.")
        if name not in context.names("textures"):
            raise problem(f"there is no texture '{name}'", _known_names(name, context, "textures"))
        texture = context.entry("textures", name, Pattern)
        if context.contains_itself("textures", name):
            raise problem(f"the texture '{name}' contains itself", "write a color or another texture here")
        return texture or color("black")
    if isinstance(value, Pattern):
        return value
    try:
        return to_color(value)
    except PydanticCustomError:
        help = _paint_meant(value, context_of(info)) if isinstance(value, str) else None
        if help is None:
            raise
    raise problem(f"{shown(value)} is not a color", help)


def _paint_meant(word: str, context: Context) -> str | None:
    """The help for a text that is no color, if it names a pattern, a picture or a texture."""
    if word in Pattern.one_of or _is_picture(word):
        return f"write 'color: {{{Pattern.spelled_out(word)}}}'"
    name = re.sub(r"^\$?textures?\.", "", word)
    return f"did you mean '$textures.{name}'?" if name in context.names("textures") else None


def _known_names(name: str, context: Context, section: str) -> str:
    known = context.names(section)
    if not known:
        return f"the scene has no {section}; add '{section}: {{{name}: ...}}'"
    return did_you_mean(name, known) or f"{section} has: {listing(known)}"


Paint = Annotated[
    ColorValue | Pattern,
    BeforeValidator(_paint),
    Also(({"type": "string", "pattern": r"^\$textures\." + NAME_PATTERN[1:]},)),
    Says("color, pattern such as `{checker: ...}`, or the name of a texture, `$textures.NAME`"),
]


Slope.model_rebuild()


class Material(Node):
    """How a surface answers light: Phong's model (paper, eq. 5.2)."""

    what = "a material"
    example = "{color: white, specular: 0.3}"
    hints: ClassVar[Mapping[str, str]] = {
        "checker": "a pattern is a color: write 'color: {checker: ...}'",
        "grid": "a pattern is a color: write 'color: {grid: ...}'",
        "bands": "a pattern is a color: write 'color: {bands: ...}'",
        "strips": "a pattern is a color: write 'color: {strips: ...}'",
        "image": "a pattern is a color: write 'color: {image: ...}'",
        "noise": "a pattern is a color: write 'color: {noise: ...}'",
        "triplanar": "a pattern is a color: write 'color: {triplanar: ...}'",
        "slope": "a pattern is a color: write 'color: {slope: ...}'",
        "reflection": "did you mean 'reflectivity'?",
        **dict.fromkeys(
            ("texture", "map", "picture"), "a picture is a color: write 'color: {image: earth.png}'"
        ),
        "mirror": "write 'reflectivity: 0.5', and 'reflections: {depth: 1}' in the effects of the scene",
    }

    color: Paint = Field(default=color("#e9e2d6"), description="The color of the surface.")
    ambient: Weight = Field(default=0.1, description="Weight of the light that comes from everywhere.")
    diffuse: Weight = Field(
        default=0.7,
        description="Weight of the light scattered evenly. Left out: what ambient and specular leave of 1.",
    )
    specular: Weight = Field(default=0.2, description="Weight of the highlight.")
    shininess: Positive = Field(
        default=20.0, description="Exponent of the highlight; larger is smaller and sharper."
    )

    reflectivity: Weight = Field(
        default=0.0,
        description="How much of what is seen there is a mirror's; needs [reflections](#reflections).",
    )

    @classmethod
    def fill(cls, data: dict[str, Any], context: Context) -> None:
        ambient, specular = data.get("ambient", 0.1), data.get("specular", 0.2)
        numbers = all(isinstance(weight, (int, float)) for weight in (ambient, specular))
        if "diffuse" not in data and numbers:
            data["diffuse"] = min(1.0, max(0.0, 1.0 - ambient - specular))

    def check(self, context: Context) -> Iterator[Problem]:
        total = self.ambient + self.diffuse + self.specular
        if self.ambient + self.specular > 1 + 1e-6:
            where = "specular" if "specular" in self.model_fields_set else "ambient"
            message = f"ambient and specular add up to {self.ambient + self.specular:g}, which is more than 1"
            help = None
            if "specular" not in self.model_fields_set:
                help = f"specular is {self.specular:g} unless you say so: write 'specular: 0'"
            elif "ambient" not in self.model_fields_set:
                help = f"ambient is {self.ambient:g} unless you say so: write 'ambient: 0'"
            yield Problem((where,), message, help)
        elif abs(total - 1) > 1e-6:
            rest = max(0.0, 1 - self.ambient - self.specular)
            message = f"ambient, diffuse and specular add up to {total:g} instead of 1"
            yield Problem(("diffuse",), message, f"leave diffuse out, or write {rest:g}")


def _field(info: ValidationInfo) -> str:
    """The key before a material, where it has one of its own."""
    key = (info.field_name or "material").replace("_", "-")
    return "" if key == "made-of" else f"{key}: "


def _material(value: Any, info: ValidationInfo) -> Any:
    if not isinstance(value, str):
        return value
    context = context_of(info)
    if value in context.names("materials"):
        return context.entry("materials", value, Material) or Material()
    help = _known_names(value, context, "materials")
    bare = value.removeprefix("$materials.")
    if bare != value:
        help = _known_names(bare, context, "materials")
        if bare in context.names("materials"):
            help = f"a material goes by its bare name: write '{_field(info)}{bare}'"
    try:
        color(value)
    except ValueError:
        pass
    else:
        help = f"for a plain color write '{_field(info)}{{color: {value}}}'"
    raise problem(f"there is no material '{value}'", help)


MaterialValue = Annotated[
    Material,
    BeforeValidator(_material),
    Also(({"type": "string", "pattern": f"{NAME_PATTERN}|{PARAM_PATTERN}"},)),
    Says("name of a material, or the [material](#material) itself"),
]

# The same where it may be left out.
OptionalMaterial = Annotated[
    Material | None,
    BeforeValidator(_material),
    Also(({"type": "string", "pattern": f"{NAME_PATTERN}|{PARAM_PATTERN}"},)),
    Says("name of a material, or the [material](#material) itself"),
]
