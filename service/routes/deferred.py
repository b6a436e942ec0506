"""Requests that become jobs: what takes too long, and what is asked for with ``Prefer: respond-async``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from service.database.connections import Connection
from service.http.acting import Act, Commit
from service.messages.answers import Answer, json_answer
from service.messages.viewer import Viewer
from service.operations.jobs import jobs
from service.operations.jobs.progress import progress
from service.operations.jobs.submission import JobSubmission, Skipped
from service.queries.jobs import results
from service.queries.jobs.jobs import Job
from service.schemas.jobs import JobView
from service.store.store import Store
from service.views.jobs import job_path, job_view, skipped_view
from service.views.resources import dump

FRESH = {"Cache-Control": "no-store"}
#: ``responses`` of an endpoint that may answer with a job
ACCEPTED: dict[int | str, dict[str, Any]] = {202: {"description": "It became a job", "model": JobView}}


def made(model: type[BaseModel]) -> dict[int | str, dict[str, Any]]:
    """``responses`` of an endpoint that makes something, unless it is there already."""
    return {200: {"description": "It is there already", "model": model}, **ACCEPTED}


def answer(connection: Connection, job: Job, status: int = 200, skipped: Sequence[Skipped] = ()) -> Answer:
    """A job with its progress; ``skipped``: items of the submission that were left out."""
    view = job_view(job, progress(connection, job))
    if skipped:
        view["skipped"] = [skipped_view(each) for each in skipped]
    headers = {**FRESH, "Location": job_path(job.id)} if status == 202 else FRESH
    return json_answer(dump(view), status, headers)


def committed(store: Store, viewer: Viewer, submission: JobSubmission, is_asked: bool = False) -> Commit:
    """What queues a submission and answers 202; ``is_asked``: by a GET, which becomes no other job than it has become
    already."""

    def commit(connection: Connection) -> Answer:
        """Queue the job and answer it, unless there is no room for results."""
        known = results.job_of(connection, viewer.key, submission.items[0].key) if is_asked else None
        if known is not None:
            return answer(connection, jobs.find(connection, viewer, known), 202)
        store.usage.take(connection, "result", viewer.key, 0)
        return answer(
            connection, jobs.submit(connection, viewer, submission, store.settings.limits), 202, submission.skipped
        )

    return commit


def deferred(
    act: Act, kind: str, item: Any, step: str = "", members: Mapping[str, Any] | None = None
) -> Callable[[], Commit]:
    """What prepares the job that does what a request asks for; arguments as of ``jobs.prepare_one``.

    Raises Refused 403 when the API key may not submit jobs.
    """

    def prepare() -> Commit:
        """Check the item as a submission would."""
        act.require("jobs")
        submission = jobs.prepare_one(act.store, act.viewer, kind, item, step, members)
        return committed(act.store, act.viewer, submission)

    return prepare
