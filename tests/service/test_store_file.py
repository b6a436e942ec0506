"""The file of an SQLite store: gone or replaced, damaged, private, and one server's by whatever name."""

from __future__ import annotations

import os
import resource
import sqlite3
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from pathlib import Path
from time import sleep
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from sqlalchemy.exc import OperationalError

from service.app import open_store
from service.database.backup import backup, restore
from service.database.connections import Database, DatabaseError
from service.settings import Settings
from service.store.store import Store

from .conftest import PENDULUM, SLIDER, copied, make_client
from .farm import Server, running


def deleted(path: Path) -> None:
    path.unlink()


def moved(path: Path) -> None:
    path.rename(path.with_name("elsewhere.db"))


def replaced(path: Path) -> None:
    other = path.with_name("other.db")
    backup(f"sqlite:///{path}", other)
    other.replace(path)


def without_log(path: Path) -> None:
    path.with_name(f"{path.name}-wal").unlink()


@pytest.mark.parametrize("happens", [deleted, moved, replaced, without_log])
def test_a_store_that_is_gone_is_noticed(
    client: TestClient, store: Store, tmp_path: Path, happens: Callable[[Path], None]
) -> None:
    """Nothing is acknowledged that a new start would not find."""
    assert client.post("/v1/substructures", json=PENDULUM).status_code == 201
    assert client.get("/readyz").status_code == 200
    happens(tmp_path / "store.db")
    for answer in (
        client.get("/readyz"),
        client.post("/v1/substructures", json=SLIDER),
        client.get("/v1/substructures/pendulum"),
    ):
        assert (answer.status_code, answer.json()["code"]) == (503, "database-unavailable")
    assert client.get("/livez").status_code == 200
    store.close()
    names = {path.name for path in tmp_path.glob("*.db")}
    if "store.db" in names and happens is not without_log:
        with closing(sqlite3.connect(tmp_path / "store.db")) as found:
            assert {row[0] for row in found.execute("SELECT name FROM substructures")} <= {"pendulum"}
    assert ("store.db" in names) == (happens in (replaced, without_log))  # nobody has made a new one


def test_a_store_that_goes_while_it_is_written(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path}/x.db")
    with pytest.raises(OperationalError, match="deleted or replaced"), database.write() as connection:  # noqa: PT012
        connection.exec_driver_sql("INSERT INTO substructures (name) VALUES ('a')")
        (tmp_path / "x.db").rename(tmp_path / "y.db")
        (tmp_path / "x.db-wal").rename(tmp_path / "y.db-wal")
    database.close()
    with closing(sqlite3.connect(tmp_path / "y.db")) as found:
        assert found.execute("SELECT count(*) FROM substructures").fetchone() == (0,)


def random_bytes(page: bytes) -> bytes:
    return page[:8] + np.random.default_rng(1).bytes(len(page) - 8)


def torn_row(page: bytes) -> bytes:
    """SQLite's own check ends in an error where the header of a row is longer than the row."""
    start = int.from_bytes(page[8:10])  # of the first row: its length, its id, the length of its header
    for _ in range(2):
        while page[start] & 0x80:
            start += 1
        start += 1
    return page[:start] + b"\xff\xff\x7f" + page[start + 3 :]


Damage = Callable[[bytes], bytes]


def damaged(template: Path, tmp_path: Path, damage: Damage = random_bytes) -> tuple[Path, bytes]:
    path = tmp_path / "store.db"
    copied(template, path)
    with closing(sqlite3.connect(path)) as connection:
        size = connection.execute("PRAGMA page_size").fetchone()[0]
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        root = connection.execute("SELECT rootpage FROM sqlite_schema WHERE name = 'parts'").fetchone()[0]
    content = bytearray(path.read_bytes())
    place = slice((root - 1) * size, root * size)
    content[place] = damage(bytes(content[place]))
    path.write_bytes(content)
    return path, bytes(content)


@pytest.mark.parametrize("damage", [random_bytes, torn_row])
def test_damage_is_found_at_the_start(template: Path, tmp_path: Path, damage: Damage) -> None:
    path, content = damaged(template, tmp_path, damage)
    with pytest.raises(DatabaseError, match=r"is damaged: .*restore a backup"):
        Database(f"sqlite:///{path}")
    assert path.read_bytes() == content


@pytest.mark.parametrize("damage", [random_bytes, torn_row])
def test_damage_of_a_large_store_is_found_while_it_answers(
    template: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, damage: Damage
) -> None:
    path, _ = damaged(template, tmp_path, damage)
    monkeypatch.setattr("service.database.file.LARGE", 0)
    with closing(Database(f"sqlite:///{path}")) as database:
        for _ in range(200):  # in ten seconds at most
            with suppress(OperationalError), database.read():
                sleep(0.05)
                continue
            break
        with pytest.raises(OperationalError, match="restore a backup"), database.read():
            pass
        with pytest.raises(OperationalError, match="is damaged"), database.write():
            pass


def test_a_sound_large_store_is_closed_at_once(template: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    copied(template, tmp_path / "store.db")
    monkeypatch.setattr("service.database.file.LARGE", 0)
    for _ in range(5):
        with closing(Database(f"sqlite:///{tmp_path / 'store.db'}")) as database, database.write() as connection:
            connection.exec_driver_sql("INSERT INTO substructures (name) VALUES ('a') ON CONFLICT DO NOTHING")
    assert not any(thread.name == "look for damage" for thread in threading.enumerate())


def mode(path: Path) -> int:
    return path.stat().st_mode & 0o777


def test_files_are_private(tmp_path: Path) -> None:
    before = os.umask(0o022)
    try:
        address = f"sqlite:///{tmp_path}/x.db"
        with open_store(Settings(database=address, catalogue=False)) as store:
            make_client(store).post("/v1/substructures", json=PENDULUM)
            backup(address, tmp_path / "saved")
            (tmp_path / "x.db").chmod(0o644)  # as older versions made it
        Database(address).close()
        restore(tmp_path / "saved", f"sqlite:///{tmp_path}/y.db")
    finally:
        os.umask(before)
    files = {path.name: mode(path) for path in tmp_path.iterdir() if path.is_file()}
    assert {"x.db", "x.db.lock", "y.db", "saved"} <= files.keys()
    assert set(files.values()) == {0o600}


@pytest.fixture(scope="module")
def held(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A store that a server in a process of its own holds."""
    folder = tmp_path_factory.mktemp("held")
    with running([Server(f"sqlite:///{folder}/x.db", folder / "log")]):
        yield folder / "x.db"


@pytest.mark.parametrize("link", ["symbolic", "hard", "symbolic folder"])
def test_a_link_is_the_same_store(held: Path, tmp_path: Path, link: str) -> None:
    """Whoever calls it by another name is refused."""
    other = tmp_path / "b" / "x.db"
    if link == "symbolic folder":
        other.parent.symlink_to(held.parent)
    else:
        other.parent.mkdir()
        (other.symlink_to if link == "symbolic" else other.hardlink_to)(held)
    try:
        with pytest.raises(DatabaseError, match="another server uses"):
            Database(f"sqlite:///{other}")
    finally:
        (other.parent if link == "symbolic folder" else other).unlink()


def test_a_full_disk_and_a_folder_that_is_not_there_are_no_other_server(tmp_path: Path) -> None:
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, limits[1]))
    try:
        with pytest.raises(DatabaseError, match=r"cannot write .*x\.db\.lock: .*; is there space left"):
            Database(f"sqlite:///{tmp_path}/x.db")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    with pytest.raises(DatabaseError, match=r"there is no folder .*nowhere"):
        Database(f"sqlite:///{tmp_path}/nowhere/x.db")
    Database(f"sqlite:///{tmp_path}/x.db").close()


def test_a_claim_ends_with_its_database(tmp_path: Path) -> None:
    (tmp_path / "link.db").symlink_to(tmp_path / "x.db")
    for name in ("x.db", "link.db", "x.db"):
        database: Any = Database(f"sqlite:///{tmp_path}/{name}")
        database.close()
    assert not (tmp_path / "link.db.lock").exists()
