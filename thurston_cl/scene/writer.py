"""What the parts of a scene share while their OpenCL text is written."""

from dataclasses import dataclass, field

from thurston_cl.geometry import Geometry
from thurston_cl.lattice import Lattice
from thurston_cl.scene import schema
from thurston_cl.scene.numbers import Numbers
from thurston_cl.scene.placement import Placement


@dataclass
class Writer:
    """Collects functions, the numbers they read and the kernel files they call. Formulas stay in `kernels/`.

    `near_walls` is how distance is measured near the walls of the cell; `cell_ids` says whether rays keep
    track of the cell they are in.
    """

    scene: schema.Scene
    geometry: Geometry
    numbers: Numbers
    near_walls: str
    cell_ids: bool
    parts: set[str] = field(default_factory=set)
    lines: list[str] = field(default_factory=list)

    @property
    def lattice(self) -> Lattice | None:
        """The lattice of the scene, if it has one."""
        return self.scene.lattice

    @property
    def creeping(self) -> bool:
        """Whether rays stop at walls (paper 4.2.1)."""
        return self.near_walls in ("creeping", "both", "images")

    @property
    def place(self) -> Placement:
        """Where things stand."""
        return Placement(self.geometry)

    def function(self, head: str, body: list[str]) -> None:
        """Add one function."""
        self.lines += [f"FN {head}", "{", *(f"  {line}" for line in body), "}"]

    def text(self) -> str:
        """The functions added since the last call."""
        text, self.lines = "\n".join(self.lines), []
        return text
