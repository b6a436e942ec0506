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
from substructures.part.balls import position_rates
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
    constant.
    """
    scope, q = Scope(Graph()), model.coordinates
    gaps = read_gaps(scope, names(model, scope, False), events)
    require_read(scope)
    # d/dt = q' d/dq + q'' d/dq' + d/dt; of ball joints their positions move by p' = R v, Q' = 1/2 Q (0, w)
    moving = {name: scope.declare(f"{name}'", "velocity", "") for name in q}
    seeds = moving | {"t": scope.graph.one}
    for ball in model.balls:
        own, rates = ball["positions"], [moving[name] for name in ball["velocities"]]
        for name in own:
            scope.declare(name, "coordinate", "")
        seeds |= zip(own, position_rates(scope.graph, own, rates), strict=True)
    seeds |= {f"{name}'": scope.declare(f"{name}''", "input", "") for name in q}
    rates = directional(gaps, seeds)
    some = dict(zip(GAPS, (gaps, rates, directional(rates, seeds)), strict=True))
    return program(scope.graph, {name: vector(entries) for name, entries in some.items()}, scope.symbols)
