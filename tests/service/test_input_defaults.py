"""Defaults of inputs over HTTP: shown, taken in evaluations, analyses, formulas and jobs, told by exports."""

from __future__ import annotations

import io
import zipfile
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.store.store import Store

from .conftest import SLIDER
from .fake_engine import FakeEngine, finished, items, running

Plain = dict[str, Any]
SLED: Plain = {
    **SLIDER,
    "name": "sled",
    "parameters": {"m": {"value": 2, "unit": "kg"}, "k": {"value": 8, "unit": "N/m"}},
    "inputs": {"push": {"unit": "N", "default": {"value": 0.002, "unit": "kN"}}, "drag": {"unit": "N"}},
    "loads": [{"type": "joint", "coordinate": "x", "force": "push - drag"}],
}
TREE: Plain = {
    "name": "hill",
    "gravity": [0, 0, 0],
    "inputs": {"u": {"unit": "kN", "default": 0.003}},
    "instances": [{"name": "s", "substructure": "sled"}],
    "loads": [{"name": "pull", "type": "joint", "coordinate": "s.x", "force": "u"}],
}


@pytest.fixture
def hill(filled: TestClient) -> TestClient:
    assert filled.post("/v1/substructures", json=SLED).status_code == 201
    made = filled.post("/v1/trees", json=TREE)
    assert made.status_code == 201, made.text
    return filled


def test_they_are_shown_in_si(hill: TestClient) -> None:
    shown = hill.get("/v1/trees/hill").json()["inputs"]
    assert float(shown["u"]["default"]) == 3
    assert shown["u"]["unit"] == "N"
    assert shown["u"]["given"] == {"value": 0.003, "unit": "kN"}
    assert float(shown["s.push"]["default"]) == 2
    assert shown["s.drag"].get("default") is None


def test_numbers_have_them(hill: TestClient) -> None:
    request: Plain = {"quantities": ["forces"], "q": [0.25]}
    for ref in ("hill", "hill@1"):
        for _ in range(3):  # at hand from the second time on
            assert hill.post(f"/v1/trees/{ref}/evaluations", json=request).json()["forces"] == pytest.approx([3.0])
    given = hill.post("/v1/trees/hill/evaluations", json={**request, "inputs": {"u": [0, 1], "s.drag": 4}}).json()
    np.testing.assert_allclose(given["forces"], [[-4], [-3]])
    found = hill.post("/v1/trees/hill/equilibria", json={}).json()
    assert [each["q"] for each in found["found"]] == [[pytest.approx(5 / 8)]]
    motion = hill.post("/v1/trees/hill/simulations", json={"q": [0], "span": [0, 1], "count": 11}).json()
    assert motion["is_right"] is True
    np.testing.assert_allclose(np.ravel(motion["q"]), 5 / 8 * (1 - np.cos(2 * np.array(motion["t"]))), atol=1e-8)


def test_jobs_have_them(hill: TestClient, store: Store) -> None:
    with running(store, FakeEngine()):
        later = hill.post(
            "/v1/trees/hill/evaluations",
            json={"quantities": ["forces"], "q": [0.25]},
            headers={"Prefer": "respond-async"},
        )
        finished(hill, later.json()["id"])
    (item,) = items(hill, later.json()["id"])
    arrays = np.load(io.BytesIO(hill.get(item["files"][0]["href"]).content))
    np.testing.assert_allclose(np.ravel(arrays["forces"]), [3])


def test_bound_defaults_are_those_of_inputs_where_formulas_are_read(hill: TestClient) -> None:
    def text(**params: str) -> str:
        return hill.get("/v1/trees/hill/forces", params={"format": "text", **params}).text

    assert "push" in text()
    bound = text(bind="defaults")
    assert "push" not in bound
    assert bound.splitlines()[-1] == "forces[1] = 5 - drag + tau_x - 8*x"
    code = hill.get("/v1/trees/hill/forces", params={"format": "c", "bind": "defaults", "name": "hill"}).text
    assert "s.push [N], default 2.0" in code
    of_part = hill.get("/v1/substructures/sled/formulas/applied", params={"format": "text", "bind": "defaults"}).text
    assert "push" not in of_part
    assert "drag" in of_part
    integrals = hill.get("/v1/trees/hill/first_integrals").json()
    assert any("push" in symbol["name"] for symbol in integrals["symbols"])


def test_exports_tell_them(hill: TestClient) -> None:
    told = hill.get("/v1/trees/hill/export?target=interface&quantities=forces&name=hill").json()["vectors"]["u"]
    assert told["names"] == ["s.drag", "s.push", "u", "tau.s.x"]
    assert told["defaults"] == [0, 2, 3, 0]
    answer = hill.get("/v1/trees/hill/export?target=fmu&quantities=forces")
    assert answer.status_code == 200, answer.text
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        described = archive.read("modelDescription.xml").decode()
        source = next(archive.read(name).decode() for name in archive.namelist() if name.endswith("model.c"))
    variable = next(line for line in described.split("<") if 'name="s.push"' in line)
    assert 'start="2.0"' in variable
    assert "u[1] = 2.0;" in source
    assert "u[2] = 3.0;" in source
    # without a default nothing is told, as before
    assert "defaults" not in hill.get("/v1/trees/cell/export?target=interface&name=a").json()["vectors"]["u"]


def test_what_is_refused(hill: TestClient) -> None:
    wrong = {**TREE, "inputs": {"u": {"unit": "N", "default": {"value": 1, "unit": "m"}}}}
    answer = hill.post("/v1/trees", json=wrong)
    assert [(e["pointer"], e["code"]) for e in answer.json()["errors"]] == [("/inputs/u/default", "unit-mismatch")]
