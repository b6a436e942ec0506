"""The command ``upgrade``: formulas of older versions of the software derived anew."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from service.cli.options import Json, Store, settings
from service.cli.output import print_json
from service.database.connections import Database
from service.operations.renewal import OPERATOR
from service.operations.upgrade import upgrade as upgraded


def upgrade(
    all: Annotated[bool, typer.Option("--all", help="Older and withdrawn versions and revisions, too.")] = False,  # noqa: A002 -- an option
    database: Store = None,
    json: Json = False,
) -> int:
    """Derive the parts and trees of a store anew, as a server does by itself; one may go on using it.

    Definitions, versions and digests stay. What is told of is on the disk.
    """
    given = settings(database=database)
    opened = Database(given.database, exclusive=False, seal_key=given.seal_key)
    told, faults = [], 0
    try:
        for each in upgraded(opened, OPERATOR, all):
            faults += bool(each.fault)
            told.append(asdict(each))
            if json:
                continue
            counts = "" if each.before is None else f", {each.before:,} -> {each.after:,} operations"
            print(f"{each.what}: {each.fault or each.outcome}{counts}", flush=True)
    finally:
        opened.close()
    if json:
        print_json(told)
    else:
        print(f"{len(told)} looked at, {faults} could not be derived")
    return int(faults > 0)


COMMANDS = {"upgrade": upgrade}
