"""Stores as other versions of the software, or who has the key of their seals, would leave them."""

from __future__ import annotations

from collections.abc import Collection
from contextlib import closing
from pathlib import Path

from sqlalchemy import select, true, update

from service.database.connections import Database
from service.database.tables import parts, trees
from service.queries.seals import seal_of_part, seal_of_tree
from service.queries.searching.formulas import index_digest
from service.queries.versions import seal_numbers


def seal_again(store: Path | str, software: str | None = None, only: Collection[str] = ()) -> None:
    """Seal what is in a store (an SQLite file, or an address without a key) as it is now.

    ``software``: that is said to have derived it; ``only``: digests of parts.
    """
    address = store if isinstance(store, str) else f"sqlite:///{store}"
    with closing(Database(address, exclusive=False)) as database, database.write() as connection:
        named = {} if software is None else {"software": software}
        chosen = parts.c.digest.in_(only) if only else true()
        for row in connection.execute(select(parts).where(chosen)).mappings().all():
            found = {**row, **named, "index_digest": index_digest(row["outputs"], row["formulas"])}
            values = {**named, "index_digest": found["index_digest"], "seal": seal_of_part(connection, found)}
            connection.execute(update(parts).where(parts.c.digest == row["digest"]).values(values))
        seal_numbers(connection)
        for row in connection.execute(select(trees)).mappings().all():
            found = {**row, **named}
            revision = (trees.c.name == row["name"]) & (trees.c.revision == row["revision"])
            connection.execute(update(trees).where(revision).values(**named, seal=seal_of_tree(connection, found)))
