"""Routh's reduction: cyclic coordinates leave the equations, their constant momenta stay as parameters.

With r the remaining and c the cyclic coordinates, K = -g_cc^-1 g_cr, P = (1, K) and w = (0, g_cc^-1 p):
q' = P q'_r + w, and the equations of motion in the remaining coordinates are algebraic in g, Gamma and Q,

    h q''_r + Gamma^h q'_r q'_r + B q'_r = f,      h = P^T g P = g_rr - g_rc g_cc^-1 g_cr
    Gamma^h_abc = P_ia P_jb P_kc Gamma_ijk,        B_ab = 2 P_ia P_jb w_k Gamma_ijk (skew: gyroscopic)
    f_a = Q_a - P_ia w_j w_k Gamma_ijk,            V_p = V + 1/2 p^T g_cc^-1 p (amended potential)

because P^T g has no entry at the cyclic coordinates.
Routh's function is R = 1/2 q'_r^T h q'_r + p^T g_cc^-1 g_cr q'_r - V_p.
(E. J. Routh, Stability of a given state of motion, 1877; J. E. Marsden, Lectures on mechanics, 1992, chapter 3.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from substructures.analysis.equations.elimination import MetricElimination
from substructures.analysis.equations.first_integrals import acting_inputs, first_integrals
from substructures.analysis.equations.formulas import ModelFormulas
from substructures.analysis.equations.integral import FirstIntegrals
from substructures.certificate.derived.integrals import reduced
from substructures.errors import InvalidArgument
from substructures.expr.graph import Expr
from substructures.expr.program import Entries, Formulas, Program, Symbol, array, program
from substructures.quantities.certificate import DYNAMICS, certified
from substructures.tree.cuts import require_open
from substructures.tree.document import require_ungiven
from substructures.tree.model import Model


@dataclass(frozen=True, repr=False)
class Reduced:
    """The equations in the r remaining ``coordinates``, without the c ``cyclic`` ones.

    ``program``: metric h (r, r), christoffel (r, r, r), gyroscopic B (r, r), forces f (r,), amended_potential V_p,
    routhian R and cyclic_velocities (c,). ``momenta``: the symbols of the constant momenta ``p.<coordinate>``.
    """

    program: Program
    coordinates: tuple[str, ...]
    cyclic: tuple[str, ...]
    momenta: tuple[str, ...]

    def __repr__(self) -> str:
        sizes = f"coordinates={len(self.coordinates)}, cyclic={list(self.cyclic)}"
        return f"Reduced({sizes})\n{len(self.program)} operations, outputs {', '.join(self.program.outputs)}"


def routh(model: Model, coordinates: Sequence[str] | None = None) -> Reduced:
    """The model without the given cyclic coordinates (default: all), as formulas; inputs are 0, but for those with
    another default, which stay symbols.

        h q''_r + Gamma^h q'_r q'_r + B q'_r = f        q'_c = K q'_r + g_cc^-1 p,  p constant

    Raises InvalidInput for a coordinate that is not cyclic (``/coordinates/i``, see first_integrals), or for none, and
    for closures. Source: E. J. Routh, 1877; J. E. Marsden, 1992 (see above).
    """
    require_open(model.closures, "use first integrals, and simulations")
    require_ungiven(model, "use first integrals, and simulations")
    found: FirstIntegrals = first_integrals(model)
    names = list(found.cyclic if coordinates is None else dict.fromkeys(coordinates))
    cyclic = require_cyclic(model, found, names)
    acting = acting_inputs(model)
    inputs = [s.name for s in model.program.symbols if s.kind == "input" and s.name not in acting]
    return _Reduction(ModelFormulas(model, inputs), cyclic).reduced()


def require_cyclic(model: Model, found: FirstIntegrals, names: Sequence[str]) -> list[int]:
    """Indices of cyclic coordinates. Raises InvalidArgument for others, and for none."""
    if not names:
        raise InvalidArgument.at("/coordinates", "no-cyclic-coordinate", "the model has no cyclic coordinate")
    for i, name in enumerate(names):
        if name not in found.cyclic:
            known = ", ".join(found.cyclic) or "none"
            message = f"'{str(name)[:80]}' is not a cyclic coordinate; cyclic are: {known}"
            raise InvalidArgument.at(f"/coordinates/{i}", "not-cyclic", message)
    return [model.coordinates.index(name) for name in names]


class _Reduction:
    """P, w and what is formed with them."""

    def __init__(self, f: ModelFormulas, cyclic: Sequence[int]) -> None:
        self.f, self.cyclic = f, list(cyclic)
        self.zero = f.graph.zero
        names = f.model.coordinates
        self.rest = [a for a in range(f.n) if a not in cyclic]
        self.p = [f.graph.symbol(f"p.{names[c]}") for c in self.cyclic]
        self.units = ["kg m^2/s" if f.model.joints[c] == "R" else "kg m/s" for c in self.cyclic]
        self.g = f.elements("metric")
        pairs = [(i, j, (a, b)) for i, a in enumerate(cyclic) for j, b in enumerate(cyclic)]
        block: Entries = {(i, j): self.g[ab] for i, j, ab in pairs if ab in self.g}
        factors = MetricElimination(block, [names[c] for c in cyclic])
        # columns of P = (1, K) by coordinate of the model, and w = (0, g_cc^-1 p)
        self.P = [self._column(factors, r) for r in self.rest]
        self.w = dict(zip(self.cyclic, factors.solve(self.p), strict=True))

    def _column(self, factors: MetricElimination, r: int) -> dict[int, Expr]:
        # K = -g_cc^-1 g_cr
        coupling = [-self.g.get((c, r), self.zero) for c in self.cyclic]
        column = dict(zip(self.cyclic, factors.solve(coupling), strict=True))
        return {r: self.f.graph.one} | {c: x for c, x in column.items() if not x.is_zero}

    def reduced(self) -> Reduced:
        """All outputs."""
        f, n, m = self.f, len(self.rest), len(self.cyclic)
        h = [[self._metric(a, b) for b in range(n)] for a in range(n)]
        # Gamma_ijk P_ia P_jb, then B_ab with w_k and Gamma^h_abc with P_kc
        gamma = {(a, b): self._pushed(self.P[a], self.P[b]) for a in range(n) for b in range(n)}
        gyroscopic: Entries = {(a, b): 2 * self._sum(x, self.w) for (a, b), x in gamma.items()}
        christoffel: Entries = {(a, b, c): self._sum(x, self.P[c]) for (a, b), x in gamma.items() for c in range(n)}
        applied = f.vector("forces")
        # f_a = Q_a - P_ia w_j w_k Gamma_ijk (Q_i has no part at the cyclic coordinates)
        forces = [applied[r] - self._sum(self._pushed(self.P[a], self.w), self.w) for a, r in enumerate(self.rest)]
        # V_p = V + 1/2 p^T g_cc^-1 p
        amended = f.scalar("potential_energy") + self._momentum_product() / 2
        outputs = {
            "metric": Formulas((n, n), {(a, b): h[a][b] for a in range(n) for b in range(a, n)}, "symmetric"),
            "christoffel": Formulas((n, n, n), christoffel),
            "gyroscopic": Formulas((n, n), gyroscopic),
            "forces": array((n,), lambda a: forces[a]),
            "amended_potential": Formulas((), {(): amended}),
            "routhian": Formulas((), {(): self._routhian(h) - amended}),
            "cyclic_velocities": array((m,), lambda i: self._cyclic_velocity(self.cyclic[i])),
        }
        names = f.model.coordinates
        momenta = {str(p.value): Symbol(str(p.value), "parameter", u) for p, u in zip(self.p, self.units, strict=True)}
        rest, cyclic = (tuple(names[a] for a in some) for some in (self.rest, self.cyclic))
        result = program(f.graph, outputs, f.symbols | momenta)
        more = dict.fromkeys(momenta, "parameter")
        needs = (*DYNAMICS, "christoffel")
        result = certified(result, f.model, reduced(cyclic, rest), "routhian", needs=needs, zero=f.zero, more=more)
        return Reduced(result, rest, cyclic, tuple(momenta))

    def _metric(self, a: int, b: int) -> Expr:
        """h_ab = g_ij P_ia P_jb, where only j = the remaining coordinate of b is needed: P^T g is 0 at the others."""
        r = self.rest[b]
        return self.f.graph.sum(self.g[i, r] * x for i, x in self.P[a].items() if (i, r) in self.g)

    def _pushed(self, x: dict[int, Expr], y: dict[int, Expr]) -> dict[int, Expr]:
        """Gamma_ijk x_i y_j, by k."""
        result: dict[int, Expr] = {}
        for (i, j, k), gamma in self.f.elements("christoffel").items():
            if i in x and j in y:
                result[k] = result.get(k, self.zero) + gamma * x[i] * y[j]
        return result

    def _sum(self, x: dict[int, Expr], y: dict[int, Expr]) -> Expr:
        return self.f.graph.sum(x[k] * y[k] for k in x.keys() & y.keys())

    def _momentum_product(self) -> Expr:
        """p^T g_cc^-1 p."""
        return self.f.graph.sum(p * self.w[c] for p, c in zip(self.p, self.cyclic, strict=True))

    def _cyclic_velocity(self, c: int) -> Expr:
        """q'_c = K q'_r + g_cc^-1 p."""
        pairs = zip(self.rest, self.P, strict=True)
        return self.w[c] + self.f.graph.sum(x[c] * self.f.rates[r] for r, x in pairs if c in x)

    def _routhian(self, h: Sequence[Sequence[Expr]]) -> Expr:
        """1/2 q'_r^T h q'_r + p^T g_cc^-1 g_cr q'_r."""
        v = [self.f.rates[r] for r in self.rest]
        # p^T g_cc^-1 g_cr q'_r = w_c g_cr q'_r
        kinetic = self.f.graph.sum(h[a][b] * v[a] * v[b] for a in range(len(v)) for b in range(len(v))) / 2
        pairs = [(c, r, x) for c in self.cyclic for r, x in zip(self.rest, v, strict=True) if (c, r) in self.g]
        return kinetic + self.f.graph.sum(self.w[c] * self.g[c, r] * x for c, r, x in pairs)
