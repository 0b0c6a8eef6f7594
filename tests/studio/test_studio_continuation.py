"""Never a wrong mode: after a small change of a dimension the pose on view is the one before, gone on.

Source: the loop's product in `reference_loops`. The pose before is closed and taken along by Newton's method, input
held, in steps of the dimension so small that none of them can reach another mode. What the studio shows is
compared with where that leads; `circuit` tells the circuit through it, and `assembly_modes` all there are.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field

import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy.reference_loops import Loop
from places import REFERENCES
from sevenbar.description.draft import Draft
from sevenbar.description.gallery import text
from sevenbar.errors import SevenbarError
from sevenbar.kinematics.numbers.dimensions import Dimension
from sevenbar.studio.state.session import Session
from studio_sessions import distance

#: Poses told between two samples are that rough [rad, or parts of the size] where a circuit runs fast.
ROUGH = 0.15
#: A step of the dimension may not move the pose by more than this, nor by this part of its stiffness.
STEP, SHARE = 0.02, 0.1


def sixteen_modes() -> str:
    path = REFERENCES / "seven_r_sixteen_modes.json"
    loop = json.loads(path.read_text(encoding="utf-8"))["loop"]
    rows = zip(loop["length"], loop["twist_deg"], loop["offset"], strict=True)
    return "format = 1\nlength_unit = 'm'\n" + "".join(
        f"[[link]]\nlength = {float(a)!r}\ntwist = {float(w)!r}\noffset = {float(d)!r}\n" for a, w, d in rows
    )


#: A linkage, and input and output where others than the file's.
CASES: dict[str, tuple[str, tuple[str, str] | None]] = {
    "rssr": (text("rssr"), None),
    "rssr, rocking": (text("rssr"), ("rocker", "crank")),
    "seven_r": (text("seven_r"), None),
    "seven_r, rocking": (text("seven_r"), ("theta_3", "theta_1")),
    "rsur, rocking": (text("rsur"), ("rocker", "crank")),
    "five_bar": (text("five_bar"), None),
    "five_bar, rocking": (text("five_bar"), ("output_hinge", "input_shaft")),
    "six_bar, rocking": (text("six_bar"), ("parallel_3", "crank")),
    "six_bar, sliding": (text("six_bar"), ("cylinder.2", "crank")),
    "rscr": (text("rscr"), None),
    "rscr, sliding": (text("rscr"), ("cylinder.2", "crank")),
    "rssp, sliding": (text("rssp"), ("slider", "crank")),
    "sixteen modes": (sixteen_modes(), None),
}


@pytest.fixture(params=[25, pytest.param(400, marks=pytest.mark.proof)])
def steps(request: pytest.FixtureRequest) -> int:
    return request.param


def begun(case: str) -> Session:
    session = Session(CASES[case][0], case)
    drive(session, case)
    return session


def drive(session: Session, case: str) -> None:
    """Drives the case's own input; a reset goes back to the file's."""
    _, ends = CASES[case]
    if ends:
        session.drive(*ends)


def stiffness(linkage: sb.Linkage, q: np.ndarray, column: int) -> float:
    """How firmly the loop holds a pose with the input held; freedoms that move no other link left out."""
    return float(Loop.of(linkage).stiffness(q[None], column)[0][-1 - len(linkage.idle)])


def closed(linkage: sb.Linkage, q: np.ndarray, column: int) -> np.ndarray | None:
    loop = Loop.of(linkage)
    found = loop.polished(q[None], column, steps=8)[0]
    return found if loop.errors(found[None])[0] < 1e-9 else None


def followed(
    draft: Draft, dimension: Dimension, value: float, q: np.ndarray, motion: sb.Motion, column: int
) -> np.ndarray | None:
    """Where a closed pose goes as a dimension goes to a value; `None` where it comes beside a dead centre."""
    done, step = 0.0, 0.5
    while done < 1:
        step = min(step, 1 - done)
        now = dimension.value + (done + step) * (value - dimension.value)
        linkage = draft.with_value(dimension.place, now).linkage
        new = closed(linkage, q, column)
        if new is not None and distance(motion, new, q) < min(STEP, SHARE * stiffness(linkage, new, column)):
            q, done, step = new, done + step, 2 * step
        elif step < 1 / 32:
            return None
        else:
            step /= 2
    return q


@dataclass
class Walked:
    """A session that is shaped at random, and what came of it."""

    session: Session
    rng: np.random.Generator
    followed: int = 0
    wrong: list[str] = field(default_factory=list)

    def place(self) -> None:
        """Anywhere on any circuit; every third time beside a dead centre or the beginning."""
        session = self.session
        if self.rng.random() < 0.3:
            session.choose(int(self.rng.integers(len(session.view.motion.circuits))))
        last = len(session.view.path.rows) - 1
        if self.rng.random() < 0.33:
            starts = [part.start for part in session.view.passes]
            session.seek(float(self.rng.choice(starts) + self.rng.normal() * 0.7))
        elif self.rng.random() < 0.7:
            session.seek(float(self.rng.uniform(0, last)))

    def change(self, share: float) -> None:
        """One dimension by a share of itself, or of what is like it where it is 0."""
        session, rng = self.session, self.rng
        draft, motion, column = session.draft, session.motion, session.view.circuit.input_column
        dimensions = [d for d in draft.dimensions if d.place[0] not in ("point", "drive")]
        dimension = dimensions[int(rng.integers(len(dimensions)))]
        like = 10.0 if dimension.unit == "deg" else 0.1 * motion.circuits[0].size if dimension.unit else 0.1
        value = dimension.value + float(rng.choice([-1, 1])) * share * (abs(dimension.value) or like)
        before = closed(draft.linkage, session.view.joints(session.row), column)
        try:
            session.change(dimension.place, value)
        except SevenbarError:
            return
        if session.problem:
            session.undo()
            return
        what = f"{dimension.key} {dimension.value!r} -> {value!r}"
        view = session.view
        shown = view.joints(session.row)
        true = closed(session.draft.linkage, shown, column)
        if view.motion is not session.motion:
            self.wrong.append(f"{what}: of another motion")
        elif true is None or distance(motion, true, shown) > ROUGH:
            # beside a dead centre the input of a pose that is rough may be just out of reach
            if stiffness(session.draft.linkage, shown, column) > 0.05:
                self.wrong.append(f"{what}: no mode at all")
        else:
            self.told(what, true)
            self.compare(what, draft, dimension, value, before, true, column)

    def told(self, what: str, true: np.ndarray) -> None:
        """The circuit and the mode that the session tells are those of the pose."""
        session, view = self.session, self.session.view
        linkage, column = session.draft.linkage, view.circuit.input_column
        if self.rng.random() > 0.2 or stiffness(linkage, true, column) < 0.02:
            return
        modes = linkage.assembly_modes(float(true[column])).q
        gaps = [distance(view.motion, q, true) for q in modes]
        if not min(gaps, default=1.0) < 1e-6:
            self.wrong.append(f"{what}: not among the assembly modes")
        met = session.modes()
        if len(met) != len(modes) or met[session.mode(met)] != (view, pytest.approx(session.row, abs=1e-6)):
            self.wrong.append(f"{what}: mode {session.mode(met)} of {len(met)}, there are {len(modes)}")
        # a pose of the circuit through the pose, far from it, lies on the circuit on view
        through = linkage.circuit(true)
        far = through.q[len(through.q) // 3]
        mine = [distance(view.motion, view.joints(at), far) for at in view.rows_at(float(far[column]))]
        if not min(mine, default=9.0) < ROUGH:
            self.wrong.append(f"{what}: on another circuit than {view.circuit.index}")

    def compare(
        self,
        what: str,
        draft: Draft,
        dimension: Dimension,
        value: float,
        before: np.ndarray | None,
        true: np.ndarray,
        column: int,
    ) -> None:
        """What is shown is what the pose before has come to."""
        motion = self.session.motion
        if before is None or (
            abs(value - dimension.value) > 0.01 * max(abs(value), abs(dimension.value)) and dimension.value
        ):
            return
        if stiffness(draft.linkage, before, column) < 0.01:
            return
        gone = followed(draft, dimension, value, before, motion, column)
        if gone is None:
            return
        self.followed += 1
        if distance(motion, gone, true) > 1e-6:
            self.wrong.append(f"{what}: shown {distance(motion, gone, true):.3g} from where it went")


@pytest.mark.parametrize("case", CASES)
def test_a_pose_goes_on_through_small_changes(case: str, steps: int) -> None:
    walked = Walked(begun(case), np.random.default_rng(steps))
    for _ in range(steps):
        walked.place()
        walked.change(0.002)
    assert not walked.wrong, "\n".join(walked.wrong)
    assert walked.followed > steps / 3


@pytest.mark.parametrize("case", CASES)
def test_a_pose_goes_on_while_a_slider_is_dragged(case: str, steps: int) -> None:
    """From the pose that was left to the next, without a person's hand: small errors must not add up to a leap."""
    rng = np.random.default_rng(1)
    session = begun(case)
    session.seek(float(rng.uniform(0, len(session.view.path.rows) - 1)))
    column = session.view.circuit.input_column
    q = closed(session.draft.linkage, session.view.joints(session.row), column)
    followed_all = 0
    for dimension in rng.permutation(np.array(session.draft.dimensions, dtype=object))[: 1 + steps // 10]:
        if dimension.place[0] in ("point", "drive"):
            continue
        for _ in range(3):
            draft, old = session.draft, {d.place: d for d in session.draft.dimensions}[dimension.place]
            value = old.value + 0.002 * (abs(old.value) or 0.05)
            session.change(dimension.place, value)
            assert not session.problem
            q = q if q is None else followed(draft, old, value, q, session.motion, column)
            shown = closed(session.draft.linkage, session.view.joints(session.row), column)
            if q is None or shown is None:
                # beside a dead centre: from here on anew
                q = shown
                continue
            assert distance(session.motion, q, shown) < 1e-5, dimension.key
            followed_all += 1
    assert followed_all


@pytest.mark.parametrize("case", CASES)
def test_after_a_great_change_a_true_mode_is_shown_and_told(case: str, steps: int) -> None:
    walked = Walked(begun(case), np.random.default_rng(steps))
    for _ in range(steps // 2):
        walked.place()
        walked.change(float(walked.rng.uniform(0.05, 0.6)))
        if walked.rng.random() < 0.5:
            walked.session.reset()
            drive(walked.session, case)
    assert not walked.wrong, "\n".join(walked.wrong)


def test_a_pose_where_its_circuit_begins_goes_on_there() -> None:
    """The last rows of a circuit that turns lie beside its first ones, and may be more like the pose before."""
    session = Session(text("five_bar"), "five_bar")
    session.change(("joint", 2, "at", 2), 31.3)
    draft = session.draft
    dimension = draft.dimension("joint[3].at[1]")
    checked = 0
    for value in (-11.9, 11.9):
        for circuit in range(4):
            for row in (0.0, 0.5, 359.5, 360.0):
                session.choose(circuit)
                session.seek(row)
                before = session.view
                assert before is not None
                column = before.circuit.input_column
                pose = closed(draft.linkage, before.joints(row), column)
                assert pose is not None
                session.change(dimension.place, value)
                gone = followed(draft, dimension, value, pose, session.motion, column)
                if gone is not None:
                    shown = closed(session.draft.linkage, session.view.joints(session.row), column)
                    assert distance(session.motion, gone, shown) < 1e-6, (value, circuit, row)
                    checked += 1
                session.undo()
    assert checked >= 16


def test_where_a_mode_is_gone_the_pose_stays_at_the_limit_of_its_circuit() -> None:
    session = Session(text("rssr"), "rssr")
    session.drive("rocker", "crank")
    view = session.view
    assert view is not None
    _, high = view.circuit.input_range or (0, 0)
    session.seek_input(high - 0.002)
    circuit = view.circuit.index
    for value in np.linspace(250, 245, 11)[1:]:
        session.change(("rssr", "L1"), float(value))
        view = session.view
        assert view is not None
        assert view.circuit.index == circuit
        limit = (view.circuit.input_range or (0, 0))[1]
        assert limit < high - 0.002
        assert view.input_at(session.row) == pytest.approx(limit, abs=0.02)


def test_of_two_poses_alike_the_one_that_moves_alike_is_shown() -> None:
    """A hair beside a dead centre a change moves the dead centre past the pose, and the other pass is the nearer one."""
    other_nearer = 0
    session = Session(text("rssr"), "rssr")
    session.drive("rocker", "crank")
    for dimension in session.draft.dimensions:
        for share in (-0.002, 0.002):
            for row in (0.003, 76.997, 77.003, 153.997):
                while session.past[1:]:
                    session.undo()
                session.choose(0)
                session.seek(row)
                before = session.view
                q = before.joints(row)
                part = before.passes.index(before.pass_of(row))
                session.change(dimension.place, dimension.value * (1 + share) or 700 * share)
                view = session.view
                if (
                    dimension.place[0] == "drive"
                    or abs(view.input_at(session.row) - before.input_at(row)) > 1e-9
                ):
                    continue
                assert view.passes.index(view.pass_of(session.row)) == part, (dimension.key, share, row)
                gaps = [distance(view.motion, other.joints(at), q) for other, at in session.modes()]
                other_nearer += min(gaps) < distance(view.motion, view.joints(session.row), q) - 1e-9
    assert other_nearer
