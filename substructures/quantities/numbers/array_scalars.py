"""Numbers of many states as scalars of the mechanics, without the work that exact zeros and ones would make."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.expr.program import Program, operands


class Lanes:
    """An array (N,), or what a sum, difference or product with one gives: the integer 0, this array, or a new one."""

    __slots__ = ("array",)

    def __init__(self, array: Array) -> None:
        self.array = array

    # x + 0 = x, x 0 = 0 and x 1 = x hold exactly, so no array is made for them

    def __add__(self, other: Any) -> Lanes:
        if type(other) is Lanes:
            return Lanes(self.array + other.array)
        return Lanes(self.array + other) if other else self

    __radd__ = __add__

    def __sub__(self, other: Any) -> Lanes:
        if type(other) is Lanes:
            return Lanes(self.array - other.array)
        return Lanes(self.array - other) if other else self

    def __rsub__(self, other: Any) -> Lanes:
        return Lanes(other - self.array) if other else Lanes(-self.array)

    def __mul__(self, other: Any) -> Lanes | int:
        if type(other) is Lanes:
            return Lanes(self.array * other.array)
        if not other:
            return 0
        return self if other == 1 else Lanes(self.array * other)

    __rmul__ = __mul__

    def __neg__(self) -> Lanes:
        return Lanes(-self.array)


def plain(x: Any) -> Any:
    """The array of lanes, or the number."""
    return x.array if type(x) is Lanes else x


def lanes(x: Any) -> Any:
    """An array as lanes; numbers, for which zero is exact, as they are."""
    return Lanes(x) if is_array(x) else float(x) or 0


def is_array(x: Any) -> bool:
    """Whether this is an array with an axis of states."""
    return type(x) is np.ndarray and x.ndim > 0


class Supports:
    """Which symbols the elements of a program's outputs depend on."""

    def __init__(self, program: Program) -> None:
        masks = [0] * len(program)
        # an operation depends on what its operands depend on; bit k stands for symbol k
        for i, operation in enumerate(program.operations):
            if operation[0] == "sym":
                masks[i] = 1 << operation[1]
            else:
                for operand in operands(operation):
                    masks[i] |= masks[operand]
        self._bits = {symbol.name: 1 << k for k, symbol in enumerate(program.symbols)}
        self._masks = {name: [masks[e] for e in output.entries] for name, output in program.outputs.items()}

    def varying(self, values: Mapping[str, Any]) -> Callable[[str], list[bool]]:
        """For every element of an output by its name, whether it depends on a symbol whose value is an array."""
        mask = sum(bit for symbol, bit in self._bits.items() if is_array(values.get(symbol)))
        return lambda name: [bool(each & mask) for each in self._masks[name]]
