"""One page that plays a motion without a server: the linkage in 3D, its verdict and its curves."""

from __future__ import annotations

from html import escape

import numpy as np

from sevenbar.drawing.quantities import quantities
from sevenbar.drawing.view import upright
from sevenbar.kinematics.ranges.reach import Reach, within
from sevenbar.studio.local_server import LocalServer
from sevenbar.studio.panels.transport import CYCLE
from sevenbar.studio.pictures.stage import FIELD, Stage
from sevenbar.studio.state.verdict import facts_html
from sevenbar.studio.state.view import View, views_of
from sevenbar.studio.svg.curves import panels

#: Pictures in a cycle.
PICTURES = 180


def page(view: View, reach: Reach | None = None) -> str:
    """The HTML of one cycle of the circuit on view, or of its way from stop to stop and back.

    All it needs is in it.
    """
    scene = escape(_scene(view, reach), quote=True)
    motion = view.motion
    curves = "".join(
        panel.html for panel in panels(views_of(motion), quantities(motion)[:3], view.circuit.index)
    )
    title = escape(f"{view.linkage.name}: {view.circuit.motion_type}")
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body {{ margin: 0; font: 14px sans-serif; color: #222; display: flex; height: 100vh; }}
aside {{ width: 440px; flex: none; overflow-y: auto; border-right: 1px solid #e2e2e2; }}
h1 {{ font-size: 16px; margin: 14px 12px 4px; }}
iframe {{ flex: 1; border: 0; height: 100%; min-width: 0; }}
@media (max-width: 800px) {{ body {{ flex-direction: column; height: auto; }}
  aside {{ width: auto; order: 2; border: 0; }} iframe {{ height: 70vh; flex: none; }} }}
</style></head><body>
<aside><h1>{title}</h1>{facts_html(view)}{curves}</aside>
<iframe title="the linkage moving" srcdoc="{scene}"></iframe>
</body></html>
"""


def _scene(view: View, reach: Reach | None) -> str:
    """The page of viser's player, with the scene and its motion in it."""
    # a recording is made of a server's scene; nobody hears of this one
    server = LocalServer("127.0.0.1", 0)
    try:
        stage = Stage(server.scene)
        stage.frame_view(view.frame.places, upright(view.linkage))
        stage.set(view.frame, (view.motion.input, view.motion.output), within(view))
        place, target = stage.look()
        server.initial_camera.fov = FIELD
        server.initial_camera.up = stage.up
        server.initial_camera.position, server.initial_camera.look_at = place, target
        rows = _rows(view, reach)
        stage.pose(view.frame.pose(rows[0]))
        recorder = server.get_scene_serializer()
        for row in rows:
            stage.pose(view.frame.pose(row))
            recorder.insert_sleep(CYCLE / PICTURES)
        return recorder.as_html()
    finally:
        server.stop()


def _rows(view: View, reach: Reach | None) -> list[float]:
    """The rows of the pictures, evenly in time."""
    if reach is None:
        return [view.row_at(float(time)) for time in np.linspace(0, view.period, PICTURES + 1)[:-1]]
    return [float(row) for row in reach.forth_and_back(PICTURES)[0]]
