"""The reference evaluator: a program over numpy arrays, one operation at a time. Slow, obviously right."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.errors import MissingValue
from substructures.expr.construction.exact import nearest_float
from substructures.expr.program import Output, Program

#: of Python where it has them: numbers alone take NumPy ten times as long
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "neg": operator.neg,
    "div": np.divide,
    "powi": np.power,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "exp": np.exp,
    "log": np.log,
    "sqrt": np.sqrt,
    "abs": np.abs,
    "sign": np.sign,
}


def constant(operation: tuple[Any, ...]) -> float:
    """Value of an ``int`` or ``rat`` operation, correctly rounded; infinite beyond the range of doubles."""
    return nearest_float(Fraction(int(operation[1]), int(operation[2])) if operation[0] == "rat" else int(operation[1]))


def interpret(program: Program, values: Mapping[str, Any], names: Iterable[str] | None = None) -> dict[str, Array]:
    """Evaluate outputs for values of all symbols they need: floats, or arrays of one common shape (batch).

    Returns arrays of shape batch + shape of the output, with all symmetric entries filled in. Division by zero and
    overflow give infinities and NaN, as in IEEE arithmetic. Raises MissingValue for a symbol without a value.
    """
    names = list(program.outputs if names is None else names)
    batch = np.broadcast_shapes(*(np.shape(v) for v in values.values())) if values else ()
    results = operations(program, values, names)
    return {name: assemble(program.outputs[name], results, batch) for name in names}


def interpret_entries(program: Program, values: Mapping[str, Any], names: Iterable[str]) -> dict[str, list[Any]]:
    """The independent elements of outputs alone, in the order of ``index``: numbers, or arrays of the shape of the
    values. Raises as :func:`interpret`.
    """
    names = list(names)
    results = operations(program, values, names)
    wanted = {entry for name in names for entry in program.outputs[name].entries}
    plain = {e: results[e] if getattr(results[e], "ndim", 0) else float(results[e]) for e in wanted}
    return {name: [plain[entry] for entry in program.outputs[name].entries] for name in names}


def operations(program: Program, values: Mapping[str, Any], names: Iterable[str]) -> dict[int, Any]:
    """The value of every operation that the outputs need."""
    results: dict[int, Any] = {}
    with np.errstate(all="ignore"):
        for i in program.reachable(names):
            operation = program.operations[i]
            op, first = operation[0], operation[1]
            if op == "sym":
                results[i] = _lookup(program.symbols[first].name, values)
            elif op in ("int", "rat"):
                results[i] = constant(operation)
            elif op == "powi":
                results[i] = _FUNCTIONS[op](results[first], float(operation[2]))
            elif len(operation) == 2:
                results[i] = _FUNCTIONS[op](results[first])
            else:
                results[i] = _FUNCTIONS[op](results[first], results[operation[2]])
    return results


def interpret_in_blocks(
    program: Program, values: Mapping[str, Any], names: Iterable[str], states: int, memory: int = 20_000_000
) -> dict[str, Array]:
    """:func:`interpret` for values that are floats or (states,), at most ``memory`` numbers at a time."""
    names = list(names)
    block = max(1, memory // max(1, len(program.reachable(names))))
    arrays = {name: np.asarray(v, dtype=np.float64) for name, v in values.items()}
    results = {name: np.empty((states, *program.outputs[name].shape)) for name in names}
    for start in range(0, states, block):
        part = {name: v[start : start + block] if v.shape == (states,) else v for name, v in arrays.items()}
        for name, x in interpret(program, part, names).items():
            results[name][start : start + block] = x
    return results


def _lookup(name: str, values: Mapping[str, Any]) -> Any:
    try:
        found = np.asarray(values[name], dtype=np.float64)
    except KeyError:
        raise MissingValue(name) from None
    return found if found.ndim else float(found)


def assemble(output: Output, results: Mapping[int, Any], batch: tuple[int, ...]) -> Array:
    """Dense array of an output from the values of its entries."""
    dense: Array = np.zeros(batch + output.shape)
    for index, entry, sign in output.expanded():
        place: tuple[Any, ...] = (..., *index)
        dense[place] = results[entry] if sign > 0 else -results[entry]
    return dense
