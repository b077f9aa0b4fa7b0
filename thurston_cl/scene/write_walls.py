"""OpenCL text for the walls of a cell: is a point outside, lead it back, how far is the next wall?

Opposite walls share their work, and entries of a map that are 0 or +-1 cost nothing.
"""

import numpy as np
from numpy.typing import NDArray

from thurston_cl.lattice import Lattice
from thurston_cl.scene.numbers import Numbers, components
from thurston_cl.scene.writer import Writer

Array = NDArray[np.float64]

P = components("p")


def write_walls(writer: Writer) -> None:
    """Add outside_cell, teleport and, where rays creep over walls, wall_time."""
    lattice, numbers = writer.lattice, writer.numbers
    if lattice is None:
        return
    writer.function("mask outside_cell(point p, scene_data scene)", _outside(lattice, numbers))
    writer.function("void teleport(ray *r, scene_data scene)", _teleport(lattice, numbers, writer.cell_ids))
    if writer.creeping:
        writer.function("real wall_time(point p, vector v, scene_data scene)", _wall_time(lattice, numbers))


def _groups(walls: Array) -> list[tuple[int, ...]]:
    """Opposite walls, which share the linear form n . x, in pairs; the others alone."""
    left = list(range(len(walls)))
    groups: list[tuple[int, ...]] = []
    while left:
        f = left.pop(0)
        mirrored = walls[f] * np.array([-1, -1, -1, 1])
        opposite = next((g for g in left if np.allclose(walls[g], mirrored, rtol=0, atol=1e-14)), None)
        if opposite is None:
            groups.append((f,))
        else:
            left.remove(opposite)
            groups.append((f, opposite))
    return groups


# A wall map with more entries than this other than 0 and +-1 is worked out only where some lane needs it.
DENSE = 6


def _outside(lattice: Lattice, numbers: Numbers) -> list[str]:
    """The body of outside_cell: is a point beyond any wall?"""
    by_offset: dict[float, str] = {}
    for group in _groups(lattice.walls):
        wall = lattice.walls[group[0]]
        form = numbers.linear(wall[:3], P[:3])
        form = f"fabs({form})" if len(group) == 2 else form
        offset = round(float(wall[3]), 14)
        by_offset[offset] = f"fmax({by_offset[offset]}, {form})" if offset in by_offset else form
    heights = [numbers.linear([1.0, offset], (f"({form})", "p.w")) for offset, form in by_offset.items()]
    highest = heights[0]
    for height in heights[1:]:
        highest = f"fmax({highest}, {height})"
    return [f"return {highest} > wall_slack(p);"]


def _teleport(lattice: Lattice, numbers: Numbers, cells: bool) -> list[str]:
    """The body of teleport: one pass over the walls; lanes beyond one are led back by its map."""
    lines = ["real slack = wall_slack(r->p);"]
    for group in _groups(lattice.walls):
        wall = lattice.walls[group[0]]
        form = numbers.linear(wall[:3], components("r->p")[:3])
        offset = numbers.linear(wall[3:], ("r->p.w",))
        maps = [lattice.maps[f] for f in group]
        lines.append("{")
        lines.append(f"  real along = {form};")
        height = "fabs(along)" if len(group) == 2 else "along"
        lines.append(f"  mask beyond = {height} + {offset} > slack;")
        entries = maps[0][(maps[0] != 0) & (np.abs(maps[0]) != 1)]
        dense = len(entries) > DENSE
        if dense:
            lines.append("  if (ANY(beyond)) {")
        if len(group) == 2:
            lines.append("  mask plus = along > REAL(0);")
        matrix = [
            [_entry(lines, [m[i, j] for m in maps], f"m{i}{j}", numbers) for j in range(4)] for i in range(4)
        ]
        for name in ("r->p", "r->v"):
            rows = [(k, _product(row, components(name))) for k, row in enumerate(matrix)]
            changed = [
                (axis, text) for (k, text), axis in zip(rows, "xyzw", strict=True) if text != f"{name}.{axis}"
            ]
            lines.append("  {")
            lines += [f"    real {axis} = {text};" for axis, text in changed]
            lines += [f"    {name}.{axis} = SELECT(beyond, {axis}, {name}.{axis});" for axis, _ in changed]
            lines.append("  }")
        if cells:
            crossed = (
                [("beyond & plus", group[0]), ("beyond & NOT(plus)", group[1])]
                if len(group) == 2
                else [("beyond", group[0])]
            )
            lines += [f"  r->cell = cell_behind(r->cell, {mask}, {f}, scene);" for mask, f in crossed]
        lines.append("  }}" if dense else "}")
    return lines


def _entry(lines: list[str], values: list[float], name: str, numbers: Numbers) -> float | str:
    """One entry of a map: a plain 0, 1 or -1, or the name of a number that depends on the side."""
    if len(set(values)) == 1 and values[0] in (0.0, 1.0, -1.0):
        return float(values[0])
    texts = [numbers.term(value) for value in values]
    chosen = texts[0] if values[0] == values[-1] else f"SELECT(plus, {texts[0]}, {texts[1]})"
    lines.append(f"  real {name} = {chosen};")
    return name


def _product(row: list[float | str], variables: tuple[str, ...]) -> str:
    text = ""
    for entry, variable in reversed(list(zip(row, variables, strict=True))):
        if entry == 0:
            continue
        if isinstance(entry, str):
            text = f"fma({entry}, {variable}, {text})" if text else f"{entry} * {variable}"
        elif entry == 1:
            text = f"{variable} + {text}" if text else variable
        else:
            text = f"{text} - {variable}" if text else f"-{variable}"
    return text or "REAL(0)"


def _wall_time(lattice: Lattice, numbers: Numbers) -> list[str]:
    """The body of wall_time: arc length to the nearest wall ahead, from the greatest (n . v)/(-n . p)."""
    # To just beyond where a point counts as outside: a ray along a wall would crawl if it could stop on it.
    lines = ["real beyond = REAL(2) * wall_slack(p);"]
    ratios: list[str] = []
    for k, group in enumerate(_groups(lattice.walls)):
        wall = lattice.walls[group[0]]
        for name, variable in (("p", "height"), ("v", "rate")):
            lines.append(f"real {variable}{k} = {numbers.linear(wall[:3], components(name)[:3])};")
            lines.append(f"real {variable}_w{k} = {numbers.linear(wall[3:], (f'{name}.w',))};")
        for sign in ("+", "-")[: len(group)]:
            rate = f"(rate_w{k} {sign} rate{k})"
            ratios.append(f"{rate} / fmax(beyond - (height_w{k} {sign} height{k}), REAL(EPSILON))")
    lines.append(f"real ratio = {ratios[0]};")
    lines += [f"ratio = fmax(ratio, {ratio});" for ratio in ratios[1:]]
    lines.append("return crossing_time(ratio);")
    return lines
