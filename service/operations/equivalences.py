"""Two models out of references, documents or robot files, compared."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from service.jobs.files import document_of
from service.jobs.kinds.compare import SIDES, pinned_side
from service.jobs.kinds.kind import inside
from service.jobs.worker import Worker
from service.operations.library import StoreLibrary
from service.refusals import moved
from service.store import Store
from service.viewer import Viewer
from substructures.errors import InvalidDocument


def compared(
    store: Store, viewer: Viewer, worker: Worker, a: Any, b: Any, coordinates: Mapping[str, str]
) -> Mapping[str, Any]:
    """Whether two models are the same, and what makes them different; each a reference, a definition, a tree, or
    ``{"file": text}``.

    A part that is compared with a tree gets its gravity; references are to what the viewer sees.
    Raises InvalidDocument, TooLarge, TimeoutError.
    """
    item: dict[str, Any] = {"coordinates": dict(coordinates), **store.work_limits}
    digests: list[str] = []
    for name, given in zip(SIDES, (a, b), strict=True):
        with moved(f"/{name}".__add__):
            document = _document(worker, given)
        with store.database.read() as connection, inside(f"/{name}"):
            pinned, needed = pinned_side(document, item["nodes"], StoreLibrary(connection, viewer))
            item[name] = {**pinned, **store.work_limits}
        digests += needed
    told = worker("compare", item, store.blobs(digests)).summary
    return {name: value for name, value in told.items() if name not in SIDES}


def _document(worker: Worker, given: Any) -> Any:
    """A reference or a document; of a file what is read of it."""
    if isinstance(given, str):
        return given
    if not isinstance(given, Mapping):
        raise InvalidDocument.at("", "object-expected", "a reference, a definition, a tree or a file is needed")
    return document_of(worker, given) if "file" in given else given
