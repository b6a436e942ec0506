"""Gamma_abc q'^b q'^c of a tree as formulas, alone and with gravity, in the way that needs the fewest operations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas
from substructures.mechanics.kinematics import INTERFACE
from substructures.mechanics.linear3 import Scalar, negate
from substructures.mechanics.newton_euler import BodyMotion
from substructures.mechanics.velocity_forces import velocity_forces
from substructures.tree.coupling import Coupled
from substructures.tree.mounted_part import PlacedPart

#: different Christoffel symbols by coordinate, up to which their products with velocities need fewer operations than
#: the recursion: found with the entries of the catalogue, all of which have fewer or many more
FEW = 2


def least_forces(graph: Graph, coupled: Coupled, rates: Sequence[Expr]) -> dict[str, list[Scalar]]:
    """``bias``: Gamma_abc q'^b q'^c, ``nonlinear_effects``: these less the gravity forces, of all coordinates.

    From the Christoffel symbols where they are few, as of small and of planar mechanisms, else by the composites, which
    are those of the metric.
    """
    gamma = coupled.christoffel
    symbols = {x for x in (gamma or {}).values() if isinstance(x, Expr) and not x.is_zero}
    if gamma is not None and len(symbols) <= FEW * len(rates):
        bias = _from_christoffel(graph, gamma, rates)
        return {"bias": bias, "nonlinear_effects": [x - q for x, q in zip(bias, coupled.gravity, strict=True)]}
    momenta = [momentum for here in coupled.placed for momentum in here.evaluated.momenta]
    # a = -gamma
    start = {
        here.first + c: BodyMotion(a=negate(outermost(here).gamma[INTERFACE]))
        for here in coupled.placed
        for c in range(len(here.links))
    }
    return {
        "bias": velocity_forces(coupled.chain, momenta, rates),
        "nonlinear_effects": velocity_forces(coupled.chain, momenta, rates, start),
    }


def outermost(part: PlacedPart) -> PlacedPart:
    """The part whose interface a part is fixed to, over interfaces of others: where links of the tree begin."""
    while part.host is not None and part.seat.parent == INTERFACE:
        part = part.host
    return part


def _from_christoffel(graph: Graph, gamma: Mapping[tuple[int, ...], Scalar], rates: Sequence[Expr]) -> list[Scalar]:
    """Gamma_abc q'^b q'^c, every different symbol of a row times its sum of products of velocities."""
    n = len(rates)
    #: by equation a and symbol, by c: the sum over b <= c of q'^b, twice for b < c
    rows: list[dict[Expr, dict[int, Expr]]] = [{} for _ in range(n)]
    for (a, b, c), x in Formulas((n, n, n), gamma, "christoffel").expanded().items():
        if b <= c and isinstance(x, Expr) and not x.is_zero:
            sums = rows[a].setdefault(x, {})
            sums[c] = sums.get(c, graph.zero) + (rates[b] if b == c else rates[b] * 2)
    return [
        graph.sum(x * graph.sum(part * rates[c] for c, part in sums.items()) for x, sums in row.items()) for row in rows
    ]
