"""Migrations, the lock on an SQLite file, and transactions."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, suppress
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.operations import Operations

from service.database.connections import Database, DatabaseError
from service.database.migrate import upgrade
from service.database.schema import NEWEST, MigrationError, is_newest
from service.database.tables import metadata, parts

from .databases import fresh


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    opened = Database(f"sqlite:///{tmp_path / 'x.db'}")
    yield opened
    opened.close()


def test_migrated_schema_is_the_one_in_the_code(database: Database) -> None:
    with database.read() as connection:
        differences = compare_metadata(MigrationContext.configure(connection), metadata)
    indexes = "substructure_words", "tree_words"  # of words; SQLite keeps them in tables of its own
    assert [each for each in differences if each[0] != "remove_table" or not each[1].name.startswith(indexes)] == []


def test_migrating_again_changes_nothing(database: Database) -> None:
    upgrade(database.writer)
    with database.read() as connection:
        assert connection.exec_driver_sql("SELECT version_num FROM alembic_version").scalars().all() == [NEWEST]


def test_what_is_newest_is_known_without_the_migrations(tmp_path: Path) -> None:
    engine = sa.create_engine(f"sqlite:///{tmp_path / 'x.db'}")
    assert not is_newest(engine)
    upgrade(engine, "0012")
    assert not is_newest(engine)
    upgrade(engine)
    assert is_newest(engine)
    engine.dispose()


def test_a_store_that_is_brought_up_to_date_is_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """A new one is not: there is nothing to wait for."""
    caplog.set_level("INFO", "service.database.migrate")
    engine = sa.create_engine(f"sqlite:///{tmp_path / 'x.db'}")
    upgrade(engine, "0012")
    assert caplog.messages == []
    for _ in range(2):
        upgrade(engine)
    assert [text for text in caplog.messages if "from schema 0012" in text] == caplog.messages[:1] == caplog.messages
    engine.dispose()


def test_newer_databases_are_refused(tmp_path: Path) -> None:
    address = f"sqlite:///{tmp_path / 'x.db'}"
    first = Database(address)
    with first.write() as connection:
        connection.exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
    first.close()
    for _ in range(2):  # the lock was given back
        with pytest.raises(MigrationError, match="does not know"):
            Database(address)


def test_altering_a_table_keeps_its_child_rows(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    """Alembic's batch mode drops the old table, which deletes rows that refer to it while foreign keys are on."""
    with database.write() as connection:
        connection.exec_driver_sql("INSERT INTO substructures (name) VALUES ('a')")
        connection.exec_driver_sql("INSERT INTO programs VALUES ('p', x'00', 1, '')")
        row = {column.name: "" for column in parts.columns} | {"digest": "d", "program": "p", "dof": 1, "mass": 1}
        connection.execute(parts.insert().values(row))
        connection.exec_driver_sql("INSERT INTO versions (name, version, digest, created) VALUES ('a', 1, 'd', '')")

    def alter(_configuration: Any, _revision: str) -> None:
        with Operations(MigrationContext.configure(_configuration.attributes["connection"])).batch_alter_table(
            "substructures", recreate="always"
        ) as batch:
            batch.add_column(sa.Column("extra", sa.Text))

    monkeypatch.setattr("service.database.migrate.command.upgrade", alter)
    upgrade(database.writer)
    with database.read() as connection:
        assert connection.exec_driver_sql("SELECT count(*) FROM versions").scalar() == 1
        assert connection.exec_driver_sql("SELECT extra FROM substructures").scalar() is None
    with pytest.raises(sa.exc.IntegrityError), database.write() as connection:  # foreign keys are on again
        connection.exec_driver_sql("DELETE FROM substructures")


def test_failed_migrations_change_nothing(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(configuration: Any, _revision: str) -> None:
        configuration.attributes["connection"].exec_driver_sql("CREATE TABLE half (x)")
        raise RuntimeError("half way")

    monkeypatch.setattr("service.database.migrate.command.upgrade", fail)
    with pytest.raises(RuntimeError, match="half way"):
        upgrade(database.writer)
    with database.read() as connection:
        assert "half" not in sa.inspect(connection).get_table_names()


def test_pragmas(database: Database) -> None:
    for engine in (database.reader, database.writer):
        with engine.connect() as connection:
            values = [
                connection.exec_driver_sql(f"PRAGMA {name}").scalar()
                for name in ("journal_mode", "synchronous", "foreign_keys")
            ]
            assert values == ["wal", 2, 1]


@pytest.mark.parametrize(
    ("kind", "asked", "told"),
    [("sqlite", "PRAGMA synchronous", (2, 1)), ("postgresql", "SHOW synchronous_commit", ("on", "off"))],
)
def test_only_what_is_not_durable_does_not_wait_for_the_disk(
    kind: str, asked: str, told: tuple[Any, Any], tmp_path: Path
) -> None:
    found = []
    with fresh(kind, tmp_path) as address, closing(Database(address)) as database:
        for durable in (True, False, True):
            with database.write(durable=durable) as connection:
                found.append(connection.exec_driver_sql(asked).scalar())
        with suppress(ZeroDivisionError), database.write(durable=False):
            raise ZeroDivisionError
        with database.write() as connection:
            found.append(connection.exec_driver_sql(asked).scalar())
    assert found == [told[0], told[1], told[0], told[0]]


def test_readers_cannot_write(database: Database) -> None:
    with pytest.raises(sa.exc.OperationalError, match="readonly"), database.read() as connection:
        connection.exec_driver_sql("INSERT INTO substructures (name) VALUES ('a')")


def test_transactions_are_all_or_nothing(database: Database) -> None:
    statement = "INSERT INTO substructures (name) VALUES ('a')"
    with pytest.raises(sa.exc.IntegrityError), database.write() as connection:  # noqa: PT012 -- the second of two
        for _ in range(2):
            connection.exec_driver_sql(statement)
    with database.read() as connection:
        assert connection.exec_driver_sql("SELECT count(*) FROM substructures").scalar() == 0


def test_one_server_a_file(tmp_path: Path) -> None:
    address = f"sqlite:///{tmp_path / 'x.db'}"
    first = Database(address)
    with pytest.raises(DatabaseError, match="another server"):
        Database(address)
    Database(address, exclusive=False).close()
    first.close()
    Database(address).close()


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("mysql://x/y", "kind 'mysql' are not supported"),
        ("nonsense", "'nonsense' is no database URL"),
        ("sqlite://", "needs a file"),
        ("sqlite:////nowhere/at/all.db", "there is no folder /nowhere/at|there is no database"),
        ("postgresql://x@127.0.0.1:9/x", "cannot use the database postgresql"),
        ("postgresql://x:port/y", "is no database URL"),
    ],
)
def test_wrong_addresses(address: str, message: str) -> None:
    for exclusive in (True, False):
        with pytest.raises(DatabaseError, match=message):
            Database(address, exclusive=exclusive)
