"""A server whose process is killed is there again: nobody is refused, jobs go on, and who ends it ends it."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import threading
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import httpx2
import pytest

from service.processes.parent import bound
from substructures.client import Client

from .conftest import PENDULUM, TREE
from .farm import Server, children, finished, running, submit


def until(condition: Callable[[], bool], seconds: float = 60) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.fixture
def server(tmp_path: Path) -> Server:
    one = Server(f"sqlite:///{tmp_path / 'x.db'}", tmp_path / "log", ("--workers", "1"))
    one.environment["SUBSTRUCTURES_LIMIT_LEASE_SECONDS"] = "2"
    return one


class Caller(threading.Thread):
    """Evaluates a state again and again; ``seen``: statuses, and kinds of errors."""

    def __init__(self, server: Server) -> None:
        super().__init__()
        self.server, self.over, self.seen = server, threading.Event(), Counter[str]()

    def run(self) -> None:
        address = f"{self.server.address}/v1/trees/{TREE['name']}/evaluations"
        body = {"quantities": ["metric"], "q": [0.5], "qd": [0]}
        while not self.over.is_set():
            try:
                answer = httpx2.post(address, json=body, timeout=60, verify=False)
                self.seen[str(answer.status_code)] += 1
            except httpx2.HTTPError as error:
                self.seen[type(error).__name__] += 1


def killed(server: Server, how: signal.Signals) -> None:
    """Kill the process that answers, and wait for the next one to answer."""
    [serving] = server.serving()
    os.kill(serving, how)
    until(lambda: serving not in server.serving())
    with httpx2.Client(timeout=60, verify=False) as client:
        assert client.get(f"{server.address}/readyz").status_code == 200
    assert server.serving() != [serving]


@pytest.mark.deep  # 12 s of CPU: many kills; one is in the test before
def test_killed_under_load(server: Server) -> None:
    """Requests in flight break off, all others are answered; a job ends as if nothing had been."""
    with running([server]), Client(server.address, timeout=60) as client:
        client.submit(PENDULUM)
        client.create_tree(TREE)
        items = [{**TREE, "name": f"tree{k}"} for k in range(200)]
        job = submit([server], {"kind": "assemble", "items": items}, "batch")
        callers = [Caller(server) for _ in range(4)]
        for caller in callers:
            caller.start()
        try:
            for how in (signal.SIGSEGV, signal.SIGABRT, signal.SIGKILL):
                count = sum(caller.seen["200"] for caller in callers)
                until(lambda count=count: sum(caller.seen["200"] for caller in callers) > count + 20)
                killed(server, how)
        finally:
            for caller in callers:
                caller.over.set()
            for caller in callers:
                caller.join()
        seen = sum((caller.seen for caller in callers), Counter[str]())
        broken = {name: count for name, count in seen.items() if name != "200"}
        # three deaths, four callers
        assert sum(broken.values()) <= 12, seen
        assert broken.keys() <= {"ReadError", "RemoteProtocolError", "WriteError"}, seen
        view = finished(client, job, 120)
        assert (view["state"], view["progress"]["failed"]) == ("succeeded", 0)
        assert server.process is not None
        assert server.process.poll() is None
    assert "killed by signal 11" in server.log.read_text()
    assert server.process.wait() == 0


@pytest.mark.parametrize(("how", "status"), [(signal.SIGTERM, 0), (signal.SIGINT, 130)])
def test_told_to_end_it_ends(server: Server, how: signal.Signals, status: int) -> None:
    with running([server]):
        [serving] = server.serving()
        assert server.process is not None
        server.process.send_signal(how)
        assert server.process.wait(30) == status
        assert not Path(f"/proc/{serving}").exists()
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.1", server.port), 5)
    assert "started again" not in server.log.read_text()


def test_told_to_end_when_it_is_dead(server: Server) -> None:
    """Between two lives: nothing is started any more."""
    with running([server]):
        assert server.process is not None
        for k in (1, 2):  # after the second the next one is waited for
            until(lambda: len(server.serving()) == 1)
            [serving] = server.serving()
            os.kill(serving, signal.SIGKILL)
            # before that its parent takes it for one that was killed when it was told to end
            until(lambda k=k: server.log.read_text().count("was killed by signal 9") == k)
        server.process.send_signal(signal.SIGTERM)
        assert server.process.wait(30) == 0
    assert "in 0.5 s" in server.log.read_text()


def test_it_ends_with_its_parent_and_the_port_is_free(server: Server) -> None:
    with running([server]):
        [serving] = server.serving()
        server.kill()
        until(lambda: not Path(f"/proc/{serving}").exists(), 10)
        server.start()
        assert server.serving() != [serving]


def test_one_that_cannot_start_is_not_started_again(server: Server, tmp_path: Path) -> None:
    """It tells why, as ever; one that is killed before it listens is not tried again either."""
    with socket.create_server(("127.0.0.1", server.port)):
        found = subprocess.run(server.command, env=server.environment, capture_output=True, text=True, check=False)
    assert found.returncode == 1
    assert f"cannot listen on 127.0.0.1:{server.port}: Address already in use" in found.stderr
    assert "Traceback" not in found.stderr
    with (tmp_path / "log").open("wb") as log:
        process = subprocess.Popen(server.command, env=server.environment, stderr=log)
    until(lambda: bool(children(process.pid)))
    os.kill(children(process.pid)[0], signal.SIGKILL)
    assert process.wait(30) == 128 + signal.SIGKILL


def test_one_port_for_all_addresses_of_a_host() -> None:
    found = bound("localhost", 0)
    with contextlib.ExitStack() as opened:
        for one in found:
            opened.enter_context(one)
        assert len({one.getsockname()[1] for one in found}) == 1
        with pytest.raises(OSError, match="in use"):
            bound("127.0.0.1", found[0].getsockname()[1])
    with pytest.raises(socket.gaierror):
        bound("no.such.host.invalid", 0)
