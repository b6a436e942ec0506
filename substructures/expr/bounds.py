"""How large the rounding errors of a formula can become: sums of absolute values at two fixed points.

Two formulas that are equal as functions need not be equal in floating point: (q + 4)(q + 9) - (q + 2)(q + 11) is 14,
and 0 at q = 1e9. Beside the value v of a node stands A, the same formula with absolute values added and multiplied
(N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, chapter 3): rounding moves the result
by a small multiple of u A. A node is put for another only where its A is not larger, up to ``SLACK``, where all
symbols are large, each differently, and where all are small: what is large beside another at one point is small beside
it at the other. The values belong to the names of the symbols, so that a definition gives the same formulas everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from hashlib import blake2b

#: powers of ten between which the large values of symbols lie
DECADES = (2.0, 6.0)
#: how many times larger the errors of a formula may be that is put for another
SLACK = 4.0

#: a value or size where all symbols are large, and where all are small
Pair = tuple[float, float]
ONES: Pair = (1.0, 1.0)


@cache
def symbol_pair(name: str) -> Pair:
    """The values of a symbol, both positive, their product is 1."""
    fraction = int.from_bytes(blake2b(name.encode(), digest_size=4).digest()) / 2**32
    exponent = DECADES[0] + fraction * (DECADES[1] - DECADES[0])
    return 10.0**exponent, 10.0**-exponent


def is_as_accurate(size: Pair, asked: Pair) -> bool:
    """Whether rounding moves a formula no more than what was asked for, wherever the latter has a value."""
    return all(x <= SLACK * y or not y < math.inf for x, y in zip(size, asked, strict=True))


def quotient(a: Pair, b: Pair, divisor: Pair) -> Pair:
    """A of a / b, for A_a, A_b and the value of b: (A_a / |b|) (A_b / |b|); infinite where b is zero."""
    x, y = ((p / abs(d)) * (q / abs(d)) if d else math.inf for p, q, d in zip(a, b, divisor, strict=True))
    return x, y


def partial(op: str, size: Pair, argument: Pair) -> Pair:
    """A of a function of one operand: |f| + |f'| A, infinite where it has no value."""
    f, slope = _FUNCTIONS[op]
    x, y = (_moved(f, slope, x, s) for x, s in zip(argument, size, strict=True))
    return x, y


def _moved(f: Callable[[float], float], slope: Callable[[float, float], float], x: float, size: float) -> float:
    try:
        value = f(x)
        return abs(value) + (slope(x, value) * size if size else 0.0)
    except (ValueError, ZeroDivisionError, OverflowError):
        return math.inf


def value_of(op: str, *args: Pair) -> Pair:
    """The value of an operation from those of its operands; NaN where it has none."""
    x, y = (_value(op, *some) for some in zip(*args, strict=True))
    return x, y


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
