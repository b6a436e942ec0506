"""Reference values that self-tests of exported files compare with, from the interpreter of programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite

import numpy as np

from substructures.export.exported import Exported, Function
from substructures.expr.interpret import interpret

#: elements of an output that are compared one by one; of more the sum is compared too
MOST = 60
#: by which positions are divided until there is something to compare
SMALLER = (1, 4, 16, 64)
#: part of the largest element of an output by which an element may differ
TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True)
class Check:
    """Element ``index`` of output number ``output``, or the sum of all, is ``value``, up to ``limit``."""

    output: int
    index: tuple[int, ...]
    is_sum: bool
    value: float
    limit: float


@dataclass(frozen=True, slots=True)
class Reference:
    """A call of a function with numbers, and what it gives. ``number``: of the function, from 0."""

    number: int
    called: str
    arguments: Mapping[str, tuple[float, ...]]
    shapes: tuple[tuple[int, ...], ...]
    checks: tuple[Check, ...]


def reference(exported: Exported) -> list[Reference]:
    """A call of every function."""
    return [_call(exported, k, function) for k, function in enumerate(exported.functions)]


def arguments(function: Function, smaller: int = 1) -> dict[str, tuple[float, ...]]:
    """Parameters at their defaults, all else, the same for ever, between -1 and 1; positions that much ``smaller``."""
    found = {}
    for k, symbol in enumerate(function.arguments):
        vector = function.vector(symbol)
        # multiples of 1/64 are exact in every language, in single precision too
        values = [((29 * i + 17 * k + 11) % 121 - 60) / 64 for i in range(len(vector))]
        if symbol == "p":
            values = [x if isfinite(x) else (1 + abs(y)) / 2 for x, y in zip(vector.defaults, values, strict=True)]
        found[symbol] = tuple(x / smaller for x in values) if symbol == "q" else tuple(values)
    return found


def _call(exported: Exported, number: int, function: Function) -> Reference:
    checks: list[Check] = []
    for smaller in SMALLER:
        given = arguments(function, smaller)
        values = {name: x for s in given for name, x in zip(function.vector(s).names, given[s], strict=True)}
        results = interpret(function.program, values)
        # loops may be open farther from where they start
        if checks := [check for k, value in enumerate(results.values()) for check in _checks(k, np.asarray(value))]:
            break
    shapes = tuple(o.shape for o in function.program.outputs.values())
    return Reference(number, exported.called(function), given, shapes, tuple(checks))


def _checks(k: int, array: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> list[Check]:
    """Of what is finite."""
    scale = float(np.abs(array[np.isfinite(array)]).max(initial=0.0)) or 1.0
    limit = TOLERANCE * scale
    places = np.argwhere(np.isfinite(array) & (array != 0)) if array.ndim else np.zeros((1, 0), dtype=int)
    step = -(-len(places) // MOST) or 1
    found = [tuple(int(i) for i in place) for place in places[::step]]
    found = [index for index in found if isfinite(array[index])]
    checks = [Check(k, index, False, float(array[index]), limit) for index in found]
    if array.ndim and array.size and np.all(np.isfinite(array)):
        checks.append(Check(k, (), True, float(array.sum()), limit * array.size))
    return checks
