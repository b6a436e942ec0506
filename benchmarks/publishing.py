"""Trees that become parts: how long it takes, and how many operations the mounted part has beside the tree.

    python -m benchmarks.publishing

``once``: all operations of metric, Christoffel symbols and forces; ``per state``: without those of parameters alone.
``in one piece``: the same definition derived anew.
"""

from __future__ import annotations

from collections.abc import Callable
from statistics import median
from typing import Any

from benchmarks.timing import alternating
from substructures import Definition, Model, Part, TreeSpec, catalogue, couple, derive
from substructures.tree.publishing.published import Publication, Published, published
from substructures.tree.publishing.published_formulas import published_part

QUANTITIES = ("metric", "christoffel", "forces")
ARM = {"name": "arm", "substructure": "puma560"}
HAND: dict[str, Any] = {"name": "hand", "substructure": "parallel-gripper", "at": "arm.flange"}
TREES: dict[str, list[dict[str, Any]]] = {
    "6 + 6": [ARM, {**HAND, "substructure": "puma560"}],
    "arm and gripper": [ARM, HAND],
    "the same, turned": [ARM, {**HAND, "placement": {"rpy": [0.3, 0.2, 0.1]}}],
}


def main() -> None:
    """Print a line for each tree and way."""
    for name, instances in TREES.items():
        report(name, TreeSpec.read({"name": "cell", "gravity": [0, 0, "-9.81"], "instances": instances}))
    report("34 dof humanoid", TreeSpec.read(catalogue.load_tree("humanoid")))


def report(name: str, spec: TreeSpec) -> None:
    """Publish a tree, mount what it became, and compare."""
    library = {i.substructure: derive(Definition.read(catalogue.load(str(i.substructure)))) for i in spec.instances}
    parts = {i.name: library[i.substructure] for i in spec.instances}
    tree = couple(spec, parts)
    open_names = tuple(name for name, given in tree.parameters.items() if given["value"] is None)
    found = published(spec, parts, Publication({"name": "module"}, free=open_names))
    ways: dict[str, Callable[[], Part]] = {
        "coupled": lambda: published_part(found, parts),
        "in one piece": lambda: derive(found.definition),
    }
    times = alternating({way: (make, 1) for way, make in ways.items()}, 5)
    for way, make in ways.items():
        module, seconds = mounted(spec, found, make()), median(times[way])
        once, per_state = ratio(module, tree, False), ratio(module, tree, True)
        print(f"{name:<18} {way:<13} {1000 * seconds:7.0f} ms  operations: once {once:.3f}, per state {per_state:.3f}")


def mounted(spec: TreeSpec, found: Published, part: Part) -> Model:
    """A tree of the part alone."""
    given = spec.model_dump(include={"gravity", "parameters"})
    one = {"name": "x", "substructure": found.definition.name}
    return couple(TreeSpec.read({**given, "name": "alone", "instances": [one]}), {"x": part})


def ratio(module: Model, tree: Model, per_state: bool) -> float:
    """Operations of the mounted part over those of the tree."""
    counts = [model.program.count(QUANTITIES, per_state)["total"] for model in (module, tree)]
    return counts[0] / counts[1]


if __name__ == "__main__":
    main()
