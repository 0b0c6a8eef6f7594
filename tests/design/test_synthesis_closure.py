"""The closed form of many designs at once is that of one linkage, and its derivatives are those of the closure."""

import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.design.closure import (
    NAMES,
    draft_of,
    output_slopes,
    outputs,
    row_of,
    scaled,
    transmission_slopes,
    transmissions,
)
from sevenbar.kinematics.numbers.sensitivity import Numbers

DESIGNS = np.array(
    [
        [300.0, 200.0, 450.0, 500.0, 350.0, 100.0],
        [700.0, 700.0, 250.0, 998.0, 550.0, 0.0],
        [-300.0, -500.0, 200.0, 640.0, 420.0, -150.0],
    ]
)
INPUTS = np.linspace(-0.9, 0.9, 11)


def linkage(row):
    return sb.rssr(**dict(zip(NAMES, row, strict=True)))


@pytest.mark.parametrize("branch", [0, 1])
def test_the_outputs_of_many_designs_are_those_of_each_linkage(branch):
    angles = outputs(DESIGNS, INPUTS, branch)
    for row, own in zip(DESIGNS, angles, strict=True):
        alone = linkage(row).output(INPUTS).position[branch]
        np.testing.assert_allclose(np.exp(1j * own), np.exp(1j * alone), atol=3e-14)


@pytest.mark.parametrize("branch", [0, 1])
def test_the_slopes_of_the_outputs_are_those_of_the_closure_used_for_calibration(branch):
    angles = outputs(DESIGNS, INPUTS, branch)
    by_row, by_input = output_slopes(DESIGNS, INPUTS, angles)
    for i, row in enumerate(DESIGNS):
        reached = np.isfinite(angles[i])
        made = linkage(row)
        numbers = Numbers(made)
        modes = [made.assembly_modes(x).q for x in INPUTS[reached]]
        own = [
            q[np.abs(np.exp(1j * q[:, -1]) - np.exp(1j * y)).argmin()]
            for q, y in zip(modes, angles[i][reached], strict=True)
        ]
        found = numbers.loop(0).slopes(numbers.poses(np.array(own)), 0)
        np.testing.assert_allclose(by_row[i][reached], found.by_number[:, 0, :, -1], rtol=1e-9, atol=1e-14)
        np.testing.assert_allclose(by_input[i][reached], found.rates[:, 0, -1], rtol=1e-9)


def test_the_transmission_angle_is_the_one_of_the_ordinary_analysis():
    circuit = linkage(DESIGNS[1]).motion().circuits[0]
    inputs = np.linspace(0, math.tau, 20001)
    square = transmissions(DESIGNS[1:2], inputs)[0]
    assert math.asin(math.sqrt(square.min())) == pytest.approx(circuit.transmission.lowest, abs=1e-7)
    assert math.asin(math.sqrt(square.max())) == pytest.approx(circuit.transmission.highest, abs=1e-7)


@pytest.mark.parametrize("column", range(7))
def test_the_slopes_of_the_transmission_are_its_differences(column):
    by_row, by_input = transmission_slopes(DESIGNS, INPUTS)
    h = 1e-3 if column < 6 else 1e-6
    if column < 6:
        step = h * np.eye(6)[column]
        difference = (transmissions(DESIGNS + step, INPUTS) - transmissions(DESIGNS - step, INPUTS)) / (2 * h)
        np.testing.assert_allclose(by_row[:, :, column], difference, atol=1e-11)
    else:
        difference = (transmissions(DESIGNS, INPUTS + h) - transmissions(DESIGNS, INPUTS - h)) / (2 * h)
        np.testing.assert_allclose(by_input, difference, atol=1e-8)


def test_there_is_no_output_where_the_input_cannot_stand():
    row = DESIGNS[:1]
    limit = linkage(row[0]).motion().limits[0]
    beyond = np.array([limit + 0.1])
    assert np.isnan(outputs(row, beyond, 0)).all()


def test_a_draft_of_a_design_has_its_dimensions():
    row = scaled(np.array([0.3, 1e-18, 0.2, 0.7, 0.4, -0.1]), 1000.0)
    assert np.abs(row).max() == 1000.0
    assert row[1] == 0.0
    np.testing.assert_array_equal(row_of(draft_of(row, "a design").linkage.dimensions), row)
