"""Seals: what this server has derived and stored carries one, which nobody can make who has the database alone.

A seal is an HMAC (RFC 2104) with SHA-256 over all that is stored of a part or of a revision of a tree, so that each of
its figures is bound to its document and to its program. The key of an SQLite store is in a file beside it, which is
made with it: a file that comes from elsewhere comes without, and a digit that was changed breaks the seal. Servers that
share a PostgreSQL database are given one in common (``SUBSTRUCTURES_SEAL_KEY``); without, a seal there shows damage
alone.
"""

from __future__ import annotations

import hmac
import os
import secrets
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

import orjson
from sqlalchemy import Connection

from service.database.file import PRIVATE, DatabaseError

BYTES = 32
KEY = "seal key"  # of the information of a connection


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


def seal(connection: Connection, values: Iterable[Any]) -> str:
    """The seal of values as they are stored: texts, numbers, None."""
    key: bytes = connection.info.get(KEY, b"")
    return hmac.digest(key, orjson.dumps(list(values)), "sha256").hex()
