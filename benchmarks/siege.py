"""Attacks on a server of this package with another client measuring: what stays answered, and what the log grows by.

python -m benchmarks.siege {heads,drip,readers,streams} [--count N] [--seconds S] [--json FILE]

The server is a process of its own on 127.0.0.1 with at most 1024 descriptors; nothing else is sent to, and the attack
ends by itself: at most 2,000 connections, at most 120 seconds.

heads    requests whose head never ends, all from the address of the client that measures
drip     bodies of which a byte arrives every second
readers  answers that nobody reads
streams  streams of events of one job; printed besides: the reads of the database, as CPU time of the server
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
JOB = {"kind": "export", "items": [{"tree": "cell", "quantity": "metric", "format": "text"}]}


@contextmanager
def besieged(folder: Path) -> Iterator[tuple[int, int]]:
    """The port and the process of a server that computes no jobs."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "service.cli.main", "serve", "--port", str(port), "--engine", "none"]
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
        yield port, process.pid
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


def cpu_seconds(process: int) -> float:
    """CPU time of a process so far."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


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
    ask(port, "/v1/substructures", PENDULUM)
    ask(port, "/v1/trees", CELL)
    location = ask(port, "/v1/jobs", JOB)[1].get("location", "/none")
    held = opened(port, count, f"GET {location}/events HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    stop.wait()
    for one in held:
        one.close()


ATTACKS: dict[str, Callable[[int, int, threading.Event], None]] = {
    "heads": heads,
    "drip": drip,
    "readers": readers,
    "streams": streams,
}


def measured(port: int, seconds: float) -> dict[str, float]:
    """How a client fares that asks ten times a second, each time on a new connection."""
    times, failed, end = list[float](), 0, perf_counter() + seconds
    while perf_counter() < end:
        start = perf_counter()
        is_answered = ask(port, "/v1/trees")[0] == 200
        times.append((perf_counter() - start) * 1e3)
        failed += not is_answered
        sleep(0.1)
    times.sort()
    return {
        "asked": len(times),
        "failed": failed,
        "median_ms": times[len(times) // 2],
        "p99_ms": times[int(0.99 * (len(times) - 1))],
    }


def siege(attack: str, count: int, seconds: float) -> dict[str, float]:
    """The figures of one attack."""
    with tempfile.TemporaryDirectory() as folder, besieged(Path(folder)) as (port, process):
        before = measured(port, 2)
        stop = threading.Event()
        attacker = threading.Thread(target=ATTACKS[attack], args=(port, count, stop), daemon=True)
        attacker.start()
        sleep(1)
        cpu = cpu_seconds(process)
        found = measured(port, seconds)
        cpu = (cpu_seconds(process) - cpu) / seconds
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
