"""The studio's server: one session for each tab, on this machine only unless another address is asked for."""

from __future__ import annotations

import threading
import time
from contextlib import suppress
from pathlib import Path

import viser

from sevenbar.description.files import decoded
from sevenbar.errors import SevenbarError
from sevenbar.studio.guard import is_loopback
from sevenbar.studio.local_server import LocalServer
from sevenbar.studio.messages import heed_values_that_fit
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.shelf import Shelf
from sevenbar.studio.tab import Tab
from sevenbar.text.paths import is_file

#: How often [s] a server that waits looks whether it is to end.
GLANCE = 0.25


class StudioServer:
    """Serves a linkage to browsers; every tab begins with it as it was given, or as its file has it."""

    def __init__(
        self,
        text: str,
        source: str,
        host: str,
        port: int,
        folder: Path | None = None,
        *,
        agree: float | None = None,
    ) -> None:
        """`text` is TOML, `source` its name, or the path of its file.

        Tabs may save to the files of `folder`, if one is given and nobody else can reach the server.
        Redundant constraints `agree` up to a closure error, if one is given. Raises `DescriptionError`;
        `OSError` for a bad address.
        """
        self._source, self._agree = source, agree
        self._session(text)  # before anything is served
        self._folder = folder if is_loopback(host) else None
        self._server = LocalServer(host, port)
        self._text = text
        self._tabs: dict[int, Tab] = {}
        self._lock = threading.Lock()
        self._server.on_client_connect(self._connected)
        self._server.on_client_disconnect(self._disconnected)

    @property
    def address(self) -> str:
        """What to open in a browser."""
        return self._server.address

    @property
    def tabs(self) -> tuple[Tab, ...]:
        """The tabs that are open."""
        with self._lock:
            return tuple(self._tabs.values())

    def _connected(self, client: viser.ClientHandle) -> None:
        heed_values_that_fit(client)
        tab = Tab(client, *self._started())
        with self._lock:
            self._tabs[client.client_id] = tab
        tab.start()
        if client.client_id not in self._server.get_clients():  # left while all this was made
            self._left(client)

    def _started(self) -> tuple[Session, Shelf | None]:
        """What a tab begins with; a file that was saved, or changed, since is read anew if it can be."""
        shelf = None if self._folder is None else Shelf(self._folder)
        if shelf is not None and is_file(self._source):
            try:
                content = shelf.read(Path(self._source))
                return self._session(decoded(content, self._source)), shelf
            except (OSError, SevenbarError):
                shelf = Shelf(shelf.folder)
        return self._session(self._text), shelf

    def _session(self, text: str) -> Session:
        return Session(text, self._source, agree=self._agree)

    async def _disconnected(self, client: viser.ClientHandle) -> None:
        # awaited by viser, where a plain function would be given to threads that `stop` has ended
        self._left(client)

    def _left(self, client: viser.ClientHandle) -> None:
        with self._lock:
            tab = self._tabs.pop(client.client_id, None)
        if tab is not None:
            tab.end()

    def stop(self) -> None:
        """Ends the server and all tabs."""
        with self._lock:
            for tab in self._tabs.values():
                tab.end()
        self._server.stop()

    def wait(self) -> None:
        """Serves until it is interrupted by Ctrl+C."""
        with suppress(KeyboardInterrupt):
            while True:
                # the signal may reach another thread, which a wait without end would not notice
                time.sleep(GLANCE)
