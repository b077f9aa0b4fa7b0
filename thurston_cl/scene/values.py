"""The single values of a scene: numbers, angles, vectors, colors, file names. Each says what it expects."""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath, PureWindowsPath
from typing import Annotated, Any

import webcolors  # type: ignore[import-untyped]
from annotated_types import Ge, Gt, Le, Lt
from pydantic import (
    AfterValidator,
    BeforeValidator,
    PlainValidator,
    StringConstraints,
    ValidationError,
    WithJsonSchema,
)
from pydantic.annotated_handlers import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from .base import Problem, problem, problems_of, raised, shown
from .suggest import did_you_mean

PARAM_PATTERN = r"^\$[A-Za-z_][A-Za-z0-9_]*$"
NAME_PATTERN = r"^[A-Za-z_][A-Za-z0-9_-]*$"


@dataclass(frozen=True)
class Says:
    """How the reference page names what a field accepts."""

    words: str


@dataclass(frozen=True)
class Also:
    """Other ways to write a value, for the JSON Schema; the validator beside it turns them into the value."""

    schemas: tuple[Mapping[str, Any], ...]

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {"anyOf": [*map(dict, self.schemas), handler(schema)]}


def number(value: object) -> float:
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value)
    help = None
    if isinstance(value, str):
        if re.fullmatch(r"\s*[-+]?[\d.]+(e[-+]?\d+)?\s*", value, re.IGNORECASE):
            help = "take the quotes off"
        elif re.fullmatch(r"\s*[-+]?\d+,\d+\s*", value):
            help = f"a decimal point, not a comma: {value.strip().replace(',', '.')}"
        elif re.fullmatch(r"\s*[-+]?[\d.]+\s*(deg|rad|turn|[cm]?m|px)\s*", value):
            help = "lengths have no unit: write the number alone"
        elif counted := re.fullmatch(r"\s*([-+]?\d+\.?\d*)\s*(stops?|ev)\s*", value, re.IGNORECASE):
            help = f"write {counted[1]}"
        elif percent := re.fullmatch(r"\s*(\d+\.?\d*)\s*%\s*", value):
            help = f"write {float(percent[1]) / 100:.10g}"
        elif re.search(r"[*/^()]|\b(pi|sqrt)\b", value):
            help = "a scene holds numbers, not expressions: write the value out"
    raise problem(f"expected a number, found {shown(value)}", help)


def whole_number(value: object) -> int:
    given = number(value)
    if not given.is_integer():
        raise problem(f"expected a whole number, found {shown(value)}")
    return int(given)


def _flag(value: object) -> bool:
    if isinstance(value, bool):
        return value
    meant = {"yes": "true", "on": "true", "1": "true", "no": "false", "off": "false", "0": "false"}
    guess = meant.get(str(value).lower())
    raise problem(f"expected true or false, found {shown(value)}", guess and f"write {guess}")


# The bounds stand before the validators, next to the plain type: only there do they reach the JSON Schema.
Number = Annotated[float, BeforeValidator(number), Says("number")]
Positive = Annotated[float, Gt(0), BeforeValidator(number), Says("number > 0")]
NotNegative = Annotated[float, Ge(0), BeforeValidator(number), Says("number ≥ 0")]
Fraction = Annotated[float, Gt(0), Lt(1), BeforeValidator(number), Says("number between 0 and 1")]
Weight = Annotated[float, Ge(0), Le(1), BeforeValidator(number), Says("number from 0 to 1")]
Ratio = Annotated[float, Ge(0.4), Le(1), BeforeValidator(number), Says("number from 0.4 to 1")]
Cosine = Annotated[float, Ge(-1), Le(1), BeforeValidator(number), Says("number from -1 to 1")]
Count = Annotated[int, Ge(1), BeforeValidator(whole_number), Says("whole number ≥ 1")]
Pixels = Annotated[int, Ge(1), Le(16384), BeforeValidator(whole_number)]
Samples = Annotated[int, Ge(1), Le(4096), BeforeValidator(whole_number), Says("whole number from 1 to 4096")]
Seed = Annotated[
    int, Ge(0), Le(1_000_000), BeforeValidator(whole_number), Says("whole number from 0 to 1000000")
]
# Shorter steps would be more than a million on the way of a ray, which no flow makes; longer ones than the
# geometry's radius follow nothing.
FlowStep = Annotated[float, Ge(1e-4), Le(1), BeforeValidator(number), Says("number from 0.0001 to 1")]
Steps = Annotated[
    int, Ge(1), Le(100_000), BeforeValidator(whole_number), Says("whole number from 1 to 100000")
]

Exposure = Annotated[float, Ge(-32), Le(32), BeforeValidator(number), Says("number from -32 to 32")]

Flag = Annotated[bool, BeforeValidator(_flag), Says("`true` or `false`")]

_UNITS = {"deg": math.pi / 180, "rad": 1.0, "turn": 2 * math.pi}
# Only what float() reads, so that the pattern and the loader accept the same.
_ANGLE_PATTERN = r"^\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*(deg|rad|turn)\s*$"


def _angle(value: object) -> float:
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        # Nobody writes more than a turn in radians.
        radians = f" or '{value:g} rad'" if abs(value) <= 2 * math.pi else ""
        raise problem(f"an angle needs a unit: write '{value:g} deg'{radians}")
    if isinstance(value, str) and re.match(_ANGLE_PATTERN, value):
        amount, unit = re.split(r"(?=deg|rad|turn)", value.strip())
        angle = float(amount) * _UNITS[unit]
        if math.isfinite(angle):
            return angle
    near = re.fullmatch(r"\s*([-+.\deE]+)\s*([a-zA-Zπ°]+)\s*", value) if isinstance(value, str) else None
    help = None
    if near:
        guess = {
            "°": "deg",
            "degree": "deg",
            "degrees": "deg",
            "radian": "rad",
            "radians": "rad",
            "turns": "turn",
        }
        help = f"write '{near[1]} {guess.get(near[2].lower(), 'deg')}'; the units are deg, rad and turn"
    raise problem(f"expected an angle such as '90 deg', found {shown(value)}", help)


Angle = Annotated[
    float,
    PlainValidator(_angle),
    WithJsonSchema(
        {"type": "string", "pattern": f"{_ANGLE_PATTERN}|{PARAM_PATTERN}", "examples": ["90 deg"]}
    ),
    Says("angle: `90 deg`, `1.57 rad`, `0.25 turn`"),
]


ACCURACIES = ("half-pixel", "quarter-pixel", "draft", "reference")


def accuracy(value: object) -> str | float:
    """A word of `ACCURACIES`, or an angle in radians."""
    if value in ACCURACIES:
        return str(value)
    if isinstance(value, str) and re.match(_ANGLE_PATTERN, value):
        angle = _angle(value)
        if not 0 < angle <= math.pi:
            raise problem("an accuracy is an angle greater than 0 and at most 180 deg")
        return angle
    help = "write 'half-pixel', or an angle such as '1e-5 rad'"
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        help = f"an angle needs a unit: write '{value:g} rad', or 'half-pixel'"
    raise problem(f"expected one of {', '.join(ACCURACIES)}, or an angle, found {shown(value)}", help)


# A word, or an angle in radians.
Accuracy = Annotated[
    str | float,
    PlainValidator(accuracy),
    WithJsonSchema(
        {
            "type": "string",
            "pattern": f"^({'|'.join(ACCURACIES)})$|{_ANGLE_PATTERN}|{PARAM_PATTERN}",
            "examples": ["half-pixel", "1e-5 rad"],
        }
    ),
    Says("`half-pixel`, `quarter-pixel`, `draft`, `reference` or an angle: `1e-5 rad`"),
]


def _field_of_view(angle: float) -> float:
    if angle <= 0:
        raise problem("a field of view is greater than 0 deg")
    if angle >= math.pi:
        degrees = min(360.0, math.degrees(angle))
        raise problem(
            "a perspective view is between 0 and 180 deg",
            "wider views need another projection: "
            f"'projection: {{fisheye: {{angle: {degrees:.10g} deg}}}}' without 'fov'",
        )
    return angle


FieldOfView = Annotated[Angle, AfterValidator(_field_of_view)]


def _view_angle(angle: float) -> float:
    # A full turn in degrees is rounded.
    if not 0 < angle <= 2 * math.pi * (1 + 1e-12):
        raise problem("an angle of view is greater than 0 deg and at most 360 deg")
    return angle


ViewAngle = Annotated[Angle, AfterValidator(_view_angle)]


@dataclass(frozen=True)
class OneOrMore:
    """A list that may be written as its only entry, for the JSON Schema."""

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        as_list = handler(schema)
        return {"anyOf": [as_list["items"], as_list]}


@dataclass(frozen=True)
class Lengths:
    """A list of so many entries, for the JSON Schema; the validator beside it knows which it has to be."""

    least: int
    most: int

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {**handler(schema), "minItems": self.least, "maxItems": self.most}


@dataclass(frozen=True)
class AtLeast:
    """A list of at least this many entries, right or wrong ones."""

    count: int

    def _check(self, value: object, handler: Callable[[object], object]) -> object:
        problems, checked = [], None
        if isinstance(value, (list, tuple)) and len(value) < self.count:
            entries = "entry" if self.count == 1 else "entries"
            problems.append(Problem((), f"expected at least {self.count} {entries}, found {len(value)}"))
        try:
            checked = handler(value)
        except ValidationError as error:
            problems += problems_of(error)
        if problems:
            raise raised("list", problems)
        return checked

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_wrap_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {**handler(schema), "minItems": self.count}


def list_of(length: int, names: str) -> Callable[[object], object]:
    def check(value: object) -> object:
        if not isinstance(value, (list, tuple)):
            written = {"x": "[1, 0, 0]", "y": "[0, 1, 0]", "z": "[0, 0, 1]"}.get(str(value))
            numbers = re.split(r"\s*[xX×,]\s*|\s+", str(value).strip())
            if len(numbers) == length and all(re.fullmatch(r"[-+]?\d+\.?\d*", text) for text in numbers):
                written = f"[{', '.join(numbers)}]"
            raise problem(
                f"expected {length} numbers {names}, found {shown(value)}", written and f"write {written}"
            )
        if len(value) != length:
            raise problem(f"expected {length} numbers {names}, found {len(value)}")
        return value

    return check


def _not_zero(vector: tuple[float, ...]) -> tuple[float, ...]:
    if not any(vector):
        raise problem("a direction is not the zero vector")
    return vector


Vec3 = Annotated[
    tuple[Number, Number, Number], BeforeValidator(list_of(3, "[x, y, z]")), Says("3 numbers `[x, y, z]`")
]
Vec4 = Annotated[
    tuple[Number, Number, Number, Number],
    BeforeValidator(list_of(4, "[x, y, z, w]")),
    Says("4 numbers `[x, y, z, w]`"),
]
Direction = Annotated[Vec3, AfterValidator(_not_zero), Says("direction `[x, y, z]`, not zero, of any length")]
PixelSize = Annotated[
    tuple[Pixels, Pixels],
    BeforeValidator(list_of(2, "[width, height]")),
    Says("2 whole numbers from 1 to 16384"),
]


def _pair(value: object) -> object:
    if isinstance(value, (list, tuple)):
        return list_of(2, "[n, m]")(value)
    number = whole_number(value)
    return number, number


SquareCount = Annotated[
    tuple[Count, Count],
    BeforeValidator(_pair),
    Also(({"type": "integer", "minimum": 1}, {"type": "string", "pattern": PARAM_PATTERN})),
    Says("whole number ≥ 1, or two of them `[n, m]`"),
]


def _lengths(value: object) -> object:
    if isinstance(value, (list, tuple)):
        return list_of(2, "[w, h]")(value)
    length = number(value)
    return length, length


TwoLengths = Annotated[
    tuple[Positive, Positive],
    BeforeValidator(_lengths),
    Also(
        ({"type": "number", "exclusiveMinimum": 0}, {"type": "string", "pattern": PARAM_PATTERN}),
    ),
    Says("number > 0, or two of them `[w, h]`"),
]


@dataclass(frozen=True)
class Color:
    """A color: `linear` red, green and blue with the primaries of Rec.709, and how it was `written`."""

    linear: tuple[float, float, float]
    written: str


_HEX_PATTERN = r"^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})$"
_COLOR_NAMES = tuple(webcolors.names("css3"))


def _decode_srgb(byte: int) -> float:
    """From an sRGB code value to linear light: IEC 61966-2-1, the piecewise curve."""
    value = byte / 255
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def color(text: str) -> Color:
    """The color of a CSS name or of '#rgb' or '#rrggbb', both read as sRGB."""
    code = webcolors.normalize_hex(text if text.startswith("#") else webcolors.name_to_hex(text))
    red, green, blue = (_decode_srgb(int(code[i : i + 2], 16)) for i in (1, 3, 5))
    return Color((red, green, blue), text)


def to_color(value: object) -> Color:
    """The validator of colors."""
    if isinstance(value, Color):
        return value
    if isinstance(value, list):
        red, green, blue = _linear_color(value)
        return Color((red, green, blue), f"[{red:g}, {green:g}, {blue:g}]")
    if not isinstance(value, str):
        raise problem(
            f"expected a color, found {shown(value)}", 'for example white, "#ffddaa" or [1, 0.7, 0.4]'
        )
    if value in _COLOR_NAMES or re.match(_HEX_PATTERN, value):
        return color(value)
    if value.startswith("#"):
        raise problem(f"{shown(value)} is not a color", "write #rgb or #rrggbb, with 0-9 and a-f")
    if re.match(_COLOR_FUNCTION, value, re.IGNORECASE):
        raise problem(f"{shown(value)} is not a color", _without_function(value))
    if re.fullmatch(r"[0-9a-fA-F]{6}", value):
        raise problem(f"{shown(value)} is not a color", f'did you mean "#{value}"? The quotes are needed')
    if value.lower() in _COLOR_NAMES:
        raise problem(f"{shown(value)} is not a color", f"names of colors are lower case: {value.lower()}")
    raise problem(
        f"{shown(value)} is not a color",
        did_you_mean(value, _COLOR_NAMES, 'use a CSS name, "#rrggbb" or [red, green, blue]'),
    )


# Ways to write a color in CSS that scenes do without.
_COLOR_FUNCTION = r"\s*(rgb|hsl|hsv|hwb|lab|lch|oklab|oklch|color)a?\s*\("


def _without_function(value: str) -> str:
    """The cure for a color written as a function of CSS: its code, if that is plain."""
    numbers = re.fullmatch(r"\s*rgb\(\s*(\d+)[\s,]+(\d+)[\s,]+(\d+)\s*\)\s*", value, re.IGNORECASE)
    if numbers and max(map(int, numbers.groups())) <= 255:
        return f'write "#{bytes(map(int, numbers.groups())).hex()}"'
    return 'functions are not read: write a CSS name, "#rrggbb" or linear [red, green, blue]'


def _linear_color(value: list[object]) -> tuple[float, float, float]:
    list_of(3, "[red, green, blue]")(value)
    numbers = [number(component) for component in value]
    if min(numbers) < 0:
        raise problem("the components of a color are at least 0")
    return numbers[0], numbers[1], numbers[2]


_NUMBER_SCHEMA = {"anyOf": [{"type": "number", "minimum": 0}, {"type": "string", "pattern": PARAM_PATTERN}]}
ColorValue = Annotated[
    Color,
    PlainValidator(to_color),
    WithJsonSchema(
        {
            "anyOf": [
                {"enum": list(_COLOR_NAMES)},
                {"type": "string", "pattern": f"{_HEX_PATTERN}|{PARAM_PATTERN}"},
                {"type": "array", "items": _NUMBER_SCHEMA, "minItems": 3, "maxItems": 3},
            ]
        }
    ),
    Says('color: CSS name, `"#rgb"`, `"#rrggbb"` (sRGB), or linear `[r, g, b]`'),
]

Name = Annotated[str, StringConstraints(pattern=NAME_PATTERN)]
# Without a dash, since $a-b would read as a difference.
ParamName = Annotated[str, StringConstraints(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]


def _param(value: object) -> float | int | str:
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise problem(f"a param is one number or one text, found {shown(value)}")
    if isinstance(value, str) and re.match(PARAM_PATTERN, value):
        raise problem("a param cannot refer to another param", "write its value")
    return value


ParamValue = Annotated[
    float | int | str,
    PlainValidator(_param),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string", "not": {"pattern": PARAM_PATTERN}}]}),
    Says("number or text"),
]


def _output_file(value: object) -> str:
    if not isinstance(value, str):
        raise problem(f"expected the name of a file, found {shown(value)}", "for example picture.png")
    path = PurePosixPath(value)
    if path.is_absolute() or PureWindowsPath(value).drive or value.startswith(("~", "\\")):
        raise problem(
            f"an output stays below the current folder; '{value}' is absolute",
            "write a relative name here, or choose another place with -o on the command line",
        )
    if ".." in path.parts or ".." in PureWindowsPath(value).parts:
        raise problem(
            f"an output stays below the current folder; '{value}' climbs out with '..'",
            "write a relative name here, or choose another place with -o on the command line",
        )
    if path.suffix.lower() not in (".png", ".exr"):
        raise problem(
            f"'{value}' is neither a .png nor an .exr file",
            "the end of the name chooses the format",
        )
    if path.stem in ("", ".png", ".exr") or "\x00" in value:
        raise problem(f"'{value}' is not the name of a file", "for example picture.png")
    return value


# Not from the root, a drive or a home folder; no '..' on the way; then a name and one of the two endings.
_FILE_PATTERN = r"^(?![~/\\]|[A-Za-z]:)(?!(.*[/\\])?\.\.([/\\]|$))" r".*[^/\\]\.([pP][nN][gG]|[eE][xX][rR])$"

OutputFile = Annotated[
    str,
    PlainValidator(_output_file),
    WithJsonSchema(
        {
            "type": "string",
            "pattern": _FILE_PATTERN,
            "examples": ["picture.png", "picture.exr"],
        }
    ),
    Says("relative file name ending in `.png` or `.exr`"),
]
