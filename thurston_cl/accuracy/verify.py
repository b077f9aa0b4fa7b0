"""Is what a picture shows right? Some of its pixels, traced again in double (`thurston render --verify`)."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import beta

from thurston_cl.accuracy.pictures import Errors, all_places, compare, worst
from thurston_cl.accuracy.rays import Array, ExactRays, Places, Rays
from thurston_cl.device import Device
from thurston_cl.method import Method
from thurston_cl.sampling import sample_shifts
from thurston_cl.scene import schema
from thurston_cl.scene.choice import MISSED, WORDS
from thurston_cl.scene.picture import Area, Size

SEED = 1
# So many of the random pixels have to be as exact as was asked for.
REACHED = 1 - MISSED
# How sure it is what is said of all pixels by some.
CONFIDENCE = 0.95
# So many of the worst pixels are named.
NAMED = 5
# Pixels among which those with the largest estimate are looked for, for each of these, and at least: all of a
# small picture, and of a large one as many as take no longer than the picture.
CANDIDATES = 20
LEAST_CANDIDATES = 1 << 16


@dataclass(frozen=True)
class Verification:
    """The errors of pixels drawn by chance, and of those whose estimated error is the largest."""

    drawn: Errors
    suspected: Errors
    target: str | float | None
    seed: int
    seconds: float

    @property
    def words(self) -> list[str]:
        """What was found, in a few lines."""
        lines = [
            _in_words(f"{len(self.drawn.places)} random pixels", self.drawn, self._within),
            _in_words(
                f"the {len(self.suspected.places)} with the largest estimate", self.suspected, self._within
            ),
        ]
        lines += self._verdict
        found = self.worst[:NAMED]
        if found and found[0]["over_half_pixel"]:
            named = ", ".join(_place_in_words(one) for one in found if one["over_half_pixel"])
            lines.append(f"worst: {named}")
        return lines

    @property
    def reached(self) -> bool:
        """Whether enough of the random pixels are as exact as was asked for."""
        return bool(self.drawn.summary["over_half_pixel"] <= MISSED)

    @property
    def _verdict(self) -> list[str]:
        """What follows from the random pixels, and how surely."""
        count = self.drawn.summary["n"]
        if count == 0:
            return []
        if self.target == "reference":
            return ["this compares the truth with itself: only mpmath tells how exact it is (--verify-mp)"]
        over = round(self.drawn.summary["over_half_pixel"] * count)
        # Clopper and Pearson's bound.
        most = float(beta.ppf(CONFIDENCE, over + 1, count - over)) if over < count else 1.0
        sure = f"with {CONFIDENCE:.0%} confidence at most {most:.2%} of the picture miss it"
        if self.target is not None:
            verdict = "is reached" if self.reached else "is NOT reached"
            return [f"{REACHED:.1%} within {self._within}: this {verdict} at random pixels ({sure})"]
        if self.reached:
            return [sure.replace("miss it", "are over half a pixel off")]
        return [
            f"{over / count:.2%} of the random pixels are over half a pixel off: --accuracy half-pixel takes "
            "settings that are more exact"
        ]

    @property
    def _within(self) -> str:
        """What counts as right, in words."""
        if isinstance(self.target, float):
            return f"{self.target:g} rad"
        halves = WORDS.get(self.target or "half-pixel", 1.0)
        return "half a pixel" if halves == 1 else f"{halves / 2:g} pixels"

    @property
    def worst(self) -> list[dict[str, Any]]:
        """The worst pixels of both, the worst first, each with its place and what is wrong there."""
        found = [
            _pixel(errors, int(k)) for errors in (self.drawn, self.suspected) for k in worst(errors, NAMED)
        ]
        unique = {(one["eye"], *one["pixel"], *one["place"]): one for one in found}
        return sorted(
            unique.values(), key=lambda one: (not one["over_half_pixel"], -(one["shown_pixels"] or 0))
        )

    @property
    def report(self) -> dict[str, Any]:
        """All of it, for JSON; `n` and the fractions are of pixels that were marched."""
        return {
            "target": self.target or "half-pixel",
            "reached": self.reached,
            "seed": self.seed,
            "seconds": self.seconds,
            "random": self.drawn.summary,
            "largest_estimate": self.suspected.summary,
            "worst": self.worst[: 2 * NAMED],
        }


def verify(
    scene: schema.Scene,
    count: int,
    method: Method,
    device: Device,
    size: Size | None = None,
    samples: int | None = None,
    area: Area | None = None,
    target: str | float | None = None,
    seed: int = SEED,
) -> Verification:
    """Trace `count` pixels of a picture again, drawn by chance, each at one of its samples, and as many with
    the largest estimated error, at their first sample; of a large picture those of a random part.

    method: that of the picture. size, samples, area (left, top, right, bottom): of the picture, the scene's
    where they are None. target: the accuracy that was asked for, a word or an angle; half a pixel where it is
    None. Where a picture has fewer pixels all of them are traced. Raises as
    `thurston_cl.accuracy.pictures.errors`.
    """
    started = time.perf_counter()
    exact = ExactRays(scene, device, size)
    rays = Rays(scene, method, device, size, estimate=True)
    drawn = random_places(scene, count, size, samples, area, seed)
    pixels = all_places(scene, size, _shifts(scene, samples)[0], area)
    candidates = pixels
    most = max(CANDIDATES * count, LEAST_CANDIDATES)
    if len(pixels) > most:
        chosen = np.random.default_rng(seed).choice(len(pixels), most, replace=False)
        candidates = pixels[np.sort(chosen)]
    ends = rays.trace(candidates)
    largest = np.argsort(-ends.estimate, kind="stable")[: min(count, len(candidates))]
    return Verification(
        compare(rays, exact, drawn, rays.trace(drawn), target=target or "half-pixel"),
        compare(rays, exact, candidates[largest], ends[largest], target=target or "half-pixel"),
        target,
        seed,
        time.perf_counter() - started,
    )


def random_places(
    scene: schema.Scene,
    count: int,
    size: Size | None = None,
    samples: int | None = None,
    area: Area | None = None,
    seed: int = SEED,
) -> Places:
    """`count` pixels of a picture drawn by chance, none twice, each at one of its samples; as `verify`."""
    random = np.random.default_rng(seed)
    pixels = all_places(scene, size, area=area)
    drawn = pixels[random.permutation(len(pixels))[:count]]
    shifts = _shifts(scene, samples)
    return Places(drawn.eye, drawn.pixel, shifts[random.integers(len(shifts), size=len(drawn))])


def _shifts(scene: schema.Scene, samples: int | None) -> Array:
    settings = scene.render
    return sample_shifts(settings.samples if samples is None else samples, settings.filter, settings.seed)


def _in_words(which: str, errors: Errors, within: str) -> str:
    summary = errors.summary
    count = summary["n"]
    if count == 0:
        return f"{which}: none was marched"
    over, other = (round(summary[key] * count) for key in ("over_half_pixel", "ids_differ"))
    text = (
        f"{which}: {count - over} of {count} within {within} ({1 - summary['over_half_pixel']:.2%}), "
        f"{other} show another object"
    )
    if unsure := round(summary["truth_unsure"] * count):
        text += f", of {unsure} the truth is not known"
    pixels, angle = summary["angle_pixels"], summary["angle"]
    if pixels is None or angle is None:
        return text
    spread = ", ".join(f"{name}{'' if name == 'max' else ' %'} {pixels[name]:.2g}" for name in pixels)
    return f"{text}; angle error in pixels {spread} (max {angle['max']:.2g} rad)"


def _place_in_words(one: dict[str, Any]) -> str:
    x, y = one["pixel"]
    eye = f" of eye {one['eye'] + 1}" if one["eye"] else ""
    if one["object"] != one["true_object"]:
        return f"{x},{y}{eye} shows object {one['object']} instead of {one['true_object']}"
    if one["shown_pixels"] is not None and one["shown_pixels"] > 0.5:
        return f"{x},{y}{eye} off by {one['shown_pixels']:.2g} pixels"
    return f"{x},{y}{eye} at the depth {one['depth']:.6g} instead of {one['true_depth']:.6g}"


def _pixel(errors: Errors, k: int) -> dict[str, Any]:
    """What is known of one pixel."""
    width = 2 * errors.half_pixel[k]
    x, y = (int(value) for value in errors.places.pixel[k])
    return {
        "pixel": [x, y],
        "eye": int(errors.places.eye[k]),
        "place": [float(value) for value in errors.places.xy[k]],
        "over_half_pixel": bool(errors.over[k]),
        "object": int(errors.method.object[k]),
        "true_object": int(errors.truth.object[k]),
        "angle": _number(errors.angle[k]),
        "angle_pixels": _number(errors.angle[k] / width),
        "shown_pixels": _number(errors.shown[k] / width),
        "depth": _number(errors.method.length[k]),
        "true_depth": _number(errors.truth.length[k]),
    }


def _number(value: NDArray[np.float64] | float) -> float | None:
    return float(value) if np.isfinite(value) else None
