"""The commands ``backup`` and ``restore``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.options import Json, Store, settings
from service.cli.output import print_json
from service.database import backup as copies

BackupFile = Annotated[Path, typer.Argument(metavar="FILE")]


def backup(file: BackupFile, database: Store = None, json: Json = False) -> int:
    """Copy the SQLite store to a file, also while a server runs."""
    size = copies.backup(settings(database=database).database, file)
    if json:
        print_json({"file": str(file), "bytes": size})
    else:
        print(f"{file}: {size:,} bytes")
    return 0


def restore(
    file: BackupFile,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a store that is there.")] = False,
    database: Store = None,
    json: Json = False,
) -> int:
    """Put a backup in the place of the SQLite store."""
    copies.restore(file, settings(database=database).database, overwrite)
    if json:
        print_json({"restored": str(file)})
    else:
        print(f"{file} restored")
    return 0


COMMANDS = {"backup": backup, "restore": restore}
