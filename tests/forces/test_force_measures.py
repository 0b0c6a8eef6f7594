"""Measures of forces by name, and their derivatives by dimensions and masses."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import sevenbar as sb
from loaded import loaded_circuit
from sevenbar.description.forms import from_description
from sevenbar.kinematics.measures import gradient, mass_gradient, measures_named, rows_of
from sevenbar.kinematics.numbers.sensitivity import Numbers


def measured(linkage: sb.Linkage, names: list[str]) -> dict[str, float]:
    (row,) = rows_of(linkage.motion(), measures_named(names))[:1]
    return {name: float(row[name]) for name in names}


def changed(linkage: sb.Linkage, place: tuple[str | int, ...], value: float) -> sb.Linkage:
    """The linkage with another number in its description."""
    description = copy.deepcopy(dict(linkage.description))
    table = description
    for key in place[:-1]:
        table = table[key]
    table[place[-1]] = value
    return from_description(description)


def test_measures_are_those_of_the_sizing() -> None:
    linkage, circuit = loaded_circuit("rssr")
    sizing = circuit.forces().sizing()
    assert sizing is not None
    names = [
        "peak_torque",
        "rms_torque",
        "peak_power",
        "energy_fluctuation",
        "peak_force:crank",
        "peak_tilting:rocker",
    ]
    found = measured(linkage, names)
    crank, rocker = sizing.bearings["crank"], sizing.bearings["rocker"]
    assert found["peak_torque"] == pytest.approx(abs(sizing.peak_torque.value), rel=1e-9)
    assert found["rms_torque"] == pytest.approx(sizing.rms_torque, rel=1e-9)
    assert found["peak_power"] == pytest.approx(sizing.peak_power.value, rel=1e-9)
    assert found["energy_fluctuation"] == pytest.approx(sizing.fluctuation, rel=1e-9)
    assert found["peak_force:crank"] == pytest.approx(crank.force.peak.value, rel=1e-9)
    assert found["peak_tilting:rocker"] == pytest.approx(rocker.tilting.peak.value, rel=1e-9)


@pytest.mark.parametrize("name", ["seven_r", "rscr"])
def test_derivatives_by_dimensions_are_those_of_differences(name: str) -> None:
    linkage, _ = loaded_circuit(name)
    joint = linkage.joints[1].name
    names = ["peak_torque", "rms_torque", "peak_power", "peak_shaking", f"peak_force:{joint}"]
    slopes = gradient(linkage.motion())
    numbers = Numbers(linkage)
    checked = 0
    for i, dimension in enumerate(numbers.dimensions[:5]):
        step = 1e-5 * (abs(dimension.value) or 1.0)
        ends = [
            measured(changed(linkage, dimension.place, dimension.value + sign * step), names)
            for sign in (1, -1)
        ]
        for measure in names:
            found = float(slopes[measure].slopes[i])
            wanted = (ends[0][measure] - ends[1][measure]) / (2 * step)
            size = slopes[measure].value / (abs(dimension.value) or 1.0)
            assert abs(found - wanted) < 1e-6 * (abs(wanted) + size), (dimension.name, measure, found, wanted)
            checked += abs(wanted) > 1e-6 * size
    assert checked > 5


def test_only_the_measures_that_are_asked_for_have_derivatives_and_the_same() -> None:
    linkage, _ = loaded_circuit("rssr")
    motion = linkage.motion(72)
    every, masses = gradient(motion), mass_gradient(motion)
    for names in (["rms_torque"], ["peak_shaking", "swing"], ["transmission_lowest", "peak_force:crank"]):
        found = gradient(motion, only=names)
        assert set(found) == set(names)
        for name, one in found.items():
            assert one.value == pytest.approx(every[name].value, rel=1e-12)
            assert one.slopes == pytest.approx(every[name].slopes, rel=1e-9, nan_ok=True)
        by_masses = mass_gradient(motion, only=names)
        assert set(by_masses) == set(names) & set(masses)
        assert all(one.slopes == pytest.approx(masses[n].slopes, rel=1e-9) for n, one in by_masses.items())
    assert gradient(motion, only=["motion_type", "usable"]) == {}
    with pytest.raises(sb.errors.RequestError, match="'swign' is not a measure; did you mean 'swing'"):
        gradient(motion, only=["swign"])


def test_derivatives_by_masses_add_up_to_what_masses_do_alone() -> None:
    linkage, _ = loaded_circuit("seven_r")
    alone = linkage.loaded(loads=[], springs=[])
    masses = np.array([bodies[0].mass for _, bodies in sorted(alone.loading.bodies.items())])
    found = mass_gradient(alone.motion())
    # weights and inertia alone are linear in all masses together
    for name in ("peak_torque", "rms_torque", "peak_power", "peak_shaking", "peak_force:theta_3"):
        assert abs(found[name].slopes @ masses - found[name].value) < 1e-9 * found[name].value


def test_a_joint_that_does_not_exist_and_a_linkage_without_masses_are_refused() -> None:
    motion = loaded_circuit("rssr")[0].motion(36)
    with pytest.raises(sb.errors.RequestError, match=r"peak_force:.*JOINT"):
        measures_named(["peak_force"])
    with pytest.raises(sb.errors.RequestError, match="crank"):
        rows_of(motion, measures_named(["peak_force:krank"]))
    with pytest.raises(sb.errors.RequestError, match="nothing has a mass"):
        rows_of(sb.load("rssr").motion(36), measures_named(["peak_torque"]))


def test_a_measure_of_a_joint_goes_through_a_process() -> None:
    (measure,) = measures_named(["peak_force:crank"])
    again = pickle.loads(pickle.dumps(measure))
    assert again.name == measure.name
    circuit = loaded_circuit("rssr")[1]
    assert again.value(circuit) == measure.value(circuit)


def test_the_peak_of_shaking_is_found_between_the_rows() -> None:
    few, many = (sb.load("rssr_press").motion(rows) for rows in (7, 36_000))
    (found,) = (row["peak_shaking"] for row in rows_of(few, measures_named(["peak_shaking"]))[:1])
    shaking = many.circuits[0].forces().shaking[:, 3:]
    # next to a peak a row at most half a step away misses of it what its curvature makes of that
    assert found == pytest.approx(np.linalg.norm(shaking, axis=1).max(), rel=1e-7)
    greatest = np.linalg.norm(few.circuits[0].forces().shaking[:, 3:], axis=1).max()
    assert found > greatest * 1.001


def test_a_circuit_that_rocks_has_no_peak_of_shaking() -> None:
    linkage, circuit = loaded_circuit("rssr")
    (row,) = rows_of(
        linkage.motion(input=circuit.columns[-1]), measures_named(["peak_shaking", "peak_torque"])
    )[:1]
    assert row["peak_shaking"] is None
    assert row["peak_torque"] is None
