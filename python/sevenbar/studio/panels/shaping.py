"""Shaping the linkage: every dimension with a slider and a box, the drive, and the way back."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import viser

from sevenbar.errors import SevenbarError
from sevenbar.kinematics.numbers.dimensions import Dimension
from sevenbar.studio.panels.controls import PAUSE, Alert, by_person, on_change, put, settle
from sevenbar.studio.state.session import Session
from sevenbar.studio.worker import Worker
from sevenbar.text.units import ANGLES

#: Steps of a slider over its range, at most.
STEPS = 1000
#: A slider that could be so many times shorter is too wide to be of use.
MUCH = 6.0
#: Least room on a slider; steps of a smaller one would round to nothing.
LEAST = 1e-290


class DimensionRow:
    """A slider and a box for one dimension."""

    def __init__(
        self,
        gui: viser.GuiApi,
        worker: Worker,
        dimension: Dimension,
        size: float,
        shape: Callable[[Dimension, float], None],
    ) -> None:
        """`shape` changes a dimension, or raises `SevenbarError`; `size` is the linkage's greatest length."""
        self.dimension, self._worker, self._size, self._shape = dimension, worker, size, shape
        low, high, step = slider_range(dimension, size)
        label = f"{dimension.label} [{dimension.unit}]" if dimension.unit else dimension.label
        hint = f"{dimension.key}; it follows from the others until it is given" if dimension.follows else None
        self._box = gui.add_text(label, number_text(dimension.value), hint=hint)
        self._slider = gui.add_slider("", min=low, max=high, step=step, initial_value=dimension.value)
        self._alert = Alert(gui)
        on_change(self._slider, worker, dimension.place, lambda value: self._take(lambda: float(value)))
        on_change(
            self._box,
            worker,
            ("typed", dimension.place),
            lambda text: self._take(lambda: self.dimension.read(text)),
            delay=PAUSE,
        )

    def _take(self, read: Callable[[], float]) -> None:
        def change() -> None:
            value = read()
            if value != self.dimension.value:
                self._shape(self.dimension, value)
            else:
                # nothing follows, which would clear the box of what was refused
                self._written(value)

        if not self._alert.tried(change):
            put(self._slider, self.dimension.value)

    def show(self, dimension: Dimension) -> None:
        """Shows the value that the description has now."""
        self.dimension = dimension
        self._within(dimension.value)
        # while a person drags, the slider is ahead of the description
        if not self._worker.awaits(dimension.place):
            put(self._slider, dimension.value)
        # nor is a box set in which a person writes
        if not self._worker.awaits(("typed", dimension.place)):
            self._written(dimension.value)

    def _written(self, value: float) -> None:
        """Has the box say a value; what a person wrote stays as it is written."""
        if self._box.value == number_text(value):
            # as nearly all boxes do after a change, and reading takes longer
            return
        try:
            written = self.dimension.read(self._box.value)
        except SevenbarError:
            written = math.nan
        if written != value:
            put(self._box, number_text(value))
            self._alert.clear()

    def _within(self, value: float) -> None:
        """Widens the slider until it holds a value, or narrows one that is far too wide."""
        wide = self._slider.max > MUCH * slider_range(self.dimension, self._size)[1]
        if wide or not self._slider.min <= value <= self._slider.max:
            self._slider.min, self._slider.max, self._slider.step = slider_range(self.dimension, self._size)


def number_text(value: float) -> str:
    """A number as people write it, without digits that only rounding has made."""
    return f"{value:.12g}"


def slider_range(dimension: Dimension, size: float) -> tuple[float, float, float]:
    """Least value, greatest value and step of a slider that holds the value in its middle, or near it.

    `size` is the greatest length of the linkage; dimensions much smaller than it get room to grow.
    """
    value = abs(dimension.value)
    if dimension.unit in ANGLES:
        most = 180.0 if dimension.unit == "deg" else 3.15
        while value > most:
            most *= 2
        return -most, most, most / 360
    is_length = dimension.unit != "" and "/" not in dimension.unit
    room = max(size / 5, LEAST) if is_length else 1.0
    most = _nice(2 * max(value, room))
    if dimension.positive:
        step = _nice(most / STEPS)
        return min(step, value), most, step
    return -most, most, _nice(2 * most / STEPS)


def _nice(value: float) -> float:
    """The next of 1, 2, 5, 10, 20, .."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= value * (1 - 1e-9))


def largest_length(dimensions: Sequence[Dimension]) -> float:
    """The greatest length among dimensions, 1 where all are 0."""
    lengths = (abs(d.value) for d in dimensions if d.unit and d.unit not in ANGLES and "/" not in d.unit)
    return max(lengths, default=0.0) or 1.0


#: More groups of dimensions than these are folded at first, except the first one.
MOST_OPEN = 2


class DimensionList:
    """The rows of some of the dimensions, a folder for each group."""

    def __init__(
        self,
        gui: viser.GuiApi,
        worker: Worker,
        session: Session,
        wanted: Callable[[Dimension], bool],
    ) -> None:
        self._gui, self._worker, self._session, self._wanted = gui, worker, session, wanted
        self._home = gui.add_folder(None)
        self._rows: dict[tuple[str, str, str], DimensionRow] = {}
        self._folders: list[viser.GuiFolderHandle] = []

    def _shape(self, dimension: Dimension, value: float) -> None:
        session = self._session
        session.change(dimension.place, session.draft.written(dimension, value))

    def show(self) -> None:
        """Shows the dimensions as they are now; other dimensions than before get rows of their own."""
        dimensions = [d for d in self._session.draft.dimensions if self._wanted(d)]
        keys = [(d.key, d.group, d.unit) for d in dimensions]
        if keys != list(self._rows):
            self._build(dimensions)
            return
        for row, dimension in zip(self._rows.values(), dimensions, strict=True):
            row.show(dimension)

    def _build(self, dimensions: list[Dimension]) -> None:
        for folder in self._folders:
            folder.remove()
        self._folders, self._rows = [], {}
        size = largest_length(dimensions)
        groups = list(dict.fromkeys(d.group for d in dimensions))
        for group in groups:
            opened = len(groups) <= MOST_OPEN or group == groups[0]
            with self._home:
                folder = self._gui.add_folder(group, expand_by_default=opened)
            self._folders.append(folder)
            with folder:
                for d in dimensions:
                    if d.group == group:
                        self._rows[d.key, d.group, d.unit] = DimensionRow(
                            self._gui, self._worker, d, size, self._shape
                        )


class ShapePanel:
    """Undo, redo, reset; the drive; and every dimension but those of points."""

    def __init__(self, gui: viser.GuiApi, worker: Worker, session: Session) -> None:
        self._worker, self._session = worker, session
        self._history = gui.add_button_group("history", ("undo", "redo", "reset"))
        self._input = gui.add_dropdown("input", ("-",), hint="the joint that drives")
        self._output = gui.add_dropdown("output", ("-",), hint="the joint whose motion is shown")
        self._alert = Alert(gui)
        self.handles = gui.add_folder(None)
        self._list = DimensionList(gui, worker, session, lambda d: d.place[0] != "point")
        self._history.on_click(self._back)
        self._input.on_update(self._driven)
        self._output.on_update(self._driven)
        gui.add_command("Undo", hotkey="Z", modifier="cmd/ctrl").on_trigger(
            lambda _: worker.ask(("history", object()), session.undo)
        )
        gui.add_command("Redo", hotkey="Y", modifier="cmd/ctrl").on_trigger(
            lambda _: worker.ask(("history", object()), session.redo)
        )
        self._shown: object = None

    def _back(self, event: viser.GuiEvent[Any]) -> None:
        actions = {"undo": self._session.undo, "redo": self._session.redo, "reset": self._session.reset}
        # each click counts
        self._worker.ask(("history", object()), actions[event.target.value])

    def _driven(self, event: viser.GuiEvent[Any]) -> None:
        if by_person(event):
            ends = (self._input.value, self._output.value)
            self._worker.ask("drive", lambda: self._drive(*ends))

    def _drive(self, input: str, output: str) -> None:
        self._shown = None
        self._alert.tried(lambda: self._session.drive(input, output))

    def show(self) -> None:
        """Shows the description as it is now."""
        if self._shown is self._session.draft:
            return
        self._shown = self._session.draft
        linkage = self._session.draft.linkage
        for control, value, choices in (
            (self._input, linkage.drive.joint, linkage.drivable()),
            (self._output, linkage.drive.output, linkage.output_choices()),
        ):
            settle(control, options=tuple(choices))
            put(control, value)
        self._list.show()
