"""Chunks of states that are uploaded for jobs, by digest. One that no job refers to is kept for a while: its job may
be about to be queued, or the same states be sent again.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from sqlalchemy import Connection, delete, exists, insert, select, update

from service.database.job_tables import job_uploads, uploads
from service.queries.common import now, put_all


def put_uploads(connection: Connection, contents: Mapping[str, bytes], principal: str = "") -> None:
    """Store contents of a principal by digest; of those that are there the age begins anew."""
    touched = now()
    for digest in sorted(contents):  # in one order, so that two uploads of the same do not wait for each other
        known = update(uploads).where(uploads.c.digest == digest).values(touched=touched)
        if not connection.execute(known).rowcount:
            content = contents[digest]
            row = {"digest": digest, "content": content, "touched": touched, "principal": principal}
            put_all(connection, uploads, [{**row, "size": len(content)}])


def get_upload(connection: Connection, digest: str) -> bytes | None:
    """The content of a chunk."""
    return connection.execute(select(uploads.c.content).where(uploads.c.digest == digest)).scalar()


def refer(connection: Connection, job: str, digests: Iterable[str]) -> None:
    """Note that a job needs chunks, which are stored."""
    rows = [{"job": job, "digest": digest} for digest in dict.fromkeys(digests)]
    if rows:
        connection.execute(insert(job_uploads), rows)


def of_job(connection: Connection, job: str) -> list[str]:
    """The digests of the chunks that a job needs."""
    return list(connection.execute(select(job_uploads.c.digest).where(job_uploads.c.job == job)).scalars())


def remove(connection: Connection, digests: Iterable[str], principal: str) -> None:
    """Remove those of some chunks that a principal uploaded and that no job refers to."""
    unused = (uploads.c.principal == principal) & ~exists().where(job_uploads.c.digest == uploads.c.digest)
    connection.execute(delete(uploads).where(uploads.c.digest.in_(list(digests)), unused))


def remove_unused(connection: Connection, before: str, most: int) -> int:
    """Remove up to ``most`` chunks that no job refers to and that were uploaded before a time: how many."""
    unused = (uploads.c.touched < before) & ~exists().where(job_uploads.c.digest == uploads.c.digest)
    some = select(uploads.c.digest).where(unused).limit(most).with_for_update(skip_locked=True)
    digests = list(connection.execute(some).scalars())
    return connection.execute(delete(uploads).where(uploads.c.digest.in_(digests))).rowcount if digests else 0
