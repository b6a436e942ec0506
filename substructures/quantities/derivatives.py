"""Exact derivatives of inverse and forward dynamics as formulas, forward mode on the graph.

With ID_a(q, q', q'', tau) = g_ab q''^b + Gamma_abc q'^b q'^c - Q_a(q, q', tau, t) one walk over the nodes of ID gives

    dID = dID/dq dq + dID/dq' dq' + dID/dq'' dq'' + dID/dtau dtau,        dID/dq'' = g,        dID/dtau_a = -e_a

as formulas again, for a small multiple of the operations of ID. The direction is a symbol beside every coordinate,
velocity, acceleration and input, with the same kind and unit and ``d.`` before its name: ``d.arm.q1`` [rad, m],
``d.arm.q1'`` [rad/s, m/s], ``d.arm.q1''`` [rad/s^2, m/s^2], ``d.tau.arm.q1`` [N m, N], ``d.arm.u`` for an input u.
Forward dynamics q'' = FD(q, q', tau) satisfies ID(q, q', FD, tau) = 0, hence g d(FD) = -dID at q'' = FD with dq'' = 0.
(notation.md, section 7: the perturbation equations.)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from substructures.errors import InvalidDocument, TooLarge
from substructures.expr.differentiate import directional, in_directions
from substructures.expr.graph import Expr
from substructures.expr.program import Formulas, Program, array, program
from substructures.expr.replay import replay
from substructures.mechanics.factorisation import Factors, factor_operations, factorised
from substructures.part.part import MAX_NODES
from substructures.quantities.numbers.workspace import ID, Workspace, vector
from substructures.tree.cuts import require_open
from substructures.tree.given.ties import require_chains
from substructures.tree.model import Model

FD = "forward_dynamics"
#: kinds of symbols that have a direction
VARIED = frozenset(("coordinate", "velocity", "acceleration", "input"))
BY_STATE = "evaluate it at states (numbers take closures), or use velocity equations with constraints of type 'closure'"
SINGULAR = "singular-metric"


class SingularMetric(InvalidDocument):
    """A metric that is singular in every state."""


def direction(name: str) -> str:
    """The symbol of the variation of ``name``."""
    return f"d.{name}"


def _along(r: Workspace, rows: Sequence[Expr], fixed: frozenset[str] = frozenset()) -> list[Expr]:
    """d(row) along the symbols ``d.*``, which are declared; ``fixed`` kinds of symbols are not varied."""
    # seeds of forward mode: every symbol x moves by its own symbol d.x
    varied = [s for s in r.symbols.values() if s.kind in VARIED - fixed]
    r.symbols |= {direction(s.name): replace(s, name=direction(s.name)) for s in varied}
    return directional(rows, {s.name: r.graph.symbol(direction(s.name)) for s in varied})


def inverse_dynamics_derivative(model: Model, _: int = MAX_NODES) -> Program:
    """Inverse dynamics and its directional derivative, one program with two outputs.

    ``inverse_dynamics`` (n,) [N m, N]; ``inverse_dynamics_derivative`` (n,): its derivative along the symbols ``d.*``
    of the module's table (only those appear that the dynamics depend on). Where a load has an infinite derivative its
    value is not finite.
    """
    require_chains(model.balls)
    r = Workspace(model)
    # ID_a = g_ab q''^b + Gamma_abc q'^b q'^c - Q_a  (notation.md, section 7)
    rows = r.inverse_dynamics()
    return r.program({ID: vector(rows), f"{ID}_derivative": vector(_along(r, rows))})


def inverse_dynamics_jacobians(model: Model) -> Program:
    """Partial derivatives of inverse dynamics by the state, one program with three outputs.

    ``inverse_dynamics`` (n,); ``inverse_dynamics_q`` (n, n): dID_a/dq^b [N m/rad, N/m, ...] and
    ``inverse_dynamics_qd`` (n, n): dID_a/dq'^b = 2 Gamma_abc q'^c - dQ_a/dq'^b, both at [a, b]. The derivative by q''
    is the metric. Of ball joints dq^b is a displacement, or a rotation vector, in the axes of the body. One walk for
    every column, each over what depends on it.
    """
    r = Workspace(model)
    rows = r.inverse_dynamics()

    def matrix(directions: Sequence[Mapping[str, Expr]]) -> Formulas:
        """The derivative of ID_a along the direction b."""
        found = in_directions(rows, directions)
        return array((r.n, r.n), lambda a, b: found[a][b])

    rates = [{f"{name}'": r.graph.one} for name in model.coordinates]
    return r.program({ID: vector(rows), f"{ID}_q": matrix(r.displacements), f"{ID}_qd": matrix(rates)})


def forward_dynamics(model: Model, max_nodes: int = MAX_NODES) -> Program:
    """q''^a from g q'' = Q - Gamma q' q', by g = L^T D L without exchange of rows: one program with three outputs.

    ``forward_dynamics`` (n,) [rad/s^2, m/s^2]; ``pivots`` (n,): D_k / |g_kk|, between 0 (singular metric) and 1, all
    positive where the metric is positive definite; ``inertias`` (n,): |g_kk|, whose products must stay within the range
    of numbers. In a state with a singular metric the division by zero gives infinities and NaN. Raises TooLarge for
    more than ``max_nodes`` operations, SingularMetric where no state has accelerations, InvalidDocument for closures.
    """
    require_open(model.closures, BY_STATE)
    r = Workspace(model)
    factors, told = factors_of(r, max_nodes)
    return r.program({FD: vector(_accelerations(r, factors)), **told})


def forward_dynamics_derivative(model: Model, max_nodes: int = MAX_NODES) -> Program:
    """Forward dynamics and its directional derivative: ``forward_dynamics``, ``pivots``, ``inertias`` as above, and

    ``forward_dynamics_derivative`` (n,): g d(q'') = -dID at q'' = FD with dq'' = 0, along the symbols ``d.*`` of
    coordinates, velocities and inputs. Raises as forward_dynamics.
    """
    require_open(model.closures, "use linearisations")
    r = Workspace(model)
    factors, told = factors_of(r, max_nodes)
    found = _accelerations(r, factors)
    # dID at the symbols q'' with dq'' = 0, then at q'' = FD
    rows = vector(_along(r, r.inverse_dynamics(), frozenset(("acceleration",))))
    slopes = program(r.graph, {"slopes": rows}, r.symbols)
    bindings = {f"{name}''": x for name, x in zip(model.coordinates, found, strict=True)}
    at_found = replay(slopes, r.graph, bindings)["slopes"].entries
    # g d(q'') = -dID
    result = factors.solve([-at_found.get((a,), r.graph.zero) for a in range(r.n)])
    return r.program({FD: vector(found), **told, f"{FD}_derivative": vector(result)})


def factors_of(r: Workspace, max_nodes: int) -> tuple[Factors[Expr], dict[str, Formulas]]:
    """L and D of the metric, and the outputs ``pivots`` and ``inertias``."""
    size = factor_operations(r.n, r.model.program.outputs["metric"].index)
    if size > max_nodes:
        raise TooLarge("forward dynamics (in operations)", size, max_nodes)
    metric = r.independent("metric")
    try:
        factors = factorised(r.n, metric)
    except ZeroDivisionError:
        message = "the metric is singular or not positive definite: check masses, inertias and coordinates"
        raise SingularMetric.at("", SINGULAR, message) from None
    # D_k / |g_kk|: 1 for a coordinate alone, 0 where others leave it no inertia
    sizes = [r.graph.function("abs", metric[k, k]) for k in range(r.n)]
    pivots = [pivot / size for pivot, size in zip(factors.pivots, sizes, strict=True)]
    return factors, {"pivots": vector(pivots), "inertias": vector(sizes)}


def _accelerations(r: Workspace, factors: Factors[Expr]) -> list[Expr]:
    """q'' with g q'' = Q - Gamma q' q'."""
    forces = r.vector("forces")
    if "nonlinear_effects" not in r.model.program.outputs:  # a model of an older version
        return factors.solve([force - bias for force, bias in zip(forces, r.vector("bias"), strict=True)])
    # Q_a without gravity, which is among the nonlinear effects
    others = [force - weight for force, weight in zip(forces, r.vector("gravity"), strict=True)]
    return factors.solve([x - effect for x, effect in zip(others, r.vector("nonlinear_effects"), strict=True)])
