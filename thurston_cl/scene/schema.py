"""The scene format: a pydantic model for each mapping of a scene. The descriptions are its documentation.

Lengths are in units of the geometry's curvature (in e3, of the scene's own choice) and are written without a
unit; angles carry theirs. Vectors are components in the frame at the point they belong to. Checks that need
the rest of the scene ask the `Context`, so that one pass reports every mistake at once."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, BeforeValidator, Field, PrivateAttr

from thurston_cl.errors import SceneError
from thurston_cl.models import GEOMETRIES

from .background import Background, BackgroundValue, Sky
from .base import Node, Problem, problem, shown
from .camera import Camera, Dome, Equirectangular, Fisheye, Look, Perspective, Projection, Step, Stereo
from .context import Context
from .effects import AmbientOcclusion, Effects, ExponentialFog, Fog, LinearFog, Reflections
from .krs import (
    EmptyZone,
    Kernel,
    KernelArc,
    KernelBall,
    KernelCapsule,
    KernelHalfSpace,
    KernelLeaf,
    Krs,
    Level,
    MapStep,
    MapTurn,
    Mirror,
    MoebiusLevel,
    Twist,
)
from .lights import HardShadows, Light, PointLight, Shadows, SoftShadows, Sun, Within
from .manifold import ManifoldValue, MatrixLattice, TorusBundle
from .parse import Location
from .points import ModelPoint, Point
from .settings import Output, RenderSettings, different_files
from .shapes import (
    Ball,
    Cylinder,
    HalfSpace,
    Horoball,
    Object,
    PseudoBall,
    PseudoCylinder,
    Rotation,
    Shape,
    Slab,
    Solid,
    Tile,
    lamp,
)
from .source import Problems, SceneSource
from .suggest import nearest
from .surfaces import (
    Bands,
    Checker,
    Grid,
    ImageTexture,
    Material,
    Noise,
    Pattern,
    Slope,
    Strips,
    Triplanar,
)
from .tracer import tracer_problems
from .values import AtLeast, Color, Name, ParamName, ParamValue, Says, color

if TYPE_CHECKING:
    from thurston_cl.lattice import Lattice

FORMAT_VERSION: Literal[1] = 1
_LONG_NAMES = {
    "euclidean": "e3",
    "flat": "e3",
    "spherical": "s3",
    "sphere": "s3",
    "hyperbolic": "h3",
    "s2xr": "s2xe",
    "s2r": "s2xe",
    "h2xr": "h2xe",
    "h2r": "h2xe",
    "heisenberg": "nil",
    "nilgeometry": "nil",
    "nilpotent": "nil",
    "sl2r": "sl2",
    "psl2r": "sl2",
    "sl2tilde": "sl2",
    "solvable": "sol",
    "solvgeometry": "sol",
}


def _version(value: Any) -> Any:
    if value != FORMAT_VERSION or isinstance(value, bool):
        raise problem(
            f"this program reads version {FORMAT_VERSION} of the scene format; this is {shown(value)}"
        )
    return FORMAT_VERSION


def _geometry(value: Any) -> Any:
    if isinstance(value, str) and value not in GEOMETRIES:
        available = ", ".join(GEOMETRIES)
        guess = nearest(value, (*GEOMETRIES, *_LONG_NAMES))
        help = f"did you mean '{_LONG_NAMES.get(guess, guess)}'?" if guess else None
        raise problem(f"{shown(value)} is not one of: {available}", help)
    return value


class Scene(Node):
    """A picture to be made. Only `geometry` and `objects` are needed."""

    what = "a scene"
    example = "geometry: h3"
    hints: ClassVar[Mapping[str, str]] = {
        "include": "a scene is one file; 'thurston scenes' lists scenes to start from",
        "animation": "animations are not rendered yet",
        "environment": "did you mean 'background'?",
        "sky": "write 'background: {sky: {...}}'",
        "krs": "a sequence is the shape of an object: write 'objects: [{krs: ...}]'",
        "object": "did you mean 'objects'?",
    }

    thurston: Annotated[Literal[1], BeforeValidator(_version), Says("`1`")] = Field(
        default=FORMAT_VERSION, description="Version of the scene format."
    )
    title: str = Field(default="", description="What the picture shows.")
    geometry: Annotated[
        Literal["e3", "s3", "h3", "s2xe", "h2xe", "nil", "sl2", "sol"], BeforeValidator(_geometry)
    ] = Field(
        description="The space: Euclidean, spherical or hyperbolic; the sphere or the hyperbolic plane "
        "times a line; Nil; the universal cover of SL(2, R); Sol."
    )
    manifold: ManifoldValue | None = Field(
        default=None,
        description="What tiles the space: objects and lights repeat in each cell. Left out: nothing does.",
    )
    params: Annotated[dict[ParamName, ParamValue], Says("names with numbers or texts")] = Field(
        default={}, description="Values to use as `$name` anywhere below, and to change with `-D name=value`."
    )
    camera: Camera = Field(default=Camera(), description="Where the picture is taken from.")
    textures: Annotated[dict[Name, Pattern], Says("names with [patterns](#pattern)")] = Field(
        default={}, description="Patterns to use as `$textures.name`."
    )
    materials: Annotated[dict[Name, Material], Says("names with [materials](#material)")] = Field(
        default={}, description="Materials to use by their name."
    )
    objects: Annotated[tuple[Object, ...], AtLeast(1)] = Field(description="What there is to see.")
    lights: tuple[Light, ...] = Field(
        default=(), description="Left out: a warm light beside the camera and a cool one ahead of it."
    )
    effects: Effects = Field(default=Effects(), description="What is simulated besides direct light.")
    background: BackgroundValue = Field(
        default=color("black"), description="What a ray shows that hits nothing."
    )
    render: RenderSettings = Field(default=RenderSettings(), description="How the picture is worked out.")
    outputs: Annotated[tuple[Output, ...], AfterValidator(different_files)] = Field(
        default=(), description="The files to write. Left out: named on the command line."
    )

    _source: SceneSource = PrivateAttr(default_factory=SceneSource)
    _lattice: "Lattice | None" = PrivateAttr(None)

    @property
    def source(self) -> SceneSource:
        """The text of the scene and where everything in it stands."""
        return self._source

    @property
    def lattice(self) -> "Lattice | None":
        """The group and fundamental domain of `manifold`; None in the whole space."""
        if self._lattice is None and self.manifold is not None:
            from thurston_cl import lattice

            if isinstance(self.manifold, str):
                self._lattice = lattice.named(self.geometry, self.manifold)
            else:
                self._lattice = self.manifold.lattice(self.geometry)
        return self._lattice

    @property
    def sky(self) -> Sky | None:
        """The sky of the background, if that is one."""
        return self.background.sky if isinstance(self.background, Background) else None

    @property
    def plain_background(self) -> Color:
        """The background where no direction counts: of a sky, the horizon."""
        if isinstance(self.background, Color):
            return self.background
        assert self.background.sky is not None
        return self.background.sky.horizon

    @property
    def solids(self) -> tuple[Object, ...]:
        """The objects, and after them the balls that show where lights stand: the numbering of object ids."""
        return (*self.objects, *self.lamps.values())

    @property
    def lamps(self) -> dict[int, Object]:
        """The balls that show where lights stand, by the index of the light."""
        return {
            k: lamp(light.point.at, light.point.ball, light.point.color)
            for k, light in enumerate(self.lights)
            if light.point is not None and light.point.ball is not None
        }

    def check(self, context: Context) -> Iterator[Problem]:
        depth = None if self.effects.reflections is None else self.effects.reflections.depth
        mirrors = [
            (k, material)
            for k, item in enumerate(self.objects)
            for material in item.materials
            if material.reflectivity > 0
        ]
        if mirrors and depth is None:
            message = "a material with reflectivity needs reflections, which this scene does not call for"
            help = "add 'effects: {reflections: {depth: 1}}', or leave reflectivity out"
            yield Problem(self._written_material(*mirrors[0], context), message, help, True)
        elif depth is not None and not mirrors:
            message = "no object has a material with reflectivity"
            help = "leave reflections out, or give a material 'reflectivity: 0.5'"
            yield Problem(("effects", "reflections"), message, help, True)
        yield from tracer_problems(self)

    def _written_material(self, index: int, material: Material, context: Context) -> Location:
        """Where the reflectivity of a material of an object is written: with it, or among the materials;
        or, of a part of the object, where that is.
        """
        for name in context.names("materials"):
            if context.entry("materials", name, Material) is material:
                return "materials", name, "reflectivity"
        own = material is self.objects[index].material
        return ("objects", index, "material", "reflectivity") if own else ("objects", index)

    def remember(self, source: SceneSource, lattice: "Lattice | None") -> None:
        """Keep what is known from loading; only the loader calls this."""
        self._source, self._lattice = source, lattice

    @classmethod
    def fill(cls, data: dict[str, Any], context: Context) -> None:
        data.setdefault("camera", {})
        data.setdefault("render", {})

    def error_at(
        self, location: Location, message: str, help: str | None = None, *, key: bool = False
    ) -> SceneError:
        """The error that shows a location such as ("objects", 0, "ball", "radius") in the text; raise it."""
        return self.source.report([self.source.diagnostic(location, message, help, key=key)])

    def problems(self) -> Problems:
        """An empty collection, for checks that can find more than one mistake."""
        return Problems(self.source)

    def __eq__(self, other: object) -> bool:
        """Whether both describe the same picture, wherever they were read."""
        return isinstance(other, Scene) and self.__dict__ == other.__dict__

    def effective_text(self) -> str:
        """The scene as YAML with -D and --set worked in: reading this text gives an equal scene."""
        from .effective import effective_text

        return effective_text(self.source)


__all__ = [
    "FORMAT_VERSION",
    "GEOMETRIES",
    "AmbientOcclusion",
    "Background",
    "Ball",
    "Bands",
    "Camera",
    "Checker",
    "Color",
    "Context",
    "Cylinder",
    "Dome",
    "Effects",
    "EmptyZone",
    "Equirectangular",
    "ExponentialFog",
    "Fisheye",
    "Fog",
    "Grid",
    "HalfSpace",
    "HardShadows",
    "Horoball",
    "ImageTexture",
    "Kernel",
    "KernelArc",
    "KernelBall",
    "KernelCapsule",
    "KernelHalfSpace",
    "KernelLeaf",
    "Krs",
    "Level",
    "Light",
    "LinearFog",
    "Look",
    "MapStep",
    "MapTurn",
    "Material",
    "MatrixLattice",
    "Mirror",
    "ModelPoint",
    "MoebiusLevel",
    "Noise",
    "Object",
    "Output",
    "Pattern",
    "Perspective",
    "Point",
    "PointLight",
    "Projection",
    "PseudoBall",
    "PseudoCylinder",
    "Reflections",
    "RenderSettings",
    "Rotation",
    "Scene",
    "Shadows",
    "Shape",
    "Sky",
    "Slab",
    "Slope",
    "SoftShadows",
    "Solid",
    "Step",
    "Stereo",
    "Strips",
    "Sun",
    "Tile",
    "TorusBundle",
    "Triplanar",
    "Twist",
    "Within",
]
