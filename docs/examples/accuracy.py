"""Draws docs/accuracy.png, writes docs/accuracy.txt, the whole output of `thurston accuracy`, and prints the
tables A1 to A4 of the paper beside what was measured, for docs/accuracy.md.

    python docs/examples/accuracy.py            # some minutes on two cores
    python docs/examples/accuracy.py nil sl2    # the tables only
"""

import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from thurston_cl import device as devices
from thurston_cl.accuracy import plot, protocol, table
from thurston_cl.accuracy.directions import SEED
from thurston_cl.accuracy.protocol import Row
from thurston_cl.models import GEOMETRIES

FOLDER = Path(__file__).parents[1]
# By table: the geometry, the equation that is integrated, the time; and by flow and step the paper's time in
# seconds, maximal and mean distance error, directions off, maximal and mean angle error in degrees.
Entry = tuple[float, float, float, int, float, float]
PAPER: dict[tuple[str, str, str, float], dict[tuple[str, float], Entry]] = {
    ("A1", "nil", "coordinates", 6.0): {
        ("euler", 0.1): (12.0, 8.4e-1, 5.2e-1, 0, 8.7, 4.4),
        ("euler", 0.01): (115.3, 8.6e-2, 5.2e-2, 0, 9.4e-1, 4.8e-1),
        ("rk2", 0.1): (17.8, 9.3e-3, 5.0e-3, 0, 1.7e-1, 3.1e-2),
        ("rk2", 0.01): (176.0, 9.6e-5, 5.1e-5, 0, 1.7e-3, 3.0e-4),
        ("rk4", 0.1): (32.4, 8.2e-6, 4.2e-6, 0, 8.1e-5, 1.8e-5),
        ("rk4", 0.01): (323.3, 8.2e-10, 4.2e-10, 0, 2.7e-8, 1.2e-9),
    },
    ("A2", "nil", "coordinates", 10.0): {
        ("euler", 0.1): (20.4, 3.8, 2.2, 690, 60, 14),
        ("euler", 0.01): (191.8, 4.3e-1, 2.2e-1, 71, 53, 2.4),
        ("rk2", 0.1): (30.0, 3.1e-2, 1.4e-2, 186, 2.5, 7.5e-2),
        ("rk2", 0.01): (297.0, 3.3e-4, 1.4e-4, 19, 1.5e-1, 9.8e-4),
        ("rk4", 0.1): (54.7, 2.8e-5, 1.2e-5, 0, 2.0e-2, 5.7e-5),
        ("rk4", 0.01): (540.1, 2.8e-9, 1.2e-9, 0, 3.5e-6, 4.5e-9),
    },
    ("A3", "sl2", "left-invariant", 6.0): {
        ("euler", 0.1): (33.2, 3.7, 2.7, 0, 52, 5.4),
        ("euler", 0.01): (325.1, 6.6e-1, 3.9e-1, 0, 2.7, 7.1e-1),
        ("rk2", 0.1): (49.0, 4.8e-2, 2.8e-2, 0, 1.0, 1.3e-1),
        ("rk2", 0.01): (485.5, 6.6e-4, 3.6e-4, 0, 9.4e-3, 1.2e-3),
        ("rk4", 0.1): (83.9, 4.1e-5, 2.4e-5, 0, 2.0e-3, 1.8e-4),
        ("rk4", 0.01): (817.5, 4.7e-9, 2.3e-9, 0, 1.9e-7, 1.3e-8),
    },
    ("A4", "sl2", "left-invariant", 10.0): {
        ("euler", 0.1): (53.7, 11, 7.9, 594, 40, 8.3),
        ("euler", 0.01): (523.3, 6.2, 3.6, 74, 37, 2.2),
        ("rk2", 0.1): (78.5, 9.0e-1, 3.3e-1, 180, 40, 5.9e-1),
        ("rk2", 0.01): (775.1, 1.3e-2, 4.7e-3, 25, 3.4e-1, 2.9e-3),
        ("rk4", 0.1): (133.1, 8.6e-4, 3.6e-4, 0, 2.8e-1, 9.1e-4),
        ("rk4", 0.01): (1316.9, 7.4e-8, 3.1e-8, 0, 1.1e-4, 7.5e-8),
    },
}
# What the exact flow took there, in seconds.
PAPER_EXACT = {"A1": 0.2, "A2": 0.3, "A3": 0.8, "A4": 0.7}
NAMES = {"euler": "Euler", "rk2": "Runge-Kutta 2", "rk4": "Runge-Kutta 4"}


def tables(rows: Sequence[Row]) -> Iterator[str]:
    """The paper's tables in Markdown, each figure of the paper before the one that was measured."""
    for (name, geometry, equation, time), entries in PAPER.items():
        found = {
            (row.flow, row.step): row
            for row in rows
            if (row.geometry, row.time, row.directions, row.precision) == (geometry, time, "uniform", "double")
            and (row.flow == "exact" or row.equation == equation)
        }
        exact = found["exact", None]
        yield f"**{name}**: {geometry}, t = {time:g}"
        yield ""
        yield "| method | step | time / exact | max distance | mean | off | max angle | mean |"
        yield "|---|---|---|---|---|---|---|---|"
        for (flow, step), (seconds, *figures) in entries.items():
            row = found[flow, step]
            ratio = f"{seconds / PAPER_EXACT[name]:.0f} · {row.seconds / exact.seconds:.0f}"
            ours = (
                row.distance_max,
                row.distance_mean,
                row.off,
                row.angle_max,
                row.angle_mean,
            )
            cells = [
                f"{theirs} · {mine}" if isinstance(theirs, int) else f"{_short(theirs)} · {_short(mine)}"
                for theirs, mine in zip(figures, ours, strict=True)
            ]
            yield f"| {NAMES[flow]} | {step:g} | {ratio} | {' | '.join(cells)} |"
        yield ""


def _short(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.2g}"


def main() -> None:
    geometries = sys.argv[1:] or list(GEOMETRIES)
    device = devices.choose()

    def progress(done: int, total: int, what: str) -> None:
        print(f"{done}/{total} {what}", file=sys.stderr)

    rows = list(protocol.measure(geometries, device=device, progress=progress))
    if len(geometries) == len(GEOMETRIES):
        head = table.header(protocol.DIRECTIONS, SEED, device.info.name)
        (FOLDER / "accuracy.txt").write_text(table.text(rows, head) + "\n", encoding="utf-8")
        plot.plot(rows, str(FOLDER / "accuracy.png"))
    print("\n".join(tables(rows)))


if __name__ == "__main__":
    main()
