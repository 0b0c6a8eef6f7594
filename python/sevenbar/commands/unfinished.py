"""How a command ends whose search Ctrl+C stopped, once what it had is delivered."""

from __future__ import annotations

import typer

from sevenbar.commands.progress import STOPPED


def end_of_work(unfinished: str) -> None:
    """Ends a command as Ctrl+C does where what was delivered is `unfinished`."""
    if unfinished:
        raise typer.Exit(STOPPED)
