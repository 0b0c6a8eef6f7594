"""Which requests the studio's server answers: those of its own page, with the key in its address."""

from __future__ import annotations

import hmac
import ipaddress
import re
import secrets
import socket
from collections.abc import Mapping
from dataclasses import dataclass, field

#: Letters of the longest path behind the key: those of the page are some dozens.
LONGEST_PATH = 1_000

#: A `Host`: an address in brackets or a name, and perhaps a port.
_NETLOC = re.compile(r"(?:\[([0-9A-Fa-f:.%]+)\]|([^\s\[\]:@/?#]+))(?::[0-9]{0,5})?")

#: Random bytes of a key: 128 bits, which nobody guesses.
KEY_BYTES = 16

#: Sent with the page: no other page may show it in a frame, and none is given its address, nor a copy of it.
HEADERS: Mapping[str, str] = {
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
}


@dataclass(frozen=True)
class Guard:
    """Judges the requests to a server at the address `host`; `key` is the first part of their path.

    Another page in the same browser can send requests here, but not forge `Origin` and `Host`, and it does
    not know the key; nor does another program or person on this machine.

    >>> guard = Guard("127.0.0.1", "secret")
    >>> guard.path("/secret/", {"Host": ["127.0.0.1:8077"]})
    '/'
    >>> guard.path("/", {"Host": ["127.0.0.1:8077"]}) is None
    True
    """

    host: str
    key: str = field(default_factory=lambda: secrets.token_urlsafe(KEY_BYTES), repr=False)

    def path(self, path: str, headers: Mapping[str, list[str]]) -> str | None:
        """The path of a request behind the key; `None` for a request that is refused.

        `headers` are all values of `Host`, `Origin` and `Upgrade`, as far as they were sent. `Host` must be a
        name of this server, which the name of another page that was made to lead here is not. `Origin`, which
        a browser always sends where a socket is opened, must be the same as `Host`.
        """
        first, _, rest = path.partition("?")[0].removeprefix("/").partition("/")
        known = hmac.compare_digest(first.encode(), self.key.encode())
        hosts, origins = headers.get("Host", []), headers.get("Origin", [])
        opens_socket = any(value.strip().lower() == "websocket" for value in headers.get("Upgrade", []))
        own = len(hosts) == 1 and self._serves(hosts[0])
        same = origins == [f"http://{hosts[0]}"] if own and (origins or opens_socket) else own
        return f"/{rest}" if known and own and same and len(rest) <= LONGEST_PATH else None

    def _serves(self, netloc: str) -> bool:
        """Whether the `Host` of a request is a name of this server; its port may be that of a tunnel.

        A number is: only a name can be made to lead here by whoever owns it.
        """
        # urlsplit would drop what follows a bracket
        parts = _NETLOC.fullmatch(netloc)
        if parts is None:
            return False
        name = (parts[1] or parts[2]).lower()
        own = {"localhost", self.host.lower()}
        served = _address(self.host)
        if served is not None and served.is_unspecified:
            own |= {socket.gethostname().lower(), socket.getfqdn().lower()}
        return name in own or _address(name) is not None


def is_loopback(host: str) -> bool:
    """Whether an address is this machine's own alone."""
    address = _address(host)
    return host == "localhost" if address is None else address.is_loopback


def _address(name: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    """The address that a name writes as a number, if it is one."""
    try:
        return ipaddress.ip_address(name)
    except ValueError:
        return None
