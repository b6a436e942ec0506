"""The canonical expanded form (notation.md, section 8.5), and the exact zero test.

A formula becomes a sum of terms: number * powers of symbols * cos or sin of a combination of angles (products of
trigonometric functions are turned into sums), over a denominator where there is one. Classes of formulas:

* Polynomials (also with negative powers, and divided by polynomials) in symbols, square roots of positive rationals,
  and cos, sin, tan of rational combinations of angles and of multiples of pi/12: the form is unique and the zero test
  exact. An angle may be any such formula without denominator, not only a symbol.
* Denominators that contain angles, or roots in sums: the zero test is exact, the form need not be unique. Nothing is
  multiplied by that can vanish where the formula has a value.
* Other functions (exp, atan2, abs, other roots, cos(pi/7), ...) are taken as independent quantities, equal when their
  arguments are: a zero that is found is one; one that rests on an identity of these functions is not found.

>>> from substructures.expr.trigonometry import cos, sin
>>> graph = Graph()
>>> x, q = graph.symbol("x"), graph.symbol("q")
>>> [str(t.coefficient) + t.trig for t in expand((x + cos(q)) * (x - cos(q))).terms]
['-1/2', '-1/2cos', '1']
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from substructures.errors import TooLarge
from substructures.expr.graph import Expr, Graph
from substructures.expr.rings.canonical import RingEvaluator
from substructures.expr.rings.generators import Basis, Generators, is_function, times_power
from substructures.expr.trigonometry import cos, sin
from substructures.expr.walk import reachable, transfer

#: terms of one formula
LIMIT = 10_000
#: sum of the squared numbers of generators over all arguments of functions
EFFORT = 1_000_000


@dataclass(frozen=True, slots=True)
class Term:
    """coefficient * product of generator**power * cos or sin (or neither: "") of the sum of multiples of angles."""

    coefficient: Fraction
    powers: tuple[tuple[Expr, int], ...]
    trig: str = ""
    angle: tuple[tuple[Expr, Fraction], ...] = ()

    def atoms(self) -> Iterable[Expr]:
        """The generators and angles that occur."""
        for expr, _ in (*self.powers, *self.angle):
            yield expr


@dataclass(frozen=True, slots=True)
class Expanded:
    """Sum of ``terms`` over the sum of ``denominator`` (empty: 1), in a readable order: by degree, then by name."""

    terms: tuple[Term, ...]
    denominator: tuple[Term, ...] = ()

    @property
    def is_zero(self) -> bool:
        """True for the zero function."""
        return not self.terms

    def __len__(self) -> int:
        return len(self.terms) + len(self.denominator)

    def to_expr(self, graph: Graph) -> Expr:
        """The form as expression. In the graph it came from that is the node it came from; give a new graph."""
        atoms = list(dict.fromkeys(a for t in (*self.terms, *self.denominator) for a in t.atoms()))
        new = dict(zip(atoms, transfer(atoms, graph, {}), strict=True))
        numerator = graph.sum(_term_expr(t, graph, new) for t in self.terms)
        if not self.denominator:
            return numerator
        return numerator / graph.sum(_term_expr(t, graph, new) for t in self.denominator)


def _term_expr(term: Term, graph: Graph, new: dict[Expr, Expr]) -> Expr:
    result = graph.one
    for expr, power in term.powers:
        result = times_power(result, new[expr], power)
    if term.trig:
        angle = graph.sum(new[a] * graph.number(c) for a, c in term.angle)
        result = result * (cos if term.trig == "cos" else sin)(angle)
    return graph.number(term.coefficient) * result


def classified(exprs: Sequence[Expr], limit: int = LIMIT) -> Generators:
    """The generators of expressions, functions recognised by the canonical form of their arguments. Raises TooLarge."""
    generators, effort = Generators(), 0
    for node in reachable(exprs):
        if is_function(node):
            arguments = []
            for arg in node.args:
                evaluator = RingEvaluator(generators, reachable([arg], is_function), limit)
                effort += (evaluator.ring.size + evaluator.ring.angles) ** 2
                if effort > EFFORT:
                    raise TooLarge("the nesting of functions in an expansion (in squared generators)", effort, EFFORT)
                arguments.append(evaluator.read(arg))
            generators.classify(node, arguments)
    return generators


class Expander:
    """Expands several formulas of one graph that share subexpressions.

    ``limit`` bounds the terms of every formula and, times 100, all work together. The constructor and
    :meth:`expand` raise TooLarge with size and limit before anything larger is formed, and ZeroDivisionError. Nodes
    that are too large, with which whatever needs them is, are added to ``large``.
    """

    def __init__(self, exprs: Sequence[Expr], limit: int = LIMIT, large: set[Expr] | None = None) -> None:
        self.limit = limit
        self.generators = classified(exprs, limit)
        self.evaluator = RingEvaluator(self.generators, reachable(exprs, is_function), limit, large)

    def expand(self, expr: Expr) -> Expanded:
        """The canonical form of one of the expressions (or of a subexpression)."""
        form = self.evaluator.read(expr)
        return Expanded(
            tuple(self._term(b, c) for b, c in form.terms), tuple(self._term(b, c) for b, c in form.denominator)
        )

    def size(self, expr: Expr) -> int:
        """A lower bound for the terms and factors of the form of an expression, known without reading it."""
        value = self.evaluator.values[expr]
        return len(value.n.poly) + len(value.d.poly) - 1

    def _term(self, basis: Basis, coefficient: Fraction) -> Term:
        atoms = self.generators.atoms
        powers = tuple((atoms[i], n) for i, n in basis.monomial)
        return Term(coefficient, powers, basis.trig, tuple((atoms[i], c) for i, c in basis.angle))


def expand(expr: Expr, limit: int = LIMIT, large: set[Expr] | None = None) -> Expanded:
    """The canonical form; ``large``: see Expander. Raises TooLarge (size, limit) with more than ``limit`` terms or too
    much work.
    """
    return Expander([expr], limit, large).expand(expr)


def is_zero(expr: Expr, limit: int = LIMIT) -> bool:
    """Whether an expression is identically zero, decided exactly (see above for which formulas). Raises TooLarge."""
    return expand(expr, limit).is_zero
