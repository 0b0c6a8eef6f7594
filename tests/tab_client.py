"""A tab of the studio without a browser: it speaks viser's wire, keeps what it was sent, and works the controls."""

import threading
import time

import msgspec
import numpy as np
from websockets.exceptions import ConnectionClosed

from evidence.benches.cases.studio_client import CAMERA, opened, unpacked


class TabClient:
    """Connects to a studio's address; `gui` and `scene` hold the properties of all that was made there."""

    def __init__(self, address):
        self.gui, self.scene, self.values, self.told = {}, {}, {}, []
        self.owners, self.places = {}, {}
        self.received, self.last = 0, 0.0
        #: The thread of the studio that serves this tab, where a test has it: `until` waits for it.
        self.worker = None
        self._socket = opened(address)
        self._lock = threading.Lock()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self._send(CAMERA)

    def _send(self, message):
        self._socket.send(msgspec.msgpack.encode(message))

    def _read(self):
        try:
            for frame in self._socket:
                self._take(frame)
                self.received += len(frame)
                self.last = time.perf_counter()
        except ConnectionClosed:
            pass

    def _take(self, frame):
        messages, buffers = unpacked(frame)
        with self._lock:
            for message in messages:
                self._apply({key: _whole(value, buffers) for key, value in message.items()})

    def _apply(self, message):
        match message["type"]:
            case "GuiUpdateMessage":
                updates = dict(message["updates"])
                if "value" in updates:
                    self.values[message["uuid"]] = updates.pop("value")
                self.gui.get(message["uuid"], {}).update(updates)
            case "GuiRemoveMessage":
                self.gui.pop(message["uuid"], None)
            case "SceneNodeUpdateMessage":
                self.scene.get(message["name"], {}).update(message["updates"])
            case "RemoveSceneNodeMessage":
                self.scene.pop(message["name"], None)
            case "NotificationShowMessage":
                self.told.append(message)
            case kind if kind.startswith("Gui") and "uuid" in message and "props" in message:
                self.gui[message["uuid"]] = {"kind": kind, **message["props"]}
                if "value" in message:
                    self.values[message["uuid"]] = message["value"]
            case _ if "name" in message and "props" in message:
                self.scene[message["name"]] = dict(message["props"])
                self.owners[message["name"]] = message.get("owner", "")
            case "SetPositionMessage":
                self.places[message["name"]] = np.array(message["position"])

    def settled(self, quiet=0.15, limit=600.0):
        """Waits until nothing has come for a while [s] from now on."""
        start = time.perf_counter()
        while time.perf_counter() < start + limit:
            if self.received and time.perf_counter() - max(self.last, start) > quiet:
                return self
            time.sleep(0.01)
        raise AssertionError("the studio does not come to rest")

    def until(self, holds, limit=600.0):
        """Waits until something holds of what was sent, the studio has drawn it, and nothing more comes."""
        end = time.perf_counter() + limit
        while not holds():
            assert time.perf_counter() < end, "it does not come to this"
            time.sleep(0.02)
        if self.worker is not None:
            done(self.worker, lambda: None)
        return self.settled()

    def find(self, label, kind=""):
        """The uuids of the controls with a label, in the order in which they were made."""
        with self._lock:
            return [u for u, p in self.gui.items() if p.get("label") == label and kind in p["kind"]]

    def value(self, label, kind=""):
        """The value of the first control with a label."""
        return self.values[self.find(label, kind)[0]]

    def put(self, label, value, kind="", which=0):
        """Gives a control a value, as a person does."""
        self.write(self.find(label, kind)[which], value)

    def write(self, uuid, value):
        """The same for a control known by its uuid."""
        self.values[uuid] = value
        self._send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}})

    def click(self, label):
        """Clicks a button."""
        self._send({"type": "GuiUpdateMessage", "uuid": self.find(label)[0], "updates": {"value": True}})

    def pull(self, key, *places):
        """Pulls a handle of the scene to places in it, one after another, and lets it go."""
        with self._lock:
            own = self.owners[f"/handles/{key}"]
        name = {"name": f"/handles/{key}", "owner": own}
        self._send({"type": "TransformControlsDragStartMessage"} | name)
        for place in places:
            where = {"wxyz": (1.0, 0.0, 0.0, 0.0), "position": tuple(map(float, place))}
            self._send({"type": "TransformControlsUpdateMessage"} | name | where)
        self._send({"type": "TransformControlsDragEndMessage"} | name)

    def html(self):
        """All HTML that is on the page, the visible pieces alone."""
        with self._lock:
            return "\n".join(
                p["content"] for p in self.gui.values() if p["kind"] == "GuiHtmlMessage" and p["visible"]
            )

    def close(self):
        """Leaves, as a tab that is closed."""
        self._socket.close()
        self._reader.join(timeout=60)


def done(worker, action):
    """What an action gives that is done by a tab's own thread, after all that was asked of it before."""
    found, ready = [], threading.Event()

    def act():
        try:
            found.append(action())
        except Exception as error:
            found.append(error)
        ready.set()

    worker.ask(object(), act)
    assert ready.wait(600)
    if isinstance(found[0], Exception):
        raise found[0]
    return found[0]


def _whole(value, buffers):
    """A value with its arrays in place."""
    if isinstance(value, dict):
        if "__binary_index" in value:
            return np.frombuffer(buffers[value["__binary_index"]], dtype=value["dtype"])
        return {key: _whole(each, buffers) for key, each in value.items()}
    if isinstance(value, list):
        return [_whole(each, buffers) for each in value]
    return value
