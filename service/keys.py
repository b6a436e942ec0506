"""API keys: ``sub_<id>_<secret>``, stored as a hash, with scopes and expiry."""

from __future__ import annotations

import hashlib
import hmac
import secrets
from collections.abc import Sequence
from datetime import timedelta
from time import monotonic

from service.database.connections import Connection
from service.queries import keys
from service.queries.common import now
from service.refusals import Refused

SCOPES = ("read", "write", "jobs", "admin")
PREFIX = "sub"
REMEMBERED = 1000  # authorisations in memory
OPEN = "local"  # the principal of a server without keys


def create(connection: Connection, label: str, scopes: Sequence[str], days: float | None) -> str:
    """Store a new key and return its text, which cannot be had again. Raises ValueError for an unknown scope."""
    unknown = sorted(set(scopes) - set(SCOPES))
    if unknown or not scopes:
        raise ValueError(f"unknown scope '{', '.join(unknown)}'; there are {', '.join(SCOPES)}")
    identifier, secret = secrets.token_hex(6), secrets.token_urlsafe(32)
    expires = None if days is None else now(timedelta(days=days))
    granted = " ".join(dict.fromkeys(scopes))
    keys.add_key(connection, keys.ApiKey(identifier, _hash(secret), label, granted, now(), expires, None))
    return f"{PREFIX}_{identifier}_{secret}"


class Authorisations:
    """Who was authorised a moment ago, so that most requests need no transaction for it.

    A key that is revoked, expires or is the first one of a server takes effect at most ``seconds`` later.
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._known: dict[tuple[str, str], tuple[float, str]] = {}

    def get(self, authorization: str | None, scope: str) -> str | None:
        """The principal, or None when it has to be looked up."""
        until, principal = self._known.get((_hash(authorization or ""), scope), (0.0, ""))
        return principal if monotonic() < until else None

    def put(self, authorization: str | None, scope: str, principal: str) -> None:
        """Remember an authorisation that was given."""
        if len(self._known) >= REMEMBERED:
            self._known.clear()
        self._known[_hash(authorization or ""), scope] = monotonic() + self.seconds, principal


def authorise(connection: Connection, authorization: str | None, scope: str) -> str:
    """The principal (key id) of a request that may do what ``scope`` allows. Raises Refused 401 or 403.

    Without any key in the store everybody may do everything: such a server listens on loopback only.
    """
    if not keys.any_key(connection):
        return OPEN
    key = _known(connection, authorization or "")
    if key is None:
        raise Refused(401, "unauthorized", "a valid API key is needed", headers={"WWW-Authenticate": "Bearer"})
    granted = key.scopes.split()
    if scope not in granted and "admin" not in granted:
        raise Refused(403, "forbidden", f"this API key lacks the scope '{scope}'")
    return key.id


def _known(connection: Connection, authorization: str) -> keys.ApiKey | None:
    kind, _, token = authorization.partition(" ")
    fields = token.strip().split("_", 2)
    if kind.lower() != "bearer" or len(fields) != 3 or fields[0] != PREFIX:
        return None
    key = keys.get_key(connection, fields[1])
    if key is None or not hmac.compare_digest(key.secret_hash, _hash(fields[2])):
        return None
    return None if key.revoked or (key.expires is not None and key.expires <= now()) else key


def _hash(secret: str) -> str:
    # The secret has 256 random bits, so one round of a fast hash is enough.
    return hashlib.sha256(secret.encode()).hexdigest()
