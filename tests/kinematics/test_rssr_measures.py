"""Extremes, transmission angle and time ratio against dense sampling and their definitions.

Source: dense sampling of the output, and `reference_rssr`, which knows the description only; design.md for the definitions.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import sevenbar as sb
from evidence.fuzz.random_linkages import (
    Dimensions,
    Drawing,
)
from strategies import drivers, laws, linkages, wrapped


@laws
@given(linkages, drivers, st.sampled_from([2.0, -2.0]))
def test_no_sample_exceeds_the_extremes_and_dense_ones_come_near(
    description: Dimensions | Drawing, driver: str, speed: float
) -> None:
    assume(description.reference().clearance() > 1e-3)
    for circuit in description.linkage().motion(samples=1440, input=driver, speed=speed):
        column = circuit.output_column
        if circuit.angle is not None:
            assert_bounds(circuit.q[:, column], circuit.angle, near=1e-3)
        if circuit.input_range is not None:  # at an input dead centre rates grow without bound
            assert circuit.velocity is None
            assert circuit.acceleration is None
            continue
        assert circuit.velocity is not None
        assert circuit.acceleration is not None
        assert_bounds(circuit.dq[:, column], circuit.velocity, near=1e-2)
        assert_bounds(circuit.ddq[:, column], circuit.acceleration, near=5e-2)


def assert_bounds(values: np.ndarray, extremes: sb.motion.Extremes, *, near: float) -> None:
    span = extremes.highest - extremes.lowest
    for sampled, bound in ((-values.min(), -extremes.lowest), (values.max(), extremes.highest)):
        assert bound - near * span <= sampled <= bound + 1e-11 * max(span, 1.0)


@laws
@given(linkages, drivers)
def test_the_output_is_at_an_extreme_where_it_is_said_to_be(
    description: Dimensions | Drawing, driver: str
) -> None:
    assume(description.reference().clearance() > 1e-3)
    linkage = description.linkage()
    for circuit in linkage.motion(samples=24, input=driver):
        for extremes, order in ((circuit.angle, 0), (circuit.velocity, 1), (circuit.acceleration, 2)):
            if extremes is None:
                continue
            output = linkage.output([extremes.lowest_at, extremes.highest_at], order, 1.0, input=driver)
            values = (output.position, output.velocity, output.acceleration)[order]
            for sample, want in enumerate((extremes.lowest, extremes.highest)):
                apart = values[:, sample] - want
                apart = np.abs(wrapped(apart) if order == 0 else apart)
                assert apart.min() < 1e-7 * max(1.0, abs(want))


@laws
@given(linkages, drivers)
def test_the_transmission_angle_is_that_between_the_coupler_and_the_driven_ball_s_path(
    description: Dimensions | Drawing, driver: str
) -> None:
    """90 degrees less the angle between the coupler and the driven ball's direction of motion."""
    reference = description.reference()
    assume(reference.clearance() > 1e-3)
    driven = reference.rocker if driver == "crank" else reference.crank
    axis = driven.axis / np.linalg.norm(driven.axis)
    for circuit in description.linkage().motion(samples=1440, input=driver):
        a, b = reference.crank.turned(circuit.q[:, 0]), reference.rocker.turned(circuit.q[:, 7])
        path = np.cross(axis, (b if driver == "crank" else a) - driven.at)
        path /= np.linalg.norm(path, axis=1)[:, None]
        line = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
        sampled = np.arcsin(np.abs(np.sum(path * line, axis=1)).clip(0, 1))
        extremes = circuit.transmission
        # an arcsine near a quarter turn is known to the root of rounding
        assert extremes.lowest - 1e-6 <= sampled.min() <= extremes.lowest + 2e-2
        assert extremes.highest - 2e-2 <= sampled.max() <= extremes.highest + 1e-7
        if circuit.input_range is not None:
            assert extremes.lowest < 1e-6


@laws
@given(linkages, drivers)
def test_the_transmission_angle_is_zero_at_an_input_dead_centre(
    description: Dimensions | Drawing, driver: str
) -> None:
    """There the coupler's line meets the driven axis: it moves the driven ball neither way."""
    for circuit in description.linkage().motion(samples=4, input=driver):
        if circuit.input_range is not None:
            assert circuit.transmission.lowest == 0.0
            assert (
                np.abs(wrapped(circuit.transmission.lowest_at - np.array(circuit.input_range))).min() < 1e-12
            )


@pytest.mark.parametrize("off", [1e-3, 1e-5, 1e-7, 1e-9, 1e-11])
def test_the_extremes_hold_the_narrow_peak_beside_a_change_point(off: float) -> None:
    """A crank that just turns past where it would stick: the rates rise within sqrt(off) of a radian."""
    for M, N, L1, L3, D, L2, meeting in BESIDE_CHANGE_POINTS:
        linkage = sb.rssr(M=M, N=N, L1=L1, L3=L3, D=D, L2=L2 * (1 + off))
        motion = linkage.motion(samples=4)
        assert motion.motion_type == "crank-rocker"
        inputs = meeting + np.sqrt(off) * np.linspace(-20, 20, 4001)
        output = linkage.output(inputs, 2)
        for circuit in motion:
            assert circuit.velocity is not None
            assert circuit.acceleration is not None
            mode = circuit.mode[0]
            for values, extremes in (
                (output.velocity[mode], circuit.velocity),
                (output.acceleration[mode], circuit.acceleration),
            ):
                height = np.abs(values).max()
                assert extremes.lowest <= values.min() + 1e-4 * height
                assert extremes.highest >= values.max() - 1e-4 * height


#: M, N, L1, L3, D, the L2 at which two limits of the crank meet, and where: by golden section on the distance from A to
#: the nearest or farthest point of B's circle.
BESIDE_CHANGE_POINTS = (
    (1.2, -1.7, 0.7, 1.1, 0.4, 2.0093174335103576, 3.233262891336456),
    (0.5, 2.2, 0.8, 2.6, -0.5, 1.3459683240028428, 3.196729371085155),
    (0.5, 0.4, 0.4, 0.5, 0.4, 0.9031056427769986, 3.2110653627600287),
    (1.4, 0.0, 0.6, 1.5, -1.9, 2.056021977856103, 2.8632929615055263),
    (0.5, 3.0, 1.9, 1.1, -0.5, 3.1139089809459786, 2.8610951061708496),
    (-1.6, -0.8, 1.0, 2.8, -0.9, 3.127773117258114, 5.901718345455515),
)


@laws
@given(linkages, drivers)
def test_the_time_ratio_is_that_of_the_two_strokes(description: Dimensions | Drawing, driver: str) -> None:
    reference = description.reference()
    assume(reference.clearance() > 1e-2)
    linkage = description.linkage()
    for circuit in linkage.motion(samples=3600, input=driver):
        if circuit.motion_type != "crank-rocker":
            assert circuit.time_ratio is None
            continue
        # the samples on which the output rises, over those on which it falls, by a sampled walk
        rising = np.count_nonzero(np.diff(circuit.output, append=circuit.output[:1]) > 0)
        falling = circuit.output.size - rising
        assert circuit.time_ratio >= 1
        assert circuit.time_ratio == pytest.approx(max(rising, falling) / min(rising, falling), rel=1e-2)
