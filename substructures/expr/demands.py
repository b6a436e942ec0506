"""What a program that is read may ask of whoever computes it: nothing in vain, and no powers without bound.

An operation is cheap, what comes of it need not be: 700 powers of powers have an exponent of 4200 bits, 99,000 of them
fill a memory. So the reader follows two sizes through a program (format.md, section 6):

* the exponent of an operation: 1 of symbols and functions, 0 of numbers; the larger one in sums, added in products and
  quotients, times |n| in powers: how often a symbol occurs as a factor, at most;
* the digits of a number that operations make of numbers alone: those of its operands together, times |n| in powers.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from substructures.errors import InvalidProgram
from substructures.expr.exact import MAX_BITS
from substructures.expr.needs import needed
from substructures.expr.operations import Operation, Output, operands

#: exponents have this many bits at most, and so have numbers
MAX_POWER = 1 << MAX_BITS
ALL_MEANT = "a program computes what its outputs need, and nothing else"


def check_demands(operations: Sequence[Operation], outputs: Iterable[Output]) -> None:
    """Raise InvalidProgram, with the position, for an operation that no output needs or that is beyond the bounds."""
    found = needed(operations, (entry for output in outputs for entry in output.entries))
    if len(found) != len(operations):
        first = next((i for i, entry in enumerate(found) if i != entry), len(found))
        raise InvalidProgram(f"no output needs it; {ALL_MEANT}", first)
    exponents: list[int] = []
    sizes: list[int | None] = []  # bits of what is a number
    for i, operation in enumerate(operations):
        exponent, size = _exponent(operation, exponents), _size(operation, sizes)
        if exponent > MAX_POWER:
            raise InvalidProgram(f"an exponent of more than {MAX_BITS} bits", i)
        if size is not None and size > MAX_BITS:
            raise InvalidProgram(f"a number of more than {MAX_BITS} bits", i)
        exponents.append(exponent)
        sizes.append(size)


def _exponent(operation: Operation, known: Sequence[int]) -> int:
    op = operation[0]
    if op in ("add", "sub"):
        return max(known[operation[1]], known[operation[2]])
    if op in ("mul", "div"):
        return known[operation[1]] + known[operation[2]]
    if op == "powi":
        return known[operation[1]] * abs(operation[2])
    return known[operation[1]] if op == "neg" else int(op not in ("int", "rat"))


def _size(operation: Operation, known: Sequence[int | None]) -> int | None:
    op = operation[0]
    if op in ("int", "rat"):
        return max(int(text).bit_length() for text in operation[1:])
    if op not in ("add", "sub", "mul", "div", "neg", "powi"):
        return None
    total = 0
    for i in operands(operation):
        size = known[i]
        if size is None:
            return None
        total += size
    return total * abs(operation[2]) if op == "powi" else total + (op in ("add", "sub"))
