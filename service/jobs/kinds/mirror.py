"""mirror: an item is ``{"source": address}``: all public parts of another instance are stored here.

It needs the store at every step, and the network: the process that watches over the engine does it itself
(:mod:`service.queue.mirroring`), and no runner does.
"""

from __future__ import annotations

from service.jobs.engines.engine import Outcome
from service.jobs.kinds.items import Mirrored
from service.jobs.kinds.kind import Blobs, ItemProgress, Kind
from service.jobs.kinds.library import Library
from service.messages.refusals import Refused
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from service.sources import SCHEMES, SETTING, read_source
from substructures.documents import read_model
from substructures.errors import InvalidDocument

MIRROR_KIND = "mirror"


def _spread(item: ItemDocument, limits: Limits, library: Library) -> list[ItemDocument]:
    """The item with the address as it is listed."""
    try:
        source = read_source(read_model(Mirrored, item).source)
    except ValueError:
        message = f"the address of an instance is needed ({' or '.join(SCHEMES)}://host), without a path"
        raise InvalidDocument.at("/source", "bad-source", message) from None
    if source.key is not None:
        message = f"an address without a key: the operator gives the key in {SETTING}"
        raise InvalidDocument.at("/source", "bad-source", message)
    if source.address not in library.sources():
        message = f"'{source.address[:200]}' is none of the instances that the operator lists in {SETTING}"
        raise InvalidDocument.at("/source", "source-not-allowed", message)
    return [{"source": source.address, "nodes": limits.job_nodes}]


def _resolve(item: ItemDocument, _library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    return item, ()


def _run(_item: ItemDocument, _blobs: Blobs, _progress: ItemProgress) -> Outcome:
    raise Refused(500, "internal-error", "a mirror is made where the store is, and by no worker")


KINDS = {MIRROR_KIND: Kind(_spread, _resolve, _run)}
