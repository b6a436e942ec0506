"""The command ``verify``: everything in a store against its documents."""

from __future__ import annotations

from typing import Annotated

import typer

from service.cli.options import Json, Store, settings
from service.cli.output import print_json
from service.database.connections import Database
from service.operations.verification import MENDED, verify_all


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
    told, verified, wrong, mended, left, is_bad = [], 0, 0, 0, 0, False
    try:
        for finding in verify_all(opened, repair):
            verified += not finding.is_left
            left += finding.is_left
            wrong += bool(finding.fault)
            is_bad |= not finding.is_sound
            mended += finding.outcome == MENDED
            if finding.fault or finding.outcome or all:
                told.append({"what": finding.what, "fault": finding.fault or None, "outcome": finding.outcome or None})
                right = "" if finding.outcome else "right"
                words = ": ".join(filter(None, (finding.what, finding.fault or right, finding.outcome)))
                if not json:
                    print(words, flush=True)
    finally:
        opened.close()
    if json:
        print_json({"verified": verified, "wrong": wrong, "mended": mended, "not_renewed": left, "findings": told})
    else:
        anew = f", {mended} derived anew" if (wrong or mended) and repair else ""
        later = f", {left} not renewed yet" if left else ""
        print(f"{verified} verified, {wrong} wrong{anew}{later}")
    return int(is_bad)


COMMANDS = {"verify": verify}
