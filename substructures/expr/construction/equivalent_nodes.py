"""Which node may stand for which formula of the same fingerprint: one that asks for no more, and is as accurate.

Equality of functions does not suffice: (q^2 - 1)/(q - 1) has no value at 1, and (q + 4)(q + 9) - (q + 2)(q + 11) is 0
at q = 1e9. What a value of a node **asks** for is a set of bits: the symbols that occur in it, the factors of its
divisors whatever their signs and powers, the operands of its roots and of other partial functions. How large its
rounding errors can become is its **size** (:mod:`substructures.expr.construction.bounds`).

Both depend on the structure of a node alone. Most nodes are never compared with another structure, or only with one in
which operands are exchanged or signs stand elsewhere; asks and sizes of a node are found when they are first needed.
"""

from __future__ import annotations

from typing import Generic

from substructures.expr.construction import bounds
from substructures.expr.construction.bounds import ZERO, Values, is_as_accurate, larger, product
from substructures.expr.construction.exact import nearest_float
from substructures.expr.construction.fingerprint import PRIME
from substructures.expr.construction.patterns import N, is_combination

#: operations that have no value for some operands (division: see StandIns._divisors)
PARTIAL = frozenset(("sqrt", "log", "asin", "acos", "tan", "atan2"))
_ARITHMETIC = frozenset(("add", "sub", "mul", "neg"))
#: operations in which the order of the operands, and their signs, change nothing but the sign of the result
_UNORDERED = {"add": "sum", "sub": "sum", "mul": "product"}


class StandIns(Generic[N]):
    """What is known of the nodes of one graph: what they ask for, and their sizes."""

    def __init__(self) -> None:
        self._known: dict[N, tuple[int, int]] = {}
        self._bits: dict[tuple[str, int], int] = {}
        self._values: dict[N, Values] = {}

    def serves(self, found: N, op: str, args: tuple[N, ...]) -> bool:
        """Whether a node with the fingerprint of op(args) may stand for it; nothing may for a number."""
        if _is_alike(found, op, args):
            return True
        if op in _ARITHMETIC and all(a.is_number for a in args):
            return False
        asks, size = self._of(found)
        asked, larger_size = self._made(op, args, self._of(args[0]), self._of(args[-1]))
        return not asks & ~asked and is_as_accurate(size, larger_size)

    def _of(self, node: N) -> tuple[int, int]:
        """Asks and size of a node, from those of its operands."""
        known = self._known
        found = known.get(node)
        stack = [] if found else [node]
        while stack:
            top = stack.pop()
            args = top.args
            if not args:
                known[top] = self._leaf(top)
                continue
            a, b = known.get(args[0]), known.get(args[-1])
            if a and b:
                known[top] = self._made(top.op, args, a, b)
                continue
            stack.append(top)
            if not a:
                stack.append(args[0])
            if not b:
                stack.append(args[-1])
        return found or known[node]

    def _leaf(self, node: N) -> tuple[int, int]:
        if node.is_number:
            return 0, bounds.number_size(nearest_float(node.value))
        return self._bit("symbol", node.fp), bounds.symbol_size(node.value)

    def _made(self, op: str, args: tuple[N, ...], a: tuple[int, int], b: tuple[int, int]) -> tuple[int, int]:
        """Asks and size of an operation, from those of its first and last operand."""
        if op == "mul":
            return a[0] | b[0], product(a[1], b[1])
        if op in _ARITHMETIC:
            return a[0] | b[0], larger(a[1], b[1])
        return self._asked(op, args, a[0] | b[0]), self._size(op, args, a[1], b[1])

    def _asked(self, op: str, args: tuple[N, ...], asks: int) -> int:
        """What an operation asks for that has not always a value; ``asks``: what its operands do."""
        if op == "div":
            asks |= self._divisors(args[1])
        elif op in PARTIAL and not all(a.is_number for a in args):
            for a in args:
                asks |= self._bit(op, a.fp)
        return asks

    def _divisors(self, b: N) -> int:
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
        return self._bits.setdefault((kind, fp), 1 << len(self._bits))

    def _size(self, op: str, args: tuple[N, ...], a: int, b: int) -> int:
        """The size of a quotient or function; of angles it counts where they are no combinations."""
        if op == "div":
            return bounds.quotient(a, b, self._points(args[1]))
        if op == "sin":
            # |sin x| <= min(1, |x|)
            return bounds.smaller(ZERO, a) if is_combination(args[0]) else a
        if op == "cos":
            return ZERO if is_combination(args[0]) else larger(ZERO, a)
        if op == "atan2":
            return larger(ZERO, larger(a, b))
        # constants are exact
        return bounds.partial(op, None if args[0].is_number else a, self._points(args[0]))

    def _points(self, node: N) -> Values:
        """The values of a node at the points of :mod:`substructures.expr.construction.bounds`."""
        known, stack = self._values, [node]
        while stack:
            top = stack[-1]
            missing = [a for a in top.args if a not in known]
            stack += missing
            if not missing:
                known[stack.pop()] = _point(top, [known[a] for a in top.args])
        return known[node]


def _is_alike(found: N, op: str, args: tuple[N, ...]) -> bool:
    """The same operation on the same operands, but for signs and order, of which neither asks nor sizes know."""
    if found.op == op and found.args == args:
        return True
    kind = _UNORDERED.get(op)
    if kind is None:
        return False
    found, a, b = _unsigned(found), _unsigned(args[0]), _unsigned(args[1])
    if kind == "sum" and (a.fp == 0 or b.fp == 0):
        return found is a or found is b
    if _UNORDERED.get(found.op) != kind:
        return False
    x, y = _unsigned(found.args[0]), _unsigned(found.args[1])
    return (x is a and y is b) or (x is b and y is a)


def _unsigned(node: N) -> N:
    return node.args[0] if node.op == "neg" else node


def _point(node: N, args: list[Values]) -> Values:
    """The values of a node from those of its operands."""
    if args:
        return bounds.values_of(node.op, *args)
    if node.op == "sym":
        return bounds.symbol_values(node.value)
    return (nearest_float(node.value),) * bounds.POINTS
