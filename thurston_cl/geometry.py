"""The numerical back-end over arrays: geodesic flow, distance, all geodesics, light intensity, in one
geometry.

Points are 4-vectors of the geometry's model (paper sections 7.1-7.3): [x, y, z, 1] in e3; [x, y, z, w] on the
unit sphere in s3 and on the sheet x^2 + y^2 + z^2 - w^2 = -1, w > 0 in h3, with the origin [0, 0, 0, 1]; in
s2xe and h2xe (paper 8.1) [x, y, z] is on the unit sphere or on the sheet x^2 + y^2 - z^2 = -1, z > 0 and w on
the line, with the origin [0, 0, 1, 0]. Nil (9) has [x, y, z, 1] in the rotation-invariant model; sl2 (10) has
[x, y, z, w] with the same sheet over [x, y] and w along the fibre, and the origin [0, 0, 1, 0]; sol (11) has
[x, y, z, 1] with the metric e^(-2z) dx^2 + e^(2z) dy^2 + dz^2.
Directions have three components: a unit vector in the frame at a point p that translation(p), left
translation in nil, sl2 and sol and else the transvection from the origin to p, carries from the origin.
Lengths are in units of the geometry's curvature. Arrays are float64, first axis N, whatever the precision
inside.
"""

import functools
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thurston_cl import device as devices
from thurston_cl.arrays import Array, ArrayProgram, finite
from thurston_cl.flows import Flow
from thurston_cl.models import HOMOGENEOUS, MODEL, ORIGIN, off_model
from thurston_cl.program import Source, geometry_parts

if TYPE_CHECKING:
    from thurston_cl.device import Device

# How far an input may be off its model or its unit length: far above rounding, far below a mistake.
MODEL_TOLERANCE = 1e-6

# Coordinates whose squares still fit single precision: in h3 points up to a distance of 44.
SINGLE_LIMIT = 1e19
# Heights z in sol for which e^z and e^-z fit the precision.
SOL_HEIGHT_LIMIT = {"single": 87.0, "double": 708.0}


class Geometry:
    """One of Thurston's geometries on one OpenCL device.

    name: one of `thurston_cl.models.GEOMETRIES`. precision: "single" or "double", the arithmetic inside.
    device: what `--device` accepts, None for the default choice. flow, step, equation: how `flow` follows
    geodesics, see `thurston_cl.flows.Flow`; all else is exact. lanes: width of the kernels, None for the
    device's default. Raises ValueError for unknown names and wrong arrays, NoDeviceError where nothing can
    build a kernel.
    """

    def __init__(
        self,
        name: str,
        precision: str = "double",
        device: "str | Device | None" = None,
        flow: str = "exact",
        lanes: int | None = None,
        *,
        step: float | None = None,
        equation: str = "left-invariant",
    ) -> None:
        self.followed = Flow(name, flow, step, equation)
        self.name = name
        self.precision = precision
        parts = (*geometry_parts(name), *self.followed.parts, "arrays.h", "flow.cl")
        self._flow = ArrayProgram(Source(parts, {}, self.followed.generated), precision, device, lanes)
        self.device = self._flow.device
        self.lanes = self._flow.lanes

    def __repr__(self) -> str:
        flow = "" if self.followed.step is None else f", {self.followed.words}"
        return f"<Geometry {self.name}, {self.precision} precision{flow}, on {self.device.info.name}>"

    @functools.cached_property
    def _program(self) -> ArrayProgram:
        """Everything beside the flow, built when it is first asked for."""
        source = Source((*geometry_parts(self.name), "arrays.h", "numerics.cl"))
        return ArrayProgram(source, self.precision, self.device, self.lanes)

    @property
    def flow_seconds(self) -> float:
        """How long the device was at work on the last `flow`, without the way there and back."""
        return self._flow.seconds

    def flow(
        self, direction: ArrayLike, time: ArrayLike, base: ArrayLike | None = None
    ) -> tuple[Array, Array]:
        """Follow geodesics from `base` (N,4; default the origin) along `direction` (N,3) for the length
        `time` (N,).

        Returns the points (N,4) and the directions of travel there (N,3). Paper 7.1-7.3, 9.1, 10.3, 11.2,
        without cases; math of the frame: `isotropic.h`, `product.h`, `nil.h`, `sl2.h`, `sol.h`. By an
        integrator (appendix A) where the geometry was made with one: its equal steps begin at the origin and
        are translated to `base`, and what takes more than a million of them is NaN.
        """
        u, t, b = self._rays(direction, time, base)
        out = self._flow.run("numerics_flow", [b, u, *self._flow.with_tail(t)], 7)
        beyond = int((~np.isfinite(out).all(axis=1)).sum())
        if beyond:
            warnings.warn(
                f"flow: {beyond} of {len(out)} points are too far away for {self.precision} precision"
                + (f" and {self.followed.words}" if self.followed.step is not None else ""),
                RuntimeWarning,
                stacklevel=2,
            )
        return out[:, :4], out[:, 4:]

    def velocity(self, point: ArrayLike, direction: ArrayLike) -> Array:
        """The ambient velocity (N,4) of a unit `direction` (N,3) in the frame at `point` (N,4)."""
        p = self._points("point", point)
        u = self._directions(direction)
        p, u = _together(p, u)
        return self._run("velocity", [p, u], 4)

    def transport(self, direction: ArrayLike, time: ArrayLike, base: ArrayLike | None = None) -> Array:
        """Parallel transport (N,3,3) along the geodesics of `flow`, from the frame at the start to the frame
        at the end.

        From the origin it is the identity where frames are transported along these geodesics themselves
        (paper 7.4). In nil and sl2 frames are left-invariant, and it is the matrix Q of paper 9.2 and 10.3.
        NaN, with a RuntimeWarning, where it is not worked out that far.
        """
        u, t, b = self._rays(direction, time, base)
        out = self._run("transport", [b, u, *self._program.with_tail(t)], 9)
        _warn_too_far("transport", "matrices", out, self.precision)
        return out.reshape(-1, 3, 3)

    def distance(self, point: ArrayLike, base: ArrayLike | None = None) -> Array:
        """The exact distance (N,) of `point` (N,4) from `base` (N,4; default the origin)."""
        out = self._run("distance", self._pair_with_tails(point, base), 2)
        _warn_unsolved("distance", out[:, 1])
        return out[:, 0]

    def underestimate(self, point: ArrayLike) -> Array:
        """A lower bound (N,) of the distance of `point` (N,4) from the origin, cheap enough to march with."""
        return self._run("underestimate", [self._points("point", point)], 1)[:, 0]

    @overload
    def geodesics(
        self, point: ArrayLike, count: int, base: ArrayLike | None = None, families: Literal[False] = False
    ) -> tuple[Array, Array]: ...

    @overload
    def geodesics(
        self, point: ArrayLike, count: int, base: ArrayLike | None = None, *, families: Literal[True]
    ) -> tuple[Array, Array, NDArray[np.bool_]]: ...

    def geodesics(
        self, point: ArrayLike, count: int, base: ArrayLike | None = None, families: bool = False
    ) -> tuple[Array, Array] | tuple[Array, Array, NDArray[np.bool_]]:
        """The `count` shortest geodesics from `base` (N,4; default the origin) to `point` (N,4).

        Returns directions at the base (N,count,3) and lengths (N,count), shortest first, NaN where there are
        fewer: e3 and h3 have one; s3 has two shorter than 2 pi, and each again with every full turn (paper
        7.5). h2xe has one; s2xe has as many as s3: those of the sphere, risen to the same end (8.4). nil and
        sl2 have one, and two more for each full turn that can reach the height (9.4, 10.4), complete and in
        order up to rounding. With `families` also flags (N,count): whether a geodesic is one of a whole
        family, equally long, of which one is returned. Such are, in s3, all to the antipode and those with
        turns to the base itself, turned in any way (here along z); in s2xe those over the same point of the
        sphere, with turns, and over antipodes, turned about the line (here over +x); in nil and sl2 those
        right above or below the base on its fibre, where two of each number of turns fuse to a circle,
        turned about the fibre (here over +x). The fibre itself comes last there. sol has one to points of the
        hyperbolic planes through the base, and else those with up to eight whole periods, which are all that
        are shorter than 35.5: in order, and complete as far as searches tell. No family is flagged there.
        RuntimeWarning where a solve ended at the bound of iterations.
        """
        if isinstance(count, bool) or not isinstance(count, (int, np.integer)) or count < 1:
            raise ValueError(f"count is {count}; expected a whole number of at least 1")
        arrays = self._pair_with_tails(point, base)
        out = np.stack([self._run("geodesic", arrays, 6, k) for k in range(count)], axis=1)
        _warn_unsolved("geodesics", out[:, :, 4])
        found = out[:, :, :3], out[:, :, 3]
        return (*found, out[:, :, 5] != 0) if families else found

    def area_density(self, direction: ArrayLike, time: ArrayLike) -> Array:
        """Area of the wave front per solid angle (N,) after `time` (N,) along `direction` (N,3); intensity
        is its inverse (5.7). inf where it is more than the precision has numbers for; NaN, with a
        RuntimeWarning, where it is not worked out that far.
        """
        u, t, _ = self._rays(direction, time, None)
        out = self._run("area_density", [u, *self._program.with_tail(t)], 1)
        _warn_too_far("area_density", "values", out, self.precision)
        return out[:, 0]

    def translate(self, base: ArrayLike, point: ArrayLike) -> Array:
        """translation(base) applied to `point` (N,4): the isometry that carries the origin to `base`."""
        return self._run(
            "translate", list(_together(self._points("base", base), self._points("point", point))), 4
        )

    def untranslate(self, base: ArrayLike, point: ArrayLike) -> Array:
        """The inverse of translation(base) applied to `point` (N,4)."""
        return self._run(
            "untranslate", list(_together(self._points("base", base), self._points("point", point))), 4
        )

    def translation_matrix(self, base: ArrayLike) -> Array:
        """translation(base) as matrices (N,4,4), or (N,5,5) in s2xe, h2xe and sl2, on homogeneous columns.

        Those are points, [x, y, z, w], with a fifth coordinate 1 where matrices are 5x5: the line or fibre is
        moved by its last column. In sl2 the fibre coordinate of the image gains an angle besides, which no
        matrix gives but that determines (`with_fibre_gain` in `sl2.h`).
        """
        b = self._points("base", base)
        frame = np.stack([self.velocity(b, direction) for direction in np.eye(3)], axis=2)
        if HOMOGENEOUS[self.name] == 4:
            return np.concatenate([frame, b[:, :, None]], axis=2)
        matrix = np.zeros((len(b), 5, 5))
        matrix[:, :3, :2] = frame[:, :3, :2]
        matrix[:, :3, 2] = b[:, :3]
        matrix[:, 3, 3], matrix[:, 3, 4], matrix[:, 4, 4] = 1, b[:, 3], 1
        return matrix

    def _rays(
        self, direction: ArrayLike, time: ArrayLike, base: ArrayLike | None
    ) -> tuple[Array, Array, Array]:
        u = self._directions(direction)
        t = finite("time", time)
        if t.ndim > 1:
            raise ValueError(f"time has shape {t.shape}; expected (N,) or a number")
        b = self._points("base", ORIGIN[self.name] if base is None else base)
        u, t2, b = _together(u, t.reshape(-1, 1), b)
        return u, t2[:, 0], b

    def _pair_with_tails(self, point: ArrayLike, base: ArrayLike | None) -> list[Array]:
        p = self._points("point", point)
        b = self._points("base", ORIGIN[self.name] if base is None else base)
        b, p = _together(b, p)
        # The difference of nearby points is exact only with their tails.
        return [b, p, self._program.tail(b), self._program.tail(p)]

    def _directions(self, direction: ArrayLike) -> Array:
        u = _rows("direction", direction, 3)
        off = np.abs(np.linalg.norm(u, axis=1) - 1)
        if off.size and off.max() > MODEL_TOLERANCE:
            worst = int(off.argmax())
            raise ValueError(
                f"direction {worst} has length {np.linalg.norm(u[worst]):.6g}; expected a unit vector"
            )
        return u

    def _points(self, what: str, points: ArrayLike) -> Array:
        p = _rows(what, points, 4)
        if not p.size:
            return p
        if self.precision == "single" and np.abs(p).max() > SINGLE_LIMIT:
            worst = int(np.abs(p).max(axis=1).argmax())
            raise ValueError(f"{what} {worst} is too far away for single precision; use precision='double'")
        if self.name == "sol" and np.abs(p[:, 2]).max() > SOL_HEIGHT_LIMIT[self.precision]:
            worst = int(np.abs(p[:, 2]).argmax())
            cure = "; use precision='double'" if self.precision == "single" else ""
            raise ValueError(f"{what} {worst} is too far away for {self.precision} precision{cure}")
        defect = np.abs(off_model(self.name, *p.T))
        if defect.max() > MODEL_TOLERANCE:
            worst = int(defect.argmax())
            raise ValueError(
                f"{what} {worst} = {p[worst].tolist()} is off the model of {self.name}; expected "
                f"{MODEL[self.name]}"
            )
        return p

    def _run(self, name: str, arrays: Sequence[Array], outputs: int, *constants: int) -> Array:
        """Run a kernel of numerics.cl over the concatenated components of `arrays`; returns (N, outputs)."""
        return self._program.run(f"numerics_{name}", arrays, outputs, *constants)


def for_few_points(name: str, device: "Device | None" = None) -> Geometry:
    """A geometry for placing things: in double where the device has it, and of one lane, since a narrow
    kernel compiles in a fraction of the time.
    """
    device = device or devices.choose()
    return Geometry(name, "double" if device.info.fp64 else "single", device, lanes=1)


def _warn_too_far(what: str, things: str, out: Array, precision: str) -> None:
    """Say of how many rows there are no numbers."""
    unknown = int(np.isnan(out).any(axis=1).sum())
    if unknown:
        warnings.warn(
            f"{what}: {unknown} of {len(out)} {things} are not known: too far away for {precision} precision",
            RuntimeWarning,
            stacklevel=3,
        )


def _warn_unsolved(what: str, reached_bound: Array) -> None:
    """Say how many solves of an iterating kernel ended at its bound: their results are the best so far."""
    unsolved = int(reached_bound.sum())
    if unsolved:
        warnings.warn(
            f"{what}: {unsolved} of {reached_bound.size} solves reached the iteration bound",
            RuntimeWarning,
            stacklevel=3,
        )


def _rows(what: str, values: ArrayLike, width: int) -> Array:
    array = finite(what, values)
    if array.ndim == 1:
        array = array[None, :]
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"{what} has shape {np.shape(values)}; expected (N, {width})")
    return array


def _together(*arrays: Array) -> tuple[Array, ...]:
    """Repeat single rows so that all arrays have the same N."""
    counts = {a.shape[0] for a in arrays} - {1}
    if len(counts) > 1:
        raise ValueError(f"arrays of different lengths: {', '.join(str(a.shape[0]) for a in arrays)}")
    n = counts.pop() if counts else 1
    return tuple(np.broadcast_to(a, (n, a.shape[1])) for a in arrays)
