"""How long the studio takes from a change of a slider to the new curves and scene, sent."""

from __future__ import annotations

import statistics
import threading
import time
from typing import Any

from benches.harness import told
from benches.outcome import Cell, Outcome, Table
from benches.setting import Setting

TITLE = "The studio: from a slider to new curves"
ABOUT = """\
A client without a browser is connected, so that packing and sending count; it throws away what it gets.
The first time ends when curves and scene have come, which are one message, the second when the last of
all has: the verdict and the boxes. The first length of each linkage is changed to and fro, all circuits
at 360 samples. Wall time; no peer does this."""

#: The asked medians [ms].
ASKED = {"rssr": 20.0, "seven_r": 50.0}

CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": (1.0, 0.0, 0.0, 0.0),
    "position": (3.0, -3.0, 2.0),
    "fov": 0.9,
    "near": 0.01,
    "far": 1000.0,
    "image_height": 900,
    "image_width": 1000,
    "look_at": (0.0, 0.0, 0.0),
    "up_direction": (0.0, 0.0, 1.0),
}


class Listener:
    """A client that only notes when bytes came, and how many: `frames` of (time [s], bytes)."""

    def __init__(self, address: str) -> None:
        import msgspec
        import viser
        from websockets.sync.client import connect

        protocol: Any = f"viser-v{viser.__version__}"
        self.frames = [(time.perf_counter(), 0)]
        self.socket = connect(
            address.replace("http://", "ws://"), subprotocols=[protocol], max_size=None, compression=None
        )
        self.socket.send(msgspec.msgpack.encode(CAMERA))
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        from websockets.exceptions import ConnectionClosed

        try:
            for frame in self.socket:
                self.frames.append((time.perf_counter(), len(frame)))
        except ConnectionClosed:
            pass

    def at_rest(self, quiet: float) -> None:
        """Waits until nothing has come for a while [s]."""
        while time.perf_counter() - self.frames[-1][0] < quiet:
            time.sleep(0.005)


def changed(tab: Any, listener: Listener, changes: int) -> tuple[list[float], list[float]]:
    """Times [ms] to curves and scene, and to the end, of changes of the first length to and fro."""
    dimension = next(d for d in tab.session.draft.dimensions if d.label in ("L1", "length"))
    drawn, all_sent = [], []
    for number in range(changes):
        value = dimension.value * (1 + 0.0005 * (number + 1) * (-1) ** number)
        sent = len(listener.frames)
        start = time.perf_counter()
        tab.worker.ask(dimension.place, lambda value=value: tab.session.change(dimension.place, value))
        while len(listener.frames) == sent:
            time.sleep(0.001)
        listener.at_rest(0.02)
        fresh = listener.frames[sent:]
        drawn.append(1e3 * (max(fresh, key=lambda frame: frame[1])[0] - start))
        all_sent.append(1e3 * (fresh[-1][0] - start))
    return sorted(drawn), sorted(all_sent)


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
    from sevenbar.files import text_of
    from sevenbar.studio.server import StudioServer

    server = StudioServer(text_of(name), name, "127.0.0.1", 0)
    listener = Listener(server.address)
    listener.at_rest(2.0)
    (tab,) = server.tabs
    before = len(listener.frames)
    drawn, all_sent = changed(tab, listener, changes)
    circuits = len(tab.session.motion.circuits) if tab.session.motion else 0
    kilobytes = sum(size for _, size in listener.frames[before:]) / changes / 1e3
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
