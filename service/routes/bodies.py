"""How bodies that the service reads itself (exact numbers) are described in the OpenAPI document."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


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
