"""Motions in machine code: steps of a Runge-Kutta method around bound kernels, many in one call."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array
from substructures.compile import target
from substructures.compile.assembler import AssemblyWriter
from substructures.compile.engine import Scratch, address, assembled
from substructures.compile.machine import BoundCall
from substructures.compile.stepping import FAILED, FINISHED, HEAD, NUMBERS, RUN, RUNNING, WORDS, Tableau, stepping
from substructures.compile.tables import TimeTables

__all__ = ["FAILED", "FINISHED", "HEAD", "RUNNING", "CompiledRates", "CompiledRun", "Tableau"]

_Words = ctypes.c_int64 * len(RUN)
#: of a row of ways, before the state: when it begins, its first step, when it ends; evaluations and status are written
WAY = ("t", "h", "end", "evaluations", "status")
#: evaluations where there is no limit
MANY = 2**62


@dataclass(frozen=True)
class Pressing:
    """Contacts of a saddle point: see :mod:`.pressing`, whose arrays these are. Those behind ``scales`` are written at
    every call: ``forces`` F (3 k, n), ``shares`` (m, r), ``columns`` (r, n), and ``pressed`` y (r,).
    """

    rate: Array
    velocities: Array
    laws: Array
    held: NDArray[np.int64]
    inverse: Array
    scales: Array
    forces: Array
    shares: Array
    columns: Array
    pressed: Array

    def words(self, jacobian: Array, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """The table PRESSING."""
        arrays = jacobian, self.rate, self.velocities, self.laws, self.forces, self.held, self.inverse, self.scales
        sizes = len(self.velocities), len(self.laws), len(self.held), len(rows)
        table = [*map(address, (*arrays, self.shares, self.columns, rows)), *sizes]
        return np.array(table, dtype=np.int64)


@dataclass(frozen=True)
class SaddlePoint:
    """[g G^T; G 0] [q''; -lambda] = [Q - Gamma q'q'; -c] of arrays that kernels write: ``metric`` (n, n), ``jacobian``
    (m, n), ``acceleration`` c (m,), ``forces``, ``bias`` (n,). ``rows`` (r,): the independent ones of G and c, others
    at the next call where they have changed. ``moving`` (k,): the coordinates that are not held, of which q'' is zero.
    ``first``: place of q'' in what is written. ``pressing``: contacts, whose columns stand in the place of G^T.
    ``velocities`` q' (n,) and ``power`` (1,), to which that of the forces of rows is added, where it counts.
    """

    metric: Array
    jacobian: Array
    acceleration: Array
    forces: Array
    bias: Array
    rows: NDArray[np.int64]
    moving: NDArray[np.int64]
    first: int = 0
    pressing: Pressing | None = None
    velocities: Array | None = None
    power: Array | None = None

    def words(self, width: int) -> tuple[NDArray[np.int64], Any]:
        """The table SADDLE, and the memory that it needs."""
        free = len(self.moving)
        size = free + len(self.rows)
        matrix = Scratch.zeros(size, -(-(size + 1) // width) * width)
        arrays = self.metric, self.jacobian, self.acceleration, self.forces, self.bias, self.rows, self.moving
        sizes = len(self.forces), free, size, matrix.array.shape[1], self.first
        contacts, pressed, columns = np.zeros(1, dtype=np.int64), np.zeros(len(self.rows)), self.jacobian
        if (p := self.pressing) is not None:
            contacts, pressed, columns = p.words(self.jacobian, self.rows), p.pressed, p.columns
        works = [0 if x is None else address(x) for x in (self.velocities, self.power)]
        beside = [address(columns), address(pressed), *works]
        own = 0 if p is None else address(contacts)
        table = [*map(address, arrays), matrix.address, *beside, *sizes, own]
        return np.array(table, dtype=np.int64), (matrix, contacts, pressed)


@dataclass(frozen=True)
class CompiledRates:
    """x' = (q', q'', power) as calls of kernels, one after the other, that share memory: they read ``t`` (1,) and ``x``
    (1, 2n), and write ``written`` (1, n) and ``power`` (1,), None where W is no part of x. ``folder``: a cache of code.
    ``saddle``: q'' is its solution, in place of what kernels write. Where q' is no part of x it is ``written`` before:
    as many as x has are all but the power. ``tables``: of the time, which the calls read.
    """

    calls: tuple[BoundCall, ...]
    t: Array
    x: Array
    written: Array
    power: Array | None
    folder: Path | None = None
    saddle: SaddlePoint | None = None
    tables: TimeTables | None = None

    @property
    def size(self) -> int:
        """Length of the state (q, q', W)."""
        return self.x.size + (self.power is not None)


def _reach() -> str:
    """The states at the ends of ``count`` ways in place of those where they begin; each takes at most so many
    evaluations. The run tries one step in a call of advance.
    """
    w = AssemblyWriter(1)
    c = w.words("%run", RUN)
    numbers, y = w.pointer(c["numbers"]), w.pointer(c["y"])
    words = {name: w.offset(numbers, len(NUMBERS) + k, "i64") for k, name in enumerate(WORDS)}
    with w.loop("0", "%count") as i:
        row = w.offset("%ways", w.arithmetic("mul", i, w.arithmetic("add", c["size"], len(WAY))), "double")
        state = w.offset(row, len(WAY), "double")
        w.copy(row, numbers, "3")
        w.copy(state, y, c["size"])
        for place in words.values():
            w.put(f"store i64 0, ptr {place}, align 8")
        with w.forever() as leave:
            w.put(f"store i64 0, ptr {words['accepted']}, align 8")
            w.put("call void @advance(ptr %run)")
            found = [w.do(f"load i64, ptr {words[name]}, align 8") for name in WAY[3:]]
            leave(w.do(f"icmp sge i64 {found[0]}, %most"))
            leave(w.do(f"icmp ne i64 {found[1]}, {RUNNING}"))
        for k, word in enumerate(found, 3):
            value = w.do(f"sitofp i64 {word} to double")
            w.put(f"store double {value}, ptr {w.offset(row, k, 'double')}, align 8")
        w.copy(y, state, c["size"])
    return w.function("reach", "ptr %run, ptr %ways, i64 %count, i64 %most")


class _Loaded(NamedTuple):
    """Functions of one method, and their code."""

    code: target.Loaded
    advance: Callable[[Any], None]
    reach: Callable[[Any, int, int, int], None]


@lru_cache(maxsize=16)
def _loaded(tableau: Tableau, width: int, folder: Path | None) -> _Loaded:
    code = target.Loaded.load(assembled(stepping(tableau, width) + _reach(), folder), ["advance", "reach"])
    run = ctypes.POINTER(_Words)
    advance = ctypes.CFUNCTYPE(None, run)(code.names["advance"])
    reach = ctypes.CFUNCTYPE(None, run, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64)(code.names["reach"])
    return _Loaded(code, advance, reach)


class CompiledRun:
    """A run of a method from a state on. Not for several threads at a time, nor beside others with the same rates."""

    def __init__(
        self,
        tableau: Tableau,
        rates: CompiledRates,
        tolerances: tuple[float, float],
        longest: float = np.inf,
        most: int = 1,
    ) -> None:
        """``tolerances``: relative and absolute; ``longest``: step; ``most``: steps that are tried in a call."""
        width, size = target.host().width, rates.size
        rows = -(-size // width) * width
        # vectors that are filled up: what is behind a state stays zero
        self._rows = Scratch.zeros(tableau.stages + 3, rows)
        self._y = self._rows.array[0, :size]
        self._steps = np.zeros((most, HEAD + size))
        self._memory = np.zeros(len(NUMBERS) + len(WORDS))
        self._words = self._memory[len(NUMBERS) :].view(np.int64)
        self._memory[3:6] = longest, *tolerances
        calls = np.array([call.words for call in rates.calls], dtype=np.int64)
        row = [self._rows.address + 8 * rows * k for k in range(3)]
        power = 0 if rates.power is None else address(rates.power)
        own = [address(calls), len(calls)]
        sizes = [rates.x.size - rates.written.size, rates.written.size, size, rows]
        own += [address(rates.t), address(rates.x), address(rates.written), power, *sizes]
        own += [target.math_library()["pow"], address(self._memory), row[0], row[2], row[1], address(self._steps)]
        saddle = None if rates.saddle is None else rates.saddle.words(width)
        own.append(0 if saddle is None else address(saddle[0]))
        own += [0, 0] if rates.tables is None else [address(rates.tables.words), len(rates.tables.words)]
        self._alive = rates, calls, saddle
        self._run = _Words(*own, 0)
        self._code = _loaded(tableau, width, rates.folder)

    def begin(self, t: float, x: Array, end: float, h: float) -> None:
        """From x (size,) at t on, to ``end``, with a first step h."""
        self._y[:] = x
        self._memory[:3] = t, h, end
        self._words[:] = 0

    def go_on(self, t: float, end: float, h: float) -> None:
        """From the state that was reached at t, where x' is known."""
        self._memory[:3] = t, h, end
        self._words[WORDS.index("status")] = RUNNING

    def advance(self, most: int = 1) -> Array:
        """The steps (k, HEAD + size) that were accepted of ``most`` tried ones: time, evaluations up to there, state.

        They are overwritten by the next call.
        """
        self._words[0] = 0
        self._run[-1] = min(most, len(self._steps))
        self._code.advance(self._run)
        return self._steps[: self._words[0]]

    def rates(self, t: float, x: Array) -> Array:
        """x' of x (size,) at t, in place of a run."""
        self.begin(t, x, t, 1.0)
        self.advance(0)
        return self._rows.array[2, : x.size].copy()

    def reach(self, ways: Array, most: int = MANY) -> None:
        """The states at the ends of ways (k, len(WAY) + size) in place of those where they begin, each by steps of its
        own, in about ``most`` evaluations at most; the columns WAY say which, and get what became of them.
        """
        self._run[-1] = 1
        self._code.reach(self._run, address(ways), len(ways), most)

    @property
    def status(self) -> int:
        """RUNNING, FAILED (the steps became too small) or FINISHED."""
        return int(self._words[WORDS.index("status")])

    @property
    def evaluations(self) -> int:
        """Of x' since the state that it began at."""
        return int(self._words[WORDS.index("evaluations")])

    @property
    def next_step(self) -> float:
        """The size of the step that is tried next."""
        return float(self._memory[NUMBERS.index("h")])

    @property
    def state(self) -> Array:
        """The state that was reached (size,)."""
        return self._y.copy()
