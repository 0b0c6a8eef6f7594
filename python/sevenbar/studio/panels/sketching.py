"""A new linkage: from a kind of the gallery, or from the places of its joints."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import viser

from sevenbar.description.gallery import names, title
from sevenbar.studio.panels.controls import PAUSE, Alert, on_change
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.sketch import DrawnJoint, Vector, beginning, drawn, kinds_of, of_kind
from sevenbar.studio.worker import Worker
from sevenbar.text.units import LENGTHS

#: What the form begins with.
FIRST_NAME, FIRST_KIND, FIRST_JOINTS = "My linkage", "planar_4r", "R R R R"

_Boxes = dict[str, Any]


class SketchPanel:
    """The forms for a new linkage; what they make is opened as one more step, which `undo` takes back."""

    def __init__(self, gui: viser.GuiApi, worker: Worker, session: Session) -> None:
        self._gui, self._session = gui, session
        kinds = (FIRST_KIND, *(kind for kind in names() if kind != FIRST_KIND))
        self._kinds = {f"{kind}: {title(kind)}": kind for kind in kinds}
        self._name = gui.add_text("new name", FIRST_NAME)
        self._kind = gui.add_dropdown("kind", tuple(self._kinds), hint="with the dimensions of the gallery")
        make = gui.add_button("Make this kind", color="gray", icon=viser.Icon.PLUS)
        self._joints = gui.add_text(
            "joints", FIRST_JOINTS, hint="their kinds in loop order: R P H C U S E K L, as in R S S R"
        )
        self._unit = gui.add_dropdown("in", tuple(LENGTHS), initial_value="mm", hint="of all lengths")
        self._home = gui.add_folder(None)
        draw = gui.add_button("Draw these joints", icon=viser.Icon.PENCIL)
        self._alert = Alert(gui)
        self._folders: list[viser.GuiFolderHandle] = []
        self._rows: list[tuple[str, _Boxes]] = []
        self._build(beginning(kinds_of(FIRST_JOINTS)))
        make.on_click(lambda _: worker.ask("new", lambda: self._open(self._of_kind)))
        draw.on_click(lambda _: worker.ask("new", lambda: self._open(self._drawn)))
        on_change(self._joints, worker, "joints", self._typed, delay=PAUSE)

    def _typed(self, words: str) -> None:
        self._alert.tried(lambda: self._lay(words))

    def _lay(self, words: str) -> None:
        """Gives the form the rows of other joints."""
        kinds = kinds_of(words)
        if kinds != tuple(kind for kind, _ in self._rows):
            self._build(beginning(kinds, self._read()))

    def _open(self, written: Callable[[], str]) -> None:
        self._alert.tried(lambda: self._session.open(written(), self._name.value.strip()))

    def _of_kind(self) -> str:
        return of_kind(self._name.value, self._kinds[self._kind.value])

    def _drawn(self) -> str:
        # what was typed last may still wait
        self._lay(self._joints.value)
        return drawn(self._name.value, self._unit.value, self._read())

    def _read(self) -> list[DrawnJoint]:
        """The joints as the boxes have them."""
        result = []
        for kind, boxes in self._rows:
            axes = [_vector(boxes[key]) for key in ("axis", "second axis") if key in boxes]
            result.append(
                DrawnJoint(
                    kind,
                    _vector(boxes["at"]),
                    cast("tuple[Vector, Vector]", tuple((*axes, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0))[:2])),
                    float(boxes["pitch"].value) if "pitch" in boxes else 10.0,
                    boxes["name"].value,
                )
            )
        return result

    def _build(self, joints: tuple[DrawnJoint, ...]) -> None:
        for folder in self._folders:
            folder.remove()
        self._folders, self._rows = [], []
        for number, joint in enumerate(joints, 1):
            with self._home:
                folder = self._gui.add_folder(f"joint {number}: {joint.kind}")
            self._folders.append(folder)
            with folder:
                boxes: _Boxes = {
                    "name": self._gui.add_text("name", joint.name),
                    "at": self._gui.add_vector3("at", joint.at),
                }
                for key, axis in zip(("axis", "second axis")[: joint.axis_count], joint.axes, strict=False):
                    boxes[key] = self._gui.add_vector3(key, axis)
                if joint.has_pitch:
                    boxes["pitch"] = self._gui.add_number("pitch", joint.pitch, hint="length in a turn")
            self._rows.append((joint.kind, boxes))


def _vector(box: Any) -> Vector:
    x, y, z = (float(value) for value in box.value)
    return x, y, z
