"""Products of parameters first: a (b x) = (a b) x, one operation of each state fewer, where b x is used nowhere else.

What depends on parameters alone is computed once for all states.

>>> from substructures.expr.graph import Graph
>>> from substructures.expr.operations import Symbol
>>> from substructures.expr.program import array, program
>>> g = Graph()
>>> a, b, x = map(g.symbol, "abx")
>>> kinds = {"a": "parameter", "b": "parameter", "x": "coordinate"}
>>> symbols = {name: Symbol(name, kind) for name, kind in kinds.items()}
>>> before = program(g, {"y": array((), lambda: a * (b * x))}, symbols)
>>> after = hoisted(before)
>>> [(each.count()["total"], each.count(per_state=True)["total"]) for each in (before, after)]
[(2, 2), (2, 1)]
"""

from __future__ import annotations

from fractions import Fraction

from substructures.expr.operations import BINARY, Operation, Output
from substructures.expr.program import Program, operands, renumbered

NUMBERS = ("int", "rat")


def hoisted(source: Program) -> Program:
    """The same functions, up to rounding, with no more operations, and fewer of them for each state."""
    operations, varies = source.operations, source.of_state
    uses = uses_of(source)
    write = _Writer()
    waiting, symbols = write.waiting, {k: k for k in range(len(source.symbols))}
    for i, operation in enumerate(operations):
        op = operation[0]
        if op == "mul":
            a, b = operation[1], operation[2]
            if varies[a] != varies[b]:
                factor, rest = (a, b) if varies[b] else (b, a)
                if rest in waiting and uses[rest] == 1:
                    inner, core = waiting.pop(rest)
                    waiting[i] = write.product(write.place(factor), inner), core
                else:
                    waiting[i] = write.place(factor), write.place(rest)
            else:
                write.new[i] = write.product(write.place(a), write.place(b))
            continue
        if op in ("add", "sub"):
            operation = op, write.place(operation[1]), write.place(operation[2])
        else:
            for x in operands(operation):
                write.place(x)
            operation = renumbered(operation, write.new, symbols)
        write.new[i] = len(write.made)
        write.made.append(operation)
    outputs = {
        name: Output(o.shape, o.index, tuple(map(write.place, o.entries)), o.symmetry)
        for name, o in source.outputs.items()
    }
    return Program(source.symbols, tuple(write.made), outputs, source.not_judged)


class _Writer:
    def __init__(self) -> None:
        self.made: list[Operation] = []
        self.new: dict[int, int] = {}
        #: products that are not written yet: of a factor without state, and the rest
        self.waiting: dict[int, tuple[int, int]] = {}
        self._products: dict[tuple[int, int], int] = {}

    def place(self, old: int) -> int:
        """The new number of an operation; a product that was waiting is written."""
        found = self.new.get(old)
        if found is None:
            found = self.new[old] = self.product(*self.waiting.pop(old))
        return found

    def product(self, a: int, b: int) -> int:
        """The number of a product."""
        key = (a, b) if a < b else (b, a)
        found = self._products.get(key)
        if found is None:
            found = self._products[key] = len(self.made)
            one, other = self.made[a], self.made[b]
            are_numbers = one[0] in NUMBERS and other[0] in NUMBERS
            self.made.append(_operation(_number(one) * _number(other)) if are_numbers else ("mul", a, b))
        return found


def _number(operation: Operation) -> Fraction:
    return Fraction(*map(int, operation[1:]))


def _operation(x: Fraction) -> Operation:
    return ("int", str(x.numerator)) if x.denominator == 1 else ("rat", str(x.numerator), str(x.denominator))


def uses_of(source: Program) -> list[int]:
    """How often each operation is an operand or an entry of an output."""
    found = [0] * len(source)
    for operation in source.operations:
        if operation[0] in BINARY:
            found[operation[1]] += 1
            found[operation[2]] += 1
        else:
            for x in operands(operation):
                found[x] += 1
    for output in source.outputs.values():
        for x in output.entries:
            found[x] += 1
    return found
