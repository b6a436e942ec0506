"""Numbers as fast as they can be had: by the kernel of a tree, from kernels of its parts, or by the interpreter.

Kernels of trees and of parts are compiled in the background when they are first missed, at once for large batches and
on request; they are kept in memory and in a folder, by program, outputs, CPU and compiler. In memory there is room for
so many bytes; kernels that were not used for longest are unloaded first, and found again in the folder.

Which of the three is the quickest, measured by ``benchmarks.first_answer`` (AMD Zen 3, one thread) for metric and
forces of 6 + 6 and of 34 dof:

==============  ==================================================================================================
kernel          about 40 us for every operation, once; then 0.2 to 2 us a state
interpreter     1.4 us for every operation and call, and 3 to 5 ns for every operation and state; needs the coupled
                formulas (20 to 200 ms when they are not there)
parts           2 to 8 ms a call and 8 to 25 us a state; needs kernels of the parts and nothing of the tree. For one
                state, over floats, 1.2 to 3.4 times as fast as the interpreter; for batches about as fast
==============  ==================================================================================================

Both ways without a kernel grow with the same numbers, operations and states, as compiling does with operations alone.
So where compiling pays off depends on the number of states only: from about 10^4 on, whatever the tree.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from enum import StrEnum
from operator import attrgetter
from pathlib import Path
from threading import Lock
from typing import Any

from service.content.cache import Cache
from substructures.array import Array
from substructures.compile import Kernel, compile_program
from substructures.compile.cache import prune
from substructures.compile.kernel import NO_PLACES, Places, with_elements
from substructures.errors import MissingValue
from substructures.expr.interpret import interpret_entries
from substructures.expr.program import Program
from substructures.part.part import Part
from substructures.quantities.accelerations import Evaluator
from substructures.quantities.from_parts import NumericTree, gives
from substructures.quantities.numbers.evaluation import interpreted
from substructures.quantities.part_kernels import Scalars, kernel_entries
from substructures.tree.coupling import asked

#: from this many states on compiling first is quicker
AT_ONCE = 8192
CAPACITY = 256 * 2**20  # bytes of the kernels kept in memory; of those that answer trees of six coordinates 1,000
QUEUE = 100  # kernels that wait for the compiler; for others it is asked again later

Key = tuple[str, tuple[str, ...]]


class Way(StrEnum):
    """How numbers are found."""

    PARTS = "parts"
    INTERPRETER = "interpreter"
    KERNEL = "kernel"


def quickest(states: int, coupled: bool, warm: bool) -> Way:
    """The way for this many states of a tree without a kernel of its own.

    ``coupled``: its formulas are there; ``warm``: the kernels of its parts are.
    """
    if states >= AT_ONCE:
        return Way.KERNEL
    if coupled and not (warm and states == 1):
        return Way.INTERPRETER
    return Way.PARTS


class Kernels:
    """An engine for :mod:`substructures.quantities.numbers.evaluation`; kernels are kept in memory, and in a folder."""

    def __init__(self, folder: Path | None, most: int = 2**32) -> None:
        """``most``: bytes that the folder may take."""
        self.folder, self._most = folder, most
        self._kernels: Cache[Kernel] = Cache(CAPACITY, attrgetter("held"))
        self._waiting: dict[Key, int] = {}  # states that were answered without the kernel
        self._lock = Lock()
        self._compiler = ThreadPoolExecutor(1, thread_name_prefix="compiler")

    def __call__(
        self, program: Program, values: Mapping[str, Any], names: list[str], states: int, places: Places = NO_PLACES, /
    ) -> dict[str, Array]:
        """Outputs for values, by a kernel if there is one or if there are many states."""
        kernel = self._ready(program, names, states)
        if kernel is None:
            return interpreted(program, values, names, states, places)
        return kernel.evaluate(values, threads=os.cpu_count() or 1, places=places)

    def of_tree(self, program: Program, parts: Iterable[Part], tree: Callable[[], NumericTree]) -> Evaluator:
        """An engine that also takes the way over the parts, for outputs of the tree's own ``program``."""

        def run(
            given: Program, values: Mapping[str, Any], names: list[str], states: int, places: Places = NO_PLACES, /
        ) -> dict[str, Array]:
            """By kernel, by the parts, or as for any program."""
            way = quickest(states, coupled=True, warm=self.warm(parts))
            if given is program and way is Way.PARTS and gives(names):
                kernel = self._ready(given, names, states)
                try:
                    if kernel is not None:
                        return kernel.evaluate(values, places=places)
                    return with_elements(tree().answer(values, names, states), places)
                except MissingValue:  # of a parameter that the coupled formulas do not depend on
                    pass
            return self(given, values, names, states, places)

        return run

    def of_part(self, program: Program, values: Mapping[str, Any], names: Sequence[str]) -> Mapping[str, Scalars]:
        """An engine for :class:`substructures.quantities.from_parts.NumericTree`."""
        kernel = self._ready(program, names, 1)
        return interpret_entries(program, values, names) if kernel is None else kernel_entries(kernel, values)

    def prepare(self, parts: Iterable[Part]) -> None:
        """Compile what coupling asks of parts, in the background."""
        for part in parts:
            for names in asked(part):
                self._ready(part.program, names, 1)

    def has(self, program: Program, names: Sequence[str]) -> bool:
        """Whether the kernel for these outputs is in memory."""
        return self._kernels.get((program.digest, tuple(names))) is not None

    def warm(self, parts: Iterable[Part]) -> bool:
        """Whether all that coupling asks of parts is compiled."""
        return all(self._kernels.get((part.program.digest, names)) for part in parts for names in asked(part))

    def compiled(self, program: Program, names: Sequence[str]) -> tuple[Kernel, bool]:
        """The kernel for these outputs, and whether it had to be compiled (or read from the folder) first."""
        key = program.digest, tuple(names)
        kernel = self._kernels.get(key)
        if kernel is not None:
            return kernel, False
        kernel = compile_program(program, key[1], self.folder)
        if self.folder is not None:
            prune(self.folder, self._most)
        self._kernels.put(key, kernel)
        return kernel, True

    def close(self) -> None:
        """Stop compiling."""
        self._compiler.shutdown(wait=True, cancel_futures=True)

    def _ready(self, program: Program, names: Sequence[str], states: int) -> Kernel | None:
        """The kernel if it is there or worth waiting for; otherwise it is compiled in the background."""
        key = program.digest, tuple(names)
        kernel = self._kernels.get(key)
        if kernel is not None:
            return kernel
        with self._lock:
            # a large batch may come in pieces
            so_far = self._waiting.get(key, 0) + states
        if quickest(so_far, coupled=True, warm=False) is Way.KERNEL:
            return self.compiled(program, names)[0]
        self._compile_later(key, program, so_far)
        return None

    def _compile_later(self, key: Key, program: Program, states: int) -> None:
        with self._lock:
            is_new = key not in self._waiting
            if is_new and len(self._waiting) >= QUEUE:
                return
            self._waiting[key] = states
        if is_new:
            self._compiler.submit(self._work, key, program)

    def _work(self, key: Key, program: Program) -> None:
        try:
            self.compiled(program, key[1])
        finally:
            with self._lock:
                self._waiting.pop(key, None)
