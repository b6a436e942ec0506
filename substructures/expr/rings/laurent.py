"""Arithmetic for the canonical form: rational functions of generators, with exp(i angle) as invertible generators.

A value is a quotient n/d of Laurent polynomials: an ``fmpq_mpoly`` of python-flint times a monomial with negative
exponents in the last generators z_a = exp(i a), where no relations hold between the z_a. Cosines and sines are
(z + 1/z)/2 and (z - 1/z)/(2i); the other generators are symbols, the unit i and roots, which have relations x**2 = p.
Every product is bounded before it is formed, so sizes cannot explode.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from substructures.errors import TooLarge
from substructures.expr.rationals import to_fmpq

#: a product may need this many times ``limit`` products of terms, and all results together have as many terms
WORK = 100
MAX_COEFFICIENT_BITS = 16_384
MAX_DEGREE = 10**8


@dataclass(frozen=True, slots=True)
class Laurent:
    """poly * z**-shift; ``bits`` bounds the size of the coefficients."""

    poly: Any
    shift: tuple[int, ...]
    bits: int


@dataclass(frozen=True, slots=True)
class Quotient:
    """n / d."""

    n: Laurent
    d: Laurent


class Ring:
    """Q[x_0, ..., x_(m-1), z_0^+-1, ...] modulo relations, and its quotients.

    ``relations`` maps a generator number to x**2 - p, where p only has later generators; ``unit`` is the number of i,
    ``roots`` are the others with relations, ``numeric_roots`` those of them whose squares are numbers.
    """

    def __init__(self, size: int, angles: int, limit: int) -> None:
        self.size, self.angles, self.limit, self.work = size, angles, limit, 0
        self.context = fmpq_mpoly_ctx.get([f"g{i}" for i in range(size + angles)], Ordering.lex)
        self.flat = (0,) * angles
        self.relations: dict[int, Any] = {}
        self.roots: tuple[int, ...] = ()
        self.numeric_roots: frozenset[int] = frozenset()
        self.unit = -1
        self.one = self.constant(Fraction(1))
        self.zero = self.constant(Fraction(0))

    @property
    def is_spent(self) -> bool:
        """Whether all results together are too large."""
        return self.work > WORK * self.limit

    def monomial(self, exponents: Sequence[int], value: Fraction = Fraction(1)) -> Any:
        """value * product of powers, as polynomial."""
        return self.context.term(coeff=to_fmpq(value), exp_vec=tuple(exponents))

    def laurent(self, poly: Any, bits: int) -> Laurent:
        """A polynomial as Laurent polynomial."""
        return Laurent(poly, self.flat, bits)

    def constant(self, value: Fraction) -> Quotient:
        """A number."""
        bits = value.numerator.bit_length() + value.denominator.bit_length()
        poly = self.context.constant(to_fmpq(value))
        one = self.laurent(self.context.constant(1), 1)
        return Quotient(self.laurent(poly, bits), one)

    def generator(self, i: int) -> Quotient:
        """The generator number i."""
        return Quotient(self.laurent(self.context.gen(i), 1), self.one.n)

    def relate(self, i: int, square: Any) -> None:
        """Demand that the square of generator i is this polynomial."""
        self.relations[i] = self.context.gen(i) ** 2 - square

    def cosine_sine(self, constant: tuple[Any, Any], k: Sequence[int]) -> tuple[Quotient, Quotient]:
        """cos and sin of an angle, where exp(i angle) = (constant[0] + i constant[1]) * z**k."""
        up = self.monomial([0] * self.size + [max(2 * n, 0) for n in k])
        down = self.monomial([0] * self.size + [max(-2 * n, 0) for n in k])
        shift = tuple(abs(n) for n in k)
        re, im, half = constant[0], constant[1], fmpq(1, 2)
        i = self.context.gen(self.unit)
        cosine = self.reduced(((re + i * im) * up + (re - i * im) * down) * half)
        sine = self.reduced(((im - i * re) * up + (im + i * re) * down) * half)
        one = self.one.n
        return Quotient(Laurent(cosine, shift, 16), one), Quotient(Laurent(sine, shift, 16), one)

    def reduced(self, poly: Any) -> Any:
        """The polynomial with all squares of related generators replaced."""
        degrees = poly.degrees()
        for i in sorted(self.relations):
            if degrees[i] > 1:
                poly = poly % self.relations[i]
                degrees = poly.degrees()
        return poly

    def plus(self, a: Laurent, b: Laurent) -> Laurent:
        """a + b."""
        shift = a.shift
        p, q = a.poly, b.poly
        if a.shift != b.shift:
            shift = tuple(map(max, a.shift, b.shift))
            p, q = self._raised(a, shift), self._raised(b, shift)
        return self._checked(p + q, shift, max(a.bits, b.bits) + min(a.bits, b.bits) + 1)

    def _raised(self, a: Laurent, shift: tuple[int, ...]) -> Any:
        lift = [n - m for n, m in zip(shift, a.shift, strict=True)]
        return a.poly * self.monomial([0] * self.size + lift) if any(lift) else a.poly

    def times(self, a: Laurent, b: Laurent) -> Laurent:
        """a * b; raises TooLarge before the product is formed."""
        products = len(a.poly) * len(b.poly)
        if products > WORK * self.limit:
            raise TooLarge("a product in the expanded form (products of terms)", products, WORK * self.limit)
        self.work += products // 4
        degree = int(a.poly.total_degree() + b.poly.total_degree())
        if degree > MAX_DEGREE:
            raise TooLarge("a degree in the expanded form", degree, MAX_DEGREE)
        bits = a.bits + b.bits + min(len(a.poly), len(b.poly)).bit_length()
        if bits > MAX_COEFFICIENT_BITS:
            bits = _bits(a.poly) + _bits(b.poly) + min(len(a.poly), len(b.poly)).bit_length()
            if bits > 2 * MAX_COEFFICIENT_BITS:
                raise TooLarge("a coefficient of the expanded form (in bits)", bits, 2 * MAX_COEFFICIENT_BITS)
        shift = tuple(n + m for n, m in zip(a.shift, b.shift, strict=True))
        return self._checked(self.reduced(a.poly * b.poly), shift, bits)

    def _checked(self, poly: Any, shift: tuple[int, ...], bits: int) -> Laurent:
        size = len(poly)
        self.work += size
        if size > 2 * self.limit:
            raise TooLarge("an expanded formula (in terms)", size, 2 * self.limit)
        if self.is_spent:
            raise TooLarge("all steps of an expansion together (in terms)", self.work, WORK * self.limit)
        if bits > MAX_COEFFICIENT_BITS:
            bits = _bits(poly)
            if bits > 2 * MAX_COEFFICIENT_BITS:
                raise TooLarge("a coefficient of the expanded form (in bits)", bits, 2 * MAX_COEFFICIENT_BITS)
        return Laurent(poly, shift, bits)

    def add(self, a: Quotient, b: Quotient) -> Quotient:
        """a + b."""
        if a.d.poly == b.d.poly and a.d.shift == b.d.shift:
            return self.cancelled(Quotient(self.plus(a.n, b.n), a.d))
        n = self.plus(self.times(a.n, b.d), self.times(b.n, a.d))
        return self.cancelled(Quotient(n, self.times(a.d, b.d)))

    def mul(self, a: Quotient, b: Quotient) -> Quotient:
        """a * b."""
        return self.cancelled(Quotient(self.times(a.n, b.n), self.times(a.d, b.d)))

    def div(self, a: Quotient, b: Quotient) -> Quotient:
        """a / b. Raises ZeroDivisionError."""
        if not len(b.n.poly):
            raise ZeroDivisionError("division by an expression that is identically zero")
        return self.cancelled(Quotient(self.times(a.n, b.d), self.times(a.d, b.n)))

    def negative(self, a: Quotient) -> Quotient:
        """-a."""
        return Quotient(Laurent(-a.n.poly, a.n.shift, a.n.bits), a.d)

    def cancelled(self, a: Quotient) -> Quotient:
        """a without common factors, roots in the denominator, or numeric denominator."""
        if a.d is self.one.n:
            return a
        n, d = a.n, self._stripped(a.d)
        if not len(n.poly):
            return self.zero
        for i in self.roots:
            if d.poly.degrees()[i] > 0 and self._has_safe_conjugate(d, i):
                # (p + q r)(p - q r) = p^2 - q^2 r^2
                conjugate = Laurent(d.poly - 2 * self.context.gen(i) * d.poly.derivative(i), d.shift, d.bits)
                norm = self.times(d, conjugate)
                if len(norm.poly):
                    n, d = self.times(n, conjugate), norm
        return self._lowest(n, d)

    def _has_safe_conjugate(self, d: Laurent, i: int) -> bool:
        """Whether p - q r vanishes nowhere but where d = p + q r does: where p = 0, or both are numbers.

        Elsewhere multiplying by it would make 0/0 of a value: of 1/(b - 1 + sqrt(a + 2)) at a = 2, b = 3, say.
        """
        degrees = d.poly.degrees()
        if all(n <= 0 or j in self.numeric_roots for j, n in enumerate(degrees)) and not any(d.shift):
            return True
        return not len(d.poly - self.context.gen(i) * d.poly.derivative(i))

    def _stripped(self, d: Laurent) -> Laurent:
        """The same without common powers of z."""
        if not any(d.shift):
            return d
        common = d.poly.term_content().degrees()[self.size :]
        down = [min(n, int(m)) for n, m in zip(d.shift, common, strict=True)]
        poly = d.poly / self.monomial([0] * self.size + down)
        return Laurent(poly, tuple(n - m for n, m in zip(d.shift, down, strict=True)), d.bits)

    def _lowest(self, n: Laurent, d: Laurent) -> Quotient:
        factor = n.poly.gcd(d.poly) if not d.poly.is_constant() else d.poly
        if not factor.is_constant() and self._is_plain(factor):
            n, d = Laurent(n.poly / factor, n.shift, 0), Laurent(d.poly / factor, d.shift, 0)
            n, d = (Laurent(x.poly, x.shift, _bits(x.poly)) for x in (n, d))
        if d.poly.is_constant() and not any(d.shift):
            poly = n.poly / d.poly.leading_coefficient()
            return Quotient(Laurent(poly, n.shift, n.bits + d.bits), self.one.n)
        return Quotient(n, d)

    def _is_plain(self, poly: Any) -> bool:
        """No angles and no i: dividing by it keeps numerator and denominator real."""
        degrees = poly.degrees()
        return not any(degrees[self.size :]) and degrees[self.unit] <= 0


def _bits(poly: Any) -> int:
    """Size of the largest coefficient."""
    return max((c.p.bit_length() + c.q.bit_length() for c in poly.coeffs()), default=1)
