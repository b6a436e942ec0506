"""The command ``doctor``: what is installed, which store, keys and kernels there are, and what is wrong with them."""

from __future__ import annotations

import os
import platform
import shutil
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import httpx2
from sqlalchemy.exc import DBAPIError

from service import __version__
from service.cli.address import SERVER, kept, kept_in
from service.cli.options import Json, Server, settings, with_server
from service.cli.output import console, print_json
from service.database.connections import Database, DatabaseError, told
from service.queries.keys import list_keys
from service.settings import Settings, SettingsError
from substructures.client.problems import ProblemError
from substructures.errors import SubstructuresError

#: packages that are not needed, and what they are for
OPTIONAL = {
    "llvmlite": "numbers at machine speed",
    "psycopg": "PostgreSQL",
    "distributed": "Dask clusters",
    "pyarrow": "Arrow streams",
    "usd-core": "USD files",
    "ziglang": "FMUs for other systems",
}
COMPILERS = ("cc", "gcc", "clang", "cl")
LEAST_FREE = 2**30  # bytes
#: a line of the report: subject, what is found, whether it is wrong
Line = tuple[str, str, bool]


@with_server
def doctor(server: Server, json: Json = False) -> int:
    """Say what is installed, which store, keys and kernels there are, and what is wrong; 1 if anything is."""
    found = [*_installed(), *_configured(server), *_stored(server.database), *_served(server)]
    if json:
        print_json([{"subject": subject, "found": text, "wrong": wrong} for subject, text, wrong in found])
    else:
        width = max(len(subject) for subject, _, _ in found)
        for subject, text, wrong in found:
            console().print(f"{subject:<{width}}  {'WRONG: ' if wrong else ''}{text}", style="red" if wrong else None)
    return int(any(wrong for _, _, wrong in found))


def _installed() -> Iterator[Line]:
    yield "substructures", f"{__version__} in {Path(__file__).parents[3]}", False
    yield "Python", f"{platform.python_version()} ({sys.executable}), {platform.system()} {platform.machine()}", False
    for name, purpose in OPTIONAL.items():
        try:
            yield name, version(name), False
        except PackageNotFoundError:
            yield name, f"not installed ({purpose})", False
    compiler = next((path for name in COMPILERS if (path := shutil.which(name))), None)
    yield "C compiler", compiler or "none (FMUs come as sources)", False


def _configured(server: Server) -> Iterator[Line]:
    try:
        known = kept()
    except SettingsError as error:
        yield "client file", str(error), True
        return
    what = f"keys of {len(known.get('keys', {}))} servers" if known else "there is none"
    yield "client file", f"{kept_in()} ({what})", False
    yield "server", server.address or known.get("server") or SERVER, False


def _stored(url: str | None) -> Iterator[Line]:
    try:
        found = settings(database=url)
    except SettingsError as error:
        yield "settings", str(error), True
        return
    yield "engine of jobs", found.engine + (f" at {found.engine_address}" if found.engine_address else ""), False
    yield from _folders(found)
    if found.database.startswith("sqlite") and not Path(found.database.removeprefix("sqlite:///")).exists():
        yield "store", f"{found.database} (there is none yet; 'substructures serve' makes one)", False
        return
    try:
        yield from _in_store(found)
    except (DatabaseError, DBAPIError) as error:
        message = told(error) if isinstance(error, DBAPIError) else str(error)
        yield "store", f"{found.database}: {message}", True


def _folders(found: Settings) -> Iterator[Line]:
    folder = found.kernel_folder
    if folder is None:
        yield "kernels", "none are kept", False
    else:
        files = [path.stat().st_size for path in folder.rglob("*") if path.is_file()] if folder.exists() else []
        yield "kernels", f"{folder}: {len(files)} files, {sum(files) / 2**20:.1f} MiB", False
    place = Path(found.database.removeprefix("sqlite:///")).absolute().parent
    place = place if found.database.startswith("sqlite") and place.exists() else Path.cwd()
    free = shutil.disk_usage(place).free
    yield "disk", f"{free / 2**30:.1f} GiB free at {place}", free < LEAST_FREE
    if not os.access(place, os.W_OK):
        yield "disk", f"{place} cannot be written to", True


def _in_store(found: Settings) -> Iterator[Line]:
    database = Database(found.database, exclusive=False)
    try:
        with database.read() as connection:
            keys = [key for key in list_keys(connection) if not key.revoked]
        size = f", {database.file.stat().st_size / 2**20:.1f} MiB" if database.is_sqlite else ""
        yield "store", f"{database.url}{size}", False
        text = f"{len(keys)} that count" if keys else "none: on loopback the server is open to all of this machine"
        yield "keys", text, False
        obstacle = database.obstacle()
        if obstacle:
            yield "store", obstacle, True
    finally:
        database.close()


def _served(server: Server) -> Iterator[Line]:
    if server.database is not None:
        return
    try:
        with server.client() as client:
            client.request("GET", "/v1/limits")
        yield "answer", "the server answers", False
    except httpx2.HTTPError:
        yield "answer", "nothing answers there now ('substructures serve' starts a server)", False
    except (ProblemError, SubstructuresError, SettingsError) as error:
        yield "answer", str(error), True


COMMANDS = {"doctor": doctor}
