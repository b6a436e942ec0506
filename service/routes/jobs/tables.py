"""``/v1/jobs/{job}/table`` and what belongs to it: the rows of a sweep, its Pareto front, and trees of rows."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

from fastapi import Query, Request, Response

from service.http.acting import ActOf, timed
from service.http.requests import OptionalJsonBody, StoreOf, ViewerOf, needs
from service.http.responses import link_header, next_link, response_of
from service.messages.answers import JSON, json_answer, streamed
from service.messages.paging import limited, read_token, write_token
from service.messages.viewer import Viewer
from service.operations import trees
from service.operations.jobs import jobs, tables
from service.operations.jobs.tables import Table
from service.routes.bodies import APIRouter, binary, body_of
from service.routes.deferred import FRESH, deferred, made
from service.routes.revisions import revision
from service.schemas.entries import Entry
from service.schemas.resources import TreeView
from service.schemas.sweeps import ColumnView, RowTree, TablePage
from service.store.store import Store
from service.views.resources import dump
from service.views.tables import CSV, FILES, as_file, chosen_media, rows_view
from substructures.documents import read_model

router = APIRouter(prefix="/v1/jobs/{job}", tags=["jobs"])
READ = [needs("read")]
Where = Annotated[str, Query(max_length=2000, description="a condition over columns, `mass < 3 and torque < 180`")]
Sort = Annotated[
    str, Query(max_length=500, description="columns, the first one first, `-` for falling: `-torque,mass`")
]
Names = Annotated[str, Query(max_length=5000, description="columns, separated by commas; all if left out")]
PageSize = Annotated[int, Query(ge=1)]
Token = Annotated[str | None, Query(max_length=2000)]
TABLE: dict[int | str, Any] = {
    200: {"description": "JSON page by page, or all rows as a file", "content": {media: binary() for media in FILES}}
}


def _answered(
    request: Request, store: Store, table: Table, search: tuple[Any, ...], size: int, token: str | None
) -> Response:
    media = chosen_media(request.headers.get("accept", "*/*"))
    if media != JSON:
        found = streamed(as_file(table, media), f"{media}; charset=utf-8" if media == CSV else media)
        return response_of(replace(found, headers={**found.headers, **FRESH}))
    size = limited(size, store.settings.limits.page_size)
    after = read_token(search, token, int)
    start = after[0] if after else 0
    following = write_token(search, start + size) if start + size < table.count else None
    link = next_link(request, following)
    view = {**rows_view(table, start, start + size), "next_page_token": following, "links": {"next": link}}
    return response_of(json_answer(dump(view), headers={**FRESH, **link_header(link)}))


def _found(store: Store, viewer: Viewer, job: str) -> Table:
    with store.database.read() as connection:
        return tables.table_of(connection, jobs.find(connection, viewer, job))


@router.get("/table", response_model=TablePage, dependencies=READ, responses=TABLE)
def get_job_table(
    job: str,
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    where: Where = "",
    sort: Sort = "",
    columns: Names = "",
    page_size: PageSize = 50,
    page_token: Token = None,
) -> Response:
    """The rows of a sweep that fit, also while it runs; as JSON in pages, as CSV, npz, Arrow or Parquet all of them."""
    names = [name.strip() for name in columns.split(",") if name.strip()]
    table = tables.chosen(_found(store, viewer, job), where, sort, names)
    return _answered(request, store, table, ("table", job, where, sort, names), page_size, page_token)


@router.get("/pareto", response_model=TablePage, dependencies=READ, responses=TABLE)
def get_job_pareto(
    job: str,
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    where: Where = "",
    sort: Sort = "",
    columns: Names = "",
    page_size: PageSize = 50,
    page_token: Token = None,
) -> Response:
    """The rows of a sweep that no other row beats in all columns of its `pareto`."""
    names = [name.strip() for name in columns.split(",") if name.strip()]
    table = tables.chosen(tables.pareto(_found(store, viewer, job)), where, sort, names)
    return _answered(request, store, table, ("pareto", job, where, sort, names), page_size, page_token)


@router.get("/table/columns/{column}", response_model=ColumnView, dependencies=READ)
def get_job_column(
    job: str,
    column: str,
    store: StoreOf,
    viewer: ViewerOf,
    where: Where = "",
    bins: Annotated[int, Query(ge=1, le=1000)] = 20,
) -> Response:
    """Mean, deviation, quantiles and histogram of a column."""
    table = tables.chosen(_found(store, viewer, job), where, "", [])
    return response_of(json_answer(dump(tables.distribution(table, column, bins)), headers=FRESH))


@router.post(
    "/rows/{row}/tree",
    status_code=201,
    response_model=TreeView,
    dependencies=[needs("write")],
    openapi_extra=body_of("RowTree", False),
    responses=made(TreeView),
)
@timed("derive")
def store_job_row(job: str, row: int, body: OptionalJsonBody, store: StoreOf, act: ActOf) -> Response:
    """Store the tree of a row, coupled and verified as any other."""
    given = read_model(RowTree, body)
    document = tables.tree_of(_found(store, act.viewer, job), row)
    document = {**document, "name": given.name or document["name"]}
    entry = Entry(visibility=given.visibility)
    prepared = revision(act, lambda: trees.prepare(store, act.viewer, act.worker, document, entry))
    return act.run(prepared, deferred(act, "assemble", {**document, **entry.model_dump(exclude_none=True)}))
