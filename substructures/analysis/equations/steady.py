"""Steady motions as formulas: x and s' = w constant (E. J. Routh, Stability of a given state of motion, 1877).

With E_x = Gamma_xbc q'^b q'^c - Q_x for the coordinates x that keep still while the coordinates s turn or slide with
rates w, a motion is steady where E_x(x, x' = 0, w) = 0. Disturbed by dx, with momenta p_s = g_ss w + g_sx x' that keep
their values, or rates that do,

    momenta    M = g_xx - g_xs g_ss^-1 g_sx       D = E_x,x' - g_xs g_ss^-1 N - E_x,w g_ss^-1 g_sx
               K = E_x,x - E_x,w g_ss^-1 N        N = d(g_ss w)/dx
    rates      M = g_xx                           D = E_x,x'            K = E_x,x

are the matrices of M dx'' + D dx' + K dx = 0. Without forces that have no potential K is the Hessian of the amended
potential V + 1/2 p g_ss^-1 p at constant momenta, of V - 1/2 w g_ss w at constant rates.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from substructures.analysis.equations.formulas import ModelFormulas, multipliers_of
from substructures.analysis.equations.perturbation import require_smooth
from substructures.certificate.derived.perturbed import steady
from substructures.errors import InvalidArgument
from substructures.expr.calculus.corners import VanishingOnAllSides
from substructures.expr.differentiate import directional, gradient
from substructures.expr.known import Known
from substructures.expr.program import Program, array, program
from substructures.expr.walk import transfer
from substructures.quantities.certificate import certified
from substructures.quantities.numbers.memo import known_model
from substructures.tree.model import Model


def steady_formulas(model: Model, moving: Sequence[int]) -> Program:
    """The functions above of x, w (the symbols s') and parameters, at x' = 0, for coordinates s = ``moving``.

    Outputs, for r coordinates x and m coordinates s: ``metric`` (n, n), ``residual`` E_x (r,), ``by_position`` E_x,x
    (r, r), ``by_velocity`` E_x,x' (r, r), ``by_rate`` E_x,w (r, m), ``momenta`` g_ss w (m,) and ``momenta_by_position``
    N (m, r). With closures E_x is less G_kx lambda_k, and there are ``closure.residual`` (c,) and ``closure.jacobian``
    G_kx (c, r). Raises InvalidDocument for forces without derivative.
    """
    return _steady_formulas(known_model(model), tuple(moving))


@lru_cache(maxsize=32)
def _steady_formulas(known: Known, moving: tuple[int, ...]) -> Program:
    model: Model = known.source
    require_smooth(model)
    f = ModelFormulas(model)
    still = [a for a in range(f.n) if a not in moving]
    names = {prime: [f"{model.coordinates[a]}{prime}" for a in still] for prime in ("", "'")}
    w = [f"{model.coordinates[s]}'" for s in moving]
    bias, forces, g = f.vector("bias"), f.vector("forces"), f.elements("metric")
    E = [bias[a] - forces[a] - f.reactions[a] for a in still]
    p = [f.graph.sum(g[s, b] * f.rates[b] for b in moving if (s, b) in g) for s in moving]
    blocks = [gradient(E, names[""]), gradient(E, names["'"]), gradient(E, w), gradient(p, names[""])]
    found = {
        "metric": array((f.n, f.n), lambda a, b: g.get((a, b), f.graph.zero)),
        "residual": array((len(E),), lambda a: E[a]),
        "by_position": array((len(E), len(E)), lambda a, b: blocks[0][a][b]),
        "by_velocity": array((len(E), len(E)), lambda a, b: blocks[1][a][b]),
        "by_rate": array((len(E), len(w)), lambda a, b: blocks[2][a][b]),
        "momenta": array((len(p),), lambda a: p[a]),
        "momenta_by_position": array((len(p), len(E)), lambda a, b: blocks[3][a][b]),
    }
    if model.closures:
        phi, G = f.elements("closure.residual"), f.elements("closure.jacobian")
        c = len(multipliers_of(model))
        found["closure.residual"] = array((c,), lambda k: phi.get((k,), f.graph.zero))
        found["closure.jacobian"] = array((c, len(still)), lambda k, a: G.get((k, still[a]), f.graph.zero))
    # x' = 0
    rest = dict.fromkeys(names["'"], f.graph.zero)
    outputs = {}
    for name, formulas in found.items():
        values = transfer(formulas.entries.values(), f.graph, rest)
        outputs[name] = type(formulas)(formulas.shape, dict(zip(formulas.entries, values, strict=True)))
    multipliers = multipliers_of(model)
    result, more = program(f.graph, outputs, f.symbols), dict.fromkeys(multipliers, "input")
    return certified(result, model, steady(still, moving, multipliers), "steady motions", more=more)


def require_free(model: Model, moving: Sequence[int]) -> None:
    """Raises InvalidArgument (``/rates``) when what acts on the other coordinates depends on the coordinates that are
    driven at constant rates: then no motion is steady.
    """
    f = ModelFormulas(model)
    still = [a for a in range(f.n) if a not in moving]
    bias, forces, g = f.vector("bias"), f.vector("forces"), f.elements("metric")
    seen = [bias[a] - forces[a] for a in still] + [g[a, b] for a in still for b in still if (a, b) in g]
    seen += f.elements("closure.residual").values() if model.closures else ()
    vanishes = VanishingOnAllSides(f.graph)
    for s in moving:
        name = model.coordinates[s]
        if not all(map(vanishes, directional(seen, {name: f.graph.one}))):
            message = f"the motion of the other coordinates depends on '{name}' itself, so none is steady"
            raise InvalidArgument.at(f"/rates/{name}", "not-cyclic", message)
