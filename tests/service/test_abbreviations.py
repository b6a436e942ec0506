"""Abbreviated formulas over HTTP: the same as by the library, faults with their places, and a limit of time."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import orjson
import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.settings import Limits, Settings
from service.store.store import Store
from substructures import Definition, Program, TreeSpec, abbreviate, catalogue, couple, derive
from substructures.expr.interpret import interpret

from .conftest import make_client

TREE = {"name": "cell", "gravity": [0, 0, "-g"], "parameters": {"g": {"value": 9.81}}}
RANGES = {"velocities": [-1, 1], "accelerations": ["-pi", "pi"], "arm.m2": [0.001, 0.01]}
REQUEST: dict[str, Any] = {"quantity": "inverse_dynamics", "simplify": 0.02, "ranges": RANGES}


def store_in(folder: Path) -> Iterator[TestClient]:
    settings = Settings(database=f"sqlite:///{folder / 's.db'}", catalogue=False)
    with open_store(settings) as store:
        yield client_of(store)


def client_of(store: Store) -> TestClient:
    client = make_client(store)
    instance = {"name": "arm", "definition": catalogue.load("double-pendulum")}
    assert client.post("/v1/trees", json=plain({**TREE, "instances": [instance]})).status_code == 201
    return client


def plain(x: Any) -> Any:
    """Decimals as numbers of JSON."""
    if isinstance(x, dict):
        return {name: plain(value) for name, value in x.items()}
    if isinstance(x, list | tuple):
        return [plain(value) for value in x]
    return x if isinstance(x, str | int | bool) or x is None else float(x)


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    yield from store_in(tmp_path_factory.mktemp("abbreviations"))


def test_the_answer_is_that_of_the_library(client: TestClient) -> None:
    answer = client.post("/v1/trees/cell/abbreviations", json=REQUEST | {"format": "text"})
    assert answer.status_code == 200, answer.text
    told = answer.json()
    part = derive(Definition.read(catalogue.load("double-pendulum")))
    spec = TreeSpec.read({**TREE, "instances": [{"name": "arm", "substructure": "double-pendulum"}]})
    found = abbreviate(couple(spec, {"arm": part}, group=True), "inverse_dynamics", 0.02, RANGES)
    assert (told["operations"], told["operations_before"]) == (found.operations, found.operations_before)
    assert told["operations"] < told["operations_before"]
    assert told["bound"] == found.bound <= 0.02
    assert [each["index"] for each in told["errors"]] == [list(each.index) for each in found.errors]
    assert told["values"]["g"] == "9.81"
    assert told["ranges"]["arm.m2"] == [0.001, 0.01]
    assert "tau" not in told["formulas"]
    # the formulas that were sent are those that the bounds are about
    program = Program.from_bytes(orjson.dumps(told["program"]))
    rng = np.random.default_rng(1)
    values = {name: rng.uniform(*ends, 500) for name, ends in told["ranges"].items()}
    full = interpret(found.full, values)["inverse_dynamics"]
    error = np.abs(interpret(program, values)["inverse_dynamics"] - full).max(axis=0)
    for each in told["errors"]:
        assert error[each["index"][0]] <= each["bound"] + 1e-12


def test_formulas_as_code(client: TestClient) -> None:
    answer = client.post("/v1/trees/cell/abbreviations", json=REQUEST | {"format": "c"})
    # the one parameter that has a range is the one that is left
    assert "double" in answer.json()["formulas"]
    assert client.post("/v1/trees/cell/abbreviations", json=REQUEST).json()["formulas"] is None


@pytest.mark.parametrize(
    ("changes", "pointer"),
    [
        ({"simplify": 1}, "/simplify"),
        ({"simplify": "much"}, "/simplify"),
        ({"quantity": "nothing"}, "/quantity"),
        ({"ranges": {"arm.q1": [1, 0]}}, "/ranges/arm.q1"),
        ({"ranges": {}}, "/ranges/arm.q1''"),
        ({"ranges": {"arm.q7": [0, 1]}}, "/ranges/arm.q7"),
        ({"ranges": 1}, "/ranges"),
        ({"format": "rtf"}, "/format"),
        ({"form": "short"}, "/form"),
        ({"parameters": {"arm.x": 1}}, "/parameters/arm.x"),
        ({"tolerance": 1}, "/tolerance"),
    ],
)
def test_bad_requests(client: TestClient, changes: dict[str, Any], pointer: str) -> None:
    answer = client.post("/v1/trees/cell/abbreviations", json=REQUEST | changes)
    assert answer.status_code == 422, answer.text
    assert pointer in [fault["pointer"] for fault in answer.json()["errors"]]


def test_work_that_takes_too_long_becomes_a_job(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    store = client.app.state.store  # type: ignore[attr-defined]
    short = store.settings.model_copy(update={"limits": Limits(sync_seconds=0.001)})
    monkeypatch.setattr(store, "settings", short)
    answer = client.post("/v1/trees/cell/abbreviations", json=REQUEST)
    assert (answer.status_code, "Location" in answer.headers) == (202, True), answer.text
