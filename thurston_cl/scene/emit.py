"""OpenCL text for the parts of a program that depend on the scene: objects, materials, walls. Formulas stay
in `kernels/`.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from thurston_cl.lattice import Lattice, elements
from thurston_cl.lattice.isometry import inverse, snap
from thurston_cl.scene import schema
from thurston_cl.scene.numbers import Numbers, components
from thurston_cl.scene.placement import Placement, turn_to

Array = NDArray[np.float64]

P = components("p")


@dataclass
class Solids:
    """Writes the signed distance and the surface of solids, and remembers which kernel files that takes."""

    numbers: Numbers
    place: Placement
    lattice: Lattice | None
    parts: set[str] = field(default_factory=set)

    def write(self, solid: schema.Solid, outer: Array) -> tuple[str, list[str], str]:
        """Distance text, statements that work out the surface, and the name of that surface.

        `outer` carries the frame of what the solid belongs to into the cell.
        """
        self._lines: list[str] = []
        self._count = 0
        distance, name = self._solid(solid, outer)
        return distance, self._lines, name

    def _solid(self, solid: schema.Solid, outer: Array) -> tuple[str, str]:
        frame = outer @ self.place.isometry(solid.at, solid.rotate)
        shape = solid.shape
        match solid.kind:
            case "union" | "difference" | "intersection" as kind:
                members = [self._solid(member, frame) for member in shape]
                if kind == "difference":
                    members[1:] = [self._complement(member) for member in members[1:]]
                minimum, combined = ("fmin", "union_of") if kind == "union" else ("fmax", "intersection_of")
                distance, name = members[0]
                for other, other_name in members[1:]:
                    distance = f"{minimum}({distance}, {other})"
                    name = self._let(f"{combined}({name}, {other_name})")
                return distance, name
            case "complement":
                return self._complement(self._solid(shape, frame))
            case "ball":
                return self._leaf("ball", frame, self.numbers.term(shape.radius))
            case "cylinder":
                return self._leaf("cylinder", frame @ turn_to(shape.along), self.numbers.term(shape.radius))
            case "half-space":
                lifted = self.place.isometry((0.0, 0.0, shape.offset))
                return self._leaf("half_space", frame @ turn_to(shape.normal) @ lifted)
            case "horoball":
                return self._leaf(
                    "horoball", frame @ turn_to(shape.towards), self.numbers.term(shape.distance)
                )
            case _:
                return self._tile(shape, frame)

    def _complement(self, member: tuple[str, str]) -> tuple[str, str]:
        distance, name = member
        return f"-({distance})", self._let(f"complement_of({name})")

    def _let(self, expression: str) -> str:
        self._count += 1
        name = f"s{self._count}"
        self._lines.append(f"surface {name} = {expression};")
        return name

    def _leaf(self, shape: str, frame: Array, *arguments: str) -> tuple[str, str]:
        """One shape about the origin of its own coordinates; `frame` carries these into the cell."""
        self.parts.add(f"shape/{shape}.h")
        matrix = snap(inverse(self.place.geometry.name, frame))
        if np.array_equal(matrix, np.eye(4)):
            point, pulled = "p", None
        else:
            self._count += 1
            point = f"(point){self.numbers.rows(matrix, P)}"
            pulled = matrix
        tail = "".join(f", {argument}" for argument in arguments)
        name = self._let(f"{shape}_surface({point}{tail})")
        if pulled is not None:
            gradient = self.numbers.rows(pulled.T, components(f"{name}.gradient"))
            self._lines.append(f"{name}.gradient = (covector){gradient};")
        return f"{shape}_distance({point}{tail})", name

    def _ball_set(self, centres: Array, radius: float) -> tuple[str, str]:
        self.parts.add("shape/ball_set.h")
        arguments = (
            f"(p, scene, {self.numbers.add(centres.ravel())}, {len(centres)}, {self.numbers.term(radius)})"
        )
        return f"ball_set_distance{arguments}", self._let(f"ball_set_surface{arguments}")

    def _tile(self, tile: schema.Tile, frame: Array) -> tuple[str, str]:
        """The cell minus balls: the walls of the cell are no surfaces, so only the balls are left (paper,
        figure 3).
        """
        assert self.lattice is not None
        members = [self._leaf("ball", frame, self.numbers.term(tile.ball))]
        polyhedron = self.lattice.polyhedron
        if tile.vertices is not None:
            members.append(self._ball_set(np.array([v.vector for v in polyhedron.vertices]), tile.vertices))
        if tile.edges is not None:
            members.append(self._ball_set(np.array([edge.point for edge in polyhedron.edges]), tile.edges))
        distance, name = members[0]
        for other, other_name in members[1:]:
            distance, name = f"fmin({distance}, {other})", self._let(f"union_of({name}, {other_name})")
        return self._complement((distance, name))


def write_paint(
    paint: "schema.Color | schema.Pattern", numbers: Numbers, parts: set[str], surface: str
) -> str:
    """The text of a colour or a pattern on a surface."""
    if isinstance(paint, schema.Color):
        return f"three_numbers(scene, {numbers.add(paint.linear)})"
    if paint.checker is not None:
        parts.add("pattern/checker.h")
        checker = paint.checker
        place = numbers.add([*checker.count, *checker.colors[0].linear, *checker.colors[1].linear])
        return f"checker({surface}, scene, {place})"
    assert paint.grid is not None
    parts.add("pattern/grid.h")
    grid = paint.grid
    place = numbers.add([*grid.count, grid.width, *grid.colors[0].linear, *grid.colors[1].linear])
    return f"grid({surface}, scene, {place})"


def write_material(material: schema.Material, numbers: Numbers, parts: set[str], surface: str) -> str:
    """The text of a material on a surface, as an initialiser."""
    place = numbers.add([material.ambient, material.diffuse, material.specular, material.shininess])
    shares = ", ".join(f"number(scene, {place + k})" for k in range(4))
    return f"{{{write_paint(material.color, numbers, parts, surface)}, {shares}}}"


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


def write_outside(lattice: Lattice, numbers: Numbers) -> list[str]:
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


def write_teleport(lattice: Lattice, numbers: Numbers, cells: bool) -> list[str]:
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
    """One entry of a map: a plain 0, 1 or -1, or the name of a number in all lanes that depends on the side.
    """
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


def write_wall_time(lattice: Lattice, numbers: Numbers) -> list[str]:
    """The body of wall_time: arc length to the nearest wall ahead, from the greatest (n . v)/(-n . p)."""
    lines = []
    ratios: list[str] = []
    for k, group in enumerate(_groups(lattice.walls)):
        wall = lattice.walls[group[0]]
        for name, variable in (("p", "height"), ("v", "rate")):
            lines.append(f"real {variable}{k} = {numbers.linear(wall[:3], components(name)[:3])};")
            lines.append(f"real {variable}_w{k} = {numbers.linear(wall[3:], (f'{name}.w',))};")
        for sign in ("+", "-")[: len(group)]:
            rate = f"(rate_w{k} {sign} rate{k})"
            ratios.append(f"{rate} / fmax(-(height_w{k} {sign} height{k}), REAL(EPSILON))")
    lines.append(f"real ratio = {ratios[0]};")
    lines += [f"ratio = fmax(ratio, {ratio});" for ratio in ratios[1:]]
    lines.append("return crossing_time(ratio);")
    return lines


def light_images(lattice: Lattice | None, translates: "int | str") -> Array:
    """The isometries (M,4,4) that carry a light to those of its images that count, nearest cells first."""
    if lattice is None:
        return np.eye(4)[None]
    if translates == "neighbours":
        return np.concatenate([np.eye(4)[None], lattice.inverses])
    return elements(lattice, count=int(translates))
