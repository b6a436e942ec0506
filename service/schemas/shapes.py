"""What all shapes of requests and answers are made of."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError

from substructures.errors import meant

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

    model_config = ConfigDict(extra="forbid", defer_build=True)


def refused(code: str, message: str, below: str = "") -> PydanticCustomError:
    """What a validator raises: the fault ``code``, at the place ``below`` what it validates."""
    return PydanticCustomError(code, "{message}", {"message": message, "below": below})


def one_of(what: str, known: Callable[[], Collection[str]]) -> AfterValidator:
    """Refuses what is none of the names that are known, with those that there are, as ``unknown-{what}``."""

    def check(given: str) -> str:
        """The name."""
        names = known()
        if given not in names:
            message = f"unknown {what} '{given[:40]}'; there are {', '.join(names)}{meant(given, names)}"
            raise refused(f"unknown-{what}", message)
        return given

    return AfterValidator(check)
