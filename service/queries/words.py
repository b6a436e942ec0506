"""Words in a text of every name, and the most similar ones to a word that is nowhere.

Words of three letters and more are found by their trigrams, with FTS5 on SQLite and pg_trgm on PostgreSQL, which has it
as an extension; shorter ones, and all where there is no such index, by a look at every name.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from typing import Any

from sqlalchemy import Connection, Select, Table, and_, bindparam, column, or_, select, table, text

from service.database.tables import substructures, tree_names
from service.queries.membership import Condition, among
from service.queries.owners import seen_by, visible
from service.viewer import Viewer

TRIGRAM = 3  # letters
#: names that are looked at for a word that is in none, how much of it has to agree, and letters that may be exchanged
NEAR, LIKENESS, LONGEST = 500, 0.72, 30
_BETWEEN = re.compile(r"[\s\-_.,;:()\[\]]+")


@dataclass(frozen=True, slots=True)
class Shelf:
    """A table with a row for every name; ``words``: the column that words are looked for in, ``index``: FTS5's table of
    its trigrams, ``there``: a column that is NULL where nothing is left of a name.
    """

    table: Table
    words: str
    index: str
    there: str


PARTS = Shelf(substructures, "searchable", "substructure_words", "latest")
TREES = Shelf(tree_names, "name", "tree_words", "dof")


def words_of(text: str) -> tuple[str, ...]:
    """The words of a search, lower-case; NUL, which no database takes, is in no text."""
    return tuple(text.lower().replace("\0", "\ufffd").split())


def has(
    connection: Connection, shelf: Shelf, words: Sequence[str], where: str = "", in_order: bool = False
) -> Condition:
    """All words are in the text, that of the column ``where`` if it is given; ``in_order``: for rows in an order."""
    where = where or shelf.words
    searched = shelf.table.c[where]
    conditions = [searched.contains(word, autoescape=True) for word in words]
    long = [word for word in words if len(word) >= TRIGRAM]
    if not long or connection.dialect.name != "sqlite":  # PostgreSQL's index serves the same condition
        return and_(*conditions)
    quoted = " AND ".join('"{}"'.format(word.replace('"', '""')) for word in long)
    match = text(f"{shelf.index} MATCH :words")
    match = match.bindparams(bindparam("words", f"{where} : ({quoted})", unique=True))
    chosen: Select[Any] = select(column("rowid")).select_from(table(shelf.index)).where(match)
    short = [searched.contains(word, autoescape=True) for word in words if len(word) < TRIGRAM]
    number = shelf.table.c.number
    return and_(among(connection, number, chosen, is_listed=True) if in_order else number.in_(chosen), *short)


def corrected(connection: Connection, viewer: Viewer, shelf: Shelf, words: Sequence[str]) -> dict[str, str]:
    """For every word that is in no text that the viewer sees, the most similar one that is in one."""
    found = {}
    for word in words:
        known = select(shelf.table.c.name).where(_is_there(shelf), has(connection, shelf, [word]))
        if not connection.execute(known.limit(1), seen_by(viewer)).first():
            near = max(_near(connection, viewer, shelf, word), key=lambda other: _likeness(word, other), default=None)
            if near is not None and _likeness(word, near) >= LIKENESS:
                found[word] = near
    return found


def _is_there(shelf: Shelf) -> Condition:
    return and_(shelf.table.c[shelf.there].is_not(None), visible(shelf.table))


def _near(connection: Connection, viewer: Viewer, shelf: Shelf, word: str) -> set[str]:
    """Words with what a slip has left of a word: one of its halves, or all of it with two letters exchanged."""
    if len(word) <= TRIGRAM:
        return set()
    half = max(TRIGRAM, (len(word) + 1) // 2)
    exchanged = {f"{word[:k]}{word[k + 1]}{word[k]}{word[k + 2 :]}" for k in range(min(len(word), LONGEST) - 1)}
    left = {word[:half], word[-half:], *exchanged}
    has_some = or_(*(has(connection, shelf, [each]) for each in sorted(left)))
    query = select(shelf.table.c[shelf.words]).where(_is_there(shelf), has_some)
    rows = connection.execute(query.limit(NEAR), seen_by(viewer)).scalars()
    words = {each for row in rows for each in _BETWEEN.split(row)}
    return {each for each in words if any(some in each for some in left)}


def _likeness(word: str, other: str) -> float:
    return SequenceMatcher(None, word, other).ratio()
