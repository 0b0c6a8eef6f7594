"""One linkage written in twenty and more ways: every answer that must agree does (`python -m evidence.rewritten`)."""

import pytest

from evidence.rewritten.__main__ import compared
from evidence.rewritten.families import families

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
