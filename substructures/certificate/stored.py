"""A stored program in ball arithmetic: the values of its operations, from the plain lists that were stored."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import compress
from typing import Any, Protocol

from flint import arb, fmpq

from substructures.certificate.linear import Ball
from substructures.expr.operations import Operation, Output, Symbol, operands

_BINARY: dict[str, Callable[[Ball, Ball], Ball]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
    "atan2": lambda y, x: arb.atan2(y, x),
}
_UNARY: dict[str, Callable[[Ball], Ball]] = {
    "neg": operator.neg,
    "abs": abs,
    "sign": operator.methodcaller("sgn"),
    **{name: operator.methodcaller(name) for name in ("sin", "cos", "tan", "asin", "acos", "atan", "exp", "sqrt")},
    # as in floating point, where exp(y log 0) = 0 is 0^y
    "log": lambda x: arb("-inf") if x.is_zero() else x.log(),
}


class Stored(Protocol):
    """A program as it is stored."""

    @property
    def symbols(self) -> tuple[Symbol, ...]:
        """Its inputs."""

    @property
    def operations(self) -> tuple[Operation, ...]:
        """Operands refer to earlier ones."""

    @property
    def outputs(self) -> Mapping[str, Output]:
        """Which operations are the elements of its arrays."""


@dataclass(frozen=True)
class Pruned:
    """What some outputs of a program need of it."""

    symbols: tuple[Symbol, ...]
    operations: tuple[Operation, ...]
    outputs: Mapping[str, Output]


def pruned(program: Stored, names: Iterable[str]) -> Pruned:
    """The program with the outputs of these names that it has, and what they need."""
    outputs = {name: program.outputs[name] for name in names if name in program.outputs}
    given, needed = program.operations, bytearray(len(program.operations))
    for output in outputs.values():
        for entry in output.entries:
            needed[entry] = 1
    for i in range(len(needed) - 1, -1, -1):
        if needed[i]:
            operation = given[i]
            if operation[0] in _BINARY:
                needed[operation[1]] = needed[operation[2]] = 1
            else:
                for k in operands(operation):
                    needed[k] = 1
    place, operations = [0] * len(needed), list[Operation]()
    for i in compress(range(len(needed)), needed):
        place[i], operation = len(operations), given[i]
        if operation[0] in _BINARY:
            operations.append((operation[0], place[operation[1]], place[operation[2]]))
        else:
            used = operands(operation)
            operations.append((operation[0], *[place[k] for k in used], *operation[1 + len(used) :]))
    moved = {name: replace(x, entries=tuple(place[entry] for entry in x.entries)) for name, x in outputs.items()}
    return Pruned(program.symbols, tuple(operations), moved)


def operations_in_balls(program: Stored, values: Mapping[str, Ball]) -> list[Ball]:
    """The value of every operation at the precision at hand; ``values``: of all symbols. Not finite outside of the
    domain of an operation."""
    found: list[Ball] = []
    for operation in program.operations:
        op = operation[0]
        if op == "mul":
            found.append(found[operation[1]] * found[operation[2]])
        elif op == "add":
            found.append(found[operation[1]] + found[operation[2]])
        elif op in _BINARY:
            found.append(_BINARY[op](found[operation[1]], found[operation[2]]))
        elif op in _UNARY:
            found.append(_UNARY[op](found[operation[1]]))
        else:
            found.append(_other(program.symbols, operation, found, values))
    return found


def _other(symbols: Sequence[Symbol], operation: Operation, found: Sequence[Ball], values: Mapping[str, Ball]) -> Ball:
    """Symbols, constants and powers with integer exponents."""
    if operation[0] == "sym":
        return values[symbols[operation[1]].name]
    if operation[0] == "powi":
        return _power(found[operation[1]], operation[2])
    number = Fraction(int(operation[1]), int(operation[2]) if operation[0] == "rat" else 1)
    return arb(fmpq(number.numerator, number.denominator))


def _power(x: Ball, n: int) -> Any:
    """By multiplications: python-flint's own power of a ball around 0 is not a number."""
    result, square, left = arb(1), x, abs(n)
    while left:
        result, square, left = result * square if left & 1 else result, square * square, left >> 1
    return 1 / result if n < 0 else result
