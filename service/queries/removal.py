"""Removing what nobody looks at any more."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy import Connection, delete, exists, select

from service.database.job_tables import job_events, job_items, job_uploads, jobs, result_files, results
from service.queries.jobs import uploads
from service.queries.jobs.jobs import share_results


def remove_finished(connection: Connection, before: str, most: int) -> int:
    """Remove up to ``most`` jobs that finished before a time, with results that no other item has."""
    share_results(connection, exclusive=True)
    old = select(jobs.c.id).where(jobs.c.finished < before).order_by(jobs.c.finished).limit(most)
    ids = list(connection.execute(old).scalars())
    if ids:
        _remove(connection, ids)
    return len(ids)


def remove_job(connection: Connection, job: str, principal: str) -> None:
    """Remove a job that has ended, with results that no other item has and states that were uploaded for it alone."""
    share_results(connection, exclusive=True)
    sent = uploads.of_job(connection, job)
    _remove(connection, [job])
    uploads.remove(connection, sent, principal)


def _remove(connection: Connection, ids: Sequence[str]) -> None:
    keys = list(connection.execute(select(job_items.c.key).where(job_items.c.job.in_(ids)).distinct()).scalars())
    for table in (job_events, job_uploads, job_items):
        connection.execute(delete(table).where(table.c.job.in_(ids)))
    connection.execute(delete(jobs).where(jobs.c.id.in_(ids)))
    for table, column in ((result_files, result_files.c.key), (results, results.c.key)):
        is_shared = exists().where(job_items.c.key == column)
        for start in range(0, len(keys), 500):
            connection.execute(delete(table).where(column.in_(keys[start : start + 500]), ~is_shared))
