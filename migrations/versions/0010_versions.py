"""Versions and revisions say why they were made and what of, parts what they are built of, jobs what they are for."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"

#: references to another name: (column of the name, column of the number)
REFERENCES = (("derived_name", "derived_version"), ("successor_name", "successor_version"), ("tree", "tree_revision"))


SHIPPED = """
UPDATE versions SET origin = 'catalogue' WHERE name IN (SELECT name FROM substructures WHERE owner = 'catalogue')
"""


def upgrade() -> None:
    """What is there has neither note nor label, and of its origin is known whether it was shipped."""
    for table in ("versions", "trees"):
        op.add_column(table, sa.Column("note", sa.Text(), nullable=False, server_default=""))
    op.add_column("versions", sa.Column("origin", sa.Text(), nullable=False, server_default=""))
    for name, number in REFERENCES:
        op.add_column("versions", sa.Column(name, sa.Text(), nullable=True))
        op.add_column("versions", sa.Column(number, sa.Integer(), nullable=True))
    op.execute(SHIPPED)
    op.add_column("jobs", sa.Column("label", sa.Text(), nullable=False, server_default=""))
    op.add_column("jobs", sa.Column("retry_of", sa.Text(), nullable=True))
    op.create_table(
        "part_uses",
        sa.Column("part", sa.Text(), nullable=False),
        sa.Column("instance", sa.Text(), nullable=False),
        sa.Column("used", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["part"], ["parts.digest"], name=op.f("fk_part_uses_part_parts")),
        sa.ForeignKeyConstraint(["used"], ["parts.digest"], name=op.f("fk_part_uses_used_parts")),
        sa.PrimaryKeyConstraint("part", "instance", name=op.f("pk_part_uses")),
    )
    op.create_index(op.f("ix_part_uses_used"), "part_uses", ["used"])
