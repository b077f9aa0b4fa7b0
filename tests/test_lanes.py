"""kernels/lanes.h: every operation, width and precision, against NumPy and against width 1."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from golden import EPSILON
from numpy.typing import NDArray
from small_kernels import Body, SmallKernels

from thurston_cl.device import Device
from thurston_cl.program import LANE_WIDTHS, LOCAL_SIZE, kernel_text

ONE_ARGUMENT = ("exp", "log", "sqrt", "rsqrt", "fabs", "rint", "floor")
TWO_ARGUMENTS = ("fmin", "fmax", "copysign", "atan2")
NUMPY: dict[str, Callable[..., Any]] = {
    "rsqrt": lambda x: 1 / np.sqrt(x),
    "fabs": np.abs,
    "atan2": np.arctan2,
}

VECTORS = 19  # numbers that the kernel on vectors of lanes writes
# Few kernels with many outputs each, since what takes time is their compilation.
BODIES = {
    # What a packet says as a whole is written to each of its lanes.
    "masks": Body(
        2,
        10,
        """mask a = IN(0) > IN(1), b = IN(0) > REAL(0);
  OUT(0, SELECT(a, REAL(1), REAL(0)));
  OUT(1, SELECT(NOT(a), REAL(1), REAL(0)));
  OUT(2, SELECT(a & b, REAL(1), REAL(0)));
  OUT(3, SELECT(a | NOT(b), REAL(1), REAL(0)));
  OUT(4, SELECT(NOT(a & b) & (a | b), REAL(1), REAL(0)));
  OUT(5, SELECT(a, IN(0), IN(1)));
  OUT(6, REAL(COUNT(a)));
  OUT(7, REAL(COUNT(NOT(a))));
  OUT(8, REAL(ANY(a) != 0));
  OUT(9, REAL(ANY(NOT(a)) != 0));""",
    ),
    # Packets in reverse order, so that LOAD and STORE must know theirs; ids; one lane at a time.
    "lanes": Body(
        1,
        7,
        """size_t other = get_global_size(0) - 1 - packet;
  OUT(0, LOAD(other, in));
  STORE(LOAD(packet, in), other, out + (size_t)stride);
  lane_int id = (lane_int)((int)packet * LANES) + LANE_IDS;
  OUT(2, TO_REAL(LANE_IDS));
  OUT(3, TO_REAL(id));
  OUT(4, TO_REAL(id >> 2));
  real_lanes values = {IN(0)};
  mask_lanes positive = {IN(0) > REAL(0)};
  int_lanes ids = {LANE_IDS};
  for (int lane = 0; lane < LANES; lane++)
    if (positive.at[lane]) values.at[lane] += (scalar)ids.at[lane];
  OUT(5, values.lanes);
  OUT(6, SELECT(IS_ODD(rint(IN(0))), REAL(1), REAL(0)));""",
    ),
    "arithmetic": Body(
        6,
        VECTORS + 6,
        """real3_lanes a = {IN(0), IN(1), IN(2)}, b = {IN(3), IN(4), IN(5)};
  real4_lanes p = {IN(0), IN(1), IN(2), IN(3)}, q = {IN(2), IN(3), IN(4), IN(5)};
  mask m = IN(0) > IN(1);
  real3_lanes c = cross_3(a, b), s = add_scaled_3(scale_3(a, IN(0)), b, IN(1)), t = select_3(m, a, b);
  real4_lanes r = add_scaled_4(scale_4(p, IN(0)), q, IN(1)), u = select_4(m, p, with_w(first_3(q), IN(0)));
  real all[VECTORS] = {dot_3(a, b), dot_4(p, q), c.x, c.y, c.z, s.x, s.y, s.z, t.x, t.y, t.z,
                       r.x, r.y, r.z, r.w, u.x, u.y, u.z, u.w};
  for (int k = 0; k < VECTORS; k++) OUT(k, all[k]);
  OUT(VECTORS, fma(IN(0), IN(1), IN(2)));
  OUT(VECTORS + 1, IN(0) * IN(1) + IN(2));
  OUT(VECTORS + 2, REAL(EPSILON));
  OUT(VECTORS + 3, REAL(TINY));
  OUT(VECTORS + 4, REAL(C(0.1)));
  OUT(VECTORS + 5, REAL(3) / REAL(2));""",
    ),
    "built_ins": Body(
        2,
        len(ONE_ARGUMENT + TWO_ARGUMENTS),
        "\n".join(
            [f"OUT({k}, {name}(IN(0)));" for k, name in enumerate(ONE_ARGUMENT)]
            + [f"OUT({k}, {name}(IN(0), IN(1)));" for k, name in enumerate(TWO_ARGUMENTS, len(ONE_ARGUMENT))]
        ),
    ),
}
# Seven packets and a bit of the widest work-group.
COUNT = 7 * max(LANE_WIDTHS) * LOCAL_SIZE + 5


def kernels(device: Device, precision: str, lanes: int) -> SmallKernels:
    return SmallKernels(device, ("lanes.h",), BODIES, precision, lanes, head=f"#define VECTORS {VECTORS}")


@pytest.fixture(
    scope="module", params=[(p, n) for p in EPSILON for n in LANE_WIDTHS], ids=lambda p: f"{p[0]}-{p[1]}"
)
def at(request: pytest.FixtureRequest, opencl_device: Device) -> SmallKernels:
    return kernels(opencl_device, *request.param)


def masks(at: SmallKernels) -> NDArray[np.floating]:
    """Two rows; the first exceeds the second in no lane of a packet, in all, in each single one, in some."""
    rng = np.random.default_rng(7)
    width = at.lanes
    patterns = [np.zeros(width), np.ones(width), *np.eye(width), *(1 - np.eye(width))]
    patterns += list(rng.integers(0, 2, (20, width)))
    wanted = np.concatenate(patterns)
    second = rng.uniform(-1, 1, len(wanted))
    return np.stack([second + np.where(wanted == 1, 0.5, -0.5), second]).astype(at.dtype)


def per_packet(values: NDArray[np.bool_], lanes: int, combine: str) -> NDArray[np.floating]:
    """A sum ("sum") or a test ("any") of each packet of lanes, repeated for each of them."""
    packets = values.reshape(-1, lanes)
    return np.repeat(getattr(packets, combine)(axis=1).astype(float), lanes)


def test_masks_combine(at: SmallKernels) -> None:
    numbers = masks(at)
    a, b = numbers[0] > numbers[1], numbers[0] > 0
    np.testing.assert_array_equal(at.run("masks", numbers)[:5], [a, ~a, a & b, a | ~b, a ^ b])


def test_any_and_count(at: SmallKernels) -> None:
    numbers = masks(at)
    holds = numbers[0] > numbers[1]
    got = at.run("masks", numbers)[6:]
    np.testing.assert_array_equal(got[:2], [per_packet(m, at.lanes, "sum") for m in (holds, ~holds)])
    np.testing.assert_array_equal(got[2:], [per_packet(m, at.lanes, "any") for m in (holds, ~holds)])


def test_select_takes_each_lane_from_its_side(at: SmallKernels) -> None:
    """A comparison with NaN is false; what is not taken does no harm."""
    numbers = masks(at)
    numbers[0, ::7], numbers[0, 1::7], numbers[1, 1::7] = np.nan, np.inf, np.nan
    with np.errstate(invalid="ignore"):
        holds = numbers[0] > numbers[1]
    np.testing.assert_array_equal(at.run("masks", numbers)[5], np.where(holds, numbers[0], numbers[1]))
    np.testing.assert_array_equal(at.run("masks", numbers)[6], per_packet(holds, at.lanes, "sum"))


def test_load_and_store_know_their_packet(at: SmallKernels) -> None:
    numbers = np.arange(3 * at.lanes * LOCAL_SIZE, dtype=at.dtype)
    backwards = numbers.reshape(-1, at.lanes)[::-1].ravel()
    np.testing.assert_array_equal(at.run("lanes", numbers)[:2], [backwards, backwards])


def test_lane_ids_count_through_the_packets(at: SmallKernels) -> None:
    ids = np.arange(COUNT)
    got = at.run("lanes", np.zeros(COUNT))
    np.testing.assert_array_equal(got[2:5], [ids % at.lanes, ids, ids // 4])


def test_lanes_one_at_a_time(at: SmallKernels) -> None:
    numbers = masks(at)[0]
    wanted = numbers + np.where(numbers > 0, np.arange(len(numbers)) % at.lanes, 0).astype(at.dtype)
    np.testing.assert_array_equal(at.run("lanes", numbers)[5], wanted)


def test_is_odd(at: SmallKernels) -> None:
    whole = np.arange(-40, 41)
    whole = np.concatenate([whole, [2**22, 2**22 + 1, -(2**22) - 1, 2**24 - 1, 1 - 2**24]])
    np.testing.assert_array_equal(at.run("lanes", whole)[6], whole % 2)


def test_vectors_of_lanes(at: SmallKernels) -> None:
    rows = np.random.default_rng(8).uniform(-2, 2, (6, 200)).astype(at.dtype)
    exact = rows.astype(np.float64)
    a, b, p, q = exact[:3], exact[3:], exact[:4], exact[2:]
    m = exact[0] > exact[1]
    wanted = [
        (a * b).sum(axis=0)[None],
        (p * q).sum(axis=0)[None],
        np.cross(a, b, axis=0),
        exact[0] * a + exact[1] * b,
        np.where(m, a, b),
        exact[0] * p + exact[1] * q,
        np.where(m, p, np.concatenate([q[:3], exact[:1]])),
    ]
    got = at.run("arithmetic", rows)[:VECTORS]
    np.testing.assert_allclose(got, np.concatenate(wanted), atol=float(32 * np.finfo(at.dtype).eps))


def test_fma_rounds_once_and_a_product_with_a_sum_twice(at: SmallKernels) -> None:
    """Contraction is off, so x * y + z is what NumPy gives; fma keeps the digits that this loses."""
    epsilon = np.finfo(at.dtype).eps
    x = np.array([1 + epsilon, 1 + 2 * epsilon, 3], at.dtype)
    fused, separate = at.run("arithmetic", np.stack([x, x, -(x * x), x, x, x]))[VECTORS : VECTORS + 2]
    np.testing.assert_array_equal(separate, [0, 0, 0])
    np.testing.assert_array_equal(fused, [epsilon**2, 4 * epsilon**2, 0])


def test_constants_are_those_of_the_precision(at: SmallKernels) -> None:
    info = np.finfo(at.dtype)
    wanted = np.array([info.eps, info.tiny, 0.1, 1.5]).astype(at.dtype)
    got = at.run("arithmetic", np.zeros((6, 1)))[VECTORS + 2 :, 0]
    np.testing.assert_array_equal(got, wanted)


@pytest.mark.parametrize("name", ONE_ARGUMENT + TWO_ARGUMENTS)
def test_built_ins_at_every_width(at: SmallKernels, name: str) -> None:
    """To the accuracy that OpenCL promises: 6 units in the last place for atan2, 4 for exp, log
    and roots.
    """
    rng = np.random.default_rng(9)
    low = 0.01 if name in ("log", "sqrt", "rsqrt") else -20
    halves = np.arange(-5, 5.5, 0.5) if low < 0 else np.arange(0.5, 5)
    first = np.concatenate([rng.uniform(low, 20, 500), halves])
    given = np.stack([first, rng.uniform(-3, 3, len(first))]).astype(at.dtype)
    arguments = given[:1] if name in ONE_ARGUMENT else given
    function = NUMPY.get(name) or getattr(np, name)
    wanted = function(*arguments.astype(np.longdouble)).astype(np.float64)
    output = (ONE_ARGUMENT + TWO_ARGUMENTS).index(name)
    ulps = {"atan2": 6, "exp": 4, "log": 4, "sqrt": 4, "rsqrt": 4}.get(name, 0)
    got = at.run("built_ins", given)[output]
    np.testing.assert_allclose(got, wanted, rtol=float(ulps * np.finfo(at.dtype).eps))


@pytest.mark.parametrize("precision", EPSILON)
def test_every_width_gives_what_width_1_gives(opencl_device: Device, precision: str) -> None:
    """Bit by bit, since these are single operations of IEEE 754."""
    rows = np.random.default_rng(10).uniform(-9, 9, (6, 999)).astype(np.float32)
    first = kernels(opencl_device, precision, 1)
    for lanes in LANE_WIDTHS[1:]:
        wide = kernels(opencl_device, precision, lanes)
        # Not what a packet says as a whole.
        for name, given, lane_by_lane in (("masks", rows[:2], 6), ("arithmetic", rows, VECTORS + 6)):
            got, wanted = (k.run(name, given)[:lane_by_lane] for k in (wide, first))
            np.testing.assert_array_equal(got, wanted, f"{name}, width {lanes}")


def test_the_tests_name_every_split_built_in() -> None:
    split = re.findall(r"SPLIT_[12]\(R, (\w+)\)", kernel_text("lanes.h"))
    assert sorted(split) == sorted(ONE_ARGUMENT + TWO_ARGUMENTS)
