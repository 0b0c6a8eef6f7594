"""Free motion: pendulums by elliptic integrals, published benchmarks, change points, losses, equilibria."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from rich.console import Console

import sevenbar as sb
from evidence.accuracy.chain_dynamics import HingedChain
from sevenbar.reporting.free_motion import free_report

G = 9.81
DOWN = (0.0, -G, 0.0)


def pendulum(**more: Any) -> tuple[sb.Circuit, dict[str, Any], float, float]:
    """A crank of an RSSR on its own: its circuit, what acts, m g d and the inertia about its axis."""
    crank = sb.Body(2.0, (125.0, 0.0, 0.0), np.diag([1e-3, 2e-3, 3e-3]))
    given = {"bodies": {1: crank}, "gravity": DOWN} | more
    return sb.load("rssr").motion().circuits[0], given, 2.0 * G * 0.125, 3e-3 + 2.0 * 0.125**2


def test_a_pendulum_swings_by_jacobi() -> None:
    circuit, given, moment, inertia = pendulum()
    fall = circuit.free_motion(10.0, start=0.0, samples=101, **given)
    # at rest a quarter turn from the lowest pose
    rate = mpmath.sqrt(moment / inertia)
    modulus = mpmath.mpf(1) / 2
    period = 4 * mpmath.ellipk(modulus) / rate
    assert fall.kind == "oscillation"
    assert fall.period is not None
    assert abs(fall.period - float(period)) < 1e-13 * float(period)
    quarter = mpmath.ellipk(modulus)
    expected = []
    for t in fall.time:
        sn = mpmath.ellipfun("sn", rate * t + quarter, m=modulus)
        expected.append(float(2 * mpmath.asin(mpmath.sqrt(modulus) * sn) - mpmath.pi / 2))
    assert np.abs(fall.input - expected).max() < 2e-12
    assert fall.energy_error < 1e-13
    assert sorted(round(point.input, 9) for point in fall.turning) == [-round(math.pi, 9), 0.0]


def test_a_pendulum_that_goes_round_does_so_by_jacobi() -> None:
    circuit, given, moment, inertia = pendulum()
    fall = circuit.free_motion(10.0, start="-90deg", speed=20.0, samples=101, **given)
    energy = mpmath.mpf(inertia) * 400 / 2
    modulus = 2 * moment / energy
    rate = mpmath.sqrt(energy / (2 * mpmath.mpf(inertia)))
    assert fall.kind == "rotation"
    assert fall.period is not None
    assert abs(fall.period - float(2 * mpmath.ellipk(modulus) / rate)) < 1e-13
    for t, angle in zip(fall.time, fall.input + math.pi / 2, strict=True):
        back = mpmath.ellipf(mpmath.mpf(float(angle)) / 2, modulus) / rate
        assert abs(float(back) - t) < 2e-12


def test_a_period_is_the_same_after_a_million_seconds() -> None:
    circuit, given, *_ = pendulum()
    fall = circuit.free_motion(1e6, start=0.0, samples=3, **given)
    assert fall.period is not None
    late = fall.at([0.3, 0.3 + 1000 * fall.period])
    assert np.abs(late.q[0] - late.q[1])[0] < 1e-11


def test_with_just_the_energy_to_stand_upright_it_comes_nearer_for_ever() -> None:
    circuit, given, moment, inertia = pendulum()
    rate = math.sqrt(moment / inertia)
    fall = circuit.free_motion(3.0, start="-90deg", speed=2 * rate, samples=31, **given)
    assert fall.kind == "asymptotic"
    expected = 4 * np.arctan(np.exp(rate * fall.time)) - math.pi - math.pi / 2
    early = fall.time < 1.5
    assert np.abs(fall.input - expected)[early].max() < 1e-9
    assert np.abs(fall.input - expected).max() < 1e-6


def test_small_vibrations_have_the_frequency_of_the_equilibrium() -> None:
    circuit, given, moment, inertia = pendulum()
    stable = next(place for place in circuit.equilibria(**given) if place.kind == "stable")
    assert abs(stable.frequency - math.sqrt(moment / inertia)) < 1e-10
    start = stable.input + 1e-4
    fall = circuit.free_motion(1.0, start=start, **given)
    assert fall.period is not None
    # the next term of the pendulum's series
    expected = math.tau / stable.frequency * (1 + 1e-8 / 16)
    assert abs(fall.period - expected) < 1e-10 * expected


def parallelogram(coupler: int = 1, rocker: int = 1) -> sb.Circuit:
    """Links of 1 m upright; rods of 1 kg, more of them on coupler and rocker for a longer chain."""
    places = ((0, 0), (0, 1), (1, 1), (1, 0))
    linkage = sb.from_axes(
        [{"kind": "R", "at": [x, y, 0.0], "axis": [0, 0, 1]} for x, y in places], length_unit="m"
    )
    rod = sb.Body(1.0, solid="rod")
    linkage = linkage.loaded(bodies={1: rod, 2: [rod] * coupler, 3: [rod] * rocker}, gravity=DOWN)
    (circuit,) = (c for c in linkage.motion() if np.ptp(c.output - c.input) < 1e-6)
    return circuit


def angle_of_chain(loops: int, t: float) -> float:
    """How far N four-bars of 1 m and 1 kg links have turned from upright, from 1 rad/s; 30 digits."""
    with mpmath.workdps(30):
        inertia = mpmath.mpf(loops + 1) / 3 + loops
        weight = (mpmath.mpf(loops + 1) / 2 + loops) * mpmath.mpf("9.81")

        def slowness(phi: Any) -> Any:
            return 1 / mpmath.sqrt(1 + 2 * weight / inertia * (1 - mpmath.cos(phi)))

        def time(phi: Any) -> Any:
            turns = int(mpmath.floor(phi / mpmath.pi))
            edges = [mpmath.pi * k for k in range(turns + 1)] + [phi]
            return mpmath.quad(slowness, edges)

        turn = mpmath.quad(slowness, [0, mpmath.pi, 2 * mpmath.pi])
        whole = int(mpmath.floor(t / turn))
        left = mpmath.mpf(t) - whole * turn
        rest = mpmath.findroot(lambda phi: time(phi) - left, 2 * mpmath.pi * left / turn)
        return float(whole * 2 * mpmath.pi + rest)


@pytest.mark.parametrize("loops", [1, 2])
def test_a_chain_of_four_bars_passes_its_change_points(loops: int) -> None:
    # a chain of N parallelograms moves as one whose coupler and rocker carry the others' rods
    circuit = parallelogram(loops, loops)
    fall = circuit.free_motion(10.0, start=0.0, speed=-1.0, samples=11)
    assert fall.through_change_points
    assert fall.kind == "rotation"
    for t, angle in zip(fall.time[1::3], -fall.input[1::3], strict=True):
        assert abs(angle - angle_of_chain(loops, float(t))) < 1e-11


def test_the_chain_of_two_four_bars_is_where_the_benchmark_has_it() -> None:
    # 40 digits by quadrature; Exudyn's published series tends to the same: 0.32845810, 0.94451853
    fall = parallelogram(2, 2).free_motion(20.0, start=0.0, speed=-1.0, samples=3)
    tip = np.stack([-np.sin(fall.input), np.cos(fall.input)], axis=1)
    assert np.abs(tip[1] - (0.3284581115408154, 0.944518538178601)).max() < 1e-11
    assert np.abs(tip[2] - (0.8397465743068435, 0.5429785363528847)).max() < 1e-11


def bricard() -> tuple[sb.Circuit, HingedChain]:
    """The library's Bricard mechanism: five rods of 1 m and 1 kg between six hinges."""
    places = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)], dtype=np.float64)
    axes = np.eye(3)[[1, 2, 0, 1, 2, 0]]
    linkage = sb.from_axes(
        [{"kind": "R", "at": at, "axis": axis} for at, axis in zip(places, axes, strict=True)],
        length_unit="m",
    ).loaded(bodies={link: sb.Body(1.0, solid="rod") for link in range(1, 6)}, gravity=DOWN)
    rods = np.diff(places, axis=0)
    inertias = np.array([(rod @ rod * np.eye(3) - np.outer(rod, rod)) / 12 for rod in rods])
    chain = HingedChain(places, axes, [1.0] * 5, (places[:-1] + places[1:]) / 2, inertias, np.array(DOWN))
    return linkage.motion().circuits[0], chain


def bricard_agrees(times: list[float]) -> None:
    circuit, chain = bricard()
    fall = circuit.free_motion(10.0, start=0.0).at(times)
    states = chain.states(np.zeros(5), np.zeros(5), times)
    off = states[:, 0] - fall.q[:, :5]
    assert np.abs(off - math.tau * np.round(off / math.tau)).max() < 1e-11
    assert np.abs(states[:, 1] - fall.dq[:, :5]).max() < 1e-10


def test_bricard_falls_as_newton_and_euler_have_it() -> None:
    bricard_agrees([0.2, 0.6])


def test_bricard_falls_for_ten_seconds_as_newton_and_euler_have_it() -> None:
    bricard_agrees([1.0, 2.0, 5.0, 10.0])


def spatial_slider_crank() -> sb.Circuit:
    """IFToMM's spatial slider-crank as Exudyn's test suite has it: the rod's cross keeps the start's angle."""
    a, b, c = (np.array(at) for at in ((0, 0.1, 0.12), (0, 0.1, 0.2), (0.2, 0, 0)))
    along = np.array([1.0, 0.0, 0.0])
    rod = (c - b) / np.linalg.norm(c - b)
    third = a - (a @ rod) * rod
    third /= np.linalg.norm(third)
    turn = np.column_stack([rod, np.cross(third, rod), third])
    linkage = sb.from_axes(
        [
            {"kind": "R", "at": a, "axis": along},
            {"kind": "S", "at": b},
            {"kind": "R", "at": c, "axis": turn[:, 1]},
            {"kind": "R", "at": c, "axis": along},
            {"kind": "P", "at": c, "axis": along},
        ],
        length_unit="m",
    )
    bodies = {
        1: sb.Body(0.12, tuple(a), np.diag([1e-4, 1e-5, 1e-4])),
        2: sb.Body(0.5, tuple((b + c) / 2), turn @ np.diag([4e-4, 4e-3, 4e-3]) @ turn.T),
        4: sb.Body(2.0, tuple(c)),
    }
    linkage = linkage.loaded(bodies=bodies, gravity=(0.0, 0.0, -9.81))
    return next(circuit for circuit in linkage.motion() if np.abs(circuit.q[0]).max() < 1e-9)


def angle_of_slider_crank(t: float) -> float:
    """The crank's angle by energy alone, in 25 digits: no joint, no matrix of the program."""
    with mpmath.workdps(25):
        half = mpmath.mpf(1) / 2

        def crank(angle: Any) -> Any:
            return mpmath.matrix(
                [0, mpmath.mpf("0.1") - mpmath.mpf("0.08") * mpmath.sin(angle),
                 mpmath.mpf("0.12") + mpmath.mpf("0.08") * mpmath.cos(angle)]
            )  # fmt: skip

        def slide(angle: Any) -> Any:
            b = crank(angle)
            return mpmath.sqrt(mpmath.mpf("0.09") - b[1] ** 2 - b[2] ** 2)

        def axes(angle: Any, cosine: Any) -> tuple[list[Any], list[Any]]:
            b = crank(angle)
            x = [
                (slide(angle) - b[0]) / mpmath.mpf("0.3"),
                -b[1] / mpmath.mpf("0.3"),
                -b[2] / mpmath.mpf("0.3"),
            ]
            # y is square to the rod and keeps its angle with the slide: y = p e + q (x cross e)
            square = 1 - x[0] ** 2
            p = cosine / square
            q = -mpmath.sqrt((1 - p**2 * square) / square)
            e = [1 - x[0] * x[0], -x[0] * x[1], -x[0] * x[2]]
            cross = [0, x[2], -x[1]]
            return x, [p * e[k] + q * cross[k] for k in range(3)]

        start = [mpmath.mpf(2) / 3, -mpmath.mpf(1) / 3, -mpmath.mpf(2) / 3]
        a = [mpmath.mpf(0), mpmath.mpf("0.1"), mpmath.mpf("0.12")]
        inner = sum(p * q for p, q in zip(a, start, strict=True))
        z = [p - inner * q for p, q in zip(a, start, strict=True)]
        size = mpmath.sqrt(sum(p * p for p in z))
        cosine = (z[1] * start[2] - z[2] * start[1]) / size
        step = mpmath.mpf(10) ** -8

        def inertia(angle: Any) -> Any:
            x, y = axes(angle, cosine)
            ends = [axes(angle + way * step, cosine) for way in (1, -1)]
            dx, dy = ([(ends[0][k][i] - ends[1][k][i]) / (2 * step) for i in range(3)] for k in (0, 1))
            third = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]
            spin = (
                sum(p * q for p, q in zip(dy, third, strict=True)),
                -sum(p * q for p, q in zip(dx, third, strict=True)),
                sum(p * q for p, q in zip(dx, y, strict=True)),
            )
            db = [0, -mpmath.mpf("0.08") * mpmath.cos(angle), -mpmath.mpf("0.08") * mpmath.sin(angle)]
            ds = (slide(angle + step) - slide(angle - step)) / (2 * step)
            centre = [ds / 2, db[1] / 2, db[2] / 2]
            turning = (4 * spin[0] ** 2 + 40 * spin[1] ** 2 + 40 * spin[2] ** 2) / 10000
            return mpmath.mpf(1) / 10000 + turning + half * sum(v * v for v in centre) + 2 * ds**2

        def potential(angle: Any) -> Any:
            return half * mpmath.mpf("9.81") * crank(angle)[2] / 2

        energy = 18 * inertia(mpmath.mpf(0)) + potential(mpmath.mpf(0))

        def slowness(angle: Any) -> Any:
            return mpmath.sqrt(inertia(angle) / (2 * (energy - potential(angle))))

        at = mpmath.mpf("1.2")
        for _ in range(6):
            at -= (mpmath.quad(slowness, [0, at / 2, at]) - t) / slowness(at)
        return float(at)


def test_the_spatial_slider_crank_is_where_energy_has_it() -> None:
    fall = spatial_slider_crank().free_motion(0.2, start=0.0, speed=6.0, samples=3)
    assert abs(fall.input[-1] - angle_of_slider_crank(0.2)) < 2e-12


def test_the_spatial_slider_crank_meets_the_published_number() -> None:
    circuit = spatial_slider_crank()
    rows = circuit.free_motion(0.2, start=0.0, speed=6.0, samples=3).motion().circuits[0]
    start = rows.link_motion(2)
    assert np.abs(start.velocity[0] - np.array([144, -72, 60]) / 85).max() < 1e-12
    # all coordinates of crank and rod, by absolute values, as the test suite adds them up
    b, c = np.array([0, 0.1, 0.2]), np.array([0.2, 0, 0])
    rod = (c - b) / 0.3
    a = np.array([0, 0.1, 0.12])
    third = a - (a @ rod) * rod
    third /= np.linalg.norm(third)
    body = start.rotation[-1] @ np.column_stack([rod, np.cross(third, rod), third])
    signs = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    quaternion = np.sqrt(np.maximum(0, 1 + signs @ np.diag(body))) / 2
    half = rows.input[-1] / 2
    found = 0.22 + abs(math.cos(half)) + abs(math.sin(half)) + quaternion.sum()
    found += np.abs(rows.point(2, tuple((b + c) / 2)).position[-1]).sum()
    # at a step of 2e-4 s; its own error there is of this size
    assert abs(found - 3.36427617809219) < 2e-8


def test_nothing_drives_a_free_motion() -> None:
    for name in ("rssr", "seven_r", "rscr", "planar_4r"):
        linkage = sb.load(name)
        circuit = linkage.motion().circuits[0]
        size = circuit.size
        bodies = {k: sb.Body(1.0 + 0.1 * k, (0.1 * size, 0.0, 0.0)) for k in range(1, len(linkage.joints))}
        given: dict[str, Any] = {"bodies": bodies, "gravity": (1.0, -9.0, 2.0)}
        fall = circuit.free_motion(2.0, samples=101, **given)
        found = fall.motion().circuits[0].forces(**given)
        weight = sum(body.mass for body in bodies.values()) * G * size / 1000
        assert np.nanmax(np.abs(found.torque)) < 1e-11 * weight
        assert np.nanmax(np.abs(found.kinetic + found.potential - found.kinetic[0] - found.potential[0])) < (
            1e-11 * weight
        )


def test_rates_of_rows_are_those_of_their_differences() -> None:
    circuit, given, *_ = pendulum()
    fall = circuit.free_motion(0.4, start=0.5, samples=4001, **given)
    step = fall.time[1]
    for value, rate in ((fall.q, fall.dq), (fall.dq, fall.ddq), (fall.ddq, fall.dddq)):
        slope = (value[2:] - value[:-2]) / (2 * step)
        assert np.abs(slope - rate[1:-1]).max() < 2e-5 * np.abs(rate).max()


def test_a_rocking_input_is_carried_over_its_dead_centres() -> None:
    linkage = sb.four_bar(crank=50, coupler=130, rocker=90, ground=100)
    rod = sb.Body(1.0, solid="rod")
    given: dict[str, Any] = {"bodies": {1: rod, 2: rod, 3: rod}, "gravity": DOWN}
    crank = linkage.motion().circuits[0]
    one = crank.free_motion(5.0, start="90deg", speed=30.0, samples=51, **given)
    assert one.kind == "rotation"
    rocking = linkage.motion(input=linkage.drive.output).circuits
    start = float(one.q[0, rocking[0].input_column])
    (rocker,) = (c for c in rocking if c.input_range and c.input_range[0] < start < c.input_range[1])
    energy = float(one.kinetic[0])
    periods = {
        round(rocker.free_motion(5.0, start=start, branch=k, energy=energy, **given).period or 0.0, 12)
        for k in (0, 1)
    }
    assert round(one.period or 0.0, 12) in periods


def test_a_damper_on_a_crank_slows_it_down_exponentially() -> None:
    circuit, given, _, inertia = pendulum(gravity=(0.0, 0.0, -G))
    damper = sb.Spring(damping=0.02, joint="crank")
    fall = circuit.free_motion(3.0, start=0.0, speed=7.0, springs=[damper], samples=31, **given)
    rate = 0.02 / inertia
    expected = 7.0 / rate * (1 - np.exp(-rate * fall.time))
    assert fall.kind == "driven"
    assert np.abs(fall.input - expected).max() < 1e-10
    assert np.abs(fall.speed - 7.0 * np.exp(-rate * fall.time)).max() < 1e-10
    assert fall.difference < 1e-7


def test_a_motor_curve_leads_to_its_speed() -> None:
    circuit, given, _, inertia = pendulum(gravity=(0.0, 0.0, -G))
    fall = circuit.free_motion(3.0, torque=([0.0, 100.0], [1.0, 0.0]), samples=31, **given)
    rate = 0.01 / inertia
    assert np.abs(fall.speed - 100.0 * (1 - np.exp(-rate * fall.time))).max() < 1e-8
    pulse = circuit.free_motion(1.0, torque_by_time=([0.0, 1.0], [0.0, 2.0]), samples=11, **given)
    assert np.abs(pulse.speed - pulse.time**2 / inertia).max() < 1e-9


def test_a_constant_torque_is_no_motor_that_is_stepped() -> None:
    circuit, given, _, inertia = pendulum(gravity=(0.0, 0.0, -G))
    fall = circuit.free_motion(2.0, torque=0.5, samples=21, **given)
    assert fall.kind == "passing"
    assert np.abs(fall.input - fall.input[0] - 0.25 / inertia * fall.time**2).max() < 1e-10


def test_a_spring_that_winds_up_swings_back() -> None:
    circuit, given, _, inertia = pendulum(gravity=(0.0, 0.0, -G))
    spring = sb.Spring(stiffness=0.1, joint="crank")
    fall = circuit.free_motion(4.0, start=0.0, speed=30.0, springs=[spring], samples=41, **given)
    rate = math.sqrt(0.1 / inertia)
    # 5.6 turns to either side
    assert 30.0 / rate > 5 * math.pi
    assert fall.kind == "oscillation"
    assert fall.period is not None
    assert abs(fall.period - math.tau / rate) < 1e-11
    assert np.abs(fall.input - 30.0 / rate * np.sin(rate * fall.time)).max() < 1e-9


def test_a_load_over_a_range_brakes_where_it_acts() -> None:
    circuit, given, _, inertia = pendulum(gravity=(0.0, 0.0, -G))
    load = sb.Load(1, torque=(0.0, 0.0, -1.0), between=(1.0, 2.0))
    fall = circuit.free_motion(3.0, start=0.0, speed=10.0, loads=[load], samples=301, **given)
    energy = inertia * 50.0 - np.clip(fall.input - 1.0, 0.0, 1.0)
    first = (fall.input >= 0.0) & (fall.input < 2.0)
    assert np.abs(fall.kinetic - energy)[first].max() < 1e-12
    # it is through once, and turns back in the second lap
    assert first.sum() > 10
    assert fall.kind == "passing"
    (turn,) = fall.turning
    assert abs(turn.input - (math.tau + inertia * 50.0)) < 1e-11


def test_equilibria_are_all_zeros_of_the_slope() -> None:
    linkage = sb.four_bar(crank=50, coupler=130, rocker=90, ground=100)
    rod = sb.Body(1.0, solid="rod")
    given: dict[str, Any] = {"bodies": {1: rod, 2: rod, 3: rod}, "gravity": DOWN}
    circuit = linkage.motion(3600).circuits[0]
    found = circuit.equilibria(**given)
    still = sb.Law.of(np.arange(3600.0), np.arange(3600) * math.tau / 3600, 0.0, 0.0)
    rows = linkage.motion(law=still).circuits[0]
    torque = rows.forces(**given).torque
    signs = np.flatnonzero(np.diff(np.sign(torque)))
    sampled = np.sort(rows.input[signs] % math.tau)
    exact = np.sort([place.input % math.tau for place in found])
    assert len(exact) == len(sampled)
    assert np.abs(exact - sampled).max() < 2 * math.tau / 3600
    # they take turns along the circuit
    kinds = [place.kind for place in found]
    assert all(a != b for a, b in zip(kinds, kinds[1:] + kinds[:1], strict=True))


def test_a_load_that_sets_in_can_hold_a_linkage() -> None:
    circuit, given, moment, _ = pendulum()
    push = sb.Load(1, torque=(0.0, 0.0, 3 * moment), between=(3.5, 4.0))
    # falling from pi to its lowest pose at 3 pi / 2 it is pushed on; from the other side it is not held
    back = sb.Load(1, torque=(0.0, 0.0, -3 * moment), between=(3.5, 4.0))
    on, held = (
        [place.kind for place in circuit.equilibria(**(given | {"loads": [load]}))] for load in (push, back)
    )
    assert "edge" not in on
    edges = [p for p in circuit.equilibria(**(given | {"loads": [back]})) if p.kind == "edge"]
    assert "edge" in held
    assert abs(edges[0].input % math.tau - 3.5) < 1e-9


def heavy_rocker(**more: Any) -> sb.Circuit:
    """A crank-rocker in which the rocker alone has a mass, with what else acts."""
    linkage = sb.four_bar(crank=30, coupler=90, rocker=60, ground=100)
    return linkage.loaded(bodies={3: sb.Body(1.0, solid="rod")}, **more).motion().circuits[0]


def test_where_nothing_with_a_mass_moves_there_is_no_vibration() -> None:
    # a spring of the rocker rests where the rocker turns back
    found = heavy_rocker(springs=[sb.Spring(stiffness=1.0, joint="theta_4")]).equilibria()
    assert sorted(place.kind for place in found) == ["stable", "unstable"]
    assert all(math.isnan(place.frequency) and math.isnan(place.rate) for place in found)


@pytest.mark.parametrize(
    "more",
    [
        {},
        {"start": 1.5, "speed": 3.0},
        {"start": 1.5, "energy": 1.0},
        {"torque": 100.0},
        {"torque": ([0.0, 1000.0], [100.0, 0.0])},
    ],
)
def test_a_motion_through_a_pose_without_moving_mass_is_refused(more: dict[str, Any]) -> None:
    circuit = heavy_rocker(springs=[sb.Spring(stiffness=1.0, joint="theta_2")])
    with pytest.raises(sb.errors.RequestError, match="nothing that has a mass moves, so its speed there has"):
        circuit.free_motion(1.0, **more)


def test_a_motion_that_stays_off_the_pose_without_moving_mass_is_found() -> None:
    # from about the middle of its swing the rocker is held by a stiff spring of the crank
    circuit = heavy_rocker(springs=[sb.Spring(stiffness=100.0, joint="theta_1", length=1.5)])
    fall = circuit.free_motion(1.0, start=1.4, samples=11)
    assert fall.kind == "oscillation"
    assert fall.energy_error < 1e-10


def slider_crank(crank: float, rod: float, **more: Any) -> sb.Circuit:
    """A slider-crank along x with 2 kg on the slider alone, circuit 0."""
    places = (0.0, crank, crank + rod)
    joints: list[dict[str, Any]] = [{"kind": "R", "at": [x, 0, 0], "axis": [0, 0, 1]} for x in places]
    joints.append({"kind": "P", "at": [places[-1], 0, 0], "axis": [1, 0, 0]})
    body = sb.Body(2.0, (places[-1], 0.0, 0.0))
    return sb.from_axes(joints).loaded(bodies={3: body}, **more).motion().circuits[0]


def test_a_piston_at_its_dead_centre_has_no_frequency() -> None:
    circuit = slider_crank(40.0, 100.0, gravity=(-G, 0.0, 0.0))
    found = {place.kind: place for place in circuit.equilibria()}
    assert math.isnan(found["stable"].frequency)
    assert math.isnan(found["unstable"].rate)
    still = circuit.free_motion(1.0, start=math.pi, samples=3)
    assert still.kind == "rest"
    assert not still.ddq.any()
    page = Console(width=100, file=io.StringIO())
    page.print(free_report(()).text((still, circuit.equilibria())))
    assert "none" in page.file.getvalue()  # type: ignore[attr-defined]


def test_table_and_figure_of_a_report_are_of_the_motion(tmp_path: Path) -> None:
    circuit, given, *_ = pendulum()
    fall = circuit.free_motion(0.5, start=0.0, samples=6, **given)
    free_report(["svg"]).write((fall, circuit.equilibria(**given)), tmp_path)
    with (tmp_path / "free.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["time_s"]) for row in rows] == fall.time.tolist()
    assert [float(row["kinetic_J"]) for row in rows] == fall.kinetic.tolist()
    assert "free motion" in (tmp_path / "free.svg").read_text("utf-8")


def test_a_circuit_on_which_no_mass_moves_is_refused() -> None:
    # with crank and rod alike the slider stays where it is on one circuit
    circuit = slider_crank(50.0, 50.0)
    assert np.nanmax(np.abs(circuit.dq[:, 3])) < 1e-9
    with pytest.raises(sb.errors.RequestError, match="nothing that moves on this circuit has a mass"):
        circuit.free_motion(3.0, start="30deg", speed=1.0)


def test_a_spring_that_winds_up_has_no_equilibrium_at_the_seam_of_laps() -> None:
    linkage = sb.four_bar(crank=30, coupler=90, rocker=60, ground=100)
    rods = {link: sb.Body(1.0, solid="rod") for link in (1, 2, 3)}
    circuit = linkage.loaded(bodies=rods).motion().circuits[0]
    for length in (0.5, 3.0, 6.0):
        spring = sb.Spring(stiffness=1.0, joint="theta_1", length=length)
        (place,) = circuit.equilibria(springs=[spring])
        assert place.kind == "stable"
        assert abs(place.input - length) < 1e-12
        fall = circuit.free_motion(1.0, start=length, springs=[spring], samples=3)
        assert np.abs(fall.input - length).max() < 1e-9


def test_equilibria_of_a_spring_that_winds_up_are_those_on_the_lap_of_the_rows() -> None:
    # the path of this circuit begins at a change point, at 270 degrees
    linkage = sb.four_bar(crank=1, coupler=2, rocker=1, ground=2, length_unit="m")
    spring = sb.Spring(stiffness=12.0, joint="theta_1", length=math.pi / 2)
    linkage = linkage.loaded(bodies={2: sb.Body(3.0, solid="rod")}, springs=[spring])
    for circuit in linkage.motion():
        if np.nanmax(np.abs(circuit.dq[:, 3] - circuit.dq[:, 0])) > 1e-6:
            continue
        (place,) = circuit.equilibria()
        assert place.kind == "stable"
        assert abs(place.input - math.pi / 2) < 1e-12
        # 3 kg on a circle of 1 m
        assert abs(place.frequency - 2.0) < 1e-9
        break
    else:
        pytest.fail("no circuit of the parallelogram")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"duration": 0}, "duration: 0 is not a time"),
        ({"duration": 1.0, "speed": 1.0, "energy": 1.0}, "energy: speed and energy are both given"),
        ({"duration": 1.0, "energy": -1.0}, "energy: -1.0 is not a kinetic energy"),
        ({"duration": 1.0, "branch": 1}, "start: is missing"),
        ({"duration": 1.0, "start": 0.0, "branch": 5}, "branch: 5 is not offered"),
        ({"duration": 1.0, "samples": 1}, "samples: 1 is not a number of rows"),
        ({"duration": 1.0, "torque": ([1.0], [2.0])}, "torque: give as many torques as speeds"),
        ({"duration": 1.0, "bodies": {}}, "bodies: nothing has a mass"),
    ],
)
def test_a_wrong_request_says_what_is_allowed(options: dict[str, Any], words: str) -> None:
    circuit, given, *_ = pendulum()
    with pytest.raises(sb.errors.RequestError) as caught:
        circuit.free_motion(**(given | options))
    assert words in str(caught.value)
