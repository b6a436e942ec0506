"""What is written when an item succeeds: a tree, a version of a substructure, or files kept as they are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from service.database import Connection
from service.jobs.engine import Outcome
from service.operations import catalogue, trees
from service.operations.catalogue import Submission
from service.queries import results
from service.queries.queue import Attempt
from service.store import Store
from service.views import tree_path, version_path
from substructures.definition import Definition
from substructures.documents import read_json, write_json
from substructures.part import Part
from substructures.tree import TreeSpec

#: fields of an item that changes a tree: the number of the revision that it changes, and whether that was pinned
BASE, IS_EXACT = "base", "is_exact"


def keep(store: Store, connection: Connection, attempt: Attempt, outcome: Outcome) -> None:
    """Store an outcome under the key of its item, in the transaction that completes the item."""
    stored: dict[str, Any] = {}
    files: Mapping[str, bytes] = {}
    match attempt.kind:
        case "assemble":
            stored = _tree(connection, read_json(attempt.item.encode()), outcome)
        case "derive":
            stored = _version(store, connection, outcome)
        case _:
            files = outcome.files
    summary = write_json({**outcome.summary, **stored}).decode()
    results.put_result(connection, attempt.key, attempt.kind, summary, files)


def _tree(connection: Connection, item: Mapping[str, Any], outcome: Outcome) -> dict[str, Any]:
    spec, files = TreeSpec.read(read_json(outcome.files["spec"])), outcome.files
    inline = [_part(files, f"{each.name}.") for each in spec.instances if each.definition is not None]
    figures, parts = (outcome.summary["nodes"], outcome.summary["dof"]), outcome.summary["parts"]
    coupled = trees.Coupled(spec, files["program"], *figures, files["summary"], parts, inline)
    tree, _ = trees.store(connection, coupled, item.get(BASE), bool(item.get(IS_EXACT)))
    return {"revision": tree.revision, "tree": f"{tree.name}@{tree.revision}", "location": tree_path(tree)}


def _version(store: Store, connection: Connection, outcome: Outcome) -> dict[str, Any]:
    part = _part(outcome.files, "")
    store.remember_part(part)
    version, _ = catalogue.submit(connection, Submission(part.definition, part))
    return {"version": version.version, "location": version_path(version)}


def _part(files: Mapping[str, bytes], prefix: str) -> Part:
    definition = Definition.read(read_json(files[f"{prefix}definition"]))
    return Part.load(definition, files[f"{prefix}program"], read_json(files[f"{prefix}certificate"]))
