"""The reference for forces judged by itself: energy, the whole's momentum, textbooks, and what equilibrium leaves open."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy.precise_loops import DIGITS, PreciseLoop
from evidence.accuracy.reference_forces import NewtonEuler
from evidence.accuracy.reference_loops import Loop
from evidence.fuzz.loadings import random_loading
from sevenbar.forces.acting import Load
from sevenbar.forces.bodies import Body
from sevenbar.forces.loading import Loading
from sevenbar.text.units import LENGTHS
from textbook_loops import slider_crank_joints

#: One of each kind: planar, spherical and spatial, one to three redundant constraints, screws, slides, balls, crosses.
GALLERY = (
    "planar_4r", "spherical_4r", "bennett", "goldberg_5r", "sarrus", "bricard_line", "seven_r", "rssr", "rssp", "rscr",
    "rsur", "rccc", "screw_drill", "universal_joint",
)  # fmt: skip


def a_row(name: str) -> tuple[sb.Linkage, sb.Circuit, int]:
    """A row of a gallery linkage in the middle of a circuit."""
    linkage = sb.load(name)
    circuit = linkage.motion(12).circuits[0]
    rows = np.flatnonzero((circuit.status == "ok") | (circuit.status == "turns-undefined"))
    return linkage, circuit, int(rows[len(rows) // 3])


def system(
    linkage: sb.Linkage, circuit: sb.Circuit, loading: Loading, *, precise: bool = False
) -> NewtonEuler:
    """The reference driven as a circuit is."""
    metre = LENGTHS[linkage.length_unit]
    return NewtonEuler(linkage, circuit.input_column, loading, metre, precise=precise)


@pytest.mark.parametrize("name", GALLERY)
def test_torque_and_losses_feed_kinetic_and_potential_energy(name: str) -> None:
    linkage, circuit, row = a_row(name)
    loading = random_loading(np.random.default_rng(3), linkage)
    unit = 1.0 if circuit.input_turns else LENGTHS[linkage.length_unit]
    with mp.workdps(DIGITS):
        whole = system(linkage, circuit, loading, precise=True)
        step = mp.mpf(10) ** -14
        angle, speed = (mp.mpf(float(x[row, circuit.input_column])) for x in (circuit.q, circuit.dq))
        acceleration = mp.mpf("0.7") * abs(speed)
        found = []
        for t in (-step, 0, step):
            q = whole.motion.pose(circuit.q[row], angle + t * (speed + t * acceleration / 2))
            found.append(whole.at(q, speed + t * acceleration, acceleration))
        before, there, after = found
        gained = (after.kinetic + after.potential - before.kinetic - before.potential) / (2 * step)
        fed = there.torque * speed * unit + there.loss
        scale = abs(there.torque * speed * unit) + abs(there.loss)
        # rotations of links and points are given in sixteen digits
        assert abs(fed - gained) < 1e-14 * scale


@pytest.mark.parametrize("name", GALLERY)
def test_the_ground_bears_weights_loads_and_shaking(name: str) -> None:
    linkage, circuit, row = a_row(name)
    loading = random_loading(np.random.default_rng(4), linkage)
    whole = system(linkage, circuit, Loading(loading.gravity, loading.bodies, loading.loads[:1]))
    speed = circuit.dq[row, circuit.input_column]
    got = whole.at(circuit.q[row], speed, 0.3 * abs(speed))
    mass = sum(body.mass for bodies in loading.bodies.values() for body in bodies)
    force = [frame @ own for frame, own in zip(got.frames, got.force, strict=True)]
    # the last joint's link after is the ground, so what is put on it is taken off
    total = force[0] - force[-1] + mass * np.array(loading.gravity) + np.array(loading.loads[0].force)
    scale = max(np.abs(got.force).max(), np.abs(got.shaking[3:]).max())
    assert np.abs(total + got.shaking[3:]).max() < 1e-12 * scale


@pytest.mark.parametrize("name", GALLERY)
def test_double_precision_and_sixty_digits_agree(name: str) -> None:
    linkage, circuit, row = a_row(name)
    loading = random_loading(np.random.default_rng(5), linkage)
    rates = (circuit.dq[row, circuit.input_column], circuit.ddq[row, circuit.input_column])
    got = system(linkage, circuit, loading).at(circuit.q[row], *rates)
    with mp.workdps(DIGITS):
        precise = system(linkage, circuit, loading, precise=True)
        angle = mp.mpf(float(circuit.q[row, circuit.input_column]))
        want = precise.at(precise.motion.pose(circuit.q[row], angle), *(mp.mpf(float(r)) for r in rates))
    for one, other, flags in (
        (got.force, want.force, got.determinate[:, 3:]),
        (got.moment, want.moment, got.determinate[:, :3]),
    ):
        there = np.array(other, dtype=np.float64)
        if flags.any():
            assert np.abs(one - there)[flags].max() < 1e-12 * np.abs(there).max()
    assert abs(got.torque - float(want.torque)) < 1e-12 * max(abs(got.torque), np.abs(got.moment).max())


@pytest.mark.parametrize("name", ["seven_r", "rscr", "screw_drill", "planar_4r"])
def test_its_rates_are_those_of_finite_differences(name: str) -> None:
    linkage, circuit, row = a_row(name)
    speed = float(circuit.dq[row, circuit.input_column])
    with mp.workdps(DIGITS):
        precise = system(linkage, circuit, Loading(), precise=True)
        angle = mp.mpf(float(circuit.q[row, circuit.input_column]))
        dq, ddq = precise.motion.rates(precise.motion.pose(circuit.q[row], angle), mp.mpf(speed), mp.mpf(2))
        q = circuit.q[row]
        found = PreciseLoop(Loop.of(linkage), circuit.input_column).along((float(angle), speed, 2.0, 0.0), q)
        # numbers of sixteen digits close an overconstrained loop to sixteen digits
        closed = 1e-14 if linkage.mobility().redundant else 1e-18
        for k, (_, first, second, _) in enumerate(found):
            assert abs(dq[k] - first) < closed * (abs(first) + abs(speed)), k
            assert abs(ddq[k] - second) < closed * (abs(second) + speed**2), k


def test_a_slider_crank_is_that_of_the_textbook() -> None:
    """Massless crank and rod: the piston's inertia goes down the rod, leans on the cylinder and turns the crank."""
    crank, rod, mass, speed, angle = 50.0, 170.0, 1.2, 300.0, 0.8
    linkage = sb.from_axes(slider_crank_joints(crank, rod, at=angle), length_unit="mm")
    circuit = linkage.motion(8).circuits[0]
    link = 3
    loading = Loading(
        bodies={
            link: (
                Body(
                    mass, (crank * math.cos(angle) + math.sqrt(rod**2 - (crank * math.sin(angle)) ** 2), 0, 0)
                ),
            )
        }
    )
    whole = system(linkage, circuit, loading)
    row = int(np.flatnonzero(circuit.status == "ok")[1])
    got = whole.at(circuit.q[row], speed, 0.0)
    theta = angle + circuit.q[row, 0]
    with mp.workdps(30):

        def place(t: mp.mpf) -> mp.mpf:
            a = theta + speed * t
            return crank / 1000 * mp.cos(a) + mp.sqrt((rod**2 - (crank * mp.sin(a)) ** 2) / mp.mpf(10) ** 6)

        pace, second = (float(mp.diff(place, 0, order)) for order in (1, 2))
    lean = math.asin(crank * math.sin(theta) / rod)
    upright = np.array([frame @ own for frame, own in zip(got.frames, got.force, strict=True)])
    piston = mass * second
    assert got.torque == pytest.approx(piston * pace / speed, rel=1e-12)
    # on the piston by the rod, along which it acts; on the cylinder by the piston, across
    assert upright[2] == pytest.approx(
        [piston, -piston * math.tan(lean), 0], rel=1e-12, abs=1e-12 * abs(piston)
    )
    assert upright[3] == pytest.approx([0, -piston * math.tan(lean), 0], rel=1e-12, abs=1e-12 * abs(piston))


def test_a_load_and_a_motor_on_a_crank_balance() -> None:
    """A force of 10 N across the end of an arm of 250 mm asks for 2.5 N m, at any speed of a massless linkage."""
    linkage = sb.load("rssr")
    circuit = linkage.motion(8).circuits[0]
    load = Load(1, force=(0, 10, 0), at=(250, 0, 0), axes="link")
    got = system(linkage, circuit, Loading(loads=(load,))).at(circuit.q[2], 10.0, 3.0)
    assert got.torque == pytest.approx(-2.5, rel=1e-13)
    assert got.loss == pytest.approx(2.5 * 10, rel=1e-13)
    assert np.abs(got.force[1:]).max() < 1e-12


@pytest.mark.parametrize(
    ("name", "open_wrenches"),
    [
        ("seven_r", 0), ("rssr", 0), ("rscr", 0), ("rsur", 0), ("rccc", 0), ("sarrus", 1), ("goldberg_5r", 2), ("bennett", 3),
        ("planar_4r", 3), ("spherical_4r", 3),
    ],
)  # fmt: skip
def test_as_many_wrenches_are_open_as_constraints_are_redundant(name: str, open_wrenches: int) -> None:
    linkage, circuit, row = a_row(name)
    got = system(linkage, circuit, random_loading(np.random.default_rng(6), linkage)).at(
        circuit.q[row], 1.0, 0.0
    )
    assert got.open == open_wrenches == len(linkage.mobility().redundant)
