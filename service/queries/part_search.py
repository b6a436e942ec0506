"""Search among the latest versions of all parts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from sqlalchemy import Connection, func, select

from service.database.tables import part_ports, substructures, tags, versions
from service.queries.catalogue import COLUMNS, STORED, Version
from service.queries.membership import Condition, among
from service.queries.owners import seen_by
from service.queries.search import Search, in_order, matching, places
from service.queries.words import PARTS, Shelf, has
from service.viewer import Viewer

_IS_LATEST = substructures.c.latest == versions.c.version


@dataclass(frozen=True)
class CatalogueSearch(Search):
    """Which latest versions to list: with all of the ``tags``, all of the ``ports``, and all words of ``source``,
    lower-case, in their source.
    """

    tags: tuple[str, ...] = ()
    ports: tuple[str, ...] = ()
    source: tuple[str, ...] = ()

    shelf: ClassVar[Shelf] = PARTS

    def others(self, connection: Connection) -> Iterator[Condition]:
        """Tags, ports and words of the source."""
        for table, column, wanted in ((tags, tags.c.tag, self.tags), (part_ports, part_ports.c.port, self.ports)):
            for each in wanted:
                yield among(connection, substructures.c.digest, select(table.c.part).where(column == each))
        if self.source:
            yield has(connection, PARTS, self.source, "source", in_order=True)


def page(
    connection: Connection, viewer: Viewer, search: CatalogueSearch, after: tuple[Any, ...] | None, size: int
) -> list[tuple[Version, Any]]:
    """Up to ``size`` versions that follow a position, as :func:`places`, with their sort values."""
    rows = places(connection, viewer, search, after, size)
    chosen = substructures.c.name.in_([name for name, _ in rows])
    latest = select(*COLUMNS).select_from(STORED).where(_IS_LATEST, chosen)
    return in_order({row.name: Version(*row) for row in connection.execute(latest, seen_by(viewer))}, rows)


def facets(connection: Connection, viewer: Viewer, search: CatalogueSearch) -> dict[str, dict[str, int]]:
    """How many of the versions found there are for every tag, joint sequence and number of degrees of freedom."""
    columns = {"tags": tags.c.tag, "joints": substructures.c.joints, "dof": substructures.c.dof}
    found = {}
    for name, value in columns.items():
        query = matching(select(value, func.count()), connection, search)
        if name == "tags":
            query = query.join(tags, tags.c.part == substructures.c.digest)
        rows = connection.execute(query.group_by(value).order_by(value), seen_by(viewer))
        found[name] = {str(row[0]): row[1] for row in rows}
    return found
