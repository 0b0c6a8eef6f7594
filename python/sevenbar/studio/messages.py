"""Which messages of a page are heeded: those that the studio's own page sends, with values that fit."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import msgspec
import viser
from viser import _messages
from websockets.asyncio.server import ServerConnection

#: Letters of the longest text in a box: a list of joints has some hundreds.
LONGEST_TEXT = 10_000

#: Greatest size of a number in a message: beyond any length and any count of bytes.
LARGEST = 1e15

#: Most pixels of a window's edge.
MOST_PIXELS = 100_000

Check = Callable[[Any], bool]


def _is_number(value: Any) -> bool:
    # of a truth value there is a box of its own; NaN is not below anything
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < LARGEST


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= LONGEST_TEXT


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and _is_number(value) and value >= 0


def _is_edge(value: Any) -> bool:
    return _is_number(value) and 1 <= value <= MOST_PIXELS


def _is_positive(value: Any) -> bool:
    return _is_number(value) and value > 0


def _numbers(count: int) -> Check:
    return lambda value: isinstance(value, list) and len(value) == count and all(map(_is_number, value))


def _is_turn(value: Any) -> bool:
    return _numbers(4)(value) and math.hypot(*value) > 0


def _is_bytes(value: Any) -> bool:
    return isinstance(value, bytes)


def _is_value(value: Any) -> bool:
    # other properties of a control are the studio's own, as are all its other attributes
    return isinstance(value, dict) and list(value) == ["value"]


#: A handle in the scene; its owner is the tab.
_HANDLE: Mapping[str, Check] = {"name": _is_text, "owner": _is_text}

#: The messages that the page sends, and what each of their fields must be.
MESSAGES: Mapping[str, Mapping[str, Check]] = {
    "ViewerCameraMessage": {
        "wxyz": _is_turn,
        "position": _numbers(3),
        "fov": _is_positive,
        "near": _is_number,
        "far": _is_number,
        "image_height": _is_edge,
        "image_width": _is_edge,
        "look_at": _numbers(3),
        "up_direction": _numbers(3),
    },
    "GuiUpdateMessage": {"uuid": _is_text, "updates": _is_value},
    "CommandTriggerMessage": {"uuid": _is_text},
    "FileTransferStartUpload": {
        "source_component_uuid": _is_text,
        "transfer_uuid": _is_text,
        "filename": _is_text,
        "mime_type": _is_text,
        "part_count": _is_count,
        "size_bytes": _is_count,
    },
    "FileTransferPart": {
        "source_component_uuid": _is_text,
        "transfer_uuid": _is_text,
        "part_index": _is_count,
        "content": _is_bytes,
    },
    "TransformControlsUpdateMessage": {**_HANDLE, "wxyz": _is_turn, "position": _numbers(3)},
    "TransformControlsDragStartMessage": _HANDLE,
    "TransformControlsDragEndMessage": _HANDLE,
}


def is_heeded(raw: bytes | str) -> bool:
    """Whether a message is one that the page sends, whole and of the right kinds."""
    if not isinstance(raw, bytes):
        return False
    try:
        message = msgspec.msgpack.decode(raw)
    except (msgspec.DecodeError, RecursionError, ValueError):
        return False
    if not isinstance(message, dict) or not isinstance(message.get("type"), str):
        return False
    checks = MESSAGES.get(message.pop("type"))
    return (
        checks is not None
        and message.keys() == checks.keys()
        and all(check(message[name]) for name, check in checks.items())
    )


class HeedfulConnection(ServerConnection):
    """A connection to a page from which only messages come that are heeded; others are nothing at all."""

    async def recv(self, decode: bool | None = None) -> Any:
        """The next message that is heeded."""
        while True:
            raw = await super().recv(decode)
            if is_heeded(raw):
                return raw


def fits(control: Any, value: Any) -> bool:
    """Whether a control of the page can take a value."""
    if isinstance(control, (viser.GuiDropdownHandle, viser.GuiButtonGroupHandle)):
        return isinstance(value, str) and value in control.options
    now = control.value
    if isinstance(now, bool):
        return isinstance(value, bool)
    if isinstance(now, (int, float)):
        return _is_number(value)
    if isinstance(now, str):
        return _is_text(value)
    return isinstance(now, tuple) and _numbers(len(now))(value)


def heed_values_that_fit(client: viser.ClientHandle) -> None:
    """Has only values reach the controls of a tab that they can take: viser would cast them, or raise."""
    gui = client.gui
    connection, passed_on = gui._websock_interface, gui._handle_gui_updates
    controls = gui._gui_input_handle_from_uuid

    async def update(client_id: Any, message: _messages.GuiUpdateMessage) -> None:
        control = controls.get(message.uuid)
        if control is not None and fits(control, message.updates["value"]):
            await passed_on(client_id, message)

    connection.unregister_handler(_messages.GuiUpdateMessage, passed_on)
    connection.register_handler(_messages.GuiUpdateMessage, update)
