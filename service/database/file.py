"""The file of an SQLite store: one server's alone, for its owner's eyes, whole, and still there."""

from __future__ import annotations

import fcntl
import logging
import os
import sqlite3
import sys
from collections.abc import Sequence
from contextlib import closing, suppress
from pathlib import Path
from threading import Thread

from sqlalchemy.exc import OperationalError

PRIVATE = 0o600
LARGE = 256 * 2**20  # bytes that a server looks at before it answers
FAULTS, TOLD = 3, 300  # of a damaged file that are named, and in how many characters
_log = logging.getLogger(__name__)


class DatabaseError(Exception):
    """A database that cannot be used; the message says which and why."""


def reading(path: Path) -> sqlite3.Connection:
    """A connection that changes nothing."""
    return sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True, timeout=60)


def require_store(path: Path) -> None:
    """Before anything is made beside a file: that it is a store, or empty, to become one. Raises DatabaseError.

    What is damaged is told by :class:`Watch`.
    """
    if path.is_dir():
        raise DatabaseError(f"{path} is a folder; name the file of a store")
    try:
        with closing(reading(path)) as connection:
            tables = {row[0] for row in connection.execute("SELECT name FROM sqlite_schema WHERE type = 'table'")}
    except sqlite3.Error as error:
        if _is_corrupt(error):
            return
        how = "name the file of a store"
        if error.sqlite_errorcode != sqlite3.SQLITE_NOTADB:
            how = "its user has to be allowed to read the file, and to write to its folder"
        raise DatabaseError(f"cannot use {path}: {error}; {how}") from None
    if tables and "alembic_version" not in tables:
        raise DatabaseError(f"{path} is a database of something else; name the file of a store")


class Claim:
    """The right to write to a file, by its inode: other names of it, and links to it, are the same file.

    The operating system drops it when the process dies. Beside the file stands one for a lock of SQLite's own, which
    holds on every system; on the file itself is a lock of Linux (flock), which SQLite does not know of, and which
    belongs to all processes that have its descriptor, until the last of them has ended.
    """

    def __init__(self, path: Path, held: int | None = None) -> None:
        """Create the file if there is none. ``held``: the descriptor of a claim that this process shares.

        Raises DatabaseError when others have it.
        """
        self.path = path.resolve()
        self._lock: sqlite3.Connection | None = None
        if held is not None:
            self._file = held
            found = os.fstat(held)
            if _identity(self.path) != (found.st_dev, found.st_ino):
                raise DatabaseError(f"{path} was deleted or replaced; restart the server")
            return
        beside = self.path.with_name(f"{self.path.name}.lock")
        if not self.path.parent.is_dir():
            raise DatabaseError(f"cannot open {path}: there is no folder {self.path.parent}")
        try:
            self._lock = sqlite3.connect(beside, timeout=0, isolation_level=None, check_same_thread=False)
        except sqlite3.OperationalError as error:
            raise DatabaseError(f"cannot open {beside}: {error}") from None
        try:
            make_private(beside)
            self._lock.execute("BEGIN EXCLUSIVE")
            self._file = _locked(self.path)
        except (sqlite3.OperationalError, BlockingIOError) as error:
            self._lock.close()
            if getattr(error, "sqlite_errorcode", sqlite3.SQLITE_BUSY) != sqlite3.SQLITE_BUSY:
                how = "is there space left, and may its user write there?"
                raise DatabaseError(f"cannot write {beside}: {error}; {how}") from None
            raise DatabaseError(f"another server uses {path}; stop it or use PostgreSQL for several") from None
        except OSError as error:
            self._lock.close()
            raise DatabaseError(f"cannot open {path}: {error.strerror}") from None

    @property
    def shared(self) -> int | None:
        """The descriptor that lets another process share it, where the system can."""
        return self._file if sys.platform == "linux" else None

    def close(self) -> None:
        """Give it up, after all connections: to close a file drops all locks that this process has on it."""
        os.close(self._file)
        if self._lock is not None:
            self._lock.close()


def _locked(path: Path) -> int:
    file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, PRIVATE)
    try:
        make_private(path)
        if sys.platform == "linux":
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(file)
        raise
    return file


def make_private(path: Path) -> None:
    """Let nobody but the owner read or write a file; that of another owner is left as it is."""
    with suppress(PermissionError):
        if path.stat().st_mode & 0o077:
            path.chmod(PRIVATE)


class Watch:
    """Notices when the file, or the log that SQLite keeps beside it, is damaged, deleted or replaced."""

    def __init__(self, path: Path) -> None:
        """Raises DatabaseError for a damaged file; a large one is looked at in the background."""
        self._path, self._paths = path, [path, path.with_name(f"{path.name}-wal")]
        self._damage, self._looker = "", Thread(target=self._look_later, name="look for damage", daemon=True)
        self._reader: sqlite3.Connection | None = None  # of the background
        # as long as one connection is open, nobody removes the log
        self._anchor = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
        try:
            is_large = path.stat().st_size > LARGE
            if not is_large:
                self._look(self._anchor)
            self._anchor.execute("PRAGMA journal_mode=WAL")
            self._anchor.execute("SELECT count(*) FROM sqlite_schema").fetchone()
            self._known = [_identity(name) for name in self._paths]
            if is_large:
                self._looker.start()
        except DatabaseError:
            self._anchor.close()
            raise
        except sqlite3.Error as error:
            self._anchor.close()
            raise self._damaged([str(error)]) if _is_corrupt(error) else DatabaseError(f"{path}: {error}") from None

    def check(self) -> None:
        """Raise OperationalError when what is open is damaged, or not what is there: what is written would be lost."""
        if self._damage:
            raise OperationalError(None, None, sqlite3.DatabaseError(self._damage))
        for name, known in zip(self._paths, self._known, strict=True):
            if _identity(name) != known:
                reason = sqlite3.OperationalError(f"{name} was deleted or replaced; restart the server")
                raise OperationalError(None, None, reason)

    def _look(self, connection: sqlite3.Connection) -> None:
        """Raise DatabaseError for a damaged file, and sqlite3.Error."""
        found = []
        try:
            found += [row[0] for row in connection.execute(f"PRAGMA quick_check({FAULTS})")]
        except sqlite3.Error as error:  # so damaged that the check itself ended
            if not _is_corrupt(error):
                raise
            found.append(str(error))
        if found != ["ok"]:
            raise self._damaged(found)

    def _damaged(self, faults: Sequence[str]) -> DatabaseError:
        told = "; ".join("; ".join(faults).splitlines())[:TOLD]
        return DatabaseError(f"{self._path} is damaged: {told}; restore a backup")

    def _look_later(self) -> None:
        """Look while the server answers; from then on it answers no more when there is damage."""
        address = f"{self._path.absolute().as_uri()}?mode=ro"
        try:
            with closing(sqlite3.connect(address, uri=True, check_same_thread=False)) as self._reader:
                self._look(self._reader)
        except (sqlite3.DatabaseError, DatabaseError) as error:
            if str(error) != "interrupted":
                self._damage = str(error)
                _log.exception("the store is damaged")

    def close(self) -> None:
        """Close the connection that keeps the log."""
        while self._looker.is_alive():
            if self._reader is not None:
                with suppress(sqlite3.ProgrammingError):  # it has just closed it
                    self._reader.interrupt()
            self._looker.join(0.1)
        self._anchor.close()


def _is_corrupt(error: sqlite3.Error) -> bool:
    """Whether this is about what the file has in it; extended codes have the primary one in their last byte."""
    return getattr(error, "sqlite_errorcode", 0) & 0xFF == sqlite3.SQLITE_CORRUPT


def _identity(path: Path) -> tuple[int, int] | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_dev, found.st_ino
