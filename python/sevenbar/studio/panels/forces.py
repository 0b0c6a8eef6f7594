"""What acts, each with a switch, and what the input has to give."""

from __future__ import annotations

from functools import partial
from html import escape

import viser

from sevenbar.reporting.force_words import NOTHING_ACTS, drive_facts, open_facts
from sevenbar.studio.panels.controls import on_change, put
from sevenbar.studio.panels.force_arrows import ForceArrows
from sevenbar.studio.pictures.stage import Stage
from sevenbar.studio.state.acting import Switch, drive_sizing
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.verdict import facts_block
from sevenbar.studio.worker import Worker

#: The peaks are found so long [s] after the last change: finding them takes longer than a picture may.
AT_REST = 0.25


class ForcesPanel:
    """Check boxes of gravity, loads and springs, the arrows in the joints, and the peaks of the drive."""

    def __init__(self, gui: viser.GuiApi, worker: Worker, session: Session, stage: Stage) -> None:
        self._gui, self._worker, self._session = gui, worker, session
        self._hint = gui.add_html("")
        self._home = gui.add_folder("What acts", visible=False)
        self._boxes: list[viser.GuiCheckboxHandle] = []
        self._arrows = ForceArrows(gui, worker, session, stage)
        self._facts = gui.add_html("")
        self._switches: tuple[Switch, ...] | None = None
        self._shown: tuple[object, ...] = ()
        self._text = ""

    def show_arrows(self) -> None:
        """Moves the arrows to the pose on view."""
        self._arrows.show()

    def show(self) -> None:
        """Shows the switches as they are now; the facts follow when nothing changes any more."""
        acting = self._session.acting
        if acting.switches != self._switches:
            self._build(acting.switches)
        for box, switch in zip(self._boxes, acting.switches, strict=True):
            on = switch.key not in acting.off
            if box.value != on and not self._worker.awaits(("switch", switch.key)):
                put(box, on)
        shown = (self._session.view, acting, bool(self._session.problem))
        if shown == self._shown:
            return
        self._shown = shown
        self._hint.content = _nothing() if acting.is_empty else ""
        if acting.is_empty or self._session.view is None:
            self._text = ""
            self._worker.ask("peaks", lambda: None)
        else:
            self._worker.ask("peaks", self._find, delay=AT_REST)
        self._tell(stale=True)

    def _find(self) -> None:
        """Finds what the facts say of what is on view."""
        view, acting = self._session.view, self._session.acting
        if view is None:
            return
        forces = acting.forces(view)
        if forces is None:
            found = [("forces", acting.reason(view))]
        else:
            found = [*drive_facts(forces, drive_sizing(forces)), *open_facts(forces)]
        title = f"circuit {view.circuit.index}"
        self._text = facts_block([fact for fact in found if fact[1]], title=title)
        self._tell(stale=bool(self._session.problem))

    def _tell(self, *, stale: bool) -> None:
        self._facts.content = (
            f'<div style="opacity:0.45">{self._text}</div>' if stale and self._text else self._text
        )

    def _build(self, switches: tuple[Switch, ...]) -> None:
        """Makes the check boxes of other switches than before."""
        self._switches = switches
        for box in self._boxes:
            box.remove()
        self._boxes = []
        self._home.visible = bool(switches)
        with self._home:
            for switch in switches:
                box = self._gui.add_checkbox(switch.name, True, hint=switch.words)
                on_change(box, self._worker, ("switch", switch.key), partial(self._turn, switch.key))
                self._boxes.append(box)

    def _turn(self, key: str, on: bool) -> None:
        self._session.switch(key, on=on)


def _nothing() -> str:
    """What a file lacks for forces."""
    words = NOTHING_ACTS.replace("nothing in it", "nothing in the file", 1)
    return (
        '<div style="padding:6px 12px;font-size:12.5px;line-height:1.4;white-space:pre-wrap;color:#555">'
        f"{escape(words)}</div>"
    )
