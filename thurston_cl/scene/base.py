"""`Node`, the base of every mapping in a scene: finds all mistakes of a mapping in one pass, in our words."""

import re
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Literal, NamedTuple, Self, get_args, get_origin

from pydantic import BaseModel, ConfigDict, ValidationError, ValidationInfo, model_validator
from pydantic.annotated_handlers import GetJsonSchemaHandler
from pydantic.functional_validators import ModelWrapValidatorHandler
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError

from .context import Context, context_of
from .parse import Location
from .suggest import blank_after_colon, listing, nearest

# The type of error whose message is ready to be shown; every other type is pydantic's and gets translated.
READY = "scene"


class Problem(NamedTuple):
    """A mistake inside a mapping, at `path` from it; with `key` the caret stands at the key itself."""

    path: Location
    message: str
    help: str | None = None
    key: bool = False


def problem(message: str, help: str | None = None, *, key: bool = False) -> PydanticCustomError:
    """The exception by which a validator of one value reports that value."""
    return PydanticCustomError(READY, "{message}", {"message": message, "help": help, "key": key})


def shown(value: object) -> str:
    """A found value as a message names it."""
    match value:
        case None:
            return "nothing"
        case bool():
            return "true" if value else "false"
        case str():
            return f"'{value}'" if len(value) <= 40 else f"'{value[:40]}...'"
        case list() | tuple():
            return "a list"
        case dict():
            return "a mapping"
        case float():
            return f"{value:.10g}"
        case _:
            return str(value)


class Node(BaseModel):
    """A mapping of a scene. Frozen; reports all unknown keys, empty keys and alternatives given together."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    what: ClassVar[str] = "a mapping"  # for messages: "a ball"
    example: ClassVar[str] = ""  # for messages: "ball: {radius: 0.4}"
    one_of: ClassVar[tuple[str, ...]] = ()  # exactly one of these keys is given
    hints: ClassVar[Mapping[str, str]] = {}  # unknown key -> help that no near spelling could give

    @classmethod
    def keys(cls) -> dict[str, str]:
        """The keys of the mapping as they are written in a scene -> the names of the fields."""
        return {info.alias or name: name for name, info in cls.model_fields.items()}

    @classmethod
    def fill(cls, data: dict[str, Any], context: Context) -> None:
        """Add defaults that depend on the other keys or on the rest of the scene."""

    def check(self, context: Context) -> Iterator[Problem]:
        """Check what involves more than one key, or the rest of the scene."""
        yield from ()

    @model_validator(mode="wrap")
    @classmethod
    def _all_at_once(cls, data: Any, handler: ModelWrapValidatorHandler[Self], info: ValidationInfo) -> Self:
        if isinstance(data, cls):
            return data
        if not isinstance(data, dict):
            help = cls._for_word(data) if isinstance(data, str) else None
            raise problem(f"expected {cls.what}, found {shown(data)}", help or cls._for_example())
        keys = cls.keys()
        problems = list(cls._wrong_keys(data))
        known = {key: value for key, value in data.items() if key in keys and value is not None}
        cls.fill(known, context_of(info))
        try:
            node = handler(known)
        except ValidationError as error:
            # A key that is there without a value, or misspelt, is not also missing.
            excused = {key for key in data if key in keys} | {
                nearest(key, keys) for key in data if key not in keys
            }
            excused.update(cls.one_of)
            problems += [
                _translated(cls, detail)
                for detail in error.errors(include_url=False)
                if not (detail["type"] == "missing" and detail["loc"][0] in excused)
            ]
        else:
            problems += node.check(context_of(info))
        if problems:
            raise raised(cls.__name__, problems)
        return node

    @classmethod
    def _wrong_keys(cls, data: dict[str, Any]) -> Iterator[Problem]:
        keys = cls.keys()
        unknown = [key for key in data if key not in keys]
        # A bracket is read as text, and a comma inside it ends that text.
        cut = any(isinstance(value, str) and value.count("(") > value.count(")") for value in data.values())
        for key in unknown:
            help = cls._meant(key)
            if cut and data[key] is None:
                help = "is it part of the text before it? Put quotes around a text that has commas"
            yield Problem((key,), f"unknown key '{key}'", help, key=True)
        for key, value in data.items():
            if value is None and key in keys:
                help = "give it a value or leave it out"
                below = list(data)[list(data).index(key) + 1 :]
                if inner := node_of(cls, keys[key]):
                    help = inner._for_example() or help
                    if not set(below).isdisjoint(inner.keys()):
                        help = f"is what belongs to '{key}' indented further than '{key}' itself?"
                yield Problem((key,), f"'{key}' has no value", help, key=True)
        given = [key for key in data if key in cls.one_of]
        if len(given) > 1:
            yield Problem((given[1],), f"{cls.what} has only one of {_and(given)}", cls._split(), True)
        elif cls.one_of and not given and not unknown:
            yield Problem((), f"{cls.what} needs one of: {', '.join(cls.one_of)}", cls._for_example())

    @classmethod
    def _split(cls) -> str | None:
        """How to write two of what may stand once."""
        return None

    @classmethod
    def _meant(cls, key: str) -> str | None:
        """The help for an unknown key."""
        keys = cls.keys()
        if key in cls.hints:
            return cls.hints[key]
        if help := blank_after_colon(key, keys):
            return help
        if key.isdecimal():
            return f"a number has a decimal point, not a comma: is it .{key}?"
        nodes = {outer: node_of(cls, name) for outer, name in keys.items()}
        inside = [outer for outer, node in nodes.items() if node is not None and key in set(node.keys())]
        guess = nearest(key, [*keys, *cls.hints])
        if guess is not None and (not inside or guess.replace("-", "") == key.replace("_", "").lower()):
            return cls.hints.get(guess, f"did you mean '{guess}'?")
        if inside:
            return f"it belongs inside {_or(inside)}: write '{inside[0]}: {{{key}: ...}}'"
        return f"known keys: {listing(keys, 20)}" if keys else "no keys are needed here"

    @classmethod
    def spelled_out(cls, word: str) -> str | None:
        """The key and value that a bare word stands for: one of the keys, or a choice that a key offers."""
        keys = cls.keys()
        if key := nearest(word, cls.one_of):
            inner = node_of(cls, keys[key])
            return (inner.example or f"{key}: {{}}") if inner else f"{key}: ..."
        for key, name in keys.items():
            annotation = cls.model_fields[name].annotation
            choices = get_args(annotation) if get_origin(annotation) is Literal else ()
            if choice := nearest(word, choices):
                return f"{key}: {choice}"
        return None

    @classmethod
    def _for_word(cls, word: str) -> str | None:
        """The help for a bare word in place of the mapping."""
        if help := blank_after_colon(word, cls.keys()) or cls.hints.get(word):
            return help
        written = cls.spelled_out(word)
        if written is None:
            return None
        if cls.example.startswith("- "):
            return f"write '- {written}'"
        outer = cls.example.partition(":")[0]
        named = outer not in set(cls.keys())
        return f"write '{outer}: {{{written}}}'" if named else f"write '{{{written}}}'"

    @classmethod
    def _for_example(cls) -> str | None:
        return f"for example {cls.example}" if cls.example else None

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        schema = handler.resolve_ref_schema(handler(core_schema))
        if cls.one_of and not set(cls.one_of) <= set(schema.get("required", ())):
            schema["oneOf"] = [{"required": [key]} for key in cls.one_of]
        return schema


def node_of(cls: type[Node], name: str) -> type[Node] | None:
    """The Node that a field holds by itself (not in a list), if it holds one."""
    annotation = cls.model_fields[name].annotation
    for candidate in (annotation, *getattr(annotation, "__args__", ())):
        if isinstance(candidate, type) and issubclass(candidate, Node):
            return candidate
    return None


def raised(title: str, problems: list[Problem]) -> ValidationError:
    """Problems as the exception that pydantic passes outwards, putting its own location before each."""
    return ValidationError.from_exception_data(
        title,
        [
            InitErrorDetails(type=problem(p.message, p.help, key=p.key), loc=tuple(p.path), input=None)
            for p in problems
        ],
    )


def problems_of(error: ValidationError) -> list[Problem]:
    """The problems of a whole scene, each with its path from the top."""
    return [_translated(Node, detail) for detail in error.errors(include_url=False)]


def _translated(cls: type[Node], detail: Any) -> Problem:
    """One of pydantic's errors in our words. `cls` is the mapping around it."""
    kind, path, ctx, found = detail["type"], tuple(detail["loc"]), detail.get("ctx", {}), detail["input"]
    if kind == READY:
        return Problem(path, ctx["message"], ctx["help"], ctx["key"])
    name = next((part for part in reversed(path) if isinstance(part, str)), cls.what)
    match kind:
        case "missing":
            return Problem(path, f"{cls.what} needs the key '{path[-1]}'", cls._for_example())
        case "greater_than":
            message = f"{name} must be greater than {ctx['gt']:g}; this is {shown(found)}"
        case "greater_than_equal":
            message = f"{name} must be at least {ctx['ge']:g}; this is {shown(found)}"
        case "less_than":
            message = f"{name} must be less than {ctx['lt']:g}; this is {shown(found)}"
        case "less_than_equal":
            message = f"{name} must be at most {ctx['le']:g}; this is {shown(found)}"
        case "literal_error":
            options = re.findall(r"'([^']*)'", ctx["expected"])
            guess = nearest(found, options) if isinstance(found, str) else None
            message = f"{shown(found)} is not one of: {', '.join(options)}"
            if not isinstance(found, str):
                message = f"expected one of {', '.join(options)}; found {shown(found)}"
            if len(options) == 1:
                message = f"{name} can only be '{options[0]}', not {shown(found)}"
            return Problem(path, message, f"did you mean '{guess}'?" if guess else None)
        case "string_type":
            return Problem(path, f"expected text, found {shown(found)}", "put quotes around it")
        case "tuple_type" | "list_type":
            return Problem(
                path,
                f"expected a list, found {shown(found)}",
                "a list is written [a, b] or with '- '",
            )
        case "dict_type":
            message = f"expected a mapping of names, found {shown(found)}"
        case "string_pattern_mismatch" if path[-1] == "[key]":
            dash = ", -" if "-]" in ctx["pattern"] else ""
            help = f"a name starts with a letter and goes on with letters, digits{dash} or _"
            return Problem(path[:-1], f"'{found}' cannot be a name", help, True)
        case _:
            message = f"{name}: {detail['msg']}"
    return Problem(path, message)


def _and(words: list[str]) -> str:
    return " and ".join(f"'{word}'" for word in words)


def _or(words: list[str]) -> str:
    return " or ".join(f"'{word}'" for word in words)
