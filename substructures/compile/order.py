"""The order of operations: by stages, and depth first, what needs most registers before what needs fewer."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from substructures.expr.needs import needed
from substructures.expr.operations import BINARY
from substructures.expr.program import Operation, Program, operands

#: stage by kind of symbol
STAGE = {"parameter": 0, "inertia": 0, "coordinate": 1, "time": 1, "velocity": 2, "acceleration": 3, "input": 3}
#: names of the stages' scratch arrays
REGIONS = ("p", "q", "v", "a")

#: functions whose value, or whether they have one, can hang on the last bit of their argument
SHARP = frozenset(("sqrt", "log", "asin", "acos", "atan2", "sign"))


def sharp(ops: Sequence[Operation], needed: Iterable[int]) -> set[int]:
    """What arguments of the SHARP functions are computed from, themselves included: to be rounded operation by
    operation, as the interpreter does. sqrt(a b - c d) is 0 where a b = c d, and NaN where one product is contracted.
    """
    found = {x for i in needed if ops[i][0] in SHARP for x in operands(ops[i])}
    stack = list(found)
    while stack:
        new = [x for x in operands(ops[stack.pop()]) if x not in found]
        found.update(new)
        stack += new
    return found


def registers(ops: Sequence[Operation], results: Iterable[int]) -> list[int]:
    """How many registers each value that the results need takes while it is computed, as if it was used once: none for
    what is read from memory (R. Sethi and J. D. Ullman, The generation of optimal code for arithmetic expressions,
    Journal of the ACM 17, 1970).
    """
    found = [0] * len(ops)
    for i in needed(ops, results):
        operation = ops[i]
        if operation[0] in BINARY:
            a, b = found[operation[1]], found[operation[2]]
            # of two that take the same number the first one waits in a register
            found[i] = a + 1 if a == b else max(a, b)
        else:
            of = [found[x] for x in operands(operation)]
            found[i] = max(1, max(of) + (len(of) > 1 and of[0] == of[1])) if of else 0
    return found


def depth_first(ops: Sequence[Operation], results: Iterable[int]) -> list[int]:
    """What the results need, every value as late as possible before its first use, and of two operands first the one
    that takes more :func:`registers`: few values wait at a time.
    """
    results = list(results)
    order, done, most = list[int](), bytearray(len(ops)), registers(ops, results)
    for result in results:
        stack = [result]
        while stack:
            i = stack.pop()
            # ~i: all operands of i are there
            if i < 0:
                order.append(~i)
            elif not done[i]:
                done[i], operation = 1, ops[i]
                stack.append(~i)
                if operation[0] in BINARY:
                    a, b = operation[1], operation[2]
                    stack += (a, b) if most[a] <= most[b] else (b, a)
                else:
                    stack += sorted(operands(operation), key=most.__getitem__)
    return order


def stage_of(program: Program, needed: Iterable[int]) -> bytearray:
    """The stage of every operation: that of its latest operand."""
    result = bytearray(len(program))
    for i in needed:
        operation = program.operations[i]
        if operation[0] in BINARY:
            a, b = result[operation[1]], result[operation[2]]
            result[i] = a if a > b else b
        elif operation[0] == "sym":
            result[i] = STAGE[program.symbols[operation[1]].kind]
        else:
            result[i] = max([result[x] for x in operands(operation)], default=0)
    return result
