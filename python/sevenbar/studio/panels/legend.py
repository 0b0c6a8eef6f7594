"""What the colours and signs of the scene mean, in two lines that are always on view."""

from __future__ import annotations

from html import escape

import viser

from sevenbar.drawing.scene import link_colours
from sevenbar.drawing.style import ACCELERATION, COUPLER, GROUND, INPUT, OUTPUT, ROD, VELOCITY
from sevenbar.studio.panels.controls import settle
from sevenbar.studio.pictures.stage import MARK_COLOUR
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.view import View, own_points


class Legend:
    """The signs that the linkage on view is drawn with."""

    def __init__(self, gui: viser.GuiApi, session: Session) -> None:
        self._session = session
        self._html = gui.add_html("")
        self._view: object = self

    def show(self) -> None:
        """Shows the signs of what is on view."""
        view = self._session.view
        if view is not self._view:
            self._view = view
            settle(self._html, content="" if view is None else legend(view))


def legend(view: View) -> str:
    """The legend of a view: links by their colours, and the signs of points where there are any."""
    colours, _ = link_colours(view.linkage, (view.motion.input, view.motion.output))
    named = {INPUT: "input", OUTPUT: "output", COUPLER: "other links"}
    signs = [("\u25ac", colour, name) for colour, name in named.items() if colour in colours]
    if view.linkage.rods:
        signs.append(("\u25ac", ROD, "rods"))
    signs.append(("\u25ac", GROUND, "ground"))
    if own_points(view):
        signs += [
            ("\u279e", VELOCITY, "velocity"),
            ("\u279e", ACCELERATION, "acceleration of a point"),
            ("\u25cf", MARK_COLOUR, "where it is fastest, slowest"),
        ]
    line = "".join(
        f'<span style="display:inline-block;white-space:nowrap;margin-right:10px">'
        f'<span style="color:{colour}">{sign}</span> {escape(words)}</span>'
        for sign, colour, words in signs
    )
    return f'<div style="padding:0 12px 6px;font-size:12px;line-height:1.5;color:#555">{line}</div>'
