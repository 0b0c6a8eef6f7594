"""A viser server that keeps to its address, answers only its own page, and says nothing of its own."""

from __future__ import annotations

import dataclasses
import io
import logging
import socket
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from http import HTTPStatus
from typing import Any

import viser
import websockets.asyncio.server
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from sevenbar.studio.guard import HEADERS, Guard
from sevenbar.studio.messages import HeedfulConnection

#: What a request is refused with.
REFUSED = b"403: this address is answered only with the key that 'sevenbar studio' printed; open that one\n"

#: viser starts its server where nobody else can pass it a guard, so one is started at a time.
_STARTING = threading.Lock()


class LocalServer(viser.ViserServer):
    """viser's server without its banner, and without its way through a tunnel into the internet.

    It answers the requests that its `guard` lets pass, all others with 403.
    """

    def __init__(self, host: str, port: int) -> None:
        """Raises `OSError` for an address at which nothing can be served."""
        # viser would try a thousand ports, and then wait for ever
        with socket.create_server((host, 0), family=socket.AF_INET6 if ":" in host else socket.AF_INET):
            pass
        # a tab may be closed in the middle of a picture
        warnings.filterwarnings("ignore", "Queued a .* on a closed connection", UserWarning)
        self.guard = Guard(host)
        with redirect_stdout(io.StringIO()), _guarded(self.guard):
            super().__init__(host=host, port=port, label="Sevenbar", verbose=False)

    @property
    def address(self) -> str:
        """What to open in a browser: the key is a part of it."""
        # every address of this machine is no address to go to
        host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(self.get_host(), self.get_host())
        return f"http://{f'[{host}]' if ':' in host else host}:{self.get_port()}/{self.guard.key}/"

    def stop(self) -> None:
        """Ends it, without a word."""
        with redirect_stdout(io.StringIO()):
            super().stop()

    def request_share_url(self, verbose: bool = True) -> str | None:  # noqa: ARG002  viser's own signature
        """Nothing: a linkage leaves this machine only if its owner takes it away."""
        return None


@contextmanager
def _guarded(guard: Guard) -> Iterator[None]:
    """Lets the server that viser starts meanwhile judge every request by a guard, before viser sees it.

    viser takes no `process_request` of its callers, and has started by the end of its `__init__`. Raises
    `RuntimeError` where it started none that could be guarded, since all would be answered then.
    """
    serve, guarded = websockets.asyncio.server.serve, []

    def judged(*arguments: Any, process_request: Any, **settings: Any) -> Any:
        def first(connection: Any, request: Request) -> Response | None:
            values = {name: request.headers.get_all(name) for name in ("Host", "Origin", "Upgrade")}
            path = guard.path(request.path, values)
            if path is None:
                return _refusal()
            answer: Response | None = process_request(connection, dataclasses.replace(request, path=path))
            if answer is not None:
                answer.headers.update(HEADERS)
            return answer

        guarded.append(guard)
        # a scan of the port is no news for the terminal
        return serve(
            *arguments,
            process_request=first,
            create_connection=HeedfulConnection,
            logger=_silent(),
            **settings,
        )

    with _STARTING:
        websockets.asyncio.server.serve = judged  # type: ignore[assignment,misc]
        try:
            yield
        finally:
            websockets.asyncio.server.serve = serve  # type: ignore[misc]
    if not guarded:
        raise RuntimeError("viser serves in a way that the studio cannot guard; install viser 1.1")


def _refusal() -> Response:
    about = {"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(REFUSED))}
    status = HTTPStatus.FORBIDDEN
    return Response(status.value, status.phrase, Headers({**about, **HEADERS}), REFUSED)


def _silent() -> logging.Logger:
    logger = logging.getLogger("sevenbar.studio.requests")
    logger.propagate = False
    if not logger.handlers:
        logger.addHandler(logging.NullHandler())
    return logger
