"""Databases that are full, busy, forbidden or held by a process that stands still."""

from __future__ import annotations

import sqlite3
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import sqlalchemy as sa
from fastapi.testclient import TestClient
from sqlalchemy.engine import make_url
from sqlalchemy.exc import DBAPIError, NotSupportedError, OperationalError

from service import app
from service.app import open_store
from service.database import connections
from service.database.connections import Database, DatabaseError
from service.database.tables import tree_names
from service.http.problems import as_refused
from service.messages.viewer import Viewer
from service.operations import trees
from service.operations.seed import Told
from service.queries.common import insert_missing, is_conflict, is_outage
from service.settings import Settings
from service.store.store import Store

from .conftest import PENDULUM, TREE, make_client
from .databases import fresh


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    with fresh("postgresql", tmp_path) as address:
        yield address


def put(connection: connections.Connection, name: str) -> None:
    insert_missing(connection, tree_names, [{"name": name, "latest": 0}])


def test_a_process_that_stands_still_does_not_hold_the_others(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "IDLE_MS", 300)
    store = Database(address)
    begun, go_on, seen = threading.Event(), threading.Event(), list[Exception]()

    def stand_still() -> None:
        try:
            with store.write() as connection:
                put(connection, "a")
                begun.set()
                go_on.wait(20)
        except Exception as error:
            seen.append(error)

    thread = threading.Thread(target=stand_still)
    thread.start()
    assert begun.wait(10)
    start = time.monotonic()
    with store.write() as connection:
        put(connection, "a")
    assert time.monotonic() - start < 10
    go_on.set()
    thread.join()
    assert is_outage(seen[0])
    assert as_refused(seen[0]).status == 503
    with store.read() as connection:
        assert list(connection.execute(sa.select(tree_names.c.name)).scalars()) == ["a"]
    store.close()


def test_both_ends_of_a_connection_watch_each_other(address: str) -> None:
    store = Database(address)
    with store.read() as connection:
        shown = [
            connection.exec_driver_sql(f"SHOW tcp_{name}").scalar() for name in ("keepalives_idle", "user_timeout")
        ]
        assert shown == ["5", "20000"]
        parameters = connection.connection.driver_connection.info.get_parameters()  # type: ignore[union-attr]
    assert parameters["tcp_user_timeout"] == "20000"
    assert parameters["connect_timeout"] == "2"  # what the address says goes before
    store.close()


def test_deadlocks_are_tried_again(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two requests that lock two names in opposite order: one is the victim, and both succeed."""
    with open_store(Settings(database=address, catalogue=False)) as store:
        client = make_client(store)
        client.post("/v1/substructures", json=PENDULUM)
        commit, meet, seen = trees.commit, threading.Barrier(2), list[str]()

        def crossed(connection: connections.Connection, viewer: Viewer, revision: trees.Revision) -> object:
            seen.append(revision.coupled.name)
            first, second = ("x", "y") if revision.coupled.name == "one" else ("y", "x")
            put(connection, first)
            if len(seen) <= 2:
                meet.wait(10)
            put(connection, second)
            return commit(connection, viewer, revision)

        monkeypatch.setattr(trees, "commit", crossed)
        answers: dict[str, int] = {}

        def post(name: str) -> None:
            answers[name] = client.post("/v1/trees", json={**TREE, "name": name}).status_code

        threads = [threading.Thread(target=post, args=(name,)) for name in ("one", "two")]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert answers == {"one": 201, "two": 201}
        assert len(seen) == 3


def test_what_the_database_forbids_is_told_in_a_line(address: str) -> None:
    Database(address).close()
    engine = sa.create_engine(make_url(address).set(drivername="postgresql+psycopg"), isolation_level="AUTOCOMMIT")
    role = f"norights_{Path(make_url(address).database or '').name}"
    with engine.connect() as connection:
        connection.exec_driver_sql(f'CREATE ROLE "{role}" LOGIN')
        try:
            forbidden = make_url(address).set(username=role).render_as_string(hide_password=False)
            with pytest.raises(DatabaseError, match=r"cannot use the database .*: permission denied for table \w+$"):
                Database(forbidden)
        finally:
            connection.exec_driver_sql(f'DROP ROLE "{role}"')
    engine.dispose()


def test_an_import_that_the_database_refuses(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_store: Store, _progress: Told) -> None:
        raise OperationalError("INSERT", {}, sqlite3.OperationalError("disk I/O error"))

    monkeypatch.setattr(app, "import_catalogue", refuse)
    settings = Settings(database=f"sqlite:///{tmp_path / 'x.db'}")
    with pytest.raises(DatabaseError, match=r"disk I/O error$"), open_store(settings):
        pass
    Database(settings.database).close()


def test_a_full_disk_is_named(client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    with store.database.write() as connection:
        pages = connection.exec_driver_sql("PRAGMA page_count").scalar()
        connection.exec_driver_sql(f"PRAGMA max_page_count = {pages}")
    answers = (client.post("/v1/substructures", json={**PENDULUM, "name": f"p{k}"}) for k in range(100))
    answer = next(answer for answer in answers if answer.status_code != 201)
    assert (answer.status_code, answer.json()["code"]) == (503, "database-unavailable")
    assert answer.json()["detail"] == "the disk of the database is full; nothing was changed"
    assert client.get("/readyz").status_code == 200
    monkeypatch.setattr(connections, "ROOM", 10**18)
    assert (client.get("/readyz").status_code, client.get("/readyz").json()["detail"]) == (
        503,
        "the disk of the database is full",
    )


def test_a_database_that_takes_no_changes_is_named(
    client: TestClient, store: Store, address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = "the database takes no changes: it is read-only, or a standby; nothing was changed"
    with store.database.write() as connection:
        connection.exec_driver_sql("PRAGMA query_only = ON")
    answer = client.post("/v1/substructures", json=PENDULUM)
    assert (answer.status_code, answer.json()["code"]) == (503, "database-unavailable")
    assert answer.json()["detail"] == told
    database = Database(address)
    with database.write() as connection:
        connection.exec_driver_sql("SET TRANSACTION READ ONLY")
        with pytest.raises(DBAPIError) as refused:
            put(connection, "a")
    errors = pytest.importorskip("psycopg").errors
    standby = NotSupportedError("x", {}, errors.FeatureNotSupported("cannot set transaction read-write mode"))
    for error in (refused.value, standby):
        assert is_outage(error)
        assert (as_refused(error).status, as_refused(error).detail) == (503, told)
    assert not database.obstacle()
    monkeypatch.setattr(connections, "STANDBY", "SELECT true")
    monkeypatch.setattr(store, "database", database)
    ready = client.get("/readyz")
    assert (ready.status_code, ready.json()["detail"]) == (503, "the database is a standby, which takes no changes")
    database.close()


def test_conflicts_are_known_by_their_state() -> None:
    assert not is_conflict(ValueError("x"))
    assert not is_conflict(DBAPIError("x", {}, sqlite3.OperationalError("database is locked")))
