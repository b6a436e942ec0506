"""The commands ``backup`` and ``restore``."""

from __future__ import annotations

import argparse
from pathlib import Path

from service.cli.options import Add, add_database, settings_of
from service.database.backup import backup, restore


def _add_backup(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_backup)
    command.add_argument("file", type=Path)
    add_database(command)


def _add_restore(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_restore)
    command.add_argument("file", type=Path)
    command.add_argument("--overwrite", action="store_true", help="replace a store that is there")
    add_database(command)


def _backup(options: argparse.Namespace) -> int:
    print(f"{options.file}: {backup(settings_of(options).database, options.file):,} bytes")
    return 0


def _restore(options: argparse.Namespace) -> int:
    restore(options.file, settings_of(options).database, options.overwrite)
    print(f"{options.file} restored")
    return 0


ADD: Add = {"backup": _add_backup, "restore": _add_restore}
