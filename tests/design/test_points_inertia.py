"""Masses at points: forces and torque against energy, a closed form, and a flywheel's own law."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.design.points import Mass, inertia
from sevenbar.errors import RequestError


def derivative(values, step):
    """By the input, of values on a closed uniform grid: exact to rounding for smooth ones."""
    wave = np.fft.fftfreq(len(values), step / (2 * np.pi))
    return np.fft.ifft(1j * wave * np.fft.fft(values)).real


@pytest.mark.parametrize("speed", [1.0, -3.0])
@pytest.mark.parametrize(
    ("name", "masses"),
    [
        ("seven_r", [Mass("a", 4, (-100.0, -90.0, -80.0), 2.5)]),
        ("rssr", [Mass("a", 2, (300.0, 20.0, 0.0), 1.5), Mass("b", 3, (10.0, 40.0, -5.0), 4.0)]),
        ("rscr", [Mass("a", 3, (10.0, 5.0, 2.0), 1.0)]),
    ],
)
def test_power_is_the_rate_of_kinetic_energy_and_its_mean_is_zero(name, masses, speed):
    motion = sb.load(name).motion(720, speed=speed)
    found = inertia(motion, masses)
    scale = np.abs(found.torque).max()
    assert abs(found.mean) < 1e-12 * scale
    step = found.input[1] - found.input[0]
    assert found.torque == pytest.approx(derivative(found.kinetic, step), abs=1e-9 * scale)
    assert found.power == pytest.approx(found.torque * speed, rel=1e-12)


def test_force_and_torque_of_the_rssr_s_rocker_are_those_of_its_closed_form():
    # a mass at the ball B: tangential r beta'', towards the axis r beta'^2; torque m r^2 beta'' beta' / alpha'
    motion = sb.load("rssr").motion(180, speed=10.0)
    linkage, mass = motion.linkage, 2.0
    arm = linkage.lengths[2] / 1000
    (ball,) = (p for p in linkage.points if p.name == "B")
    found = inertia(motion, {"B": mass})
    output = linkage.output(found.input, 2, 10.0)
    branch = int(motion.circuits[0].mode[0])
    rate, second = output.velocity[branch], output.acceleration[branch]
    assert found.torque == pytest.approx(mass * arm**2 * second * rate / 10.0, rel=1e-9, abs=1e-9)
    assert found.sizes[0] == pytest.approx(mass * arm * np.hypot(second, rate**2), rel=1e-9)
    assert ball.link in (2, 3)


def test_gravity_adds_the_slope_of_the_height():
    motion = sb.load("seven_r").motion(720)
    point = motion.linkage.points[0]
    pull = np.array([1.0, 2.0, -9.80665])
    light, heavy = (inertia(motion, {"P": 2.0}, gravity=g) for g in (None, pull))
    height = -2.0 * motion.linkage.motion(720).circuits[0].point(point.link, point.at).position @ pull / 1000
    step = light.input[1] - light.input[0]
    assert heavy.torque - light.torque == pytest.approx(derivative(height, step), abs=1e-9)
    assert abs(heavy.mean) < 1e-12 * np.abs(heavy.torque).max()
    assert heavy.force == pytest.approx(light.force)


def test_a_law_s_torque_lets_a_crank_feel_its_own_mass():
    # m r^2 times the law's acceleration, also where its speed is zero
    linkage = sb.load("planar_4r")
    t = np.linspace(0, 2, 41)
    motion = linkage.motion(law=sb.Law.of(t, np.sin(t), np.cos(t), -np.sin(t), -np.cos(t)))
    found = inertia(motion, [Mass("rim", 1, (0.0, 30.0, 40.0), 3.0)])
    assert found.torque == pytest.approx(3.0 * 0.05**2 * -np.sin(t), abs=1e-12)
    assert np.abs(np.cos(t)).min() < 0.1
    assert found.power == pytest.approx(found.torque * np.cos(t), abs=1e-15)


def test_a_sliding_input_takes_a_force():
    linkage = sb.load("rscr")
    (column,) = [c for c in linkage.columns if not linkage.turns(c)]
    low, high = linkage.motion(input=column).circuits[0].input_range
    t = np.linspace(0, 1, 201)
    middle, swing = (low + high) / 2, 0.3 * (high - low)
    law = sb.Law.of(t, middle + swing * np.sin(t), swing * np.cos(t), -swing * np.sin(t), -swing * np.cos(t))
    motion = linkage.motion(input=column, law=law)
    found = inertia(motion, [Mass("a", 2, (3.0, 4.0, 5.0), 2.0)])
    assert (found.slides, found.unit) == (True, "N")
    work = np.concatenate([[0.0], np.cumsum((found.power[1:] + found.power[:-1]) / 2 * np.diff(t))])
    assert work == pytest.approx(found.kinetic - found.kinetic[0], abs=1e-4 * np.ptp(found.kinetic))


def test_masses_add_and_the_ground_takes_part_in_nothing():
    motion = sb.load("seven_r").motion(90)
    a, b = Mass("a", 4, (1.0, 2.0, 3.0), 2.0), Mass("b", 2, (3.0, 2.0, 1.0), 1.0)
    still = Mass("c", 7, (0.0, 0.0, 9.0), 50.0)
    one, two, all_three = inertia(motion, [a]), inertia(motion, [b]), inertia(motion, [a, still, b])
    assert all_three.torque == pytest.approx(one.torque + two.torque)
    assert all_three.shaking == pytest.approx(one.force[0] + two.force[0])
    assert all_three.force[1] == pytest.approx(0)


@pytest.mark.parametrize(
    ("masses", "options", "message"),
    [
        ({"P": -1.0}, {}, "mass of P: -1.0 is not a mass; give kilograms > 0"),
        ({"P": 0}, {}, "mass of P: 0 is not a mass; give kilograms > 0"),
        ({"P": float("nan")}, {}, "mass of P: nan is not a mass; give kilograms > 0"),
        ({"P": "2kg"}, {}, "mass of P: '2kg' is not a mass; give kilograms > 0"),
        ({"Q": 1.0}, {}, "masses: no point 'Q'; this linkage has P"),
        ({}, {}, "masses: none given; give one, as in P=2.5"),
        (
            [Mass("a", 7, (0, 0, 0), 1.0)],
            {},
            "masses: all lie on the ground, which stands still; give one on a moving link",
        ),
        ([Mass("a", 9, (0, 0, 0), 1.0)], {}, "link: 9 is not a link; give 1 to 6"),
        ({"P": 1.0}, {"gravity": [9.8]}, "gravity: 1 numbers; give three, as in (0, 0, -9.80665)"),
    ],
)
def test_what_is_said_of_masses_that_do_not_fit(masses, options, message):
    with pytest.raises(RequestError) as caught:
        inertia(sb.load("seven_r").motion(24), masses, **options)
    assert str(caught.value) == message


def test_a_rocking_circuit_is_refused_at_constant_speed():
    motion = sb.load("rscr").motion()
    rocking = next(c for c in motion if c.input_range is not None)
    with pytest.raises(RequestError, match="rocks: at constant speed of crank its rates grow without bound"):
        inertia(motion, [Mass("a", 2, (0, 0, 0), 1.0)], circuit=rocking.index)
