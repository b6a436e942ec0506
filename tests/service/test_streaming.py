"""Evaluations part by part: limits, and that nothing depends on how a request is cut."""

from __future__ import annotations

import io
from collections.abc import AsyncIterator
from contextlib import closing
from typing import Any

import anyio
import numpy as np
import pyarrow as pa
import pytest
from fastapi.testclient import TestClient

from service.messages import spool
from service.operations import exchange
from service.settings import Limits
from service.store.store import Store
from substructures.formats.arrow import MEDIA_TYPE

from .conftest import make_client
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
    for limits, code in (
        ({"binary_bytes": 700}, "too-large"),
        ({"stream_states": 99}, "too-large"),
        ({"states": 99}, "too-many-states"),
    ):
        refused = post(limited(store, monkeypatch, **limits), body)
        assert (refused.status_code, refused.json()["errors"][0]["code"]) == (422, code)
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
        monkeypatch.setattr(exchange, "PART", size)
        monkeypatch.setattr(exchange, "WHOLE", 1)
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
    monkeypatch.setattr(exchange, "PART", 80)
    monkeypatch.setattr(exchange, "WHOLE", 1)
    q = np.zeros((40, 1)).tolist()
    for wrong, pointer in (
        ({"qd": q[:10]}, "/qd"),
        ({"t": [0.0] * 10}, "/t"),
        ({"parameters": {"arm.m": [1.0] * 10}}, "/parameters/arm.m"),
        ({"q": [*q, [np.inf]]}, "/q/40/0"),
    ):
        body = io.BytesIO()
        flat = {f"{name}.arm.m": value["arm.m"] if isinstance(value, dict) else value for name, value in wrong.items()}
        names = {name if name.startswith("parameters") else name.partition(".")[0]: v for name, v in flat.items()}
        np.savez(body, **{"q": q, "quantities": np.array(["metric"]), **names})
        for accept in ("application/x-npz", MEDIA_TYPE):
            answer = post(filled, body.getvalue(), sent="application/x-npz", accept=accept)
            assert answer.status_code == 422, answer.content
            assert [error["pointer"] for error in answer.json()["errors"]] == [pointer]


def test_one_position_and_many_velocities(filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """The number of states is that of the longest list in every format, also where the last part has one state."""
    monkeypatch.setattr(exchange, "PART", 10 * 8 * 2)
    monkeypatch.setattr(exchange, "WHOLE", 1)
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
