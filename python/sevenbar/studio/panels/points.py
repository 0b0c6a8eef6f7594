"""Points on links: add one, move it, take it away."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from itertools import count

import viser

from sevenbar.studio.panels.controls import Alert, put, settle
from sevenbar.studio.panels.shaping import DimensionList
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.view import View, own_points
from sevenbar.studio.worker import Worker
from sevenbar.text.ranges import three_numbers

#: What the list of points says where there is none.
NONE = "no points yet"

_HINT = (
    "In Denavit-Hartenberg rows: u along the link's joint, v along the link, w = u x v, from where the link "
    "before meets the joint's axis. In [rssr]: in the link's frame. In drawn joints: in ground coordinates."
)


class PointsPanel:
    """The points of the description, and the form for one more."""

    def __init__(self, gui: viser.GuiApi, worker: Worker, session: Session) -> None:
        self._worker, self._session = worker, session
        with gui.add_folder("New point"):
            self._name = gui.add_text("name", "P")
            self._link = gui.add_dropdown("link", ("1",))
            self._at = gui.add_text("at", "0, 0, 0", hint=_HINT)
            self._alert = Alert(gui)
            add = gui.add_button("Add point", icon=viser.Icon.PLUS)
        self._speeds = gui.add_html("")
        self._list = DimensionList(gui, worker, session, lambda d: d.place[0] == "point")
        self._removed = gui.add_dropdown("remove", (NONE,))
        self._remove = gui.add_button("Remove point", color="gray", icon=viser.Icon.TRASH)
        add.on_click(lambda _: worker.ask(("point", object()), lambda: self._alert.tried(self._add)))
        self._remove.on_click(lambda _: worker.ask(("point", object()), self._take_away))
        #: The links that may carry a point, by what the dropdown calls them.
        self._links: dict[str, int] = {}
        self._shown: object = None
        self._view: object = None

    def _add(self) -> None:
        at = three_numbers("at", self._at.value.replace(";", ","), "a place", "-100, -90, -80")
        name = self._name.value.strip()
        self._session.add_point(name, self._links[self._link.value], at)

    def _take_away(self) -> None:
        names = [str(point["name"]) for point in self._session.draft.raw.get("point", ())]
        if self._removed.value in names:
            self._session.remove_point(names.index(self._removed.value))

    def show(self) -> None:
        """Shows the points as they are now."""
        view, draft = self._session.view, self._session.draft
        if view is not self._view:
            self._view = view
            speeds = [] if view is None else [_speeds(view, i) for i in own_points(view)]
            settle(self._speeds, content="".join(speeds))
        if self._shown is draft:
            return
        self._shown = draft
        linkage = draft.linkage
        moving, ground = linkage.graph.moving, linkage.graph.ground
        self._links = {linkage.link_label(link): link for link in moving}
        self._links[f"{linkage.link_label(ground)}, the ground"] = ground
        settle(self._link, options=tuple(self._links))
        letters = "u, v, w" if draft.linkage.in_rows else "x, y, z"
        settle(self._at, label=f"at {letters} [{linkage.length_unit}]")
        names = tuple(str(point["name"]) for point in draft.raw.get("point", ()))
        settle(self._removed, options=names or (NONE,))
        settle(self._remove, disabled=not names)
        self._list.show()
        taken = {point.name for point in linkage.points}
        if self._name.value in taken:
            put(self._name, next(name for name in _names() if name not in taken))


def _speeds(view: View, index: int) -> str:
    """How fast a point gets, and how slow, among the samples of the circuit on view."""
    point, speeds = view.linkage.points[index], view.speeds[index]
    parts = [
        f"{word} {speeds[row]:.4g} {view.linkage.length_unit}/s @ {view.input_text(row)}"
        for word, row in view.speed_extremes(index)
    ]
    if not parts:
        return ""
    held = (
        "; its link's idle freedom is held by convention"
        if point.link in view.motion.linkage.idle_links
        else ""
    )
    line = escape(f"{point.name} on {view.motion.linkage.link_name(point.link)}: {', '.join(parts)}{held}")
    return f'<div style="padding:2px 12px 6px;font-size:12.5px">{line}</div>'


def _names() -> Iterator[str]:
    """P, Q, R .. Z, then P1, P2, .."""
    yield from "PQRSTUVWXYZ"
    yield from (f"P{number}" for number in count(1))
