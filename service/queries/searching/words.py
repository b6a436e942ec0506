"""Words in a text of every name, and the most similar ones to a word that is nowhere.

Words of three letters and more are found by their trigrams, with FTS5 on SQLite and pg_trgm on PostgreSQL, which has it
as an extension; shorter ones where a word begins, by the terms of parts. What no index has is found by a look at
every name.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import cache
from typing import Any

from sqlalchemy import (
    ColumnElement,
    Connection,
    Select,
    Table,
    and_,
    bindparam,
    column,
    literal_column,
    select,
    table,
)

from service.database.tables import substructures, tree_names
from service.messages.viewer import Viewer
from service.queries.membership import Condition, Membership, without_index
from service.queries.owners import seen_by, visible
from service.queries.searching.terms import START, is_start, names_with

TRIGRAM = 3  # letters
#: names that are looked at for a half of a word that is in none, how much of it has to agree, and letters that may be
#: exchanged
NEAR, LIKENESS, LONGEST = 100, 0.72, 30
_BETWEEN = re.compile(r"[\s\-_.,;:()\[\]]+")


@dataclass(frozen=True, slots=True)
class Shelf:
    """A table with a row for every name; ``words``: the column that words are looked for in, ``index``: FTS5's table of
    its trigrams, ``there``: a column that is NULL where nothing is left of a name; ``has_starts``: the first letters of
    words are among the terms.
    """

    table: Table
    words: str
    index: str
    there: str
    has_starts: bool = False


PARTS = Shelf(substructures, "searchable", "substructure_words", "latest", has_starts=True)
TREES = Shelf(tree_names, "name", "tree_words", "dof")


def words_of(text: str) -> tuple[str, ...]:
    """The words of a search, lower-case; NUL, which no database takes, is in no text."""
    return tuple(text.lower().replace("\0", "\ufffd").split())


def in_index(connection: Connection, shelf: Shelf, words: Iterable[str], where: str) -> Membership | None:
    """That all words of three letters and more are in the text of a column, by SQLite's index of trigrams, which has
    the rows in the order of their numbers; None without such words.

    PostgreSQL's index serves the conditions of :func:`beside_index`.
    """
    quoted = [_quoted(word) for word in words if len(word) >= TRIGRAM]
    if not quoted or connection.dialect.name != "sqlite":
        return None
    is_match = _matches(shelf, f"{where} : ({' AND '.join(quoted)})")
    chosen: Select[Any] = select(column("rowid")).select_from(table(shelf.index)).where(is_match)
    return Membership(shelf.table.c.number, chosen, is_listed=True)


def starts(shelf: Shelf, words: Iterable[str]) -> list[Membership]:
    """That words begin with the short ones."""
    short = sorted({word for word in words if _is_start(shelf, word)})
    return [Membership(shelf.table.c.name, names_with(START, word)) for word in short]


def beside_index(connection: Connection, shelf: Shelf, words: Iterable[str], where: str) -> list[Condition]:
    """That the words are in the text of a column which neither :func:`in_index` nor :func:`starts` looks for."""
    searched = shelf.table.c[where]
    is_indexed = connection.dialect.name == "sqlite"
    rest = (word for word in words if len(word) < TRIGRAM or not is_indexed)
    return [
        searched.contains(word, autoescape=True) for word in rest if where != shelf.words or not _is_start(shelf, word)
    ]


def escaped(word: str) -> str:
    """For a pattern, which is whole: SQLite would put one together again for every row."""
    return re.sub(r"([%_/])", r"/\1", word)


def _is_start(shelf: Shelf, word: str) -> bool:
    return shelf.has_starts and is_start(word)


def _quoted(word: str) -> str:
    return '"{}"'.format(word.replace('"', '""'))


def _matches(shelf: Shelf, words: str | ColumnElement[str]) -> Condition:
    return literal_column(shelf.index).op("MATCH", is_comparison=True)(words)


def corrected(connection: Connection, viewer: Viewer, shelf: Shelf, words: Sequence[str]) -> dict[str, str]:
    """For every word that is in no text that the viewer sees, the most similar one that is in one; of three letters
    and less there would be too many.
    """
    found = {}
    for word in words:
        if len(word) > TRIGRAM and not _texts(connection, viewer, shelf, word, 1):
            near = max(_near(connection, viewer, shelf, word), key=lambda other: _likeness(word, other), default=None)
            if near is not None and _likeness(word, near) >= LIKENESS:
                found[word] = near
    return found


def _near(connection: Connection, viewer: Viewer, shelf: Shelf, word: str) -> set[str]:
    """Words with what a slip has left of a word: one of its halves, or all of it with two letters exchanged."""
    half = max(TRIGRAM, (len(word) + 1) // 2)
    exchanged = {f"{word[:k]}{word[k + 1]}{word[k]}{word[k + 2 :]}" for k in range(min(len(word), LONGEST) - 1)}
    left = {word[:half], word[-half:], *exchanged}  # one after the other, so that each is looked up in an index
    texts = [text for each in sorted(left) for text in _texts(connection, viewer, shelf, each, NEAR)]
    return {each for each in set(_BETWEEN.split("\n".join(texts))) if any(some in each for some in left)}


def _texts(connection: Connection, viewer: Viewer, shelf: Shelf, part: str, size: int) -> Sequence[str]:
    """So many of the texts that a viewer sees with a part of three letters or more."""
    is_indexed = connection.dialect.name == "sqlite"
    given = f"{shelf.words} : {_quoted(part)}" if is_indexed else f"%{escaped(part)}%"
    return (
        connection.execute(_with(shelf, is_indexed), {"part": given, "size": size, **seen_by(viewer)}).scalars().all()
    )


@cache  # to build a statement takes longer than to execute it
def _with(shelf: Shelf, is_indexed: bool) -> Select[Any]:
    """The texts with ``part``, of SQLite's index what that says; ``size`` at most."""
    part, searched = bindparam("part", type_=shelf.table.c.name.type), shelf.table.c[shelf.words]
    query = select(searched).where(_is_there(shelf)).limit(bindparam("size"))
    if not is_indexed:
        return query.where(searched.like(part, escape="/"))
    index = table(shelf.index, column("rowid"))
    found = index.join(shelf.table, shelf.table.c.number == without_index(index.c.rowid))
    return query.select_from(found).where(_matches(shelf, part))


def _is_there(shelf: Shelf) -> Condition:
    return and_(shelf.table.c[shelf.there].is_not(None), visible(shelf.table))


def _likeness(word: str, other: str) -> float:
    return SequenceMatcher(None, word, other).ratio()
