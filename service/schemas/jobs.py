"""Shapes of jobs: requests and answers, for OpenAPI; units are in the descriptions."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, RootModel, StrictBool, WithJsonSchema, model_validator

from service.schemas.job_guide import CHOICES, EXAMPLES, KINDS
from service.schemas.shapes import Links, Shape, Time, refused
from substructures.documents.fields import Words
from substructures.sweeps.document import SweepDocument

LONGEST_LABEL = 200
COMPUTED = "whether the result has the seal of this server; false: an older version kept or queued it, or others"
ItemsKind = Literal[
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
JobKind = Literal[ItemsKind, "sweep"]
JobState = Literal["queued", "running", "cancelling", "succeeded", "failed", "cancelled"]
ItemDocument = dict[str, Any]
#: which is read by its kind, so that a bad one may be left out
OneItem = Annotated[Any, WithJsonSchema({"type": "object", "additionalProperties": True})]
ChoiceValues = Annotated[list[Any], Field(min_length=1)]
ItemState = Literal["queued", "running", "succeeded", "failed", "cancelled"]


class Submitted(Shape):
    """What every submission says of the job as a whole."""

    shared: StrictBool = Field(False, description="whether every API key may see the job, not only those of its owner")
    label: Words = Field("", max_length=LONGEST_LABEL, description="what it is for, in words")
    labels: dict[str, str] = Field(
        default_factory=dict, description="words by name, which stand in the label, `study:night`"
    )

    @model_validator(mode="after")
    def _are_words(self) -> Self:
        if not all(re.fullmatch(r"\S+", f"{name}{word}") for name, word in self.labels.items()):
            raise refused("bad-label", 'an object of words by name is needed, {"study": "night"}', "/labels")
        if len(self.whole_label) > LONGEST_LABEL:
            raise refused("bad-label", f"all labels together have at most {LONGEST_LABEL} characters", "/labels")
        return self

    @property
    def whole_label(self) -> str:
        """The label with the labels by name behind it."""
        return " ".join(filter(None, [self.label, *(f"{name}:{word}" for name, word in self.labels.items())]))


class SubmittedItems(Submitted):
    """A list of items, or a template with lists of choices."""

    model_config = ConfigDict(
        json_schema_extra={"oneOf": [{"required": ["items"]}, {"required": ["template", "choices"]}]}
    )

    kind: ItemsKind = Field(description=KINDS)
    items: list[OneItem] | None = Field(None, min_length=1, description="what an item is: see `kind`")
    template: ItemDocument | None = Field(None, description="an item that is copied for every combination of choices")
    choices: dict[str, ChoiceValues] | None = Field(None, min_length=1, description=CHOICES)
    on_invalid: Literal["refuse", "skip"] = Field(
        "refuse", description="one bad item: refuse all, or leave it out and tell of it in `skipped` of the answer"
    )

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.items is None) == (self.template is None):
            raise refused("one-source", "give either 'items', or a 'template' with 'choices'", "/items")
        if (self.template is None) != (self.choices is None):
            raise refused("no-choices", "a 'template' has 'choices', an object of lists of choices", "/choices")
        return self


class SubmittedSweep(Submitted, SweepDocument):
    """A tree with choices of parts and samples of parameters, and the columns of a table of all combinations."""

    kind: Literal["sweep"]


class JobRequest(RootModel[Any]):
    """What is to be computed: items, or a sweep."""

    model_config = ConfigDict(json_schema_extra={"examples": list(EXAMPLES)}, defer_build=True)
    root: Annotated[SubmittedItems | SubmittedSweep, Field(discriminator="kind")]


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

    label: Words | None = Field(
        None, max_length=LONGEST_LABEL, description="of the new job (default: that of the old one)"
    )


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
    computed_here: bool | None = Field(description=COMPUTED)
    files: list[FileView]


class ItemPage(Shape):
    """Items in their order."""

    items: list[ItemView]
    next_page_token: str | None
    links: Links
