"""One tab of the studio: its panels, its scene, and the session they show."""

from __future__ import annotations

import sys
import traceback

import viser

from sevenbar.studio.panels.curves import CurvesPanel
from sevenbar.studio.panels.files import FilesPanel
from sevenbar.studio.panels.points import PointsPanel
from sevenbar.studio.panels.scenery import Scenery
from sevenbar.studio.panels.shaping import ShapePanel
from sevenbar.studio.panels.transport import Transport
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.verdict import verdict
from sevenbar.studio.worker import Worker

#: Widths of the panels [px].
LEFT, RIGHT = 440, 380

#: The boxes that viser puts beside sliders hold only what a slider can; the studio has boxes of its own.
STYLE = (
    "<style>.mantine-Slider-root + .mantine-NumberInput-root { display: none }"
    " .mantine-Slider-root { margin-bottom: 0.55em }</style>"
)

#: Until the browser has docked the panels [s].
DOCKED = 1.0

FAULT = "this is a fault of Sevenbar, not yours; please report the lines in the terminal"


class Tab:
    """What one browser tab shows; nothing of it is shared with another."""

    def __init__(self, client: viser.ClientHandle, session: Session) -> None:
        self.session, self._client = session, client
        self.worker = Worker(self._tick, self._show, self._fault)
        gui = client.gui
        gui.configure_theme(show_logo=False, show_share_button=False, control_width="medium")
        gui.set_panel_label("Sevenbar")
        with client.atomic():
            gui.add_html(STYLE)
            self._transport = Transport(gui, self.worker, session)
            tabs = gui.add_tab_group()
            with tabs.add_tab("Shape", viser.Icon.RULER_2):
                self._shape = ShapePanel(gui, self.worker, session)
            with tabs.add_tab("Show", viser.Icon.EYE):
                self._scenery = Scenery(client, self.worker, session)
            with tabs.add_tab("Points", viser.Icon.POINT):
                self._points = PointsPanel(gui, self.worker, session)
            with tabs.add_tab("Files", viser.Icon.FILE):
                FilesPanel(client, self.worker, session)
            gui.main_panel.dock_right()
            gui.main_panel.set_width(RIGHT)
            left = gui.add_panel()
            with left.add_tab("Curves and verdict", viser.Icon.CHART_LINE):
                self._curves = CurvesPanel(gui, self.worker, session)
                self._verdict = gui.add_html("")
            left.dock_left()
            left.set_width(LEFT)
        self._told: tuple[object, ...] = ()

    def start(self) -> None:
        """Shows the session, and goes on to do so."""
        self.worker.ask("first", lambda: None)
        # by then the panels are at the sides, and the picture is as wide as it stays
        self.worker.ask("aim", self._scenery.aim, delay=DOCKED)
        self.worker.start()

    def _tick(self, seconds: float) -> None:
        self._transport.tick(seconds)

    def _show(self) -> None:
        """Shows what the session has come to."""
        with self._client.atomic():
            self._transport.show()
            self._scenery.show()
            self._curves.show()
        # at once, without waiting for the end of viser's own interval
        self._client.flush()
        # nothing is sent while messages are grouped, so the longest work is done before that
        told = (self.session.motion, self.session.view, self.session.problem)
        content = self._verdict.content if told == self._told else verdict(self.session)
        with self._client.atomic():
            self._shape.show()
            self._points.show()
            if told != self._told:
                self._told = told
                self._verdict.content = content

    def _fault(self) -> None:
        """Tells of a fault of the studio's own, after which the tab goes on."""
        traceback.print_exc(file=sys.stderr)
        self._client.add_notification("A fault", FAULT, color="red")

    def end(self) -> None:
        """Ends the tab's thread."""
        self.worker.end()
