"""Search among the latest versions of all parts, or revisions of all trees: what both have, sorted and page by page.

Searches read the narrow rows of the names, on SQLite nothing but the index that has the order; what is long is read of
the page alone.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

from sqlalchemy import ColumnElement, Connection, Select, and_, case, func, or_, select

from service.queries.membership import Condition, without_index
from service.queries.owners import seen_by, visible
from service.queries.words import Shelf, has
from service.viewer import Viewer

RELEVANCE = "relevance"
SORTABLE = ("name", "dof", "created")
SORTS = (*(sign + name for name in SORTABLE for sign in ("", "-")), RELEVANCE)


@dataclass(frozen=True)
class Search(ABC):
    """What to list of a shelf. All conditions must hold; ``words`` are lower-case, masses in kg, ``sort`` is one of
    ``SORTS``: by relevance come first the name itself, names that begin with the first word, and names with all words.
    """

    words: tuple[str, ...] = ()
    dof_min: int | None = None
    dof_max: int | None = None
    joints: str | None = None
    mass_min: float | None = None
    mass_max: float | None = None
    owner: str | None = None
    sort: str = "name"

    shelf: ClassVar[Shelf]

    @abstractmethod
    def others(self, connection: Connection) -> Iterator[Condition]:
        """Conditions beside those on the narrow row."""

    def with_words(self, instead: dict[str, str]) -> Self:
        """The same search with other words."""
        return replace(self, words=tuple(instead.get(word, word) for word in self.words))


def places(
    connection: Connection, viewer: Viewer, search: Search, after: tuple[Any, ...] | None, size: int
) -> list[tuple[str, Any]]:
    """Up to ``size`` names that follow the position ``after`` (sort value, name) in the order of ``sort``, with their
    sort values.
    """
    place, name = _place(search), search.shelf.table.c.name
    descending = search.sort.startswith("-")
    query = matching(select(name, place.label("place")), connection, search)
    if after is not None:
        value, last = after
        beyond = place < value if descending else place > value
        query = query.where(or_(beyond, and_(place == value, name > last)))
    # by name alone where that is the order: SQLite knows no index for a column and itself
    order = (name.desc() if descending else name,) if place is name else (place.desc() if descending else place, name)
    query = query.order_by(*order).limit(size)
    return [(row.name, row.place) for row in connection.execute(query, seen_by(viewer))]


def count(connection: Connection, viewer: Viewer, search: Search) -> int:
    """How many there are."""
    query = matching(select(func.count()), connection, search)
    return connection.execute(query, seen_by(viewer)).scalar_one()


def matching(query: Select[Any], connection: Connection, search: Search) -> Select[Any]:
    """The query, of what the viewer of :func:`seen_by` sees and all conditions hold for."""
    table, others = search.shelf.table, list(search.others(connection))
    if search.words:
        others.append(has(connection, search.shelf, search.words, in_order=True))
    query = query.select_from(table).where(table.c[search.shelf.there].is_not(None), visible(table))
    return query.where(*_narrow(connection, search), *others)


def _narrow(connection: Connection, search: Search) -> Iterator[Condition]:
    table = search.shelf.table
    for name in ("joints", "owner"):
        if (wanted := getattr(search, name)) is not None:
            yield table.c[name] == wanted
    # SQLite would take the index of dof wherever it can, also where that of the order is quicker
    dof = without_index(table.c.dof) if connection.dialect.name == "sqlite" else table.c.dof
    for name, value in (("dof", dof), ("mass", table.c.mass)):
        if (least := getattr(search, f"{name}_min")) is not None:
            yield value >= least
        if (most := getattr(search, f"{name}_max")) is not None:
            yield value <= most


def _place(search: Search) -> ColumnElement[Any]:
    """The value that results are ordered by."""
    name = search.shelf.table.c.name
    if search.sort != RELEVANCE:
        return search.shelf.table.c[search.sort.lstrip("-")]
    if not search.words:
        return name
    return case(
        (name.in_([sign.join(search.words) for sign in ("-", "_", "")]), 0),
        (name.startswith(search.words[0], autoescape=True), 1),
        (and_(*(name.contains(word, autoescape=True) for word in search.words)), 2),
        else_=3,
    )


def in_order(found: dict[str, Any], rows: Sequence[tuple[str, Any]]) -> list[tuple[Any, Any]]:
    """What was read of a page, with the sort values; a name that is gone meanwhile is left out."""
    return [(found[name], value) for name, value in rows if name in found]
