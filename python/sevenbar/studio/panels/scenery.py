"""The linkage in space: what is drawn of it, by what the tab has chosen to see."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import viser

from sevenbar.arrays import Floats
from sevenbar.drawing.skeleton import places_of, skeleton_of
from sevenbar.drawing.style import ACCELERATION, VELOCITY, circuit_colour
from sevenbar.drawing.view import upright
from sevenbar.kinematics.circuits.poses import poses
from sevenbar.kinematics.ranges.reach import within
from sevenbar.studio.panels.controls import settle
from sevenbar.studio.pictures.stage import FIELD, Stage
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.view import View, own_points
from sevenbar.studio.worker import Worker

#: Ghosts of one circuit, spread over its cycle.
POSITIONS = 8
#: The longest arrow, as a share of the linkage's extent.
LONGEST_ARROW = 0.35
#: When, after the page has opened, the browser is asked what shape the picture has [s].
QUESTIONS = (0.3, 0.6, 1.0, 1.5, 2.0, 3.0, 4.5, 7.0, 10.0, 15.0, 20.0, 30.0)
#: Changes of the field of view that make the browser answer, of the camera's place in the scene that are a
#: person's, and of the picture's shape that are none; shares, and [1].
NUDGE, MOVED, SAME_SHAPE = 1e-4, 1e-3, 0.01

#: How much larger the picture may be for all circuits than for the one on view; and the distance from the
#: middle of the scene [1] from which a place is no longer in sight.
WITH_ALL, OUT_OF_SIGHT = 1.4, 1.5

NO_AXODES = "no link"
NO_GHOSTS, ALONG, MODES = "none", "positions along the motion", "all modes at this input"


class Scenery:
    """Draws the session into the scene of a tab."""

    def __init__(self, client: viser.ClientHandle, worker: Worker, session: Session) -> None:
        self._client, self._worker, self._session = client, worker, session
        self.stage = Stage(client.scene)
        gui = client.gui
        self._ghosts = gui.add_dropdown("ghosts", (NO_GHOSTS, ALONG, MODES))
        self._switches = {
            name: gui.add_checkbox(name, on, hint=hint)
            for name, on, hint in (
                ("joint axes", True, None),
                ("paths", True, None),
                ("names", False, "of joints and points"),
                ("velocity arrows", True, "of the points you have added"),
                ("acceleration arrows", True, "of the points you have added"),
                ("extremes", True, "where the points you have added are fastest and slowest"),
            )
        }
        self._axodes = gui.add_dropdown(
            "axodes of",
            (NO_AXODES,),
            hint="its screw axes against the ground: blue in the ground, pink in the link",
        )
        look = gui.add_button("Look at it all", color="gray", icon=viser.Icon.FOCUS_CENTERED)
        look.on_click(lambda _: worker.ask("look", self.look))
        controls: tuple[Any, ...] = (self._ghosts, self._axodes, *self._switches.values())
        for control in controls:
            control.on_update(lambda _: worker.ask("scenery", lambda: None))
        self._framed: object = None
        self._motion: object = None
        self._aimed: tuple[Floats, float] | None = None
        self._arrived = False
        client.camera.on_update(self._camera_changed)
        self._drawn: dict[str, object] = {}
        self._everything = np.empty((0, 3))
        self._lines: tuple[Any, ...] = ()
        self._units: dict[int, tuple[float, float]] = {}

    def look(self) -> None:
        """Turns the camera so that the whole motion is seen, at the size it has now."""
        self._framed = None
        self._drawn.clear()

    def aim(self) -> None:
        """Turns the camera to what is drawn, by the shape of the picture as last sent."""
        camera = self._client.camera
        aspect = camera.aspect
        place, target = self.stage.look(aspect, self._everything)
        camera.fov = FIELD
        up = self.stage.up
        if not np.allclose(camera.up_direction, up):
            # a camera that looks along its own up is refused, on the way to the new place, too
            ahead = [np.subtract(target, place), np.subtract(camera.look_at, camera.position)]
            camera.up_direction = between(ahead)
        camera.position, camera.look_at = place, target
        camera.up_direction = up
        self._aimed, self._arrived = (place, aspect), False

    def watch(self) -> None:
        """Aims again while the page is put together, until the picture keeps its shape.

        The picture is as wide as the window at first, then the panels are put at its sides. The browser says
        nothing of that until the camera changes.
        """
        for number, delay in enumerate(QUESTIONS):
            self._worker.ask(("look", number), self._ask_shape, delay=delay)

    def _ask_shape(self) -> None:
        """Has the browser say its camera, and with it the picture's shape, by a change that nobody sees."""
        camera = self._client.camera
        if self._aimed is not None:
            camera.fov = FIELD * (1 + NUDGE) if abs(camera.fov - FIELD) < FIELD * NUDGE / 2 else FIELD

    def _camera_changed(self, _: viser.CameraHandle) -> None:
        if self._aimed is not None:
            self._worker.ask("camera", self._seen)

    def _seen(self) -> None:
        """Aims again where the picture has another shape, unless a person has turned the camera since."""
        if self._aimed is None:
            return
        camera, (place, aspect) = self._client.camera, self._aimed
        moved = float(np.abs(camera.position - place).max()) > MOVED
        if moved and self._arrived:
            self._aimed = None
        elif not moved:
            self._arrived = True
            if abs(camera.aspect - aspect) > SAME_SHAPE * aspect:
                self.aim()

    def show(self) -> None:
        """Draws what has changed."""
        view = self._session.view
        if view is None:
            self._still()
            return
        self._drawn.pop("still", None)
        row, problem = self._session.row, bool(self._session.problem)
        switches = {name: switch.value for name, switch in self._switches.items()}
        if self._is_new("view", (view, problem)):
            self._take(view, grey=problem)
        elif self._is_new("pose", row):
            self.stage.pose(view.frame.pose(row))
        if self._is_new("switches", (view, *switches.values())):
            self.stage.axes(switches["joint axes"])
            self.stage.paths(switches["paths"])
            self.stage.labels(switches["names"])
            self._mark(view, switches["extremes"])
        if self._is_new("arrows", (view, row, problem, *switches.values())):
            self._point(view, switches)
        if self._is_new("axodes", (view, row, self._axodes.value)):
            self._draw_axodes(view, row)
        ghosts = self._ghosts.value
        among = {MODES: row, ALONG: self._session.reach}.get(ghosts)
        if self._is_new("ghosts", (view, ghosts, among)):
            self._ghost(view)

    def _still(self) -> None:
        """Draws a drawn linkage that never moved as it is drawn, in grey; nothing of another one."""
        draft = self._session.draft
        if not self._is_new("still", draft):
            return
        self.stage.clear()
        self._drawn = {"still": draft}
        linkage = draft.linkage
        if linkage.form != "drawn":
            return
        frame = skeleton_of(linkage, poses(linkage, linkage.drawn_pose[None]), linkage.added_points)
        self._everything = frame.places.reshape(-1, 3)
        if self._framed is not draft.text:
            self.stage.frame_view(self._everything, upright(linkage))
        self.stage.set(frame, (linkage.drive.joint, linkage.drive.output))
        self.stage.pose(frame.places[0])
        self.stage.grey(True)
        if self._framed is not draft.text:
            self._framed = draft.text
            self.aim()

    def _is_new(self, what: str, state: object) -> bool:
        """Whether something has to be drawn anew, since what it shows has changed."""
        if self._drawn.get(what) == state:
            return False
        self._drawn[what] = state
        return True

    def _take(self, view: View, *, grey: bool) -> None:
        """Draws another view; what was opened anew is checked from where all of it is seen."""
        own = _places(view)
        # another circuit of the same motion may lie out of the picture
        chosen = view.motion is self._motion
        self._motion = view.motion
        away = chosen and bool((np.linalg.norm(self.stage.in_scene(own), axis=1) > OUT_OF_SIGHT).any())
        fresh = away or self._framed is not self._session.draft.text
        if fresh:
            # with every circuit that makes the picture little smaller, so that it stays when one is chosen
            every = np.concatenate([_places(each) for each in self._session.views])
            self._everything = every if _extent(every) <= WITH_ALL * _extent(own) else own
            self.stage.frame_view(self._everything, upright(view.linkage))
        self.stage.set(view.frame, (view.motion.input, view.motion.output), within(view))
        self.stage.pose(view.frame.pose(self._session.row))
        self._drawn["pose"] = self._session.row
        self.stage.grey(grey)
        self._units = {
            index: (
                arrow_unit(view, view.speeds[index]),
                arrow_unit(view, np.linalg.norm(view.traces[index].acceleration, axis=1)),
            )
            for index in own_points(view)
        }
        if fresh:
            self._framed = self._session.draft.text
            self.aim()

    def _draw_axodes(self, view: View, row: float) -> None:
        """The screw axes of the link that is chosen, in the ground and in the link."""
        links = (NO_AXODES, *(f"link {number}" for number in view.linkage.graph.moving))
        settle(self._axodes, options=links)
        chosen = links.index(self._axodes.value) if self._axodes.value in links else 0
        if not chosen:
            self.stage.axodes(np.empty((0, 2, 3)), np.empty((0, 2, 3)))
            self._lines = ()
            return
        if not self._lines or self._lines[0] is not view or self._lines[1] != chosen:
            self._lines = (view, chosen, *view.axodes(chosen))
        frame = view.point_frame(chosen, row)
        self.stage.axodes(self._lines[2], self._lines[3] @ frame[:3, :3].T + frame[:3, 3])

    def _ghost(self, view: View) -> None:
        chosen = self._ghosts.value
        shown: list[tuple[Floats, str | None]] = []
        if chosen == ALONG:
            shown = [(view.frame.pose(row), None) for row in self._spread(view)]
        elif chosen == MODES:
            modes = self._session.modes()
            own = self._session.mode(modes)
            others = [mode for i, mode in enumerate(modes) if i != own]
            q = np.array([each.joints(row) for each, row in others])
            places = list(places_of(q, view.frame)) if others else []
            colours = [circuit_colour(each.circuit.index) for each, _ in others]
            shown = list(zip(places, colours, strict=True))
        self.stage.ghosts(shown)

    def _spread(self, view: View) -> list[float]:
        """Rows spread over the cycle, or from stop to stop."""
        reach = self._session.reach
        if reach is None:
            rows = np.linspace(0, len(view.path.rows) - 1, POSITIONS, endpoint=False)
            return [float(row) for row in rows]
        return [reach.rolled(float(row)) for row in np.linspace(reach.low, reach.high, POSITIONS)]

    def _point(self, view: View, switches: dict[str, bool]) -> None:
        """The arrows of the points at the row on view."""
        arrows = []
        for index, units in self._units.items():
            place, velocity, acceleration = view.rates(index, self._session.row)
            both = ("velocity", velocity, VELOCITY), ("acceleration", acceleration, ACCELERATION)
            for (word, vector, colour), unit in zip(both, units, strict=True):
                if switches[f"{word} arrows"] and np.isfinite(vector).all() and unit > 0:
                    arrows.append((place, vector / unit, colour, ""))
        self.stage.arrows(arrows)

    def _mark(self, view: View, wanted: bool) -> None:
        """The places along the paths where the points are fastest and slowest."""
        places: list[Floats] = []
        words: list[str] = []
        for index in own_points(view) if wanted else ():
            name = view.linkage.points[index].name
            speeds = view.speeds[index]
            for word, row in view.speed_extremes(index):
                places.append(view.traces[index].position[view.path.rows][row])
                words.append(f"{name} {word}: {speeds[row]:.4g} {view.linkage.length_unit}/s")
        self.stage.marks(np.array(places).reshape(-1, 3), words)


def _places(view: View) -> Floats:
    """The places (n, 3) [length] of joints and points along the motion of a view."""
    places = view.frame.places.reshape(-1, 3)
    return np.asarray(places[np.isfinite(places).all(axis=1)])


def _extent(places: Floats) -> float:
    """The diagonal of the box round places (n, 3) [length]."""
    return float(np.linalg.norm(np.ptp(places, axis=0))) if len(places) else 0.0


def between(ahead: Sequence[Floats]) -> Floats:
    """The direction (3,) of a few that is farthest from all of some lines (3,)."""
    ways = np.concatenate([np.eye(3), np.ones((1, 3)) / np.sqrt(3.0)])
    along = np.array([np.abs(ways @ line) / np.linalg.norm(line) for line in ahead])
    return np.asarray(ways[along.max(axis=0).argmin()])


def arrow_unit(view: View, sizes: Floats, *, percent: float = 95, longest: float = LONGEST_ARROW) -> float:
    """What an arrow as long as the length unit stands for, by the sizes (n,) that arrows show.

    The longest, a share of the linkage's extent, is that of so many percent of the rows: those near dead
    centres, where sizes grow without bound, do not set the scale.
    """
    selected = sizes[np.isfinite(sizes)]
    usual = float(np.percentile(selected, percent)) if selected.size else 0.0
    return usual / (longest * view.frame.span)
