"""What is kept for whom, and how many bytes it takes, so that quotas can be had."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"

SIZES = {
    "uploads": "length(content)",
    "results": "length(summary) + coalesce((SELECT sum(f.size) FROM result_files f WHERE f.key = results.key), 0)",
    "idempotency": "coalesce(length(body), 0)",
}


def upgrade() -> None:
    """Add columns and an index; what is there has its size, and belongs to nobody where no principal is told."""
    for table, size in SIZES.items():
        if table != "idempotency":
            op.add_column(table, sa.Column("principal", sa.Text(), nullable=False, server_default=""))
        op.add_column(table, sa.Column("size", sa.BigInteger(), nullable=False, server_default="0"))
        op.execute(f"UPDATE {table} SET size = {size}")  # noqa: S608 -- of the table above
        op.create_index(op.f(f"ix_{table}_principal_size"), table, ["principal", "size"], unique=False)
