"""What entries of a program need: the operations they are computed from, listed or counted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from substructures.expr.operations import ARITHMETIC, Operation, operands

GROUPS = 1024  #: groups of entries that are counted in one pass
ROWS = 4096  #: masks that are unpacked at a time


def needed(operations: Sequence[Operation], entries: Iterable[int]) -> list[int]:
    """Sorted indices of the operations that the entries need, themselves included."""
    is_needed = bytearray(len(operations))
    for entry in entries:
        is_needed[entry] = 1
    for i in range(len(operations) - 1, -1, -1):
        if is_needed[i]:
            for operand in operands(operations[i]):
                is_needed[operand] = 1
    return [i for i, flag in enumerate(is_needed) if flag]


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
