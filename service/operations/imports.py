"""Foreign files as definitions or trees; what of them is stored is stored like any other document."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from service.database.connections import Connection
from service.operations import catalogue, trees
from service.operations.provenance import Origin
from service.queries.trees import Tree
from service.schemas.entries import PLAIN
from service.store import Store
from service.viewer import Viewer
from substructures.documents import write_json
from substructures.interchange.importing import Imported
from substructures.part.part import Part

IMPORTED = Origin("import")


@dataclass(frozen=True, slots=True)
class ImportedTree:
    """A tree ready to be stored, after the parts that it names."""

    parts: Sequence[catalogue.PartSubmission]
    revision: trees.Revision


def prepare(store: Store, viewer: Viewer, found: Imported) -> ImportedTree:
    """Derive the parts of a file and couple them. Raises as submissions of parts and trees."""
    revision = trees.prepare(store, viewer, found.tree, PLAIN, named=True)
    parts = revision.parts.values()
    made = [catalogue.prepare(store, viewer, p.definition, PLAIN, IMPORTED, partial(_given, p)) for p in parts]
    return ImportedTree(made, revision)


def _given(part: Part) -> Part:
    return part


def commit(connection: Connection, viewer: Viewer, made: ImportedTree) -> tuple[Tree, bool]:
    """Store the parts and the tree: the tree, and whether it is new. Raises as submissions of parts and trees."""
    for part in made.parts:
        catalogue.submit(connection, viewer, part)
    return trees.commit(connection, viewer, made.revision)


def answer_of(found: Imported, stored: dict[str, Any] | None = None) -> bytes:
    """The body of an answer: what was read, the report, and what became of it in the store."""
    return write_json({**found.plain(), **({} if stored is None else {"stored": stored})})
