"""Sums of monomials times harmonics, as polynomials in tangents of half angles and in cosines and sines."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from flint import Ordering, fmpq_mpoly_ctx

from substructures.textbook.atoms import Monomial, times
from substructures.textbook.exponentials import Laurent, harmonics_of, power, spread, tangent
from substructures.textbook.harmonics import normal, polynomial_of
from substructures.textbook.springs import Content
from substructures.textbook.work import Work


class Ring:
    """Polynomials in atoms, which stand at ``places``, and in cosines and sines of angles."""

    def __init__(self, places: Sequence[int], angles: int, work: Work) -> None:
        self.places, self.size, self.angles, self.work = places, len(places), angles, work
        self.context = fmpq_mpoly_ctx.get([f"g{i}" for i in range(self.size + 2 * angles)], Ordering.lex)

    def fewest(self, content: Content) -> tuple[Any, tuple[int, ...]]:
        """The polynomial in atoms, cosines and sines with the fewest terms, and the angles without cosines squared."""
        best = self.polynomial(content, ())
        sines: tuple[int, ...] = ()
        for i in range(self.angles):
            other = self.polynomial(content, (*sines, i))
            if len(other) < len(best):
                best, sines = other, (*sines, i)
        return best, sines

    def polynomial(self, content: Content, sines: Sequence[int]) -> Any:
        """The polynomial without squares of cosines of the angles ``sines``, and of sines of the others."""
        place = {p: n for n, p in enumerate(self.places)}
        found: dict[tuple[int, ...], Any] = {}
        for monomial, harmonics in content.items():
            head = [0] * self.size
            for i, n in monomial:
                head[place[i]] = n
            for powers, c in polynomial_of(normal(harmonics), sines, self.work).items():
                key = (*head, *(n for both in powers for n in both))
                found[key] = found.get(key, 0) + c
        return self.context.from_dict({k: c for k, c in found.items() if c})

    def back(self, poly: Any) -> Content:
        """The harmonics of a polynomial in atoms, cosines and sines."""
        result: dict[Monomial, Laurent] = {}
        for raw, c in poly.to_dict().items():
            exponents = [int(n) for n in raw]
            monomial = self._monomial(exponents[: self.size])
            pairs = [exponents[self.size + 2 * i : self.size + 2 * i + 2] for i in range(self.angles)]
            spread(result.setdefault(monomial, {}), [power(a, b) for a, b in pairs], c, self.work)
        return {m: harmonics_of(z) for m, z in result.items()}

    def from_tangents(self, poly: Any, halves: Sequence[int]) -> Content:
        """The harmonics of a polynomial in atoms and tangents of half angles, over the powers ``halves`` of 1 + t^2."""
        result: dict[Monomial, Laurent] = {}
        for raw, c in poly.to_dict().items():
            exponents = [int(n) for n in raw]
            waves = [tangent(j, e) for j, e in zip(exponents[self.size :], halves, strict=True)]
            spread(result.setdefault(self._monomial(exponents[: self.size]), {}), waves, c, self.work)
        found = {m: harmonics_of(z) for m, z in result.items()}
        return {m: h for m, h in found.items() if h}

    def _monomial(self, exponents: Sequence[int]) -> Monomial:
        return tuple(sorted((p, n) for p, n in zip(self.places, exponents, strict=True) if n))


def monomial_of(content: Content) -> tuple[Monomial, Fraction] | None:
    """The monomial and the number that content is, if it is no more."""
    monomial, waves = next(iter(content.items()))
    return (monomial, next(iter(waves.values()))[0]) if len(content) == 1 and not any(map(any, waves)) else None


def divided(content: Content, monomial: Monomial, number: Fraction) -> Content:
    """Content over a number and a monomial."""
    return {
        times(m, monomial, -1): {k: (a / number, b / number) for k, (a, b) in h.items()} for m, h in content.items()
    }
