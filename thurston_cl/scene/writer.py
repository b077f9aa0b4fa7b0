"""What the parts of a scene share while their OpenCL text is written."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from thurston_cl.geometry import Geometry
from thurston_cl.lattice import Lattice
from thurston_cl.models import LEFT_INVARIANT, TWISTED
from thurston_cl.scene import schema
from thurston_cl.scene.numbers import Numbers
from thurston_cl.scene.placement import Placement
from thurston_cl.scene.texels import Texels

if TYPE_CHECKING:
    from thurston_cl.krs.sequence import MoebiusSequence, Sequence

Array = NDArray[np.float64]

# More objects than these are many: their surfaces take long to compile within something else.
FEW_OBJECTS = 6
# Shapes that are bounded along the ray only: their distance takes its vector too.
DIRECTED = ("horizontal_half_space", "bisected_half_space")
# What the file of a shape calls of other files of kernels/shape, and what says how far a ball is where that
# has no closed form.
_CALLED: dict[str, tuple[str, ...]] = {
    "ball": ("angles",),
    "ball_set": ("ball",),
    "pseudo_ball": ("angles",),
    "pseudo_cylinder": ("pseudo_ball",),
    "vertical_pseudo_cylinder": ("pseudo_ball",),
    "cylinder": ("angles",),
    "level_cylinder": ("angles",),
    "horocycle_cylinder": ("angles",),
    "bisected_half_space": ("horizontal_half_space",),
}
_BALL_BOUNDS = dict.fromkeys(TWISTED, ("ball_twisted",)) | {"sol": ("ball_sol",)}


def shape_parts(geometry: str, shapes: Iterable[str]) -> set[str]:
    """The kernel files of shapes."""
    parts: set[str] = set()
    for shape in shapes:
        called = _CALLED.get(shape, ())
        if shape == "ball":
            called += _BALL_BOUNDS.get(geometry, ())
        parts |= {f"shape/{shape}.h"} | shape_parts(geometry, called)
    return parts


@dataclass(frozen=True)
class Named:
    """A sequence, and by the part of its kernels what they are made of, in words; None: as the object."""

    sequence: "Sequence | MoebiusSequence"
    made_of: tuple[str | None, ...]


@dataclass
class Writer:
    """Collects functions, the numbers they read and the kernel files they call. Formulas stay in `kernels/`.

    `near_walls` is how distance is measured near the walls of the cell. `cells` (C,n,n) are the group
    elements of the cells that rays keep track of, if any; `seen_from` has for each light that is not repeated
    its place (C,4) as seen from them; `texels` has the images. `asked` counts, by kernel file, how often a
    surface point calls for it. `switch`: None, or whether effects are on in a program that has them and asks
    a number for each whether it is: what assembling saves is measured against that.
    """

    scene: schema.Scene
    geometry: Geometry
    numbers: Numbers
    near_walls: str
    cells: Array
    switch: bool | None = None
    parts: set[str] = field(default_factory=set)
    asked: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    # Objects and images that a ray asks for their distance, and those that what shades by it asks.
    distances: int = 0
    clearances: int = 0
    lines: list[str] = field(default_factory=list)
    seen_from: list[Array] = field(default_factory=list)
    sequences: "list[Named]" = field(default_factory=list)
    # By object: whether the ball about p of a radius is free of it.
    free: dict[int, str] = field(default_factory=dict)
    # Names of sequences whose distance holds along the ray alone.
    along_rays: list[str] = field(default_factory=list)
    texels: Texels = field(default_factory=Texels)

    @property
    def lattice(self) -> Lattice | None:
        """The lattice of the scene, if it has one."""
        return self.scene.lattice

    @property
    def cell_ids(self) -> bool:
        """Whether rays keep track of the cell they are in."""
        return len(self.cells) > 0

    @property
    def directed(self) -> bool:
        """Whether the distance of some shape holds along the ray alone."""
        return bool(self.directed_shapes)

    @property
    def directed_shapes(self) -> list[str]:
        """Those shapes."""
        return [shape for shape in DIRECTED if f"shape/{shape}.h" in self.parts] + self.along_rays

    @property
    def creeping(self) -> bool:
        """Whether rays stop at walls (paper 4.2.1): always where a bound holds along the ray alone."""
        return self.directed or self.near_walls in ("creeping", "both", "images")

    @property
    def place(self) -> Placement:
        """Where things stand."""
        return Placement(self.geometry)

    @property
    def large(self) -> bool:
        """Whether surfaces and light are functions that are called: inlined they would take half as long
        again to compile. Where there is little to do, a call costs a third of it.
        """
        return self.geometry.name in LEFT_INVARIANT or len(self.scene.solids) > FEW_OBJECTS

    @property
    def reflections(self) -> int:
        """How often rays are mirrored."""
        reflections = self.scene.effects.reflections
        return 0 if reflections is None else reflections.depth

    def effect(self, part: str, lines: list[str], count: float = 1) -> list[str]:
        """Ask for the kernel file of an effect, `count` times at each surface point.

        Gives back the lines that call it.
        """
        self.parts.add(part)
        self.asked[part] += count
        if self.switch is None:
            return lines
        condition = f"if (scene.numbers[{self.numbers.add([self.switch])}] != 0) {{"
        return [condition, *(f"  {line}" for line in lines), "}"]

    def add_shape(self, shape: str) -> None:
        """Ask for the kernel files of a shape."""
        self.parts |= shape_parts(self.geometry.name, [shape])

    def function(self, head: str, body: list[str], *, called: bool = False) -> None:
        """Add one function: inlined, or where it is `called` compiled once."""
        self.lines += [f"{'SOLVER' if called else 'FN'} {head}", "{", *(f"  {line}" for line in body), "}"]

    def in_all_directions(self, distance: str) -> str:
        """The text of a distance, with what holds along a ray alone replaced by what holds all around."""
        for shape in self.directed_shapes:
            distance = distance.replace(f"{shape}_distance(", f"{shape}_clearance(")
        return distance

    def text(self) -> str:
        """The functions added since the last call."""
        text, self.lines = "\n".join(self.lines), []
        return text
