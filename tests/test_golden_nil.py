"""Every record of tests/data/nil.json against the kernels, in both precisions, at widths 1 to 32."""

import json

import pytest
from golden import DATA, EPSILON, Case
from twisted_records import WIDTHS, Limits, check_flow_or_area, check_own_reference, check_pairs, records_of

from thurston_cl.device import Device

HELD = json.loads((DATA / "nil.json").read_text(encoding="utf-8"))
RAYS = records_of("nil", HELD, "flow", "area")
PAIRS = records_of("nil", HELD, "pairs")
# The most geodesics that a record names: all with less than four full turns.
LONGEST_LIST = 7

# 4 times math section 5, by regime ("" for every other) and kind.
LIMITS: dict[tuple[str, str], dict[str, Limits]] = {
    ("", "flow"): {
        "double": Limits(plane=4 * 4.5e-16, fibre=4 * 4.5e-16),
        "single": Limits(plane=4 * 2.1e-7, fibre=4 * 2.1e-7),
    },
    ("c_near_0", "flow"): {"double": Limits(fibre=4 * 5.3e-16), "single": Limits(fibre=4 * 2.2e-7)},
    ("short_t", "flow"): {"double": Limits(fibre=4 * 2.6e-16), "single": Limits(fibre=4 * 1.5e-7)},
    ("large_t_100_1000", "flow"): {"double": Limits(fibre=4 * 3.7e-16), "single": Limits(fibre=4 * 1.8e-7)},
    ("main", "area"): {"double": Limits(area=4 * 3.6e-14), "single": Limits(area=4 * 6.3e-6)},
    ("c_near_0", "area"): {"double": Limits(area=4 * 5.9e-16), "single": Limits(area=4 * 2.8e-7)},
    ("", "pairs"): {
        "double": Limits(distance=4 * 4.1e-16, direction=4 * 2.1e-15),
        "single": Limits(distance=4 * 2.4e-7, direction=4 * 1.4e-6),
    },
}
both_precisions = pytest.mark.parametrize("precision", EPSILON)
every_width = pytest.mark.parametrize("lanes", WIDTHS)


def limits(case: Case, precision: str) -> Limits:
    by_precision = LIMITS.get((case.regime, case.kind)) or LIMITS.get(("", case.kind)) or {}
    return by_precision.get(precision, Limits())


def test_the_data_hold_what_the_table_names() -> None:
    assert (len(RAYS), len(PAIRS)) == (12, 8)
    assert {(c.regime, c.kind) for c in (*RAYS, *PAIRS)} >= {key for key in LIMITS if key[0]}


@pytest.mark.parametrize("case", RAYS, ids=str)
def test_the_tests_own_flow_agrees_with_the_data(case: Case) -> None:
    check_own_reference(case)


@every_width
@both_precisions
@pytest.mark.parametrize("case", RAYS, ids=str)
def test_flows_and_areas(case: Case, precision: str, lanes: int, opencl_device: Device) -> None:
    check_flow_or_area(case, limits(case, precision), precision, lanes, opencl_device)


@pytest.mark.filterwarnings("error")
@every_width
@both_precisions
@pytest.mark.parametrize("case", PAIRS, ids=str)
def test_pairs(case: Case, precision: str, lanes: int, opencl_device: Device) -> None:
    check_pairs(case, LONGEST_LIST, limits(case, precision), precision, lanes, opencl_device)
