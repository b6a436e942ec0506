"""The command ``key``: API keys of a database."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from service import keys
from service.cli.options import Add, add_action, add_database, settings_of
from service.database.connections import Connection, Database
from service.queries.keys import list_keys
from service.viewer import OPEN, SCOPES


def _add_key(key: argparse.ArgumentParser) -> None:
    actions = key.add_subparsers(title="actions", required=True, metavar="ACTION")
    command = add_action(actions, "create", _create_key, "create a key and print it once")
    command.add_argument("--owner", default=OPEN, help=f"whose it is: a person or a team ({OPEN})")
    command.add_argument("--label", default="", help="what it is for")
    command.add_argument("--scope", action="append", choices=SCOPES, help="may be repeated (read)")
    command.add_argument("--days", type=float, help="days until it expires (never)")
    add_database(command)
    add_database(add_action(actions, "list", _list_keys, "list all keys"))
    command = add_action(actions, "rotate", _rotate_key, "put a new key in the place of one, and print it once")
    command.add_argument("id")
    command.add_argument("--hours", type=float, default=0.0, help="so long the old one still works (0)")
    add_database(command)
    command = add_action(actions, "revoke", _revoke_key, "revoke a key")
    command.add_argument("id")
    add_database(command)
    command = add_action(actions, "delete", _delete_key, "remove a key that is revoked")
    command.add_argument("id")
    add_database(command)


@contextmanager
def _database(options: argparse.Namespace) -> Iterator[Database]:
    database = Database(settings_of(options).database, exclusive=False)
    try:
        yield database
    finally:
        database.close()


@contextmanager
def _writing(options: argparse.Namespace) -> Iterator[Connection]:
    with _database(options) as database, database.write() as connection:
        yield connection


def _create_key(options: argparse.Namespace) -> int:
    with _writing(options) as connection:
        key = keys.create(connection, options.label, options.scope or ["read"], options.days, options.owner)
    print(key)
    return 0


def _list_keys(options: argparse.Namespace) -> int:
    with _database(options) as database, database.read() as connection:
        for key in list_keys(connection):
            state = f"revoked {key.revoked}" if key.revoked else f"expires {key.expires or 'never'}"
            print(f"{key.id}  {key.owner}  {key.scopes}  created {key.created}  {state}  {key.label}")
    return 0


def _rotate_key(options: argparse.Namespace) -> int:
    with _writing(options) as connection:
        key = keys.rotate(connection, options.id, options.hours)
    print(key)
    return 0


def _revoke_key(options: argparse.Namespace) -> int:
    with _writing(options) as connection:
        is_closed = keys.revoke(connection, options.id)
    if not is_closed:
        print("that was the last key: on loopback the server is open to all of this machine now", file=sys.stderr)
    return 0


def _delete_key(options: argparse.Namespace) -> int:
    with _writing(options) as connection:
        keys.delete(connection, options.id)
    return 0


ADD: Add = {"key": _add_key}
