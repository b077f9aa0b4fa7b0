"""Every record of tests/data/sl2.json against the kernels, in both precisions, at widths 1 to 32."""

import json

import pytest
from golden import DATA, EPSILON, Case
from twisted_records import WIDTHS, Limits, check_flow_or_area, check_own_reference, check_pairs, records_of

from thurston_cl.device import Device

HELD = json.loads((DATA / "sl2.json").read_text(encoding="utf-8"))
RAYS = records_of("sl2", HELD, "flow", "area")
PAIRS = records_of("sl2", HELD, "pairs")
# The most geodesics that a record names: all with less than three half turns about o.
LONGEST_LIST = 5

# 4 times math section 5, by regime ("" for every other) and kind.
NULL_CONE = {
    "double": Limits(plane=4 * 1.7e-15, fibre=4 * 3.7e-16),
    "single": Limits(plane=4 * 1.0e-6, fibre=4 * 1.9e-7),
}
LONG = {"double": Limits(plane=4 * 1.5e-13), "single": Limits(plane=4 * 4.4e-5)}
NULL_CONE_AREA = {"double": Limits(area=4 * 1.5e-15), "single": Limits(area=4 * 1.0e-6)}
LIMITS: dict[tuple[str, str], dict[str, Limits]] = {
    ("", "flow"): {
        "double": Limits(plane=4 * 2.0e-15, fibre=4 * 3.7e-16),
        "single": Limits(plane=4 * 1.3e-6, fibre=4 * 1.9e-7),
    },
    ("null_cone_1e-14_to_1e-2", "flow"): NULL_CONE,
    ("null_cone_nearest_double", "flow"): NULL_CONE,
    ("elliptic_many_turns_t_30_100", "flow"): LONG,
    ("hyperbolic_long_t_20_40", "flow"): LONG,
    ("null_cone_t_20_60", "flow"): LONG,
    ("main", "area"): {"double": Limits(area=4 * 5.8e-15), "single": Limits(area=4 * 3.7e-6)},
    ("null_cone_1e-14_to_1e-2", "area"): NULL_CONE_AREA,
    ("null_cone_nearest_double", "area"): NULL_CONE_AREA,
    ("short_t", "area"): {"double": Limits(area=4 * 7.1e-16), "single": Limits(area=4 * 3.3e-7)},
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
    assert (len(RAYS), len(PAIRS)) == (18, 9)
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
