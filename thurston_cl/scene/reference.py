"""The tables of docs/scene.md, made from the models: every key is documented, and none that is not there.

python -m thurston_cl.scene.reference docs/scene.md      # bring the file up to date
"""

import re
import sys
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from .base import Node, shown
from .schema import Scene
from .values import Color, Says

BEGIN = (
    "<!-- The tables below are made from the models; "
    "`python -m thurston_cl.scene.reference docs/scene.md` renews them. -->"
)


def scene_reference() -> str:
    """Markdown with one table for each mapping of a scene, the outermost first."""
    return "\n\n".join(_section(model) for model in models_of_scenes())


def renewed(page: str) -> str:
    """The page with the part below BEGIN replaced by the tables as they are now."""
    return f"{page.partition(BEGIN)[0]}{BEGIN}\n\n{scene_reference()}\n"


def models_of_scenes() -> list[type[Node]]:
    """Every model that a scene can hold, each followed by those inside it."""
    found: list[type[Node]] = []

    def visit(model: type[Node]) -> None:
        if model not in found:
            found.append(model)
            for info in model.model_fields.values():
                for inner in _models_in(_whole(info)):
                    visit(inner)

    visit(Scene)
    return found


def _models_in(annotation: Any) -> Iterator[type[Node]]:
    if isinstance(annotation, type) and issubclass(annotation, Node):
        yield annotation
    for argument in get_args(annotation):
        yield from _models_in(argument)


def _section(model: type[Node]) -> str:
    parent = next((base for base in model.__bases__ if issubclass(base, Node) and base.model_fields), None)
    inherited = set(parent.model_fields) if parent else set()
    lines = [f"### {_heading(model)}", "", " ".join((model.__doc__ or "").split())]
    if parent:
        lines += ["", f"Has all keys of a {_link(parent)}, and these:"]
    elif len(model.one_of) > 1:
        lines += ["", f"Exactly one of {', '.join(f'`{key}`' for key in model.one_of)} is given."]
    if model.example:
        lines += ["", f"Example: `{model.example.removeprefix('- ')}`"]
    rows = [
        f"| `{info.alias or name}` | {_words(_whole(info))} | {_default(model, info)} | {info.description} |"
        for name, info in model.model_fields.items()
        if name not in inherited
    ]
    if rows:
        lines += ["", "| key | value | default | meaning |", "|---|---|---|---|", *rows]
    return "\n".join(lines)


def _heading(model: type[Node]) -> str:
    special = {"HalfSpace": "Half-space"}
    return special.get(model.__name__, re.sub(r"(?<=[a-z])(?=[A-Z])", " ", model.__name__).capitalize())


def _link(model: type[Node]) -> str:
    heading = _heading(model).lower()
    return f"[{heading}](#{heading.replace(' ', '-')})"


def _whole(info: FieldInfo) -> Any:
    """The annotation of a field with what pydantic took off it."""
    annotation: Any = info.annotation
    for metadata in info.metadata:
        annotation = Annotated[annotation, metadata]
    return annotation


def _words(annotation: Any) -> str:
    """What a field accepts, in words."""
    if get_origin(annotation) is Annotated:
        # The last word counts: `Positive` is a `Number` that says more.
        for metadata in reversed(annotation.__metadata__):
            if isinstance(metadata, Says):
                return metadata.words.replace("|", "\\|")
        return _words(annotation.__origin__)
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin in (Union, types.UnionType):
        return " or ".join(_words(argument) for argument in arguments if argument is not type(None))
    if origin is Literal:
        return ", ".join(f"`{choice}`" for choice in arguments)
    if origin is tuple:
        return f"list of {_words(arguments[0])}"
    if isinstance(annotation, type) and issubclass(annotation, Node):
        return _link(annotation)
    if annotation is str:
        return "text"
    raise TypeError(f"no words for {annotation}; add a Says(...)")


def _default(model: type[Node], info: FieldInfo) -> str:
    if info.is_required():
        return "needed" if len(model.one_of) < 2 else ""
    if isinstance(info.json_schema_extra, dict):
        return f"`{info.json_schema_extra['default']}`"
    if isinstance(info.default, Node):
        return "its defaults"
    return f"`{_written(info.default)}`" if info.default not in (None, "", (), {}) else ""


def _written(value: Any) -> str:
    """A default as a scene would say it."""
    if isinstance(value, Color):
        return f'"{value.written}"' if value.written.startswith("#") else value.written
    if isinstance(value, tuple):
        return f"[{', '.join(_written(item) for item in value)}]"
    if isinstance(value, bool):
        return shown(value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def main() -> None:
    """Renew the page named on the command line."""
    page = Path(sys.argv[1])
    page.write_text(renewed(page.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
