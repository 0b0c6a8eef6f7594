"""What is on view in the studio: every mode of an input, and a motion that turns back where the linkage does.

Source: `assembly_modes` of the linkage, which knows nothing of circuits, and the loop's product in `reference_loops`.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy.reference_loops import Loop
from gallery_sample import sampled
from sevenbar.description.draft import Draft
from sevenbar.description.forms import from_description
from sevenbar.description.gallery import loops, text
from sevenbar.drawing.skeleton import places_of
from sevenbar.drawing.view import upright
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.poses import along, at_row
from sevenbar.studio.panels.points import _speeds
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.view import View, modes_at, views_of
from studio_sessions import DOUBLE_ROCKER, distance, drawn, opened, state

# --- from where it is seen


def hung(gravity):
    """A four-bar in the plane of x and y, with a weight."""
    joints = [
        {"kind": "R", "at": [x, y, 0], "axis": [0, 0, 1]} for x, y in ((0, 0), (0, 40), (80, 80), (90, 0))
    ]
    return from_description({"format": 1, "joint": joints, "forces": {"gravity": gravity}})


@pytest.mark.parametrize(
    ("gravity", "right", "up"),
    [
        ([0, 0, 0], [1, 0, 0], [0, 1, 0]),
        ([0, -9.81, 0], [1, 0, 0], [0, 1, 0]),
        ([0, 9.81, 0], [-1, 0, 0], [0, -1, 0]),
        ([-9.81, 0, 0], [0, -1, 0], [1, 0, 0]),
        # square to the plane, up to rounding: it says nothing of the page
        ([1e-16, 0, -9.81], [1, 0, 0], [0, 1, 0]),
        ([0, 0, -9.81], [1, 0, 0], [0, 1, 0]),
        # a machine that leans
        ([-3, -4, -5], [0.8, -0.6, 0], [0.6, 0.8, 0]),
    ],
)
def test_a_planar_linkage_is_seen_from_above_with_gravity_down(gravity, right, up) -> None:
    screen = upright(hung(gravity))
    assert screen is not None
    assert screen == pytest.approx(np.array([right, up]), abs=1e-12)
    assert np.cross(*screen) == pytest.approx([0, 0, 1], abs=1e-12)


def test_the_output_of_the_drawn_pose_reads_zero_whatever_the_pin() -> None:
    """The drawn pose may lie a turn further on along its circuit."""
    for x in (40.0, 60.0, 95.0):
        linkage = hung([0, 0, 0])
        raw = {**linkage.description, "joint": [dict(joint) for joint in linkage.description["joint"]]}
        raw["joint"][1]["at"] = [x, 0, 0]
        views = views_of(from_description(raw).motion())
        (view,) = [view for view in views if view.home is not None]
        column = view.circuit.output_column
        shown = at_row(along(view.linkage, view.circuit, column), view.home) + view.whole_turns(column)
        assert shown == pytest.approx(0.0, abs=1e-6)


# --- modes


@pytest.mark.parametrize("name", [name for name in sampled() if name.values != ("screw_drill",)])
def test_the_modes_of_every_input_are_the_assembly_modes(name: str) -> None:
    linkage = sb.load(name)
    rng = np.random.default_rng(3)
    for column in linkage.drivable():
        index = linkage.columns.index(column)
        motion = linkage.motion(360, input=column)
        ends = [end for circuit in motion for end in (circuit.input.min(), circuit.input.max())]
        turn = linkage.turns(index)
        gap = 1e-6 * (1.0 if turn else motion.circuits[0].size)
        worst = []
        for value in rng.uniform(min(ends), max(ends), 9):
            # a whole turn more is the same
            asked = value + 2 * np.pi * int(rng.integers(-3, 4)) if turn else value
            met = modes_at(views_of(motion), asked)
            modes = linkage.assembly_modes(value, input=column)
            assert len(met) == len(modes), (column, value)
            left = list(modes.q)
            for view, row in met:
                q = view.joints(row)
                apart = [distance(motion, q, other) for other in left]
                worst.append(min(apart))
                left.pop(int(np.argmin(apart)))
                off = q[index] - value
                assert abs(np.remainder(off + np.pi, 2 * np.pi) - np.pi if turn else off) < gap
        assert np.median(worst or [0]) < 1e-3, column
        # rows lie far apart where a circuit hardly moves its input
        assert max(worst, default=0) < 0.1, column


@pytest.mark.parametrize("name", [name for name in loops() if name != "screw_drill"])
def test_a_sample_is_met_exactly_and_once(name: str) -> None:
    motion = sb.load(name).motion()
    for circuit in motion:
        view = View(motion, circuit)
        for row in {0, 1, 7, len(circuit.input) // 2, len(circuit.input) - 1}:
            mine = [
                at
                for other, at in modes_at(views_of(motion), float(circuit.input[row]))
                if other.circuit is circuit
            ]
            assert [at for at in mine if abs(at - row) < 1e-6] == [row]
            np.testing.assert_array_equal(view.joints(float(row)), circuit.q[row])


@pytest.mark.parametrize(
    ("name", "ends"),
    [("bricard_trihedral", None), ("rssr", ("rocker", "crank")), ("rssp", ("slider", "crank")), ("rccc", ("slide_3", "crank"))],
)  # fmt: skip
def test_at_a_dead_centre_two_modes_are_one(name: str, ends: tuple[str, str] | None) -> None:
    session = opened(name)
    if ends:
        session.drive(*ends)
    view = session.view
    assert view is not None
    for row in np.flatnonzero(view.circuit.status == "dead-centre"):
        limit = float(view.circuit.input[row])
        own = [at for at in view.rows_at(limit) if abs(at - row) < 1]
        assert own == [row]
        session.seek(float(row))
        modes = session.modes()
        assert modes[session.mode(modes)] == (view, row)


@pytest.mark.parametrize(
    "name", ["rssr", "seven_r", "myard_5r", "bricard_trihedral", "rscr", "rssp", "six_bar"]
)
def test_the_next_mode_visits_each_once_and_comes_back(name: str) -> None:
    session = opened(name)
    for row in (0.0, 20.0, 100.25, 33.3):
        assert session.view is not None
        session.choose(0)
        session.seek(row)
        view, row = session.view, session.row
        count = len(session.modes())
        value = view.input_at(row)
        assert count == max(1, len(modes_at(views_of(view.motion), value)))
        seen = []
        for _ in range(count):
            session.next_mode()
            seen.append((session.view.circuit.index, round(session.row, 6)))
            assert np.remainder(session.view.input_at(session.row) - value + 1, 2 * np.pi) == pytest.approx(
                1, abs=1e-7
            )
        assert len(set(seen)) == count
        assert session.view.circuit is view.circuit
        last = len(view.path.rows) - 1
        gap = abs(session.row - row)
        assert min(gap, abs(last - gap)) < 1e-6


def test_the_modes_of_a_circuit_that_turns_twice_are_both_its_own() -> None:
    session = opened("myard_5r")
    session.seek(10.5)
    assert [row for _, row in session.modes()] == pytest.approx([10.5, 370.5])
    session.next_mode()
    assert session.row == pytest.approx(370.5)


def test_choosing_a_circuit_keeps_the_input_where_it_gets_there() -> None:
    session = opened("rscr")
    session.seek(40.0)
    assert session.view is not None
    value = session.view.input_at(40.0)
    for index in (1, 2, 0):
        session.choose(index)
        assert session.view.circuit.index == index
        assert np.remainder(session.view.input_at(session.row) - value + 1, 2 * np.pi) == pytest.approx(1)
    # circuit 1 does not get everywhere
    session.seek_input(math.radians(250))
    session.choose(1)
    assert (session.view.circuit.index, session.row) == (1, 0.0)


@pytest.mark.parametrize("name", loops())
def test_places_worked_out_from_joint_values_are_those_of_the_frame(name: str) -> None:
    session = opened(name)
    session.add_point("far", 1, (1.0, 2.0, 3.0))
    assert session.view is not None
    for circuit in session.view.motion:
        view = View(session.view.motion, circuit)
        rows = np.array([0, 5, len(circuit.input) // 3])
        known = ~np.isnan(circuit.q[rows]).any(axis=1)
        got = places_of(circuit.q[rows[known]], view.frame)
        want = np.stack([view.frame.pose(float(row)) for row in rows[known]])
        np.testing.assert_allclose(got, want, atol=1e-9 * view.frame.span)


# --- moving

ROCKING: list[tuple[str, tuple[str, str] | None]] = [
    (DOUBLE_ROCKER, None),
    (text("bricard_trihedral"), None),
    (text("rssr"), ("rocker", "crank")),
    (text("rssp"), ("slider", "crank")),
    (text("seven_r"), ("theta_3", "theta_1")),
    (text("rccc"), ("slide_3", "crank")),
]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("content", "ends"), ROCKING)
def test_a_motion_turns_back_at_its_dead_centres_and_returns_to_its_start(
    content: str, ends: tuple[str, str] | None, sign: float
) -> None:
    session = Session(content, "x")
    if ends:
        session.drive(*ends)
    (speed,) = [d for d in session.draft.dimensions if d.label == "speed"]
    session.change(speed.place, session.draft.written(speed, sign * abs(speed.value)))
    view = session.view
    assert view is not None
    assert view.circuit.input_range is not None
    assert math.copysign(1, view.motion.speed) == sign
    low, high = view.circuit.input_range
    step = view.period / 3000
    begun = view.joints(session.row)
    inputs, poses = [], []
    for _ in range(3001):
        inputs.append(view.input_at(session.row))
        poses.append(view.joints(session.row))
        session.advance(step)
    inputs = np.array(inputs)
    slack = 1e-9 * (high - low)
    assert low - slack <= inputs.min() < low + 0.02 * (high - low)
    assert high - 0.02 * (high - low) < inputs.max() <= high + slack
    # the input runs evenly, and turns as often as there are dead centres
    rates = np.diff(inputs) / step
    steady = np.isclose(np.abs(rates), abs(view.motion.speed), rtol=1e-6)
    limits = sum(d.kind == "input" for d in view.circuit.dead_centres)
    turns = np.count_nonzero(np.diff(np.sign(rates[steady])))
    assert turns in (limits - 1, limits)
    assert np.count_nonzero(~steady) <= limits
    # nothing jumps: what moves fast does so beside a dead centre, as a root
    assert max(distance(view.motion, a, b) for a, b in pairwise(poses)) < 0.3
    assert distance(view.motion, poses[-1], begun) < 0.3
    # exactly a cycle
    session.seek(3.0)
    session.advance(view.period)
    assert session.row == pytest.approx(3.0, abs=1e-6)
    session.advance(-view.period)
    assert session.row == pytest.approx(3.0, abs=1e-6)


@pytest.mark.parametrize(
    ("name", "speed"),
    [
        (name, speed)
        for name in ("rssr", "seven_r", "myard_5r", "rscr")
        for speed in ("3.0 rad/s", "-3.0 rad/s")
    ],
)
def test_a_crank_runs_on_over_the_turn(name: str, speed: str) -> None:
    session = opened(name)
    session.change(("drive", "speed"), speed)
    view = session.view
    assert view is not None
    assert view.period == pytest.approx(view.circuit.turns * 2 * np.pi / 3, rel=1e-12)
    session.seek(350.0)
    joints = []
    for _ in range(60):
        joints.append(view.joints(session.row))
        session.advance(0.01)
    inputs = np.array(joints)[:, view.circuit.input_column]
    moved = np.remainder(np.diff(inputs) + np.pi, 2 * np.pi) - np.pi
    np.testing.assert_allclose(moved, 0.01 * float(speed.split()[0]), rtol=1e-9)
    assert max(distance(view.motion, a, b) for a, b in pairwise(joints)) < 0.2


@pytest.mark.parametrize(("content", "ends"), [*ROCKING, (text("rssr"), None), (text("rscr"), None)])
def test_times_rows_and_inputs_lead_to_each_other(content: str, ends: tuple[str, str] | None) -> None:
    session = Session(content, "x")
    if ends:
        session.drive(*ends)
    assert session.view is not None
    for circuit in session.view.motion:
        view = View(session.view.motion, circuit)
        last = len(view.path.rows) - 1
        for row in [
            *np.random.default_rng(0).uniform(0, last, 30),
            0.0,
            1.0,
            last - 1.0,
            0.001,
            last - 0.001,
        ]:
            time = view.time_at(row)
            assert view.row_at(time) == pytest.approx(row, abs=1e-5)
            assert (
                min(abs(at - row) for at in [*view.rows_at(view.input_at(row)), 1e9]) < 1e-4
                or last - row < 1e-4
            )
            low = int(row)
            part = view.path.input[low : low + 2]
            assert part.min() - 1e-12 <= view.input_at(row) <= part.max() + 1e-12
            assert view.path.time[low] - 1e-12 <= time <= view.path.time[min(low + 1, last)] + 1e-12
        assert (view.time_at(0.0), view.time_at(float(last))) == (0.0, view.period)


def test_between_two_samples_beside_a_dead_centre_the_loop_all_but_closes() -> None:
    """On the straight line it would be open by degrees: there the joints move as a root."""
    for content, ends in ROCKING[:4]:
        session = Session(content, "x")
        if ends:
            session.drive(*ends)
        view = session.view
        assert view is not None
        column = view.circuit.input_column
        for row in (0.25, 0.5, 0.75, len(view.path.rows) - 1.5):
            q = view.joints(row)[None]
            true = Loop.of(view.linkage).polished(q, column)[0]
            assert distance(view.motion, q[0], true) < 0.02


def test_steps_go_from_sample_to_sample_and_over_the_end() -> None:
    session = opened("rssr")
    session.seek(10.25)
    for rows, place in (
        (1, 11),
        (1, 12),
        (-1, 11),
        (-10, 1),
        (-1, 0),
        (-1, 359),
        (1, 0),
        (10, 10),
        (-20, 350),
    ):
        session.step(rows)
        assert session.row == place
    session.seek(10.75)
    session.step(-1)
    assert session.row == 10
    for wild, end in ((-5.0, 0.0), (1e9, 360.0), (360.0, 360.0)):
        session.seek(wild)
        assert session.row == end
    session.step(1)
    assert session.row == 1


def test_an_open_motion_ends_at_its_ends() -> None:
    """A pin that slides along a line at a distance: its slide goes with the tangent of the crank's angle, without end."""
    joints = [("R", (0, 0, 0), (0, 0, 1)), ("P", (0, 0, 0), (1, 0, 0)), ("R", (100, 0, 0), (0, 0, 1))]
    session = Session(drawn(*joints, ("P", (100, 0, 0), (0, 1, 0))), "tangent")
    view = session.view
    assert view is not None
    assert not view.circuit.closed
    last = len(view.path.rows) - 1
    session.seek(1.0)
    session.step(-10)
    assert session.row == 0
    session.step(1000)
    assert session.row == last
    rows = []
    for _ in range(2 * last + 20):
        rows.append(session.row)
        session.advance(view.period / last)
    # there and back, without a jump
    assert (min(rows), max(rows)) == (0.0, float(last))
    assert np.abs(np.diff(rows)).max() < 1.001
    ends = session.modes()
    session.seek(0.0)
    assert session.modes()[session.mode(session.modes())][1] == 0.0
    session.seek(float(last))
    assert session.modes()[session.mode(session.modes())][1] == last
    assert ends


def test_an_input_is_sought_on_the_pass_on_view() -> None:
    session = opened("rssr")
    for degrees in (30.0, 390.0, -330.0, 0.0, 360.0, 359.9999999999, 720.0):
        session.seek_input(math.radians(degrees))
        assert session.view is not None
        turned = math.degrees(session.view.input_at(session.row)) - degrees
        assert (turned + 180) % 360 == pytest.approx(180, abs=1e-7)
    session.drive("rocker", "crank")
    view = session.view
    low, high = view.circuit.input_range or (0, 0)
    middle = (low + high) / 2
    first, second = view.passes
    for part in (first, second):
        session.seek(part.start + 3.5)
        session.seek_input(middle)
        assert part.start < session.row < part.last


@pytest.mark.parametrize(
    ("name", "ends", "unit", "size"),
    [("rssr", ("rocker", "crank"), "deg", math.degrees(1)), ("rssp", ("slider", "crank"), "mm", 1.0)],
)
def test_an_input_out_of_reach_is_told_with_a_range_that_is_in_reach(
    name: str, ends: tuple[str, str], unit: str, size: float
) -> None:
    session = opened(name)
    session.drive(*ends)
    view = session.view
    assert view is not None
    low, high = view.circuit.input_range or (0, 0)
    session.seek(5.5)
    for value in (low - 0.1, high + 0.1):
        before = state(session)
        with pytest.raises(
            RequestError, match=rf"is out of reach of circuit {view.circuit.index}; give "
        ) as caught:
            session.seek_input(value)
        assert state(session) == before
        told = str(caught.value).partition("give ")[2].removesuffix(f" {unit}").split(" to ")
        assert [float(end) for end in told] == pytest.approx([low * size, high * size], rel=1e-5)
        for end in told:
            session.seek_input(float(end) / size)
        session.seek(5.5)


@pytest.mark.parametrize("share", np.linspace(0.6e-9, 1.4e-9, 9))
def test_a_corner_at_the_edge_of_rounding_is_a_place_of_one_pose_as_of_all(share: float) -> None:
    draft = Draft.of(text("seven_r"), "seven_r")
    length, offset = (
        next(d for d in draft.dimensions if d.name == name) for name in ("length_1", "offset_1")
    )
    motion = draft.with_value(offset.place, share * length.value).linkage.motion(60)
    frame = views_of(motion)[0].frame
    for row in range(0, 60, 7):
        assert places_of(motion.circuits[0].q[row : row + 1], frame).shape[1:] == frame.places.shape[1:]


@pytest.mark.parametrize(("link", "held"), [(1, False), (2, True), (3, False)])
def test_a_point_of_an_idle_link_is_shown_as_one_that_a_convention_holds(link: int, held: bool) -> None:
    session = opened("rssr")
    session.add_point("P", link, (1.0, 2.0, 3.0))
    assert session.view is not None
    line = _speeds(session.view, len(session.view.linkage.points) - 1)
    assert f"P on link {link}: fastest" in line
    assert ("held by convention" in line) is held
