"""Perturbation equations as formulas: M dq'' + D dq' + K dq = F du (notation.md, section 7).

About any q, q', q'', at given inputs and time:

    M_ab = g_ab        D_ab = 2 Gamma_abc q'^c - dQ_a/dq'^b
    K_ab = d_b g_ac q''^c + d_b Gamma_acd q'^c q'^d - d_b Q_a - lambda_k d_b G_ka        F_ai = dQ_a/du_i

With closures phi_k (G_ka = d_a phi_k, multipliers lambda_k) M dq'' + D dq' + K dq = F du + G^T dlambda and G dq = 0.

With ball joints (section 14) dq has of each the displacement and the rotation vector in the axes of the body that it
carries, dQ = 1/2 Q (0, dq), and d_b is the derivative along these; rates v are no derivatives:

    M dv' + D dv + K dq = F du        dq' = dv + R dq

and as first order equations dx' = A dx + B du, dy = C dx + D du, x = (q, q'), for outputs y = h(q, q', u, t).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache

from substructures.analysis.arguments import NumberOrExpression, exact
from substructures.analysis.equations.expressions import read_expressions
from substructures.analysis.equations.formulas import ModelFormulas, inputs_of, multipliers_of
from substructures.analysis.given import require_known
from substructures.certificate.derived.perturbed import first_order, perturbed
from substructures.errors import Fault, InvalidDocument
from substructures.expr.differentiate import directional, gradient, in_directions
from substructures.expr.garbage import without_collections
from substructures.expr.graph import Expr
from substructures.expr.known import Known
from substructures.expr.program import Formulas, Program, array, program
from substructures.expr.replay import replay
from substructures.quantities.certificate import certified
from substructures.quantities.derivatives import inverse_dynamics_jacobians
from substructures.quantities.numbers.memo import known_model
from substructures.quantities.numbers.workspace import ID, vector
from substructures.tree.cuts import require_open
from substructures.tree.document import require_undriven
from substructures.tree.model import Model

#: operations without a derivative at a zero of their argument
JUMPS = ("abs", "sign")
SMOOTHER = "replace |x| by sqrt(x^2 + e^2) and sign(x) by x/sqrt(x^2 + e^2) with a small e, or leave the load out"


def require_smooth(model: Model) -> None:
    """Raises InvalidDocument (``not-smooth``) that names the coordinates on which a force with |x| or sign x acts."""
    program = model.program
    jumps = [i for i in program.reachable(["forces"]) if program.operations[i][0] in JUMPS]
    if not jumps:
        return
    reached = set(jumps)
    for i in program.reachable(["forces"]):
        operation = program.operations[i]
        if operation[0] not in ("int", "rat", "sym") and reached.intersection(operation[1:]):
            reached.add(i)
    forces = program.outputs["forces"]
    pairs = zip(forces.index, forces.entries, strict=True)
    culprits = ", ".join(f"'{model.coordinates[a]}'" for (a,), entry in pairs if entry in reached)
    message = f"the force on {culprits} has no derivative everywhere: {SMOOTHER}"
    raise InvalidDocument([Fault("", "not-smooth", message)])


def perturbation(model: Model) -> Program:
    """M, D, K, F as formulas: outputs ``metric``, ``damping``, ``stiffness`` (n, n), ``input`` (n, inputs_of(model)),
    and ``residual`` (n,): g q'' + Gamma q' q' - Q - G^T lambda, zero where q'' is that of the motion. With closures of
    m rows also ``closure.residual`` (m,), ``closure.jacobian`` (m, n): G, and along the motion its first and second
    derivative by time, ``closure.jacobian_rate`` and ``closure.jacobian_second`` (m, n); symbols of the multipliers:
    multipliers_of(model). With ball joints also ``rates_by_position`` (n, n): R.

    Raises InvalidDocument for forces without derivative.
    """
    return _perturbation(known_model(model))


@lru_cache(maxsize=32)
@without_collections
def _perturbation(known: Known) -> Program:
    model: Model = known.source
    if model.closures:
        require_undriven(model.driven, "take simulations, or loop states")
    require_smooth(model)
    f = ModelFormulas(model)
    source = inverse_dynamics_jacobians(model)
    found = replay(source, f.graph, {})
    rows = _rows(found[ID], model.dof, f.graph.zero)
    names = inputs_of(model)
    # F_ai = dQ_a/du_i = -dID_a/du_i
    by_input = gradient(rows, names)
    outputs = {
        "metric": Formulas((f.n, f.n), {i: x for i, x in f.elements("metric").items() if i[0] <= i[1]}, "symmetric"),
        "damping": found[f"{ID}_qd"],
        "stiffness": found[f"{ID}_q"],
        "input": array((f.n, len(names)), lambda a, i: -by_input[a][i]),
        "residual": found[ID],
    }
    if model.balls:
        outputs["rates_by_position"] = Formulas((f.n, f.n), f.displacement_rates)
    if model.closures:
        outputs |= _with_closures(f, outputs)
    result = program(f.graph, outputs, {s.name: s for s in source.symbols} | f.symbols)
    f.graph.release()
    multipliers = multipliers_of(model)
    more = dict.fromkeys(multipliers, "input")
    return certified(result, model, perturbed(names, multipliers, model.balls), "perturbation", more=more)


def _with_closures(f: ModelFormulas, found: Mapping[str, Formulas]) -> dict[str, Formulas]:
    """The outputs that closures add or change."""
    K, residual, n = found["stiffness"].entries, found["residual"].entries, f.n
    # lambda_k d_b G_ka
    second = gradient(f.reactions, f.model.coordinates)
    G, shape = f.elements("closure.jacobian"), f.model.program.outputs["closure.jacobian"].shape
    position, rates = [str(x.value) for x in f.q], dict(zip(f.model.coordinates, f.rates, strict=True))
    # G' = d_b G q'^b, and G'' = d_b G' q'^b + dG'/dq'^b q''^b
    accelerations = {f"{name}'": f.acceleration_symbol(a) for a, name in enumerate(position)}
    rate = directional(list(G.values()), rates)
    bent = directional(rate, rates | accelerations)
    return {
        "stiffness": array((n, n), lambda a, b: K.get((a, b), f.graph.zero) - second[a][b]),
        "residual": array((n,), lambda a: residual.get((a,), f.graph.zero) - f.reactions[a]),
        "closure.residual": Formulas((shape[0],), dict(f.elements("closure.residual"))),
        "closure.jacobian": Formulas(shape, dict(G)),
        "closure.jacobian_rate": Formulas(shape, dict(zip(G, rate, strict=True))),
        "closure.jacobian_second": Formulas(shape, dict(zip(G, bent, strict=True))),
    }


def _rows(formulas: Formulas, n: int, zero: Expr) -> list[Expr]:
    entries = [formulas.entries.get((a,), zero) for a in range(n)]
    return [x if isinstance(x, Expr) else zero.graph.number(x) for x in entries]


def state_space(
    model: Model, outputs: Sequence[NumberOrExpression] = (), inputs: Sequence[str] | None = None
) -> Program:
    """A (2n, 2n), B (2n, m), C (k, 2n), D (k, m) as formulas at any state, with ``derivative`` (2n,) = x' and
    ``output`` (k,) = y. With ball joints dx = (dq, dv) of the module's equations, and ``derivative`` (m + n,) is that
    of the m numbers of a state q, quaternions among them, and of its rates.

    ``outputs``: expressions in coordinates, velocities, inputs, parameters and t; ``inputs``: default all. Raises
    InvalidInput: bad expressions (``/outputs/i``), unknown inputs (``/inputs/i``), forces without derivative, singular
    metric. Source: notation.md, section 7.
    """
    require_open(model.closures, "use the formulas 'perturbation', which have multipliers, or linearisations (numbers)")
    require_smooth(model)
    chosen = inputs_of(model) if inputs is None else tuple(inputs)
    require_known("inputs", "input", chosen, inputs_of(model))
    f = ModelFormulas(model)
    given = [(exact(x, f"/outputs/{i}"), f"/outputs/{i}") for i, x in enumerate(outputs)]
    read = read_expressions(model, {"output": given}, inputs=True)
    y = _rows(replay(read, f.graph, {})["output"], len(given), f.graph.zero)
    states = [*f.displacements, *({str(rate.value): f.graph.one} for rate in f.rates)]
    acting = [{name: f.graph.one} for name in chosen]
    # dq' = dv + R dq, and g^-1 (Q - Gamma q' q')
    kinematic = f.displacement_rates | {(a, f.n + a): f.graph.one for a in range(f.n)}
    own = [[kinematic.get((a, i), f.graph.zero) for i in range(2 * f.n)] for a in range(f.n)]
    still, x = [[f.graph.zero] * len(chosen)] * f.n, f.acceleration
    matrices = {
        "A": (own + in_directions(x, states), len(states)),
        "B": (still + in_directions(x, acting), len(acting)),
        "C": (in_directions(y, states), len(states)),
        "D": (in_directions(y, acting), len(acting)),
    }
    results = {name: array((len(m), width), lambda i, j, m=m: m[i][j]) for name, (m, width) in matrices.items()}
    results |= {"derivative": vector([*f.position_rates.values(), *x]), "output": vector(y)}
    result = program(f.graph, results, {s.name: s for s in read.symbols} | f.symbols)
    expected = first_order([text for text, _ in given], chosen, model.positions, model.balls)
    return certified(result, model, expected, "state_space")
