"""Results of items by key, and their files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sqlalchemy import Connection, delete, select

from service.content.integrity import checked, digest_of
from service.database.job_tables import job_items, jobs, result_files, results
from service.queries.common import now, put_all


@dataclass(frozen=True, slots=True)
class File:
    """A file of a result."""

    key: str
    name: str
    size: int


@dataclass(frozen=True, slots=True)
class Result:
    """What came of an item; ``summary`` is JSON. One that is not good is of an item that failed."""

    key: str
    kind: str
    summary: str
    files: Mapping[str, bytes]
    principal: str = ""
    is_good: bool = True

    @property
    def size(self) -> int:
        """Bytes of summary and files."""
        return len(self.summary.encode()) + sum(map(len, self.files.values()))


def put_results(connection: Connection, found: Sequence[Result]) -> None:
    """Keep results; of equal ones the first stays, unless it is of an item that failed."""
    created = now()
    bad = results.c.key.in_([each.key for each in found]) & ~results.c.is_good
    if keys := list(connection.execute(select(results.c.key).where(bad)).scalars()):
        for table in (result_files, results):
            connection.execute(delete(table).where(table.c.key.in_(keys)))
    put_all(connection, results, [{**_row(each), "created": created} for each in found])
    files = [
        {"key": each.key, "name": name, "size": len(data), "content": data, "digest": digest_of(data)}
        for each in found
        for name, data in each.files.items()
    ]
    put_all(connection, result_files, files)


def _row(result: Result) -> dict[str, str | int]:
    told: dict[str, str | int] = {"key": result.key, "kind": result.kind, "summary": result.summary}
    told |= {"principal": result.principal, "size": result.size, "is_good": result.is_good}
    return told | {"digest": digest_of(result.summary.encode())}


def list_files(connection: Connection, keys: list[str]) -> dict[str, list[File]]:
    """The files of results, by key."""
    found: dict[str, list[File]] = {}
    for start in range(0, len(keys), 500):
        chosen = result_files.c.key.in_(keys[start : start + 500])
        columns = select(result_files.c.key, result_files.c.name, result_files.c.size)
        for row in connection.execute(columns.where(chosen).order_by(result_files.c.name)):
            found.setdefault(row.key, []).append(File(*row))
    return found


def get_file(connection: Connection, key: str, name: str) -> bytes | None:
    """The content of one file. Raises Refused (``damaged-content``)."""
    chosen = (result_files.c.key == key) & (result_files.c.name == name)
    row = connection.execute(select(result_files.c.content, result_files.c.digest).where(chosen)).first()
    return None if row is None else as_kept(f"the file {name} of a result", row.digest, row.content)


def get_summary(connection: Connection, key: str) -> str | None:
    """The summary of a result. Raises Refused (``damaged-content``)."""
    row = connection.execute(select(results.c.summary, results.c.digest).where(results.c.key == key)).first()
    return None if row is None else as_kept("a result", row.digest, row.summary.encode()).decode()


def as_kept(what: str, digest: str, content: bytes) -> bytes:
    """The content, which has its digest unless it is of an older store. Raises Refused (``damaged-content``)."""
    return checked(what, digest, content) if digest else content


def all_keys(connection: Connection) -> list[str]:
    """The keys of all results."""
    return list(connection.execute(select(results.c.key).order_by(results.c.key)).scalars())


def job_of(connection: Connection, principal: str, key: str) -> str | None:
    """The latest job of a principal of the one item of this key, unless it has failed or is cancelled."""
    is_its = (job_items.c.key == key) & (jobs.c.total == 1)
    is_of_use = (jobs.c.principal == principal) & jobs.c.state.in_(("queued", "running", "succeeded"))
    query = select(jobs.c.id).join(job_items, job_items.c.job == jobs.c.id).where(is_its, is_of_use)
    return connection.execute(query.order_by(jobs.c.id.desc()).limit(1)).scalar_one_or_none()


def first_item(connection: Connection, job: str) -> str:
    """The first item of a job, JSON."""
    query = select(job_items.c.item).where(job_items.c.job == job).order_by(job_items.c.position).limit(1)
    return str(connection.execute(query).scalar_one())
