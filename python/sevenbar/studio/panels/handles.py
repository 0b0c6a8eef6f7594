"""Handles in the scene: the places of drawn joints, and named points, are pulled by arrows."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

import numpy as np
import viser

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.rigid import quaternion
from sevenbar.studio.panels.controls import Alert, on_change, put
from sevenbar.studio.pictures.stage import Stage
from sevenbar.studio.state.grips import Grip, grips
from sevenbar.studio.state.session import Session
from sevenbar.studio.worker import Worker

#: The length of a handle's arrows [1, in the scene], and how thick they are [pixels].
ARROWS, THICK = 0.17, 3.0
#: How far from its row a linkage still counts as drawn [rows].
NOT_MOVED = 1e-6

DRAWN = (
    "Pull an arrow, or a square between two. The linkage is shown as drawn; what lies in one place moves "
    "together; each pull is one step of undo."
)
POINTS = "Pull an arrow at a point. The dimensions of this form are changed in the boxes below."
NOTHING = "No points to pull: the dimensions of this form are changed in the boxes below."


class Handles:
    """The switch for the handles, and the handles; each pull goes the way of the number boxes."""

    def __init__(
        self,
        client: viser.ClientHandle,
        worker: Worker,
        session: Session,
        stage: Stage,
        pause: Callable[[], None],
    ) -> None:
        """`pause` ends what plays."""
        self._scene, self._worker, self._session = client.scene, worker, session
        self._stage, self._pause = stage, pause
        self._switch = client.gui.add_checkbox(
            "drag points", False, hint="arrows at the joints of a drawn linkage, and at named points"
        )
        self._note = client.gui.add_html("", visible=False)
        self._alert = Alert(client.gui)
        on_change(self._switch, worker, "handles", lambda on: self._turn(on=on))
        self._on = False
        self._held = ""
        self._handles: dict[str, viser.TransformControlsHandle] = {}
        self._grips: dict[str, Grip] = {}
        self._shown: tuple[object, ...] = ()
        #: The plane in which handles are pulled, as the stage has it; `None` in space.
        self._plane: Floats | None = None

    def _turn(self, *, on: bool) -> None:
        self._on, self._shown = on, ()
        self._alert.clear()
        if on:
            self._pause()
            self._session.as_drawn()

    def follow(self) -> None:
        """Shows a linkage as drawn again after a change of it; ends pulling where a person has moved it."""
        session = self._session
        if not self._on:
            return
        if self._shown and self._shown[0] is not session.draft:
            session.as_drawn()
        elif self._shown and self._moved():
            self._on = False
            put(self._switch, False)

    def _moved(self) -> bool:
        """Whether a drawn linkage is at another pose than the one drawn."""
        drawn = self._session.drawn
        if drawn is None:
            return False
        view, row = drawn
        return view is not self._session.view or abs(row - self._session.row) > NOT_MOVED

    def show(self) -> None:
        """Puts the handles where the description has its places now."""
        session, stage = self._session, self._stage
        if not self._on:
            if self._handles or self._note.visible:
                self._clear()
            return
        shown = (session.draft, session.view, session.row, stage.scale, tuple(stage.centre))
        if self._shown and all(a is b or a == b for a, b in zip(shown, self._shown, strict=True)):
            return
        self._shown = shown
        view = None if session.problem else session.view
        self._grips = {grip.key: grip for grip in grips(session.draft, view, session.row)}
        drawn = session.draft.linkage.form == "drawn"
        note = DRAWN if drawn else POINTS if session.draft.raw.get("point") else NOTHING
        self._note.content = (
            f'<div style="padding:0 12px 8px;font-size:12px;line-height:1.35;color:#555">{escape(note)}</div>'
        )
        self._note.visible = True
        planar = session.draft.linkage.is_planar
        plane = stage.plane if planar else None
        turned = plane is not self._plane
        self._plane = plane
        for key in [key for key in self._handles if turned or key not in self._grips]:
            self._handles.pop(key).remove()
        for key, grip in self._grips.items():
            place = stage.in_scene(grip.at)
            if key not in self._handles:
                self._handles[key] = self._made(key, place)
            elif key != self._held:
                self._handles[key].position = place

    def _made(self, key: str, place: Floats) -> viser.TransformControlsHandle:
        handle = self._scene.add_transform_controls(
            f"/handles/{key}",
            scale=ARROWS,
            line_width=THICK,
            disable_rotations=True,
            depth_test=False,
            position=place,
            # square to the plane a pull would take a planar linkage apart
            active_axes=(True, True, self._plane is None),
            wxyz=quaternion(np.eye(3) if self._plane is None else self._plane),
        )
        stroke = object()

        # awaited by viser, which gives plain functions to threads that may overtake each other
        async def pulled(event: viser.TransformControlsEvent) -> None:
            nonlocal stroke
            if event.phase == "start":
                stroke = object()
                self._held = key
            elif event.phase == "update":
                to, own = np.array(event.target.position), stroke
                self._worker.ask(("pull", key), lambda: self._pull(key, to, own))
            else:
                self._worker.ask(("pulled", key), lambda: self._let_go(key))

        handle.on_update(pulled)
        return handle

    def _pull(self, key: str, to: Floats, stroke: object) -> None:
        """Moves what a handle holds to a place in the scene; pulls of one `stroke` are one step of undo."""
        grip = self._grips.get(key)
        if grip is None or not self._on:
            return
        place = self._stage.from_scene(to)
        values = grip.dragged(place, 1.0 / self._stage.scale)
        self._alert.tried(lambda: self._session.move(values, stroke))

    def _let_go(self, key: str) -> None:
        """Puts a handle where its place has been rounded to."""
        self._held = ""
        if key in self._handles and key in self._grips:
            self._handles[key].position = self._stage.in_scene(self._grips[key].at)

    def _clear(self) -> None:
        for handle in self._handles.values():
            handle.remove()
        self._handles, self._grips, self._shown, self._held = {}, {}, (), ""
        self._note.visible = False
        self._alert.clear()
