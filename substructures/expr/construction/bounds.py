"""How large the rounding errors of a formula can become: sums of absolute values at a few fixed points.

Two formulas that are equal as functions need not be equal in floating point: (q + 4)(q + 9) - (q + 2)(q + 11) is 14,
and 0 at q = 1e9. Beside the value v of a node stands A, the same formula with absolute values added and multiplied
(N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, chapter 3): rounding moves the result
by a small multiple of u A. A node is put for another only where its A is not larger, up to ``SLACK``, at any of the
points: all symbols large, all small, and large beside small ones in many ways. Their values belong to the names of the
symbols, so that a definition gives the same formulas everywhere.

A **size** is log2 A at all points, in sixteenths, packed into one integer of ``POINTS`` fields, so that a product
needs one addition; of a sum it keeps the larger operand. Fields hold ``ZERO`` for log2 A = 0 below a guard bit; a size
that leaves them says nothing and is ``UNKNOWN``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import cache
from hashlib import blake2b

POINTS = 10
WIDTH = 24
PARTS = 16
#: magnitudes of symbols lie between 2^-OCTAVES and 2^OCTAVES
OCTAVES = 13.0

_FIELDS = sum(1 << (WIDTH * k) for k in range(POINTS))
#: guard bits, one above every field
GUARDS = _FIELDS << (WIDTH - 1)
#: log2 A = 0 everywhere
ZERO = _FIELDS << (WIDTH - 2)
UNKNOWN = GUARDS - _FIELDS
#: the errors of a formula may be that much larger that is put for another: 2^2
SLACK = _FIELDS * 2 * PARTS

Values = tuple[float, ...]


def larger(a: int, b: int) -> int:
    """The size of a sum: of each field the larger one."""
    above = ((a | GUARDS) - b) & GUARDS
    return b ^ ((a ^ b) & (above - (above >> (WIDTH - 1))))


def smaller(a: int, b: int) -> int:
    """Of each field the smaller one."""
    return a ^ b ^ larger(a, b)


def product(a: int, b: int) -> int:
    """The size of a product."""
    result = a + b - ZERO
    # a field that left its range, up or down, has its guard bit set
    return UNKNOWN if result & GUARDS else result


def is_as_accurate(size: int, asked: int) -> bool:
    """Whether rounding moves a formula no more than what was asked for, at every point."""
    return ((asked + SLACK) | GUARDS) - size & GUARDS == GUARDS


def packed(sizes: Iterable[float]) -> int:
    """A size from A at the points; UNKNOWN where one is not finite or not positive."""
    result = 0
    for k, size in enumerate(sizes):
        if not 0 < size < math.inf:
            return UNKNOWN
        result |= (round(math.log2(size) * PARTS) + (1 << (WIDTH - 2))) << (WIDTH * k)
    return result


def unpacked(size: int) -> Values:
    """A at the points, infinite where it is unknown or beyond the range of doubles."""
    fields = ((size >> (WIDTH * k)) % (1 << WIDTH) - (1 << (WIDTH - 2)) for k in range(POINTS))
    return tuple(2.0 ** (x / PARTS) if x < 1000 * PARTS else math.inf for x in fields)


def number_size(value: float) -> int:
    """The size of a constant."""
    return packed([abs(value)] * POINTS) if value else ZERO


@cache
def symbol_values(name: str) -> Values:
    """The values of a symbol, all positive: large, small, and anything between."""
    random = blake2b(name.encode(), digest_size=2 * POINTS).digest()
    draws = [int.from_bytes(random[k : k + 2]) / 2**16 for k in range(0, 2 * POINTS, 2)]
    exponents = [draws[0] + OCTAVES, draws[1] - OCTAVES, *(OCTAVES * (2 * x - 1) for x in draws[2:])]
    return tuple(2.0**x for x in exponents)


@cache
def symbol_size(name: str) -> int:
    """The size of a symbol."""
    return packed(symbol_values(name))


def quotient(a: int, b: int, divisor: Values) -> int:
    """The size of a / b, for the sizes and the value of b: A = (A_a / |b|) (A_b / |b|)."""
    pairs = zip(unpacked(a), unpacked(b), divisor, strict=True)
    return packed((x / abs(d)) * (y / abs(d)) if d else math.inf for x, y, d in pairs)


def partial(op: str, size: int | None, argument: Values) -> int:
    """The size of a function of one operand: A = |f| + |f'| A; without the operand's size where it is exact."""
    f, slope = _FUNCTIONS[op]
    sizes = (0.0,) * POINTS if size is None else unpacked(size)
    return packed(_moved(f, slope, x, s) for x, s in zip(argument, sizes, strict=True))


def _moved(f: Callable[[float], float], slope: Callable[[float, float], float], x: float, size: float) -> float:
    try:
        value = f(x)
        # a zero is as accurate as its operand
        return (abs(value) + (slope(x, value) * size if size else 0.0)) or 1.0
    except (ValueError, ZeroDivisionError, OverflowError):
        return math.inf


def values_of(op: str, *args: Values) -> Values:
    """The value of an operation from those of its operands; NaN where it has none."""
    return tuple(_value(op, *some) for some in zip(*args, strict=True))


def _value(op: str, *args: float) -> float:
    try:
        return _FUNCTIONS[op][0](*args) if op in _FUNCTIONS else _VALUES[op](*args)
    except (ValueError, ZeroDivisionError, OverflowError):
        return math.nan


_VALUES: dict[str, Callable[..., float]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "sin": math.sin,
    "cos": math.cos,
    "atan2": math.atan2,
}
#: f, and |f'| from the operand and f
_FUNCTIONS: dict[str, tuple[Callable[..., float], Callable[[float, float], float]]] = {
    "sqrt": (math.sqrt, lambda _, f: 0.5 / f),
    "tan": (math.tan, lambda _, f: 1 + f * f),
    "asin": (math.asin, lambda x, _: 1 / math.sqrt(1 - x * x)),
    "acos": (math.acos, lambda x, _: 1 / math.sqrt(1 - x * x)),
    "atan": (math.atan, lambda x, _: 1 / (1 + x * x)),
    "exp": (math.exp, lambda _, f: f),
    "log": (math.log, lambda x, _: 1 / abs(x)),
    "abs": (abs, lambda *_: 1.0),
    "sign": (lambda x: math.copysign(1.0, x), lambda *_: 0.0),
}
