"""Requests that are sent again: by what fails, and so that nothing is done twice."""

from __future__ import annotations

import json
import os
import socket
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any, ClassVar

import httpx2
import numpy as np
import pytest

from service.cli.main import main
from substructures.client import Client, ProblemError, retries
from substructures.formats.arrays import as_npz

DROP = 0  # in place of a status: the connection ends


class _Flaky(BaseHTTPRequestHandler):
    """Fails as ``script`` says, then answers; an Idempotency-Key that it has acted on is answered without acting."""

    protocol_version = "HTTP/1.1"
    script: ClassVar[list[tuple[int, dict[str, str], dict[str, Any] | None]]] = []
    seen: ClassVar[list[tuple[str, str | None]]] = []
    acted: ClassVar[list[str | None]] = []

    def _serve(self) -> None:
        self.rfile.read(int(self.headers.get("Content-Length", 0)))
        key = self.headers.get("Idempotency-Key")
        self.seen.append((self.command, key))
        status, headers, problem = self.script.pop(0) if self.script else (200, {}, None)
        if status in (200, DROP) and (key is None or key not in self.acted):
            self.acted.append(key)
        if status == DROP:
            self.close_connection = True
            return
        is_npz = self.headers.get("Content-Type") == "application/x-npz" and not self.headers.get("Prefer")
        body = json.dumps(problem or {"id": "x", "items": [], "links": {"next": None}}).encode()
        body = b"".join(as_npz({"metric": np.eye(1)}).pieces) if is_npz and status == 200 else body
        self.send_response(status)
        media_type = "application/problem+json" if problem else "application/json"
        for name, value in {"Content-Type": media_type, "Content-Length": str(len(body)), **headers}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    do_GET = do_POST = do_DELETE = _serve  # noqa: N815 -- names of the standard library

    def log_message(self, *_: object) -> None:
        """Nothing."""


@pytest.fixture
def client(monkeypatch: pytest.MonkeyPatch) -> Iterator[Client]:
    monkeypatch.setattr(retries, "FIRST", 0.001)
    _Flaky.script, _Flaky.seen, _Flaky.acted = [], [], []
    server = ThreadingHTTPServer(("127.0.0.1", 0), _Flaky)
    Thread(target=server.serve_forever, daemon=True).start()
    with Client(f"http://127.0.0.1:{server.server_port}", timeout=5) as found:
        yield found
    server.shutdown()
    server.server_close()


def fail(*script: int | tuple[int, dict[str, str], dict[str, Any] | None]) -> None:
    _Flaky.script.extend((each, {}, None) if isinstance(each, int) else each for each in script)


def test_twice_unavailable_then_answered(client: Client) -> None:
    fail(503, 502)
    assert client.limits()["id"] == "x"
    assert len(_Flaky.seen) == 3


def test_an_address_that_is_another(client: Client, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Redirects are not followed, and pages are no answers: both are told, with what should be given."""
    asked: dict[str, Callable[[], Any]] = {
        "limits": client.limits,
        "archive": lambda: client.job_archive("x", tmp_path / "x.zip"),
        "numbers": lambda: client.evaluate("x", quantities=["metric"], q=np.zeros((1, 1))),
    }
    for ask in asked.values():
        fail((308, {"Location": "https://there/"}, None))
        with pytest.raises(ProblemError, match="308: Permanent Redirect to https://there/"):
            ask()
    for script, told in (((308, {"Location": "https://there/"}, None), "https://there/"), (204, "no JSON")):
        fail(script)
        assert main(["list", "--server", client.address]) == 1
        error = capsys.readouterr().err
        assert told in error
        assert f"'{client.address}' should be the address of such a server" in error


def test_a_download_that_breaks_off_leaves_the_file_that_was_there(client: Client, tmp_path: Path) -> None:
    file = tmp_path / "x.zip"
    file.write_bytes(b"whole")
    fail(*[(200, {"Content-Length": "1000", "Connection": "close"}, None)] * 4)
    with pytest.raises(httpx2.RemoteProtocolError):
        client.job_archive("x", file)
    assert [each.read_bytes() for each in tmp_path.iterdir()] == [b"whole"]
    client.job_archive("x", file)
    assert [each.read_bytes()[:1] for each in tmp_path.iterdir()] == [b"{"]


def test_pipes_and_links_stay_where_downloads_go(client: Client, tmp_path: Path) -> None:
    """As devices do: what is there is written to, and nothing takes its place."""
    pipe, link, file = (tmp_path / name for name in ("pipe", "link", "file"))
    os.mkfifo(pipe)
    link.symlink_to(file)
    found: list[bytes] = []
    reader = Thread(target=lambda: found.append(pipe.read_bytes()))
    reader.start()
    client.job_archive("x", pipe)
    reader.join(10)
    assert pipe.is_fifo()
    client.job_archive("x", link)
    assert link.is_symlink()
    assert found == [file.read_bytes()]


def test_what_is_sent_again_acts_once(client: Client) -> None:
    """The server has acted when the connection ends; the second request has the same key."""
    fail(DROP, 503, DROP)
    client.submit_job({"kind": "derive", "items": []})
    assert len({key for _, key in _Flaky.seen}) == 1
    assert len(_Flaky.seen) == 4
    assert len(_Flaky.acted) == 1


def test_every_request_has_a_key_of_its_own(client: Client) -> None:
    for _ in range(3):
        client.submit_job({"kind": "derive", "items": []})
    client.uncouple("cell", "hand")
    assert len(set(_Flaky.acted)) == 4
    assert None not in _Flaky.acted


def test_a_key_that_is_given_is_kept(client: Client) -> None:
    fail(503)
    client.request("POST", "/v1/jobs", {}, headers={"idempotency-key": "mine"})
    assert _Flaky.seen == [("POST", "mine")] * 2


def test_arrays_are_sent_again(client: Client) -> None:
    fail(DROP, 503)
    assert client.evaluate("cell", quantities=["metric"], q=np.zeros((1, 1)))["metric"] == 1
    assert len(_Flaky.seen) == 3


@pytest.mark.parametrize("q", [[[0.0]], np.zeros((1, 1))])
def test_states_that_become_a_job_make_one(client: Client, q: Any) -> None:
    fail(DROP, 503)
    client.submit_states("cell", {"q": q}, quantities=["metric"])
    assert len(_Flaky.seen) == 3
    assert len(_Flaky.acted) == 1
    assert _Flaky.acted != [None]


def test_no_retries(client: Client) -> None:
    fail(503, DROP)
    with Client(client.address, retries=0) as once:
        with pytest.raises(ProblemError, match="503"):
            once.limits()
        with pytest.raises(httpx2.HTTPError):
            once.limits()
    assert len(_Flaky.seen) == 2


def test_it_gives_up(client: Client) -> None:
    fail(*[503] * 10)
    with pytest.raises(ProblemError, match="503"):
        client.limits()
    assert len(_Flaky.seen) == 4


@pytest.mark.parametrize("after", [{}, {"Retry-After": "1"}])
def test_problems_of_the_service_only_where_waiting_helps(
    client: Client, after: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    slept: list[float] = []
    monkeypatch.setattr(retries, "sleep", slept.append)
    fail((503, after, {"code": "took-too-long", "detail": "too long"}))
    if after:
        client.limits()
        assert slept == [1]
    else:
        with pytest.raises(ProblemError, match="too long"):
            client.limits()


def test_who_asks_for_too_long_a_pause_is_not_waited_for(client: Client) -> None:
    fail((429, {"Retry-After": "3600"}, None))
    with pytest.raises(ProblemError) as error:
        client.limits()
    assert error.value.retry_after == 3600


def test_an_attempt_that_is_still_served_is_waited_for(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(retries, "sleep", lambda _: None)
    served = (409, {"Retry-After": "1"}, {"code": "idempotency-in-flight", "detail": "still"})
    fail(DROP, *[served] * 6)
    client.submit_job({})
    assert len(_Flaky.acted) == 1
    fail(served)
    with pytest.raises(ProblemError, match="still"):  # of a request of somebody else
        client.submit_job({})


@pytest.mark.parametrize("status", [400, 404, 409, 422, 500])
def test_other_problems_are_told_at_once(client: Client, status: int) -> None:
    fail(status)
    with pytest.raises(ProblemError):
        client.limits()
    assert len(_Flaky.seen) == 1


def test_what_has_no_key_is_only_sent_again_when_it_was_not_taken(client: Client) -> None:
    for script, count in ((DROP, 1), (503, 1), ((429, {"Retry-After": "0"}, None), 2)):
        _Flaky.seen.clear()
        fail(script)
        try:
            client.remove_job("x")
        except (ProblemError, httpx2.HTTPError):
            assert count == 1
        assert len(_Flaky.seen) == count


def test_nobody_listens(monkeypatch: pytest.MonkeyPatch) -> None:
    pauses: list[float] = []
    monkeypatch.setattr(retries, "sleep", pauses.append)
    with Client("http://127.0.0.1:9") as client, pytest.raises(httpx2.ConnectError) as raised:
        client.remove_job("x")
    assert str(raised.value).startswith("nothing answers at http://127.0.0.1:9 (")
    assert str(raised.value).endswith("; 'substructures serve' starts a server")
    assert pauses == pytest.approx([0.1, 0.3, 0.9])


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a full queue refuses")
def test_a_silent_host_is_waited_for_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """It takes no more connections, and does not refuse them either."""
    monkeypatch.setattr(retries, "sleep", lambda _: pytest.fail("it is asked again"))
    with socket.create_server(("127.0.0.1", 0), backlog=0) as silent, ExitStack() as opened:
        for _ in range(4):  # until its queue is full
            waiting = opened.enter_context(socket.socket())
            waiting.setblocking(False)
            waiting.connect_ex(silent.getsockname())
        client = opened.enter_context(Client(f"http://127.0.0.1:{silent.getsockname()[1]}", timeout=0.2))
        with pytest.raises(httpx2.ConnectTimeout, match=r"nothing answers at http://127\.0\.0\.1:"):
            client.limits()
