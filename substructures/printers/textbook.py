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
from substructures.printers.numbers import has_decimals
from substructures.textbook.forms import Factor, Sum, Term, Trig, atoms_of, leaves, numbers
from substructures.textbook.reading import AT_ONCE, LIMITS, Limits, Reading, read
from substructures.textbook.scales import ratio

#: so many angles q1, q2, ..., and c12 is written for cos(q1 + q2); parameters decide nothing, so that one more of them
#: leaves the other lines as they are
ABBREVIATED = 4
#: factors and numbers of a function that has a name where it is used more than once
REPEATED = 6
#: factors and numbers of a sum that has a name where a fraction with it below is too wide
LONG = 12
#: elements and operations of small results, and products of terms of rational functions in these and in others: more of
#: them in many elements are lines that nobody reads, and take long to write
FEW, SMALL, WORK_OF_FEW, WORK_OF_MANY = 2, 400, 1_000_000, 100_000
#: parts of a half turn that are written as such, pi/180
DEGREES = 180
_ANGLE = re.compile(r"q([0-9])", re.ASCII)


def textbook(program: Program, language: Language, limit: int, limits: Limits = LIMITS) -> Listing:
    """Every element in its textbook form, long ones with abbreviations. Raises TooLarge, and ZeroDivisionError."""
    return TextbookTerms(program, language, limit, limits, language.is_for_people).listing


class TextbookTerms:
    """The textbook form of a program in a language: its listing, and the terms of its elements one by one."""

    def __init__(
        self,
        program: Program,
        language: Language,
        limit: int,
        limits: Limits = LIMITS,
        abbreviates: bool = True,
        reading: Reading | None = None,
    ) -> None:
        """``reading``: of the program, where it is known. Raises TooLarge, and ZeroDivisionError."""
        self.reading = read(program, limits) if reading is None else reading
        check_size(self.reading.size, limit)
        short = _abbreviations(program, self.reading, language) if abbreviates else {}
        repeated = _repeated(self.reading) if abbreviates else []
        named = {f: language.temporary(n) for n, f in enumerate(repeated, 1)}
        divisors: dict[str, Piece] | None = {} if abbreviates else None
        self._writer = TextbookWriter(program, language, self.reading, short, named, divisors)
        before = [(language.abbreviation(t.op, n).text, self._writer.spelled_out(t)) for t, n in short.items()]
        before += [(piece.text, self._writer.formulas[f].text) for f, piece in named.items()]
        entries = {
            name: tuple(self._writer.formula(f).text for f in some) for name, some in self.reading.outputs.items()
        }
        before += [(piece.text, text) for text, piece in (divisors or {}).items()]
        self.listing = Listing((), entries, tuple(before))
        # symbols that cancelled are in none of the forms
        symbols = {str(a.value) for a in atoms_of(self.reading.forms) if a.op == "sym"}
        language.occurring = frozenset(n for n, s in enumerate(program.symbols) if s.name in symbols)

    def text(self, term: Term) -> str:
        """A term with its sign, in the names of the listing."""
        return self._writer.formula(Sum((term,))).text


def at_once(program: Program) -> Limits:
    """What a textbook form may need where nobody asked for it: about a second."""
    elements = sum(len(output.entries) for output in program.outputs.values())
    is_small = elements <= FEW and len(program) <= SMALL
    return Limits(AT_ONCE.terms, WORK_OF_FEW if is_small else WORK_OF_MANY)


def textbook_inlined(program: Program, language: Language, limit: int, limits: Limits = LIMITS) -> Listing:
    """Every element in its textbook form, which stands alone. Raises TooLarge, and ZeroDivisionError."""
    return TextbookTerms(program, language, limit, limits, False).listing


def _abbreviations(program: Program, reading: Reading, language: Language) -> dict[Trig, str]:
    """Digits of the names of cosines and sines, c12 for cos(q1 + q2); none where a symbol looks like such a name."""
    if sum(s.kind == "coordinate" and _ANGLE.fullmatch(s.name) is not None for s in program.symbols) < ABBREVIATED:
        return {}
    used = {leaf for form in reading.forms for leaf in leaves(form) if isinstance(leaf, Trig)}
    digits = {t: d for t in used if (d := _digits(t)) is not None}
    names = {language.abbreviation(t.op, d) for t, d in digits.items()}
    if len(names) < len(digits) or not all(map(language.is_free, names)):
        return {}
    return dict(sorted(digits.items(), key=lambda item: (len(item[1]), item[1], item[0].op)))


def _digits(trig: Trig) -> str | None:
    """The digits of a sum of coordinates q1, q2, ..."""
    found = [_ANGLE.fullmatch(str(a.value)) if c == 1 else None for a, c in trig.angle]
    return "".join(m.group(1) for m in found if m) if all(found) else None


def _repeated(reading: Reading) -> list[Expr]:
    """Functions of long sums that are used more than once: a length that forces are divided by."""
    counts = Counter(leaf for form in reading.forms for leaf in leaves(form) if isinstance(leaf, Expr))
    return [f for f in reading.inside_out if counts[f] > 1 and sum(map(len, reading.functions[f])) >= REPEATED]


def _has_decimals(forms: Iterable[Sum]) -> bool:
    return has_decimals(x for form in forms for c in numbers(form) for x in ratio(c, True))


class TextbookWriter:
    """Writes textbook forms; ``short`` are the cosines and sines that have names, ``named`` the functions.

    ``formulas``: of all functions. ``divisors``: takes the names of long sums below too wide fractions, by formula.
    """

    def __init__(
        self,
        program: Program,
        language: Language,
        reading: Reading,
        short: Mapping[Trig, str],
        named: Mapping[Expr, Piece],
        divisors: dict[str, Piece] | None = None,
    ) -> None:
        self.language, self.reading, self.short = language, reading, short
        self._divisors, self._first_divisor = divisors, len(named) + 1
        self.number = {s.name: n for n, s in enumerate(program.symbols)}
        self.atoms: dict[Expr, Piece] = {}
        self.formulas: dict[Expr, Piece] = {}
        for function in reading.inside_out:
            inner = reading.functions[function]
            language.decimals = _has_decimals(inner)
            written = language.write(function.op, [self.sum(f) for f in inner])
            self.formulas[function] = written
            self.atoms[function] = named.get(function, written)

    def _atom(self, node: Expr) -> Piece:
        if node.op == "sym":
            return self.language.symbol(self.number[str(node.value)])
        return self.language.pi() if node is node.graph.pi else self.atoms[node]

    def formula(self, form: Sum) -> Piece:
        """A whole formula; 1/2 is 0.5 beside decimal numbers."""
        self.language.decimals = _has_decimals([form])
        return self.sum(form)

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
        c, divisor = ratio(c, bool(below))
        below = [self.language.number(divisor), *below] if divisor != 1 else below
        top = reduce(self.language.mul, [*([self.language.number(c)] if c != 1 or not above else []), *above])
        if not below:
            return top
        bottom = reduce(self.language.mul, below)
        if self._divisors is not None and self.language.is_too_wide(top, bottom):
            with_names = [self._divisor(f, -n) for f, n in term.factors if n < 0]
            bottom = reduce(self.language.mul, [*below[: len(below) - len(with_names)], *with_names])
        return self.language.div(top, bottom)

    def _divisor(self, factor: Factor, n: int) -> Piece:
        """What stands below a fraction that has no room for all, long sums by names."""
        if self._divisors is None or not isinstance(factor, Sum) or len(factor) < LONG:
            return self._power(factor, n)
        name = self.language.temporary(self._first_divisor + len(self._divisors))
        piece = self._divisors.setdefault(self.sum(factor).text, name)
        return piece if n == 1 else self.language.power(piece, n)

    def _power(self, factor: Factor, n: int) -> Piece:
        if isinstance(factor, Trig):
            return self.trig(factor, n)
        piece = self.sum(factor) if isinstance(factor, Sum) else self._atom(factor)
        return piece if n == 1 else self.language.power(piece, n)

    def trig(self, trig: Trig, n: int) -> Piece:
        """A power of a cosine or sine, by its short name if it has one."""
        if trig not in self.short:
            return self._called(trig, n)
        piece = self.language.abbreviation(trig.op, self.short[trig])
        return piece if n == 1 else self.language.power(piece, n)

    def spelled_out(self, trig: Trig) -> str:
        """A cosine or sine without its short name."""
        return self._called(trig, 1).text

    def _called(self, trig: Trig, n: int) -> Piece:
        angle = self._signed((c < 0, self._multiple(abs(c), a)) for a, c in trig.angle)
        return self.language.trig(trig.op, angle, n)

    def _multiple(self, c: Fraction, angle: Expr) -> Piece:
        """A part of an angle: a multiple of an atom, or a number of radians; pi/5 of a half turn."""
        if angle.is_number:
            return self.language.number(c * Fraction(angle.value))
        atom = self._atom(angle)
        if angle is angle.graph.pi and 1 < c.denominator <= DEGREES:
            above = self._multiple(Fraction(c.numerator), angle)
            return self.language.div(above, self.language.number(Fraction(c.denominator)))
        return atom if c == 1 else self.language.mul(self.language.number(c), atom)
