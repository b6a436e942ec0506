"""What runners derive for evaluations is what is derived here, and time that it takes makes a job of the request."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.jobs.engines.engine import AttemptReport, Outcome, Work
from service.jobs.kinds.requested.derived import derived_of, read_derived
from service.messages.viewer import ANYBODY
from service.operations import trees
from service.operations.sharing.sources import pinned_tree, tree_parts
from service.store.store import Store
from substructures.documents import read_json, write_json
from substructures.quantities.formulas import derived
from substructures.quantities.quantity import OF_PARTS, PROGRAMS

from .conftest import HAND

MASSLESS: dict[str, Any] = {
    "name": "massless",
    "instances": [
        {
            "name": "a",
            "definition": {
                "name": "wire",
                "bodies": [
                    {"name": "w", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}, "mass": 0}
                ],
            },
        }
    ],
}


@pytest.mark.parametrize("source", PROGRAMS)
def test_what_a_runner_derives_is_what_is_derived_here(filled: TestClient, store: Store, source: str) -> None:
    answer = filled.post("/v1/trees/cell/couplings", json=HAND)
    assert answer.status_code == 201, answer.text
    with store.database.read() as connection:
        tree = trees.find(connection, ANYBODY, "cell")
        model = store.model(connection, tree)
    item, blobs = pinned_tree(store, tree)
    made = derived_of({**item, "source": source, "nodes": 10_000}, blobs)
    sent = Outcome(read_json(write_json(dict(made.summary))), made.files)
    found = read_derived(source, sent)
    if source in OF_PARTS:
        expected = PROGRAMS[source].function(*tree_parts(store, tree), 10_000)
        assert type(found) is type(expected)
        assert found.labels == expected.labels
        assert found == expected
    else:
        assert found == derived(model, source, 10_000)


def test_a_metric_that_is_singular_everywhere_has_no_accelerations(client: TestClient) -> None:
    assert client.post("/v1/trees", json=MASSLESS).status_code == 201
    asked = {"quantities": ["forward_dynamics", "kinetic_energy"], "q": [0], "qd": [1]}
    told = client.post("/v1/trees/massless/evaluations", json=asked).json()
    assert told["forward_dynamics"] is None
    assert told["kinetic_energy"] == 0


def test_what_takes_long_to_derive_becomes_a_job(
    filled: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    compute = store.workers.compute

    def slow(share: str, work: Work, seconds: float) -> AttemptReport:
        """Nothing that is derived is done in time."""
        if work.kind == "derived":
            raise TimeoutError
        return compute(share, work, seconds)

    monkeypatch.setattr(store.workers, "compute", slow)
    asked = {"quantities": ["regressor"], "q": [0.1], "qdd": [0]}
    answer = filled.post("/v1/trees/cell@1/evaluations", json=asked)
    assert answer.status_code == 202, answer.text
    assert answer.json()["kind"] == "evaluate"
