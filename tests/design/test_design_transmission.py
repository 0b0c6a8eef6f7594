"""Design tasks that must transmit: the limit for every loop, the closed form, starts that end."""

import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.design.task import DesignTask, FigureMust, FigureWant, FreeNumber, FunctionWant
from sevenbar.design.task.effort import Effort
from sevenbar.design.task.file.reader import task_file
from sevenbar.design.task.loop import TaskLoop
from sevenbar.design.task.measured import Figures
from sevenbar.design.task.problem import TaskModel
from sevenbar.design.task.report import TaskDesigns, task_report
from sevenbar.design.task.search import designed
from sevenbar.design.task.transmitting import LeastAngle
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.kinematics.measures import gradient
from textbook_loops import four_bar_joints, linkage, slider_crank_joints, spherical_joints

TASK = """
linkage = "planar_4r"
free = {{ length_1 = "20:60", length_2 = "60:160", length_3 = "50:140" }}
[[want]]
kind = "function"
y = "x"
x = [0, 1]
input = "0:60deg"
output = "0:25deg"
{}
"""


def written(tmp_path, more):
    path = tmp_path / "task.toml"
    path.write_text(TASK.format(more))
    return task_file(path).task


def used_angles(design):
    """The transmission angle on many rows of what is used, by an own law of cosines."""
    a, b, c = design.values
    inputs = np.linspace(design.solution.inputs[0].min(), design.solution.inputs[0].max(), 400)
    # rows count the crank against the extension of the ground
    apart = a * a + 90.0**2 + 2 * a * 90.0 * np.cos(inputs)
    angle = np.arccos((b * b + c * c - apart) / (2 * b * c))
    return np.minimum(angle, np.pi - angle)


def test_a_planar_function_generator_is_held_to_a_least_transmission_angle(tmp_path):
    task = written(tmp_path, "[limits]\ntransmission = 40")
    found = designed(task, count=1, starts=3)
    (design,) = found.designs
    used = used_angles(design)
    assert np.degrees(used.min()) >= 40
    assert design.candidate.transmission_lowest == pytest.approx(used.min(), abs=1e-4)
    circuit = design.draft.linkage.motion(72).circuits[design.candidate.circuit]
    assert design.transmission == pytest.approx(circuit.transmission.lowest, abs=1e-9)
    assert design.transmission <= design.candidate.transmission_lowest + 1e-12
    # the report has both
    shown = TaskDesigns(found, "four", "", 3, 0)
    columns = task_report(task, 1, "").as_dict(shown)["designs"][0]
    assert columns["transmission_of_circuit_deg"] == pytest.approx(math.degrees(design.transmission))
    assert columns["transmission_lowest_deg"] >= 40


def test_of_a_loop_without_the_angle_the_limit_is_refused_with_what_can_be_done(tmp_path):
    path = tmp_path / "task.toml"
    path.write_text(
        'linkage = "bennett"\nfree = { length_1 = "40:60" }\n[[want]]\nkind = "function"\n'
        "pairs = [[0, 0], [10, 5]]\n[limits]\ntransmission = 30\n"
    )
    with pytest.raises(DescriptionError, match=r"no transmission angle is defined from .* bound velocity"):
        task_file(path)


def test_of_measures_alone_the_limit_holds_over_the_whole_circuit(tmp_path):
    path = tmp_path / "task.toml"
    path.write_text(
        'linkage = "planar_4r"\nfree = { length_1 = "20:60", length_3 = "60:120" }\n[[want]]\n'
        'kind = "measure"\nname = "swing"\nvalue = 50\n[limits]\ntransmission = 35\n'
    )
    task = task_file(path).task
    assert isinstance(task.wants[0], FigureWant)
    (design,) = designed(task, count=1, starts=2).designs
    assert design.figures["swing"] == pytest.approx(50, abs=1e-6)
    assert np.degrees(design.transmission) >= 35 - 1e-6


CLOSED = [
    linkage(four_bar_joints(40, 100, 80, 90)),
    linkage(four_bar_joints(40, 100, 80, 90)[::-1]),
    linkage(slider_crank_joints(40, 140, 10)),
    linkage(spherical_joints(0.5, 1.4, 1.2, 1.5)),
    sb.load("planar_4r"),
]


@pytest.mark.parametrize("found", CLOSED)
def test_the_closed_form_has_value_and_slopes_of_the_circuits_own(found):
    draft = Draft.of_linkage(found)
    motion = draft.linkage.motion(36)
    known = gradient(motion, 0, only=["transmission_lowest"])["transmission_lowest"]
    names = [d.name for d in draft.dimensions if d.kind != "speed"]
    free = [name for name, slope in zip(names, known.slopes, strict=True) if np.isfinite(slope)]
    loop = TaskLoop(draft, free)
    value, by = LeastAngle(loop).at(loop.start, motion.circuits[0].q[3], slopes=True)
    if motion.circuits[0].goes_round:
        assert value[0] == pytest.approx(known.value, abs=1e-9)
        assert by[0] == pytest.approx(loop.all_slopes(loop.start, known.slopes), rel=1e-6, abs=1e-9)
    else:
        assert value[0] <= 1e-6


def test_slopes_of_the_angle_are_those_of_differences():
    draft = Draft.of_linkage(sb.load("rssp"))
    found = gradient(draft.linkage.motion(36), 0, only=["transmission_lowest"])["transmission_lowest"]
    dims = [d for d in draft.dimensions if d.kind != "speed"]
    for k in np.flatnonzero(np.isfinite(found.slopes))[::4]:
        step, ends = 1e-3, []
        for way in (1, -1):
            own = draft.with_places({dims[k].place: draft.written(dims[k], dims[k].value + way * step)})
            ends.append(np.degrees(own.linkage.motion(36).circuits[0].transmission.lowest))
        assert found.slopes[k] == pytest.approx((ends[0] - ends[1]) / (2 * step), abs=1e-5)


def test_a_must_that_no_step_can_meet_ends_each_start_soon():
    start = Draft.of_linkage(sb.four_bar(40, 100, 80, 90))
    task = DesignTask(
        start,
        (FreeNumber("length_1", 10, 80),),
        (FigureWant("swing", 50.0),),
        (FigureMust("transmission_lowest", least=89.0),),
    )
    found = designed(task, count=1, starts=1)
    assert not found.designs
    with pytest.raises(RequestError, match="transmission_lowest is"):
        found.required(1)
    assert TaskModel(task).searched.measured


def test_a_start_ends_when_it_has_measured_all_that_it_may():
    effort = Effort()
    effort.begin(600)
    effort.take(599)
    assert (effort.left, effort.ended) == (1, 0)
    effort.take(2)
    assert (effort.left, effort.ended) == (0, 1)
    effort.take(2)
    assert effort.ended == 1


def test_a_function_and_a_dwell_need_no_motion_that_is_measured():
    start = Draft.of_linkage(sb.four_bar(40, 100, 80, 90))
    want = FunctionWant(np.radians([0.0, 30.0, 60.0]), np.radians([0.0, 10.0, 20.0]))
    model = TaskModel(DesignTask(start, (FreeNumber("length_2", 80, 120),), (want,)))
    assert not model.searched.measured


@pytest.mark.parametrize(
    ("name", "measures"),
    [
        ("planar_4r", ["swing", "time_ratio", "velocity_highest"]),
        ("rssp", ["swing", "transmission_lowest", "acceleration_lowest"]),
        ("seven_r", ["velocity_highest", "velocity_lowest"]),
        ("rssr_press", ["swing", "peak_torque"]),
    ],
)
def test_measures_of_the_circuit_through_a_pose_are_those_of_the_whole_motion(name, measures):
    draft = Draft.of_linkage(sb.load(name))
    motion = draft.linkage.motion(72)
    known = gradient(motion, len(motion.circuits) - 1, only=measures)
    names = [d.name for d in draft.dimensions if d.kind != "speed"]
    smooth = np.all([np.isfinite(known[one].slopes) for one in measures], axis=0)
    loop = TaskLoop(draft, [name for name, good in zip(names, smooth, strict=True) if good][:4])
    figures = Figures(loop, measures)
    row = next(row for row in motion.circuits[-1].q if np.isfinite(row).all())
    values, by = figures.at(loop.start, row)
    assert values == pytest.approx([known[one].value for one in measures], rel=1e-9)
    own = [loop.all_slopes(loop.start, known[one].slopes) for one in measures]
    assert by == pytest.approx(np.array(own), rel=1e-6, abs=1e-9)


def test_a_gradient_of_some_measures_is_part_of_that_of_all():
    motion = sb.load("planar_4r").motion(72)
    every = gradient(motion)
    for name in ("swing", "time_ratio", "velocity_lowest", "jerk_highest", "transmission_highest"):
        (only,) = gradient(motion, only=[name]).values()
        assert np.array_equal(only.slopes, every[name].slopes, equal_nan=True)


def test_over_the_whole_circuit_a_function_generator_is_found_that_transmits(tmp_path):
    must = "[[must]]\nkind = 'measure'\nname = 'transmission_lowest'\nleast = '40deg'"
    (design,) = designed(written(tmp_path, must), count=1, starts=8).designs
    a, b, c = design.values
    ends = [(b * b + c * c - (90 + way * a) ** 2) / (2 * b * c) for way in (-1, 1)]
    assert 90 - np.degrees(np.abs(np.arcsin(ends))).max() == pytest.approx(40, abs=1e-6)


def test_an_angle_that_shall_be_great_is_so_where_its_two_extremes_are_equal(tmp_path):
    # swing 50 of crank, coupler, rocker with a ground of 90: the best has equal angles at both ends
    path = tmp_path / "task.toml"
    path.write_text(
        'linkage = "planar_4r"\ngoal = "minimax"\nfree = { length_1 = "15:60", length_3 = "40:120" }\n[[want]]\n'
        'kind = "measure"\nname = "transmission_lowest"\nvalue = "great"\n[[must]]\nkind = "measure"\n'
        'name = "swing"\nleast = "49.9999deg"\nmost = "50.0001deg"\n'
    )
    (design,) = designed(task_file(path).task, count=1, starts=4).designs
    a, c = design.values
    low, high = ((100**2 + c * c - (90 + way * a) ** 2) / (200 * c) for way in (-1, 1))
    crank, rocker = np.meshgrid(np.linspace(15, 60, 901), np.linspace(40, 120, 801), indexing="ij")
    cosines = [(100**2 + rocker**2 - (90 + way * crank) ** 2) / (200 * rocker) for way in (-1, 1)]
    dead = [(90**2 + rocker**2 - (100 + way * crank) ** 2) / (180 * rocker) for way in (-1, 1)]
    turns = np.arccos(np.clip(dead, -1, 1))
    swing = np.degrees(np.abs(turns[1] - turns[0]))
    lowest = 90 - np.degrees(np.arcsin(np.clip(np.abs(cosines).max(axis=0), -1, 1)))
    best = lowest[(np.abs(swing - 50) < 0.1) & (lowest > 0)].max()
    assert math.degrees(design.transmission) == pytest.approx(best, abs=0.2)
    assert design.optimality < 1e-9
    assert abs(low) <= math.cos(design.transmission) + 1e-9 >= abs(high)
