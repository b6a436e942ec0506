"""What takes the inverse of the metric: g^ab itself, Christoffel symbols of the second kind, Hamilton's equations.

With the momenta p_a = dL/dq'^a = g_ab q'^b as symbols ``p.<coordinate>`` [kg m^2/s, kg m/s]

    H(q, p, t) = 1/2 g^ab p_a p_b + V           q'^a = dH/dp_a = g^ab p_b
    p'_a = -dH/dq^a + F_a = Q_a + Gamma_bac q'^b q'^c       where F_a are the forces without a potential

since d_a g_bc = Gamma_bac + Gamma_cab, and all velocities, those in forces too, are taken at q' = g^-1 p. Where motions
are given, q'^a = g^ab (p_b - g_b0), H = T_2 - T_0 + V, and p'_a has d_a (g_b0 q'^b + 1/2 g_00) besides;
the same with Routh's function where momenta are given.
(W. R. Hamilton, 1835; E. J. Routh, Advanced Rigid Dynamics, 1892; notation.md, section 7.)
"""

from __future__ import annotations

from collections.abc import Sequence

from substructures.errors import TooLarge
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr
from substructures.expr.program import Entries, Formulas, Program, Symbol
from substructures.quantities.derivatives import factors_of
from substructures.quantities.numbers.workspace import Workspace, momentum, vector
from substructures.quantities.stored_outputs import require_stored
from substructures.tree.model import Model

MOMENTA = ("hamiltonian", "canonical_equations")
PIVOTS = "pivots"
UNITS = {"R": "kg m^2/s", "P": "kg m/s"}


def inverse_metric(model: Model, max_nodes: int) -> Program:
    """``inverse_metric`` (n, n), symmetric: g^ab, and ``pivots`` as of forward dynamics, which is without forces

    q''^a = -Gamma^a_bc q'^b q'^c. Raises TooLarge, SingularMetric.
    """
    r = Workspace(model)
    factors, told = factors_of(r, max_nodes)
    columns = [factors.solve([r.graph.one if a == b else r.graph.zero for a in range(r.n)]) for b in range(r.n)]
    entries: Entries = {(a, b): columns[b][a] for a in range(r.n) for b in range(a, r.n)}
    return r.program({"inverse_metric": Formulas((r.n, r.n), entries, "symmetric"), PIVOTS: told[PIVOTS]})


def christoffel_second_kind(model: Model, max_nodes: int) -> Program:
    """``christoffel_second_kind`` (n, n, n): Gamma^a_bc = g^ad Gamma_dbc = Gamma^a_cb, and ``pivots``.

    Raises TooLarge, SingularMetric.
    """
    require_stored(model.program, ["christoffel"])
    r, entries = Workspace(model), Entries()
    factors, told = factors_of(r, max_nodes)
    gamma = r.elements("christoffel")
    pairs = sorted({(b, c) for _, b, c in gamma if b <= c})
    if len(r.graph) + r.n**2 * len(pairs) > max_nodes:
        raise TooLarge("christoffel_second_kind (in operations)", len(r.graph) + r.n**2 * len(pairs), max_nodes)
    for b, c in pairs:
        column = factors.solve([gamma.get((d, b, c), r.graph.zero) for d in range(r.n)])
        for a, x in enumerate(column):
            entries[a, b, c] = entries[a, c, b] = x
    return r.program({"christoffel_second_kind": Formulas((r.n, r.n, r.n), entries), PIVOTS: told[PIVOTS]})


def hamiltonian(model: Model, max_nodes: int) -> Program:
    """``hamiltonian`` (): H = 1/2 g^ab (p_a - g_a0) (p_b - g_b0) - 1/2 g_00 + V [J], and ``pivots``.

    Raises TooLarge, SingularMetric.
    """
    r = Workspace(model)
    p, rates, told = _rates(r, max_nodes)
    energy = r.graph.sum(x * y for x, y in zip(p, rates, strict=True)) / 2 + r.scalar("potential_energy")
    energy = energy - r.scalar("g_00") / 2 if model.given else energy
    return r.program({"hamiltonian": Formulas((), {(): energy}), PIVOTS: told})


def canonical_equations(model: Model, max_nodes: int) -> Program:
    """``coordinate_rates`` (n,): q'^a = dH/dp_a [rad/s, m/s], ``momentum_rates`` (n,): p'_a = -dH/dq^a + F_a [N m, N],
    and ``pivots``. Raises TooLarge, SingularMetric.
    """
    require_stored(model.program, ["christoffel"])
    r = Workspace(model)
    _, rates, told = _rates(r, max_nodes)
    velocities = {f"{name}'": x for name, x in zip(model.coordinates, rates, strict=True)}
    forces = r.independent("forces", velocities)
    # C_ba q'^b = Gamma_bac q'^b q'^c
    found = [forces.get((a,), r.graph.zero) for a in range(r.n)]
    for (b, a, c), gamma in r.elements("christoffel").items():
        found[a] = found[a] + gamma * rates[b] * rates[c]
    if model.given:
        # d_a of T_1 + T_0, T_1 at these velocities
        drives = [*(r.elements("g_a0").get((a,), r.graph.zero) for a in range(r.n)), r.scalar("g_00") / 2]
        slopes = [
            r.graph.sum(x * y for x, y in zip(column, [*rates, r.graph.one], strict=True))
            for column in zip(*gradient(drives, model.coordinates), strict=True)
        ]
        found = [x + y for x, y in zip(found, slopes, strict=True)]
    return r.program({"coordinate_rates": vector(rates), "momentum_rates": vector(found), PIVOTS: told})


def _rates(r: Workspace, max_nodes: int) -> tuple[Sequence[Expr], Sequence[Expr], Formulas]:
    """p_a without g_a0, q'^a = g^ab p_b of it, and the pivots."""
    factors, told = factors_of(r, max_nodes)
    names = [momentum(name) for name in r.model.coordinates]
    for name, joint in zip(names, r.model.joints, strict=True):
        r.symbols[name] = Symbol(name, "parameter", UNITS[joint])
    mixed = r.elements("g_a0") if r.model.given else {}
    p = [r.graph.symbol(name) - mixed.get((a,), 0) for a, name in enumerate(names)]
    return p, factors.solve(p), told[PIVOTS]
