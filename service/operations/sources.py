"""What evaluations of a stored tree work with: programs, regressor, reactions, powers, and the way over its parts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

from service.cache import Cache
from service.integrity import reading
from service.queries import trees
from service.queries.trees import Tree
from service.store import Store
from substructures.documents import read_json
from substructures.part.part import Part
from substructures.quantities.evaluation import Evaluator, Sources
from substructures.quantities.from_parts import NumericTree
from substructures.quantities.powers import PowerModel, powers
from substructures.quantities.reactions import ReactionModel, reactions
from substructures.quantities.regressor import RegressorModel, regressor
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model, couple
from substructures.tree.plausibility import Plausibility

Derived = TypeVar("Derived", PowerModel, ReactionModel, RegressorModel)


def sources_of(store: Store, tree: Tree, model: Model) -> Sources:
    """What quantities of a tree are computed from."""
    return Sources(
        model,
        store.derived,
        lambda: _derived(store, tree, store.caches.regressors, regressor),
        lambda: plausibility_of(store, tree, model),
        lambda values, names, states: _numeric(store, tree).answer(values, names, states),
        lambda: _derived(store, tree, store.caches.reactions, reactions),
        powers=lambda: _derived(store, tree, store.caches.powers, powers),
    )


def plausibility_of(store: Store, tree: Tree, model: Model) -> Plausibility:
    """What judges the values that a tree is evaluated with."""
    found = model.plausibility or store.caches.plausibilities.get(tree.digest)
    if found is None:
        spec, parts = tree_parts(store, tree)
        found = Plausibility(spec, {name: part.definition for name, part in parts.items()})
        store.caches.plausibilities.put(tree.digest, found)
    return found


def engine_of(store: Store, tree: Tree, model: Model) -> Evaluator:
    """What computes them: a tree whose parts have kernels answers before it has one of its own."""
    found = _numeric(store, tree)
    parts_used = [m.part for m in found.assembly.mounted]
    return store.kernels.of_tree(model.program, parts_used, lambda: found)


def _numeric(store: Store, tree: Tree) -> NumericTree:
    """The tree over the numbers of its parts."""
    found = store.caches.numeric_trees.get(tree.digest)
    if found is None:
        spec, parts = tree_parts(store, tree)
        store.kernels.prepare(parts.values())
        found = NumericTree(spec, parts, store.kernels.of_part)
        store.caches.numeric_trees.put(tree.digest, found)
    return found


def tree_parts(store: Store, tree: Tree) -> tuple[TreeSpec, dict[str, Part]]:
    """The document of a stored tree and its parts by instance. Raises Refused for content that is damaged or gone."""
    with reading(f"the document of tree {tree.name}@{tree.revision}", tree.digest):
        spec = TreeSpec.stored(read_json(tree.spec.encode()))
        with store.database.read() as connection:
            return spec, {each.name: store.required_part(connection, each.digest) for each in spec.instances}


def part_programs(store: Store, tree: Tree) -> tuple[str, ...]:
    """The digests of what is derived of a tree beside its own program is made of."""
    with store.database.read() as connection:
        return trees.part_programs(connection, tree.name, tree.revision)


def grouped_model(store: Store, tree: Tree) -> Model:
    """The model of a stored tree with base parameters. Raises TooLarge."""
    return couple(*tree_parts(store, tree), store.settings.limits.program_nodes, group=True)


def _derived(
    store: Store,
    tree: Tree,
    cache: Cache[Derived],
    derive: Callable[[TreeSpec, Mapping[str, Part], int], Derived],
) -> Derived:
    """What is derived of the parts of a tree beside its model. Raises TooLarge."""
    key = tree.digest, part_programs(store, tree)
    found = cache.get(key)
    if found is None:
        found = derive(*tree_parts(store, tree), store.settings.limits.program_nodes)
        cache.put(key, found)
    return found
