"""Sweeps beside trees made one by one: 64 x 64 numbers, a million rows of one shape, fifty shapes of the catalogue.

python -m benchmarks.sweeps [--quick] [--postgresql URL] [--json FILE]

A server in a process of its own with two workers, on an SQLite file, over HTTP: wall time from the submission to the
end of the job, the time until a submission is accepted, that until the first page of the sorted table, and the largest
memory of the server's processes, and of its workers, beside that before. ``slow``: the same combinations as a job of
the kind ``assemble``, a part of them. While a million rows are computed a client reads a part again and again: the
latency that one of a hundred exceeds. ``--postgresql``: a database without tables; the rate of rows of one shape with
one worker in a process of its own, and with two.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from statistics import quantiles
from threading import Event
from time import perf_counter, sleep
from typing import Any

import numpy as np

from benchmarks.http import server
from benchmarks.report import keep, options
from substructures.array import Array
from substructures.client import Client

REST, MOVING = [0.0] * 6, {"q": [0, 0.2, 0.3, 0, 0.5, 0], "qd": [0.1] * 6, "qdd": [0, 1, 0, 0, 0, 0]}
AT = {"q": MOVING["q"]}
TEMPLATE: dict[str, Any] = {
    "name": "cell",
    "gravity": [0, 0, "-g"],
    "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}},
    "instances": [
        {"name": "arm", "substructure": "puma560"},
        {"name": "hand", "substructure": "camera", "at": "arm.flange"},
    ],
}
FOUR: dict[str, Any] = {
    "mass": "mass",
    "torque": {"quantity": "inverse_dynamics", "of": "arm.q2", "over": MOVING},
    "inertia": {"quantity": "metric", "of": ["arm.q2", "arm.q2"], "over": AT},
    "use": "torque/mass",
}
TEN: dict[str, Any] = {
    **FOUR,
    "torque3": {"quantity": "inverse_dynamics", "of": "arm.q3", "over": MOVING},
    "inertia3": {"quantity": "metric", "of": ["arm.q3", "arm.q3"], "over": AT},
    "energy": {"quantity": "kinetic_energy", "over": {"q": MOVING["q"], "qd": MOVING["qd"]}},
    "height": {"quantity": "mass_centre.position", "of": "z", "over": AT},
    "forward": {"quantity": "mass_centre.position", "of": "x", "over": AT},
    "load": {"quantity": "gravity", "of": "arm.q2", "over": AT},
}
FREQUENCIES = {"lowest": {"analysis": "linearisation", "at": AT, "held": True, "take": "lowest_frequency"}}
ANY: dict[str, Any] = {
    "mass": "mass",
    "load": {"quantity": "gravity", "take": "largest_absolute"},
    "inertia": {"quantity": "metric", "take": "largest"},
    "height": {"quantity": "mass_centre.position", "of": "z"},
}


def sweep(client: Client, **document: Any) -> tuple[dict[str, float], str]:
    """Seconds until accepted, done, and read, and the job."""
    start = perf_counter()
    job = client.submit_job({"kind": "sweep", "template": TEMPLATE, **document})
    accepted = perf_counter()
    while not client.job(job).is_ended:
        sleep(0.02)
    done = perf_counter()
    page = client.told("GET", f"/v1/jobs/{job.id}/table?sort=-mass&page_size=50")
    read = perf_counter()
    if page["finite"] != page["rows"]:
        raise RuntimeError(f"{page['rows'] - page['finite']} rows have no numbers: {page['refused']}")
    return {"accepted_s": accepted - start, "s": done - start, "table_s": read - done}, job.id


def memory() -> Array:
    """Bytes of the processes of servers, and of their workers (proportional set size)."""
    total = np.zeros(2)
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            command = (folder / "cmdline").read_bytes()
            if b"service." in command:
                rollup = (folder / "smaps_rollup").read_text().splitlines()
                size = next(int(line.split()[1]) for line in rollup if line.startswith("Pss:"))
                total[int(b"engines.runner" in command)] += size * 1024
        except OSError:
            continue
    return total


def watched(address: str, work: Any) -> tuple[Any, list[float], Array]:
    """What the work gives, latencies [s] of reading a part meanwhile, and what was added at most to :func:`memory`."""
    ended, before = Event(), memory()

    def read() -> tuple[list[float], Array]:
        """Until the work has ended."""
        found, most = [], np.zeros(2)
        with Client(address) as other:
            while not ended.is_set():
                begun = perf_counter()
                other.request("GET", "/v1/substructures/puma560")
                found.append(perf_counter() - begun)
                most = np.maximum(most, memory() - before)
                sleep(0.02)
        return found, most

    with ThreadPoolExecutor(1) as pool:
        reading = pool.submit(read)
        try:
            result = work()
        finally:
            ended.set()
        return result, *reading.result()


def numbers(client: Client, figures: dict[str, float]) -> None:
    """64 arms and 64 tools of one part each with other numbers, and a part of them as trees."""
    arms = [{"substructure": "puma560", "parameters": {"m2": 15 + k / 16}} for k in range(64)]
    hands = [{"substructure": "camera", "parameters": {"m": 0.2 + k / 64}} for k in range(64)]
    found, _ = sweep(client, choices={"arm": arms, "hand": hands}, columns=FOUR, proof=4)
    figures |= {f"numbers_{name}": x for name, x in found.items()}
    arm, hand = TEMPLATE["instances"]
    pairs = [(i, k) for i in range(8) for k in range(8)]
    items = [
        {**TEMPLATE, "name": f"cell-{i}-{k}", "instances": [{**arm, **arms[i]}, {**hand, **hands[k]}]} for i, k in pairs
    ]
    start = perf_counter()
    client.wait(client.submit_job({"kind": "assemble", "items": items}))
    figures["numbers_slow_s"] = slow = (perf_counter() - start) * 64
    print(f"64 x 64, four columns: {found['s']:.2f} s; as trees {slow:.0f} s (64 of them measured)")


def million(client: Client, address: str, figures: dict[str, float], count: int) -> None:
    """Rows of one shape with ten columns, and with a frequency."""
    of = {"hand.m": {"uniform": [0.1, 2]}, "arm.m2": {"normal": [17.4, 0.5]}, "g": {"uniform": [9.7, 9.9]}}
    samples = {"method": "sobol", "count": count, "of": of}
    goal = {"minimise": ["mass", "torque"], "maximise": ["forward"]}
    for name, columns in (("rows", TEN), ("rows_with_frequency", {**TEN, **FREQUENCIES})):
        document = {"samples": samples, "columns": columns, "pareto": goal, "proof": 8}
        (found, job), reads, added = watched(address, lambda document=document: sweep(client, **document))
        start = perf_counter()
        front = client.table(job, front=True)
        figures |= {f"{name}_{key}": x for key, x in found.items()}
        figures |= {f"{name}_front_s": perf_counter() - start, f"{name}_added_mb": added[0] / 1e6}
        figures[f"{name}_workers_mb"] = added[1] / 1e6
        figures[f"{name}_get_p99_ms"] = quantiles(reads, n=100)[-1] * 1e3
        told = {
            f"{count:,} rows, {len(columns)} columns": f"{found['s']:.2f} s, {found['s'] / count * 1e6:.2f} us a row",
            "accepted": f"{found['accepted_s'] * 1e3:.0f} ms",
            "first page, sorted": f"{found['table_s']:.2f} s",
            f"front of {len(front['row'])} rows": f"{figures[f'{name}_front_s']:.2f} s",
            "memory": f"{added[0] / 1e6:.0f} MB more, workers {added[1] / 1e6:.0f}",
            "GET meanwhile, p99": f"{figures[f'{name}_get_p99_ms']:.0f} ms",
        }
        print("; ".join(f"{what}: {figure}" for what, figure in told.items()))


def catalogue(client: Client, figures: dict[str, float], count: int) -> None:
    """Arms with tools of the catalogue, so many rows each."""
    arms = ["puma560", "ur5", "ur10", "kuka-iiwa-14", "scara", "gantry", "planar-2r", "planar-3r", "humanoid-arm"]
    arms += ["spherical-wrist"]
    tools = ["camera", "welding-torch", "flange-tool", "parallel-gripper", "screw-gripper"]
    placed = [{"substructure": tool, "at": "arm.flange"} for tool in tools]
    samples = {"method": "random", "count": count, "of": {"g": {"uniform": [1, 10]}}}
    choices = {"arm": [{"substructure": arm} for arm in arms], "hand": placed}
    start = perf_counter()
    job = client.sweep({"template": TEMPLATE, "choices": choices, "samples": samples, "columns": ANY, "proof": 8})
    seconds = perf_counter() - start
    page = client.told("GET", f"/v1/jobs/{job.id}/table?page_size=1")
    shapes = page["finite"] // count
    figures |= {"shapes_s": seconds, "shapes": shapes}
    print(f"{shapes} shapes of the catalogue, {page['finite']:,} rows: {seconds:.2f} s; without {page['refused']}")


@contextmanager
def workers(database: str, count: int) -> Iterator[None]:
    """So many processes ``substructures worker`` with one runner each."""
    command = [sys.executable, "-m", "service.cli.main", "worker", "--database", database, "--workers", "1"]
    started = [subprocess.Popen(command, stderr=subprocess.DEVNULL) for _ in range(count)]
    try:
        yield
    finally:
        for each in started:
            each.terminate()
        for each in started:
            each.wait(30)


def shared(database: str, figures: dict[str, float], count: int) -> None:
    """Rows of one shape by workers on PostgreSQL, the first of which make the kernels and are not counted."""
    of = {"hand.m": {"uniform": [0.1, 2]}, "arm.m2": {"normal": [17.4, 0.5]}, "g": {"uniform": [9.7, 9.9]}}
    with tempfile.TemporaryDirectory() as folder, server(folder, database=database, engine="none") as client:
        for many in (1, 2):
            with workers(database, many):
                for seed, rows in ((many, 20_000 * many), (10 + many, count)):
                    samples = {"method": "random", "seed": seed, "count": rows, "of": of}
                    found, _ = sweep(client, samples=samples, columns=TEN)
            figures[f"postgresql_rows_per_s_{many}"] = count / found["s"]
    one, two = (figures[f"postgresql_rows_per_s_{many}"] for many in (1, 2))
    print(f"PostgreSQL, {count:,} rows: {one:,.0f} rows/s with one worker, {two:,.0f} with two")


def main() -> None:
    """Measure."""
    parser = options(__doc__, "fewer rows")
    parser.add_argument("--postgresql", help="address of a database without tables")
    given = parser.parse_args()
    figures: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder, server(folder, workers="2") as client:
        for name in ("puma560", "camera"):
            client.substructure(name)
        numbers(client, figures)
        million(client, client.address, figures, 10**5 if given.quick else 10**6)
        catalogue(client, figures, 1000 if given.quick else 20_000)
    if given.postgresql:
        shared(given.postgresql, figures, 10**5 if given.quick else 10**6)
    keep(figures, given.json)


if __name__ == "__main__":
    main()
