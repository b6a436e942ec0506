"""The adjoint equations of optimal control as formulas (notation.md, section 7).

With the Hamiltonian H = lambda_0 l + lambda_q . q' + lambda_qd . q'' and q'' from the equations of motion

    lambda_q' = -dH/dq         lambda_qd' = -dH/dq'         lambda(T) = lambda_0 dphi/dx         dJ/du = dH/du

(A. E. Bryson and Y.-C. Ho, Applied Optimal Control, 1975, section 2.3). No inverse of the metric is formed: with
ID(q, q', q'', u) = g q'' + Gamma q' q' - Q = 0 and the solution mu of g mu = lambda_qd

    lambda_qd . dq''/dz = -mu . dID/dz        dH/dz = d/dz (lambda_0 l - mu . ID + lambda_q . q')

for every z, at fixed q'' and mu. One walk in reverse mode over ID and l gives the derivatives by all states, controls
and parameters together, for a small multiple of the operations of inverse dynamics.

===================  =========  ======================================================================
output               shape      meaning
===================  =========  ======================================================================
metric               n n        g; solves g q'' = force and g mu = lambda_qd
force                n          Q - Gamma q' q'
running_cost                    l
hamiltonian                     H
adjoint_q            n          lambda_q' = -dH/dq
adjoint_qd           n          lambda_qd' = -dH/dq'
control_gradient     m          dH/du, in the order of the controls
parameter_gradient   r          dH/dp, in the order of the varied parameters
terminal_cost                   phi
terminal_q           n          dphi/dq
terminal_qd          n          dphi/dq'
terminal_parameters  r          dphi/dp
===================  =========  ======================================================================

Symbols beside those of the model: accelerations ``x.q1''``, costates ``lambda.x.q1`` (of q) and ``lambda.x.q1'`` (of
q'), ``mu.x.q1``, and ``lambda.0``, which is 1 except where the end alone is judged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from substructures.analysis.arguments import exact
from substructures.analysis.control.problem import LINEAR, Cost, declared, read_costs
from substructures.analysis.equations.formulas import inputs_of
from substructures.analysis.given import require_known
from substructures.certificate.derived.perturbed import adjoint
from substructures.expr.differentiate import pullback
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Program, array, program
from substructures.expr.replay import replay
from substructures.loads.scope import Scope
from substructures.quantities.certificate import certified
from substructures.quantities.formulas import derived
from substructures.tree.model import Model, require_open

ID = "inverse_dynamics"
WEIGHT = "lambda.0"
#: among what is varied it stands for the horizon, on which all times but the first depend
HORIZON = "t"
MOTION = ("metric", "force", "running_cost")
ADJOINT = ("adjoint_q", "adjoint_qd", "control_gradient", "parameter_gradient")
TERMINAL = ("terminal_cost", "terminal_q", "terminal_qd", "terminal_parameters")


@dataclass(frozen=True, repr=False)
class AdjointEquations:
    """The program of the table above, and the names of what it is written in."""

    program: Program
    coordinates: tuple[str, ...]
    controls: tuple[str, ...]
    varied: tuple[str, ...]

    def __repr__(self) -> str:
        sizes = f"n={len(self.coordinates)}, controls={len(self.controls)}, varied={len(self.varied)}"
        return f"AdjointEquations({sizes})\n{len(self.program)} operations, outputs {', '.join(self.program.outputs)}"

    def names(self, prefix: str = "", primes: str = "") -> list[str]:
        """The symbols of coordinates (velocities: primes ', accelerations: ''), or of costates by their prefix."""
        return [f"{prefix}{name}{primes}" for name in self.coordinates]


def adjoint_equations(
    model: Model, controls: Sequence[str], cost: Cost, varied: Sequence[str] = ()
) -> AdjointEquations:
    """The adjoint equations of a model for controls (names of inputs), a cost, and ``varied`` parameters.

    Raises InvalidInput for names that are not known (``/controls/i``, ``/varied/i``), for faults in the cost
    (``/cost/running``), and for closures. HORIZON among ``varied`` gives the derivatives by time there.
    """
    require_known("controls", "input", controls, inputs_of(model))
    require_known("varied", "parameter", varied, {*model.parameters, HORIZON})
    require_open(model.closures, LINEAR)
    scope = Scope(Graph())
    source = derived(model, ID)
    declared(model, scope, {s.name: s for s in (*source.symbols, *model.program.symbols)})
    running, terminal = read_costs(model, cost, scope)
    rows, metric, force = _equations(model, source, scope.graph)
    costates = [_declare(scope, f"lambda.{name}") for name in model.coordinates]
    speeds = [_declare(scope, f"lambda.{name}'") for name in model.coordinates]
    mu = [_declare(scope, f"mu.{name}") for name in model.coordinates]
    weight = _declare(scope, WEIGHT)
    n, rates = model.dof, [f"{name}'" for name in model.coordinates]
    names = [*model.coordinates, *rates, *controls, *varied]
    moving = [*model.coordinates, *rates, *varied]
    # d(lambda_0 l - mu . ID)/dz for every z of q, q', u, p in one walk
    slope = pullback([running, *rows], [weight, *(-x for x in mu)], names)
    # dphi/d(q, q', p)
    end = pullback([terminal], [scope.graph.one], moving)
    accelerations = (scope.names[f"{name}''"] for name in model.coordinates)
    rate = [scope.names[name] for name in rates]
    # H = lambda_0 l + lambda_q . q' + lambda_qd . q''
    pairs = zip([*costates, *speeds], [*rate, *accelerations], strict=True)
    outputs = {
        "metric": metric,
        "force": force,
        "running_cost": Formulas((), {(): running}),
        "hamiltonian": Formulas((), {(): weight * running + scope.graph.sum(x * y for x, y in pairs)}),
        # -dH/dq, and -dH/dq' = -(lambda_q + slope)
        "adjoint_q": array((n,), lambda a: -slope[a]),
        "adjoint_qd": array((n,), lambda a: -(costates[a] + slope[n + a])),
        "control_gradient": array((len(controls),), lambda i: slope[2 * n + i]),
        "parameter_gradient": array((len(varied),), lambda i: slope[2 * n + len(controls) + i]),
        "terminal_cost": Formulas((), {(): terminal}),
        "terminal_q": array((n,), lambda a: end[a]),
        "terminal_qd": array((n,), lambda a: end[n + a]),
        "terminal_parameters": array((len(varied),), lambda i: end[2 * n + i]),
    }
    texts = {name: exact(getattr(cost, name), f"/cost/{name}") for name in ("running", "terminal")}
    own = [*(f"{prefix}{name}" for prefix in ("lambda.", "mu.") for name in (*model.coordinates, *rates)), WEIGHT]
    result = certified(
        program(scope.graph, outputs, scope.symbols),
        model,
        adjoint(controls, texts, varied),
        "adjoint equations",
        more=dict.fromkeys(own, "input"),
    )
    return AdjointEquations(result, model.coordinates, tuple(controls), tuple(varied))


def _declare(scope: Scope, name: str) -> Expr:
    return scope.declare(name, "input")


def _equations(model: Model, source: Program, graph: Graph) -> tuple[list[Expr], Formulas, Formulas]:
    """Rows of ID, g, and Q - Gamma q' q' in one graph."""
    zero, n = graph.zero, model.dof
    found = replay(source, graph, {}, [ID])[ID].entries
    own = replay(model.program, graph, {}, ["metric", "forces", "bias"])
    force: dict[tuple[int, ...], Expr | int] = {}
    force |= {(a,): own["forces"].entries.get((a,), zero) - own["bias"].entries.get((a,), zero) for a in range(n)}
    return [zero + found.get((a,), zero) for a in range(n)], own["metric"], Formulas((n,), force)
