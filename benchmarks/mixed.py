"""Many clients at once, each at another work after a pause: what they wait for, and whether the server's memory stays.

python -m benchmarks.mixed [--clients 32] [--seconds 600] [--pause 0.25] [--database URL] [--processes N] [--json FILE]

The exit status is 1 unless there is no error, GETs are answered within 100 ms and evaluations of one state within
200 ms (p99), and the memory of the processes that answer is flat over the last half: in its second part at most 5 %
above its first. A pause is of exponential length, with this mean in seconds. The database is empty: an SQLite file by
default.
"""

from __future__ import annotations

import json
import os
import random
import socket
import subprocess
import sys
import tempfile
import threading
from collections import defaultdict
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from statistics import median
from time import monotonic, perf_counter, sleep
from typing import Any

from benchmarks.kills import children
from benchmarks.report import keep, options

ARM = {"name": "arm", "substructure": "ur5"}
SECOND = {"name": "second", "substructure": "puma560", "at": "arm.flange"}
CELL = {"name": "cell", "gravity": [0, 0, "-9.81"], "instances": [ARM]}
SWING = {"name": "swing", "gravity": [0, 0, "-9.81"], "instances": [{"name": "rod", "substructure": "acrobot"}]}
GETS = (
    "/v1/substructures",
    "/v1/substructures/puma560",
    "/v1/substructures/puma560/formulas",
    "/v1/substructures/puma560@1/formulas/U?format=text",
    "/v1/trees/cell",
    "/v1/trees/cell@1/metric?format=latex",
    "/substructures/ur5",
    "/v1/jobs",
    "/readyz",
)
#: milliseconds that 99 of 100 may take
LIMITS = {"get": 100.0, "state": 200.0}
#: how often each kind of work is done
SHARES = {"get": 50, "state": 35, "batch": 5, "tree": 4, "simulate": 3, "job": 3}
GROWTH = 1.05


def work(kind: str, number: int, chance: random.Random) -> tuple[str, Any]:
    """Path and body of a request; without a body a GET."""
    q = [chance.uniform(-1, 1) for _ in range(6)]
    if kind == "get":
        return chance.choice(GETS), None
    if kind == "state":
        return "/v1/trees/cell@1/evaluations", {"quantities": ["metric", "forces"], "q": q}
    if kind == "batch":
        return "/v1/trees/cell@1/evaluations", {"quantities": ["forces"], "q": [q] * 200}
    if kind == "tree":
        return "/v1/trees", {"name": f"made-{number}", "gravity": [0, 0, "-9.81"], "instances": [ARM, SECOND]}
    if kind == "simulate":
        return "/v1/trees/swing/simulations", {"q": q[:2], "span": [0, 1], "step": 0.05}
    request = {"quantities": ["metric"], "parameters": {"rod.m1": 1 + number / 1000}}
    sample = {"count": 100, "seed": number}
    return "/v1/jobs", {"kind": "evaluate", "items": [{"tree": "swing", "request": request, "sample": sample}]}


class Clients:
    """So many threads with a connection each; ``times`` in ms by kind, ``of_paths`` of GETs, ``errors`` in words."""

    def __init__(self, port: int, pause: float) -> None:
        self.port, self.pause = port, pause
        self.times: dict[str, list[float]] = defaultdict(list)
        self.of_paths: dict[str, list[float]] = defaultdict(list)
        self.errors: list[str] = []
        self.over = threading.Event()

    def run(self, number: int) -> None:
        """One client, to the end."""
        chance, connection, count = random.Random(number), None, 0  # noqa: S311 -- a simulation
        while not self.over.wait(chance.expovariate(1 / self.pause)):
            count += 1
            kind = chance.choices(list(SHARES), list(SHARES.values()))[0]
            path, body = work(kind, number * 1_000_000 + count, chance)
            connection = connection or HTTPConnection("127.0.0.1", self.port, timeout=60)
            start = perf_counter()
            try:
                status = ask(connection, path, body)
            except (OSError, HTTPException) as error:
                self.errors.append(f"{path}: {error!r}")
                connection = None
                continue
            self.times[kind].append((perf_counter() - start) * 1e3)
            if kind == "get":
                self.of_paths[path].append(self.times[kind][-1])
            if status not in (200, 201, 202):
                self.errors.append(f"{path}: {status}")


def ask(connection: HTTPConnection, path: str, body: Any) -> int:
    """The status of an answer that was read."""
    if body is None:
        connection.request("GET", path)
    else:
        connection.request("POST", path, json.dumps(body), {"Content-Type": "application/json"})
    answer = connection.getresponse()
    answer.read()
    return answer.status


@contextmanager
def served(database: str, processes: int) -> Iterator[tuple[int, subprocess.Popen[bytes]]]:
    """A server with the trees that are asked for: its port, and the process that was started."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = int(listener.getsockname()[1])
    command = [sys.executable, "-m", "service.cli.main", "serve", "--port", str(port), "--database", database]
    process = subprocess.Popen([*command, "--processes", str(processes)], stderr=subprocess.DEVNULL, env={**os.environ})
    try:
        for _ in range(1200):
            sleep(0.1)
            with suppress(OSError), closing(HTTPConnection("127.0.0.1", port, timeout=5)) as connection:
                if ask(connection, "/readyz", None) == 200:
                    break
        with closing(HTTPConnection("127.0.0.1", port, timeout=60)) as connection:
            for tree in (CELL, SWING):
                ask(connection, "/v1/trees", tree)
        yield port, process
    finally:
        process.terminate()
        process.wait(60)


def memory(pid: int) -> float:
    """MiB of the processes that answer: the children of the one that was started."""
    total = 0
    for each in children(pid):
        with suppress(OSError):
            total += int(Path(f"/proc/{each}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    return total / 2**20


def figures_of(clients: Clients, used: list[float]) -> dict[str, float]:
    """Medians, p99 and numbers of all kinds of work; memory in the third and the fourth quarter."""
    found: dict[str, float] = {"errors": len(clients.errors)}
    for kind, some in sorted(clients.times.items()):
        some.sort()
        found |= {f"{kind}_count": len(some), f"{kind}_median_ms": some[len(some) // 2]}
        found[f"{kind}_p99_ms"] = some[int(0.99 * (len(some) - 1))]
    quarter = max(1, len(used) // 4)
    found |= {"third_quarter_mb": median(used[2 * quarter : 3 * quarter] or used)}
    return found | {"last_quarter_mb": median(used[-quarter:]), "first_mb": used[0]}


def faults_of(found: dict[str, float]) -> list[str]:
    """What is not as it has to be."""
    faults = [f"{found['errors']:.0f} errors"] if found["errors"] else []
    faults += [
        f"{kind}: p99 {found[f'{kind}_p99_ms']:.0f} ms, more than {limit:g}"
        for kind, limit in LIMITS.items()
        if not found.get(f"{kind}_p99_ms", float("inf")) < limit
    ]
    if found["last_quarter_mb"] > GROWTH * found["third_quarter_mb"]:
        faults.append(f"memory grows: {found['third_quarter_mb']:.0f} to {found['last_quarter_mb']:.0f} MiB")
    return faults


def main() -> None:
    """Run the clients, print and judge the figures."""
    parser = options(__doc__)
    parser.add_argument("--clients", type=int, default=32)
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--pause", type=float, default=0.25)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--database")
    given = parser.parse_args()
    with (
        tempfile.TemporaryDirectory() as folder,
        served(given.database or f"sqlite:///{folder}/store.db", given.processes) as (port, process),
    ):
        clients, used = Clients(port, given.pause), list[float]()
        threads = [threading.Thread(target=clients.run, args=(number,)) for number in range(given.clients)]
        for thread in threads:
            thread.start()
        end = monotonic() + given.seconds
        while monotonic() < end:
            sleep(min(2.0, given.seconds / 20))
            used.append(memory(process.pid))
        clients.over.set()
        for thread in threads:
            thread.join()
    found = figures_of(clients, used)
    for name, value in found.items():
        print(f"{name:24} {value:12.2f}")
    for path, some in sorted(clients.of_paths.items()):
        some.sort()
        print(f"{path:44} median {some[len(some) // 2]:8.1f} ms, p99 {some[int(0.99 * (len(some) - 1))]:8.1f} ms")
    faults = [*faults_of(found), *clients.errors[:10]]
    print("\n".join(faults) or "as it has to be")
    keep({f"mixed_{name}": value for name, value in found.items()}, given.json)
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
