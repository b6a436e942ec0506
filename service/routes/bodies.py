"""How bodies that the service reads and writes itself (exact numbers) are described in the OpenAPI document."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from fastapi import routing
from pydantic import BaseModel

from service.http.routing import router_of


def reference(schema: str) -> dict[str, str]:
    """A reference to a schema of the document."""
    return {"$ref": f"#/components/schemas/{schema}"}


def body_of(schema: str, required: bool = True, others: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """``openapi_extra`` of an endpoint whose JSON body has this schema; ``others``: more media types."""
    described = {"application/json": {"schema": reference(schema)}, **(others or {})}
    return {"requestBody": {"required": required, "content": described}}


def content_of(schema: str) -> dict[int | str, dict[str, Any]]:
    """``responses`` of an endpoint that answers stored JSON of this schema."""
    return {200: {"description": f"The {schema}", "content": {"application/json": {"schema": reference(schema)}}}}


def binary() -> dict[str, Any]:
    """The description of a binary body."""
    return {"schema": {"type": "string", "format": "binary"}}


def printed(media_types: dict[str, str]) -> dict[int | str, dict[str, Any]]:
    """``responses`` of an endpoint that prints formulas in several formats."""
    described: dict[str, Any] = {
        media.partition(";")[0]: {"schema": {"type": "string"}} for media in media_types.values()
    }
    described["application/json"] = {"schema": {"type": "object"}}
    return {200: {"description": "The formulas in the format chosen", "content": described}}


class DescribedRoute(routing.APIRoute):
    """A route whose answers are described by ``models``: its ``response_model``, and ``model`` of its ``responses``.

    They are words about what is written here, and named to FastAPI, which would build a validator of each for each
    route.
    """

    def __init__(self, *given: Any, response_model: Any = None, **more: Any) -> None:
        self.models: list[type[BaseModel]] = []
        responses: dict[Any, Any] = more.pop("responses", None) or {}
        if isinstance(response_model, type):
            status = more.get("status_code") or 200
            responses = {status: {}, **responses}
            responses[status] = {**responses[status], "model": response_model}
        described = {status: self._described(each) for status, each in responses.items()}
        super().__init__(*given, response_model=None, responses=described, **more)

    def _described(self, response: Mapping[str, Any]) -> dict[str, Any]:
        model, rest = response.get("model"), {name: x for name, x in response.items() if name != "model"}
        if model is None:
            return rest
        self.models.append(model)
        content = {"application/json": {"schema": reference(model.__name__)}}
        return {**rest, "content": content | rest.get("content", {})}


#: a router of such routes
APIRouter = partial(router_of, DescribedRoute)
