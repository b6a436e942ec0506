"""Versions that are taken back are withdrawn in all words: ``withdrawn_at``, ``withdrawal_reason``."""

from __future__ import annotations

from alembic import op

revision = "0017"
down_revision = "0016"


def upgrade() -> None:
    """Rename the columns; acts of the audit stay as they were noted."""
    op.alter_column("versions", "yanked", new_column_name="withdrawn_at")
    op.alter_column("versions", "yank_reason", new_column_name="withdrawal_reason")
