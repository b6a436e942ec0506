"""Bring a database to the newest schema, on start, in one transaction."""

from __future__ import annotations

import logging
from importlib.resources import as_file, files

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from alembic.util import CommandError
from sqlalchemy import Connection, Engine, text

from service.database.schema import MigrationError

_log = logging.getLogger(__name__)

ADVISORY_LOCK = 7_305_511  # any constant: servers that start together on PostgreSQL migrate one after the other


def upgrade(engine: Engine, revision: str = "head") -> None:
    """Run the missing migrations; all or none of them take effect. Raises MigrationError."""
    with engine.connect() as connection:
        is_sqlite = connection.dialect.name == "sqlite"
        if is_sqlite:
            # Batch mode copies a table and drops the old one, which deletes all child rows while foreign keys are on;
            # the switch has no effect inside a transaction.
            _outside_transaction(connection, "PRAGMA foreign_keys=OFF")
        try:
            with connection.begin():
                _run(connection, revision, is_sqlite)
        finally:
            if is_sqlite:
                _outside_transaction(connection, "PRAGMA foreign_keys=ON")


def _run(connection: Connection, revision: str, is_sqlite: bool) -> None:
    if not is_sqlite:
        connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": ADVISORY_LOCK})
    with as_file(files("migrations")) as folder:
        configuration = Config(attributes={"connection": connection})
        configuration.set_main_option("script_location", str(folder).replace("%", "%%"))
        configuration.set_main_option("path_separator", "os")
        before = _revisions(connection)
        _tell(before, ScriptDirectory.from_config(configuration).get_current_head())
        try:
            command.upgrade(configuration, revision)
        except CommandError as error:
            raise MigrationError(f"the database has a schema that this version does not know: {error}") from None
    if is_sqlite and _revisions(connection) != before:
        # what was dangling before is not for the start to judge: whoever reads it refuses it by name
        broken = connection.exec_driver_sql("PRAGMA foreign_key_check").fetchall()
        if broken:
            raise MigrationError(f"migration would leave {len(broken)} dangling references; nothing was changed")


def _tell(before: tuple[str, ...], newest: str | None) -> None:
    """Say what takes a while: half a minute of a store of 100,000 parts."""
    if before and newest not in before:
        _log.info("bringing the database from schema %s to %s; all of it, or nothing", ", ".join(before), newest)


def _revisions(connection: Connection) -> tuple[str, ...]:
    return MigrationContext.configure(connection).get_current_heads()


def _outside_transaction(connection: Connection, statement: str) -> None:
    driver = connection.connection.driver_connection
    if driver is None:
        raise MigrationError("the connection was closed")
    driver.execute(statement)
