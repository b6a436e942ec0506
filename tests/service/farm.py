"""Servers in processes of their own, on one database, that are killed and started again."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Self

import httpx2
import numpy as np

from service.jobs.engines.pool import NICE
from service.processes.parent import VARIABLE
from substructures.client import Client, ProblemError

START = 60.0


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return int(listener.getsockname()[1])


def children(pid: int) -> list[int]:
    """The processes that a process has started."""
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            fields = status.read_text().rpartition(")")[2].split()
            if int(fields[1]) == pid and fields[0] != "Z":
                found.append(int(status.parent.name))
    return found


def niceness(pid: int) -> int:
    """How much a process leaves to others; 0 of one that is gone."""
    with contextlib.suppress(OSError):
        return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[16])
    return 0


class Server:
    """One server, always on the same port."""

    def __init__(self, database: str, log: Path, settings: Sequence[str] = ()) -> None:
        self.port, self.log = free_port(), log
        command = [sys.executable, "-m", "service.cli.main", "serve", "--port", str(self.port), "--database", database]
        self.command = [*command, *settings]
        self.environment = {**os.environ, "SUBSTRUCTURES_CATALOGUE": "false"}
        self.process: subprocess.Popen[bytes] | None = None
        self.kills = 0

    @property
    def address(self) -> str:
        """Where it answers."""
        return f"http://127.0.0.1:{self.port}"

    def start(self) -> None:
        """Start it, and wait until it answers."""
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(self.command, stderr=log, stdout=log, env=self.environment)
        end = time.monotonic() + START
        with httpx2.Client(timeout=5, verify=False) as client:  # certificates take long to load
            while time.monotonic() < end and self.process.poll() is None:
                with contextlib.suppress(httpx2.HTTPError):
                    if client.get(f"{self.address}/readyz").status_code == 200:
                        return
                time.sleep(0.02)
        raise RuntimeError(f"the server did not start: {self.log.read_text()[-2000:]}")

    def kill(self) -> None:
        """kill -9."""
        if self.process is not None:
            self.process.kill()
            self.process.wait(30)
            self.kills += 1

    def stop(self) -> int:
        """As by a service manager; the exit status, 0 of one that was never started."""
        if self.process is None:
            return 0
        self.process.terminate()
        return self.process.wait(30)

    def serving(self) -> list[int]:
        """The processes that answer, while there are some: children of the one that was started."""
        return [pid for pid, _ in self._numbered()]

    def computing(self, serving: int | None = None) -> list[int]:
        """The processes that compute what requests need, for all that answer or for one of them."""
        processes = self.serving() if serving is None else [serving]
        return [each for pid in processes for each in children(pid) if niceness(each) - niceness(pid) == NICE]

    def _numbered(self) -> list[tuple[int, int]]:
        found = []
        for pid in children(self.process.pid) if self.process is not None and self.process.poll() is None else []:
            with contextlib.suppress(OSError):
                told = dict(x.split("=", 1) for x in Path(f"/proc/{pid}/environ").read_text().split("\0") if "=" in x)
                found += [(pid, int(told[VARIABLE].split()[1]))] if VARIABLE in told else []
        return found

    def workers(self) -> list[int]:
        """The processes that compute for it."""
        return [worker for pid in self.serving() for worker in children(pid)]


@contextlib.contextmanager
def running(servers: Sequence[Server]) -> Iterator[None]:
    """All of them, stopped at the end whatever happens."""
    try:
        for server in servers:
            server.start()
        yield
    finally:
        for server in servers:
            server.stop()


class Repeated:
    """Does something again and again, in a thread of its own, while a block lasts."""

    def __init__(self) -> None:
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._work)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()

    def _work(self) -> None:
        while not self._over.wait(self.pause()):
            self.act()

    def pause(self) -> float:
        """Seconds until the next time."""
        raise NotImplementedError

    def act(self) -> None:
        """Once."""
        raise NotImplementedError


class Assassin(Repeated):
    """Kills workers at random moments, and servers when told to."""

    def __init__(self, servers: Sequence[Server], seed: int, longest: float) -> None:
        super().__init__()
        self.servers, self.longest = servers, longest
        self.random, self.kills = np.random.default_rng(seed), 0

    def pause(self) -> float:
        return self.random.uniform(0.05, self.longest)

    def act(self) -> None:
        pids = [pid for server in self.servers for pid in server.workers()]
        if pids:
            with contextlib.suppress(ProcessLookupError):
                os.kill(int(self.random.choice(pids)), signal.SIGKILL)
                self.kills += 1


class Submitter(Repeated):
    """Submits small jobs all the time, each under a key of its own, again and again until it is acknowledged."""

    def __init__(self, servers: Sequence[Server], body: Callable[[int], dict[str, Any]], pause: float) -> None:
        super().__init__()
        self.servers, self.body, self.seconds = servers, body, pause
        self.acknowledged: dict[str, str] = {}
        self.sent = 0

    def pause(self) -> float:
        return self.seconds

    def act(self) -> None:
        self.acknowledged[f"small-{self.sent}"] = submit(self.servers, self.body(self.sent), f"small-{self.sent}")
        self.sent += 1


def submit(servers: Sequence[Server], body: dict[str, Any], key: str, seconds: float = 300.0) -> str:
    """The id of a job, after as many attempts as it takes."""
    end = time.monotonic() + seconds
    while True:
        for server in servers:
            try:
                with Client(server.address, timeout=30) as client:
                    headers = {"Idempotency-Key": key}
                    return str(client.request("POST", "/v1/jobs", body, headers=headers).json()["id"])
            except (httpx2.HTTPError, ProblemError) as error:
                is_final = isinstance(error, ProblemError) and error.status not in (409, 500, 503)
                if is_final or time.monotonic() > end:
                    raise
        time.sleep(0.05)


def finished(client: Client, job: str, seconds: float) -> dict[str, Any]:
    """A job when it is final; what it is when the time is over."""
    end = time.monotonic() + seconds
    while True:
        view = dict(client.request("GET", f"/v1/jobs/{job}").json())
        if view["state"] in ("succeeded", "failed", "cancelled") or time.monotonic() > end:
            return view
        time.sleep(0.1)
