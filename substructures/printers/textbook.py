"""Textbook forms (:mod:`substructures.textbook`) in a language."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import reduce

from substructures.expr.graph import Expr
from substructures.expr.program import Program
from substructures.printers.language import Language, Listing, Piece
from substructures.printers.listing import check_size
from substructures.textbook import LIMITS, Limits, Reading, Sum, Term, Trig, read
from substructures.textbook.forms import leaves

#: cosines and sines beyond which c12 is written for cos(q1 + q2)
SPELLED_OUT = 24


def textbook(program: Program, language: Language, limit: int, limits: Limits = LIMITS) -> Listing:
    """Every element in its textbook form, long ones with abbreviations. Raises TooLarge, and ZeroDivisionError."""
    return TextbookTerms(program, language, limit, limits, language.is_for_people).listing


class TextbookTerms:
    """The textbook form of a program in a language: its listing, and the terms of its elements one by one."""

    def __init__(
        self, program: Program, language: Language, limit: int, limits: Limits = LIMITS, abbreviates: bool = True
    ) -> None:
        """Raises TooLarge, and ZeroDivisionError."""
        self.reading = read(program, limits)
        check_size(self.reading.size, limit)
        self._short = _abbreviations(program, self.reading) if abbreviates else {}
        self._writer = TextbookWriter(program, language, self.reading)
        named = tuple(
            (language.abbreviation(t.op, n).text, self._writer.trig(t, 1).text) for t, n in self._short.items()
        )
        self._writer.short = self._short
        entries = {name: tuple(self._writer.sum(f).text for f in some) for name, some in self.reading.outputs.items()}
        self.listing = Listing((), entries, named)

    def text(self, term: Term) -> str:
        """A term with its sign, in the names of the listing."""
        return self._writer.sum(Sum((term,))).text


def textbook_inlined(program: Program, language: Language, limit: int) -> Listing:
    """Every element in its textbook form, which stands alone. Raises TooLarge, and ZeroDivisionError."""
    return TextbookTerms(program, language, limit, LIMITS, False).listing


def _abbreviations(program: Program, reading: Reading) -> dict[Trig, str]:
    """Digits of the names of cosines and sines, c12 for cos(q1 + q2); none where a symbol has such a name."""
    counts = Counter(leaf for form in reading.forms for leaf in leaves(form) if isinstance(leaf, Trig))
    if sum(counts.values()) <= SPELLED_OUT:
        return {}
    digits = {t: d for t, n in counts.items() if n > 1 and (d := _digits(t)) is not None}
    names = {t.op[0] + d for t, d in digits.items()}
    if names & {s.name for s in program.symbols} or len(names) < len(digits):
        return {}
    return dict(sorted(digits.items(), key=lambda item: (len(item[1]), item[1], item[0].op)))


def _digits(trig: Trig) -> str | None:
    """The digits of a sum of coordinates q1, q2, ..."""
    found = [re.fullmatch(r"q([0-9])", str(a.value), re.ASCII) if c == 1 else None for a, c in trig.angle]
    return "".join(m.group(1) for m in found if m) if all(found) else None


class TextbookWriter:
    """Writes textbook forms; ``short`` are the cosines and sines that have names."""

    def __init__(self, program: Program, language: Language, reading: Reading) -> None:
        self.language, self.reading = language, reading
        self.number = {s.name: n for n, s in enumerate(program.symbols)}
        self.short: Mapping[Trig, str] = {}
        self.atoms: dict[Expr, Piece] = {}
        for function in reading.inside_out:
            self.atoms[function] = language.write(function.op, [self.sum(f) for f in reading.functions[function]])

    def _atom(self, node: Expr) -> Piece:
        if node.op == "sym":
            return self.language.symbol(self.number[str(node.value)])
        return self.language.pi() if node is node.graph.pi else self.atoms[node]

    def sum(self, form: Sum) -> Piece:
        """A sum with the signs of its terms."""
        return self._signed(
            (t.coefficient < 0, self._term(t.scaled(Fraction(-1)) if t.coefficient < 0 else t)) for t in form.terms
        )

    def _signed(self, terms: Iterable[tuple[bool, Piece]]) -> Piece:
        result: Piece | None = None
        for negative, piece in terms:
            if result is None:
                result = self.language.neg(piece) if negative else piece
            else:
                result = self.language.sub(result, piece) if negative else self.language.add(result, piece)
        return result or self.language.number(Fraction(0))

    def _term(self, term: Term) -> Piece:
        """A product, over the factors with negative powers; c > 0."""
        above = [self._power(f, n) for f, n in term.factors if n > 0]
        below = [self._power(f, -n) for f, n in term.factors if n < 0]
        c = term.coefficient
        if below and self._is_ratio(c):
            below.insert(0, self.language.number(Fraction(c.denominator)))
            c = Fraction(c.numerator)
        top = reduce(self.language.mul, [*([self.language.decimal(c)] if c != 1 or not above else []), *above])
        return self.language.div(top, reduce(self.language.mul, below)) if below else top

    def _is_ratio(self, c: Fraction) -> bool:
        """Whether a number is written as a quotient of integers."""
        return c.denominator != 1 and "." not in self.language.decimal(c).text

    def _power(self, factor: Expr | Trig | Sum, n: int) -> Piece:
        if isinstance(factor, Trig):
            return self.trig(factor, n)
        piece = self.sum(factor) if isinstance(factor, Sum) else self._atom(factor)
        return piece if n == 1 else self.language.power(piece, n)

    def trig(self, trig: Trig, n: int) -> Piece:
        """A power of a cosine or sine, by its short name if it has one."""
        if trig in self.short:
            piece = self.language.abbreviation(trig.op, self.short[trig])
            return piece if n == 1 else self.language.power(piece, n)
        angle = self._signed((c < 0, self._multiple(abs(c), a)) for a, c in trig.angle)
        return self.language.trig(trig.op, angle, n)

    def _multiple(self, c: Fraction, angle: Expr) -> Piece:
        """A part of an angle: a multiple of an atom, or a number of radians."""
        if angle.is_number:
            return self.language.number(c * Fraction(angle.value))
        atom = self._atom(angle)
        return atom if c == 1 else self.language.mul(self.language.number(c), atom)
