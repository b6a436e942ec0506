"""States that are uploaded for jobs, in chunks by digest."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Create the chunks, and which job refers to which."""
    op.create_table(
        "uploads",
        sa.Column("digest", sa.Text(), nullable=False),
        sa.Column("content", sa.LargeBinary(), nullable=False),
        sa.Column("touched", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("digest", name=op.f("pk_uploads")),
    )
    op.create_index(op.f("ix_uploads_touched"), "uploads", ["touched"], unique=False)
    op.create_table(
        "job_uploads",
        sa.Column("job", sa.Text(), nullable=False),
        sa.Column("digest", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["job"], ["jobs.id"], name=op.f("fk_job_uploads_job_jobs")),
        sa.ForeignKeyConstraint(["digest"], ["uploads.digest"], name=op.f("fk_job_uploads_digest_uploads")),
        sa.PrimaryKeyConstraint("job", "digest", name=op.f("pk_job_uploads")),
    )
    op.create_index(op.f("ix_job_uploads_digest"), "job_uploads", ["digest"], unique=False)
