"""Which software has derived all of a store anew, under a seal, and how far another one is.

The seal is over what is done then: parts and trees derived, versions numbered.
"""

from __future__ import annotations

from sqlalchemy import Connection, delete, insert, select

from service.content.derivation import software
from service.database.seals import seal
from service.database.tables import renewals
from service.queries.common import now
from service.queries.content import count_parts
from service.queries.trees import count_revisions


def is_done(connection: Connection) -> bool:
    """Whether this software has looked at all parts and trees of this store."""
    found = connection.execute(select(renewals.c.seal).where(renewals.c.software == software())).scalar()
    return found == _seal(connection, software())


def is_ours(connection: Connection) -> bool:
    """Whether some software has, with the key of this server: from then on every version has a seal of its number."""
    found = connection.execute(select(renewals.c.software, renewals.c.seal))
    return any(row.seal == _seal(connection, row.software) for row in found)


def note(connection: Connection) -> None:
    """Note that it has."""
    connection.execute(delete(renewals))
    connection.execute(
        insert(renewals), {"software": software(), "seal": _seal(connection, software()), "ended": now()}
    )


def progress(connection: Connection) -> tuple[int, int] | None:
    """How many parts and trees are as this software derives them, and of how many; None when it has looked at all."""
    if is_done(connection):
        return None
    parts, trees = count_parts(connection), count_revisions(connection)
    return parts[0] + trees[0], parts[1] + trees[1]


def _seal(connection: Connection, done_by: str) -> str:
    return seal(connection, ["renewal and numbers", done_by])
