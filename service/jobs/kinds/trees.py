"""Items about a stored tree: pinned with its program, and with its parts where the formulas are not enough."""

from __future__ import annotations

from collections.abc import Mapping

from service.analyses.source import Source
from service.cache import Cache
from service.jobs.kinds.assemble import pinned_tree, tree_parts
from service.jobs.kinds.decoded import model_of, pinned_model
from service.jobs.kinds.kind import Blobs, known_tree
from service.jobs.kinds.library import Library
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.documents import read_json
from substructures.quantities.regressor import RegressorModel, regressor

CAPACITY = 2_000_000  # operations

_regressors: Cache[RegressorModel] = Cache(CAPACITY, lambda found: len(found.program))


def pinned(item: ItemDocument, library: Library, nodes: int, has_parts: bool) -> tuple[ItemDocument, tuple[str, ...]]:
    """The item with its tree pinned, and the digests of the blobs that it needs.

    ``has_parts``: also the parts, from which the regressor is derived with at most ``nodes`` operations. Raises
    InvalidDocument.
    """
    tree = known_tree(item, library)
    found = {"tree": f"{tree.name}@{tree.digest}", "program": tree.program, "model": pinned_model(tree)}
    if not has_parts:
        return {**item, **found}, (tree.program,)
    parts, blobs = pinned_tree({"tree": read_json(tree.spec.encode()), "nodes": nodes}, library)
    return {**item, **found, "parts": parts}, (tree.program, *blobs)


def regressor_of(item: ItemDocument, blobs: Blobs) -> RegressorModel:
    """The regressor of the tree of an item with parts. Raises InvalidDocument, TooLarge."""
    found = _regressors.get(item["tree"])
    if found is None:
        parts = item["parts"]
        found = regressor(*tree_parts(parts, blobs), parts["nodes"])
        _regressors.put(item["tree"], found)
    return found


def source_of(item: ItemDocument, blobs: Blobs, limits: Mapping[str, int]) -> Source:
    """What analyses of the tree of an item work on. Raises InvalidProgram."""
    digest = item["tree"].partition("@")[2]
    return Source(model_of(item, blobs), digest, lambda: regressor_of(item, blobs), Limits(**limits))
