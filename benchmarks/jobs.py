"""Jobs: what an item costs beside its computation, and a batch whose server and workers are killed again and again.

    python -m benchmarks.jobs overhead [--items 1000]
    python -m benchmarks.jobs kills [--items 2000] [--kills 100] [--database postgresql://...]
    python -m benchmarks.jobs storm [--seconds 60]

``kills`` kills (-9) the server and workers in turn, at random moments, while a batch of trees is assembled, and
compares what is stored in the end with an undisturbed run. ``storm``: 8 writers and 32 readers at once.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import socket
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import httpx2
import numpy as np

from service.client import Client, ProblemError

PENDULUM: dict[str, Any] = {
    "name": "pendulum",
    "parameters": {"l": {"value": 1, "unit": "m"}, "m": {"value": 2, "unit": "kg"}},
    "bodies": [
        {
            "name": "rod",
            "parent": "base",
            "joint": {"type": "revolute", "coordinate": "q"},
            "mass": "m",
            "com": ["l", 0, 0],
        }
    ],
}
CELL = {"name": "cell", "instances": [{"name": "arm", "substructure": "pendulum"}]}


def trees(count: int) -> dict[str, Any]:
    """A job that assembles so many different trees."""
    template = {"name": "pair", "instances": [{"name": "arm", "substructure": "pendulum"}]}
    return {"kind": "assemble", "template": template, "choices": {"arm.l": list(range(1, count + 1))}}


def exports(count: int) -> dict[str, Any]:
    """A job of small items."""
    item = {"tree": "cell", "quantity": "metric", "format": "text"}
    return {"kind": "export", "items": [{**item, "bind": f"arm.l:{k}"} for k in range(1, count + 1)]}


class Server:
    """A server process that can be killed and started again on the same port."""

    def __init__(self, address: str, workers: int) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        self.command = [sys.executable, "-m", "service.cli", "serve", "--port", str(self.port)]
        self.command += ["--database", address, "--workers", str(workers)]
        self.client = Client(f"http://127.0.0.1:{self.port}")
        self.start()

    def start(self) -> None:
        """Start, and wait until it answers."""
        environment = {**os.environ, "SUBSTRUCTURES_CATALOGUE": "false", "SUBSTRUCTURES_LIMIT_LEASE_SECONDS": "5"}
        self.process = subprocess.Popen(self.command, env=environment, stderr=subprocess.DEVNULL)
        for _ in range(1200):
            try:
                self.client.request("GET", "/readyz")
                return
            except httpx2.TransportError:
                time.sleep(0.05)
        raise TimeoutError

    def workers(self) -> list[int]:
        """The processes that compute."""
        children = Path(f"/proc/{self.process.pid}/task").glob("*/children")
        return [int(pid) for path in children for pid in path.read_text().split()]

    def kill(self) -> None:
        """Kill the server."""
        self.process.kill()
        self.process.wait()


@contextmanager
def serving(address: str, workers: int) -> Iterator[Server]:
    """A server with a part and a tree."""
    server = Server(address, workers)
    try:
        server.client.submit(PENDULUM)
        server.client.create_tree(CELL)
        yield server
    finally:
        server.kill()


def overhead(options: argparse.Namespace) -> None:
    """Time of an item in a job, beside its computation in place."""
    with tempfile.TemporaryDirectory() as folder:
        for workers in (1, 2):
            with serving(f"sqlite:///{folder}/{workers}.db", workers) as server:
                server.client.wait(server.client.submit_job(exports(50))["id"])  # starts the workers
                for what, body in (("exports", exports(options.items)), ("trees", trees(options.items // 4))):
                    start = time.perf_counter()
                    job = server.client.submit_job(body)
                    queued = time.perf_counter()
                    end = server.client.wait(job["id"])
                    seconds, count = time.perf_counter() - queued, end["progress"]["total"]
                    print(
                        f"{workers} workers, {count} {what}: submitted in {queued - start:.2f} s,"
                        f" {1000 * seconds / count:.2f} ms per item"
                    )


def kills(options: argparse.Namespace) -> None:
    """Compare a batch under kills with one in peace."""
    with tempfile.TemporaryDirectory() as folder:
        with serving(f"sqlite:///{folder}/peace.db", 2) as server:
            job = server.client.submit_job(trees(options.items))["id"]
            server.client.wait(job)
            expected = outcome(server.client, job)
        address = options.database or f"sqlite:///{folder}/kills.db"
        with serving(address, 2) as server:
            job = server.client.submit_job(trees(options.items))["id"]
            disturb(server, job, options.kills)
            end = server.client.wait(job)
            found = outcome(server.client, job)
            names = [tree["name"] for tree in trees_of(server.client)]
        print(f"state {end['state']}, {end['attempts']} attempts on {end['progress']['total']} items")
        print(f"results equal: {found == expected}; trees doubled: {len(names) - len(set(names))}")
        if not options.database:
            with closing(sqlite3.connect(f"{folder}/kills.db")) as connection:
                print("integrity check:", connection.execute("PRAGMA integrity_check").fetchone()[0])


def disturb(server: Server, job: str, count: int) -> None:
    """Kill the server and workers in turn, at random moments, as long as the job runs."""
    chance, done = np.random.default_rng(4), {"server": 0, "worker": 0}
    while min(done.values()) < count and server.client.job(job)["finished"] is None:
        time.sleep(chance.uniform(0.02, 0.5))
        workers = server.workers()
        if workers and done["worker"] <= done["server"]:
            os.kill(int(chance.choice(workers)), signal.SIGKILL)
            done["worker"] += 1
        else:
            server.kill()
            server.start()
            done["server"] += 1
    print(f"killed: {done}")


def storm(options: argparse.Namespace) -> None:
    """Requests of 8 writers and 32 readers: how many, how long, and what went wrong."""
    with tempfile.TemporaryDirectory() as folder, serving(f"sqlite:///{folder}/storm.db", 2) as server:
        end = time.monotonic() + options.seconds
        with ThreadPoolExecutor(40) as threads:
            futures = [threads.submit(_write, server.port, k, end) for k in range(8)]
            futures += [threads.submit(_read, server.port, end) for _ in range(32)]
            runs = [future.result() for future in futures]
    for name, some in (("writes", runs[:8]), ("reads", runs[8:])):
        times = np.array([seconds for run in some for seconds in run[0]])
        wrong = [problem for run in some for problem in run[1]]
        p50, p99 = 1000 * np.percentile(times, [50, 99])
        print(f"{len(times)} {name}: {p50:.0f} ms, p99 {p99:.0f} ms; {len(wrong)} went wrong {sorted(set(wrong))[:3]}")


def _write(port: int, writer: int, end: float) -> tuple[list[float], list[str]]:
    def body(k: int) -> tuple[str, str, Any]:
        tree = {**CELL, "name": f"tree{writer}-{k}"}
        return ("POST", "/v1/trees", tree) if k % 2 else ("POST", "/v1/jobs", {"kind": "assemble", "items": [tree]})

    return _requests(port, end, body)


def _read(port: int, end: float) -> tuple[list[float], list[str]]:
    paths = ("/v1/substructures/pendulum", "/v1/jobs?page_size=5", "/v1/trees?page_size=5", "/readyz")
    return _requests(port, end, lambda k: ("GET", paths[k % len(paths)], None))


def _requests(port: int, end: float, make: Callable[[int], tuple[str, str, Any]]) -> tuple[list[float], list[str]]:
    times, wrong = [], []
    with Client(f"http://127.0.0.1:{port}") as client:
        while time.monotonic() < end:
            start = time.perf_counter()
            try:
                client.request(*make(len(times)))
            except (ProblemError, httpx2.HTTPError) as error:
                wrong.append(str(error))
            times.append(time.perf_counter() - start)
    return times, wrong


def outcome(client: Client, job: str) -> list[tuple[str, str]]:
    """What every item has come to, by digest."""
    return [(item["state"], json.dumps(item["result"], sort_keys=True)) for item in client.job_items(job)]


def trees_of(client: Client) -> Iterator[dict[str, Any]]:
    """All trees, the latest revision of each; a doubled one has a second revision."""
    link: str | None = "/v1/trees?page_size=1000"
    while link is not None:
        page = client.request("GET", link).json()
        for tree in page["items"]:
            yield from [tree] * tree["revision"]
        link = page["links"]["next"]


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for name, command, items in (("overhead", overhead, 1000), ("kills", kills, 2000)):
        sub = commands.add_parser(name)
        sub.add_argument("--items", type=int, default=items)
        sub.set_defaults(command=command)
    sub.add_argument("--kills", type=int, default=100)
    sub.add_argument("--database", help="for the disturbed run; SQLite in a temporary folder")
    sub = commands.add_parser("storm")
    sub.add_argument("--seconds", type=float, default=60)
    sub.set_defaults(command=storm)
    options = parser.parse_args()
    options.command(options)


if __name__ == "__main__":
    main()
