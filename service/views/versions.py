"""JSON of lists of versions and revisions, of the levels of a part, and of what uses it."""

from __future__ import annotations

from typing import Any

import orjson

from service.messages.addresses import BASE, version_path
from service.operations.differences import Level
from service.queries.uses import Use
from service.queries.versions import RevisionEntry, VersionEntry


def version_item(entry: VersionEntry) -> dict[str, Any]:
    """A version in the list of its name."""
    names = ("name", "version", "digest", "created", "author", "owner", "note", "origin", "derived_from", "tree", "dof")
    path = f"{BASE}/substructures/{entry.name}@{entry.version}"
    before = f"{BASE}/substructures/{entry.name}@{entry.before}/difference?to={entry.name}@{entry.version}"
    return {
        **{name: getattr(entry, name) for name in names},
        "operations": orjson.Fragment(entry.operations),
        "is_withdrawn": entry.withdrawn_at is not None,
        "withdrawn_at": entry.withdrawn_at,
        "withdrawal_reason": entry.withdrawal_reason,
        "successor": entry.successor,
        "links": {"self": path} | ({"difference": before} if entry.before else {}),
    }


def revision_item(entry: RevisionEntry) -> dict[str, Any]:
    """A revision in the list of its tree."""
    path = f"{BASE}/trees/{entry.name}@{entry.revision}"
    before = f"{BASE}/trees/{entry.name}@{entry.based_on}/difference?to={entry.name}@{entry.revision}"
    return {
        **{name: getattr(entry, name) for name in RevisionEntry.__slots__},
        "links": {"self": path} | ({"difference": before} if entry.based_on else {}),
    }


def level_view(level: Level) -> dict[str, Any]:
    """Another level of a part."""
    version, full, shorter = level.version, level.full, level.shorter
    return {
        "name": version.name,
        "version": version.version,
        "level": level.level,
        "dof": version.dof,
        "operations": orjson.Fragment(version.operations),
        "error": level.error,
        "rms": level.rms,
        "links": {
            "self": version_path(version),
            "levels": f"{version_path(version)}/levels",
            "difference": f"{version_path(full)}/difference?to={shorter.name}@{shorter.version}",
        },
    }


def use_view(use: Use) -> dict[str, Any]:
    """Something that uses a part."""
    kind = "trees" if use.kind == "tree" else "substructures"
    return {
        "kind": use.kind,
        "name": use.name,
        "number": use.number,
        "instances": dict(use.instances),
        "links": {"self": f"{BASE}/{kind}/{use.name}@{use.number}"},
    }
