"""Foreign files as definitions or trees; what of them is stored is stored like any other document."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from service.content.summaries import PartContent
from service.database.connections import Connection
from service.jobs.worker import Worker
from service.messages.viewer import Viewer
from service.operations import catalogue, trees
from service.operations.sharing.provenance import IMPORTED
from service.queries.trees import Tree
from service.schemas.entries import PLAIN, PartEntry
from service.store.store import Store
from substructures.documents import read_json, write_json
from substructures.part.definition import Definition


@dataclass(frozen=True, slots=True)
class ImportedTree:
    """A tree ready to be stored, after the parts that it names."""

    parts: Sequence[catalogue.PartSubmission]
    revision: trees.Revision


def with_preview(store: Store, worker: Worker, found: Mapping[str, Any]) -> Mapping[str, Any]:
    """What was read, with what would be stored of it. Raises InvalidDocument, TooLarge, TimeoutError."""
    kind = "tree" if "tree" in found else "definition"
    item = {kind: found[kind], "nodes": store.settings.limits.program_nodes}
    return {**found, "preview": worker("preview", item).summary}


def prepare(
    store: Store, viewer: Viewer, worker: Worker, tree: Mapping[str, Any], entry: PartEntry = PLAIN
) -> ImportedTree:
    """Derive the parts of a file and couple them; ``entry``: of all. Raises as submissions of parts and trees."""
    revision = trees.prepare(store, viewer, worker, tree, entry, named=True)
    made = []
    for content in revision.coupled.inline:
        definition = Definition.stored(read_json(content.row["definition"].encode()))
        made.append(catalogue.prepare(store, viewer, definition, entry, IMPORTED, partial(_given, content)))
    return ImportedTree(made, revision)


def _given(content: PartContent) -> PartContent:
    return content


def commit(connection: Connection, viewer: Viewer, made: ImportedTree) -> tuple[Tree, bool]:
    """Store the parts and the tree: the tree, and whether it is new. Raises as submissions of parts and trees."""
    for part in made.parts:
        catalogue.submit(connection, viewer, part)
    return trees.commit(connection, viewer, made.revision)


def answer_of(found: Mapping[str, Any], stored: dict[str, Any] | None = None) -> bytes:
    """The body of an answer: what was read, the report, and what became of it in the store."""
    return write_json({**found, **({} if stored is None else {"stored": stored})})
