"""Masses as free numbers of a design task: exact slopes, and the optimum that least squares give."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.design.task import DesignTask, FigureMust, FigureWant, FreeNumber, FunctionWant, designed
from sevenbar.design.task.contradictions import contradictions
from sevenbar.design.task.problem import TaskModel

RODS = {2: sb.Body(1.3, solid="rod"), 3: sb.Body(2.0, solid="rod")}


def weighed(bodies):
    return sb.rssr(M=700, N=700, L1=250, L3=550, D=0).loaded(bodies=bodies, gravity=(0, -9.81, 0))


def counterweight(mass: float) -> dict[int, sb.Body]:
    return {1: sb.Body(mass, centre=(-200, 0, 0))}


def test_slopes_by_masses_and_dimensions_are_those_of_differences():
    draft = Draft.of_linkage(weighed(counterweight(5.0) | RODS))
    free = (FreeNumber("mass_1", 0.1, 60), FreeNumber("L1", 200, 300), FreeNumber("mass_3", 0.1, 9))
    names = ("rms_torque", "peak_torque", "peak_force:rocker", "peak_shaking", "swing")
    model = TaskModel(DesignTask(draft, free, tuple(FigureWant(name, "small") for name in names)))
    row, start = draft.linkage.motion(72).circuits[0].q[0], model.loop.start
    found = model.figures.at(start, row)
    assert found is not None
    for k, step in enumerate((1e-3, 1e-3, 1e-3)):
        ends = [model.figures.at(start + way * step * np.eye(3)[k], row, slopes=False)[0] for way in (1, -1)]
        wanted = (ends[0] - ends[1]) / (2 * step)
        np.testing.assert_allclose(found[1][:, k], wanted, rtol=1e-5, atol=1e-6)


def test_the_mass_of_a_counterweight_is_that_of_least_squares():
    draft = Draft.of_linkage(weighed(counterweight(5.0) | RODS))
    task = DesignTask(draft, (FreeNumber("mass_1", 0.1, 60),), (FigureWant("rms_torque", "small"),))
    (design,) = designed(task, count=1, starts=2).designs
    circuit = design.candidate.circuit
    # the torque is linear in the mass
    own, rest = (
        weighed(bodies).motion(360).circuits[circuit].forces().torque for bodies in (counterweight(1.0), RODS)
    )
    assert design.values[0] == pytest.approx(-(rest @ own) / (own @ own), rel=1e-7)
    assert design.optimality < 1e-8
    # what is written has the new mass, and opens
    again = Draft.of(design.draft.toml(), "design").linkage
    assert again.loading.bodies[1][0].mass == design.values[0]


def test_a_mass_that_nothing_asks_for_or_that_is_none_is_refused():
    draft = Draft.of_linkage(weighed(RODS))
    want = FunctionWant(np.radians([60.0, 80.0, 100.0]), np.radians([10.0, 20.0, 35.0]))
    (alone,) = contradictions(DesignTask(draft, (FreeNumber("mass_2", 1, 2),), (want,)))
    assert "no measure of forces is wanted" in str(alone)
    must = (FigureMust("peak_torque", most=50.0),)
    found = contradictions(DesignTask(draft, (FreeNumber("mass_2", 0, 2),), (want,), must))
    assert any("0 is no mass; give bounds > 0" in str(one) for one in found)


def test_a_mass_is_read_in_its_units_and_swept():
    mass = Draft.of_linkage(weighed(RODS)).dimension("mass_2")
    assert (mass.read("300 g"), mass.column) == (0.3, "mass_2_kg")
    rows = sb.sweep.run(weighed(RODS), {"mass_3": [1.0, 2.0]}, ["peak_torque"]).table().to_pylist()
    assert rows[0]["peak_torque_N_m"] < rows[-1]["peak_torque_N_m"]
