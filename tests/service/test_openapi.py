"""The committed OpenAPI document is what the code generates, and it describes every answer."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from service.app import bare_app
from service.http import openapi

COMMITTED = Path(openapi.__file__).parents[1] / "openapi.json"


def operations() -> list[tuple[str, dict[str, Any]]]:
    paths = openapi.document(bare_app())["paths"]
    return [(f"{method} {path}", operation) for path, methods in paths.items() for method, operation in methods.items()]


def test_committed_document_is_current() -> None:
    """Regenerate with: substructures openapi > service/openapi.json"""
    assert COMMITTED.read_text() == openapi.text(bare_app())


def test_every_reference_resolves() -> None:
    document = openapi.document(bare_app())
    text = json.dumps(document)
    assert document["openapi"].startswith("3.1")
    names = {part.split('"')[0] for part in text.split("#/components/schemas/")[1:]}
    assert names <= document["components"]["schemas"].keys()
    assert {"SubmittedDefinition", "SubmittedTree", "Instance", "EvaluationRequest", "Problem"} <= names


def test_bodies_and_problems_are_described() -> None:
    for name, operation in operations():
        assert "application/problem+json" in operation["responses"]["default"]["content"], name
        if name.startswith(("post", "put")) and not name.endswith(("/imports", "/bundles")):  # these are files
            assert operation["requestBody"]["content"]["application/json"]["schema"]["$ref"], name


#: what makes a job in any case
MAKES_JOBS = ("post /v1/jobs", "post /v1/jobs/{job}/retry")


def test_headers_of_jobs_are_described() -> None:
    found = dict(operations())
    for name, operation in found.items():
        assert "Retry-After" in operation["responses"]["default"]["headers"], name
        prefers = "Prefer" in [parameter["name"] for parameter in operation.get("parameters", ())]
        becomes_job = "202" in operation["responses"]
        assert prefers == (becomes_job and name not in MAKES_JOBS), name
        assert not becomes_job or "Location" in operation["responses"]["202"]["headers"], name
    assert "202" in found["post /v1/jobs"]["responses"]
    assert "202" in found["delete /v1/trees/{ref}/couplings/{instance}"]["responses"]
    file = found["get /v1/jobs/{job}/items/{position}/files/{name}"]["responses"]["200"]["content"]
    assert {"application/json", "application/x-npz", "text/csv", "application/octet-stream"} <= file.keys()
