"""What can be taken home from the studio: each a file's name and its bytes."""

from __future__ import annotations

import io
import tempfile
import threading
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from sevenbar.description.draft import Draft
from sevenbar.drawing.figure import FORMATS as FIGURES
from sevenbar.errors import RequestError
from sevenbar.export import FORMATS, Bodies, export
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.ranges.reach import Reach
from sevenbar.reporting import report
from sevenbar.studio.panels.playback import page
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.view import View

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
