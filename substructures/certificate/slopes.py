"""Derivatives of stored programs in ball arithmetic: of one element by all symbols, and of all along a direction."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from flint import arb

from substructures.certificate.linear import Ball
from substructures.certificate.stored import Stored, operations_in_balls
from substructures.expr.operations import Operation, operands

#: symbols of which a potential that was found is no function
OUTSIDE = frozenset(("velocity", "acceleration", "input", "time"))


def slopes(program: Stored, entry: int, found: Sequence[Ball]) -> dict[str, Ball]:
    """The derivatives by all symbols on which an operation depends; ``found``: the values of the operations.

    Backwards through the operations: of y = f(x) the sensitivity of y times df/dx is added to that of x (reverse mode;
    A. Griewank and A. Walther, Evaluating Derivatives, 2008, section 3.2).
    """
    result: dict[str, Ball] = {}
    pending = {entry: arb(1)}
    for i in range(entry, -1, -1):
        weight, operation = pending.pop(i, None), program.operations[i]
        # what counts nothing may have no derivative: 0^y = exp(y log 0)
        if weight is None or weight.is_zero():
            continue
        if operation[0] == "sym":
            name = program.symbols[operation[1]].name
            result[name] = result.get(name, arb(0)) + weight
        for k, factor in _partials(operation, found, i):
            pending[k] = pending.get(k, arb(0)) + weight * factor
    return result


def tangents(program: Stored, found: Sequence[Ball], direction: Mapping[str, Ball]) -> dict[int, Ball]:
    """The changes of all operations that change when symbols change in a direction; ``found``: their values.

    Forwards through the operations (Griewank and Walther, section 3.1).
    """
    changes: dict[int, Ball] = {}
    for i, operation in enumerate(program.operations):
        op = operation[0]
        if op in _PRODUCT_OR_SUM:
            change = _of_two(operation, found, changes)
        elif op == "sym":
            change = direction.get(program.symbols[operation[1]].name)
        elif op in ("int", "rat") or changes.keys().isdisjoint(operands(operation)):
            continue
        else:
            terms = [factor * changes[k] for k, factor in _partials(operation, found, i) if k in changes]
            change = sum(terms[1:], terms[0])
        if change is not None:
            changes[i] = change
    return changes


_PRODUCT_OR_SUM = frozenset(("mul", "add", "sub"))


def _of_two(operation: Operation, found: Sequence[Ball], changes: Mapping[int, Ball]) -> Ball | None:
    """The change of a product, a sum or a difference, which nearly all operations are; None: it has none."""
    op, a, b = operation
    x, y = changes.get(a), changes.get(b)
    if op == "mul":
        x, y = (None if x is None else x * found[b]), (None if y is None else found[a] * y)
    elif op == "sub" and y is not None:
        y = -y
    if x is None or y is None:
        return y if x is None else x
    return x + y


def _partials(operation: Operation, found: Sequence[Ball], i: int) -> list[tuple[int, Ball]]:
    """(operand, partial derivative) of an operation whose value is found[i]."""
    op = operation[0]
    if op in ("sym", "int", "rat"):
        return []
    a, x, y = operation[1], found[operation[1]], found[i]
    if op in ("add", "sub"):
        return [(a, arb(1)), (operation[2], arb(1 if op == "add" else -1))]
    if op == "mul":
        return [(a, found[operation[2]]), (operation[2], x)]
    if op == "div":
        return [(a, 1 / found[operation[2]]), (operation[2], -y / found[operation[2]])]
    if op == "atan2":
        b = found[operation[2]]
        square = x * x + b * b
        return [(a, b / square), (operation[2], -x / square)]
    if op == "powi":
        n = operation[2]
        return [(a, n * y / x if n < 0 else n * _product(x, n - 1))] if n else []
    return [(a, _UNARY[op](x, y))]


def _product(x: Ball, n: int) -> Ball:
    result = arb(1)
    for _ in range(n):
        result = result * x
    return result


#: dy/dx of y = f(x)
_UNARY: dict[str, Callable[[Ball, Ball], Ball]] = {
    "neg": lambda _x, _y: arb(-1),
    "abs": lambda x, _y: x.sgn(),
    "sign": lambda _x, _y: arb(0),
    "sin": lambda x, _y: x.cos(),
    "cos": lambda x, _y: -x.sin(),
    "tan": lambda _x, y: 1 + y * y,
    "asin": lambda x, _y: 1 / (1 - x * x).sqrt(),
    "acos": lambda x, _y: -1 / (1 - x * x).sqrt(),
    "atan": lambda x, _y: 1 / (1 + x * x),
    "exp": lambda _x, y: y,
    "log": lambda x, _y: 1 / x,
    "sqrt": lambda _x, y: 1 / (2 * y),
}


def at_start(values: Mapping[str, Ball], kinds: Mapping[str, str]) -> dict[str, Ball]:
    """All coordinates zero; half the velocities, accelerations, inputs and time. ``kinds``: of the symbols; those of
    others stay.
    """
    outside = {name: x / 2 for name, x in values.items() if kinds.get(name) in OUTSIDE}
    return {**values, **outside} | {name: arb(0) for name in values if kinds.get(name) == "coordinate"}


def stored_gradient(
    program: Stored,
    entry: int | None,
    found: Sequence[Ball],
    values: Mapping[str, Ball],
    along: Sequence[str],
    ways: Mapping[str, Mapping[str, Ball]],
) -> dict[tuple[int, ...], Ball]:
    """Of a stored scalar V: the derivatives by the symbols ``along``, or ``ways`` in which several change, and at last
    its value :func:`at_start`. ``entry``: None where V is zero by structure.
    """
    if entry is None:
        return {}
    by_name = slopes(program, entry, found)
    result: dict[tuple[int, ...], Ball] = {(a,): by_name[name] for a, name in enumerate(along) if name in by_name}
    for a, way in ((a, ways[name]) for a, name in enumerate(along) if name in ways):
        result[a,] = sum((by_name[name] * x for name, x in way.items() if name in by_name), arb(0))
    start = at_start(values, without({symbol.name: symbol.kind for symbol in program.symbols}, ways))
    result[len(along),] = operations_in_balls(program, start)[entry]
    return result


def without(kinds: Mapping[str, str], ways: Mapping[str, Mapping[str, Ball]]) -> dict[str, str]:
    """The kinds of the symbols that do not change with rates."""
    kept = {name for way in ways.values() for name in way}
    return {name: kind for name, kind in kinds.items() if name not in kept}
