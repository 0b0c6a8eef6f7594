"""What the panels share: how a control is set, and how a mistake is shown below it."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from html import escape
from typing import Any

import viser

from sevenbar.errors import SevenbarError
from sevenbar.studio.worker import Worker

#: What stands in a box is taken so long [s] after the last key.
PAUSE = 0.8


def put(control: Any, value: object) -> None:
    """Sets a control's value, which viser's types have as read only."""
    control.value = value


def settle(control: Any, **properties: object) -> None:
    """Sets properties that are not so already: viser takes long to find that nothing is new."""
    for name, value in properties.items():
        if getattr(control, name) != value:
            setattr(control, name, value)


def by_person(event: viser.GuiEvent[Any]) -> bool:
    """Whether a person changed a control, and not the studio itself."""
    return event.client is not None


def on_change(
    control: Any, worker: Worker, key: Hashable, action: Callable[[Any], object], *, delay: float = 0.0
) -> None:
    """Has `action(value)` done, after a delay [s], for what a person sets a control to; the last alone."""

    # a coroutine is run where the value arrives: a function would wait for a thread, and until it has one
    # the worker, which knows of no change, would set the control back
    async def changed(event: viser.GuiEvent[Any]) -> None:
        if by_person(event):
            value = control.value
            worker.ask(key, lambda: action(value), delay=delay)

    control.on_update(changed)


class Alert:
    """A line below a control that says what is wrong with its value."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._line = gui.add_html("", visible=False)

    def tried(self, action: Callable[[], object]) -> bool:
        """Whether an action went well; a mistake in what it was given is shown here until the next try."""
        try:
            action()
        except SevenbarError as error:
            self.tell(str(error))
            return False
        self.clear()
        return True

    def tell(self, message: str) -> None:
        """Shows a message."""
        self._line.content = (
            '<div role="alert" style="color:#b3261e;font-size:12px;line-height:1.35;padding:0 12px 8px;'
            f'white-space:pre-line">{escape(message)}</div>'
        )
        self._line.visible = True

    def clear(self) -> None:
        """Takes the line away."""
        self._line.visible = False
