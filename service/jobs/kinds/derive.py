"""derive: an item is a definition, for which a request may be too short; its outcome is what is stored of the part."""

from __future__ import annotations

from service.jobs.engine import Outcome
from service.jobs.kinds.kind import Blobs, Item, Kind, Progress
from service.jobs.kinds.library import Library
from service.settings import Limits
from service.summaries import part_content
from substructures.definition import Definition
from substructures.documents import read_json
from substructures.part import derive


def _spread(item: Item, limits: Limits, _library: Library) -> list[Item]:
    return [{"definition": item, "nodes": limits.job_nodes}]


def _resolve(item: Item, _library: Library) -> tuple[Item, tuple[str, ...]]:
    definition = Definition.read(item["definition"])
    return {**item, "definition": read_json(definition.canonical())}, ()


def _run(item: Item, _blobs: Blobs, _progress: Progress) -> Outcome:
    """Files ``program``, ``content``. Raises InvalidDocument, TooLarge."""
    part = derive(Definition.read(item["definition"]), item["nodes"])
    summary = {
        "name": part.name,
        "digest": part.definition.digest,
        "program": part.program.digest,
        "nodes": len(part.program),
        "dof": part.dof,
        "operations": part.operations["total"],
        "warnings": part.certificate["warnings"],
    }
    return Outcome(summary, part_content(part).files())


DERIVE = Kind(_spread, _resolve, _run)
