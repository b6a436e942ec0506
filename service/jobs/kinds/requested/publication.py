"""Trees that become parts: a work of requests."""

from __future__ import annotations

from service.content.summaries import part_content
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.assemble import tree_parts
from service.jobs.kinds.kind import Blobs, admitted
from service.schemas.jobs import ItemDocument
from service.schemas.publishing import PublishRequest
from substructures.documents import read_model
from substructures.tree.publishing.published import Publication, published
from substructures.tree.publishing.published_formulas import published_part


def publication_of(request: PublishRequest, name: str) -> Publication:
    """What a tree shall become; ``name``: of the part."""
    return Publication({"name": name, **request.about()}, request.ports, tuple(request.free), request.defaults)


def _publish(item: ItemDocument, blobs: Blobs) -> Outcome:
    """What is stored of the part that a tree becomes."""
    spec, parts = tree_parts(item["parts"], blobs)
    found = published(spec, parts, publication_of(read_model(PublishRequest, item["request"]), item["name"]))
    part = published_part(found, parts, item["nodes"], admitted(item))
    return Outcome(files=part_content(part, item["recipe"]).files())


REQUESTED = {"publish": _publish}
