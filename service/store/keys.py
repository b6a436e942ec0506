"""API keys: ``sub_<id>_<secret>``, stored as a hash, with owner, scopes and expiry; and sessions of pages.

A server on loopback is open while it has no key that counts: revoked ones do not, so that it is open again when the
last one is; expired ones do, so that no server opens by itself.
"""

from __future__ import annotations

import hmac
import re
import secrets
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from datetime import timedelta

from service.database.connections import Connection, Database
from service.messages.refusals import Refused
from service.messages.viewer import ANYBODY, CONSOLE, OPEN, SCOPES, Viewer
from service.queries import audit, keys, sessions
from service.queries.common import now
from service.store.authorisations import Credentials, hashed

PREFIX = "sub"
OWNER = r"[a-z0-9][a-z0-9-]{0,63}"
DAYS = 36_500  # that a key may last
SESSION = timedelta(hours=12)
LENT = 1 / 24  # days of a key that is removed before
HEADER = "the header 'Authorization: Bearer sub_...'"


def create(
    connection: Connection,
    label: str,
    scopes: Sequence[str],
    days: float | None = None,
    owner: str = OPEN,
    viewer: Viewer | None = None,
) -> str:
    """Store a new key and return its text, which cannot be had again. Raises ValueError for an unknown scope."""
    unknown = sorted(set(scopes) - set(SCOPES))
    if unknown or not scopes:
        raise ValueError(f"unknown scope '{', '.join(unknown)}'; there are {', '.join(SCOPES)}")
    if not re.fullmatch(OWNER, owner):
        raise ValueError(f"'{owner}' is no owner: up to 64 of a to z, 0 to 9 and '-', the first no '-'")
    if days is not None and not 0 < days <= DAYS:
        raise ValueError(
            f"a key expires after more than 0 and at most {DAYS} days; without a number of days it never does"
        )
    expires = None if days is None else now(timedelta(days=days))
    granted = " ".join(dict.fromkeys(scopes))
    return _add(connection, keys.ApiKey("", "", label, granted, now(), expires, None, owner), "key.create", viewer)


def rotate(connection: Connection, identifier: str, hours: float = 0.0, viewer: Viewer | None = None) -> str:
    """A new key in the place of another, which is revoked, or expires after some hours. Raises ValueError."""
    old = required(connection, identifier)
    if old.revoked:
        raise ValueError(f"the key '{identifier}' is revoked; create another")
    if hours > 0:
        expires = now(timedelta(hours=hours))
        keys.expire_key(connection, identifier, min(expires, old.expires or expires))
    else:
        keys.revoke_key(connection, identifier)
    return _add(connection, replace(old, created=now()), "key.rotate", viewer, replaced=identifier)


def _add(connection: Connection, key: keys.ApiKey, action: str, viewer: Viewer | None, **detail: str) -> str:
    identifier, secret = secrets.token_hex(6), secrets.token_urlsafe(32)
    keys.add_key(connection, replace(key, id=identifier, secret_hash=hashed(secret)))
    told = {"owner": key.owner, "scopes": key.scopes.split(), "expires": key.expires, **detail}
    audit.note(connection, viewer or _console(key.owner), action, f"key {identifier}", **told)
    return f"{PREFIX}_{identifier}_{secret}"


def revoke(connection: Connection, identifier: str, viewer: Viewer | None = None) -> bool:
    """Revoke a key; whether any is left that counts. Raises ValueError where there is none of this id."""
    key = required(connection, identifier)
    keys.revoke_key(connection, identifier)
    audit.note(connection, viewer or _console(key.owner), "key.revoke", f"key {identifier}")
    return keys.any_key(connection)


def delete(connection: Connection, identifier: str, viewer: Viewer | None = None) -> None:
    """Remove a key that is revoked. Raises ValueError."""
    key = required(connection, identifier)
    if not key.revoked:
        raise ValueError(f"the key '{identifier}' is in use; revoke it first")
    sessions.end_all(connection, identifier)
    keys.delete_key(connection, identifier)
    audit.note(connection, viewer or _console(key.owner), "key.delete", f"key {identifier}")


@contextmanager
def lent(url: str) -> Iterator[str | None]:
    """A key for the commands that work on a store while the block lasts; None for a store without keys."""
    database = Database(url, exclusive=False)
    try:
        with database.read() as connection:
            is_open = not keys.any_key(connection)
        if is_open:
            yield None
            return
        with database.write() as connection:
            text = create(connection, "a command on the store", SCOPES, LENT, CONSOLE)
        try:
            yield text
        finally:
            with database.write() as connection:
                identifier = text.split("_")[1]
                revoke(connection, identifier)
                delete(connection, identifier)
    finally:
        database.close()


def required(connection: Connection, identifier: str) -> keys.ApiKey:
    """The key of an id. Raises ValueError."""
    key = keys.get_key(connection, identifier)
    if key is None:
        raise ValueError(f"there is no key '{identifier}'; 'substructures key list' shows all")
    return key


def _console(owner: str) -> Viewer:
    return Viewer(CONSOLE, owner, SCOPES)


def authenticate(connection: Connection, given: Credentials, is_loopback: bool) -> Viewer:
    """Who asks. Raises Refused 401: no key, one that is none, an expired or a revoked one, or no session any more.

    Without any key that counts everybody may do everything on loopback, and nobody anything elsewhere.
    """
    if not keys.any_key(connection):
        if is_loopback:
            return ANYBODY
        raise _denied("key-missing", "all API keys are revoked; create one with 'substructures key create'")
    if given.authorization:
        return _viewer(_of_header(connection, given.authorization))
    if given.session:
        return _viewer(_of_session(connection, given.session))
    raise _denied("key-missing", f"this server asks for an API key: send it in {HEADER}")


def sign_in(connection: Connection, token: str) -> tuple[str, Viewer]:
    """Begin a session with the text of a key: the value of its cookie, and who it is. Raises Refused 401."""
    key = _of_header(connection, f"Bearer {token}")
    value, expires = secrets.token_urlsafe(32), now(SESSION)
    sessions.add_session(connection, hashed(value), key.id, min(expires, key.expires or expires))
    audit.note(connection, _viewer(key), "session.begin", f"key {key.id}")
    return value, _viewer(key)


def sign_out(connection: Connection, session: str) -> None:
    """End a session."""
    sessions.end(connection, hashed(session))


def _of_header(connection: Connection, authorization: str) -> keys.ApiKey:
    kind, _, token = authorization.partition(" ")
    fields = token.strip().split("_", 2)
    if kind.lower() != "bearer" or len(fields) != 3 or fields[0] != PREFIX:
        raise _denied("key-unknown", f"this is no API key: what is needed is {HEADER}")
    key = keys.get_key(connection, fields[1])
    if key is None or not hmac.compare_digest(key.secret_hash, hashed(fields[2])):
        raise _denied("key-unknown", "the API key in the header Authorization is not one of this server")
    return _in_force(key)


def _of_session(connection: Connection, session: str) -> keys.ApiKey:
    found = sessions.find(connection, hashed(session))
    key = None if found is None or found.expires <= now() else keys.get_key(connection, found.key)
    if key is None:
        raise _denied("session-expired", "you are signed out; sign in with an API key")
    return _in_force(key)


def _in_force(key: keys.ApiKey) -> keys.ApiKey:
    if key.revoked:
        raise _denied("key-revoked", f"the API key {key.id} in the header Authorization was revoked on {key.revoked}")
    if key.expires is not None and key.expires <= now():
        raise _denied("key-expired", f"the API key {key.id} in the header Authorization expired on {key.expires}")
    return key


def _viewer(key: keys.ApiKey) -> Viewer:
    return Viewer(key.id, key.owner, tuple(key.scopes.split()))


def _denied(code: str, detail: str) -> Refused:
    return Refused(401, code, detail, headers={"WWW-Authenticate": "Bearer"})
