"""Versions of parts and revisions of trees beside each other."""

from __future__ import annotations

from service.database.connections import Connection
from service.messages.references import parse_reference
from service.messages.viewer import Viewer
from service.operations import catalogue, owners


def used(connection: Connection, viewer: Viewer, text: str) -> tuple[str, int | None]:
    """The name and the version whose uses are wanted, None for all versions, of a bare name. Raises Refused 404."""
    ref = parse_reference(text)
    if ref is None or ref.is_pinned or ref.alias is not None:
        version = catalogue.find(connection, viewer, text)
        return version.name, version.version
    owners.seen(connection, viewer, "substructure", ref.name)
    return ref.name, None
