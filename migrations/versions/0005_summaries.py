"""The digest of what is stored of a tree beside its program, so that whoever reads it can compare."""

from __future__ import annotations

import hashlib

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    """Add the column, and fill it for the trees that are there."""
    op.add_column("trees", sa.Column("summary_digest", sa.Text(), nullable=False, server_default=""))
    connection = op.get_bind()
    trees = sa.table("trees", *map(sa.column, ("name", "revision", "summary", "summary_digest")))
    for name, revision_ in connection.execute(sa.select(trees.c.name, trees.c.revision)).all():
        chosen = (trees.c.name == name) & (trees.c.revision == revision_)
        summary = connection.execute(sa.select(trees.c.summary).where(chosen)).scalar_one()
        digest = "sha256:" + hashlib.sha256(summary.encode()).hexdigest()
        connection.execute(sa.update(trees).where(chosen).values(summary_digest=digest))
