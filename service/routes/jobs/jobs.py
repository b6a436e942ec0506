"""``/v1/jobs``: submit, watch, cancel, and read results, also in part while a job runs."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

from fastapi import Query, Request, Response

from service.database.connections import Connection
from service.http.acting import ActOf, Commit
from service.http.requests import JsonBody, OptionalJsonBody, StoreOf, ViewerOf, needs
from service.http.responses import link_header, next_link, response_of
from service.messages.answers import Answer, json_answer
from service.messages.paging import limited, read_token, write_token
from service.messages.refusals import not_found
from service.operations.jobs import jobs
from service.operations.jobs.progress import progress
from service.queries.jobs import jobs as rows
from service.queries.jobs import results
from service.routes.bodies import APIRouter, binary, body_of
from service.routes.deferred import FRESH, answer, committed
from service.schemas.jobs import CancelRequest, ItemPage, ItemState, JobKind, JobPage, JobState, JobView, RetryRequest
from service.views.jobs import BINARY, item_view, job_view, media_type
from service.views.resources import dump
from substructures.documents import read_model

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])
MANY = 2**31  # more items than a job has, and what every database takes for a position
READ, JOBS = [needs("read")], [needs("jobs")]
PageSize = Annotated[int, Query(ge=1)]
Token = Annotated[str | None, Query(max_length=2000)]
FILES = ("application/x-npz", "application/vnd.apache.arrow.stream", BINARY)
TEXTS = ("text/csv", "image/svg+xml", "text/plain")
FILE: dict[int | str, Any] = {
    200: {
        "description": "The file, in the `media_type` that the item says",
        "content": {"application/json": {"schema": {}}}
        | {media: binary() for media in FILES}
        | {media: {"schema": {"type": "string"}} for media in TEXTS},
    }
}


@router.post("", status_code=202, response_model=JobView, dependencies=JOBS, openapi_extra=body_of("JobRequest"))
def submit_job(body: JsonBody, store: StoreOf, act: ActOf) -> Response:
    """Queue a job. 202 when it is on the disk; before that every item has been checked."""
    if isinstance(body, dict) and body.get("kind") in jobs.STORING:
        act.require("write")
    return act.submit(lambda: committed(store, act.viewer, jobs.prepare(store, act.viewer, body)))


@router.get("", response_model=JobPage, dependencies=READ)
def list_jobs(
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    state: JobState | None = None,
    kind: JobKind | None = None,
    label: Annotated[str | None, Query(max_length=200, description="the label, or a word of it: `study:night`")] = None,
    page_size: PageSize = 50,
    page_token: Token = None,
) -> Response:
    """A page of jobs, the newest first."""
    wanted = {"state": state, "kind": kind, "label": label}
    size, search = limited(page_size, store.settings.limits.page_size), ("jobs", state, kind, label)
    before = read_token(search, page_token, str)
    with store.database.read() as connection:
        found = rows.page_jobs(connection, viewer, wanted, before[0] if before else None, size + 1)
        items = [job_view(each, progress(connection, each)) for each in found[:size]]
    token = write_token(search, found[size - 1].id) if len(found) > size else None
    link = next_link(request, token)
    view = {"items": items, "next_page_token": token, "links": {"next": link}}
    return response_of(json_answer(dump(view), headers={**FRESH, **link_header(link)}))


@router.get("/{job}", response_model=JobView, dependencies=READ)
def get_job(job: str, store: StoreOf, viewer: ViewerOf) -> Response:
    """A job with its progress."""
    with store.database.read() as connection:
        return response_of(answer(connection, jobs.find(connection, viewer, job)))


@router.post("/{job}/cancel", response_model=JobView, dependencies=JOBS, openapi_extra=body_of("CancelRequest", False))
def cancel_job(job: str, body: OptionalJsonBody, store: StoreOf, act: ActOf) -> Response:
    """Cancel what is not finished; what runs is stopped within two seconds. Others' jobs need the scope admin."""
    read_model(CancelRequest, body)

    def commit(connection: Connection) -> Answer:
        """Cancel, if the job is one's own."""
        return answer(connection, jobs.cancel(connection, act.viewer, job))

    response = act.submit(lambda: commit)
    store.runtime.wake.set()
    return response


@router.post(
    "/{job}/retry",
    status_code=202,
    response_model=JobView,
    dependencies=JOBS,
    openapi_extra=body_of("RetryRequest", False),
)
def retry_job(job: str, body: OptionalJsonBody, store: StoreOf, act: ActOf) -> Response:
    """What of a job failed or was cancelled once more, as a job of its own."""
    label = read_model(RetryRequest, body).label

    def prepare() -> Commit:
        """Look what there is to be done."""
        with store.database.read() as connection:
            found = jobs.again(connection, act.viewer, job)
        return committed(store, act.viewer, found if label is None else replace(found, label=label))

    return act.submit(prepare)


@router.delete("/{job}", status_code=204, dependencies=JOBS)
def remove_job(job: str, store: StoreOf, viewer: ViewerOf) -> Response:
    """Remove a job that has ended, with its results and with the states that were uploaded for it alone."""
    with store.database.write() as connection:
        jobs.remove(connection, viewer, job)
    return Response(status_code=204)


@router.get("/{job}/items", response_model=ItemPage, dependencies=READ)
def list_job_items(
    job: str,
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    state: ItemState | None = None,
    page_size: PageSize = 50,
    page_token: Token = None,
) -> Response:
    """The items of a job with their states, results and problems."""
    size, search = limited(page_size, store.settings.limits.page_size), ("items", job, state)
    after = read_token(search, page_token, int)
    with store.database.read() as connection:
        jobs.find(connection, viewer, job)
        found = rows.page_items(connection, job, state, after[0] if after else -1, size + 1)
        files = results.list_files(connection, [item.key for item in found if item.summary is not None])
    views = [item_view(job, item, files.get(item.key, ()) if item.summary else ()) for item in found[:size]]
    token = write_token(search, found[size - 1].position) if len(found) > size else None
    link = next_link(request, token)
    view = {"items": views, "next_page_token": token, "links": {"next": link}}
    return response_of(json_answer(dump(view), headers={**FRESH, **link_header(link)}))


router.add_api_route(
    "/{job}/result",
    list_job_items,
    name="list_job_results",
    methods=["GET"],
    response_model=ItemPage,
    dependencies=READ,
    summary="The result of every item, or its problem; in part while the job runs",
)


@router.get("/{job}/items/{position}/files/{name}", dependencies=READ, response_class=Response, responses=FILE)
def get_job_file(job: str, position: int, name: str, store: StoreOf, viewer: ViewerOf) -> Response:
    """A file of a result."""
    with store.database.read() as connection:
        if not 0 <= position < MANY:
            jobs.find(connection, viewer, job)
            raise not_found(f"the job has no item {position}", "unknown-item")
        item = jobs.find_item(connection, viewer, job, position)
        content = results.get_file(connection, item.key, name) if item.summary is not None else None
    if content is None:
        raise not_found(f"item {position} has no file '{name[:80]}'", "unknown-file")
    return response_of(Answer(200, content, {"Content-Type": media_type(item, name)}))
