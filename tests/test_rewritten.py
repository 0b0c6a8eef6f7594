"""One linkage written in twenty and more ways: every answer that must agree does (`python -m evidence.rewritten`)."""

import numpy as np
import pytest

import sevenbar as sb
from evidence.rewritten.__main__ import compared
from evidence.rewritten.families import families, lattice
from sevenbar.reporting.how_found import how_found
from sevenbar.reporting.report import as_dict

#: Some of each kind; the whole is evidence.
NAMES = (
    "planar R R R R, crank-rocker 40 100 80 90",
    "planar R R R R, decimals 0.1 2.6 2.5 2.4",
    "planar R R R R, square",
    "planar R R R R, parallelogram 1 2",
    "planar R R R R, kite 1 1 2 2",
    "planar R R R R, nearly a kite, 1e-3",
    "planar R R R R, a step between planes",
    "planar R S R R, kite 1 1 2 2",
    "planar R R S R, crank-rocker 40 100 80 90",
    "planar R S S R, decimals 0.3 0.7 0.6 0.9",
    "planar R S S R, a step between planes",
    "planar R R U R, crank-rocker 40 100 80 90",
    "slider-crank R R R P, offset 1 3 0.5",
    "slider-crank R R R P, equal links 1 1 0",
    "slider-crank R S S P, in line 1 3",
    "spherical R R R R in one point, crank-rocker 30 80 60 70",
    "spherical R R R R, parallelogram 40 70 40 70",
    "spherical R R R R, right angles 90 90 90 60",
    "R S S R, decimals",
    "R S S R, skew",
    "R S S P",
    "R S C R",
    "R S U R, at a dead centre",
    "7 R, decimals",
)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_linkage_answers_alike_however_it_is_written(name: str) -> None:
    found = compared(families()[name](), seed=7)
    assert found.moves
    assert found.ways >= 20
    assert found.differences == []


def test_there_are_a_hundred_families_and_a_lattice() -> None:
    assert len(families()) >= 100


@pytest.mark.slow
def test_a_loop_on_the_lattice_with_circuits_of_equal_ranges_answers_alike() -> None:
    found = compared(lattice(175, seed=1), seed=1)
    assert found.moves
    assert found.ways >= 20
    assert found.differences == []


def test_the_circuit_through_a_pose_is_the_one_it_lies_on() -> None:
    # circuits that change points lead to from one another
    linkage = lattice(55, seed=1).linkage()
    motion = linkage.motion(36, input="j1", output="j7")
    turning_back = [circuit for circuit in motion.circuits if circuit.input_range is not None]
    assert len(turning_back) == 6
    for circuit in turning_back:
        row = int(np.nanargmin(np.where(np.isfinite(circuit.condition), circuit.condition, np.nan)))
        again = linkage.circuit(circuit.q[row], 36, input="j1", output="j7")
        assert again.input_range is not None
        lowest, highest = (
            np.unwrap([end, other])[1]
            for end, other in zip(circuit.input_range, again.input_range, strict=True)
        )
        assert (lowest, highest) == pytest.approx(circuit.input_range, abs=1e-9)


@pytest.mark.slow
def test_a_search_that_stops_short_names_the_bound() -> None:
    motion = lattice(124, seed=1).linkage().motion(36, input="j1", output="j7")
    assert motion.search.bound == "change-points"
    assert motion.search.unfollowed > 0
    assert "stopped short after the most places that may be change points" in how_found(motion)


def test_a_search_that_went_to_its_end_names_no_bound() -> None:
    assert as_dict(sb.load("rssr").motion(12))["search_bound"] is None
