"""What is wrong with a scene, where, and what to type instead; the text of every scene error is made here."""

import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass

from thurston_cl.errors import SceneError

# A broken generator script can make thousands of mistakes; the count at the end is of all of them.
MAX_SHOWN = 100
# Longer source lines are cut around the caret, so that a scene written by a machine stays readable.
MAX_WIDTH = 110

# The line breaks that the YAML reader counts, so that line numbers agree with it.
_LINE_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")


@dataclass(frozen=True)
class Diagnostic:
    """One mistake. `line` and `column` count from 1; 0 means outside the file: see `origin`."""

    line: int
    column: int
    message: str
    help: str | None = None
    origin: str | None = None  # such as "--set render.samples=x" or "-D r=1"


class SceneReport(SceneError):
    """The scene is wrong: the text is the whole report, `diagnostics` lists the mistakes of file `name`."""

    def __init__(self, name: str, text: str, diagnostics: Iterable[Diagnostic]):
        self.name = name
        # A pair made of one number says the same thing twice.
        once = dict.fromkeys(diagnostics)
        self.diagnostics = sorted(once, key=lambda d: (d.origin is not None, d.line, d.column))
        lines = split_lines(text)
        shown = [_show(name, lines, diagnostic) for diagnostic in self.diagnostics[:MAX_SHOWN]]
        count = len(self.diagnostics)
        rest = f" (the first {MAX_SHOWN} are shown)" if count > MAX_SHOWN else ""
        super().__init__("\n".join([*shown, f"{count} error{'s' * (count != 1)} in {name}{rest}"]))


# A colour without its quotes, which YAML takes for a comment.
_BARE_COLOR = re.compile(r"[:\[,]\s+(#[0-9a-fA-F]{6}|#[0-9a-fA-F]{3})\b")


def split_lines(text: str) -> list[str]:
    """The lines of a text, broken where YAML breaks them."""
    return _LINE_BREAK.split(text)


def _show(name: str, lines: list[str], diagnostic: Diagnostic) -> str:
    if diagnostic.line == 0:
        head = [f"{diagnostic.origin or name}: error: {diagnostic.message}"]
    else:
        head = [f"{name}:{diagnostic.line}:{diagnostic.column}: error: {diagnostic.message}"]
        if diagnostic.line <= len(lines):
            line, before = _excerpt(lines[diagnostic.line - 1], diagnostic.column - 1)
            head += [f"{diagnostic.line:5} | {line}".rstrip(), f"      | {before}^"]
    comment = _BARE_COLOR.search(lines[diagnostic.line - 1]) if 0 < diagnostic.line <= len(lines) else None
    help = (
        f"'#' begins a comment; write the colour in quotes: \"{comment[1]}\"" if comment else diagnostic.help
    )
    if help:
        head.append(f"      = help: {help}")
    return "\n".join(head)


def _excerpt(line: str, column: int) -> tuple[str, str]:
    """The part of a line to show, and the blanks that put a caret below its given column."""
    start = 0
    if len(line) > MAX_WIDTH:
        start = max(0, min(column - MAX_WIDTH // 2, len(line) - MAX_WIDTH))
        end = start + MAX_WIDTH
        line = ("…" if start else "") + line[start:end] + ("…" if end < len(line) else "")
        start -= 1 if start else 0
    before = "".join(_blank(character) for character in line[: column - start])
    # A control character would reach the reader's terminal as a command.
    return "".join(c if c.isprintable() or c == "\t" else "\ufffd" for c in line), before


def _blank(character: str) -> str:
    """What covers the same width on a terminal as `character`, invisibly."""
    if character == "\t":
        return "\t"
    if unicodedata.combining(character):
        return ""
    return "  " if unicodedata.east_asian_width(character) in "WF" else " "
