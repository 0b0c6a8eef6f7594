"""The state behind a tab: what a change does to it, and what a refusal leaves alone."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sevenbar.description.gallery import text
from sevenbar.errors import DescriptionError, RequestError, SevenbarError
from sevenbar.studio.state import session as session_module
from sevenbar.studio.state.session import Session
from studio_sessions import drawn, opened, state

L1 = ("rssr", "L1")


@pytest.fixture(autouse=True)
def clock(monkeypatch: pytest.MonkeyPatch) -> Callable[[float], None]:
    """Time stands still but for what a test lets go by."""
    now = [100.0]

    class Clock:
        @staticmethod
        def monotonic() -> float:
            return now[0]

    monkeypatch.setattr(session_module, "time", Clock)

    def pass_by(seconds: float) -> None:
        now[0] += seconds

    return pass_by


def values(session: Session) -> dict[str, float]:
    return {d.key: d.value for d in session.draft.dimensions}


# --- history


def test_undo_redo_and_reset_go_through_every_step(clock: Callable[[float], None]) -> None:
    session = opened("rssr")
    first = session.draft
    for value in (260.0, 270.0, 280.0):
        session.change(L1, value)
        clock(5.0)
    assert len(session.past) == 3
    for value in (270.0, 260.0, 250.0):
        session.undo()
        assert values(session)["rssr.L1"] == value
        assert session.view is not None
        assert session.view.linkage.lengths[0] == value
    session.undo()
    assert session.draft is first
    for value in (260.0, 270.0, 280.0, 280.0):
        session.redo()
        assert values(session)["rssr.L1"] == value
    session.reset()
    assert session.draft.raw == first.raw
    session.reset()
    session.undo()
    assert values(session)["rssr.L1"] == 280.0


def test_a_drag_is_one_step_and_two_dimensions_are_two(clock: Callable[[float], None]) -> None:
    session = opened("rssr")
    for value in np.linspace(250, 300, 30):
        session.change(L1, float(value))
        clock(0.05)
    assert len(session.past) == 1
    session.change(("rssr", "L3"), 560.0)
    session.change(L1, 301.0)
    assert len(session.past) == 3
    clock(5.0)
    session.change(L1, 302.0)
    assert len(session.past) == 4
    session.undo()
    assert values(session)["rssr.L1"] == 301.0
    # what was undone does not go on
    session.change(L1, 303.0)
    assert len(session.past) == 4
    assert not session.future


def test_a_refused_value_within_a_drag_does_not_break_it() -> None:
    session = opened("rssr")
    session.change(L1, 251.0)
    with pytest.raises(DescriptionError):
        session.change(L1, 0.0)
    session.change(L1, 252.0)
    assert len(session.past) == 1
    session.undo()
    assert values(session)["rssr.L1"] == 250.0


def test_no_more_steps_are_kept_than_can_be_undone(
    clock: Callable[[float], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(session_module, "MOST_STEPS", 5)
    session = opened("rssr")
    for i in range(9):
        session.change(L1, 251.0 + i)
        clock(5.0)
    for _ in range(9):
        session.undo()
    assert values(session)["rssr.L1"] == 254.0


# --- refusals

REFUSED = [
    ("rssr", L1, 0.0, "rssr.L1: 0.0 is not a length"),
    ("rssr", L1, -1.0, "rssr.L1: -1.0 is not a length"),
    ("rssr", L1, math.nan, "rssr.L1: nan is not a finite number"),
    ("rssr", L1, 1e300, "rssr.L1: 1e+300 is out of range"),
    ("rssr", L1, 1e-300, "rssr.L1: 1e-300 is out of range"),
    ("rssr", ("rssr", "M"), 1e300, "rssr.M: 1e+300 is out of range"),
    ("rssr", ("drive", "speed"), "0.0 rad/s", "drive.speed: '0.0 rad/s' moves nothing"),
    ("rssr", ("drive", "speed"), "nan rad/s", "drive.speed"),
    ("five_bar", ("joint", 0, "axis"), [0.0, 0.0, 0.0], "joint[1].axis: [0.0, 0.0, 0.0] has no direction"),
    ("rsur", ("joint", 2, "axes", 0), [0, 0, 0], "joint[3].axes[1]: [0, 0, 0] has no direction"),
    ("seven_r", ("link", 3, "twist"), math.inf, "link[4].twist: inf is not a finite number"),
    ("seven_r", ("link", 3, "length"), "abc", "link[4].length: 'abc': no 'abc' is known"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "place", "value", "words"), REFUSED)
def test_a_refused_value_leaves_everything_as_it_was(
    name: str, place: tuple[str | int, ...], value: object, words: str
) -> None:
    session = opened(name)
    session.change(session.draft.dimensions[0].place, session.draft.dimensions[0].value * 1.01)
    session.undo()
    session.seek(12.25)
    before = state(session)
    with pytest.raises(DescriptionError) as caught:
        session.change(place, value)
    assert words in str(caught.value)
    assert state(session) == before


@pytest.mark.parametrize("bad", ["", "format = 1", "not toml", "format = 1\n[rssr]\nM = 700\n", "x" * 9000])
def test_a_text_that_describes_nothing_changes_nothing(bad: str) -> None:
    session = opened("rssr")
    session.change(L1, 260.0)
    session.seek(40.5)
    before = state(session)
    with pytest.raises(DescriptionError):
        session.open(bad, "bad")
    assert state(session) == before


def test_a_text_that_is_opened_is_one_more_step() -> None:
    session = opened("rssr")
    session.change(L1, 260.0)
    session.seek(40.5)
    session.forwards = False
    shaped = session.draft
    session.open(text("seven_r"), "seven_r")
    assert session.view is not None
    assert (session.view.linkage.kind, session.row, session.forwards) == ("RRRRRRR", 0.0, True)
    session.reset()
    assert session.draft.source == "seven_r", "there is nothing to reset"
    session.undo()
    assert session.draft is shaped, "what was shaped before is not lost"
    assert session.view is not None
    assert session.view.linkage is shaped.linkage
    session.reset()
    assert values(session)["rssr.L1"] == 250.0
    session.undo()
    session.undo()
    assert not session.past


# --- descriptions without a motion


def test_what_cannot_be_assembled_keeps_the_last_view_and_says_why() -> None:
    session = opened("rssr")
    session.seek(40.5)
    shown = session.view
    session.change(("rssr", "L2"), 1.0)
    assert "cannot-assemble: no input closes the loop" in session.problem
    assert (session.view, session.row, session.motion) == (shown, 40.5, session.motion)
    assert session.motion is not None
    assert not session.motion.circuits
    session.undo()
    assert session.problem == ""
    assert session.view is not None
    assert session.row == pytest.approx(40.5, abs=1e-9)
    assert session.view.linkage is session.draft.linkage


def test_a_loop_that_gains_freedoms_keeps_the_last_view() -> None:
    session = opened("sarrus")
    moved, reasons = session.view, []
    # three axes, one after the other, are made parallel to the first three: a plane loop of three freedoms
    for joint in (3, 4, 5):
        session.change(("joint", joint, "axis"), [1.0, 0.0, 0.0])
        assert session.problem or session.view is not moved
        moved = session.view
        reasons.append(session.problem)
    assert "freedoms" in reasons[-1]
    assert session.view is moved
    for _ in range(3):
        session.undo()
    assert session.problem == ""
    assert session.view is not None
    assert session.view.linkage is session.draft.linkage
    assert session.draft.raw == session.draft.as_opened().raw


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (drawn(*(("R", at, (0, 0, 1)) for at in [(0, 0, 0), (10, 0, 0), (20, 5, 0), (10, 20, 0), (0, 12, 0)])), "two-inputs"),
        (drawn(("R", (0, 0, 0), (0, 0, 1)), ("R", (10, 0, 0), (0, 0, 1)), ("R", (20, 5, 0), (0, 1, 1)), ("R", (10, 20, 0), (1, 0, 1)), ("R", (0, 12, 0), (0, 0, 1))), "rigid"),
        (drawn(("R", (0, 0, 0), (0, 0, 1)), ("S", (1, 0, 0), None), ("R", (2, 0.5, 0.2), (0.3, 1, 0.2)), ("S", (1, 2, 0.7), None)).replace("'R'\nat = [2", "'H'\npitch = 1\nat = [2"), "moves no other link"),
        (drawn(*(("R", (i % 3, i // 3, i * i / 9), (i % 2, 1, i)) for i in range(9))), "freedoms"),
        ("format = 1\n[rssr]\nM = 700\nN = 700\nL1 = 250\nL2 = 1\nL3 = 550\nD = 0\n", "cannot-assemble"),
    ],
)  # fmt: skip
def test_a_linkage_without_a_motion_opens_and_says_why(content: str, words: str) -> None:
    session = Session(content, "x")
    assert words in session.problem
    assert (session.view, session.row, session.modes()) == (None, 0.0, [])
    # nothing to move, and nothing fails for it
    for action in (session.next_mode, session.undo, session.redo, session.reset):
        action()
    session.advance(1.0)
    session.step(3)
    session.seek(4.0)
    session.seek_input(1.0)
    session.choose(0)
    assert (session.view, session.row) == (None, 0.0)


def test_a_linkage_that_could_not_be_assembled_moves_once_it_can() -> None:
    session = Session("format = 1\n[rssr]\nM = 700\nN = 700\nL1 = 250\nL2 = 1\nL3 = 550\nD = 0\n", "x")
    session.change(("rssr", "L2"), 1000.0)
    assert session.problem == ""
    assert session.view is not None
    session.undo()
    assert session.problem
    assert session.view is not None


@pytest.mark.parametrize("name", ["rssr", "five_bar", "rssp", "seven_r", "rccc"])
def test_dimensions_of_any_size_raise_nothing_but_refusals(name: str) -> None:
    session = opened(name)
    for dimension in session.draft.dimensions[::5]:
        for value in (1e-99, 1e99, -1e20, 0.0):
            try:
                session.change(dimension.place, session.draft.written(dimension, value))
            except SevenbarError:
                continue
            if not session.problem:
                session.next_mode()
                session.advance(0.01)
                assert session.view is not None
                assert np.isfinite(session.view.frame.pose(session.row)).all()
            session.undo()
    assert session.problem == ""


# --- the drive


def test_another_joint_drives_and_the_pose_stays() -> None:
    for name in ("rssr", "rssp", "rscr", "five_bar", "six_bar", "rccc"):
        session = opened(name)
        assert session.view is not None
        session.seek(57.0)
        first = session.draft.linkage.drive
        here = session.view.joints(session.row)
        shown = session.view.frame.pose(session.row)
        for joint in session.draft.linkage.drivable():
            if joint == session.draft.linkage.drive.joint:
                continue
            session.drive(joint, session.draft.linkage.drive.output)
            view = session.view
            assert (view.linkage.drive.joint, view.motion.input) == (joint, joint)
            assert view.linkage.drive.output != joint
            unit = f"{view.linkage.unit_of(view.motion.input)}/s"
            (speed,) = [d for d in session.draft.dimensions if d.label == "speed"]
            assert speed.unit == unit
            assert session.draft.toml()
            np.testing.assert_allclose(view.frame.pose(session.row), shown, atol=0.02 * view.frame.span)
            session.seek_input(view.input_at(session.row))
        session.drive(first.joint, first.output)
        assert session.view.linkage.drive.joint == first.joint
        gap = np.remainder(session.view.joints(session.row) - here + np.pi, 2 * np.pi) - np.pi
        assert np.abs(gap[session.view.circuit.input_column]) < 0.05


def test_a_speed_keeps_its_meaning_when_the_input_slides() -> None:
    session = opened("rssp")
    session.change(("drive", "speed"), "5.0 rad/s")
    session.drive("slider", "crank")
    assert session.draft.raw["drive"]["speed"] == "1 mm/s"
    session.change(("drive", "speed"), "20.0 mm/s")
    assert session.view is not None
    assert session.view.motion.speed == 20.0
    with pytest.raises(DescriptionError, match="turning speed, and the input slides"):
        session.change(("drive", "speed"), "20.0 rad/s")
    session.drive("crank", "slider")
    assert session.draft.raw["drive"]["speed"] == "1 rad/s"
    session.undo()
    session.undo()
    assert session.view.motion.speed == 1.0


def test_a_joint_that_is_not_there_or_cannot_drive_changes_nothing() -> None:
    session = opened("rssr")
    before = state(session)
    for ends, words in ((("cranck", "rocker"), "no joint 'cranck'"), (("ball_a", "rocker"), "is a ball")):
        with pytest.raises(SevenbarError, match=words):
            session.drive(*ends)
        assert state(session) == before
    session.drive("rocker", "rocker")
    assert session.draft.linkage.drive.output == "crank"


# --- points


def test_points_are_added_and_taken_away() -> None:
    session = opened("seven_r")
    session.add_point("Q", 4, (1.0, 2.0, 3.0))
    session.add_point("on the ground", 7, (0.0, 0.0, 5.0))
    assert session.view is not None
    # (of the drawn place: the file's last link is the ground)
    assert [trace.position.shape for trace in session.view.traces] == [(360, 3)] * 3
    assert np.ptp(session.view.traces[2].position, axis=0) == pytest.approx(0, abs=1e-9)
    before = state(session)
    for arguments, words in (
        (("Q", 1, (0.0, 0.0, 0.0)), "there is a point 'Q' already"),
        ((" Q ", 1, (0.0, 0.0, 0.0)), "already"),
        (("R", 99, (0.0, 0.0, 0.0)), "99"),
        (("R", 0, (0.0, 0.0, 0.0)), "0"),
        (("", 1, (0.0, 0.0, 0.0)), "not a name"),
        (("R", 1, (math.nan, 0.0, 0.0)), "not a finite number"),
        (("R", 1, (1e300, 0.0, 0.0)), "out of range"),
    ):
        with pytest.raises(SevenbarError, match=words):
            session.add_point(*arguments)
        assert state(session) == before
    session.remove_point(1)
    assert [point.name for point in session.view.linkage.points] == ["P", "on the ground"]
    session.undo()
    assert [point.name for point in session.view.linkage.points] == ["P", "Q", "on the ground"]


def test_the_own_points_of_an_rssr_keep_their_names() -> None:
    session = opened("rssr")
    with pytest.raises(RequestError, match="there is a point 'A' already"):
        session.add_point("A", 1, (0.0, 0.0, 0.0))


# --- files of this machine


def test_a_text_that_comes_through_the_page_reads_no_file_of_this_machine(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "press.csv").write_text("crank [deg],factor\n0,0\n30,1\n60,0\n", encoding="utf-8")
    loaded = text("rssr") + "[[load]]\nlink = 3\ntorque = [0, 0, 1]\ntable = {}\n"
    (tmp_path / "mine.toml").write_text(loaded.format("'press.csv'"), encoding="utf-8")
    session = opened("rssr")
    before = session.draft
    for source in ("mine.toml", str(tmp_path / "mine.toml"), "other.toml"):
        for name in ("press.csv", "none.csv", str(tmp_path / "press.csv"), "../press.csv"):
            with pytest.raises(
                DescriptionError, match=r"load\[1\].table: .* is the name of a file, and a text"
            ):
                session.open(loaded.format(f"'{name}'"), source)
            assert session.draft is before
    session.open(loaded.format("[[0, 0], [30, 1], [60, 0]]"), "mine.toml")
    assert session.draft.linkage.loading.loads[0].table[1] == (0, 1, 0)
    # the file of the command line is one's own
    own = Session((tmp_path / "mine.toml").read_text(encoding="utf-8"), "mine.toml")
    assert own.draft.linkage.loading.loads[0].table[1] == (0, 1, 0)
