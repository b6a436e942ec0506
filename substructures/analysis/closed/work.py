"""Power of the forces that have no potential, as a formula: what an energy balance needs."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from substructures.certificate.derived import model_formulas
from substructures.expr.differentiate import directional, gradient
from substructures.expr.graph import Graph
from substructures.expr.program import Program, array, program
from substructures.expr.replay import replay
from substructures.expr.walk import transfer
from substructures.quantities.certificate import certified
from substructures.quantities.numbers.workspace import Workspace
from substructures.tree.model import Model

POWER = "lost_power"


def with_power(model: Model, outputs: Sequence[str], inputs: Collection[str]) -> Program:
    """These outputs of the model and ``lost_power`` () [W]: (Q_a + dV/dq^a) q'^a + dV/dt, for ``inputs``; others are 0.
    At given motions d_t V - d_t T stands there for dV/dt.

    V: potential energy of gravity and all springs, whose laws may depend on time. The power of dampers is negative,
    that of drives positive; the output has no entry when the forces have a potential that does not change. Raises
    ZeroDivisionError where a derivative is infinite.
    """
    graph = Graph()
    # inputs that are not given, and have no default, are 0
    absent = {s.name: graph.zero for s in model.program.symbols if s.kind == "input" and s.name not in inputs}
    found = replay(model.program, graph, absent, [*outputs, "forces", "potential_energy"])
    potential = graph.zero + found["potential_energy"].entries.get((), 0)
    ((*slopes, total),) = gradient([potential], [*model.coordinates, "t"])
    if model.driven:
        kinetic = replay(model.program, graph, absent, ["T_2", "T_1", "T_0"])
        T = graph.sum(graph.lift(x) for each in kinetic.values() for x in each.entries.values())
        time = Workspace(model, absent).time
        total = directional([potential - T], dict(zip(time, transfer(time.values(), graph, {}), strict=True)))[0]
    for a, name in enumerate(model.coordinates):
        # (Q_a + dV/dq^a) q'^a
        force = graph.zero + found["forces"].entries.get((a,), 0)
        total = total + (force + slopes[a]) * graph.symbol(f"{name}'")
    # velocities also where no output of the model depends on them
    symbols = Workspace(model).symbols
    needs = (*outputs, "forces", "potential_energy", "g_a0", "g_00")
    result = program(graph, found | {POWER: array((), lambda: total)}, symbols)
    return certified(
        result, model, model_formulas.with_power(outputs), "equations of closed motions", needs=needs, zero=absent
    )
