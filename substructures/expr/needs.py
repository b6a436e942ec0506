"""What entries of a program need: the operations they are computed from, listed or counted; and what a program that is
read may ask of whoever computes it: nothing in vain, and no powers without bound.

An operation is cheap, what comes of it need not be: 700 powers of powers have an exponent of 4200 bits, 99,000 of them
fill a memory. So the reader follows two sizes through a program (format.md, section 6):

* the exponent of an operation: 1 of symbols and functions, 0 of numbers; the larger one in sums, added in products and
  quotients, times |n| in powers: how often a symbol occurs as a factor, at most;
* the digits of a number that operations make of numbers alone: those of its operands together, times |n| in powers.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import compress

import numpy as np

from substructures.errors import InvalidProgram
from substructures.expr.construction.exact import MAX_BITS
from substructures.expr.operations import ARITHMETIC, BINARY, Operation, Output, operands

GROUPS = 1024  #: groups of entries that are counted in one pass
ROWS = 4096  #: masks that are unpacked at a time


def needed(operations: Sequence[Operation], entries: Iterable[int]) -> list[int]:
    """Sorted indices of the operations that the entries need, themselves included."""
    is_needed = bytearray(len(operations))
    for entry in entries:
        is_needed[entry] = 1
    for i in range(len(operations) - 1, -1, -1):
        if is_needed[i]:
            operation = operations[i]
            if operation[0] in BINARY:
                is_needed[operation[1]] = is_needed[operation[2]] = 1
                continue
            for operand in operands(operation):
                is_needed[operand] = 1
    return list(compress(range(len(is_needed)), is_needed))


def totals(operations: Sequence[Operation], groups: Sequence[Sequence[int]]) -> list[int]:
    """Arithmetic operations that each group of entries needs, each operation counted once for a group."""
    return [
        total
        for start in range(0, len(groups), GROUPS)
        for total in _totals(operations, groups[start : start + GROUPS])
    ]


def _totals(operations: Sequence[Operation], groups: Sequence[Sequence[int]]) -> list[int]:
    """One pass from the last operation to the first; bit k of a mask: group k needs the operation."""
    masks = [0] * len(operations)
    for k, entries in enumerate(groups):
        for entry in entries:
            masks[entry] |= 1 << k
    found: Counter[int] = Counter()
    for i in range(len(masks) - 1, -1, -1):
        mask = masks[i]
        if mask:
            found[mask] += operations[i][0] in ARITHMETIC
            for operand in operands(operations[i]):
                masks[operand] |= mask
    return _weighted_bits(found, len(groups))


def _weighted_bits(counts: Mapping[int, int], width: int) -> list[int]:
    """For every bit the sum of the counts of the masks that have it."""
    size = -(-width // 8)
    masks = np.frombuffer(b"".join(mask.to_bytes(size, "little") for mask in counts), np.uint8).reshape(-1, size)
    weights = np.fromiter(counts.values(), np.int64, len(counts))
    sums = np.zeros(width, np.int64)
    for start in range(0, len(masks), ROWS):
        bits = np.unpackbits(masks[start : start + ROWS], axis=1, bitorder="little", count=width)
        sums += weights[start : start + ROWS] @ bits
    return [int(n) for n in sums]


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
        if operation[0] in BINARY:
            op, a, b = operation
            exponent = exponents[a] + exponents[b] if op in ("mul", "div") else max(exponents[a], exponents[b])
            m, n = sizes[a], sizes[b]
            size = None if m is None or n is None else m + n + (op in ("add", "sub"))
        else:
            exponent, size = _exponent(operation, exponents), _size(operation, sizes)
        if exponent > MAX_POWER:
            raise InvalidProgram(f"an exponent of more than {MAX_BITS} bits", i)
        if size is not None and size > MAX_BITS:
            raise InvalidProgram(f"a number of more than {MAX_BITS} bits", i)
        exponents.append(exponent)
        sizes.append(size)


def _exponent(operation: Operation, known: Sequence[int]) -> int:
    """Of all but sums, products and quotients."""
    op = operation[0]
    if op == "powi":
        return known[operation[1]] * abs(operation[2])
    return known[operation[1]] if op == "neg" else int(op not in ("int", "rat"))


def _size(operation: Operation, known: Sequence[int | None]) -> int | None:
    """Likewise."""
    op = operation[0]
    if op in ("int", "rat"):
        return max(int(text).bit_length() for text in operation[1:])
    size = known[operation[1]] if op in ("neg", "powi") else None
    return size * abs(operation[2]) if size is not None and op == "powi" else size
