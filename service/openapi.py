"""The OpenAPI 3.1 document: what FastAPI generates, with the schemas of the bodies that the service reads itself."""

from __future__ import annotations

import json
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from service.analyses.numbers import ANALYSES
from service.job_schemas import CancelRequest, JobRequest
from service.number_schemas import EvaluationRequest, KernelsRequest
from service.schemas import AliasRequest, Problem, YankRequest
from substructures.analysis.velocity_constraints import VelocityConstraints
from substructures.definition import Definition
from substructures.tree import Instance, TreeSpec

TEMPLATE = "#/components/schemas/{model}"
PROBLEM: dict[int | str, dict[str, Any]] = {
    "default": {
        "description": "Problem document",
        "content": {"application/problem+json": {"schema": {"$ref": TEMPLATE.format(model="Problem")}}},
    }
}
_ANALYSED: tuple[type[BaseModel], ...] = tuple(dict.fromkeys(analysis.schema for analysis in ANALYSES.values()))
_REQUESTS = (AliasRequest, YankRequest, EvaluationRequest, KernelsRequest, JobRequest, CancelRequest)
_READ_BY_US: tuple[type[BaseModel], ...] = (
    Definition,
    TreeSpec,
    Instance,
    *_REQUESTS,
    VelocityConstraints,
    *_ANALYSED,
    Problem,
)


def document(app: FastAPI) -> dict[str, Any]:
    """The document of an app."""
    result = get_openapi(title=app.title, version=app.version, description=app.description, routes=app.routes)
    _, extra = models_json_schema([(model, "validation") for model in _READ_BY_US], ref_template=TEMPLATE)
    schemas = result.setdefault("components", {}).setdefault("schemas", {})
    schemas.update(extra["$defs"])
    result["components"]["schemas"] = dict(sorted(schemas.items()))
    result["components"]["securitySchemes"] = {"key": {"type": "http", "scheme": "bearer"}}
    result["security"] = [{}, {"key": []}]
    return result


def text(app: FastAPI) -> str:
    """The document as it is committed."""
    return json.dumps(document(app), indent=1, sort_keys=True, ensure_ascii=False) + "\n"


class DocumentedApp(FastAPI):
    """Serves this document in place of FastAPI's."""

    def openapi(self) -> dict[str, Any]:
        """The document, made once."""
        if self.openapi_schema is None:
            self.openapi_schema = document(self)
        return self.openapi_schema
