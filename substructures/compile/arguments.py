"""Values of symbols as addresses and strides: no value that varies over the batch is copied before it is needed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import prod
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from substructures.array import Array

#: names, and an array whose columns (last axis) are their values
NamedColumns = tuple[Sequence[str], Array]


class ArgumentColumn(NamedTuple):
    """A column of an array of doubles, one row for every state."""

    address: int
    stride: int
    array: Array
    number: int


class Arguments(NamedTuple):
    """Inputs of one stage: numbers for all states, and (place, address, stride in bytes) of those that vary."""

    numbers: Array
    varying: list[tuple[int, int, int]]
    alive: list[Array]


#: of a stage without inputs
NOTHING = Arguments(np.zeros(0), [], [])


def batch_shape(values: Mapping[str, Any], columns: Iterable[NamedColumns] = ()) -> tuple[int, ...]:
    """The common shape of all values. Raises ValueError when there is none."""
    kinds = set(map(type, values.values()))
    shapes = {np.shape(v) for v in values.values() if type(v) is not float} if kinds - {float} else set()
    shapes |= {np.shape(array)[:-1] for _, array in columns}
    shapes.discard(())
    if not shapes:
        return ()
    return shapes.pop() if len(shapes) == 1 else np.broadcast_shapes(*shapes)


def merged(values: Mapping[str, Any], columns: Iterable[NamedColumns], batch: tuple[int, ...]) -> Mapping[str, Any]:
    """Columns as values by name; without a copy where an array has one row of doubles for every state."""
    result = None
    for names, array in columns:
        result = dict(values) if result is None else result
        shape = np.shape(array)
        if not shape or shape[-1] != len(names):
            raise ValueError(f"{len(names)} names for an array of shape {shape}")
        if isinstance(array, np.ndarray) and array.dtype == np.float64 and shape[:-1] == batch and len(batch) == 1:
            base, (row, step) = array.__array_interface__["data"][0], array.strides
            result |= {name: ArgumentColumn(base + k * step, row, array, k) for k, name in enumerate(names)}
        else:
            result |= {name: np.asarray(array)[..., k] for k, name in enumerate(names)}
    return values if result is None else result


class Inputs:
    """The inputs of a stage by name, looked up at once."""

    def __init__(self, names: Sequence[str]) -> None:
        self.names = tuple(names)
        # a getter of two names and more answers with a tuple; of the repeated first one with a pair
        self.get = itemgetter(*self.names, *self.names[:1]) if names else lambda _: (None,)

    def find(self, values: Mapping[str, Any]) -> tuple[Any, ...]:
        """The values as they are. Raises KeyError."""
        return self.get(values)[:-1]

    def read(self, found: tuple[Any, ...], batch: tuple[int, ...], in_place: bool = False) -> Arguments:
        """Arguments from the values. ``in_place``: arrays of one element are read anew by every run."""
        if not found:
            return NOTHING
        result = Arguments(np.empty(len(found)), [], [])
        if set(map(type, found)) - {float}:
            found = tuple([self._number(result, k, x, batch, in_place) for k, x in enumerate(found)])
        result.numbers[:] = found
        return result

    @staticmethod
    def _number(result: Arguments, place: int, value: Any, batch: tuple[int, ...], in_place: bool) -> float:
        """The value when it is the same for all states; arrays are noted in the result."""
        if type(value) is float:
            return value
        if type(value) is ArgumentColumn:
            if not value.stride and not in_place:
                return float(value.array[0, value.number])
            result.varying.append((place, value.address, value.stride))
            result.alive.append(value.array)
            return np.nan
        value = np.asarray(value, dtype=np.float64)
        if value.ndim and (in_place or (value.size != 1 and any(value.strides))):
            _vary(result, place, value, batch)
            return np.nan
        return float(value.reshape(-1)[0])


def _vary(result: Arguments, place: int, value: Array, batch: tuple[int, ...]) -> None:
    """A value for every state; arrays of more axes are laid out in one."""
    if value.shape != batch:
        value = np.broadcast_to(value, batch)
    if value.ndim != 1:
        value = value.reshape(prod(batch))
    result.varying.append((place, value.__array_interface__["data"][0], value.strides[0]))
    result.alive.append(value)
