"""The studio answers its own page, opened with its key, and nobody else."""

import http.client
import socket
import threading
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import urlsplit

import pytest
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from browser import person
from sevenbar.description.files import toml_text
from sevenbar.studio.guard import Guard
from sevenbar.studio.server import StudioServer
from tab_client import TabClient

KEY = "the-key"


@pytest.fixture(scope="module")
def served():
    server = StudioServer(toml_text("rssr"), "rssr", "127.0.0.1", 0)
    yield server
    server.stop()


def fetched(address, path=None, method="GET", **headers):
    """Status, headers and body of an answer to a request with exactly these headers beside Host."""
    parts = urlsplit(address)
    one = http.client.HTTPConnection(parts.hostname, parts.port, timeout=600)
    one.putrequest(method, parts.path if path is None else path, skip_host="Host" in headers)
    for name, value in headers.items():
        for each in value if isinstance(value, list) else [value]:
            one.putheader(name, each)
    one.endheaders()
    answer = one.getresponse()
    found = answer.status, dict(answer.getheaders()), answer.read()
    one.close()
    return found


def socket_status(address, path=None, **given):
    """The status with which a socket is opened; 101 where it is."""
    parts = urlsplit(address)
    url = f"ws://{parts.netloc}{parts.path.rstrip('/') if path is None else path}"
    version = f"viser-v{viser.__version__}"
    settings = {"origin": f"http://{parts.netloc}"} | given
    try:
        with connect(url, subprotocols=[version], compression=None, **settings):
            return 101
    except InvalidStatus as refused:
        return refused.response.status_code


def test_the_page_is_served_at_the_address_with_its_key_and_may_not_be_framed(served):
    status, headers, page = fetched(served.address)
    assert (status, headers["Content-Type"].partition(";")[0]) == (200, "text/html")
    assert b"<title>Viser</title>" in page
    assert headers["Content-Security-Policy"] == "frame-ancestors 'none'"
    assert headers["Referrer-Policy"] == "no-referrer"
    assert headers["Cache-Control"] == "no-store"
    parts = urlsplit(served.address)
    same = f"http://{parts.netloc}"
    assert fetched(served.address, Origin=same)[0] == 200
    # through a tunnel that has another port at its near end
    assert fetched(served.address, Host="localhost:9000", Origin="http://localhost:9000")[0] == 200
    assert fetched(served.address, path=f"{parts.path}?websocket=x")[0] == 200
    assert fetched(served.address, path=f"{parts.path}nothing.js")[0] == 404
    assert fetched(served.address, path=f"{parts.path}../../../etc/passwd")[0] == 404


@pytest.mark.parametrize(
    "path", ["/", "", "/index.html", "/wrong/", "/wrong", "//", "/{key}x/", "/%s/" % ("a" * 22)]
)
def test_without_the_key_nothing_is_answered(served, path):
    key = urlsplit(served.address).path.strip("/")
    status, _, body = fetched(served.address, path=path.replace("{key}", key) or "/")
    assert status == 403
    assert b"answered only with the key that 'sevenbar studio' printed" in body
    assert key.encode() not in body
    assert socket_status(served.address, path=path.replace("{key}", key)) == 403


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "null",
        "http://localhost:1",
        "https://{netloc}",
        "http://{netloc}.evil.example",
        "http://{host}:1",
        "http://{host}",
        "file://",
    ],
)
def test_another_page_is_refused_even_with_the_key(served, origin):
    parts = urlsplit(served.address)
    origin = origin.format(netloc=parts.netloc, host=parts.hostname)
    assert socket_status(served.address, origin=origin) == 403
    assert fetched(served.address, Origin=origin)[0] == 403


def test_a_socket_without_an_origin_is_refused_and_that_of_the_page_is_opened(served):
    assert socket_status(served.address, origin=None) == 403
    assert socket_status(served.address) == 101
    parts = urlsplit(served.address)
    two = [f"http://{parts.netloc}", "http://evil.example"]
    assert fetched(served.address, Origin=two)[0] == 403


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:80", "127.0.0.1.evil.example", "localhost.evil.example", "", "a b",
             "127.0.0.1:x", "x@127.0.0.1", "[::1", "127.0.0.1/", "[::1].evil.com", "[::1]x:80", "[::1]@evil.com", ["127.0.0.1", "evil.example"]],
)  # fmt: skip
def test_a_name_that_was_made_to_lead_here_is_refused(served, host):
    # the page of evil.example, whose name now leads to 127.0.0.1, is of the same origin as what it asks for
    origin = f"http://{host}" if isinstance(host, str) else "http://evil.example"
    assert fetched(served.address, Host=host)[0] == 403
    assert (
        fetched(served.address, Host=host, Origin=origin, Upgrade="websocket", Connection="Upgrade")[0] == 403
    )


def test_nothing_that_is_refused_makes_a_tab(served):
    before = served.tabs
    for _ in range(3):
        assert socket_status(served.address, origin="http://evil.example") == 403
    assert served.tabs == before
    tab = TabClient(served.address)
    try:
        tab.until(lambda: len(served.tabs) == len(before) + 1)
    finally:
        tab.close()


def test_every_server_has_a_key_of_its_own_that_is_compared_whole():
    keys = {Guard("127.0.0.1").key for _ in range(100)}
    assert len(keys) == 100
    assert {len(key) for key in keys} == {22}
    guard, own = Guard("127.0.0.1", KEY), {"Host": ["127.0.0.1:1"]}
    assert guard.path(f"/{KEY}", own) == "/"
    assert guard.path(f"/{KEY}/a/b?c", own) == "/a/b"
    for wrong in (KEY[:-1], f"{KEY}x", KEY.upper(), "", "clé"):
        assert guard.path(f"/{wrong}/", own) is None, wrong
    assert KEY not in repr(guard)


@pytest.mark.parametrize(
    ("host", "own", "others"),
    [
        ("127.0.0.1", ["127.0.0.1", "localhost", "[::1]"], ["evil.example", socket.gethostname() + ".x"]),
        ("::1", ["[::1]", "localhost"], ["evil.example"]),
        ("0.0.0.0", ["192.0.2.7", socket.gethostname(), "localhost"], ["evil.example"]),
        ("box.lan", ["box.lan", "BOX.LAN", "192.0.2.7"], ["evil.example", "lan"]),
    ],
)
def test_the_names_of_a_server_are_its_address_numbers_and_localhost(host, own, others):
    guard = Guard(host, KEY)
    for name in own:
        assert guard.path(f"/{KEY}/", {"Host": [f"{name}:8077"]}) == "/", name
    for name in (*others, "[::1].evil.com", "[::1]evil.com", "127.0.0.1.evil.com", "[evil.com]"):
        assert guard.path(f"/{KEY}/", {"Host": [f"{name}:8077"]}) is None, name
        assert guard.path(f"/{KEY}/", {"Host": [name]}) is None, name
    assert guard.path(f"/{KEY}/{'a' * 5_000}", {"Host": ["localhost:1"]}) is None


def test_what_is_no_request_leaves_the_terminal_quiet_and_the_server_up(served, capfd):
    parts = urlsplit(served.address)
    for sent in (b"", b"\0\1\2\r\n\r\n", b"POST / HTTP/1.1\r\nHost: x\r\n\r\n", b"GET / HTTP/1.1\r\n\r\n"):
        with socket.create_connection((parts.hostname, parts.port), timeout=600) as one:
            one.sendall(sent)
            one.shutdown(socket.SHUT_WR)
            while one.recv(4096):
                pass
    assert fetched(served.address)[0] == 200
    assert capfd.readouterr() == ("", "")


def test_viser_is_left_as_it_was(served):  # noqa: ARG001
    # another program's server in this process is none of the studio's
    from websockets.asyncio import server

    assert server.serve.__module__ == "websockets.asyncio.server"


PAGE = b"""<!doctype html><title>another page</title><script>
function tried(url) {
  return new Promise(done => {
    const socket = new WebSocket(url, [PROTOCOL]);
    socket.onopen = () => done("open");
    socket.onerror = () => done("refused");
  });
}
async function read(url) {
  try { return (await fetch(url)).status; } catch { return "refused"; }
}
</script>"""


class _Another(BaseHTTPRequestHandler):
    """Another page of the same browser, at another port of this machine."""

    def do_GET(self):
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(PAGE.replace(b"PROTOCOL", f'"viser-v{viser.__version__}"'.encode()))

    def log_message(self, *_):
        pass


def test_a_page_of_another_origin_gets_no_socket_and_no_answer(chromium, studio):
    one = studio("rssr")
    other = ThreadingHTTPServer(("127.0.0.1", 0), _Another)
    threading.Thread(target=partial(other.serve_forever, 0.05), daemon=True).start()
    context = person(chromium)
    page = context.new_page()
    try:
        page.goto(f"http://127.0.0.1:{other.server_port}/")
        there = one.url.replace("http://", "ws://").rstrip("/")
        bare = there.rpartition("/")[0]
        # with the key, which it does not know, and without
        assert page.evaluate("url => tried(url)", there) == "refused"
        assert page.evaluate("url => tried(url)", bare) == "refused"
        assert page.evaluate("url => read(url)", one.url) == "refused"
        # nor is the page shown within another, where it could be clicked unseen
        page.evaluate(
            "url => { const f = document.createElement('iframe'); f.src = url; document.body.append(f); }",
            one.url,
        )
        page.wait_for_timeout(1500)
        assert not any("127.0.0.1" in frame.url and frame.url.startswith(one.url) for frame in page.frames)
        # the studio's own page opens its socket by the same words
        page.goto(one.url)
        page.locator(".tabler-icon-cloud-check").filter(visible=True).wait_for()
        assert page.locator("canvas").count()
    finally:
        context.close()
        other.shutdown()
        other.server_close()
