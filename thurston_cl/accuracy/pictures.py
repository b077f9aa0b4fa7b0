"""How wrong a whole picture is, pixel by pixel, and what of it a viewer can see.

A method is compared with the truth (`thurston_cl.accuracy.rays.ExactRays`) in two ways.

As in the paper (A.2.2), its *angle error* is the angle between the direction of a pixel and the nearest one
whose exact geodesic comes to the point that the method has found, in a manifold to an image of it. The *depth
error* is how much longer the ray is than the true one that shows the same object.

A viewer does not see where a ray ends but what the pixel shows. So a pixel is *over half a pixel* off where

- it shows an object, or the background, that the exact picture does not show within half a pixel of it; or
- it shows the object at a depth at which the exact picture does not show it within half a pixel: another
  surface of it, or nothing that is there. A depth within the range of those that are shown around is right,
  and so is one that differs by what half a pixel covers there, and the threshold that the method stops at:
  that is not seen; or
- the point of the surface that it shows, which is the one nearest to where the ray ended, is seen more than
  half a pixel elsewhere. For rays that end on the surface this is the angle error. Rays end above it by up to
  the threshold, so that what grazes a surface is displaced, and what meets it head on is not.

Where the truth is finer than a pixel, as far away in a cell of finite volume, any of what is within half a
pixel is right, and so is anything that fog hides in both. A ray that came to nothing (NaN) shows the
background. Light and mirrors are not compared.
"""

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thurston_cl import device as devices
from thurston_cl.accuracy.rays import Array, Ends, ExactRays, Flags, Offsets, Places, Rays
from thurston_cl.device import Device
from thurston_cl.method import Method
from thurston_cl.scene import schema
from thurston_cl.scene.choice import WORDS, method_of
from thurston_cl.scene.picture import Area, Size, views
from thurston_cl.scene.pixel import half_pixels

# Percentiles that are told of errors.
PERCENTILES = {"50": 50.0, "95": 95.0, "99": 99.0, "99.9": 99.9, "max": 100.0}

# What fog leaves less of is not seen: half a step of 8 bits.
SEEN = 1 / 512

# Where the truth is looked at within half a pixel: on the circle, and where that shows nothing like it more
# closely, on a spiral that fills the disc.
_ON_CIRCLE = 8
_IN_DISC = 40
GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))

# An angle to first order is worked out again, by Newton's method from there, where it is above this share of
# half a pixel; and above the second where so large a part of it may be beyond first order.
_REFINED_ABOVE = 0.25
_REFINED_FROM = 0.02
_BENT = 0.1
_NEWTON_STEPS = 16
# No further at once, in radians and in length: where fields are nearly parallel first order leads far away.
_MOST_TURN = 0.05
_MOST_LENGTH = 0.1
# It has come to the point where no more than this is missing, as a share of the angle or half a pixel, and
# where the point is so near: one farther away may be meant in another image.
_ENOUGH = 0.01
_FAR = 0.1
# Other images are looked for where half a pixel covers so much, in so many places on either side, so far
# apart.
_CROWDED = 1.0
_ASIDE = 100
_APART = 3.0
# Beyond so many places the first that is well within half a pixel will do.
_ASIDE_NEAR = 12


@dataclass(frozen=True)
class Errors:
    """What is wrong at places of a picture: arrays (N,), NaN where there is no such error.

    angle, shown: the angle error and that of the surface point which is shown, in radians; `half_pixel` as an
    angle there. depth: by how much the method's ray is longer than the true one, where both show the same
    object; relative_depth: as a share of that. id_differs: whether they show different objects. over: whether
    the pixel is over half a pixel off. method, truth: what the rays came to.
    """

    places: Places
    method: Ends
    truth: Ends
    half_pixel: Array
    angle: Array
    shown: Array
    depth: Array
    relative_depth: Array
    id_differs: Flags
    over: Flags

    @property
    def summary(self) -> dict[str, Any]:
        """Counts, fractions of the pixels, and percentiles of the errors; None where there are none."""
        marched = self.method.marched
        count = int(marched.sum())

        def share(of: Flags) -> float:
            return float(of[marched].mean()) if count else 0.0

        return {
            "n": count,
            "ids_differ": share(self.id_differs),
            "over_half_pixel": share(self.over),
            "nan": share(self.method.lost),
            "out_of_steps": share(self.method.out_of_steps),
            "truth_unsure": share(self.truth.lost | self.truth.out_of_steps),
            "angle": quantiles(self.angle),
            "angle_pixels": quantiles(self.angle / (2 * self.half_pixel)),
            "shown": quantiles(self.shown),
            "depth": quantiles(np.abs(self.depth)),
            "relative_depth": quantiles(np.abs(self.relative_depth)),
        }


def quantiles(values: Array) -> dict[str, float] | None:
    """The `PERCENTILES` of the values that are numbers; None where there are none."""
    known = values[~np.isnan(values)]
    if len(known) == 0:
        return None
    # Not interpolated: infinity may be one of them.
    found = np.percentile(known, list(PERCENTILES.values()), method="higher")
    return dict(zip(PERCENTILES, map(float, found), strict=True))


def all_places(
    scene: schema.Scene, size: Size | None = None, shift: ArrayLike = (0.5, 0.5), area: Area | None = None
) -> Places:
    """Every pixel of an area (left, top, right, bottom) of a picture, by default of all of it, for each eye
    that adds to it, seen at the place `shift` in the pixel.
    """
    size = size or scene.render.size
    found: list[Places] = []
    for view in views(scene.camera.layout, size, area or (0, 0, *size)):
        left, top, right, bottom = view.area
        rows, columns = np.mgrid[top:bottom, left:right].reshape(2, -1)
        pixel = np.stack([columns, rows], axis=1).astype(np.float64)
        shifts = np.broadcast_to(np.asarray(shift, np.float64), pixel.shape)
        found.append(Places(np.full(len(pixel), view.eye), pixel, shifts))
    names = [field.name for field in dataclasses.fields(Places)]
    return Places(*(np.concatenate([getattr(one, name) for one in found]) for name in names))


def errors(
    scene: schema.Scene,
    method: Method | None = None,
    device: Device | None = None,
    size: Size | None = None,
    places: Places | None = None,
) -> Errors:
    """What is wrong in a picture of a scene by a method, by default the scene's own.

    size: of the whole picture, in place of the scene's. places: by default all pixels, at their middles.
    Raises SceneError as rendering does, NoDeviceError where the device has no double precision.
    """
    device = device or devices.choose()
    exact = ExactRays(scene, device, size)
    rays = Rays(scene, method or method_of(scene, device, size=size)[0], device, size)
    where = all_places(scene, size) if places is None else places
    return compare(rays, exact, where, rays.trace(where))


def compare(
    rays: Rays,
    exact: ExactRays,
    places: Places,
    ends: Ends,
    truth: Ends | None = None,
    near: float | None = None,
    target: str | float = "half-pixel",
) -> Errors:
    """The errors of what rays of places came to. `truth`: what the exact rays of the same places come to,
    where that is known; `near`: the threshold that they were marched with, where it is not the method's;
    `target`: what counts as too far off in place of half a pixel, see `allowed_angles`.
    """
    truth = exact.trace(places) if truth is None else truth
    half = half_pixels(rays.scene.camera, rays.size, *places.xy.T)
    allowed = allowed_angles(target, half)
    reach = rays.threshold_at(np.nan_to_num(ends.length), near)
    count = len(places)
    angle, shown, area = np.full(count, np.nan), np.full(count, np.nan), np.zeros(count)
    hit = ends.object > 0
    if hit.any():
        found = _angles(exact, places[hit], ends[hit], allowed[hit], reach[hit])
        angle[hit], shown[hit], area[hit] = found

    differ = ends.marched & (ends.object != truth.object)
    both = hit & (truth.object == ends.object)
    depth = np.where(both, ends.length - truth.length, np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = depth / truth.length
    tolerance = allowed * np.sqrt(area) + reach
    # NaN counts as wrong, with `not ... <=`.
    elsewhere = hit & ~(shown <= allowed)
    strange = differ | (both & ~(np.abs(depth) <= tolerance))
    hidden = (ends.clear < SEEN) & (truth.clear < SEEN)
    elsewhere, strange = elsewhere & ~hidden, strange & ~hidden
    suspects = np.flatnonzero(strange & ~elsewhere)
    for offsets in (_circle(_ON_CIRCLE), _disc(_IN_DISC)):
        k = suspects
        around = places[k].around(offsets, allowed[k] / half[k])
        seen = _is_seen(exact, around, ends[k], truth[k], tolerance[k])
        strange[suspects[seen]] = False
        suspects = suspects[~seen]
    over = elsewhere | strange
    return Errors(places, ends, truth, half, angle, shown, depth, relative, differ, over)


def allowed_angles(target: str | float, half: Array) -> Array:
    """How far off pixels may be (N,): what a word of an accuracy means at each, `half` (N,) being half a
    pixel, or an angle in radians. "reference" names none: half a pixel.
    """
    if isinstance(target, str):
        return WORDS.get(target, 1.0) * half
    return np.full(half.shape, target)


def _circle(count: int) -> Array:
    """Places on the circle of half a pixel (count,2), in pixels."""
    turns = 2 * np.pi * np.arange(count) / count
    return 0.5 * np.stack([np.cos(turns), np.sin(turns)], axis=1)


def _disc(count: int) -> Array:
    """Places in the disc of half a pixel (count,2), in pixels, evenly."""
    index = np.arange(count) + 0.5
    radius, turns = 0.5 * np.sqrt(index / count), GOLDEN_ANGLE * index
    return np.stack([radius * np.cos(turns), radius * np.sin(turns)], axis=1)


def _is_seen(exact: ExactRays, around: Places, ends: Ends, truth: Ends, tolerance: Array) -> Flags:
    """Whether the truth shows at some of the places `around` each the object that its ray ended at, and
    about as far away; the place itself counts with them.
    """
    count = len(truth.length)
    if count == 0:
        return np.zeros(0, dtype=bool)
    found = exact.trace(around)
    objects = np.concatenate([found.object.reshape(count, -1), truth.object[:, None]], axis=1)
    lengths = np.concatenate([found.length.reshape(count, -1), truth.length[:, None]], axis=1)
    same = objects == ends.object[:, None]
    # The background has no depth.
    nearest = np.where(same, lengths, np.inf).min(axis=1)
    farthest = np.where(same, lengths, -np.inf).max(axis=1)
    deep_enough = (ends.length >= nearest - tolerance) & (ends.length <= farthest + tolerance)
    return np.asarray(same.any(axis=1) & ((ends.object == 0) | deep_enough))


def _angles(
    exact: ExactRays, places: Places, ends: Ends, half: Array, reach: Array
) -> tuple[Array, Array, Array]:
    """The angle error (N,) and that of what is shown (N,), in radians, and the area (N,) of a solid angle of
    1 there.
    """
    found = exact.offsets(places, np.zeros((len(places), 2)), ends.length, ends, reach)
    if exact.scene.lattice is not None:
        off = ~(np.hypot(*found.turn.T) <= _REFINED_FROM * half)
        far = np.flatnonzero(off & (found.distance > _FAR) & (found.widest[1] * half > _CROWDED))
        _look_aside(exact, places, ends, half, reach, found, far)
    feet = dataclasses.replace(ends, point=found.foot)
    angle = _refined(exact, places, ends, found.turn, found, half)
    shown = _refined(exact, places, feet, found.shown, found, half)
    return angle, shown, found.area


def _look_aside(
    exact: ExactRays,
    places: Places,
    ends: Ends,
    half: Array,
    reach: Array,
    found: Offsets,
    far: NDArray[np.intp],
) -> None:
    """Take other images of the points of `far` places where a smaller turn leads to them, and put that into
    `found`.

    Where geodesics part like e^t, an error of rounding leads cells aside, and then the nearest image is any.
    So they are looked for where the geodesics of turns within half a pixel are, along the direction in which
    these part the most.
    """
    aside, width = found.widest
    for k in (0, *(sign * k for k in range(1, _ASIDE + 1) for sign in (1, -1))):
        shift = k * _APART / width[far]
        far, shift = far[np.abs(shift) < half[far]], shift[np.abs(shift) < half[far]]
        enough = _REFINED_FROM if abs(k) <= _ASIDE_NEAR else _REFINED_ABOVE
        far_left = ~(np.hypot(*found.turn[far].T) <= enough * half[far])
        far, shift = far[far_left], shift[far_left]
        if len(far) == 0:
            break
        at = shift[:, None] * aside[far]
        other = exact.offsets(places[far], at, ends.length[far], ends[far], reach[far], by_turn=True)
        turn = at + other.turn
        better = np.hypot(*turn.T) < np.hypot(*found.turn[far].T)
        found.turn[far[better]] = turn[better]
        found.shown[far[better]] = (at + other.shown)[better]
        found.length[far[better]] = other.length[better]
        found.distance[far[better]] = other.distance[better]


def _refined(exact: ExactRays, places: Places, ends: Ends, turn: Array, first: Offsets, half: Array) -> Array:
    """The angles (N,) of turns (N,2) that lead to first order to the points of `ends`, which are `first` off.

    By Newton's method where they are no small share of half a pixel, or far from first order. Where that does
    not come to the point, as behind a fold of the wave front, where no direction leads to it, the larger of
    the first and the last angle stands.
    """
    angle = np.minimum(np.hypot(*turn.T), np.pi)
    # Beyond first order is about the square of the distance, over what a turn moves the point by at least.
    bent = first.distance**2 * first.widest[1] > _BENT * angle * first.area
    going = np.flatnonzero(~(angle <= _REFINED_ABOVE * half) | (bent & (angle > _REFINED_FROM * half)))
    step, ahead = turn[going], first.length[going]
    at, length, nowhere = np.zeros((len(going), 2)), ends.length[going], np.zeros(len(going))
    for _ in range(_NEWTON_STEPS):
        if len(going) == 0:
            break
        size = np.hypot(*step.T)
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.minimum(1.0, np.minimum(_MOST_TURN / size, _MOST_LENGTH / np.abs(ahead)))
            at = at + np.nan_to_num(step * share[:, None])
            length = np.maximum(length + np.nan_to_num(ahead * share), 0.0)
        found = exact.offsets(places[going], at, length, ends[going], nowhere)
        step, ahead = found.turn, found.length
        missing, reached = np.hypot(*step.T), np.hypot(*(at + step).T)
        there = (missing <= _ENOUGH * np.maximum(reached, half[going])) & (found.distance < _FAR)
        angle[going[there]] = reached[there]
        going, at, length = going[~there], at[~there], length[~there]
        step, ahead, nowhere = step[~there], ahead[~there], nowhere[~there]
    angle[going] = np.maximum(angle[going], np.minimum(np.hypot(*(at + step).T), np.pi))
    return angle


def worst(found: Errors, count: int) -> NDArray[np.intp]:
    """The numbers of the `count` worst places: first those over half a pixel, then by what is shown."""
    size = np.where(np.isnan(found.shown), 0.0, found.shown / found.half_pixel)
    order = np.lexsort((-size, ~found.over))
    return order[:count]
