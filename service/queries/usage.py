"""How many bytes are kept for whom."""

from __future__ import annotations

from sqlalchemy import Connection, Table, func, select

from service.database.job_tables import results, uploads
from service.database.tables import idempotency

#: what quotas are for: states that were uploaded, results of jobs, answers kept under idempotency keys
KEPT: dict[str, Table] = {"upload": uploads, "result": results, "answer": idempotency}


def bytes_by_principal(connection: Connection, what: str) -> dict[str, int]:
    """The bytes that are kept for each principal."""
    table = KEPT[what]
    query = select(table.c.principal, func.sum(table.c.size)).group_by(table.c.principal)
    return {row[0]: int(row[1] or 0) for row in connection.execute(query)}
