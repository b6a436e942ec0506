"""Search among the latest versions of all parts, or revisions of all trees: what both have, sorted and page by page.

Searches read the narrow rows of the names, on SQLite nothing but the index that has the order; what is long is read of
the page alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

from sqlalchemy import ColumnElement, Connection, Select, Subquery, and_, case, not_, or_, select

from service.messages.viewer import Viewer
from service.queries.membership import Condition, Membership, scanned, without_index
from service.queries.owners import seen_by, visible
from service.queries.searching.words import TRIGRAM, Shelf, beside_index, escaped, in_index, starts

RELEVANCE = "relevance"
SORTABLE = ("name", "dof", "created")
EXACT, BEGINS, ALL = range(3)  # ranks: the name itself, names that begin with the first word, names with all
SCATTERED = 4  # times as many names are looked up and sorted where they would be looked for among all in an order
LAST = "\U0010ffff"  # sorts after all that a name may have
SORTS = (*(sign + name for name in SORTABLE for sign in ("", "-")), RELEVANCE)

#: the sort value of a name, and the name or, by relevance, its number
Position = tuple[Any, Any]


@dataclass(frozen=True)
class Search:
    """What to list of a shelf. All conditions must hold; ``words`` are lower-case, masses in kg, ``sort`` is one of
    ``SORTS``: by relevance come first the name itself, names that begin with the first word, and names with all words;
    of those that are alike in this, what has been there for longest.
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

    @property
    def texts(self) -> tuple[tuple[Sequence[str], str], ...]:
        """Words, and the column whose text has to have them."""
        return ((self.words, self.shelf.words),)

    def memberships(self) -> Iterator[Membership]:
        """What the names have to be among, words of three letters and more apart."""
        yield from starts(self.shelf, self.words)
        other = self.shelf.table.alias()
        for name in ("joints", "owner"):
            if (wanted := getattr(self, name)) is not None:
                yield Membership(
                    self.shelf.table.c.name, select(other.c.name).where(other.c[name] == wanted), in_order=True
                )

    def with_words(self, instead: dict[str, str]) -> Self:
        """The same search with other words."""
        return replace(self, words=tuple(instead.get(word, word) for word in self.words))

    @property
    def is_by_words(self) -> bool:
        """Whether results are in the order of the ranks."""
        return self.sort == RELEVANCE and bool(self.words)


def places(
    connection: Connection, viewer: Viewer, search: Search, after: Position | None, size: int
) -> list[tuple[str, Position]]:
    """Up to ``size`` names that follow the position ``after`` in the order of ``sort``, with their own positions."""
    text, others = _memberships(connection, search)
    walked, every = None, [*_given(text), *others]
    if connection.dialect.name == "sqlite" and every and all(each.is_common(connection) for each in every):
        # to look them up and sort them would take long, where in an order that is at hand the page is soon full
        if search.is_by_words:
            return _by_rank(connection, viewer, search, text, others, after or (0, -1), size)
        walked = next((each for each in every if each.in_order), None) if _is_by_name(search) else None
    conditions = [each.condition(connection) for each in every if each is not walked]
    table, first = search.shelf.table, None if walked is None else walked.others.subquery()
    name = table.c.name if first is None else first.c[0]
    place = _place(search, name)
    tie = table.c.number if search.is_by_words else name
    descending = search.sort.startswith("-")
    # SQLite looks at conditions as they come: few rows are left for what everybody sees
    query: Select[Any] = select(name, place.label("place"), tie.label("tie"))
    query = _chosen(query.where(*conditions, *_beside(connection, search)), connection, search, first)
    if after is not None:
        query = query.where(_beyond(place, tie, after, descending))
    # by name alone where that is the order: SQLite knows no index for a column and itself
    ordered = place.desc() if descending else place
    query = query.order_by(*((ordered,) if place is tie else (ordered, tie))).limit(size)
    return [(row[0], (row.place, row.tie)) for row in connection.execute(query, seen_by(viewer))]


def _beyond(place: ColumnElement[Any], tie: ColumnElement[Any], after: Position, descending: bool) -> Condition:
    """What comes behind a position in the order of ``place``, and of ``tie`` where that is equal."""
    value, last = after
    beyond = place < value if descending else place > value
    return beyond if place is tie else or_(beyond, and_(place == value, tie > last))


def _by_rank(
    connection: Connection,
    viewer: Viewer,
    search: Search,
    text: Membership | None,
    others: Sequence[Membership],
    after: Position,
    size: int,
) -> list[tuple[str, Position]]:
    """The same of words that many have, on SQLite: rank by rank, each in the order of the numbers, which ends with the
    page, where all that have them would have to be sorted.
    """
    shelf, first, ranks = search.shelf, search.words[0], _ranks(search)
    name, number = shelf.table.c.name, shelf.table.c.number
    range_ = name.between(first, first + LAST)
    is_rare = not Membership(name, select(name).where(range_)).is_common(connection)
    listed = (each.condition(connection) for each in _given(text))
    steps: tuple[tuple[Membership | None, tuple[Condition, ...]], ...] = (
        (None, (ranks[EXACT],)),  # which has all the words
        (None, (range_, *listed)) if is_rare else (text, (ranks[BEGINS],)),
        *((in_index(connection, shelf, search.words, "name"), (each,)) for each in ranks[ALL:]),
        (text, ()),
    )
    conditions = [*(each.condition(connection) for each in others), *_beside(connection, search)]
    found: list[tuple[str, Position]] = []
    for rank, (walked, wanted) in enumerate(steps):
        if rank < after[0] or len(found) >= size:
            continue
        order = None if walked is None else walked.others.subquery()
        place = number if order is None else order.c[0]
        query = _chosen(select(name, number), connection, search, order, "number")
        query = query.where(*wanted, *conditions, *map(not_, ranks[:rank]))
        if rank == after[0]:
            query = query.where(place > after[1])
        rows = connection.execute(query.order_by(place).limit(size - len(found)), seen_by(viewer))
        found += [(row.name, (rank, row.number)) for row in rows]
    return found


def matching(query: Select[Any], connection: Connection, search: Search) -> Select[Any]:
    """The query, of what the viewer of :func:`seen_by` sees and all conditions hold for."""
    query = _chosen(query, connection, search)
    text, others = _memberships(connection, search)
    query = query.where(*(each.condition(connection) for each in (*_given(text), *others)))
    return query.where(*_beside(connection, search))


def _memberships(connection: Connection, search: Search) -> tuple[Membership | None, list[Membership]]:
    """What the names have to be among: for words of three letters and more, where an index has them, and the rest."""
    text, *others = (in_index(connection, search.shelf, words, where) for words, where in search.texts)
    texts = [replace(each, times=SCATTERED) for each in others if each is not None]
    return text, [*texts, *search.memberships()]


def _given(each: Membership | None) -> tuple[Membership, ...]:
    return () if each is None else (each,)


def _beside(connection: Connection, search: Search) -> list[Condition]:
    return [each for words, where in search.texts for each in beside_index(connection, search.shelf, words, where)]


def _chosen(
    query: Select[Any], connection: Connection, search: Search, first: Subquery | None = None, key: str = "name"
) -> Select[Any]:
    """The query, of the rows that a viewer sees, and their ranges; ``first``: those with such a ``key``, which SQLite
    then takes in the order that it finds these in.
    """
    table = search.shelf.table
    source = table if first is None else first.join(table, table.c[key] == without_index(first.c[0]))
    query = query.select_from(source).where(table.c[search.shelf.there].is_not(None), visible(table))
    return query.where(*_ranges(connection, search))


def _ranges(connection: Connection, search: Search) -> Iterator[Condition]:
    table = search.shelf.table
    # SQLite would take the index of dof wherever it can, also where that of the order is quicker
    for name, value in (("dof", scanned(connection, table.c.dof)), ("mass", table.c.mass)):
        if (least := getattr(search, f"{name}_min")) is not None:
            yield value >= least
        if (most := getattr(search, f"{name}_max")) is not None:
            yield value <= most


def _place(search: Search, name: ColumnElement[Any]) -> ColumnElement[Any]:
    """The value that results are ordered by."""
    if search.is_by_words:
        ranks = _ranks(search)
        return case(*((condition, rank) for rank, condition in enumerate(ranks)), else_=len(ranks))
    return name if _is_by_name(search) else search.shelf.table.c[search.sort.lstrip("-")]


def _is_by_name(search: Search) -> bool:
    return search.sort.lstrip("-") == "name" or (search.sort == RELEVANCE and not search.words)


def _ranks(search: Search) -> tuple[Condition, ...]:
    """What is more relevant than the rest: the name itself, names that begin with the first word, and names with all,
    unless all are so short that they are somewhere in most.
    """
    name = search.shelf.table.c.name
    exact = name.in_([sign.join(search.words) for sign in ("-", "_", "")])
    begins = name.like(f"{escaped(search.words[0])}%", escape="/")
    in_all = and_(*(name.like(f"%{escaped(word)}%", escape="/") for word in search.words))
    return (exact, begins, in_all) if any(len(word) >= TRIGRAM for word in search.words) else (exact, begins)


def number_of(connection: Connection, viewer: Viewer, shelf: Shelf, name: str) -> int | None:
    """The number of a name that the viewer sees."""
    table = shelf.table
    query = select(table.c.number).where(table.c.name == name, visible(table))
    found: int | None = connection.execute(query, seen_by(viewer)).scalar()
    return found


def in_order(found: dict[str, Any], rows: Sequence[tuple[str, Position]]) -> list[tuple[Any, Position]]:
    """What was read of a page, with the positions; a name that is gone meanwhile is left out."""
    return [(found[name], value) for name, value in rows if name in found]
