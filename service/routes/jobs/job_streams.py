"""``/v1/jobs/{job}/events`` and ``/archive``: what happens, as it happens, and all files in one."""

from __future__ import annotations

import zipfile
from collections.abc import AsyncIterator, Iterator
from time import monotonic
from typing import Annotated, Any

from fastapi import Header, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import StreamingResponse
from starlette.types import Receive, Scope, Send

from service.http.requests import StoreOf, ViewerOf, needs
from service.messages.answers import Sink
from service.operations.jobs import jobs
from service.queries import content
from service.queries.jobs import job_events, results
from service.queries.jobs import jobs as rows
from service.routes.bodies import APIRouter, binary
from service.store.store import Store
from service.views.jobs import event_text, file_name, item_view
from service.views.resources import dump
from substructures.documents import read_json

EVENTS, ITEMS = 500, 100  # of one read
HEARTBEAT = 15.0  # seconds
EVENT = {
    "description": "one event; its data are JSON",
    "type": "object",
    "properties": {name: {"type": "string"} for name in ("id", "event", "data")},
}
STREAM: dict[int | str, Any] = {
    200: {"description": "Server-sent events", "content": {"text/event-stream": {"schema": EVENT}}}
}
ZIP: dict[int | str, Any] = {200: {"description": "A zip file", "content": {"application/zip": binary()}}}

router = APIRouter(prefix="/v1/jobs/{job}", tags=["jobs"], dependencies=[needs("read")])


@router.get("/events", response_class=Response, responses=STREAM)
def stream_job_events(
    job: str,
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    last_event_id: Annotated[str | None, Header(max_length=20, description="resume behind this event")] = None,
) -> Response:
    """What happened and happens: changes of state, and positions of items that changed. Ends with the job, or with
    the server: then the client asks again, with ``Last-Event-ID``."""
    with store.database.read() as connection:
        jobs.find(connection, viewer, job)
    seq = int(last_event_id) if last_event_id and last_event_id.isascii() and last_event_id.isdigit() else 0
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    limits, principal = store.settings.limits_of_process, request.state.principal
    store.feed.enter(principal, limits.event_streams_per_key, limits.event_streams)
    return _EventStream(store, principal, _events(store, job, min(seq, 2**31 - 1)), headers)


class _EventStream(StreamingResponse):
    """Gives its place among the streams back when it ends, however it ends."""

    def __init__(self, store: Store, principal: str, content: AsyncIterator[bytes], headers: dict[str, str]) -> None:
        super().__init__(content, media_type="text/event-stream", headers=headers)
        self._store, self._principal = store, principal

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send all there is and will be."""
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._store.feed.leave(self._principal)


async def _events(store: Store, job: str, seq: int) -> AsyncIterator[bytes]:
    said = monotonic()
    with store.feed.watching(job, seq) as watcher:
        while not store.runtime.stopping.is_set():
            found, is_final = await run_in_threadpool(_read, store, job, watcher.seq)
            for event in found:
                yield event_text(event)
                watcher.seq = event.seq
            if found:
                said = monotonic()
            elif is_final:
                return
            elif monotonic() - said >= HEARTBEAT:
                yield b": still here\n\n"
                said = monotonic()
            if len(found) < EVENTS and not is_final:
                await watcher.wait(HEARTBEAT)


def _read(store: Store, job: str, seq: int) -> tuple[list[job_events.JobEvent], bool]:
    with store.database.read() as connection:
        found = rows.get_job(connection, job)
        return job_events.events_after(connection, job, seq, EVENTS), found is None or found.is_final


@router.get("/archive", response_class=Response, responses=ZIP)
def get_job_archive(job: str, store: StoreOf, viewer: ViewerOf) -> Response:
    """Everything there is so far as a zip file: ``<position>/item.json`` and the files of the item beside it with
    the endings of their formats; the formulas of trees and parts that were stored once for all that share them,
    ``programs/<digest>.json`` by the ``program`` of items."""
    with store.database.read() as connection:
        jobs.find(connection, viewer, job)
    headers = {"Content-Disposition": f'attachment; filename="{job}.zip"', "Cache-Control": "no-store"}
    return StreamingResponse(_archive(store, job), media_type="application/zip", headers=headers)


def _archive(store: Store, job: str) -> Iterator[bytes]:
    sink = Sink()
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as packed:
        for name, data in _members(store, job):
            packed.writestr(name, data)
            yield sink.taken()
    yield sink.taken()


def _members(store: Store, job: str) -> Iterator[tuple[str, bytes]]:
    after, told = -1, set[str]()
    while True:
        with store.database.read() as connection:
            if rows.get_job(connection, job) is None:
                raise _Removed(job)
            items = rows.page_items(connection, job, None, after, ITEMS)
            files = results.list_files(connection, [item.key for item in items if item.summary is not None])
        for item in items:
            if item.finished is None:
                continue
            there = files.get(item.key, []) if item.summary is not None else []
            yield f"{item.position}/item.json", dump(item_view(job, item, there))
            stored = read_json(item.summary.encode()).get("program") if item.summary is not None else None
            if isinstance(stored, str) and stored not in told:
                told.add(stored)
                with store.database.read() as connection:
                    formulas = content.get_program(connection, stored)
                if formulas is not None:
                    yield f"programs/{stored.removeprefix('sha256:')}.json", formulas
            for file in there:
                with store.database.read() as connection:
                    data = results.get_file(connection, file.key, file.name)
                if data is None:
                    raise _Removed(job)
                yield f"{item.position}/{file_name(item, file.name)}", data
        if len(items) < ITEMS:
            return
        after = items[-1].position


class _Removed(Exception):
    """A job was removed while its files were sent: what was sent is to be no whole archive."""
