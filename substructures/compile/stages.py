"""The stages of a kernel at run time: those whose inputs do not vary over the batch run once, before all others."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from itertools import accumulate
from math import prod
from operator import is_, itemgetter
from typing import Any, NamedTuple

import numpy as np

from substructures.array import Array
from substructures.compile.arguments import NamedColumns
from substructures.compile.engine import Scratch, VectorRuntime, WordTable, address, counters
from substructures.compile.order import REGIONS
from substructures.compile.recipe import Recipe
from substructures.compile.runtime import STEP


class Arguments(NamedTuple):
    """Inputs of one stage: numbers for all states, NaN where they vary (none where all do), and rows of the table INPUT
    of those that vary; ``alive`` owns the memory of these.
    """

    numbers: Array
    varying: list[tuple[int, ...]]
    alive: list[Any]


#: kinds of columns whose tables are remembered
REMEMBERED = 8
#: of a stage without inputs
NOTHING = Arguments(np.zeros(0), [], [])


class Columns(NamedTuple):
    """An array of doubles with a row for every state; ``is_fixed``: with one row for all of them."""

    array: Array
    is_fixed: bool

    @classmethod
    def of(cls, given: Array, batch: tuple[int, ...], in_place: bool) -> Columns:
        """Without a copy where it has that form. ``in_place``: see :meth:`Inputs.read`."""
        if type(given) is np.ndarray and given.dtype == np.float64 and given.ndim == 2 and given.shape[:1] == batch:
            return cls(given, not in_place and not given.strides[0])
        array = np.asarray(given, dtype=np.float64)
        if array.ndim == 1:
            return cls(array[None], True)
        if not in_place and (prod(array.shape[:-1]) == 1 or not any(array.strides[:-1])):
            return cls(array[(0,) * (array.ndim - 1)][None], True)
        return cls(np.broadcast_to(array, (*batch, array.shape[-1])).reshape(prod(batch), array.shape[-1]), False)


class ColumnTable(NamedTuple):
    """Which columns of an array, by its number, are which inputs of a stage, as numbers and as tables of INPUT."""

    number: int
    columns: list[int]
    places: list[int]
    words: tuple[int, int, int, int]
    alive: tuple[WordTable, WordTable]

    @classmethod
    def of(cls, number: int, step: int, found: Mapping[int, int], size: int) -> ColumnTable:
        """``found``: inputs by columns, which are ``step`` bytes apart; ``size`` of an input in bytes."""
        columns, pairs, singles = sorted(found), list[tuple[int, ...]](), list[tuple[int, ...]]()
        paired = False
        for k, column in enumerate(columns):
            place = size * found[column]
            paired = step == 8 and k > 0 and columns[k - 1] == column - 1 and not paired
            if paired:
                pairs.append((*singles.pop(), place))
            else:
                singles.append((step * column, place))
        tables = WordTable.written(pairs), WordTable.written(singles)
        return cls(number, columns, [found[x] for x in columns], (*tables[0][:2], *tables[1][:2]), tables)


class Sources(NamedTuple):
    """Where the inputs of a stage come from: those that are values by name, their places, and all from columns."""

    by_name: Callable[[Mapping[str, Any]], tuple[Any, ...]]
    places: list[int]
    tables: list[ColumnTable]


class Inputs:
    """The inputs of a stage by name; ``size`` of a vector in bytes."""

    def __init__(self, names: Sequence[str], stage: int, size: int) -> None:
        self.names, self.stage, self.size = tuple(names), stage, size
        self._single = WordTable.written([(0, size * k) for k in range(len(names))])
        self._last: tuple[Sources, tuple[float, ...], Array] | None = None

    def sources(self, columns: Sequence[tuple[Sequence[str], int]]) -> Sources:
        """From columns of these names and so many bytes apart: of those that come twice from the last ones."""
        where = {name: (number, k) for number, (names, _) in enumerate(columns) for k, name in enumerate(names)}
        own, found = list[int](), [dict[int, int]() for _ in columns]
        for place, name in enumerate(self.names):
            if name in where:
                number, column = where[name]
                found[number][column] = place
            else:
                own.append(place)
        names = [self.names[place] for place in own]
        # a getter of two names and more answers with a tuple
        getter = itemgetter(*names) if len(names) > 1 else lambda values: tuple(values[name] for name in names)
        tables = [ColumnTable.of(k, columns[k][1], some, self.size) for k, some in enumerate(found) if some]
        return Sources(getter, own, tables)

    def read(
        self,
        found: tuple[Any, ...],
        sources: Sources,
        columns: Sequence[Columns],
        batch: tuple[int, ...],
        in_place: bool = False,
    ) -> Arguments:
        """Arguments from what was found by name, and columns. ``in_place``: arrays of one element and rows that are the
        same for all states are read anew by every run. The last numbers are remembered: who has written them somewhere
        knows them again.
        """
        if not self.names:
            return NOTHING
        fixed: list[ColumnTable] = []
        rows: list[tuple[int, ...]] = []
        alive: list[Any] = [sources]
        for table in sources.tables:
            array, is_fixed = columns[table.number]
            if is_fixed:
                fixed.append(table)
            else:
                rows.append((address(array), array.strides[0], self.stage, *table.words))
                alive.append(array)
        if not found and not fixed:
            return Arguments(NOTHING.numbers, rows, alive)
        last = self._last
        if last is not None and last[0] is sources and not fixed and all(map(is_, found, last[1])):
            return Arguments(last[2], rows, alive)
        result = Arguments(np.full(len(self.names), np.nan), rows, alive)
        for table in fixed:
            result.numbers[table.places] = columns[table.number].array[0, table.columns]
        if set(map(type, found)) == {float}:
            result.numbers[sources.places] = found
            self._last = None if fixed else (sources, found, result.numbers)
        else:
            for place, value in zip(sources.places, found, strict=True):
                result.numbers[place] = self._number(result, place, value, batch, in_place)
        return result

    def _number(self, result: Arguments, place: int, value: Any, batch: tuple[int, ...], in_place: bool) -> float:
        """A value when it is the same for all states; arrays are noted in the result."""
        if type(value) is float:
            return value
        array = np.asarray(value, dtype=np.float64)
        if not array.ndim or not (in_place or (array.size != 1 and any(array.strides))):
            return float(array.reshape(-1)[0])
        if array.shape != batch:
            array = np.broadcast_to(array, batch)
        array = array if array.ndim == 1 else array.reshape(prod(batch))
        single = self._single.address + 16 * place, 1
        result.varying.append((address(array), array.strides[0], self.stage, 0, 0, *single))
        result.alive.append(array)
        return np.nan


class PreparedStages(NamedTuple):
    """Leading stages that have run for the whole batch: their scratch rows, and a row with a zero and their results."""

    scratch: tuple[Scratch, ...]
    results: Scratch


class Stages:
    """Inputs and steps of all stages. ``rows``: doubles of a scratch row of each; ``results``: results before each."""

    def __init__(self, recipe: Recipe, runtime: VectorRuntime, functions: Mapping[str, int]) -> None:
        self.runtime, self.width = runtime, runtime.width
        self.inputs = [Inputs(stage.inputs, k, 8 * self.width) for k, stage in enumerate(recipe.stages)]
        self.rows = [self.width * max(stage.size, 1) for stage in recipe.stages]
        self.results = [0, *accumulate(len(stage.results) for stage in recipe.stages)]
        steps = [runtime.steps(stage.steps, k, functions) for k, stage in enumerate(recipe.stages)]
        self._steps = WordTable.of(np.concatenate(steps))
        self._first = [0, *accumulate(map(len, steps))]
        self._none = PreparedStages((), Scratch.zeros(1, self.width))
        self._last: tuple[tuple[float, ...], PreparedStages] | None = None
        self._sources: dict[tuple[tuple[tuple[str, ...], int], ...], list[Sources]] = {}

    def begin(
        self, values: Mapping[str, Any], given: Sequence[NamedColumns], batch: tuple[int, ...], in_place: bool
    ) -> tuple[PreparedStages, list[Arguments]]:
        """Runs the leading stages whose inputs do not vary; the inputs of all others. Raises KeyError.

        The last set of parameters is remembered. ``in_place``: see :meth:`Inputs.read`.
        """
        columns = [Columns.of(array, batch, in_place) for _, array in given]
        sources = self._sources_of(given, columns)
        found = [x.by_name(values) for x in sources]
        last, is_by_name = self._last, not sources[0].tables
        once = last[1] if last is not None and is_by_name and all(map(is_, found[0], last[0])) else self._none
        done = len(once.scratch)
        arguments = [NOTHING] * done
        arguments += [
            self.inputs[k].read(found[k], sources[k], columns, batch, in_place) for k in range(done, len(found))
        ]
        if not done and not arguments[0].varying:
            once = self._continued(once, arguments[:1])
            if is_by_name and set(map(type, found[0])) <= {float}:
                self._last = found[0], once
        fixed = next((k for k, x in enumerate(arguments) if x.varying), len(arguments))
        # for one vector another call of the driver would not pay
        if fixed > 1 and prod(batch) > self.width:
            once = self._continued(once, arguments[1:fixed])
        return once, arguments

    def _sources_of(self, given: Sequence[NamedColumns], columns: Sequence[Columns]) -> list[Sources]:
        """Those of all stages; of the last few kinds of columns they are remembered."""
        key = tuple((tuple(names), x.array.strides[-1]) for (names, _), x in zip(given, columns, strict=True))
        found = self._sources.get(key)
        if found is None:
            if len(self._sources) >= REMEMBERED:
                self._sources.clear()
            found = self._sources[key] = [stage.sources(key) for stage in self.inputs]
        return found

    def steps(self, start: int, stop: int = len(REGIONS)) -> tuple[int, int]:
        """Address and number of the steps of the stages start, ..., stop - 1."""
        first, last = self._first[start], self._first[stop]
        return self._steps.address + 8 * len(STEP) * first, last - first

    def scratch(self, k: int, arguments: Arguments, rows: int = 1) -> Scratch:
        """New rows of a stage, which begin with the numbers among its arguments."""
        new = Scratch.zeros(rows, self.rows[k])
        new.array[:, : len(arguments.numbers) * self.width] = np.repeat(arguments.numbers, self.width)
        return new

    def _continued(self, once: PreparedStages, arguments: Sequence[Arguments]) -> PreparedStages:
        """The next stages, run once."""
        start = len(once.scratch)
        stop = start + len(arguments)
        scratch = [*once.scratch, *(self.scratch(k, x) for k, x in enumerate(arguments, start))]
        results = Scratch.zeros(1, self.width * (1 + self.results[stop]))
        results.array[:, : once.results.array.size] = once.results.array
        rows = [word for x in scratch for word in x[:2]] + [0] * 2 * (len(REGIONS) - stop)
        taken, nothing = counters(), (0, 0)
        batch = 1, ctypes.addressof(taken), 0, 1, 1
        words = (*results[:2], 0, *batch, *nothing, *self.steps(start, stop), *nothing, 1, 0)
        self.runtime.drive(*rows, *words)
        return PreparedStages(tuple(scratch), results)
