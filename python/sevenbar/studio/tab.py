"""One tab of the studio: its panels, its scene, and the session they show."""

from __future__ import annotations

import sys
import traceback

import viser

from sevenbar.studio.panels.curves import CurvesPanel
from sevenbar.studio.panels.files import FilesPanel
from sevenbar.studio.panels.forces import ForcesPanel
from sevenbar.studio.panels.handles import Handles
from sevenbar.studio.panels.legend import Legend
from sevenbar.studio.panels.points import PointsPanel
from sevenbar.studio.panels.scenery import Scenery
from sevenbar.studio.panels.shaping import ShapePanel
from sevenbar.studio.panels.sketching import SketchPanel
from sevenbar.studio.panels.transport import Transport
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.shelf import Shelf
from sevenbar.studio.state.verdict import verdict
from sevenbar.studio.worker import Worker

#: Widths of the panels [px]: at most, at least, and as a share of the window's; more is the linkage's.
LEFT, RIGHT = (440, 300, 0.3), (380, 290, 0.265)

#: The boxes that viser puts beside sliders hold only what a slider can; the studio has boxes of its own.
STYLE = (
    "<style>.mantine-Slider-root + .mantine-NumberInput-root { display: none }"
    " .mantine-Slider-root { margin-bottom: 0.55em }"
    # five tabs in the narrowest panel: there they have no icons
    " [role=tab] { padding-inline: 0.45em !important }"
    " @media (max-width: 1340px) { [role=tab] :has(> svg) { display: none } }</style>"
)

FAULT = "this is a fault of Sevenbar, not yours; please report the lines in the terminal"


class Tab:
    """What one browser tab shows; nothing of it is shared with another."""

    def __init__(self, client: viser.ClientHandle, session: Session, shelf: Shelf | None) -> None:
        """`shelf` has the files that the tab may save to."""
        self.session, self._client = session, client
        self.worker = Worker(self._tick, self._show, self._fault)
        gui = client.gui
        gui.configure_theme(show_logo=False, show_share_button=False, control_width="medium")
        gui.set_panel_label("Sevenbar")
        # the first that a browser says of itself, before anything is docked
        window = client.camera.image_width
        with client.atomic():
            gui.add_html(STYLE)
            self._transport = Transport(gui, self.worker, session)
            self._legend = Legend(gui, session)
            tabs = gui.add_tab_group()
            with tabs.add_tab("Shape", viser.Icon.RULER_2):
                with gui.add_folder("New linkage", expand_by_default=False):
                    SketchPanel(gui, self.worker, session)
                self._shape = ShapePanel(gui, self.worker, session)
            with tabs.add_tab("Show", viser.Icon.EYE):
                self._scenery = Scenery(client, self.worker, session)
            with self._shape.handles:
                self._handles = Handles(
                    client, self.worker, session, self._scenery.stage, self._transport.pause
                )
            with tabs.add_tab("Points", viser.Icon.POINT):
                self._points = PointsPanel(gui, self.worker, session)
            with tabs.add_tab("Forces", viser.Icon.BARBELL):
                self._forces = ForcesPanel(gui, self.worker, session, self._scenery.stage)
            with tabs.add_tab("Files", viser.Icon.FILE):
                self._files = FilesPanel(client, self.worker, session, shelf)
            gui.main_panel.dock_right()
            gui.main_panel.set_width(_width(RIGHT, window))
            left = gui.add_panel()
            with left.add_tab("Curves and verdict", viser.Icon.CHART_LINE):
                self._curves = CurvesPanel(gui, self.worker, session, _width(LEFT, window))
                self._verdict = gui.add_html("")
            left.dock_left()
            left.set_width(_width(LEFT, window))
        self._shown: tuple[object, ...] = ()

    def start(self) -> None:
        """Shows the session, and goes on to do so."""
        self.worker.ask("first", lambda: None)
        self._scenery.watch()
        self.worker.start()

    def _tick(self, seconds: float) -> None:
        self._transport.tick(seconds)

    def _show(self) -> None:
        """Shows the session as it is."""
        self._handles.follow()
        with self._client.atomic():
            self._transport.show()
            self._scenery.show()
            self._forces.arrows.show()
            self._curves.show()
        # at once, without waiting for the end of viser's own interval
        self._client.flush()
        # nothing is sent while messages are grouped, so the longest work is done before that
        now = (self.session.motion, self.session.view, self.session.problem)
        content = self._verdict.content if now == self._shown else verdict(self.session)
        with self._client.atomic():
            self._legend.show()
            self._handles.show()
            self._shape.show()
            self._points.show()
            self._forces.show()
            self._files.show()
            if now != self._shown:
                self._shown = now
                self._verdict.content = content

    def _fault(self) -> None:
        """Reports a fault of the studio's own, after which the tab goes on."""
        traceback.print_exc(file=sys.stderr)
        self._client.add_notification("A fault", FAULT, color="red")

    def end(self) -> None:
        """Ends the tab's thread."""
        self.worker.end()


def _width(panel: tuple[int, int, float], window: int) -> int:
    """The width of a panel [px] in a window of a width [px]."""
    most, least, share = panel
    return min(most, max(least, round(share * window)))
