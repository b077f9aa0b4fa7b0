"""Small kernels for tests: statements over a few parts of `kernels/`, run over NumPy arrays."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pyopencl as cl
from numpy.typing import ArrayLike, NDArray

from thurston_cl.device import Device
from thurston_cl.program import LOCAL_SIZE, Source, build

_ROW = "(size_t)({}) * stride"
_HEAD = f"""\
#define IN(c) LOAD(packet, in + {_ROW.format("c")})
#define OUT(c, v) STORE(v, packet, out + {_ROW.format("c")})
FN point point_at(int c, size_t packet, __global const scalar *in, int stride)
{{
  point p = {{IN(c), IN(c + 1), IN(c + 2), IN(c + 3)}};
  return p;
}}
#define POINT(c) point_at(c, packet, in, stride)
"""


class Body(NamedTuple):
    """Statements that read IN(c) or POINT(c), c < inputs, and write OUT(c, value) for every c < outputs."""

    inputs: int
    outputs: int
    text: str


class SmallKernels:
    """`parts` are files of `kernels/`, then come the text `head` and the kernels, `bodies` by name.

    A constant buffer of scene numbers is called `numbers`.
    """

    def __init__(
        self,
        device: Device,
        parts: Sequence[str],
        bodies: Mapping[str, Body],
        precision: str,
        lanes: int,
        head: str = "",
    ) -> None:
        arguments = (
            "__global const scalar *in, __global scalar *out, int stride, __constant const scalar *numbers"
        )
        kernels = (
            f"__kernel void small_{name}({arguments})\n"
            f"{{\n  size_t packet = get_global_id(0);\n{body.text}\n}}\n"
            for name, body in bodies.items()
        )
        text = "\n".join([_HEAD, head, *kernels])
        source = Source((*parts, "small_kernels"), generated={"small_kernels": text})
        self.device = device
        self.lanes = lanes
        self._bodies = bodies
        self.dtype: type[np.floating[Any]] = np.float64 if precision == "double" else np.float32
        self._program = build(device, source, precision, lanes)

    def run(self, name: str, inputs: ArrayLike, numbers: ArrayLike = (0.0,)) -> NDArray[np.floating]:
        """`inputs` (inputs, N), rounded to the precision; the result is (outputs, N) in that precision."""
        rows = np.atleast_2d(np.asarray(inputs, self.dtype))
        outputs = self._bodies[name].outputs
        assert len(rows) == self._bodies[name].inputs
        count = rows.shape[1]
        packet = self.lanes * LOCAL_SIZE
        stride = -(-count // packet) * packet
        data = np.empty((len(rows), stride), self.dtype)
        data[:, :count] = rows
        data[:, count:] = rows[:, :1]
        result = np.empty((outputs, stride), self.dtype)
        flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
        source = cl.Buffer(self.device.context, flags, hostbuf=data)
        table = cl.Buffer(self.device.context, flags, hostbuf=np.asarray(numbers, self.dtype))
        target = cl.Buffer(self.device.context, cl.mem_flags.WRITE_ONLY, result.nbytes)
        kernel = cl.Kernel(self._program, f"small_{name}")
        kernel.set_args(source, target, np.int32(stride), table)
        cl.enqueue_nd_range_kernel(self.device.queue, kernel, (stride // self.lanes,), (LOCAL_SIZE,))
        cl.enqueue_copy(self.device.queue, result, target)
        return result[:, :count]
