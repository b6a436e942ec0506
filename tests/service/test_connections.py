"""Connections: bounded in number, time and bytes, answered in one form, and none of them in the way of others."""

from __future__ import annotations

import errno
import json
import os
import socket
import subprocess
import sys
from asyncio import new_event_loop
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from threading import Event, Semaphore
from time import monotonic, sleep
from typing import Any

import pytest

from service.database.connections import Database
from service.http.authority import network_of
from service.http.connections import Complaints, Connection
from service.server import background
from service.settings import Limits, Settings

QUICK = {"head_seconds": 0.9, "body_seconds": 0.9, "answer_seconds": 0.9}
HOST = b"Host: localhost\r\n"
POST = b"POST /v1/substructures HTTP/1.1\r\n" + HOST + b"Content-Type: application/json\r\n"


OPEN: list[socket.socket] = []


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    yield
    close()


def close() -> None:
    """Close what a test has opened."""
    while OPEN:
        OPEN.pop().close()


@contextmanager
def serving(folder: Path, **limits: Any) -> Iterator[int]:
    """The port of a server with these limits."""
    settings = Settings(
        database=f"sqlite:///{folder}/store.db", catalogue=False, engine="none", limits=Limits.model_validate(limits)
    )
    with background(settings) as address:
        yield int(address.rpartition(":")[2])
        close()  # the server waits for requests that were begun


def sent(port: int, text: bytes) -> socket.socket:
    connection = socket.create_connection(("127.0.0.1", port), timeout=20)
    OPEN.append(connection)
    connection.sendall(text)
    return connection


def heard(connection: socket.socket) -> bytes:
    """What the server says until it closes."""
    found = b""
    try:
        while piece := connection.recv(2**16):
            found += piece
    except ConnectionResetError:
        pass
    return found


def asked(port: int, text: bytes = b"GET /livez HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n") -> bytes:
    return heard(sent(port, text))


def problem(answer: bytes) -> tuple[int, str]:
    """Status and code of a problem document, which is the only thing that was said."""
    head, _, body = answer.partition(b"\r\n\r\n")
    lines = [line.lower() for line in head.split(b"\r\n")]
    assert b"content-type: application/problem+json" in lines, answer
    assert b"connection: close" in lines
    found = json.loads(body)
    assert any(line == b"x-request-id: " + found["request_id"].encode() for line in lines)
    assert int(lines[0].split()[1]) == found["status"]
    return found["status"], found["code"]


BROKEN = {
    "no request": (b"\x16\x03\x01\x02\x00\x01\x00", 400, "invalid-http"),
    "no method": (b"BREW / HTTP/1.1\r\n" + HOST + b"\r\n", 400, "invalid-http"),
    "no colon": (b"GET / HTTP/1.1\r\nHost localhost\r\n\r\n", 400, "invalid-http"),
    "version": (b"GET /livez HTTP/3.7\r\n" + HOST + b"\r\n", 400, "invalid-http"),
    "two lengths": (POST + b"Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n", 400, "invalid-http"),
    "bad chunk": (POST + b"Transfer-Encoding: chunked\r\n\r\nzz\r\n", 400, "invalid-http"),
    "proxy": (b"CONNECT a:80 HTTP/1.1\r\n" + HOST + b"\r\n", 405, "method-not-allowed"),
    "another host": (b"GET http://evil.com/livez HTTP/1.1\r\n" + HOST + b"\r\n", 400, "invalid-host"),
    "credentials": (b"GET http://localhost@evil.com/livez HTTP/1.1\r\n" + HOST + b"\r\n", 400, "invalid-host"),
    "another scheme": (b"GET ftp://localhost/livez HTTP/1.1\r\n" + HOST + b"\r\n", 400, "invalid-host"),
    "no path": (b"GET *x HTTP/1.1\r\n" + HOST + b"\r\n", 400, "invalid-host"),
    "two hosts, one address": (
        b"GET http://localhost/livez HTTP/1.1\r\n" + 2 * HOST + b"\r\n",
        400,
        "invalid-host",
    ),
    "very long url": (b"GET /" + b"a" * 70_000 + b" HTTP/1.1\r\n" + HOST + b"\r\n", 414, "url-too-long"),
    "long head": (b"GET / HTTP/1.1\r\nA: " + b"a" * 70_000 + b"\r\n\r\n", 431, "head-too-large"),
    "endless head": (b"GET / HTTP/1.1\r\nA: " + b"a" * 700_000, 431, "head-too-large"),
    "endless chunk line": (POST + b"Transfer-Encoding: chunked\r\n\r\n1;" + b"a" * 700_000, 431, "head-too-large"),
    "endless trailer": (
        POST + b"Transfer-Encoding: chunked\r\n\r\n0\r\nA: " + b"a" * 700_000,
        431,
        "head-too-large",
    ),
}


def test_what_is_no_request_gets_a_problem_document(tmp_path: Path) -> None:
    with serving(tmp_path) as port:
        for what, (text, status, code) in BROKEN.items():
            assert problem(asked(port, text)) == (status, code), what
        trace = asked(port, b"TRACE / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        assert problem(trace) == (405, "method-not-allowed")
        for address in (b"http://localhost/livez", b"HTTP://LOCALHOST/livez?"):
            whole = b"GET " + address + b" HTTP/1.1\r\n" + HOST + b"Connection: close\r\n\r\n"
            assert asked(port, whole).startswith(b"HTTP/1.1 200"), address
        bare = b"GET http://localhost HTTP/1.1\r\n" + HOST + b"Connection: close\r\n\r\n"
        assert asked(port, bare).startswith(b"HTTP/1.1 200")  # the first page
        assert asked(port).startswith(b"HTTP/1.1 200")


def test_slow_clients_are_told_and_closed(tmp_path: Path) -> None:
    with serving(tmp_path, **QUICK) as port:
        silent = sent(port, b"")
        head = sent(port, b"GET /livez HTTP/1.1\r\nX-Slow: ")
        body = sent(port, POST + b"Content-Length: 100\r\n\r\n{")
        second = sent(port, b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\nGET /li")
        rest = sent(port, b"POST /v1/nothing HTTP/1.1\r\n" + HOST + b"Content-Length: 100\r\n\r\n{")
        assert problem(heard(silent)) == (408, "request-timeout")
        assert problem(heard(head)) == (408, "request-timeout")
        assert problem(heard(body)) == (408, "request-timeout")
        first, _, late = heard(second).partition(b"HTTP/1.1 408")
        assert first.startswith(b"HTTP/1.1 200")
        assert late
        assert heard(rest).startswith(b"HTTP/1.1 404")
        assert asked(port).startswith(b"HTTP/1.1 200")


def test_a_byte_now_and_then_does_not_help(tmp_path: Path) -> None:
    """Neither in a head, nor in a body, nor before a head; a body that comes at a fair rate may take its time."""
    with serving(tmp_path, **QUICK) as port:
        document = b'{"name": "a", "bodies": [], "description": "' + b"x" * 9000 + b'"}'
        fair = sent(port, POST + b"Connection: close\r\nContent-Length: %d\r\n\r\n" % len(document))
        slow = {
            b"a": sent(port, b"GET /livez HTTP/1.1\r\nX-Slow: "),
            b" ": sent(port, POST + b"Content-Length: 100\r\n\r\n"),
            b"\r\n": sent(port, b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n"),
        }
        for start in range(0, len(document), 300):  # 3000 bytes a second
            fair.sendall(document[start : start + 300])
            for byte, connection in slow.items():
                try:
                    connection.send(byte)
                except OSError:
                    continue
            sleep(0.1)
        assert heard(fair).startswith(b"HTTP/1.1 201")
        start = monotonic()
        for connection in slow.values():
            heard(connection)
        assert monotonic() - start < 0.5  # they had been closed


def test_answers_that_nobody_reads(tmp_path: Path) -> None:
    with serving(tmp_path, **QUICK) as port:
        unread = socket.socket()
        OPEN.append(unread)
        unread.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        unread.connect(("127.0.0.1", port))
        unread.sendall(b"GET /openapi.json HTTP/1.1\r\nHost: localhost\r\n\r\n" * 100)
        sleep(6)
        unread.settimeout(5)
        found = heard(unread)  # what the systems between had kept, and then the end
        assert found.count(b"HTTP/1.1 200") < 100


def test_who_only_holds_connections_locks_nobody_out(tmp_path: Path) -> None:
    """Also from the same address: the connection that waits longest goes."""
    with serving(tmp_path, connections_per_address=20) as port:
        held = [sent(port, b"GET /livez HTTP/1.1\r\nX-Slow: ") for _ in range(60)]
        for _ in range(10):
            assert asked(port).startswith(b"HTTP/1.1 200")
        ended = [problem(heard(connection)) for connection in held[:40]]
        assert set(ended) == {(503, "too-many-connections")}
        held[-1].sendall(b"a\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        assert heard(held[-1]).startswith(b"HTTP/1.1 200")


def test_no_room_while_all_are_served(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begun, let_go = Semaphore(0), Event()
    monkeypatch.setattr(Database, "ping", lambda _: (begun.release(), let_go.wait(60)))
    with serving(tmp_path, connections=2) as port:
        served = [sent(port, b"GET /readyz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n") for _ in range(2)]
        try:
            assert all(begun.acquire(timeout=20) for _ in served)
            assert problem(asked(port)) == (503, "too-many-connections")
        finally:
            let_go.set()
        assert all(heard(connection).startswith(b"HTTP/1.1 200") for connection in served)
        waiting = b"POST /v1/trees HTTP/1.1\r\n" + HOST + b"Content-Length: 5\r\nExpect: 100-continue\r\n\r\n"
        held = [sent(port, waiting) for _ in range(2)]
        for connection in held:
            assert connection.recv(100).startswith(b"HTTP/1.1 100")
        assert asked(port).startswith(b"HTTP/1.1 200")  # bodies that do not come give way to others
        assert problem(heard(held[0])) == (503, "too-many-connections")


def test_a_client_that_goes_is_no_error(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with serving(tmp_path) as port:
        sent(port, POST + b"Content-Length: 100\r\n\r\n{").close()
        assert asked(port).startswith(b"HTTP/1.1 200")
        sleep(0.3)
    assert not [record for record in caplog.records if record.exc_info or "ClientDisconnect" in record.message]


def test_errors_of_accepting_are_said_once(caplog: pytest.LogCaptureFixture) -> None:
    with closing(new_event_loop()) as loop:
        complaints = Complaints()
        error = OSError(errno.EMFILE, "Too many open files")
        for _ in range(1000):
            complaints(loop, {"message": "socket.accept() out of system resource", "exception": error})
        assert len(caplog.records) == 1
        assert caplog.records[0].exc_info is None
        complaints(loop, {"message": "another", "exception": ValueError("x")})
        assert len(caplog.records) == 2


FEW = """
import resource, sys
resource.setrlimit(resource.RLIMIT_NOFILE, (128, 128))
from service.cli.main import main
sys.exit(main(sys.argv[1:]))
"""


def test_more_connections_than_descriptors(tmp_path: Path) -> None:
    """A process of 128 descriptors, 400 half requests: others are answered all the time, and the log stays short."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [sys.executable, "-c", FEW, "serve", "--port", str(port), "--engine", "none"]
    with (tmp_path / "log").open("wb") as log:
        command += ["--database", f"sqlite:///{tmp_path}/store.db"]
        process = subprocess.Popen(command, stderr=log, env={**os.environ, "SUBSTRUCTURES_CATALOGUE": "0"})
    try:
        while process.poll() is None:
            try:
                if asked(port).startswith(b"HTTP/1.1 200"):
                    break
            except ConnectionRefusedError:
                sleep(0.1)
        held = [sent(port, b"GET /livez HTTP/1.1\r\nX-Slow: ") for _ in range(400)]
        for _ in range(20):
            assert asked(port).startswith(b"HTTP/1.1 200")
        assert len(held) == 400
        close()
    finally:
        process.terminate()
        process.wait(20)
    assert b"Traceback" not in (tmp_path / "log").read_bytes()


def test_addresses() -> None:
    assert network_of("192.0.2.7") == network_of("::ffff:192.0.2.7") == "192.0.2.7"
    assert network_of("2001:db8::1") == network_of("2001:db8::ffff:1") != network_of("2001:db8:0:1::1")
    assert network_of("fe80::1%eth0") == "fe80::"
    assert network_of("unix") == "unix"


def test_answers_are_sent_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A head does not wait until the client confirms it before the body follows (Nagle)."""
    found: list[int] = []

    class Watched(Connection):
        """Looks at its socket."""

        def connection_made(self, transport: Any) -> None:
            super().connection_made(transport)
            connected = transport.get_extra_info("socket")
            found.append(connected.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))

    monkeypatch.setattr("service.server.Connection", Watched)
    with serving(tmp_path) as port:
        assert asked(port).startswith(b"HTTP/1.1 200")
    assert found
    assert all(found)
