"""Who did what: rows are added and never changed, which triggers of the database see to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import orjson
from sqlalchemy import Connection, func, insert, select

from service.database.tables import audit
from service.messages.viewer import Viewer
from service.queries.common import now


@dataclass(frozen=True, slots=True)
class AuditEntry:
    """One act; ``subject`` is what it was done to, ``detail`` is JSON."""

    seq: int
    time: str
    key: str
    owner: str
    action: str
    subject: str
    detail: str


def note(connection: Connection, viewer: Viewer, action: str, subject: str, **detail: Any) -> None:
    """Note an act in the transaction that does it."""
    row = {"time": now(), "key": viewer.key, "owner": viewer.owner, "action": action, "subject": subject}
    connection.execute(_NEW, {**row, "detail": orjson.dumps(detail).decode()})


def state(connection: Connection) -> tuple[int, int]:
    """What is another one after every act: the number of the last one, and how many of those shortly before there are,
    since one may be committed later than one with a greater number.
    """
    last, count = connection.execute(_STATE).one()
    return last or 0, count


def page(connection: Connection, wanted: Mapping[str, str], before: int | None, size: int) -> list[AuditEntry]:
    """Up to ``size`` acts, the latest first; ``wanted``: values that columns have to have."""
    query = select(*(audit.c[name] for name in AuditEntry.__slots__))
    for name, value in wanted.items():
        query = query.where(audit.c[name] == value)
    if before is not None:
        query = query.where(audit.c.seq < before)
    return [AuditEntry(*row) for row in connection.execute(query.order_by(audit.c.seq.desc()).limit(size))]


# Built once: to build a statement takes longer than to execute it.
_LAST = select(func.max(audit.c.seq)).scalar_subquery()
_STATE = select(_LAST, func.count()).select_from(audit).where(audit.c.seq > _LAST - 1000)
_NEW = insert(audit)
