"""The last touch of a form: factors that all terms share stand before parentheses, which begin without a minus.

``Izz6*c23*c5 - Izz6*s23*c4*s5`` is ``Izz6*(c23*c5 - s23*c4*s5)``. What does not move is left in the terms where the sum
would be no shorter, ``m2*l2^2 + m2*l1*l2*cos(q2)``, or where parentheses would stand in parentheses.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction

from substructures.expr.graph import Expr
from substructures.textbook.atoms import MOVING, Atoms
from substructures.textbook.collect import opened
from substructures.textbook.divisors import common_number
from substructures.textbook.forms import Factor, Sum, Term, Trig, leaves, product

#: terms of a sum that is looked at as a whole
SHORT = 5
Powers = Sequence[tuple[Factor, int]]


class Tidy:
    """Tidies forms in the same atoms."""

    def __init__(self, atoms: Atoms) -> None:
        self.atoms = atoms

    def __call__(self, form: Sum) -> Sum:
        """The form with common factors taken out of all of its sums."""
        inner = Sum(tuple(map(self._term, form.terms)))
        whole = self._taken_out(inner)
        return inner if whole is None else Sum((whole,))

    def _term(self, term: Term) -> Term:
        """A product of tidy sums, none of which begins with a minus."""
        coefficient, factors = term.coefficient, list[tuple[Factor, int]]()
        for factor, n in term.factors:
            if isinstance(factor, Sum):
                sign, factor = self._begun(self(factor))
                coefficient *= sign ** (n % 2)
            factors.append((factor, n))
        found = product(coefficient, factors)
        return Term(found.coefficient, tuple(self._in_order(found.factors)))

    def _begun(self, form: Sum) -> tuple[int, Sum]:
        """A sign, and a sum that begins without a minus: with a force that acts, or with all signs changed."""
        form = self._momenta_first(form)
        if form.terms[0].coefficient > 0:
            return 1, form
        acting = next((t for t in form.terms if t.coefficient > 0 and self.atoms.acts(leaves(Sum((t,))))), None)
        if acting is not None:
            return 1, Sum((acting, *(t for t in form.terms if t is not acting)))
        return -1, Sum(tuple(t.scaled(Fraction(-1)) for t in form.terms))

    def _momenta_first(self, form: Sum) -> Sum:
        """p_psi - p_phi*cos(theta): momenta alone before those with cosines and sines."""
        found = [list(leaves(Sum((t,)))) for t in form.terms]
        if not all(any(isinstance(x, Expr) and self.atoms.is_momentum(x) for x in some) for some in found):
            return form
        turned = [any(isinstance(x, Trig) for x in some) for some in found]
        return Sum(tuple(t for _, t in sorted(zip(turned, form.terms, strict=True), key=lambda item: item[0])))

    def _in_order(self, factors: Powers) -> Powers:
        """Constants, places, momenta, cosines and sines, sums with these, rates."""
        return sorted(factors, key=lambda item: self._key(item[0]))

    def _key(self, factor: Factor) -> int:
        found = [factor] if not isinstance(factor, Sum) else list(leaves(factor))
        atoms = [x for x in found if isinstance(x, Expr)]
        if any(map(self._is_rate, atoms)):
            is_early = len(atoms) == len(found) and not any(map(self._is_velocity, atoms))
            return 0 if is_early else 3
        if len(atoms) == len(found):
            return 0
        return 2 if isinstance(factor, Sum) else 1

    def _is_velocity(self, atom: Expr) -> bool:
        return self.atoms.is_rate(atom) and not self.atoms.is_momentum(atom)

    def _taken_out(self, form: Sum) -> Term | None:
        """The sum as a product, where that is better."""
        if not 2 <= len(form.terms) <= SHORT:
            return None
        common = {f: n for f, n in form.terms[0].factors if n > 0}
        for here in (dict(t.factors) for t in form.terms[1:]):
            common = {f: min(n, here[f]) for f, n in common.items() if here.get(f, 0) > 0}
        if not common:
            return None
        number = _number([t.coefficient for t in form.terms])
        rest = [Term(t.coefficient / number, _over(t.factors, common)) for t in form.terms]
        inner = Sum(tuple(x for t in rest for x in opened(t)))
        whole = Term(number, tuple(self._in_order([*common.items(), (inner, 1)])))
        return whole if self._is_better(whole, form, rest, common) else None

    def _is_better(self, whole: Term, form: Sum, rest: Sequence[Term], common: Iterable[Factor]) -> bool:
        if any(self._moves(f) for t in rest for f, _ in t.factors if f in common):
            return False
        is_flat = not any(isinstance(f, Sum) for t in form.terms for f, _ in t.factors)
        if all(self._moves(f) for t in rest for f, _ in t.factors):
            return True
        if any(map(self._is_rate, leaves(Sum(tuple(rest))))):
            return False
        return any(map(self._moves, common)) or (is_flat and len(Sum((whole,))) < len(form))

    def _is_rate(self, leaf: Expr | Trig) -> bool:
        return isinstance(leaf, Expr) and self.atoms.is_rate(leaf)

    def _moves(self, factor: Factor) -> bool:
        if isinstance(factor, Sum):
            return any(map(self._moves, leaves(factor)))
        return isinstance(factor, Trig) or self.atoms.ranks[self.atoms.place[factor]] == MOVING


def _number(coefficients: Sequence[Fraction]) -> Fraction:
    """What they have in common, with the sign of the first one; 1/2 and 1/3 stay as they are."""
    is_alike = len({c.denominator for c in coefficients}) == 1
    return (common_number(coefficients) if is_alike else 1) * Fraction(-1 if coefficients[0] < 0 else 1)


def _over(factors: Powers, common: Mapping[Factor, int]) -> tuple[tuple[Factor, int], ...]:
    """A product over some of its powers."""
    return tuple((f, n - common.get(f, 0)) for f, n in factors if n != common.get(f, 0))
