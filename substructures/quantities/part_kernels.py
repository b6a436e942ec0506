"""Stored programs of parts by compiled kernels, for what couples numbers of parts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.compile import Kernel, compile_program
from substructures.expr.program import Program
from substructures.part.part import Part
from substructures.tree.coupling import asked

Scalars = list[Any]
#: the independent elements of outputs of a part's program for (program, values, names): floats, or arrays (N,)
PartEvaluator = Callable[[Program, Mapping[str, Any], Sequence[str]], Mapping[str, Scalars]]


class CompiledParts:
    """An engine of kernels of stored programs, each compiled when it is first needed, and kept.

    ``folder``: a cache of compiled kernels, see :func:`substructures.compile.compile_program`.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = folder
        self._kernels: dict[tuple[str, tuple[str, ...]], Kernel] = {}

    def __call__(self, program: Program, values: Mapping[str, Any], names: Sequence[str]) -> dict[str, Scalars]:
        """Elements by the kernel for these outputs."""
        key = program.digest, tuple(names)
        if key not in self._kernels:
            self._kernels[key] = compile_program(program, names, self.folder)
        return kernel_entries(self._kernels[key], values)

    def warm(self, part: Part) -> None:
        """Compile all that coupling can ask of a part."""
        for names in asked(part):
            key = part.program.digest, names
            self._kernels[key] = compile_program(part.program, names, self.folder)


def kernel_entries(kernel: Kernel, values: Mapping[str, Any]) -> dict[str, Scalars]:
    """The independent elements of all outputs of a kernel as an engine gives them."""
    return {name: scalars(x) for name, x in kernel.evaluate(values, packed=True).items()}


def scalars(x: Array) -> Scalars:
    """The elements along the last axis: floats, or contiguous arrays of shape (N,)."""
    return x.tolist() if x.ndim == 1 else list(np.ascontiguousarray(x.T))
