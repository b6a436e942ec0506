"""``true`` is no number: requests in which it stands where a count or a number belongs are refused, at its place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import pytest
from fastapi.testclient import TestClient
from pydantic import BaseModel

from service.http.openapi import _READ_BY_US
from service.models.numbers import ANALYSES
from service.models.requests import read_request
from service.schemas.analyses.ensembles import EnsembleRequest
from service.schemas.numbers import EvaluationRequest
from service.schemas.resources import Problem
from substructures.errors import InvalidInput

from .analysis_trees import client, store
from .test_jobs_cover import REQUESTS

__all__ = ["client", "store"]  # fixtures

Schema = Mapping[str, Any]
#: how deep values are made: lists of objects of lists, in alternatives
DEEPEST = 8
#: answers; and requests whose numbers are read as arrays, where their other members are
ELSEWHERE = {Problem, EvaluationRequest, EnsembleRequest}
READ = [
    model for model in (*_READ_BY_US, *dict.fromkeys(a.schema for a in ANALYSES.values())) if model not in ELSEWHERE
]


def with_true(schema: Schema, known: Schema, depth: int = 0) -> Iterator[Any]:
    """Values of a JSON schema that have ``true`` in the place of one of its numbers; the rest of them is not there."""
    if "$ref" in schema:
        schema = known[schema["$ref"].rpartition("/")[2]]
    alternatives = [*schema.get("anyOf", ()), *schema.get("oneOf", ())]
    if depth > DEEPEST or any(each.get("type") == "boolean" for each in alternatives):
        return
    for each in alternatives:
        yield from with_true(each, known, depth + 1)
    if schema.get("type") in ("integer", "number"):
        yield True
    fixed = schema.get("prefixItems", ())
    for i, each in enumerate(fixed):
        yield from ([*[0] * i, x, *[0] * (len(fixed) - i - 1)] for x in with_true(each, known, depth + 1))
    if isinstance(schema.get("items"), Mapping):
        yield from ([x] * schema.get("minItems", 1) for x in with_true(schema["items"], known, depth + 1))
    if isinstance(schema.get("additionalProperties"), Mapping):
        yield from ({"x": x} for x in with_true(schema["additionalProperties"], known, depth + 1))
    members = schema.get("properties", {})
    kind = {name: each["const"] for name, each in members.items() if "const" in each}
    for name, each in members.items():
        yield from ({**kind, name: x} for x in with_true(each, known, depth + 1))


def places(given: Any, kind: type, place: str = "") -> Iterator[str]:
    """The pointers to all values of a type."""
    if type(given) is kind:
        yield place
    below = given if isinstance(given, dict) else dict(enumerate(given)) if isinstance(given, list) else {}
    for name, each in below.items():
        yield from places(each, kind, f"{place}/{name}")


@pytest.mark.parametrize("model", READ, ids=lambda model: model.__name__)
def test_true_is_no_number_of_a_request(model: type[BaseModel]) -> None:
    schema = model.model_json_schema()
    for body in with_true(schema, schema.get("$defs", {})):
        if not isinstance(body, dict):
            continue
        with pytest.raises(InvalidInput) as error:
            read_request(model, body)
        found = [fault.pointer for fault in error.value.faults if fault.code not in ("missing", "extra-forbidden")]
        place = next(places(body, bool))
        assert any(pointer and place.startswith(pointer) for pointer in found), body


def replaced(given: Any, place: str) -> Any:
    """The data with ``true`` at a place."""
    if not place:
        return True
    first, _, rest = place[1:].partition("/")
    below = f"/{rest}" if rest else ""
    if isinstance(given, dict):
        return {name: replaced(x, below) if str(name) == first else x for name, x in given.items()}
    return [replaced(x, below) if str(i) == first else x for i, x in enumerate(given)]


@pytest.mark.parametrize("name", REQUESTS)
def test_true_is_no_number_of_an_analysis(name: str, client: TestClient) -> None:
    tree, request = REQUESTS[name]
    for kind in (int, float):
        for place in places(request, kind):
            answer = client.post(f"/v1/trees/{tree}/{name}", json=replaced(request, place))
            assert answer.status_code in (400, 422), (place, answer.text[:300])
            pointers = [fault["pointer"] for fault in answer.json()["errors"]]
            assert any(place.startswith(pointer) and pointer for pointer in pointers), (place, pointers)
