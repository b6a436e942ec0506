"""The power of every load and joint, as formulas: P = Q_a q'^a [W] of the generalised forces Q_a of each alone.

Rows, in this order: ``gravity``; ``joint arm.q1`` of the spring, damper, friction and stops of each joint;
``tau.arm.q1`` of each actuator; the loads of parts by type and place in the definition, ``spring arm.loads/0``; the
loads of the tree by type and name, ``bushing mount``. Closures do no work. The rows add up to Q_a q'^a, which is dT/dt.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from substructures.certificate.derived.powers import OUTPUT, power_outputs
from substructures.expr.graph import Expr
from substructures.expr.program import Formulas, array
from substructures.expr.replay import replay
from substructures.loads.pairs import wrench_forces
from substructures.part.forces.load_forces import load_forces, wrench_counts
from substructures.part.outputs import over_formulas
from substructures.part.part import MAX_NODES, Part
from substructures.quantities.of_parts import formed
from substructures.quantities.part_models import PowerModel
from substructures.tree.assembly import Assembly
from substructures.tree.coupling import couple_parts
from substructures.tree.document import TreeSpec
from substructures.tree.forces.applied_wrenches import part_symbols
from substructures.tree.forces.loads import loads_apart
from substructures.tree.model_outputs import rate_symbols
from substructures.tree.mounted_part import PlacedPart

#: (row, Q_a by index in the tree)
Row = tuple[str, Mapping[int, Any]]


def powers(spec: TreeSpec, parts: Mapping[str, Part], max_nodes: int = MAX_NODES) -> PowerModel:
    """The powers of a tree of stored parts (by instance name). Raises as :func:`.of_parts.formed`."""
    return PowerModel(*formed("powers", spec, parts, _outputs, power_outputs, max_nodes))


def _outputs(assembly: Assembly) -> tuple[dict[str, Formulas], list[str]]:
    graph, rates = assembly.scope.graph, rate_symbols(assembly)[0]
    found = list(_rows(assembly, rates))
    # P = Q_a q'^a
    watts = [graph.sum(graph.lift(Q) * rates[a] for a, Q in forces.items()) for _, forces in found]
    return {OUTPUT: array((len(found),), lambda k: watts[k])}, [name for name, _ in found]


def _rows(assembly: Assembly, rates: Sequence[Expr]) -> Iterator[Row]:
    graph = assembly.scope.graph
    coupled = couple_parts(over_formulas(graph), assembly.mounted, assembly.gravity, christoffel=False)
    yield "gravity", dict(enumerate(coupled.gravity))
    of_parts = [
        (instance.name, here, _of_definition(assembly, instance.name, here))
        for instance, here in zip(assembly.instances, coupled.placed, strict=True)
    ]
    for name, here, own in of_parts:
        for c, joint in enumerate(here.part.topology.joints):
            yield f"joint {name}.{joint.coordinate}", {here.first + c: own["joint"].get((c,), 0)}
    for name, here, _ in of_parts:
        for c in here.part.topology.movers:
            joint = here.part.topology.joints[c]
            effort = f"tau.{name}.{joint.coordinate}"
            yield effort, {here.first + c: assembly.scope.declare(effort, "input", "N" if joint.s else "N m")}
    for name, here, own in of_parts:
        yield from _loads(name, here, own["load"])
    if assembly.reading.spec.loads:
        apart = loads_apart(assembly, coupled.placed, rates)
        for load, found in zip(assembly.reading.spec.loads, apart, strict=True):
            yield f"{load.type} {load.name}", found.forces


def _of_definition(assembly: Assembly, instance: str, here: PlacedPart) -> dict[str, Mapping[tuple[int, ...], Expr]]:
    """Q_a of the joints and loads of a part by index, in the symbols of the tree."""
    known = load_forces(here.part.definition)
    found = replay(known, assembly.scope.graph, part_symbols(assembly, here, instance, known))
    return {name: formulas.entries for name, formulas in found.items()}


def _loads(name: str, here: PlacedPart, own: Mapping[tuple[int, ...], Expr]) -> Iterator[Row]:
    """Of the loads of a part: what acts between its bodies, and what acts on them, with the host, too."""
    definition, wrenches = here.part.definition, here.applied_wrenches()
    counts = wrench_counts(definition, here.part.topology.carrier)
    for i, (load, count) in enumerate(zip(definition.loads, counts, strict=True)):
        forces: dict[int, Any] = {here.first + a: Q for (k, a), Q in own.items() if k == i}
        for _ in range(count):
            for a, Q in wrench_forces(here, *next(wrenches)).items():
                forces[a] = forces[a] + Q if a in forces else Q
        yield f"{load.type} {name}.loads/{i}", forces
