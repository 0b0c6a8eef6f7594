"""What can be taken home from the studio, by name and bytes; also a page that plays without a server."""

from __future__ import annotations

import io
import tempfile
import threading
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np

from sevenbar.description.draft import Draft
from sevenbar.drawing.figure import FORMATS as FIGURES
from sevenbar.errors import RequestError
from sevenbar.export import FORMATS, Bodies, export
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.ranges.reach import Reach, within
from sevenbar.reporting import report
from sevenbar.studio.local_server import LocalServer
from sevenbar.studio.panels.transport import CYCLE
from sevenbar.studio.pictures.stage import FIELD, Stage
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.verdict import facts_html
from sevenbar.studio.state.view import View, views_of
from sevenbar.studio.svg.curves import panels
from sevenbar.studio.svg.quantities import quantities

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
        stage.frame_view(view.frame.places)
        stage.set(view.frame, (view.motion.input, view.motion.output), within(view))
        place, target = stage.look()
        server.initial_camera.fov = FIELD
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


#: matplotlib's settings are shared by all threads, so one draws at a time.
_DRAWING = threading.Lock()


@dataclass(frozen=True)
class Scene:
    """What there is to take home: the description, circuit and row on view, and the stops around it."""

    draft: Draft
    view: View | None
    row: float
    current: bool
    reach: Reach | None = None

    @staticmethod
    def of(session: Session) -> Scene:
        """What a session shows now."""
        return Scene(session.draft, session.view, session.row, not session.problem, session.reach)

    @property
    def stem(self) -> str:
        """The name of its files without their endings."""
        stem = Path(self.draft.source).name.removesuffix(".toml")
        return "".join(c if c.isalnum() or c in "-_." else "_" for c in stem) or "linkage"

    def moving(self) -> View:
        """What is on view; raises `RequestError` where that is not the description's own motion."""
        if self.view is None or not self.current:
            raise RequestError(
                "the linkage as it is described does not move; mend it, or undo, and try again"
            )
        return self.view


def _exported(word: str) -> Callable[[Scene], tuple[str, bytes]]:
    def write(scene: Scene) -> tuple[str, bytes]:
        view = scene.moving()
        choice: dict[str, float | int] = {}
        if word in POSED:
            row = min(int(scene.row), len(view.path.rows) - 1)
            choice = {
                "circuit": view.circuit.index,
                "at": view.input_at(scene.row),
                "branch": int(view.circuit.branch[view.path.rows[row]]),
            }
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"{scene.stem}{FORMATS[word].endings[0]}"
            files = export(view.motion, word, path, **choice)  # type: ignore[arg-type]
            return _one(scene.stem, files)

    return write


def _figures(ending: str) -> Callable[[Scene], tuple[str, bytes]]:
    def write(scene: Scene) -> tuple[str, bytes]:
        motion: Motion = scene.moving().motion
        with _DRAWING, tempfile.TemporaryDirectory() as folder:
            return _one(f"{scene.stem}_report", report.write(motion, folder, (ending,)))

    return write


def _page(scene: Scene) -> tuple[str, bytes]:
    return f"{scene.stem}.html", page(scene.moving(), scene.reach).encode()


def _one(stem: str, files: list[Path]) -> tuple[str, bytes]:
    """One file as it is, several as one archive."""
    if len(files) == 1:
        return files[0].name, files[0].read_bytes()
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in files:
            archive.write(file, file.name)
    return f"{stem}.zip", packed.getvalue()


#: Words of exports that hold one pose, the one on view.
POSED = tuple(word for word, form in FORMATS.items() if isinstance(form, Bodies))

#: What is offered, by the words of the page.
DOWNLOADS: dict[str, Callable[[Scene], tuple[str, bytes]]] = {
    "page that plays (HTML)": _page,
    "motion (CSV)": _exported("csv"),
    **{f"report and figures ({ending.upper()})": _figures(ending) for ending in FIGURES},
    "linkage (TOML)": lambda scene: (f"{scene.stem}.toml", scene.draft.toml().encode()),
    **{f"motion ({word.upper()})": _exported(word) for word in FORMATS if word not in (*POSED, "csv")},
    **{f"pose ({word.upper()})": _exported(word) for word in POSED},
}
