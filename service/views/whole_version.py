"""A version with all that is told of it, for the endpoints that answer one."""

from __future__ import annotations

from typing import Any

from service.database.connections import Connection
from service.messages.viewer import Viewer
from service.queries import aliases, uses
from service.queries.catalogue import Version
from service.views.resources import version_view


def names_of(connection: Connection, version: Version) -> list[str]:
    """The aliases that point to a version."""
    return aliases.aliases_of(connection, (version.name, version.version))[0]


def whole_view(connection: Connection, viewer: Viewer, version: Version) -> dict[str, Any]:
    """A version with all that is told of it alone."""
    withdrawn = uses.withdrawn_in_part(connection, viewer, version.digest)
    return version_view(version, names_of(connection, version), withdrawn)
