"""Compiled kernels of models: interpreted at first, compiled in the background, at once for large batches."""

from __future__ import annotations

import os
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Lock
from typing import Any

from service.cache import Cache
from substructures.compile import Kernel, compile_program
from substructures.evaluation import interpreted
from substructures.expr.program import Program
from substructures.states import Array

#: From about this many states it takes longer to interpret them than to compile first, whatever the program: both
#: times grow with its length (UR5 and iiwa 14, M and Q: 20 ms to compile, 20 ms to interpret 10,000 states).
AT_ONCE = 8192
CAPACITY = 2_000_000  # weight of the kernels kept in memory

Key = tuple[str, tuple[str, ...]]


def _weight(kernel: Kernel) -> int:
    """About what a kernel holds: it grows with its results."""
    return 100 + 10 * sum(len(output.entries) for output in kernel.outputs.values())


class Kernels:
    """An engine for :func:`substructures.evaluation.evaluate`; kernels are kept in memory, and in a folder if given."""

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder
        self._kernels: Cache[Kernel] = Cache(CAPACITY, _weight)
        self._waiting: set[Key] = set()
        self._lock = Lock()
        self._compiler = ThreadPoolExecutor(1, thread_name_prefix="compiler")

    def __call__(self, program: Program, values: Mapping[str, Any], names: list[str], states: int) -> dict[str, Array]:
        """Outputs for values, by a kernel if there is one or if there are many states."""
        key = program.digest, tuple(names)
        kernel = self._kernels.get(key)
        if kernel is None and states < AT_ONCE:
            self._compile_later(key, program)
            return interpreted(program, values, names, states)
        if kernel is None:
            kernel = self._compiled(key, program)
        return kernel.evaluate(values, threads=os.cpu_count() or 1)

    def close(self) -> None:
        """Stop compiling."""
        self._compiler.shutdown(wait=True, cancel_futures=True)

    def _compiled(self, key: Key, program: Program) -> Kernel:
        kernel = compile_program(program, key[1], self.folder)
        self._kernels.put(key, kernel)
        return kernel

    def _compile_later(self, key: Key, program: Program) -> None:
        with self._lock:
            if key in self._waiting:
                return
            self._waiting.add(key)
        self._compiler.submit(self._work, key, program)

    def _work(self, key: Key, program: Program) -> None:
        try:
            self._compiled(key, program)
        finally:
            with self._lock:
                self._waiting.discard(key)
