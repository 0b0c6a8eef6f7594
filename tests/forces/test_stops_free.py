"""Free motion and equilibria between stops, against closed forms and own sums."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from sevenbar.errors import RequestError

#: A hood on a four-bar hinge with a gas spring: a user's file.
HOOD = """
format = 1
length_unit = "mm"
drive = { joint = "g1", output = "g2" }
joint = [
  { name = "g1", kind = "R", at = [0, 0, 0], axis = [0, 1, 0] },
  { name = "h1", kind = "R", at = [-120, 0, 60], axis = [0, 1, 0] },
  { name = "h2", kind = "R", at = [-20, 0, 90], axis = [0, 1, 0] },
  { name = "g2", kind = "R", at = [80, 0, 40], axis = [0, 1, 0] },
]
point = [{ name = "lip", link = 2, at = [-1000, 0, 80] }]
forces = { gravity = [0, 0, -9.80665] }
stop = [{ joint = "g1", range = [0, 65] }]
[[body]]
link = 2
mass = 16
centre = [-500, 0, 100]
inertia = ["0.1 kg m^2", "1.4 kg m^2", "1.5 kg m^2", 0, 0, 0]
[[spring]]
name = "gas spring"
links = [4, 2]
at = [[-350, 0, -50], [-420, 0, 90]]
stiffness = "0.6 N/mm"
length = 900
"""

#: A crank of 2 kg m^2 about the origin whose weight does nothing, with links that have no mass.
WHEEL = {1: sb.Body(mass=2.0, centre=(0, 0, 0), inertia=2.0 * np.eye(3))}


def wheel(low: float, high: float) -> Any:
    """A crank-rocker whose crank alone has a mass, with a range of the crank [deg]."""
    linkage = sb.four_bar(crank=40, coupler=100, rocker=80, ground=90)
    name = linkage.columns[0]
    return linkage.stopped(ranges={name: (f"{low} deg", f"{high} deg")}).motion(samples=36).circuits[0]


def pendulum(low: float, high: float) -> Any:
    """The same, for a crank with its mass 0.2 m off the axis; gravity along -y."""
    return wheel(low, high)


def test_the_hood_is_held_open_by_its_stop_and_says_with_what_moment() -> None:
    circuit = sb.loads(HOOD).motion().circuits[0]
    found = circuit.free_motion("2s", start="65deg")
    assert (found.kind, found.rest.stop) == ("on its stop", "range of g1")
    assert abs(found.rest.holding) == pytest.approx(27.8998621747, rel=1e-9)
    assert np.all(found.input == found.input[0])
    assert not found.ddq.any()
    fall = circuit.free_motion("10s")
    # let go in the drawn pose it opens by itself
    assert fall.input[0] == pytest.approx(0, abs=1e-12)
    assert fall.input[-1] == pytest.approx(math.radians(65), abs=1e-12)
    assert fall.input.max() < math.radians(65) + 1e-12
    assert fall.input.min() > -1e-12
    assert fall.energy_error < 1e-12
    assert {place.kind for place in circuit.equilibria()} == {"on its stop"}


def test_the_command_says_how_the_hood_rests_on_its_stop(tmp_path: Any) -> None:
    file = tmp_path / "hood.toml"
    file.write_text(HOOD)
    text = " ".join(sevenbar("free", file, "--from", "65deg", "--time", "2s").stdout.split())
    assert "rests on its stop at g1 = 65 deg with 27.9 N m (range of g1)" in text
    assert "on its stop 65" in text
    assert "beyond the stops; they allow 0 deg to 65 deg" in mistake("free", file, "--from", "70deg")
    range_of = "its input goes from -22.9426332 deg to 276.682429 deg"
    assert range_of in mistake("free", file, "--from", "-40deg")
    assert "give 0 (no rebound) to 1" in mistake("free", file, "--restitution", "1.2")
    assert "no stops to rebound from" in mistake("free", "engine", "--restitution", "0.5")


def slowness_time(low: float, high: float, speed: Any) -> float:
    """The time from an angle, at rest there, to another: Gauss's rule in the root of the way."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    u = math.sqrt(abs(high - low)) * (nodes + 1) / 2
    places = low + math.copysign(1, high - low) * u**2
    return float(math.sqrt(abs(high - low)) / 2 * weights @ (2 * u / speed(places)))


def test_a_pendulum_falls_to_its_stop_and_rebounds_by_the_part_of_its_speed() -> None:
    circuit = pendulum(-90, 0)
    body = {1: sb.Body(mass=2.0, centre=(0, 20.0, 0), inertia=0.01 * np.eye(3))}
    inertia = 0.01 + 2.0 * 0.02**2

    def speed(places: Any) -> Any:
        # from rest at 0: J w^2 / 2 = m g r (0 - sin)
        return np.sqrt(2 * 2.0 * 9.81 * 0.02 * (0 - np.sin(places)) / inertia)

    for part in (0.0, 0.3, 0.9):
        found = circuit.free_motion(
            "20 s", start=0.0, restitution=part, bodies=body, gravity=(0, -9.81, 0), samples=2001
        )
        first = found.impacts[0]
        assert first.input == pytest.approx(-math.pi / 2, abs=1e-12)
        assert first.time == pytest.approx(slowness_time(0.0, -math.pi / 2, speed), rel=1e-10)
        assert first.speed == pytest.approx(-float(speed(-math.pi / 2)), rel=1e-10)
        assert found.energy_error < 1e-10
        if part == 0.0:
            # at the bottom nothing presses it on: it rests there in its own equilibrium
            assert len(found.impacts) == 1
            assert not found.speed[-1]
        else:
            second = found.impacts[1]
            assert second.speed == pytest.approx(part * first.speed, rel=1e-9)
            after = (found.time > first.time) & (found.time < second.time)
            highest = -math.pi / 2 + math.acos(1 - part**2)
            assert found.input[after].max() <= highest + 1e-9
            fine = found.at(np.linspace(first.time, second.time, 2001))
            assert fine.input.max() == pytest.approx(highest, abs=1e-5)
            assert [-one.speed for one in found.impacts[:5]] == pytest.approx(
                [-first.speed * part**k for k in range(5)], rel=1e-7
            )


def test_without_loss_it_rebounds_for_ever_and_a_million_seconds_cost_the_same() -> None:
    circuit = pendulum(-90, 0)
    body = {1: sb.Body(mass=2.0, centre=(0, 20.0, 0), inertia=0.01 * np.eye(3))}
    inertia = 0.01 + 2.0 * 0.02**2

    def speed(places: Any) -> Any:
        return np.sqrt(2 * 2.0 * 9.81 * 0.02 * (0 - np.sin(places)) / inertia)

    found = circuit.free_motion("1e6 s", start=0.0, restitution=1.0, bodies=body, gravity=(0, -9.81, 0))
    assert found.kind == "oscillation"
    assert found.period == pytest.approx(2 * slowness_time(0.0, -math.pi / 2, speed), rel=1e-10)
    assert [one.stop for one in found.impacts] == [f"range of {circuit.columns[0]}"]


@pytest.mark.parametrize("part", [0.0, 0.5])
def test_a_damped_wheel_meets_its_stop_by_the_closed_form(part: float) -> None:
    circuit = wheel(-60, 60)
    joint = circuit.columns[0]
    spring = sb.Spring(joint=joint, damping=0.5)
    found = circuit.free_motion(
        "80 s", start=0.0, speed=1.0, restitution=part, bodies=WHEEL, springs=[spring], samples=50
    )
    # J w' = -c w: the way is J w / c (1 - e^-ct/J)
    rate, way = 0.5 / 2.0, math.radians(60)
    meets = -math.log(1 - way * rate) / rate
    assert found.impacts[0].time == pytest.approx(meets, rel=1e-9)
    assert found.impacts[0].speed == pytest.approx(1 - way * rate, rel=1e-9)
    back = part * (1 - way * rate) / rate
    assert found.input[-1] == pytest.approx(way - back, abs=1e-3)
    assert math.isnan(found.energy_error)
    assert found.difference < 1e-9


def test_a_motor_that_turns_round_takes_it_off_the_stop_when_its_torque_does() -> None:
    # J phi'' = t - 2 from t = 2 on: phi = (t - 2)^3 / (6 J)
    circuit = wheel(0, 60)
    table = ([0.0, 1.0, 3.0, 4.0], [-1.0, -1.0, 1.0, 2.0])
    found = circuit.free_motion("3.5 s", start=0.0, torque_by_time=table, bodies=WHEEL, samples=36)
    expected = np.where(found.time > 2, (found.time - 2) ** 3 / 12.0, 0.0)
    assert found.input == pytest.approx(expected, abs=1e-9)
    assert found.kind == "meets stops"
    assert found.rest is None
    held = circuit.free_motion("3 s", start=0.0, torque_by_time=([0, 1], [-1, -2]), bodies=WHEEL)
    assert (held.kind, held.rest.holding, held.rest.holding_unit) == (
        "on its stop",
        pytest.approx(2.0),
        "N m",
    )


def test_a_constant_torque_presses_it_against_the_stop_that_answers_it() -> None:
    circuit = wheel(-20, 30)
    for torque, end in ((1.5, 30), (-0.7, -20)):
        (place,) = circuit.equilibria(torque=torque, bodies=WHEEL)
        assert (place.kind, math.degrees(place.input)) == ("on its stop", pytest.approx(end))
        assert place.holding == pytest.approx(-torque, rel=1e-10)
        found = circuit.free_motion("100 s", start=0.0, torque=torque, bodies=WHEEL)
        # from rest: M phi = J w^2 / 2
        assert abs(found.impacts[0].speed) == pytest.approx(
            math.sqrt(2 * torque * math.radians(end) / 2.0), rel=1e-9
        )
        assert found.rest.input == pytest.approx(math.radians(end), abs=1e-12)


def test_the_seam_of_a_circuit_is_no_stop() -> None:
    circuit = wheel(-30, 40)
    spring = sb.Spring(joint=circuit.columns[0], stiffness=3.0)
    found = circuit.free_motion("5 s", start="-20deg", bodies=WHEEL, springs=[spring])
    assert found.kind == "oscillation"
    assert not found.impacts
    assert found.period == pytest.approx(math.tau * math.sqrt(2.0 / 3.0), rel=1e-9)
    assert np.degrees([one.input for one in found.turning]) == pytest.approx([-20, 20])
    turned = circuit.free_motion("5 s", start="340deg", bodies=WHEEL, springs=[spring])
    assert turned.input[0] == pytest.approx(math.radians(340))


def test_equilibria_beyond_the_stops_are_left_out() -> None:
    linkage = sb.four_bar(crank=40, coupler=100, rocker=80, ground=90)
    body = {1: sb.Body(mass=2.0, centre=(0, 20.0, 0))}
    acting: dict[str, Any] = {"bodies": body, "gravity": (0, -9.81, 0)}
    name = linkage.columns[0]
    free = linkage.motion(samples=36).circuits[0].equilibria(**acting)
    assert sorted(place.kind for place in free) == ["stable", "unstable"]
    held = linkage.stopped(ranges={name: ("-60 deg", "60 deg")}).motion(samples=36).circuits[0]
    (place,) = held.equilibria(**acting)
    assert (place.kind, place.holding) == ("on its stop", pytest.approx(2 * 9.81 * 0.02 * 0.5))
    both = linkage.stopped(ranges={name: ("-100 deg", "100 deg")}).motion(samples=36).circuits[0]
    kinds = {round(math.degrees(place.input)): place.kind for place in both.equilibria(**acting)}
    assert kinds == {-90: "stable", 90: "unstable", 100: "on its stop", -100: "on its stop"} or kinds == {
        -90: "stable", 90: "unstable", 100: "on its stop"
    }  # fmt: skip


def test_a_stop_on_another_joint_holds_with_its_own_moment() -> None:
    linkage = sb.four_bar(crank=40, coupler=100, rocker=80, ground=90)
    rocker = linkage.columns[-1]
    whole = linkage.motion(samples=36).circuits[0]
    low, high = (getattr(whole.joint_ranges[rocker], end).value for end in ("low", "high"))
    stop = (low + 0.3 * (high - low), low + 0.6 * (high - low))
    circuit = linkage.stopped(ranges={rocker: stop}).motion(samples=36).circuits[0]
    acting: dict[str, Any] = {"bodies": {2: sb.Body(1.0, solid="rod")}, "gravity": (0, -9.81, 0)}
    held = [place for place in circuit.equilibria(**acting) if place.stop]
    assert held
    assert all(place.stop == f"range of {rocker}" for place in held)
    step = 1e-5
    for place in held:
        ends = [
            whole.free_motion(1e-9, start=place.input + way * step, samples=2, **acting) for way in (-1, 1)
        ]
        rise = ends[1].potential[0] - ends[0].potential[0]
        turned = ends[1].q[0, -1] - ends[0].q[0, -1]
        assert (place.holding, place.holding_unit) == (pytest.approx(rise / turned, rel=1e-7), "N m")


def test_where_stops_hold_a_whole_circuit_out_it_is_said() -> None:
    linkage = sb.four_bar(crank=40, coupler=100, rocker=80, ground=90)
    rocker = linkage.columns[-1]
    whole = linkage.motion(samples=36).circuits[0]
    high = whole.joint_ranges[rocker].high.value
    circuit = linkage.stopped(ranges={rocker: (high + 0.1, high + 0.2)}).motion(samples=36).circuits[0]
    with pytest.raises(RequestError, match="no pose of circuit 0 is within the stops"):
        circuit.free_motion(1.0, bodies=WHEEL)
    assert circuit.equilibria(bodies=WHEEL, torque=1.0) == ()


@pytest.mark.parametrize("value", [-0.1, 1.1, math.nan])
def test_a_restitution_is_a_part(value: float) -> None:
    with pytest.raises(RequestError, match="restitution"):
        wheel(0, 60).free_motion(1.0, restitution=value, bodies=WHEEL)
