"""Gamma_abc q'^b q'^c of a tree as formulas, alone and with gravity, in the way that needs the fewest operations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from operator import attrgetter

from substructures.expr.graph import Expr, Graph, GraphState
from substructures.expr.program import Formulas
from substructures.expr.tally import Tally
from substructures.loads.scope import Scope
from substructures.mechanics.balls import at_constant_rates
from substructures.mechanics.kinematics import INTERFACE
from substructures.mechanics.linear3 import Scalar, negate
from substructures.mechanics.newton_euler import BodyMotion
from substructures.mechanics.velocity_forces import velocity_forces
from substructures.tree.coupling import Coupled
from substructures.tree.inverse_dynamics import bias_forces
from substructures.tree.mounted_part import PlacedPart, balls_in

#: velocity forces, or these less the gravity forces, of a tree with these rates
Way = Callable[[Graph, Coupled, Sequence[Expr], bool], Sequence[Scalar]]


@dataclass(frozen=True)
class _Trial:
    """The nonlinear effects formed in one way: operations with those of the metric, and the graph with them."""

    way: Way
    operations: int
    effects: Sequence[Scalar]
    graph: GraphState


def least_forces(scope: Scope, coupled: Coupled, rates: Sequence[Expr]) -> dict[str, Sequence[Scalar]]:
    """``bias``: Gamma_abc q'^b q'^c, ``nonlinear_effects``: these less the gravity forces, (n,) of all joints [N m, N].

    From the composites of the metric, by Newton and Euler's recursion or from the Christoffel symbols: in the way in
    which metric and nonlinear effects together, what forward dynamics takes, need the fewest operations for each state.
    """
    graph = scope.graph
    start = graph.state().copy()
    metric = Tally(graph, scope.symbols)
    metric.add(nodes(coupled.metric.values()))

    def operations(more: Iterable[Scalar]) -> int:
        """Of the metric and of more entries."""
        tally = metric.copy()
        tally.add(nodes(more))
        return tally.total

    def tried(way: Way) -> _Trial:
        """Formed as if no other way had been tried: of equal formulas the graph keeps the first."""
        effects = way(graph, coupled, rates, True)
        trial = _Trial(way, operations(effects), effects, graph.state())
        graph.restore(start.copy())
        return trial

    # from the composites in coordinates alone
    ways = (recursive,) if balls_in(coupled.placed) else (composite, recursive)
    least = min(map(tried, ways), key=attrgetter("operations"))
    symbols = set(nodes((coupled.christoffel or {}).values()))
    # each of them is formed, and multiplied once at least
    if (
        coupled.christoffel is not None
        and not balls_in(coupled.placed)
        and operations(symbols) + len(symbols) < least.operations
    ):
        least = min(least, tried(multiplied), key=attrgetter("operations"))
    # the bias after the effects, with which it has most of its nodes in common
    graph.restore(least.graph)
    return {"bias": least.way(graph, coupled, rates, False), "nonlinear_effects": least.effects}


def nodes(entries: Iterable[Scalar]) -> list[Expr]:
    """Those that are not zero."""
    return [x for x in entries if isinstance(x, Expr) and not x.is_zero]


def composite(_: Graph, coupled: Coupled, rates: Sequence[Expr], falling: bool) -> Sequence[Scalar]:
    """From p, H and K of all joints."""
    momenta = [momentum for here in coupled.placed for momentum in here.evaluated.momenta]
    # a = -gamma
    start = {
        here.first + c: BodyMotion(a=negate(outermost(here).gamma[INTERFACE]))
        for here in coupled.placed
        for c in range(len(here.links))
    }
    return velocity_forces(coupled.chain, momenta, rates, start if falling else None)


def outermost(part: PlacedPart) -> PlacedPart:
    """The part whose interface a part is fixed to, over interfaces of others: where links of the tree begin."""
    while part.host is not None and part.seat.parent == INTERFACE:
        part = part.host
    return part


def recursive(_: Graph, coupled: Coupled, rates: Sequence[Expr], falling: bool) -> Sequence[Scalar]:
    """From the accelerations of all bodies for q'' = 0."""
    return bias_forces(coupled.placed, rates, falling, at_constant_rates(balls_in(coupled.placed), rates))


def multiplied(graph: Graph, coupled: Coupled, rates: Sequence[Expr], falling: bool) -> Sequence[Scalar]:
    """From the Christoffel symbols: every different one of a row times its sum of products of velocities."""
    n, gamma = len(rates), coupled.christoffel or {}
    #: by equation a and symbol, by c: the sum over b <= c of q'^b, twice for b < c
    rows: list[dict[Expr, dict[int, Expr]]] = [{} for _ in range(n)]
    for (a, b, c), x in Formulas((n, n, n), gamma, "christoffel").expanded().items():
        if b <= c and isinstance(x, Expr) and not x.is_zero:
            sums = rows[a].setdefault(x, {})
            # q'^b q'^c and q'^c q'^b: Gamma_abc = Gamma_acb, so that b <= c is all there is to form
            sums[c] = sums.get(c, graph.zero) + (rates[b] if b == c else rates[b] * 2)
    bias = [
        graph.sum(x * graph.sum(part * rates[c] for c, part in sums.items()) for x, sums in row.items()) for row in rows
    ]
    return [x - q for x, q in zip(bias, coupled.gravity, strict=True)] if falling else bias
