"""Where versions come from: what they came as, what they were made from, which tree was published as them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, Self

from service.database.connections import Connection
from service.messages.references import parse_reference
from service.messages.refusals import unprocessable
from service.messages.viewer import Viewer
from service.operations.owners import absent_part
from service.queries import catalogue
from service.queries.catalogue import Provenance
from service.schemas.entries import PartEntry

Kind = Literal["definition", "import", "catalogue", "tree"]
#: field of an item of kind ``derive`` that says where its definition comes from
ORIGIN = "origin"


@dataclass(frozen=True, slots=True)
class Origin:
    """What a version came as; of a tree that was published its name, its revision and the digests of its parts."""

    kind: Kind = "definition"
    tree: str = ""
    revision: int = 0
    uses: Mapping[str, str] = field(default_factory=dict)

    def members(self) -> dict[str, Any]:
        """As a field of an item."""
        return {ORIGIN: {"kind": self.kind, "tree": self.tree, "revision": self.revision, "uses": dict(self.uses)}}

    @classmethod
    def of_item(cls, item: Mapping[str, Any]) -> Self:
        """Out of an item."""
        return cls(**item.get(ORIGIN, {}))


#: of what was read of a file
IMPORTED = Origin("import")


def derived_from(connection: Connection, viewer: Viewer, entry: PartEntry) -> tuple[str, int] | None:
    """Name and number of the version that another was made from. Raises Refused 422 for one that is not there."""
    if entry.derived_from is None:
        return None
    return pinned(connection, viewer, entry.derived_from, "/derived_from")


def pinned(connection: Connection, viewer: Viewer, text: str, pointer: str) -> tuple[str, int]:
    """Name and number of the version that a reference means. Raises Refused 422 with the pointer."""
    ref = parse_reference(text)
    version = None if ref is None else catalogue.resolve(connection, viewer, ref)
    if version is None:
        raise unprocessable("unknown-substructure", absent_part(connection, viewer, text), pointer)
    return version.name, version.version


def provenance(connection: Connection, viewer: Viewer, entry: PartEntry, origin: Origin) -> Provenance:
    """What is stored of it. Raises Refused 422."""
    tree = (origin.tree, origin.revision) if origin.tree else None
    return Provenance(entry.note or "", origin.kind, derived_from(connection, viewer, entry), tree)
