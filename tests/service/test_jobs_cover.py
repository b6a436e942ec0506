"""Jobs compute whatever requests compute: every analysis, and every quantity as formulas."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.models.formulas import QUANTITIES, WITH_DOCUMENT
from service.models.numbers import ANALYSES
from service.settings import Settings
from service.store.store import Store
from substructures.quantities.quantity import ANALYSIS, PART, TABLE

from .analysis_trees import client_with_trees
from .fake_engine import FakeEngine, finished, items, running, submitted

MOTION = {name: np.sin(np.arange(1, 21) * k).reshape(20, 1).tolist() for k, name in enumerate(("q", "qd", "qdd"), 1)}
EDGE = {"type": "knife_edge", "name": "edge", "frame": "s.sled"}
CONTROL = {"controls": ["tau.s.x"], "cost": {"running": "tau.s.x^2"}, "horizon": 1, "intervals": 2, "q": [0, 0, 0]}
SWING = {"q": [0.3], "span": [0, 1], "count": 3}
#: tree and request, by analysis
REQUESTS: dict[str, tuple[str, dict[str, Any]]] = {
    "abbreviations": ("cart", {"quantity": "metric", "simplify": 0.1, "format": "c"}),
    "simulations": ("clock", SWING),
    "ensembles": ("cart", {**SWING, "q": [[0, 0.3], [0.1, 0.2]], "parameters": {"x.l0": [0.5, 0.7]}}),
    "sensitivities": ("cart", {**SWING, "q": [0, 0.3], "by": ["x.l0"], "of_start": True}),
    "periodic-orbits": ("cart", {"q": [0, 2.5], "period": 1.3, "hold": ["x.q0", "x.q1", "x.q0'", "x.q1'"]}),
    "lyapunov-exponents": ("cart", {"q": [0, 0.3], "duration": 5, "intervals": 20}),
    "poincare-sections": ("cart", {"q": [0, 0.3], "quantity": "x.q1", "duration": 5}),
    "linearisations": ("clock", {"q": [0.3]}),
    "frequency-responses": ("cart", {"q": [0, 3], "frequencies": [1, 2], "outputs": {"y": "x.q1"}}),
    "regulators": ("cart", {"q": [0, 0], "weights": {"x.q1": 2, "x.q0": 1}, "of_inputs": ["tau.x.q0"]}),
    "equilibria": ("clock", {"count": 4}),
    "steady-motions": ("cart", {"rates": {"x.q0": 1}, "count": 4}),
    "root-loci": ("cart", {"parameter": "x.l0", "values": [1, 2], "q": [0, 0]}),
    "curvatures": ("cart", {"q": [0, 0.3]}),
    "cost-gradients": ("skate", {**CONTROL, "values": {"tau.s.x": 1}}),
    "optimal-controls": ("skate", {**CONTROL, "end": {"q": {"s.x": 1}}}),
    "optimal-parameters": ("cart", {"vary": {"x.l0": [0.3, 1]}, "columns": {"m": "mass"}, "minimise": "m + x.l0"}),
    "loop-states": ("ring", {"q": [1.8, -2.0, -1.5]}),
    "reduced-equations": ("ring", {"independent": ["a.q"], "start": {"a.q": 1.8, "b.q": -2.0, "c.q": -1.5}}),
    "excitations": ("clock", MOTION),
    "identifications": ("clock", {**MOTION, "tau": MOTION["q"], "drives": ["viscous"]}),
}
TREE = "cart"  # of formulas


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    folder: Path = tmp_path_factory.mktemp("cover")
    with open_store(Settings(database=f"sqlite:///{folder / 'store.db'}", catalogue=False)) as store:
        yield store


@pytest.fixture(scope="module")
def client(store: Store) -> TestClient:
    return client_with_trees(store)


def file(client: TestClient, item: dict[str, Any]) -> Any:
    assert item["state"] == "succeeded", item["problem"]
    return client.get(item["files"][0]["href"])


def close(one: Any, other: Any) -> None:
    """Equal up to rounding, as a request may be computed by a compiled kernel, and up to how long it took."""
    if isinstance(other, dict):
        assert one.keys() == other.keys()
        for name, value in other.items():
            if name == "seconds":
                continue
            close(one[name], value)
    elif isinstance(other, list):
        assert len(one) == len(other)
        for a, b in zip(one, other, strict=True):
            close(a, b)
    else:
        assert one == (pytest.approx(other, rel=1e-6, abs=1e-7) if isinstance(other, float) else other)


def test_every_analysis(client: TestClient, store: Store) -> None:
    assert REQUESTS.keys() == ANALYSES.keys()
    known = {n: client.post(f"/v1/trees/{tree}/{n}", json=request) for n, (tree, request) in REQUESTS.items()}
    waiting = {
        name: client.post(f"/v1/trees/{tree}/{name}", json=request, headers={"Prefer": "respond-async"})
        for name, (tree, request) in REQUESTS.items()
    }
    with running(store, FakeEngine()):
        for name, answer in waiting.items():
            assert (answer.status_code, known[name].status_code) == (202, 200), (name, answer.text, known[name].text)
            (item,) = (finished(client, answer.json()["id"]), items(client, answer.json()["id"]))[1]
            close(file(client, item).json(), known[name].json())


def test_every_quantity(client: TestClient, store: Store) -> None:
    rows = [row for row in TABLE.values() if row.is_formula and row.source not in (ANALYSIS, PART) and row.arrays]
    names = [*(row.name for row in rows if not row.only), *QUANTITIES]
    asked = [{"tree": TREE, "quantity": name, "format": "text", "bind": "defaults"} for name in names]
    with running(store, FakeEngine()):
        job = submitted(client, {"kind": "export", "items": asked})
        finished(client, job, 60)
    for name, item in zip(names, items(client, job), strict=True):
        known = client.get(f"/v1/trees/{TREE}/{name}", params={"format": "text", "bind": "defaults"})
        assert known.status_code == (200 if item["state"] == "succeeded" else item["problem"]["status"]), name
        if known.status_code == 200:
            assert file(client, item).text == known.text, name


@pytest.mark.parametrize("query", ["format=latex", "format=latex&document=true", "format=c&name=skating"])
def test_formulas_with_a_document(client: TestClient, store: Store, query: str) -> None:
    assert list(WITH_DOCUMENT) == ["velocity-equations"]
    url, body = f"/v1/trees/skate/velocity-equations?{query}", {"constraints": [EDGE]}
    answer = client.post(url, json=body, headers={"Prefer": "respond-async"})
    assert answer.status_code == 202, answer.text
    with running(store, FakeEngine()):
        finished(client, answer.json()["id"])
    (item,) = items(client, answer.json()["id"])
    assert file(client, item).content == client.post(url, json=body).content
    wrong = client.post(url, json={"constraints": 1}, headers={"Prefer": "respond-async"})
    assert (wrong.status_code, wrong.json()["errors"][0]["pointer"]) == (422, "/constraints")
