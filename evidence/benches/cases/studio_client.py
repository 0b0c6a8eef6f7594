"""A client of the studio without a browser, which notes what comes and when."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

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

#: Longest time [s] that a frame is waited for; more, and it does not come.
LONGEST_WAIT = 30.0

#: What viser sends: messages by key, in which arrays are told by their places among the buffers.
Message = dict[str, Any]


def opened(address: str) -> Any:
    """A socket to the studio at its address, opened as its own page opens one."""
    from urllib.parse import urlsplit

    import viser
    from websockets.sync.client import connect

    protocol: Any = f"viser-v{viser.__version__}"
    origin: Any = f"http://{urlsplit(address).netloc}"
    there = address.replace("http://", "ws://").rstrip("/")
    return connect(there, subprotocols=[protocol], origin=origin, max_size=None, compression=None)


def unpacked(frame: bytes) -> tuple[list[Message], list[bytes]]:
    """The messages of a frame, and the buffers of their arrays."""
    import msgspec
    import zstandard

    place = 16 + int.from_bytes(frame[8:16], "little")
    content = msgspec.msgpack.decode(zstandard.decompress(frame[16:place]))
    buffers = []
    for length in content["binaryBufferLengths"]:
        place += -place % 8
        buffers.append(frame[place : place + length])
        place += length
    return content["messages"], buffers


def updates(frame: bytes) -> list[Message]:
    """What a frame changes of the controls that are there: properties by name, for each."""
    messages, _ = unpacked(frame)
    return [message["updates"] for message in messages if message["type"] == "GuiUpdateMessage"]


class Listener:
    """A client that notes what came, and when [s]: `frames`. It unpacks none before it is asked to."""

    def __init__(self, address: str) -> None:
        import msgspec

        self.frames = [(time.perf_counter(), b"")]
        self.socket = opened(address)
        self.socket.send(msgspec.msgpack.encode(CAMERA))
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        from websockets.exceptions import ConnectionClosed

        try:
            for frame in self.socket:
                self.frames.append((time.perf_counter(), bytes(frame)))
        except ConnectionClosed:
            pass

    def at_rest(self, quiet: float) -> None:
        """Waits until nothing has come for a while [s]."""
        while time.perf_counter() - self.frames[-1][0] < quiet:
            time.sleep(0.005)

    def first(self, begun: int, wanted: Callable[[bytes], bool]) -> float:
        """When [s] the first frame came that is wanted, of those from the number `begun` on.

        Waits for it; raises `TimeoutError` where it does not come.
        """
        end = time.perf_counter() + LONGEST_WAIT
        while time.perf_counter() < end:
            for when, frame in self.frames[begun:]:
                begun += 1
                if wanted(frame):
                    return when
            time.sleep(0.001)
        raise TimeoutError("a frame that the studio should send does not come")
