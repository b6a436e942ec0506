"""Items about a stored tree: pinned with its program, and with its parts where the formulas are not enough."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from service.content.cache import Cache
from service.jobs.kinds.assemble import pinned_tree, tree_parts
from service.jobs.kinds.decoded import model_of, pinned_model
from service.jobs.kinds.kind import Blobs, known_tree
from service.jobs.kinds.library import Library
from service.models.source import Source
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.documents import read_json
from substructures.part.definition import Definition
from substructures.quantities.sources import Sources, of_parts
from substructures.tree.document import Instance, TreeSpec
from substructures.tree.plausibility import Plausibility

CAPACITY = 2_000_000  # operations

TREES = 200  # with what judges their values

_plausibilities: Cache[Plausibility] = Cache(TREES, lambda _: 1)
_kept: Cache[Any] = Cache(CAPACITY, lambda found: len(found.program))


def pinned(item: ItemDocument, library: Library, nodes: int, has_parts: bool) -> tuple[ItemDocument, tuple[str, ...]]:
    """The item with its tree pinned, and the digests of the blobs that it needs: program and definitions.

    ``has_parts``: also the parts, from which more is derived with at most ``nodes``
    operations. Raises InvalidDocument.
    """
    tree = known_tree(item, library)
    spec = read_json(tree.spec.encode())
    found = {"tree": f"{tree.name}@{tree.digest}", "program": tree.program, "model": pinned_model(tree), "spec": spec}
    if not has_parts:
        references = (instance.get("substructure", "") for instance in spec.get("instances", ()))
        definitions = dict.fromkeys(digest for each in references if (digest := each.partition("@")[2]))
        return {**item, **found}, (tree.program, *definitions)
    parts, blobs = pinned_tree({"tree": spec, "nodes": nodes}, library, is_stored=True)
    return {**item, **found, "parts": parts}, (tree.program, *blobs)


def plausibility_of(item: ItemDocument, blobs: Blobs) -> Plausibility:
    """What judges the values that the tree of an item is evaluated with."""
    found = _plausibilities.get(item["tree"])
    if found is None:
        spec = TreeSpec.stored(item["spec"])
        found = Plausibility(spec, {each.name: _definition(each, blobs) for each in spec.instances})
        _plausibilities.put(item["tree"], found)
    return found


def _definition(instance: Instance, blobs: Blobs) -> Definition:
    if instance.definition is not None:
        return instance.definition
    return Definition.stored(read_json(blobs[instance.digest]))


def sources_of(item: ItemDocument, blobs: Blobs) -> Sources:
    """What quantities of the tree of an item are computed from. Raises InvalidProgram."""
    return Sources(
        model_of(item, blobs),
        of_parts=(lambda name: _of_parts(item, blobs, name)) if "parts" in item else None,
        plausibility=(lambda: plausibility_of(item, blobs)) if "spec" in item else None,
    )


def _of_parts(item: ItemDocument, blobs: Blobs, name: str) -> Any:
    """What is derived of the parts of a tree beside its model. Raises InvalidDocument, TooLarge."""
    parts: ItemDocument = item["parts"]
    key = item["tree"], name, *sorted(parts["programs"].values())
    return _kept.once(key, lambda: of_parts(*tree_parts(parts, blobs), parts["nodes"])(name))


def source_of(item: ItemDocument, blobs: Blobs, limits: Mapping[str, int]) -> Source:
    """What analyses of the tree of an item work on. Raises InvalidProgram."""
    digest = item["tree"].partition("@")[2]
    parts = (lambda: tree_parts(item["parts"], blobs)) if "parts" in item else None
    return Source(sources_of(item, blobs), digest, Limits(**limits), parts=parts)
