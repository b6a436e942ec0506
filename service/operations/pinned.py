"""Stored trees as items of works: with their digests, and the contents that go with them."""

from __future__ import annotations

from service.jobs.kinds.trees import pinned
from service.operations.library import StoreLibrary
from service.queries.trees import Tree
from service.schemas.jobs import ItemDocument
from service.store import Store
from service.viewer import ANYBODY


def pinned_tree(store: Store, tree: Tree, has_parts: bool = True) -> tuple[ItemDocument, dict[str, bytes]]:
    """The fields of an item about a revision that was found for whoever asks, and its blobs; ``has_parts``: also the
    formulas of its parts. Raises Refused for content that is damaged or gone.
    """
    with store.database.read() as connection:
        reference, library = f"{tree.name}@{tree.revision}", StoreLibrary(connection, ANYBODY)
        item, digests = pinned({"tree": reference}, library, store.settings.limits.program_nodes, has_parts)
        if "inputs" not in item["model"]:
            item["model"] |= store.declared(connection, tree)
    return item, store.blobs(digests)
