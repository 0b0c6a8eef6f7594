"""Sizing of a drive and its bearings against closed forms: peaks, means, the flywheel, bearing loads."""

import math
from dataclasses import dataclass, field

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.curves.curve import Peak
from sevenbar.design.points import Mass, inertia
from sevenbar.errors import RequestError
from sevenbar.forces.sizing import cycle_loads, unevenness_of


@dataclass
class Wrench:
    force: np.ndarray
    moment: np.ndarray
    determinate: np.ndarray = field(default_factory=lambda: np.ones(6, dtype=bool))


def sizing(rows, *, unevenness=None, **given):
    delta, found = unevenness_of(unevenness), cycle_loads(rows, **given)
    return None if found is None else found.sizing(delta)


@dataclass
class Drive:
    """Torque and wrenches as functions of the input, at constant speed."""

    input: np.ndarray
    torque: np.ndarray
    speed: float = 1.0
    reactions: dict = field(default_factory=dict)

    @property
    def time(self):
        return np.abs(self.input - self.input[0]) / abs(self.speed or 1.0)

    @property
    def power(self):
        return self.torque * self.speed


def grid(count=90, first=0.0, period=math.tau):
    return first + period * np.arange(count) / count


def sized(torque, speed=2.0, count=90, first=0.3, reactions=None, **more):
    period = math.copysign(math.tau, speed)

    def evaluate(x):
        return Drive(x, torque(x), speed, {} if reactions is None else reactions(x))

    return sizing(evaluate(grid(count, first, period)), period=period, speed=speed, evaluate=evaluate, **more)


@pytest.mark.parametrize("speed", [2.0, -2.0])
def test_a_sine_about_a_constant_has_its_closed_forms(speed):
    found = sized(lambda x: 5 + 8 * np.sin(x), speed, unevenness=0.02)
    assert found.peak_torque.value == pytest.approx(13.0, rel=1e-13)
    assert found.peak_torque.input % math.tau == pytest.approx(math.pi / 2, abs=1e-12)
    assert found.mean_torque == pytest.approx(5.0, rel=1e-13)
    assert found.rms_torque == pytest.approx(math.sqrt(25 + 32), rel=1e-13)
    powers = sorted([26.0, -6.0] if speed > 0 else [-26.0, 6.0])
    assert (found.braking_power.value, found.peak_power.value) == pytest.approx(powers, rel=1e-12)
    assert found.fluctuation == pytest.approx(16.0, rel=1e-13)
    assert found.flywheel == pytest.approx(16 / (0.02 * 4), rel=1e-13)
    # the energy over the input is -8 cos x, whichever way it is gone
    assert abs(math.sin(found.fastest / 2)) < 1e-12
    assert abs(math.sin((found.slowest - math.pi) / 2)) < 1e-12
    assert found.found == "series"
    assert found.tail < 1e-13


def test_the_speed_of_a_flywheel_is_as_even_as_wanted():
    # law: (I w^2 / 2)' = mean M - M with the flywheel found; its highest and lowest speeds differ by delta of the mean
    found = sized(lambda x: 5 + 8 * np.sin(x) - 3 * np.cos(2 * x), speed=10.0, unevenness=0.01)
    x = grid(200000)
    energy = np.cumsum(found.mean_torque - (5 + 8 * np.sin(x) - 3 * np.cos(2 * x))) * (x[1] - x[0])
    middle = (energy.max() + energy.min()) / 2
    speeds = np.sqrt(100.0 + 2 * (energy - middle) / found.flywheel)
    assert (speeds.max() - speeds.min()) / 10.0 == pytest.approx(0.01, rel=1e-4)
    assert x[np.argmax(speeds)] == pytest.approx(found.fastest % math.tau, abs=1e-4)
    assert x[np.argmin(speeds)] == pytest.approx(found.slowest % math.tau, abs=1e-4)


def test_a_drive_that_never_brakes_has_no_braking_power():
    found = sized(lambda x: 5 + 3 * np.sin(x))
    assert found.braking_power is None
    assert found.flywheel is None
    assert found.peak_power.value == pytest.approx(16.0)


def test_a_press_stroke_has_the_energy_of_its_step():
    # 100 N m over an eighth of a turn: dE = 100 w (1 - w / 2 pi)
    width = math.pi / 4
    found = sized(lambda x: 100.0 * ((x - 1) % math.tau < width), breaks=(1.0, 1 + width), unevenness=0.1)
    assert found.found == "pieces"
    assert found.fluctuation == pytest.approx(100 * width * (1 - width / math.tau), rel=1e-13)
    assert found.peak_torque.value == pytest.approx(100.0, rel=1e-13)
    assert found.mean_torque == pytest.approx(100 / 8, rel=1e-13)
    assert found.rms_torque == pytest.approx(100 / math.sqrt(8), rel=1e-13)
    assert found.fastest % math.tau == pytest.approx(1.0, abs=1e-12)
    assert found.slowest % math.tau == pytest.approx(1 + width, abs=1e-12)


def test_a_peak_just_before_a_jump_is_its_limit():
    # a torque that rises until the load ends: its peak is reached at no row
    found = sized(lambda x: np.where(x % math.tau < 2.0, x % math.tau, 0.0), breaks=(0.0, 2.0))
    assert found.peak_torque.value == pytest.approx(2.0, rel=1e-13)
    assert found.peak_torque.input % math.tau == pytest.approx(2.0, abs=1e-12)
    assert found.mean_torque == pytest.approx(2 / math.tau, rel=1e-12)


def test_jumps_without_rows_between_the_rows_are_refused():
    drive = Drive(grid(), np.sign(np.sin(grid() + 0.01)))
    with pytest.raises(RequestError, match=r"^breaks: a torque that jumps"):
        sizing(drive, period=math.tau, speed=1.0, breaks=(0.0,))


def test_few_rows_are_told_by_the_tail_or_doubled():
    def sharp(x):
        return 1 / (1.02 - np.cos(x - 1))

    alone = sizing(Drive(grid(24), sharp(grid(24))), period=math.tau, speed=1.0)
    assert alone.tail > 1e-3
    found = sized(sharp, count=24)
    assert found.tail < 1e-12
    assert found.peak_torque.value == pytest.approx(50.0, rel=1e-11)


def test_a_bearing_has_peak_and_cubic_mean_of_each_part():
    def reactions(x):
        n = np.zeros_like(x)
        force = np.column_stack([300 * np.sin(x), n, 40 + n])
        return {"crank": Wrench(force, np.column_stack([3 * np.cos(x), 4 * np.cos(x), 7 + n]))}

    bearing = sized(lambda x: 1 + np.sin(x), reactions=reactions).bearings["crank"]
    mean_cube = 300 * (4 / (3 * math.pi)) ** (1 / 3)
    assert bearing.radial.peak.value == pytest.approx(300, rel=1e-13)
    assert bearing.radial.mean_cube == pytest.approx(mean_cube, rel=1e-6)
    assert [bearing.axial.peak.value, bearing.axial.mean_cube] == pytest.approx([40, 40], rel=1e-13)
    assert bearing.force.peak.value == pytest.approx(math.hypot(300, 40), rel=1e-13)
    assert abs(math.cos(bearing.force.peak.input)) < 1e-7
    assert bearing.tilting.peak.value == pytest.approx(5, rel=1e-13)
    assert bearing.turning.peak.value == pytest.approx(7, rel=1e-13)
    assert bearing.size == pytest.approx(np.abs(300 * np.sin(grid(90, 0.3))))
    assert np.abs(np.cos(bearing.direction)) == pytest.approx(1.0)


def test_what_equilibrium_does_not_determine_is_nan_and_spoils_nothing_else():
    # as in a planar four-bar: forces in the plane and the moment about the axis
    def reactions(x):
        unknown = np.full_like(x, np.nan)
        force = np.column_stack([np.cos(x), np.sin(x), unknown])
        flags = np.array([False, False, True, True, True, False])
        return {"pin": Wrench(force, np.column_stack([unknown, unknown, 0 * x]), flags)}

    found = sized(np.sin, reactions=reactions)
    pin = found.bearings["pin"]
    assert pin.radial.peak.value == pytest.approx(1.0)
    assert pin.turning.peak.value == 0.0
    for part in (pin.force, pin.axial, pin.tilting):
        assert math.isnan(part.peak.value)
        assert math.isnan(part.mean_cube)
    assert found.peak_torque.value == pytest.approx(1.0)


def test_a_row_without_torque_has_no_sizing():
    torque = np.sin(grid())
    torque[7] = np.nan
    assert sizing(Drive(grid(), torque), period=math.tau, speed=1.0) is None
    assert sizing(Drive(np.empty(0), np.empty(0)), period=None) is None


def test_rows_of_a_law_are_taken_as_they_are():
    @dataclass
    class Rows:
        input = np.array([0.0, 0.5, 2.0, 2.2])
        time = np.array([0.0, 1.0, 3.0, 4.0])
        torque = np.array([1.0, 3.0, -4.0, 1.0])
        power = np.array([0.0, 6.0, -6.0, 0.0])
        reactions = {}  # noqa: RUF012

    found = sizing(Rows(), period=None, unevenness=0.01)
    assert found.found == "rows"
    assert found.peak_torque == Peak(-4.0, 2.0)
    assert found.mean_torque == pytest.approx((2.0 - 1.0 - 1.5) / 4)
    assert found.peak_power.value == 6.0
    assert found.braking_power.value == -6.0
    # mean power 0: energy 0, 3, 3, 0
    assert found.fluctuation == pytest.approx(3.0)
    assert found.flywheel is None
    assert math.isnan(found.tail)


@pytest.mark.parametrize("bad", [0.0, -0.1, math.nan, "much"])
def test_an_unevenness_is_a_part_of_the_speed(bad):
    with pytest.raises(RequestError, match=r"^unevenness: "):
        sizing(Drive(grid(), np.sin(grid())), period=math.tau, speed=1.0, unevenness=bad)


def test_the_peak_torque_of_a_7r_lies_between_its_rows():
    masses = [Mass("a", 4, (-100.0, -90.0, -80.0), 2.5)]
    few, many = (inertia(sb.load("seven_r").motion(n), masses) for n in (360, 7200))
    drives = [Drive(found.input, found.torque) for found in (few, many)]
    found = sizing(drives[0], period=math.tau, speed=1.0)
    assert found.tail < 1e-9
    scale = np.abs(few.torque).max()
    best = int(np.argmax(np.abs(many.torque)))
    assert abs(found.peak_torque.value) >= np.abs(many.torque).max() * (1 - 1e-12)
    assert found.peak_torque.value == pytest.approx(many.torque[best], rel=1e-5)
    assert found.peak_torque.input % math.tau == pytest.approx(many.input[best] % math.tau, abs=1e-3)
    # energy of the masses is all that fluctuates: the torque's integral
    kinetic = many.kinetic
    assert found.fluctuation == pytest.approx(kinetic.max() - kinetic.min(), rel=1e-6)
    assert found.mean_torque == pytest.approx(0.0, abs=1e-12 * scale)


def test_a_sizing_without_joints_goes_across_change_points():
    # as tolerances ask it, for a circuit none of whose reactions is determined
    torque = np.sin(grid())
    gaps = np.zeros(90, dtype=bool)
    gaps[[0, 45]] = True
    drive = Drive(grid(), np.where(gaps, np.nan, torque))
    found = sizing(drive, period=math.tau, speed=1.0, gaps=gaps)
    assert found.peak_torque.value == pytest.approx(1.0, rel=1e-9)
