"""Seals: what this server has derived, computed or answered carries one, which nobody can make who has the database
alone.

A seal is an HMAC (RFC 2104) with SHA-256 over all that is stored of a part, a revision of a tree or a result, so that
each of its figures is bound to its document and to its program. The key of an SQLite store is in a file beside it,
which is made with it: a file that comes from elsewhere comes without, and a digit that was changed breaks the seal.
Servers that share a PostgreSQL database are given one in common (``SUBSTRUCTURES_SEAL_KEY``); without, a seal there
shows damage alone.
"""

from __future__ import annotations

import hmac
from collections.abc import Iterable
from typing import Any

import orjson
from sqlalchemy import Connection

KEY = "seal key"  # of the information of a connection


def seal(connection: Connection, values: Iterable[Any]) -> str:
    """The seal of values as they are stored: texts, numbers, None."""
    key: bytes = connection.info.get(KEY, b"")
    return hmac.digest(key, orjson.dumps(list(values), default=repr), "sha256").hex()
