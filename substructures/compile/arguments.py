"""Values of symbols as addresses and strides: no value that varies over the batch is copied before it is needed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import count, repeat
from math import prod
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from substructures.array import Array

#: names, and an array whose columns (last axis) are their values
NamedColumns = tuple[Sequence[str], Array]


class ArgumentColumn(tuple[int, int, Array, int]):
    """A column of an array of doubles, one row for every state: address, stride in bytes, the array, its number."""

    __slots__ = ()

    @classmethod
    def all_of(cls, array: Array) -> Iterator[ArgumentColumn]:
        """Those of an array (N, k)."""
        row, step = array.strides
        addresses = count(array.__array_interface__["data"][0], step)
        return map(cls, zip(addresses, repeat(row), repeat(array), range(array.shape[1]), strict=False))


class Arguments(NamedTuple):
    """Inputs of one stage: numbers for all states, and rows of the table INPUT of those that vary."""

    numbers: Array
    varying: list[tuple[int, int, int, int]]
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
            result.update(zip(names, ArgumentColumn.all_of(array), strict=True))
        else:
            result |= {name: np.asarray(array)[..., k] for k, name in enumerate(names)}
    return values if result is None else result


class Inputs:
    """The inputs of a stage by name, looked up at once; ``size`` of a vector in bytes."""

    def __init__(self, names: Sequence[str], stage: int, size: int) -> None:
        self.names, self.stage = tuple(names), stage
        self.offsets = tuple(size * k for k in range(len(names)))
        #: where all of them vary
        self.none = np.full(len(names), np.nan)
        # a getter of two names and more answers with a tuple; of the repeated first one with a pair
        self.get = itemgetter(*self.names, *self.names[:1]) if names else lambda _: (None,)

    def find(self, values: Mapping[str, Any]) -> tuple[Any, ...]:
        """The values as they are. Raises KeyError."""
        return self.get(values)[:-1]

    def read(self, found: tuple[Any, ...], batch: tuple[int, ...], in_place: bool = False) -> Arguments:
        """Arguments from the values. ``in_place``: arrays of one element are read anew by every run."""
        if not found:
            return NOTHING
        kinds = set(map(type, found))
        if kinds == {float}:
            return Arguments(np.array(found), [], [])
        if kinds == {ArgumentColumn}:
            addresses, rows, arrays, _ = zip(*found, strict=True)
            if in_place or all(rows):
                varying = list(zip(addresses, rows, self.offsets, repeat(self.stage), strict=False))
                return Arguments(self.none, varying, list(arrays))
        result = Arguments(np.empty(len(found)), [], [])
        result.numbers[:] = [self._number(result, k, x, batch, in_place) for k, x in enumerate(found)]
        return result

    def _number(self, result: Arguments, k: int, value: Any, batch: tuple[int, ...], in_place: bool) -> float:
        """The k-th value when it is the same for all states; arrays are noted in the result."""
        if type(value) is float:
            return value
        if type(value) is ArgumentColumn:
            address, row, array, number = value
            if not row and not in_place:
                return float(array[0, number])
        else:
            array = np.asarray(value, dtype=np.float64)
            if not array.ndim or not (in_place or (array.size != 1 and any(array.strides))):
                return float(array.reshape(-1)[0])
            array = _for_every_state(array, batch)
            address, row = array.__array_interface__["data"][0], array.strides[0]
        result.varying.append((address, row, self.offsets[k], self.stage))
        result.alive.append(array)
        return np.nan


def _for_every_state(value: Array, batch: tuple[int, ...]) -> Array:
    """A value for each; arrays of more axes are laid out in one."""
    if value.shape != batch:
        value = np.broadcast_to(value, batch)
    return value if value.ndim == 1 else value.reshape(prod(batch))
