"""What was read of folders, and the versions that were stored of their files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, select, update

from service.database.tables import folders, substructures, versions
from service.queries.common import insert_missing, now
from service.settings import Settings


@dataclass(frozen=True, slots=True)
class Stored:
    """A version of a name."""

    version: int
    withdrawn_at: str | None
    withdrawal_reason: str | None


def state(connection: Connection, settings: Settings) -> dict[str, Any] | None:
    """What was read of the folder of a server last; None where it has none."""
    if not settings.folder:
        return None
    text = connection.execute(select(folders.c.state).where(folders.c.path == path_of(settings))).scalar()
    return nothing(settings) if text is None else dict(json.loads(text))


def nothing(settings: Settings) -> dict[str, Any]:
    """What is told of a folder that was not read yet."""
    lists: dict[str, Any] = {name: [] for name in ("files", "refused", "gone", "waiting")}
    return {"folder": Path(path_of(settings)).name, **lists, "not_read": {"count": 0, "items": []}, "changed": None}


def note(connection: Connection, settings: Settings, told: Mapping[str, Any]) -> None:
    """Note what was read."""
    row = {"path": path_of(settings), "state": json.dumps({**told, "changed": now()})}
    if not insert_missing(connection, folders, [row]):
        connection.execute(update(folders).where(folders.c.path == row["path"]).values(state=row["state"]))


def path_of(settings: Settings) -> str:
    """What a folder is known by: links in it may lead elsewhere tomorrow."""
    return str(Path(settings.folder).absolute())


def versions_of(connection: Connection, name: str, author: str) -> list[Stored]:
    """The versions of a name that somebody has stored, the oldest first."""
    columns = (versions.c[each] for each in Stored.__slots__)
    chosen = select(*columns).where(versions.c.name == name, versions.c.author == author)
    return [Stored(*row) for row in connection.execute(chosen.order_by(versions.c.version))]


def latest(connection: Connection, name: str) -> int | None:
    """The number of the version that a bare name means."""
    return connection.execute(select(substructures.c.latest).where(substructures.c.name == name)).scalar()
