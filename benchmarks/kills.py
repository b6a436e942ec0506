"""kill -9 of servers, of one of several processes, of workers and of runners while clients store.

Nothing that was acknowledged may be lost, or be there twice.

python -m benchmarks.kills [--kills N] [--seed S] [--processes N] [--database URL] [--file FILE]

The database is empty: an SQLite file by default. Kills of every run add up in the file, so that many may be had in
parts. The exit status is 1 where anything was lost, doubled or wrong.

server   all of a server: the process that holds the port, with those that answer; it is started again here
process  where several answer: one of them, which the server starts again by itself
runner   a process that computes items of jobs; after three deaths an item may fail, and says so
worker   on PostgreSQL: a process of its own that hands items out; it is started again here
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import httpx2

from substructures.client import Client, ProblemError

PENDULUM = {
    "name": "pendulum",
    "parameters": {"l": {"value": 1, "unit": "m"}},
    "bodies": [
        {
            "name": "rod",
            "parent": "base",
            "joint": {"type": "revolute", "coordinate": "q"},
            "mass": 1,
            "com": ["l", 0, 0],
            "inertia": {"xx": 1, "yy": 1, "zz": 1},
        }
    ],
    "ports": [{"name": "tip", "body": "rod", "position": ["l", 0, 0]}],
}
#: how often each is killed, of what there is
SHARES = {"server": 2, "process": 5, "runner": 11, "worker": 2}
COUPLINGS = 8  # of a tree, each a revision
PATIENCE = 300.0  # seconds
PAUSE = 0.3  # seconds between the requests of a client


class Farm:
    """A server of one or more processes, on PostgreSQL a worker beside it, which are killed and started again."""

    def __init__(self, database: str, folder: Path, processes: int) -> None:
        with socket.create_server(("127.0.0.1", 0)) as listener:
            self.port = int(listener.getsockname()[1])
        self.address = f"http://127.0.0.1:{self.port}"
        self.has_worker, self.has_processes = not database.startswith("sqlite"), processes > 1
        program = [sys.executable, "-m", "service.cli.main"]
        common = ["--workers", "1", "--database", database]
        self._commands = {
            "server": [*program, "serve", "--port", str(self.port), "--processes", str(processes), *common]
        }
        if self.has_worker:
            self._commands["worker"] = [*program, "worker", *common]
        settings = {"SUBSTRUCTURES_CATALOGUE": "0", "SUBSTRUCTURES_LIMIT_LEASE_SECONDS": "3"}
        self._environment = {**os.environ, **settings}
        self._log = folder / "log"
        self._processes: dict[str, subprocess.Popen[bytes]] = {}

    @contextmanager
    def running(self) -> Iterator[None]:
        """All of it, stopped at the end."""
        try:
            for kind in self._commands:
                self.start(kind)
            self.wait()
            yield
        finally:
            for process in self._processes.values():
                process.terminate()
            for process in self._processes.values():
                process.wait(60)

    def start(self, kind: str) -> None:
        """Start a server or a worker."""
        with self._log.open("ab") as log:
            self._processes[kind] = subprocess.Popen(
                self._commands[kind], stdout=log, stderr=log, env=self._environment
            )

    def wait(self) -> None:
        """Until it answers. Raises RuntimeError."""
        end = monotonic() + PATIENCE
        while monotonic() < end:
            with suppress(httpx2.HTTPError):
                if httpx2.get(f"{self.address}/readyz", timeout=5).status_code == 200:
                    return
            sleep(0.05)
        raise RuntimeError(f"the server does not answer: {self._log.read_text()[-2000:]}")

    def kill(self, kind: str, chance: random.Random) -> bool:
        """Kill one of a kind, if there is one now."""
        if kind in self._processes:
            self._processes[kind].kill()
            self._processes[kind].wait(60)
            self.start(kind)
            if kind == "server":
                self.wait()
            return True
        server = self._processes["server"].pid
        answering = children(server) if self.has_processes else [server]
        parents = [*answering, *(p.pid for name, p in self._processes.items() if name == "worker")]
        found = answering if kind == "process" else [pid for parent in parents for pid in children(parent)]
        with suppress(ProcessLookupError):
            if found:
                os.kill(chance.choice(found), signal.SIGKILL)
                return True
        return False


def children(pid: int) -> list[int]:
    """The processes that a process has started."""
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            fields = status.read_text().rpartition(")")[2].split()
            if int(fields[1]) == pid and fields[0] != "Z":
                found.append(int(status.parent.name))
    return found


class Writer(threading.Thread):
    """Sends one request after the other, each under a key of its own until it is acknowledged."""

    def __init__(self, farm: Farm, name: str, requests: Iterator[tuple[str, Any]]) -> None:
        super().__init__(daemon=True)
        self.farm, self.prefix, self.requests = farm, name, requests
        self.over = threading.Event()
        self.acknowledged: list[tuple[Any, dict[str, Any]]] = []
        self.error = ""

    def run(self) -> None:
        try:
            for path, body in self.requests:
                answer = self._acknowledged(path, body, f"{self.prefix}-{len(self.acknowledged)}")
                if answer is None:
                    return
                self.acknowledged.append((body, answer))
                self.over.wait(PAUSE)
        except Exception as error:  # whatever it is, the run has failed
            self.error = f"{self.prefix}: {error}"

    def _acknowledged(self, path: str, body: Any, key: str) -> dict[str, Any] | None:
        """The answer, after as many attempts as it takes; None when the run is over."""
        while not self.over.is_set():
            try:
                with Client(self.farm.address, timeout=30) as client:
                    answer = client.request("POST", path, body, headers={"Idempotency-Key": key})
                    return dict(answer.json())
            except (httpx2.HTTPError, ProblemError) as error:
                if isinstance(error, ProblemError) and error.status not in (409, 503):
                    raise
                sleep(0.05)
        return None


def growing(name: str) -> Iterator[tuple[str, Any]]:
    """Trees, each with some more couplings."""
    instance = {"name": "i0", "substructure": "pendulum"}
    for tree in range(10**6):
        yield "/v1/trees", {"name": f"{name}-{tree}", "instances": [instance]}
        for k in range(1, COUPLINGS):
            more = {"name": f"i{k}", "substructure": "pendulum", "at": f"i{k - 1}.tip"}
            yield f"/v1/trees/{name}-{tree}/couplings", more


def jobs(name: str) -> Iterator[tuple[str, Any]]:
    """Small jobs, of which no two are equal."""
    for k in range(10**6):
        length = {"a.l": k + 1}
        sample = {"count": 50, "seed": k, "ranges": {"a.q": [-3, 3]}}
        request = {"quantities": ["metric", "forces"], "parameters": length}
        yield "/v1/jobs", {"kind": "evaluate", "items": [{"tree": "probe", "request": request, "sample": sample}]}
        items = [{"name": f"{name}-{k}-{i}", "instances": [{"name": "i0", "substructure": "pendulum"}]} for i in "ab"]
        yield "/v1/jobs", {"kind": "assemble", "items": items}


def faults_of_trees(client: Client, name: str, writer: Writer) -> Iterator[str]:
    """Every acknowledged revision has to be there, once, with the digest that it was acknowledged with."""
    latest = Counter[str]()
    for body, answer in writer.acknowledged:
        tree = f"{answer['name']}@{answer['revision']}"
        latest[answer["name"]] += 1
        if answer["revision"] != latest[answer["name"]]:
            yield f"{tree} is revision {latest[answer['name']]} of those acknowledged: one is doubled"
        try:
            found = client.request("GET", f"/v1/trees/{tree}").json()
        except ProblemError as error:
            yield f"{tree} is lost: {error}"
            continue
        if found["digest"] != answer["digest"] or body["name"] not in (found["name"], found["coordinates"][-1][:-2]):
            yield f"{tree} is not what was acknowledged"
    for tree, count in latest.items():
        most = client.request("GET", f"/v1/trees/{tree}").json()["revision"]
        if most > count + 1 or (
            most > count and tree != writer.acknowledged[-1][1]["name"]
        ):  # one in flight at the end
            yield f"{tree} of {name} has {most} revisions, {count} are acknowledged"


def faults_of_jobs(client: Client, writers: list[Writer]) -> Iterator[str]:
    """Every acknowledged job has to end, and every item to have a result that can be read; there are no others."""
    acknowledged = [answer["id"] for writer in writers for _, answer in writer.acknowledged]
    listed = [job["id"] for job in client.jobs()]
    if len(set(listed)) != len(listed) or len(set(acknowledged)) != len(acknowledged):
        yield "a job is there twice"
    if set(acknowledged) - set(listed):
        yield f"{len(set(acknowledged) - set(listed))} jobs are lost"
    if len(set(listed) - set(acknowledged)) > len(writers):  # one in flight each at the end
        yield f"{len(set(listed) - set(acknowledged))} jobs are there that nobody was told of"
    for job in listed:
        view = client.wait(job)
        for item in client.job_items(job):
            died = item["state"] == "failed" and item["problem"]["code"] == "worker-died" and len(item["deaths"]) == 3
            if item["state"] != "succeeded" and not died:
                yield f"item {item['position']} of job {job} ({view['state']}): {item}"
            for file in item["files"] if item["state"] == "succeeded" else ():
                client.request("GET", file["href"])


def besieged(database: str, folder: Path, kills: int, seed: int, processes: int) -> tuple[Counter[str], list[str]]:
    """Kills by kind, with numbers of what was acknowledged; and what is wrong."""
    farm, chance, counts = Farm(database, folder, processes), random.Random(seed), Counter[str]()  # noqa: S311 -- a simulation
    with farm.running():
        with Client(farm.address) as client:
            client.submit(PENDULUM)
            client.create_tree({"name": "probe", "instances": [{"name": "a", "substructure": "pendulum"}]})
        made: dict[str, Callable[[str], Iterator[tuple[str, Any]]]] = {"t": growing, "u": growing, "j": jobs, "k": jobs}
        writers = {name: Writer(farm, name, requests(name)) for name, requests in made.items()}
        for writer in writers.values():
            writer.start()
        there = {"worker": farm.has_worker, "process": farm.has_processes}
        kinds = [kind for kind in SHARES if there.get(kind, True)]
        while counts.total() < kills and not any(writer.error for writer in writers.values()):
            sleep(chance.uniform(0.0, 0.6))
            kind = chance.choices(kinds, [SHARES[kind] for kind in kinds])[0]
            counts[kind] += farm.kill(kind, chance)
        for writer in writers.values():
            writer.over.set()
        for writer in writers.values():
            writer.join()
        farm.wait()
        faults = [writer.error for writer in writers.values() if writer.error]
        with Client(farm.address, timeout=60) as client:
            for name in "tu":
                faults += faults_of_trees(client, name, writers[name])
            faults += faults_of_jobs(client, [writers["j"], writers["k"]])
        counts["revisions"] = sum(len(writers[name].acknowledged) for name in "tu")
        counts["jobs"] = sum(len(writers[name].acknowledged) for name in "jk")
    return counts, faults


def main() -> None:
    """Kill, look, add the figures to the file, and print them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=50, help="how many")
    parser.add_argument("--seed", type=int, default=0, help="of the moments")
    parser.add_argument("--processes", type=int, default=2, help="that answer")
    parser.add_argument("--database", help="URL of an empty database")
    parser.add_argument("--file", type=Path, help="where kills add up")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        database = given.database or f"sqlite:///{folder}/store.db"
        counts, faults = besieged(database, Path(folder), given.kills, given.seed, given.processes)
    kind = f"{database.partition(':')[0].partition('+')[0]}, processes: {given.processes}"
    so_far = json.loads(given.file.read_text()) if given.file and given.file.exists() else {}
    total = Counter(so_far.get(kind, {})) + counts + Counter({"runs": 1, "faults": len(faults)})
    if given.file:
        given.file.write_text(json.dumps({**so_far, kind: dict(total)}, indent=2) + "\n")
    print(f"{kind}: {dict(counts)}; in all {dict(total)}")
    print("\n".join(faults) or "nothing lost, nothing doubled")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
