"""Compiled kernels, recognised by what they were made from."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from substructures.compile import Kernel, compile_program
from substructures.expr.program import Program
from substructures.quantities.numbers.memo import Known, known_model

__all__ = ["Known", "known_model", "program_kernel"]


@lru_cache(maxsize=64)
def _kernel(known: Known, folder: Path | None) -> Kernel:
    return compile_program(known.source, tuple(known.source.outputs), folder)


def program_kernel(source: Program, folder: Path | None = None) -> Kernel:
    """A compiled program with all its outputs; the same object for the same program."""
    return _kernel(Known(source.digest, source), folder)
