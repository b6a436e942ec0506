"""From the unique sum of terms of a formula to its textbook form.

The formula is a sum of monomials of parameters times functions of what moves. Each of these functions is brought to
its shortest form by itself, so that another parameter changes nothing but the terms that it occurs in. Terms are then
gathered either by functions, P_f * (f), or by the products of cosines, sines and velocities that they consist of,
whichever is shorter.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

from substructures.expr.graph import Expr
from substructures.textbook.atoms import INPUT, MASS, MOVING, Atoms, Monomial, Polynomial, monomial_key, times
from substructures.textbook.collect import WAYS, Collector, length
from substructures.textbook.divisors import common_number, content, factored, is_fraction
from substructures.textbook.factors import factors
from substructures.textbook.forms import Factor, Sum, Term, Trig, leaves, product
from substructures.textbook.harmonics import Mode, Wave, Waves, angle_key, normal, shortest, wave_key
from substructures.textbook.springs import Content, Square, completed, squares
from substructures.textbook.work import Work

#: terms of a sum that may have squares of cosines and sines
SQUARED = 20
#: what moves: powers of moving atoms, and of cosines and sines
Motion = tuple[Monomial, tuple[Wave, ...]]
#: by monomial of what is constant the sum that it is multiplied by
Functions = dict[Monomial, dict[Motion, Fraction]]


class Layout:
    """Writes formulas in the same atoms and angles; ``units`` are the parts of the angles that harmonics count."""

    def __init__(self, atoms: Atoms, angles: Sequence[Expr], units: Sequence[Fraction], work: Work) -> None:
        self.atoms, self.angles, self.units, self.work = atoms, angles, units, work
        self.collect = Collector(atoms, work)

    def __call__(self, found: Content) -> Sum:
        """The textbook form of a sum, with squares for what they are if that is shorter: 1/2*k*(q - l)^2."""
        form = self._divided(found)
        springs, rest = squares(found, self.atoms)
        if not springs:
            return form
        terms = [*self._divided(rest).terms, *self._squares(springs)]
        return min(form, Sum(tuple(terms)), key=len)

    def _squares(self, springs: Iterable[Square], trigs: Sequence[Trig] = ()) -> Iterator[Term]:
        """Terms of squares, those of the same stiffness as one: 1/2*k*((q1 - l1)^2 + (q2 - l2)^2)."""
        same: dict[tuple[Fraction, Monomial], list[Term]] = {}
        for number, stiffness, x, rest in springs:
            is_moment = any(self.atoms.ranks[i] == MASS for i, _ in stiffness)
            inner = self.distance(x, rest, is_moment, trigs)
            same.setdefault((number, stiffness), []).append(Term(Fraction(1), ((inner, 2),)))
        for (number, stiffness), some in same.items():
            yield product(number, [*self.atoms.factors(stiffness), (Sum(tuple(some)), 1)])

    def distance(self, x: Monomial, rest: Polynomial, is_moment: bool = False, trigs: Sequence[Trig] = ()) -> Sum:
        """x - rest of springs, l0 + x and l1 - l2 - x of moments of inertia; ``trigs`` are further atoms."""
        terms = sorted(((m, -c) for m, c in rest.items()), key=lambda item: monomial_key(item[0]))
        written = [*terms, (x, Fraction(1))] if terms[0][1] > 0 else [(x, Fraction(1)), *terms]
        written = sorted(written, key=lambda item: monomial_key(item[0])) if is_moment else written
        sign = -1 if written[0][1] < 0 else 1
        atoms: list[Factor] = [*self.atoms.exprs, *trigs]
        return Sum(tuple(Term(sign * c, tuple((atoms[i], n) for i, n in m)) for m, c in written))

    def _with_squares(self, functions: Functions) -> Sum:
        """The shortest form of functions, with squares of what has cosines and sines: m*(r + l*sin(q))^2."""
        form = self._best(functions)
        waves = [w for function in functions.values() for _, some in function for w in some]
        if all(n != 2 for _, _, n in waves) or sum(map(len, functions.values())) > SQUARED:
            return form
        trigs = sorted({(op, k) for op, k, _ in waves}, key=lambda trig: (angle_key(trig[1]), trig[0]))
        plain = self._with_atoms(functions, trigs)
        found, left = completed(plain, self._squared(plain), {})
        if not found:
            return form
        rest: Functions = {}
        for motion_, c in self._motions(left, trigs):
            constant, moving = self.atoms.split(motion_[0])
            rest.setdefault(constant, {})[moving, motion_[1]] = c
        written = [Trig(op, self._angle(k)) for op, k in trigs]
        other = Sum((*(self._best(rest).terms if rest else ()), *self._squares(found, written)))
        return min(form, other, key=length)

    def _with_atoms(self, functions: Functions, trigs: Sequence[tuple[str, Mode]]) -> Polynomial:
        """Functions as a polynomial, in which cosines and sines are atoms behind the others."""
        place = {trig: n for n, trig in enumerate(trigs, len(self.atoms.exprs))}
        return {
            times(times(constant, moving), tuple((place[op, k], n) for op, k, n in some)): c
            for constant, function in functions.items()
            for (moving, some), c in function.items()
        }

    def _squared(self, polynomial: Polynomial) -> set[tuple[int, Monomial]]:
        """Squares of cosines and sines, with the geometry that they are multiplied by."""
        below = len(self.atoms.exprs)
        found = {(x, times(m, ((x, -2),))) for m in polynomial for x, n in m if n == 2 and x >= below}
        return {(x, factor) for x, factor in found if self._is_geometry(factor)}

    def _is_geometry(self, monomial: Monomial) -> bool:
        """Whether nothing moves, and no mass is squared."""
        ranks = self.atoms.ranks
        return all(i < len(ranks) and ranks[i] != MOVING and (n == 1 or ranks[i] != MASS) for i, n in monomial)

    def _divided(self, found: Content) -> Sum:
        """Over a common divisor if that is shorter: (a + b)/c for a/c + b/c."""
        form = self._apart(found)
        below: dict[int, int] = {}
        for i, n in (item for monomial in found for item in monomial):
            if n < min(below.get(i, 0), 0) and self.atoms.ranks[i] < INPUT:
                below[i] = n
        if not below or len(found) < 2:
            return form
        divisor = tuple(sorted(below.items()))
        whole = self._apart({times(m, divisor, -1): harmonics for m, harmonics in found.items()})
        return min(form, Sum((product(Fraction(1), [(whole, 1), *self.atoms.factors(divisor)]),)), key=len)

    def _apart(self, found: Content) -> Sum:
        """What is quadratic in rates is added to the rest; (w + q')^2 stays whole."""
        slow = {m: h for m, h in found.items() if self._rates(m) < 2}
        fast = {m: h for m, h in found.items() if m not in slow}
        if not slow or not fast:
            return self._gathered(found)
        apart = Sum((*self._gathered(slow).terms, *self._gathered(fast).terms))
        if not any(self._rates(m) == 1 for m in slow):
            return apart
        whole = self._gathered(found)
        squares = [f for t in whole.terms for f, n in t.factors if n > 1 and isinstance(f, Sum) and self._is_rate(f)]
        is_mixed = any(not self._is_rate(Sum((t,))) for square in squares for t in square.terms)
        return min(whole, apart, key=length) if is_mixed else apart

    def _rates(self, monomial: Monomial) -> int:
        return sum(n for i, n in monomial if self.atoms.is_rate(self.atoms.exprs[i]))

    def _gathered(self, found: Content) -> Sum:
        functions: Functions = {}
        for monomial, harmonics in found.items():
            constant, moving = self.atoms.split(monomial)
            for c, waves in self._shortest(tuple(sorted(normal(harmonics).items()))):
                functions.setdefault(constant, {})[moving, waves] = c
        return self._with_fractions(self._with_squares(functions))

    def _shortest(self, items: tuple[tuple[Mode, tuple[Fraction, Fraction]], ...]) -> Waves:
        return self.work.once(("shortest", items), lambda: shortest(dict(items), self.work))

    def _best(self, functions: Functions) -> Sum:
        """The shortest of gathered by motion, by functions, by cosines and sines, and by rates."""
        self.work.steps(WAYS * sum(map(len, functions.values())))
        moving = {i for function in functions.values() for places, _ in function for i, _ in places}
        # of equal lengths C*(p' + cos(q)*r') with rates, else term by term
        key = length if any(self.atoms.is_rate(self.atoms.exprs[i]) for i in moving) else len
        best = min([self._by_motion(functions), self._by_function(functions)], key=key)
        if moving:
            best = min([best, self._by_waves(functions), self._by_rates(functions)], key=length)
        return best

    def _by_rates(self, functions: Functions) -> Sum:
        """What rates are multiplied by: (I + J*cos(q)^2)*q'."""
        groups: dict[Monomial, Functions] = {}
        for constant, function in functions.items():
            for (moving, waves), c in function.items():
                rates = tuple((i, n) for i, n in moving if self.atoms.is_rate(self.atoms.exprs[i]))
                inner = groups.setdefault(rates, {}).setdefault(constant, {})
                inner[times(moving, rates, -1), waves] = c
        if len(groups) < 2:
            return self._by_motion(functions)
        terms: list[Term] = []
        for rates, some in sorted(groups.items(), key=lambda item: monomial_key(item[0])):
            if not rates:
                terms += self._best(some).terms
                continue
            number, common = content({m: common_number(f.values()) for m, f in some.items()})
            form = self._best({times(m, common, -1): _over_number(f, number) for m, f in some.items()})
            factors: list[tuple[Factor, int]] = [*self.atoms.factors(common), (form, 1)]
            terms.append(product(number, [*self.collect.in_order(factors), *self.atoms.factors(rates)]))
        return Sum(tuple(terms))

    def _with_fractions(self, form: Sum) -> Sum:
        """A - 1/2*C for 1/2*(2*A - C), in sums of what does not move."""
        return Sum(tuple(map(self._fraction_inside, form.terms)))

    def _fraction_inside(self, term: Term) -> Term:
        c, new = term.coefficient, list[tuple[Factor, int]]()
        for factor, n in term.factors:
            if isinstance(factor, Sum):
                below = c.denominator
                whole = [t.coefficient % below == 0 for t in factor.terms]
                if below > 1 and is_fraction(c) and n == 1 and any(whole) and not self._moves(factor):
                    c *= below
                    factor = Sum(tuple(t.scaled(Fraction(1, below)) for t in factor.terms))
                factor = self._with_fractions(factor)
            new.append((factor, n))
        return Term(c, tuple(new))

    def _moves(self, form: Sum) -> bool:
        return any(isinstance(x, Trig) or self.atoms.ranks[self.atoms.place[x]] == MOVING for x in leaves(form))

    def _by_waves(self, functions: Mapping[Monomial, Mapping[Motion, Fraction]]) -> Sum:
        """What cosines and sines are multiplied by is factored as a whole: m*(l + q)^2*cos(p)."""
        groups: dict[Motion, dict[Monomial, Fraction]] = {}
        for constant, function in functions.items():
            for (moving, waves), c in function.items():
                outside = tuple((i, n) for i, n in moving if self.atoms.exprs[i].args)
                key = times(times(constant, moving), outside, -1)
                groups.setdefault((outside, waves), {})[key] = c
        terms: list[Term] = []
        for motion, polynomial in sorted(groups.items(), key=lambda item: _motion_key(item[0])):
            found = self.collect.factored(polynomial)
            below = found.coefficient.denominator
            if below > 1 and any(c.denominator != below for c in polynomial.values()):
                # a*q/3 + a*q^2/2 is no sixth of a sum
                return self._by_motion(functions)
            if motion == ((), ()):
                terms += self.collect(polynomial).terms
                continue
            first = [f for f in found.factors if not self._is_rate(f[0])]
            rates = [f for f in found.factors if self._is_rate(f[0])]
            terms.append(product(found.coefficient, [*first, *self._moved(motion), *rates]))
        return Sum(tuple(terms))

    def _is_rate(self, factor: Factor) -> bool:
        """Whether it is a rate, or a sum with rates."""
        if isinstance(factor, Sum):
            return any(map(self._is_rate, leaves(factor)))
        return not isinstance(factor, Trig) and self.atoms.is_rate(factor)

    def _moved(self, motion: Motion) -> list[tuple[Factor, int]]:
        """Places, then cosines and sines, then rates: s*cos(q)*s'."""
        moving = self.atoms.factors(motion[0])
        places = [f for f in moving if not self._is_rate(f[0])]
        return [*places, *self._waves(motion[1]), *(f for f in moving if self._is_rate(f[0]))]

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
        return [product(constant.coefficient * number, [*constant.factors, *self._moved((moving_, waves_)), *inner])]

    def _split(self, function: Mapping[Motion, Fraction]) -> tuple[Fraction, list[tuple[Factor, int]]]:
        """A number, and factors of a function with their powers: a polynomial in velocities is factored."""
        if not any(moving for moving, _ in function):
            whole = tuple((c, waves) for (_, waves), c in sorted(function.items(), key=lambda i: _motion_key(i[0])))
            value, found = self.work.once(("factors", whole), lambda: factors(whole, self.work))
            parts_: list[tuple[Waves, int]] = []
            for part, n in found:
                c, simple = _simple(part)
                value *= c**n
                parts_.append((simple, n))
            return value, self._products(parts_)
        trigs = sorted({(op, k) for _, waves in function for op, k, _ in waves})
        below = len(self.atoms.exprs)
        place = {trig: below + n for n, trig in enumerate(trigs)}
        # cosines and sines as further atoms
        polynomial = {
            tuple(sorted((*moving, *((place[op, k], n) for op, k, n in waves)))): c
            for (moving, waves), c in function.items()
        }
        number, parts = factored(polynomial, Fraction(1), self.work)
        return number, [(self._function(dict(self._motions(part, trigs))), n) for part, n in parts]

    def _motions(self, part: Polynomial, trigs: Sequence[tuple[str, Mode]]) -> Iterator[tuple[Motion, Fraction]]:
        """Terms with cosines and sines behind the other atoms."""
        below = len(self.atoms.exprs)
        order = sorted(range(len(trigs)), key=lambda i: (angle_key(trigs[i][1]), trigs[i][0] == "cos"))
        for monomial, c in part.items():
            powers = dict(monomial)
            waves = tuple((*trigs[i], powers[below + i]) for i in order if below + i in powers)
            yield (tuple((i, n) for i, n in monomial if i < below), waves), c

    def _products(self, parts: Sequence[tuple[Waves, int]]) -> list[tuple[Factor, int]]:
        """Factors; 1 - x^2 for (1 - x)*(1 + x)."""
        if [n for _, n in parts] == [1, 1]:
            one, other = ({w: c for c, w in part} for part, _ in parts)
            rest = {w: c for w, c in one.items() if w}
            if one.get(()) == other.get(()) and () in one and other == {(): one[()]} | {w: -c for w, c in rest.items()}:
                whole = tuple((c, w) for w, c in rest.items())
                sign, x = _simple(tuple(sorted(whole, key=lambda item: _motion_key(((), item[1])))))
                square = Term(-(sign**2), ((self._wave_sum(x), 2),))
                return [(Sum((Term(one[()] ** 2), square)), 1)]
        return [(self._wave_sum(part), n) for part, n in parts]

    def _wave_sum(self, waves: Waves) -> Sum:
        return self._function({((), w): c for c, w in waves})

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
        return Sum(tuple(Term(c, tuple(self._moved(motion))) for motion, c in items))

    def _waves(self, waves: Iterable[Wave]) -> list[tuple[Trig, int]]:
        return [(Trig(op, self._angle(k)), n) for op, k, n in waves]

    def _angle(self, k: Mode) -> tuple[tuple[Expr, Fraction], ...]:
        return tuple((a, n * u) for a, n, u in zip(self.angles, k, self.units, strict=True) if n)


def _simple(waves: Waves) -> tuple[Fraction, Waves]:
    """A number and a factor that begins with a positive term; cos(2*q) for 1 - 2*sin(q)^2."""
    first, *others = sorted(waves, key=lambda item: _motion_key(((), item[1])))
    if not first[1] and len(others) == 1 and len(others[0][1]) == 1:
        (c, ((op, k, n),)) = others[0]
        if n == 2 and c == -2 * first[0]:
            return first[0] * (1 if op == "sin" else -1), ((Fraction(1), (("cos", tuple(2 * m for m in k), 1),)),)
    sign = Fraction(-1 if first[0] < 0 else 1)
    return sign, tuple((c * sign, some) for c, some in waves)


def _over_number(function: Mapping[Motion, Fraction], number: Fraction) -> dict[Motion, Fraction]:
    return {motion: c / number for motion, c in function.items()}


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
