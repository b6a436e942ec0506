"""The curvature of the configuration space with the metric g (notation.md, section 7).

With the Christoffel symbols of the first kind Gamma_abc = 1/2 (d_b g_ac + d_c g_ab - d_a g_bc)

    R_abcd = d_c Gamma_abd - d_d Gamma_abc + g^ef (Gamma_ead Gamma_fbc - Gamma_eac Gamma_fbd)
    R_bd = g^ac R_abcd          S = g^bd R_bd

This is R^a_bcd = d_c Gamma^a_bd - d_d Gamma^a_bc + Gamma^a_ce Gamma^e_bd - Gamma^a_de Gamma^e_bc with the first index
lowered: the signs of C. W. Misner, K. S. Thorne and J. A. Wheeler, Gravitation, 1973, section 8.7, by which a sphere of
radius r has R_abcd = (g_ac g_bd - g_ad g_bc)/r^2 and S > 0. The Gaussian curvature of two degrees of freedom is
R_0101/det g = S/2. Free motion spreads where sectional curvatures are negative (Jacobi's equation).

Of the n^4 elements n^2 (n^2 - 1)/12 are independent, and only these are formed:

    R_abcd = -R_bacd = -R_abdc = R_cdab                 R_abcd + R_acdb + R_adbc = 0 (first Bianchi identity)
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, combinations_with_replacement
from typing import Any, Literal

import numpy as np

from substructures.analysis.given import StateArray
from substructures.array import Array
from substructures.certificate.derived.perturbed import curved
from substructures.errors import InvalidDocument, TooLarge
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr
from substructures.expr.program import Entries, Formulas, Program, array, program
from substructures.part.part import MAX_NODES
from substructures.quantities.accelerations import Evaluator
from substructures.quantities.certificate import certified
from substructures.quantities.numbers.evaluation import interpreted
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.quantities.numbers.workspace import Workspace
from substructures.tree.cuts import require_open
from substructures.tree.document import require_ungiven
from substructures.tree.model import Model

OUTPUTS = ("riemann", "ricci", "scalar_curvature", "inverse_metric", "christoffel_second")
ADVICE = "the metric is singular in this state, or its inverse is too large: check masses and coordinates"

Quadruple = tuple[int, int, int, int]


@dataclass(frozen=True)
class StateFailure:
    """A state (its number) without a finite result, and what to do about it."""

    state: int
    code: Literal["not-finite"]
    message: str


@dataclass(frozen=True, repr=False)
class CurvatureValues:
    """``riemann`` (N, n, n, n, n): R_abcd; ``ricci`` (N, n, n): R_bd; ``scalar_curvature`` (N,): S; ``inverse_metric``
    (N, n, n): g^ab; ``christoffel_second`` (N, n, n, n): Gamma^a_bc. The axis N is missing where one ``q`` (n,) was
    given. ``failures``: states in which the metric is singular.
    """

    riemann: Array
    ricci: Array
    scalar_curvature: Array
    inverse_metric: Array
    christoffel_second: Array
    failures: tuple[StateFailure, ...] = ()

    def __repr__(self) -> str:
        S = np.atleast_1d(self.scalar_curvature)
        finite = S[np.isfinite(S)]
        within = f"from {finite.min():.6g} to {finite.max():.6g}" if len(finite) else "nowhere finite"
        sizes = f"n={self.ricci.shape[-1]}, states={len(S)}, failures={len(self.failures)}"
        return f"CurvatureValues({sizes})\nscalar curvature {within}"


def curvature(model: Model, max_nodes: int = MAX_NODES) -> Program:
    """Formulas of the curvature, one program with five outputs.

    ``riemann`` (n, n, n, n): R_abcd; ``ricci`` (n, n): R_bd; ``scalar_curvature`` (); ``inverse_metric`` (n, n):
    g^ab, by L D L^T without square roots; ``christoffel_second`` (n, n, n): Gamma^a_bc. Raises InvalidDocument for a
    metric that is singular for all values of its symbols and for closures (the space of a mechanism with loops is
    curved in its own way within that of its coordinates), TooLarge (size, limit) for more than ``max_nodes`` nodes.
    """
    require_open(model.closures, "describe the mechanism in independent coordinates")
    require_ungiven(model, "take the tree without 'driven'")
    space = _Space(model, max_nodes)
    try:
        outputs = space.outputs()
    except ZeroDivisionError:
        message = "the metric is singular: a coordinate moves no mass, so there is no curvature"
        raise InvalidDocument.at("", "singular-metric", message) from None
    result = program(space.graph, outputs, {s.name: s for s in model.program.symbols})
    return certified(result, model, curved, "curvature", needs=("metric", "christoffel"))


def curvature_values(
    model: Model,
    q: StateArray,
    *,
    parameters: Mapping[str, Any] | None = None,
    limit: int | None = None,
    engine: Evaluator = interpreted,
    formulas: Program | None = None,
) -> CurvatureValues:
    """The curvature of the configuration space in numbers: R_abcd, R_bd, S, g^ab, Gamma^a_bc (see above).

    ``q`` (n,) or (N, n), or by coordinate [rad, m]; ``parameters`` in place of their defaults: one number, or (N,);
    ``limit``: so many states at most. ``engine`` evaluates programs; ``formulas``: the program of curvature(model), so
    that many calls derive it once. Raises InvalidInput (``/q``, ``/parameters/name``; the model's closures),
    MissingValue and TooLarge.
    """
    given = {"q": q, "parameters": parameters or {}}
    states = read_states(model, given, limit)
    values = symbol_values(model, given, states, ("metric",))
    found = engine(curvature(model) if formulas is None else formulas, values, list(OUTPUTS), states.count)
    # g^ab is not finite where det g = 0, and R, S with it
    good = np.all([np.isfinite(x).all(axis=tuple(range(1, x.ndim))) for x in found.values()], axis=0)
    failures = tuple(StateFailure(int(i), "not-finite", ADVICE) for i in np.flatnonzero(~good))
    riemann, ricci, scalar, inverse, second = (found[name][0] if states.single else found[name] for name in OUTPUTS)
    return CurvatureValues(riemann, ricci, scalar, inverse, second, failures)


def independent_elements(n: int) -> list[Quadruple]:
    """Indices (a, b, c, d) of the independent elements: a < b, c < d, (a, b) <= (c, d), without a < c < d < b.

    >>> [len(independent_elements(n)) for n in range(5)]
    [0, 0, 1, 6, 20]
    """
    planes = combinations_with_replacement(combinations(range(n), 2), 2)
    return [(a, b, c, d) for (a, b), (c, d) in planes if not a < c < d < b]


class _Space:
    """g, Gamma and their derivatives in a new graph."""

    def __init__(self, model: Model, max_nodes: int) -> None:
        workspace = Workspace(model)
        self.n, self.graph, self.max_nodes = model.dof, workspace.graph, max_nodes
        self.coordinates = model.coordinates
        found = workspace.outputs(["metric", "christoffel"])
        self.metric, self.first = found["metric"], found["christoffel"]
        self.slopes = self._slopes()

    def _slopes(self) -> list[Entries]:
        """[d][a, b, c] = d_d Gamma_abc, each different formula differentiated once."""
        different = list(dict.fromkeys(x for index, x in self.first.items()))
        rows = dict(zip(different, gradient(different, self.coordinates), strict=True))
        return [{index: rows[x][d] for index, x in self.first.items()} for d in range(self.n)]

    def outputs(self) -> dict[str, Formulas]:
        """The five outputs. Raises ZeroDivisionError for a singular metric."""
        n, zero = self.n, self.graph.zero
        inverse = self._inverse()
        # Gamma^a_bc = g^ae Gamma_ebc = Gamma^a_cb
        second: Entries = {
            (a, b, c): self._dot([inverse[a][e] for e in range(n)], [self.first.get((e, b, c), zero) for e in range(n)])
            for a in range(n)
            for b in range(n)
            for c in range(b, n)
        }
        second |= {(a, c, b): x for (a, b, c), x in second.items()}
        riemann = self._riemann(second)
        ricci: Entries = {}
        for b, d in combinations_with_replacement(range(n), 2):
            # R_bd = g^ac R_abcd
            terms = (inverse[a][c] * riemann.get((a, b, c, d), zero) for a in range(n) for c in range(n))
            ricci[b, d] = self.graph.sum(terms)
            self._check()
        # S = g^bd R_bd, elements off the diagonal twice
        twice = (inverse[b][d] * x * (1 if b == d else 2) for (b, d), x in ricci.items())
        return {
            "riemann": Formulas((n,) * 4, riemann),
            "ricci": Formulas((n, n), ricci, "symmetric"),
            "scalar_curvature": Formulas((), {(): self.graph.sum(twice)}),
            "inverse_metric": Formulas(
                (n, n), {(a, b): inverse[a][b] for a in range(n) for b in range(a, n)}, "symmetric"
            ),
            "christoffel_second": array((n, n, n), lambda a, b, c: second[a, b, c]),
        }

    def _inverse(self) -> list[list[Expr]]:
        """g^ab = sum_e M_ea M_eb / D_e with M = L^-1, g = L D L^T."""
        n, zero, one = self.n, self.graph.zero, self.graph.one
        g = [[self.metric.get((a, b), zero) for b in range(n)] for a in range(n)]
        M = [[one if a == b else zero for b in range(n)] for a in range(n)]
        for e in range(n):
            # rows of g become D L^T, those of 1 become M
            for a in range(e + 1, n):
                factor = g[a][e] / g[e][e]
                g[a] = [x - factor * y for x, y in zip(g[a], g[e], strict=True)]
                M[a] = [x - factor * y for x, y in zip(M[a], M[e], strict=True)]
        scaled = [[x / g[e][e] for x in M[e]] for e in range(n)]
        result = [[zero] * n for _ in range(n)]
        for a, b in combinations_with_replacement(range(n), 2):
            result[a][b] = result[b][a] = self._dot([row[a] for row in scaled], [row[b] for row in M])
        return result

    def _riemann(self, second: Entries) -> Entries:
        result: Entries = {}
        for a, b, c, d in independent_elements(self.n):
            result |= _images((a, b, c, d), self._element(a, b, c, d, second))
            self._check()
        for a, b, c, d in combinations(range(self.n), 4):
            # R_adbc = R_acbd - R_abcd (first Bianchi identity)
            last = result[a, c, b, d] - result[a, b, c, d]
            result |= _images((a, d, b, c), last)
        return result

    def _element(self, a: int, b: int, c: int, d: int, second: Entries) -> Expr:
        """R_abcd by the equation above."""
        zero, n = self.graph.zero, range(self.n)
        # d_c Gamma_abd - d_d Gamma_abc + Gamma^f_ad Gamma_fbc - Gamma^f_ac Gamma_fbd
        slope = self.slopes[c].get((a, b, d), zero) - self.slopes[d].get((a, b, c), zero)
        plus = self._dot([second[e, a, d] for e in n], [self.first.get((e, b, c), zero) for e in n])
        minus = self._dot([second[e, a, c] for e in n], [self.first.get((e, b, d), zero) for e in n])
        return slope + (plus - minus)

    def _dot(self, x: Sequence[Expr], y: Sequence[Expr]) -> Expr:
        return self.graph.sum(p * q for p, q in zip(x, y, strict=True) if not (p.is_zero or q.is_zero))

    def _check(self) -> None:
        if len(self.graph) > self.max_nodes:
            raise TooLarge("the curvature (in nodes)", len(self.graph), self.max_nodes)


def _images(index: Quadruple, x: Expr) -> Iterator[tuple[tuple[int, ...], Expr]]:
    """The elements that follow from R_abcd by its symmetries."""
    a, b, c, d = index
    for p, q, r, s in ((a, b, c, d), (c, d, a, b)):
        yield (p, q, r, s), x
        yield (q, p, s, r), x
        yield (q, p, r, s), -x
        yield (p, q, s, r), -x
