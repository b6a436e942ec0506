"""Content by digest: programs and parts. Immutable; inserting twice changes nothing."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Connection, bindparam, delete, exists, func, select, union_all, update

from service.content.derivation import software
from service.content.integrity import checked, missing, reading
from service.database.packed import unpack
from service.database.tables import parts, programs, summary_forms, trees
from service.queries.common import insert_missing, now
from service.queries.jobs.uploads import get_upload
from service.queries.seals import PART, seal_of_part
from service.queries.searching.formulas import FormulaRow, packed

AT_A_TIME = 500  # rows that are looked at


@dataclass(frozen=True, slots=True)
class StoredPart:
    """What is needed to decode a part: definition and certificate are JSON, the program canonical bytes.

    ``software``: that derived it; ``is_derived``: this server did, and stored it as it is.
    """

    definition: bytes
    program: bytes
    certificate: bytes
    recipe: str | None
    software: str
    is_derived: bool


def put_program(connection: Connection, digest: str, content: bytes, nodes: int) -> None:
    """Store a packed program."""
    row = {"digest": digest, "content": content, "nodes": nodes, "created": now()}
    insert_missing(connection, programs, [row])


def has_program(connection: Connection, digest: str) -> bool:
    """Whether a program is stored."""
    return connection.execute(_HAS_PROGRAM, {"digest": digest}).first() is not None


def stored_of(connection: Connection, digests: Collection[str]) -> list[str]:
    """Those of these digests that programs or forms of summaries are stored under."""
    if not digests:
        return []
    found = (select(table.c.digest).where(table.c.digest.in_(digests)) for table in (programs, summary_forms))
    return list(connection.execute(union_all(*found)).scalars())


def get_program(connection: Connection, digest: str) -> bytes | None:
    """A program's canonical bytes. Raises Refused (``damaged-content``)."""
    content = connection.execute(_PROGRAM, {"of_digest": digest}).scalar()
    return None if content is None else _unpacked(digest, content)


def _unpacked(digest: str, content: bytes) -> bytes:
    with reading("a program", digest):
        return checked("a program", digest, unpack(content))


def put_part(connection: Connection, row: Mapping[str, Any], formula_rows: Sequence[FormulaRow]) -> None:
    """Store a part that was derived here, and whose program is stored already, unless it is there."""
    insert_missing(connection, parts, [{**_sealed(connection, row, formula_rows), "created": now()}])


def _sealed(connection: Connection, row: Mapping[str, Any], formula_rows: Sequence[FormulaRow]) -> dict[str, Any]:
    """The row of a part with the index of its formulas, under the seal of this server."""
    mass = row["mass"]
    found = {"software": software(), **row, "mass": None if mass is None else float(mass), **packed(formula_rows)}
    return {**found, "seal": seal_of_part(connection, found)}


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
    connection.execute(chosen.values(**_sealed(connection, row, formula_rows)))


def replace_program(connection: Connection, digest: str, content: bytes, nodes: int) -> None:
    """Store a packed program in the place of what is there."""
    put_program(connection, digest, content, nodes)
    connection.execute(update(programs).where(programs.c.digest == digest).values(content=content, nodes=nodes))


def forget_program(connection: Connection, digest: str) -> None:
    """Remove a program that no part and no tree has any more, and that this server did not derive."""
    used = exists().where(parts.c.program == digest) | exists().where(trees.c.program == digest)
    connection.execute(delete(programs).where(programs.c.digest == digest, ~used))


def program_of(connection: Connection, digest: str) -> tuple[str | None, str]:
    """The digest of the program of a part, None when it is not stored, and the software that derived it."""
    found = connection.execute(_PROGRAM_OF, {"digest": digest}).first()
    return (None, "") if found is None else (found.program, found.software)


def get_part(connection: Connection, digest: str) -> StoredPart | None:
    """A part, ready to be decoded. Raises Refused (``damaged-content``, ``missing-content``)."""
    row = connection.execute(_STORED, {"of_digest": digest}).mappings().first()
    if row is None:
        return None
    if row["content"] is None:
        raise missing("a program", row["program"])
    definition = checked("a definition", digest, row["definition"].encode())
    program = _unpacked(row["program"], row["content"])
    told = row["recipe"], row["software"], row["seal"] == seal_of_part(connection, row)
    return StoredPart(definition, program, row["certificate"].encode(), *told)


def get_row(connection: Connection, digest: str) -> Mapping[str, Any]:
    """All columns of a part, as they are stored. Raises NoResultFound."""
    return dict(connection.execute(select(parts).where(parts.c.digest == digest)).mappings().one())


def get_recipe(connection: Connection, digest: str) -> str | None:
    """What a part that is a published tree was coupled of."""
    return connection.execute(_RECIPE, {"of_digest": digest}).scalar()


def stale_parts(connection: Connection) -> list[str]:
    """The digests of all parts that other software has derived, or that are not as this server stored them."""
    columns = select(*(parts.c[name] for name in PART), parts.c.seal).order_by(parts.c.digest).limit(AT_A_TIME)
    ours, last, found = software(), "", list[str]()
    while rows := connection.execute(columns.where(parts.c.digest > last)).mappings().all():
        last = rows[-1]["digest"]
        found += [
            row["digest"] for row in rows if row["software"] != ours or row["seal"] != seal_of_part(connection, row)
        ]
    return found


def count_parts(connection: Connection) -> tuple[int, int]:
    """How many parts there are that this software has derived, and how many in all."""
    count = select(func.count()).select_from(parts)
    done = connection.execute(count.where(parts.c.software == software())).scalar_one()
    return done, connection.execute(count).scalar_one()


def get_definition(connection: Connection, digest: str) -> bytes | None:
    """The definition of a part as stored. Raises Refused (``damaged-content``)."""
    text = connection.execute(_DEFINITION, {"of_digest": digest}).scalar()
    return None if text is None else checked("a definition", digest, text.encode())


def get_blob(connection: Connection, digest: str) -> bytes | None:
    """The definition, the program or the uploaded states with this digest. Raises Refused (``damaged-content``)."""
    found = get_definition(connection, digest) or get_program(connection, digest)
    if found is None:
        found = get_upload(connection, digest)
        return None if found is None else checked("uploaded states", digest, found)
    return found


# Built once: to build a statement takes longer than to execute it.
_PROGRAM = select(programs.c.content).where(programs.c.digest == bindparam("of_digest"))
_DEFINITION = select(parts.c.definition).where(parts.c.digest == bindparam("of_digest"))
_RECIPE = select(parts.c.recipe).where(parts.c.digest == bindparam("of_digest"))
_HAS_PROGRAM = select(programs.c.nodes).where(programs.c.digest == bindparam("digest"))
_PROGRAM_OF = select(parts.c.program, parts.c.software).where(parts.c.digest == bindparam("digest"))
_STORED = (
    select(*(parts.c[name] for name in (*PART, "definition", "recipe", "seal")), programs.c.content)
    .join(programs, programs.c.digest == parts.c.program, isouter=True)
    .where(parts.c.digest == bindparam("of_digest"))
)
