"""Search among the latest versions of all parts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from sqlalchemy import ColumnElement, Connection, ScalarSelect, Select, func, select

from service.database.tables import search_terms, substructures, versions
from service.messages.viewer import PRIVATE, PUBLIC, Viewer
from service.queries.catalogue import COLUMNS, STORED, Version
from service.queries.membership import Membership, scanned
from service.queries.owners import seen_by, visible
from service.queries.searching.search import Position, Search, in_order, matching, places
from service.queries.searching.terms import PORT, TAG, names_with
from service.queries.searching.words import PARTS, Shelf

#: by kind (tags, joints, dof) how many of what was found have each value
Facets = Mapping[str, Mapping[str, int]]
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

    @property
    def texts(self) -> tuple[tuple[Sequence[str], str], ...]:
        """As of all, and words of the source."""
        return *super().texts, (self.source, "source")

    def memberships(self) -> Iterator[Membership]:
        """As of all, and of tags and ports."""
        yield from super().memberships()
        for kind, wanted in ((TAG, self.tags), (PORT, self.ports)):
            for each in wanted:
                yield Membership(substructures.c.name, names_with(kind, each), in_order=True)


def page(
    connection: Connection, viewer: Viewer, search: CatalogueSearch, after: Position | None, size: int
) -> list[tuple[Version, Position]]:
    """Up to ``size`` versions that follow a position, as :func:`places`, with their own."""
    rows = places(connection, viewer, search, after, size)
    chosen = substructures.c.name.in_([name for name, _ in rows])
    latest = select(*COLUMNS).select_from(STORED).where(_IS_LATEST, chosen)
    return in_order(
        {row.name: Version.of(connection, row) for row in connection.execute(latest, seen_by(viewer))}, rows
    )


def count(connection: Connection, viewer: Viewer) -> int:
    """How many latest versions a viewer sees."""
    return connection.execute(_COUNT, seen_by(viewer)).scalar_one()


def facets(connection: Connection, viewer: Viewer, search: CatalogueSearch) -> Facets:
    """How many of the versions found there are for every tag, joint sequence and number of degrees of freedom."""
    joints, name = (scanned(connection, each) for each in (substructures.c.joints, search_terms.c.name))
    tag = search_terms.c.term
    of_joints = _counted(connection, viewer, matching(select(joints, func.count()), connection, search), joints)
    of_dof: Counter[int] = Counter()
    for each, count in of_joints.items():
        of_dof[len(each)] += count
    of_found = name.in_(matching(select(substructures.c.name), connection, search))
    tags = select(tag, func.count()).where(search_terms.c.kind == TAG, of_found)
    return {
        "tags": _counted(connection, viewer, tags, tag),
        "joints": of_joints,
        "dof": {str(dof): of_dof[dof] for dof in sorted(of_dof)},
    }


def _counted(connection: Connection, viewer: Viewer, query: Select[Any], by: ColumnElement[Any]) -> dict[str, int]:
    rows = connection.execute(query.group_by(by).order_by(by), seen_by(viewer))
    return {str(value): count for value, count in rows}


def _number(*conditions: ColumnElement[bool]) -> ScalarSelect[int]:
    there = substructures.c.latest.is_not(None)
    return select(func.count()).select_from(substructures).where(there, *conditions).scalar_subquery()


# public ones by themselves, which an index counts
_IS_PUBLIC = substructures.c.visibility == PUBLIC
_COUNT = select(_number(_IS_PUBLIC) + _number(substructures.c.visibility == PRIVATE, visible(substructures)))
