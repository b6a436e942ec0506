"""Search among the latest revisions of all trees."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from sqlalchemy import Connection, and_, select

from service.database.tables import tree_names, tree_parts, versions
from service.messages.viewer import Viewer
from service.queries.membership import Membership
from service.queries.owners import seen_by
from service.queries.searching.search import Position, Search, in_order, places
from service.queries.searching.words import TREES, Shelf
from service.queries.trees import LATEST, Tree


@dataclass(frozen=True)
class TreeSearch(Search):
    """Which trees to list; ``uses``: name of a part that one of its instances is."""

    uses: str | None = None

    shelf: ClassVar[Shelf] = TREES

    def memberships(self) -> Iterator[Membership]:
        """As of all, and of what is used."""
        yield from super().memberships()
        if self.uses is not None:
            named = tree_names.alias()
            of_latest = and_(named.c.name == tree_parts.c.name, named.c.latest == tree_parts.c.revision)
            used = select(tree_parts.c.name).join(versions, versions.c.digest == tree_parts.c.part)
            used = used.join(named, of_latest).where(versions.c.name == self.uses)
            yield Membership(tree_names.c.name, used, is_listed=True)


def page(
    connection: Connection, viewer: Viewer, search: TreeSearch, after: Position | None, size: int
) -> list[tuple[Tree, Position]]:
    """Up to ``size`` trees that follow a position, as :func:`places`, with their own."""
    rows = places(connection, viewer, search, after, size)
    latest = LATEST.where(tree_names.c.name.in_([name for name, _ in rows]))
    return in_order({row.name: Tree.of(connection, row) for row in connection.execute(latest, seen_by(viewer))}, rows)
