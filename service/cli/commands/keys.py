"""The command ``key``: API keys of a database."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict
from typing import Annotated

import typer

from service import keys
from service.cli.options import Json, Store, settings
from service.cli.output import print_json, table
from service.database.connections import Connection, Database, DatabaseError
from service.queries.common import now
from service.queries.keys import ApiKey, list_keys
from service.viewer import OPEN, SCOPES

Id = Annotated[str, typer.Argument(metavar="ID", parser=lambda text: _id(text))]


def _id(text: str) -> str:
    """The id, also of a whole key, whose secret is not for messages."""
    return text.split("_")[1] if text.startswith(f"{keys.PREFIX}_") else text


@contextmanager
def _database(url: str | None) -> Iterator[Database]:
    database = Database(settings(database=url).database, exclusive=False)
    try:
        yield database
    finally:
        database.close()


@contextmanager
def _writing(url: str | None) -> Iterator[Connection]:
    with _database(url) as database, database.write() as connection:
        yield connection


def create(
    owner: Annotated[str, typer.Option(help="Whose it is: a person or a team.")] = OPEN,
    label: Annotated[str, typer.Option(help="What it is for.")] = "",
    scope: Annotated[list[str] | None, typer.Option(help=f"{', '.join(SCOPES)}; may be repeated (read).")] = None,
    days: Annotated[float | None, typer.Option(help="Days until it expires (never).")] = None,
    database: Store = None,
    json: Json = False,
) -> int:
    """Create a key and print it once; the store, too, if there is none yet."""
    with suppress(DatabaseError):  # a server has it
        Database(settings(database=database).database).close()
    with _writing(database) as connection:
        key = keys.create(connection, label, scope or ["read"], days, owner)
    _print(key, json)
    return 0


def show(database: Store = None, json: Json = False) -> int:
    """List all keys."""
    with _database(database) as opened, opened.read() as connection:
        found = list_keys(connection)
    if json:
        print_json([{name: x for name, x in asdict(key).items() if name != "secret_hash"} for key in found])
        return 0
    if not found:
        advice = "'substructures key create --owner TEAM --scope admin' makes the first"
        print(
            f"there are no keys, so the server is open to all of this machine, and to no other; {advice}",
            file=sys.stderr,
        )
        return 0
    rows = [(key.id, key.owner, key.scopes, key.created[:10], _state(key), key.label) for key in found]
    table(("id", "owner", "scopes", "created", "state", "label"), rows)
    return 0


def _state(key: ApiKey) -> str:
    """Until when a key works, or since when it does not, by day."""
    if key.revoked:
        return f"revoked {key.revoked[:10]}"
    if key.expires is None:
        return "never expires"
    return f"{'expired' if key.expires <= now() else 'expires'} {key.expires[:10]}"


def _print(key: str, as_json: bool) -> None:
    if as_json:
        print_json({"id": key.split("_")[1], "key": key})
    else:
        print(key)


def rotate(
    id: Id,  # noqa: A002 -- name of the argument
    hours: Annotated[float, typer.Option(help="So long the old one still works.")] = 0.0,
    database: Store = None,
    json: Json = False,
) -> int:
    """Put a new key in the place of one, and print it once."""
    with _writing(database) as connection:
        key = keys.rotate(connection, id, hours)
    _print(key, json)
    return 0


def revoke(id: Id, database: Store = None, json: Json = False) -> int:  # noqa: A002 -- name of the argument
    """Revoke a key."""
    with _writing(database) as connection:
        is_closed = keys.revoke(connection, id)
    if json:
        print_json({"revoked": id, "keys_left": is_closed})
    if not is_closed:
        print("that was the last key: on loopback the server is open to all of this machine now", file=sys.stderr)
    return 0


def delete(id: Id, database: Store = None, json: Json = False) -> int:  # noqa: A002 -- name of the argument
    """Remove a key that is revoked."""
    with _writing(database) as connection:
        keys.delete(connection, id)
    if json:
        print_json({"deleted": id})
    return 0


COMMANDS = {"key": {"create": create, "list": show, "rotate": rotate, "revoke": revoke, "delete": delete}}
