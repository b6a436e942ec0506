"""Threads that use a kernel for the first time at the same moment, and threads that never begin."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier, Event
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures.compile import compile_program, layout, machine
from substructures.compile.kernel import KernelCall
from substructures.compile.machine import MachineKernel

THREADS = 8


def test_tables_in_use_are_never_freed(monkeypatch: pytest.MonkeyPatch) -> None:
    """All threads make the tables of an output; those that are kept are the ones that all go on with."""
    program = shipped_part("simple-pendulum").program
    kernel = compile_program(program, list(program.outputs)[:1])
    if not isinstance(kernel, MachineKernel):
        pytest.skip("llvmlite has no wheel here: there are no tables")
    make, together = layout.dense, Barrier(THREADS)

    def at_once(*arguments: Any) -> layout.Layout:
        made = make(*arguments)
        together.wait(30)
        return made

    monkeypatch.setattr(layout, "dense", at_once)
    (name,) = kernel.names
    array = np.zeros((1, *kernel.shape(name)))
    request = KernelCall({}, (1,), {name: array}, False)
    with ThreadPoolExecutor(THREADS) as pool:
        found = list(pool.map(lambda _: kernel._output(name, array, request), range(THREADS)))
    assert set(found) == {kernel._output(name, array, request)}


def test_the_part_of_a_thread_that_never_begins_is_computed_by_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """Threads begin with parts of their own and go on with what is left, the last states of no full vector included."""
    program = shipped_part("simple-pendulum").program
    names = list(program.outputs)
    kernel, count = compile_program(program, names), machine.THREADED + 3
    random = np.random.default_rng(5)
    values = {symbol.name: random.uniform(0.5, 2, count) for symbol in program.symbols}
    expected, never = kernel.evaluate(values), Event()
    with ThreadPoolExecutor(1) as pool:
        pool.submit(never.wait, 60)
        monkeypatch.setattr(machine, "workers", lambda: pool)
        found = [kernel.evaluate(values, threads=threads) for threads in (2, 3, 5)]
        never.set()
    assert all(np.array_equal(some[name], expected[name]) for some in found for name in names)
