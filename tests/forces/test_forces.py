"""Torque, energies and reactions: laws of mechanics, closed forms of one link, and what equilibrium determines."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sevenbar as sb
from loaded import loaded_circuit, random_body

LOOPS = ("rssr", "seven_r", "rscr", "rsur", "rccc", "planar_4r", "bennett", "spherical_4r", "sarrus")


@pytest.mark.parametrize("name", LOOPS)
def test_power_closes_along_the_cycle(name: str) -> None:
    found = loaded_circuit(name)[1].forces()
    assert found.balance is not None
    assert found.balance < 5e-12


@pytest.mark.parametrize("name", ["rssr", "seven_r", "rscr", "rccc"])
def test_the_ground_holds_weights_loads_and_shaking(name: str) -> None:
    rng = np.random.default_rng(3)
    linkage = sb.load(name)
    circuit = linkage.motion(36).circuits[0]
    last = len(linkage.joints)
    bodies = {link: random_body(rng, circuit.size) for link in range(1, last)}
    gravity = np.array([1.0, 2.0, -9.8])
    load = np.array([3.0, 4.0, -5.0])
    found = circuit.forces(
        bodies=bodies, gravity=tuple(gravity), loads=[sb.Load(2, tuple(load), at=(1.0, 2.0, 3.0))]
    )
    first, end = (found.reactions[linkage.joints[k].name].force_in_report for k in (0, -1))
    weight = sum(body.mass for body in bodies.values()) * gravity
    left = first - end + weight + load + found.shaking[:, 3:]
    assert np.abs(left).max() < 1e-12 * np.abs(first).max()


def test_a_crank_on_its_own_bears_weight_and_centrifugal_force() -> None:
    circuit = sb.load("rssr").motion(36, speed=10.0).circuits[0]
    found = circuit.forces(bodies={1: sb.Body(2.0, (125.0, 0.0, 0.0))}, gravity=(0.0, 0.0, -9.81))
    crank = found.reactions["crank"]
    # z is the crank's axis; 2 kg at 0.125 m and 10 rad/s
    assert np.abs(crank.force[:, 2] - 2 * 9.81).max() < 1e-12
    assert np.abs(np.hypot(crank.force[:, 0], crank.force[:, 1]) - 2 * 0.125 * 100).max() < 1e-11
    assert np.abs(found.torque).max() < 1e-12
    assert np.abs(found.kinetic - 0.5 * 2 * 0.125**2 * 100).max() < 1e-12
    assert np.abs(found.reactions["ball_a"].force).max() < 1e-12


def test_torque_at_rest_is_the_slope_of_potential_energy() -> None:
    rows = 720
    angles = np.arange(rows) * 2 * np.pi / rows
    linkage = loaded_circuit("seven_r")[0].loaded(loads=[])
    assert linkage.loading.springs
    still = sb.Law.of(np.arange(float(rows)), angles, 0.0, 0.0)
    found = linkage.motion(law=still).circuits[0].forces()
    waves = np.fft.rfft(found.potential) * 1j * np.arange(rows // 2 + 1)
    slope = np.fft.irfft(waves, rows)
    assert np.abs(found.torque - slope).max() < 1e-12 * np.abs(slope).max()
    assert not found.power.any()


@pytest.mark.parametrize(
    ("name", "counts"),
    [
        ("seven_r", {6}),
        ("rssr", {6}),
        ("rscr", {6}),
        ("rsur", {6}),
        ("rccc", {6}),
        ("planar_4r", {3}),
        ("bennett", {1}),
        ("goldberg_5r", {1}),
        ("spherical_4r", {3}),
    ],
)
def test_flags_say_what_equilibrium_determines(name: str, counts: set[int]) -> None:
    linkage, circuit = loaded_circuit(name, 36)
    found = circuit.forces()
    assert {int(reaction.determinate.sum()) for reaction in found.reactions.values()} == counts
    assert found.indeterminate == linkage.mobility().redundant
    for reaction in found.reactions.values():
        assert (np.isnan(reaction.moment).all(axis=0) == ~reaction.determinate[:3]).all()
        assert (np.isnan(reaction.force).all(axis=0) == ~reaction.determinate[3:]).all()
        assert reaction.known.shape[1] == 6 - len(found.indeterminate)
        assert np.isfinite(reaction.known_values).all()


def test_a_spatial_rod_needs_nothing_to_hold_its_spin() -> None:
    circuit = sb.load("rssr").motion(36).circuits[0]
    rod = circuit.forces(bodies={2: sb.Body(1.3, solid="rod")}, gravity=(0.0, 0.0, -9.81))
    assert np.abs(rod.spin["coupler"]).max() < 1e-12 * np.abs(rod.torque).max()
    start, end = np.zeros(3), np.array([float(sb.load("rssr").lengths[1]), 0.0, 0.0])
    thick = sb.Body(1.3, tuple((start + end) / 2), np.diag([2e-3, 0.09, 0.09]))
    thin = sb.Body(1.3, tuple((start + end) / 2), np.diag([0.0, 0.09, 0.09]))
    # balls without friction never turn it about its line
    assert np.array_equal(circuit.forces(bodies={2: thick}).torque, circuit.forces(bodies={2: thin}).torque)
    aside = sb.Body(1.3, (float(end[0] / 2), 20.0, 0.0), np.diag([2e-3, 0.09, 0.09]))
    assert np.abs(circuit.forces(bodies={2: aside}).spin["coupler"]).max() > 0.01


def test_a_dead_centre_of_the_input_has_no_torque() -> None:
    linkage = sb.load("rssr")
    circuit = linkage.motion(36, input="rocker", output="crank").circuits[0]
    found = circuit.forces(bodies={1: sb.Body(2.0, (125.0, 0.0, 0.0))})
    dead = found.status == "dead-centre"
    assert dead.any()
    assert np.isnan(found.torque[dead]).all()
    assert np.isfinite(found.torque[found.status == "ok"]).all()


def test_nothing_that_acts_is_refused() -> None:
    circuit = sb.load("rssr").motion(8).circuits[0]
    with pytest.raises(sb.errors.RequestError, match="nothing has a mass and nothing acts"):
        circuit.forces()


def test_a_row_whose_balls_have_no_turns_has_its_forces() -> None:
    circuit = loaded_circuit("rssr", 36)[1]
    q, status = circuit.q.copy(), circuit.status.astype("<U20")
    q[5, 1:7], status[5] = np.nan, "turns-undefined"
    found, whole = replace(circuit, q=q, status=status).forces(), circuit.forces()
    assert abs(found.torque[5] - whole.torque[5]) < 1e-12 * np.abs(whole.torque).max()
    assert np.abs(found.reactions["ball_b"].force[5] - whole.reactions["ball_b"].force[5]).max() < 1e-9


def test_a_coupler_that_comes_near_the_axis_of_the_crank_has_the_same_forces_by_both_ways() -> None:
    """There the general way, which gives what lies between rows, holds the spin by another axis."""
    rng = np.random.default_rng(3)
    linkage = sb.rssr(M=150, N=250, L1=185, L2=500, L3=390, D=-475, speed="60 rpm")
    linkage = linkage.loaded(bodies={link: random_body(rng, 500.0) for link in (1, 2, 3)})
    circuit = linkage.motion().circuits[0]
    again = linkage.circuit(circuit.q[0])
    spin = circuit.columns.index("ball_a.3")
    assert np.ptp(circuit.q[:, spin]) < 1e-9 < 1 < np.ptp(again.q[:, spin])
    own = circuit.forces()
    assert np.abs(again.forces().torque - own.torque).max() < 1e-10 * np.abs(own.torque).max()
    assert own.sizing().tail < 1e-10


def test_a_linkage_whose_mass_stands_still_takes_nothing():
    # with crank and rod alike the slider, which alone has a mass, stays where it is on one circuit
    joints = [{"kind": "R", "at": [x, 0, 0], "axis": [0, 0, 1]} for x in (0, 50, 100)]
    joints.append({"kind": "P", "at": [100, 0, 0], "axis": [1, 0, 0]})
    linkage = sb.from_axes(joints).loaded(bodies={3: sb.Body(2.0, (100, 0, 0))})
    still, moving = sorted(linkage.motion(), key=lambda circuit: np.ptp(circuit.q[:, 3]))[:2]
    forces = still.forces()
    assert not np.nanmax(np.abs(forces.torque))
    size = forces.sizing()
    assert (size.peak_torque.value, size.peak_power.value, size.mean_torque) == (0.0, 0.0, 0.0)
    assert np.nanmax(np.abs(moving.forces().torque)) > 1e-3
