"""What the panels share: how a control is set, and how a mistake is shown below it."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from html import escape
from typing import Any, Protocol

import viser

from sevenbar.errors import SevenbarError

#: What stands in a box is taken so long [s] after the last key.
PAUSE = 0.8


class Asked(Protocol):
    """The worker, as the panels know it."""

    def ask(self, key: Hashable, action: Callable[[], object], *, delay: float = 0.0) -> None:
        """Has an action done, after a delay [s]; it takes the place of one with the same key."""

    def awaits(self, key: Hashable) -> bool:
        """Whether an action with this key is still to be done."""


def put(control: Any, value: object) -> None:
    """Sets a control's value."""
    control.value = value


def offer(control: Any, choices: tuple[str, ...]) -> None:
    """Sets what can be chosen; what is offered already is not sent to the page again."""
    if control.options != choices:
        control.options = choices


def by_person(event: viser.GuiEvent[Any]) -> bool:
    """Whether a person changed a control, and not the studio itself."""
    return event.client is not None


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
