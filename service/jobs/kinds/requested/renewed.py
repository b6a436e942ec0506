"""What is stored, derived anew of its own documents (:mod:`service.operations.renewal`): works of the service."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from service.content.derivation import derived_part
from service.content.summaries import part_content
from service.content.tree_summaries import tree_summary
from service.database.packed import pack
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.decoded import part_of
from service.jobs.kinds.kind import Blobs
from service.schemas.jobs import ItemDocument
from substructures.tree.couple import couple_shape
from substructures.tree.document import TreeSpec, with_levels
from substructures.tree.plausibility import Plausibility

Renewed = Callable[[ItemDocument, Blobs], Outcome]


def _part(item: ItemDocument, blobs: Blobs) -> Outcome:
    """Files ``program``, ``content`` of the definition with this digest. Raises as
    :func:`service.content.derivation.derived_part`."""
    part = derived_part(blobs[item["definition"]], item["recipe"], item["nodes"])
    return Outcome(files=part_content(part, item["recipe"]).files())


def _tree(item: ItemDocument, blobs: Blobs) -> Outcome:
    """Files ``program`` (packed), ``summary``, ``form`` of a stored document; ``parts``: the digests of definition and
    program of every instance. Raises as :func:`substructures.tree.couple.couple_shape`."""
    parts = {name: part_of(definition, program, blobs) for name, (definition, program) in item["parts"].items()}
    definitions = {name: part.definition for name, part in parts.items()}
    spec = TreeSpec.stored(item["tree"])
    model = couple_shape(with_levels(spec, definitions), parts, item["nodes"])
    mass = Plausibility(spec, definitions).mass
    told = {"program": model.program.digest, "nodes": len(model.program)}
    told |= {"dof": model.dof, "joints": model.joints, "mass": mass}
    return Outcome(told, {"program": pack(model.program), **tree_summary(spec, model).files()})


REQUESTED: Mapping[str, Renewed] = {"renew-part": _part, "renew-tree": _tree}
