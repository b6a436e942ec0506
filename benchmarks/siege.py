"""Attacks on a server of this package with another client measuring: what stays answered, and what the log grows by.

python -m benchmarks.siege {heads,drip,readers,streams,derivations} [--count N] [--seconds S] [--json FILE]

The server is a process of its own on 127.0.0.1 with at most 1024 descriptors; nothing else is sent to, and the attack
ends by itself: at most 2,000 connections, at most 120 seconds.

heads    requests whose head never ends, all from the address of the client that measures
drip     bodies of which a byte arrives every second
readers  answers that nobody reads
streams  streams of events of one job; printed besides: the reads of the database, as CPU time of the server
derivations  definitions of chains of 40 joints, all at once; the server computes jobs

Servers, workers and runners that are killed: benchmarks.kills; many clients at other works: benchmarks.mixed.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import socket
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from time import perf_counter, sleep

from benchmarks.report import keep

DESCRIPTORS = 1024
MOST, LONGEST = 2000, 120.0
PENDULUM = {
    "name": "pendulum",
    "bodies": [{"name": "a", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}, "mass": 1}],
}
CELL = {"name": "cell", "gravity": [0, 0, -9.81], "instances": [{"name": "a", "substructure": "pendulum"}]}
STATE = {"quantities": ["metric", "forces"], "q": [0.1]}
JOB = {"kind": "export", "items": [{"tree": "cell", "quantity": "metric", "format": "text"}]}


@contextmanager
def besieged(folder: Path, engine: str) -> Iterator[int]:
    """The port of a server; ``engine``: none where it computes no jobs."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "service.cli.main", "serve", "--port", str(port), "--engine", engine]
    command += ["--database", f"sqlite:///{folder}/siege.db"]
    few = (DESCRIPTORS, DESCRIPTORS)
    with (folder / "log").open("wb") as log:
        process = subprocess.Popen(
            command,
            stderr=log,
            env={**os.environ, "SUBSTRUCTURES_CATALOGUE": "0"},
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, few),
        )
    try:
        for _ in range(300):
            if ask(port, "/livez")[0] == 200:
                break
            sleep(0.1)
        yield port
    finally:
        process.terminate()
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def ask(port: int, path: str, body: object = None) -> tuple[int, dict[str, str]]:
    """Status and headers of an answer on a connection of its own; 0 for none within five seconds."""
    with closing(HTTPConnection("127.0.0.1", port, timeout=5)) as connection:
        try:
            if body is None:
                connection.request("GET", path)
            else:
                connection.request("POST", path, json.dumps(body), {"Content-Type": "application/json"})
            answer = connection.getresponse()
            answer.read()
        except (OSError, HTTPException):
            return 0, {}
        return answer.status, dict(answer.getheaders())


def cpu_seconds(port: int) -> float:
    """CPU time so far of the process that answers."""
    with closing(HTTPConnection("127.0.0.1", port, timeout=10)) as connection:
        connection.request("GET", "/metrics")
        lines = connection.getresponse().read().decode().splitlines()
    return next(float(line.split()[1]) for line in lines if line.startswith("process_cpu_seconds_total "))


def opened(port: int, count: int, text: bytes) -> list[socket.socket]:
    """Connections that have sent a text; those that are refused are left out."""
    found = []
    for _ in range(count):
        one = socket.socket()
        one.settimeout(2)
        try:
            one.connect(("127.0.0.1", port))
            one.sendall(text)
        except OSError:
            one.close()
            continue
        found.append(one)
    return found


def heads(port: int, count: int, stop: threading.Event) -> None:
    """Heads without an end, opened again when the server has closed them."""
    while not stop.is_set():
        held = opened(port, count, b"GET /livez HTTP/1.1\r\nHost: localhost\r\nX-Slow: ")
        stop.wait(5)
        for one in held:
            one.close()


def drip(port: int, count: int, stop: threading.Event) -> None:
    """Bodies of which a byte arrives every second."""
    named = b"Host: localhost\r\nContent-Type: application/json\r\nContent-Length: 100000\r\n\r\n"
    held = opened(port, count, b"POST /v1/trees HTTP/1.1\r\n" + named)
    while not stop.wait(1):
        for one in held:
            try:
                one.send(b" ")
            except OSError:
                continue
    for one in held:
        one.close()


def readers(port: int, count: int, stop: threading.Event) -> None:
    """Answers that nobody reads."""
    text = b"GET /openapi.json HTTP/1.1\r\nHost: localhost\r\n\r\n" * 20
    held = opened(port, count, text)
    stop.wait()
    for one in held:
        one.close()


def streams(port: int, count: int, stop: threading.Event) -> None:
    """Streams of events of a job that waits."""
    location = ask(port, "/v1/jobs", JOB)[1].get("location", "/none")
    held = opened(port, count, f"GET {location}/events HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    stop.wait()
    for one in held:
        one.close()


def derivations(port: int, count: int, stop: threading.Event) -> None:
    """Definitions of chains of 40 joints, each with numbers of its own."""

    def define(k: int) -> None:
        """Submit one."""
        ask(port, "/v1/substructures", chain(f"chain{k}", k))

    threads = [threading.Thread(target=define, args=(k,), daemon=True) for k in range(min(count, 64))]
    for each in threads:
        each.start()
    stop.wait()


def chain(name: str, k: int) -> dict[str, object]:
    """40 revolute joints, every second axis turned, and symbols for all masses."""
    bodies = [
        {
            "name": f"b{i}",
            "parent": f"b{i - 1}" if i else "base",
            "joint": {"type": "revolute", "coordinate": f"q{i}", "theta": "pi/2" if i % 2 else 0, "d": 0.3 + k / 100},
            "mass": f"m{i}",
            "com": [0.1, 0.2, 0.3],
            "inertia": {"xx": 1, "yy": 1, "zz": 1},
        }
        for i in range(40)
    ]
    return {"name": name, "parameters": {f"m{i}": {"value": 1, "unit": "kg"} for i in range(40)}, "bodies": bodies}


ATTACKS: dict[str, Callable[[int, int, threading.Event], None]] = {
    "heads": heads,
    "drip": drip,
    "readers": readers,
    "streams": streams,
    "derivations": derivations,
}


def measured(port: int, seconds: float) -> dict[str, float]:
    """How a client fares that reads, and evaluates one state, ten times a second, each time on a new connection."""
    times: dict[str, list[float]] = {"": [], "evaluation_": []}
    failed, end = 0, perf_counter() + seconds
    while perf_counter() < end:
        for name, path, body in (("", "/v1/trees", None), ("evaluation_", "/v1/trees/cell@1/evaluations", STATE)):
            start = perf_counter()
            failed += ask(port, path, body)[0] != 200
            times[name].append((perf_counter() - start) * 1e3)
        sleep(0.1)
    figures = {"asked": float(sum(map(len, times.values()))), "failed": failed}
    for name, some in times.items():
        some.sort()
        figures |= {f"{name}median_ms": some[len(some) // 2], f"{name}p99_ms": some[int(0.99 * (len(some) - 1))]}
    return figures


def siege(attack: str, count: int, seconds: float) -> dict[str, float]:
    """The figures of one attack."""
    engine = "local" if attack == "derivations" else "none"
    with tempfile.TemporaryDirectory() as folder, besieged(Path(folder), engine) as port:
        ask(port, "/v1/substructures", PENDULUM)
        ask(port, "/v1/trees", CELL)
        before = measured(port, 2)
        stop = threading.Event()
        attacker = threading.Thread(target=ATTACKS[attack], args=(port, count, stop), daemon=True)
        attacker.start()
        sleep(1)
        cpu = cpu_seconds(port)
        found = measured(port, seconds)
        cpu = (cpu_seconds(port) - cpu) / seconds
        stop.set()
        attacker.join(30)
        log = (Path(folder) / "log").stat().st_size
    return {
        **{f"siege_{attack}_{name}": value for name, value in found.items()},
        f"siege_{attack}_quiet_p99_ms": before["p99_ms"],
        f"siege_{attack}_cpu_share": cpu,
        f"siege_{attack}_log_bytes": log,
    }


def main() -> None:
    """Run one attack and print its figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("attack", choices=ATTACKS)
    parser.add_argument("--count", type=int, default=1000, help=f"connections, at most {MOST}")
    parser.add_argument("--seconds", type=float, default=20.0, help=f"at most {LONGEST:g}")
    parser.add_argument("--json", type=Path, help="add the figures to this file")
    given = parser.parse_args()
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(MOST + 100, most), most))
    figures = siege(given.attack, min(given.count, MOST), min(given.seconds, LONGEST))
    for name, value in figures.items():
        print(f"{name:32} {value:12.3f}")
    keep(figures, given.json)


if __name__ == "__main__":
    main()
