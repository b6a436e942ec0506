"""The command ``verify``: everything in a store against its documents."""

from __future__ import annotations

from typing import Annotated

import typer

from service.cli.options import Json, Store, settings
from service.cli.output import print_json
from service.database.connections import Database
from service.operations.verification import verify_all


def verify(
    repair: Annotated[
        bool, typer.Option("--repair", help="Derive anew what is wrong, where its document is sound.")
    ] = False,
    all: Annotated[bool, typer.Option("--all", help="Tell also of what is right.")] = False,  # noqa: A002 -- an option
    database: Store = None,
    json: Json = False,
) -> int:
    """Prove every part and tree of a store by deriving it anew; a server may go on using it meanwhile."""
    given = settings(database=database)
    opened = Database(given.database, exclusive=False, seal_key=given.seal_key)
    told, verified, wrong, mended = [], 0, 0, 0
    try:
        for finding in verify_all(opened, repair):
            verified += 1
            wrong += bool(finding.fault)
            mended += bool(finding.fault) and finding.is_sound
            if finding.fault or all:
                told.append({"what": finding.what, "fault": finding.fault or None, "outcome": finding.outcome or None})
                words = ": ".join(filter(None, (finding.what, finding.fault or "right", finding.outcome)))
                if not json:
                    print(words, flush=True)
    finally:
        opened.close()
    if json:
        print_json({"verified": verified, "wrong": wrong, "mended": mended, "findings": told})
    else:
        anew = f", {mended} derived anew" if wrong and repair else ""
        print(f"{verified} verified, {wrong} wrong{anew}")
    return int(wrong > mended)


COMMANDS = {"verify": verify}
