"""npz answers that are sent while they are computed, packed and in single precision."""

from __future__ import annotations

import io
import shutil
import socket
import subprocess
import zipfile
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from fastapi.testclient import TestClient

from service.operations import exchange
from service.server import background
from service.settings import Settings
from substructures.client import Client, unpack
from substructures.formats import arrow
from substructures.formats.arrays import MEDIA_TYPE, read_npz, view_npz

from .conftest import HAND, PENDULUM, TREE
from .job_outcomes import known_library, outcomes

URL = "/v1/trees/cell/evaluations"
NAMES = ["forces", "kinematics", "metric", "christoffel"]


@pytest.fixture
def double(filled: TestClient) -> TestClient:
    assert filled.post("/v1/trees/cell/couplings", json=HAND).status_code == 201
    return filled


def sent(q: np.ndarray[Any, Any], **more: Any) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, q=q, quantities=np.array(NAMES), **more)
    return stream.getvalue()


def post(client: TestClient, body: bytes, accept: str = MEDIA_TYPE) -> Any:
    return client.post(URL, content=body, headers={"Content-Type": MEDIA_TYPE, "Accept": accept})


def test_every_reader_reads_it(double: TestClient, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The largest array has its check sum behind it; all is as in an answer in one piece."""
    q = np.random.default_rng(0).uniform(-3, 3, (10_000, 2))
    body = sent(q, **{"parameters.arm.m": np.where(np.arange(10_000) % 4000, 1.0, 1e308)})
    double.post("/v1/trees/cell/kernels", json={"quantities": NAMES})
    monkeypatch.setattr(exchange, "PART", 2**30)
    monkeypatch.setattr(exchange, "WHOLE", 1)
    whole = post(double, body)
    monkeypatch.setattr(exchange, "PART", 2**18)
    monkeypatch.setattr(exchange, "WHOLE", 1)
    cut = post(double, body)
    assert (whole.headers["content-length"], "content-length" in cut.headers) == (str(len(whole.content)), False)
    expected, found = (read_npz(io.BytesIO(x.content), 2**26) for x in (whole, cut))
    assert set(expected) == set(found)
    assert set(found["failures.state"]) == {0, 4000, 8000}
    for arrays in (found, view_npz(np.frombuffer(cut.content, np.uint8)), np.load(io.BytesIO(cut.content))):
        for name, array in expected.items():
            np.testing.assert_array_equal(arrays[name], array, err_msg=name)
    with zipfile.ZipFile(io.BytesIO(cut.content)) as archive:
        assert archive.testzip() is None
        flags = {member.filename: member.flag_bits & 8 for member in archive.infolist()}
    assert {name for name, bit in flags.items() if bit} == {"kinematics.rotation.npy"} == {next(iter(flags))}
    if (unzip := shutil.which("unzip")) is not None:
        (tmp_path / "answer.npz").write_bytes(cut.content)
        assert subprocess.run([unzip, "-tq", tmp_path / "answer.npz"], check=False, capture_output=True).returncode == 0


@pytest.mark.parametrize("size", [2**30, 2**12])
def test_packed_and_single_in_all_formats(double: TestClient, monkeypatch: pytest.MonkeyPatch, size: int) -> None:
    monkeypatch.setattr(exchange, "PART", size)
    monkeypatch.setattr(exchange, "WHOLE", 1)
    q = np.random.default_rng(1).uniform(-3, 3, (50, 2))
    dense, body = read_npz(io.BytesIO(post(double, sent(q)).content), 2**26), sent(q, packed=True, float32=True)
    npz = read_npz(io.BytesIO(post(double, body).content), 2**26)
    table = next(arrow.read_tables(io.BytesIO(post(double, body, arrow.MEDIA_TYPE).content)))
    assert pa.ipc.open_stream(post(double, body, arrow.MEDIA_TYPE).content).schema.field("metric").type.list_size == 3
    plain = post(double, body, "application/json").json()
    count = len(table["metric"])
    for answer in (npz, table, plain):
        for name in ("metric", "christoffel"):
            values = np.asarray(answer[name], dtype=np.float32)
            np.testing.assert_allclose(unpack(name, values, 2), dense[name][: len(values)], rtol=1e-6, atol=1e-6)
        np.testing.assert_allclose(answer["forces"], dense["forces"][: len(answer["forces"])], rtol=1e-6, atol=1e-5)
    assert {npz[name].dtype for name in ("metric", "forces")} == {table[name].dtype for name in ("metric", "forces")}
    assert npz["metric"].dtype == np.float32
    assert (count < 50) == (size == 2**12)


def test_options_are_true_or_false(double: TestClient) -> None:
    for wrong in ("yes", 1, [True]):
        answer = double.post(URL, json={"quantities": ["metric"], "q": [0, 0], "packed": wrong})
        assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/packed")


def test_jobs_pack_too() -> None:
    request = {"quantities": ["metric"], "q": [[0.3], [0.4]], "packed": True, "float32": True}
    (made,) = outcomes(known_library(), "evaluate", {"items": [{"tree": "cell", "request": request}]})
    metric = read_npz(io.BytesIO(made.files["result"]), 2**20)["metric"]
    assert (metric.shape, metric.dtype) == ((2, 1), np.float32)


@pytest.fixture
def parts(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Counts of states of all parts that were computed."""
    counts: list[int] = []
    in_parts = exchange.evaluate_in_parts

    def counted(*arguments: Any, **more: Any) -> Iterator[Any]:
        for part in in_parts(*arguments, **more):
            counts.append(part.count)
            yield part

    monkeypatch.setattr(exchange, "evaluate_in_parts", counted)
    monkeypatch.setattr(exchange, "PART", 2**20)
    monkeypatch.setattr(exchange, "WHOLE", 1)
    return counts


def test_who_does_not_read_or_goes_away(tmp_path: Path, parts: list[int]) -> None:
    """Nothing is computed for them beyond what the connection holds, and no thread stays."""
    body = sent(np.zeros((140_000, 1)))
    head = f"POST {URL} HTTP/1.1\r\nHost: x\r\nContent-Type: {MEDIA_TYPE}\r\nContent-Length: {len(body)}\r\n\r\n"
    settings = Settings(database=f"sqlite:///{tmp_path}/store.db", catalogue=False, allowed_hosts=("x",))
    with background(settings) as address, Client(address) as client:
        client.submit(PENDULUM)
        client.create_tree(TREE)
        client.request("POST", "/v1/trees/cell/kernels", {"quantities": NAMES})
        port = int(address.rpartition(":")[2])
        with socket.create_connection(("127.0.0.1", port)) as slow:
            slow.sendall(head.encode() + body)
            begun = slow.recv(2000)
            assert begun.startswith(b"HTTP/1.1 200"), begun
            held = _settled(parts)
            assert 0 < held < 25  # of 60
            while len(slow.recv(2**20)) and len(parts) <= held:
                pass
            assert len(parts) > held  # it goes on with who reads
        gone = _settled(parts)
        assert gone < 40
        sleep(0.3)
        assert len(parts) == gone
        assert client.request("GET", "/livez").status_code == 200


def _settled(parts: list[int]) -> int:
    """So many there are when nothing has happened for a while."""
    until, seen = monotonic() + 20, -1
    while len(parts) != seen and monotonic() < until:
        seen = len(parts)
        sleep(0.5)
    return len(parts)
