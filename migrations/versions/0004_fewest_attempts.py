"""Queued items in the order in which they are claimed: those that were lost before go behind the others."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
QUEUED = sa.text("state = 'queued'")


def upgrade() -> None:
    """Replace the index."""
    op.drop_index("ix_job_items_queued", table_name="job_items")
    columns = ["job", "attempts", "position"]
    op.create_index("ix_job_items_queued", "job_items", columns, sqlite_where=QUEUED, postgresql_where=QUEUED)
