"""Preconditions of requests that change trees and parts, by ETags (RFC 9110, section 13.1)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from service.database.connections import Connection
from service.messages.answers import etag, names
from service.messages.references import Reference
from service.messages.refusals import Refused
from service.messages.viewer import Viewer
from service.queries import aliases, catalogue, trees, uses
from service.queries.catalogue import Version
from service.queries.uses import Withdrawn
from service.store.store import Store


@dataclass(frozen=True, slots=True)
class Expected:
    """What a request expects the latest revision of a tree, or version of a part, to be, by ETags; None: anything."""

    if_match: str | None = None
    if_none_match: str | None = None

    def members(self) -> dict[str, Any]:
        """For the item of a job that does what the request asks for."""
        return {} if self == ANY else {EXPECTED: asdict(self)}

    @classmethod
    def of_item(cls, item: Mapping[str, Any]) -> Expected:
        """The same, out of the item."""
        return cls(**item.get(EXPECTED, {}))


ANY, EXPECTED = Expected(), "expected"


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
    require(f"the tree '{name}'", tag, expected)
    return tree.revision if tree else 0


def version_tag(version: Version, names: Sequence[str], withdrawn: Sequence[Withdrawn]) -> str:
    """The ETag of a version: what it refers to may become visible, or be withdrawn."""
    seen = (version.derived_from, version.successor, version.tree)
    shown = [*(each for each in seen if each), *(f"{each.instance}:{each.successor}" for each in withdrawn)]
    said = version.digest, version.program, str(version.version), str(version.withdrawn_at), version.visibility
    return etag(*said, *shown, *names)


def require_part(connection: Connection, viewer: Viewer, name: str, expected: Expected) -> None:
    """Raise Refused 412 where a request expects the latest version of a part to be something, and it is something else;
    a part whose versions are all withdrawn is there, and none of them is the latest.
    """
    if expected == ANY:
        return
    version = catalogue.resolve(connection, viewer, Reference(name))
    none = None if catalogue.last(connection, viewer, name) is None else ""
    require(f"the part '{name}'", none if version is None else tag_of(connection, viewer, version), expected)


def tag_of(connection: Connection, viewer: Viewer, version: Version) -> str:
    """The ETag of a version."""
    (known,) = aliases.aliases_of(connection, (version.name, version.version))
    return version_tag(version, known, uses.withdrawn_in_part(connection, viewer, version.digest))


def require(what: str, tag: str | None, expected: Expected) -> None:
    """Raise Refused 412 unless something is what is expected; ``tag``: None where it is not there, empty where what is
    there has none.
    """
    if expected.if_match is not None:
        require_match(what, tag, expected.if_match)
    if tag is not None and expected.if_none_match is not None and names(expected.if_none_match, tag):
        detail = f"{what} is there, which If-None-Match says it is not" + (f"; it is {tag}" if tag else "")
        raise Refused(412, "precondition-failed", detail, headers={"ETag": tag} if tag else {})


def require_match(what: str, tag: str | None, if_match: str) -> None:
    """Raise Refused 412 unless If-Match names the tag of a tree or version; None: there is none."""
    if not tag or not names(if_match, tag):
        now = f"it is {tag} now" if tag else "there is none"
        detail = f"{what} is not what If-Match says; {now}"
        raise Refused(412, "precondition-failed", detail, headers={"ETag": tag} if tag else {})
