"""``/v1/substructures/{ref}/report`` and ``/v1/trees/{ref}/report``: what can be said of their formulas."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import Depends, Header, Query, Request, Response

from service.http.acting import in_time
from service.http.requests import StoreOf, ViewerOf, needs
from service.http.responses import remembered
from service.jobs.worker import Worker
from service.messages.answers import etag
from service.messages.negotiation import choose_format
from service.operations import catalogue, reports, trees
from service.operations.sharing.sources import part_programs
from service.routes.bodies import APIRouter, reference
from service.schemas.reports import ReportView

router = APIRouter(prefix="/v1", dependencies=[needs("read")])
ADVICE = "ask for the formulas one by one"
REPORTED: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The report in the format chosen",
        "content": {
            media.partition(";")[0]: {
                "schema": reference(ReportView.__name__) if name == "json" else {"type": "string"}
            }
            for name, media in reports.FORMATS.items()
        },
    }
}


@dataclass(frozen=True, slots=True)
class Wanted:
    """One of the formats, and whether LaTeX has its head and end."""

    format: str
    document: bool


async def wanted_of(
    format: Annotated[  # noqa: A002 -- the name in the contract
        str | None,
        Query(max_length=40, description="wins over Accept", json_schema_extra={"enum": [*reports.FORMATS, None]}),
    ] = None,
    document: Annotated[bool, Query(description="LaTeX as a whole document; false: without head and end")] = True,
    accept: Annotated[str, Header()] = "*/*",
) -> Wanted:
    """What a request asks for."""
    return Wanted(choose_format(format, accept, reports.FORMATS), document)


WantedOf = Annotated[Wanted, Depends(wanted_of)]


@router.get("/substructures/{ref}/report", response_model=ReportView, responses=REPORTED, tags=["formulas"])
async def get_substructure_report(
    ref: str, request: Request, store: StoreOf, viewer: ViewerOf, wanted: WantedOf
) -> Response:
    """A part alone, told to people: structure and symmetries of its formulas in words, sizes of terms at the defaults;
    in LaTeX a document, as XHTML a page, both with picture, symbols, derivation, formulas and sources.
    """

    def answered(worker: Worker) -> Response:
        """The report in a thread."""
        with store.database.read() as connection:
            version = catalogue.find(connection, viewer, ref)
        named = f"{version.name}@{version.version}"
        tag = etag(version.digest, version.program, named, "report", wanted.format, str(wanted.document))
        # what a report says changes with the software: it is asked for again, by its ETag
        return remembered(
            store,
            request,
            tag,
            False,
            lambda: reports.of_part(store, worker, version, wanted.format, wanted.document),
        )

    return await in_time(request, answered, ADVICE)


@router.get("/trees/{ref}/report", response_model=ReportView, responses=REPORTED, tags=["models"])
async def get_tree_report(ref: str, request: Request, store: StoreOf, viewer: ViewerOf, wanted: WantedOf) -> Response:
    """A tree, told to people, as the report of a part."""

    def answered(worker: Worker) -> Response:
        """The report in a thread."""
        with store.database.read() as connection:
            tree = trees.find(connection, viewer, ref)
        named = f"{tree.name}@{tree.revision}"
        programs = tree.program, *part_programs(store, tree)
        tag = etag(tree.digest, *programs, named, "report", wanted.format, str(wanted.document))
        return remembered(
            store,
            request,
            tag,
            False,
            lambda: reports.of_tree(store, worker, tree, wanted.format, wanted.document),
        )

    return await in_time(request, answered, ADVICE)
