"""Results of items that failed all the same, such as motions up to where they stopped; items that were left out."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"


def upgrade() -> None:
    """Add the columns; results that are there are of items that succeeded."""
    op.add_column("results", sa.Column("is_good", sa.Boolean(), nullable=False, server_default=sa.true()))
    op.add_column("jobs", sa.Column("skipped", sa.Integer(), nullable=False, server_default="0"))
