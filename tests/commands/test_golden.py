"""Commands and figures say of the whole gallery what the record of them says."""

import pytest

from golden import FLAT, FOLDER, cases, difference
from sevenbar.kinematics.solvers.batches import simd_level

CASES = cases()


def test_the_record_has_each_case_and_no_other():
    assert {path.stem for path in FOLDER.glob("*.txt")} == set(CASES)


@pytest.mark.parametrize("case", CASES)
def test_it_is_said_as_before(case):
    if (unit := FLAT.get(case, simd_level())) != simd_level():
        pytest.skip(f"rounding decides where this search ends; the record is made with {unit}")
    assert not difference(CASES[case](), (FOLDER / f"{case}.txt").read_text("utf-8"))


@pytest.mark.parametrize(
    ("now", "record", "same"),
    [
        ("swing 60.001 deg", "swing 60.002 deg", True),
        ("swing 60.001 deg", "swing 60.101 deg", False),
        ("swing 60.001 deg", "swing 60.001 rad", False),
        ('"input": 0.12345678901234', '"input": 0.12345678901299', True),
        ('"input": 0.12345678901234', '"input": 0.12345688901299', False),
        ("error 3.2e-16", "error 4.4e-16", True),
        ("3 circuits", "4 circuits", False),
        ("one\ntwo", "one", False),
    ],
)
def test_lines_differ_by_more_than_rounding_or_agree(now, record, same):
    assert (difference(now, record) == "") is same
