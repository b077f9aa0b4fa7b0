"""Kernels over arrays (`kernels/arrays.h`): built for a device, with data rounded, moved there and back."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thurston_cl import device as devices
from thurston_cl.program import LANE_WIDTHS, LOCAL_SIZE, Source, build_widest

if TYPE_CHECKING:
    import pyopencl as cl

    from thurston_cl.device import Device

Array = NDArray[np.float64]


class ArrayProgram:
    """`source`, built for one device.

    precision: "single" or "double", the arithmetic inside. device: what `--device` accepts, None for the
    default choice. lanes: width of the kernels, None for the device's default. Raises ValueError for unknown
    settings, NoDeviceError where nothing can build a kernel.
    """

    def __init__(
        self, source: Source, precision: str, device: "str | Device | None", lanes: int | None
    ) -> None:
        if precision not in ("single", "double"):
            raise ValueError(f"unknown precision {precision!r}; expected 'single' or 'double'")
        self.precision = precision
        self.device = devices.choose(device) if device is None or isinstance(device, str) else device
        if precision == "double" and not self.device.info.fp64:
            raise ValueError(
                f"{self.device.info.name} has no double precision; use precision='single' or another device"
            )
        if lanes is not None and lanes not in LANE_WIDTHS:
            raise ValueError(f"{lanes} lanes; expected one of: {', '.join(map(str, LANE_WIDTHS))}")
        width = lanes or self.device.info.lane_width(precision)
        self.built, self.lanes = build_widest(self.device, source, precision, width)
        # How long the device was at work on the last run.
        self.seconds = 0.0

    @property
    def dtype(self) -> type[np.floating]:
        return np.float64 if self.precision == "double" else np.float32

    def tail(self, values: Array) -> Array:
        """What the precision inside cuts off `values`."""
        return values - values.astype(self.dtype)

    def with_tail(self, values: Array) -> list[Array]:
        """`values` (N,) as columns for `run`: themselves and their tail."""
        return [values[:, None], self.tail(values)[:, None]]

    def run(
        self,
        name: str,
        arrays: Sequence[Array],
        outputs: int,
        *constants: int,
        numbers: ArrayLike | None = None,
        tables: Sequence["cl.Buffer"] = (),
    ) -> Array:
        """Run a kernel over the concatenated components of `arrays`; returns (N, outputs). `numbers`: the
        constant buffer of kernels that take one; `tables`: what they take after it.
        """
        import pyopencl as cl

        count = arrays[0].shape[0]
        packet = self.lanes * LOCAL_SIZE
        stride = max(1, -(-count // packet)) * packet
        rows = np.concatenate(arrays, axis=1).T
        # Padding repeats a valid item: a lane that computes nonsense may be slow (denormals, NaN).
        data = np.empty((rows.shape[0], stride), self.dtype)
        data[:, :count] = rows
        data[:, count:] = rows[:, :1] if count else 0
        flags = cl.mem_flags
        source = cl.Buffer(self.device.context, flags.READ_ONLY | flags.COPY_HOST_PTR, hostbuf=data)
        result = np.empty((outputs, stride), self.dtype)
        target = cl.Buffer(self.device.context, flags.WRITE_ONLY, result.nbytes)
        kernel = cl.Kernel(self.built, name)
        buffers = [*([] if numbers is None else [self._constant(numbers)]), *tables]
        kernel.set_args(source, target, np.int32(stride), *buffers, *(np.int32(c) for c in constants))
        event = cl.enqueue_nd_range_kernel(self.device.queue, kernel, (stride // self.lanes,), (LOCAL_SIZE,))
        cl.enqueue_copy(self.device.queue, result, target)
        self.seconds = (event.profile.end - event.profile.start) * 1e-9
        return result[:, :count].T.astype(np.float64)

    def _constant(self, numbers: ArrayLike) -> "cl.Buffer":
        import pyopencl as cl

        flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
        return cl.Buffer(self.device.context, flags, hostbuf=np.asarray(numbers, self.dtype))


def expect(good: NDArray[np.bool_], what: str, values: Array, expected: str) -> None:
    """ValueError that names the first of `values` that is not `good`."""
    if not good.all():
        index = tuple(int(i) for i in np.argwhere(~good)[0])
        place = f"{what}{list(index)}" if index else what
        raise ValueError(f"{place} is {values[index]}; expected {expected}")


def finite(what: str, values: ArrayLike) -> Array:
    """`values` as an array of finite numbers."""
    array = np.asarray(values, dtype=np.float64)
    expect(np.isfinite(array), what, array, "a finite number")
    return array
