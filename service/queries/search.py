"""Search among the latest versions of all names: by words, tags, degrees of freedom, joints and owner.

Searches read the narrow rows of ``substructures``; what is long is read of the versions of one page. Words of three
letters and more are found by their trigrams, with FTS5 on SQLite and pg_trgm on PostgreSQL, which has it as an
extension; shorter ones, and all where there is no such index, by a look at every name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher
from typing import Any

from sqlalchemy import ColumnElement, Connection, Select, and_, bindparam, case, column, func, or_, select, table, text

from service.database.tables import substructures, tags, versions
from service.queries.catalogue import COLUMNS, STORED, Version
from service.queries.owners import seen_by, visible
from service.viewer import Viewer

RELEVANCE = "relevance"
TRIGRAM = 3  # letters
#: names that are looked at for a word that is in none, how much of it has to agree, and letters that may be exchanged
NEAR, LIKENESS, LONGEST = 500, 0.72, 30
_BETWEEN = re.compile(r"[\s\-_.,;:()\[\]]+")
_SORTABLE: dict[str, ColumnElement[Any]] = {name: substructures.c[name] for name in ("name", "dof", "created")}
SORTS = (*(sign + name for name in _SORTABLE for sign in ("", "-")), RELEVANCE)
_NAME, _WORDS = substructures.c.name, substructures.c.searchable


@dataclass(frozen=True, slots=True)
class CatalogueSearch:
    """Which latest versions to list. All conditions must hold; ``words`` are lower-case, ``sort`` is one of ``SORTS``:
    by relevance come first the name itself, names that begin with the first word, and names with all words.
    """

    words: tuple[str, ...] = ()
    tags: tuple[str, ...] = ()
    dof_min: int | None = None
    dof_max: int | None = None
    joints: str | None = None
    owner: str | None = None
    sort: str = "name"


def words_of(text: str) -> tuple[str, ...]:
    """The words of a search, lower-case; NUL, which no database takes, is in no text."""
    return tuple(text.lower().replace("\0", "\ufffd").split())


def page(
    connection: Connection, viewer: Viewer, search: CatalogueSearch, after: tuple[Any, ...] | None, size: int
) -> tuple[list[Version], list[Any]]:
    """Up to ``size`` versions that follow the position ``after`` (sort value, name) in the order of ``sort``, and their
    sort values.
    """
    place = _place(search)
    descending = search.sort.startswith("-")
    query = _matching(select(_NAME, place.label("place")), connection, search)
    if after is not None:
        value, name = after
        beyond = place < value if descending else place > value
        query = query.where(or_(beyond, and_(place == value, name < _NAME)))
    query = query.order_by(place.desc() if descending else place, _NAME).limit(size)
    rows = connection.execute(query, seen_by(viewer)).all()
    latest = select(*COLUMNS).select_from(STORED).where(_IS_LATEST, _NAME.in_([name for name, _ in rows]))
    found = {row.name: Version(*row) for row in connection.execute(latest, seen_by(viewer))}
    there = [(found[name], value) for name, value in rows if name in found]
    return [version for version, _ in there], [value for _, value in there]


def count(connection: Connection, viewer: Viewer, search: CatalogueSearch) -> int:
    """How many there are."""
    query = _matching(select(func.count()), connection, search)
    return connection.execute(query, seen_by(viewer)).scalar_one()


def facets(connection: Connection, viewer: Viewer, search: CatalogueSearch) -> dict[str, dict[str, int]]:
    """How many of the versions found there are for every tag, joint sequence and number of degrees of freedom."""
    columns = {"tags": tags.c.tag, "joints": substructures.c.joints, "dof": substructures.c.dof}
    found = {}
    for name, value in columns.items():
        query = _matching(select(value, func.count()), connection, search)
        if name == "tags":
            query = query.join(tags, tags.c.part == substructures.c.digest)
        rows = connection.execute(query.group_by(value).order_by(value), seen_by(viewer))
        found[name] = {str(row[0]): row[1] for row in rows}
    return found


def corrected(connection: Connection, viewer: Viewer, search: CatalogueSearch) -> dict[str, str]:
    """For every word that is in no name, title, description or tag, the most similar one that is in one."""
    found = {}
    for word in search.words:
        alone = CatalogueSearch(words=(word,))
        if not connection.execute(_matching(select(_NAME), connection, alone).limit(1), seen_by(viewer)).first():
            near = max(_near(connection, viewer, word), key=lambda other: _likeness(word, other), default=None)
            if near is not None and _likeness(word, near) >= LIKENESS:
                found[word] = near
    return found


def with_words(search: CatalogueSearch, instead: dict[str, str]) -> CatalogueSearch:
    """The same search with other words."""
    return replace(search, words=tuple(instead.get(word, word) for word in search.words))


def _near(connection: Connection, viewer: Viewer, word: str) -> set[str]:
    """Words with what a slip has left of a word: one of its halves, or all of it with two letters exchanged."""
    if len(word) <= TRIGRAM:
        return set()
    half = max(TRIGRAM, (len(word) + 1) // 2)
    exchanged = {f"{word[:k]}{word[k + 1]}{word[k]}{word[k + 2 :]}" for k in range(min(len(word), LONGEST) - 1)}
    left = {word[:half], word[-half:], *exchanged}
    query = select(_WORDS).where(visible(substructures), or_(*(_has(connection, [each]) for each in sorted(left))))
    rows = connection.execute(query.limit(NEAR), seen_by(viewer)).scalars()
    words = {each for row in rows for each in _BETWEEN.split(row)}
    return {each for each in words if any(some in each for some in left)}


def _likeness(word: str, other: str) -> float:
    return SequenceMatcher(None, word, other).ratio()


def _place(search: CatalogueSearch) -> ColumnElement[Any]:
    """The value that results are ordered by."""
    if search.sort != RELEVANCE:
        return _SORTABLE[search.sort.lstrip("-")]
    if not search.words:
        return _NAME
    return case(
        (_NAME.in_([sign.join(search.words) for sign in ("-", "_", "")]), 0),
        (_NAME.startswith(search.words[0], autoescape=True), 1),
        (and_(*(_NAME.contains(word, autoescape=True) for word in search.words)), 2),
        else_=3,
    )


def _matching(query: Select[Any], connection: Connection, search: CatalogueSearch) -> Select[Any]:
    query = query.select_from(substructures).where(substructures.c.latest.is_not(None), visible(substructures))
    return query.where(*_conditions(connection, search))


def _conditions(connection: Connection, search: CatalogueSearch) -> Iterator[ColumnElement[bool]]:
    if search.words:
        yield _has(connection, search.words)
    for tag in search.tags:
        yield substructures.c.digest.in_(select(tags.c.part).where(tags.c.tag == tag))
    if search.owner is not None:
        yield substructures.c.owner == search.owner
    if search.dof_min is not None:
        yield substructures.c.dof >= search.dof_min
    if search.dof_max is not None:
        yield substructures.c.dof <= search.dof_max
    if search.joints is not None:
        yield substructures.c.joints == search.joints


def _has(connection: Connection, words: Sequence[str]) -> ColumnElement[bool]:
    """All words are in the text."""
    conditions = [_WORDS.contains(word, autoescape=True) for word in words]
    long = [word for word in words if len(word) >= TRIGRAM]
    if not long or connection.dialect.name != "sqlite":  # PostgreSQL's index serves the same condition
        return and_(*conditions)
    quoted = " AND ".join('"{}"'.format(word.replace('"', '""')) for word in long)
    match = text("substructure_words MATCH :words").bindparams(bindparam("words", quoted, unique=True))
    chosen: Select[Any] = select(column("rowid")).select_from(table("substructure_words")).where(match)
    short = [_WORDS.contains(word, autoescape=True) for word in words if len(word) < TRIGRAM]
    return and_(substructures.c.number.in_(chosen), *short)


_IS_LATEST = substructures.c.latest == versions.c.version
