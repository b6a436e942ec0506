"""Back an SQLite store up while a server uses it, and restore it."""

from __future__ import annotations

import os
import sqlite3
from contextlib import closing
from pathlib import Path

from service.database.connections import Database, DatabaseError, normalised
from service.database.file import PRIVATE, Claim, reading, require_store

HEADER = b"SQLite format 3\x00"


def backup(address: str, target: Path) -> int:
    """Copy the store to a new file as it is at one moment; its size in bytes. A running server is not disturbed.

    The copy is checked, and appears under its name only when it is complete. Raises DatabaseError.
    """
    source = _file(
        address, "for PostgreSQL use pg_dump --format=custom --file=FILE URL: it is consistent while servers run"
    )
    if target.exists():
        raise DatabaseError(f"{target} exists; choose another name")
    if not source.exists():
        raise DatabaseError(f"there is no database {source}")
    require_store(source)
    part = _new(target)
    try:
        with closing(reading(source)) as connection, closing(sqlite3.connect(part)) as copy:
            connection.backup(copy)  # one step: one state, whatever is written meanwhile
            copy.execute("PRAGMA journal_mode=DELETE")
            _check(copy, part)
        _sync(part)
        part.rename(target)
    except sqlite3.Error as error:
        raise DatabaseError(f"cannot back {source} up: {error}") from None
    finally:
        part.unlink(missing_ok=True)
    return target.stat().st_size


def restore(source: Path, address: str, overwrite: bool = False) -> None:
    """Put a backup in the place of the store, which no server may be using.

    Raises DatabaseError for a damaged file, and for a store that is there unless it may be overwritten.
    """
    if not source.is_file():
        raise DatabaseError(f"there is no file {source}; 'substructures backup FILE' makes one of a store")
    target = _file(
        address,
        "for PostgreSQL stop all servers and workers, then use pg_restore --clean --if-exists --dbname=URL FILE",
    )
    if target.exists() and not overwrite:
        raise DatabaseError(f"{target} exists; restore to another file, or say --overwrite")
    _check_backup(source)  # before the store is claimed: the file of the claim stays
    with closing(Claim(target)) as claim:
        target = claim.path  # not a link to it
        part = _new(target)
        try:
            with closing(reading(source)) as connection, closing(sqlite3.connect(part)) as copy:
                connection.backup(copy)
            _sync(part)
            for leftover in ("-wal", "-shm"):  # of the store that is replaced
                target.with_name(target.name + leftover).unlink(missing_ok=True)
            part.replace(target)
        except sqlite3.Error as error:
            raise DatabaseError(f"{source} is no usable backup: {error}") from None
        finally:
            part.unlink(missing_ok=True)
    Database(address).close()  # an older version is migrated now rather than when the server starts


def _check_backup(source: Path) -> None:
    if not _is_sqlite(source):
        raise DatabaseError(f"{source} is no backup")
    try:
        with closing(reading(source)) as connection:
            _check(connection, source)
    except sqlite3.Error as error:
        raise DatabaseError(f"{source} is no usable backup: {error}") from None


def _file(address: str, otherwise: str) -> Path:
    url = normalised(address)
    if url.get_backend_name() != "sqlite":
        raise DatabaseError(otherwise)
    return Path(url.database or "")


def _is_sqlite(path: Path) -> bool:
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(len(HEADER)) == HEADER


def _check(connection: sqlite3.Connection, path: Path) -> None:
    found = [row[0] for row in connection.execute("PRAGMA integrity_check(3)")]
    dangling = connection.execute("PRAGMA foreign_key_check").fetchall()
    if found != ["ok"] or dangling:
        raise DatabaseError(f"{path} is damaged: {'; '.join(found)}; {len(dangling)} dangling references")
    connection.execute("SELECT version_num FROM alembic_version").fetchall()


def _new(target: Path) -> Path:
    """A new file beside the target that only its owner can read; what takes its name has been complete.

    Raises DatabaseError where there can be none.
    """
    part = target.with_name(target.name + ".part")
    try:
        part.unlink(missing_ok=True)
        os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, PRIVATE))
    except OSError as error:
        how = f"a folder {target.absolute().parent} is needed in which this user may write"
        raise DatabaseError(f"cannot write {target}: {error.strerror}; {how}") from None
    return part


def _sync(path: Path) -> None:
    with path.open("rb") as file:
        os.fsync(file.fileno())
