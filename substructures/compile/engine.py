"""The shared functions in executable memory, memory with known addresses, and calls of the driver."""

from __future__ import annotations

import ctypes
import os
from array import array
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array
from substructures.compile import cache, target
from substructures.compile.lowering import ProgramStep
from substructures.compile.runtime import CONTEXT, LINE, STEP, runtime

WORDS = ctypes.c_int64 * len(CONTEXT)
DRIVER = ctypes.CFUNCTYPE(None, ctypes.c_void_p)
#: of the scratch arrays: a cache line, and the widest vector
ALIGNMENT = 64


def address(array: NDArray[Any]) -> int:
    """Where the data of an array begin."""
    try:
        return ctypes.addressof(ctypes.c_char.from_buffer(array.data))  # a fifth of the time of the other way
    except (TypeError, ValueError):  # read-only, not contiguous, or empty
        return int(array.__array_interface__["data"][0])


class WordTable(NamedTuple):
    """Rows of 64-bit words for the runtime; ``alive`` owns the memory."""

    address: int
    rows: int
    alive: Any

    @classmethod
    def of(cls, array: NDArray[np.int64]) -> WordTable:
        """A table that is used often."""
        return cls(address(array), len(array), array)

    @classmethod
    def written(cls, rows: Sequence[Iterable[int]]) -> WordTable:
        """A table for one call."""
        memory = array("q", chain.from_iterable(rows))
        return cls(memory.buffer_info()[0], len(rows), memory)


def counters(parts: int = 1) -> ctypes.Array[ctypes.c_int64]:
    """Of the groups that were taken of the parts of a batch; the second word: whether a result was not finite."""
    return (ctypes.c_int64 * (LINE // 8 * parts))()


class Scratch(NamedTuple):
    """Rows of doubles, one for every vector of a group; ``stride`` in bytes is 0 when one row serves all."""

    address: int
    stride: int
    array: Array

    @classmethod
    def zeros(cls, rows: int, doubles: int) -> Scratch:
        """Aligned rows; their length must be a multiple of the vector width."""
        raw = np.zeros(rows * doubles + ALIGNMENT // 8)
        start = -address(raw) % ALIGNMENT // 8
        array = raw[start : start + rows * doubles].reshape(rows, doubles)
        return cls(address(array), 8 * doubles if rows > 1 else 0, array)

    def copy(self) -> Scratch:
        """The same for another thread."""
        result = Scratch.zeros(*self.array.shape)
        result.array[...] = self.array
        return result


@dataclass(frozen=True)
class VectorRuntime:
    """The shared functions for one vector width."""

    width: int
    loaded: target.Loaded
    call: Callable[[Any], None]
    pair: NDArray[np.int64]

    @classmethod
    def of(cls, code: bytes, width: int) -> VectorRuntime:
        """Loads the object code of the shared functions. Raises RuntimeError."""
        loaded = target.Loaded.load(code, ["drive", "drive_one", "sincos", "unary", "binary"])
        call = DRIVER(loaded.names["drive"])
        library = target.math_library()
        return cls(width, loaded, call, np.array([library["sin"], library["cos"]], dtype=np.int64))

    def steps(self, steps: Iterable[ProgramStep], stage: int, parts: Mapping[str, int]) -> NDArray[np.int64]:
        """The table STEP of a stage."""
        rows = [self._step(step, stage, parts) for step in steps]
        return np.array(rows, dtype=np.int64).reshape(-1, len(STEP))

    def _step(self, step: ProgramStep, stage: int, parts: Mapping[str, int]) -> list[int]:
        if step.function == "part":
            return [-1, parts[f"part{step.number}"], 0, 0, 0, 0, 0]
        a, b, c = (8 * self.width * x for x in (step.a, step.b, step.c))
        if step.function == "sincos":
            return [stage, self.loaded.names["sincos"], a, b, c, step.count, address(self.pair)]
        shared = "binary" if step.function in ("atan2", "pow") else "unary"
        return [stage, self.loaded.names[shared], a, b, c, step.count, target.math_library()[step.function]]

    def drive(self, *words: int) -> None:
        """One call of the driver, without the interpreter's lock; words in the order of CONTEXT."""
        context = array("q", words)
        self.call(context.buffer_info()[0])


_pools: dict[int, ThreadPoolExecutor] = {}


def workers() -> ThreadPoolExecutor:
    """Threads of this process, kept for all batches; a forked process has its own."""
    process = os.getpid()
    if process not in _pools:
        _pools.clear()
        _pools[process] = ThreadPoolExecutor(os.cpu_count() or 1, thread_name_prefix="kernel")
    return _pools[process]


_runtimes: dict[int, VectorRuntime] = {}


def shared_runtime(width: int, folder: Path | None = None) -> VectorRuntime:
    """Compiled, or taken from the folder, once in a process."""
    if width not in _runtimes:
        _runtimes[width] = VectorRuntime.of(assembled(runtime(width), folder), width)
    return _runtimes[width]


def assembled(text: str, folder: Path | None = None) -> bytes:
    """Object code of a module, which is kept in the folder. Raises RuntimeError."""
    wanted = cache.key(text, (), target.host().identity) if folder is not None else ""
    found = cache.read(folder, wanted) if folder is not None else None
    code = found[1] if found is not None else target.assemble(text)
    if folder is not None and found is None:
        cache.write(folder, wanted, None, code)
    return code
