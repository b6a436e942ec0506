"""Parts and trees say which software derived them, under a seal; published parts what they were coupled of.

What is there has no seal: it may have come from elsewhere, and whether it did cannot be told in all stores. So all of
it is derived anew from its documents, by the server that starts.
"""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"


def upgrade() -> None:
    """Add the columns, without seals."""
    for table in ("parts", "trees"):
        for name in ("software", "seal"):
            op.add_column(table, sa.Column(name, sa.Text(), nullable=False, server_default=""))
        op.create_index(op.f(f"ix_{table}_software"), table, ["software"])
    op.add_column("parts", sa.Column("index_digest", sa.Text(), nullable=False, server_default=""))
    op.add_column("parts", sa.Column("recipe", sa.Text(), nullable=True))
    for table in ("results", "result_files"):
        op.add_column(table, sa.Column("digest", sa.Text(), nullable=False, server_default=""))
    op.create_table(
        "renewals",
        sa.Column("software", sa.Text(), nullable=False),
        sa.Column("seal", sa.Text(), nullable=False),
        sa.Column("ended", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("software", name=op.f("pk_renewals")),
    )
