"""How long the studio takes from a change of a slider to the new curves and scene, sent."""

from __future__ import annotations

import statistics
import threading
import time
from functools import partial
from typing import TYPE_CHECKING, Any

from evidence.benches.cases.studio_client import LONGEST_WAIT, Listener, updates
from evidence.benches.harness import told
from evidence.benches.outcome import Cell, Outcome, Table
from evidence.benches.setting import Setting

if TYPE_CHECKING:
    from sevenbar.kinematics.loop.geometry import Place

TITLE = "The studio: from a slider to new curves"
ABOUT = """\
A client without a browser is connected, so that packing and sending count; it draws nothing.
The first time ends when curves and scene have come, which are one message, the second when the last of
all has: the verdict and the boxes. What has come is known by its content, the new curves and the new
value, and the next change begins after it. The first length of each linkage is changed to and fro,
all circuits at 360 samples. Wall time; no peer does this."""

#: The asked medians [ms].
ASKED = {"rssr": 20.0, "seven_r": 50.0}


def connected(server: Any) -> tuple[Listener, Any]:
    """A client at a server, once all of its page has come, and its tab."""
    listener = Listener(server.address)
    listener.first(1, _has_curves)
    listener.at_rest(2.0)
    (tab,) = server.tabs
    return listener, tab


def changed(tab: Any, listener: Listener, changes: int) -> tuple[list[float], list[float]]:
    """Times [ms] to curves and scene, and to the end, of changes of the first length to and fro.

    Each begins when all of the one before has come, and ends with frames that are its own: the first with
    curves, and that with the new value in its box. Raises `ValueError` for a length at which nothing moves.
    """
    from sevenbar.studio.panels.shaping import number_text

    dimension = next(d for d in tab.session.draft.dimensions if d.label in ("L1", "length"))
    drawn, all_sent = [], []
    for number in range(changes):
        value = dimension.value * (1 + 0.0005 * (number + 1) * (-1) ** number)
        begun, shown = len(listener.frames), threading.Event()
        start = time.perf_counter()
        tab.worker.ask(dimension.place, partial(_change, tab, dimension.place, value, shown))
        if not shown.wait(LONGEST_WAIT):
            raise TimeoutError(f"{dimension.key} = {value}: not done after {LONGEST_WAIT:g} s")
        if tab.session.problem:
            raise ValueError(f"{dimension.key} = {value}: {tab.session.problem}")
        # unpacked only now, when the studio has no more to do
        drawn.append(1e3 * (listener.first(begun, _has_curves) - start))
        all_sent.append(1e3 * (listener.first(begun, partial(_tells, number_text(value))) - start))
    return drawn, all_sent


def _change(tab: Any, place: Place, value: float, shown: threading.Event) -> None:
    """Changes a dimension within a round of the tab's worker; the next round begins when it is shown."""
    tab.session.change(place, value)
    tab.worker.ask(shown, shown.set)


def _has_curves(frame: bytes) -> bool:
    return any("<svg" in update.get("content", "") for update in updates(frame))


def _tells(value: str, frame: bytes) -> bool:
    return any(update.get("value") == value for update in updates(frame))


def run(setting: Setting) -> Outcome:
    """One table; its rows tell where the studio's libraries are missing."""
    changes = setting.choose(200, 10)
    columns = [
        "",
        "curves sent [ms]",
        "quickest",
        "9 of 10 below",
        "asked",
        "all sent [ms]",
        "kB a change",
        "note",
    ]
    rows: list[list[Cell]] = []
    for name, asked in ASKED.items():
        try:
            rows.append([name, *measured(name, changes, asked)])
        except ImportError as error:
            rows.append([name, None, None, None, asked, None, None, told(error)])
    return Outcome(TITLE, ABOUT, [Table(f"{changes} changes", columns, rows)])


def measured(name: str, changes: int, asked: float) -> list[Cell]:
    """The cells of a linkage."""
    from sevenbar.description.files import toml_text
    from sevenbar.studio.server import StudioServer

    server = StudioServer(toml_text(name), name, "127.0.0.1", 0)
    listener, tab = connected(server)
    before = len(listener.frames)
    drawn, all_sent = changed(tab, listener, changes)
    drawn.sort()
    circuits = len(tab.session.motion.circuits) if tab.session.motion else 0
    kilobytes = sum(len(frame) for _, frame in listener.frames[before:]) / changes / 1e3
    server.stop()
    return [
        statistics.median(drawn),
        drawn[0],
        drawn[9 * changes // 10],
        asked,
        statistics.median(all_sent),
        kilobytes,
        f"{circuits} circuits",
    ]
