"""The kernel of machine code: tables for the driver of :mod:`substructures.compile.runtime`, and threads."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import prod
from typing import Any, NamedTuple

import numpy as np

from substructures.compile import layout, target
from substructures.compile.arguments import Arguments, Array, Columns, Inputs, batch_shape, merged
from substructures.compile.engine import WORDS, Runtime, Scratch, Table, address, workers
from substructures.compile.kernel import Blocks, Kernel, Packed, is_packed
from substructures.compile.layout import Layout, Words
from substructures.compile.recipe import Recipe
from substructures.errors import MissingValue
from substructures.expr.program import Program

#: bytes of scratch for the vectors that go through every function together: half of a core's second-level cache
GROUP_BYTES = 256 * 1024
MAX_GROUP = 16
#: below this many states a second thread costs more than it gives
THREADED = 1024
#: scratch arrays kept for the next call
KEPT = 4


@dataclass(frozen=True)
class _Job:
    """A batch: number of states, numbers of the state stage's inputs, parameter scratch, tables for the driver.

    ``counter``: groups of vectors that have been taken.
    """

    count: int
    numbers: Array
    p: Scratch
    inputs: Table
    steps: Table
    outputs: Table
    alive: Any
    counter: Words
    blocks: Array | None = None


class _Prepared(NamedTuple):
    """Scratch of one thread, and the words of the driver's context from "inputs" on."""

    scratch: tuple[Scratch, Scratch]
    p: Scratch
    words: tuple[int, ...]


class MachineKernel(Kernel):
    """Compiled functions and the tables that the driver needs."""

    def __init__(self, program: Program, names: Sequence[str], recipe: Recipe, code: bytes, runtime: Runtime) -> None:
        super().__init__(program, names)
        width = runtime.width
        self.width, self.recipe, self.runtime = width, recipe, runtime
        self._code = target.Loaded.load(code, recipe.functions)
        self._place = {operation: k for k, operation in enumerate(recipe.outputs, 1)}
        stages = ((recipe.parameters, "p"), (recipe.states, "s"))
        first, second = (self.runtime.steps(x.steps, region, self._code.names) for x, region in stages)
        self._p_steps, self._s_steps = Table.of(first), Table.of(second)
        self._all_steps = Table.of(np.concatenate([first, second]))
        self._p_inputs, self._s_inputs = Inputs(recipe.parameters.inputs), Inputs(recipe.states.inputs)
        self._s_row = width * max(recipe.states.size, 1)
        # a zero, and the results
        self._o_row = width * (1 + len(recipe.outputs))
        self._p_row = width * max(recipe.parameters.size, 1)
        self.group = min(MAX_GROUP, max(1, GROUP_BYTES // (8 * (self._s_row + self._o_row))))
        self._layouts: dict[tuple[str, bool], tuple[Layout, tuple[int, ...]]] = {}
        self._scratch: list[tuple[Scratch, Scratch]] = []
        self._last: tuple[bytes, Scratch] | None = None

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
            self._run_job(self._job(values, batch, out, packed, clean), threads)

    def blocks(
        self, values: Mapping[str, Any], *, columns: Iterable[Columns] = (), threads: int = 1, out: Array | None = None
    ) -> Blocks:
        columns = list(columns)
        batch = batch_shape(values, columns)
        count = prod(batch)
        shape = (-(-count // self.width), len(self.recipe.outputs), self.width)
        array = Scratch.zeros(shape[0], shape[1] * shape[2]).array.reshape(shape) if out is None else out
        if (
            array.shape != shape
            or array.dtype != np.float64
            or not (array.flags.c_contiguous and array.flags.writeable)
        ):
            raise ValueError(f"a writable C-ordered array of doubles of shape {shape} is needed")
        if count:
            job = self._job(merged(values, columns, batch), batch, {}, False, True)
            self._run_job(replace(job, blocks=array), threads)
        return Blocks(count, array, self._numbers)

    @cached_property
    def _numbers(self) -> dict[str, Words]:
        """Places of the independent elements of every output in an array of blocks."""
        places = {name: [self._place[e] - 1 for e in output.entries] for name, output in self.outputs.items()}
        return {name: np.array(some, dtype=np.int64) for name, some in places.items()}

    def _bound(
        self, values: Mapping[str, Any], batch: tuple[int, ...], out: Mapping[str, Array], packed: Packed
    ) -> Callable[[], None]:
        job = self._job(values, batch, out, packed, clean=False, in_place=True)
        return _Bound(self, job, self._prepared(job))

    def _job(
        self,
        values: Mapping[str, Any],
        batch: tuple[int, ...],
        out: Mapping[str, Array],
        packed: Packed,
        clean: bool,
        in_place: bool = False,
    ) -> _Job:
        """Addresses and tables of a batch."""
        try:
            p, s = (stage.read(values, batch, in_place) for stage in (self._p_inputs, self._s_inputs))
        except MissingValue:
            # the first one in the order of the program, as the interpreter has it
            raise MissingValue(next(name for name in self.symbols if name not in values)) from None
        count, size = prod(batch), 8 * self.width
        inputs = [(a, stride, size * k, region) for region, x in enumerate((s, p)) for k, a, stride in x.varying]
        steps = self._all_steps if p.varying else self._s_steps
        outputs = Table.written(
            [self._output(n, array, is_packed(n, packed), len(batch), clean) for n, array in out.items()]
        )
        counter = np.zeros(1, dtype=np.int64)
        alive = (s.alive, p.alive, list(out.values()))
        return _Job(count, s.numbers, self._parameters(p), Table.written(inputs), steps, outputs, alive, counter)

    def _run_job(self, job: _Job, threads: int) -> None:
        if threads > 1 and job.count >= THREADED:
            self._share(job, threads)
        else:
            self._work(job)

    def _output(self, name: str, array: Array, packed: bool, axes: int, clean: bool) -> tuple[int, ...]:
        """A row of the table OUTPUT."""
        if (name, packed) not in self._layouts:
            made = (layout.packed if packed else layout.dense)(self.outputs[name], self._place, self.width)
            words = [word for table in (made.groups, made.singles) for word in (address(table), len(table))]
            self._layouts[name, packed] = made, tuple(words)
        where, tables = self._layouts[name, packed]
        if where.sparse and not clean:
            array.fill(0)
        stride = array.strides[0] if axes == 1 else 8 * prod(where.shape)
        return (address(array), stride, *tables)

    def _parameters(self, p: Arguments) -> Scratch:
        """Scratch of the parameter stage: one row after its operations (the last set is remembered); or, when a
        parameter varies, rows with the inputs that do not.
        """
        key, last = p.numbers.tobytes(), self._last
        if last is not None and last[0] == key and not p.varying:
            return last[1]
        scratch = Scratch.zeros(self.group if p.varying else 1, self._p_row)
        scratch.array[:, : len(p.numbers) * self.width] = np.repeat(p.numbers, self.width)
        if not p.varying:
            steps, counter = self._p_steps, np.zeros(1, dtype=np.int64)
            self.runtime.drive(
                1, address(counter), 0, 0, steps.address, steps.rows, 0, 0, scratch.address, 0, 0, 0, 0, 0, 0, 1
            )
            self._last = key, scratch
        return scratch

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
        """Scratch with the numbers of the batch, and the words of the driver's context behind the range of states."""
        try:
            s, o = self._scratch.pop()
        except IndexError:
            s, o = Scratch.zeros(self.group, self._s_row), Scratch.zeros(self.group, self._o_row)
        p = job.p.copy() if job.p.stride else job.p
        s.array[:, : len(job.numbers) * self.width] = np.repeat(job.numbers, self.width)
        tables = (job.count, address(job.counter), *job.inputs[:2], *job.steps[:2], *s[:2], *p[:2], *job.outputs[:2])
        results = (*o[:2], 0) if job.blocks is None else self._moving(job.blocks)
        return _Prepared((s, o), p, (*tables, *results, self.group))

    def _moving(self, blocks: Array) -> tuple[int, int, int]:
        """Address, stride and advance of the results in an array (vectors, results, lanes); it has no zero."""
        return address(blocks) - 8 * self.width, blocks.strides[0], blocks.strides[0]


class _Bound:
    """A prepared call."""

    def __init__(self, kernel: MachineKernel, job: _Job, prepared: _Prepared) -> None:
        self.alive = kernel, job, prepared
        self.call = kernel.runtime.call
        self.context, self.counter = WORDS(*prepared.words), job.counter

    def __call__(self) -> None:
        self.counter[0] = 0
        self.call(self.context)
