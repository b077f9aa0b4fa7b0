"""What a scene remembers of the text it came from, so that later checks can still point at a line."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from .diagnostics import Diagnostic, SceneReport
from .parse import Location, Mistake, Place


@dataclass(frozen=True)
class SceneSource:
    """The text of a scene, what was changed on the way, and where everything stands."""

    name: str = "scene"  # as the user wrote it; for messages
    path: Path | None = None  # None if the scene was read from a pipe or made in Python
    text: str = ""
    places: Mapping[Location, Place] = field(default_factory=dict)
    defines: Mapping[str, str | float] = field(default_factory=dict)
    sets: tuple[str, ...] = ()
    substituted: Mapping[Location, str] = field(
        default_factory=dict
    )  # where a $name stood -> a note on its value

    def diagnostic(
        self, location: Location, message: str, help: str | None = None, *, key: bool = False
    ) -> Diagnostic:
        """A mistake at a location such as ("objects", 0, "ball", "radius"): at its value, or key.

        What has no place of its own (a default, say) is shown at the nearest thing around it."""
        for end in range(len(location), -1, -1):
            place = self.places.get(location[:end])
            if place is None:
                continue
            note = next(
                (self.substituted[location[:n]] for n in range(end + 1) if location[:n] in self.substituted),
                "",
            )
            if note:
                message = f"{message} ({note})"
            if place.origin is not None:
                return Diagnostic(0, 0, message, help, place.origin)
            line, column = (
                place.key if key and place.key is not None and end == len(location) else place.value
            )
            return Diagnostic(line + 1, column + 1, message, help)
        return Diagnostic(0, 0, message, help)

    def at_mark(self, mistake: Mistake) -> Diagnostic:
        """A mistake found while reading this very text."""
        return Diagnostic(mistake.mark[0] + 1, mistake.mark[1] + 1, mistake.message, mistake.help)

    def report(self, diagnostics: list[Diagnostic]) -> SceneReport:
        """The error that shows all of these."""
        return SceneReport(self.name, self.text, diagnostics)


class Problems:
    """Collects mistakes found after loading, to raise them together."""

    def __init__(self, source: SceneSource):
        self.source = source
        self.diagnostics: list[Diagnostic] = []

    def add(self, location: Location, message: str, help: str | None = None, *, key: bool = False) -> None:
        """Note a mistake at a location of the scene; see `SceneSource.diagnostic`."""
        self.diagnostics.append(self.source.diagnostic(location, message, help, key=key))

    def raise_if_any(self) -> None:
        """Raise one SceneError with everything noted so far; do nothing if that is nothing."""
        if self.diagnostics:
            raise self.source.report(self.diagnostics)
