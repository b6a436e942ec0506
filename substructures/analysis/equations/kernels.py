"""Compiled kernels, recognised by what they were made from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.compile import Kernel, compile_program
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.known import Known
from substructures.expr.program import Program

#: seconds: of the interpreter for an operation, and for its value at a state; of the compiler for a program, and for an
#: operation. Their ratios count
INTERPRETED, VALUE = 1.3e-6, 4e-9
COMPILED, LINE = 5e-3, 4.5e-5


@lru_cache(maxsize=64)
def _kernel(known: Known, folder: Path | None) -> Kernel:
    return compile_program(known.source, tuple(known.source.outputs), folder)


def program_kernel(source: Program, folder: Path | None = None) -> Kernel:
    """A compiled program with all its outputs; the same object for the same program."""
    return _kernel(Known(source.digest, source), folder)


@lru_cache(maxsize=256)
def _spent(known: Known) -> list[float]:  # noqa: ARG001 -- the key
    return [0.0]


def evaluated(source: Program, values: Mapping[str, Any], names: Sequence[str], states: int) -> dict[str, Array]:
    """Outputs at so many states, values of symbols being numbers or (states,): interpreted, until that takes longer in
    all than to compile the program, then by its kernel: never twice as long as the better one of both.
    """
    chosen = source if len(names) == len(source.outputs) else source.select(list(names))
    spent, size = _spent(Known(chosen.digest, chosen)), len(chosen)
    spent[0] += size * (INTERPRETED + VALUE * states)
    if spent[0] > COMPILED + LINE * size:
        found = program_kernel(chosen).evaluate(values, names)
        return {name: _owned(x, (states, *chosen.outputs[name].shape)) for name, x in found.items()}
    return interpret_in_blocks(chosen, values, list(names), states)


def _owned(x: Array, shape: tuple[int, ...]) -> Array:
    """An array of this shape that can be written to."""
    return x if x.shape == shape else np.array(np.broadcast_to(x, shape))
