"""What all shapes of requests and answers are made of."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

Digest = Annotated[str, Field(pattern=r"^sha256:[0-9a-f]{64}$", description="sha256 of the canonical bytes")]
Time = Annotated[str, Field(description="UTC, ISO 8601")]
Links = dict[str, Any]


class Warned(BaseModel):
    """Something that is allowed and hardly meant."""

    pointer: str = Field(description="RFC 6901 pointer into the document, or into the request of an evaluation")
    code: str
    message: str
    state: int | None = Field(None, description="number of the state that it is about, from 0")
    quantity: str | None = None


class Shape(BaseModel):
    """Base: no unknown fields."""

    model_config = ConfigDict(extra="forbid")
