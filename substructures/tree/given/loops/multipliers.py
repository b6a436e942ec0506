"""Forces of loops that are in the formulas (reduced level): multipliers of their closures, as functions of a motion.

In the rows of dependent coordinates z of the equations of all coordinates no force is unknown but those of closures.
From the last loop to the first, each of which tells its own z,

    (G^T lambda)_z = R_z        R: g q'' + Gamma q' q' - Q of all coordinates, less what other closures do

and lambda is the solution of least norm, lambda = G_z (G_z^T G_z)^-1 R_z.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr
from substructures.tree.given.loops.dependent import Dependent
from substructures.tree.given.loops.linear import solver

PREFIX = "lambda."


def loop_multipliers(
    known: Dependent, names: Sequence[str], needed: Mapping[str, Expr], transmitted: Mapping[str, Expr]
) -> dict[str, Expr]:
    """Those of the loops of dependent coordinates, by symbol ``lambda.<closure>.<row>`` [N, N m].

    ``names``: of all multipliers; ``needed``: R by dependent coordinate, without closures and contacts;
    ``transmitted``: what its joint has to transmit, in which multipliers are linear, -G^T lambda. Raises NotReduced
    where G_z is singular in all positions.
    """
    z = list(known.values)
    slopes = dict(zip(z, gradient([transmitted[q] for q in z], names), strict=True))
    found: dict[str, Expr] = {}
    for closures, unknown in reversed(known.loops.items()):
        own = [x for x in names if x.startswith(tuple(f"{PREFIX}{closure}." for closure in closures))]
        # of later loops they are known by now; earlier loops do not act on these z, of contacts symbols stay
        forces = {x: found.get(x, known.graph.symbol(x)) for x in names if x not in own}
        rest = [
            known.graph.sum(
                [needed[q], *(x * forces[name] for name, x in zip(names, slopes[q], strict=True) if name in forces)]
            )
            for q in unknown
        ]
        columns = {x: [-slopes[q][names.index(x)] for q in unknown] for x in own}
        # rows across the plane of the loop do nothing to z: their multipliers of least norm are 0
        acting = {x: column for x, column in columns.items() if not all(each.is_zero for each in column)}
        found |= dict.fromkeys(own, known.graph.zero)
        found |= dict(zip(acting, _least_norm(list(acting.values()), rest), strict=True))
    return found


def _least_norm(G: Sequence[Sequence[Expr]], rest: Sequence[Expr]) -> list[Expr]:
    """lambda with G^T lambda = rest, the row of G by multiplier."""
    if len(G) == len(rest):
        return solver(list(zip(*G, strict=True)))(rest)
    add, columns = rest[0].graph.sum, range(len(rest))
    # more rows than unknown coordinates: less of what does nothing to these, the kernel of G_z^T
    square = solver([[add(row[i] * row[j] for row in G) for j in columns] for i in columns])
    solved = square(rest)
    return [add(x * s for x, s in zip(row, solved, strict=True)) for row in G]
