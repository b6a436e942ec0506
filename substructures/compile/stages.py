"""The stages of a kernel at run time: those whose inputs do not vary over the batch run once, before all others."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from itertools import accumulate
from math import prod
from operator import is_
from typing import Any, NamedTuple

import numpy as np

from substructures.compile.arguments import NOTHING, Arguments, Inputs
from substructures.compile.engine import Counter, Scratch, VectorRuntime, WordTable
from substructures.compile.order import REGIONS
from substructures.compile.recipe import Recipe
from substructures.compile.runtime import STEP


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

    def begin(
        self, values: Mapping[str, Any], batch: tuple[int, ...], in_place: bool
    ) -> tuple[PreparedStages, list[Arguments]]:
        """Runs the leading stages whose inputs do not vary; the inputs of all others. Raises KeyError.

        The last set of parameters is remembered. ``in_place``: see :meth:`Inputs.read`.
        """
        found = [stage.find(values) for stage in self.inputs]
        last = self._last
        once = last[1] if last is not None and all(map(is_, found[0], last[0])) else self._none
        done = len(once.scratch)
        arguments = [NOTHING] * done
        arguments += [x.read(f, batch, in_place) for x, f in zip(self.inputs[done:], found[done:], strict=True)]
        if not done and not arguments[0].varying:
            once = self._continued(once, arguments[:1])
            if set(map(type, found[0])) <= {float}:
                self._last = found[0], once
        fixed = next((k for k, x in enumerate(arguments) if x.varying), len(arguments))
        # for one vector another call of the driver would not pay
        if fixed > 1 and prod(batch) > self.width:
            once = self._continued(once, arguments[1:fixed])
        return once, arguments

    def steps(self, start: int, stop: int = len(REGIONS)) -> tuple[int, int]:
        """Address and number of the steps of the stages start, ..., stop - 1."""
        first, last = self._first[start], self._first[stop]
        return self._steps.address + 8 * len(STEP) * first, last - first

    def _continued(self, once: PreparedStages, arguments: Sequence[Arguments]) -> PreparedStages:
        """The next stages, run once."""
        start = len(once.scratch)
        stop = start + len(arguments)
        scratch = list(once.scratch)
        for x, size in zip(arguments, self.rows[start:stop], strict=True):
            row = Scratch.zeros(1, size)
            row.array[0, : len(x.numbers) * self.width] = np.repeat(x.numbers, self.width)
            scratch.append(row)
        results = Scratch.zeros(1, self.width * (1 + self.results[stop]))
        results.array[:, : once.results.array.size] = once.results.array
        rows = [word for x in scratch for word in x[:2]] + [0] * 2 * (len(REGIONS) - stop)
        counter, nothing = Counter(), (0, 0)
        words = (*results[:2], 0, 1, ctypes.addressof(counter), *nothing, *self.steps(start, stop), *nothing, 1, 0)
        self.runtime.drive(*rows, *words)
        return PreparedStages(tuple(scratch), results)
