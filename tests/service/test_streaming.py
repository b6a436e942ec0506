"""Evaluations larger than memory: limits, faults in mid-stream, and how much memory the server takes."""

from __future__ import annotations

import io
import socket
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import anyio
import httpx2
import numpy as np
import pyarrow as pa
import pytest
from fastapi.testclient import TestClient

from service import spool
from service.arrow import MEDIA_TYPE
from service.client import Client, ProblemError
from service.operations import batches
from service.server import background
from service.settings import Limits, Settings
from service.store import Store

from .conftest import PENDULUM, TREE, make_client
from .test_arrow import column, lists, post, stream

URL = "/v1/trees/cell/evaluations"
HEADERS = {"Content-Type": MEDIA_TYPE, "Accept": MEDIA_TYPE}
METRIC = {"quantities": ["metric"]}


def limited(store: Store, monkeypatch: pytest.MonkeyPatch, **limits: Any) -> TestClient:
    monkeypatch.setattr(store, "settings", store.settings.model_copy(update={"limits": Limits(**limits)}))
    return make_client(store)


@pytest.mark.usefixtures("filled")
def test_limits_of_streams(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    body = stream([{"q": lists(np.zeros((100, 1)))}] * 3, METRIC)
    refused = post(limited(store, monkeypatch, stream_bytes=len(body) - 1), body)
    assert (refused.status_code, refused.json()["code"]) == (413, "body-too-large")
    assert post(limited(store, monkeypatch, stream_bytes=len(body)), body).status_code == 200
    for limits in ({"binary_bytes": 700}, {"stream_states": 99}, {"states": 99}):
        assert post(limited(store, monkeypatch, **limits), body).status_code == 422
    assert post(limited(store, monkeypatch, binary_bytes=2000, states=100, stream_states=300), body).status_code == 200
    whole = post(limited(store, monkeypatch, binary_bytes=2000), body, "application/json")
    assert (whole.status_code, whole.json()["code"]) == (422, "too-large")  # only Arrow leaves part by part
    shown = limited(store, monkeypatch, stream_states=7).get("/v1/limits").json()
    assert (shown["stream_states"], shown["stream_bytes"]) == (7, 2**32)


def same(one: np.ndarray[Any, Any], other: np.ndarray[Any, Any]) -> None:
    if one.dtype.kind == "f":
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-14)
    else:
        np.testing.assert_array_equal(one, other)


def test_parts_make_the_same_answer(filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever a request is cut into, results, failures and advice are the same."""
    q, masses = np.linspace(-1, 1, 50), np.ones(50)
    masses[[7, 41]] = 0.0
    arrays = {"q": q[:, None], "qd": 0.5 * q[:1], "t": q, "inputs.tau.arm.q": q, "parameters.arm.m": masses}
    packed = io.BytesIO()
    np.savez(packed, quantities=np.array(["forward_dynamics", "metric", "kinematics"]), **arrays)
    answers = []
    for size in (10**9, 2000):
        monkeypatch.setattr(batches, "PART", size)
        answer = post(filled, packed.getvalue(), sent="application/x-npz", accept="application/x-npz")
        tables = post(filled, packed.getvalue(), sent="application/x-npz")
        table = pa.ipc.open_stream(tables.content).read_all()
        assert (len(table["metric"].chunks) > 1) == (size < 10**9)
        answers.append((np.load(io.BytesIO(answer.content), allow_pickle=False), table))
    (whole, whole_table), (cut, cut_table) = answers
    assert whole["failures.state"].tolist() == [7, 41]
    assert set(whole) == set(cut)
    for name in whole:  # the last bits may differ: the first parts are interpreted, later ones compiled
        same(whole[name], cut[name])
    assert whole_table.schema.equals(cut_table.schema, check_metadata=True)
    assert whole_table["failures"].to_pylist() == cut_table["failures"].to_pylist()
    same(column(cut_table, "metric"), whole["metric"])
    assert np.flatnonzero(~cut_table["forward_dynamics"].is_valid().to_numpy()).tolist() == [7, 41]


def test_wrong_lengths_are_found_before_anything_is_cut(filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batches, "PART", 80)
    q = np.zeros((40, 1)).tolist()
    for wrong in ({"qd": q[:10]}, {"t": [0.0] * 10}, {"parameters": {"arm.m": [1.0] * 10}}, {"q": [*q, [np.inf]]}):
        body = io.BytesIO()
        flat = {f"{name}.arm.m": value["arm.m"] if isinstance(value, dict) else value for name, value in wrong.items()}
        names = {name if name.startswith("parameters") else name.partition(".")[0]: v for name, v in flat.items()}
        np.savez(body, **{"q": q, "quantities": np.array(["metric"]), **names})
        for accept in ("application/x-npz", MEDIA_TYPE):
            answer = post(filled, body.getvalue(), sent="application/x-npz", accept=accept)
            assert answer.status_code == 422, answer.content


def test_one_position_and_many_velocities(filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """The number of states is that of the longest list in every format, also where the last part has one state."""
    monkeypatch.setattr(batches, "PART", 10 * 8 * 2)
    qd, quantities = np.linspace(-1, 1, 41), ["metric", "kinetic_energy"]
    expected = filled.post(URL, json={"quantities": quantities, "q": [[0.3]] * 41, "qd": qd[:, None].tolist()}).json()
    found = filled.post(URL, json={"quantities": quantities, "q": [0.3], "qd": qd[:, None].tolist()}).json()
    assert found["count"] == len(found["metric"]) == 41
    body = io.BytesIO()
    np.savez(body, q=np.array([0.3]), qd=qd[:, None], quantities=np.array(quantities))
    packed = post(filled, body.getvalue(), sent="application/x-npz", accept="application/x-npz")
    assert packed.headers["content-length"] == str(len(packed.content))
    arrays = np.load(io.BytesIO(packed.content), allow_pickle=False)
    table = pa.ipc.open_stream(post(filled, body.getvalue(), sent="application/x-npz").content).read_all()
    for name in quantities:
        for values in (found[name], arrays[name], column(table, name)):
            np.testing.assert_allclose(values, expected[name], rtol=1e-12)


def test_limits_count_the_longest_list(store: Store, filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    assert filled.post(URL, json={"quantities": ["metric"], "q": [0], "t": [0] * 9}).status_code == 200
    short = limited(store, monkeypatch, states=8)
    refused = short.post(URL, json={"quantities": ["metric"], "q": [0], "t": [0] * 9})
    assert (refused.status_code, refused.json()["errors"][0]["code"]) == (422, "too-many-states")


def test_streams_are_computed_again_under_their_key(filled: TestClient) -> None:
    q = lists(np.linspace(0, 1, 40_000)[:, None])
    body, other = stream([{"q": q}] * 3, METRIC), stream([{"q": q}] * 2, METRIC)
    keyed = {**HEADERS, "Idempotency-Key": "once"}
    first = filled.post(URL, content=body, headers=keyed)
    again = filled.post(URL, content=body, headers=keyed)
    assert (first.status_code, again.status_code) == (200, 200)
    assert first.content == again.content
    assert "content-length" not in first.headers
    assert filled.post(URL, content=other, headers=keyed).status_code == 422


def test_spooled_bodies(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spool, "MEMORY", 1000)
    monkeypatch.setattr(spool, "PIECE", 100)
    chunks = [bytes([i]) * 30 for i in range(100)]

    async def arriving() -> AsyncIterator[bytes]:
        for chunk in chunks:
            yield chunk

    with closing(spool.Spool()) as body:
        anyio.run(body.fill, arriving())
        assert b"".join(body.pieces()) == b"".join(chunks) == b"".join(body.pieces())
    assert body.closed


@contextmanager
def server(folder: Path, *arguments: str) -> Iterator[tuple[Client, int]]:
    """The service in a process of its own; a client and the process id."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "service.cli", "serve", "--port", str(port), *arguments]
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
    """The largest resident set so far, bytes."""
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


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
