"""How a picture is worked out, and the files it goes to."""

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import Field

from .base import Node, Problem, raised
from .context import Context
from .picture import default_size, size_problem
from .values import (
    Accuracy,
    AtLeast,
    Exposure,
    FlowStep,
    OutputFile,
    PixelSize,
    Positive,
    Samples,
    Seed,
    Steps,
)

# What an accuracy chooses.
CHOSEN = ("precision", "flow", "flow-step", "threshold", "steps")


class RenderSettings(Node):
    """How the picture is worked out."""

    what = "a mapping of render settings"
    example = "render: {size: [960, 540], samples: 4}"

    size: PixelSize = Field(
        default=(960, 540),
        description="Width and height of the picture in pixels, with both eyes where they stand beside or "
        "over each other. Left out: for each eye this; [1024, 512] where it is equirectangular; [720, 720] "
        "for a fisheye or dome.",
    )
    samples: Samples = Field(
        default=4, description="Rays for each pixel, spread over it evenly; more give smoother edges."
    )
    filter: Literal["box", "tent", "gaussian"] = Field(
        default="box",
        description="How densely the rays of a pixel lie about its middle, along both axes: `box` evenly, in "
        "the pixel; `tent` as 1 − |x|, up to 1 pixel away; `gaussian` as exp(−2 x²), up to 1.5 pixels away.",
    )
    seed: Seed = Field(
        default=0,
        description="Which rays of a pixel are taken; the same seed gives the same picture. With 0 the first "
        "ray, to which the channels beside the picture belong, goes through the middle.",
    )
    accuracy: Accuracy | None = Field(
        default=None,
        description="How far off what a pixel shows may be seen, at 99.9 % of the pixels: `half-pixel`, half "
        "of that as `quarter-pixel`, two pixels as `draft`, an angle, or `reference`, as little as can be. "
        "The cheapest precision, flow, threshold, steps and iterations are taken that reach it by what was "
        "measured ([docs/accuracy.md](accuracy.md)). Left out: what the keys below say.",
    )
    precision: Literal["auto", "single", "double"] = Field(
        default="auto", description="Arithmetic of the kernels. `auto` is single."
    )
    flow: Literal["exact", "euler", "rk2", "rk4", "rk8"] = Field(
        default="exact",
        description="How rays follow geodesics: `exact` by the closed form of the geometry, the others by "
        "integrating the geodesic equation (paper, appendix A): Euler's rule, the midpoint rule, that of "
        "Runge and Kutta, and Cooper and Verner's of order 8. To see what they cost; `exact` is better.",
    )
    flow_step: FlowStep | None = Field(
        default=None,
        alias="flow-step",
        description="The longest step of an integrator, in units of length. Left out: 0.1.",
    )
    steps: Steps = Field(
        default=300, description="The most steps a ray may take; then it shows what it has come nearest to."
    )
    threshold: Positive = Field(
        default=1e-4, description="A ray has hit a surface when it is closer than this."
    )
    detail: Positive | None = Field(
        default=None,
        description="Level of detail: nearer than so many pixels counts as a hit too, a pixel being as wide "
        "as Euclidean space makes it after the way from the eye. Left out: none.",
    )
    tracer: Literal["auto", "direct", "relaxed", "compound", "binary"] = Field(
        default="auto",
        description="How far rays go at once: `direct` by the distance to the scene; `relaxed` by 1.4 times "
        "that, and back where it was too far; `compound` marches each object by itself, the nearest first; "
        "`binary` (e3) tries out which balls are free. All but `direct` in the whole space only. `auto` is "
        "`relaxed` where one object is a sequence, `compound` where several are, both where they can be, and "
        "else `direct`.",
    )
    start: Literal["pixel", "block"] = Field(
        default="pixel",
        description="Where marching starts: `pixel` for each at the eye; `block` for 4x4 pixels together as "
        "far as the room about their middle is free for all of them (e3, perspective, no manifold).",
    )
    far: Positive | None = Field(
        default=None,
        description="How far a ray goes before it shows the background. Left out: chosen for the geometry.",
    )
    distance: Literal["auto", "domain", "creeping", "neighbours", "both"] = Field(
        default="auto",
        description="How the distance to the objects is found near the walls of a manifold's cell (paper, "
        "4.2): `domain` looks at this cell only, `creeping` stops at walls, `neighbours` looks over each "
        "wall, `both` does both. `auto` finds out for each object which images reach into the cell.",
    )
    finish: Literal["auto", "packet", "refill"] = Field(
        default="auto",
        description="What happens to the rays of a packet that end early: `packet` waits for the rest, "
        "`refill` starts new ones in their place. The picture is the same.",
    )

    @classmethod
    def fill(cls, data: dict[str, Any], context: Context) -> None:
        data.setdefault("size", list(default_size(context.projection, context.layout)))

    def check(self, context: Context) -> Iterator[Problem]:
        if problem := size_problem(context.projection, context.layout, self.size):
            yield Problem(("size",), *problem)
        if self.distance != "auto" and context.geometry is not None and not context.manifold:
            yield Problem(("distance",), f"distance: {self.distance} needs a manifold", "leave it out", True)
        if self.accuracy is not None:
            for name in CHOSEN:
                if name.replace("-", "_") in self.model_fields_set:
                    message = f"accuracy chooses the {name} itself"
                    yield Problem((name,), message, "leave one of them out", True)
            if self.detail is not None:
                message = "detail leaves out what is finer, and accuracy says how exact all of it is"
                yield Problem(("detail",), message, "leave one of them out", True)
        if self.flow == "exact" and self.flow_step is not None:
            message = "flow-step is that of an integrator, and the flow is exact"
            yield Problem(("flow-step",), message, "leave it out, or write a flow such as 'flow: rk4'", True)
        if self.far is not None and self.far <= self.threshold:
            yield Problem(("far",), f"far must be greater than threshold, which is {self.threshold:g}")


Channel = Literal["beauty", "depth", "normal", "object", "cell", "steps", "error"]


class Output(Node):
    """A file to write the picture to."""

    what = "an output"
    example = "- file: picture.png"

    file: OutputFile = Field(
        description="Name of the file, below the current folder: `.png` is made for the eye (sRGB), "
        "`.exr` keeps the linear numbers."
    )
    channels: Annotated[tuple[Channel, ...], AtLeast(1)] = Field(
        default=("beauty",),
        description="What an `.exr` holds: the picture, length of the ray, normal, number of the object, "
        "number of the cell, steps of the ray, and (`error`) an estimate of how far off, in radians, what is "
        "shown may be seen.",
    )
    shows: Literal["beauty", "depth", "steps", "error"] = Field(
        default="beauty",
        description="What a `.png` shows: the picture, or, as a heat map, the length of each ray, the "
        "number of its steps or the estimate of its error. White is 0, black is `most` and more, and "
        "grays between them are even in sRGB. Of the first ray of a pixel, as in the channels of an `.exr`.",
    )
    most: Positive | None = Field(
        default=None,
        description="What is black in a heat map. Left out: the largest that occurs. Depth is black as well "
        "where nothing is hit.",
    )
    exposure: Exposure = Field(
        default=0, description="Stops by which a `.png` is brighter than the light: each doubles it."
    )
    view: Literal["none", "filmic", "aces"] = Field(
        default="none",
        description="How a `.png` shows light brighter than a screen: `none` cuts it off at "
        "white, `filmic` bends it over softly and keeps middle gray, `aces` is ACES 2.0, which is darker.",
    )

    def check(self, context: Context) -> Iterator[Problem]:
        if "channels" in self.model_fields_set and self.file.lower().endswith(".png"):
            yield Problem(
                ("channels",), "a .png holds the picture only", "leave channels out, or write an .exr", True
            )
        if self.file.lower().endswith(".exr"):
            cure = "leave it out, or write a .png too"
            for name in ("shows", "most"):
                if name in self.model_fields_set:
                    help = "leave it out, and name what it holds in 'channels'"
                    yield Problem((name,), "an .exr keeps numbers and makes no heat map of them", help, True)
            for name in ("exposure", "view"):
                if name in self.model_fields_set:
                    message = f"an .exr keeps the linear numbers and takes no {name}"
                    yield Problem((name,), message, cure, True)
        elif self.shows != "beauty":
            for name in ("exposure", "view"):
                if name in self.model_fields_set:
                    message = f"a heat map of {self.shows} is no light and takes no {name}"
                    yield Problem((name,), message, "leave it out", True)
        elif "most" in self.model_fields_set:
            message = "most says what is black in a heat map, and this is the picture"
            yield Problem(("most",), message, "add 'shows: steps' or 'shows: depth', or leave it out", True)
        for index, channel in enumerate(self.channels):
            if channel in self.channels[:index]:
                yield Problem(("channels", index), f"'{channel}' is listed twice")


def different_files(outputs: tuple[Output, ...]) -> tuple[Output, ...]:
    first: dict[str, int] = {}
    problems = [
        Problem(
            (index, "file"), f"'{output.file}' is the file of output {first[output.file.lower()] + 1} already"
        )
        for index, output in enumerate(outputs)
        # Names that differ in case only are one file on some systems.
        if first.setdefault(output.file.lower(), index) != index
    ]
    if problems:
        raise raised("outputs", problems)
    return outputs
