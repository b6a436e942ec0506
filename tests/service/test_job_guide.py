"""What users read about jobs is true: the examples of the OpenAPI document can be submitted."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import bare_app
from service.http import openapi
from service.jobs import kinds
from service.schemas.job_guide import EXAMPLES, KINDS
from substructures import catalogue
from substructures.documents import write_json

SWING = {"name": "swing", "instances": [{"name": "rod", "substructure": "acrobot"}]}


def schemas() -> dict[str, Any]:
    return dict(openapi.document(bare_app())["components"]["schemas"])


def described() -> dict[str, Any]:
    return dict(schemas()["JobRequest"])


def test_every_kind_is_described() -> None:
    assert all(f"`{kind}`" in KINDS for kind in kinds.KINDS)
    of_items = schemas()["SubmittedItems"]
    assert of_items["properties"]["kind"]["description"] == KINDS
    assert of_items["oneOf"] == [{"required": ["items"]}, {"required": ["template", "choices"]}]
    assert {*described()["discriminator"]["mapping"]} == {*kinds.KINDS}


@pytest.fixture
def known(client: TestClient) -> TestClient:
    """A client of a server that knows what the examples refer to."""
    for name in ("acrobot", "puma560", "ur5", "camera", "parallel-gripper"):
        content, headers = write_json(catalogue.load(name)), {"Content-Type": "application/json"}
        assert client.post("/v1/substructures", content=content, headers=headers).status_code == 201
    assert client.post("/v1/trees", json=SWING).status_code == 201
    return client


def test_examples_can_be_submitted(known: TestClient) -> None:
    assert described()["examples"] == list(EXAMPLES)
    totals = []
    for example in EXAMPLES:
        answer = known.post("/v1/jobs", json=example)
        assert answer.status_code == 202, answer.text
        totals.append(answer.json()["progress"]["total"])
    assert totals == [4, 3, 6, 2, 1, 1, 1, 5, 5, 2]
