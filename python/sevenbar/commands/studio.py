"""The command `sevenbar studio`."""

from __future__ import annotations

import importlib.util
import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from sevenbar.commands import options
from sevenbar.commands.given import agreed
from sevenbar.commands.signals import CTRL_C, stopped
from sevenbar.description.files import toml_text
from sevenbar.errors import MissingExtraError, RequestError
from sevenbar.text.paths import is_file

#: Where the studio is served by default.
HOST, PORT = "127.0.0.1", 8077


def studio(
    linkage: options.Opened = "rssr",
    host: Annotated[
        str, typer.Option(help="Address to serve at; another than 127.0.0.1 lets other machines in.")
    ] = HOST,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port; the next free one where it is taken, 0 for any.")
    ] = PORT,
    open_browser: Annotated[
        bool, typer.Option("--open/--no-open", help="Whether to open the page in the browser.")
    ] = True,
    agree: options.Agree = None,
) -> None:
    """Shape a linkage in the browser and see it move (extra 'studio'); Ctrl+C ends it."""
    text, error_taken = toml_text(linkage), agreed(agree)
    for name in ("viser", "tomlkit"):
        if importlib.util.find_spec(name) is None:
            raise MissingExtraError(f"studio needs {name}; install it with: pip install 'sevenbar[studio]'")
    from sevenbar.studio.guard import is_loopback
    from sevenbar.studio.server import StudioServer

    # the folder of the file that was opened, else that in which the command was called
    folder = Path(linkage).resolve().parent if is_file(linkage) else Path.cwd()
    try:
        server = StudioServer(text, linkage, host, port, folder, agree=error_taken)
    except OSError as error:
        reason = (error.strerror or str(error)).lower().partition(" (")[0]
        raise RequestError(
            f"--host, --port: cannot serve at {host}:{port}: {reason}; give another address"
        ) from None
    try:
        if not is_loopback(host):
            typer.echo(
                f"served at {host}, over the network: whoever has the address printed here can see and "
                "change what is open; it is sent unencrypted",
                err=True,
            )
        typer.echo(f"the studio is at {server.address} (Ctrl+C ends it)")
        if open_browser:
            webbrowser.open(server.address)
        server.wait()
    finally:
        server.stop()
    if (code := stopped()) != CTRL_C:
        raise typer.Exit(code)
