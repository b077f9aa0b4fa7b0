"""What single values of a scene need to know of the rest of it, so that one pass finds every mistake."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, TypeVar

from pydantic import BaseModel, ValidationError, ValidationInfo

from thurston_cl.models import GEOMETRIES

from .picture import DEFAULT_SIZES, GRIDS

if TYPE_CHECKING:
    from thurston_cl.lattice import Lattice

Model = TypeVar("Model", bound=BaseModel)


@dataclass
class Context:
    """Facts about a scene taken from its values before they are checked.

    `geometry` is None where it is not known, and then checks that depend on it are left out."""

    geometry: str | None = None
    manifold: bool = False
    sections: dict[str, Mapping[str, Any]] = field(
        default_factory=dict
    )  # "materials", "textures": as written
    # What decides the shape of the picture; as the defaults have it where it is wrong.
    projection: str = "perspective"
    layout: str | None = None
    lattice: "Lattice | None" = None  # of the scene's manifold, once that is checked
    folder: Path = field(default_factory=Path.cwd)  # of the scene, from which the files are that it names
    _entries: dict[tuple[str, str], Any] = field(default_factory=dict)
    # Entries that are being checked, and those that were found to lead back to themselves.
    _open: set[tuple[str, str]] = field(default_factory=set)
    _endless: set[tuple[str, str]] = field(default_factory=set)

    @classmethod
    def of(cls, data: Mapping[str, Any], folder: Path | None = None) -> Self:
        """The context of a scene that is not checked yet, in a folder (default: the current one)."""
        geometry = data.get("geometry")
        sections = {name: data.get(name) for name in ("materials", "textures")}
        camera = _mapping(data, "camera")
        layout = _mapping(camera, "stereo").get("layout")
        return cls(
            projection=next(
                (key for key in _mapping(camera, "projection") if key in DEFAULT_SIZES), "perspective"
            ),
            layout=layout if isinstance(layout, str) and layout in GRIDS else None,
            geometry=geometry if geometry in GEOMETRIES else None,
            manifold=data.get("manifold") is not None,
            sections={name: section for name, section in sections.items() if isinstance(section, dict)},
            folder=Path.cwd() if folder is None else folder.absolute(),
        )

    def names(self, section: str) -> list[str]:
        """The names that a section of the scene defines."""
        return list(self.sections.get(section, ()))

    def contains_itself(self, section: str, name: str) -> bool:
        """Whether an entry that was looked up leads back to itself."""
        return (section, name) in self._endless

    def entry(self, section: str, name: str, model: type[Model]) -> Model | None:
        """The named entry of a section; None if it is wrong, which is reported where it stands."""
        if (section, name) in self._open:
            self._endless.add((section, name))
            return None
        if (section, name) not in self._entries:
            self._open.add((section, name))
            try:
                entry = model.model_validate(self.sections[section][name], context=self)
            except ValidationError:
                entry = None
            self._open.discard((section, name))
            self._entries[section, name] = entry
        found: Model | None = self._entries[section, name]
        return found


def _mapping(data: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    value = data.get(key)
    return value if isinstance(value, dict) else {}


def context_of(info: ValidationInfo) -> Context:
    """The context in a validator; an empty one for values made in Python."""
    return info.context if isinstance(info.context, Context) else Context()
