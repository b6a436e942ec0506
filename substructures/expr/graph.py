"""Scalar expressions as a hash-consed graph (notation.md, section 8).

Every node carries the fingerprint of its formula (see :mod:`substructures.expr.fingerprint`): building a formula that
is equal, as a function, to an existing one (or to its negative) returns the existing one, so that zero and one fold
away, ``sin(q)**2 + cos(q)**2`` is ``1``, rotations are orthonormal and the addition theorems apply themselves, all by
one dictionary lookup. Equality of functions alone does not suffice for that:

* an existing node is taken only where it **asks for no more** than what is built: it depends on no other symbols,
  divides by nothing else, takes no other roots and logarithms (``Expr.asks``), and rounding moves it no more
  (:mod:`substructures.expr.bounds`);
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

from collections.abc import Iterable, Mapping
from decimal import Decimal
from fractions import Fraction
from typing import Any

from substructures.errors import TooLarge
from substructures.expr import bounds
from substructures.expr.bounds import GUARDS, SLACK, UNKNOWN, ZERO, Values, is_as_accurate, larger
from substructures.expr.exact import MAX_BITS, MAX_EXPONENT, nearest_float, split_square
from substructures.expr.fingerprint import PRIME, keyed, rational, square_root
from substructures.expr.patterns import coefficient, constant, has_number, is_combination, square_of_root

ExactNumber = int | Fraction | Decimal
#: operations that have no value for some operands (division: see _divisors)
PARTIAL = frozenset(("sqrt", "log", "asin", "acos", "tan", "atan2"))
TOTAL = frozenset(("add", "sub", "mul", "neg"))


class Expr:
    """A node: operation, arguments, exact value (numbers) or name (symbols), fingerprint, creation index.

    ``is_number``: an exact integer or rational; ``negative``: a negative number, or a node of the form -x.
    ``asks``: what a value of it needs, as bits: symbols, divisors and arguments of partial functions;
    ``size``: how large its rounding errors can become (:mod:`substructures.expr.bounds`).
    """

    __slots__ = ("args", "asks", "fp", "graph", "index", "is_number", "negative", "op", "size", "value")

    def __init__(
        self, graph: Graph, op: str, args: tuple[Expr, ...], value: Any, fp: int, asks: int, size: int
    ) -> None:
        self.graph = graph
        self.op = op
        self.args = args
        self.value = value
        self.fp = fp
        self.asks = asks
        self.size = size
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
        # what Graph.serves says, for the operation that is asked for most
        if found is not None and (
            not found.args
            or (
                (asks := self.asks | x.asks) | found.asks == asks
                and is_as_accurate(found.size, larger(self.size, x.size))
                and not (self.is_number and x.is_number)
            )
        ):
            return found
        return self.graph._sum(self, x, fp)

    __radd__ = __add__

    def __sub__(self, other: Expr | ExactNumber) -> Expr:
        x = other if isinstance(other, Expr) else self.graph.number(other)
        fp = (self.fp - x.fp) % PRIME
        found = self.graph.table.get(fp)
        if found is not None and (not found.args or self.graph.serves(found, "sub", self, x)):
            return found
        return self.graph._difference(self, x, fp)

    def __rsub__(self, other: ExactNumber) -> Expr:
        return -self + other

    def __mul__(self, other: Expr | ExactNumber) -> Expr:
        x = other if isinstance(other, Expr) else self.graph.number(other)
        fp = self.fp * x.fp % PRIME
        found = self.graph.table.get(fp)
        if found is not None and (
            not found.args
            or (
                (asks := self.asks | x.asks) | found.asks == asks
                and ((self.size + x.size - ZERO + SLACK) | GUARDS) - found.size & GUARDS == GUARDS
                and not (self.is_number and x.is_number)
            )
        ):
            return found
        return self.graph._product(self, x, fp)

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


def _size(op: str, args: tuple[Expr, ...]) -> int:
    """The size of an operation from those of its operands; of angles it counts where they are no plain combinations."""
    a, b = args[0], args[-1]
    if op in ("add", "sub"):
        return larger(a.size, b.size)
    if op == "mul":
        return bounds.product(a.size, b.size)
    if op == "neg":
        return a.size
    if op == "div":
        return bounds.quotient(a.size, b.size, a.graph.points(b))
    if op == "sin":
        # |sin x| <= min(1, |x|)
        return bounds.smaller(ZERO, a.size) if is_combination(a) else a.size
    if op == "cos":
        return ZERO if is_combination(a) else larger(ZERO, a.size)
    if op == "atan2":
        return larger(ZERO, larger(a.size, b.size))
    # constants are exact
    return bounds.partial(op, None if a.is_number else a.size, a.graph.points(a))


def _point(node: Expr, known: Mapping[Expr, Values]) -> Values:
    """The values of a node whose operands have theirs."""
    if node.args:
        return bounds.values_of(node.op, *(known[a] for a in node.args))
    if node.op == "sym":
        return bounds.symbol_values(node.value)
    return (nearest_float(node.value),) * bounds.POINTS


class Graph:
    """The nodes of one derivation. Nodes of different graphs must not be mixed."""

    def __init__(self) -> None:
        self.nodes: list[Expr] = []
        # the best node of every fingerprint; others that were asked for beside it, by structure
        self.table: dict[int, Expr] = {}
        self.others: dict[tuple[str, tuple[Expr, ...]], Expr] = {}
        self.bits: dict[tuple[str, int], int] = {}
        self.numbers: dict[int | Fraction, Expr] = {}
        self.symbols: dict[str, Expr] = {}
        self._points: dict[Expr, Values] = {}
        self.zero = self.number(0)
        self.one = self.number(1)

    def __len__(self) -> int:
        return len(self.nodes)

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
        size = bounds.number_size(nearest_float(value))
        found = Expr(self, "int" if isinstance(value, int) else "rat", (), value, fp, 0, size)
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
            found = Expr(self, "sym", (), name, fp, self._bit("symbol", fp), bounds.symbol_size(name))
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

    def node(self, op: str, args: tuple[Expr, ...], fp: int) -> Expr:
        """The node of exactly this structure; the table keeps what serves best for its fingerprint."""
        best = self.table.get(fp)
        if best is not None:
            return self._beside(best, op, args, fp)
        a, b = args[0], args[-1]
        # what _asks and _size say, for the operations that are asked for most
        if op == "mul":
            size = a.size + b.size - ZERO
            found = Expr(self, op, args, None, fp, a.asks | b.asks, UNKNOWN if size & GUARDS else size)
        elif op in ("add", "sub"):
            found = Expr(self, op, args, None, fp, a.asks | b.asks, larger(a.size, b.size))
        elif op == "neg":
            found = Expr(self, op, args, None, fp, a.asks, a.size)
        else:
            found = Expr(self, op, args, None, fp, self._asks(op, args), _size(op, args))
        self.table[fp] = found
        return found

    def _beside(self, best: Expr, op: str, args: tuple[Expr, ...], fp: int) -> Expr:
        """A node of the same fingerprint as another one, which it replaces in the table where it serves for it."""
        if best.op == op and best.args == args:
            return best
        other = self.others.get((op, args))
        if other is not None:
            return other
        size = _size(op, args)
        found = Expr(self, op, args, None, fp, self._asks(op, args), size)
        if not found.asks & ~best.asks and is_as_accurate(size, best.size):
            self.others[best.op, best.args] = best
            self.table[fp] = found
        else:
            self.others[op, args] = found
        return found

    def points(self, node: Expr) -> Values:
        """The values of a node at the points of :mod:`substructures.expr.bounds`."""
        known, stack = self._points, [node]
        while stack:
            top = stack[-1]
            missing = [a for a in top.args if a not in known]
            stack += missing
            if not missing:
                known[stack.pop()] = _point(top, known)
        return known[node]

    def serves(self, found: Expr, op: str, *args: Expr) -> bool:
        """Whether a node with the fingerprint of op(args) may stand for it: it asks for no more."""
        if found.op == op and found.args == args:
            return True
        return not found.asks & ~self._asks(op, args) and is_as_accurate(found.size, _size(op, args))

    def _asks(self, op: str, args: tuple[Expr, ...]) -> int:
        asks = args[0].asks
        if len(args) == 2:
            asks |= args[1].asks
        if op in TOTAL:
            return asks
        if op == "div":
            asks |= self._divisors(args[1])
        elif op in PARTIAL and not all(a.is_number for a in args):
            for a in args:
                asks |= self._bit(op, a.fp)
        return asks

    def _divisors(self, b: Expr) -> int:
        """The bits of the factors of a divisor, whatever their signs and powers."""
        bits, stack, seen = 0, [b], {b}
        while stack:
            node = stack.pop()
            if node.op in ("mul", "neg"):
                new = [a for a in node.args if a not in seen]
                seen.update(new)
                stack += new
            elif not node.is_number:
                bits |= self._bit("div", min(node.fp, PRIME - node.fp))
        return bits

    def _bit(self, kind: str, fp: int) -> int:
        return self.bits.setdefault((kind, fp), 1 << len(self.bits))

    def _sum(self, a: Expr, b: Expr, fp: int) -> Expr:
        found = self.table.get(PRIME - fp)
        if found is not None and (not found.args or self.serves(found, "add", a, b)):
            return -found
        if a.is_number or b.is_number:
            # x + 0 is x, also where another node serves best for its fingerprint
            if a.fp == 0 or b.fp == 0:
                return b if a.fp == 0 else a
            if a.is_number and b.is_number:
                return self.number(a.value + b.value)
        collected = self._collected(a, b)
        if collected is not None:
            return collected
        if b.negative:
            if a.negative:
                return -self.node("add", (-a, -b), PRIME - fp)
            return self.node("sub", (a, -b), fp)
        if a.negative:
            return self.node("sub", (b, -a), fp)
        return self.node("add", (a, b), fp)

    def _difference(self, a: Expr, b: Expr, fp: int) -> Expr:
        if b.negative or a.negative or has_number(a) or has_number(b):
            return self._sum(a, -b, fp)
        found = self.table.get(PRIME - fp)
        if found is not None and (not found.args or self.serves(found, "sub", a, b)):
            return -found
        return self.node("sub", (a, b), fp)

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
        if found is not None and (not found.args or self.serves(found, "mul", a, b)):
            return -found
        if a.is_number or b.is_number:
            if a is self.one or b is self.one:
                return b if a is self.one else a
            if a.is_number and b.is_number:
                return self.number(a.value * b.value)
        if a.negative or b.negative:
            positive = (-a if a.negative else a) * (-b if b.negative else b)
            return positive if a.negative == b.negative else -positive
        if b.is_number:
            a, b = b, a
        if b.op == "mul" and b.args[0].is_number:
            return (a * b.args[0]) * b.args[1] if a.is_number else b.args[0] * (a * b.args[1])
        if a.op == "mul" and a.args[0].is_number:
            return a.args[0] * (a.args[1] * b)
        square = square_of_root(a, b) if a.op == "sqrt" or b.op == "sqrt" else None
        return square or self.node("mul", (a, b), fp)

    def _quotient(self, a: Expr, b: Expr) -> Expr:
        if b.fp == 0:
            raise ZeroDivisionError("division by zero")
        if b.is_number:
            return a * self.number(Fraction(1) / b.value)
        fp = a.fp * pow(b.fp, -1, PRIME) % PRIME
        found = self.table.get(fp)
        if found is not None and (not found.args or self.serves(found, "div", a, b)):
            return found
        if a.negative or b.negative:
            positive = (-a if a.negative else a) / (-b if b.negative else b)
            return positive if a.negative == b.negative else -positive
        return self.node("div", (a, b), fp)

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
