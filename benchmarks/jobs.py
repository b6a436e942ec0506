"""Batch jobs: overhead of a small item, two workers beside one, and the service while a long queue waits.

python -m benchmarks.jobs [--quick] [--json FILE]

Overhead of an item: wall time of a job of small items, times the number of workers, less the time that the same items
take when their work is called directly in one process, for each item. Everything else is as users see it: a server in
a process of its own, on an SQLite file, over HTTP.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from datetime import datetime
from multiprocessing import get_context
from statistics import median, quantiles
from time import perf_counter
from typing import Any

from benchmarks.http import server
from benchmarks.report import keep, options
from substructures import Definition, TreeSpec, catalogue, couple, derive
from substructures.client import Client

PARTS = ("puma560", "parallel-gripper", "simple-pendulum", "ur5")


@contextmanager
def prepared(folder: str, workers: int) -> Iterator[Client]:
    """The service with so many workers and the parts."""
    with server(folder, workers=str(workers), catalogue="false") as client:
        for name in PARTS:
            client.submit(catalogue.load(name))
        yield client


def tree(i: int, arm: str, hand: str) -> dict[str, Any]:
    """An assembly; all are different."""
    instances = [
        {"name": "arm", "substructure": arm},
        {"name": "hand", "substructure": hand, "at": "arm.base", "placement": {"position": [0, 0, f"{i}/1000"]}},
    ]
    return {"name": f"{arm}-{hand}-{i}", "gravity": [0, 0, "-9.81"], "instances": instances}


def run(client: Client, items: list[dict[str, Any]]) -> float:
    """Seconds from the acknowledged submission to the last result, by the clock of the server."""
    view = client.wait(client.submit_job({"kind": "assemble", "items": items})["id"])
    if view["state"] != "succeeded":
        raise RuntimeError(f"the job {view['state']}: {view['error']}")
    begun, ended = (datetime.fromisoformat(view[name]) for name in ("created", "finished"))
    return (ended - begun).total_seconds()


def directly(items: list[dict[str, Any]]) -> float:
    """Seconds that the same work takes in this process."""
    parts = {name: derive(Definition.read(catalogue.load(name))) for name in PARTS}
    start = perf_counter()
    for item in items:
        spec = TreeSpec.read(item)
        couple(spec, {i.name: parts[str(i.substructure)] for i in spec.instances}).program.to_bytes()
    return perf_counter() - start


def overhead(figures: dict[str, float], count: int) -> None:
    """Small items: two pendulums coupled."""
    items = [tree(i, "simple-pendulum", "simple-pendulum") for i in range(count)]
    first = [tree(count + i, "simple-pendulum", "simple-pendulum") for i in range(50)]
    inside = directly(items)
    with tempfile.TemporaryDirectory() as folder, prepared(folder, 1) as client:
        run(client, first)
        whole = run(client, items)
    figures["job_overhead_ms"] = (whole - inside) / count * 1e3
    figures["job_item_ms"] = whole / count * 1e3
    print(f"{count:,} small items, one worker: {figures['job_item_ms']:.2f} ms an item, ", end="")
    print(f"of which {inside / count * 1e3:.2f} ms are work; overhead {figures['job_overhead_ms']:.2f} ms")


def two_workers(figures: dict[str, float], count: int, rounds: int) -> None:
    """Items of 6 + 6 degrees of freedom; beside it two processes that couple them and share nothing but the machine.

    Servers with one and with two workers, one process and two take turns, since the speed of a machine changes.
    """
    ratios, apart = [], []
    with (
        tempfile.TemporaryDirectory() as folder,
        tempfile.TemporaryDirectory() as other,
        prepared(folder, 1) as one,
        prepared(other, 2) as two,
        ProcessPoolExecutor(2, get_context("spawn")) as pool,
    ):
        for k in range(-1, rounds):  # the first turns make all warm
            items = [tree(k * count + i, "puma560", "ur5") for i in range(count)]
            ratio, half = run(one, items) / run(two, items), items[: count // 2]
            pair = max(pool.map(directly, (half, half)))
            if k >= 0:
                ratios.append(ratio)
                apart.append(2 * pool.submit(directly, half).result() / pair)
    figures["jobs_two_workers"], figures["two_processes"] = median(ratios), median(apart)
    low, _, high = quantiles(ratios, n=4)
    print(
        f"two workers: {figures['jobs_two_workers']:.2f} times one, in half of {rounds} turns {low:.2f} to {high:.2f}",
        end="",
    )
    print(f" ({count} couplings of 6 + 6 dof); two processes that share nothing: {figures['two_processes']:.2f}")


def while_queued(figures: dict[str, float], count: int, reads: int) -> None:
    """The latency of GET while items are submitted, and while they wait and one worker computes."""
    with (
        tempfile.TemporaryDirectory() as folder,
        prepared(folder, 1) as client,
        ProcessPoolExecutor(1, get_context("spawn")) as pool,
    ):
        quiet = latencies(client, reads)
        pool.submit(submit, client.address, 10).result()  # imports
        submitted = pool.submit(submit, client.address, count)
        submitting = latencies(client, 0, submitted)
        figures["job_submit_s"] = submitted.result()
        busy = latencies(client, reads)
    for name, times in (("quiet", quiet), ("submitting", submitting), ("queued", busy)):
        figures[f"get_{name}_p99_ms"] = quantiles(times, n=100)[98]
        print(f"GET, {name}: median {median(times):.1f} ms, p99 {figures[f'get_{name}_p99_ms']:.1f} ms", end="")
        print(f", longest {max(times):.1f} ms ({len(times):,} requests)")
    print(f"{count:,} items submitted in {figures['job_submit_s']:.2f} s")


def submit(address: str, count: int) -> float:
    """Seconds that a submission takes; in a process of its own, so that only the server is measured."""
    items = [tree(i, "puma560", "ur5") for i in range(count)]
    with Client(address, timeout=300) as client:
        start = perf_counter()
        client.request("POST", "/v1/jobs", {"kind": "assemble", "items": items})
        return perf_counter() - start


def latencies(client: Client, count: int, until: Future[float] | None = None) -> list[float]:
    """Milliseconds of GETs of the catalogue, so many or until something is done."""
    times: list[float] = []
    while len(times) < count or not (until is None or until.done()):
        start = perf_counter()
        client.substructure("puma560")
        times.append((perf_counter() - start) * 1e3)
    return times


def main() -> None:
    """Print the table; with --json FILE write the figures."""
    arguments = options(__doc__, "fewer items").parse_args()
    figures: dict[str, float] = {}
    scale = 5 if arguments.quick else 1
    overhead(figures, 1500 // scale)
    two_workers(figures, 60, 20 // scale)
    while_queued(figures, 10_000 // scale, 1000 // scale)
    keep(figures, arguments.json)


if __name__ == "__main__":
    main()
