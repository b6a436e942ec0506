"""Which schema a database has, found out without what migrates: most starts have nothing to migrate."""

from __future__ import annotations

from sqlalchemy import Engine, inspect, text

NEWEST = "0019"  # revision of the newest migration


class MigrationError(Exception):
    """A database whose schema this version cannot use."""


def is_newest(engine: Engine) -> bool:
    """Whether a database has the newest schema."""
    with engine.connect() as connection:
        if not inspect(connection).has_table("alembic_version"):
            return False
        return connection.execute(text("SELECT version_num FROM alembic_version")).scalars().all() == [NEWEST]
