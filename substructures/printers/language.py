"""What a language must know to write formulas: numbers, names and operations, with precedences."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from types import MappingProxyType
from typing import ClassVar, NamedTuple

from substructures.expr.program import Program, Symbol
from substructures.printers.meanings import Label
from substructures.printers.numbers import has_decimals, shortest_decimal

SUM, NEGATION, PRODUCT, POWER, ATOM = range(5)


class Piece(NamedTuple):
    """A formula as text, with the precedence of its outermost operation.

    ``closed``: where it ends with an argument without parentheses, cos q, the same with them, as before another factor.
    """

    text: str
    precedence: int = ATOM
    closed: str = ""


@dataclass(frozen=True, slots=True)
class Listing:
    """``temporaries`` are (number, formula), each using earlier ones only; ``entries`` go with the outputs' index.

    ``abbreviations`` are (name, formula), used by all others; ``definitions`` are (name, formula, note) of symbols.
    """

    temporaries: tuple[tuple[int, str], ...]
    entries: Mapping[str, tuple[str, ...]]
    abbreviations: tuple[tuple[str, str], ...] = ()
    definitions: tuple[tuple[str, str, str], ...] = ()


class Language(ABC):
    """Base of all languages; writes formulas as most of them do. Make one for each program.

    ``width``: longer formulas become temporaries; ``powers``: whether squares are written as powers;
    ``first``: number of the first element of an array.
    """

    media = "text/plain; charset=utf-8"
    width = 80
    powers = True
    first = 0
    #: whether people read it: names of the only instance are left out of textbook forms, c12 is cos(q1 + q2)
    is_for_people = False
    #: whether letters may have a bar
    bars = False
    #: what else is to be said about names
    remark = ""
    #: what letters mean, a line each
    legend: Sequence[str] = ()
    #: by operation what it is called in mechanics; those become temporaries, however often they are used
    meanings: Mapping[int, Label] = MappingProxyType({})
    times, power_sign = "*", "^"
    functions: ClassVar[Mapping[str, str]] = {}

    def __init__(self, program: Program) -> None:
        self.program = program
        self._called: dict[int, Label | int] = {}
        #: numbers of the symbols that are said to occur; None: all of the program
        self.occurring: frozenset[int] | None = None
        #: whether 1/2 is 0.5, since other numbers of the formula are decimal numbers
        self.decimals = False

    @abstractmethod
    def render(self, listing: Listing, name: str) -> str:
        """The whole text."""

    @property
    def described(self) -> list[tuple[int, Symbol]]:
        """The symbols that readers are told about, with their numbers."""
        found = enumerate(self.program.symbols)
        return [(n, s) for n, s in found if self.occurring is None or n in self.occurring]

    def symbol(self, n: int) -> Piece:
        """Symbol number n of the program."""
        return Piece(f"x[{n + self.first}]")

    def temporary(self, n: int) -> Piece:
        """Temporary number n, from 1."""
        return Piece(f"t{n}")

    def call_temporary(self, n: int, operation: int) -> Piece:
        """Temporary number n, which is this operation: by what it means, or else by a number of its own."""
        if not self.meanings:
            return self.temporary(n)
        label = self.meanings.get(operation)
        self._called[n] = 1 + sum(isinstance(x, int) for x in self._called.values()) if label is None else label
        return self.step(n)

    def step(self, n: int) -> Piece:
        """What temporary number n is called."""
        found = self._called.get(n, n)
        return self.temporary(found) if isinstance(found, int) else self.labelled(found)

    def labelled(self, label: Label) -> Piece:
        """A quantity of mechanics."""
        return Piece(label.text)

    def look(self, text: str) -> str:
        """What readers tell a name from others by."""
        return text

    @cached_property
    def taken(self) -> frozenset[str]:
        """Looks of symbols and of elements of outputs, which nothing else may have."""
        symbols = (self.symbol(n).text for n in range(len(self.program.symbols)))
        return frozenset(map(self.look, (*symbols, *self.lefts())))

    def lefts(self) -> Iterator[str]:
        """What the elements of outputs are called."""
        yield from ()

    def is_free(self, piece: Piece) -> bool:
        """Whether no symbol and no element of an output looks like that."""
        return self.look(piece.text) not in self.taken

    @cached_property
    def one(self) -> Piece:
        """The number 1."""
        return self.number(Fraction(1))

    def pi(self) -> Piece:
        """The constant pi."""
        return Piece("pi")

    def number(self, value: Fraction) -> Piece:
        """An exact constant as people write it: an integer, a simple fraction, a decimal number where it is one."""
        if value <= 0:
            return self.neg(self.number(-value)) if value else self.scientific("0", 0)
        found = shortest_decimal(value) if self.decimals or self.is_decimal(value) else None
        return self.fraction(value.numerator, value.denominator) if found is None else self.scientific(*found)

    def is_decimal(self, value: Fraction) -> bool:
        """Whether it is an integer, or a decimal number and no simple fraction."""
        return value.denominator == 1 or has_decimals([value])

    def fraction(self, above: int, below: int) -> Piece:
        """A quotient of integers."""
        return Piece(f"{above}/{below}", PRODUCT)

    def scientific(self, mantissa: str, exponent: int) -> Piece:
        """mantissa * 10^exponent."""
        return Piece(f"{mantissa}e{exponent}" if exponent else mantissa)

    def trig(self, op: str, angle: Piece, power: int) -> Piece:
        """A power of a cosine or sine."""
        piece = self.call(op, [angle])
        return piece if power == 1 else self.power(piece, power)

    def abbreviation(self, op: str, digits: str) -> Piece:
        """What cos or sin of a sum of numbered angles is called."""
        return Piece(op[0] + digits)

    def is_too_wide(self, above: Piece, below: Piece) -> bool:  # noqa: ARG002 - here a line has room for all
        """Whether a fraction has no room for both."""
        return False

    def finished(self, text: str) -> str:
        """A whole formula, as it stands alone."""
        return text

    def inside(self, piece: Piece, least: int) -> str:
        """Text of an operand, in parentheses when it binds less than demanded."""
        return piece.text if piece.precedence >= least else self.parentheses(piece.text)

    def before(self, a: Piece, right: str) -> str:
        """Text of a factor before another one: cos(q) m, since cos q m is the cosine of q m; but cos q sin p."""
        left = self.inside(a, PRODUCT)
        return a.closed if a.closed and left == a.text and not self.begins_with_function(right) else left

    def begins_with_function(self, text: str) -> bool:  # noqa: ARG002 - here arguments have parentheses
        """Whether a factor is a cosine or the like, which no argument without parentheses goes on with."""
        return False

    def parentheses(self, text: str) -> str:
        """The text in parentheses."""
        return f"({text})"

    def add(self, a: Piece, b: Piece) -> Piece:
        """a + b."""
        if b.text.startswith("-"):
            if b.precedence == NEGATION:
                return Piece(f"{a.text} - {b.text[1:]}", SUM)
            return Piece(f"{a.text} + {self.parentheses(b.text)}", SUM)
        return Piece(f"{a.text} + {b.text}", SUM)

    def sub(self, a: Piece, b: Piece) -> Piece:
        """a - b."""
        return Piece(f"{a.text} - {self.inside(b, PRODUCT)}", SUM)

    def neg(self, a: Piece) -> Piece:
        """-a."""
        return Piece("-" + self.inside(a, PRODUCT), NEGATION)

    def mul(self, a: Piece, b: Piece) -> Piece:
        """a * b."""
        return Piece(f"{self.inside(a, PRODUCT)}{self.times}{self.inside(b, PRODUCT)}", PRODUCT)

    def div(self, a: Piece, b: Piece) -> Piece:
        """a / b."""
        return Piece(f"{self.inside(a, PRODUCT)}/{self.inside(b, POWER)}", PRODUCT)

    def power(self, a: Piece, n: int) -> Piece:
        """a to the integer n."""
        exponent = str(n) if n >= 0 else f"({n})"
        return Piece(f"{self.inside(a, ATOM)}{self.power_sign}{exponent}", POWER)

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A function of the closed set."""
        return Piece(f"{self.functions.get(op, op)}({', '.join(a.text for a in args)})")

    def write(self, op: str, args: list[Piece]) -> Piece:
        """An operation of a program (``powi`` excepted)."""
        if op == "add":
            return self.add(*args)
        if op == "sub":
            return self.sub(*args)
        if op == "mul":
            return self.power(args[0], 2) if self.powers and args[0] == args[1] else self.mul(*args)
        if op == "div":
            return self.div(*args)
        return self.neg(*args) if op == "neg" else self.call(op, args)
