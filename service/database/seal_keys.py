"""The files of the keys of seals: see :mod:`service.database.seals`."""

from __future__ import annotations

import os
import secrets
from contextlib import suppress
from pathlib import Path

from service.database.file import PRIVATE, DatabaseError

BYTES = 32


def key_beside(file: Path) -> bytes:
    """The key of an SQLite store, made when there is none. Raises DatabaseError."""
    path = file.resolve()
    path = path.with_name(f"{path.name}.key")
    try:
        if not path.exists():
            _make(path)
    except OSError as error:
        raise DatabaseError(f"cannot use {path}: {error.strerror}") from None
    return key_in(path)


def key_in(path: Path) -> bytes:
    """The key in a file. Raises DatabaseError."""
    try:
        key = path.read_bytes()
    except FileNotFoundError:
        how = f"make one for all servers of the store: head -c {BYTES} /dev/urandom > {path}"
        raise DatabaseError(f"there is no key of seals {path}; {how}") from None
    except OSError as error:
        raise DatabaseError(f"cannot use {path}: {error.strerror}") from None
    if len(key) != BYTES:
        raise DatabaseError(f"{path} is no key; remove it, and all of the store is derived anew")
    return key


def _make(path: Path) -> None:
    """A new key, complete when it appears; that of another process stays."""
    new = path.with_name(f"{path.name}.{os.getpid()}.{secrets.token_hex(4)}")
    with os.fdopen(os.open(new, os.O_CREAT | os.O_EXCL | os.O_WRONLY, PRIVATE), "wb") as file:
        file.write(secrets.token_bytes(BYTES))
        file.flush()
        os.fsync(file.fileno())
    with suppress(FileExistsError):
        os.link(new, path)
    new.unlink()
