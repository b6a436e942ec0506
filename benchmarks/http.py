"""Times of the service over HTTP on loopback, from a second process' point of view.

python -m benchmarks.http [--processes | --lean] [--json FILE]
"""

from __future__ import annotations

import io
import os
import socket
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from statistics import median
from time import perf_counter, sleep
from typing import Any

import numpy as np

from benchmarks.report import keep, options
from benchmarks.transfer import exchange
from service.store.kernels import Kernels
from substructures import Definition, TreeSpec, catalogue, couple, derive
from substructures.array import Array
from substructures.client import Client
from substructures.expr.program import Program
from substructures.formats.arrays import read_npz, view_npz, write_npz
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate

STATES = 100_000
TURNS, SECONDS = 5, 3.0
SERVERS = {"one process": [1], "two processes": [2], "two servers": [1, 1]}  # by their processes


@contextmanager
def server(folder: str, **settings: str) -> Iterator[Client]:
    """The service in a process of its own, on the database of the folder."""
    with serving(folder, **settings) as (client, _):
        yield client


@contextmanager
def serving(folder: str, **settings: str) -> Iterator[tuple[Client, int]]:
    """The same, and its port."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "service.cli.main", "serve", "--port", str(port)]
    command += ["--database", settings.get("database", f"sqlite:///{folder}/bench.db")]
    environment = {**os.environ, **{f"SUBSTRUCTURES_{name.upper()}": value for name, value in settings.items()}}
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL, env=environment)
    try:
        address = f"http://127.0.0.1:{port}"
        with Client(address, retries=0) as impatient:  # pauses between retries are longer than the start
            wait(impatient)
        with Client(address) as client:
            yield client, port
    finally:
        process.terminate()
        process.wait(30)


def wait(client: Client) -> None:
    """Until the server answers; at most a minute."""
    for _ in range(600):
        try:
            client.request("GET", "/livez")
        except Exception:
            sleep(0.1)
        else:
            return
    raise TimeoutError("the server did not start")


def milliseconds(work: Callable[[], Any], repeat: int) -> float:
    """Median wall time, warm."""
    times = []
    for _ in range(3):
        work()
    for _ in range(repeat):
        start = perf_counter()
        work()
        times.append(perf_counter() - start)
    return median(times) * 1e3


def in_turn(ways: dict[str, Callable[[], Any]], repeat: int) -> tuple[dict[str, float], dict[str, float]]:
    """Median wall times, warm, measured in turn: what else the machine does then disturbs all alike; and the medians of
    their ratios to the last one.
    """
    times: dict[str, list[float]] = {name: [] for name in ways}
    for _ in range(repeat + 3):
        for name, work in ways.items():
            start = perf_counter()
            work()
            times[name].append(perf_counter() - start)
    last = times[list(ways)[-1]][3:]
    ratios = {name: median(x / y for x, y in zip(some[3:], last, strict=True)) for name, some in times.items()}
    return {name: median(some[3:]) * 1e3 for name, some in times.items()}, ratios


def couplings(client: Client) -> float:
    """POST .../couplings of a 6 dof arm onto a 6 dof tree, each time a new tree, of a shape that is known."""
    times = []
    for i in range(15):
        base = {"name": "arm", "substructure": "ur5"}
        client.create_tree({"name": f"cell{i}", "gravity": [0, 0, "-9.81"], "instances": [base]})
        guest = {"name": "second", "substructure": "puma560", "at": "arm.flange"}
        start = perf_counter()
        client.couple(f"cell{i}", guest)
        times.append(perf_counter() - start)
    return median(times) * 1e3


def cpu_seconds(client: Client) -> float:
    """CPU time of the server's process so far."""
    lines = client.request("GET", "/metrics").text.splitlines()
    return next(float(line.split()[1]) for line in lines if line.startswith("process_cpu_seconds_total "))


def one_state(client: Client, figures: dict[str, float]) -> None:
    """One state of a 6 dof arm, M and Q, its kernel in memory: wall time, and CPU time of the server."""
    state: dict[str, Any] = {"quantities": ["metric", "forces"], "q": [0.1] * 6}

    def ask() -> None:
        client.request("POST", "/v1/trees/cell0@1/evaluations", state)

    ask()
    sleep(2)  # until the kernel has been compiled
    figures["http_one_state_ms"] = milliseconds(ask, 1000)
    before, count = cpu_seconds(client), 3000
    for _ in range(count):
        ask()
    figures["http_one_state_cpu_ms"] = (cpu_seconds(client) - before) / count * 1e3
    print(
        f"POST evaluations, one state of a 6 dof arm, M and Q: {figures['http_one_state_ms']:.1f} ms,"
        f" {figures['http_one_state_cpu_ms']:.2f} ms CPU of the server"
    )


def batch(client: Client, figures: dict[str, float]) -> None:
    """A batch over HTTP beside the same call in this process, kernels warm: ``http_batch_share`` is that of the rate
    of one thread, ``http_batch_share_all_threads`` that of the server's own engine, which takes all threads,
    ``http_batch_share_npz`` that of one thread which reads and writes npz as well. The bare transfer sends the same
    number of bytes between two processes, by sockets alone: ``http_batch_over_bare`` is the time of npz over its time,
    ``bare_evaluated_over_bare`` that of sockets alone between which the kernel evaluates,
    ``http_batch_packed_over_bare`` and ``http_batch_packed_float32_over_bare`` those of packed npz over that same time.
    """
    spec = TreeSpec.read(
        {"name": "own", "gravity": [0, 0, "-9.81"], "instances": [{"name": "arm", "substructure": "ur5"}]}
    )
    model = couple(spec, {"arm": derive(Definition.read(catalogue.load("ur5")))})
    engine, quantities = Kernels(None), ["metric", "forces"]
    q = np.random.default_rng(0).uniform(-3, 3, (STATES, 6))
    request = {"quantities": quantities, "q": q}

    def one_thread(program: Program, values: Mapping[str, Any], names: list[str], _: int) -> dict[str, Array]:
        return engine.compiled(program, names)[0].evaluate(values, threads=1)

    def npz_in_process() -> None:
        """The work of a request without HTTP: npz written and read, states evaluated, npz written and read."""
        sent = b"".join(write_npz({"q": q}).pieces)
        given = {"quantities": quantities, **read_npz(io.BytesIO(sent), len(sent))}
        found = evaluate(model, **given, options=EvaluationOptions(evaluator=one_thread))
        answer = b"".join(write_npz({name: found[name] for name in quantities}).pieces)
        view_npz(np.frombuffer(answer, np.uint8))

    ways: dict[str, Callable[[], Any]] = {
        "in process, one thread": lambda: evaluate(model, **request, options=EvaluationOptions(evaluator=one_thread)),
        "in process, all threads": lambda: evaluate(model, **request, options=EvaluationOptions(evaluator=engine)),
        "npz": lambda: client.evaluate("cell0@1", quantities=quantities, q=q),
        "npz, packed": lambda: client.evaluate("cell0@1", quantities=quantities, q=q, packed=True),
        "npz, packed, float32": lambda: client.evaluate(
            "cell0@1", quantities=quantities, q=q, packed=True, float32=True
        ),
        "Arrow": lambda: list(client.evaluate_batches("cell0@1", [{"q": q}], quantities=quantities)),
    }
    size = (q.nbytes, 42 * 8 * STATES)
    with exchange(*size) as transfer, exchange(*size, "--evaluate") as evaluated:
        ways |= {"npz in process": npz_in_process, "bare transfer, evaluated": evaluated, "bare transfer": transfer}
        times, ratios = in_turn(ways, 25)
    engine.close()
    one, every = times["in process, one thread"], times["in process, all threads"]
    figures["http_batch_share"], figures["http_batch_share_all_threads"] = one / times["npz"], every / times["npz"]
    figures["http_batch_share_npz"] = times["npz in process"] / times["npz"]
    figures["http_arrow_share"] = one / times["Arrow"]
    figures["bare_transfer_ms"] = times["bare transfer"]
    figures["bare_evaluated_over_bare"] = ratios["bare transfer, evaluated"]
    figures["http_batch_over_bare"] = ratios["npz"]
    figures["http_batch_packed_over_bare"] = ratios["npz, packed"]
    figures["http_batch_packed_float32_over_bare"] = ratios["npz, packed, float32"]
    print(f"{STATES:,} states of a 6 dof arm, M and Q, arrays in and out:")
    for name, each in times.items():
        shares = f"{one / each:.2f} of the rate of one thread, {every / each:.2f} of all"
        print(f"  {name}: {each:.1f} ms ({ratios[name]:.2f} times the bare transfer; {shares})")


def processes(figures: dict[str, float]) -> None:
    """Answers per second of a server with one process, of one with two, and of two servers on databases of their own,
    in turn: ``http_two_processes_*`` is the rate of two processes over that of one, ``http_two_servers_*`` that of two
    servers. Clients are in a process of their own, with so many connections.
    """
    ways: dict[str, list[str]] = {}
    with ExitStack() as opened:
        for name, counts in SERVERS.items():
            ways[name] = []
            for count in counts:
                folder = opened.enter_context(tempfile.TemporaryDirectory())
                client, port = opened.enter_context(serving(folder, processes=str(count)))
                arm = {"name": "arm", "substructure": "ur5", "at": "world"}
                client.create_tree({"name": "cell", "gravity": [0, 0, "-9.81"], "instances": [arm]})
                ways[name].append(str(port))
        sleep(5)  # until all processes answer
        for kind, connections in (("evaluations", 16), ("trees", 8)):
            rates: dict[str, list[float]] = {name: [] for name in ways}
            for turn in range(TURNS + 1):  # the first one warms up
                for name, ports in ways.items():
                    rates[name].append(answers(kind, connections, f"turn{turn}", ports))
            found = {name: median(each[1:]) for name, each in rates.items()}
            print(f"{kind}, {connections} connections: " + ", ".join(f"{n} {rate:.1f}/s" for n, rate in found.items()))
            figures[f"http_two_processes_{kind}"] = found["two processes"] / found["one process"]
            figures[f"http_two_servers_{kind}"] = found["two servers"] / found["one process"]
            print(
                f"  two processes {figures[f'http_two_processes_{kind}']:.2f} times one,"
                f" two servers {figures[f'http_two_servers_{kind}']:.2f} times"
            )


def answers(kind: str, connections: int, name: str, ports: Sequence[str]) -> float:
    """Answers per second."""
    command = [sys.executable, "-m", "benchmarks.load", kind, f"{SECONDS:g}", str(connections), name, *ports]
    return int(subprocess.run(command, check=True, capture_output=True, text=True).stdout) / SECONDS


def main() -> None:
    """Print the table; with --json FILE write the figures."""
    parser = options(__doc__)
    parser.add_argument("--processes", action="store_true", help="only one process beside two")
    parser.add_argument("--lean", action="store_true", help="only one state, and a batch")
    arguments = parser.parse_args()
    figures: dict[str, float] = {}
    if not arguments.lean:
        processes(figures)
    if arguments.processes:
        keep(figures, arguments.json)
        return
    with tempfile.TemporaryDirectory() as folder, server(folder) as client:
        if arguments.lean:
            arm = {"name": "arm", "substructure": "ur5"}
            client.create_tree({"name": "cell0", "gravity": [0, 0, "-9.81"], "instances": [arm]})
            one_state(client, figures)
            batch(client, figures)
            keep(figures, arguments.json)
            return
        figures["http_get_ms"] = milliseconds(lambda: client.substructure("puma560"), 200)
        print(f"GET a catalogue entry: {figures['http_get_ms']:.1f} ms")
        figures["http_couple_6_6_ms"] = couplings(client)
        print(f"POST couplings, 6 dof onto 6 dof, of a known shape, stored: {figures['http_couple_6_6_ms']:.0f} ms")
        one_state(client, figures)
        batch(client, figures)
    keep(figures, arguments.json)


if __name__ == "__main__":
    main()
