"""The adjoint equations of optimal control as formulas (notation.md, section 7).

With the Hamiltonian H = lambda_0 l + lambda_q . q' + lambda_qd . q'' and q'' from the equations of motion

    lambda_q' = -dH/dq         lambda_qd' = -dH/dq'         lambda(T) = lambda_0 dphi/dx         dJ/du = dH/du

(A. E. Bryson and Y.-C. Ho, Applied Optimal Control, 1975, section 2.3). No inverse of the metric is formed: with
ID(q, q', q'', u) = g q'' + Gamma q' q' - Q = 0 and the solution mu of g mu = lambda_qd

    lambda_qd . dq''/dz = -mu . dID/dz        dH/dz = d/dz (lambda_0 l - mu . ID + lambda_q . q')

for every z, at fixed q'' and mu. Closures phi(q) = 0 with G = dphi/dq and c = G' q' act by multipliers rho, and

    g q'' + Gamma q' q' - Q - G^T rho = 0,  G q'' + c = 0         g mu + G^T nu = lambda_qd,  G mu = 0
    lambda_qd . dq''/dz = -mu . d(ID - G^T rho)/dz - nu . d(G q'' + c)/dz

so that the gradient is that of motions on the closures for states that stay there. With ball joints q are the m numbers
of a state, quaternions among them, q' = r(q, v) of these stands in H, and its derivatives in dH/dz. One walk in reverse
mode over ID and l gives the derivatives by all states, controls and parameters together, for a small multiple of the
operations of inverse dynamics.

===================  =========  ======================================================================
output               shape      meaning
===================  =========  ======================================================================
metric               n n        g; solves g q'' = force and g mu = lambda_qd
force                n          Q - Gamma q' q'
running_cost                    l
hamiltonian                     H
adjoint_q            m          lambda_q' = -dH/dq, m = n but for ball joints
adjoint_qd           n          lambda_qd' = -dH/dq'
control_gradient     m          dH/du, in the order of the controls
parameter_gradient   r          dH/dp, in the order of the varied parameters
terminal_cost                   phi
terminal_q           m          dphi/dq
terminal_qd          n          dphi/dq'
terminal_parameters  r          dphi/dp
===================  =========  ======================================================================

With closures also ``closure.jacobian`` G (k, n) and ``closure.acceleration`` c (k,), with velocity constraints B for
G and B' q' for c, as for any motion that they are true of at its start; with ball joints
``position_rates`` r (m,).

Symbols beside those of the model: accelerations ``x.q1''``, costates ``lambda.x.q1`` (of q) and ``lambda.x.q1'`` (of
q'), ``mu.x.q1``, of each row of closures ``rho.loop.x`` and ``nu.loop.x``, and ``lambda.0``, which is 1 except where
the end alone is judged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from substructures.analysis.arguments import exact
from substructures.analysis.control.holding import HOLDING, Ties, ties_of
from substructures.analysis.control.problem import Cost, declared, read_costs
from substructures.analysis.equations.formulas import inputs_of
from substructures.analysis.given import require_known
from substructures.analysis.motion.conditions import state_names
from substructures.certificate.derived.adjoint import adjoint
from substructures.expr.differentiate import pullback
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Program, array, program
from substructures.expr.replay import replay
from substructures.loads.scope import Scope
from substructures.quantities.certificate import DYNAMICS as NEEDS
from substructures.quantities.certificate import certified
from substructures.quantities.formulas import derived
from substructures.tree.document import require_undriven
from substructures.tree.model import KINEMATICS, Model

ID = "inverse_dynamics"
WEIGHT = "lambda.0"
#: r of ball joints
CHANGES = "position_rates"
#: among what is varied it stands for the horizon, on which all times but the first depend
HORIZON = "t"
MOTION = ("metric", "force", "running_cost")
ADJOINT = ("adjoint_q", "adjoint_qd", "control_gradient", "parameter_gradient")
TERMINAL = ("terminal_cost", "terminal_q", "terminal_qd", "terminal_parameters")


@dataclass(frozen=True, repr=False)
class AdjointEquations:
    """The program of the table above, and the names of what it is written in; ``positions``: of the numbers of q, the
    coordinates but for ball joints; ``rows``: of closures, closure.row.
    """

    program: Program
    coordinates: tuple[str, ...]
    positions: tuple[str, ...]
    controls: tuple[str, ...]
    varied: tuple[str, ...]
    rows: tuple[str, ...] = ()

    def __repr__(self) -> str:
        sizes = f"n={len(self.coordinates)}, controls={len(self.controls)}, varied={len(self.varied)}"
        return f"AdjointEquations({sizes})\n{len(self.program)} operations, outputs {', '.join(self.program.outputs)}"

    def names(self, prefix: str = "", primes: str = "") -> list[str]:
        """The symbols of coordinates (velocities: primes ', accelerations: ''), or of costates by their prefix."""
        return [f"{prefix}{name}{primes}" for name in self.coordinates]

    @property
    def motion(self) -> tuple[str, ...]:
        """The outputs that accelerations and the cost follow from."""
        turning = (CHANGES,) if self.positions != self.coordinates else ()
        return (*MOTION, *turning, *HOLDING) if self.rows else (*MOTION, *turning)


def adjoint_equations(
    model: Model, controls: Sequence[str], cost: Cost, varied: Sequence[str] = ()
) -> AdjointEquations:
    """The adjoint equations of a model for controls (names of inputs), a cost, and ``varied`` parameters.

    HORIZON among ``varied``: derivatives by time. Raises InvalidInput for names that are not known (``/controls/i``,
    ``/varied/i``), for faults in the cost (``/cost/running``), and for driven coordinates beside closures.
    """
    require_known("controls", "input", controls, inputs_of(model))
    require_known("varied", "parameter", varied, {*model.parameters, HORIZON})
    tied = ties_of(model)
    require_undriven(model.driven if tied.labels else (), "take simulations")
    scope, source = Scope(Graph()), derived(model, ID)
    declared(model, scope, {s.name: s for s in (*source.symbols, *model.program.symbols)})
    running, terminal = read_costs(model, cost, scope)
    needed, metric, force = _equations(model, source, scope.graph)
    own = _Multipliers.of(model, tied, scope)
    second = [scope.names[f"{name}''"] for name in model.coordinates]
    missing, opened, holding = _closed(tied.program, scope, own.rho, needed, second)
    (changes, turning), states, n, m = _changes(model, scope), state_names(model), model.dof, len(model.positions)
    # d(lambda_0 l - mu . (ID - G^T rho) - nu . (G q'' + c) + lambda_q . r)/dz for every z of q, q', u, p in one walk
    weights = [own.weight, *(-x for x in (*own.mu, *own.nu)), *own.costates[: len(turning)]]
    slope = pullback([running, *missing, *opened, *turning], weights, [*states, *controls, *varied])
    moved = scope.graph.sum(x * y for x, y in zip(own.costates, [*changes, *second], strict=True))
    outputs = {
        "metric": metric,
        "force": force,
        "running_cost": Formulas((), {(): running}),
        # H = lambda_0 l + lambda_q . q' + lambda_qd . q''
        "hamiltonian": Formulas((), {(): own.weight * running + moved}),
        # -dH/dq, and -dH/dq' = -(lambda_q + slope)
        "adjoint_q": array((m,), lambda a: -slope[a]),
        "adjoint_qd": array((n,), lambda a: -slope[m + a] if turning else -(own.costates[a] + slope[n + a])),
        "control_gradient": array((len(controls),), lambda i: slope[m + n + i]),
        "parameter_gradient": array((len(varied),), lambda i: slope[m + n + len(controls) + i]),
    } | holding
    outputs |= _terminal(terminal, [*states, *varied], (m, n), scope.graph)
    outputs |= {CHANGES: array((m,), turning.__getitem__)} if turning else {}
    result = _certified(program(scope.graph, outputs, scope.symbols), model, cost, (controls, varied), (own, tied))
    return AdjointEquations(result, model.coordinates, model.positions, tuple(controls), tuple(varied), own.labels)


def _changes(model: Model, scope: Scope) -> tuple[list[Expr], list[Expr]]:
    """q', and with ball joints r once more, whose derivatives are part of dH/dz."""
    if not model.balls:
        return [scope.names[f"{name}'"] for name in model.coordinates], []
    found = replay(model.program, scope.graph, {}, [CHANGES])[CHANGES].entries
    changes = [scope.graph.lift(found.get((k,), 0)) for k in range(len(model.positions))]
    return changes, changes


def _terminal(phi: Expr, names: Sequence[str], sizes: tuple[int, int], graph: Graph) -> dict[str, Formulas]:
    """phi, and dphi/d(q, q', p) for these ``names``; ``sizes``: of q and q'."""
    end, (m, n) = pullback([phi], [graph.one], names), sizes
    return {
        "terminal_cost": Formulas((), {(): phi}),
        "terminal_q": array((m,), lambda a: end[a]),
        "terminal_qd": array((n,), lambda a: end[m + a]),
        "terminal_parameters": array((len(names) - m - n,), lambda i: end[m + n + i]),
    }


def _certified(
    made: Program,
    model: Model,
    cost: Cost,
    names: tuple[Sequence[str], Sequence[str]],
    holding: tuple[_Multipliers, Ties],
) -> Program:
    """The program, once it was compared; ``names``: of controls, and of what is varied."""
    own, tied = holding
    texts = {name: exact(getattr(cost, name), f"/cost/{name}") for name in ("running", "terminal")}
    return certified(
        made,
        model,
        adjoint(names[0], texts, names[1], own.labels, model.positions, tied.expected(made)),
        "adjoint equations",
        needs=(*NEEDS, HOLDING[1], CHANGES, *KINEMATICS),
        more=dict.fromkeys(own.names, "input"),
    )


@dataclass(frozen=True)
class _Multipliers:
    """Symbols of the adjoint: costates of q and q' (m + n), mu (n), rho and nu of the rows ``labels`` of closures, and
    lambda_0.
    """

    costates: list[Expr]
    mu: list[Expr]
    rho: list[Expr]
    nu: list[Expr]
    weight: Expr
    labels: tuple[str, ...]
    names: tuple[str, ...]

    @classmethod
    def of(cls, model: Model, tied: Ties, scope: Scope) -> _Multipliers:
        """Declared in the scope."""
        labels = tied.labels
        states = [*model.positions, *(f"{name}'" for name in model.coordinates)]
        groups = (("lambda", states), ("mu", model.coordinates), ("rho", labels), ("nu", labels))
        names = [[f"{prefix}.{name}" for name in some] for prefix, some in groups]
        costates, mu, rho, nu = ([scope.declare(name, "input") for name in some] for some in names)
        told = (*(name for some in names for name in some), WEIGHT)
        return cls(costates, mu, rho, nu, scope.declare(WEIGHT, "input"), labels, told)


def _equations(model: Model, source: Program, graph: Graph) -> tuple[list[Expr], Formulas, Formulas]:
    """Rows of ID, g, and Q - Gamma q' q' in one graph."""
    zero, n = graph.zero, model.dof
    found = replay(source, graph, {}, [ID])[ID].entries
    own = replay(model.program, graph, {}, ["metric", "forces", "bias"])
    force: dict[tuple[int, ...], Expr | int] = {}
    force |= {(a,): own["forces"].entries.get((a,), zero) - own["bias"].entries.get((a,), zero) for a in range(n)}
    return [zero + found.get((a,), zero) for a in range(n)], own["metric"], Formulas((n,), force)


def _closed(
    source: Program, scope: Scope, rho: Sequence[Expr], needed: list[Expr], second: Sequence[Expr]
) -> tuple[list[Expr], list[Expr], dict[str, Formulas]]:
    """ID - G^T rho (n,) from ID, G q'' + c (k,), and G and c of ``source``; ID alone without rows. ``second``: q''."""
    if not rho:
        return needed, [], {}
    graph, k = scope.graph, len(rho)
    found = replay(source, graph, {}, HOLDING)
    G, c = (found[name].entries for name in HOLDING)
    held = [graph.sum(G[i, a] * rho[i] for i in range(k) if (i, a) in G) for a in range(len(needed))]
    moved = (graph.sum(G[i, a] * x for a, x in enumerate(second) if (i, a) in G) for i in range(k))
    missing = [x - y for x, y in zip(needed, held, strict=True)]
    return missing, [x + c.get((i,), graph.zero) for i, x in enumerate(moved)], {name: found[name] for name in HOLDING}
