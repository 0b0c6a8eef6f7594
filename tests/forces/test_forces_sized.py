"""Sizing and balancing of loaded linkages: between the rows, over jumps of loads, two turns to a cycle."""

import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import RequestError

LEVER = {
    1: sb.Body(1.0, (80.0, 20.0, 0.0)),
    3: sb.Body(2.0, (30.0, 200.0, 10.0), np.diag([0.02, 0.03, 0.01])),
}
DOWN = (0.0, 0.0, -9.80665)


def rocker_load(**more):
    return sb.Load(3, (0.0, -300.0, 100.0), at=(0.0, 400.0, 0.0), **more)


@pytest.mark.parametrize("speed", [10.0, -10.0])
def test_the_peak_torque_does_not_depend_on_the_rows(speed):
    sizes = [
        sb.load("rssr")
        .motion(n, speed=speed)
        .circuits[0]
        .forces(bodies=LEVER, gravity=DOWN)
        .sizing(unevenness=0.02)
        for n in (24, 72, 360)
    ]
    last = sizes[-1]
    for found in sizes:
        assert found.found == "series"
        assert found.tail < 1e-12
        assert found.peak_torque.value == pytest.approx(last.peak_torque.value, rel=1e-11)
        assert found.peak_torque.input % math.tau == pytest.approx(
            last.peak_torque.input % math.tau, abs=1e-9
        )
        assert found.flywheel == pytest.approx(last.flywheel, rel=1e-11)
        assert found.bearings["rocker"].radial.mean_cube == pytest.approx(
            last.bearings["rocker"].radial.mean_cube, rel=1e-9
        )
    assert last.mean_torque == pytest.approx(0.0, abs=1e-10)


def test_without_loads_the_energy_that_fluctuates_is_that_of_bodies_and_weights():
    forces = sb.load("rssr").motion(7200).circuits[0].forces(bodies=LEVER, gravity=DOWN)
    energy = forces.kinetic + forces.potential
    assert forces.sizing().fluctuation == pytest.approx(np.ptp(energy), rel=1e-6)


def test_a_load_between_inputs_has_its_work_and_its_limits():
    between = (math.radians(40.0), math.radians(130.0))
    circuit = sb.load("rssr").motion(360).circuits[0]
    always = circuit.forces(loads=[rocker_load()], bodies=LEVER, gravity=DOWN)
    found = circuit.forces(loads=[rocker_load(between=between)], bodies=LEVER, gravity=DOWN).sizing()
    assert found.found == "pieces"
    assert found.tail < 1e-11
    # the mean torque is the load's work on the way, by the place of its point at the two ends
    ends = always.between(np.array(between))
    assert ends.torque.shape == (2,)
    places = (
        sb.load("rssr")
        .motion(law=sb.Law.of([0, 1], between, 1.0, 0.0))
        .circuits[0]
        .point(3, (0.0, 400.0, 0.0))
    )
    work = float(np.array([0.0, -300.0, 100.0]) @ (places.position[1] - places.position[0])) / 1000
    assert found.mean_torque == pytest.approx(-work / math.tau, rel=1e-9)
    # no row, however near the ends of the load, is above the peak
    dense = np.linspace(*between, 4001)
    greatest = np.abs(always.between(dense).torque).max()
    assert abs(found.peak_torque.value) >= greatest * (1 - 1e-12)


def test_a_cycle_of_two_turns_has_its_load_twice():
    circuit = sb.load("rssr").motion(36).circuits[0]
    loading = circuit.forces(loads=[rocker_load(between=(1.0, 2.0))], bodies=LEVER).loading
    assert loading.breaks(turns=2) == (1.0, 2.0, 1.0 + math.tau, 2.0 + math.tau)
    table = rocker_load(table=((0.0, 1.0, 2.0), (0.0, 1.0, 0.0)))
    assert circuit.forces(loads=[table]).loading.breaks(turns=1) == (0.0, 1.0, 2.0)


def test_a_circuit_that_rocks_has_no_sizing_at_constant_speed_and_one_under_a_law():
    linkage = sb.load("rssr")
    rocking = linkage.motion(90, input="rocker", output="crank").circuits[0]
    assert rocking.forces(bodies=LEVER).sizing() is None
    low, high = rocking.input_range
    time = np.linspace(0.0, 1.0, 201)
    middle, reach = (low + high) / 2, 0.3 * (high - low)
    q = middle + reach * np.sin(math.tau * time)
    law = sb.Law.of(
        time, q, math.tau * reach * np.cos(math.tau * time), -(math.tau**2) * reach * np.sin(math.tau * time)
    )
    passes = linkage.motion(input="rocker", output="crank", law=law).circuits[0].forces(bodies=LEVER)
    with pytest.raises(sb.errors.RequestError, match="passes one after the other"):
        passes.sizing()
    forces = passes.on(passes.branch == 0)
    assert len(forces.torque) == 201
    found = forces.sizing(unevenness=0.1)
    assert found.found == "rows"
    assert found.flywheel is None
    assert found.peak_torque.value == pytest.approx(forces.torque[np.argmax(np.abs(forces.torque))])


def test_bearings_of_a_planar_loop_are_determinate_in_its_plane_alone():
    circuit = sb.load("planar_4r").motion(72).circuits[0]
    found = circuit.forces(bodies={2: sb.Body(1.0, (10.0, 20.0, 0.0), np.diag([1e-3, 1e-3, 1e-3]))}).sizing()
    assert len(found.bearings) == 4
    for bearing in found.bearings.values():
        assert bearing.radial.peak.value > 0
        assert bearing.radial.mean_cube <= bearing.radial.peak.value
        assert math.isnan(bearing.axial.peak.value)
        assert math.isnan(bearing.tilting.peak.value)


def test_an_rssr_with_a_rod_is_balanced_and_the_forces_with_the_counterweights_say_so():
    circuit = sb.load("rssr").motion(180).circuits[0]
    bodies = {**LEVER, 2: sb.Body(1.3, solid="rod")}
    found = circuit.counterweights([1, 3], bodies=bodies, radius=120.0)
    assert found.before > 10
    assert found.after < 1e-11 * found.before
    assert (found.rank, found.unknowns) == (4, 6)
    assert found.idle == (
        "link 1: mass times radius along the axis of crank",
        "link 1: a mass in the pivot",
        "link 3: mass times radius along the axis of rocker",
        "link 3: a mass in the pivot",
    )
    both = {
        link: [body, *([found.bodies[link]] if link in found.bodies else [])] for link, body in bodies.items()
    }
    after = circuit.forces(bodies=both).shaking
    assert np.abs(after[:, 3:]).max() < 1e-10 * found.before
    # what is computed without the counterweights' own inertia: the moment is another, the force the same
    assert found.shaking[:, 3:] == pytest.approx(after[:, 3:], abs=1e-10 * found.before)


@pytest.mark.parametrize("name", ["rssr", "rscr", "seven_r", "planar_4r", "rccc", "spherical_4r"])
def test_a_unit_of_first_moment_and_mass_shakes_as_a_body_does(name):
    from sevenbar.kinematics.dynamics.balance import unit_shaking

    linkage = sb.load(name)
    circuit = linkage.motion(24).circuits[0]
    metre = {"mm": 1e-3, "m": 1.0, "cm": 1e-2, "in": 0.0254}[linkage.length_unit]
    for link in range(1, len(linkage.joints)):
        centre, mass = circuit.size * np.array([0.2, -0.1, 0.15]), 1.7
        unit = unit_shaking(linkage, circuit, link)
        # two bodies of one first moment and of equal inertia about the origin of the link
        arms = metre * np.array([centre, 0.5 * centre])
        about = [
            m * (a @ a * np.eye(3) - np.outer(a, a)) for m, a in zip((mass, 2 * mass), arms, strict=True)
        ]
        extra = 10 * mass * (metre * circuit.size) ** 2 * np.eye(3)
        one = circuit.forces(bodies={link: sb.Body(mass, tuple(centre), extra)}).shaking
        two = circuit.forces(
            bodies={link: sb.Body(2 * mass, tuple(0.5 * centre), extra + about[0] - about[1])}
        ).shaking
        # the same first moment, and a mass at the origin more
        scale = np.abs(one).max(axis=0) + np.abs(unit).max(axis=(0, 1)) * mass
        assert np.abs(two - one - mass * unit[:, 3]).max() <= 1e-9 * scale.max()
        force = np.einsum("j,njw->nw", [*(mass * centre), mass], unit)[:, 3:]
        assert np.abs(force - one[:, 3:]).max() <= 1e-10 * scale[3:].max()


def test_counterweights_where_shaking_has_no_bound_are_refused():
    rocking = sb.load("rssr").motion(90, input="rocker", output="crank").circuits[0]
    with pytest.raises(RequestError, match=r"^counterweights: the shaking grows without bound"):
        rocking.counterweights([1], bodies=LEVER)
    with pytest.raises(RequestError, match=r"^links: link 4 is the ground"):
        sb.load("rssr").motion(24).circuits[0].counterweights([4], bodies=LEVER)
