"""The command ``substructures``."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import httpx2
from sqlalchemy.exc import DBAPIError

from service import __version__, keys, logs
from service.app import bare_app
from service.cli import demo, jobs
from service.cli.analysis import add_commands
from service.cli.progress import follow
from service.database.connections import Database, DatabaseError, told
from service.database.migrate import MigrationError
from service.http import openapi
from service.queries.keys import list_keys, revoke_key
from service.refusals import Refused
from service.server import serve, work
from service.settings import Settings, SettingsError, from_environment
from substructures.client import Client, ProblemError
from substructures.errors import InvalidInput, SubstructuresError
from substructures.part.alone import lean
from substructures.part.definition import Definition
from substructures.part.part import derive
from substructures.printers import FORMATS, render

EXPECTED = (SubstructuresError, SettingsError, DatabaseError, MigrationError, ProblemError, Refused)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; 0 when it succeeded, 1 when it did not, 2 when it was called wrongly."""
    options = _parser().parse_args(arguments)
    command: Callable[[argparse.Namespace], int] = options.command
    try:
        return command(options)
    except InvalidInput as error:
        for fault in error.faults:
            _complain(f"{fault.pointer or '/'}: {fault.message}")
    except (*EXPECTED, ValueError, OverflowError) as error:
        _complain(str(error))
    except DBAPIError as error:
        _complain(f"the database refused: {told(error)}")
    except httpx2.HTTPError as error:
        _complain(f"no answer from the server: {error}")
    except OSError as error:
        _complain(f"{error.filename or 'error'}: {error.strerror or error}")
    except KeyboardInterrupt:
        return 130
    return 1


def _complain(message: str) -> None:
    print(f"substructures: {message}", file=sys.stderr)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="substructures", description="Couple stored formulas of mechanisms.")
    parser.add_argument("--version", action="version", version=__version__)
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")

    command = _add(commands, "serve", _serve, "run the service (settings also from SUBSTRUCTURES_* variables)")
    command.add_argument("--host", help="address to listen on (127.0.0.1)")
    command.add_argument("--port", type=int, help="port to listen on (8000)")
    _add_engine(command)
    _add_database(command)

    command = _add(commands, "worker", _worker, "compute the jobs of servers that share a PostgreSQL database")
    _add_engine(command)
    _add_database(command)

    _add(commands, "demo", _demo, "couple a gripper onto a Puma 560 over HTTP and compare with published numbers")

    command = _add(commands, "derive", _derive, "derive and verify a definition here, without a server")
    command.add_argument("file", type=Path, help="definition, JSON or YAML")
    command.add_argument("--show", metavar="QUANTITY", help="print this stored quantity, e.g. metric")
    command.add_argument("--format", choices=sorted(FORMATS), default="text")

    command = _add(commands, "submit", _submit, "submit a definition to a server")
    command.add_argument("file", type=Path, help="definition, JSON or YAML")
    command.add_argument("--wait", action="store_true", help="wait where it takes so long that it becomes a job")
    jobs.add_server(command)

    jobs.register(commands, _add, _add_database)
    add_commands(commands, _add)
    _add(commands, "openapi", _openapi, "print the OpenAPI document")
    _add_key_commands(commands)
    return parser


def _add_key_commands(commands: Any) -> None:
    key = commands.add_parser("key", help="manage API keys")
    actions = key.add_subparsers(title="actions", required=True, metavar="ACTION")
    command = _add(actions, "create", _create_key, "create a key and print it once")
    command.add_argument("--label", default="", help="what it is for")
    command.add_argument("--scope", action="append", choices=keys.SCOPES, help="may be repeated (read)")
    command.add_argument("--days", type=float, help="days until it expires (never)")
    _add_database(command)
    _add_database(_add(actions, "list", _list_keys, "list all keys"))
    command = _add(actions, "revoke", _revoke_key, "revoke a key")
    command.add_argument("id")
    _add_database(command)


def _add(commands: Any, name: str, run: Callable[[argparse.Namespace], int], text: str) -> argparse.ArgumentParser:
    command: argparse.ArgumentParser = commands.add_parser(name, help=text, description=text)
    command.set_defaults(command=run)
    return command


def _add_database(command: argparse.ArgumentParser) -> None:
    default = Settings().database
    command.add_argument("--database", help=f"URL: sqlite:///FILE or postgresql://... ({default})")


def _add_engine(command: argparse.ArgumentParser) -> None:
    command.add_argument("--engine", choices=("local", "dask", "none"), help="what computes jobs (local)")
    command.add_argument("--engine-address", help="the scheduler of a Dask cluster, tcp://...")
    command.add_argument("--workers", type=int, help="processes that compute jobs (one per core)")


def _settings(options: argparse.Namespace) -> Settings:
    names = ("host", "port", "database", "engine", "engine_address", "workers")
    return from_environment(os.environ, **{name: getattr(options, name, None) for name in names})


def _serve(options: argparse.Namespace) -> int:
    logs.configure()
    serve(_settings(options))
    return 0


def _worker(options: argparse.Namespace) -> int:
    logs.configure()
    work(_settings(options))
    return 0


def _demo(_: argparse.Namespace) -> int:
    return demo.run()


def _derive(options: argparse.Namespace) -> int:
    part = derive(Definition.read(jobs.read_document(options.file)))
    if options.show:
        names = [n for n in part.program.outputs if n == options.show or n.startswith(f"{options.show}.")]
        if not names:
            raise ValueError(f"there is no quantity '{options.show}'; there are {', '.join(part.program.outputs)}")
        print(render(lean(part, part.program.select(names)), options.format))
        return 0
    print(f"{part.name}: {part.dof} coordinates ({part.joints or 'none'}), bodies {', '.join(part.bodies)}")
    for title, figures in (("operations", part.operations), ("certificate", part.certificate)):
        print(f"{title}:")
        for name, figure in figures.items():
            print(f"  {name}: {figure}")
    print(f"digest: {part.definition.digest}")
    return 0


def _submit(options: argparse.Namespace) -> int:
    with Client(options.server, options.key) as client:
        answer = client.request("POST", "/v1/substructures", jobs.read_document(options.file))
        version = answer.json()
        if answer.status_code == 202:
            print(f"became the job {version['id']}")
            return follow(client, version["id"]) if options.wait else 0
    stored = "stored" if answer.status_code == 201 else "was stored already"
    print(f"{version['name']}@{version['version']} {stored}, {version['digest']}")
    return 0


def _openapi(_: argparse.Namespace) -> int:
    sys.stdout.write(openapi.text(bare_app()))
    return 0


def _create_key(options: argparse.Namespace) -> int:
    database = Database(_settings(options).database, exclusive=False)
    with database.write() as connection:
        key = keys.create(connection, options.label, options.scope or ["read"], options.days)
    database.close()
    print(key)
    return 0


def _list_keys(options: argparse.Namespace) -> int:
    database = Database(_settings(options).database, exclusive=False)
    with database.read() as connection:
        for key in list_keys(connection):
            state = f"revoked {key.revoked}" if key.revoked else f"expires {key.expires or 'never'}"
            print(f"{key.id}  {key.scopes}  created {key.created}  {state}  {key.label}")
    database.close()
    return 0


def _revoke_key(options: argparse.Namespace) -> int:
    database = Database(_settings(options).database, exclusive=False)
    with database.write() as connection:
        known = revoke_key(connection, options.id)
    database.close()
    if not known:
        raise ValueError(f"there is no key '{options.id}'")
    return 0


if __name__ == "__main__":
    sys.exit(main())
