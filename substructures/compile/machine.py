"""The kernel of machine code: tables for the driver of :mod:`substructures.compile.runtime`, and threads."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from itertools import accumulate
from math import prod
from operator import is_
from typing import Any, NamedTuple

import numpy as np

from substructures.compile import layout, target
from substructures.compile.arguments import NOTHING, Arguments, Array, Columns, Inputs, batch_shape, merged
from substructures.compile.engine import WORDS, Runtime, Scratch, Table, address, workers
from substructures.compile.kernel import Blocks, Kernel, Packed, is_packed
from substructures.compile.layout import Layout, Words
from substructures.compile.lowering import REGIONS
from substructures.compile.recipe import Recipe
from substructures.compile.runtime import STEP
from substructures.errors import MissingValue
from substructures.expr.program import Program

#: bytes of scratch for the vectors that go through every function together: half of a core's second-level cache
GROUP_BYTES = 256 * 1024
MAX_GROUP = 16
#: below this many states a second thread costs more than it gives
THREADED = 1024
#: scratch arrays kept for the next call
KEPT = 4
NO_OUTPUTS = Table.written(())
Counter = ctypes.c_int64


class _Once(NamedTuple):
    """Leading stages that have run for the whole batch: their scratch rows, and a row of results."""

    scratch: tuple[Scratch, ...]
    results: Scratch


class _Job(NamedTuple):
    """A batch: number of states, leading stages, inputs of all stages, tables for the driver.

    ``counter``: groups of vectors that have been taken.
    """

    states: int
    once: _Once
    arguments: list[Arguments]
    inputs: Table
    outputs: Table
    counter: Counter
    blocks: Array | None


class _Prepared(NamedTuple):
    """Scratch of one thread, and the words of the driver's context."""

    scratch: list[Scratch]
    alive: Any
    words: tuple[int, ...]


class MachineKernel(Kernel):
    """Compiled functions and the tables that the driver needs."""

    def __init__(self, program: Program, names: Sequence[str], recipe: Recipe, code: bytes, runtime: Runtime) -> None:
        super().__init__(program, names)
        width = runtime.width
        self.width, self.recipe, self.runtime = width, recipe, runtime
        self._code = target.Loaded.load(code, recipe.functions)
        self._place = {operation: k for k, operation in enumerate(recipe.outputs, 1)}
        steps = [self.runtime.steps(x.steps, k, self._code.names) for k, x in enumerate(recipe.stages)]
        self._steps = Table.of(np.concatenate(steps))
        # of the stages: first step, results before, doubles of a scratch row
        self._first = [0, *accumulate(map(len, steps))]
        self._results = [0, *accumulate(len(x.results) for x in recipe.stages)]
        self._rows = [width * max(x.size, 1) for x in recipe.stages]
        self._inputs = [Inputs(x.inputs) for x in recipe.stages]
        # a zero, and the results
        self._o_row = width * (1 + self._results[-1])
        self.group = min(MAX_GROUP, max(1, GROUP_BYTES // (8 * (sum(self._rows[1:]) + self._o_row))))
        self._layouts: dict[tuple[str, bool], tuple[Layout, tuple[int, ...]]] = {}
        self._scratch: list[list[Scratch]] = []
        self._none = _Once((), Scratch.zeros(1, width))
        self._last: tuple[tuple[float, ...], _Once] | None = None

    @property
    def compiled(self) -> bool:
        """True."""
        return True

    def _run(
        self,
        values: Mapping[str, Any],
        batch: tuple[int, ...],
        out: Mapping[str, Array],
        packed: Packed,
        threads: int,
        *,
        clean: bool,
    ) -> None:
        if prod(batch):
            self._run_job(self._job(values, batch, self._outputs(out, batch, packed, clean)), threads)

    def blocks(
        self, values: Mapping[str, Any], *, columns: Iterable[Columns] = (), threads: int = 1, out: Array | None = None
    ) -> Blocks:
        columns = list(columns)
        batch = batch_shape(values, columns)
        count = prod(batch)
        shape = (-(-count // self.width), self._results[-1], self.width)
        array = Scratch.zeros(shape[0], shape[1] * shape[2]).array.reshape(shape) if out is None else out
        if (
            array.shape != shape
            or array.dtype != np.float64
            or not (array.flags.c_contiguous and array.flags.writeable)
        ):
            raise ValueError(f"a writable C-ordered array of doubles of shape {shape} is needed")
        if count:
            self._run_job(self._job(merged(values, columns, batch), batch, blocks=array), threads)
        return Blocks(count, array, self._numbers)

    @cached_property
    def _numbers(self) -> dict[str, Words]:
        """Places of the independent elements of every output in an array of blocks."""
        places = {name: [self._place[e] - 1 for e in output.entries] for name, output in self.outputs.items()}
        return {name: np.array(some, dtype=np.int64) for name, some in places.items()}

    def _bound(
        self, values: Mapping[str, Any], batch: tuple[int, ...], out: Mapping[str, Array], packed: Packed
    ) -> Callable[[], None]:
        job = self._job(values, batch, self._outputs(out, batch, packed, clean=False), in_place=True)
        return _Bound((self, job, dict(out)), self.runtime.call, self._prepared(job), job.counter)

    def _job(
        self,
        values: Mapping[str, Any],
        batch: tuple[int, ...],
        outputs: Table = NO_OUTPUTS,
        blocks: Array | None = None,
        in_place: bool = False,
    ) -> _Job:
        """Addresses and tables of a batch; the leading stages whose inputs do not vary have run."""
        found, count = self._find(values), prod(batch)
        last = self._last
        once = last[1] if last is not None and all(map(is_, found[0], last[0])) else self._none
        done = len(once.scratch)
        arguments = [NOTHING] * done
        arguments += [x.read(f, batch, in_place) for x, f in zip(self._inputs[done:], found[done:], strict=True)]
        if not done and not arguments[0].varying:
            once = self._continued(once, arguments[:1])
            if set(map(type, found[0])) <= {float}:
                self._last = found[0], once
        fixed = next((k for k, x in enumerate(arguments) if x.varying), len(arguments))
        # for one vector another call of the driver would not pay
        if fixed > 1 and count > self.width:
            once = self._continued(once, arguments[1:fixed])
        ready = self._results[len(once.scratch)]
        if ready and blocks is not None:
            blocks[:, :ready] = once.results.array[0, self.width :].reshape(ready, self.width)
        size = 8 * self.width
        inputs = [(a, stride, size * k, stage) for stage, x in enumerate(arguments) for k, a, stride in x.varying]
        return _Job(count, once, arguments, Table.written(inputs), outputs, Counter(), blocks)

    def _find(self, values: Mapping[str, Any]) -> list[tuple[Any, ...]]:
        """The inputs of every stage. Raises MissingValue."""
        try:
            return [stage.find(values) for stage in self._inputs]
        except KeyError:
            # the first one in the order of the program, as the interpreter has it
            raise MissingValue(next(name for name in self.symbols if name not in values)) from None

    def _continued(self, once: _Once, arguments: Sequence[Arguments]) -> _Once:
        """The next stages, run once."""
        start = len(once.scratch)
        stop = start + len(arguments)
        scratch = list(once.scratch)
        for x, size in zip(arguments, self._rows[start:stop], strict=True):
            row = Scratch.zeros(1, size)
            row.array[0, : len(x.numbers) * self.width] = np.repeat(x.numbers, self.width)
            scratch.append(row)
        results = Scratch.zeros(1, self.width * (1 + self._results[stop]))
        results.array[:, : once.results.array.size] = once.results.array
        counter = Counter()
        rows = [word for x in scratch for word in x[:2]] + [0] * 2 * (len(REGIONS) - stop)
        steps = self._between(start, stop)
        self.runtime.drive(*rows, results.address, 0, 0, 1, ctypes.addressof(counter), 0, 0, *steps, 0, 0, 1)
        return _Once(tuple(scratch), results)

    def _between(self, start: int, stop: int) -> tuple[int, int]:
        """Address and number of the steps of these stages."""
        first, last = self._first[start], self._first[stop]
        return self._steps.address + 8 * len(STEP) * first, last - first

    def _run_job(self, job: _Job, threads: int) -> None:
        if threads > 1 and job.states >= THREADED:
            self._share(job, threads)
        else:
            self._work(job)

    def _outputs(self, out: Mapping[str, Array], batch: tuple[int, ...], packed: Packed, clean: bool) -> Table:
        """The table OUTPUT."""
        rows = [self._output(n, array, is_packed(n, packed), len(batch), clean) for n, array in out.items()]
        return Table.written(rows)

    def _output(self, name: str, array: Array, packed: bool, axes: int, clean: bool) -> tuple[int, ...]:
        if (name, packed) not in self._layouts:
            made = (layout.packed if packed else layout.dense)(self.outputs[name], self._place, self.width)
            words = [word for table in (made.groups, made.singles) for word in (address(table), len(table))]
            self._layouts[name, packed] = made, tuple(words)
        where, tables = self._layouts[name, packed]
        if where.sparse and not clean:
            array.fill(0)
        stride = array.strides[0] if axes == 1 else 8 * prod(where.shape)
        return (address(array), stride, *tables)

    def _share(self, job: _Job, threads: int) -> None:
        """Threads take groups of vectors until none is left; only the last one can have a partial vector."""
        others = [workers().submit(self._work, job) for _ in range(threads - 1)]
        self._work(job)
        for other in others:
            # one that has not begun yet would find nothing to do
            if not other.cancel():
                other.result()

    def _work(self, job: _Job) -> None:
        """Runs the driver, with scratch of its own."""
        prepared = self._prepared(job)
        self.runtime.drive(*prepared.words)
        if len(self._scratch) < KEPT:
            self._scratch.append(prepared.scratch)

    def _prepared(self, job: _Job) -> _Prepared:
        """Scratch with the numbers of the batch, and the words of the driver's context."""
        try:
            own = self._scratch.pop()
        except IndexError:
            own = [Scratch.zeros(self.group, size) for size in (*self._rows[1:], self._o_row)]
        done, width = len(job.once.scratch), self.width
        varying = own[done - 1 : -1] if done else [Scratch.zeros(self.group, self._rows[0]), *own[:-1]]
        rows = [*job.once.scratch, *varying]
        for row, x in zip(varying, job.arguments[done:], strict=True):
            if len(x.varying) < len(x.numbers):
                row.array[:, : len(x.numbers) * width] = np.repeat(x.numbers, width)
        words = [word for row in rows for word in row[:2]]
        if job.blocks is None:
            ready = job.once.results.array
            own[-1].array[:, : ready.size] = ready
            words += (*own[-1][:2], 0)
        else:
            # the array has no zero
            words += (address(job.blocks) - 8 * width, job.blocks.strides[0], job.blocks.strides[0])
        tables = (*job.inputs[:2], *self._between(done, len(REGIONS)), *job.outputs[:2])
        return _Prepared(own, rows, (*words, job.states, ctypes.addressof(job.counter), *tables, self.group))


class _Bound:
    """A prepared call."""

    def __init__(self, alive: Any, call: Callable[[Any], None], prepared: _Prepared, counter: Counter) -> None:
        self.alive, self.call, self.counter = (alive, prepared), call, counter
        self.context = WORDS(*prepared.words)

    def __call__(self) -> None:
        self.counter.value = 0
        self.call(self.context)
