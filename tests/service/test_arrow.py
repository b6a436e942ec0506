"""Evaluations as Arrow streams, in and out; pyarrow is the independent writer and reader."""

from __future__ import annotations

import io
import json
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from fastapi.testclient import TestClient

from substructures.formats import arrow

from .one_store import double

__all__ = ["double"]  # a fixture

ARROW, NPZ, JSON = arrow.MEDIA_TYPE, "application/x-npz", "application/json"
URL = "/v1/trees/cell/evaluations"
Q = np.linspace(-1, 1, 20).reshape(10, 2)
TAU = np.arange(10.0)


def lists(values: np.ndarray[Any, Any]) -> pa.Array:
    return pa.FixedSizeListArray.from_arrays(pa.array(values.reshape(-1)), values.shape[1])


def stream(batches: Iterable[Mapping[str, Any]], metadata: Mapping[str, Any], compression: str | None = None) -> bytes:
    texts = {key: json.dumps(value) for key, value in metadata.items()}
    tables = [pa.record_batch(dict(batch)).replace_schema_metadata(texts) for batch in batches]
    sink = io.BytesIO()
    options = pa.ipc.IpcWriteOptions(compression=compression)
    with pa.ipc.new_stream(sink, tables[0].schema, options=options) as writer:
        for table in tables:
            writer.write_batch(table)
    return sink.getvalue()


def post(client: TestClient, body: bytes, accept: str = ARROW, sent: str = ARROW) -> Any:
    return client.post(URL, content=body, headers={"Content-Type": sent, "Accept": accept})


def column(table: pa.Table, name: str) -> np.ndarray[Any, Any]:
    """A column as an array, as the documentation says: rows of the shape in the metadata of the field."""
    shape = json.loads(table.schema.field(name).metadata[b"shape"])
    values = table[name].combine_chunks()
    return np.asarray(values.flatten() if shape else values).reshape(len(table), *shape)


REQUEST = {"quantities": ["metric", "forces", "kinetic_energy", "kinematics"]}
BATCHES = [
    {"q": lists(Q[rows]), "qd": lists(2 * Q[rows]), "inputs.tau.arm.q": TAU[rows], "parameters.arm.m": TAU[rows] + 1}
    for rows in (slice(0, 3), slice(3, 4), slice(4, 10))
]


def expected(client: TestClient) -> Any:
    return client.post(
        URL,
        json={
            **REQUEST, "q": Q.tolist(), "qd": (2 * Q).tolist(), "inputs": {"tau.arm.q": TAU.tolist()},
            "parameters": {"arm.m": (TAU + 1).tolist(), "hand.l": 0.5},
        },
    ).json()  # fmt: skip


def assert_same(found: Any, known: Any) -> None:
    """Equal up to rounding: the first answers may be interpreted, later ones compiled."""
    if isinstance(known, dict):
        assert found.keys() == known.keys()
        for name, value in known.items():
            assert_same(found[name], value)
    elif np.asarray(known).dtype.kind == "f":
        np.testing.assert_allclose(found, known, rtol=1e-12, atol=1e-13)
    else:
        np.testing.assert_array_equal(found, known)


def test_arrow_equals_json(double: TestClient) -> None:
    body = stream(BATCHES, {**REQUEST, "parameters": {"hand.l": 0.5}})
    answer = post(double, body)
    assert (answer.status_code, answer.headers["content-type"]) == (200, ARROW), answer.text
    assert answer.content.endswith(arrow.END)
    table, known = pa.ipc.open_stream(answer.content).read_all(), expected(double)
    assert [len(chunk) for chunk in table["metric"].chunks] == [3, 1, 6]
    for name in ("metric", "forces", "kinetic_energy"):
        assert_same(column(table, name), known[name])
    assert_same(column(table, "kinematics.rotation"), known["kinematics"]["rotation"])
    metadata = table.schema.metadata
    assert json.loads(metadata[b"coordinates"]) == known["coordinates"]
    assert json.loads(metadata[b"quantities"]) == REQUEST["quantities"]
    assert json.loads(metadata[b"frames"]) == known["frames"]
    assert metadata[b"digest"].decode() == known["digest"]
    assert table["failures"].null_count == 10


def test_any_format_in_any_format_out(double: TestClient) -> None:
    body = stream(BATCHES, {**REQUEST, "parameters": {"hand.l": 0.5}})
    known = expected(double)
    assert_same(post(double, body, JSON).json(), known)
    arrays = np.load(io.BytesIO(post(double, body, NPZ).content), allow_pickle=False)
    assert_same(arrays["metric"], known["metric"])
    assert_same(arrays["kinematics.U"], known["kinematics"]["U"])
    assert int(arrays["count"]) == 10
    packed = io.BytesIO()
    np.savez(packed, q=Q, quantities=np.array(["metric"]))
    plain = pa.ipc.open_stream(post(double, packed.getvalue(), ARROW, NPZ).content).read_all()
    one = json.dumps({"quantities": ["metric"], "q": Q[4].tolist(), "qd": [0, 0]}).encode()
    single = pa.ipc.open_stream(post(double, one, ARROW, JSON).content).read_all()
    assert_same(column(plain, "metric")[4], column(single, "metric")[0])


@pytest.mark.parametrize("accept", ["*/*", "application/*", f"{NPZ};q=0.2, {ARROW}", f"text/html, {ARROW}"])
def test_negotiation(double: TestClient, accept: str) -> None:
    assert post(double, stream(BATCHES, REQUEST), accept).headers["content-type"] == ARROW


def test_the_format_may_be_refused(double: TestClient) -> None:
    body = stream(BATCHES, REQUEST)
    assert post(double, body, "text/html").json()["code"] == "not-acceptable"
    refused = post(double, body, sent="text/csv")
    assert (refused.status_code, refused.json()["code"]) == (415, "unsupported-media-type")


@pytest.mark.parametrize(
    "columns",
    [
        {"q": pa.array(Q.tolist(), pa.list_(pa.float64()))},
        {"q": pa.array(Q.tolist(), pa.large_list(pa.float64()))},
        {"q.arm.q": Q[:, 0], "q.hand.q": Q[:, 1]},
        {"q": lists(Q), "t": np.zeros(10, np.int32), "parameters.arm.l": np.ones(10, np.float32)},
    ],
)
def test_other_columns(double: TestClient, columns: dict[str, Any]) -> None:
    known = post(double, stream([{"q": lists(Q)}], {"quantities": ["metric"]}), JSON).json()
    assert_same(post(double, stream([columns], {"quantities": ["metric"]}), JSON).json(), known)


def test_batches_without_rows_are_passed_over(double: TestClient) -> None:
    body = stream([{"q": lists(rows)} for rows in (Q[:0], Q[:3], Q[:0], Q[3:])], REQUEST)
    assert len(pa.ipc.open_stream(post(double, body).content).read_all()) == 10


def test_columns_of_no_width() -> None:
    """Such as the redundant rows of a closed loop that has none; the number of rows is kept."""
    shape = (5, 0, 3)
    file = io.BytesIO(b"".join(map(bytes, arrow.write_tables([arrow.ArrowTable({"none": np.zeros(shape)})], {}))))
    assert pa.ipc.open_stream(file).read_all().num_rows == 5
    file.seek(0)
    (read,) = arrow.read_tables(file)
    assert (read["count"], read["none"].shape) == (5, shape)


def test_states_without_a_result_are_null(double: TestClient) -> None:
    masses = np.where(np.arange(10) == 4, 0.0, 1.0)
    body = stream([{"q": lists(Q), "parameters.arm.m": masses}], {"quantities": ["forward_dynamics", "metric"]})
    table = pa.ipc.open_stream(post(double, body).content).read_all()
    assert table["metric"].null_count == 0
    assert [i for i, row in enumerate(table["forward_dynamics"].to_pylist()) if row is None] == [4]
    told = [json.loads(text) if text else None for text in table["failures"].to_pylist()]
    assert [entry["quantity"] for entry in told[4]] == ["forward_dynamics"]
    assert told[:4] + told[5:] == [None] * 9


def broken() -> dict[str, bytes]:
    metric = {"quantities": ["metric"]}
    good = stream([{"q": lists(Q)}], metric)
    holes = pa.array([[0.0, 1.0], None], pa.list_(pa.float64(), 2))
    inside = pa.array([[0.0, None]], pa.list_(pa.float64(), 2))
    twice = pa.record_batch([lists(Q), lists(Q)], names=["q", "q"]).replace_schema_metadata(
        {"quantities": '["metric"]'}
    )
    return {
        "empty": b"",
        "text": b"q=1",
        "cut": good[:-200],
        "two columns of a name": twice.schema.serialize().to_pybytes() + twice.serialize().to_pybytes(),
        "lz4": stream([{"q": lists(Q)}], metric, "lz4"),
        "zstd": stream([{"q": lists(Q)}], metric, "zstd"),
        "null": stream([{"q": holes}], metric),
        "null inside": stream([{"q": inside}], metric),
        "texts": stream([{"q": pa.array(["a"])}], metric),
        "dictionary": stream([{"q": pa.array(["a"]).dictionary_encode()}], metric),
        "ragged": stream([{"q": pa.array([[1.0], [1.0, 2.0]])}], metric),
        "width": stream([{"q": lists(Q.reshape(5, 4))}], metric),
        "nan": stream([{"q": lists(Q * np.nan)}], metric),
        "no quantities": stream([{"q": lists(Q)}], {}),
        "no json": stream([{"q": lists(Q)}], metric).replace(b'["metric"]', b'["metric",'),
        "unknown column": stream([{"q": lists(Q), "speed": TAU}], metric),
        "unknown parameter": stream([{"q": lists(Q), "parameters.no": TAU}], metric),
        "given twice": stream([{"q": lists(Q), "q.arm.q": TAU}], metric),
        "given twice as a constant": stream([{"q": lists(Q), "t": TAU}], {**metric, "t": 0}),
        "no rows": stream([{"q": lists(Q[:0])}], metric),
        "no batches": pa.schema({"q": pa.list_(pa.float64(), 2)}, {"quantities": "[]"}).serialize().to_pybytes()
        + arrow.END,
        "no states": stream([{"t": TAU}], metric),
    }


@pytest.mark.parametrize("kind", broken())
@pytest.mark.parametrize("accept", [ARROW, JSON])
def test_broken_streams(double: TestClient, kind: str, accept: str) -> None:
    answer = post(double, broken()[kind], accept)
    assert answer.status_code == 422, answer.content
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["errors"]


def test_damaged_streams_are_refused_or_read(double: TestClient) -> None:
    """Any byte may be wrong: the answer is a problem document, never a crash."""
    good = stream([{"q": lists(Q)}], {"quantities": ["metric"]})
    rng, statuses = np.random.default_rng(3), set()
    for _ in range(300):
        damaged = bytearray(good)
        for place, value in rng.integers((0, 0), (len(good), 256), (rng.integers(1, 4), 2)):
            damaged[place] = value
        statuses.add(post(double, bytes(damaged)).status_code)
    assert statuses == {200, 422}


def test_what_is_declared_is_not_believed(double: TestClient) -> None:
    body = stream([{"q": lists(Q)}], {"quantities": ["metric"]})
    size = (160).to_bytes(8, "little")  # of the record batch's body
    assert body.count(size) >= 1
    answer = post(double, body.replace(size, (2**40).to_bytes(8, "little")))
    assert answer.status_code == 422, answer.content


def test_without_pyarrow(double: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    body = stream(BATCHES, REQUEST)
    monkeypatch.setattr(arrow, "pa", None)
    refused = post(double, body, JSON)
    assert (refused.status_code, refused.json()["code"]) == (415, "arrow-not-installed")
    assert "substructures[arrow]" in refused.json()["detail"]
    asked = post(double, b'{"quantities": ["metric"], "q": [0, 0]}', ARROW, JSON)
    assert (asked.status_code, asked.json()["code"]) == (406, "arrow-not-installed")
