"""Content by digest: programs, parts and their formulas. Immutable; inserting twice changes nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Connection, delete, insert, select, update

from service.database.packed import unpack
from service.database.tables import formulas, parts, programs, tags
from service.integrity import checked, missing, reading
from service.queries.common import insert_missing, now
from service.queries.uploads import get_upload


@dataclass(frozen=True, slots=True)
class StoredPart:
    """What is needed to decode a part: definition and certificate are JSON, the program canonical bytes."""

    definition: bytes
    program: bytes
    certificate: bytes


@dataclass(frozen=True, slots=True)
class FormulaRow:
    """One stored formula; ``shape`` and ``entry`` (its leading index within the output) are JSON."""

    position: int
    quantity: str
    body: str | None
    coordinate: str | None
    shape: str
    symmetry: str
    operations: int
    output: str
    entry: str


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


def put_part(
    connection: Connection, row: Mapping[str, Any], tag_names: Sequence[str], formula_rows: Sequence[FormulaRow]
) -> None:
    """Store a part whose program is stored already, with its tags and formulas, unless it is there."""
    if not insert_missing(connection, parts, [{**row, "created": now()}]):
        return
    digest = row["digest"]
    insert_missing(connection, tags, [{"part": digest, "tag": tag} for tag in tag_names])
    if formula_rows:
        names = FormulaRow.__slots__
        values = [{"part": digest, **{name: getattr(formula, name) for name in names}} for formula in formula_rows]
        connection.execute(insert(formulas), values)


def replace_part(
    connection: Connection,
    row: Mapping[str, Any],
    program: bytes,
    nodes: int,
    formula_rows: Sequence[FormulaRow],
) -> None:
    """Put a part that was derived anew in the place of what is stored under its digest, with its packed program."""
    digest = row["digest"]
    replace_program(connection, row["program"], program, nodes)
    connection.execute(update(parts).where(parts.c.digest == digest).values(**row))
    connection.execute(delete(formulas).where(formulas.c.part == digest))
    if formula_rows:
        names = FormulaRow.__slots__
        values = [{"part": digest, **{name: getattr(formula, name) for name in names}} for formula in formula_rows]
        connection.execute(insert(formulas), values)


def replace_program(connection: Connection, digest: str, content: bytes, nodes: int) -> None:
    """Store a packed program in the place of what is there."""
    put_program(connection, digest, content, nodes)
    connection.execute(update(programs).where(programs.c.digest == digest).values(content=content, nodes=nodes))


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


def list_formulas(
    connection: Connection,
    part: str,
    quantities: Sequence[str] = (),
    body: str | None = None,
    coordinate: str | None = None,
) -> list[FormulaRow]:
    """The stored formulas of a part in their order: all, or those of these quantities, body and coordinate."""
    wanted = {"body": body, "coordinate": coordinate}
    query = select(*(formulas.c[name] for name in FormulaRow.__slots__)).where(formulas.c.part == part)
    if quantities:
        query = query.where(formulas.c.quantity.in_(quantities))
    for name, value in wanted.items():
        if value is not None:
            query = query.where(formulas.c[name] == value)
    return [FormulaRow(*row) for row in connection.execute(query.order_by(formulas.c.position))]
