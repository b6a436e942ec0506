"""JSON of jobs. Stored JSON is spliced in as it is."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath
from typing import Any

import orjson

from service.messages.addresses import BASE
from service.operations.jobs.progress import Progress
from service.operations.jobs.submission import Skipped
from service.queries.jobs.job_events import JobEvent
from service.queries.jobs.jobs import Job, JobItem
from service.queries.jobs.results import File
from substructures.export.render import LANGUAGES

BINARY = "application/octet-stream"
SHOWN = 6  # parts of a tree
MEDIA_TYPES = {"certificate": "application/json", "result": "application/x-npz", "text": "text/plain; charset=utf-8"}
MEDIA_TYPES |= {"archive": "application/zip"}
#: endings of files by their media types
ENDINGS = {
    "application/json": ".json",
    "application/x-npz": ".npz",
    "application/vnd.apache.arrow.stream": ".arrow",
    "application/zip": ".zip",
    "text/csv": ".csv",
    "image/svg+xml": ".svg",
    "text/plain": ".txt",
    "application/x-latex": ".tex",
    "application/xhtml+xml": ".xhtml",
    **{language.media.partition(";")[0]: language.suffix for language in LANGUAGES.values()},
}


def job_path(identifier: str) -> str:
    """The address of a job."""
    return f"{BASE}/jobs/{identifier}"


def job_view(job: Job, progress: Progress) -> dict[str, Any]:
    """A job (HTTP contract, section 5)."""
    path = job_path(job.id)
    return {
        "id": job.id,
        "kind": job.kind,
        "label": job.label,
        "retry_of": job.retry_of,
        "state": job.state,
        "progress": {
            "done": job.done,
            "failed": job.failed,
            "skipped": job.skipped,
            "total": job.total,
            "fraction": round(progress.fraction, 6),
            "rate": progress.rate,
            "eta_seconds": progress.eta_seconds,
        },
        "attempts": job.attempts,
        "principal": job.principal,
        "owner": job.owner,
        "shared": bool(job.shared),
        "created": job.created,
        "started": job.started,
        "finished": job.finished,
        "error": None if job.error is None else orjson.Fragment(job.error),
        "result": f"{path}/result",
        "links": {"self": path}
        | {name: f"{path}/{name}" for name in ("items", "events", "archive", "cancel", "retry")},
    }


def skipped_view(skipped: Skipped) -> dict[str, Any]:
    """An item of a submission that was left out."""
    errors = [{"pointer": f.pointer, "code": f.code, "message": f.message} for f in skipped.faults]
    return {"item": skipped.item, "errors": errors}


def item_view(job: str, item: JobItem, files: Sequence[File]) -> dict[str, Any]:
    """An item with its result or its problem."""
    return {
        "position": item.position,
        "subject": subject(item),
        "state": item.state,
        "attempts": item.attempts,
        "deaths": orjson.Fragment(item.deaths),
        "fraction": item.fraction,
        "key": item.key,
        "started": item.started,
        "finished": item.finished,
        "problem": None if item.problem is None else orjson.Fragment(item.problem),
        "result": None if item.summary is None else orjson.Fragment(item.summary),
        "computed_here": item.computed_here,
        "files": [_file(job, item, file) for file in files],
    }


def subject(item: JobItem) -> str | None:
    """What an item that failed is about: its tree with the parts that were chosen, its part, its source."""
    if item.item is None:
        return None
    about = orjson.loads(item.item)
    given = about.get("definition") or about.get("tree") or about.get("substructure") or about.get("source")
    if not isinstance(given, dict):
        return None if given is None else str(given).partition("@")[0]
    parts = [each.get("substructure", "").partition("@")[0] for each in given.get("instances", ())]
    return f"{given['name']} ({', '.join(parts[:SHOWN])})" if any(parts) else str(given["name"])


def _file(job: str, item: JobItem, file: File) -> dict[str, Any]:
    return {
        "name": file.name,
        "size": file.size,
        "media_type": media_type(item, file.name),
        "href": f"{job_path(job)}/items/{item.position}/files/{file.name}",
    }


def media_type(item: JobItem, name: str) -> str:
    """The media type of a file: what the item says of itself, or what is usual for the name."""
    said = orjson.loads(item.summary or "{}").get("media_type")
    return str(said) if said and name in ("result", "text") else MEDIA_TYPES.get(name, BINARY)


def file_name(item: JobItem, name: str) -> str:
    """What a file is called where it stands alone: with the ending of its target, or of its media type."""
    target = str(orjson.loads(item.summary or "{}").get("name", ""))
    return name + (PurePath(target).suffix or ENDINGS.get(media_type(item, name).partition(";")[0], ""))


def event_text(event: JobEvent) -> bytes:
    """A server-sent event; its id is where a reader resumes."""
    data = f'{{"time":"{event.time}",{event.data.strip()[1:]}'
    return f"id: {event.seq}\nevent: {event.type}\ndata: {data}\n\n".encode()
