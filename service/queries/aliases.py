"""Aliases of versions and their history."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import Connection, bindparam, insert, select, update

from service.database.tables import alias_history, aliases
from service.queries.common import insert_missing, now


@dataclass(frozen=True, slots=True)
class Alias:
    """An alias as it was set at one time; ``revision`` counts its changes."""

    alias: str
    version: int
    revision: int
    changed: str


@dataclass(frozen=True, slots=True)
class AliasHistoryEntry:
    """One entry of an alias's history."""

    revision: int
    version: int
    changed: str
    principal: str


# built once: it is part of every answer that shows a version
_ALIASES_OF = (
    select(aliases.c.name, aliases.c.version, aliases.c.alias)
    .where(aliases.c.name.in_(bindparam("names", expanding=True)))
    .order_by(aliases.c.alias)
)


def get_alias(connection: Connection, name: str, alias: str) -> Alias | None:
    """One alias of a substructure."""
    rows = list_aliases(connection, name)
    return next((row for row in rows if row.alias == alias), None)


def list_aliases(connection: Connection, name: str) -> list[Alias]:
    """All aliases of a substructure, by name."""
    columns = select(aliases.c.alias, aliases.c.version, aliases.c.revision, aliases.c.changed)
    rows = connection.execute(columns.where(aliases.c.name == name).order_by(aliases.c.alias))
    return [Alias(*row) for row in rows]


def aliases_of(connection: Connection, *versions: tuple[str, int]) -> list[list[str]]:
    """For every (name, version) the aliases that point to it."""
    names = {name for name, _ in versions}
    found: dict[tuple[str, int], list[str]] = {}
    for name, version, alias in connection.execute(_ALIASES_OF, {"names": list(names)}):
        found.setdefault((name, version), []).append(alias)
    return [found.get(version, []) for version in versions]


def history(connection: Connection, name: str, alias: str) -> list[AliasHistoryEntry]:
    """All changes of an alias, the newest first."""
    table = alias_history.c
    columns = select(table.revision, table.version, table.changed, table.principal)
    rows = connection.execute(columns.where(table.name == name, table.alias == alias).order_by(table.revision.desc()))
    return [AliasHistoryEntry(*row) for row in rows]


def set_alias(
    connection: Connection, name: str, alias: str, version: int, expected: int, principal: str
) -> Alias | None:
    """Point an alias to a version if its revision is ``expected`` (0: it must not exist); None when it is not."""
    changed = now()
    revision = expected + 1
    values = {"version": version, "revision": revision, "changed": changed}
    if expected == 0:
        done = insert_missing(connection, aliases, [{"name": name, "alias": alias, **values}])
    else:
        chosen = (aliases.c.name == name) & (aliases.c.alias == alias) & (aliases.c.revision == expected)
        done = connection.execute(update(aliases).where(chosen).values(**values)).rowcount
    if not done:
        return None
    row = {"name": name, "alias": alias, "principal": principal, **values}
    connection.execute(insert(alias_history).values(**row))
    return Alias(alias, version, revision, changed)
