"""How the rays of a scene are marched: which tracer, why, and what each of them needs."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from thurston_cl.models import FIBRED, ISOTROPIC, PRODUCTS

from .base import Problem
from .krs import Krs
from .shapes import Solid

if TYPE_CHECKING:
    from .schema import Scene

# Objects that are marched by themselves, at most. All are looked through for each step: among 8 that takes as
# long as the distance of 20 balls, among 16 of 30, and half of the distances are saved.
MOST_COMPONENTS = 16


@dataclass(frozen=True)
class Tracer:
    """A file of kernels/march/ by its name, and why it is taken."""

    name: str
    why: str


def tracer_of(scene: "Scene") -> Tracer:
    """The tracer of a scene that has no `tracer_problems`."""
    asked = scene.render.tracer
    if asked != "auto":
        return Tracer(asked, "as the scene says")
    # Ordinary objects are cheap beside the choice between them.
    costly = sum(solid.kind == "krs" for solid in scene.solids)
    if costly == 0:
        return Tracer("direct", "all objects at once are cheap")
    if costly == 1:
        if scene.manifold is None and not any(_is_directed(solid, scene.geometry) for solid in scene.objects):
            return Tracer("relaxed", "an object is costly to ask for its distance")
        return Tracer("direct", "relaxed steps are for the whole space and distances that hold all around")
    if scene.manifold is not None or scene.geometry not in (*ISOTROPIC, *PRODUCTS):
        return Tracer("direct", "others are for the whole space of an isotropic geometry or a product")
    if len(scene.solids) > MOST_COMPONENTS:
        return Tracer("direct", f"more than {MOST_COMPONENTS} objects are too many to march by themselves")
    return Tracer("compound", f"{costly} objects are costly to ask for their distance")


def tracer_problems(scene: "Scene") -> Iterator[Problem]:
    """What in a scene its `tracer` or `start` cannot do."""
    yield from _tracer(scene)
    if scene.render.start == "block":
        yield from _block_start(scene)


def _tracer(scene: "Scene") -> Iterator[Problem]:
    name, geometry = scene.render.tracer, scene.geometry
    place, cure = ("render", "tracer"), "leave it out, or write 'tracer: direct'"
    if name in ("auto", "direct"):
        return
    if scene.manifold is not None:
        yield Problem(place, f"tracer: {name} needs the whole space, and this is a manifold", cure, True)
        return
    if name == "relaxed" and any(_is_directed(solid, geometry) for solid in scene.objects):
        held = "that of a level plane" if geometry in FIBRED else "with empty zones it"
        message = f"tracer: relaxed needs distances all around; {held} holds along the ray"
        yield Problem(place, message, cure, True)
    if name == "compound" and geometry not in (*ISOTROPIC, *PRODUCTS):
        message = f"tracer: compound flows along any length at once, which in {geometry} is costly"
        yield Problem(place, message, cure, True)
    elif name == "compound" and not 2 <= len(scene.solids) <= MOST_COMPONENTS:
        message = f"tracer: compound marches 2 to {MOST_COMPONENTS} objects by themselves, and here are "
        help = f"{cure}; a union of objects is one object"
        yield Problem(place, f"{message}{len(scene.solids)}, with the balls of lights", help, True)
    if name == "binary":
        if geometry != "e3":
            yield Problem(place, f"tracer: binary is made for e3, not for {geometry}", cure, True)
        for k, light in enumerate(scene.lights):
            if light.shadows is not None and light.shadows.soft is not None:
                message = "soft shadows need a distance, and tracer: binary asks for none"
                help = "write 'shadows: hard', or another tracer"
                yield Problem(("lights", k, "shadows"), message, help, True)


def _block_start(scene: "Scene") -> Iterator[Problem]:
    found = None
    if scene.geometry != "e3":
        found = f"e3, and this is {scene.geometry}"
    elif scene.manifold is not None:
        found = "the whole space, and this is a manifold"
    elif scene.camera.projection.perspective is None:
        found = f"a perspective, and this is {scene.camera.projection.kind}"
    if found is not None:
        help = "leave it out, or write 'start: pixel'"
        yield Problem(("render", "start"), f"start: block needs {found}", help, True)


def _is_directed(solid: Solid, geometry: str) -> bool:
    """Whether the distance to a solid is bounded along the ray alone (`Writer.directed`)."""
    if isinstance(solid.shape, Krs):
        return bool(solid.shape.empty_zones)
    members = solid.shape if isinstance(solid.shape, tuple) else (solid.shape,)
    if any(isinstance(member, Solid) for member in members):
        return any(_is_directed(member, geometry) for member in members)
    return geometry in FIBRED and solid.kind in ("half-space", "slab") and solid.shape.normal[2] != 0
