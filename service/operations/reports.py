"""Reports about stored parts and trees: in words, as a document, as a page."""

from __future__ import annotations

from collections.abc import Mapping

from service.jobs.worker import Worker
from service.messages.answers import Answer
from service.operations.sharing.sources import pinned_tree
from service.queries.catalogue import Version
from service.queries.trees import Tree
from service.schemas.jobs import ItemDocument
from service.store.store import Store

FORMATS: Mapping[str, str] = {
    "json": "application/json",
    "text": "text/plain; charset=utf-8",
    "latex": "application/x-latex; charset=utf-8",
    "mathml": "application/xhtml+xml; charset=utf-8",
}


def of_part(
    store: Store,
    worker: Worker,
    version: Version,
    format: str,  # noqa: A002 -- in the contract
    document: bool,
) -> Answer:
    """The report about a part alone in one of FORMATS; ``document``: LaTeX with its head and end. Raises TooLarge,
    Refused for damaged content, TimeoutError.
    """
    item = {"definition": version.digest, "program": version.program, "called": f"{version.name}@{version.version}"}
    return _written(store, worker, item, store.blobs((version.digest, version.program)), format, document)


def of_tree(store: Store, worker: Worker, tree: Tree, format: str, document: bool) -> Answer:  # noqa: A002 -- as above
    """The report about a revision of a tree; as :func:`of_part`."""
    item, blobs = pinned_tree(store, tree)
    return _written(store, worker, {**item, "called": f"{tree.name}@{tree.revision}"}, blobs, format, document)


def _written(
    store: Store,
    worker: Worker,
    item: ItemDocument,
    blobs: Mapping[str, bytes],
    format: str,  # noqa: A002 -- as above
    document: bool,
) -> Answer:
    how = {"format": format, "document": document, "nodes": store.settings.limits.program_nodes}
    return Answer(200, worker("report", {**item, **how}, blobs).files["report"], {"Content-Type": FORMATS[format]})
