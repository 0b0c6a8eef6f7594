"""The acceleration pole: a point without acceleration, by the circuit itself; lines and none where a link keeps its axis."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.design.points import acceleration_poles
from sevenbar.errors import RequestError


@pytest.mark.parametrize(("name", "link"), [("seven_r", 4), ("rssr", 2), ("rscr", 2), ("bennett", 2)])
def test_the_pole_has_no_acceleration_at_its_instant(name, link):
    motion = sb.load(name).motion(24)
    circuit = motion.circuits[0]
    poles = acceleration_poles(motion, link)
    assert set(poles.status.tolist()) == {"pole"}
    scale = np.abs(circuit.point(link, (0.0, 0.0, 0.0)).acceleration).max()
    for row in range(24):
        trace = circuit.point(link, tuple(poles.at[row]))
        # an error of the rates counts as often as the pole is far away
        far = 1 + np.linalg.norm(poles.at[row]) / circuit.size
        assert np.linalg.norm(trace.acceleration[row]) < 1e-11 * scale * far
        assert poles.place[row] == pytest.approx(trace.position[row], abs=1e-9 * far * circuit.size)
    assert poles.input == pytest.approx(circuit.input, abs=1e-12)


def test_the_determinant_is_minus_the_square_of_omega_times_alpha():
    # the law by which a pole is single: by the link's own angular velocity and acceleration
    motion = sb.load("seven_r").motion(24)
    rates = acceleration_poles(motion, 4).cycle.rates
    turn = motion.circuits[0].link_motion(4)
    cross = np.cross(turn.velocity, turn.acceleration)
    assert np.linalg.det(rates.gradient[2]) == pytest.approx(-(cross**2).sum(axis=1), rel=1e-6, abs=1e-12)


def test_a_crank_that_turns_evenly_has_its_axis_for_a_pole():
    poles = acceleration_poles(sb.load("planar_4r").motion(), 1, near=(7, 2, 3))
    assert set(poles.status.tolist()) == {"line"}
    # the place on the axis nearest to (7, 2, 3); u runs along it
    assert poles.at == pytest.approx(np.tile([7.0, 0, 0], (360, 1)), abs=1e-12)
    assert np.abs(poles.axis) == pytest.approx(np.tile([1.0, 0, 0], (360, 1)), abs=1e-12)
    assert poles.remaining == pytest.approx(0, abs=1e-12)
    assert poles.condition == pytest.approx(1, abs=1e-12)


def test_a_planar_coupler_s_pole_lies_where_the_closed_form_puts_it():
    # in the plane: a + alpha k x r - omega^2 r = 0, so r = (omega^2 a + alpha k x a) / (omega^4 + alpha^2)
    motion = sb.load("planar_4r").motion(36)
    circuit = motion.circuits[0]
    poles = acceleration_poles(motion, 2)
    origin, turn = circuit.point(2, (0.0, 0.0, 0.0)), circuit.link_motion(2)
    axis = turn.rotation[:, :, 2]
    omega, alpha = (turn.velocity * axis).sum(axis=1), (turn.acceleration * axis).sum(axis=1)
    arm = omega[:, None] ** 2 * origin.acceleration + alpha[:, None] * np.cross(axis, origin.acceleration)
    arm /= (omega**4 + alpha**2)[:, None]
    assert poles.place == pytest.approx(origin.position + arm, abs=1e-9)
    assert set(poles.status.tolist()) == {"line"}


def test_a_platform_that_does_not_turn_has_no_pole():
    motion = sb.load("sarrus").motion(36)
    poles = acceleration_poles(motion, 3)
    assert set(poles.status.tolist()) == {"none"}
    assert np.isnan(poles.at).all()
    assert np.isinf(poles.condition).all()
    trace = motion.circuits[0].point(3, (5.0, 6.0, 7.0))
    assert poles.remaining == pytest.approx(np.linalg.norm(trace.acceleration, axis=1), abs=1e-9)


def test_what_is_said_of_a_point_and_a_link_that_do_not_fit():
    motion = sb.load("seven_r").motion(24)
    with pytest.raises(RequestError, match=r"near: 2 numbers; give three"):
        acceleration_poles(motion, 4, near=(1, 2))
    with pytest.raises(RequestError, match=r"near\[1\]: nan is not a finite number"):
        acceleration_poles(motion, 4, near=(1, np.nan, 0))
    with pytest.raises(RequestError, match="link: 7 is the ground, which stands still; give 1 to 6"):
        acceleration_poles(motion, 7)
