"""Build and run one small kernel on one device; run by `device.probe` in a process of its own.

A broken OpenCL driver may end the process that uses it (pip's PoCL 3.0 crashes in its compiler on vector
code for a CPU it does not know), so nothing here runs in the caller's process.

    python -P _probe.py PLATFORM DEVICE

prints one line of JSON: {"ok": true|false, "message": "what went wrong"}.
"""

import json
import sys
import warnings

# Sixteen lanes, a branch-free choice and two built-in functions: what our kernels ask of every compiler.
# A scalar kernel is not enough: there are drivers that compile that one and fail on the vectors.
SOURCE = """
__kernel void probe(__global float *out)
{
    const int i = get_global_id(0);
    float16 x = (float16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15) + (float16)(16 * i);
    x = select(sqrt(x), exp(-x), x < (float16)(8));
    vstore16(x, i, out);
}
"""


def run(platform: int, device: int) -> tuple[bool, str]:
    """Try device number `device` of platform number `platform`: (did it work, what went wrong)."""
    import numpy as np
    import pyopencl as cl

    warnings.simplefilter("ignore", cl.CompilerWarning)
    groups = 64
    x = np.arange(16 * groups, dtype=np.float64)
    expected = np.where(x < 8, np.exp(-x), np.sqrt(x))
    got = np.full(x.shape, np.nan, dtype=np.float32)
    try:
        context = cl.Context([cl.get_platforms()[platform].get_devices()[device]])
        queue = cl.CommandQueue(context)
        program = cl.Program(context, SOURCE).build()
        buffer = cl.Buffer(context, cl.mem_flags.WRITE_ONLY, got.nbytes)
        cl.Kernel(program, "probe")(queue, (groups,), None, buffer)
        cl.enqueue_copy(queue, got, buffer)
        queue.finish()
    except Exception as error:  # any failure, of any layer, is the answer we came for
        return False, f"{type(error).__name__}: {error}"
    if not np.allclose(got, expected, rtol=1e-5, atol=0):
        return False, "the kernel ran, but its results are wrong"
    return True, ""


if __name__ == "__main__":
    ok, message = run(int(sys.argv[1]), int(sys.argv[2]))
    print(json.dumps({"ok": ok, "message": message}))
