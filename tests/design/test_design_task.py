"""Design tasks: exact slopes, known answers found again, conditions of an optimum, defective designs refused."""

import math
from io import StringIO
from itertools import pairwise

import numpy as np
import pytest
from rich.console import Console

import sevenbar as sb
from evidence.design.__main__ import FOUND, is_whole, unit_of
from evidence.design.tasks import tasks
from sevenbar.description.draft import Draft
from sevenbar.design.candidates import Refusal
from sevenbar.design.limits import Limits
from sevenbar.design.task import (
    Apart,
    DesignTask,
    DwellWant,
    FigureMust,
    FigureWant,
    FreeNumber,
    FunctionWant,
    InBox,
    InCone,
    InRange,
    Most,
    PathWant,
    PoseWant,
    StraightWant,
)
from sevenbar.design.task.along import DesignAlong
from sevenbar.design.task.check import TaskDesign, checked_design
from sevenbar.design.task.placing import rotation_of_vector
from sevenbar.design.task.problem import TaskModel, TaskProblem, TaskSeed, pose_slacks
from sevenbar.design.task.report import TaskDesigns, task_report
from sevenbar.design.task.search import DesignsFound, designed
from sevenbar.design.task.solve import Solved, solved
from sevenbar.design.task.starts import seeds
from sevenbar.kinematics.loop.rods import nearest_shares
from sevenbar.kinematics.numbers.least_squares import nearest_least
from sevenbar.kinematics.ranges.ball_angle import ball_angle

KNOWN = Draft.of_linkage(sb.load("rssr")).with_values({"L2": 1000.0}).with_point("Q", 3, (50.0, 60.0, 20.0))
NAMES = ("M", "N", "L1", "L2", "L3", "D")
CIRCUIT = KNOWN.linkage.motion(36).circuits[0]


def free(draft, names, by=200.0):
    """Free numbers that may go so far to each side."""
    own = [draft.dimension(name) for name in names]
    return tuple(
        FreeNumber(d.name, max(d.value - by, 5.0) if d.positive else d.value - by, d.value + by) for d in own
    )


def off(draft, names, share, seed=1):
    random = np.random.default_rng(seed)
    return draft.with_values(
        {n: draft.dimension(n).value + 20 * share * random.uniform(-10, 10) for n in names}
    )


START = off(KNOWN, NAMES, 0.1)


def poses_of(link, rows):
    """Poses (n, 4, 4) of a link on rows of the known circuit."""
    zero = CIRCUIT.point(link, (0.0, 0.0, 0.0)).position[rows]
    ends = [CIRCUIT.point(link, tuple(end)).position[rows] - zero for end in np.eye(3)]
    poses = np.broadcast_to(np.eye(4), (len(rows), 4, 4)).copy()
    poses[:, :3, :3], poses[:, :3, 3] = np.stack(ends, axis=2), zero
    return poses


ROWS = np.arange(4, 16, 2)
PLACES, INPUTS, OUTPUTS = CIRCUIT.point("Q").position[ROWS], CIRCUIT.input[ROWS], CIRCUIT.output[ROWS]
PATH = PathWant("Q", PLACES)
FUNCTION = FunctionWant(INPUTS - INPUTS[0], OUTPUTS - OUTPUTS[0], (None, None))
MUSTS = (
    InCone("ball_a", 1.0),
    InCone("ball_b", 1.2, seat=(1.0, 0.5, 0.0)),
    InRange("rocker", -0.2, 0.9),
    InBox((-300.0, -100.0, -900.0), (900.0, 900.0, 650.0), ("ball_a", "Q")),
    Apart((1, 3), 720.0),
)


@pytest.mark.parametrize(
    ("wants", "more"),
    [
        ((PATH,), {}),
        ((PATH,), {"placement": "free"}),
        (
            (PathWant("Q", PLACES, timing=INPUTS - 0.2, phase=True, weight=2.0), FUNCTION),
            {"placement": "free"},
        ),
        ((PoseWant(3, poses_of(3, ROWS), 100.0),), {"placement": "free"}),
        ((PoseWant(3, poses_of(3, ROWS), 100.0, INPUTS),), {}),
        ((FunctionWant(INPUTS, OUTPUTS),), {"musts": MUSTS}),
        ((DwellWant((0.5, 1.0)),), {"musts": MUSTS}),
        ((StraightWant("Q", (0.5, 1.5), 5000.0),), {}),
        ((PATH,), {"limits": Limits(np.radians(30.0), None, "crank-rocker")}),
        (
            (FigureWant("swing", 60.0, 50.0), FunctionWant(INPUTS, OUTPUTS)),
            {"musts": (FigureMust("swing", 70.0),)},
        ),
    ],
)
def test_slopes_of_every_want_and_must_are_those_of_differences(wants, more):
    names = NAMES if any(type(w).__name__ == "FigureWant" for w in wants) else (*NAMES, "Q.x", "Q.y", "Q.z")
    model = TaskModel(DesignTask(START, free(START, names), wants, **more))
    problem = TaskProblem(model, seeds(model, 0, 0, lambda: None)[0])
    z = problem.start
    here = problem.at(z)
    problem.take(z)
    gradient, rooms = here.residuals_by.T @ here.residuals, here.slack_by
    assert len(here.residuals) >= 6
    tried = problem.tried(z)
    assert tried.residuals == pytest.approx(here.residuals, abs=1e-12)
    assert tried.slack == pytest.approx(here.slack, abs=1e-12)
    for k in range(len(z)):
        step = np.zeros(len(z))
        step[k] = 1e-5
        up, down = problem.at(z + step), problem.at(z - step)
        assert gradient[k] == pytest.approx(
            (up.residuals @ up.residuals - down.residuals @ down.residuals) / 4e-5, abs=1e-6
        )
        assert rooms[:, k] == pytest.approx((up.slack - down.slack) / 2e-5, abs=1e-6)


def test_places_moved_by_unknowns_have_exact_slopes_for_the_greatest_residual():
    model = TaskModel(DesignTask(START, free(START, NAMES), (PATH,), placement="free", goal="minimax"))
    problem = TaskProblem(model, seeds(model, 0, 0, lambda: None)[0], minimax=True)
    z = problem.start + np.append(np.zeros(len(problem.start) - 6), [0.3, -0.2, 0.1, 0.02, 0.01, -0.03])
    here = problem.at(z)
    for k in range(len(z)):
        step = np.zeros(len(z))
        step[k] = 1e-5
        differences = (problem.at(z + step).residuals - problem.at(z - step).residuals) / 2e-5
        assert here.residuals_by[:, k] == pytest.approx(differences, abs=1e-7)


def test_a_cone_is_the_angle_between_the_cranks_axis_and_the_coupler():
    model = TaskModel(DesignTask(KNOWN, free(KNOWN, NAMES), (FunctionWant(INPUTS, OUTPUTS),)))
    loop = model.loop
    ((_, room),) = pose_slacks(loop, (InCone("ball_a", 1.0, seat=(0.0, 0.0, -1.0)),))
    q = loop.closed(loop.start, INPUTS, loop.poses(loop.start, CIRCUIT.q[ROWS]))
    a, b = (CIRCUIT.point(name).position[ROWS] for name in ("A", "B"))
    along = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
    assert room(loop.here(loop.start, q))[0][:, 0] == pytest.approx(1.0 - np.arccos(-along[:, 2]), abs=1e-12)
    # as the analysis has it, from a seat and from the rods
    bend = ball_angle(KNOWN.linkage, "ball_a", seat=(0.0, 0.0, -1.0))
    assert room(loop.here(loop.start, q))[0][:, 0] == pytest.approx(1.0 - bend.at(CIRCUIT.q[ROWS]), abs=1e-12)
    for ball in ("ball_a", "ball_b"):
        ((_, room),) = pose_slacks(loop, (InCone(ball, 1.0),))
        found = room(loop.here(loop.start, q))[0][:, 0]
        assert found == pytest.approx(1.0 - ball_angle(KNOWN.linkage, ball).at(CIRCUIT.q[ROWS]), abs=1e-12)


def test_the_nearest_places_of_two_rods_are_those_of_all():
    random = np.random.default_rng(0)
    a, b, c, d = random.standard_normal((4, 40, 3))
    s, t = nearest_shares(a, b, c, d)
    near = np.linalg.norm(a + s[:, None] * (b - a) - c - t[:, None] * (d - c), axis=1)
    shares = np.linspace(0.0, 1.0, 101)
    one = a[:, None] + shares[:, None] * (b - a)[:, None]
    other = c[:, None] + shares[:, None] * (d - c)[:, None]
    every = np.linalg.norm(one[:, :, None] - other[:, None], axis=3).min(axis=(1, 2))
    assert (near <= every + 1e-12).all()
    assert (every - near < 0.03).all()
    # parallel rods, and crossing ones
    square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])[:, None]
    s, t = nearest_shares(square[0], square[1], square[2], square[3])
    assert np.linalg.norm(s * (square[1] - square[0]) - square[2] - t * (square[3] - square[2])) == 1.0


def test_least_squares_follow_a_bent_valley_and_stop_at_bounds():
    tried, taken = [], []

    def valley(z):
        tried.append(z)
        return np.array([100 * (z[1] - z[0] ** 2), 1 - z[0], 0.0])

    def slopes(z):
        taken.append(z)
        return np.array([[-200 * z[0], 100.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1e-18]])

    wide = np.full(3, 9.0)
    ways = {"evaluations": 200, "first": 1e-3}
    found = nearest_least(valley, slopes, np.array([-1.2, 1.0, 0.5]), -wide, wide, **ways)
    assert found.z[:2] == pytest.approx([1.0, 1.0], abs=1e-12)
    # slopes cost the most, so they are asked for where a step was taken alone
    assert len(taken) < len(tried) < 200
    assert all((valley(a) ** 2).sum() > (valley(b) ** 2).sum() for a, b in pairwise(taken))
    low = nearest_least(valley, slopes, np.array([-1.2, 1.0, 0.5]), -wide, np.array([0.5, 9.0, 9.0]), **ways)
    assert low.z[:2] == pytest.approx([0.5, 0.25], abs=1e-9)


def test_least_squares_say_where_no_step_leads_on():
    def residuals(z):
        return np.array([z[0]]) if z[0] >= 1 else None

    ways = {"evaluations": 200, "first": 1e-3}
    wide = np.full(1, 9.0)
    found = nearest_least(residuals, lambda _: np.eye(1), np.array([2.0]), -wide, wide, **ways)
    assert found.end == "closed"
    assert found.z[0] == pytest.approx(1.0, abs=1e-6)
    assert nearest_least(residuals, lambda _: np.eye(1), np.zeros(1), -wide, wide, **ways) is None


CHOSEN = {"path": (0, 3, 14), "function": (6, 10, 12), "poses": (4, 10), "cusp": (3,)}


@pytest.mark.parametrize("family", CHOSEN)
def test_known_answers_are_found_to_nine_digits_and_whole(family):
    for number, made in enumerate(tasks(family)):
        if number in CHOSEN[family]:
            (best,) = designed(made.task, count=1, starts=8).designs
            assert best.met[0].greatest < FOUND * unit_of(made.task), made
            assert is_whole(best)


def test_musts_hold_to_the_stop_and_the_optimum_meets_its_conditions():
    want = FunctionWant(
        np.radians(np.linspace(0, 60, 13)), np.radians(20 * np.linspace(0, 1, 13) ** 2), (None, None)
    )
    task = DesignTask(START, free(START, ("M", "L1", "L3")), (want,), musts=(InCone("ball_a", 0.8),))
    (best,) = designed(task, count=1, starts=0).designs
    assert best.optimality < 1e-8
    # the cone stops it: without one the error is smaller
    assert best.room == pytest.approx(0.0, abs=1e-4)
    (free_of_it,) = designed(DesignTask(START, task.free, (want,)), count=1, starts=0).designs
    assert free_of_it.cost < best.cost
    assert free_of_it.optimality < 1e-8


def test_a_path_and_poses_of_a_linkage_that_may_stand_anywhere_are_found_together():
    turn = rotation_of_vector(np.array([0.4, -0.9, 1.1]))
    places = PLACES @ turn.T + [30.0, -80.0, 55.0]
    poses = poses_of(3, ROWS[1:4:2])
    poses[:, :3, :3], poses[:, :3, 3] = (
        turn @ poses[:, :3, :3],
        poses[:, :3, 3] @ turn.T + [30.0, -80.0, 55.0],
    )
    wants = (PathWant("Q", places), PoseWant(3, poses, 100.0))
    task = DesignTask(START, free(START, NAMES), wants, placement="free")
    (design,) = designed(task, count=1, starts=4).designs
    assert max(met.greatest for met in design.met) < 1e-8


def test_the_least_greatest_error_ripples_evenly():
    want = FunctionWant(
        np.radians(np.linspace(0, 60, 41)), np.radians(20 * np.linspace(0, 1, 41) ** 2), (None, None)
    )
    task = DesignTask(START, free(START, ("M", "L1", "L3")), (want,), goal="minimax")
    model = TaskModel(task)
    best = min(
        (solved(model, seed) for seed in seeds(model, 0, 0, lambda: None)[:2]), key=lambda one: one.cost
    )
    answer = checked_design(model, best)
    assert isinstance(answer, TaskDesign)
    errors = answer.candidate.claim.errors
    extremes = np.flatnonzero(np.abs(errors) > (1 - 1e-7) * np.abs(errors).max())
    assert answer.met[0].greatest == pytest.approx(best.cost, rel=1e-9)
    # five unknowns (two zeros among them) hold six errors, of turning signs
    assert len(extremes) >= 5
    assert all(errors[a] * errors[b] < 0 for a, b in pairwise(extremes))
    assert best.optimality < 1e-6


def test_a_swing_with_its_time_ratio_is_found_by_the_figures_alone():
    task = DesignTask(
        KNOWN, free(KNOWN, NAMES), (FigureWant("swing", 60.0, 50.0), FigureWant("time_ratio", 1.2))
    )
    (best,) = designed(task, count=1, starts=0).designs
    circuit = best.draft.linkage.motion(720).circuits[best.candidate.circuit]
    assert math.degrees(circuit.swing) == pytest.approx(60.0, abs=1e-8)
    assert circuit.time_ratio == pytest.approx(1.2, abs=1e-9)


def as_solution(model, rows, circuits):
    """The known linkage itself as a solution at rows of circuits."""
    q = np.stack([circuit.q[row] for row, circuit in zip(rows, circuits, strict=True)])
    inputs = np.array([circuit.input[row] for row, circuit in zip(rows, circuits, strict=True)])
    values = model.loop.start
    seed = TaskSeed(values, (inputs,), model.loop.poses(values, q), q[0], 0.0)
    return Solved(seed, (inputs,), 0.0, 0.0, math.inf)


@pytest.mark.parametrize(
    ("rows", "others", "fault"),
    [([1, 4, 9, 13], (), ""), ([1, 9, 4, 13], (), "order"), ([1, 4, 9, 13], (2, 3), "circuit")],
)
def test_a_defective_design_is_refused_however_well_it_fits(rows, others, fault):
    one, other = KNOWN.linkage.motion(36).circuits[:2]
    circuits = [other if k in others else one for k in range(4)]
    places = np.stack([c.point("Q").position[row] for row, c in zip(rows, circuits, strict=True)])
    model = TaskModel(DesignTask(KNOWN, free(KNOWN, NAMES), (PathWant("Q", places),)))
    answer = checked_design(model, as_solution(model, rows, circuits))
    if fault:
        assert isinstance(answer, Refusal)
        assert answer.fault == fault
    else:
        assert isinstance(answer, TaskDesign)
        assert answer.met[0].greatest < 1e-9


def test_places_with_a_dead_centre_between_are_refused():
    # a long crank rocks between two dead centres and has two passes
    draft = Draft.of_linkage(sb.rssr(M=700, N=700, L1=550, L3=250, D=0)).holding()
    draft = draft.with_point("Q", 3, (40.0, 60.0, 0.0))
    circuit = next(c for c in draft.linkage.motion(48).circuits if c.input_range is not None)
    passes = [np.flatnonzero((circuit.branch == b) & (circuit.status == "ok")) for b in (0, 1)]

    def answer(rows, *, closed=False):
        places = circuit.point("Q").position[rows]
        model = TaskModel(DesignTask(draft, free(draft, NAMES), (PathWant("Q", places, closed),)))
        return checked_design(model, as_solution(model, rows, [circuit] * len(rows)))

    over = answer(np.concatenate([passes[0][-6:-2:2], passes[1][2:6:2]]))
    assert isinstance(over, Refusal)
    assert over.fault == "dead centre"
    along = passes[0][2:10:2]
    assert isinstance(answer(along), TaskDesign)
    # a closed path needs the way back, too
    back = answer(along, closed=True)
    assert isinstance(back, Refusal)
    assert "between its last point and its first" in back.detail


def test_a_missed_must_is_refused_by_its_name():
    places = CIRCUIT.point("Q").position[[1, 4, 9, 13]]
    for must, fault in (
        (InCone("ball_a", 0.1), "cone"),
        (InRange("rocker", 0.4, 0.6), "range"),
        (InBox((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0), ("Q",)), "box"),
        (Apart((1, 3), 5000.0), "distance"),
        (FigureMust("swing", 100.0), "figure"),
    ):
        model = TaskModel(DesignTask(KNOWN, free(KNOWN, NAMES), (PathWant("Q", places),), musts=(must,)))
        answer = checked_design(model, as_solution(model, [1, 4, 9, 13], [CIRCUIT] * 4))
        assert isinstance(answer, Refusal)
        assert answer.fault == fault


WAVED = FunctionWant(
    CIRCUIT.input[4:16], CIRCUIT.output[4:16] + math.radians(2) * np.sin(4 * CIRCUIT.input[4:16])
)


@pytest.mark.parametrize(
    "must",
    [Apart((1, 3), 892.0), InBox((-763.0,) * 3, (763.0,) * 3, ("ball_b", "Q"))],
    ids=["distance", "box"],
)
def test_the_least_greatest_error_is_found_up_to_a_distance_or_the_wall_of_a_box(must):
    bounds = free(START, ("L1", "M", "N"), 60.0)

    def best(*musts):
        model = TaskModel(DesignTask(START, bounds, (WAVED,), musts, goal="minimax"))
        return solved(model, seeds(model, 0, 0, lambda: None)[0])

    alone, held = best(), best(must)
    # the must decides: nothing of its slack is left
    assert abs(held.slack) < 1e-9
    assert held.optimality < 1e-9
    assert held.cost > 1.01 * alone.cost


def crossing(crank, rocker, inputs):
    """The rocker's angle of a planar four-bar, coupler 100 and ground 90, by the law of cosines."""
    x, y = 90 + crank * np.cos(inputs), crank * np.sin(inputs)
    far = np.hypot(x, y)
    return np.arctan2(y, x) + np.arccos((far**2 + rocker**2 - 100**2) / (2 * far * rocker))


@pytest.mark.parametrize(
    ("must", "crank"),
    [
        # over the ground the coupler is lowest at the crank's pin at 150 deg: half the crank
        (Apart((2, 4), 22.0), 44.0),
        # the pin is highest at 90 deg: the crank itself
        (InBox((-1.0, -200.0, -200.0), (1.0, 200.0, 38.0), ("theta_2",)), 38.0),
    ],
    ids=["distance", "box"],
)
def test_the_least_greatest_error_up_to_a_must_is_that_of_the_law_of_cosines(must, crank):
    inputs = np.radians(np.arange(60.0, 151.0, 15.0))
    readings = crossing(40.0, 80.0, inputs)
    free_numbers = (FreeNumber("length_1", 30, 60), FreeNumber("length_3", 60, 100))
    want = FunctionWant(inputs, -readings, (0.0, None))
    start = Draft.of_linkage(sb.load("planar_4r"))
    (design,) = designed(
        DesignTask(start, free_numbers, (want,), (must,), goal="minimax"), count=1, starts=0
    ).designs
    # the crank reaches its must, and of the rocker's lengths the least greatest error is left
    every = np.linspace(60, 100, 400001)[:, None]
    errors = np.ptp(crossing(crank, every, inputs) - readings, axis=1) / 2
    assert design.values == pytest.approx([crank, every[errors.argmin(), 0]], abs=2e-4)
    assert errors.min() - 1e-6 < design.met[0].greatest <= errors.min() + 1e-12
    assert design.room == pytest.approx(0.0, abs=1e-9)
    assert design.optimality < 1e-11


def test_a_design_that_ends_where_its_motion_type_changes_says_so():
    values = {"length_1": 64.0, "length_2": 61.0, "length_3": 87.1}
    start = Draft.of_linkage(sb.load("planar_4r")).with_values(values)
    bounds = [FreeNumber(name, 0.5 * x, 1.6 * x) for name, x in zip(values, (40, 100, 80), strict=True)]
    task = DesignTask(start, tuple(bounds), (DwellWant((2.0, 3.0)), FigureWant("swing", 90.0, 60.0)))
    (design,) = designed(task, count=1, starts=0).designs
    crank, coupler, rocker = design.values
    # Grashof's limit with the ground of 90: beyond it the swing jumps
    assert coupler + 90 - crank - rocker == pytest.approx(0.0, abs=1e-3)
    assert design.optimality > 1e-3
    assert design.solution.ended == "edge"
    found = TaskDesigns(DesignsFound((design,), task=task, starts=1), "dwell", "", 0, 0)
    printed = Console(file=StringIO(), width=100, color_system=None)
    printed.print(task_report(task, 1, "").text(found))
    assert "KKT residual of design 1: ends at an edge" in printed.file.getvalue()


@pytest.mark.parametrize("least", [880.0, pytest.param(900.0, marks=pytest.mark.proof)])
def test_a_path_at_any_inputs_keeps_links_apart_between_its_places_and_ends_at_an_optimum(least):
    # fewer distances are equal than there are unknowns, and rods come nearest between two places
    task = DesignTask(
        START, free(START, ("L1", "M", "N"), 60.0), (PATH,), (Apart((1, 3), least),), goal="minimax"
    )
    (design,) = designed(task, count=1, starts=0).designs
    assert design.optimality < 1e-10
    assert abs(design.room) < 1e-6


@pytest.mark.parametrize("timing", [None, INPUTS[2:3]])
def test_a_single_pose_is_reached_with_its_musts(timing):
    want = PoseWant(3, poses_of(3, ROWS[2:3]), 100.0, timing)
    task = DesignTask(START, free(START, NAMES), (want,), (InCone("ball_a", 3.0),))
    (design,) = designed(task, count=1, starts=0).designs
    assert design.met[0].greatest < 1e-9
    assert design.room > 0


@pytest.mark.parametrize("want", [FunctionWant(INPUTS[::-1], OUTPUTS[::-1]), PathWant("Q", PLACES[::-1])])
def test_what_is_wanted_backwards_is_found_as_well(want):
    (design,) = designed(DesignTask(START, free(START, NAMES), (want,)), count=1, starts=0).designs
    assert design.met[0].greatest < 1e-9


def test_a_closed_path_of_two_turns_of_the_input_is_followed_over_both():
    known = Draft.of_linkage(sb.load("myard_5r")).with_point("P", 2, (10.0, 20.0, 30.0))
    (circuit,) = known.linkage.motion(36).circuits
    assert circuit.turns == 2
    want = PathWant("P", circuit.point("P").position[::6], closed=True)
    task = DesignTask(known, (FreeNumber("P.u", 5.0, 15.0),), (want,), (InRange("theta_2", -4.0, 4.0),))
    (design,) = designed(task, count=1, starts=0).designs
    along = DesignAlong(task, design)
    assert np.ptp(along.ways[0].inputs) == pytest.approx(4 * math.pi, rel=0.01)
    steps = np.linalg.norm(np.diff(along.curve(0).path, axis=0), axis=1)
    # to the place from which it began
    assert np.linalg.norm(along.curve(0).path[-1] - want.places[0]) < 2 * steps.max()


def test_a_bound_of_1e_6_is_checked_to_its_digits():
    model = TaskModel(DesignTask(START, free(START, NAMES), (FUNCTION,), (Most(0, 1e-6),)))
    solution = solved(model, seeds(model, 0, 0, lambda: None)[0])
    assert isinstance(checked_design(model, solution), TaskDesign)
    off = 5e-5 * np.array([1, -1, 1, -1, 1, -1])
    other = FunctionWant(FUNCTION.input, FUNCTION.output + off, (None, None))
    model = TaskModel(DesignTask(START, free(START, NAMES), (other,), (Most(0, 1e-6),)))
    refusal = checked_design(model, solution)
    assert isinstance(refusal, Refusal)
    assert refusal.detail == "the greatest error is 0.002865 deg, at most 5.73e-05 deg is asked"


def test_what_shall_be_great_is_better_the_greater_it_is_below_zero_too():
    want, steps = FigureWant("clearance", "great", 10.0), np.array([-50.0, -1.0, 0.0, 9.9, 10.0, 10.1, 80.0])
    left, by = zip(*(want.residual(x, np.ones(1)) for x in steps), strict=True)
    assert (np.diff(left) < 0).all()
    assert np.concatenate(by).max() < 0
    # without a step or a corner at the unit
    assert left[4] == pytest.approx((left[3] + left[5]) / 2, abs=1e-4)


def test_a_bound_of_a_path_is_one_of_its_distances():
    places = PLACES + 3 * np.sign(np.random.default_rng(0).normal(size=PLACES.shape))
    want = PathWant("Q", places, timing=INPUTS)
    bounds = free(START, ("L1", "M", "N", "Q.x", "Q.y", "Q.z"), 60.0)

    def best(*musts):
        return designed(DesignTask(START, bounds, (want,), musts), count=1, starts=0).designs[0]

    assert best().met[0].greatest > 7
    most = 6.0 / float(np.ptp(places, axis=0).max())
    assert best(Most(0, most)).met[0].greatest == pytest.approx(6.0, abs=1e-6)
