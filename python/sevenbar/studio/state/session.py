"""The state behind one tab: the description and its history, what is on view, whether that is still true."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping

import numpy as np

from sevenbar.description.draft import Draft
from sevenbar.description.files import toml_tables
from sevenbar.description.load_tables import refuse_tables
from sevenbar.errors import RequestError, SevenbarError
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.loop.geometry import Place
from sevenbar.kinematics.ranges.reach import Reach, reaches, stopped_by, within
from sevenbar.reporting.facts import meaning
from sevenbar.reporting.reason_text import reason_text
from sevenbar.studio.state.acting import SwitchedLoading
from sevenbar.studio.state.view import View, distance_from_drawn, modes_at, nearest, views_of

#: Inputs in a full turn.
SAMPLES = 360
#: Steps that can be undone.
MOST_STEPS = 500
#: Changes of one dimension that follow each other within this time [s] are one step.
ONE_DRAG = 1.0
#: A pose so far from the one drawn [rad, or parts of the linkage's size] is another mode.
AS_DRAWN = 1e-3


class Session:
    """A description that is shaped, and the last motion it gave.

    `draft` is always a valid description. `problem` says why it has no motion, and is empty where it has one;
    `view` then shows the last one that moved, and is `None` only where there never was one. `views` are those
    of all circuits of the motion on view; `row` is the place on the view's path. `acting` is what acts on the
    linkage on view, without what is switched off. `held` says that the linkage stops at its stops.
    """

    def __init__(self, text: str, source: str, *, agree: float | None = None) -> None:
        """Redundant constraints of all that is opened `agree` up to a closure error, if one is given.

        Raises `DescriptionError` for a text that describes no linkage.
        """
        self.view: View | None = None
        self.views: tuple[View, ...] = ()
        self.row, self.forwards, self.held = 0.0, True, True
        self.past: list[Draft] = []
        self.future: list[Draft] = []
        self._last_change: tuple[object, float] = ((), -math.inf)
        self._reaches: tuple[View, tuple[Reach, ...]] | None = None
        self.draft = Draft.of(text, source, agree=agree)
        self.acting = SwitchedLoading(self.draft.linkage)
        self._take(self.draft)

    def open(self, text: str, source: str) -> None:
        """Shows a TOML text as one more step; raises `DescriptionError`, and then nothing has changed.

        It may come from another machine, so it names no files of this one.
        """
        refuse_tables(toml_tables(text, source), source)
        draft = Draft.of(text, source, agree=self.draft.agree)
        self.view, self.forwards = None, True
        self._step(draft)

    def _take(self, draft: Draft) -> None:
        """Shows the motion of a draft; where there is none, says why and keeps what is on view."""
        if draft.text is not self.draft.text:
            # another file; the one before would be no picture of it
            self.view, self.forwards = None, True
            self.acting = SwitchedLoading(draft.linkage)
        self.draft = draft
        self.motion: Motion | None = None
        try:
            motion = draft.linkage.motion(SAMPLES)
        except SevenbarError as error:
            self.problem = str(error)
            return
        self.motion = motion
        self.problem = ""
        if not motion.circuits:
            why = "; ".join(filter(None, (meaning(motion), reason_text(motion))))
            self.problem = f"{motion.motion_type}: {why or 'it closes along no circuit'}"
        elif any(np.isnan(circuit.input).any() for circuit in motion):
            self.problem = "its dimensions differ so much in size that its motion is lost in rounding"
        else:
            self.views = views_of(motion)
            self.acting = SwitchedLoading(draft.linkage, self.acting.off)
            self.view, self.row = (
                self._first() if self.view is None else nearest(self.views, self.view, self.row)
            )
            self.hold(self.held)

    def _first(self) -> tuple[View, float]:
        """Where a linkage is shown first: on the first circuit that goes anywhere within its stops."""
        for view in self.views:
            if within(view).any():
                free = reaches(view)
                begins = not free or any(one.holds(0.0) for one in free)
                return view, 0.0 if begins else free[0].low
        return self.views[0], 0.0

    @property
    def reaches(self) -> tuple[Reach, ...]:
        """The stretches of the path on view between stops; none where nothing stops it, or it is let go."""
        if not self.held or self.view is None:
            return ()
        if self._reaches is None or self._reaches[0] is not self.view:
            self._reaches = (self.view, reaches(self.view))
        return self._reaches[1]

    @property
    def reach(self) -> Reach | None:
        """The stretch that holds the place on view; `None` where no stop holds it, or it lies beyond one."""
        return next((one for one in self.reaches if one.holds(self.row)), None)

    def hold(self, held: bool) -> None:
        """Has the linkage stop at its stops, or go through; a place beyond one goes to the nearest within."""
        self.held = held
        if self.reaches and self.reach is None:
            ends = (one.rolled(end) for one in self.reaches for end in (one.low, one.high))
            self.row = min(ends, key=self._apart)

    def change(self, place: Place, value: object, stroke: object = None) -> None:
        """Gives a number of the description, or a place, another value.

        Changes of one stroke are one step of undo, however long it lasts. Raises `DescriptionError` for a
        value that is refused, and then nothing has changed.
        """
        self.move({place: value}, stroke)

    def move(self, values: Mapping[Place, object], stroke: object = None) -> None:
        """The same for values at several places, in one step."""
        draft = self.draft.with_places(values)
        if draft.raw == self.draft.raw:
            return
        now = time.monotonic()
        what = tuple(values) if stroke is None else stroke
        goes_on = self._last_change[0] == what and (
            stroke is not None or now - self._last_change[1] < ONE_DRAG
        )
        self._step(draft, remember=not goes_on)
        self._last_change = (what, now)

    @property
    def drawn(self) -> tuple[View, float] | None:
        """Where it is as drawn; `None` where it does not move, or has no drawing."""
        if self.problem or not self.views or self.draft.linkage.form != "drawn":
            return None
        linkage = self.draft.linkage
        value = linkage.drawn_pose[linkage.columns.index(linkage.drive.joint)]
        modes = modes_at(self.views, float(value))
        apart = [distance_from_drawn(view, row) for view, row in modes]
        return modes[int(np.argmin(apart))] if apart and min(apart) < AS_DRAWN else None

    def as_drawn(self) -> None:
        """Shows the linkage as it is drawn, where it is."""
        if (drawn := self.drawn) is not None:
            self.view, self.row = drawn

    def drive(self, input: str, output: str) -> None:
        """Drives the joint `input` and shows `output`; where both are one, the two change places.

        Raises `SevenbarError` where that cannot be.
        """
        linkage = self.draft.linkage
        ends = (input, output) if input != output else (linkage.drive.output, linkage.drive.joint)
        first = linkage.column(ends[0], "input")
        draft = self.draft.with_value(("drive", "joint"), ends[0]).with_value(("drive", "output"), ends[1])
        if "speed" in draft.raw["drive"] and not linkage.driven_alike(first):
            draft = draft.with_value(("drive", "speed"), f"1 {linkage.unit_of(first)}/s")
        self._step(draft)

    def add_point(self, name: str, link: int, at: tuple[float, float, float]) -> None:
        """Adds a named point; raises `SevenbarError` for one that cannot be."""
        if any(point.name == name.strip() for point in self.draft.linkage.points):
            raise RequestError(f"point: there is a point {name!r} already; give another name")
        draft = self.draft.with_point(name, link, at)
        self._step(draft)

    def remove_point(self, index: int) -> None:
        """Takes away a point of the description, counted from 0."""
        self._step(self.draft.without_point(index))

    def _step(self, draft: Draft, *, remember: bool = True) -> None:
        """Takes a draft as the next step; raises `DescriptionError` for one that describes no linkage."""
        draft.linkage  # noqa: B018  looked at before anything is forgotten
        if remember:
            self.past = [*self.past, self.draft][-MOST_STEPS:]
        self.future = []
        self._last_change = ((), -math.inf)
        self._take(draft)

    def switch(self, key: str, *, on: bool) -> None:
        """Switches gravity, a load or a spring on or off; the description stays as it is."""
        self.acting = self.acting.switched(key, on=on)

    def undo(self) -> None:
        """Takes back the last step, if there is one."""
        self._go(self.past, self.future)

    def redo(self) -> None:
        """Takes the last step that was undone again, if there is one."""
        self._go(self.future, self.past)

    def _go(self, taken: list[Draft], kept: list[Draft]) -> None:
        if taken:
            kept.append(self.draft)
            self._last_change = ((), -math.inf)
            self._take(taken.pop())

    def reset(self) -> None:
        """Goes back to the description as its file has it, as one more step."""
        opened = self.draft.as_opened()
        if opened.raw != self.draft.raw:
            self._step(opened)

    def choose(self, circuit: int) -> None:
        """Shows another circuit, at the same input where it gets there."""
        if self.view is None or circuit == self.view.circuit.index:
            return
        met = [mode for mode in self.modes() if mode[0].circuit.index == circuit]
        self.view, self.row = met[0] if met else (self.views[circuit], 0.0)

    def next_mode(self) -> None:
        """Shows the next mode at the same input."""
        if self.view is None:
            return
        modes = self.modes()
        if modes:
            self.view, self.row = modes[(self.mode(modes) + 1) % len(modes)]

    def modes(self) -> list[tuple[View, float]]:
        """All modes at the input on view: views and rows of their paths."""
        return [] if self.view is None else modes_at(self.views, self.view.input_at(self.row))

    def mode(self, modes: list[tuple[View, float]]) -> int:
        """Which of the modes at the input on view is on view."""
        own = [i for i, (view, _) in enumerate(modes) if view is self.view]
        return min(own, key=lambda i: self._apart(modes[i][1]), default=0)

    def _apart(self, row: float) -> float:
        """How far a row of the path on view is from the one on view, on a closed circuit the shorter way."""
        gap = abs(row - self.row)
        if self.view is None or not self.view.circuit.closed:
            return gap
        return min(gap, len(self.view.path.rows) - 1 - gap)

    def seek(self, row: float) -> None:
        """Goes to a row of the path on view, no farther than a stop lets it."""
        if self.view is not None:
            reach = self.reach
            self.row = float(np.clip(row, 0, len(self.view.path.rows) - 1))
            if reach is not None and not reach.holds(self.row):
                self.row = reach.rolled(reach.clamped(reach.unrolled(self.row)))

    def seek_input(self, value: float) -> None:
        """Goes to a value of the input [rad, or length], along the present pass if that gets there.

        Raises `RequestError` where the circuit on view does not get there.
        """
        view = self.view
        if view is None:
            return
        rows = view.rows_at(value)
        if not rows:
            slide = not view.linkage.turns(view.circuit.input_column)
            unit, size = (view.linkage.length_unit, 1.0) if slide else ("deg", math.degrees(1))
            low, high = (end * size for end in view.circuit.input_range or (0.0, 0.0))
            raise RequestError(
                f"input: {value * size:.6g} {unit} is out of reach of circuit {view.circuit.index}; "
                f"give {_within(low, high)} to {_within(high, low)} {unit}"
            )
        if self.reaches:
            free = [row for row in rows if any(one.holds(row) for one in self.reaches)]
            if not free:
                text, stops = view.input_text(rows[0]), stopped_by(view, rows[0])
                raise RequestError(
                    f"input: {text} lies beyond a stop of circuit {view.circuit.index} ({stops}); "
                    "give another, or switch the stops off"
                )
            reach = self.reach
            rows = [row for row in free if reach is not None and reach.holds(row)] or free
        part = view.pass_of(self.row)
        own = [row for row in rows if part.start <= row <= part.last]
        self.row = min(own or rows, key=lambda row: abs(row - self.row))

    def step(self, rows: int) -> None:
        """Goes on, or back, by whole rows, up to a stop; a closed circuit runs over its end."""
        if self.view is None:
            return
        last, reach = len(self.view.path.rows) - 1, self.reach
        start = self.row if reach is None else reach.unrolled(self.row)
        target = math.floor(start + 1e-9) + rows if rows > 0 else math.ceil(start - 1e-9) + rows
        if reach is not None:
            self.row = reach.rolled(reach.clamped(float(target)))
            return
        self.row = float(target % last if self.view.circuit.closed and last else min(max(target, 0), last))

    def advance(self, seconds: float) -> None:
        """Lets the mechanism run for some of its seconds; it turns at stops, and where it does not close."""
        view = self.view
        if view is None or not view.period > 0:
            return
        if (reach := self.reach) is not None:
            low, high = reach.times
            time = reach.time_at(reach.unrolled(self.row)) + (seconds if self.forwards else -seconds)
            if not low < time < high:
                self.forwards = not self.forwards
            self.row = reach.row_at(time)
            return
        now = view.time_at(self.row)
        if view.circuit.closed:
            self.row = view.row_at(now + seconds)
            return
        target = now + (seconds if self.forwards else -seconds)
        if not 0 <= target <= view.period:
            self.forwards = not self.forwards
        self.row = view.row_at(target)


def _within(end: float, other: float) -> str:
    """The end of a range as a person may type it: in six digits, and not beyond the end itself."""
    text = f"{end:.6g}"
    if (float(text) - end) * (other - end) < 0:
        step = 10.0 ** (math.floor(math.log10(abs(end))) - 5)
        text = f"{float(text) + math.copysign(step, other - end):.6g}"
    return text
