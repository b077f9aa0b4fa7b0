"""Complete elliptic integrals and Jacobi's elliptic functions over arrays.

The parameter is m = k^2 or, where m is next to 1, m1 = 1 - m, which then has the digits. Arrays are float64,
whatever the precision inside. The head of `kernels/special/jacobi.h` states how accurate results are.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from thurston_cl.arrays import Array, ArrayProgram, expect
from thurston_cl.program import Source

if TYPE_CHECKING:
    from thurston_cl.device import Device

_SOURCE = Source(("lanes.h", "special/elementary.h", "special/jacobi.h", "arrays.h", "special.cl"))

# The largest |u|. Beyond, its rounding shows in the first digits, or its half periods are too many to count.
ARGUMENT_LIMIT = {"single": 1e5, "double": 1e9}


def elliptic_ke(
    m: ArrayLike | None = None,
    *,
    m1: ArrayLike | None = None,
    precision: str = "double",
    device: "str | Device | None" = None,
    lanes: int | None = None,
) -> tuple[Array, Array]:
    """The complete elliptic integrals K and E (DLMF 19.2(ii)) of `m`, or of `m1` = 1 - m; K is inf for m = 1.

    Both in the shape of `m`. precision, device, lanes: as for `Geometry`. Raises ValueError for what is not
    from 0 to 1.
    """
    program = ArrayProgram(_SOURCE, precision, device, lanes)
    name, parameter = _parameter(m, m1, program)
    out = program.run("special_ke", program.with_tail(parameter.ravel()), 2, name == "m1")
    K, E = out.T.reshape(2, *parameter.shape)
    return K, E


def jacobi(
    u: ArrayLike,
    m: ArrayLike | None = None,
    *,
    m1: ArrayLike | None = None,
    precision: str = "double",
    device: "str | Device | None" = None,
    lanes: int | None = None,
) -> tuple[Array, Array, Array, Array]:
    """sn, cn, dn (DLMF 22.2) and Jacobi's zeta function (22.16(iii)) of `u` and `m`, or `m1` = 1 - m.

    All in the shape to which `u` and `m` broadcast. For m = 1 they are the hyperbolic functions, zeta = tanh.
    precision, device, lanes: as for `Geometry`. Raises ValueError for m that is not from 0 to 1 and for u
    beyond `ARGUMENT_LIMIT`.
    """
    program = ArrayProgram(_SOURCE, precision, device, lanes)
    name, parameter = _parameter(m, m1, program)
    argument = np.asarray(u, dtype=np.float64)
    limit = ARGUMENT_LIMIT[precision]
    expect(
        np.abs(argument) <= limit, "u", argument, f"a number of at most {limit:g} in {precision} precision"
    )
    try:
        argument, parameter = np.broadcast_arrays(argument, parameter)
    except ValueError:
        shapes = f"u has shape {argument.shape} and {name} has shape {parameter.shape}"
        raise ValueError(f"{shapes}; expected shapes that broadcast") from None
    columns = [argument.reshape(-1, 1), *program.with_tail(parameter.ravel())]
    out = program.run("special_jacobi", columns, 4, name == "m1")
    sn, cn, dn, zeta = out.T.reshape(4, *argument.shape)
    return sn, cn, dn, zeta


def _parameter(m: ArrayLike | None, m1: ArrayLike | None, program: ArrayProgram) -> tuple[str, Array]:
    """Which of m and m1 is given, and its values."""
    if (m is None) == (m1 is None):
        raise ValueError(f"{'neither' if m is None else 'both'} of m and m1 = 1 - m given; expected one")
    if m1 is None:
        values = np.asarray(m, dtype=np.float64)
        expect((values >= 0) & (values <= 1), "m", values, "a number from 0 to 1")
        return "m", values
    values = np.asarray(m1, dtype=np.float64)
    # The least number with all digits: rounded to 0, m1 would make K infinite.
    least = np.finfo(program.dtype).tiny
    good = (values == 0) | ((values >= least) & (values <= 1))
    expect(good, "m1", values, f"0 or a number from {least:.2g} to 1 in {program.precision} precision")
    return "m1", values
