"""Numbers of versions, results of jobs and answers under idempotency keys have a seal, as parts and trees.

What is there has none: results are read by those who have them, and not taken for equal items of later jobs; answers
are not given again; the numbers are sealed by the server that starts, once.
"""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0019"
down_revision = "0018"


def upgrade() -> None:
    """Add the columns, without seals."""
    for table in ("versions", "results", "idempotency"):
        op.add_column(table, sa.Column("seal", sa.Text(), nullable=False, server_default=""))
