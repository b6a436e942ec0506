"""Results of items by key, and their files.

One that has the seal of this server is that of every equal item. Another one is computed anew where it is asked for; it
is read by those who have it if an older version kept it, without a seal, and refused if its seal is of somebody else.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Connection, bindparam, delete, select, update

from service.content.integrity import NOT_SEALED, checked, damaged, digest_of
from service.database.job_tables import job_items, jobs, result_files, results
from service.queries.common import now, put_all
from service.queries.seals import RESULT, seal_of_result

REMEDY = "restore a backup, or, after 'substructures verify --repair', submit its job again, which computes it anew"
TOGETHER = 500  # keys of one statement


@dataclass(frozen=True, slots=True)
class File:
    """A file of a result."""

    key: str
    name: str
    size: int


@dataclass(frozen=True, slots=True)
class Result:
    """What came of an item; ``summary`` is JSON. One that is not good is of an item that failed; ``is_of_key``: whether
    the key is that of what was computed, by the software that did.
    """

    key: str
    kind: str
    summary: str
    files: Mapping[str, bytes]
    principal: str = ""
    is_good: bool = True
    is_of_key: bool = True

    @property
    def size(self) -> int:
        """Bytes of summary and files."""
        return len(self.summary.encode()) + sum(map(len, self.files.values()))


def put_results(connection: Connection, found: Sequence[Result]) -> None:
    """Keep results under seals; of equal ones the first stays, unless it is of an item that failed, or a good one takes
    the place of one without this server's seal.
    """
    stay = _beside(connection, {each.key: each.is_good for each in found})
    rows, files = list[dict[str, Any]](), list[dict[str, Any]]()
    for each in found:
        if each.key not in stay:
            row, its = {**_row(each), "created": now()}, _files(each)
            seal = seal_of_result(connection, row, {file["name"]: file["digest"] for file in its})
            rows.append({**row, "seal": seal if each.is_of_key else ""})
            files += its
    put_all(connection, results, rows)
    put_all(connection, result_files, files)


def _beside(connection: Connection, new: Mapping[str, bool]) -> set[str]:
    """Which results stay; others make room. ``new``: keys, and whether the new results are good."""
    there = connection.execute(select(results.c.key, results.c.is_good).where(results.c.key.in_(list(new)))).all()
    ours = vouched(connection, [row.key for row in there])
    stay = {row.key for row in there if row.is_good and (row.key in ours or not new[row.key])}
    gone = [row.key for row in there if row.key not in stay]
    for table in (result_files, results) if gone else ():
        connection.execute(delete(table).where(table.c.key.in_(gone)))
    return stay


def _row(result: Result) -> dict[str, Any]:
    told: dict[str, Any] = {"key": result.key, "kind": result.kind, "summary": result.summary}
    told |= {"principal": result.principal, "size": result.size, "is_good": result.is_good}
    return told | {"digest": digest_of(result.summary.encode())}


def _files(result: Result) -> list[dict[str, Any]]:
    return [
        {"key": result.key, "name": name, "size": len(data), "content": data, "digest": digest_of(data)}
        for name, data in result.files.items()
    ]


def _sealed(connection: Connection, keys: Iterable[str]) -> dict[str, tuple[Any, str]]:
    """The rows of results, each with the seal that it has to have."""
    wanted = list(keys)
    found: dict[str, tuple[Any, dict[str, str]]] = {}
    for start in range(0, len(wanted), TOGETHER):
        for row in connection.execute(_WITH_FILES, {"keys": wanted[start : start + TOGETHER]}):
            _, files = found.setdefault(row.key, (row, {}))
            if row.file is not None:
                files[row.file] = row.file_digest
    return {key: (row, seal_of_result(connection, row._mapping, files)) for key, (row, files) in found.items()}


def vouched(connection: Connection, keys: Iterable[str]) -> set[str]:
    """Those of the keys whose results are good and have the seal of this server: equal items need not be computed."""
    found = _sealed(connection, keys)
    return {
        key
        for key, (row, right) in found.items()
        if row.is_good and row.seal == right and digest_of(str(row.summary).encode()) == row.digest
    }


def are_ours(connection: Connection, keys: Iterable[str]) -> dict[str, bool]:
    """Of each of the results whether it has the seal of this server, or none. Raises Refused (``damaged-content``) for
    one of somebody else.
    """
    found = _sealed(connection, keys)
    for row, right in found.values():
        if row.seal not in ("", right):
            raise damaged("a result", row.digest or row.key, NOT_SEALED, REMEDY)
    return {key: row.seal == right for key, (row, right) in found.items()}


def unseal(connection: Connection, key: str) -> None:
    """Let a result be computed anew where an equal item is submitted; one without the seal of this server is anyway."""
    if key in vouched(connection, [key]):
        connection.execute(update(results).where(results.c.key == key).values(seal=""))


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
    are_ours(connection, [key])
    chosen = (result_files.c.key == key) & (result_files.c.name == name)
    row = connection.execute(select(result_files.c.content, result_files.c.digest).where(chosen)).first()
    return None if row is None else as_kept(f"the file {name} of a result", row.digest, row.content)


def get_summary(connection: Connection, key: str) -> str | None:
    """The summary of a result. Raises Refused (``damaged-content``)."""
    are_ours(connection, [key])
    row = connection.execute(select(results.c.summary, results.c.digest).where(results.c.key == key)).first()
    return None if row is None else as_kept("a result", row.digest, row.summary.encode()).decode()


def as_kept(what: str, digest: str, content: bytes) -> bytes:
    """The content, which has its digest unless it is of an older store. Raises Refused (``damaged-content``)."""
    return checked(what, digest, content, REMEDY) if digest else content


def all_keys(connection: Connection) -> list[str]:
    """The keys of all results."""
    return list(connection.execute(select(results.c.key).order_by(results.c.key)).scalars())


def job_of(connection: Connection, principal: str, key: str) -> str | None:
    """The latest job of a principal of the one item of this key, unless it has failed, is cancelled, or has a result
    that would be computed anew.
    """
    is_its = (job_items.c.key == key) & (jobs.c.total == 1)
    is_of_use = (jobs.c.principal == principal) & jobs.c.state.in_(("queued", "running", "succeeded"))
    query = select(jobs.c.id, jobs.c.state).join(job_items, job_items.c.job == jobs.c.id).where(is_its, is_of_use)
    found = connection.execute(query.order_by(jobs.c.id.desc()).limit(1)).first()
    if found is None or (found.state == "succeeded" and not vouched(connection, [key])):
        return None
    return str(found.id)


def first_item(connection: Connection, job: str) -> str:
    """The first item of a job, JSON."""
    query = select(job_items.c.item).where(job_items.c.job == job).order_by(job_items.c.position).limit(1)
    return str(connection.execute(query).scalar_one())


# Built once: to build a statement takes longer than to execute it.
_WITH_FILES = (
    select(
        *(results.c[name] for name in (*RESULT, "summary", "seal")),
        result_files.c.name.label("file"),
        result_files.c.digest.label("file_digest"),
    )
    .join(result_files, result_files.c.key == results.c.key, isouter=True)
    .where(results.c.key.in_(bindparam("keys", expanding=True)))
)
