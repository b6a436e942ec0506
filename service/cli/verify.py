"""The command ``verify``: everything in a store against its documents."""

from __future__ import annotations

import argparse

from service.cli.options import Add, add_database, settings_of
from service.database.connections import Database
from service.operations.verification import verify_all


def _add_verify(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_verify)
    command.add_argument("--repair", action="store_true", help="derive anew what is wrong, where its document is sound")
    command.add_argument("--all", action="store_true", help="tell also of what is right")
    add_database(command)


def _verify(options: argparse.Namespace) -> int:
    """1 when something is wrong and stays so. A server may go on using the store."""
    database = Database(settings_of(options).database, exclusive=False)
    verified = wrong = mended = 0
    try:
        for finding in verify_all(database, options.repair):
            verified += 1
            wrong += bool(finding.fault)
            mended += bool(finding.fault) and finding.is_sound
            if finding.fault or options.all:
                print(": ".join(filter(None, (finding.what, finding.fault or "right", finding.outcome))), flush=True)
    finally:
        database.close()
    print(f"{verified} verified, {wrong} wrong" + (f", {mended} derived anew" if wrong and options.repair else ""))
    return int(wrong > mended)


ADD: Add = {"verify": _add_verify}
