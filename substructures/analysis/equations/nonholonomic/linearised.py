"""Equations in quasi-velocities linearised about a motion, as formulas.

With e = g* v' + bias - forces and q' = T v + r of :mod:`.quasi_velocities`, about any q, v, v' at given inputs:

    M dv' + D dv + K dq = F du        dq' = T dv + R dq
    M = g*    D = de/dv    K = de/dq    F = -de/du    R = d(T v + r)/dq    gaps' = 0: d(gaps)/dq dq = const
"""

from __future__ import annotations

from functools import lru_cache

from substructures.analysis.equations.formulas import inputs_of
from substructures.analysis.equations.nonholonomic.quasi_velocities import (
    Choice,
    QuasiVelocities,
    quasi_velocity_equations,
)
from substructures.analysis.equations.nonholonomic.velocity_constraints import Constraint
from substructures.analysis.equations.perturbation import require_smooth
from substructures.certificate.derived.perturbed import constrained
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.known import Known
from substructures.expr.program import Formulas, Program, Symbol, array, program
from substructures.expr.replay import replay
from substructures.quantities.certificate import certified
from substructures.quantities.numbers.memo import known_model
from substructures.tree.document import require_undriven
from substructures.tree.model import Model

EQUATIONS = ("metric", "bias", "forces", "rates", "T")


def linearised(model: Model, constraints: tuple[Constraint, ...], choice: Choice) -> tuple[QuasiVelocities, Program]:
    """The equations of a model with constraints, and ``metric`` (p, p), ``damping`` (p, p), ``stiffness`` (p, n),
    ``input`` (p, m), ``residual`` (p,), ``T`` (n, p), ``rates_by_position`` (n, n) and ``gaps_by_position`` (k, n) of
    them, which are M, D, K, F, e, T, R above. ``choice``: velocities, independent coordinates, and what they are near,
    as pairs. Raises InvalidInput as quasi_velocity_equations, also for forces without derivative, and TooLarge.
    """
    require_undriven(model.driven, "take simulations")
    require_smooth(model)
    velocities, independent, near = choice
    equations = quasi_velocity_equations(
        model,
        constraints,
        velocities=None if velocities is None else dict(velocities),
        independent=independent,
        near=None if near is None else dict(near),
    )
    known = f"{known_model(model).digest} {equations.velocities} {equations.program.digest}"
    return equations, _perturbed(Known(known, equations))


@lru_cache(maxsize=32)
def _perturbed(known: Known) -> Program:
    equations: QuasiVelocities = known.source
    model, names, graph = equations.model, list(equations.velocities), Graph()
    n, p, inputs, q = model.dof, len(names), inputs_of(model), list(model.coordinates)
    gaps = ["gaps"] if equations.gaps else []
    found = replay(equations.program, graph, {}, [*EQUATIONS, *gaps])
    g, bias, forces, rates, T = (found[name].expanded() for name in EQUATIONS)
    symbols = {s.name: s for s in equations.program.symbols}
    for name in names:
        unit = symbols[name].unit if name in symbols else ""
        symbols.setdefault(f"{name}'", Symbol(f"{name}'", "acceleration", f"{unit}^2" if unit else ""))
    dv = [graph.symbol(f"{name}'") for name in names]
    # e = g* v' + bias - forces
    e = [
        graph.sum(graph.lift(g.get((i, j), 0)) * x for j, x in enumerate(dv)) + bias.get((i,), 0) - forces.get((i,), 0)
        for i in range(p)
    ]
    moved = [graph.lift(rates.get((a,), 0)) for a in range(n)]
    outputs = {
        "metric": Formulas((p, p), {i: x for i, x in g.items() if i[0] <= i[1]}, "symmetric"),
        "damping": _matrix(gradient(e, names), p),
        "stiffness": _matrix(gradient(e, q), n),
        "input": _matrix([[-x for x in row] for row in gradient(e, inputs)], len(inputs)),
        "residual": array((p,), lambda i: e[i]),
        "T": Formulas((n, p), T),
        "rates_by_position": _matrix(gradient(moved, q), n),
    }
    if gaps:
        kept = found["gaps"].expanded()
        outputs["gaps_by_position"] = _matrix(
            gradient([graph.lift(kept.get((k,), 0)) for k in range(len(equations.gaps))], q), n
        )
    result = program(graph, outputs, symbols)
    expectation = constrained(equations.program, names, inputs)
    kinds = {s.name: s.kind for s in symbols.values()}
    return certified(result, model, expectation, "linearised velocity equations", needs=("metric",), more=kinds)


def _matrix(rows: list[list[Expr]], width: int) -> Formulas:
    return array((len(rows), width), lambda i, j: rows[i][j])
