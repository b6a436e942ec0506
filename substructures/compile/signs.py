"""The sign with which a value is kept: formulas have signs outside, -x, and what x is made of turns it for nothing.

-(a - b) is b - a; where -x is kept in the place of x, a + x is a - (-x); and -(a b) - c is one instruction where
a b + c is one. Sums keep their roundings: only the sign of a zero may be another one.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

from substructures.expr.operations import Operation, operands

#: operations that may be kept as their negatives
KEPT = frozenset(("add", "sub", "mul"))
#: values that change their signs together, at most
MOST = 12


def negatives(ops: Sequence[Operation], needed: Sequence[int], results: Iterable[int], fused: bool = True) -> set[int]:
    """Operations to be kept as their negatives, so that fewer signs remain to be turned.

    ``needed``: in the order of computation; ``results``: what is used outside, or shall keep its sign; ``fused``:
    whether a product and a sum are one instruction.
    """
    signs = _Signs(ops, needed, results, fused)
    for i in needed:
        if ops[i][0] == "neg" and ops[i][1] not in signs.minus:
            signs.turn(ops[i][1])
    return signs.minus


class _Signs:
    def __init__(self, ops: Sequence[Operation], needed: Sequence[int], results: Iterable[int], fused: bool) -> None:
        self.ops, self.fused, self.minus = ops, fused, set[int]()
        self.users: dict[int, list[int]] = defaultdict(list)
        self.fixed = set(results)
        for i in needed:
            operation = ops[i]
            used = operation[1:] if operation[0] in KEPT else operands(operation)
            for x in used:
                self.users[x].append(i)
            if operation[0] not in KEPT and operation[0] != "neg":
                self.fixed.update(used)

    def turn(self, x: int) -> None:
        """Keep -x in the place of x, with what this asks for, if that leaves fewer signs."""
        chosen = self._together(x)
        if chosen is None:
            return
        touched = chosen.union(*(self.users[k] for k in chosen))
        before = sum(map(self._signs_at, touched))
        self.minus ^= chosen
        if sum(map(self._signs_at, touched)) >= before:
            self.minus ^= chosen

    def _together(self, x: int) -> set[int] | None:
        """Products change with their factors, sums of two pluses with one of their operands."""
        chosen, waiting = {x}, [x]
        while waiting:
            k = waiting.pop()
            if k in self.fixed or self.ops[k][0] not in KEPT or len(chosen) > MOST:
                return None
            more = {u for u in self.users[k] if self.ops[u][0] == "mul"}
            within = self.ops[k][1:]
            if self.ops[k][0] != "sub" and chosen.isdisjoint(within) and not self._has_product(k):
                more.update([y for y in within if self.ops[y][0] in KEPT and len(self.users[y]) == 1][:1])
            waiting += sorted(more - chosen)
            chosen |= more
        return chosen

    def _has_product(self, k: int) -> bool:
        """Whether it is a sum with a product of its own, which goes into one instruction with it."""
        own = (x for x in self.ops[k][1:] if len(self.users[x]) == 1 and x not in self.fixed)
        return self.fused and self.ops[k][0] != "mul" and any(self.ops[x][0] == "mul" for x in own)

    def _signs_at(self, i: int) -> bool:
        """Whether an operation has to turn a sign."""
        if self.ops[i][0] not in KEPT:
            return self.ops[i][0] == "neg" and self.ops[i][1] not in self.minus
        op, x, y = self.ops[i]
        turned = [(k in self.minus) != (i in self.minus) for k in (x, y)]
        if op == "mul":
            return (x in self.minus) ^ (y in self.minus) ^ (i in self.minus)
        return turned[0] and turned[1] != (op == "sub") and not self._has_product(i)
