"""Measures of forces by the series of a few rows are those of `Circuit.forces`."""

from __future__ import annotations

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.measures import FORCE_MEASURES

TABLE = sb.Load(link=3, at=(0, 0, 0), force=(0, 0, 500), table=((0.0, 2.0, 5.0), (0.0, 1.0, 0.2)))
BALANCED = {"L1": 200.0, "L3": 550.0}
SHARP = {"L1": 295.0, "L3": 603.0}


def circuits(loads: tuple[sb.Load, ...] | None, **dimensions: float) -> tuple[Circuit, ...]:
    linkage = Draft.of_linkage(sb.load("rssr_press")).with_values(dimensions).linkage
    return (linkage if loads is None else linkage.loaded(loads=list(loads))).motion().circuits


@pytest.mark.parametrize(
    "loads", [None, (), (TABLE,), (TABLE, sb.Load(link=1, torque=(0, 0, 3), axes="link"))]
)
@pytest.mark.parametrize("dimensions", [BALANCED, SHARP])
def test_measures_by_a_few_rows_are_those_of_the_sizing(
    loads: tuple[sb.Load, ...] | None, dimensions: dict[str, float]
) -> None:
    for circuit in circuits(loads, **dimensions)[:1]:
        forces = circuit.forces()
        found = forces.sizing()
        assert found is not None
        assert circuit.force_waves is not None
        measured = [FORCE_MEASURES[name].value(circuit) for name in FORCE_MEASURES]
        known = [abs(found.peak_torque.value), found.rms_torque, found.peak_power.value, found.fluctuation]
        np.testing.assert_allclose(measured[:4], known, rtol=1e-9)
        sizes = np.linalg.norm(forces.shaking[:, 3:], axis=1)
        assert 1.0 <= measured[4] / sizes.max() < 1.001


def test_a_circuit_that_turns_back_has_no_measures_of_forces() -> None:
    rocking = circuits(None, L1=290.0, L3=470.0)[0]
    assert not rocking.goes_round
    assert all(FORCE_MEASURES[name].value(rocking) is None for name in FORCE_MEASURES)


def test_where_nothing_has_a_mass_measures_say_so() -> None:
    (circuit, *_) = sb.load("rssr").motion().circuits
    with pytest.raises(RequestError, match="nothing has a mass"):
        FORCE_MEASURES["peak_torque"].value(circuit)


def test_a_balanced_crank_without_gravity_has_a_torque_of_rounding_alone() -> None:
    crank = {1: sb.Body(2.0, (0.0, 0.0, 0.0), np.diag([0.1, 0.1, 0.1]))}
    linkage = sb.load("rssr").loaded(bodies=crank, gravity=(0.0, 0.0, 0.0))
    assert FORCE_MEASURES["peak_torque"].value(linkage.motion().circuits[0]) == 0.0
