"""OpenCL text for the walls of a cell: is a point outside, lead it back, how far is the next wall?

Opposite walls share their work, and entries of a map that are 0 or +-1 cost nothing.
"""

from functools import reduce

import numpy as np
from numpy.typing import NDArray

from thurston_cl.lattice import Lattice
from thurston_cl.lattice.isometry import fibre, vector_map
from thurston_cl.models import TWISTED
from thurston_cl.scene.numbers import ONE, Numbers, components, homogeneous
from thurston_cl.scene.writer import Writer

Array = NDArray[np.float64]

# Homogeneous coordinates that change sign from a wall to the opposite one; the others keep it.
ODD = {4: (0, 1, 2), 5: (0, 1, 3)}
EVEN = {4: (3,), 5: (2, 4)}


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
    """Opposite walls, which share the form over the odd coordinates, in pairs; the others alone."""
    sides = np.ones(walls.shape[1])
    sides[list(ODD[walls.shape[1]])] = -1.0
    left = list(range(len(walls)))
    groups: list[tuple[int, ...]] = []
    while left:
        f = left.pop(0)
        mirrored = walls[f] * sides
        opposite = next((g for g in left if np.allclose(walls[g], mirrored, rtol=0, atol=1e-14)), None)
        if opposite is None:
            groups.append((f,))
        else:
            left.remove(opposite)
            groups.append((f, opposite))
    return groups


def _odd(wall: Array, numbers: Numbers, name: str) -> str:
    """The part of a wall's form that opposite walls share but for its sign."""
    odd, variables = ODD[len(wall)], homogeneous(name, len(wall))
    return numbers.linear(wall[list(odd)], [variables[k] for k in odd])


def _even(wall: Array, numbers: Numbers, name: str) -> str:
    """The part of a wall's form that opposite walls share with its sign."""
    even, variables = EVEN[len(wall)], homogeneous(name, len(wall))
    return numbers.linear(wall[list(even)], [variables[k] for k in even])


# A wall map with more entries than this other than 0 and +-1 is worked out only where some lane needs it.
DENSE = 6
# The room of a ray where no wall ends it.
NO_WALL = "REAL(INFINITY)"


def _outside(lattice: Lattice, numbers: Numbers) -> list[str]:
    """The body of outside_cell: is a point beyond any wall?"""
    dimension = lattice.walls.shape[1]
    even, variables = EVEN[dimension], homogeneous("p", dimension)
    by_offset: dict[tuple[float, ...], str] = {}
    for group in _groups(lattice.walls):
        wall = lattice.walls[group[0]]
        form = _odd(wall, numbers, "p")
        form = f"fabs({form})" if len(group) == 2 else form
        offset = tuple(round(float(wall[k]), 14) for k in even)
        by_offset[offset] = f"fmax({by_offset[offset]}, {form})" if offset in by_offset else form
    heights = [
        numbers.linear([1.0, *offset], (f"({form})", *(variables[k] for k in even)))
        for offset, form in by_offset.items()
    ]
    highest = heights[0]
    for height in heights[1:]:
        highest = f"fmax({highest}, {height})"
    return [f"return {highest} > wall_slack(p);"]


def _teleport(lattice: Lattice, numbers: Numbers, cells: bool) -> list[str]:
    """The body of teleport: one pass over the walls, in order, in sol over the levels first; lanes beyond one
    are led back by its map.
    """
    lines = ["real slack = wall_slack(r->p);"]
    dimension = lattice.walls.shape[1]
    groups = _groups(lattice.walls)
    if lattice.geometry == "sol":
        groups = [group for group in groups if group[0] in lattice.level_walls]
    for group in groups:
        wall = lattice.walls[group[0]]
        maps = lattice.maps[list(group)]
        on_vectors = vector_map(lattice.geometry, maps)
        lines.append("{")
        lines.append(f"  real along = {_odd(wall, numbers, 'r->p')};")
        height = "fabs(along)" if len(group) == 2 else "along"
        lines.append(f"  mask beyond = {height} + {_even(wall, numbers, 'r->p')} > slack;")
        gains = lattice.geometry == "sl2" and bool(np.any(maps[:, 2, :2]))
        dense = gains or np.count_nonzero((maps[0] != 0) & (np.abs(maps[0]) != 1)) > DENSE
        if dense:
            lines.append("  if (ANY(beyond)) {")
        if len(group) == 2:
            lines.append("  mask plus = along > REAL(0);")
        matrix = _entries(lines, "m", maps[:, :4], numbers)
        same = np.array_equal(on_vectors, maps[:, :4, :4])
        turn = [row[:4] for row in matrix] if same else _entries(lines, "n", on_vectors, numbers)
        gain = ", ".join(_value(entry) for entry in (*matrix[2][:3], matrix[3][3])) if gains else ""
        lines += _move("r->p", matrix, homogeneous("r->p", dimension), gain)
        lines += _move("r->v", turn, components("r->v"))
        if cells:
            crossed = (
                [("beyond & plus", group[0]), ("beyond & NOT(plus)", group[1])]
                if len(group) == 2
                else [("beyond", group[0])]
            )
            lines += [f"  r->cell = cell_behind(r->cell, {mask}, {f}, scene);" for mask, f in crossed]
        lines.append("  }}" if dense else "}")
    return lines + _slide(lattice, numbers, cells) if lattice.geometry == "sol" else lines


def _pairs_of_sides(lattice: Lattice) -> list[tuple[int, ...]]:
    """The sides of a lattice of sol, each with the opposite one."""
    return [(f, f + 1) for f in range(0, len(lattice.walls) - len(lattice.level_walls), 2)]


def _slide(lattice: Lattice, numbers: Numbers, cells: bool) -> list[str]:
    """Lines that lead lanes back over the sides of sol by as many translations as it takes: what a level
    stretches reaches over many of them. One pair does not move lanes over the other.
    """
    lines: list[str] = []
    for f, g in _pairs_of_sides(lattice):
        wall, low, high = lattice.walls[f], float(lattice.walls[g, 3]), -float(lattice.walls[f, 3])
        along = numbers.linear([*wall[:2], -0.5 * (low + high)], ("r->p.x", "r->p.y", ONE))
        lines += [
            "{",
            f"  real along = {along};",
            # Half the slack: whatever is outside for outside_cell, which rounds in another way, is moved.
            f"  mask beyond = fabs(along) > fma(slack, REAL(C(0.5)), {numbers.term(0.5 * (high - low))});",
            f"  real moves = SELECT(beyond, rint(along * {numbers.term(1.0 / (high - low))}), REAL(0));",
        ]
        for axis, shift in zip("xy", lattice.maps[f, :2, 3], strict=True):
            if shift != 0:
                lines.append(f"  r->p.{axis} = {numbers.linear([shift, 1.0], ('moves', f'r->p.{axis}'))};")
        if cells:
            lines += [
                f"  r->cell = cell_behind_all(r->cell, {crossings}, {side}, scene);"
                for crossings, side in (("moves", f), ("-moves", g))
            ]
        lines.append("}")
    return lines


def _move(
    name: str, matrix: list[list[float | str]], variables: tuple[str, ...], gain: str = ""
) -> list[str]:
    """Lines that lead the point or vector `name` back by a matrix in the lanes of `beyond`."""
    rows = [_product(row, variables) for row in matrix]
    changed = [
        (axis, text) for axis, text in zip("xyzw", rows, strict=True) if gain or text != f"{name}.{axis}"
    ]
    lines = [f"    real {axis} = {text};" for axis, text in changed]
    if gain:
        lines.append(f"    w = with_fibre_gain({name}, (point){{x, y, z, w}}, {gain}).w;")
    lines += [f"    {name}.{axis} = SELECT(beyond, {axis}, {name}.{axis});" for axis, _ in changed]
    return ["  {", *lines, "  }"] if lines else []


def _entries(lines: list[str], name: str, maps: Array, numbers: Numbers) -> list[list[float | str]]:
    """The entries of one map, or of two of which `plus` chooses: plain 0, 1 or -1, or names of numbers."""
    return [
        [_entry(lines, maps[:, i, j], f"{name}{i}{j}", numbers) for j in range(maps.shape[2])]
        for i in range(maps.shape[1])
    ]


def _entry(lines: list[str], values: Array, name: str, numbers: Numbers) -> float | str:
    if len(set(values)) == 1 and values[0] in (0.0, 1.0, -1.0):
        return float(values[0])
    texts = [numbers.term(float(value)) for value in values]
    chosen = texts[0] if values[0] == values[-1] else f"SELECT(plus, {texts[0]}, {texts[1]})"
    lines.append(f"  real {name} = {chosen};")
    return name


def _value(entry: float | str) -> str:
    return entry if isinstance(entry, str) else f"REAL({int(entry)})"


def _product(row: list[float | str], variables: tuple[str, ...]) -> str:
    text = ""
    for entry, variable in reversed(list(zip(row, variables, strict=True))):
        if entry == 0:
            continue
        if variable == ONE:
            text = _value(entry)
        elif isinstance(entry, str):
            text = f"fma({entry}, {variable}, {text})" if text else f"{entry} * {variable}"
        elif entry == 1:
            text = f"{variable} + {text}" if text else variable
        else:
            text = f"{text} - {variable}" if text else f"-{variable}"
    return text or "REAL(0)"


def _wall_time(lattice: Lattice, numbers: Numbers) -> list[str]:
    """The body of wall_time: arc length to the nearest wall ahead, or in nil, sl2 and sol a bound of it."""
    # To just beyond where a point counts as outside: a ray along a wall would crawl if it could stop on it.
    lines = ["real beyond = REAL(2) * wall_slack(p);"]
    times: list[str] = []
    sides = [f for f in range(len(lattice.walls)) if f not in lattice.level_walls]
    if lattice.geometry == "sol":
        times += _sides_of_sol(lattice, lines, numbers)
    elif sides:
        lines += _crossing(lattice.walls[sides], lattice.geometry, numbers)
        times.append("crossing_time(ratio, v)")
    if lattice.level_walls:
        up = fibre(lattice.geometry)
        left = {"above": NO_WALL, "below": NO_WALL}
        for f in lattice.level_walls:
            wall = lattice.walls[f]
            side, sign = ("above", "-") if wall[up] > 0 else ("below", "+")
            left[side] = _room(-float(wall[-1]), sign, components("p")[up], numbers)
        times.append(f"level_time(p, v, {left['above']}, {left['below']})")
    lines.append(f"return {reduce(lambda least, time: f'fmin({least}, {time})', times)};")
    return lines


def _room(end: float, sign: str, height: str, numbers: Numbers) -> str:
    """How far a height may rise (-) or fall (+) to just beyond a wall at `end`, counted from 0 that way."""
    return f"fmax({numbers.term(end)} {sign} {height} + beyond, REAL(EPSILON))"


def _sides_of_sol(lattice: Lattice, lines: list[str], numbers: Numbers) -> list[str]:
    """The times to the sides of sol, pair by pair; adds lines for the heights over them."""
    times = []
    for k, (f, g) in enumerate(_pairs_of_sides(lattice)):
        wall = lattice.walls[f]
        lines.append(f"real along{k} = {numbers.linear(wall[:2], ('p.x', 'p.y'))};")
        normal = ", ".join(numbers.term(float(entry)) for entry in wall[:2])
        above = _room(-float(wall[3]), "-", f"along{k}", numbers)
        below = _room(-float(lattice.walls[g, 3]), "+", f"along{k}", numbers)
        times.append(f"side_time(p, v, {normal}, {above}, {below})")
    return times


def _crossing(walls: Array, geometry: str, numbers: Numbers) -> list[str]:
    """Lines that find the greatest wall_ratio of walls over the base."""
    lines = ["vector ahead = wall_velocity(p, v);"]
    rates = [("p", "height"), ("ahead", "rate")]
    if geometry in TWISTED:
        lines.append("vector aside = wall_turning(p, v);")
        rates.append(("aside", "turning"))
    ratios: list[str] = []
    for k, group in enumerate(_groups(walls)):
        # A velocity has no fifth coordinate.
        wall = walls[group[0]]
        for name, variable in rates:
            form = wall if name == "p" else np.append(wall[:4], np.zeros(len(wall) - 4))
            lines.append(f"real {variable}{k} = {_odd(form, numbers, name)};")
            lines.append(f"real {variable}_w{k} = {_even(form, numbers, name)};")
        for sign in ("+", "-")[: len(group)]:
            height = f"fmax(beyond - (height_w{k} {sign} height{k}), REAL(EPSILON))"
            turning = f"turning_w{k} {sign} turning{k}" if len(rates) == 3 else "REAL(0)"
            ratios.append(f"wall_ratio(v, {height}, rate_w{k} {sign} rate{k}, {turning})")
    lines.append(f"real ratio = {ratios[0]};")
    lines += [f"ratio = fmax(ratio, {ratio});" for ratio in ratios[1:]]
    return lines
