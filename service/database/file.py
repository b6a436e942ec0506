"""The file of an SQLite store: one server's alone, for its owner's eyes, whole, and still there."""

from __future__ import annotations

import fcntl
import os
import sqlite3
import sys
from contextlib import suppress
from pathlib import Path

from sqlalchemy.exc import OperationalError

PRIVATE = 0o600
FAULTS, TOLD = 3, 300  # of a damaged file that are named, and in how many characters


class DatabaseError(Exception):
    """A database that cannot be used; the message says which and why."""


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
        try:
            self._lock = sqlite3.connect(beside, timeout=0, isolation_level=None, check_same_thread=False)
        except sqlite3.OperationalError as error:
            raise DatabaseError(f"cannot open {beside}: {error}") from None
        try:
            make_private(beside)
            self._lock.execute("BEGIN EXCLUSIVE")
            self._file = _locked(self.path)
        except (sqlite3.OperationalError, BlockingIOError):
            self._lock.close()
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
    """Notices when the file, or the log that SQLite keeps beside it, is deleted or replaced while it is open."""

    def __init__(self, path: Path) -> None:
        """Raises DatabaseError for a damaged file."""
        self._paths = [path, path.with_name(f"{path.name}-wal")]
        # as long as one connection is open, nobody removes the log
        self._anchor = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
        try:
            found = [row[0] for row in self._anchor.execute(f"PRAGMA quick_check({FAULTS})")]
            if found != ["ok"]:
                told = "; ".join("; ".join(found).splitlines())[:TOLD]
                raise DatabaseError(f"{path} is damaged: {told}; restore a backup")
            self._anchor.execute("PRAGMA journal_mode=WAL")
            self._anchor.execute("SELECT count(*) FROM sqlite_schema").fetchone()
            self._known = [_identity(name) for name in self._paths]
        except (sqlite3.Error, DatabaseError) as error:
            self._anchor.close()
            raise DatabaseError(str(error) if isinstance(error, DatabaseError) else f"{path}: {error}") from None

    def check(self) -> None:
        """Raise OperationalError when what is open is not what is there: what is written would be lost."""
        for name, known in zip(self._paths, self._known, strict=True):
            if _identity(name) != known:
                reason = sqlite3.OperationalError(f"{name} was deleted or replaced; restart the server")
                raise OperationalError(None, None, reason)

    def close(self) -> None:
        """Close the connection that keeps the log."""
        self._anchor.close()


def _identity(path: Path) -> tuple[int, int] | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_dev, found.st_ino
