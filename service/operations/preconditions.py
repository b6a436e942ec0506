"""Preconditions of requests that change trees, by ETags (RFC 9110, section 13.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from service.database.connections import Connection
from service.messages.answers import etag, names
from service.messages.references import Reference
from service.messages.refusals import Refused
from service.messages.viewer import Viewer
from service.queries import trees, uses
from service.queries.uses import Withdrawn
from service.store.store import Store


@dataclass(frozen=True, slots=True)
class Expected:
    """What a request expects the latest revision of a tree to be, by ETags; None: anything."""

    if_match: str | None = None
    if_none_match: str | None = None


ANY = Expected()


def tree_tag(tree: trees.Tree, withdrawn: Sequence[Withdrawn] = ()) -> str:
    """The ETag of a tree; ``withdrawn``: those of its instances whose parts are withdrawn."""
    gone = [f"{each.instance}:{each.successor}" for each in withdrawn]
    return etag(tree.digest, tree.program, str(tree.revision), *([] if tree.is_public else [tree.visibility]), *gone)


def withdrawn(connection: Connection, viewer: Viewer, tree: trees.Tree) -> Sequence[Withdrawn]:
    """The instances of a tree whose parts are withdrawn, with reason and successor."""
    return uses.withdrawn(connection, viewer, tree.name, tree.revision)


def latest_as(store: Store, viewer: Viewer, name: str, expected: Expected) -> int | None:
    """The number that the latest revision of a tree has to have where a request expects it to be something, 0 where it
    expects none. Raises Refused 412 when it is something else.
    """
    if expected == ANY:
        return None
    with store.database.read() as connection:
        tree = trees.resolve(connection, viewer, Reference(name))
        tag = tree_tag(tree, withdrawn(connection, viewer, tree)) if tree else None
    if expected.if_match is not None:
        require_match(name, tag, expected.if_match)
    if tag is not None and expected.if_none_match is not None and names(expected.if_none_match, tag):
        detail = f"there is a tree '{name}', which If-None-Match says there is not; it is {tag}"
        raise Refused(412, "precondition-failed", detail, headers={"ETag": tag})
    return tree.revision if tree else 0


def require_match(text: str, tag: str | None, if_match: str) -> None:
    """Raise Refused 412 unless If-Match names the tag of a tree; None: there is no such tree."""
    if tag is None or not names(if_match, tag):
        now = f"it is {tag} now" if tag else "there is none"
        detail = f"the tree '{text}' is not what If-Match says; {now}"
        raise Refused(412, "precondition-failed", detail, headers={"ETag": tag} if tag else {})
