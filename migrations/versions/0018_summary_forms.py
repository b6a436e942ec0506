"""Summaries of trees in two parts: what trees of one shape have in common, kept once, and the values of each.

Those that are there stay whole, which their values are then; one that is coupled anew is stored in parts.
"""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0018"
down_revision = "0017"


def upgrade() -> None:
    """Add the table, and the column that points to it."""
    op.create_table(
        "summary_forms",
        sa.Column("digest", sa.Text(), nullable=False),
        sa.Column("content", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("digest", name=op.f("pk_summary_forms")),
    )
    op.alter_column("trees", "summary", new_column_name="summary_values")
    op.execute(
        "ALTER TABLE trees ADD COLUMN summary_form TEXT "
        "CONSTRAINT fk_trees_summary_form_summary_forms REFERENCES summary_forms (digest)"
    )
