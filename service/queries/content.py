"""Content by digest: programs and parts. Immutable; inserting twice changes nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Connection, bindparam, select, update

from service.database.packed import unpack
from service.database.tables import parts, programs
from service.integrity import checked, missing, reading
from service.queries.common import insert_missing, now
from service.queries.formulas import FormulaRow, packed
from service.queries.uploads import get_upload


@dataclass(frozen=True, slots=True)
class StoredPart:
    """What is needed to decode a part: definition and certificate are JSON, the program canonical bytes."""

    definition: bytes
    program: bytes
    certificate: bytes


def put_program(connection: Connection, digest: str, content: bytes, nodes: int) -> None:
    """Store a packed program."""
    row = {"digest": digest, "content": content, "nodes": nodes, "created": now()}
    insert_missing(connection, programs, [row])


def get_program(connection: Connection, digest: str) -> bytes | None:
    """A program's canonical bytes. Raises Refused (``damaged-content``)."""
    content = connection.execute(select(programs.c.content).where(programs.c.digest == digest)).scalar()
    return None if content is None else _unpacked(digest, content)


def _unpacked(digest: str, content: bytes) -> bytes:
    with reading("a program", digest):
        return checked("a program", digest, unpack(content))


def put_part(connection: Connection, row: Mapping[str, Any], formula_rows: Sequence[FormulaRow]) -> None:
    """Store a part whose program is stored already, with its formulas, unless it is there."""
    insert_missing(connection, parts, [{**row, **packed(formula_rows), "created": now()}])


def replace_part(
    connection: Connection,
    row: Mapping[str, Any],
    program: bytes,
    nodes: int,
    formula_rows: Sequence[FormulaRow],
) -> None:
    """Put a part that was derived anew in the place of what is stored under its digest, with its packed program."""
    replace_program(connection, row["program"], program, nodes)
    chosen = update(parts).where(parts.c.digest == row["digest"])
    connection.execute(chosen.values(**row, **packed(formula_rows)))


def replace_program(connection: Connection, digest: str, content: bytes, nodes: int) -> None:
    """Store a packed program in the place of what is there."""
    put_program(connection, digest, content, nodes)
    connection.execute(update(programs).where(programs.c.digest == digest).values(content=content, nodes=nodes))


def program_of(connection: Connection, digest: str) -> str | None:
    """The digest of the program of a part; None when it is not stored."""
    return connection.execute(_PROGRAM_OF, {"digest": digest}).scalar()


def has_part(connection: Connection, digest: str) -> bool:
    """Whether a part is stored."""
    return connection.execute(select(parts.c.digest).where(parts.c.digest == digest)).first() is not None


def get_part(connection: Connection, digest: str) -> StoredPart | None:
    """A part, ready to be decoded. Raises Refused (``damaged-content``, ``missing-content``)."""
    columns = select(parts.c.definition, parts.c.program, programs.c.content, parts.c.certificate)
    joined = columns.join(programs, programs.c.digest == parts.c.program, isouter=True)
    row = connection.execute(joined.where(parts.c.digest == digest)).first()
    if row is None:
        return None
    if row.content is None:
        raise missing("a program", row.program)
    definition = checked("a definition", digest, row.definition.encode())
    return StoredPart(definition, _unpacked(row.program, row.content), row.certificate.encode())


def get_row(connection: Connection, digest: str) -> Mapping[str, Any]:
    """All columns of a part, as they are stored. Raises NoResultFound."""
    return dict(connection.execute(select(parts).where(parts.c.digest == digest)).mappings().one())


def get_definition(connection: Connection, digest: str) -> bytes | None:
    """The definition of a part as stored. Raises Refused (``damaged-content``)."""
    text = connection.execute(select(parts.c.definition).where(parts.c.digest == digest)).scalar()
    return None if text is None else checked("a definition", digest, text.encode())


def get_blob(connection: Connection, digest: str) -> bytes | None:
    """The definition, the program or the uploaded states with this digest. Raises Refused (``damaged-content``)."""
    found = get_definition(connection, digest) or get_program(connection, digest)
    if found is None:
        found = get_upload(connection, digest)
        return None if found is None else checked("uploaded states", digest, found)
    return found


# Built once: to build a statement takes longer than to execute it.
_PROGRAM_OF = select(parts.c.program).where(parts.c.digest == bindparam("digest"))
