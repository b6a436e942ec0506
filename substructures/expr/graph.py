"""Scalar expressions as a hash-consed graph: one node per function (notation.md, section 8).

Every node carries the fingerprint of its formula (see :mod:`substructures.expr.fingerprint`), and the graph
keeps one node per fingerprint. Building a formula that is equal, as a function, to an existing one (or to its
negative) therefore returns the existing one: zero and one fold away, ``sin(q)**2 + cos(q)**2`` is ``1``,
rotations are orthonormal and the addition theorems apply themselves, all by one dictionary lookup.

>>> graph = Graph()
>>> x, y = graph.symbol("x"), graph.symbol("y")
>>> (x + y) * (x - y) is x * x - y * y
True
>>> x * 0, 2 * x / x
(0, 2)
"""

from __future__ import annotations

from collections.abc import Iterable
from decimal import Decimal
from fractions import Fraction
from typing import Any

from substructures.errors import TooLarge
from substructures.expr.exact import MAX_BITS, MAX_EXPONENT, split_square
from substructures.expr.fingerprint import PRIME, keyed, rational, square_root
from substructures.expr.patterns import coefficient, constant, has_number, square_of_root

ExactNumber = int | Fraction | Decimal


class Expr:
    """A node: operation, arguments, exact value (numbers) or name (symbols), fingerprint, creation index.

    ``is_number``: an exact integer or rational; ``negative``: a negative number, or a node of the form -x.
    """

    __slots__ = ("args", "fp", "graph", "index", "is_number", "negative", "op", "value")

    def __init__(self, graph: Graph, op: str, args: tuple[Expr, ...], value: Any, fp: int) -> None:
        self.graph = graph
        self.op = op
        self.args = args
        self.value = value
        self.fp = fp
        self.is_number = value is not None and op != "sym"
        self.negative = value < 0 if self.is_number else op == "neg"
        self.index = len(graph.table)
        graph.table[fp] = self

    @property
    def is_zero(self) -> bool:
        """True when the formula is the zero function."""
        return self.fp == 0

    def __add__(self, other: Expr | ExactNumber) -> Expr:
        x = other if isinstance(other, Expr) else self.graph.number(other)
        fp = (self.fp + x.fp) % PRIME
        found = self.graph.table.get(fp)
        return found if found is not None else self.graph._sum(self, x, fp)

    __radd__ = __add__

    def __sub__(self, other: Expr | ExactNumber) -> Expr:
        x = other if isinstance(other, Expr) else self.graph.number(other)
        fp = (self.fp - x.fp) % PRIME
        found = self.graph.table.get(fp)
        return found if found is not None else self.graph._difference(self, x, fp)

    def __rsub__(self, other: ExactNumber) -> Expr:
        return -self + other

    def __mul__(self, other: Expr | ExactNumber) -> Expr:
        x = other if isinstance(other, Expr) else self.graph.number(other)
        fp = self.fp * x.fp % PRIME
        found = self.graph.table.get(fp)
        return found if found is not None else self.graph._product(self, x, fp)

    __rmul__ = __mul__

    def __neg__(self) -> Expr:
        if self.op == "neg":
            return self.args[0]
        fp = PRIME - self.fp if self.fp else 0
        found = self.graph.table.get(fp)
        if found is not None:
            return found
        if self.is_number:
            return Expr(self.graph, self.op, (), -self.value, fp)
        return Expr(self.graph, "neg", (self,), None, fp)

    def __truediv__(self, other: Expr | ExactNumber) -> Expr:
        return self.graph._quotient(self, other if isinstance(other, Expr) else self.graph.number(other))

    def __rtruediv__(self, other: ExactNumber) -> Expr:
        return self.graph.number(other) / self

    def __pow__(self, n: int) -> Expr:
        if abs(n) > MAX_EXPONENT:
            raise ValueError(f"exponent {n} is beyond the limit of {MAX_EXPONENT}")
        if n < 0:
            return self.graph.one / self**-n
        result, square = self.graph.one, self
        while n:
            if n & 1:
                result = result * square
            n >>= 1
            if n:
                square = square * square
        return result

    def __repr__(self) -> str:
        if self.op in ("int", "rat", "sym"):
            return str(self.value)
        return f"<{self.op} {self.index}>"


class Graph:
    """The nodes of one derivation. Nodes of different graphs must not be mixed."""

    def __init__(self) -> None:
        self.table: dict[int, Expr] = {}
        self.zero = Expr(self, "int", (), 0, 0)
        self.one = Expr(self, "int", (), 1, 1)

    def __len__(self) -> int:
        return len(self.table)

    def number(self, value: ExactNumber) -> Expr:
        """An exact constant; a Decimal is taken as its decimal text. Floats are refused."""
        if isinstance(value, Decimal):
            value = Fraction(value)
        if isinstance(value, Fraction) and value.denominator == 1:
            value = value.numerator
        if not isinstance(value, (int, Fraction)) or isinstance(value, bool):
            raise TypeError(f"exact number expected, not {type(value).__name__}: {value!r}")
        fp = rational(value)
        return self.table.get(fp) or Expr(self, "int" if isinstance(value, int) else "rat", (), value, fp)

    def lift(self, value: Any) -> Expr:
        """An expression as it is, an exact number as :meth:`number` takes it: what is left of a sum of zeros, say."""
        return value if isinstance(value, Expr) else self.number(value)

    def symbol(self, name: str) -> Expr:
        """The symbol of this name."""
        fp = keyed("symbol", name)
        return self.table.get(fp) or Expr(self, "sym", (), name, fp)

    @property
    def pi(self) -> Expr:
        """pi, written acos(-1) in programs."""
        return self.function("acos", self.number(-1))

    def sum(self, terms: Iterable[Expr]) -> Expr:
        """Sum of any number of terms."""
        result = self.zero
        for term in terms:
            result = result + term
        return result

    def _sum(self, a: Expr, b: Expr, fp: int) -> Expr:
        found = self.table.get(PRIME - fp)
        if found is not None:
            return -found
        if a.is_number and b.is_number:
            return self._folded(a.value + b.value)
        collected = self._collected(a, b)
        if collected is not None:
            return collected
        if b.negative:
            if a.negative:
                return -Expr(self, "add", (-a, -b), None, PRIME - fp)
            return Expr(self, "sub", (a, -b), None, fp)
        if a.negative:
            return Expr(self, "sub", (b, -a), None, fp)
        return Expr(self, "add", (a, b), None, fp)

    def _difference(self, a: Expr, b: Expr, fp: int) -> Expr:
        if b.negative or a.negative or has_number(a) or has_number(b):
            return self._sum(a, -b, fp)
        found = self.table.get(PRIME - fp)
        return -found if found is not None else Expr(self, "sub", (a, b), None, fp)

    def _collected(self, a: Expr, b: Expr) -> Expr | None:
        """c x + d x = (c + d) x and (x + c) + (y + d) = (x + y) + (c + d) for exact numbers c, d."""
        if a is b:
            return self.number(2) * a
        if not (has_number(a) and has_number(b)):
            return None
        (c, x), (d, y) = coefficient(a), coefficient(b)
        if x is y:
            return self.number(c + d) * x
        (x, c), (y, d) = constant(a), constant(b)
        return (x + y) + self.number(c + d) if c and d else None

    def _product(self, a: Expr, b: Expr, fp: int) -> Expr:
        found = self.table.get(PRIME - fp)
        if found is not None:
            return -found
        if a.is_number and b.is_number:
            return self._folded(a.value * b.value)
        if a.negative or b.negative:
            positive = (-a if a.negative else a) * (-b if b.negative else b)
            return positive if positive.fp == fp else -positive
        if b.is_number:
            a, b = b, a
        if b.op == "mul" and b.args[0].is_number:
            return (a * b.args[0]) * b.args[1] if a.is_number else b.args[0] * (a * b.args[1])
        if a.op == "mul" and a.args[0].is_number:
            return a.args[0] * (a.args[1] * b)
        square = square_of_root(a, b) if a.op == "sqrt" or b.op == "sqrt" else None
        return square or Expr(self, "mul", (a, b), None, fp)

    def _quotient(self, a: Expr, b: Expr) -> Expr:
        if b.fp == 0:
            raise ZeroDivisionError("division by zero")
        if b.is_number:
            return a * self.number(Fraction(1) / b.value)
        fp = a.fp * pow(b.fp, -1, PRIME) % PRIME
        found = self.table.get(fp)
        if found is not None:
            return found
        if a.negative or b.negative:
            positive = (-a if a.negative else a) / (-b if b.negative else b)
            return positive if positive.fp == fp else -positive
        return Expr(self, "div", (a, b), None, fp)

    def _folded(self, value: int | Fraction) -> Expr:
        size = max(value.numerator.bit_length(), value.denominator.bit_length())
        if size > MAX_BITS:
            raise TooLarge("an exact number (in bits)", size, MAX_BITS)
        return self.number(value)

    def sqrt(self, x: Expr) -> Expr:
        """Principal square root; exact for squares of rationals."""
        if x.is_number:
            value = Fraction(x.value)
            if value < 0:
                raise ValueError(f"square root of the negative number {value}")
            outside, inside = split_square(value)
            root = self.number(outside)
            return root if inside == 1 else root * self.function("sqrt", self.number(inside))
        return self.function("sqrt", x)

    def function(self, op: str, *args: Expr) -> Expr:
        """A function the field knows nothing about, except the square roots of 2, 3, 5 and 7."""
        fp = square_root(args[0].value) if op == "sqrt" and args[0].op == "int" else None
        if fp is None:
            fp = keyed(op, *(a.fp for a in args))
        return self.table.get(fp) or Expr(self, op, args, None, fp)
