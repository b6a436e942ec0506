"""The kernel of machine code: tables for the driver of :mod:`substructures.compile.runtime`, and threads."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from math import prod
from typing import Any, NamedTuple

import numpy as np

from substructures.array import Array
from substructures.compile import layout, target
from substructures.compile.arguments import NamedColumns, batch_shape, merged
from substructures.compile.engine import DRIVER, WORDS, Scratch, VectorRuntime, WordTable, address, counters, workers
from substructures.compile.kernel import Blocks, Kernel, KernelCall, is_packed
from substructures.compile.layout import Layout, Words
from substructures.compile.order import REGIONS
from substructures.compile.recipe import Recipe
from substructures.compile.runtime import CONTEXT
from substructures.compile.stages import Arguments, PreparedStages, Stages
from substructures.errors import MissingValue
from substructures.expr.program import Program

#: bytes of scratch for the vectors that go through every function together: about the first-level cache of a core
GROUP_BYTES = 48 * 1024
MAX_GROUP = 4
#: below this many states a second thread costs more than it gives
THREADED = 1024
#: scratch arrays kept for the next call
KEPT = 4
#: bytes of an engine of LLVM with its target machine and pages, as measured
ENGINE_BYTES = 50_000


class _Job(NamedTuple):
    """A batch: number of states, and of parts with a thread each; leading stages, inputs of all stages, tables for the
    driver; ``is_told``: whether results are finite is asked.
    """

    states: int
    parts: int
    once: PreparedStages
    arguments: list[Arguments]
    inputs: WordTable
    outputs: WordTable
    counters: ctypes.Array[ctypes.c_int64]
    is_told: bool
    blocks: Array | None


class _ThreadScratch(NamedTuple):
    """Scratch of one thread for the stages behind the first, and for a zero and the results; ``held``: the numbers that
    stand in it since an earlier call.
    """

    rows: list[Scratch]
    held: list[Array | None]

    def hold(self, k: int, numbers: Array, lanes: int) -> None:
        """The k-th rows begin with these numbers, each of them in so many lanes."""
        if self.held[k] is not numbers:
            row = np.repeat(numbers, lanes)
            self.rows[k].array[:, : row.size] = row
            self.held[k] = numbers


class _Prepared(NamedTuple):
    """Scratch of one thread, and the words of the driver's context."""

    scratch: _ThreadScratch
    alive: Any
    words: tuple[int, ...]


class MachineKernel(Kernel):
    """Compiled functions and the tables that the driver needs."""

    def __init__(
        self, program: Program, names: Sequence[str], recipe: Recipe, code: bytes, runtime: VectorRuntime
    ) -> None:
        super().__init__(program, names)
        width = runtime.width
        self.width, self.recipe, self.runtime = width, recipe, runtime
        self._code = target.Loaded.load(code, recipe.functions)
        self._place = {operation: k for k, operation in enumerate(recipe.outputs, 1)}
        self._stages = Stages(recipe, runtime, self._code.names)
        # a zero, and the results
        self._o_row = width * (1 + self._stages.results[-1])
        row = 8 * (sum(self._stages.rows[1:]) + self._o_row)
        self.group = min(MAX_GROUP, max(1, GROUP_BYTES // row))
        self._layouts: dict[tuple[str, bool | bytes], tuple[Layout, tuple[int, ...]]] = {}
        self._scratch: list[_ThreadScratch] = []
        # the object code lies in memory about twice: as it is loaded, and as tables
        self._held = ENGINE_BYTES + 2 * len(code) + KEPT * self.group * row

    @property
    def held(self) -> int:
        """With all scratch that is kept between calls."""
        return self._held

    @property
    def compiled(self) -> bool:
        """True."""
        return True

    def _run(self, request: KernelCall) -> bool:
        if not prod(request.batch):
            return True
        job = self._job(request)
        self._run_job(job)
        return job.is_told and not job.counters[1]

    def blocks(
        self,
        values: Mapping[str, Any],
        *,
        columns: Iterable[NamedColumns] = (),
        threads: int = 1,
        out: Array | None = None,
    ) -> Blocks:
        """By machine code, ``width`` states in a vector. Raises ValueError for an ``out`` of another shape."""
        columns = list(columns)
        batch = batch_shape(values, columns)
        count = prod(batch)
        shape = (-(-count // self.width), self._stages.results[-1], self.width)
        array = Scratch.zeros(shape[0], shape[1] * shape[2]).array.reshape(shape) if out is None else out
        if (
            array.shape != shape
            or array.dtype != np.float64
            or not (array.flags.c_contiguous and array.flags.writeable)
        ):
            raise ValueError(f"a writable C-ordered array of doubles of shape {shape} is needed")
        if count:
            self._run_job(self._job(KernelCall(values, batch, {}, False, threads, columns=columns), blocks=array))
        return Blocks(count, array, self._numbers)

    @cached_property
    def _numbers(self) -> dict[str, Words]:
        """Places of the independent elements of every output in an array of blocks."""
        places = {name: [self._place[e] - 1 for e in output.entries] for name, output in self.outputs.items()}
        return {name: np.array(some, dtype=np.int64) for name, some in places.items()}

    def _bound(self, request: KernelCall) -> Callable[[], None]:
        job = self._job(request, in_place=True)
        return BoundCall((self, job, request), self.runtime, self._prepared(job), job.counters)

    def _job(self, request: KernelCall, blocks: Array | None = None, in_place: bool = False) -> _Job:
        """Addresses and tables of a batch; the leading stages whose inputs do not vary have run."""
        try:
            once, arguments = self._stages.begin(request.values, request.columns, request.batch, in_place)
        except KeyError:
            # the first one in the order of the program, as the interpreter has it
            given = merged(request.values, request.columns)
            raise MissingValue(next(name for name in self.symbols if name not in given)) from None
        ready = self._stages.results[len(once.scratch)]
        if ready and blocks is not None:
            blocks[:, :ready] = once.results.array[0, self.width :].reshape(ready, self.width)
        inputs = [row for x in arguments for row in x.varying]
        tables = WordTable.written(inputs), self._outputs(request)
        states = prod(request.batch)
        parts = max(1, request.threads) if states >= THREADED else 1
        return _Job(states, parts, once, arguments, *tables, counters(parts), request.is_told, blocks)

    def _outputs(self, request: KernelCall) -> WordTable:
        """The table OUTPUT."""
        return WordTable.written([self._output(name, array, request) for name, array in request.out.items()])

    def _new(self, name: str, request: KernelCall) -> Array:
        """Zeros, which large arrays get from the system as they are touched, where not all elements are written."""
        where, _ = self._written(name, request)
        return (np.zeros if where.sparse else np.empty)((*request.batch, *where.shape))

    def _output(self, name: str, array: Array, request: KernelCall) -> tuple[int, ...]:
        where, tables = self._written(name, request)
        if where.sparse and not request.clean:
            array.fill(0)
        stride = array.strides[0] if len(request.batch) == 1 else 8 * prod(where.shape)
        return (address(array), stride, *tables)

    def _written(self, name: str, request: KernelCall) -> tuple[Layout, tuple[int, ...]]:
        """How an output is written, and the words of its tables."""
        chosen = request.places.get(name)
        packed = is_packed(name, request.packed)
        key = name, packed if chosen is None else chosen.tobytes()
        if key not in self._layouts:
            made = self._layout(name, packed, chosen)
            words = [word for table in (made.groups, made.singles) for word in (address(table), len(table))]
            # the first one of several threads' stays: others may be using its tables
            self._layouts.setdefault(key, (made, tuple(words)))
        return self._layouts[key]

    def _layout(self, name: str, packed: bool, chosen: Words | None) -> Layout:
        output = self.outputs[name]
        if chosen is not None:
            return layout.chosen(output, self._place, self.width, chosen)
        return (layout.packed if packed else layout.dense)(output, self._place, self.width)

    def _run_job(self, job: _Job) -> None:
        """Threads take groups of vectors until none is left; only the last one can have a partial vector."""
        others = [workers().submit(self._work, job, own) for own in range(1, job.parts)]
        self._work(job)
        for other in others:
            # one that has not begun yet would find nothing to do
            if not other.cancel():
                other.result()

    def _work(self, job: _Job, own: int = 0) -> None:
        """Runs the driver, with scratch of its own, from its own part on."""
        prepared = self._prepared(job, own)
        self.runtime.drive(*prepared.words)
        if len(self._scratch) < KEPT:
            self._scratch.append(prepared.scratch)

    def _prepared(self, job: _Job, own: int = 0) -> _Prepared:
        """Scratch with the numbers of the batch, and the words of the driver's context."""
        try:
            scratch = self._scratch.pop()
        except IndexError:
            new = [Scratch.zeros(self.group, size) for size in (*self._stages.rows[1:], self._o_row)]
            scratch = _ThreadScratch(new, [None] * len(new))
        done, width = len(job.once.scratch), self.width
        first = job.once.scratch or (self._stages.scratch(0, job.arguments[0], self.group),)
        for k in range(len(first), len(REGIONS)):
            scratch.hold(k - 1, job.arguments[k].numbers, width)
        rows = [*first, *scratch.rows[len(first) - 1 : -1]]
        words = [word for row in rows for word in row[:2]]
        if job.blocks is None:
            scratch.hold(-1, job.once.results.array, 1)
            words += (*scratch.rows[-1][:2], 0)
        else:
            # the array has no zero
            words += (address(job.blocks) - 8 * width, job.blocks.strides[0], job.blocks.strides[0])
        n_results = self._stages.results[-1] if job.is_told else 0
        turns = -(-job.states // (self.group * width * job.parts))
        words += (job.states, ctypes.addressof(job.counters), own, job.parts, turns)
        words += (*job.inputs[:2], *self._stages.steps(done), *job.outputs[:2], self.group, n_results)
        return _Prepared(scratch, rows, tuple(words))


class BoundCall:
    """A prepared call; ``words``: addresses of the driver and of the context that it is called with."""

    def __init__(
        self, alive: Any, runtime: VectorRuntime, prepared: _Prepared, taken: ctypes.Array[ctypes.c_int64]
    ) -> None:
        self.alive, self.counters = (alive, prepared), taken
        self.context = WORDS(*prepared.words)
        self.place = ctypes.addressof(self.context)
        driver = "drive_one" if self.context[CONTEXT.index("last")] == 1 else "drive"
        self.words = runtime.loaded.names[driver], self.place
        self.call = DRIVER(self.words[0])

    def __call__(self) -> None:
        """Once more."""
        self.counters[0] = 0
        self.call(self.place)
