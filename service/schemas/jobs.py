"""Shapes of jobs: requests and answers, for OpenAPI; units are in the descriptions."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from service.schemas.job_guide import CHOICES, EXAMPLES, KINDS
from service.schemas.shapes import Links, Shape, Time
from substructures.documents.fields import Words

JobKind = Literal[
    "assemble",
    "evaluate",
    "export",
    "derive",
    "verify",
    "upgrade",
    "compare",
    "simulate",
    "optimise",
    "analyse",
    "mirror",
]
JobState = Literal["queued", "running", "cancelling", "succeeded", "failed", "cancelled"]
ItemDocument = dict[str, Any]
ChoiceValues = Annotated[list[Any], Field(min_length=1)]
ItemState = Literal["queued", "running", "succeeded", "failed", "cancelled"]


class JobRequest(Shape):
    """What is to be computed: a list of items, or a template with lists of choices."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "oneOf": [{"required": ["items"]}, {"required": ["template", "choices"]}],
            "examples": list(EXAMPLES),
        },
    )

    kind: JobKind = Field(description=KINDS)
    items: list[ItemDocument] = Field(default_factory=list, min_length=1, description="what an item is: see `kind`")
    template: ItemDocument = Field(
        default_factory=dict, description="an item that is copied for every combination of choices"
    )
    choices: dict[str, ChoiceValues] = Field(default_factory=dict, min_length=1, description=CHOICES)
    shared: bool = Field(False, description="whether every API key may see the job, not only those of its owner")
    label: Words = Field("", max_length=200, description="what it is for, in words")
    on_invalid: Literal["refuse", "skip"] = Field(
        "refuse", description="one bad item: refuse all, or leave it out and tell of it in `skipped` of the answer"
    )


class SkippedFault(Shape):
    """One thing wrong with an item."""

    pointer: str = Field(description="RFC 6901 pointer into the item")
    code: str
    message: str


class SkippedItem(Shape):
    """An item that cannot be computed and was left out."""

    item: int = Field(description="its number among those given, from 0")
    errors: list[SkippedFault]


class CancelRequest(Shape):
    """Nothing needs to be said."""


class RetryRequest(Shape):
    """What is tried again of a job."""

    label: Words | None = Field(None, max_length=200, description="of the new job (default: that of the old one)")


class JobProgress(Shape):
    """How far a job is."""

    done: int = Field(description="items that succeeded or failed")
    failed: int = Field(description="also those of which a part of the result is there")
    skipped: int = Field(description="items of the submission that were left out; `total` does not count them")
    total: int
    fraction: float = Field(description="0 to 1, with parts of running items")
    rate: float | None = Field(description="items per second, of late")
    eta_seconds: float | None = Field(description="time left at this rate, s")


class JobView(Shape):
    """A job. It fails when all of its items fail; otherwise the result says which of them did."""

    id: str
    kind: JobKind
    label: str = Field(description="what it is for, in words")
    retry_of: str | None = Field(description="the job of which it tries again what failed")
    state: JobState
    progress: JobProgress
    attempts: int = Field(description="attempts on all items")
    principal: str = Field(description="id of the API key, or local")
    owner: str = Field(description="whose keys see and cancel it")
    shared: bool = Field(description="whether every API key may see it")
    created: Time
    started: Time | None
    finished: Time | None
    error: dict[str, Any] | None = Field(description="problem document")
    skipped: list[SkippedItem] = Field([], description="of a submission with `on_invalid: skip`, in its answer alone")
    result: str = Field(description="where the results are, also in part while the job runs")
    links: Links


class JobPage(Shape):
    """Jobs, the newest first."""

    items: list[JobView]
    next_page_token: str | None
    links: Links


class FileView(Shape):
    """A file of a result."""

    name: str
    size: int = Field(description="bytes")
    media_type: str
    href: str


class ItemView(BaseModel):
    """An item of a job: its result, or the problem document of its own."""

    position: int
    subject: str | None = Field(description="of what failed: the tree or part that it is about")
    state: ItemState
    attempts: int
    deaths: list[str] = Field(description="what was seen of attempts whose worker died")
    fraction: float
    key: Annotated[str, Field(description="digest of what is computed; equal items share their result")]
    started: Time | None
    finished: Time | None
    problem: dict[str, Any] | None
    result: dict[str, Any] | None
    files: list[FileView]


class ItemPage(Shape):
    """Items in their order."""

    items: list[ItemView]
    next_page_token: str | None
    links: Links
