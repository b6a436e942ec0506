"""Scalar expressions as a hash-consed graph (notation.md, section 8).

Every node carries the fingerprint of its formula (:mod:`substructures.expr.construction.fingerprint`): building one
that is equal, as a function, to an existing one (or to its negative) returns the existing one, so that 0 and 1 fold
away, ``sin(q)**2 + cos(q)**2`` is ``1``, rotations are orthonormal and the addition theorems apply themselves, all by
one dictionary lookup. Equality of functions alone does not suffice for that:

* an existing node is taken only where it **asks for no more** than what is built: it depends on no other symbols,
  divides by nothing else, takes no other roots and logarithms, and rounding moves it no more
  (:mod:`substructures.expr.construction.equivalent_nodes`);
* numbers and symbols are always literal nodes, numbers of at most ``MAX_BITS`` bits;
* signs follow from the structure, never from fingerprints: a root's square has another one than what is under it.

>>> graph = Graph()
>>> x, y = graph.symbol("x"), graph.symbol("y")
>>> (x + y) * (x - y) is x * x - y * y
True
>>> x * 0, 2 * x / x
(0, 2)
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any

from substructures.errors import TooLarge
from substructures.expr.construction.equivalent_nodes import StandIns
from substructures.expr.construction.exact import MAX_BITS, MAX_EXPONENT, split_square
from substructures.expr.construction.fingerprint import PRIME, keyed, rational, square_root
from substructures.expr.construction.folding import folded_difference, folded_product, folded_quotient, folded_sum

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
        self.index = len(graph.nodes)
        graph.nodes.append(self)

    @property
    def is_zero(self) -> bool:
        """True when the formula is the zero function."""
        return self.fp == 0

    def __add__(self, other: Expr | ExactNumber) -> Expr:
        x = other if isinstance(other, Expr) else self.graph.number(other)
        fp = (self.fp + x.fp) % PRIME
        found = self.graph.table.get(fp)
        if found is not None and (
            not found.args or found is self or found is x or self.graph.serves(found, "add", self, x)
        ):
            return found
        return folded_sum(self.graph, self, x, fp)

    __radd__ = __add__

    def __sub__(self, other: Expr | ExactNumber) -> Expr:
        x = other if isinstance(other, Expr) else self.graph.number(other)
        fp = (self.fp - x.fp) % PRIME
        found = self.graph.table.get(fp)
        if found is not None and (not found.args or found is self or self.graph.serves(found, "sub", self, x)):
            return found
        return folded_difference(self.graph, self, x, fp)

    def __rsub__(self, other: ExactNumber) -> Expr:
        return -self + other

    def __mul__(self, other: Expr | ExactNumber) -> Expr:
        x = other if isinstance(other, Expr) else self.graph.number(other)
        fp = self.fp * x.fp % PRIME
        found = self.graph.table.get(fp)
        if found is not None and (
            not found.args or found is self or found is x or self.graph.serves(found, "mul", self, x)
        ):
            return found
        return folded_product(self.graph, self, x, fp)

    __rmul__ = __mul__

    def __neg__(self) -> Expr:
        if self.op == "neg":
            return self.args[0]
        if self.is_number:
            return self.graph.number(-self.value)
        fp = PRIME - self.fp
        found = self.graph.table.get(fp)
        if found is not None and (not found.args or self.graph.serves(found, "neg", self)):
            return found
        return self.graph.node("neg", (self,), fp)

    def __truediv__(self, other: Expr | ExactNumber) -> Expr:
        return folded_quotient(self.graph, self, other if isinstance(other, Expr) else self.graph.number(other))

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


@dataclass(frozen=True)
class GraphState:
    """The nodes of a graph, and how they are found."""

    nodes: list[Expr]
    table: dict[int, Expr]
    others: dict[tuple[str, tuple[Expr, ...]], Expr]
    numbers: dict[int | Fraction, Expr]
    symbols: dict[str, Expr]

    def copy(self) -> GraphState:
        """One that does not grow with this one."""
        found = dict(self.table), dict(self.others), dict(self.numbers), dict(self.symbols)
        return GraphState(list(self.nodes), *found)


class Graph:
    """The nodes of one derivation. Nodes of different graphs must not be mixed."""

    def __init__(self) -> None:
        self.nodes: list[Expr] = []
        # the best node of every fingerprint; others that were asked for beside it, by structure
        self.table: dict[int, Expr] = {}
        self.others: dict[tuple[str, tuple[Expr, ...]], Expr] = {}
        self.stand_ins: StandIns[Expr] = StandIns()
        self.numbers: dict[int | Fraction, Expr] = {}
        self.symbols: dict[str, Expr] = {}
        self.zero = self.number(0)
        self.one = self.number(1)

    def __len__(self) -> int:
        return len(self.nodes)

    def state(self) -> GraphState:
        """What there is now, and grows with the graph until another state is restored."""
        return GraphState(self.nodes, self.table, self.others, self.numbers, self.symbols)

    def restore(self, state: GraphState) -> None:
        """Go on from a state, or from a copy of it; nodes that are not in it must not be used any more."""
        self.nodes, self.table, self.others = state.nodes, state.table, state.others
        self.numbers, self.symbols = state.numbers, state.symbols

    def release(self) -> None:
        """Forget all nodes, none of which may be used any more: each refers to the graph, and it to them, a cycle that
        Python's collector would have to find."""
        for known in (self.nodes, self.table, self.others, self.numbers, self.symbols):
            known.clear()
        del self.zero, self.one, self.stand_ins

    def number(self, value: ExactNumber) -> Expr:
        """An exact constant; a Decimal is taken as its decimal text. Floats are refused.

        Raises TooLarge for more than ``MAX_BITS`` bits in numerator or denominator.
        """
        if type(value) is int:
            return self.numbers.get(value) or self._number(value)
        if isinstance(value, Decimal):
            value = Fraction(value)
        if isinstance(value, Fraction) and value.denominator == 1:
            value = value.numerator
        if not isinstance(value, (int, Fraction)) or isinstance(value, bool):
            raise TypeError(f"exact number expected, not {type(value).__name__}: {value!r}")
        return self.numbers.get(value) or self._number(value)

    def _number(self, value: int | Fraction) -> Expr:
        size = max(value.numerator.bit_length(), value.denominator.bit_length())
        if size > MAX_BITS:
            raise TooLarge("an exact number (in bits)", size, MAX_BITS)
        fp = rational(value)
        found = Expr(self, "int" if isinstance(value, int) else "rat", (), value, fp)
        self.numbers[value] = self.table[fp] = found
        return found

    def lift(self, value: Any) -> Expr:
        """An expression as it is, an exact number as :meth:`number` takes it: what is left of a sum of zeros, say."""
        return value if isinstance(value, Expr) else self.number(value)

    def symbol(self, name: str) -> Expr:
        """The symbol of this name."""
        found = self.symbols.get(name)
        if found is None:
            fp = keyed("symbol", name)
            found = Expr(self, "sym", (), name, fp)
            self.symbols[name] = self.table[fp] = found
        return found

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

    def serves(self, found: Expr, op: str, *args: Expr) -> bool:
        """Whether a node with the fingerprint of op(args) may stand for it: it asks for no more."""
        return self.stand_ins.serves(found, op, args)

    def node(self, op: str, args: tuple[Expr, ...], fp: int) -> Expr:
        """The node of exactly this structure; the table keeps what serves best for its fingerprint."""
        best = self.table.get(fp)
        if best is None:
            found = self.table[fp] = Expr(self, op, args, None, fp)
            return found
        if best.op == op and best.args == args:
            return best
        other = self.others.get((op, args))
        if other is not None:
            return other
        found = Expr(self, op, args, None, fp)
        if self.serves(found, best.op, *best.args):
            self.others[best.op, best.args] = best
            self.table[fp] = found
        else:
            self.others[op, args] = found
        return found

    def sqrt(self, x: Expr) -> Expr:
        """Principal square root; exact for squares of rationals."""
        if not x.is_number:
            return self.function("sqrt", x)
        value = Fraction(x.value)
        if value < 0:
            raise ValueError(f"square root of the negative number {value}")
        outside, inside = split_square(value)
        root = self.number(outside)
        return root if inside == 1 else root * self.function("sqrt", self.number(inside))

    def function(self, op: str, *args: Expr) -> Expr:
        """A function the field knows nothing about, except the square roots of 2, 3, 5 and 7."""
        fp = square_root(args[0].value) if op == "sqrt" and args[0].op == "int" else None
        if fp is None:
            fp = keyed(op, *(a.fp for a in args))
        found = self.table.get(fp)
        if found is not None and (not found.args or self.serves(found, op, *args)):
            return found
        return self.node(op, args, fp)
