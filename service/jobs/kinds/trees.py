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
from substructures.part.definition import Definition
from substructures.quantities.evaluation import Sources
from substructures.quantities.powers import PowerModel, powers
from substructures.quantities.reactions import ReactionModel, reactions
from substructures.quantities.regressor import RegressorModel, regressor
from substructures.tree.document import Instance, TreeSpec
from substructures.tree.model import Model, couple
from substructures.tree.plausibility import Plausibility

CAPACITY = 2_000_000  # operations

TREES = 200  # with what judges their values

_plausibilities: Cache[Plausibility] = Cache(TREES, lambda _: 1)
_powers: Cache[PowerModel] = Cache(CAPACITY, lambda found: len(found.program))
_reactions: Cache[ReactionModel] = Cache(CAPACITY, lambda found: len(found.program))
_regressors: Cache[RegressorModel] = Cache(CAPACITY, lambda found: len(found.program))


def pinned(item: ItemDocument, library: Library, nodes: int, has_parts: bool) -> tuple[ItemDocument, tuple[str, ...]]:
    """The item with its tree pinned, and the digests of the blobs that it needs: program and definitions.

    ``has_parts``: also the parts, from which regressor, reactions and powers are derived with at most ``nodes``
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
    regressor = (lambda: regressor_of(item, blobs)) if "parts" in item else None
    plausibility = (lambda: plausibility_of(item, blobs)) if "spec" in item else None
    transmitted = (lambda: reactions_of(item, blobs)) if "parts" in item else None
    by_load = (lambda: powers_of(item, blobs)) if "parts" in item else None
    model = model_of(item, blobs)
    return Sources(model, regressor=regressor, plausibility=plausibility, reactions=transmitted, powers=by_load)


def powers_of(item: ItemDocument, blobs: Blobs) -> PowerModel:
    """The powers of loads and joints of the tree of an item with parts. Raises InvalidDocument, TooLarge."""
    found = _powers.get(_key(item))
    if found is None:
        parts = item["parts"]
        found = powers(*tree_parts(parts, blobs), parts["nodes"])
        _powers.put(_key(item), found)
    return found


def reactions_of(item: ItemDocument, blobs: Blobs) -> ReactionModel:
    """The reactions of the tree of an item with parts. Raises InvalidDocument, TooLarge."""
    found = _reactions.get(_key(item))
    if found is None:
        parts = item["parts"]
        found = reactions(*tree_parts(parts, blobs), parts["nodes"])
        _reactions.put(_key(item), found)
    return found


def _key(item: ItemDocument) -> tuple[str, ...]:
    """What the parts of a tree give depends on: its document, and their programs."""
    return item["tree"], *sorted(item["parts"]["programs"].values())


def regressor_of(item: ItemDocument, blobs: Blobs) -> RegressorModel:
    """The regressor of the tree of an item with parts. Raises InvalidDocument, TooLarge."""
    found = _regressors.get(_key(item))
    if found is None:
        parts = item["parts"]
        found = regressor(*tree_parts(parts, blobs), parts["nodes"])
        _regressors.put(_key(item), found)
    return found


def source_of(item: ItemDocument, blobs: Blobs, limits: Mapping[str, int]) -> Source:
    """What analyses of the tree of an item work on. Raises InvalidProgram."""
    digest = item["tree"].partition("@")[2]
    sources = sources_of(item, blobs)
    judge = sources.plausibility
    return Source(
        sources.model,
        digest,
        lambda: regressor_of(item, blobs),
        Limits(**limits),
        plausibility=judge,
        reactions=sources.reactions,
        powers=sources.powers,
        grouped=(lambda: _grouped(item, blobs)) if "parts" in item else None,
        parts=(lambda: tree_parts(item["parts"], blobs)) if "parts" in item else None,
    )


def _grouped(item: ItemDocument, blobs: Blobs) -> Model:
    """The model of the tree of an item with parts, with base parameters. Raises TooLarge."""
    parts = item["parts"]
    return couple(*tree_parts(parts, blobs), parts["nodes"], group=True)
