"""``a.q1-b.q1`` is a difference wherever expressions are read, as it is with blanks."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.settings import Settings

from .conftest import make_client

PENDULUM = "simple-pendulum"


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    folder: Path = tmp_path_factory.mktemp("minus")
    with open_store(Settings(database=f"sqlite:///{folder / 'store.db'}")) as store:
        yield make_client(store)


def two(name: str, potential: str, **parameters: Any) -> dict[str, Any]:
    """Two pendulums with a spring between them."""
    instances = [{"name": "a", "substructure": PENDULUM}, {"name": "b", "substructure": PENDULUM} | parameters]
    law = {"name": "k", "type": "potential", "potential": potential}
    given = {"c": {"value": 3}, "l": {"value": 2}}
    return {"name": name, "gravity": [0, 0, "-9.81"], "parameters": given, "instances": instances, "loads": [law]}


def spaced(given: Any) -> Any:
    """The request with blanks about every minus of an expression."""
    if isinstance(given, dict):
        return {name: spaced(x) for name, x in given.items()}
    if isinstance(given, list):
        return [spaced(x) for x in given]
    return given.replace("-", " - ") if isinstance(given, str) and "." in given else given


def post(client: TestClient, path: str, body: dict[str, Any]) -> Any:
    answer = client.post(path, json=body)
    assert answer.is_success, answer.text
    return answer.json()


@pytest.mark.parametrize(
    "request_",
    [
        {"inputs": {"tau.a.q1": "-3*(a.q1-0.2*sin(t))-2*a.q1'"}},
        {"series": {"apart": "a.q1-b.q1", "rate": "a.q1'-b.q1'-t"}},
        {"events": [{"name": "met", "quantity": "a.q1-b.q1-0.1", "level": 0}]},
    ],
    ids=["inputs", "series", "events"],
)
def test_a_minus_in_simulations(client: TestClient, request_: dict[str, Any]) -> None:
    answer = post(client, "/v1/trees", two("case-two", "c*(a.q1-b.q1)^2/2"))
    assert answer["name"] == "case-two"
    body = {"q": [0.3, 0], "span": [0, 1], "count": 3}
    found = [post(client, "/v1/trees/case-two/simulations", body | x) for x in (request_, spaced(request_))]
    assert spaced(request_) != request_
    assert found[0]["q"] == found[1]["q"]
    assert found[0]["series"].keys() == found[1]["series"].keys()


def test_a_minus_in_loads_and_in_parameters_of_instances(client: TestClient) -> None:
    length = {"parameters": {"l": "a.l-l/4"}}
    trees = [two("tight", "c*(a.q1-b.q1)^2/2", **length), two("loose", "c*(a.q1 - b.q1)^2/2", **spaced(length))]
    state = {"quantities": ["metric", "forces"], "q": [0.3, 0.1], "parameters": {"a.l": 1.0}}
    found = []
    for tree in trees:
        post(client, "/v1/trees", tree)
        found.append(post(client, f"/v1/trees/{tree['name']}/evaluations", state))
    assert found[0]["forces"] == found[1]["forces"]
    assert found[0]["metric"] == found[1]["metric"]
    assert found[0]["metric"][1][1] == pytest.approx(found[0]["metric"][0][0] / 4, rel=1e-12)


def test_a_name_that_is_not_there_is_told_alone(client: TestClient) -> None:
    answer = client.post("/v1/trees", json=two("none", "c*(a.q1-d.q1)^2/2"))
    assert answer.status_code == 422
    assert "unknown name 'd.q1'" in answer.text
