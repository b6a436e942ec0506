"""Threads that use a kernel for the first time at the same moment."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures.compile import compile_program, layout
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
