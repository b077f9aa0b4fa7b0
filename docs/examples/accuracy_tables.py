"""Print tables A1 to A4 of the paper beside what is measured here, in Markdown for docs/accuracy.md.

    python docs/examples/accuracy_tables.py

Nil (A1, A2) by the second-order equation in coordinates, SL2 (A3, A4) by the first-order system on Q. Each
number is "measured (paper)". The paper counts directions off above 60 degrees in A2 and above 40 in A4.
"""

from typing import NamedTuple

import numpy as np

from thurston_cl.accuracy.directions import uniform
from thurston_cl.accuracy.protocol import DIRECTIONS, angle_errors, distance_errors
from thurston_cl.geometry import Geometry

NAMES = {"euler": "Euler", "rk2": "Runge–Kutta 2", "rk4": "Runge–Kutta 4"}
HEADINGS = ("Method", "Δt", "max distance", "mean distance", "off", "max angle/°", "mean angle/°")


class Table(NamedTuple):
    """One of the paper's tables: its rows by method and step, in the order of HEADINGS."""

    name: str
    geometry: str
    equation: str
    time: float
    off_above: float
    rows: dict[tuple[str, float], tuple[float, ...]]


TABLES = (
    Table("A1", "nil", "coordinates", 6.0, 60.0, {
        ("euler", 0.1): (8.4e-1, 5.2e-1, 0, 8.7e0, 4.4e0),
        ("euler", 0.01): (8.6e-2, 5.2e-2, 0, 9.4e-1, 4.8e-1),
        ("rk2", 0.1): (9.3e-3, 5.0e-3, 0, 1.7e-1, 3.1e-2),
        ("rk2", 0.01): (9.6e-5, 5.1e-5, 0, 1.7e-3, 3.0e-4),
        ("rk4", 0.1): (8.2e-6, 4.2e-6, 0, 8.1e-5, 1.8e-5),
        ("rk4", 0.01): (8.2e-10, 4.2e-10, 0, 2.7e-8, 1.2e-9),
    }),
    Table("A2", "nil", "coordinates", 10.0, 60.0, {
        ("euler", 0.1): (3.8e0, 2.2e0, 690, 6.0e1, 1.4e1),
        ("euler", 0.01): (4.3e-1, 2.2e-1, 71, 5.3e1, 2.4e0),
        ("rk2", 0.1): (3.1e-2, 1.4e-2, 186, 2.5e0, 7.5e-2),
        ("rk2", 0.01): (3.3e-4, 1.4e-4, 19, 1.5e-1, 9.8e-4),
        ("rk4", 0.1): (2.8e-5, 1.2e-5, 0, 2.0e-2, 5.7e-5),
        ("rk4", 0.01): (2.8e-9, 1.2e-9, 0, 3.5e-6, 4.5e-9),
    }),
    Table("A3", "sl2", "left-invariant", 6.0, 40.0, {
        ("euler", 0.1): (3.7e0, 2.7e0, 0, 5.2e1, 5.4e0),
        ("euler", 0.01): (6.6e-1, 3.9e-1, 0, 2.7e0, 7.1e-1),
        ("rk2", 0.1): (4.8e-2, 2.8e-2, 0, 1.0e0, 1.3e-1),
        ("rk2", 0.01): (6.6e-4, 3.6e-4, 0, 9.4e-3, 1.2e-3),
        ("rk4", 0.1): (4.1e-5, 2.4e-5, 0, 2.0e-3, 1.8e-4),
        ("rk4", 0.01): (4.7e-9, 2.3e-9, 0, 1.9e-7, 1.3e-8),
    }),
    Table("A4", "sl2", "left-invariant", 10.0, 40.0, {
        ("euler", 0.1): (1.1e1, 7.9e0, 594, 4.0e1, 8.3e0),
        ("euler", 0.01): (6.2e0, 3.6e0, 74, 3.7e1, 2.2e0),
        ("rk2", 0.1): (9.0e-1, 3.3e-1, 180, 4.0e1, 5.9e-1),
        ("rk2", 0.01): (1.3e-2, 4.7e-3, 25, 3.4e-1, 2.9e-3),
        ("rk4", 0.1): (8.6e-4, 3.6e-4, 0, 2.8e-1, 9.1e-4),
        ("rk4", 0.01): (7.4e-8, 3.1e-8, 0, 1.1e-4, 7.5e-8),
    }),
)  # fmt: skip


def main() -> None:
    vectors = uniform(DIRECTIONS).vectors
    for table in TABLES:
        exact = Geometry(table.geometry)
        truth = exact.flow(vectors, table.time)[0]
        print(f"Table {table.name}: {table.geometry}, t = {table.time:g}\n")
        print("| " + " | ".join(HEADINGS) + " |\n|" + "---|" * len(HEADINGS))
        for (flow, step), paper in table.rows.items():
            method = Geometry(table.geometry, flow=flow, step=step, equation=table.equation)
            points = method.flow(vectors, table.time)[0]
            distances = distance_errors(exact, truth, points)
            angles = np.degrees(angle_errors(exact, vectors, points, table.time))
            near = angles[angles <= table.off_above]
            here = (distances.max(), distances.mean(), len(angles) - len(near), near.max(), near.mean())
            forms = ["d" if heading == "off" else ".1e" for heading in HEADINGS[2:]]
            cells = [f"{a:{form}} ({b:{form}})" for a, b, form in zip(here, paper, forms, strict=True)]
            print("| " + " | ".join([NAMES[flow], f"{step:g}", *cells]) + " |")
        print()


if __name__ == "__main__":
    main()
