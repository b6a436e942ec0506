"""What is to be written: sums of products of powers of atoms, cosines and sines, and sums."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction

from substructures.expr.graph import Expr, Graph
from substructures.expr.trigonometry import cos, sin


@dataclass(frozen=True, slots=True)
class Trig:
    """``cos`` or ``sin`` of a sum of multiples of angles."""

    op: str
    angle: tuple[tuple[Expr, Fraction], ...]


@dataclass(frozen=True, slots=True)
class Term:
    """coefficient * product of factor**power, in the order in which they are written; powers may be negative."""

    coefficient: Fraction
    factors: tuple[tuple[Factor, int], ...] = ()

    def scaled(self, c: Fraction) -> Term:
        """The term times a number."""
        return Term(self.coefficient * c, self.factors)


@dataclass(frozen=True, slots=True)
class Sum:
    """A sum of terms in the order in which they are written; without terms it is zero."""

    terms: tuple[Term, ...]

    def __len__(self) -> int:
        """How many factors and numbers are written."""
        return sum(1 + sum(len(f) if isinstance(f, Sum) else 1 for f, _ in t.factors) for t in self.terms)


Factor = Expr | Trig | Sum


def leaves(form: Sum) -> Iterator[Expr | Trig]:
    """Every occurrence of an atom, cosine or sine."""
    for term in form.terms:
        for factor, _ in term.factors:
            if isinstance(factor, Sum):
                yield from leaves(factor)
            else:
                yield factor


def numbers(form: Sum) -> Iterator[Fraction]:
    """The coefficients of all terms."""
    for term in form.terms:
        yield term.coefficient
        for factor, _ in term.factors:
            if isinstance(factor, Sum):
                yield from numbers(factor)


def atoms_of(forms: Iterable[Sum]) -> list[Expr]:
    """The atoms of forms, those inside of cosines and sines included, each once."""
    found: dict[Expr, None] = {}
    for form in forms:
        for leaf in leaves(form):
            found.update(dict.fromkeys([a for a, _ in leaf.angle] if isinstance(leaf, Trig) else [leaf]))
    return list(found)


def product(coefficient: Fraction, factors: Iterable[tuple[Factor, int]]) -> Term:
    """A product; sums of one term are multiplied out into it, and equal factors are one power."""
    powers: dict[Factor, int] = {}
    for factor, n in factors:
        if isinstance(factor, Sum) and len(factor.terms) == 1:
            (only,) = factor.terms
            coefficient *= only.coefficient**n
            inner = [(f, n * m) for f, m in only.factors]
        else:
            inner = [(factor, n)]
        for f, m in inner:
            powers[f] = powers.get(f, 0) + m
    return Term(coefficient, tuple((f, n) for f, n in powers.items() if n))


def to_expr(form: Sum, graph: Graph, atoms: dict[Expr, Expr]) -> Expr:
    """The form as expression of a graph; ``atoms`` are its atoms there."""
    return graph.sum(_term_expr(term, graph, atoms) for term in form.terms)


def _term_expr(term: Term, graph: Graph, atoms: dict[Expr, Expr]) -> Expr:
    result = graph.number(term.coefficient)
    for factor, n in term.factors:
        if isinstance(factor, Sum):
            value = to_expr(factor, graph, atoms)
        elif isinstance(factor, Trig):
            angle = graph.sum(atoms[a] * graph.number(c) for a, c in factor.angle)
            value = cos(angle) if factor.op == "cos" else sin(angle)
        else:
            value = atoms[factor]
        result = result * value**n if n > 0 else result / value**-n
    return result
