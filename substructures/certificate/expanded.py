"""Forces that are given as formulas, expanded: sums of c q^n exp(i k.q) in the coordinates, with coefficients in balls.

Polynomials and trigonometric polynomials have this form, which shows what of a force depends on which coordinate.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

from flint import acb, arb, fmpq

from substructures.certificate.linear import Ball
from substructures.certificate.texts import Steps, names_of
from substructures.expr.direct import BALL_FUNCTIONS, carried_out

#: powers n and (rational) frequencies k of the coordinates
Key = tuple[tuple[int, ...], tuple[Fraction, ...]]
#: a coefficient, and its exact value where it is a number of the text
Coefficient = tuple[Any, Fraction | None]
#: terms of a sum that is looked at
MOST = 200


class NoExpansionError(Exception):
    """An expression that is no (trigonometric) polynomial of a few terms."""


@dataclass(frozen=True)
class Expanded:
    """Terms by powers and frequencies of ``n`` coordinates."""

    n: int
    terms: Mapping[Key, Coefficient]

    def __add__(self, other: Expanded) -> Expanded:
        found = dict(self.terms)
        for key, (c, exact) in other.terms.items():
            a, b = found.get(key, (acb(0), Fraction(0)))
            found[key] = a + c, None if b is None or exact is None else b + exact
        return self._of(found)

    def __sub__(self, other: Expanded) -> Expanded:
        return self + -other

    def __neg__(self) -> Expanded:
        return self._of({key: (-c, None if e is None else -e) for key, (c, e) in self.terms.items()})

    def __mul__(self, other: Expanded) -> Expanded:
        if len(self.terms) * len(other.terms) > MOST:
            raise NoExpansionError
        result = self._of({})
        for (n, k), (a, e) in self.terms.items():
            more = {
                (_plus(n, n_), _plus(k, k_)): (a * b, None if e is None or f is None else e * f)
                for (n_, k_), (b, f) in other.terms.items()
            }
            result = result + self._of(more)
        return result

    def __truediv__(self, other: Expanded) -> Expanded:
        c, exact = other.constant()
        inverse = 1 / c, None if exact is None else 1 / exact
        return self * self._of({self.one: inverse})

    @property
    def one(self) -> Key:
        """What a constant stands at."""
        return (0,) * self.n, (Fraction(0),) * self.n

    def constant(self) -> Coefficient:
        """The value of a divisor, or of what a function is taken of. Raises ZeroDivisionError for zero."""
        if not self.terms:
            raise ZeroDivisionError
        if list(self.terms) != [self.one]:
            raise NoExpansionError
        return self.terms[self.one]

    def power(self, n: int) -> Expanded:
        """By squaring."""
        result, square, left = self._of({self.one: (acb(1), Fraction(1))}), self, abs(n)
        while left:
            result = result * square if left & 1 else result
            left >>= 1
            square = square * square if left else square
        return self._of({self.one: (acb(1), Fraction(1))}) / result if n < 0 else result

    def wave(self, name: str) -> Expanded:
        """cos or sin of a + k.q: exp(i a) exp(i k.q) and its conjugate, halved."""
        a, k = acb(0), [Fraction(0)] * self.n
        for (powers, frequencies), (c, exact) in self.terms.items():
            if any(frequencies) or sum(powers) > 1 or (sum(powers) == 1 and exact is None):
                raise NoExpansionError
            if sum(powers):
                k[powers.index(1)] += exact or 0
            else:
                a = a + c
        if not any(k):
            return self._of({self.one: (getattr(a, name)(), None)})
        i, still = acb(0, 1), (0,) * self.n
        plus, minus = (i * a).exp() / 2, (-i * a).exp() / 2
        if name == "sin":
            plus, minus = plus / i, -minus / i
        return self._of({(still, tuple(k)): (plus, None), (still, tuple(-x for x in k)): (minus, None)})

    def function(self, name: str) -> Expanded:
        """Of a constant, or cos and sin of an angle."""
        if not self.terms or list(self.terms) == [self.one]:
            c = self.terms[self.one][0] if self.terms else acb(0)
            return self._of({self.one: (acb(getattr(c.real, name)()), None)})
        if name in ("cos", "sin"):
            return self.wave(name)
        raise NoExpansionError

    def _of(self, terms: Mapping[Key, Coefficient]) -> Expanded:
        return Expanded(self.n, {key: c for key, c in terms.items() if c[1] != 0 and c[0] != 0})

    def values(self, q: Sequence[Ball]) -> dict[Key, Ball]:
        """The terms at the coordinates q, those of exp(i k.q) and exp(-i k.q) together."""
        found: dict[Key, Ball] = {}
        for (n, k), (c, _) in self.terms.items():
            angle = sum((x * _ball(f) for x, f in zip(q, k, strict=True)), arb(0))
            factor = arb(1)
            for x, power in zip(q, n, strict=True):
                for _ in range(power):
                    factor = factor * x
            key = n, max(k, tuple(-f for f in k))
            found[key] = found.get(key, arb(0)) + factor * (c * acb(angle.cos(), angle.sin())).real
        return found


def expanded(steps: Steps, names: Mapping[str, Ball], coordinates: Sequence[str]) -> Expanded:
    """An expression as a polynomial and trigonometric polynomial of the coordinates.

    Raises NoExpansionError where it is none, ZeroDivisionError for a divisor that is zero.
    """
    n = len(coordinates)
    zero = Expanded(n, {})

    def number(x: Fraction) -> Expanded:
        """An exact constant."""
        return Expanded(n, {zero.one: (acb(_ball(x)), x)} if x else {})

    def named(x: Any) -> Expanded:
        """A coordinate, or a constant."""
        if isinstance(x, Expanded):
            return x
        return Expanded(n, {} if x == 0 else {zero.one: (acb(x), None)})

    moving = {
        q: Expanded(n, {(tuple(int(i == j) for j in range(n)), zero.one[1]): (acb(1), Fraction(1))})
        for i, q in enumerate(coordinates)
    }
    functions: dict[str, Callable[..., Any]] = {name: partial(_call, name) for name in BALL_FUNCTIONS}
    pi = partial(named, arb.pi())
    used = {name: names[name] for name in names_of(steps)}
    return carried_out(steps, {**used, **moving}, number, named, pi, functions, Expanded.power)


def _call(name: str, *args: Any) -> Expanded:
    if name not in ("sin", "cos", "tan", "sqrt"):
        raise NoExpansionError
    result: Expanded = args[0].function(name)
    return result


def _plus(a: tuple[Any, ...], b: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(x + y for x, y in zip(a, b, strict=True))


def _ball(x: Fraction) -> Ball:
    return arb(fmpq(x.numerator, x.denominator))
