"""Potentials of forces by integration of the canonical form (notation.md, section 7).

Polynomials and trigonometric polynomials in the coordinates are integrated, with whatever does not depend on them as
coefficients. A potential is handed out only when its derivatives are the forces exactly, by the zero test of
:mod:`substructures.expr.rings.expand`, so that there is none whose gradient is something else.

>>> graph = Graph()
>>> k, x, y = (graph.symbol(name) for name in "kxy")
>>> potential([-k * (x - y), k * (x - y)], ["x", "y"]) is k * (x - y) ** 2 / 2
True
>>> potential([y, -x], ["x", "y"]) is None
True
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from collections.abc import Set as AbstractSet

from substructures.errors import TooLarge
from substructures.expr.differentiate import derivative
from substructures.expr.graph import Expr, Graph
from substructures.expr.rings.expand import Expanded, Term, expand, is_zero
from substructures.expr.rings.generators import times_power
from substructures.expr.trigonometry import cos, sin
from substructures.expr.walk import reachable, transfer

#: terms of a force that is integrated
LIMIT = 2_000


def symbols_of(exprs: Iterable[Expr]) -> frozenset[str]:
    """The names of all symbols that occur."""
    return frozenset(str(node.value) for node in reachable(exprs) if node.op == "sym")


def potential(forces: Sequence[Expr], names: Sequence[str], limit: int = LIMIT) -> Expr | None:
    """V with dV/dx_a = -F_a for all coordinates x_a = ``names[a]``; None where there is none, or none is found.

    V = 0 where all terms with a coordinate are; what is not found are potentials beyond polynomials and trigonometric
    polynomials in the coordinates, and those of more than ``limit`` terms.
    """
    if not forces:
        return None
    result = forces[0].graph.zero
    try:
        for force, name in zip(forces, names, strict=True):
            # V += -integral of (F_a + d_a V) dx_a, which is a function of x_a and of the coordinates that follow
            part = antiderivative(force + derivative(result, name), name, limit)
            if part is None:
                return None
            result = result - part
        gaps = (force + derivative(result, name) for force, name in zip(forces, names, strict=True))
        return result if all(is_zero(gap, limit) for gap in gaps) else None
    except (TooLarge, ZeroDivisionError):
        return None


def from_zero(energy: Expr, names: Iterable[str]) -> Expr:
    """V less its value where all coordinates are 0; as it is where it has none there."""
    graph = energy.graph
    try:
        (start,) = transfer([energy], graph, dict.fromkeys(names, graph.zero))
    except ZeroDivisionError:
        return energy
    return energy - start


def antiderivative(expr: Expr, name: str, limit: int = LIMIT) -> Expr | None:
    """The integral by one symbol, from 0 where it is a polynomial; None where a term is no polynomial in the symbol and
    in cosines and sines of its multiples. Raises TooLarge for more than ``limit`` terms.
    """
    form, graph, x = expand(expr, limit), expr.graph, expr.graph.symbol(name)
    if name in symbols_of(_atoms(form.denominator)):
        return None
    parts = [_integral(term, x) for term in form.terms]
    found = [part for part in parts if part is not None]
    return _over(form, graph, found) if len(found) == len(parts) else None


def filtered(expr: Expr, names: AbstractSet[str], limit: int = LIMIT) -> Expr | None:
    """The terms of the canonical form that contain none but these symbols; None when its denominator contains others,
    or when it has more than ``limit`` terms.
    """
    try:
        form = expand(expr, limit)
    except (TooLarge, ZeroDivisionError):
        return None
    if not symbols_of(_atoms(form.denominator)) <= names:
        return None
    kept = [_expr(t, expr.graph) for t in form.terms if symbols_of(t.atoms()) <= names]
    return expr if len(kept) == len(form.terms) else _over(form, expr.graph, kept)


def needed(expr: Expr, limit: int = LIMIT) -> frozenset[str]:
    """The symbols in the canonical form; all that occur, where it has more than ``limit`` terms."""
    try:
        form = expand(expr, limit)
    except (TooLarge, ZeroDivisionError):
        return symbols_of([expr])
    return symbols_of(_atoms((*form.terms, *form.denominator)))


def _atoms(terms: Iterable[Term]) -> list[Expr]:
    return [atom for term in terms for atom in term.atoms()]


def _over(form: Expanded, graph: Graph, terms: Iterable[Expr]) -> Expr:
    """The terms over the denominator of a form."""
    total = graph.sum(terms)
    return total / graph.sum(_expr(t, graph) for t in form.denominator) if form.denominator else total


def _expr(term: Term, graph: Graph) -> Expr:
    """A term as expression of the graph that it came from."""
    result = graph.number(term.coefficient)
    for atom, power in term.powers:
        result = times_power(result, atom, power)
    if term.trig:
        result = result * (cos if term.trig == "cos" else sin)(_angle(term, graph))
    return result


def _angle(term: Term, graph: Graph) -> Expr:
    return graph.sum(atom * graph.number(c) for atom, c in term.angle)


def _integral(term: Term, x: Expr) -> Expr | None:
    """Of c x^n, c x^n cos(k x + r) or c x^n sin(k x + r); None for anything else."""
    graph, name = x.graph, str(x.value)
    powers, angle = dict(term.powers), dict(term.angle)
    n, k = powers.pop(x, 0), angle.pop(x, None)
    # an atom that is no symbol, as sqrt(1 + x^2) or x y in an angle, and contains x
    if name in symbols_of([*powers, *angle]):
        return None
    rest = _expr(Term(term.coefficient, tuple(powers.items())), graph)
    if k is None:
        if n == -1:
            return None
        outer = (cos if term.trig == "cos" else sin)(_angle(term, graph)) if term.trig else graph.one
        return times_power(rest, x, n + 1) * outer / graph.number(n + 1)
    if n < 0:
        return None
    at, step = _angle(term, graph), graph.number(k)
    result, factor, op = graph.zero, rest, term.trig
    # by parts: int x^n cos = (x^n sin - n int x^(n-1) sin)/k, int x^n sin = (-x^n cos + n int x^(n-1) cos)/k
    for power in range(n, -1, -1):
        sign = 1 if op == "cos" else -1
        outer = (sin if op == "cos" else cos)(at)
        factor = factor * sign / step
        result = result + times_power(factor, x, power) * outer
        factor, op = -factor * power, "sin" if op == "cos" else "cos"
    return result
