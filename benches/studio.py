"""How long the studio takes from a change of a slider to the new curves and scene, sent.

A client without a browser is connected, so that packing and sending count; it throws away what it gets. The
first time ends when curves and scene have come, which are one message, the second when the last of all has:
the verdict and the boxes. Run on an idle machine: python benches/studio.py
"""

from __future__ import annotations

import statistics
import threading
import time

import msgspec
import viser
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from sevenbar.files import text_of
from sevenbar.studio.server import StudioServer
from sevenbar.studio.tab import Tab

#: The asked medians [ms].
ASKED = {"rssr": 20.0, "seven_r": 50.0}
CHANGES = 200

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
        protocol = f"viser-v{viser.__version__}"
        self.frames = [(time.perf_counter(), 0)]
        self.socket = connect(
            address.replace("http://", "ws://"), subprotocols=[protocol], max_size=None, compression=None
        )
        self.socket.send(msgspec.msgpack.encode(CAMERA))
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        try:
            for frame in self.socket:
                self.frames.append((time.perf_counter(), len(frame)))
        except ConnectionClosed:
            pass

    def at_rest(self, quiet: float) -> None:
        """Waits until nothing has come for a while [s]."""
        while time.perf_counter() - self.frames[-1][0] < quiet:
            time.sleep(0.005)


def changed(tab: Tab, listener: Listener) -> tuple[list[float], list[float]]:
    """Times [ms] to curves and scene, and to the end, of changes of the first length to and fro."""
    dimension = next(d for d in tab.session.draft.dimensions if d.label in ("L1", "length"))
    drawn, all_sent = [], []
    for number in range(CHANGES):
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


def main() -> None:
    """Prints the medians."""
    print(f"slider change to new curves and scene sent, median of {CHANGES} [ms]")
    for name, asked in ASKED.items():
        server = StudioServer(text_of(name), name, "127.0.0.1", 0)
        listener = Listener(server.address)
        listener.at_rest(2.0)
        (tab,) = server.tabs
        before = len(listener.frames)
        drawn, all_sent = changed(tab, listener)
        circuits = len(tab.session.motion.circuits) if tab.session.motion else 0
        print(
            f"  {name:8} {circuits} circuits at 360: {statistics.median(drawn):5.1f}"
            f"  (quickest {drawn[0]:.1f}, 9 of 10 below {drawn[9 * CHANGES // 10]:.1f}; asked {asked:g}); "
            f"all sent after {statistics.median(all_sent):.1f}, "
            f"{sum(size for _, size in listener.frames[before:]) / CHANGES / 1e3:.0f} kB a change"
        )
        server.stop()


if __name__ == "__main__":
    main()
