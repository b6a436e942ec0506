"""Backups: consistent while a server writes, checked, and restored only where nothing is lost."""

from __future__ import annotations

import os
import pwd
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.cli.main import main
from service.database.backup import backup, restore
from service.database.connections import Database, DatabaseError
from service.settings import Settings

from .conftest import PENDULUM, TREE, make_client
from .fake_engine import FakeEngine, export, finished, running, submitted


def test_backup_while_writing(filled: TestClient, settings: Settings, tmp_path: Path) -> None:
    stop = threading.Event()
    acknowledged: list[str] = []

    def write() -> None:
        while not stop.is_set():
            acknowledged.append(submitted(filled, export("cell", "metric", "gravity")))

    thread = threading.Thread(target=write)
    thread.start()
    try:
        for k in range(5):
            before = len(acknowledged)
            assert backup(settings.database, tmp_path / f"b{k}") > 0
            with closing(sqlite3.connect(tmp_path / f"b{k}")) as copy:
                known = {row[0] for row in copy.execute("SELECT id FROM jobs")}
                items = copy.execute("SELECT count(*) FROM job_items").fetchone()[0]
            assert set(acknowledged[:before]) <= known
            assert items == 2 * len(known)
    finally:
        stop.set()
        thread.join()
    assert not list(tmp_path.glob("*.part"))


def test_restored_jobs_go_on(filled: TestClient, settings: Settings, tmp_path: Path) -> None:
    job = submitted(filled, export("cell", "metric"))
    backup(settings.database, tmp_path / "saved")
    address = f"sqlite:///{tmp_path / 'other.db'}"
    restore(tmp_path / "saved", address)
    with open_store(Settings(database=address, catalogue=False)) as store, running(store, FakeEngine()):
        client = make_client(store)
        assert client.get("/v1/trees/cell").json()["revision"] == 1
        assert finished(client, job)["state"] == "succeeded"


def test_nothing_is_overwritten_unasked(tmp_path: Path) -> None:
    address, other = (f"sqlite:///{tmp_path / name}" for name in ("a.db", "b.db"))
    with open_store(Settings(database=address, catalogue=False)) as store:
        make_client(store).post("/v1/substructures", json=PENDULUM)
        backup(address, tmp_path / "one")
        make_client(store).post("/v1/trees", json=TREE)
        with pytest.raises(DatabaseError, match="exists"):
            backup(address, tmp_path / "one")
        with pytest.raises(DatabaseError, match="another server"):
            restore(tmp_path / "one", address, overwrite=True)
    with pytest.raises(DatabaseError, match="--overwrite"):
        restore(tmp_path / "one", address)
    restore(tmp_path / "one", address, overwrite=True)
    with open_store(Settings(database=address, catalogue=False)) as store:
        assert make_client(store).get("/v1/trees/cell").status_code == 404
        assert make_client(store).get("/v1/substructures/pendulum").status_code == 200
    (tmp_path / "bad").write_bytes((tmp_path / "one").read_bytes()[:20_000])
    (tmp_path / "text").write_text("no database")
    for name, words in (("bad", "damaged|usable"), ("text", "no backup"), ("none", "no file")):
        with pytest.raises(DatabaseError, match=words):
            restore(tmp_path / name, other)
    assert not list(tmp_path.glob("b.db*"))


@contextmanager
def _as_anybody() -> Iterator[Path]:
    """A folder that all may read and write, for a user without rights where this one has all of them."""
    with TemporaryDirectory() as folder:
        Path(folder).chmod(0o777)
        was = os.geteuid()
        if not was:
            os.seteuid(pwd.getpwnam("nobody").pw_uid)
        try:
            yield Path(folder)
        finally:
            os.seteuid(was)


def test_what_may_not_be_read_or_written_is_named() -> None:
    with _as_anybody() as folder:
        path, shut = folder / "a.db", folder / "shut"
        Database(f"sqlite:///{path}").close()
        shut.mkdir(0o500)
        for target in (shut / "copy", folder / "none" / "copy"):
            with pytest.raises(DatabaseError, match=rf"cannot write {target}: .*a folder {target.parent} is needed"):
                backup(f"sqlite:///{path}", target)
        path.chmod(0)
        with pytest.raises(DatabaseError, match=rf"cannot use {path}: .*allowed to read the file, and to write"):
            backup(f"sqlite:///{path}", folder / "copy")
        with pytest.raises(DatabaseError, match=rf"{shut} is a folder"):
            backup(f"sqlite:///{shut}", folder / "copy")
        assert not (folder / "copy").exists()


def test_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    address = f"sqlite:///{tmp_path / 'a.db'}"
    assert main(["backup", str(tmp_path / "x"), "--database", address]) == 1
    assert "there is no database" in capsys.readouterr().err
    with open_store(Settings(database=address, catalogue=False)):
        assert main(["backup", str(tmp_path / "x"), "--database", address]) == 0
    assert main(["restore", str(tmp_path / "x"), "--database", address]) == 1
    assert main(["restore", str(tmp_path / "x"), "--database", address, "--overwrite"]) == 0
    assert "restored" in capsys.readouterr().out
    assert main(["backup", str(tmp_path / "y"), "--database", "postgresql://x/y"]) == 1
    assert "pg_dump" in capsys.readouterr().err
