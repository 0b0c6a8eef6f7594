"""A viser server that keeps to the address it was given, and says nothing of its own."""

from __future__ import annotations

import io
import socket
import warnings
from contextlib import redirect_stdout

import viser


class LocalServer(viser.ViserServer):
    """viser's server without its banner, and without its way through a tunnel into the internet."""

    def __init__(self, host: str, port: int) -> None:
        """Raises `OSError` for an address at which nothing can be served."""
        # viser would try a thousand ports, and then wait for ever
        with socket.create_server((host, 0), family=_family(host)):
            pass
        # a tab may be closed in the middle of a picture
        warnings.filterwarnings("ignore", "Queued a .* on a closed connection", UserWarning)
        with redirect_stdout(io.StringIO()):
            super().__init__(host=host, port=port, label="Sevenbar", verbose=False)

    def stop(self) -> None:
        """Ends it, without a word."""
        with redirect_stdout(io.StringIO()):
            super().stop()

    def request_share_url(self, verbose: bool = True) -> str | None:  # noqa: ARG002  viser's own signature
        """Nothing: a linkage leaves this machine only if its owner takes it away."""
        return None


def _family(host: str) -> socket.AddressFamily:
    return socket.AF_INET6 if ":" in host else socket.AF_INET
