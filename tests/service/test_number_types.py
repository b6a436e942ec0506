"""Every analysis with one parameter in place of its default, and with numbers of every type."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.jobs.kinds.trees import source_of
from service.messages.viewer import ANYBODY
from service.models.numbers import ANALYSES
from service.models.results import JSON, written
from service.operations.sharing.sources import pinned_tree
from service.operations.trees import find
from service.settings import Settings
from service.store.store import Store

from .analysis_trees import TREES
from .conftest import make_client
from .test_jobs_cover import REQUESTS

#: in place of 1, and of what numbers are given as
OVERRIDDEN = 1.25
NUMBERS: dict[str, Callable[[float], Any]] = {
    "int": lambda x: int(x) if x == int(x) else x,
    "float": float,
    "decimal": lambda x: Decimal(repr(x)),
    "fraction": Fraction,
    "numpy.float64": np.float64,
    "numpy.float32": np.float32,
    "numpy.int64": lambda x: np.int64(x) if x == int(x) else np.float64(x),
}
HEAVY = {"parameters": {"m": {"value": 1, "unit": "kg"}, "share": {"value": 1}}}


def with_mass(part: Mapping[str, Any]) -> dict[str, Any]:
    """The part with a mass that a parameter which is given and one which is not are factors of."""
    return {**part, **HEAVY, "bodies": [{**body, "mass": "m*share"} for body in part["bodies"]]}


def with_parameters(tree: dict[str, Any]) -> dict[str, Any]:
    """The tree with parameters that a request can override."""
    instances = []
    for one in tree["instances"]:
        own = {name: x for name, x in one.items() if name != "parameters"}
        if "definition" in own:
            own["definition"] = with_mass(own["definition"])
        instances.append(own)
    return {**tree, "instances": instances}


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    folder: Path = tmp_path_factory.mktemp("types")
    with open_store(Settings(database=f"sqlite:///{folder / 'store.db'}")) as store:
        yield store


@pytest.fixture(scope="module")
def client(store: Store) -> TestClient:
    client = make_client(store)
    for tree in TREES:
        answer = client.post("/v1/trees", json=with_parameters(tree))
        assert answer.status_code in (200, 201), answer.text
    return client


def request_of(client: TestClient, analysis: str) -> tuple[str, dict[str, Any]]:
    """Tree and request with one parameter in place of its default."""
    tree, request = REQUESTS[analysis]
    known = client.get(f"/v1/trees/{tree}").json()["parameters"]
    name = next(n for n in known if n.rpartition(".")[2].startswith("m") and n != request.get("parameter"))
    return tree, {**request, "parameters": {name: OVERRIDDEN}}


@pytest.mark.parametrize("analysis", ANALYSES)
def test_one_parameter_is_overridden(client: TestClient, analysis: str) -> None:
    tree, request = request_of(client, analysis)
    answer = client.post(f"/v1/trees/{tree}/{analysis}", json=request)
    assert answer.status_code == 200, answer.text


def converted(given: Any, number: Callable[[float], Any]) -> Any:
    """The request with other numbers for floats."""
    if isinstance(given, Mapping):
        return {name: converted(x, number) for name, x in given.items()}
    if isinstance(given, list | tuple):
        return [converted(x, number) for x in given]
    return number(given) if isinstance(given, float) else given


@pytest.mark.parametrize("kind", NUMBERS)
@pytest.mark.parametrize("analysis", ["linearisations", "loop-states", "curvatures", "simulations", "root-loci"])
def test_numbers_of_every_type(client: TestClient, store: Store, analysis: str, kind: str) -> None:
    tree, request = request_of(client, analysis)
    with store.database.read() as connection:
        found = find(connection, ANYBODY, tree)
    source = source_of(*pinned_tree(store, found), {})
    answers = []
    for number in (float, NUMBERS[kind]):
        result = ANALYSES[analysis].compute(source, converted(request, number), lambda _: None)
        answers.append(json.loads(written(result, JSON, source.model)))
    assert answers[1].keys() == answers[0].keys()
    assert flat(answers[1]) == pytest.approx(flat(answers[0]), rel=1e-6, abs=1e-6)


def test_an_inertia_with_one_of_two_parameters_overridden(client: TestClient) -> None:
    parameters = {"l": {"value": 0.5, "unit": "m"}, "m2": {"value": 1, "unit": "kg"}}
    bar = {
        "name": "b",
        "parent": "base",
        "joint": {"type": "revolute", "coordinate": "q", "theta": "pi/2"},
        "mass": "m2",
        "com": ["l/2", 0, 0],
        "inertia": {"zz": "m2*l^2/12", "yy": "m2*l^2/12"},
    }
    arm = {"name": "arm", "definition": {"name": "bar", "parameters": parameters, "bodies": [bar]}}
    assert client.post("/v1/trees", json={"name": "over", "gravity": [0, 0, "-9.81"], "instances": [arm]}).is_success
    answer = client.post("/v1/trees/over/linearisations", json={"q": [0.1], "parameters": {"arm.m2": 1.1}})
    assert answer.status_code == 200
    assert answer.json()["M"][0][0] == pytest.approx(1.1 * 0.5**2 / 3)


def flat(given: Any) -> list[float]:
    """All numbers of an answer."""
    if isinstance(given, dict):
        return [x for name in given if name not in ("checks", "evaluations", "seconds") for x in flat(given[name])]
    if isinstance(given, list):
        return [x for item in given for x in flat(item)]
    return [given] if isinstance(given, float) else []
