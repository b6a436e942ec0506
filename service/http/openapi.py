"""The OpenAPI 3.1 document: what FastAPI generates, with the schemas of the bodies that the service reads itself."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import orjson
from fastapi import FastAPI, Request, Response
from fastapi.encoders import jsonable_encoder
from fastapi.openapi.models import Components
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from service.http.routing import TEMPLATE, Operation
from service.models.numbers import ANALYSES
from service.schemas.analyses.velocity_constraints import VelocityConstraints
from service.schemas.entries import ChangedInstance, ChangedTree, SubmittedDefinition, SubmittedTree, VisibilityRequest
from service.schemas.equivalences import EquivalenceRequest
from service.schemas.jobs import CancelRequest, JobRequest, RetryRequest
from service.schemas.numbers import EvaluationRequest, KernelsRequest
from service.schemas.publishing import PublishRequest
from service.schemas.resources import AliasRequest, Problem, WithdrawalRequest
from service.schemas.sweeps import RowTree
from substructures.loads.kinds import AnyTreeLoad
from substructures.part.definition import Definition
from substructures.tree.document import Instance

JOB_ADDRESS = {"description": "the job", "schema": {"type": "string", "format": "uri-reference"}}
PREFER = {
    "name": "Prefer",
    "in": "header",
    "description": "`wait=N`: at most N seconds, then it becomes a job; `respond-async`: it becomes one at once",
    "schema": {"type": "string"},
}
_REQUESTS = (
    *(AliasRequest, WithdrawalRequest, EvaluationRequest, KernelsRequest, JobRequest, CancelRequest, VisibilityRequest),
    EquivalenceRequest,
    PublishRequest,
    RetryRequest,
    RowTree,
)
_READ_BY_US: tuple[type[BaseModel], ...] = (
    Definition,
    SubmittedDefinition,
    SubmittedTree,
    Instance,
    ChangedInstance,
    ChangedTree,
    AnyTreeLoad,
    *_REQUESTS,
    VelocityConstraints,
    Problem,
)


def document(app: DocumentedApp) -> dict[str, Any]:
    """The document of an app."""
    routes = [operation.read for operation in app.described]
    result = get_openapi(title=app.title, version=app.version, description=app.description, routes=routes)
    written = dict.fromkeys(model for route in routes for model in getattr(route, "models", ()))
    _, answers = models_json_schema([(model, "serialization") for model in written], ref_template=TEMPLATE)
    read_by_us = (*_READ_BY_US, *dict.fromkeys(analysis.schema for analysis in ANALYSES.values()))
    _, extra = models_json_schema([(model, "validation") for model in read_by_us], ref_template=TEMPLATE)
    schemas = result.setdefault("components", {}).setdefault("schemas", {})
    told = jsonable_encoder(Components(schemas=answers["$defs"]), by_alias=True, exclude_none=True)
    schemas.update(told["schemas"] | extra["$defs"])
    for schema in schemas.values():
        if "d" in (fields := schema.get("properties", {})):
            fields["d"] = fields.pop("d")  # last: openapi-python-client reads from a variable of this name
    result["components"]["schemas"] = dict(sorted(schemas.items()))
    result["components"]["securitySchemes"] = {"key": {"type": "http", "scheme": "bearer"}}
    result["security"] = [{}, {"key": []}]
    for methods in result["paths"].values():
        for operation in methods.values():
            _describe_job(operation)
    return result


def _describe_job(operation: dict[str, Any]) -> None:
    """The headers of an endpoint whose answer is, or can become, a job."""
    accepted = operation["responses"].get("202")
    if accepted is None:
        return
    accepted["headers"] = {"Location": JOB_ADDRESS}
    if any(status in operation["responses"] for status in ("200", "201")):
        operation.setdefault("parameters", []).append(PREFER)


def text(app: DocumentedApp) -> str:
    """The document as it is committed."""
    return json.dumps(document(app), indent=1, ensure_ascii=False) + "\n"


class DocumentedApp(FastAPI):
    """Serves this document in place of FastAPI's, as bytes that are made once."""

    def setup(self) -> None:
        """Add the route of the document, and none of pages that show it."""
        self.router.add_route("/openapi.json", self._serve, include_in_schema=False)

    async def _serve(self, _request: Request) -> Response:
        if self._bytes is None:
            self._bytes = orjson.dumps(self.openapi())
        return Response(self._bytes, media_type="application/json")

    def openapi(self) -> dict[str, Any]:
        """The document, made once."""
        if self.openapi_schema is None:
            self.openapi_schema = document(self)
        return self.openapi_schema

    _bytes: bytes | None = None
    #: what the document describes
    described: Sequence[Operation] = ()
