"""Powers of loads over HTTP: numbers, formulas, code, jobs, motions, and what is refused."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.store.store import Store
from substructures.expr.interpret import interpret
from substructures.expr.program import Program
from substructures.formats import arrow

from .conftest import HAND
from .fake_engine import FakeEngine, finished, items, running, submitted

URL = "/v1/trees/cell/evaluations"
LOAD = {"name": "mount", "type": "spring", "from": "world", "to": "hand.tip", "from_at": [0, 3, 0], "stiffness": 4}
ROWS = ["gravity", "joint arm.q", "joint hand.q", "tau.arm.q", "tau.hand.q", "spring mount"]
STATE: dict[str, Any] = {"quantities": ["powers"], "q": [0.4, -0.7], "qd": [1.0, 2.0], "inputs": {"tau.hand.q": 0.3}}


@pytest.fixture
def double(filled: TestClient) -> TestClient:
    assert filled.post("/v1/trees/cell/couplings", json=HAND).status_code == 201
    assert filled.post("/v1/trees/cell/loads", json=LOAD).status_code == 201
    return filled


def ask(client: TestClient, **request: Any) -> dict[str, Any]:
    answer = client.post(URL, json={**STATE, **request})
    assert answer.status_code == 200, answer.text
    result: dict[str, Any] = answer.json()
    return result


def test_numbers_in_every_format(double: TestClient) -> None:
    for ref in ("cell", "cell@3"):  # what is at hand of a pinned tree, too
        for _ in range(3):
            found = double.post(
                f"/v1/trees/{ref}/evaluations", json={**STATE, "quantities": ["powers", "power"]}
            ).json()
            assert found["loads"] == ROWS
            assert found["powers"][4] == pytest.approx(0.6)
            assert sum(found["powers"]) == pytest.approx(sum(found["power"]), rel=1e-12)
    stream = io.BytesIO()
    np.savez(stream, quantities=np.array(["powers"]), q=[STATE["q"]], qd=[STATE["qd"]])
    answer = double.post(URL, content=stream.getvalue(), headers={"Content-Type": "application/x-npz"})
    arrays = np.load(io.BytesIO(answer.content))
    assert arrays["loads"].tolist() == ROWS
    assert arrays["powers"][0, 4] == 0
    table = arrow.ArrowTable({name: np.array([STATE[name]]) for name in ("q", "qd")})
    content = b"".join(bytes(x) for x in arrow.write_tables([table], {"quantities": ["powers"]}))
    answer = double.post(URL, content=content, headers={"Content-Type": arrow.MEDIA_TYPE})
    (columns,) = arrow.read_tables(io.BytesIO(answer.content))
    np.testing.assert_allclose(columns["powers"], arrays["powers"], rtol=1e-14)


def test_formulas_equal_numbers(double: TestClient) -> None:
    values = dict(zip(("arm.q", "hand.q", "arm.q'", "hand.q'", "tau.hand.q"), (0.4, -0.7, 1, 2, 0.3), strict=True))
    answer = double.get("/v1/trees/cell/powers", params={"bind": "defaults"})
    assert answer.json()["loads"] == ROWS
    found = interpret(Program.from_bytes(answer.content), {**values, "tau.arm.q": 0})["powers"]
    np.testing.assert_allclose(found, ask(double)["powers"], rtol=1e-12)


def test_code_has_one_signature(double: TestClient) -> None:
    head = " ".join(double.get("/v1/trees/cell/powers?format=c&name=cell").text.split())
    assert "cell_powers(const double *q, const double *qd, const double *u, const double *p" in head
    answer = double.get("/v1/trees/cell/export?target=interface&quantities=powers&name=cell")
    (function,) = answer.json()["functions"]
    assert function["arguments"] == ["q", "qd", "u", "p"]


def test_jobs_compute_them_too(double: TestClient, store: Store) -> None:
    wanted = {"tree": "cell", "quantity": "powers", "format": "text"}
    with running(store, FakeEngine()):
        made = submitted(double, {"kind": "export", "items": [wanted]})
        finished(double, made)
        later = double.post(URL, json=STATE, headers={"Prefer": "respond-async"})
        finished(double, later.json()["id"])
    (text,) = items(double, made)
    known = double.get("/v1/trees/cell/powers?format=text")
    assert double.get(text["files"][0]["href"]).text == known.text
    (numbers,) = items(double, later.json()["id"])
    arrays = np.load(io.BytesIO(double.get(numbers["files"][0]["href"]).content))
    np.testing.assert_allclose(arrays["powers"].reshape(-1), ask(double)["powers"], rtol=1e-12)


def test_along_motions(double: TestClient, store: Store) -> None:
    url = "/v1/trees/cell/simulations"
    request = {"q": [0.4, -0.7], "span": [0, 1], "count": 4, "inputs": {"tau.hand.q": "0.3*t"}, "powers": True}
    motion = double.post(url, json=request).json()
    assert (motion["loads"], motion["is_right"]) == (ROWS, True)
    assert next(c for c in motion["checks"] if c["name"] == "power")["holds"] is True
    states = {"q": motion["q"], "qd": motion["qd"], "inputs": {"tau.hand.q": (0.3 * np.array(motion["t"])).tolist()}}
    np.testing.assert_allclose(motion["series"]["powers"], ask(double, **states)["powers"], atol=1e-12)
    lines = double.post(url, json=request, headers={"Accept": "text/csv"}).text.splitlines()
    at = lines[0].split(",").index("power.spring mount")
    assert float(lines[2].split(",")[at]) == motion["series"]["powers"][1][5]
    with running(store, FakeEngine()):
        later = double.post(url, json=request, headers={"Prefer": "respond-async"})
        finished(double, later.json()["id"])
    (item,) = items(double, later.json()["id"])
    found = double.get(item["files"][0]["href"]).json()
    np.testing.assert_allclose(found["series"]["powers"], motion["series"]["powers"], atol=1e-9)
    refused = double.post(url, json={**request, "geodesic": True, "inputs": {}})
    assert [(e["pointer"], e["code"]) for e in refused.json()["errors"]] == [("/powers", "not-supported")]
    refused = double.post("/v1/trees/cell/sensitivities", json={**request, "by": ["arm.m"]})
    assert [(e["pointer"], e["code"]) for e in refused.json()["errors"]] == [("/powers", "not-supported")]
