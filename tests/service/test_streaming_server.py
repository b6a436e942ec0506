"""Evaluations larger than memory, against a server: any number of batches, faults in mid-stream, memory."""

from __future__ import annotations

import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import anyio
import httpx2
import numpy as np
import pytest

from service.server import background
from service.settings import Limits, Settings
from substructures.client import Client, ProblemError

from .conftest import PENDULUM, TREE
from .farm import children


def same(one: np.ndarray[Any, Any], other: np.ndarray[Any, Any]) -> None:
    np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-14)


@contextmanager
def server(folder: Path, *arguments: str) -> Iterator[tuple[Client, int]]:
    """The service in a process of its own; a client and the id of the process that started those that answer."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "service.cli.main", "serve", "--port", str(port), *arguments]
    process = subprocess.Popen([*command, "--database", f"sqlite:///{folder}/store.db"], stderr=subprocess.DEVNULL)
    try:
        with Client(f"http://127.0.0.1:{port}", timeout=120) as client:
            wait(client)
            yield client, process.pid
    finally:
        process.terminate()
        process.wait(20)


def wait(client: Client) -> None:
    for _ in range(300):
        try:
            client.request("GET", "/livez")
        except httpx2.HTTPError:
            anyio.run(anyio.sleep, 0.1)
        else:
            return
    raise TimeoutError("the server did not start")


def test_many_batches(tmp_path: Path) -> None:
    """200,000 states in 100 batches, more than any single answer may have."""
    limits = Limits(states=2000, binary_bytes=2**16, json_bytes=2**14)
    settings = Settings(database=f"sqlite:///{tmp_path}/store.db", catalogue=False, limits=limits)
    q = np.linspace(-3, 3, 2000)[:, None]
    with background(settings) as address, Client(address) as client:
        client.submit(PENDULUM)
        client.create_tree(TREE)
        known = client.evaluate("cell", quantities=["forces"], q=q[::500].tolist())["forces"]
        found = list(client.evaluate_batches("cell", [{"q": q}] * 100, quantities=["metric", "forces"]))
        assert sum(part["count"] for part in found) == 200_000
        for part in (found[0], found[-1]):
            np.testing.assert_allclose(part["forces"][::500], known, rtol=1e-12)


def test_faults_of_later_batches_cut_the_answer_off(tmp_path: Path) -> None:
    """The first parts have been sent by then; what was sent before the fault is right, and the end is missing."""
    settings = Settings(database=f"sqlite:///{tmp_path}/store.db", catalogue=False)
    q, counts = np.linspace(-3, 3, 60_000)[:, None], list[int]()
    with background(settings) as address, Client(address) as client:
        client.submit(PENDULUM)
        client.create_tree(TREE)
        parts = client.evaluate_batches("cell", [*[{"q": q}] * 20, {"q": q * np.nan}], quantities=["metric"])
        with pytest.raises(httpx2.RemoteProtocolError):
            counts.extend(part["count"] for part in parts)
        assert 0 < sum(counts) <= 20 * len(q)
        assert client.request("GET", "/livez").status_code == 200
        gone = client.evaluate_batches("cell", [{"q": q}] * 20, quantities=["metric"])
        assert next(gone)["count"]
        gone.close()  # a client may leave at any time
        assert client.request("GET", "/livez").status_code == 200
        with pytest.raises(ProblemError, match="not finite"):  # a fault of the first batch is told
            next(client.evaluate_batches("cell", [{"q": q * np.nan}], quantities=["metric"]))


def test_arrays_in_arrays_out(tmp_path: Path) -> None:
    """The client answers arrays with arrays, structured as in JSON, whichever way they travel."""
    settings = Settings(database=f"sqlite:///{tmp_path}/store.db", catalogue=False)
    q, masses = np.linspace(-1, 1, 6)[:, None], np.array([1.0, 0, 1, 1, 0, 1])
    names = ["forward_dynamics", "kinetic_energy", "kinematics"]
    with background(settings) as address, Client(address) as client:
        client.submit(PENDULUM)
        client.create_tree(TREE)
        known = client.evaluate("cell", quantities=names, q=q.tolist(), parameters={"arm.m": masses.tolist()})
        whole = client.evaluate("cell", quantities=names, q={"arm.q": q[:, 0]}, parameters={"arm.m": masses})
        halves = [{"q": q[rows], "parameters": {"arm.m": masses[rows]}} for rows in (slice(0, 3), slice(3, 6))]
        parts = list(client.evaluate_batches("cell", halves, quantities=names))
    same(whole["kinematics"]["rotation"], np.array(known["kinematics"]["rotation"]))
    for key in ("coordinates", "count", "digest", "frames", "failures"):
        assert whole[key] == known[key]
    assert [[failure["state"] for failure in part["failures"]] for part in parts] == [[1], [1]]
    for name in ("forward_dynamics", "kinetic_energy"):
        same(whole[name], np.concatenate([part[name] for part in parts]))
    assert np.isnan(parts[1]["forward_dynamics"][:, 0]).tolist() == [False, True, False]


def peak_memory(process: int) -> int:
    """The largest resident sets so far, bytes, of the processes that one has started."""
    found = 0
    for child in children(process):
        lines = Path(f"/proc/{child}/status").read_text().splitlines()
        found += 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))
    assert found
    return found


@pytest.mark.deep
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the peak of memory is read from /proc")
def test_ten_million_states_in_a_gibibyte(tmp_path: Path) -> None:
    """M and Q of a 6-dof arm: 0.5 GB of states in, 3.4 GB of results out."""
    q = np.random.default_rng(1).uniform(-3, 3, (50_000, 6))
    tree = {"name": "cell", "gravity": [0, 0, "-9.81"], "instances": [{"name": "arm", "substructure": "ur5"}]}
    with server(tmp_path) as (client, process):
        client.create_tree(tree)
        known = client.evaluate("cell", quantities=["metric"], q=q[:3].tolist())["metric"]
        batches, count = ({"q": q} for _ in range(200)), 0
        for part in client.evaluate_batches("cell", batches, quantities=["metric", "forces"]):
            if count % len(q) == 0:
                np.testing.assert_allclose(part["metric"][:3], known, rtol=1e-12)
            count += part["count"]
        assert count == 10_000_000
        assert peak_memory(process) < 2**30
