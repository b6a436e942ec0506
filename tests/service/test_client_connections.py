"""Large bodies of the client: connections that are used again, and those that the server has closed meanwhile."""

from __future__ import annotations

from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from ssl import CERT_REQUIRED, SSLContext
from threading import Thread
from typing import ClassVar

import httpx2
import pytest

from substructures.client import bulk
from substructures.client.bulk import Bulk, read_all
from substructures.client.connection import _trust


class _Echo(BaseHTTPRequestHandler):
    """Answers with what was sent; closes behind ``close``, and answers nothing at all to ``lost``.

    ``once`` is only answered by a connection on which nothing was asked before.
    """

    protocol_version = "HTTP/1.1"
    ports: ClassVar[list[int]] = []

    def do_POST(self) -> None:
        is_first = self.client_address[1] not in self.ports
        self.ports.append(self.client_address[1])
        body = self.rfile.read(int(self.headers["Content-Length"]))
        is_lost = body == b"lost" or (body == b"once" and not is_first)
        self.close_connection = body == b"close" or is_lost
        if is_lost:
            return
        self.send_response(200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: object) -> None:
        """Nothing."""


@pytest.fixture
def connections() -> Iterator[Bulk]:
    _Echo.ports = []
    server = ThreadingHTTPServer(("127.0.0.1", 0), _Echo)
    thread = Thread(target=server.serve_forever, daemon=True)
    thread.start()
    found = Bulk(f"http://127.0.0.1:{server.server_port}", 10)
    yield found
    found.close()
    server.shutdown()
    server.server_close()


def ask(connections: Bulk, body: bytes, read: bool = True, is_repeatable: bool = True) -> bytes:
    headers = {"Content-Length": str(len(body))}
    with connections.transfer("/", [body], headers, is_repeatable=is_repeatable) as answer:
        return bytes(read_all(answer)) if read else b""


def test_one_connection_serves_many_requests(connections: Bulk) -> None:
    assert [ask(connections, b"%d" % k) for k in range(4)] == [b"0", b"1", b"2", b"3"]
    assert len(set(_Echo.ports)) == 1


def test_after_the_server_has_closed_it_there_is_a_new_one(connections: Bulk) -> None:
    assert [ask(connections, x) for x in (b"close", b"again")] == [b"close", b"again"]
    assert len(set(_Echo.ports)) == 2


def test_what_a_kept_connection_does_not_answer_is_asked_once_more(connections: Bulk) -> None:
    assert [ask(connections, x) for x in (b"one", b"once")] == [b"one", b"once"]
    assert len(set(_Echo.ports)) == 2


def test_what_may_not_be_sent_twice_takes_a_new_connection(connections: Bulk) -> None:
    ask(connections, b"one")
    ask(connections, b"two", is_repeatable=False)
    assert len(set(_Echo.ports)) == 2
    with pytest.raises(httpx2.HTTPError):
        ask(connections, b"lost", is_repeatable=False)
    assert len(_Echo.ports) == 3


def test_an_answer_that_was_not_read_is_not_taken_for_the_next(connections: Bulk) -> None:
    ask(connections, b"first", read=False)
    assert ask(connections, b"second") == b"second"


def test_connections_are_not_used_after_a_while(connections: Bulk, monkeypatch: pytest.MonkeyPatch) -> None:
    ask(connections, b"one")
    monkeypatch.setattr(bulk, "KEPT", 0.0)
    ask(connections, b"two")
    assert len(set(_Echo.ports)) == 2


def test_an_answer_that_never_comes(connections: Bulk) -> None:
    ask(connections, b"one")
    with pytest.raises(httpx2.HTTPError):
        ask(connections, b"lost")
    assert ask(connections, b"two") == b"two"


def test_who_is_believed_is_read_for_https_alone() -> None:
    trusted = _trust("http://localhost:8000")
    assert isinstance(trusted, SSLContext)
    assert (trusted.get_ca_certs(), trusted.verify_mode, trusted.check_hostname) == ([], CERT_REQUIRED, True)
    assert _trust("https://localhost") is True
