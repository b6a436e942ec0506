"""The command ``key``: API keys of a database."""

from __future__ import annotations

import argparse

from service import keys
from service.cli.options import Add, add_action, add_database, settings_of
from service.database.connections import Database
from service.queries.keys import list_keys, revoke_key


def _add_key(key: argparse.ArgumentParser) -> None:
    actions = key.add_subparsers(title="actions", required=True, metavar="ACTION")
    command = add_action(actions, "create", _create_key, "create a key and print it once")
    command.add_argument("--label", default="", help="what it is for")
    command.add_argument("--scope", action="append", choices=keys.SCOPES, help="may be repeated (read)")
    command.add_argument("--days", type=float, help="days until it expires (never)")
    add_database(command)
    add_database(add_action(actions, "list", _list_keys, "list all keys"))
    command = add_action(actions, "revoke", _revoke_key, "revoke a key")
    command.add_argument("id")
    add_database(command)


def _create_key(options: argparse.Namespace) -> int:
    database = Database(settings_of(options).database, exclusive=False)
    with database.write() as connection:
        key = keys.create(connection, options.label, options.scope or ["read"], options.days)
    database.close()
    print(key)
    return 0


def _list_keys(options: argparse.Namespace) -> int:
    database = Database(settings_of(options).database, exclusive=False)
    with database.read() as connection:
        for key in list_keys(connection):
            state = f"revoked {key.revoked}" if key.revoked else f"expires {key.expires or 'never'}"
            print(f"{key.id}  {key.scopes}  created {key.created}  {state}  {key.label}")
    database.close()
    return 0


def _revoke_key(options: argparse.Namespace) -> int:
    database = Database(settings_of(options).database, exclusive=False)
    with database.write() as connection:
        known = revoke_key(connection, options.id)
    database.close()
    if not known:
        raise ValueError(f"there is no key '{options.id}'")
    return 0


ADD: Add = {"key": _add_key}
