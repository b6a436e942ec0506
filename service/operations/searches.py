"""Pages of what a search finds, of the most similar words where there is nothing with the words themselves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Generic, TypeVar

from service.content.cache import Cache
from service.database.connections import Connection
from service.messages.paging import is_of, of_no_page, read_token, write_token
from service.messages.refusals import unprocessable
from service.messages.viewer import Viewer
from service.queries import audit
from service.queries.catalogue import Version
from service.queries.searching import part_search, tree_search
from service.queries.searching.part_search import CatalogueSearch, Facets
from service.queries.searching.search import RELEVANCE, SORTS, Search, number_of
from service.queries.searching.tree_search import TreeSearch
from service.queries.searching.words import corrected
from service.queries.trees import Tree
from substructures.errors import meant

Found = TypeVar("Found", Version, Tree)
Wanted = TypeVar("Wanted", bound=Search)


@dataclass(frozen=True, slots=True)
class Page(Generic[Found]):
    """A page of what was found, where the next one begins, the counts of the whole search, and words that were taken in
    place of those that are nowhere.
    """

    items: Sequence[Found]
    next_token: str | None
    facets: Facets | None = None
    instead: Mapping[str, str] = field(default_factory=dict)


def checked(wanted: Wanted) -> Wanted:
    """A search that can be carried out, by relevance where no other order is given and there are words.

    Raises Refused 422 for an unknown order, and for ranges of which nothing can be in.
    """
    wanted = replace(wanted, sort=wanted.sort or (RELEVANCE if wanted.words else "name"))
    if wanted.sort not in SORTS:
        detail = f"unknown sort '{wanted.sort[:40]}'; there are {', '.join(SORTS)}{meant(wanted.sort, SORTS)}"
        raise unprocessable("sort", detail, "/query/sort")
    for name in ("dof", "mass"):
        least, most = (getattr(wanted, f"{name}_{end}") for end in ("min", "max"))
        if least is not None and most is not None and least > most:
            detail = f"{name}_min is {least:g}, and {name}_max only {most:g}: nothing can be between them"
            raise unprocessable("empty-range", detail, f"/query/{name}_min")
    return wanted


def parts(
    connection: Connection,
    viewer: Viewer,
    wanted: CatalogueSearch,
    size: int,
    token: str | None,
    facets: Cache[Facets] | None = None,
) -> Page[Version]:
    """A page of the latest versions. ``facets``: also counts of the whole search, kept there. Raises Refused 422 for a
    token of another search.
    """
    found, wanted = _found(connection, viewer, wanted, size, token, part_search.page)
    if facets is None:
        return found
    key = (audit.state(connection), viewer.owner, viewer.is_admin, replace(wanted, sort=""))
    return replace(found, facets=facets.once(key, lambda: part_search.facets(connection, viewer, wanted)))


def trees(connection: Connection, viewer: Viewer, wanted: TreeSearch, size: int, token: str | None) -> Page[Tree]:
    """A page of the latest revisions of trees. Raises as :func:`parts`."""
    return _found(connection, viewer, wanted, size, token, tree_search.page)[0]


Read = Callable[[Connection, Viewer, Wanted, tuple[Any, ...] | None, int], list[tuple[Found, Any]]]


def _found(
    connection: Connection, viewer: Viewer, wanted: Wanted, size: int, token: str | None, read: Read[Wanted, Found]
) -> tuple[Page[Found], Wanted]:
    """A page, and what was searched for."""
    is_of_words = token is None or is_of(wanted, token)
    shown = _page(connection, viewer, wanted, size, token, read) if is_of_words else None
    instead: dict[str, str] = {}
    if wanted.words and not (shown and shown.items):
        instead = corrected(connection, viewer, wanted.shelf, wanted.words)
        wanted = wanted.with_words(instead)
        shown = None if instead else shown
    shown = shown or _page(connection, viewer, wanted, size, token, read)
    return replace(shown, instead=instead), wanted


def _page(
    connection: Connection, viewer: Viewer, wanted: Wanted, size: int, token: str | None, read: Read[Wanted, Found]
) -> Page[Found]:
    is_number = wanted.is_by_words or wanted.sort.lstrip("-") == "dof"
    after = read_token(wanted, token, int if is_number else str, str)
    if after is not None and wanted.is_by_words:
        number = number_of(connection, viewer, wanted.shelf, after[1])
        if number is None:
            raise of_no_page()
        after = after[0], number
    found = read(connection, viewer, wanted, after, size + 1)
    following = None
    if len(found) > size:
        last, (value, _) = found[size - 1]
        following = write_token(wanted, value, last.name)  # numbers would tell how many names others have
    return Page([each for each, _ in found[:size]], following)
