"""Terms by which the latest versions are found at once: tags, ports, and the first letters of words."""

from __future__ import annotations

import re
from typing import Any, Final

import orjson
from sqlalchemy import Connection, Select, bindparam, delete, select

from service.database.tables import search_terms
from service.queries.common import put_all

#: kinds of terms; the last: of every word of name, title and tags the first letter, and the first two
TAG, PORT, START = "tag", "port", "start"
LETTERS: Final = 2
_WORD = re.compile(r"[^\W_]+")

Term = tuple[str, str]


def terms_of(name: str, title: str, tags: str, ports: str) -> set[Term] | None:
    """The terms of a version, each with its kind; tags and ports are JSON as they are stored.

    None of a damaged one: whoever reads it refuses it by name.
    """
    try:
        labels, frames = orjson.loads(tags), orjson.loads(ports)
    except ValueError:
        return None
    words = _WORD.findall(" ".join((name, title, *labels)).lower())
    starts = {word[:size] for word in words for size in range(1, LETTERS + 1)}
    return {
        *((TAG, tag) for tag in labels),
        *((PORT, port) for port in frames),
        *((START, each) for each in starts if is_start(each)),
    }


def is_start(word: str) -> bool:
    """Whether a word of a search is looked for where words begin: of so few letters most are somewhere within one. In
    scripts that leave no space between words it may stand anywhere.
    """
    return len(word) <= LETTERS and word.isascii() and word.isalnum()


def names_with(kind: str, term: str) -> Select[Any]:
    """The names whose latest versions have a term; SQLite finds them in their order."""
    return select(search_terms.c.name).where(search_terms.c.kind == kind, search_terms.c.term == term)


def stored_terms(connection: Connection, name: str) -> set[Term]:
    """The terms that a name is found by."""
    query = select(search_terms.c.kind, search_terms.c.term).where(search_terms.c.name == name)
    return {(kind, term) for kind, term in connection.execute(query)}


def exchange(connection: Connection, name: str, before: set[Term] | None, after: set[Term]) -> None:
    """Let a name have other terms than before; None where these are not known."""
    if before is None:
        connection.execute(delete(search_terms).where(search_terms.c.name == name))
        before = set()
    if gone := [{"of_kind": kind, "of_term": term, "of_name": name} for kind, term in sorted(before - after)]:
        connection.execute(_GONE, gone)
    new = [{"kind": kind, "term": term, "name": name} for kind, term in sorted(after - before)]
    put_all(connection, search_terms, new)


# Built once: to build a statement takes longer than to execute it.
_GONE = delete(search_terms).where(
    *(search_terms.c[name] == bindparam(f"of_{name}") for name in ("kind", "term", "name"))
)
