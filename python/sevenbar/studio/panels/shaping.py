"""Shaping the linkage: every dimension, the drive, and the way back."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from sevenbar.kinematics.numbers.dimensions import Dimension
from sevenbar.studio.panels.controls import Alert, by_person, offer, put
from sevenbar.studio.panels.dimension_rows import DimensionRow, largest_length
from sevenbar.studio.state.session import Session
from sevenbar.studio.worker import Worker

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
        choices = tuple(linkage.drivable())
        for control, value in ((self._input, linkage.drive.joint), (self._output, linkage.drive.output)):
            offer(control, choices)
            put(control, value)
        self._list.show()
