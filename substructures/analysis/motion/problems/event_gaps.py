"""What quantities of events are from their levels, as formulas."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from substructures.analysis.arguments import exact, require_read
from substructures.analysis.equations.expressions import names, vector
from substructures.analysis.motion.problems.events import Event
from substructures.expr.differentiate import directional
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Program, program
from substructures.loads.scope import Scope
from substructures.tree.model import Model

#: outputs of :func:`gap_rates`
GAPS = ("g", "g'", "g''")


def read_gaps(scope: Scope, lookup: Callable[[str], Expr | None], events: Sequence[Event]) -> list[Expr]:
    """g = quantity - level of events; faults are those of ``scope``."""
    return [
        scope.read(exact(event.quantity, pointer), pointer, lookup) - scope.graph.lift(exact(event.level, pointer))
        for event, pointer in ((event, f"/events/{i}/quantity") for i, event in enumerate(events))
    ]


def gap_rates(model: Model, events: Sequence[Event]) -> Program:
    """Outputs ``g``, ``g'`` and ``g''`` of events, (k,) each, in q, q', t and the accelerations ``q''``, which count as
    constant. Of trees whose velocities are the rates of their coordinates.
    """
    scope, q = Scope(Graph()), model.coordinates
    gaps = read_gaps(scope, names(model, scope, False), events)
    require_read(scope)
    # d/dt = q' d/dq + q'' d/dq' + d/dt
    seeds = {name: scope.declare(f"{name}'", "velocity", "") for name in q} | {"t": scope.graph.one}
    seeds |= {f"{name}'": scope.declare(f"{name}''", "input", "") for name in q}
    rates = directional(gaps, seeds)
    some = dict(zip(GAPS, (gaps, rates, directional(rates, seeds)), strict=True))
    return program(scope.graph, {name: vector(entries) for name, entries in some.items()}, scope.symbols)
