"""OpenCL text for the objects of a scene: signed distance, surface and material."""

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from thurston_cl.lattice import Lattice, paths
from thurston_cl.lattice.isometry import (
    act,
    compose,
    identity,
    inverse,
    origin,
    snap,
    vector_map,
)
from thurston_cl.models import FIBRED, ISOTROPIC, LEFT_INVARIANT
from thurston_cl.scene import schema
from thurston_cl.scene.krs import Krs
from thurston_cl.scene.krs_sequence import SequenceError
from thurston_cl.scene.near_walls import balls_over_walls, bounds_of, images, is_hollow
from thurston_cl.scene.numbers import components, homogeneous
from thurston_cl.scene.parse import Location
from thurston_cl.scene.placement import X_AXIS, Z_AXIS
from thurston_cl.scene.texels import MOST_LEVELS
from thurston_cl.scene.write_krs import tells_free_balls, write_krs
from thurston_cl.scene.writer import DIRECTED, Writer

Array = NDArray[np.float64]


def write_objects(writer: Writer) -> int:
    """Add the distance and the surface of all objects; returns the number of images that are looked at."""
    distance: list[str] = []
    surface = [
        "surface best = {REAL(INFINITY), {REAL(0), REAL(0), REAL(0), REAL(1)}, REAL(0), REAL(0)}, s;",
        "material none = {{REAL(0), REAL(0), REAL(0)}, REAL(0), REAL(0), REAL(0), REAL(0)};",
        "*object = REAL(0);",
        "*m = none;",
        "mask nearer;",
    ]
    if any(_late(solid) for solid in writer.scene.objects):
        surface += ["point q = p;", "surface on_image = best;"]
    if writer.cell_ids:
        surface.append("real seen_from = *cell;")
    count = 0
    written_as: list[tuple[int, schema.Solid, Array, _SolidText, Array]] = []
    lamps = {
        number: ("lights", light, "point")
        for number, light in enumerate(writer.scene.lamps, start=1 + len(writer.scene.objects))
    }
    for k, solid in enumerate(writer.scene.solids, start=1):
        written = lamps.get(k, ("objects", k - 1))
        _check_tile(writer, solid, written)
        try:
            outer = _carry(writer, solid, written)
            text = _SolidText(writer, solid, outer)
            seen = np.empty((0, 4, 4))
            if writer.lattice is not None:
                seen = images(solid, outer, writer.near_walls, writer.lattice, writer.place)
        except SequenceError as error:
            path = (*written, *_keys_to(solid, error.krs), *error.path)
            raise writer.scene.error_at(path, str(error), error.help) from error
        except ValueError as error:
            raise writer.scene.error_at((*written, "at"), str(error)) from error
        writer.function(
            f"real object_{k}_distance(point p, vector v, scene_data scene)", [f"return {text.distance};"]
        )
        writer.function(
            f"surface object_{k}_surface(point p, scene_data scene)",
            [*text.lines, f"return {text.name};"],
            # Of an image it is asked for at three points.
            called=any(map(_wears_image, _late(solid).values())),
        )
        writer.function(
            f"material object_{k}_material(surface s, scene_data scene)",
            _materials(writer, [solid.material, *text.materials]),
        )
        count += len(seen)
        if writer.lattice is not None and len(seen):
            if not distance:
                distance.append("real distance = REAL(INFINITY);")
            more_distance, more_surface = _over_walls(writer, writer.lattice, k, solid, seen)
            surface += more_surface
        else:
            own = f"object_{k}_distance(p, v, scene)"
            more_distance = [f"distance = fmin(distance, {own});" if distance else f"real distance = {own};"]
            surface += [f"s = object_{k}_surface(p, scene);", *_take_nearer(k, solid)]
        writer.free[k] = text.free or f"{writer.in_all_directions(text.distance)} >= radius"
        written_as.append((k, solid, outer, text, seen))
        distance += _unless_skipped(k, more_distance) if k in lamps else more_distance
    writer.function(
        "real scene_distance(point p, vector v, scene_data scene)", [*distance, "return distance;"]
    )
    if needs_clearance(writer):
        body = ["clear = REAL(INFINITY);", "vector v = {REAL(0), REAL(0), REAL(0), REAL(0)};"]
        for one in written_as:
            lines = _clearance(writer, *one)
            body += _unless_skipped(one[0], lines) if one[0] in lamps else lines
        writer.function(
            "real scene_clearance(point p, real clear, scene_data scene)", [*body, "return clear;"]
        )
    writer.function(
        "void scene_surface(point p, vector v, real t, real *object, real *cell, covector *gradient,"
        " material *m, scene_data scene)",
        [*surface, "*gradient = best.gradient;", *_late_paints(writer, written_as)],
        called=writer.large,
    )
    writer.distances = len(writer.scene.solids) + count
    return count


def _keys_to(solid: schema.Solid, krs: Krs | None) -> Location:
    """The keys that lead from a solid to a sequence in it."""
    shape, kind = solid.shape, solid.kind
    if shape is krs:
        return (kind,)
    inside: list[tuple[Location, schema.Solid]] = []
    if isinstance(shape, tuple):
        inside = [((kind, k), member) for k, member in enumerate(shape)]
    elif isinstance(shape, schema.Solid):
        inside = [((kind,), shape)]
    found = ((*keys, *_keys_to(member, krs)) for keys, member in inside)
    return next((keys for keys in found if keys[-1] == "krs"), ())


def _unless_skipped(k: int, lines: list[str]) -> list[str]:
    """Lines for object k, a lamp, which its own light does not meet."""
    return [f"if (scene.skipped != {k}) {{", *(f"  {line}" for line in lines), "}"]


def needs_clearance(writer: Writer) -> bool:
    """Whether what shades by the distance has to know more of it than rays do."""
    scene = writer.scene
    soft = any(light.shadows is not None and light.shadows.soft is not None for light in scene.lights)
    occlusion = scene.effects.ambient_occlusion is not None
    # One ray is marched for a block of pixels.
    around = soft or occlusion or scene.render.start == "block"
    return (around and writer.directed) or (occlusion and writer.near_walls == "images")


def _clearance(
    writer: Writer, k: int, solid: schema.Solid, outer: Array, text: "_SolidText", seen: Array
) -> list[str]:
    """Lines that take the distance of object k into account, in all directions where it is directed, and with
    its images as far as ambient occlusion looks.
    """
    distance = writer.in_all_directions(text.distance)
    writer.function(
        f"real object_{k}_clearance(point p, vector v, scene_data scene)", [f"return {distance};"]
    )
    occlusion = writer.scene.effects.ambient_occlusion
    if occlusion is not None and writer.lattice is not None:
        try:
            seen = images(solid, outer, writer.near_walls, writer.lattice, writer.place, occlusion.reach)
        except ValueError as error:
            raise writer.scene.error_at(
                ("effects", "ambient-occlusion", "reach"), str(error), "make the reach shorter"
            ) from error
    writer.clearances += 1 + len(seen)
    lines = [
        f"real other = object_{k}_clearance(q, v, scene);",
        "clear = SELECT(clear < other, clear, other);",
    ]
    if len(seen) == 0 or writer.lattice is None:
        return ["{", "  point q = p;", *(f"  {line}" for line in lines), "}"]
    back = _back(writer.lattice, seen)
    maps, rows = writer.numbers.add(back[:, :4].ravel()), 4 * back.shape[2]
    return [
        f"for (int image = 0; image < {len(back)}; image++) {{",
        f"  point q = apply(scene, {maps} + {rows} * image, p);",
        *(f"  {line}" for line in lines),
        "}",
    ]


def _back(lattice: Lattice, seen: Array) -> Array:
    """What leads back from an object and its images (M,n,n) to the object: (M+1,n,n), first the identity."""
    return inverse(lattice.geometry, np.concatenate([identity(lattice.geometry)[None], seen]))


def _take_nearer(k: int, solid: schema.Solid, seen_at: str = "p", own: str = "s") -> list[str]:
    """Keep the surface s of object k where it is the nearest so far; of what is painted late also the point
    at which, and the surface as which, the object sees it itself.
    """
    kept = []
    if _late(solid):
        kept = [f"q = select_4(nearer, {seen_at}, q);", f"on_image = nearer_of({own}, on_image, nearer);"]
    return [
        "nearer = s.distance < best.distance;",
        *kept,
        "best = nearer_of(s, best, nearer);",
        f"*object = SELECT(nearer, REAL({k}), *object);",
        f"*m = select_material(nearer, object_{k}_material(s, scene), *m);",
    ]


def _over_walls(
    writer: Writer, lattice: Lattice, k: int, solid: schema.Solid, seen: Array
) -> tuple[list[str], list[str]]:
    """Distance and surface of object k and its images: the object itself, seen from the moved point. It takes
    part in the loop, so that its text is compiled once.
    """
    back = _back(lattice, seen)
    turns = vector_map(lattice.geometry, back)
    rows = 4 * back.shape[2]
    maps = linear = writer.numbers.add(back[:, :4].ravel())
    if back.shape[2] != 4 or not np.array_equal(turns, back):
        linear = writer.numbers.add(turns.ravel())
    loop = f"for (int image = 0; image < {len(back)}; image++) {{"
    moved = f"apply(scene, {maps} + {rows} * image, p)"
    turned = f"apply_linear(scene, {linear} + 16 * image, v)"
    distance = [
        loop,
        f"  real other = object_{k}_distance({moved}, {turned}, scene);",
        # A NaN is kept, unlike by fmin: a lane that has one must stop.
        "  distance = SELECT(distance < other, distance, other);",
        "}",
    ]
    surface = [
        f"point there = {moved};",
        f"surface own = object_{k}_surface(there, scene);",
        "s = own;",
        f"s.gradient = pull_back(scene, {linear} + 16 * image, s.gradient);",
        *_take_nearer(k, solid, "there", "own"),
    ]
    if writer.cell_ids:
        ways = [(), *paths(lattice, seen)]
        longest = max(len(way) for way in ways)
        place = writer.numbers.add(wall for way in ways for wall in (*way, *(-1,) * (longest - len(way))))
        surface += [
            "real behind = seen_from;",
            f"for (int step = 0; step < {longest}; step++) {{",
            f"  int wall = (int)scene.numbers[{place} + {longest} * image + step];",
            "  if (wall >= 0) behind = cell_behind(behind, nearer, wall, scene);",
            "}",
            "*cell = SELECT(nearer, behind, *cell);",
        ]
    return distance, [loop, *(f"  {line}" for line in surface), "}"]


def _carry(writer: Writer, solid: schema.Solid, location: tuple[str | int, ...]) -> Array:
    """The group element (n,n) that leads a solid's centre into the cell; 1 for what fills the cell."""
    if writer.lattice is None or is_hollow(solid, writer.geometry.name):
        return identity(writer.geometry.name)
    centre = writer.place.point(solid.at)
    _, element, ok = writer.lattice.teleport(centre[None])
    if not ok[0]:
        raise writer.scene.error_at((*location, "at"), "no group element leads this object into the cell")
    return np.asarray(element[0])


def _check_tile(writer: Writer, solid: schema.Solid, location: tuple[str | int, ...]) -> None:
    """Balls about vertices need vertices that are points of the space."""
    shape = solid.shape
    if solid.kind == "tile" and shape.vertices is not None:
        assert writer.lattice is not None
        kinds = {vertex.kind for vertex in writer.lattice.polyhedron.vertices} - {"finite"}
        if kinds:
            raise writer.scene.error_at(
                (*location, "tile", "vertices"),
                f"the vertices of {writer.lattice.name} are {' and '.join(sorted(kinds))}: no ball has its "
                "center there",
                "leave vertices out",
            )
    members = shape if isinstance(shape, tuple) else (shape,) if isinstance(shape, schema.Solid) else ()
    for k, member in enumerate(members):
        _check_tile(
            writer,
            member,
            (*location, solid.kind, k) if isinstance(shape, tuple) else (*location, solid.kind),
        )


class _SolidText:
    """The text of one solid: `distance`, and statements `lines` that work out the surface called `name`."""

    def __init__(self, writer: Writer, solid: schema.Object, outer: Array) -> None:
        self._writer, self._numbers, self._whole = writer, writer.numbers, solid
        self._place, self._lattice = writer.place, writer.lattice
        self._geometry = writer.geometry.name
        # Only in nil, sl2 and sol a set of balls has coordinates on its surface.
        self._plain = isinstance(solid.material.color, schema.Color)
        self._in_sets = self._plain or self._geometry in LEFT_INVARIANT
        self._near_walls, self._hollow = writer.near_walls, is_hollow(solid, self._geometry)
        self._count = 0
        self.lines: list[str] = []
        # Whether the ball about p of a radius is free of it, where its distance does not say so best.
        self.free: str | None = None
        # What parts of it are made of, the first of them part 1.
        self.materials: list[schema.Material] = []
        self.distance, self.name = self._solid(solid, outer)

    def _solid(self, solid: schema.Solid, outer: Array) -> tuple[str, str]:
        """Distance and name of the surface; `outer` carries the frame of what it belongs to into the cell."""
        frame = compose(self._geometry, outer, self._place.isometry(solid.at, solid.rotate))
        shape = solid.shape
        match solid.kind:
            case "union":
                balls = self._equal_balls(solid, outer) if self._in_sets and len(shape) > 1 else None
                if balls is not None:
                    return self._ball_set(*balls)
                return self._union([self._solid(member, frame) for member in shape])
            case "intersection":
                return self._intersection([self._solid(member, frame) for member in shape])
            case "difference":
                left_out = [self._complement(self._left_out(member, frame)) for member in shape[1:]]
                return self._intersection([self._solid(shape[0], frame), *left_out])
            case "complement":
                return self._complement(self._left_out(shape, frame))
            case "ball":
                return self._leaf("ball", frame, self._numbers.term(shape.radius))
            case "pseudo-ball":
                return self._leaf("pseudo_ball", frame, self._numbers.term(shape.radius))
            case "cylinder":
                return self._cylinder(shape, frame)
            case "pseudo-cylinder":
                return self._pseudo_cylinder(shape, frame)
            case "half-space":
                return self._half_space(shape.normal, shape.offset, frame, shape.crossing)
            case "slab":
                # Between two half-spaces.
                half, back = 0.5 * shape.thickness, [-c for c in shape.normal]
                front = self._half_space(shape.normal, half, frame)
                rear = self._half_space(back, half, frame)
                return f"fmax({front[0]}, {rear[0]})", self._let(f"intersection_of({front[1]}, {rear[1]})")
            case "krs":
                return self._krs(solid, frame)
            case "horoball":
                turned = frame @ self._place.turn(Z_AXIS, shape.towards)
                return self._leaf("horoball", turned, self._numbers.term(shape.distance))
            case _:
                return self._tile(shape, frame)

    def _cylinder(self, shape: schema.Cylinder, frame: Array) -> tuple[str, str]:
        """About the fibre or across it, or in any direction where there are none; in sol along x or y."""
        name, axis = "cylinder", Z_AXIS
        if self._geometry == "sol":
            name, axis = "horocycle_cylinder", X_AXIS
        elif self._geometry in FIBRED and shape.along[2] == 0:
            name, axis = "level_cylinder", X_AXIS
        return self._leaf(name, self._turned(frame, axis, shape.along), self._numbers.term(shape.radius))

    def _pseudo_cylinder(self, shape: schema.PseudoCylinder, frame: Array) -> tuple[str, str]:
        radius = self._numbers.term(shape.radius)
        if shape.along[2] != 0:
            return self._leaf("vertical_pseudo_cylinder", frame, radius)
        x, y = np.array(shape.along[:2]) / np.hypot(*shape.along[:2])
        return self._leaf("pseudo_cylinder", frame, radius, self._numbers.term(x), self._numbers.term(y))

    def _half_space(
        self, normal: Sequence[float], offset: float, frame: Array, crossing: str = "directed"
    ) -> tuple[str, str]:
        """Bounded by the plane across a geodesic; in fibred geometries over a line of the base, or level; in
        sol at one value of a coordinate.
        """
        level = normal[2] != 0
        axis = Z_AXIS if level or self._geometry in ISOTROPIC else X_AXIS
        lifted = self._place.isometry(tuple(offset * axis))
        if self._geometry == "sol":
            name = "flat_half_space" if level else "hyperbolic_half_space"
            if not level:
                # That far from the origin is the plane x = sinh(offset), though not along x.
                lifted = self._place.isometry(schema.ModelPoint(model=(math.sinh(offset), 0, 0, 1)))
        elif self._geometry in FIBRED:
            name = "horizontal_half_space" if level else "vertical_half_space"
            if level and crossing == "bisection":
                name = "bisected_half_space"
        else:
            name = "half_space"
        return self._leaf(name, compose(self._geometry, self._turned(frame, axis, normal), lifted))

    def _turned(self, frame: Array, axis: Array, goal: Sequence[float]) -> Array:
        return compose(self._geometry, frame, self._place.turn(axis, goal))

    def _left_out(self, solid: schema.Solid, frame: Array) -> tuple[str, str]:
        """What a difference or complement leaves out; in a hollow with those images that reach into the cell,
        for its neighbours leave out the same.
        """
        if not self._hollow or self._lattice is None or bounds_of(solid, frame, self._place) is None:
            return self._solid(solid, frame)
        balls = self._equal_balls(solid, frame)
        if balls is not None and self._near_walls == "images":
            return self._with_images(*balls, lambda: self._solid(solid, frame))
        seen = images(solid, frame, self._near_walls, self._lattice, self._place)
        places = [frame, *(compose(self._geometry, element, frame) for element in seen)]
        return self._union([self._solid(solid, place) for place in places])

    def _with_images(
        self, centres: Array, radius: float, alone: Callable[[], tuple[str, str]]
    ) -> tuple[str, str]:
        """Balls (N,4), which `alone` writes, with those of their images that reach into the cell."""
        assert self._lattice is not None
        over = balls_over_walls(self._lattice, centres, radius)
        if len(over) == 0:
            return alone()
        if self._in_sets:
            return self._ball_set(np.concatenate([centres, over]), radius)
        return self._union([alone(), self._ball_set(over, radius)])

    def _removed(
        self, centres: Array, radius: float, alone: Callable[[], tuple[str, str]]
    ) -> tuple[str, str]:
        """Balls that a tile leaves out. Of a Dirichlet domain their images cover nothing that they do not."""
        assert self._lattice is not None
        return alone() if self._lattice.is_dirichlet else self._with_images(centres, radius, alone)

    def _equal_balls(self, solid: schema.Solid, outer: Array) -> tuple[Array, float] | None:
        """Centres (N,4) and radius of a ball, or of a union of balls of one size; None for other solids, and
        where a turn shows that they would lose.
        """
        frame = compose(self._geometry, outer, self._place.isometry(solid.at, solid.rotate))
        if self._in_sets and not self._plain:
            turn = vector_map(self._geometry, frame)[:3, :3]
            if not np.array_equal(snap(turn), np.eye(3)):
                return None
        if solid.kind == "ball":
            return act(self._geometry, frame, origin(self._geometry))[None], solid.shape.radius
        if solid.kind != "union":
            return None
        members = [self._equal_balls(member, frame) for member in solid.shape]
        found = [member for member in members if member is not None]
        if len(found) < len(members) or len({radius for _, radius in found}) != 1:
            return None
        return np.concatenate([centres for centres, _ in found]), found[0][1]

    def _union(self, members: list[tuple[str, str]]) -> tuple[str, str]:
        return self._combined("fmin", "union_of", members)

    def _intersection(self, members: list[tuple[str, str]]) -> tuple[str, str]:
        return self._combined("fmax", "intersection_of", members)

    def _combined(self, nearer: str, combined: str, members: list[tuple[str, str]]) -> tuple[str, str]:
        distance, name = members[0]
        for other, other_name in members[1:]:
            distance = f"{nearer}({distance}, {other})"
            name = self._let(f"{combined}({name}, {other_name})")
        return distance, name

    def _complement(self, member: tuple[str, str]) -> tuple[str, str]:
        distance, name = member
        return f"-({distance})", self._let(f"complement_of({name})")

    def _let(self, expression: str) -> str:
        self._count += 1
        name = f"s{self._count}"
        self.lines.append(f"surface {name} = {expression};")
        return name

    def _leaf(self, shape: str, frame: Array, *arguments: str) -> tuple[str, str]:
        """One shape about the origin of its own coordinates; `frame` carries these into the cell."""
        self._writer.add_shape(shape)
        return self._placed(shape, frame, arguments, along_ray=shape in DIRECTED)[:2]

    def _krs(self, solid: schema.Solid, frame: Array) -> tuple[str, str]:
        """A kernel-reflection sequence, which has functions of its own."""
        krs = solid.shape
        name, materials = write_krs(self._writer, krs, 1 + len(self.materials))
        self.materials += materials
        distance, surface, point = self._placed(name, frame, ("scene",), along_ray=True)
        if solid is self._whole and tells_free_balls(self._writer, krs):
            self.free = f"{name}_unbounding({point}, radius, scene)"
        return distance, surface

    def _placed(
        self, shape: str, frame: Array, arguments: Sequence[str], *, along_ray: bool
    ) -> tuple[str, str, str]:
        """What functions give that take a point, and where they go `along_ray` its vector, in a frame:
        distance and surface; and that point.
        """
        matrix = snap(inverse(self._geometry, frame))
        point, vector, pulled = "p", "v", None
        if not np.array_equal(matrix, identity(self._geometry)):
            self._count += 1
            point = self._moved(matrix)
            pulled = snap(vector_map(self._geometry, matrix))
            vector = f"(vector){self._numbers.rows(pulled, components('v'))}" if along_ray else ""
        tail = "".join(f", {argument}" for argument in arguments)
        name = self._let(f"{shape}_surface({point}{tail})")
        if pulled is not None and not np.array_equal(pulled, np.eye(4)):
            gradient = self._numbers.rows(pulled.T, components(f"{name}.gradient"))
            self.lines.append(f"{name}.gradient = (covector){gradient};")
        return f"{shape}_distance({point}{f', {vector}' if along_ray else ''}{tail})", name, point

    def _moved(self, matrix: Array) -> str:
        """The text of the point p moved by an isometry (n,n)."""
        moved = f"(point){self._numbers.rows(matrix[:4], homogeneous('p', len(matrix)))}"
        if self._geometry != "sl2" or not np.any(matrix[2, :2]):
            return moved
        row = ", ".join(self._numbers.term(float(entry)) for entry in (*matrix[2, :3], matrix[3, 3]))
        return f"with_fibre_gain(p, {moved}, {row})"

    def _ball_set(self, centres: Array, radius: float) -> tuple[str, str]:
        self._writer.add_shape("ball_set")
        arguments = (
            f"(p, scene, {self._numbers.add(centres.ravel())}, {len(centres)}, {self._numbers.term(radius)})"
        )
        return f"ball_set_distance{arguments}", self._let(f"ball_set_surface{arguments}")

    def _tile(self, tile: schema.Tile, frame: Array) -> tuple[str, str]:
        """The cell minus balls: the walls of the cell are no surfaces, so only the balls are left (paper,
        figure 3).
        """
        assert self._lattice is not None
        polyhedron = self._lattice.polyhedron
        middle = act(self._geometry, frame, origin(self._geometry))[None]
        members = [
            self._removed(middle, tile.ball, lambda: self._leaf("ball", frame, self._numbers.term(tile.ball)))
        ]
        corners = [vertex.vector for vertex in polyhedron.vertices] if tile.vertices is not None else []
        middles = [edge.point for edge in polyhedron.edges] if tile.edges is not None else []
        for points, radius in ((corners, tile.vertices), (middles, tile.edges)):
            if radius is not None:
                centres = act(self._geometry, frame, np.array(points))
                members.append(self._removed(centres, radius, partial(self._ball_set, centres, radius)))
        return self._complement(self._union(members))


def _late(solid: schema.Solid) -> dict[int, schema.Pattern]:
    """The paints of an object's parts, its own material being part 0, that are painted once it is known
    that it is the nearest: what needs the footprint of the pixel, the point or the normal, and what
    takes long.
    """
    if not isinstance(solid, schema.Object):
        return {}
    paints = {part: material.color for part, material in enumerate(solid.materials)}
    return {
        part: paint
        for part, paint in paints.items()
        if isinstance(paint, schema.Pattern)
        and any(kind is not None for kind in (paint.image, paint.noise, paint.triplanar, paint.slope))
    }


def _wears_image(paint: "schema.Color | schema.Pattern") -> bool:
    """Whether a paint lays an image on the coordinates of the surface."""
    if isinstance(paint, schema.Color):
        return False
    inside = [] if paint.slope is None else [paint.slope.flat, paint.slope.steep]
    return paint.image is not None or any(_wears_image(part) for part in inside)


def _late_paints(
    writer: Writer, written: "list[tuple[int, schema.Solid, Array, _SolidText, Array]]"
) -> list[str]:
    """Color the objects that are painted late, once it is known which of them is seen, at q as on_image."""
    lines: list[str] = []
    for k, solid, outer, text, _ in written:
        late = _late(solid)
        if late and not lines:
            writer.parts.add("pattern/footprint.h")
            lines.append("footprint f = footprint_of(p, v, t, best.gradient, scene);")
        if any(map(_wears_image, late.values())):
            writer.parts.add("pattern/image.h")
            _write_spread(writer, k)
        for part, paint in late.items():
            name = f"object_{k}_paint" if part == 0 else f"object_{k}_paint_{part}"
            frame = compose(writer.geometry.name, outer, writer.place.isometry(solid.at, solid.rotate))
            _write_paint(writer, name, k, paint, frame, ends=_is_globe(solid))
            own = f" & (on_image.part == REAL({part}))" if text.materials else ""
            lines += [
                f"nearer = (*object == REAL({k})){own};" if own else f"nearer = *object == REAL({k});",
                "if (ANY(nearer)) {",
                f"  real3_lanes color = {name}(q, on_image, f, scene);",
                "  m->color = select_3(nearer, color, m->color);",
                "}",
            ]
    return lines


def _write_paint(
    writer: Writer, name: str, k: int, paint: schema.Pattern, frame: Array, *, ends: bool
) -> None:
    """Add the function `name`: the color of what object k wears, placed by `frame`, at a point of its
    surface.
    """
    body = [f"f.spread = object_{k}_spread(q, s, f, scene);"] if _wears_image(paint) else []
    point = "q"
    if paint.image is None:
        point = "own"
        body += _in_own_frame(writer, frame)
    color = _paint(paint, writer, "s", point, "f", ends=ends)
    writer.function(
        f"real3_lanes {name}(point q, surface s, footprint f, scene_data scene)",
        [*body, f"return {color};"],
    )


def _write_spread(writer: Writer, k: int) -> None:
    """Add the function that says which area of its coordinates a pixel sees of object k."""
    writer.function(
        f"real object_{k}_spread(point q, surface s, footprint f, scene_data scene)",
        [
            "direction in_surface[2];",
            "directions_in_surface(q, s.gradient, in_surface);",
            "surface beside[2];",
            "for (int i = 0; i < 2; i++)",
            f"  beside[i] = object_{k}_surface(moved_along(q, in_surface[i], footprint_step(f)), scene);",
            "return spread_of(s, beside, f);",
        ],
    )


def _in_own_frame(writer: Writer, frame: Array) -> list[str]:
    """Lines that take the point q and the gradient of the surface s to the frame of an object, which `frame`
    carries into the cell: the point becomes `own`.
    """
    geometry = writer.geometry.name
    back = snap(inverse(geometry, frame))
    if np.array_equal(back, identity(geometry)):
        return ["point own = q;"]
    gradient = writer.numbers.rows(snap(vector_map(geometry, frame)).T, components("s.gradient"))
    return [
        f"point own = {writer.numbers.rows(back[:4], homogeneous('q', len(back)))};",
        f"s.gradient = (covector){gradient};",
    ]


def _is_globe(solid: schema.Solid) -> bool:
    """Whether the second coordinate ends at poles wherever one is seen: a ball, or made of balls."""
    shape = solid.shape
    if isinstance(shape, tuple):
        return all(_is_globe(member) for member in shape)
    if isinstance(shape, schema.Solid):
        return _is_globe(shape)
    return solid.kind in ("ball", "pseudo-ball", "tile")


def _paint(
    paint: "schema.Color | schema.Pattern",
    writer: Writer,
    surface: str,
    point: str | None = None,
    footprint: str | None = None,
    *,
    ends: bool = False,
) -> str:
    """The text of a color or a pattern, from the names of the surface and, both in the frame of the object as
    the gradient of the surface is then, of the point and the footprint. Without these two what is painted
    late is black. `ends`: whether the second surface coordinate ends at poles.
    """
    numbers, parts = writer.numbers, writer.parts
    if isinstance(paint, schema.Color):
        return f"three_numbers(scene, {numbers.add(paint.linear)})"
    if paint.noise is not None or paint.slope is not None or paint.triplanar is not None:
        if point is None or footprint is None:
            return "{REAL(0), REAL(0), REAL(0)}"
        if paint.noise is not None:
            return _noise(paint.noise, writer, point, footprint)
        if paint.triplanar is not None:
            return _triplanar(paint.triplanar, writer, surface, point, footprint)
        assert paint.slope is not None
        flat, steep = (
            _paint(part, writer, surface, point, footprint, ends=ends)
            for part in (paint.slope.flat, paint.slope.steep)
        )
        parts.add("pattern/slope.h")
        up = np.array(paint.slope.up) / np.linalg.norm(paint.slope.up)
        place = numbers.add([paint.slope.at, paint.slope.width, *up])
        return f"slope({surface}, {point}, {flat}, {steep}, scene, {place})"
    return _flat_paint(paint, writer, surface, footprint, ends)


def _flat_paint(
    paint: "schema.Pattern | schema.Triplanar",
    writer: Writer,
    surface: str,
    footprint: str | None,
    ends: bool,
) -> str:
    """The text of a pattern that is laid out by two coordinates."""
    numbers, parts = writer.numbers, writer.parts
    if paint.checker is not None:
        parts.add("pattern/checker.h")
        checker = paint.checker
        place = numbers.add([*checker.count, *checker.colors[0].linear, *checker.colors[1].linear])
        return f"checker({surface}, scene, {place})"
    if paint.bands is not None:
        parts |= {"pattern/color_in_turn.h", "pattern/bands.h"}
        bands = paint.bands
        place = numbers.add(
            [
                bands.count,
                bands.width,
                *bands.ground.linear,
                *(c for color in bands.colors for c in color.linear),
            ]
        )
        return f"bands({surface}, scene, {place}, {len(bands.colors)})"
    if paint.strips is not None:
        parts |= {"pattern/color_in_turn.h", "pattern/strips.h"}
        colors = [c for color in paint.strips.colors for c in color.linear]
        place = numbers.add([paint.strips.count, *colors])
        coordinate = {"first": "u", "second": "v"}[paint.strips.across]
        return f"strips({surface}.{coordinate}, scene, {place}, {len(paint.strips.colors)})"
    if paint.image is not None:
        if footprint is None:
            return "{REAL(0), REAL(0), REAL(0)}"
        parts |= {"pattern/footprint.h", "pattern/image.h"}
        levels = writer.texels.add(paint.image.file)
        room = [0.0] * (4 * MOST_LEVELS - len(levels))
        last = ends and paint.image.size[1] == 1
        place = numbers.add([len(levels) // 4, last, *paint.image.size, *levels, *room])
        return f"image({surface}.u, {surface}.v, {footprint}.spread, scene, {place})"
    assert paint.grid is not None
    parts.add("pattern/grid.h")
    grid = paint.grid
    place = numbers.add([*grid.count, grid.width, *grid.colors[0].linear, *grid.colors[1].linear])
    return f"grid({surface}, scene, {place})"


def _noise(noise: schema.Noise, writer: Writer, point: str, footprint: str) -> str:
    """The text of noise at a point."""
    writer.parts |= {"lane_integers.h", "pattern/footprint.h", "pattern/noise.h"}
    writer.asked["pattern/noise.h"] += noise.octaves
    sizes = [noise.size * stretch for stretch in noise.stretch]
    colors = [c for color in noise.colors for c in color.linear]
    place = writer.numbers.add([*(1 / size for size in sizes), min(sizes), *colors])
    return f"noise({point}, {footprint}, scene, {place}, {noise.octaves}, {len(noise.colors)})"


def _triplanar(triplanar: schema.Triplanar, writer: Writer, surface: str, point: str, footprint: str) -> str:
    """The text of a triplanar pattern: a call of a function that is added."""
    writer.parts |= {"pattern/footprint.h", "pattern/triplanar.h"}
    place = writer.numbers.add([triplanar.size])
    color = _flat_paint(triplanar, writer, "seen", "covered", ends=False)
    writer.function(
        f"real3_lanes triplanar_{place}(surface s, point q, footprint f, scene_data scene)",
        [
            "direction weights = triplanar_weights(q, s.gradient);",
            "real3_lanes sum = {REAL(0), REAL(0), REAL(0)};",
            "for (int axis = 0; axis < 3; axis++) {",
            f"  surface seen = along_axis(s, q, axis, scene, {place});",
            f"  footprint covered = footprint_along_axis(f, s, q, axis, scene, {place});",
            f"  sum = add_scaled_3(sum, {color}, on_axis(weights, axis));",
            "}",
            "return sum;",
        ],
    )
    return f"triplanar_{place}({surface}, {point}, {footprint}, scene)"


def _materials(writer: Writer, materials: Sequence[schema.Material]) -> list[str]:
    """Lines that give the material of a surface: the first, or that of the part it belongs to."""
    lines = [f"material m = {_material(materials[0], writer, 's')};"]
    for part, material in enumerate(materials[1:], start=1):
        lines += [
            f"if (ANY(s.part == REAL({part}))) {{",
            f"  material of_part = {_material(material, writer, 's')};",
            f"  m = select_material(s.part == REAL({part}), of_part, m);",
            "}",
        ]
    return [*lines, "return m;"]


def _material(
    material: schema.Material,
    writer: Writer,
    surface: str,
    point: str | None = None,
    footprint: str | None = None,
) -> str:
    """The text of a material on a surface, as an initialiser; the names as `_paint` takes them."""
    shares = [material.ambient, material.diffuse, material.specular, material.shininess]
    if writer.reflections:
        shares.append(material.reflectivity)
    place = writer.numbers.add(shares)
    read = ", ".join(f"number(scene, {place + k})" for k in range(len(shares)))
    return f"{{{_paint(material.color, writer, surface, point, footprint)}, {read}}}"
