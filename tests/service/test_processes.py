"""A server of several processes: one store, one port, each process started again for itself, all ended together."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import socket
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx2
import pytest

from service.cli.main import main
from service.database.connections import Database, DatabaseError
from service.database.file import Claim
from service.processes import accepting as turns
from service.processes.parent import bound
from service.queries import idempotency
from service.settings import Limits, Settings
from substructures.client import Client

from .conftest import PENDULUM, TREE
from .databases import fresh
from .farm import Server, finished, running, submit

COUNT = 2


def until(condition: Callable[[], Any], seconds: float = 60) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


@contextlib.contextmanager
def serving(address: str, folder: Path) -> Iterator[Server]:
    """A server of which all processes answer."""
    server = Server(address, folder / "log", ("--workers", "1", "--processes", str(COUNT)))
    server.environment["SUBSTRUCTURES_LIMIT_LEASE_SECONDS"] = "2"
    with running([server]):
        until(lambda: answering(server) == {"0", "1"})
        yield server


def answering(server: Server) -> set[str]:
    """The numbers of the processes that answer new connections."""
    found = set[str]()
    for _ in range(10):
        with contextlib.ExitStack() as opened:  # whoever has fewer takes the next
            for _ in range(4):
                client = opened.enter_context(httpx2.Client(timeout=60, verify=False))
                text = client.get(f"{server.address}/metrics").text
                found |= set(re.findall(r'process_start_time_seconds\{process="(\d+)"\}', text))
        if len(found) == COUNT:
            break
    return found


class Writer(threading.Thread):
    """Stores trees, one after the other over new connections, each under a key, until each is acknowledged."""

    def __init__(self, server: Server, name: str) -> None:
        super().__init__()
        self.server, self.prefix, self.over = server, name, threading.Event()
        self.acknowledged: list[str] = []
        self.refused: list[tuple[int, str]] = []

    def run(self) -> None:
        while not self.over.is_set():
            name = f"{self.prefix}{len(self.acknowledged)}"
            if self.is_stored(name):
                self.acknowledged.append(name)

    def is_stored(self, name: str) -> bool:
        try:
            headers = {"Idempotency-Key": name}
            answer = httpx2.post(
                f"{self.server.address}/v1/trees", json={**TREE, "name": name}, headers=headers, verify=False
            )
        except httpx2.HTTPError:
            return False
        if answer.status_code == 201:
            return True
        self.refused.append((answer.status_code, answer.json()["code"]))
        time.sleep(0.1)
        return False


@pytest.mark.deep
@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_writes_of_all_processes_while_they_are_killed(kind: str, tmp_path: Path) -> None:
    """All that is acknowledged is there, once; the other process answers all the while, and a job ends."""
    with fresh(kind, tmp_path) as address, serving(address, tmp_path) as server:
        first = sorted(server.serving())
        assert len(first) == COUNT
        with Client(server.address, timeout=60) as client:
            client.submit(PENDULUM)
            client.create_tree(TREE)
        items = [{**TREE, "name": f"made{k}"} for k in range(50)]
        job = submit([server], {"kind": "assemble", "items": items}, "batch")
        writers = [Writer(server, name) for name in "abcd"]
        for writer in writers:
            writer.start()
        try:
            for killed in first:  # the first one, which looks after the jobs, and the other one
                count = sum(len(writer.acknowledged) for writer in writers)
                until(lambda count=count: sum(len(writer.acknowledged) for writer in writers) > count + 10)
                os.kill(killed, signal.SIGKILL)
                start = time.monotonic()
                assert httpx2.get(f"{server.address}/readyz", timeout=60, verify=False).status_code == 200
                assert len(server.serving()) < COUNT or time.monotonic() - start < 10
                until(lambda killed=killed: len(server.serving()) == COUNT and killed not in server.serving())
                until(lambda: answering(server) == {"0", "1"})
        finally:
            for writer in writers:
                writer.over.set()
            for writer in writers:
                writer.join()
        # a claim of a process that was killed lasts as long as its lease; nothing else is refused
        assert {each for writer in writers for each in writer.refused} <= {(409, "idempotency-in-flight")}
        with Client(server.address, timeout=60) as client:
            for name in (name for writer in writers for name in writer.acknowledged):
                assert client.request("GET", f"/v1/trees/{name}").json()["revision"] == 1
            view = finished(client, job, 120)
            assert (view["state"], view["progress"]["failed"]) == ("succeeded", 0)
        assert not set(first) & set(server.serving())
        assert server.stop() == 0
        log = server.log.read_text()
    assert log.count("killed by signal 9") == COUNT
    assert "Traceback" not in log


@pytest.mark.deep
def test_no_second_server(tmp_path: Path) -> None:
    """Nor while one process, whichever, is dead, nor after each has been started again."""
    address = f"sqlite:///{tmp_path}/store.db"
    with serving(address, tmp_path) as server:
        for number in range(2 * COUNT):
            with pytest.raises(DatabaseError, match="another server uses"):
                Database(address)
            until(lambda: len(server.serving()) == COUNT)
            before = sorted(server.serving())
            os.kill(before[0], signal.SIGKILL)
            while len(server.serving()) < COUNT or before[0] in server.serving():
                with pytest.raises(DatabaseError, match="another server uses"):
                    Database(address)
            assert number >= COUNT or before[1] in server.serving()
        at = server.command.index("--port") + 1
        for port, said in ((server.command[at], "is another server running?"), ("0", "another server uses")):
            command = [*server.command[:at], port, *server.command[at + 1 :]]
            other = subprocess.run(command, env=server.environment, capture_output=True, text=True, check=False)
            assert other.returncode == 1
            assert said in other.stderr
    Database(address).close()


def check_all_end_together(server: Server, how: signal.Signals, status: int) -> None:
    processes = server.serving()
    assert len(processes) == COUNT
    assert server.process is not None
    server.process.send_signal(how)
    assert server.process.wait(30) == status
    assert not any(Path(f"/proc/{each}").exists() for each in processes)
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", server.port), 5)
    assert "started again" not in server.log.read_text()
    assert not server.log.with_name("store.db-wal").exists()  # the last one has put the log away


def test_a_job_that_another_process_has_accepted(tmp_path: Path) -> None:
    """Every process submits jobs and shows them; one of them computes; all end together. A start takes 5 s of CPU."""
    with serving(f"sqlite:///{tmp_path}/store.db", tmp_path) as server:
        with contextlib.ExitStack() as opened:
            clients = [opened.enter_context(Client(server.address, timeout=60)) for _ in range(8)]
            clients[0].submit(PENDULUM)
            items = [[{**TREE, "name": f"t{k}"}] for k in range(len(clients))]
            jobs = [
                submit_over(client, {"kind": "assemble", "items": each})
                for client, each in zip(clients, items, strict=True)
            ]
            for client, job in zip(reversed(clients), jobs, strict=True):
                assert finished(client, job, 60)["state"] == "succeeded"
        check_all_end_together(server, signal.SIGTERM, 0)


@pytest.mark.deep  # another start for another signal
def test_all_end_together_when_interrupted(tmp_path: Path) -> None:
    with serving(f"sqlite:///{tmp_path}/store.db", tmp_path) as server:
        check_all_end_together(server, signal.SIGINT, 130)


@pytest.mark.deep
def test_one_that_ends_ends_all(tmp_path: Path) -> None:
    """And with the parent, however it dies."""
    with serving(f"sqlite:///{tmp_path}/store.db", tmp_path) as server:
        os.kill(max(server.serving()), signal.SIGTERM)
        assert server.process is not None
        assert server.process.wait(30) == 0
        server.start()
        processes = server.serving()
        server.kill()
        until(lambda: not any(Path(f"/proc/{each}").exists() for each in processes), 10)
        server.start()


@pytest.mark.deep
def test_claims_of_others_stay(tmp_path: Path) -> None:
    """A process that starts again forgets no idempotency key that another one is at work under."""
    address = f"sqlite:///{tmp_path}/store.db"
    with serving(address, tmp_path) as server:
        database = Database(address, exclusive=False)
        with database.write() as connection:
            idempotency.claim(connection, idempotency.Claim("local", "k", "other"), "fingerprint")
        for killed in server.serving():
            os.kill(killed, signal.SIGKILL)
            until(lambda killed=killed: killed not in server.serving() and answering(server) == {"0", "1"})
        with database.read() as connection:
            assert connection.exec_driver_sql("SELECT count(*) FROM idempotency").scalar() == 1
        database.close()
        server.stop()
        server.start()
        database = Database(address, exclusive=False)
        with database.read() as connection:
            assert connection.exec_driver_sql("SELECT count(*) FROM idempotency").scalar() == 0
        database.close()


def submit_over(client: Client, body: dict[str, Any]) -> str:
    return str(client.request("POST", "/v1/jobs", body).json()["id"])


def test_a_claim_is_shared_by_its_descriptor(tmp_path: Path) -> None:
    path = tmp_path / "x.db"
    with contextlib.closing(Claim(path)) as claim:
        assert claim.shared is not None
        shared = Claim(path, os.dup(claim.shared))
    with pytest.raises(DatabaseError, match="another server uses"):
        Claim(path)
    assert shared.shared is not None
    path.rename(tmp_path / "y.db")
    path.touch()
    with pytest.raises(DatabaseError, match="deleted or replaced"):
        Claim(path, shared.shared)
    shared.close()
    Claim(tmp_path / "y.db").close()


def test_limits_are_shared_out() -> None:
    limits = Limits(connections=5, event_streams=1)
    share = Settings(limits=limits, processes=2).limits_of_process
    assert (share.connections, share.connections_per_address, share.event_streams) == (3, 128, 1)
    assert Settings(limits=limits).limits_of_process == limits


def test_whoever_has_fewest_takes_the_next(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(turns, "monotonic", lambda: now[0])
    descriptor = turns.new()
    shared, others = turns.Turns(descriptor), turns.Turns(descriptor)
    os.close(descriptor)
    [free] = bound("127.0.0.1", 0)
    free.setblocking(False)
    address = free.getsockname()
    with turns.Listener(free.detach(), shared, 1) as listener, contextlib.ExitStack() as opened:

        def is_taken() -> bool:
            try:
                opened.enter_context(listener.accept()[0])
            except BlockingIOError:
                return False
            return True

        for _ in range(4):
            opened.enter_context(socket.create_connection(address))
        shared.note(1, 0)
        assert is_taken()  # nobody else is there
        others.note(0, 1)
        assert is_taken()  # as many as the other
        assert not is_taken()
        now[0] += turns.PATIENCE / 2
        assert not is_taken()
        now[0] += turns.PATIENCE
        assert is_taken()  # the other one does not come
        assert not is_taken()
        others.note(0)  # it died
        assert is_taken()


def test_only_as_a_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--port", "0", "--processes", "2", "--database", f"sqlite:///{tmp_path}/x.db"]) == 1
    assert "several processes are started by the command" in capsys.readouterr().err
