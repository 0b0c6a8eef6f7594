"""The curves next to the linkage, each with a cursor that goes along with the motion."""

from __future__ import annotations

import viser

from sevenbar.drawing.quantities import Over, Quantity, quantities
from sevenbar.studio.panels.controls import put, settle
from sevenbar.studio.state.acting import SwitchedLoading
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.view import View
from sevenbar.studio.svg.curves import panels
from sevenbar.studio.svg.picture import Panel
from sevenbar.studio.worker import Worker

#: How many curves there are, and the size of each [px].
CURVES, WIDTH, HEIGHT = 3, 420, 172
#: What of the panel's width is left of a curve [px].
MARGIN = 20

OVER: dict[str, Over] = {"the input": "input", "time": "time"}


class CurvesPanel:
    """Three curves, each of a quantity that is chosen above it."""

    def __init__(
        self, gui: viser.GuiApi, worker: Worker, session: Session, width: int = WIDTH + MARGIN
    ) -> None:
        """`width` is that of the panel [px]."""
        self._session, self._width = session, width - MARGIN
        self._over = gui.add_dropdown("over", tuple(OVER))
        self._choices, self._pictures, self._cursors = [], [], []
        for number in range(CURVES):
            self._choices.append(gui.add_dropdown(f"curve {number + 1}", ("-",)))
            self._pictures.append(gui.add_html(""))
            self._cursors.append(gui.add_html(""))
        for choice in (self._over, *self._choices):
            choice.on_update(lambda _: worker.ask("curves", lambda: None))
        self._offered: dict[str, Quantity] = {}
        self._panels: tuple[Panel, ...] = ()
        self._drawn: tuple[object, ...] = ()
        self._at: tuple[object, ...] = ()

    def show(self) -> None:
        """Draws the curves of what is on view, where it has changed, and moves the cursors."""
        view = self._session.view
        if view is None:
            for html in (*self._pictures, *self._cursors):
                html.content = ""
            self._drawn = ()
            return
        acting = self._session.acting
        if not self._drawn or self._drawn[:2] != (view, acting):
            self._offer(view, acting)
        picked = tuple(choice.value for choice in self._choices)
        drawn = (view, acting, picked, self._over.value, bool(self._session.problem))
        if drawn != self._drawn:
            self._drawn = drawn
            wanted = [self._offered[name] for name in picked]
            self._panels = panels(
                self._session.views,
                wanted,
                view.circuit.index,
                over=OVER[self._over.value],
                width=self._width,
                height=HEIGHT,
            )
            stale = ' style="filter:grayscale(1);opacity:0.45"' if self._session.problem else ""
            for html, panel in zip(self._pictures, self._panels, strict=True):
                html.content = f"<div{stale}>{panel.html}</div>"
        at = (*self._drawn, self._session.row)
        if at != self._at:
            self._at = at
            for html, panel in zip(self._cursors, self._panels, strict=True):
                html.content = panel.cursor_html(self._session.row)

    def _offer(self, view: View, acting: SwitchedLoading) -> None:
        """What can be chosen; a choice that there is no more goes back to the output's curves."""
        before = {name: quantity.key for name, quantity in self._offered.items()}
        self._offered = {quantity.name: quantity for quantity in quantities(view.motion, acting)}
        names = tuple(self._offered)
        by_key = {quantity.key: name for name, quantity in self._offered.items()}
        for choice, first in zip(self._choices, names, strict=False):
            was = by_key.get(before.get(choice.value, ""), first)
            settle(choice, options=names)
            put(choice, was)
