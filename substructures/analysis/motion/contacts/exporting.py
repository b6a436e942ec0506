"""Contacts of a tree for what simulates it elsewhere: formulas of what is seen of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from substructures.analysis.motion.contacts.rows import BIAS, GAP, RATE, ROWS, WHEN, contact_rows
from substructures.analysis.motion.problems.contacts import contacts_of
from substructures.analysis.motion.right_hand_side import ACCELERATION, forward_dynamics
from substructures.expr.graph import Graph
from substructures.expr.program import Formulas, Program, program
from substructures.expr.replay import replay
from substructures.quantities.quantity import FORWARD
from substructures.tree.document import require_unignored
from substructures.tree.model import Model


def contact_programs(model: Model, name: str) -> Mapping[str, Callable[[], Program]]:
    """What makes the accelerations while contacts are open, and under ``name`` the function of what is seen of them:
    gap (k,) [m], rows (k, 3, n), rate (k, 3), bias (k, 3), when (k,), as of :func:`contact_rows`, the metric (n, n).

    They raise InvalidInput.
    """
    require_unignored(model.ignored if model.contacts else ())
    return {name: lambda: _seen(model), FORWARD: lambda: forward_dynamics(model).select([ACCELERATION])}


def _seen(model: Model) -> Program:
    rows, metric, graph = contact_rows(model, contacts_of(model)), model.program.select(["metric"]), Graph()
    made, weights = replay(rows, graph, {}), replay(metric, graph, {})["metric"]
    # all elements: those below the diagonal are stored
    whole = Formulas(weights.shape, {at: x for (a, b), x in weights.entries.items() for at in ((a, b), (b, a))}, "")
    symbols = {s.name: s for each in (rows, metric) for s in each.symbols}
    return program(graph, {**{name: made[name] for name in (GAP, ROWS, RATE, BIAS, WHEN)}, "mass": whole}, symbols)
