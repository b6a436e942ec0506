"""From the unique sum of terms of a formula to its textbook form.

The formula is a sum of monomials of parameters times functions of what moves. Each of these functions is brought to
its shortest form by itself, so that another parameter changes nothing but the terms that it occurs in. Terms are then
gathered either by functions, P_f * (f), or by the products of cosines, sines and velocities that they consist of,
whichever is shorter.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any

from substructures.expr.graph import Expr
from substructures.textbook.atoms import Atoms, Monomial, monomial_key, times
from substructures.textbook.collect import Collector, common_number, factored
from substructures.textbook.factors import factors
from substructures.textbook.forms import Factor, Sum, Term, Trig, product
from substructures.textbook.harmonics import Harmonics, Mode, Wave, Waves, normal, shortest, wave_key

#: monomial of all atoms -> harmonics of the angles
Content = Mapping[Monomial, Harmonics]
#: what moves: powers of moving atoms, and of cosines and sines
Motion = tuple[Monomial, tuple[Wave, ...]]


@lru_cache(maxsize=20_000)
def _shortest(items: tuple[tuple[Mode, tuple[Fraction, Fraction]], ...]) -> Waves:
    return shortest(dict(items))


class Layout:
    """Writes formulas in the same atoms and angles; ``units`` are the parts of the angles that harmonics count."""

    def __init__(self, atoms: Atoms, angles: Sequence[Expr], units: Sequence[Fraction]) -> None:
        self.atoms, self.angles, self.units = atoms, angles, units
        self.collect = Collector(atoms)

    def __call__(self, found: Content) -> Sum:
        """The textbook form of a sum."""
        functions: dict[Monomial, dict[Motion, Fraction]] = {}
        for monomial, harmonics in found.items():
            constant, moving = self.atoms.split(monomial)
            for c, waves in _shortest(tuple(sorted(normal(harmonics).items()))):
                functions.setdefault(constant, {})[moving, waves] = c
        forms = [self._by_motion(functions), self._by_function(functions)]
        return min(forms, key=len)

    def _by_motion(self, functions: Mapping[Monomial, Mapping[Motion, Fraction]]) -> Sum:
        groups: dict[Motion, dict[Monomial, Fraction]] = {}
        for constant, function in functions.items():
            for motion, c in function.items():
                groups.setdefault(motion, {})[constant] = c
        terms: list[Term] = []
        for motion, polynomial in sorted(groups.items(), key=lambda item: _motion_key(item[0])):
            terms += self._times(polynomial, {motion: Fraction(1)})
        return Sum(tuple(terms))

    def _by_function(self, functions: Mapping[Monomial, Mapping[Motion, Fraction]]) -> Sum:
        groups: dict[tuple[tuple[Motion, Fraction], ...], dict[Monomial, Fraction]] = {}
        for constant, function in functions.items():
            items = sorted(function.items(), key=lambda item: _motion_key(item[0]))
            number = common_number(c for _, c in items) * (-1 if items[0][1] < 0 else 1)
            groups.setdefault(tuple((m, c / number) for m, c in items), {})[constant] = number
        terms: list[Term] = []
        for function_, polynomial in sorted(groups.items(), key=lambda item: _group_key(item[0])):
            terms += self._times(polynomial, dict(function_))
        return Sum(tuple(terms))

    def _times(self, polynomial: Mapping[Monomial, Fraction], function: Mapping[Motion, Fraction]) -> list[Term]:
        """Terms of (polynomial in parameters) * (function of what moves)."""
        if len(function) == 1:
            ((moving, waves),) = function
            if not moving and not waves:
                return list(self.collect(polynomial).terms)
        moving_, waves_ = self._common(function)
        number, inner = self._split({_over(m, (moving_, waves_)): c for m, c in function.items()})
        if len(polynomial) == 1 and polynomial.get((), Fraction(0)) in (1, -1) and [n for _, n in inner] == [1]:
            return [t.scaled(polynomial[()]) for t in self._function(function).terms]
        constant = self.collect.factored(polynomial)
        factors: list[tuple[Factor, int]] = [*constant.factors, *self._waves(waves_), *self.atoms.factors(moving_)]
        return [product(constant.coefficient * number, [*factors, *inner])]

    def _split(self, function: Mapping[Motion, Fraction]) -> tuple[Fraction, list[tuple[Factor, int]]]:
        """A number, and factors of a function with their powers: a polynomial in velocities is factored."""
        if not any(moving for moving, _ in function):
            whole = tuple((c, waves) for (_, waves), c in sorted(function.items(), key=lambda i: _motion_key(i[0])))
            value, found = factors(whole)
            return value, [(self._function({((), w): c for c, w in part}), n) for part, n in found]
        if any(waves for _, waves in function):
            return Fraction(1), [(self._function(function), 1)]
        number, parts = factored({moving: c for (moving, _), c in function.items()}, Fraction(1))
        return number, [(self._function({(m, ()): c for m, c in part.items()}), n) for part, n in parts]

    def _common(self, function: Mapping[Motion, Fraction]) -> Motion:
        """The powers that all terms of a function have."""
        first, *others = function
        moving, waves = dict(first[0]), {(op, k): n for op, k, n in first[1]}
        for monomial, more in others:
            here, there = dict(monomial), {(op, k): n for op, k, n in more}
            moving = {i: min(n, here[i]) for i, n in moving.items() if i in here}
            waves = {w: min(n, there[w]) for w, n in waves.items() if w in there}
        return tuple(moving.items()), tuple((op, k, n) for (op, k), n in waves.items())

    def _function(self, function: Mapping[Motion, Fraction]) -> Sum:
        items = sorted(function.items(), key=lambda item: _motion_key(item[0]))
        return Sum(tuple(Term(c, (*self._waves(waves), *self.atoms.factors(moving))) for (moving, waves), c in items))

    def _waves(self, waves: Iterable[Wave]) -> list[tuple[Trig, int]]:
        return [(Trig(op, self._angle(k)), n) for op, k, n in waves]

    def _angle(self, k: Mode) -> tuple[tuple[Expr, Fraction], ...]:
        return tuple((a, n * u) for a, n, u in zip(self.angles, k, self.units, strict=True) if n)


def _over(motion: Motion, common: Motion) -> Motion:
    powers = {(op, k): n for op, k, n in motion[1]}
    for op, k, n in common[1]:
        powers[op, k] -= n
    return times(motion[0], common[0], -1), tuple((op, k, n) for (op, k), n in powers.items() if n)


def _motion_key(motion: Motion) -> tuple[Any, ...]:
    moving, waves = motion
    return sum(n for _, n in moving) > 0, monomial_key(moving), len(waves) > 0, wave_key(waves)


def _group_key(function: tuple[tuple[Motion, Fraction], ...]) -> tuple[Any, ...]:
    return tuple(_motion_key(m) for m, _ in function)
