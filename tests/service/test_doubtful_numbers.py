"""What is said of accelerations that are nearly undetermined: the same in JSON, npz, Arrow, and parts of answers."""

from __future__ import annotations

import io
import json
import math
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from fastapi.testclient import TestClient

from service.operations import exchange
from substructures.client.results import joined_parts
from substructures.formats.arrays import as_answer, as_npz, read_npz

from .test_arrow import lists, post, stream

#: yaw, pitch, roll: far from, beside and at pitch = pi/2
STATES = [[0.3, 0.2, 0.1], [0.3, math.pi / 2 - 1e-6, 0.4], [0.3, math.pi / 2, 0.4], [0.3, 0.3, 0.1]]
WANTED = ["forward_dynamics", "condition"]


@pytest.fixture
def ball(client: TestClient) -> TestClient:
    """A body on a spherical joint."""
    joint = {"type": "spherical", "coordinate": ["a", "b", "c"]}
    body = {"name": "b", "parent": "base", "joint": joint, "mass": 2, "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.25}}
    assert client.post("/v1/substructures", json={"name": "ball", "bodies": [body]}).status_code == 201
    tree = {"name": "cell", "gravity": [0, 0, -9.81], "instances": [{"name": "x", "substructure": "ball"}]}
    assert client.post("/v1/trees", json=tree).status_code == 201
    return client


def evaluated(client: TestClient, q: Any) -> dict[str, Any]:
    answer = client.post("/v1/trees/cell/evaluations", json={"quantities": WANTED, "q": q})
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def test_warnings_in_json(ball: TestClient) -> None:
    found = evaluated(ball, STATES)
    (warning,) = found["warnings"]
    assert (warning["pointer"], warning["code"], warning["state"]) == ("/q/1", "ill-conditioned", 1)
    assert warning["quantity"] == "forward_dynamics"
    # 4 / (1e-6)^2 for the axes of yaw and roll, but for the shares of their inertias
    assert 1e11 < found["condition"][1] < 1e14
    assert found["forward_dynamics"][2] is None
    assert [failure["state"] for failure in found["failures"] if failure["quantity"] == "forward_dynamics"] == [2]
    one = evaluated(ball, STATES[1])
    assert [each["pointer"] for each in one["warnings"]] == ["/q"]
    assert evaluated(ball, STATES[0])["warnings"] == []


def test_warnings_in_npz(ball: TestClient) -> None:
    packed = io.BytesIO()
    np.savez(packed, quantities=np.array(WANTED[:1]), q=np.array(STATES))
    answer = post(ball, packed.getvalue(), sent="application/x-npz", accept="application/x-npz")
    arrays = read_npz(io.BytesIO(answer.content), 10**6)
    assert arrays["warnings.state"].tolist() == [1]
    assert arrays["warnings.pointer"].tolist() == ["/q/1"]
    assert as_answer(arrays)["warnings"] == evaluated(ball, STATES)["warnings"]
    about_all = {"pointer": "/parameters/x.m", "code": "negative", "message": "no"}
    answer = {"failures": [], "warnings": [about_all]}
    assert as_answer(read_npz(io.BytesIO(b"".join(as_npz(answer).pieces)), 10**6)) == answer


def test_warnings_in_arrow_whatever_the_parts(ball: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    body = stream([{"q": lists(np.array(STATES))}], {"quantities": WANTED[:1]})
    tables = []
    for size in (10**9, 1):
        monkeypatch.setattr(exchange, "PART", size)
        monkeypatch.setattr(exchange, "WHOLE", 1)
        tables.append(pa.ipc.open_stream(post(ball, body).content).read_all())
    whole, cut = (table["warnings"].to_pylist() for table in tables)
    assert [text is None for text in whole] == [True, False, True, True]
    assert whole == cut
    (told,) = json.loads(whole[1])
    assert (told["quantity"], told["code"]) == ("forward_dynamics", "ill-conditioned")
    assert "warnings" not in (tables[0].schema.metadata or {})


def test_joined_parts_have_the_places_of_the_whole() -> None:
    def part(start: int, **told: Any) -> dict[str, Any]:
        return {"range": [start, start + 2], "count": 2, "metric": np.zeros((2, 1, 1)), "failures": [], **told}

    about_all = {"pointer": "/parameters/m", "code": "negative", "message": "no"}
    note = {"pointer": "/q/1", "state": 1, "quantity": "forward_dynamics", "code": "ill-conditioned", "message": "m"}
    whole = joined_parts([part(0, warnings=[about_all]), part(2, warnings=[about_all, note]), part(4)])
    assert whole["warnings"] == [about_all, {**note, "state": 3, "pointer": "/q/3"}]
    assert whole["count"] == 6
