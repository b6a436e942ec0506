"""What evaluations of a stored tree work with: programs, what is derived of its parts, and the way over these; and the
tree as an item of a work, with its digests and the contents that go with them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from service.content.integrity import missing, reading
from service.database.connections import Connection
from service.jobs.kinds.requested.derived import read_derived
from service.jobs.kinds.trees import pinned
from service.jobs.worker import Worker
from service.messages.viewer import ANYBODY
from service.operations.library import StoreLibrary
from service.queries import content, trees
from service.queries.trees import Tree
from service.schemas.jobs import ItemDocument
from service.store.store import Store
from substructures.documents import read_json
from substructures.errors import InvalidDocument
from substructures.expr.program import Program
from substructures.part.part import Part
from substructures.quantities.accelerations import Evaluator
from substructures.quantities.derivatives import SINGULAR, SingularMetric
from substructures.quantities.from_parts import NumericTree
from substructures.quantities.quantity import OF_PARTS
from substructures.quantities.sources import Sources
from substructures.tree.document import TreeSpec, with_levels
from substructures.tree.judge import Judge
from substructures.tree.model import Model
from substructures.tree.plausibility import Plausibility


def sources_of(store: Store, tree: Tree, model: Model, worker: Worker) -> Sources:
    """What quantities of a tree are computed from; ``worker``: derives and certifies what is not in memory."""

    def derive(model: Model, quantity: str) -> Program:
        """A program of the model alone."""
        return store.derived(model, quantity, lambda: _derived(store, tree, worker, quantity))

    def of_parts(name: str) -> Any:
        """What is derived of the parts of the tree beside its model."""
        key = tree.digest, name, part_programs(store, tree)
        return store.caches.of_parts.once(key, lambda: _derived(store, tree, worker, name))

    return Sources(
        model,
        derive,
        of_parts,
        lambda: plausibility_of(store, tree, model),
        lambda values, names, states: _numeric(store, tree).answer(values, names, states),
    )


def _derived(store: Store, tree: Tree, worker: Worker, source: str) -> Any:
    """What a runner derives. Raises TooLarge, SingularMetric, TimeoutError."""
    item, blobs = pinned_tree(store, tree, source in OF_PARTS)
    nodes = store.settings.limits.program_nodes
    try:
        return read_derived(source, worker("derived", {**item, "source": source, "nodes": nodes}, blobs))
    except InvalidDocument as error:
        if [fault.code for fault in error.faults] == [SINGULAR]:
            raise SingularMetric(error.faults) from None
        raise


def plausibility_of(store: Store, tree: Tree, model: Model) -> Judge:
    """What judges the values that a tree is evaluated with."""
    found = model.plausibility or store.caches.plausibilities.get(tree.digest)
    if found is None:
        spec, parts = tree_parts(store, tree)
        found = Plausibility(spec, {name: part.definition for name, part in parts.items()})
        store.caches.plausibilities.put(tree.digest, found)
    return found


def engine_of(store: Store, tree: Tree, model: Model) -> Evaluator:
    """What computes them: a tree whose parts have kernels answers before it has one of its own."""
    if model.given or model.reduced:
        return store.kernels
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
            parts = {each.name: store.required_part(connection, each.digest) for each in spec.instances}
            return with_levels(spec, {name: part.definition for name, part in parts.items()}), parts


def part_programs(store: Store, tree: Tree) -> tuple[str, ...]:
    """The digests of what is derived of a tree beside its own program is made of."""
    with store.database.read() as connection:
        return trees.part_programs(connection, tree.name, tree.revision)


def pinned_tree(store: Store, tree: Tree, has_parts: bool = True) -> tuple[ItemDocument, dict[str, bytes]]:
    """The fields of an item about a revision that was found for whoever asks, and its blobs; ``has_parts``: also the
    formulas of its parts. Raises Refused for content that is damaged or gone.
    """
    with store.database.read() as connection:
        reference, library = f"{tree.name}@{tree.revision}", StoreLibrary(connection, ANYBODY)
        item, digests = pinned({"tree": reference}, library, store.settings.limits.program_nodes, has_parts)
        if "inputs" not in item["model"]:
            item["model"] |= store.declared(connection, tree)
    return item, store.blobs(digests)


def declared_parameters(connection: Connection, tree: Tree) -> dict[str, Mapping[str, Any]]:
    """Of every instance of a tree the parameters that its part declares. Raises Refused for content that is gone."""
    found = {}
    for each in read_json(tree.spec.encode()).get("instances", ()):
        digest = each.get("substructure", "").partition("@")[2]
        text = None if "definition" in each else content.get_definition(connection, digest)
        if text is None and "definition" not in each:
            raise missing(f"the part of '{each['name']}'", digest)
        found[each["name"]] = each.get("definition") or read_json(text or b"")
    return {name: definition.get("parameters", {}) for name, definition in found.items()}
