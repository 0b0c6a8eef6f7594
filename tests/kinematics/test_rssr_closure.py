"""The loop closes, and only where it can: a million poses of random linkages.

Source: the description alone. A and B are the given points turned about the given axes by Rodrigues'
formula in NumPy (`reference_rssr.Side`), and the loop closes where |A - B| = L2. It can be reached where L2
lies between the distances from the driving ball to the nearest and to the farthest point of the other
ball's circle.
"""

from __future__ import annotations

import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy.reference_rssr import Rssr
from evidence.fuzz.random_linkages import Dimensions, Drawing, assembled_square, mixed, short_coupler, skew

#: Of the size: the closure error that is allowed, and the margin within which rounding decides what is reached.
CLOSED = 1e-12
UNDECIDED = 1e-13

DRIVERS = pytest.mark.parametrize("driver", ["crank", "rocker"])


def inputs_of_every_kind(
    rng: np.random.Generator, linkage: sb.Linkage, driver: str, count: int
) -> np.ndarray:
    """Any angle, 1e5 and 1e8 rad, and 1e-12 to 1e-3 on either side of each limit."""
    kinds = [
        rng.uniform(-np.pi, np.pi, count),
        rng.uniform(-1e5, 1e5, count // 8),
        rng.uniform(-1e8, 1e8, count // 8),
    ]
    for limit in linkage.motion(samples=4, input=driver).limits:
        apart = 10 ** rng.uniform(-12, -3, size=10)
        kinds += [limit + apart, limit - apart, [limit]]
    return np.concatenate(kinds)


def check_poses(linkage: sb.Linkage, reference: Rssr, inputs: np.ndarray, driver: str) -> int:
    """Holds both branches against the reference; the number of poses that were found."""
    output = linkage.output(inputs, input=driver)
    margin = reference.margin(inputs, driver)
    found = 0
    for position, status in zip(output.position, output.status, strict=True):
        reached = np.isfinite(position)
        assert reached[margin > UNDECIDED].all()
        assert not reached[margin < -UNDECIDED].any()
        assert ((status == "no-solution") == ~reached).all()
        crank, rocker = (inputs, position) if driver == "crank" else (position, inputs)
        assert reference.closure_error(crank[reached], rocker[reached]).max(initial=0) < CLOSED
        found += int(reached.sum())
    return found


@pytest.mark.parametrize("linkages", [200, pytest.param(1000, marks=pytest.mark.proof)])
@DRIVERS
def test_poses_close_and_a_missing_one_cannot_be_reached(driver: str, linkages: int) -> None:
    rng = np.random.default_rng(2024 if driver == "crank" else 2025)
    found = 0
    for description in mixed(rng, linkages):
        linkage = description.linkage()
        inputs = inputs_of_every_kind(rng, linkage, driver, 480)
        found += check_poses(linkage, description.reference(), inputs, driver)
    # the other half comes from the other input
    assert found > 500 * linkages


@DRIVERS
@pytest.mark.parametrize("decades", [4.0, 8.0])
def test_lengths_that_differ_by_many_decades_close(driver: str, decades: float) -> None:
    rng = np.random.default_rng(7)
    found = 0
    for index in range(100):
        description = (assembled_square, skew)[index % 2](rng, decades)
        inputs = rng.uniform(-np.pi, np.pi, 100)
        found += check_poses(description.linkage(), description.reference(), inputs, driver)
    assert found > 2000


@DRIVERS
@pytest.mark.parametrize("share", [1e-2, 1e-5, 1e-8])
def test_a_tiny_coupler_closes(driver: str, share: float) -> None:
    """The loop closes only near the drawn pose, so the inputs are taken there."""
    rng = np.random.default_rng(8)
    found = 0
    for _ in range(50):
        description = short_coupler(rng, share)
        inputs = share * rng.uniform(-3, 3, 100)
        found += check_poses(description.linkage(), description.reference(), inputs, driver)
    assert found > 500


@DRIVERS
def test_the_two_poses_meet_at_a_limit(driver: str) -> None:
    rng = np.random.default_rng(9)
    met = 0
    for description in mixed(rng, 300):
        linkage, reference = description.linkage(), description.reference()
        limits = linkage.motion(samples=4, input=driver).limits
        if limits.size == 0 or reference.clearance() < 1e-3:
            continue
        output = linkage.output(limits, 1, input=driver)
        first, second = output.position
        # both on the limit itself and a rounding of it apart, where the distance goes by the square root
        assert np.abs((first - second + np.pi) % (2 * np.pi) - np.pi).max() < 1e-5
        assert set(output.status.ravel()) == {"dead-centre"}
        assert np.isnan(output.velocity).all()
        met += limits.size
    assert met > 200


@DRIVERS
def test_both_poses_are_found_and_there_is_no_third(driver: str) -> None:
    """With the input held, |A - B|^2 is a + b cos x + c sin x, which takes a value at most twice."""
    rng = np.random.default_rng(10)
    for description in mixed(rng, 100):
        reference = description.reference()
        inputs = rng.uniform(-np.pi, np.pi, 60)
        inputs = inputs[reference.margin(inputs, driver) > 1e-3]
        want = np.sort(reference.outputs(inputs, driver) % (2 * np.pi), axis=0)
        got = np.sort(description.linkage().output(inputs, input=driver).position % (2 * np.pi), axis=0)
        apart = np.abs((got[:, None] - want[None] + np.pi) % (2 * np.pi) - np.pi)
        # each of the two found is one of the two expected, and not the same one
        straight, crossed = np.maximum(apart[0, 0], apart[1, 1]), np.maximum(apart[0, 1], apart[1, 0])
        assert np.minimum(straight, crossed).max(initial=0) < 1e-8


@DRIVERS
def test_whole_turns_of_the_input_change_nothing(driver: str) -> None:
    rng = np.random.default_rng(11)
    for description in mixed(rng, 60):
        linkage = description.linkage()
        # a turn that is no machine number comes to 1e-16 of the angle; that much of the input moves, and near a limit
        # it moves the output by its root
        inputs = rng.uniform(-np.pi, np.pi, 40)
        inputs = inputs[np.abs(description.reference().margin(inputs, driver)) > 1e-2]
        for turns in (1, -3, 16_000):
            here, there = (
                linkage.output(x, input=driver).position for x in (inputs, inputs + 2 * np.pi * turns)
            )
            np.testing.assert_array_equal(np.isnan(here), np.isnan(there))
            apart = np.abs((here - there + np.pi) % (2 * np.pi) - np.pi)
            assert np.nanmax(apart, initial=0) < 1e-9


def test_a_coupler_too_short_or_too_long_has_no_pose() -> None:
    for coupler in (1e-3, 1e4):
        dims = Dimensions(700.0, 700.0, 250.0, 550.0, 0.0, coupler)
        output = dims.linkage().output(np.linspace(0, 6, 100), 3)
        for values in (output.position, output.velocity, output.acceleration, output.jerk):
            assert np.isnan(values).all()
        assert (output.status == "no-solution").all()


@pytest.mark.parametrize(
    "ball_b", [(0.3, 1.7, 0.4), (0.9, 0.9, 0.8)], ids=["never there", "there in any pose"]
)
def test_a_ball_that_passes_the_other_axis_closes_on_either_side_of_it(
    ball_b: tuple[float, float, float],
) -> None:
    """A quarter turn on, A is on the rocker's axis: B is out of reach or, where L2 fits, anywhere."""
    drawing = Drawing(
        crank_at=np.array([0.0, 0.0, 0.0]),
        crank_axis=np.array([0.0, 0.0, 1.0]),
        ball_a=np.array([1.0, 0.0, 0.0]),
        ball_b=np.array(ball_b),
        rocker_at=np.array([0.0, 1.0, 0.0]),
        rocker_axis=np.array([0.2, 0.1, 1.0]),
    )
    apart = np.logspace(-12, -1, 60)
    inputs = np.pi / 2 + np.concatenate([-apart, [0.0], apart])
    found = check_poses(drawing.linkage(), drawing.reference(), inputs, "crank")
    assert (found > 0) == (ball_b == (0.9, 0.9, 0.8))
