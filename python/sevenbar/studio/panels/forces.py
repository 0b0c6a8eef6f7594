"""What acts, each with a switch; the arrows of the forces in the joints; and what the input has to give."""

from __future__ import annotations

import math
from functools import partial
from html import escape

import numpy as np
import viser

from sevenbar.arrays import Floats
from sevenbar.drawing.force_panels import ROUNDING, greatest_of
from sevenbar.drawing.style import REACTION
from sevenbar.kinematics.circuits.poses import at_row
from sevenbar.reporting.force_words import NOTHING_ACTS, drive_facts, open_facts, part_facts
from sevenbar.reporting.shown import number
from sevenbar.studio.panels.controls import on_change, put, settle
from sevenbar.studio.panels.scenery import arrow_unit
from sevenbar.studio.pictures.stage import Arrow, Stage
from sevenbar.studio.state.acting import Switch, SwitchedLoading, drive_sizing, known_force
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.verdict import facts_block, faded
from sevenbar.studio.state.view import View
from sevenbar.studio.worker import Worker

#: The longest arrow, as a share of the linkage's extent.
LONGEST = 0.25

#: The peaks are found so long [s] after the last change: finding them takes longer than a picture may.
AT_REST = 0.25

NO_ARROWS, EVERY_JOINT = "none", "all joints"

_HINT = (
    "What the link before a joint puts on the link after it, the ground after the last: "
    "the part of the force that equilibrium determines. The peak of the cycle is the longest arrow."
)


class ForceArrows:
    """An arrow with its value at each joint that is chosen; none at first."""

    def __init__(self, gui: viser.GuiApi, worker: Worker, session: Session, stage: Stage) -> None:
        self._session, self._stage = session, stage
        self._choice = gui.add_dropdown("force arrows", (NO_ARROWS,), hint=_HINT)
        self._choice.on_update(lambda _: worker.ask("forces", lambda: None))
        self._names: tuple[str, ...] = ()
        # what the arrows on view show, with the row; what the forces along the path are of
        self._drawn: tuple[object, ...] = ()
        self._of: tuple[object, ...] = ()
        # the force (n, 3) on the rows of the path in each joint with an arrow; `arrow_unit` of all
        self._along: list[tuple[int, Floats]] = []
        self._unit = 0.0

    def show(self) -> None:
        """Draws the arrows at the row on view, where something has changed."""
        view, acting = self._session.view, self._session.acting
        names = tuple(joint.name for joint in acting.linkage.joints) if not acting.is_empty else ()
        if names != self._names:
            self._offer(names)
        chosen = self._choice.value
        drawn = (view, acting, chosen, self._session.row, bool(self._session.problem))
        if drawn == self._drawn:
            return
        self._drawn = drawn
        wanted = self._wanted(chosen)
        if view is None or not wanted:
            self._of = ()
            self._stage.arrows([], "joints")
            return
        if self._of != (view, acting, chosen):
            self._of = (view, acting, chosen)
            self._follow(view, acting, wanted)
        self._stage.arrows(self._at(view, self._session.row), "joints")

    def _offer(self, names: tuple[str, ...]) -> None:
        """What can be chosen; a joint that there is no more goes back to none."""
        self._names, was = names, self._choice.value
        choices = (NO_ARROWS, EVERY_JOINT, *names) if names else (NO_ARROWS,)
        settle(self._choice, options=choices)
        put(self._choice, was if was in choices else NO_ARROWS)

    def _wanted(self, chosen: str) -> list[int]:
        if chosen == EVERY_JOINT:
            return list(range(len(self._names)))
        return [self._names.index(chosen)] if chosen in self._names else []

    def _follow(self, view: View, acting: SwitchedLoading, wanted: list[int]) -> None:
        """Computes the forces along the path, and the scale that all arrows share."""
        forces = acting.forces(view)
        self._along, self._unit = [], 0.0
        if forces is None:
            return
        result = [known_force(reaction) for reaction in forces.reactions.values()]
        least = ROUNDING * max(greatest_of(force) for force in result)
        self._along = [
            (joint, result[joint][view.path.rows]) for joint in wanted if greatest_of(result[joint]) > least
        ]
        if self._along:
            sizes = np.linalg.norm(np.concatenate([force for _, force in self._along]), axis=1)
            self._unit = arrow_unit(
                view, sizes, percent=95 if view.circuit.turns_back else 100, longest=LONGEST
            )

    def _at(self, view: View, row: float) -> list[Arrow]:
        places = view.frame.pose(row)
        arrows: list[Arrow] = []
        for joint, along in self._along:
            force = at_row(along, row)
            size = float(np.linalg.norm(force))
            if math.isfinite(size) and self._unit > 0:
                place = places[view.frame.joints[joint]]
                arrows.append((place, force / self._unit, REACTION, f"{number(size)} N"))
        return arrows


class ForcesPanel:
    """Check boxes of gravity, loads and springs, the arrows in the joints, and the peaks of the drive."""

    def __init__(self, gui: viser.GuiApi, worker: Worker, session: Session, stage: Stage) -> None:
        self._gui, self._worker, self._session = gui, worker, session
        self._hint = gui.add_html("")
        self._home = gui.add_folder("What acts", visible=False)
        self._boxes: list[viser.GuiCheckboxHandle] = []
        self.arrows = ForceArrows(gui, worker, session, stage)
        self._facts = gui.add_html("")
        # what the check boxes are for, and what of it they show as switched off
        self._switches: tuple[Switch, ...] | None = None
        self._off: frozenset[str] = frozenset()
        self._shown: tuple[object, ...] = ()
        self._text = ""

    def show(self) -> None:
        """Shows the switches as they are now; the facts follow when nothing changes any more."""
        acting = self._session.acting
        if acting.switches != self._switches:
            self._build(acting.switches)
        if acting.off != self._off:
            self._off = acting.off
            for box, switch in zip(self._boxes, acting.switches, strict=True):
                if not self._worker.awaits(("switch", switch.key)):
                    put(box, switch.key not in acting.off)
        shown = (self._session.view, acting, bool(self._session.problem))
        if shown == self._shown:
            return
        self._shown = shown
        settle(self._hint, content=_nothing() if acting.is_empty else "")
        if acting.is_empty or self._session.view is None:
            self._text = ""
            self._worker.ask("peaks", lambda: None)
        else:
            self._worker.ask("peaks", self._find, delay=AT_REST)
        self._show_facts(stale=True)

    def _find(self) -> None:
        """Finds what the facts say of what is on view."""
        view, acting = self._session.view, self._session.acting
        if view is None:
            return
        forces = acting.forces(view)
        if forces is None:
            result = [("forces", acting.reason(view))]
        else:
            own = forces.within_stops or forces
            result = [*part_facts(own), *drive_facts(own, drive_sizing(forces)), *open_facts(own)]
        title = f"circuit {view.circuit.index}"
        self._text = facts_block([fact for fact in result if fact[1]], title=title)
        self._show_facts(stale=bool(self._session.problem))

    def _show_facts(self, *, stale: bool) -> None:
        settle(self._facts, content=faded(self._text, stale=stale))

    def _build(self, switches: tuple[Switch, ...]) -> None:
        """Makes the check boxes of other switches than before."""
        self._switches, self._off = switches, frozenset()
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
    return (
        '<div style="padding:6px 12px;font-size:12.5px;line-height:1.4;white-space:pre-wrap;color:#555">'
        f"{escape(NOTHING_ACTS.format(place='the file'))}</div>"
    )
